"""In which directions the components of a displacement are even about the apex, in which odd: what
the gap, the body and the loads leave open; and how far fields are from that."""

import math
import weakref

import numpy as np

UNEVEN = 1e-10
"""Largest difference of mirror images in an initial gap that counts as even, delta_n: what rounding
makes of one."""
SAME = 1e-12
"""The same for a block of a body's operator, over its largest entry."""

_KNOWN = weakref.WeakKeyDictionary()
"""Operator -> {key: parity of the block}, which are asked for again and again."""


def parity(operator, key):
    """1 where a block's kernel is even in the lags of a direction, -1 where it is odd, a tuple, one
    a direction; None where it is neither.

    Parameters
    ----------
    operator : Operator
    key : (i, j), of the block
    """
    known = _KNOWN.setdefault(operator, {})
    if key not in known:
        known[key] = _measured(operator.blocks[key], operator.grid)
    return known[key]


def _measured(block, grid):
    """The parity of a kernel by its half spectrum: real ones are even about the origin, imaginary
    ones odd."""
    whole = -1 if np.iscomplexobj(block) else 1
    if whole > 0 and block.ndim == 1:
        return (whole,)
    size = SAME * grid.maximum(np.abs(block), initial=0.0)
    if whole < 0 and grid.maximum(np.abs(block.real), initial=0.0) > size:
        return None
    if block.ndim == 1:
        return (whole,)
    image = np.roll(block[::-1], 1, axis=0)
    for sign in (1, -1):
        if grid.maximum(np.abs(image - sign * block), initial=0.0) <= size:
            return sign, sign * whole
    return None


def parities(operator, components, loaded=(), without=None):
    """For each component and direction whether it is even (1) or odd (-1) about the apex, tuples;
    None where mirror images are not bound to differ by signs alone.

    Loads move a surface evenly, and so is what they act on; a body that moves one component by the
    tractions of another moves it as evenly or oddly as these and the kernel between them are. What
    is bound by neither is even. A law of the gap and the size of the slip leaves all of that as it
    is.

    Parameters
    ----------
    operator : Operator, the body's compliance among the components
    components : int
    loaded : tangential components on which loads act
    without : direction whose mirror images are not asked for, and which has 0; None: all are
    """
    even = tuple(int(axis != without) for axis in range(len(operator.grid.shape)))
    found = {i: even for i in (0, *loaded)}
    between = {key: parity(operator, key) for key in operator.blocks}
    if None in between.values():
        return None
    between = {key: tuple(a * b for a, b in zip(own, even)) for key, own in between.items()}
    while True:
        for (i, j), own in between.items():
            if j in found and i not in found:
                found[i] = tuple(a * b for a, b in zip(own, found[j]))
                break
        else:
            free = [i for i in range(components) if i not in found]
            if not free:
                break
            found[free[0]] = even
    bound = all(own == tuple(a * b for a, b in zip(found[i], found[j]))
                for (i, j), own in between.items())
    return tuple(found[i] for i in range(components)) if bound else None


def one_mirror(contact, components, loaded=()):
    """`parities` where mirror images differ by signs alone in one direction of the plane: across a
    load, for a body that couples normal and tangential displacements; None where there is none.

    Parameters
    ----------
    contact, components, loaded : as of `obstacle`
    """
    if len(contact.grid.shape) < 2 or not contact.unevenness <= UNEVEN:
        return None
    found = (parities(contact.operator(components), components, loaded, axis) for axis in (0, 1))
    return next(filter(None, found), None)


def obstacle(contact, components, loaded=()):
    """Why mirror images in displacements of a contact with so many components need not differ by
    signs alone, in words; None if they do.

    What is asked is its initial gap on the grid, node by node, and which components of traction its
    body moves which others by.

    Parameters
    ----------
    contact : Contact
    components : int
    loaded : tangential components on which loads act
    """
    if not contact.unevenness <= UNEVEN:
        return ("the initial gap is not even about the apex: its mirror "
                f"images differ by up to {contact.unevenness:.3g} delta_n, of "
                f"which {UNEVEN:g} is allowed")
    operator = contact.operator(components)
    if components == 1 or parities(operator, components, loaded):
        return None
    if any(0 in key for key in operator.blocks if key != (0, 0)):
        return ("the body couples tangential displacements to normal ones, which a load along them "
                "moves evenly, and normal loads oddly")
    return ("tangential displacements along and across a load are even in different directions, "
            "and there are loads along both")


def asymmetry(window, values, parities=None):
    """Largest difference of values (arrays, nodes) between mirror images in a window; inf if it
    does not hold the apex.

    Parameters
    ----------
    window : Window
    values : arrays (arrays, nodes)
    parities : for each array and direction 1 (even) or -1 (odd), or, of all in a direction, 0: what
        is there is not asked; None: all are even
    """
    signs = np.ones((len(values), len(window.grid.shape))) if parities is None \
        else np.array(parities, dtype=float)
    signs = [sign.reshape(-1, *[1] * len(window.grid.shape)) for sign in signs.T]
    if window.parts[0] is not window:  # several boxes, or some nodes of one
        cell = np.full((len(values), *window.grid.local_shape), math.inf)
        window.put(values, cell)
        differences = (np.abs(cell - sign * window.grid.mirrored(cell, axis))
                       for axis, sign in enumerate(signs) if sign.any())
        with np.errstate(invalid="ignore"):
            return float(window.grid.largest(max(
                np.max(difference, where=np.isfinite(difference), initial=0.0)
                for difference in differences)))
    box, largest = window.box(values), 0.0
    for axis, (first, extent, total) in enumerate(zip(window.origin, window.extents,
                                                      window.grid.shape), start=1):
        if not signs[axis - 1].any():
            continue
        middle = (total // 2 - first) % total
        reach = min(middle, extent - 1 - middle)
        if reach < 0:
            return math.inf
        # (an odd field vanishes in the middle, and where the cell closes on itself)
        sign = signs[axis - 1].swapaxes(axis, 0)
        after, before, first = window.images(box, axis, middle, reach)
        largest = np.maximum(largest, np.max(np.abs(after - sign * before), initial=0.0))
        if extent == total:
            largest = np.maximum(largest, np.max(np.abs((1.0 - sign) * first), initial=0.0))
    return float(window.grid.largest(largest))
