"""Preconditioners of the contact Jacobian, one for each form, and the thin PETSc context around
them."""

import weakref

import numpy as np

from ..contact.bordered import ArcLength
from ..contact.even_form import EvenForm
from ..contact.force_form import ForceForm
from ..contact.forms import DisplacementForm
from ..kernels.made_zones import AskedZone, MadeZone
from ..options.database import read
from ..options.fields import InputError
from . import callbacks
from .core_zone import CoreOptions, CoreZone, core_of
from .operators import form_of, precision_of


class ZonedStiffness:
    """Preconditioner of the force form: M^-1 = a (K + D)^-1 a + b (K + c)^-1 b for each component,
    a^2 + b^2 = 1.

    a^2 is the core's smoothed indicator, D the mean tangent there, c the smallest stiffness of the
    body. Where the body is rigid in the mean (displacement control, no rigid compliance) the mean
    is taken from its own row. A ``floor`` is not needed: nothing is eliminated.

    Parameters
    ----------
    form : ForceForm, linearised
    options : CoreOptions
    floor : float
    """

    def __init__(self, form, options=CoreOptions(), floor=0.0):
        self.form, self.grid = form, form.grid
        self.transform = form.grid.transform(form.grid, form.grid.shape, 1)
        self.rigid = [i for i in range(form.components) if i not in form.forced
                      and form.rigid_compliance[i] == 0.0]
        self.zones = [self._zones(i, core_of(form, i, options)) for i in range(form.components)]
        self._work = np.empty(form.nodes)

    def _zones(self, i, core):
        """[(root of weight, symbol), ...] of one component."""
        form = self.form
        stiffness = form.contact.operator(form.components,
                                          "stiffness").blocks[i, i] * form.grid.size
        smallest = form.grid.minimum(stiffness, where=stiffness > 0.0)
        form.grid.zero_wave(stiffness)[...] = form.mean_stiffness[i]
        weight, tangent = ((np.zeros(form.nodes), 1.0) if core is None
                           else (core.everywhere(form.window), core.tangent))
        zones = [(np.sqrt(weight), tangent), (np.sqrt(1.0 - weight), smallest)]
        return [(root, 1.0 / (stiffness + shift) / form.grid.size) for root, shift in zones]

    def apply(self, vector, out):
        """out = M^-1 vector: four transforms of the cell a component."""
        source, target = vector.reshape(self.form.shape), out.reshape(self.form.shape)
        plan = self.transform
        for i, zones in enumerate(self.zones):
            mean = self.grid.mean(source[i]) if i in self.rigid else 0.0
            target[i] = 0.0
            for root, symbol in zones:
                np.subtract(source[i], mean, out=self._work)
                np.multiply(self._work, root, out=plan.real[0].reshape(-1))
                plan.forward()
                plan.spectrum[0] *= symbol
                plan.backward()
                np.multiply(plan.real[0].reshape(-1), root, out=self._work)
                target[i] += self._work
            if i in self.rigid:
                target[i] += mean - self.grid.mean(target[i])
        return out


class EvenCoreZone(CoreZone):
    """Preconditioner of the displacement form for even states: the core zone of its half form.

    Parameters
    ----------
    form : EvenForm, linearised
    options, floor, single : as of `CoreZone`
    """

    def __init__(self, form, options=CoreOptions(), floor=0.0, single=False):
        super().__init__(form.half, options, floor, single, form.node_scale)


class ArcElimination:
    """Preconditioner of a form under arc length: that of the form, the load eliminated by its Schur
    complement.

    Parameters
    ----------
    form : ArcLength, linearised
    options : CoreOptions
    single : bool, whether it is set up in single precision, if the form has that
    """

    def __init__(self, form, options=CoreOptions(), single=False):
        self.form = form
        kind, asked = KINDS.get(type(form.form), CoreZone), (True,) if single else ()
        self.inner = kind(form.form, options, 1e-5, *asked)
        self.count = form.form.size
        self.column = self.inner.apply(form.load_column, np.empty(self.count), *asked)
        self.slope = form.grid.inner(form.tangent, self.column) - form.rate

    def apply(self, vector, out, *single):
        """out = M^-1 vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled and returned
        single : True for transforms in single precision, if the form has them
        """
        form, inner = self.form, out[:self.count]
        self.inner.apply(vector[:self.count], inner, *single)
        slope = self.slope if abs(self.slope) > 1e-300 else 1.0
        position = (form.grid.inner(form.tangent, inner) - form.position(vector)) / slope
        inner -= position * self.column
        out[self.count:] = form.grid.held([position])
        return out


KINDS = {ArcLength: ArcElimination, EvenForm: EvenCoreZone, ForceForm: ZonedStiffness}
"""Preconditioners of forms other than the displacement form."""


def zone(form, options, single=False):
    """The preconditioner of a form at its last linearisation.

    Parameters
    ----------
    form : of the equations
    options : CoreOptions
    single : bool, whether it is set up in single precision
    """
    kind = KINDS.get(type(form), CoreZone)
    return kind(form, options, single=True) if single else kind(form, options)


class ZonePC:
    """PETSc's PC context of these preconditioners, ``-pc_type python``: the form's own one, set up
    at each linearisation."""

    is_ours = True

    def __init__(self):
        self.options = CoreOptions()
        self.zone = self.precision = self._in_library = None

    def setFromOptions(self, pc):
        """Read -pc_core_* under the PC's prefix."""
        self.options = read(CoreOptions, pc.getOptionsPrefix() or "")

    def setUp(self, pc):
        """Make the zones from the tangent that the operator holds."""
        # The second operator is the one to make preconditioners from: with -snes_mf_operator the
        # first is a difference quotient.
        matrix = pc.getOperators()[1]
        form = form_of(matrix)
        if form is None:
            raise InputError(callbacks.NO_JACOBIAN if matrix.getType() == "mffd" else
                             f"the linear solves are of a matrix of type {matrix.getType()}, not of"
                             " the Jacobian that zones are made from: take -pc_type none, or "
                             "another -snes_type")
        self.precision = precision_of(matrix)
        self.zone = zone(form, self.options, self.precision.begin())
        self._in_library = None

    def in_library(self, form):
        """(Zone in the library, function that chooses its precision, None) of a form whose nodes
        processes share out; None of others.

        Parameters
        ----------
        form : of the equations, or None
        """
        able = type(form) in (EvenForm, DisplacementForm) and form.kernel and form.grid.shared
        if not (able and self.zone.form is getattr(form, "half", form)):
            return None
        if self._in_library is None:
            own = weakref.ref(self)
            self._in_library = (MadeZone(self.zone, form.kernel) if form.even else AskedZone(
                form.kernel, lambda *arrays: own().apply_to(*arrays)))
        made = self._in_library
        return made, lambda: made.choose(self.precision.now()), None

    def apply(self, pc, x, y):
        """y = M^-1 x.

        Parameters
        ----------
        pc : petsc4py PC
        x, y : petsc4py Vec; y is filled
        """
        self.apply_to(x.getArray(readonly=True), y.getArray())

    def apply_to(self, vector, out):
        """out = M^-1 vector.

        Parameters
        ----------
        vector, out : arrays of the form's size; out is filled
        """
        single = [True] if self.precision.now() else []
        self.zone.apply(vector, out, *single)

    def view(self, pc, viewer):
        """What -snes_view prints."""
        options = self.options
        viewer.printfASCII(
            f"    {type(self.zone).__name__ if self.zone else 'zones, not set up yet'}: "
            f"threshold {options.threshold:g}, width {options.width:g} / lambda_n, "
            f"pad {options.pad:g}, NumPy\n")
