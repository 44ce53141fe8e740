"""Figures of archives: those that make sense are written, the others are named with the reason."""

import re
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.textpath import TextPath

from contactsnes.commands import cli
from contactsnes.options.fields import InputError
from contactsnes.output.archive import Archive
from contactsnes.output.asked import MovieOptions, PlotOptions
from contactsnes.output.columns import Column
from contactsnes.output.figures import (
    curves,
    data,
    loads,
    maps,
    measured,
    movie,
    parts,
    profiles,
    shape,
    spots,
    style,
    surface,
    words,
)
from contactsnes.output.figures import plot as plotting
from contactsnes.output.figures.plot import plot
from contactsnes.output.files import ArchiveError
from contactsnes.output.prefixes import read

EVENTS = ("none", "fold", "jump", "gross_sliding", "pull_off", "bifurcation")
LENGTH, RANGE = 100.0, 0.1  # period of the cell, range of the law
pytestmark = pytest.mark.usefixtures("read_here")


def columns(dimension=1):
    axes = ("",) if dimension == 1 else ("_x", "_y")
    force = ("w_n,r", "w_t,r") if dimension == 1 else ("R phi_n", "R phi_n sqrt(phi_t/phi_n)")
    return {
        "leg": Column("", "i8"),
        "normal_displacement": Column("u_n,r"),
        "approach": Column("u_n,r"),
        "normal_force": Column(force[0]),
        **{f"tangential_displacement{axis}": Column("u_t,r") for axis in axes},
        **{f"tangential_force{axis}": Column(force[1]) for axis in axes},
        "contact_area": Column("beta" if dimension == 1 else "beta^2"),
        "event": Column("", "i1", EVENTS),
        "fold_kind": Column("", "i1", ("", "pull_off", "jump_in", "sliding")),
    }


def archive_of(path, rows, fields="none", **grid):
    scene = {"normal_maugis": 1 / RANGE, "contact_threshold": np.e}
    dimension = len(grid.get("coordinates", (0,)))
    content = dict(scene=scene, options="", versions={}, columns=columns(dimension), fields=fields,
                   **grid)
    archive = Archive.create(path, **content)
    for row, arrays in rows:
        blank = {name: 0 for name in columns(dimension)}
        archive.append({**blank, "event": "none", "fold_kind": "", **row}, {}, *arrays)
    return archive


def jkr(half_width, compliance=0.0):
    """Normal force and displacement of an adhesive cylinder (JKR) in a periodic cell."""
    force = np.pi * half_width**2 / 4 - np.sqrt(2 * np.pi * half_width)
    displacement = 2 / np.pi * (force * np.log(LENGTH / np.pi / half_width) + np.pi * half_width**2
                                / 8)
    return dict(normal_force=force, approach=displacement, contact_area=2 * half_width,
                normal_displacement=displacement + compliance * force)


def loading(compliance=0.0, contact=(0.86, 6.3), count=30):
    """Loading from the jump into contact on, out to pull-off and away."""
    apart = {"contact_area": 0, "normal_force": -0.05}
    rows = [{**jkr(1.35, compliance), **apart, "event": "fold", "fold_kind": "jump_in"}]
    rows.append({**jkr(1.35, compliance), "event": "jump"})
    rows += [jkr(half_width, compliance) for half_width in np.linspace(1.5, contact[1], count)]
    rows += [jkr(half_width, compliance) for half_width in np.linspace(contact[1], contact[0],
                                                                       count)[1:]]
    rows[-1] |= dict(event="fold", fold_kind="pull_off")
    rows.append({**rows[-1], **apart, "event": "jump", "fold_kind": ""})
    return rows + [{**rows[-1], "event": "pull_off"}]


def shear(half_width=6.3, count=40, axis=""):
    """Tangential load up to a fold, a jump into gross sliding, and sliding."""
    rows, load = [], np.linspace(0, 380, count)
    for step in load:
        force = step / 52
        rows.append({**jkr(half_width), f"tangential_displacement{axis}": step,
                     f"tangential_force{axis}": force,
                     "contact_area": 2 * half_width * (1 - 0.0045 * force**2)})
    rows[-1] |= dict(event="fold", fold_kind="sliding")
    slid = {**rows[-1], f"tangential_force{axis}": 4.4, "contact_area": 1.55 * half_width,
            "fold_kind": ""}
    rows += [{**slid, "event": "jump"}, {**slid, "event": "gross_sliding"}]
    return rows + [{**slid, f"tangential_displacement{axis}": step, "event": "none"}
                   for step in (390, 400, 420)]


def line_fields(x, row):
    """Displacement and traction like those of a cylinder with a cohesive zone."""
    half = max(row["contact_area"] / 2, 0.1)
    outside = np.maximum(np.abs(x) - half, 0)
    singular = np.sqrt(np.maximum(half**2 - x**2, 0) + 0.02)
    inside = RANGE * (np.sqrt(2 * np.pi * half) / np.pi / singular - singular / 2)
    gap = np.where(outside > 0, RANGE + 0.7 * outside**0.5 + 0.9 * half**0.5 * outside**1.5,
                   -0.5 * RANGE)
    gap[outside == 0] = RANGE * np.clip(np.where(inside > 0, np.e * inside, inside), -2,
                                        1)[outside == 0]
    attraction = np.where(outside > 0, gap / RANGE * np.exp(-gap / RANGE),
                          np.minimum(inside, 1 / np.e))
    slip = np.minimum(row["tangential_force"] / (np.pi * singular),
                      0.858) * np.exp(-np.maximum(gap, 0) / RANGE)
    return np.array([gap - x**2 / 2, 0 * x]), np.array([attraction, slip])


