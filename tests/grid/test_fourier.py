"""Grid, windows and convolutions against numpy's transforms, direct sums and sets of nodes."""

import itertools
import math

import numpy as np
import pyfftw
import pytest
import scipy.fft

from contactsnes.grid.boxes import Spots
from contactsnes.grid.cell import Convolution, Grid, Transform, transform_cost
from contactsnes.grid.contours import at_level, crossings
from contactsnes.grid.even import halved
from contactsnes.grid.operator import Operator
from contactsnes.grid.transfer import smooth
from contactsnes.grid.windows import Window, enclosing

LINE, PLANE = Grid((48,), (12.0,)), Grid((20, 36), (5.0, 12.0))
BOXES = [
    Window(LINE, (10,), (7,)),
    Window(LINE, (44,), (8,)),
    Window(LINE, (0,), (1,)),
    Window(LINE, (20,), (40,)),
    Window(LINE, (20,), (48,)),
    Window(PLANE, (3, 30), (5, 10)),
    Window(PLANE, (18, 0), (4, 36)),
    Window(PLANE, (0, 5), (20, 9)),
    Window(PLANE, (15, 33), (8, 8)),
    Window(PLANE, (4, 4), (14, 3)),
    PLANE.whole,
]


def name(window):
    """Start and shape, for the names of tests."""
    return f"{window.start}-{window.shape}"


def random(*shape, seed=1):
    return np.random.default_rng(seed).normal(size=shape)


def axes_of(grid):
    return tuple(range(-len(grid.shape), 0))


def blocks_of(grid, components, coupled=True):
    """A symbol for each pair of components: real even ones, and imaginary odd ones without
    Nyquist's, like a body's."""
    waves = grid.wavevectors()
    wavenumber = np.sqrt(sum(q**2 for q in waves))
    blocks = {(i, i): (1.0 + i) / (0.3 + wavenumber) for i in range(components)}
    for i in range(1, components if coupled else 0):
        axis = (i - 1) % len(waves)
        q = waves[axis].copy()
        q[np.abs(np.abs(q) - np.pi / grid.spacings[axis]) < 1e-9] = 0.0
        blocks[0, i], blocks[i, 0] = -0.4j * q / (1 + wavenumber**2), 0.9j * q / (1 + wavenumber**2)
    return blocks


def on_the_cell(grid, blocks, fields):
    """Product by numpy's transforms of fields (components, *grid)."""
    spectra = np.fft.rfftn(fields, axes=axes_of(grid))
    product = np.zeros_like(spectra)
    for (i, j), block in blocks.items():
        product[i] += block * spectra[j]
    return np.fft.irfftn(product, s=grid.shape, axes=axes_of(grid))


# Grid

