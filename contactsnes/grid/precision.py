"""Single precision inside linear solves: the same transforms and products on the same memory, in
half of the time where memory is what takes it."""

import copy

import numpy as np

SINGLE = {np.dtype(float): np.float32, np.dtype(complex): np.complex64}
"""Type of an array -> what holds the same in single precision."""


def first_half(array):
    """As many numbers in single precision, in the first half of an array's memory: an array of its
    shape."""
    return array.reshape(-1).view(SINGLE[array.dtype])[:array.size].reshape(array.shape)


def in_single(convolution):
    """The product of a `cell.Convolution`, of any kind, in single precision: fields are doubles as
    before, the transform is the convolution's ``single`` one, on the memory of that in double."""
    quick = copy.copy(convolution)
    quick.transform = convolution.transform.single
    quick.blocks = {key: np.ascontiguousarray(block, dtype=SINGLE[block.dtype])
                    for key, block in convolution.blocks.items()}
    quick._lay_out()
    return quick
