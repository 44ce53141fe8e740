"""Where interpolated values on a grid cross a level: places on a line, areas on a plane."""

import numpy as np
from scipy.optimize import brentq


def crossings(values, level):
    """Where a line of values crosses a level: places in nodes (cubic interpolation), and +1 (upward) or -1 there.

    Between nodes i and i + 1 the cubic through nodes i - 1 to i + 2 is used (a line at the ends).
    """
    above = values >= level
    first = np.flatnonzero(above[1:] != above[:-1])
    places = np.empty(len(first))
    for k, i in enumerate(first):
        if not 0 < i < len(values) - 2:
            places[k] = i + (level - values[i]) / (values[i + 1] - values[i])
            continue
        before, left, right, after = values[i - 1:i + 3] - level
        # As the chord and a rest that vanishes at both nodes, so that a node on the level keeps its sign.
        rise, fall = (2 * left - right - before) / 2, (2 * right - left - after) / 2
        twist = (fall - rise) / 3
        places[k] = i + brentq(lambda t: (1 - t) * left + t * right + t * (1 - t) * (rise + twist + twist * t), 0.0, 1.0,
                               xtol=1e-14)
    return places, np.where(above[first + 1], 1, -1)


def area_below(box, level):
    """Area below a level of the surface through a box of nodes without its outermost ring, in squares of the grid.

    Squares that the level cuts are divided by bicubic interpolation, and the parts by triangles; what is left of these falls with
    the square of the division, which two divisions tell. Fourth order.
    """
    corners = _corners(box[1:-1, 1:-1])
    lowest, highest = np.minimum.reduce(corners), np.maximum.reduce(corners)
    cut = np.nonzero((lowest < level) & (highest >= level))
    patches = np.lib.stride_tricks.sliding_window_view(box, (4, 4))[cut] - level
    coarse, fine = (_triangles_below(weights @ patches @ weights.T) / (len(weights) - 1) ** 2 for weights in map(_cubic, (4, 8)))
    return np.count_nonzero(highest < level) + (4.0 * fine - coarse) / 3.0


def _cubic(parts):
    """Weights of four nodes at the ends of equal parts of the middle one of the steps between them."""
    places, nodes = np.arange(parts + 1) / parts, np.arange(-1, 3)
    return np.array([[np.prod((place - np.delete(nodes, k)) / (node - np.delete(nodes, k))) for k, node in enumerate(nodes)]
                     for place in places])


def _corners(values):
    """Values at the corners of the squares between nodes (last two axes), in their order around them."""
    return values[..., :-1, :-1], values[..., 1:, :-1], values[..., 1:, 1:], values[..., :-1, 1:]


def _triangles_below(values):
    """Area where values are negative, by the triangles of either diagonal, in squares between nodes (last two axes)."""
    corners = _corners(values)
    lowest, highest = np.minimum.reduce(corners), np.maximum.reduce(corners)
    a, b, c, d = (corner[(lowest < 0.0) & (highest >= 0.0)] for corner in corners)
    triangles = ((a, b, c), (a, c, d), (b, c, d), (b, d, a))
    return np.count_nonzero(highest < 0.0) + 0.25 * sum(_part_below(triangle).sum() for triangle in triangles)


def _part_below(corners):
    """Part of each triangle where the plane through three corner values is negative."""
    low, middle, high = np.sort(np.stack(corners), axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one = low ** 2 / ((middle - low) * (high - low))
        two = 1.0 - high ** 2 / ((high - low) * (high - middle))
    return np.select([high < 0.0, middle < 0.0, low < 0.0], [1.0, two, one], 0.0)
