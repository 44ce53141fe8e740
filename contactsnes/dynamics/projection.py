"""Modes of the projection of an operator on a space that grows, for each symmetry."""

from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy

from ..continuation.bifurcations import NEUTRAL
from .sectors import Sectors, Together

MOST = 16
"""Vectors of a symmetry that there is room for at first."""


def together(grid, parts):
    """Sums of parts in all processes; without a grid there is one."""
    return parts if grid is None else grid.together(parts)


def lengths(rows, grid=None):
    """Euclidean length of vectors (..., size), parts of which may be in other processes of a
    grid."""
    if grid is None:
        return np.linalg.norm(rows, axis=-1)
    return np.sqrt(grid.together(np.sum(np.square(np.abs(rows)), axis=-1)))


@dataclass(frozen=True)
class Modes:
    """Eigenvalues by their real parts (a complex pair once, with positive imaginary part), modes x
    of length 1 and J x - s x as rows.

    The unstable ones and, of each symmetry, the next ``certain`` (two where there is none: the
    edges of contact have one each), all of which are to be accurate, and a further one that only
    tells where to look. ``grid`` is that of the nodes where some are in other processes.
    """

    values: np.ndarray
    vectors: np.ndarray
    defects: np.ndarray
    certain: np.ndarray
    grid: object = None

    @property
    def residuals(self):
        """|J x - s x| of each."""
        return lengths(self.defects, self.grid)

    @property
    def unstable(self):
        """Number of eigenvalues with negative real part, both of a complex pair counted."""
        return int(np.sum(self.real_parts() < -NEUTRAL))

    def real_parts(self):
        """Real parts in order, both of a complex pair."""
        return np.repeat(self.values.real, np.where(self.values.imag > 0.0, 2, 1))

    @property
    def leading(self):
        """The eigenvalue of smallest real part."""
        return complex(self.values[0])


class Space:
    """Vectors with their products with J, split by symmetry, and what the projection of J on them
    has for modes.

    Parameters
    ----------
    operator : with ``size``, ``apply`` and ``mirror`` and, where vectors are shared out among
        processes, the grid that sums over them, ``shared``
    axes : symmetries, second arguments of ``mirror``, under which J does not change
    """

    def __init__(self, operator, axes=()):
        self.operator, self.grid = operator, getattr(operator, "shared", None)
        self._by = Sectors(operator, axes) if axes else Together(operator.size)
        # the edges of contact have one each where no symmetry tells them apart
        self._certain = 1 if axes else 2
        self._sectors = [_Sector(self._by.length, self.grid) for _ in range(self._by.count)]

    def begin(self, vectors):
        """Hold these vectors, and no others: rounding of what is hardly new grows from each to the
        next."""
        for sector in self._sectors:
            sector.count = 0
        for vector in vectors:
            self.product(vector)

    @property
    def largest(self):
        """Most vectors of a symmetry."""
        return max(sector.count for sector in self._sectors)

    def product(self, vector):
        """Hold a vector and its product with J; whether a part of it was new."""
        image = self.operator.apply(vector)
        scale = lengths(vector, self.grid)
        grown = [sector.append(part, its, scale) for sector, part, its in
                 zip(self._sectors, self._by.parts(vector), self._by.parts(image))]
        self._grown = [number for number, new in enumerate(grown) if new]
        return bool(self._grown)

    def newest(self):
        """Sums, over symmetries, of the vectors that came last, of length 1 in each, and of their
        images."""
        return [sum(self._by.whole(number, self._sectors[number].rows[of, -1])
                    for number in self._grown) for of in (0, 1)]

    def ritz(self):
        """`Ritz` of the projection of J on the space, for each symmetry that occurs."""
        return [ritz(sector.products[0], sector.products[1], self._certain, number)
                for number, sector in enumerate(self._sectors) if sector.count]

    def modes(self):
        """Modes of J projected on the space, for each symmetry that occurs."""
        return [self._whole(found) for found in self.ritz()]

    def _whole(self, found):
        """Modes of a symmetry whose vectors are whole."""
        vectors, moved = self._sectors[found.symmetry].combined(found.coefficients)
        whole = partial(self._by.whole, found.symmetry)
        return Modes(found.values, whole(vectors),
                     whole(moved - found.values[:, None] * vectors), found.certain, self.grid)

    def defects(self, found, loose):
        """The sum of J x - s x over some modes of a `Ritz`, of which each, or its real and
        imaginary part, has length 1."""
        sector = self._sectors[found.symmetry]
        vectors, moved = sector.combined(found.coefficients[loose])
        rows = real(moved - found.values[loose, None] * vectors, self.grid)
        return self._by.whole(found.symmetry, sum(row / lengths(row, self.grid) for row in rows))


