"""Prediction by the last two points."""

from .predictor import Predictor, through


class Secant(Predictor):
    """The straight line through the states of the last two points; of a single one its state."""

    name = "secant"

    def state(self, system, points, places, place, tangent=None):
        """As of `Predictor.state`."""
        return through(system, points[-2:], places[-2:], place)
