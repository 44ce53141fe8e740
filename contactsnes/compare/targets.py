"""The reference of a comparison: points of a path, solved to rounding, that every method is to
find."""

import re
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..contact import states
from ..contact.observables import Measurement
from ..continuation.load_steps import predict
from ..continuation.natural import leg_history
from ..continuation.points import Leg, NoEquilibrium, NotConverged
from ..continuation.predictors import PREDICTORS
from ..options.database import install

PATH_TOLERANCE, POLISHED = "1e-10", ("1e-11", "1e-12", "1e-13")
"""-snes_atol of the reference's path, and those that its points are then brought to, as far as
rounding allows."""

SAME_STATE, AMPLIFIED = 1e-4, 1e4
"""Distance of equal solutions, ranges of the law; and how much farther off a residual can leave
them (near folds most)."""

ERRORS = ("displacement_error", "force_error", "area_error")


class Target(NamedTuple):
    """A point of the reference that every method is to find: its stage (0: the first point, then
    legs), and its start."""

    stage: int
    point: object
    guess: object
    forces: np.ndarray
    area: float

    def errors(self, contact, point):
        """True errors of a point: displacement (root mean square where the law acts, ranges),
        force, contact area (relative).

        Forces relative to 1 where they are smaller; an area relative to itself unless it is zero.
        """
        displacement = states.missed(contact, self.point.state, point.state)
        force = np.max(np.abs(forces(contact, point) - self.forces)
                       / np.maximum(1.0, np.abs(self.forces)))
        area = abs(Measurement(contact, point).contact_area() - self.area) / (self.area or 1.0)
        return displacement, float(force), area

    def is_unstable(self):
        """Whether a certificate, where there is one, else linear solves say that the point is not
        stable."""
        return self.point.stable == 0 or self.point.stable < 0 and self.point.softest < 0.0

    def is_found(self, displacement_error, residual_norm):
        """Whether a state so far from the reference can be the same solution, reached with a
        tolerance."""
        return displacement_error <= max(SAME_STATE, AMPLIFIED * residual_norm)


def forces(contact, point):
    """Forces of the tractions, controlled or not (w_n,r, w_t,r)."""
    measurement = Measurement(contact, point)
    return contact.load_factor(measurement.components) * contact.grid.sum(measurement.traction)


def follow_reference(branch, given):
    """The reference's points, as exact as rounding allows, and why the path ends before its end (or
    an empty text).

    Parameters
    ----------
    branch : Branch
    given : name -> value of the options, of which those of a method are left out
    """
    own = {name: value for name, value in given.items()
           if not re.match(r"contact_|(.*_)?(snes|ksp|pc)_", name)}
    install({**own, "snes_atol": PATH_TOLERANCE})
    points, reason = [], ""
    try:
        for point in branch:
            # A further event at the same load is the same point.
            if not points or point.state is not points[-1].state:
                points.append(point)
    except (NotConverged, NoEquilibrium) as error:
        reason = str(error)
    for tolerance in POLISHED:
        install({**own, "snes_atol": tolerance})
        branch.corrector.form = None
        points = [_polished(branch.corrector, point) for point in points]
    install({**own, "snes_atol": PATH_TOLERANCE})
    branch.corrector.form = None
    return points, reason


def _polished(corrector, point):
    """The point with a smaller residual, or as it is."""
    try:
        better = corrector.solve(point.state, point.controls, point.load)
    except NotConverged:
        return point
    return replace(point, state=better.state, displacements=better.displacements,
                   forces=better.forces, residual_norm=better.residual_norm)


def targets(branch, points):
    """What methods are to solve: the first point and those reached by steps, neither folds nor what
    comes of jumps."""
    contact, found = branch.contact, []
    for place, point in enumerate(points):
        if point.event in ("fold", "jump"):
            continue
        guess = None if place == 0 else _predicted(branch, points[:place], point)
        area = Measurement(contact, point).contact_area()
        found.append(Target(point.leg, point, guess, forces(contact, point), area))
    return found


def _predicted(branch, before, point):
    """The state that the scene's predictor gives for a point from those before it."""
    end = point.origin + (point.load - point.origin) / point.position
    moving = int(np.argmax(np.abs(end - point.origin)))
    leg = Leg(point.leg, point.controls, point.origin, end, moving, 0.0, 0.0, 0.0)
    history = [(place, branch.corrector.adapted(last, leg.controls, leg.load(place)))
               for place, last in leg_history(before, point.leg)]
    return predict(branch.corrector, history, leg, point.position,
                   PREDICTORS[branch.steps.predictor])
