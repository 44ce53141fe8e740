"""First points by way of coarser grids: the state that the undeformed body reaches, for a fraction
of the transforms."""

import gc
import weakref

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes import Branch, Load  # noqa: E402
from contactsnes.branch import coarser
from contactsnes.branch import first_points as coldstart
from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact  # noqa: E402
from contactsnes.continuation.points import NotConverged  # noqa: E402
from contactsnes.dynamics import jumps
from contactsnes.grid.cell import Grid  # noqa: E402
from contactsnes.grid.counter import weighed  # noqa: E402
from contactsnes.grid.transfer import by_waves, resampled  # noqa: E402
from contactsnes.grid.windows import Window  # noqa: E402
from contactsnes.scene.settings import Form, Scene  # noqa: E402
from contactsnes.solvers.snes import COLD, WARM  # noqa: E402

PAPER = {}
SPHERE = {"dimension": 2, "points": 256, "period": 12.0, "geometry": "sphere", "normal_maugis": 4.0}


def made(scene, log=lambda sentence: None, **form):
    return Corrector(Contact(Scene(**scene)), Form(**form), log)


def first(scene, control, value, **form):
    """First point of one component, and what it cost."""
    system = made(scene, **form)
    point = coldstart.start(system, (control,), np.array([value]))
    return system, point, system.account()


def _both(spent):
    """Transforms in either precision."""
    return spent["transforms"] + spent["transforms_single"]


@pytest.mark.parametrize("scene, control, value", [
    (PAPER, DISPLACEMENT, 40.0), (PAPER, DISPLACEMENT, 7.3), (PAPER, FORCE, 11.0),
    (PAPER, DISPLACEMENT, 0.0), (SPHERE, DISPLACEMENT, 0.1),
    ({"normal_maugis": 5.0, "points": 2048, "poisson": 0.3, "height": 20.0}, DISPLACEMENT, 9.0),
    ({"normal_maugis": 0.7, "points": 512, "period": 40.0}, DISPLACEMENT, 6.0),
    ({"normal_maugis": 14.0, "points": 32768, "law": "mcgarry"}, DISPLACEMENT, 5.0),
    ({"points": 12288, "period": 150.0, "gap_offset": 0.5}, FORCE, 3.0),
    ({"points": 4608}, DISPLACEMENT, 13.0), ({**SPHERE, "normal_maugis": 6.5}, DISPLACEMENT, 2.0),
    (SPHERE, DISPLACEMENT, 3.0), (SPHERE, FORCE, 2.0),
    ({**SPHERE, "points": (256, 320), "period": (12.0, 14.0), "poisson": 0.2}, DISPLACEMENT, 2.5),
    ({**SPHERE, "geometry": "cylinder", "points": (256, 64)}, DISPLACEMENT, 2.0)])
def test_the_same_state_as_on_the_grid_itself(scene, control, value, options):
    """To what is left of their residuals: a state may be some hundred times as far off."""
    options(snes_atol="1e-9")
    system, through, cost = first(scene, control, value, symmetry="off")
    assert len(coldstart.levels(system.contact, states.undeformed(system.contact, (control,),
                                                                  np.array([value])))) > 1
    _, direct, own = first(scene, control, value, cascade=False, symmetry="off")
    assert states.missed(system.contact, through.state, direct.state, largest=True) < 1e-6
    np.testing.assert_allclose(through.forces, direct.forces, rtol=1e-7, atol=1e-7)
    # in transforms of either precision: coarse grids are too small for single precision
    assert _both(cost) < _both(own)


@pytest.mark.parametrize("method", ({}, {
    "snes_type": "python", "snes_python_type": "contactsnes.solvers.relaxation.Fire",
    "snes_max_it": "20000"}))
@pytest.mark.parametrize("scene, control, value", [
    ({"poisson": 0.3, "height": 5.0}, DISPLACEMENT, 1.0),
    ({"poisson": 0.3, "height": 5.0}, FORCE, 1.0), ({}, FORCE, 1.0)])
