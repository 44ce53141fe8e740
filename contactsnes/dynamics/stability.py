"""Stability of a point under its controls: unstable modes and the leading eigenvalue of overdamped
motion (`linearised` has its equations)."""

from dataclasses import replace

import numpy as np

from ..contact import states
from ..contact.edges import carried
from ..contact.states import State
from ..contact.symmetry import EVEN
from ..continuation.bifurcations import NEUTRAL
from ..continuation.points import NotConverged
from ..grid.mirrors import centred
from ..grid.parity import asymmetry
from ..options.database import read
from ..options.fields import InputError
from ..solvers.capabilities import asked, has_modes
from ..solvers.core_zone import CoreOptions
from .linearised import Overdamped, evened, parities_of, symmetries
from .modes import ACCURATE, leading_modes, oriented, soft, summed
from .parted import Parted
from .projection import joined

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
        self._operator = self._key = self._last = self._unstable = None
        self._silent = told

    def __call__(self, point):
        """The point with ``stable``, ``unstable_modes`` and, if asked for, ``leading_eigenvalue``
        and ``mode``."""
        if not self._silent:
            self.system.log(CERTIFIED)
            self._silent = True
        try:
            modes = self._counted(point, ACCURATE if self.kind == EIGENVALUE else None)
        except NotConverged as error:
            # A point without a certificate is not stable by it, and no reason to lose the path.
            self.system.log(f"{error}: it is not certified, and counts as not stable")
            self._last = None
            return point.changed(stable=0)
        unstable = modes.unstable
        if point.event == "fold":
            # The null mode is neither.
            unstable -= int(modes.real_parts()[np.argmin(np.abs(modes.real_parts()))] < -NEUTRAL)
        self._leave_symmetry(modes)
        found = point.changed(stable=int(modes.leading.real > NEUTRAL and point.event != "fold"),
                              unstable_modes=unstable, unstable_parities=self._parities(modes))
        return found if self.kind == SIGN else self._with_leading(found, modes, 0)

    def _counted(self, point, accurate):
        """`modes` of a point; looked for from noise as well where their number has changed, for
        modes of two symmetries may lose their stability at once, and one be missed by both."""
        modes = self.modes(point, accurate)
        if self._unstable not in (None, modes.unstable):
            self._last = None
            modes = max(self.modes(point, accurate), modes, key=lambda found: found.unstable)
        self._unstable = modes.unstable
        return modes

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
        mode = self._operator.state(oriented(modes.vectors[number], self._operator))
        return replace(point, leading_eigenvalue=modes.told(number), mode=mode)

    def _parities(self, modes):
        """Those of the unstable modes, as of `Point.unstable_parities`."""
        operator = self._operator
        if len(operator.window.parts) > 1 or self.system.symmetry.scatters(operator.components):
            return ()
        return tuple(parities_of(self.contact, operator.state(oriented(vector, operator)))
                     for value, vector in zip(modes.values, modes.vectors)
                     if value.real < -NEUTRAL for _ in range(1 + (value.imag > 0.0)))

    def _leave_symmetry(self, modes):
        """Take no state for even any more where an unstable mode is not."""
        symmetry = self.system.symmetry
        parities = symmetry.parities(self._operator.components)
        if parities and any(value.real < 0.0
                            and asymmetry(self._operator.window,
                                          self._operator.state(vector.real).displacement,
                                          parities) > EVEN
                            for value, vector in zip(modes.values, modes.vectors)):
            symmetry.leave("an unstable mode is not even about the apex")

    def modes(self, point, accurate=ACCURATE, number=0):
        """`Modes` of a point, accurate up to a ``number``.

        Parameters
        ----------
        point : Point
        accurate : residual; None where signs alone are asked for
        number : of the last mode that is to be accurate, 0 for the leading one
        """
        state, axes = self._known(point.state, len(point.controls))
        operator = self._linearised(state, point.controls, axes)
        products = operator.products
        fold = point.event == "fold"
        start = self._start(state, point.controls) + self._tangents(point, state.window)
        found = leading_modes(operator, start, accurate and max(accurate, FLAT) if fold
                              else accurate, number, FLAT if fold else NEUTRAL)
        self.system.totals["jacobian_products"] += operator.products - products
        self._last = (point.controls, state,
                      [operator.state(vector) for vector in summed(soft(found))])
        return joined(found)

    def best(self, point):
        """`modes` of a point, accurate where they can be had so, else their signs alone."""
        try:
            return self.modes(point)
        except NotConverged:
            return self.modes(point, None)

    def _known(self, state, components):
        """The state on the window that the law needs, centred where mirrors leave it as it is, and
        the `linearised.symmetries` of that."""
        scattered = self.system.symmetry.scatters(components)
        state = state if scattered else states.fitted(self.contact, state)
        if len(state.window.parts) > 1 or scattered:
            return state, []
        if state.half is not None:
            return state, [(axis, tuple(float(signs[axis]) for signs in state.half.parities)
                            if state.half.parities else (1.0,) * components)
                           for axis in range(len(state.window.shape))]
        window = centred(state.window)
        even = State(window, states.onto(state, window), state.means)
        axes = symmetries(self.contact, even)
        return (evened(even, axes), axes) if axes else (state, axes)

    def _linearised(self, state, controls, axes):
        """J at a state whose symmetries are ``axes``, at fields of each symmetry apart."""
        key = state.window, tuple(controls), tuple(axes)
        if self._key != key:
            made = (self.contact, state.window, controls)
            self._operator = (Parted(*made, axes, self.options) if axes
                              else Overdamped(*made, self.options))
            self._key = key
        self._operator.linearise(state)
        return self._operator

    def _tangents(self, point, window):
        """The branch's directions at a fold on a window, vectors: the null mode, or next to it."""
        return [self._operator.vector(State(window, states.onto(mode, window), mode.means))
                for mode in (tangent.state for tangent in point.tangents)]

    def _start(self, state, controls):
        """Modes of the last point as vectors on the window of a state, moved with the edges of
        contact; none under other controls, where what moves as a whole may be the softest."""
        if self._last is None or self._last[0] != controls:
            return []
        _, origin, modes = self._last
        return [self._operator.vector(mode)
                for mode in carried(self.contact, modes, origin, state)]
