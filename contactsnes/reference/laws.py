"""Peaks and works of the paper's two traction-separation laws, from the laws alone: exact, whatever
the contact.

They are that of McGarry et al. (`mcgarry`) and the modified one with residual friction
(`modified`).
"""

import numpy as np
from scipy.special import erfcx

from .checks import not_negative, positive, require

TANGENTIAL_PEAK = np.sqrt(0.5)  # slip at the peak of both laws, in ranges delta_t


def _share(**values):
    for name, value in values.items():
        require(np.greater_equal(value, 0) & np.less_equal(value, 1),
                f"{name} {value} must lie between 0 and 1")


def peak_normal_traction(normal_maugis):
    """Largest attraction of both laws, lambda_n/e at the gap delta_n, without slip."""
    positive(normal_maugis=normal_maugis)
    return normal_maugis * np.exp(-1.0)


def peak_tangential_traction(tangential_maugis):
    """Largest tangential traction of both laws at no gap, sqrt(2/e) lambda_t at the slip
    delta_t/sqrt 2."""
    positive(tangential_maugis=tangential_maugis)
    return np.sqrt(2 * np.exp(-1.0)) * tangential_maugis


def normal_work(ranges):
    """Work of opening without slip to a gap of `ranges` delta_n, 1 - (1 + a) exp(-a) in phi_n, of
    both laws; 0.7546 up to the threshold of the contact area, a = e."""
    not_negative(ranges=ranges)
    return 1 - (1 + ranges) * np.exp(-ranges)


def fading_work(slip_ranges, residual_adhesion=0.0):
    """Work of adhesion that is left at a slip of b ranges delta_t, w/phi_n = r + (1 - r) exp(-b^2),
    r the share left at large slip (0: eqs. 3a and 5a); of opening at that slip, by both laws."""
    _share(residual_adhesion=residual_adhesion)
    return residual_adhesion + (1 - residual_adhesion) * np.exp(-np.square(slip_ranges))


def fading_slip(work, residual_adhesion=0.0):
    """Slip b in ranges delta_t at which the work of adhesion has faded to a share w of phi_n, the
    inverse of `fading_work`, sqrt(ln((1 - r)/(w - r))) for r < w <= 1: a contact that has slipped
    so far everywhere has no more adhesion than that."""
    _share(work=work, residual_adhesion=residual_adhesion)
    require(np.greater(work, residual_adhesion),
            f"work {work} must be above the residual_adhesion {residual_adhesion}")
    return np.sqrt(np.log((1 - residual_adhesion) / (np.asarray(work) - residual_adhesion)))


def mcgarry_proportional_work(mixity):
    """(normal, tangential) works in phi_n, phi_t of separating along g_t/delta_t = c g_n/delta_n by
    the law of McGarry et al. (2014), c = `mixity` > 0: W_t = 1 - (sqrt(pi)/2c) exp(1/4c^2)
    erfc(1/2c), W_n = W_t/(2 c^2). On that path only: neither law has a potential, the works depend
    on the path."""
    positive(mixity=mixity)
    c = np.asarray(mixity, float)
    series = 2 * c**2 * (1 - 6 * c**2)  # the difference from 1 cancels for small c
    tangential = np.where(c < 1e-3, series, 1 - np.sqrt(np.pi) / (2 * c) * erfcx(1 / (2 * c)))
    return tangential / (2 * c**2), tangential


def mcgarry_sequential_work(normal_ranges=None, tangential_ranges=None):
    """(normal, tangential) works by the law of McGarry et al. (2014) on a broken path: either
    opening to a = `normal_ranges`, then sliding off, 1 - (1+a) exp(-a) and exp(-a); or sliding to b
    = `tangential_ranges`, then opening, exp(-b^2) and 1 - exp(-b^2). Give one of the two."""
    require((normal_ranges is None) != (tangential_ranges is None),
            "give normal_ranges or tangential_ranges")
    if tangential_ranges is None:
        return normal_work(normal_ranges), np.exp(-normal_ranges)
    return np.exp(-np.square(tangential_ranges)), -np.expm1(-np.square(tangential_ranges))


def modified_tangential_work(residual_friction):
    """Tangential work of the modified law at no gap, in phi_t: (up to the peak, excess over the
    residual traction beyond it), 1 - exp(-1/2) and sqrt(pi/2) exp(-1/2) (1 - tau_inf/tau_max);
    1.1536 in all without residual friction, not 1."""
    _share(residual_friction=residual_friction)
    return 1 - np.exp(-0.5), np.sqrt(np.pi / 2) * np.exp(-0.5) * (1 - residual_friction)


def front_work(residual_friction):
    """Work of slip in excess of the residual friction r = tau_inf/tau_max, G/phi_t at no gap: the
    integral of tau - tau_inf over the slip, 1 - exp(-1/2) - r exp(-1/2) + sqrt(pi/2) exp(-1/2) (1 -
    r). Negative for r above 0.82, where there is no front but a gradual slip."""
    rising, beyond = modified_tangential_work(residual_friction)
    return rising - residual_friction * np.exp(-0.5) + beyond
