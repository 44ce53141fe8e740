"""Cubic splines through values at nodes, at places between them."""

import numpy as np
import scipy


def sources(start, stop, here, there, begin):
    """Where nodes ``start`` to ``stop`` - 1 of a line were before places on it were moved from
    ``here`` to ``there``, less ``begin``: an array, linear between the places, and beyond them with
    the slope from the first to the last.

    Parameters
    ----------
    start, stop, begin : int
    here, there : increasing places, in nodes
    """
    node = np.arange(start, stop)
    slope = (here[-1] - here[0]) / (there[-1] - there[0])
    found = np.interp(node, there, here) - begin
    found += slope * (np.minimum(node - there[0], 0.0) + np.maximum(node - there[-1], 0.0))
    return found


def spline(values, places, axis):
    """Cubic spline through values at nodes along an axis, at places (in nodes, cut to theirs): an
    array with these along the axis.

    Parameters
    ----------
    values : array, nodes along the axis; the library overwrites them
    places : array, in nodes
    axis : int
    """
    count = values.shape[axis]
    if not count:
        return values
    coefficients = scipy.ndimage.spline_filter1d(values, axis=axis, mode="mirror")
    places = np.minimum(np.maximum(places, 0.0), count - 1.0)
    first = np.minimum(places.astype(int), count - 2)
    t = places - first
    along = [1] * values.ndim
    along[axis] = len(places)
    mirrored = first.min() < 1 or first.max() > count - 3
    total = 0.0
    square, left = t * t, 1.0 - t
    # (NumPy's third powers take longer than all the rest)
    for shift, weight in zip(range(-1, 3), (left * left * left, 4.0 + square * (3.0 * t - 6.0),
                                            1.0 + 3.0 * t * (1.0 + t - square), square * t)):
        node = first + shift
        if mirrored:  # beyond the ends, as the coefficients are
            node = np.abs(node)
            node = np.where(node > count - 1, 2 * (count - 1) - node, node)
        total = total + (weight / 6.0).reshape(along) * coefficients.take(node, axis=axis)
    return total
