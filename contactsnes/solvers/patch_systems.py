"""One component of a linear system on two grids: the nodes, and patches of them.

Nodes are eliminated patch by patch: waves that patches do not tell apart have one compliance. What
is left, a second-kind equation on a grid of few points, is solved by GMRES with a core zone of its
own (two grids for such an equation: Hackbusch, Multi-Grid Methods and Applications, chapter 16).
"""

from types import SimpleNamespace

import numpy as np

from ..grid.patches import compliance_between
from ..kernels.two_grids import INNER, OnTwoGrids, patch_nodes
from .core_blocks import InPatches
from .ritz import TELLING
from .triangle import Triangle

APART = 4
"""Nodes of a patch in each direction: its system costs next to nothing."""
WITHIN = 0.6
"""Compliance of waves within patches over that of the shortest ones that patches tell apart."""
CORE = 0.1
"""Stiffness of patches that belong to their system's core, over the largest."""
LEFT = 0.1
"""Part of its right side that is left of the system of patches. What less would save of outer
iterations it costs inside (measured)."""


class Unsuited(Exception):
    """Patches of nodes do not tell enough of the law."""


class Patches(InPatches):
    """One component on two grids: the inverse of I + c (I - P R) D + P C R D, to some accuracy.

    R takes the mean over a patch, P gives it to its nodes, c is the compliance of waves within
    patches, C that of patches. It is x = q (r - R r + m + P z / R q), q = 1 / (1 + c D), where z
    solves (I + C a) z = R r - C b on patches: m makes the mean of q (r - R r + m) zero, b is the
    law's mean linear response to that, and a = R D q / R q its stiffness to a mean displacement.

    Parameters
    ----------
    form : DisplacementForm
    component : int
    pad : float >= 1, extent of the circle of patches over that of the nodes
    single : bool, whether transforms are in single precision

    Attributes
    ----------
    between : float, compliance of the shortest waves that patches tell apart
    library : OnTwoGrids, what does this in the library; None: NumPy does
    softest : smallest real part of the Ritz values of the systems of patches that were solved with
        the last tangent, nan of none
    """

    apart, _area = APART, float(APART ** 2)

    def __init__(self, form, component, pad, single):
        super().__init__(form, component, None, pad)
        self.softest = np.nan
        self.between = compliance_between(form.contact, component, APART)
        plan = self._plan = self.transform.single if single else self.transform
        compiled = form.contact.kernels.compiled
        if compiled:
            self._patch = np.ascontiguousarray(plan.places(self._patch), dtype=np.int32)
        nodes = (self._complete(patch_nodes(self._patch, plan.real.size)) if compiled
                 else self._sums(None))
        self._number, self._there = np.maximum(nodes, 1.0), nodes > 0.0
        self.library = OnTwoGrids(form.grid, plan, self._patch, self._number, self._area, LEFT,
                                  WITHIN * self.between) if compiled else None

    def _find(self, window, core, scale):
        """Take all nodes; their extents."""
        return self._locate(window, np.arange(window.size, dtype=np.intc))

    def take(self, tangent):
        """Take a tangent.

        Parameters
        ----------
        tangent : array (nodes), D, dimensionless

        Raises
        ------
        Unsuited : where no patch is stiff
        """
        inverse = (self._complete(self.library.weigh(tangent)) if self.library
                   else self._weigh(tangent))
        mean = np.where(self._there, inverse / self._number, 1.0)
        # (c D q = 1 - q)
        within = np.where(self._there, self._number - inverse, 0.0) / (WITHIN * self.between)
        stiffness = within / (mean * self._area)
        core, compliance, symbol = self._of_system(stiffness)
        own = {"stiffness": stiffness, "core": core, "there": self._there,
               "compliance": compliance, "symbol": symbol}
        own = {name: array.astype(self._plan.real.dtype, copy=False)
               for name, array in own.items()}
        (self.library.take if self.library else self._take)(mean=mean, within=within, **own)
        self.softest = np.nan

    def _sums(self, values):
        """Sums of values at nodes over each patch; of None, how many nodes it has."""
        sums = np.bincount(self._patch, values, self._plan.real.size)
        return self._complete(sums.astype(float, copy=False))  # (of no nodes they are integers)

    def _weigh(self, tangent):
        """As `kernels.two_grids.OnTwoGrids.weigh`."""
        inverse = 1.0 / (1.0 + WITHIN * self.between * tangent)
        self._inverse = inverse.astype(self._plan.real.dtype)
        return self._sums(inverse)

    def _take(self, **arrays):
        """As `kernels.two_grids.OnTwoGrids.take`."""
        self._own = SimpleNamespace(**arrays)

    def _of_system(self, stiffness):
        """The core of patches, and the symbols of the compliance and of 1 less the core's inverse.

        Parameters
        ----------
        stiffness : array (patches), dimensionless
        """
        grid, plan, compliance = self._grid, self._plan, self.compliance
        largest = grid.maximum(stiffness)
        if not largest > 0.0:
            raise Unsuited
        core = stiffness > CORE * largest
        count, total = grid.together([core.sum(), stiffness[core].sum()])
        mean = float(total / count)
        if self.transform.shape == tuple(n // self.apart for n in grid.shape):
            # means are eliminated apart
            compliance = compliance.copy()
            grid.zero_wave(compliance)[...] = 0.0
        inverse = plan.inverted(compliance, [mean])
        exact = inverse.astype(float)
        symbols = ((1.0 / (plan.gain * exact) - 1.0) / (mean * plan.gain), 1.0 / plan.gain - exact)
        return core, *map(plan.fitting, symbols)

    def _filtered(self, symbol, values):
        """A symbol times values on patches, in memory of the transform."""
        self._plan.real[...] = values.reshape(self._plan.real.shape)
        self._plan.filter(symbol)
        return self._plan.real.reshape(-1)

    def _norm(self, vector):
        return float(np.sqrt(self._grid.together([vector @ vector])[0]))

    def _solved(self, right):
        """The solution of the system of patches, and its Hessenberg matrix.

        Parameters
        ----------
        right : array (patches)
        """
        own = self._own
        size = first = self._norm(right)
        rows, made, triangle, vector = [], [], Triangle(size, INNER), right
        while triangle.count < INNER and size > 0.0:
            rows.append(vector / vector.dtype.type(size))
            made.append(rows[-1] - own.core * self._filtered(own.symbol, own.core * rows[-1]))
            vector = own.there * self._filtered(own.compliance, own.stiffness * made[-1])
            vector += made[-1]
            column = np.array(self._grid.together([row @ vector for row in rows]))
            for row, factor in zip(rows, column.astype(vector.dtype)):
                vector -= factor * row
            size = self._norm(vector)
            if not triangle.add(np.append(column, size)) > LEFT * first:
                break
        found = np.zeros_like(right)
        for factor, each in zip(triangle.factors().astype(vector.dtype), made):
            found += factor * each
        return found, triangle.matrix[:triangle.count, :triangle.count]

    def _on_two_grids(self, field):
        """What `kernels.two_grids.OnTwoGrids` does to a field."""
        own, whole, part = self._own, self._sums(field), self._sums(self._inverse * field)
        mean = whole / self._number
        moved = mean - part / (self._number * own.mean)
        response = (whole - part) / (WITHIN * self.between) + own.within * (moved - mean)
        response /= self._area
        right = mean.astype(own.there.dtype) - self._filtered(own.compliance, response)
        found, matrix = self._solved(own.there * right)
        field += (moved - mean + found / own.mean)[self._patch]
        field *= self._inverse
        return matrix

    def apply(self, field, single=False):
        """Replace a field (nodes) by M^-1 field.

        Parameters
        ----------
        field : array (nodes)
        single : as of `CoreBlock.apply`; this has a precision of its own
        """
        self.tell((self.library or self._on_two_grids)(field))

    def tell(self, matrix):
        """Take the Hessenberg matrix of what was solved on patches."""
        if len(matrix) >= TELLING and np.isfinite(matrix).all():
            self.softest = np.fmin(self.softest, np.linalg.eigvals(matrix).real.min())
