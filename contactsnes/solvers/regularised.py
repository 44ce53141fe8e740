"""Newton's steps in the regularised gap: its options, and how the steps of a SNES are taken so."""

import weakref
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from ..interface.laws.coupled import SOFTENING
from ..options.fields import InputError, Options, as_text, option
from . import callbacks


@dataclass(frozen=True)
class NewtonOptions(Options):
    """Options of Newton's step that PETSc does not have."""

    prefix: ClassVar[str] = "snes_regularised_"
    title: ClassVar[str] = "Newton in the regularised gap"
    gap: bool = option(True, "take Newton's step in w = a + t_n(a)/kappa, "
                       "where the repulsion is no exponential")
    stiffness: float = option(None,
                              "kappa, above the law's steepest softening, 0.135 for a exp(-a)",
                              "phi_n/delta_n^2", kind="number", above=SOFTENING,
                              default_text="0.2 for a exp(-a), else 1.5 times the "
                                           "softening; from afar five times that")


def regularised_stiffness(law, stiffness):
    """kappa of Newton's steps, the law's own if none is given; InputError for one that is too
    small."""
    stiffness = law.newton_stiffness if stiffness is None else stiffness
    if stiffness <= law.softening:
        raise InputError(f"-snes_regularised_stiffness is '{as_text(stiffness)}': "
                         "allowed is a number above the law's steepest "
                         f"softening, {law.softening:.6g}; try "
                         f"{law.newton_stiffness:.3g}, or leave it out")
    return stiffness


FROM_AFAR = 5.0
"""kappa of steps from afar over that of steps near by, where the user gave none: the softer step is
the longer one where the law softens, which serves near by, and wanders from afar (measured on
bodies with one contact)."""


def step_from_afar(form, afar):
    """Have the next steps of a form's SNES be those from afar, or those near by.

    Parameters
    ----------
    form : of a SNES of `create_snes`
    afar : bool
    """
    if form.regularised is not None:
        factor = FROM_AFAR if afar and form.contact.convex else 1.0
        form.regularised.newton_stiffness = factor * form.contact.law.newton_stiffness


class RegularisedStep:
    """Line-search pre-check: replaces Newton's step by the one taken in the regularised gap
    (pointwise, no transform)."""

    def __init__(self, form, stiffness):
        self.form = weakref.proxy(form)  # the form holds its step: no cycle keeps both
        self.newton_stiffness = regularised_stiffness(form.contact.law, stiffness)

    def __call__(self, x, y):
        """Change the step y (the update is x - y) where it is long; True if it was changed."""
        form = self.form
        kernel = getattr(getattr(form, "form", form), "kernel", None)
        if kernel:
            return form.grid.any(kernel.regularised_step(
                self.newton_stiffness, x.getArray(readonly=True), y.getArray()))
        step = y.getArray()[:form.count].reshape(form.shape)[0]
        root = np.broadcast_to(form.root, step.shape)
        far = np.abs(step) * root > 0.1
        if not form.grid.any(far):
            return False
        gap = form.gap(x.getArray(readonly=True))[0][far]
        root = root[far]
        step[far] = -form.contact.law.regularised_step(gap, -root * step[far],
                                                       self.newton_stiffness) / root
        return True


def regularise(solvers, options):
    """Have Newton's steps of solvers, [(SNES, form), ...], taken in the regularised gap, if options
    say so; each form gets what holds its ``newton_stiffness``, or None where that is given or its
    steps are others or have an old tangent, as ``regularised``."""
    for solver, form in reversed(solvers):  # the first one of a form is not another's part
        step = None
        if options.gap and solver.getType() == "newtonls":
            step = RegularisedStep(form, options.stiffness)
            if callbacks.of(solver):
                step = callbacks.regularise(solver, step.newton_stiffness)
            else:
                solver.setLineSearchPreCheck(step)
        lagged = PETSc.Options(solver.getOptionsPrefix() or "").hasName("snes_lag_jacobian")
        # With an old tangent the long steps from afar do not lead home (measured).
        form.regularised = step if options.stiffness is None and not lagged else None
