"""Programs and the command in several processes of MPI, for tests.

Most of them are forks of a process that has imported what they need, which takes a third of the
time of a start; those of tests of how processes begin and end are started as a user starts them
(``fresh``).
"""

import atexit
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
FORKS = str(Path(__file__).with_name("forks.py"))
MODULES = ("h5py", "contactsnes.branch.branch", "contactsnes.branch.unread",
           "contactsnes.commands.cli", "contactsnes.commands.run", "contactsnes.grid.slab_even",
           "contactsnes.grid.slabs", "contactsnes.output.archive", "contactsnes.output.resuming",
           "contactsnes.output.shared", "scipy.ndimage")
"""What most programs import, here or later."""
PACKAGES = ("mpi4py",)
SIZES = (2, 3)
FEW = (2, pytest.param(3, marks=pytest.mark.study))
"""Those of whole solves, whose exchanges other tests look at between three and four."""
NEAR = {"OMPI_MCA_pml": "ob1"}
"""Variables with which Open MPI does not look for networks first, which takes a fifth of a second:
of forks, while fresh processes begin as a user's do."""
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

    def __repr__(self):
        """All that is known of it, as a failing test shows it."""
        status = self.returncode
        return "\n".join([f"status {status}" if status >= 0 else f"ended by signal {-status}",
                          "standard output:", self.stdout, "standard error:", self.stderr])

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


def environment():
    """Variables of every process: nothing of a launcher that this one was started by, one thread,
    and a rest for whoever waits."""
    kept = {name: value for name, value in os.environ.items()
            if not name.startswith(("OMPI_", "PMI", "SLURM"))}
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    return kept | {"PYTHONPATH": path, "OMP_NUM_THREADS": "1",
                   "OMPI_MCA_mpi_yield_when_idle": "1"} | resting()


RESTING = """#include <time.h>
int sched_yield(void) { struct timespec moment = {0, 20000}; return nanosleep(&moment, 0); }
"""


@cache
def resting():
    """Variables with which a process of Open MPI that waits for another one sleeps for moments,
    where there is a compiler. It would ask again and again, and where there are fewer cores than
    processes the one that it waits for would be kept from going on."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if sys.platform != "linux" or not compiler:
        return {}
    folder = tempfile.mkdtemp(prefix="contactsnes-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    library = os.path.join(folder, "resting.so")
    done = subprocess.run([compiler, "-shared", "-fPIC", "-o", library, "-x", "c", "-"],
                          input=RESTING, text=True, capture_output=True, check=False)
    others = filter(None, [os.environ.get("LD_PRELOAD")])
    return {} if done.returncode else {"LD_PRELOAD": " ".join([library, *others])}


@cache
def interpreter():
    """The words in the place of Python's path with which a program is a fork; Python itself, where
    the launcher is not Open MPI's, whose processes are known by their environment alone."""
    if sys.platform != "linux" or len(launcher_words()) == 1:
        return [sys.executable]
    folder = tempfile.mkdtemp(prefix="f", dir="/tmp")  # so are sockets
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    path = os.path.join(folder, "socket")
    server = subprocess.Popen([sys.executable, FORKS, "-serve", path, *MODULES],
                              env=environment(), text=True, stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    atexit.register(server.communicate)
    answer = server.stdout.readline()
    assert answer == "ready\n", answer + server.communicate()[0]
    return [sys.executable, "-S", "-E", FORKS, path]


class Started:
    """Processes that have been started.

    Parameters
    ----------
    size : int
    words : of the program, after the interpreter
    folder : working folder
    fresh : whether each is a new process of Python, instead of a fork
    """

    def __init__(self, size, words, folder, fresh=False):
        self._scratch = tempfile.mkdtemp(prefix="r", dir="/tmp")  # Open MPI wants a short path
        python = [sys.executable] if fresh else interpreter()
        self.process = subprocess.Popen(
            [*launcher_words(), "-n", str(size), *python, *map(str, words)], cwd=folder,
            text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            start_new_session=True,
            env=environment() | {"TMPDIR": self._scratch} | ({} if fresh else NEAR))

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


def program(size, text, folder, fresh=False):
    """A finished program of Python in so many processes.

    Parameters
    ----------
    size, folder, fresh : as of `Started`
    text : str
    """
    return Started(size, ["-c", text], folder, fresh).ended()


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
    assert done.returncode == 0, done
    assert done.stdout.count(word) == times * size, done


def found(size, text, folder):
    """What a program of Python in so many processes leaves in ``found.json`` of a folder: a
    launcher may be slow to pass on as much on standard output."""
    done = program(size, text, folder)
    assert done.returncode == 0, done
    return json.loads((Path(folder) / "found.json").read_text(encoding="utf-8"))


def command(size, *arguments, folder, fresh=False):
    """The command in so many processes, finished; in one, without a launcher.

    Parameters
    ----------
    size, folder, fresh : as of `Started`
    arguments : of the command
    """
    if size == 1:
        done = call(*arguments, folder=folder)
        return Done(done.returncode, done.stdout, done.stderr)
    return Started(size, ["-m", "contactsnes", *arguments], folder, fresh).ended()
