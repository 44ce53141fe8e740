"""Krylov vectors in single precision, or rounded, in the library."""

import numpy as np

from ..grid.rounded import Rounded
from .library import shared
from .structures import address


class Rows(list):
    """Rows in single precision, or rounded, to which others are added: where they begin is found
    once."""

    _known, _told = None, (0, None)

    def places(self):
        """Where the addresses of the rows stand, and those of their scales, or None: for as long as
        this list is."""
        if self._told[0] != len(self):
            self._known = _rows(self)
            self._told = len(self), tuple(map(_data, self._known))
        return self._told[1]


def inner_products(rows, vector, count=None):
    """As `solvers.basis.inner_products`.

    Parameters
    ----------
    rows, vector, count : as of that
    """
    rows, count = _held(rows), len(rows) if count is None else count
    found, (places, scales) = np.empty(count + 1), rows.places()
    shared().inner_products(count, len(vector), places, scales, address(vector), address(found))
    return found


def add_rows(rows, factors, vector):
    """As `solvers.basis.add_rows`.

    Parameters
    ----------
    rows, factors, vector : as of that
    """
    factors, rows = np.ascontiguousarray(factors, dtype=float), _held(rows)
    places, scales = rows.places()
    return shared().add_rows(len(factors), len(vector), places, scales, address(factors),
                             address(vector))


def rounded(vector, row, factor=1.0):
    """As `solvers.basis.rounded`.

    Parameters
    ----------
    vector, row, factor : as of that
    """
    shared().rounded(len(vector), address(vector), factor, address(row.numbers),
                     address(row.scales))


def _held(rows):
    """Rows of a list that may be none."""
    return rows if isinstance(rows, Rows) else Rows(rows)


def _rows(rows):
    """Addresses of rows, and those of their scales, or None."""
    if not (rows and isinstance(rows[0], Rounded)):
        return _places(rows), None
    return tuple(map(_places, zip(*rows)))


def _places(arrays):
    """Addresses of arrays, an array."""
    return np.array([address(array) for array in arrays], dtype=np.uintp)


def _data(places):
    """Where an array begins; None without one."""
    return None if places is None else places.ctypes.data
