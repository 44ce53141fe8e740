"""Who has which rows: none of the processes is idle before rows run out."""

import pytest

from contactsnes.grid.slab_transform import shares


@pytest.mark.parametrize("size", range(1, 20))
def test_processes_have_rows_of_a_cell_as_far_as_there_are_any(size):
    """Fours of them, which patches take, as far as these go round."""
    counts = [number for _, number in shares(16, size, 4)]
    assert sum(counts) == 16
    assert sum(number > 0 for number in counts) == min(size, 16)
    assert size > 4 or not any(number % 4 for number in counts)
