"""Archives as tables, data frames and files of VTK."""

import csv
import io
import os

import h5py
import numpy as np
import pytest

from contactsnes.commands import showing
from contactsnes.options.fields import InputError
from contactsnes.options.words import read_words
from contactsnes.output import extras, files, tabular
from contactsnes.output.archive import Archive
from contactsnes.output.asked import ExportOptions, TableOptions
from contactsnes.output.columns import Column
from contactsnes.output.figures.curves import labels
from contactsnes.output.files import ArchiveError
from contactsnes.output.reading import read
from contactsnes.output.tables import replaced
from contactsnes.output.vtk import write_vtk

X, Y = np.arange(-3.0, 3.0), np.arange(-2.0, 2.0)
EVENTS = ("none", "fold", "jump", "pull_off")
pytestmark = pytest.mark.usefixtures("read_here")


def archive(path, events=("none", "fold", "jump", "none"), unit="w_n,r", fields="none",
            friction=0.5, options="", more=(), finished=True):
    """An archive whose point number i has the force i/3, and fields that tell their place; columns
    `more` hold its number."""
    grid = {} if fields == "none" else dict(coordinates=(X, Y), components=3, initial_gap=gap())
    made = Archive.create(path, scene={"residual_friction": friction, "period": (6.0, 4.0)},
                          options=options, versions={}, fields=fields,
                          columns={"normal_force": Column(unit), "leg": Column("", "i8"),
                                   "event": Column("", "i1", EVENTS),
                                   **dict.fromkeys(more, Column("1"))}, **grid)
    for number, event in enumerate(events):
        made.append({"normal_force": number / 3, "leg": 1, "event": event,
                     **dict.fromkeys(more, number)}, {}, *(
            () if fields == "none" else (field(number), -field(number))))
    made.finish() if finished else made.settle()
    return path


def gap():
    return X[:, None] ** 2 + 0.1 * Y[None, :]


def field(number):
    """Normal: x + 10 y; tangential along x: the number of the point; along y: 2 x."""
    normal = X[:, None] + 10.0 * Y[None, :]
    return np.array([normal, np.full_like(normal, number), 2.0 * X[:, None] + 0.0 * normal])


def lines(text):
    return list(csv.reader(io.StringIO(text)))


def test_numbers_in_csv_are_those_of_the_archive(tmp_path):
    path = archive(tmp_path / "a.h5")
    table = tabular.tabulate([path], TableOptions(columns="point, normal_force,event"))
    heading, *rows = lines(tabular.as_csv(table, units=True))
    assert heading == ["point", "normal_force [w_n,r]", "event"]
    assert [float(row[1]) for row in rows] == [number / 3 for number in range(4)]
    assert rows[1][::2] == ["1", "fold"]
    assert lines(tabular.as_csv(table))[0] == ["point", "normal_force", "event"]


@pytest.mark.parametrize("rows, points", [("last", [3, 0]), ("event", [1]), ("jump", [2]),
                                          ("pull_off", []), ("all", [0, 1, 2, 3, 0])])
def test_rows_are_points_or_runs(tmp_path, rows, points):
    paths = [archive(tmp_path / "a.h5"), archive(tmp_path / "b.h5", ["none"], friction=1.0)]
    table = tabular.tabulate(paths, TableOptions(columns="archive,point,scene_residual_friction",
                                                 rows=rows))
    assert table.columns["point"].tolist() == points
    assert len(table.notes) == 2 - len(set(table.columns["archive"]))
    if rows == "last":
        assert table.columns["scene_residual_friction"].tolist() == [0.5, 1.0]


def test_a_table_refuses_what_does_not_fit(tmp_path):
    one, other = archive(tmp_path / "a.h5"), archive(tmp_path / "b.h5", unit="N")
    with pytest.raises(InputError, match="normal_force in 'N'.*'w_n,r'"):
        tabular.tabulate([one, other], TableOptions())
    with pytest.raises(InputError, match="no column normal_forc: did you mean normal_force"):
        tabular.tabulate([one], TableOptions(columns="normal_forc"))
    for name, option in (("stiffness", "-archive_stiffness"), ("error_slip", "-archive_errors")):
        with pytest.raises(InputError, match=f"no column {name}: {option} writes it"):
            tabular.tabulate([one], TableOptions(columns=name))
    with pytest.raises(InputError, match="-rows is 'some'"):
        read_words(["-rows", "some"], TableOptions)
    with pytest.raises(InputError, match="by -output"):
        tabular.write_table([one, one], None, TableOptions(format="parquet"))
    with pytest.raises(ArchiveError, match="no such file"):
        tabular.tabulate([tmp_path / "absent.h5"], TableOptions())
    assert tabular.tabulate([one], TableOptions(columns="scene_period")).columns[
        "scene_period"][0] == "6.0,4.0"


