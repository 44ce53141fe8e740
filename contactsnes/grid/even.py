"""Fields that are even or odd about the apex: half a line, a quarter of a plane of their nodes, or
half of it where they are so in one direction only, and weights.

A node at distance d from the apex in a direction stands for those at -d and d: it counts twice, but
once on the axis (d = 0) and where the cell closes on itself (d = N/2). Odd fields vanish at these.
Sums over nodes are those of even fields: of squares and of products of two odd ones, too.
"""

import math
from functools import cached_property, reduce

import numpy as np

from .cell import Grid
from .clusters import reaching
from .contours import area_below
from .mirrors import unlike, without_mirror
from .windows import Window


class EvenGrid(Grid):
    """A grid whose reductions run over half of the nodes of even fields (a quarter in the plane
    where they are even in both directions), each with its weight."""

    def __init__(self, grid, weights):
        vars(self).update(vars(grid))
        self.weights = weights

    def sum_here(self, values):
        """What this process has of a sum over all nodes that the given ones stand for (last
        axis)."""
        return values @ self.weights

    def count(self, mask):
        """Number of nodes that those stand for where ``mask`` holds."""
        return int(self.together(np.sum(self.weights, where=mask)))


def _flat(axes, shape):
    """Flat indices into a box of a shape of the nodes at given places along each direction."""
    return np.ravel_multi_index(np.ix_(*axes), shape).reshape(-1)


def line_weights(count, closed):
    """How many nodes each node of a direction stands for, from the apex outwards."""
    line = np.full(count, 2.0)
    line[0] = 1.0
    if closed:
        line[-1] = 1.0
    return line


def negate(field, axis, before, vanishing):
    """Turn an even field into an odd one along an axis, in place: it changes its sign before the
    apex, and vanishes there and where the cell closes on itself.

    Parameters
    ----------
    field : array
    axis : int
    before : what picks the nodes along it that come before the apex
    vanishing : list of what picks those where it vanishes
    """
    nodes = field.swapaxes(axis, 0)
    nodes[before] *= -1.0
    for places in vanishing:
        nodes[places] = 0.0


def halved(window, parities=None):
    """The `EvenWindow` of a centred window, of whatever class its grid has it.

    Parameters
    ----------
    window, parities : as of `EvenWindow`
    """
    return (window.grid.even_window or EvenWindow)(window, parities)


