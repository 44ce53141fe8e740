"""Figures of the contact's shape along a path: axes, edges and fronts of slip, areas that stick and
slip; outlines over each other."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .data import NothingToShow, contact_region, fields, need_plane, shear, varies
from .parts import pieces, place_legend
from .style import BLUE, DASHED, GREY, VERMILION, WIDTH, colours
from .words import column_label, label, names

GREEN = "#009E73"
PLACES = {2: {"half_axis_x": ("half axis along x", BLUE, "-"),
              "half_axis_y": ("along y", VERMILION, "--")},
          1: {"edge_left": ("edges of contact", BLUE, "-"), "edge_right": (None, BLUE, "-"),
              "front_left": ("fronts of slip", VERMILION, "--"),
              "front_right": (None, VERMILION, "--")}}
"""By dimension: column -> its words in the legend, colour, line."""
AREAS = {"contact_area": ("in contact", GREY, "-")}
SLIPPING = {**AREAS, "stick_area": ("sticks", GREEN, "-"), "slip_area": ("slips", VERMILION, "--")}


def draw_shape(record):
    """Figure of half axes (on a line edges and fronts of slip), where the contact does not go
    around the cell, and of what is in contact, under shear of what sticks and slips, too, against
    the load that moves."""
    if "half_axis_x" not in record:
        raise NothingToShow("the archive has no columns of the contact's shape")
    load, part = _load(record)
    touching = record["contact_area"][part] > 0.0
    if not touching.any():
        raise NothingToShow("nothing is in contact")
    plane = "half_axis_y" in record
    places = PLACES[1 + plane]
    bounded = any(np.isfinite(record[name][part][touching]).any() for name in places)
    figure = Figure((WIDTH, (1.25 if bounded else 0.75) * WIDTH), layout="constrained")
    *above, below = figure.subplots(1 + bounded, 1, sharex=True, squeeze=False)[:, 0]
    what, symbol = ("half axes", "a") if plane else ("edges and fronts", "x")
    for axes in above:
        _draw(axes, record, load, part, places)
        axes.set_ylabel(label(what, symbol, record.units["half_axis_x"]))
    _draw(below, record, load, part, AREAS if load == "normal_force" else SLIPPING)
    below.set(xlabel=column_label(record, load), ylabel=column_label(record, "contact_area"))
    figure.align_ylabels()
    return figure


def _load(record):
    """The column that the shape is shown against, and the points from where it moves (slice)."""
    try:
        direction, part = shear(record)
        return f"tangential_force{direction}", part
    except NothingToShow:
        if varies(record["normal_force"]):
            return "normal_force", slice(0, None)
    raise NothingToShow("no load moves")


def _draw(axes, record, load, part, columns):
    """Draw columns in a unit against a load, and their legend above."""
    handles, unit = [], record.units[next(iter(columns))]
    for name, (text, colour, line) in columns.items():
        if record.units[name] != unit:
            raise NothingToShow(f"{name} has the unit {record.units[name]} instead of {unit}")
        horizontal, vertical = record[load][part], record[name][part]
        for piece in pieces(record["event"][part]):
            axes.plot(horizontal[piece], vertical[piece], color=colour, linestyle=line)
            if piece[0] > 0:
                jump = slice(piece[0] - 1, piece[0] + 1)
                axes.plot(horizontal[jump], vertical[jump], **{**DASHED, "linestyle": ":"},
                          color=colour)
        if text and np.isfinite(vertical).any():
            handles.append(Line2D([], [], color=colour, linestyle=line, label=text))
    axes.margins(0.06)
    place_legend(axes, handles)


def draw_outlines(record, chosen):
    """Figure of where the contact ends at the chosen points, over each other."""
    need_plane(record)
    found = fields(record, chosen)
    shown = [(point, gap) for point, (gap, _) in zip(chosen, found)
             if np.min(gap) < record.contact_gap < np.max(gap)]
    if not shown:
        raise NothingToShow("no stored point has an edge of contact")
    figure = Figure((WIDTH, WIDTH), layout="constrained")
    axes = figure.subplots()
    shades = colours(len(shown))
    for (_, gap), colour in zip(shown, shades):
        axes.contour(*record.coordinates, gap.T, levels=[record.contact_gap], colors=[colour],
                     linewidths=1.0)
    window, _ = contact_region(record.coordinates, [gap for gap, _ in found],
                               [traction[0] for _, traction in found])
    axes.set(xlim=window[0], ylim=window[1], aspect="equal",
             xlabel=label("", "x", record.units["x"]), ylabel=label("", "y", record.units["y"]))
    title, texts = names(record, [point for point, _ in shown])
    place_legend(axes, [Line2D([], [], color=colour, label=text)
                        for colour, text in zip(shades, texts)], title)
    return figure
