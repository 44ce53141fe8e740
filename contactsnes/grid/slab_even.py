"""Even and odd fields of a cell that is shared out among processes (`slabs`): a quarter of the
nodes of a box, of whose rows every process has as many as others, wherever those of the cell
are."""

import numpy as np

from .even import EvenWindow, line_weights, negate
from .mirrors import unlike
from .rows import Rows
from .slab import Slab
from .slab_transform import share, shares


class SlabEven(EvenWindow):
    """This process's rows of the nodes of a centred window from the apex outwards, as
    `even.EvenWindow`.

    Parameters
    ----------
    full : Slab
    parities : as of `even.EvenWindow`

    Attributes
    ----------
    extents : nodes in each direction, of which ``shape`` are here
    rows : Rows of the quarter
    """

    def __init__(self, full, parities=None):
        cell = full.grid
        self.full, self.parities, self.limits = full, unlike(parities), tuple(
            n // 2 + 1 for n in cell.shape)
        self.extents, self.closed = tuple(n // 2 + 1 for n in full.extents), full.closed
        # in pairs, which single precision takes for one row of complex numbers
        ends = [[min(2 * end, self.extents[0]) for end in (first, first + number)]
                for first, number in shares((self.extents[0] + 1) // 2, cell.comm.size)]
        self.rows = Rows(cell.comm, [(begin, end - begin) for begin, end in ends],
                         self.extents[0], "mirror")
        self.start = tuple(n // 2 + first for n, first in zip(cell.shape, (self.rows.first, 0)))
        self.shape = self.rows.count, self.extents[1]
        self.size = self.shape[0] * self.shape[1]
        self._lines = [line_weights(*line) for line in zip(self.extents, self.closed)]
        weights = np.multiply.outer(self._lines[0][self.rows.numbers], self._lines[1])
        self.grid = cell.weighted(weights.reshape(-1), self.rows)

    occupied, own, total, with_rows = Slab.occupied, Slab.own, Slab.total, Slab.with_rows
    line, divided, put_part, placed = Slab.line, Slab.divided, Slab.put_part, Slab.placed
    ends = Slab.ends
    indices = None  # those of the cell are in other processes
    mirrors = (True, True)

    def _outwards(self, rows, values, extents):
        """Values (..., nodes) at these nodes, of a box (..., rows, columns) about the apex.

        Parameters
        ----------
        rows : Rows of the box
        values : array (..., rows, columns)
        extents : rows and columns of the box
        """
        half = extents[1] // 2
        wanted = [(extents[0] // 2 + np.arange(first, first + count)) % extents[0]
                  for first, count in self.rows.parts]
        found = rows.given(values[..., half:half + self.extents[1]], wanted)
        if found.shape[-1] < self.extents[1]:
            # where the cell closes, the last column stands before the first one of the window
            found = np.concatenate([found, rows.given(values[..., :1], wanted)], axis=-1)
        return found.reshape(*found.shape[:-2], self.size)

    def take(self, field):
        """Values (..., nodes) of a field (..., rows, columns) over the cell at these nodes."""
        return self._outwards(self.full.grid.rows, field, self.full.grid.shape)

    def fold(self, values):
        """As `EvenWindow.fold`."""
        return self.odd(self._outwards(self.full.rows, self.full.box(values), self.full.extents))

    def _numbers(self, axis):
        """As `EvenWindow._numbers`, of those here."""
        return super()._numbers(axis) if axis else self.rows.numbers

    def unfold(self, values):
        """Values (..., nodes) of the full window from those at these nodes; what is odd is so for
        arrays (components, nodes) alone."""
        numbers = self.full.rows.numbers, np.arange(self.full.extents[1])
        half, columns = self.full.extents[0] // 2, self.full.extents[1]
        rows = self.rows.given(self.box(values), [np.abs(np.arange(first, first + count) - half)
                                                  for first, count in self.full.rows.parts])
        found = np.concatenate([rows[..., columns // 2:0:-1], rows[..., :columns - columns // 2]],
                               axis=-1)
        for field, signs in zip(found, self.parities or () if found.ndim > 2 else ()):
            for axis, odd in enumerate(signs):
                if odd < 0:
                    own, middle = numbers[axis], self.full.extents[axis] // 2
                    negate(field, axis, own < middle,
                           [own == middle, own == 0] if self.closed[axis] else [own == middle])
        return found.reshape(*values.shape[:-1], self.full.size)

    def _along(self, box, places, axis):
        """As `EvenWindow._along`."""
        return super()._along(box, places, axis) if axis else self.rows.at(box, np.abs(places))

    def ringed(self, box):
        """A box (rows, columns) with the mirror images, or rows of others, around it: a row before
        and, as far as there are squares between them, two after."""
        found = self.rows.around(np.pad(box, ((0, 0), (1, 1)), "reflect"), 1, 2)
        return found[:-1] if self.rows.first + self.rows.count == self.rows.total else found

    def wave_weights(self):
        """How many waves of the cell each cosine of this process stands for."""
        comm = self.full.grid.comm
        return np.multiply.outer(self._lines[0], self._lines[1][share(self.extents[1], comm.rank,
                                                                      comm.size)])

    def rim(self):
        """Mask of the nodes on the border of the full window."""
        mask = np.zeros(self.shape, dtype=bool)
        if not self.closed[1]:
            mask[:, -1] = True
        if not self.closed[0]:
            mask[self.rows.numbers == self.extents[0] - 1] = True
        return mask.reshape(-1)
