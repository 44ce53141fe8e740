"""Heights on the grid from files: cropped, their holes filled, their edges mended, fitted to the
grid."""

import math
import os
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..grid.transfer import by_waves
from ..options.fields import LARGEST, InputError
from ..system.processes import world
from . import height_files
from .seams import seams
from .stored_heights import Elsewhere, Stored

TAPER = 0.1
"""Part of the size at each edge over which a window takes heights to their mean."""
MARGIN = 8
"""A margin is a part of one over this of the map on each side."""
FILLS = ("none", "mean", "nearest", "interpolate")
EDGES = ("warn", "detrend", "window", "pad")


def prepared(specification, crop="", fill="none", edges="warn"):
    """`Heights` of a file, cropped, without holes, and with its edges mended; their size is that
    of what is left.

    Heights that are taken as they are stay in the file, if rows of it can be read. Others are held
    as a whole, of several processes by the first one, until `let_go`: numbers of a text stand in
    places that nobody knows before, and what is put into a hole or taken from an edge hangs on all
    the others.

    Parameters
    ----------
    specification : str
        ``FILE.npy``, ``FILE.txt``, ``FILE.csv``, ``FILE.xyz`` or ``FILE.h5:dataset``.
    crop : str, ``first:last`` nodes of each direction with a comma, empty for all
    fill : one of `FILLS`
    edges : one of `EDGES`
    """
    filename = height_files.split(str(specification))[0]
    try:
        known = os.stat(filename)
        version = known.st_mtime_ns, known.st_size
    except OSError:
        version = None
    return _prepared(str(specification), crop, fill, edges, version)


def let_go():
    """Hold no heights any more: they are where they are used."""
    _prepared.cache_clear()
    on_nodes.cache_clear()


@lru_cache(maxsize=2)
def _prepared(specification, crop, fill, edges, version):
    """`prepared`, once for each version of a file, and in one process."""
    whole = []

    def told():
        found = _made(specification, crop, fill, edges)
        if world.size == 1 or isinstance(found.values, Stored):
            return found
        whole.append(found)
        return replace(found, values=Elsewhere(found.values.shape))

    found = world.first(told)
    return whole[0] if whole else found


def _made(specification, crop, fill, edges):
    """`prepared`, anew."""
    option = f"-scene_geometry_file {specification}"
    found = height_files.read(specification)
    ends = _ends(crop, found.values)
    if min(end.stop - end.start for end in ends) < 2:
        raise ValueError(f"{option}: one height in a direction makes no surface; at least two are "
                         "needed, see -scene_heights_crop.")
    if isinstance(found.values, Stored) and (fill, edges) == ("none", "warn"):
        values = found.values._replace(part=ends)
        largest = _check_stored(option, values)
    else:
        values = _usable(option, _filled(option, np.asarray(found.values)[ends], fill))
        largest, values = np.abs(values).max(), MENDED[edges](values)
        values.flags.writeable = False
    size = found.size and tuple(length * n / whole for length, n, whole
                                in zip(found.size, values.shape, found.values.shape))
    return replace(found, values=values, size=size, digit=_last_digit(found.values.dtype, largest))


def _last_digit(dtype, size):
    """The last digit of a number of that size and type, 0 of whole numbers."""
    return float(np.spacing(np.asarray(size, dtype))) if dtype.kind == "f" else 0.0


def _check_stored(option, values):
    """The largest size of `Stored` heights; ValueError, as of `_usable` and `_filled`, for such
    that are none."""
    missing, largest = 0, 0.0
    for block in values.blocks():
        missing += np.count_nonzero(~np.isfinite(block))
        largest = max(largest, np.abs(block).max())
    _refuse_holes(option, missing, math.prod(values.shape))
    _refuse_large(option, largest)
    return largest


def _ends(crop, values):
    """What is left of heights, slices; InputError for a crop that leaves nothing, or is none."""
    if not crop:
        return tuple(slice(0, count) for count in values.shape)
    pieces = [piece.strip() for piece in crop.split(",")]
    chosen = []
    for piece, count in zip(pieces, values.shape):
        first, colon, last = piece.partition(":")
        try:
            ends = slice(int(first or 0), int(last or count))
        except ValueError:
            colon = ""
        if not colon or not 0 <= ends.start < ends.stop <= count:
            raise InputError(f"-scene_heights_crop is '{crop}': allowed is first:last, from 0 to "
                             f"{count} here, one per direction with a comma")
        chosen.append(ends)
    if len(pieces) != values.ndim:
        raise InputError(f"-scene_heights_crop is '{crop}': the heights have {values.ndim} "
                         "directions; give first:last for each, with a comma")
    return tuple(chosen)


def _filled(option, values, fill):
    """Heights with values where there were none; ValueError where that is not wanted."""
    holes = ~np.isfinite(values)
    if not holes.any():
        return values
    if fill == "none" or holes.all():
        _refuse_holes(option, np.count_nonzero(holes), holes.size)
    values = np.array(values, dtype=float)
    if fill == "mean":
        values[holes] = np.mean(values[~holes])
        return values
    from scipy import ndimage  # as in `fitted`: many scenes need none of it, and it takes time
    from scipy.interpolate import griddata

    nearest = ndimage.distance_transform_edt(holes, return_distances=False, return_indices=True)
    values[holes] = values[tuple(nearest)][holes]
    if fill == "interpolate":
        # Only what is around the holes matters.
        rim = ndimage.binary_dilation(holes, iterations=2) & ~holes
        known, places = np.argwhere(rim), np.argwhere(holes)
        if values.ndim == 1:
            between = np.interp(places[:, 0], known[:, 0], values[rim])
        elif np.linalg.matrix_rank(known - known[0]) == 2:
            between = griddata(known, values[rim], places, "linear")
        else:  # on a straight line there is nothing between them
            between = np.full(len(places), np.nan)
        values[holes] = np.where(np.isfinite(between), between, values[holes])
    return values


