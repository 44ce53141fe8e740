"""Nodes of a contact, and states there, as the library is asked about them: one pass over the nodes
for all that is asked together."""

from ctypes import addressof, c_void_p, pointer

import numpy as np

from . import structures
from .library import shared
from .structures import address


class States:
    """Displacements of states at the same nodes, as the library takes them.

    Parameters
    ----------
    fields : arrays (components, nodes)

    Attributes
    ----------
    places : where each of them begins, as an array of C
    """

    def __init__(self, fields):
        self.fields = [np.ascontiguousarray(field, dtype=float) for field in fields]
        self.count, self.shape = len(fields), self.fields[0].shape
        self.places = (c_void_p * self.count)(*map(address, self.fields))


class Site:
    """Nodes of a contact: what the library knows of them for as long as they are asked for.

    Parameters
    ----------
    law : LawKernel
    initial_gap, weights : arrays (nodes,), delta_n, and for how many nodes each stands (None: one)
    about : further fields of `structures.Site`, by name

    Attributes
    ----------
    halved : whether they are half of a line
    gap : where their initial gaps begin
    """

    def __init__(self, law, initial_gap, weights, **about):
        self._kept = law, initial_gap, weights
        self._structure = structures.Site(pointer(law.structure), len(initial_gap),
                                          address(initial_gap), address(weights), **about)
        self.reference, self._library = addressof(self._structure), shared()
        self.halved, self.gap = bool(self._structure.halved), self._structure.initial_gap

    def survey(self, displacement):
        """Numbers and tractions of a state, as of `contact.survey.by_numpy`; behind the numbers, of
        half a line, by how much tractions alternate.

        Parameters
        ----------
        displacement : array (components, nodes)
        """
        displacement = np.ascontiguousarray(displacement, dtype=float)
        components, nodes = displacement.shape
        numbers, traction = np.empty(8 + 2 * components), np.empty((components, nodes))
        self._library.survey(self.reference, components, address(displacement), address(numbers),
                             address(traction))
        return numbers, traction

    def strays(self, states, limits):
        """How a step lies to its prediction, an array (11,), as of `contact.ways._by_numpy`.

        Parameters
        ----------
        states : States, where it was foretold, where it ended and where it began
        limits : structures.Limits
        """
        numbers = np.empty(11)
        self._library.strays(self.reference, states.shape[0], states.places, addressof(limits),
                             address(numbers))
        return numbers

    def releases(self, states, limits, moved):
        """What nodes release on the way of a step, and what linear springs do, summed over the sets
        of `contact.acceptance._suspects`, an array (2, 3).

        Parameters
        ----------
        states, limits : as of `strays`
        moved : largest way where the law acts, ranges
        """
        numbers = np.empty((2, 3))
        self._library.releases(self.reference, states.shape[0], states.places, addressof(limits),
                               moved, address(numbers))
        return numbers

    def reaches(self, field, last, least):
        """How far from the middle of an even line its end of contact, its slip front and its end of
        pressure are, as of `contact.fronts`, in nodes, an array (3,); 0 where there is none.

        Parameters
        ----------
        field : array (components, nodes), from the middle outwards
        last : int, nodes from the middle to the end of the line
        least : nodes between an end of pressure and the others, at least
        """
        field = np.ascontiguousarray(field, dtype=float)
        found, work = np.empty(3), np.empty(field.shape[1] + 2)
        self._library.reaches(self.reference, len(field), address(field), last, least,
                              address(work), address(found))
        return found

    def squares_along(self, states):
        """Squares of the ways from each of some states to the next, summed over components and
        nodes, array (states - 1,)."""
        numbers = np.empty(states.count - 1)
        self._library.squares_along(self.reference, states.shape[0], states.count, states.places,
                                    address(numbers))
        return numbers

    def works_along(self, states, weights, squares, first, twins, rules, reach):
        """Works on nodes along a path, as of `contact.interface_work._by_numpy`, array (3,
        components).

        Parameters
        ----------
        states : States, up to four
        weights : array (nodes,), for how many nodes each stands here; None: as everywhere
        squares : array, `squares_along` of all nodes
        first : number of the state from which on
        twins, rules : as of `contact.work_along`
        reach : normal gap below which the law acts
        """
        numbers = np.empty((3, states.shape[0]))
        self._library.works_along(self.reference, states.shape[0], states.count, states.places,
                                  address(weights), address(squares), first, twins, address(rules),
                                  reach, address(numbers))
        return numbers
