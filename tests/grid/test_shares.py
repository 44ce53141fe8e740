"""Who has which rows: patches of them are one process's, whatever the number of processes."""

import pytest

from contactsnes.grid.slab_transform import shares


@pytest.mark.parametrize("size", range(1, 20))
@pytest.mark.parametrize("rows, unit", [(16, 4), (18, 2), (15, 1), (20, 4)])
def test_patches_of_rows_are_shared_out_as_far_as_there_are_any(rows, unit, size):
    counts = [number for _, number in shares(rows, size, 4)]
    assert sum(counts) == rows and not any(number % unit for number in counts)
    assert sum(number > 0 for number in counts) == min(size, rows // unit)
    assert max(counts) - min(counts) <= unit
