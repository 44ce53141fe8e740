"""The cylinder."""

from .parabola import Parabola


class Cylinder(Parabola):
    """x^2/2: along y on a two-dimensional interface."""

    name, meaning = "cylinder", "x^2/2, in two dimensions along y"
    uniform = (1,)
    parabola = {1: 1.0}

    def gap(self, coordinates, scene):
        """x^2/2."""
        return coordinates[0] ** 2 / 2
