"""When a solve has converged: tests of the residual norm, and what PETSc is told of it."""

import numpy as np
from petsc4py import PETSc

NOT_A_NUMBER = getattr(PETSc.SNES.ConvergedReason, "DIVERGED_FNORM_NAN", None) \
    or PETSc.SNES.ConvergedReason.DIVERGED_FUNCTION_NANORINF
"""Reason to stop at a norm that is no number, by its older or its newer name."""


def reached(snes, iteration, norm, first):
    """The reason to stop at a residual norm that is no number, or small enough, by itself or beside
    the first one; 0 at others.

    Parameters
    ----------
    snes : SNES, whose tolerances hold
    iteration : int
    norm, first : float
    """
    reasons, (rtol, atol, _, _) = PETSc.SNES.ConvergedReason, snes.getTolerances()
    if not np.isfinite(norm):
        return NOT_A_NUMBER
    if norm <= atol:
        return reasons.CONVERGED_FNORM_ABS
    if iteration and norm <= rtol * first:
        return reasons.CONVERGED_FNORM_RELATIVE
    return reasons.ITERATING


def reported(snes, iteration, norm, linear_iterations=0):
    """Tell PETSc of an iteration of a SNES type of our own, its monitors included; the reason to
    stop by its convergence test, or 0.

    Parameters
    ----------
    snes : SNES
    iteration : int
    norm : float, of the residual
    linear_iterations : int, of the last solve
    """
    norm = norm if norm < np.inf else np.inf  # PETSc takes no norm that is not a number
    snes.its, snes.norm = iteration, norm
    snes.logConvergenceHistory(norm, linear_iterations)
    snes.monitor(iteration, norm)
    return snes.callConvergenceTest(iteration, 0.0, 0.0, norm)


def _preconditioned(snes):
    """Whether PETSc's vector F is what a nonlinear preconditioner on the left leads to: a step."""
    return snes.hasNPC() and snes.getNPCSide() == PETSc.PC.Side.LEFT


def measured_apart(snes, form):
    """Whether the norm of PETSc's own vector F is not ``residual_norm``: in the force form F is an
    imbalance of forces, with a nonlinear preconditioner on the left a step."""
    return not form.in_displacements or _preconditioned(snes)


def measured(snes, form):
    """``residual_norm`` where a SNES stands whose own vector F has another; the form keeps it as
    ``last_norm``."""
    unknown = snes.getSolution().getArray(readonly=True)
    imbalance = (form.residual(unknown, np.empty(form.size)) if _preconditioned(snes)
                 else snes.getFunction()[0].getArray(readonly=True))
    form.last_norm = (form.grid.norm(imbalance) if form.in_displacements
                      else form.displacement_norm(unknown, imbalance))
    return form.last_norm


def norm_at_end(snes, form):
    """``residual_norm`` where a SNES ended, as far as its own test knows it.

    Its test measures a norm that is not that of F; `Corrector.run` forgets what it measured before.
    """
    measured_last = form.last_norm if measured_apart(snes, form) else None
    return snes.getFunctionNorm() if measured_last is None else measured_last


def displacement_test(snes, iteration, norms, form):
    """The convergence test by ``residual_norm``, where the norm of PETSc's own vector F is another.

    Parameters
    ----------
    snes : SNES
    iteration, norms : as PETSc gives them
    form : of the equations
    """
    norm = measured(snes, form)
    if iteration == 0:
        form.first_norm = norm
    return reached(snes, iteration, norm, form.first_norm)
