"""Newton's method under PETSc: defaults and the user's options, reasons, convergence, and how many
iterations it takes."""

import math
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.branch.first_points import start  # noqa: E402
from contactsnes.branch.memory import memory_of_solve  # noqa: E402
from contactsnes.branch.tracing import Tracer  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.force_form import ForceForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact  # noqa: E402
from contactsnes.continuation.points import Leg, NoEquilibrium, NotConverged  # noqa: E402
from contactsnes.options.database import database  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402
from contactsnes.solvers import callbacks  # noqa: E402
from contactsnes.solvers.preconditioners import ZonePC  # noqa: E402
from contactsnes.solvers.snes import create_snes  # noqa: E402

SMALL = {"points": 512, "period": 30.0, "normal_maugis": 3.0}
PAPER = {"points": 2 ** 13}


def corrector(form="displacement", window="auto", **scene):
    return Tracer(Contact(Scene(**{**SMALL, **scene})), Form(form=form, window=window))


def solved(approach=4.0, **settings):
    """The first point at an approach, and its corrector."""
    made = corrector(**settings)
    return made, made.solve(states.undeformed(made.contact, (DISPLACEMENT,), [approach]),
                            (DISPLACEMENT,), np.array([approach]), 200)


def snes_of(form="displacement", controls=(DISPLACEMENT,)):
    contact = Contact(Scene(**SMALL))
    problem = DisplacementForm(contact, contact.grid.whole,
                               controls) if form == "displacement" else ForceForm(contact, controls)
    problem.set_load(np.ones(len(controls)))
    return create_snes(problem)


def viewed(snes, folder):
    """What -snes_view prints."""
    viewer = PETSc.Viewer().createASCII(str(folder / "view"), "w", comm=PETSc.COMM_SELF)
    snes.view(viewer)
    viewer.destroy()
    return (folder / "view").read_text()


def branch(scene, start, path, steps=None, **form):
    return Branch(Scene(**scene), Load(start=start, path=path), Steps(**(steps or {})),
                  Form(**form))


# Defaults, and who overrides them


def test_defaults(tmp_path):
    snes = snes_of()
    assert snes.getType() == "newtonls" and snes.getTolerances()[:3] == (0.0, 1e-8, 0.0)
    assert snes.getUseEW() and snes.getParamsEW()["version"] == 2
    ksp = snes.getKSP()
    assert ksp.getType() == "fgmres" and ksp.getPC().getType() in ("python", "shell")
    assert 0.0 < ksp.getTolerances()[1] <= 0.5e-8
    assert "type: basic" in viewed(snes, tmp_path)


def test_a_solve_keeps_the_vectors_that_it_is_said_to_take(tmp_path):
    """FGMRES holds two for each iteration until it restarts: a direction, and what the
    preconditioner made of it. Solves take half of the iterations that there is room for."""
    restart = int(re.search(r"restart=(\d+)", viewed(snes_of(), tmp_path))[1])
    assert memory_of_solve(10 ** 6, 0, "fgmres") > 8 * 2 * (restart / 2) * 10 ** 6


def test_memory_is_that_of_the_method(options):
    default = memory_of_solve(10 ** 6, 10 ** 6)
    assert memory_of_solve(10 ** 6, 10 ** 6, "bcgs") < memory_of_solve(10 ** 6, 10 ** 6, "gmres")
    options(ksp_type="fgmres")
    assert (default < 0.8 * memory_of_solve(10 ** 6, 10 ** 6)
            == 0.8 * memory_of_solve(10 ** 6, 10 ** 6, "fgmres"))


@pytest.mark.parametrize("given, found", [
    ({"snes_type": "newtontr"}, ["type: newtontr"]),
    ({"snes_linesearch_type": "bt"}, ["type: newtonls", "type: bt"]),
    ({"snes_linesearch_type": "l2"}, ["type: newtonls", "type: l2"]),
    ({"snes_type": "newtonls", "snes_linesearch_type": "cp"}, ["type: cp"]),
    ({"snes_max_it": "7"}, ["maximum iterations=7"]),
    ({"snes_atol": "3e-6"}, ["absolute=3e-06"]),
    ({"snes_rtol": "1e-3"}, ["relative=0.001"]),
    ({"snes_stol": "1e-12"}, ["solution=1e-12"]),
    ({"ksp_type": "gmres"}, ["type: gmres"]),
    ({"ksp_type": "bcgs"}, ["type: bcgs"]),
    ({"ksp_gmres_restart": "11"}, ["restart=11"]),
    ({"ksp_max_it": "13"}, ["maximum iterations=13"]),
    ({"pc_type": "none"}, ["type: none"]),
])
def test_options_override_the_defaults(options, tmp_path, given, found):
    options(**given)
    text = viewed(snes_of(), tmp_path)
    for words in found:
        assert words in text, text


