"""Sheared adhesive spheres whose contact may become an ellipse: fracture mechanics at the ends of
its axes (Johnson & Greenwood 2005; Papangelo et al. 2019)."""

import numpy as np
from scipy.optimize import root
from scipy.special import elliprd, elliprf

from .checks import positive, require
from .mixed_mode import mixed_mode_toughness
from .sphere import jkr_sphere_radius

STEPS = 24
"""Steps of the force from none, in which the ellipse that is stable is followed."""


def _potentials(a, b):
    """Coefficients (1, x^2, y^2) of the potential of sqrt(1 - x^2/a^2 - y^2/b^2) on an ellipse."""
    return np.pi * a * b / 2 * np.array([2 * elliprf(0, a * a, b * b),
                                         -2 / 3 * elliprd(0, b * b, a * a),
                                         -2 / 3 * elliprd(0, a * a, b * b)])


def _pressure(a, b, load):
    """c of the pressure (c_0 + c_1 x^2/a^2 + c_2 y^2/b^2)/sqrt(1 - x^2/a^2 - y^2/b^2) under a
    sphere, E* = R = 1, of a load.

    The potential of x^2/a^2 over the root is a d/da of that of the root itself.
    """
    step = 1e-5
    bends = np.array([(_potentials(a * (1 + step), b) - _potentials(a * (1 - step), b))[1:],
                      (_potentials(a, b * (1 + step)) - _potentials(a, b * (1 - step)))[1:]])
    # u = V/(pi E*) = delta - (x^2 + y^2)/2
    c = np.linalg.solve(bends.T / (2 * step), [-np.pi / 2, -np.pi / 2])
    return np.array([load / (2 * np.pi * a * b) - c.sum() / 3, *c])


def ellipse_intensities(along, across, load, tangential_force=0.0, poisson=0.5):
    """K_I and the shear's at the ends of both axes of a bonded elliptical contact of a sphere, in
    units E* = R = 1: ((K_I, K_II), (K_I, K_III/sqrt(1 - nu))), K_I > 0 for adhesion, G = (K_I^2 +
    K_s^2)/2.

    The shear traction of a uniform displacement, Q/(2 pi a b)/sqrt(1 - x^2/a^2 - y^2/b^2), has K_II
    = Q/(2 pi a b) sqrt(pi a) before and behind and K_III alike with b at the sides, where the
    energy that it releases is 1/(1 - nu) times as large.

    Parameters
    ----------
    along, across : float > 0, half axes a, b along and across the force, (R^2 w/E*)^(1/3)
    load, tangential_force : float, R w
    poisson : float, dimensionless
    """
    first, one, two = _pressure(along, across, load)
    shear = tangential_force / (2 * np.pi * along * across)
    return ((-(first + one) * np.sqrt(np.pi * along), shear * np.sqrt(np.pi * along)),
            (-(first + two) * np.sqrt(np.pi * across),
             shear * np.sqrt(np.pi * across / (1 - poisson))))


def mixed_mode_ellipse(load, tangential_force, mode_parameters=(1.0, 1.0), poisson=0.5,
                       work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(along, across): half axes of a bonded adhesive sphere along and across a tangential force,
    where G = w f(psi), f of `mixed_mode_toughness`, holds at the ends of both axes, with m of modes
    II and III; equal m of 1 are Savkoor and Briggs's contact let go of its circle. In linear
    elasticity the sides give way first unless m of mode III is smaller. For short-range adhesion,
    no slip, and forces from which on the stable ellipse ends: ValueError beyond.

    Parameters
    ----------
    load, tangential_force : float, forces
    mode_parameters : pair of float, of modes II and III, 0 to 1, dimensionless
    poisson : float, dimensionless
    work_of_adhesion, contact_modulus, radius : float, w, E*, R in consistent units
    """
    positive(work_of_adhesion=work_of_adhesion, contact_modulus=contact_modulus, radius=radius)
    force = work_of_adhesion * radius
    length = np.cbrt(radius ** 2 * work_of_adhesion / contact_modulus)
    axes = np.full(2, float(jkr_sphere_radius(load / force)))

    def misfit(logs, sheared):
        ends = ellipse_intensities(*np.exp(logs), load / force, sheared, poisson)
        return [(opening ** 2 + shear ** 2) / 2
                / mixed_mode_toughness(np.arctan2(abs(shear), opening), m) - 1
                for (opening, shear), m in zip(ends, mode_parameters)]

    for part in np.linspace(0, 1, STEPS + 1)[1:] if tangential_force else ():
        found = root(misfit, np.log(axes), args=(part * abs(tangential_force) / force,))
        require(np.max(np.abs(found.fun)) < 1e-7 and np.all(np.exp(found.x) > 0.75 * axes),
                f"no elliptical contact is stable at the tangential_force {tangential_force}")
        axes = np.exp(found.x)
    return tuple(float(length * axis) for axis in axes)