def test_a_cold_solve_in_the_force_form_finds_the_same(scene, control, value, method, options):
    """By way of states with a given mean, where the body gives way as a whole or is pressed."""
    scene = {"points": 256, "period": 20.0, "normal_maugis": 2.0, **scene}
    expected, found = made(scene), []
    for system in (expected, made(scene, form="force")):
        found.append(coldstart.cold(system, (control,), np.array([value])))
        options(**method)
    assert states.missed(expected.contact, *(point.state for point in found)) < 1e-6


@pytest.mark.parametrize("scene, value, most", [(PAPER, 40.0, 30), (PAPER, 2.8, 20),
                                                (PAPER, 17.0, 30), (PAPER, 0.0, 40),
                                                ({**SPHERE, "points": 512}, 2.0, 40),
                                                ({**SPHERE, "points": 512}, 4.0, 40),
                                                ({**SPHERE, "points": 512}, 6.0, 40)])
def test_what_a_first_point_costs(scene, value, most):
    _, _, cost = first(scene, DISPLACEMENT, value)
    assert weighed(cost) <= most


@pytest.mark.parametrize("control, value", [(FORCE, 5.0), (FORCE, 0.3), (DISPLACEMENT, 60.0)])
def test_the_start_of_large_planes_is_that_of_every_other_node(control, value):
    contact = Contact(Scene(**{**SPHERE, "poisson": 0.3}))
    load = np.array([value])
    depths = []
    for unknown in (contact, contact.coarse(np.inf)):
        start = states.undeformed(unknown, (control,), load)
        depths.append(-start.normal.min())
    assert depths[0] == pytest.approx(depths[1], rel=1e-3)
    spent = contact.grid.counter.transforms
    np.testing.assert_array_equal(states.undeformed(contact, (control,), load).normal,
                                  np.maximum(-contact.initial_gap.reshape(-1), -depths[1]))
    assert contact.grid.counter.transforms < spent + 10.0
    grid = Contact(Scene(**{**SPHERE, "poisson": 0.3, "points": 128}))  # asked on itself
    own = states.undeformed(grid, (control,), load)
    assert -own.normal.min() == pytest.approx(depths[0], rel=0.1)


def test_a_first_point_under_a_force_costs_as_much_as_one_at_a_displacement():
    scene = {**SPHERE, "points": 512}
    spent = [weighed(first(scene, control, value)[2])
             for control, value in ((DISPLACEMENT, 4.0), (FORCE, 12.5))]
    assert spent[1] <= 2.0 * spent[0] + 2.0


@pytest.mark.parametrize("changes", [
    {"poisson": 0.3}, {"poisson": 0.3, "points": (256, 320), "period": (12.0, 14.0)}])
@pytest.mark.parametrize("load", [[(DISPLACEMENT, 4.0), (DISPLACEMENT, 0.0)],
                                  [(FORCE, 5.0), (FORCE, 0.0)]])
def test_tangential_components_come_from_a_coarser_grid(load, changes, options):
    """As those found from a normal contact without friction do, in fewer iterations there."""
    options(snes_atol="1e-9")
    scene = {**SPHERE, "normal_maugis": 1.5, **changes}
    controls, values = zip(load[0], load[1], load[1])
    found, spent = [], []
    for cascade in (True, False):
        system = made(scene, cascade=cascade)
        point = coldstart.start(system, controls, np.array(values))
        found.append(point)
        spent.append((point.spent["last_iterations"], weighed(system.account())))
    assert spent[0][0] <= 3 < spent[1][0] and spent[0][1] < spent[1][1]
    assert states.missed(system.contact, *(point.state for point in found), largest=True) < 1e-6
    np.testing.assert_allclose(found[0].forces, found[1].forces, rtol=1e-7, atol=1e-7)


