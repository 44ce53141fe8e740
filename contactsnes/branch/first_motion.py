"""First points by motion from the undeformed body, where several equilibria may exist.

Which of them a body reaches is decided by its motion. On a grid on which gap and cohesive zone are
resolved this is the same motion as on finer ones, so that the coarsest of these grids decides; each
finer one only corrects what it finds.
"""

import numpy as np

from ..contact import states
from ..continuation.points import NoEquilibrium, NotConverged
from ..dynamics.jumps import settle
from ..grid.transfer import interpolated, resampled
from ..scene.resolution import LARGEST_RESOLUTION, resolution
from ..solvers.snes import COLD

SMOOTH = 0.25
"""Ranges of the law by which the gap between the nodes of a grid may miss what its neighbours, by a
cubic, say of it: more is too rough for that grid."""
SHORTEST = 16
"""Fewest nodes of a direction of a coarser grid."""
CORRECTED = 0.3
"""Ranges of the law by which a finer grid may move a node where the law acts: a spot that has
jumped is moved by more."""


def reached(system, coarser, start, controls, load, where):
    """The first point, where motion from a start leads.

    Parameters
    ----------
    system : Corrector
    coarser : function (Corrector, Contact, tolerance) -> Corrector on a coarser grid, or None
    start : function (Contact) -> State, the undeformed body
    controls, load : of each component
    where : str, what messages say of the place
    """
    grids = _levels(system, coarser, len(controls) > 1)
    state = None
    for level in grids[::-1]:
        try:
            point = (settle(level, start(level.contact), controls, load, where) if state is None
                     else _corrected(level, state, controls, load, where))
        except (NotConverged, NoEquilibrium) as error:
            if level is system:
                raise
            system.log(f"the motion on a coarser grid is not used ({error})")
            state = None
            continue
        if level is not system:
            finer = grids[grids.index(level) - 1]
            state = finer_state(level.contact, finer.contact, point.state)
    system.contact.coarse.cache_clear()
    return point


def _levels(system, coarser, sheared):
    """Correctors on the grid and on coarser ones that resolve gap and cohesive zone, the finest
    first."""
    found = [system]
    while True:
        contact = found[-1].contact
        if contact.isolated or any(n % 4 or n < 2 * SHORTEST for n in contact.grid.shape):
            return found
        level = contact.coarse(LARGEST_RESOLUTION)
        if (not np.array_equal(level.ranges, contact.ranges) or _unresolved(contact) > SMOOTH
            or max(resolution(level.scene, sheared)) > 1.0):
            return found
        coarse = coarser(system, level, None)
        if coarse is None:
            return found
        if len(found) == 1:
            system.log("motion on coarser grids leads to the first point, finer ones correct it")
        found.append(coarse)


def _unresolved(contact):
    """Largest difference between the gap and its cubic interpolation from every other node,
    ranges."""
    gap = contact.initial_gap
    kept = gap[(slice(None, None, 2),) * gap.ndim].reshape(-1)
    return contact.grid.maximum(np.abs(interpolated(contact.grid.whole, kept) - gap.reshape(-1)))


def finer_state(contact, finer, state):
    """The state of a contact as one of the same contact on twice as many nodes in each direction:
    displacements are interpolated by their waves, as smooth as the body makes them.

    Parameters
    ----------
    contact, finer : Contact
    state : State of the first of them
    """
    cell = resampled(contact.grid, finer.grid, contact.extended(state))
    return states.State(finer.grid.whole, cell.reshape(len(cell), -1), state.means)


def _corrected(system, state, controls, load, where):
    """The point next to a state from a coarser grid; motion from there where Newton's method leads
    elsewhere."""
    try:
        point = system.solve(state, controls, load, COLD)
        if (states.missed(system.contact, state, point.state, largest=True) < CORRECTED
            and not point.softest < 0.0):
            return point
        reason = "Newton's method led elsewhere"
    except NotConverged as error:
        reason = str(error)
    system.log(f"from the coarser grid's state motion goes on {where} ({reason})")
    return settle(system, state, controls, load, where)
