"""How a command begins: MPI where a launcher has started several processes, PETSc, and what several
processes cannot do together."""

import os
import sys

from .. import __version__
from ..options.database import BEGINNING, database, install
from ..options.fields import InputError
from ..options.files import entries
from ..options.words import asks_for_help
from ..system.devices import checksum
from ..system.processes import difference, launched, missing, overlooked, world
from ..system.streams import Waiting
from .speech import complain

SHARED = ("run", "info")
"""Commands that several processes can do together."""

AT_START = ("log_", "malloc", "info", "fp_trap", "on_error_", "start_in_debugger")
"""How names of PETSc's options begin that it looks at as it starts."""

_OTHERS = {}


def assemble(command, words):
    """Be one of the processes that a launcher has started for a command with some words; InputError
    where they cannot do it together."""
    size, rank = launched()
    if size == 1:
        return
    if missing():
        _refuse(size, rank, "to share out a scene takes mpi4py (scripts/setup --mpi), and "
                "without it it is solved by one: start contactsnes without mpirun "
                "or srun, or with -n 1")
    with Waiting():  # the others would wait for one that ends between
        world.join()
    if world.size != size:
        _refuse(size, rank, f"MPI knows of {world.size}: mpi4py belongs to another MPI than the "
                "launcher; take the mpirun of the MPI that mpi4py is built with, or one process")
    asked = f"{command} -help" if asks_for_help(words) else command
    first, *others = world.everywhere(asked)
    for rank, other in enumerate(others, start=2):
        if other != first:
            raise InputError(f"process {rank} of {size} differs from the first one: contactsnes "
                             f"{other} is asked for there and {first} in the first; give all the "
                             "same")
    if command not in SHARED:
        raise InputError(f"started as {size} processes, but contactsnes {command} is done by one: "
                         "start it without mpirun or srun, or with -n 1")


def _refuse(size, rank, why):
    """InputError in the first of several processes; the others end without a word."""
    if rank:
        # a launcher that sees another status would end the first one before it has spoken
        sys.exit(0)
    raise InputError(f"started as {size} processes, but {why}")


def stay_alone():
    """Tell Open MPI, before it begins, that there will be one process, which needs no daemon, that
    takes a good part of a second to start, nor to look for networks, which takes a fifth.

    Such processes have one folder together, which one that ends may take away as another begins:
    they need none.
    """
    os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    os.environ.setdefault("OMPI_MCA_orte_create_session_dirs", "false")
    os.environ.setdefault("OMPI_MCA_pml", "ob1")


def begin_petsc(words):
    """Initialise PETSc with an argument list, or where it runs already, give its database these
    options; InputError for options that it refuses, or processes that are not ours."""
    import petsc4py

    loaded = sys.modules.get("petsc4py.PETSc")
    if loaded and loaded.Sys.isInitialized():
        _go_on(entries(words))
    else:
        if world.size == 1:
            stay_alone()
        try:
            petsc4py.init(["contactsnes", *BEGINNING, *words])
        except RuntimeError as error:
            raise InputError(f"PETSc does not start with these options ({error}); it says why "
                             "above") from None
        _keep_others(entries(words))
    here = sys.modules["petsc4py.PETSc"].COMM_WORLD
    if here.getSize() != world.size:
        _refuse(max(here.getSize(), world.size), max(here.getRank(), world.rank),
                f"PETSc knows of {here.getSize()} and mpi4py of {world.size}: both have to belong "
                "to the MPI of the launcher; else start contactsnes without mpirun or srun")


def _keep_others(given):
    """Remember what PETSc's database holds besides the options of a command (name -> value): what
    PETSc itself was started with, which later commands of this process find, too."""
    _OTHERS.update(entries(BEGINNING), **{name: value for name, value in database().items()
                                          if name not in given})


def _go_on(given):
    """Make PETSc's database hold the options of a command in place of those of an earlier one, in a
    program that has started PETSc before.

    Parameters
    ----------
    given : mapping from names to values
    """
    if "options_file" in given:
        raise InputError(f"-options_file is '{given['options_file']}', which PETSc reads as it "
                         "starts, but it runs already: give the options as lines '-option value' "
                         "in a file, or start PETSc with it (petsc4py.init)")
    if not _OTHERS:
        _keep_others({})
    install({})  # so that none of them counts as used
    install({**_OTHERS, **given})
    late = [f"-{name}" for name in given if name.startswith(AT_START)]
    if late:
        complain("warning", f"{', '.join(late)}: PETSc looks at that as it starts, but it runs "
                 "already: give it to petsc4py.init")


def refuse_unshared(scene):
    """InputError for a scene that several processes cannot share out.

    Parameters
    ----------
    scene : Scene
    """
    if world.size == 1:
        return
    what = ("a line" if scene.dimension == 1 else "an isolated contact" if scene.isolated else "")
    if what:
        raise InputError(f"started as {world.size} processes, but {what} is solved by one: start "
                         "contactsnes without mpirun or srun, or take a plane with a period "
                         "(-scene_dimension 2)")


def refuse_differences():
    """InputError where processes have other options, files of the scene or versions of this
    program."""
    given = database()
    mine = {"contactsnes": __version__, **{f"-{name}": value for name, value in given.items()},
            **overlooked(),
            **{f"the file of -{name}": checksum(path)
               for name, path in _files_of_scene(given).items()}}
    if found := difference(world.everywhere(mine)):
        rank, name, there, here = found
        raise InputError(f"process {rank} of {world.size} differs from the first one: {name} is "
                         f"{there} there and {here} in the first; give all the same options and "
                         "files")


def _files_of_scene(given):
    """Name -> path of the options of a scene that name a file, or something within one."""
    paths = {name: path for name, value in given.items() if name.startswith("scene_")
             for path in (value, value.rpartition(":")[0]) if path and os.path.isfile(path)}
    return paths
