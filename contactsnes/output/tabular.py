"""Numbers of archives as one table, in CSV or Parquet: rows are points, or runs."""

import csv
import io
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..options.fields import InputError, nearest
from .extras import extra
from .reading import read

OWN = ("archive", "point")
"""Columns that an archive does not have itself: its path, and the number of the point, from 0."""

SCENE = "scene_"


class Table(NamedTuple):
    """Columns of one length and their units, by name; and what was left out, in sentences."""

    columns: dict
    units: dict
    notes: list


def tabulate(paths, asked):
    """The table that options ask for.

    Parameters
    ----------
    paths : list of paths of archives
    asked : TableOptions

    Raises
    ------
    InputError
        For a column that an archive does not have, or has in another unit than the first.
    ArchiveError
        Where there is no archive.
    """
    parts, units, notes = [], {}, []
    for path in paths:
        record = read(path)
        rows = chosen_rows(record, asked.rows)
        if not len(rows):
            notes.append(f"{path} has no point of rows '{asked.rows}'")
        names = asked.names or [*(OWN[:1] if len(paths) > 1 else ()), OWN[1], *record]
        parts.append({name: _column(record, name, rows) for name in names})
        for name in names:
            unit = record.units.get(name, "")
            if units.setdefault(name, unit) != unit:
                raise InputError(f"{path} has {name} in '{unit}', archives before it in "
                                 f"'{units[name]}': one table takes archives of one kind of units")
    every = list(dict.fromkeys(name for part in parts for name in part))
    strange = [name for name in every for part in parts if name not in part]
    if strange:
        raise InputError(f"not all archives have the column {strange[0]}: name those that are "
                         "wanted by -columns")
    columns = {name: np.concatenate([part[name] for part in parts]) for name in every}
    return Table(columns, {name: units[name] for name in every}, notes)


def chosen_rows(record, rows):
    """Numbers of the points of an archive that are rows: 'all', the 'last', the first 'event' or
    that of a kind; an array."""
    if rows == "all":
        return np.arange(record.points)
    if rows == "last":
        return np.arange(record.points)[-1:]
    events = record["event"]
    return np.flatnonzero(events != "none" if rows == "event" else events == rows)[:1]


def _column(record, name, rows):
    """Values of a column at rows; InputError for one that there is not."""
    if name == "archive":
        return np.full(len(rows), str(record.path))
    if name == "point":
        return rows
    if name in record:
        return np.asarray(record[name])[rows]
    if name.startswith(SCENE) and name[len(SCENE):] in record.scene:
        value = np.asarray(record.scene[name[len(SCENE):]])
        # of two directions one cell holds both
        value = ",".join(map(str, value.tolist())) if value.ndim else value.item()
        return np.full(len(rows), value)
    known = [*OWN, *record, *(SCENE + other for other in record.scene)]
    guess = nearest(name, known)
    raise InputError(f"-columns: {record.path} has no column {name}"
                     + (f": did you mean {guess}?" if guess else f"; it has {', '.join(known)}"))


def as_csv(table, units=False):
    """A table as text in CSV, numbers in full; with units in the heading if asked."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow([f"{name} [{table.units[name]}]" if units and table.units[name] else name
                     for name in table.columns])
    writer.writerows(zip(*(column.tolist() for column in table.columns.values())))
    return file.getvalue()


def write_parquet(path, table):
    """Write a table to a Parquet file; the metadata of a column hold its unit."""
    arrow = extra("pyarrow", "table", "-format parquet")
    parquet = extra("pyarrow.parquet", "table", "-format parquet")
    arrays = [arrow.array(column.tolist()) for column in table.columns.values()]
    fields = [arrow.field(name, array.type, metadata={"unit": table.units[name]})
              for name, array in zip(table.columns, arrays)]
    parquet.write_table(arrow.Table.from_arrays(arrays, schema=arrow.schema(fields)), path)


def write_table(paths, table, asked):
    """Write a table where options say: the path of the file, or None for a text that is yet to be
    shown.

    Parameters
    ----------
    paths : list of paths of the archives
    table : Table
    asked : TableOptions
    """
    if asked.format == "csv" and not asked.output:
        return None
    path = Path(asked.output) if asked.output else Path(paths[0]).with_suffix(".parquet")
    if not asked.output and len(paths) > 1:
        raise InputError("-format is 'parquet' for several archives without a file: name it by "
                         "-output")
    if not path.parent.is_dir():
        raise InputError(f"-output is '{path}', whose folder does not exist: create it, or name "
                         "another")
    if asked.format == "csv":
        path.write_text(as_csv(table, asked.units), encoding="utf-8")
    else:
        write_parquet(path, table)
    return path
