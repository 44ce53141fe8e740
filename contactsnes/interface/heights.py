"""Heights on the grid from files, and steps at the seam of their cell."""

import warnings
from pathlib import Path

import numpy as np

from ..options.fields import LARGEST
from ..system.devices import failure

JUMP = 4.0
"""Step at the seam of a cell over those between neighbours from which on heights are told to be not
periodic."""


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
    heights = _as_stored(option, *_split(str(specification)))
    if shape is not None and heights.shape != tuple(shape):
        raise ValueError(f"{option}: the heights have shape {heights.shape}, the "
                         f"grid has {tuple(shape)}; set -scene_points and "
                         "-scene_dimension to those of the file.")
    return _usable(option, heights)


def _usable(option, heights):
    """Heights as numbers to compute with; ValueError, which names the option, where they are
    none."""
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


def _as_stored(option, filename, suffix, dataset):
    """The array of a file; FileNotFoundError or ValueError, which name the option, where it cannot
    be had."""
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
