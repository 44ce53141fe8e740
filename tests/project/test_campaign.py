"""The checker of scripts/campaign against analytic limits and finite differences, a sample of
scenes, and planted faults."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

# noqa: E402
from campaigns import (
    checker,
    comparison,
    faults,
    judge,
    physics,
    planted,
    scenes,
    surfaces,
    table,
    ways_out,
)

pytestmark = pytest.mark.study


@pytest.fixture(scope="module")
def worker():
    process = judge.Worker()
    yield process
    process.close()


# The model of the checker


def test_a_thick_layer_deforms_as_a_half_space_and_a_thin_one_as_springs():
    for poisson in (0.0, 0.3, 0.5):
        beta = (1 - 2 * poisson) / (2 * (1 - poisson))
        thick = physics.plane_strain(np.array([1.0, 3.0]), poisson, math.inf)
        assert np.allclose(thick, np.array([[2.0, 2.0 * beta], [2.0 * beta, 2.0]])[..., None]
                           / [1.0, 3.0], rtol=1e-13)
    thin = physics.plane_strain(np.array([1e-3]), 0.3, 1.0)
    assert np.allclose([thin[1, 1], thin[0, 0]], [[physics.mean_compliance(0.3, 1.0)[0]],
                                                  [physics.mean_compliance(0.3, 1.0)[1]]],
                       rtol=1e-5)


def test_an_unbounded_line_is_deformed_by_a_logarithm():
    kernel = np.fft.ifft(physics.unbounded(64, 0.1, 0.5, math.inf, 1.0)).real[0, 0]
    x = 0.1 * np.arange(20, 60, 4)
    assert np.allclose(np.diff(kernel[20:60:4]), -2 / np.pi * 0.1 * np.diff(np.log(x)), rtol=2e-3)


def law(name, **changes):
    return {"law": name, "residual_friction": 1.0, "residual_adhesion": 0.0, "dugdale_width": 0.1,
            "xu_needleman_q": 1.0, "xu_needleman_r": 0.0, "pressure_friction": 0.1, **changes}


@pytest.mark.parametrize("name, changes", [
    ("dugdale", {}), ("dugdale", {"dugdale_width": 0.7}), ("xu_needleman", {}),
    ("xu_needleman", {"xu_needleman_q": 0.5, "xu_needleman_r": 0.3}), ("pressure_friction", {})])
def test_the_other_laws_have_a_work_of_separation(name, changes):
    a, scene = np.linspace(0.0, 40.0, 400001), law(name, **changes)
    apart = physics.tractions(scene, a, np.zeros((1, a.size)))[0]
    assert 1e-4 * (np.sum(apart) - 0.5 * apart[0]) == pytest.approx(1.0, abs=1e-7)
    deep = np.linspace(-2.0, 6.0, 80001)
    pulled = physics.tractions(scene, deep, np.zeros((1, deep.size)))[0]
    slope = np.gradient(physics.potential(scene, deep), deep)
    assert np.allclose(slope[1:-1], pulled[1:-1], rtol=1e-5, atol=1e-5)


def test_the_law_of_xu_and_needleman_has_the_potential_of_its_work_ratio():
    scene, step = law("xu_needleman", xu_needleman_q=0.5, xu_needleman_r=0.3), 1e-5
    a, b = np.meshgrid(np.linspace(-1.0, 4.0, 21), np.linspace(-2.0, 2.0, 20))
    across = (physics.tractions(scene, a, b[None] + step)[0]
              - physics.tractions(scene, a, b[None] - step)[0])
    along = 0.5 * (physics.tractions(scene, a + step, b[None])[1]
                   - physics.tractions(scene, a - step, b[None])[1])
    assert np.allclose(across, along, atol=1e-11)


def test_the_laws_have_their_peaks_and_works_of_separation():
    a, b = np.linspace(0.0, 40.0, 40001), np.linspace(0.0, 8.0, 40001)
    apart = physics.tractions(law("modified"), a, np.zeros((1, a.size)))[0]
    assert apart.max() == pytest.approx(math.exp(-1), rel=1e-6)
    assert 0.001 * np.sum(apart) == pytest.approx(1.0, rel=1e-6)
    half = law("modified", residual_friction=0.5)
    sheared = physics.tractions(half, np.zeros(b.size), b[None])[1]
    assert (sheared.max() == pytest.approx(physics.PEAK, rel=1e-6)
            and sheared[-1] == pytest.approx(0.5 * physics.PEAK, rel=1e-6))
    slope = np.gradient(physics.potential(half, a), a)
    assert np.allclose(slope[1:-1], apart[1:-1], atol=1e-6)


# What it finds


def run(worker, folder, options, **changes):
    """(archive, Run) of a scene."""
    archive = folder / "run.h5"
    scene = scenes.Scene(0, 0, {"scene_points": 64, "scene_period": 15, "scene_normal_maugis": 2,
                                "scene_height": 50, **options}, given=False)
    done = worker.run(["run", *scene.words(folder, archive_file=archive, archive_fields="all",
                                           **changes)], folder / "run", 30)
    return archive, done


def test_nothing_is_wrong_with_a_sound_path(worker, tmp_path):
    archive, done = run(worker, tmp_path, {"scene_poisson": 0.3,
                                           "load_path": "normal_displacement=1; "
                                           "tangential_displacement=2"})
    assert done.status == 0 and checker.check(archive) == []


def test_an_isolated_body_may_stop_at_a_fold_though_it_has_no_place(worker, tmp_path):
    """Its displacement as a whole is nan."""
    archive, options = tmp_path / "run.h5", {"scene_period": "inf", "scene_spacing": 0.2,
                                             "scene_normal_maugis": 2, "scene_height": "inf",
                                             "load_path": "normal_force=2.8; normal_force=3",
                                             "continuation_at_fold": "stop"}
    scene = scenes.Scene(0, 0, options, given=False)
    done = worker.run(["run", *scene.words(tmp_path, archive_file=archive, archive_fields="all")],
                      tmp_path / "run", 30)
    assert done.status == 0 and checker.check(archive) == []


@pytest.mark.parametrize("column, change, kind", [("normal_force", 1e-5, "normal_force"),
                                                  ("contact_area", 0.1, "contact_area"),
                                                  ("elastic_energy", 1e-3, "elastic_energy"),
                                                  ("normal_displacement", 1e-6,
                                                   "normal_displacement"),
                                                  ("residual_norm", 1.0, "not converged"),
                                                  ("fields/displacement", 1e-3, "traction"),
                                                  ("fields/traction", 1e-3, "traction")])
def test_what_is_changed_in_an_archive_is_seen(worker, tmp_path, column, change, kind):
    import h5py

    archive, _ = run(worker, tmp_path, {"load_path": "normal_displacement=1"})
    with h5py.File(archive, "r+") as file:
        values = file[column if "/" in column else f"branch/{column}"]
        values[1] = values[1] + change
    assert kind in {complaint.kind for complaint in checker.check(archive)}


PLANE = {"scene_dimension": 2, "scene_points": 16, "scene_period": 8, "scene_geometry": "sphere",
         "scene_normal_maugis": 1, "scene_tangential_maugis": 0.7, "scene_poisson": 0.3,
         "load_path": "normal_displacement=1; tangential_displacement_y=1"}


ISOLATED = {"load_path": "normal_force=1", "scene_period": "inf", "scene_points": None,
            "scene_spacing": 0.2}


@pytest.mark.parametrize("options", [PLANE, {"load_path": "normal_displacement=1"}, ISOLATED,
                                     {**ISOLATED, "scene_law": "dugdale",
                                      "scene_dugdale_width": 0.5, "scene_normal_maugis": 1.2}],
                         ids=["plane", "line", "isolated", "apart"])
def test_fields_on_active_nodes_are_checked_as_those_of_the_cell(worker, tmp_path, options):
    import h5py

    found = {}
    for on in ("cell", "active"):
        archive, _ = run(worker, tmp_path, options, archive_fields_on=on, archive_overwrite="")
        assert checker.check(archive) == []
        found[on] = checker.read(archive)
    assert found["cell"].mean is None and found["active"].mean is not None
    assert np.allclose(found["active"].displacement, found["cell"].displacement, atol=1e-6)
    with h5py.File(archive, "r+") as file:
        values = file["fields/active/displacement"]
        values[...] = values[...] * 1.001
    assert {"traction"} <= {complaint.kind for complaint in checker.check(archive)}


def test_paths_that_end_elsewhere_do_not_agree(worker, tmp_path):
    paths = []
    for end in ("1", "1.00001"):
        folder = tmp_path / end
        folder.mkdir()
        paths.append(comparison.Story(run(worker, folder,
                                          {"load_path": f"normal_displacement={end}"})[0]))
    assert (comparison.compare(paths[0], paths[0]) == []
            and "end of leg 1" in comparison.compare(*paths)[0])


class Told(comparison.Story):
    """A story of made events, on one leg."""

    def __init__(self, *events, stop="gross_sliding"):
        self.count = len(events)
        self.legs, self.names = np.ones(self.count, int), ["tangential_displacement"]
        self.events = [point for point, (event, _) in enumerate(events) if event != "none"]
        self.path = checker.Path(event=[event for event, _ in events], fold_kind=[""] * self.count,
                                 tangential_displacement=[load for _, load in events],
                                 normal_force=[1.0] * self.count, dissipated_work=[0.0])
        self.path.legs, self.path.dimension = [{0: ("force", 1.0), 1: ("displacement", 1.0)}], 1
        self.path.options = {"load_stop": stop}


def test_an_event_that_ends_a_path_may_come_before_the_fold_that_longer_steps_reach():
    sliding = ("gross_sliding", 3.0)
    late = Told(("none", 2.0), ("fold", 3.2), ("gross_sliding", 3.2))
    assert comparison.compare(late, Told(("none", 2.0), sliding)) == []
    assert comparison.compare(Told(("none", 2.0), sliding), late) == []
    apart = Told(("none", 2.0), ("fold", 2.5), ("jump", 2.5), ("gross_sliding", 3.2))
    assert "events" in comparison.compare(apart, Told(("none", 2.0), sliding))[0]
    assert "events" in comparison.compare(late, Told(("none", 2.0), ("none", 4.0)))[0]


def test_a_fold_that_ends_a_path_is_one_whatever_event_comes_with_it():
    late = Told(("none", 2.0), ("fold", 3.2), ("gross_sliding", 3.2), stop="none")
    assert comparison.compare(late, Told(("gross_sliding", 3.0), ("fold", 3.2), stop="none")) == []
    assert "events" in comparison.compare(late, Told(("gross_sliding", 3.0), ("none", 3.1),
                                                     stop="none"))[0]



@pytest.mark.parametrize("name", planted.FAULTS)
def test_a_test_that_is_switched_off_is_seen(worker, tmp_path, name):
    fault = planted.FAULTS[name]
    verdict = judge.judged(planted.scene(name), worker, tmp_path, only=fault.variants, fault=name,
                           planted_in=("scene",))
    assert verdict.outcome == "silent"


# A sample


@pytest.mark.parametrize("number", [3, 26, 58])
def test_a_scene_and_its_variants_tell_the_same(worker, tmp_path, number):
    verdict = judge.judged(scenes.create(1, number), worker, tmp_path, budget=1.0)
    assert verdict.outcome not in judge.FORBIDDEN, verdict.found


def test_grids_may_differ_by_the_errors_that_the_program_tells(worker, tmp_path):
    """A force of a fifth of what it was before the slip: 1.8 % and -0.4 % off, as -archive_errors
    says, on two grids that resolve it."""
    verdict = judge.judged(scenes.create(28, 102), worker, tmp_path, only=["twice the points"])
    assert verdict.outcome == "agreed", verdict.found


def test_works_behind_a_jump_are_known_as_well_as_the_step_to_its_fold_tells(worker, tmp_path):
    """A force of -10.8 after a jump and of -10.9 at the end of the next step, -11.6 in between:
    0.017 is missing in its works, as energy_imbalance says."""
    verdict = judge.judged(scenes.create(29, 107), worker, tmp_path, only=[])
    assert verdict.outcome == "agreed", verdict.found


@pytest.mark.parametrize("number", [1, 3])
def test_ways_out_of_an_archive_are_as_asked(worker, tmp_path, number):
    verdict, _ = ways_out.judged(1, number, worker, tmp_path, 30)
    assert verdict.outcome == "agreed" and verdict.runs > 1, verdict.found


def test_measured_surfaces_are_told_as_they_are(worker, tmp_path):
    verdict = judge.Verdict()
    drawn = []
    for number in range(12):
        surfaces.judged(verdict, 1, number, worker, tmp_path, 30)
        drawn.append(surfaces.create(1, number, tmp_path))
    assert verdict.outcome == "agreed" and verdict.runs == 12, verdict.found
    assert {good for *_, good in drawn} == {True, False}
    assert len({options["scene_geometry_file"] for options, *_ in drawn}) > 3


def test_another_surface_than_drawn_is_seen(worker, tmp_path, monkeypatch):
    number = next(number for number in range(50) if surfaces.create(1, number, tmp_path)[2]
                  and surfaces.create(1, number, tmp_path)[1] is not None)
    options, values, good = surfaces.create(1, number, tmp_path)
    monkeypatch.setattr(surfaces, "create", lambda *arguments: (options, 1.01 * values, good))
    verdict = judge.Verdict()
    surfaces.judged(verdict, 1, number, worker, tmp_path, 30)
    assert verdict.outcome == "silent"


def test_a_table_that_says_something_else_is_seen(worker, tmp_path):
    archive, _ = run(worker, tmp_path, {"load_path": "normal_displacement=1"})
    made = tmp_path / "made.csv"
    worker.run(["table", str(archive), "-columns", "contact_area", "-output", str(made)],
               tmp_path / "said", 30)
    text = made.read_text().rstrip("\n")
    for change, outcome in (("", "agreed"), ("e1", "silent")):
        verdict = judge.Verdict()
        made.write_text("contact_area\n")
        ways_out.judge_table(verdict, made, archive, {"rows": "event"})  # there are none
        made.write_text(text + change + "\n")
        ways_out.judge_table(verdict, made, archive, {})
        assert verdict.outcome == outcome


def test_a_scene_is_the_same_whenever_it_is_drawn():
    assert scenes.create(5, 7).options == scenes.create(5, 7).options != scenes.create(5, 8).options


def test_the_table_counts_each_case_once_by_its_worst_outcome(tmp_path):
    rows = [f"scenes,{number},1,{outcome},3,2,0,1.0,,x"
            for number, outcome in ((0, "silent"), (1, "agreed"), (0, "agreed"))]
    (tmp_path / "campaign-scenes.csv").write_text(
        "part,number,seed,outcome,points,runs,left_out,seconds,found,command\n" + "\n".join(rows)
        + "\n")
    assert "| scenes | 2 | 4 | 2 |" in "\n".join(table.lines(tmp_path))
    assert not table.failed(tmp_path, ["scenes"])


# Faults planted in the sources


def test_faults_and_their_tests_stand_in_the_sources():
    listed = faults.read_faults()
    assert faults.stale(listed) == []
    assert len(set(listed)) == len(listed) >= 100
    assert all(fault.area and fault.text != fault.fault for fault in listed)
    for file, _, test in (argument.partition("::") for fault in listed
                          for argument in faults.arguments(fault)):
        assert f"def {test or 'test_'}" in (ROOT / file).read_text(encoding="utf-8")


def test_a_fault_is_planted_in_a_copy_and_found_there():
    """The law's tangent with a wrong sign; what changes nothing is not found."""
    fault = next(fault for fault in faults.read_faults()
                 if fault.text.strip() == "out[i, i] += secant")
    fault = fault._replace(tests="laws::test_taylor_remainder_is_of_second_order")
    assert ("test_taylor_remainder" in faults.tried(fault)[0]
            and faults.tried(fault._replace(fault=fault.text))[0] == "")
    assert faults.stale([fault]) == []


def test_faults_have_a_table_of_their_own(tmp_path):
    rows = [f"faults,{number},1,{outcome},0,1,0,1.0,,x"
            for number, outcome in ((0, "silent"), (1, "agreed"))]
    (tmp_path / "campaign-faults.csv").write_text(
        "part,number,seed,outcome,points,runs,left_out,seconds,found,command\n" + "\n".join(rows)
        + "\n")
    assert table.lines(tmp_path)[-1] == "| all | 2 | 1 |" and table.lost(tmp_path)
