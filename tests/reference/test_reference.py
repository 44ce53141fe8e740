"""Analytic solutions against quadrature through the elastic kernels, energy balances, limits and
published numbers."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipkm1

from contactsnes import reference

PERIODS = [np.inf, 100.0, 9.0]


def graded(levels=7, ratio=0.1, order=16):
    """(places, weights) on -1 < x < 1 of a quadrature whose panels shrink towards both ends."""
    x, weights = np.polynomial.legendre.leggauss(order)
    ends = np.append(0.0, ratio ** np.arange(levels, -1.0, -1.0)) - 1.0
    ends = np.append(ends, -ends[-2::-1])
    middles, halves = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
    return np.ravel(middles[:, None] + np.outer(halves, x)), np.ravel(np.outer(halves, weights))


SMOOTH, GRADED = graded(levels=0, order=64), graded()


def integral(function, edges, rule=GRADED):
    """Of a function of arrays, which may have logarithms at the edges of its pieces."""
    (places, weights), edges = rule, np.array(edges)[:, None]
    middles, halves = (edges[1:] + edges[:-1]) / 2, np.diff(edges, axis=0) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        values = function(middles + halves * places)
    known = np.isfinite(values)  # a place that rounding takes to an edge has next to no weight
    assert np.mean(known) > 0.9
    return np.sum(np.where(known, values, 0.0) * halves * weights)


def over_contact(function, half_width, breaks=()):
    """Integral of function(y) over |y| < a with y = a sin(t), which smooths square roots at the
    edges."""
    points = sorted({float(np.arcsin(b / half_width)) for b in breaks if abs(b) < half_width})
    return integral(lambda t: function(half_width * np.sin(t)) * half_width * np.cos(t),
                    [-np.pi / 2, *points, np.pi / 2], GRADED if points else SMOOTH)


def lift(pressure, half_width, x, period=np.inf, breaks=()):
    """Upward displacement at x above the mean surface, -(2/pi) int ln|2 sin(pi (x-y)/L)| p dy
    (isolated: ln|x-y|)."""
    kernel = ((lambda y: np.log(abs(y))) if np.isinf(period)
              else (lambda y: np.log(abs(2 * np.sin(np.pi * y / period)))))
    return -2 / np.pi * over_contact(lambda y: kernel(x - y) * pressure(y), half_width,
                                     (x, *breaks))


def slope(x, y):
    return np.polyfit(np.log(x), np.log(np.abs(y)), 1)[0]


def derivative(function, x, step=1e-4):
    return (function(x + step) - function(x - step)) / (2 * step)


# ---------------------------------------------------------------- line contacts with short-range or
# no adhesion

@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("work", [0.0, 1.0, 0.3])
def test_line_pressure_carries_the_load_and_conforms_to_the_parabola(period, work):
    a = 3.2
    pressure = lambda x: reference.jkr_line_pressure(x, a, period, work)
    assert over_contact(pressure, a) == pytest.approx(reference.jkr_line_load(a, period, work),
                                                      abs=1e-7)
    centre = lift(pressure, a, 0.0, period)
    for x in (0.3 * a, -0.8 * a, 0.99 * a):
        assert lift(pressure, a, x, period) - centre == pytest.approx(-x**2 / 2, abs=1e-6)
    if np.isfinite(period):
        assert centre == pytest.approx(reference.jkr_line_approach(a, period, work), abs=1e-7)
    x = 1.05 * a  # open outside
    assert x**2 / 2 + lift(pressure, a, x, period) - centre > 1e-3 and pressure(x) == 0


@pytest.mark.parametrize("period", PERIODS)
def test_hertz_line_half_width_inverts_the_load(period):
    a = np.array([0.0, 1e-4, 1.0, 4.4])
    found = reference.hertz_line_half_width(reference.hertz_line_load(a, period), period)
    np.testing.assert_allclose(found, a, rtol=1e-11)


def test_a_wide_cell_recovers_the_isolated_contact_with_order_two():
    a, periods = 2.0, np.array([40.0, 80.0, 160.0])
    x = 0.7 * a
    for function in (lambda L: reference.hertz_line_load(a, L),
                     lambda L: reference.ligament_force(a, L),
                     lambda L: float(reference.jkr_line_pressure(x, a, L)),
                     lambda L: reference.jkr_line_half_width(5.0, L)):
        assert slope(periods, [function(L) - function(np.inf) for L in periods]) == pytest.approx(
            -2, abs=0.1)
    # leading terms for a << L; the next are of the order (a/L)^2 ln(L/a)
    asymptotic = 2 / np.pi * (np.pi * a**2 / 4 * np.log(periods / (np.pi * a)) + np.pi * a**2 / 8)
    errors = [reference.hertz_line_approach(a, L) for L in periods] - asymptotic
    assert -2.2 < slope(periods, errors) < -1.6


@pytest.mark.parametrize("half_width", [2e-6, 0.02, 1.0, 1.1, 12.0, 49.8])
def test_hertz_approach_holds_its_digits_down_to_narrow_contacts(half_width):
    """dd/da = (2/pi) ln(1/sin(pi a/L)) dW/da: each new punch lifts the whole contact."""
    period = 100.0
    slope = lambda b: -period / np.pi * np.tan(np.pi * b / period) * np.log(
        np.sin(np.pi * b / period))
    integral, _ = quad(slope, 0, half_width, epsabs=0, epsrel=1e-13, limit=200)
    assert reference.hertz_line_approach(half_width, period) == pytest.approx(integral, rel=2e-13)


@pytest.mark.parametrize("period", PERIODS)
def test_edge_intensity_of_the_tractions_gives_the_work_of_adhesion(period):
    """G = K^2/2 (E* = 1), K = lim sqrt(2 pi (a - x)) times the traction."""
    a = 1.7
    work = 0.6
    distance = 1e-9
    intensity = lambda traction: np.sqrt(2 * np.pi * distance) * traction
    assert intensity(-reference.jkr_line_pressure(a - distance, a, period,
                                                  work)) ** 2 / 2 == pytest.approx(work, rel=1e-3)
    strength = reference.ligament_force(a, period, work)
    shear = reference.ligament_traction(a - distance, a, strength, period)
    assert intensity(shear) ** 2 / 2 == pytest.approx(work, rel=1e-6)
    assert over_contact(lambda x: reference.ligament_traction(x, a, 2.5, period),
                        a) == pytest.approx(2.5, rel=1e-7)


def test_ligament_stiffness_is_that_of_the_flat_punch():
    a, period = 2.2, 30.0
    for x in (0.0, 1.1, 2.1):
        displacement = lift(lambda y: reference.ligament_traction(y, a, 1.0, period), a, x, period)
        assert 1 / displacement == pytest.approx(reference.ligament_stiffness(a, period), rel=1e-7)


def elastic_energy(half_width, approach, period):
    """1/2 int p u dx of a contact held at any half width and approach, Hertz plus a flat punch."""
    punch = ((approach - reference.hertz_line_approach(half_width, period))
             * reference.ligament_stiffness(half_width, period))
    pressure = lambda x: (reference.hertz_line_pressure(x, half_width, period)
                          + reference.ligament_traction(x, half_width, punch, period))
    return over_contact(lambda x: pressure(x) * (approach - x**2 / 2) / 2, half_width)


def test_jkr_and_mixed_mode_edges_balance_the_energy():
    """At a fixed displacement of the far body, dE/d(2a) = work of adhesion."""
    period = 40.0
    a = 1.9
    ratio = 2.5
    approach = reference.jkr_line_approach(a, period)
    assert derivative(lambda b: elastic_energy(b, approach, period),
                      a) == pytest.approx(2, rel=1e-5)
    load, tangential = reference.mixed_mode_line(a, 0.8, 1.0, ratio, period)
    stiffness = lambda b: reference.ligament_stiffness(b, period)
    approach = (reference.hertz_line_approach(a, period)
                + (load - reference.hertz_line_load(a, period)) / stiffness(a))
    shear = np.sqrt(ratio) * tangential / stiffness(a)
    energy = lambda b: elastic_energy(b, approach, period) + stiffness(b) * shear**2 / 2
    assert derivative(energy, a) == pytest.approx(2, rel=1e-5)


def test_isolated_jkr_line_has_barquins_pull_off():
    a, load = reference.jkr_line_pull_off()
    assert (a == pytest.approx((2 / np.pi) ** (1 / 3))
            and load == pytest.approx(-3 * np.pi / 4 * (2 / np.pi) ** (2 / 3)))
    assert reference.jkr_line_half_width(0.0) == pytest.approx((32 / np.pi) ** (1 / 3))
    # W ~ w^(2/3)
    assert reference.jkr_line_pull_off(work_of_adhesion=8.0)[1] == pytest.approx(4 * load)


@pytest.mark.parametrize("period", PERIODS)
def test_jkr_line_pull_off_is_the_least_load_and_states_are_stable(period):
    a, load = reference.jkr_line_pull_off(period)
    trial = np.linspace(0.5 * a, 1.5 * a, 20001)
    loads = reference.jkr_line_load(trial, period)
    assert (loads.min() == pytest.approx(load, rel=1e-8)
            and trial[loads.argmin()] == pytest.approx(a, abs=1e-3))
    for applied in (load + 1e-6, -0.5, 0.0, 3.0):
        width = reference.jkr_line_half_width(applied, period)
        assert reference.jkr_line_load(width, period) == pytest.approx(applied, abs=1e-12)
        assert derivative(lambda b: reference.jkr_line_load(b, period), width, 1e-6) > 0
    with pytest.raises(ValueError, match="no stable"):
        reference.jkr_line_half_width(load - 1e-6, period)


def test_short_cells_jump_to_full_contact():
    trial = np.linspace(2.0, 4.4999, 100001)
    largest = reference.jkr_line_load(trial, 9.0).max()
    assert reference.jkr_line_load(reference.jkr_line_half_width(largest - 1e-6, 9.0),
                                   9.0) == pytest.approx(largest - 1e-6)
    with pytest.raises(ValueError, match="no stable"):
        reference.jkr_line_half_width(largest + 1e-4, 9.0)
    # dW/da < 0 for every half width where sin^3 t cos t < 2 pi^2/L^3 for all t: L^3 < 2 pi^2/(3
    # sqrt(3)/16)
    shortest = (2 * np.pi**2 * 16 / (3 * np.sqrt(3))) ** (1 / 3)
    reference.jkr_line_pull_off(shortest * 1.001)
    with pytest.raises(ValueError, match="period"):
        reference.jkr_line_pull_off(shortest * 0.999)


@pytest.mark.parametrize("period, work", [(5.0, 1.0), (100.0, 1.0), (100.0, 0.2), (1e4, 1.0)])
def test_fold_under_a_prescribed_approach_is_the_least_approach(period, work):
    a, approach, load = reference.jkr_line_fold(period, work)
    trial = np.linspace(0.8 * a, 1.2 * a, 20001)
    approaches = reference.jkr_line_approach(trial, period, work)
    assert (approaches.min() == pytest.approx(approach, rel=1e-8)
            and trial[approaches.argmin()] == pytest.approx(a, rel=1e-3))
    assert load == pytest.approx(reference.jkr_line_load(a, period, work))
    everywhere = reference.jkr_line_approach(np.geomspace(1e-5 * period, 0.49999 * period, 20001),
                                             period, work)
    assert np.count_nonzero(np.diff(np.sign(np.diff(everywhere)))) == 1
    width = reference.jkr_line_half_width_at_approach(approach + 0.5, period, work)
    assert width > a and reference.jkr_line_approach(width, period,
                                                     work) == pytest.approx(approach + 0.5)
    for outside in (approach - 1e-6, period**2 / 24 + 1e-6 * period**2):
        with pytest.raises(ValueError, match="no stable"):
            reference.jkr_line_half_width_at_approach(outside, period, work)


def test_load_is_the_derivative_of_the_energy_along_jkr_states():
    """d(E_elastic - 2 a)/dd = W at equilibrium."""
    period = 50.0
    state = lambda a: (reference.jkr_line_approach(a, period), reference.jkr_line_load(a, period))
    total = lambda a: elastic_energy(a, state(a)[0], period) - 2 * a
    work = derivative(total, 3.0) / derivative(lambda a: state(a)[0], 3.0)
    assert work == pytest.approx(state(3.0)[1], rel=1e-6)


# ---------------------------------------------------------------- sinusoid

@pytest.mark.parametrize("work", [0.0, 1.0])
def test_sinusoid_pressure_carries_the_load_and_conforms_to_the_wave(work):
    a = 3.4
    period = 11.0
    amplitude = 2.0
    pressure = lambda x: reference.sinusoid_pressure(x, a, period, amplitude, work)
    assert over_contact(pressure, a) == pytest.approx(reference.sinusoid_load(a, period, amplitude,
                                                                              work), abs=1e-7)
    approach = reference.sinusoid_approach(a, period, amplitude, work)
    for x in (0.0, 1.5, 3.3):
        wave = amplitude * (1 - np.cos(2 * np.pi * x / period))
        assert lift(pressure, a, x, period) == pytest.approx(approach - wave, abs=1e-6)


def test_sinusoid_states():
    period, amplitude = 20.0, 4.0
    full = 0.5 * period * (1 - 1e-9)
    assert reference.sinusoid_load(full, period, amplitude, 0.0) == pytest.approx(np.pi * amplitude)
    assert reference.sinusoid_approach(full, period, amplitude, 0.0) == pytest.approx(amplitude)
    for share in (1e-8, 0.5, 1 - 1e-8):  # Westergaard: sin^2(pi a/L) of the load at full contact
        a = reference.sinusoid_half_width(share * np.pi * amplitude, period, amplitude, 0.0)
        assert np.sin(np.pi * a / period) ** 2 == pytest.approx(share, rel=1e-9)
    loads = reference.sinusoid_load(np.linspace(1e-3, 9.999, 200001), period, amplitude)
    most, least = loads.max(), loads[: loads.argmax()].min()
    for applied in (least + 1e-5, 0.3 * most, most - 1e-5):
        a = reference.sinusoid_half_width(applied, period, amplitude)
        assert reference.sinusoid_load(a, period, amplitude) == pytest.approx(applied, abs=1e-10)
        assert derivative(lambda b: reference.sinusoid_load(b, period, amplitude), a, 1e-6) > 0
    for applied in (least - 1e-5, most + 1e-5):
        with pytest.raises(ValueError, match="no stable"):
            reference.sinusoid_half_width(applied, period, amplitude)


def test_unloaded_sinusoid_jumps_to_full_contact_at_johnsons_parameter():
    """alpha = sqrt(2 w L/(pi^2 A^2 E*)) > 0.57: full contact without load (Johnson 1995)."""
    period = 30.0
    amplitude = lambda alpha: np.sqrt(2 * period) / (np.pi * alpha)
    reference.sinusoid_half_width(0.0, period, amplitude(0.565))
    with pytest.raises(ValueError):
        reference.sinusoid_half_width(0.0, period, amplitude(0.575))


def test_sinusoid_of_curvature_one_tends_to_the_parabola_with_order_two():
    periods = np.array([50.0, 100.0, 200.0])
    for name in ("load", "approach"):
        wave, line = getattr(reference, f"sinusoid_{name}"), getattr(reference, f"jkr_line_{name}")
        differences = [wave(2.0, L, (L / (2 * np.pi)) ** 2) - line(2.0, L) for L in periods]
        assert slope(periods, differences) == pytest.approx(-2, abs=0.4)


# ---------------------------------------------------------------- Maugis-Dugdale line, rigid
# cylinder

@pytest.mark.parametrize("maugis, load", [(0.5, 2.0), (2.0, -0.8), (10.0, 25.0), (10.0, -1.5)])
def test_maugis_line_conforms_and_spends_the_work_of_adhesion(maugis, load):
    a, c = reference.maugis_line(load, maugis)
    stress = maugis / np.e
    pressure = lambda x: reference.maugis_line_pressure(x, a, c, maugis)
    assert over_contact(pressure, c, (-a, a)) == pytest.approx(load, abs=1e-6)
    centre = lift(pressure, c, 0.0, breaks=(-a, a))
    for x in (0.4 * a, 0.95 * a):
        assert lift(pressure, c, x, breaks=(-a, a)) - centre == pytest.approx(-x**2 / 2, abs=1e-6)
    gap = c**2 / 2 + lift(pressure, c, c * (1 - 1e-12), breaks=(-a, a)) - centre
    assert stress * gap == pytest.approx(1, abs=2e-5)
    assert pressure(0.5 * (a + c)) == pytest.approx(-stress) and pressure(1.01 * c) == 0
    assert reference.maugis_line(load + 0.01, maugis)[0] > a


def test_maugis_line_tends_to_jkr_with_order_two_and_to_rigid_adhesion():
    maugis = np.array([40.0, 80.0, 160.0, 320.0])
    for load in (-1.0, 25.0):
        limit = reference.jkr_line_half_width(load)
        a, c = np.transpose([reference.maugis_line(load, m) for m in maugis])
        assert slope(maugis, a - limit) == pytest.approx(-2, abs=0.05)
        assert slope(maugis, c - limit) == pytest.approx(-2, abs=0.05)
    pull_off = np.array([reference.maugis_line_pull_off(m)[0] for m in maugis])
    assert slope(maugis, pull_off - reference.jkr_line_pull_off()[1]) < -2
    # a rigid parabola under a uniform stress s within the gap 1/s: W = -2 s sqrt(2/s)
    soft = np.array([1e-4, 1e-3, 1e-2])
    rigid = -2 * np.sqrt(2 * soft / np.e)
    pull_off = np.array([reference.maugis_line_pull_off(m)[0] for m in soft])
    np.testing.assert_allclose(pull_off, rigid, rtol=1e-2)
    assert slope(soft, 1 - pull_off / rigid) == pytest.approx(1.5, abs=0.1)


@pytest.mark.parametrize("maugis", [0.3, 1.0, 3.0])
def test_maugis_line_pull_off_is_the_least_load(maugis):
    load, a, c = reference.maugis_line_pull_off(maugis)
    assert 0 < a < c
    assert reference.maugis_line(load + 1e-4, maugis)[0] > a
    with pytest.raises(ValueError, match="no stable"):
        reference.maugis_line(load - 1e-6, maugis)


@pytest.mark.parametrize("period, maugis, load", [(100.0, 3.0, 25.0), (9.0, 2.0, 3.0),
                                                  (9.0, 10.0, -1.5), (12.0, 0.7, 1.0)])
def test_maugis_line_in_a_cell_conforms_and_spends_the_work_of_adhesion(period, maugis, load):
    a, c = reference.maugis_line(load, maugis, period)
    pressure = lambda x: reference.maugis_line_pressure(x, a, c, maugis, period)
    assert over_contact(pressure, c, (-a, a)) == pytest.approx(load, abs=1e-6)
    centre = lift(pressure, c, 0.0, period, (-a, a))
    assert centre == pytest.approx(reference.maugis_line_approach(a, c, maugis, period), abs=1e-6)
    for x in (0.4 * a, 0.95 * a):
        assert lift(pressure, c, x, period, (-a, a)) - centre == pytest.approx(-x**2 / 2, abs=1e-6)
    gap = c**2 / 2 + lift(pressure, c, c * (1 - 1e-12), period, (-a, a)) - centre
    assert maugis / np.e * gap == pytest.approx(1, abs=2e-5)
    least, _, _ = reference.maugis_line_pull_off(maugis, period)
    assert least < load and reference.maugis_line(load + 0.01, maugis, period)[0] > a


def test_maugis_line_in_a_cell_tends_to_an_isolated_one_and_to_jkr_with_order_two():
    periods, maugis = np.array([40.0, 80.0, 160.0]), np.array([20.0, 40.0, 80.0])
    for outer in (0, 1):
        alone = reference.maugis_line(5.0, 3.0)[outer]
        assert slope(periods, [reference.maugis_line(5.0, 3.0, L)[outer] - alone
                               for L in periods]) == pytest.approx(-2, abs=0.1)
        sharp = (reference.maugis_line(5.0, maugis, 12.0)[outer]
                 - reference.jkr_line_half_width(5.0, 12.0))
        assert slope(maugis, sharp) == pytest.approx(-2, abs=0.05)
    loads = reference.maugis_line_pull_off(3.0, periods)[0] - reference.maugis_line_pull_off(3.0)[0]
    assert slope(periods, loads) == pytest.approx(-2, abs=0.1)
    approach = reference.maugis_line_approach(*reference.maugis_line(5.0, 300.0, 12.0), 300.0, 12.0)
    assert approach == pytest.approx(
        reference.jkr_line_approach(reference.jkr_line_half_width(5.0, 12.0), 12.0), abs=1e-4
    )


def test_maugis_line_in_a_cell_has_a_range_of_loads():
    """Least and largest load are those of all states; beyond, the contact pulls off or jumps to the
    full period."""
    maugis, period = 3.0, 9.0
    least, a, c = reference.maugis_line_pull_off(maugis, period)
    inside = np.linspace(least + 1e-3, 4.0, 40)
    widths, zones = reference.maugis_line(inside, maugis, period)
    assert ((np.diff(widths) > 0).all() and (np.diff(zones) > 0).all() and a < widths[0]
            and c < zones[0])
    for outside in (least - 1e-6, 20.0):
        with pytest.raises(ValueError, match="no stable"):
            reference.maugis_line(outside, maugis, period)
    with pytest.raises(ValueError, match="no partial contact"):
        reference.maugis_line(0.0, maugis, 2.0)


def test_how_far_jkr_is_from_a_law_of_finite_range():
    """What the conditions of JKR's solutions say."""
    loads = [25.0, -1.0]
    for maugis, excess in ((10.0, (0.003, 0.011)), (3.0, (0.023, 0.098))):
        ratio = reference.maugis_line(loads, maugis,
                                      100.0)[1] / reference.jkr_line_half_width(loads, 100.0)
        np.testing.assert_allclose(ratio - 1, excess, rtol=0.1)
    assert reference.maugis_line_pull_off(
        3.0)[0] / reference.jkr_line_pull_off()[1] == pytest.approx(0.992, abs=5e-4)


