"""What is said of points that the grid does not resolve, and of paths that end."""

import math
import re
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest

petsc4py.init()
from contactsnes import Branch, Contact, Load, NoEquilibrium, NotConverged, Scene, Steps
from contactsnes.branch.ends import of_law
from contactsnes.branch.failures import NARROW, critical, explained, narrow, uncomputable
from contactsnes.branch.remarks import Remarks
from contactsnes.contact import states
from contactsnes.contact.balance import left_by_rounding
from contactsnes.continuation import steppers
from contactsnes.dynamics.stability import SIGN, Stability
from contactsnes.scene.resolution import resolution

LINE = {"points": 512, "period": 40.0, "normal_maugis": 2.0}


def run(scene, start, path, **steps):
    sentences = []
    branch = Branch(Scene(**{**LINE, **scene}), Load(start=start, path=path), Steps(**steps),
                    log=sentences.append)
    return branch, list(branch), sentences


def test_folds_of_a_coarse_grid_are_marked_and_said_to_be_its_own():
    """Maugis parameter 6 on 256 points: edges of contact stick between nodes (4.5 times the spacing
    that resolves them)."""
    branch, points, sentences = run({"points": 256, "normal_maugis": 6.0}, "normal_displacement=4",
                                    "normal_displacement=0")
    folds = [point for point in points if point.event == "fold"]
    assert len(folds) > 3 and not any(point.resolved for point in folds)
    assert len([sentence for sentence in sentences if "may be the grid's" in sentence
                and "-scene_points 2048" in sentence]) == 1
    assert branch.observe(folds[0])["resolved"] == 0
    fine = run({"points": 2048, "normal_maugis": 6.0}, "normal_displacement=4",
               "normal_displacement=0")[1]
    assert [point.event for point in fine] == [None] * len(fine) and all(point.resolved
                                                                           for point in fine)


def test_shear_counts_where_something_slips():
    """A sharp tangential law on a grid that resolves the normal one: points are marked from the
    first slip on."""
    scene = {"points": 512, "normal_maugis": 2.0, "tangential_maugis": 6.0,
             "residual_friction": 0.0, "height": 20.0}
    _, points, _ = run(scene, "normal_displacement=2", "tangential_displacement=30", at_fold="stop")
    marked = [bool(point.resolved) for point in points]
    assert marked[0] and not marked[-1] and marked == sorted(marked, reverse=True)


def test_rims_that_sink_under_eq_3_sharpen_the_law():
    """Where it overlaps, friction under eq. 3 is stiffer and softens faster than the spacing was
    chosen for."""
    scene = {"points": 1024, "period": 20.0, "normal_maugis": 3.0, "tangential_maugis": 3.0,
             "law": "mcgarry", "height": 50.0}
    path = {"start": "normal_displacement=4", "path": "tangential_displacement=44.5"}
    branch, points, sentences = run(scene, path["start"], path["path"], initial_step=(4.0,),
                                    largest_step=(4.0,))
    marked = [point.resolved for point in points]
    assert marked[0] == 1 and marked[-1] == 0 and marked == sorted(marked, reverse=True)
    assert len([sentence for sentence in sentences
                if "softens faster than the grid resolves" in sentence]) == 1
    # Of its own tangent by differences: minus the smallest eigenvalue, of the node where it is
    # largest.
    gap = points[-1].state.displacement.copy()
    gap[0] = states.normal_gap(branch.contact, points[-1].state)
    law = branch.contact.law
    step = 1e-6
    tangent = np.zeros((2, 2, gap.shape[1]))
    for i in range(2):
        change = np.zeros_like(gap)
        change[i] = step
        tangent[:, i] = 9.0 * (law.traction(gap + change) - law.traction(gap - change)) / (
            2.0 * step)
    values = np.linalg.eigvals(np.moveaxis(tangent, -1, 0))
    assert branch.contact.survey(points[-1].state).steepest == pytest.approx(
        -values.real[values.imag == 0.0].min(), rel=1e-5)
    fine = run({**scene, "points": 2048}, path["start"], path["path"], initial_step=(4.0,),
               largest_step=(4.0,))[1]
    assert all(point.resolved for point in fine)


