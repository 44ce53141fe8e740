"""What linear solves tell of unstable modes besides."""

import weakref

import numpy as np

from .krylov import of_ksp
from .vectors import communicator

TELLING = 3
"""Iterations of a linear solve whose Ritz values tell of a mode that is unstable."""
STIRRED = 1e-5
"""Displacement, root mean square in ranges of the law, by which a solve of spots begins
elsewhere."""
PART = 2 ** 14
"""Nodes that are looked at at a time."""


def many(contact):
    """Whether a contact may have many spots: a plane whose gap is not convex."""
    return not contact.convex and len(contact.grid.shape) == 2


def stirred(form, unknown, certified):
    """An unknown, where there may be several spots with a little added, in place, of which every
    mode has a part: a Krylov space sees what its residual has a part of, and that of equal spots
    has none of a pattern, however unstable. On planes, of the normal component alone.

    Parameters
    ----------
    form : of the equations
    unknown : array of the form's size
    certified : bool, whether certificates find all modes: on a line they need no more, and the
        digits of their bifurcations suffer
    """
    plane = many(form.contact) and form.components == 1
    line = len(form.grid.shape) == 1 and not (certified or form.contact.convex)
    if form.in_displacements and (plane or line):
        noise = np.random.default_rng(communicator(form).rank).random(form.count)
        noise -= 0.5
        _keep_open(form, unknown, noise)
        _keep_odd(form, noise)
        noise *= STIRRED / max(form.grid.norm(noise), 1e-300)
        unknown[:form.count] += noise
    return unknown


def _keep_open(form, unknown, noise):
    """Set noise of the normal component to zero, in place, where surfaces overlap: modes lose their
    stability where the law softens, and deep overlap is as stiff as the law is steep.

    Parameters
    ----------
    form : of the equations
    unknown, noise : arrays of the form's size, and of its nodes and components
    """
    root, gap = np.broadcast_to(form.root, form.nodes), getattr(form, "half", form).initial_gap
    for first in range(0, form.nodes, PART):
        part = slice(first, min(first + PART, form.nodes))
        noise[part][unknown[part] * root[part] + gap[part] <= 0.0] = 0.0


def _keep_odd(form, noise):
    """Set noise of odd components to zero, in place, where they vanish: the equations there are
    empty, so that it could not be solved away."""
    window = getattr(form, "half", form).window
    if window.even:
        window.odd(noise.reshape(form.shape))


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

    Parameters
    ----------
    spots : `two_grids.SpotsPC`, whose systems tell of modes, too, or None
    """

    def __init__(self, spots=None):
        # (which holds the form, which holds this)
        self.found, self._spots = [], weakref.ref(spots) if spots else lambda: None

    def __call__(self, snes, iteration, norm):
        spots = self._spots()
        if iteration == 0:
            self.found = []
            if spots:
                spots.begin()
            return
        values = ritz_values(snes.getKSP())
        own = float(values.real.min()) if len(values) >= TELLING else np.nan
        within = spots.softest if spots else np.nan
        least = float(np.fmin(own, within))
        if not np.isnan(least):
            self.found.append(least)

    @property
    def smallest(self):
        """That number, nan where no solve told anything."""
        return min(self.found[-2:], default=np.nan)
