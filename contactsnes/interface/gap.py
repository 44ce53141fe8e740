"""Initial gap of a shape on the grid, in units of u_n,r = beta^2/R; lengths in beta.

A new shape is one function and one row of `SHAPES`.
"""

import warnings
from pathlib import Path

import numpy as np

from ..options.fields import LARGEST
from ..system.devices import failure
from .roughness import surface

JUMP = 4.0
"""Step at the seam of a cell over those between neighbours from which on heights are told to be not
periodic."""


def _cylinder(coordinates, **_):
    """x^2/2: along y on a two-dimensional interface."""
    return coordinates[0] ** 2 / 2


def _sphere(coordinates, **_):
    """r^2/2."""
    return sum(x**2 for x in coordinates) / 2


def _sinusoid(coordinates, *, period, amplitude, **_):
    """Sum over the directions of A (1 - cos 2 pi x/L), by default of curvature 1."""
    return sum((amplitude if amplitude is not None else (length / (2 * np.pi)) ** 2)
               * 2 * np.sin(np.pi * x / length) ** 2 for x, length in zip(coordinates, period))


def _flat(coordinates, **_):
    """0."""
    return np.zeros(1)


def _file(coordinates, *, heights, **_):
    """max(h) - h: the highest point is the nearest to the flat."""
    return np.max(heights) - heights


def _rough(coordinates, *, period, roughness, **_):
    """|x|^2/2 - h, a self-affine h (`roughness.surface`), less its smallest value between nodes,
    too: the same on every grid."""
    found, lowest = surface(tuple(map(float, period)), *roughness)
    return found.gap(np.broadcast_shapes(*(x.shape for x in coordinates))) - lowest


SHAPES = {
    "cylinder": _cylinder,
    "sphere": _sphere,
    "sinusoid": _sinusoid,
    "flat": _flat,
    "file": _file,
    "rough": _rough,
}


def initial_gap(name, coordinates, period, *, amplitude=None, heights=None, roughness=None,
                offset=0.0):
    """Initial gap g_0 of a named shape, in units of u_n,r = beta^2/R.

    Parameters
    ----------
    name : str
        A row of `SHAPES`: ``cylinder`` (x^2/2, along y), ``sphere`` (r^2/2), ``sinusoid``
        (A (1 - cos 2 pi x/L), summed over the directions), ``flat`` (0), ``file`` (`heights`),
        ``rough`` (a parabola with `roughness`).
    coordinates : tuple of ndarray
        One array a direction in units of beta, broadcastable; the apex is at the origin.
    period : float or sequence of float
        Length of the cell, units of beta, one number or one a direction.
    amplitude : float, optional
        A of the sinusoid, units of u_n,r; by default (L/2 pi)^2 in each direction, of curvature 1.
    heights : ndarray, optional
        Heights of a ``file`` on the grid (`read_heights`); shifted so that the smallest gap is 0.
    roughness : tuple, optional
        Hurst exponent, rms slope, longest and shortest wave and seed of a ``rough`` shape
        (`roughness.surface`).
    offset : float
        Constant added to the gap, units of u_n,r.

    Returns
    -------
    ndarray
        The gap on every node of the grid, a new array.

    Raises
    ------
    ValueError
        If the name is no row of `SHAPES`, or a ``file`` comes without heights, a ``rough`` shape
        without roughness.
    """
    if name not in SHAPES:
        raise ValueError(f"-scene_geometry {name} is not a shape: use one of {', '.join(SHAPES)}.")
    if name == "file" and heights is None:
        raise ValueError(
            "-scene_geometry file needs heights: name their file with -scene_geometry_file.")
    if name == "rough" and roughness is None:
        raise ValueError("-scene_geometry rough needs its roughness: give "
                         "-scene_rough_slope and -scene_rough_shortest.")
    period = np.broadcast_to(period, (len(coordinates),))
    gap = SHAPES[name](coordinates, period=period, amplitude=amplitude, heights=heights,
                       roughness=roughness)
    return np.broadcast_to(gap, np.broadcast_shapes(*(x.shape for x in coordinates))) + offset


