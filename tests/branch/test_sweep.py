"""Sweeps, branches that begin at a point of an archive, and what objects say of themselves."""

import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import processes
import pytest

from contactsnes import Branch, Form, Load, Scene, Steps, read, reference, sweep
from contactsnes.branch import sweep as sweeps
from contactsnes.branch.sweep import Sweep, _cases, _is_done, _listed, _scene_words, _stems
from contactsnes.contact import observables
from contactsnes.options.fields import InputError, as_text
from contactsnes.output import archive as archives
from contactsnes.output.layout import Column

SMALL = dict(points=128, period=20.0, normal_maugis=1.0)
SI = dict(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
          contact_modulus=2e6, radius=0.01, range_normal=1.3e-6, range_tangential=1.3e-6,
          period=0.0023, height=0.2, points=128)


@pytest.fixture
def forks(monkeypatch, tmp_path):
    """Runs of sweeps are forks of a process that has imported what they need."""
    def run(words, _):
        return processes.run(*words[1:], folder=tmp_path)

    monkeypatch.setattr("contactsnes.branch.sweep.children.run", run)


def kept(branch, path, fields="all"):
    """The points of a branch, kept in an archive as a run does."""
    table = observables.table(branch.scene)
    made = archives.Archive.create(
        path, scene=branch.attributes(), versions={}, fields=fields,
        options=f'-load_path "{branch.load.path}"' + (
            f'\n-load_start "{branch.load.start}"' if branch.load.start else ""),
        columns={name: Column(row.unit, row.kind, row.names) for name, row in table.items()},
        components=branch.scene.components,
        **(observables.frame(branch.contact) if fields != "none" else {}))
    points = []
    for point in branch:
        measurement = observables.Measurement(branch.contact, point)
        made.append({name: row.function(measurement) for name, row in table.items()},
                    branch.packed(point), *(measurement.fields() if fields != "none" else ()))
        points.append(point)
    made.finish()
    return points


@pytest.mark.parametrize("scene, force, shear", [(Scene(**SMALL), 2.0, 20.0),
                                                 (Scene.typed(**SI), 5.0, 3e-5)])
def test_a_branch_begins_at_any_point_of_an_archive(tmp_path, scene, force, shear):
    load = Load(path=f"normal_force={force}; tangential_displacement={shear}")
    points = kept(Branch(scene, load), tmp_path / "run.h5")
    place = next(i for i, point in enumerate(points) if point.leg == 2) + 2
    back = Branch.restart(tmp_path / "run.h5", "tangential_displacement=0", place)
    assert back.scene == scene
    first, *_, last = back
    # The same equilibrium, found without an iteration, and back where the shear began.
    assert first.spent["nonlinear_iterations"] == 0 and first.controls == points[place].controls
    np.testing.assert_allclose(first.forces, points[place].forces, rtol=1e-9)
    pressed = next(point for point in reversed(points) if point.leg == 1)
    assert last.displacements[0] == pytest.approx(pressed.displacements[0], rel=1e-7)
    assert abs(last.forces[1]) < 1e-7


@pytest.mark.parametrize("crop", ["", "8:24"])
def test_a_branch_begins_on_a_map_whose_size_was_given(tmp_path, crop):
    np.save(tmp_path / "map.npy", 1e-6 * np.cos(2 * np.pi * np.arange(32) / 32))
    others = ("radius", "period", "points")
    given = {name: value for name, value in SI.items() if name not in others}
    scene = Scene.typed(**given, geometry="file", geometry_file=str(tmp_path / "map.npy"),
                        heights_size=1e-3, heights_crop=crop)
    points = kept(Branch(scene, Load(path="normal_displacement=1e-6")), tmp_path / "run.h5", "none")
    back = Branch.restart(tmp_path / "run.h5", "normal_displacement=0", -1)
    assert back.scene.period == pytest.approx(scene.period, rel=1e-12)
    assert next(iter(back)).forces[0] == pytest.approx(points[-1].forces[0], rel=1e-9)
    np.save(tmp_path / "map.npy", 1.01e-6 * np.cos(2 * np.pi * np.arange(32) / 32))
    with pytest.raises(InputError, match="-scene_geometry_file is .*map.npy', which is another fil"
                                         "e than when .*run.h5 was made"):
        Branch.restart(tmp_path / "run.h5", "normal_displacement=0", -1)


