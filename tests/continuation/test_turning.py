"""Whether the load turns between two points of a branch, on problems whose folds are known."""

import numpy as np
import pytest
from test_continuation import UNIT_LEG, System, cubic, curve, cusp

from contactsnes.continuation.points import Leg, NotConverged
from contactsnes.continuation.turning import turns


def turning(problem, first, last, loads=(-1.0, 1.0), **settings):
    """Whether the branch of a problem turns between the states of one unknown at two loads."""
    system = System(problem, **settings)
    leg = Leg(1, ("displacement",), *(np.array([load]) for load in loads), 0, 0.1, 0.1, 1e-6)
    ends = [system.solve([guess], leg.controls, leg.load(place)).changed(position=place)
            for place, guess in enumerate((first, last))]
    return turns(system, leg, *ends)


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
        turns(system, UNIT_LEG, *ends)
