"""The commands that show archives, without PETSc: plot, and how its like are asked."""

import errno
import os

from ..options.fields import InputError
from ..options.help import entries_of
from ..options.words import asks_for_help, read_words
from ..output.asked import PlotOptions
from ..output.files import WriteError
from .speech import told

PLOT = {"pdf": ("plot_format", "png,pdf"), "output": ("plot_output", None),
        "points": ("plot_points", None)}
"""Older and shorter names of options of plot."""


def usage(command, what, cls):
    """Help on a command that takes archives."""
    return "\n".join([f"usage: contactsnes {command}", "", what, "", *entries_of(cls)])


def asked_for(arguments, cls, text, others=None):
    """(paths of archives, options) of a command line, or (None, the exit status) where help was
    asked for.

    Parameters
    ----------
    arguments : list of str
    cls : dataclass of options
    text : str, the help
    others : mapping, as of `read_words`
    """
    if asks_for_help(arguments):
        return None, told(text)
    paths, asked = read_words(arguments, cls, others)
    if not paths:
        raise InputError(f"no archive is named; {text.splitlines()[0]}")
    return paths, asked


def writing(path, make):
    """What a function makes of an archive; WriteError or InputError where files cannot be
    written."""
    os.environ.pop("MPLBACKEND", None)  # files are written, no backend has a say
    try:
        return make()
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
        raise (WriteError if full else InputError)(
            f"what is made of {path} cannot be written: {error}") from None


def plot(arguments):
    """``contactsnes plot``: figures of archives."""
    text = usage("plot RUN.h5 ... [-plot_option value] ...",
                 "Figures of archives, beside them.", PlotOptions)
    paths, asked = asked_for(arguments, PlotOptions, text, PLOT)
    if paths is None:
        return asked

    def make():
        from ..output.figures.plot import draw

        groups = [asked.together] if asked.together else paths
        for name, drawn in zip(groups, draw(paths, asked)):
            told(*drawn.files, *(f"no figure {kind} of {name}: {why}"
                                 for kind, why in drawn.skipped.items()))

    writing(", ".join(paths), make)
    return told()
