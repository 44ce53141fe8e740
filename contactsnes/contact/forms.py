"""The contact problem as a balance of displacements on the nodes where the law acts; `force_form`
has it as one of forces on the whole cell.

Everything here is in ranges of the law: displacements v_i = lambda_i u_i, tractions in phi_i /
delta_i. With the body's compliance C (mean-free part, scaled by lambda_i lambda_j) and its rigid
compliance c_0, both scaled:

displacement form, window:  v + C t(a + v) - vbar = 0,   vbar = far displacement - c_0 mean t, or
                            one more unknown
force form, whole cell:     K v + t(a + v) = 0 for q != 0, and the balance of the mean displacement
                            or force for q = 0
"""

from functools import cached_property

import numpy as np

from ..grid.boxes import convolution
from ..grid.precision import in_single
from ..kernels.forms import twin
from .problem import APPROACH, FORCE
from .state import spread

NEGLIGIBLE = 1e-30
"""Size below which tangents are zero: floats of 1e-38 take many times as long as others."""


class DisplacementForm:
    """v + C t(a + v) - vbar = 0 on a window, and one force row for each force-controlled component.

    The unknown is [v / sqrt(M), vbar of the force-controlled components] with M = nodes x
    components, so that the 2-norm of its first part is the root mean square in ranges of the law,
    the Jacobian is the identity plus a compact operator, and the 2-norm of the residual is
    ``residual_norm`` of the archive.

    Parameters
    ----------
    contact : Contact
    window : Window that holds every node within the law's range
    controls : 'displacement', 'force' or 'approach' for each component; their number is the number
        of components

    Attributes
    ----------
    in_displacements : whether F is an imbalance of displacements, whose 2-norm is
        ``residual_norm``; else one of tractions
    whole_cell : whether it is solved on the whole cell, mean displacements among its unknowns
    even : whether states are taken for even about the apex, and half of them is solved for
    has_single : whether products may be in single precision
    tangent : array (components, components, nodes), the law's at the last ``linearise``
    work : array (components, nodes) that every method may overwrite; the preconditioner borrows it,
        and the library needs none
    drag : for each component, what the Jacobian's force row adds to the sum of tractions for a unit
        of mean displacement: 0 but in viscous motion
    """

    name = "displacement"
    in_displacements, whole_cell, even, parities = True, False, False, None
    has_single = True
    linear_tolerance = 0.5
    convolution_class = staticmethod(convolution)

    def __init__(self, contact, window, controls):
        self.contact = contact
        self.window = window
        self.controls = tuple(controls)
        self.components = len(controls)
        self.grid = window.grid
        self.nodes = window.size
        self.shape = (self.components, self.nodes)
        self.forced = [i for i, control in enumerate(controls) if control == FORCE]
        self.count = self.components * self.nodes
        self.size = self.count + len(self.grid.held(self.forced))
        self.root = np.sqrt(self.components * window.total)
        self.initial_gap = contact.gap_on(window)
        make = contact.kernels.even if window.even else contact.kernels.real
        self.convolution = self.convolution_class(window, contact.operator(self.components),
                                                  self.components, make)
        self.rigid_compliance = contact.rigid_compliance(self.components)
        self.rigid_compliance[[control == APPROACH for control in controls]] = 0.0
        self.factor = contact.load_factor(self.components)
        self._free = np.array([control != FORCE for control in controls], dtype=float)
        self.load, self.far, self.row_scale, self.row_target = np.zeros((4, self.components))
        self.set_load(self.load)
        self.tangent = np.zeros((self.components, *self.shape))
        self.drag = np.zeros(self.components)
        self._evaluations = self._products = 0
        self.pulled = None, None  # transforms when `pull` had ended, and what it returned

    @cached_property
    def work(self):
        """Memory of the methods, from the first of them on that asks for it."""
        return np.empty(self.shape)

    @cached_property
    def quick(self):
        """The convolution in single precision, on the memory of that in double."""
        return in_single(self.convolution)

    @cached_property
    def kernel(self):
        """The same equations on the same memory in the library, or None."""
        return twin(self, self)

    @property
    def evaluations(self):
        """Number of residuals evaluated so far."""
        return self._evaluations + (self.kernel.structure.evaluations if self.kernel else 0)

    @property
    def products(self):
        """Number of products with the Jacobian so far."""
        return self._products + (self.kernel.structure.products if self.kernel else 0)

    def set_load(self, load):
        """Set the controlled values: D, U in u_n,r, u_t,r or W, T in w_n,r, w_t,r, by
        ``controls``."""
        self.load[...] = load
        sizes = np.maximum(1.0, np.abs(self.load))
        np.divide(self.factor, sizes, out=self.row_scale)
        np.divide(self.load, sizes, out=self.row_target)
        self.far[...] = self.contact.far_displacement(self.components, self.load)

    def pack(self, displacement, scalars):
        """The unknown from displacements (components, nodes) and the means of the force-controlled
        components."""
        unknown = np.empty(self.size)
        np.divide(displacement.reshape(-1), self.root, out=unknown[:self.count])
        unknown[self.count:] = self.grid.held(scalars)
        return unknown

    def nodal(self, state):
        """Displacements (components, nodes) of a State on the form's window."""
        return state.displacement

    def packed(self, state):
        """The unknown of a State on the form's window."""
        return self.pack(state.displacement, state.means[self.forced])

    def displacement(self, unknown):
        """Displacements (components, nodes), ranges of the law."""
        return unknown[:self.count].reshape(self.shape) * self.root

    once = displacement

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return self.grid.scalars(unknown[self.count:], len(self.forced))

    def state(self, unknown):
        """The State of an unknown: its displacements, and means by the load and the tractions."""
        means = self.far.copy()
        state = spread(self.window, self.displacement(unknown), means)
        if self.rigid_compliance.any():
            means -= self.rigid_compliance * self.contact.survey(state).total / self.grid.size
        means[self.forced] = self.scalars(unknown)
        return state

    def gap(self, unknown):
        """Gap a (components, nodes), ranges of the law, in ``work``."""
        np.multiply(unknown[:self.count].reshape(self.shape), self.root, out=self.work)
        self.work[0] += self.initial_gap
        return self.work

    def residual(self, unknown, out):
        """F: the imbalance of displacements over sqrt(M), then of prescribed forces over max(1,
        |force|)."""
        if self.kernel:
            return self.kernel.residual(unknown, out)
        self.gap(unknown)
        rows = self.pull(self.scalars(unknown))
        field = out[:self.count].reshape(self.shape)
        np.multiply(self.work, 1.0 / self.root, out=field)
        field += unknown[:self.count].reshape(self.shape)
        out[self.count:] = self.grid.held(rows)
        return out

    def pull(self, scalars):
        """Turn gaps in ``work`` into C t - vbar, the imbalance without the displacement itself;
        return the imbalance of each force row, on every process."""
        self._evaluations += 1
        traction = self.contact.law.evaluate(self.work, self.work)
        total = self.grid.sum(traction)
        self.convolution.apply(traction, traction)
        mean = self.far - self.rigid_compliance * total / self.grid.size
        mean[self.forced] = scalars
        traction -= mean[:, None]
        rows = (self.row_scale * total - self.row_target)[self.forced]
        self.pulled = self.grid.counter.made, rows
        return rows

    def closest_beyond(self, mean):
        """Smallest normal gap at nodes of the cell that are none of the window's, some nodes of it,
        for the unknown of the last residual: its response is known everywhere, and is overwritten.

        Parameters
        ----------
        mean : float, the mean normal displacement, ranges of the law
        """
        plan, nodes = self.convolution.transform, self.window.numbers
        gap = rows = plan.real[0]
        if self.kernel and plan.folded:  # whose rows stand in pairs
            rows, nodes = plan.folded.rows(gap), plan.folded.places(nodes)
        np.subtract(self.contact.initial_gap.reshape(rows.shape), rows, out=rows)
        gap.reshape(-1)[nodes] = np.inf
        return float(self.grid.minimum(gap)) + mean

    def linearise(self, unknown):
        """Take the law's tangent at the unknown."""
        if self.kernel:
            self.kernel.linearise(unknown)
            return
        self.contact.law.evaluate(self.gap(unknown), self.work, self.tangent)
        self.tangent[np.abs(self.tangent) < NEGLIGIBLE] = 0.0

    def stiffen(self, field, out):
        """out_i = sum_j D_ij field_j: the law's tangent times a field."""
        if self.components == 1:
            return np.multiply(self.tangent[0], field, out=out)
        return np.einsum("ijn,jn->in", self.tangent, field, out=out)

    def apply_jacobian(self, vector, out, single=False):
        """out = J vector at the last linearisation: two transforms of the padded window a
        component.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        if self.kernel:
            return self.kernel.apply_jacobian(vector, out, single)
        self._products += 1
        field = vector[:self.count].reshape(self.shape)
        work = self.stiffen(field, self.work)
        total = self.grid.sum(work)
        (self.quick if single else self.convolution).apply(work, work)
        mean = -self.rigid_compliance * total / self.grid.size
        scalars = self.scalars(vector)
        mean[self.forced] = scalars / self.root
        result = out[:self.count].reshape(self.shape)
        np.subtract(work, mean[:, None], out=result)
        result += field
        rows = self.row_scale[self.forced] * (total[self.forced] * self.root
                                              + self.drag[self.forced] * scalars)
        out[self.count:] = self.grid.held(rows)
        return out

    def apply_transpose(self, vector, out, single=False):
        """out = J^T vector at the last linearisation (trust regions ask for it).

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        if self.kernel:
            return self.kernel.apply_transpose(vector, out, single)
        self._products += 1
        field = vector[:self.count].reshape(self.shape)
        sums = self.grid.sum(field)
        convolution = self.quick if single else self.convolution
        work = convolution.apply(field, self.work, transposed=True)
        work += (self.rigid_compliance / self.grid.size * sums * self._free)[:, None]
        for i, scalar in zip(self.forced, self.scalars(vector)):
            work[i] += self.row_scale[i] * self.root * scalar
        result = out[:self.count].reshape(self.shape)
        np.einsum("jin,jn->in", self.tangent, work, out=result)
        result += field
        out[self.count:] = self.grid.held(-sums[self.forced] / self.root)
        return out

    def load_derivative(self, direction, out):
        """out = dF/ds for controlled values that move by ``direction`` (one value a component) per
        unit of s.

        The scale of a force row is held: it does not move the solution.
        """
        field = out[:self.count].reshape(self.shape)
        field[...] = -(self.contact.far_displacement(self.components, direction) / self.root)[:,
                                                                                              None]
        field[self.forced] = 0.0
        rows = -np.asarray(direction) / np.maximum(1.0, np.abs(self.load))
        out[self.count:] = self.grid.held(rows[self.forced])
        return out

    def forces(self, unknown):
        """Normal force W and tangential forces, w_n,r, w_t,r."""
        return self.factor * self.grid.sum(self.contact.law.evaluate(self.gap(unknown), self.work))
