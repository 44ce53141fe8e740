"""Traction-separation laws: pointwise tractions and their consistent tangents.

Gaps and tractions are in ranges of the law: a = g_n / delta_n, b = |g_t| / delta_t, tractions in
phi_n / delta_n and phi_t / delta_t. Arrays have the shape (components, nodes): the normal component first,
then one or two tangential ones. Attraction is positive: the traction on the body is the negative of the law's.
"""

import numpy as np
from scipy.special import erf

CUTOFF = 37.0
"""Normal gap, in ranges, beyond which exp(-a) is below rounding and the law counts as zero (dimensionless)."""

DEEPEST = -30.0
"""Normal gap, in ranges, below which tractions continue linearly (dimensionless)."""

SLIP = np.sqrt(0.5)
"""Tangential gap at the peak of the tangential traction, in ranges: |g_t| = delta_t / sqrt 2 (eq. 4b)."""

SOFTENING = np.exp(-2.0)
"""Steepest normal softening, -dt_n/da at a = 2 (dimensionless)."""

MOVING_STIFFNESS = 1.5 * SOFTENING
"""kappa of the regularised gap in which states are moved along a branch or from grid to grid, phi_n/delta_n^2."""

NORMAL_PEAK = np.exp(-1.0)
"""Largest adhesive traction, phi_n / delta_n (eq. 4a)."""

TANGENTIAL_PEAK = np.sqrt(2.0 / np.e)
"""Largest tangential traction tau_max at zero normal gap, phi_t / delta_t (eq. 4b)."""


