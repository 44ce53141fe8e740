"""The full approximation scheme: coarse contacts, transfers between grids, and the equilibria of
Newton's method."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.branch.first_points import start  # noqa: E402
from contactsnes.commands.session import solver_options  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.force_form import ForceForm  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact  # noqa: E402
from contactsnes.continuation.points import NotConverged  # noqa: E402
from contactsnes.grid.cell import transform_cost  # noqa: E402
from contactsnes.grid.windows import Window  # noqa: E402
from contactsnes.interface.laws.coupled import Coupled  # noqa: E402
from contactsnes.options.database import read_file, unused_options  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.resolution import resolution  # noqa: E402
from contactsnes.scene.settings import Form, Scene  # noqa: E402
from contactsnes.solvers.multigrid import CoarseForm, Transfer  # noqa: E402
from contactsnes.solvers.snes import create_snes  # noqa: E402

SMALL = {"points": 512, "period": 30.0, "normal_maugis": 3.0}
SPHERE = {"dimension": 2, "points": 64, "period": 12.0, "geometry": "sphere", "normal_maugis": 2.0}
FOLDER = Path(__file__).resolve().parents[2] / "options"
FILES = ("fas.opts", "fas-richardson.opts")


def from_file(name):
    """Options of a method's file, those of PETSc's objects."""
    words = read_file(FOLDER / name)
    pairs = dict(zip((word.lstrip("-") for word in words[::2]), words[1::2]))
    return {name: value for name, value in pairs.items() if not name.startswith("contact_")}


def corrector(window="auto", log=lambda sentence: None, **scene):
    return Corrector(Contact(Scene(**{**SMALL, **scene})), Form(window=window), log)


def solved(made, controls, load):
    """The first point at a load."""
    return start(made, controls, np.array(load))


def pair(window=None, controls=(DISPLACEMENT,), softness=1.25, **scene):
    """A form, one on a coarser grid, and the transfer between them."""
    contact = Contact(Scene(**{**SMALL, **scene}))
    fine = DisplacementForm(contact, contact.grid.whole if window is None
                            else Window(contact.grid, *window), controls)
    fine.set_load(np.ones(len(controls)))
    coarse = CoarseForm(fine, softness)
    coarse.set_load(fine.load)
    return fine, coarse, Transfer(fine, coarse)


def applied(function, size, *given):
    """What a function that fills an array fills it with."""
    out = np.full(size, np.nan)
    function(*given, out)
    return out


def newton(form, unknown, right=None):
    """Newton's solution of F = right from an unknown, changed in place."""
    snes = create_snes(form, "reference_")
    snes.setTolerances(atol=1e-11)
    snes.getKSP().setTolerances(atol=1e-14)
    snes.solve(None if right is None else PETSc.Vec().createWithArray(right),
               PETSc.Vec().createWithArray(unknown))
    assert snes.getConvergedReason() > 0
    return unknown


# Coarse contacts


@pytest.mark.parametrize("scene", [SMALL, SPHERE, {**SMALL, "gap_offset": -1.5}],
                         ids=["line", "sphere", "offset"])
