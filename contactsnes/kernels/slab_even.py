"""Transforms of even and odd fields that are shared out (`grid.slab_even`), made by the library."""

import ctypes
import math
from functools import cached_property

import numpy as np

from ..grid.cosines import closes, cosine_waves, gain_of
from ..grid.counter import transform_cost
from ..grid.fftw import pyfftw
from ..grid.mirrors import without_mirror
from ..grid.sides import parts_of
from ..grid.slab_cosines import SlabCosines
from ..grid.slab_transform import Exchange, share
from . import structures
from .cosines import Folded
from .library import shared
from .lines import COLUMNS, line, order_of, paired_line
from .slabs import OfLibrary
from .structures import address


class OfFolded:
    """Base of transforms whose products are those of `SlabFolded`, in double (``folded``) and in
    single precision, on the same memory.

    Attributes
    ----------
    fields : what `SlabFolded` is made of before its precision, and ``columns`` behind it
    """

    columns = 0

    @cached_property
    def single(self):
        """`SlabFolded` in single precision."""
        return SlabFolded(*self.fields, True, self.columns)

    @cached_property
    def folded(self):
        """`SlabFolded` in double precision."""
        return SlabFolded(*self.fields, False, self.columns)

    def inverted(self, *given):
        """As `Filtering.inverted`, for `filter`."""
        return self.folded.inverted(*given)

    def enter(self, *given):
        """As `Filtering.enter`, before `filter`."""
        self.folded.enter(*given)

    def filter(self, symbol):
        """What was entered times symbols as of ``inverted``."""
        self.folded.filter(symbol)

    def leave(self, *given):
        """As `Filtering.leave`, after `filter`."""
        self.folded.leave(*given)


class SlabEvenReal(OfFolded, SlabCosines):
    """`grid.slab_cosines.SlabCosines` made from real transforms by the library, whose products are
    those of ``folded``. Waves are transposed, in the order of `cosines.Cosines`.

    Parameters
    ----------
    grid, shape, count, rows, parities : as of that
    """

    @property
    def fields(self):
        """As of `OfFolded`."""
        return self._given

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

    @property
    def came(self):
        """As `SlabCosines.came`."""
        return self._here

    def _aside(self, rows):
        """As `SlabCosines._aside`."""
        return 2 * self._count * sum(_aside(self._grid.comm, _in_pairs(rows), self.shape[1]))

    def _along(self, fields, axis, back):
        """Transform the rows of fields, which are lines along an axis of the plane, in place."""
        points, closed = self.shape[axis], closes(self._grid, self.shape)[axis]
        own = ctypes.addressof(line(points, closed, False).structure)
        for field, odd in zip(fields, self._odd[:, axis]):
            self.library.along_rows(own, address(field), len(field), back, odd, points, False)

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


def _used(rows):
    """Rows of all processes, from (first, number) of each."""
    return max((first + number for first, number in rows if number), default=0)


def _aside(comm, rows, width):
    """Numbers of a field that this process sends, and that come.

    Parameters
    ----------
    comm, rows : as of `Shares`
    width : int, numbers of a row
    """
    columns, mine = share(width, comm.rank, comm.size), rows[comm.rank][1]
    here = columns.stop - columns.start
    return mine * (width - here), (_used(rows) - mine) * here


