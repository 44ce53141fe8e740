"""Spots of a periodic cell against a search from node to node, and counts of nodes against hard
walls."""

import numpy as np
import pytest

from contactsnes.grid.spots import TOO_MANY, corrected_count, labelled, runs, sizes

RANDOM = np.random.default_rng(11)


def flooded(mask):
    """Spots by a search from each node to its neighbours around the cell."""
    labels, count = np.zeros(mask.shape, dtype=int), 0
    for start in np.argwhere(mask):
        if labels[tuple(start)]:
            continue
        count += 1
        waiting = [tuple(start)]
        while waiting:
            place = waiting.pop()
            if not mask[place] or labels[place]:
                continue
            labels[place] = count
            for axis in range(mask.ndim):
                for step in (-1, 1):
                    other = list(place)
                    other[axis] = (other[axis] + step) % mask.shape[axis]
                    waiting.append(tuple(other))
    return labels


@pytest.mark.parametrize("shape", ((40,), (24, 24), (16, 30)))
@pytest.mark.parametrize("share", (0.0, 0.2, 0.45, 0.6, 1.0))
def test_spots_are_those_of_a_search(shape, share):
    for _ in range(5):
        mask = RANDOM.random(shape) < share
        found = labelled(mask)
        np.testing.assert_array_equal(found, flooded(mask))
        assert sizes(found).sum() == mask.sum() and len(sizes(found)) == found.max(initial=0)


def test_spots_do_not_depend_on_where_the_cell_begins():
    mask = RANDOM.random((32, 32)) < 0.4
    expected = sorted(sizes(labelled(mask)))
    for shift in RANDOM.integers(0, 32, (5, 2)):
        assert sorted(sizes(labelled(np.roll(mask, shift, (0, 1))))) == expected


def ellipse(points, centre, axes):
    """Nodes of a cell of side 1 within an ellipse."""
    x = (np.arange(points) - points // 2) / points
    return ((x[:, None] - centre[0]) / axes[0]) ** 2 + ((x - centre[1]) / axes[1]) ** 2 < 1.0


def test_a_count_within_a_smooth_edge_is_right_without_a_correction():
    """It has no bias; the correction takes off that of hard walls, in proportion to the spacing."""
    axes, errors = (0.21, 0.13), []
    for points in (32, 64, 128, 256):
        masks = [ellipse(points, RANDOM.uniform(0, 1 / points, 2), axes) for _ in range(200)]
        plain, corrected = np.mean([[mask.sum(), corrected_count(mask)] for mask in masks],
                                   axis=0) / points ** 2
        area = np.pi * axes[0] * axes[1]
        assert abs(plain - area) < 0.1 * abs(corrected - area)
        errors.append(area - corrected)
        # steps between nodes, in spacings: the ellipse's extents, four times
        assert errors[-1] * points == pytest.approx(TOO_MANY * 4 * sum(axes), rel=0.1)
    order = np.polyfit(np.log([32, 64, 128, 256]), np.log(errors), 1)[0]
    assert order == pytest.approx(-1.0, abs=0.05)


def hard_sphere(points, centre, pressure):
    """Nodes that bear pressure under a sphere x^2/2 on a half-space, E* = 1, in a cell of side 1:
    Polonsky and Keer's method (Wear 231, 206, 1999), nothing of this package."""
    x = (np.arange(points) - points // 2) / points
    gap = sum(np.meshgrid(*((x - place) ** 2 / 2 for place in centre), indexing="ij"))
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(points, 1 / points)[:, None],
                             np.arange(points // 2 + 1))
    q[0, 0] = np.inf
    deformed = lambda field: np.fft.irfft2(2 / q * np.fft.rfft2(field), (points, points))
    load, way, last, again = np.full((points, points), pressure), 0.0, 1.0, 0.0
    for _ in range(500):
        inside = load > 0
        error = gap + deformed(load)
        error -= error[inside].mean()
        size = np.sum(error[inside] ** 2)
        way = np.where(inside, error + again * size / last * way, 0.0)
        last, moved = size, deformed(way)
        moved -= moved[inside].mean()
        step = np.sum((error * way)[inside]) / np.sum((moved * way)[inside])
        before, load = load, np.maximum(np.where(inside, load - step * way, load), 0.0)
        overlap = (load == 0) & (error < 0)
        again = 0.0 if overlap.any() else 1.0
        load[overlap] -= step * error[overlap]
        load *= pressure * points ** 2 / load.sum()
        if np.abs(load - before).sum() < 1e-6 * load.sum():
            return load > 0
    raise AssertionError("the solution with hard walls does not converge")


def test_corrected_counts_of_hard_contacts_converge_to_the_area():
    """A hard contact on a grid is too large by a part that falls with the spacing; the corrected
    count has less than half of it. Hertz: a^3 = 3 F/4, in a cell that he does not know of."""
    pressure = 0.0016
    fine = corrected_count(hard_sphere(320, (0.0, 0.0), pressure)) / 320 ** 2
    assert fine == pytest.approx(np.pi * (0.75 * pressure) ** (2 / 3), rel=0.02)
    plain, corrected = [], []
    for points in (40, 80):
        masks = [hard_sphere(points, RANDOM.uniform(0, 1 / points, 2), pressure)
                 for _ in range(12)]
        plain.append(np.mean([mask.sum() for mask in masks]) / points ** 2 / fine - 1)
        corrected.append(np.mean([corrected_count(mask) for mask in masks]) / points ** 2 / fine
                         - 1)
    assert plain[0] > 0.03 and np.log2(plain[0] / plain[1]) == pytest.approx(1.0, abs=0.5)
    assert np.all(np.abs(corrected) < np.array(plain) / 2)


def test_runs_of_a_line():
    """Nodes of each spot of a closed line from their numbers, as those of a map of it."""
    numbers = np.random.default_rng(7)
    for chance in (0.0, 0.2, 0.5, 0.9, 1.0):
        mask = numbers.random(60) < chance
        nodes = numbers.permutation(np.flatnonzero(mask))
        assert sorted(runs(nodes, 60)) == sorted(sizes(labelled(mask)))
    mask = np.zeros(9, dtype=bool)
    mask[[0, 1, 4, 7, 8]] = True
    assert runs(np.flatnonzero(mask), 9).tolist() == sizes(labelled(mask)).tolist() == [4, 1]
