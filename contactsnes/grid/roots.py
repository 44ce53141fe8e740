"""Roots of functions of one number."""

import math


def bracketed_root(function, low, high, xtol=2e-12, rtol=8.9e-16):
    """The root of a continuous function between two places at which its signs differ.

    Brent's method (Algorithms for Minimization without Derivatives, 1973), step by step that of
    SciPy's ``brentq``, whose module takes longer to import than a run asks of it.

    Parameters
    ----------
    function : function (float) -> float
    low, high : floats
    xtol, rtol : absolute and relative tolerance of the root
    """
    before, now = float(low), float(high)
    past, value = function(before), function(now)
    if past == 0.0 or value == 0.0:
        return before if past == 0.0 else now
    if (past < 0.0) == (value < 0.0):
        raise ValueError(f"no change of sign between {low:g} and {high:g}")
    other = beyond = last = step = 0.0
    for _ in range(100):
        if past != 0.0 and (past < 0.0) != (value < 0.0):
            other, beyond = before, past
            last = step = now - before
        if abs(beyond) < abs(value):
            before, now, other = now, other, now
            past, value, beyond = value, beyond, value
        least, half = 0.5 * (xtol + rtol * abs(now)), 0.5 * (other - now)
        if value == 0.0 or abs(half) < least:
            return now
        trial = math.inf
        if abs(last) > least and abs(value) < abs(past):
            trial = _interpolated((before, now, other), (past, value, beyond))
        shorter = 2.0 * abs(trial) < min(abs(last), 3.0 * abs(half) - least)
        last, step = (step, trial) if shorter else (half, half)
        before, past = now, value
        now += step if abs(step) > least else math.copysign(least, half)
        value = function(now)
    return now


def _interpolated(places, values):
    """The step from the second of three places to the root of the line, or of the inverse parabola,
    through them."""
    (before, now, other), (past, value, beyond) = places, values
    if before == other:
        return -value * (now - before) / (value - past)
    near, far = (past - value) / (before - now), (beyond - value) / (other - now)
    return -value * (beyond * far - past * near) / (far * near * (beyond - past))
