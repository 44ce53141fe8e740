"""The laws of Xu and Needleman, of Dugdale and Maugis smoothed, and with friction that grows with
pressure."""

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

from contactsnes import Branch, InputError, Load, Scene
from contactsnes.interface import laws
from contactsnes.interface.laws.dugdale import Dugdale
from contactsnes.interface.laws.modified import Modified
from contactsnes.interface.laws.pressure_friction import PressureFriction
from contactsnes.interface.laws.xu_needleman import XuNeedleman

EXAMPLES = (XuNeedleman(), XuNeedleman(0.6, 0.0), XuNeedleman(0.4, 0.5), Dugdale(),
            Dugdale(0.5, 0.2, 0.4), PressureFriction(), PressureFriction(0.5, 0.2, 0.7))
PEAK = np.sqrt(2 / np.e)


def at(law, *gap):
    return law.traction(np.array(gap, dtype=float).reshape(-1, 1))[:, 0]


@pytest.mark.parametrize("law", EXAMPLES, ids=repr)
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("components", [2, 3])
def test_taylor_remainder_is_of_second_order(law, side, components):
    rng = np.random.default_rng(components)
    gap = np.vstack([side * rng.uniform(0.1, 1.2, 40), rng.uniform(0.8, 1.6, (components - 1, 40))])
    direction = rng.normal(size=gap.shape)
    direction /= np.linalg.norm(direction, axis=0)
    start, change = law.traction(gap), np.einsum("ijn,jn->in", law.tangent(gap), direction)
    steps = 0.01 * 0.5 ** np.arange(1, 7)
    left = [np.linalg.norm(law.traction(gap + h * direction) - start - h * change) for h in steps]
    assert np.polyfit(np.log(steps), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("law", EXAMPLES, ids=repr)
def test_work_of_adhesion_and_peaks(law):
    work = quad(lambda a: at(law, a)[0], 0, 3)[0] + quad(lambda a: at(law, a)[0], 3, law.range)[0]
    assert work == pytest.approx(1.0, abs=1e-10)
    a, b = np.linspace(0, law.range, 100001), np.linspace(0, 5, 100001)
    normal, slope = law.normal(a)
    assert law.normal_peak == pytest.approx(normal.max(), rel=1e-5)
    assert law.softening == pytest.approx(-slope.min(), rel=1e-4)
    gap = np.array([0 * b, b])
    tangential = law.traction(gap)[1]
    assert law.tangential_peak == pytest.approx(tangential.max(), rel=1e-8) == pytest.approx(PEAK)
    first = b[np.argmax(tangential >= tangential.max() * (1 - 1e-10))]
    assert law.slip_peak == pytest.approx(first, abs=1e-4)
    assert law.slip_softening == pytest.approx(-law.tangent(gap)[1, 1].min(), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("law", [law for law in EXAMPLES if not isinstance(law, PressureFriction)],
                         ids=repr)
def test_potentials_have_the_tractions_for_derivatives(law):
    ratio = getattr(law, "xu_needleman_q", 1.0)
    gap = np.array([[-0.8, -0.3, 0.2, 0.9, 2.0], [0.3, 0.9, 0.4, 1.2, 0.1]])
    if isinstance(law, Modified):
        assert law.potential(gap) is None
        gap[1, gap[0] > 0] = 0.0
    step = 1e-5
    for i, size in enumerate((1.0, ratio)):
        moved = np.zeros_like(gap)
        moved[i, gap[0] < 0 if i and isinstance(law, Modified) else slice(None)] = step
        slope = (law.potential(gap + moved, ratio) - law.potential(gap - moved, ratio)) / (2 * step)
        expected = size * law.traction(gap)[i]
        np.testing.assert_allclose(slope, np.where(moved[i] > 0, expected, 0.0), rtol=1e-6,
                                   atol=1e-6)
    assert law.potential(np.array([[law.range], [0.0]]), ratio)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("q, r", [(1.0, 0.0), (0.6, 0.0), (0.4, 0.5)])
def test_xu_and_needlemans_formulas(q, r):
    """Eqs. of 1993 with phi_n = delta_n = delta_t = 1; no work around a closed cycle of gap and
    slip."""
    for a, b in ((0.7, 0.4), (-0.2, 1.1), (1.5, -0.8)):
        fade, open_ = np.exp(-b * b), np.exp(-a)
        normal = open_ * (a * fade + (1 - q) / (r - 1) * (1 - fade) * (r - a))
        tangential = 2 * b * (q + (r - q) / (r - 1) * a) * open_ * fade
        assert at(XuNeedleman(q, r), a, b) == pytest.approx([normal, tangential / q], rel=1e-13)
    law = XuNeedleman(q, r)
    A = 1.2
    B = 0.6
    around = (quad(lambda a: at(law, a, 0)[0] - at(law, a, B)[0], 0, A)[0]
              + q * quad(lambda b: at(law, A, b)[1] - at(law, 0, b)[1], 0, B)[0])
    assert around == pytest.approx(0.0, abs=1e-12)
    assert law.potential(np.array([[0.5], [0.5]]), 2 * q) is None


def test_a_narrow_dugdale_law_is_a_step():
    law = Dugdale(dugdale_width=0.01)
    a = np.array([0.1, 0.5, 0.9, 1.2])
    np.testing.assert_allclose(law.traction(a[None])[0], [1, 1, 1, 0], atol=1e-4)
    assert law.end == pytest.approx(1.01, abs=1e-6)
    assert law.softening == pytest.approx(1 / (4 * 0.01), rel=1e-2)
    with pytest.raises(InputError,
                       match="-scene_dugdale_width is '0': allowed is a number at least 0.01"):
        Dugdale(dugdale_width=0)


def test_pressed_friction_is_that_of_its_formula():
    law = PressureFriction(1.0, 0.0, 0.5)
    for a in (-0.5, -2.0):
        normal, tangential = at(law, a, 3.0)
        assert tangential == pytest.approx(PEAK + 0.5 * -normal, rel=1e-13)
    for a in (0.0, 0.4):
        assert at(law, a, 3.0) == pytest.approx(at(Modified(), a, 3.0), rel=1e-13)
    assert law.potential(np.array([[-1.0], [0.1]])) is None
    assert law.potential(np.array([[-1.0], [0.0]])) == Modified().potential(
        np.array([[-1.0], [0.0]]))


SMALL = {"points": 256, "period": 20.0, "normal_maugis": 1.0, "height": 50.0}


def test_sliding_under_pressure_follows_amontons_and_a_constant():
    """Where all has slid the force is tau_0 times what is held, and alpha times the compressive
    force."""
    scene = Scene(law="pressure_friction", pressure_friction=0.5, **SMALL)
    *_, point = branch = list(Branch(scene, load := Load("normal_displacement=3",
                                                         "tangential_displacement=90")))
    contact = Branch(scene, load).contact
    field = contact.extended(point.state)
    a, slip = (field[0] + contact.initial_gap.reshape(field[0].shape)), np.abs(field[1])
    assert slip.min() > 1.0 and a.min() < -0.2 and branch
    expected = PEAK * np.exp(-np.maximum(a, 0)).sum() + 0.5 * (-a * np.exp(-a))[a < 0].sum()
    assert point.forces[1] == pytest.approx(expected * contact.grid.node_area, rel=1e-6)


@pytest.mark.parametrize("options", [{"law": "xu_needleman", "xu_needleman_q": 0.8,
                                      "work_ratio": 0.8}, {"law": "dugdale", "dugdale_width": 0.2},
                                     {"law": "pressure_friction"}],
                         ids=lambda options: options["law"])
def test_branches_with_balanced_energies(options):
    """Work of loads is what body and interface take up, along steps that are small."""
    branch = Branch(Scene(**options, **SMALL), Load("normal_displacement=0.5",
                                                    "normal_displacement=-0.5"))
    points = list(branch)
    energies = np.array([point.elastic_energy + point.interfacial_energy for point in points])
    displacements = np.array([point.displacements[0] for point in points])
    forces = np.array([point.forces[0] for point in points])
    assert len(points) > 10 and not np.isnan(energies).any()
    work = trapezoid(forces, displacements)
    assert abs(work) > 1e-3 and energies[-1] - energies[0] == pytest.approx(work, rel=5e-3)
    assert laws.of(branch.scene).name == options["law"] == branch.attributes()["law"]


def test_a_narrow_end_of_the_attraction_is_pressed_through():
    """In a window just as wide as the attraction Newton's steps end on other equilibria, and no
    step is short enough."""
    scene = Scene(law="dugdale", normal_maugis=4.0, tangential="off", height=50.0, period=30.0,
                  points=8192)
    points = list(Branch(scene, Load(path="normal_force=1")))
    assert points[-1].forces[0] == pytest.approx(1.0) and len(points) < 30
