"""Windows as arrays of numbers, which an archive keeps, and back."""

import numpy as np

from .active import Nodes, some
from .boxes import Spots
from .windows import Window


def numbers_of(window):
    """Name -> array of what tells a window's nodes: first node and shape of its box or boxes and,
    where it is some nodes of one, their numbers there. Of nodes in several processes those of all
    are in the first one."""
    shared = window.grid.comm is not None
    nodes = {}
    if isinstance(window, Nodes):
        nodes = {"window_nodes": window.grid.to_first(window.node_numbers() if shared
                                                      else window.places)}
    start, shape = ((0, 0), window.grid.shape) if shared else (window.start, window.shape)
    return {"window_start": np.array(start), "window_shape": np.array(shape), **nodes}


def of_numbers(grid, numbers):
    """The window of a grid that such numbers tell of."""
    start = numbers["window_start"]
    window = (Window if np.ndim(start) == 1 else Spots)(grid, start, numbers["window_shape"])
    return Nodes(window, numbers["window_nodes"]) if "window_nodes" in numbers else window


def restored(grid, numbers, field):
    """(window, values there) of what an archive has, as far as they are here.

    Parameters
    ----------
    grid : Grid
    numbers : as of `numbers_of`
    field : array (components, nodes), of all nodes
    """
    window = of_numbers(grid if grid.comm is None else grid.alone(), numbers)
    if grid.comm is None:
        return window, field
    places = window.node_numbers() - grid.rows.first * grid.shape[1]
    here = np.flatnonzero((places >= 0) & (places < grid.whole.size))
    here = here[np.argsort(places[here])]
    found = grid.whole if window.is_whole else some(grid.whole, places[here])
    return found, np.ascontiguousarray(field[:, here])
