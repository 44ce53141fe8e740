"""Scenes in SI: the scales of their dimensionless form, and what is typed and told in metres,
newtons, joules and pascals.

beta = (R^2 phi_n / E*)^(1/3), u_n,r = beta^2 / R, u_t,r = sqrt(phi_t / phi_n) u_n,r; the force unit
of a line w_n,r = E* u_n,r (per length), of a plane R phi_n = E* u_n,r beta; p_n,r = phi_n / delta_n
(eq. 10 of the paper). A scene keeps its lengths dimensionless, whatever it was typed in; here is
all that knows of SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

from ..options.fields import InputError, Options, as_text, checked, option
from .load import Control, names, quantities
from .measured import INSTEAD, completed

UNITS = {"beta": "m", "beta^2": "m^2", "u_n,r": "m", "u_t,r": "m", "u_n,r/beta": "", "w_n,r": "N/m",
         "w_t,r": "N/m", "R phi_n": "N", "R sqrt(phi_n phi_t)": "N", "w_n,r u_n,r": "J/m",
         "R phi_n u_n,r": "J", "p_n,r": "Pa", "p_t,r": "Pa", "beta/E*": "m/Pa",
         "w_n,r/u_n,r": "Pa", "R phi_n/u_n,r": "N/m"}
"""Unit of a dimensionless quantity -> its unit in SI."""

SCALES = ("work_of_adhesion_normal", "work_of_adhesion_tangential", "contact_modulus", "radius")
DERIVED = {"normal_maugis": "range_normal", "tangential_maugis": "range_tangential",
           "work_ratio": "work_of_adhesion_tangential"}
"""Dimensionless group of a scene -> what it follows from in SI."""

PREFIXES = {-18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""Power of ten -> prefix of a unit in SI."""


