"""States of a contact on windows: starting, resampling, extrapolating, following the contact edge.

A state is a displacement on a window with its means over the cell, in ranges of the law. Nothing here solves.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.optimize import brentq

from .contact import APPROACH, CERTAIN, FORCE
from .fourier import Convolution, Window
from .levels import crossings
from .laws import CUTOFF


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
        depth = highest if above is None else brentq(excess, tried[above - 1], tried[above], xtol=1e-12 * highest)
    displacement = np.zeros((components, grid.size))
    displacement[0] = np.maximum(-gap, -depth).reshape(-1)
    return State(grid.whole, displacement, grid.mean(displacement))


def _carried(contact, depth):
    """Sum over the flat's nodes of the traction that bends the body to u_n = max(-g_0, -depth), ranges of the law."""
    displacement = np.maximum(-contact.initial_gap, -depth).reshape(1, -1)
    traction = Convolution(contact.grid.whole, contact.operator(1, "stiffness"), 1).apply(displacement, displacement)
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
        offset = (start + np.arange(extent) - first - known // 2 + total // 2) % total - total // 2 + known // 2
        axes.append(np.clip(offset, 0, known - 1))
    picked = source.box(state.displacement)[(slice(None), *np.ix_(*axes))]
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
    window = max(guess.window, found.window, key=lambda window: window.size)
    first, second = onto(guess, window), onto(found, window)
    lower = np.minimum(first[0], second[0]) + window.take(contact.initial_gap)
    change = (first - second)[:, lower < 10.0]
    if largest:
        return float(contact.grid.maximum(np.abs(change), initial=0.0))
    return float(np.sqrt(contact.grid.inner(change, change) / max(change.size, 1)))


def progress(contact, origin, ahead, state):
    """Part of the way from ``origin`` to ``ahead`` that a state has gone: its projection, on the window of ``ahead``."""
    start = onto(origin, ahead.window)
    way, gone = ahead.displacement - start, onto(state, ahead.window) - start
    return contact.grid.inner(gone, way) / max(contact.grid.inner(way, way), 1e-300)


def edges(contact, state):
    """Left and right end of the one stretch of a line contact, in nodes of the window; None where there is no such."""
    if len(contact.grid.shape) > 1:
        return None
    ends, _ = crossings(normal_gap(contact, state), contact.scene.contact_threshold)
    return ends if len(ends) == 2 and normal_gap(contact, state)[0] > contact.scene.contact_threshold else None


def follow_edge(contact, states, weights):
    """Extrapolate gaps in coordinates stretched so that the contact edges stay in place; None without two edges.

    The edge moves by a good part of its cohesive length in a step, so that gaps at fixed places change abruptly where gaps
    at a fixed distance from the edge hardly do.
    """
    ends = [edges(contact, state) for state in states]
    if any(end is None for end in ends):
        return None
    window = states[-1].window
    # Places of all states in nodes from the first one of the last window; a wider window begins before it.
    places = [end + _nodes_between(window, state.window) for end, state in zip(ends, states)]
    left, right = np.asarray(weights) @ places
    if right - left < 4.0:
        return None
    states = [wider(state, window) for state in states]
    begins = _nodes_between(window, states[-1].window)
    nodes = np.arange(window.size)
    gaps = np.zeros((len(states[-1].displacement), window.size))
    for state, weight, (begin, end) in zip(states, weights, places):
        source = begin + (nodes - left) * (end - begin) / (right - left) - begins
        field = state.displacement.copy()
        field[0] = normal_gap(contact, state)
        for gap, values in zip(gaps, field):
            gap += weight * ndimage.map_coordinates(values, [source], order=3, mode="nearest")
    # An extrapolation into deep overlap would meet the exponential.
    np.maximum(gaps[0], contact.grid.minimum(normal_gap(contact, states[-1])) - 1.0, out=gaps[0])
    gaps[0] -= window.take(contact.initial_gap)
    return State(window, gaps, sum(weight * state.means for state, weight in zip(states, weights)))


def _nodes_between(window, other):
    """Nodes from the first one of a line window to that of another near it, over the cell's border or not."""
    total = window.grid.shape[0]
    return (other.start[0] - window.start[0] + total // 2) % total - total // 2
