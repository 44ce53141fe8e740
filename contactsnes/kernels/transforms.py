"""Compiled transforms, with the interface of `grid.cell.Transform` and `grid.cosines.Cosines`."""

import ctypes
import math
from functools import cached_property

import numpy as np

from ..grid.counter import transform_cost
from ..grid.fftw import pyfftw
from ..grid.filtering import Filtering
from ..grid.precision import SINGLE, first_half
from . import structures
from .fftw import Plans, Rows
from .library import shared
from .lines import COLUMNS
from .structures import TOO_MANY, address


class Compiled(Filtering):
    """Base of what calls the library.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction
    count : int, number of arrays

    Attributes
    ----------
    structure : ctypes structure of the library, whose memory this object keeps
    room : memory that ``real`` begins
    folded : what makes products on the same memory faster, or None
    """

    folded = None

    def __init__(self, grid, shape, count):
        self.library, self.shape, self.count = shared(), tuple(shape), count
        self._grid, self._sided = grid, {}
        own = self._own = structures.Transform()
        self._reference = ctypes.addressof(own)
        own.count = count
        own.shape[:] = (1,) * (2 - len(shape)) + self.shape
        self.charge()

    @property
    def structure(self):
        """See above."""
        return self._own

    def charge(self):
        """Take the cost of a transform in the units that the grid's counter has now."""
        counter, own = self._grid.counter, self._own
        own.counter = address(counter.numbers)
        parts = self.count * (2 if any(own.both) else 1)
        own.cost = parts * transform_cost(math.prod(self.shape), counter.size)
        others = [vars(self).get(name) for name in ("single", "folded")]
        for other in [*others, *self._sided.values()]:
            if other is not None:
                other.charge()

    def _hold(self, real, spectrum):
        """Take the memory to work on, whose precision decides on that."""
        self.room, self.real, self.spectrum, own = real, real, spectrum, self.structure
        own.real, own.spectrum = address(real), address(spectrum)
        own.single = real.itemsize < 8

    def fitting(self, block):
        """A symbol as the library takes it."""
        kind = SINGLE.get(block.dtype, block.dtype) if self.structure.single else block.dtype
        return np.ascontiguousarray(block, dtype=kind)

    def places(self, numbers):
        """Where the library has the nodes of some numbers on the circle."""
        return numbers

    def sums_at(self, places, nodes, weight, values):
        """As `Filtering.sums_at`.

        Parameters
        ----------
        places, nodes, weight, values : as of that
        """
        sums = np.empty(self.real.size)
        self.library.sum_nodes(address(places), address(nodes), address(weight), address(values),
                               len(nodes), len(sums), address(sums))
        return sums

    def subtract_nodes(self, places, nodes, weight, own, values):
        """As `Filtering.subtract_nodes`.

        Parameters
        ----------
        places, nodes, weight, own, values : as of that
        """
        self.library.subtract_nodes(ctypes.addressof(self.structure), address(places),
                                    address(nodes), address(weight), own, address(values),
                                    len(nodes))

    def _call(self, function, *rest):
        if function(self._reference, *rest or (self._own.shape[0],)) == TOO_MANY:
            self._grid.counter.check()

    def forward(self):
        """``real`` to ``spectrum``."""
        self._call(self.library.forward)

    def backward(self):
        """``spectrum`` to ``real``, times ``gain``."""
        self._call(self.library.backward)


