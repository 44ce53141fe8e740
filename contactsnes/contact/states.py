"""States of a contact on windows: starting, resampling, extrapolating.

A state is a displacement on a window with its means over the cell, in ranges of the law. Nothing
here solves.
"""

import math

import numpy as np

from ..grid.active import Nodes
from ..grid.clusters import reaching
from ..kernels import points
from .depth import of_start
from .problem import SUPPORT
from .state import State, alike, once_or_all, onto, spread

REACH = 10.0
"""Normal gap, in ranges, below which the law acts."""
NEAR = 15.0
"""Normal gap, in ranges, below which a predictor follows the edge of contact: beyond, the law is
below 1e-5 of its peak."""


def undeformed(contact, controls, load):
    """The start without overlap: u_n = max(-g_0, -c), with c from what is controlled of the normal
    component.

    Approach: the mean is as prescribed. Displacement: that of the top, with what the body as a
    whole gives way. Force: the flat carries it, or c is the smallest gap if it pulls. Tangential
    displacements are zero.

    Parameters
    ----------
    contact : Contact
    controls : 'displacement', 'force' or 'approach' for each component
    load : controlled values, u_n,r, u_t,r or w_n,r, w_t,r by ``controls``
    """
    grid = contact.grid
    displacement = np.zeros((len(controls), grid.whole.size))
    depth = of_start(contact, controls, load)
    displacement[0] = np.maximum(-contact.initial_gap, -depth).reshape(-1)
    return State(grid.whole, displacement, grid.mean(displacement))


def apart(contact):
    """The undeformed body, far outside the law's range; the normal component."""
    away = np.array([2.0 * contact.law.range - contact.grid.minimum(contact.initial_gap)])
    return State(contact.grid.whole, np.full((1, contact.grid.whole.size), away), away)


def normal_gap(contact, state):
    """Normal gap on the state's window (nodes), delta_n."""
    return state.normal + contact.gap_on(state.window)


def _at_rim(contact, state):
    """Smallest normal gap on the border of a state's window, delta_n."""
    nodes = state.nodes
    rim = nodes.rim_places
    return contact.grid.minimum(state.once[0, rim] + contact.gap_on(nodes)[rim])


def will_do(contact, state):
    """Whether a state's box, or boxes, are about what the law needs for it: not the cell, neither
    much wider nor narrower, and none of them idle."""
    window, reach = state.window, contact.law.reach
    if window.is_whole:
        return False
    if len(window.parts) > 1:
        gaps = normal_gap(contact, state).reshape(len(window.parts), -1)
        if gaps.min(axis=1).max() > 1.2 * reach:
            return False
    return 0.9 * reach <= _at_rim(contact, state) < 4.0 * reach


def fitted(contact, state, afresh=False):
    """The state on the box that the law needs for it, or the boxes: the same state where its window
    will do, unless ``afresh``.

    Parameters
    ----------
    contact : Contact
    state : State
    afresh : bool
    """
    window = state.window
    if not afresh and will_do(contact, state):
        return state
    if window.is_whole and contact.window(*once_or_all(contact, state)) == window:
        return state
    cell = contact.extended(state)
    fresh = contact.window(cell[0] + contact.initial_gap)
    return state if fresh == window else State(fresh, fresh.take(cell), state.means)


def wider(state, window):
    """The state on a window that reaches a fifth further than ``window`` on either side."""
    wide = reaching(window)
    return State(wide, onto(state, wide), state.means)


def covers(contact, state, closest=None):
    """Whether every node outside the state's window is certainly out of the law's range.

    Parameters
    ----------
    contact : Contact
    state : State
    closest : smallest normal gap outside of a window of some nodes, if that is known
    """
    if state.window.is_whole:
        return True
    if isinstance(state.window, Nodes):
        touching = normal_gap(contact, state) < contact.scene.contact_threshold
        if closest is None:
            closest = contact.grid.minimum(contact.gap_outside(state))
        return closest >= contact.law.certain and state.window.surround(touching, SUPPORT)
    if _at_rim(contact, state) < contact.law.certain:
        return False
    if contact.convex:
        return True
    return contact.grid.minimum(contact.gap_outside(state)) >= contact.law.certain


