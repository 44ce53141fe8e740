"""The contact problem: derivatives, the two forms of one balance, windows, and what all of it
costs.

Displacements are in ranges of the law. Bodies: `thick` decouples its components, `soft` couples
them and is soft in the mean, `thin` couples them although it is incompressible, `half` couples them
and has a rigid mean.
"""

import ctypes
import gc
import itertools
import math
import tracemalloc
import weakref

import numpy as np
import pyfftw
import pytest
import scipy.fft
import scipy.signal

from contactsnes import Branch, Contact, Form, InputError, Load, Scene, Steps
from contactsnes.branch import equations
from contactsnes.branch.accuracy import finer_contact
from contactsnes.contact.bordered import ArcLength
from contactsnes.contact.force_form import ForceForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.isolated import IsolatedContact, lay_out
from contactsnes.contact.problem import DISPLACEMENT, FORCE
from contactsnes.contact.state import State
from contactsnes.grid.windows import Window
from contactsnes.interface.laws.coupled import SLIP
from contactsnes.interface.laws.modified import Modified
from contactsnes.kernels import library, lines, transforms
from contactsnes.solvers import krylov, vectors
from contactsnes.solvers.core_zone import CoreZone

BODIES = {"thick": {}, "soft": {"poisson": 0.3, "height": 3.0, "work_ratio": 2.0},
          "thin": {"height": 2.0}, "half": {"poisson": 0.1, "height": math.inf, "work_ratio": 0.5}}
LINE = {"points": 64, "period": 16.0, "normal_maugis": 2.0, "tangential_maugis": 1.5,
        "residual_friction": 0.6, "residual_adhesion": 0.1}
PLANE = {**LINE, "dimension": 2, "points": (16, 20), "period": (12.0, 14.0), "geometry": "sphere"}
BOXES = {"whole": None, "part": ((20,), (17,)), "wrapped": ((58,), (15,)),
         "plane": None, "box": ((3, 17), (5, 6)), "strip": ((14, 0), (6, 20))}
LINE_BOXES, PLANE_BOXES = ("whole", "part", "wrapped"), ("plane", "box", "strip")
CONTROLS = {count: list(itertools.product((DISPLACEMENT, FORCE), repeat=count))
            for count in (1, 2, 3)}


def contact_of(count, body="thick", **options):
    """The contact of a small scene with up to `count` components."""
    return Contact(Scene(**{**(PLANE if count == 3 else LINE), **BODIES[body], **options}))


def window_of(contact, box):
    return contact.grid.whole if BOXES[box] is None else Window(contact.grid, *BOXES[box])


def forms(contact, controls, box):
    """The forms on a box: the force form is on the whole cell only."""
    found = [DisplacementForm(contact, window_of(contact, box), controls)]
    return found + ([ForceForm(contact, controls)] if BOXES[box] is None else [])


def smooth_gaps(shape, seed=3):
    """Random gaps, in and out of contact, stuck and slipping, away from the corners of the law."""
    random = np.random.default_rng(seed)
    gap = random.uniform(0.15, 3.0, shape) * np.where(random.random(shape) < 0.4, -0.5, 1.0)
    if len(gap) > 1:
        direction = random.normal(size=gap[1:].shape)
        direction /= np.linalg.norm(direction, axis=0)
        gap[1:] = direction * np.where(random.random(shape[1]) < 0.5,
                                       random.uniform(0.1, SLIP - 0.1, shape[1]),
                                       random.uniform(SLIP + 0.1, 2.0, shape[1]))
    return gap


def unknown_of(form, gap, seed=4):
    """The form's unknown with these gaps; means of force-controlled components at random."""
    displacement = gap.copy()
    displacement[0] -= form.initial_gap
    scalars = np.random.default_rng(seed).normal(size=form.size - form.count)
    return form.pack(displacement, scalars)


