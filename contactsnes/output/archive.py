"""Archives of branches: HDF5 files to which a run adds point by point, and which h5py alone can
read.

A run may be killed at any moment, so a file changes in two ways only. As long as there is room, a
point is written in place: first its row, fields and state, last the root attribute ``points``,
which alone says how many rows count; none of these writes moves or breaks anything that counts.
When room is lacking, or an interrupted write has left unknown things behind, the archive is written
anew beside the file, with more room, and takes its place by an atomic rename. Between points the
file is closed, so that other programs can read it.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from ..system.devices import Lenient, failure, reason
from . import checksums, resuming

FORMAT = "contactsnes 1"
UNITS = {
    "coordinates": "beta",
    "initial_gap": "u_n,r",
    "displacement": "u_n,r; u_t,r",
    "traction": "p_n,r; p_t,r",
    "mode": "",
}  # of the fields, for dimensionless scenes
_STATES = 4  # states that are kept: what a predictor may extrapolate from
_SLOTS = _STATES + 1  # one more, so that a new state never overwrites one that counts
# what one node of HDF5's chunk index holds; splitting a node is not safe against a kill
_CHUNKS = 64
_PATIENCE = 1.0  # seconds to wait for another program that is just reading or writing the file


class ArchiveError(ValueError):
    """An archive that cannot be written, read or continued; the message is one sentence for the
    user."""


class WriteError(ArchiveError):
    """An archive that its disk does not take."""


class Column(NamedTuple):
    """What a column of the branch holds: its unit, its NumPy type and, of an enumeration, the names
    of 0, 1, ..."""

    unit: str
    kind: str = "f8"
    names: tuple[str, ...] = ()


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
    units : mapping, optional, units of fields other than `UNITS`
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
                 components=1, initial_gap=None, modes=False, units=UNITS, warnings=()):
        if fields not in ("none", "last", "all"):
            raise ArchiveError(f"-archive_fields is {fields!r}; it can be none, last or all.")
        if fields != "none" and not coordinates:
            raise ArchiveError(f"Fields ({fields}) need coordinates.")
        self.path = _resolved(path)
        self.points = 0
        self.complete = False
        self.runs = []
        self._first = 0  # point of this run
        self._warnings = "\n".join(warnings)
        self._options = options
        self._versions = "\n".join(f"{name} {value}" for name, value in versions.items())
        self._scene = {name: value for name, value in scene.items() if value is not None}
        self._columns = {name: Column(*column) for name, column in columns.items()}
        self._arrays = () if fields == "none" else ("displacement", "traction",
                                                    *(("mode",) if modes else ()))
        self._fields = fields
        self._units = {**UNITS, **units}
        self._initial_gap = initial_gap
        self._coordinates = dict(zip("xy", coordinates or ()))
        self._shape = (components, *(len(array) for array in self._coordinates.values()))
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
        _check_folder(archive.path)
        if archive.path.exists():
            if not archive.path.is_file():
                raise ArchiveError(f"{path}: there is no such file, but a "
                                   "folder or a device; name another "
                                   "-archive_file.")
            if not overwrite:
                raise ArchiveError(f"{path} exists: -archive_resume goes on from "
                                   "it, -archive_overwrite replaces it, another "
                                   "-archive_file leaves it alone.")
            _open_archive(archive.path).close()  # what is no archive is not ours to destroy
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
        _check_folder(archive.path)
        if read(archive.path).points:
            _safely(archive.path, archive._take_over)
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
        row, state = self._numbers(row), _pack(self.points + 1, state)
        given = {"displacement": displacement, "traction": traction, "mode": mode}
        fields = {name: given[name] for name in self._arrays if name != "mode" or mode is not None}
        for name, array in fields.items():
            if np.shape(array) != self._shape:
                raise ArchiveError(
                    f"{name} has the shape {np.shape(array)}; the archive keeps {self._shape}.")
        self._commit(lambda file: self._put(file, row, state, fields), self.points + 1, state.size)
        self.points += 1

    def finish(self):
        """Mark the archive as complete: the path was followed to its regular end."""
        if self.complete:
            return
        self._commit(lambda file: file.attrs.modify("complete", True), self.points)
        self.complete = True

    def states(self):
        """States of the last points (up to four), oldest first, as they were given to `append`."""
        states = _safely(self.path, lambda file: [_unpack(state)
                                                  for state in self._kept(file).values()])
        if self.points and not states:
            raise ArchiveError(
                f"{self.path} cannot be resumed: the state of its last point is lost.")
        return states

    def _take_over(self, file):
        """Go on from the points of a file; raise if they belong to another run than this archive
        describes."""
        self.points, self.runs = int(file.attrs["points"]), resuming.runs(file)
        self._first = self.points
        last = [{}, *map(_unpack, self._kept(file).values())][-1]
        done = int(file["branch/leg"][self.points - 1]) - (last.get("position") != 1.0)
        self._refuse(resuming.differences(dict(file["scene"].attrs), file.attrs["options"],
                                          self._scene, self._options, done))
        more = resuming.has_more(file.attrs["options"], self._options, last.get("event"))
        self.complete = bool(file.attrs["complete"]) and not more
        if self.complete:
            return
        self._refuse([("archive_fields", file.attrs["fields"], self._fields)]
                     * (file.attrs["fields"] != self._fields))
        columns = sorted(set(file["branch"]) ^ set(self._columns))
        if columns or tuple(file.attrs["shape"]) != self._shape:
            raise ArchiveError(f"{self.path} cannot be resumed: its columns or "
                               "its grid are not those of this run "
                               f"({', '.join(columns) or self._shape}); name another "
                               "-archive_file.")
        told = file.attrs.get("warnings", "").splitlines()
        self._warnings = "\n".join([*told, *(line for line in self._warnings.splitlines()
                                             if line not in told)])
        if "mode" in file.get("fields", ()) and "mode" not in self._arrays:
            self._arrays = (*self._arrays, "mode")
        for name in set(file.get("fields", ())) & {"displacement", "traction", "mode"}:
            for point in _field_points(file):
                _field(file, name, point)  # what is copied later on has to be whole

    def _refuse(self, differences):
        """Raise for the first of some differences, (name, there, here)."""
        for name, old, new in differences:
            raise ArchiveError(f"{self.path} cannot be resumed: {name} is "
                               f"{old} there and {new} here; name another "
                               "-archive_file, or replace this one with "
                               "-archive_overwrite.")

    def _numbers(self, row):
        """The row with enumerations as numbers."""
        if set(row) != set(self._columns):
            raise ArchiveError("A row has one value for each column; not so: "
                               f"{sorted(set(row) ^ set(self._columns))}.")
        numbers = dict(row)
        for name, column in self._columns.items():
            if isinstance(row[name], str):
                if row[name] not in column.names:
                    raise ArchiveError(
                        f"{name} cannot be {row[name]!r}; it can be one of {column.names}.")
                numbers[name] = column.names.index(row[name])
        return numbers

    def _commit(self, write, points=1, slot=0):
        """Let `write` act on the file in place if there is room, else on the archive written
        anew."""
        # nothing is built upon what an interrupted write leaves behind
        room, self._room = self._room, 0
        file = None
        try:
            if points <= room and slot <= self._slot:
                self._reserve(room // _CHUNKS)
                # kept open by another program, which goes on to see the old file
                with contextlib.suppress(OSError):
                    file = _open(self.path, "r+")
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
        if self._fields == "all" and self.points % chunk == 0:
            with open(self.path, "rb+") as file:
                file.seek(0, os.SEEK_END)
                file.write(bytes(len(self._arrays) * 8 * chunk * math.prod(self._shape)))

    def _write_anew(self, write, slot):
        """Copy the archive beside itself, with room for twice its points; let `write` act on it;
        put it in place."""
        partial = self.path.with_name(self.path.name + ".partial")
        try:
            with Lenient(partial) as device, h5py.File(device, "w", libver="earliest") as new:
                with _open_archive(self.path) if self.points else contextlib.nullcontext() as old:
                    if old:
                        self._check_alone(old)
                    states = self._kept(old) if old else {}
                    slot = max([slot, *(state.size for state in states.values())]) * 3 // 2
                    chunk = max(1, -(-2 * self.points // _CHUNKS))
                    self._write_frame(new, slot, chunk)
                    if old:
                        self._copy(old, new, states)
                write(new)
            device.check()
            with open(partial, "rb+") as file:
                os.fsync(file.fileno())
            os.replace(partial, self.path)
        finally:
            with contextlib.suppress(OSError):
                partial.unlink()
        self._room, self._slot = chunk * _CHUNKS, slot

    def _check_alone(self, file):
        """Raise if the file does not hold the points that this run wrote."""
        if file.attrs["points"] != self.points:
            raise ArchiveError(
                f"{self.path} has been changed by another program, which may still be running.")

    def _write_frame(self, file, slot, chunk):
        """Everything but the points."""
        file.attrs.update({"format": FORMAT, "points": 0, "complete": False,
                           "options": self._options, "versions": self._versions,
                           "warnings": self._warnings, "fields": self._fields,
                           "shape": self._shape})
        file.create_group("scene").attrs.update(self._scene)
        runs = [*(run for run in self.runs if run.first < self._first),
                resuming.Run(self._first, self._options, self._versions)]
        for name, values in zip(resuming.Run._fields, zip(*runs)):
            file[f"runs/{name}"] = values
        branch = file.create_group("branch")
        for name, (unit, kind, names) in self._columns.items():
            # One chunk for all rows there is room for: a new row allocates nothing.
            column = branch.create_dataset(name, (0,), "i1" if names else kind,
                                           chunks=(chunk * _CHUNKS,), maxshape=(None,))
            column.attrs["unit"] = unit
            if names:
                column.attrs["names"] = list(names)
        for number in range(_SLOTS if slot else 0):
            file[f"states/{number}"] = np.zeros(slot, "u1")
        if self._coordinates:
            self._write_grid(file.create_group("fields"), chunk)
        sums = 1 + len(self._arrays)
        file.create_dataset("checksums", (0, sums), "u4", chunks=(chunk * _CHUNKS, sums),
                            maxshape=(None, sums))
        file.attrs["frame"] = checksums.frame(file)

    def _write_grid(self, group, chunk):
        """Coordinates, initial gap and empty fields."""
        for name, array in self._coordinates.items():
            group[name] = array
            group[name].attrs["unit"] = self._units["coordinates"]
        if self._initial_gap is not None:
            group["initial_gap"] = self._initial_gap
            group["initial_gap"].attrs["unit"] = self._units["initial_gap"]
        if self._fields == "last":
            group.attrs["point"] = 0  # whose fields these are; 0 while they are being written
        for name in self._arrays:
            # The fill value makes a new chunk reach the file whole, before the index tells of it.
            layout = {"chunks": (chunk, *self._shape), "maxshape": (None, *self._shape)}
            rows, layout = (1, {}) if self._fields == "last" else (0, layout)
            group.create_dataset(name, data=np.full((rows, *self._shape), np.nan), fillvalue=np.nan,
                                 **layout)
            group[name].attrs["unit"] = self._units[name]

    def _copy(self, old, new, states):
        """Copy the points that count."""
        for point, state in states.items():
            new[f"states/{point % _SLOTS}"][: state.size] = state
        for name in self._columns:
            new["branch"][name].resize((self.points,))
            new["branch"][name][:] = old["branch"][name][: self.points]
        for name in self._arrays:
            if self._fields == "all":
                new["fields"][name].resize(self.points, axis=0)
            for point in range(len(new["fields"][name]) if name in old["fields"] else 0):
                new["fields"][name][point] = old["fields"][name][point]
        if self._fields == "last":
            new["fields"].attrs.modify("point", old["fields"].attrs["point"])
        self._copy_checksums(old, new)
        new.attrs.modify("points", self.points)

    def _copy_checksums(self, old, new):
        """Copy the checksums of the points that count; make those that an older program did not."""
        known = (old["checksums"][: self.points] if "checksums" in old
                 else np.zeros((self.points, 0), "u4"))
        sums = np.zeros((self.points, 1 + len(self._arrays)), "u4")
        sums[:, 0] = checksums.rows({name: new["branch"][name][:] for name in self._columns})
        for place, point in enumerate(_field_points(old)):
            sums[point, 1:] = [checksums.of(new["fields"][name][place]) for name in self._arrays]
        sums[:, : known.shape[1]] = known
        new["checksums"].resize(self.points, axis=0)
        new["checksums"][:] = sums

    def _put(self, file, row, state, fields):
        """Write the next point; what makes it safe is the order, held by the flushes."""
        point = self.points + 1
        if self._fields == "last":
            file["fields"].attrs.modify("point", 0)
            file.flush()
        for name in self._arrays:
            if self._fields == "all":
                file["fields"][name].resize(point, axis=0)
            file["fields"][name][-1] = fields.get(name, np.nan)
        file["checksums"].resize(point, axis=0)
        line = {name: np.array([row[name]], "i1" if column.names else column.kind)
                for name, column in self._columns.items()}
        whole = (np.broadcast_to(np.asarray(fields.get(name, np.nan), "f8"), self._shape)
                 for name in self._arrays)
        file["checksums"][-1] = [checksums.rows(line)[0], *map(checksums.of, whole)]
        branch, scalar = file["branch"].id, h5py.h5s.create(h5py.h5s.SCALAR)
        for name, value in row.items():  # HDF5's own calls: many columns, and half the time
            column = h5py.h5d.open(branch, name.encode())
            column.set_extent((point,))
            place = column.get_space()
            place.select_hyperslab((self.points,), (1,))
            column.write(scalar, place, np.asarray(value, column.dtype))
        file[f"states/{point % _SLOTS}"][: state.size] = state
        file.flush()
        if self._fields == "last":
            file["fields"].attrs.modify("point", point)
        file.attrs.modify("points", point)
        file.flush()

    def _kept(self, file):
        """Packed states of the last points, oldest first: point -> bytes."""
        kept = {}
        for point in range(max(1, self.points - _STATES + 1), self.points + 1):
            slot = file.get(f"states/{point % _SLOTS}")
            label, size = slot[:16].view("<i8") if slot is not None else (0, 0)
            if label == point:
                kept[point] = slot[:size]
        return kept


class Record(Mapping):
    """An archive as it was when read: a mapping of columns to arrays, of enumerations to arrays of
    names.

    Attributes
    ----------
    path : pathlib.Path
    points : int
    complete : bool
    scene, versions : dict
    options : str, of the newest run
    runs : list of `resuming.Run`: which options made which points
    warnings : list of str
    units : dict, of columns, coordinates (``x``, ``y``), ``initial_gap``, ``displacement`` and
        ``traction``
    names : dict, names of the values of each enumeration
    coordinates : tuple of arrays, empty if there are none
    initial_gap : array of the grid's shape, or None
    field_points : list of int, the points (from 0) whose displacement and traction are stored
    """

    def __init__(self, file):
        attributes = file.attrs
        self.path, self.points = Path(file.filename), int(attributes["points"])
        self.complete = bool(attributes["complete"])
        self.scene, self.options = dict(file["scene"].attrs), attributes["options"]
        self.versions = dict(line.split(" ", 1) for line in attributes["versions"].splitlines())
        self.runs, self.warnings = resuming.runs(file), attributes.get("warnings", "").splitlines()
        branch, fields = file["branch"], file.get("fields", {})
        self.units = {name: dataset.attrs["unit"] for name, dataset in [*branch.items(),
                                                                        *fields.items()]}
        self.names = {name: tuple(branch[name].attrs["names"]) for name in branch
                      if "names" in branch[name].attrs}
        self._columns = {name: branch[name][: self.points] for name in branch}
        self.coordinates = tuple(fields[name][:] for name in "xy" if name in fields)
        self.initial_gap = fields["initial_gap"][...] if "initial_gap" in fields else None
        self.field_points = _field_points(file)
        if "checksums" in file and (file.attrs["frame"] != checksums.frame(file)
                                    or not np.array_equal(file["checksums"][: self.points, 0],
                                                          checksums.rows(self._columns))):
            raise ArchiveError(
                f"{self.path} is damaged: its checksums are not those of what it holds.")
        for name, names in self.names.items():
            self._columns[name] = np.array(names)[self._columns[name]]

    def __getitem__(self, name):
        return self._columns[name]

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(self._columns)

    def field(self, name, point):
        """(components, *grid) array of 'displacement', 'traction' or 'mode' at a point of
        `field_points`, from the file."""
        return _safely(self.path, lambda file: _field(file, name, point))


def read(path):
    """Archive at `path` as a `Record`; also of a run that is going on or was killed.

    Raises
    ------
    ArchiveError
        If there is no such file, or it is no archive, or damaged.
    """
    return _safely(path, Record)


def _safely(path, take):
    """What a function takes from the archive at a path; ArchiveError where it is damaged, tried in
    another process before."""
    def taken():
        with _open_archive(path) as file:
            return take(file)

    why = failure(taken)
    if why.startswith("ArchiveError: "):
        raise ArchiveError(why.removeprefix("ArchiveError: "))
    try:
        if not why:
            return taken()
    except (ArithmeticError, LookupError, OSError, RuntimeError, TypeError, AttributeError,
            UnicodeError) as error:
        why = f"{type(error).__name__}: {error}"
    raise ArchiveError(f"{path} is damaged ({why}): what it holds cannot be read.")


def _field(file, name, point):
    """A field of a point, in an open archive."""
    stored = _field_points(file)
    if point not in stored:
        raise ArchiveError(f"{file.filename} keeps no fields of point {point}.")
    found = file["fields"][name][stored.index(point)]
    sums = dict(zip(("displacement", "traction", "mode"),
                    file["checksums"][point, 1:])) if "checksums" in file else {}
    if sums.get(name, checksums.of(found)) != checksums.of(found):
        raise ArchiveError(f"{file.filename} is damaged: the checksum of {name} "
                           f"at point {point} is not that of what "
                           "it holds.")
    return found


def _field_points(file):
    """Points (from 0) whose fields are stored, in the order of storage."""
    points, fields = int(file.attrs["points"]), file.attrs["fields"]
    if fields == "last":
        point = int(file["fields"].attrs["point"])
        return [point - 1] if 0 < point <= points else []
    return list(range(points)) if fields == "all" else []


def _open(path, mode):
    """Open an HDF5 file; wait a moment for other programs. Chunks pass by the cache: a row writes
    itself only."""
    patience = time.monotonic() + _PATIENCE
    while True:
        try:
            # The oldest format has no mark of being open that a kill would leave behind.
            return h5py.File(path, mode, libver="earliest", rdcc_nbytes=0)
        except OSError as error:
            if "unable to lock" not in str(error) or time.monotonic() > patience:
                raise
        time.sleep(0.01)


def _open_archive(path):
    """Open an archive for reading; raise if there is none."""
    if not _resolved(path).is_file():
        raise ArchiveError(f"{path}: there is no such file.")
    try:
        file = _open(path, "r")
    except OSError as error:
        if "unable to lock" in str(error):
            raise ArchiveError(f"{path} cannot be locked: another program is "
                               "writing it, or its file system knows no "
                               "locks (then set the environment's "
                               "HDF5_USE_FILE_LOCKING=FALSE).") from error
        raise ArchiveError(f"{path} cannot be read as an HDF5 file: {reason(error)}.") from error
    if file.attrs.get("format") != FORMAT:
        file.close()
        raise ArchiveError(f"{path} is an HDF5 file, but no archive of this "
                           f"program (attribute format = {FORMAT!r}).")
    return file


def _resolved(path):
    """The file behind a path, since a rename would replace a symbolic link instead of it;
    ArchiveError for what names none."""
    try:
        resolved = Path(path).resolve()
        resolved.exists()
    # too long, a loop of links, letters that no file system knows
    except (OSError, RuntimeError, ValueError) as error:
        raise ArchiveError(f"-archive_file is '{path}', which cannot be the "
                           f"name of a file: {reason(error)}.") from None
    return resolved


def _check_folder(path):
    """Raise if no file can be made beside `path`."""
    if not path.parent.is_dir():
        raise ArchiveError(f"The folder of the archive {path} does not exist: "
                           "create it or name another -archive_file.")
    if not os.access(path.parent, os.W_OK):
        raise ArchiveError(
            f"The folder of the archive {path} cannot be written: name another -archive_file.")


def _pack(point, state):
    """The state of a point as bytes: point, size, and an .npz file (which has a checksum)."""
    arrays = {name: np.asarray(value) for name, value in state.items()}
    for name, array in arrays.items():
        if array.dtype.hasobject:
            raise ArchiveError(f"The state {name!r} is neither an array nor a number nor a string.")
    buffer = io.BytesIO(bytes(16))
    buffer.seek(16)
    np.savez(buffer, **arrays)
    packed = np.frombuffer(buffer.getvalue(), "u1").copy()
    packed[:16].view("<i8")[:] = point, packed.size
    return packed


def _unpack(packed):
    """The state that `_pack` made bytes of."""
    with np.load(io.BytesIO(packed[16:].tobytes()), allow_pickle=False) as arrays:
        return {name: array if array.ndim else array.item() for name, array in arrays.items()}
