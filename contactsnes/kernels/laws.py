"""Traction laws in C: the package's own from the library, those of one's own compiled once and kept
in a cache."""

import copy
import ctypes

import numpy as np

from ..interface.laws import LAWS
from ..interface.laws.law import Law
from . import building, structures
from .law_text import OUTPUTS, functions, head
from .library import Unavailable, pointer, shared
from .structures import address

AGREEMENT = 1e-9
"""Largest difference between a compiled law and NumPy's, over the size of what is compared."""


class _Entry(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("sheared", ctypes.c_void_p),
                ("tractions", ctypes.c_void_p), ("normal", ctypes.c_void_p),
                ("parameters", ctypes.POINTER(ctypes.c_char_p))]


class LawKernel:
    """A law's ``evaluate``, compiled.

    Parameters
    ----------
    law : Law
    functions : (sheared, tractions, normal), addresses
    parameters : names of the numbers that its functions take, in their order
    library : what keeps the functions

    Attributes
    ----------
    reference : address of its structure
    """

    def __init__(self, law, functions, parameters, library):
        values = [float(getattr(law, name)) for name in parameters]
        self._parameters, self._library = np.array([*values, 0.0]), library
        self.structure = structures.Law(*functions, address(self._parameters), law.normal_peak,
                                        law.barrier, law.repulsion)
        self.reference, self._call = ctypes.addressof(self.structure), shared().evaluate

    def __call__(self, gap, traction, tangent=None):
        """As `Law.evaluate`."""
        gap = np.ascontiguousarray(gap, dtype=float)
        outputs = [array if array is None or array.flags.c_contiguous else np.empty(array.shape)
                   for array in (traction, tangent)]
        self._call(self.reference, len(gap), gap.shape[1], address(gap),
                   *(address(array) for array in outputs))
        for wanted, filled in zip((traction, tangent), outputs):
            if filled is not wanted:
                wanted[...] = filled
        return traction

    def normal(self, a):
        """As `Law.normal`."""
        gap = np.array(a, dtype=float).reshape(1, -1)
        slope = np.empty((1, *gap.shape))
        self(gap, gap, slope)
        return gap[0], slope[0, 0]

    def gap_of_regularised(self, target, stiffness):
        """As `Law.gap_of_regularised`."""
        found = np.array(target, dtype=float)
        shared().gaps_of_regularised(self.reference, found.size, address(found), stiffness,
                                     address(found))
        return found

    def works(self, gap, change, parts, rule):
        """What each node releases on a straight way, and what linear springs do there, array (2,
        nodes), as `acceptance._works`.

        Parameters
        ----------
        gap, change : arrays (components, nodes), ranges of the law
        parts : weights of the components
        rule : (places, shares, trifle) of the quadrature
        """
        places, shares, trifle = rule
        gap, change = (np.ascontiguousarray(array, dtype=float) for array in (gap, change))
        found = np.empty((2, gap.shape[1]))
        shared().works(self.reference, *gap.shape, address(gap), address(change), address(parts),
                       len(places), address(places), address(shares), trifle, address(found))
        return found

    def __deepcopy__(self, memory):
        return self


def kernel_of(law):
    """The LawKernel that a law was given, or None."""
    found = vars(law).get("evaluate")
    return found if isinstance(found, LawKernel) else None


def with_kernel(law, cache):
    """A law that is evaluated in C; itself if it is.

    Parameters
    ----------
    law : Law
    cache : folder where compiled laws of one's own are kept

    Raises
    ------
    Unavailable : where it cannot be, with the reason
    """
    if kernel_of(law) is not None:
        return law
    if LAWS.get(law.name) is type(law):
        kernel = LawKernel(law, *_of_package(law.name), shared())
    else:
        kernel = _compiled(law, cache)
    made = copy.copy(law)
    vars(made)["evaluate"] = kernel
    if type(law).normal is Law.normal:
        vars(made)["normal"] = kernel.normal
        if type(law).gap_of_regularised is Law.gap_of_regularised:
            vars(made)["gap_of_regularised"] = kernel.gap_of_regularised
    return made


def _of_package(name):
    """(functions, names of parameters) of a law of the package."""
    # a table that ends with an entry without a name
    table = ctypes.cast(pointer(shared(), "traction_laws"), ctypes.POINTER(_Entry))
    wanted = name.encode()
    place = 0
    while table[place].name is not None:
        entry = table[place]
        if entry.name == wanted:
            names = []
            while entry.parameters[len(names)] is not None:
                names.append(entry.parameters[len(names)].decode())
            return (entry.sheared, entry.tractions, entry.normal), names
        place += 1
    raise Unavailable(f"the library has no law {name}")


def _compiled(law, cache):
    """The LawKernel of a law that the library does not have; Unavailable where there is none."""
    formula = law.formula
    if formula is None:
        raise Unavailable(f"the law {type(law).__name__} has an evaluate of its own: write "
                          "tractions(a, b) in place of it")
    text = functions(formula, "law")
    library = building.compiled(head(text) + text, cache)
    kernel = LawKernel(law, [pointer(library, f"law{kind}") for kind in OUTPUTS],
                       formula.parameters, library)
    _compare(law, kernel)
    return kernel


def _compare(law, kernel):
    """Unavailable where a compiled law differs from NumPy's, at gaps and slips within which it is
    sampled and where it is continued."""
    gaps = np.concatenate([np.linspace(law.deepest * 1.1, 0.0, 40),
                           np.linspace(0.0, law.opening_range, 40)])
    gap = np.array(np.meshgrid(gaps, np.linspace(0.0, law.slip_range, 25))).reshape(2, -1)
    for components in (1, 2):
        part = gap[:components]
        expected = law.traction(part), law.tangent(part)
        found = np.empty_like(expected[0]), np.empty_like(expected[1])
        kernel(part, *found)
        for one, other in zip(expected, found):
            # of all of a node's numbers: in deep overlap some may be what is left of large ones
            size = 1.0 + np.abs(one).reshape(-1, one.shape[-1]).max(axis=0)
            if not np.all(np.abs(one - other) <= AGREEMENT * size):
                raise Unavailable(f"the law {type(law).__name__}, compiled, differs from NumPy's "
                                  f"by {np.nanmax(np.abs(one - other) / size):.2g}")
