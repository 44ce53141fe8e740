"""The displacement form on half a line or a quarter of a plane, for states that are even about the
apex, and when it serves."""

from functools import cached_property

import numpy as np

from ..grid.boxes import cost
from ..grid.even import EvenConvolution, EvenWindow, asymmetry, centred, lone, obstacle
from ..kernels.forms import twin
from ..options.fields import InputError
from .force_form import FORMS
from .forms import DisplacementForm
from .states import State, normal_gap, onto

EVEN = 1e-6
"""Largest difference of mirror images in a state that counts as even, ranges of the law."""


class HalfForm(DisplacementForm):
    """The equations at the nodes of an even window, each once, whatever number of nodes it stands
    for.

    Unknown and F are v and r over sqrt(M), M = nodes x components of the full window, as in the
    full form.

    Parameters
    ----------
    contact, controls : as of `DisplacementForm`
    window : EvenWindow
    """

    convolution_class = EvenConvolution

    def __init__(self, contact, window, controls):
        super().__init__(contact, window, controls)
        self.root = np.sqrt(self.components * window.full.size)


class EvenForm:
    """The displacement form for even states on a centred window: its equations, those at mirror
    images as one.

    Unknown and F at a node that stands for w nodes are sqrt(w) times those of the full form. So
    norms and inner products are the full form's: F has its ``residual_norm``, and a Krylov method
    takes the same steps. States are those of the full window.

    Parameters
    ----------
    contact, window, controls : as those of `forms.DisplacementForm`, the window centred

    Attributes
    ----------
    half : HalfForm
    root : array (nodes), the displacement over the unknown, ranges of the law
    """

    name = "displacement"
    in_displacements, whole_cell, even = True, False, True
    linear_tolerance = DisplacementForm.linear_tolerance

    def __init__(self, contact, window, controls):
        even = EvenWindow(window)
        self.half = half = HalfForm(contact, even, controls)
        self.contact = contact
        self.window = window
        self.controls = half.controls
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
        self._scale = np.append(np.tile(scale, self.components), np.ones(len(half.forced)))
        self._plain = np.empty(self.size)

    @cached_property
    def kernel(self):
        """The same equations on the same memory in the library, or None."""
        return twin(self, self.half, self.node_scale)

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
        return self.half.evaluations + (self.kernel.structure.evaluations if self.kernel else 0)

    @property
    def products(self):
        """Number of products with the Jacobian so far."""
        return self.half.products + (self.kernel.structure.products if self.kernel else 0)

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

    def displacement(self, unknown):
        """Displacements (components, nodes of the full window), ranges of the law."""
        return self.half.window.unfold(self.half.displacement(self.plain(unknown)))

    def scalars(self, unknown):
        """Mean displacements of the force-controlled components, ranges of the law."""
        return unknown[self.count:]

    state = DisplacementForm.state

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

    def apply_jacobian(self, vector, out):
        """out = J vector at the last linearisation."""
        if self.kernel:
            return self.kernel.apply_jacobian(vector, out)
        return self.scaled(self.half.apply_jacobian(self.plain(vector), out))

    def apply_transpose(self, vector, out):
        """out = J^T vector at the last linearisation: the half form's is the adjoint in the inner
        product with weights."""
        if self.kernel:
            return self.kernel.apply_transpose(vector, out)
        return self.scaled(self.half.apply_transpose(self.plain(vector), out))

    def load_derivative(self, direction, out):
        """out = dF/ds for controlled values that move by ``direction`` per unit of s."""
        return self.scaled(self.half.load_derivative(direction, out))


