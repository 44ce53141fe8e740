"""Traction-separation laws, each a class in a file of this folder, where it is found: a new file
suffices.

`LAWS` has them by name, `OPTIONS` all their options, `of` makes the one that a scene names. Objects
of other classes, made in Python, are known by a name once they are kept.
"""

import pkgutil
from functools import lru_cache
from importlib import import_module
from pathlib import Path

from .law import Law


def _found():
    """Name -> class of every law with a name that a file of this folder defines."""
    found = {}
    for module in sorted(entry.name
                         for entry in pkgutil.iter_modules([str(Path(__file__).parent)])):
        own = import_module(f"{__package__}.{module}")
        for cls in vars(own).values():
            if (isinstance(cls, type) and issubclass(cls, Law) and cls.name
                and cls.__module__ == own.__name__):
                found[cls.name] = cls
    return found


def _options(classes):
    """Name -> field of the options of some laws; TypeError where two laws declare one name
    differently."""
    found = {}
    for cls in classes:
        for name, field in cls.declared().items():
            if found.setdefault(name, field).metadata != field.metadata:
                raise TypeError(f"the law {cls.__name__} declares -{cls.prefix}{name}, "
                                "which another law declares differently")
    return found


LAWS = _found()
OPTIONS = _options(LAWS.values())
OWN = {}
"""FILE.py:NAME -> class of a law in a file of one's own that was loaded."""
OBJECTS = {}
"""Name -> law that was made in Python, of a class that no file of this folder has."""


def enter(name, cls):
    """Make a class in a file of one's own, and its options, known; TypeError where another law
    declares one differently."""
    OPTIONS.update(_options((*LAWS.values(), *OWN.values(), cls)))
    OWN[name] = cls


def keep(law):
    """The name by which a scene knows an object from now on: what it prints as, and a number where
    another one does."""
    text, count = repr(law), 1
    while OBJECTS.setdefault(text, law) is not law:
        count += 1
        text = f"{law!r} {count}"
    return text


def named(name):
    """The class, or the object, of a law's name; None of one that is not known."""
    return next((known[name] for known in (LAWS, OWN, OBJECTS) if name in known), None)


def of(scene):
    """The law that a scene names, with the scene's values of its options; the same object for the
    same values."""
    if scene.law in OBJECTS:
        return OBJECTS[scene.law]
    cls = named(scene.law)
    return _made(cls, tuple(getattr(scene, name) for name in cls.declared()))


@lru_cache(maxsize=64)
def _made(cls, values):
    """The law of a class with values of its options, in their order."""
    return cls(*values)
