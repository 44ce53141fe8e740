"""Laws of the normal traction a exp(-a) that fades with slip, and of a friction that fades with the
opening.

This is the base of the paper's laws, and no law itself.
"""

import numpy as np

from .law import Law

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
    T(b) holds (``friction``) and whether the two are decoupled where the surfaces overlap
    (``decoupled_in_overlap``), and ``friction_energy``. Below ``deepest`` both tractions continue
    linearly in a, with continuous slope.
    """

    decoupled_in_overlap = False
    normal_peak = NORMAL_PEAK
    softening = SOFTENING
    moving_stiffness = 1.5 * SOFTENING
    newton_stiffness = 0.2

    def fading(self, squared_slip):
        """E(b) and dE/d(b^2)."""
        fading = np.exp(-squared_slip)
        return fading, -fading

    def friction(self, slip):
        """T(b) / b and T'(b)."""
        peak = 2.0 * np.exp(-slip * slip)
        return peak, peak * (1.0 - 2.0 * slip * slip)

    def _normal(self, a):
        """N(a), N'(a), h(a) = exp(-a) and h'(a), which continue linearly below ``deepest``."""
        if not np.min(a, initial=0.0) < self.deepest:
            decay = np.exp(-a)
            return a * decay, (1.0 - a) * decay, decay, -decay
        depth = np.minimum(a - self.deepest, 0.0)
        bounded = a - depth
        decay = np.exp(-bounded)
        slope = (1.0 - bounded) * decay
        return bounded * decay + slope * depth, slope, decay * (1.0 - depth), -decay

    def _pressed(self, normal, normal_slope):
        """h(a) and h'(a) in overlap of a law that decouples there, from N(a) and N'(a)."""
        return 1.0, 0.0

    def normal(self, a):
        """N(a) and N'(a) without slip."""
        return self._normal(a)[:2]

    def evaluate(self, gap, traction, tangent=None):
        """Fill ``traction`` (components, nodes) and, if given, ``tangent`` (components, components,
        nodes) at once.

        ``traction`` may be ``gap`` itself.
        """
        normal, normal_slope, held, held_slope = self._normal(gap[0])
        if len(gap) == 1:
            traction[0] = normal
            if tangent is not None:
                tangent[0, 0] = normal_slope
            return traction
        slip_vector = gap[1:]
        squared_slip = np.einsum("in,in->n", slip_vector, slip_vector)
        slip = np.sqrt(squared_slip)
        fading, fading_slope = self.fading(squared_slip)
        secant, friction_slope = self.friction(slip)
        if self.decoupled_in_overlap:
            overlap = gap[0] <= 0.0
            fading = np.where(overlap, 1.0, fading)
            fading_slope = np.where(overlap, 0.0, fading_slope)
            pressed, pressed_slope = self._pressed(normal, normal_slope)
            held = np.where(overlap, pressed, held)
            held_slope = np.where(overlap, pressed_slope, held_slope)
        if tangent is not None:
            np.multiply(normal_slope, fading, out=tangent[0, 0])
            np.multiply(2.0 * normal * fading_slope, slip_vector, out=tangent[0, 1:])
            np.multiply(secant * held_slope, slip_vector, out=tangent[1:, 0])
            self._slip_tangent(slip_vector, slip, secant * held, friction_slope * held,
                               tangent[1:, 1:])
        np.multiply(normal, fading, out=traction[0])
        np.multiply(secant * held, slip_vector, out=traction[1:])
        return traction

    def _slip_tangent(self, slip_vector, slip, secant, slope, out):
        """T' e e + (T/b)(1 - e e), and its limit at zero slip, where both factors are the initial
        stiffness."""
        if len(slip_vector) == 1:
            out[0, 0] = slope
            return
        direction = slip_vector / np.where(slip > 0.0, slip, 1.0)
        np.multiply(slope - secant, direction[:, None] * direction[None, :], out=out)
        for i in range(len(slip_vector)):
            out[i, i] += secant

    def energy(self, normal_gap):
        """Interface energy without slip, 1 - (1 + a) exp(-a) in phi_n, zero at a = 0: its
        derivative is N(a).

        Below ``deepest`` it is the integral of the linear continuation. With slip these laws have
        no potential.
        """
        depth = np.minimum(normal_gap - self.deepest, 0.0)
        bounded = normal_gap - depth
        traction, slope, _, _ = self._normal(bounded)
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
        slip = np.linalg.norm(gap[1:], axis=0)
        coupled = gap[0] < self.range
        if self.decoupled_in_overlap:
            coupled &= gap[0] > 0.0
        if np.any(slip[coupled] > 0.0):
            return None
        return self.energy(gap[0]) - 1.0 + work_ratio * np.where(gap[0] < self.range,
                                                                 self.friction_energy(slip), 0.0)
