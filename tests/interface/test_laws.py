"""Laws against peaks, quadrature of their tractions, one-sided differences and Taylor's theorem.

Equations are those of "Incipient sliding of adhesive contacts" (Friction), as corrected in the
laws' docstrings. Gaps are a = g_n / delta_n and b = |g_t| / delta_t, tractions in phi_n / delta_n
and phi_t / delta_t, works in phi_n and phi_t.
"""

import numpy as np
import pytest
from scipy.special import erfc

from contactsnes.interface.laws import LAWS
from contactsnes.interface.laws.coupled import NORMAL_PEAK, SLIP, SOFTENING, TANGENTIAL_PEAK
from contactsnes.interface.laws.law import Law
from contactsnes.interface.laws.mcgarry import McGarry
from contactsnes.interface.laws.modified import Modified

CUTOFF, DEEPEST = Law.range, Law.deepest

EXAMPLES = {
    "mcgarry": McGarry(),
    "modified": Modified(),
    "no residual friction": Modified(residual_friction=0.0),
    "both residuals": Modified(residual_friction=0.3, residual_adhesion=0.2),
}
FAR = 40.0


@pytest.fixture(params=EXAMPLES, ids=lambda name: name.replace(" ", "-"))
def law(request):
    return EXAMPLES[request.param]


def gaps(normal, *slip):
    """Gaps (components, nodes) from scalars or arrays that broadcast."""
    return np.array(np.broadcast_arrays(np.atleast_1d(normal), *slip), dtype=float)


def traction(law, normal, *slip):
    return law.traction(gaps(normal, *slip))


def slope(law, normal, *slip):
    return law.tangent(gaps(normal, *slip))


