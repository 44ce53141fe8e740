"""Weighted sums of states, from which a solve begins, and what leads much farther than they."""

import numpy as np

from ..kernels import points
from .state import alike, spread, told_apart, weighted

STEEP = 4.0
"""How many times as far as states extrapolated at fixed nodes lead, or a range of the law, those
that follow edges may lead from the last one on a rough surface, or where a spot is resized."""


def combined(contact, states, weights):
    """Weighted sum of states at fixed places, on the window of the last, without overlap much
    deeper than its.

    Parameters
    ----------
    contact : Contact
    states : list of State
    weights : numbers, one a state
    """
    whole, each, *changed = told_apart(states, weights)
    _, nodes, (last, *others) = alike(contact, whole[-1:], whole[:-1])
    normal = last[0] if whole[-1] is states[-1] else states[-1].normal
    displacement, _ = without_overlap(contact, nodes, [*others, last], each, normal, *changed)
    return spread(nodes, displacement, weighted([state.means for state in states], weights))


def without_overlap(contact, nodes, known, weights, last, changes=(), shares=()):
    """Weighted sum of displacements, and of changes of such, without normal gaps below a floor, one
    range below those of the last state: where an extrapolation leads into deep overlap, it would
    meet the exponential. And that floor.

    Parameters
    ----------
    contact : Contact
    nodes : Window, or EvenWindow
    known, changes : lists of arrays (components, nodes), these in single precision
    weights, shares : numbers, one of each
    last : array (nodes,), normal displacement of the last state
    """
    compiled, gap = contact.kernels.compiled, contact.gap_on(nodes)
    closest = points.closest(last, gap) if compiled else np.min(last + gap, initial=np.inf)
    floor = -contact.grid.largest(-closest) - 1.0
    return (points.combined if compiled else _combined)(known, weights, changes, shares, gap,
                                                        floor), floor


def _combined(known, weights, changes, shares, initial_gap, floor):
    """As `kernels.points.combined`."""
    displacement = weighted(known, weights)
    for change, share in zip(changes, shares):
        displacement += share * change.astype(float)
    np.maximum(displacement[0], floor - initial_gap, out=displacement[0])
    return displacement


def leads_astray(contact, states, weights, ahead):
    """Whether a state that follows edges leads much farther from the last one than states at fixed
    nodes do: on a steep surface heights beside a node tell nothing of its own, and edges of a spot
    that vanishes are foretold where they never are.

    Parameters
    ----------
    contact, states, weights : as of `combined`
    ahead : State, foretold from them
    """
    grid, _, (last, moved, *earlier) = alike(contact, [states[-1]], [ahead, *states[:-1]])
    way, far = (grid.maximum(np.abs(values - last))
                for values in (weighted([*earlier, last], weights), moved))
    return far > STEEP * max(way, 1.0)