def order(steps, errors):
    """Fitted slope of log error over log step."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def taylor_order(problem, unknown, seed=5):
    """Order of the remainder F(x + h y) - F(x) - h J y over h."""
    direction = np.random.default_rng(seed).normal(size=problem.size)
    direction *= 0.02 / np.max(np.abs(direction[:problem.count])) / problem.root
    problem.linearise(unknown)
    product = problem.apply_jacobian(direction, np.empty(problem.size)).copy()
    here = problem.residual(unknown, np.empty(problem.size))
    steps = 0.5 ** np.arange(6)
    errors = [np.linalg.norm(problem.residual(unknown + h * direction, np.empty(problem.size))
                             - here - h * product) for h in steps]
    assert np.linalg.norm(product) > 0.0
    return order(steps, errors)


def points_of(scene, load, form=None, steps=None):
    """(contact, points) of a branch; its PETSc objects end here."""
    branch = Branch(scene, load, steps, Form() if form is None else form)
    return branch.contact, list(branch)


def at(**values):
    """The load path of one point."""
    text = ", ".join(f"{name}={value!r}" for name, value in values.items())
    return Load(start=text, path=text)


@pytest.fixture
def tight():
    """Converge points to 1e-12."""
    from petsc4py import PETSc

    options = PETSc.Options()
    options["snes_atol"] = 1e-12
    yield
    options.delValue("snes_atol")


# Derivatives

@pytest.mark.parametrize("law", ["modified", "mcgarry"])
@pytest.mark.parametrize("box", LINE_BOXES + PLANE_BOXES)
@pytest.mark.parametrize("body", BODIES)
def test_jacobian_is_the_derivative_of_the_residual(body, box, law):
    counts = (1, 2) if box in LINE_BOXES else (1, 3)
    for count in counts:
        contact = contact_of(3 if box in PLANE_BOXES else 2, body, law=law)
        for controls in CONTROLS[count]:
            for form in forms(contact, controls, box):
                form.set_load(np.linspace(0.4, 2.0, count))
                found = taylor_order(form, unknown_of(form, smooth_gaps(form.shape)))
                assert found == pytest.approx(2.0, abs=0.1), (count, controls, form.name)


@pytest.mark.parametrize("box", LINE_BOXES + PLANE_BOXES)
@pytest.mark.parametrize("body", BODIES)
def test_transposed_products_are_adjoint(body, box):
    """x J y = y J^T x for random vectors, whatever is controlled."""
    random = np.random.default_rng(11)
    for count in (1, 2) if box in LINE_BOXES else (1, 3):
        contact = contact_of(3 if box in PLANE_BOXES else 2, body)
        for controls in CONTROLS[count]:
            for form in forms(contact, controls, box):
                form.set_load(np.linspace(0.4, 2.0, count))
                form.linearise(unknown_of(form, smooth_gaps(form.shape)))
                first, second = random.normal(size=(2, form.size))
                product = form.apply_jacobian(first, np.empty(form.size))
                transposed = form.apply_transpose(second, np.empty(form.size))
                size = np.linalg.norm(product) * np.linalg.norm(second)
                assert abs(second @ product - first @ transposed) < 1e-12 * size, (controls,
                                                                                   form.name)


@pytest.mark.parametrize("box", LINE_BOXES + PLANE_BOXES)
@pytest.mark.parametrize("body", BODIES)
def test_load_derivative(body, box):
    # The scale of a force row depends on the load, which cannot be seen where the row is balanced.
    count = 2 if box in LINE_BOXES else 3
    contact = contact_of(count, body)
    direction = np.linspace(1.0, -0.7, count)
    for controls in CONTROLS[count]:
        for form in forms(contact, controls, box):
            unknown = unknown_of(form, smooth_gaps(form.shape))
            load = np.where(np.array(controls) == FORCE, form.forces(unknown), 0.3)
            found = []
            for step in (1e-4, -1e-4):
                form.set_load(load + step * direction)
                found.append(form.residual(unknown, np.empty(form.size)))
            form.set_load(load)
            expected = (found[0] - found[1]) / 2e-4
            derivative = form.load_derivative(direction, np.full(form.size, np.nan))
            np.testing.assert_allclose(derivative, expected, atol=1e-7 * np.max(np.abs(expected)))


@pytest.mark.parametrize("body", ["thick", "soft"])
@pytest.mark.parametrize("box", ["whole", "part", "plane"])
def test_arc_length_rows(box, body):
    count = 2 if box in LINE_BOXES else 3
    contact = contact_of(count, body)
    random = np.random.default_rng(6)
    start, direction = np.full(count, 0.2), np.linspace(0.3, -0.5, count)
    for controls in CONTROLS[count]:
        for form in forms(contact, controls, box):
            form.set_load(start)
            anchor = unknown_of(form, smooth_gaps(form.shape))
            arc = ArcLength(form, start, direction, anchor, 3.0 * random.normal(size=form.size),
                            0.7)
            residual = arc.residual(np.append(anchor, 0.4), np.empty(arc.size))
            assert residual[-1] == pytest.approx(-0.7, rel=1e-14)
            form.set_load(start + 0.4 * direction)
            np.testing.assert_array_equal(residual[:-1], form.residual(anchor, np.empty(form.size)))
            ahead = np.append(anchor + 0.7 * arc.tangent / (arc.tangent @ arc.tangent), 0.4)
            assert arc.residual(ahead, np.empty(arc.size))[-1] == pytest.approx(0.0, abs=1e-13)
            assert (taylor_order(arc, np.append(anchor, 0.4)) == pytest.approx(2.0, abs=0.1)), (
                controls, form.name)


# One balance in two forms

def by_stiffness(contact, fields):
    """The body's tractions, without the zero mode, of fields (components, *grid): by numpy's
    transforms."""
    grid, count = contact.grid, len(fields)
    axes = tuple(range(1, fields.ndim))
    spectra = np.fft.rfftn(fields, axes=axes)
    result = np.zeros_like(spectra)
    for (i, j), block in contact.body.stiffness(grid.wavevectors(), count).items():
        result[i] += block * spectra[j] / (contact.ranges[i] * contact.ranges[j])
    return np.fft.irfftn(result, s=grid.shape, axes=axes)


@pytest.mark.parametrize("box", ["whole", "plane"])
@pytest.mark.parametrize("body", BODIES)
def test_force_form_is_the_stiffness_times_the_displacement_form(body, box):
    """F_force = K F_displacement for q != 0, whatever the state; the zero modes differ by the
    body's rigid stiffness."""
    for count in ((1, 2) if box in LINE_BOXES else (1, 3)):
        contact = contact_of(3 if box in PLANE_BOXES else 2, body)
        grid, size = contact.grid, contact.grid.size
        for controls in CONTROLS[count]:
            displacement_form, force_form = forms(contact, controls, box)
            gap = smooth_gaps(force_form.shape)
            unknown = unknown_of(force_form, gap)
            displacement = force_form.displacement(unknown)
            means = displacement.mean(axis=1)
            other = displacement_form.pack(displacement, means[displacement_form.forced])
            for form in (displacement_form, force_form):
                form.set_load(np.linspace(0.4, 2.0, count))
            imbalance = displacement_form.residual(other, np.empty(displacement_form.size))
            rows = imbalance[displacement_form.count:]
            imbalance = imbalance[:displacement_form.count].reshape(count, size)
            forces = force_form.residual(unknown, np.empty(force_form.size)).reshape(count, size)
            expected = by_stiffness(contact, imbalance.reshape(count, *grid.shape)).reshape(count,
                                                                                            size)
            scale = np.max(np.abs(forces))
            np.testing.assert_allclose(forces - forces.mean(axis=1)[:, None], expected,
                                       atol=1e-11 * scale)
            rigid = contact.rigid_compliance(count)
            for i, control in enumerate(controls):
                mean = forces[i].mean()
                if control == DISPLACEMENT:
                    assert mean * (rigid[i] or 1.0) == pytest.approx(imbalance[i].mean(),
                                                                     abs=1e-11 * max(1, rigid[i]))
            prescribed = np.array([form.load[i] for i in form.forced])
            factor = contact.load_factor(
                count)[force_form.forced] * size * force_form.root / np.maximum(1, abs(prescribed))
            np.testing.assert_allclose(forces[force_form.forced].mean(axis=1) * factor, rows,
                                       atol=1e-11)


