"""Cubic splines in the library."""

import math
from ctypes import c_void_p
from operator import is_

import numpy as np

from .library import shared
from .sites import States
from .structures import address

LINES = 8
"""Lines whose recursions run side by side, as in steps.c."""
SIDE, MORE = 32, 24
"""The same of planes, and nodes that are asked for beyond those of a half, as there."""


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


def followed(states, known, sites, reach, weights, places, target):
    """Displacements (components, nodes) of even states of one box whose places are moved, as of
    `contact.edges._followed`; None where the law acts nowhere, or of a plane where that asks for
    more nodes than a state's window has.

    Parameters
    ----------
    states : list of State, with their halves, oldest first
    known : arrays (components, nodes), their displacements at the nodes of the last one's half
    sites : list of Site, of the nodes of each one's half; then, on a line, of those of the wider
        half of the last one
    reach : normal gap within which the law acts
    weights : numbers, one a state
    places, target : for each state places in each direction, in nodes from the first one of the
        last window on, and where they are moved to
    """
    half, (components, nodes) = states[-1].half, known[-1].shape
    known, own = States(known), [state.once for state in states]
    fields = known if all(map(is_, own, known.fields)) else States(own)
    begin, total = half.full.start, half.full.grid.shape
    signs = np.array(half.parities or ((1,) * len(total),) * components, dtype=np.intc)
    halves, plane = [state.half for state in states], len(total) > 1
    spread = np.array([(one.extents, one.full.extents, one.closed,
                        [(here - there + n // 2) % n - n // 2
                         for here, there, n in zip(one.full.start, begin, total)])
                       for one in (halves if plane else [*halves, half.wider])], dtype=np.intc)
    weights, here, there = (np.array(numbers, dtype=float)
                            for numbers in (weights, places, target))
    found = np.empty((components, nodes))
    work = np.empty(_work(half.extents, spread[:, 0]) if plane else
                    4 * (spread[:, 1].max() + nodes) + 2 * components * nodes)
    shape, extents = np.array(half.extents), np.array(half.full.extents, dtype=np.intc)
    gaps = (c_void_p * len(sites))(*[site.gap for site in sites])
    given = known.count, known.places, fields.places, gaps, address(spread), address(signs)
    rest = (reach, address(weights), there.shape[-1], address(here), address(there), address(work),
            address(found))
    beyond = (shared().followed_plane(components, shape.ctypes.data, *given, address(extents),
                                      *rest) if plane else
              shared().followed(components, nodes, *given, *rest))
    return None if beyond else found


def _work(shape, halves):
    """Numbers of memory that `followed_plane` works in, for a last half of a shape, and halves of
    states, array (states, 2)."""
    (rows, columns), (across, along) = shape, np.transpose(halves) + MORE
    return (np.sum(rows * (along + 1) + columns)
            + SIDE * (max(across.max(), along.max()) + 2 * columns))
