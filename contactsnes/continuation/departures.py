"""How a fold is left: motions from states beside it, in turn, until one leads to another
equilibrium."""

from contextlib import suppress
from itertools import chain

from .points import NoEquilibrium, NotConverged

KICKS = (1.0, 3.0, -1.0, -3.0, 10.0, 30.0, -10.0, -30.0)
"""How far beyond a fold, in parts of the kick that is asked for, the motion of a jump begins; the
next if it leads back.

Backwards, too: an unstable branch, which steps may have reached, is left on that side.
"""
AHEAD = (0.01, 0.1, 1.0)
"""Where all of these led back: how far beyond a fold, in parts of a step, the load is under which
motion leads to a branch that may be nearer than they are, next to a nearly broken pitchfork."""
NEXT, LEAST = 0.9, 2e-3
"""Part of the way to that branch at which motion to it begins, and way, ranges of the law, below
which solves do not tell it from the fold: two branches meet there."""
MEETING = 0.1
"""Ranges of the law that the other one has moved by at most, from there to the load beyond."""

APART = 0.5
"""Part of the kick by which a motion has to end away from its fold not to have led back to it."""
FORWARD = 0.05
"""The same in the direction of the kick, for an edge that a coarse grid pins moves on by a node."""
STILL = 0.01
"""Part of the kick within which a motion that ends where it began has not moved: what drives it is
below what solves leave of their balances, and a body on its way out looks at rest anywhere."""
MISHAPS = 5
"""Motions beside a fold that may end in no equilibrium before the jump is given up."""


def starts(system, fold, beyond):
    """Functions that return states from which the motion of a jump begins, in the order in which to
    try them.

    Parameters
    ----------
    system : System
    fold : Point
    beyond : State, of the branch behind the fold
    """
    kicks = [lambda kick=kick: system.kicked(fold, beyond, kick) for kick in KICKS]
    near = system.within_range(fold)
    return kicks if near is None else [lambda: near, *kicks]


def foreknown(system, leg, place, last):
    """The fold at a place of a leg that no search has to find (`System.end_of_attraction`), or
    None: none where motion from beside it leads back, as of what glides where friction falls, if
    ever so little, as slip is taken back.

    Parameters
    ----------
    system, leg : System, Leg
    place : of the last point in the leg
    last : Point
    """
    fold = system.end_of_attraction(last, leg, place)
    if fold is None or fold.fold_kind != "sliding":
        return fold
    near, where = system.within_range(fold), f"at {system.told(leg.controls, fold.load)}"
    try:
        found = system.settle(near, leg.controls, fold.load, where, fold.state)
    except (NotConverged, NoEquilibrium):
        return fold
    kick = system.missed(fold.state, near)
    return fold if system.missed(fold.state, found.state) > APART * kick else None


def jumped(system, leg, fold, starts, where, check_end):
    """The equilibrium at a fold's load to which motion leads from the first start that does not
    lead back. A body that leaves, from one start, says nothing of others, nor of other loads.

    Parameters
    ----------
    system, leg, fold : System, Leg, Point
    starts : functions () -> State
    where : str, what messages say of the place
    check_end : function () that raises NoEquilibrium if motion shows that the leg's end has none

    Raises
    ------
    NoEquilibrium : as of ``check_end``
    NotConverged : where no motion leads to another equilibrium
    """
    if fold.controls[leg.moving] == "force" and fold.fold_kind != "jump_in" and not fold.tangents:
        # Under the load of a plateau a body that is on its way out moves hardly, or for ever.
        check_end()
    failures = []
    for state in chain((start() for start in starts), _nearest(system, leg, fold, where)):
        try:
            point = system.settle(state, leg.controls, fold.load, where, fold.state)
        except (NotConverged, NoEquilibrium) as error:
            if not failures:
                check_end()
            failures.append(str(error))
            if len(failures) == MISHAPS:
                break
            system.log(f"{error}; trying again from elsewhere")
            continue
        if _elsewhere(system, fold.state, state, point.state, check_end):
            return point
        system.log(f"the motion {where} led back to it; trying again from farther away")
    if not failures:
        check_end()
        failures.append("the motion led back")
    raise NotConverged(f"no other equilibrium was reached {where}: {failures[0]}")


def _nearest(system, leg, fold, where):
    """Yield the state at `NEXT` of the way from a fold to the branch at its load to which motion
    under a load beyond it leads, if that is one; one on that branch where it goes through the fold,
    as that of even states does where uneven ones end."""
    for part in AHEAD if fold.tangents else ():
        position = fold.position + part * leg.initial
        if position > 1.0:
            return
        with suppress(NotConverged, NoEquilibrium):
            beyond = system.settle(fold.state, leg.controls, leg.load(position), where)
            point = system.solve(beyond.state, leg.controls, fold.load)
            if point.softest < 0.0:
                continue
            if system.missed(fold.state, point.state) > LEAST:
                yield system.extrapolate([fold, point], [1.0 - NEXT, NEXT])
            elif system.missed(fold.state, beyond.state) < MEETING:
                yield point.state


def _elsewhere(system, fold, start, found, check_end):
    """Whether a motion from a start beside a fold led on; one that ended where it began only where
    ``check_end`` raises nothing."""
    kick = system.missed(fold, start)
    led = (system.missed(fold, found) > APART * kick
           or system.progress(fold, start, found) > FORWARD)
    if led and system.missed(start, found) <= STILL * kick:
        check_end()
    return led
