"""Self-affine roughness as waves of a periodic cell: the same surface on every grid.

h(x) = sum_q a(q) cos(q.(x + L/2) + phase(q)) over the wave vectors of the cell with 2 pi/longest <=
|q| < 2 pi/shortest, each once, a(q) ~ |q|^-(H + d/2) in d dimensions: a power spectrum that falls
as |q|^-(2H + d). Waves longer than the roll-off have all the spectrum of the roll-off (Jacobs,
Junge and Pastewka, Surface Topography 5, 013001, 2017). Phases are random, and belong to the wave
vector whatever the other waves are. The mean of |grad h|^2 is the sum of (a |q|)^2/2, which sets
the rms slope.

Waves are made anew, some at a time, whenever they are summed: a plane may have more of them than
nodes that one of many processes has.
"""

import math
from functools import cached_property, lru_cache

import numpy as np
import scipy

from ..grid.lengths import fast_length
from ..options.fields import InputError

FINE = {1: 8, 2: 4}
"""Nodes within the shortest wave of the grid on which the lowest point of a gap is looked for, by
dimension."""

MOST_WAVES = 10 ** 8
"""Waves of a surface, at most."""

BLOCK = 2 ** 13
"""Waves that are there together, about."""

CANDIDATES = 32
"""Local minima of that grid that are followed down to those of the surface, at most."""


