"""Jumps: overdamped motion is the one that its equations say, comes to rest where others do, and
its works balance."""

import gc
import re
import tracemalloc

import numpy as np
import petsc4py
import pytest
from petsc4py import PETSc
from scipy.integrate import solve_ivp

petsc4py.init()
from contactsnes import Branch, Contact, Form, Load, NoEquilibrium, NotConverged, Scene, Steps
from contactsnes.branch import first_points
from contactsnes.contact import acceptance, states
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.symmetry import Symmetry
from contactsnes.dynamics import control, jumps, outside, relaxing
from contactsnes.dynamics.control import Exactness
from contactsnes.dynamics.endings import Leaving, Rounds, Unsettled
from contactsnes.dynamics.overdamped import MotionOptions, OverdampedMotion
from contactsnes.dynamics.step_works import Moment, combined, gone_on
from contactsnes.grid.counter import weighed
from contactsnes.kernels import library
from contactsnes.solvers.capabilities import NEWTON
from contactsnes.solvers.regularised import RegularisedStep

LINE = {"points": 512, "period": 20.0, "normal_maugis": 3.0, "height": float("inf")}
LAYER = {**LINE, "height": 10.0, "poisson": 0.4, "tangential_maugis": 1.5, "residual_friction": 0.5}
D, F = "displacement", "force"
COUNTS = ("linear_iterations", "function_evaluations", "jacobian_products")


class Watched(OverdampedMotion):
    """A motion that remembers where it was."""

    def __init__(self, *arguments):
        self.seen = []
        super().__init__(*arguments)

    def _account(self, moment, step):
        super()._account(moment, step)
        self.seen.append((moment.time, self.equations, moment))


def flow(contact, controls, load, state, tolerance=0.005, even=True, cls=Watched, steps=3000):
    symmetry = Symmetry(contact, Form(symmetry="auto" if even else "off"), NEWTON,
                        lambda sentence: None)
    return cls(contact, symmetry, controls, np.array(load),
               symmetry.centred(states.fitted(contact, state)), dict.fromkeys(COUNTS, 0),
               MotionOptions(tolerance=tolerance, steps=steps))


def lifted(contact, controls, load, by, slip=0.0):
    """The undeformed body at loads, off balance: lifted by ranges, slipped by others."""
    state = states.undeformed(contact, controls, np.array(load))
    displacement, means = state.displacement.copy(), state.means.copy()
    displacement[0] += by
    displacement[1:] += slip
    means[0] += by
    means[1:] += slip
    return states.State(state.window, displacement, means)


class OnTheCell:
    """M u' = -(K u + t) over the whole cell by dense matrices, M = ``mass`` (K) for the waves."""

    def __init__(self, contact, controls, load, mass="creep"):
        self.contact = contact
        self.count = len(controls)
        size = contact.grid.size
        self.shape = (self.count, size)
        blocks = contact.operator(self.count, "stiffness").blocks
        nodes = np.arange(size)
        matrix = np.zeros((self.count * size, self.count * size))
        for (i, j), block in blocks.items():
            column = np.fft.irfft(block * size, size)
            matrix[i * size:(i + 1) * size,
                   j * size:(j + 1) * size] = column[(nodes[:, None] - nodes) % size]
        self.stiffness, compliance = matrix, contact.rigid_compliance(self.count)
        self.forced = np.array([control == F for control in controls])
        self.springs = np.array([0.0 if forced or not c else 1.0 / c
                                 for forced, c in zip(self.forced, compliance)])
        self.moves = self.forced | (compliance > 0.0)
        self.far, self.load = contact.far_displacement(self.count, np.array(load)), np.array(load)
        own = np.kron(np.eye(self.count), np.full((size, size), 1.0 / size))
        if mass == "creep":
            self.mobility = np.linalg.pinv(matrix, rcond=1e-11)
            means = 1.0 / contact.mean_mass(self.count)
        else:
            self.mobility, means = (np.eye(len(matrix)) - own), np.ones(self.count)
        self.means = means

    def rate(self, _, unknown):
        field = unknown.reshape(self.shape)
        gap = field.copy()
        gap[0] += self.contact.initial_gap
        traction, mean = self.contact.law.traction(gap), field.mean(axis=1)
        force = self.stiffness @ unknown + traction.reshape(-1)
        target = np.where(self.forced,
                          self.load / (self.contact.load_factor(self.count) * self.shape[1]), 0.0)
        drift = -self.means * (self.springs * (mean - self.far) + traction.mean(axis=1)
                               - target) * self.moves
        return (drift[:, None] - (self.mobility @ force).reshape(self.shape)).reshape(-1)


@pytest.mark.parametrize("changes, controls, load, by, slip, even",
                         (({}, (D,), (-1.0,), 0.0, 0.0, True), ({}, (D,), (-1.0,), 0.0, 0.0, False),
                          ({}, (F,), (0.5,), 1.0, 0.0, True), (LAYER, (D, D), (1.0, 20.0), 0.0, 0.5,
                                                               False),
                          pytest.param(LAYER, (F, F), (1.0, 1.2), 0.5, 0.1, False,
                                       marks=pytest.mark.study)))
def test_the_motion_is_that_of_its_equations(changes, controls, load, by, slip, even):
    contact = Contact(Scene(**{**LINE, **changes, "points": 128}))
    start = lifted(contact, controls, load, by, slip)
    whole = OnTheCell(contact, controls, load)
    apart = []
    for tolerance in (0.01, 0.0005):
        motion = flow(contact, controls, load, start, tolerance, even)
        motion.follow()
        moments = [seen for seen in motion.seen if 0.3 < seen[0] < 12.0][::2]
        assert len(moments) > 3
        begin = contact.extended(flow(contact, controls, load, start, tolerance,
                                      even).state()).reshape(-1)
        exact = solve_ivp(whole.rate, (0.0, moments[-1][0]), begin, "LSODA",
                          [seen[0] for seen in moments], rtol=1e-8, atol=1e-8)
        worst = 0.0
        for (_, equations, moment), cell in zip(moments, exact.y.T):
            found = equations.unfolded(equations.displacement(moment.unknown))
            other = equations.window.take(cell.reshape(len(controls), -1))
            near = found[0] + equations.window.take(contact.initial_gap) < 10.0
            worst = max(worst, np.abs(found - other)[:, near].max())
        apart.append(worst)
    # Steps of second order: the error of a moment falls as the tolerance to the power 2/3.
    assert apart[0] < 0.2 and apart[1] < 0.3 * apart[0], apart


@pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
def test_a_step_of_a_motion_takes_few_arrays_besides_its_solve():
    """Of three components: the guess, while the system is made, and again for what the step leads
    to; not the spectra that a product of all waves at once would take, nor a gap."""
    contact = Contact(Scene(dimension=2, geometry="flat", points=96, period=12.0,
                            height=float("inf"), normal_maugis=2.0, tangential_maugis=1.0))
    controls, load = (D, D, D), (1.0, 0.2, 0.0)
    motion = flow(contact, controls, load, lifted(contact, controls, load, 0.5, 0.1), even=False)
    equations, unknown = motion.equations, motion.history[-1].unknown

    def step():
        return equations.newton(lambda: unknown.copy(), 2.0, 1.5 * unknown, Exactness(0.1, 1e-6))[0]

    step()  # what the first one makes is kept
    tracemalloc.start()
    try:
        found = step()
        most = tracemalloc.get_traced_memory()[1] / found.nbytes
    finally:
        tracemalloc.stop()
    assert most < 3.2 and "spectrum" not in vars(equations.form.convolution.transform)


def test_histories_tell_sums_of_moments_in_less_memory():
    random = np.random.default_rng(3)
    moments = [Moment(time, *(1.0 + 1e-5 * time * random.normal(size=(2, 50))))
               for time in (0.0, 1.0, 2.5, 3.0)]
    history = moments[:1]
    for moment in moments[1:]:
        history = gone_on(history, moment)
    assert [one.time for one in history] == [1.0, 2.5, 3.0] and history[-1] is moments[-1]
    assert history[0].elastic is None and history[0].unknown.dtype == np.float32
    assert history[1].elastic.dtype == np.float32
    weights = [0.5, -2.0, 2.5]
    for name, known in (("unknown", 3), ("elastic", 2)):
        exact = sum(weight * getattr(moment, name)
                    for weight, moment in zip(weights[-known:], moments[-known:]))
        found = combined(history[-known:], weights[-known:], name)
        np.testing.assert_allclose(found, exact, rtol=0, atol=5e-11)
    assert np.array_equal(combined(history[-1:], [2.0]), 2.0 * moments[-1].unknown)


# Where jumps end

JUMPS = {"jump-in": ({}, "normal_displacement=-3", "normal_displacement=0"),
         "jump-in under a force": ({}, "normal_displacement=-3", "normal_force=0.5"),
         "pull-off": ({}, "normal_displacement=0.5", "normal_displacement=-4.5"),
         "sliding": ({"height": 2000.0, "residual_friction": 0.0}, "normal_displacement=2",
                     "tangential_displacement=1000"),
         "sliding against friction": ({"height": 2000.0, "residual_friction": 0.5},
                                      "normal_displacement=2", "tangential_displacement=1000"),
         "sphere": ({"dimension": 2, "geometry": "sphere", "points": 64, "period": 8.0,
                     "normal_maugis": 4.0}, "normal_displacement=0.5", "normal_displacement=-3"),}


def followed(name, **form):
    """The points of a jump's path up to the jump, its branch, and what it says."""
    changes, start, path = JUMPS[name]
    sentences = []
    branch = Branch(Scene(**{**LINE, "period": 40.0, "points": 1024, **changes}),
                    Load(start=start, path=path), form=Form(**form), log=sentences.append)
    points = []
    for point in branch:
        points.append(point)
        if point.event == "jump":
            return branch, points, sentences
    raise AssertionError("no jump")


@pytest.fixture(scope="module")
def jumped():
    return {name: followed(name) for name in JUMPS}


def same(branch, point, other, within=1e-6):
    numbers, others = branch.observe(point), branch.observe(other)
    for name in ("normal_force", "approach", "contact_area", "maximum_pressure"):
        assert numbers[name] == pytest.approx(others[name], rel=within, abs=within), name


@pytest.mark.parametrize("name", JUMPS)
def test_inertia_ends_in_the_same_state_at_a_higher_price(name, jumped, options):
    branch, points, sentences = jumped[name]
    assert not [sentence for sentence in sentences if "led back" in sentence
                or "cannot be followed" in sentence]
    options(jump_motion_type="inertial")
    other, found, _ = followed(name)
    same(branch, points[-1], found[-1])
    assert points[-1].spent["transforms"] < (0.5 if "under" not in name
                                             else 0.9) * found[-1].spent["transforms"]
    assert np.isnan(found[-1].viscous_work)


@pytest.mark.parametrize("name", JUMPS)
@pytest.mark.parametrize("changes", ({"kick": 0.01, "tolerance": 0.05},
                                     {"kick": 0.5, "tolerance": 0.001}), ids=str)
def test_the_end_does_not_depend_on_kick_and_tolerance(name, changes, jumped, options):
    options(**{f"jump_motion_{key}": value for key, value in changes.items()})
    branch, points, _ = jumped[name]
    same(branch, points[-1], followed(name)[1][-1])


@pytest.mark.parametrize("name", [name for name in JUMPS if "under" not in name])
def test_works_of_a_jump_balance(name, jumped, options):
    """Work of the loads, stored energy, work on the interface and against viscosity: each on its
    own, along the motion."""
    errors = []
    options(jump_motion_tolerance=0.0005)
    for found, tolerance in ((jumped[name][1], 0.005), (followed(name)[1], 0.0005)):
        before, after = found[-2:]
        external, interface = (getattr(after, work) - getattr(before, work)
                               for work in ("external_work", "interface_work"))
        if after.jump_balance == "potential":
            assert after.jump_work == pytest.approx(interface, rel=0.1 * tolerance)
        left = external - (after.elastic_energy - before.elastic_energy) - after.jump_work
        errors.append(abs(left - after.viscous_work) / after.viscous_work)
        assert after.viscous_work > 0.0
    assert errors[0] < 0.03 and errors[1] < 0.006, errors


