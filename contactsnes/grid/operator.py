"""A circulant operator on the cell, by its symbols, and its kernels."""

import math
from itertools import product
from types import MappingProxyType

import numpy as np


class Operator:
    """A circulant operator on the cell: blocks {(i, j): half spectrum}, those left out zero, and
    their kernels on demand.

    The blocks carry the factor 1/size that unnormalised transforms need.

    Parameters
    ----------
    grid : Grid
    symbols : {(i, j): half spectrum} on the cell
    make : what makes transforms, as `cell.Transform`; None: as the grid has it
    others : {key: operator on the cell}, which may have kernels of the same blocks
    """

    def __init__(self, grid, symbols, make=None, others=MappingProxyType({})):
        self.grid, self._make, self._others = grid, make or grid.transform, others
        self.blocks, self._kernels = {}, {}
        for key, symbol in symbols.items():
            # column after column, as the library takes them: it makes no copy
            self.blocks[key] = self._alike(key, np.divide(symbol, grid.size, order="F"))

    def _alike(self, key, block):
        """A block, or one known that is the same: across the diagonal, or another operator's."""
        known = (operator.blocks.get(place) for operator in (self, *self._others.values())
                 for place in {key, key[::-1]})
        return next((other for other in known if other is not None
                     and np.array_equal(other, block)), block)

    def kernel(self, key):
        """Real-space kernel of a block over the cell: the response at each lag to a unit at lag
        0."""
        if key not in self._kernels:
            known = (other._kernels[key] for other in self._others.values() if key in other._kernels
                     and not self.grid.any(other.blocks[key] != self.blocks[key]))
            found = next(known, None)
            self._kernels[key] = self._transformed(key) if found is None else found
        return self._kernels[key]

    def _transformed(self, key):
        """Kernel of a block, by a transform."""
        plan = self._make(self.grid, self.grid.shape, 1)
        plan.spectrum[0] = self.blocks[key]
        plan.backward()
        return plan.real[0].copy()

    def kernel_at(self, key, lags):
        """(first row and number of rows, kernel there) of this process's part of the lags of a
        plane, in another process's or its own; on a line all of them.

        Parameters
        ----------
        key : (i, j), of the block
        lags : slice from 0 on for each direction
        """
        return self.grid.first_part(self.kernel(key), lags)

    def on_window(self, key, window):
        """The block on the padded circle of a window."""
        shape = window.circle()
        if shape == self.grid.shape:
            return self.blocks[key]
        symbol = self.between(key, window.shape, self.circle(shape), (0,) * len(shape))
        # An even block stays even on the circle.
        return symbol.real.copy() if np.isrealobj(self.blocks[key]) else symbol

    def circle(self, shape):
        """A transform on a circle of some points in each direction, for `between`."""
        return self._make(self.grid, shape, 1)

    def between(self, key, extents, plan, offset):
        """The block on a circle for the response of a box of given extents to another, ``offset``
        nodes before it.

        Parameters
        ----------
        key : (i, j), components of the block
        extents : nodes of either box in each direction
        plan : transform on the circle
        offset : nodes from the second box to the first in each direction
        """
        kernel = self.kernel(key)
        plan.real[...] = 0.0
        for runs in product(*map(_runs, extents, plan.shape, offset, self.grid.shape)):
            there, lags = zip(*runs)
            plan.real[0][there] = kernel[lags]
        plan.forward()
        return plan.spectrum[0] / math.prod(plan.shape)


def _runs(extent, points, offset, total):
    """Where lags between the nodes of two lines stand on a circle, and in a cell, slices for each
    run of them.

    Parameters
    ----------
    extent, points, offset, total : of one direction, as of `Operator.between`, and points of the
        cell
    """
    # those backwards, then those forwards, which are all of them on the cell's own circle
    parts = [(points - extent + 1, offset - extent + 1, extent - 1)] if points < total else []
    found = []
    for place, lag, left in (*parts, (0, offset, extent if parts else points)):
        while left:
            lag %= total
            count = min(left, total - lag)
            found.append((slice(place, place + count), slice(lag, lag + count)))
            place, lag, left = place + count, lag + count, left - count
    return found
