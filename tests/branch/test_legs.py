"""Legs of a load path: what controls each component follows from the path, also where a leg moves
nothing."""

from dataclasses import replace
from operator import attrgetter
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes.branch import first_points  # noqa: E402
from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.tracing import Tracer  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.energies import weights  # noqa: E402
from contactsnes.contact.interface_work import straight  # noqa: E402
from contactsnes.continuation.points import Leg, NoEquilibrium, NotConverged  # noqa: E402
from contactsnes.scene.load import Load, controls_along  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402

LINE = Scene(points=128, normal_maugis=1.5, period=30.0, height=50.0, residual_friction=0.5)
PLANE = Scene(dimension=2, geometry="sphere", points=32, normal_maugis=0.5, tangential_maugis=0.3,
              period=20.0, height=30.0)
ALONE = Scene(period=float("inf"), spacing=0.3, normal_maugis=1.0, tangential_maugis=0.5)
LARGE = Steps(initial_step=1.5, largest_step=2.0)
DISPLACED, FORCED = "displacement", "force"


def followed(path, scene=LINE, steps=LARGE, start=None, history=(), log=lambda sentence: None):
    """Branch of a path, and its points."""
    branch = Branch(scene, Load(start=start, path=path), steps, history=history, log=log)
    return branch, list(branch)


def held(point):
    """What a point's controls hold, read off its displacements and forces."""
    return [(point.forces if control == FORCED else point.displacements)[i]
            for i, control in enumerate(point.controls)]


def test_controls_follow_from_the_path():
    load = Load(path="normal_force=1; tangential_force=hold, normal_displacement=hold; "
                "tangential_force=2; normal_force=hold")
    kinds = controls_along(load.initial(1), load.legs(1))
    assert kinds == [(DISPLACED, DISPLACED), (FORCED, DISPLACED), (DISPLACED, FORCED),
                     (DISPLACED, FORCED), (FORCED, FORCED)]


# A path with legs that move nothing, and the same one without them: the second switches while it
# moves; start, scene and step.
PAIRS = {"force": ("normal_displacement=2; normal_force=hold; tangential_displacement=4",
                   "normal_displacement=2; normal_force=hold, tangential_displacement=4",
                   None, LINE, 1.5), "displacement": ("normal_force=1; "
                                                      "normal_displacement=hold; "
                                                      "tangential_displacement=4",
                                                      "normal_force=1; "
                                                      "normal_displacement=hold, "
                                                      "tangential_displacement=4", None, LINE, 1.5),
         "tangential force": ("tangential_displacement=2; tangential_force=hold; "
                              "normal_displacement=3", "tangential_displacement=2; "
                              "tangential_force=hold, normal_displacement=3", None, LINE, 1.5),
         "first leg": ("normal_force=hold; tangential_displacement=4", "normal_force=hold, "
                       "tangential_displacement=4", "normal_displacement=2", LINE, 1.5),
         "several": ("normal_force=hold; normal_displacement=hold; normal_force=hold, "
                     "tangential_force=hold; tangential_force=0.5", "normal_force=hold, "
                     "tangential_force=0.5", "normal_displacement=2", LINE, 0.2),
         "where it is": ("normal_displacement=2; normal_force=hold; normal_displacement=2; "
                         "tangential_displacement=4", "tangential_displacement=4",
                         "normal_displacement=2", LINE, 1.5),
         "plane": ("normal_force=hold; tangential_force_y=hold; tangential_displacement_x=2",
                   "normal_force=hold, tangential_force_y=hold, tangential_displacement_x=2",
                   "normal_displacement=3", PLANE, 0.8),
         "alone": ("normal_force=hold; normal_force=2, tangential_force=0; "
                   "tangential_force=0.2", "tangential_force=0.2", "normal_force=2", ALONE, 0.08),}


