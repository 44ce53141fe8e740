"""Products with symbols, which every pair of transforms can do, and of parts of its fields."""

import numpy as np


class Filtering:
    """Base of pairs of transforms: ``forward`` from ``real`` to ``spectrum``, and ``backward``;
    together they multiply by ``gain``."""

    def filter(self, symbol):
        """Multiply what stands in ``real`` by real symbols (count, *spectrum) of its precision, in
        place."""
        self.forward()
        self.spectrum *= symbol
        self.backward()

    @staticmethod
    def fitting(block):
        """A symbol as `filter` takes it."""
        return block

    @staticmethod
    def places(numbers):
        """Where in ``real`` the points of some numbers on the circle are."""
        return numbers

    def inverted(self, compliance, stiffness):
        """The symbol 1 / (gain (1 + C D)) of each field, of the precision of ``real``.

        Parameters
        ----------
        compliance : array (*spectrum), C
        stiffness : array (count,), D
        """
        symbol = np.multiply.outer(stiffness, compliance)
        symbol += 1.0
        np.divide(1.0 / self.gain, symbol, out=symbol)
        return symbol.astype(self.real.dtype, copy=False)

    def enter(self, weight, values):
        """Write weights times values (count, *box) to the first nodes of ``real``, 0 to others."""
        inner = self.real[(slice(None), *(slice(0, n) for n in values.shape[1:]))]
        np.multiply(weight, values, out=inner, casting="same_kind")
        clear_padding(self.real, values.shape[1:])

    def leave(self, into, back, values):
        """Add to values what stands in ``real`` less ``into`` times them, times ``back``.

        Parameters
        ----------
        into, back : arrays (count, *box), or what spreads to them
        values : array (count, *box)
        """
        inner = self.real[(slice(None), *(slice(0, n) for n in values.shape[1:]))]
        change = into * values
        np.subtract(inner, change, out=change)
        change *= back
        values += change

    def sums_at(self, places, nodes, weight, values):
        """Sums of weights times values at nodes for each place in ``real``, of one field.

        Parameters
        ----------
        places, nodes : arrays of intc; several nodes may have one place
        weight : array (nodes,)
        values : array
        """
        sums = np.bincount(places, weight * values[nodes], self.real.size)
        return sums.astype(float, copy=False)  # (of no nodes they are integers)

    def subtract_nodes(self, places, nodes, weight, own, values):
        """Subtract from values at nodes their weights times what stands in their places, and
        ``own`` times the square of these.

        Parameters
        ----------
        places, nodes, weight, values : as of `sums_at`
        own : float
        """
        change = own * weight * values[nodes]
        change += self.real.reshape(-1)[places]
        values[nodes] -= weight * change


def clear_padding(real, shape):
    """Set to zero what a buffer (count, *circle) holds beyond a box of the given shape."""
    for axis, extent in enumerate(shape, start=1):
        if extent < real.shape[axis]:
            real[(*[slice(None)] * axis, slice(extent, None))] = 0.0
