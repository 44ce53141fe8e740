"""Overdamped motion of a contact under fixed loads, followed in time to rest.

Nothing but w = -C tau with tau' = t - tau (see `viscous`) has to be known off the window: tau is
the part of the tractions that the body's elasticity carries, t - tau that of its viscosity.

Steps are those of the second backward differentiation formula, of variable length, with one Newton
iteration from a quadratic predictor. How far that led, where the law acts, is the measure of the
error that controls the next step.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..contact import places, scattered, states
from ..continuation.points import lagrange_weights
from ..grid.cell import Convolution
from ..options.fields import Options, option
from ..solvers.krylov import large
from ..solvers.vectors import collect
from .control import CAREFUL, MANY, Exactness, control
from .endings import Circling, Leaving, Rounds, Unsettled
from .outside import Outside
from .step_works import Moment, combined, displacements, gone_on, step_works
from .viscous import Equations, backward_formula

RESTING = 1e-6
"""Speed where the law acts, ranges a relaxation time, that counts as none where a motion begins."""
ENDLESS = 30.0
"""Time for which nothing may hold back a body that slides before it is said to slide for ever,
relaxation times.

Meanwhile the contact may still grow.
"""
REFUSED = 1.5
"""Error of a step over the tolerance from which on it is tried again, shorter."""
SHORTEST, LATEST = 1e-8, 1e12
"""Time step below which a motion cannot be followed, and time after which none comes to rest any
more, relaxation times."""


@dataclass(frozen=True)
class MotionOptions(Options):
    """Options of the motion of a jump."""

    prefix: ClassVar[str] = "jump_motion_"
    title: ClassVar[str] = "Motion of a jump"
    type: str = option("overdamped", "overdamped (a body that creeps, on the "
                       "window) or inertial (FIRE on the whole cell)",
                       choices=("overdamped", "inertial"))
    kick: float = option(0.1, "how far beyond a fold the motion begins, root "
                         "mean square where the law acts", "ranges of the law", above=0)
    tolerance: float = option(0.005, "error of a step of the overdamped motion, where the law acts",
                              "ranges of the law", above=0)
    steps: int = option(3000, "steps of the overdamped motion after which it is given up",
                        minimum=1)


class OverdampedMotion:
    """The motion from a state: its steps, its window and its works.

    Parameters
    ----------
    contact : Contact
    symmetry : symmetry.Symmetry
    controls, load : of each component
    state : State, on the window to begin with: in balance with the law outside of it
    totals : dict of counts (``linear_iterations``, ``function_evaluations``,
        ``jacobian_products``), which are added to
    options : MotionOptions
    precision : str, of transforms inside linear solves, as of ``-contact_linear_precision``
    elastic : array (components, nodes of the window), tractions of the body; None: those of the law
    measured : bool, whether works are summed up

    Attributes
    ----------
    steps : linear systems solved
    fastest : largest speed of a step, ranges a relaxation time
    works : array (2, components), done on the interface and against viscosity: sums over nodes,
        phi_i
    """

    def __init__(self, contact, symmetry, controls, load, state, totals, options=MotionOptions(),
                 precision="double", elastic=None, measured=True):
        self.contact, self.symmetry = contact, symmetry
        self.controls, self.load, self.totals = controls, load, totals
        self.options, self._precision = options, precision
        self.steps = 0
        self.measured = measured
        self.works = np.zeros((2, len(controls)))
        self.fastest = 0.0
        self._control = control(contact, symmetry, len(controls), elastic is not None, measured)
        self._rounds = Rounds()
        self._begin(0.0, state, elastic)
        self._speed = self._size_now(self._rate)

    def _begin(self, time, state, elastic=None):
        """Take up the motion on a state's window; tau is t unless it is given there."""
        self._equip(state.window)
        equations = self.equations
        unknown = equations.pack(state.displacement, state.means)
        elastic = equations.traction(unknown) if elastic is None else equations.folded(elastic)
        unknown[equations.form.count:] += equations.form.grid.held(equations.response(elastic))
        self.history, self._rate = [Moment(time, unknown, elastic)], equations.rate(unknown)
        self._next = min(1.0, max(0.5 * self.options.tolerance, self._control.still)
                         / max(self._size_now(self._rate), RESTING))

    def _equip(self, window):
        """Make the equations on a window."""
        even = self.symmetry.plain(len(self.controls))
        self.equations = self._outside = None
        collect()  # what the motion had on a smaller window
        self.equations = Equations(self.contact, window, even, self.controls, self.load,
                                   self._precision)
        self._outside = Outside(self.contact, self.equations,
                                self.symmetry.scatters(len(self.controls)))

    def make_room(self):
        """Give back large equations, whose memory others take, until the motion goes on."""
        if self.equations is not None and large(self.equations.form):
            self._left = self.equations.window, displacements(self.equations), self.means()
            self.equations = self._outside = None
            collect(True)

    def _size_now(self, change):
        """`Equations.size` of a change where the motion is now."""
        return self.equations.size(change, self.equations.near(self.history[-1].unknown))

    def means(self):
        """Means of the displacements over the cell now, (components,)."""
        equations, now = self.equations, self.history[-1]
        means = equations.far - self.contact.rigid_compliance(len(self.controls)) * equations.mean(
            now.elastic)
        means[equations.moving] = (equations.form.scalars(now.unknown)
                                   - equations.response(now.elastic))
        return means

    def state(self):
        """Where the motion is now: made anew, as it takes much memory."""
        own = self.equations
        window, displacement, means = self._left if own is None else (
            own.window, displacements(own), self.means())
        return states.State(window, displacement(self.history[-1].unknown), means)

    def follow(self, rest=RESTING, part=0.0):
        """Follow the motion until it slows down below a speed ``rest`` where the law acts, or below
        a part of the largest that it has had.

        Raises Leaving where it has no end, Unsettled where it cannot be followed.
        """
        options, self._held = self.options, self.history[-1].time
        if self.equations is None:
            self._equip(self._left[0])
        step = self._next
        self._exactness = Exactness(self._control.exactness, min(1e-4 * options.tolerance, rest))
        while self.steps < options.steps and self.history[-1].time < LATEST:
            error, moment = self._tried(step)
            if moment is None:
                step *= max(0.25, 0.8 * error ** (-1.0 / 3.0)) if error < np.inf else 0.25
                if step < SHORTEST:
                    raise Unsettled(f"its time steps became too short, fastest {self._place()}")
                continue
            last, (moved, velocity) = self._speed, self._arrive(moment, step)
            slow = max(rest, part * self.fastest)
            calm = self._speed < slow and (self._speed <= last or self._speed < 1e-3 * slow)
            covered = self._outside.free(self, sure=calm)
            if covered and calm:
                self._next = step
                return
            self._check_end(moment, velocity, moved)
            step *= min(2.0, 0.9 * max(error, 1e-3) ** (-1.0 / 3.0))
            if not covered:
                self._widen()
                step *= 0.3
        raise Unsettled(f"it has not come to rest after {self.steps} steps, fastest "
                        f"{self._place()}")

    def _arrive(self, moment, step):
        """Go on to a moment; the length of the step there, and how fast the means move in it."""
        if self.measured:
            self._account(moment, step)
        change = moment.unknown - self.history[-1].unknown
        self.history = gone_on(self.history, moment)
        moved, self._rate = self._size_now(change), None
        self._speed = moved / step
        self.fastest = max(self.fastest, self._speed)
        return moved, self.equations.form.scalars(change) / step

    def _check_end(self, moment, velocity, moved):
        """Raise Leaving or Circling of a motion without one.

        Parameters
        ----------
        moment : Moment, at the end of a step
        velocity : of the means that move
        moved : float, length of the step
        """
        lost = self.equations.leaving(moment.unknown, velocity)
        self._held = moment.time if lost is None else self._held
        if lost == 0 or moment.time - self._held > ENDLESS:
            raise Leaving
        if self._rounds.closed(moment, moved, self._size_now):
            raise Circling(f"it goes round and round, every {self._rounds.period:.3g} relaxation "
                           f"times, fastest {self._place()}")

    def _place(self):
        """Where the motion is fastest, in words."""
        equations, (before, now) = self.equations, (self.history[0], self.history[-1])
        moved = before.unknown if before is not now else self._rate
        near = equations.near(now.unknown)
        speed = equations.unfolded(np.abs(equations.displacement(moved)) * near.mask)
        return places.largest(self.contact, equations.window, speed.max(axis=0))

    def _tried(self, step):
        """Error of a step over the tolerance (inf where it failed), and the moment to which it
        leads; None beyond `REFUSED`."""
        if self.steps >= MANY and self._control in CAREFUL:
            self._control = CAREFUL[self._control]
            self._exactness.part = min(self._exactness.part, self._control.exactness)
        equations, history, allowed = self.equations, self.history, self._control
        now = history[-1]
        times = [moment.time - now.time for moment in history[-2:]]
        shift, weights = backward_formula(times, step)
        before = equations.spent()
        unknown, reason = equations.newton(lambda: self._predicted(step), shift,
                                           combined(history[-2:], weights), self._exactness)
        self.steps += 1
        for name, count in equations.spent().items():
            self.totals[name] += count - before[name]
        if reason <= 0 or self.contact.grid.any(~np.isfinite(unknown)):
            return np.inf, None
        error, moved = self._missed(self._predicted(step), unknown)
        self._exactness.after(error > 0.5 and moved < allowed.still, reason)
        if not error <= REFUSED:
            return error, None
        # The same formula for tau' = t - tau.
        elastic = combined(history[-2:], weights, "elastic")
        elastic += equations.traction(unknown)
        elastic /= 1.0 + shift
        return error, Moment(now.time + step, unknown, elastic)

    def _missed(self, guess, unknown):
        """The same error of a step to an unknown, and its length; its guess is overwritten."""
        equations, now, allowed = self.equations, self.history[-1], self._control
        share, near = 0.2 if len(self.history) > 2 else 0.5, equations.near(now.unknown, True)
        moved = equations.size(unknown - now.unknown, near)
        aside = np.subtract(unknown, guess, out=guess)
        turned = equations.size(aside, near) / max(moved, allowed.still)
        tolerance = allowed.error * self.options.tolerance
        return max(share * equations.size(aside, near, relative=True) / tolerance,
                   turned / allowed.turning, equations.returned(now.unknown, unknown)), moved

    def _predicted(self, step):
        """The unknown after a step by the parabola through the last three, or less where the motion
        has only begun."""
        now = self.history[-1]
        if len(self.history) == 1:
            return now.unknown + step * self._rate
        weights = lagrange_weights([moment.time for moment in self.history], now.time + step)
        return combined(self.history, weights)

    def _account(self, moment, step):
        """Add the works of a step to ``moment`` from the last one."""
        self.works += step_works(self.contact, self.equations, self.history, moment, step)

    def _extended(self):
        """Displacement over the cell (components, *grid): m - C tau off the window."""
        state, contact = self.state(), self.contact
        cell = np.zeros((len(self.controls), *contact.grid.local_shape))
        state.window.put(self.equations.unfolded(self.history[-1].elastic), cell)
        flat = cell.reshape(len(cell), -1)
        Convolution(contact.grid.whole, contact.operator(len(cell)), len(cell),
                    contact.transforms).apply(flat, flat)
        np.subtract(state.means[:, None], flat, out=flat)
        state.window.put(state.displacement, cell)
        return cell

    def _widen(self):
        """Go on on a window that reaches a fifth farther than the law."""
        state, contact, cell = self.state(), self.contact, self._extended()
        gap = cell[0] + contact.initial_gap
        if self.symmetry.scatters(len(self.controls)):
            window = scattered.window(contact, gap)
        else:
            window = contact.window(gap)
            fresh = states.wider(states.State(window, window.take(cell), state.means), window)
            window = self.symmetry.centred(fresh).window
        elastic = np.zeros_like(cell)
        state.window.put(self.equations.unfolded(self.history[-1].elastic), elastic)
        self._rounds.forget()
        self._begin(self.history[-1].time, states.State(window, window.take(cell), state.means),
                    window.take(elastic))
