"""Vectors rounded to short integers."""

from typing import NamedTuple

import numpy as np

LENGTH = 2 ** 10
"""Nodes that have one scale in common, as krylov.c has it."""


class Rounded(NamedTuple):
    """A vector rounded to short integers ``numbers``, times ``scales``, one for each piece of
    `LENGTH` nodes."""

    numbers: np.ndarray
    scales: np.ndarray

    @classmethod
    def of(cls, size):
        """Room for a vector of a size."""
        return cls(np.empty(size, dtype=np.short), np.empty(-(-size // LENGTH)))

    def wide(self):
        """The vector in double precision."""
        found = self.numbers.astype(float)
        whole = len(found) // LENGTH
        pieces = found[:whole * LENGTH].reshape(whole, LENGTH)
        pieces *= self.scales[:whole, None]
        found[whole * LENGTH:] *= self.scales[whole:whole + 1]
        return found
