"""Line contacts with a finite range of adhesion: Maugis and Dugdale's zone, and the rigid limit."""

import functools

import numpy as np

from .checks import ROUNDING, elementwise, find_root, minimizer, positive, require
from .laws import peak_normal_traction
from .line import hertz_line_approach, hertz_line_load, hertz_line_pressure
from .zone import isolated_opening, opening_by_punches, zone_lift, zone_traction

SMALLEST = -20.0  # log of the narrowest cohesive zone, or contact, that is looked at


def _isolated_state(log_spread, normal_maugis):
    """(load, a, c) for c/a = cosh(spread): the condition s h(c) = 1 is quadratic in a."""
    spread, stress = np.exp(log_spread), peak_normal_traction(normal_maugis)
    series = 2 / 3 * spread**3 * (1 + spread**2 / 5 + 2 * spread**4 / 105)
    # m sqrt(m^2-1) - arcosh m
    parabola = series if spread < 0.02 else np.sinh(2 * spread) / 2 - spread
    linear = stress * isolated_opening(spread, 1.0, stress)
    a = 2 / (linear + np.sqrt(linear**2 + 2 * stress * parabola))
    return np.pi * a**2 / 4 - 2 * stress * a * np.sinh(spread), a, a * np.cosh(spread)


def _periodic_state(log_share, normal_maugis, period):
    """(load, a, c) for a = L/2 times a share; the load is nan where the zone would fill the
    cell."""
    stress, A = peak_normal_traction(normal_maugis), np.pi / 2 * np.exp(log_share)

    # the punches of the zone and those that Hertz's contact lacks up to c open the gap at c
    def excess(log_angle):
        angle = np.exp(log_angle)
        C = np.arctan2(np.hypot(np.sin(A), np.cos(A) * np.sin(angle)), np.cos(A) * np.cos(angle))
        gap = period / np.pi**2 * opening_by_punches(lambda t: period * np.tan(t) + 4 * stress,
                                                     angle, C)
        return stress * gap - 1

    widest = np.log(np.pi / 2 - 1e-6)
    if excess(widest) < 0:
        return np.nan, np.nan, np.nan
    angle = np.exp(find_root(excess, SMALLEST, widest,
                             f"no cohesive zone at the normal_maugis {normal_maugis}"))
    C = np.arctan2(np.hypot(np.sin(A), np.cos(A) * np.sin(angle)), np.cos(A) * np.cos(angle))
    a = period / np.pi * A
    return hertz_line_load(a, period) - 2 * stress * period / np.pi * angle, a, period / np.pi * C


@functools.lru_cache(maxsize=64)
def _stable(normal_maugis, period):
    """(state, least, largest): the function of one number that goes through the states stable at a
    load, and its range."""
    positive(normal_maugis=normal_maugis, period=period)
    if np.isinf(period):
        def state(log_spread):
            return _isolated_state(log_spread, normal_maugis)
        smallest = SMALLEST - np.log(max(peak_normal_traction(normal_maugis), 1.0))
        return state, minimizer(lambda t: state(t)[0], smallest, np.log(40.0)), smallest

    def state(log_share):
        return _periodic_state(log_share, normal_maugis, period)

    shares = np.concatenate([np.linspace(SMALLEST, -2.0, 60),
                             np.log(np.linspace(np.exp(-2.0), 1.0, 60)[1:-1])])
    loads = np.array([state(share)[0] for share in shares])
    message = ("no partial contact is stable at any load for the "
               f"normal_maugis {normal_maugis} and period {period}")
    # A contact that has shrunk to nothing changes the load by rounding only.
    rising = np.flatnonzero(np.diff(loads) > ROUNDING * np.abs(loads[1:]))
    require(rising.size, message)
    ends = [minimizer(lambda t: sign * state(t)[0], shares[max(k - 1, 0)],
                      shares[min(k + 1, np.sum(np.isfinite(loads)) - 1)])
            for sign, k in ((1, np.argmin(loads[:rising[0] + 1])), (-1, rising[-1] + 1))]
    return state, *ends


@elementwise
def maugis_line_pull_off(normal_maugis, period=np.inf):
    """(load, a, c) of least load of `maugis_line`. For a normal Maugis parameter below about 1 the
    contact a shrinks there to nothing; its value is then only as exact as the flat minimum
    allows."""
    state, least, _ = _stable(float(normal_maugis), float(period))
    return state(least)


