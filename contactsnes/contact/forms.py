"""The contact problem in two forms of one balance, on the nodes where the law acts and on the whole
cell.

Everything here is in ranges of the law: displacements v_i = lambda_i u_i, tractions in phi_i /
delta_i. With the body's compliance C (mean-free part, scaled by lambda_i lambda_j) and its rigid
compliance c_0, both scaled:

displacement form, window:  v + C t(a + v) - vbar = 0,   vbar = far displacement - c_0 mean t, or
                            one more unknown
force form, whole cell:     K v + t(a + v) = 0 for q != 0, and the balance of the mean displacement
                            or force for q = 0
"""

import numpy as np

from ..grid.boxes import convolution
from ..grid.cell import Convolution
from .problem import APPROACH, DISPLACEMENT, FORCE


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
    tangent : array (components, components, nodes), the law's at the last ``linearise``
    work : array (components, nodes) that every method may overwrite; the preconditioner borrows it
    drag : for each component, what the Jacobian's force row adds to the sum of tractions for a unit
        of mean displacement: 0 but in viscous motion
    """

    name = "displacement"
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
        self.size = self.count + len(self.forced)
        self.root = np.sqrt(self.count)
        self.initial_gap = window.take(contact.initial_gap)
        self.convolution = self.convolution_class(window, contact.operator(self.components),
                                                  self.components)
        self.rigid_compliance = contact.rigid_compliance(self.components)
        self.rigid_compliance[[control == APPROACH for control in controls]] = 0.0
        self.factor = contact.load_factor(self.components)
        self._free = np.array([control != FORCE for control in controls], dtype=float)
        self.load = np.zeros(self.components)
        self.tangent = np.zeros((self.components, *self.shape))
        self.work = np.empty(self.shape)
        self.drag = np.zeros(self.components)
        self.evaluations = 0
        self.products = 0

    def set_load(self, load):
        """Set the controlled values: D, U in u_n,r, u_t,r or W, T in w_n,r, w_t,r, by
        ``controls``."""
        self.load = np.array(load, dtype=float)
        self.row_scale = self.factor / np.maximum(1.0, np.abs(self.load))

    def pack(self, displacement, scalars):
        """The unknown from displacements (components, nodes) and the means of the force-controlled
        components."""
        return np.concatenate([displacement.reshape(-1) / self.root, scalars])

    def displacement(self, unknown):
        """Displacements (components, nodes), ranges of the law."""
        return unknown[:self.count].reshape(self.shape) * self.root

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return unknown[self.count:]

    def gap(self, unknown):
        """Gap a (components, nodes), ranges of the law, in ``work``."""
        np.multiply(unknown[:self.count].reshape(self.shape), self.root, out=self.work)
        self.work[0] += self.initial_gap
        return self.work

    def residual(self, unknown, out):
        """F: the imbalance of displacements over sqrt(M), then of prescribed forces over max(1,
        |force|)."""
        self.evaluations += 1
        traction = self.contact.law.evaluate(self.gap(unknown), self.work)
        total = self.grid.sum(traction)
        self.convolution.apply(traction, traction)
        mean = self.contact.far_displacement(self.components, self.load) \
            - self.rigid_compliance * total / self.grid.size
        mean[self.forced] = unknown[self.count:]
        traction -= mean[:, None]
        field = out[:self.count].reshape(self.shape)
        np.multiply(traction, 1.0 / self.root, out=field)
        field += unknown[:self.count].reshape(self.shape)
        for row, i in enumerate(self.forced):
            out[self.count + row] = (self.row_scale[i] * total[i]
                                     - self.load[i] / max(1.0, abs(self.load[i])))
        return out

    def linearise(self, unknown):
        """Take the law's tangent at the unknown."""
        self.contact.law.evaluate(self.gap(unknown), self.work, self.tangent)

    def stiffen(self, field, out):
        """out_i = sum_j D_ij field_j: the law's tangent times a field."""
        if self.components == 1:
            return np.multiply(self.tangent[0], field, out=out)
        return np.einsum("ijn,jn->in", self.tangent, field, out=out)

    def apply_jacobian(self, vector, out):
        """out = J vector at the last linearisation: two transforms of the padded window a
        component."""
        self.products += 1
        field = vector[:self.count].reshape(self.shape)
        work = self.stiffen(field, self.work)
        total = self.grid.sum(work)
        self.convolution.apply(work, work)
        mean = -self.rigid_compliance * total / self.grid.size
        mean[self.forced] = vector[self.count:] / self.root
        result = out[:self.count].reshape(self.shape)
        np.subtract(work, mean[:, None], out=result)
        result += field
        for row, i in enumerate(self.forced):
            out[self.count + row] = self.row_scale[i] * (total[i] * self.root
                                                         + self.drag[i] * vector[self.count + row])
        return out

    def apply_transpose(self, vector, out):
        """out = J^T vector at the last linearisation (trust regions ask for it)."""
        self.products += 1
        field = vector[:self.count].reshape(self.shape)
        sums = self.grid.sum(field)
        work = self.convolution.apply(field, self.work, transposed=True)
        work += (self.rigid_compliance / self.grid.size * sums * self._free)[:, None]
        for row, i in enumerate(self.forced):
            work[i] += self.row_scale[i] * self.root * vector[self.count + row]
        result = out[:self.count].reshape(self.shape)
        np.einsum("jin,jn->in", self.tangent, work, out=result)
        result += field
        out[self.count:] = -sums[self.forced] / self.root
        return out

    def load_derivative(self, direction, out):
        """out = dF/ds for controlled values that move by ``direction`` (one value a component) per
        unit of s.

        The scale of a force row is held: it does not move the solution.
        """
        field = out[:self.count].reshape(self.shape)
        field[...] = -(self.contact.far_displacement(self.components, direction) / self.root)[:,
                                                                                              None]
        for row, i in enumerate(self.forced):
            field[i] = 0.0
            out[self.count + row] = -direction[i] / max(1.0, abs(self.load[i]))
        return out

    def forces(self, unknown):
        """Normal force W and tangential forces, w_n,r, w_t,r."""
        return self.factor * self.grid.sum(self.contact.law.evaluate(self.gap(unknown), self.work))