def line_archive(path, rows, fields="all", nodes=512):
    x = (np.arange(nodes) - nodes // 2) * LENGTH / nodes
    rows = [(row, line_fields(x, {"tangential_force": 0, **row})) for row in rows]
    return archive_of(path, rows, fields, coordinates=(x,), components=2, initial_gap=x**2 / 2)


def plane_archive(path, rows, components=3, nodes=96):
    """Fields like those of a sheared sphere, smaller along the shear than across it."""
    x = (np.arange(nodes) - nodes // 2) * 12 / nodes
    radius = np.hypot(*np.meshgrid(x, x, indexing="ij"))
    rows = [(row, plane_fields(x, radius, components, row)) for row in rows]
    return archive_of(path, rows, "all", coordinates=(x, x), components=components,
                      initial_gap=radius**2 / 2)


def plane_fields(x, radius, components, row):
    half = np.sqrt(row["contact_area"] / np.pi)
    shrunk = np.hypot(x[:, None] * 1.15, x[None, :])
    depth = np.sqrt(np.maximum(1 - (shrunk / max(half, 1e-9)) ** 2, 0))
    gap = np.where(shrunk < half, RANGE * np.e * (1 - 1.4 * depth**0.5),
                   RANGE * np.e + (shrunk - half).clip(0) ** 1.3)
    traction = np.zeros((components, *radius.shape))
    traction[0] = gap / RANGE * np.exp(-gap / RANGE)
    if components > 1:
        traction[1] = row.get("tangential_force_x", 0) / 8 * np.exp(-gap.clip(0) / RANGE) / np.sqrt(
            depth + 0.1)
        traction[2] = 0.1 * traction[1] * np.sin(2 * np.arctan2(x[None, :], x[:, None]))
    displacement = np.zeros_like(traction)
    displacement[0] = gap - radius**2 / 2
    return displacement, traction


def names_of(figures):
    return sorted(file.name for file in figures.files)


@pytest.fixture
def undrawn(monkeypatch):
    """Files of figures are empty: to draw them is nearly all that a figure costs, and what they
    look like has tests of its own."""
    monkeypatch.setattr(plotting, "saved", lambda figure, path: path.touch())


@pytest.fixture
def coarse(monkeypatch):
    """Pictures of few pixels: how many dots an inch has."""
    monkeypatch.setitem(style.STYLE, "savefig.dpi", 60)
    return 60


def check_images(figures, dots=300):
    """Each figure is as wide as a column, maps of several points as two, and not empty."""
    for file in figures.files:
        if file.suffix == ".png":
            image = imread(file)
            columns_wide = 2 if file.stem.endswith("maps") else 1
            assert abs(image.shape[1] - columns_wide * 8.5 / 2.54 * dots) < 2
            assert np.std(image) > 0.02


def test_numbers_at_ticks_are_text_and_their_power_of_ten_is_not(tmp_path):
    """As mathematics, which matplotlib sets slowly, they are the same."""
    with rc_context(style.settings()):
        figure = Figure()
        axes = figure.subplots()
        axes.plot([-1.5, 2.0], [0.0, 4e7])
        figure.draw_without_rendering()
        before = [axis.get_majorticklabels() for axis in (axes.xaxis, axes.yaxis)]
        before = [label.get_text() for labels in before for label in labels]
        style.saved(figure, tmp_path / "text.png")
        after = [label.get_text() for axis in (axes.xaxis, axes.yaxis)
                 for label in axis.get_majorticklabels()]
        assert before == [f"$\\mathdefault{{{text}}}$" for text in after]
        assert {"\N{MINUS SIGN}1.5", "2.0"} <= set(after)
        assert "10^{7}" in axes.yaxis.get_offset_text().get_text()


def test_what_needs_fields_says_that_none_are_stored(tmp_path, undrawn):
    archive_of(tmp_path / "run.h5", [(jkr(half_width), ()) for half_width in (2.0, 3.0)])
    skipped = plot(tmp_path / "run.h5").skipped
    assert all("no fields are stored" in skipped[kind]
               for kind in ("maps", "outlines", "profiles", "spots"))


def test_a_sheared_line_contact_has_all_figures_but_maps(tmp_path, coarse):
    rows = [jkr(half_width) for half_width in np.linspace(1.5, 6.3, 20)] + shear()
    line_archive(tmp_path / "run.h5", rows)
    figures = plot(tmp_path / "run.h5")
    assert names_of(figures) == [f"run-{kind}.png" for kind in ("approach", "area", "profiles",
                                                                "shear")]
    assert figures.skipped == {"maps": "the interface has one dimension",
                               "outlines": "the interface has one dimension",
                               "spots": "the interface has one dimension",
                               "shape": "the archive has no columns of the contact's shape"}
    check_images(figures, coarse)


def test_normal_loading_has_no_tangential_figures(tmp_path, coarse):
    archive_of(tmp_path / "run.h5", [(row, ()) for row in loading()])
    (tmp_path / "figures").mkdir()
    figures = plot(tmp_path / "run.h5", output=tmp_path / "figures", pdf=True)
    assert names_of(figures) == ["run-approach.pdf", "run-approach.png"]
    assert all(file.parent.name == "figures" and file.stat().st_size > 1000
               for file in figures.files)
    assert figures.skipped["shear"] == figures.skipped["area"] == "there is no tangential load"
    assert "-archive_fields" in figures.skipped["profiles"]


def test_a_two_dimensional_interface_has_maps(tmp_path, coarse):
    plane_archive(tmp_path / "run.h5", shear(1.5, 10, "_x"))
    figures = plot(tmp_path / "run.h5", points=[0, -1])
    assert names_of(figures) == [f"run-{kind}.png" for kind in ("area", "maps", "outlines",
                                                                "profiles", "shear")]
    assert figures.skipped == {"approach": "the normal load does not move",
                               "spots": "no stored point has more than one spot",
                               "shape": "the archive has no columns of the contact's shape"}
    check_images(figures, coarse)


def test_spots_are_numbered_from_the_largest_on(tmp_path, undrawn):
    """One around a corner of the cell, one of four nodes, one of one node; fewer at another
    point."""
    axes = (np.arange(8) - 4.0,) * 2
    many = np.ones((3, 8, 8))
    for node in ((0, 0), (7, 0), (0, 7), (7, 7), (7, 6), (2, 2), (2, 3), (3, 2), (3, 3), (5, 5)):
        many[(0, *node)] = 0.0
    few = np.ones((3, 8, 8))
    few[0, 2, 2] = few[0, 5, 5] = 0.0
    tractions = [np.where(field == 0.0, -1.0, 0.0) for field in (few, many)]
    archive_of(tmp_path / "run.h5", [({"normal_force": i}, (field, traction)) for i, (field,
               traction) in enumerate(zip((few, many), tractions))], "all", coordinates=axes,
               components=3, initial_gap=np.zeros((8, 8)))
    figure = spots.draw_spots(read(tmp_path / "run.h5"), None)
    chart, sizes = figure.axes
    assert sorted(text.get_text() for text in chart.texts) == ["1", "2", "3"]
    places = {text.get_text(): tuple(text.xy) for text in chart.texts}
    assert places["3"] == (1.0, 1.0) and abs(places["1"][0]) >= 3 <= abs(places["1"][1])
    found = [list(zip(*line.get_data())) for line in sizes.lines]
    assert found == [[(1.0, 1), (1.0, 2)], [(5.0, 1), (4.0, 2), (1.0, 3)]]
    # few spots: each a mark, their number along a linear axis
    assert sizes.get_yscale() == "linear" and {line.get_marker() for line in sizes.lines} == {"."}
    (tmp_path / "figures").mkdir()
    assert any(file.name == "run-spots.png" for file in plot(
        tmp_path / "run.h5", output=tmp_path / "figures").files)


def test_normal_load_under_shear_is_part_of_the_approach(tmp_path):
    rows = [jkr(half_width) for half_width in (2, 4, 6.3)] + shear(count=5)[1:5]
    unloading = [{**rows[-1], **jkr(half_width)} for half_width in (4, 2)]
    for name, last in (("held", []), ("unloaded", unloading)):
        record = read(archive_of(tmp_path / f"{name}.h5",
                                       [(row, ()) for row in rows + last]).path)
        curve = loads.draw_approach(record).axes[0].lines[0].get_xdata()
        assert len(curve) == (record.points if last else 3)


@pytest.mark.parametrize("fields", ["none", "last"])
def test_an_archive_of_one_point_has_figures(tmp_path, fields):
    line_archive(tmp_path / "run.h5", [jkr(6.3)], fields)
    figures = plot(tmp_path / "run.h5")
    assert names_of(figures) == ["run-approach.png"] + ["run-profiles.png"] * (fields == "last")
    check_images(figures)


def test_shear_begins_where_the_tangential_load_does(tmp_path):
    rows = [jkr(2), jkr(4), jkr(6.3), *shear()[1:]]
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in rows]).path)
    assert data.shear(record) == ("", slice(2, None))
    figure = loads.draw_area(record)
    start = figure.axes[0].lines[0].get_xydata()[0]
    assert tuple(start) == (0, 12.6)