@pytest.mark.parametrize("kind", ["natural", "arclength"])
@pytest.mark.parametrize("case", PAIRS)
def test_legs_that_move_nothing_switch_the_control(case, kind):
    idle, direct, start, scene, step = PAIRS[case]
    steps = Steps(initial_step=step, largest_step=1.5 * step, type=kind)
    (branch, points) = followed(idle, scene, steps, start)
    (_, expected) = followed(direct, scene, steps, start)
    moved = [point for point in points if point.leg == len(branch.legs)]
    assert len(points) == len(expected) and len(moved) > 1
    kinds = controls_along(branch.load.initial(scene.dimension, scene.isolated), branch.legs)
    for point, other in zip(points, expected):
        np.testing.assert_allclose(point.displacements, other.displacements, atol=1e-7)
        np.testing.assert_allclose(point.forces, other.forces, atol=1e-7)
        if point.leg:
            assert point.controls == kinds[point.leg][:len(point.controls)]
    still = [i for i in range(len(moved[0].load)) if i not in branch.legs[-1].controls]
    for point in moved:
        assert held(point) == list(point.load) and [point.load[i]
                                                    for i in still] == [moved[0].load[i]
                                                                        for i in still]
    # What was held before moves now.
    free = {"force": "displacements", "displacement": "forces",
            "tangential force": "displacements"}.get(case)
    if free:
        component = int(case.startswith("tangential"))
        assert np.ptp([getattr(point, free)[component] for point in moved]) > 1e-4


def test_ends_of_legs_are_exact():
    path = ("normal_displacement=1.1; normal_force=hold; tangential_displacement=0.7; "
            "tangential_force=hold; normal_force=1.3")
    _, points = followed(path)
    ends = {point.leg: point for point in points if point.position == 1.0}
    assert ends.keys() == {1, 3, 5}
    assert (ends[1].displacements[0] == 1.1 and ends[3].displacements[1] == 0.7
            and ends[5].forces[0] == 1.3)
    assert ends[3].forces[0] == ends[1].forces[0] and ends[5].forces[1] == ends[3].forces[1]


@pytest.mark.parametrize("symmetry", ("auto", "off"))
@pytest.mark.parametrize("array", ("load", "displacements", "forces", "origin", "state.means",
                                   "state.displacement", "state.once"))
def test_points_cannot_be_written_into(array, symmetry):
    """What a script converts to its units in place would be what the path goes on from."""
    branch = Branch(Scene(points=128, period=20.0, normal_maugis=1.0),
                    Load(path="normal_displacement=0.5"), form=Form(symmetry=symmetry))
    *_, point = branch
    with pytest.raises(ValueError, match="read-only"):
        attrgetter(array)(point)[...] *= 2.0
    assert branch.observe(point)["normal_displacement"] == 0.5


def test_the_first_point_is_under_the_controls_that_were_asked_for():
    (first,) = followed("normal_displacement=2",
                        start="normal_displacement=2, tangential_force=0")[1]
    assert first.controls == (DISPLACED, FORCED) and first.forces[1] == 0.0
    *_, last = followed("normal_displacement=2.5",
                        start="normal_displacement=2, tangential_force=0")[1]
    assert last.controls == (DISPLACED, FORCED) and last.forces[1] == 0.0


@pytest.mark.parametrize("at_fold", ["jump", "trace"])
def test_an_interrupted_path_keeps_the_switch(at_fold):
    """Interrupted after every point, also right before and after legs that move nothing."""
    path = ("normal_displacement=1; normal_force=hold; tangential_displacement=4; "
            "tangential_force=hold; normal_force=1")
    steps = Steps(initial_step=2.0, largest_step=2.0, at_fold=at_fold)
    branch, points = followed(path, steps=steps)
    assert {point.leg for point in points} == {0, 1, 3, 5}
    for done in range(1, len(points)):
        history = [branch.restored(branch.packed(point)) for point in points[max(0, done - 4):done]]
        _, rest = followed(path, steps=steps, history=history)
        assert [point.controls for point in rest] == [point.controls for point in points[done:]]
        assert rest[-1].load == pytest.approx(points[-1].load, abs=1e-12)
        assert rest[-1].displacements == pytest.approx(points[-1].displacements, abs=1e-6)


