"""Even and odd states on half the line or a quarter of the plane: the same numbers for less work,
where scene and load path are even."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from processes import call, refused

from contactsnes import Branch, Contact, Form, Load, Scene, Steps
from contactsnes.contact.bordered import ArcLength
from contactsnes.contact.even_form import EvenForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.isolated import IsolatedContact, lay_out
from contactsnes.contact.problem import DISPLACEMENT, FORCE
from contactsnes.contact.state import spread
from contactsnes.contact.states import State, onto
from contactsnes.contact.symmetry import EVEN
from contactsnes.dynamics import jumps
from contactsnes.grid.cell import Convolution, Grid
from contactsnes.grid.cosines import Cosines, EvenConvolution
from contactsnes.grid.even import EvenWindow
from contactsnes.grid.mirrors import centred
from contactsnes.grid.operator import Operator
from contactsnes.grid.parity import asymmetry, obstacle, one_mirror, parities, parity
from contactsnes.grid.sides import even_convolution
from contactsnes.grid.transfer import smooth
from contactsnes.grid.windows import Window
from contactsnes.kernels.choice import chosen
from contactsnes.options.fields import InputError
from contactsnes.solvers.core_zone import CoreOptions
from contactsnes.solvers.preconditioners import zone

LINE = Scene(points=512, period=40.0, normal_maugis=3.0, residual_friction=0.5)
SOFT = replace(LINE, points=64, period=16.0, normal_maugis=2.0, tangential_maugis=1.5,
               residual_adhesion=0.1, height=200.0)
SPHERE = Scene(dimension=2, points=64, period=12.0, geometry="sphere", normal_maugis=2.0)
ALL, HALF = Form(symmetry="off"), Form(symmetry="even")

PLANE = replace(SPHERE, points=(16, 20), period=(12.0, 14.0), tangential_maugis=1.5)
COUPLED = {"poisson": 0.3, "work_ratio": 2.0}
CONTACTS = {"line": Contact(SOFT), "plane": Contact(replace(PLANE, height=5.0)),
            "slipping": Contact(PLANE), "coupled": Contact(replace(PLANE, **COUPLED)),
            "coupled line": Contact(replace(SOFT, **COUPLED)),
            "alone": IsolatedContact(lay_out(replace(SOFT, period=math.inf, height=math.inf,
                                                     points=None, spacing=0.1), 0.1))}
BOXES = {"part": ("line", (9,)), "cell": ("line", (64,)), "much": ("line", (51,)),
         "box": ("plane", (9, 13)), "strip": ("plane", (9, 20)), "plane": ("plane", (16, 20)),
         "alone": ("alone", (41,))}
ODD = {f"{name} {box}": (name, BOXES[box][1])
       for name, boxes in {"slipping": ("box", "strip", "plane"), "coupled line": ("part", "cell"),
                           "coupled": ("box", "strip", "plane")}.items() for box in boxes}
"""Boxes of contacts some of whose components are odd."""
ONE = {f"across {'yx'[loaded - 1]} {box}": (f"coupled {box}", loaded)
       for loaded in (1, 2) for box in ("box", "strip", "plane")}
"""Boxes of contacts that have one mirror, across a load along a component."""

every_box = pytest.mark.parametrize("box", BOXES)


def window_of(box):
    """A contact, and a window of it about the apex."""
    name, shape = (BOXES | ODD)[ONE[box][0] if box in ONE else box]
    contact = CONTACTS[name]
    return contact, Window(contact.grid,
                           [total // 2 - n // 2 for n, total in zip(shape, contact.grid.shape)],
                           shape)


def fields(window, count, seed=1, signs=None):
    """Random even fields (count, nodes of the full window), or odd ones by ``signs``."""
    even = EvenWindow(window, signs)
    return even.unfold(np.random.default_rng(seed).normal(size=(count, even.size)))


def signs_of(contact, count, loaded=()):
    """Parities of the components of a contact."""
    return parities(contact.operator(count), count, loaded)


# Nodes and transforms


@every_box
def test_weights_count_every_node_once(box):
    window = window_of(box)[1]
    even, values = EvenWindow(window), fields(window, 2)
    assert asymmetry(window, values) == 0.0 and asymmetry(window,
                                                          values + np.arange(window.size)) > 0.0
    np.testing.assert_array_equal(even.unfold(even.fold(values)), values)
    np.testing.assert_allclose(even.grid.sum(even.fold(values)), window.grid.sum(values),
                               rtol=1e-12)
    np.testing.assert_allclose(even.grid.mean(even.fold(values)), window.grid.mean(values),
                               rtol=1e-12)
    assert even.grid.count(even.fold(values[0]) > 0.2) == window.grid.count(values[0] > 0.2)
    cell = np.zeros((1, *window.grid.shape))
    window.put(values[:1], cell)
    np.testing.assert_array_equal(even.take(cell), even.fold(values[:1]))


def test_windows_are_centred_on_the_apex():
    grid = Grid((32, 40), (12.0, 14.0))
    for start, shape, wanted in [((15, 19), (2, 2), ((15, 19), (3, 3))),
                                 ((10, 20), (4, 1), ((10, 19), (13, 3))),
                                 ((0, 30), (32, 5), ((0, 6), (32, 29))),
                                 ((30, 2), (5, 10), ((0, 2), (32, 37)))]:
        found = centred(Window(grid, start, shape))
        assert (found.start, found.shape) == wanted


def test_asymmetry_of_what_is_no_number_is_none():
    window = window_of("part")[1]
    assert not asymmetry(window, np.where(np.arange(9) == 2, np.nan, 0.0)[None]) <= EVEN
    aside = Window(window.grid, (34,), (9,))
    assert asymmetry(aside, np.zeros((1, 9))) == math.inf


def test_asymmetry_is_told_where_both_images_are_known():
    grid = CONTACTS["line"].grid
    values = np.abs(np.arange(10.0) - 4.0)[None]
    assert asymmetry(Window(grid, (28,), (10,)),
                     values) == 0.0 and asymmetry(Window(grid, (27,), (10,)), values) == 2.0


@every_box
@pytest.mark.parametrize("count", [1, 2])
def test_convolution_is_that_of_all_nodes(box, count):
    contact, window = window_of(box)
    components = 1 if contact.grid.shape[1:] else count
    even, values = EvenWindow(window), fields(window, components)
    expected = Convolution(window, contact.operator(components),
                           components).apply(values, np.empty_like(values))
    convolution = EvenConvolution(even, contact.operator(components), components)
    for _ in range(2):
        found = convolution.apply(even.fold(values), np.empty((components, even.size)))
        np.testing.assert_allclose(even.unfold(found), expected,
                                   atol=1e-12 * np.max(np.abs(expected)))


@pytest.mark.parametrize("box", ODD)
@pytest.mark.parametrize("transposed", [False, True])
def test_convolution_of_odd_fields_is_that_of_all_nodes(box, transposed):
    """For loads along either direction, and none; on the waves of both kinds of transforms."""
    contact, window = window_of(box)
    count = contact.scene.components
    operator = contact.operator(count)
    for loaded in ((), (1,), (count - 1,)):
        signs = signs_of(contact, count, loaded)
        if signs is None:
            assert "coupled" in box and loaded
            continue
        assert any(-1 in own for own in signs)
        even, values = EvenWindow(window, signs), fields(window, count, signs=signs)
        assert asymmetry(window, values, signs) == 0.0 and asymmetry(window, values) > 0.1
        expected = Convolution(window, operator, count).apply(values, np.empty_like(values),
                                                              transposed)
        for make in (Cosines, contact.kernels.even):
            found = EvenConvolution(even, operator, count, make).apply(
                even.fold(values), np.empty((count, even.size)), transposed)
            np.testing.assert_allclose(even.unfold(found), expected,
                                       atol=1e-12 * np.max(np.abs(expected)))


@pytest.mark.parametrize("box", ONE)
@pytest.mark.parametrize("transposed", [False, True])
def test_convolution_of_fields_with_one_mirror_is_that_of_all_nodes(box, transposed):
    contact, window = window_of(box)
    operator, signs = contact.operator(3), one_mirror(contact, 3, (ONE[box][1],))
    even, values = EvenWindow(window, signs), fields(window, 3, signs=signs)
    assert even.mirrors == ((True, False) if "across x" in box else (False, True))
    assert asymmetry(window, values, signs) == 0.0 and asymmetry(window, values) > 0.1
    expected = Convolution(window, operator, 3).apply(values, np.empty_like(values), transposed)
    for make in (chosen(False).even, contact.kernels.even):
        found = even_convolution(even, operator, 3, make).apply(
            even.fold(values), np.empty((3, even.size)), transposed)
        np.testing.assert_allclose(even.unfold(found), expected,
                                   atol=1e-12 * np.max(np.abs(expected)))


def test_parities_are_those_of_body_and_loads():
    """Loads along both directions, or along one that normal tractions move oddly, leave none."""
    slipping, coupled, line = (CONTACTS[name] for name in ("slipping", "coupled", "coupled line"))
    even, odd, across, along = (1, 1), (-1, -1), (-1, 1), (1, -1)
    for loaded in ((), (1,)):
        assert signs_of(slipping, 3, loaded) == (even, even, odd)
    assert signs_of(slipping, 3, (2,)) == (even, odd, even)
    assert signs_of(coupled, 3) == (even, across, along) and signs_of(line, 2) == ((1,), (-1,))
    assert signs_of(CONTACTS["line"], 2, (1,)) == ((1,), (1,))
    for contact, loaded in ((slipping, (1, 2)), (coupled, (1,)), (coupled, (2,)), (line, (1,))):
        assert signs_of(contact, contact.scene.components, loaded) is None


def test_parity_of_a_block_is_measured():
    """A block that is neither even nor odd in a direction has none."""
    operator = CONTACTS["coupled"].operator(3)
    assert parity(operator, (0, 1)) == (-1, 1) and parity(operator, (1, 2)) == (-1, -1)
    for change in (0.1, 0.1j):
        twisted = Operator(operator.grid, {(0, 0): operator.blocks[0, 0] + change
                                           * np.abs(operator.blocks[0, 1] + operator.blocks[1, 2])
                                           * (np.arange(16)[:, None] == 3)})
        assert parity(twisted, (0, 0)) is None and parities(twisted, 1) is None


@pytest.mark.parametrize("box", ODD)
def test_odd_fields_vanish_on_their_axes(box):
    contact, window = window_of(box)
    count = contact.scene.components
    signs = signs_of(contact, count)
    field = fields(window, count, signs=signs)
    for place, direction in itertools.product(range(count), range(len(window.shape))):
        if signs[place][direction] < 0:
            nodes = np.moveaxis(window.box(field[place]), direction, 0)
            aside = np.zeros_like(field)
            np.moveaxis(window.box(aside[place]), direction, 0)[len(nodes) // 2] = 0.1
            assert not nodes[len(nodes) // 2].any()
            assert asymmetry(window, field + aside, signs) == pytest.approx(0.2)
            if window.shape[direction] == window.grid.shape[direction]:
                assert not nodes[0].any()


@pytest.mark.parametrize("box", ODD)
def test_what_is_folded_vanishes_where_it_is_odd_on_its_axes(box):
    contact, window = window_of(box)
    signs = signs_of(contact, contact.scene.components)
    even = EvenWindow(window, signs)
    values = np.random.default_rng(1).normal(size=(len(signs), window.size))
    np.testing.assert_array_equal(even.fold(even.unfold(even.fold(values))), even.fold(values))


@pytest.mark.parametrize("shape", [(11,), (33,), (7, 6), (9, 7), (9, 11)])
@pytest.mark.parametrize("signs", list(itertools.product((1, -1), repeat=2)))
def test_cosines_and_sines_are_sums_of_waves(shape, signs):
    contact = CONTACTS["line" if len(shape) == 1 else "plane"]
    signs = signs[-len(shape):]
    plan = Cosines(contact.grid, shape, 2, (signs, signs))
    before, values = contact.grid.transforms, np.random.default_rng(3).normal(size=(2, *shape))
    for axis, (sign, closed) in enumerate(zip(signs, plan.closed), start=1):
        if sign < 0:
            np.moveaxis(values, axis, 0)[[0, -1] if closed else 0] = 0.0
    plan.real[...] = values
    plan.forward()
    expected = values.copy()
    for axis, (waves, spacing, closed) in enumerate(zip(plan.wavevectors(contact.grid.spacings),
                                                        contact.grid.spacings, plan.closed)):
        nodes, weights = np.arange(shape[axis]), np.full(shape[axis], 2.0)
        weights[0] = 1.0
        if closed:
            weights[-1] = 1.0
        wave = np.cos if signs[axis] > 0 else np.sin
        matrix = weights * wave(waves.reshape(-1)[:, None] * spacing * nodes)
        expected = np.moveaxis(np.tensordot(matrix, expected, axes=(1, axis + 1)), 0, axis + 1)
    np.testing.assert_allclose(plan.spectrum, expected, atol=1e-12)
    plan.backward()
    np.testing.assert_allclose(plan.real / plan.gain, values, atol=1e-13)
    points, size = math.prod(shape), contact.grid.size
    assert contact.grid.transforms - before == pytest.approx(4 * points * math.log(points)
                                                             / (size * math.log(size)))


@every_box
def test_blurred_fields_are_even(box):
    window = window_of(box)[1]
    even = EvenWindow(window)
    places = np.meshgrid(*[np.arange(n) - n // 2 for n in window.grid.shape], indexing="ij")
    width = 1.01 * max(window.grid.spacings)
    # Values that vanish towards the border of the window, as those of a core do, and others that
    # fill it.
    for reach in (0, 100) if window.is_whole else (0,):
        full = window.take(np.max(np.abs(places), axis=0) <= reach)
        np.testing.assert_allclose(smooth(even, even.fold(full), width),
                                   even.fold(smooth(window, full, width)), atol=1e-12)


# The form


def forms(box, controls):
    """The full and the even form of a box under a load, and unknowns of both for the same
    displacements."""
    contact, window = window_of(box)
    signs = one_mirror(contact, 3, (ONE[box][1],)) if box in ONE else None
    full, even = (DisplacementForm(contact, window, controls),
                  EvenForm(contact, window, controls, signs))
    displacement = 0.3 * fields(window, len(controls), signs=even.parities)
    displacement[0] -= 0.3 * full.initial_gap
    scalars = np.where(bare(even), 0.0, [0.1, 0.2, 0.3][:len(controls)])
    for form in (full, even):
        form.set_load(np.where(bare(even), 0.0, np.linspace(0.5, 0.8, len(controls))))
    return (full, even, *(form.pack(displacement, scalars[form.forced]) for form in (full, even)))


def bare(even):
    """Which components of an even form are odd, so that they have neither mean nor load."""
    return np.array([-1 in signs for signs in even.parities])


def cases():
    """Boxes with all the controls that their problems may have and be even."""
    for box, (name, _) in BOXES.items():
        for count in (1, 2) if name == "line" else (1,):
            for controls in itertools.product((DISPLACEMENT, FORCE), repeat=count):
                yield pytest.param(box, controls, id=f"{box}-{'-'.join(controls)}")
    for box, (name, _) in ODD.items():
        for control in (DISPLACEMENT, FORCE):
            controls = (control,) * CONTACTS[name].scene.components
            yield pytest.param(box, controls, id=f"{box}-{control}")
    for box in ONE:
        for control in (DISPLACEMENT, FORCE):
            yield pytest.param(box, (control,) * 3, id=f"{box}-{control}")


@pytest.mark.parametrize("box, controls", list(cases()))
def test_form_is_the_full_one_for_even_states(box, controls):
    """Residual, its norm, products with the Jacobian and with its transpose, columns of the load,
    forces, preconditioner."""
    full, even, unknown, half = forms(box, controls)
    np.testing.assert_allclose(even.displacement(half), full.displacement(unknown), atol=1e-13)
    assert np.linalg.norm(half) == pytest.approx(np.linalg.norm(unknown), rel=1e-12)

    def same(found, expected):
        """The even form's vector stands for the full form's, and has its norm."""
        scale = np.max(np.abs(expected))
        np.testing.assert_allclose(even.displacement(found), full.displacement(expected),
                                   atol=1e-11 * scale * full.root)
        scalars = np.zeros(len(controls))
        scalars[even.forced] = even.scalars(found)
        np.testing.assert_allclose(scalars[full.forced], full.scalars(expected),
                                   atol=1e-11 * scale)
        assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(expected), rel=1e-10)

    same(even.residual(half, np.empty(even.size)), full.residual(unknown, np.empty(full.size)))
    full.linearise(unknown)
    even.linearise(half)
    displacement = fields(full.window, len(controls), seed=5, signs=even.parities)
    scalars = np.where(bare(even), 0.0, [0.3, -0.4, 0.2][:len(controls)])
    vector, other = (form.pack(displacement, scalars[form.forced]) for form in (full, even))
    same(even.apply_jacobian(other, np.empty(even.size)),
         full.apply_jacobian(vector, np.empty(full.size)))
    same(even.apply_transpose(other, np.empty(even.size)),
         full.apply_transpose(vector, np.empty(full.size)))
    direction = np.where(bare(even), 0.0, np.arange(1.0, 1.0 + len(controls)))
    same(even.load_derivative(direction, np.empty(even.size)),
         full.load_derivative(direction, np.empty(full.size)))


@pytest.mark.parametrize("box, controls", list(cases()))
def test_jacobian_is_the_derivative(box, controls):
    _, even, _, unknown = forms(box, controls)
    even.linearise(unknown)
    random = np.random.default_rng(7)
    vector, other = random.normal(size=(2, even.size)) / np.sqrt(even.size)
    step = 1e-5
    ahead, behind = (even.residual(unknown + sign * step * vector, np.empty(even.size))
                     for sign in (1, -1))
    product = even.apply_jacobian(vector, np.empty(even.size))
    np.testing.assert_allclose((ahead - behind) / (2 * step), product,
                               atol=1e-7 * np.max(np.abs(product)))
    transposed = even.apply_transpose(other, np.empty(even.size))
    assert vector @ transposed == pytest.approx(other @ product, rel=1e-9)


MANY = {"across x strip": (True, FORCE), "across y strip": (False, DISPLACEMENT),
        "slipping strip": (True, DISPLACEMENT), "coupled strip": (False, DISPLACEMENT)}
"""Boxes of many unknowns, with whether it is along an arc and the control of their components here:
of lesser ones in the plane arcs are under forces, others not. The rest is a study, with whole
planes of three components, whose even forms are compared with full ones above."""


def is_study(box, controls, arc):
    """Whether a case of a preconditioner is a study: others show its kind."""
    if box in MANY:
        return MANY[box] != (arc, controls[0])
    lesser = box.split()[-1] in ("box", "strip", "plane", "alone")
    return box.endswith(" plane") or lesser and arc != (controls[0] == FORCE)


@pytest.mark.parametrize("box, controls, arc", [
    pytest.param(*case.values, arc, id=f"{case.id}-{arc}",
                 marks=pytest.mark.study if is_study(*case.values, arc) else ())
    for case in cases() for arc in (False, True)
    if not (arc and case.values[0].split()[-1] == "plane" and " " in case.values[0])])
def test_preconditioner_is_near_the_full_one(box, controls, arc):
    """A linear map that makes the Jacobian about as good as the full form's does."""
    full, even, unknown, half = forms(box, controls)
    spreads = []
    for form, start in ((full, unknown), (even, half)):
        if arc:
            direction = np.where(bare(even), 0.0, 1.0)
            form = ArcLength(form, direction, direction, start, np.ones(form.size), 0.1)
            start = np.append(start, 0.0)
        form.linearise(start)
        made = zone(form, CoreOptions())
        columns = [form.apply_jacobian(made.apply(column, np.empty(form.size)), np.empty(form.size))
                   for column in np.eye(form.size)]
        # (in single precision, which is twice as fast: they are counted)
        values = np.linalg.eigvals(np.array(columns, np.float32))
        spreads.append(np.sort(np.abs(values - 1.0)))
        vector, other = np.random.default_rng(4).normal(size=(2, form.size))
        combined = made.apply(vector + 2.0 * other, np.empty(form.size))
        apart = made.apply(vector, np.empty(form.size)) + 2.0 * made.apply(other,
                                                                           np.empty(form.size))
        np.testing.assert_allclose(combined, apart, atol=1e-9 * np.max(np.abs(combined)))
    # Few eigenvalues lie far from 1.
    assert np.count_nonzero(spreads[1] > 0.5) <= np.count_nonzero(spreads[0] > 0.5) + 1


