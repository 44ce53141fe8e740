"""Checksums of an archive's parts, by which damage shows: of its frame, of the rows of its points
and of their fields."""

import zlib
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from ..grid.parted import blocks, pieces

CHANGING = ("points", "complete", "frame")
"""Root attributes that points change, or that hold the checksum itself."""


class Part(NamedTuple):
    """A group or dataset of an open archive: its name from the root, itself (None where its
    attributes were known), its attributes."""

    name: str
    item: object
    attributes: dict


def parts(file, known=MappingProxyType({})):
    """The groups of an open archive and what lies in them, each opened and read once: a list of
    `Part`, the root first.

    Parameters
    ----------
    file : h5py.File
    known : mapping, names -> attributes that have just been written
    """
    names = ["", *(f"{group}/{name}" for group in ("scene", "runs", "branch", "fields")
                   if group in file for name in ("", *sorted(file[group])))]
    return [Part(name, None, known[name]) if name in known else _read(name, file[name or "/"])
            for name in names]


def _read(name, item):
    """The Part of an open group or dataset."""
    return Part(name, item, dict(item.attrs))


def frame(parts):
    """CRC-32 of what no point changes in an open archive, given as its `parts`: attributes,
    coordinates, names and units of columns."""
    found = zlib.crc32(_attributes(parts[0].attributes, CHANGING))
    for name, item, attributes in parts[1:]:
        group, _, within = name.partition("/")
        fixed = group == "runs" or within in ("x", "y", "initial_gap")
        for part in (name.encode(), _attributes(attributes, ("point",))):
            found = zlib.crc32(part, found)
        if within and fixed:
            found = _of_dataset(item, found)
        for block in item.get("compliance", {}).values() if within == "active" else ():
            found = _of_dataset(block, found)
    return found


def _attributes(attributes, without=()):
    """Attributes of a group or dataset as bytes."""
    return repr([(name, np.asarray(attributes[name]).tolist()) for name in sorted(attributes)
                 if name not in without]).encode()


def _of_dataset(item, found):
    """CRC-32 of the values of a dataset, of texts those of the texts, after what was found."""
    if item.dtype.hasobject:
        return zlib.crc32(repr(np.asarray(item[()]).tolist()).encode(), found)
    for where in pieces(item.shape):
        found = zlib.crc32(np.ascontiguousarray(item[where]), found)
    return found


def of(*arrays):
    """CRC-32 of an array, or of several, one after the other; perhaps `Parted`."""
    found = 0
    for array in arrays:
        for _, block in blocks(array):
            found = zlib.crc32(np.ascontiguousarray(block), found)
    return found


def rows(columns):
    """CRC-32 of each row of columns, a mapping of names to arrays of one length; in the order of
    the names."""
    parts = [np.ascontiguousarray(columns[name]) for name in sorted(columns)]
    table = (np.hstack([part.view("u1").reshape(len(part), -1) for part in parts]) if len(parts[0])
             else ())
    return np.array([zlib.crc32(line) for line in table], "u4")
