"""The equations of a displacement form in the library: residual and products on the memory of the
Python form that they are the twin of."""

import ctypes
import math
import weakref

import numpy as np

from . import structures
from .asked import raise_error, sums
from .laws import kernel_of
from .responses import response
from .sides import CompiledSides
from .slab_even import OfFolded
from .slab_real import SlabReal
from .structures import TOO_MANY, address
from .transforms import Compiled

KEPT = 2 ** 14
"""Numbers of a tangent up to which that of a residual is kept for a linearisation at the same
unknown."""


def twin(form, half, scale=None):
    """A CompiledForm of a form, or None where something in it is Python's alone.

    Parameters
    ----------
    form : DisplacementForm, HalfForm, or EvenForm with its ``half`` and ``scale``
    half : the form that has window, convolution and tangent: itself, or an EvenForm's
    scale : array (nodes), the unknown over the half form's; None: they are the same
    """
    law = kernel_of(half.contact.law)
    transform = getattr(half.convolution, "transform", None)
    if law is None or not isinstance(transform, (Compiled, CompiledSides, SlabReal, OfFolded)):
        return None
    return CompiledForm(form, half, law, scale)


def call(function, counter, *arguments):
    """Call what transforms; RuntimeError where these are more than a limit, or PETSc, which it may
    ask, has failed, and what Python raised that was asked.

    Parameters
    ----------
    function : of the library
    counter : Counter
    arguments : of the function
    """
    status = function(*arguments)
    if status == TOO_MANY:
        counter.check()
    if status:
        raise_error()
        raise RuntimeError(f"the library's {function.__name__} failed with status {status}")


class CompiledForm:
    """Residual, tangent and products of a form, on its memory.

    Parameters
    ----------
    form, half, scale : as of `twin`
    law : LawKernel

    Attributes
    ----------
    structure : of the library
    form : the Python form; loads, tangent, work and counts are the same memory
    """

    def __init__(self, form, half, law, scale):
        self.library, self.grid = half.convolution.transform.library, half.grid
        self._half = weakref.ref(half)  # which holds this object
        self.size, self.law = form.size, law
        own = self.structure = structures.Form(
            components=half.components, nodes=half.nodes, forced_count=len(half.forced),
            root=half.root, size=half.grid.size)
        own.forced[:len(half.forced)] = half.forced
        transform = half.convolution.transform
        self._response, kept = response(half.convolution, half.components,
                                        transform.folded or transform)
        weights = getattr(half.grid, "weights", None)
        # of more nodes the law costs less than the memory would
        roomy = half.tangent.size <= KEPT
        self._last = np.empty(half.count) if roomy else None
        self._ahead = np.empty_like(half.tangent) if roomy else None
        self._unscale = None if scale is None else 1.0 / scale
        self._kept = kept, weights, scale
        for name, array in {"scale": scale, "unscale": self._unscale, "weight": weights,
                            "initial_gap": half.initial_gap, "tangent": half.tangent,
                            "last": self._last, "ahead": self._ahead,
                            "rigid": half.rigid_compliance,
                            "far": half.far, "row_scale": half.row_scale, "target": half.row_target,
                            "drag": half.drag}.items():
            setattr(own, name, address(array))
        own.law, own.held = ctypes.pointer(law.structure), form.size - half.count
        if self.grid.shared:
            own.add_up = sums(self.grid.sum_up)
        own.response = ctypes.pointer(self._response)
        self._quick = None
        self._told, self._row = np.empty(3), np.empty(self._response.shape[1])
        self._places = address(self._row), address(self._told)
        self.reference = ctypes.addressof(own)

    @property
    def half(self):
        """The Python form that has window, convolution and tangent."""
        return self._half()

    def residual(self, unknown, out):
        """F."""
        call(self.library.residual, self.grid.counter, self.reference, address(unknown),
             address(out))
        return out

    def answers(self):
        """Whether the response to the last residual's tractions is in the transform still; it is so
        once, as whoever asks may overwrite it."""
        own, made = self.structure, self.grid.counter.made
        answered, own.answered = own.answered, -1.0
        return not self.grid.any(answered != made)

    def imbalance(self, displacement, scalars, reach, answered=False):
        """Norm of F at displacements, the largest imbalance at a node where the law acts, and
        whether it does anywhere, as of `contact.balance.asked`.

        Parameters
        ----------
        displacement : array (components, nodes), ranges of the law
        scalars : means of the force-controlled components, ranges of the law
        reach : normal gap within which the law acts, ranges
        answered : bool, whether the response to their tractions is in the transform (`answers`)
        """
        numbers, scalars = self._told, np.ascontiguousarray(scalars, dtype=float)
        displacement = np.ascontiguousarray(displacement)
        call(self.library.imbalance, self.grid.counter, self.reference, address(displacement),
             address(scalars), reach, *self._places, answered)
        if self.grid.shared:
            numbers[0] = self.grid.together(numbers[0])
            numbers[1:] = self.grid.largest(numbers[1:])
        return math.sqrt(numbers[0]), float(numbers[1]), numbers[2] > 0.0

    def linearise(self, unknown):
        """Take the law's tangent at the unknown."""
        self.library.linearise(self.reference, address(unknown))

    def regularised_step(self, stiffness, unknown, step):
        """Change a step (the update is unknown - step) where it is long, as
        `solvers.regularised.RegularisedStep`; whether it was changed here.

        Parameters
        ----------
        stiffness : float, kappa, phi_n/delta_n^2
        unknown, step : arrays of the form's size; the step is overwritten
        """
        changed = np.zeros(1, dtype=np.intc)
        self.library.regularised_step(self.reference, stiffness, address(unknown), address(step),
                                      address(changed))
        return bool(changed[0])

    def make_quick(self):
        """Have what products in single precision take, in the memory of those in double."""
        if self._quick is None:
            convolution = self.half.convolution
            self._quick = response(convolution, self.half.components,
                                   convolution.transform.single)
            self.structure.quick = ctypes.pointer(self._quick[0])

    def set_precision(self, single):
        """Have products, and the preconditioner, be in single precision from now on, or in
        double."""
        if single:
            self.make_quick()
        self.structure.single = single

    def apply_jacobian(self, vector, out, single=False):
        """out = J vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        return self._product(self.library.product, vector, out, single)

    def apply_transpose(self, vector, out, single=False):
        """out = J^T vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        return self._product(self.library.transposed_product, vector, out, single)

    def _product(self, function, vector, out, single):
        """out = a function of the library of a vector, in a precision."""
        self.set_precision(single)
        call(function, self.grid.counter, self.reference, address(vector), address(out))
        return out
