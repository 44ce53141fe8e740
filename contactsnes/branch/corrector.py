"""The corrector: from a guess, controls and loads to a converged point, whatever the method."""

import time
from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from ..contact import acceptance, states
from ..contact.balance import Balance, Imbalance
from ..contact.edges import follow_edge
from ..contact.even_form import EvenForm, Symmetry
from ..contact.forms import ForceForm
from ..contact.problem import APPROACH, FORCE
from ..continuation.points import NotConverged, Point
from ..dynamics import jumps
from ..grid.boxes import in_words
from ..scene.resolution import PINNING, resolution
from ..solvers.snes import COLD, WARM, create_snes, solver_type
from . import first_points


def _names(cls):
    """Value -> name of the enumeration that petsc4py keeps as class attributes."""
    return {value: name for name, value in vars(cls).items() if isinstance(value, int)}


SNES_REASONS, KSP_REASONS = _names(PETSc.SNES.ConvergedReason), _names(PETSc.KSP.ConvergedReason)


def finite(state):
    """A state from which a solve may begin; NotConverged for one that holds infinite values or
    NaN."""
    if not (np.isfinite(state.displacement).all() and np.isfinite(state.means).all()):
        raise NotConverged("the solve cannot begin: its start holds NaN or infinite values")
    return state


