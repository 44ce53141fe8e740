"""Grids that memory does not hold, or PETSc cannot count, refused before anything of their size is
made."""

import math

from ..interface import shapes
from ..options.fields import as_text
from ..scene.settings import loaded_legs, tangential_legs
from .grid_choice import TooLarge, cell_of, nice_below, window_part
from .memory import memory, memory_of_solve

MOST_UNKNOWNS = 2 ** 31 - 1
"""Unknowns that PETSc's whole numbers of 32 bits can count."""
LITTLE = 2 ** 25
"""Bytes that are there wherever Python and PETSc are: asking for what there is takes as long as a
solve."""


def refuse_too_large(scene, load, form):
    """TooLarge, with what would fit, unless memory holds the solves of a scene on its grid, and
    PETSc can count the unknowns.

    To be called before anything of the grid's size is made.

    Parameters
    ----------
    scene : Scene
    load : Load
    form : Form, the options of how it is solved
    """
    cell = cell_of(scene, load)
    nodes = (cell.components if any(tangential_legs(scene, load)) else 1) * math.prod(cell.shape)
    shape = shapes.of(cell).memory(cell)
    needed, unknowns = memory_of_solve(nodes, nodes) + shape, nodes
    if needed <= LITTLE:
        return
    room, whole = memory(), form.form == "force" or form.window == "off"
    if not whole and (needed > room or nodes > MOST_UNKNOWNS):
        unknowns = nodes * _least_part(cell, load) * _mirrored_part(cell, load, form)
        needed = memory_of_solve(unknowns, nodes) + shape
    share = min(room / needed, MOST_UNKNOWNS / unknowns if unknowns else 1.0)
    if share < 1.0:
        raise TooLarge(_too_many(scene, cell, needed, room, unknowns,
                                 share ** (1 / cell.dimension)))


def _least_part(cell, load):
    """`window_part`; 0 for a surface that is known on its own grid only, or takes memory itself."""
    if shapes.of(cell).gridded or shapes.of(cell).memory(cell):
        return 0.0
    try:
        return window_part(cell, load)
    except (ArithmeticError, ValueError):
        return 0.0


def _mirrored_part(cell, load, form):
    """The part of its nodes that a scene is solved on where shape, body and loads claim mirror
    images."""
    loaded = loaded_legs(cell, load)[-1] if load.path else ()
    claimed = (form.symmetry != "off" and set(shapes.of(cell).even) == set(range(cell.dimension))
               and len(loaded) < 2)
    # slip that moves the gap leaves the mirror across the load
    return 0.5 ** (cell.dimension - bool(loaded and cell.coupled)) if claimed else 1.0


def _too_many(scene, cell, needed, room, unknowns, share):
    """One sentence on a grid that memory or PETSc does not hold, and one that they do, with a share
    of its points a direction."""
    why = (f"takes about {needed / 1e9:.3g} GB of memory, of which "
           f"{room / 1e9:.3g} GB are to be had here")
    if needed <= room:
        why = f"has about {unknowns:.3g} unknowns, and PETSc counts {MOST_UNKNOWNS} of them"
    what = f"the grid of {' x '.join(f'{n:.8g}' for n in cell.shape)} nodes {why}"
    if shapes.of(scene).gridded:
        return f"{shapes.of(scene).source(scene)}: {what}; take fewer heights"
    if scene.isolated:
        fitting = tuple(float(f"{1.1 * spacing / share:.2g}") for spacing in scene.spacings)
        given = "not set" if scene.spacing is None else f"'{as_text(scene.as_typed('spacing'))}'"
        return (f"{scene.option_name('spacing')} is {given}: {what}; "
                f"{as_text(scene.told(max(fitting), 'beta'))} would fit, or a "
                "smaller load")
    points = tuple(max(16, nice_below(n * share)) for n in cell.shape)
    return (f"{scene.option_name('points')} is '{as_text(scene.points or scene.shape)}': {what}; "
            f"{as_text(points if len(points) > 1 else points[0])} would fit")
