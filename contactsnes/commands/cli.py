"""The commands run, plot, info and compare, their words and exit statuses. Only this room prints;
it decides nothing physical.

Exit status: 0 every leg done or a stop that was asked for reached, 1 a solve failed, no equilibrium
exists, or what was computed or told cannot be written, 2 bad input, 128 + the signal's number for
an interrupted command.
"""

import argparse
import dataclasses
import errno
import gc
import os
import signal
import sys
import traceback
from functools import partial

from .. import __version__
from ..branch.failures import uncomputable
from ..compare.methods import CompareOptions
from ..contact.balance import CONVERGENCE
from ..options.database import (
    database,
    database_text,
    petsc_arguments,
    read,
    unused_options,
)
from ..options.fields import InputError, nearest
from ..options.help import help_text
from ..output.files import ArchiveError, WriteError
from ..scene import settings as scenes
from ..scene.units import UNITS
from ..system.streams import Interrupts, standard_streams
from . import summary, surface
from .run import Run
from .session import (
    begin_petsc,
    create_branch,
    solver_options,
    start_comparison,
    start_petsc,
    versions,
)
from .speech import complain, told

HELP = """\
contactsnes: adhesive frictional contact of elastic bodies

  contactsnes run [FILE.opts or -option value] ...    solve a scene along its load path
  contactsnes info [FILE.opts or -option value] ...   what would be solved, without solving it
  contactsnes plot RUN.h5 ...                         figures of archives (contactsnes plot --help)
  contactsnes plot SCENE.opts [-option value] ...     the surface of a scene, before it is solved
  contactsnes compare SCENE.opts [METHOD.opts ...] [-option value] ...
                                                      methods on one scene: cost, accuracy, failures
  contactsnes run -help                               every option: meaning, unit, default, range
  contactsnes --version

Files are read from left to right, then the options of the command line; the later value
wins. For instance:
  contactsnes run options/cylinder.opts options/newton.opts -archive_file run.h5"""

def main(argv=None):
    """Run a command; return the exit status (module docstring)."""
    words = list(sys.argv[1:] if argv is None else argv)
    with standard_streams(), Interrupts() as interrupts:
        status = _ended(words, interrupts)
        sys.stdout.flush()
        if sys.stdout.left:
            return 128 + signal.SIGPIPE
        if sys.stdout.failure:
            complain("warning", "standard output cannot be written "
                     f"({sys.stdout.failure}): what should stand there is lost")
        return status


def _ended(words, interrupts):
    """Run a command to its end, whatever that is; return the exit status."""
    try:
        return _begun(words, interrupts)
    except (InputError, ArchiveError) as error:
        complain("error", error)
        return 1 if isinstance(error, WriteError) else 2
    except MemoryError as error:
        complain("error",
                 f"there is not enough memory for this scene ({error}): take fewer -scene_points")
    except OSError as error:
        complain("error", f"a file cannot be read or written: {error}")
        return 1
    except ArithmeticError as error:
        status, reason = uncomputable(error, database())
        complain("error", reason)
        return status
    except KeyboardInterrupt as interrupt:
        return 128 + (interrupt.args[0] if interrupt.args else signal.SIGINT)
    # a defect of ours: shown here, since a living traceback holds PETSc objects (see below)
    except Exception:
        traceback.print_exc()
        return 1
    finally:
        gc.collect()  # PETSc objects with Python contexts must not outlive PETSc
    return 2


def _begun(words, interrupts):
    """The exit status of a command, or of a word that is none."""
    command, arguments = (words[0], words[1:]) if words else ("", [])
    if command in ("-h", "-help", "--help", "help"):
        return told(HELP)
    if command == "--version":
        return told(f"contactsnes {__version__}")
    if command not in COMMANDS:
        return _no_command(command)
    return run(arguments, interrupts) if command == "run" else COMMANDS[command](arguments)


def _no_command(command):
    """Say what the commands are; exit status 2."""
    if not command:
        print(HELP, file=sys.stderr)
    else:
        guess = nearest(command, COMMANDS)
        complain("error", f"'{command}' is no command" + (f": did you mean {guess}?" if guess
                                                          else "; the commands are "
                                                          f"{', '.join(COMMANDS)}, for "
                                                          "instance: contactsnes run "
                                                          "FILE.opts"))
    return 2


# run


def run(arguments, interrupts):
    """``contactsnes run``: follow the load path, show and keep its points."""
    if _asks_for_help(arguments):
        return _help_on_options(arguments)
    task = Run(start_petsc(arguments), interrupts)
    status = task.follow()
    return status if task.archive else status or told()


def _words(arguments):
    """The options that arguments and their files stand for; none where a file cannot be read, which
    help does not need."""
    try:
        return petsc_arguments(arguments)
    except InputError:
        return []


def _asks_for_help(arguments):
    return any(argument in ("-h", "-help", "--help") for argument in arguments)


