"""Cosine and sine transforms of fields that are even or odd about the apex, and convolutions by
them."""

import math
from functools import cached_property

import numpy as np
import scipy

from .cell import Convolution
from .counter import transform_cost
from .fftw import pyfftw
from .filtering import Filtering
from .lengths import fast_length
from .parity import parity
from .precision import first_half


class Cosines(Filtering):
    """A pair of cosine transforms of ``count`` even arrays, sine transforms where they are odd,
    with the interface of `cell.Transform`, in place.

    In each direction m points from the axis outwards. If they reach to the middle of the cell, the
    waves are those of the cell (type I, circle of 2 m - 2 points). Otherwise even fields go on
    oddly beyond the last point, odd ones evenly (types III and II, circle of 4 m points, on which
    waves of odd number only): the same as zeros there for a convolution that is padded, and faster.
    Sines belong to the waves of the cosines; those that vanish at all points have no part in
    anything.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction from the axis outwards
    count : int, number of arrays
    parities : for each array and direction 1 (even) or -1 (odd); None: all are even
    memory : array (count, *shape) to work on, whose precision decides on that; None: doubles of
        its own
    """

    def __init__(self, grid, shape, count, parities=None, memory=None):
        self.shape = shape
        self._given = grid, shape, count, parities
        self._odd = np.zeros((count, len(shape)), dtype=bool) if parities is None \
            else np.array(parities) < 0
        self.real = pyfftw.zeros_aligned((count, *shape)) if memory is None else memory
        self.spectrum = self.real
        self.closed = closes(grid, shape)
        self.gain = gain_of(shape, self.closed)
        self._counter = grid.counter
        self._cost = (count * transform_cost(math.prod(shape), grid.counter.size),
                      self.real.itemsize < 8)
        self._plans = self._plan(3), self._plan(2)

    @cached_property
    def single(self):
        """The same pair in single precision, on the same memory."""
        return Cosines(*self._given, first_half(self.real))

    def _plan(self, open_type):
        """{type: axes}, or on a line of even fields a plan, of the transforms with a given type in
        directions that are not closed."""
        kinds = [1 if closed else open_type for closed in self.closed]
        if len(kinds) == 1 and not self._odd.any():
            # SciPy's transforms are the faster ones in the plane, but on a line its calls take
            # longer than they.
            name = {1: "FFTW_REDFT00", 2: "FFTW_REDFT10", 3: "FFTW_REDFT01"}[kinds[0]]
            return pyfftw.FFTW(self.real, self.real, axes=(1,), direction=name, threads=1,
                               flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"))
        return {kind: [axis for axis, own in enumerate(kinds) if own == kind] for kind in kinds}

    def _execute(self, plan):
        self._counter.add(*self._cost)
        if not isinstance(plan, dict):
            plan.execute()
            return
        for field, odd in zip(self.real, self._odd):
            for kind, axes in plan.items():
                even = [axis for axis in axes if not odd[axis]]
                if even:
                    done = scipy.fft.dctn(field, kind, axes=even, overwrite_x=True)
                    if done is not field:
                        field[...] = done
                for axis in set(axes) - set(even):
                    _sines(np.moveaxis(field, axis, 0), kind)

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
        return cosine_waves(self.shape, self.closed, spacings)


def closes(grid, shape):
    """Whether points from the axis outwards reach to the middle of the cell, for each direction."""
    return tuple(m == n // 2 + 1 for m, n in zip(shape, grid.shape))


def gain_of(shape, closed):
    """By what a pair of cosine transforms multiplies.

    Parameters
    ----------
    shape, closed : points in each direction, and whether they reach to the middle of the cell
    """
    return math.prod(2 * (m - 1) if one else 2 * m for m, one in zip(shape, closed))


def cosine_waves(shape, closed, spacings):
    """Wave numbers of cosine transforms, 1/beta, to broadcast.

    Parameters
    ----------
    shape, closed : as of `gain_of`
    spacings : of the nodes, beta
    """
    axes = [np.pi / h * (np.arange(m) / (m - 1) if one else (np.arange(m) + 0.5) / m)
            for m, h, one in zip(shape, spacings, closed)]
    return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))


def along(field, axis, kind, odd):
    """Cosine transform of a type of a field along an axis, in place; a sine transform where it is
    odd.

    Parameters
    ----------
    field, axis, kind, odd : array, int, 1 to 3, bool
    """
    if odd:
        _sines(np.moveaxis(field, axis, 0), kind)
        return
    done = scipy.fft.dctn(field, kind, axes=[axis], overwrite_x=True)
    if done is not field:
        field[...] = done


def _sines(field, kind):
    """Sine transform of a field along its first axis, in place: type 1 between two nodes where it
    vanishes, or types 2 and 3 between such a node and one beyond the last."""
    if kind == 1:
        field[1:-1] = scipy.fft.dst(field[1:-1], 1, axis=0)
        field[[0, -1]] = 0.0
    elif kind == 3:
        field[:-1] = field[1:].copy()
        field[-1] = 0.0
        field[...] = scipy.fft.dst(field, 3, axis=0)
    else:
        field[1:] = scipy.fft.dst(field, 2, axis=0)[:-1]
        field[0] = 0.0


class EvenConvolution(Convolution):
    """Product of a circulant operator of the cell with even or odd fields on an even window.

    An odd kernel times cosines is a sum of sines, and times sines one of cosines with the sign
    reversed: its symbol has that sign.

    Parameters
    ----------
    window : EvenWindow, whose parities fit the operator's (`parity.parities`)
    operator : Operator on the cell
    count : int, number of components
    make : what makes its transform, as `Cosines` of a grid, a shape, a count and parities
    """

    def __init__(self, window, operator, count, make=Cosines):
        self.window, self.count, self._make = window, count, make
        self._circle = tuple(limit if closed else fast_length(2 * n - 1)
                             for n, limit, closed in zip(window.outwards, window.limits,
                                                         window.closed))
        self.transform = window.placed(make(window.grid, self._circle, count, window.parities))
        self.blocks = {key: self._symbol(operator, key) for key in operator.blocks}
        self._lay_out()

    def _symbol(self, operator, key):
        """The block on the waves of the circle, by which the waves of one component give those of
        another."""
        window, own = self.window, parity(operator, key)
        source = window.of(key[1]) or ()
        sign = math.prod(-1 for here, there in zip(own, source) if here < 0 and there < 0)
        if all(window.closed):
            part = operator.blocks[key][tuple(slice(0, m) for m in self._circle)]
            return self.transform.ordered(sign * (part * 1j ** own.count(-1)).real)
        lags = tuple(slice(0, m if closed else 2 * n - 1)
                     for n, m, closed in zip(window.outwards, self._circle, window.closed))
        rows, kernel = operator.kernel_at(key, lags)
        plan = window.grid.placed(self._make(window.grid, self._circle, 1,
                                             (own,) if -1 in own else None), *rows)
        plan.real[0] = 0.0
        plan.real[(0, *map(slice, kernel.shape))] = kernel
        plan.forward()
        return sign / plan.gain * plan.spectrum[0]
