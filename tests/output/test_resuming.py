"""Going on from an earlier run: what is compared, what may differ, and points on a path whose legs
end elsewhere."""

import hashlib
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import petsc4py
import pytest
from processes import call

petsc4py.init([])

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.output import reading, resuming  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene, Steps  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
LINE = Scene(points=128, normal_maugis=1.5, period=30.0, height=50.0, residual_friction=0.5)
pytestmark = pytest.mark.usefixtures("read_here")


# In Python


def followed(path, history=(), kind="natural", start=None, scene=LINE, size=0.4):
    steps = Steps(type=kind, initial_step=size, largest_step=size)
    return list(Branch(scene, Load(start=start, path=path), steps, history=history))


@pytest.fixture(scope="module")
def before():
    """Points of a path of two legs."""
    return followed("normal_displacement=1; tangential_displacement=1")


@pytest.mark.parametrize("kind", ["natural", "arclength"])
@pytest.mark.parametrize("done", [3, -1, None])
def test_longer_legs_are_followed_to_their_new_ends(before, kind, done):
    """The leg under way, or the last one, ends farther ahead: steps keep their length."""
    history = before[:done]
    number = history[-1].leg
    path = ["normal_displacement=1", "tangential_displacement=1"]
    path[number - 1] = path[number - 1].replace("=1", "=2")
    points, once = followed(";".join(path), history, kind), followed(";".join(path), (), kind)
    assert points[-1].load == pytest.approx(once[-1].load, abs=0.0) and points[-1].position == 1.0
    np.testing.assert_allclose(points[-1].forces, once[-1].forces, atol=1e-6)
    places = [point.load[number - 1] for point in [history[-1], *points] if point.leg == number]
    assert np.all(np.diff(places) > 0.0) and np.diff(places).max() <= 0.4 + 1e-9


def test_points_to_go_on_from_that_are_not_in_their_order_are_refused(before):
    """The newest first, they were gone on from at the oldest, as if the rest had been after it."""
    first = [point for point in before if point.leg == 1]
    for points in (before[::-1], first[::-1], [*first[1:], first[0]], [*before[-2:], *before[:2]]):
        with pytest.raises(InputError, match="not in their order along the path: give the oldest"):
            followed("normal_displacement=1; tangential_displacement=2", points)


@pytest.mark.parametrize("kind", ["natural", "arclength"])
def test_a_path_goes_on_after_every_point_of_its_jumps(kind):
    """From a fold to its jump, not to the fold again, and from a jump to a further event at its
    load, for which nothing is solved."""
    scene = Scene(points=128, normal_maugis=3.0, period=16.0, height=20.0)
    steps = Steps(type=kind, initial_step=1.0, largest_step=2.0)
    load = Load(start="normal_displacement=-3",
                path="normal_displacement=0.5; normal_displacement=-4")
    branch = Branch(scene, load, steps)
    points = list(branch)
    events = [point.event for point in points]
    assert [event for event in events if event] == ["fold", "jump", "fold", "jump", "pull_off"]
    assert points[-1].position == 1.0 and points[events.index("pull_off")].resolved == 0
    for done in (place + 1 for place, event in enumerate(events) if event in ("fold", "jump")):
        history = [branch.restored(branch.packed(point)) for point in points[max(0, done - 4):done]]
        rest = list(Branch(scene, load, steps, history=history))
        assert ([point.event for point in rest if point.event]
                == [event for event in events[done:] if event])
        ends = [(found[-1].forces[0], found[-1].dissipated_work) for found in (points, rest)]
        np.testing.assert_allclose(*ends, rtol=1e-6, atol=1e-8)
        assert ([(point.event, point.resolved) for point in rest if point.event]
                == [(point.event, point.resolved) for point in points[done:] if point.event])
        if events[done] == "jump":
            assert ((rest[0].load == history[-1].load).all()
                    and rest[0].forces == pytest.approx(points[done].forces, abs=1e-7))


