"""Stability of a point under its controls: unstable modes and the leading eigenvalue of overdamped
motion.

The body is one whose material creeps with the relaxation time 1 (Kelvin and Voigt): M u' = -(K u +
t) with M = K for every wave. So u = v + w, with the mean w of each component whose mean can move,
obeys

    v' = -(v + C t),    m_0 w' = -(k_0 (w - far displacement) + mean t),

and small disturbances decay with the eigenvalues s of J (v, w) = (v + C D (v + w), (k_0 w + mean D
(v + w)) / m_0), D the law's tangent. J is the identity plus a compact operator on the nodes where
the law acts: its eigenvalues do not depend on the grid, and are 1 where the law does not act. m_0
is the stiffness of the cell's softest wave. A mean that cannot move (rigid, under displacement
control) has no w. Around an isolated contact C is the body's whole response, and m_0 belongs to the
body as a whole: pi E* on a line, as in a cell of any period, and pi E* beta in the plane. A
half-plane, whose response to a force has no end, is that of a cell with the period 1000 beta.
"""

from dataclasses import replace

import numpy as np

from ..contact import states
from ..contact.edges import carried
from ..contact.even_form import EVEN
from ..contact.forms import DisplacementForm
from ..contact.states import State
from ..continuation.bifurcations import NEUTRAL
from ..continuation.points import NotConverged
from ..grid.even import UNEVEN, asymmetry, centred
from ..options.database import read
from ..options.fields import InputError
from ..solvers.capabilities import asked, has_modes
from ..solvers.preconditioners import CoreOptions, CoreZone
from .modes import ACCURATE, joined, leading_modes, oriented, summed

CERTIFIED = ("stable: all eigenvalues of the discrete problem on this "
             "grid, linearised at the point under its controls, have "
             "positive real parts in overdamped motion (the body creeps, "
             "M = K, relaxation time 1); finite disturbances are not "
             "looked at")
OFF = "off"
SIGN = "sign"
EIGENVALUE = "eigenvalue"

CRITICAL = 1e-8
"""Residual of a mode where its eigenvalue is to be made to vanish."""
FLAT = 1e-3
"""Residual to which modes of a fold are found: one of them vanishes, or jumps through zero at a
corner of the law."""
LONG = 1000.0
"""Period, beta, of the cell whose response stands for that of a half-plane."""


class Overdamped:
    """J of overdamped motion at a state, its preconditioner, and mirror images of vectors.

    A vector is [(v + w) / root, w of the components whose mean can move], as in
    `forms.DisplacementForm`.

    Parameters
    ----------
    contact, window, controls : as of `forms.DisplacementForm`
    options : CoreOptions of the preconditioner
    """

    def __init__(self, contact, window, controls, options=CoreOptions()):
        self.form, self.options = DisplacementForm(contact, window, controls), options
        form = self.form
        compliance = form.rigid_compliance.copy()
        free = np.isin(np.arange(form.components), form.forced)
        self._inner = (_inner_compliance(contact, compliance) if contact.isolated
                       else np.zeros(form.components))
        self.means = np.flatnonzero(free | ((compliance != 0.0) & (not contact.isolated)))
        self._stiffness = np.array([0.0 if free[i] else 1.0 / compliance[i] for i in self.means])
        self._mass = contact.mean_mass(form.components)[self.means]
        self._free = free[self.means]
        self.size = form.count + len(self.means)
        self.zone = None

    def linearise(self, state, load):
        """Take the law's tangent at a state on the window, and make the preconditioner from it."""
        form = self.form
        form.set_load(load)
        form.linearise(form.pack(state.displacement, state.means[form.forced]))
        self.zone = CoreZone(form, self.options)

    def apply(self, vector):
        """J vector: two transforms of the padded window a component."""
        form, result = self.form, np.empty(self.size)
        form.products += 1
        field, means = vector[:form.count].reshape(form.shape), vector[form.count:]
        work = form.stiffen(field, form.work)
        total = form.grid.sum(work) * form.root / form.grid.size
        form.convolution.apply(work, work)
        rates = (self._stiffness * means + total[self.means]) / self._mass
        shift = self._inner * total / form.root
        shift[self.means] += (rates - means) / form.root
        out = result[:form.count].reshape(form.shape)
        np.add(field, work, out=out)
        out += shift[:, None]
        result[form.count:] = rates
        return result

    def precondition(self, vector):
        """About J^-1 vector, by the preconditioner of the form: two transforms of the core a
        component."""
        form = self.form
        field, rates = vector[:form.count].reshape(form.shape), vector[form.count:]
        right, out = np.zeros(form.size), np.empty(form.size)
        source = right[:form.count].reshape(form.shape)
        source[...] = field
        balance = self._mass * rates
        # What pulls a mean that is held by a spring moves it at once by its compliance.
        held = np.divide(balance, self._stiffness, out=np.zeros_like(balance), where=~self._free)
        source[self.means] += ((held - rates) / form.root)[:, None]
        right[form.count:] = form.row_scale[form.forced] * form.grid.size * balance[self._free]
        self.zone.apply(right, out)
        result = np.empty(self.size)
        result[:form.count] = out[:form.count]
        moved = result[:form.count].reshape(form.shape)
        total = form.grid.sum(form.stiffen(moved,
                                           form.work))[self.means] * form.root / form.grid.size
        means = np.divide(balance - total, self._stiffness, out=np.zeros_like(balance),
                          where=~self._free)
        means[self._free] = (out[form.count:] + self._inner[self.means][self._free]
                             * balance[self._free])
        result[form.count:] = means
        return result

    def vector(self, mode):
        """The vector of a mode as a state: displacements on the window and means, ranges of the
        law."""
        return np.append(mode.displacement / self.form.root, mode.means[self.means])

    def state(self, vector):
        """The mode as a state, of a real vector."""
        means = np.zeros(self.form.components)
        means[self.means] = vector[self.form.count:]
        return State(self.form.window, vector[:self.form.count].reshape(self.form.shape)
                     * self.form.root, means)

    def mirror(self, vector, symmetry):
        """The mirror image of a vector about the apex, on a centred window, for (direction, sign of
        each component)."""
        (axis, signs) = symmetry
        form = self.form
        image = vector.copy()
        image[:form.count] = mirrored(form.window, vector[:form.count].reshape(form.shape), axis,
                                      signs).reshape(-1)
        image[form.count:] *= np.array(signs)[self.means]
        return image


