"""Overdamped motion linearised at a state: the operator whose eigenvalues say whether it is stable.

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

import numpy as np

from ..contact import states
from ..contact.even_form import EvenForm
from ..contact.forms import DisplacementForm
from ..contact.problem import APPROACH, DISPLACEMENT, FORCE
from ..contact.states import State
from ..contact.symmetry import EVEN
from ..grid.mirrors import centred
from ..grid.parity import UNEVEN
from ..kernels.modes import CompiledMotion
from ..kernels.zones import CompiledZone
from ..solvers.core_zone import CoreOptions
from ..solvers.preconditioners import zone

LONG = 1000.0
"""Period, beta, of the cell whose response stands for that of a half-plane."""
ALIKE = 0.8
"""Part of its square that a mode and its mirror image have in common from which on it counts as
even or odd: states next to bifurcations are so to 1e-6 or less, and their modes with them."""


class Overdamped:
    """J of overdamped motion at a state, its preconditioner, and mirror images of vectors.

    A vector is [(v + w) / root, w of the components whose mean can move], as in
    `forms.DisplacementForm`. The form has a force row for each such component: what its mean is
    pulled by.

    Parameters
    ----------
    contact, window, controls : as of `forms.DisplacementForm`
    options : CoreOptions of the preconditioner
    parities : None, or those of the fields that it is for, as of `even_form.EvenForm`: at the nodes
        of half a line or a quarter of a plane
    """

    def __init__(self, contact, window, controls, options=CoreOptions(), parities=None):
        compliance = contact.rigid_compliance(len(controls))
        compliance[[control == APPROACH for control in controls]] = 0.0
        free = np.array([control == FORCE for control in controls])
        moving = free | ((compliance != 0.0) & (not contact.isolated))
        rows = [FORCE if moves else DISPLACEMENT for moves in moving]
        self.form = (DisplacementForm(contact, window, rows) if parities is None
                     else EvenForm(contact, window, rows, parities))
        self.plain = own = getattr(self.form, "half", self.form)
        inner = (_inner_compliance(contact, compliance) if contact.isolated
                 else np.zeros(len(controls)))
        # (odd components have no mean)
        own.rigid_compliance[...] = inner * [-1 not in signs for signs in
                                             parities or ((),) * len(controls)]
        self.means = np.array(own.forced, dtype=int)
        mass, held = contact.mean_mass(len(controls))[self.means], ~free[self.means]
        own.drag[self.means[held]] = own.grid.size / compliance[self.means[held]]
        self._row = own.row_scale[self.means] * own.grid.size * mass
        self._push = 1.0 + inner[self.means] * mass
        self.window, self.components, self.size = window, len(controls), own.size
        self.shared = own.grid if own.grid.shared else None
        self._options, kernel = options, None if self.shared else self.form.kernel
        self._zone = CompiledZone(kernel, options) if kernel else None
        self.kernel = CompiledMotion(self._zone, self._row, self._push) if kernel else None
        self.occupied = None if parities is None else self._occupied()

    def _occupied(self):
        """Mask of the entries of vectors on a half that have a meaning: an odd component vanishes
        in the middle, and where the cell closes on itself."""
        half = self.plain.window
        known = half.fold(half.unfold(np.ones(self.plain.shape)))
        return np.append(known.reshape(-1) != 0.0,
                         self.plain.grid.held(np.ones(len(self.means), dtype=bool)))

    @property
    def kernels(self):
        """What the library has for each part of vectors, or None."""
        return [self.kernel] if self.kernel else None

    @property
    def products(self):
        """Number of products so far."""
        return self.form.products

    def linearise(self, state, like=None):
        """Take the law's tangent at a state on the window, or that of another one of these at the
        same nodes, and make the preconditioner from it."""
        if like is None:
            means = np.zeros(len(self.means))
            self.form.linearise(self.form.scaled(self.plain.pack(self._once(state), means))
                                if self.plain is not self.form
                                else self.form.pack(state.displacement, means))
        else:
            np.copyto(self.plain.tangent, like.plain.tangent)
        if self.kernel:
            self._zone.set_up()
        else:
            self._zone = zone(self.form, self._options)

    def _once(self, state):
        """Displacements of a state at the nodes of the half."""
        half = self.plain.window
        return (state.once if state.half is not None and state.half.full == half.full
                else half.fold(state.displacement))

    def apply(self, vector):
        """J vector: two transforms of the padded window a component."""
        if self.kernel:
            return self.kernel.apply(vector)
        result = self.form.apply_jacobian(vector, np.empty(self.size))
        if len(self.means):
            rates = self.form.scalars(result) / self._row
            self._shift(result, self._push * rates)
            result[self.form.count:] = self.form.grid.held(rates)
        return result

    def precondition(self, vector):
        """About J^-1 vector, by the preconditioner of the form: two transforms of the core a
        component."""
        if self.kernel:
            return self.kernel.precondition(vector)
        if len(self.means):
            vector, rates = vector.copy(), self.form.scalars(vector)
            self._shift(vector, -self._push * rates)
            vector[self.form.count:] = self.form.grid.held(self._row * rates)
        return self._zone.apply(vector, np.empty(self.size))

    def _shift(self, vector, means):
        """Add uniform displacements, of the components whose mean can move, to a vector."""
        field = vector[:self.form.count].reshape(self.form.shape)
        for i, mean in zip(self.means, means):
            field[i] += mean / self.form.root

    def vector(self, mode):
        """The vector of a mode as a state: displacements on the window and means, ranges of the
        law; on the nodes of a half, of one of these parities."""
        means, field = mode.means[self.means], mode.displacement
        if self.plain is self.form:
            return self.form.pack(field, means)
        return self.form.scaled(self.plain.pack(self.plain.window.fold(field), means))

    def state(self, vector):
        """The mode as a state, of a real vector."""
        means = np.zeros(self.components)
        means[self.means] = self.form.scalars(vector)
        return State(self.window, self.form.displacement(vector), means)

    def uniform(self):
        """Vectors of the motions of the surface as a whole, of each component whose mean can."""
        return [self.vector(State(self.window, np.outer(means, np.ones(self.window.size)), means))
                for means in np.eye(self.components)[self.means]]

    def noise(self, seed):
        """A vector of random numbers, the same however its nodes are shared out."""
        form = self.form
        ones = form.grid.held(np.ones(len(self.means)))
        if self.occupied is None:
            return np.append(self.window.take(form.grid.noise(form.components, seed)), ones)
        field = form.grid.noise(form.components, seed)[..., :self.plain.window.shape[1]]
        return np.append(field, ones) * self.occupied

    def pieces(self, vector):
        """What a vector consists of in its order, each of which may go on in other processes."""
        return [*vector[:self.form.count].reshape(self.form.shape), vector[self.form.count:]]


def mirrored(window, field, axis, signs):
    """Mirror image about the apex of a field (components, nodes) on a centred window, its
    components times signs.

    Parameters
    ----------
    window : Window, centred
    field : array (components, nodes)
    axis : direction that is reversed
    signs : one a component
    """
    return window.mirrored(field, axis) * np.array(signs)[:, None]


def symmetries(contact, state):
    """[(direction, sign of each component), ...] of the mirror images about the apex that leave a
    state on a centred window as it is.

    A body in front of a mirror has its displacement along that direction reversed; where normal and
    tangential displacements are not coupled, tangential ones may be reversed besides.
    """
    window = state.window
    found, largest = [], window.grid.maximum
    gap = window.take(contact.initial_gap)[None]
    for axis in range(len(window.shape)):
        even = largest(np.abs(gap - mirrored(window, gap, axis, (1.0,)))) <= UNEVEN
        found += [(axis, signs) for signs in _reversed(contact, len(state.displacement), axis)
                  if even and largest(np.abs(state.displacement - mirrored(
                      window, state.displacement, axis, signs))) <= EVEN][:1]
    return found


def _reversed(contact, components, axis):
    """Signs of each component in mirror images that may leave states as they are, by a direction:
    tuples, the one of states that are sheared along it first."""
    signs = np.ones(components)
    signs[1 + axis:2 + axis] = -1.0
    alone = components == 1 or contact.couples()
    return [tuple(each) for each in ([signs] if alone else [np.append(1.0, -signs[1:]), signs])]


def parities_of(contact, mode):
    """Whether a mode is even (1), odd (-1) or neither (0) under the mirror image about the apex in
    each direction, a tuple, as nearly as states come to being even; empty where the gap is not.

    Parameters
    ----------
    contact : Contact
    mode : State, on one box of the cell
    """
    if not contact.unevenness <= UNEVEN:
        return ()
    window, grid = centred(mode.window), contact.grid
    field = states.onto(mode, window)
    found, square = [], grid.together(np.sum(field ** 2))
    for axis in range(len(window.shape)):
        image = mirrored(window, field, axis, _reversed(contact, len(field), axis)[0])
        alike = grid.together(np.sum(field * image))
        found.append(int(np.sign(alike)) * int(abs(alike) > ALIKE * square))
    return tuple(found)


def evened(state, axes):
    """A state without what its `symmetries` change in it, by which J would tie modes of different
    symmetry to each other."""
    field = state.displacement
    for axis, signs in axes:
        field = 0.5 * (field + mirrored(state.window, field, axis, signs))
    return State(state.window, field, state.means)


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
