"""PETSc's nonlinear solver around the contact problem, and the corrector that makes converged points with it."""

import time
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from . import states
from .contact import FORCE, ArcLength, DisplacementForm, ForceForm
from .continuation import NoEquilibrium, NotConverged, Point
from .laws import DEEPEST, SLIP, SOFTENING
from .options import read
from .settings import option, Options

COLD, WARM = 200, 16
"""Most Newton iterations of a first point, and of a step: a step that needs more is better made shorter."""


def _names(cls):
    """Value -> name of the enumeration that petsc4py keeps as class attributes."""
    return {value: name for name, value in vars(cls).items() if isinstance(value, int)}


SNES_REASONS, KSP_REASONS = _names(PETSc.SNES.ConvergedReason), _names(PETSc.KSP.ConvergedReason)


@dataclass(frozen=True)
class NewtonOptions(Options):
    """Options of Newton's step that PETSc does not have."""

    prefix: ClassVar[str] = "snes_regularised_"
    title: ClassVar[str] = "Newton in the regularised gap"
    gap: bool = option(True, "take Newton's step in w = a + t_n(a)/kappa, where the repulsion is no exponential")
    stiffness: float = option(0.2, "kappa, above the law's steepest softening 0.135", "phi_n/delta_n^2", above=SOFTENING)


class Jacobian:
    """PETSc's Mat context: the exact Jacobian of a form, matrix-free."""

    def __init__(self, form):
        self.form = form

    def mult(self, mat, x, y):
        """y = J x."""
        self.form.apply_jacobian(x.getArray(readonly=True), y.getArray())

    def view(self, mat, viewer):
        """What -snes_view prints of the operator."""
        viewer.printfASCII(f"  contact Jacobian, {self.form.name} form: {self.form.components} component(s) on "
                           f"{self.form.nodes} nodes, {self.form.size - self.form.count} scalar unknown(s)\n")


class RegularisedStep:
    """Line-search pre-check: replaces Newton's step by the one taken in the regularised gap (pointwise, no transform)."""

    def __init__(self, form, stiffness):
        self.form, self.stiffness = form, stiffness

    def __call__(self, x, y):
        """Change the step y (the update is x - y) where it is long; True if it was changed."""
        form = self.form
        step = y.getArray()[:form.count].reshape(form.shape)[0]
        far = np.abs(step) * form.root > 0.1
        if not far.any():
            return False
        gap = form.gap(x.getArray(readonly=True))[0][far]
        step[far] = -form.contact.law.regularised_step(gap, -form.root * step[far], self.stiffness) / form.root
        return True


def create_snes(form, most_iterations=COLD, prefix=""):
    """The SNES of a form, set up by our defaults and then by the user's options.

    Defaults: newtonls with full steps in the regularised gap, matrix-free Jacobian, fgmres with the form's own
    preconditioner, Eisenstat-Walker forcing 0.5 (|F|/|F_old|)^1.6 from 0.1, -snes_atol 1e-8, -snes_rtol and -snes_stol 0.
    """
    database = PETSc.Options(prefix)
    # Older petsc4py destroys objects late; their forms hold memory of the problem's size.
    getattr(PETSc, "garbage_cleanup", lambda: None)()
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setOptionsPrefix(prefix)
    work = PETSc.Vec().createSeq(form.size)
    snes.appctx = form
    snes.setFunction(lambda snes, x, f: form.residual(x.getArray(readonly=True), f.getArray()), work)
    matrix = PETSc.Mat().createPython([form.size, form.size], Jacobian(form), comm=PETSc.COMM_SELF)
    matrix.setUp()

    def linearise(snes, x, operator, preconditioner):
        form.linearise(x.getArray(readonly=True))
        # Assembling tells PETSc that the preconditioner has to be set up again.
        operator.assemble()
        if preconditioner.handle != operator.handle:
            preconditioner.assemble()

    snes.setJacobian(linearise, matrix, matrix)
    snes.setTolerances(rtol=0.0, atol=1e-8, stol=0.0, max_it=most_iterations)
    if form.name == "force":
        snes.setConvergenceTest(displacement_test, (form,))
    ksp = snes.getKSP()
    ksp.setType("fgmres")
    ksp.setGMRESRestart(60)
    ksp.setTolerances(max_it=300)
    ksp.getPC().setType("python")
    ksp.getPC().setPythonType("contactsnes.preconditioners.ZonePC")
    if not database.hasName("ksp_rtol"):
        snes.setUseEW(True)
        snes.setParamsEW(version=2, rtol_0=0.1, rtol_max=0.1, gamma=0.5, alpha=1.6)
    full_steps = database.getString("snes_type", "newtonls") == "newtonls" and not database.hasName("snes_linesearch_type")
    if full_steps:
        database["snes_linesearch_type"] = "basic"
    snes.setFromOptions()
    if full_steps:
        database.delValue("snes_linesearch_type")
    if not database.hasName("ksp_atol"):
        # Below half the tolerance of the outer iteration a linear solve polishes what nobody asks for.
        ksp.setTolerances(atol=0.5 * snes.getTolerances()[1] * form.linear_tolerance)
    newton = read(NewtonOptions, prefix)
    if newton.gap and snes.getType() == "newtonls":
        snes.setLineSearchPreCheck(RegularisedStep(form, newton.stiffness))
    return snes