# Branches


def followed(scene, load, form, **steps):
    """A branch, its points, and what the whole of them cost."""
    branch = Branch(scene, load, Steps(**steps), form)
    points = list(branch)
    names = ("nonlinear_iterations", "linear_iterations", "transforms")
    return branch, points, np.array([sum(point.spent[name] for point in points) for name in names])


def same_points(scene, load, **steps):
    """Whether a branch has the same points with and without symmetry, to the tolerance; costs of
    both."""
    (branch, all_points, all_costs), (half, points, costs) = (followed(scene, load, form, **steps)
                                                              for form in (ALL, HALF))
    assert isinstance(half.corrector.form, EvenForm) and isinstance(branch.corrector.form,
                                                                    DisplacementForm)
    # Steps grow with what an iteration more or less says: all ends of legs, and most points, are
    # the same.
    pairs = [(point, other) for point in points for other in all_points
             if (point.leg, point.event) == (other.leg, other.event)
             and (abs(point.position - other.position) < 1e-12 or point.event in ("fold", "jump"))]
    assert (len(pairs) > len(all_points) / 3 and pairs[0][0] is points[0]
            and pairs[-1] == (points[-1], all_points[-1]))
    assert [point.event for point in points if point.event] == [point.event
                                                                          for point in all_points
                                                                          if point.event]
    for point, other in pairs:
        # Folds are located to 1e-6 in the load, which is their state's distance squared.
        tolerance = 3e-3 if point.event in ("fold", "jump") else 3e-6
        np.testing.assert_allclose(point.load, other.load, rtol=1e-5)
        row, wanted = half.observe(point), branch.observe(other)
        for name in ("normal_displacement", "normal_force", "tangential_displacement",
                     "tangential_force", "contact_area", "minimum_gap", "maximum_pressure"):
            if name in row:
                assert row[name] == pytest.approx(wanted[name], rel=tolerance, abs=tolerance,
                                                  nan_ok=True), (point.load, name)
        full = DisplacementForm(half.contact, point.state.window, point.controls)
        full.set_load(point.load)
        norm = np.linalg.norm(full.residual(full.pack(point.state.displacement,
                                                      point.state.means[full.forced]),
                                            np.empty(full.size)))
        assert norm == pytest.approx(point.residual_norm, rel=1e-3, abs=1e-12) and norm < 1.001e-8
    return all_costs, costs


