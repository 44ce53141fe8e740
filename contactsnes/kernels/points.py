"""What is asked of fields and of paths, in the library."""

import math
from ctypes import c_void_p

import numpy as np

from .library import shared
from .sites import States
from .structures import address


def _flat(*arrays):
    """Contiguous arrays of doubles."""
    return [None if array is None else np.ascontiguousarray(array, dtype=float)
            for array in arrays]


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


def combined(known, weights, changes, shares, initial_gap, floor):
    """Weighted sum of displacements (components, nodes), and of changes of such, without normal
    gaps below a floor.

    Parameters
    ----------
    known, changes : lists of arrays (components, nodes), these in single precision
    weights, shares : numbers, one of each
    initial_gap : array (nodes,)
    floor : float
    """
    states, (initial_gap, weights, shares) = States(known), _flat(initial_gap, weights, shares)
    found, places = np.empty(states.shape), (c_void_p * len(changes))(*map(address, changes))
    shared().combined(*found.shape, states.count, states.places, address(weights), len(changes),
                      places, address(shares), address(initial_gap), floor, address(found))
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


def alternation(boxes, axis, image=0, closed=False, beyond=0):
    """As `grid.alternation.alternation`.

    Parameters
    ----------
    boxes, axis, image, closed, beyond : as of that
    """
    (boxes,), shape = _flat(boxes), boxes.shape
    return shared().alternation(math.prod(shape[:axis]), shape[axis], math.prod(shape[axis + 1:]),
                                address(boxes), image, closed, beyond)


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

