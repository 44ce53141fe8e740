"""What goes wrong in one of several processes ends all of them, with the sentence and status of a
run in one process, and every point before it in the archive."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from ranks import Started, program, together

from contactsnes.output.reading import read

PLANE = ("-scene_dimension", "2", "-scene_points", "32", "-scene_period", "20",
         "-scene_geometry", "sphere", "-scene_normal_maugis", "1", "-archive_file", "run.h5",
         "-load_start", "normal_displacement=-3", "-load_path", "normal_displacement=1")
FAILING = """
import sys
from contactsnes.commands import cli, run
from contactsnes.system.processes import world
accept = run.Run._accept

def failing(self, point):
    if self.progress.points == 3 and world.rank in {ranks}:
        raise {error}
    accept(self, point)

run.Run._accept, run.PATIENCE = failing, {patience}
sys.exit(cli.main(["run", *{words!r}]))"""


def failed(size, ranks, error, folder, words=PLANE, fresh=False):
    """A run in which some processes fail at the fourth point.

    Parameters
    ----------
    size, folder, fresh : as of `ranks.Started`
    ranks : tuple of int, of those that fail
    error : str, the expression that they raise
    words : tuple of str, of the run
    """
    # where others do not, none comes, however long one waits for them
    text = FAILING.format(ranks=ranks, error=error, words=words,
                          patience=5.0 if len(ranks) == size else 0.2)
    return program(size, text, folder, fresh)


@together
@pytest.mark.parametrize("ranks, letter", [((0,), ""), ((1,), "\\udcfc"), ((0, 1), "")])
def test_memory_that_lacks_in_some_processes(ranks, letter, tmp_path):
    """Also in a process whose locale lacks a letter of what it says."""
    done = failed(2, ranks, f"MemoryError('1 TB{letter}')", tmp_path, fresh=ranks == (1,))
    assert done.returncode == 1, done
    assert len(done.told) == 1 and "Traceback" not in done.stderr, done
    assert all(words in done.told[0] for words in (f"not enough memory (1 TB{letter})",
                                                   "3 points are in", "-archive_resume"))
    assert ("process 2 of 2" in done.told[0]) == (ranks == (1,))
    assert read(tmp_path / "run.h5").points == 3


JOINING = """
import os, signal, sys
from mpi4py import MPI
from contactsnes.commands import cli

class World:
    def __getattr__(self, name):
        if name == "Split_type" and PROCESSES.rank == 1:
            os.kill(os.getpid(), signal.SIGTERM)
        return getattr(PROCESSES, name)

PROCESSES, MPI.COMM_WORLD = MPI.COMM_WORLD, World()
sys.exit(cli.main(["info", *{words!r}]))"""


@together
def test_a_signal_to_one_process_as_all_find_each_other(tmp_path):
    """It ended, and the others waited for it for ever."""
    done = program(2, JOINING.format(words=PLANE), tmp_path)
    assert done.returncode == 128 + signal.SIGTERM, done
    assert done.told == ["contactsnes: error: interrupted by SIGTERM (process 2 of 2)"]


LATER = """
import sys, time
from contactsnes.commands import cli, run
from contactsnes.system.processes import world
accept = run.Run._accept

def failing(self, point):
    if self.progress.points == 3 and world.rank in {ranks}:
        time.sleep(world.rank)
        raise MemoryError("1 TB")
    accept(self, point)

run.Run._accept, run.PATIENCE = failing, 2.5
sys.exit(cli.main(["run", *{words!r}]))"""
AFTERWARDS = """
import sys
from contactsnes.commands import cli, run
from contactsnes.system.processes import world
follow = run.Run.follow

def failing(self):
    status = follow(self)
    if world.rank == 1:
        raise MemoryError("1 TB")
    return status

run.Run.follow = failing
sys.exit(cli.main(["run", *{words!r}]))"""


@together
@pytest.mark.parametrize("ranks", [(1, 2), (0, 1)])
def test_several_that_fail_one_after_another_speak_once(ranks, tmp_path):
    """While the third one goes on, and waits: the last one is ended as it waits for others."""
    done = program(3, LATER.format(ranks=ranks, words=PLANE), tmp_path, fresh=ranks == (1, 2))
    assert done.returncode == 1 and "Traceback" not in done.stderr, done
    assert len(done.told) == 1 and "3 points are in" in done.told[0], done
    assert ("process 2 of 3" in done.told[0]) == (ranks == (1, 2))
    assert read(tmp_path / "run.h5").points == 3


@together
def test_a_process_that_fails_when_others_have_ended_well(tmp_path):
    done = program(2, AFTERWARDS.format(words=PLANE), tmp_path)
    assert done.returncode == 2 and "Traceback" not in done.stderr, done
    assert len(done.told) == 1 and "process 2 of 2" in done.told[0], done
    assert read(tmp_path / "run.h5").complete


@together
@pytest.mark.parametrize("ranks", [(1,), (0, 1, 2)])
def test_a_defect_in_some_processes(ranks, tmp_path):
    """What is neither solver nor user is shown with its traceback, once."""
    done = failed(3, ranks, "RuntimeError('something is wrong')", tmp_path)
    assert done.returncode == 1, done
    assert done.stderr.count("RuntimeError: something is wrong") == 1, done
    assert read(tmp_path / "run.h5").points == 3


LAW = """
import os
from contactsnes.interface.laws.modified import Modified