class ForceForm:
    """K v + t(a + v) = 0 on the whole cell, the zero mode balanced by what is controlled.

    The zero mode of F is t_0 + k_0 (v_0 - far displacement) under displacement control, v_0 - far
    displacement where the body is rigid (k_0 infinite), and t_0 - prescribed mean traction under
    force control. Unknown and F are divided by sqrt(components x nodes) as in the displacement
    form; no further unknown is needed.

    Parameters
    ----------
    contact : Contact
    controls : 'displacement' or 'force' for each component
    """

    name = "force"
    linear_tolerance = 0.0

    def __init__(self, contact, controls):
        self.contact, self.controls = contact, tuple(controls)
        self.grid = contact.grid
        self.window = self.grid.whole
        self.components = len(controls)
        self.shape = (self.components, self.grid.size)
        self.count = self.size = self.components * self.grid.size
        self.nodes = self.grid.size
        self.root = np.sqrt(self.count)
        self.forced = [i for i, control in enumerate(controls) if control == FORCE]
        self.initial_gap = contact.initial_gap.reshape(-1)
        self.rigid_compliance = contact.rigid_compliance(self.components)
        self.factor = contact.load_factor(self.components)
        self.convolution = Convolution(self.window, contact.operator(self.components, "stiffness"),
                                       self.components)
        self.compliance = Convolution(self.window, contact.operator(self.components),
                                      self.components)
        self.load = np.zeros(self.components)
        self.tangent = np.zeros((self.components, *self.shape))
        self.work = np.empty(self.shape)
        self.evaluations = 0
        self.products = 0
        kept, self.mean_stiffness = np.ones(self.components), np.zeros(self.components)
        for i, control in enumerate(controls):
            if control == DISPLACEMENT:
                kept[i] = self.rigid_compliance[i] > 0.0
                self.mean_stiffness[i] = 1.0 / self.rigid_compliance[i] if kept[i] else 1.0
        self._kept = kept

    set_load = DisplacementForm.set_load
    displacement = DisplacementForm.displacement
    gap = DisplacementForm.gap
    linearise = DisplacementForm.linearise
    stiffen = DisplacementForm.stiffen
    forces = DisplacementForm.forces

    def pack(self, displacement, scalars=()):
        """The unknown from displacements (components, nodes of the cell); the mean displacements
        are among them."""
        return displacement.reshape(-1) / self.root

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return self.grid.mean(self.displacement(unknown))[self.forced]

    def target(self):
        """What the zero mode of F is balanced against, for each component."""
        target = self.mean_stiffness * self.contact.far_displacement(self.components, self.load)
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
        zero = self.root * spectrum[(slice(None),
                                     *[0] * len(self.grid.shape))].real / self.grid.size
        self.compliance.multiply(spectrum)
        spectrum *= self.grid.size
        field = np.sqrt(self.grid.parseval(spectrum) * self.grid.size / max(within, 1))
        rigid = np.where(self._kept > 0.0, self.rigid_compliance, 1.0) * zero
        rows = self.factor * self.grid.size * zero / np.maximum(1.0, np.abs(self.load))
        rigid[self.forced] = 0.0
        return float(np.hypot(field + np.sqrt(np.sum(rigid ** 2) / self.components),
                              np.linalg.norm(rows[self.forced])))
