"""Modes of the projection of an operator on a space that grows, for each symmetry."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..continuation.bifurcations import NEUTRAL
from ..kernels.modes import ritz
from .holding import holding, in_step, lengths, multiplying, together
from .undivided import Undivided

NEW = 1e-6
"""Length of what is left of a vector of length 1 that is new."""
ASTRAY = 1e-8
"""Error of an image, as rounding has grown from each vector that is hardly new to the next, from
which on it is made anew: below what modes are accurate to."""
ROOM = 27
"""Vectors that there is room for from the beginning, those of a first point: two runs, and motions
of the surface as a whole. Memory that is not used costs nothing."""


@dataclass(frozen=True)
class Modes:
    """Eigenvalues by their real parts (a complex pair once, with positive imaginary part), modes x
    of length 1 and J x - s x as rows.

    The unstable ones and, of each symmetry, the next ``certain`` (two where there is none: the
    edges of contact have one each), all of which are to be accurate, and a further one that only
    tells where to look, unless by its residual it may be softer than the first. ``grid`` is that of
    the nodes where some are in other processes.
    """

    values: np.ndarray
    vectors: np.ndarray
    defects: np.ndarray
    certain: np.ndarray
    grid: object = None

    @cached_property
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

    def told(self, number):
        """An eigenvalue with what of its imaginary part is more than its residual: two that are
        about one look like a pair."""
        value = complex(self.values[number])
        return value if abs(value.imag) > self.residuals[number] else complex(value.real)


class Space:
    """Vectors with their products with J, split by symmetry, and what the projection of J on them
    has for modes.

    Parameters
    ----------
    operator : with ``size``, ``apply`` and, where its vectors consist of parts that differ in
        symmetry, ``lengths``, ``parts`` and ``whole`` (as `undivided.Undivided`); where vectors are
        shared out among processes, the grid that sums over them, ``shared``
    number : of the last mode that is asked for, 0 for the leading one
    """

    def __init__(self, operator, number=0):
        self.operator, self.grid = operator, getattr(operator, "shared", None)
        self.by = operator if hasattr(operator, "parts") else Undivided(operator.size)
        # the edges of contact have one each where no symmetry tells them apart
        self._certain, self._number = 2 if len(self.by.lengths) == 1 else 1, number
        self._kernels = getattr(operator, "kernels", None)
        self._sectors = [_Sector(length, self.grid, bool(self._kernels))
                         for length in self.by.lengths]

    def begin(self, vectors):
        """Hold these vectors, and no others: rounding of what is hardly new grows from each to the
        next."""
        for sector in self._sectors:
            sector.clear()
        for vector in vectors:
            self.run(0.0, vector, 1)

    @property
    def largest(self):
        """Most vectors of a symmetry."""
        return max(sector.count for sector in self._sectors)

    def run(self, shift, begin, count):
        """Hold the vectors of a run of Arnoldi's method on 1 - P^-1 (J - shift).

        Parameters
        ----------
        shift : float
        begin : vector, overwritten
        count : int, products
        """
        if self._kernels:
            size = lengths(begin)
            for sector, part, kernel in zip(self._sectors, self.by.parts(begin), self._kernels):
                if lengths(part) > NEW * size:
                    sector.run(kernel, shift, part, count)
            return
        basis, vector = np.empty((count, len(begin))), begin
        for place in range(count):
            known = basis[:place]
            for _ in range(2 if place else 0):
                vector = vector - together(self.grid, known @ vector) @ known
            length = lengths(vector, self.grid)
            if length == 0.0:
                return
            own = np.divide(vector, length, out=basis[place])
            image = self.product(own)
            if place + 1 < count:
                vector = own - self.operator.precondition(image - shift * own)

    def product(self, vector):
        """J vector, of a vector of length 1, kept."""
        image = self.operator.apply(vector)
        parts = zip(self._sectors, self.by.parts(vector), self.by.parts(image))
        new = in_step([sector.appending(*pair) for sector, *pair in parts], self.grid)
        for number, (sector, is_new) in enumerate(zip(self._sectors, new)):
            sector.count += is_new
            if is_new and sector.astray:
                again = self.operator.apply(self.by.whole(number, sector.newest))
                in_step([sector.renewing(self.by.parts(again)[number])], self.grid)
        return image

    def only(self, among, vector):
        """What a vector has of some symmetries, by their numbers."""
        if len(among) == len(self._sectors):
            return vector
        parts = self.by.parts(vector)
        return sum(self.by.whole(number, parts[number]) for number in among)

    def found(self):
        """{number of a symmetry that occurs: modes of J projected on its vectors, as parts}."""
        return {number: sector.modes(self._certain, self._number)
                for number, sector in enumerate(self._sectors) if sector.count}

    def modes(self):
        """Modes of J projected on the space, for each symmetry that occurs."""
        return [self.whole(number, found) for number, found in self.found().items()]

    def whole(self, number, found):
        """Modes of a symmetry whose vectors are whole."""
        return replace(found, vectors=self.by.whole(number, found.vectors),
                       defects=self.by.whole(number, found.defects))


class _Sector:
    """Orthonormal vectors of one symmetry and their images, rows of an array that grows, and the
    products of the first with the second.

    Parameters
    ----------
    size : int, of vectors
    grid : as of `hold`
    compiled : bool, whether the library sums vectors
    """

    def __init__(self, size, grid=None, compiled=False):
        self._rows, self._products = np.empty((2, ROOM, size)), np.empty((ROOM, ROOM))
        self._errors = np.empty(ROOM)
        self._grid, self._compiled = grid, compiled
        self.clear()

    def clear(self):
        """Hold no vectors."""
        self.count, self._known = 0, None

    def _make_room(self, more):
        """Have room for more vectors."""
        room = len(self._products)
        while self.count + more > room:
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)], axis=1)
            self._products = np.pad(self._products, (0, room))
            self._errors = np.pad(self._errors, (0, room))
            room *= 2

    @property
    def _held(self):
        """What `holding.holding` appends to."""
        return self._rows, self._products, self._errors

    @property
    def newest(self):
        """The last vector."""
        return self._rows[0, self.count - 1]

    @property
    def astray(self):
        """Whether rounding may have grown in the image of the last vector."""
        return self._errors[self.count - 1] > ASTRAY

    def renewing(self, image):
        """Take an image that was made anew for that of the last vector. A generator, as of
        `holding.in_step`."""
        self._rows[1, self.count - 1], self._errors[self.count - 1] = image, np.finfo(float).eps
        return multiplying(self._held, self.count)

    def appending(self, vector, image):
        """Append a vector, if more than ``NEW`` of it is, with its image, as `holding.holding`."""
        self._make_room(1)
        return holding(self._held, self.count, (vector, image), NEW)

    def run(self, kernel, shift, begin, count):
        """Append the vectors of a run in the library.

        Parameters
        ----------
        kernel : kernels.modes.CompiledMotion
        shift, begin, count : as of `Space.run`
        """
        self._make_room(count)
        self.count = kernel.run(shift, begin, count, self._held, self.count, ASTRAY)

    def modes(self, certain, number):
        """`Modes` of the projection, as of `projected`; the same again as long as no vector is
        new."""
        if self._known is None or self._known[0] != self.count:
            held = slice(0, self.count)
            self._known = self.count, projected(
                *self._rows[:, held], self._products[held, held], certain, number,
                self._grid, self._compiled)
        return self._known[1]


def projected(basis, images, products, certain, number=0, grid=None, compiled=False):
    """`Modes` of the projection of J on orthonormal vectors.

    Parameters
    ----------
    basis : orthonormal vectors, rows
    images : J times these, rows
    products : array, products of the first with the second
    certain : int, modes after the unstable ones that are to be accurate
    number : of the last mode that is asked for: all up to that may be of this symmetry
    grid : Grid that sums over processes, where vectors are shared out among some
    compiled : bool, whether the library sums real vectors
    """
    values, coefficients = np.linalg.eig(products)
    kept = np.argsort(values.real, kind="stable")
    if np.iscomplexobj(values):
        kept = kept[values[kept].imag >= 0.0]
    values = values[kept]
    certain += np.count_nonzero(values.real < 0.0)
    told = max(certain, number) + 1
    values, coefficients = values[:told], coefficients[:, kept[:told]].T
    if np.iscomplexobj(values) and not values.imag.any():
        # others are complex
        values, coefficients = values.real, coefficients.real
    if compiled and not np.iscomplexobj(coefficients):
        vectors, defects = ritz(coefficients, values, basis, images)
    else:
        vectors, moved = (_combined(coefficients, rows) for rows in (basis, images))
        defects = moved - values[:, None] * vectors
    found = Modes(values, vectors, defects, np.arange(len(values)) < certain, grid)
    found.certain[:] |= values.real - found.residuals < values[0].real
    return found


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
