"""The corrector: from a guess, controls and loads to a converged point, whatever the method."""

import time

import numpy as np

from ..contact import states
from ..contact.balance import Balance, Imbalance
from ..contact.force_form import FORMS
from ..contact.problem import APPROACH
from ..continuation.points import NotConverged
from ..dynamics.relaxing import nearer
from ..grid.active import Nodes
from ..scene.load import units
from ..solvers.capabilities import of_snes, tolerated
from ..solvers.convergence import norm_at_end
from ..solvers.precision import PATIENCE, trusted
from ..solvers.regularised import step_from_afar
from ..solvers.ritz import stirred
from ..solvers.snes import KSP_REASONS, SNES_REASONS, WARM, end_of, ended_early, solve
from .equations import Equations
from .states_of_solves import balanced_point, finite

TURNED = (f"a linear solve is slow: it went on in double precision after {PATIENCE} iterations "
          "(-contact_linear_precision)")


class Corrector(Equations):
    """Makes converged points of its equations, and counts what was spent.

    Parameters
    ----------
    contact, settings, log, tolerance : as of `Equations`
    """

    certified = False  # whether somebody looks for the modes of its points
    leads = False  # whether its points only lead to those of a finer grid

    def __init__(self, contact, settings, log=lambda sentence: None, tolerance=None):
        super().__init__(contact, settings, log, tolerance)
        self._ended = None
        self.totals = dict.fromkeys(("nonlinear_iterations", "linear_iterations",
                                     "function_evaluations", "jacobian_products"), 0)
        self.balance, self._units = Balance(contact), units(contact.scene)
        self._balanced = None, None  # the last state that was asked for its imbalance, and that
        self._accounted = self._spent_so_far()

    @property
    def allowed(self):
        """Residual norm that points have at most, whichever SNES finds them."""
        return tolerated(self.prefix) if self.tolerance is None else self.tolerance

    def _spent_so_far(self):
        """Everything spent since the beginning."""
        counter = self.contact.grid.counter
        return {**self.totals, "transforms": counter.transforms,
                "transforms_single": counter.transforms_single, "wall_time": time.perf_counter()}

    def on(self, contact, tolerance):
        """One for another grid of the contact, whose tolerance of the residual norm may differ."""
        return Corrector(contact, self.settings, self.log, tolerance)

    def account(self):
        """What was spent since the last call, by name."""
        now, before = self._spent_so_far(), self._accounted
        self._accounted = now
        return {name: now[name] - before[name] for name in now}

    def solve(self, guess, controls, load, most_iterations=WARM):
        """The converged point at given loads near a guess; NotConverged otherwise. The window grows
        when a solution asks.

        Parameters
        ----------
        guess : State
        controls, load : of each component (u_n,r, u_t,r or w_n,r, w_t,r)
        most_iterations : of Newton's method, after which the solve has failed
        """
        guess = states.with_components(finite(guess), len(controls))
        self.symmetry.loaded_by(load)
        if self.settings.first == "relaxation" and not FORMS[self.settings.form].whole_cell:
            guess = self.symmetry.checked(nearer(self, guess, controls, load,
                                                 self.settings.first_tolerance))
        for _ in range(6):
            guess = self.fitted(guess)
            form = self.form_on(guess, controls)
            form.set_load(load)
            unknown, guess = stirred(form, form.packed(guess), self.certified), None  # (not held)
            unknown, iterations = self.run(form, unknown, most_iterations)
            state = form.state(unknown)
            if not self.covers(form, state, self.snes):
                guess = self.fitted(state, afresh=True)
                continue
            unknown, state, imbalance = self.balanced(form, unknown, state)
            if imbalance is not None:
                return self._point(form, state, imbalance, iterations, form.ritz.smallest,
                                   self.snes)
            guess = state
        raise NotConverged("the window kept growing: try -contact_window off")

    def run(self, form, unknown, most_iterations, snes=None):
        """Run the SNES from an unknown, which the solution overwrites; it and the iterations, or
        NotConverged with PETSc's reasons by name.

        Parameters
        ----------
        form : of the SNES
        unknown : array of the form's size, overwritten
        most_iterations : of Newton's method; None: as options say
        snes : SNES, if not the corrector's own
        """
        snes = snes or self.snes
        newton, before, products = of_snes(snes).has_tangent, form.evaluations, form.products
        self.patience.short = warm = most_iterations == WARM
        step_from_afar(form, not warm)
        near = most_iterations is not None and most_iterations <= WARM
        turned, form.precision.allowed = form.precision.turned, trusted(form, near)
        if newton and most_iterations and not form.bounded:
            snes.setTolerances(max_it=most_iterations)
        form.last_norm = None
        solve(snes, form, unknown)
        if form.precision.turned > turned == 0:
            self.log(TURNED)
        self._ended = end_of(snes, form) if newton else None
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
                               f"iterations, residual {norm_at_end(snes, form):.2e}, inner "
                               f"KSP {inner}")
        # (those of other methods say nothing about the length of a step)
        return unknown, iterations if newton else 0

    def balanced(self, form, unknown, state, system=None, snes=None):
        """(unknown, state, Imbalance) of what a SNES found, by the full form's residual; no
        Imbalance where symmetry was given up.

        Parameters
        ----------
        form : of the equations
        unknown, state : what was found
        system, snes : the form and the SNES that found it, if not ``form`` and its own
        """
        snes = self.snes if snes is None else snes
        found = self._imbalance(form, state, snes)
        tolerance = snes.getTolerances()[1]
        own = norm_at_end(snes, form if system is None else system)
        if own <= tolerance < found.norm <= 2.0 * tolerance:
            # The two differ by rounding: a little more accuracy is kept than was asked for.
            snes.setTolerances(atol=0.5 * tolerance)
            try:
                unknown, _ = self.run(form if system is None else system, unknown.copy(), WARM,
                                      snes)
                if system is not None:
                    system.set_position(system.position(unknown))
                state = form.state(unknown[:form.size])
                found = self._imbalance(form, state, snes)
            except NotConverged:
                pass
            finally:
                snes.setTolerances(atol=tolerance)
        if own <= tolerance < found.norm and form.even:
            self.symmetry.leave(
                f"the residual of all nodes is {found.norm:.2e}, that of half of them {own:.2e}")
            found = None
        return unknown, state, found

    def _imbalance(self, form, state, snes):
        """The Imbalance of what a SNES found at all nodes of its window, or of those within the
        law's range where that is the cell.

        States that only lead to others, on coarser grids or at a given approach, have that of their
        solver.
        """
        if ((self.leads or APPROACH in form.controls)
            and form.in_displacements and of_snes(snes).has_tangent):
            left = snes.getFunction()[0].getArray(readonly=True)[:form.size]
            return Imbalance(self.contact.grid.norm(left), np.nan)
        if form.whole_cell:
            window = states.fitted(self.contact, state).window
            state = states.State(window, states.onto(state, window), state.means)
        if self._balanced[0] is not state:
            self.totals["function_evaluations"] += 1
            self._balanced = state, self.balance(state, form.controls, form.load, form,
                                                   self._ended)
        return self._balanced[1]

    def covers(self, form, state, snes):
        """Whether all nodes outside a state's window are certainly out of the law's range.

        Parameters
        ----------
        form, state, snes : the state, and the form and SNES that led to it
        """
        some = isinstance(state.window, Nodes)  # whose residual tells of the whole cell
        closest = self._imbalance(form, state, snes).closest if some else None
        return states.covers(self.contact, state, closest)

    def _point(self, form, state, imbalance, iterations, softest, snes):
        """The Point of a state that passes the test of convergence; NotConverged for one that does
        not.

        Parameters
        ----------
        form, state, imbalance, iterations, softest, snes : what was solved and found, and how
        """
        contact, allowed = self.contact, self.allowed
        if not imbalance.norm <= allowed:
            raise NotConverged(f"the solver stopped at residual_norm {imbalance.norm:.2e}, above "
                               f"-snes_atol {allowed:g}{ended_early(snes)}")
        closest = contact.survey(state).closest
        if closest < contact.law.deepest:
            raise NotConverged(f"a gap of {closest:.3g} delta_n lies below "
                               f"{contact.law.deepest:g}, where the law is only "
                               "a continuation")
        return balanced_point(contact, form, state, imbalance, units=self._units, softest=softest,
                              spent={"last_iterations": iterations})