@elementwise
def maugis_line(load, normal_maugis, period=np.inf):
    """Half widths (a, c) of a Maugis-Dugdale cylinder that is stable at a load: contact |x| < a,
    uniform tension s = lambda_n/e on a < |x| < c (the peak of the exponential law, over the range e
    delta_n), s h(c) = 1; isolated, with m = c/a: 1 = (s a^2/2)[m sqrt(m^2-1) - arcosh m] + (4 s^2
    a/pi)[sqrt(m^2-1) arcosh m - m ln m], W = pi a^2/4 - 2 s a sqrt(m^2-1) (Baney & Hui 1997;
    Johnson & Greenwood 2008); periodic, exact, by the sum of flat punches: 1 = s (L/pi^2) int (L
    tan t + 4 s) artanh(tan(t)/tan(pi c/L)) dt over 0 < t < T, T = arccos(cos(pi c/L)/cos(pi a/L)),
    W = W_Hertz - 2 s L T/pi.

    Any normal Maugis parameter. The width of the law (gaps below e delta_n) exceeds 2 c by up to
    2.5 % at a parameter of 1, 0.5 % at 3 and 0.2 % from 5 on, under a load of 25. ValueError below
    pull-off and, in a cell, where the contact or the zone jumps to the full period.

    Parameters
    ----------
    load : float or array, w_n,r
    normal_maugis : float or array, dimensionless
    period : float, beta; `inf`: isolated
    """
    state, least, end = _stable(float(normal_maugis), float(period))
    if np.isinf(period):
        # So narrow a zone belongs to a larger load: s a^2 spread^3 and s^2 a spread^2 are below 3.
        stress, size = np.log(peak_normal_traction(normal_maugis)), np.log(max(load, 1.0)) / 2
        end = min(end, -4.0 - (stress + 2 * size) / 3, -4.0 - stress - size / 2)
    found = find_root(lambda t: state(t)[0], end, least,
                      f"no stable Maugis-Dugdale contact at the load {load}", load)
    return state(found)[1:]


def maugis_line_pressure(x, contact_half_width, cohesive_half_width, normal_maugis, period=np.inf):
    """Pressure of `maugis_line` with the half widths (a, c): Hertz's minus the zone's tension,
    sqrt(a^2-x^2)/2 - (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)) within a, -s up to c, or its
    periodic form; without singularity anywhere.

    Parameters
    ----------
    x, contact_half_width, cohesive_half_width : float or array, beta; the half widths a, c
    normal_maugis : float or array, dimensionless
    period : float, beta; `inf`: isolated
    """
    tension = zone_traction(x, contact_half_width, cohesive_half_width,
                            peak_normal_traction(normal_maugis), period)
    return hertz_line_pressure(x, contact_half_width, period) - tension


def maugis_line_approach(contact_half_width, cohesive_half_width, normal_maugis, period):
    """Approach of the mean surface of `maugis_line` with the half widths (a, c): Hertz's less the
    lift by the zone's tension. Needs a finite period.

    Parameters
    ----------
    contact_half_width, cohesive_half_width : float or array, beta
    normal_maugis : float or array, dimensionless
    period : float, beta, finite
    """
    lift = zone_lift(contact_half_width, cohesive_half_width, peak_normal_traction(normal_maugis),
                     period)
    return hertz_line_approach(contact_half_width, period) - lift


def rigid_cylinder_load(gap, normal_maugis):
    """Load of a rigid parabola at a least gap h under the exponential law, W = -sqrt(2 pi
    lambda)(lambda h + 1/2) exp(-lambda h) (Bradley 1932 for a line): the limit of normal Maugis
    parameters lambda well below 1; at 1 the load at pull-off is about a tenth below."""
    positive(normal_maugis=normal_maugis)
    ranges = normal_maugis * np.asarray(gap)
    return -np.sqrt(2 * np.pi * normal_maugis) * (ranges + 0.5) * np.exp(-ranges)


def rigid_cylinder_pull_off(normal_maugis):
    """(gap, load) of least load of `rigid_cylinder_load`: lambda h = 1/2, W = -sqrt(2 pi lambda/e);
    lambda well below 1."""
    positive(normal_maugis=normal_maugis)
    return 0.5 / normal_maugis, -np.sqrt(2 * np.pi * normal_maugis * np.exp(-1.0))
