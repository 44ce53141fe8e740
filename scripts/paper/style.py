"""What the figures of the paper have in common: sizes, colours, labels, and files."""

from pathlib import Path

import matplotlib
import numpy as np

from contactsnes.output.figures import printed
from contactsnes.output.figures.parts import pieces
from contactsnes.output.figures.printed import PAGE as WIDE
from contactsnes.output.figures.printed import PRINTED, lettered, panels  # noqa: F401

NARROW = 0.5 * WIDE
"""Width of a column, inches; WIDE is that of a page."""
AREA, FORCE = r"$a_r/\beta$", r"$w_t/w_{t,r}$"
GREY = "#808080"
SYMBOLS = {"residual": r"$\rho = \tau_\infty/\tau_{\max}$", "drive": r"$u_{app,t}/u_{t,r}$"}
LAW_NAMES = {"mcgarry": "McG, eq. 3", "full": r"eq. 5, $\tau_\infty = \tau_{\max}$",
             "half": r"eq. 5, $\tau_\infty = \tau_{\max}/2$"}


matplotlib.rcParams.update(PRINTED)


def save(figure, name, folder, pages=None):
    """Write a figure for print to a folder, and copies to another one."""
    printed.save(figure, Path(folder) / name, pages)


def branch(axes, record, x, y, part=slice(None), **look):
    """Curve of one column over another: jumps dashed and thin."""
    horizontal, vertical = record[x][part], record[y][part]
    for piece in pieces(record["event"][part]):
        line, = axes.plot(horizontal[piece], vertical[piece], **look)
        if piece[0] > 0:
            jump = slice(piece[0] - 1, piece[0] + 1)
            axes.plot(horizontal[jump], vertical[jump], color=line.get_color(), linestyle=":",
                      linewidth=0.7)
        look = {**look, "color": line.get_color(), "label": None}


def key(axes, label, look="k-", **more):
    """An entry of a legend for what is drawn in several colours, or by other means."""
    axes.plot([], [], look, **{"linewidth": 0.8, "markersize": 4, **more}, label=label)


ONSET = ("onset", "k*", {"markerfacecolor": "w", "markeredgewidth": 0.5, "markersize": 6})
JUMP = ("jump", "k:", {"linewidth": 0.7})
"""Entries of stars at onsets and of the dotted lines of `branch`."""


def event_keys(axes):
    """Entries of a legend for onsets and jumps."""
    for label, look, more in (ONSET, JUMP):
        key(axes, label, look, **more)


def below(figure, handles, share, columns):
    """A legend below all panels of a figure, in a share of its height."""
    figure.legend(handles=handles, loc="lower center", ncols=columns)
    figure.get_layout_engine().set(rect=(0, share, 1, 1 - share))


def shades(count, name="viridis"):
    """Colours of a family of curves, dark to light."""
    return matplotlib.colormaps[name](np.linspace(0.0, 0.9, count))
