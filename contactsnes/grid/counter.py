"""The count of transforms, which no method gets past, whatever it nests."""

import numpy as np


class Counter:
    """Counts transforms, in units of one over ``size`` nodes, and stops who needs more than is
    allowed.

    Attributes
    ----------
    limit : count beyond which every transform raises RuntimeError
    """

    def __init__(self, size):
        self.size = size
        self.limit = np.inf
        self._transforms = 0.0

    @property
    def transforms(self):
        """Transforms counted so far."""
        return self._transforms

    @transforms.setter
    def transforms(self, count):
        """Set the count; RuntimeError beyond the limit."""
        self._transforms = count
        if count > self.limit:
            raise RuntimeError("too many transforms")
