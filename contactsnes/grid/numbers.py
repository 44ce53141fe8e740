"""Windows as arrays of numbers, which an archive keeps, and back."""

import numpy as np

from .active import Nodes
from .boxes import Spots
from .windows import Window


def numbers_of(window):
    """Name -> array of what tells a window's nodes: first node and shape of its box or boxes and,
    where it is some nodes of one, their numbers there."""
    nodes = {"window_nodes": window.places} if isinstance(window, Nodes) else {}
    return {"window_start": np.array(window.start), "window_shape": np.array(window.shape), **nodes}


def of_numbers(grid, numbers):
    """The window of a grid that such numbers tell of."""
    start = numbers["window_start"]
    window = (Window if np.ndim(start) == 1 else Spots)(grid, start, numbers["window_shape"])
    return Nodes(window, numbers["window_nodes"]) if "window_nodes" in numbers else window
