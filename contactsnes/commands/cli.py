"""The commands, their words and exit statuses: run and info here, compare in `comparing`, those on
archives in `showing`. Only this room prints; it decides nothing physical.

Exit status: 0 every leg done or a stop that was asked for reached, 1 a solve failed, no equilibrium
exists, or what was computed or told cannot be written, 2 bad input, 128 + the signal's number for
an interrupted command.
"""

import dataclasses
import gc
import importlib
import os
import signal
import sys

from .. import __version__
from ..branch.failures import uncomputable
from ..branch.grid_choice import TooLarge
from ..options.database import database, read
from ..options.fields import InputError, meant
from ..options.words import asks_for_help
from ..output.files import ArchiveError, WriteError
from ..scene import settings as scenes
from ..system.misfits import misfit
from ..system.processes import launched, world
from ..system.streams import Interrupts, standard_streams
from . import summary
from .cautions import cautions
from .own_solvers import blamed
from .run import Run
from .session import create_branch, help_on_options, settled, solver_options, start_petsc
from .speech import complain, interrupted, told
from .starting import assemble

HELP = """\
contactsnes: adhesive frictional contact of elastic bodies

  contactsnes run [FILE.opts or -option value] ...    solve a scene along its load path
  contactsnes info [FILE.opts or -option value] ...   what would be solved, without solving it
  contactsnes plot RUN.h5 ...                         figures of archives
  contactsnes plot SCENE.opts [-option value] ...     the surface of a scene, before it is solved
  contactsnes report RUN.h5 ...                       curves, fields and certificates as a page
  contactsnes movie RUN.h5 ...                        profiles or maps along the load path
  contactsnes table RUN.h5 ...                        numbers of archives: CSV, Parquet
  contactsnes export RUN.h5 ...                       fields for ParaView
  contactsnes compare SCENE.opts [METHOD.opts ...] [-option value] ...
                                                      methods on one scene: cost, accuracy, failures
  contactsnes run -help                               every option: meaning, unit, default, range
  contactsnes plot -help                              options of plot; as of the four below it
  contactsnes --version

Files are read from left to right, then the options of the command line; the later value
wins. For instance:
  contactsnes run options/cylinder.opts options/newton.opts -archive_file run.h5"""


def main(argv=None):
    """Run a command; return the exit status (module docstring)."""
    words = list(sys.argv[1:] if argv is None else argv)
    if os.path.expanduser("~") == "~":  # Matplotlib does not start without a folder of the user
        os.environ["HOME"] = "/"
    interrupts = Interrupts()
    try:
        with standard_streams(), interrupts:
            status = _written(world.over(_ended(words, interrupts)))
    except KeyboardInterrupt:  # of a command that has not begun, or has come to its end
        pass
    return 128 + interrupts.number if interrupts.number else status


def _written(status):
    """The exit status of a command whose last words are written, if they can be."""
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
        return _answered(words, interrupts)
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
        return interrupted(interrupt)
    except Exception as error:
        if why := misfit(error):
            complain("error", why)
            return 2
        import traceback

        # a defect of ours: shown here, since a living traceback holds PETSc objects (see below)
        traceback.print_exc()
        return 1
    finally:
        gc.collect()  # PETSc objects with Python contexts must not outlive PETSc
    return 2


def _answered(words, interrupts):
    """The exit status of a command; InputError for what fails in a file of one's own."""
    try:
        return _begun(words, interrupts)
    except (InputError, ArchiveError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        reason = blamed(error)
        if not reason:
            raise
    raise InputError(reason)


def _begun(words, interrupts):
    """The exit status of a command, or of a word that is none."""
    command, arguments = (words[0], words[1:]) if words else ("", [])
    if command not in COMMANDS and launched()[1]:
        return 0  # the first one speaks; another status would have it ended before
    if command in ("-h", "-help", "--help", "help"):
        return told(HELP)
    if command == "--version":
        return told(f"contactsnes {__version__}")
    if command not in COMMANDS:
        return _no_command(command)
    assemble(command, arguments)
    if command == "run":
        return run(arguments, interrupts)
    settled()
    return COMMANDS[command](arguments)


def _no_command(command):
    """Say what the commands are; exit status 2."""
    if not command:
        print(HELP, file=sys.stderr)
    else:
        commands = (f"; the commands are {', '.join(COMMANDS)}, for instance: contactsnes run "
                    "FILE.opts")
        complain("error", f"'{command}' is no command" + meant(command, COMMANDS, commands))
    return 2


# run


def run(arguments, interrupts):
    """``contactsnes run``: follow the load path, show and keep its points."""
    if asks_for_help(arguments):
        return help_on_options(arguments)
    task = Run(start_petsc(arguments), interrupts)
    settled()
    status = task.follow()
    return status if task.archive else status or told()


# info


def info(arguments):
    """``contactsnes info``: what would be solved."""
    if asks_for_help(arguments):
        return help_on_options(arguments)
    settings = start_petsc(arguments, _advise)
    scene, load = settings.scene, settings.load
    legs = load.legs(scene.dimension) if load.path else ()
    # Without a path there is still a contact to tell of.
    still = dataclasses.replace(load, path="normal_force=hold" if scene.isolated
                                else "normal_displacement=hold")
    try:
        branch = create_branch(settings if legs else settings._replace(load=still,
                                                                       steps=scenes.Steps()))
    except TooLarge:
        _advise(settings)
        raise
    sections = {"Scene": summary.about_scene(settings),
                "Before solving": summary.advised(settings),
                "Load path": summary.about_path(settings, legs),
                "Unknowns": summary.about_unknowns(settings, branch),
                "Left out": summary.skipped(settings, branch),
                "Method": [*summary.about_method(settings), summary.about_kernels(branch.contact)],
                "Without effect": [f"-{name}: {why}"
                                   for name, why in scenes.ineffective(scene, load, database(),
                                                                       settings.form,
                                                                       settings.output,
                                                                       settings.estimates)],
                "Options": summary.options_in_use([*settings, *map(read, solver_options())])}
    _print(sections)
    for sentence in cautions(settings, branch.contact):
        complain("warning", sentence)
    return told()


def _print(sections):
    """Print lines under their titles."""
    for title, lines in sections.items():
        if lines:
            print(title, *(f"  {line}" for line in lines), sep="\n", end="\n\n")


def _advise(settings):
    """Print what is known of a scene whose grid is then refused."""
    _print({"Before solving": summary.advised(settings)})


# the others


def _of(module, name):
    """A command of a module, which is imported when it is wanted."""
    def command(arguments):
        return getattr(importlib.import_module(f".{module}", __package__), name)(arguments)

    return command


COMMANDS = {"run": run, "plot": _of("showing", "plot"), "info": info,
            "compare": _of("comparing", "compare"),
            **{name: _of("showing", name) for name in ("report", "movie", "table", "export")}}
