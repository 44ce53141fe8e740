"""Cubic splines in the library."""

import math
from ctypes import c_void_p

import numpy as np

from .library import shared
from .structures import address

LINES = 8
"""Lines whose recursions run side by side, as in steps.c."""


def sources(start, stop, here, there, begin):
    """As `grid.splines.sources`.

    Parameters
    ----------
    start, stop, here, there, begin : as of that
    """
    found = np.empty(max(stop - start, 0))
    here, there = (np.array(places, dtype=float) for places in (here, there))
    shared().sources(start, len(found), len(here), address(here), address(there), begin,
                     address(found))
    return found


def spline(values, places, axis):
    """As `grid.splines.spline`.

    Parameters
    ----------
    values, places, axis : as of that
    """
    shape = values.shape
    count = shape[axis]
    if not count:  # of slabs, where others have all rows
        return values
    coefficients = np.require(values, dtype=float, requirements=("C", "W"))
    places = np.ascontiguousarray(places, dtype=float)
    found = np.empty((*shape[:axis], len(places), *shape[axis + 1:]))
    turned = np.empty(LINES * count)
    shared().spline(math.prod(shape[:axis]), count, math.prod(shape[axis + 1:]),
                    address(coefficients), len(places), address(places), address(turned),
                    address(found))
    return found


def followed(states, known, gaps, reach, weights, places, target):
    """Displacements (components, nodes) of a line's even states whose places are moved, as of
    `contact.edges._followed`; None where that asks for more nodes than a state's window has.

    Parameters
    ----------
    states : list of State, with their halves, oldest first
    known : arrays (components, nodes), their displacements at the nodes of the last one's half
    gaps : arrays, initial gaps at the nodes of each one's half, delta_n
    reach : normal gap within which the law acts
    weights : numbers, one a state
    places, target : for each state places, in nodes from the first one of the last window on, and
        where they are moved to
    """
    fields, last = [state.once for state in states], states[-1]
    (components, nodes), parities = known[-1].shape, last.half.parities
    signs = np.array([sign for sign, in parities or ((1,),) * components], dtype=np.intc)
    begin, total = last.window.start[0], last.window.grid.shape[0]
    lines = [(len(field[0]), *state.window.extents, state.window.is_whole,
              (state.window.start[0] - begin + total // 2) % total - total // 2)
             for field, state in zip(fields, states)]
    longest = max(extent for _, extent, *_ in lines)
    lines = np.array(lines, dtype=np.intc)
    weights, here, there = (np.array(numbers, dtype=float)
                            for numbers in (weights, places, target))
    found = np.empty((components, nodes))
    work = np.empty(4 * (longest + nodes) + 2 * components * nodes)
    beyond = shared().followed(components, nodes, len(states),
                               *(_each(arrays) for arrays in (known, fields, gaps)),
                               address(lines), address(signs), *last.window.extents, reach,
                               address(weights), len(there), address(here), address(there),
                               address(work), address(found))
    return None if beyond else found


def _each(arrays):
    """Where each of some arrays begins, as an array of C."""
    return (c_void_p * len(arrays))(*map(address, arrays))
