"""The linear systems of many spots on two grids, with the law as it is in each patch of nodes: the
preconditioner of rough planes.

A core zone takes one stiffness for all spots, and none where the law softens. Here each patch has
its own (`patch_systems`).
"""

import numpy as np
from petsc4py import PETSc

from ..contact.forms import DisplacementForm
from ..grid.patches import taken
from ..options.database import read
from . import callbacks
from .core_zone import CoreOptions, CoreZone
from .krylov import is_ours, of_ksp
from .patch_systems import APART, Patches, Unsuited
from .ritz import many
from .vectors import communicator

SOFT = 3.0
"""C D up to which patches tell enough of the law, C the compliance of the shortest waves along an
axis that they tell apart, D the mean tangent of the core."""
PULLS = 0.5
"""The same of the steepest softening: nodes within a patch are to be stable."""
LARGE = 2 ** 14
"""Nodes from which on it is taken: fewer are solved by the library alone."""


FLEXIBLE = "fgmres", "gcr", "pipefgmres", "pipegcr"
"""PETSc's Krylov methods whose preconditioner may be another function each time."""


def suits(form):
    """Whether a form's linear systems may be of two grids: of planes with many spots, and of the
    normal component alone. Where friction ties components to each other, which patches leave out,
    they saved a fourteenth of the transforms and took a third more memory.

    Parameters
    ----------
    form : of the equations
    """
    return (type(form) is DisplacementForm and form.components == 1 and many(form.contact)
            and taken(form.window) and form.grid.in_patches(APART)
            and form.window.total >= LARGE)


def on_patches(form, component, options, single, known):
    """Patches of a component with the form's tangent, or None where nothing is stiff.

    Parameters
    ----------
    form : DisplacementForm, linearised, that `suits`
    component : int
    options : CoreOptions
    single : bool, whether transforms are in single precision
    known : dict, the `Patches` of components, which are kept there

    Raises
    ------
    Unsuited : where patches tell too little of the law, or none is stiff
    """
    grid, tangent = form.grid, form.tangent[component, component]
    largest = grid.maximum(tangent)
    if largest <= 1e-6:
        return None
    core = tangent > options.threshold * largest
    count, total = grid.together([core.sum(), np.sum(tangent, where=core)])
    if component not in known:
        known[component] = Patches(form, component, options.pad, single)
    block = known[component]
    if not block.between * total <= SOFT * count or block.between * grid.minimum(tangent) < -PULLS:
        raise Unsuited
    block.take(tangent)
    return block


class TwoGrids(CoreZone):
    """Preconditioner of the displacement form with a system of patches for each component, the
    scalars eliminated as in `CoreZone`.

    Parameters
    ----------
    form, options, single, known : as of `on_patches`, which raises what this does

    Attributes
    ----------
    softest : smallest real part of the Ritz values of what was solved on patches, nan of none
    """

    def __init__(self, form, options, single, known):
        self._known = known
        super().__init__(form, options, single=single)

    def _block(self, component, options, single):
        """Patches of a component.

        Parameters
        ----------
        component, options, single : as of `on_patches`
        """
        return on_patches(self.form, component, options, single, self._known)

    @property
    def softest(self):
        """See above."""
        return softest_of(self.blocks)


class CompiledTwoGrids:
    """The same in the library, whose zone of the form has them in place of cores until it is told
    otherwise.

    Parameters
    ----------
    zone : CompiledZone of the form
    options, single, known : as of `on_patches`

    Attributes
    ----------
    softest : as of `TwoGrids`
    """

    def __init__(self, zone, options, single, known):
        form = zone.form
        self._blocks = [on_patches(form, i, options, single, known) for i in range(form.components)]
        zone.take([block and block.library for block in self._blocks])

    def tell(self):
        """Take what was solved on patches last."""
        for block in self._blocks:
            if block:
                block.tell(block.library.matrix)

    @property
    def softest(self):
        """See above."""
        return softest_of(self._blocks)


def softest_of(blocks):
    """Smallest real part of the Ritz values of what was solved on patches, nan of none.

    Parameters
    ----------
    blocks : list of Patches or None
    """
    found = [block.softest for block in blocks if block is not None]
    return float(np.fmin.reduce(found, initial=np.nan))


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
        self._grids = None
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
