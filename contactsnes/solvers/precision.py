"""In which precision a linear solve multiplies and preconditions: in single where it is asked for
no more than that holds, and where that pays.

Residuals are doubles always, and what a solve leaves out the next one finds: a Newton iteration
with such solves is its own iterative refinement (Higham, Accuracy and Stability of Numerical
Algorithms, chapter 12).
"""

import math
import weakref

SAFE = 1e-5
"""Relative tolerance asked of a linear solve down to which its products are in single precision,
whose rounding is 6e-8: what is lost in them stays far below."""

ROUNDED = 2.5e-4
"""The same down to which its vectors are rounded to short integers times a scale, by 1.5e-5 of the
largest of a thousand numbers at most: mostly some 3e-5 of their norm, of which a part is left in
the residual."""

PATIENCE = 60
"""Iterations after which a solve goes on in double precision: a cycle of FGMRES, which then finds
its residual anew."""

LEAST = 2 ** 14
"""Points of the circle that a product transforms from which single precision pays (measured)."""


def is_large(form):
    """Whether single precision pays for the products of a form that has it."""
    return math.prod(form.convolution.transform.shape) >= LEAST


def pays(form, wanted):
    """Whether solves of a form may be in single precision by ``-contact_linear_precision``: on
    planes the library's transforms are so within its own products alone, which a law that is
    NumPy's has none of."""
    able = form.has_single and (form.kernel is not None or not form.contact.kernels.compiled
                                or len(form.grid.shape) == 1)
    return able and (wanted == "single" or (wanted == "auto" and is_large(form)))


def trusted(form, warm):
    """Whether a solve of a form is one whose way rounding does not decide: from near by, or on a
    fine grid of a body with one contact. From afar Newton's method is chaotic."""
    return warm or (form.has_single and form.contact.convex and is_large(form))


class Precision:
    """Chooses the precision of the solves of a SNES or KSP in Python's contexts; the library does
    the same (`choose` in petsc.c).

    Parameters
    ----------
    solver : SNES or KSP whose solves may be in single precision, or None

    Attributes
    ----------
    allowed : whether they may be so from now on
    turned : number of solves that went on in double precision
    """

    def __init__(self, solver=None):
        self._solver = solver and weakref.ref(solver)
        self.allowed = solver is not None
        self._single, self.turned = False, 0

    def _ksp(self):
        """The KSP of the solves, None where these are in double precision."""
        solver = self._solver() if self.allowed and self._solver else None
        return solver and getattr(solver, "getKSP", lambda: solver)()

    def begin(self):
        """Choose for a solve that begins; whether it is in single precision."""
        ksp = self._ksp()
        if ksp is None:
            return False
        relative, absolute = ksp.getTolerances()[:2]
        right = ksp.getRhs()
        self._single = bool(right) and (relative >= SAFE or absolute >= SAFE * right.norm())
        return self._single

    def now(self):
        """Whether what comes next in a solve is in single precision."""
        ksp = self._ksp()
        if ksp is None:
            return False
        count = ksp.getIterationNumber()
        if count == 0:
            return self.begin()
        if self._single and count >= PATIENCE:
            self._single = False
            self.turned += 1
        return self._single


DOUBLE = Precision()
"""That of solves which are to be exact."""
