"""Values of options from the texts that they are typed as."""

import dataclasses

from .fields import InputError, allowed, number

BOOLEANS = {**dict.fromkeys(("", "true", "yes", "on", "1"), True),
            **dict.fromkeys(("false", "no", "off", "0"), False)}


def instance(cls, entries, prefix=""):
    """An instance of a dataclass of options from entries; nothing counts as used.

    Parameters
    ----------
    cls : a subclass of `fields.Options`
    entries : mapping, name (without dash) -> text, as of the database
    prefix : str, put before the class's own prefix
    """
    values = {}
    for field in dataclasses.fields(cls):
        name = prefix + cls.option_name(field.name)[1:]
        text = entries.get(name.lower())
        if text == "" and field.metadata["kind"] != "flag":
            rule = field.metadata
            what = f" ({rule['meaning']})" if rule["kind"] == "text" and not rule["choices"] else ""
            raise InputError(f"-{name} has no value: allowed is {allowed(rule)}{what}")
        if text is not None:
            values[field.name] = _parsed(text, field.metadata)
    try:
        return cls.typed(**values)
    except InputError as error:
        raise InputError(str(error).replace(f"-{cls.prefix}", f"-{prefix}{cls.prefix}")) from None


def _parsed(text, rule):
    """The value that a text stands for; a text that is of the wrong kind stays one, for the
    dataclass to refuse."""
    convert = {"flag": lambda word: BOOLEANS.get(word.lower(), word), "integer": _number(int),
               "number": _number(float), "text": str}[rule["kind"]]
    if rule["many"] in ("directions", "legs") and "," in text:
        return tuple(convert(part.strip()) for part in text.split(","))
    return convert(text.strip())


def _number(convert):
    """A conversion that returns the text where it is no number."""
    def converted(text):
        try:
            return number(text, convert)
        except ValueError:
            return text
    return converted
