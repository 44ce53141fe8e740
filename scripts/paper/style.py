"""What the figures of the paper have in common: sizes, colours, labels, and files."""

import shutil
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from contactsnes.output.figures.parts import pieces
from contactsnes.output.figures.style import STYLE

WIDE, NARROW = 17.0 / 2.54, 8.5 / 2.54
"""Width of a page and of a column, inches."""
AREA, FORCE = r"$a_r/\beta$", r"$w_t/w_{t,r}$"
GREY = "#808080"
SYMBOLS = {"residual": r"$\rho = \tau_\infty/\tau_{\max}$", "drive": r"$u_{app,t}/u_{t,r}$"}
LAW_NAMES = {"mcgarry": "McG, eq. 3", "full": r"eq. 5, $\tau_\infty = \tau_{\max}$",
             "half": r"eq. 5, $\tau_\infty = \tau_{\max}/2$"}


matplotlib.rcParams.update({**STYLE, "legend.fontsize": 8, "legend.title_fontsize": 8,
                            "xtick.labelsize": 8, "ytick.labelsize": 8,
                            "legend.handlelength": 1.4, "legend.handletextpad": 0.5,
                            "legend.columnspacing": 0.9, "legend.labelspacing": 0.3,
                            "legend.borderpad": 0.2, "legend.borderaxespad": 0.4})
"""Text of 8 points at the printed width."""


def panels(rows, columns, width=WIDE, height=None):
    """(figure, axes) of panels in the style of the package's figures."""
    figure = Figure((width, height or 0.8 * rows * width / columns), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def save(figure, name, folder, pages=None):
    """Write a figure for print, as PNG of 200 dots an inch and as PDF, to a folder, and copies to
    another one."""
    # Laid out once; both files are of the same size.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    # The same figure is the same file: no date in it.
    for kind, how in (("png", {"dpi": 200}), ("pdf", {"metadata": {"CreationDate": None}})):
        file = Path(folder) / f"{name}.{kind}"
        figure.savefig(file, **how)
        if pages is not None and Path(pages) != Path(folder):
            shutil.copyfile(file, Path(pages) / file.name)


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


def shades(count, name="viridis"):
    """Colours of a family of curves, dark to light."""
    return matplotlib.colormaps[name](np.linspace(0.0, 0.9, count))


def lettered(axes, titles=()):
    """Give each panel its letter, and a title beside it."""
    for letter, one, title in zip("abcdefghijkl", axes, [*titles, *[""] * 12]):
        one.set_title(f"({letter})" + f"  {title}" * bool(title), loc="left")
