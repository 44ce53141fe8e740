"""The direction of dependencies between rooms: who may import whom, what belongs in one place, and
how long things may be."""

import ast
import re
import statistics
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

import contactsnes

PACKAGE = Path(contactsnes.__path__[0])
ROOT = PACKAGE.parent
LONGEST_FILE, LONGEST_FUNCTION, LONGEST_LINE, MEDIAN = 300, 40, 100, 6
"""Lines of a file and a function of the package, columns of a line anywhere, and lines of half of
the functions, their docstrings not counted."""


class Room(NamedTuple):
    """A package: the rooms below it that it has no business with, and names in others that it must
    not use."""

    name: str
    strangers: tuple = ()


LOAD_PATH = ("scene.load", "scene.settings.Steps")
STEPS = tuple(f"continuation.{path.stem}" for path in (PACKAGE / "continuation").glob("[a-z]*"))
"""All of continuation but what it declares to others, its predictors."""

ROOMS = (Room("options"), Room("system"), Room("grid", ("options", "system")),
         Room("reference", ("options", "system", "grid")), Room("interface", ("reference",)),
         Room("kernels", ("options", "system", "reference")),
         Room("continuation", ("system", "grid", "reference", "interface")),
         Room("scene", ("system", "grid", "reference",
                        *(set(STEPS) - {"continuation.predictors"}))),
         Room("contact", ("system", *LOAD_PATH)),
         # (of the grid what makes the cell's fields of those on active nodes)
         Room("output", (*(f"grid.{name}" for name in ("boxes", "contours", "counter", "even",
                                                       "nearest", "outlines", "transfer")),
                         "reference", "interface", "continuation", "contact")),
         Room("solvers", ("system", "reference", "continuation", "output", *LOAD_PATH)),
         Room("dynamics", ("system", "reference", "output", *LOAD_PATH)),
         Room("branch", ("output.archive", "output.files", "output.layout", "output.figures")),
         Room("compare", ("interface", "system", "reference")),
         Room("commands", ("interface.laws", "interface.elasticity", "grid", "reference", "solvers",
                           "dynamics")),)
"""From the ground up: a room imports only from those before it."""

HOMES = {"petsc4py": {"options.database", "commands", "compare.comparison", "solvers", "dynamics",
                      "branch"},
         "matplotlib": {"output.figures", "output.report", "compare.figure"},
         "h5py": {"system.hdf5"}, "pyfftw": {"grid.fftw"}}
"""The only rooms or modules that may import a package, anywhere in them."""

OF_HDF5 = {"output.columns", "output.files", "output.store", "output.tables", "output.vtk",
           "interface.height_files", "interface.stored_heights"}
"""The only modules that read and write HDF5."""

WITHOUT_PETSC = ("options", "system", "grid", "reference", "interface", "kernels",
                 "continuation", "scene", "contact", "output")
"""Rooms that can be imported without PETSc, themselves and all they import."""

NAMES = [room.name for room in ROOMS]
FILES = {".".join(path.relative_to(PACKAGE).with_suffix("").parts): path
         for path in sorted(PACKAGE.rglob("*.py"))}
ENTRIES = ("__init__", "__main__")
"""Modules outside all rooms, which lead into them."""
MODULES = [name for name in FILES if name not in ENTRIES]


def relative(tree, name):
    """The tree of a module, whose relative imports are made to begin at the package."""
    inner = name.split(".")[:-1]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = [*inner[:len(inner) + 1 - node.level], *filter(None, [node.module])]
            node.level, node.module = 1, ".".join(parts) or None
    return tree


def parsed(name):
    """A file's tree."""
    return relative(ast.parse(FILES[name].read_text(encoding="utf-8"), FILES[name]), name)


def room_of(name):
    """The room of a module."""
    return name.split(".")[0]


def within(name, homes):
    """Whether a module is one of the homes, or in one of them."""
    return any(f"{name}.".startswith(f"{home}.") for home in homes)


@pytest.fixture(scope="module")
def trees():
    """Name of a file -> its tree."""
    return {name: parsed(name) for name in FILES}


def offenders(found):
    """What is wrong where, of pairs of a name and what is wrong there, if anything."""
    return {name: wrong for name, wrong in found if wrong}


