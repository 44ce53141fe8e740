"""Errors of points: each is solved again on a finer grid, whose solution is nearly exact beside it.

The errors that are left on the finer grid decide what it has to be (`refinement`). Without friction
they fall as a power of e with the spacing once the cohesive zone is resolved: half the spacing will
do. Under shear nodes cross corners of the law (an overlap that ends, a peak that is passed), whose
errors fall with the spacing squared, on the mean, and take either sign: a quarter on lines, a third
on planes, where a quarter tells little more and half the spacing told less than a third of the
error at one point of fourteen. The edge of contact, which is interpolated between nodes, is found
anew on half the finer spacing.

A shift of the same grid would be cheaper, but shows only the part of an error that depends on where
nodes lie.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..contact import states
from ..contact.isolated import IsolatedContact
from ..contact.observables import Measurement, Observable
from ..contact.problem import FORCE, Contact
from ..continuation.points import NoEquilibrium, NotConverged, TooCoarse
from ..grid.cell import Grid, Transform
from ..grid.transfer import resampled
from ..interface import shapes
from ..options.fields import as_text
from ..scene.resolution import PINNING, resolution
from ..scene.settings import Form, tangential_legs
from ..solvers.capabilities import tolerated
from .coarser import finer_gap, refined
from .corrector import Corrector
from .grid_choice import next_grid, refinement

ASTRAY = 1.0
"""Ranges of the law, root mean square, that the finer grid's solution may be away where the law
acts."""

MOST = 5
"""Grids that are given up for finer ones, at most."""

SLOWEST = 0.5
"""Largest ratio of the traction's shortest waves on the finer grid to those on the grid itself
where an estimate holds."""


class Errors(NamedTuple):
    """Relative errors of a point (absolute ones where a value is below one, or what a cell smaller
    than that can hold).

    normal_force : of the force, or of the normal displacement where the force is controlled
    contact_area, slip : of the length or area in contact, and of the mean tangential displacement
    tangential_force : of the force, or of the tangential displacement where the force is controlled
    trusted : whether the estimates hold; the others are nan where there is nothing to go by
    """

    normal_force: float = np.nan
    contact_area: float = np.nan
    slip: float = np.nan
    tangential_force: float = np.nan
    trusted: bool = False

    def largest(self):
        """The larger error of force and area, 0 where nothing is known."""
        known = [error for error in self[:2] if not np.isnan(error)]
        return max(known, default=0.0)


class Reference(Corrector):
    """A corrector of points that are nearly right: Newton in the displacement form, whatever the
    method of the run."""

    prefix = "error_"

    def __init__(self, contact, window):
        super().__init__(contact, Form(window=window, linear_precision="double"),
                         tolerance=max(1e-12, min(1e-10, 1e-2 * tolerated())))


class Estimator:
    """Estimates the errors of points of a contact.

    Parameters
    ----------
    contact : Contact
    form : Form, for its window

    Attributes
    ----------
    transforms : what estimates have taken so far, in those of the contact's cell
    """

    def __init__(self, contact, form=Form()):
        self.contact, self.form = contact, form
        self._finer, self._last = {}, (None, None)

    @property
    def transforms(self):
        """Transforms of estimates so far, in units of one of the contact's whole cell."""
        weights = {ratio: ratio ** len(self.contact.grid.shape) for ratio in self._finer}
        return sum(weights[ratio] * system.contact.grid.counter.weighed
                   for ratio, (system, _) in self._finer.items())

    def __call__(self, point):
        """The errors of a point; those of a fold are not known, since other grids have it at other
        loads."""
        if point.event == "fold":
            return Errors()
        state, errors = self._last
        if state is not point.state:
            errors = self._estimate(point)
            self._last = point.state, errors
        return errors

    def _estimate(self, point):
        system, finest = self._on(refinement(len(self.contact.grid.shape),
                                             len(point.controls) > 1))
        guess = refined(self.contact, system.contact, point.state)
        try:
            exact = system.solve(guess, point.controls, point.load)
        except (NotConverged, NoEquilibrium):
            return Errors()
        values, finer = self._values(point), self._values_of(exact, system.contact, finest)
        # Below its own tolerance the finer solution is not exact either.
        errors = [max(np.linalg.norm(np.subtract(value, better)) / max(np.linalg.norm(value),
                                                                       least), system.tolerance)
                  for value, better, least in zip(values, finer, self._least(point))]
        resolved = max(resolution(self.contact.scene, len(point.controls) > 1)) <= PINNING
        near = states.missed(system.contact, guess, exact.state) < ASTRAY
        errors[2:] = [error * (len(point.controls) > 1) for error in errors[2:]]
        return Errors(*map(float, errors),
                      bool(resolved and near and self._decays(exact, system.contact)))

    def _on(self, ratio):
        """The corrector on a grid finer by a ratio, and the contact on half its spacing, kept."""
        if ratio not in self._finer:
            finer = finer_contact(self.contact, ratio)
            self._finer[ratio] = Reference(finer, self.form.window), finer_contact(finer, 2)
        return self._finer[ratio]

    def _values(self, point):
        measurement = Measurement(self.contact, point)
        return _values_at(point, measurement, measurement.contact_area())

    def _values_of(self, point, contact, finest):
        """The same of the finer grid's solution, whose contact edge is found on half its
        spacing."""
        cell = resampled(contact.grid, finest.grid, contact.extended(point.state)[:1])
        gap = cell.reshape(-1) + finest.initial_gap.reshape(-1)
        area = finest.grid.whole.area_below(gap, contact.scene.contact_threshold)
        return _values_at(point, Measurement(contact, point), area)

    def _least(self, point):
        """Below which size of a value an error is absolute: one, or what is large for the cell."""
        area = self.contact.grid.area
        law, ranges = self.contact.law, self.contact.ranges
        # what is named a force is the displacement where that is not controlled
        normal, tangential = (
            1.0 if FORCE in controls else min(1.0, peak * scale * area) for controls, peak, scale
            in ((point.controls[:1], law.normal_peak, ranges[0]),
                (point.controls[1:], law.friction_size, ranges[-1])))
        return normal, min(1.0, area), 1.0, tangential

    def _decays(self, point, contact):
        """Whether the spectrum of the traction goes on to fall beyond the shortest waves of the
        grid itself."""
        grid, components = contact.grid, len(point.controls)
        transform = Transform(grid, grid.shape, components)
        measurement = Measurement(contact, point)
        measurement.window.put(measurement.traction, transform.real)
        transform.forward()
        amplitudes = np.abs(transform.spectrum)
        waves = [abs(q) * spacing / np.pi for q, spacing in zip(grid.wavevectors(),
                                                                self.contact.grid.spacings)]
        shortness = np.maximum.reduce(np.broadcast_arrays(*waves))
        last = shortness.max()
        coarse, fine = (np.max(amplitudes, where=(shortness > 0.8 * top) & (shortness < top),
                               initial=0.0, axis=_waves(amplitudes)) for top in (1.0, last))
        noise = 1e-9 * amplitudes.max()  # a component that nothing drives is nothing else
        return bool(np.all((fine <= SLOWEST * coarse) | (coarse <= noise)))


