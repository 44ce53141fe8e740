"""Transforms of slabs, columns of whose waves the library transforms, and multiplies there by the
symbols of a response."""

import ctypes

import numpy as np
import pyfftw

from ..grid.slab_transform import SlabTransform
from . import structures
from .fftw import Rows
from .library import shared
from .structures import address
from .transforms import COLUMNS, Compiled


class SlabReal(SlabTransform):
    """`grid.slab_transform.SlabTransform`, of whose columns of waves the library has charge.

    Parameters
    ----------
    grid, shape, count, rows, single : as of that

    Attributes
    ----------
    structure : of the library, with this process's rows of ``real`` as a field's
    block : a few columns of each field, and of a symbol
    """

    fitting = Compiled.fitting

    def _plan_columns(self, planned):
        """Plan columns, some of which are transformed at a time.

        Parameters
        ----------
        planned : function, of rows' plans
        """
        self.library, single = shared(), self.real.itemsize < 8
        self.structure = own = structures.Transform(count=self._count, single=single)
        own.shape[:], own.real = self.real.shape[1:], address(self.real)
        self.block = pyfftw.zeros_aligned((self._count + 1, COLUMNS, self.shape[0]),
                                          dtype=self.spectrum.dtype)
        self._plans = Rows(self.shape[0], self._count * COLUMNS, address(self.block), single)
        self._columns = structures.Columns(
            count=self._count, rows=self.shape[0], columns=self.spectrum.shape[2], single=single,
            spectrum=address(self.spectrum), block=address(self.block),
            there=self._plans.forward, back=self._plans.backward)
        self._reference = ctypes.addressof(self._columns)

    def places(self, numbers):
        """Where the library has the nodes of some numbers in ``real``."""
        return np.asarray(numbers, dtype=np.intc)

    def _along_columns(self, back):
        """Transform the columns of waves."""
        self.library.along_columns(self._reference, not back, back, None, 0)

    def respond(self, response, transposed):
        """What stands in ``real`` times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the operator's symbols
        transposed : bool
        """
        self._to_columns()
        self.library.along_columns(self._reference, True, True, ctypes.addressof(response),
                                   transposed)
        self._from_columns()

    def filter(self, symbol):
        """What stands in ``real`` times real symbols of its precision, (count, *spectrum)."""
        response = structures.Response(components=self._count)
        for i, own in enumerate(symbol):
            response.symbol[i][i] = address(own)
        self.respond(response, False)
