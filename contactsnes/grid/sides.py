"""Convolutions of fields of the plane that are even or odd in one direction only: in the other one
they are on both sides of the axis, and their even and odd parts are transformed, each as such."""

import numpy as np

from .cosines import EvenConvolution, closes
from .filtering import Filtering
from .mirrors import without_mirror
from .parity import parity


def parts_of(parities, axis):
    """Parities of the even and the odd part of each field, one after the other.

    Parameters
    ----------
    parities : for each field and direction 1 (even) or -1 (odd), and 0 along the axis
    axis : int
    """
    return tuple(tuple(own if other == axis else sign for other, sign in enumerate(signs))
                 for signs in parities for own in (1, -1))


class Sides(Filtering):
    """Cosine and sine transforms of the even and the odd parts of ``count`` fields.

    Fields stand in ``real`` from its first node on, with their middle, which is taken for the axis,
    half of their extent further.

    Parameters
    ----------
    grid : Grid, whose counter counts
    shape : (int, int), points in each direction from the axis outwards
    count : int, number of fields
    parities : for each field and direction 1 (even) or -1 (odd), and 0 in one direction
    make : what makes transforms of the parts, as `cosines.Cosines`
    parts : these, if they are made already; ``make`` is not asked then

    Attributes
    ----------
    parts : transforms of twice as many fields, whose memory is ``real`` and ``spectrum``
    axis : the direction in which fields are on both sides
    """

    def __init__(self, grid, shape, count, parities, make=None, parts=None):
        self.shape, self.count, self.axis = tuple(shape), count, without_mirror(parities)
        self._given, self._extent = (grid, shape, count, parities), 0
        self.closed = closes(grid, self.shape)
        self.parts = parts or make(grid, self.shape, 2 * count, parts_of(parities, self.axis))
        self.real, self.spectrum, self.gain = self.parts.real, self.parts.spectrum, self.parts.gain
        self.wavevectors, self.ordered = self.parts.wavevectors, self.parts.ordered

    @property
    def single(self):
        """The same in single precision, on the same memory."""
        return Sides(*self._given, parts=self.parts.single)

    def put(self, values):
        """Take fields (count, *box): their parts to where they are transformed, 0 beyond.

        Parameters
        ----------
        values : array
        """
        n, real = values.shape[1 + self.axis], np.moveaxis(self.real, 1 + self.axis, 1)
        box, middle = np.moveaxis(values, 1 + self.axis, 1), values.shape[1 + self.axis] // 2
        self._extent, across = n, box.shape[2]
        real[...] = 0.0
        even, odd = real[::2, :, :across], real[1::2, :, :across]
        even[:, :n - middle] = box[:, middle:]
        odd[:, 1:middle + 1] = box[:, :middle][:, ::-1]
        even[:, 1:] *= 0.5
        odd[:, 1:] *= 0.5
        if self._is_whole(n):  # the first node, which is its own image
            even[:, middle] = 2.0 * odd[:, middle]
            odd[:, middle] = 0.0
            inner = slice(1, middle)
        else:
            inner = slice(1, middle + 1)
        there = even[:, inner].copy()
        even[:, inner] += odd[:, inner]
        np.subtract(there, odd[:, inner], out=odd[:, inner])

    def take(self, out):
        """Write what the parts make together to fields (count, *box).

        Parameters
        ----------
        out : array, of the shape of what was `put`
        """
        real = np.moveaxis(self.real, 1 + self.axis, 1)
        box, middle = np.moveaxis(out, 1 + self.axis, 1), out.shape[1 + self.axis] // 2
        n, across = self._extent, box.shape[2]
        even, odd = real[::2, :, :across], real[1::2, :, :across]
        np.add(even[:, :n - middle], odd[:, :n - middle], out=box[:, middle:], casting="same_kind")
        np.subtract(even[:, middle:0:-1], odd[:, middle:0:-1], out=box[:, :middle],
                    casting="same_kind")

    def _is_whole(self, extent):
        """Whether so many nodes are all of a direction that closes on itself."""
        return self.closed[self.axis] and extent == 2 * (self.shape[self.axis] - 1)

    def forward(self):
        """Parts to waves."""
        self.parts.forward()

    def backward(self):
        """Waves to parts, times ``gain``."""
        self.parts.backward()

    def inverted(self, compliance, stiffness):
        """As `Filtering.inverted`, for both parts of each field.

        Parameters
        ----------
        compliance, stiffness : as of that
        """
        return np.repeat(super().inverted(compliance, stiffness), 2, axis=0)

    def enter(self, weight, values):
        """As `Filtering.enter`.

        Parameters
        ----------
        weight, values : as of that
        """
        self.put(weight * values)

    def leave(self, into, back, values):
        """As `Filtering.leave`.

        Parameters
        ----------
        into, back, values : as of that
        """
        change = np.empty(values.shape)
        self.take(change)
        change -= into * values
        change *= back
        values += change


class SidedConvolution(EvenConvolution):
    """Product of a circulant operator of the cell with fields on half of a plane's window.

    A kernel that is odd in the direction without a mirror makes odd parts of even ones, and even
    ones of odd parts.

    Parameters
    ----------
    window : EvenWindow with a mirror in one direction, whose parities fit the operator's
    operator : Operator on the cell
    count : int, number of components
    make : what makes its transform, as `Cosines` of a grid, a shape, a count and parities

    Attributes
    ----------
    crosses : {(i, j): whether a block makes odd parts of even ones}
    """

    def __init__(self, window, operator, count, make):
        self._axis = without_mirror(window.parities)
        self.crosses = {key: parity(operator, key)[self._axis] < 0 for key in operator.blocks}
        super().__init__(window, operator, count, make)

    def _lay_out(self):
        """Find where parts come from: there is room of their own for none."""
        self._product = np.empty((2 * self.count, *self.transform.spectrum.shape[1:]),
                                 dtype=self.transform.spectrum.dtype)

    def _put(self, values):
        """Write values to the transform's circle, 0 elsewhere."""
        self.transform.put(self.window.box(values))

    def _take(self, out):
        """Read the window's nodes from the circle."""
        self.transform.take(self.window.box(out))

    def multiply(self, spectrum, transposed=False):
        """Multiply waves of the parts by the blocks, or by their transpose, in place.

        Parameters
        ----------
        spectrum : array (2 components, *waves)
        transposed : bool
        """
        product = self._product
        np.copyto(product, spectrum)
        spectrum[...] = 0.0
        for (i, j), block in self.blocks.items():
            to, source = (j, i) if transposed else (i, j)
            for part in (0, 1):
                crosses = self.crosses[i, j]
                found = block * product[2 * source + part]
                # sines of cosines, and of sines cosines with the sign reversed
                if crosses and part != transposed:
                    found *= -1.0
                spectrum[2 * to + (1 - part if crosses else part)] += found


def even_convolution(window, operator, count, make):
    """The convolution of an even window, of whatever mirrors.

    Parameters
    ----------
    window, operator, count, make : as of `cosines.EvenConvolution`
    """
    kind = EvenConvolution if all(window.mirrors) else SidedConvolution
    return kind(window, operator, count, make)
