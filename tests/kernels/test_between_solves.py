"""What compiled code is asked between two solves, against NumPy, SciPy and whole windows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage

from contactsnes import Contact, Scene
from contactsnes.contact import (
    acceptance,
    combining,
    edges,
    energies,
    fronts,
    interface_work,
    state,
    states,
    survey,
    ways,
    work_along,
)
from contactsnes.contact.even_form import EvenForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.continuation.points import Point
from contactsnes.dynamics import changes
from contactsnes.grid import contours
from contactsnes.grid import splines as grid_splines
from contactsnes.grid.alternation import alternation, differences
from contactsnes.grid.even import EvenWindow
from contactsnes.grid.parity import parities
from contactsnes.grid.splines import spline
from contactsnes.grid.windows import Window
from contactsnes.interface.laws.modified import Modified
from contactsnes.kernels import library, points, splines, structures
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.laws import kernel_of
from contactsnes.kernels.sites import Site, States

compiled = pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
EVEN = {"line": (Scene(points=128, period=20.0), (0,), 1),
        "sheared line": (Scene(points=128, period=20.0, poisson=0.3, tangential="on"), (0,), 2),
        "plane": (Scene(dimension=2, points=32, period=12.0, geometry="sphere"), (0,), 1),
        "sheared plane": (Scene(dimension=2, points=32, period=12.0, geometry="sphere",
                                poisson=0.3, tangential="on"), (0,), 3)}
"""Name -> scene, tangential components that are loaded, components."""


@compiled
@pytest.mark.parametrize("shape, axis", [((1, 2), 1), ((1, 3), 1), ((2, 29), 1), ((1, 30), 1),
                                         ((9, 31), 1), ((3, 12, 40), 1), ((3, 40, 12), 2),
                                         ((2, 2, 9), 1), ((1, 500), 1)])
def test_splines(shape, axis):
    """Within the nodes and beyond their ends, where a place counts as theirs."""
    numbers = np.random.default_rng(3)
    values, count = numbers.normal(size=shape), shape[axis]
    places = np.concatenate([numbers.uniform(-1.0, count, size=40), [0.0, count - 1.0, 1.0]])
    found = chosen().spline(values.copy(), places, axis)
    np.testing.assert_allclose(found, spline(values, places, axis), atol=1e-13)
    lines = np.moveaxis(values, axis, -1).reshape(-1, count)
    cut = np.clip(places, 0.0, count - 1.0)
    other = [ndimage.map_coordinates(line, [cut], order=3, mode="mirror") for line in lines]
    np.testing.assert_allclose(np.moveaxis(found, axis, -1).reshape(len(lines), -1), other,
                               atol=1e-12)


@compiled
def test_splines_without_nodes(monkeypatch):
    """A process whose slab has none of the rows asks the library, which needs two, for nothing."""
    monkeypatch.setattr(splines, "shared", None)
    found = chosen().spline(np.empty((3, 0, 12)), np.empty(0), 1)
    assert found.shape == spline(np.empty((3, 0, 12)), np.empty(0), 1).shape == (3, 0, 12)


@compiled
@pytest.mark.parametrize("law", ["modified", "mcgarry", "xu_needleman"])
@pytest.mark.parametrize("components", [1, 2, 3])
def test_works(law, components):
    """What nodes release, in more than one part of the library's, and of no nodes at all."""
    scene = Scene(dimension=2, points=16, law=law, geometry="sphere", work_ratio=0.7)
    numbers = np.random.default_rng(4)
    gap = numbers.uniform(-2.0, 6.0, size=(components, 600))
    change = numbers.normal(size=(components, 600)) * numbers.choice([0.0, 1e-9, 1.0], size=600)
    by_library, by_numpy = Contact(scene), Contact(scene, kernels=chosen(False))
    assert kernel_of(by_library.law) and not kernel_of(by_numpy.law)
    for nodes in (600, 256, 3, 0):
        found, expected = (acceptance._works(contact, gap[:, :nodes], change[:, :nodes])
                           for contact in (by_library, by_numpy))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


