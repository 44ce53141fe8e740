"""Pseudo-transient continuation: its equilibria and limits, the flow that it follows, and PETSc's
and its own options."""

import re

import numpy as np
import pytest
from petsc4py import PETSc
from scipy.integrate import solve_ivp

from contactsnes import Branch, Load, Steps
from contactsnes.contact import states
from contactsnes.contact.force_form import ForceForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.options.database import database, install
from contactsnes.options.fields import InputError
from contactsnes.scene.settings import Scene
from contactsnes.solvers.pseudotime import PseudoOptions, PseudoTransient
from contactsnes.solvers.snes import create_snes

SMALL = {"points": 256, "period": 20.0, "normal_maugis": 2.0, "height": np.inf}
OWN = {"snes_type": "python", "snes_python_type": "contactsnes.solvers.pseudotime.PseudoTransient"}
REASONS = PETSc.SNES.ConvergedReason
D, F = "displacement", "force"
SCENES = {"displacement": ([D], [3.0], {}), "force": ([F], [2.0], {}), "pulled": ([F], [-1.0], {}),
          "sheared": ([D, D], [3.0, 2.0], {"height": 30.0, "residual_friction": 0.5}),
          "forces": ([F, F], [2.0, 0.8], {"height": 30.0, "law": "mcgarry"}),
          "coupled": ([F, D], [2.0, 1.0], {"poisson": 0.3, "height": 30.0, "work_ratio": 0.5,
                                           "tangential_maugis": 3.0}),
          "sphere": ([F, D, D], [1.0, 0.5, 0.2], {"dimension": 2, "geometry": "sphere",
                                                  "points": (32, 32), "period": 8.0,
                                                  "height": 20.0}),}


@pytest.fixture(autouse=True)
def kept_options():
    """PETSc's options as they were."""
    before = database()
    yield
    install(before)


def problem(name):
    """A form on the whole cell and the unknown of the body without overlap."""
    controls, load, changes = SCENES[name]
    contact = Contact(Scene(**{**SMALL, **changes}))
    form = DisplacementForm(contact, contact.grid.whole, controls)
    form.set_load(load)
    start = states.undeformed(contact, controls, np.array(load))
    return form, form.pack(start.displacement, start.means[form.forced])


def solve(form, start, type_options=OWN, **values):
    """Solve by our SNES with PETSc's options set; the SNES and the unknown where it ended."""
    install({**type_options, **{name: str(value) for name, value in values.items()}})
    snes = create_snes(form)
    snes.setConvergenceHistory()
    unknown = PETSc.Vec().createWithArray(start.copy(), comm=PETSc.COMM_SELF)
    snes.solve(None, unknown)
    return snes, unknown.getArray().copy()


def residual(form, unknown):
    """The imbalance, evaluated anew."""
    return form.residual(unknown, np.empty(form.size))


@pytest.mark.parametrize("name", SCENES)
def test_it_ends_at_the_equilibrium_of_newtons_method(name):
    form, start = problem(name)
    snes, found = solve(form, start)
    newton, expected = solve(form, found + 1e-2 * (start - found), {})
    assert snes.reason == REASONS.CONVERGED_FNORM_ABS and newton.reason > 0
    assert np.linalg.norm(residual(form, found)) <= 1e-8
    assert np.linalg.norm(found - expected) < 1e-6
    # the sum over the force rows is that of the differences from the prescribed forces
    assert form.forces(found)[form.forced] == pytest.approx(form.load[form.forced], abs=1e-7)


@pytest.mark.parametrize("name", SCENES)
def test_the_limit_of_long_steps_is_newtons_method(name):
    form, near = problem(name)
    equilibrium = solve(form, near)[1]
    start = equilibrium + 0.05 * (near - equilibrium)
    exact = {"ksp_rtol": 1e-12, "ksp_atol": 1e-15}
    newton, expected = solve(form, start, {}, **exact)
    snes, found = solve(form, start, snes_pseudo_first_change=1e12, snes_pseudo_uphill=1e12,
                        **exact)
    assert snes.its == newton.its > 2 and np.linalg.norm(found - expected) < 1e-9
    histories = [np.log(solver.getConvergenceHistory()[0][:-1]) for solver in (snes, newton)]
    assert np.abs(histories[0] - histories[1]).max() < 0.1
    assert snes.getPythonContext().linear_iterations == pytest.approx(
        newton.getLinearSolveIterations(), abs=newton.its)


