"""Linearised overdamped motion in the library, and runs of Arnoldi's method that look for its
modes."""

import ctypes

import numpy as np

from . import structures
from .forms import call
from .library import shared
from .structures import address


def hold(held, count, pair, least):
    """As `dynamics.holding.holding`.

    Parameters
    ----------
    held, count, pair, least : as of that
    """
    (basis, images), products, errors = held
    return bool(shared().hold(count, basis.shape[-1], len(products), address(basis),
                              address(images), address(products), address(errors),
                              address(pair[0]), address(pair[1]), least))


def ritz(coefficients, values, basis, images):
    """Modes of a projection, and what J leaves of them: real rows.

    Parameters
    ----------
    coefficients : array (modes, count)
    values : array (modes,), their eigenvalues
    basis, images : arrays (count, size), vectors and J times these
    """
    (modes, count), size = coefficients.shape, basis.shape[1]
    coefficients, values = np.ascontiguousarray(coefficients), np.ascontiguousarray(values)
    vectors, defects = np.empty((2, modes, size))
    shared().ritz(count, size, address(basis), address(images), modes, address(coefficients),
                  address(values), address(vectors), address(defects))
    return vectors, defects


class CompiledMotion:
    """J of overdamped motion from a compiled form and its preconditioner.

    Parameters
    ----------
    zone : CompiledZone of the form
    row : array, what the form's rows are over the rates of the means that can move
    push : array, uniform displacements over these rates, in ranges of the law
    """

    def __init__(self, zone, row, push):
        self.zone, self.kernel, self.library = zone, zone.kernel, zone.library
        own = self.structure = structures.Overdamped()
        own.form, own.zone = ctypes.pointer(zone.kernel.structure), ctypes.pointer(zone.structure)
        own.row[:len(row)], own.push[:len(push)] = row, push
        self.reference = ctypes.addressof(own)

    def _call(self, function, *arguments):
        """Call a function of the library, in double precision."""
        self.kernel.set_precision(False)
        call(function, self.kernel.grid.counter, self.reference, *arguments)

    def apply(self, vector):
        """J vector."""
        out = np.empty(self.kernel.size)
        self._call(self.library.overdamped_product, address(vector), address(out))
        return out

    def precondition(self, vector):
        """About J^-1 vector."""
        vector, out = vector.copy(), np.empty(self.kernel.size)
        self._call(self.library.overdamped_precondition, address(vector), address(out))
        return out

    def run(self, shift, begin, count, held, number, astray):
        """A run of products on 1 - P^-1 (J - shift); the number of vectors held then.

        Parameters
        ----------
        shift : float
        begin : array, overwritten
        count : int, of products
        held : what vectors are appended to, as of `holding.holding`, with room for all of them
        number : int, of vectors that are held
        astray : error of an image from which on it is made anew
        """
        (basis, images), products, errors = held
        counted = ctypes.c_long(number)
        self._call(self.library.arnoldi, shift, address(begin), count, ctypes.addressof(counted),
                   len(products), address(basis), address(images), address(products),
                   address(errors), astray)
        return counted.value
