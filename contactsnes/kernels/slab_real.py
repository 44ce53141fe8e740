"""Transforms of slabs, columns of whose waves the library transforms, and multiplies there by the
symbols of a response."""

import ctypes
import math
from functools import cached_property

import numpy as np

from ..grid.counter import transform_cost
from ..grid.fftw import pyfftw
from ..grid.filtering import Filtering
from ..grid.slab_transform import Exchange, SlabTransform, share
from . import structures
from .fftw import Rows
from .library import shared
from .lines import COLUMNS
from .slabs import OfLibrary
from .structures import address
from .transforms import Packed

FULL = 0.9
"""Part of the pairs of rows with nodes from which on all are transformed."""


class SlabReal(OfLibrary, SlabTransform):
    """`grid.slab_transform.SlabTransform`, of whose columns of waves the library has charge.

    Parameters
    ----------
    grid, shape, count, rows, single : as of that

    Attributes
    ----------
    structure : of the library, with this process's rows of ``real`` as a field's
    block : a few columns of each field, and of a symbol
    """

    @cached_property
    def single(self):
        """The same in single precision, on the same memory; `SlabPacked` where it can be."""
        return self._packed(True) or super().single

    @cached_property
    def folded(self):
        """`SlabPacked` on the same memory where it can be, whose products are faster; else None: of
        whole pairs of rows alone, as ``real`` has no other."""
        parts = self._rows or self._grid.rows.parts
        return None if any(number % 2 for _, number in parts) else self._packed(False)

    def _packed(self, single):
        """`SlabPacked` in a precision, or None of rows that two of cannot be one."""
        if self.real.itemsize < 8 or self.shape[1] % 2:
            return None
        return SlabPacked(self._grid, self.shape, self._count, self._rows, single)

    def _plan_columns(self, planned):
        """Plan columns, some of which are transformed at a time.

        Parameters
        ----------
        planned : function, of rows' plans
        """
        self.library, single = shared(), self.real.itemsize < 8
        self.structure = own = structures.Transform(count=self._count, single=single)
        own.shape[:], own.real = self.real.shape[1:], address(self.real)
        own.waves = self.spectrum[0].size
        self.block = pyfftw.zeros_aligned((self._count + 1, COLUMNS, self.shape[0]),
                                          dtype=self.spectrum.dtype)
        self._plans = Rows(self.shape[0], self._count * COLUMNS, address(self.block),
                           single=single)
        self._columns = structures.Columns(
            count=self._count, rows=self.shape[0], columns=self.spectrum.shape[2], single=single,
            spectrum=address(self.spectrum), block=address(self.block),
            there=self._plans.forward, back=self._plans.backward)
        self._reference = ctypes.addressof(self._columns)
        self._serve()

    def places(self, numbers):
        """Where the library has the nodes of some numbers in ``real``."""
        return np.asarray(numbers, dtype=np.intc)

    def _along_columns(self, back):
        """Transform the columns of waves."""
        self.library.along_columns(self._reference, not back, back, None, 0)

    def multiply(self, response, symbol, transposed):
        """What stands in ``real`` times the symbols of a response, or other real ones of its
        precision, (count, *spectrum), in place.

        Parameters
        ----------
        response, symbol : addresses, one of which is None
        transposed : bool, whether the response's blocks are
        """
        if symbol:
            own = structures.Response(components=self._count)
            for i in range(self._count):
                own.symbol[i][i] = symbol + i * self.structure.waves * self.real.itemsize
            response = ctypes.addressof(own)
        self._to_columns()
        self.library.along_columns(self._reference, True, True, response, transposed)
        self._from_columns()


