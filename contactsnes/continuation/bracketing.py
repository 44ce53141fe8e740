"""Natural continuation whose folds are bracketed by steps, not located: where jumps are many."""

from dataclasses import replace

import numpy as np

from . import branching
from .load_steps import MISSED
from .natural import NaturalSteps, fold_kind
from .points import NoEquilibrium, NoFold, NotConverged

BRACKET = 0.25
"""Part of a leg's first step, and of a fortieth of it, within which a refused step is taken for a
fold, and with which the path goes on behind one."""


class BracketingSteps(NaturalSteps):
    """Steps that do not locate a fold: between a point and a step beyond it that is refused, motion
    under the load of the latter tells.

    It ends in an equilibrium (`system.Motion.crossed`). Where the branch leads from there to the
    point without turning, there is no fold, and steps go on from what was found; else the point is
    the fold, known to the length of the step, and what lies beyond it the end of the jump, under
    the load of the point if it is there, or that of the refused step. Where motion does not tell
    the fold is located. Parameters as of `LoadSteps`.
    """

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
        return self._examined(point)

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
        beyond = min(place + refused, 1.0)
        try:
            ahead, end = self.system.crossed(last, self.leg.load(beyond), f"at "
                                             f"{self._place(beyond)}")
            point = self._followed(beyond, ahead) if end is None else None
        except (NotConverged, NoEquilibrium) as failure:
            self.system.log(f"the fold beyond {self._place(place)} is located, since motion does "
                            f"not tell what lies behind it ({failure})")
            yield from super()._fold(error, refused)
            return
        if end is None:
            yield from self._arrive(*self._examined(replace(point, step=beyond - place)))
        else:
            yield from self._left(ahead, end, beyond)

    def _left(self, ahead, end, beyond):
        """Yield the last point as a fold, if it is not told of, the end of its jump, and the point
        at the bracket's far side.

        Parameters
        ----------
        ahead, end : as of `system.Motion.crossed`
        beyond : position of the far side
        """
        (place, last), moved = self.history[-1], self.system.account()
        fold, far = self._marked(last, beyond - place), np.array_equal(end.load,
                                                                       self.leg.load(beyond))
        if self.at_fold == "stop":
            self.stopped = True
            if last.event != "fold":
                yield replace(fold, spent=moved)
            return
        # Two points so near each other foretell no long step.
        step = min(max(2.0 * (beyond - place), BRACKET * self.shortest), self.leg.initial)
        where = f"at {self._place(place)}, beyond the fold ({fold.fold_kind})"
        jump = branching.settled(self.system, self.certify, end, where)
        self.history = []
        jump = self._accept(replace(jump, leg=self.leg.number, position=beyond if far else place,
                                    step=step, event="jump"))
        if last.event != "fold":
            yield fold
        yield replace(jump, spent={name: moved[name] + jump.spent[name] for name in moved})
        if far:
            return
        try:
            point = self._examined(self._step(beyond, self.predictor, ahead))
        except NotConverged:
            return
        yield from self._arrive(replace(point[0], step=step), point[1])

    def _marked(self, last, step):
        """The last point as a fold that is known to a step, a part of the leg, beyond it."""
        moving = self.leg.moving
        width = abs(step * self.leg.direction[moving]) / max(abs(last.load[moving]), 1e-3)
        return replace(last, leg=self.leg.number, event="fold", fold_kind=fold_kind(self.leg),
                       fold_precision=float(width), step=step, origin=self.leg.start,
                       spent=dict.fromkeys(last.spent, 0))

    def _followed(self, beyond, ahead):
        """The point at the end of a bracket without a fold, next to a state; NotConverged where a
        solve does not lead there."""
        last = self.history[-1][1]
        point = self.system.solve(ahead, self.leg.controls, self.leg.load(beyond))
        if self.system.missed(ahead, point.state) > MISSED or self.system.strayed(
                ahead, last.state, point.state) > 0.0:
            raise NotConverged("the solve beyond a refused step leads elsewhere than motion")
        return point.changed(leg=self.leg.number, position=beyond)

    def _look_ahead(self, error, step):
        """Yield what stops the steps; where that is not found, what motion leads to further on: no
        path ends because a spot will not settle."""
        try:
            yield from self._fold(error, 4.0 * step)
            return
        except NoFold as failure:
            reason = failure
        place, last = self.history[-1]
        for width in (4.0 * step, BRACKET * self.shortest, self.shortest):
            beyond = min(place + width, 1.0)
            where = f"at {self._place(beyond)}"
            try:
                point = self.system.settle(last.state, self.leg.controls, self.leg.load(beyond),
                                           where)
            except NotConverged as failure:
                reason = failure
                continue
            self.system.log(f"{reason}: the path goes on {where}, where motion from its last "
                            "point leads; the load of that jump is known to this step only")
            spent = self.system.account()
            fold = self._marked(last, beyond - place)
            self.history = []
            point = replace(point, leg=self.leg.number, position=beyond, step=self.leg.initial,
                            event="jump")
            point = self._accept(branching.settled(self.system, self.certify, point, where))
            yield fold
            yield replace(point, spent={name: spent[name] + point.spent[name] for name in spent})
            return
        yield from super()._look_ahead(reason, step)
