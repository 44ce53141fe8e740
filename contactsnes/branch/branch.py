"""The Python face: from a scene and a load path to its branch of converged points."""

from dataclasses import replace

import numpy as np

from ..contact import energies, observables
from ..contact.observables import STIFFNESS
from ..contact.problem import DISPLACEMENT, FORCE
from ..contact.symmetry import refuse
from ..continuation import path, steppers
from ..continuation.natural import NaturalSteps
from ..continuation.points import Leg, NotConverged
from ..continuation.predictors import PREDICTORS
from ..dynamics.overdamped import MotionOptions
from ..dynamics.stability import SIGN, Stability, refuse_without_tangent
from ..interface import shapes
from ..options.arguments import sealed, unpicklable
from ..options.database import check_names, check_values
from ..output import resuming
from ..scene import settings as scenes
from ..scene.load import controls_along, names, quantities
from ..scene.parts import for_branch, sources
from ..scene.resolution import PINNING, resolution
from ..solvers.capabilities import asked, has_modes, refuse_build
from ..solvers.registry import OPTIONS
from . import failures, first_points, kept_points, restarting
from .contacts import contact_of, refuse_unlike
from .grid_choice import chosen
from .remarks import Remarks, unmarked
from .too_large import refuse_too_large
from .tracing import Tracer

SOLVER_OPTIONS = (*OPTIONS, MotionOptions)
"""Dataclasses of the options of our own PC and SNES types, and of motions."""


