"""Options as fields of frozen dataclasses: meaning, unit, default and range in one place, and their
checks."""

from __future__ import annotations

import dataclasses
import math
import operator
import os
import re
from functools import lru_cache
from typing import ClassVar

from .kinds import kind_of, spelled
from .likeness import meant, nearest


class InputError(ValueError):
    """Bad input: one sentence with the option, its value, what is allowed and what to try."""


def option(default, meaning, unit="", *, kind=None, minimum=None, maximum=None, above=None,
           below=None, choices=None, many=None, infinite=False, even=False, word=None, also=None,
           default_text=None):
    """A dataclass field that is an option of the database.

    Parameters
    ----------
    default : value of the field; None where it depends on others (`default_text` then says how)
    meaning, unit : str, for the help; an empty unit is dimensionless
    kind : 'flag', 'integer', 'number' or 'text'; by default the type of `default`
    minimum, maximum : bounds that are allowed themselves
    above, below : bounds that are not
    choices : tuple of the allowed values
    many : None for one value; else a comma separates 'directions' (one or two), 'legs' or a 'list'
    infinite : whether inf is allowed
    even : whether an integer has to be even
    word : a text that is allowed besides
    also : function (text), whether it is allowed, where ``word`` stands for many
    default_text : str, the default as the help says it
    """
    kind = kind or kind_of(default)
    rule = dict(meaning=meaning, unit=unit, kind=kind, minimum=minimum, maximum=maximum,
                above=above, below=below, choices=choices, many=many, infinite=infinite, even=even,
                word=word, also=also, known=default not in (None, ""),
                default_text=as_text(default) if default_text is None else default_text)
    return dataclasses.field(default=default, metadata=rule)


WITH_UNIT = re.compile(r"[+-]?[\d.]+(e[+-]?\d+)?\s*(?!e[+-]?\d+$)[^\W\d].*", re.ASCII | re.I)
"""A number and a word behind it, which is no exponent."""

LARGEST = 1e30
"""Size up to which numbers are computed with, 1 / it the least: a few products do not overflow."""


def computable(value):
    """Whether a number is 0, inf or nan, or of a size whose powers neither overflow nor vanish."""
    if isinstance(value, float) and not math.isfinite(value):  # (an int may be beyond floats)
        return True
    return value == 0 or 1 / LARGEST <= abs(value) <= LARGEST


def as_text(value):
    """A value as it is typed on the command line; None is an empty text."""
    if isinstance(value, (tuple, list)):
        return ",".join(map(as_text, value))
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(float(value)).removesuffix(".0")
    return "" if value is None else str(value)


def allowed(rule):
    """What the metadata `rule` of a field allow, in words."""
    if rule["choices"]:
        text = ("one of " if len(rule["choices"]) > 1
                else "only ") + ", ".join(map(as_text, rule["choices"]))
    else:
        text = {"flag": "true or false", "text": "text", "number": "a number",
                "integer": "an even number" if rule["even"] else "a whole number"}[rule["kind"]]
        words = (("above", "above"), ("minimum", "at least"), ("below", "below"),
                 ("maximum", "at most"))
        # Computed bounds differ in their last bit from machine to machine.
        rounded = {key: float(f"{rule[key]:.9g}") if isinstance(rule[key], float) else rule[key]
                   for key, _ in words}
        bounds = [f"{word} {as_text(rounded[key])}" for key, word in words if rule[key] is not None]
        text = " ".join([text, " and ".join(bounds)]).strip() + (", or inf" if rule["infinite"]
                                                                 else "")
    several = {None: "", "directions": "; one, or one per direction with a comma",
               "legs": "; one, or one per leg with commas", "list": "; several with a comma"}
    return text + several[rule["many"]] + (f"; or {rule['word']}" if rule["word"] else "")


def number(text, convert=float):
    """The number that a text stands for; ValueError, too, for other digits than 0 to 9, for
    underscores, which Python reads, and for a number beyond all floats, which it takes for inf."""
    found = convert(text)
    beyond = convert is float and math.isinf(found) and any(map(str.isdigit, text))
    if not text.isascii() or "_" in text or beyond:
        raise ValueError(f"{text!r} is no number")
    return found


