"""Overdamped motion linearised at a state that mirrors leave as it is: J on fields that are even
and on fields that are odd, each at the nodes of half a line, a quarter of a plane or half of it."""

from itertools import product

import numpy as np

from ..contact.states import State
from ..solvers.core_zone import CoreOptions
from .linearised import Overdamped, mirrored


class Parted:
    """J and its preconditioner as of `linearised.Overdamped`, for vectors that consist of the parts
    that differ in symmetry, one after the other.

    Lengths and products of vectors are those of whole fields. A part that is zero costs nothing.
    Where processes share out the nodes, each has of every part the rows of a quarter.

    Parameters
    ----------
    contact, window, controls : as of `linearised.Overdamped`, the window centred
    axes : (direction, sign of each component) of the mirror images that leave the state as it is,
        at least one
    options : CoreOptions of the preconditioner
    """

    def __init__(self, contact, window, controls, axes, options=CoreOptions()):
        self._axes = axes
        parities = np.zeros((len(controls), len(window.shape)), dtype=int)
        directions = [axis for axis, _ in axes]
        parities[:, directions] = np.array([signs for _, signs in axes]).T
        self.window, self.components, self._each = window, len(controls), []
        for turned in product((1, -1), repeat=len(axes)):
            factor = np.zeros(len(window.shape), dtype=int)
            factor[directions] = turned
            self._each.append(Overdamped(contact, window, controls, options,
                                         tuple(map(tuple, (parities * factor).tolist()))))
        self.lengths = [one.size for one in self._each]
        ends = np.cumsum([0, *self.lengths]).tolist()
        self._places, self.size = [slice(*ends) for ends in zip(ends, ends[1:])], ends[-1]
        kernels = [one.kernel for one in self._each]
        self.kernels = kernels if all(kernels) else None
        self.occupied = np.concatenate([one.occupied for one in self._each])
        self.shared = self._each[0].shared

    @property
    def products(self):
        """Number of products so far, those of all parts as one."""
        return -(-sum(one.products for one in self._each) // len(self._each))

    def linearise(self, state):
        """Take the law's tangent at a state, and make the preconditioners from it."""
        first, *others = self._each
        first.linearise(state)
        for one in others:
            one.linearise(state, first)

    def apply(self, vector):
        """J vector."""
        return self._by_part("apply", vector)

    def precondition(self, vector):
        """About J^-1 vector."""
        return self._by_part("precondition", vector)

    def _by_part(self, name, vector):
        """What a method of the parts makes of a vector."""
        result = np.zeros(self.size)
        parts = self.parts(vector)
        some = self.window.grid.together([part.any() for part in parts])
        for one, part, place, holds in zip(self._each, parts, self._places, some):
            if holds:
                result[place] = getattr(one, name)(part)
        return result

    def vector(self, mode):
        """The vector of a mode as a state."""
        parts = [mode.displacement]
        for axis, signs in self._axes:
            images = [mirrored(self.window, part, axis, signs) for part in parts]
            parts = [0.5 * each for part, image in zip(parts, images)
                     for each in (part + image, part - image)]
        return np.concatenate([one.vector(State(self.window, part, mode.means))
                               for one, part in zip(self._each, parts)])

    def state(self, vector):
        """The mode as a state, of a real vector."""
        found = [one.state(own) for one, own in zip(self._each, self.parts(vector))]
        return State(self.window, sum(state.displacement for state in found),
                     sum(state.means for state in found))

    def pieces(self, vector):
        """As of `linearised.Overdamped`, of all parts."""
        return [piece for one, own in zip(self._each, self.parts(vector))
                for piece in one.pieces(own)]

    def uniform(self):
        """As of `linearised.Overdamped`, each of the part that has it."""
        return [self.whole(number, vector) for number, one in enumerate(self._each)
                for vector in one.uniform()]

    def noise(self, seed):
        """A vector of random numbers, the same however its nodes are shared out."""
        return np.concatenate([one.noise(len(self._each) * seed + number)
                               for number, one in enumerate(self._each)])

    def parts(self, vector):
        """The parts of a vector."""
        return [vector[place] for place in self._places]

    def whole(self, number, rows):
        """Vectors (..., size) of a part (..., its length) by its number."""
        found = np.zeros((*rows.shape[:-1], self.size), rows.dtype)
        found[..., self._places[number]] = rows
        return found
