"""What to change in a scene whose law no grid in reach resolves: which ranges do, which parameter
is free for that, and what it changes.

A grid resolves a softening phi/delta^2. With a range f times as long and the same work, it falls by
f^2; the strength, phi/delta, falls by f. With the same strength the work has to grow by f^2, and
the range with it.
"""

import math
from dataclasses import replace

from ..options.fields import as_text
from ..scene.parts import peaks
from ..scene.resolution import resolution
from ..scene.settings import tangential_legs
from .costs import cost, in_bytes, in_time
from .grid_choice import cell_of, on
from .memory import USABLE, memory

PATIENCE = 3600.0
"""Seconds of one core within which a grid is called in reach."""


def needed_shape(scene, load):
    """Points, a power of two in each direction, that resolve the law of a scene."""
    cell = cell_of(scene, load)
    ratios = resolution(cell, any(tangential_legs(scene, load)))
    return tuple(2 ** math.ceil(math.log2(max(n * ratio, 16.0))) if ratio > 0.0 else n
                 for n, ratio in zip(cell.shape, ratios))


def in_reach(found):
    """Whether a `Cost` is within memory and patience."""
    return found.memory <= memory() and found.seconds <= PATIENCE


def fitting_shape(scene, load):
    """Points of the finest grid in reach, halved from what resolves the law."""
    shape = needed_shape(scene, load)
    while max(shape) > 64 and not in_reach(cost(scene, load, shape)):
        shape = tuple(max(16, n // 2) for n in shape)
    return shape


def softened(scene, sheared):
    """Largest Maugis parameters, normal and tangential, up to those of a scene, that its grid
    resolves."""
    def ratio(normal, tangential, slips):
        return max(resolution(replace(scene, normal_maugis=normal, tangential_maugis=tangential,
                                      range_normal=None, range_tangential=None), slips))

    normal, tangential = scene.normal_maugis, scene.tangential_maugis
    normal /= math.sqrt(max(1.0, 1.02 * ratio(normal, tangential, False)))
    for _ in range(300):
        if not sheared or ratio(normal, tangential, True) <= 1.0:
            break
        tangential *= 0.97
    return normal, tangential


def remedies(scene, load, theory):
    """Lines on what to change, none where a grid that resolves the law is in reach.

    Parameters
    ----------
    scene : Scene
    load : Load
    theory : function (scene), contact and pull-off by theory as phrases, empty where there is none
    """
    shape = needed_shape(scene, load)
    needed = cost(scene, load, shape)
    if in_reach(needed):
        return []
    fits = fitting_shape(scene, load)
    less = cost(scene, load, fits)
    normal, tangential = softened(on(cell_of(scene, load), fits), any(tangential_legs(scene, load)))
    softer = replace(scene, normal_maugis=normal, range_normal=None)
    return [f"out of reach: the law takes {_by(shape)} points, about {in_bytes(needed.memory)} of "
            f"memory (free are {in_bytes(memory() / USABLE)}) and {in_time(needed.seconds)} of one "
            f"core",
            f"{_by(fits)} points ({in_bytes(less.memory)}, {in_time(less.seconds)}) resolve it "
            "with longer ranges of the law:",
            *_normal(scene, normal, theory(scene), theory(softer)),
            *_tangential(scene, tangential),
            "what this changes, measured: docs/experiments.md"]


def _normal(scene, normal, before, after):
    """Lines on a smaller normal Maugis parameter."""
    factor = scene.normal_maugis / normal
    if factor <= 1.0:
        return []
    told = f"; by theory {before} become {after}" if before and after else ""
    if scene.units != "si":
        return [f"opening: -scene_normal_maugis {normal:.3g}, a range {factor:.3g} times as long"
                f"{told}"]
    work = factor ** 2 * scene.work_of_adhesion_normal
    return [f"opening, at fixed work: the strength is free, {_instead(scene, 'normal', factor)}"
            f"{told}",
            "opening, at fixed strength: the work is free, -scene_work_of_adhesion_normal "
            f"{as_text(float(f'{work:.3g}'))}; pull-off grows with it, {factor ** 2:.3g} times"]


def _tangential(scene, tangential):
    """Lines on a smaller tangential Maugis parameter."""
    factor = scene.tangential_maugis / tangential
    if factor <= 1.0:
        return []
    crack = ("a shear crack, K^2 = 2 E* phi_t, needs the same force while its cohesive length is "
             f"short beside the contact; gliding takes 1/{factor:.3g} of it, unless "
             "-scene_residual_friction makes up for it")
    if scene.units != "si":
        return [f"slip: -scene_tangential_maugis {tangential:.3g}, a range {factor:.3g} times as "
                f"long; {crack}"]
    work = factor ** 2 * scene.work_of_adhesion_tangential
    return [f"slip, at fixed work: the strength is free, {_instead(scene, 'tangential', factor)}; "
            f"{crack}",
            "slip, at fixed strength: the work is free, -scene_work_of_adhesion_tangential "
            f"{as_text(float(f'{work:.3g}'))}; gliding takes the same force, a shear crack "
            f"{factor:.3g} times as much, and the slip over which adhesion is lost is "
            f"{factor ** 2:.3g} times as long"]


def _instead(scene, end, factor):
    """Options of a range that is longer by a factor: the range, or the strength that goes with
    it."""
    unit, option = {"normal": ("p_n,r", "adhesive"), "tangential": ("p_t,r", "shear")}[end]
    length = factor * getattr(scene, f"range_{end}")
    strength = peaks(scene)[0 if end == "normal" else 1] * scene.scale(unit)[0] / factor
    return (f"-scene_{option}_strength {strength:.3g}, which is -scene_range_{end} {length:.3g}")


def _by(shape):
    return " x ".join(map(str, shape))
