"""Analytic estimates of sheared adhesive line contacts under the modified cohesive law: units and arguments as in `reference`.

Two limits bound what the law does. A compliant interface (tangential Maugis parameter well below 1) slips as a whole: the slip
weakens adhesion everywhere alike, and the contact is a JKR contact of less work of adhesion. A stiff one (1 and more) slips from its
edge: a front of slip moves inwards, behind which the traction is the residual friction, and sliding begins where the front cannot
advance at a growing force any more.

Derivation of the front: half width a, stick at |x| < s, traction tau_inf on s < |x| < a. The zone of constant traction alone carries
2 tau_inf sqrt(a^2 - s^2) without a singularity at s (`reference.slip_zone_force`); what is added is a punch's traction on |x| < s with
the intensity that the front's work G asks for, sqrt(2 pi s G) (`reference.ligament_force`). By the J-integral around the front G is the
work of the law in excess of tau_inf.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from . import reference

_PEAK = np.sqrt(0.5)  # slip at the peak of the law, in ranges


def fading_work(slip_ranges):
    """Work of adhesion that is left at a slip of b ranges delta_t, w/phi_n = exp(-b^2), by both laws (eqs. 3a and 5a)."""
    return np.exp(-np.square(slip_ranges))


def uniform_slip_state(load, slip_ranges, tangential_maugis, residual_friction=1.0, period=np.inf):
    """(half_width, tangential_force) of a contact that slips as a whole by b ranges delta_t, at a normal load.

    The half width is JKR's for the work of adhesion exp(-b^2), the force 2 a tau(b) with the traction of the modified law
    (`reference.uniform_slip_force`). For tangential Maugis parameters well below 1 and normal ones well above; the true contact is
    wider by the range of the law, and its rim, where the gap is open, carries less.
    """
    half_width = reference.jkr_line_half_width(load, period, float(fading_work(slip_ranges)))
    slip = slip_ranges / tangential_maugis
    return half_width, float(reference.uniform_slip_force(half_width, slip, tangential_maugis, residual_friction))


def uniform_slip_onset(load, tangential_maugis, period=np.inf):
    """(half_width, tangential_force, slip_ranges) of the largest force of `uniform_slip_state`, where sliding begins under a prescribed
    force: at a slip below that of the law's peak, since the contact shrinks. For loads of at least 0."""
    def missing(slip):
        return -uniform_slip_state(load, slip, tangential_maugis, 1.0, period)[1]

    slip = minimize_scalar(missing, bounds=(0.0, _PEAK), method="bounded", options={"xatol": 1e-9}).x
    return (*uniform_slip_state(load, slip, tangential_maugis, 1.0, period), slip)


def front_work(residual_friction):
    """Work of slip in excess of the residual friction r = tau_inf/tau_max, G/phi_t at no gap: the integral of tau - tau_inf over the slip,
    1 - exp(-1/2) - r exp(-1/2) + sqrt(pi/2) exp(-1/2) (1 - r). Negative for r above 0.82, where there is no front but a gradual slip."""
    rising, beyond = reference.modified_tangential_work(residual_friction)
    return rising - residual_friction * np.exp(-0.5) + beyond


def front_force(half_width, stick_half_width, residual_traction, work):
    """Tangential force 2 tau_inf sqrt(a^2 - s^2) + sqrt(2 pi s G) with the front at s, isolated; without residual traction and at s = a the
    brittle strength, without work the slip zone of constant traction. ValueError for a negative work."""
    zone = reference.slip_zone_force(half_width, stick_half_width, residual_traction) if residual_traction else 0.0
    return zone + reference.ligament_force(stick_half_width, work_of_adhesion=work)


def front_onset(half_width, residual_traction, work):
    """(stick_half_width, tangential_force) where `front_force` is largest: sliding begins there, with the middle of the contact still
    sticking; beyond, the front runs through under a prescribed force. The half width is that of a contact which has lost its adhesion.

    Holds where the front is short beside s, G/tau_max^2 << s; the drive's stiffness, which lets the front go on a little, is left out.
    """
    found = minimize_scalar(lambda s: -front_force(half_width, s, residual_traction, work), bounds=(0.0, half_width), method="bounded",
                            options={"xatol": 1e-9 * half_width})
    return found.x, -found.fun
