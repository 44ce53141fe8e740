"""Weighted sums of states, from which a solve begins."""

import numpy as np

from ..kernels import points
from .state import alike, spread, weighted


def combined(contact, states, weights):
    """Weighted sum of states at fixed places, on the window of the last, without overlap much
    deeper than its.

    Parameters
    ----------
    contact : Contact
    states : list of State
    weights : numbers, one a state
    """
    _, nodes, (last, *others) = alike(contact, states[-1:], states[:-1])
    displacement, _ = without_overlap(contact, nodes, [*others, last], weights)
    return spread(nodes, displacement, weighted([state.means for state in states], weights))


def without_overlap(contact, nodes, known, weights):
    """Weighted sum of displacements (components, nodes), without normal gaps below a floor, one
    range below those of the last ones: where an extrapolation leads into deep overlap, it would
    meet the exponential. And that floor.

    Parameters
    ----------
    contact : Contact
    nodes : Window, or EvenWindow
    known : list of arrays (components, nodes)
    weights : numbers, one of each
    """
    compiled, gap, last = contact.kernels.compiled, contact.gap_on(nodes), known[-1][0]
    closest = points.closest(last, gap) if compiled else np.min(last + gap, initial=np.inf)
    floor = -contact.grid.largest(-closest) - 1.0
    return (points.combined if compiled else _combined)(known, weights, gap, floor), floor


def _combined(known, weights, initial_gap, floor):
    """As `kernels.points.combined`."""
    displacement = weighted(known, weights)
    np.maximum(displacement[0], floor - initial_gap, out=displacement[0])
    return displacement
