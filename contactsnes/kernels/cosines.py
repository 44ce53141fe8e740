"""Compiled cosine and sine transforms, with the interface of `grid.cosines.Cosines`."""

import math
from functools import cached_property

import numpy as np

from ..grid.fftw import pyfftw
from ..grid.precision import first_half
from .lines import COLUMNS, in_pairs, line, order_of, paired_line
from .structures import address
from .transforms import Compiled


class Cosines(Compiled):
    """Cosine and sine transforms of ``count`` even or odd arrays, as `grid.cosines.Cosines`, made
    from real ones.

    Waves stand in an order of their own, in the plane transposed: ``waves`` are their numbers in
    the order of `grid.cosines.Cosines`, for each direction.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : tuple of int, points in each direction from the axis outwards
    count : int, number of arrays, at most 3
    parities : as of `grid.cosines.Cosines`
    memory : (room, spectrum) to work on, whose precision decides on that, the room of the rows
        `in_pairs`; None: doubles of its own
    """

    def __init__(self, grid, shape, count, parities=None, memory=None):
        super().__init__(grid, shape, count)
        self._parities = parities
        own, plane = self.structure, len(shape) == 2
        self.closed = tuple(m == n // 2 + 1 for m, n in zip(shape, grid.shape))
        self.gain = math.prod(2 * (m - 1) if closed else 2 * m
                              for m, closed in zip(shape, self.closed))
        if memory is None:
            room = pyfftw.zeros_aligned((count, *in_pairs(shape)))
            memory = room, pyfftw.zeros_aligned((count, *shape[::-1])) if plane else room
        room, spectrum = memory
        self._hold(room.reshape(-1)[:count * math.prod(shape)].reshape(count, *shape), spectrum)
        self.room = room
        own.even, own.waves = 1, self.real[0].size
        self.waves = [order_of(m, closed) for m, closed in zip(shape, self.closed)]
        self._lines = [line(m, closed, bool(own.single)) for m, closed in zip(shape, self.closed)]
        for place, rows in enumerate(self._lines, start=2 - len(shape)):
            own.line[place] = rows.structure
            for field, signs in enumerate(parities or ()):
                own.odd[field][place] = signs[place - 2 + len(shape)] < 0

    @cached_property
    def single(self):
        """The same in single precision, on the same memory; in the plane `Folded`."""
        if len(self.shape) == 2:
            return Folded(self, single=True)
        memory = first_half(self.real), first_half(self.spectrum)
        return Cosines(self._grid, self.shape, self.count, self._parities, memory)

    @cached_property
    def folded(self):
        """In the plane `Folded` on the same memory, whose products are faster; else None."""
        return Folded(self) if len(self.shape) == 2 else None

    def sided(self, axis, single):
        """`Folded` on the same memory, of fields whose even and odd parts these are.

        Parameters
        ----------
        axis : direction in which fields are on both sides of the axis
        single : bool
        """
        if (axis, single) not in self._sided:
            self._sided[axis, single] = Folded(self, single, axis)
        return self._sided[axis, single]

    def wavevectors(self, spacings):
        """Wave numbers, 1/beta, to broadcast over a spectrum, one a direction of the grid."""
        axes = [np.pi / h * (order / (m - 1) if closed else (order + 0.5) / m)
                for m, h, closed, order in zip(self.shape, spacings, self.closed, self.waves)]
        if len(axes) == 1:
            return tuple(axes)
        return axes[0][None, :], axes[1][:, None]

    def ordered(self, symbol):
        """A symbol on the waves of `grid.cosines.Cosines`, in the order of these."""
        return np.ascontiguousarray(symbol[np.ix_(*self.waves)].T)


class Folded(Compiled):
    """Products with symbols of even or odd arrays over a plane, by the library (folded.c): two
    rows, and two columns, are one of complex numbers, and there is no whole spectrum.

    Parameters
    ----------
    whole : Cosines, on whose memory it works
    single : bool, whether in single precision
    axis : direction in which fields are on both sides of the axis, and ``whole`` has the even and
        the odd part of each; None: in none
    """

    def __init__(self, whole, single=False, axis=None):
        parts = whole.count
        super().__init__(whole._grid, whole.shape, parts if axis is None else parts // 2)
        self.gain, own, self._memory = whole.gain, self.structure, whole.room
        rows, columns = self.shape
        self.block = pyfftw.zeros_aligned((parts, COLUMNS // 2, in_pairs(self.shape)[0]),
                                          dtype=np.complex64 if single else complex)
        if axis is not None:
            own.both[axis] = 1
            self.charge()
        own.even, own.single, own.packed = 1, single, 1
        own.real, own.block = address(whole.real), address(self.block)
        own.waves = rows * (columns + columns % 2)
        self._lines = [paired_line(m, closed, single)
                       for m, closed in zip(self.shape, whole.closed)]
        for place, rows in enumerate(self._lines):
            own.line[place] = rows.structure
            for field in range(parts):
                own.odd[field][place] = whole.structure.odd[field][place]

    def fitting(self, block):
        """A symbol as the library takes it: pairs of columns, side by side."""
        columns, rows = block.shape
        pairs = np.zeros((columns + columns % 2, rows),
                         dtype=np.float32 if self.structure.single else float)
        pairs[:columns] = block
        return np.ascontiguousarray(np.swapaxes(pairs.reshape(-1, 2, rows), 1, 2))
