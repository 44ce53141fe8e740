"""Vectors by symmetry: their parts that mirrors leave as they are, or reverse, each on one of the
nodes that mirrors carry into each other."""

import numpy as np
import scipy


class Sectors:
    """Parts of vectors that differ in symmetry, no longer than there are nodes that differ: their
    lengths and products are those of the whole vectors.

    Parameters
    ----------
    operator : with ``size`` and ``mirror``
    axes : symmetries, second arguments of ``mirror``
    """

    def __init__(self, operator, axes):
        self.size, self.count = operator.size, 2 ** len(axes)
        images = [np.arange(1.0, self.size + 1.0)]
        # the first symmetry is that of the halves, the next one that of quarters
        for axis in reversed(axes):
            images += [operator.mirror(image, axis) for image in images]
        places = np.abs(images).astype(int) - 1
        chosen = np.flatnonzero(places[0] == places.min(axis=0))
        self._places, self._signs = places[:, chosen], np.sign(np.array(images)[:, chosen])
        # of nodes that a mirror leaves where they are there are fewer
        alike = np.sum(self._places == chosen, axis=0)
        self._weights = np.sqrt(self.count / alike)
        self._parities = scipy.linalg.hadamard(self.count).astype(float)

    @property
    def lengths(self):
        """Numbers of each part."""
        return [len(self._weights)] * self.count

    def parts(self, vector):
        """The parts of a vector, rows."""
        images = self._signs * vector[self._places]
        return self._parities @ images * (self._weights / self.count)

    def whole(self, number, rows):
        """Vectors (..., size) of the parts (..., length) of a symmetry by its number."""
        found = np.empty((*rows.shape[:-1], self.size), rows.dtype)
        for parity, places, signs in zip(self._parities[number], self._places, self._signs):
            found[..., places] = rows * (parity * signs / self._weights)
        return found


class Together:
    """The same without symmetries: a vector is its own part.

    Parameters
    ----------
    size : int, of vectors
    """

    def __init__(self, size):
        self.lengths = [size]

    def parts(self, vector):
        """The vector alone, a list."""
        return [vector]

    def whole(self, number, rows):
        """The parts themselves."""
        return rows
