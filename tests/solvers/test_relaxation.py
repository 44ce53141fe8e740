"""Dynamic relaxation: exact motion of springs, the equilibria of an independent Newton solve, and
every way to stop."""

import contextlib
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc
from processes import call
from scipy.optimize import brentq

from contactsnes.contact.force_form import ForceForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.interface.laws import Law
from contactsnes.kernels.choice import chosen
from contactsnes.output import reading
from contactsnes.scene.settings import Scene
from contactsnes.solvers.motion import Motion
from contactsnes.solvers.stepping import DampedVerlet, FastInertial, FireOptions, VerletOptions

ROOT = Path(__file__).resolve().parents[2]
METHODS = ("Verlet", "Adaptive", "Kinetic", "Fire")
SMALL = {"points": 256, "period": 20.0, "normal_maugis": 2.0, "height": np.inf}
REASONS = PETSc.SNES.ConvergedReason
D, F = "displacement", "force"


class Spring(Law):
    """t = s a in every direction."""

    def __init__(self, stiffness):
        self.stiffness = stiffness

    def evaluate(self, gap, traction, tangent=None):
        np.multiply(gap, self.stiffness, out=traction)
        if tangent is not None:
            tangent[...] = self.stiffness * np.eye(len(gap))[:, :, None]
        return traction


def create_form(controls, load, own=None, kernels=None, **changes):
    """A force form of a small line contact."""
    form = ForceForm(Contact(Scene(**{**SMALL, **changes}), law=own, kernels=kernels), controls)
    form.set_load(load)
    return form


def undeformed(form, approach):
    """Displacements (components, nodes) without overlap, with the mean of the given approach,
    u_n,r."""
    gap, depth = form.initial_gap, form.contact.ranges[0] * approach
    level = brentq(lambda level: np.minimum(gap, level).mean() - depth, -1e4, 1e4)
    start = np.zeros(form.shape)
    start[0] = np.maximum(-gap, -level)
    return start


@contextlib.contextmanager
def options(prefix="", **values):
    """Options in PETSc's database for a while."""
    database = PETSc.Options(prefix)
    for name, value in values.items():
        database[name] = value
    try:
        yield
    finally:
        for name in values:
            database.delValue(name)


def relax(form, start, method="Fire", atol=1e-9, max_it=20000, context=None, **values):
    """Solve by a SNES of one of our types; the SNES and the displacements (components, nodes)."""
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.appctx = context or form
    snes.setFunction(lambda snes, x, f: None, PETSc.Vec().createSeq(form.size))
    snes.setTolerances(rtol=0.0, atol=atol, stol=0.0, max_it=max_it)
    snes.setConvergenceHistory()
    snes.setType("python")
    snes.setPythonType("contactsnes.solvers.relaxation." + method)
    with options(**values):
        snes.setFromOptions()
    solution = PETSc.Vec().createWithArray(form.pack(start).copy(), comm=PETSc.COMM_SELF)
    snes.solve(None, solution)
    return snes, form.displacement(solution.getArray()).copy()


def newton(form, start):
    """The equilibrium by Newton's method with a dense Jacobian, damped by halving; displacements
    (components, nodes)."""
    unknown = form.pack(start).copy()
    identity, jacobian = np.eye(form.size), np.empty((form.size, form.size))
    residual, trial = form.residual(unknown, np.empty(form.size)), np.empty(form.size)
    for _ in range(100):
        if np.linalg.norm(residual) < 1e-12:
            return form.displacement(unknown).copy()
        form.linearise(unknown)
        for column, unit in zip(jacobian.T, identity):
            column[...] = form.apply_jacobian(unit, np.empty(form.size))
        step, factor = np.linalg.solve(jacobian, residual), 1.0
        while np.linalg.norm(form.residual(unknown - factor * step,
                                           trial)) > np.linalg.norm(residual) and factor > 1e-3:
            factor /= 2
        unknown -= factor * step
        residual[...] = form.residual(unknown, trial)
    raise AssertionError("the reference solution did not converge")