def with_components(state, components):
    """The state with tangential displacements added (zeros, even and odd alike) or left out."""
    if state.components == components:
        return state
    nodes = state.window if state.half is None or state.half.parities else state.half
    displacement, means = np.zeros((components, nodes.size)), np.zeros(components)
    known = state.once if nodes.even else state.displacement
    for kept, values in ((displacement, known), (means, state.means)):
        kept[:len(values)] = values[:components]
    return spread(nodes, displacement, means)


def distance(contact, first, second):
    """Root mean square distance of two states over the second's window, ranges of the law.

    Parameters
    ----------
    contact : Contact
    first, second : State, with as many components
    """
    change = onto(first, second.window) - second.displacement
    count = len(change) * second.window.total
    return float(np.sqrt(contact.grid.inner(change, change) / count))


def missed(contact, guess, found, largest=False):
    """Distance of a guess from what was found, over the nodes where the law acts on either (gap
    below 10).

    Root mean square, or the largest: the one that a spot makes which is small beside the rest.

    Parameters
    ----------
    contact, guess, found : Contact, State, State
    largest : whether the largest at a node, not the root mean square
    """
    grid, nodes, (begin, end) = alike(contact, [guess, found])
    told = (points.apart if contact.kernels.compiled else _apart)(
        begin, end, contact.gap_on(nodes), getattr(grid, "weights", None), REACH)
    if largest:
        return float(grid.largest(told[0]))
    count, squares = grid.together(told[1:]).tolist()
    return math.sqrt(squares / max(len(begin) * count, 1.0))


def _apart(first, second, initial_gap, weights, reach):
    """As `kernels.points.apart`."""
    near = np.minimum(first[0], second[0]) + initial_gap < reach
    change = (second - first) * near
    each = np.ones(len(near)) if weights is None else weights
    return np.array([np.max(np.abs(change), initial=0.0), each @ near,
                     np.sum((change * change) @ each)])


def way(contact, first, last, window):
    """Displacements from one state to another on a window, and the nodes where the law acts on
    either (gap below 10).

    Parameters
    ----------
    contact : Contact
    first, last : State
    window : Window
    """
    begin, end = onto(first, window), onto(last, window)
    return end - begin, np.minimum(begin[0], end[0]) + contact.gap_on(window) < REACH


def chord(contact, first, last, window):
    """The way from one state to another as a measure of others: row (components, nodes) and length.

    The product of the row with displacements from ``first`` is how far they lead along the way,
    root mean square over the nodes where the law acts on either end (over all, where it acts on
    none): a number that depends on neither grid nor window.

    Parameters
    ----------
    contact : Contact
    first, last : State
    window : Window
    """
    change, near = way(contact, first, last, window)
    if contact.grid.any(near):
        np.multiply(change, near, out=change)
    count = len(change) * (contact.grid.count(near) or window.total)
    length = float(np.sqrt(contact.grid.inner(change, change) / count))
    change /= max(count * length, 1e-300)
    return change, length


def chord_length(contact, first, last):
    """The length that `chord` tells, on the window of the second state.

    Parameters
    ----------
    contact : Contact
    first, last : State
    """
    told = (points.apart if contact.kernels.compiled else _apart)(
        onto(first, last.window), last.displacement, contact.gap_on(last.window), None, REACH)
    count, squares = contact.grid.together(told[1:]).tolist()
    count *= last.components
    return math.sqrt(squares / count) if count else distance(contact, first, last)


def progress(contact, origin, ahead, state):
    """Part of the way from ``origin`` to ``ahead`` that a state has gone: its projection, on the
    smaller window of the two. (Beyond it, out of the law's range, one of them is not known.)

    Parameters
    ----------
    contact : Contact
    origin, ahead, state : State
    """
    window = min(ahead.window, origin.window, key=lambda one: one.total)
    start = onto(origin, window)
    way, gone = onto(ahead, window) - start, onto(state, window) - start
    return contact.grid.inner(gone, way) / max(contact.grid.inner(way, way), 1e-300)
