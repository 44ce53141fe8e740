"""Spheres under a normal load: Hertz, JKR, DMT and Maugis-Dugdale.

All take contact radii far below the sphere's radius. Maugis's parameter (`sphere_maugis_parameter`)
tells which of the adhesive ones applies: JKR's above about 5, DMT's below about 0.1 (Johnson &
Greenwood 1997), Maugis and Dugdale's at any; it is 0.415 times the normal Maugis parameter of a
scene with the exponential law.
"""

import numpy as np
from scipy.special import spherical_jn

from .checks import (
    at_most,
    elementwise,
    find_root,
    jkr_root,
    minimizer,
    not_negative,
    positive,
    reciprocal_depth,
    root_depth,
)
from .cohesive import SMALLEST
from .zone import zone_traction


def hertz_sphere(contact_radius, contact_modulus=1.0, radius=1.0):
    """(load, approach) without adhesion, P = 4 E* a^3/(3 R), delta = a^2/R (Johnson 1985), for a <<
    R."""
    positive(contact_modulus=contact_modulus, radius=radius)
    not_negative(contact_radius=contact_radius)
    return 4 * contact_modulus * np.power(contact_radius,
                                          3.0) / (3 * radius), np.square(contact_radius) / radius


def hertz_sphere_radius(load, contact_modulus=1.0, radius=1.0):
    """Contact radius without adhesion at a load >= 0, a^3 = 3 P R/(4 E*) (Johnson 1985), for a <<
    R."""
    positive(contact_modulus=contact_modulus, radius=radius)
    not_negative(load=load)
    return np.cbrt(3 * load * radius / (4 * contact_modulus))


def hertz_sphere_pressure(r, contact_radius, contact_modulus=1.0, radius=1.0):
    """Pressure (2 E*/(pi R)) sqrt(a^2 - r^2), 0 outside (Johnson 1985), for a << R."""
    positive(contact_radius=contact_radius, contact_modulus=contact_modulus, radius=radius)
    return 2 * contact_modulus / (np.pi * radius) * root_depth(r, contact_radius)


def jkr_force(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0):
    """Force that breaks a bonded circle, sqrt(8 pi w E* a^3) (Kendall's flat punch): the adhesive
    part of JKR's load. For adhesion of a range that is short beside the circle."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus)
    not_negative(contact_radius=contact_radius)
    return np.sqrt(8 * np.pi * work_of_adhesion * contact_modulus) * np.power(contact_radius, 1.5)


def jkr_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3), delta = a^2/R - sqrt(2 pi w a/E*)
    (Johnson, Kendall & Roberts 1971): short-range adhesion, a compliant body, Maugis's parameter
    above about 5."""
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    force = jkr_force(contact_radius, work_of_adhesion, contact_modulus)
    return load - force, approach - np.sqrt(2 * np.pi * work_of_adhesion * contact_radius
                                            / contact_modulus)


