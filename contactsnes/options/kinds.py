"""Kinds of options, by their defaults."""

from numbers import Integral, Real
from unicodedata import normalize

KINDS = ((bool, "flag"), (Integral, "integer"), (Real, "number"), (str, "text"))


def kind_of(default):
    """The kind of an option by its default; TypeError, in words, of one that tells none."""
    for own_type, kind in KINDS:
        if isinstance(default, own_type):
            return kind
    raise TypeError(f"an option has the default {default!r}, but is a number, a text, True or "
                    "False: several values are several options")


def spelled(text, choices):
    """The one of some texts that a text is in other letters that look like it (a micro sign and a
    Greek mu), else the text itself."""
    return next((choice for choice in choices
                 if normalize("NFKC", choice) == normalize("NFKC", text)), text)
