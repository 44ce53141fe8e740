"""Numbers of a point: forces, contact area, peak gaps and tractions; a table name -> function,
label, unit."""

import math
from functools import lru_cache
from types import MappingProxyType
from typing import Callable, NamedTuple

import numpy as np

from ..continuation.points import Point
from ..options.arguments import of_class, several
from ..options.fields import InputError, as_text
from ..options.fields import meant as like
from ..scene.scene import Scene
from . import contact_shape, rough_contact
from .energies import BALANCES, energy_unit
from .measurement import Measurement
from .problem import Contact

EVENTS = ("none", "fold", "jump", "gross_sliding", "pull_off", "bifurcation")
ASTRAY = 1e-6
"""Force, over its size or 1 w_n,r, beyond what its solve left by which a point of a contact may
differ from what the law bears at its displacements."""
STIFFNESS = "stiffness"
"""The column that takes a solve."""
STIFFNESS_UNITS = {1: "w_n,r/u_n,r", 2: "R phi_n/u_n,r"}
"""Its unit by the dimension of the interface."""
FOLD_KINDS = ("", "pull_off", "jump_in", "sliding")


class Observable(NamedTuple):
    """A number of a point: function of a `Measurement`, label, unit, NumPy type, and names if it is
    an enumeration."""

    function: Callable
    label: str
    unit: str
    kind: str = "f8"
    names: tuple = ()


def frame(contact):
    """Coordinates, initial gap and units of the fields of a contact, as arguments of an archive: of
    several processes they are parted."""
    scene, nodes, grid = contact.scene, contact.widest, contact.grid
    first, *second = nodes.coordinates()
    axes = (grid.joined(first), *second)
    length, gap = scene.scale("beta")[0], scene.scale("u_n,r")[0] / contact.ranges[0]
    both = {name: "; ".join(scene.scale(f"{symbol}_{end},r")[1] for end in "nt")
            for name, symbol in (("displacement", "u"), ("traction", "p"))}
    heights = grid.parted(nodes.box(nodes.take(contact.initial_gap)), -2,
                          lambda block: gap * block)
    return {"coordinates": tuple(length * axis.ravel() for axis in axes), "initial_gap": heights,
            "units": {"coordinates": scene.scale("beta")[1], "initial_gap": scene.scale("u_n,r")[1],
                      **both}}


def compliance(contact):
    """(circle, blocks) of the body's compliance in the units of the fields: points of the circle of
    the widest window, and (i, j) -> half spectrum; of several processes they are parted. Where no
    leg has tangential unknowns nothing answers along the flat, whatever the body would."""
    scene, window = contact.scene, contact.widest
    ends = "n" + "t" * scene.dimension
    factor = {(i, j): scene.scale(f"u_{one},r")[0] / contact.ranges[i]
              / scene.scale(f"p_{other},r")[0]
              for i, one in enumerate(ends) for j, other in enumerate(ends)}
    operator = contact.operator(scene.components)
    return window.circle(), {
        key: contact.grid.parted(operator.on_window(key, window), -1,
                                 lambda block, factor=factor[key]: factor * block)
        for key in operator.blocks
        if scene.tangential != "off" or (key[0] > 0) == (key[1] > 0)}


@lru_cache(maxsize=4)
def table(scene):
    """Name -> Observable of everything that a point of a scene can tell, in the order of the
    archive and the scene's units."""
    of_class("scene", scene, Scene)
    return MappingProxyType({name: _in_units(row, *scene.scale(row.unit))
                             for name, row in _scaled_table(scene).items()})


def _in_units(row, size, unit):
    """A row in a unit, its present one being of that size."""
    return row if unit == row.unit else row._replace(function=lambda measurement: size
                                                     * row.function(measurement), unit=unit)


def _scaled_table(scene):
    """Name -> Observable of everything that a point of a scene can tell, in the scene's own
    units."""
    shape = {name: Observable(*row) for module in (contact_shape, rough_contact)
             for name, row in module.rows(scene).items()}
    return {**_loads(scene), **_energies(scene), **_contact(scene), **shape, **_costs(scene),
            **_CERTIFICATES}


