"""The law of McGarry et al. (2014), whose tractions all fade with opening and with slip."""

import math

from .coupled import SLIP, TANGENTIAL_PEAK, Coupled


class McGarry(Coupled):
    """Law of McGarry et al. (2014), eq. (3) of the paper with the factor 2 that makes eq. (4b)
    right.

    t_n = a exp(-a) exp(-b^2),  t_t = 2 b exp(-a) exp(-b^2) e.
    """

    name, meaning = "mcgarry", "eq. 3"
    slip_peak, tangential_peak = SLIP, TANGENTIAL_PEAK
    slip_softening = 4 * math.exp(-1.5)
