"""Whether the load turns between two points of a branch, on problems whose folds are known."""

import gc
import weakref

import numpy as np
import pytest
from test_continuation import UNIT_LEG, System, cubic, curve, cusp

from contactsnes.continuation.folds import FoldSearch
from contactsnes.continuation.points import Leg, NotConverged
from contactsnes.continuation.turning import TurnSearch, sides, way


def followed(problem, first, last, loads=(-1.0, 1.0)):
    """System, leg, and what the `way` tells of the branch of a problem between the states of one
    unknown at two loads."""
    system = System(problem)
    leg = Leg(1, ("displacement",), *(np.array([load]) for load in loads), 0, 0.1, 0.1, 1e-6)
    ends = [system.solve([guess], leg.controls, leg.load(place)).changed(position=place)
            for place, guess in enumerate((first, last))]
    return system, leg, *way(system, leg, *ends)


def turning(*given):
    """Whether the branch turns there."""
    return followed(*given)[-1]


@pytest.mark.parametrize("loads", [(0.2, 0.5), (-0.5, 0.5), (0.38, 0.39)])
def test_it_does_on_the_way_from_one_side_of_a_cubic_to_the_other(loads):
    assert turning(cubic(), -0.6, 1.2, loads)


@pytest.mark.parametrize("loads", [(-0.5, 0.3), (0.3, 0.384)])
def test_it_does_not_on_one_side_of_a_cubic(loads):
    assert not turning(cubic(), -1.0, -0.6, loads)


@pytest.mark.parametrize("depth", [-0.3, -0.1, -0.03, -0.01])
def test_small_loops_are_seen(depth):
    """Their folds are up to a four-hundredth of the way's loads apart."""
    assert turning(cusp(depth), -1.1, 1.1)


@pytest.mark.parametrize("depth", [0.3, 0.1, 0.03, 0.01])
def test_steep_branches_do_not_turn(depth):
    assert not turning(cusp(depth), -1.0, 1.0)


@pytest.mark.parametrize("low, turned", [(-0.04, True), (0.04, False)])
def test_a_loop_beside_the_middle_is_seen(low, turned):
    """The slope of the load has its least value, at a fifth of the way."""
    def load(u):
        return low * u + (u + 0.6) ** 3 / 3.0

    span = load(np.array([-1.0, 1.0]))
    found = turning(curve(load, lambda u: low + (u + 0.6) ** 2), -1.0, 1.0, span)
    assert found == turned


def test_what_strays_is_not_told_of():
    class Straying(System):
        def solve_arc(self, *given, **settings):
            point = super().solve_arc(*given, **settings)
            return point.changed(state=point.state + 2.0)

    system = Straying(cubic())
    ends = [system.solve([guess], UNIT_LEG.controls, UNIT_LEG.load(place)).changed(position=place)
            for place, guess in ((0.0, -1.0), (0.3, -1.0))]
    with pytest.raises(NotConverged, match="strayed"):
        way(system, UNIT_LEG, *ends)


@pytest.mark.parametrize("depth, loads", [(-1 / 3, (0.2, 0.5)), (-1 / 3, (-0.5, 0.5)),
                                          (-1 / 3, (0.38, 0.39)), (-1 / 3, (0.3, 0.37)),
                                          (-1 / 3, (-0.381, 0.366)), (-0.3, (-1.0, 1.0)),
                                          (-0.1, (-1.0, 1.0)), (-0.03, (-1.0, 1.0))])
def test_both_sides_of_a_fold_are_found_at_one_load(depth, loads):
    """u^3 + 3 depth u turns at u = -+ sqrt(-depth); next to its first fold the load is above that
    at which both sides have the same energy, 0."""
    system, leg, known, turned = followed(cusp(depth), -1.1, 1.1, loads)
    assert turned
    before, behind = sides(system, leg, known)
    load = leg.load(before.position)[0]
    assert behind.position == before.position and 0.0 < load < 2.0 * (-depth) ** 1.5
    for point, side in ((before, -1.0), (behind, 1.0)):
        assert point.state[0] * side > np.sqrt(-depth)
        assert point.state[0] ** 3 + 3 * depth * point.state[0] == pytest.approx(load, abs=1e-8)


def test_the_begin_of_a_way_is_the_side_before_its_fold_where_the_load_falls_below_it():
    """Not far behind the begin."""
    system, leg, known, _ = followed(cubic(), -0.6, 1.2, (0.37, 0.6))
    begin = known[0.0]
    before, behind = sides(system, leg, known)
    assert before is begin and behind.state[0] > 1.0


@pytest.mark.parametrize("depth", [0.01, 0.3])
def test_there_are_no_sides_of_no_fold(depth):
    system, leg, known, _ = followed(cusp(depth), -1.0, 1.0)
    with pytest.raises(NotConverged, match="too small"):
        sides(system, leg, known)


@pytest.mark.parametrize("loads", [(-0.38, 0.31), (-0.35, 0.19), (-0.11, 0.19)])
def test_there_are_no_sides_where_the_way_ends_far_below_its_fold(loads):
    """Its last point lies behind the fold, but under less than any load beside that."""
    system, leg, known, turned = followed(cubic(), -1.1, 1.1, loads)
    assert turned
    with pytest.raises(NotConverged):
        sides(system, leg, known)


def test_a_solve_behind_a_fold_begins_at_a_point_of_the_way_if_another_fails():
    """Those from states that are foretold do here."""
    class Failing(System):
        def solve(self, guess, controls, load):
            if self.picky and abs(guess[0] ** 3 - 0.9 * guess[0] - load[0]) > 1e-2:
                raise NotConverged("from afar")
            return super().solve(guess, controls, load)

    system, leg, known, _ = followed(cusp(-0.3), -1.1, 1.1)
    system.__class__, system.picky = Failing, True
    before, behind = sides(system, leg, known)
    assert behind.position == before.position and behind.state[0] > np.sqrt(0.3)


@pytest.mark.parametrize("kind, more", [(TurnSearch, 0), (FoldSearch, 8)])
def test_a_search_keeps_a_few_states_however_long_it_takes(kind, more):
    """Each is as large as the problem; on the way to the fold of a cubic at -1/sqrt(3), in steps
    that stay short, since solves are hard."""
    states, alive = [], []

    class Counting(System):
        def solve_arc(self, *given, **settings):
            point = super().solve_arc(*given, **settings)
            del self.used[:], self.guesses[:]  # what this system keeps itself
            states.append(weakref.ref(point.state))
            alive.append(sum(state() is not None for state in states))
            return point.changed(spent={**point.spent, "last_iterations": 9})

    system = Counting(cubic())
    leg = Leg(1, ("displacement",), np.array([-1.0]), np.array([1.0]), 0, 0.025, 0.05, 1e-6)
    history = []
    for u in (-0.601, -0.6):
        place = 0.5 * (u ** 3 - u + 1.0)
        point = system.solve(np.array([u]), leg.controls, leg.load(place))
        history.append((place, point.changed(position=place)))
    gc.disable()
    try:
        fold, beyond, _ = kind(system, leg, history).search(NotConverged("a step"))
    finally:
        gc.enable()
    assert fold.state[0] == pytest.approx(-1.0 / np.sqrt(3.0), abs=0.01) and beyond[0] > -0.5774
    assert len(alive) > 2 * kind.behind + more >= max(alive)