def test_rigid_cylinder_integrates_the_law():
    maugis = 0.2
    for gap in (-2.0, 0.0, 4.0):
        attraction = lambda x: maugis**2 * (gap + x**2 / 2) * np.exp(-maugis * (gap + x**2 / 2))
        assert -quad(attraction, -40, 40,
                     points=[0.0])[0] == pytest.approx(reference.rigid_cylinder_load(gap, maugis))
    gap, load = reference.rigid_cylinder_pull_off(maugis)
    loads = reference.rigid_cylinder_load(np.linspace(gap - 1, gap + 1, 2001), maugis)
    assert loads.argmin() == 1000 and load == pytest.approx(-np.sqrt(2 * np.pi * maugis / np.e))


# ---------------------------------------------------------------- tangential loading of lines

@pytest.mark.parametrize("period", [np.inf, 100.0, 10.5])
def test_slip_zone_sticks_inside(period):
    a = 5.0
    stick = 3.1
    strength = 1.7
    traction = lambda x: reference.slip_zone_traction(x, a, stick, strength, period)
    total = over_contact(traction, a, (-stick, stick))
    assert total == pytest.approx(reference.slip_zone_force(a, stick, strength, period), rel=1e-7)
    held = lift(traction, a, 0.0, period, breaks=(-stick, stick))
    for x in (0.5 * stick, 0.98 * stick):
        assert lift(traction, a, x, period, breaks=(-stick, stick)) == pytest.approx(held, abs=1e-6)
    assert traction(4.0) == strength and traction(5.1) == 0
    assert reference.slip_zone_force(a, 0.0, strength, period) == pytest.approx(2 * strength * a)


