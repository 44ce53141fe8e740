"""States in which a body comes to feel the law, from out of its range or from a glide: motion
begins there, for from where it comes it would take for ever.

What it loses where there is no potential hangs on its way from there on.
"""

import numpy as np

from .state import State
from .states import normal_gap

PLACES = 9
"""Gaps or slips, from far to near, of which the first that is felt is taken."""
FELT = 1e-3
"""Part of its peaks by which tractions differ from those of far away where the law is felt."""
OVERLAP, TOUCH = 1e-9, 1e-6
"""Overlap, ranges, at which a body is held though no force is felt; gap or overlap at which it
touches."""


def within_range(contact, state):
    """The state of a body off the flat moved down as a whole until its lowest node is one range of
    the law away; from out of its range, where surfaces may slip, until the body is attracted, or
    touches where slip has left no attraction."""
    cell = contact.extended(state)
    lowest = contact.grid.minimum(cell[0] + contact.initial_gap)
    gap = 1.0
    if len(cell) > 1 and lowest > contact.law.range:
        places = np.repeat(state.means[:, None], PLACES, axis=1)
        places[0] = np.linspace(contact.law.opening_range, 1.0, PLACES)
        felt = contact.law.traction(places)[0] > FELT * contact.law.normal_peak
        gap = places[0, _first(felt)] if felt.any() else -OVERLAP
    return _lowered(contact, cell, lowest - gap)


def touching(contact, state):
    """The state of a body moved down as a whole until it touches: slip has left the law nothing but
    its repulsion, of which it feels what is no force yet."""
    cell = contact.extended(state)
    return _lowered(contact, cell, contact.grid.minimum(cell[0] + contact.initial_gap) + OVERLAP)


def touches(contact, state):
    """Whether a body does nothing but touch."""
    return abs(contact.grid.minimum(normal_gap(contact, state))) < TOUCH


def _lowered(contact, cell, way):
    """The state of displacements of the cell, moved down as a whole by a way."""
    cell[0] -= way
    flat = cell.reshape(len(cell), -1)
    return State(contact.grid.whole, flat, contact.grid.mean(flat))


def held(contact, state):
    """A gliding state taken back as a whole, for it comes from more slip, until it is held by other
    tractions somewhere: at the slip of the friction's peak at last."""
    law, means = contact.law, state.means.copy()
    ahead = means[1:] / np.linalg.norm(means[1:])
    touching = normal_gap(contact, state) < contact.scene.contact_threshold
    least = contact.grid.minimum((ahead @ state.displacement[1:])[None], where=touching)
    places = np.ones((2, PLACES))
    places[1] = np.linspace(min(least, law.slip_range), law.slip_peak, PLACES)
    traction = law.traction(places)
    peaks = np.array([[law.normal_peak], [law.friction_size]])
    felt = (np.abs(traction - traction[:, :1]) > FELT * peaks).any(axis=0)
    back, moved = (places[1, _first(felt)] - least) * ahead, state.displacement.copy()
    moved[1:] += back[:, None]
    means[1:] += back
    return State(state.window, moved, means)


def _first(felt):
    """Number of the first place that is felt, or the last."""
    return int(np.argmax(felt)) if felt.any() else -1
