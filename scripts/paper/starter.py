"""Runs commands of Python, each in a process of its own that begins with what all of them import:
importing takes a third of a second of processor time, as long as many a run. PETSc is loaded there,
but begins in each process with its own options. A process that has come to its end gives back to
the system as a whole what it began with: one by one, that would have to be copied first.

As a program it reads a line of JSON for each command, [its arguments, file for what it says], and
answers with one: [exit status, seconds of processor time].
"""

import atexit
import gc
import json
import os
import runpy
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Starter:
    """A process that starts commands, one after the other."""

    def __init__(self):
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
        self._process = subprocess.Popen([sys.executable, __file__], env=environment, cwd=ROOT,
                                         text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, arguments, said):
        """(exit status, seconds of processor time) of Python with some arguments; what it says goes
        to a file."""
        self._process.stdin.write(json.dumps([arguments, str(said)]) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError(f"what starts the runs has ended: {self._process.wait()}")
        return json.loads(answer)

    def end(self):
        """End the process when its command is over."""
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def become(arguments, said):
    """Run a program in this process as Python would with these arguments."""
    file = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for stream in (1, 2):
        os.dup2(file, stream)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if arguments[0] == "-m":
        sys.argv = arguments[1:]
        runpy.run_module(arguments[1], run_name="__main__", alter_sys=True)
    else:
        sys.argv = arguments
        runpy.run_path(arguments[0], run_name="__main__")


def become_to_the_end(arguments, said):
    """As `become`; the process ends with the status that the program asks for."""
    try:
        become(arguments, said)
    except SystemExit as end:
        if not isinstance(end.code, int):
            raise
        atexit._run_exitfuncs()
        begun = sys.modules.get("petsc4py.PETSc")
        if begun and begun.Sys.isInitialized():
            begun._finalize()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        os._exit(end.code)


def serve():
    """Start commands as they are asked for; whether this is one of them, to be run now."""
    for line in sys.stdin:
        command = json.loads(line)
        child = os.fork()
        if child == 0:
            return command
        _, status, used = os.wait4(child, 0)
        print(json.dumps([os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime]),
              flush=True)
    return None


if __name__ == "__main__":
    # an interruption is for the command
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.disable()
    import h5py  # noqa: F401
    from petsc4py.lib import ImportPETSc

    ImportPETSc()

    import contactsnes.branch.branch
    import contactsnes.commands.cli
    import contactsnes.output.archive  # noqa: F401
    from contactsnes.kernels.choice import chosen

    chosen()  # loads the library, and what FFTW has learned
    command = serve()
    if command is not None:
        become_to_the_end(*command)
