"""Prediction that follows what moves: edges of contact and fronts of slip."""

from ..points import lagrange_weights
from .predictor import Predictor, through

ASIDE = 0.25
"""Part of the last step's way by which its end may have missed the polynomial through the points
before it, above which another prediction is taken."""


class Edge(Predictor):
    """The parabola through the last three states, in coordinates that follow the contact's edge.

    Of many spots, or none, the cubic through the last four as they are, which costs no linear
    solve; the tangent where there is one point. Along the arc the parabola of states as they are.
    """

    name = "edge"
    meaning = "follows contact edges and slip fronts, where there are any"
    order = 3
    retry = "tangent"

    def state(self, system, points, places, place, tangent=None):
        """As of `Predictor.state`."""
        last, weights = points[-3:], lagrange_weights(places[-3:], place)
        followed = system.follow_edge(last, weights) if len(last) > 1 else None
        if followed is not None:
            return followed
        if tangent is None:
            return system.extrapolate(last, weights)
        if len(points) == 1:
            return tangent()
        if self._misled(system, points, places):
            return self._straight(system, points, places, place, tangent)
        return system.extrapolate(points[-4:], lagrange_weights(places[-4:], place))

    def _straight(self, system, points, places, place, tangent):
        """The state at a place where more points mislead.

        Parameters
        ----------
        system, points, places, place, tangent : as of `Predictor.state`
        """
        return tangent()

    def _misled(self, system, points, places):
        """Whether the last point was not where those before it had foretold it: by more than a part
        of its way."""
        if len(points) < 3:
            return False
        foretold = system.extrapolate(points[-4:-1], lagrange_weights(places[-4:-1], places[-1]))
        way = system.missed(points[-2].state, points[-1].state)
        return system.missed(foretold, points[-1].state) > ASIDE * way


class Spots(Edge):
    """The same where jumps are many, of steps that bracket them: by the secant where others take
    the tangent, a linear solve near jumps for what holds no farther than to the next one."""

    name = ""
    retry = "secant"

    def _straight(self, system, points, places, place, tangent):
        """As of `Edge`."""
        return through(system, points[-2:], places[-2:], place)


SPOTS = Spots()
