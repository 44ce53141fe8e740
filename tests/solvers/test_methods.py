"""Every file of a method in options/: the equilibria that the default Newton's method finds, or the
failure that the file names."""

import multiprocessing
import os
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.branch.first_points import COLD, cold  # noqa: E402
from contactsnes.commands import session
from contactsnes.compare import methods
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.force_form import ForceForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.continuation.points import NoEquilibrium, NotConverged  # noqa: E402
from contactsnes.options import database as options
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402
from contactsnes.solvers.snes import create_snes  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "options").glob("*.opts"))
METHODS = [path for path in FILES if methods.is_method(path)]
FAILS, MAY_FAIL = "# Fails:", "# May fail:"
"""How the first comment of a file begins whose method fails on some of the solves below, or where
rounding decides."""

SCENE = {"points": 512, "period": 40.0, "normal_maugis": 3.0}
SHEARED = {**SCENE, "height": 20.0, "tangential_maugis": 3.0, "residual_friction": 0.5}
NORMAL, BOTH = ("displacement",), ("displacement", "displacement")
TRANSFORMS, SECONDS = 60000, 100
"""Limits for one solve, and for all of a method's."""

SAME = 1e-6
"""Distance of equal states, ranges of the law: a hundred times the tolerance of their residual
norms."""

UNKNOWN_TYPE = 86
"""PETSc's error for a type that it does not have."""


def solved(guess=None, load=(1.0,), scene=SCENE, tolerance="1e-12"):
    """Contact, guess, loads and Newton's solution of one task, all but to rounding."""
    contact, controls = Contact(Scene(**scene)), BOTH[:len(load)]
    guess = guess or states.undeformed(contact, controls, load)
    options.install({"snes_atol": tolerance})
    point = Corrector(contact, Form()).solve(guess, controls, np.array(load), COLD)
    return SimpleNamespace(contact=contact, controls=controls, load=np.array(load), guess=guess,
                           state=point.state)


@pytest.fixture(scope="module")
def tasks():
    """Name -> task: a cold start, from its solution a step further down, and one aside."""
    before = options.database()
    cold = solved()
    step = solved(cold.state, (1.5,))
    rest, steps = solved(scene=SHEARED), []
    for aside in range(1, 11):
        steps.append(solved(steps[-1].state if steps else rest.state, (1.0, float(aside)), SHEARED))
    sheared = steps[-1]
    sheared.guess = rest.state
    options.install(before)
    return {"cold start": cold, "normal step": step, "sheared step": sheared}


def solve(tasks, entries, connection):
    """In a process of its own, whose options no one else has: (task, what became of it) for each;
    then what was not used."""
    options.install({"contact_symmetry": "off", **entries})  # as a comparison does
    options.check_names(session.solver_options())
    options.check_values(session.solver_options())
    options.read(Steps)  # as a run does; what it says is not needed here
    for name, task in tasks.items():
        meter = task.contact.grid.counter
        meter.limit = TRANSFORMS
        try:
            with np.errstate(all="ignore"):
                point = Corrector(task.contact, options.read(Form)).solve(task.guess, task.controls,
                                                                          task.load, COLD)
            outcome = states.missed(task.contact, task.state, point.state)
        except (NotConverged, NoEquilibrium) as error:
            outcome = f"no solution: {error}"
        except Exception as error:  # whatever it is: the test tells of it
            missing = isinstance(error, PETSc.Error) and error.ierr == UNKNOWN_TYPE
            outcome = "missing" if missing else f"after {meter.transforms:.0f} transforms {error!r}"
        connection.send((name, outcome))
    connection.send(("unused", options.unused_options(session.solver_options())))
    connection.close()
    os._exit(0)  # nothing of the parent's is this process's to clean up


def outcomes(tasks, path):
    """What became of each task by a method, and the options that it did not use."""
    entries = methods.entries(options.read_file(path))
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=solve,
                                                          args=(tasks, entries, sender))
    process.start()
    sender.close()
    found = {}
    try:
        while "unused" not in found and receiver.poll(SECONDS):
            found.update([receiver.recv()])
    except EOFError:
        pass
    process.kill()
    process.join()
    return found


@pytest.mark.parametrize("path", METHODS, ids=lambda path: path.stem)
def test_method_finds_newtons_equilibria_or_says_why_not(tasks, path):
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert re.match(r"# \w", first), "the first line says what the method is"
    found = outcomes(tasks, path)
    if "missing" in found.values():
        pytest.skip(f"PETSc {'.'.join(map(str, PETSc.Sys.getVersion()))} lacks a type "
                    f"that {path.name} asks for")
    assert found.keys() == {*tasks, "unused"}, "the process crashed, or took too long"
    assert found.pop("unused") == []
    failed = [name for name, outcome in found.items() if str(outcome).startswith("no solution: ")]
    right = [name for name, outcome in found.items() if isinstance(outcome, float)
             and outcome < SAME]
    assert sorted(failed + right) == sorted(tasks), found
    assert first.startswith(MAY_FAIL) or bool(failed) == first.startswith(FAILS), found