def stiffness(scene):
    """The row of dW/dD, which a linear solve finds where it is asked for."""
    return Observable(None, "stiffness $dW/dD$", scene.scale(STIFFNESS_UNITS[scene.dimension])[1])


def _loads(scene):
    """Rows of the leg, of displacements and forces."""
    ends, (normal, tangential) = ((("_x", "_y"), ("R phi_n", "R sqrt(phi_n phi_t)"))
                                  if scene.dimension == 2 else (("",), ("w_n,r", "w_t,r")))
    rows = {"leg": Observable(lambda m: m.point.leg, "leg", "", "i8"),
            "normal_displacement": _displacement(0, "$D$", "u_n,r"),
            "normal_force": _force(0, "$W_n$", normal)}
    for i, end in enumerate(ends, start=1):
        rows[f"tangential_displacement{end}"] = _displacement(i, f"$U{end}$", "u_t,r")
        rows[f"tangential_force{end}"] = _force(i, f"$W_t{end}$", tangential)
    rows["approach"] = Observable(lambda m: -m.mean(0), "approach", "u_n,r")
    for i, end in enumerate(ends, start=1):
        rows[f"mean_tangential_displacement{end}"] = Observable(lambda m, i=i: m.mean(i),
                                                                f"mean slip{end}", "u_t,r")
    return rows


def _displacement(i, label, unit):
    """The row of a component's displacement under its load."""
    return Observable(lambda m: m.component(m.point.displacements, i), label, unit)


def _force(i, label, unit):
    """The row of a component's force."""
    return Observable(lambda m: m.component(m.point.forces, i), label, unit)


_ENERGIES = {"elastic_energy": "elastic energy", "interfacial_energy": "energy of the interface",
             "external_work": "work of the loads", "interface_work": "work on the interface",
             "dissipated_work": "energy lost in jumps",
             "energy_imbalance": "error of the energy balance",
             "jump_work": "work on the interface in a jump",
             "viscous_work": "work against viscosity in a jump"}


def _energies(scene):
    """Rows of energies and works."""
    return {name: Observable(lambda m, name=name: m.energy(name), label, energy_unit(scene))
            for name, label in _ENERGIES.items()}


def _contact(scene):
    """Rows of the contact, its gaps and tractions, and of what is left of its balance."""
    area = "beta^2" if scene.dimension == 2 else "beta"
    return {
        "contact_area": Observable(Measurement.contact_area, "contact area", area),
        "minimum_gap": Observable(Measurement.minimum_gap, "smallest gap", "u_n,r"),
        "maximum_pressure": Observable(Measurement.maximum_pressure, "largest pressure", "p_n,r"),
        "maximum_tangential_gap": Observable(Measurement.maximum_tangential_gap, "largest slip",
                                             "u_t,r"),
        "maximum_tangential_traction": Observable(Measurement.maximum_tangential_traction,
                                                  "largest shear traction", "p_t,r"),
        "residual_norm": _told("residual_norm", "residual", "ranges of the law", "f8"),
        "largest_residual": _told("largest_residual",
                                  "largest residual at a node where the law acts",
                                  "ranges of the law", "f8")}


def _told(name, label, unit="", kind="i8", names=()):
    """The row of a number that the point itself has."""
    return Observable(lambda m: getattr(m.point, name), label, unit, kind, names)


def _costs(scene):
    """Rows of what was spent since the last point; of one that was restored nobody knows."""
    transforms = f"real FFTs of the {'window' if scene.isolated else 'cell'}"
    units = {"nonlinear_iterations": "", "linear_iterations": "", "function_evaluations": "",
             "transforms": transforms, "transforms_single": transforms, "wall_time": "s"}
    return {name: Observable(lambda m, name=name, unknown=math.nan if unit else -1:
                             m.point.spent.get(name, unknown), name.replace("_", " "),
                             unit, "f8" if unit else "i8") for name, unit in units.items()}


