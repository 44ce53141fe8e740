"""Where interpolated values on a grid cross a level: places on a line, areas on a plane; and are
largest."""

import operator
from functools import lru_cache

import numpy as np

FEW = 16
"""Roots up to which one after the other is faster than all at once."""
MANY = 2 ** 12
"""Squares that are divided at a time."""


def first_largest(values):
    """Index of the first of the values of about the largest size: of equals, rounding would
    choose."""
    sizes = np.abs(values)
    return int(np.argmax(sizes >= 0.999 * np.max(sizes)))


def crossings(values, level):
    """Where a line of values crosses a level: places in nodes (cubic interpolation), and +1
    (upward) or -1 there.

    Between nodes i and i + 1 the cubic through nodes i - 1 to i + 2 is used (a line at the ends).
    """
    above = values >= level
    first = np.flatnonzero(above[1:] != above[:-1])
    places = np.empty(len(first))
    for k, i in enumerate(first):
        if not 0 < i < len(values) - 2:
            places[k] = i + (level - values[i]) / (values[i + 1] - values[i])
            continue
        # floats of Python: four times as fast as NumPy's, one by one
        places[k] = i + _place(*(values[i - 1:i + 3] - level).tolist())
    return places, np.where(above[first + 1], 1, -1)


def intervals(values, level, around, crossed=crossings):
    """Where a line of values is below a level: first and last place of each interval, in nodes,
    array (intervals, 2).

    Parameters
    ----------
    values : array (nodes,)
    level : float, unit of the values
    around : bool, whether the line closes on itself, one node beyond its last; else nothing beyond
        its nodes is below
    crossed : what finds crossings, as `crossings`
    """
    if around:
        # places between the last node and the first have neighbours, too
        values = np.concatenate([values[-1:], values, values[:2]])
        below = values < level
        first, last = int(below[0] != below[1]), int(below[-2] != below[-1])
        places = crossed(values, level)[0]
        places, values = places[first:len(places) - last] - 1.0, values[1:-1]
    else:
        places = crossed(values, level)[0]
    ends = [*([0.0] if values[0] < level else []), *places,
            *([len(values) - 1.0] if values[-1] < level else [])]
    return np.reshape(ends, (-1, 2))


def _place(before, left, right, after):
    """Place, 0 to 1, where the cubic through four values at nodes vanishes between the middle two,
    of which not both are above 0, nor both below: by Newton's method from the chord, within a
    bracket."""
    # As the chord and a rest that vanishes at both nodes, so that a node on the level keeps its
    # sign.
    rise, fall = (2 * left - right - before) / 2, (2 * right - left - after) / 2
    twist, chord = (fall - rise) / 3, right - left
    low, high, place = 0.0, 1.0, -left / chord
    for _ in range(60):
        rest, room = rise + twist + twist * place, place * (1 - place)
        value = left + place * chord + room * rest
        if value == 0.0:
            break
        if (value < 0.0) == (left < 0.0):
            low = place
        else:
            high = place
        slope = chord + (1 - 2 * place) * rest + room * twist
        nearer = place - value / slope if slope else low
        if not low < nearer < high:
            nearer = 0.5 * (low + high)
        if abs(nearer - place) < 1e-15:
            break
        place = nearer
    return place


def ringed(box, closed):
    """A box (..., *box) with what follows around the cell in closed directions, else its outermost
    nodes again."""
    for axis, around in enumerate(closed, start=box.ndim - len(closed)):
        before, after = ([-1], [0, 1]) if around else ([0], [-1])
        box = np.concatenate([box.take(before, axis), box, box.take(after, axis)], axis)
    return box


def at_level(values, level, fields):
    """Fields (components, *box) where values (*box) cross a level along the lines of nodes,
    (components, crossings).

    Cubic between two nodes that have neighbours in the box.

    Parameters
    ----------
    values, fields : arrays (*box) and (components, *box)
    level : float, unit of the values
    """
    if values.ndim == 1:
        above = values[1:-1] >= level
        first = np.flatnonzero(above[1:] != above[:-1])
        if len(first) <= FEW:
            return _beside(first, values - level, fields)
    found = []
    for axis in range(values.ndim):
        lines, along = values.swapaxes(axis, -1), fields.swapaxes(axis + 1, -1)
        above = lines[..., 1:-1] >= level
        *others, first = np.nonzero(above[..., 1:] != above[..., :-1])
        nodes = [(..., *others, first + shift) for shift in range(4)]
        weights = _at_places(_roots(*(lines[node] - level for node in nodes)))
        found.append(sum(weight * along[node] for weight, node in zip(weights, nodes)))
    return np.concatenate(found, axis=1)


def _beside(first, values, fields):
    """What `at_level` finds of a line behind a few nodes, the first of four around each place.

    Parameters
    ----------
    first : array of int
    values, fields : arrays (nodes,), less the level, and (components, nodes)
    """
    found = np.empty((len(fields), len(first)))
    for place, i in enumerate(first):
        # floats of Python, as in `crossings`
        weights = _at_places(_place(*values[i:i + 4].tolist()))
        found[:, place] = [sum(map(operator.mul, weights, line))
                           for line in fields[:, i:i + 4].tolist()]
    return found


def _at_places(place):
    """Weights of four nodes at places between the two in the middle, 0 to 1 from one to the
    other."""
    before = place + 1.0
    after = 2.0 - place
    rest = 1.0 - place
    return (-place * rest * after / 6.0, before * rest * after / 2.0, before * place * after / 2.0,
            -before * place * rest / 6.0)