def test_numbers_that_hardly_differ_stand_at_the_ticks(tmp_path):
    """What is common to them, above the axis, would lie under the legend."""
    rows = [row | {"contact_area": 25.4 + 1e-6 * number} for number, row in enumerate(shear())]
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in rows]).path)
    with rc_context(style.settings()):
        figure = loads.draw_area(record)
        figure.canvas.draw()
        axis = figure.axes[0].yaxis
        assert not axis.get_offset_text().get_text()
        told = [float(re.search(r"[\d.]+", label.get_text())[0]) for label in axis.get_ticklabels()]
        np.testing.assert_allclose(told, axis.get_ticklocs(), atol=1e-9)


def test_jumps_are_dashed_between_the_fold_and_the_point_after_it(tmp_path):
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()]).path)
    fold, jump = (int(np.flatnonzero(record["event"] == name)[0]) for name in ("fold", "jump"))
    assert jump == fold + 1
    axes = loads.draw_area(record).axes[0]
    (dashed,) = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert np.array_equal(dashed.get_xdata(), record["tangential_force"][fold : jump + 1])
    for line in axes.lines:
        ends = record["tangential_force"][[fold, jump]]
        assert line is dashed or not set(ends) <= set(line.get_xdata())
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts == ["start", "fold (sliding)", "jump", "gross sliding"]


def test_profiles_are_those_of_the_chosen_points_near_the_contact(tmp_path):
    line_archive(tmp_path / "run.h5", shear())
    record = read(tmp_path / "run.h5")
    figure = profiles.draw_profiles(record, [0, 10])
    gap, pressure, traction = figure.axes
    assert len(gap.lines) == 3  # two points and the zero
    assert np.array_equal(gap.lines[1].get_ydata(),
                          record.initial_gap + record.field("displacement", 10)[0])
    assert np.array_equal(pressure.lines[0].get_ydata(), -record.field("traction", 0)[0])
    left, right = gap.get_xlim()
    assert -12 < left < -6.3 and 6.3 < right < 12


@pytest.mark.parametrize("gaps", [[-0.2, -0.1], [-0.05, -0.05], [0.0, 0.0], [-3.0, -2.99]])
@pytest.mark.parametrize("dimension", (1, 2))
def test_gaps_of_bodies_that_are_pressed_everywhere_are_within_their_axis(tmp_path, gaps,
                                                                          dimension):
    x = np.arange(-8, 8) * 1.0
    wave = np.broadcast_to(np.cos(2 * np.pi * x / 16), dimension * (16,)).T
    gap = np.mean(gaps) + np.ptp(gaps) / 2 * wave
    row = dict(normal_force=1.0, contact_area=16.0)
    archive_of(tmp_path / "run.h5", [(row, (np.array([gap]), np.array([gap - 0.1])))], "all",
               coordinates=dimension * (x,), components=1, initial_gap=0 * gap)
    record = read(tmp_path / "run.h5")
    low, high = profiles.draw_profiles(record, [0]).axes[0].get_ylim()
    assert low < np.min(gap) and np.max(gap) < high
    _, ceiling = data.contact_region(record.coordinates, [gap], [gap - 0.1])
    assert ceiling == np.max(gap)
    if dimension == 2:
        image, *_ = maps.draw_maps(record, [0]).axes[0].images
        assert image.norm.vmin <= np.min(gap) and np.max(gap) <= image.norm.vmax
        assert image.norm.vmax - image.norm.vmin > 1e-3 * np.max(np.abs(gap))


