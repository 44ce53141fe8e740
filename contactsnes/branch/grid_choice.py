"""Points of the grid for a wanted accuracy (-scene_points auto), and what memory holds.

What is predicted here is only where to begin: estimates of the errors at every point (``accuracy``)
tell what was reached.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..contact import states
from ..contact.isolated import lay_out
from ..contact.problem import Contact
from ..interface import shapes
from ..options.fields import InputError, as_text
from ..scene.isolation import largest_force
from ..scene.resolution import LARGEST_RESOLUTION, resolution
from ..scene.settings import tangential_legs
from .memory import USABLE, memory, memory_of_solve

FEWEST = 32
"""Points of a direction, at least."""

FEW = {1: (2048,), 2: (128, 128)}
"""Points on which the size of windows is found out, by dimension."""

MARGIN = 0.5
"""Part of the wanted accuracy at which predictions aim."""

FINEST = 1e-9
"""Smallest errors that a finer grid still lowers: what solves to the usual tolerance leave."""


class TooLarge(InputError):
    """A grid that there is no memory for, or whose unknowns PETSc cannot count."""


def chosen(scene, load):
    """The scene on the grid for its accuracy; itself where the points are given.

    TooLarge, with the size that it would take and the best that can be done, where no grid in
    memory reaches it.
    """
    if scene.points != "auto":
        return scene
    if shapes.of(scene).gridded:
        points = shapes.of(scene).points(scene)
        return replace(scene, points=points if len(points) > 1 else points[0])
    if scene.isolated:
        return _unbounded(scene, chosen(replace(cell_of(scene, load), points="auto"), load))
    sheared = any(tangential_legs(scene, load))
    points = tuple(_points(scene, sheared, axis, scene.accuracy) for axis in range(scene.dimension))
    if scene.accuracy < FINEST or memory_needed(scene, load, points) > memory():
        raise TooLarge(_too_large(scene, load, points))
    return on(scene, points)


def on(scene, points):
    """The scene on a grid of ``points``, a tuple."""
    return replace(scene, points=points if scene.dimension == 2 else points[0])


def cell_of(scene, load):
    """The scene in a cell; of an isolated one, that which its nodes are laid out in."""
    if not scene.isolated:
        return scene
    sheared = any(tangential_legs(scene, load))
    return replace(lay_out(replace(scene, points=None), largest_force(scene, load)), tangential="on"
                   if sheared else "off")


def _unbounded(scene, cell):
    """The scene on the grid of its cell."""
    if not scene.isolated:
        return cell
    return replace(scene, points=None, spacing=cell.spacings if scene.dimension == 2
                   else cell.spacings[0])


def reason(scene, load):
    """Why the grid of a scene is what it is, in words."""
    if shapes.of(scene).gridded:
        return f"{as_text(scene.shape)} points, those of the file"
    sheared, cell = any(tangential_legs(scene, load)), cell_of(scene, load)
    error = max(predicted(cell, sheared, axis, n) for axis, n in enumerate(cell.shape))
    grid = (f"spacing {scene.words(scene.spacings, 'beta')}" if scene.isolated
            else f"{as_text(cell.shape)} points")
    return (f"{grid}, from which the law's cohesive length and the shape promise errors of about "
            f"{error:.1g} (-scene_accuracy {as_text(scene.accuracy)})")


def next_grid(scene, load, error):
    """The scene on the next grid, where its points had an error above its accuracy; None where
    there is none in memory.

    At most four times finer: the errors of the contact area fall with the fourth power of the
    spacing, those of corners of the law that nodes cross under shear with the second.

    Parameters
    ----------
    scene : Scene, whose points are chosen
    load : Load
    error : float, relative, the largest of its points
    """
    if shapes.of(scene).gridded:
        return None
    sheared, cell = any(tangential_legs(scene, load)), cell_of(scene, load)
    factor = min(4.0, (error / (MARGIN * scene.accuracy)) ** (1 / 2 if sheared else 1 / 4))
    points = tuple(_nice(factor * n) if predicted(cell, sheared, axis, n) > 0.0 else n
                   for axis, n in enumerate(cell.shape))
    fits = points != cell.shape and memory_needed(cell, load, points) <= memory()
    return _unbounded(scene, on(cell, points)) if fits else None


@lru_cache(maxsize=256)
def predicted(scene, sheared, axis, points):
    """Relative error of force and area to be expected of a direction's number of points; 0 where
    nothing varies along it.

    With l = dx/x the cohesive length of the law, x the spacing in units of it (at most 1.25 in a
    grid that resolves it): the force's error falls as a wave's, 300 l exp(-17.7/x); the edge of
    contact, interpolated by a cubic, has 9e-4 l x^4, and corners of the law under shear 3e-5 l x^2.
    A law of long range is smooth on the scale on which the initial gap, of curvature c, goes
    through it: exp(-c lambda x^2/2) has waves up to exp(-(pi/dx)^2/(c lambda)). Measured on lines
    at lambda = 3 to 10.

    Parameters
    ----------
    scene : Scene
    sheared : bool, whether tangential unknowns appear
    axis : int, the direction
    points : int, in that direction
    """
    grid = on(replace(scene, points="auto"), tuple(points if i == axis else FEWEST
                                                   for i in range(scene.dimension)))
    x = LARGEST_RESOLUTION * resolution(grid, sheared)[axis]
    if x == 0.0:
        return 0.0
    if x > LARGEST_RESOLUTION:  # edges may stick between nodes, and no error is promised
        return 1.0
    spacing = grid.spacings[axis]
    if 2 * spacing > shapes.of(scene).shortest(scene) > 0.0:
        return 1.0
    length = min(spacing / x, 1.0)
    law = length * (300.0 * math.exp(-17.7 / x) + 9e-4 * x ** 4 + (3e-5 * x ** 2 if sheared
                                                                   else 0.0))
    width = 1.0 / math.sqrt(scene.normal_maugis * _curvatures(scene)[axis])
    shape = math.exp(-(math.pi * width / spacing) ** 2) + 1e-3 * (spacing / width) ** 4
    return min(1.0, law + shape)


@lru_cache(maxsize=64)
def _curvatures(scene):
    """Largest curvature of the gap in each direction, u_n,r/beta^2."""
    return shapes.of(scene).curvature(scene)


def _points(scene, sheared, axis, accuracy):
    """The fewest points of a direction that promise an accuracy."""
    points = FEWEST
    while predicted(scene, sheared, axis, points) > MARGIN * accuracy:
        points = _nice(points + 1)
    return points


def _nice(points):
    """The smallest number that is not below ``points`` and 4, 5 or 6 times a power of 2: even often
    enough for coarser grids."""
    power = 2 ** max(2, math.floor(math.log2(points)) - 2)
    return next(n * power for n in (4, 5, 6, 8) if n * power >= points)


def nice_below(points):
    """The largest number that is not above ``points`` and 4, 5 or 6 times a power of 2."""
    power = 2 ** max(2, math.floor(math.log2(points)) - 2)
    return max([n * power for n in (4, 5, 6) if n * power <= points], default=0)


def refinement(dimension, sheared):
    """How many times finer in each direction the grid is on which a point's errors show.

    Parameters
    ----------
    dimension : int, of the interface
    sheared : bool, whether there are tangential components
    """
    return (4 if dimension == 1 else 3) if sheared else 2


def again(scene, load):
    """How many times as much again estimates of errors take, of the memory of solves: nodes of the
    finer grid for each of a grid's, four on lines at all."""
    sheared = any(tangential_legs(scene, load))
    return max(4, refinement(scene.dimension, sheared) ** scene.dimension)


