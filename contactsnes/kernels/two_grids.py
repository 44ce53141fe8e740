"""A component of a linear system on two grids, in the library: what `solvers.two_grids.Patches`
does."""

import ctypes
from weakref import WeakValueDictionary

import numpy as np

from . import structures
from .asked import sums
from .forms import call
from .library import shared
from .structures import address

INNER = 30
"""Iterations of a system of patches, as kernels.h has it."""


def patch_nodes(patch, points):
    """How many nodes each patch has.

    Parameters
    ----------
    patch : array (nodes) of int32, the patch of each
    points : int, patches
    """
    number = np.empty(points)
    shared().patch_nodes(len(patch), address(patch), points, address(number))
    return number


class Room:
    """Arrays that systems of so many patches work in, one after the other, by their names in
    `structures.TwoGrids`.

    Parameters
    ----------
    points, kind : int, type of their numbers
    """

    _held = WeakValueDictionary()

    def __init__(self, points, kind):
        self.sums, self.matrix = np.empty(2 * points), np.zeros((INNER, INNER + 1))
        self.rows = np.empty((INNER + 1, points), dtype=kind)
        self.made = np.empty((INNER, points), dtype=kind)

    @classmethod
    def of(cls, points, kind):
        """The one that others hold, or a new one; parameters as of the class."""
        found = cls._held.get((points, kind)) or cls(points, kind)
        return cls._held.setdefault((points, kind), found)


class OnTwoGrids:
    """What two grids make of a field.

    Parameters
    ----------
    grid : Grid, whose counter counts
    plan : compiled transform of the circle of patches, whose precision all have
    patch : array (nodes) of int32, the place of each node's patch
    number : array (patches), how many nodes each has, at least one
    area, left : floats, nodes of a patch, and the part of its right side that is left of the system
        of patches
    within : float, compliance of waves within patches
    """

    def __init__(self, grid, plan, patch, number, area, left, within):
        own = self.structure = structures.TwoGrids(area=area, left=left, compliant=within,
                                                    nodes=len(patch), points=plan.real.size)
        if grid.shared:
            own.add_up = sums(grid.add_up)
        self._counter, self._room = grid.counter, Room.of(plan.real.size, plan.real.dtype)
        self._kept = {}
        self.take(patch=patch, number=number, **vars(self._room),
                   inverse=np.empty(len(patch), dtype=plan.real.dtype))
        own.transform, self._plan = ctypes.pointer(plan.structure), plan
        self._reference = ctypes.addressof(own)

    def take(self, **arrays):
        """Take arrays, of the transform's precision or as kernels.h has them, by their names in
        `structures.TwoGrids`."""
        for name, array in arrays.items():
            self._kept[name] = np.ascontiguousarray(array)
            setattr(self.structure, name, address(self._kept[name]))

    def weigh(self, tangent):
        """Take the weights q = 1 / (1 + c D) of nodes, of a tangent D; their sums over patches."""
        tangent = np.ascontiguousarray(tangent)
        shared().weigh_nodes(self._reference, address(tangent))
        return self._room.sums[:self.structure.points].copy()

    @property
    def stands(self):
        """What stands for patches (patches) in what was made of a field last, which is that, the
        field and weights of nodes."""
        return self._room.sums[:self.structure.points]

    def add(self, rows, factors, stood, out):
        """Add what was made of the sum of fields times factors.

        Parameters
        ----------
        rows : addresses of rows and of their scales, of `kernels.krylov.Rows`
        factors : array, of the first of them
        stood : list of arrays, what stood for patches (`stands`) in what was made of each
        out : array (nodes), which is added to
        """
        sums = self.stands
        sums[...] = 0.0
        for factor, each in zip(factors, stood):
            sums += factor * each
        shared().add_from_patches(self._reference, len(factors), *rows, address(factors),
                                  address(out))

    @property
    def matrix(self):
        """The Hessenberg matrix of what was solved on patches last."""
        count = self.structure.count
        return self._room.matrix[:count, :count].T

    def __call__(self, field):
        """Replace a field (nodes); the Hessenberg matrix of what was solved on patches."""
        call(shared().on_two_grids, self._counter, self._reference, *2 * [address(field)])
        return self.matrix
