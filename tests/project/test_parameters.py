"""Docstrings of everything public that takes three arguments or more: each has a section that tells
of them."""

import ast
from pathlib import Path

import contactsnes

PACKAGE = Path(contactsnes.__path__[0])
MANY = 3
"""Arguments from which on they are told one by one, ``self`` not counted."""

LACKING = {
    "Applied.mult", "Body.stiffness", "CoreBlock", "CoreZone", "Corrected.multAdd",
    "Coupled.evaluate", "CoupledBlock", "Edge.state", "Equations.newton", "Equations.size",
    "EvenCoreZone", "FoldSearch", "FullForm", "HalfForm", "Jacobian.mult",
    "Jacobian.multTranspose", "LastState.state", "Law.evaluate", "Limits.end_of_attraction",
    "Limits.end_of_branch", "Motion.advance", "Motion.kicked", "PseudoTransient.solve",
    "Recorder.run", "Relaxation.solve", "Relaxation.test", "Secant.state",
    "Solves.along_tangent", "Solves.direction", "Solves.solve", "States.adapted",
    "States.detached", "States.doubtful", "States.progress", "States.strayed", "Store.commit",
    "Tangent.state", "TooCoarse", "Tracer.solve_arc", "Transfer.correct",
    "XuNeedleman.evaluate", "ZonePC.apply", "ZonedStiffness", "at_most",
    "bonded_circle_stiffness", "carried", "cattaneo_line_displacement",
    "cattaneo_line_stick_half_width", "cattaneo_line_traction", "cattaneo_sphere",
    "cattaneo_sphere_traction", "check", "check_own", "distance", "dmt_sphere",
    "dmt_sphere_radius", "drive_critical_height", "drive_stiffness", "driven_displacement",
    "driven_fold", "entries", "find_root", "fitted", "follow_edge", "front_force",
    "front_onset", "hertz_line_pressure", "hertz_sphere", "hertz_sphere_pressure",
    "hertz_sphere_radius", "ineffective", "isolated_opening", "jkr_force", "jkr_line_approach",
    "jkr_line_half_width", "jkr_line_half_width_at_approach", "jkr_line_load",
    "jkr_line_pressure", "jkr_sphere", "jkr_sphere_fold", "jkr_sphere_pressure",
    "jkr_sphere_pull_off", "jkr_sphere_radius", "jkr_sphere_radius_at_approach",
    "layer_compliance", "ligament_force", "ligament_traction", "load_extrema", "maugis_line",
    "maugis_line_approach", "maugis_line_pressure", "maugis_sphere", "maugis_sphere_pressure",
    "maugis_sphere_pull_off", "memory_needed", "minimizer", "mixed_mode_line",
    "mixed_mode_line_half_width", "mixed_mode_line_strength", "mixed_mode_sphere",
    "mixed_mode_sphere_radius", "mixed_mode_sphere_strength", "next_grid", "opening_by_punches",
    "predicted", "reciprocal_depth", "refuse_too_large", "resolution", "root_depth",
    "savkoor_briggs_line_load", "savkoor_briggs_sphere_load", "savkoor_briggs_sphere_radius",
    "savkoor_briggs_sphere_strength", "sinusoid_approach", "sinusoid_half_width",
    "sinusoid_load", "sinusoid_pressure", "sizes", "sliding_force", "sliding_half_width",
    "slip_fronts", "slip_zone_edge_slip", "slip_zone_force", "slip_zone_traction",
    "sphere_maugis_parameter", "surface", "undeformed", "uniform_slip_force",
    "uniform_slip_onset", "uniform_slip_softening", "uniform_slip_state", "where", "zone_angle",
    "zone_force", "zone_lift", "zone_opening", "zone_traction",
}
"""What has no such section yet. This list may only become shorter."""


def arguments(function):
    """Names of a function's arguments, without those that stand for its object or class."""
    given = function.args
    several = [argument for argument in (given.vararg, given.kwarg) if argument]
    names = [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs,
                                           *several)]
    return [name for name in names if name not in ("self", "cls")]


def public(node, prefix=""):
    """Public functions, methods and classes, with the arguments that they are called with."""
    for child in node.body:
        if not isinstance(child, (ast.FunctionDef, ast.ClassDef)) or child.name.startswith("_"):
            continue
        if isinstance(child, ast.FunctionDef):
            yield prefix + child.name, child, arguments(child)
            continue
        made = [inner for inner in child.body if getattr(inner, "name", "") == "__init__"]
        yield prefix + child.name, child, arguments(made[0]) if made else []
        yield from public(child, f"{prefix}{child.name}.")


def lacking():
    """Names of what has many arguments and no section on them."""
    for path in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"), path)
        for name, node, given in public(tree):
            told = ast.get_docstring(node) or ""
            if len(given) >= MANY and "Parameters\n----------\n" not in told:
                yield name


def test_the_finder_of_arguments():
    tree = ast.parse("def one(a, b, *c): pass\nclass Two:\n def __init__(self, a, *, b): pass\n"
                     " def three(self, **a): pass\n def _four(self): pass\ndef _five(): pass")
    assert [(name, given) for name, _, given in public(tree)] == [
        ("one", ["a", "b", "c"]), ("Two", ["a", "b"]), ("Two.three", ["a"])]


def test_many_arguments_are_told_one_by_one():
    found = set(lacking())
    assert sorted(found - LACKING) == [], "these lack a section Parameters"
    assert sorted(LACKING - found) == [], "these have one now: take them from LACKING"
