"""First points and jumps of a rough plane: on coarser grids, compared with motion of everything."""

import gc
import weakref

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes import Branch, Load, Scene  # noqa: E402
from contactsnes.branch import coarse_motion, crossing  # noqa: E402
from contactsnes.branch.coarser import resolving  # noqa: E402
from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.branch.departure import Departure  # noqa: E402
from contactsnes.contact import combining, fronts, states  # noqa: E402
from contactsnes.contact.energies import stored  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE  # noqa: E402
from contactsnes.continuation.points import (  # noqa: E402
    Leg,
    NoEquilibrium,
    NotConverged,
    NoWayBack,
)
from contactsnes.dynamics import jumps  # noqa: E402
from contactsnes.grid import clusters  # noqa: E402
from contactsnes.scene.settings import Form, Steps  # noqa: E402
from contactsnes.solvers import krylov  # noqa: E402
from contactsnes.solvers.patience import FURTHEST, Patience, first_forcing  # noqa: E402
from contactsnes.solvers.snes import COLD  # noqa: E402

PERIOD, WAVES, SLOPE, SEED = 12.0, (3.0, 0.75), 2.0, 0
START, END = -0.3, 0.0


def branch_of(heights, file, start=START, path="normal_displacement=hold", log=lambda text: None,
              steps=None, **form):
    """The branch of heights on a plane at a normal Maugis parameter of 2."""
    np.save(file, heights)
    scene = Scene(dimension=2, geometry="file", geometry_file=str(file), points=len(heights),
                  period=PERIOD, normal_maugis=2.0)
    return Branch(scene, Load(start=f"normal_displacement={start}", path=path), steps=steps,
                  form=Form(**form), log=log)


@pytest.fixture(scope="module")
def heights():
    """A function (points) -> heights, the same waves on every grid."""
    def made(points):
        most = int(PERIOD / WAVES[1])
        numbers = np.array(np.meshgrid(*[np.arange(-most, most + 1)] * 2, indexing="ij"))
        size = np.hypot(*numbers) / PERIOD
        kept = (size * WAVES[0] >= 1) & (size * WAVES[1] <= 1)
        phases = np.random.default_rng(SEED).random(size.shape)
        spectrum = np.zeros((points, points), complex)
        spectrum[tuple(numbers % points)] = kept * np.where(kept, size, 1.0) ** -1.8 * np.exp(
            2j * np.pi * phases)
        frequencies = np.meshgrid(*[np.fft.fftfreq(points, 1 / points)] * 2, indexing="ij")
        slopes = [np.fft.ifft2(spectrum * 2j * np.pi / PERIOD * frequency).real
                  for frequency in frequencies]
        return np.fft.ifft2(spectrum).real * SLOPE / np.sqrt(np.mean(np.square(slopes[0])
                                                                     + np.square(slopes[1])))

    return made


@pytest.fixture(scope="module", params=[
    "bracketed", "followed", "narrowed", pytest.param("nested", marks=pytest.mark.study), "turned"])
def pressed(request, heights, tmp_path_factory):
    """A branch through jumps, its points and its log; where nothing leads back through a bracket by
    what the branch between both states tells, in narrower brackets, one in another, and by arc
    length to each fold."""
    said = []
    branch = branch_of(heights(128), tmp_path_factory.mktemp("plane") / "heights.npy",
                       path=f"normal_displacement={END}", log=said.append,
                       steps=Steps(initial_step=0.04, largest_step=0.08))
    with pytest.MonkeyPatch.context() as patch:
        if request.param != "bracketed":
            refused = {"narrowed": 1, "nested": 2}.get(request.param, np.inf)
            patch.setattr(crossing, "_crossed", without_ways_back(patch, refused))
        if request.param not in ("bracketed", "followed"):
            patch.setattr(crossing, "_along", lambda *_: None)
        points = list(branch)
    assert any("by arc length" in sentence for sentence in said) == (request.param == "turned")
    return branch, points, said


