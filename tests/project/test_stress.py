"""A seeded sample of the stress test: outcomes are what they are called, and nothing ends
unnamed."""

import csv
import dataclasses
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from programs import load

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "stress"
SAMPLE = ("cold_force:-5", "start:overlap 30", "start:nan 1", "random:2", "random:46")


@pytest.fixture(scope="module")
def stress():
    """The script as a module."""
    return load(SCRIPT)


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    """(exit status, folder, rows of the table) of a few cases."""
    folder = tmp_path_factory.mktemp("stress")
    words = [word for name in SAMPLE for word in ("--only", name)]
    process = subprocess.run([sys.executable, SCRIPT, "--limit", "10", "--results", folder, *words],
                             capture_output=True, text=True)
    assert (folder / "stress-default.csv").is_file(), process.stderr
    with open(folder / "stress-default.csv", newline="", encoding="utf-8") as file:
        return process.returncode, folder, {f"{row['axis']}:{row['value']}": row
                                            for row in csv.DictReader(file)}


@pytest.mark.study
def test_sample_of_hard_cases_is_solved_by_the_default_settings(stress, sample):
    status, _, rows = sample
    assert set(rows) == set(SAMPLE)
    assert {name: row["reason"] for name, row in rows.items()
            if row["outcome"] not in stress.SOUND} == {}
    assert status == 0


@pytest.mark.study
def test_end_of_branch_is_named(sample):
    row = sample[2]["cold_force:-5"]
    assert row["outcome"] == "no equilibrium" and "no equilibrium" in row["reason"]


@pytest.mark.study
def test_a_start_that_is_no_number_is_named(sample):
    row = sample[2]["start:nan 1"]
    assert row["outcome"] == "refused" and "NaN" in row["reason"]


@pytest.mark.study
def test_what_is_sound_is_not_run_again(stress, sample):
    table = sample[1] / "stress-default.csv"
    known = stress.read_table(table)
    assert len(known) == len(SAMPLE)
    case = next(case for case in stress.axes(False)
                if f"{case.axis}:{case.label}" == "cold_force:-5")
    assert known[stress.command(case, [])].outcome == "no equilibrium"
    words = [word for name in SAMPLE for word in ("--only", name)]
    again = subprocess.run([sys.executable, SCRIPT, "--resume", "--results", sample[1], *words],
                           capture_output=True, text=True)
    assert again.returncode == 0 and "in 0.0 min" in again.stdout
    assert str(stress.read_table(table)) == str(known)


@pytest.mark.study
def test_map_is_drawn(sample):
    assert (sample[1] / "stress-default.png").stat().st_size > 10000


def test_cases_are_many_and_the_same_every_time(stress):
    cases = list(stress.axes(False))
    assert len({(case.axis, case.label) for case in cases}) == len(cases) > 100
    drawn = [stress.random_case(1, number) for number in range(200)]
    assert drawn == [stress.random_case(1, number) for number in range(200)]
    assert len({str(case.options) for case in drawn}) == 200


@pytest.mark.parametrize("outcome", ("wrong", "unhandled", "crashed", "timeout"))
def test_nothing_ends_in_silence(stress, tmp_path, monkeypatch, outcome):
    """Children that misbehave are outcomes: the script's own process stands in for them."""
    child = {"wrong": 'print(\'{"outcome": "wrong", "reason": "made up"}\')',
             "unhandled": 'print(\'{"outcome": "unhandled", "reason": "ZeroDivisionError"}\')',
             "crashed": "import os; os.abort()",
             "timeout": "import os, signal; os.kill(os.getpid(), signal.SIGXCPU)"}
    script = tmp_path / "child.py"
    script.write_text(child[outcome])
    monkeypatch.setattr(stress, "__file__", str(script))
    case = next(stress.axes(True))
    result = stress.judged(case, [], 5, compared=False)
    assert result.outcome == outcome and result.reason
    assert dataclasses.asdict(result)["outcome"] not in stress.SOUND


def test_all_cases_go_to_the_page_and_some_do_not(stress, tmp_path, monkeypatch):
    page, figure = tmp_path / "results.md", tmp_path / "stress.png"
    monkeypatch.setattr(stress, "PAGE", page)
    monkeypatch.setattr(stress, "FIGURE", figure)
    page.write_text(f"before\n{stress.BEGIN}old\n{stress.END}after\n", encoding="utf-8")
    cases = [next(stress.axes(True)), stress.random_case(1, 0)]
    results = [stress.Result(outcome, "", 1, "", 0.0, 0.0, 0.0, 0.0)
               for outcome in ("converged", "timeout")]
    everything = dict(method=None, only=None, quick=False, no_reference=False, random=None, seed=1,
                      results=tmp_path)
    (tmp_path / "stress-default.csv").write_text("", encoding="utf-8")
    stress.show(SimpleNamespace(**{**everything, "only": ["random"]}), cases, results, "default")
    assert "old" in page.read_text(encoding="utf-8") and not figure.exists()
    stress.show(SimpleNamespace(**everything), cases, results, "default")
    text = page.read_text(encoding="utf-8")
    assert ("| timeout | 1 |" in text and "| all | 2 |" in text and "old" not in text
            and figure.exists())
    assert text.startswith("before\n") and text.endswith("after\n")


def test_the_page_has_its_marks(stress):
    text = stress.PAGE.read_text(encoding="utf-8")
    assert text.count(stress.BEGIN) == text.count(stress.END) == 1