def test_later_legs_may_be_added_and_changed(before):
    for path in ("normal_displacement=1; tangential_displacement=1; normal_displacement=0.5",
                 "normal_displacement=1; tangential_displacement=1; tangential_force=hold; "
                 "normal_displacement=0.5"):
        points = followed(path, before)
        assert (points and points[-1].leg == path.count(";") + 1
                and points[-1].displacements[0] == 0.5)
    done = [point for point in before if point.leg < 2]
    (*_, last) = followed("normal_displacement=1; normal_displacement=1.5", done)
    assert last.load[0] == 1.5 and last.leg == 2


@pytest.mark.parametrize("path, done, sentence",
                         [("normal_displacement=1", None, "reach leg 2, but -load_path has 1"),
                          ("normal_displacement=0.9; tangential_displacement=1", None,
                           "in leg 1 of -load_path, beyond its end"),
                          ("normal_displacement=1; tangential_displacement=0.5", None,
                           "in leg 2 of -load_path, beyond its end"),
                          ("normal_displacement=1; tangential_displacement=-1", None,
                           "in leg 2 of -load_path, behind its beginning"),
                          ("normal_displacement=2; tangential_displacement=1", None,
                           "leave leg 1 before it ends"),
                          (
    "normal_displacement=1; tangential_displacement=1, normal_displacement=3", None,
    "in leg 2 of -load_path, beside it"), ("normal_displacement=1; tangential_force=1", None,
                                           "are under displacement, displacement control in leg 2"),
                          ("normal_force=1; tangential_displacement=1", None, "control in leg 1"),
                          (
    "normal_displacement=1; normal_displacement=2; tangential_displacement=1", None,
    "leg 2 of -load_path, beside it"), ("normal_displacement=-1", 3,
                                        "in leg 1 of -load_path, behind its beginning")])
def test_points_that_are_not_on_the_path_are_refused(before, path, done, sentence):
    with pytest.raises(InputError, match=sentence):
        Branch(LINE, Load(path=path), history=before[:done])


def test_a_leg_that_was_put_between_is_refused(before):
    shifted = [replace(point, leg=3 * (point.leg == 2) or point.leg) for point in before]
    same = "normal_displacement=1; normal_displacement={}; tangential_displacement=1"
    assert followed(same.format("1"), shifted) == [] and followed(same.format("hold"),
                                                                  shifted) == []
    with pytest.raises(InputError, match="have none of leg 2, which moves"):
        Branch(LINE, Load(path=same.format("2")), history=shifted)


def test_a_leg_may_end_where_its_last_point_is(before):
    (last,) = Branch(LINE, Load(path=f"normal_displacement={float(before[2].load[0])!r}"),
                     history=before[2:3]).history
    assert before[2].position < 1.0 == last.position


def test_another_start_is_refused(before):
    with pytest.raises(InputError, match="in leg 0 of -load_path, beside it"):
        Branch(LINE, Load(start="normal_displacement=0.5", path="normal_displacement=1"),
               history=before[:1])


def test_points_of_another_version_are_refused(before):
    branch = Branch(LINE, Load(path="normal_displacement=1"))
    packed = branch.packed(before[0])
    assert branch.restored(packed).leg == 0
    del packed["event"]
    with pytest.raises(InputError, match="says nothing of event: it was kept by another version"):
        branch.restored(packed)


def test_a_restored_point_tells_what_it_told_but_costs(before):
    branch = Branch(LINE, Load(path="normal_displacement=1"))
    told, again = (branch.observe(point)
                   for point in (before[-1], branch.restored(branch.packed(before[-1]))))
    costs = before[-1].spent.keys() & told.keys()
    assert costs and not [name for name in costs if again[name] >= 0 or told[name] < 0]
    for name in told.keys() - costs:
        np.testing.assert_equal(again[name], told[name], name)


# What texts say


def test_options_in_one_line_or_many():
    expected = {"load_path": "a=1; b=-2", "snes_monitor": "", "scene_height": "inf",
                "archive_file": "it's.h5"}
    text = ("-load_path \"a=1; b=-2\"{0}-snes_monitor{0}-scene_height inf{0}-archive_file "
            "\"it's.h5\"")
    assert resuming.entries(text.format("\n")) == resuming.entries(text.format(" ")) == expected
    assert resuming.entries("-archive_file it's.h5 -snes_atol 1")["snes_atol"] == "1"
    assert resuming.changes("-snes_atol 1 -archive_resume -ksp_x",
                            "-snes_atol 2 -ksp_y") == ["-ksp_x is not given, before that given",
                                                       "-ksp_y is given, before that not given",
                                                       "-snes_atol is 2, before that 1"]


