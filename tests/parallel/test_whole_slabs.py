"""Linear solves on all nodes of planes that are not even: their iterations on several processes
are the library's, and those of one process."""

import pytest
from ranks import FEW, found, say, together

from contactsnes.kernels import library

PROGRAM = """
import json
from itertools import islice
import petsc4py
petsc4py.init()
from petsc4py import PETSc
from contactsnes import Branch, Form, Load, Scene
from contactsnes.grid import slabs
from contactsnes.kernels import krylov as compiled
from contactsnes.solvers import krylov, operators, patch_systems, two_grids

NAMES = ["nonlinear_iterations", "linear_iterations", "normal_force", "tangential_force_x"]
NORMAL = Load("normal_displacement=1", "normal_displacement=1.2")
CASES = {"two grids": NORMAL, "shared patches": NORMAL, "taken over": NORMAL,
         "force": Load("normal_displacement=1", "normal_force=-20"),
         "sheared": Load("normal_displacement=1", "tangential_displacement_x=0.2")}
krylov.LARGE = two_grids.LARGE = 1
made, told, tell = [], [], patch_systems.Patches.tell
iterate, mult = compiled.Iterations.__call__, operators.Jacobian.mult
compiled.Iterations.__call__ = lambda *given: made.append("library") or iterate(*given)
operators.Jacobian.mult = lambda *given: made.append("Python") or mult(*given)


def tell_of_mode(patches, matrix):
    tell(patches, matrix)
    told.append(len(matrix))
    # within the third solve
    patches.softest = -1.0 if name == "taken over" and len(told) == 8 else 1.0


patch_systems.Patches.tell = tell_of_mode
kept, found = slabs.GATHERED, {}
for name, load in CASES.items():
    made.clear()
    told.clear()
    slabs.GATHERED = 0 if name == "shared patches" else kept
    branch = Branch(Scene(dimension=2, points=64, period=8.0, normal_maugis=2.0, geometry="rough",
                          rough_on="flat", rough_slope=1.0, rough_longest=8.0, rough_shortest=1.0,
                          tangential_maugis=2.0), load,
                    form=Form(linear_precision="single", window="off"))
    points = [[float(value) for value in branch.observe(point, NAMES).values()]
              for point in islice(branch, 9)]
    found[name] = points, made.count("library"), made.count("Python"), len(told)
if PETSc.COMM_WORLD.rank == 0:
    with open("found.json", "w") as file:
        json.dump(found, file)
"""


@together
@pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))
@pytest.mark.parametrize("size", FEW)
def test_iterations_in_single_precision_are_the_librarys(size, tmp_path):
    one, more = found(1, PROGRAM, tmp_path), found(size, PROGRAM, tmp_path)
    for name, (points, in_library, _, told) in one.items():
        shared, also_in_library, in_python, also_told = more[name]
        assert in_library > 10 and also_in_library > 10, name
        # the residual of a cycle that begins anew, and solves that are asked for more
        assert in_python < 0.2 * also_in_library, name
        assert told > 5 and also_told > 5, name
        for alone, other in zip(points, shared, strict=True):
            assert alone[2:] == pytest.approx(other[2:], rel=1e-7, abs=1e-7), name
        # (rounding may decide on an iteration)
        alone, other = ([sum(numbers) for numbers in zip(*each)][:2] for each in (points, shared))
        assert alone == pytest.approx(other, rel=0.1, abs=2.0), name
    assert more["taken over"][1] > more["two grids"][1]


UNEVEN = """
import petsc4py
petsc4py.init()
from petsc4py import PETSc
from contactsnes import Branch, Form, Load, Scene, Steps
from contactsnes.solvers import snes

snes.LARGE = 300  # nodes, that some processes have and others have not
branch = Branch(Scene(dimension=2, points=64, period=20.0, normal_maugis=2.0, geometry="sphere"),
                Load("normal_displacement=0", "normal_displacement=0.2"),
                Steps(initial_step=0.1, largest_step=0.1), Form(symmetry="off"))
points = list(branch)
sizes = PETSc.COMM_WORLD.tompi4py().allgather(points[-1].state.window.size)
assert len(points) == 3 and min(sizes) < snes.LARGE < max(sizes), sizes
print("alike")
"""


@together
def test_processes_with_few_nodes_and_with_many_make_vectors_together(tmp_path):
    say(3, UNEVEN, tmp_path)
