"""Figure of a surface before it is solved: its gap to the flat, and how its heights are spread."""

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ...scene.units import prefix
from .style import BLUE, STYLE, WIDTH, saved, settings, sized
from .words import label


def draw_surface(paths, coordinates, gap, units, title, asked):
    """Write a figure of an initial gap: a map, or a profile of a line, with the profile through its
    lowest place and the share of places by depth.

    Parameters
    ----------
    paths : paths of the files that are written
    coordinates : tuple of one or two arrays (nodes,), in the first unit
    gap : array over the nodes, in the second unit
    units : pair of str, of coordinates and gap; SI's get a prefix
    title : str
    asked : PlotOptions, for size and style
    """
    (length, unit), (height, depth) = (
        prefix(0.5 * largest, name) if name == "m" else (1.0, name)
        for largest, name in ((np.ptp(coordinates[0]), units[0]), (np.ptp(gap), units[1])))
    coordinates, gap = [axis / length for axis in coordinates], gap / height
    plane = gap.ndim == 2
    place = np.unravel_index(np.argmin(gap), gap.shape)
    with matplotlib.rc_context(settings(asked.style)):
        figure = Figure((WIDTH, (1.6 if plane else 1.0) * WIDTH), layout="compressed")
        figure.suptitle(title, fontsize=STYLE["axes.titlesize"])
        stack = figure.subplots(2 + plane, 1, height_ratios=[2.6, 1, 1] if plane else [1.6, 1])
        if plane:
            _draw_map(figure, stack[0], coordinates, gap, place, (unit, depth))
        stack[-2].plot(coordinates[0], gap[:, place[1]] if plane else gap, color=BLUE,
                       linewidth=0.8)
        stack[-2].set(xlabel=label("", "x", unit), ylabel=label("gap", "g_0", depth),
                      xlim=(coordinates[0][0], coordinates[0][-1]))
        stack[-2].invert_yaxis()
        shares = np.linspace(0, 100, 500)
        stack[-1].plot(np.percentile(gap, shares), shares, color=BLUE)
        stack[-1].set(xlabel=label("gap", "g_0", depth), ylabel="nearer (%)", ylim=(0, 100))
        sized(figure, asked.size)
        for path in paths:
            saved(figure, path)


def _draw_map(figure, axes, coordinates, gap, place, units):
    """The map of a gap, and the line of the profile in it.

    Parameters
    ----------
    figure, axes : matplotlib's
    coordinates : two arrays (nodes,)
    gap : array (x, y)
    place : indices of the lowest place
    units : of coordinates and gap
    """
    x, y = coordinates
    half = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    image = axes.imshow(gap.T, origin="lower", cmap="cividis_r", extent=(
        x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1]))
    axes.axhline(y[place[1]], color="white", linewidth=0.5)
    axes.set(xlabel=label("", "x", units[0]), ylabel=label("", "y", units[0]))
    figure.colorbar(image, ax=axes, label=label("gap", "g_0", units[1]))