def test_without_fields_a_branch_begins_at_the_last_points(tmp_path):
    points = kept(Branch(Scene(**SMALL), Load(path="normal_displacement=1")), tmp_path / "run.h5",
                  "none")
    first = next(iter(Branch.restart(tmp_path / "run.h5", "normal_force=0", -3)))
    assert first.forces[0] == pytest.approx(points[-3].forces[0], rel=1e-9)
    with pytest.raises(InputError, match="no state of point 0.*-archive_fields all"):
        Branch.restart(tmp_path / "run.h5", "normal_force=0", 0)
    with pytest.raises(InputError, match="has 2[0-9]: give 0 to 2"):
        Branch.restart(tmp_path / "run.h5", "normal_force=0", 99)


def test_a_point_says_what_it_is():
    *points, last = Branch(Scene(**SMALL), Load(path="normal_displacement=-6", stop="pull_off"),
                           Steps(at_fold="stop"))
    assert points[0].event is None and last.event in ("fold", "pull_off")
    text = repr(last)
    assert text.startswith("<Point: leg 1") and last.event in text and len(text) < 300
    assert "None" not in repr(points[0])
    assert f"displacement[0] {last.displacements[0]:.6g}* u_n,r" in text


def test_a_point_of_a_scene_in_si_is_told_in_si():
    scene = Scene.typed(**SI)
    point = next(iter(Branch(scene, Load(path="normal_force=0.01"))))
    size = scene.scale("u_n,r")[0]
    assert f"displacement[0] {size * point.displacements[0]:.6g}* m" in repr(point)
    assert "N/m" in repr(point)


def test_scenes_say_what_makes_them():
    assert repr(Scene()) == "Scene()"
    scene = Scene(**SMALL)
    assert repr(scene) == "Scene(points=128, period=20.0, normal_maugis=1.0)"
    assert eval(repr(scene)) == scene
    in_si = Scene.typed(**SI)
    assert eval(repr(in_si)) == in_si and "period=0.0023" in repr(in_si)
    branch = Branch(scene, Load(path="normal_force=1"))
    assert repr(scene) in repr(branch) and "'normal_force=1'" in repr(branch)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_sweep_finds_what_theory_says_and_is_taken_up_again(tmp_path, jobs, monkeypatch):
    if jobs > 1:
        pytest.importorskip("joblib")
    load = Load(path="normal_displacement=-6", stop="pull_off")
    values = (0.5, 1.0)
    found = sweep(Scene(points=256, period=40.0), load, folder=tmp_path / "runs", jobs=jobs,
                  normal_maugis=values, progress=False)
    assert list(found) == list(values) and not found.failures
    theory = [reference.maugis_line_pull_off(value, 40.0)[0] for value in values]
    assert found.take("normal_force", min) == pytest.approx(theory, rel=0.15)
    assert "normal_maugis of 2 values: 2 runs" in repr(found)
    monkeypatch.setattr("contactsnes.branch.sweep.children.run", lambda *_: 1 / 0)
    again = sweep(Scene(points=256, period=40.0), load, folder=tmp_path / "runs", progress=False,
                  normal_maugis=values)
    assert np.array_equal(again.take("normal_force"), found.take("normal_force"))


@pytest.mark.usefixtures("forks")
def test_a_run_that_ends_early_says_why(tmp_path):
    found = sweep(Scene(**SMALL), Load(path="normal_force=1"), folder=tmp_path, progress=False,
                  load_path=["normal_force=-9", "normal_force=0.5"])
    assert list(found.failures) == ["normal_force=-9"]
    assert "no equilibrium" in found.failures["normal_force=-9"]
    assert found["normal_force=-9"].points > 1 and found["normal_force=0.5"].complete
    path = tmp_path / "load_path=normal_force=0.5.h5"
    words = {"archive_fields": "none", "load_path": "normal_force=0.5",
             **{f"scene_{name}": as_text(value) for name, value in SMALL.items()}}
    assert _is_done(path, words)
    assert not _is_done(path, {**words, "load_path": "normal_force=0.6"})
    assert read(path)["normal_force"][-1] == 0.5


