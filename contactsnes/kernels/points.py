"""What is asked of points and of steps, in the library: one pass over the nodes for all of it."""

import math

import numpy as np

from .library import shared
from .structures import address

MOST = 4
"""States that a function takes at once, at most."""


def _flat(*arrays):
    """Contiguous arrays of doubles."""
    return [None if array is None else np.ascontiguousarray(array, dtype=float)
            for array in arrays]


def survey(kernel, displacement, initial_gap, weights, limits):
    """Numbers and tractions of a state, as of `contact.survey.by_numpy`.

    Parameters
    ----------
    kernel : LawKernel
    displacement, initial_gap, weights, limits : as of that
    """
    displacement, initial_gap, weights, limits = _flat(displacement, initial_gap, weights, limits)
    numbers, traction = np.empty(7 + 2 * len(displacement)), np.empty_like(displacement)
    shared().survey(kernel.reference, *displacement.shape, address(displacement),
                    address(initial_gap), address(weights), address(limits), address(numbers),
                    address(traction))
    return numbers, traction


def apart(first, second, initial_gap, weights, reach):
    """The largest difference of two displacements where the law acts on either, how many nodes
    these are, and the sum of its squares there, an array (3,).

    Parameters
    ----------
    first, second : arrays (components, nodes)
    initial_gap, weights : arrays (nodes,), the second None where all are one
    reach : normal gap below which the law acts
    """
    first, second, initial_gap, weights = _flat(first, second, initial_gap, weights)
    numbers = np.empty(3)
    shared().apart(*first.shape, address(first), address(second), address(initial_gap),
                   address(weights), reach, address(numbers))
    return numbers


def closest(displacement, initial_gap):
    """Smallest normal gap of normal displacements, arrays (nodes,)."""
    displacement, initial_gap = _flat(displacement, initial_gap)
    return shared().closest(len(displacement), address(displacement), address(initial_gap))


def combined(known, weights, initial_gap, floor):
    """Weighted sum of up to four displacements (components, nodes), without normal gaps below a
    floor.

    Parameters
    ----------
    known : list of arrays (components, nodes)
    weights : numbers, one of each
    initial_gap : array (nodes,)
    floor : float
    """
    count, known, (initial_gap, weights) = len(known), _states(known), _flat(initial_gap, weights)
    found = np.empty_like(known[0])
    shared().combined(*found.shape, count, *map(address, known), address(weights),
                      address(initial_gap), floor, address(found))
    return found


def extremes(shape, change, root, counts, scale, weights):
    """The largest size of a change at the nodes that count, and the sum of their squares, an array
    (2,), as of `dynamics.viscous.Equations.size`.

    Parameters
    ----------
    shape : (components, nodes)
    change : array that begins with the change
    root : float, its unit, ranges
    counts, weights : arrays (nodes,), 1 or 0, and for how many nodes each stands (None: all one)
    scale : array (components, nodes) or None, what sizes are told in
    """
    numbers = np.empty(2)
    shared().extremes(*shape, address(change), root, address(counts), address(scale),
                      address(weights), address(numbers))
    return numbers


def strays(foretold, ended, began, initial_gap, weights, limits):
    """How a step lies to its prediction, an array (11,), as of `contact.acceptance._by_numpy`.

    Parameters
    ----------
    foretold, ended, began, initial_gap, weights, limits : as of that
    """
    fields = _flat(foretold, ended, began, initial_gap, weights)
    numbers = np.empty(11)
    shared().strays(*fields[0].shape, *map(address, fields), address(limits), address(numbers))
    return numbers


def releases(kernel, foretold, ended, began, initial_gap, weights, parts, rule, limits, moved):
    """What nodes release on the way of a step, and what linear springs do, summed over the sets of
    `contact.acceptance._suspects`, an array (2, 3).

    Parameters
    ----------
    kernel : LawKernel
    foretold, ended, began, initial_gap, weights, limits : as of `strays`
    parts : weights of the components
    rule : (places, shares) of the quadrature
    moved : largest way where the law acts, ranges
    """
    fields, (places, shares) = _flat(foretold, ended, began, initial_gap, weights), rule
    numbers = np.empty((2, 3))
    shared().releases(kernel.reference, *fields[0].shape, *map(address, fields), address(parts),
                      len(places), address(places), address(shares), address(limits), moved,
                      address(numbers))
    return numbers


