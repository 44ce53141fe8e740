"""Modes of the projection of an operator on a space that grows, for each symmetry."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from ..continuation.bifurcations import NEUTRAL
from .sectors import Sectors, Together


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
        """J vector, kept."""
        image = self.operator.apply(vector)
        for sector, part, its in zip(self._sectors, self._by.parts(vector), self._by.parts(image)):
            sector.append(part, its, lengths(vector, self.grid))
        return image

    def modes(self):
        """Modes of J projected on the space, for each symmetry that occurs."""
        return [self._whole(number, projected(sector.basis, sector.images, self._certain,
                                              self.grid))
                for number, sector in enumerate(self._sectors) if sector.count]

    def _whole(self, number, found):
        """Modes of a symmetry whose vectors are whole."""
        return replace(found, vectors=self._by.whole(number, found.vectors),
                       defects=self._by.whole(number, found.defects))


class _Sector:
    """Orthonormal vectors of one symmetry and their images, rows of arrays that grow.

    Images are kept as such, not as sums of the products they come from: where vectors are nearly
    dependent, such sums cancel.
    """

    def __init__(self, size, grid=None):
        self._rows, self.count, self._grid = np.empty((2, 8, size)), 0, grid

    @property
    def basis(self):
        """The vectors, rows."""
        return self._rows[0, :self.count]

    @property
    def images(self):
        """Their images, rows."""
        return self._rows[1, :self.count]

    def append(self, vector, image, scale):
        """Append a vector, made orthonormal to the others, and its image; not what is hardly
        new."""
        norm, taken = lengths(vector, self._grid), np.zeros(self.count)
        # Twice is enough (Giraud et al. 2005, Numer. Math. 101, 87), once where much is left.
        for _ in range(2):
            before, parts = norm, together(self._grid, self.basis @ vector)
            vector, taken = vector - parts @ self.basis, taken + parts
            norm = lengths(vector, self._grid)
            if norm > 0.5 * before:
                break
        image = image - taken @ self.images
        if norm > 1e-6 * scale:
            if self.count == self._rows.shape[1]:
                self._rows = np.concatenate([self._rows, np.empty_like(self._rows)], axis=1)
            self._rows[:, self.count] = vector / norm, image / norm
            self.count += 1


def projected(basis, images, certain, grid=None):
    """`Modes` of the projection of J on orthonormal vectors.

    Parameters
    ----------
    basis : orthonormal vectors, rows
    images : J times these, rows
    certain : int, modes after the unstable ones that are to be accurate
    grid : Grid that sums over processes, where vectors are shared out among some
    """
    values, coefficients = scipy.linalg.eig(together(grid, basis @ images.T))
    kept = np.flatnonzero(values.imag >= 0.0)
    kept = kept[np.argsort(values[kept].real, kind="stable")]
    certain += np.sum(values[kept].real < 0.0)
    kept = kept[:certain + 1]
    vectors, moved = (_combined(coefficients[:, kept].T, rows) for rows in (basis, images))
    return Modes(values[kept], vectors, moved - values[kept, None] * vectors,
                 np.arange(len(kept)) < certain, grid)


def _combined(coefficients, rows):
    """Sums of real rows, which are not copied to complex ones where coefficients are complex."""
    if not np.iscomplexobj(coefficients):
        return coefficients @ rows
    found = np.empty((len(coefficients), rows.shape[1]), complex)
    found.real, found.imag = coefficients.real @ rows, coefficients.imag @ rows
    return found


def joined(parts):
    """Modes of all symmetries together, in the order of their real parts."""
    order = np.argsort(np.concatenate([part.values.real for part in parts]), kind="stable")
    return Modes(*(np.concatenate([getattr(part, name) for part in parts])[order]
                   for name in ("values", "vectors", "defects", "certain")), parts[0].grid)