class Law:
    """Coupled law t_n = N(a) E(a, b), t_t = T(b) h(a) e with e = g_t / |g_t| (eqs. 3 and 5 of the paper).

    N(a) = a exp(-a). Subclasses say how the normal traction fades with slip (``_fading``), which T(b) holds
    (``_friction``) and whether the two are decoupled where the surfaces overlap (``decoupled_in_overlap``).
    Below a = -30 both tractions continue linearly in a, with continuous slope.
    """

    decoupled_in_overlap = False

    def _fading(self, squared_slip):
        """E(b) and dE/d(b^2)."""
        fading = np.exp(-squared_slip)
        return fading, -fading

    def _friction(self, slip):
        """T(b) / b and T'(b)."""
        peak = 2.0 * np.exp(-slip * slip)
        return peak, peak * (1.0 - 2.0 * slip * slip)

    def _normal(self, a):
        """N(a), N'(a), exp(-a), and the depth below ``DEEPEST``, where the first continues linearly and exp(-a) ends."""
        if not np.min(a, initial=0.0) < DEEPEST:
            decay = np.exp(-a)
            return a * decay, (1.0 - a) * decay, decay, 0.0
        depth = np.minimum(a - DEEPEST, 0.0)
        bounded = a - depth
        decay = np.exp(-bounded)
        slope = (1.0 - bounded) * decay
        return bounded * decay + slope * depth, slope, decay, depth

    def traction(self, gap, out=None):
        """Tractions t(g) at every node (eq. 3 or 5).

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        out : array of the same shape, optional; filled and returned

        Returns
        -------
        array (components, nodes), phi_n / delta_n and phi_t / delta_t; attraction positive.
        """
        return self.evaluate(gap, np.empty_like(gap) if out is None else out)

    def tangent(self, gap, out=None):
        """Consistent tangent dt_i / dg_j at every node, array (components, components, nodes), dimensionless."""
        count, nodes = gap.shape
        out = np.empty((count, count, nodes)) if out is None else out
        self.evaluate(gap, np.empty_like(gap), out)
        return out

    def evaluate(self, gap, traction, tangent=None):
        """Fill ``traction`` (components, nodes) and, if given, ``tangent`` (components, components, nodes) at once.

        ``traction`` may be ``gap`` itself.
        """
        normal, normal_slope, decay, depth = self._normal(gap[0])
        if len(gap) == 1:
            traction[0] = normal
            if tangent is not None:
                tangent[0, 0] = normal_slope
            return traction
        slip_vector = gap[1:]
        squared_slip = np.einsum("in,in->n", slip_vector, slip_vector)
        slip = np.sqrt(squared_slip)
        fading, fading_slope = self._fading(squared_slip)
        secant, friction_slope = self._friction(slip)
        held, held_slope = decay * (1.0 - depth), -decay
        if self.decoupled_in_overlap:
            overlap = gap[0] <= 0.0
            fading, fading_slope = np.where(overlap, 1.0, fading), np.where(overlap, 0.0, fading_slope)
            held, held_slope = np.where(overlap, 1.0, held), np.where(overlap, 0.0, held_slope)
        if tangent is not None:
            np.multiply(normal_slope, fading, out=tangent[0, 0])
            np.multiply(2.0 * normal * fading_slope, slip_vector, out=tangent[0, 1:])
            np.multiply(secant * held_slope, slip_vector, out=tangent[1:, 0])
            self._slip_tangent(slip_vector, slip, secant * held, friction_slope * held, tangent[1:, 1:])
        np.multiply(normal, fading, out=traction[0])
        np.multiply(secant * held, slip_vector, out=traction[1:])
        return traction

    def _slip_tangent(self, slip_vector, slip, secant, slope, out):
        """T' e e + (T/b)(1 - e e), and its limit at zero slip, where both factors are the initial stiffness."""
        if len(slip_vector) == 1:
            out[0, 0] = slope
            return
        direction = slip_vector / np.where(slip > 0.0, slip, 1.0)
        np.multiply(slope - secant, direction[:, None] * direction[None, :], out=out)
        for i in range(len(slip_vector)):
            out[i, i] += secant

    def regularised(self, gap, stiffness):
        """w = a + N(a) / stiffness of a normal gap (nodes), ranges of the law: in overlap it is a traction, no logarithm of one.

        Single-valued for a stiffness above ``SOFTENING``.
        """
        return gap + self._normal(gap)[0] / stiffness

    def gap_of_regularised(self, target, stiffness):
        """The normal gap a (nodes) with a + N(a) / stiffness = target, pointwise by a bracketed Newton iteration."""
        new = np.where(target < 0.0, -np.log1p(-stiffness * np.minimum(target, 0.0)), target)
        # a and w have one sign, and N(a) is at most 1/e, and negative in overlap: a lies between these.
        low, high = np.where(target > 0.0, target - NORMAL_PEAK / stiffness, target), np.maximum(target, 0.0)
        nodes, now = np.arange(len(target)), new.copy()
        for _ in range(60):
            normal, slope, _, _ = self._normal(now)
            excess = now + normal / stiffness - target
            low, high = np.where(excess < 0.0, now, low), np.where(excess > 0.0, now, high)
            trial = now - excess / (1.0 + slope / stiffness)
            trial = np.where((trial >= low) & (trial <= high), trial, 0.5 * (low + high))
            # Most nodes are done long before the last.
            going = ~(np.abs(trial - now) <= 1e-10 * (1.0 + np.abs(trial)))
            new[nodes] = trial
            if not going.any():
                break
            nodes, now, target, low, high = (values[going] for values in (nodes, trial, target, low, high))
        return new

    def regularised_step(self, gap, step, stiffness):
        """The step of the normal gap that is ``step`` to first order, but taken in w = a + N(a) / stiffness.

        w has no exponential in overlap: a step that would overshoot in a is moderate in w.

        Parameters
        ----------
        gap, step : arrays (nodes), ranges of the law
        stiffness : dimensionless, above ``SOFTENING``

        Returns
        -------
        array (nodes), ranges of the law
        """
        normal, slope, _, _ = self._normal(gap)
        return self.gap_of_regularised(gap + normal / stiffness + (1.0 + slope / stiffness) * step, stiffness) - gap

    def energy(self, normal_gap):
        """Interface energy without slip, 1 - (1 + a) exp(-a) in phi_n, zero at a = 0: its derivative is N(a).

        Below ``DEEPEST`` it is the integral of the linear continuation. With slip these laws have no potential.
        """
        depth = np.minimum(normal_gap - DEEPEST, 0.0)
        bounded = normal_gap - depth
        traction, slope, _, _ = self._normal(bounded)
        return 1.0 - (1.0 + bounded) * np.exp(-bounded) + depth * (traction + 0.5 * slope * depth)


    def friction_energy(self, slip):
        """Integral of T(b) from 0 to a tangential gap b, phi_t: the energy of slip where nothing else moves."""
        return -np.expm1(-slip * slip)

    def potential(self, gap, work_ratio=1.0):
        """Energy of the interface at every node, phi_n, zero where the surfaces are apart; None where there is no potential.

        There is one without slip, and in overlap where the law decouples there; a gap is apart from 37 ranges on.

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        work_ratio : phi_t / phi_n
        """
        slip = np.linalg.norm(gap[1:], axis=0)
        coupled = gap[0] < CUTOFF
        if self.decoupled_in_overlap:
            coupled &= gap[0] > 0.0
        if np.any(slip[coupled] > 0.0):
            return None
        return self.energy(gap[0]) - 1.0 + work_ratio * np.where(gap[0] < CUTOFF, self.friction_energy(slip), 0.0)


