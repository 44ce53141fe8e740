"""Folds of a branch: limit points of the load, searched for by arc length."""

from dataclasses import replace

import numpy as np

from . import beside_folds
from .leaps import leapt
from .limit_points import FOLD_TOLERANCE, LimitPoint
from .load_steps import SHARE
from .points import NoFold, NotConverged, lagrange_weights
from .predictors.predictor import moved_on
from .second_points import neighboured

SHORT = 1.0 / 40.0
"""Steps that had to be cut below this part of a leg, or below its initial one, look like a fold:
arc length finds out."""

MISSED = 0.1
"""Ranges of the law that a solve by arc length may end from its prediction whatever its way: less
than for steps of the load, whose predictions are less exact next to a fold."""
FINE = 0.003
"""Length of a step, ranges of the law, below which loads hang on what solves leave: `tight`."""
STEADY = 0.7
"""Part of the slope of the load before a step that is left after it where no fold is near: a slope
that falls linearly vanishes after more than two further steps of that length."""
AHEAD = 0.01
"""Ranges of the law within which a load that still rises, by its slope, would tell it from a
plateau."""

LOST = "following the branch by arc length failed too, so that no fold was located"
HIDDEN, ACROSS = "the fold there was not located", "steps of arc length led across a jump"
IN_PLACE = 2
"""Failures in turn, each in a step a quarter as long, after which edges of contact are not followed
any more: of a spot that is just born they run away from it, and however short a step is, they lead
across the branch."""
MOST = 60
"""Steps of arc length that are tried."""
BEHIND = 5
"""Points behind a step along the arc that are kept: each has a state, and what the load did further
back tells nothing of a fold ahead."""


