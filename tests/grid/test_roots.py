"""Roots of functions of one number."""

import math

import pytest
from scipy.optimize import brentq

from contactsnes.grid.roots import bracketed_root

FUNCTIONS = {"line": (lambda x: 3.0 * x - 1.0, 0.0, 1.0), "cubic": (lambda x: x ** 3 - 2.0, 0, 2),
             "cosine": (lambda x: math.cos(x) - x, 0.0, 1.5),
             "exponential": (lambda x: math.exp(20.0 * x) - 5.0, -1.0, 1.0),
             "jump": (lambda x: -1.0 if x < 0.7 else 2.0, 0.0, 1.0),
             "root at an end": (lambda x: x, 0.0, 1.0), "backwards": (lambda x: x - 0.2, 1.0, -1.0)}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("tolerances", [{}, {"xtol": 1e-14}, {"rtol": 1e-3}])
def test_roots_are_those_of_scipy_in_as_many_evaluations(name, tolerances):
    function, low, high = FUNCTIONS[name]
    seen = []

    def watched(x):
        seen.append(x)
        return function(x)

    expected, result = brentq(function, low, high, full_output=True, **tolerances)
    assert bracketed_root(watched, low, high, **tolerances) == pytest.approx(expected, abs=1e-15)
    assert len(seen) == result.function_calls


def test_a_root_needs_a_change_of_sign():
    with pytest.raises(ValueError, match="between 1 and 2"):
        bracketed_root(lambda x: x, 1.0, 2.0)
