"""Line contacts under a normal load, without adhesion or with one of short range (JKR), and the
bonded strip.

The forms for a cell are exact: the half width may be anything below half the period (narrow beside
the radius of the cylinder).

JKR's are the limit of a large normal Maugis parameter. The width of Maugis and Dugdale's contact
(`maugis_line`), which is that of the law's threshold, exceeds JKR's by 0.3 % at a parameter of 10
and a load of 25, by 1 % near pull-off; at 3 by 2 % and 10 %.
"""

import numpy as np
from scipy.special import spence

from .checks import (
    elementwise,
    find_root,
    half_angle,
    half_width_of,
    jkr_root,
    log_cosine,
    not_negative,
    periodic_angle,
    positive,
    reciprocal_depth,
    root_depth,
    times_log_sine,
)

FULLEST = 1e15
"""Tangent of pi a/L up to which contacts are looked at: beyond, what they leave open is
rounding."""


def hertz_line_load(half_width, period=np.inf):
    """Load of a cylinder, W = pi a^2/4 (Johnson 1985); periodic: W = -(L^2/2 pi) ln cos(pi a/L),
    exact. For contacts without adhesion, or whose adhesion slip has taken away."""
    angle = half_angle(half_width, period)
    if np.isinf(period):
        return np.pi * np.square(half_width) / 4
    return -period**2 / (2 * np.pi) * log_cosine(angle)


def hertz_line_half_width(load, period=np.inf):
    """Half width of a cylinder at a load (float or array >= 0), the inverse of `hertz_line_load`;
    conditions as there. Below half the period by rounding where the load leaves less of the cell
    open."""
    not_negative(load=load)
    positive(period=period)
    if np.isinf(period):
        return 2 * np.sqrt(load / np.pi)
    depth = 4 * np.pi * np.asarray(load) / period**2
    return half_width_of(np.arctan2(np.sqrt(-np.expm1(-depth)), np.exp(-depth / 2)), period)


def hertz_line_pressure(x, half_width, period=np.inf):
    """Pressure p = sqrt(a^2 - x^2)/2, 0 outside (Johnson 1985); periodic, exact:
    p = (L/2 pi) arcosh(cos(pi x/L)/cos(pi a/L)). Conditions of `hertz_line_load`.

    Parameters
    ----------
    x, half_width : float or array, beta
    period : float, beta; `inf`: isolated
    """
    angle, depth = half_angle(half_width, period), root_depth(x, half_width, period)
    if np.isinf(period):
        return depth / 2
    return period / (2 * np.pi) * np.arcsinh(np.pi / period * depth / np.cos(angle))


def hertz_line_approach(half_width, period):
    """Approach of the mean surface, d = (L^2/4 pi^2)[ln v ln(1-v) + Li_2(v)], v = sin^2(pi a/L),
    exact; for a << L, d = (2/pi)[W ln(L/(pi a)) + pi a^2/8]. Conditions of `hertz_line_load`, and a
    finite period: an isolated line contact has no finite approach."""
    angle = periodic_angle(half_width, period)
    v = np.sin(angle) ** 2
    # Li_2, where 1 - v would lose digits
    series = v * (1 + v / 4 + v**2 / 9 + v**3 / 16 + v**4 / 25)
    dilogarithm = np.where(v < 1e-3, series, spence(np.cos(angle) ** 2))
    return (period / (2 * np.pi)) ** 2 * (times_log_sine(4 * log_cosine(angle),
                                                         angle) + dilogarithm)


def ligament_force(half_width, period=np.inf, work_of_adhesion=1.0):
    """Force that breaks a bonded strip in mode I or II, F = sqrt(2 L tan(pi a/L) w), isolated
    sqrt(2 pi a w), from K^2 = F^2/(L tan(pi a/L)) = 2 w (Tada, Paris & Irwin 2000). In mode I it is
    the adhesive part of JKR's load. In mode II it is the tangential strength if the traction falls
    to zero within a short range (law of McGarry et al., tangential Maugis parameter above about 5),
    not if residual friction remains.

    Parameters
    ----------
    half_width : float or array, beta
    period : float, beta; `inf`: isolated
    work_of_adhesion : float or array, phi_n; in mode II phi_t
    """
    angle = half_angle(half_width, period)
    not_negative(work_of_adhesion=work_of_adhesion)
    width = np.pi * np.asarray(half_width) if np.isinf(period) else period * np.tan(angle)
    return np.sqrt(2 * width) * np.sqrt(work_of_adhesion)


