"""Transforms of fields that are shared out among processes (`slab_even`) and even or odd in one
direction only, as `sides`, and circles of either kind of transforms.

Rows have their even and odd parts where they are. Columns are parted where they have come to.
"""

from functools import cached_property, partial

from .cosines import closes, gain_of
from .mirrors import without_mirror
from .sides import Sides, parts_of
from .slab_cosines import SlabCosines
from .slab_transform import SlabCircle, share


class Columns(SlabCosines):
    """Transforms along columns that are here, of ``real``, in place: of rows that have been
    transformed, and have come; parameters as of `SlabCosines`."""

    def _lay_out(self, comm, rows, kind):
        """Take memory for numbers of a type.

        Parameters
        ----------
        comm, rows, kind : as of `SlabCosines`
        """
        here = share(self.shape[1], comm.rank, comm.size)
        # where what is sent stands, or has come, at other times (`SlabSides`)
        self._take(self._grid.room((self._count // 2, 1),
                                   (self._count, self.shape[0], here.stop - here.start), kind))

    def _take(self, memory):
        """Take an array (count, points, columns here) to work on."""
        self.real = self.spectrum = memory

    def forward(self):
        """``real`` to ``spectrum``."""
        self._grid.counter.add(*self._cost)
        self._along_columns(False)

    def backward(self):
        """``spectrum`` to ``real``, times ``gain``."""
        self._grid.counter.add(*self._cost)
        self._along_columns(True)


class SlabSides(Sides):
    """Transforms of ``count`` fields that are on both sides of the axis in the direction of rows'
    numbers: rows are sent as they are, and parted into what is even and what is odd there.

    Parameters
    ----------
    grid, shape, count, rows : as of `slab_cosines.SlabCosines`, the rows those on both sides
    parities : as of `sides.Sides`
    kinds : of transforms of rows, and of parts of columns
    single : bool, whether they are in single precision
    """

    def __init__(self, grid, shape, count, rows, parities, kinds=(SlabCosines, Columns),
                 single=False):
        self._made_of = grid, shape, count, rows, parities, kinds
        total = max(first + number for first, number in rows)
        of_rows, of_columns = kinds
        super().__init__(grid, shape, count, parities, parts=of_columns(
            grid, shape, 2 * count, rows, parts_of(parities, 0), single))
        self._sent = of_rows(grid, (total, shape[1]), count, rows, parities, single)

    @cached_property
    def single(self):
        """The same in single precision, on the same memory."""
        return SlabSides(*self._made_of, True)

    def put(self, values):
        """Take fields (count, rows here, columns).

        Parameters
        ----------
        values : array
        """
        real, columns = self._sent.real, values.shape[2]
        real[..., :columns], real[..., columns:] = values, 0.0

    def take(self, out):
        """Write what the parts make together to fields (count, rows here, columns).

        Parameters
        ----------
        out : array
        """
        out[...] = self._sent.real[..., :out.shape[2]]

    def forward(self):
        """Fields to waves of parts."""
        self._sent.to_columns()
        super().put(self._sent.came)
        super().forward()

    def backward(self):
        """Waves of parts to fields, times ``gain``."""
        super().backward()
        super().take(self._sent.came)
        self._sent.from_columns()


def sides(grid, shape, count, rows, columns, parities):
    """Transforms of fields that are shared out and have one mirror.

    Parameters
    ----------
    grid, shape, count, rows : as of `slab_cosines.SlabCosines`
    columns : int, of fields that are put
    parities : as of `sides.Sides`
    """
    if without_mirror(parities) == 0:
        return SlabSides(grid, shape, count, rows, parities)
    return Sides(grid, shape, count, parities,
                 parts=SlabCosines(grid, shape, 2 * count, rows, parts_of(parities, 1)))


class SlabEvenCircle(SlabCircle):
    """Waves of even fields that are shared out: transforms on them, once it is known which process
    has which rows (`placed`).

    Parameters
    ----------
    grid, shape, count : as of `slab_cosines.SlabCosines`
    parities : as of `cosines.Cosines`, or of `sides.Sides`
    kind : of the transforms, as `slab_cosines.SlabCosines`
    make : what makes those of fields with one mirror, as `sides`
    """

    def __init__(self, grid, shape, count, parities=None, kind=SlabCosines, make=sides):
        self._sided = without_mirror(parities) is not None
        super().__init__(grid, shape, count,
                         partial(make if self._sided else kind, parities=parities))
        self._waves = kind.wavevectors
        self._closed = closes(grid, shape)
        self.gain = gain_of(shape, self._closed)

    def placed(self, rows, columns=None):
        """As `SlabCircle.placed`, of fields with so many columns.

        Parameters
        ----------
        rows : as of that
        columns : int
        """
        return super().placed(rows, *([columns] if self._sided else []))

    def wavevectors(self, spacings):
        """Wave numbers of this process's waves, 1/beta, to broadcast."""
        comm = self._grid.comm
        return self._waves(self.shape, self._closed, spacings,
                           share(self.shape[1], comm.rank, comm.size))
