"""A component of a linear system on two grids, in the library: what `solvers.two_grids.Patches`
does."""

import ctypes

import numpy as np

from . import structures
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
    """

    def __init__(self, grid, plan, patch, number, area, left):
        own = self._structure = structures.TwoGrids(area=area, left=left, nodes=len(patch),
                                                    points=plan.real.size)
        kind, points = plan.real.dtype, plan.real.size
        self._counter, self._matrix = grid.counter, np.zeros((INNER, INNER + 1))
        self._sums, self._kept = np.empty(3 * points), {}
        self._keep(patch=patch, number=number, sums=self._sums, matrix=self._matrix,
                   rows=np.empty((INNER + 1, points), dtype=kind),
                   made=np.empty((INNER, points), dtype=kind),
                   inverse=np.empty(len(patch), dtype=kind),
                   response=np.empty(len(patch), dtype=kind))
        own.transform, self._plan = ctypes.pointer(plan.structure), plan
        self._reference = ctypes.addressof(own)

    def _keep(self, **arrays):
        """Take arrays by their names in `structures.TwoGrids`."""
        for name, array in arrays.items():
            self._kept[name] = np.ascontiguousarray(array)
            setattr(self._structure, name, address(self._kept[name]))

    def weigh(self, within, tangent):
        """Take the weights q = 1 / (1 + c D) and D q of nodes; their sums over patches, (patches,
        2).

        Parameters
        ----------
        within : float, c
        tangent : array (nodes), D
        """
        tangent = np.ascontiguousarray(tangent)
        shared().weigh_nodes(self._reference, within, address(tangent))
        return self._sums[:2 * self._structure.points].reshape(-1, 2).copy()

    def take(self, **arrays):
        """Take what belongs to patches, by its names in `structures.TwoGrids`."""
        kind = self._kept["rows"].dtype
        self._keep(**{name: array if name in ("mean", "within") else array.astype(kind, copy=False)
                      for name, array in arrays.items()})

    def __call__(self, field):
        """Replace a field (nodes); the Hessenberg matrix of what was solved on patches."""
        call(shared().on_two_grids, self._counter, self._reference, address(field))
        count = self._structure.count
        return self._matrix[:count, :count].T
