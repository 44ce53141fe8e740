"""Arrays of which several processes have parts, for the first one to take block by block: it never
has them as a whole."""

import copy
import itertools
import math
import weakref

import numpy as np

from .rows import to_first

BLOCK = 2 ** 18
"""Numbers of a block, at most about."""

SMALL = 2 ** 14
"""Numbers of an array up to which the first process has it as a whole."""

_numbers, _known = itertools.count(), weakref.WeakValueDictionary()


class Parted:
    """An array whose parts along an axis belong to processes, in their order. Each makes it with
    its own part, and keeps it as long as the first one may ask for it (`taking`).

    Parameters
    ----------
    comm : communicator (mpi4py)
    part : array, this process's
    axis : int, along which parts stand one after the other
    """

    def __init__(self, comm, part, axis):
        self.part, self._axis, self._comm = part, axis % part.ndim, comm
        self._lengths = comm.allgather(part.shape[axis])
        self.shape = (*part.shape[:self._axis], sum(self._lengths), *part.shape[self._axis + 1:])
        self.ndim, self.dtype, self.size = part.ndim, part.dtype, math.prod(self.shape)
        self._changed = lambda block: block
        self._number = next(_numbers)  # the same in all processes
        _known[self._number] = self

    def mapped(self, function, dtype=None):
        """The same array with numbers that a function makes of each block, of a type (default that
        of these)."""
        found, before = copy.copy(self), self._changed
        found.original = self  # kept alive: the first process asks for it by its number
        found._changed = lambda block: function(before(block))
        found.dtype = np.dtype(self.dtype if dtype is None else dtype)
        return found

    def blocks(self):
        """In the first process, in the order of memory: (what picks a block from the array, slices;
        its numbers)."""
        axis, total = self._axis, self.shape[self._axis]
        lead, trail = math.prod(self.shape[:axis]), math.prod(self.shape[axis + 1:])
        step = max(1, BLOCK // max(1, total * trail))
        for first in range(0, lead, step):
            leads = (slice(first, min(first + step, lead)),) if axis else ()
            if total * trail <= BLOCK:
                parts = [self._of(rank, (*leads, slice(0, n)))
                         for rank, n in enumerate(self._lengths)]
                yield (*leads, slice(0, total)), np.concatenate(parts, axis=axis)
                continue
            begin, most = 0, max(1, BLOCK // trail)
            for rank, length in enumerate(self._lengths):
                for place in range(0, length, most):
                    inside = slice(place, min(place + most, length))
                    there = slice(begin + inside.start, begin + inside.stop)
                    yield (*leads, there), self._of(rank, (*leads, inside))
                begin += length

    def _of(self, rank, where):
        """A block of the part of a process, slices of the first axes."""
        if rank:
            shape = [n.stop - n.start for n in where]
            found = np.empty((*shape, *self.part.shape[len(shape):]), self.part.dtype)
            if found.size:
                self._comm.send((self._number, where), dest=rank)
                self._comm.Recv(found, source=rank)
        else:
            found = self.part[where]
        return np.asarray(self._changed(found), self.dtype)


def parted(comm, part, axis, change):
    """The `Parted` array of what a function makes of parts, block by block; a small one is whole in
    the first process, None in others.

    Parameters
    ----------
    comm, part, axis : as of `Parted`
    change : function (array), of each number by itself
    """
    if sum(comm.allgather(part.size)) <= SMALL:
        return to_first(comm, change(part), axis)
    return Parted(comm, part, axis).mapped(change)


def taking(comm, act):
    """Call a function in the first process, while the others give it the blocks that it asks for.

    Parameters
    ----------
    comm : communicator (mpi4py)
    act : function without arguments
    """
    if not comm.rank:
        try:
            act()
        finally:
            for rank in range(1, comm.size):
                comm.send(None, dest=rank)
        return
    while (asked := comm.recv(source=0)) is not None:
        number, where = asked
        comm.Send(np.ascontiguousarray(_known[number].part[where]), dest=0)


def blocks(array):
    """The blocks of an array, as of `Parted`; of one that is whole, itself."""
    return array.blocks() if isinstance(array, Parted) else [((), array)]


def typed(array, kind):
    """An array, perhaps Parted, with numbers of a type."""
    if isinstance(array, Parted):
        return array if array.dtype == kind else array.mapped(lambda block: block, kind)
    return np.asarray(array, kind)


def in_pieces(array):
    """How HDF5 is to lay out a dataset that is compressed: of an array that is Parted, in chunks
    that are written one by one."""
    return ({"chunks": (*(1,) * (array.ndim - 2), *chunk(array.shape[-2:]))}
            if isinstance(array, Parted) else {})


def chunk(shape):
    """Shape of the pieces of an array (rows, columns), or (nodes,)."""
    return min(piece_rows(shape), shape[0]), *shape[1:]


def largest(array):
    """The largest size of a number of an array, Parted or not; 0 of none."""
    return max((float(np.max(np.abs(block), initial=0.0)) for _, block in blocks(array)),
               default=0.0)


def pieces(shape):
    """What picks parts of at most about `BLOCK` numbers from an array (components, rows, columns),
    or of less axes, in the order of memory: rows of one component each.

    Parameters
    ----------
    shape : tuple of int
    """
    if math.prod(shape) <= BLOCK:
        yield tuple(slice(0, n) for n in shape)
        return
    *lead, rows = shape[:-1] if len(shape) > 1 else shape
    step = piece_rows(shape)
    for place in itertools.product(*map(range, lead)):
        for first in range(0, rows, step):
            yield (*(slice(i, i + 1) for i in place), slice(first, min(first + step, rows)))


def piece_rows(shape):
    """Rows of a piece of an array of a shape."""
    return max(1, BLOCK // (shape[-1] if len(shape) > 1 else 1))
