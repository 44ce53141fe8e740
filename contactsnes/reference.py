"""Analytic solutions to compare a numerical contact with.

Units and signs
---------------
Line contacts are dimensionless: contact modulus E*, radius R and normal work of adhesion phi_n are 1. Lengths along the
surface are in beta = (R^2 phi_n/E*)^(1/3), normal displacements and approaches in beta^2/R, loads (per length) in
E* beta^2/R, stresses in E* beta/R; tangential quantities carry a further sqrt(phi_t/phi_n), so that phi_t is 1 too.
Spheres take `contact_modulus`, `radius` and `work_of_adhesion` in any consistent units, 1 by default. Pressures, loads
and approaches are positive in compression. Normal and tangential directions are elastically decoupled, as for an
incompressible body on a rigid counterface.

Common arguments
----------------
x, r : float or array, distance from the centre of the contact
half_width, contact_radius : float or array >= 0, a; below half the period
period : float, length L of the periodic cell; `inf` (default) is the isolated contact
work_of_adhesion : float, w; lines: in units of phi_n, 0 gives Hertz's solutions; spheres: > 0
load, tangential_force : float; for line contacts per cell
Results have the shape of the arguments. Functions that find a state from a load or an approach take and return floats,
of the state that is stable when that quantity is prescribed. All raise ValueError for arguments out of range and where
no equilibrium exists.

Periodic line contacts are sums of rigid flat punches of half width b: `ligament_traction` per unit of force lifts the
contact by (2/pi) ln(1/sin(pi b/L)) above the mean surface. Abel's equation gives the density of punches that yields a
profile, (L/2) tan(pi b/L) for the parabola x^2/2 (so the solution is exact and closed; compare Block & Keer 2008) and
(2 pi^2 A/L) sin(pi b/L) cos(pi b/L) for the wave A(1 - cos 2 pi x/L), which is Westergaard's solution.

References
----------
Baney & Hui 1997, J. Adhes. Sci. Technol. 11; Barquins 1988, J. Adhes. 26; Block & Keer 2008, J. Mech. Mater. Struct. 3;
Bradley 1932, Phil. Mag. 13; Cattaneo 1938, Rend. Lincei 27; Ciavarella 1998, Int. J. Solids Struct. 35; Derjaguin,
Muller & Toporov 1975, J. Colloid Interface Sci. 53; Hutchinson & Suo 1992, Adv. Appl. Mech. 29; Johnson 1985, Contact
Mechanics; Johnson 1995, Int. J. Solids Struct. 32; Johnson & Greenwood 2008, J. Phys. D 41; Johnson, Kendall & Roberts
1971, Proc. R. Soc. A 324; Maugis 1992, J. Colloid Interface Sci. 150; McGarry et al. 2014, J. Mech. Phys. Solids 63;
Mindlin 1949, J. Appl. Mech. 16; Savkoor & Briggs 1977, Proc. R. Soc. A 356; Tada, Paris & Irwin 2000, The Stress
Analysis of Cracks Handbook; Westergaard 1939, J. Appl. Mech. 6.
"""

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import erfcx, spence, spherical_jn, xlogy

_SMALLEST = -20.0  # log of the narrowest cohesive zone that is looked at


def _require(condition, message):
    if not np.all(condition):
        raise ValueError(message)


def _positive(**values):
    for name, value in values.items():
        _require(np.greater(value, 0), f"{name} {value} must be positive")


def _not_negative(**values):
    for name, value in values.items():
        _require(np.greater_equal(value, 0), f"{name} {value} must not be negative")


def _root(function, low, high, message):
    """Zero of `function` in [low, high]; ValueError(message) where its sign does not change."""
    _require(function(low) * function(high) <= 0, message)
    return brentq(function, low, high, xtol=1e-15)


def _minimum(function, low, high):
    return minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-12}).x


def _angle(half_width, period):
    """pi a/L of a valid contact, 0 for an isolated one."""
    _positive(period=period)
    _require(np.greater_equal(half_width, 0) & np.less(half_width, period / 2),
             f"half_width {half_width} must be at least 0 and below half the period {period}")
    return np.pi * np.asarray(half_width) / period


def _cell_angle(half_width, period):
    """pi a/L, for results that do not exist without a cell."""
    _require(np.isfinite(period), "a displacement of the mean surface of a line contact needs a finite period")
    return _angle(half_width, period)


def _root_depth(x, half_width, period=np.inf):
    """sqrt(a^2 - x^2), or (L/pi) sqrt(sin^2(pi a/L) - sin^2(pi x/L)) without cancellation; 0 outside the contact."""
    left, right = half_width + np.asarray(x), half_width - np.asarray(x)
    if np.isfinite(period):
        left, right = (period / np.pi * np.sin(np.pi / period * distance) for distance in (left, right))
    return np.sqrt(np.maximum(left * right, 0.0))


def _reciprocal_depth(x, half_width, period=np.inf):
    depth = _root_depth(x, half_width, period)
    return np.divide(1.0, depth, out=np.zeros_like(depth), where=depth > 0)


# ---- line contact without adhesion