def test_tangential_components_that_nothing_moves_are_those_of_the_normal_contact():
    system = made({**SPHERE, "normal_maugis": 1.5, "tangential": "on"})
    point = coldstart.start(system, (DISPLACEMENT,) * 3, np.array([4.0, 0.0, 0.0]))
    assert point.spent["last_iterations"] == 0 and not point.state.displacement[1:].any()


@pytest.mark.parametrize("points, maugis, period, control, value", [
    (32768, 25.7, 20.0, DISPLACEMENT, 0.265), (65536, 31.6, 60.0, DISPLACEMENT, 1.23),
    (32768, 33.4, 20.0, DISPLACEMENT, 0.117), (131072, 36.7, 100.0, FORCE, 4.98),
    (131072, 30.0, 125.0, DISPLACEMENT, 40.0)])
def test_sharp_laws_are_reached_without_wandering(points, maugis, period, control, value):
    """Where full steps leave a good guess at first, and coarse grids do not resolve edges."""
    _, point, cost = first({"points": points, "normal_maugis": maugis, "period": period}, control,
                           value)
    assert point.residual_norm <= 1e-8 and weighed(cost) <= 150


def test_steps_from_afar_have_a_larger_kappa_unless_one_is_given(options):
    def kappas(**given):
        options(**given)
        system, used, point = made({"normal_maugis": 0.7, "points": 512, "period": 40.0}), [], None
        for most in (COLD, WARM):
            point = system.solve(point.state if used else
                                 states.undeformed(system.contact, (DISPLACEMENT,), [3.0]),
                                 (DISPLACEMENT,), [3.0], most)
            held = system.form.regularised
            used.append(held and held.newton_stiffness)
        return used

    assert kappas() == pytest.approx([1.0, 0.2])
    assert kappas(snes_regularised_stiffness=0.3) == [None, None]
    assert kappas(snes_lag_jacobian=2) == [None, None]


def test_a_divergence_tolerance_that_is_given_holds(options):
    options(snes_divergence_tolerance=1.01)
    system = made(PAPER)
    with pytest.raises(NotConverged, match="DIVERGED_DTOL"):
        system.solve(states.undeformed(system.contact, (DISPLACEMENT,), [0.0]), (DISPLACEMENT,),
                     [0.0], COLD)


def test_all_that_is_spent_is_counted():
    system, _, cost = first(PAPER, DISPLACEMENT, 10.0)
    assert cost["transforms"] == pytest.approx(system.contact.grid.transforms)
    assert (cost["nonlinear_iterations"] > 12
            and cost["linear_iterations"] > cost["nonlinear_iterations"])


@pytest.mark.parametrize("scene, value", [
    # off the flat: two states may exist
    (PAPER, -2.0),
    # full contact is another state
    ({"geometry": "sinusoid", "points": 2048, "normal_maugis": 4.0}, 5.0),
    ({"geometry": "flat", "points": 2048, "normal_maugis": 4.0}, 1.0),      # no edge
    ({"points": 1024}, 10.0)])                                       # edges stick between nodes
def test_grids_are_left_alone_where_they_may_lead_elsewhere(scene, value):
    contact = Contact(Scene(**scene))
    start = states.undeformed(contact, (DISPLACEMENT,), np.array([value]))
    assert coldstart.levels(contact, start) == [contact]


@pytest.mark.parametrize("settings, options", [({"cascade": False}, {}), ({"form": "force"}, {}),
                                               ({"first": "relaxation"}, {}),
                                               ({}, {"snes_type": "anderson"})])
def test_other_methods_start_on_the_grid_itself(settings, options):
    database = PETSc.Options()
    for name, value in options.items():
        database.setValue(name, value)
    try:
        assert coldstart.coarser(made(PAPER, **settings), Contact(Scene()), None) is None
    finally:
        for name in options:
            database.delValue(name)


