"""The periodic grid, windows of it, planned real transforms and every reduction over nodes.

Conventions: N points in a direction of period L, node i at x_i = (i - N/2) L / N; f(x) = sum_q f(q)
exp(+iqx), the sign of numpy's ``irfft``. Transforms here are not normalised: forward then backward
multiplies by the number of points.
"""

import math
from functools import cached_property

import numpy as np
import pyfftw
from scipy.fft import next_fast_len

from .contours import area_below, at_level, crossings, ringed
from .counter import Counter


class Transform:
    """A planned pair of real transforms of ``count`` arrays of one shape, on aligned memory.

    Plans are estimated, not measured: what was fastest on a busy machine would decide the last
    bits. Write to ``real``, call ``forward``, work on ``spectrum``, call ``backward``, read
    ``real`` again: it is overwritten, its padding too, and ``spectrum`` does not survive.
    """

    def __init__(self, grid, shape, count):
        axes = tuple(range(1, 1 + len(shape)))
        self.shape, self.gain = shape, math.prod(shape)
        self.real = pyfftw.zeros_aligned((count, *shape))
        self.spectrum = pyfftw.zeros_aligned((count, *shape[:-1], shape[-1] // 2 + 1),
                                             dtype=complex)
        plan = {"axes": axes, "threads": 1, "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        self._forward = pyfftw.FFTW(self.real, self.spectrum, **plan)
        self._backward = pyfftw.FFTW(self.spectrum, self.real, direction="FFTW_BACKWARD", **plan)
        self._counter = grid.counter
        self._cost = count * transform_cost(math.prod(shape), grid.counter.size)

    def forward(self):
        """``real`` to ``spectrum``."""
        self._counter.transforms += self._cost
        self._forward.execute()

    def backward(self):
        """``spectrum`` to ``real``."""
        self._counter.transforms += self._cost
        self._backward.execute()


def transform_cost(points, size):
    """Cost of a real transform of ``points`` points in units of one of ``size`` points: m log m /
    (N log N)."""
    return points * math.log(max(points, 2)) / (size * math.log(size))


class Grid(Counter):
    """The periodic grid of the cell: wave vectors, transforms and their count, reductions over
    nodes.

    Parameters
    ----------
    shape : points in each direction, one or two even numbers
    periods : period in each direction, beta
    counter : Counter (a grid is one) of this one's transforms, in its own units (default this
        one)
    """

    def __init__(self, shape, periods, counter=None):
        self.shape = tuple(shape)
        self.periods = tuple(float(period) for period in periods)
        self.spacings = tuple(period / points for period, points in zip(self.periods, self.shape))
        super().__init__(math.prod(self.shape))
        self.area = math.prod(self.periods)
        self.node_area = self.area / self.size
        self.counter = self if counter is None else counter
        self.whole = Window(self, (0,) * len(shape), self.shape)

    def coordinates(self):
        """Coordinates of the nodes, beta: one array a direction, shaped to broadcast over the
        grid."""
        axes = [(np.arange(n) - n // 2) * h for n, h in zip(self.shape, self.spacings)]
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    def wavevectors(self, shape=None):
        """Wave numbers of the half spectrum of a circle of ``shape`` points (default the cell),
        1/beta, to broadcast."""
        shape = self.shape if shape is None else shape
        axes = [2 * np.pi * np.fft.fftfreq(n, h) for n, h in zip(shape[:-1], self.spacings)]
        axes.append(2 * np.pi * np.fft.rfftfreq(shape[-1], self.spacings[-1]))
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    # Reductions over nodes, the last axis of an array (components, nodes).
    def sum(self, values):
        """Sum over the nodes (last axis)."""
        return np.add.reduce(values, axis=-1)

    def mean(self, values):
        """Mean over the whole cell of values that vanish off the given nodes (last axis)."""
        return np.add.reduce(values, axis=-1) / self.size

    def maximum(self, values, where=True, initial=-np.inf):
        """Largest value over all nodes and components."""
        return np.max(values, initial=initial, where=where)

    def minimum(self, values, where=True, initial=np.inf):
        """Smallest value over all nodes and components."""
        return np.min(values, initial=initial, where=where)

    def inner(self, first, second):
        """Inner product over nodes and components."""
        return float(np.vdot(first, second))

    def norm(self, values):
        """Euclidean norm over nodes and components, and what scalars an unknown carries besides."""
        return float(np.sqrt(self.inner(values, values)))

    def parseval(self, spectrum):
        """Sum over nodes and arrays of the squares of fields (..., *grid) with these half
        spectra."""
        squares = np.square(spectrum.real) + np.square(spectrum.imag)
        paired = 2.0 * squares.sum() - squares[..., 0].sum()
        if self.shape[-1] % 2 == 0:
            paired -= squares[..., -1].sum()
        return float(paired / self.size)

    def spectral_inner(self, first, second):
        """Real inner product of half spectra of the cell (arrays, *half spectrum): interior columns
        stand for two waves."""
        ends = sum(np.vdot(first[..., k], second[..., k]).real for k in (0, -1))
        return 2.0 * np.vdot(first, second).real - ends

    def count(self, mask):
        """Number of nodes where ``mask`` holds."""
        return int(np.count_nonzero(mask))


class Window:
    """A box of the cell's nodes, which may wrap around its border, as one flat index of nodes.

    Parameters
    ----------
    grid : the cell
    start : first node in each direction; 0 is taken in directions that the window fills
    shape : nodes in each direction
    """

    even = False  # whether a node stands for its mirror images, too

    def __init__(self, grid, start, shape):
        self.grid = grid
        self.shape = tuple(int(n) for n in shape)
        self.start = tuple(int(s) % total if n < total else 0
                           for s, n, total in zip(start, self.shape, grid.shape))
        self.size, self.limits = math.prod(self.shape), grid.shape
        self.closed = tuple(n == total for n, total in zip(self.shape, grid.shape))

        self._which = self.start, self.shape, grid.shape, grid.periods

    def __eq__(self, other):
        """Whether these are the same nodes of the same cell, whoever counts its transforms."""
        return type(self) is type(other) and self._which == other._which

    def __hash__(self):
        return hash(self._which)

    @property
    def parts(self):
        """The boxes of which the window is made: one."""
        return (self,)

    @property
    def is_whole(self):
        """Whether the window is the whole cell."""
        return self.shape == self.grid.shape

    @cached_property
    def indices(self):
        """What picks the window's nodes from a field over the cell: slices, or an open mesh if it
        wraps around the border."""
        if all(s + n <= total for s, n, total in zip(self.start, self.shape, self.grid.shape)):
            return tuple(slice(s, s + n) for s, n in zip(self.start, self.shape))
        return np.ix_(*((s + np.arange(n)) % total for s, n, total in zip(self.start, self.shape,
                                                                          self.grid.shape)))

    def coordinates(self):
        """Coordinates of the window's nodes, beta, continued over the cell's border, to broadcast
        over the box."""
        axes = [(s + np.arange(n) - total // 2) * h
                for s, n, total, h in zip(self.start, self.shape, self.grid.shape,
                                          self.grid.spacings)]
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at the window's nodes: a view if that is the
        whole cell."""
        lead = field.shape[:field.ndim - len(self.shape)]
        picked = field if self.is_whole else field[(..., *self.indices)]
        return np.ascontiguousarray(picked).reshape(*lead, self.size)

    def put(self, values, field):
        """Write values (..., nodes) into a field (..., *grid) at the window's nodes."""
        field[(..., *self.indices)] = values.reshape(*values.shape[:-1], *self.shape)

    def box(self, values):
        """View values (..., nodes) as (..., *box)."""
        return values.reshape(*values.shape[:-1], *self.shape)

    def rim(self):
        """Mask of the nodes on the border of the box, in directions that the window does not
        fill."""
        mask = np.zeros(self.shape, dtype=bool)
        for axis, closed in enumerate(self.closed):
            if not closed:
                np.moveaxis(mask, axis, 0)[[0, -1]] = True
        return mask.reshape(-1)

    def area_below(self, values, level):
        """Length or area where values (nodes) lie below a level, its edge interpolated between
        nodes.

        Cubic in each direction. Beyond the window nothing is below; a window that is the whole cell
        closes on itself.
        """
        box = self.box(values)
        if len(self.shape) == 2:
            return area_below(ringed(box, self.closed), level) * self.grid.node_area
        box = np.append(box, box[0]) if self.is_whole else box
        places, signs = crossings(box, level)
        ends = [*([0.0] if box[0] < level else []), *places, *([len(box) - 1.0] if box[-1] < level
                                                               else [])]
        return self.grid.node_area * float(np.sum(np.diff(ends)[::2]))

    def at_level(self, values, level, fields):
        """Fields (components, nodes) where values (nodes) cross a level between nodes, (components,
        crossings)."""
        values, *fields = ringed(self.box(np.concatenate([values[None], fields])), self.closed)
        return at_level(values, level, np.array(fields))

    def circle(self):
        """Shape of the circulant that holds a convolution of the window: padded, or the cell where
        that is smaller."""
        return tuple(total if 2 * n - 1 >= total
                     else min(total, next_fast_len(2 * n - 1, real=True))
                     for n, total in zip(self.shape, self.grid.shape))


def enclosing(grid, mask, margin):
    """The smallest window around the nodes where ``mask`` (over the cell) holds, cyclic, widened on
    each side.

    Wider on a side by two nodes and the part ``margin`` of its extent. A direction in which padding
    would not be shorter than the cell is taken whole. Without any node: two by two nodes at the
    cell's middle.
    """
    start, shape = [], []
    for axis, total in enumerate(grid.shape):
        others = tuple(i for i in range(mask.ndim) if i != axis)
        line = np.flatnonzero(mask.any(axis=others))
        if line.size == 0:
            first, extent = total // 2 - 1, 2
        else:
            gaps = np.diff(np.append(line, line[0] + total))
            widest = int(np.argmax(gaps))
            first, extent = int(line[(widest + 1) % line.size]), total - int(gaps[widest]) + 1
            wider = 2 + int(margin * extent)
            first, extent = first - wider, extent + 2 * wider
        if 2 * extent - 1 >= total:
            first, extent = 0, total
        start.append(first)
        shape.append(extent)
    return Window(grid, start, shape)


class Operator:
    """A circulant operator on the cell: blocks {(i, j): half spectrum}, those left out zero, and
    their kernels on demand.

    The blocks carry the factor 1/size that unnormalised transforms need.
    """

    def __init__(self, grid, symbols):
        self.grid = grid
        self.blocks = {key: symbol / grid.size for key, symbol in symbols.items()}
        self._kernels = {}

    def kernel(self, key):
        """Real-space kernel of a block over the cell: the response at each lag to a unit at lag
        0."""
        if key not in self._kernels:
            plan = Transform(self.grid, self.grid.shape, 1)
            plan.spectrum[0] = self.blocks[key]
            plan.backward()
            self._kernels[key] = plan.real[0]
        return self._kernels[key]

    def on_window(self, key, window):
        """The block on the padded circle of a window."""
        shape = window.circle()
        if shape == self.grid.shape:
            return self.blocks[key]
        symbol = self.between(key, window.shape, shape, (0,) * len(shape))
        # An even block stays even on the circle.
        return symbol.real.copy() if np.isrealobj(self.blocks[key]) else symbol

    def between(self, key, extents, circle, offset):
        """The block on a circle for the response of a box of given extents to another, ``offset``
        nodes before it."""
        lags = [(np.concatenate([np.arange(0, n), np.zeros(m - 2 * n + 1, int),
                                 np.arange(-n + 1, 0)]) if m < total else np.arange(total)) + away
                for n, m, total, away in zip(extents, circle, self.grid.shape, offset)]
        plan = Transform(self.grid, circle, 1)
        plan.real[0] = self.kernel(key)[np.ix_(*(lag % total
                                                 for lag, total in zip(lags, self.grid.shape)))]
        for axis, (n, m, total) in enumerate(zip(extents, circle, self.grid.shape)):
            if m < total:
                np.moveaxis(plan.real[0], axis, 0)[n:m - n + 1] = 0.0
        plan.forward()
        return plan.spectrum[0] / math.prod(circle)


class Convolution:
    """Product of a circulant operator of the cell with fields on a window: exact for the periodic
    cell.

    Parameters
    ----------
    window : the nodes that carry fields
    operator : Operator on the cell
    count : number of components
    """

    def __init__(self, window, operator, count):
        self.window, self.count = window, count
        self.transform = Transform(window.grid, window.circle(), count)
        self.blocks = {key: operator.on_window(key, window) for key in operator.blocks}
        self._inside = (slice(None), *(slice(0, n) for n in window.shape))
        self._diagonal = set(self.blocks) == {(i, i) for i in range(count)}
        self._product = (None if self._diagonal
                         else np.empty_like(self.transform.spectrum[:, :self._rows()]))

    def apply(self, values, out, transposed=False):
        """out (components, nodes) = operator, or its transpose, times values (components, nodes),
        perhaps the same array."""
        plan = self.transform
        plan.real[self._inside] = self.window.box(values)
        plan.forward()
        self.multiply(plan.spectrum, transposed)
        plan.backward()
        self.window.box(out)[...] = plan.real[self._inside]
        clear_padding(plan.real, self.window.shape)
        return out

    def multiply(self, spectrum, transposed=False):
        """Multiply a spectrum (components, *half spectrum) by the blocks, or by their transpose, in
        place."""
        if self._diagonal:
            for i in range(self.count):
                spectrum[i] *= self.blocks[i, i]
            return
        rows = self._rows()
        for first in range(0, spectrum.shape[1], rows):
            part = spectrum[:, first:first + rows]
            product = self._product[:, :part.shape[1]]
            np.copyto(product, part)
            part[...] = 0.0
            for (i, j), block in self.blocks.items():
                if transposed:
                    part[j] += block[first:first + rows].conj() * product[i]
                else:
                    part[i] += block[first:first + rows] * product[j]

    def _rows(self):
        """Rows of the spectrum that are multiplied at a time: few enough to stay in the processor's
        cache."""
        shape = self.transform.spectrum.shape[1:]
        return min(shape[0], max(1, 2 ** 14 * shape[0] // math.prod(shape)))


def clear_padding(real, shape):
    """Set to zero what a buffer (count, *circle) holds beyond a box of the given shape."""
    for axis, extent in enumerate(shape, start=1):
        if extent < real.shape[axis]:
            real[(*[slice(None)] * axis, slice(extent, None))] = 0.0
