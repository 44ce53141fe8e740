"""Whether the load of a branch turns between two of its points, what lies on both sides of the fold
there, and where it is, by arc length to one of its steps: not located."""

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
TRIES = 3
"""Places next to a fold, or behind it, that are tried."""
BEHIND = 3
"""Points behind a step along the arc that are kept: a parabola takes these, and no limit point is
located between earlier ones."""
ABOVE = 0.7
"""Part of a fall of the load above whose low a point before the fold has to be: behind the fold is
less energy there, and the fold is near."""


def way(system, leg, first, last):
    """({part of the chord: Point}, bool): the branch between two points, of which the second lies
    beyond the first, as far as it takes to know whether the load turns back on it, and that.

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
            return known, True
        part, slope = _flattest(known)
        if not parts and slope > STEEP * (last.position - first.position):
            return known, False
        part = parts.pop() if parts else part
        nearest = min(known, key=lambda other: abs(other - part))
        if abs(nearest - part) < NEAR:
            return known, system.direction(known[nearest], chord, leg).rate <= 0.0
        known[part] = _between(system, leg, known, part)
    raise NotConverged("the load neither rises nor turns")


def _chord(known):
    """The states at the ends of a way."""
    return known[0.0].state, known[1.0].state


def _between(system, leg, known, part):
    """The point at a part of the chord, foretold by those that are known."""
    chord = _chord(known)
    length, position = part * system.chord_length(*chord), _position(known, part)
    point = system.solve_arc(chord, length, _foretold(system, known, part), position, leg)
    # The guess is made anew: the solve takes much memory, which it would add to.
    if system.missed(_foretold(system, known, part), point.state) > SHARE * system.missed(*chord):
        raise NotConverged("a solve between two points strayed from the branch")
    return point


def _foretold(system, known, part):
    """The state at a part of the chord by the four nearest points that are known."""
    near = _nearest(known, part)
    return system.extrapolate([known[other] for other in near], lagrange_weights(near, part))


def _position(known, part):
    """The position there by the same points."""
    near = _nearest(known, part)
    return float(lagrange_weights(near, part) @ [known[other].position for other in near])


def _nearest(known, part):
    """Places of the four nearest points that are known, in order."""
    return sorted(sorted(known, key=lambda other: abs(other - part))[:4])


def _polynomial(known, places):
    """The polynomial through the positions of points at places."""
    return np.polynomial.Polynomial.fit(places, [known[place].position for place in places],
                                        len(places) - 1)


def _flattest(known):
    """Where the polynomial through positions at places is flattest, and its slope there."""
    slope = _polynomial(known, sorted(known)).deriv()
    parts = np.linspace(0.0, 1.0, 129)
    return min(zip(parts.tolist(), slope(parts).tolist()), key=lambda pair: pair[1])


def sides(system, leg, known):
    """(Point, Point): at one load, a point next to a way's fold, on the side that leads to it, and
    the one behind it, where the load rises again.

    The load is that of the way's begin, if it is as far above the low behind the fold as is asked
    for, else one nearer to the fold's, and none that the way does not come to again.

    Parameters
    ----------
    system, leg : System, Leg
    known : {part: Point} of a `way` whose load turns; points are added to it

    Raises
    ------
    NotConverged : where a solve fails, or the load turns too little to tell
    """
    for _ in range(TRIES):
        places = sorted(known)
        loads = np.array([known[place].position for place in places])
        fall = int(np.argmax(np.append(np.diff(loads), 0.0) <= 0.0))
        turned = fall < len(loads) - 1
        if turned:
            low = fall + 1 + int(np.argmin(loads[fall + 1:]))
            above = loads[low] + ABOVE * (loads[fall] - loads[low])
            for place in (places[max(fall - 1, 0)], places[fall]):
                before = known[place]
                if not above < before.position <= loads[low:].max():
                    continue
                if (place < places[fall] or place == 0.0
                    or system.direction(before, _chord(known), leg).rate > 0.0):
                    return before, _behind(system, leg, known, places[low], before.position)
        for part in _extremes(known)[:1 if turned else 2]:
            known[part] = _between(system, leg, known, part)
    raise NotConverged("the load turns in a loop that is too small to tell")


def _extremes(known):
    """Where the load is nearly at its first peak, and where at its low behind it, by the polynomial
    through positions at places."""
    parts = np.linspace(0.0, 1.0, 513)
    loads = _polynomial(known, sorted(known))(parts)
    falls = np.flatnonzero(np.diff(loads) <= 0.0)
    if not len(falls):
        raise NotConverged("the load turns in a loop that is too small to tell")
    peak = loads[falls[0]]
    low = falls[0] + int(np.argmin(loads[falls[0]:]))
    rising = int(np.argmax(loads >= peak - 0.5 * (1.0 - ABOVE) * (peak - loads[low])))
    return float(parts[rising]), float(parts[low])


def _behind(system, leg, known, low, position):
    """The point at a position on the way behind a low of the load; next to it, it takes a point of
    the way nearby."""
    for tried in range(TRIES):
        places = [place for place in sorted(known) if place >= low]
        after = max(1, next(k for k, place in enumerate(places)
                            if known[place].position >= position))
        parts = np.linspace(places[after - 1], places[after], 65)
        loads = _polynomial(known, _nearest(known, places[after]))(parts)
        part = float(parts[np.argmin(np.abs(loads - position))])
        if tried:
            known[part] = _between(system, leg, known, part)
        guess = _foretold(system, known, part)
        try:
            point = system.solve(guess, leg.controls, leg.load(position))
        except NotConverged:
            continue
        if (point.softest < 0.0 or system.missed(guess, point.state)
                > SHARE * system.missed(*_chord(known))):
            continue
        return point.changed(position=position)
    raise NotConverged("no solve succeeded behind a fold")


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

    behind = BEHIND

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
        trail = self._bracketed(trail, self.behind)
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
