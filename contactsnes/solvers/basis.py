"""Rows of vectors that a Krylov method keeps, in double or single precision, or rounded: products
with them, and vectors made orthogonal to them."""

import math

import numpy as np

from ..grid.rounded import LENGTH, Rounded

PIECE = 2 ** 13
"""Numbers of a row that are taken at a time, a multiple of `LENGTH`."""
SHORTEST = 32767.0
"""Largest of the short integers."""
SKEWED = {float: 1e-14, np.float32: 5e-9, np.int16: 5e-7}
"""Products with other rows, over the lengths, that rounding leaves of a row whose product with
these was no longer than itself: what it leaves of a row's numbers is in no direction that others
have (measured)."""
CANCELLED = 1e-3
"""Part of a vector below which what is left of it is made orthogonal once more in any case."""
SKEW = 1e-4
"""Estimate of the products of rows of unit length, which are to be orthogonal, that is allowed: a
hundred times more, and the residual that a cycle claims is not the true one any more."""
LEFT = 1e-13
"""Part of a vector below which nothing is left of it: the others span it."""


def wide(row, first=0, count=None):
    """Some numbers of a row in single precision, or `Rounded`, in double.

    Parameters
    ----------
    row : array of float32, or Rounded
    first, count : the first of them, at which a piece of a rounded row begins, and their number;
        None: all
    """
    if not isinstance(row, Rounded):
        return row[first:None if count is None else first + count].astype(float)
    last = len(row.numbers) if count is None else first + count
    return Rounded(row.numbers[first:last], row.scales[first // LENGTH:]).wide()


def inner_products(rows, vector, count=None):
    """Inner products of the first rows in single precision, or `Rounded`, and a vector, summed in
    double, and last that of the vector with itself.

    Parameters
    ----------
    rows : list of arrays of float32, or of Rounded
    vector : array of float
    count : int, how many of the rows; None: all
    """
    rows = rows[:count]
    found = np.zeros(len(rows) + 1)
    for first in range(0, len(vector), PIECE):
        part = vector[first:first + PIECE]
        found += [*(np.dot(wide(row, first, PIECE), part) for row in rows), np.dot(part, part)]
    return found


def add_rows(rows, factors, vector):
    """Add the first rows in single precision, or rounded, times factors, to a vector in place; its
    inner product with itself then.

    Parameters
    ----------
    rows : list of arrays of float32, or of Rounded
    factors : numbers, one for each of the first rows
    vector : array of float
    """
    square = 0.0
    for first in range(0, len(vector), PIECE):
        part = vector[first:first + PIECE]
        for row, factor in zip(rows, factors):
            part += factor * wide(row, first, PIECE)
        square += np.dot(part, part)
    return square


def rounded(vector, row, factor=1.0):
    """Round a vector times a positive number, in place, to what a `Rounded` row holds of it: short
    integers times a scale for each of its pieces.

    Parameters
    ----------
    vector : array of float
    row : Rounded, which is filled
    factor : float
    """
    starts = np.arange(0, len(vector), LENGTH)
    counts = np.minimum(len(vector) - starts, LENGTH)
    largest = np.maximum.reduceat(np.abs(vector), starts)
    row.scales[...] = largest * factor / SHORTEST
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.where(largest > 0.0, SHORTEST / largest, 0.0)
        parts = vector * np.repeat(inverse, counts)
        row.numbers[...] = (parts + np.copysign(0.5, parts)).astype(np.short)
    vector[...] = row.wide()


class Basis:
    """Rows of one precision, made when they are asked for.

    Parameters
    ----------
    kind : type of their numbers
    products : what computes: a module, or class, with ``inner_products`` and ``add_rows``, and the
        kind of list that it takes, ``Rows``
    grid : Grid, which sums over processes
    size : int, numbers of a row

    Attributes
    ----------
    kind : type of their numbers
    rows : list of them
    """

    def __init__(self, kind, products, grid, size):
        self.kind, self._products, self.rows = kind, products, products.Rows()
        self._grid, self._size = grid, size

    @property
    def single(self):
        """Whether rows are in single precision, or less."""
        return self.kind is not float

    def make(self, place):
        """Have a row of that number, the first that is free at most."""
        if place == len(self.rows):
            self.rows.append(self._new())

    def _new(self):
        """A row."""
        return np.empty(self._size, dtype=self.kind)

    def keep(self, place, vector, factor=1.0):
        """Take a vector times a positive number, in place, as a row.

        Parameters
        ----------
        place : int, the number of the row, the first that is free at most
        vector : array
        factor : float
        """
        self.make(place)
        if factor != 1.0:
            vector *= factor
        self.rows[place][...] = vector

    def inner(self, count, vector):
        """Inner products of the first rows and a vector, and its length."""
        *found, square = self._grid.together(self._products.inner_products(self.rows, vector,
                                                                           count))
        return np.array(found), math.sqrt(square)

    def add(self, factors, vector):
        """Add the first rows, times factors, to a vector in place; its length then."""
        return math.sqrt(self._grid.together(self._products.add_rows(self.rows, factors, vector)))


class Short(Basis):
    """Rows that are `Rounded`: what is taken of a vector, and left of it, is the rounded one, so
    that products with it are exact; parameters as of `Basis`."""

    def __init__(self, *given):
        super().__init__(*given)
        self.kind = np.int16

    def _new(self):
        """A row."""
        return Rounded.of(self._size)

    def keep(self, place, vector, factor=1.0):
        """Round a vector times a positive number, and take it as a row.

        Parameters
        ----------
        place, vector, factor : as of `Basis.keep`
        """
        self.make(place)
        self._products.rounded(vector, self.rows[place], factor)


class InDouble:
    """The products of rows in double precision."""

    Rows = list

    @staticmethod
    def inner_products(rows, vector, count=None):
        """As of the module.

        Parameters
        ----------
        rows, vector, count : as of that
        """
        return np.array([np.dot(row, vector) for row in [*rows[:count], vector]])

    @staticmethod
    def add_rows(rows, factors, vector):
        """As of the module.

        Parameters
        ----------
        rows, factors, vector : as of that
        """
        for row, factor in zip(rows, factors):
            vector += factor * row
        return np.dot(vector, vector)


class InSingle:
    """The products of rows in single precision, NumPy's."""

    Rows = list
    inner_products, add_rows = staticmethod(inner_products), staticmethod(add_rows)
    rounded = staticmethod(rounded)


class Orthogonality:
    """How far from orthogonal the rows of a cycle may be, and so when a vector is made orthogonal
    to them once more.

    What rounding leaves of products with earlier rows grows with each row by the length of its
    vector over what is left of that: no matter where the residual falls with it (Giraud, Langou,
    Rozloznik and van den Eshof, Numer. Math. 101, 87, 2005), but much where solves stagnate.

    Parameters
    ----------
    kind : type of the numbers of rows, as in `SKEWED`

    Attributes
    ----------
    bound : part of a vector below which what is left of it is made orthogonal once more
    """

    def __init__(self, kind):
        self._skew = SKEWED[kind]
        self.bound = CANCELLED

    def after(self, column):
        """Take note of the products of a vector with the rows, and last what is left."""
        before, left = math.sqrt(column @ column), column[-1]
        if self.bound * before < left:  # (not of nothing, 0 and 0)
            self._skew *= max(1.0, before / left)
            self.bound = max(CANCELLED, self._skew / SKEW)


def orthogonalised(space, count, vector, bound=CANCELLED):
    """Make a vector orthogonal to the first rows of a basis, in place; its products with them, and
    the norm of what is left: 0 for one that they span.

    Parameters
    ----------
    space : Basis
    count : int
    vector : array
    bound : float, as of `Orthogonality`
    """
    found, before = space.inner(count, vector)
    left = space.add(-found, vector)
    if left < bound * before:
        again, _ = space.inner(count, vector)
        left = space.add(-again, vector)
        found += again
    return np.append(found, left if left > LEFT * before else 0.0)
