"""Cosine and sine transforms of even and odd fields that are shared out among processes
(`slab_even`)."""

import math
from functools import cached_property

import numpy as np

from .cosines import along, closes, cosine_waves, gain_of
from .counter import transform_cost
from .filtering import Filtering
from .slab_transform import Exchange, share


class SlabCosines(Filtering):
    """A pair of transforms of ``count`` even or odd arrays, with the interface of
    `cosines.Cosines`; ``real`` has this process's rows, ``spectrum`` its columns of waves.

    Rows are transformed where they are and sent once, as waves of columns. Memory is the grid's,
    and the same for both.

    Parameters
    ----------
    grid : Slabs, whose counter counts
    shape : points in each direction from the axis outwards
    count : int, number of arrays
    rows : (first, number) of each process's rows, beyond which fields are zero
    parities : as of `cosines.Cosines`
    single : bool, whether they are in single precision
    """

    def __init__(self, grid, shape, count, rows, parities=None, single=False):
        self._given = grid, shape, count, rows, parities
        self._grid, self.shape, self._count = grid, tuple(shape), count
        self._odd = np.zeros((count, 2), dtype=bool) if parities is None else np.array(parities) < 0
        closed = closes(grid, shape)
        self.gain = gain_of(shape, closed)
        self._cost = count * transform_cost(math.prod(shape), grid.counter.size), single
        self._kinds = [[1 if one else kind for one in closed] for kind in (3, 2)]
        self._lay_out(grid.comm, rows, np.dtype(np.float32 if single else float))
        self.real[...] = 0.0

    @cached_property
    def single(self):
        """The same pair in single precision, on the same memory."""
        return type(self)(*self._given, True)

    def _lay_out(self, comm, rows, kind):
        """Take memory for numbers of a type, and find what goes where.

        Parameters
        ----------
        comm, rows, kind : communicator, each process's rows, type
        """
        columns = [share(self.shape[1], rank, comm.size) for rank in range(comm.size)]
        widths = [part.stop - part.start for part in columns]
        here = widths[comm.rank]
        mine = rows[comm.rank][1]
        shapes = (self._count, mine, self.shape[1]), (self._count, self.shape[0], here)
        # what is sent, or has come, stands in memory of its own; both have room for pairs of rows
        most = max(math.prod((count, number + number % 2, each)) for count, number, each in shapes)
        fields, packed = (self._grid.room((self._count, place), (size,), kind)
                          for place, size in enumerate((most, max(most, self._aside(rows)))))
        self.real, self.spectrum = (fields[:math.prod(shape)].reshape(shape) for shape in shapes)
        self._packed = packed
        packed = packed[:math.prod(shapes[0])].reshape(self._count, mine * self.shape[1])
        filled = np.zeros(self.shape[0], dtype=bool)
        for begin, number in rows:
            filled[begin:begin + number] = True
        self._empty = np.flatnonzero(~filled)
        sent = [mine * width for width in widths]
        starts = [mine * part.start for part in columns]
        got = [number * here for _, number in rows], [begin * here for begin, _ in rows]
        self._blocks = [(row[:, part], block[begin:begin + size].reshape(mine, -1))
                        for row, block in zip(self.real, packed)
                        for part, begin, size in zip(columns, starts, sent) if size]
        self._exchange = Exchange(comm, [([block, (sent, starts)], [spectrum, got])
                                         for block, spectrum in zip(packed, self.spectrum)])

    def _aside(self, rows):
        """How much memory exchanges take that others make."""
        return 0

    def _along_rows(self, back):
        """Transform the rows of ``real``, in place."""
        self._transform(self.real, 1, back)

    def _along_columns(self, back):
        """Transform the columns of waves of rows that have come to ``spectrum``, or are to be sent
        from there."""
        self._transform(self.spectrum, 0, back)

    def _transform(self, fields, axis, back):
        """Transform fields along an axis of the plane, in place."""
        for field, odd in zip(fields, self._odd[:, axis]):
            if field.size:
                along(field, axis, self._kinds[back][axis], odd)

    @property
    def came(self):
        """Columns of waves of rows, array (count, *spectrum)."""
        return self.spectrum

    def to_columns(self):
        """``real`` to columns of waves of rows, which nobody counts."""
        self._along_rows(False)
        for row, block in self._blocks:
            np.copyto(block, row)
        self._exchange.send()
        for _, (spectrum, _) in self._exchange.pairs if self._empty.size else ():
            spectrum[self._empty] = 0.0

    def from_columns(self):
        """The same back."""
        self._exchange.take()
        for row, block in self._blocks:
            np.copyto(row, block)
        self._along_rows(True)

    def forward(self):
        """``real`` to ``spectrum``."""
        self._grid.counter.add(*self._cost)
        self.to_columns()
        self._along_columns(False)

    def backward(self):
        """``spectrum`` to ``real``, times ``gain``."""
        self._grid.counter.add(*self._cost)
        self._along_columns(True)
        self.from_columns()

    @staticmethod
    def wavevectors(shape, closed, spacings, mine):
        """Wave numbers of some columns of waves, 1/beta, to broadcast over a spectrum.

        Parameters
        ----------
        shape, closed, spacings : as of `cosines.cosine_waves`
        mine : slice of the columns
        """
        first, second = cosine_waves(shape, closed, spacings)
        return first, second[:, mine]

    def ordered(self, symbol):
        """A symbol on this process's waves in their order, which is that of their numbers."""
        return np.ascontiguousarray(symbol)
