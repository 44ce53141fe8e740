"""Bifurcations: on problems of few unknowns with known branches, and where one of two contact spots
lets go first."""

from dataclasses import replace

import numpy as np
import petsc4py
import pytest
from scipy.optimize import brentq

petsc4py.init([])

from dense_cell import Cell  # noqa: E402
from test_continuation import (  # noqa: E402
    UNIT_LEG,
    Landing,
    Problem,
    System,
    assert_solutions,
    curve,
    events,
    followed,
    path,
    pitchfork,
)

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.continuation import branching  # noqa: E402
from contactsnes.continuation.arclength import ArcLengthSteps  # noqa: E402
from contactsnes.continuation.bifurcations import between, examined  # noqa: E402
from contactsnes.continuation.natural import NaturalSteps  # noqa: E402
from contactsnes.continuation.points import (  # noqa: E402
    Leg,
    NoEquilibrium,  # noqa: E402
    NotConverged,
)
from contactsnes.continuation.softening import SOFT, probe  # noqa: E402
from contactsnes.dynamics.modes import NEUTRAL  # noqa: E402
from contactsnes.dynamics.stability import Stability  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402


class Dense:
    """What continuation asks of stability, by the eigenvalues of a problem's dense Jacobian."""

    def __init__(self, system):
        self.problem = system.problem

    def _modes(self, point):
        values, vectors = np.linalg.eig(self.problem.jacobian(point.state, point.load[-1]))
        order = np.argsort(values.real)
        return values[order], vectors.T[order]

    def __call__(self, point):
        values, _ = self._modes(point)
        return replace(point, stable=int(values[0].real > 0.0 and point.event != "fold"),
                       unstable_modes=int(np.sum(values.real < (-1e-3 if point.event == "fold"
                                                                else 0.0))))

    def critical(self, point, number):
        values, vectors = self._modes(point)
        return values[number].real, replace(point, leading_eigenvalue=complex(values[number]),
                                            mode=vectors[number].real)

    def aside(self, point):
        return point.state + point.mode


class Seeing(System):
    """A system whose solves tell their softest mode: the smallest eigenvalue of J, or with the load
    as an unknown that of its matrix over the one with the identity in the place of J, as a Krylov
    method with a preconditioner sees it."""

    def __init__(self, problem):
        super().__init__(problem)
        self.examiner = Dense(self)

    def solve(self, guess, controls, load):
        point = super().solve(guess, controls, load)
        return replace(point,
                       softest=np.linalg.eigvals(self.problem.jacobian(point.state,
                                                                       load[-1])).real.min())

    def solve_arc(self, chord, length, guess, position, leg, border=(1.0, 0.0), tight=False):
        point = super().solve_arc(chord, length, guess, position, leg, border)
        matrix = self._bordered(np.append(point.state, point.position),
                                border[0] * self._row(chord), leg, border[1])
        plain = matrix.copy()
        plain[:-1, :-1] = np.eye(len(point.state))
        return replace(point, softest=np.linalg.eigvals(np.linalg.solve(plain, matrix)).real.min())


def followed_steps(problem, values=(0.0, 1.0), guess=(0.0, 0.0), **settings):
    """Points along a path of a problem, with stability."""
    system = System(problem)
    points, error = followed(path(system, values, guess, certify=Dense(system), **settings))
    assert_solutions(system, points)
    return points, error


def crossing_subcritical():
    """(u - load, v (1/2 - load - v^2 + v^4)): at 1/2 the branch v = 0 loses its stability, and v
    jumps to 1."""
    return Problem(lambda x,
                   load: np.array([x[0] - load, x[1] * (0.5 - load - x[1] ** 2 + x[1] ** 4)]),
                   lambda x, load: np.diag([1.0, 0.5 - load - 3 * x[1] ** 2 + 5 * x[1] ** 4]),
                   lambda x, load: np.array([-1.0, -x[1]]))


def broken(bias):
    """The same, v drawn to positive values: its stable branch ends in a fold, beside the rest of v
    = 0, which is not stable.

    There load = 1/2 - v^2 + v^4 - bias/v.
    """
    return Problem(lambda x,
                   load: np.array([x[0] - load, x[1] * (0.5 - load - x[1] ** 2 + x[1] ** 4)
                                   - bias]), lambda x,
                   load: np.diag([1.0, 0.5 - load - 3 * x[1] ** 2 + 5 * x[1] ** 4]), lambda x,
                   load: np.array([-1.0, -x[1]]))


def several_crossings(places):
    """Unknowns that lose their stability at loads, beside one that follows the load."""
    places = np.array(places)
    return Problem(lambda x, load: np.append(x[0] - load, x[1:] * (x[1:] ** 2 + places - load)),
                   lambda x, load: np.diag(np.append(1.0, 3 * x[1:] ** 2 + places - load)),
                   lambda x, load: np.append(-1.0, -x[1:]))


def two_crossings(first, second):
    """Two of them."""
    return several_crossings((first, second))


def flutter():
    """A pair of unknowns that begins to oscillate at load 0.3: a complex pair crosses the imaginary
    axis."""
    turn = np.array([[0.0, 2.0], [-2.0, 0.0]])
    matrix = lambda load: (0.3 - load) * np.eye(2) + turn
    return Problem(lambda x, load: np.append(x[0] - load, matrix(load) @ x[1:]), lambda x,
                   load: np.block([[np.eye(1), np.zeros((1, 2))],
                                   [np.zeros((2, 1)), matrix(load)]]), lambda x,
                   load: np.append(-1.0, -x[1:]))


