"""Checks of arguments, roots, and the geometry of one contact in a cell."""

import functools

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import xlogy

ROUNDING = 64 * np.finfo(float).eps
"""What a few operations may lose of their largest term: what misses a limit by no more is the
limit."""


def require(condition, message):
    """ValueError(message) unless the condition holds everywhere."""
    if not np.all(condition):
        raise ValueError(message)


def positive(**values):
    """ValueError that names the first of the values that is not above 0 everywhere."""
    for name, value in values.items():
        require(np.greater(value, 0), f"{name} {value} must be positive")


def not_negative(**values):
    """ValueError that names the first of the values that is below 0 anywhere."""
    for name, value in values.items():
        require(np.greater_equal(value, 0), f"{name} {value} must not be negative")


def at_most(value, limit, message):
    """ValueError(message) unless a value is at most its limit everywhere, to rounding.

    Parameters
    ----------
    value, limit : float or array, one unit
    message : str
    """
    require(np.less_equal(value, limit + ROUNDING * np.abs(limit)), message)


def find_root(function, low, high, message, value=0.0):
    """Where `function` takes a value between low and high, an end where it does so to rounding if
    it goes through the value nowhere in between. ValueError(message) where it does not take it.

    Parameters
    ----------
    function : function (float) -> float
    low, high : float, in its argument's unit
    message : str
    value : float, in its result's unit
    """
    misses = [function(end) - value for end in (low, high)]
    if np.sign(misses[0]) * np.sign(misses[1]) <= 0:
        return brentq(lambda place: function(place) - value, low, high, xtol=1e-300, maxiter=2000)
    nearest = np.argmin(np.abs(misses))
    require(abs(misses[nearest]) <= ROUNDING * max(abs(value), abs(value + misses[nearest])),
            message)
    return float((low, high)[nearest])


def jkr_root(share, message):
    """The z >= 1 with z^4 - 4 z = share: a JKR contact is z^2 times as large as where the load on a
    line, or the approach of a sphere, is least, at a share of -3. ValueError(message) below."""
    at_most(-share, 3.0, message)
    # With z = 1 + e it is e^2 (6 + 4 e + e^2), and both ends are away from the root, whatever the
    # rounding.
    rest = max(share + 3.0, 0.0)
    if rest > 1e80:
        return rest ** 0.25
    return 1.0 + find_root(lambda e: e * e * (6.0 + 4.0 * e + e * e), 0.0,
                           2.0 * min(np.sqrt(rest / 6.0), rest ** 0.25), message, rest)


def minimizer(function, low, high):
    """Where `function` is least in (low, high).

    Parameters
    ----------
    function : function (float) -> float
    low, high : float, in its argument's unit
    """
    return minimize_scalar(function, bounds=(low, high), method="bounded",
                           options={"xatol": 1e-12}).x


def half_angle(half_width, period):
    """pi a/L of a valid contact, 0 for an isolated one."""
    positive(period=period)
    require(np.greater_equal(half_width, 0) & np.less(half_width, period / 2),
            f"half_width {half_width} must be at least 0 and below half the period {period}")
    return np.pi * np.asarray(half_width) / period


def half_width_of(angle, period):
    """a of an angle pi a/L up to pi/2: below half the period, whatever the rounding."""
    return np.minimum(period / np.pi * angle, np.nextafter(period / 2, 0))


def log_cosine(angle):
    """ln cos of an angle from 0 to pi/2, exact in narrow contacts and where they nearly fill the
    cell."""
    return np.where(angle < 0.8, np.log1p(-np.minimum(np.sin(angle), 0.8) ** 2) / 2,
                    np.log(np.cos(angle)))


def times_log_sine(factor, angle):
    """A factor times ln sin of an angle from 0 to pi/2, as exact as `log_cosine`; 0 if the factor
    is."""
    return np.where(angle > 0.8, factor * np.log1p(-np.minimum(np.cos(angle), 0.8) ** 2) / 2,
                    xlogy(factor, np.sin(angle)))


def periodic_angle(half_width, period):
    """pi a/L, for results that do not exist without a cell."""
    require(np.isfinite(period),
            "a displacement of the mean surface of a line contact needs a finite period")
    return half_angle(half_width, period)


def root_depth(x, half_width, period=np.inf):
    """sqrt(a^2 - x^2), or (L/pi) sqrt(sin^2(pi a/L) - sin^2(pi x/L)) without cancellation; 0
    outside the contact.

    Parameters
    ----------
    x, half_width : float or array, one unit of length
    period : float, the same unit; `inf`: isolated
    """
    left, right = half_width + np.asarray(x), half_width - np.asarray(x)
    if np.isfinite(period):
        left, right = (period / np.pi * np.sin(np.pi / period * distance)
                       for distance in (left, right))
    return np.sqrt(np.maximum(left * right, 0.0))


def reciprocal_depth(x, half_width, period=np.inf):
    """1/`root_depth`, and 0 outside the contact.

    Parameters
    ----------
    x, half_width, period : as of `root_depth`
    """
    depth = root_depth(x, half_width, period)
    return np.divide(1.0, depth, out=np.zeros_like(depth), where=depth > 0)


def elementwise(function):
    """The same function of numbers, element by element where any of its arguments is an array, all
    broadcast."""
    @functools.wraps(function)
    def each(*args, **kwargs):
        if any(np.ndim(value) for value in (*args, *kwargs.values())):
            return np.vectorize(function, cache=True)(*args, **kwargs)
        return function(*args, **kwargs)

    return each
