"""Checks of arguments, roots, and the geometry of one contact in a cell."""

import functools

import numpy as np
from scipy.optimize import brentq, minimize_scalar


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


def find_root(function, low, high, message):
    """Zero of `function` in [low, high]; ValueError(message) where its sign does not change."""
    require(function(low) * function(high) <= 0, message)
    return brentq(function, low, high, xtol=1e-15)


def minimizer(function, low, high):
    """Where `function` is least in (low, high)."""
    return minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-12}).x


def half_angle(half_width, period):
    """pi a/L of a valid contact, 0 for an isolated one."""
    positive(period=period)
    require(np.greater_equal(half_width, 0) & np.less(half_width, period / 2),
            f"half_width {half_width} must be at least 0 and below half the period {period}")
    return np.pi * np.asarray(half_width) / period


def periodic_angle(half_width, period):
    """pi a/L, for results that do not exist without a cell."""
    require(np.isfinite(period), "a displacement of the mean surface of a line contact needs a finite period")
    return half_angle(half_width, period)


def root_depth(x, half_width, period=np.inf):
    """sqrt(a^2 - x^2), or (L/pi) sqrt(sin^2(pi a/L) - sin^2(pi x/L)) without cancellation; 0 outside the contact."""
    left, right = half_width + np.asarray(x), half_width - np.asarray(x)
    if np.isfinite(period):
        left, right = (period / np.pi * np.sin(np.pi / period * distance) for distance in (left, right))
    return np.sqrt(np.maximum(left * right, 0.0))


def reciprocal_depth(x, half_width, period=np.inf):
    """1/`root_depth`, and 0 outside the contact."""
    depth = root_depth(x, half_width, period)
    return np.divide(1.0, depth, out=np.zeros_like(depth), where=depth > 0)


def elementwise(function):
    """The same function of numbers, element by element where any of its arguments is an array, all broadcast."""
    @functools.wraps(function)
    def each(*args, **kwargs):
        if any(np.ndim(value) for value in (*args, *kwargs.values())):
            return np.vectorize(function, cache=True)(*args, **kwargs)
        return function(*args, **kwargs)

    return each