def test_options_do_not_leak():
    assert snes_of().getKSP().getType() == "fgmres" and snes_of().getTolerances()[1] == 1e-8
    assert not PETSc.Options().hasName("snes_linesearch_type")


def test_a_fixed_linear_tolerance_switches_the_forcing_off(options):
    options(ksp_rtol="1e-4")
    snes = snes_of()
    assert not snes.getUseEW() and snes.getKSP().getTolerances()[0] == 1e-4


def test_a_linear_tolerance_and_the_forcing_may_be_asked_for_together(options):
    options(ksp_rtol="1e-4", snes_ksp_ew=None, snes_ksp_ew_rtol0="0.05")
    snes = snes_of()
    assert snes.getUseEW() and snes.getParamsEW()["rtol_0"] == 0.05


def test_the_forcing_can_be_switched_off_alone(options):
    options(snes_ksp_ew="false")
    snes = snes_of()
    assert not snes.getUseEW() and snes.getKSP().getTolerances()[0] == 1e-5


def test_a_first_system_that_is_solved_further_saves_iterations(options):
    """As far as two iterations need, on a rough plane, against a fixed tolerance."""
    scene = Scene(dimension=2, points=128, period=12.0, height=math.inf, normal_maugis=2.0,
                  geometry="rough", rough_on="flat", rough_hurst=0.8, rough_longest=3.0,
                  rough_shortest=0.75, rough_slope=6.0, rough_seed=1)
    found = []
    for given in ({}, {"snes_ksp_ew_rtol0": "0.1"}):
        options(**given)
        points = list(Branch(scene, Load(start="normal_displacement=1",
                                         path="normal_displacement=2"), Steps(largest_step=0.1)))
        found.append((points[-1].forces[0], *(sum(point.spent[name] for point in points[1:])
                                              for name in ("nonlinear_iterations",
                                                           "linear_iterations"))))
    (force, newton, krylov), (same, more, others) = found
    assert force == pytest.approx(same, rel=1e-6)
    assert newton < 0.9 * more and krylov < others


def test_the_absolute_linear_tolerance_follows_that_of_the_outer_iteration(options):
    options(snes_atol="1e-4")
    assert 1e-6 < snes_of().getKSP().getTolerances()[1] <= 0.5e-4
    options(ksp_atol="1e-12")
    assert snes_of().getKSP().getTolerances()[1] == 1e-12


@pytest.mark.parametrize("given", [{"snes_type": "newtontr", "snes_max_it": "60"},
                                   {"snes_linesearch_type": "bt", "snes_max_it": "60"},
                                   {"snes_linesearch_type": "l2", "snes_max_it": "60"},
                                   {"ksp_type": "gmres"}, {"ksp_type": "bcgs"}, {"pc_type": "none"},
                                   {"ksp_rtol": "1e-6"}, {"snes_regularised_gap": "false"},
                                   {"pc_core_pad": "2", "pc_core_width": "0.1",
                                    "pc_core_threshold": "0.3"}],
                         ids=lambda given: " ".join(f"{name}={value}"
                                                    for name, value in given.items()))
def test_every_method_comes_to_the_same_point(options, given):
    """A short step from a converged point: an easy case for any of them."""
    made, first = solved(approach=1.0)
    expected = made.solve(first.state, first.controls, np.array([1.05]))
    options(**given)
    other = corrector()
    point = other.solve(first.state, first.controls, np.array([1.05]))
    assert point.residual_norm <= 1e-8
    assert states.distance(made.contact, point.state, expected.state) < 1e-6
    assert point.forces[0] == pytest.approx(expected.forces[0], abs=1e-6)


