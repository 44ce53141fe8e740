"""Fields over nodes: from a grid to one on twice as many nodes in each direction, or on others, and
blurred."""

import itertools
import math
from typing import NamedTuple

import numpy as np
import scipy

from .active import Nodes
from .windows import Window

STRIP = 2 ** 20
"""Nodes of a plane that are interpolated at a time."""


class Cell(NamedTuple):
    """Points of a cell, of which a window may be."""

    shape: tuple
    periods: tuple = ()


def interpolation(window):
    """Cubic interpolation from the nodes of even number in a window to all of them, a sparse
    matrix."""
    from scipy import sparse

    lines = [_line(*sizes) for sizes in zip(window.start, window.shape, window.grid.shape)]
    return lines[0] if len(lines) == 1 else sparse.kron(*lines, format="csr")


def interpolated(window, values):
    """Values at the nodes of a window, from those at its nodes of even number: `interpolation`
    without its matrix."""
    sizes = list(zip(window.start, window.shape, window.grid.shape))
    box = values.reshape([(start + extent + 1) // 2 - (start + 1) // 2
                          for start, extent, _ in sizes])
    for axis, (start, extent, total) in enumerate(sizes):
        first, odd = start // 2, (extent + start % 2) // 2
        places = _columns(np.arange(first - 1, first + odd + 2), start, extent, total)
        known = box.take(places, axis).swapaxes(0, axis)
        before, left, right, after = (known[shift:shift + odd] for shift in range(4))
        fine = np.empty([*box.shape[:axis], extent, *box.shape[axis + 1:]])
        lines = fine.swapaxes(0, axis)
        lines[start % 2::2] = box.swapaxes(0, axis)
        lines[1 - start % 2::2] = 0.5625 * (left + right) - 0.0625 * (before + after)
        box = fine
    return box.reshape(-1)


def _columns(places, start, extent, total):
    """Numbers, among a direction's nodes of even number in a window, of those at places, or of the
    nearest ones.

    Parameters
    ----------
    places : array of int, half the numbers of nodes
    start, extent, total : first node of the window, and nodes of it and of the cell
    """
    first, after = (start + 1) // 2, (start + extent + 1) // 2
    return (places % (total // 2) if extent == total else np.clip(places, first, after - 1)
            - first)


def _line(start, extent, total):
    """Cubic interpolation along a direction, from the nodes of even number in a window to all of
    them, sparse."""
    from scipy import sparse

    nodes = np.arange(extent)
    below, odd = np.divmod(start + nodes, 2)
    rows = []
    columns = []
    weights = []
    for shift, weight in zip(range(-1, 3), (-0.0625, 0.5625, 0.5625, -0.0625)):
        place = below + shift
        rows.append(nodes)
        columns.append(_columns(place, start, extent, total))
        weights.append(np.where(odd, weight, float(shift == 0)))
    entries = np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))
    count = (start + extent + 1) // 2 - (start + 1) // 2
    matrix = sparse.csr_matrix(sparse.coo_matrix(entries, shape=(extent, count)))
    matrix.eliminate_zeros()
    return matrix