@pytest.mark.parametrize("body", BODIES)
def test_norms_of_both_forms(body):
    """The force form's norm is that of the displacement form, rounded up by little where every node
    is in range."""
    for dense in (True, False):
        contact = contact_of(2, body, **({"geometry": "flat"} if dense else {}))
        for controls in CONTROLS[2]:
            displacement_form, force_form = forms(contact, controls, "whole")
            gap = smooth_gaps(force_form.shape)
            gap[0] += 0.0 if dense else contact.initial_gap
            unknown = unknown_of(force_form, gap)
            displacement = force_form.displacement(unknown)
            other = displacement_form.pack(displacement,
                                           displacement.mean(axis=1)[displacement_form.forced])
            for form in (displacement_form, force_form):
                form.set_load(np.array([0.4, 2.0]))
            exact = np.linalg.norm(displacement_form.residual(other,
                                                              np.empty(displacement_form.size)))
            forces = force_form.residual(unknown, np.empty(force_form.size))
            norm = force_form.displacement_norm(unknown, forces)
            assert norm >= exact * (1 - 1e-12)
            if dense:
                assert norm <= math.sqrt(2) * exact


SMALL = {"points": 512, "period": 40.0, "normal_maugis": 3.0, "residual_friction": 0.5}
SHARP = {**SMALL, "points": 1024, "normal_maugis": 6.0}
SHEARED = Load(start="normal_displacement=6", path="tangential_displacement=3")
BOTH = pytest.mark.parametrize("options", [{"height": math.inf}, {"poisson": 0.3, "height": 20.0}],
                               ids=["incompressible", "coupled"])


@pytest.mark.parametrize("twice", itertools.combinations(("heights", "gap", "geometry"), 2))
def test_a_gap_is_given_once(twice):
    """None of two is left aside without a word."""
    scene = Scene(points=64, period=20.0, normal_maugis=1.0)
    given = {"heights": np.zeros(64), "gap": np.ones(64), "geometry": np.abs}
    with pytest.raises(InputError, match=" and ".join(twice)):
        Contact(scene, **{name: given[name] for name in twice})


