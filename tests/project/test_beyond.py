"""Figures beyond the paper's: their runs, and each of them drawn and told from one small run in the
place of all."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from contactsnes import Load, Scene
from contactsnes.scene.settings import Steps, check

HERE = Path(__file__).resolve().parents[2] / "scripts" / "paper"
before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
sys.path.insert(0, str(HERE))
import beyond  # noqa: E402
import cell  # noqa: E402
import observed  # noqa: E402
import onsets  # noqa: E402
import pages  # noqa: E402
import poisson  # noqa: E402
import remnant  # noqa: E402
import runs  # noqa: E402
import style  # noqa: E402

sys.path.remove(str(HERE))
sys.dont_write_bytecode = before

every_figure = pytest.mark.parametrize("name", pages.BEYOND)

pytestmark = pytest.mark.study


class Alike:
    """One archive in the place of every run."""

    def __init__(self, record):
        self.record = record

    def __getitem__(self, name):
        return self.record


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Archive of a small contact sheared at a held normal force."""
    found = runs.Results(tmp_path_factory.mktemp("beyond"))
    run = beyond.held("small", 0.8, steps=20, points=512, normal_maugis=2.0, period=60.0)
    run.options.update(archive_fields="all", archive_errors="true")
    found.make_all([run], 1, lambda line: None)
    return found["small"]


@every_figure
def test_runs_are_valid_scenes_and_loads(name):
    needed = pages.BEYOND[name].NEEDED
    assert len({run.name for run in needed}) == len(needed)
    for run in needed:
        scene = Scene(**{key[6:]: value for key, value in run.options.items()
                         if key.startswith("scene_")})
        sizes = {key: tuple(map(float, run.options[f"continuation_{key}"].split(",")))
                 for key in ("initial_step", "largest_step")
                 if f"continuation_{key}" in run.options}
        check(scene, Load(start=run.options["load_start"], path=run.options["load_path"]),
              Steps(**sizes))


def test_runs_of_one_name_are_one_run():
    found = runs.catalogue()
    for run in pages.runs_beyond():
        assert found.setdefault(run.name, run) == run


@every_figure
def test_figure_is_drawn_and_told(name, small, tmp_path):
    module = pages.BEYOND[name]
    figure = module.draw(Alike(small))
    if name == "sinusoid":
        style.save(figure, name, tmp_path, tmp_path)
        assert sorted(path.suffix for path in tmp_path.iterdir()) == [".pdf", ".png"]
    else:
        figure.draw_without_rendering()
    assert len(module.says(Alike(small))) > 200 and module.CAPTION


def test_held_force_is_held_until_the_contact_slides(small):
    shear = beyond.sheared_part(small)
    assert small["normal_force"][shear] == pytest.approx(0.8, abs=1e-7)
    assert 0 < beyond.sliding(small) < beyond.unsheared(small)
    assert beyond.strength(small) >= small["tangential_force"][-1]


def integral(x, half_width, traction):
    """Principal value of int p(y)/(x - y) dy over |y| < a for p with inverse square roots at the
    edges, by Gauss-Chebyshev quadrature."""
    count = 4000
    y = half_width * np.cos((np.arange(count) + 0.5) * np.pi / count)
    return np.pi / count * np.sum(np.sqrt(half_width ** 2 - y ** 2) * traction(y)
                                  / (x[:, None] - y), axis=1)


def test_bonded_contact_does_not_move_sideways():
    half, count = runs.half_width(25), 4000
    x = half * np.cos(np.arange(500, 3501, 250) * np.pi / count)
    pressure = 0.5 * np.sqrt(half ** 2 - x ** 2)
    pull = beyond.reference.ligament_force(half,
                                           runs.PERIOD) / (np.pi * np.sqrt(half ** 2 - x ** 2))
    for ratio in (0.0, 0.3):
        found = integral(x, half, lambda y: poisson.bonded_traction(y, 25, ratio))
        assert found == pytest.approx(-np.pi * poisson.coupling(ratio) * (pull - pressure),
                                      abs=5e-4)