class Real(Compiled):
    """Real transforms of ``count`` arrays, as `grid.cell.Transform`.

    The spectrum, as large as the arrays, is made with the first that asks for it, or for the
    structure: where products are those of `Packed` nobody does.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction
    count : int, number of arrays
    memory : as of `grid.cell.Transform`, of which a spectrum that is None is made as above
    """

    def __init__(self, grid, shape, count, memory=None):
        super().__init__(grid, shape, count)
        self.gain = math.prod(shape)
        real, spectrum = memory or (pyfftw.zeros_aligned((count, *shape)), None)
        self.room = self.real = real
        self._own.real, self._own.single = address(real), real.itemsize < 8
        self._own.waves = math.prod(shape[:-1]) * (shape[-1] // 2 + 1)
        if spectrum is not None:
            self._plan(spectrum)

    def _plan(self, spectrum):
        """Plan the way between arrays and their half spectra, in memory for these."""
        own, self.spectrum = self._own, spectrum
        own.spectrum = address(spectrum)
        self._plans = Plans(self.shape, self.count, own.real, own.spectrum, bool(own.single))
        own.forward, own.backward = self._plans.to_half, self._plans.to_row

    @cached_property
    def spectrum(self):
        """Half spectra of the arrays."""
        self._plan(pyfftw.zeros_aligned((self.count, *self.shape[:-1], self.shape[-1] // 2 + 1),
                                        dtype=np.complex64 if self._own.single else complex))
        return self.spectrum

    @property
    def structure(self):
        """As of `Compiled`: who asks for it transforms by it."""
        self.spectrum  # noqa: B018 (which is made)
        return self._own

    def _call(self, function, *rest):
        self.spectrum  # noqa: B018 (which is made)
        super()._call(function, *rest)

    @property
    def _packs(self):
        """Whether `Packed` can make products."""
        return len(self.shape) == 2 and not any(points % 2 for points in self.shape)

    @cached_property
    def single(self):
        """The same in single precision, on the same memory; in the plane `Packed` where it can
        be."""
        real = first_half(self.real)
        if self._packs:
            return Packed(self._grid, self.shape, self.count, real)
        return Real(self._grid, self.shape, self.count, (real, first_half(self.spectrum)))

    @cached_property
    def folded(self):
        """`Packed` on the same memory where it can be, whose products are faster; else None."""
        return Packed(self._grid, self.shape, self.count, self.real) if self._packs else None


class Packed(Compiled):
    """Products with symbols of ``count`` arrays over a plane, by the library (packed.c): two rows
    are one of complex numbers, and there is no whole spectrum.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : (int, int), points in each direction, even
    count : int, number of arrays
    real : array (count, *shape) to work on, whose precision decides on that
    """

    def __init__(self, grid, shape, count, real):
        super().__init__(grid, shape, count)
        self.gain, self.real, own = math.prod(shape), real, self.structure
        self.waves = shape[0], shape[1] // 2 + 1
        single = real.itemsize < 8
        kind = np.complex64 if single else complex
        self.block = pyfftw.zeros_aligned((count, COLUMNS, shape[0]), dtype=kind)
        # what a block, or a row, is transformed to
        self.found = pyfftw.zeros_aligned(max(self.block.size, shape[1]), dtype=kind)
        own.single, own.packed = single, 1
        own.real, own.block, own.spectrum = map(address, (real, self.block, self.found))
        own.waves = math.prod(self.waves)
        self._rows = Rows(shape[1], 1, own.real, own.spectrum, single)
        self._columns = Rows(shape[0], count * COLUMNS, own.block, own.spectrum, single)
        own.forward, own.backward = self._rows.forward, self._rows.backward
        own.columns, own.columns_back = self._columns.forward, self._columns.backward

    def fitting(self, block):
        """A symbol as the library takes it: column after column."""
        waves = block.reshape(-1, *self.waves)
        kind = SINGLE.get(block.dtype, block.dtype) if self.structure.single else block.dtype
        return np.ascontiguousarray(np.swapaxes(waves, -1, -2), dtype=kind)

    def filter(self, symbol):
        """What stands in ``real`` times real symbols that are `fitting`, in place."""
        self._call(self.library.filter, ctypes.addressof(self.structure.shape), address(symbol))

    def rows(self, field):
        """A field (rows, columns) of this memory as (pairs, 2, columns), its rows in order."""
        return field.reshape(self.shape[0] // 2, self.shape[1], 2).swapaxes(1, 2)

    def places(self, numbers):
        """Where the library has the nodes of some numbers on the circle."""
        row, column = np.divmod(numbers, self.shape[1])
        return (row // 2 * 2 * self.shape[1] + row % 2 + 2 * column).astype(np.intc)
