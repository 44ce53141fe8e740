"""Initial gap of a shape on nodes, in units of u_n,r = beta^2/R; lengths in beta."""

from functools import reduce

import numpy as np

from ..grid.cell import Grid
from ..options.fields import LARGEST, InputError, as_text

STRIP = 2 ** 20
"""Nodes of a plane whose second differences are in memory at a time."""


def evaluated(shape, coordinates, scene):
    """The gap that a shape has on nodes, u_n,r.

    Parameters
    ----------
    shape : Shape
    coordinates : tuple of ndarray, one a direction, beta, to broadcast; the apex is at the origin
    scene : Scene, for its cell and its units

    Returns
    -------
    ndarray over the nodes, perhaps read-only

    Raises
    ------
    InputError : where the shape raises an exception, or what it has is no gap: of another shape,
        not real, not finite or too large
    """
    nodes = np.broadcast_shapes(*(x.shape for x in coordinates))
    if 0 in nodes:  # of a process without rows: the largest of none, say, would be an error
        return np.zeros(nodes)
    named = f"{scene.option_name('geometry')} is '{scene.geometry}'"
    try:
        with np.errstate(all="ignore"):
            # arrays of its own: what a shape writes into them stays there
            gap = without_mask(shape.gap(tuple(x.copy() for x in coordinates), scene))
    except (InputError, OSError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{named}: the gap cannot be evaluated ({type(error).__name__}: {error}); "
                         f"it is asked on {as_text(nodes)} nodes, with one array a direction"
                         ) from error
    gap = _on_nodes(named, gap, nodes)
    _refuse_beyond(named, gap, coordinates, scene)
    return gap


def by_rows(shape, grid, scene):
    """The gap, u_n,r, at the nodes of a grid that are here, of a shape that has it by rows;
    InputError where it cannot be had, or is too large.

    Parameters
    ----------
    shape : Shape
    grid : Grid
    scene : Scene
    """
    try:
        gap = shape.rows(grid, scene)
    except ValueError as error:
        raise error if isinstance(error, InputError) else InputError(str(error)) from None
    largest = grid.maximum(np.abs(gap))
    if not largest <= LARGEST:
        raise InputError(f"{scene.option_name('geometry')} is '{scene.geometry}': the gap is up to "
                         f"{largest:g}; it has to be at most {LARGEST:g} in size")
    return gap


def without_mask(values):
    """Values as an array that is not masked, nan where they were: what is missing is no number."""
    if np.ma.is_masked(values):
        values = np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)
    return np.asarray(values)


def _on_nodes(named, gap, nodes):
    """A gap as real numbers on all nodes; InputError where it is none."""
    if gap.dtype.kind not in "fiu":
        raise InputError(f"{named}: the gap is of {gap.dtype} instead of real numbers")
    try:
        return np.broadcast_to(gap, nodes).astype(float, copy=False)
    except ValueError:
        raise InputError(f"{named}: the gap has the shape {gap.shape}, the nodes have {nodes}: "
                         "give one value for each node") from None


def _refuse_beyond(named, gap, coordinates, scene):
    """InputError for a gap that is not finite, or too large to compute with, somewhere."""
    if np.max(np.abs(gap), initial=0.0) <= LARGEST:
        return
    place = np.unravel_index(np.argmax(~(np.abs(gap) <= LARGEST)), gap.shape)
    raise InputError(f"{named}: the gap is {gap[place]:g} at {where(place, coordinates, scene)}; "
                     f"it has to be finite everywhere, and at most {LARGEST:g} in size")


def where(place, coordinates, scene):
    """A node in words: its coordinates, in what the scene is told in.

    Parameters
    ----------
    place : tuple of int, the node's indices
    coordinates : tuple of ndarray, one a direction, beta, to broadcast
    scene : Scene
    """
    nodes = np.broadcast_shapes(*(x.shape for x in coordinates))
    return at([np.broadcast_to(x, nodes)[place] for x in coordinates], scene)


def at(place, scene):
    """A place, coordinates in beta, in words: in what the scene is told in."""
    return ", ".join(f"{axis} = {scene.short(float(x), 'beta', 6)}" for axis, x in zip("xy", place))


def initial_gap(shape, coordinates, scene):
    """Initial gap of a scene, the shape's and the scene's offset, on nodes.

    Parameters
    ----------
    shape : Shape
    coordinates : tuple of ndarray, one a direction, beta, to broadcast; the apex is at the origin
    scene : Scene

    Returns
    -------
    ndarray over the nodes, u_n,r, a new array
    """
    return evaluated(shape, coordinates, scene) + scene.gap_offset


def gap_of_heights(heights, grid=None):
    """max(h) - h of heights (array), of all nodes or those of a grid that are here: the highest
    point is the nearest to the flat."""
    return (np.max(heights) if grid is None else grid.maximum(heights)) - heights


def over_nodes(what, values, scene):
    """Values over the nodes of a scene, an array; InputError where they do not fit.

    Parameters
    ----------
    what : str, what they are and a verb, for the sentence
    values : array_like
    scene : Scene
    """
    values = without_mask(values)
    if values.shape != scene.shape:
        raise InputError(f"the {what} the shape {values.shape}, the grid has {scene.shape}: give "
                         "one number for each node, or -scene_points and -scene_dimension that fit")
    if values.dtype.kind not in "fiu" or not np.all(np.isfinite(values)):
        raise InputError(f"the {what} to be real and finite numbers: fill the missing ones first")
    return values


