"""What a grid costs before it is solved: points of the path, memory, disk and time, about.

Constants are measured; docs/experiments.md has what they tell beside what runs took.
"""

import math
from typing import NamedTuple

from ..contact.problem import FORCE
from ..interface import laws, shapes
from ..output import sizes
from ..scene.isolation import largest_force
from ..scene.settings import Form, Output, Steps, loaded_legs, moving, tangential_legs
from .grid_choice import active_part, again, cell_of, window_part
from .memory import memory_of_solve
from .theory import sliding_displacement, theory

START, EACH, NODE = 0.35, {1: 0.006, 2: 0.015}, 6e-8
"""Processor time of a run besides its points, of a point by dimension, and of its observables for
each node, s."""
SECONDS = 1.2e-9
"""Processor time of a transform of N nodes with all that goes with it over N log2 N, s."""
TRANSFORMS = {(1, False): 35.0, (1, True): 150.0, (2, False): 30.0, (2, True): 100.0}
"""Transforms that a point takes of the circle its window is solved on, by dimension and whether it
is sheared; those in single precision count half."""
ROUGH, COUPLED, ESTIMATED = {False: 50.0, True: 65.0}, 2.0, {4: 4.5, 9: 9.5}
"""Such transforms of a gap that is known on nodes only; times as many where normal and tangential
displacements are coupled, and where errors are estimated on a grid of so many times the nodes."""
STEPS, STOPPED, FOLDED, JUMPING = 22, 0.65, 4, 4
"""Points of a leg with default steps, the part of a leg up to a pull-off that ends the path, points
that a fold and the jump from it add, and times as many points where a rough plane is moved and its
spots jump."""
FALLING = {"points": 1.4, "transforms": 1.6}
"""Times as many where friction falls with the slip, so that sliding begins with a jump."""
RUNNING = 120e6
"""Bytes of Python and its libraries."""
ITERATIONS = 30
"""Krylov iterations of a hard solve on a rough plane, rarely more."""
PACKED, UNIFORM, PACKING = {1: 0.8, 2: 0.42, 4: 0.235}, 0.3, {1: 3e-9, 2: 7e-8}
"""Bytes of active fields in the file over those before they are compressed, by the number of mirror
images that are alike; that of planes whose shape does not vary along a direction over it;
processor time for each byte before, by dimension, s."""
BOX = 1.3
"""Nodes of a box around a disc over those in it."""
CELL = 0.35
"""Bytes of single fields of the cell, compressed, over those before."""
SINGLE = 0.57
"""Part of the law's range beyond which tractions are nothing in single precision."""


class Cost(NamedTuple):
    """Of a run, about: points of its path, bytes of memory and of its archive, seconds of one
    core."""

    points: int
    memory: float
    disk: float
    seconds: float


def cost(scene, load, shape, output=None, steps=None, form=None):
    """The `Cost` of a scene on a grid.

    Parameters
    ----------
    scene : Scene
    load : Load
    shape : tuple of int, points of the grid
    output : Output, optional: by default nothing is kept
    steps, form : Steps and Form, optional
    """
    output, form, steps = output or Output(), form or Form(), steps or Steps()
    nodes, counts, loaded = math.prod(shape), _points(scene, load, steps), loaded_legs(scene, load)
    kept = _bytes_of_fields(scene, load, nodes, output, counts)
    more = ESTIMATED[again(scene, load)] if output.errors else 1.0
    seconds = START + PACKING[scene.dimension] * sum(kept) + sum(
        count * (EACH[scene.dimension] + NODE * nodes
                 + more * _solve(scene, load, nodes, form, bool(sheared)))
        for count, sheared in zip(counts, loaded))
    memory = _memory(scene, load, nodes, form, output.errors) + _waiting(
        scene, load, nodes, output, form, sum(kept) / sum(counts), sum(counts) / seconds)
    return Cost(sum(counts), memory,
                _disk(scene, load, nodes, output, counts, sum(kept), form, steps.keeps_modes),
                seconds)


def _solve(scene, load, nodes, form, sheared):
    """Processor time of the solves of a point, s.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    form : Form
    sheared : bool, whether it is
    """
    circle = max(2.0, min(nodes, 2 ** scene.dimension * _part(scene, load, form) * nodes)
                 / _images(scene, sheared, form))
    count = ROUGH[sheared] if _is_given(scene) else TRANSFORMS[scene.dimension, sheared]
    count *= COUPLED if scene.coupled else 1.0
    count *= FALLING["transforms"] if sheared and _falls(scene) else 1.0
    return count * SECONDS * circle * math.log2(circle)


def _memory(scene, load, nodes, form, errors):
    """Bytes that a run holds.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    form : Form
    errors : bool, whether they are estimated, on a finer grid
    """
    slips, sheared = any(tangential_legs(scene, load)), any(loaded_legs(scene, load))
    whole = nodes * (scene.components if slips else 1)
    unknowns = whole * _part(scene, load, form) / _images(scene, sheared, form)
    hard = {"iterations": ITERATIONS} if _is_given(scene) and scene.dimension == 2 else {}
    times = 1 + again(scene, load) if errors else 1
    solves = times * memory_of_solve(unknowns, whole, **hard)
    return RUNNING + shapes.of(scene).memory(scene) + solves