LINES = {"normal": (LINE, Load(path="normal_displacement=4"), {}),
         "force": (LINE, Load(path="normal_force=6; normal_force=2"), {}),
         "cell": (replace(LINE, geometry="sinusoid", period=20.0),
                  Load(path="normal_displacement=6"), {}),
         "sheared": (LINE, Load(start="normal_displacement=2",
                                path="normal_force=4; tangential_displacement=30"), {}),
         "soft": (replace(LINE, height=250.0),
                  Load(path="normal_displacement=4, tangential_force=0.5"), {}),
         "alone": (replace(LINE, period=math.inf, height=math.inf, points=None, spacing=0.08),
                   Load(start="normal_force=1", path="normal_force=4, tangential_force=0.3"), {})}


@pytest.mark.parametrize("name", LINES)
def test_line_is_half_the_work(name):
    scene, load, steps = LINES[name]
    costs, half = same_points(scene, load, **steps)
    # from afar rounding has a say in the number of iterations
    assert (half[0] == pytest.approx(costs[0], rel=0.15)
            and half[1] == pytest.approx(costs[1], rel=0.15))
    assert 0.35 * costs[2] < half[2] < 0.6 * costs[2]


def test_sphere_is_a_quarter_of_the_work():
    costs, quarter = same_points(SPHERE, Load(start="normal_force=0", path="normal_force=3"))
    # (all nodes are preconditioned in patches, which takes a few iterations more)
    assert (quarter[0] == pytest.approx(costs[0], rel=0.1)
            and quarter[1] == pytest.approx(costs[1], rel=0.2))
    assert 0.12 * costs[2] < quarter[2] < 0.35 * costs[2]


