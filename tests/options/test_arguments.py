"""Arguments of the Python face that are of another kind: one sentence, in place of Python's own."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import contactsnes
from contactsnes import Branch, Contact, InputError, Load, Scene, Steps, observe, plot, read, table
from contactsnes.output.archive import Archive

SCENE = Scene(points=64, period=20.0, normal_maugis=1.0)
LOAD = Load(path="normal_displacement=1")


@pytest.fixture(scope="module")
def branch():
    return Branch(SCENE, LOAD)


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "run.h5"
    columns = {"normal_force": ("w_n,r",)}
    made = Archive.create(path, scene={}, options="", versions={}, columns=columns)
    made.append({"normal_force": 0.5}, state={})
    made.finish()
    return path


def told(call, words):
    """That a call ends in a sentence that begins with these words."""
    with pytest.raises(InputError) as error:
        call()
    assert str(error.value).startswith(words) and "\n" not in str(error.value)


@pytest.mark.parametrize("value", (None, 3, ["run.h5"]))
def test_what_is_no_path(value, tmp_path):
    told(lambda: read(value), f"the archive is {value}: give the path of one")
    told(lambda: Branch.restart(value, "normal_force=1"), f"the archive is {value}: give the path")
    if not isinstance(value, list):
        told(lambda: plot(value), f"the archive is {value}: give the path of one")
    told(lambda: contactsnes.sweep(SCENE, LOAD, normal_maugis=[1], folder=value),
         f"folder is {value}: give the path of one")


def test_no_archive_to_plot():
    told(lambda: plot([]), "there is no archive to plot: give the path of one, or a list of them")


@pytest.mark.parametrize("value", ("last", 1.5, None, True, [0, 1]))
def test_what_is_no_number_of_a_point(value, archive):
    said = f"point is {value!r}: give a whole number, "
    told(lambda: read(archive).field("traction", value), said)
    told(lambda: Branch.restart(archive, "normal_force=1", point=value), said)


@pytest.mark.parametrize("value", ("last", 1.5, 3))
def test_what_are_no_points(value, archive):
    told(lambda: plot(archive, points=value), f"points is {value!r}: give a list of whole numbers,")


@pytest.mark.parametrize("value", (3, "run.h5"))
def test_what_is_no_history(value):
    told(lambda: Branch(SCENE, LOAD, history=value), f"history is {value!r}: give points of a ")


def test_what_is_no_point_of_a_branch(branch):
    told(lambda: Branch(SCENE, LOAD, history=[1]), "a point of history is 1: give points of a ")
    told(lambda: branch.observe(3), "point is 3: give a point of a branch")
    told(lambda: Branch(SCENE, LOAD, first=3), "first is 3: give the state of a point")
    told(lambda: observe(branch.contact, None), "point is None: give a point of a branch")


@pytest.mark.parametrize("names, sentence", (
    ("normal_force", "names is 'normal_force': give a list of columns, as in ['normal_force']"),
    (3, "names is 3: give a list of columns"),
    (["force"], "a point has no 'force': did you mean normal_force?"),
    (["error_slip"], "a point has no 'error_slip'; contactsnes.table(scene) lists what it has")))
def test_numbers_that_a_point_has_not(names, sentence, branch):
    point = next(iter(branch))
    told(lambda: branch.observe(point, names), sentence)
    told(lambda: observe(branch.contact, point, names), sentence)
    told(lambda: observe(branch.contact, point, ["stiffness"]), "a point has no 'stiffness'; ")
    assert list(branch.observe(point, ["stiffness"])) == ["stiffness"]


def test_points_of_another_scene_are_no_history(branch):
    """The path went on from them, and works were those of neither."""
    other = Branch(replace(SCENE, normal_maugis=1.05), LOAD)
    points = list(other)[:5]
    told(lambda: Branch(SCENE, LOAD, history=points), "the last point of history leaves ")
    assert Branch(other.scene, LOAD, history=points).history == points
    near = next(iter(Branch(SCENE, LOAD, first=points[0].state)))
    assert near.forces[0] == pytest.approx(next(iter(branch)).forces[0], rel=1e-7)


@pytest.mark.parametrize("other, words", (({"points": 128}, "128 points, period 20 beta"),
                                          ({"period": 40.0}, "64 points, period 40 beta")))
def test_a_point_of_another_grid(other, words, branch):
    point, scene = next(iter(branch)), replace(SCENE, **other)
    said = f"is of another grid (64 points, period 20 beta) than the contact's ({words}): "
    for act in (Branch(scene, LOAD).observe, Branch(scene, LOAD).stiffness,
                Branch(scene, LOAD).packed):
        told(lambda act=act: act(point), f"point {said}")
    told(lambda: Branch(scene, LOAD, history=[point]), f"a point of history {said}")
    told(lambda: Branch(scene, LOAD, first=point.state), f"first {said}")


def test_one_thing_in_the_place_of_another(branch):
    told(lambda: observe(branch, None), "contact is <Branch of ")
    told(lambda: observe(SCENE, None), "contact is Scene(")
    told(lambda: table(branch), "scene is <Branch of ")
    told(lambda: Contact(LOAD), "scene is Load(")
    told(lambda: Branch(SCENE, LOAD, log=3), "log is 3: give a function of a sentence, as print is")


@pytest.mark.parametrize("through", (pickle.dumps, copy.copy, copy.deepcopy))
def test_branches_and_contacts_are_no_data(through, branch):
    for made in (branch, branch.contact):
        with pytest.raises(TypeError, match=f"^a {type(made).__name__} is neither pickled nor "
                                            "copied: pickle "):
            through(made)


def test_points_go_on_where_they_are_unpickled(branch):
    points = list(branch)
    scene, load, kept = pickle.loads(pickle.dumps((SCENE, LOAD, points[:5])))
    last = list(Branch(scene, load, history=kept))[-1]
    assert last.forces[0] == pytest.approx(points[-1].forces[0], rel=1e-9)


@pytest.mark.parametrize("name", ("load", "scene", "steps", "form", "legs", "contact", "laod"))
def test_a_branch_is_what_it_was_made_as(name):
    """Another load was taken without a word, and the path was the old one."""
    made = Branch(SCENE, LOAD)
    with pytest.raises(AttributeError, match=f"^a branch is immutable, its {name} cannot be set: "):
        setattr(made, name, Load(path="normal_displacement=2"))
    made.history = list(made)[:3]
    assert len(made.history) == 3


@pytest.mark.parametrize("other", ({"normal_maugis": 2.0}, {"gap_offset": 0.5},
                                   {"geometry": "sinusoid"}))
def test_a_point_of_another_contact_on_the_same_grid(other, branch):
    """Its numbers were those of neither."""
    point, elsewhere = next(iter(branch)), Branch(replace(SCENE, **other), LOAD)
    for act in (elsewhere.observe, elsewhere.stiffness, elsewhere.packed):
        told(lambda act=act: act(point), "point is of another contact: its forces are ")
    same = Branch(replace(SCENE), LOAD).observe(point, ["contact_area"])
    assert same == branch.observe(point, ["contact_area"])


def test_threads_take_turns():
    """Two that asked one branch for points ended in an AttributeError."""
    made = Branch(SCENE, LOAD)
    with ThreadPoolExecutor(3) as threads:
        several = list(threads.map(lambda _: [point.forces[0] for point in made], range(3)))
    assert several[0] == several[1] == several[2] == [point.forces[0] for point in made]


@pytest.mark.parametrize("options, sentence", (
    ({"points": "64"}, "-scene_points is '64', text: allowed is an even number"),
    ({"points": 64.0}, "-scene_points is '64', a number with a decimal point: allowed is "),
    ({"points": np.float64(64)}, "-scene_points is '64', a number with a decimal point: "),
    ({"period": "20"}, "-scene_period is '20', text: allowed is a number above 0"),
    ({"period": (1.0, 2.0, 3.0)}, "-scene_period is '1,2,3': allowed is a number above 0"),
    ({"period": b"20"}, "-scene_period is 'b'20'': allowed is a number above 0"),
    ({"normal_maugis": [1.0]}, "-scene_normal_maugis is '1', a list: allowed is a number"),
    ({"qqq": 1}, "qqq is no option of Scene: it has "),
    ({"normal_maugis": 10 ** 400}, "-scene_normal_maugis is '1000"),
    ({"normal_maugis": np.ma.masked}, "-scene_normal_maugis is '': allowed is a number")))
def test_values_of_another_type_whose_text_would_do(options, sentence):
    told(lambda: Scene(**options), sentence)


def test_numbers_of_numpy_are_those_of_python():
    made = Scene(dimension=np.int8(2), points=np.array([32, 48]), period=np.array([8.0, 12.0]),
                 normal_maugis=np.float32(0.5), geometry=np.str_("flat"))
    assert made == Scene(dimension=2, points=(32, 48), period=(8.0, 12.0), normal_maugis=0.5,
                         geometry="flat")
    assert Steps(locate_folds=np.True_).locate_folds is True


def test_columns_of_a_record_are_those_of_its_file(archive):
    """A script wrote into them, and the record told what the file has not."""
    record = read(archive)
    with pytest.raises(ValueError, match="read-only"):
        record["normal_force"][0] = 3.0
    assert record == record != read(archive) and record in {record}


def test_a_record_is_drawn_as_its_file_is(archive, tmp_path):
    both = [plot(kept, output=tmp_path) for kept in (read(archive), archive)]
    assert both[0] == both[1] and both[0].skipped
    told(lambda: plot(archive, columns=["force", "leg"], output=tmp_path),
         f"-plot_columns: {archive} has no column force of numbers: did you mean normal_force?")
    told(lambda: plot(archive, style=["ggplot"]), "-plot_style is 'ggplot', a list: allowed is ")
