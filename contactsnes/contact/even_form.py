"""The displacement form on half a line or a quarter of a plane, for states whose components are
even or odd about the apex."""

from functools import cached_property
from weakref import ref

import numpy as np

from ..grid.even import halved
from ..grid.parity import parities as parities_of
from ..grid.sides import even_convolution
from ..kernels.forms import twin
from .forms import DisplacementForm
from .problem import DISPLACEMENT


class HalfForm(DisplacementForm):
    """The equations at the nodes of an even window, each once, whatever number of nodes it stands
    for.

    Unknown and F are v and r over sqrt(M), M = nodes x components of the full window, as in the
    full form. Components that are odd have neither a mean nor a load.

    Parameters
    ----------
    contact, controls : as of `DisplacementForm`
    window : EvenWindow
    """

    convolution_class = staticmethod(even_convolution)

    def __init__(self, contact, window, controls):
        odd = [-1 in signs for signs in window.parities or ((),) * len(controls)]
        super().__init__(contact, window, [DISPLACEMENT if without else control
                                           for control, without in zip(controls, odd)])
        self.rigid_compliance[odd] = 0.0
        self.root = np.sqrt(self.components * window.full.total)


class EvenForm:
    """The displacement form for even or odd states on a centred window: its equations, those at
    mirror images as one.

    Unknown and F at a node that stands for w nodes are sqrt(w) times those of the full form. So
    norms and inner products are the full form's: F has its ``residual_norm``, and a Krylov method
    takes the same steps. States are those of the full window.

    Parameters
    ----------
    contact, window, controls : as those of `forms.DisplacementForm`, the window centred
    parities : for each component and direction 1 (even) or -1 (odd); None: as the body has them
        without loads along the surface
    even : EvenWindow of the window with these, if there is one

    Attributes
    ----------
    half : HalfForm
    root : array (nodes), the displacement over the unknown, ranges of the law
    """

    name = "displacement"
    in_displacements, whole_cell, even, has_single = True, False, True, True
    linear_tolerance = DisplacementForm.linear_tolerance

    def __init__(self, contact, window, controls, parities=None, even=None):
        count = len(controls)
        self.parities = parities or parities_of(contact.operator(count), count)
        even = halved(window, self.parities) if even is None else even
        self.half = half = HalfForm(contact, even, controls)
        self.contact = contact
        self.window = window
        self.controls = tuple(controls)
        self.grid = even.grid
        self.components = half.components
        self.nodes = half.nodes
        self.shape = half.shape
        self.count = half.count
        self.size = half.size
        self.forced, self.rigid_compliance = half.forced, half.rigid_compliance
        scale = np.sqrt(even.grid.weights)
        self.root = half.root / scale
        self.node_scale = scale
        self._scale = np.append(np.tile(scale, self.components), np.ones(half.size - half.count))
        self._plain = np.empty(self.size)
        self._made = None  # the last state, which may have no half of its own

    @cached_property
    def kernel(self):
        """The same equations on the same memory in the library, or None."""
        return twin(self, self.half, self.node_scale)

    @property
    def convolution(self):
        """The half form's."""
        return self.half.convolution

    @property
    def load(self):
        """The controlled values."""
        return self.half.load

    @property
    def far(self):
        """Far displacements of the controlled values, ranges of the law."""
        return self.half.far

    @property
    def evaluations(self):
        """Number of residuals evaluated so far."""
        own, half = self.kernel, self.half
        return half._evaluations + own.structure.evaluations if own else half.evaluations

    @property
    def products(self):
        """Number of products with the Jacobian so far."""
        own, half = self.kernel, self.half
        return half._products + own.structure.products if own else half.products

    def set_load(self, load):
        """Set the controlled values."""
        self.half.set_load(load)

    def plain(self, vector):
        """The half form's vector, in memory that the next call overwrites, for one of this form."""
        return np.divide(vector, self._scale, out=self._plain)

    def scaled(self, vector):
        """The half form's vector turned, in place, into one of this form."""
        return np.multiply(vector, self._scale, out=vector)

    def pack(self, displacement, scalars):
        """The unknown from displacements (components, nodes of the full window) and the means of
        force-controlled components."""
        return self.scaled(self.half.pack(self.half.window.fold(displacement), scalars))

    def nodal(self, state):
        """Displacements (components, nodes of the half) of a State on the form's window."""
        return (state.once if state.half == self.half.window
                else self.half.window.fold(state.displacement))

    def packed(self, state):
        """The unknown of a State on the form's window."""
        return self.scaled(self.half.pack(self.nodal(state), state.means[self.forced]))

    def displacement(self, unknown):
        """Displacements (components, nodes of the full window), ranges of the law."""
        return self.half.window.unfold(self.once(unknown))

    def once(self, unknown):
        """Displacements (components, nodes), ranges of the law, at nodes of the half, each once."""
        return self.half.displacement(self.plain(unknown))

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return self.half.scalars(unknown)

    def state(self, unknown):
        """The State of an unknown, as of `DisplacementForm`."""
        made = self.half.state(self.plain(unknown))
        self._made = ref(made)
        return made

    def tells(self, state):
        """Whether a state is known by half of its nodes, or is the last one that was made of these
        by this form."""
        return state.half is not None or (self._made is not None and self._made() is state)

    def gap(self, unknown):
        """Gap a (components, nodes), ranges of the law, in memory of the form."""
        return self.half.gap(self.plain(unknown))

    def residual(self, unknown, out):
        """F, whose norm is that of the full form."""
        if self.kernel:
            return self.kernel.residual(unknown, out)
        return self.scaled(self.half.residual(self.plain(unknown), out))

    def linearise(self, unknown):
        """Take the law's tangent at the unknown."""
        if self.kernel:
            self.kernel.linearise(unknown)
            return
        self.half.linearise(self.plain(unknown))

    def apply_jacobian(self, vector, out, single=False):
        """out = J vector at the last linearisation.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        if self.kernel:
            return self.kernel.apply_jacobian(vector, out, single)
        return self.scaled(self.half.apply_jacobian(self.plain(vector), out, single))

    def apply_transpose(self, vector, out, single=False):
        """out = J^T vector at the last linearisation: the half form's is the adjoint in the inner
        product with weights.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : bool, whether transforms are in single precision
        """
        if self.kernel:
            return self.kernel.apply_transpose(vector, out, single)
        return self.scaled(self.half.apply_transpose(self.plain(vector), out, single))

    def load_derivative(self, direction, out):
        """out = dF/ds for controlled values that move by ``direction`` per unit of s."""
        return self.scaled(self.half.load_derivative(direction, out))
