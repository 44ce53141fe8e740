"""Archives of branches: HDF5 files to which a run adds point by point, and which h5py alone can
read.

A run may be killed at any moment, so a file changes in two ways only. As long as there is room, a
point is written in place: first its row, fields and state, last the root attribute ``points``,
which alone says how many rows count; none of these writes moves or breaks anything that counts.
When room is lacking, or an interrupted write has left unknown things behind, the archive is written
anew beside the file, with more room, and takes its place by an atomic rename. Between points the
file is closed, so that other programs can read it.
"""

import contextlib
import math
import os

import h5py

from ..system.devices import Lenient, reason
from . import checksums, resuming, stored
from .files import (
    FORMAT,
    ArchiveError,
    WriteError,
    check_folder,
    check_new,
    open_archive,
    opened,
    resolved,
    safely,
)
from .layout import CHUNKS, Layout
from .reading import read


class Archive:
    """Archive of a branch that is being computed, made by `create` or `resume`.

    Parameters
    ----------
    path : path of the file, in an existing folder
    scene : mapping of numbers and strings (None is left out): what must be the same when the run is
        resumed
    options : str, the whole options database; start and legs that are done, too, must be the same
        when resumed
    versions : mapping of a program's name to its version
    columns : mapping of a column's name to its `Column`
    fields : {'none', 'last', 'all'}, the points whose displacement and traction are kept
    coordinates : tuple of one or two arrays, the nodes along x (and y); fields need them
    components : int, components of displacement and traction
    initial_gap : array of the grid's shape, optional; kept beside the coordinates
    modes : bool, whether the fields of a point include its leading mode
    units : mapping, optional, units of fields other than `layout.UNITS`
    warnings : sequence of str, optional, sentences to beware of; kept as the root attribute
        ``warnings``

    Attributes
    ----------
    points : int, points that are safely in the file
    complete : bool, whether the path was followed to its regular end (`finish`), and has no more to
        offer
    runs : list of `resuming.Run`, those before this one
    """

    def __init__(self, path, *, scene, options, versions, columns, fields="none", coordinates=None,
                 components=1, initial_gap=None, modes=False, units=None, warnings=()):
        self._layout = Layout(columns, fields, coordinates, components, initial_gap, modes, units)
        self.path = resolved(path)
        self.points = 0
        self.complete = False
        self.runs = []
        self._first = 0  # point of this run
        self._warnings = "\n".join(warnings)
        self._options = options
        self._versions = "\n".join(f"{name} {value}" for name, value in versions.items())
        self._scene = {name: value for name, value in scene.items() if value is not None}
        # points, and bytes of a state, that the file has room for as it is
        self._room, self._slot = 0, 0

    @classmethod
    def create(cls, path, *, overwrite=False, **content):
        """New archive without points; `content` as for the class.

        Raises
        ------
        ArchiveError
            If the file exists and is not to be overwritten or is no archive; if the folder is
            missing or read-only.
        """
        archive = cls(path, **content)
        check_new(archive.path, overwrite)
        archive._commit(lambda file: None)
        return archive

    @classmethod
    def resume(cls, path, **content):
        """Archive to go on from, or a new one where there is none or none with points; `content` as
        for the class.

        Raises
        ------
        ArchiveError
            If the file is no archive, or one of another scene or grid, other legs that are done, or
            other columns or fields.
        """
        archive = cls(path, **content)
        if not archive.path.is_file():
            return cls.create(path, **content)
        check_folder(archive.path)
        if read(archive.path).points:
            safely(archive.path, archive._take_over)
        return archive if archive.points else cls.create(path, overwrite=True, **content)

    def append(self, row, state, displacement=None, traction=None, mode=None):
        """Add a point; when this returns, it survives a kill of the program.

        Parameters
        ----------
        row : mapping with one value for each column, of an enumeration a name or its number
        state : mapping of arrays, numbers and strings: what a resumed run needs; kept for the last
            four points
        displacement, traction : (components, *grid) arrays, used if the archive keeps fields
        mode : the same, if it keeps modes and the point has one
        """
        if self.complete:
            raise ArchiveError(f"{self.path} is complete; no point can be added.")
        layout, place = self._layout, self.points + 1
        row, state = layout.numbers(row), stored.pack(place, state)
        fields = layout.checked({"displacement": displacement, "traction": traction, "mode": mode})
        self._commit(lambda file: layout.put(file, place, row, state, fields), place, state.size)
        self.points += 1

    def finish(self):
        """Mark the archive as complete: the path was followed to its regular end."""
        if self.complete:
            return
        self._commit(lambda file: file.attrs.modify("complete", True), self.points)
        self.complete = True

    def states(self):
        """States of the last points (up to four), oldest first, as they were given to `append`."""
        states = safely(self.path, lambda file: [
            stored.unpack(state) for state in stored.states(file, self.points).values()])
        if self.points and not states:
            raise ArchiveError(
                f"{self.path} cannot be resumed: the state of its last point is lost.")
        return states

    def _take_over(self, file):
        """Go on from the points of a file; raise if they belong to another run than this archive
        describes."""
        self.points, self.runs = int(file.attrs["points"]), resuming.runs(file)
        self._first = self.points
        last = [{}, *map(stored.unpack, stored.states(file, self.points).values())][-1]
        done = int(file["branch/leg"][self.points - 1]) - (last.get("position") != 1.0)
        self._refuse(resuming.differences(dict(file["scene"].attrs), file.attrs["options"],
                                          self._scene, self._options, done))
        more = resuming.has_more(file.attrs["options"], self._options, last.get("event"))
        self.complete = bool(file.attrs["complete"]) and not more
        if self.complete:
            return
        self._check_layout(file)
        told = file.attrs.get("warnings", "").splitlines()
        self._warnings = "\n".join([*told, *(line for line in self._warnings.splitlines()
                                             if line not in told)])
        for name in set(file.get("fields", ())) & {"displacement", "traction", "mode"}:
            for point in stored.field_points(file):
                stored.field(file, name, point)  # what is copied later on has to be whole

    def _check_layout(self, file):
        """Raise if a file keeps other fields or columns than this run; keep modes if it does."""
        kept = file.attrs["fields"]
        if kept != self._layout.fields:
            self._refuse([("archive_fields", kept, self._layout.fields)])
        columns = sorted(set(file["branch"]) ^ set(self._layout.columns))
        if columns or tuple(file.attrs["shape"]) != self._layout.shape:
            raise ArchiveError(f"{self.path} cannot be resumed: its columns or "
                               "its grid are not those of this run "
                               f"({', '.join(columns) or self._layout.shape}); name another "
                               "-archive_file.")
        if "mode" in file.get("fields", ()) and "mode" not in self._layout.arrays:
            self._layout.arrays = (*self._layout.arrays, "mode")

    def _refuse(self, differences):
        """Raise for the first of some differences, (name, there, here)."""
        for name, old, new in differences:
            raise ArchiveError(f"{self.path} cannot be resumed: {name} is "
                               f"{old} there and {new} here; name another "
                               "-archive_file, or replace this one with "
                               "-archive_overwrite.")

    def _commit(self, write, points=1, slot=0):
        """Let `write` act on the file in place if there is room, else on the archive written
        anew."""
        # nothing is built upon what an interrupted write leaves behind
        room, self._room = self._room, 0
        file = None
        try:
            if points <= room and slot <= self._slot:
                self._reserve(room // CHUNKS)
                # kept open by another program, which goes on to see the old file
                with contextlib.suppress(OSError):
                    file = opened(self.path, "r+")
            if file:
                with file:
                    self._check_alone(file)
                    write(file)
                self._room = room
            else:
                self._write_anew(write, slot)
        except (OSError, RuntimeError) as error:
            raise WriteError(f"{self.path} cannot be written ({reason(error)}): "
                             "make room, or name another -archive_file.") from error

    def _reserve(self, chunk):
        """Lengthen the file by what the next point needs: a full disk must show before HDF5 counts
        on the space."""
        if self._layout.fields == "all" and self.points % chunk == 0:
            with open(self.path, "rb+") as file:
                file.seek(0, os.SEEK_END)
                numbers = len(self._layout.arrays) * chunk * math.prod(self._layout.shape)
                file.write(bytes(8 * numbers))

    def _write_anew(self, write, slot):
        """Copy the archive beside itself, with room for twice its points; let `write` act on it;
        put it in place."""
        partial = self.path.with_name(self.path.name + ".partial")
        try:
            with Lenient(partial) as device, h5py.File(device, "w", libver="earliest") as new:
                with open_archive(self.path) if self.points else contextlib.nullcontext() as old:
                    if old:
                        self._check_alone(old)
                    states = stored.states(old, self.points) if old else {}
                    slot = max([slot, *(state.size for state in states.values())]) * 3 // 2
                    chunk = max(1, -(-2 * self.points // CHUNKS))
                    self._write_frame(new, slot, chunk)
                    if old:
                        self._layout.copy(old, new, states)
                write(new)
            device.check()
            with open(partial, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(partial, self.path)
        finally:
            with contextlib.suppress(OSError):
                partial.unlink()
        self._room, self._slot = chunk * CHUNKS, slot

    def _check_alone(self, file):
        """Raise if the file does not hold the points that this run wrote."""
        if file.attrs["points"] != self.points:
            raise ArchiveError(
                f"{self.path} has been changed by another program, which may still be running.")

    def _write_frame(self, file, slot, chunk):
        """Everything but the points."""
        file.attrs.update({"format": FORMAT, "points": 0, "complete": False,
                           "options": self._options, "versions": self._versions,
                           "warnings": self._warnings, "fields": self._layout.fields,
                           "shape": self._layout.shape})
        file.create_group("scene").attrs.update(self._scene)
        runs = [*(run for run in self.runs if run.first < self._first),
                resuming.Run(self._first, self._options, self._versions)]
        for name, values in zip(resuming.Run._fields, zip(*runs)):
            file[f"runs/{name}"] = values
        self._layout.make(file, slot, chunk)
        file.attrs["frame"] = checksums.frame(file)
