"""Graphs of formulas: values against NumPy's, derivatives against complex steps and differences."""

import numpy as np
import pytest
from scipy.special import erf, erfc

from contactsnes.interface.graph import Graph, Untraceable
from contactsnes.interface.operations import OPERATIONS
from contactsnes.interface.program import Program, fault

X, Y = np.meshgrid(np.array([0.3, 0.9, 1.7, 2.6]), np.array([0.2, 0.8, 1.4]))
X, Y = X.ravel(), Y.ravel()


def traced(function, *names):
    """A graph, its inputs and what a function makes of them."""
    graph = Graph()
    inputs = [graph.input(name) for name in names]
    return graph, inputs, graph.lift(function(*inputs))


def values(roots, inputs, *given):
    return [part.copy() for part in Program(roots, inputs).run(*given)]


SMOOTH = {
    "arithmetic": lambda x, y: (2.0 - x) * y / (1.0 + x * x) - (-x) + 3.0 * y - x / 4.0,
    "powers": lambda x, y: x**2 + y**3 - x**4 + x**-1 + y**0.5 + x**2.3 + (x + y)**-2 + x**y,
    "exponentials": lambda x, y: np.exp(-x * y) + np.expm1(-x) * np.log1p(y) + np.log(x),
    "circles": lambda x, y: np.sin(x) * np.cos(y) + np.arctan(x * y),
    "hyperbolas": lambda x, y: np.tanh(x - y) + np.sinh(y) / np.cosh(x),
    "roots": lambda x, y: np.sqrt(1.0 + x * x) + np.square(y) + np.reciprocal(x) + (x * x)**0.5,
    "numbers first": lambda x, y: np.float64(2.0) * x + 1.0 / y - np.float64(3.0) / x + 2**y,
}


@pytest.mark.parametrize("function", SMOOTH.values(), ids=SMOOTH)
def test_values_and_derivatives_of_smooth_functions(function):
    graph, inputs, root = traced(function, "x", "y")
    slopes = [graph.derivatives([root], one)[0] for one in inputs]
    value, *found = values([root, *slopes], inputs, X, Y)
    np.testing.assert_allclose(value, function(X, Y), rtol=1e-14)
    step = 1e-30
    steps = function(X + 1j * step, Y), function(X, Y + 1j * step)
    for slope, moved in zip(found, steps):
        np.testing.assert_allclose(slope, moved.imag / step, rtol=1e-12, atol=1e-14)


BRANCHED = {
    "where": lambda x, y: np.where(x > 1.0, x * y, y) + np.where(y < x, x**3, 0.0),
    "bounds": lambda x, y: np.minimum(x, y) * np.maximum(y, 1.0) + np.clip(x, 0.5, 2.0),
    "absolute": lambda x, y: np.abs(x - y) + abs(1.0 - y) * x + np.sign(x - 1.0) * y,
    "logic": lambda x, y: np.where((x > 1.0) & (y < 1.0) | ~(x <= 2.0), x, y * y),
    "truth as number": lambda x, y: (x > 1.0) * y + x * (x <= 1.0) + np.heaviside(x - y, 0.5),
    "selected": lambda x, y: np.select([x < 1.0, x < 2.0], [x, x * y], 3.0 * y),
    "errors": lambda x, y: erf(x * y) + y * erfc(x),
    "others": lambda x, y: np.hypot(x, y) + np.fmin(x, y) + np.full_like(x, 2.0) * np.ones_like(y),
    "none": lambda x, y: 0.0 * np.zeros_like(x) + 7.0,
}


@pytest.mark.parametrize("function", BRANCHED.values(), ids=BRANCHED)
def test_values_and_derivatives_of_branches(function):
    graph, inputs, root = traced(function, "x", "y")
    slopes = [graph.derivatives([root], one)[0] for one in inputs]
    value, *found = values([root, *slopes], inputs, X, Y)
    np.testing.assert_allclose(value, function(X, Y), rtol=1e-14)
    step = 1e-6
    differences = [(function(X + step, Y) - function(X - step, Y)) / (2 * step),
                   (function(X, Y + step) - function(X, Y - step)) / (2 * step)]
    for slope, difference in zip(found, differences):
        np.testing.assert_allclose(slope, difference, rtol=1e-8, atol=1e-9)


def test_second_derivatives():
    graph, (x, y), root = traced(lambda x, y: np.exp(-x) * x * y**3, "x", "y")
    mixed = graph.derivatives(graph.derivatives([root], x), y)
    np.testing.assert_allclose(values(mixed, (x, y), X, Y)[0],
                               3 * Y**2 * (1 - X) * np.exp(-X), rtol=1e-14)


def test_at_a_corner_the_branch_that_is_taken_counts():
    graph, (x,), root = traced(lambda x: np.where(x <= 1.0, 2.0 * x, 3.0 * x - 1.0), "x")
    slope = values(graph.derivatives([root], x), (x,), np.array([1.0, 1.0 + 1e-15]))[0]
    np.testing.assert_array_equal(slope, [2.0, 3.0])


def test_what_is_equal_is_one():
    graph, (x, y), root = traced(lambda x, y: np.exp(x * y) + np.exp(y * x), "x", "y")
    assert [node.operation for node in graph.reachable([root])].count("exp") == 1
    assert graph.lift(x * 1.0 + 0.0) is x and (x - x).is_number(0.0)
    assert np.where(x > 0.0, y, y) is y and np.where(True, x, y) is x
    assert -(-x) is x and (-x) * (-y) is x * y and x + (-y) is x - y


