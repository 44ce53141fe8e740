"""The flat."""

import numpy as np

from .shape import Shape


class Flat(Shape):
    """0 everywhere."""

    name, meaning = "flat", "0"
    even = uniform = (0, 1)
    uses_radius = False
    by_nodes = True

    def gap(self, coordinates, scene):
        """0."""
        return np.zeros(1)

    def curvature(self, scene):
        """That of the length unit, since a flat has none: 1."""
        return (1.0,) * scene.dimension