@pytest.mark.parametrize("period", [np.inf, 100.0, 10.5])
def test_slip_at_the_edge_of_a_slip_zone(period):
    a = 5.0
    stick = 3.1
    strength = 1.7
    traction = lambda x: reference.slip_zone_traction(x, a, stick, strength, period)
    held = lift(traction, a, 0.0, period, breaks=(-stick, stick))
    slip = held - lift(traction, a, a * (1 - 1e-12), period, breaks=(-stick, stick))
    assert slip == pytest.approx(reference.slip_zone_edge_slip(a, stick, strength, period),
                                 abs=1e-5)


def test_slip_zones_of_arrays():
    a, stick = np.array([2.0, 3.0, 4.0]), np.array([[0.5], [1.9]])
    for function in (reference.slip_zone_force, reference.slip_zone_edge_slip):
        values = function(a, stick, 0.8, 20.0)
        assert values.shape == (2, 3) and values[1,
                                                 2] == pytest.approx(function(4.0, 1.9, 0.8, 20.0),
                                                                     rel=1e-14)


def test_narrow_slip_zone_is_the_brittle_strength():
    """tau times the slip at the edge is the work of separation; for a narrow zone the force is the
    ligament's."""
    a, strength = 2.0, np.array([10.0, 20.0, 40.0])
    stick = a - np.pi / (4 * strength**2)
    force = np.array([reference.slip_zone_force(a, s, t) for s, t in zip(stick, strength)])
    energy = np.array([t * reference.slip_zone_edge_slip(a, s, t) for s, t in zip(stick, strength)])
    assert slope(strength, force / np.sqrt(energy) / reference.ligament_force(a)
                 - 1) == pytest.approx(-2, abs=0.1)


