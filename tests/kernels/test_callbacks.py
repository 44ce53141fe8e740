"""Solves by the library's callbacks: they do not enter Python, and do what Python's do."""

import ctypes
import sys

import numpy as np
import petsc4py
import pytest

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact.even_form import EvenForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.grid.mirrors import centred  # noqa: E402
from contactsnes.grid.windows import Window  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.kernels.choice import chosen  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402
from contactsnes.solvers import callbacks  # noqa: E402
from contactsnes.solvers.snes import create_snes  # noqa: E402

pytestmark = pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))

SCENE = {"points": 256, "period": 20.0, "normal_maugis": 2.0, "tangential_maugis": 2.0}
LOAD = Load(start="normal_displacement=1", path="normal_displacement=2; tangential_displacement=3")


def form_of(kind=EvenForm, kernels=None, count=2, **scene):
    contact = Contact(Scene(**{**SCENE, **scene}), kernels=kernels)
    window = centred(Window(contact.grid, [90], [77]))
    form = kind(contact, window, ("displacement", "force")[:count])
    form.set_load([2.0, 0.1][:count])
    return form


def solve(snes, form):
    unknown = PETSc.Vec().createWithArray(np.zeros(form.size), comm=PETSc.COMM_SELF)
    callbacks.solve(snes, unknown)
    assert snes.getConvergedReason() > 0
    return unknown.getArray().copy()


@pytest.mark.parametrize("kind", [EvenForm, DisplacementForm])
def test_a_solve_does_not_enter_python(kind):
    form = form_of(kind)
    snes = create_snes(form)
    first, entered = solve(snes, form), []
    unknown = PETSc.Vec().createWithArray(np.zeros(form.size), comm=PETSc.COMM_SELF)
    sys.setprofile(lambda frame, event, argument: entered.append((event, frame.f_code.co_name)))
    try:
        snes.solve(None, unknown)
    finally:
        sys.setprofile(None)
    assert snes.getLinearSolveIterations() > 5
    assert [name for event, name in entered if event == "call"] == []
    np.testing.assert_allclose(unknown.getArray(), first, atol=1e-12)


@pytest.mark.parametrize("named", [{}, {"pc_python_type": callbacks.OWN_ZONE}],
                         ids=["no class", "the default's class"])
def test_the_default_that_is_spelled_out_is_the_librarys(options, named):
    options(pc_type="python", **named)
    form = form_of()
    snes = create_snes(form)
    assert snes.getKSP().getPC().getType() == "shell"
    assert callbacks.of(snes.getKSP().getPC()) is not None
    found = solve(snes, form)
    options(pc_type="shell")
    np.testing.assert_array_equal(found, solve(create_snes(form), form))


def numbers(kernels, **given):
    """Counts and loads of a path."""
    branch = Branch(Scene(**{**SCENE, **given}), LOAD, Steps(), Form(kernels=kernels))
    points = list(branch)
    return branch, points


@pytest.mark.parametrize("given", [{}, {"poisson": 0.3}, {"law": "xu_needleman"}],
                         ids=["even", "coupled", "other law"])
def test_paths_are_numpys(given):
    (compiled, found), (plain, expected) = (numbers(kernels, **given)
                                            for kernels in ("auto", "off"))
    assert compiled.contact.kernels.compiled and not plain.contact.kernels.compiled
    assert len(found) == len(expected)
    for point, other in zip(found, expected):
        np.testing.assert_allclose(point.load, other.load, rtol=1e-8)
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-6, atol=1e-6)
    for name in ("nonlinear_iterations", "linear_iterations", "transforms"):
        mine, theirs = (branch.corrector.totals[name] if name != "transforms"
                        else branch.contact.grid.transforms for branch in (compiled, plain))
        assert mine == pytest.approx(theirs, rel=0.02)


def test_too_many_transforms_end_a_solve():
    form = form_of()
    snes = create_snes(form)
    form.grid.counter.limit = form.grid.transforms + 3.0
    with pytest.raises(RuntimeError, match="too many transforms"):
        solve(snes, form)


def test_what_python_raises_in_a_solve_is_raised(monkeypatch):
    form = form_of()
    snes = create_snes(form)

    def fail(*arguments):
        raise MemoryError("no room for a circle")

    vars(form.contact)["circle"] = fail
    with pytest.raises(MemoryError, match="no room"):
        solve(snes, form)


def test_kernels_are_left_out_where_they_are_not_wanted():
    form = form_of(kernels=chosen(False))
    assert form.kernel is None and callbacks.of(create_snes(form)) is None


@pytest.mark.parametrize("integer", [ctypes.c_int32, ctypes.c_int64])
def test_integers_of_either_width(monkeypatch, integer):
    """PETSc's may be built with 64 bits: what it writes in place of the library's own."""
    compiled, _ = callbacks.connected()
    pointers, whole = library.pointers(compiled), ctypes.POINTER(integer)

    @ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, whole)
    def iterations(ksp, count):
        count[0] = 40
        return 0

    @ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p))
    def get_ksp(snes, ksp):
        ksp[0] = 1
        return 0

    @ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, integer, ctypes.POINTER(ctypes.c_double),
                      ctypes.POINTER(ctypes.c_double), whole)
    def eigenvalues(ksp, room, real, imaginary, found):
        for place, value in enumerate((3.0, -0.5, 2.0, -7.0)):
            real[place] = value
        found[0] = 3 if room == 40 else 0
        return 0

    for name, function in (("iterations", iterations), ("get_ksp", get_ksp),
                           ("eigenvalues", eigenvalues)):
        monkeypatch.setattr(pointers, name, ctypes.cast(function, ctypes.c_void_p).value)
    form = form_of()
    own = callbacks.of(create_snes(form)).structure
    own.ksp, own.chooses, own.patience = 1, 1, 30
    own.form.contents.single = 1
    assert compiled.choose(ctypes.addressof(own), 0) == 0
    assert own.form.contents.single == 0 and own.turned == 1
    monitor = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int, ctypes.c_double,
                               ctypes.c_void_p)(("monitor_modes", compiled))
    for iteration in (0, 1):
        assert monitor(None, iteration, 1.0, ctypes.addressof(own)) == 0
    assert own.told == 1 and own.smallest[0] == -0.5