@dataclass(frozen=True, repr=False)
class Units(Options):
    """Units of a scene, and the scales of those that are in SI: a part of `scene.Scene`."""

    units: str = option("dimensionless", "units of input and output: dimensionless; "
                        "si: metres, newtons (two dimensions; one: newtons "
                        "per metre) and what follows, with the next nine",
                        choices=("dimensionless", "si"))
    work_of_adhesion_normal: float = option(None, "phi_n", "J/m^2", kind="number", above=0,
                                            default_text="none: si needs it")
    work_of_adhesion_tangential: float = option(None, "phi_t", "J/m^2", kind="number", above=0,
                                                default_text="none: si needs it")
    contact_modulus: float = option(None, "E* = E/(1 - nu^2) against the rigid flat", "Pa",
                                    kind="number", above=0, default_text="none: si needs it, or "
                                    "-scene_young_modulus")
    young_modulus: float = option(None, "E, in place of -scene_contact_modulus, with "
                                  "-scene_poisson", "Pa", kind="number", above=0,
                                  default_text="none")
    radius: float = option(None, "R of cylinder or sphere, and of the curvature "
                           "that others have by default; else it sets "
                           "nothing but internal scales", "m", kind="number", above=0,
                           default_text="none: si needs it where something is round")
    range_normal: float = option(None, "delta_n, in place of -scene_normal_maugis", "m",
                                 kind="number", above=0, default_text="none: si needs it, or "
                                 "-scene_adhesive_strength")
    range_tangential: float = option(None, "delta_t, in place of -scene_tangential_maugis", "m",
                                     kind="number", above=0, default_text="none: si needs it, or "
                                     "-scene_shear_strength")
    adhesive_strength: float = option(None, "sigma_max, the law's largest attraction, in place of "
                                      "-scene_range_normal", "Pa", kind="number", above=0,
                                      default_text="none")
    shear_strength: float = option(None, "tau_max, the law's largest friction, in place of "
                                   "-scene_range_tangential", "Pa", kind="number", above=0,
                                   default_text="none")

    def __post_init__(self):
        super().__post_init__()
        given = [name for name in (*SCALES, *DERIVED.values(), *INSTEAD.values())
                 if getattr(self, name) is not None]
        if self.units == "dimensionless" and given:
            raise InputError(f"{self.option_name(given[0])} is "
                             f"'{as_text(getattr(self, given[0]))}', but -scene_units is "
                             "'dimensionless': add -scene_units si, or leave it out")
        if self.units == "si":
            self._check_scales()

    def _check_scales(self):
        """All scales are there, and the dimensionless groups are those that follow from ranges,
        where these are known."""
        for name, other in INSTEAD.items():
            if getattr(self, other) is not None:
                raise InputError(f"{self.option_name(other)} is '{as_text(getattr(self, other))}': "
                                 f"{self.option_name(name)} follows from it in Scene.typed only")
        absent = [self.option_name(name) for name in SCALES if getattr(self, name) is None]
        if absent:
            raise InputError(f"-scene_units is 'si' without {' and '.join(absent)}: give all "
                             "scales")
        for group, source in DERIVED.items():
            if getattr(self, source) is not None and not math.isclose(getattr(self, group),
                                                                      _groups(vars(self))[group],
                                                                      rel_tol=1e-9):
                raise InputError(f"{self.option_name(group)} is "
                                 f"'{as_text(getattr(self, group))}', but "
                                 f"{self.option_name(source)} makes it "
                                 f"{_groups(vars(self))[group]:.6g}: give one of them "
                                 "(from Python: Scene.typed)")

    def __repr__(self):
        """What makes the scene, in the units that it is typed in."""
        if self.units == "dimensionless":
            return super().__repr__()
        given = [f"{name}={value!r}" for name, value in self.stated().items()]
        return f"{type(self).__name__}.typed({', '.join(given)})"

    def stated(self):
        """Option -> value that made the scene: as it was given to `typed`, a strength as such, else
        those that are no defaults, in the units they are typed in."""
        if "_stated" in vars(self):
            return dict(vars(self)["_stated"])
        derived = DERIVED if self.units == "si" else ()
        return {field.name: self.as_typed(field.name) for field in fields(self)
                if getattr(self, field.name) != field.default and field.name not in derived}

    @classmethod
    def typed(cls, **values):
        """The instance for values as they are typed: with units='si' those that have a unit are in
        SI, and ranges stand for groups.

        InputError for a value that is missing or not allowed, or for a group that follows from
        others.
        """
        if values.get("units") != "si":
            return cls(**values)
        cls.prepare(lambda: {cls.prefix + name: value for name, value in values.items()})
        cls.refuse_unknown(values)
        values = {name: checked(cls.option_name(name), value, cls.rule(name))
                  for name, value in values.items() if value is not None}
        for group, source in DERIVED.items():
            if group in values:
                raise InputError(f"{cls.option_name(group)} is '{as_text(values[group])}', "
                                 "but with -scene_units si it follows from "
                                 f"{cls.option_name(source)}: leave it out")
        values = completed(cls, values)
        values |= _groups(values)
        factors = sizes(values, values["normal_maugis"], values["tangential_maugis"])
        return cls(**{name: _divided(value, factors.get(cls.rule(name)["unit"], 1.0))
                      for name, value in values.items()})

    def scale(self, unit):
        """Size of a unit (`UNITS`) in what the scene is typed and told in, and its name there: (1,
        unit) if that is itself."""
        if self.units == "dimensionless" or unit not in UNITS:
            return 1.0, unit
        return sizes(vars(self), self.normal_maugis, self.tangential_maugis)[unit], UNITS[unit]

    def as_typed(self, name):
        """The value of an option in the units it is typed in, to 14 digits."""
        return self.told(getattr(self, name), self.rule(name)["unit"])

    def told(self, value, unit):
        """A value (or several, or none) of a unit in what the scene is told in, to 14 digits:
        rounding does not show."""
        factor = self.scale(unit)[0]
        if factor == 1.0 or value is None or isinstance(value, str):
            return value
        return (tuple(self.told(item, unit) for item in value) if isinstance(value, tuple)
                else float(f"{value * factor:.14g}"))

    def words(self, value, unit):
        """A value (or several) of a unit in what the scene is told in, with the unit's name."""
        return f"{as_text(self.told(value, unit))} {self.scale(unit)[1]}"

    def short(self, value, unit, digits=4):
        """A value in a few digits, in what the scene is told in, with a prefix in SI.

        Parameters
        ----------
        value : float, in the unit
        unit : str, of `UNITS`
        digits : int, significant ones
        """
        size, name = self.scale(unit)
        return (f"{value:.{digits}g} {unit}" if self.units == "dimensionless"
                else prefixed(value * size, name, digits))

    def typed_words(self, value, unit):
        """A value as it is typed, of a dimensionless unit or the one in its place in SI, with that
        unit, in SI with a prefix."""
        return (f"{as_text(value)} {unit}" if self.units == "dimensionless"
                else prefixed(value, self.scale(unit)[1], 8))

    def initial(self, load):
        """Component -> Control where a load path begins (``Load.initial``), its values in the
        scene's own units."""
        return self._scaled(load.initial(self.dimension, self.isolated))

    def legs(self, load):
        """The legs of a load path (``Load.legs``), their values in the scene's own units."""
        return tuple(replace(leg, controls=self._scaled(leg.controls))
                     for leg in load.legs(self.dimension))

    def _scaled(self, controls):
        """Controls as they are typed with values in the scene's own units."""
        known, units = names(self.dimension), quantities(self.dimension)
        sizes = {component: self.scale(units[known[component, control]].unit)[0]
                 for component, (control, _) in controls.items()}
        return {component: Control(control, None if value is None else value / sizes[component])
                for component, (control, value) in controls.items()}

    def loads(self, controls, values):
        """What controls each component, and its values, in words and the units of the scene."""
        told = []
        for component, (control, value) in enumerate(zip(controls, values)):
            name = names(self.dimension).get((component, control), "approach")
            size, unit = self.scale(quantities(self.dimension)[name].unit if name != "approach"
                                    else "u_n,r")
            told.append(f"{name} " + (f"{value:.6g}" if self.units == "dimensionless"
                                      else prefixed(value * size, unit, 6)))
        return ", ".join(told)


