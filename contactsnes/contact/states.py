"""States of a contact on windows: starting, resampling, extrapolating.

A state is a displacement on a window with its means over the cell, in ranges of the law. Nothing
here solves.
"""

import math

import numpy as np

from ..grid.active import Nodes
from ..grid.boxes import reaching
from ..grid.cell import Convolution
from ..grid.roots import bracketed_root
from ..kernels import points
from .problem import APPROACH, FORCE, SUPPORT
from .state import State, alike, once_or_all, onto, spread

REACH = 10.0
"""Normal gap, in ranges, below which the law acts."""
NEAR = 15.0
"""Normal gap, in ranges, below which a predictor follows the edge of contact: beyond, the law is
below 1e-5 of its peak."""
LARGE = 2 ** 16
"""Nodes of a cell from which on the start of a convex body is looked for on every other one: each
trial is two transforms."""
ACROSS = 8
"""Nodes of each direction on the flat, at least, from which that start is taken."""


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
    depth = _depth(contact, controls, load)
    displacement[0] = np.maximum(-contact.initial_gap, -depth).reshape(-1)
    return State(grid.whole, displacement, grid.mean(displacement))


def _depth(contact, controls, load):
    """c of the start u_n = max(-g_0, -c), in ranges of the law."""
    gap = contact.initial_gap
    grid = contact.grid
    lowest, highest = grid.minimum(gap), grid.maximum(gap)
    compliance = 0.0 if controls[0] == APPROACH else contact.rigid_compliance(1)[0]
    control, target = controls[0], -contact.far_displacement(len(controls), load)[0]

    def approach(depth):
        return grid.sum(np.minimum(gap, depth).reshape(-1)) / grid.size

    def excess(depth):
        if control == FORCE:
            return _carried(contact, depth) * contact.ranges[0] * grid.node_area - load[0]
        sunk = compliance / grid.size * _carried(contact, depth) if compliance else 0.0
        return approach(depth) + sunk - target

    # The mean of equal gaps is not quite the gap.
    if load[0] <= 0.0 if control == FORCE else target <= max(lowest, approach(lowest)):
        return lowest if control == FORCE else target
    if control == FORCE or compliance:
        coarse = _on_every_other_node(contact, controls, load)
        if coarse is not None:
            return coarse
    # What the flat carries first rises with the depth and falls again towards full contact: the
    # first root counts.
    tried = [lowest, *grid.quantiles(gap, (0.01, 0.03, 0.1, 0.2, 0.4, 0.7)), highest]
    above = next((k for k, depth in enumerate(tried) if k and excess(depth) > 0.0), None)
    # Each trial of what the flat carries is a transform of the cell; a start need not be exact in
    # that.
    precision = 1e-12 if control != FORCE and not compliance else 1e-3
    return highest if above is None else bracketed_root(excess, tried[above - 1], tried[above],
                                                        rtol=precision)


def _on_every_other_node(contact, controls, load):
    """c of the same start on half as many nodes in each direction; None where that is not worth
    it, or where it would not do: bodies with several equilibria are moved from their start.

    Parameters
    ----------
    contact, controls, load : as of `undeformed`
    """
    grid = contact.grid
    if grid.size < LARGE or any(n % 4 for n in grid.shape) or not contact.convex:
        return None
    coarse = contact.coarse(np.inf)
    depth = _depth(coarse, controls, load)
    pressed = coarse.grid.count(coarse.initial_gap < depth)
    contact.coarse.cache_clear()
    return depth if pressed >= ACROSS ** len(grid.shape) else None


def apart(contact):
    """The undeformed body, far outside the law's range; the normal component."""
    away = np.array([2.0 * contact.law.range - contact.grid.minimum(contact.initial_gap)])
    return State(contact.grid.whole, np.full((1, contact.grid.whole.size), away), away)


def _carried(contact, depth):
    """Sum over the flat's nodes of the traction that bends the body to u_n = max(-g_0, -depth),
    ranges of the law."""
    displacement = np.maximum(-contact.initial_gap, -depth).reshape(1, -1)
    traction = Convolution(contact.grid.whole, contact.periodic.operator(1, "stiffness"), 1,
                           contact.transforms).apply(displacement, displacement)
    return contact.grid.sum(traction[0, contact.initial_gap.reshape(-1) < depth])


def normal_gap(contact, state):
    """Normal gap on the state's window (nodes), delta_n."""
    return state.normal + contact.gap_on(state.window)


def _at_rim(contact, state):
    """Smallest normal gap on the border of a state's window, delta_n."""
    nodes = state.nodes
    rim = nodes.rim_places
    return contact.grid.minimum(state.once[0, rim] + contact.gap_on(nodes)[rim])


def fitted(contact, state, afresh=False):
    """The state on the box that the law needs for it, or the boxes: the same state where its window
    will do, unless ``afresh``.

    Parameters
    ----------
    contact : Contact
    state : State
    afresh : bool
    """
    window, reach = state.window, contact.law.range
    closest = _at_rim(contact, state)
    idle = (len(window.parts) > 1
            and normal_gap(contact, state).reshape(len(window.parts),
                                                   -1).min(axis=1).max() > 1.2 * reach)
    if not afresh and not window.is_whole and not idle and 0.9 * reach <= closest < 4.0 * reach:
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
    return change / max(count * length, 1e-300), length


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
    window of ``ahead``.

    Parameters
    ----------
    contact : Contact
    origin, ahead, state : State
    """
    start = onto(origin, ahead.window)
    way, gone = ahead.displacement - start, onto(state, ahead.window) - start
    return contact.grid.inner(gone, way) / max(contact.grid.inner(way, way), 1e-300)
