"""Fields of a window at the nodes of another one, against distances between all of their nodes."""

import gc

import numpy as np
import pytest

from contactsnes.grid import nearest as room
from contactsnes.grid.active import Nodes
from contactsnes.grid.boxes import Spots
from contactsnes.grid.cell import Grid
from contactsnes.grid.nearest import nearest
from contactsnes.grid.slab_nodes import _nearest_numbers

GRID = Grid((24, 20), (6.0, 5.0))


def some(part, seed):
    """About a part of the nodes of a box."""
    hull = GRID.box((3, 5), (15, 12))
    return Nodes(hull, np.flatnonzero(np.random.default_rng(seed).random(hull.size) < part))


WINDOWS = {"cell": GRID.whole, "box": GRID.box((20, 2), (9, 8)),
           "boxes": Spots(GRID, [(1, 1), (12, 9), (21, 15)], (5, 4)),
           "nodes": some(0.2, 1), "others": some(0.5, 2), "few": some(0.02, 3)}


def distances(source, window):
    """Squares of distances in nodes, around the cell, of nodes of the window from the source's."""
    total = np.array(GRID.shape)
    here, there = (np.transpose(np.unravel_index(each.node_numbers(), GRID.shape))
                   for each in (window, source))
    away = abs(here[:, None] - there[None])
    return (np.minimum(away, total - away) ** 2).sum(axis=-1)


@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("source", WINDOWS)
def test_values_are_those_of_the_nearest_nodes(source, window):
    source, window = WINDOWS[source], WINDOWS[window]
    fields = np.random.default_rng(4).random((2, source.size))
    for _ in range(2):  # found, and kept
        found = nearest(fields, source, window)
        assert found.shape == (2, window.size)
        taken = np.argmax(fields[0] == found[0][:, None], axis=1)
        np.testing.assert_array_equal(fields[:, taken], found)
        away = distances(source, window)
        least, own = away.min(axis=1), away[np.arange(window.size), taken]
        np.testing.assert_array_equal(own[least == 0], 0)
        # (some nodes go to a box by way of the box that holds them)
        if window.picked or not source.picked:
            np.testing.assert_array_equal(own, least)


def test_of_no_nodes_there_are_zeros():
    none = Nodes(GRID.whole, np.zeros(0, dtype=int))
    for window in WINDOWS.values():
        np.testing.assert_array_equal(nearest(np.zeros((3, 0)), none, window),
                                      np.zeros((3, window.size)))


def test_what_is_kept_goes_with_its_windows():
    source, window = some(0.3, 7), some(0.3, 8)
    nearest(np.zeros((1, source.size)), source, window)
    kept = room._known[source]
    assert list(kept) == [window]
    del window
    gc.collect()
    assert len(kept) == 0
    del source
    gc.collect()
    assert some(0.3, 7) not in room._known


@pytest.mark.parametrize("columns", [1, 2, 15, 16, 64, 65])
@pytest.mark.parametrize("part", [0.005, 0.05, 0.5])
def test_nearest_nodes_of_rows_may_lie_around_the_border(columns, part):
    known = np.random.default_rng(columns).random((7, columns)) < part
    known[3, -1] = True
    asked = np.flatnonzero(~known)
    found = _nearest_numbers(known, asked)
    assert known.reshape(-1)[found].all()
    row, column = np.divmod(asked, columns)
    nodes = np.argwhere(known)
    away = [abs(nodes[:, axis] - at[:, None]) for axis, at in enumerate((row, column))]
    least = (away[0] ** 2 + np.minimum(away[1], columns - away[1]) ** 2).min(axis=1)
    away = [abs(to - at) for to, at in zip(np.divmod(found, columns), (row, column))]
    np.testing.assert_array_equal(away[0] ** 2 + np.minimum(away[1], columns - away[1]) ** 2, least)
