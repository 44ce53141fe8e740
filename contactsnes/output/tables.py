"""Tables in files: CSV for people and spreadsheets, HDF5 for programs. A file is replaced whole, so
that it is never half written."""

import csv
import os
import subprocess
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

import numpy as np

from ..system.devices import Lenient
from ..system.hdf5 import h5py


def markdown(heading, rows):
    """Lines of a table in Markdown, from lists of texts."""
    return [f"| {' | '.join(line)} |" for line in (heading, ["---"] * len(heading), *rows)]


def write_between(path, begin, end, text):
    """Put a text between two marks of a file, each of which stands there once; ValueError
    otherwise.

    Parameters
    ----------
    path : path of the file
    begin, end : str, the marks
    text : str, what takes the place of all between them
    """
    content = Path(path).read_text(encoding="utf-8")
    if content.count(begin) != 1 or content.count(end) != 1:
        raise ValueError(
            f"{Path(path).name} has lost its marks '{begin.strip()}' and '{end.strip()}'")
    before, rest = content.split(begin)
    Path(path).write_text(before + begin + text + end + rest.split(end)[1], encoding="utf-8")


def measured(path=None):
    """When, and on which commit of the sources around it, the results in a file were written (now,
    without one): a sentence for the page that shows them."""
    time = datetime.fromtimestamp(Path(path).stat().st_mtime) if path else datetime.now()
    found = subprocess.run(["git", "log", "-1", f"--before={time.isoformat()}", "--format=%h"],
                           cwd=Path(__file__).parent, capture_output=True, text=True)
    commit = f" on commit {found.stdout.strip()}" if found.returncode == 0 else ""
    return f"Measured on {time:%Y-%m-%d}{commit}."


def write_csv(path, columns, rows):
    """Write a table with one line a row (a mapping), its heading the names of the columns; numbers
    in full.

    Parameters
    ----------
    path : path of the file
    columns : iterable of their names
    rows : iterable of mappings, column -> value
    """
    def write(partial):
        with open(partial, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(columns), extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    replaced(path, write)


def write_hdf5(path, attributes, content):
    """Write nested mappings of names to arrays, numbers, strings or lists of them as groups and
    datasets.

    Parameters
    ----------
    path : path of the file
    attributes : mapping, attributes of the root
    content : nested mapping; a value may be a pair (data, unit), the unit then is the dataset's
        attribute ``unit``
    """
    def write(partial):
        with Lenient(partial) as device, h5py.File(device, "w") as file:
            file.attrs.update(attributes)
            _fill(file, content)
        device.check()
    replaced(path, write)


def read_hdf5(path):
    """The attributes of the root and the content of a file of `write_hdf5`, units left out; strings
    as arrays of str."""
    with h5py.File(path, "r") as file:
        return dict(file.attrs), _content(file)


def _fill(group, content):
    """Write nested mappings into a group."""
    for name, value in content.items():
        if isinstance(value, Mapping):
            _fill(group.create_group(name), value)
            continue
        data, unit = value if isinstance(value, tuple) else (value, None)
        data = np.asarray(data)
        if data.dtype.kind == "U":
            # Of one length: HDF5 2.0 frees what it has not where there is no room for others.
            data = np.char.encode(data, "utf-8")
            data = data.astype(h5py.string_dtype(length=data.dtype.itemsize))
        group[name] = data
        if unit is not None:
            group[name].attrs["unit"] = unit


def _content(group):
    """Nested dictionaries of arrays from a group."""
    return {name: _content(item) if isinstance(item, h5py.Group)
            else (item.asstr()[...] if h5py.check_string_dtype(item.dtype) else item[...])
            for name, item in group.items()}


def replaced(path, write):
    """Let ``write`` make a file beside ``path``, with the same ending, and put that in its place; a
    device is written to as it is.

    Parameters
    ----------
    path : path of the file
    write : function of the path that it writes to
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        write(path)
        return
    path = path.resolve()  # (a pipe behind /dev/stdout would have no name then)
    partial = path.with_name(f"{path.stem}.partial{path.suffix}")
    try:
        write(partial)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
