"""Which boxes hold the nodes where the law acts: clusters of them, joined where that is cheaper, or
all in one window."""

import math

import numpy as np
import scipy

from .boxes import Spots
from .windows import enclosing

MOST = 24
"""Clusters of nodes, at most, of which boxes are thought of: finer ones are joined at first."""

MULTIPLICATION = 5.0
POINTWISE = 40.0
CALL = 1e4
"""Cost of a complex multiplication for each point of a circle, of work besides convolutions for
each node of a window, and of handling a box; a transform of m points costs m ln m (measured)."""

WORTH, OF_NODES = 0.8, 0.6
"""Part of the cost of the one window below which boxes are worth the check that nothing else comes
within the law's range, and of those of its nodes alone where the law acts, whose products and
preconditioner are in single precision (measured)."""


def reaching(window):
    """The window a fifth further on either side of its boxes; itself where there is no room for
    that."""
    shape, extra = window.grid.shape, [max(2, extent // 5) for extent in window.extents]
    wide = [extent + 2 * more for extent, more in zip(window.extents, extra)]
    if any(extent >= total for extent, total in zip(wide, shape)):
        return window
    if len(window.parts) == 1:
        return window.grid.box([start - more for start, more in zip(window.origin, extra)], wide)
    first = (np.array(window.start) - extra) % shape
    return window if np.triu(_overlap(first, np.broadcast_to(wide, first.shape), shape),
                             1).any() else Spots(window.grid, first, wide)


def cost(window, nodes=None):
    """Predicted time of a product with the Jacobian, for each component, where a transform of m
    points takes m ln m.

    Parameters
    ----------
    window : Window or Spots
    nodes : int, how many of its nodes are unknowns, if not all
    """
    boxes, points = len(window.parts), math.prod(window.circle())
    handling = CALL * boxes if boxes > 1 else 0.0
    return (2.0 * boxes * points * math.log(points) + MULTIPLICATION * boxes ** 2 * points
            + POINTWISE * (window.size if nodes is None else nodes) + handling)


def fitting(grid, mask, margin, picked=False):
    """The cheapest window around the nodes where ``mask`` (over the cell) holds: one box as
    `windows.enclosing`, or several.

    Boxes are made around connected nodes and joined, the pair with the smallest common box first,
    until one is left; of all these windows the one whose products with the Jacobian are predicted
    to be cheapest is taken, by `cost`.

    Parameters
    ----------
    grid : Grid
    mask : array of bool over the cell
    margin : float, part of a box's extent by which it is widened on each side
    picked : bool, whether of one box these nodes alone are unknowns (`active.Nodes`)
    """
    one, nodes = enclosing(grid, mask, margin), np.count_nonzero(mask)
    if nodes > 0.5 * one.size:
        return one
    boxes = _clusters(mask)
    best, least = one, OF_NODES * cost(one, nodes) if picked else WORTH * cost(one)
    while len(boxes[0]) > 1:
        first, extent = _widened(*boxes, margin, grid.shape)
        touching = np.triu(_overlap(first, extent, grid.shape), 1)
        if not touching.any():
            window = Spots(grid, first, extent[0])
            if cost(window) < least:
                best, least = window, cost(window)
        boxes = _joined(*boxes, touching, grid.shape)
    return best


def _clusters(mask):
    """First nodes and extents, arrays (boxes, directions), of the boxes around connected nodes of a
    mask."""
    stride, blocks = 1, mask
    labels, count = scipy.ndimage.label(blocks, np.ones((3,) * mask.ndim))
    while count > MOST:
        for axis, points in enumerate(blocks.shape):
            blocks = np.logical_or.reduceat(blocks, np.arange(0, points, 2), axis=axis)
        stride *= 2
        labels, count = scipy.ndimage.label(blocks, np.ones((3,) * mask.ndim))
    boxes = [[(stride * line.start, min(stride * line.stop, total)) for line, total in zip(
        box, mask.shape)] for box in scipy.ndimage.find_objects(labels)]
    first, after = np.moveaxis(np.array(boxes).reshape(-1, mask.ndim, 2), -1, 0)
    return first, after - first


def _widened(first, extent, margin, shape):
    """Boxes widened to one extent, the largest and on each side two nodes and a part of it; all of
    a direction if not half as long."""
    largest = np.max(extent, axis=0)
    wide = largest + 2 * (2 + (margin * largest).astype(int))
    wide = np.where(2 * wide - 1 >= shape, shape, wide)
    first = (first - (wide - extent) // 2) % shape
    return np.where(wide == shape, 0, first), np.broadcast_to(wide, extent.shape)


def _overlap(first, extent, shape):
    """Whether pairs of boxes, cyclic, have nodes in common, array (boxes, boxes)."""
    ahead = (first[None] - first[:, None]) % shape
    return np.all((ahead < extent[:, None]) | (np.swapaxes(ahead, 0, 1) < extent[None]), axis=-1)


def _joined(first, extent, touching, shape):
    """The boxes with one less: of the pairs that touch, or of all, that with the smallest common
    box is one from now on."""
    ahead = (first[None] - first[:, None]) % shape
    forth = np.maximum(extent[:, None], ahead + extent[None])
    back = np.swapaxes(forth, 0, 1)
    common = np.minimum(np.minimum(forth, back), shape)
    allowed = touching if touching.any() else np.triu(np.ones_like(touching), 1)
    i, j = np.unravel_index(np.argmin(np.where(allowed, np.prod(common, axis=-1), np.inf)),
                            allowed.shape)
    first, extent = first.copy(), extent.copy()
    first[i] = np.where(forth[i, j] <= back[i, j], first[i], first[j])
    extent[i] = common[i, j]
    return np.delete(first, j, axis=0), np.delete(extent, j, axis=0)
