"""Damped motion in C against NumPy's, and on half of the nodes against all of them: the same states
after more than a hundred steps."""

import gc
import sys
from itertools import product

import numpy as np
import petsc4py
import pytest

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

from contactsnes.contact.force_form import ForceForm  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.grid.cell import transform_cost  # noqa: E402
from contactsnes.grid.even import EvenWindow  # noqa: E402
from contactsnes.grid.parity import obstacle  # noqa: E402
from contactsnes.interface.laws.modified import Modified  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.kernels.choice import chosen  # noqa: E402
from contactsnes.scene.settings import Scene  # noqa: E402
from contactsnes.solvers import stepping  # noqa: E402
from contactsnes.solvers.motion import Motion  # noqa: E402

COMPILED = library.reason() is None
LINE = {"points": 254, "period": 20.0, "normal_maugis": 2.0, "tangential_maugis": 2.0,
        "residual_friction": 0.5, "height": 200.0}
"""So tall a layer couples normal and tangential displacements below rounding."""
PLANE = {**LINE, "height": 30.0, "points": (48, 36), "period": (12.0, 9.0), "dimension": 2,
         "geometry": "sphere"}
D, F = "displacement", "force"
SCENES = {"line": (LINE, [D], [3.0]), "pulled": (LINE, [F], [-0.3]),
          "sheared": (LINE, [F, D], [2.0, 1.0]), "forces": (LINE, [D, F], [3.0, 0.4]),
          "plane": (PLANE, [F], [2.0]), "held plane": (PLANE, [D], [0.8])}
COUPLED = {"coupled": ({**LINE, "poisson": 0.3}, [F, D], [2.0, 1.0]),
           "three": (PLANE, [F, D, F], [2.0, 0.4, 0.1]),
           "coupled three": ({**PLANE, "poisson": 0.2}, [D, F, D], [0.8, 0.3, 0.1])}
METHODS = {"Verlet": (stepping.DampedVerlet, stepping.VerletOptions),
           "Fire": (stepping.FastInertial, stepping.FireOptions),
           "Adaptive": (stepping.AdaptiveRelaxation, stepping.AdaptiveOptions),
           "Kinetic": (stepping.KineticDamping, stepping.KineticOptions)}


def started(name, compiled, even=False, masses="fourier"):
    """A motion that is about to begin, pressed in at the apex."""
    scene, controls, load = {**SCENES, **COUPLED}[name]
    form = ForceForm(Contact(Scene(**scene), kernels=chosen(compiled)), controls)
    form.set_load(load)
    form.even = even
    assert not even or obstacle(form.contact, form.components) is None
    motion = Motion(form, masses)
    assert (motion.kernel is not None) == compiled
    start = np.zeros(form.shape)
    start[0] = np.maximum(-form.initial_gap, -2.0) - 0.7 * np.exp(-form.initial_gap)
    start[1:] = 0.3 * np.exp(-form.initial_gap / 5.0)
    motion.start(start)
    return motion


def method_of(motion, name, masses="fourier"):
    cls, options = METHODS[name]
    return cls(motion, options(masses=masses))


def sums(motion):
    """What methods and SNES are told of a motion, far from rest."""
    return [*motion.energies(), *motion.changes(0.9 * motion.force), motion.norm(),
            motion.stiffening, motion.closest(), motion.grid.size]


def agree(one, other, relative=None):
    """Whether the states of two motions on all of the cell's nodes are the same to rounding, and
    their sums."""
    expected = one.displacements()
    np.testing.assert_allclose(other.displacements(), expected, rtol=0.0,
                               atol=1e-12 * np.abs(expected).max())
    if relative:
        np.testing.assert_allclose(sums(other), sums(one), rtol=relative)


def same_way(one, other, name, masses="fourier", steps=140):
    """Two motions agree at the start, on their way and after steps, and cost what they should."""
    agree(one, other, 1e-10)
    methods = [method_of(motion, name, masses) for motion in (one, other)]
    before = [motion.form.grid.transforms for motion in (one, other)]
    for step in range(steps):
        for method in methods:
            method.step()
        if step in (5, 15):
            agree(one, other, 1e-9)
            assert methods[0].time_step == pytest.approx(methods[1].time_step, rel=1e-9)
    agree(one, other)
    for motion, spent in zip((one, other), before):
        grid, shape = motion.form.grid, motion.transform.shape
        each = 2 * motion.form.components * transform_cost(np.prod(shape), grid.size)
        assert motion.form.grid.transforms - spent == pytest.approx(steps * each, rel=1e-10)
        assert motion.steps == steps and motion.form.evaluations == steps + 1


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
@pytest.mark.parametrize("name, even", [*product(SCENES, (False, True)),
                                        *product(COUPLED, (False,))])
def test_compiled_motion_is_numpys(name, even):
    for method in METHODS:
        same_way(started(name, False, even), started(name, True, even), method)


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
def test_compiled_motion_with_equal_masses_is_numpys():
    same_way(started("sheared", False, True, "equal"), started("sheared", True, True, "equal"),
             "Fire", "equal")


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.skipif(
    not COMPILED, reason=str(library.reason())))])