@pytest.mark.parametrize("there, here, done, names", [("a=1; b=2", "a=1.0;b=2e0", 2, []),
                                                      ("a=1; b=2", "a=1; b=3", 1, []),
                                                      ("a=1; b=2", "a=2; b=2", 1, ["leg 1"]),
                                                      ("a=1; b=2", "a=1", 2, ["leg 2"]),
                                                      ("a=1; b=2", "a=1; b=hold; c=1", 2,
                                                       ["leg 2"]), ("a=1,b=2", "b=2, a=1", 1, [])])
def test_legs_that_are_done_are_compared(there, here, done, names):
    found = resuming.differences({}, f'-load_path "{there}"', {}, f"-load_path '{here}'", done)
    assert [name[:5] for name, *_ in found] == names


def test_another_scene_is_told_before_a_start_that_is_none_of_its():
    start = "-load_start tangential_displacement_y=1"
    assert resuming.differences({"dimension": 2}, start, {"dimension": 1}, "", 0) == [
        ("dimension", 2, 1)]
    ((name, *_),) = resuming.differences({"dimension": 2}, start, {"dimension": 2}, "", 0)
    assert name == "load_start"


def test_scenes_are_compared_by_value_and_not_by_the_last_bit():
    there = {"normal_maugis": 0.1, "period": (3.0, np.inf), "seed": 2 ** 32 - 1, "law": "modified",
             "geometry_file": "a.npy"}
    here = {**there, "normal_maugis": np.nextafter(0.1, 1.0), "period": np.array([3.0, np.inf]),
            "geometry_file": "b.txt"}
    assert resuming.differences(there, "", here, "", 0) == []
    for change in ({"normal_maugis": 0.1 + 1e-9}, {"period": 3.0}, {"seed": 2 ** 32 - 2},
                   {"law": "mcgarry"}, {"heights": "ab"}):
        (found,) = resuming.differences(there, "", {**there, **change}, "", 0)
        assert found[0] in change and found[2] == change[found[0]]


# On the command line


def run(*arguments, folder):
    return call("run", *arguments, folder=folder)


ROUGH = ["-scene_geometry", "file", "-scene_points", "64", "-scene_period", "12", "-scene_height",
         "20", "-scene_normal_maugis", "1", "-archive_file", "run.h5", "-archive_resume"]
PATH = ["-load_path", "normal_displacement=0.2; normal_displacement=0.4"]


