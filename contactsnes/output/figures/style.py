"""The style of figures, as wide as a column of a journal."""

import io

import matplotlib
import matplotlib.style
import numpy as np
from cycler import cycler
from matplotlib.ticker import ScalarFormatter

from ...options.fields import InputError, meant
from ..tables import replaced

WIDTH = 8.5 / 2.54  # inches
STYLE = {"font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "legend.fontsize": 8,
         "xtick.labelsize": 8, "ytick.labelsize": 8, "axes.linewidth": 0.6, "lines.linewidth": 1.2,
         "lines.markersize": 5, "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True,
         "ytick.right": True, "legend.frameon": False, "savefig.dpi": 300,
         "mathtext.fontset": "dejavusans", "axes.formatter.use_mathtext": True,
         "axes.formatter.useoffset": False, "pdf.fonttype": 42, "svg.fonttype": "none",
         "axes.prop_cycle": cycler(color=["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00",
                                          "#56B4E9", "#000000"]),}
LETTERS = ("labelsize", "titlesize", "fontsize")
"""How settings end that are sizes of letters, besides font.size."""
# Okabe and Ito's colours, which the colour-blind can tell apart; the markers do without colour.
BLUE, VERMILION, GREY = "C0", "#D55E00", "#555555"
"""Colours; the first is that of the style."""
EVENTS = {"fold": VERMILION, "jump": "#E69F00", "gross_sliding": "#009E73", "pull_off": "#CC79A7",
          "bifurcation": "black"}
"""Event -> its colour, in figures and reports."""
FILLED = dict(markeredgecolor="white", markeredgewidth=0.4)
MARKS = {
    "start": dict(marker="o", markersize=4, color=BLUE, **FILLED),
    "fold": dict(marker="v", markersize=6, color=EVENTS["fold"], **FILLED),
    # open: others may sit in it
    "jump": dict(marker="s", markersize=7, color="none", markeredgecolor=EVENTS["jump"]),
    "gross_sliding": dict(marker="*", markersize=7, color=EVENTS["gross_sliding"], **FILLED),
    "pull_off": dict(marker="X", markersize=5, color=EVENTS["pull_off"], **FILLED),
    "bifurcation": dict(marker="D", markersize=5, color=EVENTS["bifurcation"], **FILLED),
}
DASHED = dict(linestyle="--", linewidth=0.7)  # jumps
ZERO = dict(color=GREY, linewidth=0.4, zorder=0)


def settings(style=""):
    """What matplotlib is to be set to: our style and, over it, one by name or file; InputError for
    one that there is not."""
    if not style:
        return STYLE
    if style in matplotlib.style.library:
        # made for large figures: their sizes of letters do not fit into a column
        sizes = {name: value for name, value in STYLE.items() if name.endswith("size")}
        return {**STYLE, **matplotlib.style.library[style], **sizes}
    try:
        own = matplotlib.rc_params_from_file(style, use_default_template=False)
        # where a file names one size of letters, it is that of labels, ticks, titles, legends
        sizes = {name: own["font.size"] for name in STYLE
                 if name.endswith(LETTERS) and "font.size" in own}
        return {**STYLE, **sizes, **own}
    except (OSError, UnicodeError):
        known = sorted(matplotlib.style.library)
        raise InputError(f"the style '{style}' is neither a file nor one of matplotlib's, "
                         f"{', '.join(known)}" + meant(style, known)) from None


def sized(figure, size):
    """The figure with a width, or a width and a height, in cm; as it is for None."""
    if size is not None:
        width, *height = np.atleast_1d(size) / 2.54
        old_width, old_height = figure.get_size_inches()
        figure.set_size_inches(width, height[0] if height else old_height * width / old_width)
    return figure


class Plain(ScalarFormatter):
    """Numbers at ticks as text. Set as mathematics they look the same, and take a third of the time
    of a figure; a power of ten that they have in common is no number at a tick."""

    def __call__(self, x, pos=None):
        return super().__call__(x, pos).removeprefix(r"$\mathdefault{").removesuffix("}$")


def saved(figure, path):
    """Write a figure to a path, which tells its kind. It is made in memory first: where a disk is
    full, matplotlib's PDF fails in ways that say nothing of it."""
    if not matplotlib.rcParams["text.usetex"]:  # all of its text is TeX
        for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(Plain())
    made = io.BytesIO()
    figure.savefig(made, format=path.suffix[1:])
    replaced(path, lambda partial: partial.write_bytes(made.getbuffer()))


def colours(count):
    """Colours of successive points, dark to light; readable in grey."""
    return matplotlib.colormaps["viridis"](np.linspace(0, 0.85, count))