@BOTH
def test_solution_is_an_equilibrium_of_both_forms(options, tight):
    contact, points = points_of(Scene(**SMALL, **options), SHEARED)
    for point in (points[0], points[-1]):
        cell = contact.extended(point.state).reshape(len(point.controls), -1)
        form = ForceForm(contact, point.controls)
        form.set_load(point.load)
        unknown = form.pack(cell)
        forces = form.residual(unknown, np.empty(form.size))
        # Imbalance over the peak of the law: the stiffest wave times the tolerance.
        stiffest = (math.pi * contact.grid.shape[0] / contact.grid.periods[0]
                    / contact.ranges.min() ** 2)
        assert np.max(np.abs(forces)) * form.root < 50 * stiffest * 1e-12
        assert form.displacement_norm(unknown, forces) < 1e-11


@BOTH
@pytest.mark.parametrize("load", [at(normal_displacement=6.0),
                                  Load(start="normal_displacement=6", path="normal_force=1"),
                                  Load(start="normal_displacement=6",
                                       path="tangential_displacement=1")],
                         ids=["displacement", "force", "sheared"])
def test_newton_in_force_form_reaches_the_same_point(options, load, tight):
    scene = Scene(**SMALL, **options)
    contact, points = points_of(scene, load)
    _, others = points_of(scene, load, Form(form="force"))
    there = others[-1].state.displacement.reshape(len(others[-1].controls), -1)
    here = contact.extended(points[-1].state).reshape(there.shape)
    np.testing.assert_allclose(here, there, atol=1e-9)
    np.testing.assert_allclose(points[-1].forces, others[-1].forces, atol=1e-9)
    np.testing.assert_allclose(points[-1].displacements, others[-1].displacements, atol=1e-8)


@pytest.mark.parametrize("load", [Load(start="normal_displacement=0",
                                       path="normal_displacement=-8"),
                                  Load(start="normal_displacement=6",
                                       path="tangential_displacement=30")],
                         ids=["pull_off", "sliding"])
def test_newton_in_force_form_reaches_the_same_fold(load):
    scene, steps = Scene(**SMALL, height=20.0), Steps(at_fold="stop")
    # Contact may be lost at the fold itself: then a further event follows it at the same load.
    ends = [next(point for point in points_of(scene, load, form, steps)[1] if point.event == "fold")
            for form in (Form(), Form(form="force"))]
    np.testing.assert_allclose(ends[0].load, ends[1].load, rtol=2e-3)


def test_one_component_is_two_without_tangential_load(tight):
    path = Load(start="normal_displacement=4", path="normal_displacement=6; normal_force=2")
    contact, points = points_of(Scene(**SMALL, tangential="off"), path)
    _, others = points_of(Scene(**SMALL, tangential="on"), path)
    assert len(points[-1].controls) == 1 and len(others[-1].controls) == 2
    for name in ("load", "displacements", "forces"):
        assert getattr(points[-1], name)[0] == pytest.approx(getattr(others[-1], name)[0],
                                                             abs=1e-10)
    two = others[-1].state.displacement
    assert not two[1].any()
    assert points[-1].state.window == others[-1].state.window
    np.testing.assert_allclose(points[-1].state.displacement[0], two[0], atol=1e-10)


# Windows

def imbalance_on_the_cell(contact, point, cell):
    """Largest imbalance of displacements over all nodes of the cell, ranges of the law."""
    form = DisplacementForm(contact, contact.grid.whole, point.controls)
    form.set_load(point.load)
    means = cell.reshape(len(cell), -1).mean(axis=1)
    residual = form.residual(form.pack(cell, means[form.forced]), np.empty(form.size))
    return np.max(np.abs(residual[:form.count])) * form.root


@BOTH
def test_fields_balance_on_the_whole_cell(options, tight):
    scene = Scene(**SMALL, **options)
    branch = Branch(scene, SHEARED)
    for point in branch:
        contact = branch.contact
        assert not point.state.window.is_whole
        cell = contact.extended(point.state)
        assert imbalance_on_the_cell(contact, point, cell) < 1e-9
        np.testing.assert_allclose(cell.reshape(len(cell), -1).mean(axis=1), point.state.means,
                                   atol=1e-9)
        outside = cell[0] + contact.initial_gap
        outside[point.state.window.indices] = np.inf
        assert outside.min() > 30.0


@BOTH
def test_window_changes_nothing(options, tight):
    scene = Scene(**SMALL, **options)
    rows, fields = [], []
    for window in ("auto", "off"):
        branch = Branch(scene, SHEARED, form=Form(window=window),
                        steps=Steps(initial_step=0.5, largest_step=0.5))
        point = list(branch)[-1]
        assert point.state.window.is_whole == (window == "off")
        rows.append(branch.observe(point))
        fields.append(branch.contact.extended(point.state))
    np.testing.assert_allclose(*fields, atol=1e-8)
    for name in ("normal_force", "tangential_force", "contact_area", "minimum_gap",
                 "maximum_pressure", "maximum_tangential_gap", "maximum_tangential_traction",
                 "approach", "mean_tangential_displacement"):
        assert rows[0][name] == pytest.approx(rows[1][name], abs=1e-8), name


