"""Line contacts under shear that slip: zones of constant traction, fronts, slip of the whole
contact.

Two limits bound what the modified law does. A compliant interface (tangential Maugis parameter well
below 1) slips as a whole: the slip weakens adhesion everywhere alike, and the contact is a JKR
contact of less work of adhesion. A stiff one (1 and more) slips from its edge: a front of slip
moves inwards, behind which the traction is the residual friction, and sliding begins where the
front cannot advance at a growing force any more.

Derivation of the front: half width a, stick at |x| < s, traction tau_inf on s < |x| < a. The zone
of constant traction alone carries 2 tau_inf sqrt(a^2 - s^2) without a singularity at s
(`slip_zone_force`); what is added is a punch's traction on |x| < s with the intensity that the
front's work G asks for, sqrt(2 pi s G) (`ligament_force`). By the J-integral around the front G is
the work of the law in excess of tau_inf.
"""

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import gamma

from .checks import at_most, elementwise, not_negative, positive, require
from .laws import TANGENTIAL_PEAK, fading_work, peak_tangential_traction
from .line import hertz_line_half_width, jkr_line_half_width, ligament_force
from .zone import zone_force, zone_opening, zone_traction


def slip_zone_force(half_width, stick_half_width, strength, period=np.inf):
    """Tangential force 2 tau sqrt(a^2 - s^2) on a contact that sticks at |x| < s and slips at the
    traction tau beyond; periodic (2 tau L/pi) arccos(cos(pi a/L)/cos(pi s/L)), exact (Dugdale's
    zone in shear). Needs a traction that stays at tau however far the surface has slipped, and slip
    much beyond the range of the law in the zone: the modified law with full residual friction,
    stiff, and the half width a over which friction acts once adhesion has gone
    (`sliding_half_width`). At a given share of the force of gross sliding s is met within 1 % up to
    two thirds at a tangential Maugis parameter of 10, and 3 % at 3.6; at 1 it is wider by 15 %.

    Parameters
    ----------
    half_width, stick_half_width : float or array, a >= s, beta
    strength : float or array > 0, tau, E* beta/R sqrt(phi_t/phi_n)
    period : float, beta; `inf`: isolated
    """
    positive(strength=strength)
    return zone_force(stick_half_width, half_width, strength, period)


def slip_zone_traction(x, half_width, stick_half_width, strength, period=np.inf):
    """Traction of `slip_zone_force`, tau on s < |x| < a, (2 tau/pi) arctan
    sqrt((a^2-s^2)/(s^2-x^2)) within s or its periodic form; 0 outside; conditions as there.

    Parameters
    ----------
    x : float or array, beta
    half_width, stick_half_width, strength, period : as of `slip_zone_force`
    """
    positive(strength=strength)
    return zone_traction(x, stick_half_width, half_width, strength, period)


def slip_zone_edge_slip(half_width, stick_half_width, strength, period=np.inf):
    """Slip at the edge of the contact of `slip_zone_force`, (4 tau s/pi)[sqrt(m^2-1) arcosh m - m
    ln m], m = a/s, for s > 0; periodic by quadrature. The traction tau times it is the work that a
    law of this strength may have spent there.

    Parameters
    ----------
    half_width, stick_half_width, strength, period : as of `slip_zone_force`
    """
    positive(stick_half_width=stick_half_width, strength=strength)
    return zone_opening(stick_half_width, half_width, strength, period)


