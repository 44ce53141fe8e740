"""What the library does with transforms of slabs, and with masks over these."""

import ctypes
import weakref

import numpy as np

from ..grid import transfer
from . import structures
from .asked import asked
from .library import shared
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
        shared().smooth_mask(ctypes.addressof(blur), wide.ctypes.data, window.mirrors[1],
                             3 * reaches[0], len(out), address(sums), address(out))
    return part, out[inner]


def _rows(box):
    """Where the rows of a part of an array of doubles begin, and how far they are from each
    other."""
    apart, one = box.strides
    if box.dtype != float or (box.size and one != box.itemsize) or apart % box.itemsize:
        raise ValueError("kernels take rows of doubles")
    return box.ctypes.data, apart // box.itemsize
