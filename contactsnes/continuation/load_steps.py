"""Steps of the load along a leg: predicted, solved, refused where they end on another branch."""

from dataclasses import replace

import numpy as np

from . import softening
from .points import NotConverged
from .predictors import PREDICTORS

MISSED = 0.15
"""Ranges of the law that a solve may end from its prediction whatever the way of the step: edges of
contact that pass nodes miss by as much."""
SHARE = 0.5
"""Part of its own way by which a step may miss its prediction: what lies on another branch may be
missed by the whole way."""
FAR = 0.3
"""Ranges of the law from which on the way of a step is compared with that of the last one."""
FASTER = 4.0
"""How much farther than the last step, per unit of the load, one may lead that missed its
prediction."""
HURRIED, FAST = 0.05, 2.0
"""Ranges of the law, and how much faster than the last step, from which on one that ended near its
prediction is asked whether the branch leads back."""
FIRST = 1.0
"""Way of a first step, ranges of the law, from which on the tangent at its end has to lead back."""
FURTHEST = 1.5
"""Way of a first step under a force by its tangent, ranges of the law, beyond which it is shortened
at once: solves that begin farther off mostly end on another branch."""
BACK = 0.8
"""Part of the way of a step that the tangent at its end leads back, up to which what ended off its
predictions may lie beyond a jump. (A parabola just behind its fold has one half, but is foretold in
shorter steps.)"""
SURE = 0.07
"""Part of its way by which a step may miss the prediction by three points or more without being
asked what it released."""
LED = 0.5
"""What `BACK` is where much was released on the way though predictions have the nodes where they
ended: that of a parabola just behind its fold. (Smooth steps have 0.57 and more, those over a jump
0.41 and less, in some 14000 steps of random scenes.)"""
LITTLE = 0.02
"""Part of a first step by which its tangent tells how fast edges of contact move: so short that
they stay in place."""


def predict(system, history, leg, position, predictor):
    """The state from which a solve begins.

    Parameters
    ----------
    system : System
    history : [(position, Point), ...] of the leg, oldest first
    leg : Leg
    position : where the solve is to be, a place in the leg
    predictor : Predictor
    """
    (here, last), (places, points) = history[-1], zip(*history)
    return predictor.state(system, points, places, position,
                           lambda: system.along_tangent(last, leg, here, position - here))


