"""Blocks of the core-zone preconditioner: one component on circles around its core, in each box."""

import math
from typing import NamedTuple

import numpy as np

from ..grid.active import Nodes
from ..grid.patches import circle_points, patch


class Core(NamedTuple):
    """Where a component is stiff.

    Attributes
    ----------
    part : slices of each box that hold all of it; None: weights are those of some nodes of the cell
    weight : array (boxes, *part) of what is here, or (1, nodes): its smoothed indicator a^2, 0 to 1
    tangent : array (boxes,), D, its mean there, dimensionless
    """

    part: tuple
    weight: np.ndarray
    tangent: np.ndarray

    def everywhere(self, window):
        """The weights of all nodes, array (nodes,)."""
        found = np.zeros(window.size)
        on_part(window, self.part, found)[...] = self.weight
        return found


def on_part(window, part, values):
    """Values (nodes) at what is here of a part of each box, as `Core` has its weights: a view.

    Parameters
    ----------
    window, part, values : Window, and as of `Core`, array
    """
    boxes = values.reshape(1, -1) if part is None else values.reshape(len(window.parts),
                                                                      *window.shape)
    return boxes if part is None else boxes[(slice(None), *window.parts[0].own(part)[1])]


class CoreBlock:
    """One component of the core zone: M^-1 r = a S (a r) + (1 - a^2) r with S = 1 / (1 + C D) on a
    circle around the core.

    Of several boxes each has a circle of its own, all of one size.

    Parameters
    ----------
    form : DisplacementForm, linearised
    component : int
    core : Core
    pad : float >= 1, extent of the circle over that of the core
    scale : array (nodes), fields that M^-1 is applied to over those that r is; None: they are the
        same

    Attributes
    ----------
    index : what picks the core's nodes that are here from boxes
    into, back : arrays (boxes, *core), a in the scales of r and of M^-1 r
    """

    apart = 1

    def __init__(self, form, component, core, pad, scale=None):
        window = form.window
        self.boxes = (len(window.parts), *window.shape)
        extents = self._find(window, core, scale)
        # Few sizes, so that transforms and symbols are made once and found again.
        both = [window.even and not mirror for mirror in window.mirrors]
        circle = tuple(circle_points(_rounded(pad * (n // 2 + 1 if sides else n)), total,
                                     self.apart)
                       for n, total, sides in zip(extents, window.limits, both))
        self.transform, self.compliance = form.contact.circle(
            component, circle, window.even, len(window.parts),
            window.of(component) if window.even else None, self.apart)
        self._stiffness, self._symbols = core and core.tangent, {}
        self._lay_out(window)

    def circle(self, single):
        """(transform, symbol) of the circle, perhaps in single precision."""
        plan = self.transform.single if single else self.transform
        if single not in self._symbols:
            self._symbols[single] = plan.inverted(self.compliance, self._stiffness)
        return plan, self._symbols[single]

    def _find(self, window, core, scale):
        """Take the core's nodes with their weights; its extents."""
        self._part, self.index = core.part, (slice(None), *window.parts[0].own(core.part)[1])
        self.into = self.back = np.sqrt(core.weight)
        if scale is not None:
            scale = on_part(window, core.part, scale)
            self.into, self.back = self.into / scale, self.back * scale
        return [line.stop - line.start for line in core.part]

    def _lay_out(self, window):
        """Find the core's place on the circle."""
        self.transform = window.parts[0].placed(self.transform, self._part)

    def apply(self, field, single=False):
        """Replace a field (nodes) by M^-1 field: two transforms of the core's circle."""
        core, (plan, symbol) = field.reshape(self.boxes)[self.index], self.circle(single)
        plan.enter(self.into, core)
        plan.filter(symbol)
        plan.leave(self.into, self.back, core)


class InPatches(CoreBlock):
    """A core block of nodes of a box in the plane whose circle has a point for each patch of
    ``apart`` nodes in each direction; parameters as of `CoreBlock`."""

    def _locate(self, window, nodes):
        """Find the rows and columns of nodes of a window; the extents of all of them.

        Parameters
        ----------
        window : Window
        nodes : array of intc, their numbers in the window
        """
        places = window.places[nodes] if isinstance(window, Nodes) else nodes
        lines = self._nodes = np.divmod(places, np.intc(window.shape[1]))
        for line, start in zip(lines, window.start):
            line += start
        extents = []
        for line, (lowest, highest) in zip(lines, window.grid.ends(lines)):
            # patches are those of the cell, whose rows one process has
            first = lowest // self.apart * self.apart
            line -= first
            extents.append(highest + 1 - first)
        return extents

    def _lay_out(self, window):
        """Find the patches of the nodes on the circle."""
        rows, columns = self._nodes
        for line in self._nodes:
            line //= self.apart
        nodes = self._nodes_of = window.grid
        self._grid = nodes.of_circle(self.transform.shape)
        if self._grid is nodes:
            here = (int(rows.min()), int(np.ptp(rows)) + 1) if rows.size else (0, 0)
            self.transform = nodes.placed(self.transform, *here)
            rows -= here[0]
        rows *= self.transform.real.shape[-1]
        rows += columns
        self._patch = rows
        del self._nodes

    def _complete(self, sums):
        """Sums over patches, of nodes that are here, as those of all of their nodes, in place: of
        a circle that every process has, others have nodes."""
        if self._grid is not self._nodes_of:
            self._nodes_of.add_up(sums)
        return sums


class PatchedBlock(InPatches):
    """A core block of nodes of a box in the plane, in patches: M^-1 r = r - a (g + P (G - g) R) (a
    r) with G = 1 - S = C D / (1 + C D).

    R takes the mean of each patch, P gives it to its nodes: the circle has a point a patch. C is
    small for waves that are shorter, and one number g is G for all of them (two grids for an
    equation of the second kind: Hackbusch, Multi-Grid Methods and Applications, chapter 16).

    Parameters
    ----------
    form, component, core, pad, scale : as of `CoreBlock`, on a window of one box whose fields have
        no scale
    """

    def __init__(self, form, component, core, pad, scale=None):
        self.apart, self._within = patch(form.contact, component, float(core.tangent[0]))
        super().__init__(form, component, core, pad, scale)

    def _find(self, window, core, scale):
        """Take the core's nodes with their weights; its extents."""
        weight = core.everywhere(window)
        self.core = np.flatnonzero(weight).astype(np.intc)
        self.into = np.sqrt(weight[self.core])
        return self._locate(window, self.core)

    def circle(self, single):
        """(transform, G - g over the nodes of a patch, where patches of the core's nodes are) of
        the circle, perhaps in single precision."""
        made = single in self._symbols
        plan, found = super().circle(single)
        if not made:
            np.subtract((1.0 - self._within) / plan.gain, found, out=found)
            found /= self.apart ** 2
            found = self._symbols[single] = plan.fitting(found), plan.places(self._patch)
        return plan, *found

    def apply(self, field, single=False):
        """Replace a field (nodes) by M^-1 field: two transforms of the core's circle."""
        plan, symbol, places = self.circle(single)
        sums = plan.sums_at(places, self.core, self.into, field)
        plan.real.reshape(-1)[...] = self._complete(sums)
        plan.filter(symbol)
        plan.subtract_nodes(places, self.core, self.into, self._within, field)


class CoupledBlock:
    """A core block of several boxes that know of each other as a whole: M^-1 r = B^-1 (r - w), w_b
    = sum of k_bc F_c.

    B is the core block, F_c the sum of the law's linear response D M^-1 r in a box, k the kernel at
    the boxes' offsets; on its diagonal, by how much a box in the cell gives way more than on its
    circle, which is the same at all small lags.

    Parameters
    ----------
    form : DisplacementForm, linearised, on a window of several boxes
    component : int
    block : CoreBlock of the component
    single : bool, whether it is set up in single precision
    """

    def __init__(self, form, component, block, single=False):
        self.block, self.by_box = block, (len(form.window.parts), -1)
        self.tangent = form.tangent[component, component]
        kernel = form.contact.operator(form.components).kernel((component, component))
        start = np.array(form.window.start)
        between = kernel[tuple(np.moveaxis((start[:, None] - start[None]) % form.grid.shape, -1,
                                           0))]
        np.fill_diagonal(between, kernel.flat[0] - self._at_no_lag())
        column = np.ones(form.nodes)
        block.apply(column, single)
        self.column = column.reshape(self.by_box)
        # Where a box only pulls, its response is negative, and what is inverted may come near to
        # singular.
        self.inverse = inverse(np.eye(len(start)) + between * self._response(column),
                                0.1) @ between

    def _at_no_lag(self):
        """The circle's kernel at lag 0: the mean of its symbol over all waves, of which a half
        spectrum has one column or two once."""
        compliance, circle = self.block.compliance, self.block.transform
        once = compliance[..., :1].sum() + (compliance[..., -1:].sum() if circle.shape[-1] % 2 == 0
                                            else 0.0)
        return (2.0 * compliance.sum() - once) / circle.gain

    def _response(self, field):
        """Sum of D field over each box."""
        return np.einsum("bn,bn->b", self.tangent.reshape(self.by_box), field.reshape(self.by_box))

    def apply(self, field, single=False):
        """Replace a field (nodes) by M^-1 field."""
        self.block.apply(field, single)
        means = self.inverse @ self._response(field)
        field.reshape(self.by_box)[...] -= means[:, None] * self.column


def inverse(matrix, floor):
    """Inverse of a small matrix, its singular values at least ``floor``.

    Without a floor, where nothing responds (a body off the flat, or sliding everywhere), means are
    left as they are.
    """
    if matrix.size == 0:
        return matrix
    if floor == 0.0:
        # of tractions far beyond the law's range: one over them may be infinite
        if np.max(np.abs(matrix)) < 1e-100:
            return np.zeros_like(matrix)
        return 1.0 / matrix if matrix.size == 1 else np.linalg.pinv(matrix, rcond=1e-13)
    left, values, right = np.linalg.svd(matrix)
    return (right.T / np.maximum(values, floor)) @ left.T


def _rounded(extent):
    """The extent rounded up to a sixteenth of its power of two."""
    unit = 2 ** max(math.frexp(extent)[1] - 5, 0)
    return math.ceil(extent / unit) * unit