SOFT = Scene(dimension=2, points=16, geometry="sphere", work_ratio=0.7, poisson=0.3,
             normal_maugis=2.0, tangential_maugis=3.0, residual_friction=0.4)


def fields(components, nodes, count):
    """Random displacements, and weights of 1, 2 and 4."""
    numbers = np.random.default_rng(components + nodes)
    return (numbers.normal(size=(count, components, nodes)) * 2.0,
            numbers.uniform(-1.0, 4.0, nodes), numbers.choice([1.0, 2.0, 4.0], nodes))


@compiled
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("nodes", [1, 256, 700])
@pytest.mark.parametrize("components", [1, 2, 3])
def test_surveys(components, nodes, weighted):
    """Numbers of a state by the library and by NumPy, on laws with slip and without."""
    ((displacement,), gap, weights), law = fields(components, nodes, 1), Contact(SOFT).law
    displacement[1:, ::5] = 0.0
    limits = {"contact": 2.718, "peak": law.slip_peak, "normal": 2.0, "sharp": 3.5}
    given = gap, weights if weighted else None
    expected = survey.by_numpy(law, displacement, *given, *limits.values())
    numbers, traction = Site(kernel_of(law), *given, **limits).survey(displacement)
    np.testing.assert_allclose(numbers[:-1], expected[0], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(traction, expected[1], rtol=1e-12, atol=1e-12)


def test_a_survey_of_known_tractions():
    """Sums, extremes and softening of a field whose tractions, of law (5), are written down
    here."""
    contact = Contact(Scene(points=16, residual_friction=0.5, normal_maugis=2.0,
                            tangential_maugis=3.0))
    a, b = np.array([-0.5, 0.5, 2.0]), np.array([0.2, 1.2, 0.4])
    beyond = np.sqrt(2.0 / np.e) * (0.5 + 0.5 * np.exp(-(b - 0.5 ** 0.5) ** 2))
    last = np.where(b > 0.5 ** 0.5, beyond, 2.0 * b * np.exp(-b * b))
    normal = a * np.exp(-a) * np.where(a > 0.0, np.exp(-b * b), 1.0)
    friction = last * np.where(a > 0.0, np.exp(-a), 1.0)
    window = Window(contact.grid, (7,), (3,))
    field = np.array([a - contact.gap_on(window), b])
    found = contact.survey(state.State(window, field, np.zeros(2)))
    np.testing.assert_allclose(found.total, [normal.sum(), friction.sum()], rtol=1e-14)
    np.testing.assert_allclose(found.work, [normal @ field[0], friction @ b], rtol=1e-13)
    np.testing.assert_allclose([found.closest, found.slip, found.pressure, found.shear],
                               [-0.5, 1.2, -normal[0], friction.max()], rtol=1e-14)
    assert (found.touching, found.sticking) == (3, 2)
    step, scale = 1e-6, np.multiply.outer([2.0, 3.0], [2.0, 3.0])
    eigenvalues = []
    for gap in np.transpose([a, b]):
        ends = np.transpose([gap + sign * step * way for way in np.eye(2) for sign in (1, -1)])
        values = contact.law.traction(ends)
        slopes = np.stack([values[:, 0] - values[:, 1], values[:, 2] - values[:, 3]], axis=1)
        eigenvalues += [one.real for one in np.linalg.eigvals(slopes / (2.0 * step) * scale)
                        if abs(one.imag) < 1e-6]
    assert found.steepest == pytest.approx(-min(eigenvalues), rel=1e-6)


@compiled
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("nodes", [1, 256, 700])
@pytest.mark.parametrize("components", [1, 2, 3])
def test_ways_of_steps(components, nodes, weighted):
    """How states lie to each other, by the library, which passes over nodes out of reach, and by
    NumPy, also where contact is said to go farther than the law reaches."""
    (foretold, ended, began), gap, weights = fields(components, nodes, 3)
    began[:, ::2], ended[:, ::7] = -ended[:, ::2], 20.0
    gap[65:330] += 30.0
    gap[450:580] += 30.0
    contact, weights = Contact(SOFT), weights if weighted else None
    peak = contact.law.slip_peak
    np.testing.assert_allclose(points.apart(began, ended, gap, weights, 3.0),
                               states._apart(began, ended, gap, weights, 3.0), rtol=1e-12)
    for threshold in (contact.scene.contact_threshold, 60.0):
        site = Site(kernel_of(contact.law), gap, weights, contact=threshold, peak=peak)
        told = site.strays(States([foretold, ended, began]), ways.LIMITS)
        expected = ways._by_numpy(foretold, ended, began, gap, weights, threshold, peak)
        np.testing.assert_allclose(told, expected, rtol=1e-12, atol=1e-12)
        assert nodes < 700 or (np.all(expected[2:6] > 0.0)
                               and (components == 1) == (expected[6] == 0.0))


@compiled
@pytest.mark.parametrize("count", [1, 2, 4, 5])
@pytest.mark.parametrize("components, nodes", [(1, 1), (1, 700), (3, 259)])
def test_combined_states(components, nodes, count):
    """Weighted sums by the library and by NumPy, of changes in single precision, too, without gaps
    below a floor."""
    known, gap, weights = fields(components, nodes, count)
    changes = [0.1 * field.astype(np.float32) for field in known[1:]]
    given = (list(known), np.array([1.5, -0.7, 0.3, 0.2, 0.1])[:count], changes,
             [0.4, -0.2, 0.3, 0.5][:count - 1], gap)
    for floor in (-np.inf, 1.0):
        np.testing.assert_allclose(points.combined(*given, floor),
                                   combining._combined(*given, floor), rtol=1e-14, atol=1e-15)
    assert np.min(points.combined(*given, 1.0)[0] + gap) >= 1.0 - 1e-14
    assert points.closest(known[0][0], gap) == np.min(known[0][0] + gap)


@compiled
@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("components, weighted", [(1, True), (2, False), (3, True)])
def test_works_along_states(components, weighted, count):
    """Of more nodes than one block has, most of them out of the law's range."""
    numbers, law = np.random.default_rng(count), chosen().law(Modified(0.3, 0.2))
    known = numbers.uniform(-1.0, 1.0, (count, components, 700)).cumsum(axis=0)
    gap, weights = numbers.uniform(-2.0, 150.0, 700), numbers.uniform(0.0, 2.0, 700).round()
    weights = weights if weighted else None
    for path in (known, [known[0], known[0] + 1e-9, *known[1:]])[:1 + (count < 4)]:
        site, given = Site(kernel_of(law), gap, weights), States(path)
        moved = site.squares_along(given)
        np.testing.assert_allclose(moved, interface_work._squares(path, weights), rtol=1e-13)
        for first in {0, len(path) - 2}:
            for own in (None, numbers.uniform(0.0, 2.0, 700).round()):
                found = site.works_along(given, own, moved, first, work_along.TWINS,
                                         work_along.rules(), law.range)
                expected = interface_work._by_numpy(law, path, gap,
                                                    weights if own is None else own, moved, first)
                np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)
    still = States([known[0]] * 2)
    assert not site.works_along(still, None, np.zeros(1), 0, work_along.TWINS, work_along.rules(),
                                law.range).any()