def test_a_pitchfork_is_passed_and_its_place_stored():
    points, error = followed_steps(pitchfork())
    assert error is None and events(points) == ["bifurcation"]
    critical = next(point for point in points if point.event == "bifurcation")
    assert (critical.load[-1] == pytest.approx(0.5, rel=1e-8) and critical.stable == 0
            and critical.unstable_modes == 0)
    assert np.abs(critical.mode) == pytest.approx([0.0, 1.0])
    for point in points[1:]:
        if point is not critical:
            assert (point.stable, point.unstable_modes) == ((1, 0) if point.load[-1] < 0.5
                                                            else (0, 1))
    assert [point.load[-1] for point in points] == sorted(point.load[-1] for point in points)


@pytest.mark.parametrize("bias", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("certified", [True, False])
@pytest.mark.parametrize("stepper", [NaturalSteps, ArcLengthSteps])
def test_a_broken_bifurcation_is_a_fold(bias, certified, stepper):
    """Steps that are much longer than the way between the two branches; without certificates solves
    see where they are."""
    place = brentq(lambda v: -2 * v + 4 * v ** 3 + bias / v ** 2, 1e-6, 0.5)
    system = System(broken(bias)) if certified else Seeing(broken(bias))
    settings = {"certify": Dense(system)} if certified else {}
    points, error = followed(path(system, (0.0, 1.0), (0.0, 2 * bias), stepper=stepper, **settings))
    assert_solutions(system, points)
    assert error is None and events(points) == ["fold", "jump"]
    fold, jump = (next(point for point in points if point.event == name)
                  for name in ("fold", "jump"))
    assert fold.load[0] == pytest.approx(0.5 - place ** 2 + place ** 4 - bias / place,
                                         rel=1e-8) and jump.state[1] > 0.9
    assert all(point.state[1] <= place * 1.01
               for point in points[:[point.event for point in points].index("fold")])


@pytest.mark.parametrize("stable", (1.0, -1.0))
def test_a_fold_is_found_from_the_unstable_side_of_a_branch_too(stable):
    """u^2 = 0.6 - load, from u = -sqrt(0.6): as a path begins whose control was switched to a force
    where that is not stable; beside it a mode that changes nothing, stable or not."""
    problem = Problem(lambda x, load: np.array([stable * x[0], x[1] ** 2 + load - 0.6]),
                      lambda x, load: np.diag([stable, 2.0 * x[1]]),
                      lambda x, load: np.array([0.0, 1.0]))
    points, error = followed_steps(problem, guess=(0.0, -np.sqrt(0.6)), at_fold="stop")
    assert error is None and events(points) == ["fold"]
    assert points[-1].load[-1] == pytest.approx(0.6, abs=1e-8)
    assert {point.unstable_modes - (stable < 0.0) for point in points[1:-1]} == {1}


@pytest.mark.parametrize("side", (1.0, -1.0))
def test_a_bifurcation_next_to_a_fold_is_not_taken_for_the_folds_own_mode(side):
    """u^2 = 0.6 - load, from either side of the fold, and beside it a mode of the eigenvalue 0.0004
    - u^2, which regains its stability within the step to the fold."""
    problem = Problem(lambda x, load: np.array([x[0] ** 2 + load - 0.6,
                                                x[1] * (4e-4 - x[0] ** 2 + x[1] ** 2)]),
                      lambda x, load: np.array([[2.0 * x[0], 0.0], [
                          -2.0 * x[0] * x[1], 4e-4 - x[0] ** 2 + 3.0 * x[1] ** 2]]),
                      lambda x, load: np.array([1.0, 0.0]))
    points, error = followed_steps(problem, guess=(side * np.sqrt(0.6), 0.0), at_fold="stop")
    assert error is None and events(points) == ["bifurcation", "fold"]
    assert points[-2].load[-1] == pytest.approx(0.5996, abs=1e-8)
    assert {point.unstable_modes for point in points[1:-2]} == {1 if side > 0.0 else 2}
    assert [point.unstable_modes for point in points[-2:]] == [0 if side > 0.0 else 1, 0]


class Early(Seeing):
    """The same with solves that tell of a mode before it is unstable, as few iterations may."""

    def solve(self, guess, controls, load):
        point = super().solve(guess, controls, load)
        return point.changed(softest=point.softest - 0.2)


@pytest.mark.parametrize("kind", [Seeing, Early])
def test_an_exact_bifurcation_that_a_solve_sees_is_passed_and_told_of(kind):
    """One that solves told of too early, before a count of modes found it, is looked for again."""
    system = kind(pitchfork())
    points, error = followed(path(system, (0.0, 1.0), (0.0, 0.0)))
    assert error is None and events(points) == [] and points[-1].position == 1.0
    told = [sentence for sentence in system.sentences if "points beyond are not stable" in sentence]
    assert len(told) == 1 and "normal_displacement 0.5 is passed" in told[0]


def test_a_path_may_stop_there():
    points, error = followed_steps(pitchfork(), at_bifurcation="stop")
    assert (error is None and points[-1].event == "bifurcation"
            and points[-1].load[-1] == pytest.approx(0.5, rel=1e-8))


@pytest.mark.parametrize("problem, branch, event", [(pitchfork, lambda load: np.sqrt(load - 0.5),
                                                     None),
                                                    (crossing_subcritical,
                                                     lambda load: np.sqrt(0.5
                                                                          + np.sqrt(load - 0.25)),
                                                     "jump")])
def test_the_stable_branch_is_followed_on_request(problem, branch, event):
    points, error = followed_steps(problem(), at_bifurcation="follow")
    assert error is None and points[-1].position == 1.0
    place = [point.event for point in points].index("bifurcation")
    assert points[place + 1].event == event
    for point in points[place + 1:]:
        assert abs(point.state[1]) == pytest.approx(branch(max(point.load[-1], 0.5)),
                                                    rel=1e-6) and point.stable == 1


@pytest.mark.parametrize("problem, size, told", [
    (two_crossings(0.3, 0.3), 3, True), (two_crossings(0.3, 0.31), 3, False),
    (flutter(), 3, False), (pitchfork(), 2, False)])
def test_of_several_modes_that_are_lost_at_once_it_is_told_that_one_is_followed(problem, size,
                                                                                told):
    system = System(problem)
    followed(path(system, (0.0, 1.0), (0.0,) * size, certify=Dense(system),
                  at_bifurcation="follow"))
    sentences = [text for text in system.sentences if "other branches begin" in text]
    assert len(sentences) == told
    assert all(text.startswith("2 modes lose their stability") for text in sentences)


def test_what_is_followed_where_two_modes_are_lost_at_once_is_stable():
    """Both unknowns have left zero, where each is not stable: motion along one leaves the other."""
    points, error = followed_steps(two_crossings(0.3, 0.3), guess=(0.0,) * 3,
                                   at_bifurcation="follow")
    assert error is None and points[-1].position == 1.0
    assert all(point.stable == 1 for point in points if point.load[-1] > 0.3 + 1e-6)
    assert np.abs(points[-1].state[1:]) == pytest.approx(np.sqrt(0.7), rel=1e-6)


def test_a_motion_that_leaves_to_one_side_says_nothing_of_the_other():
    """Of the two sides of a pitchfork one has no equilibrium that motion reaches."""
    def leaving(left):
        system = System(pitchfork())
        settle = system.settle

        def settled(state, controls, load, where, origin=None):
            if left(state[1]):
                raise NoEquilibrium(f"no equilibrium {where}")
            return settle(state, controls, load, where, origin)

        system.settle = settled
        return followed(path(system, (0.0, 1.0), (0.0, 0.0), certify=Dense(system),
                             at_bifurcation="follow"))

    _, error = leaving(lambda aside: True)
    assert isinstance(error, NoEquilibrium)
    for sign in (1.0, -1.0):
        points, error = leaving(lambda aside: sign * aside > 0.0)
        assert error is None and points[-1].stable == 1
        assert -sign * points[-1].state[1] == pytest.approx(np.sqrt(0.5), rel=1e-6)


@pytest.mark.parametrize("end, back", [(0.005, True), (0.2, False)])
def test_a_motion_that_leads_back_is_no_other_branch(end, back):
    """Beside a branch that has lost its stability: it ended nearer to the branch than three tenths
    of where it began, or farther away."""
    system = Landing([end], curve(lambda u: -u, lambda u: -np.ones_like(u)))
    (_, critical), (_, beyond) = system.points([0.0], [0.0])
    found = branching.followed(system, Dense(system), UNIT_LEG,
                               replace(critical, mode=np.ones(1)), beyond)
    assert (found is None) == back and any("led back" in sentence
                                           for sentence in system.sentences) == back


def test_a_jump_that_ends_in_an_unstable_state_goes_on_to_a_stable_one():
    """(u^3 - u - load, v (v^2 + 1/2 - u)): u jumps from the cubic's fold to where v = 0 is not
    stable any more."""
    problem = Problem(lambda x, load: np.array([x[0] ** 3 - x[0] - load,
                                                x[1] * (x[1] ** 2 + 0.5 - x[0])]), lambda x,
                      load: np.array([[3 * x[0] ** 2 - 1, 0.0],
                                      [-x[1], 3 * x[1] ** 2 + 0.5 - x[0]]]), lambda x,
                      load: np.array([-1.0, 0.0]))
    points, error = followed_steps(problem, (-2.0, 1.0), (-1.5, 0.0))
    assert error is None and events(points) == ["fold", "jump"]
    jump = next(point for point in points if point.event == "jump")
    assert jump.stable == 1 and jump.state == pytest.approx([2 / np.sqrt(3), jump.state[1]],
                                                            rel=1e-6)
    assert abs(jump.state[1]) == pytest.approx(np.sqrt(jump.state[0] - 0.5), rel=1e-6)
    unmarked, _ = followed(path(System(problem), (-2.0, 1.0), (-1.5, 0.0)))
    assert (next(point for point in unmarked if point.event == "jump").state[1]
            == pytest.approx(0.0, abs=1e-9))


def test_a_jump_at_a_bifurcation_ends_where_a_body_rests_under_its_load():
    """Beside the subcritical crossing w (w^2 + c), c = 1 + v^2 (100 (load - 0.501) - 1): w = 0 is
    stable where steps find v = 1 beyond the bifurcation, and not under the load 1/2 itself."""
    def stiffness(load):
        return 100.0 * (load - 0.501) - 1.0

    plain = crossing_subcritical()
    problem = Problem(
        lambda x, load: np.append(plain.residual(x[:2], load),
                                  x[2] * (x[2] ** 2 + 1.0 + x[1] ** 2 * stiffness(load))),
        lambda x, load: np.block([[plain.jacobian(x[:2], load), np.zeros((2, 1))],
                                  [0.0, 2.0 * x[1] * x[2] * stiffness(load),
                                   3.0 * x[2] ** 2 + 1.0 + x[1] ** 2 * stiffness(load)]]),
        lambda x, load: np.append(plain.load_derivative(x[:2], load), 100.0 * x[2] * x[1] ** 2))
    points, _ = followed_steps(problem, (0.0, 0.7), (0.0, 0.0, 0.0), at_bifurcation="follow")
    jump = next(point for point in points if point.event == "jump")
    assert jump.load[-1] == pytest.approx(0.5, rel=1e-8) and jump.stable == 1
    assert np.abs(jump.state) == pytest.approx([0.5, 1.0, np.sqrt(0.1)], rel=1e-6)


def test_a_jump_at_a_bifurcation_ends_in_the_first_state_on_its_way():
    """v q with q = 1/2 - load + s ((s - 1) (s - 2) (s - 4) - 300 (load - 1/2)), s = v^2: under the
    load 1/2 itself v comes to 1; beyond the bifurcation nothing holds it there, but at 2."""
    hill = np.polynomial.Polynomial.fromroots([0.0, 1.0, 2.0, 4.0])
    q = lambda s, load: 0.5 - load + hill(s) - 300.0 * s * (load - 0.5)
    slope = lambda s, load: hill.deriv()(s) - 300.0 * (load - 0.5)
    problem = Problem(
        lambda x, load: np.array([x[0] - load, x[1] * q(x[1] ** 2, load)]),
        lambda x, load: np.diag([1.0, q(x[1] ** 2, load)
                                 + 2.0 * x[1] ** 2 * slope(x[1] ** 2, load)]),
        lambda x, load: np.array([-1.0, -x[1] * (1.0 + 300.0 * x[1] ** 2)]))
    points, _ = followed_steps(problem, (0.0, 0.7), at_bifurcation="follow", at_fold="stop")
    jump = next(point for point in points if point.event == "jump")
    assert jump.load[-1] == pytest.approx(0.5, rel=1e-8) and jump.stable == 1
    assert np.abs(jump.state) == pytest.approx([0.5, 1.0], rel=1e-6)


def test_a_mode_that_is_neutral_at_one_end_crosses_zero_elsewhere_if_at_all():
    """Behind the limit of a branch that ends in a pitchfork its mode grows out of rounding."""
    class Values:
        def __init__(self, *values):
            self.values = values

        def critical(self, point, index):
            return self.values[int(point.position)], point

    system = System(pitchfork())
    ends = [(place, replace(system._point(np.zeros(2), np.zeros(1), 1), position=place,
                            unstable_modes=number)) for place, number in ((0.0, 0), (1.0, 1))]
    assert between(system, Values(-0.3 * NEUTRAL, -1e-3), UNIT_LEG, *ends) == []
    assert any("no bifurcation was located there" in told for told in system.sentences)
    with pytest.raises(NotConverged, match="the eigenvalue is"):
        between(system, Values(-3.0 * NEUTRAL, -1e-3), UNIT_LEG, *ends)


@pytest.mark.parametrize("behind, apart", [(-0.3 * NEUTRAL, True), (-0.01 * NEUTRAL, False)])
def test_a_neutral_mode_below_zero_has_lost_its_stability_where_the_last_point_had_it(behind,
                                                                                      apart):
    """Next to a nearly broken pitchfork even a short step may go over the fold, to where a mode is
    hardly unstable; what rounding makes of a neutral one is less."""
    class Halves(System):
        def solve(self, guess, controls, load):
            return replace(self._point(np.array([load[0], float(load[0] > 0.3)]), load, 1),
                           position=load[0])

    class Signs:
        def __call__(self, point):
            value, _ = self.critical(point, 0)
            return replace(point, stable=int(value > NEUTRAL), unstable_modes=0)

        def critical(self, point, index):
            return (1e-3 if point.load[0] <= 0.3 else behind), point

    system = Halves(pitchfork())
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 2e3, 2e3, 1e-6)
    first, point = [system.solve(None, leg.controls, leg.load(place)) for place in (0.0, 1.0)]
    _, error = followed(examined(system, Signs(), leg, (0.0, first), point) for _ in range(1))
    assert ("no bifurcation was located there" in str(error)) is apart


