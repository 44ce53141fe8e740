"""Fields of an archive over the whole cell: how they are stored, and their empty datasets."""

import math

import numpy as np

from ..grid.parted import Parted, chunk, largest, pieces, typed
from .columns import make_field
from .files import ArchiveError

CHUNKS = 64
"""What one node of HDF5's chunk index holds; splitting a node is not safe against a kill."""

LARGEST = 2 ** 32 - 1
"""Bytes of a chunk at most, by HDF5's format."""

KINDS = {"double": "f8", "single": "f4"}
"""Precision of fields -> NumPy type."""

NOTHING = {"double": 0.0, "single": 1e-9}
"""Precision of fields -> part of the largest traction of a point that counts as none: numbers have
seven digits in single precision."""

PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
"""How fields are compressed."""


def as_stored(name, array, precision):
    """A field in the precision of the archive: single tractions that are nothing beside the largest
    are 0.

    Parameters
    ----------
    name : str
    array : array, perhaps `Parted`
    precision : {'double', 'single'}
    """
    array = array if isinstance(array, Parted) else np.asarray(array)
    if name == "traction" and precision == "single":
        least = NOTHING[precision] * largest(array)

        def acting(block):
            return np.where(np.abs(block) < least, 0.0, block)

        array = array.mapped(acting) if isinstance(array, Parted) else acting(array)
    return typed(array, KINDS[precision])


def most_together(kind, shape):
    """Number of points whose fields HDF5 stores in one piece.

    ArchiveError where a field alone is too large for that.
    """
    size = np.dtype(kind).itemsize * math.prod(shape)
    if size > LARGEST:
        raise ArchiveError(f"A field of the whole cell, {size / 1e9:.3g} GB, is larger than HDF5 "
                           "stores in one piece (4.29 GB): take -archive_fields_on active, "
                           "-archive_precision single or -archive_fields last.")
    return LARGEST // size


def empty(group, name, kind, chunks, fields, packed, parted):
    """Make the dataset of a field, without points; of the last point alone, of numbers that are
    none.

    Parameters
    ----------
    group : h5py.Group
    name : str
    kind : str, NumPy's type
    chunks : tuple of int, points that are allocated at once, and shape of a field
    fields : {'all', 'last'}, the points that have some
    packed : bool, whether it is compressed
    parted : bool, whether fields are written in parts
    """
    shape = chunks[1:]
    if fields == "last":
        made = group.create_dataset(name, (1, *shape), kind, fillvalue=np.nan)
        for where in pieces(shape):
            made[(0, *where)] = np.nan
    elif packed:
        inside = (*(1,) * (len(shape) - 2), *chunk(shape[-2:])) if parted else shape
        group.create_dataset(name, (0, *shape), kind, fillvalue=np.nan, maxshape=(None, *shape),
                             **PACKED, chunks=(1, *inside))
    else:
        make_field(group.id, name, kind, chunks)
