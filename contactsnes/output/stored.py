"""What an open archive holds of its points besides their rows: fields, and states to go on from."""

import io
import struct
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from . import active, checksums
from .files import ArchiveError
from .journal import beside, encoded, entries, entry

STATES = 4
"""States that are kept: what a predictor may extrapolate from."""

HEAD = struct.Struct("<qq")
"""Point and size of a packed state."""
ZIPPED = b"PK"
"""How the states of older programs begin: they are .npz files."""

SLOTS = STATES + 1
"""One more, so that a new state never overwrites one that counts."""


def field(file, name, point):
    """A field of a point, (components, *grid), in an open archive.

    Parameters
    ----------
    file : h5py.File
    name : {'displacement', 'traction', 'mode'}
    point : int, from 0

    Raises
    ------
    ArchiveError
        If the point has no fields there, or the field is not the one that was written.
    """
    stored = field_points(file)
    if point not in stored:
        raise ArchiveError(f"{file.filename} keeps no fields of point {point}.")
    found = file["fields"][name][stored.index(point)]
    _check(file, name, point, checksums.of(found))
    return found


def on_active(file, point):
    """What an open archive keeps of a point on active nodes, name -> array; ArchiveError as of
    `field`."""
    stored = field_points(file)
    if point not in stored:
        raise ArchiveError(f"{file.filename} keeps no fields of point {point}.")
    found = active.kept(file, stored.index(point))
    _check(file, "active", point, active.checksum(found))
    return found


def _check(file, name, point, found):
    """ArchiveError where the checksum of a point's field is not the one found; archives of older
    programs have none."""
    names = ("active", "mode") if has_active(file) else ("displacement", "traction", "mode")
    sums = dict(zip(names, file["checksums"][point, 1:])) if "checksums" in file else {}
    if sums.get(name, found) != found:
        raise ArchiveError(f"{file.filename} is damaged: the checksum of {name} "
                           f"at point {point} is not that of what "
                           "it holds.")


def has_active(file):
    """Whether the fields of an open archive are those on active nodes."""
    return "active" in file.get("fields", ())


def field_points(file):
    """Points (from 0) whose fields are stored, in the order of storage."""
    points, fields = int(file.attrs["points"]), file.attrs["fields"]
    if fields == "last":
        point = int(file["fields"].attrs["point"])
        return [point - 1] if 0 < point <= points else []
    return list(range(points)) if fields == "all" else []


def states(file, points):
    """Packed states of the last of so many points, oldest first: point (from 1) -> bytes."""
    kept = {}
    for point in range(max(1, points - STATES + 1), points + 1):
        slot = file.get(f"states/{point % SLOTS}")
        label, size = slot[:16].view("<i8") if slot is not None else (0, 0)
        if label == point:
            kept[point] = slot[:size]
    return kept


class Kept(NamedTuple):
    """What an archive keeps of a point.

    row : mapping of columns to numbers
    state : mapping of arrays, numbers and texts, to go on from
    fields : mapping of fields to (components, *grid) arrays
    """

    row: Mapping
    state: Mapping
    fields: Mapping

    def arrays(self):
        """All of it as one mapping, for the journal."""
        return {f"{part} {name}": value for part, values in zip(self._fields, self)
                for name, value in values.items()}

    @classmethod
    def of(cls, arrays):
        """The point that such a mapping was made of."""
        parts = {part: {} for part in cls._fields}
        for key, value in arrays.items():
            part, _, name = key.partition(" ")
            parts[part][name] = value if value.ndim else value[()]
        return cls(**parts)


def waiting(file):
    """The points of an open archive that are in its journal yet, a list of `Kept`."""
    path, key = beside(file.filename), file.attrs.get("journal", "")
    return [Kept.of(arrays) for arrays in entries(path, key, int(file.attrs["points"]) + 1)]


def packed(first, points):
    """Packed states of the last of some points, the first of which has the number ``first``: number
    -> bytes."""
    numbered = list(enumerate(points, first))[-STATES:]
    return {number: pack(number, point.state) for number, point in numbered}


def pack(point, state):
    """The state of a point as bytes: point, size, and an entry of a journal, which has a checksum;
    ArchiveError for a state of objects."""
    data = encoded(point, state, HEAD.size)
    HEAD.pack_into(data, 0, point, len(data))
    return np.frombuffer(data, "u1")


def unpack(packed):
    """The state that `pack` made bytes of; ArchiveError where they are others."""
    data = packed[16:].tobytes()
    if data.startswith(ZIPPED):
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            return {name: array if array.ndim else array.item() for name, array in arrays.items()}
    _, arrays, _ = entry(data)
    if arrays is None:
        raise ArchiveError("the checksum of a state is not that of what is stored")
    return {name: array if array.ndim else array.item() for name, array in arrays.items()}
