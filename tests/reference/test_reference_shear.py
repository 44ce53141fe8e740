"""Limits and balances of the estimates for sheared contacts, and small contacts that follow
them."""

import numpy as np
import pytest
from scipy.integrate import quad
from test_reference import integral

from contactsnes import Branch, Load, Scene, Steps, reference
from contactsnes.interface.laws import LAWS


@pytest.mark.parametrize("residual", [0.0, 0.3, 0.5, 1.0])
def test_front_work_integrates_the_law(residual):
    law = LAWS["modified"](residual, 0.0)

    def excess(slip):
        return (law.traction(np.array([[0.0], [slip]]))[1, 0]
                - residual * reference.peak_tangential_traction(1.0))

    work = quad(excess, 0, np.sqrt(0.5))[0] + quad(excess, np.sqrt(0.5), 12)[0]
    assert reference.front_work(residual) == pytest.approx(work, rel=1e-8)


def test_front_force_has_the_brittle_strength_and_the_slip_zone_as_limits():
    assert reference.front_force(5.0, 5.0, 0.0, 0.7) == pytest.approx(
        reference.ligament_force(5.0, work_of_adhesion=0.7)
    )
    assert reference.front_force(5.0, 2.0, 0.8,
                                 0.0) == pytest.approx(reference.slip_zone_force(5.0, 2.0, 0.8))
    with pytest.raises(ValueError, match="work -0.1"):
        reference.front_force(5.0, 2.0, 0.8, -0.1)


def test_front_releases_its_work():
    """The energy release rate of the force at fixed displacement, from the compliance of the strip
    and the friction's work."""
    a = 5.0
    s = 3.0
    tau = 0.6
    work = 0.4
    extra = reference.front_force(a, s, tau, work) - reference.slip_zone_force(a, s, tau)
    # K_II of the punch's traction at the front, from its square root.
    distance = 1e-8
    intensity = reference.ligament_traction(s - distance, s, extra) * np.sqrt(2 * np.pi * distance)
    assert intensity ** 2 / 2 == pytest.approx(work, rel=1e-6)
    # The zone of constant traction adds none.
    inside = reference.slip_zone_traction(s - distance, a, s, tau)
    assert inside * np.sqrt(2 * np.pi * distance) < 1e-3


def test_onset_is_the_largest_force_and_lies_inside():
    a = 5.77
    tau = 4.29
    work = 0.47
    s, force = reference.front_onset(a, tau, work)
    assert 0 < s < a
    for other in (0.9 * s, 1.1 * s):
        assert reference.front_force(a, other, tau, work) < force
    # Near the middle of a wide contact: s^(3/2) = a sqrt(2 pi G)/(4 tau).
    assert s == pytest.approx((a * np.sqrt(2 * np.pi * work) / (4 * tau)) ** (2 / 3), rel=0.02)
    assert reference.front_onset(a, 0.0, work)[1] == pytest.approx(
        reference.ligament_force(a, work_of_adhesion=work), rel=1e-6
    )


def test_front_in_a_cell():
    """A wide cell is an isolated contact; neighbours take load from the front, and the contact
    holds more."""
    alone, apart = reference.front_onset(5.0, 0.6, 0.4), reference.front_onset(5.0, 0.6, 0.4, 1e4)
    assert apart == pytest.approx(alone, rel=1e-5)
    assert reference.front_onset(5.0, 0.6, 0.4, 10.5)[1] > alone[1]


def test_uniform_slip_starts_as_jkr_and_ends_as_hertz():
    half_width, force = reference.uniform_slip_state(10.0, 0.0, 0.1)
    assert (half_width, force) == (pytest.approx(reference.jkr_line_half_width(10.0)), 0.0)
    half_width, force = reference.uniform_slip_state(10.0, 6.0, 0.1)
    assert half_width == pytest.approx(reference.hertz_line_half_width(10.0), rel=1e-6)
    assert force == pytest.approx(2 * half_width * reference.peak_tangential_traction(0.1))
    _, largest, slip = reference.uniform_slip_onset(10.0, 0.1)
    assert 0.3 < slip < np.sqrt(0.5)
    assert largest < 2 * reference.jkr_line_half_width(10.0) * reference.peak_tangential_traction(
        0.1)


