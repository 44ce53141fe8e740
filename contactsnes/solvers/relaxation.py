"""Dynamic relaxation of the force form as SNES types: thin contexts around the methods of
``stepping``."""

from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from ..contact.force_form import ForceForm
from ..options.database import read
from ..options.fields import InputError, as_text
from . import stepping
from .capabilities import Capabilities
from .convergence import reached, reported
from .leaving import leaving
from .motion import Motion

UNBOUNDED = 1e8
"""Residual norm, in ranges and over the first one, that no motion towards a balance has
(dimensionless)."""


class Relaxation:
    """Base of the SNES types of dynamic relaxation; a subclass names its options and its method of
    stepping.

    The SNES's application context is a ForceForm. Every step is an iteration, at which monitors and
    the convergence test get ``residual_norm``, an upper bound of the archive's: -snes_atol is that
    number. The solution Vec is filled at the end. -snes_max_funcs counts only if it is given
    (PETSc's default is made for Newton), -snes_stol and -snes_divergence_tolerance do not: steps
    are small, and norms grow where a body leaves an unstable state. A motion costs 3 transforms a
    component to begin with, and 2 for each step.

    Attributes
    ----------
    escaping : component that leaves, for which the last solve ended with
        SNES_DIVERGED_FUNCTION_DOMAIN; None where none does
    """

    options_class: ClassVar[type]
    method_class: ClassVar[type]
    estimates: ClassVar[tuple] = ()
    capabilities: ClassVar[Capabilities] = Capabilities("dynamic relaxation", is_relaxation=True,
                                                       keeps_evenness=True)

    def __init__(self):
        self.options = self.options_class()
        self.method = None
        self.most_evaluations = np.inf
        self.escaping = None

    def setFromOptions(self, snes):
        """Read the method's options under the SNES's prefix."""
        prefix = snes.getOptionsPrefix() or ""
        self.options = read(self.options_class, prefix)
        if PETSc.Options(prefix).hasName("snes_max_funcs") and snes.max_funcs >= 0:
            self.most_evaluations = snes.max_funcs

    def setUp(self, snes):
        """Have the norm tested that is reported to PETSc, for the function's Vec is not kept."""
        if not isinstance(snes.appctx, ForceForm):
            raise InputError(
                f"-snes_python_type is '{snes.getPythonType()}': it needs -contact_form force")
        snes.setConvergenceTest(self.test)

    def test(self, snes, iteration, norms):
        """Convergence test: absolute, relative, and no growth without bound.

        Parameters
        ----------
        snes : petsc4py SNES
        iteration : int
        norms : (of the unknown, of the step, of the residual)
        """
        reasons, norm = PETSc.SNES.ConvergedReason, norms[2]
        self._first = norm if iteration == 0 else self._first
        if reason := reached(snes, iteration, norm, self._first):
            return reason
        return reasons.DIVERGED_DTOL if norm > UNBOUNDED * max(1.0,
                                                               self._first) else reasons.ITERATING

    def solve(self, snes, b, x):
        """Move from x until there is a reason to stop.

        Parameters
        ----------
        snes : petsc4py SNES
        b : petsc4py Vec or None, not used
        x : petsc4py Vec, the start, and the solution
        """
        motion = Motion(snes.appctx, self.options.masses, self.options.tangent)
        motion.start(motion.form.displacement(x.getArray(readonly=True)))
        self.motion, self.method = motion, self.method_class(motion, self.options)
        self.escaping = None
        self._since = 0
        self._first = np.inf
        reason = self._judge(snes, motion)
        while not reason:
            self.method.step()
            reason = self._judge(snes, motion)
        x.getArray()[...] = motion.form.pack(motion.displacements())
        snes.setConvergedReason(reason)

    def _judge(self, snes, motion):
        """Report the present state to PETSc; the reason to stop, or 0."""
        reasons = PETSc.SNES.ConvergedReason
        if reason := reported(snes, motion.steps, motion.norm()):
            return reason
        if self._escapes(motion):
            return reasons.DIVERGED_FUNCTION_DOMAIN
        if motion.steps >= snes.max_it:
            return reasons.DIVERGED_MAX_IT
        return (reasons.DIVERGED_FUNCTION_COUNT if motion.steps + 1 >= self.most_evaluations
                else reasons.ITERATING)

    def _escapes(self, motion):
        """Whether a component leaves; sliding must last a period of the slowest motion, as contact
        may yet grow."""
        component = leaving(motion)
        if component is None:
            self._since = motion.steps
        elif (component == 0 or (motion.steps - self._since) * self.method.time_step > 2.0 * np.pi
              / motion.slowest):
            self.escaping = component
        return self.escaping is not None

    def view(self, snes, viewer):
        """What -snes_view prints."""
        values = dict(vars(self.options))
        # What is not given is estimated: at the start, or on the way.
        values.update({name: "estimated" if self.method is None
                       else float(getattr(self.method, name)) for name in self.estimates
                       if values.get(name) is None})
        text = ", ".join(f"{name} {as_text(value)}" for name, value in values.items())
        viewer.printfASCII(f"  {self.options.title}: {text}\n")
        if self.method is not None:
            viewer.printfASCII(f"    {self.motion.about()}\n")


class Verlet(Relaxation):
    """SNES type of damped Verlet: ``-snes_type python -snes_python_type
    contactsnes.solvers.relaxation.Verlet``."""

    options_class = stepping.VerletOptions
    method_class = stepping.DampedVerlet
    estimates = ("damping",)


class Adaptive(Relaxation):
    """SNES type of adaptive relaxation: ``-snes_type python -snes_python_type
    contactsnes.solvers.relaxation.Adaptive``."""

    options_class, method_class = stepping.AdaptiveOptions, stepping.AdaptiveRelaxation
    estimates = ("time_step", "damping")


class Kinetic(Relaxation):
    """SNES type of kinetic damping: ``-snes_type python -snes_python_type
    contactsnes.solvers.relaxation.Kinetic``."""

    options_class, method_class = stepping.KineticOptions, stepping.KineticDamping


class Fire(Relaxation):
    """SNES type of FIRE: ``-snes_type python -snes_python_type
    contactsnes.solvers.relaxation.Fire``."""

    options_class, method_class = stepping.FireOptions, stepping.FastInertial
