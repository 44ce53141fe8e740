"""Numbers of contacts of many spots: how many and how large, and the mean gap. Functions of a
`Measurement`, in the scene's own units."""

import math

import numpy as np

from ..grid.spots import corrected_count


def spots(m):
    """Number of spots."""
    return len(m.spot_areas)


def largest_spot(m):
    """Size of the largest spot; 0 without contact."""
    return float(np.max(m.spot_areas, initial=0.0))


def mean_spot(m):
    """Mean size of spots; 0 without contact."""
    return float(np.mean(m.spot_areas)) if len(m.spot_areas) else 0.0


def corrected_area(m):
    """Area of the nodes in contact as codes for hard walls count it (`spots.corrected_count`)."""
    return corrected_count(m.spot_map > 0, m.grid) * m.grid.node_area


def mean_gap(m):
    """Mean of the gap over the cell, u_n,r; nan around an isolated contact."""
    if m.contact.isolated:
        return math.nan
    return float(m.contact.mean_initial_gap / m.contact.ranges[0]) + m.mean(0)


def rows(scene):
    """Name -> (function, label, unit) and, of whole numbers, their type."""
    area, what = ("beta^2", "area") if scene.dimension == 2 else ("beta", "length")
    found = {"spots": (spots, "spots of contact", "", "i8"),
             "largest_spot": (largest_spot, f"{what} of the largest spot", area),
             "mean_spot": (mean_spot, f"mean {what} of a spot", area),
             "mean_gap": (mean_gap, "mean gap", "u_n,r")}
    if scene.dimension == 2:
        found["corrected_area"] = (corrected_area, "contact area counted, edges corrected", area)
    return found
