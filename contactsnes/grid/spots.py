"""Spots of a mask over the periodic cell: connected nodes, numbered; their sizes, and what a count
of nodes says of an area."""

import math

import numpy as np

TOO_MANY = (math.pi - 1.0 + math.log(2.0)) / 24.0
"""Part of a node's area by which a count of nodes is too large at each step from a node in contact
to one that is not."""


def labelled(mask):
    """Number of the spot, 1, 2, ... in the order of their first nodes, of each node where a mask
    (over the cell) holds, 0 elsewhere: nodes beside each other along a direction are of one spot,
    across the border of the cell, too. An array as the mask."""
    from scipy import ndimage  # of most runs nobody asks for spots, and they take time
    from scipy.sparse import coo_matrix, csgraph

    parts, count = ndimage.label(mask)
    first, last = (np.concatenate([np.take(parts, side, axis).ravel() for axis in
                                   range(mask.ndim)]) for side in (0, -1))
    meet = (first > 0) & (last > 0)
    if not meet.any():
        return parts
    graph = coo_matrix((np.ones(np.count_nonzero(meet)), (first[meet], last[meet])),
                              shape=(count + 1,) * 2)
    # those of one spot have its first part's number, in the order of nodes
    _, spot = csgraph.connected_components(graph, directed=False)
    _, place, number = np.unique(spot, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(place))[number.ravel()][parts]


def sizes(labels):
    """Nodes of each spot, an array of int: of spot 1 first."""
    return np.bincount(labels.ravel())[1:]


def corrected_count(mask):
    """Nodes where a mask (over a plane's cell) holds, less what hard walls have too many of at
    their edges.

    A node bears pressure as soon as the true edge has come near it, so that hard contacts on a grid
    are too large, in proportion to the length of their edges, counted in steps S from nodes in
    contact to others: by S (pi - 1 + ln 2)/24 nodes (Yastrebov, Anciaux and Molinari, Tribology
    International 114, 161, 2017).
    """
    steps = sum(np.count_nonzero(mask != np.roll(mask, 1, axis)) for axis in range(mask.ndim))
    return np.count_nonzero(mask) - TOO_MANY * steps
