"""Transforms of even and odd fields that are shared out (`grid.slab_even`), made by the library."""

import ctypes
import math
from functools import cached_property

import numpy as np

from ..grid.cosines import closes, cosine_waves, gain_of
from ..grid.counter import transform_cost
from ..grid.fftw import pyfftw
from ..grid.slab_cosines import SlabCosines
from ..grid.slab_transform import share
from . import structures
from .library import shared
from .lines import COLUMNS, Line, order_of, paired_line
from .slabs import OfLibrary
from .structures import address
from .transforms import Folded


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
        packed = self._packed[:self.real.size].reshape(count, -1)
        self.spectrum = self._packed[:self._here.size].reshape(count, columns, waves)
        self._shares = Shares(comm, self.shape[1], rows, self._here, packed)
        self.block = pyfftw.zeros_aligned((count, COLUMNS, waves))
        self._lines = [Line(points, closed)
                       for points, closed in zip(self.shape, closes(self._grid, self.shape))]
        self.structure, self._columns = (structures.Transform(
            count=count, even=1, real=address(fields), block=address(self.block))
            for fields in (self.real, self._here))
        self.structure.waves = self.spectrum[0].size
        self.structure.shape[:], self._columns.shape[:] = self.real.shape[1:], self._here.shape[1:]
        for own in (self.structure, self._columns):
            _set_lines(own, self._lines, self._odd)

    def _along(self, fields, axis, back):
        """Transform the rows of fields, which are lines along an axis of the plane, in place."""
        line, points = ctypes.addressof(self._lines[axis].structure), self.shape[axis]
        for field, odd in zip(fields, self._odd[:, axis]):
            self.library.along_rows(line, address(field), len(field), back, odd, points, False)

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

    def respond(self, response, transposed):
        """What stands in ``real`` times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the operator's symbols and the shape of what
            stands there
        transposed : bool
        """
        rows, columns, shares = map(ctypes.addressof, (self.structure, self._columns,
                                                       self._shares.structure))
        used = response.shape[1]
        self._grid.counter.add(2.0 * self._cost[0], self._cost[1])
        self.library.even_rows(rows, shares, used, False)
        self._shares.send()
        self.library.even_columns(columns, shares, ctypes.addressof(response), self._shares.used,
                                  transposed)
        self._shares.take()
        self.library.even_rows(rows, shares, used, True)

    def filter(self, symbol):
        """What stands in ``real`` times symbols as of ``inverted``."""
        response = structures.Response(components=len(symbol))
        response.shape[:] = self.real.shape[1:]
        for i, own in enumerate(symbol):
            response.symbol[i][i] = address(own)
        self.respond(response, False)


class Shares:
    """Rows of fields that become columns of others: what of them goes to whom.

    Parameters
    ----------
    comm : communicator (mpi4py)
    width : int, numbers of a row
    rows : (first, number) of each process's rows
    fields, packed : arrays (count, numbers) of what has come, and is sent, row by row

    Attributes
    ----------
    structure : of the library
    used : int, rows of all processes
    """

    def __init__(self, comm, width, rows, fields, packed):
        self._comm, (place, mine) = comm, rows[comm.rank]
        columns = [share(width, rank, comm.size) for rank in range(comm.size)]
        widths = [part.stop - part.start for part in columns]
        self.used = max((first + number for first, number in rows if number), default=0)
        self._packed, self._first = packed, (ctypes.c_long * (comm.size + 1))(
            *(part.start for part in columns), width)
        self.structure = structures.Shares(
            parts=comm.size, own=comm.rank, rows=mine, place=place, size=packed.itemsize,
            field=packed.itemsize * packed.shape[1], first=self._first, packed=address(packed))
        real, kind = (1, packed.dtype) if packed.dtype.kind == "f" else (
            2, np.dtype(packed.dtype.char.lower()))
        # (the library reads what this process has where it packed it)
        others = [real * (rank != comm.rank) for rank in range(comm.size)]
        here = widths[comm.rank]
        sent = ([mine * each * other for each, other in zip(widths, others)],
                [real * mine * part.start for part in columns])
        got = ([number * here * other for (_, number), other in zip(rows, others)],
               [real * first * here for first, _ in rows])
        self._exchanges = [([block.view(kind), sent], [field.reshape(-1).view(kind), got])
                           for block, field in zip(packed, fields)]

    def send(self):
        """Rows that are packed to columns."""
        for packed, field in self._exchanges:
            self._comm.Alltoallv(packed, field)

    def take(self):
        """Columns to rows that are packed."""
        for packed, field in self._exchanges:
            self._comm.Alltoallv(field, packed)