@pytest.mark.parametrize("kind, name", [("csv", "a.parquet"), ("parquet", "a.csv")])
def test_a_file_of_one_kind_has_not_the_name_of_another(tmp_path, kind, name):
    path, target = archive(tmp_path / "a.h5"), tmp_path / name
    asked = TableOptions(format=kind, output=str(target))
    with pytest.raises(InputError, match=f"-format is '{kind}': name another"):
        tabular.write_table([path], tabular.tabulate([path], asked), asked)
    assert not target.exists()


@pytest.mark.parametrize("command, name, allowed", [
    ("table", "a.feather", r"\.csv or \.txt or \.dat"), ("export", "a.vtu", r"\.vtkhdf or \.hdf"),
    ("report", "a.pdf", r"\.html or \.htm"), ("movie", "a.avi", r"\.mp4 or \.gif")])
def test_a_file_has_not_the_name_of_an_unknown_kind(tmp_path, command, name, allowed):
    path, target = archive(tmp_path / "run.h5", fields="all"), tmp_path / name
    with pytest.raises(InputError, match=rf"-output is '{target}': the name .* in {allowed}$"):
        getattr(showing, command)([str(path), "-output", str(target)])
    assert [file.name for file in tmp_path.iterdir()] == ["run.h5"]


@pytest.mark.parametrize("name", ["numbers", "numbers.TXT"])
def test_a_table_may_have_no_ending_or_one_of_text(tmp_path, name):
    path = archive(tmp_path / "run.h5")
    asked = TableOptions(output=str(tmp_path / name), rows="last", columns="point")
    tabular.write_table([path], tabular.tabulate([path], asked), asked)
    assert (tmp_path / name).read_text() == "point\n3\n"


def test_a_table_goes_into_a_pipe_without_a_name():
    ours, theirs = os.pipe()
    replaced(f"/dev/fd/{theirs}", lambda path: path.write_text("point\n"))
    assert os.read(ours, 100) == b"point\n"
    for number in (ours, theirs):
        os.close(number)


def test_a_name_that_is_no_text_is_written_in_letters(tmp_path):
    path = archive(tmp_path / os.fsdecode(b"f\xfcr.h5"))
    asked = TableOptions(columns="archive", rows="last", output=str(tmp_path / "t.csv"))
    tabular.write_table([path], tabular.tabulate([path], asked), asked)
    assert (tmp_path / "t.csv").read_text("utf-8").endswith("f\\xfcr.h5\n")
    assert labels([read(path)]) == ["f\\xfcr"]


def test_attributes_of_scenes_have_their_units(tmp_path):
    scenes = {"a.h5": {"period": 20.0, "contact_threshold": 1.0},
              "b.h5": {"period": 0.02, "contact_threshold": 2.0, "units": "si"}}
    for name, scene in scenes.items():
        made = Archive.create(tmp_path / name, scene=scene, options="", versions={},
                              columns={"leg": Column("", "i8")})
        made.append({"leg": 0}, {})
        made.finish()
    one, other = (tmp_path / name for name in scenes)
    asked = TableOptions(columns="scene_period,scene_contact_threshold,leg")
    for path, unit in ((one, "beta"), (other, "m")):
        assert lines(tabular.as_csv(tabular.tabulate([path], asked), units=True))[0] == [
            f"scene_period [{unit}]", "scene_contact_threshold [delta_n]", "leg"]
    with pytest.raises(InputError, match="scene_period in 'm', archives before it in 'beta'"):
        tabular.tabulate([one, other], asked)
    asked = TableOptions(columns="scene_contact_threshold")
    assert tabular.tabulate([one, other], asked).columns[asked.columns].tolist() == [1.0, 2.0]


