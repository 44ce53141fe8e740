"""Archives of several processes: those of one, whoever goes on with them."""

import h5py
import numpy as np
import pytest
from ranks import SIZES, command, together

from contactsnes.output.reading import read

PLANE = ("-scene_dimension", "2", "-scene_points", "32,48", "-scene_period", "20,30",
         "-scene_geometry", "sphere", "-scene_normal_maugis", "1", "-snes_atol", "1e-11",
         "-contact_symmetry", "off", "-contact_window", "off", "-load_start",
         "normal_displacement=-2", "-archive_file", "run.h5", "-archive_fields", "all")
PATH = "normal_displacement=0; tangential_displacement_x=1"
MEASURED = {"wall_time"}


def differences(first, second):
    """Names of the datasets of floating-point numbers in which two files differ by more than
    rounding, beside what is measured."""
    found, names = [], []
    with h5py.File(first, "r") as one, h5py.File(second, "r") as other:
        one.visititems(lambda name, item: names.append(name)
                       if isinstance(item, h5py.Dataset) and item.dtype.kind in "fc" else None)
        for name in names:
            here, there = one[name][()], other[name][()]
            assert here.shape == there.shape, name
            near = np.allclose(here, there, rtol=1e-8, atol=1e-9, equal_nan=True)
            if not near and name.rpartition("/")[2] not in MEASURED:
                found.append(name)
    return found


@together
@pytest.mark.parametrize("size, on", zip(SIZES, ["cell", "active"]))
def test_an_archive_is_that_of_one_process(size, on, tmp_path):
    for folder, count in (("one", 1), ("many", size)):
        (tmp_path / folder).mkdir()
        done = command(count, "run", *PLANE, "-load_path", PATH, "-archive_fields_on", on,
                       folder=tmp_path / folder)
        assert done.returncode == 0, done.stderr
    files = [tmp_path / folder / "run.h5" for folder in ("one", "many")]
    assert read(files[0]).points == read(files[1]).points > 5
    assert read(files[1]).complete
    assert not set(differences(*files)) - {"branch/transforms", "branch/residual_norm",
                                           "branch/largest_residual", "branch/linear_iterations"}


@together
@pytest.mark.parametrize("sizes", [(2, 3), (3, 1)])
def test_another_number_of_processes_goes_on(sizes, tmp_path):
    first, second = sizes
    begun = command(first, "run", *PLANE, "-load_path", PATH.split(";")[0], folder=tmp_path)
    assert begun.returncode == 0, begun.stderr
    known = read(tmp_path / "run.h5").points
    done = command(second, "run", *PLANE, "-load_path", PATH, "-archive_resume", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert f"after point {known} of" in done.stdout
    assert read(tmp_path / "run.h5").complete
    (tmp_path / "whole").mkdir()
    command(1, "run", *PLANE, "-load_path", PATH, folder=tmp_path / "whole")
    with h5py.File(tmp_path / "run.h5", "r") as file, h5py.File(tmp_path / "whole" / "run.h5",
                                                              "r") as whole:
        for name in ("normal_force", "tangential_force_x", "contact_area"):
            assert file["branch"][name][-1] == pytest.approx(whole["branch"][name][-1], rel=1e-7)


@together
def test_an_archive_in_the_way_is_refused_once(tmp_path):
    (tmp_path / "run.h5").write_text("mine")
    done = command(2, "run", *PLANE, "-load_path", PATH, folder=tmp_path)
    assert done.returncode == 2 and len(done.told) == 1 and "run.h5" in done.told[0]
    assert (tmp_path / "run.h5").read_text() == "mine"