@pytest.mark.parametrize("name", ("displacement", "sheared"))
def test_the_limit_of_short_steps_is_the_flow(name):
    # v' = -F(v), by an integrator of high order; the implicit steps are of first order in their
    # length
    form, start = problem(name)
    time = 1.5
    flow = solve_ivp(lambda _, unknown: -residual(form, unknown), (0.0, time), start, rtol=1e-8,
                     atol=1e-10).y[:, -1]
    errors = []
    for steps in (20, 40, 80):
        first = time / steps * np.linalg.norm(residual(form, start))
        snes, found = solve(form, start, snes_max_it=steps, snes_pseudo_first_change=first,
                            snes_pseudo_growth=1, snes_pseudo_exponent=1e-9, ksp_rtol=1e-10,
                            snes_regularised_gap="false")
        assert (snes.reason == REASONS.DIVERGED_MAX_IT and snes.getPythonContext().time_step
                == pytest.approx(time / steps))
        errors.append(np.linalg.norm(found - flow) / np.linalg.norm(flow - start))
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 0.02 and np.all(np.abs(order - 1) < 0.2)


def test_prescribed_forces_are_approached_at_the_rate_one():
    # implicit Euler of e' = -e, up to the law's curvature, which a small change of the load hardly
    # meets
    form, start = problem("force")
    equilibrium = solve(form, start)[1]
    form.set_load([2.001])
    step, before = 0.5, residual(form, equilibrium)
    snes, found = solve(form, equilibrium, snes_max_it=1,
                        snes_pseudo_first_change=step * np.linalg.norm(before), ksp_rtol=1e-10)
    assert before[-1] < 0.0 and residual(form,
                                         found)[-1] / before[-1] == pytest.approx(1 / (1 + step),
                                                                                  rel=1e-2)
    # the mean displacement is such that the others follow the flow: v_1 - v_0 = -h F(v_1)
    moved, expected = (found - equilibrium)[:-1], -step * residual(form, found)[:-1]
    assert np.linalg.norm(moved - expected) < 1e-2 * np.linalg.norm(moved)


def test_time_steps_follow_the_residual():
    form, start = problem("displacement")
    snes, _ = solve(form, start, snes_max_it=1, snes_pseudo_first_change=2.0,
                    snes_pseudo_exponent=1.25, snes_pseudo_growth=1e6)
    first, second = snes.getConvergenceHistory()[0]
    assert snes.getPythonContext().time_step == pytest.approx(2.0 / first * (first / second)**1.25)
    snes, _ = solve(form, start, snes_max_it=1, snes_pseudo_first_change=2.0,
                    snes_pseudo_growth=1.01)
    assert snes.getPythonContext().time_step == pytest.approx(2.0 / first * 1.01)


def test_tolerances_and_limits_of_petsc_are_obeyed():
    form, start = problem("sheared")
    snes, found = solve(form, start, snes_atol=1e-3)
    history, linear = snes.getConvergenceHistory()
    assert snes.reason == REASONS.CONVERGED_FNORM_ABS and len(history) == snes.its + 1
    assert history[-1] == snes.norm == pytest.approx(np.linalg.norm(residual(form, found)),
                                                     rel=1e-9)
    assert history[-1] <= 1e-3 < history[:-1].min()
    assert linear[0] == 0 and linear.sum() == snes.getPythonContext().linear_iterations > 0
    snes, found = solve(form, start, snes_max_it=2)
    assert (snes.reason == REASONS.DIVERGED_MAX_IT and snes.its == 2
            and np.linalg.norm(found - start) > 0)
    snes, _ = solve(form, start, snes_rtol=1e-2, snes_atol=1e-20)
    assert snes.reason == REASONS.CONVERGED_FNORM_RELATIVE and snes.norm <= 1e-2 * history[0]
    snes, _ = solve(form, found, snes_stol=1e3, snes_max_it=1)
    assert snes.reason == REASONS.DIVERGED_MAX_IT
    equilibrium = solve(form, start)[1]
    snes, found = solve(form, equilibrium, snes_atol=1e-7)
    assert snes.reason > 0 and snes.its == 0 and np.array_equal(found, equilibrium)


@pytest.mark.parametrize("bad", (np.nan, np.inf))
def test_what_is_no_number_is_never_converged(bad):
    form, start = problem("displacement")
    start[3] = bad
    with np.errstate(invalid="ignore"):
        snes, _ = solve(form, start)
    assert snes.reason < 0 and snes.its == 0


@pytest.mark.parametrize("name, reason, values", (("displacement", REASONS.DIVERGED_LINE_SEARCH,
                                                   {"ksp_max_it": 1, "ksp_rtol": 1e-14,
                                                    "ksp_atol": 1e-30}),
                                                  ("pulled", REASONS.CONVERGED_FNORM_ABS,
                                                   {"snes_pseudo_first_change": 1}),
                                                  ("pulled", REASONS.DIVERGED_LINE_SEARCH,
                                                   {"snes_pseudo_first_change": 1000})))
