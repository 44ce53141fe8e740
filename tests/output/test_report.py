"""Reports and movies: pages are whole and right, also in a browser; movies have their pictures."""

import base64
import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser

import matplotlib
import numpy as np
import pytest
from matplotlib import animation

from contactsnes.options.fields import InputError
from contactsnes.output.archive import Archive
from contactsnes.output.asked import MovieOptions, ReportOptions
from contactsnes.output.columns import Column
from contactsnes.output.figures import encoding, movie
from contactsnes.output.files import ArchiveError
from contactsnes.output.prefixes import read
from contactsnes.output.report import certificates, curves, words

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
EVENTS = ("none", "fold", "jump", "gross_sliding")
COUNT = 12
pytestmark = pytest.mark.usefixtures("read_here")


def archive(path, dimension=1, fields="all", warnings=()):
    """A contact whose width grows, is sheared, and slides: invented, of the form of real ones."""
    ends = ("",) if dimension == 1 else ("_x", "_y")
    names = ["normal_displacement", "normal_force", "approach", "contact_area",
             *(f"tangential_{kind}{end}" for end in ends for kind in ("displacement", "force")),
             "residual_norm", "energy_imbalance", "external_work", "elastic_energy",
             "interfacial_energy", "dissipated_work", "transforms", "wall_time", "fold_precision"]
    columns = {**{name: Column("w_n,r" if "force" in name else "u_n,r") for name in names},
               "event": Column("", "i1", EVENTS), "fold_kind": Column("", "i1", ("", "sliding")),
               "stable": Column("", "i8"), "resolved": Column("", "i8")}
    x = (np.arange(64) - 32) / 8.0
    axes = (x,) * dimension
    radius = np.abs(x) if dimension == 1 else np.hypot(*np.meshgrid(x, x, indexing="ij"))
    scene = {"normal_maugis": 2.0, "contact_threshold": 2.718, "geometry": "cylinder & <co>",
             "dimension": dimension, "poisson": 0.5, "law": "modified"}
    grid = {} if fields == "none" else dict(coordinates=axes, components=1 + dimension,
                                            initial_gap=radius ** 2 / 2)
    made = Archive.create(path, scene=scene, versions={"contactsnes": "1"}, columns=columns,
                          options='-load_path "normal_force=1; tangential_displacement=2"\n'
                          "-archive_fields all", fields=fields, warnings=warnings, **grid)
    for number in range(COUNT):
        row = {name: 0.1 * number for name in names} | {
            "residual_norm": 1e-9, "energy_imbalance": 0.0, "event": "none", "fold_kind": "",
            "stable": -1, "resolved": 1, "fold_precision": 0.0}
        if number == 8:
            row |= {"event": "fold", "fold_kind": "sliding", "fold_precision": 1e-9}
        row |= {"event": "jump"} if number == 9 else {}
        made.append(row, {}, *(() if fields == "none" else shape(radius, number, dimension)))
    made.finish()
    return path


def shape(radius, number, dimension):
    """Displacement and traction of a contact of half width 1 + number / 10."""
    half = 1.0 + 0.1 * number
    gap = np.maximum(radius - half, 0.0) ** 1.5 - 0.1 * (radius < half)
    pressure = np.sqrt(np.maximum(1.0 - (radius / half) ** 2, 0.0))
    shear = [0.1 * number * pressure] + [0.0 * pressure] * (dimension - 1)
    return (np.array([gap - radius ** 2 / 2, *shear]), np.array([-pressure, *shear]))