def test_a_kick_spoils_no_work_where_the_law_bends_within_it():
    """At the kick's end the body carries what balances it, not yet what such a law draws by: the
    work against viscosity is known as the energy that is lost, which this law has."""
    scene = Scene(points=256, period=40.0, normal_maugis=4.0, law="dugdale", dugdale_width=0.1)
    points = list(Branch(scene, Load(path="normal_displacement=1; normal_displacement=-4.5")))
    jumps = [k for k, point in enumerate(points) if point.event == "jump"]
    assert len(jumps) > 2
    for k in jumps:
        lost = points[k].dissipated_work - points[k - 1].dissipated_work
        assert points[k].jump_balance == "potential"
        assert points[k].viscous_work == pytest.approx(lost, rel=0.1), k


@pytest.mark.parametrize("name, kernels", [
    *((name, "auto") for name in ("jump-in under a force", "pull-off", "sliding", "sphere")),
    ("jump-in under a force", "off"),
    *(pytest.param(name, "off", marks=pytest.mark.study)
      for name in ("pull-off", "sliding", "sphere"))])
def test_motions_in_single_precision_end_in_the_same_state(name, kernels, jumped):
    """... after the same steps, with the same works; only linear solves are in it."""
    _, expected, _ = jumped[name]
    branch, found, _ = followed(name, linear_precision="single", kernels=kernels)
    jump, other = found[-1], expected[-1]
    same(branch, jump, other)
    for work in ("jump_work", "viscous_work"):
        assert getattr(jump, work) == pytest.approx(getattr(other, work), rel=1e-4, nan_ok=True)
    # Newton's solves from afar on such grids are in double: what is single is the motion's
    assert other.spent["transforms_single"] == 0.0 < jump.spent["transforms"]
    assert jump.spent["transforms_single"] > 0.2 * other.spent["transforms"]
    assert jump.spent["linear_iterations"] == pytest.approx(other.spent["linear_iterations"],
                                                            rel=0.1)


def test_works_on_the_interface_are_known_from_out_of_the_laws_range_on(jumped):
    """... those against viscosity, which the start within it leaves out, are not."""
    before, jump = jumped["jump-in under a force"][1][-2:]
    assert jump.jump_work == pytest.approx(jump.interface_work - before.interface_work, rel=1e-3)
    assert np.isnan(jump.viscous_work)


@pytest.mark.parametrize("law, poisson, slip", [
    pytest.param("modified", 0.5, 1.0, marks=pytest.mark.study), ("mcgarry", 0.0, 0.0),
    pytest.param("dugdale", 0.3, 1.5, marks=pytest.mark.study)])
def test_a_jump_from_out_of_the_laws_range_loses_what_motion_from_afar_does(law, poisson, slip):
    """No potential tells, and slip goes back on the way, far before the body is one range away."""
    scene = Scene(points=48, period=12.0, height=10.0, poisson=poisson, normal_maugis=1.5, law=law,
                  residual_friction=0.5, dugdale_width=0.4)
    load = Load(f"normal_displacement=-10, tangential_displacement={slip}", "normal_force=0.001")
    points = list(Branch(scene, load))
    number = [point.event for point in points].index("jump")
    fold, jump = points[number - 1:number + 1]
    contact, far = Contact(scene), 6.0 if law == "dugdale" else 9.0
    whole = OnTheCell(contact, (F, D), (0.0, slip))
    start = np.repeat([[far], [slip]], 48, axis=1)

    def rate(time, known):
        moved, gap = whole.rate(time, known[:-1]), known[:-1].reshape(2, -1).copy()
        gap[0] += contact.initial_gap
        return np.append(moved, contact.law.traction(gap).reshape(-1) @ moved)

    end = solve_ivp(rate, (0.0, 1e6), np.append(start, 0.0), "LSODA", [1e6], rtol=1e-6,
                    atol=1e-8).y[:, 0]
    rest = jump.state.window.take(end[:-1].reshape(2, -1))
    np.testing.assert_allclose(rest, jump.state.displacement, atol=1e-4)
    lost = fold.elastic_energy - jump.elastic_energy - contact.grid.node_area * end[-1]
    assert jump.jump_balance == "motion"
    assert jump.dissipated_work - fold.dissipated_work == pytest.approx(lost, rel=5e-3)


def test_a_jump_as_short_as_its_kick_loses_what_motion_from_the_fold_does(monkeypatch):
    """No potential tells: edges that a coarse grid pins move on by a node, and another way there
    than the motion's, as the kick's, takes another loss."""
    scene = Scene(points=64, period=16.0, normal_maugis=2.0, tangential_maugis=3.0,
                  height=float("inf"), residual_friction=0.2)
    branch = Branch(scene, Load("normal_displacement=1",
                                "normal_force=3; tangential_displacement=8"))
    path, points = iter(branch), []
    while not points or points[-1].event != "jump":
        points.append(next(path))
    (fold, jump), contact = points[-2:], branch.contact
    assert states.missed(contact, fold.state, jump.state) < 1.5 * MotionOptions().kick
    whole = OnTheCell(contact, fold.controls, fold.load)

    def gap(displacement):
        known = displacement.reshape(2, -1).copy()
        known[0] += contact.initial_gap
        return known

    def rate(time, known):
        moved = whole.rate(time, known[:-1])
        return np.append(moved, contact.law.traction(gap(known[:-1])).reshape(-1) @ moved)

    first, start, last = (contact.extended(state).reshape(-1) for state in (
        fold.state, branch.corrector.kicked(fold, None, 0.05), jump.state))
    end = solve_ivp(rate, (0.0, 1e3), np.append(start, 0.0), "LSODA", [1e3], rtol=1e-6,
                    atol=1e-9).y[:, 0]
    np.testing.assert_allclose(end[:-1], last, atol=1e-4)
    tractions = contact.law.traction(gap(first)) + contact.law.traction(gap(start))
    done = end[-1] + 0.5 * tractions.reshape(-1) @ (start - first)
    lost = (jump.external_work - fold.external_work - jump.elastic_energy + fold.elastic_energy
            - contact.grid.node_area * done)
    assert jump.jump_balance == "motion"
    assert jump.dissipated_work - fold.dissipated_work == pytest.approx(lost, rel=0.01)
    assert jump.viscous_work == pytest.approx(lost, rel=0.05)
    # The motion of a smaller jump may be slower than what else counts as rest.
    monkeypatch.setattr(jumps, "RESTS", (1e3, *jumps.RESTS[1:]))
    system = branch.corrector
    slow = jumps.left(system, system.kicked(fold, None, 1.0), fold.controls, fold.load, "there",
                      fold.state)
    assert slow.viscous_work == pytest.approx(jump.viscous_work, rel=1e-3)


