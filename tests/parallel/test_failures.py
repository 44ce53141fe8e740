"""What goes wrong in one of several processes ends all of them, with the sentence and status of a
run in one process, and every point before it in the archive."""

import os
import signal
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

run.Run._accept = failing
sys.exit(cli.main(["run", *{words!r}]))"""


def failed(size, ranks, error, folder, words=PLANE):
    """A run in which some processes fail at the fourth point."""
    return program(size, FAILING.format(ranks=ranks, error=error, words=words), folder)


@together
@pytest.mark.parametrize("ranks", [(0,), (1,), (0, 1)])
def test_memory_that_lacks_in_some_processes(ranks, tmp_path):
    done = failed(2, ranks, "MemoryError('1 TB')", tmp_path)
    assert done.returncode == 1, done.stdout + done.stderr
    assert len(done.told) == 1 and "Traceback" not in done.stderr, done.stderr
    assert all(words in done.told[0] for words in ("not enough memory (1 TB)", "3 points are in",
                                                   "-archive_resume"))
    assert ("process 2 of 2" in done.told[0]) == (ranks == (1,))
    assert read(tmp_path / "run.h5").points == 3


@together
@pytest.mark.parametrize("ranks", [(1,), (0, 1, 2)])
def test_a_defect_in_some_processes(ranks, tmp_path):
    """What is neither solver nor user is shown with its traceback, once."""
    done = failed(3, ranks, "RuntimeError('something is wrong')", tmp_path)
    assert done.returncode == 1, done.stdout + done.stderr
    assert done.stderr.count("RuntimeError: something is wrong") == 1, done.stderr
    assert read(tmp_path / "run.h5").points == 3