@pytest.mark.parametrize("given, word", [
    (dict(normal_magis=[1]), "did you mean normal_maugis"),
    (dict(normal_maugis=[1, -1]), "-scene_normal_maugis is '-1'"), ({}, "needs values"),
    (dict(jobs=0, points=[128]), "jobs is '0'"),
    (dict(normal_maugis=[]), "normal_maugis is .*: give a list of its values"),
    (dict(normal_maugis=1.0), "normal_maugis is 1.0: give a list"),
    (dict(law="mcgarry"), "law is 'mcgarry': give a list")])
def test_a_sweep_refuses_before_it_runs(tmp_path, given, word):
    with pytest.raises(InputError, match=word):
        sweep(Scene(**SMALL), Load(path="normal_force=1"), folder=tmp_path / "none", **given)
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("given, word", [
    (dict(load_path=["normal_displacement=1", "normal_displacment=1"]), "did you mean normal_disp"),
    (dict(load_pth=["normal_force=1"]), "load_pth is no option: did you mean load_path"),
    (dict(continuation_largest_step=[0.1, -1]), "-continuation_largest_step is '-1'"),
    (dict(archive_overwrite=[True]), "exclude each other"),
    (dict(points=[128], fields="al"), "-archive_fields is 'al'")])
def test_options_that_are_none_of_scenes_are_refused_before_it_runs_too(tmp_path, given, word):
    with pytest.raises(InputError, match=word):
        sweep(Scene(**SMALL), Load(path="normal_force=1"), folder=tmp_path / "none", **given)
    assert not (tmp_path / "none").exists()


@pytest.mark.usefixtures("forks")
def test_options_of_scenes_that_begin_as_others_do_vary(tmp_path):
    found = sweep(Scene(**SMALL), Load(path="normal_displacement=1"), folder=tmp_path,
                  progress=False, contact_threshold=[1.0, 2.0])
    assert not found.failures and np.diff(found.take("contact_area")) > 0.1


@pytest.mark.usefixtures("forks")
def test_what_another_run_has_left_in_the_folder_is_no_record(tmp_path):
    """A run that is refused has no points; those in a file of its name are of another one."""
    given = dict(folder=tmp_path, progress=False, points=[128])
    sweep(Scene(**SMALL), Load(path="normal_displacement=1"), **given)
    other = sweep(Scene(**SMALL), Load(path="normal_displacement=2; normal_force=1"), **given)
    assert "cannot be resumed" in other.failures[128]
    assert list(other) == [] and np.isnan(other.take("normal_force"))


@pytest.mark.usefixtures("forks")
def test_what_a_study_no_longer_names_is_another_run(tmp_path):
    """What was left out, a default now, was not looked at: points of another Poisson ratio, or of a
    path that ended earlier, were taken from the folder without a word."""
    given = dict(folder=tmp_path, progress=False, points=[128])
    scene, pulled = Scene(**SMALL, poisson=0.3, height="inf"), Load(path="normal_displacement=-6")
    ended = sweep(scene, replace(pulled, stop="pull_off"), **given)
    assert ended.take("normal_displacement") > -5.0 and not ended.failures
    other = sweep(replace(scene, poisson=0.5), pulled, **given)
    assert "poisson is 0.3 there and 0.5 here" in other.failures[128] and list(other) == []
    whole = sweep(scene, pulled, **given)
    assert whole.take("normal_displacement") == -6.0 and not whole.failures


@pytest.mark.usefixtures("forks")
def test_files_that_have_changed_since_are_other_runs(tmp_path):
    heights = tmp_path / "heights.npy"
    given = dict(folder=tmp_path, progress=False, points=[128])
    for size, word in [(1, ""), (2, "heights_sha256")]:
        np.save(heights, size * np.cos(2 * np.pi * np.arange(128) / 128))
        found = sweep(Scene(**SMALL, geometry="file", geometry_file=str(heights)),
                      Load(path="normal_displacement=0.1"), **given)
        assert word in found.failures.get(128, "") and len(found) == (not word)


@pytest.mark.usefixtures("forks")
def test_what_complete_runs_lack_is_a_failure_and_their_points_are_there(tmp_path):
    given = dict(folder=tmp_path, progress=False, points=[128])
    load = Load(path="normal_displacement=1")
    sweep(Scene(**SMALL), load, **given)
    for fields in ("all", "last"):
        asked = sweep(Scene(**SMALL), load, fields=fields, **given)
        assert f"without what -archive_fields {fields} keeps" in asked.failures[128]
        assert asked[128].points > 1
    assert not sweep(Scene(**SMALL), load, **given).failures


