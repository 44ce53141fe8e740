"""The law of Xu and Needleman (1993), which has a potential."""

import math

import numpy as np

from ...options.fields import option
from .coupled import NORMAL_PEAK, SLIP, SOFTENING, TANGENTIAL_PEAK
from .law import Law


class XuNeedleman(Law):
    """t_n = [a E + (1-q)/(r-1) (1-E) (r-a)] exp(-a), t_t = 2 b [1 + (r-q)/(q (r-1)) a] exp(-a) E e;
    E = exp(-b^2).

    They are derivatives of one potential where phi_t = q phi_n: with ``-scene_work_ratio`` q. As
    published it is one formula for overlap, too, where friction turns round below a = -q
    (1-r)/(q-r). Both tractions continue linearly in a below ``deepest``.
    """

    name, meaning = "xu_needleman", "of a potential: Xu and Needleman 1993"
    xu_needleman_q: float = option(1.0, "q of the law xu_needleman: tangential over "
                                   "normal work of separation, as -scene_work_ratio "
                                   "if it is to have a potential", above=0)
    xu_needleman_r: float = option(0.0, "r of the law xu_needleman: gap, in ranges, "
                                   "that is left without a traction after shear",
                                   minimum=0, below=1)
    slip_options = ("xu_needleman_q", "xu_needleman_r")
    normal_peak, barrier = NORMAL_PEAK, 0.0
    softening = SOFTENING
    moving_stiffness = 1.5 * SOFTENING
    newton_stiffness = 0.2
    slip_peak = SLIP
    tangential_peak = TANGENTIAL_PEAK
    slip_softening = 4 * math.exp(-1.5)

    @property
    def _shares(self):
        """(1-q)/(r-1) and (r-q)/(r-1)."""
        q, r = self.xu_needleman_q, self.xu_needleman_r
        return (1.0 - q) / (r - 1.0), (r - q) / (r - 1.0)

    def tractions(self, a, b):
        """Normal traction, and friction over the slip."""
        remnant, linear = self._shares
        decay, fading = np.exp(-a), np.exp(-b * b)
        left = remnant * (self.xu_needleman_r - a) * decay
        normal = a * decay * fading + left * (1.0 - fading)
        return normal, 2.0 * (1.0 + linear / self.xu_needleman_q * a) * decay * fading

    def potential(self, gap, work_ratio=1.0):
        """Energy of the interface, phi_n, zero where it is open; above ``deepest``, and where
        work_ratio is q."""
        sheared = np.any(gap[1:]) and not math.isclose(work_ratio, self.xu_needleman_q,
                                                       rel_tol=1e-9)
        if sheared or np.any(gap[0] < self.deepest):
            return None
        a = gap[0]
        q = self.xu_needleman_q
        r = self.xu_needleman_r
        remnant, linear = self._shares
        fading = np.exp(-np.sum(gap[1:] ** 2, axis=0))
        return np.exp(-a) * ((1.0 - r + a) * remnant - (q + linear * a) * fading)
