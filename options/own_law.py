"""The law of own-law.opts: attraction as the package's, and a friction that saturates without a
peak."""

import numpy as np

from contactsnes import option
from contactsnes.interface.laws.coupled import Coupled


class Saturating(Coupled):
    """t_n = a exp(-a) exp(-b^2), t_t = s b / sqrt(1 + b^2) exp(-a); in overlap neither fades."""

    saturating_strength = option(0.5, "friction at large slip (law Saturating)", "phi_t/delta_t",
                                 above=0)
    slip_options = ("saturating_strength",)
    decoupled_in_overlap = True
    gap_corners = (0.0,)
    slip_peak = 1.0

    def friction(self, slip):
        """T(b)/b, the friction over the slip; its derivative is made from it."""
        return self.saturating_strength / np.sqrt(1 + slip ** 2)

    def friction_energy(self, slip):
        """Integral of T(b), of which energies are made where the surfaces overlap."""
        return self.saturating_strength * (np.sqrt(1 + slip ** 2) - 1)
