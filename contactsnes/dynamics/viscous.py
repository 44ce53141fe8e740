"""Equations of overdamped motion of a contact under fixed loads, on the window where the law acts,
and their implicit steps.

M u' = -(K u + t): the body is one whose material creeps with the relaxation time 1 (Kelvin and
Voigt), M = K for every wave, and a mean that can move has the mass of `problem.Contact.mean_mass`.
So u = w + m, with the means m of the components, and

    w' = -(w + C t),    m' = -(k_0 (m - far displacement) + mean t - prescribed mean) / m_0.

Linear systems (c + J) of implicit steps are those of Newton's method with the tangent D/(1 + c):
form, operator and preconditioner serve as they are.
"""

import math

import numpy as np
from petsc4py import PETSc

from ..contact.even_form import HalfForm
from ..contact.forms import DisplacementForm
from ..contact.problem import FORCE
from ..contact.states import NEAR
from ..grid.even import halved
from ..interface.laws.law import slip_of
from ..kernels import points
from ..options.database import read
from ..solvers import callbacks
from ..solvers.krylov import tell_modes
from ..solvers.leaving import is_beyond, slides, slides_away
from ..solvers.linear import create_ksp
from ..solvers.regularised import NewtonOptions, RegularisedStep
from ..solvers.vectors import create_vector
from .changes import Near, extremes
from .step_works import PART


