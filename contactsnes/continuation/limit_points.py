"""Limit points of the load along a branch, by a bracketed root of d(load)/d(length)."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .points import Direction, NotConverged, Point, lagrange_weights

FOLD_TOLERANCE = 1e-8
"""Relative accuracy in the load to which a fold is located."""
MOST = 50
"""Most points that a search makes: enough to halve its bracket to rounding."""
FAILURES = 6
"""Solves that may fail in a search; the later ones are tried nearer to what is known. A single one
where slip fronts move too far within the bracket for its points to be foretold: a shorter one
serves better."""
STEADY = 0.25
"""Least bend of a branch at a fold, over its largest, while an edge passes a node of a grid that
resolves it."""
CORNER = 30.0
"""How much faster than on average over its bracket a slope must change to be that of a corner."""


PASSED = 1e-4
"""Load, relative to itself, by which an end of a bracket has more than the fold found in it where
that is another one: what solves leave of a balance that hardly holds a body may be thousands of
times as much as a fold's own load is known to."""
MISSED, SHARE = 0.1, 0.5
"""Ranges of the law, and part of the bracket, that a solve in it may end from its prediction."""
STEEPER = 100.0
"""How much steeper than at the ends that a bracket began with a slope may become: next to a place
where branches meet, as that from which uneven states go on as even ones, it grows without end, and
tells of no fold."""
NEARLY = 0.25
"""Least slope of a cubic within a step, over its mean, with which it may turn where a longer
polynomial would."""
LEVEL = 1e-4
"""Part of a leg below which the load levels off in a step whose end is flatter than all of it."""


class BracketEnd(NamedTuple):
    """A point with its place on the chord of a bracket and the branch's direction there."""

    place: float
    point: Point
    direction: Direction

    @property
    def slope(self):
        """d(position)/d(place)."""
        return self.direction.rate


