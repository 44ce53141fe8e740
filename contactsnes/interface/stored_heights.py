"""Heights of a file: as an array, or by rows where they lie in it."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

BLOCK = 2 ** 20
"""Numbers of a file that are looked at together."""


@dataclass(frozen=True, eq=False)
class Heights:
    """Heights of a file (nan where there are none), its size in each direction and its unit, None
    where it does not tell.

    The size is in the unit of the heights; values are an array, or `Stored` or `Elsewhere`. They
    are equal to themselves only, so that what is made of them can be kept with them.
    """

    values: object
    size: tuple = None
    unit: str = None


class Elsewhere(NamedTuple):
    """Heights that another process has as a whole."""

    shape: tuple

    @property
    def ndim(self):
        """Number of directions."""
        return len(self.shape)


class Stored(NamedTuple):
    """Heights that stay in their file, of which rows are read when they are asked for.

    Attributes
    ----------
    filename, dataset : str; no dataset: an array of NumPy
    dtype : of the numbers in the file
    part : slices of what is used, one a direction
    """

    filename: str
    dataset: str
    dtype: np.dtype
    part: tuple

    @property
    def shape(self):
        """Number of heights in each direction."""
        return tuple(ends.stop - ends.start for ends in self.part)

    @property
    def ndim(self):
        """Number of directions."""
        return len(self.part)

    def rows(self, first, count):
        """So many rows from one on, a new array."""
        ends = slice(self.part[0].start + first, self.part[0].start + first + count)
        if self.dataset:
            from ..system.hdf5 import h5py

            with h5py.File(self.filename, "r") as file:
                return file[self.dataset][(ends, *self.part[1:])].astype(float, copy=False)
        # (mapped anew each time: what has been looked at would else stay in memory)
        return np.array(np.load(self.filename, mmap_mode="r")[(ends, *self.part[1:])], float)

    def blocks(self):
        """All rows, some at a time."""
        step = max(1, BLOCK * self.shape[0] // math.prod(self.shape))
        for first in range(0, self.shape[0], step):
            yield self.rows(first, min(step, self.shape[0] - first))

    def __array__(self, dtype=None):
        """All of them."""
        return np.asarray(self.rows(0, self.shape[0]), dtype)


def stored(filename, dataset, array):
    """What an open array is, where it can be read by rows; else all of its numbers.

    Parameters
    ----------
    filename, dataset : str, as of `Stored`
    array : numpy.memmap or h5py.Dataset
    """
    if array.dtype.kind not in "fiu" or array.ndim not in (1, 2) or array.size == 0:
        return array[()]
    return Stored(filename, dataset, array.dtype, tuple(slice(0, n) for n in array.shape))
