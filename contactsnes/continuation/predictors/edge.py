"""Prediction that follows what moves: edges of contact and fronts of slip."""

from ..points import lagrange_weights
from .predictor import Predictor


class Edge(Predictor):
    """The parabola through the last three states, in coordinates that follow the contact's edge.

    The tangent where there is one point, or none of them has an edge; along the arc the parabola of
    states as they are.
    """

    name = "edge"
    meaning = "follows contact edges and slip fronts, where there are any"
    order = 3
    retry = "tangent"

    def state(self, system, points, places, place, tangent=None):
        """As of `Predictor.state`."""
        points, weights = points[-3:], lagrange_weights(places[-3:], place)
        followed = system.follow_edge(points, weights) if len(points) > 1 else None
        if followed is not None:
            return followed
        return system.extrapolate(points, weights) if tangent is None else tangent()