def _roots(*nodes):
    """Places where the cubics through four values vanish between the middle two, of unequal
    signs."""
    if nodes[0].size <= FEW:
        return np.array([_place(*values) for values in zip(*(node.tolist() for node in nodes))])
    low, high = np.zeros_like(nodes[0]), np.ones_like(nodes[0])
    for _ in range(48):
        middle = 0.5 * (low + high)
        values = sum(weight * value for weight, value in zip(_at_places(middle), nodes))
        below = (values < 0.0) == (nodes[1] < 0.0)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def area_below(box, level, grid):
    """Area below a level of the surface through a box of nodes without its outermost ring, in
    squares of the grid, of all processes that share it out; where all of several surfaces are, each
    interpolated for itself: the highest of them has a corner where they cross.

    Squares that the level cuts are divided by bicubic interpolation, and the parts by triangles;
    what is left of these falls with the square of the division, which two divisions tell. Fourth
    order.

    Parameters
    ----------
    box : array (rows, columns), or (surfaces, rows, columns)
    level : float, unit of the values
    grid : Grid of the nodes
    """
    whole, _, patches = cut_patches(box, level)
    patches = grid.evened(patches)
    coarse = fine = 0.0
    for some in pieces(len(patches)):
        values = refined(patches[some], 8).max(axis=1)
        coarse += _triangles_below(values[:, ::2, ::2]) / 4 ** 2
        fine += _triangles_below(values) / 8 ** 2
    return grid.together(whole + (4.0 * fine - coarse) / 3.0)


def cut_patches(box, level):
    """Squares of a box of nodes without its outermost ring: how many lie below a level; of those
    that it cuts the first corners (x, y), counted within the ring, and values less the level on
    4 x 4 nodes around each, (squares, surfaces, 4, 4).

    Parameters
    ----------
    box : array (rows, columns), or (surfaces, rows, columns), all of which have to be below it
    level : float, unit of the values
    """
    surfaces = box.reshape(-1, *box.shape[-2:])
    below = np.all(surfaces[:, 1:-1, 1:-1] < level, axis=0)
    every, cut = _combined(np.logical_and, around(below)), np.nonzero(mixed(below))
    if not every.size:  # (of slabs, others may have all of the box)
        return 0, cut, np.empty((0, len(surfaces), 4, 4))
    patches = np.stack([np.lib.stride_tricks.sliding_window_view(surface, (4, 4))[cut]
                        for surface in surfaces], axis=1)
    patches -= level
    return np.count_nonzero(every), cut, patches


def pieces(count):
    """Slices of some of so many patches at a time: refined, each is a hundred numbers and more."""
    return [slice(first, first + MANY) for first in range(0, count, MANY)]


def refined(patches, parts):
    """Values at the corners of parts^2 squares within the middle one of patches (..., 4, 4),
    bicubic, array (..., parts + 1, parts + 1)."""
    values = patches.reshape(-1, 16) @ _bicubic(parts)
    return values.reshape(*patches.shape[:-2], parts + 1, parts + 1)


@lru_cache(maxsize=8)
def _bicubic(parts):
    """Weights of 4 x 4 nodes at those corners, (nodes, corners)."""
    weights = _cubic(parts)
    return np.ascontiguousarray(np.kron(weights, weights).T)


def _cubic(parts):
    """Weights of four nodes at the ends of equal parts of the middle one of the steps between
    them."""
    places, nodes = np.arange(parts + 1) / parts, np.arange(-1, 3)
    return np.array([[np.prod((place - np.delete(nodes, k)) / (node - np.delete(nodes, k)))
                      for k, node in enumerate(nodes)] for place in places])


def around(values):
    """Values at the corners of the squares between nodes (last two axes), in their order around
    them."""
    return values[..., :-1, :-1], values[..., 1:, :-1], values[..., 1:, 1:], values[..., :-1, 1:]


def mixed(below):
    """Whether a mask at nodes (last two axes) holds at some corner of the squares between them, and
    not at all."""
    corners = around(below)
    return _combined(np.logical_or, corners) & ~_combined(np.logical_and, corners)


def _combined(function, arrays):
    """A function of two arrays, of all of several."""
    first, second, *others = arrays
    found = function(first, second)
    for array in others:
        function(found, array, out=found)
    return found


def _triangles_below(values):
    """Area where values are negative, by the triangles of either diagonal, in squares between nodes
    (last two axes)."""
    below = values < 0.0
    cut, corners = mixed(below), around(values)
    a, b, c, d = (corner[cut] for corner in corners)
    triangles = ((a, b, c), (a, c, d), (b, c, d), (b, d, a))
    return (np.count_nonzero(_combined(np.logical_and, around(below)))
            + 0.25 * sum(_part_below(*triangle).sum() for triangle in triangles))


def _part_below(a, b, c):
    """Part of each triangle where the plane through values at three corners is negative."""
    least, most = np.minimum(a, b), np.maximum(a, b)
    low, high = np.minimum(least, c), np.maximum(most, c)
    middle = np.maximum(least, np.minimum(most, c))
    with np.errstate(divide="ignore", invalid="ignore"):
        one = low ** 2 / ((middle - low) * (high - low))
        two = 1.0 - high ** 2 / ((high - low) * (high - middle))
    return np.select([high < 0.0, middle < 0.0, low < 0.0], [1.0, two, one], 0.0)
