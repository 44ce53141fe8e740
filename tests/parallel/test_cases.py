"""Branches of several processes against those of one: every observable of their last points, and
their events."""

import math

import pytest
from ranks import SIZES, found, together

CASES = """
import json
import petsc4py
petsc4py.init(["cases", "-snes_atol", "1e-11"])
from petsc4py import PETSc
from contactsnes import Branch, Form, Load, Scene, Steps
from contactsnes.contact import observables
from contactsnes.grid import slabs
from contactsnes.solvers import krylov, two_grids

SPHERE = dict(dimension=2, points=(32, 32), period=8.0, normal_maugis=1.0, tangential_maugis=1.0,
              geometry="sphere", height=float("inf"))
ROUGH = dict(SPHERE, geometry="rough", rough_on="flat", rough_hurst=0.8, rough_slope=0.5,
             rough_longest=4.0, rough_shortest=1.0, rough_seed=3)
CASES = {
    "force": (SPHERE, Load("normal_displacement=0", "normal_force=-5.85"),
              dict(initial_step=0.2, largest_step=0.5, locate_folds=False)),
    "sheared layer": (dict(SPHERE, height=3.0, poisson=0.3),
                      Load("normal_displacement=0", "tangential_displacement_x=1"),
                      dict(initial_step=0.25, largest_step=0.5)),
    "pull-off": (dict(SPHERE, normal_maugis=4.0),
                 Load("normal_displacement=-1", "normal_displacement=-3"),
                 dict(initial_step=0.2, largest_step=0.5)),
    "stability": (SPHERE, Load("normal_displacement=0", "normal_displacement=0.2"),
                  dict(initial_step=0.1, largest_step=0.1, stability="eigenvalue")),
    "rough": (ROUGH, Load("normal_displacement=0", "normal_displacement=0.5"),
              dict(initial_step=0.1, largest_step=0.2)),
    "few nodes": (dict(ROUGH, points=(64, 64), rough_slope=40.0, normal_maugis=2.0),
                  Load("normal_displacement=0",
                       "normal_displacement=2; tangential_displacement_x=0.5"),
                  dict(initial_step=0.2, largest_step=0.5))}

if PETSc.COMM_WORLD.size > 1:  # two do a part, three the others
    part = ("sheared layer", "pull-off", "few nodes")
    CASES = {name: case for name, case in CASES.items()
             if (name in part) == (PETSc.COMM_WORLD.size == 2)}
found = {}
for name, (scene, load, steps) in CASES.items():
    # on one process convex gaps have boxes, whose Krylov iterations end elsewhere
    window = "off" if name in ("force", "rough") else "auto"
    # coarse grids in slabs, too, or, as they are so small, whole on every process
    slabs.GATHERED = 0 if name in ("pull-off", "rough", "sheared layer") else 2 ** 14
    # Krylov vectors in single precision, which solves of few unknowns do not have
    single = name in ("sheared layer", "few nodes")
    krylov.LARGE = 1 if single else 2 ** 16
    two_grids.LARGE = 1 if name in ("few nodes", "rough") else 2 ** 14
    branch = Branch(Scene(**scene), load, Steps(**steps),
                    Form(symmetry="off", window=window,
                         linear_precision="single" if single else "auto"))
    names = list(observables.table(branch.scene))
    found[name] = []
    for point in branch:
        found[name].append({**branch.observe(point, names),
                            "nodes": point.state.window.total / branch.contact.grid.size})
if PETSc.COMM_WORLD.rank == 0:
    with open("found.json", "w") as file:
        json.dump(found, file, default=lambda value: value if isinstance(value, str)
                  else float(value))
"""
COSTS = {"wall_time", "transforms", "transforms_single", "nonlinear_iterations",
         "linear_iterations", "function_evaluations", "nodes"}
"""What was spent since the point before, which need not be the same - a sum in another order may
change a step's length - and the part of the cell that is solved on."""
PATHS = {"external_work", "interface_work", "energy_imbalance", "dissipated_work", "jump_work",
         "viscous_work", "residual_norm", "largest_residual"}
"""What hangs on the steps of the path, or is rounding."""
TOLERANCES = {"leading_eigenvalue": 1e-3}
"""Of what is known less precisely than the state: Krylov's iteration ends when the sign is sure."""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Case -> observables of its points, of one process."""
    return found(1, CASES, tmp_path_factory.mktemp("one"))


def differs(name, one, other):
    """Whether two values of an observable are those of different points."""
    if isinstance(one, str) or math.isnan(one) or math.isnan(other):
        return one != other and not (one != one and other != other)
    return abs(one - other) > TOLERANCES.get(name, 1e-6) * max(1.0, abs(one))


def events(points):
    """The events of a path, in their order."""
    return [point["event"] for point in points if point["event"] not in ("none", "", None)]


@together
@pytest.mark.parametrize("size", SIZES)
def test_branches_are_those_of_one_process(size, alone, tmp_path):
    for case, points in found(size, CASES, tmp_path).items():
        one, other = alone[case][-1], points[-1]
        assert events(points) == events(alone[case]), case
        assert not {name: (one[name], other[name]) for name in one
                    if name not in COSTS | PATHS and differs(name, one[name],
                                                                     other[name])}, case
        # those on which the law acts, of a convex gap as of others
        assert case not in ("pull-off", "few nodes") or other["nodes"] < 0.85, case
    assert "jump" in events(alone["pull-off"]) and "jump" in events(alone["force"])
    assert 0.0 < max(point["nodes"] for point in alone["few nodes"]) < 0.75
    assert all(point["stable"] != -1 for point in alone["stability"])
