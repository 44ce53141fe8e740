"""Options of commands that need no PETSc: read from the words of a command line, checked by the
same dataclasses as all others."""

import dataclasses

from .fields import InputError, meant
from .files import is_option
from .values import BOOLEANS, instance


def asks_for_help(words):
    """Whether help is asked for."""
    return any(word in ("-h", "-help", "--help") for word in words)


def read_words(words, cls, others=None):
    """(files, instance of a dataclass of options) that the words of a command line stand for.

    Options have one dash or two; an argument after one is its value, or comes after ``=``.

    Parameters
    ----------
    words : list of str
    cls : dataclass of options
    others : mapping, other names (without dash) of options -> (name, value); a value of None: what
        is typed

    Raises
    ------
    InputError : for an option that there is not, or a value that is not allowed
    """
    known = {cls.option_name(field.name)[1:]: field.metadata["kind"]
             for field in dataclasses.fields(cls)}
    files, found, name = [], {}, ""
    for word in words:
        if name and not is_option(word) and _is_value(word, known[name]):
            found[name], name = word, ""
        elif is_option(word):
            typed, equals, value = word.lstrip("-").partition("=")
            name, fixed = (others or {}).get(typed.lower(), (typed.lower(), None))
            _check(word, name, known)
            found[name] = value if fixed is None else fixed
            name = "" if equals or fixed is not None else name
        else:
            files.append(word)
            name = ""
    return files, instance(cls, found)


def _is_value(word, kind):
    """Whether a word after an option is its value: of a flag only true or false."""
    return kind != "flag" or word.lower() in BOOLEANS


def _check(word, name, known):
    """InputError for an option that there is not."""
    if name not in known:
        there = f": there are {', '.join('-' + name for name in known)}"
        raise InputError(f"{word.partition('=')[0]} is no option here"
                         + meant(name, known, there, "-"))