# What is printed tells the truth


def test_view_tells_of_operator_and_preconditioner(options, tmp_path):
    file = tmp_path / "view"
    options(snes_view=f"ascii:{file}", pc_core_pad="1.75", pc_core_width="0.45",
            pc_core_threshold="0.2")
    made, point = solved()
    text = file.read_text()
    assert "contact Jacobian, displacement form: 1 component(s)" in text
    assert f"{made.form.nodes} nodes, 0 scalar unknown(s)" in text
    for words in ("threshold 0.2", "width 0.45", "pad 1.75", "CoreZone"):
        assert words in text, text


def test_view_counts_components_and_scalars(tmp_path):
    text = viewed(snes_of(controls=(FORCE, FORCE)), tmp_path)
    assert "2 component(s)" in text and "2 scalar unknown(s)" in text
    text = viewed(snes_of("force", (FORCE, DISPLACEMENT)), tmp_path)
    assert "force form" in text and "0 scalar unknown(s)" in text


def test_options_of_the_preconditioner_reach_it(options):
    options(pc_core_threshold="0.25", pc_core_pad="1.5")
    made, _ = solved()
    pc = made.snes.getKSP().getPC()
    chosen = (callbacks.of(pc).zone if pc.getType() == "shell" else pc.getPythonContext()).options
    assert (chosen.threshold, chosen.pad, chosen.width) == (0.25, 1.5, 0.3)


# Reasons


def test_reasons_of_a_failure_are_named(options):
    options(snes_max_it="1")
    with pytest.raises(NotConverged,
                       match=r"SNES DIVERGED_MAX_IT after 1 iterations.*KSP CONVERGED"):
        solved()


def test_failures_tell_the_norm_that_was_tested(options):
    """In the force form F is an imbalance of forces, whose norm is compared with no tolerance."""
    options(snes_max_it="1")
    made = corrector("force")
    guess = states.undeformed(made.contact, (DISPLACEMENT,), [4.0])
    with pytest.raises(NotConverged) as failure:
        made.solve(guess, (DISPLACEMENT,), np.array([4.0]), 200)
    told = float(re.search(r"residual (\S+),", str(failure.value))[1])
    assert told == pytest.approx(made.form.last_norm, rel=0.01)
    assert told != pytest.approx(made.snes.getFunctionNorm(), rel=0.1)


def test_reasons_of_the_linear_solver_are_named(options):
    options(ksp_max_it="1", ksp_rtol="1e-10")
    with pytest.raises(NotConverged,
                       match=r"SNES DIVERGED_LINEAR_SOLVE.*KSP DIVERGED_(ITS|MAX_IT)"):
        solved()


@pytest.mark.parametrize("form", ["displacement", "force"])
def test_a_point_is_converged_by_its_residual_alone(options, form):
    """A relative tolerance may stop the solver early; what it returns is no point then."""
    options(snes_rtol="1e-2")
    with pytest.raises(NotConverged, match="residual_norm"):
        solved(form=form)
    options(snes_atol="1e-1")
    assert solved(form=form)[1].residual_norm <= 1e-1


@pytest.mark.parametrize("form", ["displacement", "force"])
def test_a_point_knows_its_residual(form):
    """residual_norm is the root mean square imbalance of displacements, evaluated anew."""
    made, point = solved(form=form)
    window = states.fitted(made.contact, point.state).window
    problem = DisplacementForm(made.contact, window, point.controls)
    problem.set_load(point.load)
    imbalance = problem.residual(problem.pack(states.onto(point.state, window), ()),
                                 np.empty(problem.size))
    assert point.residual_norm <= 1e-8
    assert point.residual_norm == pytest.approx(np.linalg.norm(imbalance), rel=1e-3, abs=1e-13)


def test_a_failed_solve_leaves_the_corrector_as_it_was():
    made, first = solved()
    again = made.solve(first.state, first.controls, np.array([4.1]))
    with pytest.raises(NotConverged):
        made.solve(first.state, first.controls, np.array([60.0]), 2)
    after = made.solve(first.state, first.controls, np.array([4.1]))
    np.testing.assert_allclose(after.state.displacement, again.state.displacement, atol=1e-7)
    np.testing.assert_array_equal(first.state.displacement, solved()[1].state.displacement)


