"""Figures of archives, as wide as a column of a journal."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.colors import Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .files import ArchiveError
from .prefixes import read

WIDTH = 8.5 / 2.54  # inches
STYLE = {"font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "legend.fontsize": 7,
         "xtick.labelsize": 7, "ytick.labelsize": 7, "axes.linewidth": 0.6, "lines.linewidth": 1.2,
         "lines.markersize": 5, "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True,
         "ytick.right": True, "legend.frameon": False, "savefig.dpi": 300,
         "mathtext.fontset": "dejavusans", "axes.formatter.use_mathtext": True, "pdf.fonttype": 42,}
# Okabe and Ito's colours, which the colour-blind can tell apart; the markers do without colour.
BLUE, VERMILION, GREY = "#0072B2", "#D55E00", "#555555"
FILLED = dict(markeredgecolor="white", markeredgewidth=0.4)
MARKS = {
    "start": dict(marker="o", markersize=4, color=BLUE, **FILLED),
    "fold": dict(marker="v", markersize=6, color=VERMILION, **FILLED),
    # open: others may sit in it
    "jump": dict(marker="s", markersize=7, color="none", markeredgecolor="#E69F00"),
    "gross_sliding": dict(marker="*", markersize=7, color="#009E73", **FILLED),
    "pull_off": dict(marker="X", markersize=5, color="#CC79A7", **FILLED),
    "bifurcation": dict(marker="D", markersize=5, color="black", **FILLED),
}
EVENTS = tuple(MARKS)[1:]
DASHED = dict(linestyle="--", linewidth=0.7)  # jumps
ZERO = dict(color=GREY, linewidth=0.4, zorder=0)


class Figures(NamedTuple):
    """Files that were written, and the figures that were not, with the reason."""

    files: list[Path]
    skipped: dict[str, str]


class NothingToShow(Exception):
    """A figure would be empty; the message says why."""


def plot(path, output=None, pdf=False, points=None):
    """Draw the figures that an archive has data for.

    - ``RUN-shear.png``: tangential force and contact area against tangential displacement
    - ``RUN-area.png``: contact area against tangential force
    - ``RUN-approach.png``: normal force against normal displacement, unsheared if it stays put
      under shear
    - ``RUN-profiles.png``: gap and tractions around the contact at chosen points (in two dimensions
      along y = 0)
    - ``RUN-maps.png``: gap, pressure and tangential traction over a two-dimensional interface at up
      to three points

    The shear's figures begin where the tangential load begins.

    Parameters
    ----------
    path : path of the archive
    output : folder of the figures; by default that of the archive
    pdf : bool, whether to write each figure as PDF, too
    points : list of int, points of profiles and maps, counted from 0 or, if negative, from the end;
        by default the first and the last of the shear, events, and some between them

    Returns
    -------
    Figures
        Files, and reasons for figures that were skipped.

    Raises
    ------
    ArchiveError
        If the archive cannot be read or has no points, the folder is missing, or a chosen point has
        no fields.
    """
    record = read(path)
    folder = Path(path).parent if output is None else Path(output)
    if not record.points:
        raise ArchiveError(f"{path} has no points to plot yet.")
    if not folder.is_dir():
        raise ArchiveError(
            f"The folder of the figures, {folder}, does not exist: create it or name another.")
    figures = Figures([], {})
    chosen = choose_points(record, points)
    with matplotlib.rc_context(STYLE):
        for name, draw in (("shear", draw_shear), ("area", draw_area), ("approach", draw_approach),
                           ("profiles", lambda record: draw_profiles(record, chosen)),
                           ("maps", lambda record: draw_maps(record, chosen))):
            try:
                figure = draw(record)
            except NothingToShow as reason:
                figures.skipped[name] = str(reason)
                continue
            for suffix in (".png", ".pdf") if pdf else (".png",):
                file = folder / f"{Path(path).stem}-{name}{suffix}"
                figure.savefig(file)
                figures.files.append(file)
    return figures


# Figures


def draw_shear(record):
    """Figure of tangential force and contact area against the applied tangential displacement."""
    direction, part = shear(record)
    figure = Figure((WIDTH, 1.25 * WIDTH), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    displacement = f"tangential_displacement{direction}"
    draw_branch(above, record, displacement, f"tangential_force{direction}", part)
    draw_branch(below, record, displacement, "contact_area", part)
    above.set_xlabel("")
    place_legend(above, event_handles(record, part))
    figure.align_ylabels()
    return figure


def draw_area(record):
    """Figure of the contact area against the tangential force."""
    direction, part = shear(record)
    figure = Figure((WIDTH, 0.8 * WIDTH), layout="constrained")
    axes = figure.subplots()
    draw_branch(axes, record, f"tangential_force{direction}", "contact_area", part)
    place_legend(axes, event_handles(record, part))
    return figure


def draw_approach(record):
    """Figure of the normal force against the displacements of the mean surface and, if another, of
    the top."""
    top = record["normal_displacement"]
    surface = record["approach"]
    force = record["normal_force"]
    part = unsheared(record)
    if record.points > 1 and not (varies(force[part])
                                  and (varies(top[part]) or varies(surface[part])
                                       or np.isnan(top).any())):
        raise NothingToShow("the normal load does not move")
    figure = Figure((WIDTH, 0.8 * WIDTH), layout="constrained")
    axes = figure.subplots()
    handles = []
    if not np.allclose(top, surface, rtol=1e-6, atol=1e-6 * np.max(np.abs(top))):
        for piece in pieces(record["event"][part]):
            axes.plot(top[part][piece], force[part][piece], ":", color=GREY)
        handles = [Line2D([], [], color=BLUE, label=r"mean surface, $\bar{d}$"),
                   Line2D([], [], color=GREY, linestyle=":", label="top of the body, $D$")]
    crowded = draw_inset(axes, record, part)
    draw_branch(axes, record, "approach", "normal_force", part, () if crowded else EVENTS)
    axes.axhline(0, **ZERO)
    axes.axvline(0, **ZERO)
    if handles:
        axes.set_xlabel(label("normal displacement", "d", record.units["approach"]))
    place_legend(axes, handles + event_handles(record, part))
    return figure


def draw_profiles(record, chosen):
    """Figure of the gap, the pressure and the tangential traction along x at the chosen points."""
    profiles = fields(record, chosen)
    if len(record.coordinates) > 1:
        middle = len(record.coordinates[1]) // 2
        profiles = [(gap[:, middle], traction[:, :, middle]) for gap, traction in profiles]
    x, units = record.coordinates[0], record.units["traction"].split("; ")
    panels = [("gap", "g_n", record.units["initial_gap"], [gap for gap, _ in profiles]),
              ("pressure", "-p_n", units[0], [-traction[0] for _, traction in profiles])]
    for component, axis in list(enumerate(directions(record)))[: max(len(profiles[0][1]) - 1, 0)]:
        values = [traction[1 + component] for _, traction in profiles]
        if np.max(np.abs(values)) > 1e-6 * np.max(np.abs([traction for _, traction in profiles])):
            panels.append(("tangential traction", tangential("p", axis), units[-1], values))
    if "mode" in record.units:
        modes = [mode if mode.ndim == 1 else mode[:, middle]
                 for mode in (record.field("mode", point)[0] for point in chosen)]
        panels += [("leading mode", "v_n", "", modes)] if np.isfinite(modes).any() else []
    figure = Figure((WIDTH, (0.25 + 0.45 * len(panels)) * WIDTH), layout="constrained")
    stack = figure.subplots(len(panels), 1, sharex=True)
    for axes, (text, symbol, unit, values) in zip(stack, panels):
        for value, colour in zip(values, colours(len(chosen))):
            axes.plot(x, value, color=colour)
        axes.axhline(0, **ZERO)
        axes.set_ylabel(label(text, symbol, unit))
    zoom(stack, x, [gap for gap, _ in profiles], [traction[0] for _, traction in profiles])
    stack[-1].set_xlabel(label("", "x", record.units["x"]))
    title, texts = names(record, chosen)
    handles = [Line2D([], [], color=colour, label=text)
               for colour, text in zip(colours(len(chosen)), texts)]
    place_legend(stack[0], handles, title)
    figure.align_ylabels()
    return figure


def draw_maps(record, chosen):
    """Figure of the gap, the pressure and the tangential traction over a two-dimensional
    interface."""
    if len(record.coordinates) < 2:
        raise NothingToShow("the interface has one dimension")
    chosen = chosen if len(chosen) <= 3 else [chosen[0], chosen[len(chosen) // 2], chosen[-1]]
    maps = fields(record, chosen)
    gaps, pressures = [gap for gap, _ in maps], [-traction[0] for _, traction in maps]
    shears = [np.hypot.reduce(traction[1:]) if len(traction) > 1 else np.zeros(1)
              for _, traction in maps]
    window, ceiling = contact_region(record.coordinates, gaps, pressures)
    units = record.units["traction"].split("; ")
    rows = [("gap", "g_n", record.units["initial_gap"], gaps, "cividis",
             Normalize(np.min(gaps), ceiling)), ("pressure", "-p_n", units[0], pressures,
                                                 *pressure_colours(pressures))]
    if np.max(shears) > 0:
        rows.append(("tang. traction", "|p_t|", units[-1], shears, "viridis",
                     Normalize(0, np.max(shears))))
    width, height = np.ptp(window, axis=1)
    panel = (WIDTH - 1.4) / max(len(chosen), 2) * height / width
    figure = Figure((WIDTH, len(rows) * (panel + 0.1) + 0.9), layout="compressed")
    grid = figure.subplots(len(rows), len(chosen), sharex=True, sharey=True, squeeze=False)
    for line, (text, symbol, unit, values, colormap, norm) in zip(grid, rows):
        for axes, value, gap in zip(line, values, gaps):
            image = draw_map(axes, record, value, colormap, norm)
            draw_edge(axes, record, gap)
        bar = figure.colorbar(image, ax=list(line), label=label(text, symbol, unit, "\n"),
                              aspect=12, extend="max" if text == "gap" else "neither")
        if isinstance(norm, TwoSlopeNorm):
            ticks = (norm.vmin, norm.vmin / 2, 0, norm.vmax / 2, norm.vmax)
            bar.set_ticks(ticks, labels=[number(tick, 2) for tick in ticks])
    title, texts = names(record, chosen)
    figure.suptitle(title, fontsize=STYLE["axes.titlesize"])
    for axes, text in zip(grid[0], texts):
        axes.set(title=text, xlim=window[0], ylim=window[1])
    for axes in grid[-1]:
        axes.set_xlabel(label("", "x", record.units["x"]))
    for axes in grid[:, 0]:
        axes.set_ylabel(label("", "y", record.units["y"]))
    return figure


# Parts of figures


def draw_branch(axes, record, x, y, part, shown=EVENTS):
    """Draw column `y` against column `x` at `part` (slice) of the points: jumps dashed, events and
    start marked."""
    horizontal = record[x][part]
    vertical = record[y][part]
    events = record["event"][part]
    if np.isnan(horizontal).any():
        raise NothingToShow("a half-plane under a force has no displacement as a whole")
    dots = {"marker": ".", "markersize": 3} if len(events) <= 25 else {}
    for piece in pieces(events):
        axes.plot(horizontal[piece], vertical[piece], color=BLUE, **dots)
        if piece[0] > 0:
            jump = slice(piece[0] - 1, piece[0] + 1)
            axes.plot(horizontal[jump], vertical[jump], color=BLUE, **DASHED)
    axes.plot(horizontal[0], vertical[0], **MARKS["start"], linestyle="none", zorder=3)
    for name in shown:
        axes.plot(horizontal[events == name], vertical[events == name], **MARKS[name],
                  linestyle="none", zorder=3)
    axes.set_xlabel(column_label(record, x))
    axes.set_ylabel(column_label(record, y))
    axes.margins(0.06)


def pieces(events):
    """Indices of the points between jumps: one array for each piece of the branch."""
    return np.split(np.arange(len(events)), np.flatnonzero(events[1:] == "jump") + 1)


def draw_inset(axes, record, part):
    """Inset, above a rising curve, of several events where they crowd at its lower end; whether
    there is need of it."""
    events, x, y = (record[name][part] for name in ("event", "approach", "normal_force"))
    at = events != "none"
    crowded = all(np.max(values[at], initial=values[0]) - np.min(values) < 0.2 * np.ptp(values)
                  for values in (x, y))
    if np.count_nonzero(at) < 3 or not crowded:
        return False
    inset = axes.inset_axes([0.11, 0.57, 0.34, 0.38])
    draw_branch(inset, record, "approach", "normal_force", part)
    limits = []
    for values, whole in ((x[at], x), (y[at], y)):
        margin = 0.3 * np.ptp(values) or 0.05 * np.ptp(whole)
        limits.append((np.min(values) - margin, np.max(values) + margin))
    inset.set(xlabel="", ylabel="", xlim=limits[0], ylim=limits[1])
    (left, right), (low, high) = limits
    axes.indicate_inset([left, low, right - left, high - low], edgecolor=GREY, linewidth=0.5)
    return True


def event_handles(record, part):
    """Entries of the legend for the start and the events that occur."""
    found = record["event"][part]
    handles = [Line2D([], [], **MARKS["start"], linestyle="none", label="start" if len(found) > 1
                      else "only point")]
    for name in (name for name in EVENTS if name in found):
        line = DASHED | {"color": BLUE} if name == "jump" else {"linestyle": "none"}
        look = {**MARKS[name], **line, "markerfacecolor": MARKS[name]["color"]}
        handles.append(Line2D([], [], **look, label=kinds(record, part) if name == "fold"
                              else word(name)))
    return handles


def kinds(record, part):
    """Folds with the kinds that occur."""
    found = (record["fold_kind"][part][record["event"][part] == "fold"] if "fold_kind" in record
             else [])
    words = sorted({word(kind) for kind in found if kind})
    return f"fold ({', '.join(words)})" if words else "fold"


def place_legend(axes, handles, title=None):
    """A legend above the axes, where it can hide nothing."""
    longest = max(len(handle.get_label()) for handle in handles)
    columns = min(len(handles), 3 if longest < 14 else 2)
    axes.legend(handles=handles, title=title, loc="lower left", bbox_to_anchor=(0, 1), ncol=columns,
                borderaxespad=0.2, columnspacing=1.2, handletextpad=0.5, handlelength=1.8)


def draw_map(axes, record, values, colormap, norm):
    """Image of values on the nodes of a two-dimensional grid."""
    x, y = record.coordinates
    half = (x[1] - x[0]) / 2, (y[1] - y[0]) / 2
    extent = (x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1])
    return axes.imshow(values.T, origin="lower", extent=extent, cmap=colormap, norm=norm)


def draw_edge(axes, record, gap):
    """Line where the contact ends, if the scene says at which gap."""
    if np.min(gap) < record.contact_gap < np.max(gap):
        axes.contour(*record.coordinates, gap.T, levels=[record.contact_gap], colors="white",
                     linewidths=1.4)
        axes.contour(*record.coordinates, gap.T, levels=[record.contact_gap], colors="black",
                     linewidths=0.6)


def zoom(stack, x, gaps, tractions):
    """Limit profiles to the contact and its surroundings, and the gap to what matters there."""
    (window,), ceiling = contact_region((x,), gaps, tractions)
    stack[0].set_xlim(window)
    floor = min(map(np.min, gaps))
    stack[0].set_ylim(floor - 0.1 * (ceiling - floor), ceiling)


def pressure_colours(pressures):
    """Colour map and norm: compression red, attraction blue, each over its own range."""
    low, high = np.min(pressures), np.max(pressures)
    if low > -1e-3 * high:
        return "Reds", Normalize(0, high or 1)
    if high < -1e-3 * low:
        return "Blues_r", Normalize(low, 0)
    return "RdBu_r", TwoSlopeNorm(0, low, high)


def colours(count):
    """Colours of successive points, dark to light; readable in grey."""
    return matplotlib.colormaps["viridis"](np.linspace(0, 0.85, count))


# Data


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


def varies(values):
    """Whether values differ by more than rounding."""
    return np.ptp(values) > 1e-6 * np.max(np.abs(values))


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


def fields(record, chosen):
    """Gap and traction at the chosen points."""
    if not chosen:
        raise NothingToShow("no fields are stored (-archive_fields last or all keeps them)")
    if record.initial_gap is None:
        raise NothingToShow("the initial gap is not stored")
    return [(record.initial_gap + record.field("displacement", point)[0],
             record.field("traction", point)) for point in chosen]


def contact_region(coordinates, gaps, tractions):
    """Limits in each direction of where the law acts, with a margin, and a gap above which it does
    not."""
    peak = np.max(np.abs(tractions))
    acts = np.abs(tractions) > 1e-2 * peak if peak > 0 else np.ones(np.shape(gaps), bool)
    limits = []
    for axis, x in enumerate(coordinates, start=1):
        inside = x[np.any(acts, axis=tuple(other for other in range(acts.ndim) if other != axis))]
        margin = 0.2 * (inside[-1] - inside[0]) + 2 * (x[1] - x[0])
        limits.append((max(inside[0] - margin, x[0]), min(inside[-1] + margin, x[-1])))
    return limits, 1.5 * np.max(np.array(gaps)[acts])


# Words


def names(record, chosen):
    """What tells the chosen points apart: symbol of the first load that differs, and its values
    with the events."""
    columns = [*(f"tangential_displacement{axis}" for axis in directions(record)), "normal_force",
               "normal_displacement", *(f"tangential_force{axis}" for axis in directions(record))]
    name = next((name for name in columns if varies(record[name][chosen])), "normal_force")
    # not what is rounding
    loads = np.where(np.abs(record[name]) > 1e-9 * np.abs(record[name][chosen]).max(), record[name],
                     0.0)
    values = [(number(loads[point], 4), record["event"][point]) for point in chosen]
    texts = [value if event == "none" else f"{value}, {word(event)}" for value, event in values]
    return label("", word_and_symbol(name)[1], record.units[name]), texts


def number(value, digits):
    """A number with a typographic minus sign."""
    return f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def word(name):
    """An event or kind of fold in plain words."""
    return str(name).replace("_", " " if name == "gross_sliding" else "-")


SYMBOLS = {
    "normal_force": ("normal force", "W_n"),
    "approach": ("approach", r"\bar{d}"),
    "normal_displacement": ("normal displacement", "D"),
    "tangential_force": ("tangential force", "W_t"),
    "tangential_displacement": ("tangential displacement", "U_t"),
}


def column_label(record, name):
    """Label of a column: words, symbol and unit."""
    unit = record.units[name]
    if name == "contact_area":
        return label(*(("contact area", "A") if unit.endswith(("^2", "²"))
                       else ("contact length", "2a")), unit)
    return label(*word_and_symbol(name), unit)


def word_and_symbol(name):
    """Words and symbol of a column for a label."""
    axis = name[-2:] if name.endswith(("_x", "_y")) else ""
    words, symbol = SYMBOLS[name.removesuffix(axis)]
    return words, tangential(symbol[0], axis) if axis else symbol


def tangential(symbol, axis):
    """Symbol of a tangential quantity in a direction ('', '_x', '_y')."""
    return f"{symbol}_{{t{axis.replace('_', ',')}}}"


def label(words, symbol, unit, between=" "):
    """Label in a figure: words, and a symbol over its scale ($2a/\\beta$) or before its SI unit in
    brackets."""
    scale = re.sub(r"([a-zA-Z])_([a-zA-Z,]+)", r"\1_{\2}", unit)
    scale = re.sub(r"sqrt\((.*?)\)", r"\\sqrt{\1}", scale)
    scale = re.sub(r"\b(beta|phi|delta)", r"\\\1", scale)
    if not unit:
        text = f"${symbol}$"
    elif scale == unit:
        text = f"${symbol}$ ({unit})"
    else:
        if " " in scale:  # a long one: on a line of its own
            scale, between = "(" + scale.replace(" ", r"\,") + ")", "\n"
        text = f"${symbol} / {scale}$"
    return f"{words}{between if words else ''}{text}"
