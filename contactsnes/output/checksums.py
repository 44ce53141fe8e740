"""Checksums of an archive's parts, by which damage shows: of its frame, of the rows of its points
and of their fields."""

import zlib

import numpy as np

CHANGING = ("points", "complete", "frame")
"""Root attributes that points change, or that hold the checksum itself."""


def frame(file):
    """CRC-32 of what no point changes in an open archive: attributes, coordinates, names and units
    of columns."""
    found = zlib.crc32(_attributes(file, CHANGING))
    for group in ("scene", "runs", "branch", "fields"):
        for name, item in [("", file[group]),
                           *sorted(file[group].items())] if group in file else []:
            fixed = group == "runs" or name in ("x", "y", "initial_gap")
            for part in (f"{group}/{name}".encode(), _attributes(item, ("point",)),
                         _content(item[()]) if name and fixed else b""):
                found = zlib.crc32(part, found)
            for block in item.get("compliance", {}).values() if name == "active" else ():
                found = zlib.crc32(_content(block[()]), found)
    return found


def _attributes(item, without=()):
    """Attributes of a group or dataset as bytes."""
    return repr([(name, np.asarray(item.attrs[name]).tolist()) for name in sorted(item.attrs)
                 if name not in without]).encode()


def _content(values):
    """Values as bytes, of texts those of the texts."""
    values = np.asarray(values)
    return repr(values.tolist()).encode() if values.dtype.hasobject else values.tobytes()


def of(array, *more):
    """CRC-32 of an array, or of several, one after the other."""
    found = zlib.crc32(np.ascontiguousarray(array))
    for other in more:
        found = zlib.crc32(np.ascontiguousarray(other), found)
    return found


def rows(columns):
    """CRC-32 of each row of columns, a mapping of names to arrays of one length; in the order of
    the names."""
    parts = [np.ascontiguousarray(columns[name]) for name in sorted(columns)]
    table = (np.hstack([part.view("u1").reshape(len(part), -1) for part in parts]) if len(parts[0])
             else ())
    return np.array([zlib.crc32(line) for line in table], "u4")
