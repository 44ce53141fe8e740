"""Figures beyond the paper's: their runs, and each of them drawn and told from one small run in the place of all."""

import sys
from pathlib import Path

import pytest

from contactsnes import Load, Scene
from contactsnes.scene import Steps, check

HERE = Path(__file__).resolve().parents[1] / "scripts" / "paper"
before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
sys.path.insert(0, str(HERE))
import beyond  # noqa: E402
import pages  # noqa: E402
import runs  # noqa: E402
import style  # noqa: E402

sys.path.remove(str(HERE))
sys.dont_write_bytecode = before

every_figure = pytest.mark.parametrize("name", pages.BEYOND)


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
        scene = Scene(**{key[6:]: value for key, value in run.options.items() if key.startswith("scene_")})
        sizes = {key: tuple(map(float, run.options[f"continuation_{key}"].split(",")))
                 for key in ("initial_step", "largest_step") if f"continuation_{key}" in run.options}
        check(scene, Load(start=run.options["load_start"], path=run.options["load_path"]), Steps(**sizes))


def test_runs_of_one_name_are_one_run():
    found = runs.catalogue()
    for run in pages.runs_beyond():
        assert found.setdefault(run.name, run) == run


@every_figure
def test_figure_is_drawn_and_told(name, small, tmp_path):
    module = pages.BEYOND[name]
    style.save(module.draw(Alike(small)), name, tmp_path, tmp_path)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".pdf", ".png"]
    assert len(module.says(Alike(small))) > 200 and module.CAPTION


def test_held_force_is_held_until_the_contact_slides(small):
    shear = beyond.sheared_part(small)
    assert small["normal_force"][shear] == pytest.approx(0.8, abs=1e-7)
    assert 0 < beyond.sliding(small) < beyond.unsheared(small)
    assert beyond.strength(small) >= small["tangential_force"][-1]
