"""Archives: what is written is read, a kill at any moment leaves a readable archive, and a run
resumes from it."""

import errno
import io
import itertools
import multiprocessing
import os
import resource
import signal
import time

import h5py
import numpy as np
import pytest

from contactsnes.grid import parted
from contactsnes.output import active, cell_fields, files, layout, resuming, store, stored
from contactsnes.output import archive as writing
from contactsnes.output.archive import Archive
from contactsnes.output.columns import Column
from contactsnes.output.files import ArchiveError
from contactsnes.output.layout import Layout
from contactsnes.output.reading import Record, read

COLUMNS = {
    "leg": Column("", "i8"),
    "normal_force": Column("w_n,r"),
    "contact_area": Column("beta"),
    "event": Column("", "i1", ("none", "fold", "jump", "gross_sliding")),
}
X = np.linspace(-5, 5, 32, endpoint=False)

pytestmark = pytest.mark.usefixtures("read_here")  # a thousand times


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """No point waits in the journal, but in tests of that."""
    monkeypatch.setattr(writing, "BATCH", 1)


def content(**changed):
    base = dict(scene={"geometry": "cylinder", "normal_maugis": 10.0, "points": 8192},
                options='-scene_normal_maugis 10\n-load_path "normal_force=25; '
                'tangential_displacement=400"\n-snes_atol 1e-8',
                versions={"contactsnes": "0.1", "petsc": "3.18.5"}, columns=COLUMNS,)
    return {**base, **changed}