class Corrector:
    """Makes converged points: owns the load, the window, the form on it and its SNES, and the count
    of what was spent.

    Parameters
    ----------
    contact : Contact
    settings : Form (options ``-contact_*``)
    log : function (sentence), for what a user should know about a run
    tolerance : of the residual norm, if not the one of -snes_atol
    """

    prefix = ""  # of the options of its SNES

    def __init__(self, contact, settings, log=lambda sentence: None, tolerance=None):
        self.contact = contact
        self.settings = settings
        self.log = log
        self.tolerance = tolerance
        self.form = None
        self.snes = None
        self.boxes = 1
        self.totals = dict.fromkeys(("nonlinear_iterations", "linear_iterations",
                                     "function_evaluations", "jacobian_products"), 0)
        self.symmetry = Symmetry(contact, settings, solver_type(), log)
        self.balance = Balance(contact)
        self._accounted = self._spent_so_far()

    def _spent_so_far(self):
        """Everything spent since the beginning."""
        return {**self.totals, "transforms": self.contact.grid.counter.transforms,
                "wall_time": time.perf_counter()}

    def account(self):
        """What was spent since the last call, by name."""
        now, before = self._spent_so_far(), self._accounted
        self._accounted = now
        return {name: now[name] - before[name] for name in now}

    def told(self, controls, load):
        """Loads in words."""
        return self.contact.scene.loads(controls, load)

    # What continuation asks of states.
    def adapted(self, point, controls, load):
        """The point as one of a leg: with as many components as there are controls, under its
        controls and load."""
        displacements, forces = (np.append(values, np.zeros(len(controls)))[:len(controls)]
                                 for values in (point.displacements, point.forces))
        state = self.symmetry.checked(states.with_components(point.state, len(controls)))
        return replace(point, state=state, controls=controls, load=load,
                       displacements=displacements, forces=forces)

    def extrapolate(self, points, weights):
        """Weighted sum of states at fixed places."""
        return states.combined(self.contact, [point.state for point in points], weights)

    def follow_edge(self, points, weights):
        """Weighted sum of states in coordinates that follow the contact edge, or None."""
        known = [point.state for point in points]
        half = self.symmetry.halves(known[-1])
        return self.symmetry.mirrored(follow_edge(self.contact, known, weights, half))

    def distance(self, first, second):
        """Root mean square distance of two states, ranges of the law."""
        return states.distance(self.contact, first, second)

    def missed(self, guess, state, largest=False):
        """How far a solve ended from its guess where the law acts, ranges of the law: root mean
        square or largest."""
        return states.missed(self.contact, states.with_components(guess, len(state.displacement)),
                             state, largest)

    def strayed(self, guess, last, state):
        """By how much a node ends farther from its prediction than a smooth branch leaves open
        (``acceptance.strayed``)."""
        return acceptance.strayed(self.contact, *self._alike(guess, last, state))

    def doubtful(self, guess, last, state):
        """Whether a jump may be a part of the way to a state (``acceptance.doubtful``)."""
        return acceptance.doubtful(self.contact, *self._alike(guess, last, state))

    def detached(self, guess, last, state, back):
        """Whether the tangent at a state hardly leads back to the last one
        (``acceptance.detached``)."""
        return acceptance.detached(self.contact, *self._alike(guess, last, state), back)

    def _alike(self, *found):
        """States with the components of the last of them."""
        return [states.with_components(state, len(found[-1].displacement)) for state in found]

    def let_go(self, point, leg, position):
        """The fold, at its position, of a body off the flat that a growing force moves; None for
        any other.

        Off the flat a body is attracted only, and less the farther it is away: as the force grows
        to zero, equilibria end out of the law's range, whatever the steps that led there.
        """
        if (point.controls[0] != FORCE or point.in_contact or leg.moving != 0
            or leg.direction[0] <= 0.0):
            return None
        if self.contact.grid.minimum(states.normal_gap(self.contact,
                                                       point.state)) > self.contact.law.range:
            return replace(point, position=position)
        position = -leg.start[0] / leg.direction[0]
        load = leg.load(-leg.start[0] / leg.direction[0])
        if position > 1.0:
            return None
        load[0] = 0.0
        away = states.with_components(states.apart(self.contact), len(load))
        away.displacement[1:], away.means[1:] = point.state.means[1:, None], point.state.means[1:]
        return replace(self.solve(away, leg.controls, load), position=position)

    def lowered(self, point):
        """A state within the law's range for a body that a force moves freely, off the flat; None
        for any other."""
        free = point.controls[0] == FORCE and not point.in_contact
        return states.lowered(self.contact, point.state) if free else None

    def progress(self, origin, ahead, state):
        """How far a state is from ``origin`` towards ``ahead``, as a part of that distance
        (negative: the other way)."""
        return states.progress(self.contact, origin, ahead, state)

    # Solving.
    def start(self, controls, load):
        """The first point: the equilibrium that the undeformed body reaches under given loads.

        A cold solve finds it where the gap is convex; elsewhere, and where that fails, motion
        decides.
        """
        why = self.ambiguous()
        if why is None:
            if not self.contact.convex:
                self.log("the gap is not convex: inertial motion leads to the "
                         "first point, and where several equilibria exist it "
                         "may be another one than overdamped motion reaches")
            try:
                return self.cold(controls, load)
            except NotConverged as error:
                why = f"no cold solve ({error})"
        self.log(f"{why}: the first point is where motion from the undeformed body leads")
        undeformed = first_points.beginning(self.contact, controls, load)
        return self.settle(undeformed, controls, load,
                           f"at {self.told(controls, load)} from the undeformed body")

    def ambiguous(self):
        """Why a cold solve may end elsewhere than the undeformed body, in words; None if not."""
        relaxed = self.settings.form == "force"
        if relaxed and solver_type() == "python":
            return None
        if not self.contact.convex:
            return "the gap is not convex, so that several equilibria may exist"
        if not relaxed and max(resolution(self.contact.scene, sheared=False)) > PINNING:
            return ("edges stick between nodes of so coarse a grid, where "
                    "Newton's method may find an unstable branch")
        return None

    def cold(self, controls, load):
        """The point at given loads that the body reaches from the start without overlap, without
        friction first."""
        point = first_points.first_point(self, controls[:1], load[:1])
        return point if len(controls) == 1 else self.solve(point.state, controls, load, COLD)

    def on(self, contact, tolerance):
        """A corrector for the contact on a coarser grid whose costs are this one's; None if no grid
        but its own serves it."""
        form = self.settings
        if not (form.cascade and form.form == "displacement" and form.first == "none"
                and solver_type().startswith("newton")):
            return None
        system = Corrector(contact, self.settings, self.log, tolerance)
        system.totals = self.totals
        return system

    def solve(self, guess, controls, load, most_iterations=WARM):
        """The converged point at given loads near a guess; NotConverged otherwise. The window grows
        when a solution asks."""
        guess = states.with_components(finite(guess), len(controls))
        if self.settings.first == "relaxation" and self.settings.form == "displacement":
            guess = jumps.handed_over(self, guess, controls, load)
        for _ in range(6):
            guess = self._fitted(guess)
            form = self._form_for(guess, controls)
            form.set_load(load)
            unknown, iterations = self._newton(form,
                                               form.pack(guess.displacement,
                                                         guess.means[form.forced]), most_iterations)
            state = self._state(form, unknown)
            if not states.covers(self.contact, state):
                guess = states.fitted(self.contact, state, afresh=True)
                continue
            unknown, state, imbalance = self._balanced(form, unknown, state)
            if imbalance is not None:
                return replace(self._point(form, state, imbalance, iterations),
                               softest=form.ritz.smallest)
            guess = state
        raise NotConverged("the window kept growing: try -contact_window off")

    def kicked(self, fold, beyond, part):
        """The state beside a fold, a point, at a part of -jump_motion_kick along its null vector,
        or towards ``beyond``."""
        return jumps.kicked(self.contact, fold, beyond, part)

    def settle(self, state, controls, load, where, origin=None):
        """The equilibrium that motion from a state, beside ``origin``, reaches at fixed load;
        NoEquilibrium where there is none."""
        return jumps.settle(self, state, controls, load, where, origin)

    def _fitted(self, state):
        """The state on the window that the settings and the law ask for."""
        widest = self.contact.widest
        whole = self.settings.window == "off" or self.settings.form == "force"
        if not whole:
            state = states.fitted(self.contact, state)
            # Coarser grids for the full approximation scheme are made of one window.
            whole = len(state.window.parts) > 1 and solver_type() == "fas"
        if whole and state.window != widest:
            state = states.State(widest, widest.take(self.contact.extended(state)), state.means)
        return self.symmetry.centred(state)

    def _form_for(self, guess, controls):
        """The form on the guess's window, kept with its SNES while window and controls stay."""
        kept = self.form
        kind = ForceForm if self.settings.form == "force" else self.symmetry.form(len(controls))
        if (type(kept) is not kind or kept.window != guess.window
            or kept.controls != tuple(controls)):
            if len(guess.window.parts) != self.boxes:
                self.boxes = len(guess.window.parts)
                self.log(in_words(guess.window))
            self.form = kind(self.contact, *(() if kind is ForceForm else (guess.window,)),
                             controls)
            self.snes = create_snes(self.form, self.prefix, self.tolerance)
        return self.form

    def _newton(self, form, unknown, most_iterations, snes=None):
        """Run the SNES from an unknown, which is overwritten; the solution and its iterations.

        Raises NotConverged with PETSc's reasons by name.
        """
        snes = self.snes if snes is None else snes
        newton = snes.getType().startswith("newton")
        if newton and most_iterations and not PETSc.Options(snes.getOptionsPrefix()
                                                            or "").hasName("snes_max_it"):
            snes.setTolerances(max_it=most_iterations)
        if not np.isfinite(unknown).all():
            raise NotConverged("the solve cannot begin: its start holds NaN or infinite values")
        solution = PETSc.Vec().createWithArray(unknown, comm=PETSc.COMM_SELF)
        before, products = form.evaluations, form.products
        snes.solve(None, solution)
        iterations, reason = snes.getIterationNumber(), snes.getConvergedReason()
        self.totals["nonlinear_iterations"] += iterations
        own = snes.getPythonContext() if snes.getType() == "python" else None
        self.totals["linear_iterations"] += getattr(own, "linear_iterations",
                                                    snes.getLinearSolveIterations())
        self.totals["function_evaluations"] += form.evaluations - before
        self.totals["jacobian_products"] += form.products - products
        if reason <= 0:
            inner = KSP_REASONS.get(snes.getKSP().getConvergedReason(), "none")
            raise NotConverged(f"SNES {SNES_REASONS.get(reason, reason)} after {iterations} "
                               f"iterations, residual {snes.getFunctionNorm():.2e}, inner "
                               f"KSP {inner}")
        # Iterations of other methods say nothing about the length of a step.
        return solution.getArray().copy(), iterations if newton else 0

    def _state(self, form, unknown):
        """The state that a form's unknown stands for."""
        displacement = form.displacement(unknown).copy()
        if form.name == "force":
            return self.symmetry.checked(states.State(form.window, displacement,
                                                      form.grid.mean(displacement)))
        traction = self.contact.law.traction(form.gap(unknown))
        means = (self.contact.far_displacement(form.components, form.load) - form.rigid_compliance
                 * form.grid.mean(traction))
        means[form.forced] = form.scalars(unknown)
        return states.State(form.window, displacement, means)

    def _balanced(self, form, unknown, state, system=None, snes=None):
        """(unknown, state, Imbalance) of what a SNES found, by the full form's residual; no
        Imbalance where symmetry was given up.

        Parameters
        ----------
        form : of the equations
        unknown, state : what was found
        system, snes : the form and the SNES that found it, if not ``form`` and its own
        """
        snes, found = self.snes if snes is None else snes, self._imbalance(form, state)
        tolerance, own = snes.getTolerances()[1], snes.getFunctionNorm()
        if own <= tolerance < found.norm <= 2.0 * tolerance:
            # The two differ by rounding: a little more accuracy is kept than was asked for.
            snes.setTolerances(atol=0.5 * tolerance)
            try:
                unknown, _ = self._newton(form if system is None else system, unknown.copy(), WARM,
                                          snes)
                if system is not None:
                    system.set_position(unknown[-1])
                state = self._state(form, unknown[:form.size])
                found = self._imbalance(form, state)
            except NotConverged:
                pass
            finally:
                snes.setTolerances(atol=tolerance)
        if own <= tolerance < found.norm and isinstance(form, EvenForm):
            self.symmetry.leave(
                f"the residual of all nodes is {found.norm:.2e}, that of half of them {own:.2e}")
            found = None
        return unknown, state, found

    def _imbalance(self, form, state):
        """The Imbalance of a solution at all nodes of its window, or of those within the law's
        range where that is the cell.

        States that only lead to others, on coarser grids or at a given approach, have that of their
        solver.
        """
        if ((self.tolerance is not None or APPROACH in form.controls)
            and form.name == "displacement" and self.snes.getType().startswith("newton")):
            return Imbalance(self.contact.grid.norm(self.snes.getFunction()[0].getArray(
                readonly=True)), np.nan)
        if form.name == "force":
            window = states.fitted(self.contact, state).window
            state = states.State(window, states.onto(state, window), state.means)
        self.totals["function_evaluations"] += 1
        return self.balance(state, form.controls, form.load, form)

    def _point(self, form, state, imbalance, iterations):
        """The Point of a state that passes the test of convergence; NotConverged for one that does
        not."""
        contact = self.contact
        grid = self.contact.grid
        components = form.components
        gap = state.displacement.copy()
        gap[0] = states.normal_gap(contact, state)
        tolerance = self.snes.getTolerances()[1]
        deepest = grid.minimum(gap[0])
        if not imbalance.norm <= tolerance:
            raise NotConverged("the solver stopped at residual_norm "
                               f"{imbalance.norm:.2e}, above -snes_atol {tolerance:g}")
        if deepest < contact.law.deepest:
            raise NotConverged(f"a gap of {deepest:.3g} delta_n lies below "
                               f"{contact.law.deepest:g}, where the law is only "
                               "a continuation")
        traction = contact.law.traction(gap)
        factor, ranges = contact.load_factor(components), contact.ranges[:components]
        forces = factor * grid.sum(traction)
        far = state.means + contact.rigid_compliance(components) * grid.mean(traction)
        displacements = contact.signs(components) * far / ranges + contact.datum
        for i, control in enumerate(form.controls):
            if control != APPROACH:
                (forces if control == FORCE else displacements)[i] = form.load[i]
        touching = gap[0] < contact.scene.contact_threshold
        slipped = np.linalg.norm(gap[1:], axis=0) > contact.law.slip_peak
        in_contact = grid.count(touching) > 0
        sliding = components > 1 and in_contact and grid.count(touching & ~slipped) == 0
        return Point(state, form.controls, form.load.copy(), displacements, forces, in_contact,
                     sliding, imbalance.norm, largest_residual=imbalance.largest,
                     spent={"last_iterations": iterations})
