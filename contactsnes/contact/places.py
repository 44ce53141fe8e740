"""Places of a contact in words: where something is largest, and what a jump has moved."""

import numpy as np

from ..interface.gap import at
from .states import way

MOVED = 0.3
"""Way of a node, ranges of the law, from which on it has jumped."""


def largest(contact, window, field):
    """Where a field is largest, in words.

    Parameters
    ----------
    contact : Contact
    window : Window
    field : array (nodes of the window)
    """
    grid = contact.grid
    cell = np.full(grid.local_shape, -np.inf)
    window.put(field, cell)
    return f"at {at(grid.place(grid.highest(cell)), contact.scene)}"


def moved(contact, first, last):
    """What has moved from one state to another where the law acts, in words.

    Parameters
    ----------
    contact : Contact
    first, last : State
    """
    window = max(first.window, last.window, key=lambda window: window.total)
    change, near = way(contact, first, last, window)
    far = np.sqrt(np.square(change, out=change).sum(axis=0)) * near
    return (f"{contact.grid.count(far > MOVED)} nodes move by more than {MOVED:g} ranges of the "
            f"law, the farthest, {largest(contact, window, far)}, by "
            f"{contact.grid.maximum(far):.3g}")
