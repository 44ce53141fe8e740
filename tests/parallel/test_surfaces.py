"""Gaps of several processes, each of its own rows, against those of one."""

import h5py
import numpy as np
import pytest
from ranks import SIZES, command, found, program, together

from contactsnes.output.reading import read

PROGRAM = """
import sys
import numpy as np
import petsc4py
petsc4py.init([])
from mpi4py import MPI
from contactsnes.branch.contacts import shared_grid
from contactsnes.contact.problem import Contact
from contactsnes.grid import slabs
from contactsnes.interface import heights, own_shapes, seams, shapes
from contactsnes.output import resuming
from contactsnes.scene.settings import Scene
from contactsnes.system.processes import world

slabs.GATHERED = 0
ROUGH = dict(geometry="rough", rough_slope=0.5, rough_longest=4.0, rough_shortest=0.6, rough_seed=3)
MENDED = dict(geometry="file", geometry_file="holes.txt", heights_fill="nearest",
              heights_edges="window", heights_fit="interpolate", points=(48, 40))
CASES = {"rough": ROUGH, "rough flat": dict(ROUGH, rough_on="flat", rough_rolloff=2.0),
         **{name: dict(geometry="file", geometry_file=name, heights_crop="2:44,0:32")
            for name in ("a.npy", "a.txt", "a.h5:h")}, "mended": MENDED,
         "own": dict(), "sphere": dict(geometry="sphere")}


def own(x, y):
    assert x.shape == (42, 32)  # all of them
    return x ** 2 + np.abs(y) - np.min(x ** 2 + np.abs(y))


def made(case, grid):
    scene = Scene.typed(**{"dimension": 2, "points": (42, 32), "period": (14.0, 10.0), **case})
    grid = shared_grid(scene) if grid else None
    return Contact(scene, grid=grid, geometry=own if not case else None)


def told(contact):
    shape, grid = shapes.of(contact.scene), contact.grid
    rows = shape.heights(contact.scene, grid)
    return [own_shapes.jumps(contact.scene, grid), *own_shapes.proportions(contact.scene, grid),
            rows is not None and resuming.checksum(grid, rows)]


alone = {name: made(case, False) for name, case in CASES.items()}
sentences = {name: told(contact) for name, contact in alone.items()}
heights.let_go()


def compare(name, case):
    shared = made(case, True)
    here = shared.grid.part_of(alone[name].initial_gap)
    assert shared.initial_gap.shape == here.shape != alone[name].initial_gap.shape, name
    assert np.allclose(shared.initial_gap, here, rtol=0.0, atol=1e-12), name
    jumps, *others = told(shared)
    assert others[-1] == sentences[name][-1], name
    assert np.allclose(others[:-1], sentences[name][1:-1], rtol=1e-12), name
    assert np.allclose(jumps, sentences[name][0], rtol=1e-9), name
    if name in ("a.npy", "rough"):  # all that may be said of the surface in several processes
        size = lambda value, unit, digits: f"{value:.9g}"
        assert (shapes.of(shared.scene).about(shared.scene, size)
                == shapes.of(alone[name].scene).about(alone[name].scene, size))


for name, case in CASES.items():
    compare(name, case)
world.join()  # as of a command
heights.let_go()
for name, case in CASES.items():
    compare(name, case)
sys.__stdout__.write("alike\\n") if not world.rank else None
"""


def files(folder):
    """Files of the same heights, of which a crop is periodic by chance only, and one with holes."""
    values = np.random.default_rng(5).normal(size=(46, 32)).cumsum(axis=1)
    np.save(folder / "a.npy", values)
    np.savetxt(folder / "a.txt", values, fmt="%.17g")
    with h5py.File(folder / "a.h5", "w") as file:
        file["h"] = values
    values[3:5, 7:9] = np.nan
    np.savetxt(folder / "holes.txt", values, fmt="%.17g")


@together
@pytest.mark.parametrize("size", SIZES)
def test_gaps_by_rows_are_those_of_one_process(size, tmp_path):
    """Of processes that are each alone otherwise, and then of those of a command."""
    files(tmp_path)
    done = program(size, PROGRAM, tmp_path)
    assert done.returncode == 0 and "alike" in done.stdout, done


HELD = """
import json
import tracemalloc
import numpy as np
import petsc4py
petsc4py.init([])
from mpi4py import MPI
from contactsnes.branch.contacts import shared_grid
from contactsnes.contact.problem import Contact
from contactsnes.interface import stored_heights
from contactsnes.scene.settings import Scene
from contactsnes.system.processes import world

world.join()
stored_heights.BLOCK = 2 ** 14
N = 512


def made(points, given):
    scene = Scene.typed(dimension=2, points=points, period=12.0, **given)
    return Contact(scene, grid=shared_grid(scene))


scenes = {"file": dict(geometry="file", geometry_file="large.npy"),
          "rough": dict(geometry="rough", rough_on="flat", rough_slope=0.5, rough_longest=4.0,
                        rough_shortest=0.16)}
made((32, 32), dict(scenes["rough"], rough_shortest=2.0))  # (what is imported counts, too)
made((32, 32), dict(scenes["file"], heights_fit="interpolate"))
held = {}
for name, given in scenes.items():
    tracemalloc.start()
    contact = made((N, N), given)
    held[name] = [part / (8 * N * N) for part in tracemalloc.get_traced_memory()]
    tracemalloc.stop()
    del contact
every = MPI.COMM_WORLD.gather(held)
if not world.rank:
    json.dump(every, open("found.json", "w"))
"""


@together
def test_no_process_makes_or_holds_a_surface_as_a_whole(tmp_path):
    """Of three, in arrays of the cell: held are the gap's rows and room of a transform."""
    np.save(tmp_path / "large.npy", np.random.default_rng(1).normal(size=(512, 512)))
    for process in found(3, HELD, tmp_path):
        assert process["file"][0] < 0.4 and process["rough"][0] < 1.4, process
        assert process["file"][1] < 1.1 and process["rough"][1] < 2.0, process


@together
def test_a_surface_that_the_first_process_cannot_have_ends_all(tmp_path):
    (tmp_path / "bad.txt").write_text("1 2 3 4\n1 2 3\n")
    (tmp_path / "own.py").write_text("def gap(x, y):\n    raise ValueError('no')\n")
    for geometry, more in (("file", ("-scene_geometry_file", "bad.txt")), ("own.py:gap", ())):
        done = command(2, "run", "-scene_dimension", "2", "-scene_points", "32", "-scene_geometry",
                       geometry, *more, "-load_path", "normal_force=1", folder=tmp_path)
        assert done.returncode == 2 and len(done.told) == 1, done


@together
@pytest.mark.parametrize("name", ("a.npy", "holes.txt"))
def test_runs_on_heights_are_those_of_one_process(name, tmp_path):
    files(tmp_path)
    for size in (1, 2):
        done = command(size, "run", "-scene_period", "14,10", "-scene_geometry", "file",
                       "-scene_geometry_file", name, "-scene_heights_fill", "nearest",
                       "-scene_normal_maugis", "1", "-load_start", "normal_displacement=-1",
                       "-load_path", "normal_displacement=-0.9", "-archive_file", f"{size}.h5",
                       folder=tmp_path)
        assert done.returncode == 0, done
    one, two = (read(tmp_path / f"{size}.h5") for size in (1, 2))
    assert one.scene["heights_sha256"] == two.scene["heights_sha256"]
    np.testing.assert_allclose(one["normal_force"], two["normal_force"], rtol=1e-7)