def fields_content(fields, **changed):
    """What an archive is made of that keeps fields of 'last' or 'all' points; after 'active' on
    active nodes, of a rigid body."""
    *where, fields = fields.split()
    if "active" in where:
        blocks = {(i, i): np.zeros(X.size // 2 + 1) for i in range(2)}
        changed["compliance"] = (X.size,), blocks
    parts = "parted" in where
    where = [word for word in where if word != "parted"]
    return content(fields=fields, coordinates=(X,), components=2,
                   initial_gap=in_parts(X ** 2 / 2, parts), **changed)


class Alone:
    """A communicator of one process."""

    rank, size = 0, 1

    @staticmethod
    def allgather(value):
        return [value]


def in_parts(array, parts=True):
    """An array as several processes have it, or itself."""
    return parted.Parted(Alone, array, -1) if parts else array


def point(number):
    """A point whose every number tells which it is; the state's size changes now and then, as a
    window does."""
    row = dict(leg=number, normal_force=number / 3, contact_area=-number,
               event=("none", "fold")[number % 2])
    state = dict(displacement=np.full((2, 40 + number // 100), number), load=number / 7,
                 control="force")
    field = np.full((2, X.size), float(number))
    return row, state, field, -field


def active_nodes(number):
    """Those of a point: now few, now many."""
    return np.arange(number % 5, X.size, 1 + number % 7)


def append(archive, count):
    for _ in range(count):
        row, state, displacement, traction = point(archive.points)
        where = {}
        if archive._layout.active is not None:
            nodes = active_nodes(archive.points)
            where = {"nodes": nodes, "mean": displacement[:, 0]}
            displacement, traction = displacement[:, nodes], traction[:, nodes]
        if archive._layout.parted:
            state["displacement"], displacement, traction = map(
                in_parts, (state["displacement"], displacement, traction))
        archive.append(row, state, displacement, traction, **where)


def check(path, fields="none"):
    """Assert that an archive is consistent; return its record."""
    record = read(path)
    numbers = np.arange(record.points)
    assert np.array_equal(record["leg"], numbers)
    assert np.array_equal(record["normal_force"], numbers / 3)
    assert list(record["event"]) == [("none", "fold")[number % 2] for number in numbers]
    chosen = sorted({*record.field_points[::40], *record.field_points[-3:]})
    for number, (displacement, traction) in zip(chosen, record.each(chosen)):
        assert np.all(displacement == number)
        expected = np.full((2, X.size), -float(number))
        if record.on_active:
            if number == chosen[-1]:  # where tractions act tells the nodes of the others
                assert np.array_equal(record.active(number)["nodes"], active_nodes(number))
            expected[:, np.setdiff1d(np.arange(X.size), active_nodes(number))] = 0.0
        assert np.array_equal(traction, expected)
    resumed = Archive.resume(path, **(fields_content(fields) if record.coordinates else content()))
    last = [state["load"] for state in resumed.states()]
    assert last == [number / 7 for number in numbers[-4:]]
    return record


# What is written is read


def test_a_record_gives_back_what_was_appended(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **content())
    append(archive, 150)
    archive.finish()
    record = check(tmp_path / "run.h5")
    assert record.points == archive.points == 150 and record.complete
    assert record.scene == content()["scene"] and record.options == content()["options"]
    assert record.versions == {"contactsnes": "0.1", "petsc": "3.18.5"}
    assert (record.units["normal_force"] == "w_n,r"
            and record.names["event"] == COLUMNS["event"].names)
    assert set(record) == set(COLUMNS) and record.coordinates == () and record.initial_gap is None
    assert os.listdir(tmp_path) == ["run.h5"]


def test_h5py_alone_reads_an_archive_between_any_two_points(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    for count in range(1, 4):
        append(archive, 1)
        with h5py.File(archive.path) as file:
            assert file.attrs["points"] == count and file.attrs["options"] == content()["options"]
            assert file["scene"].attrs["normal_maugis"] == 10
            assert file["branch/normal_force"].shape == (count,)
            assert file["branch/normal_force"].attrs["unit"] == "w_n,r"
            assert list(file["branch/event"].attrs["names"]) == list(COLUMNS["event"].names)
            assert file["fields/displacement"].shape == file["fields/traction"].shape == (count, 2,
                                                                                          X.size)
            assert np.array_equal(file["fields/x"],
                                  X) and np.array_equal(file["fields/initial_gap"], X**2 / 2)
            assert not file.attrs["complete"]


def test_a_record_takes_no_fields_of_an_archive_that_has_replaced_its_own(tmp_path):
    """Those of a run that goes on it does."""
    made = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(made, 3)
    made.settle()
    record = read(made.path)
    append(made, 2)
    made.finish()
    assert np.all(record.field("displacement", 1) == 1)
    other = Archive.create(tmp_path / "run.h5", overwrite=True, **fields_content("all"))
    append(other, 4)
    for take in (lambda: record.field("displacement", 1), lambda: list(record.each([1])),
                 record.states):
        with pytest.raises(ArchiveError, match="run.h5 is another archive than was read"):
            take()
    assert np.all(read(made.path).field("displacement", 1) == 1)


def test_a_record_reads_its_own_file_from_any_folder(tmp_path, monkeypatch):
    """Where its name is that of another archive there, too."""
    for folder, first in (("one", 0), ("two", 5)):
        (tmp_path / folder).mkdir()
        made = Archive.create(tmp_path / folder / "run.h5", **fields_content("all"))
        for number in range(first, first + 3):
            made.append(*point(number))
        made.finish()
    monkeypatch.chdir(tmp_path / "one")
    record = read("run.h5")
    monkeypatch.chdir(tmp_path / "two")
    (displacement, _), = record.each([1])
    assert np.all(displacement == 1) and np.all(record.field("displacement", 1) == 1)
    assert str(record.path) == "run.h5"


@pytest.mark.parametrize("fields, stored", [("none", []), ("last", [149]),
                                            ("all", list(range(150)))])
def test_fields_of_the_points_asked_for_are_kept(tmp_path, monkeypatch, fields, stored):
    monkeypatch.setattr(writing, "BATCH", 64)
    archive = Archive.create(tmp_path / "run.h5", **fields_content(fields))
    append(archive, 150)
    archive.settle()
    record = check(archive.path, fields)
    assert record.field_points == stored
    with h5py.File(archive.path) as file:
        assert ("displacement" in file["fields"]) == bool(stored)
        assert not stored or file["fields/displacement"].shape[0] == len(stored)
    with pytest.raises(ArchiveError, match="no fields of point 150"):
        record.field("displacement", 150)
    name = next(iter(record))
    with pytest.raises(KeyError, match=f"run.h5 has no column '{name}s': did you mean {name}"):
        record[f"{name}s"]
    assert f"{name}s" not in record and record.get(f"{name}s") is None


def test_two_dimensional_fields(tmp_path):
    shape = (3, 4, 6)
    grid = dict(coordinates=(np.arange(4.0), np.arange(6.0)), components=3,
                initial_gap=np.ones((4, 6)), fields="all")
    archive = Archive.create(tmp_path / "run.h5", **content(**grid))
    displacement = np.random.default_rng(1).random(shape)
    archive.append(*point(0)[:2], displacement, 2 * displacement)
    record = read(archive.path)
    assert np.array_equal(record.field("traction", 0), 2 * displacement)
    assert [len(axis) for axis in record.coordinates] == [4,
                                                          6] and record.initial_gap.shape == (4, 6)


def test_chunks_are_no_larger_than_the_format_allows(tmp_path, monkeypatch):
    """As many points together as HDF5 stores in one piece; fields that it does not are refused
    before the first point."""
    size = 8 * 2 * X.size
    monkeypatch.setattr(cell_fields, "LARGEST", 2 * size - 1)
    monkeypatch.setattr(writing, "BATCH", 64)
    archive = Archive.create(tmp_path / "a.h5", **fields_content("all"))
    append(archive, 70)
    archive.settle()
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["fields/displacement"].chunks == (1, 2, X.size)
    for number in (0, 69):
        assert (read(tmp_path / "a.h5").field("displacement", number) == float(number)).all()
    monkeypatch.setattr(cell_fields, "LARGEST", size - 1)
    with pytest.raises(ArchiveError, match="-archive_fields_on active"):
        Archive.create(tmp_path / "b.h5", **fields_content("all"))
    for kept in ("last", "active all"):
        Archive.create(tmp_path / f"{kept}.h5", **fields_content(kept))


def test_long_options_and_long_states(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **content(options="-name value\n" * 10000))
    for size in (1, 100_000, 10, 200_000):
        archive.append(point(archive.points)[0], {"displacement": np.full(size, size)})
    assert [state["displacement"].size for state in archive.states()] == [1, 100_000, 10, 200_000]
    assert len(read(archive.path).options) == 120_000


def test_a_damaged_state_is_told_with_its_file(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **content())
    append(archive, 2)
    archive.settle()
    with h5py.File(archive.path, "r+") as file:
        for slot in file["states"].values():
            slot[60] ^= 255
    said = f"^{archive.path} is damaged: the checksum of a state is not that of "
    with pytest.raises(ArchiveError, match=said):
        read(archive.path).states()
    with pytest.raises(ArchiveError, match=said):
        archive.states()


def test_states_are_those_of_the_last_four_points(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **content())
    assert archive.states() == []
    for count in range(1, 9):
        append(archive, 1)
        states = archive.states()
        assert [state["load"] for state in states] == [number / 7
                                                       for number in range(max(0, count - 4),
                                                                           count)]
    assert states[-1]["displacement"].shape == (2, 40) and states[-1]["control"] == "force"


# Resuming


@pytest.mark.parametrize("fields", ["none", "last", "all"])
def test_a_resumed_archive_is_that_of_an_uninterrupted_run(tmp_path, monkeypatch, fields):
    with monkeypatch.context() as patch:
        patch.setattr(writing, "BATCH", 64)
        once = Archive.create(tmp_path / "once.h5", **fields_content(fields))
        append(once, 70)
        once.settle()
    append(Archive.create(tmp_path / "twice.h5", **fields_content(fields)), 30)
    twice = Archive.resume(tmp_path / "twice.h5", **fields_content(fields))
    assert twice.points == 30 and not twice.complete
    append(twice, 40)
    first, second = check(once.path, fields), check(twice.path, fields)
    assert all(np.array_equal(first[name], second[name]) for name in first)
    assert first.field_points == second.field_points


def test_rows_beyond_points_are_dropped(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 3)
    with h5py.File(archive.path, "r+") as file:
        file["branch/leg"].resize((7,))
        file["fields/displacement"].resize(5, axis=0)
    resumed = Archive.resume(archive.path, **fields_content("all"))
    append(resumed, 1)
    with h5py.File(archive.path) as file:
        assert file["branch/leg"].shape == (4,) and len(file["fields/displacement"]) == 4
    check(archive.path, "all")


def test_columns_of_ones_own_are_resumed(tmp_path):
    mine = content(columns={"force": ("w_n,r",)}, options="")
    made = Archive.create(tmp_path / "own.h5", **mine)
    made.append({"force": 0.5}, {})
    made.settle()
    more = Archive.resume(made.path, **mine)
    more.append({"force": 0.75}, {})
    more.finish()
    assert read(made.path)["force"].tolist() == [0.5, 0.75]


@pytest.mark.parametrize("value", ([1.0, 2.0], np.zeros(1), 1j))
def test_what_is_no_number_is_refused_before_it_is_written(tmp_path, value):
    made = Archive.create(tmp_path / "own.h5", **content(columns={"force": ("w_n,r",)}))
    with pytest.raises(ArchiveError, match="force is .*: a row has one real number"):
        made.append({"force": value}, {})
    made.append({"force": np.array(0.5)}, {})
    made.finish()
    assert read(made.path)["force"].tolist() == [0.5]


@pytest.mark.parametrize("column, value", (
    (("", "i8"), 2.5), (("", "i8"), np.nan), (("", "i1"), 300), (("", "u1"), -1),
    (("", "i8"), 2 ** 63), (("", "f4"), 1e39), (("", "i1", ("a", "b")), 2),
    (("", "i1", ("a", "b")), -1), (("", "i1", ("a", "b")), 0.5)))
def test_what_a_column_cannot_hold_is_refused(tmp_path, column, value):
    """It would be another number in the file, or none that its names have."""
    made = Archive.create(tmp_path / "own.h5", **content(columns={"own": column}))
    with pytest.raises(ArchiveError, match="own is .*, which its column cannot hold"):
        made.append({"own": value}, {})
    for value in (1, np.int64(1), True, np.float32(1.0)):
        made.append({"own": value}, {})
    made.finish()
    assert read(made.path)["own"].tolist() == ["b" if len(column) == 3 else 1] * 4


@pytest.mark.parametrize("columns, words", (
    ({"a/b": ("",)}, "a column is called 'a/b'"), ({"": ("",)}, "a column is called ''"),
    ({3: ("",)}, "a column is called 3"), ({"own": "w_n,r"}, "the column own is 'w_n,r': give a"),
    ({"own": None}, "the column own is None"), ({"own": ("", "O")}, "the column own is"),
    ({"own": ("", "nonsense")}, "the column own is"), ({"own": (3,)}, "the column own is")))
def test_what_is_no_column_is_refused(tmp_path, columns, words):
    with pytest.raises(ArchiveError, match=words):
        Archive.create(tmp_path / "own.h5", **content(columns=columns))


def test_nothing_to_resume_starts_anew(tmp_path):
    path = tmp_path / "run.h5"
    assert Archive.resume(path, **content()).points == 0 and path.exists()
    assert Archive.resume(path, **content(scene={"geometry": "sphere"})).points == 0
    assert read(path).scene == {"geometry": "sphere"}


def test_finish_after_resuming_changes_nothing_else(tmp_path):
    append(Archive.create(tmp_path / "run.h5", **fields_content("last")), 3)
    Archive.resume(tmp_path / "run.h5", **fields_content("last")).finish()
    record = check(tmp_path / "run.h5", "last")
    assert record.complete and record.points == 3 and record.field_points == [2]
    before = record.path.read_bytes()
    Archive.resume(record.path, **fields_content("all", columns={"leg": Column("", "i8")})).finish()
    assert record.path.read_bytes() == before
    complete = Archive.resume(tmp_path / "run.h5", **fields_content("last"))
    assert complete.complete
    with pytest.raises(ArchiveError, match="is complete"):
        append(complete, 1)


@pytest.mark.parametrize("changed, message",
                         [(dict(scene={**content()["scene"], "normal_maugis": 5.0}),
                           "normal_maugis is 10.0 there and 5.0 here"),
                          (dict(scene={**content()["scene"], "height": 2.0}), "height is not "
                           "given there and 2.0 here"),
                          (dict(options="-load_path normal_force=3"), "leg 1 of load_path, .*, "
                           "is normal_force=25 there and normal_force=3 here"),
                          (dict(options=content()["options"] + " -load_start normal_force=1"),
                           "load_start is not given there and "
                           "normal_force=1 here"), (dict(columns={"leg": Column("", "i8")}),
                                                    r"columns or its grid .*contact_area, event, "
                                                    r"normal_force\)"),
                          (dict(columns={**COLUMNS, "error_slip": Column("relative")}),
                           "-archive_errors is not given there and given here; take what"),
                          (dict(fields="all", coordinates=(X,)), "archive_fields is none "
                           "there and all here"),],)
def test_an_archive_of_another_run_is_not_resumed(tmp_path, changed, message):
    append(Archive.create(tmp_path / "run.h5", **content()), 3)
    before = (tmp_path / "run.h5").read_bytes()
    with pytest.raises(ArchiveError, match=message):
        Archive.resume(tmp_path / "run.h5", **content(**changed))
    assert (tmp_path / "run.h5").read_bytes() == before


@pytest.mark.parametrize(
    "options",
    [
        '-snes_atol 1e-9 -load_path "normal_force=25;  tangential_displacement=400" -pc_type core',
        "-load_path normal_force=25; tangential_displacement=400",
        "-load_path normal_force=1\n-load_path\tnormal_force=25; tangential_displacement=400\n",
        "-load_path normal_force=2.5e1;normal_force=-1 -load_stop pull_off",
    ],
)
def test_method_and_spelling_of_options_do_not_hinder_resuming(tmp_path, options):
    append(Archive.create(tmp_path / "run.h5", **content()), 3)
    assert Archive.resume(tmp_path / "run.h5", **content(options=options)).points == 3


@pytest.mark.parametrize("scene, there, here", [
    ({"period": 30.0}, "", "-load_start normal_displacement=0"),
    ({"period": 30.0}, "-load_start normal_displacement=0.0", ""),
    ({"period": np.inf}, "", "-load_start normal_force=0"),
    ({"period": 30.0}, "-load_start normal_force=1",
     "-load_start 'tangential_displacement=0, normal_force=1.0'"),
    ({"period": [9.0, 8.0], "dimension": 2}, "", "-load_start tangential_displacement_y=0")])
def test_a_start_that_is_named_as_it_is_anyway_does_not_hinder_resuming(tmp_path, scene, there,
                                                                        here):
    """At the start displacements are 0, forces of an isolated contact, if they are not named."""
    path = content()["options"] + " "
    append(Archive.create(tmp_path / "run.h5", **content(scene=scene, options=path + there)), 3)
    going_on = content(scene=scene, options=path + here)
    assert Archive.resume(tmp_path / "run.h5", **going_on).points == 3
    other = "normal_displacement" if np.isinf(scene["period"]).any() else "normal_force"
    with pytest.raises(ArchiveError, match=f"load_start is .* there and {other}=0 here"):
        Archive.resume(tmp_path / "run.h5",
                       **content(scene=scene, options=f"{path}-load_start {other}=0"))


def test_which_options_made_which_points(tmp_path):
    """Readable by h5py alone; a run without points counts for nothing, and points written anew keep
    their run."""
    path = tmp_path / "run.h5"
    texts = [f"{content()['options']}\n-snes_atol 1e-{number}" for number in (8, 9, 10, 11)]
    append(Archive.create(path, **content(options=texts[0], warnings=["coarse"])), 3)
    append(Archive.resume(path, **content(options=texts[1], versions={"petsc": "3.26"},
                                          warnings=["steep"])), 80)
    Archive.resume(path, **content(options=texts[2])).finish()
    with h5py.File(path) as file:
        assert (file["runs/first"][:].tolist() == [0, 3, 83]
                and file["runs/options"].asstr()[:].tolist() == texts[:3])
        assert (file["runs/versions"].asstr()[1] == "petsc 3.26"
                and file.attrs["options"] == texts[2])
        assert file.attrs["warnings"].splitlines() == ["coarse", "steep"]
    again = f"{texts[3]} -load_path 'normal_force=25; tangential_displacement=400; normal_force=1'"
    append(Archive.resume(path, **content(options=again)), 1)
    assert [run.first for run in read(path).runs] == [0, 3,
                                                      83] and read(path).runs[-1].options == again
    with h5py.File(path, "r+") as file:
        del file["runs"], file["checksums"]
    assert [tuple(run)[:2] for run in read(path).runs] == [(0, again)]
    append(Archive.resume(path, **content(options=again)), 1)
    assert [run.first for run in read(path).runs] == [0, 84]


@pytest.mark.parametrize("event, before, now, more",
                         [("none", "-load_path a=1", "-load_path a=1 -snes_atol 1", False),
                          ("none", "-load_path a=1", "-load_path a=1;a=2", True),
                          ("fold", "-continuation_at_fold stop",
                           "-continuation_at_fold stop -load_path a=1;a=2", False),
                          ("fold", "-continuation_at_fold stop", "-continuation_at_fold trace",
                           True), ("pull_off", "-load_stop gross_sliding,pull_off",
                                   "-load_stop gross_sliding", True),
                          ("pull_off", "-load_stop pull_off", "-load_stop pull_off,gross_sliding",
                           False), ("pull_off", "", "-load_stop pull_off -load_path a=1", False)])
def test_what_a_complete_path_has_more_to_offer(event, before, now, more):
    assert resuming.has_more(before, now, (event,)) is more


def test_modes_may_be_kept_from_some_point_on(tmp_path):
    path = tmp_path / "run.h5"
    append(Archive.create(path, **fields_content("all")), 2)
    append(Archive.resume(path, **fields_content("all", modes=True)), 1)
    mode = np.ones((2, X.size))
    Archive.resume(path, **fields_content("all")).append(*point(3), mode)
    assert (np.isnan(read(path).field("mode", 2)).all()
            and np.array_equal(read(path).field("mode", 3), mode))
    check(path, "all")


@pytest.mark.parametrize("shape, block", [((64,), 20), ((12, 10), 30), ((12, 10), 4)])
def test_points_without_a_mode_beside_others_with_one_are_written_in_pieces(shape, block, tmp_path,
                                                                          monkeypatch):
    """Pieces are some components of a line and some rows of a plane."""
    monkeypatch.setattr(parted, "BLOCK", block)
    path, field = tmp_path / "run.h5", np.ones((len(shape) + 1, *shape))
    archive = Archive.create(path, **content(
        fields="all", coordinates=[np.arange(n) for n in shape], components=len(field),
        modes=True))
    for mode in (None, field, None):
        archive.append(*point(archive.points)[:2], field, field, mode)
    archive.finish()
    for number, found in enumerate((np.nan, 1.0, np.nan)):
        np.testing.assert_array_equal(read(path).field("mode", number), found * field)


# Bad input


def test_an_existing_archive_is_replaced_only_when_asked(tmp_path):
    append(Archive.create(tmp_path / "run.h5", **content()), 2)
    with pytest.raises(ArchiveError, match="-archive_resume .* -archive_overwrite"):
        Archive.create(tmp_path / "run.h5", **content())
    assert read(tmp_path / "run.h5").points == 2
    append(Archive.create(tmp_path / "run.h5", overwrite=True, **content()), 1)
    assert read(tmp_path / "run.h5").points == 1


def test_what_is_to_be_replaced_stays_until_there_is_something_in_its_place(tmp_path):
    """Not only removed: an archive without points would be made of it before."""
    path = tmp_path / "run.h5"
    append(Archive.create(path, **content()), 2)
    other = Archive.create(path, overwrite=True, **content())
    other.remove()
    assert read(path).points == 2
    other.settle()
    assert read(path).points == 0


def test_a_protected_archive_is_neither_replaced_nor_gone_on_with(tmp_path, monkeypatch):
    """In a folder that can be written, another file took its place."""
    path = tmp_path / "run.h5"
    append(Archive.create(path, **content()), 2)
    allowed = os.access
    monkeypatch.setattr(os, "access", lambda name, mode, **how:
                        name != path and allowed(name, mode, **how))
    for attempt in (lambda: Archive.create(path, overwrite=True, **content()),
                    lambda: Archive.resume(path, **content())):
        with pytest.raises(ArchiveError, match="run.h5 is protected against being written"):
            attempt()
    assert read(path).points == 2
    monkeypatch.undo()
    Archive.resume(path, **content()).finish()
    monkeypatch.setattr(os, "access", lambda name, mode, **how: name != path)
    assert Archive.resume(path, **content()).complete


def test_who_may_read_an_archive_stays(tmp_path):
    """Written anew, it is readable for those only who could read it before."""
    archive = Archive.create(tmp_path / "run.h5", **content())
    archive.path.chmod(0o600)
    append(archive, 2)
    archive.finish()
    assert archive.path.stat().st_mode & 0o777 == 0o600


def test_what_is_no_archive_is_neither_read_nor_destroyed(tmp_path):
    text, other = tmp_path / "scene.opts", tmp_path / "other.h5"
    text.write_text("-scene_points 64")
    with h5py.File(other, "w") as file:
        file["data"] = 1
    for path, message in ((text, "HDF5"), (other, "no archive"), (tmp_path, "is a folder")):
        for attempt in (read, lambda p: Archive.create(p, overwrite=True, **content()),
                        lambda p: Archive.resume(p, **content())):
            with pytest.raises(ArchiveError, match=message):
                attempt(path)
    assert text.read_text() == "-scene_points 64"
    with pytest.raises(ArchiveError, match="no such file; name one that contactsnes run has"):
        read(tmp_path / "absent.h5")
    with pytest.raises(ArchiveError, match="no such file; did you mean other.h5"):
        read(tmp_path / "othr.h5")


def test_a_folder_with_the_name_of_an_archive_is_no_archive(tmp_path):
    (tmp_path / "run.h5").mkdir()
    with pytest.raises(ArchiveError, match="run.h5 is a folder or a device, no archive"):
        read(tmp_path / "run.h5")
    with pytest.raises(ArchiveError, match="no such file; name one"):
        read(tmp_path / "runs.h5")
    for folder in (tmp_path / "run.h5", "/"):
        with pytest.raises(ArchiveError, match="folder or a device; name another -archive_file"):
            Archive.create(folder, **content())


def test_an_archive_of_another_version_is_told_as_one(tmp_path):
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file.attrs["format"] = "contactsnes 7"
    with pytest.raises(ArchiveError, match="another version .*format 'contactsnes 7'"):
        read(tmp_path / "run.h5")


def test_folders_that_cannot_be_written(tmp_path, monkeypatch):
    (tmp_path / "plain").write_text("")
    with pytest.raises(ArchiveError, match="is a file: move it away or name another"):
        Archive.create(tmp_path / "plain" / "run.h5", **content())
    with pytest.raises(ArchiveError, match="does not exist"):
        Archive.create(tmp_path / "absent" / "run.h5", **content())
    monkeypatch.setattr(os, "access", lambda *_: False)  # permissions do not bind an administrator
    with pytest.raises(ArchiveError, match="cannot be written"):
        Archive.create(tmp_path / "run.h5", **content())


def test_wrong_points_are_refused_and_leave_no_trace(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 1)
    row, state, field, traction = point(1)
    for wrong, message in [
        (({"leg": 1}, state, field, traction), "one value for each column.*contact_area"),
        (({**row, "event": "sliding"}, state, field, traction), "event cannot be 'sliding'"),
        (({**row, "contact_area": "2"}, state, field, traction), "contact_area is '2': a row has"),
        ((row, {"parent": None}, field, traction), "parent'"),
        ((row, state, field[0], traction), r"displacement has the shape \(32,\)"),
        ((row, state), r"displacement has the shape \(\)"),
    ]:
        with pytest.raises(ArchiveError, match=message):
            archive.append(*wrong)
    append(archive, 1)
    assert check(archive.path, "all").points == 2
    with pytest.raises(ArchiveError, match="none, last or all"):
        Archive.create(tmp_path / "other.h5", **content(fields="some"))
    with pytest.raises(ArchiveError, match="need coordinates"):
        Archive.create(tmp_path / "other.h5", **content(fields="all"))


def test_a_file_that_is_taken_away_stops_the_run(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 3)
    archive.path.unlink()
    with pytest.raises(ArchiveError, match="cannot be written|no such file"):
        append(archive, 1)
    # what waits for its file
    assert os.listdir(tmp_path) == ["run.h5.journal"]


# Other programs


def test_a_reader_that_keeps_the_file_open_does_not_stop_the_run(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "PATIENCE", 0.0)
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 2)
    with h5py.File(archive.path) as reader:
        append(archive, 3)
        archive.finish()
        assert len(reader["branch/leg"]) == 2
    assert check(archive.path, "all").points == 5


def test_two_runs_cannot_write_one_archive(tmp_path):
    append(Archive.create(tmp_path / "run.h5", **content()), 2)
    first, second = (Archive.resume(tmp_path / "run.h5", **content()) for _ in range(2))
    append(first, 2)
    with pytest.raises(ArchiveError, match="changed by another program"):
        append(second, 2)
    assert check(tmp_path / "run.h5").points == 4


def test_a_run_whose_archive_was_begun_anew_leaves_the_other_alone(tmp_path, monkeypatch):
    """Each knows its own by more than the number of points."""
    monkeypatch.setattr(writing, "BATCH", 64)
    first = Archive.create(tmp_path / "run.h5", **content())
    append(first, 2)
    second = Archive.create(tmp_path / "run.h5", overwrite=True, **content())
    append(second, 1)
    with pytest.raises(ArchiveError, match="changed by another program"):
        first.settle()
    append(second, 2)
    second.finish()
    assert check(second.path).points == 3


@pytest.mark.parametrize("moved", [False, True])
def test_two_runs_do_not_write_one_file_anew(tmp_path, monkeypatch, moved):
    """While the first is about to put its file in place, or after it has."""
    path = tmp_path / "run.h5"
    first = Archive.create(path, **content())
    late = Archive(path, **content())
    replace, opened, met = os.replace, os.open, []

    def anew():
        with pytest.raises(ArchiveError, match="changed by another program"):
            late.settle()
        met.append(True)

    def replaced(partial, target):
        monkeypatch.setattr(os, "replace", replace)
        moved or anew()
        replace(partial, target)

    def found(name, *arguments):
        """A file that is moved between its opening and its lock."""
        number = opened(name, *arguments)
        if moved and not met and str(name).endswith(".partial"):
            met.append(True)
            replace(name, path)
        return number

    monkeypatch.setattr(os, "replace", replaced)
    append(first, 1) if not moved else None
    monkeypatch.setattr(os, "open", found)
    if moved:
        anew()
    assert met and not list(tmp_path.glob("*.partial"))


def test_two_runs_mix_no_points_in_the_journal(tmp_path, monkeypatch):
    """A second one that finds no points waiting goes on from the same point."""
    first = waiting(tmp_path / "run.h5", monkeypatch, 0)
    second, given = Archive.resume(first.path, **fields_content("all")), point
    append(first, 2)
    monkeypatch.setattr(f"{__name__}.point", lambda number: given(number + 100))
    append(second, 1)
    assert list(read(first.path)["leg"]) == [0, 101]
    append(second, 1)
    assert list(read(first.path)["leg"]) == [0, 101, 102]
    with pytest.raises(ArchiveError, match="run.h5 has been changed by another program"):
        append(first, 1)
    with pytest.raises(ArchiveError, match="run.h5 has been changed by another program"):
        first.settle()
    append(second, 1)
    assert list(read(first.path)["leg"]) == [0, 101, 102, 103]


def wait_with_points(path, monkeypatch, told):
    archive = waiting(path, monkeypatch, 3)
    told.set()
    time.sleep(600.0)
    archive.settle()


def test_a_run_that_goes_on_is_not_resumed(tmp_path, monkeypatch):
    path, context = tmp_path / "run.h5", multiprocessing.get_context("fork")
    told = context.Event()
    run = context.Process(target=wait_with_points, args=(path, monkeypatch, told))
    run.start()
    assert told.wait(600.0) and read(path).points == 4
    with pytest.raises(ArchiveError, match="may still be running"):
        Archive.resume(path, **fields_content("all"))
    run.kill()
    run.join()
    assert Archive.resume(path, **fields_content("all")).points == 4


def test_an_interrupted_write_is_repaired_by_the_next(tmp_path, monkeypatch):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 3)
    put = Layout.put

    def interrupted(self, file, first, points, states):
        put(self, file, first, [point._replace(fields={}) for point in points], states)
        file.attrs.modify("points", first - 1)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Layout, "put", interrupted)
        append(archive, 1)
    assert read(archive.path).points == 4  # the last one from the journal
    append(archive, 1)
    assert check(archive.path, "all").points == 5


# Full disks and kills


def run_into_a_limit(path):
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 1000,) * 2)
    with pytest.raises(ArchiveError, match="cannot be written"):
        run_until_killed(path, "all")
    os._exit(0)