class LimitPoint:
    """The limit point of the load between two points of a branch, one on either side of it.

    The branch is parametrised by its projection on the chord between the two, where
    d(load)/d(place) is known exactly. The law has corners where nodes leave contact, where that
    slope jumps: such a corner may be the limit point itself.

    Parameters
    ----------
    system : System
    leg : Leg
    before, beyond : points of the branch
    heading : 1 or -1, where the load goes from a fold before, whose own slope is rounding; else its
        slope there says it
    """

    def __init__(self, system, leg, before, beyond, heading=0.0):
        self.system = system
        self.leg = leg
        self.chord = (before.state, beyond.state)
        length = system.chord_length(*self.chord)
        self.left, self.right = (BracketEnd(place, point, system.direction(point, self.chord, leg))
                                 for place, point in ((0.0, before), (length, beyond)))
        self.sign = heading or (1.0 if self.left.slope > 0.0 else -1.0)

    @property
    def bracketed(self):
        """Whether the load turns in between."""
        return not self.level and self.sign * self.right.slope <= 0.0

    @property
    def level(self):
        """Whether the load stands still: where nothing acts, none turns."""
        return self.left.slope == self.right.slope == 0.0

    @property
    def rate(self):
        """Mean d(position)/d(place) in between."""
        return (self.right.point.position - self.left.point.position) / (self.right.place
                                                                         - self.left.place)

    def locate(self):
        """The fold, with its tangents; NotConverged where its load does not become known to
        FOLD_TOLERANCE, or is none that the load has its limit at between the two points."""
        first, steepest = (self.left, self.right), self._steepest()
        proposals = (self._smooth, self._corner, self._middle)
        mode = 0
        failures = 0
        before = self.uncertainty()
        most = 1 if self.system.fronts_moved(first[0].point, first[1].point) else FAILURES
        for _ in range(MOST):
            if before <= 0.1 * FOLD_TOLERANCE or failures == most:
                break
            try:
                self._narrow(self._pulled(proposals[mode](), 0.25 ** (failures // 3)))
            except NotConverged:
                failures, mode = failures + 1, (mode + 1) % 3
                continue
            after = self.uncertainty()
            mode, before = mode if after < 0.5 * before else (mode + 1) % 3, after
        if not before <= FOLD_TOLERANCE:
            place = self.system.told(self.leg.controls, self.leg.load(self.left.point.position))
            raise NotConverged(f"the load turns beyond {place}, but where is "
                               f"known to {before:.2g} of it only, no fold "
                               f"(known to {FOLD_TOLERANCE:g})")
        if self._steepest() > STEEPER * steepest:
            raise NotConverged("branches meet where the load turns")
        fold = self._fold(self._is_corner(*first))
        self._check_outermost(fold, first)
        return replace(fold, fold_precision=max(before, np.finfo(float).eps))

    def _steepest(self):
        """The largest size of a slope at the bracket's ends."""
        return max(abs(self.left.slope), abs(self.right.slope))

    def _check_outermost(self, fold, first):
        """NotConverged for a fold that the load has passed at the ends that its bracket began with,
        and has to turn before: it is one of several, or another branch's."""
        passed = max(self.sign * (end.point.position - fold.position) for end in first)
        if passed > 0.0 and self.relative(passed) > PASSED:
            raise NotConverged("the load turns more than once between two points, or the search "
                               "for the fold came upon another branch")

    def uncertainty(self):
        """What the load may lack to its limit, relative to itself."""
        left, right = self.left.slope, self.right.slope
        steep, steepest = min(abs(left), abs(right)), max(abs(left), abs(right), 1e-300)
        width = self.right.place - self.left.place
        rise = self.right.point.position - self.left.point.position
        # Slopes that go with the rise are those of a parabola; else the limit may be a corner
        # anywhere in between.
        smooth = abs(rise - 0.5 * (left + right) * width) < 0.1 * steepest * width
        by_slopes = steep * width * (2.0 * steep / (steep + steepest) if smooth else 1.0)
        # A flat end may be another limit, from which the branch goes on to this one.
        return self.relative(max(by_slopes, self._beyond_ends(rise, width)))

    def _beyond_ends(self, rise, width):
        """How far the cubic through both points with their slopes goes beyond them, in position."""
        begin = self.sign * self.left.slope * width
        end = self.sign * self.right.slope * width
        rate = self.sign * rise
        part = np.linspace(0.0, 1.0, 33)
        cubic = ((begin + end - 2.0 * rate) * part + (3.0 * rate - 2.0 * begin
                                                      - end)) * part ** 2 + begin * part
        return float(cubic.max() - max(0.0, rate))

    def relative(self, change):
        """A change of position in the leg as one of the moving load, relative to itself."""
        moving = self.leg.moving
        load = self.leg.load(self.left.point.position)[moving]
        return abs(change * self.leg.direction[moving]) / max(abs(load), 1e-3)

    def _smooth(self):
        """Place where the cubic through both points with their slopes has its limit point."""
        left, right = self.left, self.right
        width = right.place - left.place
        rise = self.rate
        # Slope of the cubic, a t^2 + b t + c for t from 0 to 1.
        a = 3.0 * (left.slope + right.slope) - 6.0 * rise
        b = 6.0 * rise - 4.0 * left.slope - 2.0 * right.slope
        c = left.slope
        roots = np.roots([a, b, c]) if abs(a) > 1e-9 * abs(b) else np.array([-c / b])
        inside = [root.real for root in roots if abs(root.imag) < 1e-9 and 0.0 <= root.real <= 1.0]
        return left.place + width * (inside[0] if inside
                                     else left.slope / (left.slope - right.slope))

    def turns_between(self, heading):
        """Whether the cubic between two ends that both lead on goes back in between, or nearly so:
        two folds near each other hide there."""
        begin, end = heading * self.left.slope, heading * self.right.slope
        rise = heading * self.rate
        if min(begin, end) <= rise < LEVEL / (self.right.place - self.left.place):
            return False
        part = np.linspace(0.0, 1.0, 33)
        slopes = (begin + (6.0 * rise - 4.0 * begin - 2.0 * end) * part
                  + 3.0 * (begin + end - 2.0 * rise) * part ** 2)
        return bool(slopes.min() < (NEARLY * rise if slopes.min() < min(begin, end) else 0.0))

    def _corner(self):
        """Place a little beyond where the tangents of both points meet, seen from the nearer one:
        that closes the bracket."""
        left, right = self.left, self.right
        width = right.place - left.place
        meet = (right.point.position - left.point.position - right.slope * width) / (
            left.slope - right.slope)
        meet = min(max(meet, 0.0), width)
        return left.place + (1.1 * meet if 2.0 * meet < width else width - 1.1 * (width - meet))

    def _middle(self):
        return 0.5 * (self.left.place + self.right.place)

    def _pulled(self, place, part):
        """A place nearer to the closer end of the bracket, where after failures a solve is likelier
        to succeed."""
        end = min(self.left.place, self.right.place, key=lambda known: abs(known - place))
        return end + part * (place - end)

    def _narrow(self, place, closest=1e-3, tight=False):
        """Replace an end of the bracket by the point at a place in it, no closer to an end than a
        part of its width."""
        width = self.right.place - self.left.place
        found = self._point_at(min(max(place, self.left.place + closest * width),
                                   self.right.place - closest * width), tight)
        if found.slope * self.sign > 0.0:
            self.left = found
        else:
            self.right = found
        return found

    def _point_at(self, place, tight):
        """The point at a place of the bracket, with its direction; NotConverged for one of another
        branch."""
        left, right = self.left, self.right
        width = right.place - left.place
        t = (place - left.place) / width
        weights = np.array([(1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2 * width,
                            t ** 2 * (t - 1) * width, t ** 2 * (3 - 2 * t)])
        ends = [left.point, left.direction, right.direction, right.point]
        guess = self.system.extrapolate(ends, weights)
        position = float(weights @ [left.point.position, left.slope, right.slope,
                                    right.point.position])
        point = self.system.solve_arc(self.chord, place, guess, position, self.leg, tight=tight)
        if self.system.missed(guess, point.state) > max(
            MISSED, SHARE * self.system.missed(left.point.state, right.point.state)
        ):
            raise NotConverged("the search for the fold strayed from the branch")
        if not tight and point.softest < 0.0 <= min(left.point.softest, right.point.softest):
            raise NotConverged(
                "the search for the fold came upon a branch with another mode that is unstable")
        return BracketEnd(place, point, self.system.direction(point, self.chord, self.leg))

    def _is_corner(self, first, last):
        """Whether the slope jumps where a smooth one would hardly change, given the bracket's first
        ends."""
        part = (self.right.place - self.left.place) / (last.place - first.place)
        change = abs(self.left.slope - self.right.slope) / abs(first.slope - last.slope)
        return part < 0.01 and change > CORNER * part

    def _polished(self):
        """The flattest point, two steps on: where the load is known to a tolerance, all else is
        known to its root only."""
        found = []
        try:
            while len(found) < 2 and self.right.place > self.left.place:
                found.append(self._narrow(self._smooth(), closest=0.0, tight=True))
        except NotConverged:
            pass
        return min(found or (self.left, self.right), key=lambda end: abs(end.slope))

    def _fold(self, corner):
        """The fold with the direction there or, at a corner, with both of its sides, of unit
        length."""
        if corner:
            ends = self.left, self.right
            best = max(ends, key=lambda end: self.sign * end.point.position)
        else:
            best = self._polished()
            ends = best,
        tangents = tuple(self.system.unit(end.point, end.direction) for end in ends)
        return replace(best.point, event="fold", tangents=tangents,
                       resolved=int(corner or not self._crowded(best)))

    def _crowded(self, fold):
        """Whether the branch's bend at a fold changes so much while an edge passes a node that the
        grid may turn it again there, at a load that can be told from its own."""
        stride, found = self.system.stride(fold.point, fold.direction), {0: fold.point}
        if not stride:
            return False
        try:
            for thirds in (-1, 1, -2, 2):
                offset = stride * thirds / 3.0
                near = [found[place] for place in (-1, 0, 1)] if len(found) > 2 else None
                guess = self.system.extrapolate(*((near, lagrange_weights((-1, 0, 1), thirds))
                                                  if near else ([fold.point, fold.direction],
                                                                (1.0, offset))))
                found[thirds] = self.system.solve_arc(self.chord, fold.place + offset, guess,
                                                      fold.point.position, self.leg, tight=True)
        except NotConverged:
            return False
        bends = -self.sign * np.diff([found[thirds].position for thirds in sorted(found)], 2)
        # On fine grids an edge moves by so little that what the load bends is rounding.
        told = self.relative(np.abs(bends).max()) > 0.1 * FOLD_TOLERANCE
        return bool(told and bends.min() < STEADY * bends.max())

