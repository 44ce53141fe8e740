"""Files of instruments, by the library SurfaceTopography."""

import codecs
import importlib.util

HEAD = 4096
"""Bytes that tell a file of text, which has none that is 0."""
WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
"""How text of two bytes a letter begins, as spreadsheets write it."""


def has_library():
    """Whether SurfaceTopography is there."""
    return importlib.util.find_spec("SurfaceTopography") is not None


def is_binary(filename):
    """Whether a file is no text."""
    with open(filename, "rb") as file:
        head = file.read(HEAD)
    return b"\0" in head and not head.startswith(WIDE)


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
        if not is_binary(filename):
            raise ValueError("a text that tells no size; call it FILE.txt to have its numbers read "
                             "as a map whose rows follow each other along x")
        return reader.topography(physical_sizes=(1.0,) * channel.dim), None


def _from_positions(found):
    """The size of a profile of points, which the library has from the first to the last one."""
    places = found.positions()
    return (float((places[-1] - places[0]) * len(places) / (len(places) - 1)),)
