"""Functions that are called in several processes at a time, which begin with all that this one
holds: nothing is read or made twice for them."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

_FUNCTIONS = []
"""Those that are called now: a process finds them where it was forked off."""


def called(functions, workers):
    """Iterate over the values of functions without arguments, in their order; values have to be
    picklable, functions need not.

    Parameters
    ----------
    functions : list of callables
    workers : int, processes
    """
    _FUNCTIONS[:] = functions
    with ProcessPoolExecutor(workers, multiprocessing.get_context("fork")) as pool:
        yield from pool.map(_call, range(len(functions)))


def _call(number):
    return _FUNCTIONS[number]()
