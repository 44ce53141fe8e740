"""Figures for print: as wide as a page, letters of 8 points, PNG of 200 dots an inch and PDF."""

import shutil
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from .style import STYLE, WIDTH

PAGE = 2 * WIDTH
"""Width of a page, inches."""
POINTS, DOTS = 8, 200
"""Height of letters, and dots an inch of the PNG."""
PRINTED = {**STYLE, "font.size": POINTS, "axes.labelsize": POINTS, "axes.titlesize": POINTS,
           "legend.fontsize": POINTS, "legend.title_fontsize": POINTS, "xtick.labelsize": POINTS,
           "ytick.labelsize": POINTS, "figure.titlesize": POINTS, "savefig.dpi": DOTS,
           "legend.handlelength": 1.4, "legend.handletextpad": 0.5, "legend.columnspacing": 0.9,
           "legend.labelspacing": 0.3, "legend.borderpad": 0.2, "legend.borderaxespad": 0.4,
           "axes.formatter.use_mathtext": False}
"""The package's style at the printed width; a figure is made and saved with it. Plain numbers at
ticks are not formulas: these take most of the time of drawing."""


def panels(rows, columns, width=PAGE, height=None):
    """(figure, axes) of rows and columns of panels.

    Parameters
    ----------
    rows, columns : int
    width, height : inches; a height of None makes panels a little broader than high
    """
    figure = Figure((width, height or 0.8 * rows * width / columns), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def lettered(axes, titles=()):
    """Give each panel its letter, and a title beside it."""
    for letter, one, title in zip("abcdefghijkl", axes, [*titles, *[""] * 12]):
        one.set_title(f"({letter})" + f"  {title}" * bool(title), loc="left")


def save(figure, path, copies=None):
    """Write a figure as PNG and as PDF of the same size; the path of the PNG.

    Parameters
    ----------
    figure : matplotlib Figure, laid out here; made with the style PRINTED
    path : path without, or with, the ending
    copies : another folder, for copies of both files, or None
    """
    with matplotlib.rc_context(PRINTED):
        # Laid out once, for the PNG; both files are of the same size.
        figure.set_dpi(DOTS)
        if figure.get_layout_engine() is not None:
            figure.get_layout_engine().execute(figure)
        figure.set_layout_engine(None)
        # The same figure is the same file: no date in it.
        for kind, how in ((".pdf", {"metadata": {"CreationDate": None}}), (".png", {"dpi": DOTS})):
            file = Path(path).parent / (Path(path).name.removesuffix(".png") + kind)
            figure.savefig(file, **how)
            if copies is not None and Path(copies) != file.parent:
                shutil.copyfile(file, Path(copies) / file.name)
    return file