@pytest.mark.parametrize("period", PERIODS)
def test_cattaneo_line_sticks_inside_and_slips_by_coulomb(period):
    a = 3.0
    friction = 0.4
    tangential = 1.5
    stick = reference.cattaneo_line_stick_half_width(a, tangential, friction, period)
    traction = lambda x: reference.cattaneo_line_traction(x, a, stick, friction, period)
    pressure = lambda x: reference.hertz_line_pressure(x, a, period)
    assert over_contact(traction, a, (-stick, stick)) == pytest.approx(tangential, rel=1e-6)
    held = [lift(traction, a, x, period, (-stick, stick)) for x in (0.0, 0.5 * stick, 0.95 * stick)]
    np.testing.assert_allclose(held, held[0], atol=1e-6)
    assert traction(0.5 * (a + stick)) == pytest.approx(friction * pressure(0.5 * (a + stick)))
    assert 0 < traction(0.5 * stick) < friction * pressure(0.5 * stick)
    if np.isfinite(period):
        assert held[0] == pytest.approx(reference.cattaneo_line_displacement(a, stick, friction,
                                                                             period), abs=1e-6)
    else:
        assert stick / a == pytest.approx(np.sqrt(1 - tangential / (friction * np.pi * a**2 / 4)))


def modified_law(b, maugis, residual):
    peak = maugis * np.sqrt(2 / np.e)
    return np.where(b <= np.sqrt(0.5), 2 * maugis * b * np.exp(-b * b),
                    peak * (residual + (1 - residual) * np.exp(-((b - np.sqrt(0.5)) ** 2))))