def hertz_line_load(half_width, period=np.inf):
    """Load of a cylinder, W = pi a^2/4 (Johnson 1985); periodic: W = -(L^2/2 pi) ln cos(pi a/L), exact."""
    angle = _angle(half_width, period)
    if np.isinf(period):
        return np.pi * np.square(half_width) / 4
    return -period**2 / (4 * np.pi) * np.log1p(-np.sin(angle) ** 2)


def hertz_line_half_width(load, period=np.inf):
    """Half width of a cylinder at a load (float or array >= 0), the inverse of `hertz_line_load`."""
    _not_negative(load=load)
    if np.isinf(period):
        return 2 * np.sqrt(load / np.pi)
    return period / np.pi * np.arcsin(np.sqrt(-np.expm1(-4 * np.pi * load / period**2)))


def hertz_line_pressure(x, half_width, period=np.inf):
    """Pressure p = sqrt(a^2 - x^2)/2, 0 outside (Johnson 1985); periodic, exact:
    p = (L/2 pi) arcosh(cos(pi x/L)/cos(pi a/L))."""
    angle, depth = _angle(half_width, period), _root_depth(x, half_width, period)
    if np.isinf(period):
        return depth / 2
    return period / (2 * np.pi) * np.arcsinh(np.pi / period * depth / np.cos(angle))


def hertz_line_approach(half_width, period):
    """Approach of the mean surface, d = (L^2/4 pi^2)[ln v ln(1-v) + Li_2(v)], v = sin^2(pi a/L), exact; for a << L,
    d = (2/pi)[W ln(L/(pi a)) + pi a^2/8]. Needs a finite period: an isolated line contact has no finite approach."""
    v = np.sin(_cell_angle(half_width, period)) ** 2
    series = v * (1 + v / 4 + v**2 / 9 + v**3 / 16 + v**4 / 25)  # Li_2, where 1 - v would lose digits
    return (period / (2 * np.pi)) ** 2 * (xlogy(np.log1p(-v), v) + np.where(v < 1e-3, series, spence(1 - v)))


# ---- bonded strip = flat punch, mode I or II

def ligament_force(half_width, period=np.inf, work_of_adhesion=1.0):
    """Force that breaks a bonded strip in mode I or II, F = sqrt(2 L tan(pi a/L) w), isolated sqrt(2 pi a w), from
    K^2 = F^2/(L tan(pi a/L)) = 2 w (Tada, Paris & Irwin 2000). In mode I it is the adhesive part of JKR's load. In
    mode II it is the tangential strength if the traction falls to zero within a short range (law of McGarry et al.,
    tangential Maugis parameter above about 5), not if residual friction remains."""
    angle = _angle(half_width, period)
    _not_negative(work_of_adhesion=work_of_adhesion)
    width = np.pi * np.asarray(half_width) if np.isinf(period) else period * np.tan(angle)
    return np.sqrt(2 * width * work_of_adhesion)


def ligament_traction(x, half_width, force=1.0, period=np.inf):
    """Traction on a bonded strip or under a flat punch, F/(pi sqrt(a^2 - x^2)), 0 outside (Johnson 1985); periodic:
    F cos(pi x/L)/(L sqrt(sin^2(pi a/L) - sin^2(pi x/L))) (Tada, Paris & Irwin 2000)."""
    _angle(half_width, period)
    return force / np.pi * np.cos(np.pi * np.asarray(x) / period) * _reciprocal_depth(x, half_width, period)


def ligament_stiffness(half_width, period):
    """Force per displacement of the mean surface, pi/(2 ln(1/sin(pi a/L))), normal or tangential, for a > 0."""
    _positive(half_width=half_width)
    return -np.pi / (2 * np.log(np.sin(_cell_angle(half_width, period))))


# ---- adhesive line contact, short-range adhesion

def jkr_line_load(half_width, period=np.inf, work_of_adhesion=1.0):
    """JKR load of a cylinder, `hertz_line_load` - `ligament_force`: W = pi a^2/4 - sqrt(2 pi a w) (Barquins 1988)."""
    return hertz_line_load(half_width, period) - ligament_force(half_width, period, work_of_adhesion)


def jkr_line_pressure(x, half_width, period=np.inf, work_of_adhesion=1.0):
    """JKR pressure of a cylinder, sqrt(a^2 - x^2)/2 - sqrt(2 w/(pi a))/sqrt(1 - x^2/a^2) (Barquins 1988) or its
    periodic form, 0 outside: tension without bound towards the edge."""
    force = ligament_force(half_width, period, work_of_adhesion)
    return hertz_line_pressure(x, half_width, period) - ligament_traction(x, half_width, force, period)


def jkr_line_approach(half_width, period, work_of_adhesion=1.0):
    """JKR approach of the mean surface, d = d_Hertz - (2/pi) F ln(1/sin(pi a/L)), F = `ligament_force`: the periodic
    cell in the limit of a short range of adhesion (normal Maugis parameter to infinity)."""
    force = ligament_force(half_width, period, work_of_adhesion)
    return hertz_line_approach(half_width, period) + 2 / np.pi * xlogy(force, np.sin(_angle(half_width, period)))


def _load_extrema(power, value, period):
    """Half widths of least and largest load, both roots of sin^3 t cos^power t = value, t = pi a/L."""
    if value == 0:
        return 0.0, period / 2 * (1 - 1e-7)

    def excess(t):
        return np.sin(t) ** 3 * np.cos(t) ** power - value

    peak, message = np.arctan(np.sqrt(3 / power)), f"no partial contact is stable at any load, period {period}"
    return [period / np.pi * _root(excess, *bracket, message) for bracket in ((0.0, peak), (peak, np.pi / 2))]


