"""Natural continuation whose folds are bracketed by steps, not located: where jumps are many."""

import math
from dataclasses import replace

from . import branching
from .load_steps import MISSED
from .natural import NaturalSteps, fold_kind
from .points import NoEquilibrium, NoFold, NotConverged, NoWayBack, without_frames
from .predictors import PREDICTORS
from .predictors.edge import SPOTS
from .turning import BRACKET, TurnSearch, starts

USED = 0.6
"""Part of what nodes may stray from their prediction that steps are to use: those that use less
grow, and those that use more get shorter. With more of it they are refused too often (measured)."""


class BracketingSteps(NaturalSteps):
    """Steps that do not locate a fold: between a point and a step beyond it that is refused, motion
    under the load of the latter tells.

    It ends in an equilibrium, which is followed back to the load of the point, or of one between
    (`system.Motion.crossed`). Where that leads to the point itself, there is no fold, and steps go
    on from what was found; where it leads elsewhere, the point is the fold, known to the length of
    the step, and what was found there the end of the jump. Where no way back is found, or one to
    more energy, the branch is followed by arc length to where its load turns
    (`turning.TurnSearch`): a small jump, or a steep branch without one. Where no motion is found
    the fold is located. Parameters as of `LoadSteps`.
    """

    def __init__(self, *given, **others):
        super().__init__(*given, **others)
        if self.predictor is PREDICTORS["edge"]:
            self.predictor = SPOTS

    def _resumed(self):
        """What follows a fold from which the path goes on: the step behind it is taken up again."""
        last = self.history[-1][1]
        if last.event == "fold" and last.leg == self.leg.number and self.at_fold == "jump":
            yield from self._fold(NotConverged("no way is known out of the fold at "
                                               f"{self._place(last.position)}"), last.step)

    def _tried(self, target, predictor):
        """As of `NaturalSteps`; NotConverged where linear solves met an unstable mode: motion tells
        what the branch does there, at less than the modes of everything cost."""
        point = self._step(*self._foreseen(target, predictor))
        if point.stable < 0 and point.softest < 0.0 and not self.history[-1][1].softest < 0.0:
            raise NotConverged("a mode lost its stability in the step")
        return self._examined(self._probed(point))

    def _next(self, step, point):
        """As of `NaturalSteps`, and by the part that the step used of the room that nodes have:
        they stray with its square, about."""
        longest = step * math.sqrt(USED / self._used) if self._used > 0.0 else math.inf
        return min(super()._next(step, point), longest)

    def _accept(self, point):
        """As of `NaturalSteps`; points before the last one, which but foretell others, take less
        memory."""
        point = super()._accept(point)
        places, points = zip(*self.history)
        self.history = [*zip(places, self.system.lighter(points))]
        return point

    def _due(self, refused, failures):
        """Whether a refused step is to be taken for a fold."""
        return refused <= BRACKET * self.shortest

    def _fold(self, error, refused):
        """Find out what stops the steps before the end of a refused step; yield what is there.

        Parameters
        ----------
        error : NotConverged, why the step was refused
        refused : float, its length
        """
        spent = self.system.account()
        for point in self._searched(error, refused):
            yield point.changed(spent={name: spent[name] + point.spent[name] for name in spent})
            spent = dict.fromkeys(spent, 0)

    def _searched(self, error, refused):
        """As of `_fold`, without what was spent before."""
        place, last = self.history[-1]
        beyond, failure = min(place + refused, 1.0), None
        try:
            found = self.system.crossed(last, self.leg.load(beyond), f"at {self._place(beyond)}")
        except (NotConverged, NoEquilibrium) as caught:
            failure = caught
        if failure is not None:  # not where it is caught, as in `NaturalSteps.__iter__`
            yield from self._untold(failure, error, refused)
            return
        begin = place + found.begin * (beyond - place)
        if found.end < 1.0:
            beyond = place + found.end * (beyond - place)
        if begin > place:
            try:
                nearer = self._examined(self._nearer(found, begin, beyond))
            except NotConverged as failure:
                yield from self._by_arc(failure, error, refused)
                return
            yield from self._arrive(*nearer)
            if self.history[-1][0] != begin:
                return
        yield from (self._onward(error, found, beyond) if found.behind is None
                    else self._left(found, beyond))

    def _untold(self, failure, error, refused):
        """What `_fold` yields where a failure of motion, or of the way back, leaves the bracket
        untold: by arc length or, where there was no motion, with the fold located."""
        without_frames(failure)
        if isinstance(failure, NoWayBack):
            yield from self._by_arc(failure, error, refused)
            return
        self.system.log(f"the fold beyond {self._place(self.history[-1][0])} is located, since "
                        f"motion does not tell what lies behind it ({failure})")
        yield from super()._fold(error, refused)

    def _nearer(self, found, place, beyond):
        """The point of a `Crossing` before its jump, a fold if it has one, at the begin of a
        bracket between two places."""
        point = replace(found.before, leg=self.leg.number, position=place, step=beyond - place)
        return point if found.behind is None else self._marked(point, beyond - place)

    def _onward(self, error, found, beyond):
        """Yield the point at the end of a bracket without a fold, next to its `Crossing`'s state;
        by arc length where a solve does not lead there."""
        place, last = self.history[-1]
        try:
            point = self.system.solve(found.ahead, self.leg.controls, self.leg.load(beyond))
            if self.system.missed(found.ahead, point.state) > MISSED or self.system.strayed(
                    found.ahead, last.state, point.state) > 0.0:
                raise NotConverged("the solve beyond a refused step leads elsewhere than motion")
        except NotConverged as failure:
            yield from self._by_arc(failure, error, beyond - place)
            return
        yield from self._arrive(*self._examined(point.changed(
            leg=self.leg.number, position=beyond, step=beyond - place)))

    def _by_arc(self, failure, error, refused):
        """What `_fold` yields, by arc length; why that is asked."""
        self.system.log(f"{failure}: following it by arc length from "
                        f"{self._place(self.history[-1][0])}")
        yield from super()._fold(error, refused, TurnSearch, starts)

    def _left(self, found, beyond):
        """Yield the last point as a fold, if it is not told of, the end of its jump, and the point
        behind it at the bracket's far side.

        Parameters
        ----------
        found : `Crossing`
        beyond : position of the far side
        """
        (place, last), moved = self.history[-1], self.system.account()
        fold = replace(self._marked(last, beyond - place), spent=dict.fromkeys(moved, 0))
        if self.at_fold == "stop":
            self.stopped = True
            if last.event != "fold":
                yield replace(fold, spent=moved)
            return
        # Two points so near each other foretell no long step.
        step = min(max(2.0 * (beyond - place), BRACKET * self.shortest), self.leg.initial)
        where = f"at {self._place(place)}, beyond the fold ({fold.fold_kind})"
        jump = branching.settled(self.system, self.certify, found.behind, where)
        self.history = []
        jump = self._accept(replace(jump, leg=self.leg.number, position=place, step=step,
                                    event="jump"))
        if last.event != "fold":
            yield fold
        yield replace(jump, spent={name: moved[name] + jump.spent[name] for name in moved})
        try:
            point = self._examined(self._probed(self._step(beyond, self.predictor, found.ahead)))
        except NotConverged:
            return
        yield from self._arrive(replace(point[0], step=step), point[1])

    def _marked(self, last, step):
        """The last point as a fold that is known to a step, a part of the leg, beyond it."""
        moving = self.leg.moving
        width = abs(step * self.leg.direction[moving]) / max(abs(last.load[moving]), 1e-3)
        return replace(last, leg=self.leg.number, event="fold", fold_kind=fold_kind(self.leg),
                       fold_precision=float(width), step=step, origin=self.leg.start,
                       **self._let_go(last))

    def _let_go(self, last):
        """How a fold where the leg begins, whose controls do not hold what others held, is marked
        as unstable; told."""
        if last.leg == self.leg.number or last.event == "fold":
            return {}
        count = self.system.examiner or self.certify
        modes = count(replace(last, event=None, tangents=())).unstable_modes
        if modes <= 0:
            return {}
        self.system.log(f"leg {self.leg.number} begins at an equilibrium that is unstable under "
                        f"its controls (modes: {modes}), at {self._place(self.history[-1][0])}: "
                        "what is marked as a fold is where the body leaves it, no limit point")
        return {"stable": 0, "unstable_modes": modes}

    def _look_ahead(self, error, step):
        """Yield what stops the steps; where that is not found, or motion finds no way out of it,
        what motion leads to further on: no path ends because a spot will not settle. Where nothing
        is found at all, shorter steps go on, and, where none are left, motion to the leg's end."""
        try:
            yield from self._fold(error, 4.0 * step)
            return
        except NotConverged as failure:
            reason, unknown = failure, isinstance(failure, NoFold)
        place, last = self.history[-1]
        for beyond in self._further(place, step, not unknown or step < self.leg.smallest):
            where = f"at {self._place(beyond)}"
            try:
                point = self.system.settle(last.state, self.leg.controls, self.leg.load(beyond),
                                           where)
            except NotConverged as failure:
                reason = failure
                continue
            yield from self._jumped(point, beyond, where, reason)
            return
        if not unknown:
            raise reason
        self._shorten(reason, step)

    def _further(self, place, step, far):
        """Yield places beyond a place, where a step was refused, up to the leg's end if it is to be
        ``far``."""
        width = self.shortest
        yield from (min(place + near, 1.0) for near in (4.0 * step, BRACKET * width, width))
        while far and place + width < 1.0:
            width *= 2.0
            yield min(place + width, 1.0)

    def _jumped(self, point, beyond, where, reason):
        """Yield the last point as a fold, if it is not told of, and, by default, a point to which
        motion under a load beyond leads.

        Parameters
        ----------
        point : Point
        beyond : position of that load
        where : str, what messages say of it
        reason : NotConverged, why nothing nearer is known
        """
        (place, last), spent = self.history[-1], self.system.account()
        fold = replace(self._marked(last, beyond - place), spent=dict.fromkeys(spent, 0))
        if self.at_fold == "stop":
            self.stopped = True
            self.system.log(f"{reason}: the path stops at {self._place(place)}, since motion from "
                            f"there comes to rest {where}; the load of that fold is known to this "
                            "step only")
            if last.event != "fold":
                yield replace(fold, spent=spent)
            return
        self.system.log(f"{reason}: the path goes on {where}, where motion from its last point "
                        "leads; the load of that jump is known to this step only")
        self.history = []
        point = replace(point, leg=self.leg.number, position=beyond, step=self.leg.initial,
                        event="jump")
        point = self._accept(branching.settled(self.system, self.certify, point, where))
        if last.event != "fold":
            yield fold
        yield replace(point, spent={name: spent[name] + point.spent[name] for name in spent})