@cache
def imports(tree):
    """Dotted names that a module imports, wherever it does; those of the package begin with a
    dot."""
    found = []
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
            found.append(name[len("contactsnes"):] or "." if inside else name)
    return tuple(found)


def own_names(tree):
    """Dotted names of the package that a module imports, without those of the package itself."""
    return {name[1:] for name in imports(tree) if name.startswith(".") and "." in name[1:]}


def own_modules(tree):
    """Modules of the package that a module imports."""
    found = set()
    for name in own_names(tree):
        parts = name.split(".")
        found.add(next(".".join(parts[:i]) for i in (3, 2, 1) if i <= len(parts)
                       and ".".join(parts[:i]) in FILES
                       or ".".join([*parts[:i], "__init__"]) in FILES))
    return found


def used_names(tree):
    """Dotted names that a module imports, and those of attributes that it uses."""
    return set(imports(tree)) | {dotted(node) for node in ast.walk(tree)
                                 if isinstance(node, ast.Attribute)}


@cache
def definitions(tree):
    """Every function, method and class of a module with its dotted name."""
    def inner(node, prefix):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                yield prefix + child.name, child
                yield from inner(child, f"{prefix}{child.name}.")
            else:
                yield from inner(child, prefix)
    return tuple(inner(tree, ""))


def public(tree):
    """Functions, classes and methods without a leading underscore anywhere in their name, not those
    within functions."""
    functions = {name for name, node in definitions(tree) if not isinstance(node, ast.ClassDef)}
    for name, node in definitions(tree):
        parts = name.split(".")
        outer = {".".join(parts[:i]) for i in range(1, len(parts))}
        if not any(part.startswith("_") for part in parts) and not outer & functions:
            yield name, node


def dotted(node):
    """The dotted name of an attribute of a name, or an empty text."""
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def test_the_parser_of_imports():
    tree = ast.parse("import numpy.fft as f, h5py\nfrom . import laws, "
                     "snes\nfrom .fourier import Grid\nimport contactsnes\nimport "
                     "contactsnes.branch.branch\nfrom contactsnes.commands.cli import "
                     "main\ndef f():\n    from petsc4py import PETSc")
    assert list(imports(tree)) == ["numpy.fft", "h5py", ".laws", ".snes", ".fourier.Grid", ".",
                                   ".branch.branch", ".commands.cli.main", "petsc4py.PETSc"]
    tree = ast.parse("from ..grid.cell import Grid\nfrom . import states\nfrom "
                     ".. import __version__\nfrom ..contact import forms")
    assert own_names(relative(tree, "contact.problem")) == {"grid.cell.Grid", "contact.states",
                                                            "contact.forms"}
    assert own_modules(tree) == {"grid.cell", "contact.states", "contact.forms"}


def test_the_rooms_are_those_of_the_package():
    assert set(NAMES) == {room_of(name) for name in MODULES}
    for position, room in enumerate(ROOMS):
        assert {stranger.split(".")[0]
                for stranger in room.strangers} <= set(NAMES[:position]), room


def test_imports_come_from_below(trees):
    above = {name: {room_of(other) for other in own_modules(trees[name])}
             - set(NAMES[:NAMES.index(room_of(name)) + 1]) for name in MODULES}
    assert not offenders(above.items()), "these import from rooms that stand above their own"


def test_a_room_keeps_to_its_business(trees):
    strangers = {room.name: room.strangers for room in ROOMS}
    assert not offenders((name, {other for other in own_names(trees[name])
                                 for stranger in strangers[room_of(name)]
                                 if f"{other}.".startswith(f"{stranger}.")}) for name in MODULES)


@pytest.mark.parametrize("room", NAMES)
def test_modules_of_a_room_have_an_order(room, trees):
    """No module of a room imports, by way of others, itself."""
    left = {name: {other for other in own_modules(trees[name]) if room_of(other) == room}
            for name in MODULES if room_of(name) == room}
    while left:
        free = [name for name, needed in left.items() if not needed & set(left)]
        assert free, f"these import each other: {sorted(left)}"
        left = {name: needed for name, needed in left.items() if name not in free}


@pytest.mark.parametrize("package", HOMES)
def test_package_has_its_homes(package, trees):
    importing = [name for name in FILES
                 if package in {imported.split(".")[0] for imported in imports(trees[name])}]
    assert not [name for name in importing if not within(name, HOMES[package])]