@compiled
@pytest.mark.parametrize("components", [1, 2, 3])
def test_releases(components):
    """Works of the sets of nodes that a step is asked for, from works of each node."""
    (foretold, ended, began), gap, each = fields(components, 700, 3)
    contact = Contact(SOFT)
    began[0, ::3] += 20.0
    ended[0, ::3] += 20.0
    gap[65:330] += 30.0  # where nodes are passed over together
    change, aside, near, allowed = ways.by_node(foretold, ended, began, gap)
    gaps = began.copy()
    gaps[0] += gap
    moved = np.max(np.abs(change), axis=0) * near
    sets = [np.any(aside > ways.DOUBTFUL * allowed, axis=0), near, moved > 0.5 * moved.max()]
    works = acceptance._works(contact, gaps, change)
    expected = [[np.sum(work * each * nodes) for nodes in sets] for work in works]
    parts = tuple(energies.weights(contact, components))
    found = Site(kernel_of(contact.law), gap, each, parts=parts).releases(
        States([foretold, ended, began]), ways.LIMITS, float(moved.max()))
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


@compiled
def test_crossings_and_sources():
    """Places of a line, more of them than there is room for at first, at its ends and on nodes; and
    where nodes were before places moved."""
    numbers = np.random.default_rng(5)
    for values in (numbers.normal(size=200), np.array([1.0, -1.0]), np.array([0.0, -1.0, 0.0, 2.0]),
                   np.zeros(4), np.array([1.0])):
        for one, other in zip(points.crossings(values, 0.0), contours.crossings(values, 0.0)):
            np.testing.assert_allclose(one, other, atol=1e-13)
    here, there = [3.0, 10.5, 20.0, 30.0], [4.5, 10.0, 22.0, 33.5]
    for count in (2, 4):
        given = (-5, 45, here[:count], there[:count], 2)
        np.testing.assert_allclose(splines.sources(*given), grid_splines.sources(*given),
                                   atol=1e-12)
    assert splines.sources(3, 3, here, there, 0).size == 0


