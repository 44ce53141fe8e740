"""Several processes of the command: what they say, and what they cannot do together."""

import re

import pytest
from ranks import SIZES, command, program, together

from contactsnes.commands import starting
from contactsnes.options.fields import InputError

PLANE = ("-scene_dimension", "2", "-scene_points", "32", "-scene_period", "20",
         "-scene_geometry", "sphere", "-scene_normal_maugis", "1", "-load_path",
         "normal_displacement=0.5")


def refused(done, *words):
    """Assert that bad input was answered by one sentence with these words, once."""
    assert done.returncode == 2, done
    assert len(done.told) == 1 and "Traceback" not in done.stderr, done
    assert all(word in done.told[0] for word in words), done.told


@together
@pytest.mark.parametrize("size", SIZES)
def test_what_one_process_does_is_refused(size, tmp_path):
    refused(command(size, "plot", "run.h5", folder=tmp_path, fresh=size == 2),
            f"{size} processes", "plot")


@together
def test_scenes_of_one_process_are_refused(tmp_path):
    refused(command(2, "run", "-load_path", "normal_displacement=1", folder=tmp_path),
            "2 processes", "a line")
    refused(command(2, "run", *PLANE, "-scene_period", "inf", folder=tmp_path), "isolated")


@together
def test_bad_input_is_told_once(tmp_path):
    refused(command(2, "run", *PLANE, "-scene_pionts", "32", folder=tmp_path), "scene_points")
    refused(command(2, "run", "absent.opts", folder=tmp_path), "absent.opts")
    refused(command(2, "nonsense", folder=tmp_path), "'nonsense' is no command")


BOWL = """
from contactsnes import Shape

class Bowl(Shape):
    by_nodes = True

    def gap(self, coordinates, scene):
        raise ValueError("no table")
"""


@together
def test_what_all_find_in_other_rows_is_told_once(tmp_path):
    """Of 32 rows the third process has fewer than the others, which its sentence says."""
    (tmp_path / "bowl.py").write_text(BOWL)
    refused(command(3, "run", *PLANE, "-scene_geometry", "bowl.py:Bowl", folder=tmp_path),
            "ValueError: no table")


@together
@pytest.mark.parametrize("name", ["-snes_monitor", "-log_view"])
def test_a_file_that_the_first_process_cannot_write_is_told_at_the_start(name, tmp_path):
    """Of -log_view PETSc says so when all is done, and others wait for the first process."""
    refused(command(2, "run", *PLANE, name, ":absent/told.txt", folder=tmp_path, fresh=True),
            name, "absent/told.txt")


ALONE = """
import os
from petsc4py import PETSc

class Own:
    def __init__(self):
        if PETSc.COMM_WORLD.rank == 1:
            raise ValueError("mine alone")

    def solve(self, snes, right, unknown):
        snes.setConvergedReason(PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT)
"""


