"""States on windows of any nodes of a plane, those on which the law acts, and on the boxes of
such."""

from ..grid.active import Nodes, within
from .states import State, normal_gap

SPARSE = 0.6
"""Part of the nodes of a window on which the law acts, below which a smaller one is taken."""


def boxed(contact, state):
    """The state on the box of its window, where that is of some nodes of one."""
    if not isinstance(state.window, Nodes):
        return state
    box = state.window.hull
    return State(box, box.take(contact.extended(state)), state.means)


def on_nodes(contact, state, afresh=False):
    """The state on the nodes that the law needs for it, of whatever box that is (in the plane): the
    same state where its window will do, unless ``afresh``.

    Parameters
    ----------
    contact : Contact
    state : State
    afresh : bool
    """
    window, reach = state.window, contact.law.range
    if not afresh and isinstance(window, Nodes):
        acting = contact.grid.count(normal_gap(contact, state) < reach)
        if acting > SPARSE * window.size:
            return state
    cell = contact.extended(state)
    gap = cell[0] + contact.initial_gap
    fresh = contact.window(gap)
    if len(fresh.parts) == 1:
        fresh = within(fresh, contact.acting(gap))
    return state if fresh == window else State(fresh, fresh.take(cell), state.means)