@compiled
@pytest.mark.parametrize("image, closed", [(0, False), (0, True), (1, False), (-1, False),
                                           (1, True), (-1, True)])
@pytest.mark.parametrize("shape, axis", [((1, 30), 1), ((2, 12, 9), 1), ((2, 9, 12), 2)])
def test_alternation(shape, axis, image, closed):
    """Eighth differences by the library and by SciPy."""
    boxes = np.random.default_rng(6).normal(size=shape)
    assert points.alternation(boxes, axis, image, closed) == pytest.approx(
        alternation(boxes, axis, image, closed), rel=1e-12)
    if shape[axis] > 9 and not image:  # without neighbours' own differences
        inside = np.abs(differences(boxes, axis, closed)).take(range(4, shape[axis] - 4), axis)
        for found in (points.alternation, alternation):
            assert found(boxes, axis, image, closed, 4) == pytest.approx(inside.max(), rel=1e-12)


@compiled
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("signs", [(1,), (1, -1), (-1, -1)])
def test_alternation_of_halves(signs, closed):
    """Of tractions on the whole line that halves are of, each component over its largest size, or
    the least."""
    (displacement,), gap, _ = fields(len(signs), 40, 1)
    odd, law = np.array(signs) < 0, kernel_of(Contact(SOFT).law)
    at = [0, 39] if closed else [0]  # where odd tractions vanish
    displacement[1:] *= 1e-3
    for place in at:
        displacement[odd, place] = np.where(np.arange(len(signs)) == 0, -gap[place], 0.0)[odd]
    tractions = law(displacement + np.outer(np.arange(len(signs)) == 0, gap),
                    np.empty_like(displacement))
    images = np.array(signs)[:, None] * tractions[:, -2 if closed else -1:0:-1]
    for least in (1e-9, 0.1):
        sizes = np.maximum(np.max(np.abs(tractions), axis=1, keepdims=True), least)
        whole = np.concatenate([images, tractions], axis=1) / sizes
        site = Site(law, gap, None, halved=True, closed=closed, sign=signs, least=least)
        assert site.survey(displacement)[0][-1] == pytest.approx(
            np.max(np.abs(differences(whole, 1, closed))), rel=1e-12)


@compiled
@pytest.mark.parametrize("name", EVEN)
def test_imbalances(name):
    """Norm and largest residual of an unknown, of half fields and of whole ones."""
    contact, half, whole = even(name)
    count = len(half.displacement)
    for of, form in ((half, EvenForm(contact, half.window, ("displacement",) * count,
                                     half.half.parities)),
                     (whole, DisplacementForm(contact, whole.window, ("force",) * count))):
        unknown = form.packed(of)
        residual = form.residual(unknown, np.empty(form.size))
        acts = form.gap(unknown)[0] < 2.0
        sizes = np.abs(residual[:form.count].reshape(form.shape)) * form.root
        told = form.kernel.imbalance(form.nodal(of), of.means[form.forced], 2.0)
        assert told == pytest.approx((np.linalg.norm(residual), np.max(sizes[:, acts]), True),
                                     rel=1e-12)
        # what was kept of the law on the way is its tangent at the same unknown
        form.linearise(unknown)
        own = form.half if isinstance(form, EvenForm) else form
        np.testing.assert_allclose(own.tangent, contact.law.tangent(form.gap(unknown).copy()),
                                   rtol=1e-12, atol=1e-12)
        lowest = form.gap(unknown)[0].min() - 1e-9
        told = form.kernel.imbalance(form.nodal(of), of.means[form.forced], lowest)
        assert told[1:] == (0.0, False)


