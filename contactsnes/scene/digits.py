"""Numbers of a scene and its load so large that double precision leaves nothing of the law's range,
or of a pressure that the law has."""

import math

import numpy as np

from ..interface import laws
from ..options.fields import InputError, as_text
from .load import names, quantities

FARTHEST = 1e-3 / np.finfo(float).eps
"""Displacement, ranges of the law, whose last digit is a thousandth of a range: no gap is known any
more, whatever the method."""


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
    legs = scene.legs(load) if load.path else ()
    controlled = [("-load_start", scene.initial(load)), *(("-load_path", leg.controls)
                                                          for leg in legs)]
    for source, controls in controlled:
        for component, (control, value) in controls.items():
            name = names(scene.dimension)[component, control]
            unit = quantities(scene.dimension)[name].unit
            what = f"{source} has {name}={as_text(scene.told(value, unit))}"
            if value is not None and control == "displacement":
                _check_length(scene, what, value, unit, component)
            elif value is not None and component == 0 and not scene.isolated:
                _check_force(scene, what, value, unit)


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
        raise InputError(f"{given}: allowed is {most}, beyond which rounding leaves nothing of it; "
                         "try a Maugis parameter from 0.1 to 20, as most contacts have")


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
                         "which rounding leaves nothing of the law's range; try one of the size of "
                         "the heights, and see whether it is in the unit of the scene")


def _check_force(scene, what, value, unit):
    """InputError for a normal force that the law does not bear where all of the cell is as deep in
    the flat as it is followed; parameters as of `_check_length`."""
    law = laws.of(scene)
    pressure = -float(law.traction(np.array([[law.deepest]]))[0, 0])
    most = scene.normal_maugis * pressure * math.prod(scene.periods)
    if value > most > 0.0:
        raise InputError(f"{what}: allowed is at most {scene.short(most, unit, 2)}, what the law "
                         f"bears at a gap of {law.deepest:g} ranges everywhere; try a smaller one, "
                         "and see whether it is in the unit of the scene")
