"""Numbers of a point: forces, contact area, peak gaps and tractions; a table name -> function,
label, unit."""

from functools import cached_property
from typing import Callable, NamedTuple

import numpy as np

from ..grid.cell import Convolution
from ..grid.contours import first_largest
from . import states
from .energies import BALANCES, energy_unit

EVENTS = ("none", "fold", "jump", "gross_sliding", "pull_off", "bifurcation")
FOLD_KINDS = ("", "pull_off", "jump_in", "sliding")


class Observable(NamedTuple):
    """A number of a point: function of a `Measurement`, label, unit, NumPy type, and names if it is
    an enumeration."""

    function: Callable
    label: str
    unit: str
    kind: str = "f8"
    names: tuple = ()


class Measurement:
    """A point in its contact, with gap and traction on its window evaluated once (ranges of the
    law).

    Parameters
    ----------
    contact : Contact
    point : Point

    Attributes
    ----------
    gap : array (components, nodes): normal a, tangential b
    traction : array (components, nodes)
    """

    def __init__(self, contact, point):
        self.contact = contact
        self.point = point
        self.grid = contact.grid
        self.state, self.window = point.state, point.state.window
        self.components = len(point.controls)

        self.gap, self.traction = contact.evaluated(point.state)

    @cached_property
    def in_contact(self):
        """Mask of the nodes in contact."""
        return self.gap[0] < self.contact.scene.contact_threshold

    def component(self, values, index):
        """The value of a component, 0 where the leg has no such unknown."""
        return float(values[index]) if index < self.components else 0.0

    def mean(self, index):
        """Mean displacement over the cell, u_n,r or u_t,r; around an isolated contact that is the
        displacement far away."""
        if self.contact.isolated:
            return self.component(self.contact.signs(self.components) * self.point.displacements,
                                  index)
        return self.component(self.state.means, index) / self.contact.ranges[index]

    def energy(self, name):
        """An energy or work of the point; nan where it is that of a displacement which is not
        defined."""
        undefined = self.contact.datum if name in ("elastic_energy", "external_work") else 0.0
        return getattr(self.point, name) + undefined

    def contact_area(self):
        """Length or area where the gap is below the contact threshold."""
        return self.window.area_below(self.gap[0], self.contact.scene.contact_threshold)

    def minimum_gap(self):
        """Smallest normal gap of the cell, u_n,r."""
        smallest = self.grid.minimum(self.gap[0])
        if smallest >= self.contact.law.range and not self.window.is_whole:
            smallest = self.grid.minimum(self.contact.extended(self.state)[0]
                                         + self.contact.initial_gap)
        return float(smallest / self.contact.ranges[0])

    def maximum_pressure(self):
        """Largest compressive normal traction, p_n,r."""
        return float(self.grid.maximum(-self.traction[0], initial=0.0))

    def maximum_tangential_gap(self):
        """Largest tangential gap in contact, whose edge is mostly between nodes, u_t,r."""
        if self.components == 1:
            return 0.0
        inside = np.linalg.norm(self.gap[1:, self.in_contact], axis=0)
        edge = self.window.at_level(self.gap[0], self.contact.scene.contact_threshold, self.gap[1:])
        largest = max(self.grid.maximum(slip, initial=0.0)
                      for slip in (inside, np.linalg.norm(edge, axis=0)))
        return float(largest / self.contact.ranges[1])

    def maximum_tangential_traction(self):
        """Largest tangential traction, p_t,r."""
        if self.components == 1:
            return 0.0
        return float(self.grid.maximum(np.linalg.norm(self.traction[1:], axis=0), initial=0.0))

    def fields(self):
        """Displacement (u_n,r, u_t,r) and traction (p_n,r, p_t,r), or in SI, over the widest
        window, (components of the scene, *box)."""
        scene, each = self.contact.scene, (-1, *[1] * len(self.grid.shape))
        displacement, traction = np.zeros((2, scene.components, *self.grid.shape))
        displacement[:self.components] = self.contact.extended(self.state)
        displacement *= np.reshape(_sizes(scene, "u") / self.contact.ranges, each)
        self.window.put(self.traction, traction[:self.components])
        traction *= np.reshape(_sizes(scene, "p"), each)
        fields = ((displacement, traction) if self._null_or_leading() is None
                  else (displacement, traction, self._mode()))
        return tuple(self.contact.widest.box(self.contact.widest.take(field)) for field in fields)

    def _null_or_leading(self):
        """The leading mode and its eigenvalue, at a fold the null vector in its place where no mode
        was looked for, or None."""
        point = self.point
        if point.mode is not None:
            return point.mode, point.leading_eigenvalue
        return (point.tangents[0].state, 0j) if len(point.tangents) == 1 else None

    def _mode(self):
        """The leading mode (real part of a complex one), ranges of the law over its largest value,
        (components of the scene, *cell).

        Beyond the window no traction changes: there (s - 1) v = C D v, but for a constant.
        """
        contact = self.contact
        grid = self.grid
        (mode, eigenvalue) = self._null_or_leading()
        rate = eigenvalue - 1.0
        field = np.zeros((contact.scene.components, *grid.shape))
        window, inside = mode.window, field[:self.components]
        gap = states.onto(self.state, window).copy()
        tangent = np.zeros((self.components, self.components, window.size))
        gap[0] += window.take(contact.initial_gap)
        contact.law.evaluate(gap, np.empty_like(gap), tangent)
        if not window.is_whole and rate.imag == 0.0 and abs(rate) > 1e-6:
            window.put(np.einsum("ijn,jn->in", tangent, mode.displacement), inside)
            flat = inside.reshape(self.components, -1)
            Convolution(grid.whole, contact.operator(self.components),
                        self.components).apply(flat, flat)
            inside /= rate.real
            rim = window.rim()
            inside += np.mean((mode.displacement - window.take(inside))[:, rim],
                              axis=1).reshape(-1, *[1] * len(grid.shape))
        window.put(mode.displacement, inside)
        return field / np.copysign(np.max(np.abs(field)),
                                   field.flat[first_largest(field.reshape(-1))])


