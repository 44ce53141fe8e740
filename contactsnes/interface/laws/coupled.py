"""Laws of the normal traction a exp(-a) that fades with slip, and of a friction that fades with the
opening.

This is the base of the paper's laws, and no law itself.
"""

import numpy as np

from .law import Law, slip_of

SLIP = np.sqrt(0.5)
"""Tangential gap at the peak of the tangential traction, in ranges: |g_t| = delta_t / sqrt 2 (eq.
4b)."""

SOFTENING = np.exp(-2.0)
"""Steepest normal softening, -dt_n/da at a = 2 (dimensionless)."""

NORMAL_PEAK = np.exp(-1.0)
"""Largest adhesive traction, phi_n / delta_n (eq. 4a)."""

TANGENTIAL_PEAK = np.sqrt(2.0 / np.e)
"""Largest tangential traction tau_max at zero normal gap, phi_t / delta_t (eq. 4b)."""


class Coupled(Law):
    """Coupled law t_n = N(a) E(a, b), t_t = T(b) h(a) e with e = g_t / |g_t| (eqs. 3 and 5 of the
    paper).

    N(a) = a exp(-a). Subclasses say how the normal traction fades with slip (``fading``), which
    T(b) holds (``friction``, T(b) / b) and whether the two are decoupled where the surfaces overlap
    (``decoupled_in_overlap``), and ``friction_energy``. Below ``deepest`` both tractions continue
    linearly in a, with continuous slope.
    """

    decoupled_in_overlap = False
    normal_peak, barrier = NORMAL_PEAK, 0.0
    softening = SOFTENING
    moving_stiffness = 1.5 * SOFTENING
    newton_stiffness = 0.2

    def tractions(self, a, b):
        """N(a) E(b) and T(b) h(a) / b."""
        normal, held = self._normal(a)
        fading = self.fading(b * b)
        if self.decoupled_in_overlap:
            overlap = a <= 0.0
            fading = np.where(overlap, 1.0, fading)
            held = np.where(overlap, self._pressed(normal), held)
        return normal * fading, self.friction(b) * held

    def fading(self, squared_slip):
        """E(b)."""
        return np.exp(-squared_slip)

    def friction(self, slip):
        """T(b) / b."""
        return 2.0 * np.exp(-slip * slip)

    def _normal(self, a):
        """N(a) and h(a) = exp(-a)."""
        decay = np.exp(-a)
        return a * decay, decay

    def _pressed(self, normal):
        """h(a) in overlap of a law that decouples there, from N(a)."""
        return 1.0

    def energy(self, normal_gap):
        """Interface energy without slip, 1 - (1 + a) exp(-a) in phi_n, zero at a = 0: its
        derivative is N(a).

        Below ``deepest`` it is the integral of the linear continuation. With slip these laws have
        no potential.
        """
        if not np.minimum.reduce(normal_gap, axis=None, initial=self.deepest) < self.deepest:
            decay = np.negative(normal_gap)
            np.exp(decay, out=decay)
            decay *= 1.0 + normal_gap
            return np.subtract(1.0, decay, out=decay)
        depth = np.minimum(normal_gap - self.deepest, 0.0)
        bounded = normal_gap - depth
        traction, slope = self.normal(bounded)
        return 1.0 - (1.0 + bounded) * np.exp(-bounded) + depth * (traction + 0.5 * slope * depth)

    def friction_energy(self, slip):
        """Integral of T(b) from 0 to a tangential gap b, phi_t: the energy of slip where nothing
        else moves."""
        return -np.expm1(-slip * slip)

    def potential(self, gap, work_ratio=1.0):
        """Energy of the interface at every node, phi_n, zero where the surfaces are apart; None
        where there is no potential.

        There is one without slip, and in overlap where the law decouples there; a gap is apart from
        37 ranges on.

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        work_ratio : phi_t / phi_n
        """
        if len(gap) == 1:
            return self.energy(gap[0]) - 1.0
        slip = slip_of(gap)
        coupled = gap[0] < self.range
        if self.decoupled_in_overlap:
            coupled &= gap[0] > 0.0
        if (coupled & (slip > 0.0)).any():
            return None
        return self.energy(gap[0]) - 1.0 + work_ratio * np.where(gap[0] < self.range,
                                                                 self.friction_energy(slip), 0.0)