def test_predictions_on_a_whole_cell_stay_even():
    """The first node of a cell has no mirror image to be followed with: rounding there is not a
    state's own asymmetry."""
    same_points(replace(SPHERE, normal_maugis=0.55), Load(start="normal_force=0.5",
                                                          path="normal_force=2"))


def test_folds_and_jumps_stay():
    """A jump moves on the whole cell, free to leave symmetry; it comes back to an even state
    here."""
    pulled = Load(start="normal_displacement=1", path="normal_displacement=-3")
    same_points(replace(LINE, height=math.inf), pulled, initial_step=0.1, largest_step=0.1)
    slid = Load(start="normal_force=2", path="tangential_displacement=90")
    same_points(replace(LINE, height=250.0), slid, initial_step=2.0, largest_step=4.0)


@pytest.mark.parametrize("more, mirrors", [({}, {0: 2, 1: 2, 2: 2, 3: 0}),
                                           (COUPLED, {0: 2, 1: 2, 2: 1, 3: 0})])
@pytest.mark.parametrize("stepping", ["natural", "arclength"])
def test_legs_are_even_before_others_are_not(more, mirrors, stepping):
    """Without coupling in both directions until there are loads along both, else until there is
    one, which leaves the mirror across it."""
    scene = replace(SPHERE, points=32, normal_maugis=1.0, **more)
    load = Load(start="normal_displacement=1", path="normal_displacement=1.5; "
                "tangential_displacement_x=0.5; tangential_displacement_y=0.3")
    force = None
    for form in (ALL, Form()):
        branch, kinds = Branch(scene, load, Steps(type=stepping), form), []
        for point in branch:
            even = isinstance(branch.corrector.form, EvenForm)
            kinds.append((point.leg, sum(branch.corrector.form.half.window.mirrors)
                          if even else 0))
        if form == Form():
            assert set(kinds) == set(mirrors.items())
            np.testing.assert_allclose(point.forces, force, rtol=1e-6)
        force = point.forces