def test_a_full_disk_ends_the_run_and_leaves_the_archive(tmp_path):
    append(Archive.create(tmp_path / "run.h5", **fields_content("all")), 3)
    run = multiprocessing.get_context("fork").Process(target=run_into_a_limit,
                                                      args=(tmp_path / "run.h5",))
    run.start()
    run.join()
    assert run.exitcode == 0
    points = check(tmp_path / "run.h5", "all").points
    append(Archive.resume(tmp_path / "run.h5", **fields_content("all")), 1)
    assert check(tmp_path / "run.h5", "all").points == points + 1
    assert os.listdir(tmp_path) == ["run.h5"]


@pytest.mark.parametrize("lacking", [AttributeError(), OSError(errno.EOPNOTSUPP, "unsupported")])
def test_files_grow_without_a_call_for_it(tmp_path, monkeypatch, lacking):
    def refuse(*given):
        raise lacking

    archive = Archive.create(tmp_path / "run.h5", **fields_content("all"))
    append(archive, 1)
    monkeypatch.setattr(os, "posix_fallocate", refuse)
    append(archive, 5)
    assert check(archive.path, "all").points == 6


class Recorder(io.BytesIO):
    """A file that remembers each change that HDF5 makes, in order."""

    def __init__(self, path):
        super().__init__(path.read_bytes())
        self.path, self.changes = path, []

    def write(self, data):
        self.changes.append((self.tell(), bytes(data)))
        return super().write(data)

    def truncate(self, size=None):
        self.changes.append((size, None))
        return super().truncate(size)

    def prefixes(self, before):
        """Contents of the file after each change that makes it another one, large ones cut where a
        kill can cut them: between pages, the first and last ones of many."""
        content, last = bytearray(before), None
        for start, data in self.changes:
            if data is None:
                content = content[:start] + bytes(max(0, start - len(content)))
                data = b""
            pages = list(range(4096 - start % 4096, len(data), 4096))
            cuts = [0, *(pages if len(pages) < 6 else pages[:2] + pages[-2:]), len(data)]
            for first, end in zip(cuts, cuts[1:]):
                content.extend(bytes(max(0, start + end - len(content))))
                content[start + first : start + end] = data[first:end]
                if content != last:
                    last = bytes(content)
                    yield last


