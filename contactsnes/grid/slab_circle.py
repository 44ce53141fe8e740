"""Transforms on a circle smaller than a cell that is shared out (`slabs`), of fields that are zero
off some rows of it: each process has its own of these, as in the cell."""

import math
from functools import cached_property

import numpy as np
import pyfftw

from .counter import transform_cost


def share(total, rank, size):
    """Which of ``total`` columns a process has, a slice: as mpi4py-fft shares them out.

    Parameters
    ----------
    total, rank, size : int, columns, number of the process, processes
    """
    each, more = divmod(total, size)
    first = rank * each + min(rank, more)
    return slice(first, first + each + (rank < more))


class SlabCircle:
    """A planned pair of real transforms of an array on a circle, with the interface of
    `cell.Transform`: ``real`` has this process's rows of the circle, ``spectrum`` its columns of
    waves.

    Rows are transformed where they are and sent once, as waves of columns: those that are zero cost
    nothing, and no process has more than its slab. Memory is the grid's, and others use it between
    two calls.

    Parameters
    ----------
    grid : Slabs, whose counter counts
    shape : points in each direction
    count : 1, number of arrays
    rows : first row of this process on the circle, and how many it has; None: not known yet
        (`placed`)
    single : bool, whether it is in single precision
    """

    def __init__(self, grid, shape, count=1, rows=None, single=False):
        if count != 1:
            raise ValueError("shared circles have one array")
        self.shape, self.gain = tuple(shape), math.prod(shape)
        self._grid, self._rows = grid, rows
        self._cost = transform_cost(self.gain, grid.counter.size), single
        if rows is not None:
            self._lay_out(*rows, np.dtype(np.complex64 if single else complex))
            self._plan()

    def placed(self, first, count):
        """The same for rows of this process.

        Parameters
        ----------
        first, count : int, on the circle
        """
        return SlabCircle(self._grid, self.shape, 1, (first, count))

    @cached_property
    def single(self):
        """The same pair in single precision."""
        return SlabCircle(self._grid, self.shape, 1, self._rows, True)

    def _lay_out(self, first, count, kind):
        """Take memory, and find what goes where.

        Parameters
        ----------
        first, count : int, this process's rows
        kind : dtype of waves
        """
        comm, waves, room = self._grid.comm, self.shape[1] // 2 + 1, self._grid.room
        columns = [share(waves, rank, comm.size) for rank in range(comm.size)]
        widths = [part.stop - part.start for part in columns]
        self._packed, self._half = (room(place, (count, waves), kind) for place in range(2))
        self.real = self._packed.reshape(-1).view(kind.char.lower())[:count * self.shape[1]].reshape(
            1, count, self.shape[1])
        self.spectrum = room(2, (1, self.shape[0], widths[comm.rank]), kind)
        rows = comm.allgather((first, count))
        empty = np.ones(self.shape[0], dtype=bool)
        for begin, number in rows:
            empty[begin:begin + number] = False
        self._empty = np.flatnonzero(empty)
        sent = [count * width for width in widths]
        starts = np.concatenate([[0], np.cumsum(sent)[:-1]]).astype(int)
        self._blocks = [(self._half[:, part], self._packed.reshape(-1)[start:start + number].reshape(
            count, width)) for part, start, number, width in zip(columns, starts, sent, widths)]
        here = widths[comm.rank]
        self._by_column = [self._packed, (sent, list(starts))]
        self._by_row = [self.spectrum, ([number * here for _, number in rows],
                                        [begin * here for begin, _ in rows])]

    def _plan(self):
        """Plan rows and columns: those that are here."""
        back = {"direction": "FFTW_BACKWARD"}
        self._there, self._back = ([pyfftw.FFTW(*arrays, axes=(axis,), threads=1,
                                                flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"),
                                                **way).execute if arrays[0].size else lambda: None
                                    for arrays, axis, way in pairs] for pairs in (
            [((self.real[0], self._half), 1, {}), ((self.spectrum[0],) * 2, 0, {})],
            [((self.spectrum[0],) * 2, 0, back), ((self._half, self.real[0]), 1, back)]))

    def forward(self):
        """``real`` to ``spectrum``."""
        self._grid.counter.add(*self._cost)
        self._there[0]()
        for half, packed in self._blocks:
            packed[...] = half
        self.spectrum[:, self._empty] = 0.0
        self._grid.comm.Alltoallv(self._by_column, self._by_row)
        self._there[1]()

    def backward(self):
        """``spectrum`` to ``real``."""
        self._grid.counter.add(*self._cost)
        self._back[0]()
        self._grid.comm.Alltoallv(self._by_row, self._by_column)
        for half, packed in self._blocks:
            half[...] = packed
        self._back[1]()
