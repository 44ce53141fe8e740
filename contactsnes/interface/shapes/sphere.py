"""The sphere."""

from ...options.fields import InputError
from .parabola import Parabola


class Sphere(Parabola):
    """r^2/2, on planes."""

    name, meaning = "sphere", "r^2/2"
    parabola = {2: 1.0}

    def gap(self, coordinates, scene):
        """(x^2 + y^2)/2."""
        return sum(x**2 for x in coordinates) / 2

    def check(self, scene):
        """InputError on a line, or in contact at the edge of the cell."""
        if scene.dimension == 1:
            raise InputError("-scene_geometry is 'sphere': it needs two dimensions; "
                             "add -scene_dimension 2 or take cylinder")
        super().check(scene)
