"""What follows a loss of stability: motion aside of a branch, along the mode that grows."""

from dataclasses import replace

from .points import NoEquilibrium, NotConverged

APART = 0.3
"""Part of the kick by which a motion has to end away from a branch not to have led back to it."""
JUMPED = 0.5
"""Part of the distance from a branch to what a motion reached within which the same solution is
still next to the branch at the bifurcation: it begins there, and there is no jump."""
KICKS = (1.0, -1.0, 5.0, -5.0)
"""How far along the mode, in parts of the kick that is asked for, a motion away from the branch
begins; the next if it leads back."""


def followed(system, stability, leg, critical, beyond):
    """The stable point to which a disturbance leads where a branch has lost its stability, and None
    if it leads nowhere else.

    Motion begins next to the point ``beyond``, which is not stable any more: at the bifurcation
    itself it would be infinitely slow. Where it leads to a state that is another one at the
    bifurcation's load, too, that is a jump there (event ``jump``); else it is the branch that
    begins there.

    Raises NotConverged or NoEquilibrium, the first that a motion raised, where none leads to
    another equilibrium.

    Parameters
    ----------
    system, stability, leg : System, Stability (`system.Stability`), Leg
    critical : Point, the bifurcation
    beyond : Point of the branch behind it, not stable
    """
    where = (f"at {system.told(leg.controls, leg.load(beyond.position))}, off the branch "
             "that has lost its stability")
    failure = None
    for kick in KICKS:
        start = system.kicked(beyond, stability.aside(replace(beyond, mode=critical.mode)), kick)
        try:
            reached = system.settle(start, leg.controls, leg.load(beyond.position), where)
        except (NotConverged, NoEquilibrium) as error:
            # A body that leaves to one side may stay on the other.
            system.log(f"{error}; trying again from elsewhere")
            failure = failure or error
            continue
        if system.missed(beyond.state, reached.state) >= APART * system.missed(beyond.state, start):
            return _branched(system, stability, leg, critical, beyond, (reached, kick))
    if failure is not None:
        raise failure
    system.log(f"the motion {where} led back to it")
    return None


def _branched(system, stability, leg, critical, beyond, found):
    """What a motion beside a branch reached: a point of another branch that begins at the
    bifurcation, or a jump there.

    A jump ends where motion under the bifurcation's load leads to: what motion beyond it passes
    need not be all that is on the way, and what is stable there need not be so here.

    Parameters
    ----------
    system, stability, leg, critical, beyond : as of `followed`
    found : (Point, kick) that motion reached under the load of ``beyond``, and how it began
    """
    (reached, kick), load = found, leg.load(critical.position)
    beside = f"at {system.told(leg.controls, leg.load(beyond.position))}, off the bifurcation"
    reached = replace(reached, leg=leg.number, position=beyond.position, step=leg.initial)
    try:
        there = system.solve(reached.state, leg.controls, load)
        if system.missed(critical.state, there.state) < JUMPED * system.missed(beyond.state,
                                                                               reached.state):
            return _rested(system, stability, reached, beside)
    except NotConverged:
        there = None
    where = f"at {system.told(leg.controls, load)}, off the bifurcation"
    start = system.kicked(critical, stability.aside(critical), kick)
    try:
        end = system.settle(start, leg.controls, load, where, critical.state)
        if system.missed(critical.state, end.state) >= APART * system.missed(critical.state, start):
            there = end
    except (NotConverged, NoEquilibrium) as error:
        system.log(f"{error}; taking what motion beyond it leads to")
    if there is None:
        return _rested(system, stability, reached, beside)
    return replace(settled(system, stability, there, where), leg=leg.number,
                   position=critical.position, step=leg.initial, event="jump")


def _rested(system, stability, reached, where):
    """A point of a branch beside, `settled`: where several modes lose their stability at once,
    motion along one of them may end where another one grows."""
    point = settled(system, stability, reached, where)
    return replace(point, leg=reached.leg, position=reached.position, step=reached.step)


def settled(system, stability, point, where):
    """The end of a jump, gone on from along its least stable mode while it is marked as unstable;
    at most three times.

    The motion of an even state is even, but what is not even may grow: only the mark tells.

    Parameters
    ----------
    system, stability : System, Stability (`system.Stability`)
    point : Point, the end of the jump
    where : str, what messages say of the place
    """
    for _ in range(3):
        point = stability(point)
        if point.unstable_modes <= 0:
            break
        several = point.unstable_modes > 1
        system.log(f"the motion {where} ended in an unstable state: going on along "
                   + (f"the least stable of its {point.unstable_modes} modes, while others may "
                      "lead elsewhere" if several else "its mode"))
        start = system.kicked(point, stability.aside(stability.critical(point, 0)[1]), 1.0)
        found = system.settle(start, point.controls, point.load, where, point.state)
        point = replace(found, jump_work=point.jump_work + found.jump_work,
                        viscous_work=point.viscous_work + found.viscous_work)
    return point
