"""What is made of a thing, and kept with it."""

import weakref
from functools import lru_cache


class kept:
    """A method that keeps some of its last answers with its object, as `functools.lru_cache`.

    What it keeps does not hold the object: a ring of both, with all their arrays, would not be
    given back with the object's last use, but when Python looks for rings.

    Parameters
    ----------
    most : int, answers that are kept

    Attributes
    ----------
    made : function (object, ...) that makes them
    """

    def __init__(self, most):
        self._most = most

    def __call__(self, made):
        """The method that a function (object, ...) is."""
        self.made, self.__doc__ = made, made.__doc__
        return self

    def __set_name__(self, owner, name):
        """Learn the method's name."""
        self._name = name

    def __get__(self, thing, owner=None):
        """The method of an object, which from now on finds it without being asked here."""
        if thing is None:
            return self
        made, own = self.made, weakref.ref(thing)
        answers = vars(thing)[self._name] = lru_cache(maxsize=self._most)(
            lambda *given, **named: made(own(), *given, **named))
        return First(thing, answers)


class First:
    """A method the first time that it is asked for: it holds its object, which nobody else may.

    Parameters
    ----------
    thing : the object
    answers : function of `functools.lru_cache`
    """

    def __init__(self, thing, answers):
        self._thing, self._answers = thing, answers
        self.cache_clear = answers.cache_clear

    def __call__(self, *given, **named):
        """An answer."""
        return self._answers(*given, **named)
