"""Motion on coarser grids: to first points from the undeformed body, and out of folds.

Which of several equilibria a body reaches is decided by its motion. On a grid on which gap and
cohesive zone are resolved this is the same motion as on finer ones, so that the coarsest of these
grids decides; each finer one only corrects what it finds.
"""

from dataclasses import replace

from ..contact import states
from ..contact.acceptance import strayed
from ..continuation.points import NoEquilibrium, NotConverged
from ..dynamics import jumps
from ..solvers.snes import COLD
from .coarser import coarser, finer_state, resolving
from .departure import Departure

CORRECTED = 0.3
"""Ranges of the law by which a finer grid may move a node where the law acts: a spot that has
jumped is moved by more."""

SAME = 1e-3
"""Largest way of a node, ranges of the law, from the state that lies behind a bracket to the one
before it, up to which both are one: no fold lies in between."""
SHORTEST = 0.2
"""Part of a bracket below which steps on the way back through it are not halved."""


class NoWayBack(NotConverged):
    """The branch beyond a bracket of loads does not reach back through it."""


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
    def motion(coarse, level):
        return settle(coarse, level.injected(state), controls, level.load(controls, load), where,
                      level.origin)

    level, point = _coarsely(system, controls, origin, motion)
    if level is None:
        return jumps.settle(system, state, controls, load, where, origin)
    found = corrected(system, level.prolonged(point.state), controls, load, where)
    return replace(found, jump_work=point.jump_work, viscous_work=point.viscous_work)


def crossed(system, origin, controls, load, beyond, where):
    """What lies beyond a bracket of loads: the state to which motion from an equilibrium leads
    under the load at its end, and the point to which that leads back, None where it is the
    equilibrium itself.

    Parameters
    ----------
    system : Corrector
    origin : State, the equilibrium
    controls, load : of the equilibrium
    beyond : the load at the bracket's end
    where : str, what messages say of the place

    Raises
    ------
    NoEquilibrium : where the body leaves or slides without end
    NotConverged : where the motion does not settle, or no branch leads back
    """
    def motion(coarse, level):
        return crossed(coarse, level.origin, controls, level.load(controls, load),
                       level.load(controls, beyond), where)

    level, found = _coarsely(system, controls, origin, motion)
    if level is None:
        return _crossed(system, origin, controls, load, beyond, where)
    ahead, behind = found
    if behind is None:
        return level.prolonged(ahead), None
    point = corrected(system, level.prolonged(behind.state), controls, load, where)
    if states.missed(system.contact, origin, point.state, largest=True) < SAME:
        return level.prolonged(ahead), None
    return level.prolonged(ahead), replace(point, jump_work=behind.jump_work,
                                           viscous_work=behind.viscous_work)


def _crossed(system, origin, controls, load, beyond, where):
    """`crossed` on the system's own grid."""
    contact = system.contact
    ahead = jumps.settle(system, origin, controls, beyond, where, origin)
    behind = _back(system, ahead, controls, beyond, load)
    if states.missed(system.contact, origin, behind.state, largest=True) < SAME:
        return ahead.state, None
    return ahead.state, replace(behind, jump_work=ahead.jump_work, viscous_work=ahead.viscous_work)


def _back(system, ahead, controls, beyond, load):
    """The point at a load on the branch of one beyond it, in steps as long as they stay on it.

    Parameters
    ----------
    system, ahead : Corrector, and the Point
    controls, beyond, load : what is held, where the way begins, and where it ends
    """
    known, step = [(0.0, ahead.state)], 1.0
    while known[-1][0] < 1.0:
        here, last = known[-1]
        place = min(here + step, 1.0)
        guess = last
        if len(known) > 1:
            part = (place - here) / (here - known[-2][0])
            guess = states.combined(system.contact, [known[-2][1], last], [-part, 1.0 + part])
        try:
            point = system.solve(guess, controls, beyond + place * (load - beyond))
            lost = point.softest < 0.0 or strayed(system.contact, guess, last, point.state) > 0.0
        except NotConverged:
            lost = True
        if not lost:
            known = [*known[-1:], (place, point.state)]
            step *= 2.0
        elif step > SHORTEST:
            step *= 0.5
        else:
            raise NoWayBack("the branch beyond a refused step does not reach back")
    return point


def _coarsely(system, controls, origin, motion):
    """(`Departure`, what a motion finds on a coarser grid); (None, None) where none serves.

    Parameters
    ----------
    system, controls : Corrector, and what is held
    origin : State, the equilibrium beside which the motion begins, or None
    motion : function (Corrector on the coarser grid, Departure) -> what it finds
    """
    contact = system.contact
    if (origin is None or len(controls) > 1 or contact.convex or len(contact.grid.shape) < 2
            or (coarse := resolving(system, False)) is None):
        return None, None
    level = Departure(contact, coarse.contact, origin)
    try:
        return level, motion(coarser(system, level.contact, None), level)
    except NoWayBack:
        raise
    except (NotConverged, NoEquilibrium) as error:
        system.log(f"the coarser grid does not serve ({error})")
        return None, None
