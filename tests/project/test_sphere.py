"""scripts/sphere on coarse grids: paths to gliding, pull-off after shear, tables and figure."""

import sys
from pathlib import Path

import numpy as np
import petsc4py
import pytest
from programs import load

petsc4py.init([])

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.study


@pytest.fixture(scope="module")
def script():
    """The script as a module."""
    sys.path.insert(0, str(ROOT / "scripts"))
    yield load(ROOT / "scripts/sphere")
    sys.path.remove(str(ROOT / "scripts"))


@pytest.fixture(scope="module")
def found(script):
    """The runs that --quick makes."""
    return dict(script.run(task) for task in script.tasks(quick=True).items())


def test_paths_end_gliding_and_pulls_are_weaker_after_shear(script, found):
    paths = [run for name, run in found.items() if name.startswith("sheared")]
    assert len(paths) == 4 and all(run["event"][-1] == "gross_sliding" for run in paths)
    for run in paths:
        assert run["tangential_force_x"][0] == 0.0 and 0.2 < script.page.lost(run) < 0.9
    pulled = script.page.Runs(found, "pulled").numbers(script.page.pull_off)
    assert pulled[0.0, 1.0][0] < pulled[0.2, 1.0][0] < 0.0
    # The law of Maugis and Dugdale at the same strength: -1.55 pi at lambda_n = 3.
    assert pulled[0.0, 1.0][0] == pytest.approx(-1.55 * np.pi, rel=0.07)


def test_tables_and_figure_tell_of_all_runs(script, found, tmp_path):
    lines = script.page.tables(found)
    assert sum(line.startswith("| 4 | 1 |") for line in lines) == 2
    assert any(line.startswith("k ~ A_0^-n: n =") for line in lines)
    assert all(" ± " in line for line in lines if line.startswith(("| 0 |", "| 4 |", "| 0.2 |")))
    assert script.page.draw(found, tmp_path / "a.png").stat().st_size > 50000


def test_runs_are_kept_and_read_again(script, found, tmp_path, monkeypatch):
    monkeypatch.setattr(script, "run", lambda task: (task[0], found[task[0]]))
    todo = dict(list(script.tasks(quick=True).items())[:2])
    script.measure(todo, tmp_path / "sphere.h5", 1, False)
    kept = script.read_hdf5(tmp_path / "sphere.h5")[1]
    assert set(kept) == set(todo)
    for name, columns in kept.items():
        assert list(columns["event"]) == list(found[name]["event"])
        np.testing.assert_array_equal(columns["contact_area"], found[name]["contact_area"])


def test_errors_are_summed_over_what_is_coarser(script):
    """The cell and the steps beside the coarser grid, the grid beside the finest."""
    runs = {f"sheared-4-1-{way}": {"number": number} for way, number
            in (("finest", 10.0), ("grid", 10.5), ("cell", 10.3), ("steps", 11.5))}
    value, error = script.page.Runs(runs, "sheared").numbers(lambda run: run["number"])[4.0, 1.0]
    assert (value, error) == (10.0, pytest.approx(0.5 + 0.2 + 1.0, rel=1e-12))
    assert set(script.WAYS) == {"finest", *script.page.BESIDE}


def test_coefficients_are_those_of_a_parabola(script):
    force = np.linspace(0, 5, 40)
    run = {"tangential_force_x": force, "contact_area": 20 - 0.3 * force ** 2}
    assert script.page.coefficient(run) == pytest.approx(0.3, rel=1e-12)
    assert script.page.curvature(run) == pytest.approx(0.0, abs=1e-12)
    assert script.page.largest_force({**run, "tangential_force_x": force * (6 - force)}) == (
        pytest.approx(9.0, rel=1e-12))