def test_a_kick_is_along_the_null_vector(options):
    branch, points, _ = followed("sliding against friction")
    fold = points[-2]
    options(jump_motion_kick=0.2)
    for part in (0.5, 1.0, -1.0):
        aside = branch.corrector.kicked(fold, None, part)
        assert states.missed(branch.contact, fold.state, aside) == pytest.approx(0.2 * abs(part),
                                                                                 rel=1e-6)
        way = aside.displacement - states.onto(fold.state, aside.window)
        null = fold.tangents[-1].state.displacement
        assert part * np.sum(way * null) > 0.999 * abs(part) * np.linalg.norm(way) * np.linalg.norm(
            null)


# Solves that leave as much as moves

@pytest.mark.parametrize("ended, left", (("CONVERGED_ATOL", (1e-2, 1.25e-7)),
                                         ("CONVERGED_RTOL", (1.25e-3, 1e-6)),
                                         ("CONVERGED_ITS", (1e-2, 1e-6))))
def test_solves_leave_less_of_what_ended_them_where_steps_stall(ended, left):
    exactness, reason = Exactness(1e-2, 1e-6), getattr(PETSc.KSP.ConvergedReason, ended)
    for stalled in (True, True, True, False, True, True, True):
        exactness.after(stalled, reason)
    assert (exactness.part, exactness.left) == (1e-2, 1e-6)
    for _ in range(3):
        exactness.after(True, reason)
    assert (exactness.part, exactness.left) == left
    for _ in range(20):
        exactness.after(True, reason)
    assert exactness.part >= min(1e-4, left[0])


def test_what_relative_tolerances_leave_does_not_keep_a_motion_up(monkeypatch):
    """A tenth of each right side, which the parabola through the last states makes as much again:
    steps of a sheared rough plane stayed as long as they were, until they were given up."""
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", rough_longest=6.0,
                  rough_shortest=2.0, rough_slope=8.0, rough_seed=1, points=64, period=12.0,
                  poisson=0.3, normal_maugis=1.0)
    load = Load(start="normal_displacement=1", path="tangential_displacement_x=1")
    loose, found = control.SHEARED_FREELY._replace(exactness=0.1), {}
    for name, used in (("loose", loose), ("own", control.SHEARED_FREELY)):
        monkeypatch.setattr(control, "SHEARED_FREELY", used)
        monkeypatch.setitem(control.CAREFUL, used, used)
        found[name] = next(iter(Branch(scene, load)))
    np.testing.assert_allclose(found["loose"].forces, found["own"].forces, rtol=1e-5, atol=1e-7)
    assert found["loose"].spent["function_evaluations"] < 200  # 1500 where solves leave no less


@pytest.mark.study
def test_what_solves_leave_does_not_keep_a_motion_up():
    """A sphere on a grid that pins its edge: whether rounding kept its motion on for a thousand
    steps was chance, and differed between compiled kernels and NumPy."""
    scene = Scene(dimension=2, points=512, period=12.0, geometry="sphere", normal_maugis=11.3)
    branch = Branch(scene, Load(start="normal_displacement=1", path="normal_displacement=1.1"))
    assert next(iter(branch)).spent["function_evaluations"] < 300


def test_jumps_of_a_sheared_rough_plane_end_where_exact_motion_does(monkeypatch):
    """Their works are those of more exact motion to a hundredth, at two thirds of what motion
    takes elsewhere."""
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", rough_hurst=0.8,
                  rough_longest=6.0, rough_shortest=1.5, rough_slope=1.0, rough_seed=5, points=32,
                  period=12.0, height=float("inf"), normal_maugis=1.0, tangential_maugis=1.5,
                  residual_friction=0.2)
    load = Load(start="normal_displacement=1", path="tangential_displacement_x=0.4")
    found = {}
    for name, used in (("own", control.SHEARED), ("elsewhere", control.FOLLOWED),
                       ("exact", control.Control(0.02, 0.1, 1e-5, 1e-5))):
        monkeypatch.setattr(control, "SHEARED", used)
        points = list(Branch(scene, load, Steps(initial_step=0.5, largest_step=0.5)))
        found[name] = [point for point in points if point.event == "jump"]
    costs = {name: sum(weighed(point.spent) for point in points) for name, points in found.items()}
    assert 0.0 < costs["own"] < 0.75 * costs["elsewhere"]
    for told, true in zip(found["own"], found["exact"], strict=True):
        np.testing.assert_allclose(told.forces, true.forces, rtol=1e-3, atol=1e-3)
        assert told.jump_work == pytest.approx(true.jump_work, rel=2e-3)
        assert told.viscous_work == pytest.approx(true.viscous_work, rel=0.01, abs=5e-4)


