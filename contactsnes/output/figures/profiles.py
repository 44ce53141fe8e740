"""Figure of gap and tractions along a line through the contact."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .data import contact_region, directions, fields, padded
from .parts import place_legend
from .style import WIDTH, ZERO, colours
from .words import label, names, tangential


class Panel(NamedTuple):
    """A quantity along the line at several points: its words, symbol and unit for a label, its
    values at each point."""

    text: str
    symbol: str
    unit: str
    values: list


def draw_profiles(record, chosen):
    """Figure of the gap, the pressure and the tangential traction along x at the chosen points."""
    profiles = fields(record, chosen)
    if len(record.coordinates) > 1:
        middle = len(record.coordinates[1]) // 2
        profiles = [(gap[:, middle], traction[:, :, middle]) for gap, traction in profiles]
    gaps = [gap for gap, _ in profiles]
    tractions = [traction for _, traction in profiles]
    shown = [*panels(record, gaps, tractions), *modes(record, chosen)]
    figure = Figure((WIDTH, (0.25 + 0.45 * len(shown)) * WIDTH), layout="constrained")
    stack = figure.subplots(len(shown), 1, sharex=True)
    x, shades = record.coordinates[0], colours(len(chosen))
    # Thinner and thinner: what lies under another curve shows on both sides of it.
    widths = np.linspace(2.2, 0.9, len(chosen)) if len(chosen) > 1 else [1.2]
    for axes, panel in zip(stack, shown):
        for value, colour, width in zip(panel.values, shades, widths):
            axes.plot(x, value, color=colour, linewidth=width)
        axes.axhline(0, **ZERO)
        # where panels are many they are low: what a label says takes two lines there
        axes.set_ylabel(label(panel.text, panel.symbol, panel.unit,
                              "\n" if len(shown) > 3 else " "))
    zoom(stack, x, gaps, [traction[0] for traction in tractions])
    stack[-1].set_xlabel(label("", "x", record.units["x"]))
    title, texts = names(record, chosen)
    handles = [Line2D([], [], color=colour, linewidth=width, label=text)
               for colour, width, text in zip(shades, widths, texts)]
    place_legend(stack[0], handles, title)
    figure.align_ylabels()
    return figure


def panels(record, gaps, tractions):
    """Gap, pressure and the tangential tractions that are more than rounding.

    Parameters
    ----------
    record : Readable
    gaps : list of (x,) arrays, one a point, units of the record
    tractions : list of (components, x) arrays, one a point, units of the record
    """
    units = record.units["traction"].split("; ")
    found = [Panel("gap", "g_n", record.units["initial_gap"], gaps),
             Panel("pressure", "-p_n", units[0], [-traction[0] for traction in tractions])]
    for component, axis in enumerate(directions(record)[:len(tractions[0]) - 1], start=1):
        values = [traction[component] for traction in tractions]
        if np.max(np.abs(values)) > 1e-6 * np.max(np.abs(tractions)):
            found.append(Panel("tangential traction", tangential("p", axis), units[-1], values))
    return found


def modes(record, chosen):
    """The leading modes of the chosen points where any of them has one: the components that are
    more than rounding."""
    if "mode" not in record.units:
        return []
    found = np.array([mode if mode.ndim == 2 else mode[:, :, mode.shape[2] // 2]
                      for mode in (record.field("mode", point) for point in chosen)])
    sizes = np.max(np.abs(found), axis=(0, 2), initial=0.0, where=np.isfinite(found))
    symbols = "v_n", *(tangential("v", axis) for axis in directions(record))
    return [Panel("leading mode", symbol, "", list(values))
            for symbol, values, size in zip(symbols, found.transpose(1, 0, 2), sizes)
            if size > 1e-6 * max(sizes)]


def zoom(stack, x, gaps, tractions):
    """Limit profiles to the contact and its surroundings, and the gap to what matters there.

    Parameters
    ----------
    stack : list of axes, that of the gap first
    x : (nodes,) array, unit of the coordinates
    gaps, tractions : lists of (nodes,) arrays, one a point: gap and normal traction
    """
    (window,), ceiling = contact_region((x,), gaps, tractions)
    stack[0].set_xlim(window)
    floor = min(map(np.min, gaps))
    low, high = padded(floor, ceiling, 0.1)
    stack[0].set_ylim(low, ceiling if max(map(np.max, gaps)) > ceiling else high)
