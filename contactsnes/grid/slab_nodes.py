"""Windows of some of the nodes of a slab (`slabs`), and values of one such window at the nodes of
another."""

import weakref
from functools import cached_property

import numpy as np
import scipy

from .active import Nodes

NEARBY = 32
"""Rows beyond its own among which a process looks for the nearest known node first."""
FEW = 3
"""Windows for which it is kept where their values come from: steps go back and forth between
few."""


class SlabNodes(Nodes):
    """Some of this process's rows' nodes, as `active.Nodes` of the cell.

    Parameters
    ----------
    hull : slab.Slab
    places : array of int, the nodes' numbers among this process's, ascending

    Attributes
    ----------
    total : nodes in all processes
    """

    def __init__(self, hull, places):
        super().__init__(hull, places)
        self.total = int(hull.grid.together(self.size))
        self._ways = []

    def __eq__(self, other):
        """Whether these are the same nodes, in all processes."""
        if self is other or type(self) is not type(other):
            return self is other
        return not self.grid.any(not np.array_equal(self.places, other.places))

    def __hash__(self):
        return hash((self.hull, self.total))

    @property
    def numbers(self):
        """Numbers of the nodes in what is here of fields over the cell, array (nodes,)."""
        return self.places

    def node_numbers(self):
        """Numbers of the nodes in the cell, array (nodes,)."""
        return self.places.astype(np.int64) + self.start[0] * self.grid.shape[1]

    @property
    def indices(self):
        """What picks the nodes from what is here of a field over the cell, in their order."""
        return np.unravel_index(self.places, self.shape)

    @property
    def on_circle(self):
        """Numbers of the nodes in a transform's rows."""
        return self.places

    def filled(self, values):
        """Values (..., nodes of the box) from those at these nodes, elsewhere that of the nearest
        one."""
        return self._to_all.given(values, self)

    @cached_property
    def _to_all(self):
        """The way to all nodes."""
        return _Way(self, SlabNodes(self.hull, np.arange(self.hull.size)))

    def nearest(self, field, window):
        """Values of a field at nodes, where it is not known those of the nearest known node.

        Parameters
        ----------
        field : array (components, nodes)
        window : SlabNodes, where they are asked for
        """
        return self._way_to(window).given(field, self)

    def _way_to(self, window):
        """The way to another window, which is found once for few of these."""
        for other, way in self._ways:
            if other() is window:
                return way
        way = _Way(self, window)
        self._ways = [(weakref.ref(window), way), *self._ways[:FEW - 1]]
        return way


class _Way:
    """Where nodes find their values: at the same nodes of a source, or at the nearest ones.

    Parameters
    ----------
    source, window : SlabNodes
    """

    def __init__(self, source, window):
        rows = source.grid.rows
        self._reach = min(NEARBY, rows.fewest)
        here, columns = np.zeros(source.shape, dtype=bool), source.shape[1]
        here.reshape(-1)[source.places] = True
        missing, self._far = np.flatnonzero(~here.reshape(-1).take(window.places)), None
        if not source.grid.any(missing.size):
            self._reach = 0
        # numbers of nodes among this process's rows with those around
        self._numbers = numbers = window.places + np.intp(self._reach * columns)
        if self._reach:
            wide, asked = rows.around(here, self._reach, self._reach), numbers[missing]
            if source.grid.any(missing.size and not wide.any()):
                row, column = np.divmod(asked, columns)
                self._far = missing, np.array([row + rows.first - self._reach, column])
            elif missing.size:
                numbers[missing] = _nearest_numbers(wide, asked)

    def given(self, field, source):
        """Values of a field (components, nodes of the source) at the window's nodes.

        Parameters
        ----------
        field : array
        source : the SlabNodes
        """
        here = np.zeros((len(field), *source.shape))
        here.reshape(len(field), -1)[:, source.places] = field
        if self._reach:
            here = source.grid.rows.around(here, self._reach, self._reach)
        found = here.reshape(len(field), -1).take(self._numbers, axis=-1)
        if self._far:
            _from_everywhere(field, source, found, *self._far)
        return found


def _nearest_numbers(known, asked):
    """Numbers of the nearest known nodes of some, among columns that close on themselves.

    Parameters
    ----------
    known : mask (rows, columns), somewhere True
    asked : array of int (nodes,), their numbers
    """
    columns = known.shape[1]
    place = np.divmod(asked, columns)
    for aside in (columns // 4, columns // 2):  # of the second half: one is that near
        apart = np.pad(~known, ((0, 0), (aside, aside)), mode="wrap")
        nearest = scipy.ndimage.distance_transform_edt(apart, return_distances=False,
                                                       return_indices=True)
        at = place[0] * apart.shape[1] + place[1] + aside
        row, column = (each.reshape(-1).take(at) for each in nearest)
        away = (row - place[0]) ** 2 + (column - aside - place[1]) ** 2
        if aside == columns // 2 or away.max() <= aside ** 2:
            wrapped = np.arange(-aside, columns + aside) % columns
            return row * columns + wrapped.take(column)


def _from_everywhere(field, source, found, missing, wanted):
    """Fill in values of the nearest nodes where no node is known nearby: all processes tell all
    that they know.

    Parameters
    ----------
    field, source : values and SlabNodes where they are known
    found : array (components, nodes), which gets values
    missing : array of int, at which of the nodes
    wanted : array of int (2, missing), their rows and columns in the cell
    """
    grid = source.grid
    places = np.concatenate(grid.comm.allgather(np.array(source.indices) + [[grid.rows.first],
                                                                            [0]]), axis=1)
    values = np.concatenate(grid.comm.allgather(field), axis=1)
    if missing.size:
        tree = scipy.spatial.cKDTree(places.T, boxsize=grid.shape)
        found[:, missing] = values[:, tree.query((wanted % np.array(grid.shape)[:, None]).T)[1]]
