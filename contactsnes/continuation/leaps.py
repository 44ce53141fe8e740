"""Steps of arc length that led across a jump, to another part of the branch."""

SLOWED, CUBIC = 4.0, 0.25
"""How much slower than the one before, per unit of the load, a step is after which that one is
asked for the way back (towards a fold they get faster, and behind its jump they are slow), and the
part of its way that the tangent at its end leads back where it led over no fold: both those of a
load that is a cubic of the way through a steep place, at most."""


def leapt(system, leg, trail, failures=0):
    """Length of the last but one step of a trail where that went from before a fold to where its
    jump ends, or beyond: what follows is much slower, or failed before, and hardly leads back. 0
    where it did not.

    Parameters
    ----------
    system : System
    leg : Leg
    trail : [(position, Point), ...], oldest first, of which two are to stay
    failures : int, before the last step was found
    """
    if len(trail) < 4:
        return 0.0
    (begin, first), (middle, second), (end, third) = trail[-3:]
    length, next_one = (system.chord_length(one.state, other.state)
                        for one, other in ((first, second), (second, third)))
    slow = length * (end - middle) > SLOWED * next_one * (middle - begin)
    if not (begin < middle < end and (failures or slow)):
        return 0.0
    back = system.along_tangent(second, leg, middle, begin - middle)
    return length if 0.0 <= system.progress(second.state, first.state, back) < CUBIC else 0.0
