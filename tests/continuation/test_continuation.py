"""Continuation on problems of one or two unknowns whose branches, folds and bends are known in
closed form."""

import weakref
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import expit

from contactsnes.continuation import departures
from contactsnes.continuation.arclength import ArcLengthSteps
from contactsnes.continuation.events import with_events
from contactsnes.continuation.folds import FoldSearch
from contactsnes.continuation.leaps import leapt
from contactsnes.continuation.limit_points import FOLD_TOLERANCE, LimitPoint
from contactsnes.continuation.load_steps import predict
from contactsnes.continuation.natural import (
    REPEATED,
    NaturalSteps,
    fold_kind,
    grown,
    leg_history,
)
from contactsnes.continuation.path import branch
from contactsnes.continuation.points import (
    Crossing,
    Direction,
    Leg,
    NoEquilibrium,
    NoFold,
    NotConverged,
    Point,
    lagrange_weights,
    without_frames,
)
from contactsnes.continuation.predictors import PREDICTORS
from contactsnes.continuation.predictors.predictor import Predictor, through
from contactsnes.continuation.steppers import TracedSteps

CUBIC_FOLD = 2.0 / (3.0 * np.sqrt(3.0))
SECANT = PREDICTORS["secant"]


class Problem:
    """F(u, load) = 0 with its derivatives, stable where a motion du/dt = -F settles, and flags of
    contact and sliding."""

    in_contact = staticmethod(lambda u: True)
    sliding = staticmethod(lambda u: False)

    def __init__(self, residual, jacobian, load_derivative):
        self.residual = residual
        self.jacobian = jacobian
        self.load_derivative = load_derivative


def cubic(shift=0.0):
    """u^3 - u = load + shift: stable for |u| > 1/sqrt 3, with folds at load = -+ 2/(3 sqrt 3) -
    shift."""
    return Problem(lambda u, load: u ** 3 - u - load - shift, lambda u,
                   load: np.diag(3 * u ** 2 - 1), lambda u, load: -np.ones(1))


def follower():
    """The cubic with a second unknown that is twice the first: (u^3 - u - load, v - 2u)."""
    return Problem(lambda u, load: np.array([u[0] ** 3 - u[0] - load, u[1] - 2 * u[0]]), lambda u,
                   load: np.array([[3 * u[0] ** 2 - 1, 0.0], [-2.0, 1.0]]), lambda u,
                   load: np.array([-1.0, 0.0]))


def circle():
    """u^2 + load^2 = 1: nothing beyond load 1, where a motion never ends."""
    return Problem(lambda u, load: u ** 2 + load ** 2 - 1, lambda u, load: np.diag(2 * u), lambda u,
                   load: 2 * load * np.ones(1))


def explicit(value, slope):
    """u = value(load), a branch without a fold."""
    return Problem(lambda u, load: u - value(load), lambda u, load: np.eye(1), lambda u,
                   load: -slope(load) * np.ones(1))


def bend(slope, width, at=0.5):
    """u = load, from load ``at`` on steeper by ``slope``, over about ``width``."""
    return explicit(lambda load: load + slope * width * np.logaddexp(0.0, (load - at) / width),
                    lambda load: 1.0 + slope * expit((load - at) / width))


def curve(load, slope):
    """load = load(u) of one unknown, a branch with folds where the slope of the load vanishes."""
    return Problem(lambda u, value: load(u) - value, lambda u, value: np.diag(slope(u)), lambda u,
                   value: -np.ones(1))


def waves():
    """load = u + 2 sin u: a fold wherever cos u = -1/2."""
    return curve(lambda u: u + 2 * np.sin(u), lambda u: 1 + 2 * np.cos(u))


def corner(rising=1.0, falling=-3.0, at=0.3):
    """load = at + rising (u - at) for u below ``at``, then at + falling (u - at): a fold in a
    corner, without curvature."""
    return curve(lambda u: at + np.where(u < at, rising, falling) * (u - at),
                 lambda u: np.where(u < at, rising, falling))


def cusp(depth):
    """u^3 + 3 depth u = load: folds at -+ 2 (-depth)^(3/2) for a negative depth, none for others, a
    cusp at 0."""
    return curve(lambda u: u ** 3 + 3 * depth * u, lambda u: 3 * u ** 2 + 3 * depth)


def loop():
    """(u - 2)^2 + v^2 = 1 with v = load: an isola."""
    return Problem(lambda x, load: np.array([(x[0] - 2) ** 2 + x[1] ** 2 - 1, x[1] - load]),
                   lambda x, load: np.array([[2 * (x[0] - 2), 2 * x[1]], [0.0, 1.0]]), lambda x,
                   load: np.array([0.0, -1.0]))


def cube_root():
    """u^3 = load, with a vertical tangent at 0 that is no fold."""
    return Problem(lambda u, load: u ** 3 - load, lambda u, load: np.diag(3 * u ** 2), lambda u,
                   load: -np.ones(1))


def pitchfork():
    """(u - load, v (v^2 + 1/2 - load)): the branch v = 0 loses stability at 1/2 and goes on."""
    return Problem(lambda x, load: np.array([x[0] - load, x[1] * (x[1] ** 2 + 0.5 - load)]),
                   lambda x, load: np.diag([1.0, 3 * x[1] ** 2 + 0.5 - load]), lambda x,
                   load: np.array([-1.0, -x[1]]))


class System:
    """What continuation asks of a solver, by dense Newton iterations on a `Problem`; a state is an
    array of unknowns.

    ``fails`` says at which loads a solve fails whatever it starts from, and ``arc_fails`` one by
    arc length; ``iterations`` is how many it reports, ``most`` how many it may take. ``guesses``,
    ``attempts`` and ``used`` record starts and loads of solves, and the points extrapolated from.
    """

    examiner = None

    def __init__(self, problem, most=16, fails=lambda load: False, arc_fails=lambda load: False,
                 iterations=None):
        self.problem = problem
        self.most = most
        self.fails = fails
        self.arc_fails = arc_fails
        self.iterations = iterations
        self.guesses = []
        self.used = []
        self.attempts = []
        self.sentences = []
        self.log = self.sentences.append
        self.spent = 0

    def told(self, controls, load):
        return ", ".join(f"{name} {value:.6g}"
                         for name, value in zip(("normal_displacement", "tangential_displacement"),
                                                load))

    def adapted(self, point, controls, load):
        return replace(point, controls=controls, load=load)

    def lighter(self, points):
        return points

    def account(self):
        spent, self.spent = self.spent, 0
        return {"nonlinear_iterations": spent}

    def extrapolate(self, points, weights):
        self.used.append(points)
        return sum(weight * point.state for weight, point in zip(weights, points))

    follow_edge = extrapolate

    @staticmethod
    def fronts_moved(first, last):
        return False

    def distance(self, first, second):
        return float(np.sqrt(np.mean((first - second) ** 2)))

    def missed(self, first, second, **_):
        return self.distance(first, second)

    def ways(self, guess, last, state):
        return self.missed(guess, state), self.missed(last, state)

    leeway = 0.35

    def strayed(self, guess, last, state):
        return float(np.max(np.abs(guess - state) - 0.35 - 0.15 * np.minimum(np.abs(state - last),
                                                                             10.0)))

    def doubtful(self, *_):
        return False

    adrift = detached = leapt = doubtful

    def progress(self, origin, ahead, state):
        return (state - origin) @ (ahead - origin) / ((ahead - origin) @ (ahead - origin))

    def within_range(self, point, *_):
        return None

    end_of_attraction = neutral = within_range

    def pulled_away(self, *_):
        return ""

    def along_tangent(self, point, leg, position, step):
        load = leg.load(position)[leg.moving]
        slope = -np.linalg.solve(self.problem.jacobian(point.state, load),
                                 self.problem.load_derivative(point.state, load))
        return point.state + step * leg.direction[leg.moving] * slope

    def solve(self, guess, controls, load):
        self.guesses.append(np.array(guess))
        self.attempts.append(load[-1])
        if self.fails(load[-1]):
            raise NotConverged("no solution is looked for here")
        problem = self.problem
        state, count = self._newton(lambda u: problem.residual(u, load[-1]),
                                    lambda u: problem.jacobian(u, load[-1]), guess)
        return self._point(state, load, count)

    def end_of_branch(self, point, leg, heading):
        return "it went far away" if np.abs(point.state).max() > 50.0 else ""

    def margin(self, point, event):
        happened = point.sliding if event == "gross_sliding" else not point.in_contact
        return 1.0 if happened else -1.0

    def chord_length(self, first, last):
        return self.distance(first, last)

    def _row(self, chord):
        change = chord[1] - chord[0]
        return change / max(len(change) * self.distance(*chord), 1e-300)

    def _bordered(self, x, row, leg, slope=0.0):
        rate, load = leg.direction[leg.moving], leg.load(x[-1])[leg.moving]
        return np.block([[self.problem.jacobian(x[:-1], load),
                          rate * self.problem.load_derivative(x[:-1], load)[:, None]],
                         [row[None], np.full((1, 1), slope)]])

    def solve_arc(self, chord, length, guess, position, leg, border=(1.0, 0.0), tight=False):
        (share, rate), row = border, border[0] * self._row(chord)
        unknown, count = self._newton(lambda x: np.append(self.problem.residual(x[:-1],
                                                                                leg.load(
            x[-1])[leg.moving]), row @ (x[:-1] - chord[0]) + rate * (x[-1] - position)
                                                          - share * length),
                                      lambda x: self._bordered(x, row, leg, rate),
                                      np.append(guess, position))
        load = leg.load(unknown[-1])
        if self.arc_fails(load[-1]):
            raise NotConverged("no solution is looked for here")
        return replace(self._point(unknown[:-1], load, count), leg=leg.number, position=unknown[-1])

    def direction(self, point, chord, leg):
        change = np.linalg.solve(self._bordered(np.append(point.state, point.position),
                                                self._row(chord), leg),
                                 np.append(np.zeros(len(point.state)), 1.0))
        return Direction(change[:-1], change[-1])

    def stride(self, point, direction):
        return 0.0

    def unit(self, point, direction):
        length = self.distance(direction.state, np.zeros(1))
        return Direction(direction.state / length, direction.rate / length)

    def kicked(self, fold, beyond, part):
        return fold.state + 0.1 * part * (beyond - fold.state) / self.missed(fold.state, beyond)

    def settle(self, state, controls, load, where, origin=None):
        state = np.array(state)
        for _ in range(3000):
            force = self.problem.residual(state, load[-1])
            if np.abs(force).max() < 1e-6:
                return self.solve(state, controls, load)
            if np.abs(state).max() > 1e3:
                raise NoEquilibrium(f"no equilibrium {where}")
            state = state - 0.1 * force / (0.1
                                           + np.abs(self.problem.jacobian(state, load[-1])).max())
        raise NotConverged("the motion did not settle")

    def crossed(self, last, beyond, where):
        ahead = self.settle(last.state, last.controls, beyond, where)
        behind = self.solve(ahead.state, last.controls, last.load)
        same = self.missed(last.state, behind.state) < 1e-3
        return Crossing(0.0, 1.0, last, None if same else behind, ahead.state)

    def _newton(self, residual, jacobian, guess):
        state = np.array(guess, dtype=float)
        for count in range(self.most + 1):
            function = residual(state)
            self.spent += 1
            if np.linalg.norm(function) < 1e-11:
                return state, count
            if not np.all(np.isfinite(function)) or np.linalg.norm(function) > 1e9:
                break
            try:
                state = state - np.linalg.solve(jacobian(state), function)
            except np.linalg.LinAlgError:
                break
        raise NotConverged("Newton's iteration failed")

    def _point(self, state, load, count):
        problem, load = self.problem, np.array(load)
        return Point(state, ("displacement",) * len(load), load, load, load,
                     problem.in_contact(state), problem.sliding(state), 0.0,
                     spent={"last_iterations": count if self.iterations is None
                            else self.iterations})