@pytest.mark.parametrize("fields, points", [
    *itertools.product(["none", "last", "all"], [3]),
    *itertools.product(["none", "active last", "parted all", "parted active all"], [66]),
    *(pytest.param(*case, marks=pytest.mark.study)
      for case in [("active last", 3), ("active all", 3), ("parted last", 66), ("last", 66),
                   ("all", 66), ("active all", 66)]),
    *itertools.product(["none", "last"], [0]),
    ("all", 65)])  # from 65 on two points share a chunk of the fields
def test_every_prefix_of_the_changes_of_a_point_is_an_archive(tmp_path, monkeypatch, fields,
                                                              points):
    monkeypatch.setattr(parted, "BLOCK", 20)
    given = layout.pieces  # but of zeros, thousands of bytes
    monkeypatch.setattr(layout, "pieces",
                        lambda shape: given(shape) if len(shape) > 1 else [slice(None)])
    path, killed = tmp_path / "run.h5", tmp_path / "killed.h5"
    monkeypatch.setattr(writing, "BATCH", 64)
    archive = Archive.create(path, **fields_content(fields, state=0 if points else 4096))
    append(archive, min(points, 63))
    archive.settle()
    monkeypatch.setattr(writing, "BATCH", 1)
    append(archive, points - archive.points)
    before = [path.read_bytes()]
    recorders = []
    counts = []
    stored = []
    opened = files.opened

    def recording(name, mode):
        if mode == "r":
            return opened(name, mode)
        recorders.append(Recorder(path))
        before.append(path.read_bytes())  # made longer before
        return opened(recorders[-1], mode)

    with monkeypatch.context() as patch:
        patch.setattr(store, "opened", recording)
        append(archive, 1)
    assert len(recorders) == 1
    for content in recorders[0].prefixes(before[-1]):
        killed.write_bytes(content)
        record = check(killed, fields)
        counts.append(record.points)
        stored.append(len(record.field_points))
    assert set(counts) == {points, points + 1} and counts == sorted(counts)
    assert len(recorders[0].changes) > 10
    if fields.endswith("last"):
        assert set(stored) == {0, 1}  # the one array is gone while it is overwritten


