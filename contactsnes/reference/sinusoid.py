"""A wave on a flat, one contact a period, without adhesion or with one of short range (a large
normal Maugis parameter).

Exact where the slope of the wave, 2 pi A/L in true lengths, is small.
"""

import numpy as np

from .checks import (
    at_most,
    elementwise,
    find_root,
    half_width_of,
    not_negative,
    periodic_angle,
    positive,
    require,
    root_depth,
    times_log_sine,
)
from .line import ligament_force, ligament_traction, load_extrema


def sinusoid_load(half_width, period, amplitude, work_of_adhesion=1.0):
    """Load per period on the wave A(1 - cos 2 pi x/L), W = pi A sin^2(pi a/L) - sqrt(2 L tan(pi
    a/L) w) (Westergaard 1939; adhesive: Johnson 1995). Full contact needs W = pi A without adhesion
    (w = 0). Stable or not; adhesion of short range, a finite period.

    Parameters
    ----------
    half_width : float or array, beta
    period : float, beta, finite
    amplitude : float or array > 0, A, u_n,r
    work_of_adhesion : float or array, phi_n
    """
    positive(amplitude=amplitude)
    smooth = np.pi * amplitude * np.sin(periodic_angle(half_width, period)) ** 2
    return smooth - ligament_force(half_width, period, work_of_adhesion)


def sinusoid_pressure(x, half_width, period, amplitude, work_of_adhesion=1.0):
    """Pressure on the wave of `sinusoid_load`, (2 pi A/L) cos(pi x/L) sqrt(sin^2(pi a/L) - sin^2(pi
    x/L)) minus the ligament's traction (Westergaard 1939; Johnson 1995), 0 outside; conditions as
    there.

    Parameters
    ----------
    x : float or array, beta
    half_width, period, amplitude, work_of_adhesion : as of `sinusoid_load`
    """
    positive(amplitude=amplitude)
    force = ligament_force(half_width, period, work_of_adhesion)
    depth = np.pi / period * root_depth(x, half_width, period)
    smooth = 2 * np.pi * amplitude / period * np.cos(np.pi * np.asarray(x) / period) * depth
    return smooth - ligament_traction(x, half_width, force, period)


def sinusoid_approach(half_width, period, amplitude, work_of_adhesion=1.0):
    """Approach of the mean surface to the wave of `sinusoid_load`, A s^2 (1 - 2 ln s) - (2/pi) F
    ln(1/s) with s = sin(pi a/L), by the sum of flat punches; A at full contact. Conditions as
    there.

    Parameters
    ----------
    half_width, period, amplitude, work_of_adhesion : as of `sinusoid_load`
    """
    positive(amplitude=amplitude)
    angle = periodic_angle(half_width, period)
    force = ligament_force(half_width, period, work_of_adhesion)
    s = np.sin(angle)
    return amplitude * (s**2 - times_log_sine(2 * s**2, angle)) + 2 / np.pi * times_log_sine(force,
                                                                                             angle)


@elementwise
def sinusoid_half_width(load, period, amplitude, work_of_adhesion=1.0):
    """Half width on the wave of `sinusoid_load` that is stable at a load, between pull-off and the
    jump to full contact, both at sin^3 t cos^5 t = w L/(8 pi^2 A^2), t = pi a/L (Johnson 1995);
    without adhesion up to full contact, below half the period by rounding. Conditions as there;
    ValueError where nothing partial is stable.

    Parameters
    ----------
    load : float or array, w_n,r
    period, amplitude, work_of_adhesion : as of `sinusoid_load`
    """
    require(0 < period < np.inf, f"period {period} must be positive and finite")
    positive(amplitude=amplitude)
    not_negative(work_of_adhesion=work_of_adhesion)
    message, full = f"no stable partial contact with the wave at the load {load}", np.pi * amplitude
    if work_of_adhesion == 0:
        at_most(load, full, message)
        require(load >= 0, message)
        share = min(load / full, 1.0)
        return float(half_width_of(np.arctan2(np.sqrt(share), np.sqrt(1 - share)), period))

    # `sinusoid_load` of tan t, which tells apart what nearly fills the period
    def carried(tangent):
        bond = np.sqrt(2 * period * tangent) * np.sqrt(work_of_adhesion)
        return full * tangent**2 / (1 + tangent**2) - bond

    logs = np.log([work_of_adhesion, period, 8 * np.pi**2, amplitude])
    log_value = logs @ [1, 1, -1, -2]
    tangent = find_root(carried, *load_extrema(5, log_value, period), message, load)
    return float(half_width_of(np.arctan(tangent), period))
