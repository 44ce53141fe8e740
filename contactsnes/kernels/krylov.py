"""Krylov vectors in single precision in the library."""

import numpy as np

from .library import shared
from .structures import address


def inner_products(rows, vector):
    """As `solvers.basis.inner_products`."""
    found, places = np.empty(len(rows) + 1), _places(rows)
    shared().inner_products(len(rows), len(vector), places.ctypes.data, address(vector),
                            address(found))
    return found


def add_rows(rows, factors, vector):
    """As `solvers.basis.add_rows`.

    Parameters
    ----------
    rows, factors, vector : as of that
    """
    factors, places = np.ascontiguousarray(factors, dtype=float), _places(rows)
    return shared().add_rows(len(rows), len(vector), places.ctypes.data, address(factors),
                             address(vector))


def _places(rows):
    """Addresses of rows, an array."""
    return np.array([address(row) for row in rows], dtype=np.uintp)
