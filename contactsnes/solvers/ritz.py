"""What linear solves tell of unstable modes besides."""

import numpy as np

from .krylov import of_ksp

TELLING = 3
"""Iterations of a linear solve whose Ritz values tell of a mode that is unstable."""


def ritz_values(ksp):
    """Ritz values of the last solve of a KSP."""
    own = of_ksp(ksp)
    return own.ritz_values() if own else ksp.computeEigenvalues()


class Ritz:
    """Monitor of a Newton iteration: keeps the smallest real part of the Ritz values of its last
    two linear solves that tell.

    Those are about the eigenvalues of J M^-1, M the preconditioner. It is positive, as for a body
    that rests, so that a negative one belongs to an unstable mode of J (Sylvester's law of inertia,
    where J is symmetric). They cost no product.
    """

    def __init__(self):
        self.found = []

    def __call__(self, snes, iteration, norm):
        if iteration == 0:
            self.found = []
            return
        values = ritz_values(snes.getKSP())
        if len(values) >= TELLING:
            self.found.append(float(values.real.min()))

    @property
    def smallest(self):
        """That number, nan where no solve told anything."""
        return min(self.found[-2:], default=np.nan)