def test_a_step_that_fails_is_taken_again_until_none_is_left(name, reason, values):
    form, start = problem(name)
    snes, found = solve(form, start, snes_regularised_gap="false", snes_pseudo_uphill=1.0001,
                        **values)
    norm, (history, linear) = np.linalg.norm(residual(form, found)), snes.getConvergenceHistory()
    assert snes.reason == reason and snes.norm == pytest.approx(norm, rel=1e-5)
    again = history[1:] == history[:-1]
    assert again.any() and np.all(history[1:] <= 1.0001 * history[:-1])
    # what was given up counts, too
    assert (linear.sum() == snes.getPythonContext().linear_iterations and np.all(linear[1:] > 0)
            and snes.its == len(again))


def test_no_equilibrium_is_never_converged():
    # more than the peak traction over the whole contact
    form, start = problem("pulled")
    form.set_load([-20.0])
    snes, found = solve(form, start, snes_max_it=300)
    assert snes.reason < 0 and np.linalg.norm(residual(form, found)) > 1e-2


def test_monitors_and_views(tmp_path):
    form, start = problem("displacement")
    snes, _ = solve(form, start, snes_monitor=f"ascii:{tmp_path}/monitor",
                    snes_view=f"ascii:{tmp_path}/view", snes_pseudo_exponent=1.25)
    lines = (tmp_path / "monitor").read_text().splitlines()
    norms = [float(line.split()[-1]) for line in lines]
    assert norms == pytest.approx(list(snes.getConvergenceHistory()[0]),
                                  rel=1e-10) and len(lines) == snes.its + 1
    text = (tmp_path / "view").read_text()
    assert all(f"{name} " in text for name in vars(PseudoOptions())) and "exponent 1.25" in text
    assert float(re.search(r"last time step ([\d.e+]+)",
                           text)[1]) == pytest.approx(snes.getPythonContext().time_step, rel=1e-5)


def test_options_are_read_under_the_prefix():
    install({"one_snes_pseudo_growth": "7", "snes_pseudo_growth": "5",
             "one_snes_regularised_gap": "false"})
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setOptionsPrefix("one_")
    snes.setType("python")
    snes.setPythonContext(PseudoTransient())
    snes.setFromOptions()
    context = snes.getPythonContext()
    assert context.options == PseudoOptions(growth=7.0) and not context.regularised.gap


def caught(action):
    """The InputError of an action; newer petsc4py keeps the error of a Python context as the cause
    of its own."""
    with pytest.raises(Exception) as found:
        action()
    error = found.value if isinstance(found.value, InputError) else found.value.__cause__
    assert error is None or isinstance(error, InputError)
    return str(error or found.value)


@pytest.mark.parametrize("name, value, allowed", (("first_change", "0", "above 0"),
                                                  ("growth", "0.5", "at least 1"),
                                                  ("exponent", "-1", "above 0"),
                                                  ("uphill", "1", "above 1"),
                                                  ("growth", "fast", "number")))
def test_bad_options_are_named(name, value, allowed):
    form, start = problem("displacement")
    text = caught(lambda: solve(form, start, **{f"snes_pseudo_{name}": value}))
    assert f"-snes_pseudo_{name}" in text and allowed in text


def test_the_force_form_is_refused():
    form, _ = problem("displacement")
    other = ForceForm(form.contact, [D])
    other.set_load([3.0])
    text = caught(lambda: solve(other, np.zeros(other.size)))
    assert "-contact_form displacement" in text and "PseudoTransient" in text


def test_a_differenced_jacobian_is_refused():
    form, start = problem("displacement")
    assert "-snes_mf" in caught(lambda: solve(form, start, snes_mf=""))


def test_a_path_is_that_of_newtons_method_and_its_iterations_are_counted():
    scene = Scene(**SMALL, residual_friction=0.5)
    numbers = []
    for type_options in ({}, {**OWN, "snes_max_it": "1000"}):
        install(type_options)
        branch = Branch(scene, Load(path="normal_force=1; tangential_displacement=2"),
                        Steps(initial_step=(0.25, 0.5)))
        numbers.append([branch.observe(point) for point in branch])
        assert all(row["nonlinear_iterations"] > 0
                   and row["linear_iterations"] >= row["nonlinear_iterations"]
                   and row["residual_norm"] <= 1e-8 for row in numbers[-1])
    newton, own = ([row for row in rows if row["tangential_displacement"] == 2][-1]
                   for rows in numbers)
    for name in ("normal_force", "tangential_force", "normal_displacement", "contact_area"):
        assert own[name] == pytest.approx(newton[name], abs=1e-6)