def test_marks_of_an_unstable_part_end_where_they_did():
    """Interrupted there, too: a fold behind it is not looked at by anyone."""
    path = dict(path="normal_force=1", start="normal_displacement=-3",
                steps=Steps(locate_folds=False),
                scene=Scene(points=128, normal_maugis=2.0, period=20.0))
    branch, points = followed(**path)
    marks = [point.stable for point in points]
    fold = [point.event for point in points].index("fold")
    assert 0 in marks[:fold] and marks[fold] == -1
    for done in range(1, fold + 2):
        history = [branch.restored(branch.packed(point)) for point in points[max(0, done - 4):done]]
        _, rest = followed(**path, history=history)
        assert [point.stable for point in rest][:2] == marks[done:done + 2], done


@pytest.mark.parametrize("softest, modes, told", [(-1e-3, 2, True), (-1e-3, 0, False),
                                                  (1e-3, 2, False), (np.nan, 2, False)])
def test_a_first_point_that_is_not_stable_is_told_of(softest, modes, told, monkeypatch):
    """Its linear solves say where to look; the modes themselves decide."""
    sentences = []
    branch = Branch(Scene(points=128, normal_maugis=1.0, period=20.0),
                    Load(path="normal_displacement=0.1"), log=sentences.append)
    start = first_points.start
    monkeypatch.setattr(first_points, "start",
                        lambda *load: replace(start(*load), softest=softest))
    monkeypatch.setattr(branch.corrector, "examiner",
                        lambda point: replace(point, stable=int(not modes), unstable_modes=modes))
    assert next(iter(branch)).stable == (0 if told else -1)
    assert any("the first point, at normal_displacement 0, is not stable: 2 modes" in sentence
               for sentence in sentences) is told


def test_a_switch_of_controls_is_looked_at_on_grids_that_pin_too():
    scene = Scene(points=64, normal_maugis=6.0, period=40.0, tangential="on")
    points = followed("normal_force=hold, tangential_displacement=1", scene,
                      start="normal_displacement=4")[1]
    assert points[-1].controls[0] == "force" and points[-1].load[1] == 1.0


def test_what_was_stable_under_other_controls_is_checked_anew():
    """Beyond the smallest force, -1.62 at -2.3, a displacement holds what a force does not."""
    path = "normal_displacement=-2.5; normal_force=hold; normal_force=-1.5"
    scene = Scene(points=256, normal_maugis=2.0, period=30.0)
    found, told = {}, []
    for stability in ("sign", "off"):
        steps = Steps(initial_step=0.1, largest_step=0.4, stability=stability)
        points = followed(path, scene, steps, "normal_displacement=-2", log=told.append)[1]
        found[stability] = [(point.leg, point.stable) for point in points if not point.event]
    assert {stable for leg, stable in found["sign"] if leg < 3} == {1}
    assert {stable for leg, stable in found["sign"] if leg == 3} == {stable
                                                                     for leg, stable in found["off"]
                                                                     if leg == 3} == {0}
    assert {stable for leg, stable in found["off"] if leg < 3} == {-1}
    assert len([sentence for sentence in told
                if "leg 3 begins on an unstable part of the branch" in sentence]) == 1
    told.clear()
    # Also where what moves is not what was let go, or not alone.
    steps = Steps(initial_step=(0.1, 1.0, 0.2), largest_step=(0.4, 1.0, 0.2))
    for aside in ("tangential_displacement=0.2", "normal_force=-1.6, tangential_force=0.1",
                  "tangential_force=0.1"):
        followed(path.replace("normal_force=-1.5", aside), scene, steps, "normal_displacement=-2",
                 log=told.append)
        assert len([sentence for sentence in told
                    if "leg 3 begins on an unstable part of the branch" in sentence]) == 1
        told.clear()
    for end in ("normal_force=3", "tangential_displacement=1"):
        points = followed(f"normal_displacement=2; normal_force=hold; {end}", log=told.append)[1]
        assert {point.stable for point in points} == {-1}
    assert not any("unstable" in sentence for sentence in told)


