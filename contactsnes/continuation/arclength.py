"""Continuation by arc length: points along a branch whatever its load does, through its folds."""

from dataclasses import replace

import numpy as np

from . import bifurcations, departures
from .events import events_between, locate
from .folds import FoldSearch
from .limit_points import FOLD_TOLERANCE, LimitPoint
from .natural import NaturalSteps, fold_kind, grown
from .points import NoEquilibrium, NotConverged, lagrange_weights
from .predictors import after_failure

APART = 0.1
"""Points nearer to each other than this part of the next step add noise to a prediction, not
knowledge."""
TURNING = 0.5
"""Where the slope of the load falls below this part of its mean over the last step, a fold may be
near."""
BRIEF = 1e-4
"""A step along the arc below this part of the last ones has failed, if the load hardly moves in
it."""
LONG = 0.1
SAME = 1e-4
BACK = 0.45
"""Ranges in which a load that turns changes by more than rounding, those up to which folds are one,
part of a way to lead back."""
ASIDE = 0.05
"""Ranges that a solve may end from its prediction without being asked whether the branch leads back
from there."""
PATIENCE = 40
"""Failures, less successes, after which a branch is given up."""
NEARBY = 0.05
"""Steps below this part of the last one do not tell folds apart any better if they are shorter
still."""
SWINGS, SWING = 3, 1e-2
"""Folds after the first that, within so small a part of the load, are likely to be those of a
grid."""
PACE, STILL = 0.1, 1e-12
"""What the position counts in the length of a branch, over what the state does, and how little of
it is rounding."""