class Equations:
    """The motion's equations on one window, for x = [u over its scale, m of the means that move].

    Parameters
    ----------
    contact : Contact
    window : Window, centred if ``even``
    even : whether states are even about the apex
    controls, load : of each component
    precision : str, of transforms inside linear solves, as of ``-contact_linear_precision``
    """

    def __init__(self, contact, window, even, controls, load, precision):
        self.contact = contact
        self.window = window
        count = len(controls)
        compliance = contact.rigid_compliance(count)
        pulled = np.array([control == FORCE for control in controls])
        # Around an isolated contact the rigid compliance is a part of the body's response like any
        # other wave.
        sprung = (compliance > 0.0) & ~pulled & (not contact.isolated)
        self.moving = np.flatnonzero(pulled | sprung)
        self.pulled = pulled[self.moving]
        self.inner = np.where(self.pulled & contact.isolated, compliance[self.moving], 0.0)
        self.mass = contact.mean_mass(count)[self.moving]
        self.stiffness = np.where(self.pulled, 0.0,
                                  1.0 / np.where(sprung, compliance, 1.0)[self.moving])
        self.half = halved(window) if even else None
        controls = [FORCE if i in self.moving else control for i, control in enumerate(controls)]
        self.form = (HalfForm(contact, self.half, controls) if even
                     else DisplacementForm(contact, window, controls))
        self.far, load = contact.far_displacement(count, load), np.array(load, dtype=float)
        load[sprung] = 0.0
        self.form.set_load(load)
        self.target = (load / self.form.factor)[self.moving] / contact.grid.size
        self.ksp, self.matrix = create_ksp(self.form, "jump_", precision)
        tell_modes(self.ksp, False)
        self._right, self._step = (create_vector(self.form) for _ in range(2))
        options = read(NewtonOptions, "jump_")
        self._regularised = RegularisedStep(self.form, options.stiffness) if options.gap else None
        given = PETSc.Options("jump_")
        self._part = given.getReal("ksp_rtol") if given.hasName("ksp_rtol") else None
        self._iterations = 0
        self._rim = np.flatnonzero(self.folded(window.rim()))

    def spent(self):
        """What the solves on this window cost: name -> count."""
        return {"linear_iterations": self._iterations,
                "function_evaluations": self.form.evaluations,
                "jacobian_products": self.form.products}

    def folded(self, field):
        """A field (components, nodes of the window) at the nodes of the equations."""
        return self.half.fold(field) if self.half else field

    def unfolded(self, field):
        """A field (components, nodes of the window) from its values at the nodes of the
        equations."""
        return self.half.unfold(field) if self.half else field

    def pack(self, displacement, means):
        """The unknown of displacements (components, nodes of the window) and means (components)."""
        return self.form.pack(self.folded(displacement), means[self.moving])

    def displacement(self, unknown):
        """Displacements (components, nodes of the equations), ranges of the law."""
        return self.form.displacement(unknown)

    def gap(self, unknown):
        """Gap (components, nodes of the equations), ranges of the law."""
        gap = self.displacement(unknown)
        gap[0] += self.form.initial_gap
        return gap

    def traction(self, unknown):
        """Tractions of the law (components, nodes of the equations)."""
        gap = self.gap(unknown)
        return self.contact.law.evaluate(gap, gap)

    def near(self, unknown, relative=False):
        """`Near` of an unknown; its scale, much memory, only where changes are told ``relative``
        to gap and slip."""
        form, scale = self.form, None
        gap = unknown[:form.nodes] * form.root
        gap += form.initial_gap
        mask = gap < NEAR
        del gap
        mask = mask if form.grid.any(mask) else np.ones_like(mask)
        if relative:
            scale = self.gap(unknown)
            slip = slip_of(scale) if len(scale) > 1 else None
            np.maximum(scale[0], 1.0, out=scale[0])
            if slip is not None:
                np.maximum(slip, 1.0, out=scale[1:])
        return Near(mask.astype(float), form.grid.count(mask), scale)

    def rim_gap(self, gap):
        """Smallest normal gap on the border of the window; inf where it has none."""
        return self.form.grid.minimum(gap[0, self._rim])

    def mean(self, tractions):
        """Mean over the cell, for each component."""
        return self.form.grid.sum(tractions) / self.contact.grid.size

    def response(self, tractions):
        """What the means that move give way to tractions by the body's own compliance."""
        return self.inner * self.mean(tractions)[self.moving]

    def _spread(self, means):
        """Uniform displacements of the means that move, as the first part of an unknown."""
        field = np.zeros(self.form.shape)
        field[self.moving] = means[:, None]
        return field.reshape(-1) / self.form.root

    def _pull(self, means, traction):
        """m' from the means that move and the mean tractions that pull them."""
        held = self.stiffness * (means - self.far[self.moving])
        return -(held + traction - self.target) / self.mass

    def imbalance(self, unknown):
        """w + C t as the first part of an unknown, and m'."""
        form, count = self.form, self.form.count
        residual = form.residual(unknown, np.empty(form.size))
        mean = self._total(residual) / self.contact.grid.size
        return residual[:count] + self._spread(self.inner * mean), self._pull(
            form.scalars(unknown), mean)

    def rate(self, unknown):
        """x': one residual."""
        field, means = self.imbalance(unknown)
        return np.append(self._spread(means) - field, self.form.grid.held(means))

    def newton(self, foretold, shift, known, exactness):
        """x from ``shift`` x - ``known`` = x' by one Newton iteration from a guess, and PETSc's
        reason why its linear solve ended.

        Parameters
        ----------
        foretold : function () -> array of the form's size, the guess: made anew after the linear
            solve, which takes much memory
        shift : float > 0, per unit of time
        known : array of the form's size, an unknown
        exactness : Exactness of its linear solve, unless -jump_ksp_rtol gives one
        """
        form, ksp, count = self.form, self.ksp, self.form.count
        self._linearise(foretold(), shift, known)
        del known  # its memory is that of the linear solve, as is the form's own
        vars(form).pop("work", None)
        self.matrix.assemble()
        part = exactness.part if self._part is None else self._part
        ksp.setTolerances(rtol=part, atol=exactness.left / (1.0 + shift))
        callbacks.solve(ksp, (self._right, self._step))
        self._iterations += ksp.getIterationNumber()
        step, guess = self._step.getArray(), foretold()
        response = np.zeros(len(self.moving))
        if self.inner.any():
            response = self.response(form.stiffen(form.displacement(step), form.work))
        if self._regularised:
            begin = create_vector(form, guess)
            self._regularised(begin, self._step)
            begin.destroy()  # at once: older petsc4py does so late
        step[count:] += form.grid.held(response)
        return np.subtract(guess, step, out=guess), ksp.getConvergedReason()

    def _linearise(self, guess, shift, known):
        """Take the tangent of a step's system at a guess, and its right side: no memory but theirs;
        parameters as of `newton`."""
        form, count, moving = self.form, self.form.count, self.moving
        scale, right = 1.0 + shift, self._right.getArray()
        form.residual(guess, right)
        traction = self._total(right) / self.contact.grid.size
        form.linearise(guess)
        form.tangent /= scale
        means, before = form.scalars(guess), form.scalars(known)
        # A mean that moves with the body's response to it: x stands for m less that response.
        share = 1.0 + shift * self.inner * self.mass / scale
        drag = self.contact.grid.size * self.mass / scale / share
        form.drag[moving] = drag * (shift + self.stiffness / self.mass)
        field, own = right[:count], guess[:count]
        field -= known[:count]
        field /= scale
        for first in range(0, count, PART):
            field[first:first + PART] += shift / scale * own[first:first + PART]
        aside = (self.inner * traction + before - shift * means) / (form.root * scale)
        for place, way in zip(moving, aside):
            field.reshape(form.shape)[place] += way
        right[count:] = form.grid.held(form.row_scale[moving] * drag * (
            shift * means - before - self._pull(means, traction)))

    def _total(self, residual):
        """Sums over the cell of the tractions that pull means that move, by their rows of a
        residual."""
        form, moving = self.form, self.moving
        return (form.scalars(residual) + form.row_target[moving]) / form.row_scale[moving]

    def size(self, change, near, relative=False):
        """How large a change of the unknown is at nodes, ranges: root mean square, or a third of
        the largest.

        Parameters
        ----------
        change : array of the form's size, an unknown
        near : Near, the nodes that count
        relative : bool, whether in parts of gap and slip where these are larger than a range
        """
        grid, scale = self.form.grid, near.scale if relative else None
        weights = getattr(grid, "weights", None)
        told = points.extremes if self.contact.kernels.compiled else extremes
        largest, squares = told(self.form.shape, change, self.form.root, near.mask, scale, weights)
        mean = float(grid.together(squares)) / (self.form.components * near.count)
        return max(math.sqrt(mean), float(grid.largest(largest)) / 3.0)

    def leaving(self, unknown, velocity):
        """The component that is pulled and that no traction will balance as it is, or None. (What
        slides back may be held where it once stuck.)

        Parameters
        ----------
        unknown : array of the form's size
        velocity : of the means that move
        """
        grid, means = self.form.grid, self.form.scalars(unknown)
        for place in np.flatnonzero(self.pulled):
            component, target = self.moving[place], self.target[place]
            if velocity[place] * target <= 0.0:
                continue
            if component == 0 and is_beyond(self.contact.law, grid.minimum(self.gap(unknown)[0]),
                                            target):
                return 0
            if component > 0 and slides_away(means[place], velocity[place]):
                pressed = 0 in self.moving[self.pulled] and self.target[0] < 0.0
                if slides(self.contact.law, grid, self.gap(unknown),
                          abs(target) * self.contact.grid.size, pressed):
                    return component
        return None

    def returned(self, before, after):
        """How far bodies that slide come back in a step, over what they may: half of their slip, or
        a range. Nothing bends a longer one, which would pass what holds them.

        Parameters
        ----------
        before, after : arrays of the form's size, unknowns at the ends of the step
        """
        start, end = (self.form.scalars(unknown)[self.moving > 0] for unknown in (before, after))
        back = (start - end) * np.sign(start)
        return float(np.max(back / np.maximum(0.5 * np.abs(start), 1.0), initial=0.0))


def backward_formula(times, step):
    """c and weights of the last moments, at times before now, with which c x - sum of weights x =
    x' after a step."""
    if len(times) < 2:
        return 1.0 / step, [1.0 / step]
    ratio = -step / times[0]
    return (1.0 + 2.0 * ratio) / (1.0 + ratio) / step, [-ratio ** 2 / (1.0 + ratio) / step,
                                                        (1.0 + ratio) / step]
