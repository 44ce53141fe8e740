"""The base of shapes: what a shape declares of its gap, and defaults of the rest.

Lengths along the interface in beta, gaps in u_n,r = beta^2/R. The apex, the place that windows and
symmetry are about, is the origin; node i of N lies at (i - N/2) L/N.
"""

from ...grid.cell import Grid
from ..declared import Declared
from ..gap import curvatures, evaluated

SAMPLES = {1: 4096, 2: 512}
"""Nodes of a direction on which a curvature that is not declared is found, by dimension."""

NEAR = 40.0
"""Ranges of the law above the lowest place within which a curvature counts: there the law acts on
bodies that just touch."""


class Shape(Declared):
    """The initial gap between the undeformed body and the flat. A subclass has to have ``gap``;
    what it claims besides is looked at on the nodes, and a claim that does not hold is refused.

    Attributes
    ----------
    even : directions (0 for x, 1 for y) in which it claims to be even about the apex. None is the
        default; states are halved only where the nodes themselves show it
    convex : whether it claims to be convex within the cell (one summit); None where that is not
        known, and found out on the nodes
    uniform : directions along which nothing varies: there is no edge of contact, and any grid
        resolves it
    apart : whether a contact that reaches the edge of the cell, where the body meets its neighbour,
        is refused
    gridded : whether it is known on one grid only, that of ``points``
    by_nodes : whether its gap at a node hangs on that node's place alone, so that parts of a cell
        may be asked for
    by_rows : whether it has its gap on some rows of a grid by itself (``rows``), of any other shape
        that is not ``by_nodes`` all of a cell is asked for
    uses_radius : whether a scene in SI needs a radius for it: its gap, or a default of it, is in
        units of the radius of curvature
    parabola : dimension of the interface -> c such that the gap is nowhere below c |x|^2/2, on an
        unbounded flat, too: it may then be an isolated contact (-scene_period inf)
    """

    even = ()
    convex = None
    uniform = ()
    apart = False
    gridded = False
    by_nodes = False
    by_rows = False
    uses_radius = True
    parabola = {}

    def gap(self, coordinates, scene):
        """The gap, u_n,r, on nodes; its lowest place should be 0.

        Parameters
        ----------
        coordinates : tuple of ndarray, one a direction, beta, to broadcast
        scene : Scene, for its ``periods`` (beta), ``dimension``

        Returns
        -------
        array that broadcasts to the nodes
        """
        raise NotImplementedError(f"the shape {type(self).__name__} has no gap(coordinates, scene)")

    def rows(self, grid, scene):
        """The gap, u_n,r, at the nodes of a cell's grid that are in this process, where it is
        ``by_rows``."""

    @classmethod
    def completed(cls, values, scene):
        """Values of a scene's options as they are typed, with what the shape adds to them.

        Parameters
        ----------
        values : mapping of options that are given
        scene : class of the scene
        """
        return values

    def curvature(self, scene):
        """Largest curvature of the gap in each direction, u_n,r/beta^2, a tuple: where bodies come
        near, it decides with the law how fine a grid an accuracy takes.

        By default it is found on `SAMPLES` nodes, within `NEAR` ranges above the lowest one.
        """
        grid = Grid((SAMPLES[scene.dimension],) * scene.dimension, scene.periods)
        gap = evaluated(self, grid.coordinates(), scene)
        return curvatures(gap, grid, NEAR / scene.normal_maugis)

    def check(self, scene):
        """InputError unless a scene has what the shape needs, and a cell that it fits into."""

    def check_grid(self, scene):
        """InputError if the grid of a scene, where it is known, is too coarse for the shape."""

    def too_near(self):
        """What to try where a contact that is ``apart`` reaches the edge of its cell, in words."""
        return "take a longer period"

    def points(self, scene):
        """Points of the only grid that it is known on, a tuple, where it is ``gridded``."""

    def heights(self, scene, grid=None):
        """Heights from a file, u_n,r, of which archives keep a checksum; on a grid those at its
        nodes that are here. None where there are none."""

    def source(self, scene):
        """Where heights come from, as it is typed: option and value, where it is ``gridded``."""

    def shortest(self, scene):
        """Length that all it is made of is longer than, beta: a grid has two nodes within it."""
        return 0.0

    def memory(self, scene):
        """Bytes that it takes to compute the gap, besides arrays of the grid."""
        return 0

    def smooth(self, scene):
        """The scene with the smooth shape that this one is rough on; itself where there is
        none."""
        return scene

    def filled(self, scene):
        """Name -> value of its options that have a default of the scene's making, in the scene's
        own units; tuples for directions."""
        return {}

    def about(self, scene, size):
        """Lines on what it is made of; ``size(value, unit, digits)`` puts a value in words."""
        return []