@pytest.mark.parametrize("along", "xy")
@pytest.mark.parametrize("more, mirrors, share", [({}, 2, 0.4), (COUPLED, 1, 0.75)])
def test_a_sheared_sphere_is_a_part_of_the_work(along, more, mirrors, share):
    """Its slip along the load is even, that across it odd, in both directions; of a body that
    couples slip and gap about the load alone."""
    scene = replace(SPHERE, tangential_maugis=1.5, residual_friction=0.5, **more)
    load = Load(start="normal_displacement=1", path=f"tangential_displacement_{along}=80; "
                                                    "normal_displacement=0.5")
    (_, all_points, all_costs), (branch, points, costs) = (
        followed(scene, load, form, predictor="secant")
        for form in (ALL, HALF if mirrors == 2 else Form()))
    assert isinstance(branch.corrector.form, EvenForm) and len(points) == len(all_points)
    assert sum(branch.corrector.form.half.window.mirrors) == mirrors
    for point, other in zip(points, all_points):
        np.testing.assert_allclose(point.forces, other.forces, atol=1e-6)
        np.testing.assert_allclose(states_onto(point, other), other.state.displacement, atol=3e-6)
        assert point.residual_norm < 1.001e-8
    assert np.abs(points[-1].state.displacement[2 if along == "x" else 1]).max() > 0.01
    assert costs[2] < share * all_costs[2]


