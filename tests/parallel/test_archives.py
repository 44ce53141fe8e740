"""Archives of several processes: those of one, whoever goes on with them."""

import h5py
import numpy as np
import pytest
from ranks import SIZES, command, program, together

from contactsnes.output.reading import read

PLANE = ("-scene_dimension", "2", "-scene_points", "16,24", "-scene_period", "20,30",
         "-scene_geometry", "sphere", "-scene_normal_maugis", "1", "-snes_atol", "1e-11",
         "-continuation_initial_step", "0.5",
         "-contact_symmetry", "off", "-contact_window", "off", "-load_start",
         "normal_displacement=-2", "-archive_file", "run.h5")
PATH = "normal_displacement=0; tangential_displacement_x=1"
ONE_MIRROR = ("-scene_poisson", "0.3", "-contact_symmetry", "auto", "-contact_window", "auto")
"""States that have the mirror across the load alone."""
MEASURED = {"wall_time"}


def words_of(fields="all", on="cell", precision="double", path=PATH):
    """The words of a run on the plane.

    Parameters
    ----------
    fields, on, precision : str
        Of the archive.
    path : str
        The load path.
    """
    return [*PLANE, "-archive_fields", fields, "-archive_fields_on", on, "-archive_precision",
            precision, "-load_path", path]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The archive of one process that runs a scene, made once."""
    known = {}

    def archive(*words):
        if words not in known:
            folder = tmp_path_factory.mktemp("alone")
            done = command(1, "run", *words, folder=folder)
            assert done.returncode == 0, done
            known[words] = folder / "run.h5"
        return known[words]

    return archive


def differences(first, second, most=1e-8):
    """Names of the datasets of floating-point numbers in which two files differ by more than
    rounding, or another part, beside what is measured."""
    found, names = [], []
    with h5py.File(first, "r") as one, h5py.File(second, "r") as other:
        one.visititems(lambda name, item: names.append(name)
                       if isinstance(item, h5py.Dataset) and item.dtype.kind in "fc" else None)
        for name in names:
            here, there = one[name][()], other[name][()]
            assert here.shape == there.shape, name
            near = np.allclose(here, there, rtol=most, atol=0.1 * most, equal_nan=True)
            if not near and name.rpartition("/")[2] not in MEASURED:
                found.append(name)
    return found


@together
@pytest.mark.parametrize("size, on", [*zip(SIZES, ["cell", "active"])])
def test_an_archive_is_that_of_one_process(size, on, alone, tmp_path):
    done = command(size, "run", *words_of(on=on), folder=tmp_path)
    assert done.returncode == 0, done
    files = alone(*words_of(on=on)), tmp_path / "run.h5"
    assert read(files[0]).points == read(files[1]).points > 5
    assert read(files[1]).complete
    assert not set(differences(*files)) - {"branch/transforms", "branch/residual_norm",
                                           "branch/largest_residual", "branch/linear_iterations"}


IN_BLOCKS = """
import sys
from contactsnes.commands.cli import main
from contactsnes.grid import parted
from contactsnes.output import layout

