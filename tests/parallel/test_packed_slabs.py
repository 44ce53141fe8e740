"""Products with symbols of fields whose rows several processes have, and stand in pairs, against
NumPy's of one."""

import pytest
from ranks import say, together

from contactsnes.kernels import library

pytestmark = pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))

PROGRAM = """
import itertools
import numpy as np
from mpi4py import MPI
from contactsnes.grid.slab_transform import share
from contactsnes.grid.slabs import Slabs
from contactsnes.kernels.choice import chosen

comm, random = MPI.COMM_WORLD, np.random.default_rng(6)
kernels = chosen(True)
# rows in the middle of a circle, of which some process has one more than pairs, or none
some = [(1, 3), (4, 4), (4, 0)][:comm.size - 1] + [(6, 1)]
for shape, rows, single in itertools.product([(24, 16), (12, 10), (64, 48)], (None, some),
                                             (False, True)):
    grid = Slabs(shape, (1.0, 1.0), comm)
    whole = (kernels.real(grid, shape, 2) if rows is None
             else kernels.circle(grid, shape, 2).placed(rows))
    pairs = whole.single if single else whole.folded
    if pairs is None:  # of odd numbers of rows, whose doubles are not in pairs
        assert rows and not single
        continue
    parts = grid.rows.parts if rows is None else rows
    first, count = parts[comm.rank]
    assert pairs.real.shape == (2, count + count % 2, shape[1])
    symbols = np.array([np.fft.rfft2(np.exp(-np.add.outer(*(np.minimum(
        np.arange(n), n - np.arange(n)) * size for n in shape)))).real for size in (0.3, 0.7)])
    here = share(symbols.shape[2], comm.rank, comm.size)
    fitted = pairs.fitting(symbols[..., here])
    fields = random.normal(size=(2, *shape))
    for number in set(range(shape[0])) - {row for begin, n in parts
                                          for row in range(begin, begin + n)}:
        fields[:, number] = 0.0
    places = pairs.places(np.arange(count * shape[1]))
    memory = pairs.real.reshape(2, -1)
    memory[...] = np.nan
    memory[:, places] = fields[:, first:first + count].reshape(2, -1)
    if count % 2 == 0:
        assert np.array_equal([pairs.rows(field).reshape(count, -1) for field in pairs.real],
                              fields[:, first:first + count].astype(pairs.real.dtype))
    made = grid.counter.made
    pairs.filter(fitted)
    assert grid.counter.made > made
    expected = np.fft.irfft2(np.fft.rfft2(fields) * symbols, s=shape) * pairs.gain
    assert np.allclose(memory[:, places].reshape(2, count, -1),
                       expected[:, first:first + count], rtol=0.0,
                       atol=(1e-5 if single else 1e-13) * pairs.gain), (shape, rows, single)
print("alike")
"""


@together
@pytest.mark.parametrize("size", (2, 3))
def test_products_of_pairs_of_rows_that_are_shared_out_are_numpys(size, tmp_path):
    say(size, PROGRAM, tmp_path)
