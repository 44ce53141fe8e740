"""Figure of gap and tractions over a two-dimensional interface."""

from typing import NamedTuple

import matplotlib
import numpy as np
from contourpy import contour_generator
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .data import contact_region, fields, need_plane, spread
from .style import WIDTH
from .words import label, names, number


class Row(NamedTuple):
    """Maps of one quantity at several points: its words, symbol and unit for a label, its values at
    each point, colours."""

    text: str
    symbol: str
    unit: str
    values: list
    colormap: str
    norm: Normalize


BESIDE, BETWEEN, ABOVE = 1.5, 0.12, 0.9
"""Inches that ticks, labels and bars of colours take beside panels, rows between them, and titles
with what stands below."""


def draw_maps(record, chosen):
    """Figure of the gap, the pressure and the tangential traction over a two-dimensional
    interface."""
    need_plane(record)
    chosen = chosen if len(chosen) <= 3 else [chosen[0], chosen[len(chosen) // 2], chosen[-1]]
    maps = fields(record, chosen)
    gaps = [gap for gap, _ in maps]
    tractions = [traction for _, traction in maps]
    window, ceiling = contact_region(record.coordinates, gaps, [each[0] for each in tractions])
    shown = rows(record, gaps, tractions, ceiling)
    width, height = np.ptp(window, axis=1)
    # maps of two and three points take the width of two columns
    across = WIDTH * min(len(chosen), 2)
    panel = (across - BESIDE) / len(chosen) * height / width
    figure = Figure((across, len(shown) * (panel + BETWEEN) + ABOVE), layout="compressed")
    figure.get_layout_engine().set(w_pad=0.06, h_pad=0.04)
    grid = figure.subplots(len(shown), len(chosen), sharex=True, sharey=True, squeeze=False)
    for line, row in zip(grid, shown):
        draw_row(figure, line, record, row, gaps)
    title, texts = names(record, chosen)
    figure.suptitle(title, fontsize=matplotlib.rcParams["axes.titlesize"])
    for axes, text in zip(grid[0], texts):
        # three panels share the width of a column: the event has a line of its own
        axes.set(title=text.replace(", ", "\n"), xlim=window[0], ylim=window[1])
        axes.xaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
        axes.yaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
    for axes in grid[-1]:
        axes.set_xlabel(label("", "x", record.units["x"]))
    for axes in grid[:, 0]:
        axes.set_ylabel(label("", "y", record.units["y"]))
    return figure


def rows(record, gaps, tractions, ceiling):
    """What is shown of the points: gap, pressure and, where there is any, tangential traction.

    Parameters
    ----------
    record : Readable
    gaps : list of (x, y) arrays, one a point, units of the record
    tractions : list of (components, x, y) arrays, one a point, units of the record
    ceiling : float, gap above which all is of one colour
    """
    pressures = [-traction[0] for traction in tractions]
    shears = [np.hypot.reduce(traction[1:]) if len(traction) > 1 else np.zeros(1)
              for traction in tractions]
    units = record.units["traction"].split("; ")
    found = [Row("gap", "g_n", record.units["initial_gap"], gaps, "cividis",
                 Normalize(*spread(np.min(gaps), ceiling))),
             Row("pressure", "-p_n", units[0], pressures, *pressure_colours(pressures))]
    if np.max(shears) > 0:
        found.append(Row("shear", "|p_t|", units[-1], shears, "viridis",
                         Normalize(0, np.max(shears))))
    return found


def draw_row(figure, line, record, row, gaps):
    """Draw the maps of a quantity with their bar of colours.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    line : list of axes, one a point
    record : Readable
    row : Row
    gaps : list of (x, y) arrays, one a point, units of the record
    """
    for axes, value, gap in zip(line, row.values, gaps):
        image = draw_map(axes, record.coordinates, value, row.colormap, row.norm)
        draw_edge(axes, edge(record.coordinates, gap, record.contact_gap))
    bar = figure.colorbar(image, ax=list(line), label=label(row.text, row.symbol, row.unit, "\n"),
                          aspect=14, extend=beyond(row))
    if isinstance(row.norm, TwoSlopeNorm):
        norm = row.norm
        mark_bar(bar, (norm.vmin, norm.vmin / 2, 0, norm.vmax / 2, norm.vmax))


def beyond(row):
    """At which end of the bar of colours of a row its values go on: that of the largest, or none,
    in words of matplotlib."""
    return "max" if np.max(row.values) > row.norm.vmax else "neither"


def mark_bar(bar, ticks):
    """Put ticks at a bar of colours, with two digits or, where they are large, all before the
    point."""
    digits = max(2, len(f"{max(map(abs, ticks)):.0f}"))
    bar.set_ticks(ticks, labels=[number(tick, digits) for tick in ticks])


def draw_map(axes, coordinates, values, colormap, norm):
    """Image of values on the nodes of a two-dimensional grid.

    Parameters
    ----------
    axes : matplotlib's
    coordinates : two arrays (nodes,)
    values : array (x, y)
    colormap : str
    norm : matplotlib.colors.Normalize, in the unit of the values
    """
    x, y = coordinates
    half = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    extent = (x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1])
    return axes.imshow(values.T, origin="lower", extent=extent, cmap=colormap, norm=norm)


def edge(coordinates, gap, level):
    """Lines where the contact ends, arrays (points, 2), if the scene says at which gap.

    Parameters
    ----------
    coordinates : two arrays (nodes,)
    gap : array (x, y)
    level : float, unit of the gap; nan where the scene does not say it
    """
    inside = gap < level
    if not inside.any() or inside.all():
        return []
    near = []  # a node farther than the contact goes
    for axis in range(2):
        places = np.flatnonzero(inside.any(axis=1 - axis))
        near.append(slice(max(places[0] - 1, 0), places[-1] + 2))
    x, y = (line[part] for line, part in zip(coordinates, near))
    return contour_generator(x, y, gap[tuple(near)].T).lines(level)


def draw_edge(axes, lines):
    """Draw where the contact ends, lines of `edge`, to be seen on all colours."""
    for colour, width in (("white", 1.4), ("black", 0.6)):
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=width, zorder=2),
                            autolim=False)


def pressure_colours(pressures):
    """Colour map and norm: compression red, attraction blue, each over its own range."""
    low, high = np.min(pressures), np.max(pressures)
    if low > -1e-3 * high:
        return "Reds", Normalize(0, high or 1)
    if high < -1e-3 * low:
        return "Blues_r", Normalize(low, 0)
    return "RdBu_r", TwoSlopeNorm(0, low, high)