def test_window_grows_with_the_contact():
    scene = Scene(**SHARP)
    branch = Branch(scene, at(normal_displacement=1.0))
    small = next(iter(branch))
    grown = branch.corrector.solve(small.state, (DISPLACEMENT,), np.array([10.0]), 100)
    assert grown.state.window.size > small.state.window.size
    contact, points = points_of(scene, at(normal_displacement=10.0))
    np.testing.assert_allclose(branch.contact.extended(grown.state),
                               contact.extended(points[0].state), atol=1e-6)
    assert imbalance_on_the_cell(contact, grown, branch.contact.extended(grown.state)) < 1e-6


def shifted_scene(folder, shift, **options):
    """The cylinder as a file of heights, moved by a number of nodes around the cell."""
    scene = Scene(**{**SMALL, **options})
    x = np.arange(scene.shape[0]) * scene.spacings[0] - scene.periods[0] / 2
    path = folder / f"parabola{shift}.npy"
    np.save(path, np.roll(-x ** 2 / 2, shift))
    return Scene(**{**SMALL, **options}, geometry="file", geometry_file=str(path))


@pytest.mark.parametrize("shift", [0, 37, 250, 256, 300, 511])
def test_translation(tmp_path, shift, tight):
    """The same contact anywhere in the cell, also across its border, where the window wraps
    around."""
    steps = Steps(initial_step=0.5, largest_step=0.5)
    contact, points = points_of(Scene(**SMALL, height=math.inf), SHEARED, steps=steps)
    moved_contact, moved = points_of(shifted_scene(tmp_path, shift, height=math.inf), SHEARED,
                                     steps=steps)
    np.testing.assert_allclose(moved_contact.initial_gap, np.roll(contact.initial_gap, shift),
                               atol=1e-12)
    here, there = contact.extended(points[-1].state), moved_contact.extended(moved[-1].state)
    np.testing.assert_allclose(there, np.roll(here, shift, axis=-1), atol=1e-8)
    assert moved[-1].state.window.size == pytest.approx(points[-1].state.window.size, rel=0.05)
    for point in (points[-1], moved[-1]):
        assert not point.state.window.is_whole
    if shift == 256:
        window = moved[-1].state.window
        assert window.start[0] + window.shape[0] > contact.grid.shape[0]


def test_body_far_from_the_flat():
    """Nothing is within range: a window of next to nothing, no force, and displacements that are
    uniform."""
    for form in (Form(), Form(window="off"), Form(form="force")):
        branch = Branch(Scene(**SMALL), at(normal_displacement=-20.0), form=form)
        point = next(iter(branch))
        row = branch.observe(point)
        assert form != Form() or point.state.window.size == 3
        assert (abs(row["normal_force"]) < 1e-20 and row["contact_area"] == 0.0
                and not point.in_contact)
        assert (row["minimum_gap"] == pytest.approx(20.0, rel=1e-10)
                and row["approach"] == pytest.approx(-20.0, rel=1e-10))
        np.testing.assert_allclose(branch.contact.extended(point.state), 60.0, rtol=1e-10)


def test_window_holds_the_range_of_the_law():
    contact, points = points_of(Scene(**SMALL), at(normal_displacement=6.0))
    cell = contact.extended(points[0].state)[0] + contact.initial_gap
    window = contact.window(cell)
    outside = cell.copy()
    outside[window.indices] = np.inf
    assert outside.min() >= Modified.range
    assert window.size < 1.3 * np.count_nonzero(cell < Modified.range)


# Work

class Counter:
    """Cost of every real transform, from the sizes of its arrays, in transforms of a cell of
    ``size`` points, of those in single precision apart."""

    def __init__(self, size):
        self.size, self.cost, self.single = size, 0.0, 0.0

    def add(self, real, axes):
        """Count the transforms along the axes of a real array."""
        points = math.prod(real.shape[axis] for axis in axes)
        cost = real.size * math.log(points) / (self.size * math.log(self.size))
        if real.itemsize == 4:
            self.single += cost
        else:
            self.cost += cost


