"""A state of a contact on a window, and states on the nodes that they share."""

import weakref
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..grid.nearest import nearest

PART = 2 ** 14
"""Nodes that are looked at at a time."""
LARGE = 2 ** 16
"""Displacements of a state from which on half of their memory counts; of one component, whose
solves hold a third, the time to make them anew counts more."""

_FORMER = weakref.WeakKeyDictionary()
"""State -> reference to the `Former` that was made of it last."""


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

    def __reduce_ex__(self, protocol):
        """What ``pickle`` and ``copy`` make it of; TypeError where others have the other rows."""
        if self.window.grid.shared:
            raise TypeError("a point in several processes is neither pickled nor copied: "
                            "contactsnes run keeps it in an archive, from which any number of "
                            "processes goes on")
        return super().__reduce_ex__(protocol)

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


class Former(State):
    """A State that others are foretold from, known by what it differs from a later one, in single
    precision: to a ten-millionth of their way, in half the memory. What is asked of it is made
    anew each time."""

    @classmethod
    def of(cls, state, later):
        """The one of a state; the state itself where it is small, of one component, or at other
        nodes than the later one.

        Parameters
        ----------
        state, later : State
        """
        if (state.half is not None or later.half is not None or state.window != later.window
                or state.components != later.components or state.components == 1
                or state.components * state.window.size < LARGE):
            return state
        made = object.__new__(cls)
        change = state.displacement - later.displacement
        vars(made).update(window=state.window, half=None, means=state.means, _later=later,
                          _change=change.astype(np.float32))
        _FORMER[state] = weakref.ref(made)
        return made

    @classmethod
    def row(cls, states):
        """Those of states, oldest first, each known by the next, but for the last one, which stays
        as it is.

        Parameters
        ----------
        states : sequence of State, the `Former` ones of an earlier row among them
        """
        made = [states[-1]]
        for state in states[-2::-1]:
            if isinstance(state, cls) and lightest(state._later) is made[-1]:
                vars(state).update(_later=made[-1])
            else:
                state = cls.of(state, made[-1])
            made.append(state)
        return made[::-1]

    @property
    def displacement(self):
        """Displacements on the window, array (components, nodes)."""
        state, changes = self, []
        while isinstance(state, Former):
            changes.append(state._change)
            state = state._later
        found = state.displacement + changes.pop()
        for change in changes[::-1]:
            found += change
        return found

    once = displacement

    @property
    def normal(self):
        """Normal displacement (nodes)."""
        return self._later.normal + self._change[0]


def told_apart(states, weights):
    """A weighted sum of states by what they are kept as: the states in full that it is one of, that
    of the last behind the others, and their weights; changes in single precision on its window, and
    the weights of these.

    Parameters
    ----------
    states : list of State
    weights : numbers, one a state
    """
    whole, changes = {}, {}
    for state, weight in zip(states[::-1], weights[::-1]):
        while isinstance(state, Former) and state.window == states[-1].window:
            changes[state] = weight + changes.get(state, 0.0)
            state = state._later
        whole[state] = weight + whole.get(state, 0.0)
    return ([*whole][::-1], [*whole.values()][::-1], [state._change for state in changes],
            [*changes.values()])


def lightest(state):
    """The last `Former` that was made of a state, and is in use, or the state."""
    made = _FORMER[state]() if state in _FORMER else None
    return state if made is None else lightest(made)


def below(displacement, initial_gap, level):
    """Mask (nodes,) of the nodes whose normal gap is below a level: part by part, which stay in the
    processor's cache.

    Parameters
    ----------
    displacement, initial_gap : arrays (nodes,), normal displacements and initial gaps, delta_n
    level : float
    """
    mask = np.empty(len(initial_gap), dtype=bool)
    for first in range(0, len(mask), PART):
        part = slice(first, first + PART)
        np.less(displacement[part] + initial_gap[part], level, out=mask[part])
    return mask


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
        return contact.grid, largest.window, _on(every, largest.window)
    return half.grid, half, _on(every, half)


def _on(every, nodes):
    """Displacements (components, nodes) of states on a window, or of such that are all even or odd
    alike at the nodes of a half."""
    if not nodes.even:
        return [onto(state, nodes) for state in every]
    return [state.once if state.half == nodes else nodes.fold(onto(state, nodes.full))
            for state in every]


def everywhere(contact, states):
    """What `alike` tells of states, with a mask (nodes,) of the nodes that count, None: all; then
    the same of each further window of theirs, of its nodes that none before it has."""
    grid, nodes, known = alike(contact, states)
    yield grid, nodes, known, None
    passed, seen = [nodes], None
    for own in [state.half if nodes.even else state.window for state in states]:
        if own in passed:
            continue
        if seen is None:
            seen = np.zeros(contact.grid.local_shape, dtype=bool)
        last = passed[-1].full if nodes.even else passed[-1]
        last.put(np.ones(last.size, dtype=bool), seen)
        more = ~own.take(seen)
        if contact.grid.any(more):
            yield own.grid if nodes.even else grid, own, _on(states, own), more
        passed.append(own)


def weighted(arrays, weights):
    """Weighted sum of arrays alike."""
    found = weights[0] * arrays[0]
    for array, weight in zip(arrays[1:], weights[1:]):
        found += weight * array
    return found


def spread(nodes, displacement, means):
    """The state with displacements at the nodes of a window, each once.

    One that has a mirror in one direction only is known at all nodes: what is made of states asks
    for quarters of the plane or for all of it.

    Parameters
    ----------
    nodes : Window, or EvenWindow
    displacement : array (components, nodes), ranges of the law
    means : array (components,), ranges of the law
    """
    if not nodes.even:
        return State(nodes, displacement, means)
    if not all(nodes.mirrors):
        return State(nodes.full, nodes.unfold(displacement), means)
    return Mirrored.of(nodes, displacement, means)
