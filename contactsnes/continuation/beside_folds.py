"""Which of the modes that change next to a fold are its own, which it does not count, and which of
those that an arc tells of are there."""

import math

from .points import NotConverged
from .predictors.predictor import through

SURE = 0.1
"""Part of its way within which a step by arc length ends of its prediction for what its linear
systems tell of modes to be asked again."""
NEXT = 0.01
"""Part of the load from a fold to a point that is next to the fold, a tenth of the way: the load is
a parabola there."""


def own_modes(first, last):
    """How many of the modes that change between two points are that of a fold, which does not count
    it: one on its unstable side.

    Parameters
    ----------
    first, last : Point
    """
    return int(any(_fewer(one, other) for one, other in ((first, last), (last, first))))


def reached(system, stability, leg, before, after):
    """The second of two (position, Point); for a fold with fewer unstable modes than the first one
    what is next to it, on the side that the branch comes from, which counts the fold's own mode
    where that is unstable there, and not one that regained its stability on the way.

    Where no solve ends next to the fold, the fold.

    Parameters
    ----------
    system, stability, leg : System, Stability, Leg
    before, after : (position, Point)
    """
    (begin, first), (end, last) = before, after
    if not _fewer(last, first) or begin == end:
        return after
    position, left = end + NEXT * (begin - end), math.sqrt(NEXT)
    guess = through(system, [last, first], [0.0, 1.0], left)
    try:
        point = system.solve(guess, leg.controls, leg.load(position))
    except NotConverged:
        return after
    # The branch on the fold's other side is twice as far away.
    if system.missed(guess, point.state) > left * system.missed(first.state, last.state):
        return after
    point = stability(point)
    return after if point.unstable_modes < 0 else (position, point)


def trusted(system, last, point, missed, moved):
    """The point of a step along the arc; NotConverged for one that may be another branch's, where
    a mode is unstable that is not that of a fold behind which the load falls.

    Linear systems of an arc that turns into a soft mode, as next to a nearly broken pitchfork, tell
    of unstable modes that there are not: where a step ended as foretold, they are counted.

    Parameters
    ----------
    system, last, point : System, the point before the step and the one at its end
    missed, moved : float, ranges of the law from its prediction and from the last point to its end
    """
    if not point.softest < 0.0 <= last.softest:
        return point
    own = int(point.position < last.position)
    if (missed > SURE * moved or system.examiner is None
            or not 0 <= system.examiner(point).unstable_modes <= own):
        raise NotConverged(
            "a mode lost its stability in an arc-length step, perhaps on another branch")
    return point.changed(softest=0.0)  # the next point is asked, too


def _fewer(one, other):
    """Whether a point is a fold with fewer unstable modes than another one has."""
    return one.event == "fold" and 0 <= one.unstable_modes < other.unstable_modes
