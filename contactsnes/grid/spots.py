"""Spots of a mask over the periodic cell: connected nodes, numbered; their sizes, and what a count
of nodes says of an area."""

import math

import numpy as np

TOO_MANY = (math.pi - 1.0 + math.log(2.0)) / 24.0
"""Part of a node's area by which a count of nodes is too large at each step from a node in contact
to one that is not."""


def labelled(mask, grid=None):
    """Number of the spot, 1, 2, ... in the order of their first nodes, of each node where a mask
    (over the cell) holds, 0 elsewhere: nodes beside each other along a direction are of one spot,
    across the border of the cell, too. An array as the mask.

    Parameters
    ----------
    mask : array of bool over the cell, or as much of it as is here
    grid : Grid of the cell, where some of it is in other processes
    """
    from scipy import ndimage  # of most runs nobody asks for spots, and they take time
    from scipy.sparse import coo_matrix, csgraph

    parts, count = ndimage.label(mask)
    if grid is not None:
        before, count = grid.rows.counted(count)
        parts[parts > 0] += before
    first, last = (np.concatenate(side) for side in zip(*_seams(parts, grid)))
    meet = (first > 0) & (last > 0)
    first, last = first[meet], last[meet]
    if grid is not None:
        first, last = (np.concatenate(grid.comm.allgather(side)) for side in (first, last))
    if not first.size:
        return parts
    graph = coo_matrix((np.ones(first.size), (first, last)), shape=(count + 1,) * 2)
    # those of one spot have its first part's number, in the order of nodes
    _, spot = csgraph.connected_components(graph, directed=False)
    _, place, number = np.unique(spot, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(place))[number.ravel()][parts]


def _seams(parts, grid):
    """Pairs of lines of nodes that are beside each other across the cell's border, or across those
    of processes."""
    pairs = [(np.take(parts, 0, axis).ravel(), np.take(parts, -1, axis).ravel())
             for axis in range(parts.ndim)]
    if grid is not None:
        pairs[0] = parts[0], grid.rows.at(parts, [(grid.rows.first - 1) % grid.shape[0]])[0]
    return pairs


def sizes(labels, grid=None):
    """Nodes of each spot, an array of int: of spot 1 first.

    Parameters
    ----------
    labels, grid : as of `labelled`, and what it returns
    """
    if grid is None:
        return np.bincount(labels.ravel())[1:]
    most = int(grid.maximum(labels, initial=0))
    return grid.together(np.bincount(labels.ravel(), minlength=most + 1)).astype(int)[1:]


def corrected_count(mask, grid=None):
    """Nodes where a mask (over a plane's cell) holds, less what hard walls have too many of at
    their edges.

    A node bears pressure as soon as the true edge has come near it, so that hard contacts on a grid
    are too large, in proportion to the length of their edges, counted in steps S from nodes in
    contact to others: by S (pi - 1 + ln 2)/24 nodes (Yastrebov, Anciaux and Molinari, Tribology
    International 114, 161, 2017).

    Parameters
    ----------
    mask, grid : as of `labelled`
    """
    wide = mask if grid is None else grid.with_rows(mask, 1)
    changes = [wide != np.roll(wide, 1, axis) for axis in range(mask.ndim)]
    if grid is None:
        return np.count_nonzero(mask) - TOO_MANY * sum(map(np.count_nonzero, changes))
    steps = sum(grid.count(grid.without_rows(change, 1)) for change in changes)
    return grid.count(mask) - TOO_MANY * steps
