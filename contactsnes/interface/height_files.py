"""Files of heights, as they are: numbers, and the size and unit that they tell. Files are data:
nothing in them is executed."""

import math
import re
import textwrap
import warnings
from pathlib import Path

import numpy as np
from numpy.lib.format import MAGIC_PREFIX

from ..system.devices import failure
from .height_texts import read_table, size_and_unit, text_of
from .instruments import has_library, is_binary, topography
from .stored_heights import Heights, Stored, known, stored, unit_of

LONGEST = 300
"""Characters of a library's reason that are told."""
UNEVEN = 0.02
"""Part of a step by which places of points may miss a regular grid."""
FEWEST = 6
"""Rows from which on columns of numbers may be places and heights."""
EXTRA = ("use FILE.npy, FILE.txt, FILE.csv, FILE.xyz or FILE.h5:dataset, or install "
         "SurfaceTopography (pip install 'contactsnes[surfaces]'), which reads the files of "
         "instruments")


def read(specification):
    """The `Heights` of ``FILE.suffix`` or ``FILE.h5:dataset``.

    FileNotFoundError or ValueError, which name the option, where they cannot be had.
    """
    option = f"-scene_geometry_file {specification}"
    filename, suffix, dataset = split(str(specification))
    reader = READERS.get(suffix, _read_instrument)
    if reader is _read_instrument and not has_library():
        raise ValueError(f"{option}: unknown kind of file; {EXTRA}.")
    if not Path(filename).is_file():
        raise FileNotFoundError(
            f"{option}: there is no file {filename}; check the name and the directory.")
    why = failure(lambda: _look_at(reader(filename, dataset))) if suffix == ".h5" else ""
    try:
        if why:
            raise ValueError(why.removeprefix("ValueError: "))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of files without a number
            found = reader(filename, dataset)
    except Exception as error:  # a damaged file: whatever it makes of itself
        # SurfaceTopography tells of each of its readers, with parts of the file.
        reason = textwrap.shorten(str(error), LONGEST)
        raise ValueError(f"{option}: cannot be read ({reason}).") from None
    if not isinstance(found, Heights):
        found = Heights(found if isinstance(found, Stored) else np.asarray(found))
    if found.values.dtype.kind not in "fiu":
        raise ValueError(f"{option}: holds {found.values.dtype} instead of real numbers.")
    if 0 in found.values.shape or found.values.ndim not in (1, 2):
        raise ValueError(f"{option}: holds an array of shape {found.values.shape} "
                         "instead of heights on a line or a plane.")
    return found


def _look_at(found):
    """Read everything once."""
    for _ in found.values.blocks() if isinstance(found.values, Stored) else ():
        pass


def split(specification):
    """File name, suffix and dataset of FILE.npy, FILE.txt or FILE.h5:dataset."""
    stem, separator, dataset = specification.partition(".h5:")
    filename = stem + ".h5" if separator else specification
    return filename, Path(filename).suffix.lower(), dataset


def _datasets(file):
    """Names of the datasets of an HDF5 file, in groups, too, a dozen at most."""
    from ..system.hdf5 import h5py

    found = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset)
                    else None)
    return ", ".join(found[:12]) + (", ..." if len(found) > 12 else "") or "none"


def _read_dataset(filename, dataset):
    """A dataset of an HDF5 file."""
    from ..system.hdf5 import h5py  # needed for this kind of file only

    with h5py.File(filename, "r") as file:
        if not isinstance(file.get(dataset or "/"), h5py.Dataset):
            named = f"'{dataset}'" if dataset else "in the name"
            raise ValueError(f"there is no dataset {named}; write FILE.h5:dataset, "
                             f"there are: {_datasets(file)}")
        found, unit = stored(filename, dataset, file[dataset]), unit_of(file[dataset])
    return Heights(found if isinstance(found, Stored) else np.asarray(found), unit=unit)


def _read_map(filename, _=""):
    """A map as rows of numbers, with the size and unit that Gwyddion tells above them; of a file
    that is no text, what an instrument wrote under the same ending; ValueError for places, in
    columns or beside the heights."""
    if is_binary(filename) and has_library():
        return _read_instrument(filename)
    text = text_of(filename)
    table = read_table(text)
    found = np.squeeze(table)
    if found.ndim == 2 and found.shape[1] in (2, 3) and _are_points(found):
        raise ValueError(f"its {found.shape[1]} columns seem to be places and heights; call it "
                         "FILE.xyz to have it read so")
    for which, turned in (("column", found), ("row", found.T)):
        if found.ndim == 2 and len(turned.T) > 1 and _are_places(turned):
            raise ValueError(f"its first {which} seems to be places, evenly spaced, and no heights "
                             "as the next one; take places out, or save the map as FILE.npy")
    size, unit = size_and_unit(text, table.shape)
    return Heights(found, size, unit, metric=unit is None and size is not None)


