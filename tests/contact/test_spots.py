"""Windows of several boxes: which are taken, their convolution, and that all results are those of
the whole cell."""

import numpy as np
import pytest
import scipy.fft

from contactsnes.branch.branch import Branch
from contactsnes.contact import scattered, states
from contactsnes.contact.combining import combined
from contactsnes.contact.edges import follow_edge
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import DISPLACEMENT, Contact
from contactsnes.grid import clusters
from contactsnes.grid.boxes import Spots, SpotsConvolution
from contactsnes.grid.cell import Convolution, Grid, transform_cost
from contactsnes.grid.numbers import numbers_of, of_numbers
from contactsnes.grid.operator import Operator
from contactsnes.grid.windows import Window, enclosing
from contactsnes.scene.load import Load
from contactsnes.scene.settings import Form, Scene, Steps
from contactsnes.solvers.core_zone import CoreZone

LINE, PLANE = (512,), (48, 64)
BOXES = {LINE: ([(500,), (100,), (300,)], (40,)), PLANE: ([(44, 5), (10, 58), (24, 30)], (9, 14))}
DEPTHS = {1: (0.0, 0.2, 0.5), 2: (0.0, 0.1, 0.3)}


def boxes_of(shape):
    grid = Grid(shape, [0.1 * n for n in shape])
    return Spots(grid, *BOXES[shape])


