"""Spheres under shear: a bonded circle, Coulomb friction, and Savkoor and Briggs's adhesion."""

import numpy as np

from .checks import ROUNDING, at_most, positive, require
from .sphere import hertz_sphere, hertz_sphere_pressure, hertz_sphere_radius, jkr_force


def bonded_circle_stiffness(contact_radius, poisson=0.5, contact_modulus=1.0):
    """Tangential force per displacement of a sticking circle, 8 a G*, G* = mu/(2 - nu) = E*
    (1-nu)/(2 (2-nu)) for one body of Poisson ratio nu on a rigid counterface (Mindlin 1949), exact
    without coupling (nu = 1/2).

    Parameters
    ----------
    contact_radius : float or array > 0, a length
    poisson : float or array, 0 to 0.5
    contact_modulus : float or array > 0, E*, a force over a length squared
    """
    positive(contact_radius=contact_radius, contact_modulus=contact_modulus)
    require(np.greater_equal(poisson, 0) & np.less_equal(poisson, 0.5),
            f"poisson {poisson} must lie between 0 and 0.5")
    return 8 * contact_radius * contact_modulus * (1 - poisson) / (2 * (2 - poisson))


def cattaneo_sphere(load, tangential_force, friction, poisson=0.5, contact_modulus=1.0, radius=1.0):
    """(stick radius, displacement) of a Hertzian sphere with Coulomb friction f, s^3/a^3 = 1 - Q/(f
    P), delta_t = (3 f P/(16 a G*))[1 - (1 - Q/(f P))^(2/3)] (Cattaneo 1938; Mindlin 1949), G* of
    `bonded_circle_stiffness`. Needs friction in proportion to the pressure and no adhesion, and a
    load held while the force grows from nothing to at most f P. Slip across the force (unless nu =
    0) and normal-tangential coupling (unless nu = 1/2) are neglected: expect differences of a few
    per cent.

    Parameters
    ----------
    load, tangential_force : float or array, forces
    friction : float or array > 0, dimensionless
    poisson, contact_modulus : as of `bonded_circle_stiffness`
    radius : float or array > 0, R, a length
    """
    positive(load=load, friction=friction)
    a = hertz_sphere_radius(load, contact_modulus, radius)
    stick = 1 - tangential_force / (friction * load)
    require(np.greater_equal(stick, -ROUNDING) & np.less_equal(stick, 1), "tangential_force "
            f"{tangential_force} must lie between 0 and friction times "
            f"load, {friction * load}")
    stick = np.maximum(stick, 0.0)
    sliding = 1.5 * friction * load / bonded_circle_stiffness(a, poisson, contact_modulus)
    return a * np.cbrt(stick), sliding * (1 - np.cbrt(stick) ** 2)


def cattaneo_sphere_traction(r, contact_radius, stick_radius, friction, contact_modulus=1.0,
                             radius=1.0):
    """Traction of `cattaneo_sphere`, along the force, f [p(r; a) - p(r; s)] with Hertz's pressure
    of each radius, s <= a; conditions as there.

    Parameters
    ----------
    r, contact_radius, stick_radius : float or array, lengths
    friction, contact_modulus, radius : as of `cattaneo_sphere`
    """
    positive(friction=friction)
    at_most(stick_radius, contact_radius,
            f"stick_radius {stick_radius} exceeds contact_radius {contact_radius}")
    outer, inner = (hertz_sphere_pressure(r, edge, contact_modulus, radius)
                    for edge in (contact_radius, stick_radius))
    return friction * (outer - inner)


def savkoor_briggs_ratio(poisson=0.5):
    """E*/(4 G*) = (2 - nu)/(2 (1 - nu)), 3/2 for an incompressible body on a rigid counterface:
    what a tangential force releases at the edge of a bonded circle, over what the same normal force
    does, modes II and III averaged (Savkoor & Briggs 1977)."""
    return 2 / bonded_circle_stiffness(1.0, poisson)


def savkoor_briggs_sphere_load(contact_radius, tangential_force, poisson=0.5, work_of_adhesion=1.0,
                               contact_modulus=1.0, radius=1.0):
    """Load of a bonded adhesive sphere of a contact radius and a tangential force Q, stable or not:
    (4 E* a^3/(3R) - P)^2 = 8 pi w E* a^3 - E* Q^2/(4 G*), G* of `bonded_circle_stiffness` (Savkoor
    & Briggs 1977). For short-range adhesion (Maugis parameters large) and no slip; the contact is
    taken to stay a circle, modes II and III averaged: the area falls too fast for most
    experiments.

    Parameters
    ----------
    contact_radius, radius : float or array, a and R, a length
    tangential_force : float or array, Q, a force
    poisson, contact_modulus : as of `bonded_circle_stiffness`
    work_of_adhesion : float or array > 0, w, a force over a length
    """
    bond = jkr_force(contact_radius, work_of_adhesion, contact_modulus)
    sheared = np.sqrt(savkoor_briggs_ratio(poisson)) * np.abs(tangential_force)
    at_most(sheared, bond, f"tangential_force {tangential_force} exceeds the strength "
            f"of the contact_radius {contact_radius}")
    remaining = np.maximum((bond - sheared) * (bond + sheared), 0)
    return hertz_sphere(contact_radius, contact_modulus, radius)[0] - np.sqrt(remaining)


def savkoor_briggs_sphere_radius(load, tangential_force, poisson=0.5, work_of_adhesion=1.0,
                                 contact_modulus=1.0, radius=1.0):
    """Radius of `savkoor_briggs_sphere_load` that is stable at a load and a tangential force;
    conditions as there. ValueError beyond the strength, where 9 (pi w R)^2 + 6 pi w R P < E* Q^2/(4
    G*).

    Parameters
    ----------
    load, tangential_force : float or array, forces
    poisson, work_of_adhesion, contact_modulus, radius : as of `savkoor_briggs_sphere_load`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 3 * np.pi * work_of_adhesion * radius
    strength = force**2 + 2 * force * load
    sheared = savkoor_briggs_ratio(poisson) * np.square(tangential_force)
    # The strength is a difference near pull-off, of which rounding takes a part of its terms.
    require(np.less_equal(sheared - strength, ROUNDING * (force**2 + np.abs(2 * force * load))),
            f"no equilibrium at the load {load} and tangential_force {tangential_force}")
    return hertz_sphere_radius(load + force + np.sqrt(np.maximum(strength - sheared, 0)),
                               contact_modulus, radius)


def savkoor_briggs_sphere_strength(load, poisson=0.5, work_of_adhesion=1.0, contact_modulus=1.0,
                                   radius=1.0):
    """(contact_radius, tangential_force) of `savkoor_briggs_sphere_load` at the largest tangential
    force that a load >= -3 pi w R/2 allows, E* Q^2/(4 G*) = 9 (pi w R)^2 + 6 pi w R P at 4 E*
    a^3/(3 R) = P + 3 pi w R; conditions as there.

    Parameters
    ----------
    load : float or array, a force
    poisson, work_of_adhesion, contact_modulus, radius : as of `savkoor_briggs_sphere_load`
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = 3 * np.pi * work_of_adhesion * radius
    at_most(np.negative(load), force / 2, f"the load {load} is below pull-off, {-force / 2}")
    largest = np.sqrt(np.maximum(force * (force + 2 * load), 0) / savkoor_briggs_ratio(poisson))
    return hertz_sphere_radius(load + force, contact_modulus, radius), largest