def test_a_failure_after_a_switch_is_explained_under_the_new_controls(monkeypatch):
    """Where no step is found under the force, the last point is called unstable: its certificate
    was that of a displacement."""
    solve, scene = Tracer.solve, Scene(points=256, normal_maugis=2.0, period=30.0)

    def fails(*_, **__):
        raise NotConverged("no")

    def solved(self, guess, controls, *rest):
        return fails() if controls[0] == FORCED else solve(self, guess, controls, *rest)

    monkeypatch.setattr(Tracer, "solve", solved)
    for name in ("solve_arc", "settle"):
        monkeypatch.setattr(Tracer, name, fails)
    load = Load(start="normal_displacement=-2",
                path="normal_displacement=-2.5; normal_force=hold; normal_force=-1.5")
    with pytest.raises(NotConverged, match=r"the last point is unstable \(1 modes"):
        list(Branch(scene, load, Steps(initial_step=0.1, largest_step=0.4)))


@pytest.mark.parametrize("friction", (0.3, 1.0))
def test_a_gliding_body_whose_force_is_taken_back_is_held_again(friction):
    """Its residual friction balances no smaller force, wherever it is: it goes back to where
    friction still grows with slip, as motion does that begins in the glide under a smaller
    force."""
    scene = Scene(points=256, period=40.0, height=50.0, normal_maugis=1.5, tangential_maugis=1.0,
                  residual_friction=friction)
    path = "normal_force=3; tangential_displacement=60; tangential_force="
    points = list(Branch(scene, Load(path=path + "0")))
    fold, jump = (point for point in points if point.leg == 3 and point.event)
    assert (fold.event, fold.fold_kind, jump.event) == ("fold", "sliding", "jump")
    assert jump.forces[1] == fold.forces[1] > 0.0
    assert jump.displacements[1] < fold.displacements[1]
    # friction that nowhere falls with the slip gives back what was done on it
    lost, given = jump.dissipated_work - fold.dissipated_work, jump.forces[1] * (
        fold.displacements[1] - jump.displacements[1])
    assert lost > 0.05 if friction < 1.0 else abs(lost) < 1e-3 * given
    assert abs(points[-1].displacements[1]) < 1e-6 and points[-1].forces[1] == 0.0
    less = 0.95 * fold.forces[1]
    branch = Branch(scene, Load(path=path + str(less)))
    *_, last = branch
    moved = branch.corrector.settle(fold.state, last.controls, last.load, "there")
    assert states.missed(branch.contact, moved.state, last.state) < 1e-6


def test_a_gliding_body_that_is_pressed_on_is_held_by_what_glided():
    scene = Scene(points=256, period=40.0, height=50.0, normal_maugis=1.5, tangential_maugis=1.0,
                  residual_friction=0.5)
    points = list(Branch(scene, Load(path="normal_force=3; tangential_displacement=60; "
                                          "normal_force=4, tangential_force=hold")))
    fold, jump = (point for point in points if point.leg == 3 and point.event)
    assert (fold.event, fold.fold_kind, jump.event) == ("fold", "sliding", "jump")
    assert points[-1].forces[0] == 4.0 and points[-1].forces[1] == fold.forces[1]
    assert points[-1].displacements[1] < 0.5 * fold.displacements[1]


def test_a_jump_that_ends_in_a_glide_is_no_fold_again():
    branch, points = followed("normal_force=3; tangential_displacement=60")
    forces, controls = np.array(points[-1].forces), (FORCED, FORCED)
    glide = branch.corrector.adapted(points[-1], controls, forces)
    leg = Leg(3, controls, forces, forces * [1.0, 0.5], 1, 0.1, 0.1, 1e-6)
    ends = branch.corrector.end_of_attraction
    assert ends(glide, leg, 0.0).fold_kind == "sliding"
    assert ends(glide.changed(event="jump"), leg, 0.0) is not None
    assert ends(glide.changed(event="jump", leg=3), leg, 0.0) is None


def test_a_body_at_the_peak_of_its_friction_does_not_glide():
    """Friction has no slope there, but softens further on: a jump that began in the peak itself
    would end where it began."""
    scene = Scene(geometry="flat", points=16, period=8.0, height=float("inf"), normal_maugis=1.0,
                  tangential_maugis=1.0, law="mcgarry")
    branch, points = followed("normal_displacement=0.5; tangential_displacement=0.1", scene)
    window, moved = points[-1].state.window, points[-1].state.displacement.copy()
    moved[1] = np.nextafter(branch.contact.law.slip_peak, 1.0)
    peak = points[-1].changed(state=states.State(window, moved, moved.mean(axis=1)),
                              controls=(DISPLACED, FORCED))
    assert branch.corrector.within_range(peak) is None


