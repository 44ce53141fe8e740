"""Fields that are even about the apex: half a line or a quarter of a plane of their nodes, weights,
transforms, convolutions.

A node at distance d from the apex in a direction stands for those at -d and d: it counts twice, but
once on the axis (d = 0) and where the cell closes on itself (d = N/2).
"""

import math

import numpy as np
import pyfftw
from scipy import fft

from .cell import Grid, clear_padding, transform_cost
from .windows import Window

UNEVEN = 1e-10
"""Largest difference of mirror images in an initial gap that counts as even, delta_n: what rounding
makes of one."""


def obstacle(contact, components):
    """Why displacements of a contact with so many components need not be even in every direction,
    in words; None if they are.

    What is asked is its initial gap on the grid, node by node, and which components of traction its
    body moves which others by.
    """
    if not contact.unevenness <= UNEVEN:
        return ("the initial gap is not even about the apex: its mirror "
                f"images differ by up to {contact.unevenness:.3g} delta_n, of "
                f"which {UNEVEN:g} is allowed")
    coupled = [(i, j) for i, j in contact.operator(components).blocks
               if i != j] if components > 1 else []
    if any(0 in pair for pair in coupled):
        return "the body couples tangential displacements, which are odd, to normal ones"
    if coupled:
        return "tangential displacements along and across a load are even in different directions"
    return None