def is_convex(gap):
    """Whether a gap on a grid is convex within the cell, to rounding, and not the same everywhere:
    a body with one summit.

    Its second differences are those of a convex function: along each direction not negative, with a
    Hessian's determinant that is not, either. Half a cell away from the summit, where a body meets
    its neighbour, nothing is asked.
    """
    rounding = 8.0 * np.finfo(float).eps * np.max(np.abs(gap))
    axes, summit = tuple(range(gap.ndim)), np.unravel_index(np.argmin(gap), gap.shape)
    centred = np.roll(gap, [n // 2 - place for n, place in zip(gap.shape, summit)], axes)
    # A summit between two nodes has the border half a spacing beside the array's end.
    gap = centred[(slice(1, -1),) * gap.ndim]
    bends = [np.diff(gap, 2, axis) for axis in range(gap.ndim)]
    if np.ptp(gap) <= rounding or min(bend.min() for bend in bends) < -rounding:
        return False
    if gap.ndim == 1:
        return True
    along, across = bends[0][:, 1:-1], bends[1][1:-1]
    twist = (gap[2:, 2:] - gap[2:, :-2] - gap[:-2, 2:] + gap[:-2, :-2]) / 4
    return bool(np.min(along * across - twist ** 2) >= -rounding * max(bend.max()
                                                                       for bend in bends))


def read_heights(specification, shape=None):
    """Read heights on the grid from a file, in units of u_n,r, the highest nearest to the flat.

    Parameters
    ----------
    specification : str
        ``FILE.npy``, ``FILE.txt`` (numbers separated by blanks) or ``FILE.h5:dataset``.
    shape : tuple of int, optional
        Points of the grid in each direction; by default those of the file.

    Returns
    -------
    ndarray
        Heights, as they stand in the file.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the suffix is unknown, the file or its dataset cannot be read, or the
        heights are not real and finite numbers of the grid's shape.
    """
    option = f"-scene_geometry_file {specification}"
    filename, suffix, dataset = _split(str(specification))
    if suffix not in _READERS:
        raise ValueError(
            f"{option}: unknown kind of file; use FILE.npy, FILE.txt or FILE.h5:dataset.")
    if not Path(filename).is_file():
        raise FileNotFoundError(
            f"{option}: there is no file {filename}; check the name and the directory.")
    read = _READERS[suffix]
    why = failure(lambda: read(filename, dataset)) if suffix == ".h5" else ""
    try:
        if why:
            raise ValueError(why)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of files without a number
            heights = np.asarray(read(filename, dataset))
    except Exception as error:  # a damaged file: whatever it makes of itself
        raise ValueError(f"{option}: cannot be read ({error}).") from None
    if heights.dtype.kind not in "fiu":
        raise ValueError(f"{option}: holds {heights.dtype} instead of real numbers.")
    if shape is not None and heights.shape != tuple(shape):
        raise ValueError(f"{option}: the heights have shape {heights.shape}, the "
                         f"grid has {tuple(shape)}; set -scene_points and "
                         "-scene_dimension to those of the file.")
    if heights.size == 0 or heights.ndim not in (1, 2):
        raise ValueError(f"{option}: holds an array of shape {heights.shape} "
                         "instead of heights on a line or a plane.")
    if not np.all(np.isfinite(heights)):
        raise ValueError(
            f"{option}: some heights are not finite (nan or inf); fill the missing points first.")
    heights = heights.astype(float)
    if not np.abs(heights).max() <= LARGEST:
        raise ValueError(f"{option}: a height of {np.abs(heights).max():.3g} is "
                         "too large to compute with; allowed are sizes up "
                         f"to {LARGEST:g}.")
    return heights


def seams(heights):
    """Where heights jump at the seam of their cell: direction, step at the seam and typical step
    between neighbours, a list.

    Steps are root mean squares: of all neighbours for the typical one, and of those across the
    seam. A jump is a seam that steps `JUMP` times as far as neighbours do, those next to it, too,
    which are steep where a steep place of the surface lies at the seam.
    """
    found = []
    for axis in range(heights.ndim):
        steps = np.moveaxis(np.diff(heights, axis=axis), axis, 0)
        seam = np.take(heights, 0, axis) - np.take(heights, -1, axis)
        size, typical, beside = (float(np.sqrt(np.mean(part ** 2)))
                                 for part in (seam, steps, np.array([*steps[:2], *steps[-2:]])))
        if size > JUMP * max(typical, beside) and size > 1e-9 * np.ptp(heights):
            found.append((axis, size, typical))
    return found


def _split(specification):
    """File name, suffix and dataset of FILE.npy, FILE.txt or FILE.h5:dataset."""
    stem, separator, dataset = specification.partition(".h5:")
    filename = stem + ".h5" if separator else specification
    return filename, Path(filename).suffix, dataset


def _read_dataset(filename, dataset):
    """A dataset of an HDF5 file."""
    import h5py  # needed for this kind of file only

    with h5py.File(filename, "r") as file:
        if not isinstance(file.get(dataset or "/"), h5py.Dataset):
            raise KeyError(f"there is no dataset '{dataset}'; write FILE.h5:dataset, "
                           f"at the top level there are: {', '.join(file) or 'none'}")
        return file[dataset][()]


_READERS = {
    ".npy": lambda filename, _: np.load(filename, allow_pickle=False),
    ".txt": lambda filename, _: np.loadtxt(filename, encoding="utf-8-sig"),
    ".h5": _read_dataset,
}
