"""Operations that formulas may have: what NumPy calls them, their derivatives, and identities by
which a graph of them stays small."""

import math
from typing import NamedTuple

import numpy as np
import scipy


class Operation(NamedTuple):
    """An operation on values at every node.

    Parameters
    ----------
    function : universal function of NumPy (or SciPy) that takes an output as its last argument
    slopes : functions (result, *arguments), the derivative to each argument; none are needed where
        the result is true or false
    boolean : whether the result is true or false
    """

    function: object
    slopes: tuple = ()
    boolean: bool = False


TWO_OVER_ROOT_PI = 2.0 / math.sqrt(math.pi)


class Special:
    """A universal function of scipy.special, which is not imported before it is called: few laws
    need it."""

    nin = 1

    def __init__(self, name):
        self.name = name

    def __call__(self, *arguments):
        return getattr(scipy.special, self.name)(*arguments)


OPERATIONS = {
    "add": Operation(np.add, (lambda e, x, y: 1.0, lambda e, x, y: 1.0)),
    "subtract": Operation(np.subtract, (lambda e, x, y: 1.0, lambda e, x, y: -1.0)),
    "multiply": Operation(np.multiply, (lambda e, x, y: y, lambda e, x, y: x)),
    "divide": Operation(np.divide, (lambda e, x, y: 1.0 / y, lambda e, x, y: -(e / y))),
    "power": Operation(np.power, (lambda e, x, y: y * x ** (y - 1.0),
                                  lambda e, x, y: e * x.graph.apply("log", x))),
    "negative": Operation(np.negative, (lambda e, x: -1.0,)),
    "absolute": Operation(np.absolute, (lambda e, x: x.graph.apply("where", x < 0.0, -1.0, 1.0),)),
    "sqrt": Operation(np.sqrt, (lambda e, x: 0.5 / e,)),
    "exp": Operation(np.exp, (lambda e, x: e,)),
    "expm1": Operation(np.expm1, (lambda e, x: e + 1.0,)),
    "log": Operation(np.log, (lambda e, x: 1.0 / x,)),
    "log1p": Operation(np.log1p, (lambda e, x: 1.0 / (1.0 + x),)),
    "sin": Operation(np.sin, (lambda e, x: x.graph.apply("cos", x),)),
    "cos": Operation(np.cos, (lambda e, x: -x.graph.apply("sin", x),)),
    "arctan": Operation(np.arctan, (lambda e, x: 1.0 / (1.0 + x * x),)),
    "sinh": Operation(np.sinh, (lambda e, x: x.graph.apply("cosh", x),)),
    "cosh": Operation(np.cosh, (lambda e, x: x.graph.apply("sinh", x),)),
    "tanh": Operation(np.tanh, (lambda e, x: 1.0 - e * e,)),
    "erf": Operation(Special("erf"),
                     (lambda e, x: TWO_OVER_ROOT_PI * x.graph.apply("exp", -(x * x)),)),
    "erfc": Operation(Special("erfc"),
                      (lambda e, x: -TWO_OVER_ROOT_PI * x.graph.apply("exp", -(x * x)),)),
    "minimum": Operation(np.minimum), "maximum": Operation(np.maximum),
    "where": Operation(np.where),
    **{name: Operation(getattr(np, name), boolean=True)
       for name in ("less", "less_equal", "greater", "greater_equal", "equal", "not_equal",
                    "logical_and", "logical_or", "logical_not")},
}

LOGICAL = ("logical_and", "logical_or", "logical_not")
COMMUTATIVE = ("add", "multiply", "logical_and", "logical_or")

QUIET = {"add", "subtract", "multiply", "negative", "absolute", "exp", "expm1", "tanh", "erf",
         "erfc", "arctan", "minimum", "maximum", "where",
         *(name for name, operation in OPERATIONS.items() if operation.boolean)}
"""Operations without a warning where all goes well; others may be asked for what they have not in
the branch that is not taken."""


def _selected(conditions, choices, default=0.0):
    """np.select by np.where."""
    for condition, choice in reversed(list(zip(conditions, choices))):
        default = condition.graph.apply("where", condition, choice, default)
    return default


def _clipped(x, low=None, high=None, **others):
    """np.clip by np.minimum and np.maximum."""
    low, high = others.pop("a_min", low), others.pop("a_max", high)
    x = x if low is None else x.graph.apply("maximum", x, low)
    return x if high is None else x.graph.apply("minimum", x, high)


def _sign(x):
    """np.sign by np.where."""
    return x.graph.apply("where", x > 0.0, 1.0, x.graph.apply("where", x < 0.0, -1.0, 0.0))


