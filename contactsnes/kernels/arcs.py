"""The row and column of arc length around a form in the library, on the memory of both."""

import ctypes

import numpy as np

from . import structures
from .forms import call
from .structures import MOST, address


class CompiledArc:
    """The row and column of arc length around a compiled form.

    Parameters
    ----------
    arc : ArcLength whose form has a kernel
    """

    def __init__(self, arc):
        half = arc.form.kernel.half
        contact, count = half.contact, half.components
        self._factor = np.zeros(2 * MOST)
        self._factor[:count] = half.factor
        self._factor[MOST:MOST + count] = contact.far_displacement(count, np.ones(count))
        self.kernel, self.structure = arc.form.kernel, structures.Arc()
        self._shared = {"factor": self._factor, "load": half.load, "target": half.row_target,
                        "far": half.far, "row_scale": half.row_scale,
                        "load_column": np.zeros(count + len(half.forced))}
        for name, array in self._shared.items():
            setattr(self.structure, name, address(array))
        self.aim(arc)
        self.reference = ctypes.addressof(self.structure)

    def aim(self, arc):
        """Take where an arc leads, and how far."""
        own = self.structure
        own.length, own.rate = arc.length, arc.rate
        self._given = {name: np.ascontiguousarray(getattr(arc, name), dtype=float)
                       for name in ("start", "direction", "tangent")}
        self._given["anchor"] = arc.anchor
        for name, array in self._given.items():
            setattr(own, name, address(array))

    def release(self, *names):
        """Give back arrays of these names, which an arc has released."""
        for name in names:
            self._given.pop(name, None)
            setattr(self.structure, name, None)

    def load_column(self, out):
        """dF/ds of the last linearisation, of which the library keeps a number a component."""
        self.kernel.library.load_column(self.kernel.reference, self.reference, address(out))
        return out

    def linearise(self, unknown):
        """Take the law's tangent and dF/ds at the unknown."""
        self.kernel.library.arc_linearise(self.kernel.reference, self.reference, address(unknown))

    def residual(self, unknown, out):
        """F of the form and of the arc length."""
        call(self.kernel.library.arc_residual, self.kernel.grid.counter, self.kernel.reference,
             self.reference, address(unknown), address(out))
        return out

    def apply_jacobian(self, vector, out, single=False):
        """out = J vector.

        Parameters
        ----------
        vector, out, single : as of `bordered.ArcLength`
        """
        self.kernel.set_precision(single)
        call(self.kernel.library.arc_product, self.kernel.grid.counter, self.kernel.reference,
             self.reference, address(vector), address(out))
        return out

    def apply_transpose(self, vector, out, single=False):
        """out = J^T vector.

        Parameters
        ----------
        vector, out, single : as of `bordered.ArcLength`
        """
        self.kernel.set_precision(single)
        call(self.kernel.library.arc_transposed, self.kernel.grid.counter, self.kernel.reference,
             self.reference, address(vector), address(out))
        return out
