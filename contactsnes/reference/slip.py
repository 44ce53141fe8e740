"""Line contacts under shear that slip: zones of constant traction, Coulomb friction, slip of the whole contact, and the drive.

Two limits bound what the law does. A compliant interface (tangential Maugis parameter well below 1) slips as a whole: the slip
weakens adhesion everywhere alike, and the contact is a JKR contact of less work of adhesion. A stiff one (1 and more) slips from its
edge: a front of slip moves inwards, behind which the traction is the residual friction, and sliding begins where the front cannot
advance at a growing force any more.

Derivation of the front: half width a, stick at |x| < s, traction tau_inf on s < |x| < a. The zone of constant traction alone carries
2 tau_inf sqrt(a^2 - s^2) without a singularity at s (`slip_zone_force`); what is added is a punch's traction on |x| < s with
the intensity that the front's work G asks for, sqrt(2 pi s G) (`ligament_force`). By the J-integral around the front G is the
work of the law in excess of tau_inf.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from .checks import half_angle, positive, require, root_depth
from .cohesive import cohesive_opening, cohesive_tension
from .laws import fading_work, peak_tangential_traction
from .line import hertz_line_approach, hertz_line_half_width, hertz_line_load, hertz_line_pressure, jkr_line_half_width, ligament_force

_PEAK = np.sqrt(0.5)  # slip at the peak of the law, in ranges


def slip_zone_force(half_width, stick_half_width, strength, period=np.inf):
    """Tangential force 2 tau sqrt(a^2 - s^2) on a contact that sticks at |x| < s and slips at the traction tau beyond
    (Dugdale's zone in shear): a law that stays at its peak, for large tangential Maugis parameters. In a periodic cell
    (2 tau L/pi) arccos[cos(pi a/L)/cos(pi s/L)], since x -> tan(pi x/L) makes an isolated contact of the cell."""
    positive(strength=strength)
    require(np.greater_equal(stick_half_width, 0) & np.less_equal(stick_half_width, half_width),
            f"stick_half_width {stick_half_width} must lie between 0 and half_width {half_width}")
    if np.isinf(period):
        return 2 * strength * root_depth(stick_half_width, half_width)
    depth = np.pi / period * root_depth(stick_half_width, half_width, period)
    return 2 * strength * period / np.pi * np.arctan2(depth, np.cos(half_angle(half_width, period)))


def slip_zone_traction(x, half_width, stick_half_width, strength, period=np.inf):
    """Traction of `slip_zone_force`, tau on s < |x| < a, (2 tau/pi) arctan sqrt((a^2-s^2)/(s^2-x^2)) within s; in a
    periodic cell the same of tan(pi x/L)."""
    if np.isinf(period):
        return cohesive_tension(x, stick_half_width, half_width, strength)
    x, stick_half_width, half_width = (np.tan(np.pi * np.asarray(place) / period) for place in (x, stick_half_width, half_width))
    return cohesive_tension(x, stick_half_width, half_width, strength)


def slip_zone_edge_slip(half_width, stick_half_width, strength):
    """Slip at the edge of the contact of `slip_zone_force`, (4 tau s/pi)[sqrt(m^2-1) arcosh m - m ln m], m = a/s."""
    positive(stick_half_width=stick_half_width, strength=strength)
    require(np.less_equal(stick_half_width, half_width), f"stick_half_width {stick_half_width} exceeds {half_width}")
    return cohesive_opening(np.arccosh(half_width / stick_half_width), stick_half_width, strength)


def cattaneo_line_stick_half_width(half_width, tangential_force, friction, period=np.inf):
    """Half width s of the stick zone of a Hertzian cylinder with Coulomb friction f (ratio of scaled tractions), from
    Q = f [W(a) - W(s)]: s/a = sqrt(1 - Q/fW) (Cattaneo 1938; periodic by the superposition of Ciavarella 1998)."""
    load = hertz_line_load(half_width, period)
    positive(friction=friction)
    require(np.greater_equal(tangential_force, 0) & np.less_equal(tangential_force, friction * load),
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
    require(0 <= residual_friction <= 1, f"residual_friction {residual_friction} must lie between 0 and 1")
    b, b_peak = tangential_maugis * np.abs(slip), np.sqrt(0.5)
    level = residual_friction + (1 - residual_friction) * np.exp(-((b - b_peak) ** 2))
    rising, beyond = 2 * tangential_maugis * b * np.exp(-(b**2)), peak_tangential_traction(tangential_maugis) * level
    return 2 * half_width * np.where(b <= b_peak, rising, beyond) * np.sign(slip)


def drive_stiffness(period, height, poisson=0.5):
    """Force per tangential displacement of the top at a held surface, L k_0t = L (1 - nu)/(2 H), the layer's
    simple shear."""
    positive(period=period, height=height)
    require(np.isfinite(period), "the force per cell needs a finite period")
    require(0 <= poisson <= 0.5, f"poisson {poisson} must lie between 0 and 0.5")
    return period * (1 - poisson) / (2 * height)


def driven_displacement(mean_slip, tangential_force, period, height, poisson=0.5):
    """Tangential displacement of the top, U = mean u_t + T/(L k_0t). The path (mean u_t, T) is the same for any
    height; sliding starts with a jump where dT/d(mean u_t) < -`drive_stiffness`. After gross sliding T is constant."""
    return mean_slip + tangential_force / drive_stiffness(period, height, poisson)


def uniform_slip_state(load, slip_ranges, tangential_maugis, residual_friction=1.0, period=np.inf):
    """(half_width, tangential_force) of a contact that slips as a whole by b ranges delta_t, at a normal load.

    The half width is JKR's for the work of adhesion exp(-b^2), the force 2 a tau(b) with the traction of the modified law
    (`uniform_slip_force`). For tangential Maugis parameters well below 1 and normal ones well above; the true contact is
    wider by the range of the law, and its rim, where the gap is open, carries less.
    """
    half_width = jkr_line_half_width(load, period, float(fading_work(slip_ranges)))
    slip = slip_ranges / tangential_maugis
    return half_width, float(uniform_slip_force(half_width, slip, tangential_maugis, residual_friction))


def uniform_slip_onset(load, tangential_maugis, period=np.inf):
    """(half_width, tangential_force, slip_ranges) of the largest force of `uniform_slip_state`, where sliding begins under a prescribed
    force: at a slip below that of the law's peak, since the contact shrinks. For loads of at least 0."""
    def missing(slip):
        return -uniform_slip_state(load, slip, tangential_maugis, 1.0, period)[1]

    slip = minimize_scalar(missing, bounds=(0.0, _PEAK), method="bounded", options={"xatol": 1e-9}).x
    return (*uniform_slip_state(load, slip, tangential_maugis, 1.0, period), slip)


def front_force(half_width, stick_half_width, residual_traction, work, period=np.inf):
    """Tangential force 2 tau_inf sqrt(a^2 - s^2) + sqrt(2 pi s G) with the front at s, or the same in a periodic cell; without residual
    traction and at s = a the brittle strength, without work the slip zone of constant traction. ValueError for a negative work."""
    zone = slip_zone_force(half_width, stick_half_width, residual_traction, period) if residual_traction else 0.0
    return zone + ligament_force(stick_half_width, period, work)


def front_onset(half_width, residual_traction, work, period=np.inf):
    """(stick_half_width, tangential_force) where `front_force` is largest: sliding begins there, with the middle of the contact still
    sticking; beyond, the front runs through under a prescribed force. The half width is that of a contact which has lost its adhesion.

    Holds where the front is short beside s, G/tau_max^2 << s; the drive's stiffness, which lets the front go on a little, is left out.
    """
    found = minimize_scalar(lambda s: -front_force(half_width, s, residual_traction, work, period), bounds=(0.0, half_width),
                            method="bounded", options={"xatol": 1e-9 * half_width})
    return found.x, -found.fun
