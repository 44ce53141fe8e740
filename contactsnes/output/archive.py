"""Archives of branches: HDF5 files to which a run adds point by point, and which h5py alone can
read.

Quick points wait in the journal beside the file (`journal`) until many are written at once; it is
read with the file, and goes when the file has what is in it.
"""

import os
import time

import numpy as np

from . import checksums, resuming, stored
from .columns import put_attributes
from .files import (
    FORMAT,
    ArchiveError,
    check_folder,
    check_new,
    check_unprotected,
    resolved,
    safely,
)
from .journal import BATCH, MOST, Journal, beside, next_key
from .layout import Layout
from .reading import read
from .store import Store, unwritten

LARGE = 1 << 18
"""Numbers of the fields of a point beyond which it is written to the file at once: there, writing
it twice would take longer than what HDF5 does besides."""

SECONDS = 1.0
"""Time after which points that wait are written with the next one, so that slow runs have each
point in the file."""


def _completed(file):
    """Mark a file as complete."""
    file.attrs.modify("complete", True)


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
    precision : {'double', 'single'}, of displacement and traction; single ones are compressed when
        the path is done
    compliance : (circle, blocks), optional: displacement and traction are kept on the nodes where
        the law acts, `active.ActiveFields`
    state : int, bytes of a first point's state as far as they are known, if not all have fields

    Attributes
    ----------
    points : int, points that are safely in the file or its journal
    complete : bool, whether the path was followed to its regular end (`finish`), and has no more to
        offer
    runs : list of `resuming.Run`, those before this one
    lacking : str, what a complete file has not and this run asks for; empty for nothing
    """

    def __init__(self, path, *, scene, options, versions, columns, fields="none", coordinates=None,
                 components=1, initial_gap=None, modes=False, units=None, warnings=(),
                 precision="double", compliance=None, state=0):
        self._layout = Layout(columns, fields, coordinates, components, initial_gap, modes, units,
                              precision, compliance)
        self.path = resolved(path)
        self.complete, self.lacking = False, ""
        self.runs = []
        self._first, self._expected = 0, state  # point of this run
        self._begun = False  # whether the file is this archive's
        self._warnings = "\n".join(warnings)
        self._options = options
        self._versions = "\n".join(f"{name} {value}" for name, value in versions.items())
        self._scene = {name: value for name, value in scene.items() if value is not None}
        self._journal = Journal(beside(self.path), os.urandom(16).hex())
        self._store = Store(self.path, self._layout, self._write_frame, self._journal)
        self._frame = None  # what it depends on, and its checksum
        # points that are in the journal, but not in the file, and what gives the last its fields
        self._waiting, self._later = [], None
        self._settled = time.monotonic()

    @property
    def points(self):
        """Points that survive a kill."""
        return self._store.held + len(self._waiting)

    @classmethod
    def create(cls, path, *, overwrite=False, **content):
        """New archive without points; a file that it replaces stays as it is until the first point,
        or `settle`.

        Parameters
        ----------
        path : path of the file, in an existing folder
        overwrite : bool, whether to replace an archive
        content : as for the class

        Raises
        ------
        ArchiveError
            If the file exists and is not to be overwritten or is no archive; if the folder is
            missing or read-only.
        """
        archive = cls(path, **content)
        check_new(archive.path, overwrite)
        if not archive.path.exists():
            archive._begin()
        return archive

    def _begin(self):
        """Make the file, once, in place of what was there."""
        if not self._begun:
            self._store.commit(lambda file: None, BATCH, self._expected)
            self._journal.remove()
            self._begun = True

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
        archive._journal.check_free()
        if read(archive.path).points:
            safely(archive.path, archive._take_over)
            archive.settle()
        if not archive.points:
            archive = cls.create(path, overwrite=True, **content)
            archive.settle()
        return archive

    def append(self, row, state, displacement=None, traction=None, mode=None, later=None, **active):
        """Add a point; when this returns, it survives a kill of the program.

        Parameters
        ----------
        row : mapping with one value for each column, of an enumeration a name or its number
        state : mapping of arrays, numbers and strings: what a resumed run needs; kept for the last
            four points
        displacement, traction : (components, *grid) arrays, used if the archive keeps fields; on
            active nodes (components, nodes)
        mode : (components, *grid), if it keeps modes and the point has one
        later : function that returns these as a mapping: of a last point alone it is asked for them
            where the file is written
        active : on active nodes, their numbers ``nodes`` and the ``mean`` displacement (components)
        """
        if self.complete:
            raise ArchiveError(f"{self.path} is complete; no point can be added.")
        self._begin()
        fields = {} if later else self._layout.checked(
            {"displacement": displacement, "traction": traction, "mode": mode, **active})
        point = stored.Kept(self._layout.numbers(row), state, fields)
        # The first point of a run, or after a write that failed, shows whether the file can be
        # written.
        large = sum(map(np.size, fields.values())) > LARGE or any(
            map(stored.has_parts, (state, fields)))
        if not self._store.room or large:
            self.settle()
            self._store.put([self._with_fields(point, later)])
            self._settled = time.monotonic()
            return
        try:
            self._journal.append(self.points + 1, point.arrays())
        except OSError as error:
            raise unwritten(self.path, error) from error
        self._waiting.append(point)
        self._later = later
        if (len(self._waiting) == BATCH or self._journal.size > MOST
                or time.monotonic() - self._settled > SECONDS):
            self.settle()

    def settle(self, then=lambda file: None):
        """Write the points that wait in the journal to the file, and what ``then`` does to it."""
        self._begin()
        if self._waiting:
            self._waiting[-1] = self._with_fields(self._waiting[-1], self._later)
            self._store.put(self._waiting, then)
            self._settled = time.monotonic()
            self._waiting, self._later = [], None
            self._journal.remove()

    def _with_fields(self, point, later):
        """A point with the fields that a function, if any, gives it."""
        return point._replace(fields=self._layout.checked(later())) if later else point

    def finish(self):
        """Mark the archive as complete: the path was followed to its regular end."""
        if self.complete:
            return
        small = self._layout.fields == "all" and (self._layout.precision == "single"
                                                  or self._layout.active is not None)
        if self._waiting and not small:
            self.settle(_completed)
        else:
            self.settle()
            (self._store.pack if small else self._store.commit)(_completed, self._store.held)
        self.complete = True

    def remove(self):
        """Remove the file, which would only be in the way of the next try, if it is this
        archive's."""
        if self._begun:
            self.path.unlink(missing_ok=True)

    def states(self):
        """States of the last points (up to four), oldest first, as they were given to `append`."""
        states = safely(self.path, lambda file: list(stored.unpacked(file, self.points).values()))
        if self.points and not states:
            raise ArchiveError(
                f"{self.path} cannot be resumed: the state of its last point is lost.")
        return states

    def _take_over(self, file):
        """Go on from the points of a file; raise if they belong to another run than this archive
        describes."""
        self._begun = True
        self._store.held, self.runs = int(file.attrs["points"]), resuming.runs(file)
        self._waiting = stored.waiting(file)
        self._journal.key = next_key(file.attrs.get("journal", self._journal.key))
        self._first = self.points
        last, leg = self._last(file)
        done = int(leg) - (last.get("position") != 1.0)
        self._refuse(resuming.differences(dict(file["scene"].attrs), file.attrs["options"],
                                          self._scene, self._options, done))
        there = file.attrs["options"], self._options
        more = (resuming.has_more(*there, resuming.events_of(last))
                or resuming.leads_elsewhere(*there, done))
        self.complete = bool(file.attrs["complete"]) and not more
        if self.complete:
            self.lacking = resuming.lacking(file, self._layout.fields, self._layout.columns)
            return
        check_unprotected(self.path)
        self._refuse(self._layout.differences(file))
        self._layout.go_on(file)
        told = file.attrs.get("warnings", "").splitlines()
        self._warnings = "\n".join([*told, *(line for line in self._warnings.splitlines()
                                             if line not in told)])
        stored.Fields(file).check()  # what is copied later on has to be whole

    def _last(self, file):
        """State and leg of the last point, 0 of paths that have none."""
        if self._waiting:
            return self._waiting[-1].state, self._waiting[-1].row.get("leg", 0)
        states = [{}, *map(stored.unpack, stored.states(file, self._store.held).values())]
        legs = file["branch"].get("leg")
        return states[-1], 0 if legs is None else legs[self._store.held - 1]

    def _refuse(self, differences):
        """Raise for the first of some differences, (name, there, here)."""
        for name, old, new in differences:
            raise ArchiveError(f"{self.path} cannot be resumed: {name} is {old} there and {new} "
                               "here; take what is there, another -archive_file, or "
                               "-archive_overwrite.")

    def _write_frame(self, file, slot, chunk):
        """Everything but the points."""
        known = {"": {"format": FORMAT, "points": 0, "complete": False,
                      "options": self._options, "versions": self._versions,
                      "warnings": self._warnings, "fields": self._layout.fields,
                      "shape": self._layout.shape, "journal": self._journal.key,
                      "precision": self._layout.precision}, "scene/": self._scene}
        for item, attributes in zip((file, file.create_group("scene")), known.values()):
            put_attributes(item.id, attributes)
        runs = [*(run for run in self.runs if run.first < self._first),
                resuming.Run(self._first, self._options, self._versions)]
        for name, values in zip(resuming.Run._fields, zip(*runs)):
            file[f"runs/{name}"] = values
        known |= self._layout.make(file, slot, chunk)
        # what it is made of, besides what stays: written anew, it is the same
        kept = self._first, runs, self._warnings, self._layout.arrays
        if self._frame is None or self._frame[0] != kept:
            self._frame = kept, checksums.frame(checksums.parts(file, known))
        file.attrs["frame"] = self._frame[1]
