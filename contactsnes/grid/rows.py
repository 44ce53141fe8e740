"""Rows of a field over the cell that belong to several processes: rows of others, and all of
them."""

import numpy as np


class Rows:
    """Consecutive rows of this process, of those of all processes.

    Parameters
    ----------
    comm : communicator (mpi4py)
    parts : list of (first row, number of rows) of each process
    total : int, rows of all processes
    beyond : ``wrap``, ``nearest`` or ``mirror``: what follows beyond the first and the last row, by
        the names of SciPy's filters

    Attributes
    ----------
    first, count : int, the rows of this process
    fewest : int, rows of a process that has any
    """

    def __init__(self, comm, parts, total, beyond="wrap"):
        self.comm, self.parts, self.total, self._beyond = comm, parts, total, beyond
        self.first, self.count = parts[comm.rank]
        self.fewest = min((count for _, count in self.parts if count), default=0)

    @property
    def numbers(self):
        """Numbers in the cell of the rows that are here."""
        return np.arange(self.first, self.first + self.count)

    def within(self, rows):
        """Of consecutive rows, a slice, those of each process: a list of (first, number), counted
        from the first of them."""
        return [(min(max(first, rows.start), rows.stop) - rows.start,
                 max(min(first + count, rows.stop) - max(first, rows.start), 0))
                for first, count in self.parts]

    def at(self, field, wanted):
        """Rows of a field over the cell, wherever they are: (..., rows wanted, columns).

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        wanted : array of int, numbers of rows in the cell; each process asks for its own
        """
        return self.given(field, self.comm.allgather(np.asarray(wanted)))

    def given(self, field, asked):
        """The same where each process knows what all of them ask for, which need not be told then.

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        asked : for each process an array of int, numbers of rows in the cell
        """
        own = self.comm.rank
        mine = asked[own]
        found = np.empty((*field.shape[:-2], len(mine), field.shape[-1]), dtype=field.dtype)
        on_way, coming = [], []
        for rank, (rows, (first, count)) in enumerate(zip(asked, self.parts)):
            here = rows[(rows >= self.first) & (rows < self.first + self.count)] - self.first
            there = np.flatnonzero((mine >= first) & (mine < first + count))
            if rank == own:
                found[..., _slice(there), :] = field[..., _slice(here), :]
                continue
            if len(there):
                part = np.empty((*field.shape[:-2], len(there), field.shape[-1]), field.dtype)
                coming.append((self.comm.Irecv(part, source=rank), there, part))
            if len(here):
                part = np.ascontiguousarray(field[..., _slice(here), :])
                on_way.append((self.comm.Isend(part, dest=rank), part))
        for request, there, part in coming:
            request.Wait()
            found[..., _slice(there), :] = part
        for request, _ in on_way:
            request.Wait()
        return found

    def around(self, field, before, after):
        """A field (..., rows, columns) with rows before and after, whoever has them.

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        before, after : int, the same in all processes
        """
        first, last = self.beside(field, before, after)
        return np.concatenate([first, field, last], axis=-2)

    def beside(self, field, before, after):
        """These rows before and after alone.

        Parameters
        ----------
        field, before, after : as of `around`
        """
        asked = [self._inside(np.r_[first - before:first, first + number:first + number + after])
                 for first, number in self.parts]
        found = self.given(field, asked)
        return found[..., :before, :], found[..., before:, :]

    def _inside(self, numbers):
        """Numbers of the rows that stand for those of numbers beyond the first or the last one."""
        if self._beyond == "nearest":
            return np.clip(numbers, 0, self.total - 1)
        if self._beyond == "wrap":
            return numbers % self.total
        around = numbers % max(2 * (self.total - 1), 1)
        return np.minimum(around, 2 * (self.total - 1) - around)

    def all(self, field):
        """All rows of a field over the cell, on every process.

        Parameters
        ----------
        field : array (rows of this process, columns)
        """
        field = np.ascontiguousarray(field)
        found = np.empty((self.total, field.shape[1]), field.dtype)
        wide = field.shape[1] * field.itemsize
        counts, places = zip(*((wide * count, wide * first) for first, count in self.parts))
        self.comm.Allgatherv(field.view(np.uint8), [found.view(np.uint8), (counts, places)])
        return found

    def in_turn(self, field):
        """Rows of a field over the cell, of one process after the other, in the first process;
        nothing in the others.

        Parameters
        ----------
        field : array (rows of this process, columns)
        """
        if self.comm.rank:
            self.comm.Send(np.ascontiguousarray(field), dest=0)
            return
        yield field
        for rank, (_, count) in enumerate(self.parts[1:], start=1):
            got = np.empty((count, *field.shape[1:]), dtype=field.dtype)
            self.comm.Recv(got, source=rank)
            yield got

    def of_first(self, field, columns):
        """This process's rows of a field over the cell that the first one has as a whole.

        Parameters
        ----------
        field : array (rows, columns) in the first process
        columns : int
        """
        if self.comm.rank:
            found = np.empty((self.count, columns))
            self.comm.Recv(found, source=0)
            return found
        for rank, (first, count) in enumerate(self.parts[1:], start=1):
            self.comm.Send(np.ascontiguousarray(field[first:first + count], float), dest=rank)
        return np.array(field[:self.count], float)


def _slice(numbers):
    """Numbers as a slice, where they follow each other upwards: no copy is made to pick them."""
    if len(numbers) and numbers[-1] - numbers[0] == len(numbers) - 1 and np.all(
            numbers[1:] > numbers[:-1]):
        return slice(int(numbers[0]), int(numbers[-1]) + 1)
    return numbers


def to_first(comm, array, axis):
    """Arrays of all processes on the first one, joined along an axis; None on the others.

    They come one by one, so that the first process never has more than all and one of them, and no
    message is beyond what MPI can count.

    Parameters
    ----------
    comm : communicator (mpi4py)
    array : array, of one shape in all processes but for that axis
    axis : int
    """
    lengths = comm.gather(array.shape[axis])
    if lengths is None:
        comm.Send(np.ascontiguousarray(array), dest=0)
        return None
    shape = list(array.shape)
    shape[axis] = sum(lengths)
    found = np.empty(shape, dtype=array.dtype)
    parts = np.split(np.moveaxis(found, axis, 0), np.cumsum(lengths)[:-1])
    parts[0][...] = np.moveaxis(array, axis, 0)
    for rank, (length, part) in enumerate(zip(lengths, parts)):
        if rank:
            shape[axis] = length
            got = np.empty(shape, dtype=array.dtype)
            comm.Recv(got, source=rank)
            part[...] = np.moveaxis(got, axis, 0)
    return found