@pytest.mark.parametrize("second", [0.7, 0.31, 0.3 + 1e-6])
def test_all_modes_that_change_in_a_step_are_found(second):
    points, _ = followed_steps(two_crossings(0.3, second), guess=(0.0, 0.0, 0.0))
    found = [point for point in points if point.event == "bifurcation"]
    assert [point.load[-1] for point in found] == pytest.approx([0.3, second], rel=1e-8)
    assert [point.unstable_modes for point in found] == [0, 1] and points[-1].unstable_modes == 2


def test_modes_of_two_symmetries_that_change_in_turn_are_found_both():
    """The number of unstable modes is the same at both ends of a step in which one of each symmetry
    changes, and a fold was passed so."""
    class Symmetric(Dense):
        def __call__(self, point):
            values, vectors = self._modes(point)
            of = np.argmax(np.abs(vectors[values < 0.0]), axis=1).tolist()
            return replace(super().__call__(point),
                           unstable_parities=tuple(((1,), (-1,))[number - 1] for number in of))

    slopes = np.array([1.0, -1.0])
    stiffness = lambda load: slopes * (load - np.array([0.53, 0.66]))
    problem = Problem(lambda x, load: np.append(x[0] - load, x[1:] * stiffness(load)),
                      lambda x, load: np.diag(np.append(1.0, stiffness(load))),
                      lambda x, load: np.append(-1.0, x[1:] * slopes))
    system = System(problem)
    points, error = followed(path(system, (0.0, 1.0), (0.0,) * 3, certify=Symmetric(system),
                                  sizes=(0.4, 0.4, 1e-6)))
    found = [point for point in points if point.event == "bifurcation"]
    assert error is None and points[-1].unstable_modes == 1
    assert [point.load[-1] for point in found] == pytest.approx([0.53, 0.66], rel=1e-8)


