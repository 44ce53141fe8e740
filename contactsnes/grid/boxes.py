"""Windows of several boxes, one around each spot of contact where spots are far apart: which nodes,
and their convolution.

Beyond the boxes there is no traction. So m boxes respond to each other by the cell's own kernel at
their offsets: each is transformed on a circle of twice the largest extent, and the spectra are
coupled in pairs. That is exact, and as cheap as the boxes are small beside the cell and few.
"""

from functools import cached_property

import numpy as np

from .active import NodesConvolution
from .cell import Convolution
from .filtering import clear_padding
from .windows import Window


class Spots:
    """Nodes of several disjoint boxes of the cell, all of one shape, with the interface of
    `windows.Window`.

    Parameters
    ----------
    grid : the cell
    start : first nodes, array (boxes, directions)
    shape : nodes of a box in each direction

    Attributes
    ----------
    parts : the boxes, each a Window; nodes are those of one box after the other
    """

    even, is_whole, picked, mirrors = False, False, False, Window.mirrors

    def __init__(self, grid, start, shape):
        self.grid = grid
        self.limits = grid.shape
        self.shape = self.extents = tuple(int(n) for n in shape)
        self.parts = tuple(sorted((Window(grid, first, self.shape) for first in start),
                                  key=lambda part: part.start))
        self.start = self.origin = tuple(part.start for part in self.parts)
        self.size = self.total = len(self.parts) * self.parts[0].size
        self._which = self.start, self.shape, grid.shape, grid.periods

    __eq__, __hash__ = Window.__eq__, Window.__hash__

    @cached_property
    def indices(self):
        """What picks the nodes from a field over the cell, in their order."""
        return np.unravel_index(self.node_numbers(), self.grid.shape)

    def take(self, field):
        """Values (..., nodes) of a field (..., *grid) at these nodes."""
        return np.concatenate([part.take(field) for part in self.parts], axis=-1)

    def put(self, values, field):
        """Write values (..., nodes) into a field (..., *grid) at these nodes."""
        for part, own in zip(self.parts, np.moveaxis(self.box(values), values.ndim - 1, 0)):
            field[(..., *part.indices)] = own

    def node_numbers(self):
        """Numbers of the nodes in the cell, array (nodes,)."""
        return np.concatenate([part.node_numbers() for part in self.parts])

    def box(self, values, beyond=0.0):
        """View values (..., nodes) as (..., boxes, *box), of which there are no others."""
        return values.reshape(*values.shape[:-1], len(self.parts), *self.shape)

    def rim(self):
        """Mask of the nodes on the borders of the boxes, in directions that these do not fill."""
        return np.tile(self.parts[0].rim(), len(self.parts))

    rim_places = Window.rim_places

    def area_below(self, values, level):
        """Length or area where values (nodes) lie below a level, the sum of all boxes."""
        each = np.split(values, len(self.parts), axis=-1)
        return sum(part.area_below(own, level) for part, own in zip(self.parts, each))

    def at_level(self, values, level, fields):
        """Fields where values cross a level, (components, crossings), of one box after another.

        Parameters
        ----------
        values, fields : arrays (nodes,) and (components, nodes) over the window
        level : float, unit of the values
        """
        both = self.box(np.concatenate([values[None], fields]))
        return np.concatenate([part.at_level(own[0].reshape(-1), level,
                                             own[1:].reshape(len(fields), -1))
                               for part, own in zip(self.parts, np.moveaxis(both, 1, 0))], axis=1)

    def circle(self):
        """Shape of the circle on which each box is transformed."""
        return self.parts[0].circle()


def in_words(window):
    """What is solved on a window, a sentence for the log."""
    boxes, total = len(window.parts), window.grid.size
    if boxes == 1:
        return f"spots near one another: one window of {window.size} nodes of {total}"
    return f"spots far apart: {boxes} boxes with {window.size} nodes in all instead of {total}"


class SpotsConvolution:
    """Product of a circulant operator of the cell with fields on several boxes.

    Parameters
    ----------
    window : Spots
    operator : Operator on the cell
    count : number of components
    make : as of `cell.Convolution`
    """

    def __init__(self, window, operator, count, make=None):
        self.window, self.count = window, count
        boxes, circle = len(window.parts), window.circle()
        self.transform = (make or window.grid.transform)(window.grid, circle, count * boxes)
        self._lay_out()
        self.blocks = {key: self._couplings(operator, key) for key in operator.blocks}

    def _lay_out(self):
        """Find where the boxes are on the circles of the transform, and room to multiply blocks."""
        plan, lead = self.transform, (self.count, len(self.window.parts))
        self._real = plan.real.reshape(*lead, *plan.shape)
        self._spectrum = plan.spectrum.reshape(*lead, -1)
        self._product = np.empty_like(self._spectrum[0])
        self._sums = np.empty_like(self._spectrum)
        self._inside = (slice(None), slice(None), *(slice(0, n) for n in self.window.shape))

    def _couplings(self, operator, key):
        """Half spectra (to box, from box, waves) of a block's kernel between boxes."""
        parts, extents = self.window.parts, self.window.shape
        plan = operator.circle(self.transform.shape)
        found = np.empty((len(parts), *self._spectrum.shape[1:]), dtype=complex)
        # Kernels of real blocks are even, those of imaginary ones odd: conjugates, there and back.
        sign = 1.0 if np.isrealobj(operator.blocks[key]) else -1.0
        for i, part in enumerate(parts):
            for j, other in enumerate(parts[:i + 1]):
                found[i, j] = operator.between(key, extents, plan,
                                               np.subtract(part.start, other.start)).reshape(-1)
                if i != j:
                    np.multiply(sign, found[i, j].conj(), out=found[j, i])
        return found

    def apply(self, values, out, transposed=False):
        """Write the operator, or its transpose, times values to out, which is returned.

        Parameters
        ----------
        values, out : arrays (components, nodes), perhaps the same one
        transposed : bool, whether the transpose is meant
        """
        self._real[self._inside] = self.window.box(values)
        clear_padding(self.transform.real, self.window.shape)
        self.transform.forward()
        self._sums[...] = 0.0
        for (i, j), block in self.blocks.items():
            if transposed:
                np.einsum("abk,ak->bk", block, self._spectrum[i].conj(), out=self._product)
                self._sums[j] += np.conj(self._product, out=self._product)
            else:
                self._sums[i] += np.einsum("abk,bk->ak", block, self._spectrum[j],
                                           out=self._product)
        self._spectrum[...] = self._sums
        self.transform.backward()
        self.window.box(out)[...] = self._real[self._inside]
        return out


def convolution(window, operator, count, make=None):
    """The product of an operator with fields on a window, of any kind.

    Parameters
    ----------
    window : Window, Spots or Nodes
    operator, count, make : as of `cell.Convolution`
    """
    kind = (SpotsConvolution if isinstance(window, Spots) else NodesConvolution
            if window.picked else Convolution)
    return kind(window, operator, count, make)
