"""Iterations of GMRES that are one call of the library: those of PETSc's operator and
preconditioner, by vectors in double precision."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.grid import patches  # noqa: E402
from contactsnes.kernels import krylov as compiled  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene  # noqa: E402
from contactsnes.solvers import krylov, patch_systems, two_grids  # noqa: E402

pytestmark = pytest.mark.skipif(library.reason() is not None, reason="no compiled kernels")
SPHERE = {"points": 96, "period": 12.0, "normal_maugis": 2.0, "dimension": 2,
          "geometry": "sphere"}
ROUGH = {"points": 64, "period": 8.0, "normal_maugis": 3.0, "geometry": "rough", "rough_on": "flat",
         "rough_slope": 1.0, "rough_longest": 8.0, "rough_shortest": 1.0}
LEGS = {"normal": ("normal_displacement=1.2", {}), "force": ("normal_force=3", {}),
        "sheared": ("tangential_displacement_x=0.7", {"tangential_maugis": 1.0, "poisson": 0.3}),
        "layer": ("normal_displacement=1.2", {"height": 3.0, "poisson": 0.2}),
        "two grids": ("normal_displacement=1.2", ROUGH)}
HELD = {"held": ("normal_force=-20", {**ROUGH, "normal_maugis": 2.0, "rough_slope": 0.5})}


@pytest.fixture(autouse=True)
def large(monkeypatch):
    """Whatever the size, vectors are ours, rounded where little is asked for, and of planes with
    many spots on two grids."""
    monkeypatch.setattr(two_grids, "LARGE", 1)
    monkeypatch.setattr(krylov, "LARGE", 1)
    monkeypatch.setattr(krylov, "WIDE", 1)


def solver(leg, symmetry="off", window="auto", **more):
    """(branch, form, KSP, linearised at the end of the path) of a sphere."""
    path, scene = {**LEGS, **HELD}[leg]
    branch = Branch(Scene(**{**SPHERE, **scene, **more}), Load("normal_displacement=1", path),
                    form=Form(linear_precision="single", symmetry=symmetry, window=window))
    list(branch)
    branch.corrector.snes.setUseEW(False)  # which would choose tolerances itself
    return branch, branch.corrector.form, branch.corrector.snes.getKSP()


def solved(form, ksp, right, tolerance):
    """(solution, norms on the way) of a right-hand side."""
    b = PETSc.Vec().createWithArray(right.copy(), comm=PETSc.COMM_SELF)
    x = PETSc.Vec().createWithArray(np.zeros_like(right), comm=PETSc.COMM_SELF)
    ksp.setTolerances(rtol=tolerance, atol=0.0, max_it=100)
    ksp.setConvergenceHistory()
    ksp.solve(b, x)
    krylov.release(ksp)
    return x.getArray().copy(), np.array(ksp.getConvergenceHistory())


@pytest.mark.parametrize("tolerance", [1e-3, 3e-5])
@pytest.mark.parametrize("symmetry", ["auto", "off"])
@pytest.mark.parametrize("leg", LEGS)
def test_they_are_those_of_vectors_in_double(monkeypatch, leg, symmetry, tolerance):
    """With rounded rows and rows in single precision, kept products of the preconditioner and
    without, means that forces hold and that a layer moves, of even planes and others; the residual
    is what it is said to be."""
    branch, form, ksp = solver(leg, symmetry)
    right = form.residual(np.zeros(form.size), np.empty(form.size))
    right *= 1.0 + 0.5 * np.sin(np.arange(form.size))
    called, whole = [], compiled.Iterations.__call__
    monkeypatch.setattr(compiled.Iterations, "__call__",
                        lambda own, *given: called.append(given) or whole(own, *given))
    found, norms = solved(form, ksp, right, tolerance)
    assert len(called) == ksp.getIterationNumber() == len(norms) - 1 > 2
    monkeypatch.setattr(compiled, "steps_alone", lambda system: False)
    expected, known = solved(form, ksp, right, tolerance)
    assert len(called) == len(norms) - 1 == len(known) - 1
    size = np.linalg.norm(right)
    np.testing.assert_allclose(norms, known, rtol=2e-3, atol=3e-6 * size)
    scale = np.abs(expected).max()
    # (numbers next to the middle of two short ones may be rounded to either)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=(0.1 * tolerance + 1e-5) * scale)
    left = np.linalg.norm(right - form.apply_jacobian(found, np.empty_like(found)))
    assert left <= 1.001 * max(tolerance * size, norms[-1]) + 3e-5 * size * (tolerance > 1e-4)
    assert abs(left - norms[-1]) <= (3e-5 if tolerance > 1e-4 else 1e-6) * size


@pytest.mark.parametrize("alone", [True, False], ids=["library", "petsc"])
@pytest.mark.parametrize("leg", ["two grids", *HELD])
def test_the_zone_takes_over_within_a_solve(monkeypatch, leg, alone):
    """Where patches tell of an unstable mode; what was made of vectors before is kept."""
    branch, form, ksp = solver(leg)
    spots = ksp.getPC().getPythonContext()
    told = []

    def tell(own, matrix):
        told.append(len(matrix))
        own.softest = -1.0 if len(told) == 4 else 1.0

    monkeypatch.setattr(patch_systems.Patches, "tell", tell)
    if not alone:
        monkeypatch.setattr(compiled, "steps_alone", lambda system: False)
    right = form.residual(np.zeros(form.size), np.empty(form.size))
    ksp.getOperators()[0].assemble()
    spots.begin()
    found, norms = solved(form, ksp, right, 1e-4)
    assert len(told) == 4 < len(norms) - 1 and spots.is_ours
    assert not any(spots.callbacks.zone.structure.grids)
    left = np.linalg.norm(right - form.apply_jacobian(found, np.empty_like(found)))
    assert left <= 1.5e-4 * np.linalg.norm(right)


@pytest.mark.parametrize("sizes", [{1: np.inf}, None])
def test_cores_in_patches_and_without(monkeypatch, sizes):
    if sizes:
        monkeypatch.setattr(patches, "PATCHES", sizes)
    branch, form, ksp = solver("normal")
    right = form.residual(np.zeros(form.size), np.empty(form.size))
    found, norms = solved(form, ksp, right, 1e-3)
    left = np.linalg.norm(right - form.apply_jacobian(found, np.empty_like(found)))
    assert left <= 1.01e-3 * np.linalg.norm(right) and len(norms) > 2


def test_those_of_another_preconditioner_are_petscs(monkeypatch, options):
    monkeypatch.setattr(compiled, "Iterations", None)
    options(pc_type="none")
    branch, form, ksp = solver("normal")
    right = form.residual(np.zeros(form.size), np.empty(form.size))
    assert len(solved(form, ksp, right, 1e-2)[1]) > 2


@pytest.mark.parametrize("behind", [0, 1])
def test_vectors_become_single_in_place(behind):
    """From their memory's begin on, and from its middle."""
    given = np.random.default_rng(3).normal(size=2500)
    vector = given.copy()
    half = vector.view(np.float32)[2500 * behind:][:2500]
    library.shared().narrowed(len(vector), vector.ctypes.data, half.ctypes.data)
    np.testing.assert_array_equal(half, given.astype(np.float32))
