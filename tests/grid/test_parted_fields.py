"""Arrays in parts: their blocks, in the order of memory, are the array."""

import numpy as np
import pytest

from contactsnes.grid import parted


class Alone:
    """A communicator of one process."""

    rank, size = 0, 1

    @staticmethod
    def allgather(value):
        return [value]


@pytest.mark.parametrize("block", (1, 3, 7, 10, 1000))
@pytest.mark.parametrize("shape, axis", (((11,), 0), ((2, 11), -1), ((4, 5), 0), ((3, 4, 5), -2)))
def test_blocks_are_the_array(monkeypatch, block, shape, axis):
    monkeypatch.setattr(parted, "BLOCK", block)
    array = np.random.default_rng(1).normal(size=shape)
    found = parted.Parted(Alone, array, axis)
    assert found.shape == shape and found.size == array.size and np.size(found) == array.size
    copy, row = np.full(shape, np.nan), []
    for where, values in found.blocks():
        copy[where] = values
        row.extend(values.ravel())
        assert values.size <= max(block, shape[-1])
    assert np.array_equal(copy, array) and row == list(array.ravel())
    assert parted.largest(found) == np.max(np.abs(array))


@pytest.mark.parametrize("block", (1, 3, 7, 1000))
@pytest.mark.parametrize("shape", ((11,), (4, 5), (3, 4, 5)))
def test_pieces_cover_an_array(monkeypatch, block, shape):
    monkeypatch.setattr(parted, "BLOCK", block)
    array, row = np.arange(np.prod(shape)).reshape(shape), []
    for where in parted.pieces(shape):
        row.extend(array[where].ravel())
        assert array[where].size <= max(block, shape[-1] if len(shape) > 1 else 1)
    assert row == list(range(array.size))


def test_numbers_are_changed_when_they_are_taken():
    array = np.arange(6.0).reshape(2, 3)
    found = parted.typed(parted.Parted(Alone, array, -1).mapped(lambda block: 2.0 * block), "f4")
    (_, values), = found.blocks()
    assert found.dtype == values.dtype == "f4" and np.array_equal(values, 2.0 * array)
