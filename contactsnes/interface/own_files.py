"""Files of one's own, in which options of the scene name a law, a shape or a body: `FILE.py:NAME`.

The file is run, with Python's usual trust in what a user names.
"""

import hashlib
import importlib.util
from pathlib import Path
from types import FunctionType

from ..options.fields import InputError, nearest


def is_own(name):
    """Whether a name is that of something in a file."""
    return ".py:" in name


def load(registry, name, plain=None):
    """What `FILE.py:NAME` names, which then has the file's SHA-256 as ``source_sha256``.

    Parameters
    ----------
    registry : Registry, of whose kind it has to be: a subclass of the base, or an object of one
    name : FILE.py:NAME, the path from the working folder
    plain : function that makes an object of a plain function; by default functions will not do

    Raises
    ------
    InputError : where the file does not run, or has nothing of that name and kind
    """
    option = f"-scene_{registry.field} is '{name}'"
    file, _, title = name.rpartition(":")
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{option}: there is no file '{file}' "
                         "in the working folder, or from it; check its name")
    found = _contents(registry, option, path, plain is not None)
    if title not in found:
        known = (f"its {registry.several} are {', '.join(found)}" if found
                 else "it has " + ("no function and " if plain else "")
                 + f"no subclass of {registry.wanted}")
        guess = nearest(title, found)
        raise InputError(f"{option}: '{file}' has no {registry.kind} '{title}': {known}"
                         + (f"; try {file}:{guess}" if guess else ""))
    made = found[title]
    if not isinstance(made, (type, registry.base)):
        made = plain(made)
    # What was computed with it is of what the file says now, not of what it says later.
    made.source_sha256 = _sha256(path)
    return made


def is_stale(name, made):
    """Whether the file of what `FILE.py:NAME` named says something else now than when it was
    loaded; one that is no longer there says nothing."""
    path = Path(name.rpartition(":")[0])
    return path.is_file() and _sha256(path) != made.source_sha256


def _sha256(path):
    """Checksum of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _contents(registry, option, path, functions):
    """Name -> what a file has of a kind, of its own; InputError where it does not run."""
    spec = importlib.util.spec_from_file_location(f"contactsnes_own_{registry.field}_{path.stem}",
                                                  path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{option}: the file '{path}' does not run "
                         f"({type(error).__name__}: {error}); mend it") from error
    # What a file imports is of the file that it comes from.
    return {key: value for key, value in vars(module).items()
            if isinstance(value, registry.base)
            or getattr(value, "__module__", "") == module.__name__
            and (isinstance(value, type) and issubclass(value, registry.base)
                 or functions and isinstance(value, FunctionType))}
