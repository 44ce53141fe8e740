"""PETSc's preconditioner of planes with many spots."""

import weakref

import numpy as np
from petsc4py import PETSc

from ..kernels.made_zones import MadeZone
from ..options.database import read
from . import callbacks
from .core_zone import CoreOptions
from .krylov import is_ours, of_ksp
from .operators import precision_of
from .patch_systems import Unsuited
from .precision import DOUBLE
from .two_grids import CompiledTwoGrids, TwoGrids, suits
from .vectors import communicator

FLEXIBLE = "fgmres", "gcr", "pipefgmres", "pipegcr"
"""PETSc's Krylov methods whose preconditioner may be another function each time."""


class SpotsPC:
    """PETSc's PC context of planes with many spots: two grids, or the form's own zone where these
    do not help.

    Two grids stand in for a tangent whose modes are stable, so that a negative Ritz value of the
    outer system belongs to an unstable mode, as with the zone. Where what is solved on patches
    tells of one itself, the zone takes over for the rest of a nonlinear solve.

    Parameters
    ----------
    form : of the equations, that `suits`
    core : petsc4py PC, the form's own zone
    options : CoreOptions
    single : bool, whether transforms are in single precision
    callbacks : Callbacks of the form in the library, whose zone does either; None: NumPy does

    Attributes
    ----------
    softest : smallest real part of the Ritz values of what the last linear solve has solved on
        patches, nan of none
    """

    def __init__(self, form, core, options, single, callbacks=None):
        self.form, self.core, self._options, self._single = form, core, options, single
        self.callbacks = callbacks
        self._grids, self._trusted, self._known = None, True, {}
        self._precision = DOUBLE

    def begin(self):
        """Take two grids in a nonlinear solve that begins."""
        self._trusted = True

    @property
    def is_ours(self):
        """Whether it is the zone for what follows: the same linear function throughout."""
        return not (self._grids and self._trusted)

    @property
    def softest(self):
        """See above."""
        return self._grids.softest if self._grids else np.nan

    def setUp(self, pc):
        """Make the grids from the tangent that the operator holds."""
        self._grids, self._precision = None, precision_of(pc.getOperators()[1])
        self.core.setOperators(*pc.getOperators())
        if self.callbacks:
            self.callbacks.zone.take()
        if self._trusted:
            try:
                self._grids = self._made()
            except Unsuited:
                pass
        if self.callbacks or self.is_ours:
            self.core.setUp()
        self.tell()

    def in_library(self, form):
        """(Zone in the library, function that chooses the precision of its products, what is to be
        called when it was applied, or None) of a form whose nodes processes share out; None of
        others.

        Parameters
        ----------
        form : of the equations, or None
        """
        if self.is_ours and not self.callbacks:
            return self.core.getPythonContext().in_library(form)
        if self.callbacks or form is not self.form or not (form.kernel and form.grid.shared):
            return None
        made, precision = MadeZone(self._grids, form.kernel), self._precision
        own = weakref.ref(self)
        return made, lambda: made.choose(precision.now()), lambda: own().told(made)

    def told(self, made):
        """Take what the library has solved on patches last, and have it ask for the zone from now
        on where that takes over.

        Parameters
        ----------
        made : MadeZone of the grids
        """
        if self.is_ours:
            return
        self._grids.tell()
        self.tell()
        if self.is_ours:
            self.core.setUp()
            made.ask(self.core.getPythonContext().apply_to)

    def _made(self):
        """Two grids of the form's tangent."""
        rest = self._options, self._single, self._known
        return (CompiledTwoGrids(self.callbacks.zone, *rest) if self.callbacks
                else TwoGrids(self.form, *rest))

    def tell(self):
        """Have the zone take over where what was solved on patches last tells of an unstable
        mode."""
        if self.is_ours:
            return
        if self.callbacks:
            self._grids.tell()
        self._trusted = not self._grids.softest < 0.0
        if self.callbacks and not self._trusted:
            zone = self.callbacks.zone
            zone.take()
            zone.set_up(bool(zone.kernel.structure.single))

    def apply(self, pc, x, y):
        """y = M^-1 x.

        Parameters
        ----------
        pc : petsc4py PC
        x, y : petsc4py Vec; y is filled
        """
        if self.callbacks or self.is_ours:
            self.core.apply(x, y)
        else:
            self._grids.apply(x.getArray(readonly=True), y.getArray())
        self.tell()

    def view(self, pc, viewer):
        """What -snes_view prints."""
        viewer.printfASCII("    two grids, of nodes and of patches of nodes, with the zone:\n")
        self.core.view(viewer)

    def destroy(self, pc):
        """Give back the zone."""
        self.core.destroy()


def offer(snes, form, single):
    """Have a SNES take two grids where they suit, where its preconditioner is the form's own, and
    its Krylov method one that takes another function each time: the SpotsPC, or None.

    Parameters
    ----------
    snes : SNES, as options have it
    form : of the equations
    single : bool, whether products of linear solves may be in single precision
    """
    ksp, pc = snes.getKSP(), snes.getKSP().getPC()
    flexible = of_ksp(ksp) or ksp.getType() in FLEXIBLE
    if not (flexible and suits(form) and is_ours(pc)):
        return None
    core, own = PETSc.PC().create(communicator(form)), None
    if pc.getType() == "shell":
        own = callbacks.of(pc)
        callbacks.set_shell(core, own)
    else:
        core.setType("python")
        core.setPythonContext(pc.getPythonContext())
    pc.setType("python")
    spots = SpotsPC(form, core, read(CoreOptions, pc.getOptionsPrefix() or ""), single, own)
    pc.setPythonContext(spots)
    return spots