def _set_lines(structure, lines, odd):
    """Have a transform of the library be of lines, even or odd ones.

    Parameters
    ----------
    structure : of the library
    lines : Line or PairedLine of each direction
    odd : array (fields, directions) of bool
    """
    for axis, line in enumerate(lines):
        structure.line[axis] = line.structure
        for field, signs in enumerate(odd):
            structure.odd[field][axis] = signs[axis]


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
        self._lines = [paired_line(points, one) for points, one in zip(shape, closed)]
        self._lay_out(grid.comm, count, rows)
        odd = np.zeros((count, 2), dtype=bool) if parities is None else np.array(parities) < 0
        for own in (self.structure, self.spectral):
            _set_lines(own, self._lines, odd)

    def _lay_out(self, comm, count, rows):
        """Take memory, that of the transforms in double precision, and find what goes where.

        Parameters
        ----------
        comm, count, rows : communicator, number of fields, (first, number) of each process's rows
        """
        if any(first % 2 for first, number in rows if number):
            raise ValueError("slabs of pairs begin with a row of even number")
        pairs = [(first // 2, (number + 1) // 2) for first, number in rows]
        columns, mine = share(self.shape[1], comm.rank, comm.size), pairs[comm.rank][1]
        points, here = self.shape[0] + self.shape[0] % 2, columns.stop - columns.start
        sizes = [2 * mine * self.shape[1], points * here]
        fields, packed = (self._grid.room((count, place), (count * max(sizes),), np.float32)
                          for place in range(2))
        self.block = pyfftw.zeros_aligned((count, COLUMNS // 2, points), dtype=np.complex64)
        # (rows are sent before columns come)
        self.structure, self.spectral = (structures.Transform(
            count=count, even=1, single=1, packed=1, waves=self.shape[0] * (here + here % 2),
            real=address(fields), block=address(self.block)) for _ in range(2))
        self.structure.shape[:] = rows[comm.rank][1], self.shape[1]
        self.spectral.shape[:] = self.shape[0], here
        self._used = max((first + number for first, number in rows if number), default=0)
        self._shares = Shares(
            comm, self.shape[1], pairs,
            fields[:count * sizes[1]].view(np.complex64).reshape(count, -1),
            packed[:count * sizes[0]].view(np.complex64).reshape(count, -1))

    def _multiply(self, response, symbol, transposed):
        """What stands in the rows times the symbols of a response, or others, in place.

        Parameters
        ----------
        response, symbol : addresses, one of which is None
        transposed : bool
        """
        rows, columns, shares = map(ctypes.addressof, (self.structure, self.spectral,
                                                       self._shares.structure))
        number = self.structure.shape[0]
        self._grid.counter.add(*self._cost)
        self.library.folded_rows(rows, shares, number, 0)
        self._shares.send()
        self.library.folded_columns(columns, shares, response, symbol, self._used, transposed)
        self._shares.take()
        self.library.folded_rows(rows, shares, number, 1)

    def respond(self, response, transposed):
        """What stands in the rows times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the operator's symbols and the shape of what
            stands there
        transposed : bool
        """
        self.library.clear_beyond(ctypes.addressof(self.structure),
                                  ctypes.addressof(response.shape))
        self._multiply(ctypes.addressof(response), None, transposed)

    def filter(self, symbol):
        """What stands in the rows times symbols as of ``inverted``."""
        self._multiply(None, address(symbol), False)