def test_hdf5_has_its_homes(trees):
    assert {name for name in MODULES if "system.hdf5" in own_modules(trees[name])} == OF_HDF5


def test_transforms_are_the_grids(trees):
    """Whatever transforms is in `grid`, which counts; the lengths that suit a transform may be
    asked anywhere."""
    allowed = {"grid.cell": {"np.fft", "np.fft.fftfreq", "np.fft.rfftfreq"},
               "grid.cosines": {"scipy.fft", "scipy.fft.dctn", "scipy.fft.dst"}}
    homes = ("np.fft", "numpy.fft", "scipy.fft", "scipy.signal.fft", "scipy.signal.oaconvolve",
             "mkl_fft")
    assert not offenders((name, {used for used in used_names(trees[name]) if used.startswith(homes)}
                          - {"scipy.fft.next_fast_len"} - allowed.get(name, set()))
                         for name in FILES)


def test_only_the_command_line_prints(trees):
    printing = ("print", "sys.stdout.write", "PETSc.Sys.Print")
    assert not offenders((name, [node.lineno for node in ast.walk(trees[name])
                                 if isinstance(node, ast.Call) and dotted(node.func) in printing])
                         for name in FILES if not name.startswith("commands."))


def test_files_are_short():
    lines = {name: len(path.read_text(encoding="utf-8").splitlines())
             for name, path in FILES.items()}
    assert not offenders((name, count > LONGEST_FILE and count) for name, count in lines.items()), \
        "find what can stand on its own"


def test_functions_are_short(trees):
    lengths = {f"{name}.{full}": node.end_lineno - node.lineno + 1
               for name, tree in trees.items() for full, node in definitions(tree)
               if not isinstance(node, ast.ClassDef)}
    assert not offenders((name, length > LONGEST_FUNCTION and length)
                         for name, length in lengths.items())


def body_lines(node):
    """Lines of a function's body, its docstring not counted."""
    body = node.body[1:] if ast.get_docstring(node) else node.body
    return body[-1].end_lineno - body[0].lineno + 1 if body else 0


def test_most_functions_are_shorter(trees):
    lengths = [body_lines(node) for tree in trees.values() for _, node in definitions(tree)
               if not isinstance(node, ast.ClassDef)]
    assert statistics.median(lengths) <= MEDIAN


def programs():
    """Every file of Python in the package, the tests, scripts with and without suffix, examples and
    options."""
    for folder in ("contactsnes", "tests", "scripts", "examples", "options"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix == ".py" or not path.suffix and path.is_file() and re.match(
                    "#!.*python", path.read_text(encoding="utf-8").split("\n", 1)[0]):
                yield path


def test_lines_are_short():
    assert not offenders(
        (path.relative_to(ROOT).as_posix(),
         [number for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
          if len(line) > LONGEST_LINE]) for path in programs()), \
        f"lines of these are longer than {LONGEST_LINE} columns"


def test_programs_without_suffix_are_checked_as_python():
    settings = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    scripts = [path.relative_to(ROOT).as_posix() for path in programs() if not path.suffix]
    assert len(scripts) > 5 and not [name for name in scripts if f'"{name}"' not in settings]


def test_everything_public_says_what_it_is(trees):
    assert not [name for name, tree in trees.items() if not ast.get_docstring(tree)]
    assert not offenders((name, [full for full, node in public(tree)
                                 if not ast.get_docstring(node)]) for name, tree in trees.items())


def imported_by(statement):
    """Top-level packages in `sys.modules` of a fresh interpreter after a statement."""
    code = (f"import sys; sys.path.insert(0, {str(PACKAGE.parent)!r}); {statement}; "
            "print(*sys.modules)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return {module.split(".")[0] for module in done.stdout.split()}


def test_the_package_alone_imports_no_petsc():
    assert not imported_by("import contactsnes") & {"petsc4py", "matplotlib"}


def test_mathematics_imports_no_petsc():
    modules = ", ".join(f"contactsnes.{name}" for name in MODULES
                        if room_of(name) in WITHOUT_PETSC and not within(name, HOMES["matplotlib"]))
    assert not imported_by(f"import {modules}") & {"petsc4py", "matplotlib"}
