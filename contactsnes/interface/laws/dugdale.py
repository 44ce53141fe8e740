"""The constant attraction of Dugdale and Maugis, smoothed."""

import math
from functools import cached_property

import numpy as np

from ...options.fields import option
from .law import Law
from .modified import Modified


class Dugdale(Modified):
    """t_n = N(a) E_r(b) where a > 0, N(a) below; friction as of the law modified, with h(a) in
    place of exp(-a).

    N(a) = (1 - exp(-a/w)) / (1 + exp((a-c)/w)): about 1 from w to c, and a repulsion exp(-a/w) in
    overlap. The end c, about 1 + w, makes the work of adhesion 1. h(a) falls from 1 as N does at
    its end.
    """

    name, meaning = "dugdale", "constant attraction up to a gap, smoothed: Dugdale, Maugis"
    dugdale_width: float = option(0.1, "w of the law dugdale: gap over which the "
                                  "attraction rises and ends", "delta_n", minimum=0.01,
                                  maximum=1)
    derived = ("end",)
    normal_peak, softening = Law.normal_peak, Law.softening
    moving_stiffness, newton_stiffness = Law.moving_stiffness, Law.newton_stiffness

    @cached_property
    def end(self):
        """c: the gap at which half of the attraction is left, of which the work of adhesion is
        1."""
        from scipy.optimize import brentq  # needed for this law only, and slow to import

        width = self.dugdale_width
        return brentq(lambda c: width * ((1.0 + math.exp(-c / width))
                                         * math.log1p(math.exp(c / width)) - 1.0) - 1.0, 0.0, 5.0,
                      xtol=1e-15, rtol=1e-15)

    @property
    def range(self):
        """Normal gap beyond which there is no attraction: it is below rounding after 37 widths.
        Where these are short it is told as more, so that the window is wider: in one just as wide
        as the attraction Newton's steps end on other equilibria, and contact, up to e ranges by
        default, may go beyond it."""
        return self.end + max(37.0 * self.dugdale_width, min(36.0, 100.0 * self.dugdale_width), 3.0)

    @property
    def deepest(self):
        """Normal gap below which tractions continue linearly."""
        return -30.0 * self.dugdale_width

    @property
    def repulsion(self):
        """Overlap over which the repulsion grows by a factor e."""
        return self.dugdale_width

    @property
    def opening_range(self):
        """Normal gap within which the law is sampled."""
        return self.end + 8.0 * self.dugdale_width

    def _normal(self, a):
        """N(a) and h(a)."""
        width = self.dugdale_width
        # 1 / (1 + exp(x)) without overflow
        part = 0.5 - 0.5 * np.tanh(0.5 * (a - self.end) / width)
        return (1.0 - np.exp(-a / width)) * part, (1.0 + np.exp(-self.end / width)) * part

    def energy(self, normal_gap):
        """Interface energy without slip, phi_n, zero at a = 0: its derivative is N(a)."""
        width, depth = self.dugdale_width, np.minimum(normal_gap - self.deepest, 0.0)
        bounded, ratio = normal_gap - depth, math.exp(-self.end / self.dugdale_width)
        logarithm = bounded / width + math.log1p(ratio) - np.logaddexp(0.0,
                                                                       (bounded - self.end) / width)
        traction, slope = self.normal(bounded)
        whole = width * ((1.0 + ratio) * logarithm - 1.0 + np.exp(-bounded / width))
        return whole + depth * (traction + 0.5 * slope * depth)