def test_a_table_of_a_study_tells_its_runs_apart(tmp_path):
    paths = [archive(tmp_path / f"{number}.h5", friction=friction, options=(
        f'-load_path "normal_force={force}" -scene_residual_friction {friction} '
        f"-archive_file {number}.h5 -load_stop none"))
        for number, (friction, force) in enumerate([(0.5, 1), (0.5, 2), (0.25, 2)])]
    table = tabular.tabulate(paths, TableOptions(rows="last"))
    assert list(table.columns) == ["archive", "scene_residual_friction", "load_path", "point",
                                   "event", "leg", "normal_force"]
    assert table.columns["scene_residual_friction"].tolist() == [0.5, 0.5, 0.25]
    assert table.columns["load_path"].tolist() == [f"normal_force={force}" for force in (1, 2, 2)]
    assert list(tabular.tabulate(paths[:1], TableOptions()).columns) == [
        "point", "event", "leg", "normal_force"]
    assert tabular.tabulate(paths, TableOptions(columns="load_stop", rows="last")).columns[
        "load_stop"].tolist() == ["none"] * 3
    # what was typed in place of an attribute of the scene
    path = archive(tmp_path / "typed.h5", options="-scene_young_modulus 2e6")
    asked = TableOptions(columns="scene_young_modulus", rows="last")
    assert tabular.tabulate([path], asked).columns[
        "scene_young_modulus"].tolist() == ["2e6"]


def test_columns_that_some_archives_lack_are_empty_there(tmp_path):
    paths = [archive(tmp_path / "a.h5"), archive(tmp_path / "b.h5", more=["stiffness"])]
    for columns in ("", "stiffness,point"):
        table = tabular.tabulate(paths, TableOptions(columns=columns, rows="last"))
        assert table.columns["stiffness"].tolist() == [None, 3.0]
        assert table.notes == [f"{paths[0]}: no column stiffness, its cells are empty"]
        at = list(table.columns).index("stiffness")
        assert [row[at] for row in lines(tabular.as_csv(table))] == ["stiffness", "", "3.0"]
    with pytest.raises(InputError, match="no column stifness: did you mean stiffness"):
        tabular.tabulate(paths, TableOptions(columns="stifness"))


def test_archives_that_cannot_be_read_or_are_not_complete_are_named(tmp_path):
    good, under_way = archive(tmp_path / "a.h5"), archive(tmp_path / "b.h5", finished=False)
    broken, absent = tmp_path / "broken.h5", tmp_path / "absent.h5"
    broken.write_bytes(good.read_bytes()[:900])
    table = tabular.tabulate([absent, good, broken, under_way],
                             TableOptions(rows="last", columns="archive,complete"))
    assert table.columns["archive"].tolist() == [str(good), str(under_way)]
    assert table.columns["complete"].tolist() == [1, 0]
    assert [str(absent) in table.unread[0], str(broken) in table.unread[1]] == [True, True]
    assert len(table.unread) == 2 and str(under_way) in table.notes[0]
    with pytest.raises(ArchiveError, match="absent.h5.*broken.h5"):
        tabular.tabulate([absent, broken], TableOptions())


