"""Lengths of transforms against SciPy's, whose they are, and against a search."""

import scipy.fft

from contactsnes.grid.lengths import fast_length


def smooth(count):
    """Whether a number has no prime factor above 5."""
    for prime in (2, 3, 5):
        while count % prime == 0:
            count //= prime
    return count == 1


def test_lengths_are_the_shortest_smooth_ones():
    for count in (*range(1, 3000), 2 ** 20 - 1, 2 ** 20 + 1, 10 ** 9 + 7):
        assert fast_length(count) == scipy.fft.next_fast_len(count, real=True)
    for count in range(1, 500):
        found = fast_length(count)
        assert smooth(found) and not any(map(smooth, range(count, found)))