def test_jumps_of_even_bumps_that_are_sheared_stay_even():
    """Linear systems of all nodes that are hardly solved would leave what is not."""
    scene = Scene(dimension=2, geometry="sinusoid", points=32, period=12.0, height=float("inf"),
                  normal_maugis=0.5, tangential_maugis=2.0, residual_friction=0.2)
    load, said = Load(start="normal_displacement=1", path="tangential_displacement_x=60"), []
    points = iter(Branch(scene, load, log=said.append))
    assert next(point for point in points if point.event == "jump").displacements[1] < 3.0
    assert not [sentence for sentence in said if "without symmetry" in sentence]


# Motions without rest

def turned(shrinks, angle=0.25, steps=400, drifts=0.0):
    """Number of the step at which a spiral is found to be a cycle, and the period; None where it
    is not."""
    rounds, last = Rounds(), None
    for step in range(steps):
        turn, radius = step * angle, np.exp(-shrinks * step)
        unknown = radius * np.array([np.cos(turn), np.sin(turn)]) + drifts * step
        moment = Moment(0.5 * step, unknown)
        moved = 0.0 if last is None else np.linalg.norm(unknown - last)
        last = unknown
        if rounds.closed(moment, moved, np.linalg.norm):
            return step, rounds.period
    return None


def test_a_motion_that_goes_round_is_told_from_one_that_comes_to_rest():
    step, period = turned(0.0)
    assert 64 + 3 * 2.0 * np.pi / 0.25 < step < 256
    assert period == pytest.approx(0.5 * 2.0 * np.pi / 0.25, rel=0.03)
    for spiral in ({"shrinks": 2e-3}, {"shrinks": 0.0, "drifts": 0.1}, {"shrinks": 0.02},
                   {"shrinks": -2e-3}, {"shrinks": -0.01}):  # (from an unstable state elsewhere)
        assert turned(**spiral) is None


@pytest.mark.study
def test_friction_may_keep_a_motion_up_for_ever():
    """Explicit steps of Heun's method, of 0.012 relaxation times each, come back to where they were
    at the time 200 within 0.0043 ranges after 124.5."""
    scene = Scene(dimension=2, geometry="rough", rough_on="flat", rough_longest=6.0,
                  rough_shortest=1.5, rough_slope=0.905, rough_seed=22, points=64, period=24.0,
                  poisson=0.3, normal_maugis=1.424, height=float("inf"))
    branch = Branch(scene, Load("normal_displacement=0", "tangential_displacement_x=1"))
    rest = next(iter(branch)).state
    with pytest.raises(NotConverged, match="come to rest: it goes round and round") as told:
        jumps.settle(branch.corrector, lambda: rest, (D,) * 3, np.array([0.0, 0.5, 0.0]), "here")
    (period,) = re.findall(r"every ([\d.]+) relaxation times", str(told.value))
    assert float(period) == pytest.approx(124.5, rel=0.02)


# Other masses

@pytest.mark.parametrize("mass", ("creep", "drag"))
@pytest.mark.parametrize("name", ("jump-in", "pull-off", "sliding"))
def test_other_masses_end_in_the_same_state(name, mass):
    """M = 1 for every wave and every mean (a drag on each node of the interface) instead of M = K,
    on the cell, by SciPy."""
    changes, start, path = JUMPS[name]
    size = {"points": 64, "normal_maugis": 2.0,
            "height": 20.0} if name == "sliding" else {"points": 128, "normal_maugis": 3.0}
    changes = {**changes, "period": 20.0, **size}
    branch = Branch(Scene(**{**LINE, **changes}), Load(start=start, path=path))
    for point in branch:
        if point.event == "fold":
            fold = point
        if point.event == "jump":
            break
    assert point.event == "jump"
    contact, count = branch.contact, len(fold.controls)
    whole = OnTheCell(contact, fold.controls, fold.load, mass)
    begin = contact.extended(fold.state).reshape(count, -1)
    direction = contact.extended(point.state).reshape(count, -1) - begin
    begin += 0.3 * direction / np.abs(direction).max()
    end = solve_ivp(whole.rate, (0.0, 1e5), begin.reshape(-1), "LSODA", rtol=1e-6,
                    atol=1e-8).y[:, -1]
    found = contact.extended(point.state).reshape(count, -1)
    assert np.abs(end.reshape(count, -1) - found).max() < 1e-2


# Ends and failures

@pytest.mark.parametrize("changes", [{}, {"geometry": "flat"}, {"tangential": "on", "height": 50.0,
                                                                "residual_friction": 0.5}])
def test_a_body_off_the_flat_lets_go_where_its_force_vanishes(changes):
    """Within the law's range it is attracted, the less the farther away: the fold is at no force,
    whatever the steps."""
    found = []
    for times in (1.0, 4.0):
        steps = Steps(initial_step=times / 40.0, largest_step=times / 20.0)
        scene = Scene(**{**LINE, "points": 128, **changes})
        branch = Branch(scene, Load(start="normal_displacement=-3", path="normal_force=0.5"), steps)
        points = list(branch)
        fold, jump = (next(point for point in points if point.event == event)
                      for event in ("fold", "jump"))
        assert points[0].forces[0] < -1e-4 and not fold.in_contact
        assert (fold.load[0] == fold.forces[0] == jump.load[0] == 0.0
                and fold.fold_kind == "jump_in" and jump.in_contact)
        # Nothing is lost on the way out, which no polynomial through the points could tell.
        before = points[[point.event for point in points].index("fold") - 1]
        stored = [point.elastic_energy + point.interfacial_energy for point in (before, fold)]
        assert fold.external_work - before.external_work == pytest.approx(stored[1] - stored[0],
                                                                          abs=1e-9)
        assert jump.dissipated_work > 0.1
        found.append((jump.displacements[0], jump.dissipated_work))
    assert found[0] == pytest.approx(found[1], rel=1e-6)


