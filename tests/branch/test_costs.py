"""What a run costs, told beforehand: points, memory, disk and time, beside what runs take."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import petsc4py
import pytest
from processes import call

petsc4py.init([])

from contactsnes.branch import costs  # noqa: E402
from contactsnes.branch.memory import memory_of_solve  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.options.values import instance  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import (  # noqa: E402
    OPTION_CLASSES,
    Form,
    Output,
    Scene,
    Steps,
)

SPHERE = Scene(dimension=2, geometry="sphere", normal_maugis=40.0, tangential_maugis=2.0,
               period=12.0, points=512)
SHEARED = Load(path="normal_force=5; tangential_displacement_x=20")


def test_costs_grow_with_the_grid_and_the_fields():
    cell, active = (Output(file="x.h5", fields="all", fields_on=on) for on in ("cell", None))
    small, large = (costs.cost(SPHERE, SHEARED, (n, n), cell) for n in (128, 256))
    on_active = costs.cost(SPHERE, SHEARED, (256, 256), active)
    assert 3.9 < large.disk / small.disk < 4.1
    finest = costs.cost(SPHERE, SHEARED, (512, 512), cell)
    assert 3.5 < finest.seconds / large.seconds < 5
    assert large.disk == pytest.approx(8 * 6 * 256 ** 2 * large.points, rel=5e-2)
    assert 0.02 * large.disk < on_active.disk < 0.5 * large.disk
    assert costs.cost(SPHERE, SHEARED, (128, 128)).disk == 0.0
    coupled = costs.cost(replace(SPHERE, poisson=0.3), SHEARED, (256, 256), active)
    assert 1.5 * on_active.disk < coupled.disk < 4 * on_active.disk


def test_points_follow_from_the_steps():
    load = Load(path="normal_force=hold; normal_force=5; normal_force=15")
    steps = Steps(largest_step=0.5)
    assert costs.cost(SPHERE, load, (64, 64), steps=steps).points == 1 + 22 + 24
    # what was held otherwise may be elsewhere after a leg that moved something
    load = Load(start="normal_displacement=1",
                path="normal_force=hold; tangential_displacement_x=1; normal_displacement=1")
    assert costs.cost(SPHERE, load, (64, 64)).points == 1 + 22 + 22
    si = Scene.typed(units="si", dimension=2, geometry="sphere", radius=9.42e-3, young_modulus=1e6,
                     work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
                     adhesive_strength=2e4, shear_strength=3e4)
    typed = Load(path="normal_force=1e-3; normal_force=2e-3; tangential_displacement_x=1e-5")
    steps = Steps(largest_step=(1e-4, 5.1e-5, 5.1e-7))
    assert costs.cost(si, typed, (64, 64), steps=steps).points == 1 + 22 + 24 + 24


@pytest.mark.parametrize("path, points", [
    ("normal_displacement=1", 0), ("normal_force=hold; normal_displacement=hold", 0),
    ("normal_displacement=1, tangential_displacement_x=0; normal_displacement=hold", 0),
    ("normal_force=hold; normal_displacement=1", 0),
    ("normal_displacement=hold, tangential_displacement_x=1", 22),
    ("normal_displacement=1, tangential_displacement_x=1; tangential_displacement_x=hold; "
     "tangential_displacement_x=1", 22)])
def test_legs_that_move_nothing_have_no_points(path, points):
    """Nor where spots of a rough plane would jump."""
    load = Load(start="normal_displacement=1", path=path)
    assert costs.cost(SPHERE, load, (64, 64)).points == 1 + points
    rough = replace(SPHERE, geometry="rough", rough_slope=0.1, rough_shortest=3.0)
    assert costs.cost(rough, load, (64, 64)).points == 1 + points


LINE = "-scene_points 512 -scene_period 40 -scene_normal_maugis 2 -scene_height 30 "
PLANE = "-scene_dimension 2 -scene_points 64 -scene_normal_maugis 1.5 -scene_height inf "
MEASURED = {
    "pressed": LINE + "-load_path normal_force=8",
    "sheared": LINE + "-load_path normal_force=8;tangential_displacement=80 -load_stop "
    "gross_sliding",
    "pulled": LINE + "-load_path normal_displacement=3;normal_displacement=-5 -load_stop pull_off",
    "sphere": PLANE + "-scene_geometry sphere -scene_period 12 -load_path normal_force=4",
    "sheared sphere": PLANE + "-scene_geometry sphere -scene_period 12 -load_path "
    "normal_force=4;tangential_displacement_x=12 -load_stop gross_sliding",
    "rough": PLANE + "-scene_geometry rough -scene_period 12 -scene_rough_slope 0.3 "
    "-scene_rough_shortest 1.5 -load_path normal_force=4",
}
TOLD = re.compile(r"cost, about: (\d+) points, (\S+) MB of memory, (\S+) (kB|MB) of disk")


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=pytest.mark.study if name in ("pressed", "sphere") else ())
    for name in MEASURED])
def test_points_and_disk_are_told_within_a_factor_of_two(tmp_path, name):
    """Memory and time are of the machine: scripts/costs."""
    words = [*MEASURED[name].split(), "-archive_file", "run.h5", "-archive_fields", "all"]
    found = TOLD.search(call("info", *words, folder=tmp_path).stdout)
    assert call("run", *words, folder=tmp_path).returncode == 0
    with h5py.File(tmp_path / "run.h5") as file:
        taken = file.attrs["points"]
    assert 0.5 < int(found[1]) / taken < 2.0
    size = float(found[3]) * {"kB": 1e3, "MB": 1e6}[found[4]]
    assert 0.5 < size / (tmp_path / "run.h5").stat().st_size < 2.0


KEPT = {"pressed": ["-archive_fields none", "-archive_fields last", "-archive_fields all",
                    "-archive_fields last -archive_fields_on active", "-archive_fields all "
                    "-archive_precision single", "-archive_fields none "
                    "-continuation_largest_step 0.1", "-archive_fields all "
                    "-continuation_stability eigenvalue"],
        "sphere": ["-archive_fields none", "-archive_fields last", "-archive_fields all",
                   "-archive_fields all -archive_fields_on cell",
                   "-archive_fields last -archive_precision single"]}
OTHERS = [("pressed", "-archive_fields last"), ("sphere", "-archive_fields none"),
          ("sphere", "-archive_fields last"), ("pressed", "-archive_fields all")]
"""Each of what is kept is that of the other scene, too, or of a case with something besides."""


@pytest.mark.parametrize("name, kept", [
    pytest.param(name, kept, marks=pytest.mark.study if (name, kept) in OTHERS else ())
    for name in KEPT for kept in KEPT[name]])
def test_the_size_of_an_archive_follows_from_its_points(tmp_path, monkeypatch, name, kept):
    """To a tenth; a small archive took ten times what was told: rooms, columns and states of a file
    besides its numbers."""
    words = [*MEASURED[name].split(), *kept.split(), "-archive_file", str(tmp_path / "run.h5")]
    assert call("run", *words, folder=tmp_path).returncode == 0
    with h5py.File(tmp_path / "run.h5") as file:
        legs = file["branch/leg"][:]
    entries = {word[1:]: value for word, value in zip(words[::2], words[1::2])}
    scene, form, load, steps, output = [instance(cls, entries) for cls in OPTION_CLASSES]
    monkeypatch.setattr(costs, "_points", lambda *_: list(np.bincount(legs)))
    told = costs.cost(scene, load, scene.shape, output, steps, form).disk
    assert told == pytest.approx((tmp_path / "run.h5").stat().st_size, rel=0.1)


@pytest.mark.parametrize("count, text", [(7.72e5, "772 kB"), (2.04e4, "20 kB"),
                                         (1.55e6, "1.6 MB"), (1.21e8, "121 MB"), (3e9, "3 GB")])
def test_bytes_are_told_without_powers_of_ten(count, text):
    assert costs.in_bytes(count) == text


def test_what_a_form_leaves_out_is_counted():
    """Mirror images, a window, and certificates of errors: less is less."""
    scene, load = replace(SPHERE, normal_maugis=3.0, period=40.0), Load(path="normal_force=5")
    usual = costs.cost(scene, load, (512, 512))
    whole = costs.cost(scene, load, (512, 512), form=Form(symmetry="off", window="off"))
    own = usual.memory - costs.RUNNING
    assert whole.seconds > 3 * usual.seconds and whole.memory - costs.RUNNING > 3 * own
    errors = costs.cost(scene, load, (512, 512), Output(errors=True))
    assert errors.seconds > 1.5 * usual.seconds and errors.memory - costs.RUNNING > 3 * own


def test_a_rough_sphere_costs_what_its_sphere_touches():
    """Its fields are those of the smooth one's contact, not of the cell; no rough flat is."""
    rough = Scene(dimension=2, geometry="rough", rough_slope=0.2, rough_shortest=1.0, period=40.0,
                  points=256, normal_maugis=2.0)
    kept, load = Output(file="x.h5", fields="all"), Load(path="normal_force=5")
    on_sphere, on_flat = (costs.cost(replace(rough, rough_on=what), load, (256, 256), kept)
                          for what in ("sphere", "flat"))
    assert on_sphere.disk < 0.3 * on_flat.disk


