"""Spheres under a normal load: Hertz, JKR and DMT.

All take contact radii far below the sphere's radius. Maugis's parameter (`sphere_maugis_parameter`)
tells which of the adhesive ones applies: JKR's above about 5, DMT's below about 0.1 (Johnson &
Greenwood 1997), Maugis and Dugdale's (`sphere_cohesive`) at any; it is 0.415 times the normal
Maugis parameter of a scene with the exponential law.
"""

import numpy as np

from .checks import (
    at_most,
    elementwise,
    jkr_root,
    not_negative,
    positive,
    reciprocal_depth,
    root_depth,
)


def hertz_sphere(contact_radius, contact_modulus=1.0, radius=1.0):
    """(load, approach) without adhesion, P = 4 E* a^3/(3 R), delta = a^2/R (Johnson 1985), for a <<
    R.

    Parameters
    ----------
    contact_radius, radius : float or array, a >= 0 and R, a length
    contact_modulus : float or array, E*, a force over a length squared
    """
    positive(contact_modulus=contact_modulus, radius=radius)
    not_negative(contact_radius=contact_radius)
    return 4 * contact_modulus * np.power(contact_radius,
                                          3.0) / (3 * radius), np.square(contact_radius) / radius


def hertz_sphere_radius(load, contact_modulus=1.0, radius=1.0):
    """Contact radius without adhesion at a load >= 0, a^3 = 3 P R/(4 E*) (Johnson 1985), for a <<
    R.

    Parameters
    ----------
    load : float or array >= 0, a force
    contact_modulus, radius : as of `hertz_sphere`
    """
    positive(contact_modulus=contact_modulus, radius=radius)
    not_negative(load=load)
    return np.cbrt(3 * load * radius / (4 * contact_modulus))


def hertz_sphere_pressure(r, contact_radius, contact_modulus=1.0, radius=1.0):
    """Pressure (2 E*/(pi R)) sqrt(a^2 - r^2), 0 outside (Johnson 1985), for a << R.

    Parameters
    ----------
    r : float or array, a length
    contact_radius, contact_modulus, radius : as of `hertz_sphere`, a > 0
    """
    positive(contact_radius=contact_radius, contact_modulus=contact_modulus, radius=radius)
    return 2 * contact_modulus / (np.pi * radius) * root_depth(r, contact_radius)


def jkr_force(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0):
    """Force that breaks a bonded circle, sqrt(8 pi w E* a^3) (Kendall's flat punch): the adhesive
    part of JKR's load. For adhesion of a range that is short beside the circle.

    Parameters
    ----------
    contact_radius, contact_modulus : as of `hertz_sphere`
    work_of_adhesion : float or array > 0, w, a force over a length
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus)
    not_negative(contact_radius=contact_radius)
    return np.sqrt(8 * np.pi * work_of_adhesion * contact_modulus) * np.power(contact_radius, 1.5)


def jkr_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3), delta = a^2/R - sqrt(2 pi w a/E*)
    (Johnson, Kendall & Roberts 1971): short-range adhesion, a compliant body, Maugis's parameter
    above about 5.

    Parameters
    ----------
    contact_radius, work_of_adhesion, contact_modulus : as of `jkr_force`
    radius : float or array, R, a length
    """
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    force = jkr_force(contact_radius, work_of_adhesion, contact_modulus)
    return load - force, approach - np.sqrt(2 * np.pi * work_of_adhesion * contact_radius
                                            / contact_modulus)


def jkr_sphere_pressure(r, contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Pressure of `jkr_sphere`, Hertz's minus sqrt(2 w E*/(pi a))/sqrt(1 - r^2/a^2), 0 outside
    (Maugis 1992); conditions of `jkr_sphere`.

    Parameters
    ----------
    r : float or array, a length
    contact_radius, work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`, a > 0
    """
    positive(work_of_adhesion=work_of_adhesion)
    smooth = hertz_sphere_pressure(r, contact_radius, contact_modulus, radius)
    intensity = np.sqrt(2 * work_of_adhesion * contact_modulus * contact_radius / np.pi)
    return smooth - intensity * reciprocal_depth(r, contact_radius)


def jkr_sphere_radius(load, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `jkr_sphere` that is stable at a load >= -3 pi w R/2 (Johnson, Kendall &
    Roberts 1971); conditions as there.

    Parameters
    ----------
    load : float or array, a force
    work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 3 * np.pi * work_of_adhesion * radius
    at_most(np.negative(load), force / 2, f"the load {load} is below pull-off, {-force / 2}")
    root = np.sqrt(force) * np.sqrt(np.maximum(force + 2 * load, 0))
    return hertz_sphere_radius(load + force + root, contact_modulus, radius)


@elementwise
def jkr_sphere_radius_at_approach(approach, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `jkr_sphere` that is stable at an approach, from that of `jkr_sphere_fold`
    on; conditions as there.

    Parameters
    ----------
    approach : float or array, a length
    work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    smallest, least, _ = jkr_sphere_fold(work_of_adhesion, contact_modulus, radius)
    if approach > -1e80 * least:  # adhesion is below rounding
        return float(np.sqrt(approach) * np.sqrt(radius))
    message = f"no stable JKR contact at the approach {approach}: the least is {least}"
    return float(smallest * jkr_root(-3 * approach / least, message) ** 2)


def jkr_sphere_pull_off(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, load) at pull-off under a prescribed load, P = -3 pi w R/2 at a^3 = 9 pi w
    R^2/(8 E*); conditions of `jkr_sphere`.

    Parameters
    ----------
    work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    return np.cbrt(9 * force * radius / (8 * contact_modulus)), -1.5 * force


def jkr_sphere_fold(work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(contact_radius, approach, load) at pull-off under a prescribed approach, delta = -3 a^2/R, P
    = -5 pi w R/6 at a^3 = pi w R^2/(8 E*); conditions of `jkr_sphere`.

    Parameters
    ----------
    work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = np.pi * work_of_adhesion * radius
    a = np.cbrt(force * radius / (8 * contact_modulus))
    return a, -3 * a**2 / radius, -5 / 6 * force


def dmt_sphere(contact_radius, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, approach), P = 4 E* a^3/(3 R) - 2 pi w R, delta = a^2/R (Derjaguin, Muller & Toporov
    1975): long-range adhesion, a stiff body, Maugis's parameter below about 0.1; the least load is
    -2 pi w R, at a = 0.

    Parameters
    ----------
    contact_radius, work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    positive(work_of_adhesion=work_of_adhesion)
    load, approach = hertz_sphere(contact_radius, contact_modulus, radius)
    return load - 2 * np.pi * work_of_adhesion * radius, approach


def dmt_sphere_radius(load, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Contact radius of `dmt_sphere` at a load >= -2 pi w R, a^3 = 3 R (P + 2 pi w R)/(4 E*);
    conditions as there.

    Parameters
    ----------
    load : float or array, a force
    work_of_adhesion, contact_modulus, radius : as of `jkr_sphere`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 2 * np.pi * work_of_adhesion * radius
    at_most(np.negative(load), force, f"the load {load} is below pull-off, {-force}")
    return hertz_sphere_radius(np.maximum(load + force, 0.0), contact_modulus, radius)