@pytest.fixture(scope="module")
def rough(tmp_path_factory):
    """Folder with heights under two names, others under a third, and the complete archive of a path
    of two legs."""
    folder = tmp_path_factory.mktemp("rough")
    wave = np.cos(2 * np.pi * np.arange(64) / 64)
    np.save(folder / "heights.npy", wave)
    np.savetxt(folder / "same.txt", wave, fmt="%.17g")
    np.save(folder / "others.npy", 1.01 * wave)
    done = run(*ROUGH, *PATH, "-scene_geometry_file", "heights.npy", folder=folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_heights_that_have_changed_are_refused(rough):
    before = (rough / "run.h5").read_bytes()
    done = run(*ROUGH, *PATH, "-scene_geometry_file", "others.npy", folder=rough)
    assert (done.returncode == 2 and "heights_sha256 is" in done.stderr
            and len(done.stderr.splitlines()) == 1)
    assert (rough / "run.h5").read_bytes() == before
    digests = [hashlib.sha256(read(rough / name).tobytes()).hexdigest()
               for read, name in ((np.load, "heights.npy"), (np.loadtxt, "same.txt"))]
    assert [reading.read(rough / "run.h5").scene["heights_sha256"]] * 2 == digests


def test_a_complete_archive_stays_as_it_is(rough):
    before = (rough / "run.h5").read_bytes()
    done = run(*ROUGH, *PATH, "-scene_geometry_file", "same.txt", "-snes_atol", "1e-10",
               "-continuation_largest_step", "0.05", "-archive_fields", "all", folder=rough)
    assert (done.returncode == 0 and "is complete" in done.stdout
            and (rough / "run.h5").read_bytes() == before)


@pytest.mark.parametrize("end, sentence", [
    ("normal_displacement=-0.5", "beyond its end"), ("between the last two", "beyond its end"),
    ("normal_displacement=2", "behind its begin"),
    ("normal_force=1", "begun must be the same"), ("normal_displacement=-4", ""),
    ("normal_displacement=-3.0", "")])
def test_a_path_that_an_event_has_ended_is_held_against_the_leg_that_is_asked_for(tmp_path, end,
                                                                                   sentence):
    words = ["-scene_points", "128", "-scene_period", "20", "-scene_normal_maugis", "2",
             "-continuation_at_fold", "stop", "-archive_file", "run.h5", "-archive_resume"]
    done = run(*words, "-load_path", "normal_displacement=1; normal_displacement=-3",
               folder=tmp_path)
    assert done.returncode == 0, done.stderr
    before = reading.read(tmp_path / "run.h5")
    assert before["event"][-1] == "fold" and before["normal_displacement"][-1] < -0.5
    if end == "between the last two":
        end = f"normal_displacement={np.mean(before['normal_displacement'][-2:])}"
    again = run(*words, "-load_path", f"normal_displacement=1; {end}", folder=tmp_path)
    assert again.returncode == (2 if sentence else 0) and sentence in again.stderr
    after = reading.read(tmp_path / "run.h5")
    assert after.complete and after.points == before.points


def test_a_pull_off_by_force_that_ends_a_path_no_more_is_none(tmp_path):
    """It is a fold; told as complete, the path seemed to have an equilibrium at its end."""
    words = ["-scene_points", "128", "-scene_period", "20", "-scene_normal_maugis", "2",
             "-archive_file", "run.h5", "-archive_resume", "-load_path"]
    path, stop = "normal_force=1; normal_force=-10", ("-load_stop", "pull_off")
    done = run(*words, path, *stop, folder=tmp_path)
    assert done.returncode == 0 and reading.read(tmp_path / "run.h5")["event"][-1] == "fold"
    for longer in (path, f"{path}; normal_force=1"):
        again = run(*words, longer, *stop, folder=tmp_path)
        assert again.returncode == 0 and "is complete" in again.stdout
    last = run(*words, path, folder=tmp_path)
    assert last.returncode == 1 and "no equilibrium" in last.stderr


def test_legs_that_are_done_must_be_the_same(rough):
    path = "normal_displacement=0.2; normal_displacement=0.5"
    done = run(*ROUGH, "-scene_geometry_file", "heights.npy", "-load_path", path, folder=rough)
    assert (done.returncode == 2 and "leg 2 of load_path, which is done, is "
            "normal_displacement=0.4 there" in done.stderr), done.stderr


def test_other_ways_to_solve_are_taken_told_and_stored(rough, tmp_path):
    """Another name of the heights, another tolerance, another form, and one leg more."""
    shutil.copytree(rough, tmp_path / "copy")
    known = reading.read(rough / "run.h5").points
    done = run(*ROUGH, "-scene_geometry_file", "same.txt", "-load_path",
               f"{PATH[1]}; normal_displacement=0.5", "-snes_atol", "1e-11", "-contact_symmetry",
               "off", folder=tmp_path / "copy")
    assert done.returncode == 0, done.stderr
    told = [line for line in done.stdout.splitlines()
            if line.startswith(f"from point {known + 1} on -")]
    assert [line.split()[4] for line in told] == ["-contact_symmetry", "-load_path",
                                                  "-scene_geometry_file", "-snes_atol"]
    assert told[3].endswith("-snes_atol is 1e-11, before that not given")
    record = reading.read(tmp_path / "copy" / "run.h5")
    assert (record.complete and record["normal_displacement"][-1] == 0.5
            and record["residual_norm"][known:].max() <= 1e-11)
    assert [run.first for run in record.runs] == [0, known]
    assert ("-snes_atol 1e-11" in record.runs[1].options
            and "-snes_atol" not in record.runs[0].options)
