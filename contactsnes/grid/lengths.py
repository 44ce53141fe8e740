"""Lengths that suit a real transform."""

import math
from functools import lru_cache


@lru_cache(maxsize=256)
def fast_length(count):
    """The smallest number of points, ``count`` at least, without prime factors above 5: that of
    SciPy's ``next_fast_len``, whose module takes longer to import than a run asks of it."""
    best = 2 ** math.ceil(math.log2(max(count, 1)))
    fives = 1
    while fives < best:
        odd = fives
        while odd < best:
            # by the power of two that this needs
            found = odd << max(0, (-(-count // odd) - 1).bit_length())
            best = min(best, found)
            odd *= 3
        fives *= 5
    return best
