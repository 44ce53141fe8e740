"""Analytic solutions where rounding could decide: at their limits and at extreme arguments.

A limit's last bits differ from machine to machine: each is moved by a few of them, too.
"""

import numpy as np
import pytest

from contactsnes import reference as exact

RANDOM = None
EPS = np.finfo(float).eps


@pytest.fixture(autouse=True)
def seeded():
    """What a test draws does not hang on the tests before it, which are others in every process."""
    global RANDOM
    RANDOM = np.random.default_rng(8)


def spread(count, low, high):
    """Random numbers between powers of ten."""
    return 10.0 ** RANDOM.uniform(low, high, count)


def near(value):
    """A value, and what other roundings may make of it."""
    return [value * (1.0 + bits * EPS) for bits in (0, -1, 1, -8, 8)]


def agree(value, expected, rel):
    """Whether numbers agree to a part of what is expected."""
    return bool(np.all(np.abs(np.divide(value, expected) - 1.0) <= rel))


# ------------------------------------------------ inverses, from small to large arguments

@pytest.mark.parametrize("work", [0.0, 1e-300, 1e-12, 0.7, 5.3, 1e12, 1e300])
def test_isolated_jkr_lines_under_any_load(work):
    unit = work ** (2 / 3)
    for load in (0.0, *spread(20, -300, 300), *spread(40, -3, 3) * unit,
                 *-spread(20, -290, -0.1) * unit):
        a = exact.jkr_line_half_width(load, np.inf, work)
        adhesion = np.sqrt(2 * np.pi * a) * np.sqrt(work)
        assert abs(np.pi * a**2 / 4 - adhesion - load) <= 1e-14 * (adhesion + abs(load))
        assert a >= np.cbrt(2 * work / np.pi) * (1 - 1e-15)


def test_lines_without_load_and_without_adhesion_have_their_closed_forms():
    for work, small in zip(spread(100, -8, 8), (0.0, *spread(99, -300, -22))):
        assert agree(exact.jkr_line_half_width(small, np.inf, work), np.cbrt(32 * work / np.pi),
                     4 * EPS)
    for load in spread(100, -300, 300):
        assert agree(exact.jkr_line_half_width(load, np.inf, 0.0), 2 * np.sqrt(load / np.pi),
                     4 * EPS)
        periodic = exact.jkr_line_half_width(load, 1e3, 0.0)
        assert periodic == exact.hertz_line_half_width(load, 1e3) < 500


@pytest.mark.parametrize("work", [0.0, 1e-300, 1e-20, 1e-3, 1.0, 30.0])
def test_jkr_lines_in_a_cell_and_waves_invert_their_loads(work):
    for period in spread(25, 0.9, 4) * max(1.0, np.cbrt(work)):
        # 1.5 periods fill the least cell
        for load in (0.0, *spread(2, -300, -2), *spread(2, -2, 0.15) * period):
            a = exact.jkr_line_half_width(load, period, work)
            terms = abs(load) + exact.ligament_force(a, period, work)
            assert abs(exact.jkr_line_load(a, period, work) - load) <= 1e-13 * terms
        for amplitude in np.sqrt(work * period / spread(2, -7, 0)) if work else spread(2, -5, 5):
            expected = period / np.pi * RANDOM.uniform(0.55, 0.75)  # stable for any such amplitude
            load = exact.sinusoid_load(expected, period, amplitude, work)
            assert agree(exact.sinusoid_half_width(load, period, amplitude, work), expected, 1e-12)


def test_spheres_under_any_load_and_approach():
    for body in spread((30, 3), -4, 4):
        unit, depth = np.pi * body[0] * body[2], -exact.jkr_sphere_fold(*body)[1]
        shares = 0.0, *spread(2, -280, -20), *spread(4, -3, 3), *-spread(3, -280,
                                                                         -0.2), *spread(2, 10, 180)
        for share in shares:
            a = exact.jkr_sphere_radius(share * unit, *body)
            missed = exact.jkr_sphere(a, *body)[0] - share * unit
            assert abs(missed) <= 1e-14 * (exact.jkr_force(a, *body[:2]) + abs(share) * unit)
            a = exact.jkr_sphere_radius_at_approach(share * depth, *body)
            missed = exact.jkr_sphere(a, *body)[1] - share * depth
            assert abs(missed) <= 1e-14 * (a**2 / body[2] + 5 * depth)


