"""The cell of a plane in slabs of rows, one a process (MPI): who has which rows, rows of others,
transforms, and reductions over all processes.

Every process does the same with its own nodes; what is one number for the whole contact is the same
on all. Sums of the processes are added in their order by each of them, so that all decide alike.
"""

import math
import weakref
from functools import cached_property

import numpy as np

from .cell import Grid
from .even import EvenGrid
from .fftw import pyfftw
from .rows import Rows, to_first
from .slab import Slab
from .slab_even import SlabEven
from .slab_fields import SlabFields
from .slab_sides import SlabEvenCircle
from .slab_transform import SlabCircle, SlabTransform, share, shares

STRIP = 2 ** 17
"""Waves for which symbols are made at a time: what that takes does not add to what many processes
keep."""
LEAST = 16
"""Columns of waves that a strip has at least, beside the two that each has."""
PATCH = 4
"""Rows that processes have a multiple of, where there are enough: patches of a preconditioner
(`grid.patches`) are theirs as a whole."""
GATHERED = 2 ** 14
"""Nodes of a coarser grid, or points of a circle, up to which every process has all of them: to
compute with all of these takes it less time than to wait for others."""


class Slabs(SlabFields, Grid):
    """The periodic grid of a plane whose rows belong to several processes.

    Parameters
    ----------
    shape : points in each direction, two even numbers
    periods : period in each direction, beta
    comm : communicator (mpi4py) of the processes
    counter : as of `cell.Grid`

    Attributes
    ----------
    rows : Rows, who has which
    """

    circle, even_window, even_circle, shared = SlabCircle, SlabEven, SlabEvenCircle, True

    def __init__(self, shape, periods, comm, counter=None):
        self.comm, self._rooms, self.shape = comm, {}, tuple(shape)
        waves = shape[1] // 2 + 1
        self.rows = Rows(comm, shares(shape[0], comm.size, PATCH), shape[0])
        self.columns = Rows(comm, shares(waves, comm.size), waves)
        self.waves = share(shape[1] // 2 + 1, comm.rank, comm.size)
        super().__init__(shape, periods, counter)

    @property
    def local_shape(self):
        """Rows and columns of this process."""
        return self.rows.count, self.shape[1]

    def _whole(self):
        """The window of all nodes that are here."""
        return Slab(self)

    def box(self, start, shape):
        """This process's rows of a box of nodes; directions in which it would wrap around the
        cell's border are taken whole.

        Parameters
        ----------
        start, shape : first node, and nodes in each direction
        """
        inside = [0 <= first and first + n <= total
                  for first, n, total in zip(start, shape, self.shape)]
        found = Slab(self, *zip(*((first, n) if fits else (0, total) for first, n, total, fits
                                  in zip(start, shape, self.shape, inside))))
        return self.whole if found.is_whole else found

    def of_points(self, points):
        """The grid of so many points in each direction over the same cell: slabs, or where these
        are few all of it on every process."""
        if math.prod(points) <= GATHERED or points[0] < self.comm.size:
            return Grid(points, self.periods)
        return Slabs(points, self.periods, self.comm)

    def weighted(self, weights, rows):
        """This grid with reductions over even fields, of which a node counts as many times as its
        weight says.

        Parameters
        ----------
        weights : array (nodes,)
        rows : Rows of these nodes
        """
        return EvenSlabs(self, weights, rows)

    @property
    def transform(self):
        """What makes transforms over the cell."""
        return SlabTransform

    def coordinates(self):
        """Coordinates of this process's nodes, beta, to broadcast."""
        return self.whole.coordinates()

    def wavevectors(self, shape=None, apart=1):
        """Wave numbers of this process's part of the half spectrum, 1/beta, to broadcast.

        Parameters
        ----------
        shape, apart : as of `cell.Grid.wavevectors`
        """
        first, second = super().wavevectors(shape, apart)
        return first, second[:, share(second.size, self.comm.rank, self.comm.size)]

    def symbols(self, make, components, shape=None, apart=1):
        """Blocks of a body on this process's waves.

        Parameters
        ----------
        make : `Body.compliance` or `Body.stiffness`
        components : int
        shape, apart : as of `wavevectors`
        """
        first, second = super().wavevectors(shape, apart)
        here = share(second.size, self.comm.rank, self.comm.size)
        found, some = {}, max(LEAST, STRIP // first.size)
        for begin in range(here.start, max(here.stop, here.start + 1), some):
            end = min(begin + some, here.stop)
            last = end == second.size and (shape or self.shape)[1] % 2 == 0
            # What blocks there are hangs on the longest waves, which one process has: all take
            # them.
            blocks = make((first, second[:, np.r_[0:2, begin:end]]), components, last_even=last)
            for key, block in blocks.items():
                found.setdefault(key, np.empty((first.size, here.stop - here.start), block.dtype))
                found[key][:, begin - here.start:end - here.start] = block[:, 2:]
        return found

    def room(self, place, shape, kind):
        """Memory of a name that transforms use in turn, as an array that is not cleared; it is
        given back when none of them holds it.

        Parameters
        ----------
        place : its name, whose largest array so far it holds
        shape, kind : of the array
        """
        size = math.prod(shape) * np.dtype(kind).itemsize
        memory = self._rooms[place]() if place in self._rooms else None
        if memory is None or memory.size < size + pyfftw.simd_alignment:
            memory = np.empty(size + pyfftw.simd_alignment, dtype=np.uint8)
            self._rooms[place] = weakref.ref(memory)
        first = -memory.ctypes.data % pyfftw.simd_alignment
        return memory[first:first + size].view(kind).reshape(shape)

    def of_circle(self, shape):
        """The grid that has the points of a circle of a shape: where these are few, every process
        has all of them, as of a cell that it has alone.

        Parameters
        ----------
        shape : points in each direction
        """
        return self._alone if math.prod(shape) <= GATHERED else self

    @cached_property
    def _alone(self):
        """The cell as one process has it, with the same counter."""
        return Grid(self.shape, self.periods, self.counter)

    def placed(self, transform, first, count):
        """A transform of a circle, of which this process has some rows.

        Parameters
        ----------
        transform : SlabCircle
        first, count : int, on the circle
        """
        return transform.placed(self.comm.allgather((first, count)))

    def zero_wave(self, spectrum):
        """The values at q = 0 of half spectra (..., *half spectrum), if they are here, as a
        view: else one without values."""
        here = self.waves.start == 0
        return spectrum[..., :here, :here]

    # Reductions over the nodes of all processes.
    def together(self, parts):
        """Sums over processes of numbers, an array of any shape: the same on all of them."""
        own = np.array(parts, dtype=float, order="C")
        every = np.empty((self.comm.size, *own.shape))
        self.comm.Allgather(own, every)
        return np.add.reduce(every, axis=0)

    def sum_up(self, numbers):
        """Take the sums over processes in place of an array of numbers."""
        numbers[...] = self.together(numbers)

    def add_up(self, numbers):
        """Sum up an array over processes, in place, of whose numbers each but one has zero: it is
        the same on all, then."""
        from mpi4py import MPI

        self.comm.Allreduce(MPI.IN_PLACE, numbers)

    def before(self, count):
        """How many the processes before this one have of what this one has so many."""
        return sum(self.comm.allgather(count)[:self.comm.rank])

    def joined(self, rows):
        """What all processes have of an array, one after the other along its first axis."""
        return np.concatenate(self.comm.allgather(rows))

    def first_largest(self, fields):
        """The largest size of values, with the sign of the first about as large: those of an array
        (components, rows, columns), or of several, each of which goes on in the next process."""
        largest = self.largest(max(np.max(np.abs(field), initial=0.0) for field in fields))
        firsts = self.comm.allgather([next(iter(field[np.abs(field) >= 0.999 * largest]), 0.0)
                                      for field in fields])
        first = next(value for component in zip(*firsts) for value in component if value)
        return np.copysign(largest, first)

    def to_first(self, values):
        """Values (..., nodes) of all processes in the first of them, None in the others."""
        return to_first(self.comm, values, -1)

    def largest(self, number):
        """The largest of a number a process, or of several, an array."""
        own = np.array(number, dtype=float)
        every = np.empty((self.comm.size, *own.shape))
        self.comm.Allgather(own, every)
        return every.max(axis=0)

    def waves_at(self, spectrum, columns):
        """Columns of half spectra (..., *half spectrum), by their numbers, whoever has them."""
        found = self.columns.at(np.ascontiguousarray(np.moveaxis(spectrum, -1, -2)), columns)
        return np.moveaxis(found, -2, -1)

    def lone_columns(self):
        """Columns of half spectra that stand for one wave, as far as they are here."""
        here = self.waves
        return [number - here.start for number in super().lone_columns()
                if here.start <= number < here.stop]

    @cached_property
    def half(self):
        """Slabs of every other node; None where these are so few that every process has all."""
        if self.size // 4 <= GATHERED:
            return None
        return Slabs([n // 2 for n in self.shape], self.periods, self.comm, self.counter)

    @property
    def first_column(self):
        """Number of the first column of half spectra that is here."""
        return self.waves.start

    # Scalars among the unknowns: the last process has them.
    @property
    def has_scalars(self):
        """Whether scalars among unknowns are kept here."""
        return self.comm.rank == self.comm.size - 1

    def scalars(self, tail, count):
        """Numbers that the end of the last process's part of an unknown holds.

        Parameters
        ----------
        tail : array, this process's end: of ``count`` numbers on the last one, else empty
        count : int
        """
        if not count:
            return np.zeros(0)
        return self.together(tail if self.has_scalars else np.zeros(count))

    def held(self, scalars):
        """Of scalars those that are kept here: all or none."""
        return scalars if self.has_scalars else scalars[:0]


class EvenSlabs(EvenGrid, Slabs):
    """The same whose reductions run over a quarter of the nodes of even fields, each with its
    weight.

    Parameters
    ----------
    grid, weights, rows : as of `Slabs.weighted`
    """

    def __init__(self, grid, weights, rows):
        super().__init__(grid, weights)
        self.rows = rows
