"""The Python face: from a scene and a load path to its branch of converged points."""

from dataclasses import replace

import numpy as np

from ..contact import energies, observables
from ..contact.even_form import refuse
from ..contact.isolated import IsolatedContact, lay_out
from ..contact.problem import DISPLACEMENT, FORCE, Contact
from ..contact.states import State
from ..continuation import natural, walks
from ..continuation.points import Leg, NotConverged, Point
from ..dynamics.overdamped import MotionOptions
from ..dynamics.stability import SIGN, Stability, refuse_without_tangent
from ..grid.boxes import of_boxes
from ..interface import shapes
from ..interface.gap import refuse_contact_at_edge
from ..options.database import check_names, check_values
from ..options.fields import InputError
from ..output import resuming
from ..scene import settings as scenes
from ..scene.isolation import check_form, largest_force
from ..scene.load import controls_along, names, quantities
from ..scene.parts import sources, with_parts
from ..scene.resolution import PINNING, resolution
from ..solvers.multigrid import GridsOptions
from ..solvers.preconditioners import CoreOptions
from ..solvers.pseudotime import PseudoOptions
from ..solvers.snes import NewtonOptions, solver_type
from ..solvers.stepping import AdaptiveOptions, FireOptions, KineticOptions, VerletOptions
from . import failures
from .grid_choice import chosen
from .too_large import refuse_too_large
from .tracing import Tracer

SOLVER_OPTIONS = (NewtonOptions, GridsOptions, CoreOptions, VerletOptions, AdaptiveOptions,
                  KineticOptions, FireOptions, PseudoOptions, MotionOptions)
"""Dataclasses of the options of our own PC and SNES types, and of motions."""

KEPT = ("leg", "position", "step", "arc", "load", "displacements", "forces", "in_contact",
        "sliding", "residual_norm", "largest_residual", "event", "fold_kind", "elastic_energy",
        "interfacial_energy", "smooth_steps", "jump_work", "viscous_work", *energies.WORKS,
        "stable", "unstable_modes", "leading_eigenvalue", "resolved", "fold_precision", "softest")
"""What of a point, besides its state, controls and origin, an archive keeps for going on from
it."""

DILUTED = 100.0
"""Largest imbalance of a node over the tolerance of their root mean square from which on a run says
so: that of one node alone, were it all there is, in a window of 10^4 unknowns."""


