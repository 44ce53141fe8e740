"""The journal of an archive: points that its file does not hold yet, appended by one write each.

The file ``RUN.h5.journal`` beside ``RUN.h5`` begins with a line that names its format and the
archive it belongs to. An entry is the number of its point, the size and the CRC-32 of what follows,
a line of JSON that tells names, types and shapes of arrays, and their bytes. What an interrupted
write leaves behind, or another archive, is no entry.
"""

import contextlib
import errno
import fcntl
import json
import os
import struct
import zlib
from functools import lru_cache
from pathlib import Path

import numpy as np

from .files import ArchiveError, shared

BATCH, MOST = 64, 32 << 20
"""Points that wait in the journal at most, and bytes that it grows to."""
SUFFIX = ".journal"
HEADING = "contactsnes journal 1 of "
FLAGS = os.O_RDWR | os.O_APPEND
ENTRY = struct.Struct("<QQI")
"""Point, size of what follows, and its CRC-32."""
LARGE = 2 ** 16
"""Bytes of an array from which it is not copied before it is joined to others."""


def beside(archive):
    """The path of the journal of an archive; of a folder without a name, too, which is refused
    elsewhere."""
    return Path(archive).parent / (Path(archive).name + SUFFIX)


def next_key(key):
    """The key of the run that goes on with an archive: of its journal, since the run before may be
    going on as well, and its points are others."""
    return f"{archive_of(key)}-{os.urandom(4).hex()}"


def archive_of(key):
    """What all runs of an archive have in common of their keys."""
    return str(key).partition("-")[0]


class Journal:
    """A journal that is being written.

    Parameters
    ----------
    path : of its file, which is made anew with the first entry
    key : text, which the archive has, too
    """

    def __init__(self, path, key):
        self.path = path
        self.key = key
        self._file = None
        self.size = 0

    def append(self, point, arrays):
        """Add the arrays (name -> array of numbers or text) of a point; OSError where the disk
        does not take them, ArchiveError where another program writes there, too."""
        if self._file is None:
            self._file = os.open(self.path, FLAGS | os.O_CREAT, 0o666)
            _take(self._file, self.path)
            os.ftruncate(self._file, 0)
        found = os.fstat(self._file)
        if not found.st_nlink or found.st_size != self.size:
            raise _shared(self.path)
        if not self.size:  # new, or one that did not take its heading before
            self._write(_heading(self.key))
        self._write(encoded(point, arrays))

    def _write(self, data):
        """Write everything, or nothing."""
        done = 0
        try:
            while done < len(data):
                done += os.write(self._file, data[done:])
        except OSError:
            os.ftruncate(self._file, self.size)
            raise
        self.size += len(data)

    def check_free(self):
        """ArchiveError while another program, which is running, has points in the file."""
        try:
            file = os.open(self.path, FLAGS)
        except OSError:  # there is none, or one that is not to be written
            return
        try:
            _take(file, self.path)
        finally:
            os.close(file)

    def remove(self):
        """Take the file away: the archive holds what was in it."""
        if self._file is not None:
            os.close(self._file)
            self._file = None
        self.size = 0
        with contextlib.suppress(FileNotFoundError):
            os.unlink(self.path)


def _take(file, path):
    """Lock an open journal until it is closed; ArchiveError where another program has. What knows
    no locks has none."""
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in (errno.EACCES, errno.EAGAIN):
            raise _shared(path) from None


def _shared(path):
    """The error to raise where two programs write one journal."""
    return shared(path.with_name(path.name.removesuffix(SUFFIX)))


def _heading(key):
    return f"{HEADING}{key}\n".encode()


def encoded(point, arrays, before=0):
    """An entry, a bytearray; ArchiveError for an array of objects.

    Parameters
    ----------
    point : int
    arrays : mapping of names to arrays
    before : int, bytes of room before the entry
    """
    values = list(map(np.asarray, arrays.values()))
    # (states of planes are large: no further copy is made of what is)
    data = bytearray().join([bytes(before + ENTRY.size), heading(dict(zip(arrays, values))), *[
        array.tobytes() if array.nbytes < LARGE else np.ravel(array).view("u1")
        for array in values]])
    with memoryview(data)[before + ENTRY.size:] as body:
        ENTRY.pack_into(data, before, point, len(body), zlib.crc32(body))
    return data


def heading(arrays):
    """The line that tells names, types and shapes of arrays (name -> array, perhaps `Parted`);
    ArchiveError for an array of objects."""
    values = arrays.values()
    return _head(tuple(arrays), tuple([array.dtype for array in values]),
                 tuple([array.shape for array in values]))


@lru_cache(maxsize=4)
def _head(names, kinds, shapes):
    """The line that tells names, types and shapes of arrays: that of one point is mostly that of
    the next."""
    for name, kind in zip(names, kinds):
        if kind.hasobject:
            raise ArchiveError(f"{name!r} is neither an array nor a number nor a text.")
    return json.dumps([*zip(names, [kind.str for kind in kinds], shapes)]).encode() + b"\n"


def decoded(data):
    """The arrays of an entry, name -> array."""
    head, _, rest = data.partition(b"\n")
    found, place = {}, 0
    for name, kind, shape in json.loads(head):
        size = int(np.prod(shape, dtype=int))
        kind = np.dtype(kind)
        found[name] = np.frombuffer(rest, kind, size, place).reshape(shape)
        place += size * kind.itemsize
    return found


def entries(path, key, first):
    """The whole entries of a journal, those of the points ``first``, ``first`` + 1, ... in order: a
    list of mappings of names to arrays; none where it is of another archive.

    Parameters
    ----------
    path : of the journal
    key : str, of its archive
    first : int, number of the first point
    """
    try:
        content = Path(path).read_bytes()
    except FileNotFoundError:
        return []
    heading = _heading(key)
    if not content.startswith(heading):
        return []
    place, found = len(heading), []
    while place < len(content):
        point, arrays, place = entry(content, place)
        if arrays is None:
            break
        if point == first + len(found):
            found.append(arrays)
    return found


def entry(content, place=0):
    """(point, arrays, place behind it) of the entry at a place of some bytes; no arrays, but None,
    of one that is not whole.

    Parameters
    ----------
    content : bytes
    place : int
    """
    if place + ENTRY.size > len(content):
        return 0, None, place
    point, size, sum_ = ENTRY.unpack_from(content, place)
    data = content[place + ENTRY.size:place + ENTRY.size + size]
    if len(data) < size or zlib.crc32(data) != sum_:
        return point, None, place
    return point, decoded(data), place + ENTRY.size + size