def test_pressing_moves_the_surface_as_a_half_plane_does(tmp_path):
    found = runs.Results(tmp_path)
    run = beyond.held("coupled", 0.8, steps=20, points=512, normal_maugis=2.0, period=60.0,
                      poisson=0.0)
    run.options.update(archive_fields="all", load_path="normal_force=0.8",
                       continuation_initial_step="0.25", continuation_largest_step="1.5")
    found.make_all([run], 1, lambda line: None)
    record = found["coupled"]
    last = record.points - 1
    _, displacement = record.field("displacement", last)
    normal, tangential = (np.fft.rfft(one) for one in record.field("traction", last)
                          * np.array([[2.0], [1.0]]))
    wave = 2 * np.pi * np.fft.rfftfreq(512, 60.0 / 512)[1:-1]
    expected = -2 / wave * (tangential + 1j * poisson.coupling(0.0) * normal)[1:-1]
    assert np.abs(np.fft.rfft(displacement)[1:-1] - expected).max() < 1e-6 * np.abs(expected).max()
    x = record.coordinates[0]
    _, gap, _, _, traction = observed.profile(record, last)
    assert np.all(traction[(x > -1) & (x < 0)] > 0) and np.all(traction[(x > 0) & (x < 1)] < 0)


def test_gap_of_the_contact_without_adhesion_is_that_of_hertz():
    half = 0.5 * remnant.jkr_width(25, 0.0)
    edge = 0.5 * remnant.measured_width(25, 0.0)
    gap, _ = quad(lambda x: np.sqrt(x * x - half * half), half, edge)
    assert gap == pytest.approx(np.e / remnant.MAUGIS, rel=1e-8)
    assert (remnant.jkr_width(-1, 1.01 * remnant.least_share(-1)) > 0
            and np.isnan(remnant.jkr_width(-1, 0.99 * remnant.least_share(-1))))


def test_layer_narrows_the_contact_less_and_less():
    changes = [cell.layer_distance(height) for height in (40.0, 60.0, 100.0, 400.0)]
    assert changes[0] < changes[1] < changes[2] < 0 and abs(changes[3]) < 1e-10


def test_cell_matters_as_the_square_of_its_period():
    assert cell.alone().options["scene_period"] == np.inf
    assert cell.jkr_distance(1000.0) == pytest.approx(0.01 * cell.jkr_distance(100.0), rel=0.03)


@pytest.mark.parametrize("normal", [5, 8])
def test_friction_of_uniform_slip_fades_where_tension_opens_the_gap(normal, tmp_path):
    found = runs.Results(tmp_path)
    run = beyond.held("pressed", onsets.FORCE, normal_maugis=float(normal), points=8192)
    run.options.update(archive_fields="last", load_path=f"normal_force={onsets.FORCE:g}",
                       continuation_initial_step="0.25", continuation_largest_step="1.5")
    found.make_all([run], 1, lambda line: None)
    record = found["pressed"]
    x, gap, *_ = observed.profile(record, record.points - 1)
    width = np.sum(np.exp(-np.maximum(gap, 0.0))) * (x[1] - x[0])
    assert onsets.gripping_width(0.0, normal) == pytest.approx(width, rel=0.02)


def test_uniform_slip_tends_to_that_of_jkr():
    distances = [onsets.uniform(normal, 0.1) / onsets.reference.uniform_slip_onset(onsets.FORCE,
                                                                                   0.1)[1] - 1
                 for normal in (20, 80, 320)]
    assert distances[0] < distances[1] < distances[2] < 0 and distances[2] > -0.01


def test_cases_are_told_in_words():
    known = np.full(4, True)
    told = [onsets.compressed("k", (1, 2, 3, 4), holds, known) for holds in
            ([1, 1, 1, 1], [0, 0, 1, 1], [1, 1, 0, 0], [0, 1, 1, 0], [1, 0, 1, 1], [0, 0, 1, 0])]
    assert told == ["all k", "k >= 3", "k <= 2", "k = 2 to 3", "k = 1, 3, 4", "k = 3"]
    assert onsets.compressed("k", (1, 2, 3, 4), [0, 0, 1, 1],
                             np.array([0, 0, 1, 1], bool)) == "all k"


def test_cells_of_a_map_meet_between_their_places():
    assert onsets.edges((1, 10, 100)) == pytest.approx([10 ** -0.5, 10 ** 0.5, 10 ** 1.5,
                                                        10 ** 2.5])
