"""Transforms of even and odd fields that are shared out (`grid.slab_even`), made by the library."""

import ctypes
import math
from functools import cached_property

import numpy as np

from ..grid.cosines import closes, cosine_waves, gain_of
from ..grid.counter import transform_cost
from ..grid.fftw import pyfftw
from ..grid.filtering import clear_padding
from ..grid.slab_cosines import SlabCosines
from ..grid.slab_transform import share
from . import structures
from .library import shared
from .slabs import OfLibrary
from .structures import address
from .transforms import COLUMNS, Folded, Line, PairedLine, order_of


class SlabEvenReal(OfLibrary, SlabCosines):
    """`grid.slab_cosines.SlabCosines` made from real transforms by the library, which writes into
    its rows what nodes have. Waves are transposed, in the order of `transforms.Cosines`.

    Parameters
    ----------
    grid, shape, count, rows, parities : as of that

    Attributes
    ----------
    structure : of the library, with this process's rows of ``real`` as a field's
    """

    @cached_property
    def single(self):
        """The same in single precision, on the same memory: `SlabFolded`."""
        return SlabFolded(*self._given)

    def _lay_out(self, comm, rows, kind):
        """Take memory for numbers of a type, and find what goes where.

        Parameters
        ----------
        comm, rows, kind : as of `SlabCosines`
        """
        super()._lay_out(comm, rows, kind)
        self.library, self._here = shared(), self.spectrum
        count, waves, columns = self._here.shape
        self.spectrum = self._packed[:self._here.size].reshape(count, columns, waves)
        self.structure = own = structures.Transform(count=count)
        own.shape[:], own.real = self.real.shape[1:], address(self.real)
        own.waves = self.spectrum[0].size
        self._lines = [Line(points, closed)
                       for points, closed in zip(self.shape, closes(self._grid, self.shape))]

    def _along(self, fields, axis, back):
        """Transform the rows of fields, which are lines along an axis of the plane, in place."""
        line = ctypes.addressof(self._lines[axis].structure)
        for field, odd in zip(fields, self._odd[:, axis]):
            self.library.along_rows(line, address(field), len(field), back, odd, False)

    def _along_rows(self, back):
        """Transform the rows of ``real``, in place."""
        self._along(self.real, 1, back)

    def _along_columns(self, back):
        """Turn what has come into rows of ``spectrum`` and transform these, or back."""
        if back:
            self._along(self.spectrum, 0, back)
        for here, turned in zip(self._here, self.spectrum):
            self.library.turn_field(address(here), *here.shape, address(turned), back, False)
        if not back:
            self._along(self.spectrum, 0, back)

    @staticmethod
    def wavevectors(shape, closed, spacings, mine):
        """Wave numbers of some columns of waves, 1/beta, to broadcast over a spectrum.

        Parameters
        ----------
        shape, closed, spacings, mine : as of `SlabCosines.wavevectors`
        """
        first, second = (axis.ravel()[order_of(points, one)] for axis, points, one in zip(
            cosine_waves(shape, closed, spacings), shape, closed))
        return first[None, :], second[mine, None]

    def ordered(self, symbol):
        """A symbol on this process's waves of `SlabCosines` in the order of these, of the cell."""
        return np.ascontiguousarray(symbol.T)

    def respond(self, response, transposed, symbols):
        """What stands in ``real`` times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the shape of what stands there
        transposed : bool
        symbols : {(i, j): array on this process's waves}
        """
        clear_padding(self.real, tuple(response.shape))
        self.forward()
        if all(i == j for i, j in symbols):
            for (i, _), symbol in symbols.items():
                self.spectrum[i] *= symbol
        else:
            given = self.spectrum.copy()
            self.spectrum[...] = 0.0
            for (i, j), symbol in symbols.items():
                to, source = (j, i) if transposed else (i, j)
                self.spectrum[to] += symbol * given[source]
        self.backward()


