"""Archives as they are read: columns, fields, and what tells of them."""

import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from ..options.arguments import a_path, whole
from . import checksums, resuming, stored
from .active import Rebuilt
from .columns import instead
from .extras import extra
from .files import ArchiveError, checked, open_archive, safely
from .journal import archive_of

TRIES = 5
"""How often an archive is read again that a run has written to meanwhile."""

SHOWN = ("normal_force", "tangential_force", "contact_area")
"""Beginnings of the names of columns whose extent the ``repr`` tells."""


class NoColumn(KeyError):
    """A column that an archive has not; the message is its first argument, which ``str`` quotes."""


class Record(Mapping):
    """An archive as it was when read: a mapping of columns to arrays, of enumerations to arrays of
    names, which cannot be written into (copy them).

    Parameters
    ----------
    file : h5py.File, the open archive
    tried : bool, whether what is read from it later is tried in another process first, as it should
        be of an archive of unknown origin

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
    on_active : bool, whether they are stored on the nodes where the law acts only
    """

    def __init__(self, file, tried=True):
        self._tried = tried
        parts = {part.name: part for part in checksums.parts(file)}
        attributes = parts[""].attributes
        self.path, self.points = Path(file.filename), int(attributes["points"])
        # Fields are read later, maybe from another folder, or where another run has put its file.
        self._place, self._key = self.path.absolute(), archive_of(attributes.get("journal"))
        self.complete = bool(attributes["complete"])
        self.scene, self.options = parts["scene/"].attributes, attributes["options"]
        self.versions = dict(line.split(" ", 1) for line in attributes["versions"].splitlines())
        self.runs, self.warnings = resuming.runs(file), attributes.get("warnings", "").splitlines()
        branch, fields = (_within(parts, group) for group in ("branch", "fields"))
        self.units = {name: part.attributes["unit"] for name, part in [*branch.items(),
                      *fields.items()] if "unit" in part.attributes}
        self.on_active, self._rebuilt = "active" in fields, None
        self._stored = ("displacement", "traction", *["mode"] * ("mode" in fields))
        if self.on_active:
            self.units |= {name: item.attrs["unit"] for name, item in
                           fields["active"].item.items() if "unit" in item.attrs}
        self.names = {name: tuple(part.attributes["names"]) for name, part in branch.items()
                      if "names" in part.attributes}
        self._columns = {name: part.item[: self.points] for name, part in branch.items()}
        self._waiting = stored.waiting(file)
        self.coordinates = tuple(fields[name].item[:] for name in "xy" if name in fields)
        self.initial_gap = fields["initial_gap"].item[...] if "initial_gap" in fields else None
        self.field_points = list(stored.field_points(file))
        self._check(file, list(parts.values()))
        self._add(attributes["fields"])
        for name, names in self.names.items():
            self._columns[name] = np.array(names)[self._columns[name]]
        for column in self._columns.values():
            column.flags.writeable = False

    def _check(self, file, parts):
        """Raise if frame or rows are not those that were written; archives of older programs cannot
        tell, but for how many rows they have."""
        if any(len(column) != self.points for column in self._columns.values()):
            raise ArchiveError(f"{self.path} is damaged: it counts {self.points} points, and its "
                               "columns have another number of rows.")
        if "checksums" in file and (parts[0].attributes["frame"] != checksums.frame(parts)
                                    or not np.array_equal(file["checksums"][: self.points, 0],
                                                          checksums.rows(self._columns))):
            raise ArchiveError(
                f"{self.path} is damaged: its checksums are not those of what it holds.")

    def _add(self, fields):
        """Add the points that are in the journal yet to those in the file."""
        if not self._waiting:
            return
        self.points += len(self._waiting)
        for name, column in self._columns.items():
            rows = np.array([point.row[name] for point in self._waiting], column.dtype)
            self._columns[name] = np.concatenate([column, rows])
        if fields == "all":
            self.field_points = list(range(self.points))
        elif self._waiting[-1].fields:  # else those in the file count
            self.field_points = [self.points - 1]

    def __getitem__(self, name):
        if name not in self._columns:
            raise NoColumn(f"{self.path} has no column {name!r}{instead(str(name), list(self))}")
        return self._columns[name]

    def __contains__(self, name):
        return name in self._columns

    __eq__, __hash__ = object.__eq__, object.__hash__  # columns are arrays

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(self._columns)

    def __repr__(self):
        """Path, points, loads reached and events."""
        events = [name for name in self.get("event", ()) if name != "none"]
        told = [f"{name} {np.nanmin(self[name]):.4g} to {np.nanmax(self[name]):.4g} "
                f"{self.units[name]}" for name in self
                if self.points and name.startswith(SHOWN) and np.isfinite(self[name]).any()]
        return (f"<Record {self.path}: {self.points} points"
                + ("" if self.complete else ", not complete")
                + "".join(f", {text.strip()}" for text in told)
                + (f"; {', '.join(events)}" if events else "")
                + (f"; fields of {len(self.field_points)} points" if self.field_points else "")
                + ">")

    def to_dataframe(self):
        """The columns as a DataFrame of pandas (of the extra ``table``), one row a point; its
        ``attrs`` hold units, path and scene."""
        frame = extra("pandas", "table", "Record.to_dataframe").DataFrame(dict(self))
        frame.index.name = "point"
        frame.attrs |= {"units": {name: self.units[name] for name in self},
                        "archive": str(self.path), "scene": self.scene}
        return frame

    def states(self):
        """Point (from 0) -> what going on from it takes, a mapping: of up to four last points."""
        held = self.points - len(self._waiting)

        def take(file):
            found = stored.unpacked(file, held)
            if held not in found and file.attrs["points"] > held:
                raise ArchiveError(f"{self.path} has gone on since it was read: read it again.")
            return {number - 1: state for number, state in found.items()}

        return self._taken(take) | {held + place: point.state
                                    for place, point in enumerate(self._waiting)}

    def _taken(self, take):
        """What a function takes from the file; ArchiveError where that is another one by now."""
        if self._tried:
            return safely(self._place, partial(self._own, take))
        with open_archive(self._place) as file:
            return self._own(take, file)

    def _own(self, take, file):
        """What a function takes from an open file; ArchiveError for one of another run."""
        if archive_of(file.attrs.get("journal")) != self._key:
            raise ArchiveError(f"{self.path} is another archive than was read: read it again.")
        return take(file)

    def field(self, name, point):
        """(components, *grid) array of 'displacement', 'traction' or 'mode' at a point of
        `field_points`, from the file; -1 is the last point. ArchiveError where it is not kept."""
        point = self._number(point, name)
        if name == "mode" or not self.on_active:
            held = self.points - len(self._waiting)
            if held <= point < self.points and point in self.field_points:
                return self._waiting[point - held].fields[name]
            return self._taken(lambda file: stored.Fields(file).field(name, point))
        return self._cell(name, self.active(point))

    def _number(self, point, *names):
        """The number from 0 of a point, which may be counted from the end; ArchiveError where it
        has no fields of these names."""
        point = whole("point", point, "a whole number, from 0 or, if negative, from the end")
        number = point + self.points if point < 0 else point
        if number not in self.field_points:
            kept = self.field_points
            raise ArchiveError(f"{self.path} keeps no fields of point {point}: "
                               + (f"it keeps those of {kept[0]} to {kept[-1]}." if len(kept) > 1
                                  else f"it keeps those of {kept[0]}." if kept
                                  else "-archive_fields all or last keeps them."))
        for name in names:
            if name not in self._stored:
                raise ArchiveError(f"{self.path} has no field '{name}': it has "
                                   f"{', '.join(self._stored)}"
                                   + ("" if name != "mode" else "; -continuation_stability "
                                      "eigenvalue finds modes") + ".")
        return number

    def _cell(self, name, kept):
        """The cell's 'displacement' or 'traction' from what is kept of a point on active nodes."""
        if self._rebuilt is None:
            self._rebuilt = self._taken(Rebuilt)
        return self._rebuilt(name, kept)

    def active(self, point):
        """What is kept of a point of `field_points` on the nodes where the law acts, a mapping:
        ``nodes`` (their numbers in the cell's fields), ``displacement`` and ``traction``
        (components, nodes) and ``mean`` displacement (components); of archives made with
        -archive_fields_on active. ArchiveError where there is nothing of it."""
        point = self._number(point)
        if not self.on_active:
            raise ArchiveError(f"{self.path} keeps fields of the whole cell, which `field` reads: "
                               "-archive_fields_on active keeps those of active nodes.")
        held = self.points - len(self._waiting)
        if held <= point < self.points and point in self.field_points:
            return self._waiting[point - held].fields
        return self._taken(lambda file: stored.Fields(file).on_active(point))

    def each(self, points, names=("displacement", "traction")):
        """Iterate over points: of each the fields of these names, a list, as of `field`; many cost
        less than one by one.

        Parameters
        ----------
        points : list of int, of `field_points`
        names : sequence of str
        """
        points = [self._number(point, *names) for point in points]
        held = self.points - len(self._waiting)
        in_file = [point for point in points if not held <= point < self.points]

        def kept(fields, point):
            on_active = (fields.on_active(point)
                         if self.on_active and set(names) - {"mode"} else None)
            return on_active, {name: fields.field(name, point) for name in names
                               if on_active is None or name == "mode"}

        def take(file):
            fields = stored.Fields(file)
            for point in in_file:
                kept(fields, point)

        if in_file and self._tried:
            checked(self._place, partial(self._own, take))
        for point in points:
            if point not in in_file:
                yield [self.field(name, point) for name in names]
                continue
            with open_archive(self._place) as file:
                on_active, whole = self._own(lambda own: kept(stored.Fields(own), point), file)
            yield [whole[name] if name in whole else self._cell(name, on_active)
                   for name in names]


def _within(parts, group):
    """Parts of an archive in one of its groups, by their names there."""
    return {name.partition("/")[2]: part for name, part in parts.items()
            if name.startswith(f"{group}/") and name != f"{group}/"}


def read(path):
    """Archive at `path` as a `Record`; also of a run that is going on or was killed.

    Raises
    ------
    ArchiveError
        If there is no such file, or it is no archive, or damaged.
    """
    before, record = _stamp(a_path("the archive", path, "the path of one")), None
    for left in reversed(range(1 + TRIES)):
        try:
            record = safely(path, Record)
        except ArchiveError:
            if before == _stamp(path) or not left and not record:
                raise
        # a run has taken its journal in meanwhile: points would be missing that were there; or,
        # where there are no locks, has written to what was read
        before, after = _stamp(path), before
        if record and before == after:
            break
    return record


def _stamp(path):
    """What tells a file from another in its place, or as it is written to; None of none."""
    try:
        found = os.stat(path)
    except (OSError, ValueError):  # the second for what cannot be a name
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