def test_work_fades_with_the_slip():
    law = LAWS["modified"](0.5, 0.2)
    for slip in (0.3, 1.0, 6.0):
        left = quad(lambda a: law.traction(np.array([[a], [slip]]))[0, 0], 0, 40)[0]
        assert reference.fading_work(slip, 0.2) == pytest.approx(left, rel=1e-8)
    slips = np.array([0.0, 0.4, 2.0])
    np.testing.assert_allclose(reference.fading_slip(reference.fading_work(slips, 0.2), 0.2), slips,
                               atol=1e-12)
    assert reference.fading_work(reference.fading_slip(0.01)) == pytest.approx(0.01)


def test_residual_adhesion_leaves_a_jkr_contact():
    wide = reference.uniform_slip_state(10.0, 8.0, 0.1, residual_adhesion=0.3)[0]
    assert wide == pytest.approx(reference.jkr_line_half_width(10.0, work_of_adhesion=0.3))
    with pytest.raises(ValueError, match="no stable"):
        reference.uniform_slip_state(-1.5, 0.6, 0.1)
    with pytest.raises(ValueError, match="pull off"):
        reference.uniform_slip_onset(-1.0, 0.1)
    most = reference.uniform_slip_onset(5.0, 0.1, residual_adhesion=0.3)[1]
    assert most > reference.uniform_slip_onset(5.0, 0.1)[1]


def test_steepest_fall_of_uniform_slip():
    ranges = np.linspace(0.71, 4, 40001)
    force = reference.uniform_slip_force(3.0, ranges / 0.1, 0.1, 0.3)
    steepest = -np.min(np.diff(force) / np.diff(ranges / 0.1))
    assert reference.uniform_slip_softening(3.0, 0.1, 0.3) == pytest.approx(steepest, rel=1e-6)


@pytest.mark.parametrize("period", [np.inf, 12.0])
def test_friction_acts_beyond_hertz_by_the_range_of_the_law(period):
    """The integral of exp(-g/delta_n) over the gap of a contact without adhesion, by quadrature."""
    load, maugis = 6.0, np.array([20.0, 40.0, 80.0])
    a = reference.hertz_line_half_width(load, period)
    kernel = ((lambda y: np.log(abs(y))) if np.isinf(period)
              else (lambda y: np.log(abs(np.sin(np.pi * y / period)))))

    def lowered(x):
        pressed = lambda t: reference.hertz_line_pressure(a * np.sin(t), a, period) * a * np.cos(t)
        return 2 / np.pi * integral(lambda t: kernel(x - a * np.sin(t)) * pressed(t),
                                    [-np.pi / 2, np.pi / 2])

    s = np.linspace(0, 1, 201) ** 2
    gap = np.array([(a + one) ** 2 / 2 - lowered(a + one) for one in s])
    gap -= gap[0]
    added = np.array([np.sum((np.exp(-one * gap[1:]) + np.exp(-one * gap[:-1])) / 2 * np.diff(s))
                      for one in maugis])
    estimate = reference.sliding_half_width(load, maugis, period) - a
    np.testing.assert_allclose(estimate, added, rtol=0.05)
    errors = estimate / added - 1
    assert (np.diff(np.abs(errors)) < 0).all()
    assert reference.sliding_half_width(load, period=period) == pytest.approx(a)
    assert reference.sliding_force(load, 0.4, 20.0,
                                   period) == pytest.approx(0.8 * (a + estimate[0]))


@pytest.mark.parametrize("maugis, load, tolerance", [(3.0, 1.0, 0.015), (3.0, 6.0, 0.015),
                                                     (10.0, 6.0, 0.002)])
