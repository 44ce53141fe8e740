"""Fields of archives as files of VTK (VTKHDF), which ParaView opens: an image over the interface, a
step of time for each point. VTK takes a file of one step for an image without time, and is given
one."""

from pathlib import Path

import numpy as np

from ..system.devices import Lenient
from ..system.hdf5 import h5py
from .files import ArchiveError, check_ending, check_output, target_beside
from .reading import read

VERSION = (2, 2)
"""Of the format: the first that knows several steps is 2.0."""

ENDING = ".vtkhdf"

NUMBERS = ("normal_displacement", "normal_force", "tangential_displacement", "tangential_force",
           "contact_area")
"""Columns that stand beside the fields of a step."""


def write_vtk(path, asked):
    """Write the fields of an archive; the path of the file.

    Parameters
    ----------
    path : path of the archive
    asked : ExportOptions

    Raises
    ------
    ArchiveError, InputError
        Where there are no fields, or no folder for the file.
    """
    record = read(path)
    points = _points(record, asked.chosen)
    target = Path(asked.output) if asked.output else target_beside(path, ENDING)
    check_ending(target, "a file for ParaView", (ENDING, ".hdf"))
    check_output(target)
    # ParaView knows the format by the ending.
    target = target if target.suffix else target.with_name(target.name + ENDING)
    partial = target.with_name(target.name + ".partial")
    try:
        with Lenient(partial) as device, h5py.File(device, "w") as file:
            _write(file.create_group("VTKHDF"), record, points,
                   {"single": "f4", "double": "f8"}[asked.precision])
        device.check()
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)
    return target


def _points(record, chosen):
    """The points that are written; ArchiveError for those without fields."""
    if not record.field_points or record.initial_gap is None:
        raise ArchiveError(f"{record.path} has no fields: run with -archive_fields all or last"
                           if record.points else f"{record.path} has no points to write yet.")
    if chosen is None:
        return record.field_points
    chosen = [point + record.points if point < 0 else point for point in chosen]
    strange = [point for point in chosen if point not in record.field_points]
    if strange:
        raise ArchiveError(f"{record.path} has no fields of point {strange[0]}; it has those of "
                           f"{record.field_points[0]} to {record.field_points[-1]}")
    return sorted(set(chosen))  # steps of time, which only grow


def _write(group, record, points, kind):
    """Write grid, steps and fields into the group that VTK reads."""
    axes = [*record.coordinates, np.zeros(1), np.zeros(1)][:3]
    group.attrs["Version"] = VERSION
    group.attrs.create("Type", np.bytes_("ImageData"))
    group.attrs["WholeExtent"] = [bound for axis in axes for bound in (0, len(axis) - 1)]
    group.attrs["Origin"] = [axis[0] for axis in axes]
    group.attrs["Spacing"] = [axis[1] - axis[0] if len(axis) > 1 else 1.0 for axis in axes]
    group.attrs["Direction"] = np.eye(3).ravel()
    group.attrs["unit"] = record.units["x"]
    numbers = _numbers(record, points)
    for name, values in numbers.items():
        group[f"FieldData/{name}"] = values
    data, steps = group.create_group("PointData"), (len(points),) if len(points) > 1 else ()
    for place, (displacement, traction) in enumerate(record.each(points)):
        for name, field in fields(record, displacement, traction).items():
            # VTK counts y, x; it leaves out directions of one node
            field = np.swapaxes(field, 0, 1) if len(record.coordinates) == 2 else field
            if name not in data:
                data.create_dataset(name, (*steps, *field.shape), kind,
                                    chunks=(*[1 for _ in steps], *field.shape),
                                    compression="gzip", compression_opts=1, shuffle=True)
            data[name][place if steps else ...] = field
    if steps:
        _write_steps(group.create_group("Steps"), points, list(data), list(numbers))


def _write_steps(steps, points, arrays, numbers):
    """Write which parts of the data belong to which step.

    Parameters
    ----------
    steps : h5py.Group, of the steps
    points : list of int
    arrays, numbers : lists of str, names of fields and of numbers
    """
    places = np.arange(len(points))
    steps.attrs["NSteps"] = len(points)
    steps["Values"] = np.array(points, dtype="f8")
    for name in arrays:
        steps[f"PointDataOffsets/{name}"] = places
    for name in numbers:
        steps[f"FieldDataOffsets/{name}"] = places
        steps[f"FieldDataSizes/{name}"] = np.ones((len(points), 2), int)


def _numbers(record, points):
    """Loads and contact of points, which ParaView shows as field data: name with its unit ->
    array."""
    names = [name for column in NUMBERS for name in (column, f"{column}_x", f"{column}_y")
             if name in record]
    return {_named(name.replace("_", " "), record.units[name]):
            np.asarray(record[name], "f8")[points] for name in names}


def _named(what, unit):
    """A name with its unit, without the stroke that would make a group of it in HDF5."""
    return f"{what} ({unit.replace('/', ' per ')})"


def fields(record, displacement, traction):
    """Name with its unit -> array over the nodes, of vectors with their components last.

    Parameters
    ----------
    record : Record
    displacement, traction : arrays (components, *grid), its fields at a point
    """
    shifts, stresses = (_both(record.units[name]) for name in ("displacement", "traction"))
    found = {_named("gap", record.units["initial_gap"]): record.initial_gap + displacement[0],
             _named("normal displacement", shifts[0]): displacement[0],
             _named("pressure", stresses[0]): -traction[0]}
    if len(displacement) > 1:
        found |= {_named("slip", shifts[1]): _vector(displacement[1:]),
                  _named("tangential traction", stresses[1]): _vector(traction[1:])}
    return found


def _both(units):
    """Normal and tangential unit of a field."""
    normal, _, tangential = units.partition("; ")
    return normal, tangential or normal


def _vector(components):
    """A tangential field as vectors of three components, along x, y and z."""
    along = [*components, *[np.zeros_like(components[0])] * (3 - len(components))]
    return np.stack(along, axis=-1)
