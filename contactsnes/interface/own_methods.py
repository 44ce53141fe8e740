"""Methods of laws, shapes and bodies of one's own: whether they take what they are called with, and
which of them it was that failed."""

import inspect
import traceback
from numbers import Real
from pathlib import Path

from ..options.fields import InputError

RETURNED = {"memory": ("a number", lambda found: isinstance(found, Real)),
            "shortest": ("a number", lambda found: isinstance(found, Real)),
            "filled": ("a dictionary", lambda found: isinstance(found, dict)),
            "about": ("a list of texts", lambda found: isinstance(found, (list, tuple)) and all(
                isinstance(line, str) for line in found))}
"""What methods that cost nothing have to return: in words, and whether something is that."""


def check(registry, named, made):
    """InputError where a method of a class of one's own cannot be called as that of its base is, or
    is none; a property of the base may be a value.

    Parameters
    ----------
    registry : Registry, of its kind
    named : what the sentence calls it
    made : the class, or an object of it
    """
    cls = made if isinstance(made, type) else type(made)
    for name in sorted({*_declared(registry.base)} & {*_declared(cls)}):
        asked, own = (inspect.getattr_static(kind, name) for kind in (registry.base, cls))
        if own is not asked and name not in registry.base.made:
            _check_one(f"{named}, whose {name}", asked, own, cls)


def _declared(cls):
    """Public names of a class."""
    return (name for name in dir(cls) if not name.startswith("_"))


def _check_one(named, asked, own, cls):
    """InputError unless what a class has can stand for a method or property of its base.

    Parameters
    ----------
    named : str, how the sentence begins
    asked, own : attributes of base and class, not bound
    cls : the class
    """
    method = isinstance(asked, (classmethod, staticmethod)) or inspect.isfunction(asked)
    if not method:
        if inspect.isfunction(own):
            raise InputError(f"{named} is a method, but is asked for as a value; write "
                             "@property above it")
        return
    if not hasattr(own, "__get__"):
        raise InputError(f"{named} is {own!r}, but is called{_arguments(asked, cls)}; make it a "
                         "method")
    if isinstance(asked, classmethod) and inspect.isfunction(own):
        raise InputError(f"{named} is called on the class, before there is an object; write "
                         "@classmethod above it")
    if isinstance(own, property):
        raise InputError(f"{named} is a property, but is called{_arguments(asked, cls)}; leave "
                         "@property out")
    try:
        given, taken = (inspect.signature(kind.__get__(cls, cls)) for kind in (asked, own))
    except (TypeError, ValueError):  # of what C made nothing is known
        return
    for values, names in _calls(given):
        try:
            taken.bind(*values, **names)
        except TypeError:
            raise InputError(f"{named} takes {taken}, but is called with {given}; give it these "
                             "parameters") from None


def _arguments(asked, cls):
    """How a method of a base is called, in words."""
    return f" with {inspect.signature(asked.__get__(cls, cls))}"


def _calls(signature):
    """Arguments, by place and by name, that a method may be called with: those that have to be
    given, and all."""
    parameters = signature.parameters.values()
    for some in ([each for each in parameters if each.default is each.empty], [*parameters]):
        yield ([each.name for each in some if each.kind is not each.KEYWORD_ONLY],
               {each.name: None for each in some if each.kind is each.KEYWORD_ONLY})


def check_returned(part, named, scene):
    """InputError where a method of a shape or body of one's own returns what is not asked for; not
    asked before there is a grid.

    Parameters
    ----------
    part : Shape or Body
    named : what the sentence calls it
    scene : Scene
    """
    for name, (words, fits) in RETURNED.items():
        if hasattr(part, name) and scene.points != "auto":
            more = (lambda value, unit, digits=4: "",) if name == "about" else ()
            found = getattr(part, name)(scene, *more)
            if not fits(found):
                raise InputError(f"{named}, whose {name} returns {found!r}: it has to be {words}")


def blamed(error, registries):
    """A sentence on an error that came out of a file of one's own: option, method, error and place;
    an empty text where it did not.

    Parameters
    ----------
    error : Exception, with its traceback
    registries : of the kinds that may be in files
    """
    if isinstance(error.__cause__, StopIteration):  # which generators wrap
        error = error.__cause__
    return next(filter(None, (
        failed(f"scene_{registry.field}", name, name.rpartition(":")[0], error)
        for registry in registries for name in registry.own)), "")


def failed(option, value, path, error):
    """A sentence on an error that came out of the file at a path: option, method, error and place;
    an empty text where it did not.

    Parameters
    ----------
    option, value : str, that name what is in the file
    path : of the file
    error : Exception, with its traceback
    """
    path = Path(path).resolve()
    inside = [frame for frame in traceback.extract_tb(error.__traceback__)
              if Path(frame.filename).resolve() == path]
    if not inside:
        return ""
    return (f"-{option} is '{value}': its {inside[0].name} fails ({type(error).__name__}: {error}; "
            f"line {inside[-1].lineno} of the file); mend it")
