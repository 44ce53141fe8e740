"""Folds that steps bracket, on problems whose folds are known in closed form."""

import numpy as np
import pytest
from test_continuation import (
    CUBIC_FOLD,
    System,
    assert_solutions,
    cubic,
    curve,
    cusp,
    events,
    followed,
    path,
)

from contactsnes.continuation.bracketing import BracketingSteps
from contactsnes.continuation.points import NotConverged, NoWayBack
from contactsnes.continuation.steppers import stepper
from contactsnes.scene.steps import Steps


def bracketed(system, values, guess, **settings):
    """Points of a branch whose folds are bracketed, and what ended it."""
    return followed(path(system, values, guess, stepper=BracketingSteps, **settings))


class Late(System):
    """A system without a way back through any bracket: nothing but motion leads on."""

    def crossed(self, last, beyond, where):
        raise NoWayBack("no branch leads back here")


@pytest.mark.parametrize("size", [1 / 40, 1 / 200])
def test_a_fold_lies_within_its_bracket_and_the_jump_at_its_load(size):
    system = System(cubic())
    points, error = bracketed(system, [-1.875, 2.0], [-1.5], sizes=(size, 2 * size, 1e-6))
    assert error is None and events(points) == ["fold", "jump"]
    assert_solutions(system, points)
    fold, jump = (point for point in points if point.event)
    width = fold.fold_precision * max(abs(fold.load[0]), 1e-3)
    assert fold.load[0] <= CUBIC_FOLD <= fold.load[0] + width
    assert 1e-8 < width <= 3.875 * size
    assert jump.load[0] == fold.load[0] and jump.fold_precision == 0.0
    assert fold.state[0] < -1 / np.sqrt(3) and jump.state[0] > 1 / np.sqrt(3)
    assert points[-1].position == 1.0


def test_shorter_steps_bracket_a_fold_more_closely():
    widths = []
    for size in (1 / 20, 1 / 80, 1 / 320):
        points, _ = bracketed(System(cubic()), [-1.875, 2.0], [-1.5], sizes=(size, size, 1e-6))
        widths.append(next(point.fold_precision for point in points if point.event == "fold"))
    assert widths[0] > widths[1] > widths[2]


def test_a_jump_costs_less_than_by_locating_the_fold():
    spent = []
    for steps in ({"stepper": BracketingSteps}, {}):
        points, error = followed(path(System(cubic()), [-1.875, 2.0], [-1.5], **steps))
        assert error is None and events(points) == ["fold", "jump"]
        spent.append(sum(point.spent["nonlinear_iterations"] for point in points if point.event))
    assert spent[0] < spent[1]


def test_every_jump_of_a_path_there_and_back_is_met():
    points, error = bracketed(System(cubic()), [-1.875, 2.0, -1.5], [-1.5])
    assert error is None and events(points) == ["fold", "jump"] * 2
    loads = [point.load[0] for point in points if point.event == "fold"]
    assert loads[0] == pytest.approx(CUBIC_FOLD, abs=0.1)
    assert loads[1] == pytest.approx(-CUBIC_FOLD, abs=0.1)


@pytest.mark.parametrize("depth", [0.01, 0.001])
def test_steep_branches_have_no_fold(depth):
    """Refused steps alone make none: what motion leads to leads back."""
    system = System(cusp(depth))
    points, error = bracketed(system, [-1.0, 1.0], [-1.0])
    assert error is None and events(points) == []
    assert_solutions(system, points)
    assert len({point.position for point in points}) == len(points)


def test_a_path_may_stop_at_a_fold():
    points, error = bracketed(System(cubic()), [-1.875, 2.0], [-1.5], at_fold="stop")
    assert error is None and events(points) == ["fold"] and points[-1].event == "fold"
    assert points[-1].load[0] <= CUBIC_FOLD


def test_all_that_is_spent_is_told_once():
    system = System(cubic())
    points, _ = bracketed(system, [-1.875, 2.0], [-1.5])
    told = sum(point.spent["nonlinear_iterations"] for point in points)
    count = System(cubic())
    again, spent = [], 0
    count.account = lambda: {"nonlinear_iterations": 0}
    for point in path(count, [-1.875, 2.0], [-1.5], stepper=BracketingSteps):
        again.append(point)
    spent = count.spent
    assert len(again) == len(points) and told == spent


def test_an_interrupted_path_goes_on_as_if_it_had_not_been():
    whole, _ = bracketed(System(cubic()), [-1.875, 2.0], [-1.5])
    number = events_at(whole, "jump")
    for kept in (number + 1, number + 3, len(whole) - 2):
        rest, error = bracketed(System(cubic()), [-1.875, 2.0], [-1.5],
                                resumed=whole[max(0, kept - 4):kept])
        assert error is None and events(rest) == []
        assert rest[-1].state[0] == pytest.approx(whole[-1].state[0], abs=1e-9)


def test_a_path_that_ended_at_a_fold_goes_on_with_its_jump():
    stopped, _ = bracketed(System(cubic()), [-1.875, 2.0], [-1.5], at_fold="stop")
    rest, error = bracketed(System(cubic()), [-1.875, 2.0], [-1.5], resumed=stopped[-4:])
    assert error is None and events(rest) == ["jump"] and rest[-1].position == 1.0
    assert rest[0].load[0] == stopped[-1].load[0]


def test_no_path_ends_where_no_branch_leads_back():
    """Neither bracket nor location: motion goes on further, and the log says so."""
    system = Late(cubic(), arc_fails=lambda load: load > 0.3)
    points, error = bracketed(system, [-1.875, 2.0], [-1.5])
    assert error is None and events(points) == ["fold", "jump"]
    assert_solutions(system, points)
    fold, jump = (point for point in points if point.event)
    assert fold.load[0] <= CUBIC_FOLD < jump.load[0]
    assert jump.load[0] <= fold.load[0] + fold.fold_precision * abs(fold.load[0]) + 1e-12
    assert any("the path goes on" in sentence for sentence in system.sentences)


def test_where_motion_ends_nowhere_the_reason_is_told_and_the_points_stay():
    class Restless(Late):
        def settle(self, *_):
            raise NotConverged("a spot at x = 3 does not settle")

    points, error = bracketed(Restless(cubic(), arc_fails=lambda load: load > 0.3), [-1.875, 2.0],
                              [-1.5])
    assert points and "a spot at x = 3" in str(error)


def test_where_a_branch_ends_its_fold_is_located():
    """Beyond it the body leaves, so that no bracket has another side."""
    system = System(curve(lambda u: -u ** 2, lambda u: -2 * u))
    points, error = bracketed(system, [-1.0, 0.5], [-1.0])
    assert error is not None and events(points) == ["fold"]
    assert points[-1].load[0] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("asked, resolved, kind", [
    (None, True, "NaturalSteps"), (None, False, "BracketingSteps"),
    (True, False, "NaturalSteps"), (False, True, "BracketingSteps")])
def test_folds_are_located_where_that_is_asked_for_or_the_default(asked, resolved, kind):
    assert stepper(Steps(locate_folds=asked), resolved).__name__ == kind


def events_at(points, name):
    """Number of the first point with an event."""
    return next(number for number, point in enumerate(points) if point.event == name)