class Branch:
    """The branch of equilibria of a scene along a load path: iterate over it to get its converged
    points.

    Parameters
    ----------
    scene : Scene
    load : Load, as it is typed: in SI where the scene is
    steps : Steps, optional; as they are typed, too
    form : Form, optional
    log : function (sentence), optional; called with what a user should know
    law, geometry, body : Law, Shape and Body, optional, in place of the scene's: objects of classes
        of one's own, perhaps; a geometry may be a function gap(x) or gap(x, y) of the coordinates
    history : points of an earlier run along this path to go on from, oldest first; its last leg may
        end farther ahead

    Raises
    ------
    InputError : at once, where load and scene do not fit, the history does not lie on the path,
        or PETSc's database holds a name under our prefixes that is none
    NotConverged, NoEquilibrium : while iterating, after all points before the failure
    """

    def __init__(self, scene, load, steps=None, form=None, log=lambda sentence: None, history=(),
                 law=None, geometry=None, body=None):
        check_names(SOLVER_OPTIONS)
        check_values(SOLVER_OPTIONS)
        scene = chosen(with_parts(scene, law, geometry, body), load)
        self.scene, self.load = scene, load
        self.steps = scenes.Steps() if steps is None else steps
        scenes.check(scene, load, self.steps)
        form = scenes.Form() if form is None else form
        refuse_too_large(scene, load, form)
        shape = shapes.of(scene)
        self._heights = shape.heights(scene)
        if scene.isolated:
            check_form(form)
            self.contact = IsolatedContact(lay_out(scene, largest_force(scene, load)))
        else:
            self.contact = Contact(scene, self._heights)
            refuse_contact_at_edge(shape, self.contact)
        self._sheared = scenes.tangential_legs(scene, load)
        refuse(self.contact, self._sheared, form, solver_type())
        refuse_without_tangent(self.steps.stability, form, solver_type())
        walks.refuse(self.steps, solver_type())
        self.corrector = Tracer(self.contact, form, log)
        self.stability = Stability(self.corrector,
                                   self.steps.stability) if self.steps.stability != "off" else None
        # Branches of grids that pin bend at every node, and are marked as not resolved.
        if max(resolution(self.contact.scene, any(self._sheared))) <= PINNING:
            self.corrector.examiner = Stability(self.corrector, SIGN, told=True)
        self._resting = FORCE if scene.isolated else DISPLACEMENT
        self.legs = scene.legs(load)
        self._controls = controls_along(scene.initial(load), self.legs)
        self.history = history
        self._log = log
        self._ways = {}
        self._diluted = False

    @property
    def history(self):
        """Points of an earlier run to go on from, oldest first, with their places on this path;
        InputError for others."""
        return self._history

    @history.setter
    def history(self, points):
        """Take the points of an earlier run."""
        self._history = resuming.on_path(points, self.scene.initial(self.load), self.legs,
                                         self._controls, self.scene.loads)

    def attributes(self):
        """Name -> value of what decides the states besides the load: the scene's, and what is made
        of it and its files."""
        found = scenes.attributes(self.scene)
        if self.scene.isolated:
            # Forces of legs that are yet to come may ask for a larger one.
            found["box_points"] = self.contact.grid.shape
        if self._heights is not None:
            found["heights_sha256"] = resuming.checksum(self._heights)
        return found | sources(self.scene)

    def __iter__(self):
        makers = [lambda points, number=number: self._leg(number, points)
                  for number in range(1, len(self.legs) + 1)]
        points = natural.branch(self.corrector, self._start, makers, predictor=self.steps.predictor,
                                at_fold=self.steps.at_fold, stops=self.load.stops,
                                history=self.history, certify=self.stability
                                or (lambda point: point), at_bifurcation=self.steps.at_bifurcation,
                                walker=walks.walker(self.steps))
        ledger = energies.Ledger(self.contact, self.history)
        self._last, self._under_way = self.history[-1] if self.history else None, None
        grid = failures.Resolution(self.contact, self._log, self._last)
        try:
            for point in map(grid.marked, map(ledger.entered, points)):
                point = self._not_held(self._not_stable(point))
                self._last = point
                self._say_what_is_diluted(point)
                yield point
        except NotConverged as error:
            raise failures.explained(error, self.contact, any(self._sheared), self._modes) from None

    def _modes(self):
        """Modes of the last point under the controls of the leg under way; None without one, or a
        tangent."""
        last, leg = self._last, self._under_way
        if last is None or not self._has_tangent():
            return None
        if leg is not None and tuple(last.controls) != leg.controls:
            last = self.corrector.adapted(last, leg.controls, leg.start)
        return Stability(self.corrector, SIGN).modes(last, None)

    def _has_tangent(self):
        """Whether the method has a tangent whose modes can be found."""
        return self.corrector.settings.form == "displacement" or solver_type().startswith("newton")

    def observe(self, point):
        """Name -> value of everything that a point can tell (``observables.table``)."""
        return observables.observe(self.contact, point)

    def packed(self, point):
        """Arrays, numbers and strings from which ``restored`` makes the point again."""
        state = point.state
        return {**{name: getattr(point, name) for name in KEPT}, "displacement": state.displacement,
                "means": state.means, "window_start": np.array(state.window.start),
                "window_shape": np.array(state.window.shape),
                "forced": np.array([control == FORCE for control in point.controls]),
                "origin": point.load if point.origin is None else point.origin}

    def restored(self, packed):
        """The point that was ``packed``; InputError for one that another version of this program
        packed."""
        lost = [name for name in KEPT if name not in packed]
        if lost:
            raise InputError("a point to go on from says nothing of "
                             f"{', '.join(lost)}: it was kept by another version "
                             "of this program; begin anew")
        window = of_boxes(self.contact.grid, packed["window_start"], packed["window_shape"])
        state = State(window, np.array(packed["displacement"]), np.array(packed["means"]))
        controls = tuple(FORCE if forced else DISPLACEMENT for forced in packed["forced"])
        return Point(state=state, controls=controls, origin=np.array(packed["origin"]),
                     **{name: packed[name] for name in KEPT})

    def _start(self):
        """The first point, at -load_start: without tangential load, then in steps to the one asked
        for.

        Where motion decides, it begins with the undeformed body under all loads.
        """
        initial = self.scene.initial(self.load)
        count = self.scene.components if self._sheared[0] else 1
        at_once = count if self.corrector.ambiguous() else 1
        controls = (*[initial[component].control for component in range(at_once)],
                    *[self._resting] * (count - at_once))
        values = np.array([initial[component].value if component < at_once else 0.0
                           for component in range(count)])
        point = replace(self.corrector.start(controls, values), spent=self.corrector.account())
        leg = self._leg_to(0, initial, count, [point], lambda length: (0.1 * length, 0.25 * length,
                                                                       1e-6 * length))
        if leg is None:
            asked = np.array([initial[component].value for component in range(count)])
            return self._certified(self.corrector.adapted(point, self._controls[0][:count], asked))
        spent = dict(point.spent)
        for point in natural.Walk(self.corrector, leg, [(0.0, point)], self.steps.predictor,
                                  "jump"):
            spent = {name: spent[name] + point.spent[name] for name in spent}
        point = replace(point, position=0.0, step=0.0, origin=None, event="none", fold_kind="",
                        fold_precision=0.0, spent=spent)
        return self._certified(point)

    def _certified(self, point):
        """The first point with its stability, if that is asked for, and the cost of it."""
        if self.stability is None:
            return point
        point, more = self.stability(point), self.corrector.account()
        return replace(point, spent={name: value + more[name]
                                     for name, value in point.spent.items()})

    def _leg(self, number, points):
        """The continuation's leg from the last point, or None where nothing moves."""
        count = self.scene.components if self._sheared[number] else 1
        leg = self._leg_to(number, self.legs[number - 1].controls, count, points,
                           lambda length: self.steps.sizes(number, length))
        if leg is not None:
            self._say_what_turns_back(leg)
            self._say_what_a_switch_frees(points[-1], leg)
            self._under_way = leg
        return leg

    def _say_what_is_diluted(self, point):
        """Say once that a node is much worse balanced than the mean over the window's, which may be
        far more than the contact's."""
        # nothing is solved for further events at a point of an earlier run
        if self._diluted or self.corrector.snes is None:
            return
        tolerance = self.corrector.snes.getTolerances()[1]
        if point.largest_residual > DILUTED * tolerance:
            self._diluted = True
            self._log("a node where the law acts is out of balance by "
                      f"{point.largest_residual:.1e} ranges (largest_residual), at a "
                      f"residual_norm of {point.residual_norm:.1e} over a window "
                      f"of {point.state.window.size} nodes: the mean hides what "
                      "is wrong in a few of them; a smaller -snes_atol "
                      "balances these, too")

    def _say_what_turns_back(self, leg):
        """Say once that a tangential load which turns back makes no hysteresis by itself."""
        if self._ways is None:
            return
        ways = {component: np.sign(way) for component, way in enumerate(leg.direction) if component
                and way}
        turned = any(way * self._ways.get(component, way) < 0 for component, way in ways.items())
        self._ways = None if turned else self._ways | ways
        if turned:
            self._log(f"leg {leg.number} takes a tangential load back: these "
                      "laws have no memory, so that a path without "
                      "folds retraces itself and shows no frictional "
                      "hysteresis; energy is lost in jumps only")

    def _say_what_a_switch_frees(self, last, leg):
        """Say of a leg that lets go of a displacement and moves another one whether it begins at an
        unstable point.

        Where nobody checks stability, and only there; of a leg that moves forces alone its first
        step tells at no cost.
        """
        freed = any(pair == (DISPLACEMENT, FORCE) for pair in zip(last.controls, leg.controls))
        pulled = any(control == DISPLACEMENT and way != 0.0
                     for control, way in zip(leg.controls, leg.direction))
        if self.stability is not None or last.leg == leg.number or not (freed and pulled
                                                                        and self._has_tangent()):
            return
        begun = replace(self.corrector.adapted(last, leg.controls, leg.start), event="none",
                        tangents=())
        found = (self.corrector.examiner or Stability(self.corrector, SIGN, told=True))(begun)
        if found.unstable_modes > 0:
            self._log(f"leg {leg.number} begins on an unstable part of the "
                      f"branch: at {self.corrector.told(leg.controls, leg.start)} "
                      f"{found.unstable_modes} modes are unstable now that a "
                      "force holds what a displacement held; "
                      "-continuation_stability sign certifies points")

    def _not_stable(self, point):
        """A first point or the end of a jump marked, and told, where it is not stable and nobody
        checks: its linear solves tell."""
        examiner = self.corrector.examiner
        if (self.stability is not None or examiner is None or not point.softest < 0.0
            or not (point.leg == 0 or point.event == "jump")):
            return point
        modes = examiner(replace(point, event="none", tangents=())).unstable_modes
        if modes <= 0:
            return point
        what = "the end of a jump" if point.event == "jump" else "the first point"
        self._log(f"{what}, at {self.corrector.told(point.controls, point.load)}, is not "
                  f"stable: {modes} modes are unstable; -continuation_stability "
                  "sign certifies points, and follows jumps on")
        return replace(point, stable=0, unstable_modes=modes)

    def _not_held(self, point):
        """A point marked where the force that moves does not hold the body, if nobody checks
        stability; told where its leg begins there.

        A displacement that goes against its force does so on an unstable part of the branch: what
        was stable while the displacement was held need not be so under the force.
        """
        last = self._last
        if self.stability is not None or last is None or point.event == "jump":
            return point
        if point.state is last.state and point.leg == last.leg and point.event != "fold":
            return replace(point, stable=last.stable)
        count = len(last.controls)
        forced = np.array([control == FORCE for control in point.controls[:count]])
        moved = point.displacements[:count] - last.displacements
        changed = point.forces[:count] - last.forces
        if (moved[~forced] != 0.0).any() or changed[forced] @ moved[forced] >= 0.0:
            return point
        if point.leg != last.leg:
            self._log(f"leg {point.leg} begins on an unstable part of the "
                      f"branch: at {self.corrector.told(point.controls, point.load)} the "
                      "displacement goes against the force; -continuation_stability "
                      "sign tells more")
        alone = np.count_nonzero(changed[forced]) == 1 and point.event != "fold"
        return replace(point, stable=0) if alone else point

    def _leg_to(self, number, named, count, points, sizes):
        """A leg from the last point to named controls and values (None: held), or None where
        nothing moves.

        What controls each component follows from the path alone: legs that moved nothing have left
        no point.
        """
        last, controls = points[-1], self._controls[number][:count]
        reached = {DISPLACEMENT: last.displacements, FORCE: last.forces}
        reached = {control: np.append(values, np.zeros(count - len(values)))
                   for control, values in reached.items()}
        start = np.array([reached[control][i] for i, control in enumerate(controls)])
        if last.leg == number and last.origin is not None:
            start = last.origin
        end = start.copy()
        for component in set(named) & set(range(count)):
            if named[component].value is not None:
                end[component] = named[component].value
        moving = next((component for component in named if component < count
                       and end[component] != start[component]), None)
        if moving is None:
            return None
        # Steps are typed in the unit of what moves.
        unit = quantities(self.scene.dimension)[names(self.scene.dimension)[moving,
                                                                            controls[moving]]].unit
        length = abs(end[moving] - start[moving]) * self.scene.scale(unit)[0]
        initial, largest, smallest = np.array(sizes(length)) / length
        return Leg(number, controls, start, end, moving, initial, largest, smallest)