class McGarry(Law):
    """Law of McGarry et al. (2014), eq. (3) of the paper with the factor 2 that makes eq. (4b) right.

    t_n = a exp(-a) exp(-b^2),  t_t = 2 b exp(-a) exp(-b^2) e.
    """


class Modified(Law):
    """The paper's law, eq. (5) as corrected: friction and repulsion survive large slip.

    t_n = a exp(-a) E_r(b) and t_t = T(b) exp(-a) e where a > 0; t_n = a exp(-a) and t_t = T(b) e where a <= 0.
    T(b) = 2 b exp(-b^2) up to b_0 = 1/sqrt 2, then tau_max [rho + (1 - rho) exp(-(b - b_0)^2)], and
    E_r(b) = r + (1 - r) exp(-b^2).

    Parameters
    ----------
    residual_friction : rho = tau_inf / tau_max, 0 to 1: the traction at large slip over its peak.
    residual_adhesion : r, 0 <= r < 1: the share of the work of adhesion that is left at large slip.
    """

    decoupled_in_overlap = True

    def __init__(self, residual_friction=1.0, residual_adhesion=0.0):
        self.residual_friction = residual_friction
        self.residual_adhesion = residual_adhesion

    def _fading(self, squared_slip):
        lost = (1.0 - self.residual_adhesion) * np.exp(-squared_slip)
        return self.residual_adhesion + lost, -lost

    def _friction(self, slip):
        secant, slope = super()._friction(slip)
        beyond = slip > SLIP
        if beyond.any():
            past = slip[beyond] - SLIP
            drop = TANGENTIAL_PEAK * (1.0 - self.residual_friction) * np.exp(-past * past)
            secant[beyond] = (TANGENTIAL_PEAK * self.residual_friction + drop) / slip[beyond]
            slope[beyond] = -2.0 * past * drop
        return secant, slope

    def friction_energy(self, slip):
        """Integral of T(b), by parts of the law: 1 - exp(-b^2), then tau_max [rho c + (1 - rho) sqrt(pi)/2 erf(c)], c = b - b_0."""
        past, residual = np.maximum(slip - SLIP, 0.0), self.residual_friction
        beyond = residual * past + (1.0 - residual) * 0.5 * np.sqrt(np.pi) * erf(past)
        return super().friction_energy(np.minimum(slip, SLIP)) + TANGENTIAL_PEAK * beyond


LAWS = {"modified": Modified, "mcgarry": McGarry}
