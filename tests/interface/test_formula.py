"""Formulas of laws: tangents against analytic ones and differences, corners, no slip, what is
wrong."""

import copy
import pickle

import numpy as np
import pytest

from contactsnes import InputError, Law, option
from contactsnes.interface import own_laws
from contactsnes.interface.formula import Formula, Tractions
from contactsnes.interface.laws.coupled import SLIP, TANGENTIAL_PEAK
from contactsnes.interface.laws.dugdale import Dugdale
from contactsnes.interface.laws.mcgarry import McGarry
from contactsnes.interface.laws.modified import Modified
from contactsnes.interface.laws.pressure_friction import PressureFriction
from contactsnes.interface.laws.xu_needleman import XuNeedleman

LAWS = (McGarry(), Modified(), Modified(0.3, 0.2), Dugdale(0.5, 0.2, 0.4),
        PressureFriction(0.5, 0.2, 0.7), XuNeedleman(0.4, 0.5))
every_law = pytest.mark.parametrize("law", LAWS, ids=repr)


def gaps(components, lowest=-6.0, count=400):
    """Gaps on both sides of no gap, with slips of all sizes and none."""
    rng = np.random.default_rng(components)
    slip = rng.normal(size=(components - 1, count))
    slip *= rng.uniform(0.0, 6.0, count) / np.linalg.norm(slip, axis=0) if components > 1 else 1.0
    slip[:, :20], slip[:, 20:30] = 0.0, 1e-9 * slip[:, 20:30]
    return np.vstack([rng.uniform(lowest, 8.0, count), slip])


def modified_tangent(a, b, rho, left):
    """dN/da, dN/db, dT/da, dT/db of the law modified, by hand."""
    decay, fade = np.exp(-a), np.exp(-b * b)
    apart, beyond = a > 0.0, b > SLIP
    past = b - SLIP
    drop = TANGENTIAL_PEAK * (1.0 - rho) * np.exp(-past * past)
    friction = np.where(beyond, TANGENTIAL_PEAK * rho + drop, 2.0 * b * fade)
    slope = np.where(beyond, -2.0 * past * drop, 2.0 * fade * (1.0 - 2.0 * b * b))
    return ((1.0 - a) * decay * np.where(apart, left + (1.0 - left) * fade, 1.0),
            np.where(apart, -2.0 * b * (1.0 - left) * fade * a * decay, 0.0),
            np.where(apart, -friction * decay, 0.0), slope * np.where(apart, decay, 1.0))


def test_the_tangent_of_the_law_modified():
    law = Modified(0.3, 0.2)
    a, b = np.meshgrid([-8.0, -0.1, 0.0, 1e-12, 0.4, 1.0, 3.0, 30.0],
                       [0.0, 1e-12, 0.3, SLIP, SLIP + 1e-9, 1.3, 7.0])
    gap = np.array([a.ravel(), b.ravel()])
    found = law.tangent(gap).reshape(4, -1)
    meant = np.array(modified_tangent(*gap, 0.3, 0.2))
    np.testing.assert_allclose(found, meant, rtol=1e-13, atol=1e-15)


@every_law
@pytest.mark.parametrize("components", [1, 2, 3])
def test_tangents_are_those_of_the_tractions(law, components):
    gap = gaps(components)
    step, away = 1e-6, np.abs(gap[0]) > 1e-5
    away &= np.abs(np.linalg.norm(gap[1:], axis=0) - SLIP) > 1e-5
    tangent = law.tangent(gap)
    for j in range(components):
        moved = np.zeros((components, 1))
        moved[j] = step
        difference = (law.traction(gap + moved) - law.traction(gap - moved)) / (2 * step)
        size = 1.0 + np.abs(tangent).max(axis=(0, 1))
        error = np.abs(tangent[:, j] - difference) / size
        assert error[:, away].max() < 1e-8