def resampled(grid, finer, fields, make=None):
    """Fields (components, *grid) on the finer grid, by the waves of the coarse one: at its nodes
    they are as they were, since the shortest wave, which no node tells from its mirror image, goes
    halves.

    Parameters
    ----------
    grid, finer : Grid, with even numbers of points, the finer one with more in each direction
    fields : array (components, *grid)
    make : what makes transforms, as `cell.Transform`, which may be kept; None: as the grid has it
    """
    count, half = len(fields), grid.shape[-1] // 2
    source = (make or grid.transform)(grid, grid.shape, count)
    source.real[...] = fields
    source.forward()
    target = (make or finer.transform)(finer, finer.shape, count)
    columns = finer.first_column + np.arange(target.spectrum.shape[-1])
    columns = columns[columns <= half]
    waves = grid.waves_at(source.spectrum, columns) / grid.size
    waves[..., columns == half] *= 0.5
    for axis, n in enumerate(grid.shape[:-1], start=1):
        waves.swapaxes(0, axis)[n // 2] *= 0.5
    target.spectrum[...] = 0.0
    # those of wave numbers from 0 on, and negative ones
    for rows in itertools.product(*((slice(0, n // 2 + 1), slice(-(n // 2), None))
                                    for n in grid.shape[:-1])):
        part = (slice(None), *rows, slice(0, len(columns)))
        target.spectrum[part] = waves[part]
    target.backward()
    return target.real.copy() if make or finer.shared else target.real


def smooth(window, values, width):
    """Values (nodes) on a window blurred by about a Gaussian of standard deviation ``width``
    (beta): zero where `blurred` leaves them out.

    Parameters
    ----------
    window : Window, Spots, Nodes or EvenWindow
    values : array (..., nodes)
    width : float, standard deviation, beta
    """
    if isinstance(window, Nodes):
        return smooth(window.hull, window.spread(values), width)[..., window.places]
    part, found = blurred(window, values, width)
    out = np.zeros(window.box(values).shape)
    out[(..., *window.parts[0].own(part)[1])] = found
    return out.reshape(values.shape)


def blurred(window, values, width):
    """The part of each box beyond which values stay zero when they are blurred, slices, and blurred
    values (..., *part) of what is here of it.

    Three running means: no transform, and a cost that does not depend on the width. Periodic in
    directions that the window fills; in others the values on its border continue outwards, in an
    even window as their mirror images. Each box of several for itself.

    Parameters
    ----------
    window, values, width : as of `smooth`, on a window of boxes
    """
    box, reaches = window.box(values), reach_of(window, width)
    part, wide, inner = reached(window, box != 0.0, reaches)
    found = around(window, box, wide, reaches[0]).astype(float)
    first = box.ndim - len(window.shape)
    negligible = 1e-12 * window.grid.maximum(np.abs(found), initial=0.0)
    for axis, (total, reach, line, mirror) in enumerate(zip(window.grid.shape, reaches, wide,
                                                            window.mirrors), first):
        # Of slabs nothing that counts for the rows that are here is beyond those around them.
        mode = ("nearest" if window.grid.shared and axis == first
                else "wrap" if line.stop - line.start == total
                else "mirror" if mirror else "nearest")
        for _ in range(3 if reach and found.size else 0):
            found = scipy.ndimage.uniform_filter1d(found, 2 * reach + 1, axis=axis, mode=mode)
    # Running sums leave rounding where they have passed the last value; there the blur is zero.
    found[np.abs(found) < negligible] = 0.0
    return part, window.grid.without_rows(found, 3 * reaches[0])[(..., *inner)]


def reached(window, mask, reaches):
    """The part of each box to which three running means take what is in a mask, slices; a node more
    on all sides, beyond which are zeros; and the one of what is here of the other.

    Parameters
    ----------
    window : as of `blurred`
    mask : array of bool (..., *box)
    reaches : as of `reach_of`
    """
    ends = window.parts[0].ends(mask.any(axis=tuple(range(mask.ndim - len(window.shape)))))
    part, wide = (tuple(
        _widened(*line, 3 * reach + more, *sizes)
        for line, reach, *sizes in zip(ends, reaches, window.extents, window.grid.shape,
                                       window.mirrors, window.parts[0].units))
        for more in (0, 1))
    own, here = (window.parts[0].own(each)[1] for each in (part, wide))
    return part, wide, tuple(slice(one.start - other.start, one.stop - other.start)
                             for one, other in zip(own, here))


def _widened(low, high, margin, count, total, even, unit):
    """From the first to the last place of a box's line, a margin wider, as far as it is known.

    Parameters
    ----------
    low, high, margin, count, total : int; ``count`` of the ``total`` of the cell are the line
    even : bool, whether it begins at its middle
    unit : int, of which the first place is a multiple
    """
    if high < low:
        return slice(0, 0)
    first, after = low - margin, high + 1 + margin
    if count == total and (first < 0 or after > count):
        return slice(0, count)
    return slice(0 if even else max(first - first % unit, 0), min(after, count))


def around(window, box, part, reach):
    """What is here of a part of a box (..., *box); of slabs, with so many rows on either side as
    three running means need.

    Parameters
    ----------
    window, box : Window of one box or several, array
    part : slices of the box
    reach : int, nodes that a mean takes on either side of a row
    """
    own = window.parts[0].own(part)[1]
    if not window.grid.shared:
        return box[(..., *own)]
    rows = window.with_rows(box[(..., *own[1:])], 3 * reach)
    return rows[..., own[0].start:own[0].stop + 6 * reach, :]


def reach_of(window, width):
    """How many nodes on either side each of the three means of `smooth` takes, by direction.

    Parameters
    ----------
    window, width : as of that
    """
    # The variance of three uniform means of 2 k + 1 nodes is k (k + 1).
    return [min(round(math.sqrt(0.25 + (width / spacing) ** 2) - 0.5), (points - 1) // 2)
            for points, spacing in zip(window.extents, window.grid.spacings)]


def refined(grid, values):
    """A field over the cell (*grid) from its values at every other node (`every_other`): cubic
    between these, in each direction."""
    if not grid.shared:
        return interpolated(grid.whole, values).reshape(grid.shape)
    first, count = grid.rows.first, grid.rows.count
    begin, end = _beneath(first, count)
    number = np.arange(begin, end) % (grid.shape[0] // 2)
    values = values[number] if grid.half is None else grid.half.rows.at(values, number)
    found, some = np.empty(grid.local_shape), max(1, STRIP // grid.shape[1])
    for at in range(first, first + count, some):
        rows = min(some, first + count - at)
        low, high = _beneath(at, rows)
        # rows of a larger cell, at whose ends nothing goes on
        shape = 2 * (high - low), grid.shape[1]
        part = Window(Cell((2 * shape[0], shape[1])), (0, 0), shape)
        wide = interpolated(part, values[low - begin:high - begin]).reshape(shape)
        found[at - first:at - first + rows] = wide[at - 2 * low:][:rows]
    return found


def _beneath(first, count):
    """The first of the rows of a coarser grid from which some of the finer one are interpolated,
    and the one after the last."""
    return (first - 8) // 2, (first + count + 9) // 2


def extent(mask, axis, margin=0):
    """Slice along an axis that holds every True of a mask and a margin of nodes; all of the axis if
    that does not fit.

    Parameters
    ----------
    mask : array of bool
    axis : int
    margin : int, nodes
    """
    line, = (mask if mask.ndim == 1 else mask.any(
        axis=tuple(i for i in range(mask.ndim) if i != axis))).nonzero()
    first, after = (line[0] - margin, line[-1] + 1 + margin) if line.size else (0, 0)
    return (slice(int(first), int(after)) if 0 <= first and after <= mask.shape[axis]
            else slice(0, mask.shape[axis]))


def by_waves(values, points, axis):
    """Periodic values at other places along an axis, (.., points, ..): those of the trigonometric
    polynomial through them, node i of n at (i - n//2)/n of the period.

    Parameters
    ----------
    values : array
    points : int
    axis : int
    """
    count = values.shape[axis]
    if count == points:
        return values
    # Dirichlet's kernel of the distance, in half turns: 1 at a node, 0 at the others
    angle = np.pi * (((np.arange(points) - points // 2) / points)[:, None]
                     - (np.arange(count) - count // 2) / count)
    wave = np.tan if count % 2 == 0 else np.sin  # (of even numbers the shortest wave goes halves)
    at_node = np.abs(np.sin(angle)) < 1e-12
    kernel = np.where(at_node, 1.0, np.sin(count * angle)
                      / (count * wave(np.where(at_node, 1.0, angle))))
    return np.moveaxis(np.tensordot(kernel, values, axes=(1, axis)), 0, axis)
