"""Programs and the command in several processes of MPI, for tests."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import pytest
from processes import call

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("mpi4py",)
SIZES = (2, 3)
SECONDS = 240.0
"""After which processes that still run are ended, and the test fails."""


def launcher_path():
    """The program that starts processes: beside the interpreter, where PETSc's own MPI may be, or
    in PATH."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    return shutil.which("mpirun", path=path) or shutil.which("mpiexec", path=path)


def lacking():
    """What is not here to run tests in several processes, in words; empty where nothing lacks."""
    names = [name for name in PACKAGES if find_spec(name) is None]
    if not launcher_path():
        names.append("mpirun")
    return f"no {', '.join(names)} here: scripts/setup --mpi" if names else ""


together = pytest.mark.skipif(bool(lacking()), reason=lacking())
"""Mark of tests that need MPI."""


class Done(NamedTuple):
    """A finished run: status of the launcher, and what all processes wrote."""

    returncode: int
    stdout: str
    stderr: str

    @property
    def told(self):
        """Lines of the program's own on standard error: the launcher says more."""
        return [line for line in self.stderr.splitlines() if line.startswith("contactsnes: ")]


@cache
def launcher_words():
    """The words with which the launcher starts processes on any number of cores."""
    path = launcher_path()
    version = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    if "Open MPI" in version.stdout or "OpenRTE" in version.stdout:
        return [path, "--oversubscribe"] + ["--allow-run-as-root"] * (os.geteuid() == 0)
    return [path]


class Started:
    """Processes that have been started.

    Parameters
    ----------
    size : int
    words : of the program, after the interpreter
    folder : working folder
    variables : name -> value in the environment
    """

    def __init__(self, size, words, folder, variables):
        self._scratch = tempfile.mkdtemp(prefix="r", dir="/tmp")  # Open MPI wants a short path
        kept = {name: value for name, value in os.environ.items()
                if not name.startswith(("OMPI_", "PMI", "SLURM"))}
        path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
        self.process = subprocess.Popen(
            [*launcher_words(), "-n", str(size), sys.executable, *map(str, words)], cwd=folder,
            text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            start_new_session=True,
            env=kept | {"PYTHONPATH": path, "TMPDIR": self._scratch, "OMP_NUM_THREADS": "1",
                        "OMPI_MCA_mpi_yield_when_idle": "1",  # there may be fewer cores
                        **variables})

    def ended(self, seconds=SECONDS):
        """What has come of them; the test fails where they hang."""
        try:
            shown = self.process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            self.process.terminate()  # the launcher takes its processes with it
            try:
                shown = self.process.communicate(timeout=10.0)
            except subprocess.TimeoutExpired:
                os.killpg(self.process.pid, signal.SIGKILL)
                shown = self.process.communicate()
            pytest.fail(f"the processes hang after {seconds:g} s:\n" + "\n".join(shown))
        finally:
            shutil.rmtree(self._scratch, ignore_errors=True)
        return Done(self.process.returncode, *shown)


def program(size, text, folder, **variables):
    """A finished program of Python in so many processes."""
    return Started(size, ["-c", text], folder, variables).ended()


def say(size, text, folder, word="alike", times=1):
    """Assert that a program of Python in so many processes ends well, and that each says a word so
    often.

    Parameters
    ----------
    size, text, folder : as of `program`
    word : str
    times : int
    """
    done = program(size, text, folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count(word) == times * size, done.stdout


def found(size, text, folder):
    """What a program of Python in so many processes leaves in ``found.json`` of a folder: a
    launcher may be slow to pass on as much on standard output."""
    done = program(size, text, folder)
    assert done.returncode == 0, done.stderr
    return json.loads((Path(folder) / "found.json").read_text(encoding="utf-8"))


def command(size, *arguments, folder):
    """The command in so many processes, finished; in one, without a launcher."""
    if size == 1:
        done = call(*arguments, folder=folder)
        return Done(done.returncode, done.stdout, done.stderr)
    return Started(size, ["-m", "contactsnes", *arguments], folder, {}).ended()