def ligament_traction(x, half_width, force=1.0, period=np.inf):
    """Traction on a bonded strip or under a flat punch, F/(pi sqrt(a^2 - x^2)), 0 outside (Johnson
    1985); periodic: F cos(pi x/L)/(L sqrt(sin^2(pi a/L) - sin^2(pi x/L))) (Tada, Paris & Irwin
    2000), exact. Holds where nothing opens or slips at |x| < a, up to about the range of the law
    from the edges.

    Parameters
    ----------
    x, half_width : float or array, beta
    force : float or array, w_n,r; in mode II w_t,r
    period : float, beta; `inf`: isolated
    """
    half_angle(half_width, period)
    return force / np.pi * np.cos(np.pi * np.asarray(x) / period) * reciprocal_depth(x, half_width,
                                                                                     period)


def ligament_stiffness(half_width, period):
    """Force per displacement of the mean surface, pi/(2 ln(1/sin(pi a/L))), normal or tangential,
    exact for a > 0 and a finite period: the initial stiffness of a contact that neither opens nor
    slips, a stiff interface."""
    positive(half_width=half_width)
    return -np.pi / (2 * times_log_sine(1.0, periodic_angle(half_width, period)))


def jkr_line_load(half_width, period=np.inf, work_of_adhesion=1.0):
    """JKR load of a cylinder, `hertz_line_load` - `ligament_force`: W = pi a^2/4 - sqrt(2 pi a w)
    (Barquins 1988). Stable or not. For adhesion of short range, a large normal Maugis parameter.

    Parameters
    ----------
    half_width, period : beta, as of `ligament_force`
    work_of_adhesion : float or array, phi_n
    """
    return hertz_line_load(half_width, period) - ligament_force(half_width, period,
                                                                work_of_adhesion)


def jkr_line_pressure(x, half_width, period=np.inf, work_of_adhesion=1.0):
    """JKR pressure of a cylinder, sqrt(a^2 - x^2)/2 - sqrt(2 w/(pi a))/sqrt(1 - x^2/a^2) (Barquins
    1988) or its periodic form, 0 outside: tension without bound towards the edge, where the law's
    peak bounds it within its range. For a large normal Maugis parameter.

    Parameters
    ----------
    x, half_width, period : beta, as of `ligament_traction`
    work_of_adhesion : float or array, phi_n
    """
    force = ligament_force(half_width, period, work_of_adhesion)
    return hertz_line_pressure(x, half_width, period) - ligament_traction(x, half_width, force,
                                                                          period)


def jkr_line_approach(half_width, period, work_of_adhesion=1.0):
    """JKR approach of the mean surface, d = d_Hertz - (2/pi) F ln(1/sin(pi a/L)), F =
    `ligament_force`: the periodic cell in the limit of a short range of adhesion (normal Maugis
    parameter to infinity). Needs a finite period.

    Parameters
    ----------
    half_width : float or array, beta
    period : float, beta, finite
    work_of_adhesion : float or array, phi_n
    """
    force = ligament_force(half_width, period, work_of_adhesion)
    lift = times_log_sine(force, half_angle(half_width, period))
    return hertz_line_approach(half_width, period) + 2 / np.pi * lift


def load_extrema(power, log_value, period):
    """Tangents s of t = pi a/L for the least and the largest load, the roots of exp(log_value) =
    sin^3 t cos^power t = s^3 (1 + s^2)^(-(3 + power)/2); twice the same where they are one to
    rounding.

    Parameters
    ----------
    power : float, of the cosine, > 0
    log_value : float, dimensionless
    period : float, beta, for the message
    """
    def logarithm(x):  # of the left side, x = ln s; below 3 x and -power x
        return 3 * x - (3 + power) * np.logaddexp(0.0, 2 * x) / 2

    message = f"no partial contact is stable at any load, period {period}"
    peak = np.log(3 / power) / 2
    ends = min(log_value / 3 - 1, peak), max(1 - log_value / power, peak)
    return [np.exp(min(find_root(logarithm, peak, end, message, log_value),
                       np.log(FULLEST))) for end in ends]


def _jkr_extrema(period, work_of_adhesion):
    """`load_extrema` of JKR contacts with the parabola."""
    return load_extrema(1, np.log(2 * np.pi**2) + np.log(work_of_adhesion) - 3 * np.log(period),
                        period)