class FoldSearch:
    """Arc-length search for the fold beyond the last point of a leg: the load is one more unknown
    of the solve.

    Parameters
    ----------
    system : System
    leg : Leg
    history : list of (position in the leg, Point), oldest first
    """

    behind = BEHIND

    def __init__(self, system, leg, history):
        self.system = system
        self.leg = leg
        self.history = [(place, replace(point, position=place)) for place, point in history]
        # Whatever steps a user asks for: those that look for a fold must not pass it.
        self.initial, self.largest = min(leg.initial, SHORT), min(leg.largest, 2.0 * SHORT)

    def search(self, error, refused=np.inf):
        """(fold point, state beyond it, None), or (None, None, point) where the branch goes on past
        the trouble; NoFold (``error`` again) where it cannot be followed."""
        begin = self.history[-1][0]
        try:
            trail = self.trail(refused)
        except NotConverged as second:
            raise NoFold(f"{error}; no neighbour was found either: {second}") from None
        end, failures = min(begin + self.largest, 1.0), 0
        first = length = self._short_of(refused, trail)
        for _ in range(MOST):
            try:
                point = self._ahead(trail, length, failures)
            except NotConverged as second:
                failures, length = failures + 1, self._shorter(length, first, error, LOST, second)
                continue
            trail = [*trail[-self.behind:], (point.position, point)]
            leap, failures = leapt(self.system, self.leg, trail, failures), 0
            if leap:
                trail, length = trail[:-2], self._shorter(leap, first, error, ACROSS)
                continue
            slope = self._slopes(trail[-3:])[1]
            steady = slope[2] > STEADY * slope[1]
            if slope[2] <= 0.0:
                try:
                    fold, beyond, trail = self._locate(trail)
                except NotConverged as second:
                    # Between points that are nearer to it a search succeeds.
                    trail, length = trail[:-1], self._shorter(length, first, error, HIDDEN, second)
                    continue
                if fold is not None and fold.position <= 1.0:
                    return fold, beyond, None
                length *= 2.0
            if (place := trail[-1][0]) >= end or (steady and place > begin + self.initial):
                return None, None, self._natural(trail, min(place, end))
            if steady and point.spent["last_iterations"] <= 6:
                length *= min(1.7, self.largest / max(place - trail[-2][0], 1e-300))
        if trail[-1][0] <= begin + 2.0 * self.leg.smallest:
            raise NoFold(f"{error}; arc length made no headway either")
        return None, None, self._natural(trail, min(trail[-1][0], 1.0))

    @staticmethod
    def _shorter(length, first, *reasons):
        """A quarter of a step; NoFold, with what led to it, where that is next to nothing."""
        if 0.25 * length < 1e-4 * first:
            raise NoFold("; ".join(map(str, reasons))) from None
        return 0.25 * length

    def _short_of(self, refused, trail):
        """Length of the first arc step: that of the last one, but not beyond the refused step."""
        (before, first), (here, last) = trail[-2:]
        way = max(abs(here - before), 1e-300)  # none, where the slip jumped under the same load
        return self.system.chord_length(first.state, last.state) * min(1.0, refused / way)

    def _slopes(self, trail):
        """Places on the arc of three points, and d(position)/d(arc length) of their parabola."""
        distance = self.system.chord_length
        arc = np.array([-distance(trail[0][1].state, trail[1][1].state), 0.0,
                        distance(trail[1][1].state, trail[2][1].state)])
        curvature, slope, _ = np.polyfit(arc, [place for place, _ in trail], 2)
        return arc, slope + 2.0 * curvature * arc

    def trail(self, refused=np.inf):
        """The last two points, made by a tiny step where the leg has only begun."""
        if len(self.history) > 1:
            return [(position, point) for position, point in self.history[-2:]]
        here, last = self.history[-1]
        step = max(self.leg.smallest, 1e-3 * self.initial)
        return neighboured(self.system, self.leg, here, last, step, refused)

    def _ahead(self, trail, length, failures=0):
        """The point at a given arc length beyond the last two, after failures in turn."""
        earlier = trail[:-2] or self.history[:-2]
        return self._at(*trail[-2:][::-1], length, earlier[-1:], failures < IN_PLACE)

    def _at(self, end, begin, length, earlier=(), follow=True):
        """The point at about arc length ``length`` from the ``end`` of a way, on from its
        ``begin``, with edges and fronts that move on, if they are to be followed: in place, steps
        have to be shorter than these are wide. Each is (position, point), as the one ``earlier``,
        if any, which tells how they turn."""
        system, (_, last), (_, first) = self.system, end, begin
        places, points = zip(*earlier, begin, end)
        arc = [0.0, *np.cumsum([system.chord_length(one.state, other.state)
                                for one, other in zip(points, points[1:])])]
        weights = lagrange_weights(arc, arc[-1] + length)
        guess = system.follow_edge(points, weights) if follow else None
        if guess is None:
            places, points, weights = places[-2:], [first, last], lagrange_weights(
                arc[-2:], arc[-1] + length)
            guess = system.extrapolate(points, weights)
        point = self._solved((last.state, guess), guess, float(weights @ places))
        aside, moved = system.ways(guess, last.state, point.state)
        point = beside_folds.trusted(system, last, point, aside, moved)
        if (aside > MISSED and aside > SHARE * moved) \
                or system.strayed(guess, last.state, point.state) > 0.0:
            raise NotConverged(f"the arc-length step ended {aside:.3g} ranges from "
                               "its prediction, perhaps on another branch")
        return point

    def _solved(self, chord, guess, position):
        """The point at the end of a chord of two states, near a guess and its position."""
        length = self.system.chord_length(*chord)
        return self.system.solve_arc(chord, length, guess, position, self.leg, tight=length < FINE)

    def _natural(self, trail, target):
        """The point at a given place of the leg, between two of a trail that is refined until a
        solve succeeds.

        Where none does, the trail's own last point before that place; NoFold if that is no way
        ahead.
        """
        after = next((k for k, (place, _) in enumerate(trail) if place >= target and k),
                     len(trail) - 1)
        pair = trail[after - 1:after + 1]
        for _ in range(12):
            (before, first), (behind, second) = pair
            guess = moved_on(self.system, [first, second], [before, behind], target)
            try:
                point = self.system.solve(guess, self.leg.controls, self.leg.load(target))
                if (self.system.missed(guess, point.state) <= max(MISSED,
                                                                  self.system.missed(first.state,
                                                                                     second.state))
                    and self.system.strayed(guess, first.state, point.state) <= 0.0):
                    return self._passed(point, target)
            except NotConverged:
                pass
            try:
                half = self._at(pair[0], pair[1],
                                -0.5 * self.system.chord_length(first.state, second.state))
            except NotConverged:
                break
            pair = ([pair[0], (half.position, half)] if half.position >= target
                    else [(half.position, half), pair[1]])
        begin = self.history[-1][0]
        ahead = [(place, point) for place, point in trail if begin + self.leg.smallest < place
                 <= target]
        if not ahead:
            raise NoFold(
                f"the branch goes on beyond {target:.6g} of the leg, but no solve there succeeded")
        place, point = max(ahead, key=lambda item: item[0])
        return self._passed(point, place)

    def _passed(self, point, place):
        """A point with which the steps go on."""
        reached = min(self.initial, place - self.history[-1][0])
        return replace(point, leg=self.leg.number, position=place,
                       step=max(reached, self.leg.smallest))

    def _locate(self, trail):
        """Fold, state beyond it, and trail up to it, from a trail with the load's peak near its
        end.

        The first two are None where the load goes on rising: a bend may look like a peak.
        """
        trail = self._bracketed(trail)
        if trail[-1][0] >= trail[-2][0]:
            return self._hidden(trail)
        if self._returns(trail):
            return None, None, trail[:-1]
        beyond, last = trail[-1][1], None
        for after in range(len(trail) - 1, 0, -1):
            peak = LimitPoint(self.system, self.leg, trail[after - 1][1], trail[after][1])
            last = last or peak
            if peak.bracketed and peak.sign > 0.0:
                return self._at_peak(peak, beyond, trail[:after])
            # Next to the peak loads are as accurate as residuals: by its slope it may have been
            # passed before, or lie ahead.
            if peak.left.slope > 0.0 and after < len(trail) - 1:
                break
        place, fold = max(trail[-3:], key=lambda item: item[0])
        width = peak.relative(place - min(trail[-3][0], trail[-1][0]))
        if not width <= FOLD_TOLERANCE:
            raise NotConverged("the load turned, but its slope did not: edges "
                               "that stick between nodes give way one by one")
        if min(last.left.slope,
               last.right.slope) > 0.0 and last.relative(last.right.slope * AHEAD) > FOLD_TOLERANCE:
            return None, None, trail[:-1]
        # A plateau: the load neither rises nor falls.
        fold = replace(fold, leg=self.leg.number, step=self.leg.initial,
                       fold_precision=max(width, np.finfo(float).eps))
        return fold, beyond.state, trail

    def _at_peak(self, peak, beyond, trail):
        """The same at a `LimitPoint`, from a point beyond it and the trail before it."""
        fold = peak.locate()
        fold = replace(fold, leg=self.leg.number, step=self.leg.initial)
        return fold, beyond.state, [*trail, (fold.position, fold)]

    def _hidden(self, trail):
        """The same from a trail whose load rises from point to point, though it turns back and on
        again where that hardly shows."""
        (places, points), distance = zip(*trail), self.system.chord_length
        rises = [(end - begin) / distance(first.state, last.state)
                 for begin, end, first, last in zip(places, places[1:], points, points[1:])]
        flattest = int(np.argmin(rises)) + 1
        for after in range(flattest, 0, -1):
            peak = LimitPoint(self.system, self.leg, points[after - 1], points[after])
            if peak.bracketed and peak.sign > 0.0:
                return self._at_peak(peak, points[after], trail[:after])
            if peak.left.slope > 0.0:
                break
        if peak.turns_between(1.0):
            raise NotConverged("the load turns more than once in this step")
        return None, None, trail

    def _returns(self, trail):
        """Whether the last point lies on the way to the one before it: the arc turned, not the
        branch.

        Beyond a fold, the state at a load is as far from the one on the way there as twice the way
        from the fold.
        """
        place, point = trail[-1]
        after = next(k for k, (ahead, _) in enumerate(trail) if ahead >= place)
        if after == 0:
            return False
        (before, first), (behind, second) = trail[after - 1:after + 1]
        passed = self.system.extrapolate([first, second], lagrange_weights([before, behind], place))
        return self.system.missed(passed,
                                  point.state) < 0.5 * self.system.missed(trail[-2][1].state,
                                                                          point.state)

    def _bracketed(self, trail, behind=None):
        """The trail, gone on along the arc until the load falls, or for eight steps; of points
        before the last one all, or that many are kept."""
        length, failures = 0.5 * self._slopes(trail[-3:])[0][2], 0
        for _ in range(8):
            if trail[-1][0] < trail[-2][0]:
                break
            try:
                ahead = self._ahead(trail, length, failures)
            except NotConverged:
                failures, length = failures + 1, 0.25 * length
                continue
            failures = 0
            trail = [*trail, (ahead.position, ahead)][-behind - 1 if behind else None:]
        return trail
