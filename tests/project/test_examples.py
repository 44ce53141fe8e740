"""The examples: each runs, draws its figure, and finds what is true."""

import contextlib
import importlib
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

from contactsnes import reference

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TUTORIAL = EXAMPLES / "tutorial.py"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py") if path != TUTORIAL)


@pytest.fixture
def run(tmp_path, monkeypatch, kept_options):
    """A function that runs an example, small; its figure has to be there."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.syspath_prepend(str(EXAMPLES))

    def call(name, **values):
        found = importlib.import_module(name).main(tmp_path, **values)
        sys.modules.pop(name)
        assert (tmp_path / f"{name}.png").stat().st_size > 5e3
        return found

    return call


@pytest.mark.parametrize("path", [*map("{}.py".format, NAMES), TUTORIAL.name])
def test_help_says_what_an_example_does(path, tmp_path, monkeypatch, capsys, kept_options):
    """And is no name of a folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(EXAMPLES / path), "--help"])
    with contextlib.suppress(SystemExit):
        runpy.run_path(sys.argv[0], run_name="__main__")
    assert "[FOLDER]" in capsys.readouterr().out and not list(tmp_path.iterdir())


def test_pull_off_lies_between_the_limits_of_long_and_short_ranges(run):
    values = (0.5, 2.0, 4.0)
    forces, theory = map(np.array, run("sweep", values=values))
    assert np.all(np.diff(forces) < 0.0) and forces[-1] > reference.jkr_line_pull_off(100.0)[1]
    assert forces[0] > reference.rigid_cylinder_pull_off(values[0])[1]
    assert forces == pytest.approx(theory, rel=0.15)
    assert forces[-1] == pytest.approx(theory[-1], rel=0.02)


def test_a_loop_encloses_what_its_jumps_lose(run):
    area, lost = run("hysteresis", points=512, step=0.1, maugis=2.0)
    assert lost > 1.0 and area == pytest.approx(lost, rel=5e-3)


def test_a_surface_of_bumps_touches_with_the_highest_first(run):
    areas, spots = run("own_surface", points=256)
    assert spots[0] == 1 and spots[-1] == 3 and np.all(np.diff(spots) >= 0)
    apart = np.flatnonzero(np.diff(spots))
    assert np.all(np.diff(areas)[apart] > 2.0)


def test_a_rule_of_ones_own_ends_a_branch(run):
    whole, found = run("by_hand", points=512, lost=0.03)
    areas = np.array(found)[:, 1]
    assert areas[-1] <= 0.97 * whole < areas[-2] and np.all(np.diff(areas) < 0.0)


def test_error_bars_reach_the_finer_grid(run):
    estimated, true = run("error_bars", points=320, maugis=2.0)
    assert true.max() > 1e-6 and np.all(np.abs(estimated - true) < 0.1 * true + 1e-8)


def test_friction_that_saturates_is_proportional_to_its_strength(run):
    weak, strong = map(np.array, run("own_law", strengths=(0.2, 0.4)))
    assert np.all(np.diff(weak[1]) > 0.0) and weak[1, -1] < 1.001 * weak[1, -2]
    assert strong[1, -1] == pytest.approx(2.0 * weak[1, -1], rel=1e-3)


@pytest.mark.study
def test_the_tutorial_finds_what_it_says(tmp_path, monkeypatch, kept_options):
    monkeypatch.setattr(sys, "argv", [str(TUTORIAL), str(tmp_path)])
    found = runpy.run_path(str(TUTORIAL))
    assert found["strongest"] == pytest.approx(found["theory"], rel=0.1)
    assert np.all(np.diff(found["peaks"]) > 0.5) and not found["study"].failures
    assert found["area"] == pytest.approx(found["record"]["contact_area"].max(), rel=1e-6)
    assert {path.name for path in tmp_path.iterdir()} == {
        "runs", "own.png", "study-shear.png", "study-area.png", "study-approach.png"}


def test_the_tutorial_has_cells():
    cells = TUTORIAL.read_text(encoding="utf-8").split("\n# %% ")[1:]
    assert len(cells) > 8 and all(len(cell.splitlines()) < 20 for cell in cells)


@pytest.mark.parametrize("name", NAMES)
def test_examples_are_short(name):
    assert len((EXAMPLES / f"{name}.py").read_text(encoding="utf-8").splitlines()) < 40


def test_every_example_is_tried():
    text = Path(__file__).read_text(encoding="utf-8")
    assert NAMES and all(f'run("{name}"' in text for name in NAMES)
