"""Krylov vectors in single precision, or rounded, in the library."""

import numpy as np

from ..grid.rounded import Rounded
from .forms import call
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


def steps_alone(kernel):
    """Whether iterations of a linear solve of a form can be the library's (`Iterations`).

    Parameters
    ----------
    kernel : CompiledForm
    """
    response = kernel.structure.response.contents
    return response.boxes == 1 and not response.on_circle


class Iterations:
    """Iterations of a cycle of GMRES whose vectors are in single precision throughout, each one
    call of the library, by a form's operator and its preconditioner.

    Both vectors that they work in are halves of one in double precision.

    Parameters
    ----------
    kernel : CompiledForm that `steps_alone`
    zone : with the ``reference`` of its preconditioner in the library
    choose : function that has both in the precision that the solve is in now
    begin : array, what the cycle begins with
    room : array to work in, which may be that, and which `end` fills
    space : Basis in single precision, or `Short`
    made : Basis of what the preconditioner made of its rows, or None
    patches : OnTwoGrids that are the preconditioner as it is now, of which ``made`` holds what
        stood for patches, or None
    orthogonality : `solvers.basis.Orthogonality`
    left : float, part of a vector that counts as none
    applied : what is called when the preconditioner was applied, or None
    """

    def __init__(self, kernel, zone, choose, begin, room, space, made, patches, orthogonality,
                 left, applied=None):
        self._kernel, self._zone, self._counter = kernel, zone, kernel.grid.counter
        self._choose, self._applied = choose, applied
        self._vectors, self._bases = (room.view(np.float32)[len(room):], room), (space, made)
        self._patches, self._stood = patches, 0
        self._orthogonality, self._left = orthogonality, left
        shared().narrowed(len(begin), address(begin), address(self._vectors[0]))

    def __call__(self, place, factor):
        """Take the vector times a factor as row number ``place``, and go on with what the rows
        leave of the product; its products with them, and last its length."""
        (space, made), (vector, work) = self._bases, self._vectors
        space.make(place)
        out, kept = work, (None, None)
        patches = self._patches if self._zone.patches is self._patches else None
        if made and not self._patches:
            made.make(place)
            row = made.rows[place]
            if isinstance(row, Rounded):
                kept = address(row.numbers), address(row.scales)
            else:
                out = row
        room = np.empty((2, place + 2))
        self._choose()
        call(shared().iterate, self._counter, self._kernel.reference, self._zone.reference, place,
             len(vector), *space.rows.places(), factor, address(vector), address(out), *kept,
             self._orthogonality.bound, self._left, address(room[0]), address(room[1]))
        self._orthogonality.after(room[0])
        if patches:
            made.keep(place, patches.stands)
            self._stood += 1
        if self._applied:
            self._applied()
        return room[0]

    def end(self, factors):
        """Fill the room, in double precision, with what is added to the solution.

        Parameters
        ----------
        factors : array, the part of each row
        """
        (space, made), (vector, work), stood = self._bases, self._vectors, self._stood
        asks, rows = made is None or self._patches is not None, (made or space).rows.places()
        if self._patches:
            rows, work[...] = space.rows.places(), 0.0
        if stood < len(factors):
            # (another preconditioner may have taken over)
            self._choose()
            later, rest = factors[stood:], [first and first + 8 * stood for first in rows]
            call(shared().sum_up, self._counter, self._zone.reference, len(later), len(vector),
                 *rest, address(later), asks, address(vector), address(work))
        if stood:
            self._patches.add(rows, factors[:stood], made.rows, work)


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
