"""The commands run, plot, info and compare, their words and exit statuses. The only module that prints; it decides nothing physical.

Exit status: 0 every leg done or a stop that was asked for reached, 1 a solve failed, no equilibrium exists, or what was
computed or told cannot be written, 2 bad input, 128 + the signal's number for an interrupted command.
"""

import argparse
import dataclasses
import errno
import gc
import os
import re
import signal
import sys
import traceback
from functools import partial

from . import __version__, observables, resuming, scene as scenes, summary
from .archive import Archive, ArchiveError, Column, WriteError
from .failures import uncomputable
from .grid_choice import reason
from .methods import CompareOptions
from .points import new_points, NoEquilibrium, NotConverged, TooCoarse, unfinished_fold
from .options import database, database_text, help_text, read, unused_options
from .progress import Progress
from .session import begin_petsc, create_branch, create_watch, solver_options, start_comparison, start_petsc, versions
from .settings import InputError, nearest
from .streams import Interrupts, standard_streams

HELP = """\
contactsnes: adhesive frictional contact of elastic bodies

  contactsnes run [FILE.opts or -option value] ...    solve a scene along its load path
  contactsnes info [FILE.opts or -option value] ...   what would be solved, without solving it
  contactsnes plot RUN.h5 ...                         figures of archives (contactsnes plot --help)
  contactsnes compare SCENE.opts [METHOD.opts ...] [-option value] ...
                                                      methods on one scene: cost, accuracy, failures
  contactsnes run -help                               every option with meaning, unit, default and range
  contactsnes --version

Files are read from left to right, then the options of the command line; the later value wins. For instance:
  contactsnes run options/cylinder.opts options/newton.opts -archive_file run.h5"""

BAD_OPTIONS = {56, 57, 62, 63, 65, 83, 86, 92, 95}
"""PETSc's error codes of what a user asked for: no support, wrong argument, missing file, unknown type, no factorisation."""


def main(argv=None):
    """Run a command; return the exit status (module docstring)."""
    words = list(sys.argv[1:] if argv is None else argv)
    with standard_streams(), Interrupts() as interrupts:
        status = _ended(words, interrupts)
        sys.stdout.flush()
        if sys.stdout.left:
            return 128 + signal.SIGPIPE
        if sys.stdout.failure:
            _complain("warning", f"standard output cannot be written ({sys.stdout.failure}): what should stand there is lost")
        return status


def _ended(words, interrupts):
    """Run a command to its end, whatever that is; return the exit status."""
    try:
        return _begun(words, interrupts)
    except (InputError, ArchiveError) as error:
        _complain("error", error)
        return 1 if isinstance(error, WriteError) else 2
    except MemoryError as error:
        _complain("error", f"there is not enough memory for this scene ({error}): take fewer -scene_points")
    except OSError as error:
        _complain("error", f"a file cannot be read or written: {error}")
        return 1
    except ArithmeticError as error:
        status, reason = uncomputable(error, database())
        _complain("error", reason)
        return status
    except KeyboardInterrupt as interrupt:
        return 128 + (interrupt.args[0] if interrupt.args else signal.SIGINT)
    except Exception:  # a defect of ours: shown here, since a living traceback holds PETSc objects (see below)
        traceback.print_exc()
        return 1
    finally:
        gc.collect()  # PETSc objects with Python contexts must not outlive PETSc
    return 2


def _begun(words, interrupts):
    """The exit status of a command, or of a word that is none."""
    command, arguments = (words[0], words[1:]) if words else ("", [])
    if command in ("-h", "-help", "--help", "help"):
        return _told(HELP)
    if command == "--version":
        return _told(f"contactsnes {__version__}")
    if command not in COMMANDS:
        return _no_command(command)
    return run(arguments, interrupts) if command == "run" else COMMANDS[command](arguments)


def _told(*lines):
    """Print what a command is for: exit status 1 where that cannot be written."""
    print(*lines, sep="\n", end="\n" if lines else "", flush=True)
    return int(bool(sys.stdout.failure))