class SlabFolded(OfLibrary):
    """Products with symbols in single precision of even or odd fields that are shared out, by the
    library (folded.c): two rows, of which each process has pairs, and two columns, are one of
    complex numbers.

    Parameters
    ----------
    grid, shape, count, rows, parities : as of `SlabCosines`; the first row is of even number

    Attributes
    ----------
    structure, spectral : of the library, with this process's rows, and with its columns of all
    block : a few columns of each field
    """

    fitting, spectral = Folded.fitting, None

    def __init__(self, grid, shape, count, rows, parities=None):
        self.library, self._grid, self.shape = shared(), grid, tuple(shape)
        closed = closes(grid, shape)
        self.gain = gain_of(shape, closed)
        self._cost = 2.0 * count * transform_cost(math.prod(shape), grid.counter.size), True
        self._lines = [PairedLine(points, one) for points, one in zip(shape, closed)]
        self._lay_out(grid.comm, count, grid.comm.allgather(rows))
        for own in (self.structure, self.spectral):
            for axis, line in enumerate(self._lines):
                own.line[axis] = line.structure
                for field, signs in enumerate(parities or ()):
                    own.odd[field][axis] = signs[axis] < 0

    def _lay_out(self, comm, count, rows):
        """Take memory, that of the transforms in double precision, and find what goes where.

        Parameters
        ----------
        comm, count, rows : communicator, number of fields, (first, number) of each process's rows
        """
        columns = [share(self.shape[1], rank, comm.size) for rank in range(comm.size)]
        pairs = [(number + 1) // 2 for _, number in rows]
        if any(first % 2 for first, number in rows if number):
            raise ValueError("slabs of pairs begin with a row of even number")
        mine, here = pairs[comm.rank], columns[comm.rank].stop - columns[comm.rank].start
        points = self.shape[0] + self.shape[0] % 2
        sizes = [2 * mine * self.shape[1], points * here]
        fields, packed = (self._grid.room((count, place), (count * max(sizes),), np.float32)
                          for place in range(2))
        self._used = max((first + number for first, number in rows if number), default=0)
        self.block = pyfftw.zeros_aligned((count, COLUMNS // 2, points), dtype=np.complex64)
        # (rows are sent before columns come)
        self.structure, self.spectral = (structures.Transform(
            count=count, even=1, single=1, packed=1, waves=self.shape[0] * (here + here % 2),
            real=address(fields), block=address(self.block)) for _ in range(2))
        self.structure.shape[:] = rows[comm.rank][1], self.shape[1]
        self.spectral.shape[:] = self.shape[0], here
        packed = packed[:count * sizes[0]].view(np.complex64).reshape(count, sizes[0] // 2)
        rows_of = fields[:count * sizes[0]].view(np.complex64).reshape(count, mine, self.shape[1])
        columns_of = fields[:count * sizes[1]].reshape(count, sizes[1])
        sent, starts = ([2 * mine * number for number in numbers] for numbers in zip(
            *((part.stop - part.start, part.start) for part in columns)))
        got = [2 * number * here for number in pairs], [first * here for first, _ in rows]
        self._blocks = [(row[:, part], block[mine * part.start:mine * part.stop].reshape(mine, -1))
                        for row, block in zip(rows_of, packed) for part in columns
                        if mine and part.stop > part.start]
        self._exchanges = [([block.view(np.float32), (sent, starts)], [column, got])
                           for block, column in zip(packed, columns_of)]

    def _multiply(self, response, symbol, transposed):
        """What stands in the rows times the symbols of a response, or others, in place.

        Parameters
        ----------
        response, symbol : addresses, one of which is None
        transposed : bool
        """
        comm, rows, columns = self._grid.comm, *map(ctypes.addressof,
                                                    (self.structure, self.spectral))
        number = self.structure.shape[0]
        self._grid.counter.add(*self._cost)
        self.library.folded_rows(rows, number, 0)
        for row, block in self._blocks:
            np.copyto(block, row)
        for packed, column in self._exchanges:
            comm.Alltoallv(packed, column)
        self.library.folded_columns(columns, response, symbol, self._used, transposed)
        for packed, column in self._exchanges:
            comm.Alltoallv(column, packed)
        for row, block in self._blocks:
            np.copyto(row, block)
        self.library.folded_rows(rows, number, 1)

    def respond(self, response, transposed, symbols=None):
        """What stands in the rows times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the operator's symbols and the shape of what
            stands there
        transposed : bool
        symbols : these as arrays, which are not asked for
        """
        self.library.clear_beyond(ctypes.addressof(self.structure),
                                  ctypes.addressof(response.shape))
        self._multiply(ctypes.addressof(response), None, transposed)

    def filter(self, symbol):
        """What stands in the rows times symbols as of ``inverted``."""
        self._multiply(None, address(symbol), False)