def without_ways_back(patch, number):
    """`crossing._crossed` that finds no way back so many times at first."""
    crossed, back, tried = crossing._crossed, crossing._back, []

    def counted(*given):
        if given[-1] == crossing.NARROWER:
            tried.clear()
        return crossed(*given)

    def refused(*given):
        tried.append(given)
        if len(tried) <= number:
            raise NoWayBack("the branch beyond a refused step does not reach back")
        return back(*given)

    patch.setattr(crossing, "_back", refused)
    return counted


@pytest.fixture(scope="module")
def folds(pressed):
    """(fold, jump) pairs of the branch."""
    _, points, _ = pressed
    pairs = [pair for pair in zip(points, points[1:]) if pair[0].event == "fold"]
    assert pairs and all(jump.event == "jump" for _, jump in pairs)
    return pairs


def bracket(fold):
    """Width of the load's bracket."""
    return fold.fold_precision * max(abs(fold.load[0]), 1e-3)


def test_coarser_grids_lead_to_the_first_point_of_motion_on_everything(heights, tmp_path):
    found = []
    for cascade in (True, False):
        branch = branch_of(heights(128), tmp_path / "heights.npy", start=0.0, cascade=cascade)
        found.append((next(iter(branch)), sum(branch.contact.grid.numbers[[0, 2]])))
    (point, cost), (direct, whole) = found
    assert point.forces[0] == pytest.approx(direct.forces[0], rel=1e-6)
    assert cost < 0.5 * whole
    inertial = branch_of(heights(128), tmp_path / "heights.npy", start=0.0, cascade=False)
    state = states.undeformed(inertial.contact, (DISPLACEMENT,), np.zeros(1))
    fire = jumps.by_inertia(inertial.corrector, state, (DISPLACEMENT,), np.zeros(1), "here")
    assert fire.forces[0] == pytest.approx(point.forces[0], rel=1e-6)


def test_the_first_point_does_not_depend_on_the_kernels(heights, tmp_path):
    forces = [next(iter(branch_of(heights(128), tmp_path / "heights.npy",
                                  kernels=kernels))).forces[0] for kernels in ("auto", "off")]
    assert forces[0] == pytest.approx(forces[1], rel=1e-7)


def test_a_grid_too_coarse_for_the_gap_is_not_used(heights, tmp_path):
    branch = branch_of(heights(64), tmp_path / "heights.npy")
    assert resolving(branch.corrector, False) is None
    fine = branch_of(heights(128), tmp_path / "heights.npy")
    assert resolving(fine.corrector, False).contact.grid.shape == (64, 64)


def test_a_coarse_state_that_newton_leaves_is_moved_on(heights, tmp_path, monkeypatch):
    said = []
    reference = next(iter(branch_of(heights(128), tmp_path / "heights.npy"))).forces[0]
    monkeypatch.setattr(coarse_motion, "CORRECTED", 0.0)
    point = next(iter(branch_of(heights(128), tmp_path / "heights.npy", log=said.append)))
    assert point.forces[0] == pytest.approx(reference, rel=1e-6)
    assert any("motion goes on" in sentence for sentence in said)


def test_solves_beside_a_state_and_along_the_arc_are_in_single_precision(heights, tmp_path):
    """What a coarser grid's state or an arc leads to is near by, so that rounding decides
    nothing."""
    branch = branch_of(heights(128), tmp_path / "heights.npy")
    system, point = branch.corrector, next(iter(branch))
    leg = Leg(1, point.controls, point.load, point.load + 1.0, 0, 0.1, 0.1, 1e-6)
    ahead = system.along_tangent(point, leg, 0.0, 0.01)
    chord = point.state, ahead
    solves = [lambda: coarse_motion.corrected(system, ahead, point.controls, leg.load(0.01)),
              lambda: system.solve_arc(chord, system.chord_length(*chord), ahead, 0.01, leg)]
    found = []
    for solve in solves:
        before = system.contact.grid.counter.numbers[[0, 2]]
        found.append(solve())
        double, single = system.contact.grid.counter.numbers[[0, 2]] - before
        assert single > double and found[-1].residual_norm <= 1e-8
    assert states.missed(system.contact, *(each.state for each in found), largest=True) < 0.01