def _scales(values):
    """beta, u_n,r and u_t,r in metres, from the values of `SCALES`."""
    normal, tangential, modulus, radius = (values[name] for name in SCALES)
    length = (radius ** 2 * normal / modulus) ** (1 / 3)
    return length, length ** 2 / radius, math.sqrt(tangential / normal) * length ** 2 / radius


def _groups(values):
    """The dimensionless groups that follow from SI, as far as their ranges are there."""
    _, normal, tangential = _scales(values)
    groups = {"work_ratio": values["work_of_adhesion_tangential"]
              / values["work_of_adhesion_normal"]}
    for group, displacement in (("normal_maugis", normal), ("tangential_maugis", tangential)):
        if values[DERIVED[group]] is not None:
            groups[group] = displacement / values[DERIVED[group]]
    return groups


def sizes(values, normal_maugis, tangential_maugis):
    """Unit (`UNITS`) -> its size in SI, from the values of `SCALES` and the Maugis parameters.

    Parameters
    ----------
    values : mapping, name of `SCALES` -> float, SI
    normal_maugis, tangential_maugis : float, dimensionless
    """
    length, normal, tangential = _scales(values)
    modulus = values["contact_modulus"]
    return {"beta": length, "beta^2": length ** 2, "u_n,r": normal, "u_t,r": tangential,
            "u_n,r/beta": normal / length, "w_n,r": modulus * normal, "w_t,r": modulus * tangential,
            "R phi_n": modulus * normal * length, "R sqrt(phi_n phi_t)": modulus * tangential
            * length, "w_n,r u_n,r": modulus * normal ** 2,
            "R phi_n u_n,r": modulus * normal ** 2 * length,
            "p_n,r": normal_maugis * modulus * normal / length,
            "p_t,r": tangential_maugis * modulus * tangential / length,
            "beta/E*": length / modulus, "w_n,r/u_n,r": modulus,
            "R phi_n/u_n,r": modulus * length}


def _divided(value, factor):
    """A value, or each of several, over a factor; words and what has no unit as they are."""
    if isinstance(value, tuple):
        return tuple(_divided(item, factor) for item in value)
    return value if factor == 1.0 or isinstance(value, (str, bool)) else value / factor


def prefix(largest, unit):
    """Size and name of the unit in SI, with the prefix in which ``largest`` is a handy number, at
    least 1: 1e-3 and mm for 0.02 m.

    The name is for readers: µ, and a raised 2.
    """
    power = 2 if unit == "m^2" else 1
    name, smallest = unit.replace("^2", "²"), 10.0 ** (-3 * (power - 1))
    usable = [(10.0 ** (power * place), sign) for place, sign in PREFIXES.items()
              if smallest * 10.0 ** (power * place) <= largest]
    size, sign = max(usable, default=(1.0, "")) if unit else (1.0, "")
    return size, sign + name


def prefixed(value, unit, digits=4):
    """A value in SI as text with a prefix.

    Parameters
    ----------
    value : float
    unit : str, in SI
    digits : int, significant ones
    """
    if not unit:
        return f"{value:.{digits}g}"
    size, name = prefix(abs(value) if math.isfinite(value) else 1.0, unit)
    return f"{value / size:.{digits}g} {name}"