def front_force(half_width, stick_half_width, residual_traction, work, period=np.inf):
    """Tangential force 2 tau_inf sqrt(a^2 - s^2) + sqrt(2 pi s G) with the front of slip at s, or
    the same in a periodic cell (`slip_zone_force` + `ligament_force`); without residual traction
    and at s = a the brittle strength, without work the slip zone of constant traction. G >= 0 is
    the work of the law in excess of tau_inf (`front_work`). Holds where the front is short beside
    s, G/tau_max^2 << s: a tangential Maugis parameter of 1 and more.

    Parameters
    ----------
    half_width, stick_half_width, period : as of `slip_zone_force`
    residual_traction : float or array, tau_inf, E* beta/R sqrt(phi_t/phi_n)
    work : float or array, G, phi_t
    """
    not_negative(residual_traction=residual_traction, work=work)
    at_most(stick_half_width, half_width,
            f"stick_half_width {stick_half_width} exceeds half_width {half_width}")
    zone = slip_zone_force(half_width, stick_half_width, residual_traction,
                           period) if residual_traction else 0.0
    return zone + ligament_force(stick_half_width, period, work)


@elementwise
def front_onset(half_width, residual_traction, work, period=np.inf):
    """(stick_half_width, tangential_force) where `front_force` is largest: sliding begins there,
    with the middle of the contact still sticking; beyond, the front runs through under a prescribed
    force. The half width is that of a contact which has lost its adhesion (`sliding_half_width`).

    Conditions of `front_force`; the drive's stiffness, which lets the front go on a little, is left
    out. The force at onsets of the modified law with half residual friction is met within 0.3 % at
    a tangential Maugis parameter of 10 and 3 % at 1, for loads of 1 to 25 (that at which it slides,
    which at a held displacement is larger than before) and a normal Maugis parameter of 10.

    Parameters
    ----------
    half_width, residual_traction, work, period : as of `front_force`
    """
    positive(half_width=half_width)
    found = minimize_scalar(lambda s: -front_force(half_width, s, residual_traction, work, period),
                            bounds=(0.0, half_width), method="bounded",
                            options={"xatol": 1e-9 * half_width})
    return float(found.x), float(-found.fun)


def uniform_slip_force(half_width, slip, tangential_maugis, residual_friction=1.0):
    """Tangential force 2 a tau of a contact that slips as a whole. Modified law, b = lambda_t slip:
    tau = 2 lambda_t b exp(-b^2) up to b = 1/sqrt 2, then tau_max [r + (1-r) exp(-(b - 1/sqrt
    2)^2)]. Leading order for a tangential Maugis parameter lambda_t << 1, with the half width of
    the present state: 2 a tau_max of the width without shear is a few per cent above the true
    maximum.

    Parameters
    ----------
    half_width : float or array, beta
    slip : float or array, u_t,r
    tangential_maugis, residual_friction : float or array, lambda_t; r, 0 to 1
    """
    not_negative(half_width=half_width)
    require(np.greater_equal(residual_friction, 0) & np.less_equal(residual_friction, 1),
            f"residual_friction {residual_friction} must lie between 0 and 1")
    b = tangential_maugis * np.abs(slip)
    level = residual_friction + (1 - residual_friction) * np.exp(-((b - TANGENTIAL_PEAK) ** 2))
    rising = 2 * tangential_maugis * b * np.exp(-(b**2))
    beyond = peak_tangential_traction(tangential_maugis) * level
    return 2 * half_width * np.where(b <= TANGENTIAL_PEAK, rising, beyond) * np.sign(slip)


def uniform_slip_softening(half_width, tangential_maugis, residual_friction):
    """Steepest fall of `uniform_slip_force` with the slip, (4/e)(1 - r) a lambda_t^2 at b = sqrt 2,
    at a fixed half width; for tangential Maugis parameters well below 1 (to compare with
    `drive_stiffness`, by `drive_critical_height`).

    Parameters
    ----------
    half_width : float or array, beta
    tangential_maugis, residual_friction : as of `uniform_slip_force`
    """
    positive(half_width=half_width, tangential_maugis=tangential_maugis)
    not_negative(residual_friction=residual_friction)
    require(np.less_equal(residual_friction, 1),
            f"residual_friction {residual_friction} must not exceed 1")
    return 4 / np.e * half_width * np.square(tangential_maugis) * (1
                                                                   - np.asarray(residual_friction))


