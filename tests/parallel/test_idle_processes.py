"""More processes than a plane has rows: those beyond have nothing to do, and the others do all as
before."""

import h5py
import numpy as np
import pytest
import test_even_slabs
import test_shared_forms
import test_slabs
from ranks import command, program, say, together
from test_archives import differences

from contactsnes.kernels import library
from contactsnes.output.reading import read

IDLE = """
import sys
from contactsnes.grid import slab_transform


def share(total, rank, size, given=slab_transform.share):
    # the last process has nothing, of however many rows and columns there are
    return given(total, rank, size - 1) if rank < size - 1 else slice(total, total)


given = slab_transform.share
for module in list(sys.modules.values()):
    if getattr(module, "share", None) is given:
        module.share = share
"""
COMMAND = """
import sys
from contactsnes.commands.cli import main
sys.exit(main({words!r}))
"""
ROUGH = ("-scene_dimension", "2", "-scene_points", "16", "-scene_period", "6", "-scene_height",
         "inf", "-scene_geometry", "rough", "-scene_rough_on", "sphere", "-scene_rough_hurst",
         "0.8", "-scene_rough_slope", "0.2", "-scene_rough_longest", "4", "-scene_rough_shortest",
         "2", "-scene_rough_seed", "3", "-scene_normal_maugis", "3", "-scene_tangential_maugis",
         "1", "-snes_atol", "1e-11", "-continuation_initial_step", "0.5",
         "-continuation_largest_step", "1", "-archive_file", "run.h5", "-archive_fields", "all")
PULLED = "tangential_displacement_x=0.1; normal_displacement=-1.6"
SPHERE = ("-scene_dimension", "2", "-scene_points", "16", "-scene_period", "6", "-scene_geometry",
          "sphere", "-scene_normal_maugis", "2", "-load_path", "normal_displacement=0",
          "-archive_file", "run.h5", "-archive_fields", "all")


compiled = pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))


@together
@pytest.mark.parametrize("text", [
    pytest.param(test_slabs.PROGRAM, id="rows"), pytest.param(test_even_slabs.FIELDS, id="even"),
    pytest.param(test_even_slabs.FORMS, id="even forms", marks=compiled),
    pytest.param(test_shared_forms.PROGRAM, id="forms", marks=compiled)])
def test_fields_are_those_of_one_process(text, tmp_path):
    say(2, IDLE + text, tmp_path)


@together
def test_a_run_is_that_of_one_process(tmp_path):
    """Three components, certificates, a jump; begun by two processes of which one has nothing, and
    ended by one."""
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
    words = [*ROUGH, "-continuation_stability", "eigenvalue", "-load_start",
             "normal_displacement=-1.2", "-load_path"]
    done = command(1, "run", *words, PULLED, folder=tmp_path / "one")
    assert done.returncode == 0, done
    done = program(2, IDLE + COMMAND.format(words=["run", *words, PULLED, "-load_stop",
                                                   "pull_off"]), tmp_path / "two")
    assert done.returncode == 0, done
    assert done.stderr.count("1 of 2 processes have none") == 1
    files = [tmp_path / folder / "run.h5" for folder in ("one", "two")]
    with h5py.File(files[0], "r") as file:
        events = file["branch/event"]
        assert "jump" in np.array(events.attrs["names"])[events[()]]
    done = command(1, "run", *words, PULLED, "-archive_resume", folder=tmp_path / "two")
    assert done.returncode == 0, done
    one, other = map(read, files)
    assert one.points == other.points > 5 and other.complete
    for name in ("event", "stable", "unstable_modes"):
        assert np.array_equal(one[name], other[name]), name
    # (modes are sought to an accuracy of their own)
    assert not set(differences(*files, 1e-6)) - {"branch/leading_eigenvalue", "branch/transforms",
                                                 "fields/mode"}


@pytest.mark.study
@together
def test_processes_beyond_rows_are_told_of(tmp_path):
    for folder, size in (("one", 1), ("many", 17)):
        (tmp_path / folder).mkdir()
        done = command(size, "run", *SPHERE, folder=tmp_path / folder)
        assert done.returncode == 0, done
        told = done.stderr.count("of which 13 of 17 processes have none")
        assert told == (size > 1), done.stderr
    files = [tmp_path / folder / "run.h5" for folder in ("one", "many")]
    assert read(files[0]).points == read(files[1]).points == 1
    assert not set(differences(*files)) - {"branch/residual_norm", "branch/largest_residual",
                                           "branch/eccentricity"}  # (0, of rounding)
