"""Spheres with a finite range of adhesion: Maugis and Dugdale's, at any Maugis parameter.

Contact radii are far below the sphere's radius.
"""

import numpy as np
from scipy.special import spherical_jn

from .checks import elementwise, find_root, minimizer, positive
from .cohesive import SMALLEST
from .sphere import hertz_sphere_pressure
from .zone import zone_traction


def sphere_maugis_parameter(cohesive_stress, work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Maugis's parameter of a sphere, 2 s (R/(pi w K^2))^(1/3), K = 4 E*/3, s the peak stress,
    phi_n/(e delta_n) of the exponential law (Maugis 1992): above about 5 `jkr_sphere` applies,
    below about 0.1 `dmt_sphere` (Johnson & Greenwood 1997).

    Parameters
    ----------
    cohesive_stress, contact_modulus : float or array > 0, s, E*, a force over a length squared
    work_of_adhesion : float or array > 0, w, a force over a length
    radius : float or array > 0, R, a length
    """
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
    Any Maugis parameter.

    Parameters
    ----------
    cohesive_stress, work_of_adhesion, contact_modulus, radius : as of `sphere_maugis_parameter`
    """
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
    delta_n). Any Maugis parameter; ValueError below pull-off.

    Parameters
    ----------
    load : float or array, a force
    cohesive_stress, work_of_adhesion, contact_modulus, radius : as of `sphere_maugis_parameter`
    """
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
    a, -s up to c. Any Maugis parameter.

    Parameters
    ----------
    r, contact_radius, cohesive_radius : float or array, lengths; the radii a, c
    cohesive_stress, contact_modulus, radius : as of `sphere_maugis_parameter`
    """
    positive(cohesive_stress=cohesive_stress)
    tension = zone_traction(r, contact_radius, cohesive_radius, cohesive_stress)
    return hertz_sphere_pressure(r, contact_radius, contact_modulus, radius) - tension