def test_the_rim_of_a_contact_without_adhesion_is_in_its_profile(tmp_path):
    """Where nothing attracts, gaps at which tractions act are all overlaps."""
    x = np.linspace(-4, 4, 81)
    gap = 0.1 * (x**2 - 4)
    _, ceiling = data.contact_region((x,), [gap], [np.minimum(gap, 0)])
    assert 0.1 < ceiling < np.max(gap)


def test_points_are_chosen_among_those_stored(tmp_path):
    line_archive(tmp_path / "run.h5", [jkr(3), *shear(count=10)])
    record = read(tmp_path / "run.h5")
    chosen = data.choose_points(record, None)
    events = list(record["event"])
    assert chosen[0] == 1 and chosen[-1] == record.points - 1 and len(chosen) == 5
    assert {events.index("fold"), events.index("jump")} <= set(chosen)
    assert data.choose_points(record, [2, -1]) == [2, record.points - 1]
    with pytest.raises(ArchiveError, match="no fields of point 99; it has those of points 0 to"):
        plot(tmp_path / "run.h5", points=[99])


def test_an_archive_of_other_columns_is_told_to_lack_those_of_figures(tmp_path, capsys):
    own = Archive.create(tmp_path / "own.h5", scene={"period": LENGTH}, options="",
                         versions={"mine": "1"}, columns={"force": Column("w_n,r")})
    own.append({"force": 0.5}, {})
    own.finish()
    figures = plot(own.path)
    assert not figures.files
    assert "own.h5 has no column 'normal_displacement'; it has" in figures.skipped["approach"]
    assert cli.main(["report", str(own.path)]) == 2
    assert "own.h5 has no column" in capsys.readouterr().err


def test_bad_input(tmp_path):
    archive_of(tmp_path / "run.h5", [])
    with pytest.raises(ArchiveError, match="no points"):
        plot(tmp_path / "run.h5")
    archive_of(tmp_path / "one.h5", [(jkr(2), ())])
    with pytest.raises(ArchiveError, match="does not exist"):
        plot(tmp_path / "one.h5", output=tmp_path / "absent")
    with pytest.raises(ArchiveError, match="figures, .*one.h5, is a file: move it away"):
        plot(tmp_path / "one.h5", output=tmp_path / "one.h5")
    with h5py.File(tmp_path / "other.h5", "w"), pytest.raises(ArchiveError):
        plot(tmp_path / "other.h5")


def test_figures_of_archives_of_one_name_do_not_replace_each_other(
        tmp_path, capsys, kept_options, undrawn):
    """As those of a study with a folder a run."""
    for folder in ("one", "two", "figures"):
        (tmp_path / folder).mkdir()
    paths = [str(archive_of(tmp_path / folder / "run.h5", [(jkr(2), ()), (jkr(3), ())]).path)
             for folder in ("one", "two")]
    output = ["-plot_output", str(tmp_path / "figures")]
    assert cli.main(["plot", *paths, *output]) == 2
    assert "two/run.h5 would have figures of the names that those of " in capsys.readouterr().err
    assert not list((tmp_path / "figures").iterdir())
    for named in (paths, [paths[0], paths[0], *output], [*paths, *output, "-plot_together", "x"]):
        assert cli.main(["plot", *named]) == 0


@pytest.mark.parametrize(
    "unit, text",
    [
        ("w_t,r", "force $W / w_{t,r}$"),
        ("beta^2", r"force $W / \beta^2$"),
        ("R phi_n", "force\n" r"$W / (R\,\phi_{n})$"),
        ("R phi_n sqrt(phi_t/phi_n)", "force\n" r"$W / (R\,\phi_{n}\,\sqrt{\phi_{t}/\phi_{n}})$"),
        ("N/m", "force $W$ (N/m)"),
        ("", "force $W$"),
    ],
)
def test_labels_have_symbol_and_unit(unit, text):
    assert words.label("force", "W", unit) == text


@pytest.mark.parametrize("name, unit, text", [
    ("wall_time", "s", "wall time (s)"), ("spots", "", "spots"),
    ("residual_norm", "ranges of the law", "residual norm\n(ranges of the law)"),
    ("external_work", "w_n,r u_n,r", "external work\n($w_{n,r} u_{n,r}$)")])
def test_labels_of_columns_are_not_longer_than_a_panel(name, unit, text):
    class Record:
        units = {name: unit}

    assert words.column_label(Record, name) == text


def test_loads_of_rounding_are_none_in_titles():
    class Record(dict):
        units, coordinates = {"tangential_displacement": "u_t,r"}, [None]

    record = Record(tangential_displacement=np.array([3e-17, -0.0, -0.5]),
                    tangential_force=np.zeros(3), normal_displacement=np.zeros(3),
                    event=np.array(["none", "jump", "none"]))
    assert words.names(record, [0, 1, 2])[1] == ["0", "0, jump", "\N{MINUS SIGN}0.5"]
    # points of the same load by their numbers
    record["event"] = np.array(["none", "none", "none"])
    assert words.names(record, [0, 1, 2])[1] == ["0, point 0", "0, point 1", "\N{MINUS SIGN}0.5"]


def test_titles_tell_of_the_direction_that_is_sheared():
    """Where a plane is sheared along y, rounding along x tells no points apart."""
    class Record(dict):
        units = dict.fromkeys(("tangential_displacement_y", "normal_force", "tangential_force_y",
                               "normal_displacement"), "u")
        coordinates = [None, None]

    record = Record(normal_displacement=np.array([1.0, 1.0]), normal_force=np.array([2.0, 2.0]),
                    tangential_displacement_x=np.array([3e-11, -8e-11]),
                    tangential_displacement_y=np.array([0.0, 0.5]),
                    tangential_force_x=np.array([1e-12, -2e-12]),
                    tangential_force_y=np.array([0.0, 0.25]), event=np.array(["none", "none"]))
    assert words.names(record, [0, 1])[1] == ["0", "0.5"]
    assert movie._title(record, 1) == "point 1:  $W_n$ = 2,  $W_{t,y}$ = 0.25,  $D$ = 1"
    record["tangential_displacement_y"] = record["tangential_force_y"] = np.zeros(2)
    record["normal_force"] = np.array([2.0, 3.0])
    assert words.names(record, [0, 1])[1] == ["2", "3"]
    assert movie._title(record, 1) == "point 1:  $W_n$ = 3,  $D$ = 1"