def run_until_killed(path, fields, told=lambda: None):
    archive = Archive.resume(path, **fields_content(fields))
    while True:
        append(archive, 1)
        told()


@pytest.mark.parametrize("fields, batch", [
    ("last", 5), ("all", 64), ("active all", 1),
    *(pytest.param(*case, marks=pytest.mark.study)
      for case in [("last", 1), ("all", 1), ("active last", 5)])])
def test_a_run_that_is_killed_at_random_leaves_an_archive_and_resumes(tmp_path, fields, batch,
                                                                      monkeypatch):
    monkeypatch.setattr(writing, "BATCH", batch)
    random = np.random.default_rng(7)
    path = tmp_path / "run.h5"
    points = []
    context = multiprocessing.get_context("fork")
    for number in range(6):
        begun = context.Event()
        run = context.Process(target=run_until_killed, args=(path, fields, begun.set))
        run.start()
        if number % 3:  # the others may be killed before their first point
            assert begun.wait(600.0)
        time.sleep(random.uniform(0.0, 0.04))
        os.kill(run.pid, signal.SIGKILL)
        run.join()
        if path.exists():
            points.append(check(path, fields).points)
    assert len(points) > 3 and points == sorted(points) and points[-1] > points[0]


# Points that wait in the journal


def waiting(path, monkeypatch, count, fields="all"):
    """An archive with one point in the file, and others in the journal."""
    monkeypatch.setattr(writing, "BATCH", 64)
    monkeypatch.setattr(writing, "SECONDS", np.inf)
    archive = Archive.create(path, **fields_content(fields))
    append(archive, 1)
    archive.settle()
    append(archive, count)
    with h5py.File(path) as file:
        assert file.attrs["points"] == 1
    return archive


