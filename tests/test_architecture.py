"""The direction of dependencies: who may import whom, what belongs in one place, and how long things may be."""

import ast
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

import contactsnes

PACKAGE = Path(contactsnes.__path__[0])
LONGEST_FILE, LONGEST_FUNCTION = 350, 60
LONGER = {"plots": 484, "archive": 560, "cli": 385}
"""Files that hold one thing of many like parts: figures, the safety of one file format."""


class Row(NamedTuple):
    """A module, what it is for, and the modules above it, or names in them, that it has no business with."""

    name: str
    purpose: str
    strangers: tuple = ()


PHYSICS = ("laws", "geometry", "elasticity", "contact", "reference")
SOLVERS = ("multigrid", "snes", "corrector", "tracing", "preconditioners", "motion", "stepping", "relaxation", "pseudotime",
           "stability")
LOAD_PATH = ("load", "scene.Steps")

TABLE = (
    Row("settings", "options as checked fields of dataclasses"),
    Row("streams", "standard streams that may be closed or full, and signals"),
    Row("devices", "files and disks that fail"),
    Row("checksums", "checksums of an archive's parts"),
    Row("load", "load paths and their text form"),
    Row("laws", "tractions and tangents at a gap, node by node"),
    Row("si", "scales of scenes in SI, and what is typed and told"),
    Row("shapes", "what a geometry asks of its scene"),
    Row("alone", "what an isolated contact asks of scene and load"),
    Row("cohesive", "spacings that resolve the cohesive zone"),
    Row("scene", "what is to be solved, as frozen data with units and checks"),
    Row("levels", "where interpolated values cross a level", ("scene", "laws")),
    Row("fourier", "the periodic grid, windows, transforms and reductions over nodes", ("scene", "laws")),
    Row("spots", "windows of several boxes, which to take, and their convolution", ("scene", "laws")),
    Row("symmetry", "even fields: half of their nodes, transforms and convolutions", ("scene", "laws")),
    Row("grids", "fields on finer grids, and blurred", ("scene", "laws")),
    Row("rough", "self-affine roughness as waves", ("scene", "laws")),
    Row("geometry", "initial gap of a shape on the grid", ("laws",)),
    Row("elasticity", "stiffness and compliance of the body in Fourier space", ("laws",)),
    Row("freespace", "compliance of the body on the unbounded line and plane", ("scene", "laws")),
    Row("contact", "a scene on its grid: law, gap and body"),
    Row("forms", "the balance as residual and tangent, however it is solved", LOAD_PATH),
    Row("arclength", "a form with its load as one more unknown", LOAD_PATH),
    Row("states", "displacements to start from, and between windows", LOAD_PATH),
    Row("following", "predictions that follow the edges of contact", LOAD_PATH),
    Row("reference", "analytic solutions, on their own", ("scene", "fourier", "forms", "states", *PHYSICS[:-1])),
    Row("energies", "energies of a point and works along a path", LOAD_PATH),
    Row("acceptance", "what tells a neighbour of a point from a state beyond a jump", LOAD_PATH),
    Row("observables", "numbers of a converged point"),
    Row("points", "points of a branch, legs, and what goes wrong", ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("isolated", "a contact that is the only one, on a box of nodes", LOAD_PATH),
    Row("mirrored", "the displacement form for even states", LOAD_PATH),
    Row("grid_choice", "points of a grid for an accuracy, and the memory they take", ("laws", "fourier", "elasticity")),
    Row("limit_points", "limit points located to rounding", ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("event_points", "points at which events happen", ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("folds", "limit points by arc length", ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("departures", "how a fold is left", ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("modes", "modes of smallest real part of any preconditioned operator", (*LOAD_PATH, "forms", *PHYSICS)),
    Row("bifurcations", "places where an eigenvalue crosses zero",
        ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("failures", "which points the grid resolves, and what stops a branch, in words", ("fourier", "forms")),
    Row("continuation", "points along a path, whatever is solved",
        ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("arcs", "points along a path by arc length, whatever is solved",
        ("scene", "fourier", "states", "observables", "forms", *PHYSICS)),
    Row("files", "files of options as arguments", ("fourier", "states", "observables", "forms", *PHYSICS)),
    Row("options", "the options database and the dataclasses", ("fourier", "states", "observables", "forms", *PHYSICS)),
    Row("resuming", "what an earlier run's points and this one must have in common", ("fourier", "states", "observables", "forms", *PHYSICS)),
    Row("motion", "the dynamics of the balance in Fourier space, without PETSc", (*LOAD_PATH, "continuation")),
    Row("stepping", "methods of damping a motion, without PETSc", (*LOAD_PATH, "forms", "continuation")),
    Row("balance", "imbalances of states at all nodes, evaluated anew", (*LOAD_PATH, "continuation")),
    Row("multigrid", "coarser grids for the full approximation scheme", (*LOAD_PATH, "continuation")),
    Row("snes", "PETSc's solver around a form", (*LOAD_PATH, "continuation")),
    Row("coldstart", "first points, by way of coarser grids where that serves", ("continuation", *LOAD_PATH)),
    Row("viscous", "equations of overdamped motion on a window and their implicit steps", (*LOAD_PATH, "continuation")),
    Row("overdamped", "overdamped motion followed to rest", (*LOAD_PATH, "continuation")),
    Row("jumps", "motion to rest at fixed loads", (*LOAD_PATH, "continuation")),
    Row("corrector", "from a guess and loads to a converged point", (*LOAD_PATH, "continuation")),
    Row("tracing", "from point to point along a branch, by tangents and arc length", (*LOAD_PATH, "continuation")),
    Row("preconditioners", "approximate inverses of the Jacobian", (*LOAD_PATH, "continuation")),
    Row("accuracy", "errors of points by finer grids", ("continuation",)),
    Row("recorder", "a corrector whose solves leave a history", LOAD_PATH),
    Row("relaxation", "damped dynamics as SNES types", (*LOAD_PATH, "continuation", "preconditioners")),
    Row("pseudotime", "pseudo-transient continuation as a SNES type", (*LOAD_PATH, "continuation", "preconditioners")),
    Row("stability", "unstable modes of a point", LOAD_PATH),
    Row("archive", "points in a file and back", PHYSICS + SOLVERS),
    Row("tables", "tables in files", PHYSICS + SOLVERS),
    Row("run", "a scene to its branch, from Python", ("archive",)),
    Row("methods", "methods as files of options, and the options of a comparison", PHYSICS + SOLVERS),
    Row("compare", "several methods on one scene, on equal terms", ("laws", "geometry", "elasticity", "forms", "archive")),
    Row("comparison_table", "a comparison as table, text and files", PHYSICS + SOLVERS),
    Row("prefixes", "archives in SI for readers of figures", PHYSICS + SOLVERS),
    Row("plots", "figures of archives", SOLVERS),
    Row("comparison_figure", "the figure of a comparison", PHYSICS + SOLVERS),
    Row("summary", "what would be solved, in words", PHYSICS[:-1] + SOLVERS),
    Row("progress", "lines and a bar on points as they come", PHYSICS + SOLVERS + ("states",)),
    Row("session", "PETSc started with a command's arguments, and what its database asks for", PHYSICS),
    Row("cli", "commands, progress and exit status", ("laws", "geometry", "elasticity", "reference")),
    Row("__main__", "python -m contactsnes", PHYSICS + SOLVERS),
)

HOMES = {
    "petsc4py": {"options", "multigrid", "snes", "viscous", "corrector", "tracing", "preconditioners", "relaxation", "pseudotime", "stability", "accuracy", "compare",
                 "session", "cli"},
    "matplotlib": {"plots", "comparison_figure"},
    "h5py": {"archive", "geometry", "tables"},
    "pyfftw": {"fourier", "symmetry"},
}
"""The only modules that may import a package, anywhere in them."""

FREE_OF_PETSC = ("settings", "load", "si", "shapes", "alone", "cohesive", "scene", "laws", "levels", "fourier", "geometry", "elasticity", "freespace", "spots", "symmetry", "rough", "contact", "isolated", "forms", "arclength", "states", "following", "mirrored", "balance",
                 "reference", "grid_choice", "observables", "points", "energies", "limit_points", "event_points", "folds", "failures", "bifurcations", "departures", "modes", "continuation", "arcs", "files", "options", "motion", "stepping", "resuming", "archive", "tables", "methods")
"""Modules that can be imported without PETSc, themselves and all they import."""

NAMES = [row.name for row in TABLE]
FILES = {".".join(path.relative_to(PACKAGE).with_suffix("").parts): path for path in sorted(PACKAGE.rglob("*.py"))}
MODULES = [name for name in FILES if name != "__init__"]

def parsed(name):
    """A file's tree; relative imports within a package of this package are made to begin at the latter."""
    tree, inner = ast.parse(FILES[name].read_text(encoding="utf-8"), FILES[name]), name.split(".")[:-1]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = [*inner[:len(inner) + 1 - node.level], *filter(None, [node.module])]
            node.level, node.module = 1, ".".join(parts) or None
    return tree


def row_of(name):
    """The row of a file: modules of a package share its row."""
    return name.split(".")[0]


TREES = {name: parsed(name) for name in FILES}

every_module = pytest.mark.parametrize("name", MODULES)
every_file = pytest.mark.parametrize("name", FILES)


def imports(tree):
    """Dotted names that a module imports, wherever it does; those of the package begin with a dot."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            dotted = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            separator = "" if base.endswith(".") else "."
            dotted = [base + separator + alias.name for alias in node.names]
        else:
            continue
        for name in dotted:
            inside = name == "contactsnes" or name.startswith("contactsnes.")
            yield name[len("contactsnes"):] or "." if inside else name


def own_imports(tree):
    """Modules of the package that a module imports; what is exported by the package itself counts by its own name."""
    return {name.split(".")[0] for name in own_names(tree)}


def own_names(tree):
    """The same, with the names that are imported from them."""
    return {name[1:] for name in imports(tree) if name.startswith(".")}


def used_names(tree):
    """Dotted names that a module imports, and those of attributes that it uses."""
    return set(imports(tree)) | {dotted(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}


def definitions(tree):
    """Every function, method and class of a module with its dotted name."""
    def inner(node, prefix):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                yield prefix + child.name, child
                yield from inner(child, f"{prefix}{child.name}.")
            else:
                yield from inner(child, prefix)
    return inner(tree, "")


def public(tree):
    """Functions, classes and methods without a leading underscore anywhere in their name, not those within functions."""
    functions = {name for name, node in definitions(tree) if not isinstance(node, ast.ClassDef)}
    for name, node in definitions(tree):
        parts = name.split(".")
        within = {".".join(parts[:i]) for i in range(1, len(parts))}
        if not any(part.startswith("_") for part in parts) and not within & functions:
            yield name, node


def dotted(node):
    """The dotted name of an attribute of a name, or an empty text."""
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def test_the_parser_of_imports():
    tree = ast.parse("import numpy.fft as f, h5py\nfrom . import laws, snes\nfrom .fourier import Grid\n"
                     "import contactsnes\nimport contactsnes.run\nfrom contactsnes.cli import main\n"
                     "def f():\n    from petsc4py import PETSc")
    assert list(imports(tree)) == ["numpy.fft", "h5py", ".laws", ".snes", ".fourier.Grid", ".", ".run", ".cli.main",
                                   "petsc4py.PETSc"]
    assert own_imports(tree) == {"laws", "snes", "fourier", "", "run", "cli"}
    assert own_imports(parsed("reference.__init__")) == own_imports(parsed("reference.sphere")) == {"reference"}


def test_the_table_is_sound():
    assert len(set(NAMES)) == len(NAMES)
    for position, row in enumerate(TABLE):
        assert {stranger.split(".")[0] for stranger in row.strangers} <= set(NAMES[:position]), row
    assert set(NAMES) <= {row_of(name) for name in FILES}, "a row without a file"
    assert set(FREE_OF_PETSC) <= set(NAMES) and set().union(*HOMES.values()) <= set(NAMES)


@every_module
def test_module_is_in_the_table(name):
    assert row_of(name) in NAMES, f"{name}.py is not in the table: say what it is for, and put it below all it imports"


@every_module
def test_imports_come_from_above(name):
    if row_of(name) not in NAMES:
        pytest.skip("not in the table")
    own = own_imports(TREES[name]) - {"__version__"} - ({row_of(name)} if "." in name else set())
    below = own - set(NAMES[:NAMES.index(row_of(name))])
    assert not below, f"{name}.py imports {sorted(below)}, which do not stand above it"


@every_module
def test_imports_keep_to_the_purpose(name):
    strangers = {row.name: set(row.strangers) for row in TABLE}.get(row_of(name), set())
    assert not (own_imports(TREES[name]) | own_names(TREES[name]) | used_names(TREES[name])) & strangers


@every_file
@pytest.mark.parametrize("package", HOMES)
def test_package_has_its_homes(name, package):
    if name not in HOMES[package]:
        assert package not in {imported.split(".")[0] for imported in imports(TREES[name])}


@every_file
def test_transforms_are_the_grids(name):
    """Whatever transforms is in `fourier`, which counts; the lengths that suit a transform may be asked anywhere."""
    allowed = {"scipy.fft.next_fast_len"}
    if name == "fourier":
        allowed |= {"np.fft", "np.fft.fftfreq", "np.fft.rfftfreq"}
    if name == "symmetry":
        allowed |= {"scipy.fft", "scipy.fft.dctn"}
    homes = ("np.fft", "numpy.fft", "scipy.fft", "scipy.signal.fft", "scipy.signal.oaconvolve", "mkl_fft")
    assert not {used for used in used_names(TREES[name]) if used.startswith(homes)} - allowed


@every_file
def test_only_the_command_line_prints(name):
    if name != "cli":
        calls = [node for node in ast.walk(TREES[name]) if isinstance(node, ast.Call)]
        assert not [node.lineno for node in calls if dotted(node.func) in ("print", "sys.stdout.write", "PETSc.Sys.Print")]


@every_file
def test_files_are_short(name):
    lines = len(FILES[name].read_text(encoding="utf-8").splitlines())
    assert lines <= LONGER.get(name, LONGEST_FILE), f"{name}.py has {lines} lines: find what can stand on its own"


@every_file
def test_functions_are_short(name):
    lengths = {full: node.end_lineno - node.lineno + 1 for full, node in definitions(TREES[name])
               if not isinstance(node, ast.ClassDef)}
    assert not {full: length for full, length in lengths.items() if length > LONGEST_FUNCTION}


@every_file
def test_everything_public_says_what_it_is(name):
    tree = TREES[name]
    assert ast.get_docstring(tree), f"{name}.py has no docstring"
    assert not [full for full, node in public(tree) if not ast.get_docstring(node)]


def imported_by(statement):
    """Top-level packages in `sys.modules` of a fresh interpreter after a statement."""
    code = f"import sys; sys.path.insert(0, {str(PACKAGE.parent)!r}); {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return {module.split(".")[0] for module in done.stdout.split()}


def test_the_package_alone_imports_no_petsc():
    assert not imported_by("import contactsnes") & {"petsc4py", "matplotlib"}


def test_mathematics_imports_no_petsc():
    modules = ", ".join(f"contactsnes.{name}" for name in FREE_OF_PETSC)
    assert not imported_by(f"import {modules}") & {"petsc4py", "matplotlib"}