def states_onto(point, other):
    """Displacements of a point on the window of another."""
    return onto(point.state, other.state.window)


def test_a_pressed_compressible_body_is_even_without_a_load_along_it():
    """Normal tractions move its surface oddly."""
    for scene in (replace(LINE, poisson=0.3), replace(SPHERE, **COUPLED)):
        load = Load(path="normal_displacement=1.5")
        (_, all_points, all_costs), (branch, points, costs) = (followed(scene, load, form)
                                                               for form in (ALL, HALF))
        assert isinstance(branch.corrector.form, EvenForm)
        assert np.abs(points[-1].state.displacement[1]).max() > 0.01
        np.testing.assert_allclose(points[-1].forces, all_points[-1].forces, atol=1e-6)
        np.testing.assert_allclose(states_onto(points[-1], all_points[-1]),
                                   all_points[-1].state.displacement, atol=3e-6)
        assert costs[2] < (0.7 if scene.dimension == 1 else 0.4) * all_costs[2]


def test_a_state_that_is_odd_to_rounding_is_solved_to_rounding():
    """The preconditioner has no odd component on the axes: what a state has of it there, an
    iteration could not take away."""
    branch = Branch(replace(SPHERE, points=32, normal_maugis=1.0, **COUPLED),
                    Load(path="normal_displacement=1.5"))
    *_, point = branch
    branch.corrector.snes.setTolerances(atol=1e-11)
    branch.corrector.snes.getKSP().setTolerances(atol=2e-12)
    before = branch.corrector.totals["linear_iterations"]
    noise = 1e-8 * np.random.default_rng(1).normal(size=point.state.displacement.shape)
    found = branch.corrector.solve(State(point.state.window, point.state.displacement + noise,
                                         point.state.means), point.controls, point.load)
    assert isinstance(branch.corrector.form, EvenForm)
    assert found.residual_norm < 1e-11
    assert branch.corrector.totals["linear_iterations"] - before < 40


def test_a_slip_that_is_not_odd_ends_symmetry():
    """A perturbation across the load, and a load across it."""
    scene, said = replace(SPHERE, points=32, normal_maugis=1.0), []
    load = Load(start="normal_displacement=1", path="tangential_displacement_x=0.5")
    branch = Branch(scene, load, log=said.append)
    *_, point = branch
    assert isinstance(branch.corrector.form, EvenForm) and not said
    tilted = point.state.displacement.copy()
    tilted[2] += 1e-3
    found = branch.corrector.solve(State(point.state.window, tilted, point.state.means),
                                   point.controls, point.load)
    assert not isinstance(branch.corrector.form, EvenForm)
    assert said == ["the state is not even about the apex: going on without symmetry"]
    np.testing.assert_allclose(found.forces, point.forces, atol=1e-6)
    branch = Branch(scene, load)
    *_, point = branch
    across = branch.corrector.solve(point.state, point.controls, point.load + [0.0, 0.0, 0.2])
    assert not isinstance(branch.corrector.form, EvenForm) and across.forces[2] > 1e-3


def test_a_path_goes_on_from_an_archive():
    load = Load(start="normal_force=1", path="normal_force=3; tangential_displacement=20")
    branch, points, _ = followed(LINE, load, HALF)
    half = len(points) // 2
    again = Branch(LINE, load, form=HALF)
    again.history = [again.restored(branch.packed(point)) for point in points[:half]]
    rest = list(again)
    assert len(rest) == len(points) - half and isinstance(again.corrector.form, EvenForm)
    np.testing.assert_allclose(rest[-1].state.displacement, points[-1].state.displacement,
                               atol=1e-7)


@pytest.mark.parametrize("scene, load", [
    (SOFT, Load(start="normal_displacement=1", path="normal_displacement=1.5; "
                                                    "tangential_displacement=2")),
    (replace(SPHERE, points=(24, 28)), Load(start="normal_displacement=0.5",
                                            path="normal_force=1"))], ids=["line", "plane"])
