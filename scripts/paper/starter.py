"""Runs commands of Python, each in a process of its own that begins with what all of them import:
importing takes a third of a second of processor time, as long as many a run. PETSc is loaded there,
and MPI has begun, but PETSc begins in each process with its own options. A process that has come to
its end gives back to the system as a whole what it began with: one by one, that would have to be
copied first.

As a program, with the names of modules to import, it reads a line of JSON for each command, [its
arguments, folder, file for what it says, file for what it complains of], and answers with two: its
number, and at its end [exit status, seconds of processor time].
"""

import atexit
import ctypes
import gc
import importlib
import json
import os
import runpy
import select
import signal
import subprocess
import sys
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("h5py", "contactsnes.branch.branch", "contactsnes.branch.unread",
           "contactsnes.commands.cli", "contactsnes.output.archive", "contactsnes.output.shared",
           "scipy.ndimage")
"""What most commands import, here or later, and what takes long."""


class Starter:
    """A process that starts commands, one after the other; it begins with the first.

    Parameters
    ----------
    environment : mapping of names to texts, by default this process's, with one thread
    modules : names of the modules that commands begin with
    """

    def __init__(self, environment=None, modules=MODULES):
        self._environment = environment or {**os.environ, "PYTHONPATH": str(ROOT),
                                            "OMP_NUM_THREADS": "1"}
        self._modules, self._process = modules, None

    def run(self, arguments, said, complaints=None, folder=ROOT, seconds=None):
        """(exit status, seconds of processor time) of Python with some arguments.

        Parameters
        ----------
        arguments : list of str
        said : path of the file that gets what it says
        complaints : path of that for its standard error, by default the same one
        folder : path, in which it runs
        seconds : float, after which it is killed, by default never
        """
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, __file__, *self._modules], env=self._environment, cwd=ROOT,
                bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        files = map(str, (folder, said, complaints or said))
        self._process.stdin.write(json.dumps([arguments, *files]).encode() + b"\n")
        child = self._answer()
        # (what comes together with the first answer waits in the pipe: nothing is read ahead)
        if not select.select([self._process.stdout], [], [], seconds)[0]:
            os.kill(child, signal.SIGKILL)
        return self._answer()

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"what starts the commands has ended: {self._process.wait()}")
        return json.loads(line)

    def end(self):
        """End the process when its command is over."""
        if self._process is not None:
            self._process.stdin.close()
            self._process.wait()
            self._process.stdout.close()
            self._process = None


def become(arguments, folder, said, complaints):
    """Run a program in this process as Python would with these arguments.

    Parameters
    ----------
    arguments, folder, said, complaints : as of `Starter.run`
    """
    for stream, path in ((1, said), (2, complaints)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(file, stream)
        os.close(file)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    follow(arguments, folder)


def follow(arguments, folder):
    """Run a program in this process and folder, whose streams are there."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.chdir(folder)
    if arguments[0] == "-m":
        sys.argv, sys.path[0] = arguments[1:], folder
        runpy.run_module(arguments[1], run_name="__main__", alter_sys=True)
    else:
        sys.argv, sys.path[0] = arguments, os.path.dirname(arguments[0])
        runpy.run_path(arguments[0], run_name="__main__")


def become_to_the_end(*command):
    """As `become`; the process ends with the status that the program asks for."""
    try:
        become(*command)
    except SystemExit as end:
        if not isinstance(end.code, int):
            raise
        close()
        os._exit(end.code)


def close():
    """What Python does at its end, but for giving back what it holds."""
    atexit._run_exitfuncs()
    begun = sys.modules.get("petsc4py.PETSc")
    if begun and begun.Sys.isInitialized():
        begun._finalize()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()


def prepare(modules):
    """Import what programs begin with, before any is started; PETSc, which begins in each."""
    gc.disable()
    from petsc4py.lib import ImportPETSc

    petsc = ImportPETSc()
    for name in modules:
        importlib.import_module(name)

    from contactsnes.kernels.choice import chosen

    chosen()  # loads the library, and what FFTW has learned
    gc.freeze()  # a collection that looks through all of this would copy it
    return petsc


def begin_mpi(petsc):
    """Begin MPI as each command would for itself, in a fortieth of a second; what ends it.

    Of a process alone, MPI needs no other thread: one that it has does not come along.
    """
    from contactsnes.commands.starting import stay_alone

    stay_alone()
    warnings.filterwarnings("ignore", ".*fork", DeprecationWarning)
    library = ctypes.CDLL(petsc.__file__)
    try:
        library.MPI_Init(None, None)
    except AttributeError:  # a PETSc without MPI
        return lambda: None
    return library.MPI_Finalize


def serve(learn):
    """Start commands as they are asked for, after what the last ones left has been learned; the one
    that is to be run now, in a process for it."""
    for line in sys.stdin:
        command = json.loads(line)
        learn()
        child = os.fork()
        if child == 0:
            return command
        print(child, flush=True)
        _, status, used = os.wait4(child, 0)
        print(json.dumps([os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime]),
              flush=True)
    return None


if __name__ == "__main__":
    # an interruption is for the command
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_mpi = begin_mpi(prepare(sys.argv[1:]))

    from contactsnes.kernels.choice import chosen

    command = serve(chosen)
    if command is not None:
        become_to_the_end(*command)
    else:
        end_mpi()