def memory_needed(scene, load, points):
    """Bytes for the solves of a grid, a tuple, and of the finer one that its errors are estimated
    on.

    Parameters
    ----------
    scene : Scene
    load : Load
    points : tuple of int, one a direction
    """
    cell = (scene.components if any(tangential_legs(scene, load)) else 1) * math.prod(points)
    return (1 + again(scene, load)) * memory_of_solve(window_part(scene, load) * cell, cell)


@lru_cache(maxsize=8)
def window_part(scene, load):
    """The largest part of the cell on which the law acts where the path begins and at the ends of
    its legs.

    That of the body bent without a law, on few points: the window of a contact with adhesion is
    somewhat larger.
    """
    contact, gaps = _bent(scene, load)
    return min(1.0, 1.2 * max(contact.window(gap).size for gap in gaps) / contact.grid.size)


def active_part(scene, load, reach=1.0):
    """The largest part of the nodes that the law acts on, as of `window_part`: not of a box around
    them.

    Parameters
    ----------
    scene : Scene
    load : Load
    reach : float, part of the law's range within which it counts
    """
    contact, gaps = _bent(scene, load)
    return max(float(np.mean(gap < reach * contact.law.range)) for gap in gaps)


@lru_cache(maxsize=1)
def _bent(scene, load):
    """The contact on few points, and normal gaps (*grid) of the body bent without a law where the
    path begins and at the ends of its legs; made once for both parts of a cell."""
    contact = Contact(on(scene, FEW[scene.dimension]))
    legs = scene.legs(load) if load.path else ()
    controls = [scene.initial(load)[0], *(leg.controls[0] for leg in legs if 0 in leg.controls)]
    return contact, [states.normal_gap(contact, states.undeformed(contact, (its.control,),
                                                                  [its.value])).reshape(
        contact.grid.shape) for its in controls if its.value is not None]


def _too_large(scene, load, points):
    """One sentence with the size that an accuracy would take, and the best accuracy there is memory
    for."""
    needed = points
    best = max(scene.accuracy, FINEST)
    sheared = any(tangential_legs(scene, load))
    while best < 1.0:
        points = tuple(_points(scene, sheared, axis, best) for axis in range(scene.dimension))
        if memory_needed(scene, load, points) <= memory():
            break
        best *= 1.25
    size = (f"{as_text(needed)} points and "
            f"{memory_needed(scene, load, needed) / 1e9:.3g} GB of memory")
    place = math.ceil(-math.log10(best))
    reach = ("the best that it can do is -scene_accuracy "
             f"{math.ceil(best * 10 ** place) / 10 ** place:.1g}, with "
             f"{as_text(points)} points" if best < 1.0 else "no grid that resolves the "
             "cohesive zone fits; give -scene_points, or a softer law "
             "or a smaller -scene_period")
    digits = (f", and what solves leave is about {as_text(FINEST)}"
              if scene.accuracy < FINEST else "")
    return (f"-scene_accuracy is '{as_text(scene.accuracy)}': that takes {size}, "
            f"and this machine has {memory() / USABLE / 1e9:.3g} "
            f"GB{digits}; {reach}")
