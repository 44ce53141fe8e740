"""Krylov vectors in single precision in the library."""

import numpy as np

from ..grid.changes import LENGTH, Changes
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


def changes(before, after, like=None):
    """As `solvers.basis.changes`.

    Parameters
    ----------
    before, after, like : as of that; there is room for a few more than ``like``
    """
    count, held = (0, 0) if like is None else (len(like.runs), len(like.values))
    told, shifts = np.zeros(2, dtype=np.intc), np.empty(-(-len(before) // LENGTH))
    while True:
        count, held = count + count // 4 + 64, held + held // 4 + 1024
        runs, values = np.empty((count, 2), dtype=np.intc), np.empty(held, dtype=np.float32)
        shared().changes(len(before), address(before), address(after), address(shifts),
                         address(runs), count, address(values), held, address(told))
        if told[0] <= count and told[1] <= held:
            return Changes(shifts, runs[:told[0]], values[:told[1]])
        count, held = told.tolist()


def add_changed(rows, changed, factors, vector):
    """As `solvers.basis.add_changed`.

    Parameters
    ----------
    rows, changed, factors, vector : as of that
    """
    factors = np.ascontiguousarray(factors, dtype=float)
    shifts, runs, values = (_places(part) for part in zip(*changed))
    counts = np.array([len(each.runs) for each in changed], dtype=np.intc)
    work, places = np.empty(2 * len(changed), dtype=np.intc), _places(rows)
    return shared().add_changed(
        len(changed), len(vector), places.ctypes.data, shifts.ctypes.data, runs.ctypes.data,
        address(counts), values.ctypes.data, address(factors), address(vector), address(work))


def _places(rows):
    """Addresses of rows, an array."""
    return np.array([address(row) for row in rows], dtype=np.uintp)
