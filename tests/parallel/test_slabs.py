"""What the grid does with rows of several processes against the same on one, node by node."""

import pytest
from ranks import SIZES, say, together

PROGRAM = """
import sys
from types import SimpleNamespace
import numpy as np
from mpi4py import MPI
from contactsnes.grid.active import some, widened
from contactsnes.grid.cell import Grid
from contactsnes.grid.nearest import nearest
from contactsnes.grid.numbers import numbers_of, restored
from contactsnes.grid.slab_transform import shares
from contactsnes.grid.spots import corrected_count, labelled, sizes
from contactsnes.grid import slabs, transfer
from contactsnes.grid.transfer import refined, resampled, smooth
from contactsnes.interface.gap import is_convex
from contactsnes.kernels.choice import chosen as kernels_chosen
from contactsnes.solvers.core_blocks import Core, CoreBlock, PatchedBlock, on_part

shape, periods = (46, 32), (5.0, 4.0)
shared, alone = slabs.Slabs(shape, periods, MPI.COMM_WORLD), Grid(shape, periods)
random = np.random.default_rng(1)
cell = random.normal(size=(2, *shape))
mask = smooth(alone.whole, (cell[0] > 0.8).reshape(-1), 0.2).reshape(shape) > 0.35
chosen = np.flatnonzero(mask)
first = shared.rows.first * shape[1]


def both(function):
    return function(shared, shared.part_of), function(alone, lambda field: field)


def alike(what, function):
    here, whole = both(function)
    whole = shared.part_of(whole) if np.ndim(whole) == 2 else whole
    assert np.allclose(here, whole, rtol=1e-12, atol=1e-13), (what, here, whole)


def nodes(grid, part):
    return some(grid.whole, np.flatnonzero(part(mask)))


def on_cell(window, grid, values):
    field = np.full(grid.local_shape, -1.0)
    window.put(np.asarray(values, dtype=float), field)
    return field


for what in ("sum", "maximum", "minimum", "mean", "count", "any"):
    alike(what, lambda grid, part: np.sum(getattr(grid, what)(part(cell[0]).reshape(1, -1) + 0.1)))
alike("inner", lambda grid, part: grid.inner(part(cell[0]), part(cell[1])))
alike("highest", lambda grid, part: np.array(grid.highest(part(cell[0]))))
alike("widened", lambda grid, part: widened(grid, part(mask), 2))
alike("rim", lambda grid, part: on_cell(nodes(grid, part), grid, nodes(grid, part).rim()))
for rows in ([20, 21], [0, 45], [15, 16]):
    for reach in (1, 2):
        # nodes in all rows but one, and whether those at some rows are surrounded
        def surrounded(grid, part):
            kept = np.ones(shape, dtype=bool)
            kept[18] = False
            asked = np.zeros(shape, dtype=bool)
            asked[rows] = True
            window = some(grid.whole, np.flatnonzero(part(kept)))
            return float(window.surround(window.take(part(asked)), reach))
        alike("surround", surrounded)
alike("labels", lambda grid, part: labelled(part(mask), grid))
alike("sizes", lambda grid, part: sizes(labelled(part(mask), grid), grid))
alike("corrected", lambda grid, part: corrected_count(part(mask), grid))
assert sizes(labelled(mask)).size > 3
alike("smooth", lambda grid, part: smooth(grid.whole, part(mask).reshape(-1), 0.3).reshape(
    grid.local_shape))
# of a mask in few rows, which others have, too, by either's kernels
for row in (3, 12, 23, 31, 42):
    spot = np.zeros(shape, dtype=bool)
    spot[row:row + 2, 9:14] = True
    for kernels in (kernels_chosen(True), kernels_chosen(False)):
        def blurred(grid, part):
            where, found = kernels.blurred(grid.whole, part(spot).reshape(-1), 0.15)
            around = np.zeros(grid.local_shape)
            around[grid.whole.own(where)[1]] = found
            return around
        alike(f"blurred at row {row}", blurred)
alike("area", lambda grid, part: grid.whole.area_below(part(cell[0]).reshape(-1), 0.3))
# what one process has of squares to be divided is dealt out, in its order; what is even stays
squares, rank, size = random.normal(size=(7, 4, 4)), shared.comm.rank, shared.comm.size
for number in (0, 7):
    here = shared.evened(squares[:number if rank == size - 1 else 0])
    begin, count = shares(number, size)[rank]
    assert np.array_equal(here, squares[begin:begin + count])
assert shared.evened(here := squares[:4 + rank % 2]) is here
alike("every other", lambda grid, part: refined(grid, grid.every_other(part(cell[0]))))
transfer.STRIP, whole = 150, transfer.STRIP  # some rows at a time
alike("in strips", lambda grid, part: refined(grid, grid.every_other(part(cell[0]))))
transfer.STRIP = whole


def spectral(grid, part):
    transform = grid.transform(grid, grid.shape, 1)
    transform.real[0] = part(cell[0])
    transform.forward()
    return np.array([grid.parseval(transform.spectrum),
                     grid.spectral_inner(transform.spectrum, transform.spectrum)])


alike("spectral", spectral)
assert np.isclose(spectral(alone, lambda field: field)[0], np.sum(cell[0] ** 2))
x, y = alone.coordinates()
for name, gap in {"bowl": x ** 2 + y ** 2, "saddle": x ** 2 - y ** 2, "flat": 0.0 * (x + y),
                  "wave": 1.0 - np.cos(2 * np.pi * x / 5.0) + y ** 2,
                  "dent": x ** 2 + y ** 2 - 0.5 * ((x > 1.0) & (x < 1.2) & (y > 0.9) & (y < 1.1)),
                  }.items():
    for shift in ((0, 0), (17, 5)):
        moved = np.roll(gap, shift, (0, 1))
        alike(name, lambda grid, part: float(is_convex(part(moved), grid)))
assert is_convex(x ** 2 + y ** 2)

# blocks of a core's rows on a circle of their own: the same as on one process
def inverted(grid, rows, columns, circle, single, scattered):
    weight = np.zeros(shape)
    weight[rows, columns] = 0.2 + random_weight[rows, columns]
    chosen = np.flatnonzero(part_of(grid)(weight)) if scattered else slice(None)
    window = some(grid.whole, chosen) if scattered else grid.whole
    points = grid.of_circle(circle) if scattered else grid
    form = SimpleNamespace(window=window, components=1, contact=SimpleNamespace(
        grid=grid, body=SimpleNamespace(diagonal=symbols), ranges=[1.0],
        circle=lambda component, extents, *rest: (
            (points.circle or points.transform)(points, circle, 1),
            points.symbols(symbols, 1, circle)[0, 0])))
    make = PatchedBlock if scattered else CoreBlock
    part, weight = None if scattered else (rows, columns), part_of(grid)(weight).reshape(-1)[chosen]
    block = make(form, 0, Core(part, on_part(window, part, weight), np.array([2.0])), 1.0)
    field = part_of(grid)(cell[0]).reshape(-1)[chosen].copy()
    block.apply(field, single)
    return on_cell(window, grid, field)


def symbols(waves, components, last_even):
    first, second = waves
    return {(0, 0): 1.0 / (1.0 + first ** 2 + 2.0 * second ** 2)}


def part_of(grid):
    return grid.part_of if grid is shared else lambda field: field


random_weight = 0.8 * random.random(shape)
for rows, columns, circle in ((slice(3, 12), slice(5, 20), (12, 18)),
                              (slice(0, 46), slice(0, 32), shape),
                              (slice(10, 40), slice(7, 8), (46, 3)),
                              (slice(22, 24), slice(0, 31), (5, 32))):
    for scattered, slabs.GATHERED in ((False, 0), (True, 0), (True, 2 ** 14)):
        for single in (False, True):
            here, whole = (inverted(grid, rows, columns, circle, single, scattered)
                           for grid in (shared, alone))
            assert np.allclose(here, shared.part_of(whole), rtol=0.0,
                               atol=2e-6 if single else 1e-13), (rows, scattered, single)

# the transform of a circle is made anew where rows are others, or nothing holds it
circle = shared.circle(shared, (12, 18), 1)
made = circle.placed(shares(9, shared.comm.size))
assert circle.placed(shares(9, shared.comm.size)) is made
assert circle.placed(shares(8, shared.comm.size)) is not made

# three fields at a time
for single in (False, True):
    fields = np.concatenate([cell, cell[:1] * cell[1:]])
    transform = shared.transform(shared, shape, 3)
    transform = transform.single if single else transform
    transform.real[...] = shared.part_of(fields)
    transform.forward()
    waves = np.fft.rfft2(fields)[:, :, shared.waves]
    assert np.allclose(transform.spectrum, waves, rtol=0.0, atol=1e-3 if single else 1e-11)
    transform.backward()
    assert np.allclose(transform.real / transform.gain, shared.part_of(fields), rtol=0.0,
                       atol=1e-5 if single else 1e-13)

# values at other nodes: the same, or those of a nearest one
values = cell[:, mask]
few = np.flatnonzero(mask & (x < 1.5))
for wanted in (np.flatnonzero(widened(alone, mask, 1)), np.arange(mask.size)):
    known = np.zeros(mask.size, dtype=bool)
    known[few] = True
    source = some(shared.whole, np.flatnonzero(shared.part_of(known.reshape(shape))))
    asked = np.zeros(mask.size, dtype=bool)
    asked[wanted] = True
    window = some(shared.whole, np.flatnonzero(shared.part_of(asked.reshape(shape))))
    found = nearest(source.take(shared.part_of(cell)), source, window)
    # the way there is kept
    assert np.array_equal(nearest(2.0 * source.take(shared.part_of(cell)), source, window),
                          2.0 * found)
    if len(wanted) == mask.size:
        assert np.array_equal(source.filled(source.take(shared.part_of(cell))), found)
    places = np.array(np.unravel_index(few, shape))
    for node, value in zip(window.node_numbers(), found.T):
        away = np.abs(places - np.array(np.unravel_index(node, shape))[:, None])
        away = np.minimum(away, np.array(shape)[:, None] - away)
        distance = np.sum(away ** 2, axis=0)
        close = distance == distance.min()
        assert np.any(np.all(cell.reshape(2, -1)[:, few[close]].T == value, axis=1))

# kept and restored
window = nodes(shared, shared.part_of)
numbers, kept = numbers_of(window), shared.to_first(window.take(shared.part_of(cell)))
again, back = restored(shared, numbers, kept)
assert again == window and np.array_equal(back, window.take(shared.part_of(cell)))
print("alike")
"""


@together
@pytest.mark.parametrize("size", (1, *SIZES))
def test_rows_of_several_processes_are_those_of_one(size, tmp_path):
    say(size, PROGRAM, tmp_path)