def test_of_large_forms_one_solver_at_a_time_has_memory(heights, tmp_path, monkeypatch):
    """That along the arc, or that at a load; of small ones both stay. They lead to the same
    points."""
    found = {}
    for size in (1000, 10 ** 6):
        monkeypatch.setattr(krylov, "LARGE", size)
        system = branch_of(heights(64), tmp_path / "heights.npy").corrector
        leg = Leg(1, (DISPLACEMENT,), np.array([0.3]), np.array([1.3]), 0, 0.1, 0.1, 1e-6)
        begin = system.solve(states.undeformed(system.contact, leg.controls, [0.3]), leg.controls,
                             leg.load(0.0), COLD)
        ahead = system.along_tangent(begin, leg, 0.0, 0.01)
        chord = begin.state, ahead
        passed = system.solve_arc(chord, system.chord_length(*chord), ahead, 0.01, leg)
        assert (system.snes is None) is (size == 1000) and system.arc is not None
        behind = system.solve(passed.state, leg.controls, leg.load(passed.position))
        assert (system.arc is None) is (size == 1000) and system.snes is not None
        found[size] = begin, passed, behind
    for few, many in zip(*found.values()):
        assert states.missed(system.contact, few.state, many.state, largest=True) < 1e-6
        assert few.forces == pytest.approx(many.forces, abs=1e-6)
    assert passed.forces == pytest.approx(behind.forces, abs=1e-6)


def test_a_chord_is_judged_by_its_own_residual(heights, tmp_path):
    """On a grid that leads to a finer one, whatever the last solve at a load left."""
    branch = branch_of(heights(64), tmp_path / "heights.npy")
    system, point = branch.corrector, next(iter(branch))
    system.leads = True
    leg = Leg(1, point.controls, point.load, point.load + 1.0, 0, 0.1, 0.1, 1e-6)
    ahead = system.along_tangent(point, leg, 0.0, 0.01)
    chord = point.state, ahead
    with pytest.raises(NotConverged):
        system.solve(point.state, point.controls, leg.load(0.5), 1)
    found = system.solve_arc(chord, system.chord_length(*chord), ahead, 0.01, leg)
    assert found.residual_norm <= 1e-8 < system.snes.getFunctionNorm()


def test_jumps_end_where_motion_of_everything_does(pressed, folds):
    """With inertia from each fold, on the whole grid, at the load of the bracket's far end, and
    back."""
    branch = pressed[0]
    system = branch.corrector
    for fold, jump in folds:
        beyond = fold.load + bracket(fold)
        ahead = jumps.by_inertia(system, fold.state, fold.controls, beyond, "here")
        back = system.solve(ahead.state, fold.controls, fold.load, 200)
        assert states.missed(system.contact, jump.state, back.state, largest=True) < 1e-4
        assert states.missed(system.contact, fold.state, back.state, largest=True) > 0.3


def test_works_of_jumps_are_from_their_own_begin_to_their_own_end(folds):
    """The motion runs beyond the bracket's far side, from another point and to another one; the
    potential tells what a jump itself does."""
    for fold, jump in folds:
        done = jump.interfacial_energy - fold.interfacial_energy
        assert jump.jump_work == pytest.approx(done, rel=5e-3)


def test_jumps_lose_energy_and_are_told_with_their_places(pressed, folds):
    branch, _, said = pressed
    for fold, jump in folds:
        assert jump.load[0] == fold.load[0]
        assert sum(stored(branch.contact, jump)) < sum(stored(branch.contact, fold))
        assert jump.dissipated_work > fold.dissipated_work
    assert sum("a jump " in sentence and "at x = " in sentence for sentence in said) >= len(
        folds)


