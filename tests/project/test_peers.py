"""The comparison with other codes, as far as it goes without them; marked as studies, with them."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import load

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "peers"


peers = load(SCRIPT)


pytestmark = pytest.mark.usefixtures("kept_options")


@pytest.fixture(name="problem")
def small_problem(monkeypatch):
    """A cylinder on a small grid."""
    monkeypatch.setitem(peers.CASES, "small", ({**peers.LINE, "points": 1024, "period": 40.0,
                                                "normal_maugis": 3.0}, 2.0, 0.1))
    return peers.Problem("small", "warm")


def spared(monkeypatch, *packages):
    """Make packages impossible to import."""
    real = peers.importlib.import_module

    def import_module(name, *rest):
        if name.split(".")[0] in packages:
            raise ModuleNotFoundError(f"No module named '{name}'")
        return real(name, *rest)

    monkeypatch.setattr(peers.importlib, "import_module", import_module)


@pytest.mark.parametrize("words, named", [(["--cases", "cube"], "cube"),
                                          (["--peers", "nobody"], "nobody"),
                                          (["--starts", "hot"], "hot"),
                                          (["--repeats", "0"], "--repeats is 0"),
                                          (["--repeats", "x"], "--repeats")])
def test_bad_arguments(words, named, capsys):
    with pytest.raises(SystemExit) as stop:
        peers.parse(words)
    assert stop.value.code == 2 and named in capsys.readouterr().err


def test_help_says_what_it_is():
    done = subprocess.run([sys.executable, SCRIPT, "--help"], capture_output=True, text=True,
                          timeout=600, check=False)
    assert done.returncode == 0 and "Tamaas" in done.stdout and "sphere-512" in done.stdout


def test_missing_peers_are_left_out(monkeypatch, capsys, tmp_path):
    spared(monkeypatch, "tamaas", "Adhesion")
    assert peers.main(["--output", str(tmp_path / "results")]) == 1
    text = capsys.readouterr().out
    assert "pip install tamaas" in text and "pip install Adhesion" in text
    assert not (tmp_path / "results").exists()


def test_the_others_go_on(monkeypatch, capsys):
    spared(monkeypatch, "Adhesion")
    monkeypatch.setitem(peers.PEERS, "tamaas", ("numpy",))
    assert peers.present(["adhesion", "tamaas"]) == ["tamaas"]
    assert "Adhesion is left out" in capsys.readouterr().out


@pytest.mark.parametrize("norms, place", [([3, 2, 0.5], 2), ([0.5, 2, 0.1, 0.2], 2), ([0.1], 0),
                                          ([2, np.nan], None), ([0.1, 3], None), ([], None)])
def test_settled(norms, place):
    assert peers.settled(np.array(norms, dtype=float), 1.0) == place


def test_residual_of_our_solution(problem):
    norm, force = problem.residual(problem.reference, peers.OURS)
    assert norm <= 1e-10
    assert force == pytest.approx(-problem.mean_traction * problem.grid.area)
    shifted = problem.reference + 0.01 * np.cos(2 * np.pi * np.arange(1024) / 1024)
    assert problem.residual(shifted, peers.OURS)[0] > 1e-3


def wall_residual(problem, at_wall, further=0.0):
    """Residual of a field whose traction is given at the wall, and the law's at a gap of five
    ranges elsewhere; then moved."""
    coordinate, = problem.grid.coordinates()
    pressed = np.abs(coordinate) < 1.0
    traction = np.where(pressed, at_wall, np.exp(-5.0 / np.e) / np.e)[None]
    field = -peers.Convolution(problem.grid.whole, problem.contact.operator(1),
                               1).apply(traction, np.empty_like(traction))
    problem.forms[peers.WALL].initial_gap = np.where(pressed, 0.0,
                                                     5.0 + further * (coordinate > 3.0)) - field[0]
    return problem.residual(field[0] / problem.maugis, peers.WALL)[0]


def test_residual_at_the_wall(problem):
    """Balanced is what presses, or pulls less than the law at the wall (1/e); not what pulls more,
    nor another gap elsewhere."""
    assert wall_residual(problem, -50.0) < 1e-12 and wall_residual(problem, 0.3) < 1e-12
    assert wall_residual(problem, 0.6) > 1e-2 and wall_residual(problem, -50.0, further=0.5) > 1e-2


def test_newton_reaches_every_target(problem):
    measurement = peers.Measurement(problem, peers.newton(problem))
    measurement.time()
    rows = list(measurement.table(measurement))
    assert [row["target"] for row in rows] == list(peers.TARGETS)
    for row in rows:
        assert (row["residual_norm"] <= row["target"] and row["ratio"] == row["cpu_ratio"]
                == row["transforms_ratio"] == 1.0)
    assert rows[-1]["displacement_error"] < 1e-7


def halving(problem, steps=60):
    """A method that halves its distance to the reference, at two transforms an iteration."""
    count = [0]

    def solve(watch):
        for step in range(steps):
            count[0] += 2
            watch(problem.reference + 0.5 ** step * 0.01 * np.cos(2 * np.pi * np.arange(1024)
                                                                  / 1024))
        return "that was all"

    return peers.Method("Peer", "1", "halving", peers.OURS,
                        peers.partial(peers.watched, problem, peers.OURS, lambda: count[0], solve))


def test_a_peer_is_watched_and_timed(problem):
    measurement = peers.Measurement(problem, halving(problem))
    assert None not in measurement.places and measurement.last == len(measurement.first.rows) - 1
    measurement.time()
    assert len(measurement.timed[0]) == measurement.last + 1
    for row in measurement.table(peers.Measurement(problem, peers.newton(problem))):
        assert row["target"] / 2.5 < row["residual_norm"] <= row["target"]
    assert np.all(np.diff(measurement.history()[:, 0]) == 2)


def test_a_peer_that_gives_up_says_so(problem):
    measurement = peers.Measurement(problem, halving(problem, steps=15))
    row = list(measurement.table(measurement))[-1]
    assert "seconds" not in row and "15 iterations; that was all" in row["note"]


def test_a_peer_that_fails_says_so(problem):
    def solve(watch):
        raise ValueError("no\nidea")

    method = peers.Method("Peer", "1", "failing", peers.OURS,
                          peers.partial(peers.watched, problem, peers.OURS, lambda: 0, solve))
    measurement = peers.Measurement(problem, method)
    measurement.time()
    base = peers.Measurement(problem, peers.newton(problem))
    base.time()
    assert all("ValueError: no idea" in row["note"] for row in measurement.table(base))
    assert any("ValueError" in line for line in peers.lines("small", "warm", [base, measurement]))


@pytest.mark.study
def test_the_peers_agree(tmp_path):
    """Adhesion on our law finds our solution; Adhesion and Tamaas find one and the same on theirs,
    by the wall's residual."""
    pytest.importorskip("tamaas")
    pytest.importorskip("Adhesion")
    assert peers.main(["--cases", "sphere-128", "--repeats", "1", "--output", str(tmp_path)]) == 0
    with open(tmp_path / "peers.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["normal_force"]]
    errors = {(row["code"], row["method"]): float(row["displacement_error"]) for row in rows
              if row["displacement_error"]}
    assert {code for code, _ in errors} == {"contactsnes", "Adhesion",
                                            "Tamaas"} and max(errors.values()) < 1e-6
    forces = {row["code"]: float(row["normal_force"]) for row in rows if row["law"] == peers.WALL}
    # their approaches differ that much
    assert forces["Adhesion"] == pytest.approx(forces["Tamaas"], rel=5e-4)
    assert {path.name for path in tmp_path.iterdir()} == {"peers.csv", "peers.png",
                                                          "peers-sphere-128.h5"}