def _waves(amplitudes):
    return tuple(range(1, amplitudes.ndim))


def _values_at(point, measurement, area):
    """Normal force or the displacement that it belongs to, contact area, mean slip, and the
    tangential force or the displacement that it belongs to (all components of both).

    Around an isolated contact displacements are means over its cell, which even a half-plane has.
    """
    if measurement.contact.isolated:
        means = point.state.means / measurement.contact.ranges[:measurement.components]
        return means[0], area, *2 * (means[1:] if means.size > 1 else [0.0],)
    normal, *tangential = (displacement if control == FORCE else force for control, displacement,
                           force in zip(point.controls, point.displacements, point.forces))
    slip = [measurement.mean(i) for i in range(1, measurement.components)]
    return normal, area, slip or [0.0], tangential or [0.0]


def finer_contact(contact, ratio):
    """The contact on a grid with ``ratio`` times the nodes in each direction; heights from a file
    are interpolated."""
    points = tuple(ratio * n for n in contact.grid.shape)
    scene = replace(contact.scene, points=points if len(points) == 2 else points[0])
    if contact.isolated:
        return IsolatedContact(scene, law=contact.law, kernels=contact.kernels)
    if not shapes.of(scene).gridded:
        return Contact(scene, law=contact.law, kernels=contact.kernels)
    return Contact(scene, gap=finer_gap(contact, Grid(scene.shape, scene.periods)),
                   law=contact.law, kernels=contact.kernels)


