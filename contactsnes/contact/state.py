"""A state of a contact on a window, and states on the nodes that they share."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..grid.nearest import nearest


@dataclass(frozen=True, eq=False)
class State:
    """Displacements on a window, array (components, nodes), and their means over the cell
    (components). A state is equal to itself only, so that what is made of it can be kept with it.
    ``half`` is the EvenWindow of one that is taken for even or odd about the apex, else None."""

    window: object
    displacement: np.ndarray
    means: np.ndarray
    half: object = None

    @property
    def components(self):
        """Their number."""
        return len(self.means)

    @property
    def normal(self):
        """Normal displacement (nodes)."""
        return self.displacement[0]

    @property
    def nodes(self):
        """The window's nodes, each once where others are its mirror images."""
        return self.window if self.half is None else self.half

    @cached_property
    def once(self):
        """Displacements (components, nodes) at these."""
        return self.displacement if self.half is None else self.half.fold(self.displacement)

    def seal(self):
        """Let nobody write into it any more."""
        for name in {"once", "displacement", "means"} & vars(self).keys():
            vars(self)[name].flags.writeable = False

    def unfolded(self, field):
        """A field (components, nodes), known once at each of these, at all nodes of the window."""
        return field if self.half is None else self.half.unfold(field)


class Mirrored(State):
    """A State that may be known by its half: the whole is made when it is asked for."""

    @classmethod
    def of(cls, half, once, means):
        """The one of displacements at the nodes of a half.

        Parameters
        ----------
        half : EvenWindow
        once : array (components, nodes of the half), ranges of the law
        means : array (components,), ranges of the law
        """
        made = object.__new__(cls)
        vars(made).update(window=half.full, half=half, once=once, means=means)
        return made

    @cached_property
    def displacement(self):
        """Displacements on the window, array (components, nodes)."""
        found = self.half.unfold(self.once)
        found.flags.writeable = self.once.flags.writeable
        return found

    @property
    def normal(self):
        """Normal displacement (nodes)."""
        return (self.displacement if "displacement" in vars(self)
                else self.half.unfold(self.once[:1]))[0]


def once_or_all(contact, state):
    """Normal gap (*box) of a state on a window of one box, delta_n, and the half it is given at,
    each node once, or None: at all nodes.

    Parameters
    ----------
    contact : Contact
    state : State
    """
    nodes = state.nodes
    normal = state.normal if state.half is None else state.once[0]
    return nodes.box(normal + contact.gap_on(nodes)), state.half


def onto(state, window):
    """The state on another window; where it was not known, its nearest known displacement."""
    if window == state.window:
        return state.displacement
    return nearest(state.displacement, state.window, window)


def alike(contact, states, others=()):
    """Grid that sums, nodes, and displacements (components, nodes) of states and others, there:
    on the largest window of the first, each node once where all are even or odd alike.

    Parameters
    ----------
    contact : Contact
    states, others : lists of State
    """
    every = [*states, *others]
    half = every[0].half
    if half is not None and all([state.half is half for state in every]):
        return half.grid, half, [state.once for state in every]
    largest = max(states, key=lambda state: state.window.total)
    half = largest.half
    if half is None or any(state.half is None or state.half.parities != half.parities
                           for state in every):
        return (contact.grid, largest.window,
                [onto(state, largest.window) for state in every])
    return half.grid, half, [state.once if state.half == half
                             else half.fold(onto(state, half.full)) for state in every]


def weighted(arrays, weights):
    """Weighted sum of arrays alike."""
    found = weights[0] * arrays[0]
    for array, weight in zip(arrays[1:], weights[1:]):
        found += weight * array
    return found


def spread(nodes, displacement, means):
    """The state with displacements at the nodes of a window, each once.

    Parameters
    ----------
    nodes : Window, or EvenWindow
    displacement : array (components, nodes), ranges of the law
    means : array (components,), ranges of the law
    """
    if not nodes.even:
        return State(nodes, displacement, means)
    return Mirrored.of(nodes, displacement, means)
