"""Programs: graphs of formulas as lists of NumPy's operations on memory that is kept."""

import threading
from typing import NamedTuple

import numpy as np

from .operations import OPERATIONS, QUIET


class Fault(NamedTuple):
    """A result that is not finite, and where it comes from.

    Attributes
    ----------
    result : number of the root
    operation : the first operation that makes something infinite or undefined of finite values
    arguments : these values
    values : those of the inputs there
    """

    result: int
    operation: str
    arguments: tuple
    values: tuple


class _Memory(threading.local):
    """Memory that all programs of a thread compute in: one runs at a time."""

    def __init__(self):
        self.bytes = np.zeros(0, dtype=np.uint8)

    def of(self, count):
        """So many bytes at least."""
        if len(self.bytes) < count:
            self.bytes = np.zeros(count, dtype=np.uint8)
        return self.bytes


class _Sizes(threading.local):
    """What a program has prepared in a thread: size -> (memory, steps, inputs, results)."""

    def __init__(self):
        self.known = {}


_MEMORY = _Memory()


class Program:
    """Values of some nodes of a graph, for arrays of inputs. Where a size has been met it takes no
    memory; what it returns holds until a program runs again in the thread.

    Parameters
    ----------
    roots : nodes, of which values are wanted
    inputs : nodes, in the order in which they are given
    """

    def __init__(self, roots, inputs):
        self.roots, self.inputs = tuple(roots), tuple(inputs)
        graph = self.roots[0].graph
        self.nodes = [node for node in graph.reachable(roots)
                      if node.operation not in ("input", "number")]
        self._quiet = all(node.operation in QUIET or _is_safe(node) for node in self.nodes)
        self._plan()
        self._sizes = _Sizes()

    def run(self, *inputs):
        """Values of the roots, arrays like the inputs (nodes); they are overwritten by the next
        run of a program."""
        count = len(inputs[0])
        _, steps, taken, results = self._bound(count)
        for own, given in zip(taken, inputs):
            own[:count], own[count:] = given, 0.0
        if self._quiet:
            for function, arguments in steps:
                function(*arguments)
        else:
            with np.errstate(all="ignore"):
                for function, arguments in steps:
                    function(*arguments)
        return [result[:count] for result in results]

    def _plan(self):
        """Which of the buffers each node is in: that of an argument, where this is not needed any
        more."""
        last = {argument.index: node.index for node in self.nodes for argument in node.arguments}
        last.update({node.index: np.inf for node in self.roots})
        self._kinds = [float] * len(self.inputs)
        self._place = {node.index: place for place, node in enumerate(self.inputs)}
        free = {float: [], bool: []}
        for node in self.nodes:
            ended = {argument.index: argument for argument in node.arguments
                     if last[argument.index] == node.index and argument.index in self._place}
            kind = bool if node.boolean else float
            if node.operation == "where":
                # Its second branch is overwritten by the first one: the others may not be.
                kept = ended.pop(node.arguments[2].index, None)
                if kept is not None and kept.boolean == node.boolean:
                    self._place[node.index] = self._place[kept.index]
                else:
                    self._place[node.index] = self._taken(free, kind)
                    ended.update({} if kept is None else {kept.index: kept})
                self._release(free, ended)
            else:
                self._release(free, ended)
                self._place[node.index] = self._taken(free, kind)

    def _taken(self, free, kind):
        if not free[kind]:
            self._kinds.append(kind)
            return len(self._kinds) - 1
        return free[kind].pop()

    def _release(self, free, ended):
        for node in ended.values():
            free[bool if node.boolean else float].append(self._place[node.index])

    def _bound(self, count):
        """Steps, inputs and results on memory for so many nodes, or up to an eighth more, so that
        there are few sizes."""
        step = 1 << max(4, count.bit_length() - 4)
        size = -(-count // step) * step
        known = self._sizes.known
        if size not in known or known[size][0] is not _MEMORY.bytes:
            known[size] = self._prepared(size)
        return known[size]

    def _prepared(self, size):
        """(memory, steps as functions and arguments, inputs, results) for so many nodes."""
        # Buffers follow each other, a line of the cache apart.
        lengths = [size * np.dtype(kind).itemsize + 64 & ~63 for kind in self._kinds]
        memory = _MEMORY.of(sum(lengths))
        ends = np.cumsum([0, *lengths])
        buffers = [memory[start:start + size * np.dtype(kind).itemsize].view(kind)
                   for start, kind in zip(ends, self._kinds)]
        return memory, *self._steps(buffers)

    def _steps(self, memory):
        """Steps as functions and arguments, inputs and results in buffers."""
        def held(node):
            return (np.array(node.value) if node.operation == "number"
                    else memory[self._place[node.index]])

        steps = []
        for node in self.nodes:
            out, arguments = held(node), [held(argument) for argument in node.arguments]
            if node.operation == "where":
                condition, first, second = arguments
                if second is not out:
                    steps.append((np.copyto, (out, second)))
                steps.append((np.putmask, (out, condition, first)))
            else:
                steps.append((OPERATIONS[node.operation].function, (*arguments, out)))
        results = []
        for root in self.roots:
            value = held(root)
            if value.ndim == 0:  # a number, the same at every node
                value = np.full(len(memory[0]), value)
            results.append(value)
        return steps, [memory[place] for place in range(len(self.inputs))], results


def _is_safe(node):
    """Whether a root is that of an input, or a quotient has a divisor that is never 0."""
    last = node.arguments[-1]
    if node.operation == "divide":
        bounds = last.arguments if last.operation == "maximum" else (last,)
        return any(bound.operation == "number" and bound.value > 0.0 for bound in bounds)
    return node.operation == "sqrt" and last.operation == "input"


def fault(program, *inputs):
    """The Fault at the first place where a result of a program is not finite; None where all are.

    What is not finite in a branch of np.where that is not taken does no harm.
    """
    values = {node.index: np.asarray(given, dtype=float)
              for node, given in zip(program.inputs, inputs)}
    like = values[program.inputs[0].index]
    with np.errstate(all="ignore"):
        for node in program.roots[0].graph.reachable(program.roots):
            if node.operation == "number":
                values[node.index] = np.full(like.shape, node.value)
            elif node.index not in values:
                values[node.index] = OPERATIONS[node.operation].function(
                    *(values[argument.index] for argument in node.arguments))
    for number, root in enumerate(program.roots):
        bad = np.flatnonzero(~np.isfinite(values[root.index]))
        if bad.size:
            found = _origin(root, {index: value[bad[0]] for index, value in values.items()})
            return Fault(number, repr(found),
                         tuple(float(values[node.index][bad[0]]) for node in found.arguments),
                         tuple(float(given[bad[0]]) for given in inputs))
    return None


def _origin(node, values):
    """The first operation with finite arguments that a value comes from that is not finite."""
    while True:
        arguments = node.arguments
        if node.operation == "where":
            arguments = (arguments[1 if values[arguments[0].index] else 2],)
        bad = [argument for argument in arguments if not np.isfinite(values[argument.index])]
        if not bad:
            return node
        node = bad[0]
