"""A form whose load is one more unknown, fixed by the length of the step along the branch."""

from functools import cached_property

import numpy as np

from ..kernels.arcs import CompiledArc


class ArcLength:
    """A form whose load s is one more unknown, fixed by how far the state has gone along a
    direction.

    F = [form's F at the load start + s direction;  <tangent, x - anchor> + rate s - length]; the
    unknown is [x, s].

    Parameters
    ----------
    form : DisplacementForm
    start, direction : controlled values at s = 0, and their change per unit of s
    anchor, tangent : arrays of the form's size; the tangent measures how far an unknown has gone
        from the anchor
    length : how far to go
    rate : how much of that a unit of s is
    """

    def __init__(self, form, start, direction, anchor, tangent, length, rate=0.0):
        self.form = form
        self.aim(start, direction, anchor, tangent, length, rate)
        self.name = form.name
        self.in_displacements, self.has_single = form.in_displacements, form.has_single
        self.contact = form.contact
        self.grid = form.grid
        self.components, self.window = form.components, form.window
        self.nodes = form.nodes
        self.shape = form.shape
        self.count = form.count
        self.root = form.root
        self.size = form.size + len(form.grid.held([0.0]))
        self.linear_tolerance = form.linear_tolerance

    @cached_property
    def kernel(self):
        """The same rows on the same memory in the library, or None."""
        alone = getattr(self.form, "kernel", None) and not self.grid.shared
        return CompiledArc(self) if alone else None

    def aim(self, start, direction, anchor, tangent, length, rate=0.0):
        """Take another length, or another direction to go; parameters as of the class.

        Parameters
        ----------
        start, direction, anchor, tangent, length, rate : as of `ArcLength`
        """
        self.start = start
        self.direction = direction
        # What rounding takes off the anchor is told with the length.
        self.anchor = anchor.astype(np.float32)
        self.tangent = tangent
        self.length = length + self.form.grid.inner(tangent, anchor - self.anchor)
        self.rate = rate
        if vars(self).get("kernel"):
            self.kernel.aim(self)

    def release(self, *names):
        """Give back arrays that `aim` has taken, before it takes others, or what a product does not
        ask for."""
        for name in names:
            setattr(self, name, None)
        if vars(self).get("kernel"):
            self.kernel.release(*names)

    @property
    def evaluations(self):
        """Number of residuals evaluated so far."""
        return self.form.evaluations

    @property
    def products(self):
        """Number of products with the Jacobian so far."""
        return self.form.products

    def gap(self, unknown):
        """Gap of the form's part of the unknown."""
        return self.form.gap(self.inner(unknown))

    def inner(self, unknown):
        """The form's part of an unknown, or of a vector like it, as a view."""
        return unknown[:self.form.size]

    def position(self, unknown):
        """The load's part s of an unknown, or of a vector like it."""
        return self.grid.scalars(unknown[self.form.size:], 1)[0]

    def joined(self, inner, position):
        """The unknown of the form's part and a place s."""
        return np.append(inner, self.grid.held([position]))

    def set_position(self, position):
        """Set the load of the form to that of a place s."""
        self.form.set_load(self.start + position * self.direction)

    def residual(self, unknown, out):
        """F of the form and of the arc length."""
        if self.kernel:
            return self.kernel.residual(unknown, out)
        own, position = self.inner(unknown), self.position(unknown)
        self.set_position(position)
        self.form.residual(own, self.inner(out))
        out[self.form.size:] = self.grid.held([
            self.grid.inner(self.tangent, own - self.anchor) + self.rate * position - self.length])
        return out

    def displacement_norm(self, unknown, imbalance):
        """That of the force form, with the row of the arc length."""
        return float(np.hypot(self.form.displacement_norm(self.inner(unknown),
                                                          self.inner(imbalance)),
                              self.position(imbalance)))

    def linearise(self, unknown):
        """Take the law's tangent and dF/ds at the unknown."""
        if self.kernel:
            self.kernel.linearise(unknown)
            return
        self.set_position(self.position(unknown))
        self.form.linearise(self.inner(unknown))
        self._column = self.form.load_derivative(self.direction, np.empty(self.form.size))

    @property
    def load_column(self):
        """dF/ds of the last linearisation, an array of the form's size."""
        return self.kernel.load_column(np.empty(self.form.size)) if self.kernel else self._column

    def apply_jacobian(self, vector, out, *single):
        """out = J vector.

        Parameters
        ----------
        vector, out : arrays of its size; out is filled and returned
        single : True for transforms in single precision, if the form has them
        """
        if self.kernel:
            return self.kernel.apply_jacobian(vector, out, *single)
        self.form.apply_jacobian(self.inner(vector), self.inner(out), *single)
        return self._bordered(vector, self.load_column, self.tangent, out)

    def apply_transpose(self, vector, out, *single):
        """out = J^T vector.

        Parameters
        ----------
        vector, out, single : as of `apply_jacobian`
        """
        if self.kernel:
            return self.kernel.apply_transpose(vector, out, *single)
        self.form.apply_transpose(self.inner(vector), self.inner(out), *single)
        return self._bordered(vector, self.tangent, self.load_column, out)

    def _bordered(self, vector, column, row, out):
        """Add a column times the last number of a vector to out, and make its last number."""
        own, position = self.inner(out), self.position(vector)
        own += position * column
        out[self.form.size:] = self.grid.held([self.grid.inner(row, self.inner(vector))
                                               + self.rate * position])
        return out