class Symmetry:
    """Whether the solves of a corrector take states for even: where contact and method allow it,
    until a state is not.

    Parameters
    ----------
    contact : Contact
    settings : Form, with ``symmetry`` 'auto', 'even' or 'off'
    method : Capabilities of the type of SNES
    log : function (sentence)
    """

    def __init__(self, contact, settings, method, log):
        self.contact = contact
        self.log = log
        self.asked = settings.symmetry == "even"
        self._half = None  # the last window of states made even
        self.wanted = settings.symmetry != "off" and method_obstacle(settings, method) is None

    def holds(self, components):
        """Whether states with so many components are taken for even."""
        return self.wanted and obstacle(self.contact, components) is None

    def checked(self, state):
        """The state; if it is not even where it should be, no state is taken for even from now
        on."""
        if self.holds(len(state.displacement)) and not self._is_even(state):
            self.leave("the state is not even about the apex")
        return state

    def _is_even(self, state):
        """Whether mirror images in a state are alike, and the law acts where there is one only
        nowhere."""
        if not asymmetry(state.window, state.displacement) <= EVEN:
            return False
        if centred(state.window) == state.window:
            return True
        unpaired = lone(state.window)
        return self.contact.grid.minimum(normal_gap(self.contact, state),
                                         where=unpaired) >= self.contact.law.certain

    def leave(self, why):
        """Take no state for even from now on, for a reason in words."""
        self.wanted = False
        self.log(f"{why}: going on without symmetry")

    def centred(self, state):
        """The state on a centred window, if it is taken for even: half of one box, in place of
        several where that is cheaper."""
        self.checked(state)
        window = centred(state.window) if self.holds(len(state.displacement)) else state.window
        if (len(window.parts) < len(state.window.parts) and not self.asked
            and 2.0 * cost(state.window) < cost(window)):
            self.leave("boxes around the spots cost less than half of one window")
            return state
        return state if window == state.window else State(window, onto(state, window), state.means)

    def halves(self, state):
        """Whether a state is taken for even, on a window about the apex."""
        return self.holds(len(state.displacement)) and centred(state.window) == state.window

    def mirrored(self, state):
        """A state predicted from even ones, or None, made even: places of the cell's first node
        have no mirror image."""
        if state is None or not self.holds(len(state.displacement)):
            return state
        window = centred(state.window)
        half = self._folded(window)
        return State(window, half.unfold(half.fold(onto(state, window))), state.means)

    def half_of(self, window, components):
        """The EvenWindow of a window on which states with so many components are taken for even;
        None of another."""
        return (self._folded(window) if self.holds(components) and centred(window) == window
                else None)

    def _folded(self, window):
        """The EvenWindow of a centred window; the last one is kept."""
        if self._half is None or self._half.full != window:
            self._half = EvenWindow(window)
        return self._half

    def form(self, components):
        """The class of displacement forms for states with so many components."""
        return EvenForm if self.holds(components) else DisplacementForm


def method_obstacle(settings, method):
    """Why a form of the equations, or a type of SNES on it, does not use even states, in words;
    None if it does."""
    if FORMS[settings.form].whole_cell and not method.is_relaxation:
        return f"the {settings.form} form is solved on the whole cell, but by dynamic relaxation"
    return (None if method.keeps_evenness
            else f"the method (-snes_type {method.name}) is neither Newton's nor a relaxation")


def refuse(contact, sheared, settings, method):
    """InputError where symmetry is asked for and a leg has none.

    Parameters
    ----------
    contact : Contact
    sheared : whether tangential unknowns appear at the start and in each leg
    settings : Form
    method : Capabilities of the type of SNES
    """
    why = obstacles(contact, sheared, settings, method) if settings.symmetry == "even" else []
    if any(why):
        raise InputError(f"-contact_symmetry is 'even', but {next(filter(None, why))}: "
                         "allowed here are auto and off")


def obstacles(contact, sheared, settings, method):
    """Why states are not taken for even at the start and in each leg, in words or None where they
    are, a list.

    Parameters
    ----------
    contact, sheared, settings, method : as of `refuse`
    """
    why = method_obstacle(settings, method)
    return [why or obstacle(contact, contact.scene.components if tangential else 1)
            for tangential in sheared]