_CERTIFICATES = {
    "resolved": _told("resolved", "resolved by the grid (0: folds may be its own)"),
    "stable": _told("stable", "stable (1, 0, -1: not checked)"),
    "unstable_modes": _told("unstable_modes", "unstable modes (-1: not known)"),
    "leading_eigenvalue": Observable(lambda m: m.point.leading_eigenvalue.real,
                                     "leading eigenvalue", ""),
    "leading_eigenvalue_imaginary": Observable(lambda m: m.point.leading_eigenvalue.imag,
                                               "its imaginary part", ""),
    "event": Observable(lambda m: m.point.event or "none", "event", "", "i8", EVENTS),
    "fold_kind": _told("fold_kind", "kind of fold", names=FOLD_KINDS),
    "fold_tangents": Observable(lambda m: len(m.point.tangents),
                                "tangents of a fold (2: in a corner of the branch)", "", "i8"),
    "fold_precision": _told("fold_precision",
                            "relative width of the bracket of a fold's load", kind="f8"),
    "jump_balance": _told("jump_balance", "what tells the energy lost in a jump", names=BALANCES)}
"""Rows of what is known of a point besides its balance."""


def observe(contact, point, names=None):
    """Name -> value of every observable of a point, or of those of some names: others cost nothing.

    Parameters
    ----------
    contact : Contact
    point : Point
    names : iterable of str, optional
    """
    of_class("contact", contact, Contact, "an object of contactsnes.Contact, for instance the "
             "contact of a branch")
    with contact.turn:
        measurement = Measurement(contact, found_on(contact, point))
        rows = table(contact.scene)
        return {name: rows[name].function(measurement) for name in named(names, rows)}


def named(names, known, *more):
    """Names of numbers of a point, a list: those that are asked for, or all that are known (None);
    InputError for what is none.

    Parameters
    ----------
    names : iterable of str, or None
    known, more : names of numbers, a mapping, and of such as are told where they are asked for only
    """
    if names is None:
        return list(known)
    names = several("names", names, "a list of columns, as in ['normal_force']")
    for name in names:
        if not isinstance(name, str) or name not in known and name not in more:
            raise InputError(f"a point has no {name!r}" + like(
                str(name), [*known, *more], "; contactsnes.table(scene) lists what it has",
                cutoff=0.55))
    return names


def point_of(contact, point, name="point", meant="a point of a branch"):
    """A point of the grid of a contact; InputError for another, whose nodes lie elsewhere.

    Parameters
    ----------
    contact : Contact
    point : Point
    name, meant : str, as of `of_class`
    """
    refuse_elsewhere(contact, of_class(name, point, Point, meant).state, name)
    return point


def found_on(contact, point):
    """A point of a contact; InputError for one of another, also of the same grid: the law would
    bear other forces at its displacements.

    Parameters
    ----------
    contact : Contact
    point : Point
    """
    state = point_of(contact, point).state
    forces = contact.load_factor(state.components) * contact.survey(state).total
    sizes = np.maximum(1.0, np.abs(point.forces))
    if not np.all(np.abs(forces - point.forces) <= (ASTRAY + 2.0 * point.residual_norm) * sizes):
        there, here = (", ".join(f"{force:.6g}" for force in each)
                       for each in (point.forces, forces))
        raise InputError(f"point is of another contact: its forces are {there} (scaled units), the "
                         f"law and the gap of this one make {here} of its displacements: take the "
                         "branch that it is of")
    return point


def refuse_elsewhere(contact, state, name):
    """InputError for a state whose nodes are not those of a contact, or not shared out as they are.

    Parameters
    ----------
    contact : Contact
    state : State
    name : str, of the argument
    """
    there, here = state.window.grid, contact.grid
    if (there.shape, there.periods) != (here.shape, here.periods):
        raise InputError(f"{name} is of another grid ({_in_words(there)}) than the contact's "
                         f"({_in_words(here)}): take the branch that it is of")
    if there.shared != here.shared:
        where = ("in one process as a whole", "in rows of several processes")
        raise InputError(f"{name} lies {where[there.shared]}, the contact {where[here.shared]}: "
                         "take the branch that it is of, or its contact")


def _in_words(grid):
    """Points and period of a grid in words."""
    return f"{as_text(grid.shape)} points, period {as_text(grid.periods)} beta"