def path(system, values, guess, *, sizes=(1 / 40, 1 / 20, 1e-6), resumed=None, **settings):
    """The branch of a system from values[0] along legs to the others; ``resumed``: the last points
    of an interrupted one."""
    def maker(number, start, end):
        return lambda points: None if start == end else Leg(number, ("displacement",),
                                                            np.array([start]), np.array([end]), 0,
                                                            *sizes)

    def start():
        return replace(system.solve(np.array(guess, dtype=float), ("displacement",),
                                    np.array([values[0]])), spent=system.account())

    if "predictor" in settings:
        settings["predictor"] = PREDICTORS[settings["predictor"]]
    legs = [maker(number, *ends) for number, ends in enumerate(zip(values, values[1:]), start=1)]
    return branch(system, start, legs, history=resumed or (), **settings)


def followed(iterator):
    """Points of a branch, and what ended it (None: its own end)."""
    points = []
    try:
        for point in iterator:
            points.append(point)
            assert len(points) < 2000, "the steps do not come to an end"
    except (NotConverged, NoEquilibrium) as error:
        return points, error
    return points, None


def events(points):
    return [point.event for point in points if point.event]


def assert_solutions(system, points):
    for point in points:
        assert np.abs(system.problem.residual(point.state, point.load[-1])).max() < 1e-10


def assert_steps(points, largest=1 / 20, legs=1):
    """Every leg is followed in order from its beginning to its exact end, in steps no longer than
    the largest."""
    for number in range(1, legs + 1):
        places = [0.0, *(point.position for point in points if point.leg == number)]
        assert places[-1] == 1.0
        assert np.all(np.diff(places) >= 0.0) and np.max(np.diff(places)) <= largest * (1 + 1e-9)


# Legs and steps


def test_weights_reproduce_polynomials():
    rng = np.random.default_rng(3)
    for count in (1, 2, 3, 4):
        nodes = np.cumsum(rng.uniform(0.1, 1.0, count))
        polynomial = np.polynomial.Polynomial(rng.normal(size=count))
        for target in (nodes[-1] + 0.7, nodes[0], nodes.mean()):
            np.testing.assert_allclose(lagrange_weights(nodes, target) @ polynomial(nodes),
                                       polynomial(target), rtol=1e-12)


def test_nodes_that_are_one_have_no_weights():
    same = 0.3
    assert np.isnan(lagrange_weights([same, same, 1.0], 2.0)[:2]).all()


@pytest.mark.parametrize("predictor", PREDICTORS)
def test_legs_end_exactly_and_every_point_is_a_solution(predictor):
    system, values = System(explicit(np.sin, np.cos)), [0.1, 1.7, -0.3, 1 / 3]
    points, error = followed(path(system, values, [0.0], predictor=predictor))
    assert error is None and events(points) == []
    assert points[0].leg == 0 and points[0].load[0] == 0.1
    assert [point.load[0] for point in points if point.position == 1.0] == values[1:]
    assert_solutions(system, points)
    assert_steps(points, legs=3)


def test_a_leg_to_where_it_is_adds_no_point():
    points, error = followed(path(System(explicit(np.sin, np.cos)), [0.5, 0.5, 1.0, 1.0], [0.0]))
    assert error is None
    assert sum(point.load[0] == 0.5 for point in points) == 1 and sum(point.load[0] == 1.0
                                                                      for point in points) == 1


def test_predictors_have_their_orders():
    """Halving the step divides the error by 2 (none), 4 (secant, tangent) or 8 (edge: a
    parabola)."""
    system = System(explicit(np.exp, np.exp))
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    for predictor, order in zip(PREDICTORS.values(), (1, 2, 2, 3)):
        wrong = []
        for step in (0.02, 0.01):
            history = [(place, system.solve(np.ones(1), ("displacement",), leg.load(place)))
                       for place in 0.5 + step * np.arange(-2.0, 1.0)]
            wrong.append(abs(predict(system, history, leg, 0.5 + step, predictor)[0]
                             - np.exp(0.5 + step)))
        assert np.log2(wrong[0] / wrong[1]) == pytest.approx(order, abs=0.1)


def test_step_rule():
    """Twice the step after a solve for nothing, the same at the target, never half or less, never
    above the largest."""
    assert grown(0.1, 0, 1.0) == pytest.approx(0.2)
    assert grown(0.1, 8, 1.0) == pytest.approx(0.1)
    assert grown(0.1, 0, 0.15) == 0.15
    assert 0.05 <= grown(0.1, 1000, 1.0) < 0.1
    sizes = [grown(0.1, count, 1.0) for count in range(20)]
    assert np.all(np.diff(sizes) <= 0.0)


def test_steps_grow_with_few_iterations_and_not_with_many():
    for iterations, least, most in ((0, 1.9, 2.1), (4, 1.2, 1.3), (12, 0.6, 1.0)):
        system = System(explicit(np.sin, np.cos), iterations=iterations)
        points, _ = followed(path(system, [0.0, 1.0], [0.0], sizes=(0.02, 0.5, 1e-3)))
        first, second, third = (point.position for point in points[:3])
        assert first == 0.0 and second == pytest.approx(0.02)
        assert least < (third - second) / second <= most * (1 + 1e-9)


@pytest.mark.parametrize("iterations", [10, 16])
def test_slow_solvers_finish_their_legs(iterations):
    """A solver that needs many iterations at any step must not shrink its steps without end."""
    points, error = followed(path(System(explicit(np.sin, np.cos), iterations=iterations),
                                  [0.0, 1.0], [0.0]))
    assert error is None and points[-1].position == 1.0


def test_legs_have_their_own_steps():
    system = System(explicit(np.sin, np.cos))
    legs = [lambda points: Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6),
            lambda points: Leg(2, ("displacement",), np.ones(1), np.zeros(1), 0, 0.01, 0.02, 1e-6)]
    points, _ = followed(branch(system, lambda: replace(system.solve(np.zeros(1), ("displacement",),
                                                                     np.zeros(1)), spent={}), legs))
    first, second = ([point.position for point in points if point.leg == number]
                     for number in (1, 2))
    assert first[0] == 0.1 and len(first) == 10
    assert second[0] == 0.01 and np.max(np.diff(second)) <= 0.02 * (1 + 1e-9)


@pytest.mark.parametrize("predictor", PREDICTORS)
def test_large_moves_along_a_straight_branch_are_no_trouble(predictor):
    """A state that moves far in a step is no other branch: nothing is to be refused here."""
    system = System(explicit(lambda load: 30.0 * load, lambda load: 30.0))
    points, error = followed(path(system, [0.0, 1.0], [0.0], predictor=predictor))
    assert error is None and system.sentences == [] and len(points) <= 24


def test_a_polynomial_through_one_point_is_no_prediction(monkeypatch):
    """What moves far in a first step is refused off a prediction alone: a predictor of one's own
    has none before its second point."""
    class Cubic(Predictor):
        order = 4

        def state(self, system, points, places, place, tangent=None):
            return through(system, points[-4:], places[-4:], place)

    monkeypatch.setitem(PREDICTORS, "cubic", Cubic())
    system = System(explicit(lambda load: 30.0 * load, lambda load: 30.0))
    points, error = followed(path(system, [0.0, 1.0], [0.0], predictor="cubic"))
    assert error is None and system.sentences == [] and len(points) <= 24


# Failures


def test_a_failed_step_returns_to_the_last_point():
    """After a failure the next solve starts from the last good point, nearer to it, and nothing
    else was kept."""
    failing = {4: True}
    system = System(explicit(np.sin, np.cos), fails=lambda load: failing.pop(len(system.attempts),
                                                                             False))
    points, error = followed(path(system, [0.0, 1.0], [0.0], predictor="none"))
    assert error is None and len(system.sentences) == 1
    assert_solutions(system, points)
    good = points[2]
    np.testing.assert_array_equal(system.guesses[3], good.state)
    np.testing.assert_array_equal(system.guesses[4], good.state)
    taken = [system.attempts[i] - good.load[0] for i in (3, 4)]
    assert 0.0 < taken[1] < taken[0]
    assert points[3].load[0] == system.attempts[4]


@pytest.mark.parametrize("predictor", PREDICTORS)
def test_failures_without_a_reason_are_passed(predictor):
    """Loads at which the solver fails though nothing is wrong: arc length passes them, in steps no
    longer than allowed."""
    system = System(explicit(np.sin, np.cos), fails=lambda load: 0.3 < load < 0.32)
    points, error = followed(path(system, [0.0, 1.0], [0.0], predictor=predictor))
    assert error is None and events(points) == []
    assert_solutions(system, points)
    assert_steps(points)


