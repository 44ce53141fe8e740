"""Classes of Python that options of PETSc's solvers name (-snes_python_type, -pc_python_type, ...):
whether they are there and can be what they are named for, and which of them it was that failed."""

import inspect
import re
import sys
from importlib import import_module
from importlib.util import find_spec

from ..interface import own_methods
from ..options.database import database
from ..options.fields import InputError, meant
from ..scene import parts

OPTION = re.compile("(?:^|_)(snes|ksp|pc)_python_type$")

NEEDED = {"snes": ("solve", "step"), "ksp": ("solve", "step"), "pc": ("apply",)}
"""Methods of which a solver of that kind has to have one: without, petsc4py takes steps of its own,
or calls what is not there."""

TAKEN = {"solve": ("solver", "b", "x"), "apply": ("pc", "x", "y")}
"""What petsc4py calls these methods with."""

PACKAGE = __name__.partition(".")[0]


def check():
    """InputError for a class that an option names and that does not exist, or is no solver, and for
    a type that needs such an option and has none."""
    given = database()
    for kind in ("snes", "ksp"):
        if given.get(f"{kind}_type") == "python" and f"{kind}_python_type" not in given:
            raise InputError(f"-{kind}_type is 'python', which needs -{kind}_python_type: name "
                             "MODULE.CLASS, of a module that Python can import")
    for name, path in given.items():
        kind = OPTION.search(name)
        if kind:
            _check_one(f"-{name} is '{path}'", path, NEEDED[kind[1]])


def _check_one(named, path, needed):
    """InputError unless there is a class, function or module that can be a solver.

    Parameters
    ----------
    named : str, how the sentence begins
    path : str, its dotted name
    needed : tuple of str, methods of which it has to have one
    """
    if not all(part.isidentifier() for part in path.split(".")):
        raise InputError(f"{named}: allowed is MODULE.CLASS, of a module that Python can import")
    try:
        found = _found(named, path, needed)
    except ImportError as error:
        raise InputError(f"{named}, {_missing(path, error)}") from None
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{named}, whose module fails ({type(error).__name__}: {error}); mend it"
                         ) from None
    # (what a function makes is known when it is called)
    made = isinstance(found, type) or not callable(found)
    if made and not _has_one(found, needed):
        raise InputError(f"{named}, which has no {' and no '.join(needed)}: it is no solver")
    if callable(found):
        _check_call(named, found)
    if isinstance(found, type):
        _check_methods(named, found, needed)


def _check_methods(named, found, needed):
    """InputError where a method of a class does not take what it is called with.

    Parameters
    ----------
    named : str, how the sentence begins
    found : type
    needed : tuple of str, methods that may be called
    """
    for method in TAKEN.keys() & set(needed):
        if not inspect.isfunction(own := inspect.getattr_static(found, method, None)):
            continue
        try:
            inspect.signature(own).bind("self", *TAKEN[method])
        except TypeError:
            raise InputError(f"{named}, whose {method} takes {inspect.signature(own)}, but is "
                             f"called as {method}({', '.join(TAKEN[method])})") from None


def _check_call(named, found):
    """InputError where a class or function cannot be called without arguments."""
    try:
        taken = inspect.signature(found)
    except (TypeError, ValueError):  # of what C made nothing is known
        return
    try:
        taken.bind()
    except TypeError:
        raise InputError(f"{named}, which takes {taken}, but is called without arguments; give "
                         "them defaults") from None


def _found(named, path, needed):
    """The class, function or module of a dotted name; InputError for a class that there is not.

    Parameters
    ----------
    named : str, how the sentence begins
    path : str
    needed : tuple of str, methods of which it has to have one
    """
    module, _, name = path.rpartition(".")
    known = vars(import_module(module)) if module else {}
    if name in known:
        return known[name]
    if module and not ("__path__" in known and find_spec(path)):
        classes = [other for other, found in known.items() if isinstance(found, type)
                   and found.__module__ == module and _has_one(found, needed)]
        there = f": it has {', '.join(classes)}" if classes else ", nor any that is a solver"
        raise InputError(f"{named}, but {module} has no class {name}"
                         + meant(name, classes, there, f"{module}."))
    return import_module(path)


def _has_one(found, needed):
    """Whether something has one of the methods that a solver needs."""
    return any(callable(getattr(found, method, None)) for method in needed)


def _missing(path, error):
    """Why a dotted name cannot be imported, and what to do.

    Parameters
    ----------
    path : str
    error : ImportError
    """
    if not error.name or not f"{path}.".startswith(f"{error.name}."):
        return f"whose module cannot be imported ({error}): give it what it imports"
    todo = ("files of methods, which contactsnes compare lists, name those of this program"
            if error.name.partition(".")[0] == PACKAGE and error.name != path
            else "name MODULE.CLASS, and the folder of the module in the environment's PYTHONPATH")
    return f"but Python finds no module {error.name}: {todo}"


def blamed(error):
    """A sentence on an error out of a file of one's own: of a law, shape or body, or of a solver;
    an empty text where it came from elsewhere."""
    return parts.blamed(error) or next(filter(None, (
        own_methods.failed(name, path, _file(path), error)
        for name, path in (database() if "petsc4py.PETSc" in sys.modules else {}).items()
        if OPTION.search(name) and not path.startswith(f"{PACKAGE}."))), "")


def _file(path):
    """The file of what has a dotted name; an empty text where there is none."""
    module = sys.modules.get(path) or sys.modules.get(path.rpartition(".")[0])
    return getattr(module, "__file__", None) or ""
