"""Outlines of where values on a window lie below a level: intervals of a line, oriented pieces of
curves on a plane; and what follows from them."""

from functools import partial
from typing import NamedTuple

import numpy as np

from .contours import around, crossings, cut_patches, intervals, mixed, pieces, refined

PARTS = 8
"""Of a square of the grid in each direction, within which its edge is straight."""


class Outline(NamedTuple):
    """Where values lie below a level.

    Attributes
    ----------
    ends : array (pieces, 2, directions), beta: on a line left and right end of each interval, on a
        plane ends of straight pieces of the edge, the inside on their left
    around : whether it goes around the cell, or across its border, in each direction
    """

    ends: np.ndarray
    around: tuple

    def extent(self, axis):
        """First and last place along a direction, beta; nan where there is none, or it goes around
        the cell."""
        if not len(self.ends) or self.around[axis]:
            return np.nan, np.nan
        return float(self.ends[..., axis].min()), float(self.ends[..., axis].max())

    def inside(self):
        """Length of the inside on a line, beta."""
        return float((self.ends[:, 1] - self.ends[:, 0]).sum())

    def length(self):
        """Length of the edge on a plane, beta."""
        return float(np.sum(np.linalg.norm(self.ends[:, 1] - self.ends[:, 0], axis=-1)))

    def centroid(self, axis):
        """Centroid of the inside along a direction, beta; nan as for `extent`. On a plane by
        Green's theorem: A x = closed integral of x^2/2 dy, to which borders along x add nothing: a
        band around the cell along y has one along x."""
        if not len(self.ends) or self.around[axis]:
            return np.nan
        first, last = self.ends[:, 0], self.ends[:, 1]
        if self.ends.shape[-1] == 1:
            return float(np.sum(last ** 2 - first ** 2) / (2.0 * np.sum(last - first)))
        middle = np.mean([first[:, axis].min(), first[:, axis].max()])
        x, run = first[:, axis] - middle, last[:, axis] - first[:, axis]
        other = 1 - axis
        rise = (last - first)[:, other] * (1.0 if axis == 0 else -1.0)
        area = np.sum((x + 0.5 * run) * rise)
        return float(middle + np.sum((x ** 2 + x * run + run ** 2 / 3.0) * rise) / (2.0 * area))


def outline(window, values, level, crossed=crossings):
    """The `Outline` of where values are below a level on a window, of one box or several; of where
    all of several fields are, each interpolated for itself (`contours.area_below`).

    Parameters
    ----------
    window : Window, Spots or Nodes
    values : array (nodes,) or (fields, nodes)
    level : float, unit of the values
    crossed : what finds crossings on a line, as `contours.crossings`
    """
    shape = window.parts[0].shape
    values = np.atleast_2d(values)
    beyond = window.grid.maximum(values) if window.picked else np.inf
    boxes = np.reshape(window.box(values, beyond), (len(values), len(window.parts), *shape))
    boxes = np.moveaxis(boxes, 1, 0)
    made = partial(_intervals, crossed) if len(shape) == 1 else _pieces
    ends = [made(part, box, level) for part, box in zip(window.parts, boxes)]
    joined = window.grid.joined(np.concatenate(ends))
    periods = np.array(window.grid.periods)
    # (boxes go on beyond the border of the cell)
    joined = joined - periods * np.floor(joined.mean(axis=1, keepdims=True) / periods + 0.5)
    return Outline(joined, tuple(
        _ends_at(joined[..., axis], 0.5 * periods[axis])
        or any(_at_border(part, np.all(box < level, axis=0), axis)
               for part, box in zip(window.parts, boxes))
        for axis in range(len(window.parts[0].shape))))


def _at_border(part, inside, axis):
    """Whether some of a mask over a box lies on the border of the cell, its first node, in a
    direction."""
    occupied, total = part.occupied(inside, axis), part.grid.shape[axis]
    return bool(occupied[(part.start[axis] + np.arange(len(occupied))) % total == 0].any())


def _ends_at(places, border):
    """Whether ends of pieces lie on the border of the cell, of squares that an edge crosses though
    none of the nodes on it is inside."""
    return bool((np.abs(np.abs(places) - border) < 1e-9 * border).any())


