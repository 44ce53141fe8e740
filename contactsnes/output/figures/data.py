"""What figures show of an archive: the parts of its path, the points that have fields, their
fields."""

import numpy as np

from ..files import ArchiveError
from .style import EVENTS


class NothingToShow(Exception):
    """A figure would be empty; the message says why."""


def shear(record):
    """Direction of the tangential load ('', '_x' or '_y'), and the points from where it begins
    (slice)."""
    axes = [axis for axis in directions(record) if np.any(record[f"tangential_force{axis}"])]
    kind = "force" if np.isnan(record["normal_displacement"]).any() else "displacement"
    loads = [record[f"tangential_{kind}{axis}"] for axis in axes]
    if not any(map(np.any, loads)):
        raise NothingToShow("there is no tangential load")
    axis, load = max(zip(axes, loads), key=lambda pair: np.max(np.abs(pair[1])))
    moved = np.flatnonzero(np.abs(load - load[0]) > 1e-6 * np.max(np.abs(load)))
    return axis, slice(max(moved[0] - 1, 0) if moved.size else 0, None)


def unsheared(record):
    """The points before the tangential load begins; all where the normal load moves on under it
    (slice)."""
    try:
        first = shear(record)[1].start
    except NothingToShow:
        return slice(0, None)
    moves = np.ptp(record["normal_displacement"][first:]) > 0.1 * np.ptp(
        record["normal_displacement"])
    return slice(0, None if moves else first + 1)


def directions(record):
    """Endings of the tangential columns."""
    return [axis for axis in ("", "_x", "_y") if f"tangential_displacement{axis}" in record]


def along_load(record):
    """Endings of the tangential columns, that of the tangential load first."""
    try:
        first = shear(record)[0]
    except NothingToShow:
        return directions(record)
    return sorted(directions(record), key=lambda axis: axis != first)


def free_of_rounding(record, name, chosen=slice(None)):
    """Values of a column of loads, an array; 0 where they are rounding beside those of its kind,
    forces or displacements, at the chosen points.

    Parameters
    ----------
    record : Readable
    name : str
    chosen : list of int, or slice
    """
    columns = [f"normal_{name.split('_')[1]}", *(
        f"tangential_{name.split('_')[1]}{axis}" for axis in directions(record))]
    largest = max((np.max(np.abs(record[column][chosen]), initial=0.0,
                          where=np.isfinite(record[column][chosen]))
                   for column in columns if column in record), default=0.0)
    return np.where(np.abs(record[name]) <= 1e-9 * largest, 0.0, record[name])


def varies(values):
    """Whether values differ by more than rounding."""
    return np.ptp(values) > 1e-6 * np.max(np.abs(values))


def padded(low, high, part):
    """Limits of an axis around values from low to high: apart by a part of their range or, where
    they do not differ, of their size.

    Parameters
    ----------
    low, high : float, unit of the axis
    part : float
    """
    margin = part * (high - low if varies([low, high]) else abs(low) or 1.0)
    return low - margin, high + margin


def spread(low, high):
    """Limits of colours for values from low to high: these or, where they differ by rounding alone,
    some around them."""
    return (low, high) if varies([low, high]) else padded(low, high, 0.1)


def choose_points(record, points):
    """Points of profiles and maps: those asked for, or events, begin, end, and some between, of the
    sheared part."""
    stored = record.field_points
    if points is not None:
        chosen = [point + record.points if point < 0 else point for point in points]
        for point in chosen:
            if point not in stored:
                raise ArchiveError(f"{record.path} has no fields of point "
                                   f"{point}; it has those of {describe(stored)}.")
        return chosen
    try:
        stored = [point for point in stored if point >= shear(record)[1].start]
    except NothingToShow:
        pass
    events = [point for point in stored if record["event"][point] in EVENTS]
    chosen = {*stored[:1], *events[:2], *stored[-1:]}
    spread = [stored[index] for index in np.linspace(0, len(stored) - 1,
                                                     5).astype(int)] if stored else []
    for point in (spread[2], spread[1], spread[3]) if stored else ():
        chosen |= {point} if len(chosen) < 5 else set()
    return sorted(chosen)


def describe(stored):
    """The points that have fields, in words."""
    return (f"points {stored[0]} to {stored[-1]}" if stored
            else "none (-archive_fields all keeps them)")


def need_plane(record):
    """Raise NothingToShow where fields are those of an interface of one dimension; of one that has
    none, `fields` says so.

    Parameters
    ----------
    record : Readable
    """
    if len(record.coordinates) == 1:
        raise NothingToShow("the interface has one dimension")


def fields(record, chosen, kind="f8"):
    """Gap and traction at the chosen points.

    Parameters
    ----------
    record : Readable
    chosen : list of int
    kind : str, of numbers of the arrays
    """
    if not chosen:
        raise NothingToShow("no fields are stored (-archive_fields last or all keeps them)")
    if record.initial_gap is None:
        raise NothingToShow("the initial gap is not stored")
    return [((record.initial_gap + displacement[0]).astype(kind, copy=False),
             traction.astype(kind, copy=False))
            for displacement, traction in record.each(chosen)]


def contact_region(coordinates, gaps, tractions):
    """Limits in each direction of where the law acts, with a margin, and a gap above which it does
    not: half of what is below it higher, the largest gap where there is no such place.

    Parameters
    ----------
    coordinates : tuple of one or two arrays (nodes,)
    gaps, tractions : lists of arrays over the nodes, one a point: gap and normal traction
    """
    peak = max(max(-np.min(traction), np.max(traction)) for traction in tractions)
    acts, highest = np.zeros(gaps[0].shape, bool), -np.inf
    for gap, traction in zip(gaps, tractions):
        here = np.abs(traction) > 1e-2 * peak if peak > 0 else np.ones(gap.shape, bool)
        acts |= here
        highest = np.max(gap, where=here, initial=highest)
    limits = []
    for axis, x in enumerate(coordinates):
        inside = x[np.any(acts, axis=tuple(other for other in range(acts.ndim) if other != axis))]
        margin = 0.2 * (inside[-1] - inside[0]) + 2 * (x[1] - x[0])
        limits.append((max(inside[0] - margin, x[0]), min(inside[-1] + margin, x[-1])))
    ceiling = highest + 0.5 * (highest - min(0.0, *map(np.min, gaps)))
    return limits, min(ceiling, max(map(np.max, gaps)))


def inside(coordinates, limits):
    """The nodes within limits, and one beyond them: a tuple of slices.

    Parameters
    ----------
    coordinates : tuple of arrays (nodes,), one a direction
    limits : list of (low, high), of `contact_region`
    """
    bounds = [(np.searchsorted(x, low), np.searchsorted(x, high, "right"))
              for x, (low, high) in zip(coordinates, limits)]
    return tuple(slice(max(first - 1, 0), last + 1) for first, last in bounds)
