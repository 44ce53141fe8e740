"""States on windows of any nodes of a plane, those on which the law acts, and on the boxes of
such."""

from ..grid.active import WORTH, Nodes, within
from .state import State, below
from .states import will_do

SPARSE = 0.6
"""Part of the nodes of a window on which the law acts, below which a smaller one is taken."""


def boxed(contact, state):
    """The state on the box of its window, where that is of some nodes of one."""
    if not isinstance(state.window, Nodes):
        return state
    box = state.window.hull
    return State(box, box.take(contact.extended(state)), state.means)


def window(contact, gap):
    """The window on which the law acts for a normal gap over the cell (delta_n): of nodes of a box,
    or several boxes where these cost less."""
    found = contact.window(gap)
    return within(found, contact.acting(gap)) if len(found.parts) == 1 else found


def on_nodes(contact, state, afresh=False):
    """The state on the nodes that the law needs for it, of whatever box that is (in the plane): the
    same state where its window will do, unless ``afresh``.

    Parameters
    ----------
    contact : Contact
    state : State
    afresh : bool
    """
    some = isinstance(state.window, Nodes)
    if not afresh and (some or state.window.is_whole):
        acting = contact.grid.count(below(state.normal, contact.gap_on(state.window),
                                          contact.law.reach))
        # more than WORTH of the cell, and no window but the cell holds them
        if acting > (SPARSE * state.window.total if some else WORTH * state.window.total):
            return state
    elif not afresh and len(state.window.parts) > 1 and will_do(contact, state):
        return state
    cell = contact.extended(state)
    fresh = window(contact, cell[0] + contact.initial_gap)
    return state if fresh == state.window else State(fresh, fresh.take(cell), state.means)