def _jkr_extrema(period, work_of_adhesion):
    _positive(period=period)
    _not_negative(work_of_adhesion=work_of_adhesion)
    if np.isinf(period):
        return np.cbrt(2 * work_of_adhesion / np.pi), np.inf
    return _load_extrema(1, 2 * np.pi**2 * work_of_adhesion / period**3, period)


def jkr_line_pull_off(period=np.inf, work_of_adhesion=1.0):
    """(half_width, load) at pull-off under a prescribed load, dW/da = 0: a = (2w/pi)^(1/3), W = -3 pi a^2/4 (Barquins
    1988); periodic: sin^3 t cos t = 2 pi^2 w/L^3, t = pi a/L < pi/3."""
    half_width = _jkr_extrema(period, work_of_adhesion)[0]
    return half_width, jkr_line_load(half_width, period, work_of_adhesion)


def jkr_line_half_width(load, period=np.inf, work_of_adhesion=1.0):
    """Half width of a JKR cylinder that is stable at a load. ValueError below pull-off and, in a periodic cell, above
    the load at which the contact jumps to the full period."""
    smallest, largest = _jkr_extrema(period, work_of_adhesion)
    if np.isinf(period):  # Hertz's width plus JKR's at no load exceeds the width at this load
        largest = hertz_line_half_width(max(load, 0.0)) + np.cbrt(32 * work_of_adhesion / np.pi)
    return _root(lambda a: jkr_line_load(a, period, work_of_adhesion) - load, smallest, largest,
                 f"no stable partial JKR contact at the load {load}")


def jkr_line_fold(period, work_of_adhesion=1.0):
    """(half_width, approach, load) at pull-off under a prescribed approach of the mean surface: dd/da = 0 of
    `jkr_line_approach`."""
    def slope(a):  # (pi/2) dd/da
        t, force = _cell_angle(a, period), ligament_force(a, period, work_of_adhesion)
        hertz, release = period / 2 * np.tan(t), np.pi * work_of_adhesion / np.cos(t) ** 2 / force  # dW/da, dF/da
        return np.log(np.sin(t)) * (release - hertz) + force * np.pi / period / np.tan(t)

    _positive(work_of_adhesion=work_of_adhesion)
    smallest = 1e-6 * min(period, np.cbrt(work_of_adhesion))
    a = _root(slope, smallest, period / 2 * (1 - 1e-6), f"no fold under a prescribed approach at the period {period}")
    return a, jkr_line_approach(a, period, work_of_adhesion), jkr_line_load(a, period, work_of_adhesion)


def jkr_line_half_width_at_approach(approach, period, work_of_adhesion=1.0):
    """Half width of a periodic JKR cylinder that is stable at an approach of the mean surface, between the fold and
    L^2/24, where the contact fills the cell."""
    smallest = jkr_line_fold(period, work_of_adhesion)[0]
    return _root(lambda a: jkr_line_approach(a, period, work_of_adhesion) - approach, smallest,
                 period / 2 * (1 - 1e-7), f"no stable partial JKR contact at the approach {approach}")


# ---- sinusoid

def sinusoid_load(half_width, period, amplitude, work_of_adhesion=1.0):
    """Load per period on the wave A(1 - cos 2 pi x/L), W = pi A sin^2(pi a/L) - sqrt(2 L tan(pi a/L) w) (Westergaard
    1939; adhesive: Johnson 1995). Full contact needs W = pi A without adhesion."""
    _positive(amplitude=amplitude)
    smooth = np.pi * amplitude * np.sin(_cell_angle(half_width, period)) ** 2
    return smooth - ligament_force(half_width, period, work_of_adhesion)


def sinusoid_pressure(x, half_width, period, amplitude, work_of_adhesion=1.0):
    """Pressure on the wave of `sinusoid_load`, (2 pi A/L) cos(pi x/L) sqrt(sin^2(pi a/L) - sin^2(pi x/L)) minus the
    ligament's traction (Westergaard 1939; Johnson 1995)."""
    _positive(amplitude=amplitude)
    force = ligament_force(half_width, period, work_of_adhesion)
    depth = np.pi / period * _root_depth(x, half_width, period)
    smooth = 2 * np.pi * amplitude / period * np.cos(np.pi * np.asarray(x) / period) * depth
    return smooth - ligament_traction(x, half_width, force, period)


def sinusoid_approach(half_width, period, amplitude, work_of_adhesion=1.0):
    """Approach of the mean surface to the wave of `sinusoid_load`, A s^2 (1 - 2 ln s) - (2/pi) F ln(1/s) with
    s = sin(pi a/L), by the sum of flat punches; A at full contact."""
    _positive(amplitude=amplitude)
    s, force = np.sin(_cell_angle(half_width, period)), ligament_force(half_width, period, work_of_adhesion)
    return amplitude * (s**2 - xlogy(2 * s**2, s)) + 2 / np.pi * xlogy(force, s)