@pytest.mark.parametrize("residual", [1.0, 0.3])
def test_uniform_slip_is_the_limit_of_small_tangential_parameters(residual):
    """A strip with the modified law, collocated on panels: the error of the uniform slip falls as
    lambda_t^2."""
    a = 3.0
    period = 60.0
    panels = 120
    width = 2 * a / panels
    x = -a + width * (np.arange(panels) + 0.5)
    distance = np.abs(x[:, None] - x) + np.diag(np.full(panels, np.nan))
    kernel = np.log(2 * np.sin(np.pi * distance / period)) * width
    # int ln|2 pi y/L| over a panel
    np.fill_diagonal(kernel, width * (np.log(np.pi * width / period) - 1))
    maugis, errors = np.array([0.01, 0.02, 0.04]), {0.3: [], 1.6: []}
    for parameter in maugis:
        for b in errors:
            traction = np.zeros(panels)
            for _ in range(60):
                slip = b / parameter + 2 / np.pi * kernel @ traction
                traction = modified_law(parameter * slip, parameter, residual)
            force = reference.uniform_slip_force(a, b / parameter, parameter, residual)
            errors[b].append(traction.sum() * width / force - 1)
    for b, error in errors.items():
        assert 4 * error[0] - error[1] == pytest.approx(0, abs=1e-5)  # the limit, by extrapolation
        if b < 1 or residual < 1:
            assert slope(maugis, error) == pytest.approx(2, abs=0.1)
    assert reference.uniform_slip_force(a, -1.0, 0.1,
                                        residual) == -reference.uniform_slip_force(a, 1.0, 0.1,
                                                                                   residual)
    slips = np.linspace(0, 40, 4001)
    assert reference.uniform_slip_force(a, slips, 0.1,
                                        residual).max() == pytest.approx(2 * a * 0.1 * np.sqrt(
        2 / np.e))


def test_drive_is_the_simple_shear_of_the_layer():
    young = 3.0
    poisson = 0.3
    height = 7.0
    period = 5.0
    force = 0.4
    modulus = young / (1 - poisson**2)  # unit of stress of the scaled stiffness
    shear = young / (2 * (1 + poisson))
    sheared = force / period * height / shear
    assert reference.driven_displacement(1.5, force / modulus, period, height,
                                         poisson) == pytest.approx(1.5 + sheared)
    assert reference.drive_stiffness(100.0, 2000.0) == pytest.approx(0.0125)


# ---------------------------------------------------------------- mixed mode

def test_hutchinson_suo_toughness():
    angle = np.linspace(-1.5, 1.5, 7)
    np.testing.assert_allclose(reference.mixed_mode_toughness(angle, 0.3),
                               1 + np.tan(0.7 * angle) ** 2)
    np.testing.assert_allclose(reference.mixed_mode_toughness(angle, 1.0), 1)
    # parameter 0: G_I alone counts, G cos^2(psi) = 1
    np.testing.assert_allclose(reference.mixed_mode_toughness(angle, 0.0) * np.cos(angle) ** 2, 1)


@pytest.mark.parametrize("period", PERIODS)
def test_mixed_mode_edge_has_the_toughness_of_its_phase(period):
    a = 2.0
    angle = 0.9
    parameter = 0.4
    ratio = 1.7
    distance = 1e-9
    load, tangential = reference.mixed_mode_line(a, angle, parameter, ratio, period)
    tension = reference.ligament_traction(a - distance, a, reference.hertz_line_load(a, period)
                                          - load, period)
    shear = np.sqrt(ratio) * reference.ligament_traction(a - distance, a, tangential, period)
    assert np.arctan2(shear, tension) == pytest.approx(angle)
    release = 2 * np.pi * distance * (tension**2 + shear**2) / 2
    assert release == pytest.approx(1 + np.tan((1 - parameter) * angle) ** 2, rel=1e-6)


@pytest.mark.parametrize("load", [-1.2, 0.0, 0.8, 25.0])
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_savkoor_briggs_line_against_its_quartic(load, ratio):
    """(pi a^2/4 - W)^2 = 2 pi a - r T^2, and at the strength the ligament force is 2/a."""
    critical, strength = reference.mixed_mode_line_strength(load, work_ratio=ratio)
    bond = np.pi * critical**2 / 4 - load
    assert bond * critical == pytest.approx(2, rel=1e-5)
    assert strength == pytest.approx(np.sqrt((2 * np.pi * critical - bond**2) / ratio), rel=1e-9)
    for tangential in (0.0, 1e-12, 0.5 * strength, 0.99 * strength):
        quartic = [np.pi**2 / 16, 0, -np.pi / 2 * load, -2 * np.pi, load**2 + ratio * tangential**2]
        roots = np.roots(quartic)
        largest = roots[np.abs(roots.imag) < 1e-9].real.max()
        a = reference.mixed_mode_line_half_width(load, tangential, work_ratio=ratio)
        assert a == pytest.approx(largest, rel=1e-9)
        assert reference.savkoor_briggs_line_load(a, tangential,
                                                  ratio) == pytest.approx(load, abs=1e-9)
    with pytest.raises(ValueError, match="strength"):
        reference.mixed_mode_line_half_width(load, 1.001 * strength, work_ratio=ratio)


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("load", [-1.0, 1.5])
def test_mixed_mode_half_width_meets_load_and_force(load, period):
    widest = reference.jkr_line_half_width(load, period)
    widths = []
    for parameter in (1.0, 0.5, 0.1):
        _, strength = reference.mixed_mode_line_strength(load, parameter, period=period)
        a = reference.mixed_mode_line_half_width(load, 0.6, parameter, period=period)
        angle = np.arctan2(0.6, reference.hertz_line_load(a, period) - load)
        assert reference.mixed_mode_line(a, angle, parameter,
                                         period=period) == pytest.approx((load, 0.6), abs=1e-10)
        assert strength > 0.6
        widths.append(a)
    # the less mode II counts, the wider the contact; without it, JKR's
    assert widths == sorted(widths) and widths[-1] < widest
    assert reference.mixed_mode_line_half_width(load, 0.6, 1e-3,
                                                period=period) == pytest.approx(widest, rel=1e-3)


# ---------------------------------------------------------------- traction-separation laws

