"""Estimates of errors, and grids for an accuracy: against finer grids, on scenes that no constant
was chosen by."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from contactsnes.branch import accuracy, grid_choice
from contactsnes.branch.branch import Branch
from contactsnes.branch.coarser import refined
from contactsnes.branch.corrector import Corrector
from contactsnes.branch.grid_choice import chosen, memory_needed, next_grid, predicted, reason
from contactsnes.contact.observables import Measurement
from contactsnes.contact.problem import Contact
from contactsnes.contact.states import State
from contactsnes.continuation.points import NotConverged, TooCoarse
from contactsnes.options.fields import InputError
from contactsnes.scene.load import Load
from contactsnes.scene.resolution import resolution_warning
from contactsnes.scene.settings import Form, Output, Scene, Steps, ineffective, tangential_legs
from contactsnes.solvers.snes import COLD

LINE = dict(normal_maugis=2.0, period=20.0)
PRESS = Load(path="normal_displacement=1")


def errors_against(scene, load, ratio, steps=Steps()):
    """Estimates and errors against a grid finer by a ratio, of force (or displacement), area and
    slip, and of the tangential force (or displacement): array (points, 2, 4)."""
    branch = Branch(scene, load, steps)
    estimator = accuracy.Estimator(branch.contact)
    finer = accuracy.finer_contact(branch.contact, ratio)
    exact = Corrector(finer, Form(), tolerance=1e-10)
    found, trusted = [], []
    for point in branch:
        if point.event == "fold":
            continue
        better = exact.solve(refined(branch.contact, finer, point.state), point.controls,
                             point.load, COLD)
        numbers = []
        for contact, its in ((branch.contact, point), (finer, better)):
            measurement = Measurement(contact, its)
            conjugate = [displacement if control == "force" else force for control, displacement,
                         force in zip(its.controls, its.displacements, its.forces)]
            numbers.append(np.array([conjugate[0], measurement.contact_area(), measurement.mean(1),
                                     conjugate[1] if conjugate[1:] else 0.0]))
        estimate = estimator(point)
        found.append([estimate[:4], abs(numbers[0] - numbers[1]) / np.maximum(abs(numbers[0]),
                                                                              1.0)])
        trusted.append(estimate.trusted)
        branch.corrector.account()
    return np.array(found), np.array(trusted)


def honest(found, least=1e-9):
    """Which estimates are within a factor 3 of errors that are not rounding."""
    estimates, errors = np.maximum(found, least).transpose(1, 0, 2)
    return (estimates < 3 * errors) & (estimates > errors / 3)


@pytest.mark.parametrize("points", [128, 192])
def test_estimates_of_normal_paths_are_within_a_factor_three(points):
    load = Load(start="normal_displacement=2", path="normal_displacement=-0.5; normal_force=1")
    found, trusted = errors_against(Scene(points=points, **LINE), load, 8)
    assert trusted.all() and len(found) > 10 and honest(found).all()
    assert found[:, 1, :2].max() > 1e-5


@pytest.mark.parametrize("friction", [0.5, 1.0])
def test_estimates_of_sheared_paths_are_within_a_factor_three(friction):
    scene = Scene(points=256, residual_friction=friction, height=4.0, **LINE)
    found, trusted = errors_against(scene, Load(start="normal_displacement=1.5",
                                                path="tangential_displacement=3"), 8)
    assert len(found) > 15 and trusted.all()
    assert np.mean(honest(found)) >= 0.95


def test_estimates_tell_of_the_force_that_holds_a_thin_layer_back():
    """It is that of the top less the mean slip, nearly alike: the error of the slip says nothing of
    it. A layer thinner than the spacing leaves the corner of the law in the traction."""
    scene = Scene(points=256, residual_friction=0.5, height=0.03, poisson=0.3,
                  **{**LINE, "normal_maugis": 3.0})
    for path in ("normal_force=5; tangential_displacement=0.3",
                 "normal_force=5; tangential_force=0.8"):
        found, trusted = errors_against(scene, Load(start="normal_displacement=0.3", path=path), 8)
        slip, tangential = found[-5:, 0, 2], found[-5:, 0, 3]
        assert trusted[-5:].all() and honest(found[:, :, 3:]).mean() >= 0.9
        if "tangential_d" in path:
            assert (tangential > 1e-5).all() and (tangential > 10.0 * slip).all()


def test_estimates_on_an_interface_of_two_dimensions():
    scene = Scene(dimension=2, geometry="sphere", points=32, period=8.0, normal_maugis=1.5,
                  height=3.0)
    load = Load(path="normal_displacement=0.7; tangential_displacement_x=0.5")
    found, trusted = errors_against(scene, load, 3, Steps(largest_step=0.5, initial_step=0.5))
    assert trusted.all() and honest(found).all()


def test_estimates_of_sheared_planes_are_within_a_factor_three():
    """Straight edges pass as many nodes at once: what corners of the law leave of the force does
    not average out along them, and is as large on half the spacing."""
    scene = Scene(dimension=2, geometry="cylinder", points=(64, 16), period=(12.0, 6.0),
                  normal_maugis=2.0, residual_friction=0.5, poisson=0.3, height=5.0)
    load = Load(start="normal_displacement=2", path="tangential_displacement_x=20")
    found, trusted = errors_against(scene, load, 4, Steps(largest_step=5.0, initial_step=5.0))
    assert trusted.all() and len(found) > 10
    assert np.mean(honest(found)) >= 0.95


@pytest.mark.parametrize("edges", ["warn", "pad", "periodic"])
@pytest.mark.parametrize("shape", [(40,), (20, 30)])
def test_finer_grids_have_measured_heights_as_interpolation_has_them(tmp_path, shape, edges):
    """The surface that an estimate compares with is that of a run on more points: with the noise of
    its nodes, without waves that ring where heights step."""
    heights = np.random.default_rng(2).standard_normal(shape)
    heights += 0.0 if edges == "periodic" else np.linspace(0.0, 40.0, shape[0]).reshape(
        -1, *[1] * (len(shape) - 1))
    np.save(tmp_path / "map.npy", heights)
    typed = dict(geometry="file", geometry_file=str(tmp_path / "map.npy"), period=20.0,
                 heights_edges=edges.replace("periodic", "warn"))
    contact = Contact(Scene.typed(**typed))
    ratio = 3
    finer = accuracy.finer_contact(contact, ratio)
    points = tuple(ratio * n for n in contact.grid.shape)
    other = Contact(Scene.typed(**typed, points=points if shape[1:] else points[0],
                                heights_fit="interpolate"))
    difference = finer.initial_gap - other.initial_gap
    np.testing.assert_allclose(difference, difference.mean(), atol=1e-9)
    every = (slice(None, None, ratio),) * len(shape)
    np.testing.assert_allclose(finer.initial_gap[every], contact.initial_gap, atol=1e-9)


@pytest.mark.parametrize("edges, there", [("detrend", True), ("pad", True), ("detrend", False)])
def test_finer_grids_have_interpolated_heights_as_their_map_has_them(tmp_path, edges, there):
    """Not those at the nodes interpolated once more, unless their map is gone."""
    path = tmp_path / "map.npy"
    np.save(path, np.random.default_rng(2).standard_normal((21, 19)).cumsum(axis=0))
    typed = dict(geometry="file", geometry_file=str(path), period=20.0, heights_edges=edges,
                 heights_fit="interpolate")
    contact = Contact(Scene.typed(**typed, points=(32, 36)))
    other = Contact(Scene.typed(**typed, points=(96, 108)))
    if not there:
        path.unlink()
    finer = accuracy.finer_contact(contact, 3)
    np.testing.assert_allclose(finer.initial_gap[::3, ::3], contact.initial_gap, atol=1e-9)
    difference = finer.initial_gap - other.initial_gap
    assert (np.ptp(difference) < 1e-9) == there


def test_a_grid_that_does_not_resolve_the_law_is_not_trusted():
    scene = Scene(points=512, period=100.0, normal_maugis=5.0)
    point = next(iter(Branch(scene, Load(start="normal_displacement=2",
                                         path="normal_displacement=2"))))
    assert not accuracy.Estimator(Branch(scene, PRESS).contact)(point).trusted


def test_a_point_that_the_finer_grid_does_not_have_is_not_trusted(monkeypatch):
    branch = Branch(Scene(points=128, **LINE), PRESS)
    point = next(iter(branch))

    def fails(*arguments):
        raise NotConverged("no such point")

    monkeypatch.setattr(accuracy.Reference, "solve", fails)
    errors = accuracy.Estimator(branch.contact)(point)
    assert not errors.trusted and np.isnan(errors[:3]).all() and errors.largest() == 0.0


def test_an_estimate_from_another_branch_is_not_trusted(monkeypatch):
    """The finer grid's solve ended far from where it began: before the fold of a pull-off there are
    two states at a load."""
    branch = Branch(Scene(points=128, **LINE), PRESS)
    point, solve = next(iter(branch)), accuracy.Reference.solve
    estimator = accuracy.Estimator(branch.contact)
    assert estimator(point).trusted
    monkeypatch.setattr(accuracy.Reference, "solve", lambda self, guess, controls,
                        load: solve(self, guess, controls, load + 2.0))
    away = accuracy.Estimator(branch.contact)(point)
    assert not away.trusted and away[0] > 0.01


def test_tractions_whose_waves_do_not_fall_are_not_trusted(monkeypatch):
    """What varies from node to node on the finer grid, too, would show on a still finer one."""
    branch = Branch(Scene(points=128, **LINE), PRESS)
    point, solve = next(iter(branch)), accuracy.Reference.solve

    def rough(self, guess, controls, load):
        exact = solve(self, guess, controls, load)
        noise = 1e-3 * np.random.default_rng(3).standard_normal(exact.state.displacement.shape)
        return replace(exact, state=replace(exact.state, displacement=exact.state.displacement
                                            + noise))

    assert accuracy.Estimator(branch.contact)(point).trusted
    monkeypatch.setattr(accuracy.Reference, "solve", rough)
    errors = accuracy.Estimator(branch.contact)(point)
    assert not errors.trusted and errors.largest() < 0.01


def test_sheared_contacts_are_refined_more_than_twice():
    """Slip fronts have corners of the law: their errors fall slowly, and twice the points show a
    part of them only."""
    line = Scene(points=128, **LINE)
    plane = Scene(dimension=2, geometry="sphere", points=16, period=8.0, normal_maugis=1.0)
    for scene, path, expected in ((line, "normal_displacement=0.5", [2]),
                                  (line, "tangential_displacement=0.5", [4]),
                                  (plane, "normal_displacement=0.1", [2]),
                                  (plane, "tangential_displacement_x=0.1", [3])):
        branch = Branch(scene, Load(path=path))
        *_, point = branch
        estimator = accuracy.Estimator(branch.contact)
        estimator(point)
        assert [round(system.contact.grid.shape[0] / branch.contact.grid.shape[0])
                for system, _ in estimator._finer.values()] == expected


SCENES = {"line": (Scene(points="auto", accuracy=1e-5, **LINE), "normal_displacement=1"),
          "sharp line": (Scene(points="auto", accuracy=1e-6, normal_maugis=7.0, period=30.0),
                         "normal_force=1"),
          "soft line": (Scene(points="auto", accuracy=1e-6, normal_maugis=0.4, period=30.0),
                        "normal_displacement=3"),
          "thin layer": (Scene(points="auto", accuracy=1e-5, normal_maugis=2.0, period=20.0,
                               height=0.5, poisson=0.3), "normal_displacement=0.5"),
          "sinusoid": (Scene(points="auto", accuracy=1e-6, geometry="sinusoid", period=6.0,
                             normal_maugis=1.0), "normal_displacement=0.8"),
          "sphere": (Scene(points="auto", accuracy=1e-3, dimension=2, geometry="sphere", period=8.0,
                           normal_maugis=1.7), "normal_displacement=0.3"),
          "sheared": (Scene(points="auto", accuracy=1e-5, height=4.0, **LINE),
                      "normal_displacement=1; tangential_displacement=1.5"),}


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=pytest.mark.study) if name == "sharp line" else name
    for name in SCENES])
def test_chosen_grids_reach_the_accuracy_against_four_times_finer_ones(name):
    scene, path = SCENES[name]
    load = Load(path=path)
    grid = chosen(scene, load)
    found, trusted = errors_against(grid, load, 4)
    assert trusted.all() and found[:, 1, :2].max() <= scene.accuracy
    if min(grid.shape) >= 64:  # nor is it a waste: four times coarser would not do
        coarse, _ = errors_against(grid_choice.on(scene, tuple(n // 4 for n in grid.shape)), load,
                                   8)
        assert coarse[:, 1, :2].max() > scene.accuracy


@pytest.mark.parametrize("seed", range(3))
def test_no_grid_is_chosen_that_the_program_warns_of(seed):
    """However loose the accuracy, on lines and planes, in cells and alone."""
    random, seen = np.random.default_rng(seed), 0
    for _ in range(25):
        dimension, sheared = int(random.integers(1, 3)), bool(random.integers(2))
        alone = random.random() < 0.2
        given = {"dimension": dimension,
                 "geometry": random.choice([("cylinder", "sphere")[dimension - 1],
                                            *["sinusoid"] * (not alone)]), "period": np.inf if alone
                 else random.uniform(8.0, 30.0), "accuracy": 10.0 ** random.uniform(-6.0, -0.5),
                 "normal_maugis": 10.0 ** random.uniform(-0.5, 0.8),
                 "tangential_maugis": 10.0 ** random.uniform(-1.0, 0.8),
                 "law": random.choice(["modified", "mcgarry"]), "poisson": random.uniform(0.0, 0.5),
                 "height": np.inf}
        slide = f"; tangential_displacement{'_x' * (dimension - 1)}=1" if sheared else ""
        load = Load(path=f"normal_force=1{slide}")
        try:
            grid = chosen(Scene(points="auto", residual_friction=random.random(), **given), load)
        except InputError as error:
            assert "memory" in str(error)
            continue
        seen += 1
        assert resolution_warning(grid, any(tangential_legs(grid, load))) is None
    assert seen > 15


def test_where_nothing_varies_the_fewest_points_do():
    flat = chosen(Scene(points="auto", geometry="flat", period=10.0), PRESS)
    cylinder = chosen(Scene(points="auto", dimension=2, accuracy=1e-3, period=(20.0, 5.0),
                            normal_maugis=2.0), PRESS)
    assert flat.shape == (grid_choice.FEWEST,)
    assert cylinder.shape[1] == grid_choice.FEWEST and cylinder.shape[0] > 2 * grid_choice.FEWEST
    assert "32" in reason(flat, PRESS)


@pytest.mark.parametrize("count", [33, 100, 1000, 1025, 5000, 7000])
def test_points_have_small_prime_factors_and_coarser_grids(count):
    points = grid_choice._nice(count)
    assert count <= points <= 4 / 3 * count and points % 4 == 0
    odd = points // (points & -points)
    assert odd in (1, 3, 5)


def test_prediction_falls_with_the_points_and_the_next_grid_is_finer():
    scene = Scene(points=256, accuracy=1e-8, **LINE)
    errors = [predicted(scene, False, 0, n) for n in (64, 128, 256, 512)]
    assert errors == sorted(errors, reverse=True)
    assert 256 < next_grid(scene, PRESS, 1e-7).points <= 1024


def test_accuracy_beyond_memory_says_what_it_takes_and_what_can_be_had(monkeypatch):
    monkeypatch.setattr(grid_choice, "memory", lambda: 0.8 * 3e8)
    scene = Scene(points="auto", dimension=2, geometry="sphere", period=12.0, normal_maugis=4.0)
    with pytest.raises(InputError) as error:
        chosen(scene, PRESS)
    sentence = str(error.value)
    assert ("-scene_accuracy is '1e-06'" in sentence and "GB" in sentence and "best" in sentence
            and "\n" not in sentence)
    best = float(sentence.split("-scene_accuracy ")[2].split(",")[0])
    small = chosen(Scene(points="auto", accuracy=best, dimension=2, geometry="sphere", period=12.0,
                         normal_maugis=4.0), PRESS)
    assert memory_needed(small, PRESS, small.shape) <= 0.8 * 3e8
    monkeypatch.setattr(grid_choice, "memory", lambda: 1e3)
    with pytest.raises(InputError, match="no grid"):
        chosen(scene, PRESS)


def test_memory_is_that_of_the_window():
    load = Load(path="normal_force=2")
    parts = [grid_choice.window_part(Scene(points="auto", normal_maugis=3.0, period=period), load)
             for period in (5.0, 50.0, 500.0)]
    assert parts[0] == 1.0 and 0.05 < parts[1] < 0.5 and parts[2] < 0.2 * parts[1]
    still = Load(start="normal_displacement=2",
                 path="normal_displacement=hold, tangential_displacement=1")
    assert grid_choice.window_part(Scene(points="auto", normal_maugis=3.0, period=50.0),
                                   still) > 0.05


def test_both_parts_of_a_cell_take_one_contact(monkeypatch):
    made = []

    def counted(scene):
        made.append(scene)
        return Contact(scene)

    monkeypatch.setattr(grid_choice, "Contact", counted)
    load = Load(path="normal_force=2")
    for period in (40.0, 41.0):
        parts = []
        for part in (grid_choice.window_part, grid_choice.active_part):
            # as `contactsnes info` asks: with scenes that are equal, not the same
            parts.append(part(Scene(points="auto", normal_maugis=3.0, period=period), load))
        assert 0.0 < parts[1] <= parts[0] < 1.0
    assert [scene.period for scene in made] == [40.0, 41.0]


@pytest.mark.parametrize("value", [1e-14, 1e-11])
def test_accuracy_below_what_solves_leave_is_refused(value):
    with pytest.raises(InputError, match="GB.*best"):
        chosen(Scene(points="auto", accuracy=value, **LINE), PRESS)


def test_accuracy_without_effect():
    names = {"scene_accuracy"}
    assert [name for name, _ in ineffective(Scene(), PRESS, names)] == ["scene_accuracy"]
    assert not ineffective(Scene(), PRESS, names, output=Output(errors=True), estimates=True)


ROOT = Path(__file__).resolve().parents[2]
RUN = ["run", "-scene_normal_maugis", "2", "-scene_period", "20", "-load_path",
       "normal_displacement=1", "-continuation_largest_step", "0.25"]


def run(folder, *arguments, before="pass"):
    """What a process of the command says, which ends well and leaves run.h5 in a folder;
    ``before``: Python to execute first."""
    code = (f"import sys; {before}; from contactsnes.commands.cli import main; "
            "sys.exit(main(sys.argv[1:]))")
    words = [*RUN, *arguments, "-archive_file", str(folder / "run.h5")]
    done = subprocess.run([sys.executable, "-c", code, *words],
                          env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True,
                          text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_run_on_a_chosen_grid_keeps_its_errors_and_can_be_resumed(tmp_path):
    said = run(tmp_path, "-scene_points", "auto", "-scene_accuracy", "1e-4")
    assert "the grid: " in said and "errors " in said
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        points, options = int(file["scene"].attrs["points"]), file.attrs["options"]
        branch = {name: column[:] for name, column in file["branch"].items()}
        assert file["branch/error_contact_area"].attrs["unit"] == "relative"
        file.attrs["complete"] = False
    assert "-scene_points auto" in options and points % 4 == 0
    assert ((branch["error_normal_force"] <= 1e-4).all()
            and (branch["error_contact_area"] <= 1e-4).all())
    assert (branch["error_trusted"] == 1).all()
    # Resumed on the grid of the archive, though another one would be chosen now.
    run(tmp_path, "-scene_points", "auto", "-scene_accuracy", "1e-3", "-archive_resume")
    with h5py.File(tmp_path / "run.h5") as file:
        assert file["scene"].attrs["points"] == points and file.attrs["complete"]
        assert len(file["branch/leg"]) == len(branch["leg"])


def test_a_grid_that_misses_is_refined_and_the_path_begins_anew(tmp_path):
    lax = ("import contactsnes.branch.grid_choice as g; real = g.predicted; "
           "g.predicted = lambda *words: 1e-2 * real(*words)")
    said = run(tmp_path, "-scene_points", "auto", "-scene_accuracy", "1e-6", "-archive_fields",
               "all", before=lax)
    assert "the path begins anew with" in said
    with h5py.File(tmp_path / "run.h5") as file:
        assert file["branch/leg"][0] == 0 and (file["branch/leg"][1:] == 1).all()
        assert max(file["branch/error_contact_area"][:].max(),
                   file["branch/error_normal_force"][:].max()) <= 1e-6
        assert file["fields/displacement"].shape[-1] == file["scene"].attrs["points"]


def test_errors_on_a_given_grid_are_estimated_on_request(tmp_path):
    said = run(tmp_path, "-scene_points", "96", "-archive_errors", "-scene_accuracy", "1e-6")
    assert "missed at" in said
    with h5py.File(tmp_path / "run.h5") as file:
        assert (file["scene"].attrs["points"] == 96 and file["branch/error_contact_area"][:].max()
                > 1e-6)


def test_without_estimates_there_are_no_columns_for_them(tmp_path):
    assert "-scene_accuracy has no effect" in run(tmp_path, "-scene_points", "96",
                                                  "-scene_accuracy", "1e-6")
    with h5py.File(tmp_path / "run.h5") as file:
        assert not [name for name in file["branch"] if name.startswith("error")]


class Lines:
    """Stands for a Progress."""

    def __init__(self):
        self.columns, self.said = {"event": "event"}, []
        self.log = self.said.append


def test_too_coarse_names_the_grid_to_take(monkeypatch):
    branch, lines = Branch(Scene(points=64, accuracy=1e-6, **LINE), PRESS), Lines()
    point = next(iter(branch))
    with pytest.raises(TooCoarse, match="normal_displacement") as found:
        accuracy.Watch(branch, True, lines).row(point)
    assert found.value.scene.points > 64 and found.value.error > 1e-6 and not lines.said
    # No finer grid where the last one did not help, where none fits, and where the grid is given.
    for auto, missed, room, why in ((True, (found.value,), 1e12, "snes_atol"),
                                    (True, (), 1e3, "memory"),
                                    (False, (), 1e12, "above -scene_accuracy 1e-06")):
        monkeypatch.setattr(grid_choice, "memory", lambda room=room: room)
        lines = Lines()
        watch = accuracy.Watch(branch, auto, lines, missed)
        rows = [watch.row(point), watch.row(point)]
        assert rows[0]["error_trusted"] in (0, 1) and watch.above == 2
        assert len(lines.said) == 1 and why in lines.said[0]
        assert "missed at 2 of 2 points" in watch.summary()[1]


def test_estimates_of_a_body_that_nothing_holds_are_not_trusted():
    """It slid, so that nothing attracts it any more, and nothing presses it."""
    scene = Scene(points=96, period=40.0, normal_maugis=0.8, tangential_maugis=0.3, height=np.inf)
    branch = Branch(scene, Load("normal_displacement=1", "tangential_displacement=20; "
                                "normal_force=0"), Steps(initial_step=20.0, largest_step=20.0))
    watch = accuracy.Watch(branch, False, Lines())
    free, trusted = zip(*((branch.corrector.neutral(point) is not None,
                           watch.row(point)["error_trusted"]) for point in branch
                          if point.event != "fold"))
    assert free[-1] and not any(free[:-1]) and trusted == (1,) * (len(free) - 1) + (0,)


def test_rounding_of_a_component_that_nothing_drives_leaves_trust():
    """Its spectrum does not fall, and was looked at as that of the others."""
    scene = Scene(dimension=2, points=64, period=10.0, normal_maugis=0.8, tangential_maugis=0.5,
                  geometry="sphere", tangential="on")
    branch = Branch(scene, Load("normal_displacement=0", "normal_displacement=0.2"))
    point, estimator = next(iter(branch)), accuracy.Estimator(branch.contact)
    assert len(point.controls) == 3 and estimator(point).trusted
    finer, _ = estimator._on(2)
    exact = finer.solve(refined(branch.contact, finer.contact, point.state), point.controls,
                        point.load)
    cell = finer.contact.extended(exact.state)
    draw = np.random.default_rng(0)
    for size, trusted in ((1e-14, True), (1e-4, False)):
        cell[1:] = size * draw.standard_normal(cell[1:].shape)
        widest = finer.contact.widest
        noisy = exact.changed(state=State(widest, widest.take(cell), exact.state.means))
        assert estimator._decays(noisy, finer.contact) == trusted