@together
def test_a_method_that_one_process_cannot_make_ends_all(tmp_path, monkeypatch):
    """What options a solver does not ask for is looked at before the first solve."""
    (tmp_path / "alone.py").write_text(ALONE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    done = command(2, "run", *PLANE, "-snes_type", "python", "-snes_python_type", "alone.Own",
                   folder=tmp_path, fresh=True)
    assert done.returncode in (1, 2) and len(done.told) == 1, done
    assert "mine alone" in done.told[0] and "process 2 of 2" in done.told[0], done.told


CLAIMS = """
import numpy as np
from contactsnes import Shape

class Claims(Shape):
    even, convex, parabola, by_nodes = (0, 1), True, {2: 1.0}, True
    tilt, lowered = 0.0, 0.0

    def gap(self, coordinates, scene):
        squared = sum(x ** 2 for x in coordinates)
        return (1 + 0.01 * squared) * squared / 2 + self.tilt * coordinates[0] - self.lowered

    def curvature(self, scene):
        return 8.0, 8.0

class Ridge(Claims):
    uniform = (1,)
    parabola = {}

    def gap(self, coordinates, scene):
        return coordinates[0] ** 2 / 2 + 0 * coordinates[1]

class Tilted(Claims):
    tilt = 1e-3

class Lowered(Claims):
    lowered = 1e-3

class Waved(Claims):
    convex, parabola = True, {}

    def gap(self, coordinates, scene):
        return super().gap(coordinates, scene) + 3 * np.cos(2 * coordinates[0])

class Sharp(Claims):
    def curvature(self, scene):
        return 8.0, 1.2

class Along(Ridge):
    uniform = (0,)
"""


NAMES = ("Claims", "Ridge", "Tilted", "Lowered", "Waved", "Sharp", "Along")
ASKED = """
from contactsnes.commands.cli import main
from mpi4py import MPI
found = [main(["info", *{words!r}, "-scene_geometry", "claims.py:" + name]) for name in {names!r}]
assert all(each == found for each in MPI.COMM_WORLD.allgather(found))
print(*["found"] * (MPI.COMM_WORLD.rank == 0), *found)
"""


@together
def test_claims_of_a_shape_are_looked_at_as_by_one_process(tmp_path):
    """Of 24 rows, of which each of six processes has four, few are mirror images of one's own."""
    (tmp_path / "claims.py").write_text(CLAIMS)
    text = ASKED.format(words=[*PLANE, "-scene_points", "24"], names=NAMES)
    one, several = (program(size, text, tmp_path) for size in (1, 6))
    assert one.returncode == several.returncode == 0, several.stderr
    status = [0 if name in ("Claims", "Ridge") else 2 for name in NAMES]
    assert " ".join(map(str, ["found", *status])) in several.stdout
    refusals = [line for line in one.told if "error: " in line]
    assert one.told == several.told and len(refusals) == sum(status) // 2, several.stderr


@together
def test_info_tells_the_memory_of_each_process(tmp_path):
    """Of each of two it is half of what one takes, up to rounding."""
    told = {}
    for size in (1, 2):
        done = command(size, "info", *PLANE, "-scene_points", "512", folder=tmp_path)
        assert done.returncode == 0 and done.stdout.count("Unknowns\n") == 1, done
        told[size] = re.search(r"(\d+) MB( a process)? on the whole", done.stdout)
    assert told[1][2] is None and told[2][2] == " a process"
    assert abs(2 * int(told[2][1]) - int(told[1][1])) <= 2


@together
def test_memory_is_that_of_all_machines(tmp_path):
    """Two processes on one machine share its memory: together they have no more than one has."""
    text = """
from contactsnes.system.processes import world
from contactsnes.branch.memory import memory
alone = memory()
world.join()
assert world.neighbours == world.size == 2
assert 0.8 * alone < memory() < 1.2 * alone
"""
    assert program(2, text, tmp_path).returncode == 0


@together
def test_help_is_told_once(tmp_path):
    done = command(2, "run", "-help", folder=tmp_path)
    assert done.returncode == 0 and done.stdout.count("Scene: ") == 1
    done = command(2, "--version", folder=tmp_path)
    assert done.returncode == 0 and done.stdout.count("contactsnes") == 1


@together
@pytest.mark.parametrize("file, more, words", [
    ("here", ["-snes_atol", "1e-7"], ["process 2", "-snes_atol", "1e-7"]),
    ("there", [], ["process 2", "file of -scene_geometry_file"])])
def test_processes_that_differ_are_named(file, more, words, tmp_path):
    """A file of options or heights may be an old copy on another machine."""
    for folder, height in (("here", 0.0), ("there", 1.0)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "heights.txt").write_text(f"0 0\n0 {height}\n")
    text = f"""
import os, sys
from contactsnes.commands.cli import main
from contactsnes.system.processes import launched
second = launched()[1] == 1
os.chdir({file!r} if second else "here")
sys.exit(main(["run", *{PLANE!r}, "-scene_geometry", "file", "-scene_geometry_file",
               "heights.txt", *({more!r} if second else [])]))"""
    refused(program(2, text, tmp_path), *words)


@together
@pytest.mark.parametrize("rank, status", [(0, 0), (1, 2)])
def test_options_of_one_environment_are_those_of_all_or_told(rank, status, tmp_path):
    """PETSc hands on what the first process has, and would not look at what others have."""
    text = f"""
import os, sys
from contactsnes.commands.cli import main
from contactsnes.system.processes import launched
if launched()[1] == {rank}:
    os.environ["PETSC_OPTIONS"] = "-snes_atol 1e-7"
sys.exit(main(["info", *{PLANE!r}]))"""
    done = program(2, text, tmp_path)
    assert done.returncode == status, done
    if status:
        refused(done, "process 2 of 2 differs from the first one: PETSC_OPTIONS is -snes_atol 1e-7 "
                "there and not given in the first")


@together
@pytest.mark.parametrize("second", (["info"], ["run", "-help"], ["plot"]))
def test_processes_with_other_commands_are_told(second, tmp_path):
    text = f"""
import sys
from contactsnes.commands.cli import main
from contactsnes.system.processes import launched
sys.exit(main([*({second!r} if launched()[1] else ["run"]), *{PLANE!r}]))"""
    refused(program(2, text, tmp_path), "process 2 of 2", " ".join(second),
            "and run in the first")


def test_a_launcher_without_packages_is_refused(monkeypatch):
    monkeypatch.setattr(starting, "launched", lambda: (2, 0))
    monkeypatch.setattr(starting, "missing", lambda: ["mpi4py"])
    with pytest.raises(InputError, match="2 processes.*mpi4py"):
        starting.assemble("run", [])
    monkeypatch.setattr(starting, "launched", lambda: (2, 1))
    with pytest.raises(SystemExit) as stop:
        starting.assemble("run", [])
    assert stop.value.code == 0


def test_processes_that_mpi_does_not_know_of_are_refused(monkeypatch):
    """A launcher of another MPI than mpi4py's starts processes that are each alone."""
    monkeypatch.setattr(starting, "launched", lambda: (2, 0))
    monkeypatch.setattr(starting, "missing", lambda: [])
    monkeypatch.setattr(starting.world, "join", lambda: None)
    with pytest.raises(InputError, match="MPI knows of 1"):
        starting.assemble("run", [])


def test_files_of_a_scene_are_found(tmp_path):
    law = tmp_path / "law.py"
    law.write_text("")
    given = {"scene_law": f"{law}:Law", "scene_geometry_file": str(law), "archive_file": str(law),
             "scene_points": "32"}
    assert starting._files_of_scene(given) == {"scene_law": str(law),
                                               "scene_geometry_file": str(law)}
