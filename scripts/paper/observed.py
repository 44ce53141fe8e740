"""What is read off the runs: where sliding begins, how the contact peels, and traction profiles."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import curve_fit

from contactsnes.interface.laws.coupled import SLIP


class Onset(NamedTuple):
    """Where gross sliding begins: the index of the point, whether by a fold, and the values
    there."""

    point: int
    unstable: bool
    displacement: float
    force: float
    area: float
    force_error: float


def sheared_part(record):
    """The points from where the shear begins (slice)."""
    return slice(max(int(np.flatnonzero(record["tangential_displacement"] > 0)[0]) - 1, 0), None)


def onset(record):
    """Onset of gross sliding: the fold from which the whole contact goes on to slide, or the first
    point of gross sliding.

    Folds that lead to a state in which some of the contact still sticks are passed over; at one
    where a run was told to stop, the onset is taken to be. None where the run ends before. The
    error of the force is what it changed by in the last step, 0 at a fold.
    """
    folds = np.flatnonzero((record["event"] == "fold") & (record["fold_kind"] == "sliding"))
    slid = np.flatnonzero(record["event"] == "gross_sliding")
    first = slid[0] if slid.size else record.points
    for fold in folds:
        landed = np.flatnonzero(record["event"][fold:] == "jump")
        if (fold == record.points - 1 or first == fold + 1
            or landed.size and first <= fold + landed[0] + 1):
            return _at(record, fold, True)
    return _at(record, first, False) if slid.size else None


def _at(record, point, unstable):
    force = record["tangential_force"]
    # Along the length of a branch events are located exactly.
    error = (0.0 if unstable or "-continuation_type arclength" in record.options
             else abs(force[point] - force[point - 1]))
    return Onset(int(point), unstable, record["tangential_displacement"][point], force[point],
                 record["contact_area"][point], error)


def peel(record):
    """(forces, areas) from the unsheared contact to the onset of sliding."""
    part, last = sheared_part(record), onset(record)
    end = record.points if last is None else last.point + 1
    chosen = slice(part.start, end)
    return record["tangential_force"][chosen], record["contact_area"][chosen]


def area_at(record, force):
    """Contact area at a tangential force before the onset, by a monotone cubic through the
    points."""
    forces, areas = peel(record)
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(forces)) > 0])
    return float(PchipInterpolator(forces[rising], areas[rising])(force))


def pressed_area(record, forces):
    """Contact areas at normal forces of a run that unloads, above its least force."""
    falling = slice(0, int(np.argmin(record["normal_force"])) + 1)
    loads, areas = (record[name][falling][::-1] for name in ("normal_force", "contact_area"))
    keep = np.concatenate([[True], np.diff(loads) > 1e-9])
    return PchipInterpolator(loads[keep], areas[keep])(forces)


class PowerLaw(NamedTuple):
    """A fit a = a_0 - factor w^exponent: its values, and the half width of the exponent's 95 %
    confidence interval."""

    area: float
    factor: float
    exponent: float
    interval: float
    end: float

    def __call__(self, force):
        return self.area - self.factor * np.asarray(force) ** self.exponent


def power_law(forces, areas, share=0.5):
    """The power law that fits the decay of the area best, from zero force to where a share of what
    is lost is lost.

    What is lost in all is the area at zero force minus the least one before the onset. Least
    squares in the area, with the area at zero force fixed, since it is known.
    """
    lost = areas[0] - areas
    early = np.flatnonzero((lost <= share * lost.max()) & (forces > 0))
    early = early[early < np.argmax(lost)]
    if early.size < 4:
        raise ValueError("fewer than four points to fit")
    x, y = forces[early], lost[early]
    (factor, exponent), spread = curve_fit(lambda w, k, n: k * w ** n, x, y,
                                           p0=(y[-1] / x[-1] ** 2, 2.0))
    return PowerLaw(areas[0], factor, exponent, 1.96 * float(np.sqrt(spread[1, 1])), x[-1])


class Profile(NamedTuple):
    """A point whose fields are kept: x, gap in delta_n, slip in delta_t, normal and tangential
    traction."""

    x: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    normal: np.ndarray
    tangential: np.ndarray


def profile(record, point):
    """`Profile` of a point."""
    return next(profiles(record, [point]))


def profiles(record, points):
    """Iterate over the `Profile`s of points; many cost less than one by one."""
    maugis = [record.scene["normal_maugis"], record.scene["tangential_maugis"]]
    for displacement, traction in record.each(list(points)):
        gap = (record.initial_gap + displacement[0]) * maugis[0]
        none = np.zeros_like(gap)
        slip, tangential = ((none, none) if len(displacement) == 1
                            else (displacement[1] * maugis[1], traction[1]))
        yield Profile(record.coordinates[0], gap, slip, traction[0], tangential)


def width_below(x, gap, threshold):
    """Length where a gap is below a threshold; the edges are interpolated linearly between
    nodes."""
    below = gap < threshold
    edges = np.flatnonzero(below[1:] != below[:-1])
    if not edges.size:
        return 0.0
    share = (threshold - gap[edges]) / (gap[edges + 1] - gap[edges])
    places = x[edges] + share * (x[edges + 1] - x[edges])
    return float(np.sum(places[1::2] - places[::2]))


def stuck(slip, gap, threshold):
    """Share of the contact that has not passed the peak of the tangential traction."""
    contact = gap < threshold
    return float(np.mean(np.abs(slip[contact]) <= SLIP)) if contact.any() else 0.0
