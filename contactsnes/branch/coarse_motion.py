"""Motion on coarser grids: to first points from the undeformed body, and out of folds.

Which of several equilibria a body reaches is decided by its motion. On a grid on which gap and
cohesive zone are resolved this is the same motion as on finer ones, so that the coarsest of these
grids decides; each finer one only corrects what it finds.
"""

from dataclasses import replace

from ..contact import places, states
from ..contact.acceptance import strayed
from ..contact.energies import far_displacements, stored, weights
from ..continuation.points import Crossing, NoEquilibrium, NotConverged, NoWayBack
from ..dynamics import jumps
from ..dynamics.control import rough
from ..solvers.snes import COLD, collect
from .coarser import coarser, finer_state, resolving
from .departure import Departure

CORRECTED = 0.3
"""Ranges of the law by which a finer grid may move a node where the law acts: a spot that has
jumped is moved by more."""

SAME = 1e-3
"""Largest way of a node, ranges of the law, from the state that lies behind a bracket to the one
before it, up to which both are one: no fold lies in between."""
SHORTEST = 0.5
"""Part of a bracket below which steps on the way back through it are not halved."""
CLOSE = 0.1
"""The same of steps towards a fold in it."""
NARROWER = 2
"""How many narrower brackets in each other are tried where the state beyond one does not lead back
to before it."""


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
    coarse = resolving(system, len(controls) > 1) if plane else None
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
                return jumps.settle(system, state, controls, load, where)
    return jumps.settle(system, start(system.contact), controls, load, where)


def corrected(system, state, controls, load):
    """The stable point next to a state from a coarser grid; NotConverged where there is none.

    Parameters
    ----------
    system : Corrector
    state : State
    controls, load : of each component
    """
    point = system.solve(state, controls, load, COLD)
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
    state, controls, load, where, origin : as of `jumps.settle`
    """
    point = _settled(system, state, controls, load, where, origin)
    if origin is not None and rough(system.contact, len(controls)):
        system.log(f"a jump {where}: {places.moved(system.contact, origin, point.state)}")
    return point


def _settled(system, state, controls, load, where, origin):
    """The same, in silence."""
    def motion(coarse, level):
        point = _settled(coarse, level.injected(state), controls, level.load(controls, load), where,
                         level.origin)
        return _with_works(corrected(system, level.prolonged(point.state), controls, load), point)

    return (_coarsely(system, controls, origin, motion)
            or jumps.settle(system, state, controls, load, where, origin))


def _with_works(point, motion):
    """A point with the works of the motion that ended next to it."""
    return replace(point, jump_work=motion.jump_work, viscous_work=motion.viscous_work)


def crossed(system, last, beyond, where):
    """What lies in a bracket of loads and beyond it: a `Crossing`.

    Motion from a point leads under the load at the bracket's end to a state beyond a fold, if there
    is one. Where that leads back to the point's load, to less energy, the point is next to the
    fold; else a step of the branch nearer to it is.

    Parameters
    ----------
    system : Corrector
    last : Point, stable
    beyond : array, the load at the bracket's end
    where : str, what messages say of the place

    Raises
    ------
    NoEquilibrium : where the body leaves or slides without end
    NotConverged : where the motion does not settle
    NoWayBack : where no branch leads back, or to more energy
    """
    found = _crossing(system, last, last.load, beyond, where)
    if found.behind is not None:
        system.log(f"a jump before {system.contact.scene.loads(last.controls, beyond)}: "
                   f"{places.moved(system.contact, last.state, found.behind.state)}")
    return found


def _crossing(system, last, load, beyond, where):
    """`crossed` from a point at a load, on coarser grids where these serve."""
    controls = last.controls

    def motion(coarse, level):
        begin, end = level.load(controls, load), level.load(controls, beyond)
        found = _crossing(coarse, coarse.solve(level.origin, controls, begin), begin, end, where)
        at = load + found.begin * (beyond - load)

        def fine(point):
            return corrected(system, level.prolonged(point.state), controls, at)

        before = fine(found.before) if found.begin else last
        behind = found.behind and _lower(system, before,
                                         _with_works(fine(found.behind), found.behind))
        return found._replace(before=before, behind=behind, ahead=level.prolonged(found.ahead))

    return (_coarsely(system, controls, last.state, motion)
            or _crossed(system, last, load, beyond, where, NARROWER))


def _crossed(system, last, load, beyond, where, narrower):
    """The same on the system's own grid, with as many narrower brackets within each other."""
    ahead = jumps.settle(system, last.state, last.controls, beyond, where, last.state)

    def told(begin, before, shortest):
        at = load + begin * (beyond - load)
        behind = _lower(system, before, _back(system, ahead, at, shortest))
        return Crossing(begin, 1.0, before, behind and _with_works(behind, ahead), ahead.state)

    try:
        return told(0.0, last, 1.0)
    except NoWayBack:
        if not narrower:
            raise
    begin, end, before = _nearest(system, last, load, beyond)
    try:
        return told(begin, before, SHORTEST)
    except NoWayBack:
        # Motion may have led past more than one fold.
        found = _crossed(system, before, load + begin * (beyond - load),
                         load + end * (beyond - load), where, narrower - 1)
    width = end - begin
    return found._replace(begin=begin + width * found.begin, end=begin + width * found.end)


