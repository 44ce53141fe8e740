"""Options of our own types of SNES and PC, found in the files of this folder: a new file suffices.
"""

import pkgutil
from importlib import import_module
from pathlib import Path

from ..options.fields import Options


def _found():
    """Dataclasses of options that files of this folder define, by their titles."""
    found = []
    for entry in pkgutil.iter_modules([str(Path(__file__).parent)]):
        if entry.name == Path(__file__).stem:
            continue
        own = import_module(f"{__package__}.{entry.name}")
        found += [cls for cls in vars(own).values()
                  if isinstance(cls, type) and issubclass(cls, Options) and "prefix" in vars(cls)
                  and cls.__module__ == own.__name__]
    return tuple(sorted(found, key=lambda cls: cls.title))


OPTIONS = _found()