def sinusoid_half_width(load, period, amplitude, work_of_adhesion=1.0):
    """Half width on the wave of `sinusoid_load` that is stable at a load, between pull-off and the jump to full
    contact, both at sin^3 t cos^5 t = w L/(8 pi^2 A^2), t = pi a/L (Johnson 1995)."""
    _require(0 < period < np.inf, f"period {period} must be positive and finite")
    _positive(amplitude=amplitude)
    _not_negative(work_of_adhesion=work_of_adhesion)
    extrema = _load_extrema(5, work_of_adhesion * period / (8 * np.pi**2 * amplitude**2), period)
    return _root(lambda a: sinusoid_load(a, period, amplitude, work_of_adhesion) - load, *extrema,
                 f"no stable partial contact with the wave at the load {load}")


# ---- line contact, finite range of adhesion

def _cohesive_tension(x, inner, outer, stress):
    """Uniform stress s on a < |x| < c, and (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)) within a, which stays closed."""
    _require(np.greater_equal(inner, 0) & np.less_equal(inner, outer),
             f"the inner edge {inner} of the zone must lie between 0 and its outer edge {outer}")
    share = 2 / np.pi * np.arctan2(np.sqrt((outer - inner) * (outer + inner)), _root_depth(x, inner))
    return stress * np.where(np.abs(x) < outer, share, 0.0)


def _cohesive_opening(spread, inner, stress):
    """Displacement at c relative to |x| < a under `_cohesive_tension`, (4 s a/pi)[sqrt(m^2-1) arcosh m - m ln m],
    m = c/a = cosh(spread)."""
    logarithm = np.log1p(2 * np.sinh(spread / 2) ** 2)
    return 4 * stress * inner / np.pi * (spread * np.sinh(spread) - np.cosh(spread) * logarithm)


def _maugis_line_state(log_spread, normal_maugis):
    """(load, a, c) for c/a = cosh(spread): the condition s h(c) = 1 is quadratic in a."""
    spread, stress = np.exp(log_spread), peak_normal_traction(normal_maugis)
    series = 2 / 3 * spread**3 * (1 + spread**2 / 5 + 2 * spread**4 / 105)
    parabola = series if spread < 0.02 else np.sinh(2 * spread) / 2 - spread  # m sqrt(m^2-1) - arcosh m
    linear = stress * _cohesive_opening(spread, 1.0, stress)
    a = 2 / (linear + np.sqrt(linear**2 + 2 * stress * parabola))
    return np.pi * a**2 / 4 - 2 * stress * a * np.sinh(spread), a, a * np.cosh(spread)


def _maugis_line_least(normal_maugis):
    return _minimum(lambda t: _maugis_line_state(t, normal_maugis)[0], _SMALLEST, np.log(40.0))


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
    spread = _root(lambda t: _maugis_line_state(t, normal_maugis)[0] - load, _SMALLEST, least,
                   f"no stable Maugis-Dugdale contact at the load {load}")
    return _maugis_line_state(spread, normal_maugis)[1:]


def maugis_line_pressure(x, contact_half_width, cohesive_half_width, normal_maugis):
    """Pressure of `maugis_line`, sqrt(a^2-x^2)/2 - (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-x^2)) within a, -s up to c."""
    tension = _cohesive_tension(x, contact_half_width, cohesive_half_width, peak_normal_traction(normal_maugis))
    return hertz_line_pressure(x, contact_half_width) - tension


def rigid_cylinder_load(gap, normal_maugis):
    """Load of a rigid parabola at a least gap h under the exponential law, W = -sqrt(2 pi lambda)(lambda h + 1/2)
    exp(-lambda h) (Bradley 1932 for a line): the limit of small normal Maugis parameters lambda."""
    _positive(normal_maugis=normal_maugis)
    ranges = normal_maugis * np.asarray(gap)
    return -np.sqrt(2 * np.pi * normal_maugis) * (ranges + 0.5) * np.exp(-ranges)


def rigid_cylinder_pull_off(normal_maugis):
    """(gap, load) of least load of `rigid_cylinder_load`: lambda h = 1/2, W = -sqrt(2 pi lambda/e)."""
    _positive(normal_maugis=normal_maugis)
    return 0.5 / normal_maugis, -np.sqrt(2 * np.pi * normal_maugis * np.exp(-1.0))


# ---- tangential loading of line contacts

def slip_zone_force(half_width, stick_half_width, strength):
    """Tangential force 2 tau sqrt(a^2 - s^2) on a contact that sticks at |x| < s and slips at the traction tau beyond
    (Dugdale's zone in shear, isolated): a law that stays at its peak, for large tangential Maugis parameters."""
    _positive(strength=strength)
    _require(np.greater_equal(stick_half_width, 0) & np.less_equal(stick_half_width, half_width),
             f"stick_half_width {stick_half_width} must lie between 0 and half_width {half_width}")
    return 2 * strength * _root_depth(stick_half_width, half_width)


def slip_zone_traction(x, half_width, stick_half_width, strength):
    """Traction of `slip_zone_force`, tau on s < |x| < a, (2 tau/pi) arctan sqrt((a^2-s^2)/(s^2-x^2)) within s."""
    return _cohesive_tension(x, stick_half_width, half_width, strength)