def _lower(system, before, behind):
    """A point behind a jump; None where it is the one before it.

    Raises
    ------
    NoWayBack : where it has more energy, so that under its load it is the other state to which a
        body would jump
    """
    contact = system.contact
    if states.missed(contact, before.state, behind.state, largest=True) < SAME:
        return None
    kept, reached = (sum(stored(contact, point)) for point in (before, behind))
    moved = far_displacements(contact, behind) - far_displacements(contact, before)
    if reached - kept - weights(contact, len(moved)) @ (before.forces * moved) > 0.0:
        raise NoWayBack("the branch beyond a refused step leads back to more energy")
    return behind


def _back(system, ahead, load, shortest):
    """The point at a load on the branch of one beyond it, in steps as long as they stay on it.

    Parameters
    ----------
    system, ahead : Corrector, and the Point
    load : where the way ends
    shortest : part of the way below which steps are not halved
    """
    known, step = [(0.0, ahead)], 1.0
    while known[-1][0] < 1.0:
        here = known[-1][0]
        point = _stepped(system, known, here + step, ahead.load, load)
        if point is not None:
            known, step = [*known[-1:], (here + step, point)], min(2.0 * step, 1.0 - here - step)
        elif step > shortest:
            step *= 0.5
        else:
            raise NoWayBack("the branch beyond a refused step does not reach back")
    return known[-1][1]


def _nearest(system, last, begin, end):
    """(place, refused, point): how far on the way from a point at the load ``begin`` to a load
    ``end`` beyond a fold the branch leads, in halved steps, and the nearest place to which it does
    not."""
    known, refused, step = [(0.0, last)], 1.0, 0.5
    while step > CLOSE:
        place = known[-1][0] + step
        point = _stepped(system, known, place, begin, end)
        if point is None:
            refused = place
        else:
            known = [*known[-1:], (place, point)]
        step *= 0.5
    return known[-1][0], refused, known[-1][1]


def _stepped(system, known, place, begin, end):
    """The stable point at a place of a way between two loads, next to those that are known; None
    where a solve leads elsewhere.

    Parameters
    ----------
    system : Corrector
    known : [(place, Point), ...], the last two at most
    place : of the new point
    begin, end : arrays, the loads at places 0 and 1
    """
    here, last = known[-1]
    guess = last.state
    if len(known) > 1:
        part = (place - here) / (here - known[-2][0])
        guess = states.combined(system.contact, [known[-2][1].state, guess], [-part, 1.0 + part])
    try:
        point = system.solve(guess, last.controls, begin + place * (end - begin))
    except NotConverged:
        return None
    lost = (point.softest < 0.0
            or strayed(system.contact, guess, last.state, point.state) > 0.0)
    return None if lost else point


def _coarsely(system, controls, origin, motion):
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
    try:
        return motion(coarser(system, level.contact, None), level)
    except NoWayBack:
        raise
    except (NotConverged, NoEquilibrium) as error:
        system.log(f"the coarser grid does not serve ({error})")
        return None
    finally:
        coarse = None
        collect()
