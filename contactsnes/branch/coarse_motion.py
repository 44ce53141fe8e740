"""Motion on coarser grids: to first points from the undeformed body, and out of folds.

Which of several equilibria a body reaches is decided by its motion. On a grid on which gap and
cohesive zone are resolved this is the same motion as on finer ones, so that the coarsest of these
grids decides; each finer one only corrects what it finds.
"""

from dataclasses import replace

from ..contact import states
from ..continuation.points import NoEquilibrium, NotConverged
from ..dynamics import jumps
from ..solvers.snes import COLD
from .coarser import coarser, finer_state, resolving
from .departure import Departure

CORRECTED = 0.3
"""Ranges of the law by which a finer grid may move a node where the law acts: a spot that has
jumped is moved by more."""


def reached(system, start, controls, load, where):
    """The first point, where motion from a start leads.

    Parameters
    ----------
    system : Corrector
    start : function (Contact) -> State, the undeformed body
    controls, load : of each component
    where : str, what messages say of the place
    """
    coarse = resolving(system, len(controls) > 1)
    if coarse is not None:
        system.log(f"motion on {coarse.contact.grid.size} nodes leads to the first point on "
                   f"{system.contact.grid.size}, which Newton's method corrects")
        try:
            point = reached(coarse, start, controls, load, where)
            system.contact.coarse.cache_clear()
            return corrected(system, finer_state(coarse.contact, system.contact, point.state),
                             controls, load, where)
        except (NotConverged, NoEquilibrium) as error:
            system.log(f"the coarser grid does not serve ({error})")
    return jumps.settle(system, start(system.contact), controls, load, where)


def corrected(system, state, controls, load, where):
    """The point next to a state from a coarser grid; motion from there where Newton's method leads
    elsewhere.

    Parameters
    ----------
    system : Corrector
    state : State
    controls, load, where : as of `reached`
    """
    try:
        point = system.solve(state, controls, load, COLD)
        if (states.missed(system.contact, state, point.state, largest=True) < CORRECTED
            and not point.softest < 0.0):
            return point
        reason = "Newton's method led elsewhere"
    except NotConverged as error:
        reason = str(error)
    system.log(f"from the coarser grid's state motion goes on {where} ({reason})")
    return jumps.settle(system, state, controls, load, where)


def settle(system, state, controls, load, where, origin=None):
    """The equilibrium that motion from a state leads to (`jumps.settle`), on coarser grids first
    where it begins beside an equilibrium of a rough plane.

    Parameters
    ----------
    system : Corrector
    state, controls, load, where, origin : as of `jumps.settle`
    """
    contact = system.contact
    if (origin is None or len(controls) > 1 or contact.convex or len(contact.grid.shape) < 2):
        return jumps.settle(system, state, controls, load, where, origin)
    coarse = resolving(system, False)
    if coarse is None:
        return jumps.settle(system, state, controls, load, where, origin)
    try:
        level = Departure(contact, coarse.contact, origin)
        point = settle(coarser(system, level.contact, None), level.injected(state), controls,
                       level.load(controls, load), where, level.origin)
    except (NotConverged, NoEquilibrium) as error:
        system.log(f"the coarser grid does not serve ({error})")
        return jumps.settle(system, state, controls, load, where, origin)
    found = corrected(system, level.prolonged(point.state), controls, load, where)
    return replace(found, jump_work=point.jump_work, viscous_work=point.viscous_work)