def centred(window):
    """The smallest window about the apex, one box, that holds a window."""
    start, shape = [], []
    for axis, (extent, total) in enumerate(zip(window.shape, window.grid.shape)):
        ends = [end for part in window.parts for end in (total // 2 - part.start[axis],
                                                         part.start[axis] - total // 2 + extent
                                                         - 1)]
        reach = max(1, *ends)
        whole = extent == total or 2 * reach + 1 >= total
        start.append(0 if whole else total // 2 - reach)
        shape.append(total if whole else 2 * reach + 1)
    return Window(window.grid, start, shape)


def mirrored(field, axis):
    """Mirror image about the apex, along an axis, of an array that the cell's nodes fill there."""
    return np.roll(np.flip(field, axis), 1, axis)


def lone(window):
    """Mask of the nodes of a window (nodes) whose mirror image in some direction lies outside of
    it."""
    known = np.zeros((1, *window.grid.shape), dtype=bool)
    window.put(np.ones((1, window.size), dtype=bool), known)
    return window.take(np.any([known & ~mirrored(known, axis) for axis in range(1, known.ndim)],
                              axis=0))[0]


def asymmetry(window, values):
    """Largest difference of values (arrays, nodes) between mirror images in a window; inf if it
    does not hold the apex."""
    if len(window.parts) > 1:
        cell = np.full((len(values), *window.grid.shape), math.inf)
        window.put(values, cell)
        differences = (np.abs(cell - mirrored(cell, axis)) for axis in range(1, cell.ndim))
        with np.errstate(invalid="ignore"):
            return float(max(np.max(difference, where=np.isfinite(difference), initial=0.0)
                             for difference in differences))
    box, largest = window.box(values), 0.0
    for axis, (first, extent, total) in enumerate(zip(window.start, window.shape,
                                                      window.grid.shape), start=1):
        middle = (total // 2 - first) % total
        reach = min(middle, extent - 1 - middle)
        if reach < 0:
            return math.inf
        nodes = np.moveaxis(box, axis, 0)
        after, before = nodes[middle + 1:middle + 1 + reach], nodes[middle - reach:middle][::-1]
        largest = np.maximum(largest, np.max(np.abs(after - before), initial=0.0))
    return float(largest)


class EvenGrid(Grid):
    """A grid whose reductions run over half of the nodes of even fields (a quarter in the plane),
    each with its weight."""

    def __init__(self, grid, weights):
        vars(self).update(vars(grid))
        self.weights = weights

    def sum(self, values):
        """Sum over all nodes that the given ones stand for (last axis)."""
        return values @ self.weights

    def mean(self, values):
        """Mean over the whole cell of values that vanish off these nodes (last axis)."""
        return values @ self.weights / self.size

    def count(self, mask):
        """Number of nodes that those stand for where ``mask`` holds."""
        return int(np.sum(self.weights, where=mask))


def _flat(axes, shape):
    """Flat indices into a box of a shape of the nodes at given places along each direction."""
    return np.ravel_multi_index(np.ix_(*axes), shape).reshape(-1)


class EvenWindow:
    """The nodes of a centred window from the apex outwards, in each direction.

    Attributes
    ----------
    full : the window itself, on whose nodes states are known
    shape : nodes in each direction
    closed : whether the window fills a direction, where the cell closes on itself
    """

    even = True

    def __init__(self, full):
        cell = full.grid
        self.full, self.start = full, tuple(n // 2 for n in cell.shape)
        self.shape = tuple(n // 2 + 1 for n in full.shape)
        self.size = math.prod(self.shape)
        self.closed = tuple(n == total for n, total in zip(full.shape, cell.shape))
        self.limits = tuple(n // 2 + 1 for n in cell.shape)
        folded = [(n // 2 + np.arange(count)) % n for n, count in zip(full.shape, self.shape)]
        self._folded = _flat(folded, full.shape)
        self._unfolded = _flat([np.abs(np.arange(n) - n // 2) for n in full.shape], self.shape)
        weights = np.ones(())
        for n, closed in zip(self.shape, self.closed):
            line = np.full(n, 2.0)
            line[0] = 1.0
            if closed:
                line[-1] = 1.0
            weights = np.multiply.outer(weights, line)
        self.grid = EvenGrid(cell, weights.reshape(-1))

    box, parts = Window.box, Window.parts

    def fold(self, values):
        """Values (..., nodes) of the full window at these nodes."""
        return values.take(self._folded, axis=-1)

    def unfold(self, values):
        """Values (..., nodes) of the full window from those at these nodes."""
        return values.take(self._unfolded, axis=-1)

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at these nodes."""
        return self.fold(self.full.take(field))


class Cosines:
    """A pair of cosine transforms of ``count`` even arrays, with the interface of `cell.Transform`,
    in place.

    In each direction m points from the axis outwards. If they reach to the middle of the cell, the
    waves are those of the cell (type I, circle of 2 m - 2 points). Otherwise the fields go on oddly
    beyond the last point (types III and II, circle of 4 m points, on which waves of odd number
    only): the same as zeros there for a convolution that is padded, and faster.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction from the axis outwards
    count : int, number of arrays
    """

    def __init__(self, grid, shape, count):
        self.shape = shape
        self.real = self.spectrum = pyfftw.zeros_aligned((count, *shape))
        self.closed = tuple(m == n // 2 + 1 for m, n in zip(shape, grid.shape))
        self.gain = math.prod(2 * (m - 1) if closed else 2 * m
                              for m, closed in zip(shape, self.closed))
        self._counter = grid.counter
        self._cost = count * transform_cost(math.prod(shape), grid.counter.size)
        self._plans = self._plan(3), self._plan(2)

    def _plan(self, open_type):
        """{type: axes}, or on a line a plan, of the transforms with a given type in directions that
        are not closed."""
        kinds = [1 if closed else open_type for closed in self.closed]
        if len(kinds) == 1:
            # SciPy's transforms are the faster ones in the plane, but on a line its calls take
            # longer than they.
            name = {1: "FFTW_REDFT00", 2: "FFTW_REDFT10", 3: "FFTW_REDFT01"}[kinds[0]]
            return pyfftw.FFTW(self.real, self.real, axes=(1,), direction=name, threads=1,
                               flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"))
        return {kind: [axis for axis, own in enumerate(kinds, start=1) if own == kind]
                for kind in kinds}

    def _execute(self, plan):
        self._counter.transforms += self._cost
        if len(self.shape) == 1:
            plan.execute()
            return
        for kind, axes in plan.items():
            done = fft.dctn(self.real, kind, axes=axes, overwrite_x=True)
            if done is not self.real:
                self.real[...] = done

    def forward(self):
        """``real`` to ``spectrum``, which is the same memory."""
        self._execute(self._plans[0])

    def backward(self):
        """``spectrum`` to ``real``, times ``gain``."""
        self._execute(self._plans[1])

    def ordered(self, symbol):
        """A symbol on these waves in their order, which is that of their numbers."""
        return np.ascontiguousarray(symbol)

    def wavevectors(self, spacings):
        """Wave numbers, 1/beta, to broadcast."""
        axes = [np.pi / h * (np.arange(m) / (m - 1) if closed else (np.arange(m) + 0.5) / m)
                for m, h, closed in zip(self.shape, spacings, self.closed)]
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))


class EvenConvolution:
    """Product of an even circulant operator of the cell with even fields on an even window: as
    `cell.Convolution`.

    Parameters
    ----------
    window : EvenWindow
    operator : Operator on the cell, even
    count : int, number of components
    make : what makes its transform, as `Cosines` of a grid, a shape and a count
    """

    def __init__(self, window, operator, count, make=Cosines):
        self.window = window
        circle = tuple(limit if closed else fft.next_fast_len(2 * n - 1, real=True)
                       for n, limit, closed in zip(window.shape, window.limits, window.closed))
        self.transform = make(window.grid, circle, count)
        self.blocks = {(i, i): self._symbol(operator, (i, i)) for i in range(count)}
        self._inside = (slice(None), *(slice(0, n) for n in window.shape))

    def _symbol(self, operator, key):
        """The block on the waves of the circle."""
        plan, window = self.transform, self.window
        if all(window.closed):
            return plan.ordered(operator.blocks[key][tuple(slice(0, m) for m in plan.shape)])
        lags = tuple(slice(0, m if closed else 2 * n - 1)
                     for n, m, closed in zip(window.shape, plan.shape, window.closed))
        plan.real[0] = 0.0
        plan.real[(0, *lags)] = operator.kernel(key)[lags]
        plan.forward()
        return plan.spectrum[0] / plan.gain

    def apply(self, values, out, transposed=False):
        """Write the operator times values to out, which is returned.

        Parameters
        ----------
        values, out : arrays (components, nodes), perhaps the same one
        transposed : bool, of no effect: the operator is its transpose
        """
        plan = self.transform
        plan.real[self._inside] = self.window.box(values)
        clear_padding(plan.real, self.window.shape)
        plan.forward()
        for (i, _), symbol in self.blocks.items():
            plan.spectrum[i] *= symbol
        plan.backward()
        self.window.box(out)[...] = plan.real[self._inside]
        return out
