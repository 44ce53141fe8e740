"""Steps between whose ends, both stable, a mode may be unstable, or a small jump lie."""

import math

from .bifurcations import solved
from .points import NotConverged

SOFT = 0.05
LONG, BELOW = 0.3, 0.2
PROBES = 2
"""Softest Ritz value at the rate of the last step, and way in ranges of the law, from which on a
step is asked in between (the second where that value is below zero), and how often: a mode that
softens so fast may be unstable there."""
LESS = 0.75
"""Part of its value below which the softest mode has to come by the end of the step at that rate:
one that is as soft all along a path, as of a sharp law it is, does not lose its stability."""
SOFTENED, FURTHER = 0.8, 3.0
"""Part of its value below which the softest mode has to come in a first step, which no rate
foretells, and way of such a step, ranges of the law, from which on it need not."""
SHORT = 0.05
SOFTER = 0.7
BACK = 0.5
"""Way, and part of the softest value at its begin, from which on the tangent at its end is asked,
and what part of the way that has to lead back."""


def probe(system, leg, history, point):
    """NotConverged where a mode is stable at both ends of a step, but a small jump or an unstable
    part lies in between.

    Where a mode is hardly stable any more (`Point.softest`), the tangent back tells of a jump, and
    where it would not be at the rate of the last step, solves in between tell whether it loses its
    stability and regains it; where they find it hardly stable, the tangent there has to lead back,
    too. In a long step which no rate foretells, as a first one, they are asked where it has
    softened, or was hardly stable where the step began, in a very long one always; one at which it
    is hardly stable, and less so than at both ends, or that hardly leads back, will do.

    Parameters
    ----------
    system, leg : as of `between`
    history : [(position, Point), ...] of the leg, before the point
    point : Point
    """
    (here, last), (softened, ahead, earlier) = history[-1], _softening(system, history, point)
    if not softened or min(last.softest, point.softest) < 0.0:
        return
    known, far = {here: last, point.position: point}, system.missed(last.state, point.state)
    if far > SHORT:
        _lead_back(system, leg, last, here, point, point.position)
    unknown = math.isnan(ahead)
    least = min(SOFT, point.softest, LESS * last.softest) if unknown else 0.0
    softens = unknown or ahead < min(SOFT, LESS * last.softest)
    for _ in range(PROBES if softens and far > (BELOW if ahead < 0.0 else LONG) else 0):
        places = sorted(known)
        pair = min(zip(places, places[1:]), key=lambda pair: sum(known[place].softest
                                                                 for place in pair))
        position = 0.5 * sum(pair)
        known[position] = solved(system, leg, earlier | known, position, far)
        if known[position].softest < least:
            raise NotConverged("a mode that is stable at both ends of the step is "
                               f"{'hardly so' if known[position].softest > 0.0 else 'not'} at "
                               f"{system.told(leg.controls, leg.load(position))}")
        if unknown or known[position].softest < SOFT:
            _lead_back(system, leg, known[pair[0]], pair[0], known[position], position)


def _lead_back(system, leg, last, here, point, position):
    """NotConverged where the tangent at a point hardly leads back to one before it, of the place
    ``here``."""
    back = system.along_tangent(point, leg, position, here - position)
    if system.progress(point.state, last.state, back) < BACK:
        raise NotConverged("a jump may lie in the step: the branch at "
                           f"{system.told(leg.controls, leg.load(position))} hardly leads back")


def _softening(system, history, point):
    """(whether a mode may be unstable in a step, how soft it were at its end at the rate of the
    last step, nan where that is not known, the point before the step, if that is of the same
    branch, by its place); as of `probe`."""
    here, last = history[-1]
    lower = point.softest < (SOFTER if len(history) > 1 else SOFTENED) * last.softest
    if len(history) < 2:
        far = system.missed(last.state, point.state)
        # (of a body that slides as a whole no mode is known)
        return ((lower or last.softest < SOFT) and far > LONG
                or far > FURTHER and last.softest + point.softest > 0.0), math.nan, {}
    before, first = history[-2]
    ahead = last.softest + (last.softest - first.softest) * (point.position
                                                             - here) / (here - before)
    return (ahead < SOFT or point.softest < SOFT or lower, ahead,
            {before: first} if first.controls == last.controls else {})
