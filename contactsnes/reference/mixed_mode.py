"""Bonded adhesive contacts under shear, lines and spheres: linear fracture mechanics with a
toughness that depends on the mode.

Nothing slips within the contact, and the edge is sharp: both Maugis parameters large, a traction
that falls to zero beyond its peak. The modified law, whose friction stays, follows these curves at
best in quality.
"""

import numpy as np
from scipy.optimize import brentq

from .checks import at_most, elementwise, find_root, minimizer, positive, require
from .line import (
    hertz_line_half_width,
    hertz_line_load,
    jkr_line_half_width,
    jkr_line_load,
    jkr_line_pull_off,
    ligament_force,
)
from .sphere import hertz_sphere, hertz_sphere_radius, jkr_force, jkr_sphere_radius
from .sphere_shear import savkoor_briggs_ratio


def mixed_mode_toughness(phase_angle, mode_parameter):
    """Toughness G_c/phi_n = 1 + tan^2[(1 - m) psi], tan psi = K_II/K_I, |psi| <= pi/2, 0 <= m <= 1
    (Hutchinson & Suo 1992): m = 1 is Griffith's criterion, for m = 0 mode II does not matter. A fit
    to experiments, not derived from either law."""
    at_most(np.abs(phase_angle), np.pi / 2, f"phase_angle {phase_angle} must lie within +-pi/2")
    require(np.greater_equal(mode_parameter, 0) & np.less_equal(mode_parameter, 1),
            f"mode_parameter {mode_parameter} must lie between 0 and 1")
    return 1 / np.cos((1 - np.asarray(mode_parameter)) * np.asarray(phase_angle)) ** 2


# ---- lines