def test_small_contacts_slide_at_the_force_of_gross_sliding(maugis, load, tolerance):
    points = 4096 if maugis > 5 else 1024
    scene = Scene(normal_maugis=maugis, tangential_maugis=1.0, residual_friction=0.5, points=points,
                  period=60.0)
    branch = Branch(scene, Load(start="normal_displacement=6",
                                path=f"normal_force={load:g}; tangential_displacement=800"))
    row = branch.observe(list(branch)[-1])
    expected = reference.sliding_force(load, 0.5 * reference.peak_tangential_traction(1.0), maugis,
                                       60.0)
    assert 0 < row["tangential_force"] / expected - 1 < tolerance


# ---- the drive

def test_a_path_folds_above_the_critical_height():
    """A path whose steepest fall is known: T = sin(u), at u = pi."""
    slips = np.linspace(0, 5, 2001)
    forces = 0.3 * np.sin(slips)
    height = reference.drive_critical_height(0.3, 100.0, 0.4)
    assert reference.drive_stiffness(100.0, height, 0.4) == pytest.approx(0.3)
    for factor in (1.05, 2.0, 50.0):
        slip, force, displacement = reference.driven_fold(slips, forces, 100.0, factor * height,
                                                          0.4)
        exact = np.arccos(-1 / factor)
        assert (slip, force) == pytest.approx((exact, 0.3 * np.sin(exact)), abs=1e-5)
        assert displacement == pytest.approx(reference.driven_displacement(slip, force, 100.0,
                                                                           factor * height, 0.4),
                                             abs=1e-5)
    with pytest.raises(ValueError, match="gradually"):
        reference.driven_fold(slips, forces, 100.0, 0.999 * height, 0.4)
    with pytest.raises(ValueError, match="three points"):
        reference.driven_fold([0.0, 1.0], [0.0, 1.0], 100.0, 10.0)


def test_one_path_folds_where_a_contact_with_any_drive_does():
    """The path of a layer without a fold tells where that of a higher one has its."""
    scene = {"normal_maugis": 3.0, "tangential_maugis": 0.3, "points": 512, "period": 40.0,
             "residual_friction": 0.9}
    rows, events = {}, {}
    for height, part in ((70.0, 200), (2000.0, 20)):
        end = 10.0 + reference.driven_displacement(0.0, 1.6, 40.0, height)
        load = Load(start="normal_displacement=6",
                    path=f"normal_force=4; tangential_displacement={end:g}")
        branch = Branch(Scene(height=height, **scene), load, Steps(largest_step=(3.0, end / part)))
        points = list(branch)
        rows[height] = [branch.observe(point) for point in points]
        events[height] = [point.event for point in points]
    assert "fold" not in events[70.0]
    slips, forces = (np.array([row[name] for row in rows[70.0]])
                     for name in ("mean_tangential_displacement", "tangential_force"))
    slip, force, _ = reference.driven_fold(slips, forces, 40.0, 2000.0)
    fold = rows[2000.0][events[2000.0].index("fold")]
    assert force == pytest.approx(fold["tangential_force"], rel=1e-4)
    assert slip == pytest.approx(fold["mean_tangential_displacement"], rel=1e-3)


# ---- spheres, in units other than 1

SPHERE = {"work_of_adhesion": 0.7, "contact_modulus": 3.0, "radius": 2.0}


@pytest.mark.parametrize("parameter", [1.0, 0.6, 0.2])
def test_mixed_mode_sphere_releases_the_toughness_of_its_phase(parameter):
    """G by the compliances of the flat punch on the circle, modes by what each force releases
    alone."""
    a = 1.2
    angle = 0.7
    poisson = 0.3
    load, shear = reference.mixed_mode_sphere(a, angle, parameter, poisson, **SPHERE)
    pull, step = reference.hertz_sphere(a, 3.0, 2.0)[0] - load, 1e-4
    fall = lambda compliance: (compliance(a - step) - compliance(a + step)) / (2 * step) / 2 / (
        2 * np.pi * a)
    normal = pull**2 * fall(lambda b: 1 / (6.0 * b))
    tangential = shear**2 * fall(lambda b: 1 / reference.bonded_circle_stiffness(b, poisson, 3.0))
    assert np.arctan(np.sqrt(tangential / normal)) == pytest.approx(angle, rel=1e-6)
    assert normal + tangential == pytest.approx(0.7 * (1 + np.tan((1 - parameter) * angle) ** 2),
                                                rel=1e-6)


