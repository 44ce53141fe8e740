"""Newton's steps on rough planes: given up early where they do not lead on, and taken in two
iterations where these are enough."""

from petsc4py import PETSc

from .capabilities import of_snes
from .convergence import NOT_A_NUMBER, measured, measured_apart
from .ritz import many

FIRST, LATER = 0.7, 0.5
"""Part of the first residual norm below which the next one has to be, and all later ones. Warm
steps on smooth parts of a branch reduce it tenfold with each iteration; those beyond a fold wander
about."""
WANDERING = 3
"""Iteration from which on the norm has to be the least so far."""
DIVERGED = 1e4
"""PETSc's own bound of the norm over the first one."""
FURTHEST = 0.015
"""Least part of the first residual norm that a solve's first linear system leaves."""


def first_forcing(part, *, rtol_0, gamma, alpha, **others):
    """Part of the residual norm that a solve's first linear system leaves.

    Parameters
    ----------
    part : float, what two iterations are to leave: eta gamma eta^alpha of the first one's eta
    rtol_0 : float, where that eta is no less, or less than `FURTHEST`
    gamma, alpha : floats, of the second one's forcing term gamma eta^alpha
    others : of `SNES.getParamsEW`
    """
    found = (part / gamma) ** (1.0 / (1.0 + alpha))
    return found if FURTHEST <= found < rtol_0 else rtol_0


class Patience:
    """Convergence test of a SNES that gives up early while ``short``: else PETSc's own.

    A rough plane has a fold for each of its spots. What is solved beyond one costs ten times a step
    of the branch until it fails, or ends where nothing but chance led it.

    Its linear systems follow Newton's progress (Eisenstat and Walker, SIAM J. Sci. Comput. 17, 16,
    1996, their choice 2), and the first one, of which nothing is known, is solved as far as the
    others need for two iterations in all, unless -snes_ksp_ew_rtol0 is given: a tenth of the
    transforms of a step that would take three.
    """

    def __init__(self):
        self.short, self._first, self._least = False, 0.0, 0.0

    def watch(self, snes, contact):
        """Be the test of a SNES that has a tangent, where spots are many."""
        if not (many(contact) and of_snes(snes).has_tangent):
            return
        given = PETSc.Options(snes.getOptionsPrefix() or "").hasName("snes_ksp_ew_rtol0")
        forcing = snes.getParamsEW() if snes.getUseEW() and not given else {}
        form = snes.appctx
        snes.setConvergenceTest(self.test, (form if measured_apart(snes, form) else None,
                                            forcing if forcing.get("version") == 2 else None))

    def test(self, snes, iteration, norms, form=None, forcing=None):
        """The reason to stop, or to go on.

        Parameters
        ----------
        snes : SNES
        iteration : int
        norms : (of the unknown, of the step, of the residual)
        form : of the equations, where PETSc's own vector F has another norm than ``residual_norm``
        forcing : parameters of Eisenstat and Walker whose first one is ours to choose, or None
        """
        reasons, (size, step, norm) = PETSc.SNES.ConvergedReason, norms
        norm = norm if form is None else measured(snes, form)
        rtol, atol, stol, _ = snes.getTolerances()
        if not norm < float("inf"):
            return NOT_A_NUMBER
        self._first, least = (norm, norm) if iteration == 0 else (self._first, self._least)
        self._least = min(norm, least)
        if norm <= atol:
            return reasons.CONVERGED_FNORM_ABS
        if iteration == 0:
            if forcing:
                snes.setParamsEW(rtol_0=first_forcing(atol / norm, **forcing))
            return reasons.ITERATING
        if norm <= rtol * self._first:
            return reasons.CONVERGED_FNORM_RELATIVE
        if step < stol * size:
            return reasons.CONVERGED_SNORM_RELATIVE
        lost = self.short and (norm > (FIRST if iteration == 1 else LATER) * self._first
                               or (iteration >= WANDERING and norm > least))
        return reasons.DIVERGED_DTOL if lost or norm > DIVERGED * self._first else reasons.ITERATING