@pytest.mark.parametrize("lift", ["normal_displacement=-0.5", "normal_displacement=-2.5",
                                  "normal_displacement=-45",
                                  "normal_displacement=-1; normal_force=hold"])
def test_a_body_that_nothing_holds_is_pressed_on_again(lift):
    """Lifted after slip has taken the adhesion, in contact or far off, no force moves it until it
    touches: a force that presses finds it there, and leads where it does without a lift."""
    scene = Scene(points=128, period=16.0, normal_maugis=1.0, tangential_maugis=0.5,
                  height=float("inf"), residual_friction=0.5)
    slid, steps = "tangential_displacement=30", Steps(initial_step=1.0, largest_step=30.0)
    _, plain = followed(f"{slid}; normal_force=1", scene, steps, "normal_displacement=1")
    branch, points = followed(f"{slid}; {lift}; normal_force=1", scene, steps,
                              "normal_displacement=1")
    np.testing.assert_allclose(points[-1].forces, plain[-1].forces, rtol=1e-6)
    np.testing.assert_allclose(points[-1].state.means, plain[-1].state.means, rtol=1e-6)
    fold, jump = (point for point in points if point.event in ("fold", "jump"))
    assert fold.fold_kind == "jump_in" and abs(jump.forces[0]) < 2e-8
    assert abs(branch.observe(jump)["minimum_gap"]) < 1e-6


BORNE = [({}, "normal_force=0", ["to"]), ({"residual_friction": 0.0}, "normal_force=0", ["to"]),
         ({}, "normal_force=0; tangential_force=0", ["to", "along"]),
         ({"residual_adhesion": 0.3}, "normal_force=0", []), ({}, "normal_force=1", [])]


@pytest.mark.parametrize("changes, path, told, stability", [
    *((*case, "sign") for case in BORNE), (*BORNE[2], "off"), (*BORNE[4], "off"),
    *(pytest.param(*BORNE[other], "off", marks=pytest.mark.study) for other in (0, 1, 3))])
def test_a_body_that_nothing_holds_is_told(changes, path, told, stability):
    """After sliding nothing is left of the adhesion: lifted under no force, the body stays where it
    is put; and under what its friction has left it glides. Certificates see the side on which the
    flat bears it."""
    scene = replace(LINE, points=256, period=40.0, height=5.0, normal_maugis=2.0, **changes)
    said, steps = [], Steps(stability=stability)
    _, points = followed(f"normal_force=2; tangential_displacement=60; {path}", scene, steps,
                         "normal_displacement=0.5", log=said.append)
    found = [sentence for sentence in said if "nothing holds the body" in sentence]
    assert len(found) == len(told)
    assert all(f"holds the body {way} the flat" in text for way, text in zip(told, found))
    last = [point for point in points if point.leg == 3][-1]
    assert last.stable == (0 if told else 1 if stability == "sign" else -1)
    assert all(point.stable != 0 for point in points if point.leg < 3 and point.event != "fold")


@pytest.mark.parametrize("scene, start, path", [
    (ALONE, None, "normal_force=-0.5"),
    (ALONE, None, "normal_force=0; normal_force=-0.01; normal_force=-1"),
    (Scene(geometry="sphere", dimension=2, period=float("inf"), normal_maugis=1.0, spacing=0.8),
     None, "normal_force=-0.5"), (LINE, "normal_displacement=-60", "normal_force=-0.5")])
def test_a_body_that_is_pulled_out_of_the_laws_range_has_no_equilibrium(scene, start, path):
    """Whatever the last digits of a solve: the branch that comes in from infinity is not its
    own."""
    branch, found = Branch(scene, Load(start=start, path=path)), []
    with pytest.raises(NoEquilibrium, match="pulled out of the law's range"):
        for point in branch:
            found.append(point)
    assert all(point.forces[0] == pytest.approx(0.0, abs=1e-7) for point in found)