def measured_file(path, text):
    path.write_text(text)
    return str(path)


def test_several_archives_stand_in_one_figure(tmp_path, undrawn):
    for name in ("one", "two"):
        archive_of(tmp_path / f"{name}.h5", [(row, ()) for row in shear()])
    figures = plot([tmp_path / "one.h5", tmp_path / "two.h5"], together="both", format="svg,pdf")
    assert names_of(figures) == sorted(f"both-{kind}{end}" for kind in ("area", "shear")
                                       for end in (".svg", ".pdf"))
    records = [read(tmp_path / f"{name}.h5") for name in ("one", "two")]
    figure = curves.draw_columns(records, ["tangential_force", "contact_area"])
    style.saved(figure, tmp_path / "drawn.svg")
    assert (tmp_path / "drawn.svg").read_text(encoding="utf-8").startswith("<?xml")
    axes = figure.axes[0]
    drawn = [line for line in axes.lines if len(line.get_xdata()) > 10]
    assert len({line.get_color() for line in drawn}) == 2
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts[:2] == ["one", "two"] and texts.count("jump") == 1


def test_folds_of_all_archives_are_one_entry_of_a_legend(tmp_path):
    for name, rows in (("one", shear()), ("two", [*shear(), *loading()])):
        archive_of(tmp_path / f"{name}.h5", [(row, ()) for row in rows])
    records = [read(tmp_path / f"{name}.h5") for name in ("one", "two")]
    axes = curves.draw_columns(records, ["normal_displacement", "normal_force"]).axes[0]
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts == ["one", "two", "start", "fold (jump-in, pull-off, sliding)", "jump",
                     "gross sliding", "pull-off"]


@pytest.mark.parametrize("dimension", (1, 2))
def test_modes_are_drawn_of_the_components_that_they_have(tmp_path, dimension):
    """Of a contact that begins to slide the leading mode is one of slip."""
    x = np.arange(16.0)
    shape = (dimension + 1, *[16] * dimension)
    opens, slips, none = np.zeros(shape), np.zeros(shape), np.full(shape, np.nan)
    opens[0], slips[1] = 1.0, np.sin(x).reshape(16, *[1] * (dimension - 1))
    archive_of(tmp_path / "run.h5", [({}, (np.zeros(shape), np.ones(shape), mode))
                                     for mode in (opens, slips, none)], "all", modes=True,
               coordinates=(x,) * dimension, components=dimension + 1,
               initial_gap=np.ones(shape[1:]))
    record = read(tmp_path / "run.h5")
    normal, slip = profiles.modes(record, [0, 1, 2])
    assert (normal.symbol, slip.symbol) == ("v_n", "v_{t}" if dimension == 1 else "v_{t,x}")
    assert np.array_equal(slip.values[1], np.sin(x)) and not np.any(slip.values[0])
    assert np.array_equal(normal.values[0], np.ones(16)) and np.isnan(normal.values[2]).all()
    assert [panel.symbol for panel in profiles.modes(record, [1])] == [slip.symbol]
    assert profiles.modes(record, [2]) == []


@pytest.mark.parametrize("paths, names", [
    (["one.h5", "there/two.h5"], ["one", "two"]),
    (["run.h5", "../run.h5"], ["here/run", "{}/run"]),
    (["a/x/run.h5", "b/x/run.h5", "b/run.h5"], ["a/x/run", "b/x/run", "b/run"]),
    (["run.h5", "run.h5"], ["run", "run"])])
def test_archives_of_one_name_are_told_apart_by_their_folders(tmp_path, monkeypatch, paths, names):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    records = [SimpleNamespace(path=Path(path)) for path in paths]
    assert curves.labels(records) == [name.format(tmp_path.name) for name in names]


@pytest.mark.parametrize("displacement", ["approach", "normal_displacement"])
def test_measured_loads_stand_beside_the_curves_of_their_displacement(tmp_path, displacement):
    archive_of(tmp_path / "run.h5", [(row, ()) for row in loading(compliance=0.3)])
    records = [read(tmp_path / "run.h5")] * 2
    table = measured.Measured(measured_file(
        tmp_path / "points.csv", f"{displacement},normal_force\n1,2\n"))
    axes = curves.together(records, [table])["approach"]().axes[0]
    assert table.used and axes.containers
    drawn = np.concatenate([line.get_xdata() for line in axes.lines if len(line.get_xdata()) > 10])
    assert np.isin(drawn, records[0][displacement]).all()


def test_measured_points_stand_where_their_units_say(tmp_path):
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()]).path)
    table = measured.Measured(measured_file(
        tmp_path / "glass.csv", "# by hand\ntangential_force,contact_area,contact_area_error\n"
        "1,12.5,0.1\n2,12.4,\n"))
    axes = loads.draw_area(record, [table]).axes[0]
    points = axes.containers[0].lines[0]
    assert np.array_equal(points.get_xydata(), [[1, 12.5], [2, 12.4]]) and table.used
    assert axes.get_legend().get_texts()[-1].get_text() == "glass"

    record.units["contact_area"] = record.stored_units["contact_area"] = "m^2"
    table = measured.Measured(measured_file(tmp_path / "si.csv", "contact_area [mm²];x\n2;1\n"))
    assert table.values(record, "contact_area") == pytest.approx([2e-6], rel=1e-12)
    for sign in ("µ", "\N{GREEK SMALL LETTER MU}", "u"):
        table = measured.Measured(measured_file(tmp_path / "si.csv",
                                                f"contact_area [{sign}m^2]\n2\n"))
        assert table.values(record, "contact_area") == pytest.approx([2e-12], rel=1e-12)
    # errors are in the unit of what they are errors of, unless they have one
    for unit, size in (("", 3e-8), (" [m^2]", 0.03)):
        table = measured.Measured(measured_file(
            tmp_path / "error.csv", f"contact_area [mm2],contact_area_error{unit}\n2,0.03\n"))
        assert table.values(record, "contact_area_error") == pytest.approx([size], rel=1e-12)