@pytest.mark.parametrize("command", [showing.table, showing.report, showing.movie, showing.export])
def test_an_archive_is_not_replaced_by_what_is_made_of_it(tmp_path, command, monkeypatch):
    """Neither the one that is shown, by whatever path, nor another."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.h5", "b.h5", "c.hdf"):
        archive(tmp_path / name, fields="all")
    (tmp_path / "link.gif").symlink_to("a.h5")
    before = [(tmp_path / name).read_bytes() for name in ("a.h5", "b.h5", "c.hdf")]
    for path, output in (("a.h5", "a.h5"), ("a.h5", "./b.h5"), ("a.h5", "link.gif"),
                         ("c.hdf", "c.hdf")):
        with pytest.raises(InputError, match=f"-output is '{output}', an archive: name another"):
            command([path, "-output", output])
    assert before == [(tmp_path / name).read_bytes() for name in ("a.h5", "b.h5", "c.hdf")]


@pytest.mark.parametrize("command, name", [
    ("report", "run.html"), ("export", "run.vtkhdf"), ("movie -format gif", "run.gif"),
    ("table -format parquet", "run.parquet")])
def test_an_archive_of_any_name_is_not_replaced_by_what_would_lie_beside_it(tmp_path, command,
                                                                           name):
    path = archive(tmp_path / name, fields="all")
    before = path.read_bytes()
    word, *others = command.split()
    with pytest.raises(InputError, match=f"would replace .*{name}, an archive: .* by -output"):
        getattr(showing, word)([str(path), *others])
    assert path.read_bytes() == before


@pytest.mark.parametrize("command", [showing.report, showing.movie, showing.export])
def test_files_of_archives_that_differ_by_an_ending_do_not_replace_each_other(tmp_path, command):
    paths = [str(archive(tmp_path / name, fields="all")) for name in ("maugis-0.1", "maugis-0.5")]
    with pytest.raises(InputError, match="0.5 would have files of the names that those of .*0.1"):
        command(paths)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_pipe_is_no_archive_and_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert not files.is_archive(tmp_path / "pipe", ["a.h5"])


def test_parquet_holds_values_and_units(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    path = archive(tmp_path / "a.h5")
    asked = TableOptions(format="parquet")
    written = tabular.write_table([path], tabular.tabulate([path], asked), asked)
    found = parquet.read_table(written)
    assert written == tmp_path / "a.parquet"
    assert found["normal_force"].to_pylist() == [number / 3 for number in range(4)]
    assert found["event"].to_pylist()[1] == "fold"
    assert found.schema.field("normal_force").metadata == {b"unit": b"w_n,r"}


def test_parquet_without_rows_has_the_types_of_one_with_rows(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    path, types = archive(tmp_path / "a.h5"), []
    for rows in ("all", "gross_sliding"):
        asked = TableOptions(format="parquet", output=str(tmp_path / f"{rows}.parquet"), rows=rows,
                             columns="archive,point,event,normal_force,complete")
        found = parquet.read_table(
            tabular.write_table([path], tabular.tabulate([path], asked), asked))
        types.append([str(field.type) for field in found.schema])
    assert found.num_rows == 0 and types[0] == types[1]
    assert types[0] == ["string", "int64", "string", "double", "int64"]


def test_a_record_is_a_data_frame(tmp_path):
    pytest.importorskip("pandas")
    frame = read(archive(tmp_path / "a.h5")).to_dataframe()
    assert frame["normal_force"].tolist() == [number / 3 for number in range(4)]
    assert frame.attrs["units"]["normal_force"] == "w_n,r" and frame.index.name == "point"


def test_a_missing_library_says_how_to_get_it():
    with pytest.raises(InputError, match=r"pip install no_such_library, or contactsnes\[table\]"):
        extras.extra("no_such_library.part", "table", "this")


@pytest.mark.parametrize("error", ["ImportError", "ValueError", "AttributeError"])
def test_a_library_that_does_not_go_with_others_is_not_installed_again(tmp_path, monkeypatch,
                                                                       error):
    """What is compiled against another NumPy ends as its kind has it."""
    (tmp_path / "unhappy.py").write_text(f"raise {error}('unhappy needs NumPy 9')")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(InputError, match="NumPy 9.*an older unhappy"):
        extras.extra("unhappy", "table", "this")


def test_the_repr_of_a_record_tells_what_it_holds(tmp_path):
    text = repr(read(archive(tmp_path / "a.h5", fields="all")))
    for words in ("a.h5: 4 points", "normal_force 0 to 1 w_n,r", "fold, jump",
                  "fields of 4 points"):
        assert words in text


def test_fields_of_an_archive_name_components_axes_and_units(tmp_path):
    with h5py.File(archive(tmp_path / "a.h5", fields="all")) as file:
        for name, units in (("displacement", ["u_n,r", "u_t,r", "u_t,r"]),
                            ("traction", ["p_n,r", "p_t,r", "p_t,r"])):
            dataset = file[f"fields/{name}"]
            assert list(dataset.attrs["components"]) == ["normal", "tangential_x", "tangential_y"]
            assert list(dataset.attrs["component_units"]) == units
            axes = ["point", "component", "x", "y"]
            assert list(dataset.attrs["axes"]) == axes == [axis.label for axis in dataset.dims]


def test_a_file_of_vtk_has_the_layout_that_vtk_reads(tmp_path):
    # in their order, each once
    path = write_vtk(archive(tmp_path / "a.h5", fields="all"), ExportOptions(points="-1,1,3"))
    with h5py.File(path) as file:
        image = file["VTKHDF"]
        assert image.attrs["Type"] == b"ImageData" and image.attrs["Version"][0] == 2
        assert list(image.attrs["WholeExtent"]) == [0, 5, 0, 3, 0, 0]
        assert list(image.attrs["Origin"]) == [-3.0, -2.0, 0.0]
        assert list(image["Steps/Values"]) == [1.0, 3.0] and image["Steps"].attrs["NSteps"] == 2
        assert image["PointData/slip (u_t,r)"].shape == (2, 4, 6, 3)
        force = "normal force (w_n,r)"
        assert image[f"FieldData/{force}"][()].tolist() == [1 / 3, 1.0]
        assert image[f"Steps/FieldDataOffsets/{force}"][()].tolist() == [0, 1]
        assert image[f"Steps/FieldDataSizes/{force}"][()].tolist() == [[1, 1], [1, 1]]


def test_vtk_finds_each_value_where_it_belongs(tmp_path):
    reader = pytest.importorskip("vtkmodules.vtkIOHDF").vtkHDFReader()
    path = write_vtk(archive(tmp_path / "a.h5", fields="all"), ExportOptions())
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 4
    reader.SetStep(2)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetFieldData().GetArray("normal force (w_n,r)").GetValue(0) == 2 / 3
    for number in range(image.GetNumberOfPoints()):
        x, y, _ = image.GetPoint(number)
        values = image.GetPointData()
        assert values.GetArray("normal displacement (u_n,r)").GetValue(number) == x + 10.0 * y
        assert values.GetArray("pressure (p_n,r)").GetValue(number) == x + 10.0 * y
        assert values.GetArray("slip (u_t,r)").GetTuple(number) == (2.0, 2.0 * x, 0.0)
        assert values.GetArray("gap (u_n,r)").GetValue(number) == pytest.approx(
            x ** 2 + 0.1 * y + x + 10.0 * y, rel=1e-6, abs=1e-5)


def test_one_point_is_an_image_without_time(tmp_path):
    path = write_vtk(archive(tmp_path / "a.h5", fields="all"), ExportOptions(points="2"))
    with h5py.File(path) as file:
        assert "Steps" not in file["VTKHDF"]
        assert file["VTKHDF/PointData/gap (u_n,r)"].shape == (4, 6)
    reader = pytest.importorskip("vtkmodules.vtkIOHDF").vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetFieldData().GetArray("normal force (w_n,r)").GetValue(0) == 2 / 3
    for number in range(image.GetNumberOfPoints()):
        x, _, _ = image.GetPoint(number)
        assert image.GetPointData().GetArray("slip (u_t,r)").GetTuple(number) == (2.0, 2.0 * x, 0.0)


@pytest.mark.parametrize("points", ("", "1"))
def test_numbers_with_a_stroke_in_their_unit_are_shown(points, tmp_path):
    path = archive(tmp_path / "a.h5", fields="all", unit="N/m")
    with h5py.File(write_vtk(path, ExportOptions(points=points))) as file:
        data = file["VTKHDF/FieldData"]
        assert list(data) == ["normal force (N per m)"]
        assert list(data["normal force (N per m)"][:]) == ([1 / 3] if points else
                                                           [0, 1 / 3, 2 / 3, 1])


def test_an_export_refuses_what_is_not_there(tmp_path):
    with pytest.raises(ArchiveError, match="has no fields: run with -archive_fields"):
        write_vtk(archive(tmp_path / "a.h5"), ExportOptions())
    empty = archive(tmp_path / "c.h5", (), fields="all", finished=False)
    with pytest.raises(ArchiveError, match="has no points to write yet"):
        write_vtk(empty, ExportOptions())
    path = archive(tmp_path / "b.h5", fields="all")
    with pytest.raises(ArchiveError, match="no fields of point 9; it has those of 0 to 3"):
        write_vtk(path, ExportOptions(points="9"))
    with pytest.raises(InputError, match="folder does not exist"):
        write_vtk(path, ExportOptions(output=str(tmp_path / "absent/a.vtkhdf")))
    with pytest.raises(InputError, match="whose folder is a file: move it away, or name another"):
        write_vtk(path, ExportOptions(output=str(path / "a.vtkhdf")))
    with pytest.raises(InputError, match="-output is '.*', a folder: name a file"):
        write_vtk(path, ExportOptions(output=str(tmp_path)))
