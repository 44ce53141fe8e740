"""A neighbour of the only point of a leg that is known: from two a branch can be followed."""

from dataclasses import replace

from .load_steps import SHARE
from .points import NotConverged

WITHIN = 0.1
"""Part of a refused step within which a neighbour is looked for where none is farther away."""
NEAR = 0.1
"""Ranges of the law within which one is looked for by arc length."""
SHORTER = 3
"""Arc lengths, each a quarter of the last, at which it is."""


def neighboured(system, leg, here, last, step, refused):
    """[(position, Point), ...] of a point and a neighbour of it, in the order of the branch.

    By a step of the load along the tangent; where that fails, by arc length: the load may turn on
    either side of the point within less than any step of it, as between folds of a grid.

    Parameters
    ----------
    system, leg : System, Leg
    here, last : position and Point
    step : of the position, tiny
    refused : of the position, a step that failed

    Raises
    ------
    NotConverged : where no neighbour is found
    """
    def at(tiny):
        guess = system.along_tangent(last, leg, here, tiny)
        return here + tiny, replace(system.solve(guess, leg.controls, leg.load(here + tiny)),
                                    position=here + tiny)

    # Backwards, since the trouble may be nearer than the step; there may be more behind.
    for tiny in (-step, step):
        try:
            neighbour = at(tiny)
        except NotConverged:
            continue
        return [neighbour, (here, last)] if tiny < 0.0 else [(here, last), neighbour]
    try:
        return [_behind(system, leg, here, last, step), (here, last)]
    except NotConverged:
        return [at(-min(step, WITHIN * refused)), (here, last)]


def _behind(system, leg, here, last, step):
    """Place and point behind another one by arc length, as far as a step of the position leads at
    most."""
    back = replace(last, state=system.along_tangent(last, leg, here, -step))
    part = min(1.0, NEAR / max(system.missed(last.state, back.state), 1e-300))
    error = NotConverged("no neighbour lies along the branch's tangent")
    for _ in range(SHORTER):
        guess = system.extrapolate([last, back], [1.0 - part, part])
        try:
            point = system.solve_arc((last.state, guess), system.chord_length(last.state, guess),
                                     guess, here - part * step, leg)
        except NotConverged as failure:
            error = failure
        else:
            aside, moved = system.ways(guess, last.state, point.state)
            if aside <= SHARE * moved:
                return point.position, point
        part *= 0.25
    raise error
