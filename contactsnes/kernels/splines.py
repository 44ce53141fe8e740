"""Cubic splines in the library."""

import math

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
    coefficients = np.array(values, dtype=float, order="C")
    places = np.ascontiguousarray(places, dtype=float)
    found = np.empty((*shape[:axis], len(places), *shape[axis + 1:]))
    turned = np.empty(LINES * count)
    shared().spline(math.prod(shape[:axis]), count, math.prod(shape[axis + 1:]),
                    address(coefficients), len(places), address(places), address(turned),
                    address(found))
    return found


def moved(state, gap, closed, wanted, here, there, begin):
    """Normal gap and tangential displacements (components, nodes) of a line's even state at nodes
    whose places were moved, as of `contact.edges._stretched`; None where that asks for more nodes
    than the state's window has.

    Parameters
    ----------
    state : State, with its half
    gap : array, initial gap at the nodes of the half, delta_n
    closed : bool, whether the window is the cell
    wanted : slice, of nodes
    here, there, begin : as of `sources`
    """
    (extent,), once, parities = state.window.extents, state.once, state.half.parities
    signs = np.array([sign for sign, in parities or ((1,),) * len(once)], dtype=np.intc)
    here, there = (np.array(places, dtype=float) for places in (here, there))
    count = max(wanted.stop - wanted.start, 0)
    found, work = np.empty((count, len(once))), np.empty(4 * (extent + count))
    beyond = shared().moved(*once.shape, address(once), address(gap), address(signs), extent,
                            closed, wanted.start, count, len(here), address(here), address(there),
                            begin, address(work), address(found))
    return None if beyond else found.T