def slip_zone_edge_slip(half_width, stick_half_width, strength):
    """Slip at the edge of the contact of `slip_zone_force`, (4 tau s/pi)[sqrt(m^2-1) arcosh m - m ln m], m = a/s."""
    _positive(stick_half_width=stick_half_width, strength=strength)
    _require(np.less_equal(stick_half_width, half_width), f"stick_half_width {stick_half_width} exceeds {half_width}")
    return _cohesive_opening(np.arccosh(half_width / stick_half_width), stick_half_width, strength)


def cattaneo_line_stick_half_width(half_width, tangential_force, friction, period=np.inf):
    """Half width s of the stick zone of a Hertzian cylinder with Coulomb friction f (ratio of scaled tractions), from
    Q = f [W(a) - W(s)]: s/a = sqrt(1 - Q/fW) (Cattaneo 1938; periodic by the superposition of Ciavarella 1998)."""
    load = hertz_line_load(half_width, period)
    _positive(friction=friction)
    _require(np.greater_equal(tangential_force, 0) & np.less_equal(tangential_force, friction * load),
             f"tangential_force {tangential_force} must lie between 0 and friction times load, {friction * load}")
    return hertz_line_half_width(np.maximum(load - tangential_force / friction, 0.0), period)


def cattaneo_line_traction(x, half_width, stick_half_width, friction, period=np.inf):
    """Tangential traction f [p(x; a) - p(x; s)], p the Hertzian pressure of each half width (Cattaneo 1938)."""
    outer, inner = (hertz_line_pressure(x, edge, period) for edge in (half_width, stick_half_width))
    return friction * (outer - inner)


def cattaneo_line_displacement(half_width, stick_half_width, friction, period):
    """Mean tangential displacement of the surface relative to the stick zone, f [d(a) - d(s)], d Hertz's approach."""
    return friction * (hertz_line_approach(half_width, period) - hertz_line_approach(stick_half_width, period))


def uniform_slip_force(half_width, slip, tangential_maugis, residual_friction=1.0):
    """Tangential force 2 a tau for a tangential Maugis parameter lambda_t << 1, where the slip is uniform (leading
    order; the contact shrinks, so that the true maximum is a few per cent below 2 a tau_max). Modified law,
    b = lambda_t slip: tau = 2 lambda_t b exp(-b^2) up to b = 1/sqrt 2, then tau_max [r + (1-r) exp(-(b - 1/sqrt 2)^2)]."""
    _require(0 <= residual_friction <= 1, f"residual_friction {residual_friction} must lie between 0 and 1")
    b, b_peak = tangential_maugis * np.abs(slip), np.sqrt(0.5)
    level = residual_friction + (1 - residual_friction) * np.exp(-((b - b_peak) ** 2))
    rising, beyond = 2 * tangential_maugis * b * np.exp(-(b**2)), peak_tangential_traction(tangential_maugis) * level
    return 2 * half_width * np.where(b <= b_peak, rising, beyond) * np.sign(slip)


def drive_stiffness(period, height, poisson=0.5):
    """Force per tangential displacement of the top at a held surface, L k_0t = L (1 - nu)/(2 H), the layer's
    simple shear."""
    _positive(period=period, height=height)
    _require(np.isfinite(period), "the force per cell needs a finite period")
    _require(0 <= poisson <= 0.5, f"poisson {poisson} must lie between 0 and 0.5")
    return period * (1 - poisson) / (2 * height)


def driven_displacement(mean_slip, tangential_force, period, height, poisson=0.5):
    """Tangential displacement of the top, U = mean u_t + T/(L k_0t). The path (mean u_t, T) is the same for any
    height; sliding starts with a jump where dT/d(mean u_t) < -`drive_stiffness`. After gross sliding T is constant."""
    return mean_slip + tangential_force / drive_stiffness(period, height, poisson)


# ---- mixed mode

def mixed_mode_toughness(phase_angle, mode_parameter):
    """Toughness G_c/phi_n = 1 + tan^2[(1 - m) psi], tan psi = K_II/K_I, |psi| <= pi/2 (Hutchinson & Suo 1992): m = 1
    is Griffith's criterion, for m = 0 mode II does not matter."""
    _require(np.less_equal(np.abs(phase_angle), np.pi / 2), f"phase_angle {phase_angle} must lie within +-pi/2")
    _require(0 <= mode_parameter <= 1, f"mode_parameter {mode_parameter} must lie between 0 and 1")
    return 1 / np.cos((1 - mode_parameter) * np.asarray(phase_angle)) ** 2