def heights(directory, dimension, places, depths, points, period):
    """A file with the highest of unit parabolas at places, lower than the highest by depths."""
    x = (np.arange(points) - points // 2) * period / points
    gap = np.inf
    for place, depth in zip(places, depths):
        away = [((x - centre + period / 2) % period - period / 2)
                for centre in np.atleast_1d(place)]
        gap = np.minimum(gap, depth + 0.5 * sum(np.meshgrid(*[a ** 2 for a in away], indexing="ij",
                                                            sparse=True)))
    path = directory / f"heights{dimension}.npy"
    np.save(path, -gap)
    return str(path)


def line_scene(directory, places=(-45.0, 0.0, 38.0), depths=DEPTHS[1], points=2048, period=150.0,
               **changes):
    path = heights(directory, 1, places, depths, points, period)
    return Scene(**{"points": points, "period": period, "geometry": "file", "geometry_file": path,
                    "normal_maugis": 2.0, "tangential_maugis": 1.0, "poisson": 0.3, "height": 20.0,
                    **changes})


def plane_scene(directory, places=((-19.0, -18.0), (20.0, -14.0), (1.0, 22.0)), depths=DEPTHS[2],
                points=144, period=75.0, **changes):
    path = heights(directory, 2, places, depths, points, period)
    return Scene(**{"dimension": 2, "points": (points, points), "period": period,
                    "geometry": "file", "geometry_file": path, "normal_maugis": 1.5,
                    "tangential_maugis": 1.0, "poisson": 0.3, **changes})


@pytest.fixture
def always(monkeypatch):
    """Boxes wherever they do not touch, however little that saves."""
    for name in ("MULTIPLICATION", "POINTWISE", "CALL"):
        monkeypatch.setattr(clusters, name, 0.0)
    monkeypatch.setattr(clusters, "OF_NODES", clusters.WORTH)


# Nodes and their convolution


@pytest.mark.parametrize("shape", [LINE, PLANE])
def test_take_put_and_indices_agree(shape):
    window = boxes_of(shape)
    field = np.random.default_rng(0).normal(size=(2, *shape))
    values = window.take(field)
    assert (values.shape == (2, window.size)
            and window.size == len(set(window.take(np.arange(field[0].size).reshape(shape)))))
    np.testing.assert_array_equal(values, field[(slice(None), *window.indices)])
    copy = np.zeros_like(field)
    window.put(values, copy)
    np.testing.assert_array_equal(window.take(copy), values)
    assert np.count_nonzero(copy) == values.size
    rim = np.zeros(shape, bool)
    window.put(window.rim(), rim)
    assert np.count_nonzero(rim) == sum(np.count_nonzero(part.rim()) for part in window.parts)


@pytest.mark.parametrize("shape", [LINE, PLANE])
@pytest.mark.parametrize("transposed", [False, True])
def test_convolution_is_that_of_the_cell(shape, transposed):
    """Even, odd and coupling blocks, as a body of Poisson ratio 0.3 has them; to rounding."""
    count = len(shape) + 1
    contact = Contact(Scene(dimension=len(shape), points=shape if len(shape) == 2 else shape[0],
                            period=20.0, poisson=0.3, tangential_maugis=2.0, height=5.0))
    window = Spots(contact.grid, *BOXES[shape])
    operator = contact.operator(count)
    assert (0, 1) in operator.blocks
    values = np.random.default_rng(1).normal(size=(count, window.size))
    cell = np.zeros((count, *shape))
    window.put(values, cell)
    flat = cell.reshape(count, -1)
    Convolution(contact.grid.whole, operator, count).apply(flat, flat, transposed)
    for _ in range(2):
        found = SpotsConvolution(window, operator, count).apply(values, np.empty_like(values),
                                                                transposed)
        np.testing.assert_allclose(found, window.take(cell), atol=1e-14 * np.abs(cell).max())


def test_convolution_of_stripes_that_fill_a_direction():
    grid = Grid((48, 64), (5.0, 7.0))
    waves = np.hypot(*grid.wavevectors())
    window = Spots(grid, [(5, 0), (30, 0)], (9, 64))
    operator = Operator(grid, {(0, 0): np.exp(-waves)})
    values = np.random.default_rng(2).normal(size=(1, window.size))
    cell = np.zeros((1, *grid.shape))
    window.put(values, cell)
    expected = scipy.fft.irfftn(scipy.fft.rfftn(cell[0]) * np.exp(-waves), grid.shape)
    assert window.circle()[1] == 64 and window.circle()[0] < 48
    found = SpotsConvolution(window, operator, 1).apply(values, values)
    np.testing.assert_allclose(found[0], window.take(expected), atol=1e-14)


def test_transforms_are_counted_on_the_circles():
    window = boxes_of(LINE)
    operator = Operator(window.grid, {(0, 0): np.ones(LINE[0] // 2 + 1)})
    product = SpotsConvolution(window, operator, 1)
    before, values = window.grid.counter.transforms, np.ones((1, window.size))
    product.apply(values, values)
    spent = window.grid.counter.transforms - before
    assert spent == pytest.approx(2 * 3 * transform_cost(window.circle()[0], LINE[0]))


def test_a_window_is_made_again_from_start_and_shape():
    for window in (boxes_of(LINE), boxes_of(PLANE), Window(Grid(PLANE, (4.0, 4.0)), (3, 60),
                                                           (7, 9))):
        again = of_numbers(window.grid, numbers_of(window))
        assert again == window and type(again) is type(window)
    assert boxes_of(LINE) != boxes_of(LINE).parts[0]


# Which boxes


def mask_of(shape, boxes):
    grid = Grid(shape, [1.0] * len(shape))
    mask = np.zeros(shape, bool)
    for box in boxes:
        mask[Window(grid, *box).indices] = True
    return grid, mask


@pytest.mark.parametrize("shape, boxes", [
    ((2 ** 14,), [((16000,), (500,)), ((3000,), (400,)), ((9000,), (450,))]),
    ((256, 256), [((250, 20), (20, 20)), ((100, 250), (15, 20)), ((120, 100), (20, 17))])])
def test_spots_far_apart_have_a_box_each(shape, boxes):
    """Across the border of the cell, too; every node is inside, with a margin."""
    grid, mask = mask_of(shape, boxes)
    window = clusters.fitting(grid, mask, 0.05)
    assert len(window.parts) == 3 and window.size < 2.0 * np.count_nonzero(mask)
    outside = mask.copy()
    outside[window.indices] = False
    assert not outside.any() and not window.take(mask)[window.rim()].any()
    assert clusters.cost(window) < clusters.WORTH * clusters.cost(enclosing(grid, mask, 0.05))


def test_neighbours_share_a_box():
    grid, mask = mask_of((2 ** 14,), [((1000,), (300,)), ((1310,), (100,)), ((9000,), (350,))])
    assert len(clusters.fitting(grid, mask, 0.05).parts) == 2


@pytest.mark.parametrize("boxes", [[((1000,), (400,))], [((16300,), (200,))], [],
                                   [((0,), (6000,)), ((8000,), (6000,))],
                                   [((1000,), (400,)), ((1500,), (400,))]],
                         ids=["one", "across the border", "none", "large", "near"])
def test_one_window_where_that_is_cheaper(boxes):
    grid, mask = mask_of((2 ** 14,), boxes)
    assert clusters.fitting(grid, mask, 0.05) == enclosing(grid, mask, 0.05)


def test_boxes_cost_less_than_one_window_of_all_nodes_before_less_than_one_of_few(monkeypatch):
    """Where a window has the nodes alone on which the law acts, a box's nodes are many."""
    grid, mask = mask_of((256, 256), [((25, 34), (17, 18)), ((150, 134), (18, 17))])
    one = enclosing(grid, mask, 0.05)
    boxes = clusters.fitting(grid, mask, 0.05)
    assert len(boxes.parts) == 2 and len(one.parts) == 1
    nodes = np.count_nonzero(mask)
    assert clusters.cost(one, nodes) == pytest.approx(
        clusters.cost(one) - clusters.POINTWISE * (one.size - nodes))
    between = clusters.cost(boxes) / clusters.cost(one, nodes)
    for least, found in ((1.01 * between, boxes), (0.99 * between, one)):
        monkeypatch.setattr(clusters, "OF_NODES", least)
        assert clusters.fitting(grid, mask, 0.05, picked=True) == found


def test_many_spots_are_joined_first():
    """Random nodes: as many clusters; whatever is taken holds them all in disjoint boxes."""
    rng = np.random.default_rng(3)
    for shape, count in (((2 ** 14,), 60), ((256, 256), 80), ((90, 130), 40)):
        mask = np.zeros(shape, bool)
        mask[tuple(rng.integers(0, n // 2, count) + n // 3 for n in shape)] = True
        grid = Grid(shape, [1.0] * len(shape))
        window = clusters.fitting(grid, mask, 0.05)
        assert np.count_nonzero(window.take(mask)) == np.count_nonzero(mask)
        numbers = window.take(np.arange(grid.size).reshape(shape))
        assert len(set(numbers)) == len(numbers)


# The preconditioner


def pressed(directory, **changes):
    """The form on boxes of a pressed line, linearised at its state, and the same on the whole
    cell."""
    scene = line_scene(directory, **changes)
    branch, points = points_of(scene, "normal_displacement=2")
    state, controls = points[-1].state, (DISPLACEMENT,) * len(points[-1].controls)
    forms = []
    for window in (state.window, branch.contact.grid.whole):
        form = DisplacementForm(branch.contact, window, controls)
        form.set_load(points[-1].load)
        form.linearise(form.pack(states.onto(state, window), np.zeros(0)))
        forms.append(form)
    return forms


def test_boxes_know_of_each_other(tmp_path, always):
    """The rest |x - M^-1 J x| is as small as in one window, and far smaller than without what boxes
    are to each other."""
    boxes, whole = pressed(tmp_path, poisson=0.5, height=np.inf)
    zones = [CoreZone(boxes), CoreZone(whole), CoreZone(boxes)]
    assert len(boxes.window.parts) == 3
    zones[2].blocks = [block.block for block in zones[2].blocks]
    rests, rng = [], np.random.default_rng(5)
    for zone in zones:
        form, total = zone.form, 0.0
        for waves in range(4):
            field = np.cos(waves * form.window.take(np.linspace(0.0, 2.0 * np.pi, form.grid.size))
                           + rng.uniform(0, 6))
            vector = np.tile(np.where(form.tangent[0, 0] > 0.1, field, 0.0), form.components)
            rest = zone.apply(form.apply_jacobian(vector, np.empty(form.size)),
                              np.empty(form.size)) - vector
            total += np.linalg.norm(rest) / np.linalg.norm(vector)
        rests.append(total)
    assert rests[0] < 1.2 * rests[1] and rests[0] < 0.5 * rests[2], rests


# States on boxes


def test_states_on_other_boxes_take_the_nearest_known_values():
    window = boxes_of(LINE)
    values = np.random.default_rng(4).normal(size=(2, window.size))
    state = states.State(window, values, np.zeros(2))
    assert states.onto(state, window) is values
    cell = states.onto(state, window.grid.whole)
    np.testing.assert_array_equal(window.take(cell.reshape(2, -1)), values)
    known = window.take(np.arange(512))
    for node in (60, 70, 71, 210, 290, 420, 424, 425, 430, 499):
        away = np.abs((known - node + 256) % 512 - 256)
        assert any(np.array_equal(cell[:, node], values[:, k])
                   for k in np.flatnonzero(away == away.min()))
    other = Spots(window.grid, [(90,), (310,)], (60,))
    np.testing.assert_array_equal(states.onto(state, other), other.take(cell))


@pytest.mark.parametrize("made", [line_scene, plane_scene])
@pytest.mark.parametrize("poisson", [0.3, 0.5])
def test_gap_outside_is_that_of_the_whole_cell(made, poisson, tmp_path):
    scene = made(tmp_path, poisson=poisson, height=np.inf)
    contact, rng = Contact(scene, np.load(scene.geometry_file)), np.random.default_rng(6)
    window = Spots(contact.grid, [[n // part for n in scene.shape] for part in (9, 2)],
                   [20] * len(scene.shape))
    state = states.State(window, rng.normal(size=(scene.components, window.size)),
                         rng.normal(size=scene.components))
    before, expected = contact.grid.transforms, contact.extended(state)[0] + contact.initial_gap
    window.put(np.full(window.size, np.inf), expected)
    middle, found = contact.grid.transforms, contact.gap_outside(state)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    assert middle - before >= 2 * scene.components
    assert contact.grid.transforms - middle == pytest.approx((scene.components if poisson == 0.3
                                                              else 1) + 1)


def test_a_box_whose_spot_is_gone_is_left_out(tmp_path, always):
    scene = line_scene(tmp_path)
    contact = Contact(scene, np.load(scene.geometry_file))
    far = contact.window(contact.initial_gap + 2.0)
    assert len(far.parts) == 3
    lifted = -contact.ranges[0] * np.concatenate([np.full(part.size, -60.0 * (k == 2))
                                                  for k, part in enumerate(far.parts)])
    state = states.State(far, np.zeros((1, far.size)) + 2.0, np.zeros(1))
    assert states.fitted(contact, state) is state
    gone = states.fitted(contact, states.State(far, state.displacement + lifted, np.zeros(1)))
    assert gone.window != far


# Branches: the same points as on the whole cell


def points_of(scene, path, start="normal_displacement=1", window="auto",
              steps=Steps(initial_step=0.5, largest_step=0.5), log=lambda sentence: None):
    branch = Branch(scene, Load(path=path, start=start), steps=steps, form=Form(window=window),
                    log=log)
    return branch, list(branch)


def same(branch, points, whole):
    """Loads, forces and states agree to some thousand times the tolerance of 1e-8, which is that of
    each point's imbalance."""
    assert [point.event for point in points] == [point.event for point in whole]
    for point, other in zip(points, whole):
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(point.displacements, other.displacements, rtol=1e-5, atol=1e-5)
        assert point.residual_norm <= 1e-8
        cell = other.state.displacement
        assert np.abs(branch.contact.extended(point.state).reshape(cell.shape) - cell).max() < 1e-4
        seen, expected = branch.observe(point), branch.observe(other)
        for name in ("contact_area", "maximum_pressure", "minimum_gap", "elastic_energy"):
            assert seen[name] == pytest.approx(expected[name], rel=1e-4, abs=1e-4), name


@pytest.mark.parametrize("path, start", [("normal_displacement=2", "normal_displacement=1"),
                                         ("normal_force=3", "normal_force=2"),
                                         ("normal_displacement=hold, tangential_displacement=1",
                                          "normal_displacement=2"),
                                         ("normal_force=hold, tangential_force=1",
                                          "normal_force=4")])
def test_boxes_change_nothing_on_a_line(path, start, tmp_path, always):
    scene = line_scene(tmp_path)
    branch, points = points_of(scene, path, start)
    assert all(len(point.state.window.parts) == 3 for point in points)
    same(branch, points, points_of(scene, path, start, "off")[1])


@pytest.mark.parametrize("path", [pytest.param("normal_displacement=0.4", marks=pytest.mark.study),
                                  "normal_force=hold, tangential_displacement_x=0.5"])
def test_boxes_change_nothing_in_the_plane(path, tmp_path, always):
    scene = plane_scene(tmp_path)
    start = "normal_force=2" if "force" in path else "normal_displacement=0.2"
    branch, points = points_of(scene, path, start)
    assert all(len(point.state.window.parts) == 3 for point in points)
    same(branch, points, points_of(scene, path, start, "off")[1])


@pytest.mark.parametrize("places, depths, boxes", [((-50.0, -29.0, 30.0), (0.0, 0.5, 38.0), {1, 3}),
                                                   ((-50.0, -29.5, 30.0), (0.0, 0.5, 40.0),
                                                    {1, 2})])
def test_spots_appear_and_merge_along_a_path(places, depths, boxes, tmp_path, always):
    """Two spots near each other, of one box or two, and a third that comes within the law's range
    as the body is pressed."""
    scene = line_scene(tmp_path, places, depths, normal_maugis=1.0, period=200.0)
    path = "normal_displacement=12; normal_displacement=-1"
    start = "normal_displacement=-1"
    log = []
    steps = Steps(initial_step=2.0, largest_step=4.0)
    branch, points = points_of(scene, path, start, steps=steps, log=log.append)
    assert {len(point.state.window.parts) for point in points} == boxes
    assert any(sentence.startswith("spots far apart: ") for sentence in log)
    ends = [[point for point in found if point.displacements[0] in (12.0, -1.0)]
            for found in (points, points_of(scene, path, start, "off", steps=steps)[1])]
    same(branch, *ends)


def test_a_run_goes_on_from_boxes(tmp_path, always):
    scene = line_scene(tmp_path)
    load = Load(path="normal_displacement=2", start="normal_displacement=1")
    steps = Steps(initial_step=0.25, largest_step=0.25)
    branch = Branch(scene, load, steps=steps)
    points = list(branch)
    packed = [branch.packed(point) for point in points[:3]]
    assert packed[-1]["window_start"].shape == (3, 1)
    restored = [branch.restored(one) for one in packed]
    assert (restored[-1].state.window == points[2].state.window
            and len(restored[-1].state.window.parts) == 3)
    again = list(Branch(scene, load, steps=steps, history=restored))
    assert [point.displacements[0] for point in again] == [point.displacements[0]
                                                           for point in points[3:]]
    np.testing.assert_allclose([point.forces for point in again],
                               [point.forces for point in points[3:]], rtol=1e-6)


def test_a_path_costs_less_where_spots_are_small(tmp_path):
    """By the rule as it is, nothing forced."""
    scene = line_scene(tmp_path, (-110.0, 20.0, 120.0), points=8192, period=400.0)
    spent = {}
    for window in ("auto", "off"):
        branch, points = points_of(scene, "normal_displacement=1", "normal_displacement=0", window,
                                   Steps(initial_step=0.2, largest_step=0.2))
        assert len(points[-1].state.window.parts) == (3 if window == "auto" else 1)
        spent[window] = np.median([point.spent["transforms"] for point in points[1:]])
    assert spent["auto"] < 0.35 * spent["off"]


def test_boxes_of_a_plane_stay_while_they_will_do(tmp_path, always, monkeypatch):
    """Steps go on on the boxes of the last point: nothing is made anew, nor transformed for it."""
    made, window = [], scattered.window
    monkeypatch.setattr(scattered, "window",
                        lambda *arguments: made.append(window(*arguments)) or made[-1])
    branch, points = points_of(plane_scene(tmp_path), "normal_displacement=0.6",
                               "normal_displacement=0.2", steps=Steps(initial_step=0.05,
                                                                      largest_step=0.05))
    assert len(points) == 9 and all(len(point.state.window.parts) == 3 for point in points)
    assert len({point.state.window for point in points}) < 4 and len(made) < 6
    same(branch, points[-1:], points_of(plane_scene(tmp_path), "normal_displacement=0.6",
                                        "normal_displacement=0.2", "off")[1][-1:])


def test_one_spot_keeps_its_window(tmp_path):
    """Heights of one parabola are solved on the window of the cylinder that they describe."""
    scene = line_scene(tmp_path, (0.0,), (0.0,), points=1024, period=75.0)
    path, start = "normal_displacement=2", "normal_displacement=1"
    found = points_of(scene, path, start)[1]
    assert all(len(point.state.window.parts) == 1 and not point.state.window.is_whole
               for point in found)


def test_each_spot_is_followed_on_its_own():
    """Three spots whose edges move with different speeds: only interpolation between nodes is left,
    in boxes or one window."""
    points, period = 2048, 160.0
    x = (np.arange(points) - points // 2) * period / points
    centres = (-50.0, -8.0, 45.0)
    gap = np.min([(x - centre) ** 2 / 2 for centre in centres], axis=0)
    contact = Contact(Scene(points=points, period=period, normal_maugis=3.0, geometry="file",
                            geometry_file="-"), -gap)
    start = [(int((centre - 6.0) / period * points) + points // 2,) for centre in centres]
    for window in (Spots(contact.grid, start, (154,)), contact.grid.whole):
        places, given = window.take(x), []
        for t in range(4):
            gaps = np.full(window.size, np.inf)
            for number, centre in enumerate(centres):
                left = centre - 2.0 - 0.1 * number * t
                right = centre + 2.0 + 0.12 * t - 0.01 * t * t
                s = 2.0 * (places - left) / (right - left) - 1.0
                gaps = np.minimum(gaps, contact.scene.contact_threshold + 25.0 * (s ** 2 - 1.0))
            field = (gaps - window.take(contact.initial_gap))[None]
            given.append(states.State(window, field, contact.grid.mean(field)))
        weights = np.array([1.0, -3.0, 3.0])
        found = follow_edge(contact, given[:3], weights)
        near = states.normal_gap(contact, given[3]) < 10.0
        wrong, still = (np.abs(state.displacement - given[3].displacement)[0, near].max()
                        for state in (found, combined(contact, given[:3], weights)))
        assert found.window == window and wrong < 2e-3 and wrong < 0.05 * still


def test_spots_next_to_the_border_of_a_window_are_no_trouble():
    """One that the border of the cell cuts is extrapolated at fixed places, its neighbour is
    followed."""
    points, period = 1024, 80.0
    x = (np.arange(points) - points // 2) * period / points
    away = [(x - centre + period / 2) % period - period / 2 for centre in (-39.0, 0.0)]
    contact = Contact(Scene(points=points, period=period, normal_maugis=3.0, geometry="file",
                            geometry_file="-"), -np.min([distance ** 2 / 2 for distance in away],
                                                        axis=0))
    given = []
    for half in (2.0, 2.1, 2.2):
        gap = contact.scene.contact_threshold + 25.0 * (np.min([distance ** 2 for distance in away],
                                                               axis=0) / half ** 2 - 1.0)
        field = (gap - contact.initial_gap)[None]
        given.append(states.State(contact.grid.whole, field, contact.grid.mean(field)))
    found = states.normal_gap(contact, follow_edge(contact, given[:2], np.array([-1.0, 2.0])))
    wrong = np.abs(found - states.normal_gap(contact, given[2]))[np.abs(x) < 2.3]
    assert wrong.max() < 1e-2


def test_the_full_approximation_scheme_takes_the_cell(tmp_path, always, options):
    scene = line_scene(tmp_path, (-20.0, 0.0, 18.0), points=1024, period=75.0)
    path = "normal_displacement=1.5"
    whole = points_of(scene, path, window="off")[1]
    options(snes_type="fas")
    points = points_of(scene, path)[1]
    assert points[-1].state.window.is_whole
    np.testing.assert_allclose(points[-1].forces, whole[-1].forces, rtol=1e-5, atol=1e-5)
