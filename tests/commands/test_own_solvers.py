"""Classes of one's own that options of PETSc's solvers name: those that cannot be solvers, or fail,
are told in one sentence."""

import sys

import petsc4py
import pytest

petsc4py.init([])

from contactsnes.commands import cli  # noqa: E402
from contactsnes.output.reading import read  # noqa: E402

SCENE = ["run", "-scene_points", "128", "-scene_period", "20", "-scene_normal_maugis", "1",
         "-load_path", "normal_displacement=0.5"]
MODULE = """
import sys


class Fine:
    def apply(self, pc, x, y):
        x.copy(y)


class Failing:
    def solve(self, snes, b, x):
        raise ValueError("no idea")


class Leaving:
    def solve(self, snes, b, x):
        sys.exit(3)


class Late:
    calls = 0

    def apply(self, pc, x, y):
        Late.calls += 1
        if Late.calls > 40:
            raise RuntimeError("too often")
        x.copy(y)


class Misspelt:
    def slove(self, snes, b, x):
        pass


class Short:
    def solve(self, snes):
        pass

    def apply(self, pc, x):
        pass


class Static:
    @staticmethod
    def apply(pc, x, y):
        x.copy(y)


class Asking:
    def __init__(self, size):
        self.size = size

    def solve(self, snes, b, x):
        pass


def function():
    return Fine()
"""
SNES, PC = ([f"-{kind}_type", "python", f"-{kind}_python_type"] for kind in ("snes", "pc"))


@pytest.fixture
def folder(tmp_path, monkeypatch, kept_options):
    """The working folder, from which Python imports modules of a user's own."""
    (tmp_path / "solvers_of_mine.py").write_text(MODULE, encoding="utf-8")
    (tmp_path / "broken_solvers.py").write_text("def f(:\n", encoding="utf-8")
    (tmp_path / "importing_solvers.py").write_text("import nowhere\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    sys.modules.pop("solvers_of_mine", None)  # what it counts begins anew


@pytest.mark.parametrize("options, name, words", (
    (SNES, "solvers_of_mine.Failing", "its solve fails (ValueError: no idea; line 12 of the file)"),
    (SNES, "solvers_of_mine.Leaving", "its solve fails (SystemExit: 3; line 17 of the file)"),
    (SNES, "solvers_of_mine.Misspelt", "has no solve and no step"),
    (SNES, "solvers_of_mine.Asking", "which takes (size), but is called without arguments"),
    (SNES, "solvers_of_mine.Short", "whose solve takes (self, snes), but is called as solve("),
    (PC, "solvers_of_mine.Short", "whose apply takes (self, pc, x), but is called as apply(pc, x"),
    (SNES, "solvers_of_mine.Failling", "did you mean solvers_of_mine.Failing?"),
    (SNES, "solvers_of_mine.Other", "solvers_of_mine has no class Other: it has Failing, "),
    (SNES, "string.Other", "string has no class Other, nor any that is a solver"),
    (SNES, "json.Other", "json has no class Other, nor any that is a solver"),
    (SNES, "nowhere.Solver", "Python finds no module nowhere: name MODULE.CLASS, and the folder"),
    (SNES, "contactsnes.solvers.fire.Fire", "compare lists, name those of this program"),
    (SNES, "importing_solvers.Any", "whose module cannot be imported (No module named 'nowhere')"),
    (SNES, "solvers_of_mine", "has no solve and no step"),
    (SNES, "./solvers_of_mine.py:Failing", "allowed is MODULE.CLASS"),
    (SNES, "broken_solvers.Any", "whose module fails (SyntaxError"),
    (PC, "solvers_of_mine.Failing", "has no apply"),
))
def test_what_cannot_be_a_solver_or_fails_is_told(folder, capsys, options, name, words):
    assert cli.main([*SCENE, *options, name]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1 and words in told[0]
    assert told[0].startswith(f"contactsnes: error: {options[-1]} is '{name}'")


@pytest.mark.parametrize("name", ("Fine", "Static", "function"))
def test_a_preconditioner_of_ones_own_is_taken(folder, name):
    assert cli.main([*SCENE, *PC, f"solvers_of_mine.{name}"]) == 0


def test_what_fails_later_keeps_the_points_before(folder, capsys):
    asked = [*SCENE, *PC, "solvers_of_mine.Late", "-archive_file", "run.h5"]
    assert cli.main(asked) == 1
    assert "its apply fails (RuntimeError: too often" in capsys.readouterr().err
    assert read("run.h5").points > 1
