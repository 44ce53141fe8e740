"""The linear systems of many spots on two grids, with the law as it is in each patch of nodes: the
preconditioner of rough planes.

A core zone takes one stiffness for all spots, and none where the law softens. Here each patch has
its own (`patch_systems`).
"""

import numpy as np

from ..contact.forms import DisplacementForm
from ..grid.patches import taken
from .core_zone import CoreZone
from .patch_systems import APART, Patches, Unsuited
from .ritz import many

SOFT = 3.0
"""C D up to which patches tell enough of the law, C the compliance of the shortest waves along an
axis that they tell apart, D the mean tangent of the core."""
PULLS = 0.5
"""The same of the steepest softening: nodes within a patch are to be stable."""
LARGE = 2 ** 14
"""Nodes from which on it is taken: fewer are solved by the library alone."""


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

    def tell(self):
        """Take what the library has solved on patches last."""
        tell(self.blocks)

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
        tell(self._blocks)

    @property
    def softest(self):
        """See above."""
        return softest_of(self._blocks)


def tell(blocks):
    """Have patches take what the library has solved on them last.

    Parameters
    ----------
    blocks : list of Patches or None
    """
    for block in blocks:
        if block:
            block.tell(block.library.matrix)


def softest_of(blocks):
    """Smallest real part of the Ritz values of what was solved on patches, nan of none.

    Parameters
    ----------
    blocks : list of Patches or None
    """
    found = [block.softest for block in blocks if block is not None]
    return float(np.fmin.reduce(found, initial=np.nan))
