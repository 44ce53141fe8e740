"""Continuation by arc length: points along a branch whatever its load does, through its folds."""

from dataclasses import replace

from . import departures
from .events import events_between, locate
from .folding_steps import FoldingSteps
from .folds import FoldSearch
from .natural import grown
from .points import NoEquilibrium, NotConverged
from .predictors import after_failure

BRIEF = 1e-4
"""A step along the arc below this part of the last ones has failed, if the load hardly moves in
it."""
PATIENCE = 40
"""Failures, less successes, after which a branch is given up."""


class ArcLengthSteps(FoldingSteps):
    """Pseudo-arclength continuation along one leg: an iterator of points, through folds or to them.

    Steps are lengths along the branch (`system.States.chord_length`), by the rules of natural
    continuation: the first is the leg's initial step, they grow with few iterations, and none moves
    the load by more than the largest step. Parameters as of `LoadSteps`, and 'trace' for
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
        self._restart()
        failures, again = 0, after_failure(self.predictor)
        while not self.stopped and self.history[-1][0] != 1.0:
            why = self._why_it_ends()
            if why or len(self.history) == 1:
                yield from self._end_of_attraction(why) if why else self._begin()
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

    def _restart(self):
        """Begin to count at the last point: steps, failures, folds."""
        self.begun = self.history[-1][1]
        self.steps, self.patience = 0, PATIENCE
        self.length = self.history[-1][1].arc
        self.turns, self.told = [], False
        self.departed = self.level = None

    def _begin(self):
        """The second point: by a step of the load, or, where that fails, next to the first one by
        its tangent."""
        (here, last) = self.history[-1]
        step = self.leg.initial
        self.length = 0.0
        left = 1.0 - here
        target = 1.0 if left <= step * (1.0 + 1e-9) else here + min(step, 0.5 * left)
        try:
            point = self._probed(self._step(target, self.predictor))
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
                examined, before = None, self.history[-1][0]
                yield from self._certified(found)
                turned = (found.position - before) * (point.position - found.position) < 0.0
                if self.stopped or turned and point.event != "fold":
                    return  # the next step meets a fold that the places of this one did not show
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
        return point.changed(leg=self.leg.number, step=self.leg.initial, arc=self.length)

    def _pass(self, fold, beyond):
        """Hand out a fold, and leave it by a jump or stay there where that is asked for."""
        self._tell_of_swings(fold)
        yield from self._reach(fold)
        fold = self.history[-1][1]
        if self.at_fold != "trace" and not self.stopped:
            self.departed = fold
            yield from self._leave(fold, departures.starts(self.system, fold, beyond.state))

    def _leave(self, fold, starts):
        """What follows a fold: what follows it elsewhere, but traces go on along the branch."""
        if self.at_fold != "trace":
            yield from super()._leave(fold, starts)

    def _why_it_ends(self):
        """Why the branch does not lead to the end of the leg, NoEquilibrium; None where it may."""
        if len(self.history) < 2:
            return None
        (before, previous), (here, last) = self.history[-2:]
        why = self.system.end_of_branch(last, self.leg, self.heading)
        if here == 0.0 < before:
            why = "it came back to where the leg began"
        if self.steps > 5 and max(self._way(self.begun, previous),
                                  self._way(self.begun, last)) < self._way(previous, last):
            why = "it closes on itself"
        return why and NoEquilibrium(
            f"the branch does not lead to {self._place(1.0)}: {why}, at {self._place(here)}")

    def _end_of_attraction(self, why):
        """The fold, and what follows it, at which the equilibria of a body end that is attracted
        less and less; where its branch ends for another reason, that is raised.

        Parameters
        ----------
        why : NoEquilibrium
        """
        here, last = self.history[-1]
        # (what loads off the flat change by is rounding at last)
        ends = (self.heading > 0.0 or not last.in_contact) and self.system.end_of_branch(
            last, self.leg, self.heading)
        if (not ends or last.event == "fold"
            or self.system.end_of_attraction(last, self.leg, here) is None):
            raise why
        yield from self._fold(NotConverged(str(why)))
