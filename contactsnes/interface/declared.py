"""Classes that declare themselves, laws, shapes and bodies: their options, and where they are found
by name."""

import dataclasses
import inspect
import pkgutil
from functools import lru_cache, wraps
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

import numpy as np

from ..options.fields import InputError, Options


class Declared(Options):
    """Base of what is one class in one file. A subclass is made a dataclass when it is defined; its
    options are class attributes made by `options.fields.option`, ``-scene_`` + their names, and its
    parameters from Python.

    Attributes
    ----------
    name : what an option of the scene calls it; a class without one is a base of others
    meaning : what the help says of it
    made : methods that are made of what it declares, and are none for it to replace
    spared : name of a method -> what stands for it where it would be asked of no nodes or waves, as
        one of several processes may have none: their smallest, say, would be an error
    """

    prefix = "scene_"
    name, meaning = "", ""
    made, spared = (), {}

    def __init_subclass__(cls, **options):
        super().__init_subclass__(**options)
        for name in cls.spared.keys() & vars(cls).keys():
            if inspect.isfunction(vars(cls)[name]):
                setattr(cls, name, _spared(vars(cls)[name], cls.spared[name]))
        own = {name: value for name, value in vars(cls).items()
               if isinstance(value, dataclasses.Field)}
        annotations = dict(vars(cls).get("__annotations__", {}))
        cls.__annotations__ = {**{name: type(value.default) for name, value in own.items()},
                               **annotations}
        dataclasses.dataclass(eq=False)(cls)
        for field in dataclasses.fields(cls):
            if field.default is dataclasses.MISSING or not field.metadata:
                raise TypeError(f"{cls.__name__}.{field.name} is not made by option(...)")

    def __setattr__(self, name, value):
        """Set an attribute; AttributeError for an option of an object that a scene was made of
        (`Registry.keep`): what is computed later would be of another one."""
        if "_kept" in vars(self) and name in self.declared():
            raise AttributeError(f"{self!r} is in use, its {name} cannot be set: make another "
                                 f"object of {type(self).__name__}")
        super().__setattr__(name, value)

    @classmethod
    @lru_cache(maxsize=64)
    def declared(cls):
        """Name -> field of every option that the class declares."""
        fields = dataclasses.fields(cls) if dataclasses.is_dataclass(cls) else ()
        return MappingProxyType({field.name: field for field in fields})


def _spared(method, nothing):
    """A method that is asked of something only; of no nodes or waves, its first argument, another
    function is.

    Parameters
    ----------
    method, nothing : functions of the same arguments, the latter without the object
    """
    @wraps(method)
    def asked(self, *values, **named):
        if values and not np.size(values[0]):
            return nothing(*values, **named)
        return method(self, *values, **named)
    return asked


class Registry:
    """Classes of one kind by name: those that the files of a folder define, those in files of one's
    own, and objects made in Python.

    Parameters
    ----------
    kind : what they are, in a word
    field : the field of the scene, ``-scene_`` + its name, that names one
    base : the class that all of them are subclasses of
    package : dotted name of the package of their files
    file : a path in that package's folder

    Attributes
    ----------
    found : name -> class, of the package's files
    several, wanted : more than one of the kind, and the base, in words
    options : name -> field of all their options
    own : FILE.py:NAME -> class (or object) in a file of one's own that was loaded
    objects : name -> object made in Python, of a class that no file of the package has
    """

    def __init__(self, kind, field, base, package, file):
        self.kind, self.field, self.base, self.found = kind, field, base, {}
        folder = str(Path(file).parent)
        for module in sorted(entry.name for entry in pkgutil.iter_modules([folder])):
            own = import_module(f"{package}.{module}")
            for cls in vars(own).values():
                if (isinstance(cls, type) and issubclass(cls, base) and cls.name
                    and cls.__module__ == own.__name__):
                    self.found[cls.name] = cls
        self.several = kind.removesuffix("y") + ("ies" if kind.endswith("y") else "s")
        self.wanted = f"{package}.{base.__name__}"
        self.options = self._merged(self.found.values())
        self.own, self.objects = {}, {}

    def _merged(self, classes):
        """Name -> field of the options of some classes; TypeError where two declare one
        differently."""
        found = {}
        for cls in classes:
            for name, field in cls.declared().items():
                if found.setdefault(name, field).metadata != field.metadata:
                    raise TypeError(f"the {self.kind} {cls.__name__} declares -{cls.prefix}{name}, "
                                    f"which another {self.kind} declares differently")
        return found

    def enter(self, name, made):
        """Make a class (or an object without options) in a file of one's own, and its options,
        known; TypeError where another declares one differently."""
        self.options.update(self._merged((*self.found.values(), *self.own.values(), made)))
        self.own[name] = made

    def keep(self, made):
        """The name by which a scene knows an object, whose options stay from now on: what it prints
        as, and a number where another one does."""
        text, count = repr(made), 1
        while self.objects.setdefault(text, made) is not made:
            count += 1
            text = f"{made!r} {count}"
        vars(made)["_kept"] = True
        return text

    def knows(self, name):
        """Whether a name is that of a class in a file of one's own, or of an object."""
        return name in self.objects or name in self.own

    def named(self, name):
        """The class, or the object, of a name; None of one that is not known."""
        return next((known[name] for known in (self.found, self.own, self.objects)
                     if name in known), None)

    def of(self, scene):
        """What a scene names, with the scene's values of its options; the same object for the same
        values. InputError for an object of another process, from where the scene was pickled."""
        made = self.named(getattr(scene, self.field))
        if made is None:
            raise InputError(f"the {self.kind} of the scene is '{getattr(scene, self.field)}', an "
                             "object that was made in another process, which scenes do not take "
                             f"with them: give it again, {self.field}=...")
        if not isinstance(made, type):
            return made
        try:
            return _made(made, tuple(getattr(scene, name) for name in made.declared()))
        except (TypeError, AttributeError) as error:
            if made in self.found.values():
                raise
            raise InputError(f"-scene_{self.field} is '{getattr(scene, self.field)}': no object of "
                             f"its class can be made of its options ({error}); leave __init__ "
                             "out, its parameters are made by option(...)") from error

    def described(self):
        """What the help says of the package's own, in words."""
        return ", ".join(f"{name} ({cls.meaning})" for name, cls in self.found.items())


@lru_cache(maxsize=64)
def _made(cls, values):
    """The object of a class with values of its options, in their order."""
    return cls(*values)
