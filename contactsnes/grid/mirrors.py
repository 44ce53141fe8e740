"""Windows about the apex, and the directions in which what is on them has a mirror there."""

import numpy as np


def centred(window):
    """The smallest window about the apex, one box, that holds a window."""
    start, shape = [], []
    for axis, (extent, total) in enumerate(zip(window.parts[0].extents, window.grid.shape)):
        ends = [end for part in window.parts for end in (total // 2 - part.origin[axis],
                                                         part.origin[axis] - total // 2 + extent
                                                         - 1)]
        reach = max(1, *ends)
        whole = extent == total or 2 * reach + 1 >= total
        start.append(0 if whole else total // 2 - reach)
        shape.append(total if whole else 2 * reach + 1)
    return window.grid.box(start, shape)


def lone(window, parities=None):
    """Mask of the nodes of a window (nodes) whose mirror image in some direction lies outside of
    it.

    Parameters
    ----------
    window : Window
    parities : as of `EvenWindow`
    """
    known = np.zeros((1, *window.grid.local_shape), dtype=bool)
    window.put(np.ones((1, window.size), dtype=bool), known)
    return window.take(np.any([known & ~window.grid.mirrored(known, axis)
                               for axis in range(len(window.grid.shape))
                               if axis != without_mirror(parities)], axis=0))[0]


def unlike(parities):
    """Parities, or None where all components are even in all directions."""
    return parities if parities and any({-1, 0} & {*signs} for signs in parities) else None


def without_mirror(parities):
    """The direction of the plane in which fields are neither even nor odd, or None.

    Parameters
    ----------
    parities : as of `EvenWindow`, or None
    """
    return parities[0].index(0) if parities and 0 in parities[0] else None