class ArcLengthSteps(NaturalSteps):
    """Pseudo-arclength continuation along one leg: an iterator of points, through folds or to them.

    Steps are lengths along the branch (``Tracer.chord_length``), by the rules of natural
    continuation: the first is the leg's initial step, they grow with few iterations, and none moves
    the load by more than the largest step. Parameters as of `NaturalSteps`, and 'trace' for
    ``at_fold``, which goes on through folds.
    """

    @staticmethod
    def past(points, number):
        """[(position, point), ...] of the last points of leg ``number``, from which the steps
        go on."""
        found = []
        for point in reversed(points):
            place = point.position if point.leg == number else 0.0
            # Copies of a point carry its further events.
            if not found or place != found[-1][0]:
                found.append((place, point))
            if point.leg != number or point.event == "jump":
                break
        return found[::-1]

    def __iter__(self):
        self.history = [(place, replace(point, position=place)) for place, point in self.history]
        yield from self._resumed()
        self.begun = self.history[-1][1]
        self.steps = 0
        self.length = self.history[-1][1].arc
        failures, again = 0, after_failure(self.predictor)
        self.patience = PATIENCE
        self.turns = []
        self.told = False
        self.departed = None
        self.level = None
        while not self.stopped and self.history[-1][0] != 1.0:
            self._check_end()
            if len(self.history) == 1:
                yield from self._begin()
                continue
            here, last = self.history[-1]
            self.length = self.length or self._way(self.history[-2][1], last)
            try:
                point = self._ahead(self.length, again if failures else self.predictor)
                fold, point = self._met(point)
                examined = None
                if fold is None and last.event != "fold":
                    examined = point, _ = self._examined(self._marked(point))
            except NotConverged as error:
                if failures or again is self.predictor:
                    self.length *= 0.25
                failures += 1
                self.system.log(f"a step along the branch from {self._place(here)} "
                                f"failed ({error}): trying another one")
                self.patience -= 1
                if self._exhausted():
                    self._give_up(error, f"at {self._place(1.0)}")
                continue
            failures, self.length = 0, self.length if point is None else self._next_length(point)
            if fold is not None:
                yield from self._pass(fold, last if point is None else point)
                if self.stopped or self.at_fold != "trace":
                    continue
            if point is None:
                self.history[-2:] = self.history[-2:][::-1]
                continue
            self.steps, self.patience = self.steps + 1, min(self.patience + 1, PATIENCE)
            yield from self._reach(point, examined)

    @property
    def heading(self):
        """1 where the load moves on towards the leg's end, -1 where it moves back."""
        (before, _), (here, last) = self.history[-2:]
        return (-1.0 if last.event == "fold" else 1.0) * np.sign(here - before)

    @property
    def _pace(self):
        """Length that a unit of position counts, so that the branch has a direction where its state
        stands still, too."""
        pairs = [(first, last) for (_, first), (_, last) in zip(self.history, self.history[1:])]
        moved = sum(self.system.chord_length(first.state, last.state) for first, last in pairs)
        return PACE * moved / max(sum(abs(last.position - first.position) for first, last in pairs),
                                  STILL)

    def _way(self, first, last):
        """Length of the way from one point to another."""
        return float(np.hypot(self.system.chord_length(first.state, last.state),
                              self._pace * (last.position - first.position)))

    def _begin(self):
        """The second point: by a step of the load, or, where that fails, next to the first one by
        its tangent."""
        (here, last) = self.history[-1]
        step = self.leg.initial
        self.length = 0.0
        left = 1.0 - here
        target = 1.0 if left <= step * (1.0 + 1e-9) else here + min(step, 0.5 * left)
        try:
            point = self._step(target, self.predictor)
        except NotConverged as error:
            self.system.log(f"step to {self._place(target)} failed ({error}): looking "
                            "for the branch's direction")
            if self.system.end_of_attraction(last, self.leg, here) is not None:
                yield from self._fold(error, target - here)
                return
            try:
                trail = FoldSearch(self.system, self.leg, self.history).trail()
            except NotConverged:
                self._give_up(error, f"at {self._place(1.0)}")
            self.history = [(place, replace(point, leg=self.leg.number, position=place))
                            for place, point in trail]
            self.length = self._way(*(point for _, point in self.history)) * step / abs(
                trail[1][0] - trail[0][0])
            if trail[0][1].state is not last.state:
                return
            point = self.history.pop()[1]
        yield self._accept(self._marked(point))

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
        points, places = [self.history[-1][1]], [0.0]
        for _, point in reversed(self.history[:-1]):
            apart = self._way(point, points[0])
            if apart > APART * length or (len(points) == 1 and point is self.history[0][1]):
                points, places = [point, *points], [places[0] - apart, *places]
        used = max(2, predictor.order)
        points, places = points[-used:], places[-used:]
        weights = lagrange_weights(places, length)
        return (predictor.state(self.system, points, places, length),
                float(weights @ [point.position for point in points]))

    def _check(self, guess, point):
        """NotConverged unless a point is the neighbour of the last one that a prediction led to."""
        (_, before), (here, last) = self.history[-2:]
        missed = self.system.missed(guess, point.state)
        moved = self.system.missed(last.state, point.state)
        if (missed > 0.15 and missed > 0.5 * moved) or self.system.strayed(guess, last.state,
                                                                           point.state) > 0.0:
            raise NotConverged(f"the solve ended {missed:.3g} ranges from its "
                               f"prediction, {moved:.3g} from the last point, "
                               "perhaps on another branch")
        if missed > ASIDE and (missed > 0.35 * moved or self.system.missed(self._back(point),
                                                                           last.state) > 0.5
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

    def _slopes(self, point):
        """d(position)/d(length) at a new point, by the parabola through the last two and it, and
        the mean since the last."""
        (first, before), (here, last) = self.history[-2:]
        behind, ahead = self._way(before, last), self._way(last, point)
        mean, earlier = (point.position - here) / ahead, (here - first) / behind
        return mean + (mean - earlier) * ahead / (ahead + behind), mean

    def _met(self, point):
        """(fold or None, point) of what a step to a point meets: a fold on the way, or an end of
        the leg in the point's place.

        No point where the fold turns out to lie before the last one.
        """
        fold, late = (None, False) if self.system.end_of_branch(point, self.leg,
                                                       self.heading) else self._fold_before(point)
        if late:
            return fold, None
        here, last = self.history[-1]
        first = fold or point
        end = next((end for end in (0.0, 1.0) if (first.position - end) * (end - here) > 0.0), None)
        if end is None:
            return fold, point
        part = (end - here) / (first.position - here)
        guess = self.system.extrapolate([last, first], [1.0 - part, part])
        point = self._at_end(guess, end)
        self._check(guess, point)
        return None, point

    def _fold_before(self, point):
        """The fold before a new point or None, and whether it lies before the last one, too: it may
        turn more sharply than steps tell.

        Raises NotConverged for a step over several folds.
        """
        (slope, mean), heading = self._slopes(point), self.heading
        (_, before), (_, last) = self.history[-2:]
        straight = last.state is not self.level and min(slope * heading,
                                                        mean * heading) > TURNING * abs(mean)
        if straight or self._stands_still(last, point):
            return None, False
        limit = LimitPoint(self.system, self.leg, last, point, heading if last.event == "fold"
                           else 0.0)
        late = last.event != "fold" and limit.left.slope * heading < 0.0
        if (not late and limit.right.slope * heading > 0.0 and mean * heading > 0.0
            and not limit.turns_between(heading)):
            # The next step begins next to a fold, or on a plateau, where its own mean tells little.
            self.level = (point.state if limit.right.slope * heading < TURNING * limit.rate
                          * heading else None)
            return None, False
        if late:
            limit = LimitPoint(self.system, self.leg, before, last, heading
                               if before.event == "fold" else 0.0)
        apart = limit.bracketed and limit.sign == heading
        if not apart and self._way(last, point) > NEARBY * self._way(before, last):
            raise NotConverged("the load turns more than once in this step")
        fold = limit.locate() if apart else None
        if fold is None or any(end.event == "fold" and self.system.missed(end.state, fold.state)
                               < SAME for end in (before, last)):
            self.system.log(f"folds at {self._place(last.position)} are too near to "
                            "each other to be told apart: going on")
            return None, False
        if self.departed is not None and self.system.missed(self.departed.state, fold.state) < SAME:
            raise NotConverged("the step led back to the fold that a jump has left")
        if (not late and self._way(last, point) > APART * LONG
            and bifurcations.crossed(self.system, self.certify, last, point)):
            raise NotConverged(
                "the sides of the fold are as stable as each other, so that it is another branch's")
        return replace(fold, fold_kind=fold_kind(self.leg, heading)), late

    def _stands_still(self, last, point):
        """Whether the load changes by rounding only in a long step: where the law is exhausted it
        turns by chance."""
        change, load = abs(point.load - last.load)[self.leg.moving], abs(last.load[self.leg.moving])
        return (change < FOLD_TOLERANCE * max(load, 1e-3)
                and self.system.chord_length(last.state, point.state) > LONG)

    def _next_length(self, point):
        """Length of the step after a point, which is not accepted yet."""
        here, last = self.history[-1]
        length = self._way(last, point)
        moved = max(abs(point.position - here), 1e-3 * self.leg.smallest)
        return grown(length, point.spent["last_iterations"], max(length * self.leg.largest / moved,
                                                                 0.25 * length))

    def _exhausted(self):
        """Whether another try is not worth it: the step has become too short, or too many
        failed."""
        (before, first), (here, last) = self.history[-2:]
        behind = self._way(first, last)
        worth = (self.length >= BRIEF * behind or self.length * abs(here - before)
                 >= self.leg.smallest * behind)
        return self.patience == 0 or not worth

    def _reach(self, point, examined=None):
        """Accept a point after those before it at which events happen; where none do, what was
        found with it holds."""
        for event in events_between(self.history[-1][1], point):
            found = locate(self.system, self.leg, event, self.history[-1][1], point)
            if found is not point:
                examined = None
                yield from self._certified(found)
                if self.stopped:
                    return
        yield from self._certified(point, examined)

    def _certified(self, point, examined=None):
        """Accept a point; next to a fold, where an eigenvalue crosses zero, too, nothing
        bifurcates."""
        point = self._marked(point)
        if "fold" in (self.history[-1][1].event, point.event):
            yield self._accept(point)
        else:
            point, critical = examined or self._examined(point)
            yield from self._arrive(self._marked(point), critical)

    def _marked(self, point):
        """A point with the steps to try next."""
        return replace(point, leg=self.leg.number, step=self.leg.initial, arc=self.length)

    def _pass(self, fold, beyond):
        """Hand out a fold, and leave it by a jump or stay there where that is asked for."""
        self._tell_of_swings(fold)
        yield from self._reach(fold)
        fold = self.history[-1][1]
        if self.at_fold != "trace" and not self.stopped:
            self.departed = fold
            yield from self._leave(fold, departures.starts(self.system, fold, beyond.state))

    def _tell_of_swings(self, fold):
        """Say once of folds that hardly differ in their load that they are the grid's."""
        self.turns = [*self.turns[-SWINGS:], fold.position]
        reached, moving = abs(fold.load[self.leg.moving]), self.leg.moving
        swing = np.ptp(self.turns) * abs(self.leg.direction[moving])
        if len(self.turns) > SWINGS and swing < SWING * max(reached, 1e-3) and not self.told:
            self.told = True
            self.system.log(f"folds follow each other within {swing:.2g} of the "
                            f"load, at {self._place(fold.position)}: edges of "
                            "contact or slip that stick between nodes give "
                            "way one by one; a grid twice as fine tells "
                            "whether they last")

    def _check_end(self):
        """Raise NoEquilibrium where the branch does not lead to the end of the leg."""
        if len(self.history) < 2:
            return
        (before, previous), (here, last) = self.history[-2:]
        why = self.system.end_of_branch(last, self.leg, self.heading)
        if here == 0.0 < before:
            why = "it came back to where the leg began"
        if self.steps > 5 and max(self._way(self.begun, previous),
                                  self._way(self.begun, last)) < self._way(previous, last):
            why = "it closes on itself"
        if why:
            raise NoEquilibrium(
                f"the branch does not lead to {self._place(1.0)}: {why}, at {self._place(here)}")
