"""Figure of a comparison of methods: how fast the imbalance falls in some solves, in transforms and
in time."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatter, LogLocator

from ..output.figures.printed import PAGE, PRINTED
from ..output.figures.style import saved
from ..output.tables import read_hdf5

PANEL = 3.3 / 2.54
"""Height of a row of panels, inches: with six rows a page of a journal."""
COLUMNS = 4
"""Columns of the legend, at most: long names leave room for fewer."""
BLANK = Line2D([], [], linestyle="none", label=" ")

HUES = {"Newton": "Blues", "Newton after relaxation": "Purples", "multigrid": "Greys",
        "compositions": "cool_r", "nonlinear Krylov": "Greens", "quasi-Newton": "YlOrBr",
        "others": "cool", "dynamic relaxation": "Reds"}
"""Family -> colours of its methods, dark to light; kinds of lines tell them apart, too."""
LINES = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (1, 3)))


def plot_comparison(paths, output, shown=None):
    """Draw the histories of comparisons, a row of panels for each solve that was watched; the path
    of the figure.

    One curve a method: the smallest residual norm so far against transforms (left) and time
    (right); a cross ends the curve of a solve that failed or found another branch.

    Parameters
    ----------
    paths : paths of comparisons' HDF5 files
    output : path of the figure
    shown : names of the methods that are drawn, all by default
    """
    records = []
    for path in paths:
        attributes, record = read_hdf5(path)
        records.append({**record, "name": attributes["name"]})
    rows = [(record, place) for record in records for place in sorted(record["histories"], key=int)]
    styles = _styles(records, shown)
    with matplotlib.rc_context(PRINTED):
        below = 0.25 + 0.17 * _tall(styles)
        figure = Figure((PAGE, len(rows) * PANEL + below), layout="constrained")
        above, foot = figure.subfigures(2, 1, height_ratios=(len(rows) * PANEL, below))
        panels = above.subplots(len(rows), 2, squeeze=False, sharey="row")
        for number, (line, (record, place)) in enumerate(zip(panels, rows)):
            _draw_row(line, record, place, styles)
            # One letter a row: its title takes the width of both panels.
            line[0].set_title(f"({chr(ord('a') + number % 26)})  {line[0].get_title('left')}",
                              loc="left")
        panels[-1][0].set_xlabel("transforms of the cell")
        panels[-1][1].set_xlabel("time (ms)")
        _legend(foot, styles)
        saved(figure, Path(output))
    return Path(output)


def _styles(records, shown):
    """Name -> (family, look of the curve) of the methods that are drawn, in the order of
    families."""
    families = defaultdict(list)
    for record in records:
        for name, family in zip(record["methods"]["name"], record["methods"]["family"]):
            if name not in families[family] and (shown is None or name in shown):
                families[family].append(name)
    styles = {}
    for family in sorted(families, key=[*HUES, *families].index):
        names = families[family]
        hue = HUES.get(family, HUES["others"])
        shades = matplotlib.colormaps[hue](np.linspace(0.95, 0.45, len(names)))
        for number, (name, shade) in enumerate(zip(names, shades)):
            styles[name] = family, dict(color=shade, linestyle=LINES[number % len(LINES)],
                                        linewidth=2.0 if name == "newton" else 1.1,
                                        # on the thick one the others are seen
                                        zorder=3 if name == "newton" else 4)
    return styles


def _draw_row(panels, record, place, styles):
    """One solve: residual norm against transforms and time."""
    histories, names = record["histories"][place], list(record["methods"]["name"])
    outcomes = record["results"]["outcome"][:, int(place)]
    for number, name in enumerate(names):
        if name not in styles or str(number) not in histories or not len(histories[str(number)]):
            continue
        transforms, seconds, norms = histories[str(number)].T
        # What a solve costs before its first evaluation ends is the first point's place; zero has
        # none on this axis.
        for axes, costs in zip(panels, (np.maximum(transforms, 1.0),
                                        np.maximum(1e3 * seconds, 1e-3))):
            axes.plot(costs, np.fmin.accumulate(norms), **styles[name][1])
            if outcomes[number] != "converged":
                axes.plot(costs[-1], np.nanmin(norms), "x", color=styles[name][1]["color"],
                          markersize=5, zorder=5)
    for axes in panels:
        axes.set(xscale="log", yscale="log")
        axes.grid(True, which="major", linewidth=0.3, color="0.88")
        # within one power of ten there may be none to stand at a tick
        axes.xaxis.set_minor_formatter(LogFormatter(minor_thresholds=(1, 0.5)))
        axes.yaxis.set_major_locator(LogLocator(numticks=8))
    drawn = [histories[str(number)] for number, name in enumerate(names) if name in styles
             and str(number) in histories]
    first = max((history[0, 2] for history in drawn if len(history)), default=1.0)
    panels[0].set_ylim(1e-10, 10.0 * first if np.isfinite(first) else 1e3)
    panels[0].set_ylabel("residual norm")
    panels[0].set_title(f"{record['name']}: {str(histories['title']).replace('_', ' ')}",
                        loc="left")


def _legend(figure, styles):
    """Legend with a heading for each family, which does not stand last in a column."""
    tall = _tall(styles)
    entries = []
    previous = None
    for name, (family, look) in styles.items():
        if family != previous:
            entries += [BLANK] * (len(entries) % tall == tall - 1)
            entries.append(Line2D([], [], linestyle="none", label=family))
        entries.append(Line2D([], [], **look, label=name))
        previous = family
    entries += [BLANK] * (-len(entries) % tall)
    legend = figure.legend(handles=entries, loc="upper center", ncols=len(entries) // tall,
                           handlelength=2.6, columnspacing=1.5)
    for text in legend.get_texts():
        text.set_fontweight("bold" if text.get_text() in HUES else "normal")


def _tall(styles):
    """Rows of the legend."""
    families = len({family for family, _ in styles.values()})
    em = PRINTED["legend.fontsize"] / 72
    # A character is about half as wide as it is tall; line and blanks of an entry take the rest.
    columns = min(COLUMNS, int(PAGE / ((0.55 * max(map(len, styles)) + 4.9) * em)))
    return max(3, -(-(len(styles) + 2 * families) // columns))
