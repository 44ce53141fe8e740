"""This process's rows of a cell that is shared out (`slabs`), or of a box of it: a window."""

import numpy as np

from .contours import ringed
from .rows import Rows
from .slab_nodes import SlabNodes
from .slab_transform import share, shares
from .windows import Window


class Slab(Window):
    """This process's rows of a box of the cell that does not wrap around its border; of the cell,
    where none is given.

    Parameters
    ----------
    grid : Slabs
    start, shape : of the box, as of `windows.Window`

    Attributes
    ----------
    start, shape : of what is here; ``origin`` and ``extents`` are those of the box
    rows : Rows of the box
    """

    def __init__(self, grid, start=(0, 0), shape=None):
        super().__init__(grid, start, grid.shape if shape is None else shape)
        first, column = self.origin
        self.rows = grid.rows if self.is_whole else Rows(
            grid.comm, grid.rows.within(slice(first, first + self.extents[0])), self.extents[0],
            "wrap" if self.closed[0] else "nearest")
        self.start = first + self.rows.first, column
        self.shape = self.rows.count, self.extents[1]
        self.size = self.shape[0] * self.shape[1]

    @property
    def of_nodes(self):
        """Class of windows of some of the cell's nodes."""
        return SlabNodes if self.is_whole else None

    @property
    def is_whole(self):
        """Whether the box is the cell."""
        return self.extents == self.grid.shape

    @property
    def total(self):
        """Number of nodes, in all processes."""
        return self.extents[0] * self.extents[1]

    @property
    def indices(self):
        """What picks the nodes from what is here of a field over the cell."""
        row, column = self.start[0] - self.grid.rows.first, self.start[1]
        return slice(row, row + self.shape[0]), slice(column, column + self.shape[1])

    def circle(self):
        """Shape of the circle that holds a convolution: the cell."""
        return self.grid.shape

    def node_numbers(self):
        """Numbers in the cell of the nodes that are here, array (nodes,)."""
        return np.add.outer((self.start[0] + np.arange(self.shape[0])) * self.grid.shape[1],
                            self.start[1] + np.arange(self.shape[1])).reshape(-1)

    @property
    def numbers(self):
        """Numbers of the nodes in what is here of fields over the cell, array (nodes,)."""
        return self.node_numbers() - self.grid.rows.first * self.grid.shape[1]

    @property
    def picked(self):
        """Whether nodes are some of those of the circle, by their numbers there (``on_circle``)."""
        return not self.is_whole

    @property
    def places(self):
        """Numbers of the nodes among those of the cell that are here, array (nodes,)."""
        return self.numbers.astype(np.int32)

    on_circle = places

    def occupied(self, mask, axis):
        """Where along an axis a mask (rows, columns) holds anywhere."""
        here = Window.occupied(self, mask, axis)
        if axis == 0:
            return self.rows.all(here[:, None])[:, 0]
        return self.grid.together(here) > 0.0

    def ends(self, mask):
        """As `windows.Window.ends`, of masks (rows, columns) whose rows others have, too."""
        rows, columns = (np.flatnonzero(Window.occupied(self, mask, axis)) for axis in range(2))
        return self.grid.ends([rows + self.rows.first, columns])

    def line(self, box, axis, through):
        """Values of a box along an axis, on the line through places of the other directions.

        Parameters
        ----------
        box : array (rows, columns)
        axis : int
        through : row and column, in the box
        """
        if axis == 0:
            return self.rows.all(box[:, through[1]:through[1] + 1])[:, 0]
        return self.rows.at(box, [through[0]])[0]

    def own(self, part):
        """A part of the box, slices, as far as it is here, and the same in what is here."""
        rows, (first, count) = part[0], (self.rows.first, self.rows.count)
        begin = min(max(rows.start, first), first + count)
        end = max(begin, min(rows.stop, first + count))
        return (slice(begin, end), part[1]), (slice(begin - first, end - first), part[1])

    def divided(self, part):
        """Of a part of the box, slices, what this process is to find: as many rows as others."""
        rows, comm = part[0], self.rows.comm
        mine = share(rows.stop - rows.start, comm.rank, comm.size)
        return slice(rows.start + mine.start, rows.start + mine.stop), *part[1:]

    def put_part(self, values, box, part):
        """Write values (..., rows, columns) of a part of the box, found as `divided` says, into
        what is here of a box.

        Parameters
        ----------
        values, box : arrays
        part : slices
        """
        begin, end = part[0].start, part[0].stop
        found = Rows(self.rows.comm, shares(end - begin, self.rows.comm.size), end - begin)
        wanted = [np.arange(first, first + count) for first, count in self.rows.within(part[0])]
        box[(..., *self.own(part)[1])] = found.given(values, wanted)

    def placed(self, transform, part=None):
        """A transform of the nodes' circle, of which each process has its rows, or of one of a part
        of them, slices.

        Parameters
        ----------
        transform : SlabCircle
        part : slices of the box
        """
        return transform.placed(self.rows.parts if part is None else self.rows.within(part[0]))

    def images(self, box, axis, middle, reach):
        """As `windows.Window.images`; of rows those that this process compares."""
        if axis == 2:
            return super().images(box, axis, middle, reach)
        away = self.rows.numbers - middle
        # one of the two, by turns, so that all processes have as much to do
        mine = np.flatnonzero((np.abs(away) <= reach) & ((away % 2 == 0) == (away <= 0)))
        found = box[:, mine], self.rows.at(box, middle - away[mine]), box[:, :self.rows.first == 0]
        return tuple(np.moveaxis(part, 1, 0) for part in found)

    def mirrored(self, values, axis):
        """As `windows.Window.mirrored`."""
        if axis == 1:
            return super().mirrored(values, axis)
        places = -self.rows.numbers - (not self.closed[0])
        return self.rows.at(self.box(values), places % self.extents[0]).reshape(values.shape)

    def cut(self, box, part):
        """A part of the box, slices, of values (..., rows, columns), whoever has them."""
        return self.rows.at(box, np.arange(part[0].start, part[0].stop))[..., part[1]]

    def ringed(self, box):
        """A box (..., rows, columns) with the nodes around it, or its outermost nodes again: a row
        before and two after."""
        return self.rows.around(ringed(box, self.closed[1:]), 1, 2)

    def with_rows(self, box, reach):
        """A box (..., rows, columns) with rows of others on either side."""
        return self.rows.around(box, reach, reach)

    def rim(self):
        """Mask of the nodes on the border of the box, in directions that it does not fill."""
        mask = np.zeros(self.shape, dtype=bool)
        if not self.closed[1]:
            mask[:, [0, -1]] = True
        if not self.closed[0]:
            mask[np.isin(self.rows.numbers, (0, self.extents[0] - 1))] = True
        return mask.reshape(-1)