def test_where_no_solve_succeeds_the_points_before_are_handed_out():
    system = System(explicit(np.sin, np.cos), fails=lambda load: load > 0.42,
                    arc_fails=lambda load: load > 0.42)
    points, error = followed(path(system, [0.0, 1.0], [0.0]))
    assert isinstance(error, NotConverged) and "no solution is looked for here" in str(error)
    assert 0.35 < points[-1].load[0] <= 0.42 and len(system.attempts) < 200
    assert_solutions(system, points)


def test_a_first_point_that_fails_ends_the_path():
    points, error = followed(path(System(circle(), fails=lambda load: True), [0.0, 1.0], [1.0]))
    assert points == [] and isinstance(error, NotConverged)


def test_no_step_is_below_the_smallest():
    system = System(explicit(np.sin, np.cos), fails=lambda load: load > 0.42,
                    arc_fails=lambda load: True)
    points, error = followed(path(system, [0.0, 1.0], [0.0], sizes=(0.05, 0.05, 0.03)))
    assert isinstance(error, NotConverged)
    steps = np.abs(np.diff(system.attempts))
    # The motion that tells whether an equilibrium exists is at the load that failed last.
    assert np.min(steps[steps > 0.0]) >= 0.03 * (1 - 1e-9)


# Folds


@pytest.mark.parametrize("predictor", PREDICTORS)
@pytest.mark.parametrize("problem, guess", [(cubic, [-1.5]), (follower, [-1.5, -3.0])])
def test_folds_are_located_and_left_by_a_jump(problem, guess, predictor):
    system = System(problem())
    points, error = followed(path(system, [-1.875, 2.0, -1.5], guess, predictor=predictor))
    assert error is None and events(points) == ["fold", "jump", "fold", "jump"]
    assert_solutions(system, points)
    assert_steps(points, legs=2)
    for number, (load, before, after, kind) in enumerate([(CUBIC_FOLD, -1, 2, "jump_in"),
                                                          (-CUBIC_FOLD, 1, -2, "pull_off")], 1):
        fold, jump = (next(point for point in points if point.leg == number and point.event == name)
                      for name in ("fold", "jump"))
        assert fold.load[0] == pytest.approx(load, rel=2 * FOLD_TOLERANCE)
        assert (fold.fold_kind, jump.fold_kind) == (kind, "")
        assert jump.load[0] == fold.load[0] and jump.position == fold.position
        # A load short of the fold by 1e-6 moves the state by the root of that.
        assert fold.state[0] == pytest.approx(before / np.sqrt(3), abs=2e-3)
        assert jump.state[0] == pytest.approx(after / np.sqrt(3), abs=2e-3)


@pytest.mark.parametrize("sizes", [(0.003, 0.006, 1e-7), (0.025, 0.05, 1e-6), (0.11, 0.13, 1e-5),
                                   (0.5, 0.5, 1e-6)])
@pytest.mark.parametrize("most", [3, 5, 16])
def test_folds_do_not_depend_on_steps_or_solver(sizes, most):
    system = System(cubic(), most=most)
    points, error = followed(path(system, [-1.875, 2.0], [-1.5], sizes=sizes))
    assert error is None and events(points) == ["fold", "jump"]
    fold = next(point for point in points if point.event == "fold")
    assert fold.load[0] == pytest.approx(CUBIC_FOLD, rel=2 * FOLD_TOLERANCE)


def test_a_fold_at_load_zero():
    points, error = followed(path(System(cubic(shift=CUBIC_FOLD)), [-2.0, 1.0], [-1.5]))
    assert error is None and events(points) == ["fold", "jump"]
    assert (next(point.load[0] for point in points if point.event == "fold")
            == pytest.approx(0.0, abs=1e-7))


@pytest.mark.parametrize("size", [0.2, 1.0, 20.0])
def test_jumps_may_be_short_or_long(size):
    """The cubic in u / size: the jump is of 1.73 size."""
    problem = Problem(lambda u, load: (u / size) ** 3 - u / size - load, lambda u,
                      load: np.diag(3 * (u / size) ** 2 - 1) / size, lambda u, load: -np.ones(1))
    points, error = followed(path(System(problem), [-1.875, 2.0], [-1.5 * size]))
    assert error is None and events(points) == ["fold", "jump"]
    assert next(point.state[0] for point in points if point.event == "jump") == pytest.approx(
        2 * size / np.sqrt(3), rel=2e-3)


def test_stop_ends_at_the_fold():
    points, error = followed(path(System(cubic()), [-1.875, 2.0, -1.0], [-1.5], at_fold="stop"))
    assert (error is None and points[-1].event == "fold" and points[-1].leg == 1
            and events(points) == ["fold"])
    assert points[-1].load[0] == pytest.approx(CUBIC_FOLD, rel=2 * FOLD_TOLERANCE)


def test_where_nothing_lies_beyond_the_fold_the_path_ends():
    points, error = followed(path(System(circle()), [0.0, 2.0], [1.0]))
    assert isinstance(error, NoEquilibrium) and "beyond the fold" in str(error)
    assert points[-1].event == "fold" and points[-1].load[0] == pytest.approx(1.0,
                                                                              rel=2
                                                                              * FOLD_TOLERANCE)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_path_that_is_to_stop_at_pull_off_does_not_end_well_at_another_fold(way):
    """What moves is a displacement: no force pulls the body off, and that nothing lies beyond is
    told."""
    points, error = followed(path(System(circle()), [0.5 * way, 2.0 * way], [0.8],
                                  stops=("pull_off",)))
    assert isinstance(error, NoEquilibrium) and points[-1].event == "fold"


def test_an_unstable_branch_is_left_backwards():
    """From the middle of the cubic to its fold: beyond it, motion leads back to it, and before it
    on to the far branch."""
    points, error = followed(path(System(cubic()), [0.0, 2.0], [0.0]))
    assert error is None and events(points) == ["fold", "jump"]
    before, after = (next(point for point in points if point.event == name)
                     for name in ("fold", "jump"))
    assert (before.load[0] == pytest.approx(CUBIC_FOLD, rel=2 * FOLD_TOLERANCE)
            and before.state[0] == pytest.approx(-1 / np.sqrt(3), abs=2e-3))
    assert after.state[0] == pytest.approx(2 / np.sqrt(3), abs=2e-3)


class Unsteady(System):
    """Motions under the load of a fold that leave, so many of them; under other loads they
    settle."""

    leaving, end = 1, 2.0

    def settle(self, state, controls, load, where, origin=None):
        if load[-1] != self.end and self.leaving > 0:
            self.leaving -= 1
            raise NoEquilibrium(f"no equilibrium {where}")
        return super().settle(state, controls, load, where, origin)


def test_a_motion_that_leaves_says_nothing_of_others():
    system = Unsteady(cubic())
    points, error = followed(path(system, [-1.875, 2.0], [-1.5]))
    assert error is None and events(points) == ["fold", "jump"] and system.leaving == 0
    assert points[-1].position == 1.0


def test_a_jump_that_is_not_found_is_no_missing_equilibrium():
    """At the leg's end there is one: the path ends, and what is said is what failed, and where."""
    system = Unsteady(cubic())
    system.leaving = 100
    points, error = followed(path(system, [-1.875, 2.0], [-1.5]))
    assert isinstance(error, NotConverged) and "no other equilibrium was reached at" in str(error)
    assert system.told((), np.array([CUBIC_FOLD]))[:6] in str(error) and events(points) == ["fold"]


@pytest.mark.parametrize("end, expected", [(2.0, NoEquilibrium), (0.95, NotConverged)])
def test_where_solves_fail_the_end_of_the_leg_says_whether_there_is_anything(end, expected):
    """tanh u = load has a solution for loads below 1, but solves fail beyond 0.9; just there a
    motion would settle."""
    problem = Problem(lambda u, load: np.tanh(u) - load, lambda u,
                      load: np.diag(np.cosh(np.minimum(u, 300.0)) ** -2.0), lambda u,
                      load: -np.ones(1))
    system = System(problem, fails=lambda load: 0.9 < load, arc_fails=lambda load: 0.9 < load)
    points, error = followed(path(system, [0.0, end], [0.0]))
    assert isinstance(error, expected) and 0.85 < points[-1].load[0] <= 0.9


