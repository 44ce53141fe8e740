"""Whether the load turns on a branch between two of its points."""

import numpy as np

from .load_steps import SHARE
from .points import NotConverged, lagrange_weights

NEAR = 1.0 / 32.0
"""Part of a way within which places on it are one."""
STEEP = 0.2
"""Slope of the load along a way, over its mean, from which on it surely rises."""
MOST = 9
"""Places of a way at which the branch is solved for at most."""


def turns(system, leg, first, last):
    """Whether the load turns back on the branch between two points, of which the second lies
    beyond the first.

    The branch is solved for at places on the chord between the two, where the load is one more
    unknown: a half, the quarters, and where the polynomial through all of them is flattest.

    Parameters
    ----------
    system : System
    leg : Leg
    first, last : Point, with their positions in the leg

    Raises
    ------
    NotConverged : where a solve fails, or ends far from what the others foretell
    """
    chord, known = (first.state, last.state), {0.0: first, 1.0: last}
    parts = [0.75, 0.25, 0.5]
    while len(known) < MOST:
        if min(np.diff([known[part].position for part in sorted(known)])) <= 0.0:
            return True
        part, slope = _flattest(known)
        if not parts and slope > STEEP * (last.position - first.position):
            return False
        part = parts.pop() if parts else part
        nearest = min(known, key=lambda other: abs(other - part))
        if abs(nearest - part) < NEAR:
            return system.direction(known[nearest], chord, leg).rate <= 0.0
        known[part] = _between(system, leg, chord, known, part)
    raise NotConverged("the load neither rises nor turns")


def _between(system, leg, chord, known, part):
    """The point at a part of a chord, foretold by the four nearest that are known."""
    near = sorted(sorted(known, key=lambda other: abs(other - part))[:4])
    weights = lagrange_weights(near, part)
    points = [known[other] for other in near]
    guess = system.extrapolate(points, weights)
    position = float(weights @ [point.position for point in points])
    point = system.solve_arc(chord, part * system.chord_length(*chord), guess, position, leg)
    if system.missed(guess, point.state) > SHARE * system.missed(*chord):
        raise NotConverged("a solve between two points strayed from the branch")
    return point


def _flattest(known):
    """Where the polynomial through positions at places is flattest, and its slope there."""
    places = sorted(known)
    slope = np.polynomial.Polynomial.fit(places, [known[part].position for part in places],
                                         len(places) - 1).deriv()
    parts = np.linspace(0.0, 1.0, 129)
    return min(zip(parts.tolist(), slope(parts).tolist()), key=lambda pair: pair[1])
