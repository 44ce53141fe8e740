"""A statement of the paper in numbers: what is measured, on two grids, with its error bar, and the
verdict that follows."""

from typing import NamedTuple

import numpy as np

from contactsnes.output.files import ArchiveError

ALL = []
"""The statements: functions from (results, results on finer grids) to a Statement."""
ORDER = ("statements_pressed", "statements", "statements_residual", "statements_theory",
         "statements_more")
"""Their modules in the order of the table."""
MISSING = (KeyError, IndexError, ArchiveError)
"""What functions of results raise where a run is missing or too short."""


class Statement(NamedTuple):
    """A row of the table.

    place : where in the paper; text : what it says; measure : how it is measured here; found : what
        comes out, with errors;
    verdict : "confirmed", "confirmed within ...", "not confirmed", and why
    """

    place: str
    text: str
    measure: str
    found: str
    verdict: str


class Number(NamedTuple):
    """A number that is found.

    label : what of, may be empty; unit : "%" for a share, which is told in percent; spread : half
        width of the interval in which
    it lies apart from the error of the grid (a confidence interval, a load step); exact : whether
    no run is behind it
    """

    label: str
    value: float
    unit: str = ""
    spread: float = 0.0
    exact: bool = False


def evaluated(function, *arguments):
    """(value of a function of results, None), or (None, what is missing): a run, its fields, or an
    onset that it has not reached.

    What is missing is a sentence that names the run, if the results know which one they were asked
    for last.
    """
    try:
        return function(*arguments), None
    except MISSING as error:
        missing = error
    except (AttributeError, TypeError) as error:
        if "NoneType" not in str(error):
            raise
        missing = error
    asked = next((one for one in reversed(arguments) if getattr(one, "asked", None)), None)
    return None, asked.lacking() if asked is not None else str(missing)


def statement(place, text, measure):
    """Decorator: a function of results that gives (list of Number or of (heading, list of Number),
    verdict) is one of the statements."""
    def wrap(function):
        def stated(results, finer=None):
            found, verdict = function(results)
            again = None if finer is None else evaluated(function, finer)[0]
            return Statement(place, text, measure, told(found, again and again[0]), verdict)
        stated.__name__, stated.__doc__ = function.__name__, function.__doc__
        stated.__module__ = function.__module__
        stated.numbers = lambda results: listed(function(results)[0])
        ALL.append(stated)
        return stated
    return wrap


def in_order():
    """The statements in the order of the table."""
    return sorted(ALL, key=lambda one: ORDER.index(one.__module__))


def row(one, results, finer=None):
    """The row of a statement; one whose runs are missing, or did not come far enough, says so."""
    found, error = evaluated(one, results, finer)
    return found or Statement("", one.__name__.replace("_", " "), "",
                              f"a run is missing or too short: {error}", "open")


def listed(found):
    """(heading, label) -> value of the numbers of a statement."""
    if found and isinstance(found[0], Number):
        found = [("", found)]
    return {(heading, number.label): number.value for heading, numbers in found
            for number in numbers}


def told(found, again=None):
    """Text of numbers with their error bars: the larger of the spread and of the change on finer
    grids, ``again``."""
    if found and isinstance(found[0], Number):
        found, again = [("", found)], None if again is None else [("", again)]
    others = {(heading, place): number for heading, numbers in again or ()
              for place, number in enumerate(numbers)}
    return "; ".join(heading + ": " * bool(heading)
                     + ", ".join(_told(number, others.get((heading, place)))
                                 for place, number in enumerate(numbers))
                     for heading, numbers in found)


def _told(number, other):
    error = number.spread
    if other is not None:
        error = max(error, abs(other.value - number.value))
    # What does not change at all has not been made again.
    known = (number.exact or number.spread > 0.0
             or other is not None and (other.value != number.value or number.value == 0.0))
    return (number.label + ": " * bool(number.label) + with_error(number.value, error, number.unit)
            + ("" if known else " ± ?"))


def with_error(value, error, unit=""):
    """A value with as many digits as its error leaves it, and the error; a share in percent for the
    unit "%"."""
    scale = 100.0 if unit == "%" else 1.0
    value = scale * value
    error = scale * error
    end = f" {unit}" * bool(unit)
    if not error > 1e-9 * abs(value):
        return f"{value:.4g}{end}"
    whole = int(np.floor(np.log10(abs(value)))) + 1 if value else 0
    digits = int(np.clip(whole - np.floor(np.log10(error)), max(whole, 1), max(6, whole)))
    return f"{value:#.{digits}g} ± {error:.1g}{end}".replace("e-0",
                                                             "e-").replace(".e",
                                                                           "e").replace(". ", " ")
