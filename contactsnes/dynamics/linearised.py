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

from ..contact.forms import DisplacementForm
from ..contact.states import State
from ..contact.symmetry import EVEN
from ..grid.parity import UNEVEN
from ..solvers.core_zone import CoreOptions, CoreZone

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
        self.size = form.count + len(form.grid.held(self.means))
        self.shared = form.grid if form.grid.shared else None
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
        form.count_product()
        field = vector[:form.count].reshape(form.shape)
        means = self._means(vector)
        work = form.stiffen(field, form.work)
        total = form.grid.sum(work) * form.root / form.grid.size
        form.convolution.apply(work, work)
        rates = (self._stiffness * means + total[self.means]) / self._mass
        shift = self._inner * total / form.root
        shift[self.means] += (rates - means) / form.root
        out = result[:form.count].reshape(form.shape)
        np.add(field, work, out=out)
        out += shift[:, None]
        result[form.count:] = form.grid.held(rates)
        return result

    def precondition(self, vector):
        """About J^-1 vector, by the preconditioner of the form: two transforms of the core a
        component."""
        form = self.form
        field = vector[:form.count].reshape(form.shape)
        rates = self._means(vector)
        right, out = np.zeros(form.size), np.empty(form.size)
        source = right[:form.count].reshape(form.shape)
        source[...] = field
        balance = self._mass * rates
        # What pulls a mean that is held by a spring moves it at once by its compliance.
        held = np.divide(balance, self._stiffness, out=np.zeros_like(balance), where=~self._free)
        source[self.means] += ((held - rates) / form.root)[:, None]
        right[form.count:] = form.grid.held(form.row_scale[form.forced] * form.grid.size
                                            * balance[self._free])
        self.zone.apply(right, out)
        result = np.empty(self.size)
        result[:form.count] = out[:form.count]
        moved = result[:form.count].reshape(form.shape)
        total = form.grid.sum(form.stiffen(moved,
                                           form.work))[self.means] * form.root / form.grid.size
        means = np.divide(balance - total, self._stiffness, out=np.zeros_like(balance),
                          where=~self._free)
        means[self._free] = (form.scalars(out) + self._inner[self.means][self._free]
                             * balance[self._free])
        result[form.count:] = form.grid.held(means)
        return result

    def vector(self, mode):
        """The vector of a mode as a state: displacements on the window and means, ranges of the
        law."""
        return np.append(mode.displacement / self.form.root,
                         self.form.grid.held(mode.means[self.means]))

    def state(self, vector):
        """The mode as a state, of a real vector."""
        means = np.zeros(self.form.components)
        means[self.means] = self._means(vector)
        return State(self.form.window, vector[:self.form.count].reshape(self.form.shape)
                     * self.form.root, means)

    def _means(self, vector):
        """The means that can move of a vector."""
        return self.form.grid.scalars(vector[self.form.count:], len(self.means))

    def noise(self, seed):
        """A vector of random numbers, the same however its nodes are shared out."""
        form, window = self.form, self.form.window
        field = window.take(form.grid.noise(form.components, seed))
        return np.append(field, form.grid.held(np.ones(len(self.means))))

    def first_largest(self, vector):
        """The largest size of a vector's displacements, with the sign of the first about as
        large."""
        return self.form.grid.first_largest(vector[:self.form.count].reshape(self.form.shape))

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
    components times signs.

    Parameters
    ----------
    window : Window, centred
    field : array (components, nodes)
    axis : direction that is reversed
    signs : one a component
    """
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