def spring_motion(stiffness, tangent=2.0):
    """A started motion on springs, the place of rest of its waves, their squared frequencies and
    the stiffness K.

    K = |q|/2 for the half-space in scaled units, over lambda^2 in ranges of the law; m = K +
    tangent.
    """
    form = create_form([D], [1.0], Spring(stiffness))
    # overlap everywhere; the mean, which cannot move, bears it
    form.initial_gap = form.initial_gap - 1e4
    motion = Motion(form, tangent=tangent)
    motion.start(np.zeros(form.shape))
    wavenumber = 2 * np.pi * np.arange(129) / SMALL["period"]
    elastic = wavenumber / 2 / SMALL["normal_maugis"] ** 2
    rest = -stiffness * np.fft.rfft(form.initial_gap) / (elastic + stiffness)
    rest[0] = -SMALL["normal_maugis"] * 1.0 * 256
    return motion, rest, (elastic + stiffness) / (elastic + tangent), elastic


@pytest.mark.parametrize("stiffness", (0.7, 40.0))
def test_undamped_verlet_on_springs_keeps_amplitude_and_has_the_exact_phase(stiffness):
    # u_n+1 - 2 u_n + u_n-1 = -(w dt)^2 u_n from u_-1 = u_0: u_n = u_0 cos(p (n + 1/2)) / cos(p/2),
    # sin(p/2) = w dt/2.
    motion, rest, squared, elastic = spring_motion(stiffness)
    if stiffness > 2.0:
        # Overlap stiffer than the reference: all masses grow so that the fastest frequency, of the
        # lightest wave, stays 1.
        squared *= (elastic[1] + 2.0) / (elastic[1] + stiffness)
        assert squared[1:].max() == pytest.approx(1.0)
    verlet = DampedVerlet(motion, VerletOptions(damping=0.0, time_step=0.8))
    first = motion.displacement[0] - rest
    for _ in range(500):
        verlet.step()
    phase = 2 * np.arcsin(0.8 * np.sqrt(squared) / 2)
    expected = first * np.cos(phase * 500.5) / np.cos(phase / 2)
    assert np.abs(motion.displacement[0] - rest - expected)[1:].max() < 1e-9 * np.abs(first).max()


@pytest.mark.parametrize("damping, exponent", ((0.3, 0.0), (2.0, 0.0), (0.3, 0.5)))
def test_damped_verlet_on_springs_tends_to_the_damped_oscillator(damping, exponent):
    errors = []
    for time_step in (0.1, 0.05, 0.025):
        motion, rest, squared, elastic = spring_motion(0.7)
        verlet = DampedVerlet(motion, VerletOptions(damping=damping, damping_exponent=exponent,
                                                    time_step=time_step))
        first = motion.displacement[0] - rest
        for _ in range(round(4.0 / time_step)):
            verlet.step()
        # u'' + c u' + w^2 u = 0 at time 4 from rest; c grows with the wave's own frequency
        # sqrt(K/m)
        own = elastic[1:] / (elastic[1:] + 2.0)
        rate = damping * np.append(1.0, own / own[0]) ** (exponent / 2)
        root = np.sqrt(squared - rate**2 / 4 + 0j)
        decay = np.exp(-rate * 2.0) * (np.cos(4 * root) + rate / 2 * np.sin(4 * root) / root).real
        errors.append(np.abs(motion.displacement[0] - rest - first * decay)[1:].max()
                      / np.abs(first).max())
    # the start from rest, half a step early, is of first order
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 0.02 and np.all(np.abs(order - 1) < 0.15)


SCENES = {"displacement": ([D], [3.0], 3.0, {}), "force": ([F], [2.0], 3.0, {}),
          "pulled": ([F], [-1.0], 0.5, {}), "sheared": ([D, D], [3.0, 2.0], 3.0,
                                                        {"height": 30.0, "residual_friction": 0.5}),
          "forces": ([F, F], [2.0, 0.8], 3.0, {"height": 30.0, "law": "mcgarry"}),
          "coupled": ([F, D], [2.0, 1.0], 3.0, {"poisson": 0.3, "height": 30.0, "work_ratio": 0.5,
                                                "tangential_maugis": 3.0}),}


@pytest.fixture(scope="module")
def equilibria():
    """Name -> form, start and the equilibrium found by the dense Newton method, each made when
    first asked for."""
    made = {}

    def find(name):
        if name not in made:
            controls, load, approach, changes = SCENES[name]
            form = create_form(controls, load, **changes)
            start = undeformed(form, approach)
            made[name] = form, start, newton(form, relax(form, start, atol=1e-2)[1])
        return made[name]
    return find


