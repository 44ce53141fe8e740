"""Where a vector differs from another by more than a number: what is kept of one in single
precision, beside the other."""

from typing import NamedTuple

import numpy as np

LENGTH = 2 ** 10
"""Nodes that have one number in common, as krylov.c has it."""
BETWEEN = 4
"""Nodes that may be told with others though they are not changed, likewise."""
SAMPLES = 9
"""Nodes of a piece that are asked for the number they have in common, likewise."""
TRIFLE = 6e-8
"""Rounding of numbers in single precision."""


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


class Changes(NamedTuple):
    """Changes of a vector: ``shifts``, one for each piece of `LENGTH` nodes; ``runs`` (first node,
    count), none longer than its piece, and ``values`` in single precision that stand there in
    place of what is shifted."""

    shifts: np.ndarray
    runs: np.ndarray
    values: np.ndarray

    def applied(self, before):
        """The changed vector, in double precision, from the one before."""
        found = before + np.repeat(self.shifts, LENGTH)[:len(before)]
        held = 0
        for first, count in self.runs.tolist():
            found[first:first + count] = self.values[held:held + count]
            held += count
        return found


def changes(before, after, like=None):
    """The `Changes` from a vector to another.

    Parameters
    ----------
    before, after : arrays of float
    like : Changes of about that size, or None
    """
    starts = np.arange(0, len(before), LENGTH)
    counts, off = np.minimum(len(before) - starts, LENGTH), after - before
    allowed = TRIFLE * (np.abs(before) + np.abs(after))
    asked = starts + np.outer(2 * np.arange(SAMPLES) + 1, counts) // (2 * SAMPLES)
    agree = np.sum(np.abs(off[asked][:, None] - off[asked]) <= allowed[asked][:, None], axis=0)
    shifts = off[asked[np.argmax(agree, axis=0), np.arange(len(starts))]]
    nodes = np.flatnonzero(~(np.abs(off - np.repeat(shifts, counts)) <= allowed))
    cuts = 1 + np.flatnonzero((np.diff(nodes) > BETWEEN) | (np.diff(nodes // LENGTH) > 0))
    runs = np.array([(part[0], part[-1] - part[0] + 1) for part in np.split(nodes, cuts)
                     if part.size], dtype=np.intc).reshape(-1, 2)
    values = [after[first:first + count] for first, count in runs.tolist()]
    return Changes(shifts, runs, np.concatenate([*values, after[:0]]).astype(np.float32))
