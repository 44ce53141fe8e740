"""Transforms of a direction's rows, and the order of their waves, for the library."""

from functools import lru_cache

import numpy as np

from ..grid.fftw import pyfftw
from ..grid.precision import SINGLE
from . import structures
from .fftw import Plans, Rows
from .structures import address

COLUMNS = 8
"""Columns of a block, as kernels.h has it."""


def in_pairs(shape):
    """A shape, in the plane with as many rows as pairs of them have."""
    return (shape[0] + shape[0] % 2, *shape[1:]) if len(shape) == 2 else tuple(shape)


def order_of(points, closed):
    """Numbers of a direction's waves in their order: as they are, or even ones upwards, then odd
    ones downwards."""
    numbers = np.arange(points)
    return numbers if closed else np.concatenate([numbers[::2], numbers[1::2][::-1]])


@lru_cache(maxsize=16)
def line(points, closed, single):
    """The `Line` of some points, which all transforms share that have such rows: a path on a line
    has about a dozen, with those of the coarser grids that it begins on.

    Parameters
    ----------
    points, closed, single : as of that
    """
    return Line(points, closed, single)


class Line:
    """Work, factors and plans of a direction's rows.

    Parameters
    ----------
    points : int, of a row from the axis outwards
    closed : bool, whether the cell closes on itself there
    single : bool, whether rows are in single precision
    """

    def __init__(self, points, closed, single=False):
        real, wave = (SINGLE[np.dtype(kind)] if single else kind for kind in (float, complex))
        self.structure = own = structures.Line(points=points, closed=closed)
        length, self._turn = points, None
        if closed:
            length = 2 * (points - 1)
        else:
            self._turn = np.exp(0.5j * np.pi * np.arange(points // 2 + 1) / points).astype(wave)
        self._row = pyfftw.zeros_aligned(length, dtype=real)
        self._half = pyfftw.zeros_aligned(length // 2 + 1, dtype=wave)
        self._plans = Plans((length,), 1, address(self._row), address(self._half), single)
        own.row, own.half, own.turn = (address(part) for part in (self._row, self._half,
                                                                  self._turn))
        own.to_row, own.to_half = self._plans.to_row, self._plans.to_half


@lru_cache(maxsize=16)
def paired_line(points, closed, single=True):
    """The `PairedLine` of some points, which all transforms share that have such lines.

    Parameters
    ----------
    points, closed, single : as of that
    """
    return PairedLine(points, closed, single)


class PairedLine:
    """Work, factors and plans of complex lines of a direction, a few at a time.

    Parameters
    ----------
    points, closed, single : as of `Line`
    """

    def __init__(self, points, closed, single):
        wave, real = (np.complex64, np.float32) if single else (complex, float)
        self.structure = own = structures.Line(points=points, closed=closed)
        length = 2 * (points - 1) if closed else points
        self._row, self._half = (pyfftw.zeros_aligned((COLUMNS // 2, length + length % 2),
                                                      dtype=wave) for _ in range(2))
        own.row, own.half = address(self._row), address(self._half)
        self._plans = Rows(length, len(self._row), own.row, own.half, single, self._row.shape[1])
        own.to_half, own.to_row = self._plans.forward, self._plans.backward
        if not closed:
            turn = np.exp(0.5j * np.pi * np.arange(points) / points)
            self._turn = np.array([np.repeat(turn.real, 2),
                                   np.ravel(np.column_stack([-turn.imag, turn.imag]))],
                                  dtype=real)
            own.turn = address(self._turn)