def _places(part, places):
    """Coordinates, beta, of places in nodes of a box, array (..., directions)."""
    first = [start - total // 2 for start, total in zip(part.start, part.grid.shape)]
    return (places + first) * part.grid.spacings


def _intervals(crossed, part, box, level):
    """Intervals of a line where all fields of a box (fields, nodes) are below a level, cubic
    between nodes.

    Parameters
    ----------
    crossed, level : as of `outline`
    part : Window
    box : array (fields, nodes)
    """
    first, *others = (intervals(field, level, part.is_whole, crossed) for field in box)
    for other in others:
        low = np.maximum(first[:, None, 0], other[:, 0])
        high = np.minimum(first[:, None, 1], other[:, 1])
        first = np.stack([low, high], axis=-1)[low < high]
    return _places(part, first[..., None])


def _pieces(part, box, level):
    """Straight pieces of the edge of where all fields of a box (fields, x, y) are below a level:
    bicubic within squares of the grid, linear within triangles of their eighths."""
    known = part.ringed(box)
    _, corners, patches = cut_patches(known, level)
    corners, cut = np.asarray(corners).T, mixed(np.all(known < level, axis=0))
    found = [piece for some in pieces(len(patches))
             for piece in _pieces_within(patches[some], corners[some], cut)]
    return _places(part, np.concatenate([np.empty((0, 2, 2)), *found]))


def _pieces_within(patches, corners, cut):
    """Those of some squares, as of `_crossed`, of the triangles of either side, and `_on_sides`.

    Parameters
    ----------
    patches : array (squares, surfaces, 4, 4), values less the level around each
    corners : array (squares, 2), the first of each
    cut : mask of squares that the level cuts, a ring around those of the box with them
    """
    values = refined(patches, PARTS).max(axis=1)
    # most parts of a square have no edge within them
    parts = np.nonzero(mixed(values < 0.0))
    first = corners[parts[0]] + np.stack(parts[1:], axis=-1) / PARTS
    a, b, c, d = ((corner[parts], first + np.array(away) / PARTS) for corner, away in zip(
        around(values), ((0, 0), (1, 0), (1, 1), (0, 1))))
    return [*(_crossed(*zip(*triangle)) for triangle in ((a, b, c), (a, c, d))),
            *_on_sides(values, corners, cut)]


def _on_sides(values, corners, cut):
    """Pieces on sides of squares, (pieces, 2, 2), where an edge crosses a side there and back, and
    the square beyond is not cut: that one is whole, as in `contours.area_below`, and the outline
    would have a hole, through which moments about far places leak.

    Parameters
    ----------
    values : array (squares, PARTS + 1, PARTS + 1) at the corners of their parts, less the level
    corners, cut : as of `_pieces_within`
    """
    up, low, high = np.arange(PARTS + 1), np.zeros(PARTS + 1, int), np.full(PARTS + 1, PARTS)
    found = []
    # counter-clockwise
    for x, y, beyond in ((up, low, (0, -1)), (high, up, (1, 0)), (up[::-1], high, (0, 1)),
                         (low, up[::-1], (-1, 0))):
        own = np.flatnonzero(~cut[tuple((corners + 1 + beyond).T)])
        places = corners[own, None] + np.stack([x, y], axis=-1) / PARTS
        along = values[own[:, None], x, y]
        sign = np.where(along[:, :1] < 0.0, -1.0, 1.0)  # of all the square beyond
        before, after = (sign * along)[:, :-1], (sign * along)[:, 1:]
        on = np.nonzero((before < 0.0) | (after < 0.0))
        before, after = before[on], after[on]
        start, run = places[:, :-1][on], np.diff(places, axis=1)[on]
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = before / (before - after)
        part = np.stack([np.where(before < 0.0, 0.0, crossing),
                         np.where(after < 0.0, 1.0, crossing)], axis=1)
        ends = start[:, None] + part[..., None] * run[:, None]
        found.append(np.where(sign[on[0], :, None] > 0.0, ends, ends[:, ::-1]))
    return found


def _crossed(values, places):
    """Where planes through three corners, counter-clockwise, vanish: (pieces, 2, 2), negative
    values on their left."""
    values = np.stack(values)
    negative = values < 0.0
    count = negative.sum(axis=0)
    cut = np.flatnonzero((count == 1) | (count == 2))
    lone = count[cut] == 1
    alone = np.argmax(negative[:, cut] == lone, axis=0)
    turned = (alone + np.arange(3)[:, None]) % 3
    values = values[turned, cut]
    places = np.stack(places)[turned, cut]
    part = values[0] / (values[0] - values[1:])
    ends = places[0] + part[..., None] * (places[1:] - places[0])
    return np.where(lone[:, None], ends, ends[::-1]).swapaxes(0, 1)
