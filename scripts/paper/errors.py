"""Errors of the figures: how far curves and markers move when runs are made again on twice the
points.

Distances are measured on the drawing, in points (1/72 inch), where a line has a width: what moves
less cannot be seen.
"""

import numpy as np
from statement import evaluated

from contactsnes.output.tables import markdown

MOST = 300
"""Vertices of a curve at which its distance from the other is taken, at most."""


def drawn_distance(figure, finer):
    """(largest distance of a curve or marker of one figure, which is laid out, from the same one of
    the other, in points; its width in points).

    ValueError where the figures do not have the same curves.
    """
    worst = (0.0, 1.0)
    for first, second in zip(_all_axes(figure), _all_axes(finer), strict=True):
        lines = [[line for line in axes.lines if line.get_transform() == axes.transData]
                 for axes in (first, second)]
        if len(lines[0]) != len(lines[1]):
            raise ValueError("the two figures have different curves")
        # Both in the coordinates of the first one's axes, whose limits may differ.
        scale = 72.0 / figure.dpi
        box = first.get_window_extent()
        for line, other in zip(*lines):
            here, there = (first.transData.transform(
                np.column_stack(one.get_data(orig=False)).astype(float)) for one in (line, other))
            away = scale * distance(here[_inside(here, box)], there[np.isfinite(there).all(axis=1)])
            width = (line.get_linewidth() if line.get_linestyle() not in ("None", "")
                     else line.get_markersize())
            worst = max(worst, (away, width), key=lambda pair: pair[0] / pair[1])
    return worst


def _all_axes(figure):
    """Axes of a figure with their insets."""
    return [one for axes in figure.axes for one in (axes, *axes.child_axes)]


def _inside(points, box):
    with np.errstate(invalid="ignore"):
        return ((points >= box.min) & (points <= box.max)).all(axis=1)


def distance(points, curve):
    """Largest distance of points (n, 2) from the polyline through others (m, 2); 0 for none,
    infinity from an empty one."""
    if not len(points):
        return 0.0
    if not len(curve):
        return np.inf
    points = points[::max(1, len(points) // MOST)]
    begin, along = curve[:-1], np.diff(curve, axis=0)
    if not len(begin):
        begin, along = curve, np.zeros_like(curve)
    length = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    nearest = []
    for point in points:
        share = np.clip(np.einsum("ij,ij->i", point - begin, along) / length, 0.0, 1.0)
        nearest.append(np.hypot(*(begin + share[:, None] * along - point).T).min())
    return float(max(nearest))


def movement(figure, draw, finer):
    """What the table says of a figure: how far it moves, and that over the width of what moves.

    Parameters
    ----------
    figure : matplotlib Figure as it was saved, or a sentence on what it lacks
    draw : function of results that made it
    finer : results of the runs on finer grids
    """
    if isinstance(figure, str):
        return f"not known: {figure}", ""
    again, missing = evaluated(draw, finer)
    if missing is not None:
        return f"not known: {missing}", ""
    moved, width = drawn_distance(figure, again)
    return f"{moved:.1g} points", f"{moved / width:.1g} of its width"


def figure_table(movements):
    """Lines of a table of ``movements``, figure -> `movement`."""
    return markdown(["figure", "largest movement of a curve or marker", ""],
                    [[figure, *moved] for figure, moved in movements.items()])