@pytest.mark.parametrize("places, counts", [((0.3, 0.3), [0]), ((0.3, 0.3, 0.31), [0, 2]),
                                            ((0.3, 0.31, 0.31), [0, 1])])
def test_modes_that_change_at_once_are_one_bifurcation_whatever_rounding_makes_of_them(places,
                                                                                       counts):
    """Eigenvalues of large systems are known to some 1e-8, by which places of their roots differ by
    more than one is known to."""
    problem, size = several_crossings(places), len(places) + 1
    system = System(problem)
    exact = Dense(system)

    class Rounded(Dense):
        def critical(self, point, number):
            value, point = exact.critical(point, number)
            return value + 5e-8 * (-1.0) ** number, point

    points, _ = followed(path(system, (0.0, 1.0), (0.0,) * size, certify=Rounded(system)))
    found = [point for point in points if point.event == "bifurcation"]
    assert [point.unstable_modes for point in found] == counts
    assert [point.load[-1] for point in found] == pytest.approx(sorted(set(places)), abs=1e-7)
    assert points[-1].unstable_modes == len(places) and not system.sentences


def test_following_edges_on_a_coarse_grid_leads_no_search_off_the_branch():
    """Next to where an eigenvalue vanishes a solve leaves the branch if it begins beside it, and
    following edges has an error that does not fall with the step."""
    softening = lambda x, load: 0.75 - load - load ** 2 - x[1] ** 2
    problem = Problem(lambda x, load: np.array([x[0] - load, x[1] * softening(x, load)]),
                      lambda x, load: np.diag([1.0, softening(x, load) - 2.0 * x[1] ** 2]),
                      lambda x, load: np.array([-1.0, -x[1] * (1.0 + 2.0 * load)]))

    class Coarse(System):
        def follow_edge(self, points, weights):
            return self.extrapolate(points, weights) + np.array([0.0, 2e-5])

        def solve(self, guess, controls, load):
            softness = abs(np.linalg.eigvals(problem.jacobian(guess, load[-1]))).min()
            if abs(guess[1]) > max(0.1 * softness, 1e-7):
                raise NotConverged("the solve diverged")
            return super().solve(guess, controls, load)

    system = Coarse(problem)
    stability, ends = Dense(system), []
    for place in (0.3, 0.8):
        point = system.solve(np.array([place, 0.0]), UNIT_LEG.controls, UNIT_LEG.load(place))
        ends.append((place, stability(replace(point, position=place))))
    found = between(system, stability, UNIT_LEG, *ends)
    assert [point.position for point in found] == [pytest.approx(0.5, abs=1e-8)]