@pytest.mark.parametrize("fields", ["none", "last", "all"])
def test_points_in_the_journal_are_read_with_the_file(tmp_path, monkeypatch, fields):
    archive = waiting(tmp_path / "run.h5", monkeypatch, 5, fields)
    record = read(archive.path)
    assert record.points == archive.points == 6 and list(record["leg"]) == list(range(6))
    assert record["event"].tolist() == ["none", "fold"] * 3
    assert record.field_points == {"none": [], "last": [5], "all": list(range(6))}[fields]
    assert all(np.all(record.field("traction", number) == -number)
               for number in record.field_points)
    archive.settle()
    assert os.listdir(tmp_path) == ["run.h5"] and check(archive.path, fields).points == 6


def test_a_run_that_takes_its_journal_in_while_it_is_read_hides_no_point(tmp_path, monkeypatch):
    """Between the file, which is open yet, and the journal."""
    archive, found = waiting(tmp_path / "run.h5", monkeypatch, 5), stored.waiting

    def meanwhile(file):
        archive.settle()
        return found(file)

    monkeypatch.setattr(files, "failure", lambda read: "")
    monkeypatch.setattr(stored, "waiting", meanwhile)
    assert read(archive.path).points == archive.points == 6


def test_points_that_are_written_in_place_while_they_are_read_are_there(tmp_path, monkeypatch):
    """Where a file system knows no locks: the journal is gone, and what was read has not them."""
    archive, found = waiting(tmp_path / "run.h5", monkeypatch, 5, "none"), stored.waiting

    def meanwhile(file):
        monkeypatch.setattr(stored, "waiting", found)
        os.utime(file.filename, ns=(0, 0))
        return []

    monkeypatch.setattr(stored, "waiting", meanwhile)
    assert read(archive.path).points == 6


