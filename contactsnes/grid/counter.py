"""The count of transforms, which no method gets past, whatever it nests."""

import math

import numpy as np


def transform_cost(points, size):
    """Cost of a real transform of ``points`` points in units of one of ``size`` points: m log m /
    (N log N)."""
    return points * math.log(max(points, 2)) / (size * math.log(size))


def weighed(counts):
    """Transforms in a mapping of counts by name, those in single precision as half of one."""
    return counts["transforms"] + 0.5 * counts["transforms_single"]


class Counter:
    """Counts transforms, in units of one over ``size`` nodes, and stops who needs more than is
    allowed.

    Attributes
    ----------
    limit : count beyond which every transform raises RuntimeError, those in single precision
        counted as half of one
    numbers : array (3,), transforms in double precision so far, the limit, and those in single
        precision, which compiled transforms share
    """

    def __init__(self, size):
        self.size = size
        self.numbers = np.array([0.0, np.inf, 0.0])

    @property
    def limit(self):
        """The count that is allowed."""
        return float(self.numbers[1])

    @limit.setter
    def limit(self, limit):
        """Set the count that is allowed."""
        self.numbers[1] = limit

    @property
    def transforms(self):
        """Transforms in double precision counted so far."""
        return float(self.numbers[0])

    @property
    def transforms_single(self):
        """Transforms in single precision counted so far."""
        return float(self.numbers[2])

    @property
    def made(self):
        """A number that every transform changes."""
        return float(self.numbers[0] + self.numbers[2])

    @property
    def weighed(self):
        """Transforms so far, those in single precision as half of one."""
        return float(self.numbers[0] + 0.5 * self.numbers[2])

    def add(self, cost, single=False):
        """Count a transform by its cost; RuntimeError beyond the limit."""
        self.numbers[2 if single else 0] += cost
        self.check()

    def check(self):
        """RuntimeError beyond the limit."""
        if self.weighed > self.numbers[1]:
            raise RuntimeError("too many transforms")
