"""Numbers of a scene and its load so large that double precision leaves too little of the law's
range, and loads that press deeper than the law is followed."""

import math

import numpy as np

from ..interface import bodies, laws, shapes
from ..options.fields import InputError, as_text
from .load import names, quantities

FARTHEST = 1e-6 / np.finfo(float).eps
"""Displacement, ranges of the law, whose last digit is a millionth of a range: no gap is known as
well as a balance asks for, whatever the method."""


def check(scene, load, sheared):
    """InputError, with the option, its value and what is allowed, for a number that no solve would
    come to terms with.

    Parameters
    ----------
    scene : Scene
    load : Load
    sheared : bool, whether tangential unknowns appear
    """
    _check_ranges(scene, sheared)
    offset = scene.option_name("gap_offset")
    _check_length(scene, f"{offset} is '{as_text(scene.as_typed('gap_offset'))}'", scene.gap_offset,
                  "u_n,r", 0)
    for what, component, control, value, unit in _controlled(scene, load):
        if control == "displacement":
            _check_length(scene, what, value, unit, component)
        elif component == 0:
            (_check_alone if scene.isolated else _check_force)(scene, what, value, unit)


def check_depth(scene, load, gap, compliance):
    """InputError, as of `check`, for a normal displacement that presses all of a cell deeper than
    the law is followed.

    Parameters
    ----------
    scene : Scene
    load : Load
    gap : float, mean initial gap of the cell, ranges of the law
    compliance : float, of the mean displacement, ranges of the law over its unit of traction
    """
    law, most = laws.of(scene), _largest_pressure(scene)
    deepest = (gap - law.deepest + compliance * most) / scene.normal_maugis
    for what, component, control, value, unit in _controlled(scene, load):
        if (component, control) == (0, "displacement") and value > deepest and most > 0.0:
            raise InputError(f"{what}: allowed is at most {scene.short(deepest, unit, 2)}, where "
                             f"the gap is {law.deepest:g} ranges of the law in the mean of the "
                             "cell; try one of the size of the heights, and see whether it is in "
                             "the unit of the scene")


def _controlled(scene, load):
    """(what to say of it, component, control, value, unit) of each value that the load names."""
    legs = scene.legs(load) if load.path else ()
    for source, controls in [("-load_start", scene.initial(load)),
                             *(("-load_path", leg.controls) for leg in legs)]:
        for component, (control, value) in controls.items():
            name = names(scene.dimension)[component, control]
            unit = quantities(scene.dimension)[name].unit
            if value is not None:
                yield (f"{source} has {name}={as_text(scene.told(value, unit))}", component,
                       control, value, unit)


def _check_ranges(scene, sheared):
    """InputError for a range of the law that is lost beside u_n,r and u_t,r themselves."""
    for way, maugis, unit in list(zip(("normal", "tangential"), scene.ranges,
                                      ("u_n,r", "u_t,r")))[:1 + sheared]:
        if maugis <= FARTHEST:
            continue
        name, most = scene.option_name(f"{way}_maugis"), f"at most {FARTHEST:.2g}"
        given = f"{name} is '{as_text(maugis)}'"
        if scene.units == "si":
            given = f"the {way} range of the law is {scene.short(1.0 / maugis, unit)}"
            most = f"at least {scene.short(1.0 / FARTHEST, unit, 2)}"
        raise InputError(f"{given}: allowed is {most}, beyond which rounding leaves too little of "
                         "it; try a Maugis parameter from 0.1 to 20, as most contacts have")


def _check_length(scene, what, value, unit, component):
    """InputError for a displacement that is too far.

    Parameters
    ----------
    scene : Scene
    what : str, option and value
    value : float, in the unit
    unit : str, of the component
    component : int
    """
    most = FARTHEST / scene.ranges[component]
    if abs(value) > most:
        raise InputError(f"{what}: allowed is a size up to {scene.short(most, unit, 2)}, beyond "
                         "which rounding leaves too little of the law's range; try one of the size "
                         "of the heights, and see whether it is in the unit of the scene")


def _check_force(scene, what, value, unit):
    """InputError for a normal force that the law does not bear where all of the cell is as deep in
    the flat as it is followed; parameters as of `_check_length`."""
    most = scene.normal_maugis * _largest_pressure(scene) * math.prod(scene.periods)
    if value > most > 0.0:
        raise InputError(f"{what}: allowed is at most {scene.short(most, unit, 2)}, what the law "
                         f"bears at a gap of {laws.of(scene).deepest:g} ranges everywhere; try a "
                         "smaller one, and see whether it is in the unit of the scene")


def _check_alone(scene, what, value, unit):
    """InputError for a normal force on an isolated contact that presses the half-space, by which
    its grid is laid out, deeper than the last digits of its displacements allow, or, without a
    coating, harder than the law bears; parameters as of `_check_length`.

    Hertz's contact of half-width a under a parabola of curvature c is c a^2/2 deep at the apex
    below its rim, and bears pi c a^2/4 on a line, 4 c a^3/3 in the plane; its largest pressure is
    c a/2, and 2 c a/pi.
    """
    line, curvature = scene.dimension == 1, shapes.of(scene).parabola[scene.dimension]
    limits = [(math.sqrt(2.0 * FARTHEST / (scene.normal_maugis * curvature)),
               "beyond which rounding leaves too little of the law's range")]
    pressure = scene.normal_maugis * _largest_pressure(scene)
    if pressure > 0.0 and not any(bodies.of(scene).local_compliance):
        limits.append(((2.0 if line else math.pi / 2.0) * pressure / curvature,
                       f"what the law bears at a gap of {laws.of(scene).deepest:g} ranges"))
    width, why = min(limits)
    most = curvature * width ** 2 * (math.pi / 4.0 if line else 4.0 * width / 3.0)
    if value > most:
        raise InputError(f"{what}: allowed is at most {scene.short(most, unit, 2)} on an isolated "
                         f"half-space, {why}; try a smaller one, and see whether it is in the "
                         "unit of the scene")


def _largest_pressure(scene):
    """What a law bears where it is followed no deeper, in its unit of traction."""
    law = laws.of(scene)
    return -float(law.traction(np.array([[law.deepest]]))[0, 0])