def count_compiled(monkeypatch, count):
    """Have every plan that the compiled kernels execute counted, a row's as its points."""
    shapes, pointers = {}, library.pointers(library.shared())
    planned, line = transforms.Real._plan, lines.Line.__init__

    def planned_real(self, spectrum):
        planned(self, spectrum)
        shapes.update(dict.fromkeys((self._plans.to_row, self._plans.to_half),
                                    (self.count, *self.shape)))

    def made_line(self, points, closed, single):
        line(self, points, closed, single)
        shapes.update(dict.fromkeys((self._plans.to_row, self._plans.to_half), (1, points)))

    def counting(name, number):
        kind = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * (3 if name.startswith("to_") else 1))
        execute = kind(getattr(pointers, name))

        def counted(plan, *memory):
            shape = shapes[plan]
            count.add(np.broadcast_to(number, shape), range(1, len(shape)))
            execute(plan, *memory)

        return kind(counted)

    count.callbacks = {f"{name}{end}": counting(f"{name}{end}", number)
                       for name in ("execute", "to_half", "to_row")
                       for end, number in (("", np.float64(0.0)), ("_single", np.float32(0.0)))}
    lines.line.cache_clear()  # plans of other tests are not known here
    monkeypatch.setattr(transforms.Real, "_plan", planned_real)
    monkeypatch.setattr(lines.Line, "__init__", made_line)
    for name, callback in count.callbacks.items():  # kept as long as the count
        monkeypatch.setattr(pointers, name, ctypes.cast(callback, ctypes.c_void_p).value)


@pytest.fixture
def counter(monkeypatch):
    """Counts pyFFTW's transforms, SciPy's cosines and sines, and those of compiled kernels; others
    would not be counted by the grid, and are errors."""
    count, cosines, sines = Counter(SHARP["points"]), scipy.fft.dctn, scipy.fft.dst
    if library.reason() is None:
        count_compiled(monkeypatch, count)

    class CountedFFTW(pyfftw.FFTW):
        def execute(self):
            count.add(self.output_array if self.direction == "FFTW_BACKWARD" else self.input_array,
                      self.axes)
            super().execute()

        def __call__(self, *args, **kwargs):
            count.add(self.output_array if self.direction == "FFTW_BACKWARD" else self.input_array,
                      self.axes)
            return super().__call__(*args, **kwargs)

    def counted(values, kind, axes, overwrite_x):
        count.add(values, axes)
        return cosines(values, kind, axes=axes, overwrite_x=overwrite_x)

    def counted_sines(values, kind, axis):
        # (sines between two nodes where they vanish, which count, too)
        count.add(np.pad(values, 1) if kind == 1 else values, (axis,))
        return sines(values, kind, axis=axis)

    def forbidden(*args, **kwargs):
        raise AssertionError("a transform that the grid does not count")

    monkeypatch.setattr(pyfftw, "FFTW", CountedFFTW)
    names = [before + kind + "fft" + end for before, kind, end in itertools.product(("", "i"),
                                                                                    ("", "r", "h"),
                                                                                    ("", "2", "n"))]
    names += [before + kind + end for before, kind, end in itertools.product(("", "i"),
                                                                             ("dct", "dst"),
                                                                             ("", "n"))]
    names += ["fftconvolve", "oaconvolve", "convolve"]
    for module in (np.fft, scipy.fft, scipy.signal):
        for name in names:
            if hasattr(module, name):
                monkeypatch.setattr(module, name, forbidden)
    monkeypatch.setattr(scipy.fft, "dctn", counted)
    monkeypatch.setattr(scipy.fft, "dst", counted_sines)
    return count


WINDOW = Form()
CELL = Form(window="off")
STIFF = Form(form="force")
ALL = Form(symmetry="off")
HALVES, QUICK = (Form(linear_precision="single", symmetry=symmetry) for symmetry in ("auto", "off"))


@pytest.mark.parametrize("form, predictor", [(WINDOW, "none"), (WINDOW, "secant"),
                                             (WINDOW, "tangent"), (WINDOW, "edge"), (CELL, "edge"),
                                             (STIFF, "tangent"), (STIFF, "edge"), (ALL, "edge"),
                                             (HALVES, "edge"), (QUICK, "edge")],
                         ids=["window-none", "window-secant", "window-tangent", "window-edge",
                              "cell-edge", "force-tangent", "force-edge", "no symmetry",
                              "single", "single-no symmetry"])
def test_transforms_of_a_run_are_all_counted(counter, form, predictor):
    branch = Branch(Scene(**SHARP, height=20.0), Load(start="normal_displacement=6",
                                                      path="normal_displacement=20; "
                                                      "tangential_displacement=3, "
                                                      "normal_force=12"),
                    Steps(predictor=predictor, initial_step=(2.0, 0.3), largest_step=(4.0, 0.6)),
                    form)
    spent, windows = np.zeros(2), set()
    names = "transforms", "transforms_single"
    for point in branch:
        branch.observe(point)
        spent += [point.spent[name] for name in names]
        windows.add((point.state.window.start, point.state.window.shape))
    assert len(windows) > 2 or form in (CELL, STIFF)
    assert point.spent["linear_iterations"] > 0
    rest = branch.corrector.account()
    spent += [rest[name] for name in names]
    assert spent[0] > 20 and (spent[1] > 20) == (form in (HALVES, QUICK))
    np.testing.assert_allclose(spent, [counter.cost, counter.single], rtol=1e-12)


