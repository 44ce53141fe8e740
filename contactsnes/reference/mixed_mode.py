"""Bonded adhesive line contacts under shear: linear fracture mechanics with a toughness that depends on the mode."""

import numpy as np
from scipy.optimize import brentq

from .checks import find_root, minimizer, positive, require
from .line import hertz_line_half_width, hertz_line_load, jkr_line_half_width, jkr_line_load, jkr_line_pull_off, ligament_force


def mixed_mode_toughness(phase_angle, mode_parameter):
    """Toughness G_c/phi_n = 1 + tan^2[(1 - m) psi], tan psi = K_II/K_I, |psi| <= pi/2 (Hutchinson & Suo 1992): m = 1
    is Griffith's criterion, for m = 0 mode II does not matter."""
    require(np.less_equal(np.abs(phase_angle), np.pi / 2), f"phase_angle {phase_angle} must lie within +-pi/2")
    require(0 <= mode_parameter <= 1, f"mode_parameter {mode_parameter} must lie between 0 and 1")
    return 1 / np.cos((1 - mode_parameter) * np.asarray(phase_angle)) ** 2


def mixed_mode_line(half_width, phase_angle, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(load, tangential_force) of a bonded adhesive cylinder at the equilibrium K_I^2 + K_II^2 = 2 G_c(psi) of its edge,
    W = W_Hertz - B cos psi, T = B sin psi/sqrt(phi_t/phi_n), B = ligament force times sqrt(G_c). The unit of T carries
    sqrt(phi_t/phi_n), hence `work_ratio` phi_t/phi_n. Nothing slips; a cohesive law follows this at best in quality."""
    positive(work_ratio=work_ratio)
    bond = ligament_force(half_width, period) * np.sqrt(mixed_mode_toughness(phase_angle, mode_parameter))
    load = hertz_line_load(half_width, period) - bond * np.cos(phase_angle)
    return load, bond * np.sin(phase_angle) / np.sqrt(work_ratio)


def savkoor_briggs_line_load(half_width, tangential_force, work_ratio=1.0, period=np.inf):
    """Load of `mixed_mode_line` for m = 1, W = W_Hertz - sqrt(2 L tan(pi a/L) - (phi_t/phi_n) T^2), isolated pi a^2/4
    - sqrt(2 pi a - (phi_t/phi_n) T^2) (Savkoor & Briggs 1977, for a line)."""
    positive(work_ratio=work_ratio)
    remaining = ligament_force(half_width, period) ** 2 - work_ratio * np.square(tangential_force)
    require(remaining >= 0, f"tangential_force {tangential_force} exceeds the strength of the half_width {half_width}")
    return hertz_line_load(half_width, period) - np.sqrt(remaining)


def _mixed_mode_force(half_width, load, mode_parameter, work_ratio, period):
    """Tangential force that holds `half_width` at `load`: cos psi = share cos((1-m) psi), share = (W_Hertz - W)/F."""
    share = np.clip((hertz_line_load(half_width, period) - load) / ligament_force(half_width, period), 0, 1)
    rest = 1 - mode_parameter  # solved for pi/2 - psi, so that the signs at the ends survive rounding
    angle = brentq(lambda t: np.sin(t) - share * np.sin(np.pi / 2 * mode_parameter + rest * t), 0, np.pi / 2)
    return mixed_mode_line(half_width, np.pi / 2 - angle, mode_parameter, work_ratio, period)[1]


def mixed_mode_line_strength(load, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """(half_width, tangential_force) of `mixed_mode_line` at the largest tangential force a load allows, 0 < m <= 1,
    beyond which the bond breaks; for m < 1 and under compression the width may then be down to Hertz's."""
    require(0 < mode_parameter <= 1, f"mode_parameter {mode_parameter} must be above 0 and at most 1")
    largest = jkr_line_half_width(load, period)
    if load >= 0:
        smallest = max(hertz_line_half_width(load, period), 1e-9)
    else:  # the unstable equilibrium without shear
        ends = load**2 / (8 * np.pi), jkr_line_pull_off(period)[0]
        smallest = brentq(lambda a: jkr_line_load(a, period) - load, *ends)

    def force(a):
        return _mixed_mode_force(a, load, mode_parameter, work_ratio, period)

    weakest = max(smallest, minimizer(lambda a: -force(a), smallest, largest), key=force)
    return weakest, force(weakest)


def mixed_mode_line_half_width(load, tangential_force, mode_parameter=1.0, work_ratio=1.0, period=np.inf):
    """Half width of `mixed_mode_line`, stable at a load and a tangential force up to `mixed_mode_line_strength`."""
    smallest, strength = mixed_mode_line_strength(load, mode_parameter, work_ratio, period)
    largest = jkr_line_half_width(load, period)

    def excess(a):
        return _mixed_mode_force(a, load, mode_parameter, work_ratio, period) - abs(tangential_force)

    if excess(largest) >= 0:  # a force within rounding of none
        return largest
    return find_root(excess, smallest, largest, f"tangential_force {tangential_force} exceeds the strength {strength}")