def at_edge(shape, contact):
    """Smallest initial gap at the edge of the cell, delta_n, where bodies meet their neighbours;
    inf along what nothing varies along."""
    grid, gap = contact.grid, contact.initial_gap
    return min((grid.minimum(grid.edge(gap, axis)) for axis in range(gap.ndim)
                if axis not in shape.uniform), default=np.inf)


def refuse_contact_at_edge(shape, contact):
    """InputError for a body that is to stay apart from its neighbours and is in contact at the edge
    of its cell, where they meet."""
    scene = contact.scene
    # a period that is just allowed is so to rounding
    if shape.apart and at_edge(shape, contact) < scene.contact_threshold * (1.0 - 1e-12):
        raise InputError(f"-scene_period is '{as_text(scene.as_typed('period'))}': the "
                         f"{scene.geometry} body would be in contact up to the edge "
                         f"of the cell; {shape.too_near()}")


def is_convex(gap, grid=None):
    """Whether a gap on a grid is convex within the cell, to rounding, and not the same everywhere:
    a body with one summit.

    Its second differences are those of a convex function: along each direction not negative, with a
    Hessian's determinant that is not, either. Half a cell away from the summit, where a body meets
    its neighbour, nothing is asked.

    Parameters
    ----------
    gap : array over the cell, or as much of it as is here
    grid : Grid of the cell, where some of it may be in other processes
    """
    grid = Grid(gap.shape, (1.0,) * gap.ndim) if grid is None else grid
    lowest, highest = grid.minimum(gap), grid.maximum(gap)
    rounding = 8.0 * np.finfo(float).eps * max(abs(lowest), abs(highest))
    if highest - lowest <= rounding:
        return False
    # A summit between two nodes has the border half a spacing beside the array's end.
    summit, around, axes = grid.highest(-gap), grid.whole.ringed(gap), range(gap.ndim)
    borders = [[2 if other == axis else 1 for other in axes] for axis in axes] + [[2] * gap.ndim]
    inside = [_about(grid, summit, border) for border in borders]
    some = max(1, STRIP * len(gap) // max(gap.size, 1))
    found = np.array([_bent(around[first:first + some + 3],
                            [[rows[first:first + some], *others] for rows, *others in inside])
                      for first in range(0, len(gap), some)]).reshape(-1, 3).T
    if grid.minimum(found[0]) < -rounding:
        return False
    steepest = grid.maximum(found[1])
    return gap.ndim == 1 or bool(grid.minimum(found[2]) >= -rounding * steepest)


def _bent(around, inside):
    """Smallest and largest second differences along the directions, and smallest determinant of
    those of a plane, among some nodes.

    Parameters
    ----------
    around : array, values with a ring around them (`windows.Window.ringed`)
    inside : for each direction, and for the determinant, masks along the directions of what counts
    """
    masks = [reduce(np.logical_and.outer, lines) for lines in inside]
    steps = np.eye(around.ndim, dtype=int)
    gap = _beside(around, 0 * steps[0])
    bends = [(_beside(around, step) - gap) - (gap - _beside(around, -step)) for step in steps]
    least = min(np.min(bend, where=mask, initial=np.inf) for bend, mask in zip(bends, masks))
    most = max(np.max(bend, where=mask, initial=-np.inf) for bend, mask in zip(bends, masks))
    if around.ndim == 1:
        return least, most, 0.0
    twist = (_beside(around, (1, 1)) - _beside(around, (1, -1)) - _beside(around, (-1, 1))
             + _beside(around, (-1, -1))) / 4
    return least, most, np.min(bends[0] * bends[1] - twist ** 2, where=masks[-1], initial=np.inf)


def _beside(around, step):
    """Values of a field a step away from each node, from those with a ring around them
    (`windows.Window.ringed`)."""
    return around[tuple(slice(1 + way, n - 2 + way) for way, n in zip(step, around.shape))]


def _about(grid, summit, borders):
    """Masks, one a direction, of the nodes that are here and so many nodes from the border of a
    cell about the summit.

    Parameters
    ----------
    grid : Grid
    summit : node, a tuple of int
    borders : number of nodes for each direction
    """
    places = [grid.row_numbers, *map(np.arange, grid.shape[1:])]
    lines = [(place + n // 2 - top) % n for place, n, top in zip(places, grid.shape, summit)]
    return [(line >= border) & (line < n - border) for line, n, border
            in zip(lines, grid.shape, borders)]


def curvatures(gap, grid, reach):
    """Largest second difference of a gap in each direction, within a reach above its lowest place,
    over the spacing squared; a tuple, at least 1e-12.

    Parameters
    ----------
    gap : array over the nodes of the grid that are here, u_n,r
    grid : Grid
    reach : u_n,r

    Returns
    -------
    tuple of float, u_n,r/beta^2
    """
    low, around, found = gap <= grid.minimum(gap) + reach, grid.whole.ringed(gap), []
    places = np.ix_(grid.row_numbers, *map(np.arange, grid.shape[1:]))
    for place, points, spacing, step in zip(places, grid.shape, grid.spacings,
                                            np.eye(gap.ndim, dtype=int)):
        bends = np.abs((_beside(around, step) - gap) - (gap - _beside(around, -step)))
        # Half a cell away from the apex, where a body meets its neighbour, nothing is asked.
        inside = low & (place > 0) & (place < points - 1)
        most = grid.maximum(bends, where=inside, initial=0.0)
        found.append(max(1e-12, most / spacing ** 2))
    return tuple(found)
