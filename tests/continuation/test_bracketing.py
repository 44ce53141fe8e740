"""Folds that steps bracket, on problems whose folds are known in closed form."""

import weakref
from dataclasses import replace

import numpy as np
import pytest
from test_continuation import (
    CUBIC_FOLD,
    UNIT_LEG,
    Landing,
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
from contactsnes.continuation.natural import NaturalSteps
from contactsnes.continuation.points import Crossing, NotConverged, NoWayBack
from contactsnes.continuation.predictors import PREDICTORS
from contactsnes.continuation.steppers import stepper
from contactsnes.scene.steps import Steps


def bracketed(system, values, guess, **settings):
    """Points of a branch whose folds are bracketed, and what ended it."""
    return followed(path(system, values, guess, stepper=BracketingSteps, **settings))


class Late(System):
    """A system without a way back through any bracket: nothing but motion leads on."""

    def crossed(self, last, beyond, where):
        raise NoWayBack("no branch leads back here")


class Narrow(System):
    """A system that tells of a part of each bracket: what lies there, and beyond it."""

    def crossed(self, last, beyond, where):
        begin, end = last.load, np.asarray(beyond)
        parts = [0.0, 1.0]
        point = last
        for step in (0.5, 0.25, 0.125):
            here = begin + (parts[0] + step) * (end - begin)
            try:
                tried = self.solve(point.state, last.controls, here)
            except NotConverged:
                tried = None
            if tried is None or self.missed(point.state, tried.state) > 0.5:
                parts[1] = parts[0] + step
            else:
                parts[0], point = parts[0] + step, tried
        ahead = self.settle(point.state, last.controls, begin + parts[1] * (end - begin), where)
        behind = self.solve(ahead.state, last.controls, point.load)
        same = self.missed(point.state, behind.state) < 1e-3
        return Crossing(*parts, point, None if same else behind, ahead.state)


@pytest.mark.parametrize("at_fold", ["jump", "stop"])
def test_a_fold_lies_in_the_narrower_bracket_that_is_found(at_fold):
    """It is told once, with all that was spent, and known better than to the refused step."""
    found = {}
    for kind in (System, Narrow):
        system = kind(cubic())
        points, error = bracketed(system, [-1.875, 2.0], [-1.5], at_fold=at_fold)
        assert error is None and events(points) == ["fold", "jump"][:1 + (at_fold == "jump")]
        assert_solutions(system, points)
        assert len({(point.position, point.event) for point in points}) == len(points)
        found[kind] = next(point for point in points if point.event == "fold")
        spent = kind(cubic())
        spent.account = lambda: {"nonlinear_iterations": 0}
        list(path(spent, [-1.875, 2.0], [-1.5], stepper=BracketingSteps, at_fold=at_fold))
        assert spent.spent == sum(point.spent["nonlinear_iterations"] for point in points)
    width = {kind: fold.fold_precision * abs(fold.load[0]) for kind, fold in found.items()}
    assert width[Narrow] < 0.5 * width[System]
    fold = found[Narrow]
    assert fold.load[0] <= CUBIC_FOLD <= fold.load[0] + width[Narrow]


@pytest.mark.parametrize("depth", [0.01, 0.001])
def test_steep_branches_have_no_fold_in_narrower_brackets(depth):
    system = Narrow(cusp(depth), most=3)
    points, error = bracketed(system, [-1.0, 1.0], [-1.0])
    assert error is None and events(points) == []
    assert_solutions(system, points)
    places = [point.position for point in points]
    assert places == sorted(set(places)) and places[-1] == 1.0


@pytest.mark.parametrize("size", [1 / 40, 1 / 200])
def test_where_no_branch_leads_back_the_load_turns_along_the_arc(size):
    """The fold is known to what is told."""
    system = Late(cubic())
    points, error = bracketed(system, [-1.875, 2.0], [-1.5], sizes=(size, 2 * size, 1e-6))
    assert error is None and events(points) == ["fold", "jump"]
    assert_solutions(system, points)
    fold, jump = (point for point in points if point.event)
    width = fold.fold_precision * abs(fold.load[0])
    assert 1e-8 < width < 0.02 and fold.load[0] <= CUBIC_FOLD + 1e-12
    assert CUBIC_FOLD <= fold.load[0] + 1.5 * width
    assert jump.load[0] == fold.load[0] and jump.state[0] > 1 / np.sqrt(3)


@pytest.mark.parametrize("depth", [0.01, 0.001])
def test_steep_branches_are_passed_where_no_branch_leads_back(depth):
    system = Late(cusp(depth), most=3)
    points, error = bracketed(system, [-1.0, 1.0], [-1.0])
    assert error is None and events(points) == []
    assert_solutions(system, points)
    assert any("by arc length" in sentence for sentence in system.sentences)


def test_points_that_but_foretell_others_are_kept_in_less_memory():
    """Those before the last one: who is handed a point has it as it was found."""
    class Rounding(System):
        def lighter(self, points):
            return [*(replace(point, state=point.state.astype(np.float32).astype(float))
                      for point in points[:-1]), points[-1]]

    exact, rounding = (bracketed(kind(cubic()), [-1.875, 2.0], [-1.5])[0]
                       for kind in (System, Rounding))
    assert events(rounding) == events(exact) and len(rounding) == len(exact) > 8
    for one, other in zip(exact, rounding):
        np.testing.assert_allclose(one.state, other.state, rtol=0, atol=1e-6)
    steps = BracketingSteps(Rounding(cubic()), UNIT_LEG, [(0.0, exact[0])], PREDICTORS["none"],
                            "jump")
    for point in exact[1:6]:
        steps._accept(point)
    assert [point.position for _, point in steps.history] == [p.position for p in exact[2:6]]
    assert all((point.state == point.state.astype(np.float32)).all()
               for _, point in steps.history[:-1])
    assert steps.history[-1][1].state is exact[5].state


@pytest.mark.parametrize("step", [True, False])
def test_a_step_onto_an_unstable_part_is_refused(step):
    """Linear solves tell of it, and modes of everything are not asked for."""
    class Watched(System):
        examiner = staticmethod(lambda point: pytest.fail("all modes were looked for"))

        def solve(self, guess, controls, load):
            point = super().solve(guess, controls, load)
            return replace(point, softest=3 * point.state[0] ** 2 - 1)

    steps = BracketingSteps(Watched(cubic()), UNIT_LEG, [(0.0, replace(
        System(cubic()).solve([-1.2], ("displacement",), [0.0]), softest=1.0, position=0.0))],
        PREDICTORS["none"], "jump")
    point = replace(steps.system.solve([0.1 if step else -1.2], ("displacement",), [0.05]),
                    position=0.05)
    steps._step = lambda *_: point
    if step:
        with pytest.raises(NotConverged, match="lost its stability"):
            steps._tried(0.05, PREDICTORS["none"])
    else:
        assert steps._tried(0.05, PREDICTORS["none"])[0].position == 0.05


@pytest.mark.parametrize("kind, name, foretold", [
    (NaturalSteps, "edge", 0.6), (BracketingSteps, "edge", 0.9), (BracketingSteps, "tangent", 0.6),
    (BracketingSteps, "secant", 0.9)])
def test_brackets_take_the_secant_where_points_mislead(kind, name, foretold):
    """The last of three states moved on farther than foretold: u = load gives the tangent 1; what
    a user asks for stays that."""
    class Spotted(Landing):
        def follow_edge(self, points, weights):
            return None

    system = Spotted([0.0])
    steps = kind(system, UNIT_LEG, system.points([0.0], [0.1], [0.5]), PREDICTORS[name], "jump")
    assert steps._foreseen(0.3, steps.predictor)[2] == pytest.approx(foretold)
    # and of a step that is tried again
    system = Spotted([0.0])
    steps = kind(system, UNIT_LEG, system.points([0.0], [0.2]), PREDICTORS[name], "jump")
    again = 0.3 if name == "tangent" or kind is NaturalSteps else 0.4
    assert steps._foreseen(0.2, steps._again())[2] == pytest.approx(again)


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


@pytest.mark.parametrize("kind", [NoWayBack, NotConverged])
def test_no_search_holds_what_motion_has_left(kind):
    """States and forms of the frames that a failure came from are given back before it begins."""
    class Held:
        pass

    class Searched(System):
        def crossed(self, last, beyond, where):
            held = Held()
            alive.append(weakref.ref(held))
            try:
                raise RuntimeError("within")
            except RuntimeError:
                raise kind("nothing is told here")

        def solve_arc(self, *given, **named):
            asked.append(any(one() is not None for one in alive))
            return super().solve_arc(*given, **named)

    alive, asked = [], []
    points, error = bracketed(Searched(cubic()), [-1.875, 2.0], [-1.5])
    assert error is None and "jump" in events(points)
    assert alive and asked and not any(asked)


def test_a_path_may_stop_at_a_fold():
    points, error = bracketed(System(cubic()), [-1.875, 2.0], [-1.5], at_fold="stop")
    assert error is None and events(points) == ["fold"] and points[-1].event == "fold"
    assert points[-1].load[0] <= CUBIC_FOLD


@pytest.mark.parametrize("kind", [System, Narrow, Late])
def test_all_that_is_spent_is_told_once(kind):
    system = kind(cubic())
    points, _ = bracketed(system, [-1.875, 2.0], [-1.5])
    told = sum(point.spent["nonlinear_iterations"] for point in points)
    count = kind(cubic())
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


@pytest.mark.parametrize("kind", [System, Narrow, Late])
@pytest.mark.parametrize("at_fold", ["jump", "stop"])
def test_a_path_goes_on_before_a_fold_from_points_of_a_file(kind, at_fold):
    """Of these nothing is known of what they took."""
    whole, _ = bracketed(kind(cubic()), [-1.875, 2.0], [-1.5], at_fold=at_fold)
    number = events_at(whole, "fold")
    kept = [replace(point, spent={}) for point in whole[max(0, number - 4):number]]
    rest, error = bracketed(kind(cubic()), [-1.875, 2.0], [-1.5], resumed=kept, at_fold=at_fold)
    assert error is None and events(rest) == events(whole)
    assert rest[-1].state[0] == pytest.approx(whole[-1].state[0], abs=1e-9)
    assert all(point.spent["nonlinear_iterations"] >= 0 for point in rest)


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


def test_shorter_steps_go_on_where_neither_fold_nor_motion_is_found():
    """As where a solver fails on some steps, and nothing comes to rest."""
    class Tired(Late):
        tried = 0

        def settle(self, *_):
            self.tried += 1
            raise NotConverged("a spot at x = 3 does not settle")

    def fails(load):
        return load > 0.2 and not system.tried

    system = Tired(curve(lambda u: u, np.ones_like), fails=fails, arc_fails=fails)
    points, error = bracketed(system, [0.0, 1.0], [0.0])
    assert error is None and events(points) == [] and points[-1].load[0] == 1.0
    assert system.tried and any("shorter steps" in said for said in system.sentences)


def test_a_path_that_is_to_stop_at_folds_stops_where_only_motion_leads_on():
    system = Late(cubic(), arc_fails=lambda load: load > 0.3)
    points, error = bracketed(system, [-1.875, 2.0], [-1.5], at_fold="stop")
    assert error is None and events(points) == ["fold"] and points[-1].event == "fold"
    assert points[-1].load[0] <= CUBIC_FOLD < points[-1].load[0] + 0.2
    assert any("the path stops" in said for said in system.sentences)


@pytest.mark.parametrize("until", (0.5, 0.9, 1.99))
def test_a_path_goes_on_where_motion_comes_to_rest_again(until):
    """Beyond the fold, which is located, a body has but a cycle to go round in."""
    class Round(System):
        def settle(self, state, controls, load, where, *origin):
            if CUBIC_FOLD - 0.1 < load[0] < until:
                raise NotConverged("it goes round and round")
            return super().settle(state, controls, load, where, *origin)

        def crossed(self, last, beyond, where):
            raise NotConverged("it goes round and round")

    system = Round(cubic())
    points, error = bracketed(system, [-1.875, 2.0], [-1.5])
    assert error is None and events(points) == ["fold", "jump"] and points[-1].load[0] == 2.0
    assert_solutions(system, points)
    fold, jump = (point for point in points if point.event)
    assert fold.load[0] == pytest.approx(CUBIC_FOLD, rel=1e-6) and until <= jump.load[0]
    assert any("goes round and round: the path goes on" in said for said in system.sentences)


def test_motion_far_ahead_is_the_last_resort():
    """While steps may be shorter, what lies a fortieth of the leg ahead is all that is asked."""
    class Restless(Late):
        asked = []

        def settle(self, state, controls, load, where, *_):
            self.asked.append((load[0], len(self.attempts)))
            raise NotConverged("a spot does not settle")

    system = Restless(cubic(), arc_fails=lambda load: load > 0.3)
    points, error = bracketed(system, [-1.875, 2.0], [-1.5])
    assert "a spot does not settle" in str(error)
    far = points[-1].load[0] + 0.03 * 3.875
    assert {count for load, count in system.asked if load > far} == {len(system.attempts)}
    assert len({count for _, count in system.asked}) > 1


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


@pytest.mark.parametrize("aside, grows", [(0.1, True), (0.35, True), (0.5, False)])
def test_steps_use_a_part_of_the_room_that_nodes_have(aside, grows):
    """Those that lead near to what would be refused get shorter, by the square root of what they
    use of 0.35 and 0.15 of the way."""
    system = Landing([2.0 + aside])
    given = system, UNIT_LEG, system.points([0.0], [1.0]), PREDICTORS["secant"], "jump"
    steps = BracketingSteps(*given)
    point = steps._step(0.2, PREDICTORS["secant"]).changed(spent={"last_iterations": 2})
    used = 1.0 + (aside - 0.35 - 0.15 * (1.0 + aside)) / 0.35
    least = min(1.0 + 0.75 ** 2, np.sqrt(0.6 / used) if used > 0.0 else np.inf)
    assert steps._next(0.01, point) == pytest.approx(0.01 * least)
    assert (least > 1.0) == grows
    assert NaturalSteps(*given)._next(0.01, point) == pytest.approx(0.01 * (1.0 + 0.75 ** 2))