def of_stiffness(stiffness):
    """A system in which u is the load, and the mode v has a stiffness at each load."""
    return Seeing(Problem(lambda x, load: np.array([x[0] - load, x[1] * stiffness(load)]),
                          lambda x, load: np.diag([1.0, stiffness(load)]),
                          lambda x, load: np.array([-1.0, 0.0])))


def at_loads(system, leg, *places):
    """The points of such a system at some loads."""
    return [replace(system.solve(np.array([place, 0.0]), leg.controls, leg.load(place)),
                    position=place) for place in places]


@pytest.mark.parametrize("least, solves", [(-0.05, 2), (0.01, 2), (1.0, 0)])
def test_a_mode_that_softens_fast_is_looked_at_within_a_step(least, solves):
    """v has the stiffness 4 (load - 0.6)^2 + ``least``: lost and regained in one step where that is
    negative in between."""
    def stiffness(load):
        return 4.0 * (load - 0.6) ** 2 + least

    problem = Problem(lambda x, load: np.array([x[0] - load, x[1] * stiffness(load) + x[1] ** 3]),
                      lambda x, load: np.diag([1.0, stiffness(load) + 3 * x[1] ** 2]), lambda x,
                      load: np.array([-1.0, 0.0]))
    system = Seeing(problem)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    *history, point = at_loads(system, leg, 0.1, 0.3, 0.95)
    assert min(point.softest, history[-1].softest) > 0.0
    system.attempts.clear()
    history = [(found.position, found) for found in history]
    if least < 0.0:
        with pytest.raises(NotConverged, match="stable at both ends of the step"):
            probe(system, leg, history, point)
    else:
        probe(system, leg, history, point)
    assert len(system.attempts) <= solves and bool(system.attempts) == bool(solves)


@pytest.mark.parametrize("values, solves", [((0.043, 0.04, 0.042), 0), ((0.06, 0.045, 0.03), 2),
                                            ((0.3, 0.1, 0.09), 2)])
def test_a_mode_that_is_as_soft_all_along_is_not_looked_at(values, solves):
    """... as that of a sharp law is: only one that would lose a good part of its value in a step
    may have lost all of it within."""
    system = Seeing(Problem(lambda x, load: np.array([x[0] - load, x[1]]),
                            lambda x, load: np.eye(2), lambda x, load: np.array([-1.0, 0.0])))
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    *history, point = [replace(system.solve(np.array([place, 0.0]), leg.controls, leg.load(place)),
                               position=place, softest=value)
                       for place, value in zip((0.1, 0.4, 1.0), values)]
    system.attempts.clear()
    probe(system, leg, [(found.position, found) for found in history], point)
    assert len(system.attempts) == solves


@pytest.mark.parametrize("least, refused, solves", [(-0.1, "is not at", 1),
                                                    (-0.06, "is hardly so at", 1), (0.2, "", 2)])
