"""Preconditioners that were made in Python, as the library applies them, or asks for them, in
iterations whose vectors are in single precision."""

import ctypes

import numpy as np

from . import structures
from .asked import asked
from .structures import address


class AskedZone:
    """A zone that Python applies, of one box whose nodes processes share out, as the library asks
    for it.

    Parameters
    ----------
    kernel : CompiledForm
    apply : function (vector, out) of arrays in double precision, the second of which it fills
    """

    patches = None  # (each process has all patches, and few nodes)

    def __init__(self, kernel, apply=None):
        self._kernel = kernel
        own = self.structure = structures.Zone(form=ctypes.pointer(kernel.structure))
        self.reference = ctypes.addressof(own)
        if apply:
            self.ask(apply)

    def ask(self, apply):
        """Have a function as of the class do what is asked for from now on."""
        size = self._kernel.size
        floats = ctypes.c_float * size

        def applied(*places):
            vector, out = (np.ndarray(size, np.float32, floats.from_address(place))
                           for place in places)
            found = np.empty(size)
            apply(vector.astype(float), found)
            out[...] = found

        self.structure.elsewhere = asked(structures.Elsewhere, applied)

    def choose(self, single):
        """Have products in single precision, or in double, from now on."""
        self._kernel.set_precision(single)


class MadeZone(AskedZone):
    """A zone that was made in Python, of one box whose nodes processes share out, as the library
    applies it to vectors in single precision.

    Parameters
    ----------
    zone : `solvers.core_zone.CoreZone` of even states, whose transforms are the library's, or
        `solvers.two_grids.TwoGrids`
    kernel : CompiledForm
    """

    def __init__(self, zone, kernel):
        super().__init__(kernel)
        self._single, self._circles, self._kept, own = None, [], [zone], self.structure
        own.mean_count, own.columns = len(zone.means), address(zone.columns)
        own.means[:len(zone.means)] = zone.means
        own.inverse[:zone.inverse.size] = zone.inverse.reshape(-1)
        self._blocks = []
        for i, made in enumerate(zone.blocks):
            grids = getattr(made, "library", None)
            if grids:
                own.grids[i] = ctypes.pointer(grids.structure)
            elif made:
                self._take(own.block[i], made)

    def _take(self, block, made):
        """Take a core block.

        Parameters
        ----------
        block : structures.Block
        made : `solvers.core_blocks.CoreBlock`
        """
        weights = [np.ascontiguousarray(weight) for weight in (made.into, made.back)]
        block.on, (block.into, block.back) = 1, map(address, weights)
        block.first[:] = [part.start for part in made.index[1:]]
        block.extent[:] = made.into.shape[1:]
        self._kept.append(weights)
        self._blocks.append((block, made))

    def choose(self, single):
        """Have products, and cores, in single precision, or in double, from now on."""
        super().choose(single)
        if single is self._single:
            return
        self._single, self._circles = single, []
        for block, made in self._blocks:
            plan, symbol = made.circle(single)
            circle = structures.Circle(symbol=address(symbol))
            circle.quick = circle.transform = ctypes.pointer((plan.folded or plan).structure)
            block.circle, block.made = ctypes.pointer(circle), single
            self._circles.append((plan, symbol, circle))