def crossings(values, level):
    """As `grid.contours.crossings`.

    Parameters
    ----------
    values, level : as of that
    """
    (values,), room = _flat(values), 32
    while True:
        places, signs = found = np.empty((2, room))
        count = shared().crossings(len(values), address(values), level, room, address(places),
                                   address(signs))
        if count <= room:
            return found[:, :count]
        room = count


def reaches(field, initial_gap, last, level, peak, least):
    """How far from the middle of an even line its end of contact, its slip front and its end of
    pressure are, as of `contact.fronts`, in nodes, an array (3,); 0 where there is none.

    Parameters
    ----------
    field, initial_gap : arrays (components, nodes) and (nodes), from the middle outwards
    last : int, nodes from the middle to the end of the line
    level, peak : normal gap of contact, and slip of the law's peak
    least : nodes between an end of pressure and the others, at least
    """
    found, work = np.empty(3), np.empty(len(initial_gap) + 2)
    shared().reaches(*field.shape, address(field), address(initial_gap), last, level, peak, least,
                     address(work), address(found))
    return found


def alternation(boxes, axis, image=0, closed=False, beyond=0):
    """As `grid.alternation.alternation`.

    Parameters
    ----------
    boxes, axis, image, closed, beyond : as of that
    """
    (boxes,), shape = _flat(boxes), boxes.shape
    return shared().alternation(math.prod(shape[:axis]), shape[axis], math.prod(shape[axis + 1:]),
                                address(boxes), image, closed, beyond)


def alternation_of_halves(fields, signs, closed, least):
    """The largest `alternation` of fields on half of a line, each over its largest size, or
    ``least`` where that is less, by which they are divided in place.

    Parameters
    ----------
    fields : array (components, nodes), more nodes than the difference reaches
    signs : for each component 1 (even) or -1 (odd)
    closed : bool, whether there are images at the end, too
    least : float
    """
    signs = np.array(signs, dtype=np.intc)
    return shared().alternation_of_halves(*fields.shape, address(fields), address(signs), closed,
                                          least)


def path_work(displacements, forces, give, weights, first, limits, rules):
    """Work along a path, as of `contact.work_along.path_work`.

    Parameters
    ----------
    displacements, forces, give, weights, first : as of that
    limits : array of its `TWINS`, `REACH` and `SURER`
    rules : array, places and shares of the rules of Gauss and Legendre of two points on
    """
    given = _flat(displacements, forces, give, weights)
    return shared().path_work(len(displacements), first, len(give), *map(address, given),
                              address(limits), address(rules))


def works_along(kernel, known, initial_gap, weights, reach, rule):
    """Works on nodes along a path, as of `contact.interface_work`, array (3, components).

    Parameters
    ----------
    kernel : LawKernel
    known : up to four arrays (components, nodes)
    initial_gap, weights : arrays (nodes,), the second None where all are one
    reach : normal gap below which the law acts
    rule : array (2, states, places), as of that
    """
    known, (initial_gap, weights, values, slopes) = _states(known), _flat(initial_gap, weights,
                                                                          *rule)
    numbers = np.empty((3, len(known[0])))
    shared().works_along(kernel.reference, *known[0].shape, len(values), *map(address, known),
                         address(initial_gap), address(weights), reach, *values.shape,
                         address(values), address(slopes), address(numbers))
    return numbers


def squares_along(known, weights):
    """Squares of the ways from each of some states to the next, summed over components and nodes,
    array (states - 1,).

    Parameters
    ----------
    known : up to four arrays (components, nodes)
    weights : array (nodes,), None where all are one
    """
    numbers, count = np.empty(len(known) - 1), len(known)
    known, (weights,) = _states(known), _flat(weights)
    shared().squares_along(*known[0].shape, count, *map(address, known), address(weights),
                           address(numbers))
    return numbers


def _states(known):
    """`MOST` contiguous arrays, those that are missing None."""
    return _flat(*known, *[None] * (MOST - len(known)))
