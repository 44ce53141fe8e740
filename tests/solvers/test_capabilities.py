"""What methods can do is declared in one place, and options and types of SNES are found there."""

import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact.even_form import EvenForm  # noqa: E402
from contactsnes.contact.force_form import FORMS, ForceForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene  # noqa: E402
from contactsnes.solvers import capabilities  # noqa: E402
from contactsnes.solvers.registry import OPTIONS  # noqa: E402

RELAXATION = "contactsnes.solvers.relaxation."
ROOT = Path(__file__).resolve().parents[2]
TINY = ["-scene_points", "64", "-scene_period", "20", "-scene_normal_maugis", "1", "-load_path",
        "normal_displacement=0.5", "-continuation_initial_step", "0.25",
        "-continuation_largest_step", "0.25"]


@pytest.mark.parametrize("name, other, told", [
    ("ScalarType", np.complex128, "type complex128; float64 is needed"),
    ("ScalarType", np.float32, "type float32; float64 is needed"),
    ("Sys", SimpleNamespace(getVersion=lambda: (3, 17, 5)), "version 3.17.5; 3.18 or newer"),
])
def test_another_petsc_is_refused(monkeypatch, name, other, told):
    """Before anything is solved, with what to do."""
    monkeypatch.setattr(PETSc, name, other)
    with pytest.raises(InputError, match=f"{told}.*PETSC_DIR and PETSC_ARCH"):
        Branch(Scene(points=64), Load(path="normal_displacement=0.5"))


@pytest.mark.parametrize("kind, tangent", [("newtonls", True), ("newtontr", True), ("fas", False),
                                           ("ngmres", False), ("qn", False), ("shell", False),
                                           ("composite", False), ("ksponly", False)])
def test_types_of_petsc(kind, tangent):
    """What Newton's methods alone can do, whatever is nested in others."""
    found = capabilities.of(kind)
    assert found.name == kind and found.has_tangent == found.keeps_evenness == tangent
    assert found.most_iterations == (200 if tangent else 10000)
    assert not found.is_relaxation and found.one_window == (kind == "fas")


@pytest.mark.parametrize("name", ["Fire", "Verlet", "Adaptive", "Kinetic"])
def test_types_of_dynamic_relaxation(name):
    found = capabilities.of("python", RELAXATION + name)
    assert found.is_relaxation and found.kind == "dynamic relaxation" and not found.has_tangent
    assert found.keeps_evenness


@pytest.mark.parametrize("path", ["", "nowhere.at.All", "contactsnes.solvers.relaxation.Nothing",
                                  "collections.OrderedDict"])
def test_a_type_that_says_nothing_is_taken_to_be_able_of_nothing(path):
    found = capabilities.of("python", path)
    assert found.kind == "others" and not found.has_tangent and not found.is_relaxation


def test_a_snes_is_asked_as_it_is(options):
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setType("newtontr")
    assert capabilities.of_snes(snes).has_tangent
    snes.setType("python")
    snes.setPythonType(RELAXATION + "Fire")
    assert capabilities.of_snes(snes).is_relaxation
    snes.destroy()
    options(snes_type="python", snes_python_type=RELAXATION + "Kinetic", arc_snes_type="qn")
    assert capabilities.asked().is_relaxation and capabilities.asked("arc_").name == "qn"
    assert capabilities.has_modes(Form()) and not capabilities.has_modes(Form(form="force"))


def test_forms_declare_what_they_are():
    assert FORMS == {"displacement": DisplacementForm, "force": ForceForm}
    assert [(form.in_displacements, form.whole_cell, form.even)
            for form in (DisplacementForm, EvenForm, ForceForm)] == [
                (True, False, False), (True, False, True), (False, True, False)]


def test_options_of_all_types_are_found():
    prefixes = [cls.prefix for cls in OPTIONS]
    assert {"snes_regularised_", "snes_grids_", "pc_core_", "snes_verlet_", "snes_adaptive_",
            "snes_kinetic_", "snes_fire_", "snes_pseudo_"} <= set(prefixes)
    assert len(prefixes) == len(set(prefixes))


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A function that runs the command of a copy of the package with the two files that
    docs/extending.md shows."""
    folder = tmp_path_factory.mktemp("extended")
    shutil.copytree(ROOT / "contactsnes", folder / "contactsnes",
                    ignore=shutil.ignore_patterns("*.pyc.*"))  # which are being written
    page = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    shown = re.findall(r"```python\n(.*?)```", page, flags=re.S)
    for name, text in (("solvers/heavy_ball.py", "class HeavyBall("),
                       ("continuation/predictors/cubic.py", "class Cubic(")):
        source, = (code for code in shown if text in code)
        (folder / "contactsnes" / name).write_text('"""One file."""\n\n' + source)

    def run(*words):
        return subprocess.run([sys.executable, "-m", "contactsnes", *words], cwd=folder, text=True,
                              capture_output=True, check=False)
    return run


def test_a_predictor_takes_one_file(extended):
    helped = " ".join(extended("run", "-help").stdout.split())
    assert "edge (follows contact edges and slip fronts, where there are any), cubic" in helped
    done = extended("run", *TINY, "-continuation_predictor", "cubic", "-archive_file", "cubic.h5")
    assert done.returncode == 0, done.stderr
    done = extended("run", *TINY, "-continuation_predictor", "cubic", "-continuation_type",
                    "arclength", "-archive_file", "arc.h5")
    assert done.returncode == 0, done.stderr
    assert extended("run", *TINY, "-continuation_predictor", "quartic").returncode == 2


def test_a_type_of_snes_takes_one_file(extended):
    method = ["-contact_form", "force", "-snes_type", "python", "-snes_python_type",
              "contactsnes.solvers.heavy_ball.HeavyBall"]
    assert "-snes_heavy_ball_kept" in extended("run", "-help").stdout
    done = extended("run", *TINY, *method, "-snes_heavy_ball_kept", "0.8", "-archive_file", "b.h5")
    assert done.returncode == 0, done.stderr
    done = extended("run", *TINY, *method, "-snes_heavy_ball_kepd", "0.8")
    assert done.returncode == 2 and "-snes_heavy_ball_kept" in done.stderr