class LoadSteps:
    """Steps along one leg, from the points of it that are known.

    What nodes may stray from a prediction and what of that a step used (``_used``, about 0 to 1) is
    of the best prediction that was asked.

    Parameters
    ----------
    system : System
    leg : Leg
    history : [(position, point), ...] of this leg, oldest first; the last one is where the steps
        go on
    predictor : Predictor
    at_fold : 'jump' or 'stop'
    certify : function (Point) -> Point that says of a point that is accepted whether it is stable
        (`system.Stability`)
    at_bifurcation : 'pass', 'stop' or 'follow'
    """

    def __init__(self, system, leg, history, predictor, at_fold, certify=lambda point: point,
                 at_bifurcation="pass"):
        self.system, self.leg = system, leg
        # What was stable under other controls may not be under these.
        self.history = [(place, system.adapted(point if point.controls == leg.controls
                                               else point.changed(stable=-1), leg.controls,
                                               leg.load(place))) for place, point in history]
        self.predictor, self.at_fold = predictor, at_fold
        self.certify, self.at_bifurcation = certify, at_bifurcation
        self.stopped, self._used = False, 0.0

    def _place(self, position):
        """Loads at a position, in words."""
        return self.system.told(self.leg.controls, self.leg.load(position))

    def _foreseen(self, target, predictor):
        """(place, predictor, prediction) of a step; nearer than asked for where a first one under a
        force, which holds no displacement, would lead too far."""
        guess = predict(self.system, self.history, self.leg, target, predictor)
        here, last = self.history[-1]
        first = len(self.history) == 1 and self.leg.controls[self.leg.moving] == "force"
        far = self.system.missed(last.state, guess) / FURTHEST if first else 0.0
        if 1.0 < far < np.inf:
            target = here + (target - here) / far
            guess = predict(self.system, self.history, self.leg, target, predictor)
        return target, predictor, guess

    def _step(self, target, predictor, guess=None):
        """Predict and correct; a correction as long as the step itself is another branch's, not a
        neighbour."""
        if guess is None:
            guess = predict(self.system, self.history, self.leg, target, predictor)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(target))
        last = self.history[-1][1]
        missed, moved = self.system.ways(guess, last.state, point.state)
        wrong, self._led = 0.0 if guess is last.state else missed, None
        if len(self.history) == 1 and moved > FIRST:
            # Nothing tells how far a first step goes, and a tangent next to a fold may hit another
            # branch: look back.
            wrong = max(wrong, self.system.missed(self._way_back(target, point), last.state))
        far = missed > MISSED and moved > FAR and moved > FASTER * self._expected(target)
        aside = (f"the solve ended {max(missed, wrong):.3g} ranges from its prediction, "
                 f"{moved:.3g} from the last point"
                 if far or (wrong > MISSED and wrong > SHARE * moved)
                 else self._strayed(guess, target, point))
        if not aside and (len(self.history) < 3 or missed > SURE * moved):
            aside = self._leapt(target, point)
        if not aside and moved > HURRIED and moved > FAST * (usual := self._expected(target)):
            aside = self._hurried(target, point, missed > SHARE * moved and moved > FASTER * usual)
        if aside:
            raise NotConverged(f"{aside}, perhaps on another branch")
        return point.changed(leg=self.leg.number, position=target)

    def _probed(self, point):
        """The point of a step, asked for what lies in between (`softening.probe`); apart from
        the step, since predictions take much memory."""
        softening.probe(self.system, self.leg, self.history, point)
        return point

    def _strayed(self, guess, target, point):
        """How some nodes ended where no prediction has them, however the solve began, or off all of
        them by much of their way: part of the contact has jumped. '' where none did."""
        (here, last), doubted, off, used = self.history[-1], None, False, []
        for foretold in self._foretold(guess, target):
            beyond = self.system.strayed(foretold, last.state, point.state)
            if not off:
                used.append(1.0 + beyond / self.system.leeway)
                self._used = max(min(used), 0.0)
            if beyond <= 0.0:
                if self.system.doubtful(foretold, last.state, point.state):
                    doubted = foretold if doubted is None else doubted
                elif self.system.adrift(foretold, last.state, point.state):
                    off = True
                else:
                    return ""
        if doubted is None and not off:
            return "nodes of the solve ended where no prediction has them"
        back = self._way_back(target, point)
        if doubted is None:
            return "" if self._led > BACK else ("nodes of the solve ended off all predictions, and "
                                                "the branch there hardly leads back")
        if not self.system.detached(doubted, last.state, point.state, back):
            return ""
        del foretold, doubted, back  # whose memory the next one takes
        # A linear solve more is dear, but less so than a step that is refused for nothing.
        ahead = self.system.along_tangent(last, self.leg, here, target - here)
        snapped = (self.system.strayed(ahead, last.state, point.state) > 0.0
                   or self.system.doubtful(ahead, last.state, point.state))
        return "nodes of the solve released energy on their way" if snapped else ""

    def _leapt(self, target, point):
        """How a step released energy to end where predictions have it, but the branch does not lead
        back. '' where it does."""
        if not self.system.leapt(self.history[-1][1].state, point.state):
            return ""
        if self._led is None:
            self._way_back(target, point)
        return "" if self._led > LED else ("nodes released energy on their way, and the branch "
                                           "where they ended hardly leads back")

    def _hurried(self, target, point, missed):
        """How a step went much faster than the last one to where predictions have it, or ``missed``
        these by much of its way: across a small jump, or to the other side of a pitchfork that is
        nearly one. '' where the branch leads back."""
        if not missed and self._led is None:
            self._way_back(target, point)
        return "" if not missed and self._led > LED else (
            "the step went much faster than the last one")

    def _way_back(self, target, point):
        """Where the tangent at the end of a step leads on the way back; what part of that way it
        leads is kept for who asks next."""
        here, last = self.history[-1]
        back = self.system.along_tangent(point, self.leg, target, here - target)
        self._led = self.system.progress(point.state, last.state, back)
        return back

    def _foretold(self, guess, target):
        """Predictions of the state at a place, the cheapest first: the guess, if it is one, and
        those by fewer or more points."""
        here, last = self.history[-1]
        if guess is not last.state:
            yield guess
        for used in ((3, 2) if len(self.history) > 2 else (2,) if len(self.history) > 1 else ()):
            yield predict(self.system, self.history[-used:], self.leg, target,
                          PREDICTORS["edge"])
            yield predict(self.system, self.history[-used:], self.leg, target,
                          PREDICTORS["secant"])
        if len(self.history) == 1:
            yield from self._foretold_by_tangent(guess, target)

    def _foretold_by_tangent(self, guess, target):
        """Predictions of a first step by the tangent where it begins: in place, and with the edges
        of contact moved on."""
        here, last = self.history[-1]
        if guess is last.state:
            yield self.system.along_tangent(last, self.leg, here, target - here)
        near = replace(last, state=self.system.along_tangent(last, self.leg, here,
                                                             LITTLE * (target - here)))
        followed = self.system.follow_edge([last, near], [1.0 - 1.0 / LITTLE, 1.0 / LITTLE])
        if followed is not None:
            yield followed

    def _expected(self, target):
        """How far a step to ``target`` would move at the rate of the last one; inf for a first
        step."""
        if len(self.history) < 2:
            return np.inf
        (before, first), (here, last) = self.history[-2:]
        return self.system.missed(first.state, last.state) * (target - here) / (here - before)
