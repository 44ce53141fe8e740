"""What a solve may begin with, and the point that its end is."""

import math

import numpy as np

from ..contact.problem import APPROACH, FORCE
from ..continuation.points import NotConverged, Point


def refuse_unknown(grid, *starts):
    """NotConverged where what a solve begins with, arrays, holds infinite values or NaN: so does
    its sum."""
    if grid.any(not math.isfinite(sum([np.add.reduce(start, axis=None) for start in starts]))):
        raise NotConverged("the solve cannot begin: its start holds NaN or infinite values")


def finite(state):
    """A state from which a solve may begin, as of `refuse_unknown`."""
    refuse_unknown(state.window.grid, state.once, state.means)
    return state


def moved_means(form, change, far):
    """How the means (components,) move with a change of the unknown at the last linearisation,
    ranges of the law: where a displacement is held through the body, by as much less than that as
    the body gives way.

    Parameters
    ----------
    form : of the equations
    change : array of the form's size
    far : array (components,), change of the far displacements
    """
    if form.whole_cell:
        return form.grid.mean(form.displacement(change))
    half, field = getattr(form, "half", form), form.once(change)
    # one component takes no memory besides
    response = half.stiffen(field, field if form.components == 1 else np.empty_like(field))
    means = far - form.rigid_compliance * form.grid.sum(response) / form.grid.size
    means[form.forced] = form.scalars(change)
    return means


def balanced_point(contact, form, state, imbalance, **more):
    """The Point of a state that balances.

    Parameters
    ----------
    contact, form, state : Contact, the form whose load is the state's, State
    imbalance : Imbalance
    more : further attributes of the point
    """
    components, survey = form.components, contact.survey(state)
    factor, ranges = contact.load_factor(components), contact.ranges[:components]
    forces = factor * survey.total
    far = state.means + contact.rigid_compliance(components) * survey.total / contact.grid.size
    displacements = contact.signs(components) * far / ranges + contact.datum
    for i, control in enumerate(form.controls):
        if control != APPROACH:
            (forces if control == FORCE else displacements)[i] = form.load[i]
    in_contact = survey.touching > 0
    sliding = components > 1 and in_contact and survey.sticking == 0
    return Point(state, form.controls, form.load.copy(), displacements, forces, in_contact, sliding,
                 imbalance.norm, largest_residual=imbalance.largest, **more)
