"""Transforms of fields on the cell or a smaller circle, of which processes have rows (`slabs`)."""

import math
import weakref
from functools import cached_property

import numpy as np

from .counter import transform_cost
from .fftw import pyfftw
from .filtering import Filtering

PLANS = {"threads": 1, "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
"""Plans of rows and columns: estimated, not measured, as in one process."""

BLOCK = 16
"""Columns that are transformed at a time: as many as share lines of the processor's memory."""


def shares(total, size, unit=1):
    """(first, number) of the rows or columns of each of so many processes.

    Parameters
    ----------
    total, size : int
    unit : int, of whose common divisor with the total the numbers are multiples
    """
    unit = math.gcd(total, unit)
    parts = (share(total // unit, rank, size) for rank in range(size))
    return [(unit * part.start, unit * (part.stop - part.start)) for part in parts]


def share(total, rank, size):
    """Which of ``total`` rows or columns a process has, a slice.

    Parameters
    ----------
    total, rank, size : int; rank: number of the process of ``size``
    """
    each, more = divmod(total, size)
    first = rank * each + min(rank, more)
    return slice(first, first + each + (rank < more))


class Exchange:
    """What processes send each other of fields whose rows become columns, and back.

    Parameters
    ----------
    comm : communicator (mpi4py)
    pairs : of each field, what is sent and what comes, as `Alltoallv` takes them
    """

    def __init__(self, comm, pairs):
        self._comm, self.pairs = comm, pairs

    def send(self):
        """Rows to columns."""
        for packed, came in self.pairs:
            self._comm.Alltoallv(packed, came)

    def take(self):
        """Columns to rows."""
        for packed, came in self.pairs:
            self._comm.Alltoallv(came, packed)


class SlabTransform(Filtering):
    """A planned pair of real transforms of ``count`` arrays, with the interface of
    `cell.Transform`; ``real`` has this process's rows, ``spectrum`` its columns of waves.

    Rows are transformed where they are and sent once, as waves of columns; on a circle those that
    no process has are zero, and cost nothing. Memory is the grid's: all transforms of as many
    arrays, of the cell and of circles, use it in turn.

    Parameters
    ----------
    grid : Slabs, whose counter counts
    shape : points in each direction
    count : int, number of arrays
    rows : (first, number) of each process's rows of a circle; None: those of the cell
    single : bool, whether they are in single precision
    """

    def __init__(self, grid, shape, count, rows=None, single=False):
        if rows is None and tuple(shape) != grid.shape:
            raise ValueError("slabs have transforms of the whole cell, or of circles' rows")
        self.shape, self.gain = tuple(shape), math.prod(shape)
        self._grid, self._count, self._rows = grid, count, rows
        self._cost = count * transform_cost(self.gain, grid.counter.size), single
        self._lay_out(np.dtype(np.complex64 if single else complex))
        self._plan()
        self.real[...], self.spectrum[...] = 0.0, 0.0

    @cached_property
    def single(self):
        """The same pair in single precision, on the same memory."""
        return type(self)(self._grid, self.shape, self._count, self._rows, True)

    def _lay_out(self, kind):
        """Take memory for waves of a type, and find what goes where."""
        comm, waves = self._grid.comm, self.shape[1] // 2 + 1
        columns = [share(waves, rank, comm.size) for rank in range(comm.size)]
        widths = [part.stop - part.start for part in columns]
        rows, here = self._rows or self._grid.rows.parts, widths[comm.rank]
        mine = self._count, rows[comm.rank][1], self.shape[1]
        # what is sent stands where the real numbers were, or will be; waves of rows where those of
        # columns will be, or were
        half, spectrum = (*mine[:2], waves), (self._count, self.shape[0], here)
        packed, turned = (self._grid.room((self._count, place), (size,), kind)
                          for place, size in enumerate((math.prod(half),
                                                        max(map(math.prod, (half, spectrum))))))
        self.real = packed.view(kind.char.lower())[:math.prod(mine)].reshape(mine)
        self._half, self.spectrum = (turned[:math.prod(shape)].reshape(shape)
                                     for shape in (half, spectrum))
        empty = np.ones(self.shape[0], dtype=bool)
        for first, number in rows:
            empty[first:first + number] = False
        self._empty = np.flatnonzero(empty)
        sent = [mine[1] * width for width in widths]
        starts = [mine[1] * part.start for part in columns]
        got = [number * here for _, number in rows], [first * here for first, _ in rows]
        packed = packed.reshape(self._count, mine[1] * waves)
        self._blocks = [(row[:, part], block[begin:begin + number].reshape(mine[1], -1))
                        for row, block in zip(self._half, packed)
                        for part, begin, number in zip(columns, starts, sent) if number]
        self._exchange = Exchange(comm, [([block, (sent, starts)], [spectrum, got])
                                         for block, spectrum in zip(packed, self.spectrum)])

    def _plan(self):
        """Plan rows and columns, as far as there are any here."""
        def planned(source, target, axis, direction):
            if not source.size:
                return lambda: None
            return pyfftw.FFTW(source, target, axes=(axis,), direction=direction, **PLANS).execute

        self._to_half = planned(self.real, self._half, 2, "FFTW_FORWARD")
        self._to_row = planned(self._half, self.real, 2, "FFTW_BACKWARD")
        self._plan_columns(planned)

    def _plan_columns(self, planned):
        """Plan columns, some of which are transformed at a time.

        Parameters
        ----------
        planned : function (source, target, axis, direction); what executes a plan
        """
        self._block = pyfftw.zeros_aligned((BLOCK, self.shape[0]), dtype=self._half.dtype)
        self._to_waves, self._to_column = (planned(self._block, self._block, 1, direction)
                                           for direction in ("FFTW_FORWARD", "FFTW_BACKWARD"))

    def _along_columns(self, back):
        """Transform the columns of waves, some at a time side by side: in their places numbers of a
        column are so far apart that it takes several times as long."""
        execute = self._to_column if back else self._to_waves
        for field in self.spectrum:
            for first in range(0, field.shape[1], BLOCK):
                columns = field[:, first:first + BLOCK]
                block = self._block[:columns.shape[1]]
                np.copyto(block, columns.T)
                execute()
                np.copyto(columns, block.T)

    def _to_columns(self):
        """``real`` to columns of waves of rows."""
        self._grid.counter.add(*self._cost)
        self._to_half()
        for half, block in self._blocks:
            np.copyto(block, half)
        if self._empty.size:
            self.spectrum[:, self._empty] = 0.0
        self._exchange.send()

    def _from_columns(self):
        """Columns of waves of rows to ``real``."""
        self._grid.counter.add(*self._cost)
        self._exchange.take()
        for half, block in self._blocks:
            np.copyto(half, block)
        self._to_row()

    def forward(self):
        """``real`` to ``spectrum``."""
        self._to_columns()
        self._along_columns(False)

    def backward(self):
        """``spectrum`` to ``real``."""
        self._along_columns(True)
        self._from_columns()


class SlabCircle:
    """A circle of fewer points than a cell that is shared out: transforms on it, once it is known
    which process has which rows (`placed`).

    Parameters
    ----------
    grid : Slabs
    shape : points in each direction
    count : int, number of arrays
    kind : of the transforms, as `SlabTransform`
    """

    def __init__(self, grid, shape, count, kind=SlabTransform):
        self._grid, self.shape, self._count, self._kind = grid, shape, count, kind
        self.gain, self._last = math.prod(shape), (None, lambda: None)

    def placed(self, *places):
        """Transforms of fields that are zero off the rows that processes have, a list of (first,
        number) of each; the last ones, where these are the same and something holds them still.

        Parameters
        ----------
        places : rows, and what else says where fields are not zero
        """
        made = self._last[1]() if places == self._last[0] else None
        if made is None:
            made = self._kind(self._grid, self.shape, self._count, *places)
            self._last = places, weakref.ref(made)
        return made
