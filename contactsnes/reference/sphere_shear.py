"""Spheres under shear: a bonded circle, Coulomb friction, and Savkoor and Briggs's adhesion."""

import numpy as np

from .checks import positive, require
from .sphere import hertz_sphere_radius


def bonded_circle_stiffness(contact_radius, poisson=0.5, contact_modulus=1.0):
    """Tangential force per displacement of a sticking circle, 8 a G*, G* = mu/(2 - nu) = E* (1-nu)/(2 (2-nu)) for one
    body of Poisson ratio nu on a rigid counterface (Mindlin 1949)."""
    positive(contact_radius=contact_radius, contact_modulus=contact_modulus)
    require(0 <= poisson <= 0.5, f"poisson {poisson} must lie between 0 and 0.5")
    return 8 * contact_radius * contact_modulus * (1 - poisson) / (2 * (2 - poisson))


def cattaneo_sphere(load, tangential_force, friction, poisson=0.5, contact_modulus=1.0, radius=1.0):
    """(stick radius, displacement) of a Hertzian sphere with Coulomb friction f, s^3/a^3 = 1 - Q/(f P),
    delta_t = (3 f P/(16 a G*))[1 - (1 - Q/(f P))^(2/3)] (Cattaneo 1938; Mindlin 1949), G* of `bonded_circle_stiffness`.
    Slip across the force (unless nu = 0) and normal-tangential coupling (unless nu = 1/2) are neglected: expect
    differences of a few per cent."""
    positive(load=load, friction=friction)
    a, stick = hertz_sphere_radius(load, contact_modulus, radius), 1 - tangential_force / (friction * load)
    require(np.greater_equal(stick, 0) & np.less_equal(stick, 1),
            f"tangential_force {tangential_force} must lie between 0 and friction times load, {friction * load}")
    sliding = 1.5 * friction * load / bonded_circle_stiffness(a, poisson, contact_modulus)
    return a * np.cbrt(stick), sliding * (1 - np.cbrt(stick) ** 2)


def savkoor_briggs_sphere_radius(load, tangential_force, poisson=0.5, work_of_adhesion=1.0, contact_modulus=1.0,
                                 radius=1.0):
    """Radius of a bonded adhesive sphere that is stable at a load and a tangential force, from
    (4 E* a^3/(3R) - P)^2 = 8 pi w E* a^3 - E* Q^2/(4 G*), G* of `bonded_circle_stiffness` (Savkoor & Briggs 1977). The
    contact is taken to stay a circle, modes II and III averaged. ValueError beyond the strength, where
    9 (pi w R)^2 + 6 pi w R P < E* Q^2/(4 G*)."""
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    ratio = 2 * contact_modulus / bonded_circle_stiffness(1.0, poisson, contact_modulus)  # E*/(4 G*)
    force = 3 * np.pi * work_of_adhesion * radius
    root = force**2 + 2 * force * load - ratio * np.square(tangential_force)
    require(root >= 0, f"no equilibrium at the load {load} and tangential_force {tangential_force}")
    return hertz_sphere_radius(load + force + np.sqrt(root), contact_modulus, radius)