class Page(HTMLParser):
    """What a page holds: open elements, those with an id, texts, scripts, and what it loads."""

    VOID = {"meta", "br", "input", "img", "link", "hr"}

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.loaded, self.texts, self.scripts = [], [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids += [attributes["id"]] if "id" in attributes else []
        self.loaded += [attributes[name] for name in ("src", "href") if name in attributes]
        self.open += [] if tag in self.VOID else [tag]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        (self.scripts if self.open and self.open[-1] == "script" else self.texts).append(data)


@pytest.fixture
def report():
    """A function that makes the report of an archive, a path and its page."""
    pytest.importorskip("plotly")
    from contactsnes.output.report.page import write_report

    def make(path, **options):
        page = write_report(path, ReportOptions(**options))
        return page, Page(page.read_text(encoding="utf-8"))

    return make


def frames(page):
    """Names and data of the frames of the figure of fields."""
    text = next(script for script in page.scripts if "addFrames('fields'" in script)
    found = json.JSONDecoder().raw_decode(text.split("addFrames('fields'", 1)[1].lstrip(", "))[0]
    return {frame["name"]: frame["data"] for frame in found}


def array(packed):
    """An array as plotly packs it, or as a list."""
    if isinstance(packed, list):
        return np.array(packed)
    kind = np.dtype(packed["dtype"]).newbyteorder("<")
    flat = np.frombuffer(base64.b64decode(packed["bdata"]), kind)
    return flat.reshape([int(n) for n in packed["shape"].split(",")]) if "shape" in packed else flat


def test_a_page_needs_nothing_else_and_says_what_there_is(tmp_path, report):
    path, page = report(archive(tmp_path / "run.h5", warnings=("mind the <grid>",)))
    text = " ".join(" ".join(page.texts).split())
    assert path == tmp_path / "run.html" and not page.loaded
    assert {"curves", "fields"} <= set(page.ids)
    for said in ("cylinder & <co> on a flat", "mind the <grid>", "fold (sliding)", "1e−09",
                  "12 points", "largest residual_norm", "0 stable, 0 unstable, 12 not checked",
                  "tangential_displacement=2"):
        assert said in text, said
    assert "-archive_fields" not in text


@pytest.mark.parametrize("dimension", [1, 2])
def test_frames_are_the_fields_of_the_points(tmp_path, report, dimension):
    path = archive(tmp_path / "run.h5", dimension)
    _, page = report(path, points=5)
    found, record = frames(page), read(path)
    assert 3 <= len(found) <= 5 and "8" in found  # the fold is among them
    for name, data in found.items():
        pressure = -record.field("traction", int(name))[0]
        shown = array(data[1]["y"] if dimension == 1 else data[2]["z"])
        assert shown.max() == pytest.approx(pressure.max(), rel=1e-6)
        if dimension == 1:
            places = np.searchsorted(record.coordinates[0], array(data[1]["x"]))
            np.testing.assert_allclose(shown, pressure[places], rtol=1e-6)


def test_the_edge_of_contact_is_where_the_gap_says(tmp_path, report):
    path = archive(tmp_path / "run.h5", 2)
    _, page = report(path)
    data = frames(page)["4"]
    x, y = array(data[1]["x"]), array(data[1]["y"])
    known = np.isfinite(x.astype(float)) & np.isfinite(y.astype(float))
    half = 1.4 + (2.718 / 2.0) ** (2 / 3)  # of the level of the gap, see `shape`
    np.testing.assert_allclose(np.hypot(x[known], y[known]), half, atol=0.01)


def test_a_page_without_fields_says_how_to_get_them(tmp_path, report):
    _, page = report(archive(tmp_path / "run.h5", fields="none"))
    assert "fields" not in page.ids and "-archive_fields all" in " ".join(page.texts)


def test_a_report_refuses_what_is_not_there(tmp_path, report):
    with pytest.raises(ArchiveError, match="no such file"):
        report(tmp_path / "absent.h5")
    with pytest.raises(InputError, match="folder does not exist"):
        report(archive(tmp_path / "run.h5"), output=str(tmp_path / "absent/run.html"))
    with pytest.raises(InputError, match="-points is '0'"):
        ReportOptions(points=0)


def test_a_browser_draws_the_page_and_moves_the_slider(tmp_path, report):
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        pytest.skip(f"none of {', '.join(BROWSERS)} is installed")
    path, _ = report(archive(tmp_path / "run.h5", 2))
    probe = """<script>
window.addEventListener("load", () => setTimeout(() => {
  const fields = document.getElementById("fields");
  Plotly.animate(fields, ["3"], {mode: "immediate", frame: {duration: 0, redraw: true}});
  setTimeout(() => { fields.emit("plotly_sliderchange", {slider: {active: 3}});
      const curves = document.getElementById("curves");
      const told = document.createElement("p"); told.id = "told";
      told.textContent = JSON.stringify({title: fields.layout.title.text,
        drawn: document.querySelectorAll("#curves .trace").length,
        maps: document.querySelectorAll("#fields .heatmaplayer image").length,
        mark: curves.data[curves.data.length - 3].y[0]});
      document.body.appendChild(told); }, 3000); }, 300));</script></body>"""
    shown = tmp_path / "probed.html"
    shown.write_text(path.read_text(encoding="utf-8").replace("</body>", probe), encoding="utf-8")
    done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu",
                           "--virtual-time-budget=20000", f"--user-data-dir={tmp_path}/profile",
                           "--dump-dom", shown.as_uri()], capture_output=True, text=True,
                          timeout=300, check=False)
    told = re.search(r'<p id="told">(.*?)</p>', done.stdout)
    assert told, done.stderr[-2000:]
    told = json.loads(told[1].replace("&lt;", "<").replace("&gt;", ">"))
    assert told["title"].startswith("point 3:") and told["drawn"] >= 4 and told["maps"] == 3
    assert told["mark"] == pytest.approx(0.3, rel=1e-6)