def _in_pairs(rows):
    """Pairs of rows, (first, number) of each process."""
    return [(first // 2, (number + 1) // 2) for first, number in rows]


class Shares:
    """Rows of fields that become columns of others: what of them goes to whom. Columns of this
    process's own rows stay where these are.

    Parameters
    ----------
    comm : communicator (mpi4py)
    rows : (first, number) of each process's rows
    fields : array (count, rows here, numbers of a row)
    memory : array of numbers of their type, for what is sent, and has come (`_aside`)
    sides : int, parts of a field that stand in a row one after the other, and go apart
    """

    def __init__(self, comm, rows, fields, memory, sides):
        (count, mine, wide), own = fields.shape, comm.rank
        count, width = sides * count, wide // sides
        columns = [share(width, rank, comm.size) for rank in range(comm.size)]
        self._kept = fields, memory
        self._first = (ctypes.c_long * (comm.size + 1))(*(part.start for part in columns), width)
        widths = [part.stop - part.start for part in columns]
        here, self.used = widths[own], _used(rows)
        ends = np.cumsum([count * number for number in _aside(comm, rows, width)])
        packed, came, _ = (part.reshape(count, -1) for part in np.split(memory, ends))
        self.structure = structures.Shares(
            parts=comm.size, own=own, rows=mine, place=rows[own][0], size=fields.itemsize,
            sides=sides, wide=wide, first=self._first, here=address(fields),
            packed=address(packed), came=address(came))
        self.structure.fields[:] = [array[0].nbytes for array in (fields, packed, came)]
        real, kind = 1 if fields.dtype.kind == "f" else 2, fields.dtype.char.lower()
        # of those after this process without what stays here
        others = [(0 if rank == own else real, rank > own) for rank in range(comm.size)]
        sent = ([mine * each * one for each, (one, _) in zip(widths, others)],
                [real * mine * (part.start - here * after)
                 for part, (_, after) in zip(columns, others)])
        got = ([number * here * one for (_, number), (one, _) in zip(rows, others)],
               [real * here * (first - mine * after)
                for (first, _), (_, after) in zip(rows, others)])
        self.exchange = Exchange(comm, [([block.view(kind), sent], [rows_.view(kind), got])
                                        for block, rows_ in zip(packed, came)])


class SlabFolded(OfLibrary):
    """Products with symbols of even or odd fields that are shared out, by the library (folded.c):
    two rows, of which each process has pairs, and two columns, are one of complex numbers.

    Parameters
    ----------
    grid, shape, count, rows : as of `SlabCosines`; the first row is of even number
    parities : as of that, or of `grid.sides.Sides`
    single : bool, whether they are in single precision
    columns : int, of fields that have one mirror, rows of which are on both sides of the axis

    Attributes
    ----------
    structure, spectral : of the library, with this process's rows, and with its columns of all
    block : a few columns of each field
    """

    fitting, spectral = Folded.fitting, None

    def __init__(self, grid, shape, count, rows, parities, single, columns=0):
        self.library, self._grid, self.shape = shared(), grid, tuple(shape)
        closed, axis = closes(grid, shape), without_mirror(parities)
        fields = parities or ((1, 1),) * count
        parts = fields if axis is None else parts_of(fields, axis)
        self.gain, self._columns = gain_of(shape, closed), columns
        self._cost = 2.0 * len(parts) * transform_cost(math.prod(shape), grid.counter.size), single
        self._lines = [paired_line(points, one, single) for points, one in zip(shape, closed)]
        self._lay_out(grid.comm, count, rows, np.dtype(np.complex64 if single else complex), axis)
        for own, odd in ((self.structure, fields if axis == 0 else parts), (self.spectral, parts)):
            for place, made in enumerate(self._lines):
                own.line[place] = made.structure
                for field, signs in enumerate(odd):
                    own.odd[field][place] = signs[place] < 0
        self._serve()

    def _lay_out(self, comm, count, rows, kind, axis):
        """Take memory, that of `SlabEvenReal`, and find what goes where.

        Parameters
        ----------
        comm, count, rows : communicator, number of fields, (first, number) of each process's rows
        kind : type of complex numbers
        axis : direction in which fields are on both sides of the axis, or None
        """
        if any(first % 2 for first, number in rows if number):
            raise ValueError("slabs of pairs begin with a row of even number")
        pairs, mine = _in_pairs(rows), rows[comm.rank][1]
        columns, width = share(self.shape[1], comm.rank, comm.size), self.shape[1]
        points, here = self.shape[0] + self.shape[0] % 2, columns.stop - columns.start
        # of rows on both sides of the axis, processes get what is even and what is odd
        sides, parts = 1 + (axis == 1), 1 + (axis is not None)
        number, aside = pairs[comm.rank][1], sides * count * sum(_aside(comm, pairs, width))
        fields, memory = (self._grid.room((sides * count, place), size, kind) for place, size
                          in enumerate(((count, number, sides * width), (aside,))))
        self.block = pyfftw.zeros_aligned((parts * count, COLUMNS // 2, points), dtype=kind)
        self.structure, self.spectral = (structures.Transform(
            count=count, even=1, single=self._cost[1], packed=1,
            waves=self.shape[0] * (here + here % 2), real=address(fields),
            block=address(self.block)) for _ in range(2))
        self.structure.shape[:] = mine, width
        self.spectral.shape[:] = self.shape[0], here
        self.structure.both[1] = sides - 1
        if axis is not None:
            self.spectral.both[axis] = 1
        self._used = _used(rows)
        self._shares = Shares(comm, pairs, fields, memory, sides)

    def multiply(self, response, symbol, transposed):
        """What stands in the rows times the symbols of a response, or of `inverted`, in place.

        Parameters
        ----------
        response, symbol : addresses, one of which is None
        transposed : bool, whether the response's blocks are
        """
        rows, columns, shares = map(ctypes.addressof, (self.structure, self.spectral,
                                                       self._shares.structure))
        used = self.structure.shape[0], self._columns
        self._grid.counter.add(*self._cost)
        self.library.folded_rows(rows, shares, *used, 0)
        self._shares.exchange.send()
        self.library.folded_columns(columns, shares, response, symbol, self._used, transposed)
        self._shares.exchange.take()
        self.library.folded_rows(rows, shares, *used, 1)
