"""Spots of a mask over the periodic cell: connected nodes, numbered; their sizes, and what a count
of nodes says of an area."""

import math

import numpy as np

from .fields import Fields

ALONE = Fields()
"""Of fields that are all here."""
TOO_MANY = (math.pi - 1.0 + math.log(2.0)) / 24.0
"""Part of a node's area by which a count of nodes is too large at each step from a node in contact
to one that is not."""


def labelled(mask, grid=ALONE):
    """Number of the spot, 1, 2, ... in the order of their first nodes, of each node where a mask
    (over the cell) holds, 0 elsewhere: nodes beside each other along a direction are of one spot,
    across the border of the cell, too. An array as the mask.

    Parameters
    ----------
    mask : array of bool over the cell, or as much of it as is here
    grid : Grid of the cell, where some of it may be in other processes
    """
    from scipy import ndimage  # of most runs nobody asks for spots, and they take time
    from scipy.sparse import coo_matrix, csgraph

    parts, count = ndimage.label(mask)
    parts[parts > 0] += grid.before(count)
    # lines of nodes beside each other across the cell's border, or across those of processes
    before = grid.row_before(parts)
    # (of slabs, others may have all rows)
    sides = [np.array([parts[0], before] if len(parts) else [[], []], int).reshape(2, -1),
             *(np.array([np.take(parts, 0, axis).ravel(), np.take(parts, -1, axis).ravel()])
               for axis in range(1, parts.ndim))]
    seams = np.concatenate(sides, axis=1)
    first, last = grid.joined(seams[:, (seams > 0).all(axis=0)].T).T
    if not first.size:
        return parts
    count = int(grid.together(count))
    graph = coo_matrix((np.ones(first.size), (first, last)), shape=(count + 1,) * 2)
    # those of one spot have its first part's number, in the order of nodes
    _, spot = csgraph.connected_components(graph, directed=False)
    _, place, number = np.unique(spot, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(place))[number.ravel()][parts]


def runs(nodes, count):
    """Nodes of each spot on a closed line of ``count`` nodes, an array of int, from the numbers of
    those in it: as `sizes` of `labelled` has them."""
    nodes = np.sort(nodes)
    ends = np.flatnonzero(nodes[1:] - nodes[:-1] > 1).tolist()
    if len(nodes):
        ends.append(len(nodes) - 1)
    found = [last - before for before, last in zip([-1, *ends], ends)]
    if len(found) > 1 and nodes[0] == 0 and nodes[-1] == count - 1:
        # the first and the last are one
        found[0] += found.pop()
    return np.array(found, dtype=int)


def sizes(labels, grid=ALONE):
    """Nodes of each spot, an array of int: of spot 1 first.

    Parameters
    ----------
    labels, grid : as of `labelled`, and what it returns
    """
    most = int(grid.largest(np.max(labels, initial=0)))
    return grid.together(np.bincount(labels.ravel(), minlength=most + 1)).astype(int)[1:]


def corrected_count(mask, grid=ALONE):
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
    wide = grid.with_rows(mask, 1)
    steps = sum(np.count_nonzero(grid.without_rows(wide != np.roll(wide, 1, axis), 1))
                for axis in range(mask.ndim))
    return grid.together(np.count_nonzero(mask) - TOO_MANY * steps)
