"""Windows of some of the nodes of a slab (`slabs`), and values of one such window at the nodes of
another."""

import numpy as np
import scipy

from .active import Nodes

NEARBY = 32
"""Rows beyond its own among which a process looks for the nearest known node first."""


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
        everywhere = SlabNodes(self.hull, np.arange(self.hull.size))
        return nearest_known(values, self, everywhere)


def nearest_known(field, source, window):
    """Values of a field at nodes, where it is not known those of the nearest known node.

    Parameters
    ----------
    field : array (components, nodes of the source)
    source, window : SlabNodes
    """
    grid, rows = source.grid, source.grid.rows
    reach = min(NEARBY, rows.fewest)
    here = np.full((1 + len(field), *source.shape), np.nan)
    here[(slice(None), *source.indices)] = np.concatenate([np.ones((1, source.size)), field])
    wide = rows.around(here, reach, reach)
    across = np.array(window.indices)
    across[0] += reach
    found = wide[(slice(1, None), *across)]
    missing = np.flatnonzero(np.isnan(wide[(0, *across)]))
    if not grid.any(missing.size):
        return found
    has = wide[0] == 1.0
    if grid.any(missing.size and not has.any()):
        _from_everywhere(field, source, across, found, missing)
    elif missing.size:
        # columns close on themselves: half of them are there once more on either side
        half = has.shape[1] // 2
        apart = np.pad(~has, ((0, 0), (half, half)), mode="wrap")
        places = scipy.ndimage.distance_transform_edt(apart, return_distances=False,
                                                return_indices=True)
        row, column = places[:, across[0, missing], across[1, missing] + half]
        found[:, missing] = wide[1:, row, (column - half) % has.shape[1]]
    return found


def _from_everywhere(field, source, across, found, missing):
    """Fill in values of the nearest nodes where no node is known nearby: all processes tell all
    that they know.

    Parameters
    ----------
    field, source : values and SlabNodes where they are known
    across : array of int (directions, nodes), places in this process's rows with those around
    found : array (components, nodes), which gets values
    missing : array of int, at which of the nodes
    """
    grid, rows = source.grid, source.grid.rows
    places = np.concatenate(grid.comm.allgather(np.array(source.indices) + [[rows.first], [0]]),
                            axis=1)
    values = np.concatenate(grid.comm.allgather(field), axis=1)
    if missing.size:
        wanted = across[:, missing] + [[rows.first - min(NEARBY, rows.fewest)], [0]]
        tree = scipy.spatial.cKDTree(places.T, boxsize=grid.shape)
        found[:, missing] = values[:, tree.query((wanted % np.array(grid.shape)[:, None]).T)[1]]
