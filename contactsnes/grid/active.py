"""Windows of any nodes: those on which the law acts, of a box whose circle their convolution takes.

On a rough surface hundreds of spots leave most of every box that holds them out of the law's range.
Fields are known at the other nodes only; for a convolution they are scattered into the box.
"""

from functools import cached_property

import numpy as np
import scipy

from .cell import Convolution
from .windows import Window

WORTH = 0.75
"""Part of a box's nodes up to which they are a window of their own: more are not worth the way into
the box and back."""


class Nodes:
    """Some nodes of a box, in its order, with the interface of `windows.Window`.

    Parameters
    ----------
    hull : Window of one box
    places : array of int, the nodes' numbers in the box, ascending

    Attributes
    ----------
    parts : the box alone
    start, shape, closed, limits : those of the box
    """

    even, is_whole, picked, mirrors = False, False, True, Window.mirrors

    def __init__(self, hull, places):
        self.grid, self.hull, self.parts = hull.grid, hull, (hull,)
        self.start, self.shape = hull.start, hull.shape
        self.origin, self.extents = hull.origin, hull.extents
        self.closed, self.limits = hull.closed, hull.limits
        self.places = np.ascontiguousarray(places, dtype=np.int32)
        self.places.flags.writeable = False
        self.size = len(self.places)
        self.total = self.size

    def __eq__(self, other):
        """Whether these are the same nodes of the same box."""
        return self is other or (type(self) is type(other) and self.hull == other.hull
                                 and np.array_equal(self.places, other.places))

    def __hash__(self):
        return hash((self.hull, self.size))

    @cached_property
    def numbers(self):
        """Numbers of the nodes in the cell, array (nodes,)."""
        nodes = np.unravel_index(self.places, self.shape)
        return np.ravel_multi_index([(first + node) % total for first, node, total
                                     in zip(self.start, nodes, self.grid.shape)], self.grid.shape)

    def node_numbers(self):
        """Numbers of the nodes in the cell, array (nodes,)."""
        return self.numbers

    @property
    def indices(self):
        """What picks the nodes from a field over the cell, in their order."""
        return np.unravel_index(self.numbers, self.grid.shape)

    @cached_property
    def on_circle(self):
        """Numbers of the nodes on the circle that holds the box, array (nodes,)."""
        return np.ravel_multi_index(np.unravel_index(self.places, self.shape),
                                    self.circle()).astype(np.int32)

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at these nodes."""
        lead = field.shape[:field.ndim - len(self.shape)]
        return field.reshape(*lead, -1).take(self.numbers, axis=-1)

    def put(self, values, field):
        """Write values (..., nodes) into a field (..., *grid) at these nodes."""
        field[(..., *self.indices)] = values

    def spread(self, values, fill=0.0):
        """Values (..., nodes of the box) from those at these nodes, elsewhere ``fill``."""
        box = np.full((*values.shape[:-1], self.hull.size), fill, dtype=values.dtype)
        box[..., self.places] = values
        return box

    def box(self, values, beyond=0.0):
        """Values (..., *box) from those at these nodes, and ``beyond`` elsewhere."""
        return self.hull.box(self.spread(values, beyond))

    def filled(self, values):
        """Values (..., nodes of the box) from those at these nodes, elsewhere that of the nearest
        one."""
        box = np.ones(self.hull.size, dtype=bool)
        box[self.places] = False
        if self.size == 0:
            return self.spread(values)
        nearest = scipy.ndimage.distance_transform_edt(self.hull.box(box), return_distances=False,
                                                 return_indices=True)
        return self.spread(values)[..., np.ravel_multi_index(nearest, self.shape).reshape(-1)]

    def rim(self):
        """Mask of the nodes with a neighbour in the cell that is none of these."""
        known = np.zeros(self.grid.local_shape, dtype=bool)
        known[self.indices] = True
        known = self.grid.with_rows(known, 1)
        inner = known.copy()
        for axis in range(known.ndim):
            inner &= np.roll(known, 1, axis) & np.roll(known, -1, axis)
        return ~self.grid.without_rows(inner, 1)[self.indices]

    rim_places = Window.rim_places

    def surround(self, mask, reach):
        """Whether all nodes of the cell up to ``reach`` nodes from some of these are among them.

        Parameters
        ----------
        mask : array of bool (nodes)
        reach : int
        """
        known, asked = np.zeros((2, *self.grid.local_shape), dtype=bool)
        known[self.indices] = True
        asked[self.indices] = mask
        return not self.grid.any(widened(self.grid, asked, reach) & ~known)

    def area_below(self, values, level):
        """Area where values (nodes) lie below a level, of the box."""
        return self.hull.area_below(self.spread(values, self.grid.maximum(values)), level)

    def at_level(self, values, level, fields):
        """Fields where values cross a level, (components, crossings), of the box.

        Parameters
        ----------
        values, fields : arrays (nodes,) and (components, nodes) over the window
        level : float, unit of the values
        """
        return self.hull.at_level(self.spread(values, self.grid.maximum(values)), level,
                                  self.spread(fields))

    def circle(self):
        """Shape of the circle that holds a convolution of the box."""
        return self.hull.circle()


def widened(grid, mask, reach):
    """A mask over the cell with all nodes up to ``reach`` nodes from it in every direction.

    Parameters
    ----------
    grid : Grid
    mask : array of bool over the cell
    reach : int
    """
    mask = grid.with_rows(mask, reach)
    for axis in range(mask.ndim):
        mask = np.logical_or.reduce([np.roll(mask, shift, axis)
                                     for shift in range(-reach, reach + 1)])
    return grid.without_rows(mask, reach)


def some(hull, places):
    """The window of some nodes of a box, by their numbers in it."""
    return (hull.of_nodes or Nodes)(hull, places)


def within(hull, mask):
    """The window of the nodes of a box, of a cell that is shared out of all of that, where a mask
    over the cell holds; the box itself if these are nearly all."""
    hull = hull.grid.whole if hull.grid.shared else hull
    places = np.flatnonzero(hull.take(mask))
    return (some(hull, places) if 0 < hull.grid.together(places.size) <= WORTH * hull.total
            else hull)


class NodesConvolution(Convolution):
    """Product of a circulant operator of the cell with fields on `Nodes`.

    Parameters
    ----------
    window : Nodes
    operator, count, make : as of `cell.Convolution`
    """

    def _lay_out(self):
        """Find the transform's circle as one row, too."""
        super()._lay_out()
        self._flat = self.transform.real.reshape(self.count, -1)

    def _put(self, values):
        """Write values to their places on the transform's circle, 0 elsewhere."""
        self.transform.real[...] = 0.0
        self._flat[:, self.window.on_circle] = values

    def _take(self, out):
        """Read the nodes from the circle."""
        if out.dtype == self._flat.dtype:
            np.take(self._flat, self.window.on_circle, axis=-1, out=out)
        else:
            out[...] = self._flat[:, self.window.on_circle]
