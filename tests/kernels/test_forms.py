"""Compiled forms and preconditioners against NumPy's, which are written apart from them."""

import ctypes
import itertools
import math

import numpy as np
import pytest

from contactsnes.contact.bordered import ArcLength
from contactsnes.contact.even_form import EvenForm, HalfForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.grid.active import Nodes
from contactsnes.grid.boxes import Spots
from contactsnes.grid.cell import Grid
from contactsnes.grid.counter import Counter
from contactsnes.grid.even import EvenWindow
from contactsnes.grid.parity import one_mirror
from contactsnes.grid.windows import Window
from contactsnes.kernels import library
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.forms import call
from contactsnes.kernels.structures import TOO_MANY
from contactsnes.kernels.zones import CompiledZone
from contactsnes.scene.settings import Scene
from contactsnes.solvers.core_zone import CoreOptions, CoreZone
from contactsnes.solvers.preconditioners import ArcElimination, EvenCoreZone

pytestmark = pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))

LINE = {"points": 256, "period": 20.0, "normal_maugis": 2.0, "tangential_maugis": 2.0,
        "residual_friction": 0.5}
PLANE = {**LINE, "points": (64, 48), "period": (12.0, 9.0), "dimension": 2, "geometry": "sphere"}
SCENES = {"line": LINE, "odd": {**LINE, "points": 254}, "coupled": {**LINE, "poisson": 0.3},
          "plane": PLANE, "uneven": {**PLANE, "points": (62, 46)},
          "coupled plane": {**PLANE, "poisson": 0.2},
          "coupled uneven": {**PLANE, "points": (62, 46), "poisson": 0.2}}
EVEN = [(name, count, part, "even") for name, count in (("line", 1), ("line", 2), ("odd", 2),
                                                        ("plane", 1), ("uneven", 1), ("plane", 3),
                                                        ("coupled", 2), ("coupled plane", 3))
        for part in ("open", "closed", "strip")]
SIDES = [(name, 3, part, f"mirror across {along}")
         for name in ("coupled plane", "coupled uneven") for along in "xy"
         for part in ("open", "closed", "strip")]
HALF = [("line", 2, "open", "half"), ("line", 1, "closed", "half")]
PLAIN = [(name, count, part, "plain") for name, count in (("line", 1), ("coupled", 2),
                                                          ("coupled plane", 3))
         for part in ("open", "closed", "strip")]
SPOTS = [(name, count, "spots", "plain") for name, count in (("coupled", 1), ("coupled", 2),
                                                             ("coupled plane", 3))]
NODES = [(name, count, part, "plain") for name, count in (("plane", 1), ("coupled plane", 3))
         for part in ("nodes of a box", "nodes of the cell")]
CASES = [(*case, control)
         for case, control in itertools.product(EVEN + SIDES + HALF + PLAIN + SPOTS + NODES,
                                                ("displacement", "force"))]


