"""What linear solves tell of unstable modes besides."""

import math
import weakref
from functools import lru_cache

import numpy as np

from .krylov import of_ksp

TELLING = 3
"""Iterations of a linear solve whose Ritz values tell of a mode that is unstable."""
STIRRED = 1e-5
"""Displacement, root mean square in ranges of the law, by which a solve of spots begins
elsewhere."""
PART, PARTS = 2 ** 14, 2 ** 12
"""Nodes that are looked at at a time, and how many times noise goes on before it is repeated."""


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
    if not (form.in_displacements and (plane or line)):
        return unknown
    fields, parts, squares = unknown[:form.count].reshape(form.shape), [], 0.0
    half, before = getattr(form, "half", form), form.grid.before(form.nodes)
    root = np.broadcast_to(form.root, form.nodes)
    for i, field in enumerate(fields):
        for part, noise in _noise(before + i * form.nodes, form.nodes):
            # modes lose their stability where the law softens: deep overlap is as stiff as the law
            # is steep
            counts = True if i else field[part] * root[part] + half.initial_gap[part] > 0.0
            some = noise * counts
            squares += some @ some
            parts.append((field[part], noise, counts))
    scale = STIRRED / max(math.sqrt(form.grid.together(squares)), 1e-300)
    for values, noise, counts in parts:
        added = noise * scale
        added *= counts
        values += added
    if half.window.even:
        half.window.odd(fields)  # the equations of what vanishes are empty: nothing is added there
    return unknown


@lru_cache(maxsize=1)
def _sown():
    """Random numbers, and where in them each part of noise begins: a generator takes ten times as
    long for a number as it takes to add one."""
    source = np.random.default_rng(0)
    return (source.random(2 * PART) - 0.5,
            [0, *source.integers(PART, size=PARTS - 1).tolist()])


def _noise(first, count):
    """Noise of consecutive nodes by their numbers, whichever process has them: (slice, array) of
    one part after the other.

    Parameters
    ----------
    first, count : number of the first node, and how many there are
    """
    numbers, begins = _sown()
    at = 0
    while at < count:
        part, within = divmod(first + at, PART)
        place, many = begins[part % PARTS] + within, min(PART - within, count - at)
        yield slice(at, at + many), numbers[place:place + many]
        at += many


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
    spots : `spots.SpotsPC`, whose systems tell of modes, too, or None
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