def _no_command(command):
    """Say what the commands are; exit status 2."""
    if not command:
        print(HELP, file=sys.stderr)
    else:
        guess = nearest(command, COMMANDS)
        _complain("error", f"'{command}' is no command" + (f": did you mean {guess}?" if guess else
                  f"; the commands are {', '.join(COMMANDS)}, for instance: contactsnes run FILE.opts"))
    return 2


def _complain(kind, text):
    """A sentence on standard error: one line, whatever names it holds."""
    sys.stdout.flush()
    line = re.sub(r"[\x00-\x1f\x7f]", lambda match: ascii(match.group())[1:-1], str(text))
    print(f"contactsnes: {kind}: {line}", file=sys.stderr, flush=True)


# run


def run(arguments, interrupts):
    """``contactsnes run``: follow the load path, show and keep its points."""
    if _asks_for_help(arguments):
        return _help_on_options()
    task = Run(start_petsc(arguments), interrupts)
    status = task.follow()
    return status if task.archive else status or _told()


def _asks_for_help(arguments):
    return any(argument in ("-h", "-help", "--help") for argument in arguments)


def _help_on_options(more=()):
    begin_petsc([])
    return _told(help_text((*solver_options(), *more)))


class Run:
    """One run: branch, archive and progress, and what to say when it is over."""

    def __init__(self, settings, interrupts):
        self.settings, self.interrupts = settings, interrupts
        self._set_up()

    def _set_up(self, missed=()):
        """Begin the path on the grid of the settings, where coarser ones have ``missed`` their accuracy."""
        settings = self.settings
        self.table = observables.table(settings.scene)
        # What PETSc prints by itself would tear a bar to pieces.
        watched = any("monitor" in name or name.endswith("view") for name in database())
        self.progress = Progress(settings.scene, settings.load, partial(print, flush=True),
                                 live=sys.stdout.isatty() and sys.stderr.isatty() and not watched)
        self.branch = create_branch(settings, self.progress.log)
        self.warnings = summary.resolution_warnings(settings)
        self.watch = create_watch(settings, self.branch, self.progress, missed)
        self.table |= self.watch.columns if self.watch else {}
        self.archive, self.waiting, self.known = None, 0, 0
        if settings.output.file:
            self.archive = self._open_archive()
            self.known = self.archive.points

    def _open_archive(self):
        """The archive to append to, created or resumed; the branch gets the history it goes on from."""
        scene, output = self.settings.scene, self.settings.output
        content = {"scene": self.branch.attributes(), "options": database_text(), "versions": versions(),
                   "columns": {name: Column(row.unit, row.kind, row.names) for name, row in self.table.items()},
                   "fields": output.fields, "components": scene.components, "warnings": self.warnings}
        if output.fields != "none":
            content |= observables.frame(self.branch.contact) | {"modes": self.branch.steps.keeps_modes}
        if not output.resume:
            return Archive.create(output.file, overwrite=output.overwrite, **content)
        archive = Archive.resume(output.file, **content)
        if archive.complete:
            return archive
        history = [self.branch.restored(state) for state in archive.states()]
        self.waiting = 0 if self.settings.steps.at_fold == "trace" else unfinished_fold(history)
        self.branch.history = history[:len(history) - self.waiting]
        return archive

    def follow(self):
        """Follow the path to its end, and say how it went; return the exit status."""
        if self.archive and self.archive.complete:
            print(f"{self.archive.path} is complete with {self.known} points: there is nothing to do")
            return 0
        self._say_what_is_solved()
        if self.known:
            self.progress.log(f"going on after point {self.known} of {self.archive.path}")
            for change in resuming.changes(self.archive.runs[-1].options, database_text()):
                self.progress.log(f"from point {self.known + 1} on {change}")
        status, reason = self._points()
        for name in unused_options(solver_options()):
            _complain("warning", f"{name} was never used: neither this program nor any PETSc object in use asks for it")
        if status == 2 and self.archive and not self.archive.points:
            self.archive.path.unlink(missing_ok=True)  # an empty one would only be in the way of the next try
        if self.progress.points:
            print(self.progress.summary(self.known), *(self.watch.summary() if self.watch else ()), sep="\n", flush=True)
        if self.archive and self.archive.points:
            print(f"  archive       {self.archive.path}, {self.archive.points} points", flush=True)
        if reason:
            _complain("error", reason.rstrip(".") + self._way_on())
        return status

    def _points(self):
        """Take all points; exit status and, if it is not 0, the reason in words."""
        try:
            for point in new_points(self.branch, self.waiting):
                self._accept(point)
                if sys.stdout.left:
                    return 128 + signal.SIGPIPE, "nobody reads standard output any more" if self.archive else ""
                if self.interrupts.number:  # PETSc may swallow what is raised in some of its callbacks
                    raise KeyboardInterrupt(self.interrupts.number)
            if self.archive:
                self.archive.finish()
        except TooCoarse as found:
            coarse = found.with_traceback(None)  # a traceback would hold PETSc objects
        except (Exception, KeyboardInterrupt) as error:
            return self._verdict(error)
        else:
            return 0, ""
        finally:
            self.progress.close()
        return self._begin_anew(coarse)

    def _begin_anew(self, coarse):
        """The path from its beginning on a finer grid, in place of the points so far."""
        self.progress.log(f"{coarse}; the path begins anew with {reason(coarse.scene, self.settings.load)}")
        output = dataclasses.replace(self.settings.output, resume=False, overwrite=True)
        self.settings = self.settings._replace(scene=coarse.scene, output=output)
        self._set_up((*self.watch.missed, coarse))
        return self._points()

    def _verdict(self, error):
        """Exit status and reason of what ended the path early; what is neither solver nor user is raised again."""
        from petsc4py import PETSc

        if isinstance(error, PETSc.Error) and error.__cause__ is not None:
            error = error.__cause__  # newer petsc4py wraps what our callbacks raise
        early = self.progress.points == 0
        if isinstance(error, (NotConverged, NoEquilibrium, ArchiveError)):
            return 1, str(error)
        if isinstance(error, MemoryError):
            return 2 if early else 1, f"there is not enough memory ({error}): take fewer points of the grid"
        if isinstance(error, ArithmeticError):
            status, reason = uncomputable(error, database())
            return status if early else 1, reason
        if isinstance(error, KeyboardInterrupt):
            number = self.interrupts.number or signal.SIGINT
            return 128 + number, f"interrupted by {signal.Signals(number).name}"
        if isinstance(error, PETSc.Error):
            sentence = str(error).splitlines()[-1].removeprefix("[0] ").strip()
            return 2 if early and error.ierr in BAD_OPTIONS else 1, f"PETSc: {sentence} (error {error.ierr})"
        if isinstance(error, ImportError) and early:
            return 2, f"a Python class that an option names cannot be imported: {error}"
        raise error

    def _accept(self, point):
        """Keep and show a point."""
        measurement = observables.Measurement(self.branch.contact, point)
        row = self.watch.row(point) if self.watch else {}
        row |= {name: observable.function(measurement) for name, observable in self.table.items() if name not in row}
        if self.archive:
            fields = measurement.fields() if self.settings.output.fields != "none" else ()
            self.archive.append(row, self.branch.packed(point), *fields)
        self.progress.point(row, point.position)
        self.branch.corrector.account()  # what observing and keeping took is not the next point's

    def _say_what_is_solved(self):
        """Before the first solve: what has no effect, what is skipped, what to beware of."""
        scene, form, load, _, output = self.settings
        if self.settings.auto:
            self.progress.log(f"the grid: {reason(scene, load)}")
        for name, why in scenes.ineffective(scene, load, database(), form, output, self.settings.estimates):
            self.progress.log(f"-{name} has no effect: {why}")
        for sentence in summary.skipped(self.settings, self.branch):
            self.progress.log(sentence)
        for sentence in self.warnings:
            _complain("warning", sentence)

    def _way_on(self):
        """What became of the points of a path that was not followed to its end, in words."""
        if not (self.archive and self.archive.points):
            return ""
        points = f"{self.archive.points} points are" if self.archive.points > 1 else "1 point is"
        return f"; {points} in {self.archive.path}, -archive_resume goes on from there"


