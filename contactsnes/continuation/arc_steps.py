"""Points along a branch by arc length: predicted, solved, and refused where a step ends on another
branch."""

import operator
from dataclasses import replace

import numpy as np

from .load_steps import MISSED, SHARE
from .natural import NaturalSteps
from .points import NotConverged, lagrange_weights

ALONG = 0.35
"""Part of its way by which a step may miss its prediction without being asked whether the branch
leads back from there."""
APART = 0.1
"""Points nearer to each other than this part of the next step add noise to a prediction, not
knowledge."""
BACK = 0.45
"""Part of a way that the tangent at its end has to lead back."""
ASIDE = 0.05
"""Ranges that a solve may end from its prediction without being asked whether the branch leads back
from there."""
PACE, STILL = 0.1, 1e-12
"""What the position counts in the length of a branch, over what the state does, and how little of
it is rounding."""


class ArcSteps(NaturalSteps):
    """Steps along a branch by its length, from the last points of a leg; parameters as of
    `LoadSteps`."""

    _gone = [], 0.0

    @property
    def heading(self):
        """1 where the load moves on towards the leg's end, -1 where it moves back."""
        (before, _), (here, last) = self.history[-2:]
        return (-1.0 if last.event == "fold" else 1.0) * np.sign(here - before)

    @property
    def _pace(self):
        """Length that a unit of position counts, so that the branch has a direction where its state
        stands still, too."""
        points = [point for _, point in self.history]
        gone = sum(abs(last.position - first.position) for first, last in zip(points, points[1:]))
        return PACE * self._moved([point.state for point in points]) / max(gone, STILL)

    def _moved(self, states):
        """Length of the way through states, known until they are others: each length of a step
        asks for it."""
        known, moved = self._gone
        if len(known) != len(states) or any(map(operator.is_not, known, states)):
            moved = sum(map(self.system.chord_length, states, states[1:]))
            self._gone = states, moved
        return moved

    def _way(self, first, last):
        """Length of the way from one point to another."""
        return float(np.hypot(self.system.chord_length(first.state, last.state),
                              self._pace * (last.position - first.position)))

    def _ahead(self, length, predictor):
        """The next point at a length along the branch; the exact one at an end of the leg that a
        prediction reaches before."""
        here, last = self.history[-1]
        guess, position = self._predicted(length, predictor)
        ahead = position - here
        end = 1.0 if ahead > 0.0 else 0.0
        if abs(ahead) > self.leg.largest:
            length *= self.leg.largest / abs(ahead)
            guess, position = self._predicted(length, predictor)
        elif abs(ahead) < abs(end - here) < 2.0 * abs(ahead):
            # The last two steps share what is left, so that none is tiny.
            length *= 0.5 * (end - here) / ahead
            guess, position = self._predicted(length, predictor)
        if ahead and (position - end) * ahead >= -1e-9 * abs(ahead) and here != end:
            length *= (end - here) / (position - here)
            guess, _ = self._predicted(length, predictor)
            point = self._at_end(guess, end)
        else:
            way = self.system.chord_length(last.state, guess)
            whole = np.hypot(way, self._pace * (position - here))
            if whole == 0.0:
                raise NotConverged("the step has shrunk to nothing")
            border = way / whole, self._pace ** 2 * (position - here) / whole
            point = self.system.solve_arc((last.state, guess), way, guess, position, self.leg,
                                          border)
        self._check(guess, point)
        # the first step: nothing tells yet how long it may be
        if len(self.history) == 2 and last.event != "fold":
            back = self.system.along_tangent(point, self.leg, point.position, here - point.position)
            if self.system.progress(point.state, last.state, back) < BACK:
                raise NotConverged("the branch where the step ended hardly leads back")
        return point

    def _at_end(self, guess, end):
        """The point exactly at an end of the leg, 0 or 1."""
        point = self.system.solve(guess, self.leg.controls, self.leg.load(end))
        return replace(point, leg=self.leg.number, position=end)

    def _predicted(self, length, predictor):
        """State and position at a length beyond the last point, by a polynomial through the last
        ones."""
        points, places, used = [self.history[-1][1]], [0.0], max(2, predictor.order)
        for _, point in reversed(self.history[:-1]):
            if len(points) == used:
                break
            apart = self._way(point, points[0])
            if apart > APART * length or (len(points) == 1 and point is self.history[0][1]):
                points, places = [point, *points], [places[0] - apart, *places]
        weights = lagrange_weights(places, length)
        return (predictor.state(self.system, points, places, length),
                float(weights @ [point.position for point in points]))

    def _check(self, guess, point):
        """NotConverged unless a point is the neighbour of the last one that a prediction led to."""
        (_, before), (here, last) = self.history[-2:]
        missed, moved = self.system.ways(guess, last.state, point.state)
        if (missed > MISSED and missed > SHARE * moved) or self.system.strayed(guess, last.state,
                                                                               point.state) > 0.0:
            raise NotConverged(f"the solve ended {missed:.3g} ranges from its "
                               f"prediction, {moved:.3g} from the last point, "
                               "perhaps on another branch")
        if missed > ASIDE and (missed > ALONG * moved or self.system.missed(self._back(point),
                                                                            last.state) > SHARE
                               * moved):
            raise NotConverged("the branch where the step ended hardly leads back")
        ahead = self._way(last, point)
        if ahead == 0.0 or self._way(before, point) < min(self._way(before, last), ahead):
            raise NotConverged("the step led back along the branch")
        if abs(point.position - here) > 2.0 * self.leg.largest:
            raise NotConverged("the load moved by more than twice the largest step")

    def _back(self, point):
        """The state that the branch's direction at a new point has where the last one is."""
        chord = self.history[-1][1].state, point.state
        direction = self.system.direction(point, chord, self.leg)
        return self.system.extrapolate([point, direction], [1.0, -self.system.chord_length(*chord)])
