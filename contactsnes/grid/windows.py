"""Windows: boxes of the cell's nodes."""

import math
from functools import cached_property

import numpy as np

from .contours import area_below, at_level, intervals, ringed
from .lengths import fast_length


class Window:
    """A box of the cell's nodes, which may wrap around its border, as one flat index of nodes.

    Parameters
    ----------
    grid : the cell
    start : first node in each direction; 0 is taken in directions that the window fills
    shape : nodes in each direction

    Attributes
    ----------
    origin, extents : start and shape of the box, of which a process may have a part only
    """

    even = False  # whether a node stands for its mirror images, too
    picked = False  # whether nodes are some of those of a circle, by their numbers there
    of_nodes = None  # class of windows of some of its nodes, where it has one of its own
    mirrors = (False, False)  # whether a direction has a mirror, and nodes are from there on
    units = (1, 1)  # of what numbers of nodes parts of it begin at, in each direction

    def __init__(self, grid, start, shape):
        self.grid = grid
        self.shape = tuple(int(n) for n in shape)
        self.start = tuple(int(s) % total if n < total else 0
                           for s, n, total in zip(start, self.shape, grid.shape))
        self.origin, self.extents = self.start, self.shape
        self.size, self.limits = math.prod(self.shape), grid.shape
        self.closed = tuple(n == total for n, total in zip(self.shape, grid.shape))

        self._which = self.start, self.shape, grid.shape, grid.periods

    def __eq__(self, other):
        """Whether these are the same nodes of the same cell, whoever counts its transforms."""
        return type(self) is type(other) and self._which == other._which

    def __hash__(self):
        return hash(self._which)

    @property
    def total(self):
        """Number of nodes, in all processes."""
        return self.size

    def ringed(self, box):
        """A box (..., *box) with the nodes around it, or its outermost nodes again."""
        return ringed(box, self.closed)

    @property
    def parts(self):
        """The boxes of which the window is made: one."""
        return (self,)

    @property
    def is_whole(self):
        """Whether the window is the whole cell."""
        return self.shape == self.grid.shape

    @cached_property
    def indices(self):
        """What picks the window's nodes from a field over the cell: slices, or an open mesh if it
        wraps around the border."""
        if all(s + n <= total for s, n, total in zip(self.start, self.shape, self.grid.shape)):
            return tuple(slice(s, s + n) for s, n in zip(self.start, self.shape))
        return np.ix_(*((s + np.arange(n)) % total for s, n, total in zip(self.start, self.shape,
                                                                          self.grid.shape)))

    def coordinates(self):
        """Coordinates of the window's nodes, beta, continued over the cell's border, to broadcast
        over the box."""
        axes = [(s + np.arange(n) - total // 2) * h
                for s, n, total, h in zip(self.start, self.shape, self.grid.shape,
                                          self.grid.spacings)]
        return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at the window's nodes: a view if that is the
        whole cell."""
        lead = field.shape[:field.ndim - len(self.shape)]
        picked = field if self.is_whole else field[(..., *self.indices)]
        return np.ascontiguousarray(picked).reshape(*lead, self.size)

    def node_numbers(self):
        """Numbers of the nodes in the cell, array (nodes,)."""
        if len(self.shape) == 1:
            return (self.start[0] + np.arange(self.size)) % self.grid.size
        return self.take(np.arange(self.grid.size).reshape(self.grid.shape))

    def put(self, values, field):
        """Write values (..., nodes) into a field (..., *grid) at the window's nodes."""
        field[(..., *self.indices)] = values.reshape(*values.shape[:-1], *self.shape)

    def box(self, values, beyond=0.0):
        """View values (..., nodes) as (..., *box); ``beyond`` stands at nodes of a box that are
        none of the window's, if it has such (`active.Nodes`)."""
        return values.reshape(*values.shape[:-1], *self.shape)

    def occupied(self, mask, axis):
        """Where along an axis a mask (*box) holds anywhere."""
        others = tuple(other for other in range(mask.ndim) if other != axis)
        return mask.any(axis=others) if others else mask

    def ends(self, mask):
        """The first and last place of each direction in which a mask (*box) holds; the last one
        before the first where it holds nowhere."""
        return self.grid.ends([np.flatnonzero(self.occupied(mask, axis))
                               for axis in range(mask.ndim)])

    def along(self, line, axis):
        """A line of the window along an axis from what is known of it: it is all."""
        return line

    def line(self, box, axis, through):
        """Values of a box along an axis, on the line through places of the other directions.

        Parameters
        ----------
        box : array (*box)
        axis : int
        through : place in each direction; that along the axis is not asked for
        """
        return box[tuple(slice(None) if other == axis else place
                         for other, place in enumerate(through))]

    def own(self, part):
        """A part of the box, slices, as far as it is here, and the same in what is here."""
        return part, part

    def divided(self, part):
        """Of a part of the box, slices, what this process is to find: all of it."""
        return part

    def put_part(self, values, box, part):
        """Write values of a part of the box, found as `divided` says, into a box (..., *box).

        Parameters
        ----------
        values, box : arrays
        part : slices
        """
        box[(..., *part)] = values

    def placed(self, transform, part=None):
        """A transform of the nodes' circle, or of one of a part of them, of which this process has
        some rows: all.

        Parameters
        ----------
        transform : on the circle
        part : slices of the box
        """
        return transform

    def images(self, box, axis, middle, reach):
        """Values of a box (arrays, *box) that are mirror images of each other along an axis, and
        those of its first node: three arrays whose first axis that is.

        Parameters
        ----------
        box : array
        axis : int, from 1
        middle, reach : int, node of the mirror, and how far from it there are nodes on both sides
        """
        nodes = box.swapaxes(axis, 0)
        return nodes[middle:middle + 1 + reach], nodes[middle - reach:middle + 1][::-1], nodes[:1]

    def mirrored(self, values, axis):
        """Mirror image about the apex of values (arrays, nodes) on a centred window, along a
        direction."""
        image = np.flip(self.box(values), axis + 1)
        if self.closed[axis]:
            image = np.roll(image, 1, axis + 1)
        return image.reshape(values.shape)

    def cut(self, box, part):
        """A part, slices, of a box (..., *box), as a copy."""
        return box[(..., *part)].copy()

    def with_rows(self, box, reach):
        """A box (..., *box) with rows of others around what is here: nothing is missing."""
        return box

    def rim(self):
        """Mask of the nodes on the border of the box, in directions that the window does not
        fill."""
        mask = np.zeros(self.shape, dtype=bool)
        for axis, closed in enumerate(self.closed):
            if not closed:
                mask[(*[slice(None)] * axis, [0, -1])] = True
        return mask.reshape(-1)

    @cached_property
    def rim_places(self):
        """Places of these nodes in the window's flat index."""
        return np.flatnonzero(self.rim())

    def area_below(self, values, level):
        """Length or area where values (nodes), on a plane all of several (fields, nodes), lie below
        a level, its edge interpolated between nodes.

        Cubic in each direction. Beyond the window nothing is below; a window that is the whole cell
        closes on itself.
        """
        box = self.box(values)
        if len(self.shape) == 2:
            return float(area_below(self.ringed(box), level, self.grid) * self.grid.node_area)
        return self.grid.node_area * float(np.sum(np.diff(intervals(box, level, self.is_whole))))

    def at_level(self, values, level, fields):
        """Fields (components, nodes) where values (nodes) cross a level between nodes, (components,
        crossings).

        Parameters
        ----------
        values, fields : arrays (nodes,) and (components, nodes) over the window
        level : float, unit of the values
        """
        known = self.ringed(self.box(np.concatenate([values[None], fields])))
        return at_level(known[0], level, known[1:])

    def circle(self):
        """Shape of the circulant that holds a convolution of the window: padded, or the cell where
        that is smaller."""
        return tuple(total if 2 * n - 1 >= total
                     else min(total, fast_length(2 * n - 1))
                     for n, total in zip(self.shape, self.grid.shape))


def enclosing(grid, mask, margin, half=None):
    """The smallest window around the nodes where ``mask`` (over the cell) holds, cyclic, widened on
    each side.

    Wider on a side by two nodes and the part ``margin`` of its extent. A direction in which padding
    would not be shorter than the cell is taken whole. Without any node: two by two nodes at the
    cell's middle.

    Parameters
    ----------
    grid : Grid
    mask : array of bool over the cell, or over its half
    margin : float, part of the extent
    half : EvenWindow of the cell, if the mask is over that
    """
    start, shape, nodes = [], [], half or grid.whole
    for axis, total in enumerate(grid.shape):
        line = np.flatnonzero(nodes.along(nodes.occupied(mask, axis), axis))
        if line.size == 0:
            first, extent = total // 2 - 1, 2
        else:
            gaps = np.diff(np.append(line, line[0] + total))
            widest = int(np.argmax(gaps))
            first, extent = int(line[(widest + 1) % line.size]), total - int(gaps[widest]) + 1
            wider = 2 + int(margin * extent)
            first, extent = first - wider, extent + 2 * wider
        if 2 * extent - 1 >= total:
            first, extent = 0, total
        start.append(first)
        shape.append(extent)
    return grid.box(start, shape)