@pytest.mark.parametrize("short", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("most", [3, 5, 16])
def test_a_fold_beyond_the_end_of_a_leg_is_none_of_its(short, most):
    """A leg that ends just before a fold ends exactly there, however hard the last step is."""
    end = CUBIC_FOLD * (1.0 - short)
    points, error = followed(path(System(cubic(), most=most), [-1.875, end], [-1.5]))
    assert error is None and events(points) == []
    assert points[-1].position == 1.0 and points[-1].load[0] == end


@pytest.mark.parametrize("slope", [5.0, 20.0, 100.0, 1000.0])
@pytest.mark.parametrize("width", [1e-4, 1e-3, 1e-2])
def test_bends_are_no_folds(slope, width):
    system = System(bend(slope, width))
    points, error = followed(path(system, [0.0, 1.0], [0.0]))
    assert error is None and events(points) == []
    assert_solutions(system, points)
    assert_steps(points)


def test_a_vertical_tangent_is_no_fold():
    system = System(cube_root())
    points, error = followed(path(system, [-1.0, 1.1], [-1.0]))
    assert error is None and events(points) == []
    assert_solutions(system, points)
    assert_steps(points)


def test_the_primary_branch_of_a_pitchfork_is_followed():
    system = System(pitchfork())
    points, error = followed(path(system, [0.0, 1.1], [0.0, 0.0]))
    assert error is None and events(points) == [] and all(point.state[1] == 0.0 for point in points)
    assert_steps(points)


def test_another_branch_is_not_taken_for_the_next_point():
    """A solve that lands on the far branch is refused: the path has a fold, however well the solver
    converges."""
    system = System(cubic(), most=200)
    points, _ = followed(path(system, [-1.875, 2.0], [-1.5], sizes=(0.1, 0.1, 1e-6)))
    assert events(points) == ["fold", "jump"]
    before = [point.state[0] for point in points[:[point.event for point in points].index("jump")]]
    assert max(before) <= -1 / np.sqrt(3) + 2e-3


class Landing(System):
    """A system whose solves all end in one state, so that what is asked of a step decides alone."""

    def __init__(self, end, problem=None, softest=np.nan, jumped=False):
        super().__init__(problem or explicit(lambda load: load, lambda load: 1.0))
        self.end = np.array(end)
        self.softest = softest
        self.jumped = jumped

    def solve(self, guess, controls, load):
        return replace(self._point(self.end, load, 3), softest=self.softest)

    def solve_arc(self, chord, length, guess, position, leg, border=(1.0, 0.0), tight=False):
        return replace(self.solve(guess, leg.controls, leg.load(position)), position=position)

    def settle(self, state, controls, load, where, origin=None):
        return self.solve(state, controls, load)

    def doubtful(self, *_):
        return self.jumped

    detached = doubtful

    def points(self, *states):
        """[(position, point), ...] of states a tenth of a leg apart."""
        found = enumerate(map(np.array, states))
        return [(0.1 * k, replace(self._point(state, np.array([0.1 * k]), 3), position=0.1 * k,
                                  softest=0.5)) for k, state in found]


UNIT_LEG = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
NODES = np.ones(100)
ONE_ASIDE = 0.4 * NODES + np.where(np.arange(100) == 3, 0.6, 0.0)
LATE = explicit(lambda load: 4 * load, lambda load: 4.0 if load < 0.05 else 0.0)


@pytest.mark.parametrize("states, predictor, end, refused",
                         [([[0.0], [0.05]], "none", [0.2], ""),
                          ([[0.0], [0.05]], "none", [0.45], "0.4 ranges from its prediction"),
                          ([[0.0], [0.2]], "secant", [0.5], ""),
                          ([[0.0], [0.2]], "secant", [0.7], "0.3 ranges from its prediction"),
                          ([0.0 * NODES, 0.2 * NODES], "secant", 0.4 * NODES, ""),
                          ([0.0 * NODES, 0.2 * NODES], "secant", ONE_ASIDE,
                           "nodes of the solve ended where no prediction has them")])
def test_a_step_that_ends_off_its_prediction_is_refused(states, predictor, end, refused):
    """Of natural steps: four times as far as the last one, off by half of the way, or with one node
    that jumped."""
    system = Landing(end)
    history = system.points(*states)
    steps = NaturalSteps(system, UNIT_LEG, history, PREDICTORS[predictor], "jump")
    if refused:
        with pytest.raises(NotConverged, match=f"{refused}.*another branch"):
            steps._step(0.2, PREDICTORS[predictor])
    else:
        assert steps._step(0.2, PREDICTORS[predictor]).position == 0.2


class Doubting(Landing):
    """A system that doubts all until so many tangents are ``trusted``."""

    tangents = 0

    def along_tangent(self, point, *rest):
        self.tangents += 1
        return super().along_tangent(point, *rest)

    def doubtful(self, guess, *_):
        return self.tangents != self.trusted

    detached = doubtful


@pytest.mark.parametrize("trusted, refused", [(0, False), (1, False), (2, False), (3, True)])
def test_a_step_that_one_prediction_foretells_without_doubt_is_kept(trusted, refused):
    """Tangents are asked only if all other predictions are doubted: first that at the end, which
    leads back, then that at the beginning, before the step is refused."""
    system = Doubting([0.4])
    system.trusted = trusted
    steps = NaturalSteps(system, UNIT_LEG, system.points([0.0], [0.2]), PREDICTORS["secant"],
                         "jump")
    if refused:
        with pytest.raises(NotConverged, match="released energy on their way, perhaps on another"):
            steps._step(0.2, PREDICTORS["secant"])
    else:
        assert steps._step(0.2, PREDICTORS["secant"]).position == 0.2
    assert system.tangents == (2 if refused else trusted)


@pytest.mark.parametrize("doubt, end, doubted, slope, refused", [
    ("adrift", 0.4, False, 1.0, False), ("adrift", 0.4, True, 2.0, False),
    ("adrift", 0.4, True, 1.0, True), ("leapt", 0.41, False, 1.0, False),
    ("leapt", 0.41, True, 2.0, False), ("leapt", 0.41, True, 0.4, True)])
def test_the_branch_leads_back_from_where_a_step_is_in_doubt(doubt, end, doubted, slope, refused):
    """It ended off all predictions, behind a short jump of which no energy tells, where it leads
    back by what the load moves it only; or nodes leapt to where all predictions have them."""
    system = Landing([end], explicit(lambda load: slope * load, lambda load: slope))
    setattr(system, doubt, lambda *_: doubted)
    steps = NaturalSteps(system, UNIT_LEG, system.points([0.0], [0.2]), SECANT, "jump")
    with (pytest.raises(NotConverged, match="hardly leads back, perhaps on another branch")
          if refused else nullcontext()):
        assert steps._step(0.2, SECANT).position == 0.2


def test_what_three_points_foretell_is_not_asked_whether_it_leapt():
    """Smooth paths take no tangent for it."""
    system = Landing([0.6], explicit(lambda load: load, lambda load: 1.0))
    system.leapt = lambda *_: pytest.fail("asked")
    history = system.points([0.0], [0.2], [0.4])
    steps = NaturalSteps(system, UNIT_LEG, history, SECANT, "jump")
    assert steps._step(history[-1][0] + 0.1, SECANT).state[0] == 0.6


def test_one_tangent_is_held_at_a_time():
    """That at the end of a doubted step is over when the one at its beginning is asked for, whose
    memory it takes."""
    system = Doubting([0.4])
    system.trusted, alive, asked = -1, [], system.along_tangent

    def along_tangent(*given):
        alive.append([state() for state in made])
        state = asked(*given)
        made.append(weakref.ref(state))
        return state

    made, system.along_tangent = [], along_tangent
    steps = NaturalSteps(system, UNIT_LEG, system.points([0.0], [0.2]), PREDICTORS["secant"],
                         "jump")
    with pytest.raises(NotConverged, match="released energy"):
        steps._step(0.2, PREDICTORS["secant"])
    assert alive == [[], [None]]


def test_what_a_step_released_is_asked_where_its_end_was_foretold():
    for jumped in (False, True):
        system = Landing([0.4], jumped=jumped)
        steps = NaturalSteps(system, UNIT_LEG, system.points([0.0], [0.2]), SECANT, "jump")
        assert (followed(steps._step(0.2, SECANT) for _ in range(1))[1] is not None) is jumped


@pytest.mark.parametrize("problem, refused", [(None, False), (LATE, True)])
def test_the_tangent_at_a_far_first_point_leads_back(problem, refused):
    system = Landing([4.0], problem or explicit(lambda load: 4 * load, lambda load: 4.0))
    steps = NaturalSteps(system, replace(UNIT_LEG, end=np.array([10.0])), system.points([0.0]),
                         PREDICTORS["tangent"], "jump")
    found = followed(steps._step(0.1, PREDICTORS["tangent"]) for _ in range(1))[1]
    assert (found is not None) is refused


@pytest.mark.parametrize("states, guess, end, position, sentence",
                         [([[0.0], [0.2]], [0.4], [0.45], 0.2, ""),
                          ([[0.0], [0.2]], [0.4], [0.7], 0.2, "another branch"),
                          ([0.0 * NODES, 0.2 * NODES], 0.4 * NODES, ONE_ASIDE, 0.2,
                           "another branch"), ([[0.0], [0.2]], [0.05], [0.05], 0.2,
                                               "back along the branch"),
                          ([[0.0], [0.2]], [0.4], [0.4], 0.35, "more than twice")])
def test_a_step_along_the_arc_stays_on_the_branch_and_goes_on(states, guess, end, position,
                                                              sentence):
    system = Landing(end)
    steps = ArcLengthSteps(system, UNIT_LEG, system.points(*states), SECANT, "jump")
    point = replace(system.solve(None, ("displacement",), np.array([position])), position=position)
    found = followed(steps._check(np.array(guess), point) for _ in range(1))[1]
    assert sentence in str(found) if sentence else found is None


@pytest.mark.parametrize("states, end, softest, sentence", [([[0.0], [0.2]], [0.45], 0.1, ""),
                                                            ([[0.0], [0.2]], [0.65], 0.1,
                                                             "another branch"),
                                                            ([0.0 * NODES, 0.2 * NODES], ONE_ASIDE,
                                                             0.1, "another branch"),
                                                            ([[0.0], [0.2]], [0.4], -0.1,
                                                             "lost its stability")])
def test_a_search_for_a_fold_stays_on_its_branch(states, end, softest, sentence):
    system = Landing(end, softest=softest)
    trail = system.points(*states)
    found = followed(FoldSearch(system, UNIT_LEG, trail)._ahead(trail, 0.2) for _ in range(1))[1]
    assert sentence in str(found) if sentence else found is None


FOLDED = lambda u: u ** 3 - u, lambda u: 3 * u ** 2 - 1
STEEP = lambda u: u ** 3 + 0.01 * u, lambda u: 3 * u ** 2 + 0.01
WAVY = lambda u: u + 2 * np.sin(u), lambda u: 1 + 2 * np.cos(u)


def places_on(loads, *unknowns):
    """A system with a load(u) and its slope, a leg of its loads from -10 to 10, and (position,
    point) at some u."""
    system = System(curve(*loads))
    leg = Leg(1, ("displacement",), np.array([-10.0]), np.array([10.0]), 0, 0.025, 0.05, 1e-6)
    places = [0.05 * (loads[0](u) + 10.0) for u in unknowns]
    return system, leg, [(place, replace(system._point(np.array([u]), leg.load(place), 3),
                                         position=place)) for u, place in zip(unknowns, places)]


@pytest.mark.parametrize("loads, unknowns, failures, length", [
    (FOLDED, (-0.9, -0.7, 1.2, 1.25), 0, 1.9),  # over the fold at -0.577
    (FOLDED, (-0.9, -0.7, -0.6, -0.59), 2, 0.0),
    (WAVY, (1.5, 1.9, 6.4, 8.0), 1, 4.5),  # over that at 2.09, and on nearly as fast
    (WAVY, (1.5, 1.9, 6.4, 8.0), 0, 0.0),
    (STEEP, (-0.6, -0.5, 1.0, 1.01), 2, 0.0),  # no fold
    (FOLDED, (-0.7, 1.2, 1.25), 0, 0.0)])  # two points have to stay
def test_a_step_across_a_jump_is_seen_by_what_follows_it(loads, unknowns, failures, length):
    """By how slow that is or, after failures, by whether the branch leads back."""
    system, leg, trail = places_on(loads, *unknowns)
    assert leapt(system, leg, trail, failures) == pytest.approx(length)


def test_a_search_for_a_fold_goes_back_before_the_jump_that_it_led_across():
    system, leg, (*before, beyond, further) = places_on(FOLDED, -0.61, -0.6, 1.2, 1.25)

    class Across(FoldSearch):
        led = [beyond[1], further[1]]

        def _ahead(self, trail, length, failures=0):
            return self.led.pop(0) if self.led else super()._ahead(trail, min(length, 0.05))

    fold, _, passed = Across(system, leg, before).search(NotConverged("a step"))
    assert passed is None and fold.state[0] == pytest.approx(-3 ** -0.5, abs=1e-6)


@pytest.mark.parametrize("failures, way", [(0, 0.1), (1, 0.1), (2, 0.05)])
def test_a_search_leaves_edges_in_place_where_following_them_failed_twice(failures, way):
    """They run away from a spot that is just born, here twice as far, however short a step is."""
    system, leg, trail = places_on(STEEP, 0.4, 0.5)
    system.follow_edge = lambda points, weights: points[-1].state + 0.1
    point = FoldSearch(system, leg, trail)._ahead(trail, 0.05, failures)
    assert point.state[0] == pytest.approx(0.5 + way, abs=0.01)


@pytest.mark.parametrize("here, length", [(0.0, 0.2), (0.01, 0.2), (0.8, 0.1)])
def test_a_search_for_a_fold_begins_with_the_last_step_but_short_of_the_refused_one(here, length):
    """Also where the last two points are under the same load, as slip that jumps leaves them."""
    system = Landing([0.0])
    (_, first), (_, last) = system.points([0.0], [0.2])
    found = FoldSearch(system, UNIT_LEG, [])._short_of(0.4, [(0.0, first), (here, last)])
    assert found == pytest.approx(length * system.chord_length(first.state, last.state) / 0.2)


@pytest.mark.parametrize("end, softest, tight, sentence",
                         [(-0.6, 0.1, False, ""), (-0.45, 0.1, False, "strayed"),
                          (-0.6, -0.1, False, "another mode"), (-0.6, -0.1, True, "")])
def test_a_fold_is_located_on_its_branch(end, softest, tight, sentence):
    system = Landing([end], cubic(), softest)
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    before, beyond = (replace(system._point(np.array([u]), leg.load(0.5 * (u ** 3 - u + 1.0)), 3),
                              position=0.5 * (u ** 3 - u + 1.0), softest=0.5) for u in (-0.7, -0.5))
    limit = LimitPoint(system, leg, before, beyond)
    found = followed(limit._point_at(0.5 * limit.right.place, tight) for _ in range(1))[1]
    assert sentence in str(found) if sentence else found is None


@pytest.mark.parametrize("end, first", [(2.0, True), (9.0, False)])
def test_a_fold_that_the_load_has_passed_before_its_bracket_is_not_its_limit(end, first):
    """load = 2 sin u - u/10 has its first limit from u = 1.3 on where cos u = 1/20, and the next
    one a period later, below the load at u = 1.3."""
    def load(u):
        return 2 * np.sin(u) - 0.1 * u

    system = System(curve(load, lambda u: 2 * np.cos(u) - 0.1))
    leg = Leg(1, ("displacement",), np.array([-4.0]), np.array([4.0]), 0, 0.025, 0.05, 1e-6)
    places = [(load(u) + 4.0) / 8.0 for u in (1.3, end)]
    peak = LimitPoint(system, leg, *(system._point(np.array([u]), leg.load(place), 3).changed(
        position=place) for u, place in zip((1.3, end), places)))
    assert peak.bracketed
    with nullcontext() if first else pytest.raises(NotConverged, match="more than once"):
        assert peak.locate().state[0] == pytest.approx(np.arccos(0.05), abs=1e-6)


def test_where_the_load_stands_still_none_turns():
    """As of a body out of the law's range: its last two points have no slope at all."""
    system = System(curve(np.zeros_like, np.zeros_like))
    ends = [system._point(np.array([u]), UNIT_LEG.load(0.0), 3).changed(position=0.0)
            for u in (0.0, 1e-6)]
    assert not LimitPoint(system, UNIT_LEG, *ends).bracketed


@pytest.mark.parametrize("end, back", [(0.001, True), (0.01, False), (-0.2, False), (-0.01, True)])
def test_a_jump_leads_away_from_its_fold(end, back):
    """A motion that began a tenth beside a fold has left it a twentieth ahead of it, or half of
    that distance on any side."""
    system = Landing([end])
    fold = replace(system.points([0.0])[0][1], event="fold", fold_kind="jump_in")
    found = followed(departures.jumped(system, UNIT_LEG, fold, [lambda: np.array([0.1])], "there",
                                       lambda: None) for _ in range(1))[1]
    assert "led back" in str(found) if back else found is None


@pytest.mark.parametrize("end, beyond, softest, place, back", [
    (0.05, 0.05, np.nan, 0.5, False), (0.05, 0.05, -0.1, 0.5, True), (-0.05, 0.2, 0.1, 0.5, False),
    (0.001, 0.01, 0.1, 0.5, False), (0.001, 0.2, 0.1, 0.5, True), (0.05, 0.05, 0.1, 0.9999, True)])
def test_a_branch_nearer_to_a_fold_than_kicks_are_is_found_from_beyond(end, beyond, softest, place,
                                                                       back):
    """As next to a nearly broken pitchfork: from kicks motion leads back, under a load beyond the
    fold to a branch that is ``end`` away from it there. An unstable one is none, nor is there any
    beyond the end of the leg. One that solves do not tell from the fold goes through it, if it has
    hardly moved to the load beyond: that of uneven states ends there."""
    class Beside(Landing):
        def settle(self, state, controls, load, where, origin=None):
            near = abs(state[0] - end) < 0.2 * abs(end)
            return self._point(np.array([beyond]) if load > leg.load(place) else
                               self.end if near else np.zeros(1), load, 3)

    leg = replace(UNIT_LEG, initial=0.02)
    system = Beside([end], softest=softest)
    fold = replace(system._point(np.zeros(1), leg.load(place), 3), event="fold", position=place,
                   tangents=(None,))
    starts = departures.starts(system, fold, np.ones(1))
    found, error = followed(departures.jumped(system, leg, fold, starts, "there", lambda: None)
                            for _ in range(1))
    assert "led back" in str(error) if back else found[0].state == pytest.approx([end])


@pytest.mark.parametrize("end, length, modes, refused", [
    (0.2, 0.1, 0, False), (0.2, 0.1, 1, True), (0.2, 0.1, -1, True), (0.215, 0.1, 0, True),
    (0.2, 0.1, None, True), (0.05, -0.05, 1, False), (0.05, -0.05, 2, True)])
def test_modes_that_an_arc_tells_of_are_counted_where_it_ends_as_foretold(end, length, modes,
                                                                          refused):
    """Its linear systems tell of unstable modes falsely where it turns into a soft one: one is, at
    most, and only where the load falls."""
    system = Landing([end], softest=-0.2)
    if modes is not None:
        system.examiner = lambda point: replace(point, unstable_modes=modes)
    trail = [(place, point.changed(position=place, softest=0.1))
             for place, point in system.points([0.0], [0.1])]
    search = FoldSearch(system, UNIT_LEG, trail)
    found, error = followed(search._at(trail[1], trail[0], length) for _ in range(1))
    assert "lost its stability" in str(error) if refused else found[0].softest == 0.0


@pytest.mark.parametrize("length, tight", [(0.1, False), (1e-3, True)])
def test_short_steps_of_an_arc_are_solved_to_more_digits(length, tight):
    """Next to a nearly broken pitchfork their loads would be those of what solves leave."""
    class Telling(System):
        def solve_arc(self, *given, tight=False, **others):
            self.tight = tight
            return super().solve_arc(*given, tight=tight, **others)

    system = Telling(cubic())
    trail = [(place, system._point(np.array([u]), np.array([place]), 3).changed(position=place))
             for u in (-0.8, -0.75) for place in (u ** 3 - u,)]
    FoldSearch(system, UNIT_LEG, trail)._at(trail[1], trail[0], length)
    assert system.tight is tight


def test_the_walk_starts_a_leg_next_to_its_fold():
    """With a single point to go from, the search makes its second one by a tiny step."""
    start = CUBIC_FOLD * (1.0 - 1e-5)
    guess = np.sort(np.roots([1.0, 0.0, -1.0, -start]).real)[0]
    points, error = followed(path(System(cubic()), [start, 2.0], [guess]))
    assert error is None and events(points) == ["fold", "jump"]
    assert points[1].load[0] == pytest.approx(CUBIC_FOLD,
                                              rel=2 * FOLD_TOLERANCE) and points[1].leg == 1


def test_the_search_leaves_the_fold_behind_before_it_jumps():
    """The state to jump from lies beyond the fold at a lower load, not on it."""
    for last in (-0.62, -0.6, -0.59, -0.578):
        system = System(cubic())
        leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
        history = []
        for u in (last - 0.03, last):
            load = np.array([u ** 3 - u])
            history.append((0.5 * (load[0] + 1.0), system.solve(np.array([u]), ("displacement",),
                                                                load)))
        fold, beyond, _ = FoldSearch(system, leg, history).search(NotConverged("a step"))
        assert fold.state[0] < beyond[0] and beyond[0] ** 3 - beyond[0] < fold.load[0] * (1 - 1e-6)


def test_an_arc_that_turns_on_a_straight_branch_is_no_fold():
    """A poor direction may lead the arc back along the branch: the last point is then where the
    branch has been."""
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    for problem, states, back in ((explicit(lambda load: load, lambda load: 1.0),
                                   (0.1, 0.2, 0.3, 0.27), True),
                                  (cubic(), (-0.7, -0.64, -0.58, -0.54), False)):
        system = System(problem)
        loads = [problem.residual(np.array([u]), 0.0) for u in states]
        trail = [(0.5 * (load[0] + 1.0), system.solve(np.array([u]), ("displacement",), load))
                 for u, load in zip(states, loads)]
        assert trail[3][0] < trail[2][0]
        assert FoldSearch(system, leg, trail[:2])._returns(trail) is back


@pytest.mark.parametrize("aside, back", [(0.005, True), (0.012, False)])
def test_an_arc_has_turned_where_it_is_nearer_to_its_way_than_to_its_end(aside, back):
    system = System(cubic())
    places, states = (0.1, 0.2, 0.3, 0.27), (0.1, 0.2, 0.3, 0.27 + aside)
    trail = [(place, system._point(np.array([u]), np.array([place]), 3))
             for place, u in zip(places, states)]
    assert FoldSearch(system, UNIT_LEG, trail[:2])._returns(trail) is back


def test_an_arc_is_followed_until_the_load_falls():
    system = System(cubic())
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    places = [(0.5 * (u ** 3 - u + 1.0), u) for u in (-0.62, -0.61, -0.6)]
    trail = [(place, replace(system.solve(np.array([u]), ("displacement",), leg.load(place)),
                             position=place)) for place, u in places]
    found = FoldSearch(system, leg, trail)._bracketed(trail)
    assert (len(found) > 6 and found[-1][0] < found[-2][0]
            and found[-1][1].state[0] > -1 / np.sqrt(3.0))


@pytest.mark.parametrize("drop, slope, located", [(1e-9, 1e-9, True), (1e-9, 1.0, False),
                                                  (1e-4, 1e-9, False), (1e-4, 1.0, False)])
def test_a_load_that_turns_without_its_slope_is_a_fold_on_a_plateau_only(drop, slope, located):
    """Loads that fall by no more than residuals leave open are no fold either while they rise by
    their slope."""
    class Pinned(Landing):
        def direction(self, point, chord, leg):
            return Direction(np.ones(1), slope)

    system = Pinned([0.0])
    trail = [(place, replace(system._point(np.array([u]), np.array([place]), 3), position=place))
             for place, u in ((0.3, 0.2), (0.4 - 1e-10, 0.3), (0.4, 0.4), (0.4 - drop, 0.5))]
    found, error = followed(FoldSearch(system, UNIT_LEG, trail)._locate(trail) for _ in range(1))
    if drop > FOLD_TOLERANCE:
        assert not found and "slope did not" in str(error)
    else:
        fold, _, left = found[0]
        assert (fold.fold_precision < FOLD_TOLERANCE if located else fold is None
                and left == trail[:-1])


@pytest.mark.parametrize("room, refused, behind", [(1.0, np.inf, True), (1e-6, 4e-6, True),
                                                   (1e-6, np.inf, None)])
def test_the_neighbour_of_an_only_point_is_as_near_as_what_was_refused(room, refused, behind):
    def far(load):
        return abs(load - 0.5) > room

    system = System(explicit(lambda load: load, np.ones_like), fails=far, arc_fails=far)
    last = system.solve(np.array([0.5]), UNIT_LEG.controls, np.array([0.5]))
    search = FoldSearch(system, UNIT_LEG, [(0.5, last)])
    if behind is None:
        with pytest.raises(NotConverged):
            search.trail(refused)
        return
    (before, _), (here, _) = search.trail(refused)
    assert here == 0.5 and 0.0 < here - before <= room


@pytest.mark.parametrize("begin", [-0.5, 0.0, 0.95])
def test_a_point_between_folds_nearer_than_any_step_of_the_load_has_a_neighbour(begin):
    """As behind a jump from one fold of a grid to the next."""
    rise = 1e-7
    system = System(curve(lambda u: 0.5 + rise * (1.5 * u - 0.5 * u ** 3),
                          lambda u: 1.5 * rise * (1.0 - u ** 2)),
                    fails=lambda load: abs(load - 0.5) > rise)
    place = 0.5 + rise * (1.5 * begin - 0.5 * begin ** 3)
    last = system.solve(np.array([begin]), UNIT_LEG.controls, np.array([place]))
    fold, beyond, _ = FoldSearch(system, UNIT_LEG, [(place, last)]).search(NotConverged("a step"))
    assert fold.position == pytest.approx(0.5 + rise, rel=1e-9)
    assert fold.state[0] == pytest.approx(1.0, abs=1e-3) and beyond[0] > 1.0


def test_a_peak_is_where_the_slope_turns_whatever_loads_say():
    """Short steps beyond a peak, whose loads rise by rounding still: it lies before the last two
    pairs of points."""
    system = System(cubic())
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    trail = []
    for k, u in enumerate((-0.6, -0.57, -0.5695, -0.569, -0.5685)):
        place = 0.5 * (u ** 3 - u + 1.0)
        point = system.solve(np.array([u]), ("displacement",), leg.load(place))
        trail.append((place, replace(point, position=place)))
    high = trail[1][0]
    trail = trail[:2] + [(high + rise, replace(point, position=high + rise))
                         for rise, (_, point) in zip((1e-9, 2e-9, 1e-9), trail[2:])]
    fold, _, kept = FoldSearch(system, leg, trail)._locate(trail)
    assert fold.fold_precision < FOLD_TOLERANCE and abs(leg.load(fold.position)[0] / CUBIC_FOLD
                                                        - 1.0) < 1e-8 and len(kept) == 2


def test_a_walk_along_the_arc_does_not_come_back_to_the_fold_that_it_left():
    system = System(cubic())
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    trail = []
    for u in (-0.62, -0.6, -0.55):
        place = 0.5 * (u ** 3 - u + 1.0)
        trail.append((place, replace(system.solve(np.array([u]), ("displacement",),
                                                  leg.load(place)), position=place)))
    steps = ArcLengthSteps(system, leg, trail[:1], PREDICTORS["edge"], "jump")
    steps.history = trail[:2]
    steps.departed = None
    steps.level = None
    steps.departed, _ = steps._fold_before(trail[2][1])
    assert abs(leg.load(steps.departed.position)[0] / CUBIC_FOLD - 1.0) < 1e-8
    with pytest.raises(NotConverged, match="led back to the fold"):
        steps._fold_before(trail[2][1])


@pytest.mark.parametrize("fronts", [True, False])
def test_between_points_of_the_arc_edges_and_fronts_are_in_between(fronts):
    """Where these are known; else the solve begins from a sum of both states."""
    system = System(explicit(np.sin, np.cos))
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.05, 0.1, 1e-6)
    trail = [(place, system.solve(np.zeros(1), ("displacement",), leg.load(place)))
             for place in (0.1, 0.2, 0.3, 0.5)]
    followed_state = np.array([np.sin(0.4) + 0.01])
    system.follow_edge = lambda points, weights: followed_state if fronts else None
    found = FoldSearch(system, leg, trail[:2])._natural(trail, 0.4)
    in_place = 0.5 * (trail[2][1].state + trail[3][1].state)
    assert system.guesses[4:] == [followed_state if fronts else in_place]
    assert found.state == pytest.approx(np.sin(0.4)) and found.position == 0.4