def test_a_run_that_is_killed_says_by_what(tmp_path, monkeypatch):
    for number, word in [(signal.SIGKILL, "memory"), (signal.SIGSEGV, "SIGSEGV"), (99, "99"),
                         (-128 - signal.SIGTERM, "interrupted by SIGTERM")]:
        monkeypatch.setattr("contactsnes.branch.sweep.children.run",
                            lambda words, _, number=number:
                            subprocess.CompletedProcess(words, -number, "", ""))
        found = sweep(Scene(**SMALL), Load(path="normal_force=1"), folder=tmp_path, progress=False,
                      normal_maugis=[1])
        assert word in found.failures[1] and not found


TERM = """
import os, signal, sys, threading, time
from contactsnes.system import children

def end():
    while not children._running:
        time.sleep(0.01)
    print(*(child.pid for child in children._running), flush=True)
    os.kill(os.getpid(), signal.SIGTERM)

threading.Thread(target=end, daemon=True).start()
with children.ended_with_this():
    children.run([sys.executable, "-S", "-c", "import time; time.sleep(600)"], dict(os.environ))
"""


def test_a_run_ends_with_its_sweep():
    """Terminated, the program left its runs behind, which went on."""
    done = subprocess.run([sys.executable, "-c", TERM], capture_output=True, text=True,
                          timeout=300, check=False)
    assert done.returncode == -signal.SIGTERM, done.stderr
    until = time.monotonic() + 60.0
    while time.monotonic() < until:
        try:
            os.kill(int(done.stdout), 0)
        except ProcessLookupError:
            return
        if "\nState:\tZ" in Path(f"/proc/{int(done.stdout)}/status").read_text("utf-8"):
            return  # nobody has asked for its status
        time.sleep(0.01)
    raise AssertionError("it goes on")


@pytest.mark.usefixtures("forks")
def test_a_damaged_archive_is_a_failure_of_its_run_only(tmp_path):
    (tmp_path / "points=128.h5").write_text("none")
    found = sweep(Scene(**SMALL), Load(path="normal_displacement=1"), folder=tmp_path,
                  progress=False, points=[128, 64])
    assert list(found) == [64] and "cannot be read as an HDF5 file" in found.failures[128]
    assert (tmp_path / "points=128.h5").read_text() == "none"


@pytest.mark.parametrize("name", ["run.h5", "run.h5/deeper", "a\0b"])
def test_a_folder_that_cannot_be_made_is_told(tmp_path, name):
    (tmp_path / "run.h5").write_text("an archive")
    with pytest.raises(InputError, match="folder is '.*', which cannot be made"):
        sweep(Scene(**SMALL), Load(path="normal_displacement=1"), folder=tmp_path / name,
              progress=False, points=[64])
    assert (tmp_path / "run.h5").read_text() == "an archive"


@pytest.mark.usefixtures("forks")
def test_runs_have_archives_of_their_own_however_long_their_values(tmp_path):
    """Names of files hold no more than 255 bytes, and not every sign."""
    shared = ["normal_force=1; tangential_force=0.1", "normal_force=1, tangential_force=0.1"]
    long = ["; ".join(f"normal_displacement={leg}" for leg in range(last)) for last in (20, 21)]
    cases = _cases({"load_path": [*shared, *long, "normal_force=1"]})
    names = _stems(cases)
    assert len(set(names.values())) == len(cases) and names == _stems(cases)
    assert max(len(name.encode()) for name in names.values()) < 240
    assert names["normal_force=1"] == "load_path=normal_force=1"
    one = _stems(_cases({"height": ["inf", float("inf")]}))
    assert set(one.values()) == {"height=inf"}
    found = sweep(Scene(**SMALL), Load(), folder=tmp_path, progress=False, load_path=shared)
    assert not found.failures and found[shared[0]].points > found[shared[1]].points


