"""Line contacts with a finite range of adhesion: Maugis and Dugdale's zone, and the rigid limit."""

import numpy as np

from .checks import find_root, minimizer, positive, require, root_depth
from .laws import peak_normal_traction
from .line import hertz_line_pressure

SMALLEST = -20.0  # log of the narrowest cohesive zone that is looked at


def cohesive_tension(x, inner, outer, stress):
    """Uniform stress s on a < |x| < c, and (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)) within a, which stays closed."""
    require(np.greater_equal(inner, 0) & np.less_equal(inner, outer),
            f"the inner edge {inner} of the zone must lie between 0 and its outer edge {outer}")
    share = 2 / np.pi * np.arctan2(np.sqrt((outer - inner) * (outer + inner)), root_depth(x, inner))
    return stress * np.where(np.abs(x) < outer, share, 0.0)


def cohesive_opening(spread, inner, stress):
    """Displacement at c relative to |x| < a under `cohesive_tension`, (4 s a/pi)[sqrt(m^2-1) arcosh m - m ln m],
    m = c/a = cosh(spread)."""
    logarithm = np.log1p(2 * np.sinh(spread / 2) ** 2)
    return 4 * stress * inner / np.pi * (spread * np.sinh(spread) - np.cosh(spread) * logarithm)


def _maugis_line_state(log_spread, normal_maugis):
    """(load, a, c) for c/a = cosh(spread): the condition s h(c) = 1 is quadratic in a."""
    spread, stress = np.exp(log_spread), peak_normal_traction(normal_maugis)
    series = 2 / 3 * spread**3 * (1 + spread**2 / 5 + 2 * spread**4 / 105)
    parabola = series if spread < 0.02 else np.sinh(2 * spread) / 2 - spread  # m sqrt(m^2-1) - arcosh m
    linear = stress * cohesive_opening(spread, 1.0, stress)
    a = 2 / (linear + np.sqrt(linear**2 + 2 * stress * parabola))
    return np.pi * a**2 / 4 - 2 * stress * a * np.sinh(spread), a, a * np.cosh(spread)


def _maugis_line_least(normal_maugis):
    return minimizer(lambda t: _maugis_line_state(t, normal_maugis)[0], SMALLEST, np.log(40.0))


def maugis_line_pull_off(normal_maugis):
    """(load, a, c) of least load of `maugis_line`. For a normal Maugis parameter below about 1 the contact a shrinks
    there to nothing; its value is then only as exact as the flat minimum allows."""
    return _maugis_line_state(_maugis_line_least(normal_maugis), normal_maugis)


def maugis_line(load, normal_maugis):
    """Half widths (a, c) of a Maugis-Dugdale cylinder at a load: contact |x| < a, uniform tension s = lambda_n/e on
    a < |x| < c (the peak of the exponential law, over the range e delta_n), s h(c) = 1, isolated; with m = c/a:
    1 = (s a^2/2)[m sqrt(m^2-1) - arcosh m] + (4 s^2 a/pi)[sqrt(m^2-1) arcosh m - m ln m],
    W = pi a^2/4 - 2 s a sqrt(m^2-1) (Baney & Hui 1997; Johnson & Greenwood 2008). The width of a numerical contact is
    to be compared with c. ValueError below pull-off."""
    least = _maugis_line_least(normal_maugis)
    spread = find_root(lambda t: _maugis_line_state(t, normal_maugis)[0] - load, SMALLEST, least,
                       f"no stable Maugis-Dugdale contact at the load {load}")
    return _maugis_line_state(spread, normal_maugis)[1:]


def maugis_line_pressure(x, contact_half_width, cohesive_half_width, normal_maugis):
    """Pressure of `maugis_line`, sqrt(a^2-x^2)/2 - (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)) within a, -s up to c."""
    tension = cohesive_tension(x, contact_half_width, cohesive_half_width, peak_normal_traction(normal_maugis))
    return hertz_line_pressure(x, contact_half_width) - tension


def rigid_cylinder_load(gap, normal_maugis):
    """Load of a rigid parabola at a least gap h under the exponential law, W = -sqrt(2 pi lambda)(lambda h + 1/2)
    exp(-lambda h) (Bradley 1932 for a line): the limit of small normal Maugis parameters lambda."""
    positive(normal_maugis=normal_maugis)
    ranges = normal_maugis * np.asarray(gap)
    return -np.sqrt(2 * np.pi * normal_maugis) * (ranges + 0.5) * np.exp(-ranges)


def rigid_cylinder_pull_off(normal_maugis):
    """(gap, load) of least load of `rigid_cylinder_load`: lambda h = 1/2, W = -sqrt(2 pi lambda/e)."""
    positive(normal_maugis=normal_maugis)
    return 0.5 / normal_maugis, -np.sqrt(2 * np.pi * normal_maugis * np.exp(-1.0))
