"""Natural continuation: steps of the load along a leg, with rollback, folds and jumps."""

from dataclasses import replace

import numpy as np

from . import bifurcations, branching, departures
from .folds import SHORT, FoldSearch
from .load_steps import LoadSteps
from .points import NoEquilibrium, NoFold, NotConverged, without_frames
from .predictors import after_failure

SAME = 1e-6
"""Part of a leg within which a fold that is found anew is the one that an earlier run ended at."""

REPEATED = 2
"""Jumps in turn that may begin at one load and end where nothing holds the body either."""

USUAL = 8
"""Newton iterations with which a step stays as long as it is."""


def grown(step, iterations, largest):
    """The next step after a success: longer by up to twice the fewer iterations it took (as in
    BifurcationKit).

    Parameters
    ----------
    step, largest : lengths, in one unit
    iterations : of the last solve; 0 where not known
    """
    if iterations >= USUAL:
        return min(largest, step * max(0.5, USUAL / iterations))
    return min(largest, step * (1.0 + ((USUAL - iterations) / USUAL) ** 2))


def leg_history(points, number):
    """[(position, point), ...] of the points that steps along leg ``number`` extrapolates from."""
    found = []
    for point in reversed(points):
        if point.event != "bifurcation" or not found:
            found.append((point.position if point.leg == number else 0.0, point))
        if point.leg != number or point.event == "jump":
            break
    distinct = [found[0]] + [later for earlier, later in zip(found, found[1:])
                             if later[0] < earlier[0]]
    return distinct[::-1]