def test_a_mode_that_softens_in_a_long_first_step_is_looked_at_within_it(least, refused, solves):
    """... whose rate no step before tells: v has the stiffness 4 (load - 0.6)^2 + ``least``."""
    def stiffness(load):
        return 4.0 * (load - 0.6) ** 2 + least

    system = of_stiffness(stiffness)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.9, 0.9, 1e-6)
    first, point = at_loads(system, leg, 0.0, 0.95)
    assert min(point.softest, first.softest) > 0.0
    start = replace(system.solve(np.array([-0.1, 0.0]), leg.controls, leg.load(-0.1)),
                    position=-0.1, softest=np.nan)
    for history in ([first], [start, first]):  # a rate is not known of a start without solves, too
        system.attempts.clear()
        _, error = followed(probe(system, leg, [(found.position, found) for found in history],
                                  point) for _ in range(1))
        assert refused in str(error) if refused else error is None
        assert len(system.attempts) == solves


@pytest.mark.parametrize("slope, way, solves", [(0.15, 1.0, 0), (0.25, 1.0, 2), (0.0, 8.0, 2)])
def test_a_first_step_in_which_a_mode_softens_by_a_fifth_or_that_is_long_is_looked_at(slope, way,
                                                                                      solves):
    """... though it is far from losing its stability at both ends: no rate tells of it."""
    system = of_stiffness(lambda load: 1.0 - slope * load)
    leg = Leg(1, ("displacement",), np.zeros(1), np.full(1, way), 0, 0.9, 0.9, 1e-6)
    first, point = at_loads(system, leg, 0.0, 1.0)
    system.attempts.clear()
    probe(system, leg, [(0.0, first)], point)
    assert len(system.attempts) == solves


@pytest.mark.parametrize("least, dip, refused, solves", [
    (-0.01, 0.8, "is not at", 2), (0.004, 0.7, "is hardly so at", 2), (0.04, 0.0, "", 2)])
def test_a_first_step_from_where_a_mode_is_hardly_stable_is_looked_at(least, dip, refused, solves):
    """... though the mode is stiffer at its end: v has the stiffness dip (load - 0.2375)^2 + least,
    or the same all along, as of a sharp law."""
    def stiffness(load):
        return dip * (load - 0.2375) ** 2 + least

    system = of_stiffness(stiffness)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.9, 0.9, 1e-6)
    first, point = at_loads(system, leg, 0.0, 0.95)
    assert 0.0 < first.softest < SOFT and point.softest >= first.softest
    system.attempts.clear()
    _, error = followed(probe(system, leg, [(0.0, first)], point) for _ in range(1))
    assert refused in str(error) if refused else error is None
    assert len(system.attempts) == solves


@pytest.mark.parametrize("back", [0.2, 1.0])
def test_where_a_mode_is_hardly_stable_within_a_step_the_tangent_leads_back_or_it_jumped(back):
    """... from there: where the step ends, beyond the jump, it leads back by chance."""
    def stiffness(load):
        return 4.0 * (load - 0.6) ** 2 + 0.01

    system = of_stiffness(stiffness)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    first, last, point = at_loads(system, leg, 0.1, 0.3, 0.95)
    system.along_tangent = (lambda begin, leg, position, step: begin.state + np.array(
        [step * (1.0 if begin is point else back), 0.0]))
    _, error = followed(probe(system, leg, [(0.1, first), (0.3, last)], point) for _ in range(1))
    assert ("hardly leads back" in str(error)) is (back < 0.5)


@pytest.mark.parametrize("back", [0.2, 1.0])
def test_within_a_first_step_in_which_a_mode_softens_the_tangent_leads_back_or_it_jumped(back):
    """... however stable the mode is where that is asked: behind the jump it is stiff again."""
    system = of_stiffness(lambda load: 1.5 - load)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.9, 0.9, 1e-6)
    first, point = at_loads(system, leg, 0.0, 1.0)
    system.along_tangent = (lambda begin, leg, position, step: begin.state + np.array(
        [step * (1.0 if begin is point else back), 0.0]))
    _, error = followed(probe(system, leg, [(0.0, first)], point) for _ in range(1))
    assert ("hardly leads back" in str(error)) is (back < 0.5)


@pytest.mark.parametrize("softest, back, refused", [(0.02, 0.2, True), (0.3, 0.2, True),
                                                    (0.3, 1.0, False), (0.9, 0.2, False)])
def test_where_a_mode_has_softened_the_tangent_leads_back_or_the_step_jumped(softest, back,
                                                                             refused):
    """A jump that is small beside the step: rates behind it lead back a fifth of the way."""
    system = Seeing(pitchfork())
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    system.along_tangent = (lambda point, leg, position,
                            step: point.state + back * np.array([step, 0.0]))
    first, last, point = (replace(system._point(np.array([place, 0.0]), np.array([place]), 3),
                                  position=place, softest=soft)
                          for place, soft in ((0.0, 1.0), (0.2, 1.0), (0.3, softest)))
    found = followed(probe(system, leg, [(0.0, first), (0.2, last)], point) for _ in range(1))
    assert ("hardly leads back" in str(found[1])) is refused


@pytest.mark.parametrize("modes", [1, 2])
@pytest.mark.parametrize("apart", [0.0, 0.05])
def test_where_an_eigenvalue_jumps_states_tell_a_corner_from_another_branch(apart, modes):
    """Solves in between that end on two branches have eigenvalues of either sign, and no root; so
    has a corner on one branch. However many modes change: an even number is no excuse for states
    that jump."""
    said = []

    class Halves(System):
        def solve(self, guess, controls, load):
            return replace(self._point(np.array([load[0], apart * (load[0] > 0.3)]), load, 1),
                           position=load[0])

    class Signs:
        def critical(self, point, index):
            return (1.0 if point.load[0] <= 0.3 else -1.0), point

    system = Halves(pitchfork())
    # (beside whose first step this one is short: long ones are refused in any case)
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 2e3, 2e3, 1e-6)
    system.log = said.append
    ends = [(place, replace(system.solve(None, leg.controls, leg.load(place)),
                            unstable_modes=number)) for place, number in ((0.0, 0), (1.0, modes))]
    if apart:
        with pytest.raises(NotConverged, match="and the state with it"):
            between(system, Signs(), leg, *ends)
    else:
        assert between(system, Signs(), leg,
                       *ends) == [] and "an eigenvalue jumps through zero" in said[0]


