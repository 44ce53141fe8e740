"""Traction laws in the library."""

import copy
import ctypes

import numpy as np

from . import structures
from .library import shared
from .structures import address

TEMPORARY = {"modified": ("law_modified", "law_modified_normal", ("residual_friction", "residual_adhesion"))}


class LawKernel:
    """A law's functions in a library and its parameters.

    Parameters
    ----------
    law : Law
    functions : (sheared, normal), addresses
    parameters : the numbers that the formula names, in their order
    library : what keeps the functions
    """

    def __init__(self, law, functions, parameters, library):
        self._parameters, self._library = np.array([*parameters, 0.0], dtype=float), library
        self.structure = structures.Law(*functions, address(self._parameters), law.normal_peak,
                                        law.repulsion)
        self._reference, self._evaluate = ctypes.addressof(self.structure), shared().evaluate
        self._plain = law.evaluate

    def __call__(self, gap, traction, tangent=None):
        """As `Law.evaluate`."""
        try:
            arrays = address(gap), address(traction), address(tangent)
        except ValueError:
            return self._plain(gap, traction, tangent)
        self._evaluate(self._reference, len(gap), gap.shape[1], *arrays)
        return traction


def kernel_of(law):
    """The LawKernel that a law was given, or None."""
    return vars(law).get("evaluate")


def with_kernel(law, cache):
    if kernel_of(law) is not None or law.name not in TEMPORARY:
        return law
    library = shared()
    a, b, names = TEMPORARY[law.name]
    functions = [ctypes.cast(getattr(library, n), ctypes.c_void_p).value for n in (a, b)]
    made = copy.copy(law)
    made.evaluate = LawKernel(law, functions, [getattr(law, n) for n in names], library)
    return made