PLANAR = {"dimension": 2, "points": 64, "period": 12.0, "geometry": "sphere", "normal_maugis": 2.0}


def held_arrays(root, depth=8):
    """Name -> array for every array reachable from an object, each block of memory once."""
    found, seen = {}, set()

    def visit(thing, name, depth):
        while isinstance(thing, np.ndarray) and isinstance(thing.base, np.ndarray):
            thing = thing.base
        if id(thing) in seen or depth < 0:
            return
        seen.add(id(thing))
        if isinstance(thing, np.ndarray):
            found[name] = thing
            return
        parts = (thing.items() if isinstance(thing, dict) else enumerate(thing)
                 if isinstance(thing, (list, tuple)) else vars(thing).items()
                 if hasattr(thing, "__dict__") else ())
        for key, part in parts:
            visit(part, f"{name}.{key}", depth - 1)

    visit(root, "", depth)
    return found


@pytest.mark.parametrize("count, most", [(1, 8.0), (3, 13.0)])
def test_memory_of_form_and_preconditioner(count, most):
    """Vectors of components x nodes held beside the SNES: unknown, gap, traction, tangent, spectra,
    symbols, core zones; not what laws compute in, which is of a few thousand nodes on every
    grid."""
    contact = Contact(Scene(**PLANAR))
    form = DisplacementForm(contact, contact.grid.whole, (DISPLACEMENT,) * count)
    form.set_load(np.full(count, 0.5))
    unknown = form.pack(np.zeros(form.shape), [])
    form.residual(unknown, np.empty(form.size))
    form.linearise(unknown)
    zone = CoreZone(form)
    held = {name: array.nbytes / unknown.nbytes
            for name, array in held_arrays([form, zone]).items() if "._programs." not in name}
    assert sum(held.values()) < most, held


@pytest.mark.parametrize("body", BODIES)
def test_the_kernel_of_a_block_is_found_once_whatever_the_number_of_components(body):
    contact = contact_of(2, body)
    first = contact.operator(1).kernel((0, 0))
    before = contact.grid.counter.transforms
    assert contact.operator(2).kernel((0, 0)) is first
    assert contact.grid.counter.transforms == before
    # Blocks that differ have kernels of their own, each by an FFT of NumPy.
    for key, block in contact.operator(2).blocks.items():
        np.testing.assert_allclose(contact.operator(2).kernel(key),
                                   np.fft.irfft(block) * contact.grid.size, atol=1e-14)
    stiff = contact.operator(2, "stiffness")
    assert stiff.kernel((0, 0)) is not first


def test_forms_of_old_windows_are_released():
    """A run over many windows keeps the memory of one or two: petsc4py 3.18 frees what Python drops
    only when told to."""
    def alive():
        gc.collect()
        return sum(isinstance(thing, DisplacementForm) for thing in gc.get_objects())

    before = alive()
    branch = Branch(Scene(**SHARP), Load(start="normal_displacement=1",
                                         path="normal_displacement=20"))
    windows = {point.state.window.shape for point in branch}
    assert len(windows) > 3
    assert alive() <= before + 2


def test_a_form_is_released_before_the_next_is_made(monkeypatch):
    """Two of them with their Krylov vectors would be twice the memory."""
    made, most, create = weakref.WeakSet(), [], equations.create_snes

    def creating(form, *given):
        snes = create(form, *given)
        made.add(form)
        gc.collect()
        most.append(len(made))
        return snes

    monkeypatch.setattr(equations, "create_snes", creating)
    load = Load(start="normal_displacement=1", path="normal_displacement=20")
    for _ in Branch(Scene(**SHARP), load, Steps(), Form(cascade=False)):
        pass
    assert len(most) > 3 and max(most) == 1


def test_memory_of_large_forms_goes_back_to_the_system(monkeypatch):
    """With the form, and not that of small ones, of which there are many."""
    given = []
    monkeypatch.setattr(vectors, "_give_back", lambda: given.append(system.form))
    for large in (math.inf, 1):
        monkeypatch.setattr(krylov, "LARGE", large)
        system = Branch(Scene(**LINE), Load(start="normal_displacement=1",
                                            path="normal_displacement=2")).corrector
        system.form = DisplacementForm(system.contact, system.contact.widest, (DISPLACEMENT,))
        system.release()
    assert given == [None]