def _single(value, rule):
    """The value in the type of its field; ValueError or TypeError where the rule forbids it."""
    kind = rule["kind"]
    if isinstance(value, str) and value == "inf" and rule["infinite"]:  # as help and files write it
        value = math.inf
    value = os.fspath(value) if kind == "text" and isinstance(value, os.PathLike) else value
    own_type = {"flag": bool, "text": str}.get(kind)
    if not isinstance(value, own_type) if own_type else isinstance(value, (bool, str, bytes)):
        raise TypeError
    value = {"flag": bool, "text": str, "integer": operator.index, "number": float}[kind](value)
    if kind == "text" and rule["choices"]:
        value = spelled(value, rule["choices"])
    outside = (("choices", lambda a, b: a not in b), ("minimum", operator.lt),
               ("maximum", operator.gt), ("above", operator.le), ("below", operator.ge))
    if any(rule[key] is not None and fails(value, rule[key]) for key, fails in outside):
        raise ValueError
    if kind in ("number", "integer") and not computable(value) or rule["even"] and value % 2:
        raise ValueError
    if kind == "number" and (math.isnan(value) or (math.isinf(value) and not rule["infinite"])):
        raise ValueError
    return value


def _advice(value, rule):
    """What to give in place of a value that is not allowed: the choice most like it, else the
    default, if there is one."""
    choices = list(map(as_text, rule["choices"] or ()))
    alike = [choice for choice in choices if choice.lower() == as_text(value).lower()]
    guess = alike[0] if alike else nearest(as_text(value), choices)
    if guess or rule["known"]:
        return f"; try {guess or rule['default_text']}"
    without = not rule["default_text"] or rule["default_text"].startswith("none")
    return "" if without else f"; left out, it is {rule['default_text']}"


def _shown(value, items, rule):
    """A value as a sentence has it that refuses it: as it is typed, and what it is, where its text
    would do."""
    text = as_text(value)
    if isinstance(value, (tuple, list)) and rule["many"] is None:
        return f"'{text}', a list"
    if not text or rule["kind"] == "text":
        return f"'{text}'"
    told = {str: "text", bytes: "bytes"}
    if rule["kind"] == "integer":
        told[float] = "a number with a decimal point"
    for item in items:
        kind = told.get(type(item), "")
        if kind and _is_typed(as_text(item), rule):
            return f"'{text}', {kind}"
    return f"'{text}'"


def _is_typed(text, rule):
    """Whether an option takes a text that is typed on the command line."""
    if rule["kind"] == "flag":
        return text.lower() in ("true", "false", "yes", "no", "on", "off")
    try:
        _single(number(text, {"integer": int, "number": float}[rule["kind"]]), rule)
    except (ValueError, TypeError, OverflowError):
        return False
    return True


def checked(name, value, rule):
    """The value of option `name`, or InputError.

    Parameters
    ----------
    name : str, with its dash, for the sentence
    value : number, text, bool or a sequence of them
    rule : mapping, the metadata of the option's field
    """
    if isinstance(value, str) and (rule["also"](value) if rule["also"] else value == rule["word"]):
        return value
    value = value.tolist() if hasattr(value, "tolist") else value  # of NumPy: as Python has it
    several = isinstance(value, (tuple, list)) and rule["many"] is not None
    if rule["many"] == "list" and isinstance(value, str):
        value, several = tuple(part.strip() for part in value.split(",")), True
    try:
        values = tuple(_single(item, rule) for item in (value if several else (value,)))
        if not values or (rule["many"] == "directions" and len(values) > 2):
            raise ValueError
    except (ValueError, TypeError, OverflowError):
        items = value if isinstance(value, (tuple, list)) else (value,)
        beyond = any(isinstance(item, (int, float)) and not computable(item) for item in items)
        measured = rule["kind"] == "number" and any(map(WITH_UNIT.fullmatch, map(as_text, items)))
        raise InputError(f"{name} is {_shown(value, items, rule)}: allowed is {allowed(rule)}"
                         + (f", of a size from {1 / LARGEST:g} to {LARGEST:g}" if beyond else "")
                         + ", typed without its unit" * measured + _advice(value, rule)) from None
    if rule["many"] == "list":
        return ",".join(values)
    return values if len(values) > 1 else values[0]


