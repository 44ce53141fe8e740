"""Elliptical contacts against circles, quadrature and other formulas."""

import numpy as np
import pytest
from scipy.integrate import dblquad

from contactsnes import reference
from contactsnes.reference.ellipse import _potentials, _pressure


def test_potential_of_an_ellipse_by_quadrature():
    """At the centre: the integral of sqrt(1 - rho^2)/r, and along x and y."""
    a, b = 1.4, 0.8
    found = _potentials(a, b)

    def direct(x, y):
        def radial(r, t):
            u, v = x + r * np.cos(t), y + r * np.sin(t)
            return np.sqrt(max(0.0, 1 - (u / a) ** 2 - (v / b) ** 2))
        return dblquad(radial, 0, 2 * np.pi, 0, 2 * a, epsabs=1e-6)[0]

    assert found[0] == pytest.approx(direct(0, 0), rel=1e-4)
    assert found @ [1, 0.25, 0] == pytest.approx(direct(0.5, 0), rel=1e-4)
    assert found @ [1, 0, 0.16] == pytest.approx(direct(0, 0.4), rel=1e-4)


@pytest.mark.parametrize("load", [-2.0, 0.0, 4.0])
def test_a_circle_without_shear_is_that_of_jkr(load):
    radius = float(reference.jkr_sphere_radius(load))
    assert reference.mixed_mode_ellipse(load, 0.0) == pytest.approx((radius, radius), rel=1e-12)
    for opening, shear in reference.ellipse_intensities(radius, radius, load):
        assert opening == pytest.approx(np.sqrt(2), rel=1e-7) and shear == 0.0
    first, one, two = _pressure(radius, radius, load)
    r = 0.6 * radius
    depth = np.sqrt(1 - 0.36)
    assert (first + one * 0.36) / depth == pytest.approx(
        reference.jkr_sphere_pressure(r, radius), rel=1e-6)


def test_the_area_is_savkoor_and_briggss_for_small_forces():
    """The mean of both ends; the circle is given up in second order of the force only."""
    for force, rounding in ((0.5, 1e-3), (1.0, 3e-3), (2.0, 1e-2)):
        along, across = reference.mixed_mode_ellipse(4.0, force)
        circle = reference.savkoor_briggs_sphere_radius(4.0, force)
        lost = reference.jkr_sphere_radius(4.0) ** 2 - np.array([along * across, circle ** 2])
        assert lost[0] == pytest.approx(lost[1], rel=rounding)
        assert along > across


def test_equal_modes_keep_the_circle_at_poisson_ratio_0():
    along, across = reference.mixed_mode_ellipse(4.0, 4.0, poisson=0.0)
    assert along == pytest.approx(across, rel=1e-6)
    assert along == pytest.approx(reference.savkoor_briggs_sphere_radius(4.0, 4.0, poisson=0.0),
                                  rel=1e-6)


def test_a_tougher_mode_iii_shrinks_the_contact_along_the_force():
    along, across = reference.mixed_mode_ellipse(4.0, 8.0, (1.0, 0.1))
    assert along < across


def test_units():
    plain = reference.mixed_mode_ellipse(4.0, 3.0, (0.9, 0.7), 0.3)
    work, modulus, radius = 0.03, 2e6, 0.01
    length = (radius ** 2 * work / modulus) ** (1 / 3)
    scaled = reference.mixed_mode_ellipse(4.0 * radius * work, 3.0 * radius * work, (0.9, 0.7), 0.3,
                                          work, modulus, radius)
    assert scaled == pytest.approx([length * axis for axis in plain], rel=1e-6)


def test_beyond_its_strength_there_is_none():
    strength = reference.savkoor_briggs_sphere_strength(4.0)[1]
    with pytest.raises(ValueError, match="no elliptical contact is stable"):
        reference.mixed_mode_ellipse(4.0, 1.05 * strength)