def quadrature(function, *breaks, order=30, pieces=40):
    """Integral of a function of an array between the breaks, by Gauss-Legendre on pieces of each
    interval."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    total = 0.0
    for left, right in zip(breaks, breaks[1:]):
        edges = np.linspace(left, right, pieces + 1)
        half = np.diff(edges)[:, None] / 2
        points = (edges[:-1, None] + half + half * nodes).ravel()
        total += np.sum((half * weights).ravel() * function(points))
    return total


def random_gaps(components, side, beyond, count=50, seed=0):
    """Gaps on one side of a = 0 and of b = b_0, at least 0.15 away from both kinks."""
    rng = np.random.default_rng(seed + 10 * components)
    normal = side * rng.uniform(0.15, 2.5, count)
    if components == 1:
        return normal[None]
    slip = rng.uniform(SLIP + 0.15, 2.5, count) if beyond else rng.uniform(0.05, SLIP - 0.15, count)
    direction = rng.normal(size=(components - 1, count))
    return np.vstack([normal, slip * direction / np.linalg.norm(direction, axis=0)])


# Peaks, limits, steepest softening

def test_normal_peak_and_its_place(law):
    a = np.linspace(-1.0, 8.0, 90001)
    normal = traction(law, a)[0]
    assert a[np.argmax(normal)] == pytest.approx(1.0, abs=1e-4)
    assert normal.max() == pytest.approx(np.exp(-1.0), rel=1e-12)
    assert NORMAL_PEAK == pytest.approx(np.exp(-1.0), rel=1e-15)


def test_tangential_peak_and_its_place(law):
    b = np.linspace(0.0, 5.0, 500001)
    tangential = traction(law, 0.0, b)[1]
    assert tangential.max() == pytest.approx(0.857764, abs=1e-6)
    assert tangential.max() == pytest.approx(TANGENTIAL_PEAK, rel=1e-9)
    first = b[np.argmax(tangential >= TANGENTIAL_PEAK * (1 - 1e-10))]
    assert first == pytest.approx(np.sqrt(0.5), abs=2e-5)
    assert SLIP == pytest.approx(np.sqrt(0.5), rel=1e-15)


def test_unstressed_at_zero_gap(law):
    np.testing.assert_array_equal(traction(law, 0.0, 0.0, 0.0), 0.0)


def test_large_separation(law):
    assert np.all(np.abs(traction(law, CUTOFF, 0.3)) < 1e-14)
    assert np.all(np.abs(traction(law, CUTOFF, 9.0)) < 1e-14)


@pytest.mark.parametrize("a", [-2.0, 0.0, 1.5])
def test_residual_friction(a):
    shielded = np.exp(-max(a, 0.0))
    for rho in (0.0, 0.3, 1.0):
        tangential = traction(Modified(residual_friction=rho), a, FAR)[1]
        assert tangential == pytest.approx(rho * np.sqrt(2 / np.e) * shielded, rel=1e-14,
                                           abs=1e-300)
    assert traction(McGarry(), a, FAR)[1] == pytest.approx(0.0, abs=1e-300)


def test_full_residual_friction_levels_off_at_the_peak():
    b = np.linspace(SLIP, 9.0, 50)
    np.testing.assert_allclose(traction(Modified(residual_friction=1.0), -1.0, b)[1],
                               np.sqrt(2 / np.e), rtol=1e-15)


def test_residual_adhesion():
    for remnant in (0.0, 0.2, 0.9):
        sheared = Modified(residual_adhesion=remnant)
        a = np.array([0.2, 1.0, 3.0])
        np.testing.assert_allclose(traction(sheared, a, FAR)[0], remnant * a * np.exp(-a),
                                   rtol=1e-14, atol=1e-300)
        assert quadrature(lambda a: traction(sheared, a, FAR)[0], 0.0,
                          FAR) == pytest.approx(remnant, abs=1e-12)
        np.testing.assert_allclose(traction(sheared, -a, FAR)[0], -a * np.exp(a), rtol=1e-14)


def test_steepest_normal_softening(law):
    a = np.linspace(-1.0, 8.0, 90001)
    softening = slope(law, a)[0, 0]
    assert softening.min() == pytest.approx(-np.exp(-2.0), rel=1e-9)
    assert a[np.argmin(softening)] == pytest.approx(2.0, abs=1e-3)
    assert SOFTENING == pytest.approx(0.1353, abs=5e-5)


@pytest.mark.parametrize("example, steepest, place", [
    (McGarry(), -0.8925, np.sqrt(1.5)),
    (Modified(residual_friction=0.0), -0.7358, np.sqrt(2.0)),
    (Modified(residual_friction=0.4), -0.7358 * 0.6, np.sqrt(2.0)),
])
def test_steepest_tangential_softening(example, steepest, place):
    b = np.linspace(0.0, 4.0, 400001)
    softening = slope(example, 0.0, b)[1, 1]
    assert softening.min() == pytest.approx(steepest, abs=5e-5)
    assert b[np.argmin(softening)] == pytest.approx(place, abs=1e-4)


# Work of separation

def test_work_of_separation_normal(law):
    for normal_only in (lambda a: traction(law, a)[0], lambda a: traction(law, a, 0.0)[0]):
        assert quadrature(normal_only, 0.0, FAR) == pytest.approx(1.0, abs=1e-12)
        assert quadrature(normal_only, 0.0, np.e) == pytest.approx(1 - (1 + np.e) * np.exp(-np.e),
                                                                   rel=1e-12)


def test_work_of_separation_tangential():
    def work(example, *breaks, a=0.0):
        return quadrature(lambda b: traction(example, a, b)[1], *breaks)

    assert work(McGarry(), 0.0, FAR) == pytest.approx(1.0, abs=1e-12)
    for rho in (0.0, 0.3, 0.8):
        for a in (0.0, -3.0):
            example = Modified(residual_friction=rho)
            assert work(example, 0.0, SLIP, a=a) == pytest.approx(1 - np.exp(-0.5), rel=1e-12)
            excess = work(example, SLIP, FAR, a=a) - rho * TANGENTIAL_PEAK * (FAR - SLIP)
            assert excess == pytest.approx((1 - rho) * np.sqrt(np.pi / 2) * np.exp(-0.5), rel=1e-10)
    assert work(Modified(residual_friction=0.0), 0.0, SLIP, FAR) == pytest.approx(1.1536, abs=5e-5)


@pytest.mark.parametrize("c, normal_work, tangential_work",
                         [(0.5, 0.48426, 0.24213), (1.0, 0.22718, 0.45436),
                          (2.0, 0.08233, 0.65865)])
def test_work_on_straight_mixed_paths(c, normal_work, tangential_work):
    normal = quadrature(lambda a: traction(McGarry(), a, c * a)[0], 0.0, FAR)
    tangential = quadrature(lambda a: c * traction(McGarry(), a, c * a)[1], 0.0, FAR)
    rest = np.sqrt(np.pi) / (2 * c) * np.exp(1 / (4 * c**2)) * erfc(1 / (2 * c))
    assert tangential == pytest.approx(1 - rest, rel=1e-12)
    assert normal == pytest.approx((1 - rest) / (2 * c**2), rel=1e-12)
    assert (normal, tangential) == (pytest.approx(normal_work, abs=6e-6),
                                    pytest.approx(tangential_work, abs=6e-6))
    # Out of contact the modified law's adhesion fades alike, but for what is left of it.
    for remnant in (0.0, 0.25):
        modified = Modified(residual_adhesion=remnant)
        faded = quadrature(lambda a: traction(modified, a, c * a)[0], 0.0, FAR)
        assert faded == pytest.approx(remnant + (1 - remnant) * normal, rel=1e-12)


@pytest.mark.parametrize("turn", [0.3, 1.0, 2.5])
def test_work_on_broken_paths(turn):
    law = McGarry()
    normal_first = quadrature(lambda a: traction(law, a, 0.0)[0], 0.0, turn)
    tangential_last = quadrature(lambda b: traction(law, turn, b)[1], 0.0, FAR)
    assert normal_first == pytest.approx(1 - (1 + turn) * np.exp(-turn), rel=1e-12)
    assert tangential_last == pytest.approx(np.exp(-turn), rel=1e-12)
    tangential_first = quadrature(lambda b: traction(law, 0.0, b)[1], 0.0, turn)
    normal_last = quadrature(lambda a: traction(law, a, turn)[0], 0.0, FAR)
    assert tangential_first == pytest.approx(1 - np.exp(-turn**2), rel=1e-12)
    assert normal_last == pytest.approx(np.exp(-turn**2), rel=1e-12)


def test_closed_cycles_do_net_work(law):
    """Around [0, A] x [0, B], with phi_t / phi_n = 1: a law with a potential would do none."""
    A, B = 1.2, 0.6
    work = (quadrature(lambda a: traction(law, a, 0.0)[0] - traction(law, a, B)[0], 0.0, A)
            + quadrature(lambda b: traction(law, A, b)[1] - traction(law, 0.0, b)[1], 0.0, B))
    # Tractions are what they are in the first branch; the adhesion that is left does not take part.
    lost = 1 - getattr(law, "residual_adhesion", 0.0)
    adhesion, friction = 1 - (1 + A) * np.exp(-A), 1 - np.exp(-A)
    assert work == pytest.approx((1 - np.exp(-B**2)) * (lost * adhesion - friction), rel=1e-10)
    assert abs(work) > 0.05


def test_mixed_derivatives_differ():
    """phi_n/(delta_n delta_t) times the one, phi_t/(delta_n delta_t) times the other: equal only
    where phi_n a = phi_t."""
    a, b = np.array([0.3, 1.0, 2.2]), np.array([0.2, 0.5, 1.1])
    tangent = slope(McGarry(), a, b)
    np.testing.assert_allclose(tangent[0, 1], -2 * a * b * np.exp(-a - b**2), rtol=1e-14)
    np.testing.assert_allclose(tangent[1, 0], -2 * b * np.exp(-a - b**2), rtol=1e-14)
    for example in (Modified(), Modified(residual_friction=0.2)):
        overlapping = slope(example, -a, b)
        np.testing.assert_array_equal(overlapping[0, 1], 0.0)
        np.testing.assert_array_equal(overlapping[1, 0], 0.0)
        separated = slope(example, 0.3, b[:2])
        assert np.all(np.abs(separated[0, 1] - separated[1, 0]) > 0.1)


# Kinks

B = np.array([0.0, 0.4, SLIP, 1.3])


def test_tractions_are_continuous_where_contact_opens(law):
    below, above = traction(law, -1e-13, B), traction(law, 1e-13, B)
    np.testing.assert_allclose(below, above, atol=5e-13)


@pytest.mark.parametrize("remnant", [0.0, 0.2])
def test_slope_jumps_where_contact_opens(remnant):
    law = Modified(residual_friction=0.3, residual_adhesion=remnant)
    step = 1e-6
    at = traction(law, 0.0, B)
    left = (at - traction(law, -step, B)) / step
    right = (traction(law, step, B) - at) / step
    fading = remnant + (1 - remnant) * np.exp(-B**2)
    np.testing.assert_allclose(left[0], 1.0, atol=5e-6)
    np.testing.assert_allclose(right[0], fading, atol=5e-6)
    np.testing.assert_allclose(left[1], 0.0, atol=5e-6)
    np.testing.assert_allclose(right[1], -at[1], atol=5e-6)
    # The tangent takes the side of the overlap at a = 0, and either side's next to it.
    np.testing.assert_allclose(slope(law, 0.0, B)[:, 0], left, atol=5e-6)
    np.testing.assert_allclose(slope(law, 1e-9, B)[:, 0], right, atol=5e-6)
    # Derivatives with respect to slip do not jump.
    np.testing.assert_allclose(slope(law, -1e-13, B)[:, 1], slope(law, 1e-13, B)[:, 1], atol=1e-12)


def test_no_jump_without_coupling_in_overlap():
    np.testing.assert_allclose(slope(McGarry(), -1e-13, B), slope(McGarry(), 1e-13, B), atol=1e-12)


@pytest.mark.parametrize("rho", [0.0, 0.3, 1.0])
def test_friction_is_smooth_once_at_its_peak(rho):
    law = Modified(residual_friction=rho)
    step = 1e-5
    assert traction(law, 0.0, SLIP * (1 - 1e-14))[1] == pytest.approx(traction(law, 0.0,
                                                                               SLIP * (
        1 + 1e-14))[1], rel=1e-13)
    before, at, after = (slope(law, 0.0, SLIP + shift)[1, 1] for shift in (-step, 0.0, step))
    assert at == pytest.approx(0.0, abs=1e-14)
    assert (at - before) / step == pytest.approx(-4 * TANGENTIAL_PEAK, abs=1e-3)
    assert (after - at) / step == pytest.approx(-2 * (1 - rho) * TANGENTIAL_PEAK, abs=1e-3)


# Tangents

@pytest.mark.parametrize("components", [1, 2, 3])
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("beyond", [False, True])
def test_taylor_remainder_is_of_second_order(law, components, side, beyond):
    gap = random_gaps(components, side, beyond)
    direction = np.random.default_rng(5).normal(size=gap.shape)
    direction /= np.linalg.norm(direction, axis=0)
    at, change = law.traction(gap), np.einsum("ijn,jn->in", law.tangent(gap), direction)
    steps = 0.1 * 0.5 ** np.arange(1, 9)
    remainders = [np.linalg.norm(law.traction(gap + h * direction) - at - h * change)
                  for h in steps]
    order = np.polyfit(np.log(steps), np.log(remainders), 1)[0]
    assert order == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("beyond", [False, True])
def test_rotation_in_the_plane(law, side, beyond):
    gap = random_gaps(3, side, beyond)
    turn = np.eye(3)
    turn[1:, 1:] = [[np.cos(1.1), -np.sin(1.1)], [np.sin(1.1), np.cos(1.1)]]
    np.testing.assert_allclose(law.traction(turn @ gap), turn @ law.traction(gap), atol=2e-14)
    turned = np.einsum("ij,jkn,lk->iln", turn, law.tangent(gap), turn)
    np.testing.assert_allclose(law.tangent(turn @ gap), turned, atol=1e-13)


def test_slip_along_one_axis_is_that_of_a_line(law):
    gap = random_gaps(2, 1, True)
    line, plane = law.tangent(gap), law.tangent(np.vstack([gap, 0 * gap[:1]]))
    np.testing.assert_allclose(plane[:2, :2], line, atol=1e-15)
    np.testing.assert_allclose(plane[2, 2], law.traction(gap)[1] / gap[1], rtol=1e-13)
    np.testing.assert_array_equal(plane[2, :2], 0.0)
    np.testing.assert_array_equal(plane[:2, 2], 0.0)


def test_tractions_are_odd_in_slip(law):
    gap = random_gaps(2, 1, True)
    mirror = np.array([[1.0], [-1.0]])
    np.testing.assert_array_equal(law.traction(mirror * gap), mirror * law.traction(gap))


@pytest.mark.parametrize("tiny", [0.0, 1e-200, 1e-160, 1e-9])
def test_isotropic_at_zero_slip(law, tiny):
    for a in (-0.5, 0.0, 1.0):
        held = np.exp(-a) if a > 0 or isinstance(law, McGarry) else 1.0
        tangent = slope(law, a, tiny, -0.7 * tiny)[..., 0]
        np.testing.assert_allclose(tangent[1:, 1:], 2 * held * np.eye(2), atol=1e-14)
        np.testing.assert_allclose(tangent[0], [(1 - a) * np.exp(-a), 0, 0], atol=1e-8)


def test_one_component_is_zero_slip(law):
    a = np.linspace(-40.0, 40.0, 801)
    np.testing.assert_array_equal(traction(law, a)[0], traction(law, a, 0.0)[0])
    np.testing.assert_array_equal(slope(law, a)[0, 0], slope(law, a, 0.0, 0.0)[0, 0])


def test_out_and_in_place(law):
    gap = random_gaps(3, 1, False)
    out, tangent = np.full_like(gap, np.nan), np.full((3, 3, gap.shape[1]), np.nan)
    assert law.traction(gap, out) is out
    assert law.tangent(gap, tangent) is tangent
    np.testing.assert_array_equal(out, law.traction(gap))
    np.testing.assert_array_equal(tangent, law.tangent(gap))
    both = np.empty_like(gap), np.empty_like(tangent)
    law.evaluate(gap, *both)
    np.testing.assert_array_equal(both[0], out)
    np.testing.assert_array_equal(both[1], tangent)
    law.traction(gap, gap)
    np.testing.assert_array_equal(gap, out)


# Linear continuation

def test_continuation_has_continuous_slope(law):
    for slip in ([], [0.4], [0.4, -1.0]):
        near = [traction(law, DEEPEST + shift, *slip) for shift in (-1e-9, 0.0, 1e-9)]
        scale = np.exp(-DEEPEST) * abs(DEEPEST)
        np.testing.assert_allclose(near[0] / scale, near[2] / scale, atol=1e-8)
        one_sided = [slope(law, DEEPEST + shift, *slip) / scale for shift in (-1e-9, 1e-9)]
        np.testing.assert_allclose(*one_sided, atol=1e-8)


def test_continuation_is_linear(law):
    slip = np.array([[0.4], [1.0]])
    start = traction(law, DEEPEST, *slip)
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        for depth in (-1e-3, -10.0, -1e4):
            tangent = slope(law, DEEPEST + depth, *slip)
            np.testing.assert_allclose(traction(law, DEEPEST + depth, *slip),
                                       start + depth * tangent[:, 0], rtol=1e-13)
            np.testing.assert_allclose(tangent[:, 0], slope(law, DEEPEST, *slip)[:, 0], rtol=1e-13)


def test_nothing_overflows(law):
    a = np.array([-1e4, -800.0, -30.0, 0.0, 800.0, 1e4])
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        for slip in ([], [0.0], [1e3], [1e3, -2.0]):
            assert np.all(np.isfinite(traction(law, a, *slip)))
            assert np.all(np.isfinite(slope(law, a, *slip)))
        assert np.all(np.isfinite(law.energy(a)))


# Energy without slip

def test_energy_is_the_integral_of_the_traction(law):
    assert law.energy(np.array([0.0]))[0] == 0.0
    for a in (-35.0, -5.0, -0.5, 0.7, 3.0, 20.0):
        breaks = (0.0, DEEPEST, a) if a < DEEPEST else (0.0, a)
        work = quadrature(lambda gap: traction(law, gap)[0], *breaks)
        assert law.energy(np.array([a]))[0] == pytest.approx(work, rel=1e-11)
    assert law.energy(np.array([FAR]))[0] == pytest.approx(1.0, abs=1e-14)


def test_energy_has_the_traction_for_derivative(law):
    a = np.array([-31.0, -12.0, -1.0, 0.0, 0.5, 1.0, 4.0])
    step = 1e-4
    difference = (law.energy(a + step) - law.energy(a - step)) / (2 * step)
    np.testing.assert_allclose(difference, traction(law, a)[0], rtol=1e-7, atol=1e-8)


# Step in the regularised gap

def regularised(law, a, stiffness):
    """w = a + N(a) / stiffness."""
    return a + traction(law, a)[0] / stiffness


@pytest.mark.parametrize("stiffness", [0.1354, 0.2, 1.0, 5.0])
def test_regularised_step_is_the_same_step_in_another_variable(stiffness):
    law, rng = Modified(), np.random.default_rng(4)
    gap = np.concatenate([rng.uniform(-49.0, 8.0, 300), rng.uniform(-1.0, 4.0, 300),
                          [0.0, 1.0, 2.0, 500.0]])
    step = np.concatenate([rng.normal(scale=5.0, size=600), [0.0, 0.0, 1e-3, -700.0]])
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        new = gap + law.regularised_step(gap, step, stiffness)
    target = regularised(law, gap, stiffness) + (1 + slope(law, gap)[0, 0] / stiffness) * step
    # To rounding of w, and to the tolerance of a where w is steep.
    steep = 1 + slope(law, new)[0, 0] / stiffness
    assert np.all(np.abs(regularised(law, new, stiffness) - target) <= 1e-13 * np.abs(target)
                  + 1e-9 * steep)


def test_regularised_step_is_the_step_to_first_order():
    law = Modified()
    gap = np.array([-12.0, -3.0, -0.4, 0.5, 1.5, 6.0])
    sizes = 0.1 * 0.5 ** np.arange(1, 9)
    differences = [np.linalg.norm(law.regularised_step(gap, h * np.ones(6), 0.2) - h)
                   for h in sizes]
    assert np.polyfit(np.log(sizes), np.log(differences), 1)[0] == pytest.approx(2.0, abs=0.1)
    assert np.all(law.regularised_step(gap, np.zeros(6), 0.2) == pytest.approx(0.0, abs=1e-9))


def test_names_of_laws():
    assert LAWS["modified"] is Modified and LAWS["mcgarry"] is McGarry
    assert Modified().residual_friction == 1.0 and Modified().residual_adhesion == 0.0