@pytest.mark.parametrize("text, word", [
    ("", "no heading"), ("contact_area\n1,2\n", "row 1 is '1,2': 1 numbers"),
    ("tangential_force,contact_area\n1,wide\n", "row 1 is '1,wide'"),
    ("contact_area,contact_area,tangential_force\n1,2,3\n", "has two columns contact_area"),
    ("tangential_force [N],contact_area\n1,2\n", "is in 'N', but the archive has it in 'w_t,r'"),
    ("tangential_force,contact_aria\n1,2\n", "did you mean contact_area"),
    ("tangential_force,contact_area,error\n1,2,3\n", "column error is unknown: errors of a column"),
    ("tangential_force,contact_area,contact_area_eror\n1,2,3\n",
     "contact_area_eror is unknown (did you mean contact_area?)")])
def test_measured_points_that_do_not_fit_are_named(tmp_path, text, word):
    archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()])
    path = measured_file(tmp_path / "points.csv", text)
    with pytest.raises(InputError, match=re.escape(word)):
        plot(tmp_path / "run.h5", measured=path)


def test_measured_points_that_no_figure_shows_are_an_error_of_the_command(
        tmp_path, capsys, kept_options, undrawn):
    archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()])
    path = measured_file(tmp_path / "points.csv", "leg,approach\n1,2\n")
    assert cli.main(["plot", str(tmp_path / "run.h5"), "-plot_with", path]) == 2
    assert "no figure has two of its columns" in capsys.readouterr().err


def test_each_table_of_measured_points_stands_in_the_legend_once(tmp_path):
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()]).path)
    tables = [measured.Measured(measured_file(tmp_path / f"{name}.csv", text)) for name, text in (
        ("glass", "tangential_displacement,tangential_force,contact_area\n1,1,12\n"),
        ("steel", "tangential_displacement,tangential_force\n2,2\n"),
        ("cut", "tangential_displacement,contact_area\n2,12\n"))]
    for figure in (loads.draw_shear(record, tables), curves.draw_columns(
            [record], ["tangential_displacement", "tangential_force", "contact_area"], tables)):
        shown = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        assert sorted(shown[-3:]) == ["cut", "glass", "steel"]


@pytest.mark.parametrize("sign", [";", "\t"])
def test_measured_points_have_decimal_commas_where_others_separate_them(tmp_path, sign):
    table = measured.Measured(measured_file(tmp_path / "points.csv", "approach;normal_force\n"
                                            "1,5;-2,25e-1\n0.5;1\n".replace(";", sign)))
    assert np.array_equal(table.columns["approach"], [1.5, 0.5])
    assert np.array_equal(table.columns["normal_force"], [-0.225, 1.0])


def test_columns_that_are_not_known_everywhere_are_drawn_where_they_are(tmp_path):
    rows = shear()
    for place, row in enumerate(rows):
        row["approach"] = np.nan if place < 5 else float(place)
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in rows]).path)
    assert curves.draw_columns([record], ["approach", "contact_area"])
    for row in rows:
        row["approach"] = np.nan
    record = read(archive_of(tmp_path / "none.h5", [(row, ()) for row in rows]).path)
    for pair in (["approach", "contact_area"], ["contact_area", "approach"]):
        with pytest.raises(data.NothingToShow, match="none.h5 has no point with both"):
            curves.draw_columns([record], pair)


def test_archives_stand_together_whose_costs_are_counted_in_other_units(tmp_path, monkeypatch,
                                                                        undrawn):
    known, paths = columns(), [tmp_path / "cell.h5", tmp_path / "alone.h5"]
    for path in paths:
        monkeypatch.setitem(globals(), "columns", lambda dimension, path=path: known | {
            "transforms": Column(f"of {path.stem}")})
        archive_of(path, [(row, ()) for row in shear()])
    assert len(plot(paths).files) == 2
    with pytest.raises(ArchiveError, match="has transforms in 'of alone'"):
        plot(paths, columns="transforms,contact_area")


def test_figures_together_name_the_archive_without_shear(tmp_path, undrawn):
    archive_of(tmp_path / "sheared.h5", [(row, ()) for row in shear()])
    archive_of(tmp_path / "pressed.h5", [(row, ()) for row in loading()])
    skipped = plot([tmp_path / "sheared.h5", tmp_path / "pressed.h5"]).skipped
    assert skipped["shear"] == "there is no tangential load in pressed.h5"


@pytest.mark.parametrize("name", ["run", "maugis_3_poisson_0.49_residual_friction_0.5_seed_17"])
def test_no_entry_of_a_legend_is_cut(tmp_path, name):
    rows = loading()
    for row, force in zip((rows[0], rows[-1]), (1.234e-6, 1.234e-6)):
        row["normal_force"] = -force
    record = read(line_archive(tmp_path / f"{name}.h5", rows).path)
    with rc_context(style.STYLE):
        for figure in (profiles.draw_profiles(record, [0, 5, len(rows) - 1]),
                       curves.draw_columns([record, record], ["approach", "normal_force"])):
            figure.draw_without_rendering()
            boxes = [text.get_window_extent() for text in figure.axes[0].get_legend().get_texts()]
            assert all(box.x1 < figure.bbox.x1 for box in boxes)
            assert figure.axes[0].get_window_extent().width > 0.7 * figure.bbox.width


def test_the_length_of_a_text_is_that_of_its_letters():
    """Without their outlines, whose extents cost a quarter of a figure. Lines that are broken are
    as long as the longest."""
    for text in ("fold", "gross sliding", r"$\lambda_n = 3$", "5 $"):
        length = TextPath((0.0, 0.0), text, size=1).get_extents().width
        width = parts._width([Line2D([], [], label=text)], 1)
        assert width == pytest.approx(2.3 + length, abs=0.3)
    once, broken = (Line2D([], [], label=text) for text in ("measured", "measured\nagain"))
    assert parts._width([broken], 1) == parts._width([once], 1)