def _refuse_holes(option, missing, size):
    """ValueError where heights are missing.

    Parameters
    ----------
    option : str, how they are named
    missing, size : int, of so many heights
    """
    if missing == size:
        raise ValueError(f"{option}: there is nothing to fill from, all {size} heights are missing "
                         "(nan or inf); take another file, or another -scene_heights_crop.")
    if missing:
        raise ValueError(f"{option}: some heights are not finite (nan or inf), {missing} of {size} "
                         "heights are missing; fill the missing points first: -scene_heights_fill "
                         "interpolate, nearest or mean.")


def _refuse_large(option, largest):
    """ValueError where the largest size of a height is too large."""
    if not largest <= LARGEST:
        raise ValueError(f"{option}: a height of {largest:.3g} is too large to compute with; "
                         f"allowed are sizes up to {LARGEST:g}.")


def _usable(option, heights):
    """Heights as numbers to compute with, a new array; ValueError, which names the option, where
    they are too large."""
    heights = heights.astype(float)
    _refuse_large(option, np.abs(heights).max())
    return heights


def detrended(values):
    """Heights less the plane (or line) of least squares."""
    axes = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in values.shape), indexing="ij",
                       sparse=True)
    # On a grid the slopes are orthogonal to each other and to the mean.
    return values - values.mean() - sum(np.mean(values * x) / np.mean(x ** 2) * x for x in axes)


def windowed(values):
    """Detrended heights, taken to their mean towards the edges by half a cosine."""
    values = detrended(values)
    for axis, count in enumerate(values.shape):
        place = (np.arange(count) + 0.5) / count
        ramp = np.clip(np.minimum(place, 1.0 - place) / TAPER, 0.0, 1.0)
        values *= np.expand_dims(0.5 - 0.5 * np.cos(np.pi * ramp),
                                 tuple(i for i in range(values.ndim) if i != axis))
    return values


def padded(values):
    """Heights with a margin of their lowest height around them."""
    return np.pad(values, [(n // MARGIN, n // MARGIN) for n in values.shape],
                  constant_values=values.min())


MENDED = dict(zip(EDGES, (np.array, detrended, windowed, padded)))


@lru_cache(maxsize=1)
def on_nodes(heights, specification, shape, fit, edges):
    """The `fitted` values of `Heights`, held as these are: gap, checksum and cautions ask for them.

    Parameters
    ----------
    heights : Heights
    specification, shape, fit, edges : as of `fitted`
    """
    return fitted(specification, np.asarray(heights.values), shape, fit, edges)


def fitted(specification, values, shape, fit="exact", edges="warn"):
    """Heights on a grid; ValueError where these are other nodes and that is not wanted.

    Periodic heights are interpolated by their waves, which is exact where none is shorter than two
    of their own spacings; others, whose waves would ring at the seam, by cubic splines. So are
    those within a margin, on their own: at the step to it splines swing, too.

    Parameters
    ----------
    specification : str, of the file
    values : array, heights
    shape : tuple of int, points of the grid
    fit : 'exact' or 'interpolate', around the cell
    edges : one of `EDGES`, how they were mended
    """
    if values.shape == tuple(shape):
        return values
    if fit == "exact" or values.ndim != len(shape):
        raise ValueError(f"-scene_geometry_file {specification}: the heights have shape "
                         f"{values.shape}, the grid has {tuple(shape)}; set -scene_points and "
                         "-scene_dimension to those of the file"
                         + ("." if values.ndim != len(shape)
                            else ", or -scene_heights_fit interpolate."))
    if edges != "pad" and not seams(values):
        for axis, points in enumerate(shape):
            values = by_waves(values, points, axis)
        return values
    from scipy import ndimage

    places = [(np.arange(n) - n // 2) * (count / n) + count // 2
              for n, count in zip(shape, values.shape)]
    if edges == "pad":
        return _fitted_within(values, places)
    return ndimage.map_coordinates(values, np.meshgrid(*places, indexing="ij"), order=3,
                                   mode="grid-wrap")


def _fitted_within(values, places):
    """Heights with a margin at other places: within it by cubic splines, and a straight step to the
    margin over one spacing of theirs.

    Parameters
    ----------
    values : array, as of `padded`
    places : list of arrays, one a direction, in spacings of theirs
    """
    from scipy import ndimage

    # A margin of n // MARGIN on both sides of n heights is so much of them all.
    margins = [count // (MARGIN + 2) for count in values.shape]
    within = values[tuple(slice(margin, count - margin)
                          for margin, count in zip(margins, values.shape))]
    inner = [np.clip(place - margin, 0, count - 1)
             for place, margin, count in zip(places, margins, within.shape)]
    part = math.prod(np.meshgrid(*(np.clip(1 - np.abs(place - margin - near), 0, 1)
                                   for place, margin, near in zip(places, margins, inner)),
                                 indexing="ij", sparse=True))
    found = ndimage.map_coordinates(within, np.meshgrid(*inner, indexing="ij"), order=3,
                                    mode="mirror")
    lowest = values.min()
    return lowest + part * (found - lowest)