def even(name, extent=None):
    """(contact, state taken for even, the same state at all nodes) of random fields."""
    scene, loaded, count = EVEN[name]
    contact = Contact(scene)
    signs = parities(contact.operator(count), count, loaded[1:])
    extent = contact.grid.shape if extent is None else extent
    full = Window(contact.grid, [n // 2 - m // 2 for n, m in zip(contact.grid.shape, extent)],
                  extent)
    half = EvenWindow(full, signs)
    fields = np.random.default_rng(len(extent)).normal(size=(count, half.size))
    made = state.spread(half, half.fold(half.unfold(0.5 * fields)), np.zeros(count))
    return contact, made, replace(made, half=None)


def about(contact, of):
    """A point of a state."""
    count = len(of.displacement)
    return Point(of, ("displacement",) * count, *np.zeros((3, count)), True, False, 0.0)


@pytest.mark.parametrize("name, extent", [*((name, None) for name in EVEN), ("line", (41,)),
                                          ("sheared line", (41,)), ("plane", (21, 25)),
                                          ("sheared plane", (21, 25)), ("line", (7,)),
                                          ("plane", (21, 32))])
def test_halves_tell_what_all_nodes_do(name, extent):
    """Numbers that steps are judged by, of even and odd fields."""
    contact, half, whole = even(name, extent)
    once, all_ = about(contact, half), about(contact, whole)
    assert contact.survey(half).alternating > 0.01  # of random fields
    for one, other in zip(contact.survey(half), contact.survey(whole)):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(energies.stored(contact, once), energies.stored(contact, all_),
                               rtol=1e-12, atol=1e-12)
    assert states.covers(contact, half) == states.covers(contact, whole)
    other, moved = (state.spread(half.half, factor * half.once, half.means)
                    for factor in (1.3, 0.9))
    plain = [replace(one, half=None) for one in (other, half, moved)]
    for told in (acceptance.strayed, acceptance.doubtful):
        np.testing.assert_allclose(told(contact, other, half, moved), told(contact, *plain),
                                   rtol=1e-12)
    told, expected = (ways.ways(contact, *three) for three in ((other, half, moved), plain))
    np.testing.assert_allclose(told[:4], expected[:4], rtol=1e-12)
    assert told.counts == expected.counts
    np.testing.assert_allclose(told[:2], [states.missed(contact, one, moved)
                                          for one in (other, half)], rtol=1e-12)
    for largest in (False, True):
        np.testing.assert_allclose(states.missed(contact, other, half, largest),
                                   states.missed(contact, *plain[:2], largest), rtol=1e-12)
    ahead = combining.combined(contact, [other, half, moved], [1.0, -3.0, 3.0])
    assert ahead.half == half.half
    np.testing.assert_allclose(ahead.displacement,
                               combining.combined(contact, plain, [1.0, -3.0, 3.0]).displacement,
                               atol=1e-12)


@compiled
@pytest.mark.parametrize("twin", [None, 0, 1, 2])
@pytest.mark.parametrize("count, first", [(2, 0), (3, 0), (4, 0), (4, 2)])
def test_works_along_a_path(count, first, twin):
    """By the library as by NumPy, where points are next to each other, too, polynomials swing, or
    a displacement is not defined; of forces that are cubic in the distance, exactly."""
    numbers = np.random.default_rng(count)
    give, parts, chords = np.array([1.5, 1.0]), np.array([1.0, 0.3]), set()
    for _ in range(20):
        steps = numbers.normal(size=(2, count, 2)) * 10.0 ** numbers.uniform(-1, 1, (count, 1))
        along = np.cumsum(steps, axis=1)
        if twin is not None and twin < count - 1:
            along[:, twin] = along[:, twin + 1] + 1e-9
        given = *along, give, parts, first
        found, expected = (work_along.path_work(*given, which) for which in (True, False))
        assert found == pytest.approx(expected, rel=1e-10)
        polynomials = work_along.line_work(*given, work_along.gauss(count))
        chords.add(expected == pytest.approx(polynomials, rel=1e-9))
    assert chords == {True, False} or (count, first, twin) != (4, 2, None)
    along[0, 0] = np.nan
    assert all(np.isnan(work_along.path_work(*along, give, parts, 0, which))
               for which in (True, False))
    straight = np.linspace(0.0, 1.0, count)[:, None] * [1.0, 0.0]
    given = straight, np.zeros((count, 2)) + straight ** (count - 1), 0.0 * give, parts, first
    exact = (1.0 - straight[first, 0] ** count) / count
    assert work_along.path_work(*given, True) == pytest.approx(exact, rel=1e-12)


@compiled
@pytest.mark.parametrize("extent, other", [(81, 91), (81, 71), (101, 111), (128, 128)])
def test_halves_of_lines_whose_places_were_moved(extent, other, monkeypatch):
    """By the library as by NumPy and SciPy on the whole window: from the middle outwards, with odd
    slip, and up to where the cell closes; beyond a window by its nearest nodes, as far as a wider
    one reaches that the cell has room for."""
    scene = EVEN["sheared line"][0]
    contact = Contact(scene)
    interpreted = Contact(scene, kernels=chosen(False))
    window = Window(contact.grid, (64 - extent // 2,), (extent,))
    half, numbers = EvenWindow(window, ((1,), (-1,))), np.random.default_rng(11)
    once = np.cumsum(numbers.normal(size=(2, half.size)), axis=1)
    once[1, 0] = 0.0
    once[1, -1] *= extent < 128
    known = state.Mirrored.of(half, once, np.zeros(2))
    there = EvenWindow(Window(contact.grid, (64 - other // 2,), (other,)), half.parities)
    before = state.Mirrored.of(there, np.resize(once[:, ::-1], (2, there.size)), np.zeros(2))
    before.once[1, 0] = 0.0
    given, weights = [before, known], [-0.7, 1.7]
    places = [[extent / 2 - 20.3, extent / 2 + 20.3], [extent / 2 - 18.0, extent / 2 + 18.0]]
    target = [extent / 2 - 19.0, extent / 2 + 19.0]
    at_nodes = [half.fold(state.onto(before, window)), once]
    for last, reach in ((extent // 2 - 14, 1.5), (half.size, 100.0)):
        # the law acts up to a node
        once[0] = np.where(np.arange(half.size) < last, 1.0, 2.0) - contact.gap_on(half)
        once[0] += 0.1 * np.sin(np.arange(half.size))
        sites = [contact.site(one) for one in (there, half, half.wider)]
        found = splines.followed(given, at_nodes, sites, reach, weights,
                                 [[line] for line in places], [target])
        monkeypatch.setattr(interpreted.law, "range", reach)
        expected = edges._followed(interpreted, given, half, at_nodes, weights,
                                   [[line] for line in places], [target])
        np.testing.assert_allclose(found, expected, atol=1e-11)


@compiled
@pytest.mark.parametrize("extent, far", [((113, 97), 30), ((113, 128), 30), ((128, 128), 65)])
def test_quarters_of_planes_whose_places_were_moved(extent, far, monkeypatch):
    """By the library as by NumPy and SciPy on the whole window: from the middle outwards, with odd
    slip, up to where the cell closes; more than a window has is asked of neither."""
    scene = replace(EVEN["sheared plane"][0], points=128)
    contact, interpreted = Contact(scene), Contact(scene, kernels=chosen(False))
    signs, numbers = ((1, 1), (1, -1), (-1, 1)), np.random.default_rng(12)

    def quarter(extent):
        window = contact.grid.box([(64 - n // 2) % 128 if n < 128 else 0 for n in extent], extent)
        return EvenWindow(window, signs)

    def random(half):
        field = np.cumsum(np.cumsum(numbers.normal(size=(3, *half.shape)), axis=1), axis=2)
        for values, odd in zip(field, signs):
            for axis, sign in enumerate(odd):
                along = np.moveaxis(values, axis, 0)
                along[[0, -1][:1 + (half.closed[axis])]] *= sign > 0
        return state.Mirrored.of(half, field.reshape(3, -1), np.zeros(3))

    half = quarter(extent)
    wide = quarter([min(n + 10, 128) for n in extent])
    given, weights = [random(wide), random(half), random(half)], [0.4, -1.1, 1.7]
    middle = np.array(extent)[:, None] // 2
    across, along = np.meshgrid(*(np.arange(n) for n in half.shape), indexing="ij")
    near = (across < far) & (along < far - 3)
    once = given[-1].once[0]  # the law acts up to some nodes of each direction
    once[:] = np.where(near, 0.9 + 0.1 * np.sin(across + 2 * along), 2.0).ravel()
    once -= contact.gap_on(half)
    known = [half.fold(state.onto(one, half.full)) for one in given]
    for reach in (1.5, 100.0):
        places = [middle + apart * np.array([[-1.0, 1.0], [-0.8, 0.8]])
                  for apart in (20.3, 19.0, 18.1)]
        target = middle + 17.0 * np.array([[-1.0, 1.0], [-0.8, 0.8]])
        found = splines.followed(given, known, [contact.site(one.half) for one in given], reach,
                                 weights, places, target)
        if reach > 2.0 and min(extent) < 128:
            assert found is None
            continue
        monkeypatch.setattr(interpreted.law, "range", reach)
        whole = [states.State(one.window, one.displacement, one.means) for one in given]
        expected = edges._followed(interpreted, whole, half.full,
                                   [state.onto(one, half.full) for one in whole], weights,
                                   places, target)
        size = np.abs(expected).max()
        # (a spline begins so many nodes aside of what is asked for; where a cell closes, the half
        # has what is known there)
        inner = (across < extent[0] - extent[0] // 2) & (along < extent[1] - extent[1] // 2)
        np.testing.assert_allclose(found[:, inner.ravel()],
                                   half.fold(expected)[:, inner.ravel()], atol=1e-8 * size)
        quarters = edges._followed(interpreted, given, half, known, weights, places, target)
        np.testing.assert_allclose(found, quarters, atol=1e-11 * size)


@pytest.mark.parametrize("extent", [81, 128])
def test_places_of_halves_of_lines(extent):
    """Edges, fronts of slip and ends of pressure of an even state are those of all of its nodes."""
    contact = Contact(EVEN["sheared line"][0])
    window = Window(contact.grid, (64 - extent // 2,), (extent,))
    half = EvenWindow(window, ((1,), (-1,)))
    reach = np.arange(half.size) / half.size
    for rim, slip in ((0.5, 0.3), (0.7, 0.01), (1e-3, 0.0), (2.0, 0.5)):
        once = np.array([4.0 * (reach / rim) ** 2 + contact.scene.contact_threshold - 4.0,
                         contact.law.slip_peak * (reach / max(slip, 1e-9)) ** 3])
        once[0] -= contact.gap_on(half)
        once[1, -1] *= extent < 128
        even = state.Mirrored.of(half, once, np.zeros(2))
        whole = states.State(window, even.displacement, np.zeros(2))
        ends = fronts.edges(contact, whole)
        for found, expected in zip(fronts._kept_places(contact, even),
                                   fronts._kept_places(contact, whole)):
            assert (found is None) == (expected is None)
            if found is not None:
                np.testing.assert_allclose(found, expected, rtol=1e-13)
        assert (ends is None) == (rim > 1.0)


@pytest.mark.parametrize("extent", [(32, 32), (25, 21), (25, 32)])
def test_places_and_windows_of_halves_of_planes(extent):
    """Edges of a spot, and the window that the cell asks for, are those of all nodes: of round
    spots, long ones, rings, spots that reach the border, and nothing."""
    contact = Contact(EVEN["plane"][0])
    full = Window(contact.grid, [16 - n // 2 for n in extent], extent)
    half, found = EvenWindow(full), []
    across, along = np.meshgrid(*(np.arange(n) for n in half.shape), indexing="ij")
    for wide, long, hole in ((6.3, 6.3, 0.0), (4.2, 9.9, 0.0), (8.0, 8.0, 3.0), (40.0, 4.0, 0.0),
                             (1e-3, 1e-3, 9.0)):
        size = np.hypot(across / wide, along / long)
        gap = contact.scene.contact_threshold + 80.0 * (size - 1.0)
        gap *= np.sign(size - hole / wide)
        once = gap.reshape(1, -1) - contact.gap_on(half)
        even = state.Mirrored.of(half, once, np.zeros(1))
        whole = states.State(full, even.displacement, np.zeros(1))
        ends = [fronts.edges(contact, one) for one in (even, whole)]
        assert (ends[0] is None) == (ends[1] is None)
        found.append(ends[0] is not None)
        if found[-1]:
            np.testing.assert_allclose(*ends, rtol=1e-13)
        if full.is_whole:
            windows = [contact.window(*state.once_or_all(contact, one)) for one in (even, whole)]
            assert windows[0] == windows[1]
            assert states.fitted(contact, even).window == states.fitted(contact, whole).window
    assert found == [True, True, False, False, False]


def test_memory_of_arrays():
    """Addresses of what may be changed and what may not, of nothing, and of none."""
    array = np.arange(12.0).reshape(3, 4)
    for given in (array, array[1:], np.zeros(0), np.array(1.0), array.astype(np.complex64)):
        assert structures.address(given) == given.ctypes.data
        given.flags.writeable = False
        assert structures.address(given) == given.ctypes.data
    assert structures.address(None) is None
    for given in (array[:, 1:], np.zeros(3, dtype=bool)):
        with pytest.raises(ValueError, match="contiguous"):
            structures.address(given)


@compiled
@pytest.mark.parametrize("components", [1, 3])
def test_extremes_of_a_change(components):
    """Largest size and squares, as NumPy finds them, with and without weights and a scale."""
    numbers, nodes = np.random.default_rng(13), 700
    change, scale = numbers.normal(size=components * nodes + 2), numbers.uniform(1.0, 2.0,
                                                                               (components, nodes))
    counts = (numbers.uniform(size=nodes) < 0.5).astype(float)
    for each in (None, numbers.uniform(size=nodes)):
        for own in (None, scale):
            given = (components, nodes), change, 0.3, counts, own, each
            np.testing.assert_allclose(points.extremes(*given), changes.extremes(*given),
                                       rtol=1e-13)


@compiled
@pytest.mark.parametrize("components", [1, 2])
@pytest.mark.parametrize("extent", [5, 40, 41, 128])
def test_places_of_waves_on_halves_of_lines(extent, components):
    """By the library as by NumPy, where levels are crossed in one place, in many, or in none."""
    contact, numbers = Contact(EVEN["sheared line"][0]), np.random.default_rng(extent)
    window = Window(contact.grid, (64 - extent // 2,), (extent,))
    half = EvenWindow(window, ((1,), (-1,))[:components])
    known = [0, 0, 0]
    for waves in np.repeat([0.4, 0.7, 1.2, 3.0, 20.0], 60):
        phase, shift, size = numbers.uniform(size=(3, components, 1)) * [[[1.5]], [[4.0]], [[8.0]]]
        once = shift - size * np.cos(phase + np.pi * waves * np.arange(half.size) / half.size)
        once[0] -= contact.gap_on(half)
        even = state.Mirrored.of(half, once, np.zeros(components))
        expected = fronts._one_by_one(contact, even)
        for place, (one, other) in enumerate(zip(fronts._by_halves(contact, even), expected)):
            assert (one is None) == (other is None)
            if one is not None:
                np.testing.assert_allclose(one, other, rtol=1e-14)
                known[place] += 1
    if extent > 5 and components > 1:
        assert all(10 < count < 200 for count in known[:2]) and known[2] > 0