# info


def info(arguments):
    """``contactsnes info``: what would be solved."""
    if _asks_for_help(arguments):
        return _help_on_options()
    settings = start_petsc(arguments)
    scene, load = settings.scene, settings.load
    legs = load.legs(scene.dimension) if load.path else ()
    # Without a path there is still a contact to tell of.
    still = dataclasses.replace(load, path="normal_force=hold" if scene.isolated else "normal_displacement=hold")
    branch = create_branch(settings if legs else settings._replace(load=still, steps=scenes.Steps()))
    sections = {"Scene": summary.about_scene(settings), "Load path": summary.about_path(settings, legs),
                "Unknowns": summary.about_unknowns(settings, branch), "Left out": summary.skipped(settings, branch),
                "Method": summary.about_method(settings),
                "Without effect": [f"-{name}: {why}" for name, why in
                                   scenes.ineffective(scene, load, database(), settings.form, settings.output,
                                                      settings.estimates)],
                "All options": summary.all_options([*settings, *map(read, solver_options())])}
    for title, lines in sections.items():
        if lines:
            print(title, *(f"  {line}" for line in lines), sep="\n", end="\n\n")
    for sentence in summary.resolution_warnings(settings):
        _complain("warning", sentence)
    return _told()


# compare


def compare(arguments):
    """``contactsnes compare``: methods on one scene, measured on equal terms."""
    if _asks_for_help(arguments):
        return _help_on_options((CompareOptions,))
    comparison, stem = start_comparison(arguments, partial(print, flush=True))
    os.environ.pop("MPLBACKEND", None)  # files are written: no backend has a say, and an unknown one would end the import
    from . import comparison_figure, comparison_table

    about = {"scene": str(comparison.branch.scene), "options": database_text(), "versions": str(versions())}
    comparison.run(lambda: comparison_table.save(comparison, stem, about))
    for name in unused_options(solver_options()):
        if name[1:] in comparison.given:
            _complain("warning", f"{name} was never used: neither this program nor any PETSc object in use asks for it")
    print("", *comparison_table.lines(comparison), sep="\n")
    figures = [comparison_figure.plot_comparison([f"{stem}.h5"], f"{stem}.png")] if comparison.watched else []
    print(f"{stem}.csv", f"{stem}.h5", *figures, sep="\n", flush=True)
    return 0 if any(comparison.finished(method) for method in comparison.methods) else 1


