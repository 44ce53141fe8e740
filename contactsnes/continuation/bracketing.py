"""Natural continuation whose folds are bracketed by steps, not located: where jumps are frequent."""

from dataclasses import replace

from . import branching
from .natural import NaturalSteps, fold_kind
from .points import NoEquilibrium, NoFold, NotConverged
from .predictors import after_failure

HALVINGS = 6
"""How often a bracket is halved whose far side belongs to a branch that does not reach back."""
BRACKET = 0.25
"""Part of a leg's first step, and of a fortieth of it, within which a refused step is taken for a
fold."""
SAME = 1e-3
"""Largest way of a node, ranges of the law, from the state that lies behind a bracket to the one
before it, up to which both are one: no fold lies in between."""


class BracketingSteps(NaturalSteps):
    """Steps that do not locate a fold: between a point and a step beyond it that is refused, motion
    under the load of the latter tells.

    It ends in an equilibrium, which is followed back to the point's load. Where that leads to the
    point itself, there is no fold, and steps go on from what was found; where it leads elsewhere,
    the point is the fold, known to the length of the step, and what was found there the end of the
    jump. Where no motion or no way back is found, the fold is located. Parameters as of
    `LoadSteps`.
    """

    def _resumed(self):
        """What follows a fold from which the path goes on: the step behind it is taken up again."""
        last = self.history[-1][1]
        if last.event == "fold" and last.leg == self.leg.number and self.at_fold == "jump":
            yield from self._fold(NotConverged("no way is known out of the fold at "
                                               f"{self._place(last.position)}"), last.step)

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
        place, last = self.history[-1]
        spent = self.system.account()
        try:
            ahead, behind = self._bracketed(place, last, min(place + refused, 1.0))
        except (NotConverged, NoEquilibrium) as failure:
            self.system.log(f"the fold beyond {self._place(place)} is located, since motion does "
                            f"not tell what lies behind it ({failure})")
            yield from super()._fold(error, refused)
            return
        if behind is None:
            yield from self._arrive(*self._examined(replace(ahead, step=refused)))
            return
        width = ahead.position - place
        fold = replace(self._marked(last, width), spent=spent)
        if self.at_fold == "stop":
            yield replace(fold, spent={name: value + spent[name]
                                       for name, value in self.system.account().items()})
            self.stopped = True
            return
        # Two points so near each other foretell no long step.
        step = min(max(2.0 * width, BRACKET * self.shortest), self.leg.initial)
        self.history = []
        points = [self._accept(replace(behind, position=place, step=step, event="jump")),
                  self._accept(replace(ahead, step=step))]
        yield fold
        yield from points

    def _marked(self, last, width):
        """The last point as a fold that is known to a part of the leg."""
        moving = self.leg.moving
        width = abs(width * self.leg.direction[moving]) / max(abs(last.load[moving]), 1e-3)
        return replace(last, leg=self.leg.number, event="fold", fold_kind=fold_kind(self.leg),
                       fold_precision=float(width), step=self.leg.initial, origin=self.leg.start)

    def _bracketed(self, place, last, beyond):
        """(point to which motion beyond a bracket leads, point on its branch before the bracket),
        the second None where the bracket holds no fold.

        Parameters
        ----------
        place, last : the point before the bracket, and its position
        beyond : position of its end
        """
        for _ in range(HALVINGS):
            load = self.leg.load(beyond)
            where = f"at {self.system.told(self.leg.controls, load)}"
            ahead = self.system.settle(last.state, self.leg.controls, load, where, last.state)
            ahead = branching.settled(self.system, self.certify, ahead, where)
            ahead = replace(ahead, leg=self.leg.number, position=beyond)
            try:
                behind = self._back(ahead, place)
            except NotConverged as failure:
                reason, middle = str(failure), 0.5 * (place + beyond)
                self.system.log(f'DEBUG {place} {beyond} {failure}')
            else:
                same = self.system.missed(last.state, behind.state, largest=True) < SAME
                return ahead, None if same else behind
            try:
                return self._step(middle, after_failure(self.predictor)), None
            except NotConverged:
                beyond = middle
        raise NoFold(f"no branch leads back from there: {reason}")

    def _back(self, ahead, place):
        """The point at a place before another one, on its branch; NotConverged where that is not
        clear."""
        state = self.system.along_tangent(ahead, self.leg, ahead.position, place - ahead.position)
        point = self.system.solve(state, self.leg.controls, self.leg.load(place))
        if self.system.strayed(state, ahead.state, point.state) > 0.0:
            raise NotConverged("the way back leads to another branch")
        return replace(point, leg=self.leg.number, jump_work=ahead.jump_work,
                       viscous_work=ahead.viscous_work)
