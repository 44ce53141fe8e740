"""What an open archive holds of its points besides their rows: fields, and states to go on from."""

import io
import itertools
import struct
import zlib
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..grid.parted import Parted, blocks, pieces
from . import active, checksums
from .files import ArchiveError
from .journal import ENTRY, beside, encoded, entries, entry, heading

STATES = 4
"""States that are kept: what a predictor may extrapolate from."""

HEAD = struct.Struct("<qq")
"""Point and size of a packed state."""
ZIPPED = b"PK"
"""How the states of older programs begin: they are .npz files."""

SLOTS = STATES + 1
"""One more, so that a new state never overwrites one that counts."""

FEW = 2 ** 16
"""Bytes of an array of a state up to which it is written with others."""

ARRAYS = "displacement", "traction", "mode"
"""Fields of the cell, in the order of their checksums."""


class Fields:
    """Fields of the points of an open archive, each held against its checksum; archives of older
    programs have none.

    Parameters
    ----------
    file : h5py.File

    Attributes
    ----------
    points : points (from 0) whose fields are stored, as of `field_points`
    """

    def __init__(self, file):
        self._file, self.points = file, field_points(file)
        stored = file.get("fields", {})
        self._arrays = {name: stored[name] for name in ARRAYS if name in stored}
        self._active = active.datasets(file) if has_active(file) else {}
        names = ("active", "mode") if self._active else ARRAYS
        self._sums = file.get("checksums")
        columns = 0 if self._sums is None else self._sums.shape[1]
        self._column = dict(zip(names, range(1, columns)))

    def field(self, name, point):
        """A field of a point, (components, *grid).

        Parameters
        ----------
        name : {'displacement', 'traction', 'mode'}
        point : int, from 0

        Raises
        ------
        ArchiveError
            If the point has no fields there, or the field is not the one that was written.
        """
        found = self._arrays[name][self._place(point)]
        self._check(name, point, checksums.of(found))
        return found

    def on_active(self, point):
        """What is kept of a point on active nodes, name -> array; ArchiveError as of `field`."""
        found = active.kept(self._active, self._place(point))
        self._check("active", point, active.checksum(found))
        return found

    def check(self):
        """ArchiveError, as of `field`, unless all fields are those that were written."""
        for point in self.points:
            for name in self._arrays:
                self.field(name, point)
            if self._active:
                self.on_active(point)

    def _place(self, point):
        if point not in self.points:
            raise ArchiveError(f"{self._file.filename} keeps no fields of point {point} any more: "
                               "its run has gone on since it was read; read it again.")
        return self.points.index(point)

    def _check(self, name, point, found):
        if name in self._column and self._sums[point, self._column[name]] != found:
            raise ArchiveError(f"{self._file.filename} is damaged: the checksum of {name} "
                               f"at point {point} is not that of what it holds.")


def has_active(file):
    """Whether the fields of an open archive are those on active nodes."""
    return "active" in file.get("fields", ())


def field_points(file):
    """Points (from 0) whose fields are stored, in the order of storage: a sequence, of all points a
    range, which is not gone through."""
    points, fields = int(file.attrs["points"]), file.attrs["fields"]
    if fields == "last":
        point = int(file["fields"].attrs["point"])
        return [point - 1] if 0 < point <= points else []
    return range(points) if fields == "all" else []


def states(file, points):
    """Packed states of the last of so many points, oldest first: point (from 1) -> bytes."""
    return {point: slot[:size] for point, (slot, size) in _slots(file, points).items()}


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


class Held:
    """A packed state in the slot of an open archive, taken in pieces.

    Parameters
    ----------
    slot : h5py.Dataset
    size : int, bytes
    """

    def __init__(self, slot, size):
        self._slot, self.size = slot, size

    def pieces(self):
        """(slice, bytes there) of the state."""
        for where, in pieces((self.size,)):
            yield where, self._slot[where]


class Streamed:
    """A packed state whose arrays processes have parts of, made in pieces.

    Parameters
    ----------
    point : int
    state : mapping
    """

    def __init__(self, point, state):
        self._point, self._arrays = point, {
            name: value if isinstance(value, Parted) else np.asarray(value)
            for name, value in state.items()}
        self._head = heading(self._arrays)
        self.size = HEAD.size + ENTRY.size + len(self._head) + sum(
            array.size * array.dtype.itemsize for array in self._arrays.values())

    def pieces(self):
        """(slice, bytes there) of the state; last those that make it count."""
        place, sum_ = HEAD.size + ENTRY.size, 0
        parts = (block for array in self._arrays.values() for _, block in blocks(array))
        for data in _joined(itertools.chain([np.frombuffer(self._head, "u1")], parts)):
            yield slice(place, place + data.size), data
            place, sum_ = place + data.size, zlib.crc32(data, sum_)
        body = self.size - HEAD.size - ENTRY.size
        start = HEAD.pack(self._point, self.size) + ENTRY.pack(self._point, body, sum_)
        yield slice(0, len(start)), np.frombuffer(start, "u1")


def _joined(parts):
    """The bytes of arrays, one after the other, those of small ones together: to write some takes
    HDF5 a tenth of a millisecond, however few they are."""
    few = []
    for part in parts:
        data = np.ascontiguousarray(part).reshape(-1).view("u1")
        if data.size <= FEW:
            few.append(data)
            continue
        if few:
            yield np.concatenate(few)
            few = []
        yield data
    if few:
        yield np.concatenate(few)


def put_state(slot, state):
    """Write a packed state (bytes, `Held` or `Streamed`) into its slot, a dataset."""
    for where, data in ([(slice(0, state.size), state)] if isinstance(state, np.ndarray)
                        else state.pieces()):
        slot[where] = data


def held_states(file, points):
    """`states`, each `Held`."""
    return {point: Held(*slot) for point, slot in _slots(file, points).items()}


def _slots(file, points):
    """Point (from 1) -> (dataset, bytes) of the states of the last of so many points, oldest
    first."""
    kept = {}
    for point in range(max(1, points - STATES + 1), points + 1):
        slot = file.get(f"states/{point % SLOTS}")
        label, size = slot[:16].view("<i8") if slot is not None else (0, 0)
        if label == point:
            kept[point] = slot, int(size)
    return kept


def packed(first, points):
    """Packed states of the last of some points, the first of which has the number ``first``: number
    -> bytes."""
    numbered = list(enumerate(points, first))[-STATES:]
    return {number: pack(number, point.state) for number, point in numbered}


def has_parts(arrays):
    """Whether processes have parts of an array of a mapping, as of a state."""
    return any(isinstance(value, Parted) for value in arrays.values())


def pack(point, state):
    """The state of a point as bytes, or `Streamed`: point, size, and an entry of a journal, which
    has a checksum; ArchiveError for a state of objects."""
    if has_parts(state):
        return Streamed(point, state)
    data = encoded(point, state, HEAD.size)
    HEAD.pack_into(data, 0, point, len(data))
    return np.frombuffer(data, "u1")


def unpacked(file, points):
    """`states`, each as `pack` was given it; ArchiveError, which names the file, for a damaged
    one."""
    try:
        return {number: unpack(state) for number, state in states(file, points).items()}
    except ArchiveError as error:
        raise ArchiveError(f"{file.filename} is damaged: {error}; its points can be read, and no "
                           "run goes on from them.") from None


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