class _Sector:
    """Orthonormal vectors of one symmetry and their images, rows of arrays that grow, and the
    products of these.

    Images are kept as such, not as sums of the products they come from: where vectors are nearly
    dependent, such sums cancel.
    """

    def __init__(self, size, grid=None):
        self._rows, self.count, self._grid = np.empty((2, MOST, size)), 0, grid
        self._products = np.empty((2, MOST, MOST))

    @property
    def rows(self):
        """The vectors and their images, array (2, count, size)."""
        return self._rows[:, :self.count]

    @property
    def products(self):
        """Products of vectors, and of images, with images, array (2, count, count)."""
        return self._products[:, :self.count, :self.count]

    def append(self, vector, image, scale):
        """Append a vector, made orthonormal to the others, and its image, but not what is hardly
        new; whether it was."""
        norm, (basis, images) = lengths(vector, self._grid), self.rows
        taken = np.zeros(self.count)
        # Twice is enough (Giraud et al. 2005, Numer. Math. 101, 87), once where much is left.
        for _ in range(2):
            before, parts = norm, together(self._grid, basis @ vector)
            vector, taken = vector - parts @ basis, taken + parts
            norm = lengths(vector, self._grid)
            if norm > 0.5 * before:
                break
        if not norm > 1e-6 * scale:
            return False
        if self.count == self._rows.shape[1]:
            self._grow()
        place = self.count
        np.divide(vector, norm, out=self._rows[0, place])
        np.subtract(image, taken @ images, out=self._rows[1, place])
        self._rows[1, place] /= norm
        self.count += 1
        self._multiply(place)
        return True

    def _multiply(self, place):
        """Products of the vector and the image that came last."""
        (basis, images), image = self.rows, self._rows[1, place]
        rows = np.array([basis @ image, images @ self._rows[0, place], images @ image])
        first, last, both = together(self._grid, rows)
        products = self.products
        products[0, :, place], products[0, place] = first, last
        products[1, :, place], products[1, place] = both, both

    def _grow(self):
        """Have room for more vectors."""
        self._rows = np.concatenate([self._rows, np.empty_like(self._rows)], axis=1)
        products = np.empty((2, *2 * (2 * self.count,)))
        products[:, :self.count, :self.count] = self._products
        self._products = products

    def combined(self, coefficients):
        """Sums of the vectors, and of the images, rows."""
        return [_combined(coefficients, rows) for rows in self.rows]


@dataclass(frozen=True)
class Ritz:
    """Modes of a projection on orthonormal vectors: eigenvalues, coefficients of the vectors as
    rows, and |J x - s x| up to rounding, which stands for less than 1e-7 of |J x|; ``certain`` as
    of `Modes`, and the number of their symmetry."""

    values: np.ndarray
    coefficients: np.ndarray
    residuals: np.ndarray
    certain: np.ndarray
    symmetry: int


def ritz(projection, squares, certain, symmetry=0):
    """`Ritz` of a projection.

    Parameters
    ----------
    projection : array, products of orthonormal vectors with their images under J
    squares : array, products of the images
    certain : int, modes after the unstable ones that are to be accurate
    symmetry : int
    """
    values, coefficients = scipy.linalg.eig(projection, check_finite=False)
    kept = np.flatnonzero(values.imag >= 0.0)
    kept = kept[np.argsort(values[kept].real, kind="stable")]
    certain += np.sum(values[kept].real < 0.0)
    kept = kept[:certain + 1]
    values, coefficients = values[kept], coefficients[:, kept].T
    moved = np.einsum("ki,ij,kj->k", coefficients.conj(), squares, coefficients).real
    return Ritz(values, coefficients, np.sqrt(np.maximum(moved - np.abs(values) ** 2, 0.0)),
                np.arange(len(kept)) < certain, symmetry)


def projected(images, certain):
    """`Modes` of a matrix whose columns are the rows ``images``; certain as of `ritz`."""
    found = ritz(images.T, images @ images.T, certain)
    moved = _combined(found.coefficients, images)
    return Modes(found.values, found.coefficients,
                 moved - found.values[:, None] * found.coefficients, found.certain)


def _combined(coefficients, rows):
    """Sums of real rows, which are not copied to complex ones where coefficients are complex."""
    if not np.iscomplexobj(coefficients):
        return coefficients @ rows
    found = np.empty((len(coefficients), rows.shape[1]), complex)
    found.real, found.imag = coefficients.real @ rows, coefficients.imag @ rows
    return found


def real(vectors, grid=None):
    """Real and imaginary parts of vectors, a list without what vanishes."""
    parts = [part for vector in vectors for part in (vector.real, vector.imag)]
    return [part for part in parts if (part.any() if grid is None else grid.any(part))]


def joined(parts):
    """Modes of all symmetries together, in the order of their real parts."""
    order = np.argsort(np.concatenate([part.values.real for part in parts]), kind="stable")
    return Modes(*(np.concatenate([getattr(part, name) for part in parts])[order]
                   for name in ("values", "vectors", "defects", "certain")), parts[0].grid)
