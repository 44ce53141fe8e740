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
    system : solves, extrapolates and jumps (``Corrector``)
    start : function () -> Point, the first point with what it cost, for a path without ``history``
    legs : functions (last point) -> Leg or None (nothing to do), one a leg
    predictor : Predictor
    at_fold, at_bifurcation : options ``-continuation_*``
    stops : names of events that end the path
    history : the last points of an interrupted path, oldest first
    certify : function (Point) -> Point that says of the points of legs whether they are stable
        (``Stability``)
    stepper : class of the steps along a leg

    Raises
    ------
    NotConverged, NoEquilibrium : after the points before the failure have been handed out
    """
    emitted = list(history)
    if emitted and (emitted[-1].event in stops or (at_fold == "stop"
                                                   and emitted[-1].event == "fold")):
        return
    if emitted:
        # A point may have been archived without the further events at its load.
        last = replace(emitted[-1], spent=dict.fromkeys(system.account(), 0))
        fresh = list(further_events(emitted[-2] if len(emitted) > 1 else None, last))
    else:
        fresh = [start()]
    for point in fresh:
        emitted.append(point)
        yield point
        if point.event in stops:
            return
    for number, make_leg in enumerate(legs, start=1):
        if number < emitted[-1].leg:
            continue
        leg = make_leg(emitted)
        if leg is None:
            continue
        steps = stepper(system, leg, stepper.past(emitted, number), predictor, at_fold, certify,
                      at_bifurcation)
        try:
            for arrived in steps:
                previous = emitted[-1]
                for point in with_events(previous, arrived):
                    emitted = [*emitted[-5:], point]
                    yield point
                    if point.event in stops:
                        return
        except NoEquilibrium:
            if "pull_off" in stops and pulled_off(emitted[-1]):
                return
            raise
        if steps.stopped:
            return
