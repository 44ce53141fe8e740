"""States of a contact on windows: starting, resampling, extrapolating, following the contact edge.

A state is a displacement on a window with its means over the cell, in ranges of the law. Nothing here solves.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.optimize import brentq

from .contact import APPROACH, CERTAIN, FORCE
from .fourier import Convolution, Window
from .grids import extent
from .levels import crossings
from .laws import CUTOFF


NEAR = 15.0
"""Normal gap, in ranges, below which a predictor follows the edge of contact: beyond, the law is below 1e-5 of its peak."""

SUPPORT = 12
"""Nodes beyond a place on which the coefficients of a cubic spline there depend (by more than 1e-7)."""


@dataclass(frozen=True)
class State:
    """Displacements on a window, array (components, nodes), and their means over the cell (components)."""

    window: object
    displacement: np.ndarray
    means: np.ndarray


def undeformed(contact, controls, load):
    """The start without overlap: u_n = max(-g_0, -c), with c from what is controlled of the normal component.

    Approach: the mean is as prescribed. Displacement: that of the top, with what the body as a whole gives way. Force: the flat
    carries it, or c is the smallest gap if it pulls. Tangential displacements are zero.
    """
    gap, grid, components = contact.initial_gap, contact.grid, len(controls)
    lowest, highest = grid.minimum(gap), grid.maximum(gap)
    compliance = 0.0 if controls[0] == APPROACH else contact.rigid_compliance(1)[0]
    control, target = controls[0], -contact.far_displacement(components, load)[0]

    def approach(depth):
        return grid.sum(np.minimum(gap, depth).reshape(-1)) / grid.size

    def excess(depth):
        if control == FORCE:
            return _carried(contact, depth) * contact.ranges[0] * grid.node_area - load[0]
        sunk = compliance / grid.size * _carried(contact, depth) if compliance else 0.0
        return approach(depth) + sunk - target

    if (load[0] <= 0.0 and control == FORCE) or (control != FORCE and target <= lowest):
        depth = lowest if control == FORCE else target
    else:
        # What the flat carries first rises with the depth and falls again towards full contact: the first root counts.
        tried = [lowest, *np.quantile(gap, (0.01, 0.03, 0.1, 0.2, 0.4, 0.7)), highest]
        above = next((k for k, depth in enumerate(tried) if k and excess(depth) > 0.0), None)
        # Each trial of what the flat carries is a transform of the cell; a start need not be exact in that.
        precision = 1e-12 if control != FORCE and not compliance else 1e-3
        depth = highest if above is None else brentq(excess, tried[above - 1], tried[above], rtol=precision)
    displacement = np.zeros((components, grid.size))
    displacement[0] = np.maximum(-gap, -depth).reshape(-1)
    return State(grid.whole, displacement, grid.mean(displacement))


def apart(contact):
    """The undeformed body, far outside the law's range; the normal component."""
    displacement = np.full((1, contact.grid.size), 2.0 * CUTOFF - contact.grid.minimum(contact.initial_gap))
    return State(contact.grid.whole, displacement, displacement[:, 0].copy())


def _carried(contact, depth):
    """Sum over the flat's nodes of the traction that bends the body to u_n = max(-g_0, -depth), ranges of the law."""
    displacement = np.maximum(-contact.initial_gap, -depth).reshape(1, -1)
    traction = Convolution(contact.grid.whole, contact.periodic.operator(1, "stiffness"), 1).apply(displacement, displacement)
    return contact.grid.sum(traction[0, contact.initial_gap.reshape(-1) < depth])


def lowered(contact, state):
    """The state of a body off the flat moved down as a whole until its lowest node is one range of the law away."""
    cell = contact.extended(state)
    cell[0] -= contact.grid.minimum(cell[0] + contact.initial_gap) - 1.0
    flat = cell.reshape(len(cell), -1)
    return State(contact.grid.whole, flat, contact.grid.mean(flat))


def normal_gap(contact, state):
    """Normal gap on the state's window (nodes), delta_n."""
    return state.displacement[0] + state.window.take(contact.initial_gap)