def test_cohesive_zones_under_any_load():
    """Extreme loads leave Hertz's contact, small ones that without load; so stiff a law is
    JKR's."""
    for maugis in spread(6, -1, 2):
        for load in spread(2, 12, 280):
            assert agree(exact.maugis_line(load, maugis), exact.hertz_line_half_width(load), 1e-9)
            assert agree(exact.maugis_sphere(load, maugis)[0], exact.hertz_sphere_radius(load),
                         1e-5)
        small = 10.0 ** RANDOM.uniform(-300, -20)
        for states in (exact.maugis_line, exact.maugis_sphere):
            assert agree(states(small, maugis), states(0.0, maugis), 1e-12)
    for stress in spread(3, 6, 20):
        assert agree(exact.maugis_sphere(0.7, stress)[0], exact.jkr_sphere_radius(0.7), 1e-8)
        assert agree(exact.maugis_sphere_pull_off(stress)[0], exact.jkr_sphere_pull_off()[1], 1e-8)


# ------------------------------------------------ limits, to a few bits

def test_pull_off_of_lines_is_the_limit_of_their_states():
    for work in spread(12, -6, 6):
        for period in (np.inf, 10.0 ** RANDOM.uniform(0.6, 3) * np.cbrt(work)):
            a, least = exact.jkr_line_pull_off(period, work)
            for load in near(least):
                assert agree(exact.jkr_line_half_width(load, period, work), a, 1e-6)
            with pytest.raises(ValueError, match="no stable"):
                exact.jkr_line_half_width(least * (1 + 1e-9), period, work)
        a, least, _ = exact.jkr_line_fold(period, work)
        for approach in near(least):
            assert agree(exact.jkr_line_half_width_at_approach(approach, period, work), a, 1e-6)
        for full in near(period**2 / 24):
            assert agree(exact.jkr_line_half_width_at_approach(full, period, work), period / 2,
                         1e-6)


def test_cells_and_waves_in_which_the_last_partial_contact_is_stable():
    """There pull-off and the jump to full contact are one: tan^2(pi a/L) = 3, or 3/5 on a wave."""
    angle = np.arctan(np.sqrt(0.6))
    for work in spread(20, -6, 6):
        for period in near(np.cbrt(32 * np.pi**2 * work / (3 * np.sqrt(3)))):
            a, load = exact.jkr_line_pull_off(period, work)
            assert agree(a, period / 3, 1e-6)
            for applied in near(load):
                assert agree(exact.jkr_line_half_width(applied, period, work), a, 1e-5)
        with pytest.raises(ValueError, match="no partial contact"):
            exact.jkr_line_pull_off(period * (1 - 1e-9), work)
        share = 8 * np.pi**2 * np.sin(angle) ** 3 * np.cos(angle) ** 5
        for amplitude in near(np.sqrt(work * 10.0 / share)):
            for load in near(exact.sinusoid_load(10 / np.pi * angle, 10.0, amplitude, work)):
                a = exact.sinusoid_half_width(load, 10.0, amplitude, work)
                assert agree(a, 10 / np.pi * angle, 1e-4)


def test_waves_without_adhesion_are_pressed_to_full_contact():
    for period, amplitude in spread((60, 2), -3, 3):
        wave = period, amplitude, 0.0
        for load in near(np.pi * amplitude):
            a = exact.sinusoid_half_width(load, *wave)
            assert a < period / 2 and agree(a, period / 2, 1e-6)
            assert agree(exact.sinusoid_load(a, *wave), np.pi * amplitude, 1e-12)
            assert agree(exact.sinusoid_approach(a, *wave), amplitude, 1e-12)
        with pytest.raises(ValueError, match="no stable"):
            exact.sinusoid_half_width(load * (1 + 1e-9), *wave)
    full = exact.hertz_line_half_width(1e9, 10.0)
    assert full < 5 and np.isfinite([exact.hertz_line_load(full, 10.0),
                                     exact.ligament_stiffness(full, 10.0)]).all()
    assert agree(exact.hertz_line_approach(full, 10.0), 100 / 24, 1e-12)


