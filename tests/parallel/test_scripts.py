"""Scripts in several processes: what they do as one does, and what is refused in a sentence."""

import pytest
from processes import call
from ranks import command, program, say, together

SPHERE = """
import copy
import pickle
import petsc4py
petsc4py.init([])
from petsc4py import PETSc
from contactsnes import Branch, Contact, InputError, Load, Scene, observe

rank = PETSc.COMM_WORLD.rank
scene = Scene(dimension=2, geometry="sphere", points=32, period=12.0, normal_maugis=2.0)
load = Load(path="normal_displacement=0.2")
"""


@pytest.fixture(scope="module")
def archives(tmp_path_factory):
    """A folder with archives of one process: fields on the cell and on active nodes."""
    folder = tmp_path_factory.mktemp("archives")
    for on in ("cell", "active"):
        done = call("run", "-scene_dimension", "2", "-scene_geometry", "sphere", "-scene_points",
                    "32", "-scene_period", "12", "-scene_normal_maugis", "2", "-load_path",
                    "normal_displacement=0.2", "-archive_file", f"{on}.h5", "-archive_fields",
                    "all", "-archive_fields_on", on, folder=folder)
        assert done.returncode == 0, done
    return folder


@together
def test_a_branch_begins_at_fields_of_an_archive(archives):
    say(2, """
import petsc4py
petsc4py.init([])
from contactsnes import Branch, read

for on in ("cell", "active"):
    record = read(f"{on}.h5")
    for place in (2, -1):  # of the second the state is kept, too
        first = next(iter(Branch.restart(record, "normal_displacement=0", place)))
        force = record["normal_force"][place]
        assert abs(first.forces[0] - force) < 1e-9 * abs(force), (first, force)
        assert first.spent["nonlinear_iterations"] == 0
print("alike", flush=True)
""", archives)


@together
def test_points_of_several_processes_are_theirs(tmp_path):
    """A contact made by hand is whole in each process: numbers of its rows were told as those of
    the points of a branch."""
    say(2, SPHERE + """
def refused(words, act, kind=InputError):
    try:
        act()
    except kind as error:
        assert words in str(error), error
        return
    raise AssertionError(words)


branch, whole = Branch(scene, load), Contact(scene)
point = next(iter(branch))
refused("point lies in rows of several processes, the contact in one process as a whole",
        lambda: observe(whole, point))
for through in (pickle.dumps, copy.deepcopy):
    refused("a point in several processes is neither pickled nor copied",
            lambda: through(point), TypeError)
area = Branch(scene, load, first=point.state).observe(point)["contact_area"]
assert area == branch.observe(point)["contact_area"] > 0.0
print("alike", flush=True)
""", tmp_path)


@together
@pytest.mark.parametrize("unlike, words", [
    ("scene = Scene(dimension=2, geometry='sphere', points=32, period=12.0 + 1e-3 * rank)",
     "-scene_period is 12.001,12.001 there and 12,12 in the first"),
    ("load = Load(path=f'normal_displacement={0.2 + 0.1 * rank:g}')",
     "-load_path is normal_displacement=0.3 there and normal_displacement=0.2 in the first"),
    ("PETSc.Options()['snes_atol'] = 1e-8 / (1 + rank)",
     "-snes_atol is 5e-09 there and 1e-08 in the first"),
    ("import os; os.environ['PETSC_OPTIONS'] = f'-snes_atol {rank}'",
     "PETSC_OPTIONS is -snes_atol 1 there and -snes_atol 0 in the first")])
def test_processes_with_other_scenes_are_told(unlike, words, tmp_path):
    """Each took its own numbers on its rows: forces that belong to no scene."""
    say(2, SPHERE + unlike + f"""
try:
    Branch(scene, load)
except InputError as error:
    assert "process 2 of 2 differs from the first one: {words}" in str(error), error
    print("alike", flush=True)
""", tmp_path)


@together
@pytest.mark.parametrize("end", ("Scene(poisson=0.6 if rank else 0.5)",
                                 "Branch(scene, load, law=Stiff())"))
def test_an_exception_before_there_is_a_branch_ends_all(end, tmp_path):
    done = program(2, SPHERE + """
import numpy as np
from contactsnes import Law


class Stiff(Law):
    def evaluate(self, gap, traction, tangent=None):
        if rank:
            raise InputError("of mine")
        if tangent is not None:
            tangent[...] = np.eye(len(gap))[:, :, None]
        return np.multiply(gap, 1.0, out=traction)


""" + end + """
print(list(Branch(scene, load)))
""", tmp_path, fresh=True)
    assert done.returncode == 1 and "InputError" in done.stderr


@together
def test_a_path_that_fails_says_why_as_in_one_process(tmp_path):
    """The sentence asks what rounding leaves, of which processes knew nothing: a traceback."""
    words = ["run", "-scene_dimension", "2", "-scene_geometry", "sphere", "-scene_points", "32",
             "-scene_period", "24", "-load_path", "normal_displacement=1", "-contact_symmetry",
             "off", "-scene_normal_maugis", "2", "-snes_max_it", "1", "-continuation_initial_step",
             "0.9", "-continuation_largest_step", "0.9", "-continuation_smallest_step", "0.5"]
    one, two = (command(size, *words, folder=tmp_path) for size in (1, 2))
    assert one.returncode == two.returncode == 1 and "Traceback" not in two.stderr, two.stderr
    told = [line.partition("error: SNES DIVERGED_MAX_IT")[2].partition("; the grid is too coarse")
            for done in (one, two) for line in done.stderr.splitlines() if "error: " in line]
    assert len(told) == 2 and told[0][2] == told[1][2] != ""


@together
def test_a_sweep_of_one_launched_process_starts_its_runs(tmp_path):
    """They took themselves for processes of the launcher, and did not begin."""
    done = program(1, """
import petsc4py
petsc4py.init([])
from petsc4py import PETSc
from contactsnes import Load, Scene, sweep

study = sweep(Scene(points=64, period=20.0), Load(path="normal_displacement=0.1"),
              normal_maugis=[0.5, 1.0], progress=False)
print(len(study), study.failures, flush=True)
""", tmp_path, fresh=True)
    assert done.stdout == "2 {}\n", done
