"""The periodic grid, its planned real transforms and convolutions, and every reduction over nodes.

Conventions: N points in a direction of period L, node i at x_i = (i - N/2) L / N; f(x) = sum_q f(q)
exp(+iqx), the sign of numpy's ``irfft``. Transforms here are not normalised: forward then backward
multiplies by the number of points.
"""

import math

import numpy as np
import pyfftw

from .contours import first_largest
from .counter import Counter
from .windows import Window


class Transform:
    """A planned pair of real transforms of ``count`` arrays of one shape, on aligned memory.

    Plans are estimated, not measured: what was fastest on a busy machine would decide the last
    bits. Write to ``real``, call ``forward``, work on ``spectrum``, call ``backward``, read
    ``real`` again: it is overwritten, its padding too, and ``spectrum`` does not survive.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction
    count : int, number of arrays
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


def _counted(values, where):
    """Values (..., nodes) where a mask, of all their axes or the last ones, holds: picking them
    takes a third of a reduction under a mask."""
    return values[(slice(None),) * (np.ndim(values) - np.ndim(where)) + (where,)]


def transform_cost(points, size):
    """Cost of a real transform of ``points`` points in units of one of ``size`` points: m log m /
    (N log N)."""
    return points * math.log(max(points, 2)) / (size * math.log(size))


class Grid(Counter):
    """The periodic grid of the cell: wave vectors, transforms and their count, reductions over
    nodes. ``comm`` is None, or the communicator of the processes among which nodes are shared out
    (`slabs`).

    Parameters
    ----------
    shape : points in each direction, one or two even numbers
    periods : period in each direction, beta
    counter : Counter (a grid is one) of this one's transforms, in its own units (default this
        one)
    """

    comm = None

    def __init__(self, shape, periods, counter=None):
        self.shape = tuple(shape)
        self.periods = tuple(float(period) for period in periods)
        self.spacings = tuple(period / points for period, points in zip(self.periods, self.shape))
        super().__init__(math.prod(self.shape))
        self.area = math.prod(self.periods)
        self.node_area = self.area / self.size
        self.counter = self if counter is None else counter
        self.whole = self._whole()

    def _whole(self):
        """The window of all nodes."""
        return Window(self, (0,) * len(self.shape), self.shape)

    @property
    def local_shape(self):
        """Shape of a field over the cell, as far as it is in this process."""
        return self.shape

    @property
    def transform(self):
        """What makes transforms over the cell."""
        return Transform

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

    def symbols(self, make, components, shape=None):
        """Blocks (i, j) -> half spectrum of a body on a circle.

        Parameters
        ----------
        make : `Body.compliance` or `Body.stiffness`
        components : int
        shape : points of the circle in each direction (default the cell)
        """
        shape = self.shape if shape is None else shape
        return make(self.wavevectors(shape), components, last_even=shape[-1] % 2 == 0)

    def zero_wave(self, spectrum):
        """The values at q = 0 of half spectra (..., *half spectrum), as a view."""
        return spectrum[(..., *[slice(0, 1)] * len(self.shape))]

    # Reductions over nodes, the last axis of an array (components, nodes).
    def sum(self, values):
        """Sum over the nodes (last axis)."""
        return np.add.reduce(values, axis=-1)

    def mean(self, values):
        """Mean over the whole cell of values that vanish off the given nodes (last axis)."""
        return np.add.reduce(values, axis=-1) / self.size

    def maximum(self, values, where=True, initial=-np.inf):
        """Largest value over all nodes and components.

        Parameters
        ----------
        values : array (components, nodes)
        where : mask of what counts, to broadcast
        initial : float, what is found where nothing counts
        """
        return np.maximum.reduce(values if where is True else _counted(values, where),
                                 axis=None, initial=initial)

    def minimum(self, values, where=True, initial=np.inf):
        """Smallest value over all nodes and components.

        Parameters
        ----------
        values : array (components, nodes)
        where : mask of what counts, to broadcast
        initial : float, what is found where nothing counts
        """
        return np.minimum.reduce(values if where is True else _counted(values, where),
                                 axis=None, initial=initial)

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

    # A field over the cell, or as much of it as this process has, and rows of others beside it.
    def with_rows(self, field, reach):
        """A field over the cell (..., *grid) with rows around what is here: nothing is missing."""
        return field

    def without_rows(self, field, reach):
        """The same without them."""
        return field

    def part_of(self, field):
        """What is here of a whole field over the cell (..., *grid): all."""
        return field

    def every_other(self, field):
        """A field over the cell (..., *grid) at every other node, a whole one."""
        return field[(..., *[slice(None, None, 2)] * len(self.shape))]

    @property
    def first_column(self):
        """Number of the first column of half spectra that is here."""
        return 0

    def quantiles(self, field, parts):
        """Values below which parts of a field over the cell lie, about."""
        return np.quantile(field, parts)

    def convex(self, gap, test):
        """Whether a gap over the cell is convex within it, by a test of arrays."""
        return test(gap)

    def edge(self, field, axis):
        """The first nodes of a field over the cell along an axis."""
        return np.take(field, [0], axis)

    def highest(self, field):
        """The first node of the largest value of a field over the cell, a tuple of int."""
        return np.unravel_index(np.argmax(field), field.shape)

    def place(self, node):
        """Coordinates of a node, beta."""
        return [(i - n // 2) * h for i, n, h in zip(node, self.shape, self.spacings)]

    def joined(self, rows):
        """What all processes have of an array, one after the other along its first axis."""
        return rows

    def rows_to_first(self, field):
        """A field (..., *grid) of all processes in the first of them, None in the others."""
        return field

    def first_largest(self, field):
        """The largest size of values (components, *grid), with the sign of the first about as
        large."""
        return np.copysign(np.max(np.abs(field)), field.flat[first_largest(field.reshape(-1))])

    def to_first(self, values):
        """Values (..., nodes) of all processes in the first of them, None in the others."""
        return values

    def together(self, parts):
        """Sums of what the parts of the cell have, in all processes."""
        return parts

    def any(self, mask):
        """Whether ``mask`` holds anywhere."""
        return bool(np.any(mask))

    # Scalars among the unknowns stand behind the nodes; `slabs` has them in one process only.
    def scalars(self, tail, count):
        """Scalars among unknowns, from what stands behind the nodes, so many."""
        return tail

    def held(self, scalars):
        """Of scalars those that are kept here: all."""
        return scalars


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
        nodes before it.

        Parameters
        ----------
        key : (i, j), components of the block
        extents : nodes of either box in each direction
        circle : points of the circle in each direction
        offset : nodes from the second box to the first in each direction
        """
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
    make : what makes its transform, as `Transform` of a grid, a shape and a count; None: as the
        grid has it
    """

    def __init__(self, window, operator, count, make=None):
        self.window, self.count = window, count
        make = make or window.grid.transform
        self.transform = make(window.grid, window.circle(), count)
        self.blocks = {key: operator.on_window(key, window) for key in operator.blocks}
        self._lay_out()

    def _lay_out(self):
        """Find where the window is on the circle of the transform, and room to multiply blocks."""
        self._inside = (slice(None), *(slice(0, n) for n in self.window.shape))
        self._diagonal = set(self.blocks) == {(i, i) for i in range(self.count)}
        self._product = (None if self._diagonal
                         else np.empty_like(self.transform.spectrum[:, :self._rows()]))

    def apply(self, values, out, transposed=False):
        """Write the operator, or its transpose, times values to out, which is returned.

        Parameters
        ----------
        values, out : arrays (components, nodes), perhaps the same one
        transposed : bool, whether the transpose is meant
        """
        self._put(values)
        self.transform.forward()
        self.multiply(self.transform.spectrum, transposed)
        self.transform.backward()
        self._take(out)
        return out

    def _put(self, values):
        """Write values to the transform's circle, 0 elsewhere."""
        self.transform.real[self._inside] = self.window.box(values)
        clear_padding(self.transform.real, self.window.shape)

    def _take(self, out):
        """Read the window's nodes from the circle."""
        self.window.box(out)[...] = self.transform.real[self._inside]

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