def onto(state, window):
    """The state on another window; where it was not known, its nearest known displacement."""
    if window == state.window:
        return state.displacement
    source = state.window
    axes = []
    for start, extent, first, known, total in zip(window.start, window.shape, source.start, source.shape, window.grid.shape):
        # Signed distance from the middle of what is known, so that nodes on either side find their own end of it.
        offset = (start - first - known // 2 + total // 2) % total - total // 2 + known // 2
        inside = 0 <= offset and offset + extent <= known
        axes.append(slice(offset, offset + extent) if inside else
                    np.clip((offset + np.arange(extent) - known // 2 + total // 2) % total - total // 2 + known // 2, 0, known - 1))
    picked = source.box(state.displacement)
    for axis, places in enumerate(axes, start=1):
        picked = picked[(slice(None),) * axis + (places,)]
    return np.ascontiguousarray(picked).reshape(len(picked), -1)


def fitted(contact, state, afresh=False):
    """The state on the window that the law needs for it: the same state where its window will do, unless ``afresh``."""
    window = state.window
    gap = normal_gap(contact, state)
    rim = window.rim()
    closest = contact.grid.minimum(gap, where=rim)
    if not afresh and not window.is_whole and 0.9 * CUTOFF <= closest < 4.0 * CUTOFF:
        return state
    cell = contact.extended(state)
    fresh = contact.window(cell[0] + contact.initial_gap)
    if fresh == window:
        return state
    return State(fresh, fresh.take(cell), state.means)


def wider(state, window):
    """The state on a window that reaches a fifth further than ``window`` on either side."""
    extra = [max(2, extent // 5) for extent in window.shape]
    if any(extent + 2 * more >= total for extent, more, total in zip(window.shape, extra, window.grid.shape)):
        return State(window, onto(state, window), state.means)
    wide = Window(window.grid, [start - more for start, more in zip(window.start, extra)],
                  [extent + 2 * more for extent, more in zip(window.shape, extra)])
    return State(wide, onto(state, wide), state.means)


def covers(contact, state):
    """Whether every node outside the state's window is certainly out of the law's range."""
    if state.window.is_whole:
        return True
    gap = normal_gap(contact, state)
    if contact.grid.minimum(gap, where=state.window.rim()) < CERTAIN:
        return False
    if contact.convex:
        return True
    outside = contact.extended(state)[0] + contact.initial_gap
    outside[state.window.indices] = np.inf
    return contact.grid.minimum(outside) >= CERTAIN


def with_components(state, components):
    """The state with tangential displacements added (as zeros) or left out."""
    present = len(state.displacement)
    if present == components:
        return state
    displacement, means = np.zeros((components, state.window.size)), np.zeros(components)
    kept = min(present, components)
    displacement[:kept], means[:kept] = state.displacement[:kept], state.means[:kept]
    return State(state.window, displacement, means)


def combined(contact, states, weights):
    """Weighted sum of states at fixed places, on the window of the last, without overlap much deeper than its."""
    window = states[-1].window
    displacement = sum(weight * onto(state, window) for state, weight in zip(states, weights))
    floor = contact.grid.minimum(normal_gap(contact, states[-1])) - 1.0
    np.maximum(displacement[0], floor - window.take(contact.initial_gap), out=displacement[0])
    return State(window, displacement, sum(weight * state.means for state, weight in zip(states, weights)))


def distance(contact, first, second):
    """Root mean square distance of two states over the second's window, ranges of the law."""
    change = onto(first, second.window) - second.displacement
    return float(np.sqrt(contact.grid.inner(change, change) / change.size))


def missed(contact, guess, found, largest=False):
    """Distance of a guess from what was found, over the nodes where the law acts on either (gap below 10).

    Root mean square, or the largest: the one that a spot makes which is small beside the rest.
    """
    change, near = _way(contact, guess, found, max(guess.window, found.window, key=lambda window: window.size))
    np.multiply(change, near, out=change)
    if largest:
        return float(contact.grid.maximum(np.abs(change), initial=0.0))
    return float(np.sqrt(contact.grid.inner(change, change) / max(len(change) * contact.grid.count(near), 1)))


def _way(contact, first, last, window):
    """Displacements from one state to another on a window, and the nodes where the law acts on either (gap below 10)."""
    begin, end = onto(first, window), onto(last, window)
    return end - begin, np.minimum(begin[0], end[0]) + window.take(contact.initial_gap) < 10.0


def chord(contact, first, last, window):
    """The way from one state to another as a measure of others: row (components, nodes) and length.

    The product of the row with displacements from ``first`` is how far they lead along the way, root mean square over the nodes
    where the law acts on either end (over all, where it acts on none): a number that depends on neither grid nor window.
    """
    change, near = _way(contact, first, last, window)
    if near.any():
        np.multiply(change, near, out=change)
    count = len(change) * (contact.grid.count(near) or window.size)
    length = float(np.sqrt(contact.grid.inner(change, change) / count))
    return change / max(count * length, 1e-300), length


def progress(contact, origin, ahead, state):
    """Part of the way from ``origin`` to ``ahead`` that a state has gone: its projection, on the window of ``ahead``."""
    start = onto(origin, ahead.window)
    way, gone = ahead.displacement - start, onto(state, ahead.window) - start
    return contact.grid.inner(gone, way) / max(contact.grid.inner(way, way), 1e-300)


def edges(contact, state):
    """First and last place, in nodes of the window, of the one spot of contact along each direction, an array (directions, 2).

    In two dimensions on the lines through its middle. None where there is no such spot: none, several, one across the border.
    """
    box, level, ends = state.window.box(normal_gap(contact, state)), contact.scene.contact_threshold, []
    touching = box < level
    lines = [extent(touching, axis) for axis in range(box.ndim)]
    if not touching.any() or any(line.start == 0 for line in lines):
        return None
    for axis, line in enumerate(lines):
        through = tuple(slice(None) if i == axis else (other.start + other.stop) // 2 for i, other in enumerate(lines))
        places, _ = crossings(box[through], level)
        # The extent of all that touches is that on the line, give or take the roundness of a spot.
        if len(places) != 2 or places[0] > line.start + 2 or places[1] < line.stop - 3:
            return None
        ends.append(places)
    return np.array(ends)


def follow_edge(contact, states, weights, half=False):
    """Extrapolate gaps in coordinates stretched so that the ends of the contact spot stay in place; None without such a spot.

    With ``half``, only from the middle of the last window onwards in each direction, elsewhere at fixed places.

    The edge moves by a good part of its cohesive length in a step, so that gaps at fixed places change abruptly where gaps
    at a fixed distance from the edge hardly do. Where the law hardly acts, displacements are extrapolated at fixed places.
    """
    ends = [edges(contact, state) for state in states]
    if any(end is None for end in ends):
        return None
    window = states[-1].window
    # Places of all states in nodes from the first one of the last window; a wider window begins before it.
    places = [end + _nodes_between(window, state.window)[:, None] for end, state in zip(ends, states)]
    target = np.tensordot(weights, places, axes=1)
    if np.any(target[:, 1] - target[:, 0] < 4.0):
        return None
    near = window.box(normal_gap(contact, states[-1])) < NEAR
    part = tuple(extent(near, axis, margin=2) for axis in range(near.ndim))
    if half:
        part = tuple(slice(count // 2, line.stop) for line, count in zip(part, near.shape))
    states = [wider(state, window) for state in states]
    far = sum(weight * onto(state, window) for state, weight in zip(states, weights))
    far[0] += window.take(contact.initial_gap)
    window.box(far)[(slice(None), *part)] = sum(weight * _stretched(contact, state, window, place, target, part)
                                                for state, weight, place in zip(states, weights, places))
    # An extrapolation into deep overlap would meet the exponential.
    np.maximum(far[0], contact.grid.minimum(normal_gap(contact, states[-1])) - 1.0, out=far[0])
    far[0] -= window.take(contact.initial_gap)
    return State(window, far, sum(weight * state.means for state, weight in zip(states, weights)))


def carried(contact, change, origin, state):
    """A small change of one state as one of another: moved with the edge of contact where it is one spot, to the other's window."""
    fixed = State(state.window, onto(change, state.window), change.means)
    ends = [edges(contact, origin), edges(contact, state)]
    if any(end is None for end in ends):
        return fixed
    window = state.window
    near = window.box(normal_gap(contact, state)) < NEAR
    part = tuple(extent(near, axis, margin=2) for axis in range(near.ndim))
    places = ends[0] + _nodes_between(window, origin.window)[:, None]
    change = State(change.window, change.displacement.copy(), change.means)
    change.displacement[0] -= change.window.take(contact.initial_gap)
    window.box(fixed.displacement)[(slice(None), *part)] = _stretched(contact, wider(change, window), window, places, ends[1], part)
    return fixed


def _stretched(contact, state, window, ends, target, part):
    """Normal gap and tangential displacements (components, *part) of a state where its ends have been moved to ``target``.

    ``ends`` and ``target`` are counted from the first node of ``window``, of whose box ``part`` is a part.
    """
    known, sources = [], []
    for (first, last), (left, right), wanted, begin, count in \
            zip(ends, target, part, _nodes_between(window, state.window), state.window.shape):
        source = first + (np.arange(wanted.start, wanted.stop) - left) * (last - first) / (right - left) - begin
        low, high = (min(max(place, 0), count) for place in (int(source[0]) - SUPPORT, int(source[-1]) + SUPPORT + 2))
        known.append(slice(min(low, count - 2), high))
        sources.append(source - known[-1].start)
    field = state.window.box(state.displacement)[(slice(None), *known)].copy()
    field[0] += state.window.box(state.window.take(contact.initial_gap))[tuple(known)]
    for axis, places in enumerate(sources, start=1):
        field = spline(field, places, axis)
    return field


def spline(values, places, axis):
    """Cubic spline through values at nodes along an axis, at places (in nodes, cut to theirs): an array with these along the axis."""
    count = values.shape[axis]
    coefficients = ndimage.spline_filter1d(values, axis=axis, mode="mirror")
    places = np.minimum(np.maximum(places, 0.0), count - 1.0)
    first = np.minimum(places.astype(int), count - 2)
    t = places - first
    along = [1] * values.ndim
    along[axis] = len(places)
    total = 0.0
    for shift, weight in zip(range(-1, 3), ((1 - t) ** 3, 4 + t ** 2 * (3 * t - 6), 1 + 3 * t * (1 + t - t ** 2), t ** 3)):
        # Mirrored beyond the ends, as the coefficients are.
        node = np.abs(first + shift)
        node = np.where(node > count - 1, 2 * (count - 1) - node, node)
        total = total + (weight / 6.0).reshape(along) * coefficients.take(node, axis=axis)
    return total


def _nodes_between(window, other):
    """Nodes from the first one of a window to that of another near it in each direction, over the cell's border or not."""
    total = np.array(window.grid.shape)
    return (np.array(other.start) - np.array(window.start) + total // 2) % total - total // 2