class Watch:
    """The errors of a run's points: their columns, and what becomes of those above the accuracy of
    the scene.

    Parameters
    ----------
    branch : Branch
    auto : whether the points of the grid were chosen, and may be chosen again
    progress : Progress, which gets columns for the errors and the sentence on the first that is too
        large
    missed : what a coarser grid was given up for each time, TooCoarse
    """

    def __init__(self, branch, auto, progress, missed=()):
        self.branch = branch
        self.auto = auto
        self.missed = missed
        self.log = progress.log
        self.estimator = Estimator(branch.contact, branch.corrector.settings)
        about = {"normal_force": "force (of the displacement, where the force is controlled)",
                 "contact_area": "contact area", "slip": "mean slip",
                 "tangential_force": "tangential force (of the displacement, where the force is "
                                     "controlled)"}
        self.columns = {f"error_{name}": Observable(None, f"error of the {text}", "relative")
                        for name, text in about.items()}
        self.columns["error_trusted"] = Observable(None, "whether the errors hold (1, 0)", "", "i8")
        sheared = any(tangential_legs(branch.scene, branch.load))
        shown = ("normal_force", "contact_area", "slip") if sheared else ("normal_force",
                                                                          "contact_area")
        event = {"event": progress.columns.pop("event")}
        progress.columns |= {f"error_{name}": f"e({name.split('_')[-1]})" for name in shown} | event
        self.points = self.above = self.doubtful = 0
        self.largest = 0.0

    def row(self, point):
        """Name -> value of the columns for a point; TooCoarse where its grid was chosen and another
        one may do better."""
        errors = self.estimator(point)
        if errors.largest() > self.branch.scene.accuracy:
            self._too_large(point, errors.largest())
        if self.branch.corrector.neutral(point) is not None:
            # other grids have another one of its many equilibria
            errors = errors._replace(trusted=False)
        self.points += 1
        self.doubtful += not errors.trusted
        self.largest = max(self.largest, errors.largest())
        return dict(zip(self.columns, [*errors[:-1], int(errors.trusted)]))

    def _too_large(self, point, error):
        """Raise TooCoarse if another grid may help against an error; else count it, and tell of the
        first."""
        scene = self.branch.scene
        sentence = (f"the error at {scene.loads(point.controls, point.load)} is about {error:.1e}, "
                    f"above -scene_accuracy {as_text(scene.accuracy)}")
        # Where a coarser grid was as good, the spacing is not what is wrong.
        helps = (not self.above and len(self.missed) < MOST
                 and not any(np.array_equal(before.load, point.load) and error > 0.5 * before.error
                             for before in self.missed))
        finer = next_grid(scene, self.branch.load, error) if self.auto and helps else None
        if finer is not None:
            raise TooCoarse(sentence, finer, point.load, error)
        self.above += 1
        if self.above == 1:
            why = "" if not self.auto else ": there is no memory for a finer grid" if helps else \
                ", and a finer grid did not help: a smaller -snes_atol may"
            self.log(sentence + why)

    def summary(self):
        """Lines on the errors of all points."""
        lines = [f"  errors        at most {self.largest:.1e} of "
                 "force and contact area; estimating them took "
                 f"{self.estimator.transforms:.0f} transforms"]
        if self.above:
            lines.append(f"  accuracy      missed at {self.above} of {self.points} points")
        if self.doubtful:
            lines.append(
                f"  trust         none in the estimates at {self.doubtful} of {self.points} points")
        return lines
