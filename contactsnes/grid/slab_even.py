"""Even and odd fields of a cell that is shared out among processes (`slabs`): a quarter of the
nodes of a box, or half of them, of whose rows every process has as many as others, wherever those
of the cell are."""

import numpy as np

from .even import EvenWindow, negate
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
        start, self._lines = self._halve(full, parities)
        # in pairs, which single precision takes for one row of complex numbers
        ends = [[min(2 * end, self.extents[0]) for end in (first, first + number)]
                for first, number in shares((self.extents[0] + 1) // 2, cell.comm.size)]
        beyond = "mirror" if self.mirrors[0] else "wrap" if self.closed[0] else "nearest"
        self.rows = Rows(cell.comm, [(begin, end - begin) for begin, end in ends],
                         self.extents[0], beyond)
        self.start = start[0] + self.rows.first, start[1]
        self.shape = self.rows.count, self.extents[1]
        self.size = self.shape[0] * self.shape[1]
        weights = np.multiply.outer(self._lines[0][self.rows.numbers], self._lines[1])
        self.grid = cell.weighted(weights.reshape(-1), self.rows)

    occupied, own, total, with_rows = Slab.occupied, Slab.own, Slab.total, Slab.with_rows
    line, divided, put_part, ends = Slab.line, Slab.divided, Slab.put_part, Slab.ends
    indices = None  # those of the cell are in other processes

    def placed(self, transform, part=None):
        """As `Slab.placed`.

        Parameters
        ----------
        transform : SlabEvenCircle
        part : slices of the box
        """
        rows, columns = part or [slice(0, n) for n in self.extents]
        return transform.placed(self.rows.within(rows), columns.stop - columns.start)

    def _outwards(self, rows, values, extents, origin):
        """Values (..., nodes) at these nodes, of a box (..., rows, columns) about the apex.

        Parameters
        ----------
        rows : Rows of the box
        values : array (..., rows, columns)
        extents : rows and columns of the box
        origin : first row and column of the full window in it
        """
        begin, half = (n // 2 if mirror else first
                       for n, first, mirror in zip(extents, origin, self.mirrors))
        wanted = [(begin + np.arange(first, first + count)) % extents[0]
                  for first, count in self.rows.parts]
        found = rows.given(values[..., half:half + self.extents[1]], wanted)
        if found.shape[-1] < self.extents[1]:
            # where the cell closes, the last column stands before the first one of the window
            found = np.concatenate([found, rows.given(values[..., :1], wanted)], axis=-1)
        return found.reshape(*found.shape[:-2], self.size)

    def take(self, field):
        """Values (..., nodes) of a field (..., rows, columns) over the cell at these nodes."""
        cell = self.full.grid
        return self._outwards(cell.rows, field, cell.shape, self.full.origin)

    def fold(self, values):
        """As `EvenWindow.fold`."""
        full = self.full
        return self.odd(self._outwards(full.rows, full.box(values), full.extents, (0, 0)))

    def _numbers(self, axis):
        """As `EvenWindow._numbers`, of those here."""
        return super()._numbers(axis) if axis else self.rows.numbers

    def unfold(self, values):
        """Values (..., nodes) of the full window from those at these nodes; what is odd is so for
        arrays (components, nodes) alone."""
        numbers = self.full.rows.numbers, np.arange(self.full.extents[1])
        half, columns = self.full.extents[0] // 2 * self.mirrors[0], self.full.extents[1]
        found = self.rows.given(self.box(values), [np.abs(np.arange(first, first + count) - half)
                                                   for first, count in self.full.rows.parts])
        if self.mirrors[1]:
            found = np.concatenate([found[..., columns // 2:0:-1],
                                    found[..., :columns - columns // 2]], axis=-1)
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
        beside = "reflect" if self.mirrors[1] else "wrap" if self.closed[1] else "edge"
        found = self.rows.around(np.pad(box, ((0, 0), (1, 1)), beside), 1, 2)
        return found[:-1] if self.rows.first + self.rows.count == self.rows.total else found

    def wave_weights(self):
        """How many waves of the cell each cosine of this process stands for."""
        comm = self.full.grid.comm
        return np.multiply.outer(self._lines[0], self._lines[1][share(self.extents[1], comm.rank,
                                                                      comm.size)])

    def rim(self):
        """Mask of the nodes on the border of the full window."""
        mask, lines = np.zeros(self.shape, dtype=bool), (self.rows.numbers,
                                                         np.arange(self.extents[1]))
        for axis, (line, closed, mirror) in enumerate(zip(lines, self.closed, self.mirrors)):
            if not closed:
                ends = [self.extents[axis] - 1] if mirror else [0, self.extents[axis] - 1]
                mask.swapaxes(axis, 0)[np.isin(line, ends)] = True
        return mask.reshape(-1)
