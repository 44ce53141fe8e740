"""Transforms of slabs, columns of whose waves the library transforms, and multiplies there by the
symbols of a response."""

import ctypes
import weakref

import numpy as np

from ..grid import transfer
from ..grid.fftw import pyfftw
from ..grid.slab_transform import SlabTransform
from . import structures
from .asked import asked
from .fftw import Rows
from .library import shared
from .lines import COLUMNS
from .structures import address
from .transforms import Compiled


class OfLibrary:
    """What the library does with this process's rows of a transform's fields, which its
    ``structure`` tells of."""

    fitting, folded = Compiled.fitting, None
    sums_at, subtract_nodes = Compiled.sums_at, Compiled.subtract_nodes

    def _serve(self):
        """Have the library ask for products."""
        own, self.structure.counter = weakref.ref(self), address(self._grid.counter.numbers)
        self.structure.multiply = asked(structures.Multiply,
                                        lambda *given: own().multiply(*given))

    def filter(self, symbol):
        """What stands in the rows times symbols as of ``inverted``, in place."""
        self.multiply(None, address(symbol), False)

    @property
    def spectral(self):
        """The structure whose waves this process has."""
        return self.structure

    def inverted(self, compliance, stiffness):
        """As `Filtering.inverted`.

        Parameters
        ----------
        compliance, stiffness : as of that
        """
        own = self.spectral
        symbol = np.empty((own.count, own.waves), dtype=np.float32 if own.single else float)
        compliance = np.ascontiguousarray(compliance)
        for row, each in zip(symbol, stiffness):
            self.library.invert(ctypes.addressof(own), address(compliance), each, self.gain,
                                address(row))
        return symbol if own.packed else symbol.reshape(own.count, *compliance.shape)

    def enter(self, weight, values):
        """As `Filtering.enter`.

        Parameters
        ----------
        weight, values : as of that
        """
        weight, extent = np.ascontiguousarray(weight), (ctypes.c_long * 2)(*values.shape[1:])
        reference = ctypes.addressof(self.structure)
        for field, (own, box) in enumerate(zip(weight, values)):
            self.library.put_box(reference, field, extent, address(own), *_rows(box))
        self.library.clear_beyond(reference, extent)

    def leave(self, into, back, values):
        """As `Filtering.leave`.

        Parameters
        ----------
        into, back, values : as of that
        """
        into, back = np.ascontiguousarray(into), np.ascontiguousarray(back)
        extent = (ctypes.c_long * 2)(*values.shape[1:])
        for field, (there, again, box) in enumerate(zip(into, back, values)):
            self.library.blend_box(ctypes.addressof(self.structure), field, extent, address(there),
                                   address(again), *_rows(box))


def blurred(window, mask, width):
    """A mask (nodes), blurred as by `grid.transfer.blurred`.

    Parameters
    ----------
    window, mask, width : as of that
    """
    if not window.grid.shared:
        return transfer.blurred(window, mask, width)
    box, reaches = window.box(mask), transfer.reach_of(window, width)
    part, wide, inner = transfer.reached(window, box, reaches)
    wide = np.ascontiguousarray(transfer.around(window, box, wide, reaches[0]))
    out = np.empty((len(wide) - 6 * reaches[0], wide.shape[1]))
    if out.size:
        room, sums = np.empty((16, max(wide.shape))), np.empty(wide.shape, dtype=np.float32)
        # rows beyond those that are here stand in the box
        blur = structures.Blur(shape=wide.shape, reach=tuple(reaches), sums=address(room),
                               wraps=(0, wide.shape[1] == window.grid.shape[1]))
        shared().smooth_mask(ctypes.addressof(blur), wide.ctypes.data, window.even, 3 * reaches[0],
                             len(out), address(sums), address(out))
    return part, out[inner]


def _rows(box):
    """Where the rows of a part of an array of doubles begin, and how far they are from each
    other."""
    apart, one = box.strides
    if box.dtype != float or (box.size and one != box.itemsize) or apart % box.itemsize:
        raise ValueError("kernels take rows of doubles")
    return box.ctypes.data, apart // box.itemsize


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