def _sizes(scene, symbol):
    """Sizes of the units of displacement ('u') or traction ('p') of each component in what the
    scene is told in."""
    return np.array([scene.scale(f"{symbol}_n,r")[0],
                     *[scene.scale(f"{symbol}_t,r")[0]] * scene.dimension])


def frame(contact):
    """Coordinates, initial gap and units of the fields of a contact, as arguments of an archive."""
    scene, nodes = contact.scene, contact.widest
    length, gap = scene.scale("beta")[0], scene.scale("u_n,r")[0] / contact.ranges[0]
    both = {name: "; ".join(scene.scale(f"{symbol}_{end},r")[1] for end in "nt")
            for name, symbol in (("displacement", "u"), ("traction", "p"))}
    return {"coordinates": tuple(length * axis.ravel() for axis in nodes.coordinates()),
            "initial_gap": gap * nodes.box(nodes.take(contact.initial_gap)),
            "units": {"coordinates": scene.scale("beta")[1], "initial_gap": scene.scale("u_n,r")[1],
                      **both}}


def table(scene):
    """Name -> Observable of everything that a point of a scene can tell, in the order of the
    archive and the scene's units."""
    return {name: _in_units(row, *scene.scale(row.unit))
            for name, row in _scaled_table(scene).items()}


def _in_units(row, size, unit):
    """A row in a unit, its present one being of that size."""
    return row if unit == row.unit else row._replace(function=lambda measurement: size
                                                     * row.function(measurement), unit=unit)


def _scaled_table(scene):
    """Name -> Observable of everything that a point of a scene can tell, in the scene's own
    units."""
    return {**_loads(scene), **_energies(scene), **_contact(scene), **_costs(scene),
            **_CERTIFICATES}


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
    """Rows of what was spent since the last point."""
    units = {"nonlinear_iterations": "", "linear_iterations": "", "function_evaluations": "",
             "transforms": f"real FFTs of the {'window' if scene.isolated else 'cell'}",
             "wall_time": "s"}
    return {name: Observable(lambda m, name=name: m.point.spent[name], name.replace("_", " "),
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


def observe(contact, point):
    """Name -> value of every observable of a point."""
    measurement = Measurement(contact, point)
    return {name: row.function(measurement) for name, row in table(contact.scene).items()}
