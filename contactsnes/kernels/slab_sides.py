"""Transforms of fields that are shared out and have one mirror (`grid.slab_sides`), made by the
library."""

from ..grid.mirrors import without_mirror
from ..grid.sides import Sides, parts_of
from ..grid.slab_sides import Columns, SlabSides
from .library import shared
from .slab_even import OfFolded, SlabEvenReal


class ColumnsReal(Columns, SlabEvenReal):
    """`grid.slab_sides.Columns` made from real transforms by the library: waves are transposed, in
    the order of `SlabEvenReal`."""

    def _take(self, memory):
        """As `Columns._take`."""
        count, points, here = memory.shape
        self.library, self.spectrum = shared(), memory.reshape(count, here, points)
        self.real = self.spectrum.swapaxes(1, 2)

    def _along_columns(self, back):
        """Transform the rows of ``spectrum``, which are columns, in place."""
        self._along(self.spectrum, 0, back)


class OfSides(OfFolded):
    """Base of transforms of fields with one mirror whose products are the library's."""

    def _known(self, *fields):
        """Take what `slab_even.SlabFolded` is made of but for its precision, the columns last."""
        *self.fields, self.columns = fields
        self.library = shared()


class AlongRows(OfSides, Sides):
    """Transforms of fields with a mirror across rows.

    Parameters
    ----------
    grid, shape, count, rows, columns, parities : as of `grid.slab_sides.sides`
    """

    def __init__(self, grid, shape, count, rows, columns, parities):
        self._known(grid, shape, count, rows, parities, columns)
        super().__init__(grid, shape, count, parities, parts=SlabEvenReal(
            grid, shape, 2 * count, rows, parts_of(parities, 1)))


class AlongColumns(OfSides, SlabSides):
    """Transforms of fields with a mirror across columns.

    Parameters
    ----------
    grid, shape, count, rows, columns, parities : as of `grid.slab_sides.sides`
    """

    def __init__(self, grid, shape, count, rows, columns, parities):
        self._known(grid, shape, count, rows, parities, columns)
        super().__init__(grid, shape, count, rows, parities, (SlabEvenReal, ColumnsReal))


def sides(grid, shape, count, rows, columns, parities):
    """As `grid.slab_sides.sides`.

    Parameters
    ----------
    grid, shape, count, rows, columns, parities : as of that
    """
    kind = AlongColumns if without_mirror(parities) == 0 else AlongRows
    return kind(grid, shape, count, rows, columns, parities)
