"""Arguments of the Python face: what they have to be, said in one sentence."""

import operator
import os
import reprlib

from .fields import InputError


def unfit(name, value, meant):
    """The InputError of an argument whose value is not what is to be given.

    Parameters
    ----------
    name : str, of the argument
    value : object
    meant : str, what is to be given
    """
    return InputError(f"{name} is {reprlib.repr(value)}: give {meant}")


def of_class(name, value, cls, meant=""):
    """A value that is an object of a class; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    cls : type, or a tuple of them
    meant : str, what is to be given, if not just an object of the one, which the package exports
    """
    if not isinstance(value, cls):
        raise unfit(name, value, meant or f"an object of contactsnes.{cls.__name__}")
    return value


def alone(**given):
    """Nothing; InputError where more than one of several arguments, by name, is not None."""
    names = [name for name, value in given.items() if value is not None]
    if len(names) > 1:
        raise InputError(f"{' and '.join(names)} are given, of which each would do: give one of "
                         "them")


def whole(name, value, meant):
    """A value that is a whole number, an int; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    meant : str, what is to be given
    """
    return _converted(name, value, meant, operator.index, bool)


def several(name, values, meant):
    """Values that can be iterated over and are no text, a list; InputError for others.

    Parameters
    ----------
    name : str, of the argument
    values : object
    meant : str, what is to be given
    """
    return _converted(name, values, meant, list, (str, bytes))


def _converted(name, value, meant, convert, others):
    """What a function makes of a value; InputError where it takes none such, or for objects of some
    other classes.

    Parameters
    ----------
    name, value, meant : as of ``unfit``
    convert : function (value), which raises TypeError for what it does not take
    others : type, or a tuple of them
    """
    try:
        if not isinstance(value, others):
            return convert(value)
    except TypeError:
        pass
    raise unfit(name, value, meant)


def a_path(name, value, meant):
    """A value that is a path, a str or `os.PathLike`; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    meant : str, what is to be given
    """
    return of_class(name, value, (str, os.PathLike), meant)


def unpicklable(instead):
    """A decorator of classes whose objects are neither pickled nor copied: TypeError, as ``pickle``
    and ``copy`` have it, says what is, in their place."""
    def decorated(cls):
        def refuse(made, protocol):
            raise TypeError(f"a {cls.__name__} is neither pickled nor copied: {instead}")

        cls.__reduce_ex__ = refuse
        return cls
    return decorated


def sealed(what, instead, but=()):
    """A decorator of classes whose objects are as they were made, once they have ``_sealed``:
    AttributeError where an attribute is set or deleted, also one that there is not, which would
    change nothing.

    Parameters
    ----------
    what : str, an object of the class
    instead : str, what to do in place of that
    but : names that may be set
    """
    def decorated(cls):
        def setting(made, name, value):
            if "_sealed" in vars(made) and name not in but:
                raise AttributeError(f"{what} is immutable, its {name} cannot be set: {instead}")
            object.__setattr__(made, name, value)

        def deleting(made, name):
            raise AttributeError(f"{what} is immutable, its {name} cannot be deleted")

        cls.__setattr__, cls.__delattr__ = setting, deleting
        return cls
    return decorated
