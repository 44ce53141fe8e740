"""The core-zone preconditioner in the library: what `solvers.core_zone.CoreZone` does, set up again
at each tangent in the memory it has."""

import ctypes
import math
import weakref

import numpy as np

from ..grid.active import Nodes
from ..grid.patches import PATCHES, circle_points, shortest, taken
from ..grid.transfer import reach_of
from . import structures
from .asked import asked
from .forms import call
from .structures import address

SIDE_BY_SIDE = 8
"""Rows of doubles that are blurred side by side, as core_zone.c has it."""


def answers(kernel, fields):
    """What this process has of the sums over nodes of what the law answers to fields.

    Parameters
    ----------
    kernel : CompiledForm
    fields : array (components, nodes)
    """
    sums = np.empty(len(fields))
    kernel.library.answers(kernel.reference, address(fields), address(sums))
    return sums


class CompiledZone:
    """The preconditioner of a compiled form, or of one under arc length.

    Parameters
    ----------
    kernel : CompiledForm
    options : CoreOptions
    floor : float, least response to means over that of a stiff contact, dimensionless
    arc : CompiledArc around the form, or None
    quick : bool, whether it is applied in single precision, too, where the form's products are
    """

    def __init__(self, kernel, options, floor=0.0, arc=None, quick=False):
        self.kernel, self.form, self.options = kernel, kernel.half, options
        self.library, self._arc = kernel.library, arc
        window, count = self.form.window, self.form.components
        own = self.structure = structures.Zone(
            threshold=options.threshold, pad=options.pad, floor=floor)
        own.form = ctypes.pointer(kernel.structure)
        if arc is not None:
            own.arc = ctypes.pointer(arc.structure)
        self._kept, self._grids = [], ()
        if quick:
            kernel.make_quick()
        self._lay_out(window, options)
        self._circles = [[] for _ in range(count)]
        own.missing = asked(structures.Missing, self._circle_maker(window, quick))
        self._blocks(window, count)
        self._means(count)
        self.reference = ctypes.addressof(own)

    def _array(self, *shape):
        """The address of a new array that is kept."""
        self._kept.append(np.zeros(shape))
        return address(self._kept[-1])

    def _lay_out(self, window, options):
        """Widths of the blur in nodes, and the directions that close on themselves."""
        own, first = self.structure, 2 - len(window.shape)
        reaches = reach_of(window, options.width / self.form.contact.ranges[0])
        for axis, (points, reach, total) in enumerate(zip(window.shape, reaches,
                                                          window.grid.shape), start=first):
            own.reach[axis], own.wraps[axis] = reach, points == total
        nodes = self.form.nodes
        if len(window.shape) == 2:
            own.sums = self._array(2, max(window.shape), SIDE_BY_SIDE)
            # boxes are blurred in memory of their transform, which is not at work then
            transform = self.form.convolution.transform
            own.mask, own.blur = address(transform.real), address(self._beside(transform))
        else:
            own.sums = self._array(nodes)
            own.mask, own.blur = self._array(nodes), self._array(nodes)
        if self._arc is not None:
            own.column = self._array(self.kernel.size)
        own.patched = taken(window)
        if own.patched:
            self._patches(window)

    def _beside(self, transform):
        """Memory for blurs beside that of masks, of a float and a byte for each node of a box: the
        transform's, but for none that it would make for this alone."""
        if "spectrum" in vars(transform) or len(self.form.window.parts) > 1:
            return transform.spectrum
        if len(transform.real) > 1:
            return transform.real[1]
        nodes = math.prod(self.form.window.shape)
        self._kept.append(np.empty(nodes + nodes // 4 + 1, dtype=np.float32))
        return self._kept[-1]

    def _patches(self, window):
        """Say when cores are in which patches."""
        own = self.structure
        own.start[:], own.sizes[:], own.left[:] = window.start, (*PATCHES,), (*PATCHES.values(),)
        for i in range(self.form.components):
            known = dict(shortest(self.form.contact, i))
            own.shortest[i][:] = [known.get(apart, 0.0) for apart in PATCHES]

    def _blocks(self, window, count):
        """Memory of the blocks; of several boxes what they know of each other."""
        own, boxes, nodes = self.structure, len(window.parts), window.size
        for i in range(count):
            block = own.block[i]
            block.into = self._array(nodes)
            block.back = self._array(nodes) if self.kernel.structure.scale else block.into
            if isinstance(window, Nodes):
                self._kept.append(np.zeros((2, nodes), dtype=np.intc))
                block.node, block.at = (address(part) for part in self._kept[-1])
            block.mean = self._array(2 * boxes)
            if boxes > 1:
                kernel = self.form.contact.operator(count).kernel((i, i))
                start = np.array(window.start)
                lags = np.moveaxis((start[:, None] - start[None]) % window.grid.shape, -1, 0)
                between = np.ascontiguousarray(kernel[tuple(lags)])
                self._kept.append(between)
                own.between[i], own.kernel_at_zero[i] = address(between), kernel.flat[0]
                block.column = self._array(nodes)
                block.inverse = self._array(5 * boxes, boxes)

    def _means(self, count):
        """Components whose means are eliminated."""
        own, form = self.structure, self.form
        means = [i for i in range(count) if i in form.forced or form.rigid_compliance[i] != 0.0]
        own.mean_count = len(means)
        own.means[:len(means)] = means
        own.columns = self._array(len(means), form.nodes)

    def _circle_maker(self, window, quick):
        """What makes a circle for a component's core of a rounded extent, and enters it.

        It holds neither the form nor this object, which hold it.
        """
        contact, circles = self.form.contact, self._circles
        structure, plane, boxes = weakref.ref(self.structure), len(window.shape) == 2, len(
            window.parts)

        def make(component, first, second, apart):
            raw = (first, second) if plane else (second,)
            shape = tuple(circle_points(extent, total, apart)
                          for extent, total in zip(raw, window.limits))
            signs = window.of(component) if window.even else None
            # cores of several extents may be on one circle, which one of them is on at a time
            like = next((circle for circle in circles[component]
                         if circle.transform.shape == shape), None)
            made = Circle(contact.circle(component, shape, window.even, boxes, signs, apart),
                          boxes, (first, second, apart), quick, like)
            circles[component].append(made)
            made.table = (structures.Circle * len(circles[component]))(
                *(circle.structure for circle in circles[component]))
            structure().circles[component] = made.table
            structure().circle_count[component] = len(made.table)

        return make

    def take(self, grids=()):
        """Take two grids in place of cores from the next set-up on.

        Parameters
        ----------
        grids : OnTwoGrids or None of each component; of none: cores
        """
        self._grids = grids
        for i in range(self.form.components):
            grid = grids[i] if grids else None
            self.structure.grids[i] = grid and ctypes.pointer(grid.structure)

    @property
    def patches(self):
        """The OnTwoGrids that are all that it is now, or None."""
        alone = len(self._grids) == 1 and not self.structure.mean_count
        return self._grids[0] if alone else None

    def set_up(self, single=False):
        """Make the zones from the form's tangent, perhaps in single precision."""
        self.kernel.set_precision(single)
        call(self.library.set_up, self.form.grid.counter, self.reference)

    def apply(self, vector, out, single=False):
        """out = M^-1 vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        self.kernel.set_precision(single)
        call(self.library.precondition, self.form.grid.counter, self.reference, address(vector),
             address(out))
        return out


class Circle:
    """A circle for cores of a component up to an extent.

    Parameters
    ----------
    found : (transform, compliance), of `Contact.circle`
    boxes : int
    raw : (int, int, int), rounded extents that it is found by, and spacings between its points
    quick : bool, whether there is one in single precision, too
    like : Circle of the same shape whose symbol is this one's, too, or None
    """

    def __init__(self, found, boxes, raw, quick, like=None):
        self.transform, compliance = found
        self.compliance = compliance = np.ascontiguousarray(compliance, dtype=float)
        waves = max(compliance.size, self.transform.structure.waves)
        self._symbol = np.empty((boxes, waves)) if like is None else like._symbol
        own = self.structure = structures.Circle(no_lag=self._at_no_lag() if boxes > 1 else 0.0)
        own.raw[:], own.apart = raw[:2], raw[2]
        if quick:
            own.quick = ctypes.pointer(self.transform.single.structure)
        own.transform = ctypes.pointer(self.transform.structure)
        own.compliance, own.symbol = address(compliance), address(self._symbol)

    def _at_no_lag(self):
        """The circle's kernel at lag 0: the mean of its symbol over all waves, of which a half
        spectrum has one column or two once."""
        compliance, circle = self.compliance, self.transform.shape
        once = compliance[..., :1].sum() + (compliance[..., -1:].sum() if circle[-1] % 2 == 0
                                            else 0.0)
        return (2.0 * compliance.sum() - once) / self.transform.gain