def _are_places(table):
    """Whether the first column rises evenly below its corner, and the second does not."""
    first, second = table[1:, :2].T
    return len(first) >= FEWEST and _rises_evenly(first) and not _rises_evenly(second)


def _are_points(table):
    """Whether columns are places of a regular grid, and heights: of a line rising evenly, of a
    plane as many as there are places along x times those along y."""
    places = table[np.isfinite(table).all(axis=1), :-1]
    if len(places) < FEWEST:
        return False
    if places.shape[1] == 2:
        each = [len(np.unique(column)) for column in places.T]
        return min(each) > 1 and math.prod(each) == len(places)
    return _rises_evenly(places[:, 0])


def _rises_evenly(column):
    """Whether numbers rise, or fall, by one step."""
    steps = np.diff(column)
    return bool(steps[0] and np.abs(steps - steps.mean()).max() <= UNEVEN * abs(steps.mean()))


def _read_points(filename, _=""):
    """Points x y z of a regular grid in any order (x z of a line); places without one are holes;
    ValueError for two heights at one place."""
    table = read_table(text_of(filename))
    if table.shape[1] not in (2, 3):
        raise ValueError(f"it has {table.shape[-1]} columns; x y z, or x z of a line, are wanted")
    table = table[np.isfinite(table[:, :-1]).all(axis=1)]
    numbers, shape, size = [], [], []
    for name, places in zip("xy", table[:, :-1].T):
        number, step = _grid_numbers(places, name)
        numbers.append(number)
        shape.append(int(number.max()) + 1)
        size.append(step * shape[-1])
    if np.prod(shape) > 16 * len(table) + 1024:
        raise ValueError(f"its {len(table)} points lie on no regular grid")
    values = np.full(shape, np.nan)
    values[tuple(numbers)] = table[:, -1]
    other = np.isfinite(table[:, -1]) & (values[tuple(numbers)] != table[:, -1])
    if other.any():
        *place, height = table[np.argmax(other)]
        raise ValueError(f"it has two heights at {', '.join(f'{x:g}' for x in place)}, {height:g} "
                         f"and {values[tuple(n[np.argmax(other)] for n in numbers)]:g}, and at "
                         f"{np.count_nonzero(other) - 1} more places; leave one of each")
    return Heights(values, tuple(size))


def _grid_numbers(places, name):
    """Numbers of places on a regular grid, and its step."""
    found = np.unique(places)
    steps = np.diff(found)
    steps = steps[steps > 1e-6 * np.ptp(found)]
    if not len(steps):
        raise ValueError(f"all points have the same {name}")
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    numbers = (places - found[0]) / step
    if np.max(np.abs(numbers - np.rint(numbers))) > UNEVEN * max(1.0, 1e-3 * numbers.max()):
        raise ValueError(f"its points are not evenly spaced along {name}")
    return np.rint(numbers).astype(int), step


def _read_instrument(filename, _=""):
    """What SurfaceTopography makes of a file: with unit, holes and, where it tells it, size."""
    found, size = topography(filename)
    if not found.is_uniform:
        steps = np.diff(found.positions())
        if np.ptp(steps) > UNEVEN * abs(steps.mean()):
            raise ValueError("its points are not evenly spaced along x")
    values = np.ma.filled(np.ma.asarray(found.heights(), dtype=float), np.nan)
    return Heights(values, size, known(found.unit))


def _read_array(filename, _=""):
    """An array of NumPy, without objects: these are programs."""
    try:
        found = np.load(filename, allow_pickle=False, mmap_mode="r")
        if not isinstance(found, np.ndarray):
            raise ValueError(f"it holds arrays by name ({', '.join(found)}): save one of them")
        by_rows = isinstance(found, np.memmap) and found.flags.c_contiguous
        return stored(filename, "", found) if by_rows else np.load(filename, allow_pickle=False)
    except (ValueError, EOFError) as error:
        why = str(error)
    with open(filename, "rb") as file:
        if file.read(len(MAGIC_PREFIX)) != MAGIC_PREFIX and "by name" not in why:
            why = "it is no array of NumPy, whatever its name says"
        elif re.search("pickle|object", why):
            why = "it holds objects of Python, which are not read"
    raise ValueError(why)


READERS = {
    ".npy": _read_array,
    ".txt": _read_map, ".csv": _read_map, ".asc": _read_map, ".dat": _read_map,
    ".xyz": _read_points, ".h5": _read_dataset,
}
