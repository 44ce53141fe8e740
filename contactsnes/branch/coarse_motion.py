"""Motion on coarser grids: to first points from the undeformed body, and out of folds.

Which of several equilibria a body reaches is decided by its motion. On a grid on which gap and
cohesive zone are resolved this is the same motion as on finer ones, so that the coarsest of these
grids decides; each finer one only corrects what it finds.
"""

from dataclasses import replace

from ..contact import nearing, places, states
from ..continuation.points import NoEquilibrium, NotConverged, NoWayBack
from ..dynamics import jumps
from ..dynamics.control import rough
from ..solvers.vectors import collect
from .coarser import coarser, finer_state, resolving
from .departure import Departure

CORRECTED = 0.3
"""Ranges of the law by which a finer grid may move a node where the law acts: a spot that has
jumped is moved by more."""

BESIDE = 12
"""Iterations of Newton's method from a coarser grid's state, next to which there may be none on the
finer one."""

ENOUGH = 1e-6
"""Residual norm on a coarser grid, where states only lead to those of the finer one, which begins a
hundred times farther from its own."""


def reached(system, start, controls, load, where):
    """The first point, where motion from a start leads.

    Parameters
    ----------
    system : Corrector
    start : function (Contact) -> State, the undeformed body
    controls, load : of each component
    where : str, what messages say of the place
    """
    plane = len(system.contact.grid.shape) == 2
    coarse = resolving(system, len(controls) > 1, ENOUGH) if plane else None
    if coarse is not None:
        system.log(f"motion on {coarse.contact.grid.size} nodes leads to the first point on "
                   f"{system.contact.grid.size}, which Newton's method corrects")
        try:
            point = reached(coarse, start, controls, load, where)
            system.contact.coarse.cache_clear()
            state = finer_state(coarse.contact, system.contact, point.state)
            coarse = point = None
            collect()  # the coarse grid's memory is the finer one's
        except (NotConverged, NoEquilibrium) as error:
            system.log(f"the coarser grid does not serve ({error})")
        else:
            try:
                return corrected(system, state, controls, load)
            except NotConverged as error:
                system.log(f"from the coarser grid's state motion goes on {where} ({error})")
                return jumps.settle(system, lambda: state, controls, load, where)
    return jumps.settle(system, lambda: start(system.contact), controls, load, where)


def corrected(system, state, controls, load, most=BESIDE):
    """The stable point next to a state from a coarser grid; NotConverged where there is none.

    Parameters
    ----------
    system : Corrector
    state : State
    controls, load : of each component
    most : int, iterations of Newton's method
    """
    point = system.solve(state, controls, load, most)
    if (states.missed(system.contact, state, point.state, largest=True) < CORRECTED
        and not point.softest < 0.0):
        return point
    raise NotConverged("Newton's method led elsewhere")


def settle(system, state, controls, load, where, origin=None):
    """The equilibrium that motion from a state leads to (`jumps.settle`), on coarser grids first
    where it begins beside an equilibrium of a rough plane; the log says what has moved there.

    Parameters
    ----------
    system : Corrector
    state : State
    controls, load, where, origin : as of `jumps.settle`
    """
    point = _settled(system, state, controls, load, where, origin)
    if nearing.touches(system.contact, point.state) and system.neutral(point) == 0:
        # On which side of touching, where it is held or not, rounding left it.
        held = nearing.touching(system.contact, point.state)
        point = with_works(system.solve(held, controls, load), point)
    if origin is not None and rough(system.contact, len(controls), True):
        system.log(f"a jump {where}: {places.moved(system.contact, origin, point.state)}")
    return point


def _settled(system, state, controls, load, where, origin):
    """The same, in silence."""
    def motion(coarse, level):
        point = _settled(coarse, level.injected(state), controls, level.load(controls, load), where,
                         level.origin)
        coarse.release()
        return with_works(corrected(system, level.prolonged(point.state), controls, load), point)

    return (coarsely(system, controls, origin, motion)
            or jumps.left(system, state, controls, load, where, origin))


def with_works(point, motion):
    """A point with the works of the motion that ended next to it."""
    return replace(point, jump_work=motion.jump_work, viscous_work=motion.viscous_work)


def coarsely(system, controls, origin, motion):
    """What a motion finds that begins on a coarser grid; None where none serves.

    Parameters
    ----------
    system, controls : Corrector, and what is held
    origin : State, the equilibrium beside which the motion begins, or None
    motion : function (Corrector on the coarser grid, Departure) -> what it finds
    """
    contact = system.contact
    if (origin is None or len(controls) > 1 or contact.convex or len(contact.grid.shape) < 2
            or (coarse := resolving(system, False)) is None):
        return None
    level = Departure(contact, coarse.contact, origin)
    system.release()
    try:
        found = motion(coarser(system, level.contact, ENOUGH), level)
    except NoWayBack:
        raise
    except (NotConverged, NoEquilibrium) as error:
        system.log(f"the coarser grid does not serve ({error})")
        found = None
    coarse = None
    collect()  # not after an exception that one process may have alone: it takes all of them
    return found