def test_a_file_that_could_not_be_read_while_it_changed_is_read_again(tmp_path, monkeypatch):
    append(archive := Archive.create(tmp_path / "run.h5", **content()), 2)
    found, tried = stored.waiting, []

    def torn(file):
        tried.append(file)
        if len(tried) == 1:
            os.utime(file.filename, ns=(0, 0))
            raise ArchiveError("torn")
        return found(file)

    monkeypatch.setattr(stored, "waiting", torn)
    assert read(archive.path).points == 2 and len(tried) > 1
    monkeypatch.setattr(stored, "waiting", lambda file: 1 / 0)
    with pytest.raises(ArchiveError, match="damaged"):
        read(archive.path)


def test_a_record_that_a_run_has_left_behind_says_so(tmp_path, monkeypatch):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("last"))
    append(archive, 2)
    record = read(archive.path)
    append(archive, 6)
    with pytest.raises(ArchiveError, match="gone on since it was read"):
        record.states()
    with pytest.raises(ArchiveError, match="gone on since it was read"):
        record.field("traction", 1)


def test_fields_of_the_last_point_are_asked_for_where_the_file_is_written(tmp_path, monkeypatch):
    def field(number):
        return np.full((2, X.size), float(number))

    def add(archive, number):
        def found():
            asked.append(number)
            return {"displacement": field(number), "traction": -field(number)}

        archive.append({"leg": number, "normal_force": 1.0, "contact_area": 1.0, "event": "none"},
                       {"position": 0.5}, later=found)

    monkeypatch.setattr(writing, "BATCH", 64)
    monkeypatch.setattr(writing, "SECONDS", np.inf)
    asked, path = [], tmp_path / "run.h5"
    archive = Archive.create(path, **fields_content("last"))
    add(archive, 0)
    archive.settle()
    for number in range(1, 4):
        add(archive, number)
    # killed now: those of the first point are there, by its number
    record = read(path)
    assert asked == [0] and record.points == 4 and record.field_points == [0]
    np.testing.assert_array_equal(record.field("displacement", 0), field(0))
    resumed = Archive.resume(path, **fields_content("last"))
    record = read(path)
    assert resumed.points == record.points == 4 and record.field_points == [0]
    np.testing.assert_array_equal(record.field("traction", 0), -field(0))
    add(resumed, 4)
    add(resumed, 5)
    resumed.finish()
    record = read(path)
    assert asked == [0, 5] and record.points == 6 and record.field_points == [5]
    np.testing.assert_array_equal(record.field("displacement", 5), field(5))


@pytest.mark.parametrize("fields", ["active last", "active all"])
def test_fields_on_active_nodes_wait_in_the_journal_and_are_packed_at_the_end(tmp_path, monkeypatch,
                                                                              fields):
    monkeypatch.setattr(active, "ROOM", 4)  # nodes outgrow the room that there is for them
    archive = waiting(tmp_path / "run.h5", monkeypatch, 5, fields)
    record = read(archive.path)
    assert record.points == 6 and np.all(record.field("displacement", 5) == 5.0)
    archive.settle()
    append(archive, 150)
    archive.finish()
    record = check(archive.path, fields)
    assert record.points == 156 and record.complete
    with h5py.File(archive.path) as file:
        count = file["fields/active/offsets"][-1]
        assert len(file["fields/active/nodes"]) == count == sum(
            len(active_nodes(number)) for number in record.field_points)
        packed = file["fields/active/traction"].compression
    assert packed == ("gzip" if fields.endswith("all") else None)


def test_a_changed_number_on_active_nodes_is_damage(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("active all"))
    append(archive, 5)
    for name in ("nodes", "displacement", "traction", "mean"):
        with h5py.File(archive.path, "r+") as file:
            numbers = file["fields/active"][name]
            place = (0,) * numbers.ndim
            before, numbers[place] = numbers[place], 3
        with pytest.raises(ArchiveError, match="checksum of active at point 0"):
            read(archive.path).field("displacement", 0)
        with h5py.File(archive.path, "r+") as file:
            file["fields/active"][name][place] = before
    with h5py.File(archive.path, "r+") as file:
        file["fields/active/compliance/00"][0] = 1.0
    with pytest.raises(ArchiveError, match="damaged"):
        read(archive.path)


@pytest.mark.parametrize("there, here", [("active all", "all"), ("all", "active all")])
def test_a_run_goes_on_with_the_fields_that_are_there(tmp_path, there, here):
    append(Archive.create(tmp_path / "run.h5", **fields_content(there)), 2)
    with pytest.raises(ArchiveError, match="archive_fields_on is"):
        Archive.resume(tmp_path / "run.h5", **fields_content(here))


@pytest.mark.parametrize("fields", ["none", "last", "all"])
@pytest.mark.parametrize("count", [1, 3, 4, 5, 40])
def test_a_resumed_run_takes_the_journal_in(tmp_path, monkeypatch, fields, count):
    archive = waiting(tmp_path / "run.h5", monkeypatch, count, fields)
    del archive  # killed
    assert check(tmp_path / "run.h5", fields).points == 1 + count
    assert os.listdir(tmp_path) == ["run.h5"]
    append(Archive.resume(tmp_path / "run.h5", **fields_content(fields)), 30)
    assert check(tmp_path / "run.h5", fields).points == 31 + count


