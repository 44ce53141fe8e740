"""Heights of a file: as an array, or by rows where they lie in it."""

import math
import re
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "pm": 1e-12, "A": 1e-10}
"""Unit of heights -> metres."""
OWN_NAMES = {"µm": "um", "μm": "um", "Å": "A", "Angstrom": "A"}
"""Units as files write them."""
WORDS = re.compile("(milli|micro|nano|pico|)met(?:er|re)s?")
"""Units in words: parts of a metre, whose first letters those of units are, but for micro."""
BLOCK = 2 ** 20
"""Numbers of a file that are looked at together."""
HOLES = "_FillValue", "missing_value"
"""Attributes of a dataset, by netCDF's conventions, that tell the number which stands for none."""
PACKED = "scale_factor", "add_offset"
"""Those that tell what its numbers are to be multiplied by, and what is to be added then."""


def known(unit):
    """A unit as a file writes it by its name in `UNITS`, or None; ValueError for another one."""
    unit = OWN_NAMES.get(unit, unit)
    if unit is not None and unit not in UNITS:
        raise ValueError(f"its unit is {unit}; known are {', '.join(UNITS)}")
    return unit


@dataclass(frozen=True, eq=False)
class Heights:
    """Heights of a file (nan where there are none), its size in each direction and its unit, None
    where it does not tell.

    The size is in the unit of the heights, or ``metric``, in metres, where the file tells that of
    the size alone; values are an array, or `Stored` or `Elsewhere`; the digit is the last one that
    the largest of them has in the file's floating-point numbers. They are equal to themselves only,
    so that what is made of them can be kept with them.
    """

    values: object
    size: tuple = None
    unit: str = None
    digit: float = 0.0
    metric: bool = False

    def size_in(self, unit):
        """The size in metres, or as the file has it, for a unit of the heights in metres, or 1.0;
        None where there is none."""
        factor = 1.0 if self.metric else unit
        return self.size and tuple(factor * length for length in self.size)


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
    if dataset and (told := _conventions(array)):
        return _unpacked(array[()], told)
    return Stored(filename, dataset, array.dtype, tuple(slice(0, n) for n in array.shape))


def unit_of(dataset):
    """The unit of an open dataset by netCDF's conventions, one of `UNITS`; None where it tells
    none, or none of lengths."""
    told = [*np.ravel(dataset.attrs.get("units", "")), ""][0]
    word = told.decode(errors="replace") if isinstance(told, bytes) else str(told)
    if part := WORDS.fullmatch(word):
        word = part[1].replace("micro", "u")[:1] + "m"
    try:
        return known(word)
    except ValueError:
        return None


def _conventions(dataset):
    """Attributes of an open dataset by which netCDF tells what its numbers stand for, name ->
    number; none where they stand for themselves."""
    told = {name: float(np.ravel(dataset.attrs[name])[0]) for name in (*HOLES, *PACKED)
            if name in dataset.attrs}
    return {name: value for name, value in told.items()
            if not (name in HOLES and math.isnan(value))}


def _unpacked(numbers, told):
    """Heights of numbers of a dataset, nan where these stand for none.

    Parameters
    ----------
    numbers : array
    told : mapping, `_conventions`
    """
    values = numbers.astype(float)
    for name in HOLES:
        if name in told:
            values[numbers == numbers.dtype.type(told[name])] = np.nan
    return values * told.get("scale_factor", 1.0) + told.get("add_offset", 0.0)
