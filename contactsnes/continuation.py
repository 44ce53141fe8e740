"""Branches of equilibria: points, predictors, step control, folds, jumps and events.

A branch is an iterator of converged points along the legs of a load path. What is solved, and how, is the business of the
``system`` that ``branch`` is given (``contactsnes.snes.Corrector``); here a state is something that the system combines.
"""

from dataclasses import dataclass, field, replace

import numpy as np

FOLD_TOLERANCE = 1e-6
"""Relative accuracy in the load to which a fold is located; a step of the search promises less than this."""
SHORT = 0.1
"""Steps that had to be cut below this part of the leg's initial one look like a fold: arc length finds out."""
KICKS = (0.1, 0.3, 1.0, 3.0)
"""How far beyond a fold, in ranges of the law where it acts, the motion of a jump begins; the next if it leads back."""


class NotConverged(RuntimeError):
    """A solve ended without a converged point; the message names PETSc's reasons."""


class NoEquilibrium(RuntimeError):
    """No equilibrium exists under the present loads: the body leaves, or slides without end."""


@dataclass(frozen=True)
class Point:
    """A converged point of a branch.

    Attributes
    ----------
    state : displacements and means (``contactsnes.states.State``)
    controls : 'displacement' or 'force' for each component
    load : controlled values (u_n,r, u_t,r or w_n,r, w_t,r by ``controls``)
    displacements, forces : D, U, ... and W, T, ... of each component, controlled or not
    leg, position, step : leg of the path (0: start), place in it (0 to 1) and the step to try next (same unit)
    origin : controlled values where the leg began
    in_contact, sliding : whether a node is in contact; whether all of those have slipped past the law's peak
    residual_norm : of the archive
    spent : name -> count of iterations, evaluations, transforms and time since the point before
    event, fold_kind : as in the archive
    """

    state: object
    controls: tuple
    load: np.ndarray
    displacements: np.ndarray
    forces: np.ndarray
    in_contact: bool
    sliding: bool
    residual_norm: float
    leg: int = 0
    position: float = 0.0
    step: float = 0.0
    origin: np.ndarray = None
    spent: dict = field(default_factory=dict)
    event: str = "none"
    fold_kind: str = ""


@dataclass(frozen=True)
class Leg:
    """A straight leg between two sets of controlled values, and the sizes of its steps as parts of its length."""

    number: int
    controls: tuple
    start: np.ndarray
    end: np.ndarray
    moving: int
    initial: float
    largest: float
    smallest: float

    @property
    def direction(self):
        """Change of the controlled values along the whole leg."""
        return self.end - self.start

    def load(self, position):
        """Controlled values at a place of the leg, exact at its end."""
        return self.end.copy() if position == 1.0 else self.start + position * self.direction


def lagrange_weights(nodes, target):
    """Weights of values at ``nodes`` whose sum is the polynomial through them at ``target``."""
    nodes = np.asarray(nodes, dtype=float)
    return np.array([np.prod((target - np.delete(nodes, k)) / (nodes[k] - np.delete(nodes, k)))
                     for k in range(len(nodes))])


def predict(system, history, leg, position, kind):
    """The state from which a solve at ``position`` starts, from the leg's last points [(position, point), ...]."""
    here, last = history[-1]
    if kind == "none":
        return last.state
    if len(history) > 1 and kind != "tangent":
        used = history[-3:] if kind == "edge" else history[-2:]
        points = [point for _, point in used]
        weights = lagrange_weights([place for place, _ in used], position)
        followed = system.follow_edge(points, weights) if kind == "edge" else system.extrapolate(points, weights)
        if followed is not None:
            return followed
    if kind == "secant":
        return last.state
    return system.along_tangent(last, leg, here, position - here)


def grown(step, iterations, largest, target=8):
    """The next step after a success: longer by up to twice the fewer iterations it took (as in BifurcationKit)."""
    if iterations >= target:
        return min(largest, step * max(0.5, target / iterations))
    return min(largest, step * (1.0 + ((target - iterations) / target) ** 2))


