"""What a run imports, and what it does not."""

import subprocess
import sys

import pytest
from processes import ENVIRONMENT

UNUSED = ("scipy.optimize", "scipy.interpolate", "h5py", "matplotlib", "tqdm", "argparse",
          "slepc4py", "contactsnes.compare", "contactsnes.reference", "contactsnes.output.figures",
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