def test_peaks_are_the_extrema_of_the_laws():
    gaps = np.linspace(0, 5, 50001)
    assert reference.peak_normal_traction(7.0) == pytest.approx((7.0 * gaps * np.exp(-gaps)).max())
    assert reference.peak_tangential_traction(3.0) == pytest.approx(
        (3.0 * 2 * gaps * np.exp(-(gaps**2))).max())


def mcgarry_normal(a, b):
    return a * np.exp(-a - b * b)


def mcgarry_tangential(a, b):
    return 2 * b * np.exp(-a - b * b)


def test_works_of_separation_integrate_the_laws():
    for end in (0.7, np.e, 30.0):
        assert reference.normal_work(end) == pytest.approx(quad(lambda a: mcgarry_normal(a, 0), 0,
                                                                end)[0])
    for c in (1e-4, 9e-4, 0.5, 1.0, 2.0, 40.0):
        end = min(40, 7 / c)
        normal = quad(lambda a: mcgarry_normal(a, c * a), 0, end, epsrel=1e-12)[0]
        tangential = quad(lambda a: c * mcgarry_tangential(a, c * a), 0, end, epsrel=1e-12)[0]
        assert reference.mcgarry_proportional_work(c) == pytest.approx((normal, tangential),
                                                                       rel=1e-9)
    opened = (quad(lambda a: mcgarry_normal(a, 0), 0, 1.3)[0],
              quad(lambda b: mcgarry_tangential(1.3, b), 0, 8)[0])
    assert reference.mcgarry_sequential_work(normal_ranges=1.3) == pytest.approx(opened)
    slid = (quad(lambda a: mcgarry_normal(a, 0.6), 0, 40)[0],
            quad(lambda b: mcgarry_tangential(0, b), 0, 0.6)[0])
    assert reference.mcgarry_sequential_work(tangential_ranges=0.6) == pytest.approx(slid)
    for residual in (0.0, 0.4, 1.0):
        peak = np.sqrt(0.5)
        rising = quad(lambda b: modified_law(b, 1.0, residual), 0, peak)[0]
        excess = quad(lambda b: modified_law(b, 1.0, residual) - residual * np.sqrt(2 / np.e), peak,
                      12)[0]
        assert reference.modified_tangential_work(residual) == pytest.approx((rising, excess),
                                                                             abs=1e-9)


# ---------------------------------------------------------------- spheres, in units other than 1

SPHERE = {"contact_modulus": 3.0, "radius": 2.0}
WORK = 0.7


def sphere_lift(pressure, edge, r, breaks=()):
    """Displacement under an axisymmetric pressure, (4/(pi E*)) int p(s) s/(r+s) K ds, s = edge
    sin(t)."""
    def integrand(t):
        s = edge * np.sin(t)
        return pressure(s) * s / (r + s) * ellipkm1(((r - s) / (r + s)) ** 2) * edge * np.cos(t)

    points = sorted({0.0, np.pi / 2, *(float(np.arcsin(b / edge)) for b in (r, *breaks)
                                       if b < edge)})
    return 4 / (np.pi * SPHERE["contact_modulus"]) * integral(integrand, points)


def sphere_load(pressure, edge, breaks=()):
    return over_contact(lambda r: np.pi * abs(r) * pressure(abs(r)), edge,
                        (0.0, *breaks, *(-b for b in breaks)))


def check_sphere(pressure, contact, edge, load, approach):
    breaks = (contact,) if contact < edge else ()
    assert sphere_load(pressure, edge, breaks) == pytest.approx(load, rel=1e-6, abs=1e-7)
    for r in (1e-6, 0.5 * contact, 0.97 * contact):
        assert sphere_lift(pressure, edge, r,
                           breaks) == pytest.approx(approach - r**2 / (2 * SPHERE["radius"]),
                                                    abs=1e-6)


def test_hertz_and_jkr_spheres_carry_their_load_and_conform():
    a = 1.1
    check_sphere(lambda r: reference.hertz_sphere_pressure(r, a, **SPHERE), a, a,
                 *reference.hertz_sphere(a, **SPHERE))
    jkr = lambda r: reference.jkr_sphere_pressure(r, a, WORK, **SPHERE)
    check_sphere(jkr, a, a, *reference.jkr_sphere(a, WORK, **SPHERE))
    release = 2 * np.pi * 1e-9 * jkr(a - 1e-9) ** 2 / (2 * SPHERE["contact_modulus"])
    assert release == pytest.approx(WORK, rel=1e-3)


def test_sphere_radii_invert_and_pull_offs_are_extrema():
    assert reference.hertz_sphere(reference.hertz_sphere_radius(2.2, **SPHERE),
                                  **SPHERE)[0] == pytest.approx(2.2)
    a, load = reference.jkr_sphere_pull_off(WORK, **SPHERE)
    fold, least, load_at_fold = reference.jkr_sphere_fold(WORK, **SPHERE)
    trial = np.linspace(0.2 * a, 2 * a, 100001)
    loads, approaches = reference.jkr_sphere(trial, WORK, **SPHERE)
    assert (loads.min() == pytest.approx(load, rel=1e-8)
            and trial[loads.argmin()] == pytest.approx(a, abs=1e-3))
    assert (approaches.min() == pytest.approx(least, rel=1e-8)
            and trial[approaches.argmin()] == pytest.approx(fold, abs=1e-3))
    assert reference.jkr_sphere(fold, WORK, **SPHERE) == pytest.approx((load_at_fold, least))
    for approach in (least, 0.5 * least, 0.0, 0.3, 5.0):
        held = reference.jkr_sphere_radius_at_approach(approach, WORK, **SPHERE)
        assert held >= fold and reference.jkr_sphere(held, WORK,
                                                     **SPHERE)[1] == pytest.approx(approach,
                                                                                   abs=1e-12)
    with pytest.raises(ValueError, match="no stable"):
        reference.jkr_sphere_radius_at_approach(1.001 * least, WORK, **SPHERE)
    assert reference.dmt_sphere(reference.dmt_sphere_radius(2.2, WORK, **SPHERE), WORK,
                                **SPHERE)[0] == pytest.approx(2.2)
    assert reference.dmt_sphere_radius(-2 * np.pi * WORK * SPHERE["radius"], WORK, **SPHERE) == 0
    for applied in (load, 0.5 * load, 0.0, 4.0):
        stable = reference.jkr_sphere_radius(applied, WORK, **SPHERE)
        assert (stable >= a * (1 - 1e-7) and reference.jkr_sphere(stable, WORK, **SPHERE)[0]
                == pytest.approx(applied, abs=1e-9))


