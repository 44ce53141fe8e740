"""Correctors on coarser grids, which count in their finer one's units, and their states on it."""

import numpy as np

from ..contact import states
from ..contact.force_form import FORMS
from ..grid.transfer import refined, resampled
from ..scene.resolution import LARGEST_RESOLUTION, resolution
from ..solvers.capabilities import asked

SMOOTH = 0.25
"""Ranges of the law by which the gap between the nodes of a grid may miss what its neighbours, by a
cubic, say of it: more is too rough for that grid."""
SHORTEST = 32
"""Fewest nodes of a direction of a coarser grid."""


def coarser(system, contact, tolerance):
    """A corrector for the contact on a coarser grid whose costs are this one's; None if no grid
    but its own serves it.

    Parameters
    ----------
    system : Corrector
    contact : Contact on a coarser grid
    tolerance : of the residual norm, ranges of the law; None: that of -snes_atol
    """
    form = system.settings
    if not (form.cascade and not FORMS[form.form].whole_cell and form.first == "none"
            and asked().has_tangent):
        return None
    coarse = system.on(contact, tolerance)
    coarse.totals, coarse.leads = system.totals, True
    return coarse


def resolving(system, sheared, tolerance=None):
    """A corrector on every other node of a system's grid, where those still resolve gap and
    cohesive zone; None where they do not, or where no other grid serves.

    Parameters
    ----------
    system : Corrector
    sheared : bool, whether there are tangential components
    tolerance : as of `coarser`
    """
    contact = system.contact
    if contact.isolated or any(n % 4 or n < 2 * SHORTEST for n in contact.grid.shape):
        return None
    level = contact.coarse(LARGEST_RESOLUTION)
    if (not np.array_equal(level.ranges, contact.ranges) or _missed(contact) > SMOOTH
        or max(resolution(level.scene, sheared)) > 1.0):
        return None
    return coarser(system, level, tolerance)


def _missed(contact):
    """Largest difference between the gap and its cubic interpolation from every other node,
    ranges."""
    gap = contact.initial_gap
    return contact.grid.maximum(np.abs(refined(contact.grid, contact.grid.every_other(gap)) - gap))


def finer_state(contact, finer, state):
    """The state of a contact as one of the same contact on twice as many nodes in each direction:
    displacements are interpolated by their waves, as smooth as the body makes them.

    Parameters
    ----------
    contact, finer : Contact
    state : State of the first of them
    """
    cell = resampled(contact.grid, finer.grid, contact.extended(state), contact.transforms)
    return states.State(finer.grid.whole, cell.reshape(len(cell), -1), state.means)
