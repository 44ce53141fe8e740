"""Fields from a grid to one on twice as many nodes."""

import numpy as np
import pytest

from contactsnes.grid.cell import Grid
from contactsnes.grid.transfer import interpolated, interpolation
from contactsnes.grid.windows import Window

WINDOWS = [((64,), (3,), (21,)), ((64,), (4,), (20,)), ((64,), (60,), (13,)), ((64,), (0,), (64,)),
           ((32, 16), (3, 2), (9, 7)), ((32, 16), (30, 0), (11, 16)), ((32, 16), (0, 0), (32, 16)),
           ((32, 16), (5, 15), (8, 6))]


@pytest.mark.parametrize("shape, start, extent", WINDOWS)
def test_interpolated_values_are_those_of_the_matrix(shape, start, extent):
    matrix = interpolation(window := Window(Grid(shape, map(float, shape)), start, extent))
    values = np.random.default_rng(1).normal(size=matrix.shape[1])
    np.testing.assert_allclose(interpolated(window, values), matrix @ values, atol=1e-14)


def test_cubics_are_interpolated_exactly():
    window = Window(Grid((64, 64), (1.0, 1.0)), (7, 10), (30, 21))
    x, y = np.arange(7.0, 37.0)[:, None], np.arange(10.0, 31.0)
    field = 1.0 + x * y ** 2 - 0.1 * x ** 3
    even = field[1::2, ::2]
    found = interpolated(window, even.reshape(-1)).reshape(field.shape)
    np.testing.assert_allclose(found[4:-4, 4:-4], field[4:-4, 4:-4], rtol=1e-13)
