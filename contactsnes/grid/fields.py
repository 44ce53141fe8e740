"""What of a cell's fields, waves and unknowns is in this process: all of it, but in `slabs`."""

import numpy as np

from .contours import first_largest


def mirrored(field, axis):
    """Mirror image about the apex, along an axis, of an array that the cell's nodes fill there."""
    return np.roll(np.flip(field, axis), 1, axis)


class Fields:
    """Fields over the cell of a grid in one process, of which nothing is elsewhere.

    A class that has it has ``shape`` and ``spacings`` of the cell.
    """

    shared = False
    """Whether nodes are shared out among processes: each has rows of the cell, of a box about its
    apex or of a quarter of that, or some nodes of its rows."""

    idle = 0
    """How many processes have no rows."""

    @property
    def local_shape(self):
        """Shape of a field over the cell, as far as it is in this process."""
        return self.shape

    def with_rows(self, field, reach):
        """A field over the cell (..., *grid) with rows around what is here: nothing is missing."""
        return field

    def without_rows(self, field, reach):
        """The same without them."""
        return field

    def row_before(self, field):
        """The row of a field over the cell before the first one that is here."""
        return field[-1]

    def first_part(self, field, part):
        """(first row and number of rows, values there) of the first nodes of a field over the cell,
        as far as they are this process's: all.

        Parameters
        ----------
        field : array (*grid)
        part : slices from 0 on
        """
        return (0, part[0].stop), field[part]

    def mirrored(self, field, axis):
        """Mirror image about the apex, along an axis of the cell, of a field over it (..., *grid).

        Parameters
        ----------
        field : array
        axis : int, of the cell
        """
        return mirrored(field, axis - len(self.shape))

    @property
    def row_numbers(self):
        """Numbers in the cell of the rows that are here."""
        return np.arange(self.shape[0])

    def part_of(self, field):
        """What is here of a whole field over the cell (..., *grid): all."""
        return field

    def spread(self, make):
        """A whole field over the cell (*grid) that a function makes, as far as it is here: all."""
        return make()

    def turns(self, items):
        """Of things that every process has one after the other those that are this one's to do:
        all."""
        return items

    def in_turn(self, field):
        """Rows of a field over the cell, of one process after the other; in the first one, which
        never has more than those of one other."""
        yield field

    def of_first(self, value):
        """A value of the first process, in all of them."""
        return value

    half = None
    """Grid of every other node, where that is shared out among processes, too."""

    def every_other(self, field):
        """A field over the cell (..., *grid) at every other node."""
        return field[(..., *[slice(None, None, 2)] * len(self.shape))]

    @property
    def first_column(self):
        """Number of the first column of half spectra that is here."""
        return 0

    def quantiles(self, field, parts):
        """Values below which parts of a field over the cell lie, about."""
        return np.quantile(field, parts)

    def edge(self, field, axis):
        """The first nodes of a field over the cell along an axis."""
        return np.take(field, [0], axis)

    def highest(self, field):
        """The first node of the largest value of a field over the cell, a tuple of int."""
        return np.unravel_index(np.argmax(field), field.shape)

    def place(self, node):
        """Coordinates of a node, beta."""
        return [(i - n // 2) * h for i, n, h in zip(node, self.shape, self.spacings)]

    def before(self, count):
        """How many the processes before this one have of what this one has so many."""
        return 0

    def joined(self, rows):
        """What all processes have of an array, one after the other along its first axis."""
        return rows

    def first_largest(self, field):
        """The largest size of values (components, *grid), with the sign of the first about as
        large."""
        return np.copysign(np.max(np.abs(field)), field.flat[first_largest(field.reshape(-1))])

    def parted(self, values, axis=-1, change=lambda block: block):
        """What a function makes of an array, for what takes it block by block where processes have
        parts of it: all of that.

        Parameters
        ----------
        values : array
        axis : int, along which processes would have parts
        change : function (array), of each number by itself
        """
        return change(values)

    def taking(self, act):
        """Call a function that takes blocks of `parted` arrays, in the first process."""
        act()

    def in_order(self, keys, arrays):
        """Arrays of nodes (..., nodes) in the order of keys, `parted`.

        Parameters
        ----------
        keys : list of arrays of int (nodes,), the first of which decides first
        arrays : mapping
        """
        order = np.lexsort(keys[::-1])
        return {name: values[..., order] for name, values in arrays.items()}

    def evened(self, rows):
        """Of what all processes have of an array along its first axis about as much for each, to be
        worked on: all."""
        return rows

    def to_first(self, values):
        """Values (..., nodes) of all processes in the first of them, None in the others."""
        return values

    def together(self, parts):
        """Sums of what the parts of the cell have, in all processes."""
        return parts

    def largest(self, number):
        """The largest of what the parts of the cell have, in all processes."""
        return number

    def ends(self, lines):
        """(lowest, highest) of whole numbers, of each of some arrays, in all processes: a list."""
        most = np.iinfo(np.int32).max
        found = self.largest([(-int(np.min(line, initial=most)), int(np.max(line, initial=-most)))
                              for line in lines])
        return [(-int(below), int(highest)) for below, highest in found]

    def any(self, mask):
        """Whether ``mask`` holds anywhere."""
        return bool(self.largest(mask if isinstance(mask, bool)
                                 else np.logical_or.reduce(mask, axis=None)))

    def in_patches(self, apart):
        """Whether the cell is made of patches of ``apart`` nodes, two or more in each direction."""
        return not any(points % apart or points < 2 * apart for points in self.shape)

    # Scalars among the unknowns stand behind the nodes; `slabs` has them in one process only.
    def scalars(self, tail, count):
        """Scalars among unknowns, from what stands behind the nodes, so many."""
        return tail

    def held(self, scalars):
        """Of scalars those that are kept here: all."""
        return scalars

    # Waves, of which half are kept.
    even_window = even_circle = None
    """Class of windows of even fields, and what makes their transforms, where nodes are shared
    out."""
    circle = None
    """What makes transforms on circles smaller than the cell, where that is shared out."""

    def of_circle(self, shape):
        """The grid that has the points of a circle of a shape.

        Parameters
        ----------
        shape : points in each direction
        """
        return self

    def placed(self, transform, first, count):
        """A transform of a circle, of which this process has some rows: all.

        Parameters
        ----------
        transform : on the circle
        first, count : int, on the circle
        """
        return transform

    def zero_wave(self, spectrum):
        """The values at q = 0 of half spectra (..., *half spectrum), as a view."""
        return spectrum[(..., *[slice(0, 1)] * len(self.shape))]

    def waves_at(self, spectrum, columns):
        """Columns of half spectra (..., *half spectrum), by their numbers."""
        return spectrum[..., columns]

    def lone_columns(self):
        """Columns of half spectra that stand for one wave, as far as they are here: the first one
        and, of an even number of points, the last; others stand for two."""
        return (0, self.shape[-1] // 2) if self.shape[-1] % 2 == 0 else (0,)
