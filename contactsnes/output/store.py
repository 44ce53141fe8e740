"""The file of an archive, which a run that is killed at any moment leaves whole.

It changes in two ways only. As long as there is room, points are written in place: first their
rows, fields and states, last the root attribute ``points``, which alone says how many rows count;
none of these writes moves or breaks anything that counts. When room is lacking, or an interrupted
write has left unknown things behind, the archive is written anew beside the file, with more room,
and takes its place by an atomic rename. In between the file is closed, so that other programs can
read it.
"""

import contextlib
import errno
import fcntl
import math
import os
import shutil

from ..system.devices import Lenient, reason
from . import stored
from .files import SAFE, WriteError, open_archive, opened, shared
from .journal import archive_of
from .layout import CHUNKS

ROOMY = 1 << 16
"""Bytes of a state up to which there is room for one four times as large: those of a line grow with
its contact, and a file written anew takes longer than all of a step."""

ZEROS = 1 << 22
"""Bytes of zeros that are written together."""


def unwritten(path, error):
    """The error to raise where a disk does not take what is written for an archive."""
    return WriteError(f"{path} cannot be written ({reason(error)}): make room, or name another "
                      "-archive_file.")


def _lengthen(path, more):
    """Make a file longer by so many bytes, which its disk has then; OSError where it has not."""
    with open(path, "rb+") as file:
        end = file.seek(0, os.SEEK_END)
        try:
            os.posix_fallocate(file.fileno(), end, more)
        # there are systems, and kinds of files, that have no such call
        except (AttributeError, OSError) as error:
            if getattr(error, "errno", errno.EOPNOTSUPP) not in (errno.EOPNOTSUPP, errno.EINVAL):
                raise
            for begin in range(0, more, ZEROS):
                file.write(bytes(min(ZEROS, more - begin)))


class Store:
    """The file of an archive that is being computed.

    Parameters
    ----------
    path : pathlib.Path
    layout : layout.Layout
    frame : function (file, slot, chunk) that writes everything but the points
    journal : journal.Journal, whose key the file is known by

    Attributes
    ----------
    held : int, points in the file
    room : int, points that it has room for as it is, 0 where that is not known
    """

    def __init__(self, path, layout, frame, journal):
        self.path = path
        self.layout = layout
        self.journal = journal
        self.held, self._made = 0, False  # whether the file is there
        self.room = 0
        self._slot = 0  # bytes of a state that it has room for
        self._frame = frame

    def put(self, points, then=lambda file: None):
        """Write points, a list of `stored.Kept`, and what ``then`` does to the file."""
        first = self.held + 1
        states = stored.packed(first, points)
        if self.layout.active is not None:
            self.layout.active.expect(points)

        def write(file):
            self.layout.put(file, first, points, states)
            then(file)

        self.commit(write, self.held + len(points), max(state.size for state in states.values()))
        self.held += len(points)

    def pack(self, write, points):
        """Let ``write`` act on the archive, written anew with its fields compressed; what is added
        later on makes a new one without."""
        self.room, self.layout.packed = 0, True
        if self.layout.active is not None:
            self.layout.active.coming = 0
        try:
            self._write_anew(write, points, 0)
        except (OSError, RuntimeError) as error:
            raise unwritten(self.path, error) from error
        finally:
            self.room, self.layout.packed = 0, False

    def commit(self, write, points=1, slot=0):
        """Let `write` act on the file in place if there is room, else on the archive written
        anew.

        Parameters
        ----------
        write : function (h5py.File)
        points : int, that the file has to have room for, those in it included
        slot : int, bytes of the largest state
        """
        # nothing is built upon what an interrupted write leaves behind
        room, self.room = self.room, 0
        file = None
        try:
            active = self.layout.active
            if points <= room and slot <= self._slot and (active is None or active.fits()):
                self._reserve(room // CHUNKS, points)
                # kept open by another program, which goes on to see the old file
                with contextlib.suppress(OSError):
                    file = opened(self.path, "r+")
            if file:
                with file:
                    self._check_alone(file)
                    write(file)
                self.room = room
            else:
                self._write_anew(write, points, slot)
        except (OSError, RuntimeError) as error:
            raise unwritten(self.path, error) from error

    def _reserve(self, chunk, points):
        """Lengthen the file by what so many points need: a full disk must show before HDF5 counts
        on the space."""
        chunks = -(-points // chunk) - -(-self.held // chunk)
        more = 0
        if self.layout.fields == "all" and chunks > 0:
            each = int(self.layout.kind[1:]) * chunk * math.prod(self.layout.shape)
            more = len(self.layout.arrays) * chunks * (each + SAFE["alignment_interval"])
        if self.layout.active is not None:
            more += self.layout.active.more()
        if more:
            _lengthen(self.path, more)

    def _write_anew(self, write, points, slot):
        """Copy the archive beside itself, with room for twice so many points, four times with all
        fields, which take long to copy; let `write` act on it; put it in place."""
        from ..system.hdf5 import h5py

        partial = self.path.with_name(self.path.name + ".partial")
        taken = self._taken(partial)
        try:
            with Lenient(partial) as device, h5py.File(device, "w", **SAFE) as new:
                there = self._made or self.held
                with open_archive(self.path) if there else contextlib.nullcontext() as old:
                    if old:
                        self._check_alone(old)
                    if not self.held:
                        old = None
                    states = stored.held_states(old, self.held) if old else {}
                    slot = max([slot, *(state.size for state in states.values())])
                    if not self.layout.packed:
                        slot = max(slot * 3 // 2, min(slot * 4, ROOMY))
                    chunk = self.layout.at_once((4 if self.layout.fields == "all" else 2) * points)
                    self._frame(new, slot, chunk)
                    if old:
                        self.layout.copy(old, new, states)
                write(new)
            device.check()
            with open(partial, "rb+") as file:
                os.fsync(file.fileno())
            # who may read and write it stays
            with contextlib.suppress(OSError):
                shutil.copymode(self.path, partial)
            os.replace(partial, self.path)
        except BaseException:
            with contextlib.suppress(OSError):
                partial.unlink()
            raise
        finally:
            os.close(taken)
        self._made, self.room, self._slot = True, chunk * CHUNKS, slot

    def _taken(self, partial):
        """The number of a file that is locked until it is closed; raise where another program has,
        which is about to put it in place. What knows no locks has none; one of POSIX, as a journal
        has, would end where any other opening of the file is closed."""
        number = os.open(partial, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            moved = not (partial.exists() and os.path.samestat(os.fstat(number), partial.stat()))
        except OSError as error:
            moved = error.errno in (errno.EACCES, errno.EAGAIN)
        if moved:
            os.close(number)
            raise shared(self.path)
        return number

    def _check_alone(self, file):
        """Raise if the file is not that of this archive, with the points that this run wrote."""
        ours, theirs = map(archive_of, (self.journal.key, file.attrs.get("journal", "")))
        if file.attrs["points"] != self.held or theirs not in ("", ours):
            raise shared(self.path)