@pytest.mark.parametrize("stability", ["sign", "eigenvalue"])
def test_the_mode_of_a_free_body_fades_and_crosses_nothing(stability):
    """Off the flat a force holds no body: one unstable mode, whose eigenvalue goes with the force
    to zero and not through it."""
    steps = Steps(initial_step=1.0 / 40.0, largest_step=1.0 / 20.0, stability=stability)
    scene = Scene(**{**LINE, "points": 64, "geometry": "flat"})
    points = list(Branch(scene, Load(start="normal_displacement=-4",
                                     path="normal_force=-2e-6; normal_force=0.5"), steps))
    events = [point.event for point in points]
    assert "bifurcation" not in events and events.count("fold") == events.count("jump") == 1
    before = points[1:events.index("fold")]
    assert before and not any(point.stable for point in before)
    assert points[-1].stable and points[-1].forces[0] == 0.5


def test_a_first_step_along_the_arc_too_long_for_a_free_body_leads_to_its_fold():
    scene = Scene(**{**LINE, "points": 64, "geometry": "flat"})
    load = Load(start="normal_displacement=-3", path="normal_force=2")
    points = list(Branch(scene, load, Steps(type="arclength", initial_step=0.5, largest_step=0.5)))
    assert ([point.event for point in points if point.event] == ["fold", "jump"]
            and points[-1].forces[0] == 2.0)


def test_a_window_grows_with_the_motion():
    """The body at 30 ranges falls on the flat; on the whole cell it ends in the same state."""
    contact = Contact(Scene(**{**LINE, "points": 2048, "normal_maugis": 8.0}))
    motions = [flow(contact, (F,), (0.5,), lifted(contact, (F,), (0.5,), by))
               for by in (30.0, 30.0)]
    state, whole = motions[1].state(), contact.grid.whole
    motions[1]._begin(0.0, states.State(whole, states.onto(state, whole), state.means))
    begun = motions[0].equations.window.size
    for motion in motions:
        motion.follow()
    ended = [motion.state() for motion in motions]
    assert begun < ended[0].window.size < 0.5 * contact.grid.size and ended[1].window.is_whole
    assert states.missed(contact, *ended) < 1e-4


@pytest.mark.parametrize("height", (float("inf"), 10.0))
@pytest.mark.parametrize("path, scene", (("normal_force=-5", {}),
                                         ("tangential_force=30", {"residual_friction": 0.5})))
def test_a_body_that_leaves_or_slides_for_ever_is_named(path, scene, height):
    branch = Branch(Scene(**{**LINE, "period": 40.0, "points": 1024, "height": height, **scene}),
                    Load(start="normal_displacement=1", path=path))
    points = []
    with pytest.raises(NoEquilibrium, match="no equilibrium .* beyond the fold .*: "
                       "the body leaves, sinks in or slides without end"):
        for point in branch:
            points.append(point)
    assert points[-1].event == "fold" and branch.contact.grid.transforms < 3000


@pytest.mark.parametrize("motion", ("overdamped", "inertial"))
@pytest.mark.parametrize("type", ("natural", "arclength"))
def test_a_body_that_slip_has_left_no_repulsion_sinks_for_ever(options, motion, type):
    # 30 ranges of slip: exp(-900) of the law is left, nothing at all, in whatever overlap.
    options(jump_motion_type=motion)
    scene = Scene(**{**LINE, "points": 64, "period": 16.0, "normal_maugis": 1.5, "law": "mcgarry",
                     "tangential_maugis": 0.5})
    branch = Branch(scene, Load(start="normal_displacement=0, tangential_displacement=60",
                                path="normal_force=3"), steps=Steps(type=type))
    with pytest.raises(NoEquilibrium, match="no equilibrium at normal_force 3.*sinks in"):
        list(branch)
    assert branch.contact.grid.transforms < 8000


@pytest.mark.parametrize("force, slip", ((30.0, 1.0), (-1.0, 0.0)))
def test_motion_without_end_is_told_at_once(force, slip):
    contact = Contact(Scene(**{**LINE, "residual_friction": 0.5}))
    controls, load = ((D, F), (1.0, force)) if slip else ((F,), (-3.0,))
    with pytest.raises(Leaving):
        flow(contact, controls, load, lifted(contact, controls, load, 0.0, slip)).follow()


@pytest.mark.parametrize("force", (-0.5, -1e-3))
def test_what_slides_back_is_held_where_it_stuck(force):
    """Nothing holds a body that has slipped by 16 ranges and has no residual friction; pushed back
    it comes to where its friction carries the force, as from the undeformed state, however far a
    step that nothing bends would lead."""
    contact = Contact(Scene(**{**LINE, "residual_friction": 0.0}))
    controls, load = (F, F), (2.0, force)
    ended = []
    for slip in (16.0, 0.0):
        motion = flow(contact, controls, load, lifted(contact, controls, load, 0.0, slip))
        motion.follow()
        ended.append(motion.state())
    assert states.missed(contact, *ended) < 1e-4
    assert 0.0 < ended[0].means[1] / force < 10.0


def test_what_slides_while_contact_still_grows_does_not_slide_for_ever():
    """Lifted and slipped, the body hardly touches: friction carries the force once it has come
    down."""
    contact = Contact(Scene(**{**LAYER, "height": float("inf")}))
    controls = (F, F)
    load = (5.0, 0.3)
    motion = flow(contact, controls, load, lifted(contact, controls, load, 5.0, 12.0), even=False)
    motion.follow()
    assert states.normal_gap(contact, motion.state()).min() < 1.0


@pytest.mark.parametrize("farther", [outside.FARTHER, 0.0])
def test_a_spot_that_comes_into_range_is_taken_in_whenever_it_is_looked_for(farther, monkeypatch):
    """A second parabola, out of range at first, that a force brings to the flat; looked for after
    every step, or when nodes have moved far enough and when all rests."""
    x = (np.arange(2048) - 1024) * 80.0 / 2048
    heights = -np.minimum((x + 18) ** 2, (x - 18) ** 2 + 22.0) / 2
    scene = Scene(points=2048, period=80.0, normal_maugis=4.0, height=np.inf, geometry="file",
                  geometry_file="-")
    ends, spent = [], []
    for kept in (np.inf, farther):
        monkeypatch.setattr(outside, "FARTHER", kept)
        contact = Contact(scene, heights)
        motion = flow(contact, (F,), (30.0,), lifted(contact, (D,), (0.0,), 2.0),
                      even=False)
        begun = contact.grid.counter.transforms
        narrow = motion.equations.window
        motion.follow()
        assert motion.equations.window.total > narrow.total
        ends.append(motion.state())
        spent.append(contact.grid.counter.transforms - begun)
    assert states.missed(contact, *ends, largest=True) < 1e-3
    assert spent[1] < spent[0]


