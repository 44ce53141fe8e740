"""Files of instruments, by the library SurfaceTopography."""

import importlib.util
from pathlib import Path

HEAD = 4096
"""Bytes that tell a text, which has none that is 0."""


def has_library():
    """Whether SurfaceTopography is there."""
    return importlib.util.find_spec("SurfaceTopography") is not None


def topography(filename):
    """The first channel of a file, the library's object, and its size: count x step, a tuple with
    one length a direction in the unit of the file, or None where the file tells none.

    Raises
    ------
    ValueError
        For a text without a size, of which the library takes numbers and no more.
    """
    from SurfaceTopography import open_topography

    with open_topography(filename) as reader:
        channel = reader.default_channel
        if not channel.is_uniform:
            found = reader.topography()
            return found, _from_positions(found)
        if channel.physical_sizes is not None:
            found = reader.topography()
            return found, tuple(map(float, found.physical_sizes))
        if b"\0" not in Path(filename).read_bytes()[:HEAD]:
            raise ValueError("a text that tells no size; call it FILE.txt to have its numbers read "
                             "as a map whose rows follow each other along x")
        return reader.topography(physical_sizes=(1.0,) * channel.dim), None


def _from_positions(found):
    """The size of a profile of points, which the library has from the first to the last one."""
    places = found.positions()
    return (float((places[-1] - places[0]) * len(places) / (len(places) - 1)),)