@pytest.mark.parametrize("residual_friction", [0.0, 0.5])
def test_no_jump_leads_to_more_energy_where_the_law_has_no_potential(residual_friction):
    """Of two states under one load, of a contact that slides at once, the way there is one, and the
    way back none."""
    scene = Scene(points=512, period=40.0, normal_maugis=2.0, tangential_maugis=2.0, height=2.0,
                  residual_friction=residual_friction)
    branch = Branch(scene, Load("normal_displacement=0.5", "tangential_displacement=6"))
    points = list(branch)
    fold, jump = next(pair for pair in zip(points, points[1:]) if pair[1].event == "jump")
    assert np.isnan(stored(branch.contact, jump)[1])
    assert crossing._lower(branch.corrector, fold, jump) is jump
    assert crossing._lower(branch.corrector, jump, jump) is None
    with pytest.raises(NoWayBack, match="more energy"):
        crossing._lower(branch.corrector, jump, fold)


@pytest.fixture(scope="module")
def located(heights, tmp_path_factory):
    """The first fold of the branch, located."""
    branch = branch_of(heights(128), tmp_path_factory.mktemp("located") / "heights.npy",
                       path=f"normal_displacement={END}",
                       steps=Steps(at_fold="stop", locate_folds=True, initial_step=0.04,
                                   largest_step=0.08))
    return list(branch)[-1]


def test_a_located_fold_lies_in_its_bracket(folds, located):
    fold = folds[0][0]
    assert located.event == "fold" and 0.0 < located.fold_precision <= 1e-8
    assert fold.load[0] <= located.load[0] <= fold.load[0] + bracket(fold)


@pytest.mark.parametrize("control", [DISPLACEMENT, FORCE])
def test_an_equilibrium_stands_still_on_the_coarser_grid(heights, tmp_path, control):
    branch = branch_of(heights(128), tmp_path / "heights.npy")
    system = branch.corrector
    point = next(iter(branch))
    load = point.load if control == DISPLACEMENT else point.forces
    coarse = resolving(system, False)
    level = Departure(system.contact, coarse.contact, point.state)
    found = type(coarse)(level.contact, system.settings).solve(level.origin, (control,),
                                                               level.load((control,), load))
    assert states.missed(level.contact, level.origin, found.state, largest=True) < 1e-6
    again = level.prolonged(level.injected(point.state))
    assert states.missed(system.contact, again, point.state, largest=True) < 1e-12


def test_a_grid_holds_no_form_while_motion_is_on_a_coarser_one(heights, tmp_path, monkeypatch):
    """Nor does what was told of the step that was refused: a form's memory, and that of its SNES,
    is that of the motion, and then of the states that are brought to the finer grid."""
    bare_form, follow = Corrector.bare_form, jumps.OverdampedMotion.follow
    forms, held = weakref.WeakSet(), []

    def made(system, *given):
        form = bare_form(system, *given)
        forms.add(form)
        return form

    def followed(motion, *given):
        finer = [form for form in forms if form.contact.grid.size > motion.contact.grid.size]
        held.append(len(finer))
        return follow(motion, *given)

    prolonged, given = Departure.prolonged, []

    def brought(level, state):
        given.append(any(form.contact is level._fine for form in forms))
        return prolonged(level, state)

    monkeypatch.setattr(Departure, "prolonged", brought)
    monkeypatch.setattr(Corrector, "bare_form", made)
    monkeypatch.setattr(jumps.OverdampedMotion, "follow", followed)
    branch = branch_of(heights(128), tmp_path / "heights.npy",
                       path=f"normal_displacement={END}",
                       steps=Steps(initial_step=0.04, largest_step=0.08))
    gc.collect()
    gc.disable()
    try:
        assert "jump" in [point.event for point in branch]
    finally:
        gc.enable()
    assert len(held) > 1 and not any(held)
    assert len(given) > 2 and not any(given)