def test_relaxation_moves_half_of_even_states(scene, load, options):
    """The points of all nodes, for half or a quarter of the transforms."""
    options(snes_type="python", snes_python_type="contactsnes.solvers.relaxation.Fire")
    (whole, all_points, all_costs), (half, points, costs) = (
        followed(scene, load, replace(form, form="force")) for form in (ALL, HALF))
    assert half.corrector.form.even and not whole.corrector.form.even
    assert len(points) == len(all_points)
    for point, other in zip(points, all_points):
        np.testing.assert_allclose(point.state.displacement, other.state.displacement, atol=1e-6)
        np.testing.assert_allclose(point.forces, other.forces, atol=1e-6)
        assert asymmetry(point.state.window, point.state.displacement) == 0.0
        assert point.residual_norm <= 1e-8
    # Where a cell closes its whole and its half are foretold a little differently.
    assert costs[0] == pytest.approx(all_costs[0], rel=0.15)
    assert costs[2] < (0.6 if scene.dimension == 1 else 0.35) * all_costs[2]


def test_relaxation_before_a_solve_moves_half_of_an_even_state():
    load, costs = Load(start="normal_displacement=1", path="normal_displacement=2"), []
    for form in (ALL, HALF):
        branch, points, spent = followed(SOFT, load, replace(form, first="relaxation"))
        costs.append(spent[2])
        assert points[-1].residual_norm <= 1e-8
    assert costs[1] < 0.65 * costs[0]


# Where there is none


def test_a_state_that_is_not_even_ends_symmetry():
    sentences = []
    branch = Branch(LINE, Load(start="normal_displacement=2", path="normal_displacement=2"),
                    log=sentences.append)
    point = next(iter(branch))
    window = point.state.window
    controls = (DISPLACEMENT,)
    load = np.array([2.1])
    rounding = State(window, point.state.displacement + 1e-9 * np.arange(window.size) / window.size,
                     point.state.means)
    assert isinstance(branch.corrector.form, EvenForm)
    branch.corrector.solve(rounding, controls, load)
    assert isinstance(branch.corrector.form, EvenForm) and not sentences
    tilted = State(window, point.state.displacement + 0.2 * np.arange(window.size) / window.size,
                   point.state.means)
    found = branch.corrector.solve(tilted, controls, load)
    assert not isinstance(branch.corrector.form, EvenForm)
    assert sentences == ["the state is not even about the apex: going on without symmetry"]
    branch.corrector.solve(point.state, controls, load)
    assert not isinstance(branch.corrector.form, EvenForm) and len(sentences) == 1
    other = Branch(LINE, Load(start="normal_displacement=2.1", path="normal_displacement=2.1"),
                   form=HALF)
    np.testing.assert_allclose(found.forces, next(iter(other)).forces, rtol=1e-6)


def test_a_motion_from_a_state_that_is_not_even_is_that_of_all_nodes(options):
    options(snes_type="python", snes_python_type="contactsnes.solvers.relaxation.Fire")
    sentences = []
    branch = Branch(SOFT, Load(start="normal_displacement=1", path="normal_displacement=1"),
                    form=Form(form="force"), log=sentences.append)
    point = next(iter(branch))
    assert branch.corrector.form.even and not sentences
    window = point.state.window
    tilted = State(window, point.state.displacement + 0.2 * np.arange(window.size) / window.size,
                   point.state.means)
    found = branch.corrector.solve(tilted, (DISPLACEMENT,), np.array([1.0]))
    assert not branch.corrector.form.even
    assert sentences == ["the state is not even about the apex: going on without symmetry"]
    np.testing.assert_allclose(found.forces, point.forces, rtol=1e-6)


def test_a_jump_may_end_symmetry(monkeypatch):
    """What inertial motion on the cell leads to is taken as it is."""
    sentences = []
    branch = Branch(LINE, Load(start="normal_displacement=2", path="normal_displacement=2"),
                    log=sentences.append)
    point = next(iter(branch))
    relaxed = jumps.relaxed

    def tilted(run, form, unknown, tolerance, where, prefix="jump_"):
        found = relaxed(run, form, unknown, tolerance, where, prefix)
        return found + 1e-5 * np.sin(2 * np.pi * np.arange(found.size) / found.size) / form.root

    monkeypatch.setattr(jumps, "relaxed", tilted)
    settled = jumps.by_inertia(branch.corrector, point.state, point.controls, point.load, "here")
    assert len(sentences) == 1 and "not even" in sentences[0]
    np.testing.assert_allclose(settled.forces, point.forces, rtol=1e-5)


@pytest.mark.parametrize("scene, loaded, words", [
    (replace(LINE, poisson=0.3), {1}, "couples"), (replace(LINE, height=2.0), {1}, "couples"),
    (replace(LINE, poisson=0.3), (), None), (SPHERE, {1, 2}, "different directions"),
    (SPHERE, {1}, None), (SPHERE, {2}, None), (LINE, {1}, None),
    (replace(SPHERE, geometry="cylinder"), {1}, None),
    (replace(LINE, geometry="rough", rough_slope=0.1, rough_shortest=5.0), (), "differ by")])
def test_obstacles(scene, loaded, words):
    contact = Contact(scene)
    why = obstacle(contact, contact.scene.components, loaded)
    assert why is None if words is None else words in why
    assert (obstacle(contact, 1) is None) == (scene.geometry != "rough")