class Surface:
    """A rough surface on a cylinder (one dimension), a sphere or a flat; its waves.

    Parameters
    ----------
    periods : tuple of float, one a direction, beta
    hurst : float, dimensionless
    slope : float, rms, u_n,r/beta
    longest, shortest : float, wavelengths, beta
    seed : int, of the phases
    rolloff : float, wavelength beyond which the power spectrum is flat, beta
    curvature : float, of the body that is rough, u_n,r/beta^2; 0 of a flat

    Raises
    ------
    InputError : where there are no such waves in the cell, or too many
    """

    def __init__(self, periods, hurst, slope, longest, shortest, seed, rolloff=math.inf,
                 curvature=1.0):
        self.periods, self.seed, self.curvature = periods, seed, curvature
        self._exponent, self._rolloff = -(hurst + 0.5 * len(periods)), 2 * np.pi / rolloff
        self._ends = 2 * np.pi / longest * (1 - 1e-9), 2 * np.pi / shortest * (1 - 1e-9)
        self._most, self._factor, self._lowest = _most(periods, shortest), 1.0, None
        if not self.count:
            raise InputError("-scene_rough_longest and -scene_rough_shortest leave no "
                             "wave that fits into the cell: take a smaller "
                             "-scene_rough_shortest")
        self._factor = slope / self.rms(1)
        del self._sums  # of other amplitudes

    def blocks(self):
        """The waves, some at a time: whole numbers (directions, waves), amplitudes, phases."""
        # A stream of numbers that no version of NumPy changes, in an order that does not depend on
        # the shortest wave.
        random = np.random.RandomState(self.seed)
        for numbers in _numbers(len(self.periods), self._most):
            phases = 2 * np.pi * random.random_sample(numbers.shape[1])
            wavenumber = np.sqrt(np.sum(self._waves(numbers) ** 2, axis=0))
            kept = (wavenumber >= self._ends[0]) & (wavenumber < self._ends[1])
            amplitudes = np.maximum(wavenumber[kept], self._rolloff) ** self._exponent
            if kept.any():
                yield numbers[:, kept], self._factor * amplitudes, phases[kept]

    def _waves(self, numbers):
        """q of waves by their numbers (directions, waves), 1/beta."""
        return 2 * np.pi * numbers / np.array(self.periods)[:, None]

    @cached_property
    def _sums(self):
        """Number of the waves, and sums over them: (order, direction, or None for the vector) ->
        that of a^2 |q|^(2 order)."""
        count, found = 0, {(order, axis): 0.0 for order in range(3)
                           for axis in (None, *range(len(self.periods)))}
        for numbers, amplitudes, _ in self.blocks():
            waves, count = self._waves(numbers), count + len(amplitudes)
            for order, axis in found:
                size = (np.sqrt(np.sum(waves ** 2, axis=0)) if axis is None
                        else np.abs(waves[axis]))
                found[order, axis] += np.sum((amplitudes * size ** order) ** 2)
        return count, found

    @property
    def count(self):
        """Number of waves."""
        return self._sums[0]

    def rms(self, order, axis=None):
        """Root mean square of h (order 0), its slope (1) or curvature (2), in u_n,r and beta; in
        one direction or of the vector."""
        return math.sqrt(0.5 * self._sums[1][order, axis])

    def heights(self, grid):
        """h at the nodes of a grid that are here, an array; waves shorter than two spacings are
        there as the nodes see them."""
        transform = grid.transform(grid, grid.shape, 1)
        spectrum = transform.spectrum[0]
        for numbers, amplitudes, phases in self.blocks():
            waves = 0.5 * amplitudes * np.exp(1j * phases)
            for sign, values in ((1, waves), (-1, waves.conj())):
                *rows, column = [(sign * number) % n for number, n in zip(numbers, grid.shape)]
                column -= grid.first_column
                here = (column >= 0) & (column < spectrum.shape[-1])
                np.add.at(spectrum, tuple(place[here] for place in (*rows, column)), values[here])
        transform.backward()
        return transform.real[0].copy()

    def gap(self, grid):
        """c |x|^2/2 - h at the nodes of a grid that are here, u_n,r; c is the curvature."""
        gap = self.heights(grid)
        np.negative(gap, out=gap)
        if self.curvature:
            gap += self.curvature / 2 * sum(x ** 2 for x in grid.coordinates())
        return gap

    def lowest(self, grid):
        """The smallest c |x|^2/2 - h of the cell of a grid, between nodes, too: minima of a fine
        grid, followed by Newton's method; found once."""
        if self._lowest is None:
            self._lowest = self._found_lowest(grid)
        return self._lowest

    def _found_lowest(self, grid):
        """`lowest`, anew."""
        most = [math.floor(self._ends[1] * period / (2 * np.pi)) for period in self.periods]
        fine = grid.of_points(tuple(
            2 * fast_length(math.ceil(0.5 * FINE[len(most)] * (number + 1))) for number in most))
        gap, step = self.gap(fine), np.array(fine.spacings)
        reach = (fine.minimum(gap)
                 + 0.5 * (self.curvature + 6.0 * self.rms(2)) * np.sum((0.5 * step) ** 2))
        around = scipy.ndimage.minimum_filter(fine.with_rows(gap, 1), 3, mode="wrap")
        lowest = (gap <= reach) & (gap == fine.without_rows(around, 1))
        del around
        found, values = np.argwhere(lowest), fine.joined(gap[lowest])
        found[:, 0] += fine.row_numbers[:1].sum()
        found = fine.joined(found)[np.argsort(values, kind="stable")][:CANDIDATES]
        return self._descend(grid, (found - np.array(fine.shape) // 2) * step, step)

    def _descend(self, grid, start, step):
        """The smallest gap that Newton's method finds from places (places, directions), within a
        spacing of each.

        Parameters
        ----------
        grid : Grid, whose processes share out the waves
        start : array (places, directions)
        step : array (directions,)
        """
        x, smallest = start, math.inf
        # few are made once
        kept = [*grid.turns(self.blocks())] if self.count <= BLOCK else None
        for _ in range(8):
            heights, slopes, curvatures = self._at(grid, x, kept)
            smallest = min(smallest, np.min(0.5 * self.curvature * np.sum(x * x, axis=1) - heights))
            changes = [np.linalg.lstsq(curvature, -slope, rcond=None)[0] for curvature, slope
                       in zip(self.curvature * np.eye(x.shape[1]) + curvatures,
                              self.curvature * x + slopes)]
            x = np.clip(x + np.array(changes), start - step, start + step)
        return float(smallest)

    def _at(self, grid, x, kept=None):
        """h, and gradient and second derivatives of -h, at places (places, directions).

        Parameters
        ----------
        grid : Grid, whose processes share out the waves
        x : array (places, directions)
        kept : list of this process's blocks of waves; None: they are made
        """
        places, dimension = x.shape
        found = np.zeros((places, 1 + dimension + dimension ** 2))
        for numbers, amplitudes, phases in (grid.turns(self.blocks()) if kept is None else kept):
            waves = self._waves(numbers)
            angle = (x + 0.5 * np.array(self.periods)) @ waves + phases
            cosine = amplitudes * np.cos(angle)
            found[:, 0] += np.sum(cosine, axis=1)
            found[:, 1:1 + dimension] += (amplitudes * np.sin(angle)) @ waves.T
            products = (waves[:, None] * waves).reshape(dimension ** 2, -1)
            found[:, 1 + dimension:] += cosine @ products.T
        found = grid.together(found)
        return (found[:, 0], found[:, 1:1 + dimension],
                found[:, 1 + dimension:].reshape(places, dimension, dimension))


surface = lru_cache(maxsize=4)(Surface)
"""The Surface of the same arguments, once."""


def _most(periods, shortest):
    """Largest of the whole numbers of all waves longer than the shortest; InputError where there
    are too many."""
    most = math.ceil(max(periods) / shortest)
    if (2 * most) ** len(periods) > 2 * MOST_WAVES:
        raise InputError("-scene_rough_shortest leaves about "
                         f"{0.5 * (2.0 * most) ** len(periods):.2g} waves, and "
                         f"{MOST_WAVES:.0e} are the most that can be computed "
                         "with: take a longer one, or a smaller "
                         "-scene_period")
    return most


def _numbers(dimension, most):
    """Whole numbers of half of all waves up to the largest number, by their own largest, some at a
    time: arrays (directions, waves).

    On a plane those of a largest number m are the upper half of a square's rim, by x and then y.
    """
    if dimension == 1:
        yield from np.array_split(np.arange(1, most + 1)[None], 1 + most // BLOCK, axis=1)
        return
    rims, count = [], 0
    for m in range(1, most + 1):
        rims.append((np.r_[0, np.repeat(np.arange(1, m), 2), np.full(2 * m + 1, m)],
                     np.r_[m, np.tile([-m, m], m - 1), np.arange(-m, m + 1)]))
        count += 4 * m
        if count >= BLOCK or m == most:
            yield np.concatenate(rims, axis=1)
            rims, count = [], 0
