"""Numbers on the shape of a contact, along and across the load: axes, centroid, edges, fronts of
slip, areas that stick and slip. Functions of a `Measurement`, in the scene's own units."""

import math

import numpy as np


def half_axis(m, axis):
    """Half of the contact's extent in a direction; 0 without contact, nan around the cell."""
    if not m.grid.any(m.in_contact):
        return 0.0
    first, last = m.outline.extent(axis)
    return 0.5 * (last - first)


def eccentricity(m):
    """sqrt(1 - (b/a)^2) of the longer half axis a and the shorter one b; nan where one is none."""
    axes = half_axis(m, 0), half_axis(m, 1)
    longer = np.maximum(*axes)  # nan if either is
    return math.sqrt(1.0 - (min(axes) / longer) ** 2) if longer > 0.0 else math.nan


def slip_area(m):
    """Part of the contact where the slip is beyond the law's peak."""
    return m.contact_area() - m.stick_area


def open_area(m):
    """The rest of the cell; nan around an isolated contact."""
    if m.contact.isolated:
        return math.nan
    return float(np.prod(m.grid.periods)) - m.contact_area()


def edge(m, side):
    """Outermost edge of the contact on a side of a line, 0 left, 1 right; nan without one."""
    return m.outline.extent(0)[side]


def front(m, side):
    """Outermost place that sticks on a side of a line: where slip has come to; nan where none
    does, or nothing slips."""
    if m.stick_area in (0.0, m.contact_area()):
        return math.nan
    place = m.stuck.extent(0)[side]
    return math.nan if abs(place - edge(m, side)) < 1e-9 * m.grid.periods[0] else place


def rows(scene):
    """Name -> (function, label, unit) of the shape's numbers that a scene has."""
    area = "beta^2" if scene.dimension == 2 else "beta"
    what = "area" if scene.dimension == 2 else "length"
    found = {"stick_area": (lambda m: m.stick_area, f"{what} that sticks", area),
             "slip_area": (slip_area, f"{what} that slips", area),
             "open_area": (open_area, f"{what} out of contact", area)}
    for axis, end in enumerate("xy"[:scene.dimension]):
        found[f"half_axis_{end}"] = (lambda m, axis=axis: half_axis(m, axis),
                                     f"half axis along {end}", "beta")
        found[f"centroid_{end}"] = (lambda m, axis=axis: m.outline.centroid(axis),
                                    f"centroid along {end}", "beta")
    if scene.dimension == 2:
        return found | {"eccentricity": (eccentricity, "eccentricity", ""),
                        "perimeter": (lambda m: m.outline.length(), "perimeter", "beta")}
    for side, word in enumerate(("left", "right")):
        found[f"edge_{word}"] = (lambda m, side=side: edge(m, side), f"{word} edge", "beta")
        found[f"front_{word}"] = (lambda m, side=side: front(m, side), f"{word} front of slip",
                                  "beta")
    return found
