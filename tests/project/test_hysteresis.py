"""The script of adhesive loops on a tiny cell: what it measures, its limit, and where it writes."""

import sys
from pathlib import Path

import numpy as np
import pytest
from programs import load

ROOT = Path(__file__).resolve().parents[2]

pytestmark = [pytest.mark.study, pytest.mark.usefixtures("kept_options")]


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """The script as a module, with a small cell and large steps, writing elsewhere."""
    module = load(ROOT / "scripts" / "hysteresis")
    folder = tmp_path_factory.mktemp("hysteresis")
    module.PERIOD = 40.0
    module.STEP = 0.4
    module.CLOSEST = 1.0
    module.LARGEST = 0.5
    module.POINTS = {2: 256, 3: 512}
    module.DATA, module.FIGURE = folder / "results" / "hysteresis.h5", folder / "hysteresis.png"
    return module


@pytest.fixture(scope="module")
def measured(script):
    """The numbers of one Maugis parameter."""
    from contactsnes.options.database import database, install

    before = database()
    found = script.measure(3, 512)
    install(before)
    return found


def test_the_limit_is_that_of_short_ranges(script, monkeypatch):
    # Johnson, Kendall and Roberts' line contact in a cell of period 100, from an independent
    # solution of the integral equation
    monkeypatch.setattr(script, "PERIOD", 100.0)
    reached = script.limit()
    expected = {"pull_off_force": -1.743883, "pull_off_displacement": -3.8236,
                "release_displacement": -4.1136, "release_force": -1.6195}
    assert {name: reached[name] for name in expected} == pytest.approx(expected, abs=1e-4)
    # along the branch the energy grows by W dD, from none
    from contactsnes import reference

    assert script.jkr_energy(1e-9) == pytest.approx(0.0, abs=1e-7)
    for width, step in ((0.2, 1e-5), (0.7, 1e-5), (3.0, 1e-5)):
        one, other = width - step, width + step
        gained, way = (function(other) - function(one)
                       for function in (script.jkr_energy,
                                        lambda a: reference.jkr_line_approach(a, 100.0)))
        assert gained / way == pytest.approx(reference.jkr_line_load(width, 100.0), rel=1e-6)


def test_the_loop_and_its_folds(script, measured):
    values, reached = measured["values"], script.limit()
    for name in ("pull_off_force", "release_displacement", "pull_off_displacement"):
        assert values[name] == pytest.approx(reached[name], rel=0.1)
    assert -4.0 < values["jump_in_displacement"] < -1.0 and max(measured["errors"].values()) < 1e-5
    for control, unstable in (("displacement", {("fold", 0), ("none", 0)}),
                              ("force", {("fold", 0), ("none", 0), ("pull_off", 0)})):
        branch = measured[f"branch, {control}"]
        certificates = set(zip(branch["event"], branch["stable"]))
        assert certificates >= unstable | {("none", 1)} and -1 not in branch["stable"]
        assert branch["event"].count("fold") == (2 if control == "displacement" else 1)
    rows = measured["loop, displacement"]
    assert rows["event"].count("jump") == 2 and rows["normal_displacement"][-1] == script.far(3)
    assert values["lost_on_approach"] + values["lost_on_release"] == pytest.approx(
        rows["external_work"][-1], abs=0.02)
    assert (measured["loop, force"]["fold_kind"][-1] == "pull_off"
            and values["lost_without_force"] > values["lost_on_approach"] > 0.0)


def test_order_is_that_of_a_power(script):
    assert script.order([1.0, 5.0, 10.0, 20.0], [9.0, *(2.0 + np.array([5.0, 10.0, 20.0]) ** -1.5)],
                        2.0) == pytest.approx(1.5)
    assert np.isnan(script.order([5.0, 10.0], [1.0, 1.1], 2.0))


def test_results_are_written_drawn_and_read_again(script, measured, monkeypatch, capsys):
    monkeypatch.setattr(script, "measure", lambda maugis, points: measured)
    monkeypatch.setattr(sys, "argv", ["hysteresis", "--maugis", "3"])
    assert script.main() == 0
    assert script.DATA.with_suffix(".png").stat().st_size > 1e4 and not script.FIGURE.exists()
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
    assert [line.split("|")[1].strip() for line in lines] == 2 * ["Maugis", "---", "3", "JKR",
                                                                  "order"]
    assert f"{measured['values']['pull_off_force']:.9f}" in lines[2]
    monkeypatch.setattr(sys, "argv", ["hysteresis", "--draw"])
    assert script.main() == 0 and lines == [line for line in capsys.readouterr().out.splitlines()
                                            if line.startswith("|")]
    monkeypatch.setattr(script, "DATA", script.DATA.with_name("other.h5"))
    with pytest.raises(SystemExit, match="is missing"):
        script.main()


def test_the_page_has_its_marks(script):
    text = script.PAGE.read_text(encoding="utf-8")
    assert text.count(script.BEGIN) == text.count(script.END) == 1
