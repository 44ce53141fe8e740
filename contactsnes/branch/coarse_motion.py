"""Motion on coarser grids: to first points from the undeformed body, and out of folds.

Which of several equilibria a body reaches is decided by its motion. On a grid on which gap and
cohesive zone are resolved this is the same motion as on finer ones, so that the coarsest of these
grids decides; each finer one only corrects what it finds.
"""

from dataclasses import replace

import numpy as np

from ..contact import places, states
from ..contact.acceptance import strayed
from ..contact.energies import far_displacements, stored, weights
from ..continuation.bifurcations import BACK
from ..continuation.points import Leg, NoEquilibrium, NotConverged, NoWayBack
from ..continuation.turning import turns
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
SHORTEST = 0.2
"""Part of a bracket below which steps on the way back through it are not halved."""


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
    """What lies beyond a bracket of loads: the state to which motion from a point leads under the
    load at the bracket's end, and the end of a jump on the way there, None where there is none.

    That end is where the motion leads back to under the load of the point: a state of less energy.
    Where nothing leads back, or to more energy, it is the end of the motion itself, under the load
    beyond, if the branch between the two turns back (`turning.turns`).

    Parameters
    ----------
    system : Corrector
    last : Point, stable
    beyond : array, the load at the bracket's end
    where : str, what messages say of the place

    Raises
    ------
    NoEquilibrium : where the body leaves or slides without end
    NotConverged : where the motion does not settle, or nothing tells whether the branch turns
    """
    ahead, end = _crossing(system, last.state, last.controls, (last.load, beyond), where)
    if end is not None and not np.array_equal(end.load, beyond) and _gained(system.contact, last,
                                                                            end) > 0.0:
        # Under the load of the point it is the other state to which a body would jump.
        raise NoWayBack("the branch beyond a refused step leads back to more energy")
    if end is not None:
        system.log(f"a jump before {system.contact.scene.loads(last.controls, beyond)}: "
                   f"{places.moved(system.contact, last.state, end.state)}")
    return ahead, end


def _gained(contact, last, found):
    """Energy that body and interface have more than before at held loads, less what these did; nan
    where the law has no potential."""
    before, after = (sum(stored(contact, point)) for point in (last, found))
    moved = far_displacements(contact, found) - far_displacements(contact, last)
    return after - before - weights(contact, len(moved)) @ (last.forces * moved)


def _crossing(system, origin, controls, loads, where):
    """`crossed` from a state, on coarser grids where these serve; ``loads`` before and beyond."""
    def motion(coarse, level):
        near = tuple(level.load(controls, load) for load in loads)
        ahead, end = _crossing(coarse, level.origin, controls, near, where)
        if end is None:
            return level.prolonged(ahead), None
        held = loads[int(np.array_equal(end.load, near[1]))]
        point = corrected(system, level.prolonged(end.state), controls, held)
        same = states.missed(system.contact, origin, point.state, largest=True) < SAME
        return level.prolonged(ahead), None if same else _with_works(point, end)

    return (_coarsely(system, controls, origin, motion)
            or _crossed(system, origin, controls, loads, where))


def _crossed(system, origin, controls, loads, where):
    """The same on the system's own grid."""
    load, beyond = loads
    ahead = jumps.settle(system, origin, controls, beyond, where, origin)
    last, way = system.solve(origin, controls, load), Way(system, ahead, controls, loads)
    behind = way.back()
    same = behind and states.missed(system.contact, origin, behind.state, largest=True) < SAME
    if behind is None or (same and not way.leads_back(last)):
        try:
            return ahead.state, ahead if way.turns(last) else None
        except NotConverged:
            # far apart: a jump that is larger than its bracket
            behind = way.back(SHORTEST)
        if behind is None:
            raise NoWayBack("the branch beyond a refused step does not reach back")
        same = states.missed(system.contact, origin, behind.state, largest=True) < SAME
    if same:
        return ahead.state, None
    return ahead.state, (ahead if _gained(system.contact, last, behind) > 0.0
                         else _with_works(behind, ahead))


class Way:
    """The way back from where motion led, under a load beyond another.

    Parameters
    ----------
    system : Corrector
    ahead : Point, where it led
    controls, loads : what is held, and the loads at the end of the way and at its begin
    """

    def __init__(self, system, ahead, controls, loads):
        moving = int(np.argmax(np.abs(loads[1] - loads[0])))
        self.leg = Leg(0, controls, *loads, moving, 1.0, 1.0, 1.0)
        self.system, self.ahead = system, replace(ahead, position=1.0)

    def back(self, shortest=1.0):
        """The point at its end, reached in steps as long as they stay on the branch; None where
        those above a part of the way do not.

        Parameters
        ----------
        shortest : float
        """
        known, step, system = [(1.0, self.ahead.state)], 1.0, self.system
        while known[-1][0] > 0.0:
            here, last = known[-1]
            place, guess = max(here - step, 0.0), last
            if len(known) > 1:
                part = (place - here) / (here - known[-2][0])
                guess = states.combined(system.contact, [known[-2][1], last], [-part, 1.0 + part])
            try:
                point = system.solve(guess, self.leg.controls, self.leg.load(place))
                lost = point.softest < 0.0 or strayed(system.contact, guess, last,
                                                      point.state) > 0.0
            except NotConverged:
                lost = True
            if not lost:
                known = [*known[-1:], (place, point.state)]
                step *= 2.0
            elif step > shortest:
                step *= 0.5
            else:
                return None
        return point

    def leads_back(self, last):
        """Whether the branch's tangent at its begin leads back to the point at its end."""
        tangent = self.system.along_tangent(self.ahead, self.leg, 1.0, -1.0)
        return self.system.progress(self.ahead.state, last.state, tangent) >= BACK

    def turns(self, last):
        """Whether the load turns back between a point at its end and its begin; NotConverged where
        that is not known."""
        return turns(self.system, self.leg, replace(last, position=0.0), self.ahead)


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