@pytest.mark.parametrize("moved, most", [(False, 6), (True, 1)])
def test_a_bracket_in_which_fronts_move_far_is_given_up_at_once(moved, most):
    """Its points cannot be foretold: the search that made it makes a shorter one."""
    system, leg = System(cubic()), replace(UNIT_LEG, start=np.array([-1.0]))
    ends = [replace(system.solve(np.array([u]), leg.controls, np.array([u ** 3 - u])),
                    position=0.5 * (u ** 3 - u + 1.0)) for u in (-0.62, -0.53)]
    system.fronts_moved = lambda first, last: moved
    peak, tried = LimitPoint(system, leg, *ends), []
    system.arc_fails = lambda load: not tried.append(load)
    assert peak.bracketed
    with pytest.raises(NotConverged, match="the load turns beyond"):
        peak.locate()
    assert len(tried) == most


def test_a_point_of_the_arc_serves_where_no_solve_does():
    """The places of a trail are points of the branch: the last one before the place in question, or
    none beyond the leg's last."""
    system = System(explicit(np.sin, np.cos))
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.05, 0.1, 1e-6)
    trail = [(place, system.solve(np.zeros(1), ("displacement",), leg.load(place)))
             for place in (0.1, 0.2, 0.33, 0.47)]
    system.fails = system.arc_fails = lambda load: True
    turn = FoldSearch(system, leg, trail[:2])
    found = turn._natural(trail, 0.4)
    assert (found.position == 0.33 and found.state is trail[2][1].state and found.leg == 1
            and 0.0 < found.step <= 0.05)
    with pytest.raises(NoFold):
        turn._natural(trail, 0.3)


