"""Fields of an archive on the nodes where the law acts, and the cell's fields from them.

Elsewhere there is no traction, and u = mean - C t tells the displacement (C: the body's compliance,
a circulant). The group ``fields/active`` holds of point k the entries offsets[k] to offsets[k + 1]
of ``nodes`` (numbers of nodes in the fields, the last direction fastest), ``displacement`` and
``traction`` (components, entries), its ``mean`` (components), and ``compliance``: half spectra of
C's blocks over the points of a ``circle``, named by their components; with the factor that
transforms need which are not normalised.
"""

import math

import numpy as np

from ..grid.cell import Convolution, Grid
from ..grid.operator import Operator
from ..grid.parted import blocks, in_pieces, typed
from ..grid.windows import Window
from . import checksums
from .files import ArchiveError

NODES = {"nodes": "i8", "displacement": None, "traction": None}
"""Datasets with an entry for each node, and NumPy's type; None: that of fields."""

ROOM = 1 << 12
"""Nodes that there is room for at least."""


class ActiveFields:
    """What an archive that is being written keeps of points on the nodes where the law acts.

    Parameters
    ----------
    components : int, of displacement and traction
    kind : str, NumPy's type of the fields
    compliance : (points of the circle, mapping of (i, j) to the half spectrum of a block of C)
    points : all of them ('all'), or the 'last'
    chunks : int, chunks of a dataset at most
    packing : mapping, how a dataset is compressed

    Attributes
    ----------
    coming : int, nodes of the points that are to be written next
    """

    def __init__(self, components, kind, compliance, points, chunks, packing):
        self.components, self.kind, self.compliance = components, kind, compliance
        self.points, self.chunks, self.packing = points, chunks, packing
        self.coming = self._held = self._room = 0

    def checked(self, given):
        """A point's arrays as they are stored; ArchiveError where they do not fit each other."""
        nodes = typed(given["nodes"], NODES["nodes"])
        found = {"nodes": nodes, "mean": np.asarray(given["mean"], float)}
        for name in ("displacement", "traction"):
            found[name] = typed(given[name], self.kind)
            if found[name].shape != (self.components, nodes.size):
                raise ArchiveError(f"{name} on active nodes has the shape {found[name].shape}; the "
                                   f"archive keeps {(self.components, nodes.size)}.")
        return found

    def expect(self, points):
        """Be told of the points (`stored.Kept`) that are to be written next."""
        kept = points if self.points == "all" else points[-1:]
        self.coming = sum(point.fields["nodes"].size for point in kept)

    def fits(self):
        """Whether there is room in the file for what is coming."""
        return self._before() + self.coming <= self._room

    def more(self):
        """Bytes by which the file grows for what is coming."""
        chunk = self._room // self.chunks
        grown = -(-(self._before() + self.coming) // chunk) - -(-self._before() // chunk)
        return grown * chunk * (8 + 2 * self.components * int(self.kind[1:]))

    def _before(self):
        return self._held if self.points == "all" else 0

    def make(self, group, chunk, packed):
        """Make empty datasets in the group of fields; their group.

        Parameters
        ----------
        group : h5py.Group
        chunk : int, points that are allocated at once
        packed : bool, whether they are compressed: of an archive to which nothing is added
        """
        active = group.create_group("active")
        each = max(ROOM, -(-2 * (self._before() + self.coming) // self.chunks))
        self._room = each * self.chunks
        packing = self.packing if packed else {}
        for name, kind in NODES.items():
            lead, kind = ((), kind) if kind else ((self.components,), self.kind)
            active.create_dataset(name, (*lead, 0), kind, chunks=(*lead, each),
                                  maxshape=(*lead, None),
                                  fillvalue=-1 if name == "nodes" else np.nan, **packing)
        active.create_dataset("offsets", data=[0], dtype="i8", chunks=(chunk * self.chunks,),
                              maxshape=(None,))
        active.create_dataset("mean", (0, self.components), "f8", maxshape=(None, self.components),
                              chunks=(chunk * self.chunks, self.components))
        circle, symbols = self.compliance
        for (i, j), block in symbols.items():
            made = active.create_dataset(f"compliance/{i}{j}", block.shape, block.dtype,
                                         **self.packing, **in_pieces(block))
            for where, values in blocks(block):
                made[where] = values
        active["compliance"].attrs["circle"] = circle
        return active

    def put(self, file, place, points):
        """Write points from a place on.

        Parameters
        ----------
        file : h5py.File
        place : int, of the first one among those with fields, from 0
        points : list of `stored.Kept`
        """
        active = file["fields/active"]
        for count, point in enumerate(points, place):
            begin = int(active["offsets"][count])
            end = begin + point.fields["nodes"].size
            _set(active["offsets"], count + 1, end)
            for name in NODES:
                active[name].resize(end, axis=active[name].ndim - 1)
                put_behind(active[name], begin, point.fields[name])
            _set(active["mean"], count, point.fields["mean"])
            self._held = end

    def copy(self, old, new, count):
        """Copy points of one archive to another.

        Parameters
        ----------
        old, new : h5py.File, the second without points
        count : int, points with fields
        """
        there, here = old["fields/active"], new["fields/active"]
        offsets = there["offsets"][:count + 1]
        for name in NODES:
            here[name].resize(int(offsets[-1]), axis=here[name].ndim - 1)
            # a chunk at a time, which is compressed but once
            each, last = here[name].chunks[-1], int(offsets[-1])
            for begin in range(0, last, each):
                part = slice(begin, min(begin + each, last))
                here[name][..., part] = there[name][..., part]
        for name in ("offsets", "mean"):
            values = there[name][:count + (name == "offsets")]
            here[name].resize(len(values), axis=0)
            here[name][:] = values
        self._held = int(offsets[-1])


def _set(dataset, row, value):
    """Write a row of a dataset, made longer where it ends before."""
    if len(dataset) <= row:
        dataset.resize(row + 1, axis=0)
    dataset[row] = value


def put_behind(dataset, begin, values):
    """Write values (..., nodes) into a dataset from a node on.

    Parameters
    ----------
    dataset : h5py.Dataset, which has room for them
    begin : int
    values : array, perhaps `Parted`
    """
    for where, block in blocks(values):
        *lead, nodes = where or (slice(0, values.shape[-1]),)
        lead = lead or (...,)
        dataset[(*lead, slice(begin + nodes.start, begin + nodes.stop))] = block


def checksum(arrays):
    """CRC-32 of what is kept of a point, a mapping."""
    return checksums.of(*(arrays[name] for name in (*NODES, "mean")))


def datasets(file):
    """Where an open archive keeps fields on active nodes, name -> h5py.Dataset."""
    return {name: file["fields/active"][name] for name in ("offsets", *NODES, "mean")}


def kept(held, place):
    """What `datasets` hold of the point at a place (from 0) among those with fields."""
    begin, end = held["offsets"][place:place + 2]
    return {name: held[name][..., begin:end] for name in NODES} | {"mean": held["mean"][place]}


class Rebuilt:
    """The cell's fields, rebuilt from those on active nodes by one convolution.

    Parameters
    ----------
    file : h5py.File, the open archive
    """

    def __init__(self, file):
        shape = tuple(int(n) for n in file.attrs["shape"])
        self.shape, grid = shape, shape[1:]
        self.kind = file["fields/active/displacement"].dtype
        compliance = file["fields/active/compliance"]
        circle = Grid(compliance.attrs["circle"], (1.0,) * len(grid))
        operator = Operator(circle, {tuple(map(int, name)): dataset[()] * circle.size
                                     for name, dataset in compliance.items()})
        self._convolution = Convolution(Window(circle, (0,) * len(grid), grid), operator, shape[0])

    def __call__(self, name, arrays):
        """The displacement or traction (components, *grid) of a point.

        Parameters
        ----------
        name : {'displacement', 'traction'}
        arrays : mapping, `kept`
        """
        nodes, field = arrays["nodes"], np.zeros((self.shape[0], math.prod(self.shape[1:])))
        field[:, nodes] = arrays["traction"]
        if name == "displacement":
            self._convolution.apply(field, field)
            np.subtract(arrays["mean"][:, None], field, out=field)
            field[:, nodes] = arrays["displacement"]
        return field.reshape(self.shape).astype(self.kind, copy=False)
