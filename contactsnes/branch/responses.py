"""How a contact responds at a point: linear solves with the Jacobian there."""

import numpy as np

from ..contact import states
from ..contact.even_form import EvenForm
from ..contact.forms import DisplacementForm
from ..contact.problem import DISPLACEMENT, FORCE
from ..contact.state import spread
from ..contact.survey import gaps
from ..continuation.points import NotConverged
from ..solvers import callbacks
from ..solvers.capabilities import asked
from ..solvers.krylov import tell_modes
from ..solvers.linear import end_by_residual, exact_jacobian
from ..solvers.precision import pays
from ..solvers.snes import KSP_REASONS, create_snes, idle, kept
from .corrector import Corrector
from .states_of_solves import moved_means

PART = 2 ** 14
"""Nodes that are moved at a time."""
EXACT = 1e-8
"""Relative tolerance of the linear solve for a direction, on which the place of a fold depends."""
BY_RESIDUAL = "CONVERGED_RTOL", "CONVERGED_ATOL", "CONVERGED_HAPPY"
"""How the reasons begin for which a KSP ends by its residual: others tell nothing of it."""
MUCH = 0.2
"""Residual of a direction, over the direction itself, that is too much, however small it is beside
the right side."""


class Responses(Corrector):
    """A corrector that knows how its points respond to their loads."""

    def along_tangent(self, point, leg, position, step):
        """The state of a point of a leg moved along the branch's tangent: one linear solve with the
        Jacobian there.

        Parameters
        ----------
        point, leg : Point, Leg
        position : of the point in the leg
        step : of the position
        """
        state, direction = self.fitted(point.state), leg.direction
        form = self.form_on(state, leg.controls)
        form.set_load(leg.load(position))
        form.linearise(form.packed(state))
        moved = self._linear(self.snes, form,
                             lambda right: form.load_derivative(-direction, right), 1e-3) * step
        far = step * self.contact.far_displacement(form.components, direction)
        means = state.means + moved_means(form, moved, far)
        moved += form.packed(state)
        ahead = self._regularised(form, state, moved, means)
        if form.forced and not form.whole_cell:
            # The mean displacement belonged to another gap than this: it is balanced anew, where
            # the law acts.
            moved = form.packed(ahead)
            aside = form.once(form.residual(moved, np.empty(form.size)))[form.forced]
            near = form.nodal(state)[0] + getattr(form, "half", form).initial_gap < states.NEAR
            moved[form.count:] += form.grid.held(form.grid.sum(aside * near)
                                                 / max(form.grid.count(near), 1))
            means[form.forced] = form.scalars(moved)
        return ahead

    def _regularised(self, form, state, moved, means):
        """The state of an unknown that a state was ``moved`` to, the normal step taken in the
        regularised gap, where a long one into overlap stays bounded.

        Parameters
        ----------
        form : of the equations
        state : State on its window
        moved : array of the form's size
        means : array (components,), ranges of the law, kept as it is
        """
        law, known = self.contact.law, isinstance(form, EvenForm) and state.half is not None
        half = state.half if known and state.half == form.half.window else None
        field = form.displacement(moved) if half is None else form.once(moved)
        begin = state.normal if half is None else state.once[0]
        gap = self.contact.gap_on(half or form.window)
        for first in range(0, len(gap), PART):  # (arrays of all nodes are memory, not needed)
            part = slice(first, first + PART)
            near, moving = begin[part], field[0, part]
            moving -= near
            np.add(near, law.regularised_step(near + gap[part], moving, law.moving_stiffness),
                   out=moving)
        if half is None:
            return states.State(form.window, field, means, state.half)
        return spread(half, field, means)

    def stiffness(self, point):
        """dW/dD at a point, w_n,r/u_n,r or R phi_n/u_n,r, other loads held as they are controlled
        there: one linear solve with the Jacobian, to `EXACT`; nan where that fails, as at a fold, 0
        where no node is within the law's range: a body that nothing holds has no solution.

        D moves by 1 or, of an isolated contact, which has no mean displacement, W does.
        """
        contact, state = self.contact, point.state
        if contact.survey(state).closest >= contact.law.range:
            return 0.0 + contact.datum
        controls = (FORCE if contact.isolated else DISPLACEMENT, *point.controls[1:])
        form = DisplacementForm(contact, state.window, controls)
        form.set_load([(force if control == FORCE else displacement) for control, force,
                       displacement in zip(controls, point.forces, point.displacements)])
        form.linearise(form.pack(state.displacement, state.means[form.forced]))
        try:
            snes = create_snes(form, "" if asked().has_tangent else "arc_",
                               packed=pays(form, self.settings.linear_precision))
            change = self._linear(snes, form, lambda right: form.load_derivative(
                -np.eye(form.components)[0], right), EXACT)
        except NotConverged:
            return np.nan
        tangent = contact.law.tangent(gaps(contact, state))
        response = np.einsum("jn,jn->n", tangent[0], form.displacement(change))
        if not contact.isolated:
            return float(form.factor[0] * contact.grid.sum(response))
        mean = form.scalars(change)[0] + form.rigid_compliance[0] * contact.grid.mean(response)
        return float(-contact.ranges[0] / mean) + contact.datum

    def _linear(self, snes, form, right, tolerance):
        """J^-1 of a ``right`` side, a function that fills an array, at the last linearisation of
        the form of a SNES, by its KSP, in memory of the SNES, to a residual that is a part
        ``tolerance`` of the right side and, where that is much of the answer, of that."""
        ksp = kept(snes.getKSP())
        matrix = exact_jacobian(snes, form)
        tolerances = ksp.getTolerances()
        forcing = snes.getUseEW()
        kind = ksp.getType()
        # Else the SNES would set the tolerance of this solve, too, by how its own last one went.
        snes.setUseEW(False)
        ksp.setOperators(matrix)
        ksp.setTolerances(rtol=tolerance, atol=1e-50)
        tell_modes(ksp, False)
        end_by_residual(snes)
        vectors = idle(snes, form)
        right(vectors[0].getArray())
        callbacks.solve(ksp, vectors)
        self.totals["linear_iterations"] += ksp.getIterationNumber()
        size = vectors[1].norm()
        if ksp.getConvergedReason() > 0 and ksp.getResidualNorm() > MUCH * size > 0.0:
            # A load may move the contact by much less than the body between them gives way.
            ksp.setTolerances(rtol=tolerance * size / vectors[0].norm(), atol=1e-50)
            ksp.setInitialGuessNonzero(True)
            callbacks.solve(ksp, vectors)
            ksp.setInitialGuessNonzero(False)
            self.totals["linear_iterations"] += ksp.getIterationNumber()
        change = vectors[1].getArray()
        ksp.setType(kind)
        ksp.setTolerances(rtol=tolerances[0], atol=tolerances[1])
        tell_modes(ksp, True)
        snes.setUseEW(forcing)
        reason = KSP_REASONS.get(ksp.getConvergedReason(), "none")
        if tolerance <= EXACT and not reason.startswith(BY_RESIDUAL):
            raise NotConverged(f"no direction of the branch: KSP {reason}")
        if form.grid.any(~np.isfinite(change)):
            raise NotConverged("no direction of the branch: it is infinite")
        return change
