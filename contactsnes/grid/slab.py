"""This process's rows of a cell that is shared out (`slabs`): a window."""

import math

import numpy as np

from .slab_nodes import SlabNodes
from .windows import Window


class Slab(Window):
    """This process's rows of the cell, as a window that is the whole cell.

    Parameters
    ----------
    grid : Slabs
    """

    is_whole, of_nodes = True, SlabNodes

    def __init__(self, grid):
        super().__init__(grid, (0, 0), grid.shape)
        self.start, self.shape = (grid.rows.first, 0), grid.local_shape
        self.size = math.prod(grid.local_shape)
        self.indices = slice(None), slice(None)

    @property
    def total(self):
        """Number of nodes, in all processes."""
        return self.grid.size

    def take(self, field):
        """Values (..., nodes) of a field (..., rows, columns) of this process: a view."""
        return np.ascontiguousarray(field).reshape(*field.shape[:-2], self.size)

    def circle(self):
        """Shape of the circle that holds a convolution: the cell."""
        return self.grid.shape

    def node_numbers(self):
        """Numbers in the cell of the nodes that are here, array (nodes,)."""
        return np.arange(self.size) + self.start[0] * self.grid.shape[1]

    @property
    def extents(self):
        """Nodes in each direction, in all processes."""
        return self.grid.shape

    def occupied(self, mask, axis):
        """Where along an axis a mask (rows, columns) holds anywhere."""
        here = super().occupied(mask, axis)
        if axis == 0:
            return self.grid.rows.all(here[:, None])[:, 0]
        return self.grid.together(here) > 0.0

    def line(self, box, axis, through):
        """Values of a box along an axis, on the line through places of the other directions.

        Parameters
        ----------
        box : array (rows, columns)
        axis : int
        through : row and column, in the cell
        """
        if axis == 0:
            return self.grid.rows.all(box[:, through[1]:through[1] + 1])[:, 0]
        return self.grid.rows.at(box, [through[0]])[0]

    def own(self, part):
        """A part of the cell, slices, as far as it is here, and the same in what is here."""
        rows, (first, count) = part[0], (self.grid.rows.first, self.grid.rows.count)
        begin, end = max(rows.start, first), min(rows.stop, first + count)
        end = max(begin, end)
        return (slice(begin, end), part[1]), (slice(begin - first, end - first), part[1])

    def cut(self, box, part):
        """A part of the cell, slices, of a box (..., rows, columns), whoever has it."""
        return self.grid.rows.at(box, np.arange(part[0].start, part[0].stop))[..., part[1]]

    def ringed(self, box):
        """A box (..., rows, columns) with the nodes around it: a row before and two after."""
        box = np.concatenate([box[..., -1:], box, box[..., :2]], axis=-1)
        return self.grid.rows.around(box, 1, 2)
