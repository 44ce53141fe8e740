"""Libraries that a base installation does without, imported where they are used."""

from importlib import import_module

from ..options.fields import InputError


def extra(library, name, purpose):
    """A library that belongs to an extra; InputError, which says how to get it, where it is
    missing.

    Parameters
    ----------
    library : str, the module
    name : str, the extra of the package
    purpose : str, what needs it
    """
    try:
        return import_module(library)
    except ImportError as error:
        package = library.partition(".")[0]
        raise InputError(f"{purpose} needs {package} ({error}): pip install {package}, or "
                         f"contactsnes[{name}]") from None