def test_pull_off_and_fold_of_spheres_are_limits_of_their_states():
    for body in spread((60, 3), -6, 6):
        a, load = exact.jkr_sphere_pull_off(*body)
        fold, approach, _ = exact.jkr_sphere_fold(*body)
        for one, other, third in zip(near(load), near(approach),
                                     near(exact.dmt_sphere(0.0, *body)[0])):
            assert agree(exact.jkr_sphere_radius(one, *body), a, 1e-6)
            assert agree(exact.jkr_sphere_radius_at_approach(other, *body), fold, 1e-6)
            assert exact.dmt_sphere_radius(third, *body) < 1e-4 * a
            assert exact.savkoor_briggs_sphere_strength(one, 0.5, *body)[1] < -1e-5 * load


def test_pull_off_of_cohesive_zones_is_the_limit_of_their_states():
    for maugis in spread(12, -1, 1.5):
        load, *state = exact.maugis_line_pull_off(maugis)
        for applied in near(load):
            assert exact.maugis_line(applied, maugis) == pytest.approx(state, rel=1e-3, abs=1e-3)
        load, *state = exact.maugis_sphere_pull_off(maugis)
        for applied in near(load):
            assert exact.maugis_sphere(applied, maugis) == pytest.approx(state, rel=1e-3, abs=1e-3)
    load, *state = exact.maugis_line_pull_off(2.0, 11.3)
    assert state[0] > 0.3  # contacts that have shrunk to nothing differ in their load by rounding
    for applied in near(load):
        assert agree(exact.maugis_line(applied, 2.0, 11.3), state, 1e-5)


def test_bonds_hold_up_to_their_strength():
    for load in (*RANDOM.uniform(-1.6, 20.0, 12), 0.0):
        a, strength = exact.mixed_mode_line_strength(load, 1.0, 1.4)
        assert all(agree(exact.mixed_mode_line_half_width(load, force, 1.0, 1.4), a, 1e-4)
                   for force in near(strength))
        a, strength = exact.savkoor_briggs_sphere_strength(load, 0.3)
        assert all(agree(exact.savkoor_briggs_sphere_radius(load, force, 0.3), a, 1e-4)
                   for force in near(strength))
    for period in (np.inf, 20.0):
        a, pull_off = exact.jkr_line_pull_off(period)
        for load in near(pull_off):
            size, force = exact.mixed_mode_line_strength(load, 0.6, 1.0, period)
            held = exact.mixed_mode_line_half_width(load, 0.0, 0.6, 1.0, period)
            assert force < 1e-3 and agree([size, held], a, 1e-3)
    a, pull_off = exact.jkr_sphere_pull_off()
    for load in near(pull_off):
        size, force = exact.mixed_mode_sphere_strength(load, 0.6)
        assert force < 1e-3 and agree([size, exact.mixed_mode_sphere_radius(load, 0.0, 0.6)], a,
                                      1e-3)
    for load in -spread(30, -200, -1):
        assert agree(exact.mixed_mode_line_half_width(load, 0.0), exact.jkr_line_half_width(load),
                     1e-9)


def test_friction_up_to_gross_sliding():
    for a, friction in spread((60, 2), -2, 1):
        for period in (np.inf, 2.5 * a):
            load = exact.hertz_line_load(a, period)
            for force in near(friction * load):
                assert exact.cattaneo_line_stick_half_width(a, force, friction, period) < 1e-5 * a
            # a, but for rounding
            stick = exact.cattaneo_line_stick_half_width(a, 0.0, friction, period)
            exact.cattaneo_line_traction(0.3 * a, a, stick, friction, period)
            for edge in near(a):
                for nothing in (exact.slip_zone_force, exact.slip_zone_edge_slip):
                    assert abs(nothing(a, edge, friction, period)) < 1e-5 * a * friction
                assert exact.front_force(a, edge, friction, 0.5, period) > 0
        for force in near(friction * a):
            assert exact.cattaneo_sphere(a, force, friction)[0] < 1e-4 * exact.hertz_sphere_radius(
                a)
