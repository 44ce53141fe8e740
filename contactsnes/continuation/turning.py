"""Whether the load of a branch turns between two of its points, and where, found by arc length to
one of its steps: not located."""

from dataclasses import replace

import numpy as np

from . import departures
from .folds import SHARE, SHORT, FoldSearch
from .points import NotConverged, lagrange_weights

BRACKET = 0.25
"""Part of a leg's first step, and of a fortieth of it, within which a refused step is taken for a
fold, and with which the path goes on behind one."""

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


def starts(system, fold, beyond):
    """States from which the motion of the jump begins: first that beyond the fold, where the load
    is below the fold's, so that the state without stability lies in between.

    Parameters
    ----------
    system, fold, beyond : as of `departures.starts`
    """
    return [lambda: beyond, *departures.starts(system, fold, beyond)]


class TurnSearch(FoldSearch):
    """A search along the arc that ends as soon as the load falls: the fold is the last point
    before, known to the peak of the parabola through the three points around it. Parameters as of
    `FoldSearch`."""

    def search(self, error, refused=np.inf):
        """As of `FoldSearch`; where the branch goes on past the refused step, so do steps of the
        load."""
        self.initial = min(self.initial, refused)
        return super().search(error, refused)

    def _solved(self, chord, guess, position):
        """As of `FoldSearch`, but what its linear systems tell of modes is left aside: where a
        chord is nearly across the load's own waves, that they eliminate, they tell of these.
        Natural steps and motion tell what is stable."""
        return replace(super()._solved(chord, guess, position), softest=np.nan)

    def _locate(self, trail):
        """Fold, state beyond it, and trail up to it, as of `FoldSearch`; the first two are None
        where the load rises on."""
        trail = self._bracketed(trail)
        if trail[-1][0] >= trail[-2][0]:
            return None, None, trail
        if self._returns(trail):
            return None, None, trail[:-1]
        place, fold = trail[-2]
        return (replace(fold, leg=self.leg.number, step=BRACKET * min(self.leg.initial, SHORT),
                        fold_precision=self._precision(trail[-3:])), trail[-1][1].state,
                trail[:-1])

    def _precision(self, trail):
        """By how much the load may rise beyond the middle of three points, relative to itself:
        twice what the parabola through them does."""
        moving = self.leg.moving
        arc, slopes = self._slopes(trail)
        rise = 0.5 * slopes[1] ** 2 * (arc[2] - arc[1]) / max(slopes[1] - slopes[2], 1e-300)
        load = abs(self.leg.load(trail[1][0])[moving])
        return max(2.0 * rise * abs(self.leg.direction[moving]) / max(load, 1e-3),
                   np.finfo(float).eps)
