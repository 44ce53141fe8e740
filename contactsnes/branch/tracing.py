"""Along a branch: its direction at a point, and points by arc length, for a corrector."""

from contextlib import contextmanager, nullcontext

import numpy as np

from ..contact import states
from ..contact.bordered import ArcLength
from ..contact.forms import DisplacementForm
from ..continuation.points import Direction, NotConverged
from ..dynamics import kicks
from ..solvers.capabilities import asked
from ..solvers.precision import pays
from ..solvers.ritz import many
from ..solvers.snes import WARM, create_snes
from . import coarse_motion, crossing
from .ends import Ends
from .neighbours import Neighbours
from .responses import EXACT, Responses
from .states_of_solves import finite, moved_means, refuse_unknown

LED = 1e-3
"""What `EXACT` is for states that only lead to those of a finer grid: the sign of the direction
tells of them."""
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


class Tracer(Responses, Neighbours, Ends):
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
        self.arc[0].aim(*aim)
        del aim, first  # of which the arc holds what it needs
        packed = form.pack(states.onto(state, form.window), state.means[form.forced])
        return form, *self.arc, self.arc[0].joined(packed, position)
