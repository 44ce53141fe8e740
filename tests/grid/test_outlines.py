"""Outlines against ellipses, intervals and bands that are known."""

import math

import numpy as np
import pytest
from scipy.special import ellipe

from contactsnes.grid import contours
from contactsnes.grid.boxes import Spots
from contactsnes.grid.cell import Grid
from contactsnes.grid.outlines import outline
from contactsnes.grid.windows import Window

A, B, X, Y = 1.3, 0.8, 0.2, -0.1


def ellipse(points, whole=True):
    grid = Grid((points, points), (4.0, 4.0))
    x, y = grid.coordinates()
    values = ((x - X) / A) ** 2 + ((y - Y) / B) ** 2
    window = grid.whole if whole else Window(grid, (points // 16,) * 2, (7 * points // 8,) * 2)
    return outline(window, window.take(values), 1.0)


@pytest.mark.parametrize("whole", [True, False])
def test_an_ellipse_has_its_axes_centroid_and_perimeter(whole):
    found = ellipse(64, whole)
    for axis, (half, centre) in enumerate(((A, X), (B, Y))):
        first, last = found.extent(axis)
        assert 0.5 * (last - first) == pytest.approx(half, rel=3e-5)
        assert found.centroid(axis) == pytest.approx(centre, abs=1e-6)
    assert found.length() == pytest.approx(4 * A * ellipe(1 - (B / A) ** 2), rel=2e-5)
    assert found.around == (False, False)


def test_perimeter_is_of_second_order():
    exact = 4 * A * ellipe(1 - (B / A) ** 2)
    errors = [abs(ellipse(points).length() / exact - 1) for points in (32, 64, 128)]
    assert errors[0] > 3.5 * errors[1] > 12 * errors[2]


def test_the_inside_is_on_the_left():
    """Green's theorem gives the area with its sign."""
    (x0, y0), (x1, y1) = np.moveaxis(ellipse(64).ends, 0, -1)
    assert 0.5 * np.sum(x0 * y1 - x1 * y0) == pytest.approx(np.pi * A * B, rel=1e-4)


def test_a_few_squares_at_a_time_are_all_of_them(monkeypatch):
    """Pieces and area are the same, in another order."""
    grid = Grid((64, 64), (4.0, 4.0))
    values = np.random.default_rng(3).normal(size=grid.size)
    all_, area = outline(grid.whole, values, 0.3), grid.whole.area_below(values, 0.3)
    monkeypatch.setattr(contours, "MANY", 7)
    few = outline(grid.whole, values, 0.3)
    assert len(all_.ends) > 1000
    # how long an array is decides on last digits: NumPy has processors take several numbers at once
    np.testing.assert_allclose(*(np.sort(found.ends.reshape(-1, 4), axis=0)
                                 for found in (all_, few)), rtol=0.0, atol=1e-12)
    assert few.length() == pytest.approx(all_.length(), rel=1e-12)
    assert grid.whole.area_below(values, 0.3) == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize("fields", [1, 2])
def test_an_outline_is_closed(fields):
    """Where it bulges into a square none of whose corners it parts, too: through a hole of 0.1
    beside a far spot a centroid is off by the spot's distance times that."""
    grid = Grid((24, 40), (5.0, 3.0))
    values = np.random.default_rng(fields).normal(size=(fields, *grid.shape))
    box = Window(grid, (3, 5), (17, 30))
    for window in (grid.whole, box):
        part = window.take(values)
        part[..., window.rim()] = 1.0
        ends = outline(window, part, 0.3).ends
        begin, end = (np.sort(np.round(places / grid.periods % 1.0, 6) @ [1.0, math.pi])
                      for places in np.moveaxis(ends, 1, 0))
        np.testing.assert_allclose(begin, end, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(np.diff(ends, axis=1).sum(axis=0), 0.0, atol=1e-9)


def test_several_boxes_are_one_outline():
    grid = Grid((64, 64), (8.0, 8.0))
    x, y = grid.coordinates()
    values = np.minimum((x + 2) ** 2 + y ** 2, (x - 2) ** 2 + (y - 1) ** 2)
    spots = Spots(grid, np.array([(8, 24), (40, 32)]), (16, 16))
    one, several = (outline(window, window.take(values), 0.5) for window in (grid.whole, spots))
    assert several.length() == pytest.approx(one.length(), rel=1e-12)
    assert several.length() == pytest.approx(4 * np.pi * np.sqrt(0.5), rel=1e-3)
    assert several.extent(0) == pytest.approx(one.extent(0), rel=1e-12)
    assert several.centroid(1) == pytest.approx(0.5, abs=1e-5)
    both = np.array([values, values + 0.1 * x])
    whole, boxes = (window.area_below(window.take(both), 0.5) for window in (grid.whole, spots))
    assert boxes == pytest.approx(whole, rel=1e-12)
    assert 2.0 < boxes < grid.whole.area_below(values.reshape(-1), 0.5)


def test_what_goes_around_the_cell_has_no_extent_there():
    grid = Grid((32, 32), (4.0, 4.0))
    x, _ = grid.coordinates()
    band = outline(grid.whole, np.broadcast_to(x ** 2, grid.shape).reshape(-1), 1.0)
    assert band.around == (False, True)
    assert band.extent(0) == pytest.approx((-1.0, 1.0), rel=1e-12)
    assert np.isnan(band.extent(1)).all() and np.isnan(band.centroid(1))
    assert band.length() == pytest.approx(8.0, rel=1e-12)


def test_a_contact_around_the_cell_one_way_has_a_centroid_the_other_way():
    """A band from x = -0.7 to 1.1 and a disc across the border along y, of area 0.16 pi about
    x = -1.4."""
    grid = Grid((128, 128), (4.0, 4.0))
    x, y = grid.coordinates()
    across = np.minimum((y - 1.9) ** 2, (y + 2.1) ** 2)
    values = np.minimum(((x - 0.2) / 0.9) ** 2 + 0 * y, ((x + 1.4) ** 2 + across) / 0.16)
    disc, band = 0.16 * np.pi, 1.8 * 4.0
    meant = (0.2 * band - 1.4 * disc) / (band + disc)
    for turned, axis in ((values, 0), (values.T, 1)):
        found = outline(grid.whole, turned.reshape(-1), 1.0)
        assert found.centroid(axis) == pytest.approx(meant, abs=1e-4)
        assert np.isnan(found.centroid(1 - axis)) and np.isnan(found.extent(1 - axis)).all()


@pytest.mark.parametrize("centre", [1.55, 1.6, 1.9, 2.0, -1.9, -1.6, -1.55])
def test_a_box_across_the_border_tells_what_the_whole_cell_does(centre):
    """A contact of half width 0.3 in a cell of 4, its box from 1 to 3: on one side of the
    border its places are in the cell, across it none."""
    grid = Grid((64, 64), (4.0, 4.0))
    (x,) = Grid((64,), (4.0,)).coordinates()
    line = ((x - centre + 2.0) % 4.0 - 2.0) ** 2
    for one, values, box in ((Grid((64,), (4.0,)), line, ((48,), (32,))),
                             (grid, np.add.outer(line, x ** 2), ((48, 20), (32, 24)))):
        whole, part = (outline(window, window.take(values).reshape(-1), 0.09)
                       for window in (one.whole, Window(one, *box)))
        across = abs(centre) > 1.7
        assert whole.around == part.around == (across, *[False] * (len(one.shape) - 1))
        told = [[found.centroid(axis), *found.extent(axis)] for found in (whole, part)
                for axis in range(len(one.shape))]
        half = len(told) // 2
        np.testing.assert_allclose(told[:half], told[half:], rtol=0.0, atol=1e-12)
        known = [np.nan] * 3 if across else [centre, centre - 0.3, centre + 0.3]
        np.testing.assert_allclose(told[half], known, rtol=0.0, atol=1e-4)


def test_intervals_of_a_line():
    grid = Grid((256,), (2 * np.pi,))
    (x,) = grid.coordinates()
    found = outline(grid.whole, np.cos(2 * x + 0.3), 0.5)
    edges = np.arccos(0.5)
    assert found.ends[:, 1, 0] - found.ends[:, 0, 0] == pytest.approx(np.pi - edges, rel=1e-6)
    assert found.extent(0) == pytest.approx((-np.pi + (edges - 0.3) / 2,
                                             np.pi - (edges + 0.3) / 2), rel=1e-6)
    nothing = outline(grid.whole, np.cos(x), -2.0)
    assert np.isnan(nothing.extent(0)).all() and np.isnan(nothing.centroid(0))


@pytest.mark.parametrize("shift", range(5))
def test_edges_beside_the_border_of_a_closed_line_are_as_exact_as_others(shift):
    grid = Grid((64,), (2 * np.pi,))
    (x,) = grid.coordinates()
    # the left edge lies in turn around the places where the line closes
    values = -np.cos(x - x[-2] - shift * grid.spacings[0] - 1.0 - 0.3 * grid.spacings[0])
    for length in (outline(grid.whole, values, -np.cos(1.0)).inside(),
                   grid.whole.area_below(values, -np.cos(1.0))):
        assert length == pytest.approx(2.0, abs=4e-6)


@pytest.mark.parametrize("shape", [(64,), (64, 48)])
@pytest.mark.parametrize("reach, across", [(0.4, False), (0.9, False), (1.3, True)])
def test_a_contact_beside_the_border_and_its_mirror_image_tell_the_same(shape, reach, across):
    """Their edge lies between the last node and the border, or beyond that, so many spacings behind
    the last node."""
    grid = Grid(shape, (4.0,) * len(shape))
    x, *others = grid.coordinates()
    last = 2.0 - (1.0 - reach) * grid.spacings[0]
    values = (x - last + 0.7) ** 2 + sum(y ** 2 for y in others)
    # the body is another one around the cell
    values = np.minimum(values, (x + 4.0 - last + 0.7) ** 2 + sum(y ** 2 for y in others))
    image = np.roll(np.flip(values, 0), 1, 0)
    one, other = (outline(grid.whole, field.ravel(), 0.49) for field in (values, image))
    assert one.around[0] == other.around[0] == across
    told, mirrored = ([*found.extent(0), found.centroid(0)] for found in (one, other))
    expected = [np.nan] * 3 if across else [last - 1.4, last, last - 0.7]
    np.testing.assert_allclose(told, expected, rtol=0.0, atol=1e-3)
    np.testing.assert_allclose([-mirrored[1], -mirrored[0], -mirrored[2]], expected, rtol=0.0,
                               atol=1e-3)


@pytest.mark.parametrize("shape", [(64,), (64, 32)])
def test_nodes_of_several_boxes_have_the_numbers_that_they_have_in_the_cell(shape):
    grid = Grid(shape, (4.0,) * len(shape))
    window = Spots(grid, np.array([[4] * len(shape), [60] * len(shape), [30] * len(shape)])
                   % shape, (6,) * len(shape))
    field = np.random.default_rng(1).normal(size=shape)
    np.testing.assert_array_equal(field.ravel()[window.node_numbers()], window.take(field))


def test_where_two_fields_are_below_a_level_each_is_interpolated_for_itself():
    """Two circles that cross, and one within the other by less than a spacing: the larger of both
    fields has a corner beside the edge, of which cubics know nothing."""
    grid = Grid((48, 48), (6.0, 6.0))
    x, y = grid.coordinates()
    for apart, radius, area in ((1.0, 1.0, 2 * math.pi / 3 - math.sqrt(3) / 2),
                                (0.0, 0.96, math.pi * 0.96 ** 2)):
        fields = [((x - off) ** 2 + y ** 2) / size ** 2 * np.ones(grid.shape)
                  for off, size in ((0.0, 1.0), (apart, radius))]
        fields[1] = 1.0 + 5.0 * (fields[1] - 1.0)
        values = np.reshape(fields, (2, -1))
        assert grid.whole.area_below(values, 1.0) == pytest.approx(area, rel=1.5e-3)
        length = 4 * math.pi / 3 if apart else 2 * math.pi * radius
        assert outline(grid.whole, values, 1.0).length() == pytest.approx(length, rel=1e-2)
    line = Grid((48,), (6.0,))
    x = line.coordinates()[0]
    ends = outline(line.whole, np.array([x ** 2, 1.0 + 5.0 * ((x - 0.06) ** 2 - 1.0)]), 1.0).ends
    assert np.allclose(ends.ravel(), [-0.94, 1.0], atol=1e-12)
