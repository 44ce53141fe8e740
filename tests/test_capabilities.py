"""What methods can do is declared in one place, and options and types of SNES are found there."""

import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.contact.even_form import EvenForm  # noqa: E402
from contactsnes.contact.force_form import FORMS, ForceForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.scene.settings import Form  # noqa: E402
from contactsnes.solvers import capabilities  # noqa: E402
from contactsnes.solvers.registry import OPTIONS  # noqa: E402

RELAXATION = "contactsnes.solvers.relaxation."


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
    assert [(form.in_displacements, form.whole_cell)
            for form in (DisplacementForm, EvenForm, ForceForm)] == [(True, False), (True, False),
                                                                     (False, True)]


def test_options_of_all_types_are_found():
    assert {cls.prefix for cls in OPTIONS} == {
        "snes_regularised_", "snes_grids_", "pc_core_", "snes_verlet_", "snes_adaptive_",
        "snes_kinetic_", "snes_fire_", "snes_pseudo_"} and len(OPTIONS) == 8
