"""scripts/rough on coarse grids: the challenge pressed, pulled off, and sheared to gliding; tables
and figures."""

import sys
from pathlib import Path

import numpy as np
import petsc4py
import pytest
from programs import load

petsc4py.init([])

ROOT = Path(__file__).resolve().parents[2]
pytestmark = [pytest.mark.study, pytest.mark.usefixtures("kept_options")]


@pytest.fixture(scope="module")
def script():
    """The script as a module."""
    sys.path.insert(0, str(ROOT / "scripts"))
    yield load(ROOT / "scripts/rough")
    sys.path.remove(str(ROOT / "scripts"))


@pytest.fixture(scope="module")
def found(script):
    """The runs that --quick makes."""
    return {name: function(*arguments) for name, (function, arguments) in script.QUICK.items()}


def test_the_file_is_the_challenge(script):
    """Columns of the file: the slope that is left of all waves', the range over the square root of
    the spacing; in SI."""
    scene, load, _ = script.scene()
    assert scene.shape == (512, 512) and load.stop == "pull_off"
    assert scene.told(scene.periods, "beta") == pytest.approx((1e-4, 1e-4))
    assert scene.contact_modulus == 25e6 and scene.work_of_adhesion_normal == 0.05
    # rho = 30 x 2.071 nm has the strength gamma/rho
    assert scene.told(1 / scene.normal_maugis, "u_n,r") * np.e == pytest.approx(30 * 2.071e-9,
                                                                                rel=1e-3)
    text = script.FILE.read_text()
    rows = {row.split()[1]: row.split()[2:] for row in text.splitlines()
            if row.startswith(("#     points", "#     shortest", "#     slope", "#     range"))}
    numbers = np.arange(-1000, 1001)
    q = np.hypot(numbers[:, None], numbers)  # wave numbers of the cell, 2 pi/L
    for place, points in enumerate((256, 512)):
        assert script.WAVES[points] == tuple(float(rows[name][place]) for name in (
            "shortest", "slope", "range"))
    all_waves = np.sum(np.where((q >= 5) & (q < 1000), np.maximum(q, 1.0) ** -1.6, 0.0))
    for points, shortest, slope, reach in zip(*(rows[name] for name in (
            "points", "shortest", "slope", "range"))):
        kept = (q >= 5) & (q < 1e-4 / float(shortest) * (1 - 1e-9))
        part = np.sum(np.where(kept, np.maximum(q, 1.0) ** -1.6, 0.0))
        assert float(slope) == pytest.approx(np.sqrt(part / all_waves), abs=1e-3)
        spacing = 1e-4 / float(points.split(",")[0])
        assert float(shortest) == pytest.approx(4.096 * spacing, rel=1e-6)
        assert float(reach) == pytest.approx(2.286e-8 * np.sqrt(spacing * 512 / 1e-4), rel=1e-3)


def test_paths_end_apart_and_gliding(script, found):
    pressed, sheared = found["pressed-128-1"], found["sheared-128-1"]
    assert pressed["event"][-1] == "pull_off" and sheared["event"][-1] == "gross_sliding"
    top = script.page.full(pressed)
    assert pressed["normal_force"][top] == pytest.approx(2.5e-3, rel=1e-12)
    assert pressed["spots"][top] > 50 and pressed["normal_force"].min() < 0.0
    assert np.sum(pressed["areas_1"]) == pytest.approx(pressed["contact_area"][top], rel=0.05)
    assert pressed["stiffness"][top] > 0.0
    # one curve: an asperity here is too sharp to snap
    assert script.page.at(pressed, 2.5e-5, 3) == pytest.approx(script.page.at(pressed, 2.5e-5, 1),
                                                               rel=0.02)
    assert 0.0 < sheared["tangential_force_x"][-1] < 2.5e-3 and sheared["stick_area"][-1] == 0.0


def test_stiffness_is_the_slope_of_the_curve(found):
    """By parabolas through three points, where they are near each other."""
    run = found["pressed-128-1"]
    part = run["leg"] == 2
    force, displacement = run["normal_force"][part], run["normal_displacement"][part]
    slope = np.gradient(force, displacement)[2:-2]
    np.testing.assert_allclose(run["stiffness"][part][2:-2], slope, rtol=0.02)


def test_tables_and_figures_tell_of_all_runs(script, found, tmp_path):
    lines = script.page.tables(found)
    assert sum(line.startswith("| 128², seed 1") for line in lines) == 3
    assert script.page.draw(found, tmp_path / "a.png").stat().st_size > 50000
    assert script.page.draw_shear(found, tmp_path / "b.png").stat().st_size > 20000
