"""What is solved but for the load, a scene, as a frozen dataclass of checked options.

Units: lengths along the interface in beta = (R^2 phi_n / E*)^(1/3), normal displacements in u_n,r =
beta^2 / R, tangential ones in u_t,r = sqrt(phi_t / phi_n) u_n,r. With these, the range of the law
is delta_n = u_n,r / normal_maugis and delta_t = u_t,r / tangential_maugis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ..interface import bodies, laws, shapes
from ..interface.bodies import BODIES
from ..interface.laws import LAWS
from ..interface.shapes import SHAPES
from ..options.fields import InputError, as_text, extend, option
from . import isolation, parts
from .measured import INSTEAD
from .resolution import default_spacing
from .units import UNITS, Units


@dataclass(frozen=True, repr=False)
class Scene(Units):
    """Body, interface and grid: everything but the load.

    Parameters are the ``-scene_*`` options, dimensionless (module docstring) even where units is
    'si', for then `Scene.typed` takes them as they are typed; InputError where they are not
    allowed.
    """

    prefix: ClassVar[str] = "scene_"
    title: ClassVar[str] = "Scene: body, interface and grid"
    dimension: int = option(1, "dimension of the interface", choices=(1, 2))
    points: int | tuple | str = option(None, "grid points of the cell; auto: for -scene_accuracy",
                                       kind="integer", minimum=16, even=True, many="directions",
                                       word="auto", default_text="8192 (two dimensions: 512,512)")
    accuracy: float = option(1e-6, "relative accuracy of force and contact area "
                             "that -scene_points auto aims at", above=0, below=1)
    period: float | tuple = option(100.0, "length of the periodic cell; inf: an "
                                   "isolated cylinder (one dimension) or sphere",
                                   "beta", above=0, many="directions", infinite=True)
    spacing: float | tuple = option(None, "distance of the nodes of an isolated contact", "beta",
                                    kind="number", above=0, many="directions",
                                    default_text="resolves the cohesive zone")
    geometry: str = option("cylinder", f"initial gap: {shapes.REGISTRY.described()}",
                           choices=tuple(SHAPES),
                           word="FILE.py:NAME, a function or class of one's own",
                           also=shapes.REGISTRY.knows)
    gap_offset: float = option(0.0, "constant added to the initial gap", "u_n,r")
    law: str = option("modified", f"tractions: {laws.REGISTRY.described()}", choices=tuple(LAWS),
                      word="FILE.py:NAME, a class of one's own", also=laws.REGISTRY.knows)
    normal_maugis: float = option(10.0, "lambda_n: u_n,r over the normal range of the law", above=0)
    tangential_maugis: float = option(1.0, "lambda_t: u_t,r over the tangential range of the law",
                                      above=0)
    work_ratio: float = option(1.0, "tangential over normal work of adhesion; "
                               "enters with elastic coupling, and in energies",
                               above=0)
    body: str = option("layer", f"elastic body: {bodies.REGISTRY.described()}",
                       choices=tuple(BODIES), word="FILE.py:NAME, a class of one's own",
                       also=bodies.REGISTRY.knows)
    tangential: str = option("auto", "tangential unknowns: auto (in legs whose "
                             "load or coupling needs them), on, off",
                             choices=("auto", "on", "off"))
    contact_threshold: float = option(2.718281828, "contact is where the gap is below this",
                                      "delta_n", above=0)

    def __new__(cls, *values, **named):
        """A scene that is yet to be filled, which has the options of its law, shape and body."""
        parts.admit(cls, named)
        return super().__new__(cls, **named)

    @classmethod
    def prepare(cls, entries):
        """The options of what is named in files of one's own are known before they are read."""
        found = entries()
        parts.admit(cls, {field: found.get(cls.prefix + field, "") for field in ("law", "geometry",
                                                                                 "body")})

    @classmethod
    def typed(cls, **values):
        """The instance for values as they are typed (``Units.typed``), completed by its shape."""
        scene = super().typed(**parts.completed(cls, values))
        known = cls.__dataclass_fields__
        stated = {name: value for name, value in values.items() if value is not None and (
            name in INSTEAD.values() or getattr(scene, name) != known[name].default)}
        object.__setattr__(scene, "_stated", stated)
        return scene

    def __post_init__(self):
        super().__post_init__()
        for name in ("points", "period", "spacing"):
            if self.dimension == 1 and isinstance(getattr(self, name), tuple):
                raise InputError(f"-scene_{name} is '{as_text(self.as_typed(name))}': "
                                 "one dimension takes one number; give one, "
                                 "or -scene_dimension 2")
        isolation.check_scene(self)
        parts.check(self)

    def __setstate__(self, values):
        """A scene that was pickled, perhaps in another process: files of one's own are read
        there."""
        parts.admit(type(self), values)
        vars(self).update(values)

    @property
    def components(self):
        """Components of a displacement, the normal one first; where tangential unknowns appear:
        `tangential_legs`."""
        return 1 + self.dimension

    @property
    def shape(self):
        """Grid points in each direction, a tuple; ValueError where they have yet to be chosen
        (``grid_choice.chosen``)."""
        if self.points == "auto":
            raise ValueError("the points of this scene have yet to be chosen")
        points = self.points or {1: 8192, 2: 512}[self.dimension]
        return points if isinstance(points, tuple) else (points,) * self.dimension

    @property
    def periods(self):
        """Length of the cell in each direction, a tuple, in beta."""
        return self.period if isinstance(self.period, tuple) else (self.period,) * self.dimension

    @property
    def isolated(self):
        """Whether the contact is the only one: no cell, no period."""
        return math.inf in self.periods

    @property
    def spacings(self):
        """Distance of the nodes in each direction, a tuple, in beta."""
        if self.isolated:
            spacing = self.spacing or default_spacing(self)
            return spacing if isinstance(spacing, tuple) else (spacing,) * self.dimension
        return tuple(period / points for period, points in zip(self.periods, self.shape))

    @property
    def ranges(self):
        """Maugis parameter of each component (displacement in ranges of the law = this times the
        scaled one), a tuple."""
        return (self.normal_maugis,) + (self.tangential_maugis,) * self.dimension

    @property
    def contact_gap(self):
        """Gap below which there is contact, in u_n,r."""
        return self.contact_threshold / self.normal_maugis

    @property
    def coupled(self):
        """Whether the body couples normal and tangential displacements by more than rounding."""
        return bodies.of(self).coupled(self)

    @classmethod
    def told_in(cls, name, units):
        """Unit of an attribute of a scene in an archive, by its ``units``; empty where there is
        none."""
        unit = cls.rule(name)["unit"] if name in cls.__dataclass_fields__ else ""
        return UNITS.get(unit, unit) if units == "si" else unit


def changed(scene, **values):
    """A scene with other values of some options, known to be allowed: `dataclasses.replace`, which
    looks at all of them anew, takes as long as a solve on a coarse grid."""
    made, known = object.__new__(type(scene)), scene.__dataclass_fields__
    vars(made).update({name: value for name, value in vars(scene).items() if name in known},
                      **values)
    return made


extend(Scene, *(registry.options for registry in parts.REGISTRIES))