def mirrored(window, field, axis, signs):
    """Mirror image about the apex of a field (components, nodes) on a centred window, its
    components times signs."""
    box = np.flip(window.box(field), axis + 1)
    if window.shape[axis] == window.grid.shape[axis]:
        box = np.roll(box, 1, axis + 1)
    return box.reshape(field.shape) * np.array(signs)[:, None]


def symmetries(contact, state):
    """[(direction, sign of each component), ...] of the mirror images about the apex that leave a
    state on a centred window as it is.

    A body in front of a mirror has its displacement along that direction reversed; where normal and
    tangential displacements are not coupled, tangential ones may be reversed besides.
    """
    components = len(state.displacement)
    window = state.window
    found = []
    gap = window.take(contact.initial_gap)[None]
    for axis in range(len(window.shape)):
        signs = np.ones(components)
        signs[1 + axis:2 + axis] = -1.0
        tried = [signs] if components == 1 or contact.couples() else [np.append(1.0, -signs[1:]),
                                                                      signs]
        even = np.abs(gap - mirrored(window, gap, axis, (1.0,))).max() <= UNEVEN
        found += [(axis, tuple(signs)) for signs in tried if even
                  and np.abs(state.displacement - mirrored(window, state.displacement, axis,
                                                           signs)).max() <= EVEN][:1]
    return found


def _inner_compliance(contact, rigid):
    """What the mean traction moves the whole surface by around an isolated contact, in ranges of
    the law."""
    if not np.isnan(contact.datum):
        return rigid
    # The half-plane's kernel -2/pi ln |x| is taken against its mean over the circle of lags: here
    # against that of a long cell.
    circle = contact.grid.periods[0]
    shift = 2.0 / np.pi * (np.log(LONG / (2.0 * np.pi)) - np.log(circle / 2.0) + 1.0)
    return shift * circle * contact.ranges[:len(rigid)] ** 2


def refuse_without_tangent(kind, settings):
    """InputError where stability is asked for and the method has no tangent."""
    if kind != OFF and not has_modes(settings):
        raise InputError(f"-continuation_stability is '{kind}', but relaxation "
                         f"(-contact_form {settings.form}, -snes_type {asked().name}) has no "
                         "tangent whose eigenvalues could be found: take "
                         "-contact_form displacement with Newton's method "
                         "(-snes_type newtonls), or -continuation_stability off")


