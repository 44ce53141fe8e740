"""Formulas of laws: from tractions that are written once, tangents, and programs of NumPy."""

import copy
from functools import cached_property

import numpy as np

from ..options.fields import InputError
from .graph import Graph, Untraceable
from .program import Program

LEAST = 1e-150
"""Slip, in ranges, below which db/d(b^2) = 1/(2 b) grows no more: times the slip it vanishes."""

SHEARED = ("N", "S = T/b", "dN/da", "(dN/db)/b", "dS/da", "(dS/db)/b")
"""Results of a sheared formula: normal traction N, secant of the friction S = T/b, and derivatives
to the normal gap a and the slip b."""

NORMAL = ("N", "dN/da")
"""Results of a formula without slip."""


class Formula:
    """Tractions of a law as a graph: the inputs are the normal gap a and the squared slip q = b^2,
    in ranges of the law, and the law's parameters.

    Parameters
    ----------
    law : Law with ``tractions``

    Attributes
    ----------
    parameters, values : names of the numbers that the graph has as inputs, and the law's values;
        none where its tractions do with them what no graph has
    gap, squared : inputs a and q
    """

    def __init__(self, law):
        try:
            self._trace(law, law.parameters)
        except (Exception, SystemExit):  # whatever a law does with a parameter that is no number
            self._trace_numbers(law)
        self.values = tuple(float(getattr(law, name)) for name in self.parameters)

    def _trace_numbers(self, law):
        """Trace with the parameters' values; InputError where a law cannot be traced at all."""
        title = type(law).__name__
        try:
            self._trace(law, ())
        except Untraceable as error:
            raise InputError(f"the law {title} has tractions(a, b) that cannot be "
                             f"differentiated: {error}") from error
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            raise InputError(f"the law {title} has tractions(a, b) that cannot be evaluated "
                             f"({type(error).__name__}: {error}); mend it") from error

    def _trace(self, law, parameters):
        """Call the law's tractions with nodes for gap, slip and parameters."""
        graph = self.graph = Graph()
        self.parameters = tuple(parameters)
        self.gap, self.squared = graph.input("a"), graph.input("q")
        self.symbols = tuple(graph.input(name) for name in self.parameters)
        self.slip = graph.apply("sqrt", self.squared)
        self.slip.value = "b"
        twin = _twin(law, dict(zip(self.parameters, self.symbols)))
        made = twin.tractions(self.gap, self.slip)
        if not isinstance(made, (tuple, list)) or len(made) != 2:
            raise Untraceable("it returns something else than two values, the normal traction N "
                              "and the friction over the slip T/b")
        self.roots = [0.0 + graph.lift(value) for value in made]
        self.deepest = graph.lift(twin.deepest)

    @cached_property
    def _slopes(self):
        """(N, S), (N_a, S_a), (N_b/b, S_b/b) where nothing is continued."""
        turned = {self.slip: 0.5 / self.graph.apply("maximum", self.slip, LEAST)}
        return (self.roots, self.graph.derivatives(self.roots, self.gap),
                self._by_slip(self.roots, turned))

    def _by_slip(self, roots, turned):
        """Derivatives to the slip over the slip, 2 d/dq."""
        return [2.0 * slope for slope in self.graph.derivatives(roots, self.squared, turned)]

    def results(self, sheared, continued):
        """Nodes of SHEARED, or of NORMAL.

        Parameters
        ----------
        sheared : whether there is slip
        continued : whether there are gaps below ``deepest``, where tractions continue linearly
        """
        graph, (values, opening, slipping) = self.graph, self._slopes
        if continued:
            turned = {self.slip: 0.5 / graph.apply("maximum", self.slip, LEAST)}
            mixed = self._by_slip(opening, turned)
            bounded = graph.apply("maximum", self.gap, self.deepest)
            depth = self.gap - bounded
            parts = [*values, *opening, *slipping, *mixed]
            parts = graph.rebuilt(parts, {self.gap: bounded})
            values, opening, slipping, mixed = (parts[i:i + 2] for i in (0, 2, 4, 6))
            values = [value + slope * depth for value, slope in zip(values, opening)]
            slipping = [value + slope * depth for value, slope in zip(slipping, mixed)]
        if sheared:
            return (*values, opening[0], slipping[0], opening[1], slipping[1])
        return tuple(graph.rebuilt([values[0], opening[0]], {self.squared: 0.0}))

    def program(self, sheared, continued, tangent):
        """The Program of `results` with the law's parameters; its inputs are a and q, or a.

        Parameters
        ----------
        sheared, continued : as of `results`
        tangent : bool, whether derivatives are wanted
        """
        roots = self.graph.rebuilt(self.results(sheared, continued),
                                   dict(zip(self.symbols, self.values)))
        inputs = (self.gap, self.squared) if sheared else (self.gap,)
        return Program(roots if tangent else roots[:2 if sheared else 1], inputs)


