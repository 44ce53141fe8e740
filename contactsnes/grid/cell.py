"""The periodic grid, its planned real transforms and convolutions, and every reduction over nodes.

Conventions: N points in a direction of period L, node i at x_i = (i - N/2) L / N; f(x) = sum_q f(q)
exp(+iqx), the sign of numpy's ``irfft``. Transforms here are not normalised: forward then backward
multiplies by the number of points.
"""

import math
from functools import cached_property

import numpy as np

from .counter import Counter, transform_cost
from .fftw import pyfftw
from .fields import Fields
from .filtering import Filtering, clear_padding
from .precision import first_half
from .windows import Window


class Transform(Filtering):
    """A planned pair of real transforms of ``count`` arrays of one shape, on aligned memory.

    Plans are estimated, not measured: what was fastest on a busy machine would decide the last
    bits. Write to ``real``, call ``forward``, work on ``spectrum``, call ``backward``, read
    ``real`` again: it is overwritten, its padding too, and ``spectrum`` does not survive.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction
    count : int, number of arrays
    memory : (real, spectrum) to work on, whose precision decides on that; None: doubles of its own
    """

    def __init__(self, grid, shape, count, memory=None):
        axes = tuple(range(1, 1 + len(shape)))
        self.shape, self.gain = shape, math.prod(shape)
        self.real, self.spectrum = memory or (
            pyfftw.zeros_aligned((count, *shape)),
            pyfftw.zeros_aligned((count, *shape[:-1], shape[-1] // 2 + 1), dtype=complex))
        plan = {"axes": axes, "threads": 1, "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        self._forward = pyfftw.FFTW(self.real, self.spectrum, **plan)
        self._backward = pyfftw.FFTW(self.spectrum, self.real, direction="FFTW_BACKWARD", **plan)
        self._grid, self._counter = grid, grid.counter
        self._cost = count * transform_cost(self.gain, grid.counter.size), self.real.itemsize < 8

    @cached_property
    def single(self):
        """The same pair in single precision, on the same memory."""
        return Transform(self._grid, self.shape, len(self.real),
                         (first_half(self.real), first_half(self.spectrum)))

    def forward(self):
        """``real`` to ``spectrum``."""
        self._counter.add(*self._cost)
        self._forward.execute()

    def backward(self):
        """``spectrum`` to ``real``."""
        self._counter.add(*self._cost)
        self._backward.execute()


def _counted(values, where):
    """Values (..., nodes) where a mask, of all their axes or the last ones, holds: picking them
    takes a third of a reduction under a mask."""
    return values[(slice(None),) * (np.ndim(values) - np.ndim(where)) + (where,)]


class Grid(Fields, Counter):
    """The periodic grid of the cell: wave vectors, transforms and their count, reductions over
    nodes; `slabs.Slabs` where these are shared out among processes.

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
        self.whole = self._whole()

    def _whole(self):
        """The window of all nodes."""
        return Window(self, (0,) * len(self.shape), self.shape)

    def box(self, start, shape):
        """The window of a box of nodes.

        Parameters
        ----------
        start, shape : first node, and nodes in each direction
        """
        return Window(self, start, shape)

    def of_points(self, points):
        """The grid of so many points in each direction over the same cell."""
        return Grid(points, self.periods)

    @property
    def transform(self):
        """What makes transforms over the cell."""
        return Transform

    def coordinates(self):
        """Coordinates of the nodes, beta: one array a direction, shaped to broadcast over the
        grid."""
        axes = [(np.arange(n) - n // 2) * h for n, h in zip(self.shape, self.spacings)]
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    def wavevectors(self, shape=None, apart=1):
        """Wave numbers of the half spectrum of a circle, 1/beta, to broadcast.

        Parameters
        ----------
        shape : points of the circle in each direction (default the cell)
        apart : int, spacings from one of its points to the next
        """
        shape = self.shape if shape is None else shape
        spacings = [apart * spacing for spacing in self.spacings]
        axes = [2 * np.pi * np.fft.fftfreq(n, h) for n, h in zip(shape[:-1], spacings)]
        axes.append(2 * np.pi * np.fft.rfftfreq(shape[-1], spacings[-1]))
        return np.ix_(*axes)

    def symbols(self, make, components, shape=None, apart=1):
        """Blocks (i, j) -> half spectrum of a body on a circle.

        Parameters
        ----------
        make : `Body.compliance` or `Body.stiffness`
        components : int
        shape, apart : as of `wavevectors`
        """
        shape = self.shape if shape is None else shape
        return make(self.wavevectors(shape, apart), components, last_even=shape[-1] % 2 == 0)

    def with_mean(self, symbol):
        """A compliance (*half spectrum), in place with twice its largest value at q = 0 where it is
        0 there: a stiff law holds the mean of a core, for whose rest the longest wave, doubled,
        stands."""
        mean = self.zero_wave(symbol)
        if self.any(mean == 0.0):
            mean[...] = 2.0 * self.maximum(symbol)
        return symbol

    # Reductions over nodes, the last axis of an array (components, nodes).
    def sum(self, values):
        """Sum over the nodes (last axis)."""
        return self.together(self.sum_here(values))

    def sum_here(self, values):
        """What this process has of it."""
        return np.add.reduce(values, axis=-1)

    def mean(self, values):
        """Mean over the whole cell of values that vanish off the given nodes (last axis)."""
        return self.sum(values) / self.size

    def maximum(self, values, where=True, initial=-np.inf):
        """Largest value over all nodes and components.

        Parameters
        ----------
        values : array (components, nodes)
        where : mask of what counts, to broadcast
        initial : float, what is found where nothing counts
        """
        return self.largest(np.maximum.reduce(values if where is True else _counted(values, where),
                                              axis=None, initial=initial))

    def minimum(self, values, where=True, initial=np.inf):
        """Smallest value over all nodes and components.

        Parameters
        ----------
        values : array (components, nodes)
        where : mask of what counts, to broadcast
        initial : float, what is found where nothing counts
        """
        return -self.largest(-np.minimum.reduce(values if where is True
                                                else _counted(values, where), axis=None,
                                                initial=initial))

    def inner(self, first, second):
        """Inner product over nodes and components."""
        return float(self.together(np.vdot(first, second)))

    def norm(self, values):
        """Euclidean norm over nodes and components, and what scalars an unknown carries besides."""
        return float(np.sqrt(self.inner(values, values)))

    def parseval(self, spectrum):
        """Sum over nodes and arrays of the squares of fields (..., *grid) with these half
        spectra."""
        squares = np.square(spectrum.real) + np.square(spectrum.imag)
        paired = 2.0 * squares.sum()
        for column in self.lone_columns():
            paired -= squares[..., column].sum()
        return float(self.together(paired) / self.size)

    def spectral_inner(self, first, second):
        """Real inner product of half spectra of the cell (arrays, *half spectrum): interior columns
        stand for two waves."""
        lone = sum(np.vdot(first[..., k], second[..., k]).real for k in self.lone_columns())
        return float(self.together(2.0 * np.vdot(first, second).real - lone))

    def count(self, mask):
        """Number of nodes where ``mask`` holds."""
        return int(self.together(np.count_nonzero(mask)))


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
        self._product = None  # made by the first product: the library needs none

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
        if self._product is None:
            self._product = np.empty_like(self.transform.spectrum[:, :rows])
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
        return max(1, min(shape[0], 2 ** 14 * shape[0] // max(1, math.prod(shape))))
