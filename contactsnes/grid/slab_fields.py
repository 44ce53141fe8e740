"""Fields over a cell that is shared out among processes (`slabs`), of which each has its rows."""

import math
from itertools import islice

import numpy as np

from . import parted
from .fields import Fields
from .rows import Rows
from .slab_transform import share, shares

SOWN = 16
"""Rows whose random numbers are of one generator: to make one takes as long as a row."""
SAMPLED = 256
"""Rows and columns, about, of which a quantile is taken."""
UNEVEN = 1.25
"""How many times the mean a process may have of what is worked on, that nothing is sent."""


class SlabFields(Fields):
    """Fields over the cell of a grid of which this process has some ``rows``, and all processes the
    others (``comm``)."""

    @property
    def idle(self):
        """How many processes have no rows."""
        return sum(not count for _, count in self.rows.parts)

    def in_patches(self, apart):
        """Whether the cell is made of patches of ``apart`` nodes in each direction, and each
        process's rows of whole ones."""
        return super().in_patches(apart) and not any(first % apart
                                                     for first, _ in self.rows.parts)

    def with_rows(self, field, reach):
        """A field over the cell (..., rows, columns) with rows on either side."""
        return self.rows.around(field, reach, reach)

    def without_rows(self, field, reach):
        """The same without them."""
        return field[..., reach:field.shape[-2] - reach, :]

    def first_part(self, field, part):
        """(first row and number of rows, values there) of this process's share of the first nodes
        of a field over the cell.

        Parameters
        ----------
        field : array (rows, columns)
        part : slices from 0 on
        """
        mine = share(part[0].stop, self.comm.rank, self.comm.size)
        return (mine.start, mine.stop - mine.start), self.rows.at(
            field[:, part[1]], np.arange(mine.start, mine.stop))

    def mirrored(self, field, axis):
        """Mirror image about the apex, along an axis of the cell, of a field over it (..., rows,
        columns).

        Parameters
        ----------
        field : array
        axis : int, of the cell
        """
        if axis == 1:
            return super().mirrored(field, axis)
        return self.rows.at(field, -self.rows.numbers % self.shape[0])

    def row_before(self, field):
        """The row of a field over the cell before the first one that is here."""
        return self.rows.at(field, [(self.rows.first - 1) % self.shape[0]])[0]

    @property
    def row_numbers(self):
        """Numbers in the cell of the rows that are here."""
        return self.rows.numbers

    def part_of(self, field):
        """This process's rows of a whole field over the cell (..., *grid)."""
        return field[..., self.rows.first:self.rows.first + self.rows.count, :]

    def spread(self, make):
        """This process's rows of a whole field over the cell (*grid) that a function makes in the
        first one, which then sends the others theirs; what it raises is raised in all."""
        made = error = None
        if not self.comm.rank:
            try:
                made = make()
            except Exception as raised:
                error = raised
        error = self.comm.bcast(error)
        if error is not None:
            raise error
        return self.rows.of_first(made, self.shape[1])

    def turns(self, items):
        """Of things that every process has one after the other those that are this one's to do."""
        return islice(items, self.comm.rank, None, self.comm.size)

    def in_turn(self, field):
        """Rows of a field over the cell, of one process after the other; in the first one, which
        never has more than those of one other."""
        yield from self.rows.in_turn(field)

    def of_first(self, value):
        """A value of the first process, in all of them."""
        return self.comm.bcast(value)

    def every_other(self, field):
        """A field over the cell at every other node: this process's rows of ``half`` or, where
        that is none, a whole one."""
        if self.half is None:
            return np.concatenate(self.comm.allgather(field[..., self.rows.first % 2::2, ::2]), -2)
        return self.rows.at(field[..., ::2], 2 * self.half.rows.numbers)

    def quantiles(self, field, parts):
        """Values below which parts of a field over the cell lie, about: of some rows and
        columns."""
        strides = [max(1, n // SAMPLED) for n in self.shape]
        sample = field[self.rows.numbers % strides[0] == 0, ::strides[1]]
        return np.quantile(np.concatenate(self.comm.allgather(sample)), parts)

    def edge(self, field, axis):
        """The first row or column of a field over the cell, as far as it is here."""
        return field[:self.rows.first == 0] if axis == 0 else field[:, :1]

    def highest(self, field):
        """The first node of the largest value of a field over the cell, a tuple of int."""
        here = []  # (of a process without rows none)
        if field.size:
            row, column = map(int, np.unravel_index(np.argmax(field), field.shape))
            here = [(field[row, column], (row + self.rows.first, column))]
        tops = [top for own in self.comm.allgather(here) for top in own]
        return max(tops, key=lambda top: top[0])[1]

    def parted(self, values, axis=-1, change=lambda block: block):
        """What a function makes of the array of values that all processes have, one after the other
        along an axis: `parted.parted`.

        Parameters
        ----------
        values : array, of this process
        axis : int
        change : function (array), of each number by itself
        """
        return parted.parted(self.comm, values, axis, change)

    def taking(self, act):
        """Call a function that takes blocks of `parted` arrays, in the first process."""
        parted.taking(self.comm, act)

    def in_order(self, keys, arrays):
        """Arrays of nodes (..., nodes) of all processes in the order of keys, `parted`: about as
        many nodes for each process, of which it has some numbers of the first key.

        Parameters
        ----------
        keys : list of arrays of int (nodes,), the first of which decides first
        arrays : mapping
        """
        most = 1 + int(self.largest(np.max(keys[0], initial=0)))
        before = np.cumsum(self.together(np.bincount(keys[0], minlength=most)))
        owner = np.minimum(before * self.comm.size // (before[-1] + 1), self.comm.size - 1)
        owner = owner.astype(int)[keys[0]]
        mine = [np.flatnonzero(owner == rank) for rank in range(self.comm.size)]

        def exchanged(values):
            return np.concatenate(self.comm.alltoall([values[part] for part in mine]))

        order, found = np.lexsort([exchanged(key) for key in keys[::-1]]), {}
        for name, values in arrays.items():
            rows = values.reshape(math.prod(values.shape[:-1]), values.shape[-1])
            own = np.empty((len(rows), len(order)), values.dtype)
            for i, row in enumerate(rows):  # (one by one: what is on its way takes memory)
                own[i] = exchanged(row)[order]
            found[name] = self.parted(own.reshape(*values.shape[:-1], -1))
        return found

    def evened(self, rows):
        """Of what all processes have of an array along its first axis about as much for each, to be
        worked on; what is there, where that is so already."""
        counts = self.comm.allgather(len(rows))
        if max(counts) * self.comm.size <= UNEVEN * sum(counts):
            return rows
        total, parts = sum(counts), list(zip(np.cumsum([0, *counts]).tolist(), counts))
        wanted = [np.arange(first, first + number)
                  for first, number in shares(total, self.comm.size)]
        found = Rows(self.comm, parts, total).given(
            rows.reshape(len(rows), math.prod(rows.shape[1:])), wanted)
        return found.reshape(-1, *rows.shape[1:])

    def noise(self, count, seed):
        """Random numbers (count, rows, columns), those of a row the same whoever has it."""
        found, first = np.empty((count, self.rows.count, self.shape[1])), self.rows.first
        for begin in range(first - first % SOWN, first + self.rows.count, SOWN):
            sown = np.random.default_rng((seed, begin)).standard_normal(
                (SOWN, count, self.shape[1]))[max(first - begin, 0):]
            place = max(begin - first, 0)
            here = found[:, place:place + len(sown)]
            here[...] = sown[:here.shape[1]].swapaxes(0, 1)
        return found
