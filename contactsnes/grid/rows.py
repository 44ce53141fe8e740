"""Rows of a field over the cell that belong to several processes: rows of others, and all of
them."""

import numpy as np


class Rows:
    """Consecutive rows of this process, of those of all processes.

    Parameters
    ----------
    comm : communicator (mpi4py)
    first, count : int, the rows of this process
    total : int, rows of the cell

    Attributes
    ----------
    parts : list of (first row, number of rows) of each process
    """

    def __init__(self, comm, first, count, total):
        self.comm, self.first, self.count, self.total = comm, first, count, total
        self.parts = comm.allgather((first, count))
        self.fewest = min(count for _, count in self.parts)

    @property
    def numbers(self):
        """Numbers in the cell of the rows that are here."""
        return np.arange(self.first, self.first + self.count)

    def at(self, field, wanted):
        """Rows of a field over the cell, wherever they are: (..., rows wanted, columns).

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        wanted : array of int, numbers of rows in the cell; each process asks for its own
        """
        asked = self.comm.allgather(np.asarray(wanted))
        sent = [field[..., rows[(rows >= self.first) & (rows < self.first + self.count)]
                      - self.first, :] for rows in asked]
        got = self.comm.alltoall(sent)
        mine = asked[self.comm.rank]
        found = np.empty((*field.shape[:-2], len(mine), field.shape[-1]), dtype=field.dtype)
        for (first, count), part in zip(self.parts, got):
            found[..., (mine >= first) & (mine < first + count), :] = part
        return found

    def around(self, field, before, after):
        """A field (..., rows, columns) with rows of the cell before and after, around its border.

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        before, after : int
        """
        numbers = np.arange(-before, self.count + after) + self.first
        outside = np.r_[0:before, before + self.count:len(numbers)]
        wide = np.empty((*field.shape[:-2], len(numbers), field.shape[-1]), dtype=field.dtype)
        wide[..., before:before + self.count, :] = field
        wide[..., outside, :] = self.at(field, numbers[outside] % self.total)
        return wide

    def all(self, field):
        """All rows of a field over the cell, on every process.

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        """
        return np.concatenate(self.comm.allgather(np.ascontiguousarray(field)), axis=-2)

    def to_first(self, field):
        """All rows of a field over the cell on the first process, None on the others.

        Parameters
        ----------
        field : array (..., rows of this process, columns)
        """
        return to_first(self.comm, field, -2)


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
