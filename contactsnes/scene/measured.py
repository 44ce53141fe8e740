"""What experiments know in place of the scales of a scene in SI: Young's modulus, strengths of the
interface, and no radius where nothing is round.

E* = E/(1 - nu^2); a strength is the law's peak, sigma_max = N phi_n/delta_n and tau_max = T
phi_t/delta_t, with N = 1/e and T = sqrt(2/e) for the paper's law (eq. 4).
"""

import math
from types import SimpleNamespace

from ..interface import laws, shapes
from ..options.fields import InputError, as_text

INSTEAD = {"contact_modulus": "young_modulus", "range_normal": "adhesive_strength",
           "range_tangential": "shear_strength"}
"""Option in SI -> the one that may stand in its place."""

RIVALS = (*INSTEAD.items(), ("period", "heights_size"))
"""Pairs of options of which one fixes what the other does."""

PERIOD = 100.0
"""Period of the cell, beta, of a scene without a radius: that makes its internal scales."""


def completed(cls, values):
    """Values as they are typed with contact modulus, ranges and radius that follow from others, and
    without these others.

    Parameters
    ----------
    cls : Scene, whose fields have the defaults
    values : mapping of options that are given, in SI

    Raises
    ------
    InputError : where two fix the same thing, one is lacking, or the law has no such strength
    """
    for name, other in INSTEAD.items():
        if name in values and other in values:
            raise InputError(f"{cls.option_name(other)} is '{as_text(values[other])}', but "
                             f"{cls.option_name(name)} '{as_text(values[name])}' fixes the same: "
                             "give one of them")
    scene = SimpleNamespace(**{name: values.get(name, field.default)
                               for name, field in cls.__dataclass_fields__.items()})
    round_ = shapes.of(scene).uses_radius
    _refuse_missing(cls, values, round_)
    values = dict(values)
    if "young_modulus" in values:
        values["contact_modulus"] = values.pop("young_modulus") / (1.0 - scene.poisson ** 2)
    for end in ("normal", "tangential"):
        other = INSTEAD[f"range_{end}"]
        if other in values:
            peak = _peak(cls, scene, end, other)
            values[f"range_{end}"] = (peak * values[f"work_of_adhesion_{end}"]
                                      / values.pop(other))
    if "radius" not in values:
        values["radius"] = _internal_radius(values)
    return values


def _refuse_missing(cls, values, round_):
    """InputError where something is absent that makes a scene one in SI."""
    needed = ["work_of_adhesion_normal", "work_of_adhesion_tangential", "contact_modulus",
              *(["radius"] if round_ else []), "range_normal", "range_tangential"]
    absent = [name for name in needed if name not in values
              and INSTEAD.get(name) not in values]
    if absent:
        lacking = [cls.option_name(name) + (f" (or {cls.option_name(INSTEAD[name])})"
                                            if name in INSTEAD else "") for name in absent]
        raise InputError(f"-scene_units is 'si' without {' and '.join(lacking)}: give "
                         + ("it" if len(lacking) == 1 else "all of these"))
    period = values.get("period")
    sizes = period if isinstance(period, (tuple, list)) else (period,)
    if "radius" not in values and (period is None or not all(map(math.isfinite, sizes))):
        raise InputError("-scene_units is 'si' without -scene_radius and without a finite "
                         "-scene_period: one of them sets the lengths of the scene; of this "
                         "geometry give the period")


def _peak(cls, scene, end, option):
    """Peak of the scene's law, phi/delta; InputError where it cannot be known before the scales
    are."""
    law = laws.of(scene)
    scaled = [name for name in law.declared() if cls.rule(name)["unit"].endswith(",r")]
    peak = getattr(law, f"{end}_peak")
    if scaled or not peak > 0.0:
        raise InputError(f"{cls.option_name(option)} is '{as_text(getattr(scene, option))}', but "
                         f"the law {scene.law} has no such strength that is known before its "
                         f"range: give -scene_range_{end}")
    return peak


def _internal_radius(values):
    """The radius with which the longest period is `PERIOD` beta: beta^3 = R^2 phi_n/E*."""
    period = values["period"]
    length = max(period) if isinstance(period, (tuple, list)) else period
    return math.sqrt((length / PERIOD) ** 3 * values["contact_modulus"]
                     / values["work_of_adhesion_normal"])