@pytest.mark.parametrize("stress, load", [(0.3, 1.0), (1.5, -4.0), (8.0, 2.0)])
def test_maugis_sphere_conforms_and_spends_the_work_of_adhesion(stress, load):
    a, c, approach = reference.maugis_sphere(load, stress, WORK, **SPHERE)
    pressure = lambda r: reference.maugis_sphere_pressure(r, a, c, stress, **SPHERE)
    check_sphere(pressure, a, c, load, approach)
    gap = c**2 / (2 * SPHERE["radius"]) - approach + sphere_lift(pressure, c, c * (1 - 1e-12), (a,))
    assert stress * gap == pytest.approx(WORK, abs=2e-5)


def maugis_parameter(stress):
    modulus = 4 * SPHERE["contact_modulus"] / 3
    return 2 * stress * (SPHERE["radius"] / (np.pi * WORK * modulus**2)) ** (1 / 3)


def test_maugis_sphere_tends_to_jkr_and_dmt():
    load, unit = 1.0, np.pi * WORK * SPHERE["radius"]
    stiff = np.array([50.0, 100.0, 200.0])
    errors = [reference.maugis_sphere(load, s, WORK, **SPHERE)[0]
              - reference.jkr_sphere_radius(load, WORK, **SPHERE) for s in stiff]
    assert slope(stiff, errors) == pytest.approx(-2, abs=0.1)
    soft = np.array([1e-6, 1e-5, 1e-4])
    limit = reference.hertz_sphere_radius(load + 2 * unit, **SPHERE)
    expected, approach = reference.dmt_sphere(limit, WORK, **SPHERE)
    assert expected == pytest.approx(load)
    a, _, approaches = np.transpose([reference.maugis_sphere(load, s, WORK, **SPHERE)
                                     for s in soft])
    assert slope(soft, a - limit) == pytest.approx(1, abs=0.05)
    assert slope(soft, approaches - approach) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("stress", [0.01, 0.1, 0.5, 2.0, 20.0])
def test_maugis_sphere_against_the_fits_of_carpick_ogletree_salmeron(stress):
    """J. Colloid Interface Sci. 211 (1999): pull-off and radius at no load, fitted to Maugis's
    solution within about 1 %."""
    maugis, unit = maugis_parameter(stress), np.pi * WORK * SPHERE["radius"]
    length = (unit * SPHERE["radius"] / (4 * SPHERE["contact_modulus"] / 3)) ** (1 / 3)
    pull_off = -7 / 4 + (4.04 * maugis**1.4 - 1) / (4.04 * maugis**1.4 + 1) / 4
    radius = 1.54 + 0.279 * (2.28 * maugis**1.3 - 1) / (2.28 * maugis**1.3 + 1)
    load, a, c, _ = reference.maugis_sphere_pull_off(stress, WORK, **SPHERE)
    assert load / unit == pytest.approx(pull_off, rel=0.02) and 0 < a < c
    assert reference.sphere_maugis_parameter(stress, WORK, **SPHERE) == pytest.approx(maugis)
    assert (reference.maugis_sphere(0.0, stress, WORK,
                                    **SPHERE)[0] / length == pytest.approx(radius, rel=0.015))
    with pytest.raises(ValueError, match="no stable"):
        reference.maugis_sphere(1.001 * load, stress, WORK, **SPHERE)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_bonded_circle_stiffness_from_cerrutis_point_force(poisson):
    """u_x = Q/(2 pi mu)[(1 - nu)/r + nu x^2/r^3] (Johnson 1985), at the centre under Q/(2 pi a
    sqrt(a^2 - r^2))."""
    a, modulus = 1.3, 3.0
    shear = modulus * (1 - poisson) / 2
    around = quad(lambda angle: (1 - poisson) + poisson * np.cos(angle) ** 2, 0,
                  2 * np.pi)[0] / (2 * np.pi * shear)
    # int dr/(2 pi a sqrt(a^2 - r^2)), r = a sin(t)
    along = quad(lambda t: 1 / (2 * np.pi * a), 0, np.pi / 2)[0]
    assert reference.bonded_circle_stiffness(a, poisson,
                                             modulus) == pytest.approx(1 / (around * along))


def test_cattaneo_sphere_grows_by_flat_punches_on_its_stick_zone():
    """d(displacement)/dQ is the compliance of the bonded circle of the present stick radius
    (Mindlin 1949)."""
    load = 4.0
    friction = 0.3
    poisson = 0.3
    state = lambda force: reference.cattaneo_sphere(load, force, friction, poisson, **SPHERE)
    for force in (1e-4, 0.4, 1.1):
        rate = derivative(lambda q: state(q)[1], force, 1e-5)
        stiffness = reference.bonded_circle_stiffness(state(force)[0], poisson,
                                                      SPHERE["contact_modulus"])
        assert rate == pytest.approx(1 / stiffness, rel=1e-6)
    assert state(0.0) == pytest.approx((reference.hertz_sphere_radius(load, **SPHERE),
                                        0)) and state(1.2)[0] < 1e-4
    stick, a = state(0.7)[0], state(0.0)[0]
    traction = lambda r: reference.cattaneo_sphere_traction(r, a, stick, friction, **SPHERE)
    assert sphere_load(traction, a, (stick,)) == pytest.approx(0.7, rel=1e-6)
    ring = 0.5 * (a + stick)
    assert traction(ring) == pytest.approx(friction * reference.hertz_sphere_pressure(ring, a,
                                                                                      **SPHERE))
    assert traction(1.01 * a) == 0


@pytest.mark.parametrize("load, tangential", [(2.0, 1.5), (-1.0, 0.7), (0.0, 3.0)])
def test_savkoor_briggs_sphere_releases_the_work_of_adhesion(load, tangential):
    """G = -(F^2/2) dC_n/dA - (Q^2/2) dC_t/dA with the flat punch's C_n = 1/(2 E* a)."""
    poisson, modulus = 0.4, SPHERE["contact_modulus"]
    a = reference.savkoor_briggs_sphere_radius(load, tangential, poisson, WORK, **SPHERE)
    normal = lambda b: 1 / (2 * modulus * b)
    shear = lambda b: 1 / reference.bonded_circle_stiffness(b, poisson, modulus)
    force = 4 * modulus * a**3 / (3 * SPHERE["radius"]) - load
    release = -(force**2 * derivative(normal, a) + tangential**2 * derivative(shear, a)) / 2 / (
        2 * np.pi * a)
    assert release == pytest.approx(WORK, rel=1e-6)
    assert a < reference.jkr_sphere_radius(load, WORK, **SPHERE)


def test_which_limit_of_a_sphere_applies():
    """Johnson & Greenwood's map, and the normal Maugis parameter of the exponential law."""
    assert reference.sphere_maugis_parameter(1 / np.e) == pytest.approx(0.415, abs=1e-3)
    one = 1 / reference.sphere_maugis_parameter(1.0)
    assert reference.maugis_sphere(0.0,
                                   5 * one)[0] == pytest.approx(reference.jkr_sphere_radius(0.0),
                                                                rel=0.01)
    assert reference.maugis_sphere_pull_off(0.1 * one)[0] == pytest.approx(-2 * np.pi, rel=0.03)