def test_folds_that_the_grid_makes_of_one_are_marked():
    """At a normal Maugis parameter of 20 the largest spacing that resolves the law turns a branch
    several times at its fold: which of these folds is found hangs on the steps. Half the spacing
    has one."""
    scene = {"period": 25.0, "normal_maugis": 20.0}
    folds = {}
    for size in (8192, 16384):
        _, points, sentences = run({**scene, "points": size}, "normal_displacement=0",
                                   "normal_displacement=-4.5", at_fold="stop", type="arclength")
        folds[size] = points[-1]
        assert (points[-1].event == "fold" and points[-1].fold_precision <= 1e-8
                and points[-2].resolved == 1)
        assert any("may be one of several" in sentence for sentence in sentences) is (size == 8192)
    assert (folds[8192].resolved, folds[16384].resolved) == (0, 1)
    assert folds[8192].load[0] == pytest.approx(folds[16384].load[0], rel=1e-5)


def test_bends_that_are_rounding_crowd_no_folds():
    """The trough of a wave lets go at one load, to nine digits, on grids seven and 14 times finer
    than the law asks for, on which its opening passes a node within 1e-5 ranges."""
    loads = []
    for size in (2048, 4096):
        _, points, sentences = run({"points": size, "period": 10.0, "geometry": "sinusoid",
                                    "amplitude": 1.0, "normal_maugis": 6.0, "height": np.inf},
                                   "normal_displacement=1.1", "normal_displacement=0.8",
                                   at_fold="stop")
        assert points[-1].event == "fold" and points[-1].resolved
        assert not any("may be one of several" in sentence for sentence in sentences)
        loads.append(points[-1].load[0])
    assert loads[0] == pytest.approx(loads[1], rel=1e-9)


