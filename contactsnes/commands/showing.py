"""The commands that show archives, without PETSc: plot, table, export, report, movie."""

import errno
import os
from pathlib import Path

from ..options.fields import InputError
from ..options.files import is_option
from ..options.help import entries_of
from ..options.words import asks_for_help, read_words
from ..output import tabular
from ..output.asked import (
    ExportOptions,
    MovieOptions,
    PlotOptions,
    ReportOptions,
    TableOptions,
)
from ..output.files import WriteError, is_archive, refuse_shared
from ..output.reading import NoColumn
from ..system.devices import reason
from .speech import complain, told

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
    if asked.output and is_archive(Path(asked.output), paths):
        raise InputError(f"{asked.option_name('output')} is '{asked.output}', an archive: name "
                         "another")
    return paths, asked


def writing(path, make):
    """What a function makes of an archive; WriteError or InputError where files cannot be written,
    or the archive has not what is shown."""
    os.environ.pop("MPLBACKEND", None)  # files are written, no backend has a say
    try:
        return make()
    except NoColumn as error:  # of an archive of another program's columns
        raise InputError(f"{error.args[0]}; what contactsnes run writes has all that are shown"
                         ) from None
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
        raise (WriteError if full else InputError)(
            f"what is made of {path} cannot be written: {_refused(error)}") from None


def _refused(error):
    """Why a file cannot be written, and which one, in words; what to do where that is known."""
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS) and error.filename:
        return (f"the folder {Path(error.filename).parent} takes no files from this user "
                f"({reason(error)}); name another with -output, figures with -plot_output")
    return f"{reason(error)}: {error.filename}" if error.filename else reason(error)


class Saved:
    """What is written again and again as more of it is known; where a disk does not take it, all
    goes on, for what is known is shown at the end.

    Parameters
    ----------
    path : str, what errors call it
    make : function without arguments that writes it

    Attributes
    ----------
    done : bool, whether there is something on the disk
    """

    def __init__(self, path, make):
        self.path, self._make = path, make
        self.done, self._lost = False, None

    def __call__(self):
        """Write it; the first time that fails is told."""
        try:
            writing(self.path, self._make)
        except (WriteError, InputError) as error:
            if self._lost is None:
                complain("warning", f"{error}: what is measured is shown at the end")
            self._lost = error
        else:
            self.done, self._lost = True, None

    def check(self):
        """WriteError or InputError if what is known last is not on the disk."""
        if self._lost is not None:
            raise self._lost


def plot(arguments):
    """``contactsnes plot``: figures of archives, or of the surface of a scene."""
    if any(word.endswith(".opts") or word.startswith("-scene_") for word in arguments):
        from .surface import plot_surface

        own, rest = _parted(arguments)
        _, asked = read_words(own, PlotOptions, PLOT)
        return writing("the surface", lambda: plot_surface(rest, asked))
    text = usage("plot RUN.h5 ... [-plot_option value] ...",
                 "Figures of archives, beside them.", PlotOptions)
    paths, asked = asked_for(arguments, PlotOptions, text, PLOT)
    if paths is None:
        return asked

    def make():
        from ..output.figures.plot import draw

        groups = [asked.together] if asked.together else paths
        # drawn first: after the last of them measured points are told that no figure has shown
        for drawn, name in zip(draw(paths, asked), groups):
            told(*drawn.files, *(f"no figure {kind} of {name}: {why}"
                                 for kind, why in drawn.skipped.items()))

    writing(", ".join(paths), make)
    return told()


def _parted(arguments):
    """Words of a command line: those of options of plot with their values, and the others."""
    own, rest, into = [], [], None
    for word in arguments:
        if is_option(word):
            name = word.lstrip("-").partition("=")[0].lower()
            into = own if name in PLOT or name.startswith(PlotOptions.prefix) else rest
        elif word.endswith(".opts"):
            into = rest
        (rest if into is None else into).append(word)
    return own, rest


def table(arguments):
    """``contactsnes table``: numbers of archives."""
    text = usage("table RUN.h5 ... [-option value] ...",
                 "Numbers of archives as one table, a row a point or a run.", TableOptions)
    paths, asked = asked_for(arguments, TableOptions, text)
    if paths is None:
        return asked
    found = tabular.tabulate(paths, asked)
    for note in found.notes:
        complain("warning", note)
    written = writing(", ".join(paths), lambda: tabular.write_table(paths, found, asked))
    status = told(written or tabular.as_csv(found, asked.units).rstrip("\n"))
    for why in found.unread:
        complain("error", why)
    return 2 if found.unread else status


def export(arguments):
    """``contactsnes export``: fields of archives for ParaView."""
    def write(path, asked):
        from ..output.vtk import write_vtk

        return write_vtk(path, asked)

    return _each(arguments, "export", "Fields of archives in files of VTK (VTKHDF), which ParaView "
                 "opens.", ExportOptions, write)


def report(arguments):
    """``contactsnes report``: a page on an archive."""
    def write(path, asked):
        from ..output.report.page import write_report

        return write_report(path, asked)

    return _each(arguments, "report", "Curves, fields, events and certificates of archives as "
                 "pages of HTML, which need nothing else; made by plotly, of the extra [report].",
                 ReportOptions, write)


def movie(arguments):
    """``contactsnes movie``: an archive in motion."""
    def write(path, asked):
        from ..output.figures.movie import write_movie

        return write_movie(path, asked)

    return _each(arguments, "movie", "Profiles or maps of archives along their load paths.",
                 MovieOptions, write)


def _each(arguments, command, what, cls, write):
    """A command that makes one file of each archive.

    Parameters
    ----------
    arguments : list of str
    command, what : str, its name, and what it is for
    cls : dataclass of its options
    write : function (path, options) -> path of the file
    """
    text = usage(f"{command} RUN.h5 ... [-option value] ...", what, cls)
    paths, asked = asked_for(arguments, cls, text)
    if paths is None:
        return asked
    _one_output(paths, asked)
    for path in paths:
        told(writing(path, lambda: write(path, asked)))
    return told()


def _one_output(paths, asked):
    """InputError where several archives would be shown in one file."""
    if len(paths) > 1 and asked.output:
        raise InputError(f"-output is '{asked.output}', but {len(paths)} archives are named: leave "
                         "it out, or show them one by one")
    refuse_shared(paths, "", "files", "show them one by one, with -output")
