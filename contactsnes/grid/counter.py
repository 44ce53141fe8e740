"""The count of transforms, which no method gets past, whatever it nests."""

import numpy as np


class Counter:
    """Counts transforms, in units of one over ``size`` nodes, and stops who needs more than is
    allowed.

    Attributes
    ----------
    limit : count beyond which every transform raises RuntimeError
    numbers : array (2,), transforms so far and the limit, which compiled transforms share
    """

    def __init__(self, size):
        self.size = size
        self.numbers = np.array([0.0, np.inf])

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
        """Transforms counted so far."""
        return float(self.numbers[0])

    @transforms.setter
    def transforms(self, count):
        """Set the count; RuntimeError beyond the limit."""
        self.numbers[0] = count
        self.check()

    def check(self):
        """RuntimeError beyond the limit."""
        if self.numbers[0] > self.numbers[1]:
            raise RuntimeError("too many transforms")