def window_of(grid, part):
    """A window about the apex, the cell, one closed in its last direction only, two boxes, or some
    nodes of a box or of the cell."""
    shape = grid.shape
    if part.startswith("nodes"):
        hull = window_of(grid, "closed" if "cell" in part else "open")
        return Nodes(hull, np.flatnonzero(np.random.default_rng(2).random(hull.size) < 0.6))
    if part == "spots":
        return Spots(grid, np.array([[n // 8 for n in shape], [n // 2 for n in shape]]),
                     [n // 5 for n in shape])
    if part == "closed":
        return grid.whole
    extent = [(n // 3) | 1 for n in shape]
    if part == "strip":
        extent[-1] = shape[-1]
    return Window(grid, [n // 2 - e // 2 for n, e in zip(shape, extent)], extent)


def form_of(compiled, name, count, part, kind, control):
    """A form in overlap at the apex, and an unknown."""
    contact = Contact(Scene(**SCENES[name]), kernels=chosen(compiled))
    window, controls = window_of(contact.grid, part), (control,) * count
    if kind == "half":
        form = HalfForm(contact, EvenWindow(window), controls)
    elif kind.startswith("mirror"):
        loaded = ("across y", "across x").index(kind[7:]) + 1
        form = EvenForm(contact, window, controls, one_mirror(contact, count, (loaded,)))
    else:
        form = (EvenForm if kind == "even" else DisplacementForm)(contact, window, controls)
    form.set_load([1.5, 0.3, -0.2][:count])
    half = getattr(form, "half", form)
    assert (half.kernel is not None) == compiled
    pressed = np.tile(-1.2 * np.exp(-half.initial_gap / 3.0), count) / half.root
    unknown = 0.02 * np.random.default_rng(3).normal(size=form.size)
    unknown[:form.count] += pressed * np.tile(getattr(form, "node_scale", np.ones(half.nodes)),
                                              count)
    return form, unknown


def results(form, zone, unknown):
    """Name -> array of what a form and its preconditioner compute."""
    random = np.random.default_rng(5)
    vector, new = random.normal(size=form.size), lambda: np.empty(form.size)
    found = {"residual": form.residual(unknown, new())}
    form.linearise(unknown)
    found["tangent"] = getattr(form, "half", form).tangent.copy()
    found["product"] = form.apply_jacobian(vector, new())
    found["transposed"] = form.apply_transpose(vector, new())
    found["preconditioner"] = zone(form).apply(vector, new())
    return found


def arc_of(form):
    """The form under arc length."""
    random = np.random.default_rng(7)
    start, direction = random.normal(size=(2, form.components))
    anchor, tangent = random.normal(size=(2, form.size))
    return ArcLength(form, start, direction, 0.01 * anchor, tangent, 0.3, 0.7)


def interpreted_zone(form):
    kinds = {EvenForm: EvenCoreZone, ArcLength: ArcElimination}
    return kinds.get(type(form), CoreZone)(form, CoreOptions())


def compiled_zone(form):
    arc = form.kernel if isinstance(form, ArcLength) else None
    zone = CompiledZone(form.kernel if arc is None else arc.kernel, CoreOptions(),
                        0.0 if arc is None else 1e-5, arc)
    zone.set_up()
    return zone


def agree(expected, found):
    for name, array in expected.items():
        np.testing.assert_allclose(found[name], array, rtol=0, err_msg=name,
                                   atol=(1e-12 if name == "preconditioner" else 1e-13)
                                   * np.abs(array).max())


@pytest.mark.parametrize("name, count, part, kind, control", CASES)
def test_compiled_forms_are_numpys(name, count, part, kind, control):
    both = [form_of(compiled, name, count, part, kind, control) for compiled in (False, True)]
    zones = interpreted_zone, compiled_zone
    expected, found = (results(form, zone, unknown)
                       for (form, unknown), zone in zip(both, zones))
    agree(expected, found)
    (plain, _), (form, _) = both
    assert form.grid.transforms == pytest.approx(plain.grid.transforms, rel=1e-12)
    assert (form.evaluations, form.products) == (plain.evaluations, plain.products)


SINGLE = {"displacement": 2e-6, "force": 1e-5}
"""Relative error of a convolution in single precision: its rounding, 6e-8, times a few tens for
transforms of hundreds of points (and their sums in the law's steep parts). Where a force is held,
the sum of tractions that partly cancel magnifies it: up to 2.3e-6 over seven random vectors."""


def by_both(cases):
    """Cases of compiled forms and of NumPy's, of which those that hold displacements, a part of
    those that hold forces, are studies."""
    return [*((*case, True) for case in cases),
            *(pytest.param(*case, False, marks=pytest.mark.study if case[-1] == "displacement"
                           else ()) for case in cases)]


@pytest.mark.parametrize("name, count, part, kind, control, compiled", by_both(CASES))
def test_products_in_single_precision(name, count, part, kind, control, compiled):
    """They differ from those in double by rounding, and by no less, and are counted apart."""
    form, unknown = form_of(compiled, name, count, part, kind, control)
    random = np.random.default_rng(5)
    vector, new = random.normal(size=form.size), lambda: np.empty(form.size)
    form.linearise(unknown)
    if compiled:
        zone = CompiledZone(form.kernel, CoreOptions(), quick=True)
        zone.set_up()
    else:
        zone = interpreted_zone(form)
    products = {"product": form.apply_jacobian, "transposed": form.apply_transpose,
                "preconditioner": zone.apply}
    exact = {name: product(vector, new()) for name, product in products.items()}
    before = form.grid.transforms, form.grid.transforms_single
    again = {name: product(vector, new()) for name, product in products.items()}
    spent = form.grid.transforms - before[0]
    assert form.grid.transforms_single == before[1]
    if compiled:
        zone.set_up(single=True)
    before = form.grid.transforms, form.grid.transforms_single
    for name, product in products.items():
        np.testing.assert_array_equal(again[name], exact[name])
        error = np.abs(product(vector, new(), single=True) - exact[name]).max()
        # (of one mirror the preconditioner may hold a mean that is nearly free)
        assert 1e-10 < error / np.abs(exact[name]).max() < SINGLE[control] * (
            50 if kind.startswith("mirror") and name == "preconditioner" else 1), name
    assert form.grid.transforms == before[0]
    assert form.grid.transforms_single - before[1] == pytest.approx(spent, rel=1e-12)
    # the memory is that of double precision, which is asked again
    if compiled:
        zone.set_up()
    for name, product in products.items():
        np.testing.assert_allclose(product(vector, new()), exact[name], rtol=0,
                                   atol=1e-12 * np.abs(exact[name]).max())


@pytest.mark.parametrize("kind, name, count", [("plain", "coupled plane", 3), ("even", "plane", 1),
                                               ("plain", "line", 2)])
@pytest.mark.parametrize("scale", [0.0, 0.02, 3.0])
def test_steps_in_the_regularised_gap_are_numpys(kind, name, count, scale):
    """Of no node, some, and nearly all, in more parts than one."""
    form, unknown = form_of(True, name, count, "closed", kind, "displacement")
    step = scale * np.random.default_rng(7).normal(size=form.size)
    own, gap = step.copy(), form.gap(unknown)[0].copy()
    law = form_of(False, name, count, "closed", kind, "displacement")[0].contact.law
    changed = form.kernel.regularised_step(0.2, unknown, own)
    expected, root = step.copy(), np.broadcast_to(form.root, gap.shape)
    normal = expected[:form.nodes]
    far = np.abs(normal) * root > 0.1
    if far.any():
        normal[far] = -law.regularised_step(gap[far], -root[far] * normal[far], 0.2) / root[far]
    assert changed == far.any()
    np.testing.assert_allclose(own, expected, rtol=0, atol=1e-9 * max(np.abs(step).max(), 1.0))


@pytest.mark.parametrize("name, count, part, kind, control",
                         [case for case in CASES if case[2] != "strip" and case[3] != "half"])
def test_compiled_arc_length_is_numpys(name, count, part, kind, control):
    found = []
    for compiled, zone in ((False, interpreted_zone), (True, compiled_zone)):
        form, unknown = form_of(compiled, name, count, part, kind, control)
        arc = arc_of(form)
        made = results(arc_form(arc), zone, np.append(unknown, 0.4))
        found.append({**made, "load": form.load.copy(), "column": arc.load_column})
    agree(*found)


@pytest.mark.parametrize("name, count, part, kind, control, compiled", by_both(
    [case for case in CASES if case[2] != "strip" and case[3] != "half"]))
def test_products_of_arc_length_in_single_precision(name, count, part, kind, control, compiled):
    """The row and the column of the length are in double."""
    form, unknown = form_of(compiled, name, count, part, kind, control)
    arc = arc_of(form)
    vector = np.random.default_rng(5).normal(size=arc.size)
    arc.linearise(np.append(unknown, 0.4))
    products = [arc.apply_jacobian, arc.apply_transpose]
    if not compiled:
        products.append(interpreted_zone(arc).apply)
    for product in products:
        exact, before = product(vector, np.empty(arc.size)), form.grid.transforms
        found = product(vector, np.empty(arc.size), True)
        error = np.abs(found - exact).max() / np.abs(exact).max()
        assert 1e-10 < error < SINGLE[control] and form.grid.transforms == before
    assert form.grid.transforms_single > 0.0


def arc_form(arc):
    """The arc, with what `results` asks of a form."""
    half = getattr(arc.form, "half", arc.form)
    arc.half = half
    return arc


def test_a_residual_leaves_the_tangent_of_the_last_linearisation():
    form, unknown = form_of(True, "coupled", 2, "open", "plain", "force")
    form.linearise(unknown)
    vector = np.random.default_rng(1).normal(size=form.size)
    product = form.apply_jacobian(vector, np.empty(form.size))
    form.residual(0.5 * unknown, np.empty(form.size))
    assert np.array_equal(form.apply_jacobian(vector, np.empty(form.size)), product)
    form.linearise(0.5 * unknown)
    assert not np.allclose(form.apply_jacobian(vector, np.empty(form.size)), product)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("count", [1, 3])
def test_tangents_far_from_the_contact_are_zero(compiled, count):
    """Far from the contact exp(-a) passes the smallest normal float, 1e-38, at which arithmetic
    takes many times as long; no product sees what is below 1e-30."""
    contact = Contact(Scene(**{**PLANE, "normal_maugis": 20.0}), kernels=chosen(compiled))
    form = DisplacementForm(contact, contact.grid.whole, ("displacement",) * count)
    unknown = 0.3 * np.random.default_rng(3).normal(size=form.size) / form.root
    form.linearise(unknown)
    exact = np.empty_like(form.tangent)
    contact.law.evaluate(form.gap(unknown), np.empty((count, form.nodes)), exact)
    least, kept = np.abs(exact) >= 1e-30, form.tangent != 0.0
    assert np.any((exact != 0.0) & ~least) and np.array_equal(kept, least)
    np.testing.assert_allclose(form.tangent[kept], exact[kept], rtol=1e-12)


@pytest.mark.parametrize("shape", [(1,), (2,), (3,), (24,), (25,), (12, 15), (40, 64)])
@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_compiled_cosines_are_scipys(shape, signs):
    """Rows that close on the cell, that do not, and both, of even and odd fields, forwards and
    back."""
    signs = signs[-len(shape):]
    contact = Contact(Scene(**(LINE if len(shape) == 1 else PLANE)), kernels=chosen(True))
    grid = contact.grid
    closed = tuple(n // 2 + 1 for n in grid.shape)
    shapes = [shape, closed] if len(shape) == 1 else [shape, closed, (shape[0], closed[1]),
                                                      (closed[0], shape[1])]
    for points in shapes:
        ours, scipys = (kind(grid, points, 2, (signs, signs)) for kind in (contact.kernels.even,
                                                                           chosen(False).even))
        field = np.random.default_rng(2).normal(size=scipys.real.shape)
        for axis, (sign, ends) in enumerate(zip(signs, ours.closed), start=1):
            if sign < 0:
                np.moveaxis(field, axis, 0)[[0, -1] if ends else 0] = 0.0
        for plan in (ours, scipys):
            plan.real[...] = field
            plan.forward()
        for mine, theirs in zip(ours.spectrum, scipys.spectrum):
            np.testing.assert_allclose(mine, ours.ordered(theirs),
                                       atol=1e-13 * np.abs(theirs).max())
        for one, other in zip(ours.wavevectors(grid.spacings), scipys.wavevectors(grid.spacings)):
            np.testing.assert_allclose(np.sort(one.ravel()), other.ravel(), rtol=1e-14)
        ours.backward()
        np.testing.assert_allclose(ours.real, ours.gain * field, atol=1e-12 * ours.gain)


@pytest.mark.parametrize("shape", [(1,), (2,), (3,), (24,), (25,), (12, 15)])
def test_products_of_even_fields_are_those_of_a_box_whatever_stands_beyond_it(shape):
    contact = Contact(Scene(**(LINE if len(shape) == 1 else PLANE)), kernels=chosen(True))
    ours, scipys = (kind(contact.grid, shape, 1) for kind in (contact.kernels.even,
                                                              chosen(False).even))
    random = np.random.default_rng(6)
    symbol = random.uniform(0.5, 1.0, size=scipys.spectrum[0].shape)
    own = np.ascontiguousarray(ours.ordered(symbol))
    for extent in itertools.product(*(range(1, n + 1) for n in shape)):
        box = tuple(map(slice, extent))
        scipys.real[...] = 0.0
        ours.real[...] = random.normal(size=ours.real.shape)
        scipys.real[0][box] = ours.real[0][box]
        scipys.forward()
        scipys.spectrum[0] *= symbol
        scipys.backward()
        library.shared().filter(ctypes.byref(ours.structure),
                                (ctypes.c_long * 2)(*(1,) * (2 - len(shape)), *extent),
                                ctypes.c_void_p(own.ctypes.data))
        np.testing.assert_allclose(ours.real[0][box], scipys.real[0][box], atol=1e-12 * ours.gain)


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (3, 2), (24, 7), (33, 25), (9, 25), (33, 10)])
@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
@pytest.mark.parametrize("single", [False, True])
def test_products_of_pairs_of_rows_are_scipys(shape, signs, single):
    """Rows that close on the cell (33 and 25 of it), and that do not, of one of two fields each,
    on the first rows, whatever stands beyond these; and they stay within their memory."""
    contact = Contact(Scene(**PLANE), kernels=chosen(True))
    parities = (signs, signs[::-1])
    whole, scipys = (kind(contact.grid, shape, 2, parities) for kind in (contact.kernels.even,
                                                                         chosen(False).even))
    random = np.random.default_rng(6)
    symbols = random.uniform(0.5, 1.0, size=scipys.spectrum.shape)
    pairs = whole.single if single else whole.folded
    fitted = np.array([pairs.fitting(whole.ordered(symbol)) for symbol in symbols])
    rows, columns = np.indices(shape)
    places = rows // 2 * 2 * shape[1] + rows % 2 + 2 * columns
    fields = whole.room.view(np.float32 if single else float).reshape(-1)
    fields = fields[:whole.room.size].reshape(2, -1)
    for used in range(1, shape[0] + 1):
        fields[...] = random.normal(size=fields.shape)
        scipys.real[...] = 0.0
        for field, there, signs_of in zip(fields, scipys.real, parities):
            there[:used] = field[places[:used]]
            for axis, (sign, closed) in enumerate(zip(signs_of, whole.closed)):
                if sign < 0:
                    np.moveaxis(there, axis, 0)[[0, -1] if closed else 0] = 0.0
            field[places] = there
            field[places[used:]] = random.normal(size=places[used:].shape)
        scipys.forward()
        scipys.spectrum *= symbols
        scipys.backward()
        library.shared().filter(ctypes.byref(pairs.structure),
                                (ctypes.c_long * 2)(used, shape[1]),
                                ctypes.c_void_p(fitted.ctypes.data))
        for field, there in zip(fields, scipys.real):
            np.testing.assert_allclose(field[places[:used]], there[:used],
                                       atol=(1e-5 if single else 1e-13) * whole.gain)


@pytest.mark.parametrize("shape", [(2, 2), (24, 8), (6, 50), (64, 48)])
@pytest.mark.parametrize("single", [False, True])
def test_products_of_whole_rows_in_pairs_are_numpys(shape, single):
    """Of two fields each, on the first rows and columns, whatever stands beyond these, where nodes
    have their places."""
    contact = Contact(Scene(**PLANE), kernels=chosen(True))
    plan = contact.kernels.real(contact.grid, shape, 2)
    pairs, random = plan.single if single else plan.folded, np.random.default_rng(6)
    waves = np.fft.rfft2(np.zeros(shape)).shape
    # of symbols that are even and so real in the rows
    symbols = np.array([np.fft.rfft2(np.exp(-np.add.outer(*(np.minimum(np.arange(n), n - np.arange(
        n)) * size for n in shape)))).real for size in (0.3, 0.7)])
    assert symbols.shape[1:] == waves
    fitted = np.array([pairs.fitting(symbol) for symbol in symbols])
    places = pairs.places(np.arange(math.prod(shape)))
    for used in ((1, 1), (shape[0] - 1, shape[1]), (shape[0] // 2, shape[1] // 2), shape):
        box, fields = tuple(map(slice, used)), random.normal(size=(2, *shape))
        memory = pairs.real.reshape(2, -1)
        memory[:, places] = fields.reshape(2, -1)
        for found, field in zip(pairs.real, fields):
            np.testing.assert_allclose(pairs.rows(found).reshape(shape), field, rtol=1e-6)
        library.shared().filter(ctypes.byref(pairs.structure), (ctypes.c_long * 2)(*used),
                                ctypes.c_void_p(fitted.ctypes.data))
        for found, field, symbol in zip(memory, fields, symbols):
            known = np.zeros(shape)
            known[box] = field[box]
            expected = np.fft.irfft2(np.fft.rfft2(known) * symbol, s=shape) * pairs.gain
            np.testing.assert_allclose(found[places].reshape(shape)[box], expected[box],
                                       atol=(1e-5 if single else 1e-13) * pairs.gain)


@pytest.mark.parametrize("floor", [0.0, 0.1])
@pytest.mark.parametrize("rank", [5, 3])
def test_pseudo_inverse_is_that_of_singular_values(floor, rank):
    random = np.random.default_rng(4)
    matrix = random.normal(size=(5, rank)) @ random.normal(size=(rank, 5))
    left, values, right = np.linalg.svd(matrix)
    inverse = [1.0 / max(value, floor) if floor or value > 1e-13 * values[0] else 0.0
               for value in values]
    expected = (right.T * inverse) @ left.T
    found, work = matrix.copy(), np.empty(60)
    library.shared().pseudo_inverse(found.ctypes.data, 5, floor, work.ctypes.data)
    if rank == 5:
        np.testing.assert_allclose(found, expected, atol=1e-11)
    elif not floor:
        np.testing.assert_allclose(found, np.linalg.pinv(matrix, rcond=1e-13), atol=1e-11)


@pytest.mark.parametrize("even, wide, narrow", [(False, (300, 256), (256, 270)),
                                                (False, (2 ** 17,), (90000,)),
                                                (True, (257, 259), (257, 256)),
                                                (True, (2 ** 16 + 1,), (2 ** 16,))])
def test_large_transforms_of_other_shapes_work_on_the_same_memory(even, wide, narrow):
    """One after the other they give what each gives on memory of its own; more fields than there
    is memory for have their own."""
    kernels, random = chosen(), np.random.default_rng(3)
    cell = Grid(tuple(2 * (n - 1) if even else n for n in wide), (1.0,) * len(wide))
    make = kernels.even if even else kernels.real
    first, second, more = (make(cell, shape, count) for shape, count in
                           ((wide, 1), (narrow, 1), (narrow, 3)))
    assert np.shares_memory(first.real, second.real)
    assert not np.shares_memory(first.real, more.real)
    for made, shape in ((first, wide), (second, narrow), (first, wide)):
        alone = (chosen().even if even else chosen().real)(cell, shape, 1)
        assert not np.shares_memory(alone.real, made.real)
        field = random.normal(size=(1, *shape))
        for each in (made, alone):
            each.real[...] = field
            each.forward()
        np.testing.assert_array_equal(made.spectrum, alone.spectrum)
        made.backward()
        np.testing.assert_allclose(made.real, made.gain * field, atol=1e-9 * made.gain)
        if even and len(shape) == 2:
            # pairs of rows need one more where their number is odd
            assert made.room.size == 2 * math.ceil(shape[0] / 2) * shape[1]
            assert np.shares_memory(made.room, made.real)


def test_no_status_of_the_library_is_passed_over():
    counter = Counter(64)
    counter.limit = 1.0

    def stopping(status):
        counter.numbers[0] = 2.0 * (status == TOO_MANY)
        return status

    assert call(stopping, counter, 0) is None
    with pytest.raises(RuntimeError, match="transforms"):
        call(stopping, counter, TOO_MANY)
    with pytest.raises(RuntimeError, match="stopping failed with status 76"):
        call(stopping, counter, 76)
