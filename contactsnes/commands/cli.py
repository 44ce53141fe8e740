"""The commands, their words and exit statuses: run, info and compare here, those on archives in
`showing`. Only this room prints; it decides nothing physical.

Exit status: 0 every leg done or a stop that was asked for reached, 1 a solve failed, no equilibrium
exists, or what was computed or told cannot be written, 2 bad input, 128 + the signal's number for
an interrupted command.
"""

import dataclasses
import gc
import signal
import sys
from functools import partial

from .. import __version__
from ..branch.failures import uncomputable
from ..contact.balance import CONVERGENCE
from ..options.database import (
    database,
    database_text,
    petsc_arguments,
    read,
    unused_options,
)
from ..options.fields import InputError, meant
from ..options.help import help_text
from ..options.words import asks_for_help
from ..output.files import ArchiveError, WriteError
from ..scene import settings as scenes
from ..scene.units import UNITS
from ..system.processes import launched, world
from ..system.streams import Interrupts, standard_streams
from . import summary
from .cautions import cautions
from .own_solvers import blamed
from .run import Run
from .session import (
    create_branch,
    settled,
    solver_options,
    start_comparison,
    start_petsc,
    versions,
)
from .speech import complain, told
from .starting import assemble, begin_petsc

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
        return 128 + (interrupt.args[0] if interrupt.args else signal.SIGINT)
    # a defect of ours: shown here, since a living traceback holds PETSc objects (see below)
    except Exception:
        import traceback

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
        return _help_on_options(arguments)
    task = Run(start_petsc(arguments), interrupts)
    settled()
    status = task.follow()
    return status if task.archive else status or told()


def _words(arguments):
    """The options that arguments and their files stand for; none where a file cannot be read, which
    help does not need."""
    try:
        return petsc_arguments(arguments)
    except InputError:
        return []


def _help_on_options(arguments, more=()):
    begin_petsc([])
    words = _words([argument for argument in arguments if not asks_for_help([argument])])
    named = {name[1:].lower(): value for name, value in zip(words, words[1:])}
    scenes.Scene.prepare(lambda: named)
    return told(help_text((*solver_options(), *more), notes=[("Convergence", CONVERGENCE)],
                          units=UNITS))


# info


def info(arguments):
    """``contactsnes info``: what would be solved."""
    if asks_for_help(arguments):
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
    """Print what is known of a scene that is then refused."""
    _print({"Before solving": summary.advised(settings)})


# compare


def compare(arguments):
    """``contactsnes compare``: methods on one scene, measured on equal terms."""
    from ..compare.methods import CompareOptions

    if asks_for_help(arguments):
        return _help_on_options(arguments, (CompareOptions,))
    comparison, stem = start_comparison(arguments, partial(print, flush=True))
    from ..compare import table as comparison_table
    from .showing import Saved, writing

    def drawn():
        from ..compare.figure import plot_comparison  # and matplotlib, which others need not import

        return [plot_comparison([f"{stem}.h5"], f"{stem}.png")]

    about = {"scene": str(comparison.branch.scene), "options": database_text(),
             "versions": str(versions())}
    save = Saved(f"the comparison {stem}",
                 lambda: comparison_table.save(comparison, stem, about))
    try:
        comparison.run(save)
    except KeyboardInterrupt:
        if save.done:
            complain("error", f"interrupted: what was measured is in {stem}.csv and {stem}.h5, and "
                     "-compare_overwrite begins anew")
        raise
    for name in unused_options(solver_options()):
        if name[1:] in comparison.given:
            complain("warning", f"{name} was never used: neither this program "
                     "nor any PETSc object in use asks for it")
    print("", *comparison_table.lines(comparison), sep="\n")
    save.check()
    figures = writing(save.path, drawn) if comparison.watched else []
    print(f"{stem}.csv", f"{stem}.h5", *figures, sep="\n", flush=True)
    return 0 if any(comparison.finished(method) for method in comparison.methods) else 1


# commands on archives


def _shown(name):
    """A command of ``showing``, which is imported when it is wanted."""
    def command(arguments):
        from . import showing

        return getattr(showing, name)(arguments)

    return command


COMMANDS = {"run": run, "plot": _shown("plot"), "info": info, "compare": compare,
            **{name: _shown(name) for name in ("report", "movie", "table", "export")}}