def test_a_complex_pair_is_one_bifurcation():
    points, _ = followed_steps(flutter(), guess=(0.0, 0.0, 0.0))
    found = [point for point in points if point.event == "bifurcation"]
    assert len(found) == 1 and found[0].load[-1] == pytest.approx(0.3, rel=1e-8)
    assert (abs(found[0].leading_eigenvalue.imag) == pytest.approx(2.0)
            and points[-1].unstable_modes == 2)


def test_stability_may_come_back():
    points, _ = followed_steps(pitchfork(), values=(0.9, 0.1))
    assert events(points) == ["bifurcation"] and points[1].stable == 0 and points[-1].stable == 1


def test_a_resumed_path_goes_on_after_its_bifurcation():
    points, _ = followed_steps(pitchfork())
    place = events(points) and [point.event for point in points].index("bifurcation")
    for last in (place - 1, place, place + 1):
        rest, _ = followed_steps(pitchfork(), resumed=points[max(0, last - 3):last + 1])
        assert [(point.event, point.stable) for point in rest] == [(point.event, point.stable)
                                                                   for point in points[last + 1:]]
        np.testing.assert_allclose([point.load[-1] for point in rest],
                                   [point.load[-1] for point in points[last + 1:]], rtol=1e-8)


def test_what_follows_a_bifurcation_needs_its_search():
    with pytest.raises(InputError,
                       match="-continuation_at_bifurcation is 'follow'.*-continuation_stability"):
        Steps(at_bifurcation="follow")


# Two contact spots