def _twin(law, parameters):
    """A copy of a law that has nodes for parameters, and nothing that it has kept of their
    values."""
    twin = copy.copy(law)
    own = vars(twin)
    for name in list(own):
        if isinstance(getattr(type(law), name, None), cached_property):
            del own[name]
    own.update(parameters)
    return twin


class Tractions:
    """Tractions and tangents of a formula at arrays of gaps.

    Parameters
    ----------
    formula : Formula
    """

    block = 4096
    """Nodes that are evaluated at once: what is computed on the way stays in the cache."""

    def __init__(self, formula):
        self.formula, self._programs = formula, {}
        deepest = formula.graph.rebuilt([formula.deepest],
                                        dict(zip(formula.symbols, formula.values)))[0]
        self._deepest = deepest.value

    def program(self, *which):
        """The program of `Formula.program`, made once."""
        if which not in self._programs:
            self._programs[which] = self.formula.program(*which)
        return self._programs[which]

    def evaluate(self, gap, traction, tangent):
        """Fill ``traction`` and ``tangent``.

        Parameters
        ----------
        gap, traction, tangent : as of `Law.evaluate`
        """
        fill = self._normal if len(gap) == 1 else self._sheared
        nodes = gap.shape[1]
        for start in range(0, nodes, self.block):
            part = np.s_[..., start:start + self.block] if nodes > self.block else ...
            fill(gap[part], traction[part], None if tangent is None else tangent[part])

    def normal(self, gap):
        """N(a) and N'(a) without slip, two arrays (nodes)."""
        if len(gap) <= self.block:
            return [part.copy() for part in self._alone(gap, True)]
        both = np.empty((2, len(gap)))
        for start in range(0, len(gap), self.block):
            part = np.s_[start:start + self.block]
            both[0, part], both[1, part] = self._alone(gap[part], True)
        return both

    def _alone(self, gap, tangent):
        return self.program(False, self._continued(gap), tangent).run(gap)

    def _continued(self, normal_gap):
        return bool(np.minimum.reduce(normal_gap, initial=0.0) < self._deepest)

    def _normal(self, gap, traction, tangent):
        """One component."""
        values = self._alone(gap[0], tangent is not None)
        traction[0] = values[0]
        if tangent is not None:
            tangent[0, 0] = values[1]

    def _sheared(self, gap, traction, tangent):
        """Two or three: t_t = S s, dt_t/ds = S + (S_b/b) s s, without a division by the slip."""
        slip = gap[1:]
        squared = slip[0] * slip[0]
        for other in slip[1:]:
            squared += other * other
        program = self.program(True, self._continued(gap[0]), tangent is not None)
        normal, secant, *slopes = program.run(gap[0], squared)
        if tangent is not None:
            tangent[0, 0] = slopes[0]
            np.multiply(slopes[1], slip, out=tangent[0, 1:])
            np.multiply(slopes[2], slip, out=tangent[1:, 0])
            self._along(slopes[3], secant, slip, tangent[1:, 1:])
        np.multiply(secant, slip, out=traction[1:])
        traction[0] = normal

    @staticmethod
    def _along(slope, secant, slip, out):
        """S + (S_b/b) s s."""
        for i, one in enumerate(slip):
            for j, other in enumerate(slip[:i + 1]):
                np.multiply(slope, one, out=out[i, j])
                out[i, j] *= other
                out[j, i] = out[i, j]
            out[i, i] += secant