def test_a_motion_has_the_memory_of_a_large_form(heights, tmp_path, monkeypatch):
    """On its own grid, too, and gives it back for the solve at its end; where that leads elsewhere
    it goes on as one that has kept its own. It keeps of moments what its steps need."""
    follow, taken_over, found = jumps.OverdampedMotion.follow, jumps.taken_over, []

    def followed(motion, *given):
        held.append(system.form is None)
        follow(motion, *given)
        assert [moment.elastic is None for moment in motion.history] == [True, False, False]
        ended.append(motion)

    def refused(*given):
        held.append(ended[-1].equations is None)
        taken_over(*given)
        raise NotConverged("refused")

    monkeypatch.setattr(jumps.OverdampedMotion, "follow", followed)
    monkeypatch.setattr(jumps, "taken_over", refused)
    system = branch_of(heights(64), tmp_path / "heights.npy").corrector
    controls, load = (DISPLACEMENT,), np.array([START])
    state = states.undeformed(system.contact, controls, load)
    begin = system.solve(state, controls, load, COLD)
    for large in (True, False):
        monkeypatch.setattr(krylov, "LARGE", 1000 if large else 10 ** 6)
        held, ended = [], []
        end = jumps.settle(system, lambda: begin.state, controls, load + 0.01, "there")
        assert held == [large] * 5 and end.residual_norm <= 1e-8
        found.append((end.state.displacement, ended[-1].steps))
    np.testing.assert_array_equal(*(displacement for displacement, _ in found))
    assert found[0][1] == found[1][1]


@pytest.mark.parametrize("norms, reason", [
    ([1.0, 0.8], "DIVERGED_DTOL"), ([1.0, 0.6], "ITERATING"), ([1.0, 0.6, 0.55], "DIVERGED_DTOL"),
    ([1.0, 0.1, 0.2, 0.09], "ITERATING"), ([1.0, 0.1, 0.2, 0.11], "DIVERGED_DTOL"),
    ([1.0, 0.1, 1e-3], "ITERATING"), ([1.0, 0.1, 1e-9], "CONVERGED_FNORM_ABS")])
def test_patience_ends_where_a_residual_does_not_fall(norms, reason):
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setTolerances(atol=1e-8, rtol=0.0, stol=0.0)
    reasons, patience = PETSc.SNES.ConvergedReason, Patience()
    for short in (True, False):
        patience.short = short
        found = [patience.test(snes, iteration, (1.0, 1.0, norm))
                 for iteration, norm in enumerate(norms)]
        assert found[:-1] == [reasons.ITERATING] * (len(norms) - 1)
        lost = reason == "DIVERGED_DTOL" and not short
        assert found[-1] == (reasons.ITERATING if lost else getattr(reasons, reason))
    snes.destroy()


def test_the_force_form_ends_by_displacements_where_residuals_are_watched():
    """A solve that ended by the norm of its forces would be refused as a point, and each step be
    made shorter, again and again."""
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", rough_slope=2.0, rough_hurst=0.8,
                  rough_longest=6.0, rough_shortest=1.5, points=32, period=12.0, normal_maugis=2.0)
    load = Load(start="normal_displacement=0.5", path="normal_displacement=0.8")
    steps = Steps(initial_step=0.1, largest_step=0.1)
    found = [[(*point.displacements, *point.forces)
              for point in Branch(scene, load, steps, Form(form=form))]
             for form in ("displacement", "force")]
    assert len(found[0]) == 4 and np.allclose(*found, rtol=1e-6)


@pytest.mark.parametrize("part", np.geomspace(1e-10, 0.5, 40))
def test_a_first_linear_system_is_solved_as_far_as_two_iterations_need(part):
    first = first_forcing(part, rtol_0=0.1, gamma=0.5, alpha=1.6, version=2)
    furthest, least = (each * 0.5 * each ** 1.6 for each in (FURTHEST, 0.1))
    assert first * 0.5 * first ** 1.6 == pytest.approx(part if furthest < part < least else least)


def test_motions_spread_to_spots_far_apart(monkeypatch):
    """From one spot to several boxes of nodes, as on all nodes."""
    monkeypatch.setattr(clusters, "OF_NODES", 2.0)
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", rough_slope=6.0,
                  rough_shortest=6.0, rough_longest=50.0, rough_seed=2, points=96, period=100.0,
                  normal_maugis=2.0, height=float("inf"))
    load = Load(start="normal_displacement=-40", path="normal_force=5")
    found = []
    for window in ("auto", "off"):
        branch = Branch(scene, load, form=Form(window=window))
        points = list(branch)
        assert "jump" in [point.event for point in points]
        found.append((max(len(point.state.window.parts) for point in points),
                      branch.observe(points[-1])))
    (several, boxes), (one, everywhere) = found
    assert several > 1 == one
    for name in ("normal_displacement", "contact_area"):
        assert boxes[name] == pytest.approx(everywhere[name], rel=1e-7)