def test_a_branch_knows_its_condition():
    graph, (x,), root = traced(lambda x: np.where(x > 1.0, np.where(x > 1.0, x, 0.0) * 2.0,
                                                  np.where(x > 1.0, 5.0, 1.0)), "x")
    assert [node.operation for node in graph.reachable([root])].count("where") == 1


def test_numbers_are_put_in_later():
    graph, (x, p), root = traced(lambda x, p: p + (1.0 - p) * np.exp(-x), "x", "p")
    assert graph.rebuilt([root], {p: 1.0})[0].is_number(1.0)
    assert graph.rebuilt([root], {x: 0.0, p: 0.3})[0].is_number(1.0)
    without = graph.rebuilt([root], {p: 0.0})
    np.testing.assert_array_equal(values(without, (x,), X)[0], np.exp(-X))


@pytest.mark.parametrize("function, words", [
    (lambda x: x if x > 0 else -x, "true .if, while.*np.where"),
    (lambda x: min(x, 1.0), "min, max"), (lambda x: 0 < x < 1, "a < b < c"),
    (lambda x: np.sum(x), "the function sum"), (lambda x: x.sum(), "asks for .sum"),
    (lambda x: np.maximum.reduce(x), "maximum.reduce"), (lambda x: x[0], "apart"),
    (lambda x: np.interp(x, [0, 1], [1, 2]), "interp"),
    (lambda x: np.exp(x, where=x > 0), "where="),
    (lambda x: x * np.arange(3.0), "the array array"), (lambda x: float(x), "one number"),
    (lambda x: np.add(x, 1.0, out=np.empty(3)), "in place"),
    (lambda x: x * "2", "neither a number"),
    (lambda x: np.array(x) + 1, "one number"), (lambda x: x + Graph().input("y"), "another call"),
    (lambda x: np.gcd(x, 2), "the function gcd")])
def test_what_cannot_be_traced_is_named(function, words):
    with pytest.raises(Untraceable, match=words):
        traced(function, "x")


def test_nothing_is_changed_in_place():
    def shifted(x):
        x -= 1.0
        return x

    with pytest.raises(Untraceable, match="x = x . y"):
        traced(shifted, "x")


# Programs

@pytest.mark.parametrize("count", [0, 1, 15, 16, 17, 250, 4000])
def test_programs_of_any_size(count):
    graph, inputs, root = traced(lambda x, y: np.where(x > y, np.exp(-x * x), y / (1.0 + x)),
                                 "x", "y")
    x, y = np.random.default_rng(1).uniform(0.0, 2.0, (2, count))
    expected = np.where(x > y, np.exp(-x * x), y / (1.0 + x))
    np.testing.assert_allclose(values([root], inputs, x, y)[0], expected, rtol=1e-15)


def test_a_program_keeps_its_memory_and_its_results_apart():
    graph, (x, y), root = traced(lambda x, y: np.where(x > y, x * y, np.exp(x) * y), "x", "y")
    program = Program([root, x, graph.number(2.0), root * root], (x, y))
    first = program.run(X, Y)
    kept = [part.copy() for part in first]
    assert all(np.shares_memory(a, b) for a, b in zip(first, program.run(Y, X)))
    for again, before in zip(program.run(X, Y), kept):
        np.testing.assert_array_equal(again, before)
    np.testing.assert_array_equal(kept[1], X)
    np.testing.assert_array_equal(kept[2], 2.0)
    for larger in (100, 1000, 12):
        assert len(program.run(np.ones(larger), np.ones(larger))[0]) == larger


def test_a_warm_program_takes_no_memory():
    import tracemalloc

    graph, (x, y), root = traced(lambda x, y: np.where(x > y, x * y, np.exp(x) * y), "x", "y")
    program, given = Program([root], (x, y)), np.ones((2, 4000))
    program.run(*given)
    tracemalloc.start()
    for _ in range(3):
        program.run(*given)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < given[0].nbytes / 4


def test_branches_that_are_not_taken_do_not_warn():
    graph, (x,), root = traced(lambda x: np.where(x > 0.0, np.log(x) / x, 0.0), "x")
    with np.errstate(all="raise"):
        assert values([root], (x,), np.array([0.0, 1.0]))[0].tolist() == [0.0, 0.0]


def test_the_first_operation_that_fails_is_found():
    graph, inputs, root = traced(lambda x, y: np.where(y > 1.0, 1.0 / (x - 2.0), 1.0 / y) * 3.0,
                                 "x", "y")
    program = Program([inputs[0] * 1.5, root], inputs)
    x = np.array([2.0, 3.0, 2.0])
    assert fault(program, x, np.array([0.5, 2.0, 1.0])) is None
    found = fault(program, x, np.array([0.5, 2.0, 1.5]))
    assert (found.result, found.arguments, found.values) == (1, (1.0, 0.0), (2.0, 1.5))
    assert found.operation == "divide(1, subtract(x, 2))"


def test_all_operations_are_differentiated_or_said_to_be_conditions():
    for name, operation in OPERATIONS.items():
        count = getattr(operation.function, "nin", 0)
        branches = name in ("where", "minimum", "maximum")
        assert operation.boolean or branches or len(operation.slopes) == count, name