@unpicklable("pickle scene, load and points, and go on with Branch(..., history=points)")
@sealed("a branch", "make another one, Branch(scene, load, ...), which goes on from points of this "
        "one where they lie on its path too, history=points", ("history", "_history", "first"))
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
    first : State near which the first point is, in place of what the undeformed body reaches

    Raises
    ------
    InputError : at once, where load and scene do not fit, the history does not lie on the path,
        PETSc's database holds a name under our prefixes that is none, or PETSc is too old or has
        other numbers than real ones in double precision
    NotConverged, NoEquilibrium : while iterating, after all points before the failure
    """

    def __init__(self, scene, load, steps=None, form=None, log=lambda sentence: None, history=(),
                 law=None, geometry=None, body=None, first=None):
        refuse_build()
        self.steps, form = scenes.of_run(scene, load, steps, form)
        check_names(SOLVER_OPTIONS)
        check_values(SOLVER_OPTIONS)
        scene = for_branch(scene, law, geometry, body)
        scene = chosen(scene, load)
        self.scene, self.load, self._log = scene, load, log
        refuse_unlike(scene, load, self.steps, form)
        scenes.check(scene, load, self.steps)
        refuse_too_large(scene, load, form)
        self.contact = contact_of(scene, load, form, log)
        grid = self.contact.grid
        self._checksum = resuming.checksum(grid, shapes.of(scene).heights(scene, grid))
        self._sheared, loaded = scenes.tangential_legs(scene, load), scenes.loaded_legs(scene, load)
        refuse(self.contact, self._sheared, loaded, form, self.method)
        refuse_without_tangent(self.steps.stability, form)
        steppers.refuse(self.steps, self.method)
        self.corrector = Tracer(self.contact, form, log)
        self.stability = Stability(self.corrector,
                                   self.steps.stability) if self.steps.stability != "off" else None
        self.corrector.certified = self.stability is not None
        # Branches of grids that pin bend at every node, and are marked as not resolved.
        examiner = Stability(self.corrector, SIGN, told=True)
        self._examiners = [
            examiner if max(resolution(self.contact.scene, bool(tangential))) <= PINNING else None
            for tangential in loaded]
        self.corrector.examiner = self._examiners[0]
        self._resting = FORCE if scene.isolated else DISPLACEMENT
        self.legs = scene.legs(load)
        self._controls = controls_along(scene.initial(load), self.legs)
        self.history, self.first = history, restarting.beside(first, self.contact)
        self._predictor = PREDICTORS[self.steps.predictor]
        self._sealed = True

    @classmethod
    def restart(cls, archive, path, point=-1, *, stop="none", **options):
        """The branch that begins at a point of an archive, with other legs.

        Parameters
        ----------
        archive : path of an archive, or a Record; its scene is taken
        path : str, legs as of ``Load``
        point : int, from 0 or, if negative, from the end; one of the last four, or with fields
            (of isolated contacts on active nodes)
        stop : str, as of ``Load``
        options : steps, form, log as of the class
        """
        record, point, scene, load = restarting.beginning(archive, point, path, stop)
        branch = cls(scene, load, **options)
        branch.first = restarting.state_at(branch, record, point)
        return branch

    def __repr__(self):
        return f"<Branch of {self.scene!r}, {self.load!r}>"

    @property
    def history(self):
        """Points of an earlier run to go on from, oldest first, with their places on this path;
        InputError for others."""
        return self._history

    @history.setter
    def history(self, points):
        """Take the points of an earlier run."""
        earlier = restarting.earlier(points, self.contact)
        self._history = resuming.on_path(earlier, self.scene.initial(self.load), self.legs,
                                         self._controls, self.scene.loads)

    @property
    def method(self):
        """What the type of SNES that the user asks for can do (`solvers.capabilities`)."""
        return asked()

    def attributes(self):
        """Name -> value of what decides the states besides the load: of the scene and its files."""
        found = scenes.attributes(self.scene)
        if self.scene.isolated:
            # Forces of legs that are yet to come may ask for a larger one.
            found["box_points"] = self.contact.grid.shape
        found |= {"heights_sha256": self._checksum} if self._checksum else {}
        return found | sources(self.scene)

    def __iter__(self):
        points = self._points()
        while True:
            with self.contact.turn:
                point = next(points, None)
            if point is None:
                return
            yield point

    def _points(self):
        """The points, of which only one thread at a time asks for the next."""
        last = self.history[-1] if self.history else None
        remarks = Remarks(self.corrector, self.stability is not None,
                          has_modes(self.corrector.settings), self._log, last)
        makers = [lambda points, number=number: self._leg(number, points, remarks)
                  for number in range(1, len(self.legs) + 1)]
        stepper = steppers.stepper(self.steps, self.scene.dimension == 1 or self.contact.convex)
        points = path.branch(self.corrector, self._start, makers, predictor=self._predictor,
                             at_fold=self.steps.at_fold, stops=self.load.stops,
                             history=self.history if self.stability else unmarked(self.history),
                             certify=self.stability or (lambda point: point),
                             at_bifurcation=self.steps.at_bifurcation,
                             stepper=stepper)
        works = energies.PathEnergies(self.contact, self.history)
        grid = failures.Resolution(self.contact, self._log, last)
        try:
            for point in map(grid.marked, map(works.completed, points)):
                yield remarks.marked(point).sealed()
        except NotConverged as error:
            raise failures.explained(error, self.contact, any(self._sheared),
                                     lambda: self._modes(remarks.last, remarks.leg), remarks.last,
                                     remarks.unstable_since(), steppers.others(stepper),
                                     self._nearly) from None

    def _nearly(self):
        """A point near the first one, for what can be told of it; None without any."""
        initial = self.scene.initial(self.load)
        return first_points.nearly(self.corrector, [initial[0].control],
                                   np.array([initial[0].value]))

    def _modes(self, last, leg):
        """Modes of the last point under the controls of the leg under way; None without one, or a
        tangent."""
        if last is None or not has_modes(self.corrector.settings):
            return None
        if leg is not None and tuple(last.controls) != leg.controls:
            last = self.corrector.adapted(last, leg.controls, leg.start)
        return Stability(self.corrector, SIGN).best(last)

    def observe(self, point, names=None):
        """Name -> value of everything that a point can tell (``observables.table``), or of some
        names only; its ``stiffness``, which takes a linear solve, by its name only."""
        names = observables.named(names, observables.table(self.scene), STIFFNESS)
        others = [name for name in names if name != STIFFNESS]
        found = observables.observe(self.contact, point, others)
        return {name: found[name] if name in found else self.stiffness(point) for name in names}

    def stiffness(self, point):
        """dW/dD at a point (`Responses.stiffness`), in the units of the scene."""
        size, _ = self.scene.scale(observables.STIFFNESS_UNITS[self.scene.dimension])
        with self.contact.turn:
            return size * self.corrector.stiffness(observables.found_on(self.contact, point))

    def packed(self, point):
        """Arrays, numbers and strings from which ``restored`` makes the point again."""
        return kept_points.packed(self.contact, observables.found_on(self.contact, point))

    def restored(self, packed):
        """The point that was ``packed``; InputError for one that another version of this program
        packed."""
        return kept_points.restored(self.contact, packed)

    def _start(self):
        """The first point, at -load_start: without tangential load, then in steps to the one asked
        for.

        Where motion decides, it begins with the undeformed body under all loads.
        """
        initial = self.scene.initial(self.load)
        count = self.scene.components if self._sheared[0] else 1
        at_once = count if first_points.ambiguous(self.corrector) else 1
        if self.first is not None:
            controls, values = zip(*(initial[component] for component in range(count)))
            point = self.corrector.solve(self.first, controls, np.array(values))
            return self._certified(replace(point, spent=self.corrector.account()))
        controls = (*[initial[component].control for component in range(at_once)],
                    *[self._resting] * (count - at_once))
        values = np.array([initial[component].value if component < at_once else 0.0
                           for component in range(count)])
        point = first_points.start(self.corrector, controls, values)
        point = replace(point, spent=self.corrector.account())
        leg = self._leg_to(0, initial, count, [point], lambda length: (0.1 * length, 0.25 * length,
                                                                       1e-6 * length))
        if leg is None:
            asked = np.array([initial[component].value for component in range(count)])
            return self._certified(self.corrector.adapted(point, self._controls[0][:count], asked))
        spent = dict(point.spent)
        for point in NaturalSteps(self.corrector, leg, [(0.0, point)], self._predictor,
                                  "jump"):
            spent = {name: spent[name] + point.spent[name] for name in spent}
        point = replace(point, position=0.0, step=0.0, origin=None, event=None, fold_kind="",
                        fold_precision=0.0, spent=spent)
        return self._certified(point)

    def _certified(self, point):
        """The first point with its stability, if that is asked for, and the cost of it."""
        if self.stability is None:
            return point
        point, more = self.stability(point), self.corrector.account()
        return replace(point, spent={name: value + more[name]
                                     for name, value in point.spent.items()})

    def _leg(self, number, points, remarks):
        """The continuation's leg from the last point, or None where nothing moves."""
        count = self.scene.components if self._sheared[number] else 1
        leg = self._leg_to(number, self.legs[number - 1].controls, count, points,
                           lambda length: self.steps.sizes(number, length))
        self.corrector.examiner = self._examiners[number]
        if leg is not None:
            remarks.begun(leg)
        return leg

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
        self.corrector.symmetry.loaded_by(start, end)
        return Leg(number, controls, start, end, moving, initial, largest, smallest).at_once()