@pytest.mark.parametrize("force", [-5.85, -5.9])
def test_a_force_that_begins_where_it_does_not_hold_the_body_leads_away_from_there(force):
    """Pulled beyond the largest attraction by the displacement, and then by a force: what that
    lets go of jumps onto the stable branch, or off, and is not followed along the unstable one."""
    sphere = Scene(dimension=2, points=32, period=8.0, normal_maugis=1.0, geometry="sphere",
                   height=np.inf)
    branch = Branch(sphere, Load("normal_displacement=0", f"normal_force={force}"),
                    Steps(initial_step=0.2, largest_step=0.5, locate_folds=False),
                    Form(symmetry="off"))
    points = []
    try:
        points.extend(branch)
    except NoEquilibrium:
        assert force < points[0].forces[0]
    else:
        first, fold, jump = points[:3]
        assert (fold.event, jump.event) == ("fold", "jump")
        assert jump.displacements[0] > first.displacements[0] + 0.01
        assert points[-1].forces[0] == force
    # only the mark of where the leg begins says that it is not stable
    assert all((point.stable == 0) == (point.event == "fold"
                                       and point.forces[0] == points[0].forces[0])
               for point in points)


@pytest.mark.parametrize("stability", ["off", "sign"])
def test_where_a_leg_begins_unstable_under_its_force_is_no_limit_point(stability, tmp_path):
    """Between what a force and what a displacement holds: the body leaves where the force takes
    over, of which displacements nearby tell that it falls as the body comes near."""
    x = 2 * np.pi * np.arange(16) / 16
    np.save(tmp_path / "heights.npy", -3.0 * np.add.outer(np.cos(x - 0.3), 0.7 * np.cos(x)
                                                          + 0.2 * np.sin(2 * x)))
    plane = Scene(dimension=2, points=16, period=10.0, normal_maugis=1.0, geometry="file",
                  geometry_file=str(tmp_path / "heights.npy"))

    def points(path, said=None):
        branch = Branch(plane, Load("normal_displacement=-2", path),
                        Steps(stability=stability), Form(form="force"),
                        log=(said if said is not None else []).append)
        return list(branch)

    held = points("normal_displacement=-1.9")
    assert held[-1].forces[0] < held[0].forces[0] - 0.1 and held[0].stable != 0
    said = []
    first, fold, jump, *others = points("normal_force=2", said)
    assert (fold.event, fold.stable, fold.unstable_modes) == ("fold", 0, 1)
    assert fold.forces == first.forces
    assert jump.event == "jump" and jump.displacements[0] > first.displacements[0] + 1.0
    assert [sentence for sentence in said if "no limit point" in sentence]
    assert all(point.stable != 0 for point in (jump, *others))


def test_predictions_on_steep_planes_do_not_follow_edges_astray(monkeypatch):
    """Few spots, of heights that change by many ranges from node to node: what follows their edges
    leads far off, is not taken, and no step is refused."""
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", period=24.0, rough_longest=6.0,
                  rough_shortest=0.75, rough_slope=20.0, rough_seed=3, normal_maugis=2.0,
                  points=256)
    load = Load(start="normal_displacement=0.5", path="normal_displacement=4")
    said = []
    monkeypatch.setattr(fronts, "FILLED", 0.0)  # which leaves most of them out
    points = list(Branch(scene, load, log=said.append))
    assert len(points) == 22 and not any("failed" in sentence for sentence in said)
    monkeypatch.setattr(combining, "STEEP", np.inf)
    list(Branch(scene, load, log=said.append))
    assert any("failed" in sentence for sentence in said)