def test_what_was_spent_is_counted_once():
    made, point = solved()
    spent = made.account()
    assert spent["nonlinear_iterations"] == point.spent["last_iterations"] > 0
    assert spent["jacobian_products"] >= spent["linear_iterations"] >= spent["nonlinear_iterations"]
    assert (spent["function_evaluations"] >= spent["nonlinear_iterations"] + 1
            and spent["transforms"] > 0)
    assert {name: value for name, value in made.account().items()
            if name != "wall_time"} == dict.fromkeys(("nonlinear_iterations", "linear_iterations",
                                                      "function_evaluations", "jacobian_products",
                                                      "transforms", "transforms_single"), 0)


# The two forms


@pytest.mark.parametrize("controls, load", [((DISPLACEMENT,), [4.0]), ((FORCE,), [6.0]),
                                            ((DISPLACEMENT, DISPLACEMENT), [4.0, 5.0]),
                                            ((FORCE, FORCE), [6.0, 1.0])],
                         ids=["d", "f", "dd", "ff"])
def test_both_forms_come_to_the_same_point(controls, load):
    points = []
    for form in ("displacement", "force"):
        made = corrector(form=form)
        start = states.undeformed(made.contact, (DISPLACEMENT,), [4.0])
        first = made.solve(start, (DISPLACEMENT,), np.array([4.0]), 200)
        sheared = replace(states.with_components(first.state, len(controls)))
        points.append(made.solve(sheared, controls, np.array(load), 200))
    first, second = points
    assert states.distance(Contact(Scene(**SMALL)), second.state, first.state) < 1e-6
    np.testing.assert_allclose(second.forces, first.forces, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(second.displacements, first.displacements, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(second.state.means, first.state.means, rtol=1e-6, atol=1e-6)


def test_the_window_changes_nothing():
    narrow, wide = solved()[1], solved(window="off")[1]
    assert narrow.state.window.size < wide.state.window.size == SMALL["points"]
    assert states.distance(Contact(Scene(**SMALL)), wide.state, narrow.state) < 1e-7
    np.testing.assert_allclose(narrow.forces, wide.forces, rtol=1e-8)
    np.testing.assert_allclose(narrow.state.means, wide.state.means, rtol=1e-8)


def test_the_window_grows_on_demand():
    """From a state on a window far too small."""
    made, point = solved()
    grid = made.contact.grid
    small = states.State(type(grid.whole)(grid, (grid.size // 2 - 12,), (24,)), np.zeros((1, 24)),
                         np.zeros(1))
    small = states.State(small.window, states.onto(point.state, small.window), point.state.means)
    found = made.solve(small, point.controls, point.load, 200)
    assert states.covers(made.contact, found.state)
    assert states.distance(made.contact, point.state, found.state) < 1e-6


def test_a_method_whose_ritz_values_petsc_cannot_tell_is_not_asked_for_them(options):
    """PETSc's flexible CG, whose numbers it takes for those of CG."""
    made, first = solved(approach=1.0)
    options(ksp_type="fcg")
    other = corrector()
    try:
        other.solve(first.state, first.controls, np.array([1.05]))
    except NotConverged:
        pass  # (the preconditioner is not symmetric)
    assert np.isnan(other.form.ritz.smallest) and not np.isnan(made.form.ritz.smallest)


def test_the_window_grows_with_what_a_solve_finds():
    """The contact spreads beyond the window that its guess asks for."""
    made, point = solved(0.0)
    found = made.solve(point.state, point.controls, np.array([9.0]), 200)
    assert found.state.window.size > point.state.window.size and states.covers(made.contact,
                                                                               found.state)
    np.testing.assert_allclose(found.forces, solved(9.0)[1].forces, rtol=1e-7)


def two_spots(folder):
    """Parabolas at -15 and 15, the second lower by 14 u_n,r: it comes into contact late, by a
    jump."""
    x = (np.arange(1024) - 512) * 60.0 / 1024
    np.save(folder / "heights.npy", np.maximum(-(x + 15) ** 2 / 2, -(x - 15) ** 2 / 2 - 14.0))
    return {"points": 1024, "period": 60.0, "normal_maugis": 3.0, "geometry": "file",
            "geometry_file": str(folder / "heights.npy")}


def test_a_second_spot_is_taken_into_the_window(tmp_path):
    points = list(branch(two_spots(tmp_path), "normal_displacement=0", "normal_displacement=6",
                         {"predictor": "tangent"}))
    assert points[-1].load[0] == 6.0 and all(not point.event for point in points)
    assert points[0].state.window.size < 300 < points[-1].state.window.size


@pytest.mark.parametrize("predictor", ["secant", "tangent", "edge"])
def test_a_small_spot_does_not_jump_unnoticed(tmp_path, predictor):
    """The second spot jumps into contact near 9.52: a fold of the whole, though most of the contact
    hardly moves."""
    points = list(branch(two_spots(tmp_path), "normal_displacement=0", "normal_displacement=12",
                         {"predictor": predictor, "initial_step": 0.75, "largest_step": 1.5}))
    assert [point.event for point in points if point.event] == ["fold", "jump"]
    fold = next(point for point in points if point.event == "fold")
    assert fold.load[0] == pytest.approx(9.5197, rel=1e-3)


# Robust starts


def test_a_deep_cold_start_converges():
    """The paper's cylinder at an approach of 40, from the start without overlap."""
    made = corrector(**{**PAPER, "period": 100.0, "normal_maugis": 10.0})
    point = made.solve(states.undeformed(made.contact, (DISPLACEMENT,), [40.0]), (DISPLACEMENT,),
                       np.array([40.0]), 200)
    assert point.residual_norm <= 1e-8 and made.account()["transforms"] < 700


@pytest.mark.parametrize("approach", [2.0, 12.0, 200.0])
def test_a_guess_with_heavy_overlap_does_not_overflow(approach):
    """u = -D everywhere: gaps down to -600 ranges at the apex. It may fail, with a reason, but not
    by a number too large."""
    made, expected = solved(approach=min(approach, 12.0))
    flat = np.full((1, SMALL["points"]), -approach * SMALL["normal_maugis"])
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        try:
            point = made.solve(states.State(made.contact.grid.whole, flat, flat[0, :1]),
                               expected.controls, expected.load, 200)
        except NotConverged:
            assert approach > 10.0
            return
    assert states.distance(made.contact, expected.state, point.state) < 1e-6


def law_and_body(contact, point):
    """Eigenvalues of the tangent stiffness, law and body, at a point under a given mean
    displacement, ranges of the law."""
    count = contact.grid.size
    wave = contact.body.stiffness(contact.grid.wavevectors(), 1)[0, 0] / contact.ranges[0] ** 2
    body = np.fft.irfft(wave[:, None] * np.fft.rfft(np.eye(count), axis=0), n=count, axis=0)
    gap = contact.extended(point.state)[0] + contact.initial_gap
    held = np.eye(count) - 1.0 / count
    return np.sort(
        np.linalg.eigvalsh(
            held @ (body + np.diag(contact.law.tangent(gap.reshape(1, -1))[0, 0])) @ held
        )
    )[1:]


@pytest.mark.parametrize("points, period, maugis", [(128, 30.0, 12.0), (256, 60.0, 12.0)])
def test_starts_on_a_grid_that_pins_are_stable(points, period, maugis):
    """Newton's own solutions, if it finds any, have a node halfway between in and out of contact at
    about every other load, where an eigenvalue is negative: at which ones hangs on rounding."""
    for approach in np.linspace(0.0, 3.0, 10):
        made = corrector(points=points, period=period, normal_maugis=maugis)
        load = np.array([approach])
        assert law_and_body(made.contact, start(made, (DISPLACEMENT,), load))[0] > 1e-4


@pytest.mark.parametrize("given", [{"snes_max_it": "many"},
                                   {"snes_type": "fas", "fas_levels_snes_max_it": "many"}])
def test_a_solver_that_cannot_be_set_up_leaves_the_options_as_they_were(given, options,
                                                                        kept_options):
    """Defaults stand in the database while PETSc reads it only, however that ends."""
    made = corrector(points=1024)
    state = states.undeformed(made.contact, (DISPLACEMENT,), np.array([3.0]))
    form = DisplacementForm(made.contact, state.window, (DISPLACEMENT,))
    options(**given)
    before = database()
    with pytest.raises(PETSc.Error):
        create_snes(form)
    assert database() == before and not any("linesearch" in name for name in before)


def test_a_body_far_apart_is_at_rest_at_once():
    """Motion from a balance of 1e-18 ends there: its tolerance is a part of the first imbalance,
    but none below the solver's."""
    made, load = corrector(), np.array([-14.0])
    point = made.settle(states.undeformed(made.contact, (DISPLACEMENT,), load), (DISPLACEMENT,),
                        load, "far apart")
    assert point.residual_norm <= 1e-8 and made.contact.grid.transforms < 100


def test_a_soft_law_under_control_of_the_force_comes_back_to_the_flat():
    """Pulled at a distance and then let go, the body drifts off along an unstable branch whose
    force vanishes far away."""
    scene = {"points": 1024, "period": 30.0, "normal_maugis": 0.3, "height": math.inf}
    points = list(branch(scene, "normal_displacement=-6", "normal_force=2"))
    assert points[-1].in_contact and points[-1].forces[0] == 2.0 and min(point.displacements[0]
                                                                         for point in points) > -1e3


def test_a_start_that_is_no_number_is_named():
    made, point = solved()
    spoiled = point.state.displacement.copy()
    spoiled[0, 3] = np.nan
    with pytest.raises(NotConverged, match="NaN"):
        made.solve(states.State(point.state.window, spoiled, point.state.means), point.controls,
                   point.load)


def test_failures_on_a_grid_that_pins_name_it():
    """Without iterations nothing is found anywhere: the reason is the solver's, and what the grid
    does comes with it."""
    coarse = branch({**SMALL, "points": 64, "normal_maugis": 9.0}, "normal_displacement=1",
                    "normal_displacement=2")
    coarse.corrector.settle = coarse.corrector.solve = failing
    with pytest.raises(NotConverged, match="made up; the grid is too coarse, .* "
                       "the grid of 64 points does not resolve"):
        list(coarse)
    fine = branch(SMALL, "normal_displacement=1", "normal_displacement=2")
    fine.corrector.settle = fine.corrector.solve = failing
    with pytest.raises(NotConverged, match="made up; a failure of the solver: try"):
        list(fine)


def failing(*_):
    raise NotConverged("made up")


def test_a_force_beyond_friction_ends_the_path_at_once():
    """Under a residual friction of 1 the whole contact slips at the fold's own load: no motion
    there settles or leaves."""
    scene = {"points": 1024, "period": 30.0, "normal_maugis": 2.0, "tangential_maugis": 1.5,
             "poisson": 0.2, "height": 50.0}
    sheared, points = branch(scene, "normal_displacement=5", "tangential_force=20"), []
    with pytest.raises(NoEquilibrium, match="beyond the fold .sliding."):
        for point in sheared:
            points.append(point)
    assert points[-1].event in ("fold", "gross_sliding") and sheared.contact.grid.transforms < 10000


@pytest.mark.parametrize("path", ["normal_displacement=1", "normal_force=-5"])
def test_a_script_that_holds_its_branch_ends_well(path, tmp_path):
    """Objects of PETSc whose methods are Python's outlive the interpreter in a script's own
    variables, or an exception's frames."""
    script = tmp_path / "script.py"
    script.write_text(f"""import sys
sys.path.insert(0, {str(Path(__file__).resolve().parents[2])!r})
import petsc4py
petsc4py.init(sys.argv)
from contactsnes import Branch, Load, Scene
scene = Scene(points=256, period=30, normal_maugis=2.0)
branch = Branch(scene, Load(start="normal_displacement=1", path="{path}"))
failure = None
try:
    points = list(branch)
except RuntimeError as error:
    failure = error
print(type(failure).__name__)
""")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.split() == ["NoEquilibrium" if "force" in path
                                                            else "NoneType"]


def test_a_force_controlled_start_is_found():
    points = list(branch(SMALL, "normal_force=2", "normal_force=3"))
    assert points[0].load[0] == points[0].forces[0] == 2.0 and points[-1].forces[0] == 3.0
    assert all(point.in_contact for point in points)


def test_a_leg_to_where_it_is_has_one_point():
    points = list(branch(SMALL, "normal_displacement=4", "normal_displacement=4"))
    assert len(points) == 1 and points[0].leg == 0


def test_gaps_beyond_the_laws_continuation_are_an_error():
    """A rigid flat pressed with a pressure above 30 e^30 has no point, but a sentence."""
    contact = Contact(Scene(points=64, period=20.0, normal_maugis=3.0, geometry="flat"))
    made = Corrector(contact, Form())
    deep = states.State(contact.grid.whole, np.full((1, 64), -35.0), np.array([-35.0]))
    with pytest.raises(NotConverged, match="gap of -35 delta_n .* only a continuation"):
        made.solve(deep, (DISPLACEMENT,), np.array([35.0 / 3.0]), 50)


# Iterations


def test_iterations_do_not_depend_on_the_grid():
    """Krylov iterations a Newton step and in all, from 2^12 to 2^14 points; warm steps take few of
    either."""
    totals = []
    for points in (2 ** 12, 2 ** 13, 2 ** 14):
        scene = {"points": points, "period": 60.0, "normal_maugis": 6.0}
        walk = list(branch(scene, "normal_displacement=10", "normal_displacement=11",
                           {"initial_step": 0.2, "largest_step": 0.2}))
        spent = [point.spent for point in walk[1:]]
        newton, krylov = (np.array([s[name] for s in spent])
                          for name in ("nonlinear_iterations", "linear_iterations"))
        assert np.median(newton) <= 8 and np.median(krylov / newton) <= 12
        totals.append(krylov.sum())
    assert max(totals) <= 1.3 * min(totals)


def test_normal_steps_are_cheap():
    """The paper's cylinder from 35.8 to 37 by 0.25."""
    walk = list(branch(PAPER, "normal_displacement=35.8", "normal_displacement=37",
                       {"initial_step": 0.25, "largest_step": 0.25}))
    assert np.median([point.spent["transforms"] for point in walk[1:]]) <= 30


def test_sheared_steps_are_cheap():
    """The same, sheared by 20 a step."""
    walk = list(branch(PAPER, "normal_displacement=35.787", "tangential_displacement=200",
                       {"initial_step": 20, "largest_step": 20}))
    assert walk[-1].load[1] == 200.0
    assert np.median([point.spent["transforms"] for point in walk[1:]]) <= 100


# Predictor


@pytest.mark.parametrize("controls, load, rate", [((DISPLACEMENT,), [4.0], [1.0]),
                                                  ((FORCE,), [6.0], [3.0]),
                                                  ((DISPLACEMENT, DISPLACEMENT), [4.0, 3.0],
                                                   [0.3, 2.0]), ((FORCE, DISPLACEMENT), [6.0, 3.0],
                                                                 [0.5, 2.0])],
                         ids=["d", "f", "dd", "fd"])
@pytest.mark.parametrize("form", ["displacement", "force"])
def test_the_tangent_is_a_tangent(options, form, controls, load, rate):
    """Its error is of second order in the step, but for that of its linear solve: small, and larger
    in the force form."""
    options(snes_atol="1e-10")
    made = corrector(form=form)
    first = made.solve(states.undeformed(made.contact, (DISPLACEMENT,), [4.0]), (DISPLACEMENT,),
                       np.array([4.0]), 200)
    load, rate = np.array(load), np.array(rate)
    point = made.solve(states.with_components(first.state, len(controls)), controls, load, 200)
    leg = Leg(1, controls, load, load + rate, 0, 0.1, 0.1, 1e-6)
    wrong = []
    for step in (0.2, 0.1):
        exact = made.solve(point.state, controls, load + step * rate, 200)
        predicted = made.along_tangent(point, leg, 0.0, step)
        wrong.append(states.distance(made.contact, predicted, exact.state))
        moved = states.distance(made.contact, point.state, exact.state)
        assert predicted.means == pytest.approx(exact.state.means, abs=step)
    assert wrong[0] / wrong[1] > 3.2 or (form == "force" and wrong[1] < 0.05 * moved)


@pytest.mark.parametrize("differences", ["snes_mf", "snes_mf_operator"])
def test_the_tangent_is_that_of_the_exact_jacobian_where_products_are_differences(options,
                                                                                  differences):
    """These are of what the SNES has in its vectors, which the linear solve for a tangent fills."""
    _, first = solved(4.0)
    leg = Leg(1, (DISPLACEMENT,), np.array([4.0]), np.array([5.0]), 0, 0.1, 0.1, 1e-6)
    exact = corrector().along_tangent(first, leg, 0.0, 0.1).displacement - first.state.displacement
    options(**{differences: "", "pc_type": "none", "snes_atol": "1e-6"})
    made = corrector()
    made.solve(first.state, (DISPLACEMENT,), np.array([4.1]), 200)
    moved = made.along_tangent(first, leg, 0.0, 0.1).displacement - first.state.displacement
    assert np.linalg.norm(moved - exact) < 0.01 * np.linalg.norm(exact)


@pytest.mark.parametrize("kernels", ["auto", "off"])
def test_differences_alone_leave_no_preconditioner_whoever_has_made_it(options, kernels):
    """Without kernels, or on several processes, PETSc took it away without a word."""
    options(snes_mf="")
    branch = Branch(Scene(points=64, period=15.0, normal_maugis=1.0),
                    Load(path="normal_displacement=1"), form=Form(kernels=kernels))
    with pytest.raises(InputError, match="-snes_mf leaves no Jacobian"):
        next(iter(branch))


def test_a_matrix_that_is_no_jacobian_is_told_by_its_type():
    """Parts of one, as -snes_type vinewtonrsls takes, were said to come of -snes_mf."""
    matrix = PETSc.Mat().createDense(2, comm=PETSc.COMM_SELF)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(matrix)
    with pytest.raises(InputError, match=f"matrix of type {matrix.getType()}.*-pc_type none"):
        ZonePC().setUp(pc)


@pytest.mark.parametrize("law", ("modified", "xu_needleman"))
def test_the_tangent_of_a_thick_layer_is_that_of_its_contact(law):
    """A layer that gives way by a thousand times what its contact does leaves little of the right
    side, and all of the direction is in that."""
    scene = Scene(points=128, period=15.0, geometry="rough", rough_on="flat", rough_slope=1.5,
                  rough_shortest=1.0, normal_maugis=0.6, tangential_maugis=2.0, law=law)
    branch = Branch(scene, Load(start="normal_displacement=1", path="tangential_displacement=0.4"),
                    Steps(initial_step=0.2, largest_step=0.2))
    _, first, last = branch
    leg = Leg(1, last.controls, np.array([1.0, 0.0]), np.array([1.0, 0.4]), 1, 0.5, 0.5, 1e-6)
    ahead = branch.corrector.along_tangent(first, leg, first.position, 0.5)
    moved = last.state.displacement - first.state.displacement
    assert np.linalg.norm(moved) < 1e-3 * last.load[1]
    assert (np.linalg.norm(ahead.displacement - last.state.displacement)
            < 0.02 * np.linalg.norm(moved))


@pytest.mark.parametrize("controls, rate", [((DISPLACEMENT,), [1.0]),
                                            ((DISPLACEMENT, DISPLACEMENT), [-1.0, 0.0]),
                                            ((FORCE, DISPLACEMENT), [0.5, 2.0])],
                         ids=["d", "dd", "fd"])
def test_the_tangent_does_not_depend_on_what_was_solved_before(controls, rate):
    """That of a new corrector is that of one that has just solved, and both are accurate: a resumed
    path is the same."""
    made, first = solved(4.0)
    load = np.array([4.0 if controls[0] == DISPLACEMENT else first.forces[0], 3.0][:len(controls)])
    point = made.solve(states.with_components(first.state, len(controls)), controls, load, 200)
    leg = Leg(1, controls, load, load + np.array(rate), 0, 0.1, 0.1, 1e-6)
    near = [made.solve(point.state, controls, leg.load(step), 200).state.displacement
            for step in (1e-3, -1e-3)]
    exact = 0.01 * (near[0] - near[1]) / 2e-3
    moves = [any_one.along_tangent(point, leg, 0.0, 0.01).displacement - point.state.displacement
             for any_one in (made, corrector())]
    np.testing.assert_allclose(moves[1], moves[0], atol=1e-9)
    assert np.linalg.norm(moves[1] - exact) < 0.03 * np.linalg.norm(exact)