@pytest.fixture
def coarse(monkeypatch):
    """Pictures of few pixels."""
    monkeypatch.setattr(movie, "DOTS", 60)


def test_a_film_shows_every_point(tmp_path, coarse):
    PIL = pytest.importorskip("PIL.Image")
    path = movie.write_movie(archive(tmp_path / "run.h5"), MovieOptions(format="gif", width=6.0))
    with PIL.open(path) as film:
        assert path.suffix == ".gif" and film.n_frames == COUNT
        pictures = []
        for number in range(COUNT):
            film.seek(number)
            pictures.append(np.asarray(film.convert("RGB"), float))
    assert all(np.abs(one - other).max() > 50 for one, other in zip(pictures, pictures[1:]))


@pytest.mark.parametrize("dimension", [1, 2])
def test_what_is_told_above_fields_is_not_wider_than_the_page(tmp_path, dimension):
    title = curves.title_of(read(archive(tmp_path / "run.h5", dimension)), 8)
    lines = title.split("<br>")
    assert [len(re.findall("normal|tangential", line)) for line in lines] == [[4], [2, 4]][
        dimension - 1]
    assert title.startswith("point 8: normal") and title.endswith("<b>fold</b>")


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_picture_shows_the_fields_of_its_point(tmp_path, dimension):
    path = archive(tmp_path / "run.h5", dimension)
    record, asked = read(path), MovieOptions(frames=4)
    with matplotlib.rc_context(movie.settings("")):
        scenes = movie._scenes(record, asked)
        assert scenes.points == [0, 3, 7, 11]
        scenes.draw(2)
    axes, pressure = scenes.figure.axes[1], -record.field("traction", 7)[0].astype("f4")
    if dimension == 1:
        assert np.array_equal(axes.lines[0].get_ydata(), pressure)
    else:  # the nodes that are to be seen, each at its place
        image, (x, y) = axes.images[0], record.coordinates
        left, right, low, high = image.get_extent()
        near = np.ix_((left < x) & (x < right), (low < y) & (y < high))
        assert np.array_equal(image.get_array().T, pressure[near])
        assert axes.get_xlim()[0] >= left and axes.get_ylim()[1] <= high
    assert "point 7" in scenes.figure._suptitle.get_text()


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_gif_has_the_colours_of_its_pictures(tmp_path, monkeypatch, dimension):
    """Though these share 256 of them: maps and curves within a hundredth in the mean."""
    PIL = pytest.importorskip("PIL.Image")
    drawn, pictures = movie.Scenes.pictures, []

    def kept(scenes, places):
        """What is drawn at places, of which the last comes first, too: its colours are shared."""
        assert list(places) == [1, 0, 1]
        for picture in drawn(scenes, places):
            pictures.append(picture)
            yield picture

    monkeypatch.setattr(movie.Scenes, "pictures", kept)
    asked = MovieOptions(frames=2, format="gif", width=8.0)
    path = movie.write_movie(archive(tmp_path / "run.h5", dimension), asked)
    with PIL.open(path) as film:
        for number, picture in enumerate(pictures[1:]):
            film.seek(number)
            off = np.abs(np.asarray(film.convert("RGB"), float) - picture[..., :3])
            assert off.mean() < 2.5 and np.quantile(off, 0.99) < 32


