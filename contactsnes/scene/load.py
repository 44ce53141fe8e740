"""Load paths: what is controlled, legs, and their text form.

The four quantities and their signs: D, W (normal displacement and force, compressive positive), U,
T (tangential ones).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, NamedTuple

from ..options.arguments import unfit
from ..options.fields import (
    LARGEST,
    WITH_UNIT,
    InputError,
    Options,
    computable,
    meant,
    number,
    option,
)


class Quantity(NamedTuple):
    """What a controllable quantity is: component (0 normal), 'displacement' or 'force', unit of its
    values."""

    component: int
    control: str
    unit: str


class Control(NamedTuple):
    """How a component is controlled, 'displacement' or 'force', and its value; None holds the value
    reached."""

    control: str
    value: float | None


@dataclass(frozen=True)
class TypedLeg:
    """One leg of a load path: its text, and component -> Control for what it names, in the order
    named."""

    text: str
    controls: Mapping[int, Control]


@cache
def quantities(dimension):
    """Name -> Quantity of the controllable quantities: normal before tangential, displacement
    before force. InputError for a dimension that no interface has."""
    if dimension not in (1, 2):
        raise unfit("the dimension of the interface", dimension, "1 or 2")
    forces = {1: ("w_n,r", "w_t,r"), 2: ("R phi_n", "R sqrt(phi_n phi_t)")}[dimension]
    table = {"normal_displacement": Quantity(0, "displacement", "u_n,r"),
             "normal_force": Quantity(0, "force", forces[0])}
    for component, suffix in enumerate({1: ("",), 2: ("_x", "_y")}[dimension], start=1):
        table["tangential_displacement" + suffix] = Quantity(component, "displacement", "u_t,r")
        table["tangential_force" + suffix] = Quantity(component, "force", forces[1])
    return table


def units(scene):
    """'displacement' and 'force' -> (size, name) of each component's unit in what the scene is told
    in."""
    return {control: tuple(scene.scale(quantity.unit)
                           for quantity in quantities(scene.dimension).values()
                           if quantity.control == control)
            for control in ("displacement", "force")}


@cache
def names(dimension):
    """(component, control) -> name of the controllable quantities."""
    return {(quantity.component, quantity.control): name
            for name, quantity in quantities(dimension).items()}


def controls_along(initial, legs):
    """What controls each component, 'displacement' or 'force', at the start and along each leg: a
    list of tuples.

    A leg changes the controls that it names, also where it moves nothing.
    """
    found = [tuple(initial[component].control for component in sorted(initial))]
    for leg in legs:
        found.append(tuple(leg.controls[component].control if component in leg.controls else control
                           for component, control in enumerate(found[-1])))
    return found


def _quantity(name, piece, source, dimension):
    """The Quantity of a name in `piece` of option `source`."""
    table = quantities(dimension)
    if name in table:
        return table[name]
    base = name.removesuffix("_x").removesuffix("_y")
    if base in ("tangential_displacement", "tangential_force"):
        hint = (f": in two dimensions write {base}_x or {base}_y" if dimension == 2
                else f": in one dimension write {base}")
    else:
        hint = meant(name, table, f": allowed are {', '.join(table)}")
    raise InputError(f"{source} has an unknown quantity in '{piece}'{hint}")


def _value(text, piece, source, hold):
    """A number of `piece`, or None for hold."""
    if text == "hold" and hold:
        return None
    try:
        value = number(text)
        if not math.isfinite(value) or not computable(value):
            raise ValueError
    except ValueError:
        kinds = (f"a finite number{', or hold' if hold else ''}, of a size from "
                 f"{1 / LARGEST:g} to {LARGEST:g}" + ", without its unit" * bool(
                     WITH_UNIT.fullmatch(text)))
        raise InputError(
            f"{source} has no number after '=' in '{piece}': allowed is {kinds}") from None
    return value


def _controls(text, source, dimension, hold):
    """Component -> Control of one leg, 'name=value, name=value'."""
    controls = {}
    for piece in map(str.strip, text.split(",")):
        name, equals, value = (part.strip() for part in piece.partition("="))
        if not equals:
            where = f"'{piece}' without '='" if piece else f"an empty piece in '{text.strip()}'"
            raise InputError(
                f"{source} has {where}: write quantity=value, for instance normal_force=25")
        quantity = _quantity(name, piece, source, dimension)
        control = Control(quantity.control, _value(value, piece, source, hold))
        if quantity.component in controls:
            raise InputError(f"{source} controls one component twice in "
                             f"'{text.strip()}', the second time by '{piece}': "
                             "a leg names the displacement or the force of "
                             "a component, once")
        controls[quantity.component] = control
    return controls


@dataclass(frozen=True, repr=False)
class Load(Options):
    """Load path: the ``-load_*`` options. An empty path is an error of `legs` only, since not every
    use needs one."""

    prefix: ClassVar[str] = "load_"
    title: ClassVar[str] = "Load path"
    start: str = option(None, "controlled values where the path begins, the "
                        "others zero: quantity=value, with commas", kind="text",
                        default_text="normal_displacement=0; isolated: no force")
    path: str = option("", "legs separated by ;, their quantities by commas: "
                       "normal_displacement, normal_force, tangential_displacement, "
                       "tangential_force (two dimensions: tangential ones with "
                       "_x or _y) = end value or hold",
                       default_text="none: run needs one")
    stop: str = option("none", "end the path at the first such event", many="list",
                       choices=("none", "gross_sliding", "pull_off"))

    def __post_init__(self):
        super().__post_init__()
        if "none" in self.stop and self.stop != "none":
            raise InputError(f"-load_stop is '{self.stop}': none stands alone; "
                             "allowed is none, gross_sliding, pull_off, or the "
                             "last two with a comma")

    @property
    def stops(self):
        """Events that end the path, a tuple of names; empty for none."""
        return tuple(name for name in self.stop.split(",") if name != "none")

    def initial(self, dimension, isolated=False):
        """Component -> Control where the path begins, for every component; what is not named:
        displacement 0, isolated force 0."""
        unloaded = {component: Control("force" if isolated else "displacement", 0.0)
                    for component in range(1 + dimension)}
        return unloaded if self.start is None else unloaded | _controls(self.start, "-load_start",
                                                                        dimension, hold=False)

    def legs(self, dimension):
        """The legs of the path, a tuple of TypedLeg. InputError for an empty path and for pieces
        that cannot be read."""
        if not self.path.strip():
            raise InputError(
                "-load_path is empty: name the legs, for instance -load_path \"normal_force=25\"")
        texts = [text.strip() for text in self.path.split(";")]
        if "" in texts:
            raise InputError(
                f"-load_path has an empty leg in '{self.path}': ';' stands between two legs only")
        return tuple(TypedLeg(text, _controls(text, "-load_path", dimension, hold=True))
                     for text in texts)