@pytest.fixture(scope="module")
def spots(tmp_path_factory):
    """A function that makes the branch of two equal adhesive spots in a cell, pulled off by the
    mean displacement."""
    points, period = 192, 18.0
    places = (np.arange(points) - points // 2) * period / points
    heights = -1.5 * (1.0 - np.cos(4.0 * np.pi * places / period))
    file = tmp_path_factory.mktemp("spots") / "two.npy"

    def make(path, log=lambda sentence: None, start="normal_displacement=-1.2", bias=0.0, **steps):
        # The spot in the middle is higher by twice the bias.
        np.save(file, heights + bias * np.cos(2.0 * np.pi * places / period))
        scene = Scene(points=points, period=period, normal_maugis=2.0, geometry="file",
                      geometry_file=str(file))
        return Branch(scene, Load(start=start, path=path),
                      Steps(**{"stability": "eigenvalue", **steps}), Form(), log=log)

    return make


def halves_differ(point):
    """Difference between the two spots."""
    field = point.state.displacement[0]
    return np.abs(field - np.roll(field, len(field) // 2)).max()


def test_one_of_two_spots_lets_go_first(spots):
    """Pulled by the mean displacement, which could hold both: the mode takes from one spot what it
    gives the other."""
    made = spots("normal_displacement=-1.75")
    points, _ = followed(made)
    assert events(points) == ["bifurcation"]
    critical = next(point for point in points if point.event == "bifurcation")
    mode = critical.mode.displacement[0]
    assert (np.abs(mode + np.roll(mode, mode.size // 2)).max() < 1e-4 * np.abs(mode).max()
            and halves_differ(critical) < 1e-6)
    for point in points:
        beyond = abs(point.load[0]) > abs(critical.load[0])
        assert point is critical or (point.stable, point.unstable_modes) == ((0, 1) if beyond
                                                                             else (1,
                                                                                   0)), point.event
    # On either side, at 1e-8 of the load, the eigenvalue has the signs that it should have.
    signs = []
    for part in (1.0 - 2e-8, 1.0 + 2e-8):
        near = made.corrector.solve(critical.state, critical.controls, part * critical.load)
        signs.append(np.sign(Stability(made.corrector, "eigenvalue").critical(near, 0)[0]))
    assert signs == [1.0, -1.0]


def test_the_other_spot_is_followed(spots):
    points, error = followed(spots("normal_displacement=-1.75", at_bifurcation="follow"))
    place = [point.event for point in points].index("bifurcation")
    jump = points[place + 1]
    assert (error is None and jump.event == "jump" and jump.load == points[place].load
            and halves_differ(jump) > 1.0)
    assert all(point.stable == 1 for point in points[place + 1:]) and points[-1].position == 1.0
    assert (jump.forces[0] > points[place].forces[0]
            and jump.dissipated_work > points[place].dissipated_work)


def test_the_end_of_a_leg_is_looked_at_for_modes_that_half_a_surface_does_not_show(tmp_path):
    """Two spots, one on either side of the apex: which of them lets go is an odd mode."""
    places, told = 2.0 * np.pi * (np.arange(192) - 96) / 192, []
    np.save(tmp_path / "two.npy", -1.5 * (1.0 + np.cos(2.0 * places)))
    scene = Scene(points=192, period=18.0, normal_maugis=2.0, geometry="file",
                  geometry_file=str(tmp_path / "two.npy"))
    path = "normal_displacement=-1.65; normal_displacement=-1.5"
    made, resumed = (Branch(scene, Load(start="normal_displacement=-1.2", path=path), Steps(),
                            Form(), log=log) for log in (told.append, lambda sentence: None))
    points, error = followed(made)
    *_, lost, _ = ends = [point for point in points if point.position == 1.0 or not point.leg]
    assert error is None and [point.stable for point in ends] == [-1, 0, -1]
    assert lost.unstable_modes == 1
    assert sum("the end of leg 1, at normal_displacement -1.65, is not stable" in sentence
               for sentence in told) == 1
    place = points.index(lost) + 1
    resumed.history = [resumed.restored(resumed.packed(point)) for point in points[:place]]
    rest, _ = followed(resumed)
    assert [point.stable for point in rest] == [point.stable for point in points[place:]]
    assert 0 in [point.stable for point in rest]


@pytest.mark.parametrize("stability, kind", [("off", "natural"), ("sign", "natural"),
                                             ("off", "arclength")])
def test_of_two_spots_that_are_nearly_equal_the_lower_one_lets_go(spots, stability, kind):
    """Where the fold lies before the bifurcation of equal spots goes as the difference to the power
    of 2/3."""
    ahead = []
    for bias in (1e-5, 1e-4):
        made = spots("normal_displacement=-1.75", bias=bias, stability=stability, type=kind)
        points, error = followed(made)
        assert error is None and events(points) == ["fold", "jump"]
        # A jump of few nodes is no work of a grid that has room for its edges: on 768 points it is
        # the same to 1e-8.
        assert all(point.resolved for point in points if point.event != "fold")
        fold, jump = (next(point for point in points if point.event == name)
                      for name in ("fold", "jump"))
        ahead.append(fold.load[0] + 1.598706377)
        gap = made.contact.extended(jump.state)[0] + made.contact.initial_gap
        assert gap[0] > 4.0 > 0.3 > gap[gap.size // 2]
        near = points[[point.event for point in points].index("fold") - 1]
        assert near.stable == (1 if stability == "sign" else -1)
        for point in (near, jump, points[-1]):
            assert Cell(made.contact, point).eigenvalues()[0].real > 0.0
        assert abs(Cell(made.contact, fold).eigenvalues()[0].real) < 1e-4
    assert ahead[1] / ahead[0] == pytest.approx(10.0 ** (2.0 / 3.0), rel=0.05)


@pytest.mark.parametrize("stability", ["off", "sign"])
def test_two_spots_that_let_go_do_not_go_over_their_fold_where_they_were_unstable(tmp_path,
                                                                                  stability):
    """The odd mode of two spots that share a pull, unstable where the path begins, has become
    stable again where the even one lets go: in one step as many modes were unstable at its end,
    which was on another branch (a force of -8.72 in place of -7.25)."""
    places, file = (np.arange(48) - 24) / 48, tmp_path / "two.npy"
    np.save(file, 0.782 * np.cos(4 * np.pi * places) - 4.33e-5 * np.cos(2 * np.pi * places))
    scene = Scene(points=48, period=60.0, normal_maugis=0.929, geometry="file",
                  geometry_file=str(file), poisson=0.5, height=np.inf, residual_friction=0.62,
                  residual_adhesion=0.7, tangential_maugis=0.435)
    ends = []
    for step in (1.43, 0.1):
        points, error = followed(Branch(scene, Load(start="normal_displacement=-1.5",
                                                    path="normal_displacement=-2.86"),
                                        Steps(initial_step=step, largest_step=step,
                                              stability=stability), Form()))
        assert error is None
        ends.append([(point.event, *point.load, *point.forces) for point in points
                     if point.event in ("fold", "jump") or point is points[-1]])
    assert [event for event, *_ in ends[0]] == ["fold", "jump", None]
    for one, other in zip(*ends, strict=True):
        assert one[0] == other[0] and one[1:] == pytest.approx(other[1:], abs=1e-5)


def test_a_flat_layer_parts_in_waves():
    """A uniform gap loses its stability to the cell's longest wave where 1 + C(q) t'(a) = 0, to
    cosine and sine at once."""
    maugis, period = 3.0, 6.0
    scene = Scene(geometry="flat", points=64, period=period, normal_maugis=maugis, height=np.inf)
    compliance = 2.0 * maugis ** 2 / (2.0 * np.pi / period)
    gaps = [brentq(lambda gap, wave=wave: 1.0 + compliance / wave * (1.0 - gap) * np.exp(-gap), 1.0,
                   2.0) for wave in (1, 2)]
    said = []
    points = list(Branch(scene, Load(start="normal_displacement=-0.3",
                                     path="normal_displacement=-0.55"), Steps(stability="sign"),
                         log=said.append))
    found = [point for point in points if point.event == "bifurcation"]
    assert [-maugis * point.load[0] for point in found] == pytest.approx(gaps, rel=1e-8)
    assert [point.unstable_modes for point in found] == [0, 2] and points[-1].unstable_modes == 4
    # The run took its states for even, which sines are not.
    assert any("not even about the apex: going on without symmetry" in sentence
               for sentence in said)


def test_unstable_modes_of_a_traced_branch_are_those_of_dense_matrices(spots):
    """Two modes with eigenvalues down to -2, on the way from two spots to none."""
    made = spots("normal_displacement=-2.4", at_fold="trace")
    points, _ = followed(made)
    assert (max(point.unstable_modes for point in points) >= 1
            and events(points).count("bifurcation") == 2)
    for point in points[::3]:
        if not point.event:
            expected = Cell(made.contact, point).eigenvalues()
            assert point.unstable_modes == np.sum(expected.real < -NEUTRAL)
            assert point.leading_eigenvalue.real == pytest.approx(expected[0].real, abs=4e-4)
