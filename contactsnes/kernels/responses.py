"""Products with a convolution's symbols, as the library takes them."""

import ctypes

import numpy as np

from . import structures
from .slab_real import SlabPacked
from .structures import address
from .transforms import Packed

WAVES = 2048
"""Waves of a spectrum that blocks are multiplied with at a time, as kernels.h has it."""


def _copied(transform, by_columns=False):
    """Memory for the part of spectra that blocks are multiplied with at a time."""
    if isinstance(transform, (Packed, SlabPacked)):
        return transform.found
    if by_columns or transform.structure.packed:
        return np.empty_like(transform.block)
    return np.empty((transform.count, WAVES), dtype=transform.spectrum.dtype)


def _symbols(blocks, transform):
    """Blocks as the library takes them, by (i, j): of two that are equal, as those of even fields
    are across the diagonal, one."""
    symbols = {}
    for (i, j), block in blocks.items():
        other = symbols.get((j, i))
        alike = i != j and other is not None and np.array_equal(block, blocks[j, i])
        symbols[i, j] = other if alike else transform.fitting(block)
    return symbols


def response(convolution, count, transform):
    """The structure of a convolution's product, and what it keeps.

    Parameters
    ----------
    convolution : with a compiled transform
    count : int, number of components
    transform : its own, or that in single precision
    """
    window = convolution.window
    boxes = len(window.parts)
    own = structures.Response(components=count, boxes=boxes)
    own.transform = ctypes.pointer(transform.structure)
    own.shape[:] = (1,) * (2 - len(window.shape)) + tuple(window.shape)
    product, symbols = None, _symbols(convolution.blocks, transform)
    crosses = getattr(convolution, "crosses", {})
    for (i, j), symbol in symbols.items():
        own.symbol[i][j], own.is_complex[i][j] = address(symbol), np.iscomplexobj(symbol)
        own.crosses[i][j] = crosses.get((i, j), False)
    # one real block of one box is multiplied where it stands, and so are blocks on the diagonal of
    # even fields
    if window.even:
        product = (None if all(i == j for i, j in symbols)
                   else _copied(transform, window.grid.shared))
    elif count > 1 or boxes > 1 or np.iscomplexobj(symbols[0, 0]):
        product = _copied(transform, window.grid.shared)
    if product is not None:
        own.product = address(product)
    if window.picked:
        places = transform.places(window.on_circle), window.places
        own.picked = window.size
        own.on_circle, own.in_box = map(address, places)
        pairs = transform.pairs_with(places[0]) if isinstance(transform, SlabPacked) else None
        own.pairs = None if pairs is None else address(pairs)
        product = product, places, pairs
    return own, (transform, symbols, product)