def test_jumps_over_few_nodes_are_told_from_others():
    contact = Branch(Scene(**LINE), Load(start="normal_displacement=1",
                                         path="normal_displacement=1")).contact
    state = states.undeformed(contact, ("displacement",), np.array([1.0]))
    for width, expected in ((3, True), (NARROW // 2, True), (2 * NARROW, False)):
        moved = state.displacement.copy()
        moved[:, 256:256 + width] += 1.0
        assert narrow(contact, state, states.State(state.window, moved, state.means)) is expected
    assert narrow(contact, state, state) is False


@pytest.mark.parametrize("modes, words", ((None, "a failure of the solver"),
                                          (SimpleNamespace(unstable=2, leading=-0.3 + 0.1j),
                                           "unstable .2 modes, leading eigenvalue "
                                           "-0.3.: a bifurcation was passed"),
                                          (SimpleNamespace(unstable=0, leading=0.0001 + 0j),
                                           "hardly .*a fold or a bifurcation is "
                                           "next to it"),
                                          (SimpleNamespace(unstable=0, leading=0.8 + 0j),
                                           "stable .*a failure of the solver; try "
                                           "smaller steps")))
def test_reasons_are_told_apart(modes, words):
    told = explained(NotConverged("a solve failed"), Contact(Scene(**LINE)), False, lambda: modes)
    assert isinstance(told, NotConverged) and str(told).startswith("a solve failed; ")
    with pytest.raises(NotConverged, match=words):
        raise told


def test_the_eigenvalue_that_a_reason_tells_is_right_to_its_digits():
    """Signs alone were looked for: 0.664 in place of 0.651, and another number on several
    processes."""
    branch = Branch(Scene(dimension=2, geometry="sphere", points=16, period=6.0,
                          normal_maugis=2.0), Load("normal_displacement=1",
                                                   "normal_displacement=1"))
    point = next(iter(branch))
    exact = Stability(branch.corrector, SIGN).modes(point, 1e-8).leading
    assert branch._modes(point, None).leading == pytest.approx(exact, abs=3e-4)


@pytest.mark.parametrize("control, begins", (("force", True), ("displacement", False)))
def test_legs_that_begin_unstable_under_their_force_say_so(control, begins):
    """Without contact attraction pulls harder the nearer the body: no force holds it there."""
    branch = Branch(Scene(**LINE), Load(start="normal_displacement=-1",
                                        path="normal_displacement=-1"))
    last = next(iter(branch))
    modes = SimpleNamespace(unstable=1, leading=-3e-5 + 0.0j)
    remarks = Remarks(branch.corrector, False, True, None, last)
    remarks.leg = SimpleNamespace(controls=(control,))
    told = str(explained(NotConverged("x"), branch.contact, False, lambda: modes, last,
                         remarks.unstable_since()))
    assert ("now that a force holds what a displacement held" in told) is begins
    assert ("a bifurcation was passed" in told) is not begins


@pytest.mark.parametrize("stable, stability, told", (
    (0, "off", "now that a force holds what a displacement held"),
    (-1, "off", "a bifurcation was passed, which -continuation_stability sign finds"),
    (1, "sign", "a bifurcation was passed$")))
def test_the_reason_stays_that_of_the_legs_beginning(monkeypatch, stable, stability, told):
    """Behind its first points, a leg that had begun unstable was said to have passed a bifurcation,
    which was to be looked for where it had been asked for."""
    def fails(corrector, start, makers, **rest):
        first = start()
        yield first
        leg = makers[0]([first])
        yield corrector.adapted(first, leg.controls, leg.start).changed(leg=1, stable=stable)
        raise NotConverged("x")

    monkeypatch.setattr("contactsnes.continuation.path.branch", fails)
    branch = Branch(Scene(**LINE), Load("normal_displacement=-1", "normal_force=0"),
                    Steps(stability=stability))
    monkeypatch.setattr(Branch, "_modes", lambda *_: SimpleNamespace(unstable=1, leading=-1 + 0j))
    with pytest.raises(NotConverged, match=f"unstable .1 modes, leading eigenvalue -1.:? {told}"):
        list(branch)


@pytest.mark.parametrize("steps, rough, advised", (
    (Steps(), False, ("-continuation_locate_folds false", "-continuation_type arclength")),
    (Steps(), True, ("-continuation_type arclength",)),
    (Steps(locate_folds=False), False, ("-continuation_type arclength",)),
    (Steps(type="arclength"), False, ())))
def test_what_is_taken_already_is_not_advised(steps, rough, advised):
    soft, others = SimpleNamespace(unstable=0, leading=0.0001 + 0j), steppers.others(
        steppers.stepper(steps, not rough))
    told = str(explained(NotConverged("x"), Contact(Scene(**LINE)), False, lambda: soft,
                         others=others))
    assert told.endswith(", or ".join(("; try smaller steps", *advised)))


def test_a_path_advises_other_ways_than_its_own(monkeypatch):
    def fails(*given, **rest):
        raise NotConverged("x")
        yield

    soft = SimpleNamespace(unstable=0, leading=0.0001 + 0j)
    monkeypatch.setattr("contactsnes.continuation.path.branch", fails)
    branch = Branch(Scene(**LINE), Load("normal_displacement=1", "normal_displacement=1"),
                    Steps(locate_folds=False))
    monkeypatch.setattr(Branch, "_modes", lambda *_: soft)
    with pytest.raises(NotConverged, match="smaller steps, or -continuation_type arclength$"):
        next(iter(branch))


def test_a_tall_layer_is_not_taken_for_a_critical_point():
    """Its mean creeps back at the rate k_0/m_0: 0.0016 for L = 40, H = 2000."""
    contact = Contact(Scene(**LINE))
    assert 0.0003 < critical(contact, True) < 0.0005 < 0.04 < critical(contact, False)


def test_a_diagnosis_that_fails_leaves_the_reason():
    def broken():
        raise ValueError("no modes")

    assert "a failure of the solver" in str(explained(NotConverged("x"), Contact(Scene(**LINE)),
                                                      False, broken))


@pytest.mark.parametrize("given, told", (({"ksp_type": "cg"}, "without -ksp_type cg, or another "
                                          "-load_start"),
                                         ({"ksp_type": "fgmres", "pc_type": "python"},
                                          "solver: try another -load_start, and a leg")))
def test_methods_of_the_users_choice_are_doubted_first(monkeypatch, given, told):
    monkeypatch.setattr("contactsnes.branch.failures.database", lambda: given)
    assert told in str(explained(NotConverged("x"), Contact(Scene(**LINE)), False, lambda: None))


def test_a_tolerance_below_rounding_is_named_as_the_reason():
    from petsc4py import PETSc

    options = PETSc.Options()
    options["snes_atol"] = 1e-18
    try:
        with pytest.raises(NotConverged, match="-snes_atol 1e-18 is below what rounding leaves"):
            list(Branch(Scene(**LINE), Load(path="normal_displacement=1")))
    finally:
        options.delValue("snes_atol")


def test_a_first_point_too_deep_for_its_digits_says_so():
    """There are no steps to make smaller, but the tolerance that is named has a point."""
    from petsc4py import PETSc

    options, scene = PETSc.Options(), Scene(period=3.5, points=96, normal_maugis=4.5)
    load = Load(start="normal_displacement=3.7", path="normal_displacement=3.7")
    with pytest.raises(NotConverged, match="rounding leaves of displacements") as failure:
        list(Branch(scene, load))
    told = str(failure.value)
    assert "smaller steps" not in told
    options["snes_atol"] = float(re.search(r"try (\S+)$", told).group(1))
    try:
        assert next(iter(Branch(scene, load))).in_contact
    finally:
        options.delValue("snes_atol")


def test_a_body_that_sinks_to_the_laws_end_is_no_failure_of_the_solver():
    """Slip takes the repulsion of this law as well as its attraction."""
    scene = Scene(period=21.0, points=128, normal_maugis=1.8, tangential_maugis=0.4,
                  law="xu_needleman", xu_needleman_r=0.5, height=math.inf)
    load = Load(start="normal_force=3.6", path="tangential_displacement=14")
    with pytest.raises((NotConverged, NoEquilibrium),
                       match="deepest of which the law tells|sinks in") as failure:
        list(Branch(scene, load, Steps(at_fold="trace")))
    assert "smaller steps" not in str(failure.value)


@pytest.mark.parametrize("closest, deep", [(-29.9, True), (-20.0, False)])
def test_the_deepest_gap_of_which_a_law_tells_is_named_where_a_path_ends_there(closest, deep):
    contact = SimpleNamespace(survey=lambda state: SimpleNamespace(closest=closest),
                              law=SimpleNamespace(deepest=-30.0))
    told = of_law(contact, SimpleNamespace(state=None))
    assert (f"a gap of {closest:g} delta_n" in told and "press less" in told) is deep
    assert bool(told) is deep and not of_law(contact, None)


@pytest.mark.parametrize("option", ["snes_rtol", "snes_stol"])
def test_an_option_that_ends_solves_before_their_tolerance_is_named(option):
    from petsc4py import PETSc

    options = PETSc.Options()
    options[option] = 1e-3
    try:
        _, points, sentences = run({"points": 256}, "normal_displacement=1",
                                   "normal_displacement=2")
    finally:
        options.delValue(option)
    told = [sentence for sentence in sentences if "above -snes_atol" in sentence]
    assert told and all(f"where -{option} ended it" in sentence for sentence in told)
    assert all(point.residual_norm <= 1e-8 for point in points)


def test_contacts_too_deep_for_their_digits_are_told():
    """A last digit of a deep displacement is worth more than the tolerance."""
    from petsc4py import PETSc

    options = PETSc.Options()
    options["snes_atol"] = 1e-6
    try:
        branch = Branch(Scene(period=20.0, normal_maugis=1.0, points=64),
                        Load(path="normal_displacement=30", start="normal_displacement=15"))
        soft, *_, deep = branch
    finally:
        options.delValue("snes_atol")
    left = [left_by_rounding(branch.contact, point.state, point.controls, point.load)
            for point in (soft, deep)]
    assert left[0] < 1e-9 and 1e-8 < left[1] < 1e-6
    told = [str(explained(NotConverged("x"), branch.contact, False, lambda: None, point))
            for point in (soft, deep)]
    assert "rounding" not in told[0] and re.search(
        r"^x; -snes_atol 1e-08 is below what rounding leaves of displacements of [\d.e+]+ ranges "
        r"of the law, about \de-0\d: try \de-0\d$", told[1])


@pytest.mark.parametrize("scene, displacement", [
    ({"normal_maugis": 1.0, "period": 30.0}, 2.0), ({"normal_maugis": 3.0, "period": 20.0}, 10.0),
    ({"dimension": 2, "geometry": "sphere", "normal_maugis": 1.0, "period": 16.0}, 1.0)])
def test_points_whose_traction_alternates_from_node_to_node_are_not_resolved(scene, displacement):
    """A soft law on a grid that is too coarse for the contact, though it is not for the law: by the
    error of the force."""
    load = Load(path=f"normal_displacement={displacement}",
                start=f"normal_displacement={displacement}")
    exact = None
    for points in (192, 96, 48, 24, 16):
        said = []
        branch = Branch(Scene(points=points, **scene), load, log=said.append)
        point = next(iter(branch))
        exact = point.forces[0] if exact is None else exact
        error = abs(point.forces[0] / exact - 1.0)
        # Marked where the error is large, not where it is small, and between as it comes.
        assert point.resolved == 0 or error < 0.02
        assert point.resolved == 1 or error > 1e-4
        assert point.resolved or any("alternates" in sentence or "resolve" in sentence
                                     for sentence in said) or max(resolution(branch.scene,
                                                                             False)) > 1.0
    assert point.resolved == 0


def test_a_full_contact_and_a_body_off_the_flat_do_not_alternate():
    for geometry, path in (("flat", "normal_displacement=0.3; normal_displacement=-3"),
                           ("sinusoid", "normal_displacement=3")):
        points = list(Branch(Scene(points=64, period=8.0, normal_maugis=2.0, geometry=geometry),
                             Load(path=path)))
        assert all(point.resolved for point in points)


@pytest.mark.parametrize("more", [{"geometry": "flat"}, {"geometry": "rough", "rough_slope": 0.5,
                                                        "rough_shortest": 2.0}])
def test_what_solves_leave_of_slip_that_no_load_makes_does_not_alternate(more):
    """Tangential unknowns, and nothing that moves them: their tractions are noise of some 1e-9."""
    said = []
    points = list(Branch(Scene(points=64, period=8.0, normal_maugis=2.0, law="mcgarry",
                               tangential="on", **more),
                         Load(path="normal_displacement=1.5; normal_displacement=-2"),
                         log=said.append))
    assert all(point.resolved for point in points) and "alternates" not in str(said)


@pytest.mark.parametrize("options, status, words",
                         [({"scene_period": "30", "scene_range_normal": "7.4e-07",
                            "load_path": "normal_force=-1.5e2; normal_displacement=.5"}, 1,
                           "on the way (e"),
                          ({"scene_period": "1e20", "load_path": "normal_force=1"}, 2,
                           "-scene_period 1e20"),
                          ({"load_path": "normal_force=-3e-15", "snes_atol": "1e-12"}, 2,
                           "-load_path 3e-15")])
def test_only_numbers_that_were_given_are_called_too_large_or_too_small(options, status, words):
    found, sentence = uncomputable(OverflowError("e"), options)
    assert found == status and words in sentence and "snes_atol" not in sentence


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("width, expected", [(3, True), (18, True), (19, False), (40, False)])
def test_width_of_what_jumps(dimension, width, expected):
    """Runs of nodes that move, the widest of which counts."""
    contact = Contact(Scene(dimension=dimension, points=128, period=20.0,
                            geometry="cylinder" if dimension == 1 else "sphere"))
    before = np.zeros(contact.grid.shape)
    after = before.copy()
    for first, last in ((20, 20 + width), (100, 102)):
        after[(slice(first, last),) * dimension] = 1.0
    gap = 1.0 - contact.initial_gap.reshape(1, -1)
    pair = [states.State(contact.grid.whole, gap + field.reshape(1, -1), np.zeros(1))
            for field in (before, after)]
    assert narrow(contact, *pair) is expected
    assert narrow(contact, pair[0], pair[0]) is False


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("shift", [-62, 0, 66])
def test_what_jumps_across_the_border_of_the_cell_is_as_wide_as_elsewhere(dimension, shift):
    contact = Contact(Scene(dimension=dimension, points=128, period=20.0, geometry="flat"))
    for width, expected in ((18, True), (24, False)):
        after = np.zeros(contact.grid.shape)
        after[(slice(50, 50 + width),) * dimension] = 1.0
        after = np.roll(after, (shift,) * dimension, tuple(range(dimension)))
        pair = [states.State(contact.grid.whole, field.reshape(1, -1), np.zeros(1))
                for field in (0.0 * after, after)]
        assert narrow(contact, *pair) is expected
