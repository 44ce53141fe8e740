"""Gaps of own-geometry.opts: a punch with a groove as a function, and one with options as a
class."""

import numpy as np

from contactsnes import Shape, option


def grooved(x):
    """A cylinder with a groove along its apex: beta and u_n,r; in scenes in SI metres."""
    return x ** 2 / 2 + np.exp(-x ** 2) - (1 + np.log(2)) / 2


class Ogive(Shape):
    """|x|^2/2 (1 + s |x|^2), steeper than a parabola by an option of its own."""

    ogive_steepness = option(0.1, "s of the shape Ogive: 0 is a parabola", "1/beta^2", minimum=0)
    even = (0, 1)
    convex = True
    parabola = {1: 1.0, 2: 1.0}

    def gap(self, coordinates, scene):
        """Gap in u_n,r at coordinates in beta."""
        squared = sum(x ** 2 for x in coordinates)
        return squared / 2 * (1 + self.ogive_steepness * squared)
