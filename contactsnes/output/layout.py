"""Groups and datasets of an archive: made empty with room for points, filled point by point, copied
where room is lacking."""

from __future__ import annotations

import numpy as np

from ..grid.parted import Parted, blocks, pieces
from ..grid.parted import chunk as chunk_of
from . import active, checksums
from .active import ActiveFields
from .cell_fields import CHUNKS, KINDS, PACKED, as_stored, empty, most_together
from .columns import Column, asked_differently, make_columns, put_rows
from .files import ArchiveError
from .stored import SLOTS, field_points, has_active, put_state

UNITS = {
    "coordinates": "beta",
    "initial_gap": "u_n,r",
    "displacement": "u_n,r; u_t,r",
    "traction": "p_n,r; p_t,r",
    "mode": "",
}
"""Of the fields, for dimensionless scenes."""


class Layout:
    """What an archive holds of each point, and of the grid.

    Parameters
    ----------
    columns : mapping of a column's name to its `Column`
    fields : {'none', 'last', 'all'}, the points whose displacement and traction are kept
    coordinates : tuple of one or two arrays, the nodes along x (and y); fields need them
    components : int, components of displacement and traction
    initial_gap : array of the grid's shape, optional
    modes : bool, whether the fields of a point include its leading mode
    units : mapping or None, units of fields other than `UNITS`
    precision : {'double', 'single'}, of the fields
    compliance : (circle, blocks) of `active.ActiveFields`, which then keeps displacement and
        traction; None: they are kept on the whole grid

    Attributes
    ----------
    packed : bool, whether fields are compressed: in a file to which nothing is added in place
    arrays : tuple of str, fields that are kept on the whole grid
    active : ActiveFields or None
    shape : tuple of int, (components, *grid) of each field
    """

    def __init__(self, columns, fields, coordinates, components, initial_gap, modes, units,
                 precision="double", compliance=None):
        if fields not in ("none", "last", "all"):
            raise ArchiveError(f"-archive_fields is {fields!r}; it can be none, last or all.")
        if fields != "none" and not coordinates:
            raise ArchiveError(f"Fields ({fields}) need coordinates.")
        self.columns = {name: Column.of(name, column) for name, column in columns.items()}
        self.fields = fields
        self.arrays = () if fields == "none" else (
            *(("displacement", "traction") if compliance is None else ()),
            *(("mode",) if modes else ()))
        self.coordinates = dict(zip("xy", coordinates or ()))
        self.shape = (components, *(len(array) for array in self.coordinates.values()))
        self.initial_gap = initial_gap
        self.units = {**UNITS, **(units or {})}
        self.precision, self.kind, self.packed = precision, KINDS[precision], False
        self.active = None if compliance is None else ActiveFields(
            components, self.kind, compliance, fields, CHUNKS, PACKED)
        self._together = (most_together(self.kind, self.shape) if fields == "all" and self.arrays
                          else None)

    def differences(self, file):
        """What an open archive keeps otherwise by its options, [(option, there, here), ...]."""
        kept, on_active = file.attrs["fields"], has_active(file)
        found = [("archive_fields", kept, self.fields)]
        if kept != "none":
            nodes = {True: "active", False: "cell"}
            found += [("archive_fields_on", nodes[on_active], nodes[self.active is not None]),
                      ("archive_precision", file.attrs.get("precision", "double"), self.precision)]
        return [*(one for one in found if one[1] != one[2]),
                *asked_differently(file["branch"], self.columns)]

    def go_on(self, file):
        """Raise if an open archive has other columns or another grid; keep modes if it does."""
        columns = sorted(set(file["branch"]) ^ set(self.columns))
        if columns or tuple(file.attrs["shape"]) != self.shape:
            raise ArchiveError(f"{file.filename} cannot be resumed: its columns or its grid differ "
                               f"({', '.join(columns) or self.shape}); take another file.")
        if "mode" in file.get("fields", ()) and "mode" not in self.arrays:
            self.arrays = (*self.arrays, "mode")

    def at_once(self, points):
        """Number of points whose fields are allocated at once, in a file with room for so many."""
        chunk = max(1, -(-points // CHUNKS))
        return min(chunk, self._together or chunk)

    def numbers(self, row):
        """A row, one value for each column, with enumerations as numbers."""
        if set(row) != set(self.columns):
            raise ArchiveError("A row has one value for each column; not so: "
                               f"{sorted(set(row) ^ set(self.columns), key=str)}.")
        return {name: column.number(name, row[name]) for name, column in self.columns.items()}

    def checked(self, given):
        """The fields that are kept among those given, name -> array, a mode only where there is
        one."""
        fields = {name: as_stored(name, given[name], self.precision) for name in self.arrays
                  if name != "mode" or given.get(name) is not None}
        for name, array in fields.items():
            if array.shape != self.shape:
                raise ArchiveError(
                    f"{name} has the shape {array.shape}; the archive keeps {self.shape}.")
        return fields if self.active is None else fields | self.active.checked(given)

    def make(self, file, slot, chunk):
        """Make empty groups and datasets.

        Parameters
        ----------
        file : h5py.File
        slot : int, bytes that a state may have; 0: no states yet
        chunk : int, fields of so many points are allocated at once, rows of `CHUNKS` times as many

        Returns
        -------
        dict : names of the columns from the root -> their attributes
        """
        # One chunk for all rows there is room for: a new row allocates nothing.
        columns = make_columns(file.create_group("branch").id, self.columns, chunk * CHUNKS)
        for number in range(SLOTS if slot else 0):
            made = file.create_dataset(f"states/{number}", (slot,), "u1",
                                       **(PACKED | {"chunks": chunk_of((slot,))}
                                          if self.packed else {}))
            for where in pieces((slot,)):
                made[where] = 0
        if self.coordinates:
            self._make_grid(file.create_group("fields"), chunk)
        sums = 1 + self._sums
        file.create_dataset("checksums", (1, sums), "u4", chunks=(chunk * CHUNKS, sums),
                            maxshape=(None, sums))[0] = 0
        return columns

    @property
    def _sums(self):
        """Checksums of the fields of a point."""
        return len(self.arrays) + (self.active is not None)

    def _make_grid(self, group, chunk):
        """Coordinates, initial gap and empty fields."""
        for name, array in self.coordinates.items():
            group[name] = array
            group[name].attrs["unit"] = self.units["coordinates"]
        if self.initial_gap is not None:
            made = group.create_dataset("initial_gap", np.shape(self.initial_gap), "f8")
            for where, block in blocks(self.initial_gap):
                made[where] = block
            made.attrs["unit"] = self.units["initial_gap"]
        if self.active is not None:
            made = self.active.make(group, chunk, self.packed)
            for name in ("displacement", "traction"):
                self._name_axes(made[name], name, ["component", "node"])
            made["mean"].attrs["unit"] = self.units["displacement"]
        if self.fields == "last":
            group.attrs["point"] = 0  # whose fields these are; 0 while they are being written
        for name in self.arrays:
            how = self.fields, self.packed, self.parted
            empty(group, name, self.kind, (chunk, *self.shape), *how)
            self._name_axes(group[name], name, ["point", "component", *self.coordinates])

    def _name_axes(self, dataset, name, axes):
        """Unit of a field, names of its components, their units and the axes, as attributes; the
        axes as HDF5's labels, too."""
        dataset.attrs["unit"] = self.units[name]
        ends = {1: [""], 2: ["_x", "_y"]}[len(self.coordinates)]
        names = ["normal", *(f"tangential{end}" for end in ends)][:self.shape[0]]
        normal, _, tangential = self.units[name].partition("; ")
        dataset.attrs["components"] = names
        dataset.attrs["component_units"] = [normal, *[tangential or normal] * (len(names) - 1)]
        dataset.attrs["axes"] = axes
        for dimension, axis in zip(dataset.dims, axes):
            dimension.label = axis

    def copy(self, old, new, states):
        """Copy the points that count.

        Parameters
        ----------
        old, new : h5py.File, an archive and one without points
        states : mapping of points (from 1) to their packed states
        """
        points = int(old.attrs["points"])
        for point, state in states.items():
            put_state(new[f"states/{point % SLOTS}"], state)
        for name in self.columns:
            new["branch"][name].resize((points,))
            new["branch"][name][:] = old["branch"][name][:points]
        for name in self.arrays:
            if self.fields == "all":
                new["fields"][name].resize(points, axis=0)
            for point in range(len(new["fields"][name]) if name in old["fields"] else 0):
                for where in self._pieces():
                    new["fields"][name][(point, *where)] = old["fields"][name][(point, *where)]
        if self.active is not None:
            self.active.copy(old, new, len(field_points(old)))
        if self.fields == "last":
            new["fields"].attrs.modify("point", old["fields"].attrs["point"])
        self._copy_checksums(old, new, points)
        new.attrs.modify("points", points)

    def _copy_checksums(self, old, new, points):
        """Copy the checksums of the points that count; make those that an older program did not."""
        known = (old["checksums"][:points] if "checksums" in old
                 else np.zeros((points, 0), "u4"))
        sums = np.zeros((points, 1 + self._sums), "u4")
        if known.shape[1] < sums.shape[1]:
            sums[:, 0] = checksums.rows({name: new["branch"][name][:] for name in self.columns})
            held = active.datasets(new) if self.active else {}
            for place, point in enumerate(field_points(old)):
                sums[point, 1:] = [
                    *([active.checksum(active.kept(held, place))] if held else []),
                    *(checksums.of(new["fields"][name][place]) for name in self.arrays)]
        sums[:, : known.shape[1]] = known
        new["checksums"].resize(points, axis=0)
        new["checksums"][:] = sums

    def put(self, file, first, points, states):
        """Write points; what makes it safe is the order, held by the flushes.

        Parameters
        ----------
        file : h5py.File
        first : int, number of the first one, from 1
        points : list of `stored.Kept`
        states : mapping of the numbers of the last of them to their packed states
        """
        last, kept = first + len(points) - 1, self._kept(points)
        if self.fields == "last" and kept:
            file["fields"].attrs.modify("point", 0)
            file.flush()
        for name in self.arrays:
            if self.fields == "all":
                file["fields"][name].resize(last, axis=0)
            for place, point in zip(range(-len(kept), 0), kept):
                for where, block in self._blocks(name, point):
                    file["fields"][name][(place, *where)] = block
        if self.active is not None:
            every = self.fields == "all"
            self.active.put(file, first - 1 if every else 0, points if every else points[-1:])
        rows = {name: np.array([point.row[name] for point in points], column.stored)
                for name, column in self.columns.items()}
        file["checksums"].resize(last, axis=0)
        file["checksums"][first - 1:] = self._checksums(rows, points)
        put_rows(file["branch"].id, first, len(points), rows)
        for number, state in states.items():
            put_state(file[f"states/{number % SLOTS}"], state)
        file.flush()
        if self.fields == "last" and kept:
            file["fields"].attrs.modify("point", last)
        file.attrs.modify("points", last)
        file.flush()

    def _kept(self, points):
        """Those of some points whose fields are kept; a last one that waited in a journal without
        them has none, and those that are there stay."""
        return points if self.fields == "all" else points[-1:] if points[-1].fields else []

    def _checksums(self, rows, points):
        """Checksums of points: of their rows, and of the fields that are kept, lacking ones
        included."""
        sums, kept = np.zeros((len(points), 1 + self._sums), "u4"), self._kept(points)
        sums[:, 0] = checksums.rows(rows)
        for own, point in zip(sums[len(points) - len(kept):], kept):
            own[1:] = [*([active.checksum(point.fields)] if self.active else []),
                       *(checksums.of(*(block for _, block in self._blocks(name, point)))
                         for name in self.arrays)]
        return sums

    @property
    def parted(self):
        """Whether processes have parts of the fields."""
        return isinstance(self.initial_gap, Parted)

    def _pieces(self):
        """What picks parts of a field that are read and written together."""
        return pieces(self.shape) if self.parted else [()]

    def _blocks(self, name, point):
        """Blocks of a field of a point (`stored.Kept`), nan where it has none, as of
        `parted.blocks`."""
        if name in point.fields:
            return blocks(point.fields[name])
        return ((where, np.full((*(ends.stop - ends.start for ends in where),
                                 *self.shape[len(where):]), np.nan, self.kind))
                for where in pieces(self.shape))
