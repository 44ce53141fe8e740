"""Limits and balances of the estimates for sheared contacts, and small contacts that follow them."""

import numpy as np
import pytest
from scipy.integrate import quad

from contactsnes import Branch, Load, Scene, reference
from contactsnes.laws import LAWS


@pytest.mark.parametrize("residual", [0.0, 0.3, 0.5, 1.0])
def test_front_work_integrates_the_law(residual):
    law = LAWS["modified"](residual, 0.0)

    def excess(slip):
        return law.traction(np.array([[0.0], [slip]]))[1, 0] - residual * reference.peak_tangential_traction(1.0)

    work = quad(excess, 0, np.sqrt(0.5))[0] + quad(excess, np.sqrt(0.5), 12)[0]
    assert reference.front_work(residual) == pytest.approx(work, rel=1e-8)


def test_front_force_has_the_brittle_strength_and_the_slip_zone_as_limits():
    assert reference.front_force(5.0, 5.0, 0.0, 0.7) == pytest.approx(reference.ligament_force(5.0, work_of_adhesion=0.7))
    assert reference.front_force(5.0, 2.0, 0.8, 0.0) == pytest.approx(reference.slip_zone_force(5.0, 2.0, 0.8))
    with pytest.raises(ValueError, match="work_of_adhesion"):
        reference.front_force(5.0, 2.0, 0.8, -0.1)


def test_front_releases_its_work():
    """The energy release rate of the force at fixed displacement, from the compliance of the strip and the friction's work."""
    a, s, tau, work = 5.0, 3.0, 0.6, 0.4
    extra = reference.front_force(a, s, tau, work) - reference.slip_zone_force(a, s, tau)
    # K_II of the punch's traction at the front, from its square root.
    distance = 1e-8
    intensity = reference.ligament_traction(s - distance, s, extra) * np.sqrt(2 * np.pi * distance)
    assert intensity ** 2 / 2 == pytest.approx(work, rel=1e-6)
    # The zone of constant traction adds none.
    inside = reference.slip_zone_traction(s - distance, a, s, tau)
    assert inside * np.sqrt(2 * np.pi * distance) < 1e-3


def test_onset_is_the_largest_force_and_lies_inside():
    a, tau, work = 5.77, 4.29, 0.47
    s, force = reference.front_onset(a, tau, work)
    assert 0 < s < a
    for other in (0.9 * s, 1.1 * s):
        assert reference.front_force(a, other, tau, work) < force
    # Near the middle of a wide contact: s^(3/2) = a sqrt(2 pi G)/(4 tau).
    assert s == pytest.approx((a * np.sqrt(2 * np.pi * work) / (4 * tau)) ** (2 / 3), rel=0.02)
    assert reference.front_onset(a, 0.0, work)[1] == pytest.approx(reference.ligament_force(a, work_of_adhesion=work), rel=1e-6)


def test_front_in_a_cell():
    """A wide cell is an isolated contact; neighbours take load from the front, and the contact holds more."""
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
    assert largest < 2 * reference.jkr_line_half_width(10.0) * reference.peak_tangential_traction(0.1)


def test_small_contacts_slide_where_the_estimates_say():
    """A compliant interface: the largest force within the width that the range of the law adds. A stiff one: the fold."""
    scene = {"normal_maugis": 3.0, "points": 1024, "period": 60.0, "residual_friction": 0.5}
    for maugis, end, tolerance in ((0.1, 120.0, 0.06), (2.0, 1300.0, 0.03)):
        branch = Branch(Scene(tangential_maugis=maugis, **scene),
                        Load(start="normal_displacement=8", path=f"normal_force=6; tangential_displacement={end:g}"))
        rows = [branch.observe(point) for point in branch]
        largest, slid = max(row["tangential_force"] for row in rows), rows[-1]["tangential_force"]
        tau = 0.5 * reference.peak_tangential_traction(maugis)
        if maugis < 1:
            expected = reference.uniform_slip_onset(6.0, maugis, 60.0)[1]
        else:
            # The width over which friction acts after adhesion is gone.
            expected = reference.front_onset(0.5 * slid / tau, tau, reference.front_work(0.5))[1]
        assert largest == pytest.approx(expected, rel=tolerance)
