"""Damped motion in steps of the load, as the figure on early sliding takes it: at rest it is in
equilibrium, stopped before it is not."""

import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parents[2] / "scripts" / "paper"
before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
sys.path.insert(0, str(HERE))
import beyond  # noqa: E402
import early  # noqa: E402
import runs  # noqa: E402

sys.path.remove(str(HERE))
sys.dont_write_bytecode = before

SCENE = {"normal_maugis": 2.0, "tangential_maugis": 1.0, "residual_friction": 0.5, "points": 512,
         "period": 60.0}

pytestmark = pytest.mark.study


def motion(name, **asked):
    """A motion of a small contact whose approach is held."""
    run = early.moved("half", 512, name, 30, 90, **asked)
    run.options.update({f"scene_{key}": value for key, value in SCENE.items()},
                       load_start="normal_displacement=4", load_path="normal_displacement=5",
                       continuation_initial_step="0.5", continuation_largest_step="0.5")
    return run


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The equilibria of a small contact, motions to rest, and motions stopped before."""
    found = runs.Results(tmp_path_factory.mktemp("early"))
    equilibria = beyond.held("equilibria", 0.8, **SCENE)
    equilibria.options.update(load_start="normal_displacement=4",
                              load_path="normal_displacement=5; tangential_displacement=90",
                              continuation_initial_step="0.5,5", continuation_largest_step="0.5,10")
    lines = []
    found.make_all([equilibria, motion("rest"), motion("stopped", steps=20)], 1, lines.append)
    assert len(lines) == 3 and not any("status" in line or "input" in line for line in lines)
    return found


def test_motion_at_rest_is_in_equilibrium(results):
    record, exact = results["moved-half-p512-rest"], results["equilibria"]
    moved = record["leg"] == early.MOVED
    assert record.complete and record["tangential_displacement"][moved] == pytest.approx(
        [30, 60, 90])
    assert record["residual_norm"].max() <= 1e-8 and record["transforms"][moved].min() > 100
    last = exact.points - 1
    for name in ("tangential_force", "mean_tangential_displacement", "contact_area",
                 "normal_force"):
        assert record[name][-1] == pytest.approx(exact[name][last], rel=1e-6)
    drive = runs.reference.driven_displacement(record["mean_tangential_displacement"],
                                               record["tangential_force"], 60.0, 2000.0)
    assert drive == pytest.approx(record["tangential_displacement"], abs=1e-5)


def test_motion_stopped_before_is_kept_as_it_is(results):
    record, rest = results["moved-half-p512-stopped"], results["moved-half-p512-rest"]
    moved = record["leg"] == early.MOVED
    assert (np.all(record["nonlinear_iterations"][moved] == 20)
            and record["residual_norm"][moved].min() > 1e-3)
    assert np.all(record["mean_tangential_displacement"][moved]
                  < rest["mean_tangential_displacement"][moved])
    assert np.all(record["stable"][moved] == -1)


def test_width_that_sticks_is_the_contact_or_what_has_not_passed_the_peak(results):
    record = results["moved-half-p512-rest"]
    for point in np.flatnonzero(record["leg"] == early.MOVED):
        x, gap, slip, _, _ = early.profile(record, point)
        held = (gap < record.scene["contact_threshold"]) & (np.abs(slip) <= early.SLIP)
        spacing = x[1] - x[0]
        assert early.sticking(record, point) == pytest.approx(0.5 * held.sum() * spacing,
                                                              abs=spacing)
        assert early.sticking(record, point) <= 0.5 * record["contact_area"][point]


def test_least_displacement_of_gross_sliding_is_that_of_the_drive_and_of_the_body():
    force, half = 25.0, runs.reference.sliding_half_width(25.0, 10.0, runs.PERIOD)
    traction = 0.5 * runs.reference.peak_tangential_traction(10.0)
    x = (np.arange(2**18) - 2**17) * runs.PERIOD / 2**18
    spectrum = np.fft.rfft(np.where(np.abs(x) < half, traction, 0.0))
    wave = 2 * np.pi * np.fft.rfftfreq(x.size, runs.PERIOD / x.size)
    surface = np.fft.irfft(np.concatenate([[0.0], -2 * spectrum[1:] / wave[1:]]), x.size)
    expected = 80 * 2 * half * traction - surface[x.size // 2] + early.SLIP / 10.0
    assert early.least_sliding(force) == pytest.approx(expected, rel=1e-5)