def jkr_sphere_pressure(r, contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Pressure of `jkr_sphere`, Hertz's minus sqrt(2 w E*/(pi a))/sqrt(1 - r^2/a^2), 0 outside
    (Maugis 1992); conditions of `jkr_sphere`."""
    positive(work_of_adhesion=work_of_adhesion)
    smooth = hertz_sphere_pressure(r, contact_radius, contact_modulus, radius)
    intensity = np.sqrt(2 * work_of_adhesion * contact_modulus * contact_radius / np.pi)
    return smooth - intensity * reciprocal_depth(r, contact_radius)


def jkr_sphere_radius(load, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `jkr_sphere` that is stable at a load >= -3 pi w R/2 (Johnson, Kendall &
    Roberts 1971); conditions as there."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 3 * np.pi * work_of_adhesion * radius
    at_most(np.negative(load), force / 2, f"the load {load} is below pull-off, {-force / 2}")
    root = np.sqrt(force) * np.sqrt(np.maximum(force + 2 * load, 0))
    return hertz_sphere_radius(load + force + root, contact_modulus, radius)


@elementwise
def jkr_sphere_radius_at_approach(approach, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `jkr_sphere` that is stable at an approach, from that of `jkr_sphere_fold`
    on; conditions as there."""
    smallest, least, _ = jkr_sphere_fold(work_of_adhesion, contact_modulus, radius)
    if approach > -1e80 * least:  # adhesion is below rounding
        return float(np.sqrt(approach) * np.sqrt(radius))
    message = f"no stable JKR contact at the approach {approach}: the least is {least}"
    return float(smallest * jkr_root(-3 * approach / least, message) ** 2)


def jkr_sphere_pull_off(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, load) at pull-off under a prescribed load, P = -3 pi w R/2 at a^3 = 9 pi w
    R^2/(8 E*); conditions of `jkr_sphere`."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    return np.cbrt(9 * force * radius / (8 * contact_modulus)), -1.5 * force


def jkr_sphere_fold(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, approach, load) at pull-off under a prescribed approach, delta = -3 a^2/R, P
    = -5 pi w R/6 at a^3 = pi w R^2/(8 E*); conditions of `jkr_sphere`."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    a = np.cbrt(force * radius / (8 * contact_modulus))
    return a, -3 * a**2 / radius, -5 / 6 * force


def dmt_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - 2 pi w R, delta = a^2/R (Derjaguin, Muller & Toporov
    1975): long-range adhesion, a stiff body, Maugis's parameter below about 0.1; the least load is
    -2 pi w R, at a = 0."""
    positive(work_of_adhesion=work_of_adhesion)
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    return load - 2 * np.pi * work_of_adhesion * radius, approach


def dmt_sphere_radius(load, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `dmt_sphere` at a load >= -2 pi w R, a^3 = 3 R (P + 2 pi w R)/(4 E*);
    conditions as there."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 2 * np.pi * work_of_adhesion * radius
    at_most(np.negative(load), force, f"the load {load} is below pull-off, {-force}")
    return hertz_sphere_radius(np.maximum(load + force, 0.0), contact_modulus, radius)


def sphere_maugis_parameter(cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Maugis's parameter of a sphere, 2 s (R/(pi w K^2))^(1/3), K = 4 E*/3, s the peak stress,
    phi_n/(e delta_n) of the exponential law (Maugis 1992): above about 5 `jkr_sphere` applies,
    below about 0.1 `dmt_sphere` (Johnson & Greenwood 1997)."""
    return _maugis_sphere_units(cohesive_stress, work_of_adhesion, contact_modulus, radius)[0]


def _maugis_sphere_units(cohesive_stress, work_of_adhesion, contact_modulus, radius):
    """(Maugis parameter, units of load, length, approach), with K = 4 E*/3."""
    positive(cohesive_stress=cohesive_stress, work_of_adhesion=work_of_adhesion,
             contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    length = np.cbrt(force * radius / (4 * contact_modulus / 3))
    return 2 * cohesive_stress * length**2 / force, force, length, length**2 / radius


def _maugis_sphere_state(log_angle, maugis):
    """(load, a, c, approach) in Maugis's units for c/a = 1/cos(angle): the energy condition is
    quadratic in a."""
    angle = np.exp(log_angle)
    tangent, secant = np.tan(angle), 1 / np.cos(angle)
    # (lambda/2)[t + (m^2-2) arctan t]
    square = maugis * (secant * angle) ** 2 * spherical_jn(1, 2 * angle)
    linear = 4 / 3 * maugis**2 * (angle * tangent - 2 * np.sin(angle / 2) ** 2 * secant)
    a = 2 / (linear + np.sqrt(linear**2 + 4 * square))
    return a**3 - maugis * a**2 * (tangent
                                   + secant**2
                                   * angle), a, a * secant, a**2 - 4 / 3 * maugis * a * tangent


def _maugis_sphere_least(maugis):
    smallest = SMALLEST - np.log(max(maugis, 1.0))
    return minimizer(lambda t: _maugis_sphere_state(t, maugis)[0], smallest,
                     np.log(np.pi / 2 - 1e-9))


@elementwise
def maugis_sphere_pull_off(cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, a, c, approach) of least load of `maugis_sphere`; a vanishes towards the DMT limit.
    Any Maugis parameter."""
    maugis, force, length, depth = _maugis_sphere_units(cohesive_stress, work_of_adhesion,
                                                        contact_modulus, radius)
    load, a, c, approach = _maugis_sphere_state(_maugis_sphere_least(maugis), maugis)
    return load * force, a * length, c * length, approach * depth


@elementwise
def maugis_sphere(load, cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(a, c, approach) of a Maugis-Dugdale sphere at a load: contact r < a, uniform tension s on a
    < r < c, s h(c) = w (Maugis 1992). With K = 4 E*/3, lambda = 2 s (R/(pi w K^2))^(1/3), A = a
    (K/(pi w R^2))^(1/3), t^2 = m^2 - 1, m = c/a: 1 = (lambda A^2/2)[t + (m^2-2) arctan t] + (4
    lambda^2 A/3)[t arctan t - m + 1], P/(pi w R) = A^3 - lambda A^2 [t + m^2 arctan t], delta
    (K^2/(pi^2 w^2 R))^(1/3) = A^2 - (4/3) lambda A t. For the exponential law s = phi_n/(e
    delta_n). Any Maugis parameter; ValueError below pull-off."""
    maugis, force, length, depth = _maugis_sphere_units(cohesive_stress, work_of_adhesion,
                                                        contact_modulus, radius)
    least = _maugis_sphere_least(maugis)
    # So narrow a zone belongs to a larger load: lambda a^2 angle^3 and lambda^2 a angle^2 are below
    # 2.
    size = np.log(max(load / force, 1.0)) / 3
    narrow = min(SMALLEST, -4.0 - (np.log(maugis) + 2 * size) / 3, -4.0 - np.log(maugis) - size / 2)
    log_angle = find_root(lambda t: _maugis_sphere_state(t, maugis)[0], narrow, least,
                          f"no stable Maugis-Dugdale contact at the load {load}", load / force)
    _, a, c, approach = _maugis_sphere_state(log_angle, maugis)
    return a * length, c * length, approach * depth


def maugis_sphere_pressure(r, contact_radius, cohesive_radius, cohesive_stress, contact_modulus=1.0,
                           radius=1.0):
    """Pressure of `maugis_sphere`, Hertz's minus (2 s/pi) arctan sqrt((c^2-a^2)/(a^2-r^2)) within
    a, -s up to c. Any Maugis parameter."""
    positive(cohesive_stress=cohesive_stress)
    tension = zone_traction(r, contact_radius, cohesive_radius, cohesive_stress)
    return hertz_sphere_pressure(r, contact_radius, contact_modulus, radius) - tension