@pytest.mark.parametrize("masses", ("fourier", "equal"))
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SCENES)
def test_relaxation_finds_the_equilibrium_of_newtons_method(equilibria, name, method, masses):
    form, start, expected = equilibria(name)
    before, evaluations = form.grid.transforms, form.evaluations
    snes, found = relax(form, start, method, **{f"snes_{method.lower()}_masses": masses})
    assert snes.reason == REASONS.CONVERGED_FNORM_ABS
    assert np.sqrt(np.mean((found - expected)[:, form.initial_gap + expected[0] < 37] ** 2)) < 1e-8
    assert form.forces(form.pack(found))[form.forced] == pytest.approx(form.load[form.forced],
                                                                       abs=1e-8)
    # two transforms a component for each force, and one for the start
    assert form.grid.transforms - before == pytest.approx(form.components * (2 * snes.its + 3))
    assert form.evaluations - evaluations == snes.its + 1
    assert snes.getPythonContext().escaping is None


@pytest.mark.parametrize("method", METHODS)
def test_relaxation_recovers_from_deep_overlap(equilibria, method):
    form, _, expected = equilibria("displacement")
    snes, found = relax(form, np.full(form.shape, -60.0), method)
    assert snes.reason > 0 and np.abs(found - expected).max() < 1e-7


def test_two_dimensions_with_three_components():
    form = create_form([F, F, D], [2.0, 0.5, 0.0], dimension=2, geometry="sphere", points=(32, 32),
                       period=8.0, height=20.0)
    results = [relax(form, undeformed(form, 0.5), method)[1] for method in METHODS]
    assert np.abs(results[0] - results[1]).max() < 1e-7
    assert np.linalg.norm(form.residual(form.pack(results[0]), np.empty(form.size))) < 1e-9


@pytest.mark.parametrize("name", ("sheared", "coupled", "force"))
def test_the_motions_force_is_the_forms_residual(equilibria, name):
    form, start, _ = equilibria(name)
    motion = Motion(form)
    motion.start(start + np.random.default_rng(1).standard_normal(form.shape))
    fields = motion.gap.copy()
    fields[0] -= form.initial_gap
    residual = form.residual(form.pack(fields), np.empty(form.size)).reshape(form.shape) * form.root
    assert np.allclose(np.fft.irfft(motion.force), residual, rtol=0,
                       atol=1e-12 * np.abs(residual).max())


def test_energies_are_sums_over_nodes(equilibria):
    form, start, _ = equilibria("coupled")
    motion = Motion(form, "equal")
    motion.start(start)
    verlet = DampedVerlet(motion, VerletOptions(masses="equal"))
    for _ in range(5):
        verlet.step()
    force, velocity = np.fft.irfft(motion.force), np.fft.irfft(motion.velocity)
    mass = motion.stiffening * motion.mass[:, 5][:, None]
    # Parseval: a sum over the waves is N times the sum over the nodes
    expected = form.grid.size * np.array([-np.sum(force * velocity), np.sum(mass * velocity**2),
                                          np.sum(force**2 / mass)])
    assert motion.energies() == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("compiled", [False, True])
def test_a_law_that_stiffens_leaves_the_kinetic_energy(compiled):
    """Masses grow with the tangent where surfaces overlap, and a motion slows down by as much."""
    controls, load, approach, changes = SCENES["coupled"]
    form = create_form(controls, load, kernels=chosen(compiled), **changes)
    start = undeformed(form, approach)
    motion = Motion(form)
    motion.start(start)
    motion.velocity[...] = np.fft.rfft(np.random.default_rng(3).standard_normal(form.shape))
    stiffening, kinetic = motion.stiffening, motion.energies()[1]
    motion.displacement[0, 0] -= 3.0 * form.grid.size
    motion.advance(0.0, 1.0, 0.0)
    assert (motion.stiffening > 2.0 * stiffening
            and motion.energies()[1] == pytest.approx(kinetic, rel=1e-12))