def test_nodes_and_waves():
    for grid in (LINE, PLANE):
        for axis, (points, period) in enumerate(zip(grid.shape, grid.periods)):
            x = np.squeeze(grid.coordinates()[axis])
            np.testing.assert_allclose(x, [(i - points / 2) * period / points
                                           for i in range(points)], atol=1e-14)
            assert x[points // 2] == 0.0
            assert grid.coordinates()[axis].ndim == len(grid.shape)
            rest = tuple(-1 if i == axis else 1 for i in range(len(grid.shape)))
            wave = np.broadcast_to(np.cos(2 * np.pi * 3 / period * x).reshape(rest), grid.shape)
            peaks = np.abs(np.fft.rfftn(wave)) > 1e-9 * grid.size
            carried = np.broadcast_to(grid.wavevectors()[axis], peaks.shape)[peaks]
            np.testing.assert_allclose(np.abs(carried), 2 * np.pi * 3 / period, rtol=1e-14)
    assert PLANE.area == 60.0 and PLANE.size == 720
    assert PLANE.node_area == pytest.approx(60 / 720) and PLANE.spacings == (0.25,
                                                                             pytest.approx(1 / 3))


@pytest.mark.parametrize("shape", [(9,), (10,), (15, 25), (16, 27)])
def test_waves_of_another_circle_keep_the_spacing(shape):
    grid = LINE if len(shape) == 1 else PLANE
    waves = grid.wavevectors(shape)
    spectrum = np.fft.rfftn(np.zeros(shape)).shape
    assert np.broadcast_shapes(*(q.shape for q in waves)) == spectrum
    for q, points, h in zip(waves, shape, grid.spacings):
        assert np.unique(np.abs(q))[1] == pytest.approx(2 * np.pi / (points * h), rel=1e-14)


def test_reductions():
    values, mask = random(2, 30), random(30) > 0
    np.testing.assert_allclose(LINE.sum(values), [sum(v) for v in values], rtol=1e-13)
    np.testing.assert_allclose(LINE.mean(values), [sum(v) / 48 for v in values], rtol=1e-13)
    assert (LINE.maximum(values) == max(values.ravel())
            and LINE.minimum(values) == min(values.ravel()))
    assert LINE.maximum(values[0], where=mask) == max(values[0][mask])
    assert LINE.minimum(values[0], where=mask) == min(values[0][mask])
    assert LINE.maximum(values, where=False, initial=-1.0) == -1.0
    assert LINE.inner(values, values + 1) == pytest.approx(sum((v * (v + 1)).sum() for v in values),
                                                           rel=1e-13)
    assert LINE.count(mask) == sum(mask)


@pytest.mark.parametrize("shape", [(48,), (27,), (20, 36), (20, 15), (9, 15), (9, 16)])
def test_parseval(shape):
    grid = Grid(shape, (1.0,) * len(shape))
    fields = random(2, *shape) + 0.5
    spectra = np.fft.rfftn(fields, axes=axes_of(grid))
    assert grid.parseval(spectra) == pytest.approx(np.sum(fields**2), rel=1e-13)
    assert grid.parseval(spectra[0]) == pytest.approx(np.sum(fields[0] ** 2), rel=1e-13)


# Transforms

@pytest.mark.parametrize("shape", [(48,), (27,), (20, 36), (9, 15), (16, 25)])
def test_transform_has_the_sign_of_numpy(shape):
    grid = LINE if len(shape) == 1 else PLANE
    plan = Transform(grid, shape, 3)
    assert not plan.real.any()
    fields = random(3, *shape)
    plan.real[...] = fields
    plan.forward()
    np.testing.assert_allclose(plan.spectrum, np.fft.rfftn(fields, axes=axes_of(grid)), atol=1e-12)
    np.testing.assert_array_equal(plan.real, fields)
    plan.backward()
    np.testing.assert_allclose(plan.real, fields * math.prod(shape), atol=1e-10)


class Counter:
    """Cost of every transform of any library, from the sizes of its arrays, in transforms of
    ``size`` points."""

    def __init__(self, size):
        self.size = size
        self.cost = 0.0
        self.calls = 0

    def add(self, real, axes):
        """Count the transforms along the axes of a real array."""
        points = math.prod(real.shape[axis] for axis in axes)
        self.calls += 1
        self.cost += real.size * math.log(points) / (self.size * math.log(self.size))


@pytest.fixture
def counter(monkeypatch):
    count = Counter(PLANE.size)

    class CountedFFTW(pyfftw.FFTW):
        def _count(self):
            count.add(self.output_array if self.direction == "FFTW_BACKWARD" else self.input_array,
                      self.axes)

        def execute(self):
            self._count()
            super().execute()

        def __call__(self, *args, **kwargs):
            self._count()
            return super().__call__(*args, **kwargs)

    def forbidden(*args, **kwargs):
        raise AssertionError("a transform that the grid does not count")

    monkeypatch.setattr(pyfftw, "FFTW", CountedFFTW)
    names = [prefix + kind + "fft" + end for prefix, kind, end in itertools.product(("", "i"),
                                                                                    ("", "r", "h"),
                                                                                    ("", "2", "n"))]
    for library in (np.fft, scipy.fft):
        for transform in names + ["dct", "idct", "dst", "idst", "dctn", "idctn", "dstn", "idstn"]:
            if hasattr(library, transform):
                monkeypatch.setattr(library, transform, forbidden)
    return count


@pytest.mark.parametrize("start, shape", [((0, 0), (20, 36)), ((3, 30), (5, 10)), ((4, 4), (9, 3)),
                                          ((4, 0), (8, 36))])
@pytest.mark.parametrize("components", [1, 3])
def test_every_transform_is_counted(counter, start, shape, components):
    grid = Grid(PLANE.shape, PLANE.periods)
    window = Window(grid, start, shape)
    convolution = Convolution(window, Operator(grid, blocks_of(grid, components)), components)
    assert grid.transforms == pytest.approx(counter.cost, rel=1e-13)
    before, calls = grid.transforms, counter.calls
    values = random(components, window.size)
    for _ in range(3):
        convolution.apply(values, values)
    assert counter.calls == calls + 6
    assert grid.transforms == pytest.approx(counter.cost, rel=1e-13)
    points = math.prod(window.circle())
    once = 2 * components * points * math.log(points) / (grid.size * math.log(grid.size))
    assert grid.transforms - before == pytest.approx(3 * once, rel=1e-12)
    smooth(window, values[0], 1.0)
    window.put(values, np.zeros((components, *grid.shape)))
    assert counter.calls == calls + 6


def test_cost_of_the_cell_is_one():
    assert transform_cost(PLANE.size, PLANE.size) == 1.0
    assert transform_cost(1024, 2048) == pytest.approx(0.5 * 10 / 11, rel=1e-14)


# Windows

@pytest.mark.parametrize("window", BOXES, ids=name)
def test_take_and_put(window):
    grid = window.grid
    field = random(2, *grid.shape)
    taken = window.take(field)
    assert taken.shape == (2, window.size) and window.box(taken).shape == (2, *window.shape)
    for offset in itertools.product(*(range(n) for n in window.shape)):
        node = tuple((s + k) % n for s, k, n in zip(window.start, offset, grid.shape))
        np.testing.assert_array_equal(window.box(taken)[(slice(None), *offset)],
                                      field[(slice(None), *node)])
    np.testing.assert_array_equal(window.take(field[0]), taken[0])
    other = np.full_like(field, np.nan)
    window.put(taken, other)
    assert np.count_nonzero(np.isfinite(other)) == 2 * window.size
    written = np.isfinite(other)
    np.testing.assert_array_equal(other[written], field[written])
    np.testing.assert_array_equal(window.take(other), taken)


@pytest.mark.parametrize("window", BOXES, ids=name)
def test_coordinates_of_a_window_go_on_over_the_border(window):
    for axis, (x, cell, period, h) in enumerate(zip(window.coordinates(), window.grid.coordinates(),
                                                    window.grid.periods, window.grid.spacings)):
        picked = window.box(window.take(np.broadcast_to(cell, window.grid.shape)))
        picked, x = np.moveaxis(picked, axis, 0).reshape(len(x.ravel()), -1)[:, 0], x.ravel()
        np.testing.assert_allclose(np.diff(x), h, rtol=1e-9)
        np.testing.assert_allclose((x - picked) / period, np.round((x - picked) / period),
                                   atol=1e-13)
        assert x[0] == picked[0]


def test_equal_windows():
    assert Window(LINE, (-4,), (8,)) == Window(LINE, (44,), (8,)) != Window(LINE, (44,), (9,))
    assert Window(LINE, (20,), (48,)) == LINE.whole and LINE.whole.is_whole
    assert not Window(PLANE, (0, 0), (20, 35)).is_whole


def test_rim():
    edge = Window(PLANE, (3, 30), (5, 10)).rim().reshape(5, 10)
    assert edge.sum() == 26 and not edge[1:-1, 1:-1].any()
    filled = Window(PLANE, (18, 0), (4, 36)).rim().reshape(4, 36)
    assert filled[[0, -1]].all() and not filled[1:-1].any()
    assert not PLANE.whole.rim().any()


@pytest.mark.parametrize("window", BOXES, ids=name)
def test_circle_is_long_enough(window):
    for n, m, total in zip(window.shape, window.circle(), window.grid.shape):
        assert m == total or 2 * n - 1 <= m < total


def circular(total, nodes):
    """Mask over a circle of nodes."""
    mask = np.zeros(total, dtype=bool)
    mask[list(nodes)] = True
    return mask


@pytest.mark.parametrize("nodes, margin, start, extent", [
    ([20, 24], 0.0, 18, 9),
    ([24], 0.0, 22, 5),
    ([24], 0.9, 22, 5),
    ([24], 1.0, 21, 7),
    ([20, 29], 0.1, 17, 16),
    ([46, 1, 3], 0.0, 44, 10),
    ([0], 0.0, 46, 5),
    ([47], 0.0, 45, 5),
    ([2], 0.0, 0, 5),
    ([1], 0.0, 47, 5),
    ([0, 47], 0.5, 44, 8),
    (range(10, 30), 0.0, 8, 24),
    (range(10, 31), 0.0, 0, 48),
    (range(10, 30), 0.05, 0, 48),
    (range(48), 0.0, 0, 48),
    (range(48), 0.5, 0, 48),
    ([5, 29], 0.0, 0, 48),
    ([], 0.5, 23, 2),
])
def test_enclosing_in_one_dimension(nodes, margin, start, extent):
    """Two nodes and the part ``margin`` of the extent are added on each side; 25 nodes are as good
    as the whole cell."""
    window = enclosing(LINE, circular(48, nodes), margin)
    assert (window.start, window.shape) == ((start,), (extent,))
    assert set(nodes) <= set(window.take(np.arange(48)))


def test_enclosing_is_smallest():
    rng = np.random.default_rng(3)
    for _ in range(200):
        nodes = rng.choice(48, size=rng.integers(1, 6), replace=False)
        window = enclosing(LINE, circular(48, nodes), 0.0)
        smallest = min(max((nodes - first) % 48) + 1 for first in nodes) + 4
        assert window.size == (smallest if 2 * smallest - 1 < 48 else 48)
        assert circular(48, nodes)[window.indices].sum() == len(nodes)
        if not window.is_whole:
            near = circular(48, nodes)[window.indices]
            assert near[2] and near[-3] and not near[:2].any() and not near[-2:].any()


def test_enclosing_in_two_dimensions():
    mask = np.zeros(PLANE.shape, dtype=bool)
    assert enclosing(PLANE, mask, 0.1) == Window(PLANE, (9, 17), (2, 2))
    mask[18, 3], mask[1, 9] = True, True
    assert enclosing(PLANE, mask, 0.0) == Window(PLANE, (16, 1), (8, 11))
    assert enclosing(PLANE, mask, 0.2) == Window(PLANE, (16, 0), (8, 13))
    mask[::3, 34] = True
    assert enclosing(PLANE, mask, 0.0) == Window(PLANE, (0, 32), (20, 16))
    assert enclosing(PLANE, np.ones(PLANE.shape, dtype=bool), 0.05) == PLANE.whole


# Convolutions

@pytest.mark.parametrize("window", BOXES, ids=name)
@pytest.mark.parametrize("components", [1, 2, 3])
@pytest.mark.parametrize("coupled", [False, True])
def test_convolution_is_that_of_the_cell(window, components, coupled):
    grid = window.grid
    blocks = blocks_of(grid, components, coupled)
    values = random(components, window.size)
    cell = np.zeros((components, *grid.shape))
    window.put(values, cell)
    expected = window.take(on_the_cell(grid, blocks, cell))
    convolution = Convolution(window, Operator(window.grid, blocks), components)
    np.testing.assert_allclose(convolution.apply(values, np.empty_like(values)), expected,
                               atol=1e-12)
    again = values.copy()
    assert convolution.apply(again, again) is again
    np.testing.assert_allclose(again, expected, atol=1e-12)


@pytest.mark.parametrize("nodes, circle", [(1, 1), (2, 3), (3, 5), (5, 9), (8, 15), (13, 25),
                                           (14, 27)])
def test_odd_circles(nodes, circle):
    window = Window(LINE, (40,), (nodes,))
    assert window.circle() == (circle,)
    test_convolution_is_that_of_the_cell(window, 2, True)
    wide = Window(Grid((16, 64), (4.0, 9.0)), (14, 60), (3, nodes))
    assert wide.circle() == (5, circle)
    test_convolution_is_that_of_the_cell(wide, 3, True)


def test_convolution_without_some_diagonal_blocks():
    window, values = BOXES[0], random(2, 7)
    blocks = {(0, 1): blocks_of(LINE, 2)[0, 1]}
    cell = np.zeros((2, 48))
    window.put(values, cell)
    expected = window.take(on_the_cell(LINE, blocks, cell))
    np.testing.assert_allclose(Convolution(window, Operator(LINE, blocks),
                                           2).apply(values, np.empty((2, 7))), expected, atol=1e-12)
    np.testing.assert_array_equal(expected[1], 0.0)


@pytest.mark.parametrize("grid", [LINE, PLANE])
def test_kernel_is_the_response_to_a_unit(grid):
    blocks = blocks_of(grid, 2)
    unit = np.zeros((2, *grid.shape))
    unit[(1, *[0] * len(grid.shape))] = 1.0
    response = on_the_cell(grid, blocks, unit)
    np.testing.assert_allclose(Operator(grid, blocks).kernel((1, 1)), response[1], atol=1e-14)
    np.testing.assert_allclose(Operator(grid, blocks).kernel((0, 1)), response[0], atol=1e-14)


# Smoothing

@pytest.mark.parametrize("width", [0.5, 1.0, 2.0])
def test_smoothing_keeps_mass_centre_and_symmetry(width):
    grid = Grid((400,), (100.0,))
    window = Window(grid, (60,), (161,))
    bump = np.zeros(161)
    bump[70:91] = 1.0
    blurred, x = smooth(window, bump, width), window.coordinates()[0]
    assert blurred.sum() == pytest.approx(bump.sum(), rel=1e-13)
    np.testing.assert_allclose(blurred, blurred[::-1], atol=1e-14)
    unit = np.eye(161)[80]
    kernel = smooth(window, unit, width)
    spread = math.sqrt(np.sum(kernel * (x - x[80]) ** 2))
    assert spread == pytest.approx(width, abs=0.6 * grid.spacings[0])
    np.testing.assert_allclose(blurred, np.convolve(bump, kernel, mode="same"), atol=1e-14)
    fourth = np.sum(kernel * (x - x[80]) ** 4) / spread**4
    assert fourth == pytest.approx(3.0, abs=0.5)


def test_smoothing_is_zero_away_from_the_values():
    window = Window(LINE, (2,), (40,))
    mask = np.zeros(40, dtype=bool)
    mask[15:19] = True
    blurred = smooth(window, mask, 2.4 * LINE.spacings[0])
    assert blurred.min() == 0.0 and np.flatnonzero(blurred)[[0, -1]].tolist() == [9, 24]


def test_smoothing_on_the_cell_is_periodic():
    bump = np.zeros(48)
    bump[20:25] = random(5)
    moved = smooth(LINE.whole, np.roll(bump, 25), 1.0)
    np.testing.assert_allclose(moved, np.roll(smooth(LINE.whole, bump, 1.0), 25), atol=1e-14)
    assert moved.sum() == pytest.approx(bump.sum(), rel=1e-13)


def test_smoothing_on_a_window_continues_its_border():
    window = Window(LINE, (30,), (20,))
    np.testing.assert_allclose(smooth(window, np.full(20, 2.5), 1.0), 2.5, rtol=1e-14)
    step = smooth(window, np.arange(20) < 10, 0.5)
    assert np.all(np.diff(step) <= 1e-14)
    assert step[0] == pytest.approx(1.0, rel=1e-12) and step[-1] == 0.0


def test_smoothing_in_two_dimensions_is_a_product():
    window = Window(PLANE, (15, 3), (9, 30))
    first, second = np.zeros(9), np.zeros(30)
    first[4], second[15] = 1.0, 1.0
    blurred = smooth(window, np.outer(first, second).ravel(), 0.4)
    assert blurred.shape == (270,)
    rows = smooth(Window(Grid((20,), (5.0,)), (15,), (9,)), first, 0.4)
    columns = smooth(Window(Grid((36,), (12.0,)), (3,), (30,)), second, 0.4)
    np.testing.assert_allclose(blurred, np.outer(rows, columns).ravel(), atol=1e-15)


def test_smoothing_narrower_than_a_node_or_wider_than_the_window():
    values = random(7)
    np.testing.assert_array_equal(smooth(BOXES[0], values, 0.01), values)
    for nodes in (1, 2, 3, 4, 5):
        window = Window(LINE, (3,), (nodes,))
        np.testing.assert_allclose(smooth(window, np.ones(nodes), 50.0), 1.0, rtol=1e-14)


# Crossings

def test_crossings_are_exact_for_a_cubic():
    nodes = np.arange(12.0)
    places, signs = crossings((nodes - 2.3) * (nodes - 5.6) * (nodes - 8.2) + 7.0, 7.0)
    np.testing.assert_allclose(places, [2.3, 5.6, 8.2], atol=1e-12)
    assert signs.tolist() == [1, -1, 1]


def test_crossings_at_the_ends_are_linear():
    places, signs = crossings(np.array([1.0, -1.0, -4.0, 0.0, 3.0]), 0.5)
    np.testing.assert_allclose(places, [0.25, 3 + 0.5 / 3], rtol=1e-14)
    assert signs.tolist() == [-1, 1]
    assert crossings(np.arange(3.0), 5.0)[0].size == 0


def test_crossings_are_of_fourth_order():
    spacings, root = 0.2 * 0.5 ** np.arange(4), np.arcsin(0.2)
    errors = [h * abs(crossings(np.sin(root + h * (np.arange(9) - 4.37)), 0.2)[0][0] - 4.37)
              for h in spacings]
    assert np.polyfit(np.log(spacings), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize("waves", [3, 30])  # found one by one, and all at once
def test_fields_where_a_line_crosses_a_level(waves):
    turn = np.linspace(0.0, 2.0 * np.pi * waves, 4001)
    found = at_level(np.sin(turn), 0.2, np.array([np.cos(turn), np.sin(turn)]))
    assert found.shape == (2, 2 * waves)
    np.testing.assert_allclose(found[0], np.resize([1.0, -1.0], 2 * waves) * np.sqrt(0.96),
                               atol=1e-6)
    np.testing.assert_allclose(found[1], 0.2, atol=1e-13)


def test_crossings_where_a_node_is_on_the_level():
    rng = np.random.default_rng(0)
    for _ in range(300):
        values = 10 * rng.normal(size=7)
        values[3] = np.e
        places, signs = crossings(values, np.e)
        above = values >= np.e
        assert len(places) == np.count_nonzero(above[1:] != above[:-1]) == len(signs)
        if above[2] != above[4]:
            assert 3.0 in places


def test_area_below_a_level_is_of_fourth_order_in_the_spacing():
    errors = []
    for points in (32, 64, 128):
        grid = Grid((points, points), (6.0, 6.0))
        x, y = grid.coordinates()
        # A disc of radius 1, whose rim is not straight to third order, over the cell's border.
        radius = np.hypot((x - 2.7 + 3.0) % 6.0 - 3.0, y - 0.123)
        gap = radius + 0.1 * np.exp(-3.0 * (radius - 1.0) ** 2) - 0.1
        errors.append(abs(grid.whole.area_below(gap.reshape(-1), 1.0) / np.pi - 1.0))
    assert errors[0] < 2e-3 and errors[2] < 1e-5 and errors[2] < errors[0] / 100


def test_area_of_a_few_nodes_is_that_of_the_surface_through_them():
    """Cubic interpolation has a paraboloid exactly: what is left is the error of triangles, which
    two divisions cancel."""
    grid = Grid((16, 16), (16.0, 16.0))
    x, y = grid.coordinates()
    errors = [abs(grid.whole.area_below(((x - 0.3) ** 2 + (y + 0.2) ** 2).reshape(-1),
                                        radius ** 2) / (np.pi * radius ** 2) - 1.0)
              for radius in (2.3, 3.1, 4.4)]
    assert max(errors) < 1e-4


def test_area_of_a_quarter_with_its_mirror_images_is_that_of_all_nodes():
    grid = Grid((32, 24), (2.0 * np.pi, 2.0 * np.pi))
    for window in (grid.whole, grid.box((4, 3), (25, 19)), grid.box((3, 0), (27, 24))):
        x, y = window.coordinates()
        for gap in (1.3 - np.cos(x) * np.cos(y), 1.1 - np.cos(2 * x) + 0.3 * x ** 2 + 0.7 * y ** 2):
            field = np.broadcast_to(gap, window.shape).copy()
            if not window.is_whole:  # the law acts, and contact is, within
                field[window.rim().reshape(window.shape)] = 9.0
                field = np.where((np.abs(x) < 2.0) & (np.abs(y) < 2.0), field, 9.0)
            half = halved(window)
            area = half.area_below(half.fold(field.reshape(1, -1))[0], 0.9)
            assert area > 0.5
            assert area == pytest.approx(window.area_below(field.reshape(-1), 0.9), rel=1e-12)


def test_lengths_below_a_level_are_those_of_all_intervals():
    grid = Grid((64,), (2.0 * np.pi,))
    x, = grid.coordinates()
    for waves in (1, 2, 3):
        # Over the border of the cell, too: cos(n x) < 1/2 on two thirds of the line, however many
        # intervals.
        assert grid.whole.area_below(np.cos(waves * x), 0.5) == pytest.approx(4.0 * np.pi / 3.0,
                                                                              rel=1e-3)
    window = Window(grid, (20,), (25,))
    assert window.area_below(window.take(np.cos(x)), 0.3) == 0.0
    assert window.area_below(window.take(-np.cos(x)), -0.9) == pytest.approx(2.0 * np.arccos(0.9),
                                                                             rel=1e-5)


def test_windows_are_equal_on_one_cell_only():
    grids = [Grid((32,), (10.0,)), Grid((32,), (10.0,)), Grid((64,), (10.0,)), Grid((32,), (5.0,))]
    boxes = [Window(grid, (4,), (8,)) for grid in grids]
    several = [Spots(grid, [(4,), (16,)], (8,)) for grid in grids]
    for windows in (boxes, several, [grid.whole for grid in grids]):
        assert [window == windows[0] for window in windows] == [True, True, False, False]
        assert len(set(windows)) == 3 and windows[0] != "a window"
    assert boxes[0] != several[0] and len({*boxes, *several}) == 6
