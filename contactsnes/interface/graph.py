"""Formulas as graphs: a function of NumPy's expressions is called with nodes in place of arrays;
what it does with them is written down, once each, and differentiated exactly."""

from numbers import Real

import numpy as np

from .operations import COMMUTATIVE, IDENTITIES, KNOWN, LOGICAL, OPERATIONS, REWRITTEN


class Untraceable(TypeError):
    """What a formula does that no graph can be made of, and what to use."""


class Node:
    """A value of a formula: an operation on others, an input or a number; equal ones of a graph are
    one.

    Parameters
    ----------
    graph, operation, arguments, value, boolean : as the attributes

    Attributes
    ----------
    graph : the graph that it is of
    index : its place there, behind those of its arguments
    operation, arguments : what it comes from; 'input' and 'number' come from nothing
    value : the number, or the name of the input, or how another one is told of
    boolean : whether it is true or false
    """

    __slots__ = ("graph", "index", "operation", "arguments", "value", "boolean")
    __hash__ = object.__hash__
    ndim, shape = 1, (-1,)

    def __init__(self, graph, operation, arguments, value, boolean):
        self.graph, self.index = graph, len(graph.nodes)
        self.operation, self.arguments = operation, arguments
        self.value, self.boolean = value, boolean

    def __array_ufunc__(self, function, method, *inputs, **others):
        if method != "__call__":
            raise Untraceable(_unknown(f"{function.__name__}.{method}"))
        if others:
            raise Untraceable(f"it calls np.{function.__name__} with {', '.join(others)}=, or "
                              "changes a value in place: write x = x + y for x += y, and np.where "
                              "for where=")
        return self.graph.apply(function.__name__, *inputs)

    def __array_function__(self, function, types, arguments, others):
        if function.__name__ not in {*REWRITTEN, "where"}:
            raise Untraceable(_unknown(function.__name__))
        return self.graph.apply(function.__name__, *arguments, **others)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        raise Untraceable(f"it asks for .{name} of a value at every node: {_USE}")

    def copy(self):
        """Itself: nodes do not change."""
        return self

    def is_number(self, value):
        """Whether it is this number."""
        return self.operation == "number" and not self.boolean and self.value == value

    def factor(self):
        """The number that a product has for a factor, or None."""
        return next((node for node in self.arguments if node.operation == "number"), None)

    def without(self, factor):
        """The other factor of a product."""
        return self.arguments[0] if self.arguments[1] is factor else self.arguments[1]

    def __repr__(self, depth=3):
        if self.value is not None:
            return self.value if isinstance(self.value, str) else f"{self.value:g}"
        inner = ", ".join(node.__repr__(depth - 1) if depth else "..." for node in self.arguments)
        return f"{self.operation}({inner})"


_USE = ("every operation has to be one on all nodes at once, as np.where(a > 0, x, y); or write "
        "evaluate(gap, traction, tangent=None), with the tangent")


def _unknown(name):
    return (f"it uses the function {name}, of which no derivative is known here: allowed are "
            f"arithmetic, comparisons, &, | and ~, NumPy's {', '.join(KNOWN)}, and SciPy's erf and "
            f"erfc; {_USE}")


def _operator(name, swapped=False):
    """A method of nodes for an operator of Python."""
    def method(self, other):
        return self.graph.apply(name, other, self) if swapped else self.graph.apply(name, self,
                                                                                    other)
    return method


def _refused(why):
    """A method of nodes that says why there is none."""
    def method(self, *others):
        raise Untraceable(f"{why}: {_USE}")
    return method


for _symbol, _name in (("add", "add"), ("sub", "subtract"), ("mul", "multiply"),
                       ("truediv", "divide"), ("pow", "power"), ("and", "logical_and"),
                       ("or", "logical_or")):
    setattr(Node, f"__{_symbol}__", _operator(_name))
    setattr(Node, f"__r{_symbol}__", _operator(_name, swapped=True))
    setattr(Node, f"__i{_symbol}__", _refused("it changes a value in place (as x += y does); write "
                                              "x = x + y"))
for _symbol, _name in (("lt", "less"), ("le", "less_equal"), ("gt", "greater"),
                       ("ge", "greater_equal"), ("eq", "equal"), ("ne", "not_equal")):
    setattr(Node, f"__{_symbol}__", _operator(_name))
for _symbol, _name in (("neg", "negative"), ("abs", "absolute"), ("invert", "logical_not"),
                       ("pos", "positive")):
    setattr(Node, f"__{_symbol}__", lambda self, name=_name: self.graph.apply(name, self))
for _symbols, _why in ((("bool",), "it asks whether a value at every node is true (if, while, and, "
                        "or, not, min, max, a < b < c)"),
                       (("float", "int", "index", "complex", "array"),
                        "it makes one number of the values at all nodes (float, math.exp, "
                        "np.array; take np.exp for math.exp)"),
                       (("len", "iter", "getitem", "setitem"),
                        "it takes nodes apart (len, for, x[...])")):
    for _symbol in _symbols:
        setattr(Node, f"__{_symbol}__", _refused(_why))


