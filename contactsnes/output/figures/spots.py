"""Figure of the spots of a contact on a plane: a numbered map, and how their sizes are spread."""

import matplotlib
import matplotlib.ticker
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from ...grid.spots import labelled, sizes
from .data import NothingToShow, choose_points, fields, need_plane
from .maps import draw_map
from .parts import place_legend
from .style import WIDTH, colours
from .words import label, names

FEW = 9
"""Spots up to which each is a mark, and their number counts in steps of one."""
NUMBERED = 12
"""Spots of a map that carry their numbers: the largest."""


def draw_spots(record, points):
    """Figure of the spots at that of some points (by default events, and where there are most
    spots) which has the most, numbered from the largest on; and the number of spots above each size
    at all of these points."""
    need_plane(record)
    chosen = choose_points(record, points)
    if points is None and "spots" in record and record.field_points:
        stored = list(record.field_points)
        chosen = sorted({*chosen, stored[int(np.argmax(record["spots"][stored]))]})
    found = {point: _ranked(labelled(gap < record.contact_gap))
             for point, (gap, _) in zip(chosen, fields(record, chosen))}
    found = {point: ranks for point, ranks in found.items() if ranks.any()}
    if max((ranks.max() for ranks in found.values()), default=0) < 2:
        raise NothingToShow("no stored point has more than one spot")
    mapped = max(found, key=lambda point: found[point].max())
    ratio = np.ptp(record.coordinates[1]) / np.ptp(record.coordinates[0])
    figure = Figure((WIDTH, (ratio + 0.75) * WIDTH), layout="constrained")
    above, below = figure.subplots(2, 1, height_ratios=[ratio, 0.55])
    title, texts = names(record, list(found))
    shown = dict(zip(found, texts))
    _draw_numbered(above, record, found[mapped])
    above.set(title=f"{title}: {shown[mapped]}", xlabel=label("", "x", record.units["x"]),
              ylabel=label("", "y", record.units["y"]))
    _draw_sizes(below, record, found, shown, title)
    return figure


def _ranked(labels):
    """Numbers of spots in the order of their sizes, 1 the largest, 0 where there is none."""
    order = np.argsort(-sizes(labels), kind="stable")
    ranks = np.zeros(len(order) + 1, dtype=int)
    ranks[1 + order] = np.arange(1, len(order) + 1)
    return ranks[labels]


def _draw_numbered(axes, record, ranks):
    """Draw a map of spots, each in a colour, the largest with their numbers."""
    shades = ListedColormap(matplotlib.colormaps["tab20"].colors)
    draw_map(axes, record.coordinates, np.ma.masked_equal(ranks, 0) % 20, shades,
             matplotlib.colors.Normalize(0, 19))
    for spot in range(1, min(ranks.max(), NUMBERED) + 1):
        place = [axis[node] for axis, node in zip(record.coordinates, _middle(ranks == spot))]
        axes.annotate(str(spot), place, (4, 4), textcoords="offset points", fontsize=6,
                      path_effects=[withStroke(linewidth=1.5, foreground="white")])


def _middle(mask):
    """The node of a spot that is nearest to its middle around the cell."""
    nodes = np.argwhere(mask)
    angles = 2 * np.pi * nodes / mask.shape
    middle = np.angle(np.mean(np.exp(1j * angles), axis=0))
    return nodes[np.argmin(np.sum(1.0 - np.cos(angles - middle), axis=1))]


def _draw_sizes(axes, record, found, shown, title):
    """Draw the number of spots that are not smaller than each size.

    Parameters
    ----------
    axes : matplotlib's
    record : Readable
    found : mapping of points to ranked spots
    shown : mapping of points to their words
    title : str, of the legend
    """
    node = np.prod([axis[1] - axis[0] for axis in record.coordinates])
    unit, shades = record.units["x"], colours(len(found))
    for ranks, colour in zip(found.values(), shades):
        areas = node * sizes(ranks)
        axes.step(areas, np.arange(1, len(areas) + 1), where="pre", color=colour, marker="."
                  if len(areas) <= FEW else "")
    most = max(ranks.max() for ranks in found.values())
    axes.set(xscale="log", yscale="log" if most > FEW else "linear", ylabel="spots not smaller",
             xlabel=label("size of a spot", "A", "beta^2" if unit == "beta" else f"{unit}²"))
    if most <= FEW:
        axes.set_ylim(0, most + 0.5)
        axes.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    place_legend(axes, [Line2D([], [], color=colour, label=shown[point])
                        for point, colour in zip(found, shades)], title)