class Walk:
    """Natural continuation along one leg: an iterator of points, with rollback, folds and jumps.

    Parameters
    ----------
    system : what solves (``Corrector``)
    leg : Leg
    history : [(position, point), ...] of this leg, oldest first; the last one is where the walk goes on
    predictor : 'none', 'secant', 'tangent' or 'edge'
    at_fold : 'jump' or 'stop'
    """

    def __init__(self, system, leg, history, predictor, at_fold):
        self.system, self.leg = system, leg
        self.history = [(place, system.adapted(point, leg.controls, leg.load(place))) for place, point in history]
        self.predictor, self.at_fold = predictor, at_fold
        self.stopped = False

    def __iter__(self):
        position, point = self.history[-1]
        step = point.step if point.leg == self.leg.number and point.step > 0.0 else self.leg.initial
        failures = 0
        while self.history[-1][0] < 1.0:
            position = self.history[-1][0]
            # The last two steps share what is left, so that none is tiny.
            left = 1.0 - position
            step = left if left <= step * (1.0 + 1e-9) else min(step, 0.5 * left) if left < 2.0 * step else step
            target = 1.0 if step == left else position + step
            try:
                point = self._step(target, "tangent" if failures >= 1 and self.predictor == "edge" else self.predictor)
            except NotConverged as error:
                failures, step = failures + 1, 0.25 * step
                self.system.log(f"step to {self._place(target)} failed ({error}); the next one is {step:.3g} of the leg")
                if failures >= 2 or step < max(self.leg.smallest, SHORT * self.leg.initial):
                    yield from self._fold(error)
                    if self.stopped:
                        return
                    failures, step = 0, self.leg.initial
                continue
            failures = max(0, failures - 0.5)
            step = grown(step, point.spent["last_iterations"], self.leg.largest)
            yield self._accept(replace(point, step=step))

    def _place(self, position):
        return ", ".join(f"{name} {value:.6g}" for name, value in
                         zip(self.system.names(self.leg.controls), self.leg.load(position)))

    def _step(self, target, predictor):
        """Predict and correct; a correction as long as the step itself is another branch's, not a neighbour."""
        guess = predict(self.system, self.history, self.leg, target, predictor)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(target))
        last = self.history[-1][1]
        missed, moved = self.system.missed(guess, point.state), self.system.missed(last.state, point.state)
        astray = predictor != "none" and missed > 0.2 and missed > 0.6 * moved
        if astray or moved > 1.0 and moved > 8.0 * self._expected(target):
            raise NotConverged(f"the solve ended {missed:.3g} ranges from its prediction, {moved:.3g} from the last point, "
                               "perhaps on another branch")
        return replace(point, leg=self.leg.number, position=target)

    def _expected(self, target):
        """How far a step to ``target`` would move at the rate of the last one; inf for a first step."""
        if len(self.history) < 2:
            return np.inf
        (before, first), (here, last) = self.history[-2:]
        return self.system.missed(first.state, last.state) * (target - here) / (here - before)

    def _accept(self, point):
        """The one place where a point of a leg is accepted."""
        point = replace(point, origin=self.leg.start, spent=self.system.account())
        self.history = [*self.history[-3:], (point.position, point)]
        return point

    def _fold(self, error):
        """Find out what stops the walk; yield the fold and, by default, the point after the jump."""
        try:
            fold, beyond, passed = Turn(self.system, self.leg, self.history).search(error)
            starts = [lambda kick=kick: self.system.kicked(fold.state, beyond, kick) for kick in KICKS]
        except NotConverged:
            fold, lowered, passed = self.history[-1][1], self.system.lowered(self.history[-1][1]), None
            if lowered is None:
                raise
            starts = [lambda: lowered]
        if fold is None:
            yield self._accept(passed)
            return
        kind = fold_kind(self.leg)
        fold = self._accept(replace(fold, event="fold", fold_kind=kind))
        yield fold
        if self.at_fold == "stop":
            self.stopped = True
            return
        point = self._jump(fold, starts, f"beyond the fold ({kind}) at {self._place(fold.position)}")
        point = replace(point, leg=self.leg.number, position=fold.position, step=self.leg.initial, event="jump")
        self.history = []
        yield self._accept(point)

    def _jump(self, fold, starts, where):
        """The equilibrium at the fold's load to which motion leads from the first of some starts that does not lead back."""
        for start in starts:
            state = start()
            point = self.system.settle(state, self.leg.controls, fold.load, where)
            if self.system.missed(fold.state, point.state) > 0.5 * self.system.missed(fold.state, state):
                return point
            self.system.log(f"the motion {where} led back to it; trying again from farther away")
        raise NotConverged(f"no other equilibrium was reached {where}: the motion led back")