def test_no_power_of_ten_is_under_a_legend(tmp_path):
    rows = [{**row, "approach": 1e-9 * place, "normal_force": place}
            for place, row in enumerate(shear())]
    record = read(archive_of(tmp_path / "run.h5", [(row, ()) for row in rows]).path)
    with rc_context(style.STYLE):
        for y, factor in (("approach", True), ("normal_force", False)):
            figure = curves.draw_columns([record], ["contact_area", y])
            figure.draw_without_rendering()
            axes = figure.axes[0]
            power, legend = axes.yaxis.offsetText, axes.get_legend()
            assert bool(power.get_text()) == factor
            below = power.get_window_extent().y1 if factor else axes.get_window_extent().y1
            assert 0 <= legend.get_window_extent().y0 - below < 12


def test_size_style_and_columns(tmp_path, coarse):
    archive_of(tmp_path / "run.h5", [(row, ()) for row in shear()])
    figures = plot(tmp_path / "run.h5", size=(12.0, 6.0), style="ggplot",
                   columns="tangential_force,contact_area,approach")
    images = {file.stem: imread(file) for file in figures.files}
    assert set(images) == {"run-shear", "run-area", "run-columns"}
    for image in images.values():
        assert np.abs(np.array(image.shape[:2]) - np.array([6, 12]) / 2.54 * coarse).max() < 2
    for options, word in ((dict(style="ggplt"), "did you mean ggplot"),
                          (dict(columns="contact_area"), "two columns at least"),
                          (dict(columns="tangential_force,event"), "no column event of numbers"),
                          (dict(format="gif"), "-plot_format is 'gif'"),
                          (dict(size=2.0), "-plot_size is too small for"),
                          (dict(together="a/b"), "-plot_output"),
                          (dict(together=".."), "-plot_output"),
                          (dict(together="all.png"), "whose ending -plot_format says")):
        for file in tmp_path.glob("*.png"):
            file.unlink()
        with pytest.raises(InputError, match=re.escape(word)):
            plot(tmp_path / "run.h5", **options)
        assert not list(tmp_path.glob("*.png"))


def test_labels_of_low_panels_take_two_lines(tmp_path):
    line_archive(tmp_path / "run.h5", shear())
    with rc_context(style.STYLE):
        figure = style.sized(profiles.draw_profiles(read(tmp_path / "run.h5"), [0, 10]), (17, 10))
        parts.break_labels(figure)
        figure.draw_without_rendering()
        labels = [axes.yaxis.label for axes in figure.axes]
        boxes = [label.get_window_extent() for label in labels]
    assert all(above.y0 > below.y1 for above, below in zip(boxes, boxes[1:]))
    assert labels[-1].get_text() == "tangential\ntraction $p_{t} / p_{t,r}$"
    assert "\n" not in labels[0].get_text()


def test_archives_of_other_units_do_not_stand_together(tmp_path):
    archive_of(tmp_path / "line.h5", [(row, ()) for row in shear()])
    plane_archive(tmp_path / "plane.h5", shear(1.5, 10, "_x"))
    with pytest.raises(ArchiveError, match="one kind of units"):
        plot([tmp_path / "line.h5", tmp_path / "plane.h5"])


def test_maps_have_room_for_their_ticks_and_titles(tmp_path):
    record = read(plane_archive(tmp_path / "run.h5", shear(1.5, 10, "_x")).path)
    with rc_context(style.STYLE):
        figure = maps.draw_maps(record, [0, 10, record.points - 1])
        figure.canvas.draw()
        for axes in figure.axes[6:9]:
            left, right = axes.get_xlim()
            boxes = [label.get_window_extent() for label, place
                     in zip(axes.get_xticklabels(), axes.get_xticks()) if left <= place <= right]
            assert len(boxes) > 1 and all(one.x1 < other.x0 for one, other in zip(boxes, boxes[1:]))
        titles = [axes.title.get_window_extent() for axes in figure.axes[:3]]
        assert all(one.x1 < other.x0 for one, other in zip(titles, titles[1:]))


@pytest.mark.parametrize("largest, texts", [
    (0.1234, ["\N{MINUS SIGN}0.12", "0", "0.12"]), (84.4, ["\N{MINUS SIGN}84", "0", "84"]),
    (150.6, ["\N{MINUS SIGN}151", "0", "151"]), (1071.2, ["\N{MINUS SIGN}1071", "0", "1071"])])
def test_numbers_at_bars_of_colours_have_no_exponents(largest, texts):
    class Bar:
        def set_ticks(self, ticks, labels):
            self.texts = labels

    bar = Bar()
    maps.mark_bar(bar, (-largest, 0, largest))
    assert bar.texts == texts


def test_maps_in_motion_have_the_ends_of_pressure_and_attraction_at_their_bar(tmp_path):
    record = read(plane_archive(tmp_path / "run.h5", shear(1.5, 10, "_x")[:2]).path)
    pressures = [-record.field("traction", point)[0] for point in (0, 1)]
    scenes = movie._scenes(record, MovieOptions())
    scenes.figure.draw_without_rendering()
    told = [[text.get_text() for text in axes.get_xticklabels()] for axes in scenes.figure.axes]
    ends = [words.number(end(pressures), 2) for end in (np.min, np.max)]
    assert [ends[0], "0", ends[1]] in told


def test_numbers_at_bars_of_maps_in_motion_are_few(tmp_path):
    x = np.arange(-24, 24) / 5
    radius = np.hypot(x[:, None], x[None, :])
    fields = np.array([3 + 0 * radius]), np.array([0.155 * np.exp(-radius**2 / 2)])
    archive_of(tmp_path / "run.h5", [(dict(normal_force=-1.0), fields)], "all",
               coordinates=(x, x), components=1, initial_gap=radius**2 / 2)
    record = read(tmp_path / "run.h5")
    with rc_context(style.STYLE):
        scenes = movie._scenes(record, MovieOptions())
        scenes.figure.canvas.draw()
        bars = [axes for axes in scenes.figure.axes if axes.get_label() == "<colorbar>"]
        assert len(bars) == 2
        for axes in bars:
            left, right = axes.get_xlim()
            boxes = [label.get_window_extent() for label, place
                     in zip(axes.get_xticklabels(), axes.get_xticks()) if left <= place <= right]
            assert 1 < len(boxes) < 5
            assert all(one.x1 < other.x0 for one, other in zip(boxes, boxes[1:]))


