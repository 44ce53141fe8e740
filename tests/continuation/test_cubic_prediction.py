"""The cubic that foretells states without an edge to follow, on fields known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from contactsnes.continuation.predictors import PREDICTORS

COEFFICIENTS = np.random.default_rng(7).standard_normal((4, 5))
PLACES = np.array([0.1, 0.25, 0.3, 0.42])
"""Steps of different lengths, as load steps are."""


class Fields:
    """Fields as arrays, of contacts without an edge that could be followed."""

    @staticmethod
    def follow_edge(points, weights):
        return None

    @staticmethod
    def extrapolate(points, weights):
        return sum(weight * point.state for point, weight in zip(points, weights))

    @staticmethod
    def missed(guess, state):
        return float(np.sqrt(np.mean((guess - state) ** 2)))


def foretold(field, places, place):
    """State at a place by the predictor; a string where it asks for the tangent."""
    points = [SimpleNamespace(state=field(one)) for one in places]
    return PREDICTORS["edge"].state(Fields, points, list(places), place, lambda: "tangent")


def wave(place):
    return np.exp(place * np.arange(1.0, 4.0))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_fields_of_degree_below_the_number_of_points_are_exact(count):
    """Of steps of any length."""
    def field(place):
        return COEFFICIENTS[:count].T @ place ** np.arange(count)

    # short steps: where the last one was missed by much the tangent would be taken
    places = 0.1 * PLACES[-count:]
    slow = foretold(lambda place: field(1.0 + place), places, 0.06)
    assert slow == pytest.approx(field(1.06), rel=1e-9)


def test_points_before_the_last_four_do_not_matter():
    def field(place):
        return COEFFICIENTS.T @ place ** np.arange(4) + 1e3 * (place < 1.0)

    assert foretold(field, [0.99, *(1.0 + 0.1 * PLACES)], 1.06) == pytest.approx(
        COEFFICIENTS.T @ 1.06 ** np.arange(4), rel=1e-9)


def test_halving_the_step_divides_the_error_by_sixteen():
    errors = [Fields.missed(foretold(wave, 0.5 + step * np.arange(-3.0, 1.0), 0.5 + step),
                            wave(0.5 + step)) for step in (0.02, 0.01)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.15)


@pytest.mark.parametrize("jump, answer", [(0.2, False), (1.0, True)])
def test_the_tangent_is_taken_where_the_last_point_was_missed(jump, answer):
    """A straight line whose last state lies ``jump`` steps beside it, which is missed by
    jump/(1 + jump) of the last step's way: 1/6 and 1/2."""
    def field(place):
        return np.array([place + (0.1 * jump if place > 0.35 else 0.0)])

    state = foretold(field, [0.1, 0.2, 0.3, 0.4], 0.5)
    assert (isinstance(state, str) and state == "tangent") is answer


def test_one_point_has_its_tangent():
    assert foretold(wave, [0.5], 0.6) == "tangent"
