"""What steps of an overdamped motion may miss: more where nothing but its end counts."""

from typing import NamedTuple

from ..solvers.ritz import many


class Control(NamedTuple):
    """What steps of a motion may miss.

    Attributes
    ----------
    error : their error, over -jump_motion_tolerance
    turning : part of a step by which it may miss its prediction: next to an unstable state a long
        implicit step would lead back to it
    still : length of a step, ranges, below which it does not matter how it was predicted; that of
        the first one, if that is more than half of -jump_motion_tolerance
    exactness : relative tolerance of the linear solves, unless -jump_ksp_rtol gives one
    """

    error: float
    turning: float
    still: float
    exactness: float


PATIENCE = 3
"""Stalled steps in turn that may be chance."""
FOLLOWED, ROUGHLY = Control(1.0, 0.25, 1e-4, 1e-4), Control(2.0, 0.4, 2e-2, 0.1)
"""Of motions whose works are summed up, and of `rough` ones that begin beside an equilibrium."""
FREELY = Control(4.0, 0.5, 2e-2, 0.15)
"""Of `rough` ones from elsewhere, which no unstable state is near."""
SHEARED = Control(0.2, 0.4, 2e-2, 0.1)
"""Of those whose works are summed up where there are many spots: shorter steps make these more
exact than `FOLLOWED` does, at little more than half of the iterations of its linear solves."""
CAREFUL, MANY = {**dict.fromkeys((ROUGHLY, FREELY), Control(1.0, 0.25, 1e-2, 1e-3)),
                 SHEARED: FOLLOWED}, 100
"""What takes the place of these from so many steps on: what their linear solves and long steps
leave may keep a motion up for ever."""


class Exactness:
    """What the linear solves of a motion may leave of its rate: less where that is about all that
    moves, keeps the motion up and its steps short.

    Parameters
    ----------
    left : float, norm, ranges of the law a relaxation time
    """

    def __init__(self, left):
        self.left, self._stalled = left, 0

    def after(self, stalled):
        """Take note of a step: whether it hardly moved, did not allow for a longer one, and left
        all that it may."""
        self._stalled = self._stalled + 1 if stalled else 0
        if self._stalled > PATIENCE:
            self.left *= 0.5


def rough(contact, components):
    """Whether nothing but the end of a motion counts: on planes whose gap is not convex, where
    spots jump one by one, and the law's potential tells what is lost.

    Parameters
    ----------
    contact : Contact
    components : int, of the motion
    """
    return components == 1 and many(contact)


def control(contact, symmetry, components, beside):
    """The `Control` of a motion.

    Parameters
    ----------
    contact, components : as of `rough`
    symmetry : symmetry.Symmetry
    beside : bool, whether it begins beside an equilibrium
    """
    if rough(contact, components):
        return ROUGHLY if beside else FREELY
    # what is left by solves on all nodes is not even, as states are where some components are odd
    odd = symmetry.holds(components) and not symmetry.plain(components)
    return SHEARED if many(contact) and beside and not odd else FOLLOWED