@lru_cache(maxsize=1024)
def _default(cls, field):
    """`checked` of the default of a field of a class, which most values are."""
    return checked(cls.option_name(field.name), field.default, field.metadata)


COMMON = []
"""Dataclasses of options that every command knows, in the order of the help."""


def extend(cls, *groups):
    """Give a dataclass of options more of them, after its own, as a scene gets those of its law:
    groups of fields by name. Instances made before have the defaults."""
    known, wanted = dict(cls.__dataclass_fields__), []
    for name, field in (item for group in groups for item in group.items()):
        if known.setdefault(name, field).metadata != field.metadata:
            raise TypeError(f"{cls.option_name(name)} is declared twice, differently")
        wanted += [] if name in cls.__dataclass_fields__ or name in wanted else [name]
    if not wanted:
        return
    added = [(name, type(known[name].default), _fresh(known[name])) for name in wanted]
    wider = dataclasses.make_dataclass(cls.__name__, added, bases=(cls,), frozen=True)
    for name in ("__init__", "__eq__", "__hash__", "__match_args__", "__dataclass_fields__"):
        setattr(cls, name, getattr(wider, name))
    for name, _, field in added:
        setattr(cls, name, field.default)


def _fresh(field):
    """A field that no class has yet, with the default and the metadata of another."""
    return dataclasses.field(default=field.default, metadata=field.metadata)


def declare(*classes):
    """Make dataclasses of options known to every command; the classes."""
    COMMON.extend(classes)
    return classes


class Options:
    """Base of the frozen dataclasses of options: checks every field by its metadata (InputError).

    A subclass has a `prefix`, with which all its options begin, and a `title` for the help; its
    fields are made by `option`.
    """

    prefix: ClassVar[str]
    title: ClassVar[str]

    def __new__(cls, *values, **named):
        """An instance that is yet to be filled; InputError for a name that is none of a field."""
        cls.refuse_unknown(named)
        return super().__new__(cls)

    @classmethod
    def refuse_unknown(cls, names):
        """InputError for a name that is none of a field, with the one that may be meant."""
        for name in names:
            if name not in cls.__dataclass_fields__:
                known = [field.name for field in dataclasses.fields(cls)]
                raise InputError(f"{name} is no option of {cls.__name__}"
                                 + meant(name, known, f": it has {', '.join(known)}"))

    def __post_init__(self):
        cls = type(self)
        for field in dataclasses.fields(cls):
            value = getattr(self, field.name)
            if value is None and field.default is None:
                continue
            found = (_default(cls, field) if value is field.default
                     else checked(cls.option_name(field.name), value, field.metadata))
            if found is not value:
                object.__setattr__(self, field.name, found)

    def __repr__(self):
        """What makes the instance: the values that are no defaults."""
        given = [f"{field.name}={getattr(self, field.name)!r}" for field in dataclasses.fields(self)
                 if getattr(self, field.name) != field.default]
        return f"{type(self).__name__}({', '.join(given)})"

    @classmethod
    def typed(cls, **values):
        """The instance for values as they are typed."""
        return cls(**values)

    @classmethod
    def prepare(cls, entries):
        """Called before values are read: ``entries()`` are the options that are given, which may
        bring others with them."""

    @classmethod
    def rule(cls, field):
        """Metadata of a field: what its option means and allows."""
        return cls.__dataclass_fields__[field].metadata

    @classmethod
    def option_name(cls, field):
        """The option of a field as it is typed, for instance -scene_poisson; what Python keeps for
        itself (with) has an underscore there."""
        return f"-{cls.prefix}{field.rstrip('_')}"