REWRITTEN = {
    "abs": lambda x: abs(x), "positive": lambda x: x, "copy": lambda x: x,
    "square": lambda x: x * x, "reciprocal": lambda x: 1.0 / x, "sign": _sign,
    "true_divide": lambda x, y: _on(x, y).apply("divide", x, y),
    "float_power": lambda x, y: _on(x, y).apply("power", x, y),
    "fmin": lambda x, y: _on(x, y).apply("minimum", x, y),
    "fmax": lambda x, y: _on(x, y).apply("maximum", x, y),
    "hypot": lambda x, y: (x * x + y * y) ** 0.5,
    "heaviside": lambda x, at: x.graph.apply(
        "where", x > 0.0, 1.0, x.graph.apply("where", x < 0.0, 0.0, at)),
    "bitwise_and": lambda x, y: _on(x, y).apply("logical_and", x, y),
    "bitwise_or": lambda x, y: _on(x, y).apply("logical_or", x, y),
    "invert": lambda x: x.graph.apply("logical_not", x),
    "zeros_like": lambda x: x.graph.number(0.0), "ones_like": lambda x: x.graph.number(1.0),
    "full_like": lambda x, value: x.graph.lift(value),
    "select": _selected, "clip": _clipped,
}
"""Functions of NumPy that are made of others."""

KNOWN = ("where", "minimum", "maximum", "clip", "select", "heaviside", "sign", "abs", "sqrt",
         "square", "hypot", "exp", "expm1", "log", "log1p", "sin", "cos", "arctan", "sinh", "cosh",
         "tanh", "zeros_like", "ones_like", "full_like")
"""Functions of NumPy that messages name."""


def _on(*arguments):
    """The graph of the first argument that has one."""
    return next(x.graph for x in arguments if hasattr(x, "graph"))


# Identities: each takes a graph and arguments, and gives the result, or None where there is no
# shorter one.

def _add(graph, x, y):
    if x.is_number(0.0):
        return y
    if y.is_number(0.0):
        return x
    if x is y:
        return 2.0 * x
    if y.operation == "negative":
        return x - y.arguments[0]
    return y - x.arguments[0] if x.operation == "negative" else None


def _subtract(graph, x, y):
    if y.is_number(0.0):
        return x
    if x.is_number(0.0):
        return -y
    if x is y:
        return graph.number(0.0)
    return x + y.arguments[0] if y.operation == "negative" else None


def _multiply(graph, x, y):
    for one, other in ((x, y), (y, x)):
        if one.is_number(0.0):
            return one
        if one.is_number(1.0):
            return other
        if one.is_number(-1.0):
            return -other
        if one.operation == "negative":
            return -(one.arguments[0] * other)
        if one.operation == "multiply" and (number := one.factor()) is not None:
            rest = one.without(number)
            return (number * other * rest if other.operation == "number"
                    else number * (rest * other))
    root = x is y and x.operation == "sqrt" and x.arguments[0].operation == "input"
    return x.arguments[0] if root else None  # the square of a root of an input, as of b = sqrt(q)


def _divide(graph, x, y):
    if y.is_number(1.0):
        return x
    if x.operation == "negative":
        return -(x.arguments[0] / y)
    # To multiply by the inverse of a power of two is exact.
    if y.operation == "number" and y.value and abs(math.frexp(y.value)[0]) == 0.5:
        return x * (1.0 / y.value)
    return None


def _negative(graph, x):
    if x.operation == "negative":
        return x.arguments[0]
    if x.operation == "multiply" and (number := x.factor()) is not None:
        return -number.value * x.without(number)
    return None


def _power(graph, x, y):
    if y.operation != "number":
        return None
    if y.value == 0.5:
        return graph.apply("sqrt", x)
    if y.value < 0.0 and y.value in (-0.5, -1.0, -2.0, -3.0, -4.0):
        return 1.0 / x ** -y.value
    squared = {2.0: lambda: x * x, 3.0: lambda: x * x * x, 4.0: lambda: (x * x) * (x * x)}
    if y.value in (0.0, 1.0):
        return x if y.value else graph.number(1.0)
    return squared[y.value]() if y.value in squared else None


def _where(graph, condition, x, y):
    if condition.operation == "number":
        return x if condition.value else y
    if condition.operation == "logical_not":
        return graph.apply("where", condition.arguments[0], y, x)
    x, y = graph.assume(x, condition, True), graph.assume(y, condition, False)
    if x is y:
        return x
    negative = [value.operation == "negative" or value.is_number(0.0) for value in (x, y)]
    if all(negative):
        return -graph.apply("where", condition, -x, -y)
    return graph.intern("where", (condition, x, y))


def _logical(absorbing):
    def shorter(graph, x, y):
        for one, other in ((x, y), (y, x)):
            if one.operation == "number":
                return one if one.value == absorbing else other
        return x if x is y else None
    return shorter


IDENTITIES = {
    "add": _add, "subtract": _subtract, "multiply": _multiply, "divide": _divide,
    "negative": _negative, "power": _power, "where": _where,
    "logical_and": _logical(False), "logical_or": _logical(True),
    "logical_not": lambda graph, x: x.arguments[0] if x.operation == "logical_not" else None,
    "minimum": lambda graph, x, y: x if x is y else None,
    "maximum": lambda graph, x, y: x if x is y else None,
}
