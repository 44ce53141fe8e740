"""PETSc started with the arguments of a command, and what its database asks for: settings, branch,
versions."""

import gc
import importlib
import os
import platform
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .. import __version__
from ..branch.grid_choice import TooLarge, chosen, on
from ..contact.balance import CONVERGENCE
from ..interface import shapes
from ..options.database import check_names, check_values, database, petsc_arguments, read
from ..options.fields import InputError
from ..options.files import entries, refuse_circles
from ..options.help import help_text
from ..options.solver_values import VIEWERS, refuse_unwritable
from ..options.words import asks_for_help
from ..scene import settings as scenes
from ..scene.load import Load
from ..scene.settings import OPTION_CLASSES
from ..scene.units import UNITS
from ..system.processes import world
from . import own_solvers
from .speech import told
from .starting import begin_petsc, refuse_differences, refuse_unshared


class Settings(NamedTuple):
    """All that options say about a run, in the order of `OPTION_CLASSES`."""

    scene: scenes.Scene
    form: scenes.Form
    load: Load
    steps: scenes.Steps
    output: scenes.Output

    @property
    def auto(self):
        """Whether the points of the grid were chosen, and have to prove themselves."""
        return database().get("scene_points") == "auto"

    @property
    def estimates(self):
        """Whether the errors of points are estimated."""
        return self.auto or self.output.errors


def solver_options():
    """Dataclasses of the options of our own PC and SNES types (they import PETSc)."""
    from ..branch.branch import SOLVER_OPTIONS

    return SOLVER_OPTIONS


def unread_options(branch, classes):
    """Names of PETSc's options that the solver of a branch does not ask for (it imports PETSc).

    Parameters
    ----------
    branch : Branch
    classes : dataclasses of options of our own types
    """
    from ..branch.unread import unread_options as unread

    return unread(branch, classes)


def settled():
    """Collect garbage from now on, where that has been left out since the program began, without a
    look at what is there."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def start_petsc(arguments, refused=lambda settings: None):
    """Initialise PETSc with the arguments of a command and read the settings from its database.

    ``refused`` is called with settings whose grid there is no memory for, before the InputError.
    """
    try:
        os.getcwd()
    except OSError as error:
        raise InputError(f"the working folder cannot be used ({error.strerror}): "
                         "change into one that exists") from None
    words = petsc_arguments(arguments)[1:]
    world.first(lambda: refuse_unwritable(entries(words)))  # some PETSc opens as it starts
    world.first(lambda: refuse_circles(os.environ.get("PETSC_OPTIONS", "")))
    begin_petsc(words)
    refuse_differences()
    check_solvers()
    scene, form, load, steps, output = [read(kind) for kind in OPTION_CLASSES]
    refuse_unshared(scene)
    scenes.check(scene, load, steps)
    settings = Settings(scene, form, load, steps, output)
    try:
        return settings._replace(scene=_with_points(settings))
    except TooLarge:
        refused(settings)
        raise


def _with_points(settings):
    """The scene with its points chosen where they are to be; a run that is resumed keeps those of
    its archive."""
    scene, output = settings.scene, settings.output
    if settings.auto and output.resume and Path(output.file).is_file():
        from ..output.reading import read as read_archive

        archive = read_archive(output.file)
        if archive.points and scene.isolated:
            return replace(scene, points=None,
                           spacing=(np.atleast_1d(archive.scene["spacing"])
                                    / scene.scale("beta")[0]).tolist())
        if archive.points and not shapes.of(scene).gridded:
            return on(scene, tuple(np.atleast_1d(archive.scene["points"]).tolist()))
    try:
        return chosen(scene, settings.load)
    except (OSError, ValueError) as error:
        raise error if isinstance(error, InputError) else InputError(str(error)) from None


def _words(arguments):
    """The options that arguments and their files stand for; none where a file cannot be read, which
    help does not need."""
    try:
        return petsc_arguments(arguments)
    except InputError:
        return []


def help_on_options(arguments, more=()):
    """Print every option, those of files of one's own that arguments name among them; the exit
    status.

    Parameters
    ----------
    arguments : list of str
    more : dataclasses of options besides those of a run
    """
    begin_petsc([])
    words = _words([argument for argument in arguments if not asks_for_help([argument])])
    named = {name[1:].lower(): value for name, value in zip(words, words[1:])}
    scenes.Scene.prepare(lambda: named)
    return told(help_text((*solver_options(), *more), notes=[("Convergence", CONVERGENCE)],
                          units=UNITS))


def check_solvers():
    """InputError for names, numbers, classes and types of solvers that the database holds and that
    do not exist or are not allowed."""
    check_names(solver_options())
    check_values(solver_options())
    _check_viewers()
    own_solvers.check()


def _check_viewers():
    """InputError for a file that PETSc is to write and cannot."""
    from petsc4py import PETSc

    try:
        world.first(lambda: refuse_unwritable(database()))
    except InputError:
        for name in filter(VIEWERS.search, database()):
            PETSc.Options().delValue(name)  # for some of them PETSc opens files when it ends
        raise


def create_branch(settings, log=lambda sentence: None):
    """The branch of the settings; InputError, too, where the geometry's file is at fault."""
    from ..branch.branch import Branch

    try:
        branch = Branch(settings.scene, settings.load, settings.steps, settings.form, log=log)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(str(error)) from None
    if "log_view" in database():
        from ..branch.timings import log_events

        log_events(branch.contact)
    return branch


def create_watch(settings, branch, progress, missed):
    """What estimates the errors of a run's points (``accuracy.Watch``); None where nobody asks for
    them.

    Parameters
    ----------
    settings : Settings
    branch : Branch of the scene
    progress : Progress, which is told
    missed : tuple, coarser grids that have missed the accuracy
    """
    if not settings.estimates:
        return None
    from ..branch.accuracy import Watch

    return Watch(branch, settings.auto, progress, missed)


def versions():
    """Program -> version of what a result depends on."""
    import petsc4py
    from petsc4py import PETSc

    packages = {name: importlib.import_module(name).__version__
                for name in ("numpy", "pyfftw", "h5py")}
    return {"contactsnes": __version__, "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
            "petsc4py": petsc4py.__version__, **packages, "python": platform.python_version()}
