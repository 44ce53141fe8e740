"""The style of figures, as wide as a column of a journal."""

import matplotlib
import numpy as np

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


def colours(count):
    """Colours of successive points, dark to light; readable in grey."""
    return matplotlib.colormaps["viridis"](np.linspace(0, 0.85, count))
