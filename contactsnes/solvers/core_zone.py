"""The core zone of the displacement form, where the law is stiff: the mathematics of its
preconditioner, and its options."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..grid.active import Nodes
from ..grid.patches import taken
from ..kernels.zones import answers
from ..options.fields import Options, option
from .core_blocks import (
    Core,
    CoreBlock,
    CoupledBlock,
    PatchedBlock,
    inverse,
    on_part,
)


@dataclass(frozen=True)
class CoreOptions(Options):
    """Options of the core-zone preconditioner of the displacement form, and of the zones of the
    force form."""

    prefix: ClassVar[str] = "pc_core_"
    title: ClassVar[str] = "Preconditioner: core zone, where the law is stiff"
    threshold: float = option(0.1, "tangent that counts as stiff, over the "
                              "component's largest (at most 1)", above=0, below=1)
    width: float = option(0.3, "blur of the core's edge over 1/lambda_n", minimum=0)
    pad: float = option(1.25,
                        "extent of the circle on which the core is inverted, over that of the core",
                        minimum=1, maximum=1000)


def core_of(form, component, options):
    """A component's `Core`; None where nothing is stiff.

    Parameters
    ----------
    form : DisplacementForm or ForceForm, linearised
    component : int
    options : CoreOptions
    """
    tangent, window = form.tangent[component, component], form.window
    largest = form.grid.maximum(tangent)
    if largest <= 1e-6:
        return None
    stiff, width = tangent > options.threshold * min(1.0, largest), options.width
    part, weight = weights(form.contact.kernels, window, stiff, width / form.contact.ranges[0])
    counted = weight * on_part(window, part, form.grid.weights) if window.even else weight
    by_box = len(window.parts), -1
    stiffness = counted * on_part(window, part, tangent)
    count, total = form.grid.together([each.reshape(by_box).sum(axis=-1)
                                       for each in (counted, stiffness)])
    return Core(part, weight, total / np.where(count > 0.0, count, 1.0))


def weights(kernels, window, stiff, width):
    """The part of each box that holds a core, and the weights there, as `Core` has them.

    Parameters
    ----------
    kernels : `kernels.choice.Compiled` or `Interpreted`
    window : Window
    stiff : array of bool (nodes)
    width : float, standard deviation of the blur, beta
    """
    if isinstance(window, Nodes):
        part, found = kernels.blurred(window.hull, window.spread(stiff), width)
        own = Core(part, found, None).everywhere(window.hull)[None, window.places]
        return None, np.minimum(own, 1.0, out=own)
    part, found = kernels.blurred(window, stiff, width)
    found = found.reshape(len(window.parts), *found.shape[found.ndim - len(window.shape):])
    return part, np.minimum(found, 1.0, out=found)


class CoreZone:
    """Preconditioner of the displacement form: a core block for each component and box, the scalars
    eliminated exactly.

    Coupling blocks of law and body are left out. What the mean displacements add (the rigid
    compliance of the body, and the unknowns and rows of force control) is of low rank and is
    eliminated by its Schur complement. A ``floor`` for the response to means, over that of a stiff
    contact, keeps it regular where the load is one more unknown.

    Parameters
    ----------
    form : DisplacementForm, linearised
    options : CoreOptions
    floor : float, dimensionless
    single : bool, whether it is set up in single precision
    scale : array (nodes), unknowns that it is applied to over the form's (`even_form.EvenForm`);
        None: they are the same
    """

    def __init__(self, form, options=CoreOptions(), floor=0.0, single=False, scale=None):
        self.form, self.grid, self._scale = form, form.grid, scale
        self.blocks = [self._block(i, options, single) for i in range(form.components)]
        self.forced = np.array([i in form.forced for i in range(form.components)])
        self.means = np.flatnonzero(self.forced | (form.rigid_compliance != 0.0))
        self._rigid = form.rigid_compliance[self.means] / self.grid.size
        # M^-1 of a component's unit is nonzero in that component only.
        self.columns = np.ones((len(self.means), form.nodes))
        self.columns *= 1.0 if scale is None else scale
        self.matrix = np.zeros((len(self.means), len(self.means)))
        for place, (i, column) in enumerate(zip(self.means, self.columns)):
            if self.blocks[i] is not None:
                self.blocks[i].apply(column, single)
            self.matrix[:, place] = self._sum(form.tangent[self.means, i] * column)
        for row, i in enumerate(self.means):
            if self.forced[i]:
                self.matrix[row, row] += form.drag[i]
            else:
                self.matrix[row] *= self._rigid[row]
                self.matrix[row, row] += 1.0
        forced = self.forced[self.means]
        acting = self.grid.count(form.tangent[0, 0] != 0.0) if forced.any() else 1
        scale = np.where(forced, max(acting, 1.0), 1.0)
        self.inverse = inverse(self.matrix / scale[:, None], floor) / scale

    def _block(self, component, options, single):
        """The core block of a component, or None where nothing is stiff.

        Parameters
        ----------
        component, options, single : int, and as of `CoreZone`
        """
        core = core_of(self.form, component, options)
        if core is None:
            return None
        window = self.form.window
        kind = PatchedBlock if taken(window) else CoreBlock
        block = kind(self.form, component, core, options.pad, self._scale)
        return (block if len(window.parts) == 1
                else CoupledBlock(self.form, component, block, single))

    def _sum(self, fields):
        """Sums over all nodes of fields (..., nodes) on the scale of unknowns."""
        # (a node counts by the square of its scale)
        return self.grid.sum(fields) if self._scale is None else self.grid.together(
            fields @ self._scale)

    def _response(self, field):
        """Sum over nodes of the law's linear response to a field, for the components with a
        scalar."""
        if self.form.kernel and self._scale is None:
            return self.grid.together(answers(self.form.kernel, field))[self.means]
        return self._sum(self.form.stiffen(field, self.form.work))[self.means]

    def apply(self, vector, out, single=False):
        """out = M^-1 vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        form = self.form
        np.copyto(out, vector)
        field = out[:form.count].reshape(form.shape)
        for i, block in enumerate(self.blocks):
            if block is not None:
                block.apply(field[i], single)
        if not len(self.means):
            return out
        right = -self._response(field)
        right[~self.forced[self.means]] *= self._rigid[~self.forced[self.means]]
        right[self.forced[self.means]] += form.scalars(vector) / (form.row_scale[form.forced]
                                                                 * form.root)
        means = self.inverse @ right
        for i, mean, column in zip(self.means, means, self.columns):
            np.multiply(column, mean, out=form.work[0])
            field[i] += form.work[0]
        out[form.count:] = self.grid.held(means[self.forced[self.means]] * form.root)
        return out