def _jkr_load(tangent, period, work_of_adhesion):
    """`jkr_line_load` of the tangent of pi a/L, which tells apart what nearly fills the cell."""
    hertz = (period / np.sqrt(4 * np.pi)) ** 2 * np.log1p(tangent**2)
    return hertz - np.sqrt(2 * period * tangent) * np.sqrt(work_of_adhesion)


@elementwise
def jkr_line_pull_off(period=np.inf, work_of_adhesion=1.0):
    """(half_width, load) at pull-off under a prescribed load, dW/da = 0: a = (2w/pi)^(1/3), W = -3
    pi a^2/4 (Barquins 1988); periodic: sin^3 t cos t = 2 pi^2 w/L^3, t = pi a/L < pi/3. For a large
    normal Maugis parameter (from 3 on within 1 % of the load) and cells of L^3 > 32 pi^2 w/(3 sqrt
    3), below which no partial contact is stable."""
    positive(period=period)
    not_negative(work_of_adhesion=work_of_adhesion)
    if np.isinf(period) or work_of_adhesion == 0:
        half_width = np.cbrt(2 * work_of_adhesion / np.pi)
        return half_width, -3 * np.pi / 4 * half_width**2
    least = _jkr_extrema(period, work_of_adhesion)[0]
    return half_width_of(np.arctan(least), period), _jkr_load(least, period, work_of_adhesion)


@elementwise
def jkr_line_half_width(load, period=np.inf, work_of_adhesion=1.0):
    """Half width of a JKR cylinder that is stable at a load. ValueError below pull-off and, in a
    periodic cell, above the load at which the contact jumps to the full period. For a large normal
    Maugis parameter.

    Parameters
    ----------
    load : float or array, w_n,r
    period, work_of_adhesion : beta and phi_n, as of `jkr_line_load`
    """
    message = f"no stable partial JKR contact at the load {load}"
    positive(period=period)
    not_negative(work_of_adhesion=work_of_adhesion)
    if work_of_adhesion == 0:
        return float(hertz_line_half_width(load, period))
    if np.isinf(period):
        least = np.cbrt(2 * work_of_adhesion / np.pi)
        unit = np.pi * least**2 / 4
        if load > 1e80 * unit:  # adhesion is below rounding
            return float(hertz_line_half_width(load))
        return float(least * jkr_root(load / unit, message) ** 2)
    tangent = find_root(lambda s: _jkr_load(s, period, work_of_adhesion),
                        *_jkr_extrema(period, work_of_adhesion), message, load)
    return float(half_width_of(np.arctan(tangent), period))


@elementwise
def jkr_line_fold(period, work_of_adhesion=1.0):
    """(half_width, approach, load) at pull-off under a prescribed approach of the mean surface:
    dd/da = 0 of `jkr_line_approach`. For a large normal Maugis parameter and a finite period; w >
    0."""
    def slope(a):  # (pi/2) dd/da
        t, force = periodic_angle(a, period), ligament_force(a, period, work_of_adhesion)
        # dW/da, dF/da
        hertz, release = period / 2 * np.tan(t), np.pi * work_of_adhesion / np.cos(t) ** 2 / force
        return np.log(np.sin(t)) * (release - hertz) + force * np.pi / period / np.tan(t)

    positive(work_of_adhesion=work_of_adhesion)
    # There the slope is negative and near full contact positive, whatever the work of adhesion.
    smallest = 1e-3 * min(period, np.cbrt(work_of_adhesion))
    a = find_root(slope, smallest, period / 2 * (1 - 1e-6),
                  f"no fold under a prescribed approach at the period {period}")
    return a, jkr_line_approach(a, period, work_of_adhesion), jkr_line_load(a, period,
                                                                            work_of_adhesion)


@elementwise
def jkr_line_half_width_at_approach(approach, period, work_of_adhesion=1.0):
    """Half width of a periodic JKR cylinder that is stable at an approach of the mean surface,
    between the fold and L^2/24, where the contact fills the cell. For a large normal Maugis
    parameter and a finite period; w > 0.

    Parameters
    ----------
    approach : float or array, u_n,r
    period, work_of_adhesion : beta and phi_n, as of `jkr_line_approach`
    """
    smallest = jkr_line_fold(period, work_of_adhesion)[0]
    return find_root(lambda a: jkr_line_approach(a, period, work_of_adhesion), smallest,
                     half_width_of(np.pi / 2, period),
                     f"no stable partial JKR contact at the approach {approach}", approach)