@pytest.mark.parametrize("stem", ["newton-differences", "newton-unpreconditioned",
                                  "newton-lagged-preconditioner", "lbfgs-preconditioned",
                                  "composite-multiplicative"])
def test_method_follows_a_path(stem):
    """Along the tangent to begin with, for which continuation borrows the method's Jacobian and
    linear solver."""
    before = options.database()

    def path_by(entries):
        options.install(entries)
        branch = Branch(Scene(**SCENE), Load(start="normal_displacement=1",
                                             path="normal_displacement=1.2"),
                        Steps(initial_step=0.1, largest_step=0.1), options.read(Form))
        return branch.contact, list(branch)

    try:
        contact, found = path_by(methods.entries(options.read_file(ROOT / "options"
                                                                   / f"{stem}.opts")))
        _, wanted = path_by({})
    finally:
        options.install(before)
    assert [point.load[0] for point in found] == [point.load[0] for point in wanted]
    assert all(states.missed(contact, one.state, other.state) < SAME
               for one, other in zip(found, wanted))


@pytest.mark.parametrize("damping", ["1e3", "1e160", "1e300"])
@pytest.mark.parametrize("entries", [{"contact_form": "force", "snes_type": "nrichardson"},
                                     {"snes_type": "nrichardson"},
                                     {"snes_type": "qn", "snes_npc_side": "left",
                                      "npc_snes_type": "nrichardson", "npc_snes_max_it": "1"}])
def test_overflow_on_the_way_is_a_failed_solve(entries, damping):
    before = options.database()
    options.install({**entries, "snes_linesearch_type": "basic",
                     "snes_linesearch_damping": damping})
    try:
        with pytest.raises(NotConverged), np.errstate(all="ignore"):
            cold(Corrector(Contact(Scene(**SCENE)), options.read(Form)), NORMAL, np.ones(1))
    finally:
        options.install(before)


def test_scenes_are_no_methods():
    assert {path.stem for path in FILES} - {path.stem for path in METHODS} >= {"cylinder", "sphere"}


def test_the_page_names_every_file():
    text = (ROOT / "docs" / "methods.md").read_text(encoding="utf-8")
    assert [path.name for path in FILES if f"`{path.name}`" not in text] == []


# What solvers inside others are made of


@pytest.mark.parametrize("form", [DisplacementForm, ForceForm])
@pytest.mark.parametrize("entries", [{"snes_type": "ngmres", "npc_snes_type": "newtonls",
                                      "npc_snes_max_it": "3"},
                                     {"snes_type": "composite",
                                      "snes_composite_sneses": "newtonls,anderson",
                                      "sub_0_snes_max_it": "3", "sub_1_snes_max_it": "3"},
                                     {"snes_type": "composite",
                                      "snes_composite_sneses": "nrichardson,anderson",
                                      "sub_0_npc_snes_type": "newtonls",
                                      "sub_0_npc_snes_max_it": "3", "sub_0_snes_max_it": "3",
                                      "sub_1_snes_max_it": "3"}])
def test_inner_solvers_have_our_function_jacobian_and_preconditioner(form, entries):
    before = options.database()
    contact = Contact(Scene(points=64, period=20.0, normal_maugis=2.0))
    arguments = ((contact, contact.grid.whole, NORMAL) if form is DisplacementForm
                 else (contact, NORMAL))
    form = form(*arguments)
    form.set_load(np.ones(1))
    options.install(entries)
    try:
        snes = create_snes(form)
        assert options.unused_options() == []
    finally:
        options.install(before)
    parts = [snes.getCompositeSNES(place)
             for place in range(snes.getCompositeNumber())] if snes.getType() == "composite" else []
    inner = [*parts, *(solver.getNPC() for solver in (snes, *parts) if solver.hasNPC())]
    assert inner
    unknown, vector = np.zeros(form.size), np.random.default_rng(1).standard_normal(form.size)
    form.linearise(unknown)
    wanted = form.residual(unknown, np.empty(form.size)), form.apply_jacobian(vector,
                                                                              np.empty(form.size))
    for solver in inner:
        x, product, residual = (PETSc.Vec().createWithArray(array, comm=PETSc.COMM_SELF)
                                for array in (vector.copy(), np.zeros(form.size),
                                              np.zeros(form.size)))
        solver.getJacobian()[0].mult(x, product)
        assert np.array_equal(product.getArray(), wanted[1])
        x.set(0.0)
        solver.computeFunction(x, residual)
        assert np.array_equal(residual.getArray(), wanted[0])
        assert solver.getKSP().getPC().getType() in ("python", "shell")
        assert solver.getTolerances()[3] == 3


@pytest.mark.parametrize("name", ["npc_snes_maxit", "sub_1_ksp_rtoll", "npc_npc_pc_nonsense"])
def test_unused_options_of_inner_solvers_are_found(name):
    before = options.database()
    options.install({name: "1"})
    found = options.unused_options()
    options.install(before)
    assert found == ["-" + name]
