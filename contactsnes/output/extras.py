"""Libraries that a base installation does without, imported where they are used."""

from importlib import import_module
from importlib.util import find_spec

from ..options.fields import InputError


def extra(library, name, purpose):
    """A library that belongs to an extra; InputError, which says how to get it, where it is
    missing, or does not go with what is installed.

    Parameters
    ----------
    library : str, the module
    name : str, the extra of the package
    purpose : str, what needs it
    """
    try:
        return import_module(library)
    except (ImportError, ValueError, AttributeError) as error:  # as another NumPy makes them
        package = library.partition(".")[0]
        if find_spec(package):
            raise InputError(f"{purpose} needs {package}, whose version here does not work with "
                             f"others that are installed ({error}): install the one or the other "
                             f"in a version that does, for instance an older {package}") from None
        raise InputError(f"{purpose} needs {package} ({error}): pip install {package}, or "
                         f"contactsnes[{name}]") from None
