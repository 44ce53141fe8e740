"""What the library asks Python for while it works, and what goes wrong there, which it cannot pass
on: its caller does."""

import ctypes

import numpy as np

from . import structures

_raised = []


def asked(kind, act):
    """A function for the library: what it raises is kept, and told by its status.

    Parameters
    ----------
    kind : type of the function, of `structures`
    act : function of its arguments
    """
    def told(*given):
        try:
            act(*given)
        except BaseException as error:
            _raised.append(error)
            return structures.FAILED
        return 0

    return kind(told)


def raise_error():
    """Raise what was raised first while the library worked, if anything was."""
    if _raised:
        error = _raised[0]
        _raised.clear()
        raise error


def sums(add_up):
    """What the library sums up numbers over processes by.

    Parameters
    ----------
    add_up : function of an array, which it changes
    """
    return asked(structures.AddUp, lambda place, count: add_up(np.frombuffer(
        (ctypes.c_double * count).from_address(place))))
