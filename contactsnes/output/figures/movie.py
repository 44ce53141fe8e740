"""Movies of archives: profiles or maps along the load path, with the place on a curve of loads."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import matplotlib
import matplotlib.ticker
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from ..files import ArchiveError, check_output, target_beside
from ..prefixes import read
from ..tables import replaced
from .data import (
    NothingToShow,
    along_load,
    contact_region,
    fields,
    free_of_rounding,
    inside,
    padded,
    shear,
)
from .encoding import ending, write_gif, write_mp4
from .maps import beyond, draw_edge, draw_map, edge, mark_bar, rows
from .parts import draw_branch
from .profiles import panels, zoom
from .style import STYLE, ZERO, settings
from .words import label, number, word, word_and_symbol

DOTS = 150
"""Dots per inch."""
SI = ("m", "N", "N/m")
"""Units of what stands above a picture, which may have a prefix."""
RATES = (2, 30)
"""Fewest and most pictures a second."""


class Scenes(NamedTuple):
    """A figure, what sets it to one of its points (function of a place in the list of points: the
    artists that move), the points, and the names of its maps of colours."""

    figure: Figure
    draw: object
    points: list
    colormaps: tuple = ()

    def pictures(self, places):
        """Iterate over pictures, arrays (height, width, 4), of places in the list of points: what
        stands still is drawn once."""
        self.figure.set_size_inches(*(2 * np.ceil(self.figure.get_size_inches() * DOTS / 2) / DOTS))
        self.figure.set_dpi(DOTS)
        canvas = FigureCanvasAgg(self.figure)
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")  # what was laid out stays where it is
        for artist in self.draw(0):
            artist.set_animated(True)
        canvas.draw()
        still = canvas.copy_from_bbox(self.figure.bbox)
        for place in places:
            canvas.restore_region(still)
            for artist in self.draw(place):
                artist.draw(canvas.get_renderer())
            yield np.array(canvas.buffer_rgba())


def write_movie(path, asked):
    """Write the movie of an archive; the path of the file.

    Parameters
    ----------
    path : path of the archive
    asked : MovieOptions

    Raises
    ------
    ArchiveError, InputError
        Where there are no fields, no folder for the file, or no ffmpeg for an MP4 that is asked
        for.
    """
    record = read(path)
    if not record.field_points or record.initial_gap is None:
        raise ArchiveError(f"{path} has no fields to show: run with -archive_fields all"
                           if record.points else f"{path} has no points to show yet.")
    kind = ending(asked)
    target = Path(asked.output) if asked.output else target_beside(path, f".{kind}")
    if target.suffix.lower() != f".{kind}":
        target = target.with_suffix(f".{kind}")  # by which Pillow and ffmpeg know what is wanted
    check_output(target)
    rate = _rate(record, asked)
    # Formulas take most of the time: numbers at axes are none.
    with matplotlib.rc_context({**settings(asked.style), "axes.formatter.use_mathtext": False}):
        write, scenes = write_mp4 if kind == "mp4" else write_gif, _scenes(record, asked)
        replaced(target, lambda path: write(path, rate, scenes))
    return target


def _points(record, most):
    """Points that are shown: all with fields, or some spread over them."""
    stored = record.field_points
    if len(stored) <= most:
        return list(stored)
    return [stored[place] for place in np.linspace(0, len(stored) - 1, most).astype(int)]


def _rate(record, asked):
    """Pictures a second."""
    rate = len(_points(record, asked.frames)) / asked.seconds
    return float(np.clip(rate, *RATES))


def _scenes(record, asked):
    """The figure of an archive, a line or a plane."""
    points = _points(record, asked.frames)
    make = _line if len(record.coordinates) == 1 else _plane
    return make(record, points, asked.width / 2.54)


def _curve(axes, record):
    """Draw the curve of loads; (x, y) of all its points."""
    try:
        axis = shear(record)[0]
        x, y = f"tangential_displacement{axis}", f"tangential_force{axis}"
    except NothingToShow:
        x, y = "approach", "normal_force"
    try:
        draw_branch(axes, record, x, y, slice(0, None))
    except NothingToShow:
        axes.plot(record[y], ".-")
        axes.set(xlabel="point", ylabel=y.replace("_", " "))
        return np.arange(record.points), record[y]
    return record[x], record[y]


def _title(record, point):
    """The point, its controlled loads and its event."""
    axis, *_ = along_load(record)
    shown = {name: free_of_rounding(record, name) for name in (
        "normal_force", f"tangential_force{axis}", "normal_displacement")}
    told = [f"${word_and_symbol(name)[1]}$ = {number(values[point], 4)}{_unit(record.units[name])}"
            for name, values in shown.items() if np.any(values) and np.isfinite(values[point])]
    event = record["event"][point]
    return f"point {point}:  " + ",  ".join(told) + (
        f"  ({word(event)})" if event != "none" else "")


def _unit(unit):
    """A unit of SI behind a number; others stand at the axes."""
    return f" {unit}" if unit in SI or unit[1:] in SI else ""


def _line(record, points, width):
    """Profiles below each other beside the curve of loads."""
    profiles = fields(record, points, "f4")
    gaps, tractions = ([pair[part] for pair in profiles] for part in (0, 1))
    shown = panels(record, gaps, tractions)
    figure = Figure((width, 0.62 * width), layout="constrained")
    grid = figure.add_gridspec(len(shown), 2, width_ratios=(1.7, 1))
    stack = [figure.add_subplot(grid[row, 0]) for row in range(len(shown))]
    x, curves = record.coordinates[0], []
    for axes, panel in zip(stack, shown):
        curves += axes.plot(x, panel.values[0], color="C0")
        axes.axhline(0, **ZERO)
        axes.set_ylim(padded(np.min(panel.values), np.max(panel.values), 0.06))
        axes.set_ylabel(label(panel.text, panel.symbol, panel.unit, "\n"))
        axes.tick_params(labelbottom=axes is stack[-1])
    zoom(stack, x, gaps, [traction[0] for traction in tractions])
    for axes in stack[1:]:
        axes.set_xlim(stack[0].get_xlim())
    stack[-1].set_xlabel(label("", "x", record.units["x"]))
    mark, along = _mark(figure.add_subplot(grid[:, 1]), record)

    def draw(place):
        for curve, panel in zip(curves, shown):
            curve.set_ydata(panel.values[place])
        return [*curves, *_place(figure, record, points[place], mark, along)]

    draw(0)
    return Scenes(figure, draw, points)


def _mark(axes, record):
    """A mark on the curve of loads that moves along it, and the places that it takes."""
    along = _curve(axes, record)
    (mark,) = axes.plot([], [], "o", markersize=9, markerfacecolor="none", markeredgewidth=1.6,
                        color="black", zorder=5)
    return mark, along


def _place(figure, record, point, mark, along):
    """Move the mark, and say where it is: a list of both.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    record : Readable
    point : int
    mark : line of matplotlib
    along : (x, y), arrays over all points
    """
    mark.set_data([along[0][point]], [along[1][point]])
    return [mark, figure.suptitle(_title(record, point), fontsize=STYLE["axes.titlesize"] + 1)]


def _seen(record, points):
    """What of a plane is to be seen: its window, coordinates, gaps and rows of maps there."""
    maps = fields(record, points, "f4")
    gaps, tractions = ([pair[part] for pair in maps] for part in (0, 1))
    window, ceiling = contact_region(record.coordinates, gaps, [each[0] for each in tractions])
    near = inside(record.coordinates, window)
    gaps, tractions = [gap[near] for gap in gaps], [each[(..., *near)] for each in tractions]
    return (window, [x[part] for x, part in zip(record.coordinates, near)], gaps,
            rows(record, gaps, tractions, ceiling))


def _plane(record, points, width):
    """Maps beside each other above the curve of loads."""
    window, coordinates, gaps, shown = _seen(record, points)
    figure = Figure((width, 0.72 * width), layout="constrained")
    grid = figure.add_gridspec(2, len(shown), height_ratios=(1.5, 1))
    stack = [figure.add_subplot(grid[0, column]) for column in range(len(shown))]
    images = []
    for axes, row in zip(stack, shown):
        images.append(draw_map(axes, coordinates, row.values[0], row.colormap, row.norm))
        axes.set(xlim=window[0], ylim=window[1], xlabel=label("", "x", record.units["x"]))
        axes.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5))
        bar = figure.colorbar(images[-1], ax=axes, location="top", aspect=25,
                              label=label(row.text, row.symbol, row.unit),
                              extend=beyond(row))
        if isinstance(row.norm, TwoSlopeNorm):
            mark_bar(bar, (row.norm.vmin, 0, row.norm.vmax))
        else:
            bar.locator = matplotlib.ticker.MaxNLocator(3, steps=[1, 2, 5, 10])
        # Outside of the map, which is drawn anew for each point.
        axes.tick_params(labelleft=axes is stack[0], direction="out", top=False, right=False)
    stack[0].set_ylabel(label("", "y", record.units["y"]))
    mark, along = _mark(figure.add_subplot(grid[1, :]), record)

    def draw(place):
        lines = edge(coordinates, gaps[place], record.contact_gap)
        for axes, image, row in zip(stack, images, shown):
            image.set_data(row.values[place].T)
            for former in [*axes.collections]:
                former.remove()
            draw_edge(axes, lines)
        parts = [part for axes in stack for part in (*axes.images, *axes.collections,
                                                     *axes.spines.values())]
        return [*parts, *_place(figure, record, points[place], mark, along)]

    draw(0)
    return Scenes(figure, draw, points, tuple(row.colormap for row in shown))