def test_a_fold_under_a_force_is_the_pull_off_that_a_path_stops_at():
    scene = Scene(**{**LINE, "period": 40.0, "points": 1024})
    points = list(Branch(scene, Load(start="normal_displacement=1", path="normal_force=-5",
                                     stop="pull_off")))
    assert (points[-1].event, points[-1].fold_kind) == ("fold", "pull_off")
    with pytest.raises(NoEquilibrium):
        list(Branch(scene, Load(start="normal_displacement=1", path="normal_force=-5",
                                stop="gross_sliding")))


ROUGH = {"period": 24.0, "points": 256, "height": float("inf"), "tangential": "off",
         "geometry": "file"}


def on_heights(tmp_path, heights, start, path, **changes):
    """The branch of a body with heights."""
    np.save(tmp_path / "heights.npy", heights)
    scene = Scene(**{**ROUGH, "geometry_file": str(tmp_path / "heights.npy"), **changes})
    return Branch(scene, Load(start=start, path=path))


def test_spots_that_let_go_one_by_one_under_a_force_are_followed_to_the_last(tmp_path, self_affine):
    """Beyond the first fold, whose spot lets go, there are equilibria at a greater pull."""
    heights, points = self_affine(256, 24.0, 12.0, 0.75, 2.0, 0), []
    branch = on_heights(tmp_path, heights, "normal_force=1", "normal_force=-20", normal_maugis=4.0)
    with pytest.raises(NoEquilibrium, match="no equilibrium at normal_force -20, beyond the fold"):
        for point in branch:
            points.append(point)
    folds = [point.forces[0] for point in points if point.event == "fold"]
    assert len(folds) > 1 and min(folds) == folds[-1] < 1.03 * folds[0]
    beyond = [point for point in points if point.forces[0] < folds[0]]
    assert beyond and all(point.in_contact and point.residual_norm <= 1e-8 for point in beyond)


def test_what_is_pressed_is_not_said_to_leave(tmp_path, self_affine):
    """From a state that a prescribed force does not hold: the branch ends, the body jumps, and
    reaches what a start reaches."""
    heights = self_affine(64, 12.0, 6.0, 1.5, 1.0, 1, dimension=2)
    changes = {"dimension": 2, "points": 64, "period": 12.0, "normal_maugis": 2.0, "height": 2000.0}
    branch = on_heights(tmp_path, heights, "normal_displacement=0", "normal_force=10", **changes)
    points = list(branch)
    assert [point.event for point in points if point.event] == ["fold", "jump"]
    direct = first_points.start(branch.corrector, (F,), np.array([10.0]))
    assert points[-1].displacements == pytest.approx(direct.displacements, rel=1e-6)


def test_inertia_that_carries_a_body_off_is_no_missing_equilibrium(jumped, options, monkeypatch):
    """Overdamped motion has the last word; where it cannot be followed nothing is said of
    equilibria."""
    branch, points, _ = jumped["pull-off"]
    fold, after = points[-2:]

    def leaves(*arguments):
        raise Leaving

    monkeypatch.setattr(jumps, "by_inertia", leaves)
    aside = branch.corrector.kicked(fold, None, 1.0)
    options(jump_motion_type="inertial")
    point = branch.corrector.settle(aside, fold.controls, fold.load, "here")
    np.testing.assert_allclose(point.forces, after.forces, rtol=1e-6, atol=1e-9)
    options(jump_motion_type="overdamped", jump_motion_steps=3)
    with pytest.raises(NotConverged, match="leaves, sinks in or slides without end .* with inertia "
                       "here, but the overdamped motion .* 3 steps"):
        branch.corrector.settle(aside, fold.controls, fold.load, "here")
    monkeypatch.setattr(relaxing, "relaxed", leaves)
    with pytest.raises(NotConverged, match="in the relaxation before the solve"):
        relaxing.nearer(branch.corrector, fold.state, fold.controls, fold.load, 1e-3)


def test_an_isolated_contact_jumps_in():
    scene = Scene(period=float("inf"), normal_maugis=5.0, tangential="off")
    points = list(Branch(scene, Load(path="normal_force=0.5")))
    direct = list(Branch(scene, Load(start="normal_force=0.6", path="normal_force=0.5")))
    assert [point.event for point in points[:3]] == [None, "fold", "jump"]
    assert points[-1].state.displacement.min() == pytest.approx(direct[-1].state.displacement.min(),
                                                                rel=1e-4)


def test_a_motion_that_is_not_followed_gives_way_to_inertia(options, jumped):
    branch, points, _ = jumped["pull-off"]
    options(jump_motion_steps=3)
    _, found, sentences = followed("pull-off")
    assert any("not come to rest after 3 steps" in sentence and "on the whole cell" in sentence
               for sentence in sentences)
    same(branch, points[-1], found[-1])


def test_a_normal_start_of_a_sheared_motion_gives_way_to_inertia_too(options):
    branch = Branch(Scene(**{**LINE, "residual_friction": 0.5}),
                    Load("normal_displacement=0", "tangential_displacement=0.1"))
    start, *_, sheared = branch
    options(jump_motion_steps=1)
    assert start.state.components == 1
    point = jumps.settle(branch.corrector, lambda: start.state, (D, D), sheared.load, "here")
    np.testing.assert_allclose(point.forces, sheared.forces, rtol=1e-6)


def test_steps_that_fail_are_named():
    contact = Contact(Scene(**LINE))
    motion = flow(contact, (D,), (1.0,), lifted(contact, (D,), (1.0,), 0.0))
    motion.equations.newton = lambda foretold, *_: (np.full_like(foretold(), np.nan), True)
    with pytest.raises(Unsettled, match="too short"):
        motion.follow()