@pytest.mark.parametrize("name", SCENES)
def test_norm_bounds_the_residual_on_the_window_from_above(equilibria, name):
    form, start, _ = equilibria(name)
    motion = Motion(form)
    motion.start(start)
    fire, ratios = FastInertial(motion, FireOptions()), []
    while motion.norm() > 1e-8:
        fields = motion.gap.copy()
        fields[0] -= form.initial_gap
        window = form.contact.window(motion.gap[0].reshape(form.grid.shape))
        other = DisplacementForm(form.contact, window, form.controls)
        other.set_load(form.load)
        unknown = other.pack(window.take(fields.reshape(-1, *form.grid.shape)),
                             fields.mean(axis=1)[form.forced])
        ratios.append(motion.norm() / np.linalg.norm(other.residual(unknown, np.empty(other.size))))
        for _ in range(10):
            fire.step()
    assert (len(ratios) > 5 and min(ratios) > 1.0 - 1e-9 and np.median(ratios) < 2.0
            and max(ratios) < 5.0)


def test_the_mean_of_a_rigid_mode_is_the_load_and_stays(equilibria):
    form, start, _ = equilibria("displacement")
    motion = Motion(form)
    motion.start(start + 0.3)
    fire = FastInertial(motion, FireOptions())
    for _ in range(50):
        fire.step()
        assert np.mean(motion.gap[0] - form.initial_gap) == pytest.approx(-2.0 * 3.0, abs=1e-12)


def test_masses_are_stiffnesses_plus_the_reference_tangent():
    form = create_form([D, F], [1.0, 0.0], tangential_maugis=4.0, height=30.0)
    motion = Motion(form, tangent=1.5)
    wavenumber = 2 * np.pi * np.arange(1, 129) / SMALL["period"]
    # at these heights the layer is the half-space to the given accuracy
    assert motion.mass[0, 1:] == pytest.approx(wavenumber / 2 / 4 + 1.5, rel=1e-3)
    assert motion.mass[1, 1:] == pytest.approx(wavenumber / 2 / 16 + 1.5, rel=1e-3)
    assert motion.mass[:, 0] == pytest.approx([0.0, 0.75]) and motion.mobility[0, 0] == 0.0
    equal = Motion(form, "equal", 1.5)
    assert (np.all(equal.mass[1] == equal.mass[1].max())
            and equal.mass[1].max() == pytest.approx(motion.mass[1].max()))


@pytest.mark.parametrize("method", METHODS)
def test_tolerances_and_limits_of_petsc_are_obeyed(equilibria, method):
    form, start, _ = equilibria("displacement")
    snes, _ = relax(form, start, method, atol=1e-4)
    history = snes.getConvergenceHistory()[0]
    assert snes.reason == REASONS.CONVERGED_FNORM_ABS and len(history) == snes.its + 1
    assert history[-1] == snes.norm <= 1e-4 < history[:-1].min()
    snes, _ = relax(form, start, method, max_it=7)
    assert snes.reason == REASONS.DIVERGED_MAX_IT and snes.its == 7
    snes, _ = relax(form, start, method, snes_rtol=1e-3)
    assert snes.reason == REASONS.CONVERGED_FNORM_RELATIVE and snes.norm <= 1e-3 * history[0]
    snes, _ = relax(form, start, method, snes_max_funcs=9)
    assert snes.reason == REASONS.DIVERGED_FUNCTION_COUNT and snes.its == 8


EVEN = {"displacement": SCENES["displacement"], "force": SCENES["force"],
        "sheared": ([D, D], [3.0, 2.0], 3.0, {"height": 200.0, "residual_friction": 0.5}),
        "sphere": ([F], [2.0], 0.5, {"dimension": 2, "geometry": "sphere", "points": (32, 24),
                                     "period": (8.0, 6.0), "height": 20.0})}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", EVEN)