@pytest.mark.parametrize("name", SCENES)
def test_motion_of_half_the_nodes_is_that_of_all(name, compiled):
    for method in METHODS:
        whole, half = started(name, compiled), started(name, compiled, even=True)
        assert half.gap.shape[1] == np.prod([n // 2 + 1 for n in half.form.grid.shape])
        for cell, own in zip(whole.frequencies(), half.frequencies()):
            np.testing.assert_allclose(np.unique(own.round(12)), np.unique(cell.round(12)),
                                       rtol=1e-10)
        same_way(whole, half, method)


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.skipif(
    not COMPILED, reason=str(library.reason())))])
@pytest.mark.parametrize("name", ["sheared", "plane"])
def test_sums_over_cosines_are_those_over_the_nodes(name, compiled):
    """Parseval: power, kinetic energy by equal masses, and the square of the force."""
    motion = started(name, compiled, True, "equal")
    method = method_of(motion, "Verlet", "equal")
    for _ in range(5):
        method.step()
    window, fields = EvenWindow(motion.form.window), []
    for spectrum in (motion.force, motion.velocity):
        motion.transform.spectrum[...] = spectrum
        motion.transform.backward()
        fields.append(window.unfold(motion.transform.real.reshape(motion.gap.shape))
                      / motion.form.grid.size)
    force, velocity = fields
    mass = motion.stiffening * motion.mass.reshape(len(force), -1)[:, 1][:, None]
    expected = motion.form.grid.size * np.array(
        [-np.sum(force * velocity), np.sum(mass * velocity ** 2), np.sum(force ** 2 / mass)])
    # the mean of the second component does not move where it is held
    held = [i for i in range(len(force)) if not motion.mobile[i]]
    expected[2] -= sum(motion.force[(i, *motion.zero)] ** 2 / mass[i, 0] for i in held)
    expected[0] += sum((motion.force[(i, *motion.zero)] * motion.velocity[(i, *motion.zero)]).real
                       for i in held)
    assert motion.energies() == pytest.approx(expected, rel=1e-9)


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
@pytest.mark.parametrize("kept, impulse", [(0.9, 0.3), ("array", 0.3), (0.9, "row"),
                                           ("array", "array")])
def test_factors_of_a_step_are_numbers_or_arrays(kept, impulse):
    found = []
    for compiled in (False, True):
        motion = started("sheared", compiled, True)
        shape = {"array": motion.mass.shape, "row": motion.mass.shape[1:]}
        factors = [np.linspace(0.2, 0.8, np.prod(shape[factor])).reshape(shape[factor])
                   if isinstance(factor, str) else factor for factor in (kept, impulse)]
        for _ in range(20):
            motion.advance(0.7, *factors)
        found.append(motion)
    agree(*found, 1e-9)


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
def test_what_is_no_number_is_no_number():
    for compiled in (False, True):
        motion = started("sheared", compiled, True)
        motion.displacement[0, 3] = np.nan
        with np.errstate(invalid="ignore"):
            motion.advance(0.0, 0.0, 0.0)
        assert np.isnan(motion.norm()) and motion.stiffening == 1.0


class Evaluated(Modified):
    """A law that says in Python what it is."""

    def evaluate(self, gap, traction, tangent=None):
        return super().evaluate(gap, traction, tangent)


def test_a_law_of_pythons_own_moves_by_numpy():
    scene, controls, load = SCENES["sheared"]
    form = ForceForm(Contact(Scene(**scene), law=Evaluated(0.5, 0.0)), controls)
    form.set_load(load)
    assert Motion(form).kernel is None


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
def test_more_transforms_than_are_allowed_end_a_motion():
    motion = started("sheared", True, True)
    motion.form.grid.limit = motion.form.grid.transforms + 1.0
    with pytest.raises(RuntimeError, match="too many transforms"):
        motion.advance(1.0, 0.5, 0.5)


@pytest.mark.skipif(not COMPILED, reason=str(library.reason()))
def test_a_step_enters_python_only_to_step_and_to_be_judged():
    """No NumPy of the step's size: what a step calls is a few functions of its own."""
    scene, controls, load = SCENES["sheared"]
    form = ForceForm(Contact(Scene(**scene)), controls)
    form.set_load(load)
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.appctx = form
    snes.setFunction(lambda snes, x, f: None, PETSc.Vec().createSeq(form.size))
    snes.setTolerances(rtol=0.0, atol=1e-30, max_it=50)
    snes.setType("python")
    snes.setPythonType("contactsnes.solvers.relaxation.Fire")
    snes.setFromOptions()
    unknown, called = PETSc.Vec().createWithArray(np.zeros(form.size)), []

    def watch(frame, event, argument):
        if event == "call":
            called.append((frame.f_code.co_filename, frame.f_code.co_name))
    gc.disable()  # what is no more used of other tests is not this solve's
    sys.setprofile(watch)
    try:
        snes.solve(None, unknown)
    finally:
        sys.setprofile(None)
        gc.enable()
    place = [name for _, name in called].index("step")
    files = {file.rpartition("contactsnes/")[2] for file, _ in called[place:]
             if "/contactsnes/" in file}
    assert files <= {"solvers/stepping.py", "solvers/motion.py", "solvers/relaxation.py",
                     "solvers/leaving.py", "solvers/waves.py", "solvers/convergence.py",
                     "kernels/motion.py", "kernels/forms.py", "kernels/structures.py",
                     "contact/force_form.py", "grid/even.py", "grid/cell.py", "grid/fields.py"}
    assert not {"_balance", "_stiffen", "_steepest"} & {name for _, name in called[place:]}
