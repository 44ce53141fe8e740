"""Along a branch: its tangent at a point, and points by arc length, for a corrector."""

import numpy as np
from petsc4py import PETSc

from . import states
from .arclength import ArcLength
from .corrector import WARM, Corrector
from .forms import DisplacementForm
from .laws import MOVING_STIFFNESS
from .points import NotConverged
from .snes import create_snes


class Tracer(Corrector):
    """A corrector that knows the branch's direction, too, and goes along it by arc length."""

    def solve_arc(self, first, last, before, here, length, leg):
        """The point at arc length ``length`` beyond ``last``, in the direction from ``first`` to it, and its position.

        By Newton in the displacement form (options under the prefix ``arc_``) if the user's method is another one.
        """
        own = self.snes.getType().startswith("newton")
        last = self._fitted(last) if own else states.fitted(self.contact, last)
        form = self._form_for(last, leg.controls) if own else DisplacementForm(self.contact, last.window, leg.controls)
        pack = [form.pack(states.onto(state, form.window), state.means[form.forced]) for state in (first, last)]
        arc = ArcLength(form, leg.start, leg.direction, pack[1], pack[1] - pack[0], length)
        ahead = length / self.contact.grid.norm(pack[1] - pack[0])
        guess = np.append(pack[1] + ahead * (pack[1] - pack[0]), here + ahead * (here - before))
        predicted = states.State(form.window, form.displacement(guess[:-1]), last.means)
        snes = create_snes(arc, "" if own else "arc_")
        unknown, iterations = self._newton(arc, guess, WARM, snes)
        arc.set_position(unknown[-1])
        state = self._state(form, unknown[:-1])
        if not states.covers(self.contact, state):
            raise NotConverged("the arc-length step left the window")
        aside = self.missed(predicted, state)
        if aside > 0.1 and aside > 0.5 * self.missed(last, state):
            raise NotConverged(f"the arc-length step ended {aside:.3g} ranges from its prediction, perhaps on another branch")
        norm = self._norm(form, unknown[:-1], state, evaluated=False)
        return self._point(form, state, norm, iterations), float(unknown[-1])

    def along_tangent(self, point, leg, position, step):
        """The state of a point of a leg moved along the branch's tangent: one linear solve with the Jacobian there."""
        state, direction = self._fitted(point.state), leg.direction
        form = self._form_for(state, leg.controls)
        form.set_load(leg.load(position))
        unknown = form.pack(state.displacement, state.means[form.forced])
        form.linearise(unknown)
        ksp, size = self.snes.getKSP(), form.size
        # The second of its matrices is ours, too, where the user has products by finite differences (-snes_mf_operator).
        matrix = self.snes.getJacobian()[1]
        matrix.assemble()
        tolerances, forcing, kind = ksp.getTolerances(), self.snes.getUseEW(), ksp.getType()
        # Else the SNES would set the tolerance of this solve, too, by how its own last one went.
        self.snes.setUseEW(False)
        ksp.setOperators(matrix)
        ksp.setTolerances(rtol=1e-3, atol=1e-50)
        if kind == PETSc.KSP.Type.PREONLY:  # good enough for the method, but no tangent
            ksp.setType("fgmres")
        right, change = PETSc.Vec().createSeq(size), PETSc.Vec().createSeq(size)
        form.load_derivative(-direction, right.getArray())
        ksp.solve(right, change)
        ksp.setType(kind)
        ksp.setTolerances(rtol=tolerances[0], atol=tolerances[1])
        self.snes.setUseEW(forcing)
        self.totals["linear_iterations"] += ksp.getIterationNumber()
        moved, gap = unknown + step * change.getArray(readonly=True), states.normal_gap(self.contact, state)
        field = form.displacement(moved)
        # In the regularised gap a long step into overlap stays bounded.
        ahead = self.contact.law.regularised_step(gap, field[0] - state.displacement[0], MOVING_STIFFNESS)
        field[0] = state.displacement[0] + ahead
        moved = form.pack(field, form.scalars(moved))
        if form.name == "displacement" and form.forced:
            # The mean displacement belonged to another gap than this: it is balanced anew, where the law acts.
            aside, near = form.displacement(form.residual(moved, np.empty(size))), gap < states.NEAR
            moved[form.count:] += self.contact.grid.sum(aside[form.forced][:, near]) / max(self.contact.grid.count(near), 1)
        means = state.means + step * self.contact.far_displacement(form.components, direction)
        means[form.forced] = form.scalars(moved)
        return states.State(form.window, form.displacement(moved), means)
