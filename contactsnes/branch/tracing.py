"""Along a branch: its tangent at a point, and points by arc length, for a corrector."""

from contextlib import contextmanager, nullcontext

import numpy as np
from petsc4py import PETSc

from ..contact import states
from ..contact.bordered import ArcLength
from ..contact.even_form import EvenForm
from ..contact.forms import DisplacementForm
from ..contact.problem import DISPLACEMENT, FORCE
from ..contact.state import spread
from ..contact.survey import gaps
from ..continuation.points import Direction, NotConverged
from ..dynamics import kicks
from ..solvers import callbacks
from ..solvers.capabilities import asked
from ..solvers.krylov import tell_modes
from ..solvers.linear import exact_jacobian
from ..solvers.precision import pays
from ..solvers.ritz import many
from ..solvers.snes import KSP_REASONS, WARM, create_snes, idle, kept
from . import coarse_motion, crossing
from .corrector import Corrector
from .ends import Ends
from .neighbours import Neighbours
from .states_of_solves import finite, moved_means, refuse_unknown

PART = 2 ** 14
"""Nodes that are moved at a time."""
EXACT = 1e-8
"""Relative tolerance of the linear solve for a direction, on which the place of a fold depends."""
LED = 1e-3
"""The same of states that only lead to those of a finer grid: its sign tells of them."""
MUCH = 0.2
"""Residual of a direction, over the direction itself, that is too much, however small it is beside
the right side."""
TIGHT = 1e-11
"""Residual norm of a fold: next to a bifurcation that is nearly one, its load depends on the
residual a hundredfold."""


@contextmanager
def tightened(snes, form):
    """Let a SNES and its linear solver go to a residual of `TIGHT`."""
    ksp = snes.getKSP()
    outer, inner = snes.getTolerances()[1], ksp.getTolerances()[1]
    snes.setTolerances(atol=min(TIGHT, outer))
    ksp.setTolerances(atol=0.5 * TIGHT * form.linear_tolerance)
    try:
        yield
    finally:
        snes.setTolerances(atol=outer)
        ksp.setTolerances(atol=inner)