class EvenWindow:
    """The nodes of a centred window from the apex outwards, in each direction that has a mirror.

    Attributes
    ----------
    full : the window itself, on whose nodes states are known
    parities : for each component and direction 1 (even) or -1 (odd), or, of all components in one
        direction of the plane, 0: there nodes are those of the whole window; None: all are even
    mirrors : whether a direction has a mirror
    shape : nodes in each direction
    closed : whether the window fills a direction, where the cell closes on itself
    """

    even, picked = True, False

    def __init__(self, full, parities=None):
        self.start, lines = self._halve(full, parities)
        self.shape = self.extents
        self.size = math.prod(self.shape)
        folded = [(n // 2 * mirror + np.arange(count)) % n
                  for n, count, mirror in zip(full.shape, self.shape, self.mirrors)]
        self._folded = _flat(folded, full.shape)
        self.grid = EvenGrid(full.grid, reduce(np.multiply.outer, lines).reshape(-1))

    def _halve(self, full, parities):
        """Take what does not depend on the processes that have the nodes: where they begin in the
        cell, and for how many nodes of a direction each stands, an array of each.

        Parameters
        ----------
        full, parities : as of `EvenWindow`
        """
        shape = full.grid.shape
        self.full, self.closed, self.parities = full, full.closed, unlike(parities)
        without = without_mirror(self.parities)
        self.mirrors = tuple(axis != without for axis in range(len(shape)))
        self.extents = tuple(n // 2 + 1 if mirror else n
                             for n, mirror in zip(full.extents, self.mirrors))
        self.limits = tuple(n // 2 + 1 for n in shape)
        start = tuple(n // 2 if mirror else first
                      for n, first, mirror in zip(shape, full.origin, self.mirrors))
        return start, [line_weights(count, closed) if mirror else np.ones(count)
                       for count, closed, mirror in zip(self.extents, self.closed, self.mirrors)]

    @property
    def units(self):
        """Of what numbers of nodes parts begin at, in each direction: processes have pairs of
        rows."""
        return (1 if self.mirrors[0] else 2), 1

    @property
    def outwards(self):
        """Nodes of each direction from the axis outwards."""
        return tuple(n if mirror else n // 2 + 1 for n, mirror in zip(self.extents, self.mirrors))

    box, parts, total = Window.box, Window.parts, Window.total
    occupied, ends, own, line = Window.occupied, Window.ends, Window.own, Window.line
    divided, put_part, placed = Window.divided, Window.put_part, Window.placed

    def __eq__(self, other):
        """Whether these are the same nodes of the same window, alike in sign."""
        return self is other or (type(self) is type(other) and self.full == other.full
                                 and self.parities == other.parities)

    def __hash__(self):
        return self._number

    @cached_property
    def _number(self):
        """What it is found by, which is asked for many times a step."""
        return hash((self.full, self.parities))

    @cached_property
    def wider(self):
        """The half of the window that reaches a fifth further; this one where there is no room."""
        wide = reaching(self.full)
        return self if wide is self.full else halved(wide, self.parities)

    @cached_property
    def indices(self):
        """What picks these nodes from a field over the cell."""
        if not any(self.closed):
            return tuple(slice(first, first + n) for first, n in zip(self.start, self.shape))
        return np.ix_(*((first + np.arange(n)) % total
                        for first, n, total in zip(self.start, self.shape, self.full.grid.shape)))

    def sum(self, values):
        """Sums over all nodes of arrays (components, nodes), those of odd components being 0."""
        found = self.grid.sum(values)
        for i, signs in enumerate(self.parities or ()):
            if -1 in signs:
                found[i] = 0.0
        return found

    def wave_weights(self):
        """How many waves of the cell each cosine stands for, on a window that is the cell, array
        (*shape)."""
        return self.grid.weights.reshape(self.shape)

    def rim(self):
        """Mask of the nodes on the border of the full window, as `windows.Window.rim`."""
        mask = np.zeros(self.shape, dtype=bool)
        for axis, (closed, mirror) in enumerate(zip(self.closed, self.mirrors)):
            if not closed:
                mask[(*[slice(None)] * axis, [-1] if mirror else [0, -1])] = True
        return mask.reshape(-1)

    rim_places = Window.rim_places

    def ringed(self, box):
        """A box (rows, columns) of the plane with the mirror images around it; where there is no
        mirror, with the nodes around it, or its outermost nodes again."""
        for axis, (closed, mirror) in enumerate(zip(self.closed, self.mirrors)):
            box = np.pad(box, [(int(axis == other),) * 2 for other in range(box.ndim)],
                         "reflect" if mirror else "wrap" if closed else "edge")
        return box

    def area_below(self, values, level):
        """Area where even values (nodes) of the plane lie below a level, as
        `windows.Window.area_below`: that between these nodes, and of its mirror images."""
        return float(2 ** sum(self.mirrors) * self.grid.node_area
                     * area_below(self.ringed(self.box(values)), level, self.grid))

    def along(self, line, axis):
        """A line of the full window along an axis, from that at these nodes and the apex on."""
        if not self.mirrors[axis]:
            return line
        return np.concatenate([line[:0:-1], line[:self.full.extents[axis] - len(line) + 1]])

    def fold(self, values):
        """Values (..., nodes) of the full window at these nodes; what is odd is so for arrays
        (components, nodes) alone."""
        return self.odd(values.take(self._folded, axis=-1))

    def odd(self, values):
        """Values at these nodes, where odd components now vanish on the mirrors themselves: the
        equations there are empty, and what rounding leaves could not be solved away."""
        for field, signs in zip(self.box(values), self.parities or () if values.ndim > 1 else ()):
            for axis, odd in enumerate(signs):
                if odd < 0:
                    numbers, last = self._numbers(axis), self.extents[axis] - 1
                    negate(field, axis, slice(0),
                           [numbers == 0, numbers == last] if self.closed[axis] else [numbers == 0])
        return values

    def _numbers(self, axis):
        """Numbers of nodes from the apex outwards along an axis."""
        return np.arange(self.extents[axis])

    def unfold(self, values):
        """Values (..., nodes) of the full window from those at these nodes; what is odd is so for
        arrays (components, nodes) alone."""
        found = self.box(values)
        for axis, n in enumerate(self.full.shape, start=-len(self.shape)):
            if not self.mirrors[axis]:
                continue
            # from the apex outwards and back
            inwards = (..., slice(None, 0, -1), *[slice(None)] * (-1 - axis))
            outwards = (..., slice(0, n - n // 2), *[slice(None)] * (-1 - axis))
            found = np.concatenate([found[inwards], found[outwards]], axis)
        found = found.reshape(*values.shape[:-1], self.full.size)
        for field, signs in zip(found, self.parities or () if found.ndim > 1 else ()):
            for axis, (n, odd) in enumerate(zip(self.full.shape, signs)):
                if odd < 0:
                    negate(self.full.box(field), axis, slice(n // 2),
                           [n // 2, 0] if self.closed[axis] else [n // 2])
        return found

    def around(self, values, part):
        """Values (components, *part) in a part of the full window's box, slices by direction, from
        those (components, nodes) at these nodes."""
        places = [np.arange(cut.start, cut.stop) - n // 2 * mirror
                  for cut, n, mirror in zip(part, self.full.extents, self.mirrors)]
        found = self.box(values)[..., :1 + np.max(np.abs(places[-1]), initial=0)]
        for axis, (place, n) in enumerate(zip(places, self.full.extents)):
            found = self._along(found, place, axis)
            factor = np.sign(place)
            factor[place == -(n // 2)] *= not self.closed[axis]
            for field, signs in zip(found, self.parities or ()):
                if signs[axis] < 0:
                    field *= np.expand_dims(factor, tuple(range(1, len(part) - axis)))
        return found

    def _along(self, box, places, axis):
        """Values of a box (components, *box) along an axis at places one after the other, those
        before the apex below 0, as a copy."""
        before, across = np.count_nonzero(places < 0), (slice(None),) * (1 + axis)
        start, count = max(places[0], 0) if len(places) else 0, len(places) - before
        parts = [box[(*across, slice(start, start + count))]]
        if before:
            parts.insert(0, box[(*across, slice(-places[0], -places[0] - before, -1))])
        return np.concatenate(parts, 1 + axis)

    def of(self, component):
        """The signs of a component in each direction; None where it is even in all."""
        signs = self.parities and self.parities[component]
        return signs if signs and {-1, 0} & {*signs} else None

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at these nodes."""
        picked = field[(..., *self.indices)]
        return np.ascontiguousarray(picked).reshape(*picked.shape[:-len(self.shape)], self.size)
