"""What a run imports, and what it does not."""

import subprocess
import sys

import pytest
from processes import ENVIRONMENT

UNUSED = ("scipy.optimize", "scipy.interpolate", "h5py", "matplotlib", "tqdm", "slepc4py",
          "contactsnes.compare", "contactsnes.reference", "contactsnes.output.figures",
          "contactsnes.interface.unbounded")
"""What is slow to import and serves no plain run."""
RUN = ["run", "-scene_points", "256", "-scene_normal_maugis", "1", "-load_path",
       "normal_displacement=0.1"]


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    """The names of all modules after a run of a small scene."""
    code = ("import sys; from contactsnes.commands.cli import main; "
            f"assert main({RUN!r}) == 0; print(*sys.modules)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                          cwd=tmp_path_factory.mktemp("run"), env=ENVIRONMENT)
    return done.stdout.splitlines()[-1].split()


@pytest.mark.parametrize("name", UNUSED)
def test_a_plain_run_does_not_import(name, imported):
    assert name not in imported


SEVERAL = """
from contactsnes import read
from contactsnes.commands.cli import main

LINE = ["run", "-scene_points", "128", "-scene_period", "20", "-scene_normal_maugis", "1"]
assert main([*LINE, "-load_path", "normal_displacement=0.1", "-archive_file", "one.h5",
             "-snes_max_it", "40", "-scene_rough_seed", "3"]) == 0
assert main([*LINE, "-load_path", "normal_displacement=0.2", "-archive_file", "two.h5",
             "-options_file", "late.yaml"]) == 2
assert main([*LINE, "-load_path", "normal_displacement=0.2", "-archive_file", "two.h5"]) == 0
for name in ("one", "two"):
    found = read(name + ".h5")
    print(found["normal_displacement"][-1], "snes_max_it 40" in found.options,
          "rough_seed" in found.options, "snes_max_funcs 5000" in found.options)
"""
"""Two commands of a program, and one that PETSc could do at its start only."""


@pytest.mark.parametrize("before, kept", (("", "False"), (
    "import petsc4py; petsc4py.init(['x', '-snes_max_funcs', '5000']); from petsc4py import PETSc",
    "True")))
def test_each_command_of_a_program_has_its_own_options(tmp_path, before, kept):
    """Whoever has started PETSc, and with which options: those stay."""
    (tmp_path / "late.yaml").write_text("snes_max_it: 3\n", encoding="utf-8")
    done = subprocess.run([sys.executable, "-c", before + SEVERAL], capture_output=True, text=True,
                          check=True, cwd=tmp_path, env=ENVIRONMENT)
    assert done.stdout.splitlines()[-2:] == [f"0.1 True True {kept}", f"0.2 False False {kept}"]
    assert "'late.yaml', which PETSc reads as it starts" in done.stderr


def test_what_petsc_looks_at_as_it_starts_is_told(tmp_path):
    code = f"import petsc4py.PETSc; from contactsnes.commands.cli import main; main({RUN!r})"
    done = subprocess.run([sys.executable, "-c", code.replace("'run'", "'run', '-log_view'")],
                          capture_output=True, text=True, check=True, cwd=tmp_path,
                          env=ENVIRONMENT)
    assert "warning: -log_view: PETSc looks at that as it starts" in done.stderr
