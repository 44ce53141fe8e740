"""What a grid costs before it is solved: points of the path, memory, disk and time, about."""

import math
from typing import NamedTuple

from ..interface import shapes
from ..scene.settings import tangential_legs
from .grid_choice import active_part, cell_of, window_part
from .memory import memory_of_solve

TRANSFORMS = {(1, False): 20.0, (1, True): 60.0, (2, False): 120.0, (2, True): 200.0}
"""Transforms of the cell that a point takes where its window is the whole cell, by dimension and
whether it is sheared; measured."""
SECONDS, EACH = 1.5e-9, 0.015
"""Processor time of a transform of N nodes with all that goes with it over N log2 N, and of a point
besides; measured on one core."""
STEPS = 25
"""Points of a leg with default steps, about."""
PACKED = {1: 0.45, 2: 0.3, 4: 0.13}
"""Bytes of active fields in the file over those before they are compressed, by the number of mirror
images that are alike; measured."""
STATES = 4
"""States that an archive keeps for going on."""
SINGLE = 0.57
"""Part of the law's range beyond which tractions are nothing in single precision."""
NUMBERS = 50
"""Columns of an archive, about."""


class Cost(NamedTuple):
    """Of a run, about: points of its path, bytes of memory and of its archive, seconds of one
    core."""

    points: int
    memory: float
    disk: float
    seconds: float


def cost(scene, load, shape, output=None, steps=None):
    """The `Cost` of a scene on a grid.

    Parameters
    ----------
    scene : Scene
    load : Load
    shape : tuple of int, points of the grid
    output : Output, optional: by default nothing is kept
    steps : Steps, optional
    """
    sheared = tangential_legs(scene, load)
    nodes, count = math.prod(shape), scene.components if any(sheared) else 1
    part = _part(scene, load)
    needed = memory_of_solve(part * count * nodes, count * nodes)
    per_leg = _points(scene, load, steps)
    work = SECONDS * nodes * math.log2(nodes) * min(1.0, 4.0 ** scene.dimension * part)
    if _is_even(scene):
        work *= 0.5
    seconds = sum(points * (EACH + TRANSFORMS[scene.dimension, bool(slips)] * work)
                  for points, slips in zip(per_leg, sheared))
    points = sum(per_leg)
    kept = {"none": 0, "last": 1, "all": points}[output.fields if output and output.file
                                                 else "none"]
    disk = 0.0
    if output and output.file:
        disk = (8.0 * NUMBERS * points + kept * _bytes_of_fields(scene, load, nodes, output)
                + _bytes_besides(scene, load, nodes, kept and output.on_active(scene)))
    return Cost(points, needed, disk, seconds)


def _bytes_of_fields(scene, load, nodes, output):
    """Bytes of the fields of a point; of active nodes with their numbers, packed.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    output : Output
    """
    single = output.precision == "single"
    each = 2 * scene.components * (4 if single else 8)
    if not output.on_active(scene):
        return nodes * each
    packed = PACKED[_images(scene, load)] * (8 + each)
    return nodes * packed * _part(scene, load, active_part, SINGLE if single else 1.0)


def _bytes_besides(scene, load, nodes, rebuilt):
    """Bytes of the gap and of the states that a run goes on from; and of the compliance, packed,
    where fields are rebuilt by it.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    rebuilt : bool
    """
    states = STATES * scene.components * _part(scene, load)
    return 8.0 * nodes * (1.0 + states + (0.5 * PACKED[1] * scene.components ** 2
                                          if rebuilt else 0.0))


def _is_even(scene):
    """Whether states are mirror images of themselves about the apex, as far as shapes tell."""
    return not _is_given(scene)


def _images(scene, load):
    """Mirror images of a contact that are alike, in most of its points."""
    if _is_given(scene):
        return 1
    return 2 ** scene.dimension // (2 if scene.coupled and any(tangential_legs(scene, load)) else 1)


def _is_given(scene):
    """Whether the gap is known on nodes only."""
    return shapes.of(scene).gridded or bool(shapes.of(scene).memory(scene))


def _part(scene, load, part=window_part, *more):
    """The part of the cell that the window, or another ``part``, takes, 1 where that is not
    known."""
    if _is_given(scene):
        return 1.0
    try:
        return part(cell_of(scene, load), load, *more)
    except (ArithmeticError, ValueError):
        return 1.0


def _points(scene, load, steps):
    """Points of the start and of each leg, about; loads and steps as they are typed."""
    legs = load.legs(scene.dimension) if load.path else ()
    found, values = [1], dict(load.initial(scene.dimension, scene.isolated))
    for number, leg in enumerate(legs, start=1):
        component, control = next(iter(leg.controls.items()))
        before = values.get(component)
        length = (abs(control.value - before.value) if control.value is not None
                  and before is not None and before.control == control.control
                  and before.value is not None else None)
        points = STEPS if control.value is not None else 1
        if length and steps is not None:
            points = 5 + math.ceil(length / (steps.sizes(number, length)[1]))
        found.append(points)
        values |= leg.controls
    return found


def in_bytes(count):
    """Bytes in words."""
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.{2 if count < 100 * size else 3}g} {unit}"
    return f"{count / 1e3:.2g} kB"


def in_time(seconds):
    """A time in words."""
    for unit, size in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"
