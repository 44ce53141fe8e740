"""The paper's law: friction and repulsion survive large slip."""

import math

import numpy as np
import scipy

from ...options.fields import option
from .coupled import SLIP, TANGENTIAL_PEAK, Coupled


class Modified(Coupled):
    """The paper's law, eq. (5) as corrected: friction and repulsion survive large slip.

    t_n = a exp(-a) E_r(b) and t_t = T(b) exp(-a) e where a > 0; t_n = a exp(-a) and t_t = T(b) e
    where a <= 0. T(b) = 2 b exp(-b^2) up to b_0 = 1/sqrt 2, then tau_max [rho + (1 - rho) exp(-(b -
    b_0)^2)], and E_r(b) = r + (1 - r) exp(-b^2).

    Parameters
    ----------
    residual_friction : rho = tau_inf / tau_max, 0 to 1: the traction at large slip over its peak.
    residual_adhesion : r, 0 <= r < 1: the share of the work of adhesion that is left at large slip.
    """

    decoupled_in_overlap = True

    name, meaning = "modified", "eq. 5 of the paper"
    residual_friction: float = option(1.0, "tangential traction at large slip over "
                                      "its peak (laws modified, dugdale, "
                                      "pressure_friction)", minimum=0, maximum=1)
    residual_adhesion: float = option(0.0, "work of adhesion at large slip over "
                                      "that without slip (laws modified, dugdale, "
                                      "pressure_friction)", minimum=0, below=1)
    slip_options = ("residual_friction", "residual_adhesion")
    slip_peak, tangential_peak = SLIP, TANGENTIAL_PEAK
    gap_corners, slip_corners = (0.0,), (SLIP,)

    @property
    def slip_softening(self):
        """Steepest fall of the friction with the slip, (2/e) (1 - residual_friction)."""
        return 2 / math.e * (1 - self.residual_friction)

    def fading(self, squared_slip):
        """E_r(b)."""
        return self.residual_adhesion + (1.0 - self.residual_adhesion) * np.exp(-squared_slip)

    def friction(self, slip):
        """T(b) / b, in two parts."""
        beyond = np.maximum(slip, SLIP)
        drop = (1.0 - self.residual_friction) * np.exp(-(beyond - SLIP) ** 2)
        return np.where(slip > SLIP, TANGENTIAL_PEAK * (self.residual_friction + drop) / beyond,
                        super().friction(slip))

    def friction_energy(self, slip):
        """Integral of T(b), by parts of the law: 1 - exp(-b^2), then tau_max [rho c + (1 - rho)
        sqrt(pi)/2 erf(c)], c = b - b_0."""
        past, residual = np.maximum(slip - SLIP, 0.0), self.residual_friction
        beyond = residual * past + (1.0 - residual) * 0.5 * np.sqrt(np.pi) * scipy.special.erf(past)
        return super().friction_energy(np.minimum(slip, SLIP)) + TANGENTIAL_PEAK * beyond