class Stability:
    """Marks points as stable or not: finds their modes, from those of the last point.

    Parameters
    ----------
    system : Corrector that makes the points, whose contact, log and totals are used
    kind : 'sign' or 'eigenvalue'
    told : whether what a certificate means has been said, or need not be
    """

    def __init__(self, system, kind, told=False):
        self.system = system
        self.contact = system.contact
        self.kind = kind
        self.options = read(CoreOptions, system.prefix)
        self._operator = self._last = None
        self._silent = told

    def __call__(self, point):
        """The point with ``stable``, ``unstable_modes`` and, if asked for, ``leading_eigenvalue``
        and ``mode``."""
        if not self._silent:
            self.system.log(CERTIFIED)
            self._silent = True
        try:
            modes = self.modes(point, ACCURATE if self.kind == EIGENVALUE else None)
        except NotConverged as error:
            # A point without a certificate is not stable by it, and no reason to lose the path.
            self.system.log(f"{error}: it is not certified, and counts as not stable")
            self._last = None
            return replace(point, stable=0)
        unstable = modes.unstable
        if point.event == "fold":
            # The null mode is neither.
            unstable -= int(modes.real_parts()[np.argmin(np.abs(modes.real_parts()))] < -NEUTRAL)
        self._leave_symmetry(modes)
        found = replace(point, stable=int(modes.leading.real > NEUTRAL and point.event != "fold"),
                        unstable_modes=unstable)
        return found if self.kind == SIGN else self._with_leading(found, modes, 0)

    def critical(self, point, number):
        """(real part of eigenvalue ``number``, the point with it as its leading one), to high
        accuracy."""
        modes = self.modes(point, CRITICAL, number)
        if number >= len(modes.real_parts()):
            raise NotConverged(
                f"of {number + 1} modes that were expected {len(modes.real_parts())} were found")
        value = modes.real_parts()[number]
        return float(value), self._with_leading(point, modes,
                                                int(np.argmin(np.abs(modes.values.real - value))))

    def aside(self, point):
        """A state that differs from a point's by its mode, one range of the law at most."""
        state, mode = point.state, point.mode
        largest = self.contact.grid.maximum(np.abs(mode.displacement))
        moved = states.onto(state, mode.window) + mode.displacement / largest
        return State(mode.window, moved, state.means + mode.means / largest)

    def _with_leading(self, point, modes, number):
        """The point with an eigenvalue and its mode."""
        mode = self._operator.state(oriented(modes.vectors[number]))
        return replace(point, leading_eigenvalue=complex(modes.values[number]), mode=mode)

    def _leave_symmetry(self, modes):
        """Take no state for even any more where an unstable mode is not."""
        symmetry = self.system.symmetry
        uneven = [vector for value, vector in zip(modes.values, modes.vectors) if value.real < 0.0
                  and asymmetry(self._operator.form.window,
                                self._operator.state(vector.real).displacement) > EVEN]
        if uneven and symmetry.holds(self._operator.form.components):
            symmetry.leave("an unstable mode is not even about the apex")

    def modes(self, point, accurate=ACCURATE, number=0):
        """`Modes` of a point, accurate up to a ``number``."""
        state = states.fitted(self.contact, point.state)
        axes = []
        if len(state.window.parts) == 1:
            window = centred(state.window)
            even = State(window, states.onto(state, window), state.means)
            axes = symmetries(self.contact, even)
            state = even if axes else state
        operator = self._operator
        if (operator is None or operator.form.window != state.window
            or operator.form.controls != tuple(point.controls)):
            operator = self._operator = Overdamped(self.contact, state.window, point.controls,
                                                   self.options)
        operator.linearise(state, point.load)
        products = operator.form.products
        fold = point.event == "fold"
        start = self._start(state) + self._tangents(point, state.window)
        found = leading_modes(operator, axes, start, accurate and max(accurate, FLAT) if fold
                              else accurate, number, FLAT if fold else NEUTRAL)
        self.system.totals["jacobian_products"] += operator.form.products - products
        self._last = state, [operator.state(vector) for vector in summed(found)]
        return joined(found)

    def _tangents(self, point, window):
        """The branch's directions at a fold on a window, vectors: the null mode, or next to it."""
        return [self._operator.vector(State(window, states.onto(mode, window), mode.means))
                for mode in (tangent.state for tangent in point.tangents)]

    def _start(self, state):
        """Modes of the last point as vectors on the window of a state, moved with the edges of
        contact."""
        if self._last is None or len(self._last[0].displacement) != len(state.displacement):
            return []
        origin, modes = self._last
        return [self._operator.vector(carried(self.contact, mode, origin, state)) for mode in modes]