def test_a_failure_on_coarse_grids_is_told_and_costs_only_time(monkeypatch):
    def fails(contact, finer, state):
        raise NotConverged("the coarse grid failed")

    for way in ("refined", "sharpened"):
        monkeypatch.setattr(coldstart, way, fails)
    said = []
    system = made({**PAPER, "points": 8192}, said.append)
    point = coldstart.start(system, (DISPLACEMENT,), np.array([3.0]))
    assert point.residual_norm <= 1e-8
    assert len(said) == 2 and all("the coarse grid failed" in sentence for sentence in said)


def test_contact_that_a_softer_law_makes_too_early_costs_its_coarse_grid_alone():
    """A body that gives way as a whole, brought near: under the law of the coarsest grid it has
    come into contact, which is no beginning for a sharper one."""
    scene = {**SPHERE, "points": 512, "normal_maugis": 5.657, "poisson": 0.3}
    said = []
    system = made(scene, said.append)
    point = coldstart.start(system, (DISPLACEMENT,), np.array([0.0]))
    _, direct, own = first(scene, DISPLACEMENT, 0.0, cascade=False)
    assert weighed(system.account()) < 0.5 * weighed(own) and not said
    np.testing.assert_allclose(point.forces, direct.forces, atol=1e-7)


def test_every_grid_has_as_many_iterations_as_a_cold_solve(monkeypatch):
    """A sharp law on a fine grid takes more of them than a warm step may."""
    given, run = [], Corrector.run

    def watched(self, form, unknown, most, snes=None):
        given.append((form.grid.shape, most))
        return run(self, form, unknown, most, snes)

    monkeypatch.setattr(Corrector, "run", watched)
    _, point, _ = first({**SPHERE, "normal_maugis": 5.6}, DISPLACEMENT, 1.0)
    assert len({shape for shape, _ in given}) > 2 and {most for _, most in given} == {COLD}
    # half of the cell is more than its own circle has room for, padded
    assert point.state.window.is_whole


def test_resampling_keeps_every_wave():
    coarse, fine = Grid((16, 12), (3.0, 2.0)), Grid((32, 24), (3.0, 2.0))

    def field(grid):
        x, y = (2 * np.pi * axis / period for axis, period in zip(grid.coordinates(), grid.periods))
        return np.array([1.5 + np.cos(7 * x - 5 * y) + np.sin(3 * y), np.sin(2 * x + 4 * y)])

    np.testing.assert_allclose(resampled(coarse, fine, field(coarse)), field(fine), atol=1e-13)
    assert coarse.transforms > 0 and fine.transforms > 0


@pytest.mark.parametrize("shape, ratio", [((20,), 2), ((16, 12), 2), ((12, 16), 3)])
def test_resampling_leaves_values_at_nodes_as_they_are(shape, ratio):
    """The noise of a measured surface has as much of the shortest wave as of others."""
    coarse, fine = (Grid(tuple(n * k for n in shape), (3.0, 2.0)[:len(shape)])
                    for k in (1, ratio))
    noise = np.random.default_rng(1).standard_normal((2, *shape))
    found, expected = resampled(coarse, fine, noise), noise
    for axis, points in enumerate(fine.shape):
        expected = by_waves(expected, points, axis + 1)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    every = (slice(None), *[slice(None, None, ratio)] * len(shape))
    np.testing.assert_allclose(found[every], noise, atol=1e-13)


def test_a_sharper_law_keeps_traction_in_overlap_and_the_gap_elsewhere():
    sharp = Contact(Scene())
    soft = sharp.coarse(2.5)
    soft_again = soft.coarse(2.5)
    assert soft.ranges[0] == sharp.ranges[0] and soft_again.ranges[0] < soft.ranges[0]
    window = Window(soft_again.grid, (600,), (800,))
    places = window.coordinates()[0]
    gap = 3.0 * np.cos(places / 4.0) + 1.0
    state = states.State(window, (gap - window.take(soft_again.initial_gap))[None], np.zeros(1))
    moved = coarser.refined(soft_again, soft, state)
    mine = states.normal_gap(soft, moved)[::2]
    overlap, open_ = gap < -0.3, gap > 3.5
    ratio = soft.ranges[0] / soft_again.ranges[0]
    tractions = [contact.law.traction(values[None])[0]
                 for contact, values in ((soft_again, gap), (soft, mine))]
    # In units of length: gaps over maugis, tractions times maugis; kappa leaves both only
    # approximately as they are.
    np.testing.assert_allclose(ratio * tractions[1][overlap], tractions[0][overlap], rtol=0.35)
    np.testing.assert_allclose(mine[open_], gap[open_] * ratio, rtol=0.2)