class Failing(Modified):
    def evaluate(self, *arguments):
        if "BROKEN" in os.environ:
            raise {error}("no traction")
        return super().evaluate(*arguments)
"""
BREAKING = """
import os, sys
from contactsnes.commands import cli, run
from contactsnes.system.processes import world
accept = run.Run._accept

def breaking(self, point):
    accept(self, point)
    if self.progress.points == 3 and world.rank == 1:
        os.environ["BROKEN"] = "1"

run.Run._accept, run.PATIENCE = breaking, 0.2
sys.exit(cli.main(["run", *{words!r}]))"""


@together
@pytest.mark.parametrize("error", ["ValueError", "SystemExit"])
def test_a_law_that_fails_within_a_solve_of_one_process(error, tmp_path):
    """The error passes through PETSc, while the other process waits for a sum: for ever, where
    the law ended its program."""
    (tmp_path / "law.py").write_text(LAW.format(error=error))
    done = program(2, BREAKING.format(words=(*PLANE, "-scene_law", "law.py:Failing")), tmp_path)
    assert done.returncode == 1, done
    assert all(words in done.told[0] for words in (f"{error}: no traction; line 8 of the file",
                                                   "3 points are in", "process 2 of 2"))
    assert "Traceback" not in done.stderr and read(tmp_path / "run.h5").points == 3


@together
def test_a_full_disk(tmp_path):
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (400000, 400000))\n"
    words = (*PLANE, "-archive_fields", "all", "-archive_fields_on", "cell")
    text = FAILING.format(ranks=(), error="None", words=words, patience=5.0)
    done = program(2, limit + text, tmp_path)
    assert done.returncode == 1, done
    points = read(tmp_path / "run.h5").points
    assert len(done.told) == 1 and points, done
    assert "cannot be written (File too large)" in done.told[0]
    assert f"{points} {'points are' if points > 1 else 'point is'} in" in done.told[0]


COUNTED = re.compile("; (?P<least>at least )?(?P<points>[0-9]+) points are in ")


def started(folder, size=2):
    """A long run that has at least two points."""
    run = Started(size, ["-m", "contactsnes", "run", *PLANE, "-continuation_largest_step", "0.001",
                         "-continuation_initial_step", "0.001"], folder, fresh=True)
    path, until = folder / "run.h5", time.monotonic() + 120.0
    while time.monotonic() < until and not (path.exists() and read(path).points > 1):
        time.sleep(0.1)
    return run


def members(pid):
    """Processes of the command that a launcher has started."""
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        try:
            status = (path / "stat").read_text(encoding="ascii", errors="replace")
            words = (path / "cmdline").read_bytes()
        except OSError:
            continue
        if int(status.rpartition(")")[2].split()[1]) == pid and b"contactsnes" in words:
            found.append(int(path.name))
    return found


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="no /proc here")


@together
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_launcher(number, tmp_path):
    run = started(tmp_path)
    run.process.send_signal(number)
    done, archive = run.ended(60.0), read(tmp_path / "run.h5")
    assert done.returncode != 0 and "Traceback" not in done.stderr, done
    assert archive.points > 1 and not archive.complete
    for line in done.told:
        counted = COUNTED.search(line)
        assert counted, line
        lacking = archive.points - int(counted["points"])
        # of the point that is being written, one process may know and the other not
        assert lacking in ((0, 1) if counted["least"] else (0,)), (line, archive.points)


@together
@needs_proc
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_process_that_is_killed(number, tmp_path):
    run = started(tmp_path)
    own = sorted(members(run.process.pid))
    assert len(own) == 2
    os.kill(own[1], number)
    done = run.ended(60.0)
    assert done.returncode == 128 + number and "Traceback" not in done.stderr, done
    assert read(tmp_path / "run.h5").points > 1 and not members(run.process.pid)


@together
def test_an_exception_in_one_process_of_a_script_ends_all(tmp_path):
    done = program(2, """
import petsc4py
petsc4py.init([])
from petsc4py import PETSc
from contactsnes import Branch, Load, Scene

scene = Scene(dimension=2, geometry="sphere", points=32, period=12.0, height=float("inf"))
for point in Branch(scene, Load("normal_displacement=0", "normal_displacement=0.4")):
    print("a point", flush=True)
    if PETSc.COMM_WORLD.rank:
        raise ValueError("of mine")""", tmp_path, fresh=True)
    assert done.returncode == 1 and "ValueError: of mine" in done.stderr
    assert 1 <= done.stdout.count("a point") <= 4


ABORTED = """
import time
from types import SimpleNamespace
from contactsnes.system import processes

processes.GRACE = 0.1
processes._end_all(SimpleNamespace(Abort=lambda status: time.sleep(600.0)), 1)
"""


@pytest.mark.skipif(not hasattr(signal, "alarm"), reason="no alarms here")
def test_a_process_whose_launcher_is_gone_ends(tmp_path):
    """Open MPI waits for the launcher, which is to end the others, for ever."""
    done = subprocess.run([sys.executable, "-c", ABORTED], cwd=tmp_path, timeout=300.0,
                          check=False)
    assert done.returncode == -signal.SIGALRM