class Tracer(Corrector, Neighbours, Ends):
    """The system that continuation asks (``continuation.system.System``): a corrector that knows
    the branch's direction, too, and goes along it by arc length.

    A ``chord``, a pair of states, measures how far a state has gone (``states.chord``). The
    ``examiner`` (`stability.Stability`), if it is given one, counts unstable modes where nobody
    asked for certificates, but a solve met one (``Point.softest``).
    """

    examiner = None
    kicked = kicks.kicked
    settle = coarse_motion.settle
    crossed = crossing.crossed

    def on(self, contact, tolerance):
        """As of `Corrector`."""
        return Tracer(contact, self.settings, self.log, tolerance)

    def told(self, controls, load):
        """Loads in words."""
        return self.contact.scene.loads(controls, load)

    def solve_arc(self, chord, length, guess, position, leg, border=(1.0, 0.0), tight=False):
        """The point at a place of a chord, near a guess and its position in the leg; NotConverged
        otherwise.

        By Newton in the displacement form (options under the prefix ``arc_``) if the user's method
        is another one.

        Parameters
        ----------
        chord : two states, whose difference measures lengths
        length : float, along the chord, ranges of the law
        guess, position, leg : State, float and Leg
        border : what the length counts in the equation that holds it, and a unit of the position,
            from the given one on
        tight : bool, to a residual below which a fold's load hardly depends on it
        """
        length, guess = border[0] * length + border[1] * position, finite(guess)
        for _ in range(6):
            form, arc, snes, start = self._on_chord(chord, length, guess, position, leg, border)
            guess = None  # (much memory)
            refuse_unknown(form.grid, start)
            with tightened(snes, form) if tight else nullcontext():
                unknown, iterations = self.run(arc, start, WARM, snes)
            arc.set_position(arc.position(unknown))
            state = form.state(arc.inner(unknown))
            if not self.covers(form, state, snes):
                guess, position = self.fitted(state, afresh=True), arc.position(unknown)
                continue
            unknown, state, imbalance = self.balanced(form, unknown, state, arc, snes)
            if imbalance is not None:
                arc.set_position(arc.position(unknown))
                point = self._point(form, state, imbalance, iterations, arc.ritz.smallest, snes)
                return point.changed(leg=leg.number, position=float(arc.position(unknown)))
            guess, position = state, arc.position(unknown)
        raise NotConverged("the window kept growing: try -contact_window off")

    def direction(self, point, chord, leg):
        """The branch's direction at a point per unit of length along a chord: one linear solve,
        regular at a fold, too.

        Parameters
        ----------
        point : Point
        chord : two states
        leg : Leg
        """
        form, arc, snes, unknown = self._on_chord(chord, 0.0, point.state, point.position, leg)
        arc.linearise(unknown)
        del unknown  # its memory, and the anchor's, is that of the linear solve
        arc.release("anchor")
        change = self._linear(snes, arc, lambda right: np.copyto(
            right, arc.joined(np.zeros(form.size), 1.0)), LED if self.leads else EXACT)
        own, rate = arc.inner(change), float(arc.position(change))
        far = rate * self.contact.far_displacement(form.components, leg.direction)
        return Direction(states.State(form.window, form.displacement(own),
                                      moved_means(form, own, far)), rate)

    def unit(self, point, direction):
        """A direction at a point per unit of the branch's own length."""
        change = direction.state
        ahead = states.State(change.window, states.onto(point.state, change.window)
                             + change.displacement, point.state.means)
        length = self.chord_length(point.state, ahead)
        if length == 0.0:
            raise NotConverged("no direction of the branch: its state stands still")
        return Direction(states.State(change.window, change.displacement / length,
                                      change.means / length), direction.rate / length)

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
        there: one linear solve with the Jacobian, to `EXACT`; nan where that fails, as at a fold.

        D moves by 1 or, of an isolated contact, which has no mean displacement, W does.
        """
        contact, state = self.contact, point.state
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

    def _on_chord(self, chord, length, guess, position, leg, border=(1.0, 0.0)):
        """Form, form with the arc length, its SNES and its unknown, for a state and position on or
        near a chord."""
        own = asked().has_tangent
        state = self.fitted(guess) if own else states.fitted(self.contact, guess)
        form = (self.bare_form(state, leg.controls) if own
                else DisplacementForm(self.contact, state.window, leg.controls))
        if self.arc is not None and self.arc[0].tangent is not None:
            self.arc[0].release("anchor", "tangent")  # others take their memory
        none = np.zeros(len(form.forced))
        row, way = states.chord(self.contact, *chord, form.window)
        row = form.pack(row, none)
        first, change = (form.pack(states.onto(end, form.window), none) for end in chord)
        change -= first
        row *= border[0] * way / max(form.grid.inner(row, change), 1e-300)
        del change  # its memory is the solver's
        aim = leg.start, leg.direction, first, row, length, border[1]
        if self.arc is None or self.arc[0].form is not form:
            if own:
                self.make_room()
            arc = ArcLength(form, *aim)
            quick = pays(form, self.settings.linear_precision)
            self.arc = arc, create_snes(arc, "" if own else "arc_",
                                        single=quick and many(self.contact), packed=quick)
            self.patience.watch(self.arc[1], self.contact)
        arc, snes = self.arc
        arc.aim(*aim)
        unknown = arc.joined(form.pack(states.onto(state, form.window), state.means[form.forced]),
                             position)
        return form, arc, snes, unknown

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
        if kind == PETSc.KSP.Type.PREONLY:  # good enough for the method, but no tangent
            ksp.setType("fgmres")
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
        if ksp.getConvergedReason() < 0 and tolerance <= EXACT:
            raise NotConverged(
                f"no direction of the branch: KSP {KSP_REASONS[ksp.getConvergedReason()]}")
        if form.grid.any(~np.isfinite(change)):
            raise NotConverged("no direction of the branch: it is infinite")
        return change
