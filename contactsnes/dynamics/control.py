"""What steps of an overdamped motion may miss: more where nothing but its end counts."""

from typing import NamedTuple


class Control(NamedTuple):
    """What steps of a motion may miss.

    Attributes
    ----------
    error : their error, over -jump_motion_tolerance
    turning : part of a step by which it may miss its prediction: next to an unstable state a long
        implicit step would lead back to it
    still : length of a step, ranges, below which it does not matter how it was predicted
    exactness : relative tolerance of the linear solves, unless -jump_ksp_rtol gives one
    """

    error: float
    turning: float
    still: float
    exactness: float


FOLLOWED, ROUGHLY = Control(1.0, 0.25, 1e-4, 1e-4), Control(4.0, 0.5, 1e-2, 0.1)
"""Of motions whose works are summed up, and of `rough` ones."""


def rough(contact, components):
    """Whether nothing but the end of a motion counts: on planes whose gap is not convex, where
    spots jump one by one, and the law's potential tells what is lost.

    Parameters
    ----------
    contact : Contact
    components : int, of the motion
    """
    return components == 1 and len(contact.grid.shape) == 2 and not contact.convex


def control(contact, components):
    """The `Control` of a motion; parameters as of `rough`."""
    return ROUGHLY if rough(contact, components) else FOLLOWED
