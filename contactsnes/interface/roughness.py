"""Self-affine roughness as waves of a periodic cell: the same surface on every grid.

h(x) = sum_q a(q) cos(q.(x + L/2) + phase(q)) over the wave vectors of the cell with 2 pi/longest <=
|q| < 2 pi/shortest, each once, a(q) ~ |q|^-(H + d/2) in d dimensions: a power spectrum that falls
as |q|^-(2H + d). Waves longer than the roll-off have all the spectrum of the roll-off (Jacobs,
Junge and Pastewka, Surface Topography 5, 013001, 2017). Phases are random, and belong to the wave
vector whatever the other waves are. The mean of |grad h|^2 is the sum of (a |q|)^2/2, which sets
the rms slope.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy

from ..grid.cell import Grid, Transform
from ..grid.lengths import fast_length
from ..options.fields import InputError

FINE = {1: 8, 2: 4}
"""Nodes within the shortest wave of the grid on which the lowest point of a gap is looked for, by
dimension."""

MOST_WAVES = 10 ** 8
"""Waves of a surface, at most: they take a hundred bytes each."""

CANDIDATES = 32
"""Local minima of that grid that are followed down to those of the surface, at most."""


class Surface(NamedTuple):
    """Waves of a rough surface on a cylinder (one dimension) or a sphere: whole numbers
    (directions, waves), amplitudes, phases; and the curvature of what they are on, u_n,r/beta^2, 0
    of a flat."""

    periods: tuple
    numbers: np.ndarray
    amplitudes: np.ndarray
    phases: np.ndarray
    curvature: float = 1.0

    @property
    def wavevectors(self):
        """q of each wave (directions, waves), 1/beta."""
        return 2 * np.pi * self.numbers / np.array(self.periods)[:, None]

    def rms(self, order, axis=None):
        """Root mean square of h (order 0), its slope (1) or curvature (2), in u_n,r and beta; in
        one direction or of the vector."""
        size = (np.sqrt(np.sum(self.wavevectors ** 2, axis=0)) if axis is None
                else np.abs(self.wavevectors[axis]))
        return math.sqrt(0.5 * np.sum((self.amplitudes * size ** order) ** 2))

    def heights(self, points):
        """h on a grid of points in each direction, an array; waves shorter than two spacings are
        there as the nodes see them."""
        transform = Transform(Grid(points, self.periods), points, 1)
        waves = 0.5 * self.amplitudes * np.exp(1j * self.phases)
        for sign, values in ((1, waves), (-1, waves.conj())):
            places = [(sign * number) % n for number, n in zip(self.numbers, points)]
            half = places[-1] <= points[-1] // 2
            np.add.at(transform.spectrum[0], tuple(place[half] for place in places), values[half])
        transform.backward()
        return transform.real[0].copy()

    def gap(self, points):
        """c |x|^2/2 - h on a grid, node i at (i - N/2) L/N, u_n,r; c is the curvature."""
        heights = self.heights(points)
        if not self.curvature:
            return -heights
        squares = sum(x ** 2 for x in Grid(points, self.periods).coordinates())
        return self.curvature / 2 * squares - heights

    def lowest(self):
        """The smallest c |x|^2/2 - h of the cell, between nodes, too: minima of a fine grid,
        followed by Newton's method."""
        points = tuple(2 * fast_length(math.ceil(0.5 * FINE[len(self.periods)]
                                                 * (np.max(np.abs(number)) + 1)))
                       for number in self.numbers)
        gap = self.gap(points)
        step = np.array(self.periods) / points
        reach = gap.min() + 0.5 * (self.curvature + 6.0 * self.rms(2)) * np.sum((0.5 * step) ** 2)
        lowest = gap == scipy.ndimage.minimum_filter(gap, 3, mode="wrap")
        found = np.argwhere((gap <= reach) & lowest)
        found = found[np.argsort(gap[tuple(found.T)], kind="stable")][:CANDIDATES]
        return min(self._descend((place - np.array(points) // 2) * step, step) for place in found)

    def _descend(self, x, step):
        """The smallest gap that Newton's method finds from a node, within a spacing of it."""
        start, waves = x, self.wavevectors
        smallest = math.inf
        for _ in range(8):
            angle = waves.T @ (x + 0.5 * np.array(self.periods)) + self.phases
            cosine = self.amplitudes * np.cos(angle)
            smallest = min(smallest, 0.5 * self.curvature * x @ x - np.sum(cosine))
            slope = self.curvature * x + waves @ (self.amplitudes * np.sin(angle))
            curvature = self.curvature * np.eye(len(x)) + (waves * cosine) @ waves.T
            change = np.linalg.lstsq(curvature, -slope, rcond=None)[0]
            x = np.clip(x + change, start - step, start + step)
        return smallest


@lru_cache(maxsize=4)
def surface(periods, hurst, slope, longest, shortest, seed, rolloff=math.inf, curvature=1.0):
    """The Surface of a Hurst exponent, rms slope (u_n,r/beta), longest and shortest wave (beta) and
    a seed; and its lowest gap.

    Parameters
    ----------
    periods : tuple of float, one a direction, beta
    hurst : float, dimensionless
    slope : float, rms, u_n,r/beta
    longest, shortest : float, wavelengths, beta
    seed : int, of the phases
    rolloff : float, wavelength beyond which the power spectrum is flat, beta
    curvature : float, of the body that is rough, u_n,r/beta^2; 0 of a flat
    """
    numbers = _numbers(periods, shortest)
    # A stream of numbers that no version of NumPy changes, in an order that does not depend on the
    # shortest wave.
    phases = 2 * np.pi * np.random.RandomState(seed).random_sample(numbers.shape[1])
    wavenumber = np.sqrt(np.sum((2 * np.pi * numbers / np.array(periods)[:, None]) ** 2, axis=0))
    ends = 2 * np.pi / longest * (1 - 1e-9), 2 * np.pi / shortest * (1 - 1e-9)
    kept = (wavenumber >= ends[0]) & (wavenumber < ends[1])
    if not kept.any():
        raise InputError("-scene_rough_longest and -scene_rough_shortest leave no "
                         "wave that fits into the cell: take a smaller "
                         "-scene_rough_shortest")
    amplitudes = np.maximum(wavenumber[kept], 2 * np.pi / rolloff) ** -(hurst + 0.5 * len(periods))
    amplitudes *= slope / math.sqrt(0.5 * np.sum((amplitudes * wavenumber[kept]) ** 2))
    found = Surface(periods, numbers[:, kept], amplitudes, phases[kept], curvature)
    return found, found.lowest()


def _numbers(periods, shortest):
    """Whole numbers of half of all waves longer than the shortest, and some more: (directions,
    waves), by their largest number."""
    most = math.ceil(max(periods) / shortest)
    if (2 * most) ** len(periods) > 2 * MOST_WAVES:
        raise InputError("-scene_rough_shortest leaves about "
                         f"{0.5 * (2.0 * most) ** len(periods):.2g} waves, and "
                         f"{MOST_WAVES:.0e} are the most that can be computed "
                         "with: take a longer one, or a smaller "
                         "-scene_period")
    if len(periods) == 1:
        return np.arange(1, most + 1)[None]
    x, y = np.meshgrid(np.arange(most + 1), np.arange(-most, most + 1), indexing="ij")
    x, y = (numbers[(x > 0) | (y > 0)] for numbers in (x, y))
    order = np.lexsort((y, x, np.maximum(x, abs(y))))
    return np.array([x[order], y[order]])
