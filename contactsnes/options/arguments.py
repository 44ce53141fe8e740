"""Arguments of the Python face: what they have to be, said in one sentence."""

import operator
import os
import reprlib

from .fields import InputError


def of_class(name, value, cls, meant=""):
    """A value that is an object of a class; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    cls : type, which the package exports
    meant : str, what is to be given, if not just an object of it
    """
    if not isinstance(value, cls):
        raise InputError(f"{name} is {reprlib.repr(value)}: give "
                         + (meant or f"an object of contactsnes.{cls.__name__}"))
    return value


def whole(name, value, meant):
    """A value that is a whole number, an int; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    meant : str, what is to be given
    """
    try:
        if isinstance(value, bool):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise InputError(f"{name} is {reprlib.repr(value)}: give {meant}") from None


def several(name, values, meant):
    """Values that can be iterated over and are no text, a list; InputError for others.

    Parameters
    ----------
    name : str, of the argument
    values : object
    meant : str, what is to be given
    """
    try:
        if isinstance(values, (str, bytes)):
            raise TypeError
        return list(values)
    except TypeError:
        raise InputError(f"{name} is {reprlib.repr(values)}: give {meant}") from None


def a_path(name, value, meant):
    """A value that is a path, a str or `os.PathLike`; InputError for one that is not.

    Parameters
    ----------
    name : str, of the argument
    value : object
    meant : str, what is to be given
    """
    if not isinstance(value, (str, os.PathLike)):
        raise InputError(f"{name} is {reprlib.repr(value)}: give {meant}")
    return value


def unpicklable(instead):
    """A decorator of classes whose objects are neither pickled nor copied: TypeError, as ``pickle``
    and ``copy`` have it, says what is, in their place."""
    def decorated(cls):
        def refuse(made, protocol):
            raise TypeError(f"a {cls.__name__} is neither pickled nor copied: {instead}")

        cls.__reduce_ex__ = refuse
        return cls
    return decorated
