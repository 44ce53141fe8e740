"""Columns of an archive, their rows and their attributes, by HDF5's own calls: there are many, and
these take a third of the time of h5py's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..options.fields import meant
from .files import ArchiveError

ASKED = {"stiffness": "-archive_stiffness", "error_": "-archive_errors"}
"""Beginnings of the names of columns that a run writes where it is asked to -> the option."""


class Column(NamedTuple):
    """What a column of the branch holds: its unit, its NumPy type and, of an enumeration, the names
    of 0, 1, ..."""

    unit: str
    kind: str = "f8"
    names: tuple[str, ...] = ()

    @classmethod
    def of(cls, name, given):
        """The column that is given as a tuple; ArchiveError for what is none."""
        if not isinstance(name, str) or not name or "/" in name or name == ".":
            raise ArchiveError(f"a column is called {name!r}: allowed is a text without '/'")
        try:
            if isinstance(given, str):
                raise TypeError
            column = cls(*given)
            fits = np.dtype(column.kind).kind in "fiu" and isinstance(column.unit, str)
        except TypeError:
            fits = False
        if not fits:
            raise ArchiveError(f"the column {name} is {given!r}: give a tuple of its unit, a text, "
                               "perhaps of NumPy's type of real numbers and of names")
        return column

    @property
    def stored(self):
        """NumPy type in the file."""
        return "i1" if self.names else self.kind

    def number(self, name, value):
        """A value as a number that the column holds, of an enumeration from a name, too;
        ArchiveError for one that it does not."""
        if isinstance(value, str) and self.names:
            if value not in self.names:
                raise ArchiveError(f"{name} cannot be {value!r}; it can be one of {self.names}.")
            return self.names.index(value)
        if isinstance(value, float) and self.stored == "f8":
            return value
        plain = np.asarray(value)
        if plain.ndim or plain.dtype.kind not in "fiub":
            raise ArchiveError(f"{name} is {value!r}: a row has one real number for each column")
        with np.errstate(all="ignore"):
            kept = plain.astype(self.stored)
        lost = (np.isfinite(kept) != np.isfinite(plain) if kept.dtype.kind == "f"
                else kept != plain or (self.names and not 0 <= kept < len(self.names)))
        if lost:
            raise ArchiveError(f"{name} is {value!r}, which its column cannot hold: that has "
                               + (f"numbers from 0 to {len(self.names) - 1}" if self.names else
                                  f"numbers of NumPy's type {self.stored}"))
        return value


def asked_differently(there, here):
    """Options that ask for columns which only one of two mappings of columns has: (option, how it
    is there, how it is here)."""
    asked = [{option for start, option in ASKED.items()
              if any(name.startswith(start) for name in known)} for known in (there, here)]
    return [(option, *(("not given", "given")[option in known] for known in asked))
            for option in sorted(asked[0] ^ asked[1])]


def instead(name, known, shown=None):
    """The end of a sentence on a column that an archive does not have: what writes it, what is
    spelt like it, or what there is.

    Parameters
    ----------
    name : str
    known : list of str, names that would do
    shown : list of str, those to show where none is alike; None: all
    """
    option = next((option for start, option in ASKED.items() if name.startswith(start)
                   and not any(other.startswith(start) for other in known)), "")
    if option:
        return f": {option} writes it"
    return meant(name, known, f"; it has {', '.join(shown or known)}")


def put_attributes(item, attributes):
    """Write attributes, a mapping, of a new group or dataset, given by its identifier."""
    from ..system.hdf5 import h5py

    for name, value in attributes.items():
        value = np.asarray(value)
        if value.dtype.kind == "U":
            value = value.astype(h5py.string_dtype())
        kind = h5py.h5t.py_create(value.dtype, logical=True)
        space = (h5py.h5s.create_simple(value.shape) if value.ndim
                 else h5py.h5s.create(h5py.h5s.SCALAR))
        h5py.h5a.create(item, name.encode(), kind, space).write(value)


def make_columns(branch, columns, chunk):
    """Make columns without rows that count; names from the root -> attributes.

    The room of the first rows is in the file at once: it has to be there before any row is.

    Parameters
    ----------
    branch : h5py.h5g.GroupID, the group that gets them
    columns : dict, name -> `Column`
    chunk : int, rows that are stored together
    """
    from ..system.hdf5 import h5py

    space = h5py.h5s.create_simple((1,), (h5py.h5s.UNLIMITED,))
    plan, found = h5py.h5p.create(h5py.h5p.DATASET_CREATE), {}
    plan.set_chunk((chunk,))
    plan.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    plan.set_obj_track_times(False)
    for name, column in columns.items():
        kind = h5py.h5t.py_create(np.dtype(column.stored))
        found[f"branch/{name}"] = attributes = {"unit": column.unit}
        if column.names:
            attributes["names"] = list(column.names)
        put_attributes(h5py.h5d.create(branch, name.encode(), kind, space, plan), attributes)
    return found


def make_field(group, name, kind, chunk):
    """Make a dataset of fields without points.

    New chunks are not filled: the file has been made long enough before the index tells of them.

    Parameters
    ----------
    group : h5py.h5g.GroupID, which gets it
    name : str
    kind : str, NumPy's type of the numbers
    chunk : tuple of int, (points, *shape of a field)
    """
    from ..system.hdf5 import h5py

    space = h5py.h5s.create_simple((0, *chunk[1:]), (h5py.h5s.UNLIMITED, *chunk[1:]))
    plan, kind = h5py.h5p.create(h5py.h5p.DATASET_CREATE), np.dtype(kind)
    plan.set_chunk(chunk)
    plan.set_fill_value(np.array(np.nan, kind))
    plan.set_obj_track_times(False)
    plan.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    h5py.h5d.create(group, name.encode(), h5py.h5t.py_create(kind), space, plan)


def put_rows(branch, first, count, rows):
    """Write rows.

    Parameters
    ----------
    branch : h5py.h5g.GroupID, the group of the columns
    first, count : int, number of the first row, from 1 on, and how many there are
    rows : dict, name -> array (count, ...)
    """
    from ..system.hdf5 import h5py

    place = h5py.h5s.create_simple((first - 1 + count,))
    place.select_hyperslab((first - 1,), (count,))
    whole = h5py.h5s.create_simple((count,))
    for name, values in rows.items():
        column = h5py.h5d.open(branch, name.encode())
        column.set_extent((first - 1 + count,))
        column.write(whole, place, values)