parted.SMALL, parted.BLOCK = {small}, {block}
given = layout.pieces  # but of zeros, thousands of bytes
layout.pieces = lambda shape: given(shape) if len(shape) > 1 else [slice(None)]
sys.exit(main(["run", *{words!r}]))"""


@together
@pytest.mark.parametrize("fields, on, precision, small", [
    ("all", "cell", "single", 0), pytest.param("all", "active", "double", 0,
                                              marks=pytest.mark.study),
    ("last", "active", "single", 1000)])
def test_an_archive_that_is_written_in_blocks_is_the_same(fields, on, precision, small, alone,
                                                          tmp_path):
    """Blocks of several rows, and of less than one; the file is made anew, resumed and packed."""
    for size, block, path in ((3, 150, PATH.split(";")[0]), (2, 20, PATH)):
        words = [*words_of(fields, on, precision, path), "-archive_resume"]
        text = IN_BLOCKS.format(small=small, block=block, words=words)
        done = program(size, text, tmp_path)
        assert done.returncode == 0, done
    files = alone(*words_of(fields, on, precision)), tmp_path / "run.h5"
    one, other = map(read, files)
    assert other.complete and one.points == other.points > 5
    # (numbers of seven digits, and what is beside a limit of nothing)
    assert not set(differences(*files, 1e-6 if precision == "single" else 1e-8)) - {
        "branch/transforms", "branch/residual_norm", "branch/largest_residual",
        "branch/linear_iterations"}
    for point, state in one.states().items():
        np.testing.assert_allclose(other.states()[point]["displacement"], state["displacement"],
                                   rtol=1e-8, atol=1e-9)
    for point in one.field_points:  # checksums hold
        np.testing.assert_allclose(*(each.field("displacement", point) for each in (one, other)),
                                   rtol=1e-6, atol=1e-7)


@together
@pytest.mark.parametrize("sizes, more, path", [
    pytest.param((2, 3), (), PATH, marks=pytest.mark.study), ((3, 1), (), PATH),
    ((2, 3), ONE_MIRROR, "normal_displacement=0; tangential_displacement_x=0.5; "
     "tangential_displacement_x=1")])
def test_another_number_of_processes_goes_on(sizes, more, path, alone, tmp_path):
    (first, second), words = sizes, [*words_of(path=path), *more]
    begun = command(first, "run", *words_of(path=path.rpartition(";")[0]), *more, folder=tmp_path)
    assert begun.returncode == 0, begun.stderr
    known = read(tmp_path / "run.h5").points
    done = command(second, "run", *words, "-archive_resume", folder=tmp_path)
    assert done.returncode == 0, done
    assert f"after point {known} of" in done.stdout
    archive, whole = read(tmp_path / "run.h5"), read(alone(*words))
    assert archive.complete
    if more:  # the iterations of one process
        for name in ("nonlinear_iterations", "linear_iterations"):
            np.testing.assert_array_equal(archive[name], whole[name])
    for name in ("normal_force", "tangential_force_x", "contact_area"):
        assert archive[name][-1] == pytest.approx(whole[name][-1], rel=1e-7)


@together
@pytest.mark.parametrize("size", [1, pytest.param(2, marks=pytest.mark.study)])
def test_states_on_the_laws_nodes_go_on_as_even_ones(size, alone, tmp_path):
    """Several processes have states without mirror images on these nodes alone."""
    begun, auto = words_of(path="normal_displacement=0"), ("-contact_symmetry", "auto")
    words = [*words_of(path="normal_displacement=0; normal_displacement=1"), *auto,
             "-contact_window", "auto"]
    done = command(2, "run", *begun, "-contact_window", "auto", folder=tmp_path)
    assert done.returncode == 0, done
    assert all("window_nodes" in state for state in read(tmp_path / "run.h5").states().values())
    done = command(size, "run", *words, "-archive_resume", folder=tmp_path)
    assert done.returncode == 0 and "without symmetry" not in done.stdout, done
    archive, whole = read(tmp_path / "run.h5"), read(alone(*words))
    for name in ("normal_force", "contact_area"):
        assert archive[name][-1] == pytest.approx(whole[name][-1], rel=1e-7)


@together
def test_fields_in_parts_are_kept_beside_states_that_one_process_has_as_a_whole(tmp_path):
    """Of even states, as a quarter."""
    done = command(2, "run", "-scene_dimension", "2", "-scene_geometry", "sphere",
                   "-scene_points", "96", "-scene_period", "8", "-scene_normal_maugis", "2",
                   "-load_start", "normal_displacement=0", "-load_path", "normal_displacement=0.4",
                   "-archive_fields", "all", "-archive_file", "run.h5", folder=tmp_path)
    assert done.returncode == 0, done
    archive = read(tmp_path / "run.h5")
    assert archive.complete and archive.points > 1


@together
def test_an_archive_in_the_way_is_refused_once(tmp_path):
    (tmp_path / "run.h5").write_text("mine")
    done = command(2, "run", *PLANE, "-load_path", PATH, folder=tmp_path)
    assert done.returncode == 2 and len(done.told) == 1 and "run.h5" in done.told[0]
    assert (tmp_path / "run.h5").read_text() == "mine"
