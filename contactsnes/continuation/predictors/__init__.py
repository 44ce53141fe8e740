"""Predictors, each a class in a file of this folder, where it is found: a new file suffices.

`PREDICTORS` has one of each by its name, in the order of their errors.
"""

import pkgutil
from importlib import import_module
from pathlib import Path

from .predictor import Predictor


def _found():
    """Name -> predictor, one of every class with a name that a file of this folder defines."""
    found = {}
    for entry in pkgutil.iter_modules([str(Path(__file__).parent)]):
        own = import_module(f"{__package__}.{entry.name}")
        found.update({cls.name: cls() for cls in vars(own).values()
                      if isinstance(cls, type) and issubclass(cls, Predictor) and cls.name
                      and cls.__module__ == own.__name__})
    return dict(sorted(found.items(), key=lambda item: (item[1].order, item[0])))


PREDICTORS = _found()


def in_words():
    """Names of the predictors and what they are, for the help."""
    return ", ".join(f"{name} ({known.meaning})" if known.meaning else name
                     for name, known in PREDICTORS.items())


def after_failure(predictor):
    """The predictor with which a step is tried again after one has failed, perhaps itself."""
    return PREDICTORS.get(predictor.retry, predictor)