class NaturalSteps(LoadSteps):
    """Natural continuation along one leg: an iterator of points, with rollback, folds and jumps;
    parameters as of `LoadSteps`."""

    past = staticmethod(leg_history)
    _left_at = -1.0, 0

    def __iter__(self):
        yield from self._resumed()
        if self.stopped:
            return
        position, point = self.history[-1]
        step = point.step if point.leg == self.leg.number and point.step > 0.0 else self.leg.initial
        failures, searched = 0, None
        while self.history[-1][0] < 1.0:
            position = self.history[-1][0]
            (step, target), error = shared(step, position), None
            try:
                point, critical = self._tried(target, self._again() if failures
                                              else self.predictor)
            except NotConverged as caught:
                error = caught
            if error is not None:  # not where it is caught: Python 3.10 holds its frames there
                without_frames(error)
                failures, step = failures + 1, 0.25 * step
                self.system.log(f"step to {self._place(target)} failed ({error}); the "
                                f"next one is {step:.3g} of the leg")
                # What a search missed beyond a longer step may be near where the last ones end.
                if step < self.leg.smallest or searched != position and self._due(4.0 * step,
                                                                                  failures):
                    searched, before = position, self.history[-1][1]
                    yield from self._look_ahead(error, step)
                    if self.stopped:
                        return
                    if self.history[-1][1] is not before:
                        failures, searched = 0, None
                        step = self.history[-1][1].step
                    del before  # which may take much memory
                continue
            # However many iterations every solve takes, steps must not shrink without end.
            step, failures = point.position - position, 0
            shortest = min(step, self.leg.initial)
            step = max(shortest, self._next(step, point))
            yield from self._arrive(point.changed(step=step), critical)
            if self.stopped:
                return
            step = self.history[-1][1].step

    def _next(self, step, point):
        """Length of the step after one of a length that led to a point."""
        return grown(step, point.spent["last_iterations"], self.leg.largest)

    def _tried(self, target, predictor):
        """The point of a step to a place, or nearer, and what bifurcates on the way."""
        return self._examined(self._probed(self._step(*self._foreseen(target, predictor))))

    def _again(self):
        """The predictor of a step that is tried again, nearer."""
        points = [point for _, point in self.history[-2:]]
        moved = len(points) > 1 and self.system.fronts_moved(*points)
        return self.predictor if moved else after_failure(self.predictor)

    def _due(self, refused, failures):
        """Whether it is time to look for a fold, after a refused step and failures in turn."""
        return refused < 0.4 * self.shortest or failures > 1 and refused < 4.0 * self.shortest

    @property
    def shortest(self):
        """Length of a step, part of the leg, below which refused ones look like a fold."""
        return min(self.leg.initial, SHORT)

    def _look_ahead(self, error, step):
        """Yield what stops the steps, as `_fold` does; where nothing is found, shorter ones go
        on."""
        try:
            yield from self._fold(error, 4.0 * step)
        except NoFold as failure:
            self._shorten(failure, step)

    def _shorten(self, failure, step):
        """Have steps that are shorter than one go on after a failure; give up where none are."""
        if step < self.leg.smallest:
            self._give_up(failure, f"at {self._place(1.0)}")
        self.system.log(f"{failure}: going on with shorter steps")

    def _resumed(self):
        """What follows a fold that the path goes on from, whose way out is not known any more."""
        last = self.history[-1][1]
        if last.event == "fold" and last.leg == self.leg.number and self.at_fold == "jump":
            yield from self._fold(
                NotConverged(f"no way was found out of the fold at {self._place(last.position)}"),
                self.leg.initial)

    def _examined(self, point):
        """A point with its certificate, and what bifurcates on the way to it; NotConverged for one
        of another branch."""
        return bifurcations.examined(self.system, self.certify, self.leg, self.history[-1], point)

    def _arrive(self, point, found):
        """Yield what bifurcates on the way to a point, then the point, or the stable one beside it
        that is to be followed."""
        last = self.history[-1]
        for critical, following in zip(found, [*found[1:], point]):
            if critical.position != last[0]:
                yield replace(critical, origin=self.leg.start, spent=self.system.account(),
                              step=abs(point.position - critical.position))
            if self.at_bifurcation == "stop":
                self.stopped = True
                return
            lost = point.unstable_modes - last[1].unstable_modes
            if self.at_bifurcation == "follow" and lost > 0:
                beside = branching.followed(self.system, self.certify, self.leg, critical, point)
                if beside is not None:
                    self._tell_of_others(critical,
                                         following.unstable_modes - critical.unstable_modes)
                    self.history = []
                    yield self._accept(replace(beside, step=min(point.step, self.leg.initial)))
                    return
        yield self._accept(point)

    def _tell_of_others(self, critical, lost):
        """Say that a branch is one of several where several modes lose their stability at once (a
        complex pair of them is one).

        Parameters
        ----------
        critical : Point, the bifurcation
        lost : int, modes
        """
        if lost > 1 and not abs(critical.leading_eigenvalue.imag) > bifurcations.NEUTRAL:
            self.system.log(f"{lost} modes lose their stability at "
                            f"{self._place(critical.position)}: what one of them leads to is "
                            "followed, and other branches begin there")

    def _give_up(self, error, where):
        """Raise ``error``, or NoEquilibrium, with that error, where the leg's end has none."""
        try:
            self._end(where)
        except NoEquilibrium as missing:
            reached = self._place(self.history[-1][0])
            raise NoEquilibrium(
                f"{missing}; the branch was followed to {reached} ({error})") from None
        raise error

    def _end(self, where):
        """Raise NoEquilibrium if motion under the load of the leg's end shows that there is none.

        Under the load of the last point a body on its way out may hardly move.
        """
        last, load = self.history[-1][1], self.leg.load(1.0)
        try:
            self.system.settle(last.state, self.leg.controls, load, where)
        except NotConverged:
            pass

    def _accept(self, point):
        """The one place where a point of a leg is accepted."""
        point = point if point.stable >= 0 else self.certify(point)
        point = point.changed(origin=self.leg.start, spent=self.system.account())
        self.history = [*self.history[-3:], (point.position, point)]
        return point

    def _fold(self, error, refused=np.inf, kind=FoldSearch, starts=departures.starts):
        """Find out what stops the steps before the end of a refused step; yield the fold and, by
        default, the point after the jump.

        Parameters
        ----------
        error : NotConverged, why a step was refused
        refused : its length
        kind : class of the search for the fold
        starts : function as `departures.starts`, of states from which the jump's motion begins
        """
        place, last = self.history[-1]
        fold, passed = departures.foreknown(self.system, self.leg, place, last), None
        if fold is None:
            search = kind(self.system, self.leg, self.history)
            fold, beyond, passed = search.search(error, refused)
            fold = fold and self._judged(fold, place)
            begins = [] if fold is None else starts(self.system, fold, beyond)
        else:
            near = self.system.within_range(fold)
            fold = self._judged(replace(fold, leg=self.leg.number, step=self.leg.initial,
                                        fold_precision=np.finfo(float).eps), place)
            begins = [lambda: near]
        if fold is not None and last.event == "fold" and abs(fold.position - place) < SAME:
            yield from self._leave(replace(last, tangents=fold.tangents), begins)
            return
        try:
            found = self._examined(passed if fold is None else replace(fold, event="fold"))
        except NotConverged as second:
            raise NoFold(f"{error}; arc length led to another branch: {second}") from None
        yield from self._arrive(*found)
        if fold is None:
            return
        if not self.stopped and self.history[-1][1].event == "fold":
            yield from self._leave(self.history[-1][1], begins)

    def _judged(self, fold, place):
        """A fold beyond a place, with its kind. One that was found before that is not where the
        load that led there has its limit, but one of several."""
        return replace(fold, fold_kind=fold.fold_kind or fold_kind(self.leg),
                       resolved=0 if fold.position < place - SAME else fold.resolved)

    def _leave(self, fold, starts):
        """What follows a fold: nothing, or the point after the jump."""
        if self.at_fold == "stop":
            self.stopped = True
            return
        self._leave_once_more(fold)
        where = f"at {self._place(fold.position)}, beyond the fold ({fold.fold_kind})"
        end = (f"at {self._place(1.0)}, beyond the fold ({fold.fold_kind}) at "
               f"{self._place(fold.position)}")
        point = departures.jumped(self.system, self.leg, fold, starts, where,
                                  lambda: self._end(end))
        point = branching.settled(self.system, self.certify, point, where)
        point = replace(point, leg=self.leg.number, position=fold.position, step=fold.step,
                        event="jump")
        self.history = []
        yield self._accept(point)

    def _leave_once_more(self, fold):
        """NoEquilibrium, none that counts, where jump after jump begins at one load, since nothing
        holds the body: each ends in another of many, and none leads on."""
        place, jumps = self._left_at
        jumps = jumps + 1 if abs(fold.position - place) < SAME else 1
        self._left_at = fold.position, jumps
        if jumps > REPEATED and self.system.neutral(fold) is not None:
            raise NoEquilibrium(
                f"no equilibrium that the load decides on beyond {self._place(fold.position)}: "
                f"nothing holds the body any more, and {jumps - 1} jumps in turn from there led to "
                "others of its many equilibria; prescribe a displacement in place of a force")


def shared(step, position):
    """(step, its end) from a position; the last two steps share what is left, so that none is
    tiny."""
    left = 1.0 - position
    step = (left if left <= step * (1.0 + 1e-9) else min(step, 0.5 * left)
            if left < 2.0 * step else step)
    return step, 1.0 if step == left else position + step


def fold_kind(leg, heading=1.0):
    """Name of the fold that a branch meets as the load moves along a leg, or (heading -1) back."""
    if leg.moving > 0:
        return "sliding"
    return "jump_in" if heading * leg.direction[0] > 0.0 else "pull_off"
