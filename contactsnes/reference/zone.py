"""A strip that stays closed at |x| < a under a uniform traction s on a < |x| < c: Dugdale's zone,
in tension or shear.

The traction is that of flat punches of half widths b between a and c. Abel's equation gives the
force that they carry, dF = (2 s L/pi) dt with cos(pi b/L) = cos(pi c/L)/cos(t), t from 0 at b = c
to the `zone_angle` at b = a. A punch under a unit force moves its middle by (2/pi) ln(1/sin(pi
b/L)) relative to the mean surface, and by (2/pi) artanh(tan(t)/tan(pi c/L)) relative to c. The
forces and tractions are those of Dugdale's collinear cracks (Tada, Paris & Irwin 2000).
"""

import numpy as np

from .checks import at_most, half_angle, not_negative, periodic_angle, positive, root_depth

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)
_NODES, _WEIGHTS = (1 + _NODES) / 2, _WEIGHTS / 2


def _require_order(inner, outer, period):
    half_angle(outer, period)
    not_negative(inner=inner)
    at_most(inner, outer,
            f"the inner edge {inner} of the zone must lie between 0 and its outer edge {outer}")


def zone_angle(inner, outer, period):
    """arccos(cos(pi c/L)/cos(pi a/L)) without cancellation.

    Parameters
    ----------
    inner, outer : float or array, a <= c, beta
    period : float, beta, finite
    """
    _require_order(inner, outer, period)
    return np.arctan2(np.pi / period * root_depth(inner, outer, period),
                      np.cos(np.pi * np.asarray(outer) / period))


def zone_force(inner, outer, stress, period=np.inf):
    """Force of the whole strip, 2 s sqrt(c^2 - a^2); periodic (2 s L/pi) arccos(cos(pi c/L)/cos(pi
    a/L)), exact.

    Parameters
    ----------
    inner, outer : float or array, a <= c, beta
    stress : float or array, s, E* beta/R, in shear times sqrt(phi_t/phi_n)
    period : float, beta; `inf`: isolated
    """
    _require_order(inner, outer, period)
    if np.isinf(period):
        return 2 * stress * root_depth(inner, outer)
    return 2 * stress * period / np.pi * zone_angle(inner, outer, period)


def zone_traction(x, inner, outer, stress, period=np.inf):
    """s on a < |x| < c, and within a (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)); periodic, exact, (2
    s/pi) arctan of cos(pi x/L) sqrt(sin^2(pi c/L) - sin^2(pi a/L))/(cos(pi c/L) sqrt(sin^2(pi a/L)
    - sin^2(pi x/L))).

    Parameters
    ----------
    x : float or array, beta; isolated any unit of length, in which the edges are, too
    inner, outer, stress, period : as of `zone_force`
    """
    _require_order(inner, outer, period)
    outside = np.cos(np.pi * np.asarray(x) / period) * root_depth(inner, outer, period)
    inside = np.cos(np.pi * np.asarray(outer) / period) * root_depth(x, inner, period)
    return stress * np.where(np.abs(x) < outer, 2 / np.pi * np.arctan2(outside, inside), 0.0)


def _sum_over_punches(function, angle):
    """Integral of function(t, `angle` - t) over 0 < t < `angle`, where it may have a logarithm at
    the upper end."""
    angle = np.asarray(angle)[..., None]
    rest = angle * (1 - _NODES) ** 3
    return np.sum(_WEIGHTS * 3 * angle * (1 - _NODES) ** 2 * function(angle - rest, rest), axis=-1)


def opening_by_punches(density, angle, outer_angle):
    """Integral of density(t) artanh(tan(t)/tan(C)) over 0 < t < `angle`, C = pi c/L.

    Parameters
    ----------
    density : function (array of angles) -> array
    angle, outer_angle : float or array, radians; C is at least the angle
    """
    C, least = np.asarray(outer_angle)[..., None], np.asarray(outer_angle - angle)[..., None]
    return _sum_over_punches(lambda t,
                             rest: density(t) * np.log(np.sin(C + t) / np.sin(least + rest)) / 2,
                             angle)


def isolated_opening(spread, inner, stress):
    """Displacement at c relative to |x| < a, isolated, (4 s a/pi)[sqrt(m^2-1) arcosh m - m ln m], m
    = c/a = cosh(spread).

    Parameters
    ----------
    spread : float or array, arcosh c/a, dimensionless
    inner, stress : float or array, a, beta; s, as of `zone_force`
    """
    logarithm = np.log1p(2 * np.sinh(spread / 2) ** 2)
    return 4 * stress * inner / np.pi * (spread * np.sinh(spread) - np.cosh(spread) * logarithm)


def zone_opening(inner, outer, stress, period=np.inf):
    """Displacement at c relative to |x| < a, for a > 0; periodic by quadrature over the punches.

    Parameters
    ----------
    inner, outer, stress, period : as of `zone_force`
    """
    _require_order(inner, outer, period)
    positive(inner=inner)
    if np.isinf(period):
        return isolated_opening(np.arccosh(np.maximum(np.divide(outer, inner), 1.0)), inner, stress)
    angle = zone_angle(inner, outer, period)
    return 4 * stress * period / np.pi**2 * opening_by_punches(np.ones_like, angle,
                                                               half_angle(outer, period))


def zone_lift(inner, outer, stress, period):
    """Displacement of |x| < a relative to the mean surface, by quadrature over the punches.

    Parameters
    ----------
    inner, outer, stress : as of `zone_force`
    period : float, beta, finite
    """
    C, angle = periodic_angle(outer, period)[..., None], zone_angle(inner, outer, period)

    def logarithm(t, rest):  # ln(1/sin(pi b/L))
        return np.log(np.cos(t)) - np.log(np.sin(C + t) * np.sin(C - angle[..., None] + rest)) / 2

    return 4 * stress * period / np.pi**2 * _sum_over_punches(logarithm, angle)