# plot


def plot(arguments):
    """``contactsnes plot``: figures of archives."""
    parser = argparse.ArgumentParser(prog="contactsnes plot", description="Figures of archives, beside them.")
    parser.add_argument("archives", nargs="+", metavar="RUN.h5")
    parser.add_argument("--pdf", action="store_true", help="each figure as PDF, too")
    parser.add_argument("--output", metavar="FOLDER", help="folder of the figures")
    parser.add_argument("--points", metavar="0,5,-1", type=_numbers, help="points of profiles and maps, from 0 or from the end")
    if "--points" in arguments[:-1]:
        # A list that begins with a negative number would be taken for an option.
        place = arguments.index("--points")
        arguments = [*arguments[:place], f"--points={arguments[place + 1]}", *arguments[place + 2:]]
    try:
        asked = parser.parse_args(arguments)
    except SystemExit as stop:
        return stop.code
    os.environ.pop("MPLBACKEND", None)  # as in a comparison
    from . import plots

    for path in asked.archives:
        try:
            figures = plots.plot(path, asked.output, asked.pdf, asked.points)
        except OSError as error:
            kind = WriteError if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO) else InputError
            raise kind(f"the figures of {path} cannot be written: {error}") from None
        print(*figures.files, *(f"no figure {name} of {path}: {why}" for name, why in figures.skipped.items()), sep="\n")
    return 0


def _numbers(text):
    """Whole numbers with commas."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is no list of whole numbers, for instance 0,5,-1") from None


COMMANDS = {"run": run, "plot": plot, "info": info, "compare": compare}
