"""Branches of equilibria along a path of legs: its points one after the other, with their events.

What is solved, and how, is the business of the system that `branch` is given
(``continuation.system.System``); here a state is something that the system combines.
"""

from dataclasses import replace

from .events import further_events, pulled_off, with_events
from .natural import NaturalSteps
from .points import NoEquilibrium
from .predictors import PREDICTORS


def branch(system, start, legs, *, predictor=PREDICTORS["edge"], at_fold="jump", stops=(),
           history=(), certify=lambda point: point, at_bifurcation="pass", stepper=NaturalSteps):
    """Iterate over the converged points of a load path.

    Parameters
    ----------
    system : System
    start : function () -> Point, the first point with what it cost, for a path without ``history``
    legs : functions (last point) -> Leg or None (nothing to do), one a leg
    predictor : Predictor
    at_fold, at_bifurcation : options ``-continuation_*``
    stops : names of events that end the path
    history : the last points of an interrupted path, oldest first
    certify : function (Point) -> Point that says whether it is stable (`system.Stability`)
    stepper : class of the steps along a leg

    Raises
    ------
    NotConverged, NoEquilibrium : after the points before the failure have been handed out
    """
    emitted, ends = list(history), {*stops, *(("fold",) if at_fold == "stop" else ())}
    if emitted and emitted[-1].event in ends:
        return
    for point in _not_archived(system, emitted) if emitted else [start()]:
        emitted.append(point)
        yield point
        if point.event in stops:
            return
    for number, make_leg in enumerate(legs, start=1):
        leg = None if number < emitted[-1].leg else make_leg(emitted)
        if leg is None:
            continue
        steps = stepper(system, leg, stepper.past(emitted, number), predictor, at_fold, certify,
                        at_bifurcation)
        for point in _along(steps, emitted, stops):
            yield point
            if point.event in stops:
                return
        if steps.stopped:
            return


def _check_held(system, point, leg):
    """NoEquilibrium where a leg pulls a body that nothing holds."""
    away = system.pulled_away(point, leg)
    if away:
        raise NoEquilibrium(f"no equilibrium at {system.told(leg.controls, leg.load(1.0))}: {away}")


def _not_archived(system, emitted):
    """Further events at the load of the last point, without which it may have been archived."""
    last = replace(emitted[-1], spent=dict.fromkeys(system.account(), 0))
    return list(further_events(emitted[-2] if len(emitted) > 1 else None, last))


def _along(steps, emitted, stops):
    """The points of a leg with their further events, each the last one that was ``emitted``; a
    pull-off that is to end the path ends it here."""
    _check_held(steps.system, emitted[-1], steps.leg)
    try:
        for arrived in steps:
            for point in with_events(emitted[-1], arrived):
                emitted[:] = [point]
                yield point
    except NoEquilibrium:
        if not ("pull_off" in stops and pulled_off(emitted[-1])):
            raise
        if emitted[-1].forces[0] > 0.0:
            steps.system.log("the path ends at a fold of kind pull_off, but the normal force still "
                             "presses the body there: it slides away in contact")
        steps.stopped = True