def displacement_test(snes, iteration, norms, form):
    """The convergence test of the force form: ``residual_norm``, the displacements that the imbalance stands for."""
    rtol, atol, stol, most = snes.getTolerances()
    function = snes.getFunction()[0]
    norm = form.displacement_norm(snes.getSolution().getArray(readonly=True), function.getArray(readonly=True))
    if not np.isfinite(norm):
        return PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN
    if iteration == 0:
        form.first_norm = norm
    if norm <= atol:
        return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_ABS
    if iteration and norm <= rtol * form.first_norm:
        return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_RELATIVE
    return PETSc.SNES.ConvergedReason.ITERATING


class Corrector:
    """Makes converged points: owns the load, the window, the form on it and its SNES, and the count of what was spent.

    Parameters
    ----------
    contact : Contact
    settings : Form (options ``-contact_*``)
    log : function (sentence), for what a user should know about a run
    """

    def __init__(self, contact, settings, log=lambda sentence: None):
        self.contact, self.settings, self.log = contact, settings, log
        self.form = self.snes = None
        self.totals = dict.fromkeys(("nonlinear_iterations", "linear_iterations", "function_evaluations"), 0)
        self._accounted = self._spent_so_far()

    def _spent_so_far(self):
        """Everything spent since the beginning."""
        return {**self.totals, "transforms": self.contact.grid.transforms, "wall_time": time.perf_counter()}

    def account(self):
        """What was spent since the last call, by name."""
        now, before = self._spent_so_far(), self._accounted
        self._accounted = now
        return {name: now[name] - before[name] for name in now}

    def names(self, controls):
        """Names of the controlled quantities."""
        axes = ["normal", "tangential"] if len(self.contact.grid.shape) == 1 else ["normal", "tangential", "tangential"]
        ends = [""] * 2 if len(self.contact.grid.shape) == 1 else ["", "_x", "_y"]
        return [f"{axis}_{control}{end}" for axis, control, end in zip(axes, controls, ends)]

    # What continuation asks of states.
    def adapted(self, point, controls, load):
        """The point as one of a leg: with as many components as there are controls, under its controls and load."""
        return replace(point, state=states.with_components(point.state, len(controls)), controls=controls, load=load)

    def extrapolate(self, points, weights):
        """Weighted sum of states at fixed places."""
        return states.combined(self.contact, [point.state for point in points], weights)

    def follow_edge(self, points, weights):
        """Weighted sum of states in coordinates that follow the contact edge, or None."""
        return states.follow_edge(self.contact, [point.state for point in points], weights)

    def distance(self, first, second):
        """Root mean square distance of two states, ranges of the law."""
        return states.distance(self.contact, first, second)

    def missed(self, guess, state):
        """How far a solve ended from its guess where the law acts, ranges of the law."""
        return states.missed(self.contact, states.with_components(guess, len(state.displacement)), state)

    def lowered(self, point):
        """A state within the law's range for a body that a force moves freely, off the flat; None for any other."""
        free = point.controls[0] == FORCE and not point.in_contact
        return states.lowered(self.contact, point.state) if free else None

    # Solving.
    def start(self, controls, load):
        """The first point: a cold solve at given loads from the start without overlap.

        Under a prescribed normal force, and where Newton fails, the body is relaxed from there dynamically first.
        """
        state = states.undeformed(self.contact, controls, load)
        if controls[0] != FORCE:
            try:
                return self.solve(state, controls, load, COLD)
            except NotConverged as error:
                self.log(f"the first solve failed ({error}): relaxing the body dynamically")
        return self.settle(state, controls, load, "from the undeformed body")

    def solve(self, guess, controls, load, most_iterations=WARM):
        """The converged point at given loads near a guess; NotConverged otherwise. The window grows when a solution asks."""
        for _ in range(6):
            guess = self._fitted(states.with_components(guess, len(controls)))
            form = self._form_for(guess, controls)
            form.set_load(load)
            unknown, iterations = self._newton(form, form.pack(guess.displacement, guess.means[form.forced]), most_iterations)
            state = self._state(form, unknown)
            if states.covers(self.contact, state):
                return self._point(form, state, self._norm(form, unknown, state), iterations)
            guess = state
        raise NotConverged("the window kept growing: try -contact_window off")

    def solve_arc(self, first, last, before, here, length, leg):
        """The point at arc length ``length`` beyond ``last``, in the direction from ``first`` to it, and its position."""
        last = self._fitted(last)
        form = self._form_for(last, leg.controls)
        pack = [form.pack(states.onto(state, form.window), state.means[form.forced]) for state in (first, last)]
        arc = ArcLength(form, leg.start, leg.direction, pack[1], pack[1] - pack[0], length)
        ahead = length / np.linalg.norm(pack[1] - pack[0])
        guess = np.append(pack[1] + ahead * (pack[1] - pack[0]), here + ahead * (here - before))
        predicted = states.State(form.window, form.displacement(guess), last.means)
        snes = create_snes(arc, WARM)
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
        matrix = self.snes.getJacobian()[0]
        matrix.assemble()
        tolerances = ksp.getTolerances()
        ksp.setOperators(matrix)
        ksp.setTolerances(rtol=1e-3, atol=1e-50)
        right, change = PETSc.Vec().createSeq(size), PETSc.Vec().createSeq(size)
        form.load_derivative(-direction, right.getArray())
        ksp.solve(right, change)
        ksp.setTolerances(rtol=tolerances[0], atol=tolerances[1])
        self.totals["linear_iterations"] += ksp.getIterationNumber()
        moved = unknown + step * change.getArray(readonly=True)
        ahead = step * form.displacement(change.getArray(readonly=True))[0]
        gap = states.normal_gap(self.contact, state)
        # In the regularised gap a long step into overlap stays bounded.
        moved[:form.nodes] = (state.displacement[0] + self.contact.law.regularised_step(gap, ahead, 1.5 * SOFTENING)) / form.root
        scalars = form.scalars(moved)
        means = state.means + step * self.contact.far_displacement(form.components, direction)
        means[form.forced] = scalars
        return states.State(form.window, form.displacement(moved), means)

    def kicked(self, fold, beyond, kick):
        """The state at a distance ``kick`` (ranges, where the law acts) from a fold, in the direction of one beyond it."""
        part = kick / max(states.missed(self.contact, fold, beyond), 1e-12)
        return states.combined(self.contact, [beyond, fold], [part, 1.0 - part])

    def settle(self, state, controls, load, where):
        """The equilibrium that damped motion from a state reaches at fixed load, polished by Newton.

        Raises NoEquilibrium where the body leaves or slides without end, NotConverged where the motion does not settle.
        """
        form = ForceForm(self.contact, controls)
        form.set_load(load)
        unknown = form.pack(self.contact.extended(states.with_components(state, form.components)))
        imbalance = form.residual(unknown, np.empty(form.size))
        first = min(1e-3, 0.03 * form.displacement_norm(unknown, imbalance))
        for tolerance in (first, 1e-2 * first, 1e-8):
            unknown = self._relaxed(form, unknown, tolerance, where)
            relaxed = self._state(form, unknown)
            try:
                point = self.solve(relaxed, controls, load, COLD)
            except NotConverged as error:
                reason = error
                continue
            if states.missed(self.contact, relaxed, point.state) < 0.1:
                return point
            reason = "Newton's solution is not where the motion led"
        raise NotConverged(f"the motion {where} settled, but {reason}")

    def _relaxed(self, form, unknown, tolerance, where):
        """Where FIRE leads from an unknown of the force form, to a tolerance of ``residual_norm``."""
        snes = create_snes(form, prefix="jump_")
        snes.setType("python")
        snes.setPythonType("contactsnes.relaxation.Fire")
        snes.setTolerances(atol=tolerance, max_it=200000)
        snes.setFromOptions()
        try:
            return self._newton(form, unknown, None, snes)[0]
        except NotConverged as error:
            if snes.getPythonContext().escaped:
                loads = ", ".join(f"{name} {value:.6g}" for name, value in zip(self.names(form.controls), form.load))
                raise NoEquilibrium(f"no equilibrium at {loads} {where}: the body leaves or slides without end") from None
            raise NotConverged(f"the motion {where} did not settle: {error}") from None

    def _fitted(self, state):
        """The state on the window that the settings and the law ask for."""
        if self.settings.window == "off" or self.settings.form == "force":
            whole = self.contact.grid.whole
            return state if state.window.is_whole else \
                states.State(whole, self.contact.extended(state).reshape(len(state.displacement), -1), state.means)
        return states.fitted(self.contact, state)

    def _form_for(self, guess, controls):
        """The form on the guess's window, kept with its SNES while window and controls stay."""
        kept = self.form
        if kept is None or kept.window != guess.window or kept.controls != tuple(controls):
            if self.settings.form == "force":
                self.form = ForceForm(self.contact, controls)
            else:
                self.form = DisplacementForm(self.contact, guess.window, controls)
            self.snes = create_snes(self.form)
        return self.form

    def _newton(self, form, unknown, most_iterations, snes=None):
        """Run the SNES from an unknown, which is overwritten; the solution and its iterations.

        Raises NotConverged with PETSc's reasons by name.
        """
        snes = self.snes if snes is None else snes
        if most_iterations and not PETSc.Options(snes.getOptionsPrefix() or "").hasName("snes_max_it"):
            snes.setTolerances(max_it=most_iterations)
        solution = PETSc.Vec().createWithArray(unknown, comm=PETSc.COMM_SELF)
        before = form.evaluations
        snes.solve(None, solution)
        iterations, reason = snes.getIterationNumber(), snes.getConvergedReason()
        self.totals["nonlinear_iterations"] += iterations
        self.totals["linear_iterations"] += snes.getLinearSolveIterations()
        self.totals["function_evaluations"] += form.evaluations - before
        if reason <= 0:
            inner = KSP_REASONS.get(snes.getKSP().getConvergedReason(), "none")
            raise NotConverged(f"SNES {SNES_REASONS.get(reason, reason)} after {iterations} iterations, "
                               f"residual {snes.getFunctionNorm():.2e}, inner KSP {inner}")
        return solution.getArray().copy(), iterations

    def _state(self, form, unknown):
        """The state that a form's unknown stands for."""
        displacement = form.displacement(unknown).copy()
        if form.name == "force":
            return states.State(form.window, displacement, form.grid.mean(displacement))
        traction = self.contact.law.traction(form.gap(unknown))
        means = self.contact.far_displacement(form.components, form.load) - form.rigid_compliance * form.grid.mean(traction)
        means[form.forced] = form.scalars(unknown)
        return states.State(form.window, displacement, means)

    def _norm(self, form, unknown, state, evaluated=True):
        """``residual_norm`` of a solution: always that of the displacement form, whatever method found the state.

        ``evaluated``: the kept SNES ended with F at this very state.
        """
        if evaluated and form.name == "displacement" and self.snes.getType().startswith("newton"):
            return np.linalg.norm(self.snes.getFunction()[0].getArray(readonly=True))
        if form.name == "force":
            window = states.fitted(self.contact, state).window
            state = states.State(window, states.onto(state, window), state.means)
            load, form = form.load, DisplacementForm(self.contact, window, form.controls)
            form.set_load(load)
            unknown = form.pack(state.displacement, state.means[form.forced])
        return np.linalg.norm(form.residual(unknown, np.empty(form.size)))

    def _point(self, form, state, norm, iterations):
        """The Point of a state that passes the test of convergence; NotConverged for one that does not."""
        contact, grid, components = self.contact, self.contact.grid, form.components
        gap = state.displacement.copy()
        gap[0] = states.normal_gap(contact, state)
        tolerance = self.snes.getTolerances()[1]
        deepest = grid.minimum(gap[0])
        if not norm <= tolerance:
            raise NotConverged(f"the solver stopped at residual_norm {norm:.2e}, above -snes_atol {tolerance:g}")
        if deepest < DEEPEST:
            raise NotConverged(f"a gap of {deepest:.3g} delta_n lies below {DEEPEST:g}, where the law is only a continuation")
        traction = contact.law.traction(gap)
        factor, ranges = contact.load_factor(components), contact.ranges[:components]
        forces = factor * grid.sum(traction)
        far = state.means + contact.rigid_compliance(components) * grid.mean(traction)
        displacements = contact.signs(components) * far / ranges
        for i, control in enumerate(form.controls):
            (forces if control == FORCE else displacements)[i] = form.load[i]
        touching = gap[0] < contact.scene.contact_threshold
        slipped = np.linalg.norm(gap[1:], axis=0) > SLIP
        in_contact = grid.count(touching) > 0
        sliding = components > 1 and in_contact and grid.count(touching & ~slipped) == 0
        return Point(state, form.controls, form.load.copy(), displacements, forces, in_contact, sliding, float(norm),
                     spent={"last_iterations": iterations})