GLIDING = Scene(geometry="sinusoid", amplitude=0.2, points=32, period=20.0, poisson=0.0,
                height=float("inf"), normal_maugis=0.409, tangential_maugis=0.111)


@pytest.mark.parametrize("slid", [-6.4, -6.5, -7.0])
def test_a_glide_whose_friction_falls_by_ever_so_little_is_led_back_without_a_fold(slid):
    """Slip fades the attraction and so moves the surfaces, which changes friction by a few
    millionths: no jump, but the way back."""
    path = f"tangential_displacement={slid}; tangential_force=0"
    _, points = followed(path, GLIDING, None, "normal_displacement=-1")
    assert not [point.event for point in points if point.leg == 2 and point.event]
    assert points[-1].displacements[1] == pytest.approx(0.0, abs=1e-6)
    assert points[-1].forces[0] == pytest.approx(points[0].forces[0], rel=1e-8)


def test_a_body_that_has_sunk_in_does_not_glide_as_long_as_its_friction_falls():
    """Friction of the law of McGarry grows with the overlap as fast as it falls with the slip: as
    of a body that just touches it was none, and steps that failed ended in a fold, anywhere."""
    scene = Scene(law="mcgarry", points=64, period=24.0, height=3.0, normal_maugis=1.0)
    branch, points = followed("tangential_displacement=5; normal_displacement=8", scene, LARGE,
                              "normal_displacement=-3")
    leg = SimpleNamespace(number=3, moving=0, direction=np.array([1.0, -1.0]))
    for point, glides in ((next(point for point in points if point.leg == 2), True),
                          (points[-1], False)):
        sunk = point.changed(controls=(FORCED, FORCED))
        fold = branch.corrector.end_of_attraction(sunk, leg, 0.0)
        assert (fold is not None and fold.fold_kind == "sliding") is glides


def test_what_newtons_method_adds_to_a_motion_counts_among_its_works():
    """The body may stand anywhere on the way, and its friction does work on all of it."""
    path = "tangential_displacement=-7; tangential_force=0"
    scene = replace(GLIDING, law="dugdale", dugdale_width=1.0)
    branch, points = followed(path, scene, None, "normal_displacement=-1")
    jump = next(point for point in points if point.event == "jump")
    fold = points[points.index(jump) - 1]
    work = straight(branch.contact, fold.state, jump.state, 60) @ weights(branch.contact, 2)
    # (a quadrature along a glide, of any length, leaves some 2e-5; that last part is 4e-4)
    assert jump.jump_work == pytest.approx(work, rel=1e-4)


def test_iterations_of_one_branch_may_be_in_different_legs():
    branch, alone = followed("normal_force=1; tangential_displacement=6", replace(
        LINE, height=float("inf"), poisson=0.5), Steps())
    ahead, behind = iter(branch), iter(branch)
    begun = sum(point.leg < 2 for point in alone) + 1  # one is sheared when the other begins
    found = [next(ahead) for _ in range(begun)], []
    for _ in alone:
        for points, iteration in zip(found, (ahead, behind)):
            points.extend(point for point in [next(iteration, None)] if point is not None)
    for points in found:
        assert [point.leg for point in points] == [point.leg for point in alone]
        np.testing.assert_allclose([point.forces[0] for point in points],
                                   [point.forces[0] for point in alone], rtol=0, atol=1e-6)


def test_a_force_that_solves_leave_is_taken_to_nothing_in_one_step_and_turns_no_load_back():
    """A transverse displacement that was held leaves a force of 1e-10 or so, of either sign, which
    was taken for a load: 21 points, a branch that is unstable, and a load that turns back."""
    for end in (-0.01, 0.01):
        said = []
        path = ("normal_force=1; tangential_force_x=0.1; tangential_force_y=0; "
                f"tangential_force_y={end}")
        _, points = followed(path, PLANE, Steps(), log=said.append)
        last = [point for point in points if point.leg < 4][-1]
        assert sum(point.leg == 3 for point in points) <= 1
        assert last.forces[2] == 0.0 and points[-1].forces[2] == end
        assert not [sentence for sentence in said if "load back" in sentence
                    or "unstable" in sentence]
        assert all(point.stable for point in points)
