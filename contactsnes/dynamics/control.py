"""What steps of an overdamped motion may miss: more where nothing but its end counts."""

from typing import NamedTuple

from petsc4py import PETSc

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
LEAST = 1e-4
"""Least part of its right side that a linear solve of a stalled motion leaves."""
FOLLOWED = Control(1.0, 0.25, 1e-4, 1e-4)
"""Of motions on lines, of one spot, and of states whose symmetry these would break."""
ROUGHLY = Control(2.0, 0.4, 2e-2, 0.1)
"""Of `rough` ones that begin beside an equilibrium."""
FREELY, SHEARED_FREELY = (Control(4.0, 0.5, 2e-2, left) for left in (0.15, 5e-3))
"""Of `rough` ones from elsewhere, which no unstable state is near, of the normal component and of
several: what linear solves leave of these would keep the motion up."""
SHEARED = Control(0.2, 0.4, 2e-2, 0.1)
"""Of those whose works are summed up where there are many spots: shorter steps make these more
exact than `FOLLOWED` does, at two thirds of its transforms."""
CAREFUL, MANY = {**dict.fromkeys((ROUGHLY, FREELY, SHEARED_FREELY),
                                 Control(1.0, 0.25, 1e-2, 1e-3)), SHEARED: FOLLOWED}, 100
"""What takes the place of these from so many steps on: what their linear solves and long steps
leave may keep a motion up for ever."""


class Exactness:
    """What the linear solves of a motion may leave: less where that is about all that moves, keeps
    the motion up and its steps short.

    Parameters
    ----------
    part : float, of the right side, as `Control.exactness`
    left : float, norm of a rate, ranges of the law a relaxation time
    """

    def __init__(self, part, left):
        self.part, self.left, self._stalled = part, left, 0

    def after(self, stalled, reason):
        """Take note of a step.

        Parameters
        ----------
        stalled : bool, whether it hardly moved, and did not allow for a longer one
        reason : PETSc's, why its linear solve ended
        """
        reasons = PETSc.KSP.ConvergedReason
        self._stalled = self._stalled + 1 if stalled else 0
        if self._stalled > PATIENCE and reason == reasons.CONVERGED_ATOL:
            self.left *= 0.5
        elif self._stalled > PATIENCE and reason == reasons.CONVERGED_RTOL:
            self.part = max(0.5 * self.part, LEAST)


def rough(contact, components, measured):
    """Whether nothing but the end of a motion counts: on planes whose gap is not convex, where
    spots jump one by one, and the law's potential tells what is lost, or nobody asks for it.

    Parameters
    ----------
    contact : Contact
    components : int, of the motion
    measured : bool, whether works are asked for
    """
    return many(contact) and (components == 1 or not measured)


def control(contact, symmetry, components, beside, measured):
    """The `Control` of a motion.

    Parameters
    ----------
    contact, components, measured : as of `rough`
    symmetry : symmetry.Symmetry
    beside : bool, whether it begins beside an equilibrium
    """
    # what is left by solves on all nodes is not even, as states are where some components are odd
    if not many(contact) or (symmetry.holds(components) and not symmetry.plain(components)):
        return FOLLOWED
    if rough(contact, components, measured):
        return ROUGHLY if beside else FREELY if components == 1 else SHEARED_FREELY
    return SHEARED if beside else FOLLOWED