@pytest.mark.parametrize("stepper", [NaturalSteps, ArcLengthSteps, TracedSteps])
def test_what_is_not_located_to_its_precision_is_no_fold(stepper):
    """Solves next to the fold fail: the path ends there and says so; the load is known to the part
    in which they fail."""
    system = System(cubic(), fails=lambda load: abs(load / CUBIC_FOLD - 1) < 1e-4,
                    arc_fails=lambda load: abs(load / CUBIC_FOLD - 1) < 1e-4)
    points, error = followed(path(system, [-1.875, 2.0], [-1.5], stepper=stepper))
    assert isinstance(error,
                      NotConverged) and folds(points) == [] and points[-1].load[0] < CUBIC_FOLD
    assert "fold" in str(error) or any("no fold" in sentence for sentence in system.sentences)


def test_the_precision_of_a_fold_is_told_with_it():
    for stepper in (NaturalSteps, ArcLengthSteps):
        points, _ = followed(path(System(cubic()), [-1.875, 2.0, -1.5], [-1.5], stepper=stepper))
        assert len(folds(points)) == 2 and all(0.0 < point.fold_precision <= FOLD_TOLERANCE
                                               for point in folds(points))
        assert all(point.fold_precision == 0.0 for point in points if point.event != "fold")
        for fold, load in zip(folds(points), (CUBIC_FOLD, -CUBIC_FOLD)):
            assert abs(fold.load[0] / load - 1.0) <= max(10.0 * fold.fold_precision, 1e-12)


@pytest.mark.parametrize("limit", [0.02, 0.1, 0.3])
def test_a_fold_that_steps_are_too_long_for_is_located_by_shorter_ones(limit):
    """A solver that finds only what its guess hardly misses, as Newton's method where a fold is
    sharp."""
    class Short(System):
        def solve_arc(self, chord, length, guess, *rest, **settings):
            point = super().solve_arc(chord, length, guess, *rest, **settings)
            if self.missed(guess, point.state) > limit * 0.05:
                raise NotConverged("the guess is too far away")
            return point

    for stepper in (NaturalSteps, ArcLengthSteps):
        points, error = followed(path(Short(cubic()), [-1.875, 2.0], [-1.5], stepper=stepper,
                                      at_fold="stop", sizes=(0.1, 0.2, 1e-6)))
        assert error is None and [point.load[0] for point in folds(points)] == pytest.approx(
            [CUBIC_FOLD], rel=FOLD_TOLERANCE)


