"""Going on from any point of an archive with other legs: its scene, its load and its state."""

from dataclasses import fields

import numpy as np

from ..contact.balance import Balance
from ..contact.observables import point_of, refuse_elsewhere
from ..contact.state import State
from ..grid.windows import Window
from ..options.arguments import of_class, several, whole
from ..options.fields import InputError, as_text
from ..output import resuming
from ..output.reading import Record, read
from ..scene.load import Load, controls_along, names
from ..scene.scene import Scene
from ..scene.units import DERIVED

ASTRAY = 1e-3
"""residual_norm, beyond that of its own run, from which on a point is one of another scene."""


def beginning(archive, point, path, stop):
    """(record, number of the point, scene, Load) of what begins at a point of an archive.

    Parameters
    ----------
    archive : path, or Record
    point : int, from 0 or, if negative, from the end
    path : str, the legs
    stop : str, as of ``-load_stop``
    """
    record = archive if isinstance(archive, Record) else read(archive)
    point = whole("point", point, f"a whole number, 0 to {record.points - 1}, or -1 for the last")
    if not -record.points <= point < record.points:
        raise InputError(f"the point to begin at is {point}, but {record.path} has "
                         f"{record.points}: give 0 to {record.points - 1}, or -1 for the last")
    point %= record.points
    scene = scene_of(record)
    return record, point, scene, Load(start=load_at(record, point, scene), path=path, stop=stop)


def earlier(points, contact):
    """Points of an earlier run of a contact, a list; InputError for what are none, and where the
    last one does not balance."""
    meant = "points of a branch along this path, oldest first"
    found = [point_of(contact, point, "a point of history", meant)
             for point in several("history", points, meant)]
    if found:
        last = found[-1]
        left = Balance(contact)(last.state, last.controls, last.load, None).norm
        if not left <= ASTRAY + last.residual_norm:
            raise InputError(f"the last point of history leaves {left:.1e} ranges of the law of "
                             "this scene's balance: give points of a branch of the same scene, or "
                             "begin near it, Branch(..., first=point.state)")
    return found


def beside(state, contact):
    """A state of a contact near which a first point is to be, or None; InputError for others."""
    if state is not None:
        meant = "the state of a point, point.state"
        refuse_elsewhere(contact, of_class("first", state, State, meant), "first")
    return state


def scene_of(record):
    """The scene of an archive."""
    known = {field.name for field in fields(Scene)}
    derived = set(DERIVED) if record.scene.get("units") == "si" else set()
    values = {name: _plain(value) for name, value in record.scene.items()
              if name in known - derived}
    if values.get("geometry") == "file" and "heights_size" in values:
        del values["period"]  # which follows from that
    return Scene.typed(**values)


def _refuse_changed(record, branch):
    """InputError where a file that the scene of an archive is made of is another for its branch."""
    now = branch.attributes()
    for name, there in record.scene.items():
        part = name.removesuffix("_sha256")
        if part != name and now.get(name) != there:
            field = "geometry_file" if part == "heights" else part
            raise InputError(f"{Scene.option_name(field)} is '{getattr(branch.scene, field)}', "
                             f"which is another file than when {record.path} was made: bring that "
                             "one back, or begin anew")


def _plain(value):
    """An attribute of HDF5 as Python has it."""
    value = np.asarray(value).tolist()
    return tuple(value) if isinstance(value, list) else value


def load_at(record, point, scene):
    """The load of a point as ``-load_start`` has it, each component controlled as in its leg.

    Parameters
    ----------
    record : Record
    point : int, from 0
    scene : Scene of the archive
    """
    run = [run for run in record.runs if run.first <= point][-1]
    found = resuming.entries(run.options)
    load = Load(start=found.get("load_start"), path=found.get("load_path", ""))
    legs = load.legs(scene.dimension) if load.path else ()
    initial = load.initial(scene.dimension, scene.isolated)
    controls = controls_along(initial, legs)[int(record["leg"][point])]
    known = names(scene.dimension)
    columns = [known[component, control] for component, control in enumerate(controls)]
    return ", ".join(f"{name}={as_text(float(record[name][point]))}" for name in columns)


def state_at(branch, record, point):
    """The state of a point in an archive, from what is kept for going on, else from its fields.

    Parameters
    ----------
    branch : Branch of the same scene
    record : Record
    point : int

    InputError where there is none, or a file of the scene is another now.
    """
    _refuse_changed(record, branch)
    packed = record.states()
    if point in packed:
        return branch.restored(packed[point]).state
    if point not in record.field_points:
        where = [*record.field_points, *packed]
        raise InputError(f"{record.path} has no state of point {point}: it keeps those of "
                         f"{', '.join(map(str, sorted(set(where))[-4:]))}"
                         + (" and before" if len(set(where)) > 4 else "")
                         + "; -archive_fields all keeps every one")
    contact, scene = branch.contact, branch.scene
    if scene.isolated and not record.on_active:
        raise InputError(f"{record.path} has the last points of an isolated contact to go on from: "
                         "fields of the cell do not hold the displacement of the body as a whole; "
                         "-archive_fields_on active keeps it")
    field = contact.grid.part_of(record.field("displacement", point))
    sizes = [scene.scale(unit)[0] for unit in ("u_n,r", *["u_t,r"] * (len(field) - 1))]
    factors = contact.ranges[:len(field)] / sizes
    scaled = field.reshape(len(field), -1) * factors[:, None]
    mean = (record.active(point)["mean"] * factors if record.on_active
            else contact.grid.mean(scaled))
    return State(_about_centre(contact.widest, field.shape[1:]), scaled, mean)


def _about_centre(widest, shape):
    """The window of some nodes about the middle of the widest one, which may have other nodes where
    a contact is isolated."""
    if widest.shape == shape:
        return widest
    return Window(widest.grid, [start + (n - nodes) // 2 for start, n, nodes
                                in zip(widest.start, widest.shape, shape)], shape)