@pytest.mark.parametrize("load", [-5.0, 0.0, 3.0])
def test_mixed_mode_spheres_of_griffith_are_savkoor_and_briggs(load):
    for poisson in (0.5, 0.2):
        critical, strength = reference.savkoor_briggs_sphere_strength(load, poisson, **SPHERE)
        assert reference.mixed_mode_sphere_strength(load, 1.0, poisson,
                                                    **SPHERE) == pytest.approx((critical, strength),
                                                                               rel=1e-5)
        forces = strength * np.array([0.0, 0.3, 0.999])
        radii = reference.savkoor_briggs_sphere_radius(load, forces, poisson, **SPHERE)
        np.testing.assert_allclose(reference.mixed_mode_sphere_radius(load, forces, 1.0, poisson,
                                                                      **SPHERE), radii, rtol=1e-9)
        np.testing.assert_allclose(reference.savkoor_briggs_sphere_load(radii, forces, poisson,
                                                                        **SPHERE), load, atol=1e-9)
        assert radii[2] > critical
        with pytest.raises(ValueError, match="exceeds the strength"):
            reference.mixed_mode_sphere_radius(load, 1.001 * strength, 1.0, poisson, **SPHERE)
        with pytest.raises(ValueError, match="no equilibrium"):
            reference.savkoor_briggs_sphere_radius(load, 1.001 * strength, poisson, **SPHERE)
    assert reference.savkoor_briggs_ratio() == pytest.approx(1.5)


@pytest.mark.parametrize("load", [-5.0, 3.0])
def test_mixed_mode_sphere_meets_load_and_force(load):
    widest = reference.jkr_sphere_radius(load, **SPHERE)
    radii = []
    for parameter in (1.0, 0.5, 0.1):
        a = reference.mixed_mode_sphere_radius(load, 3.0, parameter, **SPHERE)
        angle = np.arctan2(np.sqrt(1.5) * 3.0, reference.hertz_sphere(a, 3.0, 2.0)[0] - load)
        assert reference.mixed_mode_sphere(a, angle, parameter,
                                           **SPHERE) == pytest.approx((load, 3.0), abs=1e-9)
        assert reference.mixed_mode_sphere_strength(load, parameter, **SPHERE)[1] > 3.0
        radii.append(a)
    assert radii == sorted(radii) and radii[-1] < widest
    # The first loss is quadratic in the force, Griffith's.
    lost = widest - reference.mixed_mode_sphere_radius(load, np.array([0.1, 0.2]), 0.5, **SPHERE)
    assert lost[1] / lost[0] == pytest.approx(4, rel=0.01)


def test_small_contacts_slide_where_the_estimates_say():
    """A compliant interface: the largest force within the width that the range of the law adds. A
    stiff one: the fold."""
    scene = {"normal_maugis": 3.0, "points": 1024, "period": 60.0, "residual_friction": 0.5}
    for maugis, end, tolerance in ((0.1, 120.0, 0.06), (2.0, 1300.0, 0.03)):
        branch = Branch(Scene(tangential_maugis=maugis, **scene),
                        Load(start="normal_displacement=8",
                             path=f"normal_force=6; tangential_displacement={end:g}"))
        rows = [branch.observe(point) for point in branch]
        largest, slid = max(row["tangential_force"] for row in rows), rows[-1]["tangential_force"]
        tau = 0.5 * reference.peak_tangential_traction(maugis)
        if maugis < 1:
            expected = reference.uniform_slip_onset(6.0, maugis, 60.0)[1]
        else:
            # The width over which friction acts after adhesion is gone.
            expected = reference.front_onset(0.5 * slid / tau, tau, reference.front_work(0.5))[1]
        assert largest == pytest.approx(expected, rel=tolerance)