def test_kinds_of_folds():
    def kind(moving, change):
        return fold_kind(Leg(1, ("force", "displacement"), np.zeros(2), np.array(change), moving,
                             0.1, 0.1, 0.1))

    assert kind(0, [1.0, 0.0]) == "jump_in" and kind(0, [-1.0, 0.0]) == "pull_off"
    assert kind(1, [0.0, 1.0]) == "sliding" and kind(1, [0.0, -1.0]) == "sliding"


# Arc length


def traced(problem, values, guess, stepper=ArcLengthSteps, **settings):
    """A system, the points of its branch traced through folds, and what ended it."""
    system = System(problem)
    points, error = followed(path(system, values, guess, stepper=stepper,
                                  **{"at_fold": "trace", **settings}))
    assert_solutions(system, points)
    return system, points, error


def folds(points):
    return [point for point in points if point.event == "fold"]


@pytest.mark.parametrize("stepper", [ArcLengthSteps, TracedSteps])
@pytest.mark.parametrize("predictor", PREDICTORS)
@pytest.mark.parametrize("sizes", [(1 / 40, 1 / 20, 1e-6), (0.004, 0.01, 1e-6), (0.2, 0.3, 1e-6)],
                         ids=["default", "short", "long"])
def test_a_branch_is_traced_through_its_folds(stepper, predictor, sizes):
    """To rounding, there and back: each fold at its load with its kind and null vector, each leg to
    its exact end."""
    _, points, error = traced(cubic(), [-1.875, 2.0, -1.5], [-1.5], stepper, predictor=predictor,
                              sizes=sizes)
    assert error is None
    assert [point.fold_kind for point in folds(points)] == ["jump_in", "pull_off", "pull_off",
                                                            "jump_in"]
    for point, sign in zip(folds(points), (1, -1, -1, 1)):
        assert point.load[0] == pytest.approx(sign * CUBIC_FOLD, rel=FOLD_TOLERANCE)
        tangent, = point.tangents
        assert abs(tangent.state[0]) == pytest.approx(1.0) and abs(tangent.rate) < 1e-4
    assert [point.load[0] for point in points if point.position == 1.0] == [2.0, -1.5]
    moves = np.abs(np.diff([point.position for point in points if point.leg == 1]))
    assert np.max(moves) < 2.0 * sizes[1] * (1 + 1e-9)


def test_steps_along_a_branch_without_folds_are_natural_ones():
    """As many points, each step of the load within the largest, the end exact."""
    natural, _ = followed(path(System(explicit(np.sin, np.cos)), [0.0, 1.0], [0.0]))
    system, points, error = traced(explicit(np.sin, np.cos), [0.0, 1.0], [0.0])
    assert error is None and events(points) == [] and system.sentences == []
    assert abs(len(points) - len(natural)) <= 3
    assert_steps(points, largest=1.1 / 20)


def test_several_folds_on_one_branch():
    """u + 2 sin u: cos u = -1/2 at every turn of the load."""
    _, points, error = traced(waves(), [0.0, 20.0], [0.0])
    assert error is None and points[-1].load[0] == 20.0
    places = [(2 * np.pi * turn + sign * 2 * np.pi / 3) for turn in range(4)
              for sign in (1, -1)][0:1] + [2 * np.pi * turn + sign * 2 * np.pi / 3
                                           for turn in (1, 2, 3) for sign in (-1, 1)]
    found = folds(points)
    assert ([point.fold_kind for point in found[:2]] == ["jump_in", "pull_off"]
            and 5 <= len(found) <= len(places))
    for point, place in zip(found, places):
        assert point.state[0] == pytest.approx(place, abs=1e-4)
        assert point.load[0] == pytest.approx(place + 2 * np.sin(place), rel=FOLD_TOLERANCE)


@pytest.mark.parametrize("rising, falling", [(1.0, -3.0), (1.0, -1.0), (5.0, -0.2)])
@pytest.mark.parametrize("stepper", [ArcLengthSteps, TracedSteps])
def test_a_fold_in_a_corner_has_two_tangents(rising, falling, stepper):
    at_fold = "stop" if stepper is ArcLengthSteps else "trace"
    _, points, error = traced(corner(rising, falling), [-0.1, 1.0], [0.3 - 0.4 / rising], stepper,
                              at_fold=at_fold)
    fold, = folds(points)
    assert fold.load[0] == pytest.approx(0.3, rel=FOLD_TOLERANCE)
    length = 1.1
    assert [tangent.rate * length for tangent in fold.tangents] == pytest.approx([rising, falling],
                                                                                 rel=1e-6)
    assert error is None or "came back" in str(error)


@pytest.mark.parametrize("depth, count", [(-0.3, 2), (-1e-2, 2), (0.0, 0), (1e-2, 0)])
def test_cusps(depth, count):
    """Two folds merge in a cusp, where the tangent is vertical but the load goes on."""
    _, points, error = traced(cusp(depth), [-1.0, 1.1], [-2.0])
    assert error is None and points[-1].position == 1.0
    expected = [2 * abs(depth) ** 1.5, -2 * abs(depth) ** 1.5][:count]
    assert [point.load[0] for point in folds(points)] == pytest.approx(expected, rel=1e-6)


def test_a_closed_branch_ends_where_it_began():
    for start, guess in ((-0.5, 2 + np.sqrt(0.75)), (0.0, 3.0)):
        _, points, error = traced(loop(), [start, 2.0], [guess, start])
        assert isinstance(error, NoEquilibrium) and "came back to where the leg began" in str(error)
        assert [point.load[0] for point in folds(points)] == pytest.approx([1.0],
                                                                           rel=FOLD_TOLERANCE)
        assert points[-1].load[0] == start and points[-1].state[0] < 2.0


def test_a_closed_branch_within_a_leg_is_followed_once():
    """A jump on to an isola that the leg does not leave: the trace begins inside the leg."""
    system = System(loop())
    leg = Leg(1, ("displacement",), np.array([-3.0]), np.array([3.0]), 0, 1 / 40, 1 / 20, 1e-6)
    first = replace(system.solve(np.array([3.0, 0.0]), ("displacement",), np.zeros(1)), leg=1,
                    position=0.5)
    points, error = followed(ArcLengthSteps(system, leg, [(0.5, first)], PREDICTORS["edge"],
                                            "trace"))
    assert isinstance(error, NoEquilibrium) and "closes on itself" in str(error)
    assert [point.load[0] for point in folds(points)] == pytest.approx([1.0, -1.0],
                                                                       rel=FOLD_TOLERANCE)
    assert len(points) < 100


def test_a_branch_that_leaves_ends_there():
    """load = u exp(-u): beyond its fold the load falls for ever."""
    problem = curve(lambda u: u * np.exp(-u), lambda u: (1 - u) * np.exp(-u))
    _, points, error = traced(problem, [-0.5, 1.0], [-0.3517337112])
    assert isinstance(error,
                      NoEquilibrium) and "far away" in str(error) and points[-1].state[0] > 50.0
    assert [point.load[0] for point in folds(points)] == pytest.approx([np.exp(-1)],
                                                                       rel=FOLD_TOLERANCE)


def test_jump_and_stop_with_arc_length():
    _, points, error = traced(cubic(), [-1.875, 2.0, -1.5], [-1.5], at_fold="jump")
    assert error is None and events(points) == ["fold", "jump", "fold", "jump"]
    _, points, error = traced(cubic(), [-1.875, 2.0], [-1.5], at_fold="stop")
    assert error is None and events(points) == ["fold"] and points[-1].event == "fold"


@pytest.mark.parametrize("stepper", [ArcLengthSteps, TracedSteps])
def test_a_resumed_trace_goes_on_through_the_same_branch(stepper):
    """From any of its points: the same folds, the same end."""
    _, whole, _ = traced(cubic(), [-1.875, 2.0], [-1.5], stepper)
    for cut in range(1, len(whole) + 1):
        _, rest, error = traced(cubic(), [-1.875, 2.0], [-1.5], stepper,
                                resumed=archived(whole[:cut]))
        found = folds(whole[:cut]) + folds(rest)
        assert error is None and [point.fold_kind for point in found] == ["jump_in", "pull_off"]
        assert [point.load[0] for point in found] == pytest.approx([CUBIC_FOLD, -CUBIC_FOLD],
                                                                   rel=FOLD_TOLERANCE)
        assert (whole[:cut] + rest)[-1].load[0] == 2.0


def test_folds_that_swing_within_a_small_load_are_told_of():
    """load = u + 0.0004 sin 6000 (u - 1/2): the branch of a grid on which edges stick, and one
    whose folds are far apart."""
    system, points, _ = traced(curve(lambda u: u + 4e-4 * np.sin(6e3 * (u - 0.5)),
                                     lambda u: 1 + 2.4 * np.cos(6e3 * (u - 0.5))), [0.5, 0.508],
                               [0.5])
    assert len(folds(points)) > 4 and len([sentence for sentence in system.sentences
                                           if "stick between nodes" in sentence]) == 1
    system, points, _ = traced(waves(), [0.0, 20.0], [0.0])
    assert len(folds(points)) > 4 and not any("stick between nodes" in sentence
                                              for sentence in system.sentences)


def test_events_along_a_branch_are_located():
    """Sliding from 0.3, contact until 0.8, whatever the steps."""
    system = System(contacting(lambda u: u < 0.8, lambda u: u > 0.3))
    points, error = followed(path(system, [0.0, 1.0], [0.0], stepper=ArcLengthSteps))
    assert error is None and events(points) == ["gross_sliding", "pull_off"]
    for point, load in zip([point for point in points if point.event], (0.3, 0.8)):
        assert load * (1 - 1e-12) <= point.load[0] <= load * (1 + 2 * FOLD_TOLERANCE)


