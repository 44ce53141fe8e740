"""What lies in a bracket of loads that a step did not pass: motion beyond it, and the way back, on
coarser grids where these serve."""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from ..contact import combining, places, states
from ..contact.acceptance import strayed
from ..contact.energies import weights
from ..contact.interface_work import released, straight
from ..continuation.points import Crossing, Leg, NotConverged, NoWayBack
from ..continuation.turning import sides, way
from ..dynamics import jumps
from ..solvers.snes import WARM
from .coarse_motion import BESIDE, coarsely, corrected, with_works

SAME = 1e-3
"""Largest way of a node, ranges of the law, from the state that lies behind a bracket to the one
before it, up to which both are one: no fold lies in between."""
SHORTEST = 0.5
"""Part of a bracket below which steps on the way back through it are not halved."""
CLOSE = 0.1
"""The same of steps towards a fold in it."""
BEGUN = 0.2
"""How far along the branch's tangent motion out of a bracket begins at most, ranges where the law
acts: next to a fold that is its mode, along which a body hardly moves at first."""
NARROWER = 2
"""How many narrower brackets in each other are tried where the state beyond one does not lead back
to before it."""


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
        coarse.release()

        def fine(point, most):
            return corrected(system, level.prolonged(point.state), controls, at, most)

        try:
            before = fine(found.before, WARM) if found.begin else last
        except NotConverged as error:
            # The finer grid's fold may lie before that place.
            raise NoWayBack(f"the branch ends within a refused step ({error})") from None
        behind = found.behind and _lower(system, before, with_works(fine(found.behind, BESIDE),
                                                                    found.behind))
        system.release()  # its memory is that of states until a solve asks for it
        ahead = level.prolonged(found.ahead)
        if behind is not None:
            # Both are as far from the finer grid's own states.
            behind_there = level.prolonged(found.behind.state)
            ahead = combining.combined(system.contact, [ahead, behind.state, behind_there],
                                       [1.0, 1.0, -1.0])
        return found._replace(before=before, behind=behind, ahead=ahead)

    return (coarsely(system, controls, last.state, motion)
            or _crossed(system, last, load, beyond, where, NARROWER))


def _crossed(system, last, load, beyond, where, narrower):
    """The same on the system's own grid, with as many narrower brackets within each other."""
    ahead = jumps.settle(system, lambda: _begun(system, last, beyond), last.controls, beyond, where,
                         last.state)

    def told(begin, before):
        at = load + begin * (beyond - load)
        behind = _lower(system, before, _back(system, ahead, at))
        return Crossing(begin, 1.0, before, behind and _with_works(system, (last, before),
                                                                   (ahead, behind)), ahead.state)

    try:
        return told(0.0, last)
    except NoWayBack:
        if not narrower:
            raise
    found = _along(system, last, ahead)
    if found is not None:
        return found
    begin, end, before = _nearest(system, last, load, beyond)
    if begin > 0.0:
        with suppress(NoWayBack):
            return told(begin, before)
    # Motion may have led past more than one fold.
    found = _crossed(system, before, load + begin * (beyond - load), load + end * (beyond - load),
                     where, narrower - 1)
    width = end - begin
    return found._replace(begin=begin + width * found.begin, end=begin + width * found.end)


def _begun(system, last, beyond):
    """The state beside a point from which motion under the load ``beyond`` begins: half of the way
    that the tangent leads there, at most. What lies at its end is an equilibrium, an unstable one
    if the point is, as under a force that has just taken over."""
    contact, leg = system.contact, _leg(last, beyond)
    ahead = system.along_tangent(last, leg, 0.0, 1.0)
    far = max(states.missed(contact, last.state, ahead),
              states.missed(contact, last.state, ahead, largest=True) / 3.0)
    part = BEGUN / max(far, 2.0 * BEGUN)
    return combining.combined(contact, [ahead, last.state], [part, 1.0 - part])


def _leg(point, load):
    """The leg from a point to a load."""
    moving = int(np.argmax(np.abs(load - point.load)))
    return Leg(0, point.controls, point.load, load, moving, 1.0, 1.0, 1.0)


def _along(system, last, ahead):
    """What the branch between a point and one beyond it tells of their bracket: a `Crossing`; None
    where it tells nothing, or of more than one fold."""
    try:
        leg, known, turned = _way(system, last, ahead)
        if not turned:
            return Crossing(0.0, 1.0, last, None, ahead.state)
        before, behind = sides(system, leg, known)
        del known  # as much memory as the next way takes
        behind = _lower(system, before, behind)
        if behind is not None and _way(system, behind, ahead)[2]:
            return None
    except (NotConverged, NoWayBack):
        return None
    return Crossing(before.position, 1.0, before, behind and _with_works(
        system, (last, before), (ahead, behind)), ahead.state)


def _with_works(system, begun, ended):
    """The point behind a jump with the works of the motion through its bracket; that on the
    interface is from the jump's own begin to its own end.

    Parameters
    ----------
    system : Corrector
    begun, ended : pairs of points: where the motion begins and the jump does, where each ends
    """
    contact, (ahead, behind) = system.contact, ended
    ways = sum(sign * straight(contact, first.state, last.state)
               for sign, (first, last) in ((-1.0, begun), (1.0, ended)) if first is not last)
    done = float(ways @ weights(contact, len(ways)))
    return with_works(behind, replace(ahead, jump_work=ahead.jump_work + done))


def _way(system, first, last):
    """The leg from one point to another, and the `way` between both."""
    leg = _leg(first, last.load)
    return leg, *way(system, leg, replace(first, position=0.0), replace(last, position=1.0))


def _lower(system, before, behind):
    """A point behind a jump; None where it is the one before it.

    Raises
    ------
    NoWayBack : where it has more energy, or nothing is released on the straight way to it, so that
        under its load it is the other state to which a body would jump
    """
    contact = system.contact
    if states.missed(contact, before.state, behind.state, largest=True) < SAME:
        return None
    free = released(contact, before.state, behind.state)
    if not free @ weights(contact, len(free)) > 0.0:
        raise NoWayBack("the branch beyond a refused step leads back to more energy")
    return behind


def _back(system, ahead, load):
    """The point at a load on the branch of one beyond it, in steps as long as they stay on it.

    Parameters
    ----------
    system, ahead : Corrector, and the Point
    load : where the way ends
    """
    known, step = [(0.0, ahead)], 1.0
    while known[-1][0] < 1.0:
        here = known[-1][0]
        point = _stepped(system, known, here + step, ahead.load, load)
        if point is not None:
            known, step = [*known[-1:], (here + step, point)], min(2.0 * step, 1.0 - here - step)
        elif step > SHORTEST:
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
        guess = combining.combined(system.contact, [known[-2][1].state, guess], [-part, 1.0 + part])
    try:
        point = system.solve(guess, last.controls, begin + place * (end - begin))
    except NotConverged:
        return None
    lost = point.softest < 0.0 or strayed(system.contact, guess, last.state, point.state) > 0.0
    return None if lost else point