def fold_kind(leg):
    """Name of the fold that ends natural continuation along a leg."""
    if leg.moving > 0:
        return "sliding"
    return "jump_in" if leg.direction[0] > 0.0 else "pull_off"


class Turn:
    """Arc-length search for the fold beyond the last point of a leg: the load is one more unknown of the solve."""

    def __init__(self, system, leg, history, most=60):
        self.system, self.leg, self.history, self.most = system, leg, list(history), most

    def search(self, error):
        """(fold point, state beyond it, None), or (None, None, point) where the branch goes on past the trouble.

        Raises NotConverged (``error`` again) where no solution can be followed any further.
        """
        trail = self._trail()
        reach = self.history[-1][0] + self.leg.initial
        first = length = self.system.distance(trail[0][1].state, trail[1][1].state)
        for taken in range(self.most):
            try:
                point = self._ahead(trail, length)
            except NotConverged as second:
                length *= 0.25
                if length < 1e-4 * first:
                    raise NotConverged(f"{error}; following the branch by arc length failed too: {second}") from None
                continue
            trail.append((point.position, point))
            arc, slope = self._slopes(trail[-3:])
            if slope[2] <= 0.0:
                found, trail = self._locate(trail[-3:])
                if found is not None:
                    return (*found, None)
                continue
            steady = slope[2] > 0.7 * slope[1]
            if steady and (point.position >= 1.0 or (point.position > reach and taken > 6)):
                return None, None, self._natural(trail, min(point.position, 1.0))
            length *= 1.7 if steady and point.spent["last_iterations"] <= 6 else 1.0
        raise NotConverged(f"{error}; arc length made no headway either")

    def _slopes(self, trail):
        """Places on the arc of three points, and d(position)/d(arc length) there by the parabola through them."""
        distance = self.system.distance
        arc = np.array([-distance(trail[0][1].state, trail[1][1].state), 0.0,
                        distance(trail[1][1].state, trail[2][1].state)])
        curvature, slope, _ = np.polyfit(arc, [place for place, _ in trail], 2)
        return arc, slope + 2.0 * curvature * arc

    def _trail(self):
        """The last two points, made by a tiny tangent step where the leg has only begun."""
        if len(self.history) > 1:
            return [(position, point) for position, point in self.history[-2:]]
        here, last = self.history[-1]
        step = max(self.leg.smallest, 1e-3 * self.leg.initial)
        guess = self.system.along_tangent(last, self.leg, here, step)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(here + step))
        return [(here, last), (here + step, point)]

    def _ahead(self, trail, length):
        """The point at a given arc length beyond the last two."""
        (before, first), (here, last) = trail[-2:]
        return self._at(last, here, first, before, length)

    def _at(self, last, here, first, before, length):
        """The point at arc length ``length`` from ``last`` in the direction from ``first`` to it."""
        point, position = self.system.solve_arc(first.state, last.state, before, here, length, self.leg)
        return replace(point, leg=self.leg.number, position=position)

    def _natural(self, trail, target):
        """A point at a given place of the leg, from two neighbours on the branch."""
        weights = lagrange_weights([place for place, _ in trail[-2:]], target)
        guess = self.system.extrapolate([point for _, point in trail[-2:]], weights)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(target))
        return replace(point, leg=self.leg.number, position=target, step=self.leg.initial)

    def _locate(self, trail):
        """((fold, state beyond it), trail) from three points on the arc, the load's peak near the last, refined by parabolas.

        The first is None where the load goes on rising: a bend may look like a peak.
        """
        trail = self._bracketed(trail)
        if trail[2][0] >= trail[1][0]:
            return None, trail
        beyond = trail[2][1]
        for _ in range(12):
            arc, slopes = self._slopes(trail)
            curvature = (slopes[2] - slopes[0]) / (arc[2] - arc[0]) / 2.0
            shift = -0.5 * slopes[1] / curvature
            if abs(curvature) * shift ** 2 * self._scale() < FOLD_TOLERANCE:
                break
            toward = 0 if shift < 0.0 else 2
            try:
                found = self._at(trail[1][1], trail[1][0], trail[toward][1], trail[toward][0], -abs(shift))
            except NotConverged:
                break
            between = [trail[0], (found.position, found), *trail[1:]] if shift < 0.0 else \
                [*trail[:2], (found.position, found), trail[2]]
            best = 1 if between[1][0] > between[2][0] else 2
            trail = between[best - 1:best + 2]
        fold = max(trail, key=lambda item: item[0])[1]
        return (replace(fold, step=self.leg.initial), beyond.state), trail

    def _bracketed(self, trail):
        """The last three points after going on along the arc until the load falls, or for eight steps."""
        length = 0.5 * self._slopes(trail)[0][2]
        for _ in range(8):
            if trail[2][0] < trail[1][0]:
                break
            try:
                ahead = self._ahead(trail, length)
            except NotConverged:
                length *= 0.25
                continue
            trail = [*trail[1:], (ahead.position, ahead)]
        return trail

    def _scale(self):
        """Relative change of the moving load per change of position."""
        moving = self.leg.moving
        reached = self.leg.load(self.history[-1][0])[moving]
        return abs(self.leg.direction[moving]) / max(abs(reached), 1e-3)