@elementwise
def uniform_slip_state(load, slip_ranges, tangential_maugis, residual_friction=1.0, period=np.inf,
                       residual_adhesion=0.0):
    """(half_width, tangential_force) of a contact that slips as a whole by b ranges delta_t, at a
    normal load.

    The half width is JKR's for the work of adhesion that is left (`fading_work`), the force 2 a
    tau(b) with the traction of the modified law (`uniform_slip_force`). For tangential Maugis
    parameters well below 1 and normal ones well above; the true contact is wider by the range of
    the law, and its rim, where the gap is open, carries less. ValueError where the contact has
    pulled off.

    Parameters
    ----------
    load : float or array, w_n,r
    slip_ranges : float or array, b, ranges of the law
    tangential_maugis, residual_friction : as of `uniform_slip_force`
    period : float, beta; `inf`: isolated
    residual_adhesion : float or array, 0 to 1, as of `fading_work`
    """
    half_width = jkr_line_half_width(load, period,
                                     float(fading_work(slip_ranges, residual_adhesion)))
    slip = slip_ranges / tangential_maugis
    return half_width, float(uniform_slip_force(half_width, slip, tangential_maugis,
                                                residual_friction))


@elementwise
def uniform_slip_onset(load, tangential_maugis, period=np.inf, residual_adhesion=0.0):
    """(half_width, tangential_force, slip_ranges) of the largest force of `uniform_slip_state`,
    where sliding begins under a prescribed force: at a slip below that of the law's peak, since the
    contact shrinks. Conditions as there, and loads of at least 0, below which the contact may pull
    off before it slides.

    Parameters
    ----------
    load, tangential_maugis, period, residual_adhesion : as of `uniform_slip_state`
    """
    require(load >= 0,
            f"the load {load} must not be negative: the contact may pull off before it slides")

    def missing(slip):
        return -uniform_slip_state(load, slip, tangential_maugis, 1.0, period, residual_adhesion)[1]

    slip = minimize_scalar(missing, bounds=(0.0, TANGENTIAL_PEAK), method="bounded",
                           options={"xatol": 1e-9}).x
    return (*uniform_slip_state(load, slip, tangential_maugis, 1.0, period, residual_adhesion),
            float(slip))


def sliding_half_width(load, normal_maugis=np.inf, period=np.inf):
    """Half width over which friction acts in gross sliding without adhesion, a + Gamma(5/3) [(2/3)
    lambda_n sqrt(2 a)]^(-2/3), a Hertz's: the integral of exp(-g/delta_n) over the gap g = (2/3)
    sqrt(2 a) s^(3/2) at a distance s from the edge is added, a being (L/pi) tan(pi a/L) there in a
    cell. Leading order in the range of the law: about 1 % too narrow at a normal Maugis parameter
    of 3, 0.1 % at 10, for loads of 1 and more; for loads above 0 and a law without adhesion at
    large slip.

    Parameters
    ----------
    load : float or array > 0, w_n,r
    normal_maugis : float or array > 0, dimensionless
    period : float, beta; `inf`: isolated
    """
    positive(load=load, normal_maugis=normal_maugis)
    half_width = hertz_line_half_width(load, period)
    edge = half_width if np.isinf(period) else period / np.pi * np.tan(np.pi * half_width / period)
    return half_width + gamma(5 / 3) * np.power(2 / 3 * normal_maugis * np.sqrt(2 * edge), -2 / 3)


def sliding_force(load, residual_traction, normal_maugis=np.inf, period=np.inf):
    """Tangential force 2 a tau_inf of gross sliding, a the `sliding_half_width`, whatever the
    tangential Maugis parameter and the drive: every point has slipped far beyond delta_t. For the
    modified law with residual friction; other conditions as there.

    Parameters
    ----------
    load, normal_maugis, period : as of `sliding_half_width`
    residual_traction : float or array > 0, tau_inf, E* beta/R sqrt(phi_t/phi_n)
    """
    positive(residual_traction=residual_traction)
    return 2 * residual_traction * sliding_half_width(load, normal_maugis, period)