def mixed_mode_line(half_width, phase_angle, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(load, tangential_force) of a bonded adhesive cylinder at the equilibrium K_I^2 + K_II^2 = 2 G_c(psi) of its edge,
    W = W_Hertz - B cos psi, T = B sin psi/sqrt(phi_t/phi_n), B = ligament force times sqrt(G_c). The unit of T carries
    sqrt(phi_t/phi_n), hence `work_ratio` phi_t/phi_n. Nothing slips; a cohesive law follows this at best in quality."""
    _positive(work_ratio=work_ratio)
    bond = ligament_force(half_width, period) * np.sqrt(mixed_mode_toughness(phase_angle, mode_parameter))
    load = hertz_line_load(half_width, period) - bond * np.cos(phase_angle)
    return load, bond * np.sin(phase_angle) / np.sqrt(work_ratio)


def savkoor_briggs_line_load(half_width, tangential_force, work_ratio=1.0, period=np.inf):
    """Load of `mixed_mode_line` for m = 1, W = W_Hertz - sqrt(2 L tan(pi a/L) - (phi_t/phi_n) T^2), isolated pi a^2/4
    - sqrt(2 pi a - (phi_t/phi_n) T^2) (Savkoor & Briggs 1977, for a line)."""
    _positive(work_ratio=work_ratio)
    remaining = ligament_force(half_width, period) ** 2 - work_ratio * np.square(tangential_force)
    _require(remaining >= 0, f"tangential_force {tangential_force} exceeds the strength of the half_width {half_width}")
    return hertz_line_load(half_width, period) - np.sqrt(remaining)


def _mixed_mode_force(half_width, load, mode_parameter, work_ratio, period):
    """Tangential force that holds `half_width` at `load`: cos psi = share cos((1-m) psi), share = (W_Hertz - W)/F."""
    share = np.clip((hertz_line_load(half_width, period) - load) / ligament_force(half_width, period), 0, 1)
    rest = 1 - mode_parameter  # solved for pi/2 - psi, so that the signs at the ends survive rounding
    angle = brentq(lambda t: np.sin(t) - share * np.sin(np.pi / 2 * mode_parameter + rest * t), 0, np.pi / 2)
    return mixed_mode_line(half_width, np.pi / 2 - angle, mode_parameter, work_ratio, period)[1]


def mixed_mode_line_strength(load, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(half_width, tangential_force) of `mixed_mode_line` at the largest tangential force a load allows, 0 < m <= 1,
    beyond which the bond breaks; for m < 1 and under compression the width may then be down to Hertz's."""
    _require(0 < mode_parameter <= 1, f"mode_parameter {mode_parameter} must be above 0 and at most 1")
    largest = jkr_line_half_width(load, period)
    if load >= 0:
        smallest = max(hertz_line_half_width(load, period), 1e-9)
    else:  # the unstable equilibrium without shear
        ends = load**2 / (8 * np.pi), jkr_line_pull_off(period)[0]
        smallest = brentq(lambda a: jkr_line_load(a, period) - load, *ends)

    def force(a):
        return _mixed_mode_force(a, load, mode_parameter, work_ratio, period)

    weakest = max(smallest, _minimum(lambda a: -force(a), smallest, largest), key=force)
    return weakest, force(weakest)


def mixed_mode_line_half_width(load, tangential_force, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """Half width of `mixed_mode_line`, stable at a load and a tangential force up to `mixed_mode_line_strength`."""
    smallest, strength = mixed_mode_line_strength(load, mode_parameter, work_ratio, period)
    largest = jkr_line_half_width(load, period)

    def excess(a):
        return _mixed_mode_force(a, load, mode_parameter, work_ratio, period) - abs(tangential_force)

    if excess(largest) >= 0:  # a force within rounding of none
        return largest
    return _root(excess, smallest, largest, f"tangential_force {tangential_force} exceeds the strength {strength}")


# ---- works and peaks of the traction-separation laws

def peak_normal_traction(normal_maugis):
    """Largest attraction of both laws, lambda_n/e at the gap delta_n."""
    _positive(normal_maugis=normal_maugis)
    return normal_maugis * np.exp(-1.0)


def peak_tangential_traction(tangential_maugis):
    """Largest tangential traction of both laws at no gap, sqrt(2/e) lambda_t at the slip delta_t/sqrt 2."""
    _positive(tangential_maugis=tangential_maugis)
    return np.sqrt(2 * np.exp(-1.0)) * tangential_maugis


def normal_work(ranges):
    """Work of opening without slip to a gap of `ranges` delta_n, 1 - (1 + a) exp(-a) in phi_n, of both laws."""
    _not_negative(ranges=ranges)
    return 1 - (1 + ranges) * np.exp(-ranges)


def mcgarry_proportional_work(mixity):
    """(normal, tangential) works in phi_n, phi_t of separating along g_t/delta_t = c g_n/delta_n by the law of McGarry
    et al. (2014), c = `mixity` > 0: W_t = 1 - (sqrt(pi)/2c) exp(1/4c^2) erfc(1/2c), W_n = W_t/(2 c^2)."""
    _positive(mixity=mixity)
    c = np.asarray(mixity, float)
    series = 2 * c**2 * (1 - 6 * c**2)  # the difference from 1 cancels for small c
    tangential = np.where(c < 1e-3, series, 1 - np.sqrt(np.pi) / (2 * c) * erfcx(1 / (2 * c)))
    return tangential / (2 * c**2), tangential


def mcgarry_sequential_work(normal_ranges=None, tangential_ranges=None):
    """(normal, tangential) works by the law of McGarry et al. (2014) on a broken path: either opening to a =
    `normal_ranges`, then sliding off, 1 - (1+a) exp(-a) and exp(-a); or sliding to b = `tangential_ranges`, then
    opening, exp(-b^2) and 1 - exp(-b^2)."""
    _require((normal_ranges is None) != (tangential_ranges is None), "give normal_ranges or tangential_ranges")
    if tangential_ranges is None:
        return normal_work(normal_ranges), np.exp(-normal_ranges)
    return np.exp(-np.square(tangential_ranges)), -np.expm1(-np.square(tangential_ranges))


def modified_tangential_work(residual_friction):
    """Tangential work of the modified law at no gap, in phi_t: (up to the peak, excess over the residual traction beyond
    it), 1 - exp(-1/2) and sqrt(pi/2) exp(-1/2) (1 - tau_inf/tau_max); 1.1536 in all without residual friction, not 1."""
    _not_negative(residual_friction=residual_friction)
    return 1 - np.exp(-0.5), np.sqrt(np.pi / 2) * np.exp(-0.5) * (1 - residual_friction)


# ---- spheres

def hertz_sphere(contact_radius, contact_modulus=1.0, radius=1.0):
    """(load, approach) without adhesion, P = 4 E* a^3/(3 R), delta = a^2/R (Johnson 1985)."""
    _positive(contact_modulus=contact_modulus, radius=radius)
    _not_negative(contact_radius=contact_radius)
    return 4 * contact_modulus * np.power(contact_radius, 3.0) / (3 * radius), np.square(contact_radius) / radius


def hertz_sphere_radius(load, contact_modulus=1.0, radius=1.0):
    """Contact radius without adhesion at a load >= 0, a^3 = 3 P R/(4 E*) (Johnson 1985)."""
    _positive(contact_modulus=contact_modulus, radius=radius)
    _not_negative(load=load)
    return np.cbrt(3 * load * radius / (4 * contact_modulus))


def hertz_sphere_pressure(r, contact_radius, contact_modulus=1.0, radius=1.0):
    """Pressure (2 E*/(pi R)) sqrt(a^2 - r^2), 0 outside (Johnson 1985)."""
    _positive(contact_radius=contact_radius, contact_modulus=contact_modulus, radius=radius)
    return 2 * contact_modulus / (np.pi * radius) * _root_depth(r, contact_radius)


def jkr_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3), delta = a^2/R - sqrt(2 pi w a/E*) (Johnson, Kendall
    & Roberts 1971): short-range adhesion, a compliant body."""
    _positive(work_of_adhesion=work_of_adhesion)
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    force = np.sqrt(8 * np.pi * work_of_adhesion * contact_modulus * np.power(contact_radius, 3.0))
    return load - force, approach - np.sqrt(2 * np.pi * work_of_adhesion * contact_radius / contact_modulus)


def jkr_sphere_pressure(r, contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Pressure of `jkr_sphere`, Hertz's minus sqrt(2 w E*/(pi a))/sqrt(1 - r^2/a^2), 0 outside (Maugis 1992)."""
    _positive(work_of_adhesion=work_of_adhesion)
    smooth = hertz_sphere_pressure(r, contact_radius, contact_modulus, radius)
    intensity = np.sqrt(2 * work_of_adhesion * contact_modulus * contact_radius / np.pi)
    return smooth - intensity * _reciprocal_depth(r, contact_radius)


def jkr_sphere_radius(load, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `jkr_sphere` that is stable at a load >= -3 pi w R/2 (Johnson, Kendall & Roberts 1971)."""
    return savkoor_briggs_sphere_radius(load, 0.0, 0.5, work_of_adhesion, contact_modulus, radius)


def jkr_sphere_pull_off(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, load) at pull-off under a prescribed load, P = -3 pi w R/2 at a^3 = 9 pi w R^2/(8 E*)."""
    _positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    return np.cbrt(9 * force * radius / (8 * contact_modulus)), -1.5 * force


def jkr_sphere_fold(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, approach, load) at pull-off under a prescribed approach, delta = -3 a^2/R, P = -5 pi w R/6 at
    a^3 = pi w R^2/(8 E*)."""
    _positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    a = np.cbrt(force * radius / (8 * contact_modulus))
    return a, -3 * a**2 / radius, -5 / 6 * force


def dmt_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - 2 pi w R, delta = a^2/R (Derjaguin, Muller & Toporov 1975): long-range
    adhesion, a stiff body."""
    _positive(work_of_adhesion=work_of_adhesion)
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    return load - 2 * np.pi * work_of_adhesion * radius, approach


def _maugis_sphere_units(cohesive_stress, work_of_adhesion, contact_modulus, radius):
    """(Maugis parameter, units of load, length, approach), with K = 4 E*/3."""
    _positive(cohesive_stress=cohesive_stress, work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus,
              radius=radius)
    force = np.pi * work_of_adhesion * radius
    length = np.cbrt(force * radius / (4 * contact_modulus / 3))
    return 2 * cohesive_stress * length**2 / force, force, length, length**2 / radius


def _maugis_sphere_state(log_angle, maugis):
    """(load, a, c, approach) in Maugis's units for c/a = 1/cos(angle): the energy condition is quadratic in a."""
    angle = np.exp(log_angle)
    tangent, secant = np.tan(angle), 1 / np.cos(angle)
    square = maugis * (secant * angle) ** 2 * spherical_jn(1, 2 * angle)  # (lambda/2)[t + (m^2-2) arctan t]
    linear = 4 / 3 * maugis**2 * (angle * tangent - 2 * np.sin(angle / 2) ** 2 * secant)
    a = 2 / (linear + np.sqrt(linear**2 + 4 * square))
    return a**3 - maugis * a**2 * (tangent + secant**2 * angle), a, a * secant, a**2 - 4 / 3 * maugis * a * tangent


def _maugis_sphere_least(maugis):
    return _minimum(lambda t: _maugis_sphere_state(t, maugis)[0], _SMALLEST, np.log(np.pi / 2 - 1e-9))


def maugis_sphere_pull_off(cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, a, c, approach) of least load of `maugis_sphere`; a vanishes towards the DMT limit."""
    maugis, force, length, depth = _maugis_sphere_units(cohesive_stress, work_of_adhesion, contact_modulus, radius)
    load, a, c, approach = _maugis_sphere_state(_maugis_sphere_least(maugis), maugis)
    return load * force, a * length, c * length, approach * depth


def maugis_sphere(load, cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(a, c, approach) of a Maugis-Dugdale sphere at a load: contact r < a, uniform tension s on a < r < c, s h(c) = w
    (Maugis 1992). With K = 4 E*/3, lambda = 2 s (R/(pi w K^2))^(1/3), A = a (K/(pi w R^2))^(1/3), t^2 = m^2 - 1, m = c/a:
    1 = (lambda A^2/2)[t + (m^2-2) arctan t] + (4 lambda^2 A/3)[t arctan t - m + 1],
    P/(pi w R) = A^3 - lambda A^2 [t + m^2 arctan t], delta (K^2/(pi^2 w^2 R))^(1/3) = A^2 - (4/3) lambda A t.
    For the exponential law s = phi_n/(e delta_n). ValueError below pull-off."""
    maugis, force, length, depth = _maugis_sphere_units(cohesive_stress, work_of_adhesion, contact_modulus, radius)
    least = _maugis_sphere_least(maugis)
    log_angle = _root(lambda t: _maugis_sphere_state(t, maugis)[0] - load / force, _SMALLEST, least,
                      f"no stable Maugis-Dugdale contact at the load {load}")
    _, a, c, approach = _maugis_sphere_state(log_angle, maugis)
    return a * length, c * length, approach * depth


def maugis_sphere_pressure(r, contact_radius, cohesive_radius, cohesive_stress, contact_modulus=1.0, radius=1.0):
    """Pressure of `maugis_sphere`, Hertz's minus (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-r^2)) within a, -s up to c."""
    tension = _cohesive_tension(r, contact_radius, cohesive_radius, cohesive_stress)
    return hertz_sphere_pressure(r, contact_radius, contact_modulus, radius) - tension


def bonded_circle_stiffness(contact_radius, poisson=0.5, contact_modulus=1.0):
    """Tangential force per displacement of a sticking circle, 8 a G*, G* = mu/(2 - nu) = E* (1-nu)/(2 (2-nu)) for one
    body of Poisson ratio nu on a rigid counterface (Mindlin 1949)."""
    _positive(contact_radius=contact_radius, contact_modulus=contact_modulus)
    _require(0 <= poisson <= 0.5, f"poisson {poisson} must lie between 0 and 0.5")
    return 8 * contact_radius * contact_modulus * (1 - poisson) / (2 * (2 - poisson))


def cattaneo_sphere(load, tangential_force, friction, poisson=0.5, contact_modulus=1.0, radius=1.0):
    """(stick radius, displacement) of a Hertzian sphere with Coulomb friction f, s^3/a^3 = 1 - Q/(f P),
    delta_t = (3 f P/(16 a G*))[1 - (1 - Q/(f P))^(2/3)] (Cattaneo 1938; Mindlin 1949), G* of `bonded_circle_stiffness`.
    Slip across the force (unless nu = 0) and normal-tangential coupling (unless nu = 1/2) are neglected: expect
    differences of a few per cent."""
    _positive(load=load, friction=friction)
    a, stick = hertz_sphere_radius(load, contact_modulus, radius), 1 - tangential_force / (friction * load)
    _require(np.greater_equal(stick, 0) & np.less_equal(stick, 1),
             f"tangential_force {tangential_force} must lie between 0 and friction times load, {friction * load}")
    sliding = 1.5 * friction * load / bonded_circle_stiffness(a, poisson, contact_modulus)
    return a * np.cbrt(stick), sliding * (1 - np.cbrt(stick) ** 2)


def savkoor_briggs_sphere_radius(load, tangential_force, poisson=0.5, work_of_adhesion=1.0, contact_modulus=1.0,
                                 radius=1.0):
    """Radius of a bonded adhesive sphere that is stable at a load and a tangential force, from
    (4 E* a^3/(3R) - P)^2 = 8 pi w E* a^3 - E* Q^2/(4 G*), G* of `bonded_circle_stiffness` (Savkoor & Briggs 1977). The
    contact is taken to stay a circle, modes II and III averaged. ValueError beyond the strength, where
    9 (pi w R)^2 + 6 pi w R P < E* Q^2/(4 G*)."""
    _positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    ratio = 2 * contact_modulus / bonded_circle_stiffness(1.0, poisson, contact_modulus)  # E*/(4 G*)
    force = 3 * np.pi * work_of_adhesion * radius
    root = force**2 + 2 * force * load - ratio * np.square(tangential_force)
    _require(root >= 0, f"no equilibrium at the load {load} and tangential_force {tangential_force}")
    return hertz_sphere_radius(load + force + np.sqrt(root), contact_modulus, radius)