# ---------------------------------------------------------------- arguments

@pytest.mark.parametrize("call", [
    lambda: reference.hertz_line_load(-1.0),
    lambda: reference.hertz_line_load(np.array([1.0, np.nan])),
    lambda: reference.hertz_line_load(5.0, 10.0),
    lambda: reference.hertz_line_load(1.0, -10.0),
    lambda: reference.hertz_line_half_width(-1.0),
    lambda: reference.hertz_line_approach(1.0, np.inf),
    lambda: reference.ligament_force(1.0, 10.0, -1.0),
    lambda: reference.ligament_stiffness(0.0, 10.0),
    lambda: reference.jkr_line_fold(np.inf),
    lambda: reference.sinusoid_load(1.0, 10.0, 0.0),
    lambda: reference.sinusoid_approach(1.0, np.inf, 1.0),
    lambda: reference.maugis_line(1.0, 0.0),
    lambda: reference.maugis_line_pressure(0.0, 2.0, 1.0, 3.0),
    lambda: reference.maugis_line_pressure(0.0, 2.0, 6.0, 3.0, 10.0),
    lambda: reference.maugis_line_approach(1.0, 2.0, 3.0, np.inf),
    lambda: reference.maugis_line(1.0, 3.0, -1.0),
    lambda: reference.dmt_sphere_radius(-7.0),
    lambda: reference.hertz_line_half_width(1.0, -10.0),
    lambda: reference.sliding_half_width(0.0, 3.0),
    lambda: reference.uniform_slip_softening(1.0, 0.1, 1.1),
    lambda: reference.drive_critical_height(0.0, 10.0),
    lambda: reference.maugis_sphere_pressure(0.0, 1.0, 1.5, -1.0),
    lambda: reference.savkoor_briggs_sphere_load(1.0, 100.0),
    lambda: reference.savkoor_briggs_sphere_strength(-5.0),
    lambda: reference.mixed_mode_sphere_strength(0.0, 0.0),
    lambda: reference.jkr_force(1.0, -1.0),
    lambda: reference.sphere_maugis_parameter(0.0),
    lambda: reference.cattaneo_sphere_traction(0.0, 1.0, 2.0, 0.5),
    lambda: reference.cattaneo_line_traction(0.0, 1.0, 2.0, 0.5),
    lambda: reference.cattaneo_line_displacement(1.0, 0.5, -0.5, 10.0),
    lambda: reference.front_work(1.5),
    lambda: reference.fading_work(1.0, -0.1),
    lambda: reference.fading_slip(0.2, 0.3),
    lambda: reference.savkoor_briggs_ratio(0.7),
    lambda: reference.slip_zone_force(1.0, 2.0, 1.0),
    lambda: reference.slip_zone_edge_slip(1.0, 0.0, 1.0),
    lambda: reference.cattaneo_line_stick_half_width(1.0, 1.0, 0.1),
    lambda: reference.uniform_slip_force(1.0, 1.0, 0.1, 1.5),
    lambda: reference.drive_stiffness(np.inf, 1.0),
    lambda: reference.drive_stiffness(1.0, 1.0, 0.6),
    lambda: reference.mixed_mode_toughness(2.0, 0.5),
    lambda: reference.mixed_mode_line_strength(0.0, 0.0),
    lambda: reference.savkoor_briggs_line_load(1.0, 10.0),
    lambda: reference.mcgarry_sequential_work(),
    lambda: reference.mixed_mode_line_half_width(-2.0, 0.1),
    lambda: reference.jkr_line_half_width(np.nan),
    lambda: reference.jkr_line_pull_off(np.inf, -1.0),
    lambda: reference.sinusoid_half_width(0.0, np.inf, 1.0),
    lambda: reference.sinusoid_half_width(0.0, 10.0, -1.0),
    lambda: reference.rigid_cylinder_pull_off(0.0),
    lambda: reference.peak_tangential_traction(-1.0),
    lambda: reference.modified_tangential_work(-0.1),
    lambda: reference.normal_work(-1.0),
    lambda: reference.hertz_sphere(-1.0),
    lambda: reference.jkr_sphere_radius(-4.8),
    lambda: reference.jkr_sphere(1.0, radius=0.0),
    lambda: reference.maugis_sphere(0.0, -1.0),
    lambda: reference.cattaneo_sphere(1.0, 1.0, 0.5),
    lambda: reference.savkoor_briggs_sphere_radius(0.0, 10.0),
])
def test_arguments_out_of_range_are_refused(call):
    with pytest.raises(ValueError, match="."):
        call()


def test_results_have_the_shape_of_the_arguments():
    half_width = np.array([[0.5, 1.0, 1.5], [2.0, 2.5, 3.0]])
    for function in (reference.jkr_line_load, reference.ligament_force,
                     reference.jkr_line_approach):
        values = function(half_width, 20.0)
        assert values.shape == (2, 3) and values[1, 1] == function(2.5, 20.0)
    assert reference.jkr_line_pressure(half_width, 2.2).shape == (2, 3)
    assert isinstance(reference.jkr_line_half_width(1.0), float)
    assert isinstance(reference.maugis_line(1.0, 3.0)[0], float)
    assert isinstance(reference.front_onset(5.0, 0.6, 0.4)[1], float)


def test_states_of_arrays_of_loads():
    loads, forces = np.array([0.0, 1.0, 25.0]), np.array([[0.0], [0.5]])
    widths = reference.jkr_line_half_width(loads, 100.0)
    assert widths.shape == (3,) and widths[2] == reference.jkr_line_half_width(25.0, 100.0)
    inner, outer = reference.maugis_line(loads, 3.0)
    assert (inner[1], outer[1]) == reference.maugis_line(1.0, 3.0)
    sheared = reference.mixed_mode_line_half_width(loads, forces, 0.5, period=100.0)
    assert sheared.shape == (2, 3) and sheared[1, 2] == reference.mixed_mode_line_half_width(
        25.0, 0.5, 0.5, period=100.0
    )
    assert reference.maugis_sphere(loads, 1.0)[2][1] == reference.maugis_sphere(1.0, 1.0)[2]


def test_every_solution_is_tested_and_has_its_conditions():
    text = "".join(path.read_text(encoding="utf-8")
                   for path in Path(__file__).parent.glob("test_reference*.py"))
    assert not [name for name in reference.__all__ if not re.search(rf"reference\.{name}\b", text)]
    assert len(reference.__all__) == len(set(reference.__all__)) > 70
    for name in reference.__all__:
        function = getattr(reference, name)
        assert function.__module__.startswith("contactsnes.reference.") and function.__doc__, name