@every_law
def test_continued_tractions_are_linear_and_meet(law):
    edge = law.deepest
    for slip in ([], [0.4], [0.4, -1.0]):
        gap = np.array([[edge, edge - 1e-9, edge - 1.0, edge - 100.0],
                        *([value] * 4 for value in slip)])
        traction, tangent = law.traction(gap), law.tangent(gap)
        assert np.isfinite(traction).all() and np.isfinite(tangent).all()
        for k in range(1, 4):
            expected = traction[:, 0] + tangent[:, 0, 0] * (gap[0, k] - edge)
            np.testing.assert_allclose(traction[:, k], expected, rtol=1e-12, atol=1e-12)
            np.testing.assert_allclose(tangent[:, 0, k], tangent[:, 0, 0], rtol=1e-12)
    # what is continued and what is not are the same above
    gap = gaps(2, edge)
    below = np.hstack([gap, [[edge - 5.0], [0.3]]])
    np.testing.assert_array_equal(law.traction(below)[:, :-1], law.traction(gap))
    np.testing.assert_allclose(law.tangent(below)[..., :-1], law.tangent(gap), rtol=1e-13,
                               atol=1e-15)


@every_law
def test_blocks_and_single_nodes_are_alike(law):
    gap = gaps(3, count=Tractions.block + 3)
    traction, tangent = law.traction(gap), law.tangent(gap)
    for k in (0, 25, Tractions.block - 1, Tractions.block + 2):
        np.testing.assert_allclose(law.traction(gap[:, [k]])[:, 0], traction[:, k], rtol=1e-14)
        np.testing.assert_allclose(law.tangent(gap[:, [k]])[..., 0], tangent[..., k], rtol=1e-13,
                                   atol=1e-15)
    normal = law.normal(gap[0])
    np.testing.assert_array_equal(normal[0], law.traction(gap[:1])[0])
    np.testing.assert_array_equal(normal[1], law.tangent(gap[:1])[0, 0])
    first = law.normal(gap[0, :10])
    law.normal(gap[0, 10:20])
    np.testing.assert_array_equal(first[0], normal[0][:10])
    assert law.traction(np.empty((2, 0))).shape == (2, 0)


class Cone(Law):
    """Friction b / (1 + b) whose secant falls linearly from its value at no slip."""

    steep = option(1.0, "steepness (law Cone)", minimum=0)
    gap_corners, slip_range = (0.0,), 6.0

    def tractions(self, a, b):
        return a * np.exp(-a), self.steep * np.exp(-np.maximum(a, 0.0)) / (1.0 + self.steep * b)


@pytest.mark.parametrize("tiny", [0.0, 1e-300, 1e-170, 1e-150, 1e-80, 1e-9])
def test_a_cone_at_no_slip(tiny):
    """d(b/(1 + b))/db = 1 there, although dS/db over b has no limit."""
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        tangent = Cone().tangent(np.array([[0.0], [tiny], [-0.5 * tiny]]))[..., 0]
    np.testing.assert_allclose(tangent[1:, 1:], np.eye(2), atol=1e-8)
    np.testing.assert_allclose(tangent[0], [1.0, 0.0, 0.0], atol=1e-15)


def test_options_are_symbols_and_other_numbers_follow():
    assert Cone(0.7).formula.parameters == ("steep",) and Cone(0.7).formula.values == (0.7,)
    law = Dugdale(dugdale_width=0.3)
    assert law.formula.parameters[-1] == "end" and law.formula.values[-1] == law.end
    # a law that asks Python about its options is traced with their values
    asking = type("Asking", (Cone,), {
        "tractions": lambda self, a, b: (a * np.exp(-a), b * 0.0 + max(self.steep, 0.2))})(0.7)
    assert asking.formula.parameters == ()
    assert asking.traction(np.array([[0.0], [2.0]]))[1, 0] == 2.0 * 0.7