@pytest.mark.parametrize("scene, path, form, words",
                         [(replace(LINE, poisson=0.3), "tangential_displacement=1", HALF,
                           "couples"),
                          (SPHERE, "normal_displacement=1; tangential_displacement_x=1, "
                                   "tangential_displacement_y=1", HALF,
                           "different directions"), (replace(LINE, tangential="off"),
                                                     "normal_displacement=1",
                                                     replace(HALF, form="force"), "force form")])
def test_symmetry_that_is_not_there_is_an_error(scene, path, form, words):
    with pytest.raises(InputError, match=f"-contact_symmetry is 'even', but .*{words}"):
        Branch(scene, Load(path=path), form=form)
    branch = Branch(scene, Load(path=path), form=replace(form, symmetry="auto"))
    *_, point = branch
    assert point.leg and not isinstance(branch.corrector.form, EvenForm)


def test_symmetry_without_tangential_unknowns():
    """A compressible body whose tangential displacements are left out is even."""
    scene = replace(LINE, poisson=0.3, tangential="off")
    same_points(scene, Load(path="normal_displacement=2"))


FIRE = ["-contact_form", "force", "-snes_type", "python", "-snes_python_type",
        "contactsnes.solvers.relaxation.Fire"]
INFO = ["-scene_points", "512", "-scene_period", "40", "-scene_normal_maugis", "3", "-load_path",
        "normal_force=1"]


def test_info_says_what_is_skipped(tmp_path):
    said = call("info", *INFO, folder=tmp_path).stdout
    assert "mirror images, so that half the line is solved" in said
    window = next(line for line in said.splitlines()
                  if "nodes at the start" in line).split("has ")[1].split(" ")[0]
    assert f"1 x {int(window) // 2 + 1} displacements + 1 of force control" in said
    said = call("info", *INFO, "-contact_symmetry", "off", folder=tmp_path).stdout
    assert ("no symmetry is used: -contact_symmetry is off" in said
            and f"1 x {window} displacements" in said)
    said = call("info", *INFO[:-1], "normal_force=1; tangential_force=1", "-scene_poisson", "0.3",
                folder=tmp_path).stdout
    assert "mirror images before leg 2" in said and "on the body couples" in said
    plane = ["-scene_dimension", "2", "-scene_points", "64", "-scene_geometry", "sphere",
             "-scene_period", "20"]
    sheared = "normal_force=1; tangential_force_x=1"
    said = call("info", *plane, "-load_path", sheared, folder=tmp_path).stdout
    assert "mirror images, so that a quarter of the plane is solved" in said
    said = call("info", *plane, "-load_path", f"{sheared}; tangential_force_y=1",
                folder=tmp_path).stdout
    assert "mirror images before leg 3, so that a quarter of the plane is solved" in said
    said = call("info", *plane, "-scene_poisson", "0.3", "-load_path", sheared,
                folder=tmp_path).stdout
    assert ("before leg 2, so that a quarter of the plane is solved" in said and "from then on the "
            "mirror across the load leaves half of the plane to be solved, since the body" in said)
    said = call("info", *INFO, "-snes_type", "qn", folder=tmp_path).stdout
    assert "no symmetry is used: the method (-snes_type qn)" in said
    said = call("info", *INFO, "-contact_form", "force", folder=tmp_path).stdout
    assert "no symmetry is used: the force form is solved on the whole cell" in said
    said = call("info", *INFO, *FIRE, folder=tmp_path).stdout
    assert "mirror images, so that half the line is solved" in said
    assert "1 x 257 displacements" in said


def test_run_says_what_is_skipped_and_refuses_what_is_not_even(tmp_path):
    done = call("run", *INFO, folder=tmp_path)
    assert (done.returncode == 0 and "mirror images, so that half the line "
            "is solved" in done.stdout + done.stderr)
    refused(call("run", *INFO, "-contact_symmetry", "even", "-snes_type", "qn", folder=tmp_path),
            "-contact_symmetry is 'even'", "qn")


@pytest.mark.parametrize("shape, extent", [((12, 10), (12, 10)), ((12, 10), (7, 10)),
                                           ((12, 10), (5, 9)), ((16,), (16,)), ((16,), (9,))])
@pytest.mark.parametrize("signs", [1, -1])
def test_a_part_around_the_apex_is_that_of_the_whole(shape, extent, signs):
    """Of fields that are even, odd in both directions, and in one, from their half alone; a state
    that is known by its half is the one of all nodes."""
    grid = Grid(shape, (4.0,) * len(shape))
    window = Window(grid, [n // 2 - e // 2 for n, e in zip(shape, extent)], extent)
    parities = ((1,) * len(shape), (signs,) * len(shape), (1, signs)[-len(shape):])
    half = EvenWindow(window, parities)
    once = half.fold(half.unfold(np.random.default_rng(4).normal(size=(3, half.size))))
    whole = half.unfold(once)
    for part in (tuple(slice(0, n) for n in extent), tuple(slice(n // 2 - 2, n) for n in extent),
                 tuple(slice(1, n // 2 + 2) for n in extent)):
        np.testing.assert_array_equal(half.around(once, part),
                                      window.box(whole)[(slice(None), *part)])
    state = spread(half, once, np.zeros(3))
    assert "displacement" not in vars(state) and state.components == 3
    np.testing.assert_array_equal(state.normal, whole[0])
    assert "displacement" not in vars(state)
    np.testing.assert_array_equal(state.displacement, whole)
    made = replace(state, displacement=2.0 * whole)
    np.testing.assert_array_equal(made.once, 2.0 * once)
    np.testing.assert_array_equal(made.normal, 2.0 * whole[0])
