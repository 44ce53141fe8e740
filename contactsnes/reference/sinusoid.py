"""A wave on a flat, one contact a period, without adhesion or with one of short range (a large normal Maugis parameter).

Exact where the slope of the wave, 2 pi A/L in true lengths, is small.
"""

import numpy as np
from scipy.special import xlogy

from .checks import elementwise, find_root, not_negative, periodic_angle, positive, require, root_depth
from .line import ligament_force, ligament_traction, load_extrema


def sinusoid_load(half_width, period, amplitude, work_of_adhesion=1.0):
    """Load per period on the wave A(1 - cos 2 pi x/L), W = pi A sin^2(pi a/L) - sqrt(2 L tan(pi a/L) w) (Westergaard
    1939; adhesive: Johnson 1995). Full contact needs W = pi A without adhesion (w = 0). Stable or not; adhesion of
    short range, a finite period."""
    positive(amplitude=amplitude)
    smooth = np.pi * amplitude * np.sin(periodic_angle(half_width, period)) ** 2
    return smooth - ligament_force(half_width, period, work_of_adhesion)


def sinusoid_pressure(x, half_width, period, amplitude, work_of_adhesion=1.0):
    """Pressure on the wave of `sinusoid_load`, (2 pi A/L) cos(pi x/L) sqrt(sin^2(pi a/L) - sin^2(pi x/L)) minus the
    ligament's traction (Westergaard 1939; Johnson 1995), 0 outside; conditions as there."""
    positive(amplitude=amplitude)
    force = ligament_force(half_width, period, work_of_adhesion)
    depth = np.pi / period * root_depth(x, half_width, period)
    smooth = 2 * np.pi * amplitude / period * np.cos(np.pi * np.asarray(x) / period) * depth
    return smooth - ligament_traction(x, half_width, force, period)


def sinusoid_approach(half_width, period, amplitude, work_of_adhesion=1.0):
    """Approach of the mean surface to the wave of `sinusoid_load`, A s^2 (1 - 2 ln s) - (2/pi) F ln(1/s) with
    s = sin(pi a/L), by the sum of flat punches; A at full contact. Conditions as there."""
    positive(amplitude=amplitude)
    s, force = np.sin(periodic_angle(half_width, period)), ligament_force(half_width, period, work_of_adhesion)
    return amplitude * (s**2 - xlogy(2 * s**2, s)) + 2 / np.pi * xlogy(force, s)


@elementwise
def sinusoid_half_width(load, period, amplitude, work_of_adhesion=1.0):
    """Half width on the wave of `sinusoid_load` that is stable at a load, between pull-off and the jump to full
    contact, both at sin^3 t cos^5 t = w L/(8 pi^2 A^2), t = pi a/L (Johnson 1995). Conditions as there; ValueError where nothing
    partial is stable."""
    require(0 < period < np.inf, f"period {period} must be positive and finite")
    positive(amplitude=amplitude)
    not_negative(work_of_adhesion=work_of_adhesion)
    extrema = load_extrema(5, work_of_adhesion * period / (8 * np.pi**2 * amplitude**2), period)
    return find_root(lambda a: sinusoid_load(a, period, amplitude, work_of_adhesion) - load, *extrema,
                     f"no stable partial contact with the wave at the load {load}")
