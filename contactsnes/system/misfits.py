"""Packages that were compiled for another NumPy than the one that is there."""

import re
import sys
import traceback

SIGNS = re.compile("binary incompatibility|numpy.* failed to import|compiled .*numpy|_ARRAY_API",
                   re.IGNORECASE)
"""In what such a package says as it is imported."""
INNER = ("numpy", "importlib", "imp", "contactsnes")
"""What imports it, or is asked by it."""


def misfit(error):
    """Why a package cannot be used beside this NumPy, in words; an empty text of other errors.

    Parameters
    ----------
    error : Exception, with its traceback
    """
    numpy, lines = sys.modules.get("numpy"), str(error).splitlines()
    if numpy is None or not lines or not SIGNS.search(lines[0]):
        return ""
    frames = traceback.walk_tb(error.__traceback__)
    names = [frame.f_globals.get("__name__", "").partition(".")[0] for frame, _ in frames]
    package = next((name for name in reversed(names) if name not in INNER), "a package")
    return (f"{package} was compiled for another NumPy than {numpy.__version__}, which is in "
            f"{next(iter(numpy.__path__))} ({lines[0]}): install the one that it was compiled for "
            "(pip install 'numpy<2' where that is NumPy 1), or use the environment that "
            "scripts/setup makes")
