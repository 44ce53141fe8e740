"""Folds on the way along a branch: what a step by arc length meets."""

from dataclasses import replace

import numpy as np

from . import bifurcations
from .arc_steps import ArcSteps
from .limit_points import FOLD_TOLERANCE, LimitPoint
from .natural import fold_kind
from .points import NotConverged

TURNING = 0.5
"""Where the slope of the load falls below this part of its mean over the last step, a fold may be
near."""
LONG = 0.1
SAME = 1e-4
"""Ranges in which a load that turns changes by more than rounding, and those up to which folds are
one."""
APART = 0.1
"""Part of the length of a long step from which on the sides of a fold are asked for their
stability."""
NEARBY = 0.05
"""Steps below this part of the last one do not tell folds apart any better if they are shorter
still."""
FASTER, FAR = 2.0, 0.3
"""How much faster the load may move where a first step begins than in all of it, and way of such a
step, ranges of the law, from which on more tells of two folds within it."""
SWINGS, SWING = 3, 1e-2
"""Folds after the first that, within so small a part of the load, are likely to be those of a
grid."""


class FoldingSteps(ArcSteps):
    """Steps by arc length that find the folds on their way; parameters as of `LoadSteps`."""

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
        ended = self.system.end_of_branch(point, self.leg, self.heading)
        fold, late = (None, False) if ended else self._fold_before(point)
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
        self._check_first(limit)
        late = last.event != "fold" and limit.left.slope * heading < 0.0
        if limit.level or (not late and limit.right.slope * heading > 0.0 and mean * heading > 0.0
                           and not limit.turns_between(heading)):
            # The next step begins next to a fold, or on a plateau, where its own mean tells little.
            self.level = (point.state if limit.right.slope * heading < TURNING * limit.rate
                          * heading else None)
            return None, False
        if late:
            limit = LimitPoint(self.system, self.leg, before, last, heading
                               if before.event == "fold" else 0.0)
        fold = limit.locate() if limit.bracketed and limit.sign == heading else None
        if fold is None or any(end.event == "fold" and self.system.missed(end.state, fold.state)
                               < SAME for end in (before, last)):
            if self._way(last, point) > NEARBY * self._way(before, last):
                raise NotConverged("the load turns more than once in this step")
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

    def _check_first(self, limit):
        """NotConverged where a first step is too long to tell of two folds within it: of them no
        slope at its ends tells, nor do points before it."""
        if (len(self.history) == 2 and limit.right.place > FAR
            and limit.left.slope * limit.sign > FASTER * abs(limit.rate)):
            raise NotConverged("the load moves much less than where this first step begins")

    def _stands_still(self, last, point):
        """Whether the load changes by rounding only in a long step: where the law is exhausted it
        turns by chance."""
        change, load = abs(point.load - last.load)[self.leg.moving], abs(last.load[self.leg.moving])
        return (change < FOLD_TOLERANCE * max(load, 1e-3)
                and self.system.chord_length(last.state, point.state) > LONG)

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