@pytest.mark.parametrize("kind", ["window", "displacement", "force"])
@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("body", ["thick", "soft"])
def test_product_allocates_less_than_a_vector(kind, count, body):
    contact = Contact(Scene(**{**PLANAR, "points": 192}, **BODIES[body]))
    controls = (DISPLACEMENT,) * count
    box = Window(contact.grid, (140, 30), (110, 100)) if kind == "window" else contact.grid.whole
    form = ForceForm(contact, controls) if kind == "force" else DisplacementForm(contact, box,
                                                                                 controls)
    form.set_load(np.full(count, 0.5))
    vector, out = np.random.default_rng(7).normal(size=(2, form.size))
    form.linearise(vector)
    form.apply_jacobian(vector, out)
    gc.collect()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(6):
        form.apply_jacobian(vector, out)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # numpy's casting buffer of 8192 complex numbers is not counted.
    assert peak - before - 8192 * 16 < 8 * count * math.prod(box.circle())


# What cannot be changed


@pytest.mark.parametrize("made", ["cell", "coarse", "alone", "neighbours"])
def test_a_contact_is_immutable(made):
    alone = IsolatedContact(lay_out(Scene(period=math.inf, spacing=0.3, normal_maugis=1.0), 1.0))
    contact = {"cell": contact_of(2), "coarse": contact_of(1).coarse(0.5), "alone": alone,
               "neighbours": alone.periodic}[made]
    for name in ("law", "initial_gap", "body", "grid", "scene", "ranges", "widest", "datum",
                 "isolated", "anything"):
        with pytest.raises(AttributeError, match=f"immutable, its {name} cannot be set"):
            setattr(contact, name, None)
    with pytest.raises(AttributeError, match="its law cannot be deleted"):
        del contact.law
    for array in (contact.initial_gap, contact.ranges):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_a_law_in_place_of_the_scenes_is_that_of_all_that_is_made():
    """Of coarser and finer grids, too, and of the neighbours of an isolated contact."""
    law = Modified(0.3, 0.2)
    scene = Scene(points=128, period=20.0, normal_maugis=2.0, residual_friction=0.9)
    alone = lay_out(Scene(period=math.inf, spacing=0.3, normal_maugis=1.0), 1.0)
    for contact in (Contact(scene, law=law), IsolatedContact(alone, law=law)):
        for other in (contact, contact.coarse(0.5), finer_contact(contact, 2), contact.periodic):
            assert type(other.law) is Modified and vars(law).items() <= vars(other.law).items()


def test_a_gap_in_place_of_the_scenes():
    contact = contact_of(1)
    given = np.array(contact.initial_gap)
    other = Contact(contact.scene, gap=given)
    given[0] = np.nan
    np.testing.assert_array_equal(other.initial_gap, contact.initial_gap)
    rough = Contact(contact.scene, np.cos(2 * np.pi * np.arange(64) / 64)
                    + 0.1 * np.sin(6 * np.pi * np.arange(64) / 64))
    finer, coarse = finer_contact(rough, 2), rough.coarse(0.1)
    np.testing.assert_allclose(finer.initial_gap[::2], rough.initial_gap, atol=1e-12)
    np.testing.assert_allclose(coarse.initial_gap / coarse.ranges[0],
                               rough.initial_gap[::2] / rough.ranges[0], atol=1e-12)


@pytest.mark.parametrize("gap, sentence", [
    (np.zeros(5), r"the gap has the shape \(5,\), the grid has \(64,\): give one number for each"),
    (np.full(64, math.nan), "the gap has to be real and finite numbers"),
    (np.full(64, 1j), "the gap has to be real"),
    (np.ma.masked_greater(np.arange(64.0), 60.0), "the gap has to be real and finite numbers")])
def test_a_gap_of_ones_own_has_to_fit(gap, sentence):
    scene = Scene(points=64, period=20.0, normal_maugis=1.0)
    with pytest.raises(InputError, match=sentence):
        Contact(scene, gap=gap)
    with pytest.raises(InputError, match=sentence.replace("gap has", "heights have")):
        Contact(scene, gap)
    assert Contact(scene, gap=[1] * 64).initial_gap.tolist() == [1.0] * 64


def test_what_is_made_of_a_contact_does_not_hold_it():
    """Its arrays are given back with its last use, those of coarser grids of a motion for
    instance, not when Python looks for rings of objects."""
    contact = contact_of(2)
    operators = [contact.operator(2, kind) for kind in ("compliance", "stiffness")]
    kernels = [operator.kernel((0, 0)) for operator in operators]
    state = State(contact.widest, np.zeros((2, contact.grid.size)), np.zeros(2))
    survey = contact.survey(state)
    assert contact.survey(state) is survey and not np.array_equal(*kernels)
    contact.site(contact.widest), contact.circle(0, contact.grid.shape)
    assert np.array_equal(contact_of(2).gap_on(contact.widest), contact.gap_on(contact.widest))
    held = [weakref.ref(thing) for thing in (contact, contact.coarse(0.5), *operators)]
    gc.disable()
    try:
        del contact, operators
        assert [thing() for thing in held] == 4 * [None]
    finally:
        gc.enable()