def events_between(previous, point):
    """Names of the events that a point has besides its own: first gross sliding, first loss of contact."""
    if previous is None:
        return []
    found = []
    if point.sliding and not previous.sliding:
        found.append("gross_sliding")
    if previous.in_contact and not point.in_contact:
        found.append("pull_off")
    return found


def with_events(previous, point):
    """The point, then a copy for every further event at the same load; a point without an event takes the first."""
    names = events_between(previous, point)
    if point.event == "none" and names:
        point = replace(point, event=names.pop(0))
    yield point
    for name in names:
        yield replace(point, event=name, fold_kind="", spent={key: 0 * value for key, value in point.spent.items()})


def branch(system, start, legs, *, predictor="edge", at_fold="jump", stops=(), history=()):
    """Iterate over the converged points of a load path.

    Parameters
    ----------
    system : solves, extrapolates and jumps (``Corrector``)
    start : function () -> Point, the first point with what it cost, for a path without ``history``
    legs : functions (last point) -> Leg or None (nothing to do), one a leg
    predictor, at_fold : options ``-continuation_*``
    stops : names of events that end the path
    history : the last points of an interrupted path, oldest first

    Raises
    ------
    NotConverged, NoEquilibrium : after the points before the failure have been handed out
    """
    emitted = list(history)
    if emitted and (emitted[-1].event in stops or (at_fold == "stop" and emitted[-1].event == "fold")):
        return
    if emitted:
        # A jump may have been archived without the further events at its load.
        fresh = list(with_events(emitted[-2] if len(emitted) > 1 else None, emitted[-1]))[1:] \
            if emitted[-1].event == "jump" else []
    else:
        fresh = [start()]
    for point in fresh:
        emitted.append(point)
        yield point
        if point.event in stops:
            return
    for number, make_leg in enumerate(legs, start=1):
        if number < emitted[-1].leg:
            continue
        leg = make_leg(emitted)
        if leg is None:
            continue
        walk = Walk(system, leg, leg_history(emitted, number), predictor, at_fold)
        for arrived in walk:
            previous = emitted[-1]
            for point in with_events(previous, arrived):
                emitted = [*emitted[-5:], point]
                yield point
                if point.event in stops:
                    return
        if walk.stopped:
            return


def leg_history(points, number):
    """[(position, point), ...] of the points that a walk along leg ``number`` extrapolates from."""
    found = []
    for point in reversed(points):
        found.append((point.position if point.leg == number else 0.0, point))
        if point.leg != number or point.event == "jump":
            break
    distinct = [found[0]] + [later for earlier, later in zip(found, found[1:]) if later[0] < earlier[0]]
    return distinct[::-1]