MEMORY = """
import ctypes, re, sys, petsc4py
petsc4py.init([])
from contactsnes import Branch, Load, Scene, Steps

def held(name):
    return 1024 * int(re.search(name + r":\\s+(\\d+)", open("/proc/self/status").read())[1])

def begun():
    getattr(ctypes.CDLL(None), "malloc_trim", int)(0)  # what lies idle is not held
    return held("VmRSS")
"""
"""How a process tells its memory: at the begin, and the most."""

ROUGH = MEMORY + """
def run(points, start, path, slope):
    scene = Scene(dimension=2, points=points, period=24.0, geometry="rough", rough_on="flat",
                  rough_slope=slope, rough_longest=6.0, rough_shortest=0.75, normal_maugis=2.0,
                  tangential_maugis=1.0, residual_friction=0.5, height=float("inf"))
    step = 0.1 if slope > 2.0 or "tangential" in path else 0.01
    few = Steps(initial_step=step, largest_step=step)
    jumps = 0
    for point in Branch(scene, Load(start=start, path=path), few):
        assert points < 256 or point.state.window.is_whole
        jumps += point.event == "jump"
    return jumps

points, start, path, slope = int(sys.argv[1]), *sys.argv[2:4], float(sys.argv[4])
run(64, start, path, slope)
before = begun()
jumps = run(points, start, path, slope)
print((held("VmHWM") - before) / 8 / points ** 2, jumps)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no /proc")
@pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
@pytest.mark.parametrize("points, start, path, slope, components, most", [
    (384, 1, "normal_displacement=1.4", 6.0, 1, 23.0),
    (384, 1, "normal_displacement=1.1; tangential_displacement_x=0.2", 6.0, 3, 55.0),
    pytest.param(512, 0.3, "normal_displacement=0.36", 2.0, 1, 24.0, marks=pytest.mark.study),
    pytest.param(256, 1.5, "tangential_displacement_x=0.7", 2.0, 3, 80.0, marks=pytest.mark.study)])
def test_memory_of_a_rough_plane(points, start, path, slope, components, most):
    """Where the law acts on all nodes, in arrays of these: measured 20, 47, and, where linear
    solves are long and a spot jumps, 20, and of three components 56, with PETSc 3.18; 19, 51, 19
    and 71 with PETSc 3.26 and NumPy 2; more is told, for solves of 20 iterations, and of 30."""
    arguments = [str(points), f"normal_displacement={start}", path, str(slope)]
    done = subprocess.run([sys.executable, "-c", ROUGH, *arguments], capture_output=True,
                          text=True, timeout=300, check=True)
    nodes, (held, jumps) = components * points ** 2, done.stdout.split()
    hard = {"iterations": costs.ITERATIONS} if slope < 6.0 else {}
    told = memory_of_solve(nodes, nodes, **hard) / 8 / points ** 2
    assert (int(jumps) > 0) is (slope < 6.0)
    assert 0.4 * told < float(held) < min(most, told)


EVEN = MEMORY + """
def run(points):
    scene = Scene(dimension=2, points=points, period=12.0, geometry="sphere", normal_maugis=8.0)
    for point in Branch(scene, Load("normal_displacement=1", "normal_displacement=1.1")):
        assert point.state.half is not None
    return point.state.window.total / points ** 2

run(128)
before = begun()
part = run(512)
print((held("VmHWM") - before) / 8 / 512 ** 2, part)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no /proc")
@pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
def test_memory_of_an_even_plane():
    """Where a quarter of nearly all nodes is solved, in arrays of the cell: measured 12. What the
    first point asks of all nodes, and of the grid before, is not kept."""
    done = subprocess.run([sys.executable, "-c", EVEN], capture_output=True, text=True,
                          timeout=300, check=True)
    held, part = map(float, done.stdout.split())
    assert part > 0.5 and held < 16.0
