"""The contact problem as a balance of forces on the whole cell (`forms` has the equations)."""

import math
from functools import cached_property

import numpy as np

from ..grid.cell import Convolution
from ..grid.even import halved
from .forms import DisplacementForm
from .problem import APPROACH, FORCE
from .state import State


class ForceForm:
    """K v + t(a + v) = 0 on the whole cell, the zero mode balanced by what is controlled.

    The zero mode of F is t_0 + k_0 (v_0 - far displacement) under displacement control, v_0 - far
    displacement where the body is rigid (k_0 infinite), and t_0 - prescribed mean traction under
    force control. Unknown and F are divided by sqrt(components x nodes) as in the displacement
    form; no further unknown is needed.

    Parameters
    ----------
    contact : Contact
    controls : 'displacement', 'force' or 'approach' for each component

    Attributes
    ----------
    even : whether states are taken for even about the apex, so that a motion may be followed on
        half of the nodes; the form's own unknowns are those of the whole cell
    """

    name, kernel = "force", None
    in_displacements, whole_cell, even, parities = False, True, False, None
    has_single = False
    linear_tolerance = 0.0

    def __init__(self, contact, controls):
        self.contact, self.controls = contact, tuple(controls)
        self.grid = contact.grid
        self.window = self.grid.whole
        self.components = len(controls)
        self.nodes = self.window.size
        self.shape = (self.components, self.nodes)
        self.count = self.size = self.components * self.nodes
        self.root = np.sqrt(self.components * self.grid.size)
        self.forced = [i for i, control in enumerate(controls) if control == FORCE]
        self.initial_gap = contact.initial_gap.reshape(-1)
        self.rigid_compliance = contact.rigid_compliance(self.components)
        self.rigid_compliance[[control == APPROACH for control in controls]] = 0.0
        self.factor = contact.load_factor(self.components)
        self.convolution = Convolution(self.window, contact.operator(self.components, "stiffness"),
                                       self.components, contact.kernels.real)
        self.compliance = Convolution(self.window, contact.operator(self.components),
                                      self.components, contact.kernels.real)
        self.load, self.far, self.row_scale, self.row_target = np.zeros((4, self.components))
        self.set_load(self.load)
        self.tangent = np.zeros((self.components, *self.shape))
        self.work = np.empty(self.shape)
        self.evaluations = 0
        self.products = 0
        kept, self.mean_stiffness = np.ones(self.components), np.zeros(self.components)
        for i, control in enumerate(controls):
            if control != FORCE:
                kept[i] = self.rigid_compliance[i] > 0.0
                self.mean_stiffness[i] = 1.0 / self.rigid_compliance[i] if kept[i] else 1.0
        self._kept = kept

    set_load = DisplacementForm.set_load
    displacement = DisplacementForm.displacement
    gap = DisplacementForm.gap
    linearise = DisplacementForm.linearise
    stiffen = DisplacementForm.stiffen
    forces = DisplacementForm.forces

    @cached_property
    def half(self):
        """The EvenWindow of the cell."""
        return halved(self.window)

    def packed(self, state):
        """The unknown of a State on the cell."""
        return self.pack(state.displacement)

    def pack(self, displacement, scalars=()):
        """The unknown from displacements (components, nodes of the cell); the mean displacements
        are among them."""
        return displacement.reshape(-1) / self.root

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return self.grid.mean(self.displacement(unknown))[self.forced]

    def state(self, unknown):
        """The State of an unknown, whose means are those of its displacements."""
        displacement = self.displacement(unknown).copy()
        return State(self.window, displacement, self.grid.mean(displacement))

    def target(self):
        """What the zero mode of F is balanced against, for each component."""
        target = self.mean_stiffness * self.far
        target[self.forced] = (self.load / (self.factor * self.grid.size))[self.forced]
        return target

    def residual(self, unknown, out):
        """F: the imbalance of tractions over sqrt(M)."""
        self.evaluations += 1
        traction = self.contact.law.evaluate(self.gap(unknown), self.work)
        return self._balance(unknown, traction, self.target(), out)

    def _balance(self, unknown, traction, target, out):
        """K v + t with the zero mode replaced, over sqrt(M); the unknown is v over sqrt(M),
        traction is overwritten."""
        field, result = unknown.reshape(self.shape), out.reshape(self.shape)
        traction /= self.root
        mean = self.grid.mean(traction)
        zero = (self._kept - 1.0) * mean + self.mean_stiffness * self.grid.mean(
            field) - target / self.root
        self.convolution.apply(field, result)
        result += traction
        result += zero[:, None]
        return out

    def apply_jacobian(self, vector, out):
        """out = J vector at the last linearisation: two transforms of the cell a component."""
        self.products += 1
        work = self.stiffen(vector.reshape(self.shape), self.work)
        work *= self.root
        return self._balance(vector, work, np.zeros(self.components), out)

    def apply_transpose(self, vector, out):
        """out = J^T vector at the last linearisation (trust regions ask for it)."""
        self.products += 1
        field, result = vector.reshape(self.shape), out.reshape(self.shape)
        sums = self.grid.sum(field)
        self.convolution.apply(field, result, transposed=True)
        result += (self.mean_stiffness * sums / self.grid.size)[:, None]
        np.subtract(field, ((1.0 - self._kept) * sums / self.grid.size)[:, None], out=self.work)
        result += np.einsum("jin,jn->in", self.tangent, self.work)
        return out

    def load_derivative(self, direction, out):
        """out = dF/ds for controlled values that move by ``direction`` per unit of s."""
        target = self.mean_stiffness * self.contact.far_displacement(self.components, direction)
        target[self.forced] = (direction / (self.factor * self.grid.size))[self.forced]
        out.reshape(self.shape)[...] = -(target / self.root)[:, None]
        return out

    def displacement_norm(self, unknown, imbalance):
        """``residual_norm`` of the archive for a state and its F, to be sure rounded up: one
        transform a component.

        The displacements that F deforms the body by, root mean square over the nodes within the
        law's range, of the whole cell's (Parseval's sum), and the force rows.
        """
        plan = self.compliance.transform
        plan.real.reshape(self.shape)[...] = imbalance.reshape(self.shape)
        plan.forward()
        return self.spectral_norm(plan.spectrum,
                                  self.grid.count(self.gap(unknown)[0] < self.contact.law.range))

    def spectral_norm(self, spectrum, within):
        """The same from the transform of F (components, *half spectrum), which is overwritten;
        ``within``: nodes in range."""
        zero = self.grid.zero_wave(spectrum).real.reshape(self.components, -1).sum(axis=1)
        zero = self.root * self.grid.together(zero)
        self.compliance.multiply(spectrum)
        squares = self.root ** 2 * self.grid.size * self.grid.parseval(spectrum)
        return self.norm_function()(squares, zero, within)

    def norm_function(self):
        """``residual_norm`` at the present load, a function of the sum over the cell's waves of the
        squares of C F / N (ranges squared), of the zero mode of F (components; N times the mean
        traction), and of the number of nodes in range; N nodes, F in tractions."""
        size, forced = self.grid.size, np.isin(np.arange(self.components), self.forced)
        field = size / self.root
        rigid = np.where(self._kept > 0.0, self.rigid_compliance, 1.0) * ~forced / size
        rigid /= np.sqrt(self.components)
        rows = self.factor * forced / np.maximum(1.0, np.abs(self.load))

        def norm(squares, zero, within):
            return math.hypot(field * math.sqrt(squares / max(within, 1.0))
                              + math.hypot(*(rigid * zero)), *(rows * zero))

        return norm


FORMS = {form.name: form for form in (DisplacementForm, ForceForm)}
"""Forms by their names, of ``-contact_form``."""
