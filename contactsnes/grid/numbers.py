"""Windows as arrays of numbers, which an archive keeps, and back."""

import numpy as np

from .active import Nodes, some
from .boxes import Spots
from .cell import Grid
from .windows import Window


def numbers_of(window):
    """Name -> array of what tells a window's nodes: first node and shape of its box or boxes and,
    where it is some nodes of one, their numbers there. Of nodes in several processes those of all
    are `parted`."""
    shared = window.grid.shared
    nodes = {}
    if isinstance(window, Nodes):
        nodes = {"window_nodes": window.grid.to_first(window.node_numbers() if shared
                                                      else window.places)}
    box = window.parts[0] if shared else window
    start, shape = (box.origin, box.extents) if shared else (window.start, window.shape)
    return {"window_start": np.array(start), "window_shape": np.array(shape), **nodes}


def of_numbers(grid, numbers):
    """The window of a grid that such numbers tell of."""
    start = numbers["window_start"]
    window = (Window if np.ndim(start) == 1 else Spots)(grid, start, numbers["window_shape"])
    return Nodes(window, numbers["window_nodes"]) if "window_nodes" in numbers else window


def restored(grid, numbers, field):
    """(window, values there) of what an archive has, as far as they are here: of several processes
    the first one sends the others theirs.

    Parameters
    ----------
    grid : Grid
    numbers : as of `numbers_of`; of several processes in the first one
    field : array (components, nodes), of all nodes; of several processes in the first one
    """
    if not grid.shared:
        return of_numbers(grid, numbers), field
    comm, mine = grid.comm, None
    whole = None if comm.rank else of_numbers(Grid(grid.shape, grid.periods), numbers)
    for rank, part in enumerate(() if comm.rank else _parts(grid, whole, field)):
        if rank:
            comm.send(part, dest=rank)
        else:
            mine = part
    box, places, values = comm.recv(source=0) if comm.rank else mine
    return grid.box(*box) if box else some(grid.whole, places), values


def _parts(grid, window, field):
    """What each process has of a window of the whole cell: start and shape of a box that does not
    wrap around the cell's border, None of another window; the nodes' numbers among those of the
    process, ascending, and the values of a field there."""
    nodes, box = window.node_numbers(), None
    if isinstance(window, Window) and all(first + n <= total for first, n, total in zip(
            window.start, window.shape, grid.shape)):
        box = window.start, window.shape
    order = np.argsort(nodes, kind="stable")
    nodes = nodes[order]
    for first, count in grid.rows.parts:
        begin, end = np.array([first, first + count]) * grid.shape[1]
        mine = slice(*np.searchsorted(nodes, (begin, end)))
        yield box, nodes[mine] - begin, field[:, order[mine]]
