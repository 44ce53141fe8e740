"""The example of a study: what it says is understood, its table tells its runs apart, and where
Snakemake is, it runs the study and goes on with runs that were begun."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest
from processes import ENVIRONMENT, ROOT, call
from programs import load

from contactsnes import Scene, read

STUDY = ROOT / "examples" / "study"
VALUES = {"scene_tangential_maugis": [1, 2], "scene_residual_friction": [0, 0.5]}
SMALL = {"scene_points": "512"}


def configured():
    """Parameters and columns of the study, of lists in one line each."""
    text = (STUDY / "config.yaml").read_text(encoding="utf-8")
    lists = dict(re.findall(r"^ *(\w+): (\[.*\])$", text, re.MULTILINE))
    columns = lists.pop("columns").strip("[]").split(", ")
    return {name: json.loads(values) for name, values in lists.items()}, columns


@pytest.fixture
def folder(tmp_path):
    """A copy of the study with few small runs."""
    shutil.copytree(STUDY, tmp_path / "study")
    scene = tmp_path / "study" / "study.opts"
    scene.write_text(scene.read_text() + "".join(f"-{name} {value}\n"
                                                 for name, value in SMALL.items()))
    return scene.parent


def snakemake(folder, *arguments):
    """A finished process of Snakemake in a folder, with the values of this test."""
    return subprocess.run(
        ["snakemake", "--cores", "1", *arguments, "--config", f"python={sys.executable}",
         f"parameters={json.dumps(VALUES)}"], cwd=folder, env=ENVIRONMENT, capture_output=True,
        text=True, timeout=300, check=False)


def test_all_parameters_of_the_study_are_options_and_all_columns_are_known(folder):
    parameters, columns = configured()
    assert list(parameters) == list(VALUES) and all(map(len, parameters.values()))
    for name, values in parameters.items():
        for value in values:
            Scene(**{name[len(Scene.prefix):]: value})
    done = call("run", "study.opts", "-archive_file", "a.h5", folder=folder)
    assert done.returncode == 0, done.stderr
    table = call("table", "a.h5", "-rows", "event", "-columns", ",".join([*parameters, *columns]),
                 folder=folder)
    heading, row = table.stdout.splitlines()
    assert heading.split(",") == [*parameters, *columns]
    assert row.endswith(",gross_sliding,1,1")


def test_the_figure_of_the_study_has_a_curve_of_each_parameter(folder):
    rows = ["2,0.5,4", "1,0.5,3", "2,0,3.5"]
    (folder / "table.csv").write_text("\n".join([
        "scene_tangential_maugis,scene_residual_friction,tangential_force", *rows]))
    curves = load(STUDY / "figure.py").main(folder / "table.csv", folder / "a.png")
    assert curves == {2.0: [(0.5, 4.0), (0.0, 3.5)], 1.0: [(0.5, 3.0)]}
    assert (folder / "a.png").stat().st_size > 5e3


@pytest.mark.skipif(not shutil.which("snakemake"), reason="needs snakemake: pip install snakemake")
def test_snakemake_runs_the_study_and_goes_on_with_what_was_begun(folder):
    begun = folder / "runs" / "tangential_maugis_2-residual_friction_0.5.h5"
    begun.parent.mkdir()
    call("run", "study.opts", "-scene_tangential_maugis", "2", "-scene_residual_friction", "0.5",
         "-load_path", "normal_force=2", "-archive_file", begun, folder=folder)
    before = read(begun).points
    done = snakemake(folder)
    assert done.returncode == 0, done.stderr
    heading, *rows = (folder / "table.csv").read_text().splitlines()
    columns = [row.split(",") for row in rows]
    assert [tuple(map(float, row[:2])) for row in columns] == [(1, 0), (1, 0.5), (2, 0), (2, 0.5)]
    assert [row[-1] for row in columns] == ["1"] * 4 and (folder / "onset.png").exists()
    assert [run.first for run in read(begun).runs] == [0, before]
    made = os.stat(begun).st_mtime_ns
    assert "Nothing to be done" in snakemake(folder).stderr and os.stat(begun).st_mtime_ns == made