# Gaps that are not convex

LINE = {"points": 256, "period": 24.0, "normal_maugis": 2.0, "height": float("inf"),
        "tangential": "off", "geometry": "file", "geometry_file": "heights.npy"}
PLANE = {**LINE, "dimension": 2, "points": 64, "period": 8.0}
SAID = "where motion from the undeformed body leads"


def on_heights(heights, scene, control=DISPLACEMENT, value=0.0, log=lambda sentence: None, **form):
    """First point of one component of a body with heights."""
    system = Corrector(Contact(Scene(**scene), heights), Form(**form), log)
    return system, coldstart.start(system, (control,), np.array([value]))


@pytest.mark.parametrize("seed, control, value", (
    (0, DISPLACEMENT, 0.0), (1, DISPLACEMENT, 0.0), (2, DISPLACEMENT, -1.0), (1, FORCE, 1.0)))
def test_a_rough_line_starts_where_motion_leads(seed, control, value, self_affine, options):
    """Whatever node the line begins with, and with another motion."""
    heights, said = self_affine(256, 24.0, 12.0, 0.75, 1.0, seed), []
    system, point = on_heights(heights, LINE, control, value, said.append)
    assert not system.contact.convex and any(SAID in sentence for sentence in said)
    _, moved = on_heights(np.roll(heights, 101), LINE, control, value)
    here, there = (system.contact.extended(found.state)[0] for found in (point, moved))
    np.testing.assert_allclose(np.roll(here, 101), there, atol=1e-6)
    np.testing.assert_allclose(moved.forces, point.forces, rtol=1e-7)
    options(jump_motion_type="inertial")
    _, inertial = on_heights(heights, LINE, control, value)
    for name in ("forces", "displacements"):
        np.testing.assert_allclose(getattr(inertial, name), getattr(point, name), rtol=1e-7,
                                   atol=1e-7)


def test_a_cold_solve_on_a_rough_line_ends_elsewhere(self_affine):
    """There is another equilibrium with half as much again of adhesion: the test above has a
    meaning."""
    system, point = on_heights(self_affine(256, 24.0, 12.0, 0.75, 1.0, 1), LINE)
    cold = coldstart.cold(system, (DISPLACEMENT,), np.array([0.0]))
    assert cold.forces[0] < 1.3 * point.forces[0] < 0.0


def test_rounding_does_not_decide_on_a_rough_plane(self_affine, monkeypatch):
    heights = self_affine(64, 8.0, 4.0, 1.0, 1.0, 3, dimension=2)
    _, point = on_heights(heights, PLANE)
    undeformed, noise = states.undeformed, np.random.default_rng(5)

    def disturbed(*arguments):
        state = undeformed(*arguments)
        around = state.displacement + 1e-13 * noise.standard_normal(state.displacement.shape)
        return states.State(state.window, around, state.means)

    monkeypatch.setattr(states, "undeformed", disturbed)
    _, other = on_heights(np.roll(heights, (20, 31), (0, 1)), PLANE)
    np.testing.assert_allclose(other.forces, point.forces, rtol=1e-7)


def test_a_parabola_from_a_file_is_convex_and_a_dented_one_is_not():
    contact = Contact(Scene(**{**LINE, "geometry": "cylinder"}))
    heights = np.roll(-contact.initial_gap, 40) / contact.ranges[0]
    said = []
    system, point = on_heights(heights, LINE, value=3.0, log=said.append)
    assert system.contact.convex and not said
    shape = coldstart.start(made({**LINE, "geometry": "cylinder"}), (DISPLACEMENT,),
                            np.array([3.0]))
    np.testing.assert_allclose(point.forces, shape.forces, rtol=1e-7)
    heights[30] += 0.1
    assert not Contact(Scene(**LINE), heights).convex