@pytest.mark.skipif(not animation.FFMpegWriter.isAvailable(), reason="there is no ffmpeg")
def test_a_film_is_an_mp4_where_ffmpeg_is(tmp_path, coarse):
    path = movie.write_movie(archive(tmp_path / "run.h5", 2), MovieOptions(frames=3, width=6.0))
    assert path == tmp_path / "run.mp4" and b"ftyp" in path.read_bytes()[:16]


def test_a_film_without_ffmpeg_is_a_gif(tmp_path, monkeypatch):
    monkeypatch.setattr(animation.FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    assert encoding.ending(MovieOptions()) == "gif"
    with pytest.raises(InputError, match="needs ffmpeg"):
        encoding.ending(MovieOptions(format="mp4"))


def test_a_film_without_an_ending_gets_one(tmp_path, coarse):
    asked = MovieOptions(output=str(tmp_path / "film"), format="gif", frames=2, width=6.0)
    path = movie.write_movie(archive(tmp_path / "run.h5"), asked)
    assert path == tmp_path / "film.gif" and path.read_bytes().startswith(b"GIF")


@pytest.mark.parametrize("output, word", [("run.avi", r"ends in \.mp4 or \.gif"),
                                          ("run.gif", "leave one out")])
def test_a_film_refuses_names_that_do_not_fit(monkeypatch, output, word):
    monkeypatch.setattr(animation.FFMpegWriter, "isAvailable", classmethod(lambda cls: True))
    with pytest.raises(InputError, match=word):
        encoding.ending(replace(MovieOptions(output=output), format="mp4"))


def test_a_film_needs_fields(tmp_path):
    with pytest.raises(ArchiveError, match="-archive_fields all"):
        movie.write_movie(archive(tmp_path / "run.h5", fields="none"), MovieOptions())


class Kept(dict):
    """Columns of an archive with their units."""

    units, points, complete = {"external_work": "J", "normal_displacement": "m",
                               "normal_force": "N"}, 3, True


@pytest.mark.parametrize("last, told, fine", [
    (0.02, "0.02 of 7 J", False), (2e-6, "2e−06 of 7 J", True),
    (np.nan, "1e−06 of 2 J, of the 2 points before a jump whose loss is not known", True)])
def test_a_balance_certifies_the_points_that_it_tests(last, told, fine):
    record = Kept(external_work=np.array([0.0, -2.0, 7.0]),
                  energy_imbalance=np.array([0.0, 1e-6, last]), residual_norm=np.zeros(3),
                  resolved=np.ones(3), stable=-np.ones(3))
    (row,) = [row for row in certificates.rows(record) if row[0].startswith("missing")]
    assert row[1].startswith(told) and row[2] == fine


@pytest.mark.parametrize("force, told", [(0.0, "no load"), (1e-14, "no load"),
                                         (1.0, "normal force 1 N")])
def test_a_place_without_a_load_is_named_so(force, told):
    """The fold at which an isolated body jumps in was at nothing."""
    record = Kept(normal_displacement=np.full(2, np.nan), normal_force=np.array([force, 2.0]))
    assert re.sub("<[^>]*>", "", words.loads(record, 0)) == told


def test_a_half_plane_that_has_no_displacement_is_drawn_along_its_points():
    """Its panel of shear was empty: under a force it has no displacement as a whole."""
    force, nothing = np.array([0.0, 0.0, 0.5]), np.array([0.0, np.nan, np.nan])
    record = {"normal_displacement": nothing, "approach": nothing, "normal_force": force,
              "tangential_displacement": nothing, "tangential_force": force}
    assert curves.panels(record) == [(None, "normal_force"), (None, "tangential_force"),
                                     ("tangential_force", "contact_area")]
    record["tangential_displacement"] = force
    assert curves.panels(record)[1] == ("tangential_displacement", "tangential_force")
