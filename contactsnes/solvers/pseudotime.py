"""Pseudo-transient continuation as a SNES type: implicit Euler steps of a flow that ends at the
equilibrium, made ever longer.

The flow of the displacement form is v' = -(v + C t(a + v) - vbar): down the energy in the metric of
the body's stiffness, every wave at the rate 1 where the law does not act. Prescribed forces are
approached at that rate, too. A step of length h solves (1/h + 1 + C D) dv = -F. Divided by s = 1 +
1/h that is Newton's system with the tangent D/s: operator and preconditioner serve as they are.
"""

from dataclasses import dataclass
from typing import ClassVar

from petsc4py import PETSc

from ..contact.forms import DisplacementForm
from ..options.database import read
from ..options.fields import InputError, Options, as_text, option
from . import callbacks
from .capabilities import Capabilities
from .convergence import reported
from .operators import form_of
from .regularised import NewtonOptions, RegularisedStep

SHORTEST = 1e-6
"""Time step below which a solve has failed; where the law does not act the flow has the rate 1
(dimensionless)."""
TINY = 1e-300


@dataclass(frozen=True)
class PseudoOptions(Options):
    """Options of pseudo-transient continuation."""

    prefix: ClassVar[str] = "snes_pseudo_"
    title: ClassVar[str] = "Pseudo-transient continuation"
    first_change: float = option(3.0, "how far the first step would lead at the "
                                 "rate that it begins with, root mean square",
                                 "ranges of the law", above=0)
    exponent: float = option(1.5, "the time step grows as the residual's norm "
                             "falls, by its inverse to this power", above=0)
    growth: float = option(10.0, "largest factor of the time step from one step to the next",
                           minimum=1)
    uphill: float = option(10.0, "factor of the residual's norm beyond which a "
                           "step is taken again, a quarter as long", above=1)


class PseudoTransient:
    """``-snes_type python -snes_python_type contactsnes.solvers.pseudotime.PseudoTransient``, for
    the displacement form.

    Switched evolution relaxation (Mulder and van Leer 1985, J. Comput. Phys. 59, 232; Kelley and
    Keyes 1998, SIAM J. Numer. Anal. 35, 508): from a flow that is followed to Newton's method, as
    the residual falls. A linear solve is an iteration, whether its step is taken or not. Linear
    systems are as accurate as Newton's (Eisenstat and Walker, unless -ksp_rtol is given), and steps
    are taken in the regularised gap unless -snes_regularised_gap is false. Only PETSc's test of the
    residual makes a solve converged.

    Attributes
    ----------
    time_step : the present one
    linear_iterations : of the last solve; PETSc does not count those of a Python type
    """

    capabilities = Capabilities(forcing=True)

    def __init__(self):
        self.options, self.regularised = PseudoOptions(), NewtonOptions()
        self.time_step, self.linear_iterations = None, 0

    def setFromOptions(self, snes):
        """Read the options under the SNES's prefix."""
        prefix = snes.getOptionsPrefix() or ""
        self.options, self.regularised = read(PseudoOptions, prefix), read(NewtonOptions, prefix)

    def setUp(self, snes):
        """InputError for what this flow is not made for."""
        if not isinstance(snes.appctx, DisplacementForm):
            raise InputError(f"-snes_python_type is '{snes.getPythonType()}': it needs "
                             "-contact_form displacement")

    def solve(self, snes, b, x):
        """Step from x until there is a reason to stop.

        Parameters
        ----------
        snes : petsc4py SNES
        b : petsc4py Vec or None, not used
        x : petsc4py Vec, the start, and the solution
        """
        options = self.options
        residual = snes.getFunction()[0]
        trial = x.duplicate()
        if form_of(snes.getJacobian()[0]) is None:
            raise InputError(f"-snes_python_type is '{snes.getPythonType()}': it needs "
                             "the exact Jacobian, without -snes_mf")
        snes.computeFunction(x, residual)
        norm = residual.norm()
        iteration = 0
        self.linear_iterations = 0
        self.time_step = options.first_change / max(norm, TINY)
        reason = self._judge(snes, iteration, norm)
        while not reason:
            solved = self._step(snes, x, residual, trial)
            snes.computeFunction(trial, residual)
            tried, iteration = residual.norm(), iteration + 1
            if solved and tried <= options.uphill * norm:
                trial.copy(x)
                self.time_step *= min(options.growth, (norm / max(tried, TINY)) ** options.exponent)
                norm = tried
            else:
                snes.computeFunction(x, residual)
                self.time_step *= 0.25
            reason = self._judge(snes, iteration, norm)
        snes.setConvergedReason(reason)

    def _step(self, snes, x, residual, trial):
        """Fill ``trial`` with where a step leads from x; whether the linear system was solved."""
        form = snes.appctx
        ksp = snes.getKSP()
        step = snes.getSolutionUpdate()
        matrices, shift = snes.getJacobian()[:2], 1.0 + 1.0 / self.time_step
        snes.computeJacobian(x, *matrices)
        form.tangent /= shift
        residual.copy(trial)
        trial.scale(1.0 / shift)
        # Force rows hold a tangent only, and mean displacements enter without one.
        trial.getArray()[form.count:] /= shift
        ksp.setOperators(*matrices)
        callbacks.solve(ksp, (trial, step))
        self.linear_iterations += ksp.getIterationNumber()
        step.getArray()[form.count:] *= shift
        if self.regularised.gap:
            RegularisedStep(form, self.regularised.stiffness)(x, step)
        trial.waxpy(-1.0, step, x)
        return ksp.getConvergedReason() > 0

    def _judge(self, snes, iteration, norm):
        """Report the present state to PETSc; the reason to stop, or 0."""
        reasons = PETSc.SNES.ConvergedReason
        if reason := reported(snes, iteration, norm,
                              snes.getKSP().getIterationNumber() if iteration else 0):
            return reason
        if self.time_step < SHORTEST:
            return reasons.DIVERGED_LINE_SEARCH
        return reasons.DIVERGED_MAX_IT if iteration >= snes.max_it else reasons.ITERATING

    def view(self, snes, viewer):
        """What -snes_view prints."""
        text = ", ".join(f"{name} {as_text(value)}" for name, value in vars(self.options).items())
        last = "" if self.time_step is None else f", last time step {self.time_step:.6g}"
        viewer.printfASCII(f"  {self.options.title}: {text}{last}\n")