def test_a_sweep_of_several_processes_is_refused(monkeypatch, tmp_path):
    """Each would run all of it, in the same files."""
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    with pytest.raises(InputError, match="started as 2 processes, but sweep starts those of its "
                                         "runs itself"):
        sweep(Scene(**SMALL), Load(path="normal_displacement=1"), normal_maugis=[1.0],
              folder=tmp_path / "study")
    assert not (tmp_path / "study").exists()


def test_values_of_a_sweep_are_numbers_or_tuples():
    """Those of an array in two dimensions ended in a TypeError."""
    assert _listed("points", np.array([[64, 32], [32, 32]])) == [(64, 32), (32, 32)]
    assert _listed("points", [[64, 32], 16]) == [(64, 32), 16]
    with pytest.raises(InputError, match="^points is .*: give a list of its values"):
        _listed("points", [{"a": 1}])


def test_numbers_of_a_sweep_are_as_many_as_its_values(tmp_path):
    """Of values that are given twice there was one, and others stood beside another value."""
    study = Sweep({"normal_maugis": [1.0, 1.0, 2.0]}, tmp_path)
    study._records.update({1.0: {"force": np.array([3.0])}, 2.0: {"force": np.array([4.0])}})
    assert list(study.take("force")) == [3.0, 3.0, 4.0]


def test_threads_of_a_sweep_read_nothing(tmp_path, monkeypatch):
    """One that read an archive when the program was interrupted kept HDF5's lock for ever."""
    pytest.importorskip("joblib")
    asked = []
    monkeypatch.setattr(sweeps, "_is_done",
                        lambda *_: not asked.append(threading.current_thread()))
    assert not sweep(Scene(**SMALL), Load(path="normal_force=1"), folder=tmp_path, jobs=2,
                     normal_maugis=[1.0, 2.0], progress=False)
    assert asked == [threading.main_thread()] * 2


def test_names_of_archives_are_those_of_files():
    case = {"points": np.int64(64), "geometry_file": "a/b c.npy"}
    assert _stems({0: case})[0] == "points=64-geometry_file=a_b_c.npy"


def test_a_sweep_keeps_what_a_scene_was_made_of():
    """Strengths stay where the work varies, Young's modulus where the Poisson ratio does, and what
    is swept takes the place of what fixes the same."""
    given = dict(units="si", radius=0.004, young_modulus=1.3e6, work_of_adhesion_normal=0.05,
                 work_of_adhesion_tangential=0.02, adhesive_strength=21e3, range_tangential=4e-7,
                 height="inf", period=0.003)
    scene = Scene.typed(**given)
    assert f"adhesive_strength={21e3!r}" in repr(scene) and eval(repr(scene)) == scene
    other = _scene_words(scene, {"work_of_adhesion_normal": 0.1})
    assert float(other["scene_adhesive_strength"]) == 21e3 and "scene_range_normal" not in other
    assert "scene_contact_modulus" not in _scene_words(scene, {"poisson": 0.3})
    ranges = _scene_words(scene, {"range_normal": 1e-6})
    assert float(ranges["scene_range_normal"]) == 1e-6 and "scene_adhesive_strength" not in ranges
    assert "scene_contact_modulus" not in _scene_words(Scene.typed(**given), {"young_modulus": 2e6})
    # a scene made of another by `replace` has what follows only
    made = replace(scene, points=512)
    assert "young_modulus" not in repr(made)
    assert "scene_contact_modulus" not in _scene_words(made, {"young_modulus": 2e6})


@pytest.mark.parametrize("given, sentence", [
    (("normal_force=1",), "load is 'normal_force=1': give an object of contactsnes.Load, for"),
    ((Load(path="normal_force=1"), Form()), "steps is Form.*: give an object of contactsnes.Steps"),
    ((Load(path="normal_force=1"), None, Steps()), "form is Steps.*: give an object of")])
def test_arguments_in_the_place_of_others_are_refused(given, sentence):
    with pytest.raises(InputError, match=sentence):
        Branch(Scene(**SMALL), *given)
    with pytest.raises(InputError, match="scene is {}: give an object of contactsnes.Scene"):
        Branch({}, *given)


def test_a_geometry_that_is_none_is_told_in_one_line():
    with pytest.raises(InputError, match="give a function of the coordinates") as error:
        Branch(Scene(**SMALL), Load(path="normal_force=1"), geometry=np.zeros(128))
    assert "\n" not in str(error.value)