def test_relaxation_that_is_asked_for_says_that_it_is_not_the_reference(self_affine, options):
    heights, said = self_affine(256, 24.0, 12.0, 0.75, 1.0, 1), []
    options(snes_type="python", snes_python_type="contactsnes.solvers.relaxation.Fire",
            snes_max_it=100000)
    _, point = on_heights(heights, LINE, log=said.append, form="force")
    assert any("inertial motion" in sentence and "another one" in sentence for sentence in said)


def test_a_sheared_rough_line_starts_where_motion_under_all_loads_leads(tmp_path, self_affine,
                                                                        options):
    """With inertia, too; by steps of the shear, spot by spot, it would cost ten times as much."""
    np.save(tmp_path / "heights.npy", self_affine(256, 24.0, 12.0, 0.75, 1.0, 0))
    scene = Scene(**{**LINE, "tangential": "on", "tangential_maugis": 1.0, "residual_friction": 0.5,
                     "poisson": 0.3, "geometry_file": str(tmp_path / "heights.npy")})
    found = []
    for kind in ("overdamped", "inertial"):
        options(jump_motion_type=kind)
        start = "normal_displacement=0, tangential_displacement=2"
        branch = Branch(scene, Load(start=start, path="normal_displacement=hold"))
        found.append((next(iter(branch)), branch.contact.grid.transforms))
    (point, cost), (other, _) = found
    np.testing.assert_allclose(point.displacements, (0.0, 2.0), atol=1e-12)
    np.testing.assert_allclose(point.forces, other.forces, rtol=1e-6)
    assert cost < 4000


# A motion is handed over to Newton's method where that leads to the same state, at every node

def test_a_solution_that_differs_at_a_few_nodes_is_not_taken(self_affine):
    system, point = on_heights(self_affine(256, 24.0, 12.0, 0.75, 1.0, 1), LINE)
    aside = point.state.displacement.copy()
    aside[0, np.argmin(states.normal_gap(system.contact, point.state))] += 0.05
    rest = states.State(point.state.window, aside, point.state.means)
    assert states.missed(system.contact, rest, point.state) < 0.01
    with pytest.raises(NotConverged, match="not where the motion led"):
        jumps.polished(system, lambda: rest, point.controls, point.load)


def test_a_motion_that_is_not_confirmed_is_followed_further(self_affine, monkeypatch):
    system, point = on_heights(self_affine(256, 24.0, 12.0, 0.75, 1.0, 1), LINE)
    polished, speeds = jumps.polished, []

    def doubtful(system, rest, controls, load, most):
        aside = point.state.displacement - states.onto(rest(), point.state.window)
        speeds.append(np.abs(aside).max())
        if len(speeds) < 3:
            raise NotConverged("not yet")
        return polished(system, rest, controls, load, most)

    class Seen(jumps.OverdampedMotion):
        def __init__(self, *arguments, **measured):
            super().__init__(*arguments, **measured)
            motions.append(weakref.ref(self))

    motions = []
    monkeypatch.setattr(jumps, "polished", doubtful)
    monkeypatch.setattr(jumps, "OverdampedMotion", Seen)
    gc.disable()
    try:
        again = coldstart.start(system, (DISPLACEMENT,), np.array([0.0]))
        # No failure keeps a motion with its solvers alive: PETSc may be gone when cycles are
        # collected.
        assert motions and all(motion() is None for motion in motions)
    finally:
        gc.enable()
    assert len(speeds) == 3 and speeds[2] < speeds[0] and speeds[2] < 1e-6
    np.testing.assert_allclose(again.forces, point.forces, rtol=1e-7)
