"""Transforms of slabs, columns of whose waves the library transforms, and multiplies there by the
symbols of a response."""

import ctypes

import numpy as np
import pyfftw

from ..grid.cell import clear_padding
from ..grid.cosines import closes, cosine_waves
from ..grid.slab_cosines import SlabCosines
from ..grid.slab_transform import SlabTransform
from . import structures
from .fftw import Rows
from .library import shared
from .structures import address
from .transforms import COLUMNS, Compiled, Line, order_of


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

    def respond(self, response, transposed, symbols=None):
        """What stands in ``real`` times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the operator's symbols
        transposed : bool
        symbols : these as arrays, which are not asked for
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


class SlabEvenReal(SlabCosines):
    """`grid.slab_cosines.SlabCosines` made from real transforms by the library, which writes into
    its rows what nodes have. Waves are transposed, in the order of `transforms.Cosines`.

    Parameters
    ----------
    grid, shape, count, rows, parities, single : as of that

    Attributes
    ----------
    structure : of the library, with this process's rows of ``real`` as a field's
    """

    fitting = Compiled.fitting

    def _lay_out(self, comm, rows, kind):
        """Take memory for numbers of a type, and find what goes where.

        Parameters
        ----------
        comm, rows, kind : as of `SlabCosines`
        """
        super()._lay_out(comm, rows, kind)
        self.library, self._here = shared(), self.spectrum
        count, waves, columns = self._here.shape
        self.spectrum = self._packed[:self._here.size].reshape(count, columns, waves)
        self.structure = own = structures.Transform(count=count, single=kind.itemsize < 8)
        own.shape[:], own.real = self.real.shape[1:], address(self.real)
        self._lines = [Line(points, closed, bool(own.single))
                       for points, closed in zip(self.shape, closes(self._grid, self.shape))]

    def _along(self, fields, axis, back):
        """Transform the rows of fields, which are lines along an axis of the plane, in place."""
        line = ctypes.addressof(self._lines[axis].structure)
        for field, odd in zip(fields, self._odd[:, axis]):
            self.library.along_rows(line, address(field), len(field), back, odd,
                                    self.structure.single)

    def _along_rows(self, back):
        """Transform the rows of ``real``, in place."""
        self._along(self.real, 1, back)

    def _along_columns(self, back):
        """Turn what has come into rows of ``spectrum`` and transform these, or back."""
        if back:
            self._along(self.spectrum, 0, back)
        for here, turned in zip(self._here, self.spectrum):
            self.library.turn_field(address(here), *here.shape, address(turned), back,
                              self.structure.single)
        if not back:
            self._along(self.spectrum, 0, back)

    @staticmethod
    def wavevectors(shape, closed, spacings, mine):
        """Wave numbers of some columns of waves, 1/beta, to broadcast over a spectrum.

        Parameters
        ----------
        shape, closed, spacings, mine : as of `SlabCosines.wavevectors`
        """
        first, second = (axis.ravel()[order_of(points, one)] for axis, points, one in zip(
            cosine_waves(shape, closed, spacings), shape, closed))
        return first[None, :], second[mine, None]

    def ordered(self, symbol):
        """A symbol on this process's waves of `SlabCosines` in the order of these, of the cell."""
        return np.ascontiguousarray(symbol.T)

    def respond(self, response, transposed, symbols):
        """What stands in ``real`` times an operator, or its transpose, in place.

        Parameters
        ----------
        response : structure of the library, with the shape of what stands there
        transposed : bool
        symbols : {(i, j): array on this process's waves}
        """
        clear_padding(self.real, tuple(response.shape))
        self.forward()
        if all(i == j for i, j in symbols):
            for (i, _), symbol in symbols.items():
                self.spectrum[i] *= symbol
        else:
            given = self.spectrum.copy()
            self.spectrum[...] = 0.0
            for (i, j), symbol in symbols.items():
                to, source = (j, i) if transposed else (i, j)
                self.spectrum[to] += symbol * given[source]
        self.backward()
