"""Archives in SI for readers of figures: values in units with prefixes, mm and kPa, chosen once for
all figures of an archive."""

from collections.abc import Mapping

import numpy as np

from ..scene.units import prefix, sizes
from . import reading
from .files import ArchiveError

SHARED = (("normal_displacement", "approach"), ("tangential_displacement",
                                                "mean_tangential_displacement"),
          ("tangential_force",),
          ("elastic_energy", "interfacial_energy", "external_work", "interface_work",
           "dissipated_work", "energy_imbalance", "jump_work", "viscous_work"),
          ("half_axis",), ("contact_area", "stick_area", "slip_area"),
          ("edge_left", "edge_right", "front_left", "front_right"))
"""Columns that share a prefix, since they share an axis; without _x and _y."""

RANGES_SHOWN = 10.0
"""Gaps in figures, in ranges of the law, about."""


def read(path):
    """Archive at `path` as a `Readable`; ArchiveError if there is none."""
    return Readable(reading.read(path))


class Readable(Mapping):
    """A ``Record`` whose columns, coordinates and fields are in units with prefixes where they are
    in SI; else the record itself.

    Parameters
    ----------
    record : reading.Record

    Attributes
    ----------
    units : as those of the record
    coordinates, initial_gap : as those of the record
    contact_gap : gap where the contact ends, in the unit of the initial gap; nan if the scene does
        not say
    """

    def __init__(self, record):
        self._record = record
        self.units = dict(record.units)
        self._factors = {}
        scene = record.scene
        self._in_si = scene.get("units") == "si"
        self._scales = sizes(scene, scene["normal_maugis"],
                             scene["tangential_maugis"]) if self._in_si else {}
        law_range = self._scales.get("u_n,r", 1.0) / scene.get("normal_maugis", np.nan)
        if self._in_si:
            self._choose(law_range)
        self.coordinates = tuple(self.factor(name) * axis
                                 for name, axis in zip("xy", record.coordinates))
        self.initial_gap = (None if record.initial_gap is None
                            else self.factor("initial_gap") * record.initial_gap)
        self.contact_gap = scene.get("contact_threshold",
                                     np.nan) * law_range * self.factor("initial_gap")

    def __getitem__(self, name):
        values, factor = self._record[name], self.factor(name)
        return values if factor == 1.0 else factor * values

    def __iter__(self):
        return iter(self._record)

    def __len__(self):
        return len(self._record)

    def __getattr__(self, name):
        if name == "_record":  # of a copy in the making
            raise AttributeError(name)
        return getattr(self._record, name)

    def field(self, name, point):
        """(components, *grid) array of 'displacement' or 'traction' at a point."""
        return self._handy(name, self._record.field(name, point))

    def each(self, points, names=("displacement", "traction")):
        """Iterate over the fields of points, as ``Record.each``."""
        for found in self._record.each(points, names):
            yield [self._handy(name, values) for name, values in zip(names, found)]

    def _handy(self, name, values):
        """A field in units with prefixes."""
        factors = [self.factor(f"{name} {component}") for component in range(len(values))]
        if factors == [1.0] * len(values):
            return values
        return values * np.reshape(factors, (-1, *[1] * (values.ndim - 1)))

    @property
    def stored_units(self):
        """Units of columns and fields as the archive has them, without prefixes."""
        return self._record.units

    def factor(self, name):
        """Number of a column's unit here in one of the archive."""
        return self._factors.get(name, 1.0)

    def take_unit(self, name, other):
        """Show a column in the unit that another archive of the same kind is shown in."""
        self.units[name], self._factors[name] = other.units[name], other.factor(name)

    def _choose(self, law_range):
        """Units of columns, coordinates and fields by what they hold or, where that is nothing, by
        the scales of the scene."""
        record = self._record
        for name in record:
            family = next((family for family in SHARED
                           if name.removesuffix("_x").removesuffix("_y") in family), (name,))
            members = [other for other in record
                       if other.removesuffix("_x").removesuffix("_y") in family] or [name]
            if record.units[name] in ("m", "m^2", "N", "N/m", "J", "J/m", "Pa"):
                self._set(name, max(_largest(record[other]) for other in members))
        largest = (_largest(record["contact_area"])
                   or self._scales["beta"] ** len(record.coordinates))
        for name in "xy"[:len(record.coordinates)]:
            self._set(name, largest ** (1 / len(record.coordinates)))
        if record.coordinates:
            self._set("initial_gap", RANGES_SHOWN * law_range)
            self._set_field("displacement", "m", RANGES_SHOWN * law_range, self._scales["u_t,r"])
            self._set_field("traction", "Pa", self._scales["p_n,r"], self._scales["p_t,r"])

    def _set(self, name, largest):
        size, self.units[name] = prefix(largest, self._record.units[name])
        self._factors[name] = 1.0 / size

    def _set_field(self, name, unit, normal, tangential):
        """Prefixes of the components of a field in which a normal and a tangential value are
        handy."""
        each, units = zip(prefix(normal, unit), prefix(tangential, unit))
        self._factors |= {f"{name} {component}": 1.0 / each[min(component, 1)]
                          for component in range(3)}
        self.units[name] = "; ".join(units)


def check_units(records, columns):
    """ArchiveError where archives have one of some columns in different units."""
    first = records[0]
    for other in records[1:]:
        for name in (name for name in columns if name in other):
            if first.stored_units[name] != other.stored_units[name]:
                raise ArchiveError(f"{other.path} has {name} in '{other.stored_units[name]}', "
                                   f"{first.path} in '{first.stored_units[name]}': figures "
                                   "together take archives of one kind of units and dimension")


def alike(records):
    """Show the columns of several archives in common units; ArchiveError where their units
    differ, but for costs: a cell's and a window's differ, and those are seldom drawn."""
    check_units(records, [name for name in records[0] if not name.startswith("transforms")])
    for name in {name for record in records for name in record}:
        holders = [record for record in records if name in record]
        widest = min(holders, key=lambda record: record.factor(name))
        for record in holders:
            record.take_unit(name, widest)


def _largest(values):
    """Largest finite size of the values, 0 for none."""
    return float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
