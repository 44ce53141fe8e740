"""Steps of arc length that led across a jump, to another part of the branch."""

SLOWED = 5.0
"""How much slower than the one before, per unit of the load, a step is after which that one is
asked for the way back: towards a fold they get faster, and behind its jump they are slow."""
CUBIC = 0.2
"""Part of a way that the tangent at its end leads back at least where it led over no fold: of a
load that is a cubic of the way through a steep place, a quarter."""


def leapt(system, leg, trail):
    """Length of the last but one step of a trail where that went from before a fold to where its
    jump ends, or beyond: what follows is much slower, and hardly leads back. 0 where it did not.

    Parameters
    ----------
    system : System
    leg : Leg
    trail : [(position, Point), ...], oldest first, of which two are to stay
    """
    if len(trail) < 4:
        return 0.0
    (begin, first), (middle, second), (end, third) = trail[-3:]
    length, next_one = (system.chord_length(one.state, other.state)
                        for one, other in ((first, second), (second, third)))
    if not begin < middle < end or length * (end - middle) < SLOWED * next_one * (middle - begin):
        return 0.0
    back = system.along_tangent(second, leg, middle, begin - middle)
    return length if 0.0 <= system.progress(second.state, first.state, back) < CUBIC else 0.0
