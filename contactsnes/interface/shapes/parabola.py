"""Bodies of parabolic surface: a base, and no shape itself."""

import math

from ...options.fields import InputError, as_text
from .shape import Shape


class Parabola(Shape):
    """A parabola of curvature 1 in the directions that are not uniform, which is to stay out of
    contact at the edge of its cell."""

    even = (0, 1)
    convex = True
    apart = True
    by_nodes = True

    def curvature(self, scene):
        """1 in every direction."""
        return (1.0,) * scene.dimension

    def check(self, scene):
        """InputError unless it is out of contact at the edge of the cell: L^2/8 + offset >=
        threshold."""
        needed = 8 * (scene.contact_gap - scene.gap_offset)
        periods = [period for axis, period in enumerate(scene.periods) if axis not in self.uniform]
        if any(period ** 2 < needed for period in periods):
            smallest = scene.told(math.ceil(1e3 * math.sqrt(needed)) / 1e3, "beta")
            raise InputError(f"-scene_period is '{as_text(scene.as_typed('period'))}': the "
                             f"{self.name} would be in contact up to the "
                             "edge of the cell; the smallest period allowed "
                             f"here is {smallest:.6g}")
