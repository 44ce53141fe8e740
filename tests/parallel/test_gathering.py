"""Fields of all processes in the first one, and back: compared with what they were made of."""

import pytest
from ranks import SIZES, say, together

TEXT = """
import numpy as np
from mpi4py import MPI
from contactsnes.grid import numbers
from contactsnes.grid.cell import Grid
from contactsnes.grid.rows import to_first
from contactsnes.grid.slabs import Slabs
from contactsnes.grid.active import some
from contactsnes.grid.windows import Window

comm = MPI.COMM_WORLD
whole = np.arange(2 * 10 * 6, dtype=float).reshape(2, 10, 6)
bounds = [0, *np.linspace(1, 10, comm.size).astype(int)]
mine = slice(bounds[comm.rank], bounds[comm.rank + 1])
for axis, field in ((-2, whole), (-1, np.swapaxes(whole, 1, 2)), (0, np.moveaxis(whole, 1, 0))):
    part = np.moveaxis(np.moveaxis(field, axis, 0)[mine], 0, axis)
    for kind in (float, complex, np.int32, bool):
        found = to_first(comm, part.astype(kind), axis)
        assert (found is None) == (comm.rank > 0)
        assert comm.rank or (np.array_equal(found, field.astype(kind)) and found.dtype == kind)

# Windows that one process has kept: the cell, a box over its seam, some nodes of a box.
shape, periods = (24, 16), (12.0, 8.0)
grid, alone = Slabs(shape, periods, comm), Grid(shape, periods)
field = np.random.default_rng(1).random((2, *shape))
box = Window(alone, (20, 3), (9, 7))
for window in (alone.whole, box, some(box, np.array([0, 5, 8, 31, 40, 62])),
               some(alone.whole, np.array([1, 200]))):
    kept = numbers.numbers_of(window) if comm.rank == 0 else {}
    here, values = numbers.restored(grid, kept, window.take(field) if comm.rank == 0 else None)
    assert here.is_whole == window.is_whole
    assert np.array_equal(values, here.take(grid.part_of(field)))
    assert comm.allreduce(here.size) == window.size == here.total
    back = numbers.numbers_of(here)
    gathered = grid.to_first(values)
    if comm.rank == 0:
        again = numbers.of_numbers(alone, back)
        assert np.array_equal(again.take(field), gathered)
print("done")
"""


@together
@pytest.mark.parametrize("size", SIZES)
def test_fields_come_to_the_first_process_and_back(size, tmp_path):
    say(size, TEXT, tmp_path, "done")
