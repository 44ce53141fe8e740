"""No prediction: the last state."""

from .predictor import Predictor, through


class LastState(Predictor):
    """The state of the last point; along the arc, which needs a direction, the secant."""

    name = "none"
    order = 1

    def state(self, system, points, places, place, tangent=None):
        """As of `Predictor.state`."""
        if tangent is None:
            return through(system, points[-2:], places[-2:], place)
        return points[-1].state