def test_a_formula_follows_its_law():
    law = Cone(0.5)
    gap = np.array([[0.3], [1.0]])
    before = law.traction(gap)[1, 0]
    law.steep = 1.0
    assert law.traction(gap)[1, 0] == pytest.approx(before * 1.5)
    for other in (copy.copy(law), copy.deepcopy(law), pickle.loads(pickle.dumps(Modified(0.3)))):
        other.evaluate(gap, np.empty_like(gap))
    assert Formula(law).values == (1.0,)


def test_laws_with_an_evaluate_of_their_own_have_no_formula():
    class Doubled(Cone):
        def evaluate(self, gap, traction, tangent=None):
            super().evaluate(gap, traction, tangent)
            traction *= 2.0
            if tangent is not None:
                tangent *= 2.0
            return traction

    law = Doubled()
    own_laws.check(law, "Doubled", in_file=False)
    assert law.formula is None and law.normal(np.array([1.0]))[0] == 2.0 * np.exp(-1.0)
    with pytest.raises(NotImplementedError, match="neither tractions.a, b. nor evaluate"):
        Law().traction(gaps(1))


def law_of(tractions, **declared):
    return type("Mine", (Cone,), {"tractions": tractions, **declared})()


def test_a_law_without_tractions_is_bad_input():
    with pytest.raises(InputError, match="neither tractions.a, b. nor evaluate.*give it one of"):
        own_laws.check(type("Bare", (Law,), {})(), "own.py:Bare")


def test_a_law_that_has_tractions_alone_is_checked():
    own_laws.check(Cone(), "Cone")
    own_laws.check(law_of(lambda self, a, b: (
        np.where(a > 0.0, a, np.expm1(a)) * np.exp(-np.abs(a)),
        np.exp(-np.maximum(a, 0.0)) * np.where(b > 0.0, np.tanh(b) / b, 1.0)),
        deepest=-1.9, repulsion=5.0), "Mine", in_file=False)


@pytest.mark.parametrize("tractions, words", [
    (lambda self, a, b: (a * np.exp(-a), np.tanh(b) / b),
     r"no finite S = T/b at .* the slip 0 .ranges.: divide.tanh.b., b. has the arguments 0, 0"),
    (lambda self, a, b: (a * np.exp(-a) + 1.0 / (a - 0.7), 1.0 + 0.0 * b),
     r"no finite N at the normal gap 0.7 .*: divide.1, subtract.a, 0.7.. has the arguments 1, 0"),
    (lambda self, a, b: (a * np.exp(-a), np.sqrt(np.maximum(1.0 - b, 0.0))),
     r"no finite .dS/db./b at .* the slip 1 .*: divide.0.5, sqrt"),
    (lambda self, a, b: (a * np.exp(-a), np.where(b > 1.0, np.nan, 1.0)),
     r"no finite S = T/b at .* the slip [^:]*: nan stands there; choose by np.where"),
    (lambda self, a, b: (a * np.exp(-a), np.random.rand() + 0.0 * b), "other values"),
    (lambda self, a, b: (a if a > 0 else -a, b), "np.where.*or write evaluate"),
    (lambda self, a, b: (np.cumsum(a), b), "function cumsum.*or write evaluate"),
    (lambda self, a, b: a * np.exp(-a), "two values"),
    (lambda self, a, b: (undefined, b), "NameError")])  # noqa: F821
def test_what_is_wrong_with_tractions_is_told(tractions, words):
    with pytest.raises(InputError, match=words) as error:
        own_laws.check(law_of(tractions), "Mine")
    assert "Mine" in str(error.value)


def test_laws_may_be_used_in_threads():
    from concurrent.futures import ThreadPoolExecutor

    law, fields = Modified(0.3, 0.2), [gaps(2, count=3000) * (1.0 - 0.1 * i) for i in range(4)]
    expected = [law.tangent(gap) for gap in fields]
    with ThreadPoolExecutor(4) as pool:
        for gap, meant in zip(fields * 20, pool.map(law.tangent, fields * 20)):
            np.testing.assert_array_equal(meant, next(
                value for value, one in zip(expected, fields) if one is gap))