def test_a_coarse_contact_is_the_same_on_every_other_node(scene):
    fine = Contact(Scene(**scene))
    coarse = fine.coarse(np.inf)
    again = Contact(Scene(**{**scene, "points": scene["points"] // 2}))
    assert coarse.grid.shape == tuple(n // 2 for n in fine.grid.shape)
    np.testing.assert_array_equal(coarse.ranges, fine.ranges)
    np.testing.assert_allclose(coarse.initial_gap, again.initial_gap, atol=1e-12)
    for mine, other in zip(coarse.grid.coordinates(), fine.grid.coordinates()):
        np.testing.assert_allclose(mine.ravel(), other.ravel()[::2], atol=1e-12)


def test_a_coarse_contact_takes_measured_heights(tmp_path):
    heights = np.random.default_rng(1).normal(size=64)
    scene = Scene(points=64, period=20.0, geometry="file", geometry_file=str(tmp_path / "none.npy"),
                  normal_maugis=3.0)
    coarse = Contact(scene, heights).coarse(0.1)
    np.testing.assert_allclose(coarse.initial_gap / coarse.ranges[0],
                               (heights.max() - heights)[::2], atol=1e-12)


def test_coarse_laws_are_soft_enough_for_their_grids():
    contact = Contact(Scene(points=512, period=30.0, normal_maugis=6.0, tangential_maugis=4.0))
    assert contact.coarse(np.inf).scene.ranges == contact.scene.ranges
    assert contact.coarse(5.0).scene.normal_maugis == 6.0
    twice = contact.coarse(1.25).coarse(1.25)
    assert twice.scene.normal_maugis == twice.scene.tangential_maugis == pytest.approx(
        np.sqrt(1.25 * 128 / 30))
    assert max(resolution(twice.scene, False)) <= 1.0 + 1e-12
    gap = contact.coarse(1.25).initial_gap / contact.coarse(1.25).ranges[0]
    np.testing.assert_allclose(gap, contact.initial_gap[::2] / contact.ranges[0], atol=1e-12)
    assert twice.scene.contact_threshold / twice.ranges[0] == pytest.approx(
        contact.scene.contact_threshold / 6.0)


@pytest.mark.parametrize("scene", [
    Scene(points=512, period=30.0, normal_maugis=6.0),
    Scene(dimension=2, points=(64, 96), period=(8.0, 12.0), geometry="rough", normal_maugis=3.0,
          rough_hurst=0.7, rough_slope=0.5, rough_longest=4.0, rough_shortest=1.0),
    Scene(law="xu_needleman", xu_needleman_q=0.8, points=512, poisson=0.3, height=math.inf),
    Scene.typed(units="si", points=512, work_of_adhesion_normal=0.05, contact_modulus=1e6,
                work_of_adhesion_tangential=0.05, radius=1e-4, range_normal=1e-7,
                range_tangential=2e-7)],
    ids=["line", "rough", "law", "SI"])
def test_scenes_of_coarse_contacts_are_as_checks_would_have_them(scene):
    """Their options are not looked at anew: that would find nothing, and change nothing."""
    coarse = Contact(scene).coarse(0.5).scene
    again = dataclasses.replace(coarse)
    assert coarse == again and hash(coarse) == hash(again) and repr(coarse) == repr(again)
    assert coarse.normal_maugis < scene.normal_maugis and coarse.stated() == again.stated()
    assert vars(coarse).keys() == vars(again).keys()


def test_coarse_transforms_count_in_units_of_the_fine_grid():
    fine, coarse, _ = pair()
    before = fine.grid.transforms
    coarse.residual(np.zeros(coarse.size), np.empty(coarse.size))
    assert fine.grid.transforms - before == pytest.approx(2 * 256 * np.log(256)
                                                          / (512 * np.log(512)))
    assert coarse.grid.transforms == 0.0
    inner = CoarseForm(coarse, 1.25)
    before = fine.grid.transforms
    inner.residual(np.zeros(inner.size), np.empty(inner.size))
    assert fine.grid.transforms - before == pytest.approx(2 * transform_cost(128, 512))


def test_a_coarse_form_follows_the_load():
    fine, coarse, _ = pair(controls=(FORCE, DISPLACEMENT))
    inner = CoarseForm(coarse, 1.25)
    fine.set_load([5.0, 2.0])
    for form in (coarse, inner):
        form.residual(np.zeros(form.size), np.empty(form.size))
        np.testing.assert_array_equal(form.load, [5.0, 2.0])


# Transfers

WINDOWS = [None, ((180,), (120,)), ((181,), (121,)), ((501,), (60,)), ((511,), (2,)),
           ((200,), (2,))]


@pytest.mark.parametrize("window", WINDOWS)
def test_kept_nodes_are_those_of_the_coarse_window(window):
    fine, coarse, transfer = pair(window)
    length = fine.grid.periods[0]
    kept = fine.window.coordinates()[0][transfer.kept]
    away = (kept - coarse.window.coordinates()[0] + length / 2) % length - length / 2
    assert len(kept) == coarse.nodes
    np.testing.assert_allclose(away, 0.0, atol=1e-12)


@pytest.mark.parametrize("window", WINDOWS[1:4])
def test_interpolation_is_exact_for_cubics(window):
    fine, _, transfer = pair(window)
    x = np.arange(fine.nodes) / fine.nodes
    for power in range(4):
        result = transfer.nodes @ x[transfer.kept] ** power
        np.testing.assert_allclose(result[4:-4], x[4:-4] ** power, atol=1e-12)
    np.testing.assert_allclose(transfer.nodes @ np.ones(len(transfer.kept)), 1.0, atol=1e-14)


def test_interpolation_is_of_fourth_order_on_the_cell():
    wrong = []
    for points in (64, 128):
        fine, _, transfer = pair(points=points)
        wave = np.sin(2 * np.pi * (3 * np.arange(points) / points + 0.1))
        wrong.append(np.abs(transfer.nodes @ wave[transfer.kept] - wave).max())
    assert 14.0 < wrong[0] / wrong[1] < 18.0


def test_interpolation_on_the_plane_is_that_of_both_directions():
    fine, coarse, transfer = pair(**SPHERE, window=((10, 61), (20, 17)))
    x, y = (np.arange(n) / n for n in fine.window.shape)
    field = (x[:, None] ** 3 * (1 + y[None, :] ** 2)).reshape(-1)
    assert coarse.window.start == (5, 31) and coarse.window.shape == (10, 8)
    result = fine.window.box(transfer.nodes @ field[transfer.kept])
    np.testing.assert_allclose(result[4:-4, 4:-4], fine.window.box(field)[4:-4, 4:-4], atol=1e-12)


def test_restriction_keeps_what_is_constant():
    """The same displacement, in the ranges of either law; rows of forces stay as they are."""
    fine, coarse, transfer = pair(controls=(FORCE, DISPLACEMENT), softness=0.3)
    assert coarse.contact.ranges[0] < fine.contact.ranges[0]
    constant = np.array([[2.0], [-3.0]]) * fine.contact.ranges[:, None]
    imbalance = fine.pack(np.broadcast_to(constant, fine.shape), [0.7])
    result = applied(transfer.restrict, coarse.size, imbalance)
    expected = coarse.pack(np.broadcast_to(constant * (coarse.contact.ranges
                                                       / fine.contact.ranges)[:, None],
                                           coarse.shape), [0.7])
    np.testing.assert_allclose(result, expected, atol=1e-13)


def test_the_same_law_exchanges_displacements():
    fine, coarse, transfer = pair(((180,), (121,)), (FORCE, DISPLACEMENT), softness=np.inf)
    rng = np.random.default_rng(2)
    field = rng.normal(size=fine.shape)
    field[0] -= 0.5 * fine.initial_gap
    injected = applied(transfer.inject, coarse.size, fine.pack(field, [0.4]))
    np.testing.assert_allclose(coarse.displacement(injected), field[:, transfer.kept], atol=1e-9)
    assert coarse.scalars(injected) == pytest.approx([0.4])


@pytest.mark.parametrize("softness", [0.3, np.inf])
def test_no_change_corrects_nothing(softness):
    fine, coarse, transfer = pair(((180,), (121,)), (FORCE, DISPLACEMENT), softness)
    unknown = fine.pack(np.random.default_rng(3).normal(size=fine.shape), [0.4])
    applied(transfer.inject, coarse.size, unknown)
    np.testing.assert_allclose(applied(transfer.correct, fine.size, np.zeros(coarse.size), unknown),
                               unknown, atol=1e-9)


def test_overlap_moves_as_traction_and_the_rest_as_gap():
    """Whatever the range of the coarse law: tractions are lambda N(a), scaled, and gaps a /
    lambda."""
    fine, coarse, transfer = pair(softness=0.3)
    gap = np.linspace(-6.0, 30.0, fine.nodes)[None]
    unknown = fine.pack(gap - fine.initial_gap, ())
    injected = applied(transfer.inject, coarse.size, unknown)
    other, mine = coarse.gap(injected)[0].copy(), gap[0, transfer.kept]
    laws = [(form.contact.law, form.contact.ranges[0]) for form in (fine, coarse)]
    tractions = [length * law.traction(a[None])[0] for (law, length), a in zip(laws, (mine, other))]
    assert laws[1][1] < 0.6 * laws[0][1] and np.abs(other[mine < -4.0]
                                                    - mine[mine < -4.0]).min() > 0.5
    np.testing.assert_allclose(tractions[1][mine < -4.0], tractions[0][mine < -4.0], rtol=0.03)
    np.testing.assert_allclose(other[mine > 25.0] / laws[1][1], mine[mine > 25.0] / laws[0][1],
                               rtol=1e-3)
    kappa = Coupled.moving_stiffness / (laws[1][1] / laws[0][1]) ** 2
    assert kappa > Coupled.moving_stiffness > Coupled.softening
    np.testing.assert_allclose(laws[1][0].regularised(other, kappa) / laws[1][1],
                               laws[0][0].regularised(mine, Coupled.moving_stiffness) / laws[0][1],
                               atol=1e-7)


def test_a_correction_leads_where_injection_came_from():
    """Inject a state, change it to another one's injection: the fine state gets the other's values
    on the kept nodes."""
    fine, coarse, transfer = pair(softness=0.3)
    x = fine.window.coordinates()[0]
    first = fine.pack((-0.9 * fine.initial_gap - np.exp(-x ** 2))[None], ())
    other = fine.pack((-0.8 * fine.initial_gap - 3.0 * np.exp(-x ** 2))[None], ())
    target = applied(transfer.inject, coarse.size, other)
    start = applied(transfer.inject, coarse.size, first)
    corrected = applied(transfer.correct, fine.size, target - start, first)
    np.testing.assert_allclose(fine.displacement(corrected)[0, transfer.kept],
                               fine.displacement(other)[0, transfer.kept], atol=1e-6)


# The scheme

EQUILIBRIA = {"normal": ((DISPLACEMENT,), [4.0], {}), "sheared": ((DISPLACEMENT, DISPLACEMENT),
                                                                  [4.0, 30.0], {}),
              "forces": ((FORCE, FORCE), [6.0, 1.0], {}),
              "sphere": ((DISPLACEMENT,), [0.5], SPHERE),
              "off the flat": ((DISPLACEMENT,), [-4.0], {}),
              "compressible": ((DISPLACEMENT,) * 2, [2.0, 1.0], {"poisson": 0.3})}


@pytest.mark.parametrize("softness", [1.25, 0.3, np.inf])
@pytest.mark.parametrize("controls, load", [((DISPLACEMENT,), [4.0]),
                                            ((DISPLACEMENT, FORCE), [4.0, 0.5])],
                         ids=["normal", "sheared"])
def test_a_solution_is_a_fixed_point_whatever_the_coarse_law(softness, controls, load):
    """From a disturbed guess the coarse problem comes back to what was injected, and corrects
    nothing."""
    fine, coarse, transfer = pair(controls=controls, softness=softness)
    fine.set_load(load)
    start = states.undeformed(fine.contact, (DISPLACEMENT,), [4.0])
    field = np.zeros(fine.shape)
    field[:1] = start.displacement
    solution = newton(fine, fine.pack(field, [0.0] * len(fine.forced)))
    imbalance = fine.residual(solution, np.empty(fine.size))
    injected = applied(transfer.inject, coarse.size, solution)
    own = coarse.residual(injected, np.empty(coarse.size))
    assert np.linalg.norm(own) > 1e-6
    right = own - applied(transfer.restrict, coarse.size, imbalance)
    guess = injected + 0.02 * np.random.default_rng(4).normal(size=coarse.size) / coarse.root
    change = newton(coarse, guess, right) - injected
    assert np.linalg.norm(change) < 1e-8
    corrected = applied(transfer.correct, fine.size, change, solution)
    assert np.linalg.norm(corrected - solution) < 1e-7


def test_a_coarse_correction_removes_a_smooth_error():
    """A tenth of it is left at most, with the law of the fine grid and with a softer one."""
    for softness in (np.inf, 1.25, 0.5):
        fine, coarse, transfer = pair(softness=softness)
        fine.set_load([4.0])
        solution = newton(fine, fine.pack(states.undeformed(fine.contact, (DISPLACEMENT,),
                                                            [4.0]).displacement, ()))
        fine.set_load([4.05])
        target = newton(fine, solution.copy())
        injected = applied(transfer.inject, coarse.size, solution)
        imbalance = fine.residual(solution, np.empty(fine.size))
        right = coarse.residual(injected, np.empty(coarse.size)) - applied(transfer.restrict,
                                                                           coarse.size, imbalance)
        change = newton(coarse, injected.copy(), right) - injected
        corrected = applied(transfer.correct, fine.size, change, solution)
        assert np.linalg.norm(corrected - target) < 0.1 * np.linalg.norm(solution
                                                                         - target), softness


@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("case", EQUILIBRIA)
def test_files_reach_newtons_equilibrium(options, file, case):
    controls, load, scene = EQUILIBRIA[case]
    expected = solved(corrector(**scene), controls, load)
    options(**from_file(file))
    made = corrector(log=pytest.fail, **scene)
    point = solved(made, controls, load)
    assert made.snes.getType() == "fas" and point.residual_norm <= 1e-8
    assert states.distance(made.contact, point.state, expected.state) < 1e-6
    np.testing.assert_allclose(point.forces, expected.forces, rtol=1e-6, atol=1e-6)
    assert not [name for name in unused_options(solver_options())
                if name.lstrip("-") in from_file(file)]


@pytest.mark.parametrize("given", [{"snes_fas_levels": "1"}, {"snes_fas_levels": "2"},
                                   {"snes_fas_levels": "5"}, {"snes_fas_cycles": "2"},
                                   {"snes_fas_type": "full"}, {"snes_fas_type": "kaskade"},
                                   {"snes_fas_smoothup": "2"}, {"snes_fas_smoothdown": "2"},
                                   {"snes_grids_resolution": "inf"},
                                   {"snes_regularised_gap": "true"},
                                   {"fas_levels_snes_type": "newtontr"},
                                   {"fas_levels_1_ksp_type": "gmres"}],
                         ids=lambda given: " ".join(f"{name}={value}"
                                                    for name, value in given.items()))
def test_petscs_options_work(options, given):
    expected = solved(corrector(), (DISPLACEMENT,), [4.0])
    options(snes_type="fas", **given)
    made = corrector()
    point = solved(made, (DISPLACEMENT,), [4.0])
    assert states.distance(made.contact, point.state, expected.state) < 1e-6
    assert made.snes.getFASLevels() == int(given.get("snes_fas_levels", 3))
    assert not [name for name in unused_options(solver_options()) if name.lstrip("-") in given]


def test_the_window_changes_nothing(options):
    options(snes_type="fas")
    narrow, wide = (solved(corrector(window), (DISPLACEMENT,), [4.0]) for window in ("auto", "off"))
    assert narrow.state.window.size < wide.state.window.size
    assert states.distance(corrector().contact, wide.state, narrow.state) < 1e-7


def test_view_shows_every_level(options, tmp_path):
    options(snes_type="fas", snes_fas_levels="3", snes_fas_smoothup="2")
    made = corrector()
    solved(made, (DISPLACEMENT,), [4.0])
    viewer = PETSc.Viewer().createASCII(str(tmp_path / "view"), "w", comm=PETSc.COMM_SELF)
    made.snes.view(viewer)
    viewer.destroy()
    text = (tmp_path / "view").read_text()
    assert "levels=3" in text and text.count("contact Jacobian") >= 5
    assert "type: basic" in text and "type: bt" not in text
    nodes = made.form.nodes
    assert all(f"{count} nodes" in text for count in (nodes,
                                                      made.snes.getFASSmoother(
        1).getJacobian()[0].getPythonContext().form.nodes))


def test_defaults_do_not_leak(options):
    options(snes_type="fas")
    solved(corrector(), (DISPLACEMENT,), [4.0])
    database = PETSc.Options()
    assert (not database.hasName("fas_levels_snes_linesearch_type")
            and not database.hasName("fas_coarse_snes_linesearch_type"))


# What it is good for


def test_softer_coarse_laws_help_where_coarse_grids_do_not_resolve_the_edge(options):
    """The paper's cylinder on three grids. What solves take without the softer laws hangs on
    rounding (65 or 87 transforms at D = 10, 52 with them), hence four depths: measured 237 against
    326 to 364."""
    spent = dict.fromkeys(("1.25", "inf"), 0.0)
    for softness in spent:
        options(snes_type="fas", snes_fas_levels="3", snes_grids_resolution=softness)
        for depth in (6.0, 10.0, 15.0, 20.0):
            made = corrector(points=8192, period=100.0, normal_maugis=10.0)
            solved(made, (DISPLACEMENT,), [depth])
            spent[softness] += made.account()["transforms"]
    assert spent["1.25"] < 0.9 * spent["inf"]


def test_a_deep_cold_start_is_cheaper_than_newtons(options):
    """The same at D = 40, both from the start without overlap on the finest grid: measured 92
    against 167 transforms."""
    spent = []
    for kind in ("newtonls", "fas"):
        options(snes_type=kind)
        made = Corrector(Contact(Scene(points=8192, period=100.0, normal_maugis=10.0)),
                         Form(cascade=False, symmetry="off"))
        solved(made, (DISPLACEMENT,), [40.0])
        spent.append(made.account()["transforms"])
    assert spent[1] < 0.8 * spent[0]


# Bad input, and failure


@pytest.mark.parametrize("given, words", [({"snes_fas_levels": "6"}, "at most 5 levels"),
                                          ({"snes_fas_levels": "0"}, "at most 5 levels"),
                                          ({"snes_fas_type": "ADDITIVE"}, "not linear"),
                                          ({"snes_fas_galerkin": "true"}, "only false"),
                                          ({"snes_fas_full_total": "true"}, "only false"),
                                          ({"snes_fas_continuation": "true"}, "only false"),
                                          ({"snes_grids_resolution": "0"}, "above 0")])
def test_what_these_grids_cannot_do_is_refused(options, given, words):
    options(snes_type="fas", **given)
    with pytest.raises(InputError, match=words):
        solved(corrector(), (DISPLACEMENT,), [4.0])


def test_a_grid_that_cannot_be_halved_has_one_level(options):
    options(snes_type="fas")
    made = corrector(points=250)
    solved(made, (DISPLACEMENT,), [4.0])
    assert made.snes.getFASLevels() == 1


def test_the_force_form_is_refused(options):
    options(snes_type="fas")
    form = ForceForm(Contact(Scene(**SMALL)), (DISPLACEMENT,))
    with pytest.raises(InputError, match="-contact_form displacement"):
        create_snes(form)


def test_a_smoother_without_preconditioner_fails_with_a_reason(options):
    """The paper's cylinder at D = 5: nonlinear Richardson, which stands still, as
    options/fas-richardson.opts says."""
    options(**{**from_file("fas-richardson.opts"), "fas_levels_snes_type": "nrichardson"})
    made = corrector(points=8192, period=100.0, normal_maugis=10.0)
    load = np.array([5.0])
    with pytest.raises(NotConverged, match="SNES DIVERGED_MAX_IT after 50 iterations"):
        made.solve(states.undeformed(made.contact, (DISPLACEMENT,), load), (DISPLACEMENT,), load)
