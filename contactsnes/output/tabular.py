"""Numbers of archives as one table, in CSV or Parquet: rows are points, or runs."""

import csv
import io
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..options.fields import InputError
from ..scene.scene import Scene
from ..system.streams import legible
from . import resuming
from .columns import instead
from .extras import extra
from .files import ArchiveError, check_ending, check_output, target_beside
from .reading import read
from .tables import replaced

OWN = ("archive", "point", "complete")
"""Columns that an archive does not have itself: its path, the number of the point, from 0, and
whether its path is done (1 or 0)."""

SCENE = "scene_"

ENDINGS = {"csv": (".csv", ".txt", ".dat"), "parquet": (".parquet", ".pq")}
"""Kind of file -> endings of its names."""

ALWAYS_OTHERS = ("archive_", "scene_")
"""Prefixes of options that tell no runs apart: files always differ, and what a scene is, its
attributes tell."""


class Table(NamedTuple):
    """Columns of one length and their units, by name; what was left out or is not complete, in
    sentences; and why archives could not be read."""

    columns: dict
    units: dict
    notes: list
    unread: list


def tabulate(paths, asked):
    """The table that options ask for, of the archives that can be read.

    Parameters
    ----------
    paths : list of paths of archives
    asked : TableOptions

    Raises
    ------
    InputError
        For a column that no archive has, or one has in another unit than the first.
    ArchiveError
        Where none of the archives can be read.
    """
    records, unread = _readable(paths)
    names = asked.names or _default(records)
    rows = [chosen_rows(record, asked.rows) for record in records]
    notes = [f"{record.path} is not complete: its run has not come to its end"
             for record in records if not record.complete]
    notes += [f"{record.path} has no point of rows '{asked.rows}'"
              for record, chosen in zip(records, rows) if not len(chosen)]
    units, columns = _units(records, names), {}
    for name in names:
        parts = [_cells(record, name, chosen) for record, chosen in zip(records, rows)]
        without = [record.path for record, part in zip(records, parts) if part is None]
        if len(without) == len(records):
            raise _unknown(records, name)
        if without:
            notes.append(f"{', '.join(map(str, without))}: no column {name}, its cells are empty")
        columns[name] = np.concatenate([np.full(len(chosen), None) if part is None else part
                                        for part, chosen in zip(parts, rows)])
    return Table(columns, units, notes, unread)


def _readable(paths):
    """Archives as records, and why others cannot be read; ArchiveError where none can."""
    records, unread = [], []
    for path in paths:
        try:
            records.append(read(path))
        except ArchiveError as error:
            unread.append(str(error))
    if not records:
        raise ArchiveError("; ".join(unread))
    return records, unread


def _default(records):
    """Columns of a table that names none: of several archives also what tells their rows apart."""
    several = len(records) > 1
    own = [name for record in records for name in record]
    return list(dict.fromkeys([*OWN[:several], *(_differing(records) if several else ()), OWN[1],
                               *own]))


def _differing(records):
    """Attributes of scenes, and options besides, that differ between archives."""
    known = [[*(SCENE + name for name in record.scene),
              *(name for name in resuming.entries(record.options)
                if not name.startswith(ALWAYS_OTHERS))] for record in records]
    return [name for name in dict.fromkeys(name for names in known for name in names)
            if len({str(_value(record, name)) for record in records}) > 1]


def _units(records, names):
    """Unit of each column; InputError where an archive has another than those before it."""
    units = {}
    for record in records:
        for name in names:
            unit = _unit(record, name)
            if unit is None:
                continue
            if units.setdefault(name, unit) != unit:
                raise InputError(f"{record.path} has {name} in '{unit}', archives before it in "
                                 f"'{units[name]}': one table takes archives of one kind of units")
    return {name: units.get(name, "") for name in names}


def _unit(record, name):
    """Unit of a column, or of an attribute of the scene; None for what has none there."""
    attribute = name.removeprefix(SCENE)
    if name.startswith(SCENE) and attribute in record.scene:
        return Scene.told_in(attribute, record.scene.get("units"))
    return record.units.get(name, "") if name in record else None


def chosen_rows(record, rows):
    """Numbers of the points of an archive that are rows: 'all', the 'last', the first 'event' or
    that of a kind; an array."""
    if rows == "all":
        return np.arange(record.points)
    if rows == "last":
        return np.arange(record.points)[-1:]
    events = record.get("event", np.full(record.points, "none"))
    return np.flatnonzero(events != "none" if rows == "event" else events == rows)[:1]


def _cells(record, name, rows):
    """Values of a column at rows; None for one that there is not."""
    if name == "point":
        return rows
    if name in record:
        return np.asarray(record[name])[rows]
    value = _value(record, name)
    return None if value is None else np.full(len(rows), value)


def _value(record, name):
    """What holds for all points of an archive: its path, whether it is complete, an attribute of
    its scene, an option; None where there is none."""
    if name in ("archive", "complete"):
        return {"archive": legible(str(record.path)), "complete": int(record.complete)}[name]
    if not name.startswith(SCENE) or name[len(SCENE):] not in record.scene:
        return resuming.entries(record.options).get(name)
    value = np.asarray(record.scene.get(name[len(SCENE):]))
    # of two directions one cell holds both
    return ",".join(map(str, value.tolist())) if value.ndim else value.item()


def _unknown(records, name):
    """The InputError for a column that no archive has."""
    first = records[0]
    known = list(dict.fromkeys([*OWN, *(known for record in records for known in record),
                                *(SCENE + other for other in first.scene)]))
    return InputError(f"-columns: {first.path} has no column {name}"
                      + instead(name, [*known, *resuming.entries(first.options)], known))


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
    # NumPy's type is that of a column without rows, too
    arrays = [arrow.array(column.tolist() if column.dtype == object else column)
              for column in table.columns.values()]
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
    if not asked.output and len(paths) > 1:
        raise InputError("-format is 'parquet' for several archives without a file: name it by "
                         "-output")
    path = Path(asked.output) if asked.output else target_beside(paths[0], ".parquet")
    other, = (kind for kind in ENDINGS if kind != asked.format)
    if path.suffix.lower() in ENDINGS[other]:
        raise InputError(f"-output is '{path}', but -format is '{asked.format}': name another, or "
                         f"give -format {other}")
    check_ending(path, f"a table in {asked.format.upper()}", ENDINGS[asked.format])
    check_output(path)
    if asked.format == "csv":
        text = as_csv(table, asked.units)
        replaced(path, lambda partial: partial.write_text(text, encoding="utf-8"))
    else:
        replaced(path, lambda partial: write_parquet(partial, table))
    return path
