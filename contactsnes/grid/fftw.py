"""pyfftw without what it has besides FFTW: its interfaces import a good part of SciPy, which takes
as long as NumPy does, and are left until someone asks for them."""

import importlib
import sys
from types import ModuleType

LEFT = "interfaces"


def _on_demand(name):
    """What a module lacks, by its name."""
    if name != LEFT:
        raise AttributeError(f"module 'pyfftw' has no attribute {name!r}")
    return importlib.import_module(f"pyfftw.{LEFT}")


def _imported():
    """The module pyfftw."""
    left = f"pyfftw.{LEFT}"
    if "pyfftw" in sys.modules:
        return sys.modules["pyfftw"]
    sys.modules[left] = ModuleType(left)
    try:
        found = importlib.import_module("pyfftw")
    finally:
        del sys.modules[left]
    vars(found).pop(LEFT, None)
    found.__getattr__ = _on_demand
    return found


pyfftw = _imported()