def test_a_batch_is_written_at_once_and_leaves_no_journal(tmp_path, monkeypatch):
    archive = waiting(tmp_path / "run.h5", monkeypatch, 63)
    append(archive, 1)
    with h5py.File(archive.path) as file:
        assert file.attrs["points"] == 65
    assert os.listdir(tmp_path) == ["run.h5"]


def test_a_file_is_written_anew_only_where_states_are_larger_than_foreseen(tmp_path, monkeypatch):
    for state, times in ((0, 2), (4096, 1)):
        made = []
        with monkeypatch.context() as patch:
            anew = store.Store._write_anew
            patch.setattr(store.Store, "_write_anew",
                          lambda *arguments: made.append(anew(*arguments)))
            patch.setattr(writing, "BATCH", 64)
            archive = Archive.create(tmp_path / f"{state}.h5", **content(state=state))
            append(archive, 100)
            archive.finish()
        assert len(made) == times
        assert read(archive.path).points == 100 and len(archive.states()) == 4


def test_slow_points_and_large_ones_do_not_wait(tmp_path, monkeypatch):
    for name, value in (("SECONDS", 0.0), ("LARGE", 100)):
        with monkeypatch.context() as patch:
            archive = waiting(tmp_path / f"{name}.h5", patch, 3)
            patch.setattr(writing, name, value)
            append(archive, 1)
            with h5py.File(archive.path) as file:
                assert file.attrs["points"] == archive.points == 5


def test_the_journal_of_another_run_is_left_alone_and_replaced(tmp_path, monkeypatch):
    path = tmp_path / "run.h5"
    waiting(path, monkeypatch, 5)
    other = (tmp_path / "run.h5.journal").read_bytes()
    path.unlink()
    archive = Archive.create(path, **fields_content("all"))
    append(archive, 1)
    archive.settle()
    assert not (tmp_path / "run.h5.journal").exists()
    (tmp_path / "run.h5.journal").write_bytes(other)
    assert read(path).points == 1 and check(path, "all").points == 1
    append(Archive.resume(path, **fields_content("all")), 3)
    assert check(path, "all").points == 4


def test_a_kill_between_the_file_and_the_end_of_the_journal_repeats_no_point(tmp_path, monkeypatch):
    archive = waiting(tmp_path / "run.h5", monkeypatch, 5)
    kept = (tmp_path / "run.h5.journal").read_bytes()
    archive.settle()
    (tmp_path / "run.h5.journal").write_bytes(kept)
    assert read(archive.path).points == 6 and check(archive.path, "all").points == 6


def test_a_disk_that_takes_no_more_of_the_journal_loses_no_point(tmp_path, monkeypatch):
    archive = waiting(tmp_path / "run.h5", monkeypatch, 2)
    write = os.write

    def full(file, data):
        if len(data) < 100:
            raise OSError(28, "No space left on device")
        return write(file, data[:len(data) - 50])

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        with pytest.raises(ArchiveError, match="cannot be written .No space left"):
            append(archive, 1)
    assert archive.points == read(archive.path).points == 3
    append(archive, 2)
    assert check(archive.path, "all").points == 5


@pytest.mark.parametrize("fields", ["all", "last"])
def test_what_is_not_tried_before_is_read_without_another_process(tmp_path, monkeypatch, fields):
    path = tmp_path / "run.h5"
    append(Archive.create(path, **fields_content(fields)), 3)
    tried = read(path)
    expected = list(tried.each(tried.field_points))
    monkeypatch.setattr(files, "failure", None)
    with files.open_archive(path) as file:
        record = Record(file, tried=False)
    found = list(record.each(record.field_points))
    assert len(found) == len(expected) > 0
    for one, other in zip(found, expected):
        np.testing.assert_array_equal(one, other)
    last = record.field_points[-1]
    np.testing.assert_array_equal(record.field("traction", last), expected[-1][1])
    assert record.states().keys() == {0, 1, 2}


def test_an_archive_without_a_key_is_resumed(tmp_path):
    append(Archive.create(tmp_path / "run.h5", **content()), 3)
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        del file.attrs["journal"]
        file.attrs["frame"] = writing.checksums.frame(writing.checksums.parts(file))
    archive = Archive.resume(tmp_path / "run.h5", **content())
    append(archive, 3)
    assert check(tmp_path / "run.h5").points == 6


def test_single_fields_are_half_as_large_and_compressed_at_the_end(tmp_path, monkeypatch):
    monkeypatch.setattr(writing, "BATCH", 64)
    sizes = {}
    for precision in ("double", "single"):
        archive = Archive.create(tmp_path / f"{precision}.h5",
                                 **fields_content("all", precision=precision))
        for number in range(200):
            archive.append(*point(number))
        archive.finish()
        sizes[precision] = (tmp_path / f"{precision}.h5").stat().st_size
    record = read(tmp_path / "single.h5")
    assert record.complete and record.points == 200 and sizes["single"] < sizes["double"]
    with h5py.File(tmp_path / "single.h5") as file:
        assert file["fields/traction"].compression == "gzip"
    whole = read(tmp_path / "double.h5")
    for number in (0, 77, 199):
        found = record.field("displacement", number)
        assert found.dtype == "f4"
        assert np.array_equal(found, whole.field("displacement", number).astype("f4"))
    with pytest.raises(ArchiveError, match="archive_precision is single there and double here"):
        longer = fields_content("all")
        longer["options"] = longer["options"].replace("=400", "=400; normal_force=30")
        Archive.resume(tmp_path / "single.h5", **longer)


def test_a_compressed_archive_takes_more_points(tmp_path):
    content = fields_content("all", precision="single")
    archive = Archive.create(tmp_path / "run.h5", **content)
    for number in range(5):
        archive.append(*point(number))
    archive.finish()
    content["options"] = content["options"].replace("=400", "=400; normal_force=30")
    again = Archive.resume(tmp_path / "run.h5", **content)
    assert not again.complete and again.points == 5
    again.append(*point(5))
    again.settle()
    record = read(tmp_path / "run.h5")
    assert record["leg"].tolist() == list(range(6))
    for number in range(6):
        assert np.array_equal(record.field("traction", number),
                              np.asarray(point(number)[3], "f4"))


def test_single_tractions_beyond_their_digits_are_nothing(tmp_path):
    archive = Archive.create(tmp_path / "run.h5", **fields_content("all", precision="single"))
    row, state, field, _ = point(1)
    traction = np.tile([1.0, -1e-8, 1e-10, 0.0], (2, 8))
    archive.append(row, state, 1e-10 * field, traction)
    archive.finish()
    record = read(tmp_path / "run.h5")
    assert np.array_equal(record.field("traction", 0)[0, :4], np.array([1, -1e-8, 0, 0], "f4"))
    assert np.all(record.field("displacement", 0) == np.float32(1e-10))