def test_half_of_the_nodes_takes_the_steps_of_all(name, method):
    """The same iterations and norms, to rounding, at about half or a quarter of the transforms."""
    controls, load, approach, changes = EVEN[name]
    results = []
    for even in (False, True):
        form = create_form(controls, load, **changes)
        form.even = even
        assert f"{form.half.size if even else form.nodes} of {form.nodes} nodes" in Motion(
            form).about()
        snes, found = relax(form, undeformed(form, approach), method, atol=1e-7)
        assert snes.reason == REASONS.CONVERGED_FNORM_ABS
        results.append((found, snes.its, snes.getConvergenceHistory()[0], form.grid.transforms))
    (whole, steps, norms, cost), (half, own_steps, own_norms, own_cost) = results
    assert own_steps == steps and np.abs(half - whole).max() < 1e-11 * np.abs(whole).max()
    assert own_norms == pytest.approx(norms, rel=1e-4)
    assert own_norms[:20] == pytest.approx(norms[:20], rel=1e-9)
    nodes = np.prod([n // 2 + 1 for n in form.grid.shape])
    ratio = nodes * np.log(nodes) / (form.grid.size * np.log(form.grid.size))
    assert own_cost / cost == pytest.approx(ratio, rel=1e-6)


def test_an_equilibrium_takes_no_step(equilibria):
    form, _, expected = equilibria("coupled")
    snes, found = relax(form, expected, atol=1e-8)
    assert snes.reason > 0 and snes.its == 0 and np.abs(found - expected).max() < 1e-12


def test_a_time_step_that_is_too_large_diverges_with_a_reason(equilibria):
    form, start, _ = equilibria("displacement")
    snes, _ = relax(form, start, "Verlet", snes_verlet_time_step=5.0)
    assert snes.reason == REASONS.DIVERGED_DTOL and snes.its < 2000


def test_not_a_number_diverges_with_a_reason(equilibria):
    form, start, _ = equilibria("displacement")
    start = start.copy()
    start[0, 3] = np.nan
    snes, _ = relax(form, start)
    assert snes.reason == -4 and snes.its == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_body_that_is_pulled_off_is_seen_to_leave(method):
    # no tensile force beyond the peak traction over the whole contact: here far more
    form = create_form([F], [-20.0])
    snes, _ = relax(form, undeformed(form, 1.0), method)
    context = snes.getPythonContext()
    assert (snes.reason == REASONS.DIVERGED_FUNCTION_DOMAIN
            and context.escaping == 0 and snes.its < 1000)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("controls, load", (([D, F], [3.0, None]), ([F, F], [2.0, None])))
def test_a_body_slides_without_end_only_beyond_its_friction(method, controls, load):
    # Friction levelled off carries tau_max (2/e)^(1/2) at every node with a < 0 and that times
    # exp(-a) elsewhere.
    changes = {"height": 30.0, "law": "modified", "residual_adhesion": 0.5}
    held = create_form(controls, [load[0], 0.0], **changes)
    start = undeformed(held, 3.0)
    start[1] += 30.0
    settled = create_form([controls[0], D], [load[0], 3000.0], **changes)
    slid = relax(settled, start, "Fire")[1]
    gap = settled.gap(settled.pack(slid))
    assert gap[1].min() > 6
    largest = np.sqrt(2 / np.e) * np.exp(-np.maximum(gap[0], 0)).sum() * settled.factor[1]
    for factor, escapes in ((0.97, False), (1.03, True)):
        form = create_form(controls, [load[0], factor * largest], **changes)
        snes, _ = relax(form, undeformed(form, 3.0), method, atol=1e-8)
        context = snes.getPythonContext()
        assert escapes == (snes.reason == REASONS.DIVERGED_FUNCTION_DOMAIN)
        assert context.escaping == (1 if escapes else None) and (escapes or snes.reason > 0)


@pytest.mark.parametrize("method", METHODS)
def test_a_body_that_slides_back_comes_to_where_it_stuck(method):
    """Without residual friction nothing holds it back on the way."""
    form = create_form([F, F], [2.0, -0.2], height=30.0, law="modified", residual_friction=0.0)
    start = undeformed(form, 3.0)
    results = []
    for slip in (15.0, 0.0):
        start[1] = slip
        snes, found = relax(form, start, method, atol=1e-8)
        assert snes.reason > 0 and snes.getPythonContext().escaping is None
        results.append(found)
    assert np.abs(results[0] - results[1]).max() < 1e-6


def test_options_are_read_under_the_prefix_and_viewed(tmp_path):
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setOptionsPrefix("jump_")
    snes.setType("python")
    snes.setPythonType("contactsnes.solvers.relaxation.Fire")
    with options("jump_", snes_fire_mixing=0.25, snes_fire_delay=5):
        snes.setFromOptions()
    context = snes.getPythonContext()
    assert context.options == FireOptions(mixing=0.25, delay=5)
    path = tmp_path / "view"
    viewer = PETSc.Viewer().createASCII(str(path), comm=PETSc.COMM_SELF)
    context.view(snes, viewer)
    viewer.destroy()
    text = path.read_text()
    assert "Motion" not in text  # there has been none
    assert all(f"{name} " in text for name in vars(FireOptions())) and "mixing 0.25" in text


def test_verlet_tells_the_damping_it_used(equilibria, tmp_path):
    form, start, _ = equilibria("displacement")
    snes, _ = relax(form, start, "Verlet", atol=1.0)
    viewer = PETSc.Viewer().createASCII(str(tmp_path / "view"), comm=PETSc.COMM_SELF)
    snes.getPythonContext().view(snes, viewer)
    viewer.destroy()
    # twice the frequency of the longest wave: K = q/2/lambda^2, m = K + 2
    stiffness = np.pi / SMALL["period"] / SMALL["normal_maugis"] ** 2
    assert f"damping {2 * np.sqrt(stiffness / (stiffness + 2)):.6f}" in (
        tmp_path / "view").read_text()


def test_the_displacement_form_is_refused():
    form = create_form([D], [1.0])
    other = DisplacementForm(form.contact, form.grid.whole, [D])
    with pytest.raises(Exception) as caught:
        relax(form, undeformed(form, 1.0), context=other)
    # newer petsc4py keeps the error of a Python context as the cause of its own
    assert "-contact_form force" in str(caught.value.__cause__ or caught.value)


# The files of options

FILES = {path.stem: path for path in sorted((ROOT / "options").glob("*.opts"))
         if "relaxation." in path.read_text(encoding="utf-8")}
PATH = ["-scene_points", "256", "-scene_period", "20", "-scene_normal_maugis", "2",
        "-scene_residual_friction", "0.5", "-load_path",
        "normal_force=1; tangential_displacement=1", "-continuation_initial_step", "0.5",
        "-continuation_largest_step", "0.5", "-archive_fields", "all", "-archive_file", "run.h5"]


def run(path, folder, *arguments):
    """A finished run of a small sheared path with a file of options, in a folder of its own."""
    folder.mkdir()
    return call("run", path, *PATH, *arguments, folder=folder)


@pytest.fixture(scope="module")
def newton_archive(tmp_path_factory):
    """What Newton's method archives of the path."""
    folder = tmp_path_factory.mktemp("newton") / "run"
    done = run(ROOT / "options" / "newton.opts", folder)
    assert done.returncode == 0, done.stderr
    return reading.read(folder / "run.h5")


def test_each_method_has_a_file_with_each_kind_of_masses():
    assert {f"{method.lower()}{end}" for method in METHODS
            for end in ("", "-equal")} | {"verlet-plain"} <= set(FILES)


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_options_archives_what_newtons_method_does(name, newton_archive, tmp_path):
    done = run(FILES[name], tmp_path / "run", "-snes_monitor", "ascii:monitor", "-snes_view",
               "ascii:view")
    assert done.returncode == 0 and "unused" not in done.stderr, done.stderr
    found = reading.read(tmp_path / "run" / "run.h5")
    assert found.points == newton_archive.points and set(found) == set(newton_archive)
    costs = ("iterations", "evaluations", "transforms", "time", "residual_norm")
    for column in found:
        if column.endswith(costs):
            assert np.all(found[column] > 0) or column == "linear_iterations"
        elif found[column].dtype.kind == "f":
            assert np.allclose(found[column], newton_archive[column], rtol=1e-6, atol=1e-6,
                               equal_nan=True), column
        else:
            assert np.array_equal(found[column], newton_archive[column]), column
    assert np.all(found["residual_norm"] <= 1e-8)
    last = found.points - 1
    assert np.allclose(found.field("displacement", last),
                       newton_archive.field("displacement", last), atol=1e-6)
    method, kind = name.partition("-")[::2]
    text = (tmp_path / "run" / "view").read_text()
    assert (f"masses {'equal' if kind else 'fourier'}, " in text
            and f"relaxation.{method.capitalize()}" in text)
    assert kind != "plain" or "damping_exponent 0\n" in text
    # the file of the monitor is that of the last leg's SNES
    norms = [float(line.split()[-1])
             for line in (tmp_path / "run" / "monitor").read_text().splitlines()]
    assert len(norms) > found["nonlinear_iterations"][-1] > 10 and norms[-1] <= 1e-8 < norms[-2]


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_options_yields_to_the_command_line(name, tmp_path):
    done = run(FILES[name], tmp_path / "run", "-snes_max_it", "5", "-load_path",
               "normal_displacement=0")
    # the first solve fails, what the program does then is its own affair
    assert "DIVERGED_MAX_IT after 5 iterations" in done.stdout + done.stderr
