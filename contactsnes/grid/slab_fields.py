"""Fields over a cell that is shared out among processes (`slabs`), of which each has its rows."""

import numpy as np

from .fields import Fields
from .slab_transform import share

SAMPLED = 256
"""Rows and columns, about, of which a quantile is taken."""


class SlabFields(Fields):
    """Fields over the cell of a grid of which this process has some ``rows``, and all processes the
    others (``comm``)."""

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

    def every_other(self, field):
        """A field over the cell at every other node: this process's rows of ``half`` or, where
        that is none, a whole one."""
        if self.half is None:
            return self.rows.all(field[..., self.rows.first % 2::2, ::2])
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
        node = np.unravel_index(np.argmax(field), field.shape)
        tops = self.comm.allgather((field[node], (int(node[0]) + self.rows.first, int(node[1]))))
        return max(tops, key=lambda top: top[0])[1]

    def noise(self, count, seed):
        """Random numbers (count, rows, columns), each row's its own."""
        return np.stack([np.random.default_rng((seed, row)).standard_normal(
            (count, self.shape[1])) for row in self.rows.numbers], axis=1)