def mixed_mode_line(half_width, phase_angle, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(load, tangential_force) of a bonded adhesive cylinder at the equilibrium K_I^2 + K_II^2 = 2
    G_c(psi) of its edge, W = W_Hertz - B cos psi, T = B sin psi/sqrt(phi_t/phi_n), B = ligament
    force times sqrt(G_c), exact in a cell, too. The unit of T carries sqrt(phi_t/phi_n), hence
    `work_ratio` phi_t/phi_n, and m counts in works of phi_n. For short-range laws and no slip.

    Parameters
    ----------
    half_width : float or array, beta
    phase_angle : float or array, psi, radians, within +-pi/2
    mode_parameter, work_ratio : float or array, dimensionless
    period : float, beta; `inf`: isolated
    """
    positive(work_ratio=work_ratio)
    bond = ligament_force(half_width, period) * np.sqrt(mixed_mode_toughness(phase_angle,
                                                                             mode_parameter))
    load = hertz_line_load(half_width, period) - bond * np.cos(phase_angle)
    return load, bond * np.sin(phase_angle) / np.sqrt(work_ratio)


def savkoor_briggs_line_load(half_width, tangential_force, work_ratio=1.0, period=np.inf):
    """Load of `mixed_mode_line` for m = 1, W = W_Hertz - sqrt(2 L tan(pi a/L) - (phi_t/phi_n) T^2),
    isolated pi a^2/4 - sqrt(2 pi a - (phi_t/phi_n) T^2) (Savkoor & Briggs 1977, for a line). For
    short-range laws and no slip: the area falls too fast for most experiments. The criterion G_I +
    m G_II = phi_n is that of a `work_ratio` times m.

    Parameters
    ----------
    half_width : float or array, beta
    tangential_force : float or array, w_t,r
    work_ratio : float or array, dimensionless
    period : float, beta; `inf`: isolated
    """
    positive(work_ratio=work_ratio)
    bond = (ligament_force(half_width, period) ** 2)
    sheared = work_ratio * np.square(tangential_force)
    at_most(sheared, bond, f"tangential_force {tangential_force} exceeds the strength "
            f"of the half_width {half_width}")
    return hertz_line_load(half_width, period) - np.sqrt(np.maximum(bond - sheared, 0))


@elementwise
def mixed_mode_line_strength(load, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(half_width, tangential_force) of `mixed_mode_line` at the largest tangential force a load
    allows, 0 < m <= 1, beyond which the bond breaks; for m < 1 and under compression the width may
    then be down to Hertz's.

    Parameters
    ----------
    load : float or array, w_n,r
    mode_parameter, work_ratio, period : as of `mixed_mode_line`
    """
    return _weakest(*_line_states(load, mode_parameter, work_ratio, period))


@elementwise
def mixed_mode_line_half_width(load, tangential_force, mode_parameter=1.0, work_ratio=1.0,
                               period=np.inf):
    """Half width of `mixed_mode_line`, stable at a load and a tangential force up to
    `mixed_mode_line_strength`, 0 < m <= 1.

    Parameters
    ----------
    load : float or array, w_n,r
    tangential_force : float or array, w_t,r
    mode_parameter, work_ratio, period : as of `mixed_mode_line`
    """
    return _stable_size(tangential_force, *_line_states(load, mode_parameter, work_ratio, period))


def _line_states(load, mode_parameter, work_ratio, period):
    """(force that holds a half width, least half width, largest one) at a load."""
    positive(work_ratio=work_ratio)
    largest = jkr_line_half_width(load, period)
    if load > -3e-4:  # nearly nothing, at a tension as well
        smallest = max(hertz_line_half_width(max(load, 0.0), period), 1e-9)
    else:  # the unstable equilibrium without shear
        # At the lower end what tears is half the load.
        smallest = find_root(lambda a: jkr_line_load(a, period), load**2 / (8 * np.pi),
                             jkr_line_pull_off(period)[0],
                             f"no partial contact at the load {load}", load)

    def force(a):
        bond = ligament_force(a, period)
        return bond * _sheared_share((hertz_line_load(a, period) - load) / bond,
                                     mode_parameter) / np.sqrt(work_ratio)

    return force, smallest, largest


# ---- spheres

def mixed_mode_sphere(contact_radius, phase_angle, mode_parameter=1.0, poisson=0.5,
                      work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """(load, tangential_force) of a bonded adhesive sphere at the equilibrium G = w f(psi), f of
    `mixed_mode_toughness`: P = P_Hertz - B cos psi, Q sqrt(E*/(4 G*)) = B sin psi, B = sqrt(8 pi w
    f E* a^3), G* of `bonded_circle_stiffness`.

    The contact is taken to stay a circle, modes II and III averaged along its edge: tan^2 psi is
    the ratio of the mean energies that shear and normal load release (compare Waters & Guduru 2010;
    Papangelo & Ciavarella 2019). m = 1 is Savkoor and Briggs's contact. For short-range adhesion
    (Maugis parameters large), no slip, and little elongation across the force.

    Parameters
    ----------
    contact_radius, radius : float or array, a and R, a length
    phase_angle : float or array, psi, radians, within +-pi/2
    mode_parameter, poisson : float or array, dimensionless; 0 to 1, 0 to 0.5
    work_of_adhesion, contact_modulus : float or array, w, E*, in units consistent with R
    """
    toughness = work_of_adhesion * mixed_mode_toughness(phase_angle, mode_parameter)
    bond = jkr_force(contact_radius, toughness, contact_modulus)
    load = hertz_sphere(contact_radius, contact_modulus, radius)[0] - bond * np.cos(phase_angle)
    return load, bond * np.sin(phase_angle) / np.sqrt(savkoor_briggs_ratio(poisson))


@elementwise
def mixed_mode_sphere_strength(load, mode_parameter=1.0, poisson=0.5, work_of_adhesion=1.0,
                               contact_modulus=1.0, radius=1.0):
    """(contact_radius, tangential_force) of `mixed_mode_sphere` at the largest tangential force a
    load allows, 0 < m <= 1; for m < 1 and under compression the radius may then be down to Hertz's.
    Conditions as there.

    Parameters
    ----------
    load : float or array, a force
    mode_parameter, poisson, work_of_adhesion, contact_modulus, radius : as of `mixed_mode_sphere`
    """
    return _weakest(*_sphere_states(load, mode_parameter, poisson, work_of_adhesion,
                                    contact_modulus, radius))


@elementwise
def mixed_mode_sphere_radius(load, tangential_force, mode_parameter=1.0, poisson=0.5,
                             work_of_adhesion=1.0, contact_modulus=1.0, radius=1.0):
    """Radius of `mixed_mode_sphere`, stable at a load and a tangential force up to
    `mixed_mode_sphere_strength`, 0 < m <= 1.

    Parameters
    ----------
    load, tangential_force : float or array, forces
    mode_parameter, poisson, work_of_adhesion, contact_modulus, radius : as of `mixed_mode_sphere`
    """
    states = _sphere_states(load, mode_parameter, poisson, work_of_adhesion, contact_modulus,
                            radius)
    return _stable_size(tangential_force, *states)


def _sphere_states(load, mode_parameter, poisson, work_of_adhesion, contact_modulus, radius):
    """(force that holds a radius, least radius, largest one) at a load."""
    largest = jkr_sphere_radius(load, work_of_adhesion, contact_modulus, radius)
    unit = 3 * np.pi * work_of_adhesion * radius
    # the load of Hertz's contact of the least radius: below it, tension; a contact that is pulled
    # is unstable below it
    rest = (load if load >= 0
            else load**2 / (load + unit + np.sqrt(max(unit * (unit + 2 * load), 0.0))))
    smallest = max(hertz_sphere_radius(rest, contact_modulus, radius), 1e-9 * largest)

    def force(a):
        bond = jkr_force(a, work_of_adhesion, contact_modulus)
        share = (hertz_sphere(a, contact_modulus, radius)[0] - load) / bond
        return bond * _sheared_share(share, mode_parameter) / np.sqrt(savkoor_briggs_ratio(poisson))

    return force, smallest, largest


# ---- both

def _sheared_share(share, mode_parameter):
    """sqrt(f) sin psi where sqrt(f) cos psi, the share of the adhesion without shear that the
    normal load takes, is given."""
    require(0 < mode_parameter <= 1,
            f"mode_parameter {mode_parameter} must be above 0 and at most 1")
    # solved for pi/2 - psi: the signs at the ends survive rounding
    share, rest = min(max(share, 0.0), 1.0), 1 - mode_parameter
    angle = brentq(lambda t: np.sin(t) - share * np.sin(np.pi / 2 * mode_parameter + rest * t), 0,
                   np.pi / 2)
    return np.cos(angle) / np.sin(np.pi / 2 * mode_parameter + rest * angle)


def _weakest(force, smallest, largest):
    smallest = min(smallest, largest)  # at pull-off they are one, but for rounding
    size = max(smallest, minimizer(lambda a: -force(a), smallest, largest), key=force)
    return size, force(size)


def _stable_size(tangential_force, force, smallest, largest):
    """The size at which a contact under a growing force is held by it, between that of largest
    force and that of none."""
    weakest, strength = _weakest(force, smallest, largest)
    if force(largest) >= abs(tangential_force):  # a force within rounding of none
        return largest
    return find_root(force, weakest, largest,
                     f"tangential_force {tangential_force} exceeds the strength {strength}",
                     abs(tangential_force))
