"""Friction that grows with the pressure where the surfaces overlap."""

import numpy as np

from ...options.fields import option
from .coupled import TANGENTIAL_PEAK
from .modified import Modified


class PressureFriction(Modified):
    """The law modified, but t_t = T(b) (1 + alpha p / tau_max) e in overlap, with the pressure p =
    -t_n.

    The peak of the friction is tau_0 + alpha p, tau_0 = tau_max being that of the law modified.
    """

    name, meaning = "pressure_friction", "modified, with friction that grows with the pressure"
    pressure_friction: float = option(0.1, "alpha of the law pressure_friction: growth "
                                      "of the friction's peak with the pressure, "
                                      "(phi_t/delta_t)/(phi_n/delta_n)", minimum=0)
    slip_options = (*Modified.slip_options, "pressure_friction")

    def _pressed(self, normal):
        return 1.0 - self.pressure_friction / TANGENTIAL_PEAK * normal

    def potential(self, gap, work_ratio=1.0):
        """As of the law modified without slip; with slip in overlap there is none."""
        if self.pressure_friction > 0.0 and np.any(gap[1:][:, gap[0] < self.range]):
            return None
        return super().potential(gap, work_ratio)