def _help_on_options(arguments, more=()):
    begin_petsc([])
    words = _words([argument for argument in arguments if not _asks_for_help([argument])])
    named = {name[1:].lower(): value for name, value in zip(words, words[1:])}
    scenes.Scene.prepare(lambda: named)
    return told(help_text((*solver_options(), *more), notes=[("Convergence", CONVERGENCE)],
                          units=UNITS))


# info


def info(arguments):
    """``contactsnes info``: what would be solved."""
    if _asks_for_help(arguments):
        return _help_on_options(arguments)
    settings = start_petsc(arguments, _advise)
    scene, load = settings.scene, settings.load
    legs = load.legs(scene.dimension) if load.path else ()
    # Without a path there is still a contact to tell of.
    still = dataclasses.replace(load, path="normal_force=hold" if scene.isolated
                                else "normal_displacement=hold")
    try:
        branch = create_branch(settings if legs else settings._replace(load=still,
                                                                       steps=scenes.Steps()))
    except InputError:
        _advise(settings)
        raise
    sections = {"Scene": summary.about_scene(settings),
                "Before solving": summary.advised(settings),
                "Load path": summary.about_path(settings, legs),
                "Unknowns": summary.about_unknowns(settings, branch),
                "Left out": summary.skipped(settings, branch),
                "Method": summary.about_method(settings),
                "Without effect": [f"-{name}: {why}"
                                   for name, why in scenes.ineffective(scene, load, database(),
                                                                       settings.form,
                                                                       settings.output,
                                                                       settings.estimates)],
                "All options": summary.all_options([*settings, *map(read, solver_options())])}
    _print(sections)
    for sentence in summary.resolution_warnings(settings):
        complain("warning", sentence)
    return told()


def _print(sections):
    """Print lines under their titles."""
    for title, lines in sections.items():
        if lines:
            print(title, *(f"  {line}" for line in lines), sep="\n", end="\n\n")


def _advise(settings):
    """Print what is known of a scene that is then refused."""
    _print({"Before solving": summary.advised(settings)})


# compare


def compare(arguments):
    """``contactsnes compare``: methods on one scene, measured on equal terms."""
    if _asks_for_help(arguments):
        return _help_on_options(arguments, (CompareOptions,))
    comparison, stem = start_comparison(arguments, partial(print, flush=True))
    # files are written: no backend has a say, and an unknown one would end the import
    os.environ.pop("MPLBACKEND", None)
    from ..compare import figure as comparison_figure
    from ..compare import table as comparison_table

    about = {"scene": str(comparison.branch.scene), "options": database_text(),
             "versions": str(versions())}
    comparison.run(lambda: comparison_table.save(comparison, stem, about))
    for name in unused_options(solver_options()):
        if name[1:] in comparison.given:
            complain("warning", f"{name} was never used: neither this program "
                     "nor any PETSc object in use asks for it")
    print("", *comparison_table.lines(comparison), sep="\n")
    figures = [comparison_figure.plot_comparison([f"{stem}.h5"],
                                                 f"{stem}.png")] if comparison.watched else []
    print(f"{stem}.csv", f"{stem}.h5", *figures, sep="\n", flush=True)
    return 0 if any(comparison.finished(method) for method in comparison.methods) else 1


# plot


def plot(arguments):
    """``contactsnes plot``: figures of archives, or of the surface of a scene."""
    if surface.of_scene(arguments):
        os.environ.pop("MPLBACKEND", None)
        return surface.plot_surface(arguments)
    parser = argparse.ArgumentParser(prog="contactsnes plot",
                                     description="Figures of archives, beside them.")
    parser.add_argument("archives", nargs="+", metavar="RUN.h5")
    parser.add_argument("--pdf", action="store_true", help="each figure as PDF, too")
    parser.add_argument("--output", metavar="FOLDER", help="folder of the figures")
    parser.add_argument("--points", metavar="0,5,-1", type=_numbers,
                        help="points of profiles and maps, from 0 or from the end")
    if "--points" in arguments[:-1]:
        # A list that begins with a negative number would be taken for an option.
        place = arguments.index("--points")
        arguments = [*arguments[:place], f"--points={arguments[place + 1]}", *arguments[place + 2:]]
    try:
        asked = parser.parse_args(arguments)
    except SystemExit as stop:
        return stop.code
    os.environ.pop("MPLBACKEND", None)  # as in a comparison
    from ..output.figures import plot as figures

    for path in asked.archives:
        try:
            drawn = figures.plot(path, asked.output, asked.pdf, asked.points)
        except OSError as error:
            kind = WriteError if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG,
                                                 errno.EIO) else InputError
            raise kind(f"the figures of {path} cannot be written: {error}") from None
        print(*drawn.files, *(f"no figure {name} of {path}: {why}"
                              for name, why in drawn.skipped.items()), sep="\n")
    return 0


def _numbers(text):
    """Whole numbers with commas."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is no list of whole numbers, for instance 0,5,-1") from None


COMMANDS = {"run": run, "plot": plot, "info": info, "compare": compare}
