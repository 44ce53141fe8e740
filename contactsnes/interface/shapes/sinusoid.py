"""The sinusoid."""

import numpy as np

from ...options.fields import option
from .shape import Shape


class Sinusoid(Shape):
    """Sum over the directions of A (1 - cos 2 pi x/L), by default of curvature 1."""

    name, meaning = "sinusoid", "A (1 - cos 2 pi x/L) summed over the directions"
    amplitude: float = option(None, "A of the sinusoid", "u_n,r", kind="number", above=0,
                              default_text="(L/2 pi)^2, of curvature 1")
    even = (0, 1)
    by_nodes = True

    @property
    def uses_radius(self):
        """For the default of the amplitude only."""
        return self.amplitude is None

    def amplitudes(self, scene):
        """A in each direction, u_n,r, a tuple."""
        return tuple((period / (2 * np.pi)) ** 2 if self.amplitude is None else self.amplitude
                     for period in scene.periods)

    def gap(self, coordinates, scene):
        """2 A sin^2 pi x/L, summed."""
        return sum(amplitude * 2 * np.sin(np.pi * x / length) ** 2
                   for x, length, amplitude in zip(coordinates, scene.periods,
                                                   self.amplitudes(scene)))

    def curvature(self, scene):
        """A (2 pi/L)^2."""
        return tuple(amplitude * (2 * np.pi / period) ** 2
                     for amplitude, period in zip(self.amplitudes(scene), scene.periods))

    def filled(self, scene):
        """The amplitudes."""
        return {"amplitude": self.amplitudes(scene)}