class SlabPacked(OfLibrary, Filtering):
    """Products with symbols of fields that are shared out, by the library (packed.c): two rows of a
    process are one of complex numbers, and go to those that have their columns, and come back,
    while they are in the processor's cache.

    Parameters
    ----------
    grid, shape, count, rows, single : as of `grid.slab_transform.SlabTransform`; columns of even
        number

    Attributes
    ----------
    real : array (count, rows here, columns), rows in pairs, the last of which may be none
    structure, spectral : of the library, with this process's rows, and with its columns of all
    block, found : a few columns of each field, and what these, or a row, are transformed to
    """

    places, inverted, spectral = Packed.places, Filtering.inverted, None

    def __init__(self, grid, shape, count, rows, single):
        self.library, self._grid, self.shape = shared(), grid, tuple(shape)
        self.gain, self._rows = math.prod(shape), rows or grid.rows.parts
        self._cost = 2.0 * count * transform_cost(self.gain, grid.counter.size), single
        self._lay_out(count, np.dtype(np.complex64 if single else complex))
        self._plan(count, single)
        self._serve()

    def _lay_out(self, count, kind):
        """Take memory for waves of a type, and find what goes where.

        Parameters
        ----------
        count, kind : int, type
        """
        comm, (points, width) = self._grid.comm, self.shape
        waves, (first, mine) = width // 2 + 1, self._rows[comm.rank]
        columns = [share(waves, rank, comm.size) for rank in range(comm.size)]
        here = columns[comm.rank].stop - columns[comm.rank].start
        self.waves, real = (points, here), kind.char.lower()
        self.real = self._room(count, 0, (mine + mine % 2, width), real)
        self.spectrum = self._room(count, 1, self.waves, kind)
        packed = self._room(count, 2, (mine * (waves - here),), kind)
        self._first = (ctypes.c_long * (comm.size + 1))(*(part.start for part in columns), waves)
        self._shares = structures.Shares(
            parts=comm.size, own=comm.rank, rows=mine, place=first, size=kind.itemsize,
            first=self._first, packed=address(packed), came=address(self.spectrum))
        self._shares.fields[1:] = packed[0].nbytes, self.spectrum[0].nbytes
        known = [np.arange(begin, begin + number) for begin, number in self._rows]
        self._empty = np.setdiff1d(np.arange(points), np.concatenate(known))
        sent = [mine * (part.stop - part.start) for part in columns]
        got = [number * here for _, number in self._rows]
        sent[comm.rank] = got[comm.rank] = 0
        places = [begin * here for begin, _ in self._rows]
        self._exchange = Exchange(comm, [([block, sent], [waves, (got, places)])
                                         for block, waves in zip(packed, self.spectrum)])

    def _room(self, count, place, shape, kind):
        """An array (count, *shape) of memory that all transforms use in turn.

        Parameters
        ----------
        count, place, shape, kind : int, as of `Slabs.room`
        """
        return self._grid.room((count, place), (count, *shape), kind)

    def _plan(self, count, single):
        """Plan rows and columns, some of which are transformed at a time.

        Parameters
        ----------
        count, single : int, bool
        """
        (points, width), kind = self.shape, self.spectrum.dtype
        self.block = pyfftw.zeros_aligned((count, COLUMNS, points), dtype=kind)
        self.found = pyfftw.zeros_aligned(max(self.block.size, 2 * width), dtype=kind)
        places = dict(zip(("real", "block", "spectrum"),
                          map(address, (self.real, self.block, self.found))))
        self.structure, self.spectral = (structures.Transform(
            count=count, single=single, packed=1, waves=math.prod(self.waves), **places)
            for _ in range(2))
        self.structure.shape[:] = self._rows[self._grid.comm.rank][1], width
        self.spectral.shape[:] = points, width
        self._plans = (Rows(width, 1, places["real"], places["spectrum"], single),
                       Rows(points, count * COLUMNS, places["block"], places["spectrum"], single))
        for own in (self.structure, self.spectral):
            own.forward, own.backward = self._plans[0].forward, self._plans[0].backward
            own.columns, own.columns_back = self._plans[1].forward, self._plans[1].backward

    def fitting(self, block):
        """A symbol (..., *waves) as the library takes it: column after column."""
        return super().fitting(np.swapaxes(block, -1, -2))

    def pairs_with(self, places):
        """Which pairs of rows have some of a few places, 1 or 0; None where all, or nearly all,
        have.

        Parameters
        ----------
        places : array of int, as of ``places``
        """
        found = np.zeros(-(-self.structure.shape[0] // 2), dtype=np.intc)
        found[places // (2 * self.shape[1])] = 1
        return None if found.sum() > FULL * len(found) else found

    def rows(self, field):
        """A field (rows here, columns) of this memory as (pairs, 2, columns), its rows in order."""
        return field.reshape(-1, self.shape[1], 2).swapaxes(1, 2)

    def multiply(self, response, symbol, transposed):
        """What stands in the rows times the symbols of a response, or real ones of its precision
        that are `fitting`, in place.

        Parameters
        ----------
        response, symbol : addresses, one of which is None
        transposed : bool, whether the response's blocks are
        """
        rows, columns, shares = map(ctypes.addressof, (self.structure, self.spectral,
                                                       self._shares))
        self._grid.counter.add(*self._cost)
        self.library.shared_rows(rows, shares, response, False)
        if self._empty.size:
            self.spectrum[:, self._empty] = 0.0
        self._exchange.send()
        self.library.shared_columns(columns, shares, response, symbol, transposed)
        self._exchange.take()
        self.library.shared_rows(rows, shares, response, True)
