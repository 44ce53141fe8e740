"""Edges of contact, slip fronts and ends of pressure: places between which states are stretched."""

import weakref

import numpy as np

from ..grid.transfer import extent
from .state import below

FAR = 0.3
"""Cohesive lengths of the friction (`in_cohesive_lengths`) by which a slip front has to move in a
step to be followed: wider ones are predicted better in place."""
FORETOLD = 0.05
ON_ITS_WAY = 0.02
"""Cohesive lengths, and part of its way, by which a slip front may have missed its prediction for
that to be no chance. Where a grid pins fronts, they miss it by a part of a spacing, which is more
of the cohesive length than this."""
LEAST = 4.0
"""Nodes that lie at least between places that are followed."""
FILLED = 0.25
"""Part of the box around all nodes where the law may act that these are at least, where they are
one spot and its surroundings: of a disc 0.79, of hundreds of places that hardly touch a few
hundredths."""
ROUND = 3
"""Nodes by which a spot, at either of its ends, is shorter on the line through its middle than as a
whole, at most."""

_KNOWN = weakref.WeakKeyDictionary()
"""State -> contact, and places in it (`_kept_places`)."""


def edges(contact, state):
    """First and last place, in nodes of the window, of the one spot of contact along each
    direction, an array (directions, 2).

    In two dimensions on the lines through its middle. None where there is no such spot: none,
    several, one across the border.
    """
    if len(state.window.parts) > 1:
        return None
    level, ends = contact.scene.contact_threshold, []
    if len(state.window.shape) == 1:
        places, signs = _crossed(contact, state, _normal_gap(contact, state), level)
        return places[None] if list(signs) == [-1, 1] else None
    nodes, gap = state.nodes.parts[0], contact.gap_on(state.nodes)
    touching = state.nodes.box(below(state.once[0], gap, level))
    lines = [extent(nodes.occupied(touching, axis), 0) for axis in range(touching.ndim)]
    if state.half is not None:
        lines = [slice(n // 2 + 1 - line.stop, n // 2 + line.stop)
                 for line, n in zip(lines, state.window.extents)]
    if lines[0].start >= lines[0].stop or any(line.start == 0 for line in lines):
        return None
    through = [(line.start + line.stop) // 2 if state.half is None else 0 for line in lines]
    boxes = state.nodes.box(state.once[0]), state.nodes.box(gap)
    for axis, line in enumerate(lines):
        along = np.add(*(nodes.line(box, axis, through) for box in boxes))
        places, _ = _crossed(contact, state, along, level, axis)
        # The extent of all that touches is that on the line, give or take the roundness of a spot.
        if (len(places) != 2 or places[0] > line.start + ROUND - 1
            or places[1] < line.stop - ROUND):
            return None
        ends.append(places)
    return np.array(ends)


def may_be_lone(contact, state):
    """Whether `edges` may find one spot in a state on some nodes of a box, and all these lie around
    it: on the lines through the middle of all that touch there are as many as from first to last.

    Parameters
    ----------
    contact : Contact
    state : State on `grid.active.Nodes`
    """
    window, level = state.window, contact.scene.contact_threshold
    rows, columns = _rows_and_columns(
        window, window.places[below(state.normal, contact.gap_on(window), level)])
    (top, bottom), (left, right) = contact.grid.ends((rows, columns))
    if top > bottom:
        return False
    beside = contact.grid.count(columns == (left + right + 1) // 2)
    across = contact.grid.count(rows == (top + bottom + 1) // 2)
    if beside <= bottom - top - 2 * ROUND or across <= right - left - 2 * ROUND:
        return False
    (top, bottom), (left, right) = contact.grid.ends(_rows_and_columns(window, window.places))
    return window.total > FILLED * (bottom - top + 1) * (right - left + 1)


def _rows_and_columns(window, places):
    """Rows of the cell, and columns of the box, of nodes by their numbers in a window's box."""
    rows, columns = np.divmod(places, window.shape[1])
    return rows + window.start[0], columns


def _normal_gap(contact, state):
    """Normal gap at a state's nodes, each once, delta_n."""
    return state.once[0] + contact.gap_on(state.nodes)


def _crossed(contact, state, values, level, axis=0):
    """Where values (nodes) of a line, at a state's nodes, each once and even about the apex, cross
    a level: places in nodes of its window, and signs (`contours.crossings`).

    Parameters
    ----------
    contact, state, values, level : Contact, State, array, float
    axis : int, along which the line lies
    """
    if state.half is None:
        return contact.kernels.crossings(values, level)
    beside = values[2:0:-1]  # which interpolation between the first two asks for
    found = contact.kernels.crossings(np.concatenate([beside, values]), level)
    count, first = state.window.extents[axis], len(beside)
    middle, last = count // 2, count - 1 - count // 2
    right = [(place - first, sign) for place, sign in zip(*(each.tolist() for each in found))
             if 0.0 < place - first <= last]
    return (np.array([*(middle - reach for reach, _ in reversed(right)),
                      *(middle + reach for reach, _ in right)]),
            [*(-sign for _, sign in reversed(right)), *(sign for _, sign in right)])


def slip_fronts(contact, state, ends):
    """The two places on a line, within ``ends`` of the contact, between which the surfaces stick:
    where the slip passes that of the peak of the friction. None where there are not two.

    Parameters
    ----------
    contact : Contact
    state : State
    ends : array (directions, 2), `edges` of the state, in nodes
    """
    if len(ends) > 1 or state.components < 2:
        return None
    places, signs = _crossed(contact, state, np.abs(state.once[1]), contact.law.slip_peak)
    left, right = ends[0].tolist()
    within = [(place, sign) for place, sign in zip(places.tolist(), signs) if left < place < right]
    found, signs = zip(*within) if within else ((), ())
    return np.array([found]) if signs == (-1, 1) else None


def fronts_foretold(contact, guess, last, found):
    """Whether the slip fronts of a state are where they were foretold, after a way of their own: as
    no fronts are that have jumped.

    Parameters
    ----------
    contact : Contact
    guess : State, predicted from points of the branch
    last, found : State, equilibria
    """
    moved, missed = (_fronts_apart(contact, state, found) for state in (last, guess))
    return moved > FAR and missed < min(FORETOLD, ON_ITS_WAY * moved)


def fronts_moved(contact, first, last):
    """Whether slip fronts are followed from one state to another: a tangent would leave them in
    place.

    Parameters
    ----------
    contact : Contact
    first, last : State
    """
    return _fronts_apart(contact, first, last) > FAR


def _fronts_apart(contact, first, last):
    """How far the slip fronts of two states are from each other, cohesive lengths of the friction;
    nan where there are none."""
    if len(contact.grid.shape) > 1:
        return np.nan
    known = [_kept_places(contact, state)[1] for state in (first, last)]
    if any(fronts is None for fronts in known):
        return np.nan
    between = nodes_between(last.window.parts[0], first.window.parts[0])[0]
    return np.abs(known[1] - known[0] - between).max() * in_cohesive_lengths(contact)


def in_cohesive_lengths(contact):
    """A spacing of a line over the cohesive length of the friction: beta/lambda_t^2 over its
    steepest fall with the slip or, where it hardly falls, its mean rise to the peak. Fronts that
    rise within a spacing go from node to node: only a fall counts there.
    """
    law = contact.law
    sharp = contact.grid.spacings[0] * contact.scene.tangential_maugis ** 2
    fall, rise = sharp * law.slip_softening, sharp * law.tangential_peak / law.slip_peak
    return rise if 4.0 * fall < rise < 1.0 else fall


def pressed_ends(contact, state, ends, fronts):
    """The two places on a line, between the ends of the contact and the slip ``fronts``, where the
    normal gap passes zero: ends of the pressure, once slip has taken the adhesion, which stay where
    they are while the fronts move. None where there are not two.

    Parameters
    ----------
    contact : Contact
    state : State
    ends : array (1, 2), `edges` of the state, in nodes
    fronts : array (1, 2), `slip_fronts` of the state, in nodes
    """
    places, _ = _crossed(contact, state, _normal_gap(contact, state), 0.0)
    if len(places) != 2:
        return None
    order = [float(place) for line in (ends[0], places, fronts[0]) for place in line]
    (left, right), pressed, (stuck, there) = order[:2], order[2:4], order[4:]
    apart = (pressed[0] - left, stuck - pressed[0], right - pressed[1], pressed[1] - there)
    return places[None] if min(apart) > LEAST else None


def _kept_places(contact, state):
    """`edges`, `slip_fronts` and `pressed_ends` of a state, which are asked for step after step."""
    found = _KNOWN.get(state)
    if found is None or found[0]() is not contact:
        half = state.half
        line = half is not None and len(half.shape) == 1 and half.size > 2
        places = (_by_halves if line and contact.site(half) else _one_by_one)(contact, state)
        found = _KNOWN[state] = weakref.ref(contact), *places
    return found[1:]


def _one_by_one(contact, state):
    """These, one after the other."""
    ends = edges(contact, state)
    fronts = None if ends is None else slip_fronts(contact, state, ends)
    return ends, fronts, None if fronts is None else pressed_ends(contact, state, ends, fronts)


def _by_halves(contact, state):
    """The same of even states of a line, by the library."""
    count, site = state.window.extents[0], contact.site(state.half)
    middle, found = count // 2, site.reaches(state.once, count - 1 - count // 2, LEAST)
    return [np.array([[middle - reach, middle + reach]]) if reach else None
            for reach in found.tolist()]


def followed_places(contact, states):
    """Places of each state that stay in place in the stretched coordinates, in order: the ends of
    its spot of contact and, where all have them, the slip fronts and the ends of pressure; an array
    (directions, places) for each state, or None without such a spot."""
    ends, *inner = zip(*(_kept_places(contact, state) for state in states))
    if any(end is None for end in ends):
        return None
    known = [places for places in inner if all(place is not None for place in places)]
    if not known:
        return ends
    return [np.sort(np.concatenate(together, axis=1)) for together in zip(ends, *known)]


def nodes_between(window, other):
    """Nodes from the first one of a window to that of another near it in each direction, over the
    cell's border or not."""
    return np.array([(there - here + total // 2) % total - total // 2 for here, there, total
                     in zip(window.origin, other.origin, window.grid.shape)])
