"""What a predictor is: the contract of all files of this folder."""

from ..points import lagrange_weights


class Predictor:
    """How the state at which a solve begins is foretold from the last points of a branch.

    Attributes
    ----------
    name : of ``-continuation_predictor``; "" of a base of others
    meaning : phrase for the help, or ""
    order : power of the step by which its error falls, and the number of points of a polynomial
        that is as exact: along the arc so many, at least two, give the position
    retry : name of the predictor of the steps that are tried again after it has failed; "": its own
    """

    name = ""
    meaning = ""
    order = 2
    retry = ""

    def state(self, system, points, places, place, tangent=None):
        """The state foretold at a place from the last points, one at least.

        Parameters
        ----------
        system : System
        points : points of the branch, oldest first
        places : where they lie, numbers: positions in the leg, or lengths along the branch
        place : where the state is wanted
        tangent : function () -> state there by the branch's tangent at the last point, at the cost
            of a linear solve; None along the arc, where points are two at least
        """
        raise NotImplementedError


def through(system, points, places, place):
    """The state at a place by the polynomial through points, each component on its own; of a single
    one its state itself, by which steps know that nothing was foretold.

    Parameters
    ----------
    system : System
    points, places, place : as of `Predictor.state`
    """
    if len(points) == 1:
        return points[0].state
    return system.extrapolate(points, lagrange_weights(places, place))


def moved_on(system, points, places, place):
    """The same in coordinates that follow edges of contact and fronts of slip, where there are any.

    Parameters
    ----------
    system, points, places, place : as of `Predictor.state`
    """
    weights = lagrange_weights(places, place)
    followed = system.follow_edge(points, weights)
    return system.extrapolate(points, weights) if followed is None else followed