class Graph:
    """Nodes of a formula, each operation on the same arguments once.

    Attributes
    ----------
    nodes : all of them; arguments come before what is made of them
    """

    def __init__(self):
        self.nodes, self._known = [], {}

    def input(self, name):
        """The input of a name."""
        return self._entered(("input", name), "input", (), name, False)

    def number(self, value):
        """A number, or True or False."""
        truth = isinstance(value, (bool, np.bool_))
        value = bool(value) if truth else float(value) + 0.0  # there is one zero, 0.0
        return self._entered(("number", repr(value)), "number", (), value, truth)

    def lift(self, value):
        """A node of what may be one or a number."""
        if isinstance(value, Node):
            if value.graph is not self:
                raise Untraceable("it keeps values of another call: nothing may be stored")
            return value
        if isinstance(value, (Real, np.bool_)) or isinstance(value, np.ndarray) and value.ndim == 0:
            return self.number(value[()] if isinstance(value, np.ndarray) else value)
        what = f"the array {value!r:.40}" if isinstance(value, np.ndarray) else f"{value!r:.40}"
        raise Untraceable(f"it computes with {what}, which is neither a number nor made of gap and "
                          f"slip: {_USE}")

    def apply(self, name, *arguments, **others):
        """The node of an operation on others, as short as identities make it.

        Parameters
        ----------
        name : str, of NumPy's function
        arguments : nodes or numbers
        others : arguments by name, which only functions that are rewritten take
        """
        if name in REWRITTEN:
            return self.lift(REWRITTEN[name](*arguments, **others))
        if name not in OPERATIONS or others:
            raise Untraceable(_unknown(name))
        arguments = [self.lift(value) for value in arguments]
        truth = LOGICAL if name in LOGICAL else ("where",) if name == "where" else ()
        if truth:
            count = 1 if name == "where" else len(arguments)
            arguments[:count] = [self._truth(node) for node in arguments[:count]]
        else:
            arguments = [self._numeric(node) for node in arguments]
        if all(node.operation == "number" for node in arguments):
            with np.errstate(all="ignore"):
                values = [node.value for node in arguments]
                return self.number(OPERATIONS[name].function(*values)[()])
        shorter = IDENTITIES[name](self, *arguments) if name in IDENTITIES else None
        return self.intern(name, tuple(arguments)) if shorter is None else shorter

    def _truth(self, node):
        return node if node.boolean else self.apply("not_equal", node, 0.0)

    def _numeric(self, node):
        """A number of what is true or false."""
        return self.apply("where", node, 1.0, 0.0) if node.boolean else node

    def intern(self, name, arguments):
        """The node of an operation on nodes, as it stands."""
        if name in COMMUTATIVE:
            arguments = tuple(sorted(arguments, key=lambda node: node.index))
        boolean = OPERATIONS[name].boolean
        if name == "where":
            boolean = arguments[1].boolean and arguments[2].boolean
            if not boolean:
                arguments = (arguments[0], *map(self._numeric, arguments[1:]))
        key = (name, *(node.index for node in arguments))
        return self._entered(key, name, arguments, None, boolean)

    def _entered(self, key, *parts):
        if key not in self._known:
            self._known[key] = Node(self, *parts)
            self.nodes.append(self._known[key])
        return self._known[key]

    @staticmethod
    def reachable(roots):
        """Nodes that some are made of, and these, arguments first."""
        found, left = {}, list(roots)
        while left:
            node = left.pop()
            if node.index not in found:
                found[node.index] = node
                left.extend(node.arguments)
        return [found[index] for index in sorted(found)]

    def rebuilt(self, roots, mapping):
        """Roots in which nodes are replaced.

        ``mapping`` is node -> node or number. What is made of them is shortened again.
        """
        made = {node.index: self.lift(value) for node, value in mapping.items()}
        for node in self.reachable(roots):
            if node.index not in made:
                now = [made[argument.index] for argument in node.arguments]
                same = all(new is old for new, old in zip(now, node.arguments))
                made[node.index] = node if same else self.apply(node.operation, *now)
        return [made[root.index] for root in roots]

    def assume(self, node, condition, truth):
        """A node where a condition is known to hold, or not to.

        Parameters
        ----------
        node, condition : Node
        truth : bool
        """
        if condition.index > node.index:
            return node
        return self.rebuilt([node], {condition: truth})[0]

    def derivatives(self, roots, variable, known=None):
        """Exact derivatives of roots to a variable; conditions have none, and at a corner they are
        those of the branch that is taken.

        Parameters
        ----------
        roots : nodes
        variable : node
        known : node -> its derivative, where that is given
        """
        slopes = {node.index: self.lift(slope) for node, slope in (known or {}).items()}
        slopes[variable.index] = self.number(1.0)
        for node in self.reachable(roots):
            if node.index not in slopes:
                slopes[node.index] = self._slope(node, [slopes[argument.index]
                                                        for argument in node.arguments])
        return [slopes[root.index] for root in roots]

    def _slope(self, node, inner):
        """The derivative of a node, from those of its arguments."""
        name, arguments = node.operation, node.arguments
        if node.boolean or not arguments:
            return self.number(0.0)
        if name == "where":
            return self.apply("where", arguments[0], *inner[1:])
        if name in ("minimum", "maximum"):
            first = self.apply("less" if name == "minimum" else "greater", *arguments)
            return self.apply("where", first, *inner)
        total = self.number(0.0)
        for slope, to in zip(OPERATIONS[name].slopes, inner):
            if not to.is_number(0.0):
                total = total + slope(node, *arguments) * to
        return total