def test_no_label_of_the_figure_of_a_surface_is_cut(tmp_path):
    x = np.linspace(-1e-4, 1e-4, 48, endpoint=False)
    gap = 2e-6 * (1 - np.cos(np.pi * x / 5e-5)[:, None] * np.cos(np.pi * x / 3e-5))
    surface.draw_surface([tmp_path / "a.png"], (x, x), gap, ("m", "m"), "a map", PlotOptions())
    picture = imread(tmp_path / "a.png")
    borders = picture[0], picture[-1], picture[:, 0], picture[:, -1]
    assert all(np.all(border == 1.0) for border in borders)


SHAPE = {"line": ("half_axis_x", "stick_area", "slip_area", "edge_left", "edge_right", "front_left",
                  "front_right"),
         "plane": ("half_axis_x", "half_axis_y", "stick_area", "slip_area")}


def words_of(axes):
    """Texts of the legend of axes."""
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_what_sticks_is_drawn_under_shear_only(tmp_path, monkeypatch):
    known = columns(2)
    wider = {**known, **{name: Column(known["contact_area"].unit if name.endswith("area")
                                      else "beta") for name in SHAPE["plane"]}}
    monkeypatch.setattr(f"{__name__}.columns", lambda dimension=1: wider)
    rows = [{**row, **dict.fromkeys(SHAPE["plane"], 1.0), "normal_force": number,
             "tangential_force_x": 0.0, "tangential_displacement_x": 0.0, "event": "none"}
            for number, row in enumerate(shear(axis="_x")[:10])]
    plane_archive(tmp_path / "run.h5", rows)
    below = shape.draw_shape(read(tmp_path / "run.h5")).axes[-1]
    assert words_of(below) == ["in contact"]
    assert below.get_xlabel().startswith("normal force")


@pytest.mark.parametrize("interface", SHAPE)
def test_the_shape_of_a_sheared_contact_is_drawn(interface, tmp_path, monkeypatch, coarse):
    names, axis = SHAPE[interface], "_x" if interface == "plane" else ""
    dimension = 2 if axis else 1
    known = columns(dimension)
    unit = known["contact_area"].unit
    wider = {**known, **{name: Column(unit if name.endswith("area") else "beta") for name in names}}
    monkeypatch.setattr(f"{__name__}.columns", lambda dimension=1: wider)
    for kind in ("shear", "area", "profiles", "maps"):  # which have their own tests
        monkeypatch.setattr(plotting, f"draw_{kind}", lambda *_: Figure((1.0, 1.0)))
    rows = [{**row, **{name: number for number, name in enumerate(names, start=1)}}
            for row in shear(count=10, axis=axis)]
    if interface == "plane":
        plane_archive(tmp_path / "run.h5", rows, nodes=48)
    else:
        archive_of(tmp_path / "run.h5", [(row, ()) for row in rows])
    figure = shape.draw_shape(read(tmp_path / "run.h5"))
    above, below = figure.axes
    assert "in contact" in words_of(below) and "sticks" in words_of(below)
    drawn = {round(float(line.get_ydata()[0]), 9) for line in (*above.lines, *below.lines)
             if len(line.get_ydata())}
    assert set(range(2 if dimension == 1 else 1, 1 + len(names))) <= drawn
    assert below.get_xlabel().startswith("tangential force")
    assert "outlines" not in plot(tmp_path / "run.h5").skipped or interface == "line"
    # around the cell a contact has no half axes; then what sticks and slips is left
    for missing in ([name for name in names if not name.endswith("area")], [*names]):
        for row in rows:
            row.update(dict.fromkeys(missing, np.nan))
            row["contact_area"] *= missing != [*names]
        rows[-1].update({**dict.fromkeys(missing, 0.0), "contact_area": 0.0})  # pulled off
        (tmp_path / "run.h5").unlink()
        if interface == "plane":
            plane_archive(tmp_path / "run.h5", rows, nodes=48)
        else:
            archive_of(tmp_path / "run.h5", [(row, ()) for row in rows])
        if missing != [*names]:
            assert len(shape.draw_shape(read(tmp_path / "run.h5")).axes) == 1
    assert plot(tmp_path / "run.h5").skipped["shape"] == "nothing is in contact"


def test_the_edge_of_contact_is_that_of_a_circle():
    """Lines at the right radius, and none where all or nothing is in contact."""
    x, y = np.linspace(-3, 3, 121), np.linspace(-2, 2, 81)
    gap = (x[:, None] - 0.4) ** 2 + y ** 2 - 0.94
    (line,) = maps.edge((x, y), gap, 0.5)
    np.testing.assert_allclose(np.hypot(line[:, 0] - 0.4, line[:, 1]), 1.2, atol=1e-3)
    assert len(line) > 100 and np.array_equal(line[0], line[-1])
    assert [*maps.edge((x, y), gap - 100, 0.5), *maps.edge((x, y), gap + 100, 0.5)] == []
    (half,) = maps.edge((x, y), gap - 2.5, 0.5)  # as far as the border of the map
    assert np.abs(half[:, 1]).max() <= 2.0


def test_a_style_in_a_file_sets_the_size_of_all_letters(tmp_path):
    """By font.size alone; what it names besides is as it says, what it does not name as ever."""
    (tmp_path / "talk.mplstyle").write_text("font.size: 13\nlegend.fontsize: 9\n", encoding="utf-8")
    found = style.settings(str(tmp_path / "talk.mplstyle"))
    assert {found[name] for name in ("font.size", "axes.labelsize", "xtick.labelsize")} == {13.0}
    assert found["legend.fontsize"] == 9.0 and found["xtick.direction"] == "in"
