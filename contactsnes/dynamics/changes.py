"""Changes in a motion: the nodes at which they count, and how large they are there."""

import math
from typing import NamedTuple

import numpy as np


class Near(NamedTuple):
    """Nodes at which changes count: 1 where the law acts, or everywhere where it does so nowhere,
    else 0 (nodes); for how many they stand; gap and slip there over one range, at least 1
    (components, nodes), or None."""

    mask: np.ndarray
    count: int
    scale: np.ndarray


def extremes(shape, change, root, counts, scale, weights):
    """As `kernels.points.extremes`.

    Parameters
    ----------
    shape, change, root, counts, scale, weights : as of that
    """
    field = np.abs(change[:math.prod(shape)].reshape(shape) * root)
    field *= counts
    if scale is not None:
        field /= scale
    largest = np.max(field, initial=0.0)
    squares = np.square(field, out=field).sum(axis=0)
    return largest, np.sum(squares) if weights is None else squares @ weights