def test_arc_length_goes_through_other_troubles():
    """Bends, a vertical tangent and the primary branch of a pitchfork, as natural continuation
    does."""
    for problem, values, guess in ((bend(100.0, 1e-3), [0.0, 1.0], [0.0]),
                                   (cube_root(), [-1.0, 1.1], [-1.0]),
                                   (pitchfork(), [0.0, 1.1], [0.0, 0.0])):
        _, points, error = traced(problem, values, guess)
        assert error is None and events(points) == []
        assert_steps(points, largest=1 / 10)


# What points a predictor may use


def test_history_ends_with_the_leg_and_with_a_jump():
    system = System(cubic())
    points, _ = followed(path(system, [-1.875, 2.0, 1.0], [-1.5]))
    order = {id(point.state): number for number, point in enumerate(points)}
    jump = next(number for number, point in enumerate(points) if point.event == "jump")
    turn = next(number for number, point in enumerate(points) if point.leg == 2) - 1
    assert len(system.used) > 20
    for used in system.used:
        numbers = [order[id(point.state)] for point in used if id(point.state) in order]
        for border in (jump, turn) if numbers else ():  # none: two points of an arc
            assert min(numbers) >= border or max(numbers) <= border
        assert numbers == sorted(numbers)


def test_history_of_a_leg_from_points():
    system = System(cubic())
    points, _ = followed(path(system, [-1.875, 2.0, 1.0], [-1.5]))
    turn = next(number for number, point in enumerate(points) if point.leg == 2)
    assert leg_history(points[:turn], 2) == [(0.0, points[turn - 1])]
    assert leg_history(points[:turn + 2], 2) == [(0.0, points[turn - 1]),
                                                 *((p.position, p) for p in points[turn:turn + 2])]
    jump = next(number for number, point in enumerate(points) if point.event == "jump")
    assert leg_history(points[:jump + 1], 1) == [(points[jump].position, points[jump])]
    copy = replace(points[jump], event="pull_off")
    assert leg_history([*points[:jump + 1], copy], 1) == [(copy.position, copy)]


# Events


def contacting(in_contact, sliding):
    problem = explicit(lambda load: load, lambda load: 1.0)
    problem.in_contact, problem.sliding = (lambda u: in_contact(u[0])), (lambda u: sliding(u[0]))
    return problem


def test_events_are_first_times():
    """Sliding from 0.3 to 0.5 and again from 0.6; contact until 0.8."""
    system = System(contacting(lambda u: u < 0.8, lambda u: 0.3 < u < 0.5 or 0.6 < u < 0.8))
    points, _ = followed(path(system, [0.0, 1.0], [0.0]))
    assert events(points) == ["gross_sliding", "gross_sliding", "pull_off"]
    for event, load in zip([point for point in points if point.event], (0.3, 0.6, 0.8)):
        assert load - 1e-9 <= event.load[0] <= load + 0.05 + 1e-9
    assert len({point.load[0] for point in points}) == len(points)


def test_several_events_at_one_load_are_several_points():
    system = System(contacting(lambda u: u < 0.5, lambda u: u > 0.5))
    points, _ = followed(path(system, [0.0, 1.0], [0.0]))
    first, second = (point for point in points if point.event)
    assert (first.event, second.event) == ("gross_sliding", "pull_off")
    assert (first.load[0] == second.load[0] and first.state is second.state
            and first.position == second.position)
    assert first.spent["nonlinear_iterations"] > 0 and set(second.spent.values()) == {0}
    assert second.spent.keys() == first.spent.keys()


def test_a_jump_out_of_contact_is_a_jump_and_a_pull_off():
    problem = cubic()
    problem.in_contact = lambda u: u[0] > 0.0
    system = System(problem)
    points, _ = followed(path(system, [1.0, -1.0], [1.3]))
    assert events(points) == ["fold", "jump", "pull_off"]
    fold, jump, off = (point for point in points if point.event)
    assert fold.load[0] == jump.load[0] == off.load[0] and off.fold_kind == jump.fold_kind == ""
    assert points[-1].position == 1.0


def test_with_events_keeps_the_events_own_name():
    system = System(contacting(lambda u: u < 0.5, lambda u: False))
    before, after = (system.solve(np.array([load]), ("displacement",), np.array([load]))
                     for load in (0.4, 0.6))
    assert [point.event for point in with_events(before,
                                                 replace(after, event="fold",
                                                         fold_kind="pull_off"))] == ["fold",
                                                                                     "pull_off"]
    assert [point.event for point in with_events(None, after)] == [None]


@pytest.mark.parametrize("stop, last", [("gross_sliding", 0.3), ("pull_off", 0.7)])
def test_a_stop_ends_the_path_at_the_event(stop, last):
    system = System(contacting(lambda u: u < 0.7, lambda u: u > 0.3))
    points, error = followed(path(system, [0.0, 1.0, 0.0], [0.0], stops=(stop,)))
    assert (error is None and points[-1].event == stop
            and points[-1].load[0] == pytest.approx(last, abs=0.051))
    assert stop not in events(points[:-1])


def test_costs_are_accounted_for_once():
    """The spent iterations of all points are all that were made, rejected steps, fold and jump
    included."""
    system = System(cubic())
    total, account = [], system.account
    system.account = lambda: total.append(system.spent) or account()
    points, _ = followed(path(system, [-1.875, 2.0], [-1.5]))
    assert system.sentences and sum(point.spent["nonlinear_iterations"]
                                    for point in points) == sum(total)
    assert all("last_iterations" not in point.spent for point in points)


# Interrupted paths


def archived(points):
    """The last four points as an archive gives them back: without what they cost."""
    return [replace(point, spent={}) for point in points[-4:]]


def key(point):
    return (
        point.leg,
        point.position,
        point.load[0],
        point.event,
        point.fold_kind,
        point.step,
        tuple(point.state),
    )


@pytest.mark.parametrize("fails", [
    pytest.param(lambda load: False, id="smooth", marks=pytest.mark.study),
    pytest.param(lambda load: np.sin(360.0 * load) > 0.85, id="failures")])
def test_a_resumed_path_is_the_same(fails):
    """From any point but a fold, which is found again (a later jump needs the state beyond it)."""
    values = [-1.875, 2.0, -2.0]
    whole, error = followed(path(System(cubic(), fails=fails), values, [-1.5]))
    assert error is None
    for cut in range(1, len(whole) + 1):
        if whole[cut - 1].event != "fold":
            rest, error = followed(path(System(cubic(), fails=fails), values, [-1.5],
                                        resumed=archived(whole[:cut])))
            assert error is None
            assert [key(point) for point in rest] == [key(point) for point in whole[cut:]]


def test_a_resumed_path_hands_out_the_further_events_of_a_jump():
    def problem():
        made = cubic()
        made.in_contact = lambda u: u[0] > 0.0
        return made

    whole, _ = followed(path(System(problem()), [1.0, -1.0], [1.3]))
    cut = [point.event for point in whole].index("jump") + 1
    rest, _ = followed(path(System(problem()), [1.0, -1.0], [1.3], resumed=archived(whole[:cut])))
    assert [key(point) for point in rest] == [key(point) for point in whole[cut:]]
    # What it costs is nothing, but is a number for every column of an archive.
    assert rest[0].spent == {"nonlinear_iterations": 0}


def test_a_path_that_met_its_stop_is_over():
    system = System(contacting(lambda u: u < 0.7, lambda u: u > 0.3))
    whole, _ = followed(path(system, [0.0, 1.0], [0.0], stops=("pull_off",)))
    assert followed(path(system, [0.0, 1.0], [0.0], stops=("pull_off",),
                         resumed=archived(whole))) == ([], None)
    whole, _ = followed(path(System(cubic()), [-1.875, 2.0], [-1.5], at_fold="stop"))
    assert followed(path(System(cubic()), [-1.875, 2.0], [-1.5], at_fold="stop",
                         resumed=archived(whole))) == ([], None)


def test_a_walk_can_be_left_at_any_point():
    """The iterator asks nothing of its consumer: dropping it early is no error."""
    system = System(cubic())
    leg = Leg(1, ("displacement",), np.array([-1.875]), np.array([2.0]), 0, 0.1, 0.1, 1e-6)
    first = system.solve(np.array([-1.5]), ("displacement",), np.array([-1.875]))
    steps = iter(NaturalSteps(system, leg, [(0.0, first)], PREDICTORS["edge"], "jump"))
    assert next(steps).leg == 1
    steps.close()


def test_an_error_without_frames_holds_nothing_of_where_it_was_raised():
    class Held:
        pass

    def failed(seen):
        held = Held()
        seen.append(weakref.ref(held))
        try:
            raise NotConverged("first")
        except NotConverged:
            raise NotConverged("then") from None

    seen = []
    try:
        failed(seen)
    except NotConverged as caught:
        assert seen[0]() is not None
        error = caught
    without_frames(error)
    assert seen[0]() is None and str(error) == "then"


@pytest.mark.parametrize("held, apart, ends", [(None, 0.0, False), (1, 0.0, True),
                                               (1, 0.01, False)])
def test_jumps_of_a_body_that_nothing_holds_end(held, apart, ends):
    """From one of many equilibria to the next, under one load: not those that lead on, nor those of
    a body that something holds."""
    system = System(cubic())
    system.neutral = lambda point: held
    first = system.solve(-np.ones(1), ("displacement",), np.zeros(1))
    steps = NaturalSteps(system, UNIT_LEG, [(0.0, first)], SECANT, "jump")
    folds = [replace(first, position=0.5 + apart * number) for number in range(REPEATED + 1)]
    for fold in folds[:REPEATED]:
        steps._leave_once_more(fold)
    with pytest.raises(NoEquilibrium, match="nothing holds the body") if ends else nullcontext():
        steps._leave_once_more(folds[REPEATED])


@pytest.mark.parametrize("place, resolved", [(0.12, 1), (0.08, 0)])
def test_a_fold_behind_the_last_point_is_one_of_several(place, resolved):
    """The load that led to that point has its limit elsewhere."""
    system = Landing([0.4])
    history = system.points([0.0], [0.2])
    fold = replace(history[-1][1], position=place, event="fold", fold_kind="pull_off",
                   fold_precision=1e-9)
    steps = NaturalSteps(system, UNIT_LEG, history, SECANT, "stop")
    found, = steps._fold(NotConverged("refused"), kind=lambda *_: SimpleNamespace(
        search=lambda *_: (fold, None, None)), starts=lambda *_: [])
    assert (found.event, found.resolved) == ("fold", resolved)
