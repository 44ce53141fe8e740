"""The scan of parameters on tiny scenes: what it tries, what it counts, and what it says of
failures."""

import sys
from pathlib import Path

import numpy as np
import pytest
from programs import load

from contactsnes.commands.session import solver_options
from contactsnes.compare.methods import entries
from contactsnes.options import database as options

ROOT = Path(__file__).resolve().parents[2]
TINY = {"points": 128, "period": 10.0, "normal_maugis": 2.0, "residual_friction": 0.5}


@pytest.fixture(scope="module")
def scan():
    """The script as a module, with tiny scenes."""
    module = load(ROOT / "scripts" / "scan")
    module.SCENES = {"cold": (TINY, "normal_displacement=1", "", None),
                     "warm": (TINY, "normal_displacement=1",
                              "normal_force=1; tangential_displacement=1", (0.5, 0.5))}
    module.SAMPLE = ("cold", "warm")
    return module


pytestmark = [pytest.mark.study, pytest.mark.usefixtures("kept_options")]


@pytest.fixture(scope="module")
def cases(scan):
    """The tiny scenes, solved by Newton's method."""
    return {name: scan.Case(name) for name in scan.SCENES}


def own(name):
    """Name -> value of the options of a method's file."""
    return entries(options.read_file(ROOT / "options" / f"{name}.opts"))


def test_every_file_of_its_kind_is_scanned_over_options_that_exist(scan):
    texts = {path.stem: path.read_text(encoding="utf-8")
             for path in (ROOT / "options").glob("*.opts")}
    assert set(scan.PARAMETERS) == {name for name, text in texts.items() if "relaxation." in text
                                    or "pseudotime." in text}
    known = {cls.prefix + name for cls in solver_options() for name in vars(cls())}
    for method, parameters in scan.PARAMETERS.items():
        assert {scan.prefix(method) + name
                for name in parameters} <= known and all(parameters.values())


def test_each_parameter_is_changed_alone_or_all_together(scan, monkeypatch):
    monkeypatch.setitem(scan.PARAMETERS, "kinetic", {"time_step": (1.0, 1.5),
                                                     "damping": (0.1, 0.2, 0.3)})
    given = {"snes_kinetic_time_step": "1.5"}
    assert scan.sets("kinetic", given, False) == [{}, {"time_step": 1.0}, {"damping": 0.1},
                                                  {"damping": 0.2}, {"damping": 0.3}]
    full = scan.sets("kinetic", given, True)
    assert full[0] == {} and len(full) == 8 and {"time_step": 1.0, "damping": 0.3} in full


@pytest.mark.parametrize("method", ("verlet", "verlet-plain", "kinetic", "pseudotime"))
def test_costs_are_those_of_the_options(scan, cases, method):
    # a parameter that is set to what it is costs what the file's own do, and one step is too few
    known = {cls.prefix + name: value for cls in solver_options()
             for name, value in vars(cls()).items()}
    for case in cases.values():
        cost = pytest.approx(case.cost(method, own(method), {}), rel=1e-9)
        assert np.isfinite(cost.expected) and cost.expected > 0
        name = next(iter(scan.PARAMETERS[method]))
        option = scan.prefix(method) + name
        assert case.cost(method, own(method),
                         {name: own(method).get(option, known[option])}) == cost
        if "damping" in scan.PARAMETERS[method] and method != "kinetic":
            assert case.cost(method, own(method), {"damping": f"1.0 {scan.CRITICAL}"}) == cost
            assert case.cost(method, own(method), {"damping": f"100.0 {scan.CRITICAL}"}) == np.inf
        # Newton's method needs but one from where a step begins
        assert method == "pseudotime" or case.cost(method, {**own(method), "snes_max_it": "1"},
                                                   {}) == np.inf


def test_a_solve_that_ends_elsewhere_has_failed(scan, cases, monkeypatch):
    case = cases["cold"]
    monkeypatch.setattr(type(case.target), "is_found", lambda self, error, norm: False)
    assert case.cost("fire", own("fire"), {}) == np.inf


def test_table_names_the_best(scan, cases, monkeypatch, capsys):
    monkeypatch.setitem(scan.PARAMETERS, "verlet", {"time_step": (0.4,),
                                                    "damping": (f"10 {scan.CRITICAL}",)})
    rows = scan.scan("verlet", cases, False)
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == "verlet" and lines[2].split() == ["cold", "warm", "mean"]
    # four times the steps of the file's own time step are too many
    assert lines[4].split() == ["time_step", "0.4", "-", "-",
                                "-"] and lines[5].split()[-3:] == ["-", "-", "-"]
    assert (not any("best" in line for line in lines)
            and rows[0][2] == pytest.approx(np.sqrt(np.prod(rows[0][1]))))
    own_file = {**own("verlet"), "snes_verlet_time_step": "0.8"}
    monkeypatch.setattr("contactsnes.compare.methods.entries", lambda arguments: own_file)
    monkeypatch.setitem(scan.PARAMETERS, "verlet", {"time_step": (1.4,)})
    scan.scan("verlet", cases, False)
    best = capsys.readouterr().out.splitlines()[-1]
    assert best.startswith("  best: -snes_verlet_time_step 1.4 (0.")


def test_the_script_scans_what_is_asked_for(scan, monkeypatch, capsys):
    monkeypatch.setitem(scan.PARAMETERS, "fire", {"delay": (5,)})
    monkeypatch.setattr(sys, "argv", ["scan", "fire", "--scenes", "cold"])
    assert scan.main() == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.strip()]
    assert (lines[0] == "fire" and lines[1].split() == ["cold", "mean"]
            and lines[3].split()[:2] == ["delay", "5"])
    # a file whose own parameters fail is the script's failure
    monkeypatch.setattr(scan, "MOST_STEPS", 3)
    monkeypatch.setattr(sys, "argv", ["scan", "fire", "--scenes", "all"])
    assert scan.main() == 1


@pytest.mark.parametrize("words, named", ((["fyre"], "'fyre' is no method"),
                                          (["--scenes", "D = 6"], "'D = 6' is no scene")))
def test_what_is_unknown_is_named(scan, monkeypatch, capsys, words, named):
    monkeypatch.setattr(sys, "argv", ["scan", *words])
    with pytest.raises(SystemExit) as stopped:
        scan.main()
    assert stopped.value.code == 2 and named in capsys.readouterr().err
