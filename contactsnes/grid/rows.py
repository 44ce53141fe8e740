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
    """

    def __init__(self, comm, first, count, total):
        self.comm, self.first, self.count, self.total = comm, first, count, total
        self._parts = comm.allgather((first, count))
        self.fewest = min(count for _, count in self._parts)

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
        for (first, count), part in zip(self._parts, got):
            found[..., (mine >= first) & (mine < first + count), :] = part
        return found

    def counted(self, count):
        """How many the processes before this one have of what it has so many, and all have."""
        counts = self.comm.allgather(count)
        return sum(counts[:self.comm.rank]), sum(counts)

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
        parts = self.comm.gather(np.ascontiguousarray(field))
        return None if parts is None else np.concatenate(parts, axis=-2)