def test_a_drift_that_never_ends_is_given_up():
    """A velocity that nothing stops, as of a body pulled by what is not recognised."""
    contact = Contact(Scene(**LINE))
    motion = flow(contact, (F,), (-3.0,), lifted(contact, (F,), (-3.0,), 40.0))
    motion.equations.leaving = lambda *_: None
    with pytest.raises(Unsettled, match="not come to rest"):
        motion.follow()


@pytest.mark.parametrize("away", [0.5, 2.0])
def test_a_body_off_the_flat_is_where_its_motion_led(away, monkeypatch):
    """There the law hardly acts, and the balance hardly tells one place from another."""
    system = Branch(Scene(**{**LINE, "points": 64}), Load(path="normal_displacement=1")).corrector
    rest = states.apart(system.contact)
    found = states.State(rest.window, rest.displacement + away, rest.means + away)
    point = system.solve(found, (F,), np.array([0.0]))
    monkeypatch.setattr(system, "solve", lambda *_: point)
    assert not point.in_contact and states.missed(system.contact, rest, point.state) == 0.0
    if away < 1.0:
        assert jumps.polished(system, lambda: rest, (F,), np.array([0.0])) is point
    else:
        with pytest.raises(NotConverged, match="not where the motion led"):
            jumps.polished(system, lambda: rest, (F,), np.array([0.0]))


@pytest.mark.parametrize("wrong", (np.nan, np.inf))
def test_a_motion_cannot_begin_from_what_is_no_number(wrong, jumped):
    branch, points, _ = jumped["pull-off"]
    spoiled = points[0].state.displacement.copy()
    spoiled[0, 7] = wrong
    with pytest.raises(NotConverged, match="NaN"):
        branch.corrector.settle(states.State(points[0].state.window, spoiled,
                                             points[0].state.means), points[0].controls,
                                points[0].load, "here")


@pytest.mark.parametrize("given, stiffness", [({}, 0.2), ({"jump_snes_regularised_stiffness": 0.7},
                                                          0.7),
                                              ({"jump_snes_regularised_gap": "false"}, None)])
def test_steps_of_a_motion_are_taken_as_its_options_say(given, stiffness, options, monkeypatch):
    """In the regularised gap of a stiffness, or not; the motion leads to the same state."""
    options(**given)
    contact = Contact(Scene(**LINE))
    used = []
    call = RegularisedStep.__call__
    monkeypatch.setattr(RegularisedStep, "__call__", lambda step, x, y:
                        used.append(step.newton_stiffness) or call(step, x, y))
    motion = flow(contact, (D,), (1.0,), lifted(contact, (D,), (1.0,), 0.0))
    motion.follow()
    assert set(used) == ({stiffness} if stiffness else set())


def test_what_holds_less_than_solves_can_tell_holds_no_body():
    """Slip has left nothing of the adhesion but what is below tolerances: a motion beside the fold
    does not move, but ends nowhere. Paths jumped from fold to fold there."""
    scene = Scene(geometry="flat", dimension=2, points=16, period=9.66, height=float("inf"),
                  normal_maugis=0.686, tangential_maugis=0.735, residual_friction=0.0)
    load = Load(start="normal_displacement=-1.3",
                path="normal_force=9; tangential_displacement_y=6; normal_force=-4.2")
    points = []
    with pytest.raises(NoEquilibrium, match="beyond the fold"):
        for point in Branch(scene, load, Steps(locate_folds=True)):
            points.append(point)
            assert point.event != "jump"
    assert points[-1].event == "fold"


def rough_line():
    """The branch of a rough line along which it jumps thrice."""
    scene = Scene(points=512, period=24.0, geometry="rough", rough_on="flat", rough_longest=6.0,
                  rough_shortest=1.5, rough_slope=2.0, rough_seed=1, normal_maugis=3.0,
                  height=float("inf"))
    return Branch(scene, Load(start="normal_displacement=0", path="normal_displacement=1.5"),
                  Steps(initial_step=0.1, largest_step=0.1))


def test_what_a_motion_took_is_given_back_when_a_jump_is_over():
    """PETSc kept the linear solver of each motion, with its vectors, until a window changed."""
    gc.collect()
    alive, events = [], []
    for point in rough_line():
        events.append(point.event)
        if point.position in (0.0, 1.0):
            alive.append(sum(isinstance(thing, DisplacementForm) for thing in gc.get_objects()))
    assert events.count("jump") == 3
    assert len(alive) > 1 and alive[-1] <= alive[0] + 1


@pytest.mark.parametrize("even", [False, True])
def test_nodes_that_are_looked_at_a_few_at_a_time_tell_what_all_of_them_tell(even, monkeypatch):
    """Of all nodes of a window, and of half of them, each with what it counts."""
    branch = rough_line() if not even else Branch(
        Scene(points=256, normal_maugis=4.0),
        Load(start="normal_displacement=-2", path="normal_displacement=3"))
    states_of = [point.state for point in branch]
    first, last = states_of[0], states_of[-1]
    known = acceptance._compared(branch.contact, first, first, last)
    assert hasattr(known[0], "weights") == even
    nodes, released = acceptance._suspects(branch.contact, *known)
    monkeypatch.setattr(acceptance, "PART", 37)
    found = acceptance._suspects(branch.contact, *known)
    assert np.array_equal(found[0], nodes)
    assert found[1] == pytest.approx(released, rel=1e-9)


def test_of_a_pressed_body_that_slides_away_at_a_pull_off_it_is_told():
    scene = Scene(points=128, period=20.0, normal_maugis=2.0, height=float("inf"),
                  residual_friction=0.3)
    told = []
    *_, last = Branch(scene, Load(start="normal_displacement=6", stop="pull_off",
                                  path="tangential_force=4.5; normal_force=-5"), log=told.append)
    assert (last.event, last.fold_kind) == ("fold", "pull_off") and last.forces[0] > 1.0
    assert sum("slides away in contact" in sentence for sentence in told) == 1