def _waiting(scene, load, nodes, output, form, fields, pace):
    """Bytes of points that wait for being written to an archive, so many a second, each with so
    many bytes of fields."""
    slips = any(tangential_legs(scene, load))
    state = 8.0 * nodes * _boxed(scene, load, form) * (scene.components if slips else 1)
    return sizes.waiting(pace, state + fields) if output.file else 0.0


def _bytes_of_fields(scene, load, nodes, output, counts):
    """Bytes of the fields that are kept of each leg, before they are compressed; what is zero takes
    nothing.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    output : Output
    counts : list of int, points of the start and of each leg
    """
    if not output.file or output.fields == "none":
        return [0.0]
    if output.fields == "last":
        counts = [0] * (len(counts) - 1) + [1]
    single = output.precision == "single"
    each = 2 * (4 if single else 8)
    if not output.on_active(scene):
        return [each * sizes.window_of(scene, nodes) * scene.components * count for count in counts]
    each *= nodes * _active(scene, load, SINGLE if single else 1.0)
    return [each * count * (scene.components if slips else 1)
            for count, slips in zip(counts, tangential_legs(scene, load))]


def _disk(scene, load, nodes, output, counts, kept, form, modes):
    """Bytes of an archive.

    Parameters
    ----------
    scene : Scene
    load : Load
    nodes : int, of the grid
    output : Output
    counts : list of int, points of the start and of each leg
    kept : float, bytes of the fields before they are compressed
    form : Form
    modes : bool, whether points have one
    """
    if not output.file:
        return 0.0
    slips = any(tangential_legs(scene, load))
    state = nodes * _boxed(scene, load, form) * (scene.components if slips else 1)
    active, packed, on_active = 0.0, 0.0, output.on_active(scene)
    if on_active:
        active = nodes * _active(scene, load, SINGLE if output.precision == "single" else 1.0)
    if output.fields == "all" and on_active:
        packed = kept * PACKED[_images(scene, any(loaded_legs(scene, load)), Form())]
        packed *= UNIFORM if scene.dimension == 2 and shapes.of(scene).uniform else 1.0
    elif output.fields == "all" and output.precision == "single":
        packed = kept * CELL
    return sizes.archive(scene, output, nodes, sum(counts), state, active, packed, modes)


def _images(scene, sheared, form):
    """Mirror images that states are made of, as far as shapes tell; of sheared ones where normal
    and tangential displacements are coupled half as many."""
    if _is_given(scene) or form.symmetry == "off":
        return 1
    return 2 ** scene.dimension // (2 if sheared and scene.coupled else 1)


def _falls(scene):
    """Whether friction falls with the slip."""
    return laws.of(scene).slip_softening > 0.0


def _is_given(scene):
    """Whether the gap is known on nodes only."""
    return shapes.of(scene).gridded or bool(shapes.of(scene).memory(scene))


def _part(scene, load, form):
    """The part of the cell that the window takes."""
    if form.window == "off" or form.form == "force":
        return 1.0
    return _share(scene, load, window_part)


def _boxed(scene, load, form):
    """The part of the cell that states take: less than that of windows on few nodes, which are
    wide, where a box around the nodes that the law acts on is small."""
    part, box = _part(scene, load, form), BOX ** (scene.dimension - 1) * _active(scene, load)
    return part if box > 0.5 or form.window == "off" or form.form == "force" else min(part, box)


def _active(scene, load, reach=1.0):
    """The part of the cell that the law acts on, within a part of its range."""
    return _share(scene, load, active_part, reach)


def _share(scene, load, part, *more):
    """A part of the cell, 1 where that is not known; of a rough body that of the smooth one."""
    scene = shapes.of(scene).smooth(scene)
    if _is_given(scene):
        return 1.0
    try:
        return part(cell_of(scene, load), load, *more)
    except (ArithmeticError, ValueError):
        return 1.0


# Points of a path


def _points(scene, load, steps):
    """Points of the start and of each leg, about; loads and steps as they are typed."""
    found = [1]
    for number, moved in enumerate(moving(scene, load), start=1):
        if not moved:
            found.append(0)
            continue
        component, control, way = moved
        points = STEPS
        if way and (steps.initial_step or steps.largest_step):
            points = FOLDED + math.ceil(way / steps.sizes(number, way)[1])
        found.append(math.ceil(points * _walked(scene, load, component, control, way)
                               * _crowded(scene, component, control)))
    return found


def _walked(scene, load, component, control, way):
    """The part of a leg that is walked before an event ends the path.

    Parameters
    ----------
    scene : Scene
    load : Load
    component : int, that moves
    control : Control
    way : float, its length as typed, or None
    """
    if component == 0:
        return STOPPED if "pull_off" in load.stops and control.value < 0.0 else 1.0
    if "gross_sliding" not in load.stops or not way or control.control == FORCE:
        return 1.0
    end = sliding_displacement(scene, theory(scene, largest_force(scene, load)))
    return 1.0 if end is None else min(1.0, scene.told(end, "u_t,r") / way + FOLDED / STEPS)


def _crowded(scene, component, control):
    """Times as many points where what is moved by its displacement jumps on the way."""
    if control.control == FORCE:
        return 1
    if component:
        return FALLING["points"] if _falls(scene) else 1
    return JUMPING if scene.dimension == 2 and _is_given(scene) else 1


def in_bytes(count):
    """Bytes in words."""
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.{2 if count < 100 * size else 3}g} {unit}"
    return f"{count / 1e3:.{2 if count < 1e5 else 3}g} kB"


def in_time(seconds):
    """A time in words."""
    for unit, size in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"
