"""Predictions that follow the edges of spots of contact: states extrapolated in coordinates in
which the edges stay in place."""

import numpy as np
import scipy

from ..grid.active import Nodes
from ..grid.clusters import MOST
from ..grid.windows import Window
from ..kernels.splines import followed
from .combining import combined, leads_astray, without_overlap
from .fronts import FAR, LEAST, followed_places, in_cohesive_lengths, may_be_lone, nodes_between
from .state import State, alike, below, onto, spread, weighted
from .states import NEAR, normal_gap, wider
from .survey import gaps_once

STRETCH = 0.25
"""Part of its length by which a piece between ends of pressure and fronts may grow or shrink in a
step: more of it changes than is stretched."""
RESIZED = 0.1
"""Part of its extent by which a spot grows or shrinks in a step from which on that is looked at: as
one of a long range does before it vanishes, whose edges move ever faster."""
SUPPORT = 12
"""Nodes beyond a place on which the coefficients of a cubic spline there depend (by more than
1e-7)."""


def follow_edge(contact, states, weights):
    """Extrapolate gaps in coordinates stretched so that the ends of the contact spot stay in place;
    None without such a spot.

    Of even states their half is extrapolated, of several spots each in a box of its own.

    The edge moves by a good part of its cohesive length in a step, so that gaps at fixed places
    change abruptly where gaps at a fixed distance from the edge hardly do. So do the fronts of slip
    on a line. Where the law hardly acts, displacements are extrapolated at fixed places.

    Parameters
    ----------
    contact : Contact
    states : list of State, oldest first
    weights : numbers, one a state
    """
    ahead = _ahead(contact, states, weights)
    if ahead is None or not contact.convex and leads_astray(contact, states, weights, ahead):
        return None
    return ahead


def _ahead(contact, states, weights):
    """What `follow_edge` finds, wherever that leads."""
    window = states[-1].window
    if isinstance(window, Nodes):
        return _follow_on_nodes(contact, states, weights)
    ahead = _follow_spot(contact, states, weights)
    # Spots of a rough plane merge and appear, and few are round.
    if (ahead is not None or states[-1].half is not None or contact.scattered
            or contact.grid.shared):
        return ahead
    return _follow_spots(contact, states, weights)


def _follow_on_nodes(contact, states, weights):
    """The same on the box of a window of some of its nodes, which costs as much as a step where
    these are few: not of several spots."""
    window = states[-1].window
    if not may_be_lone(contact, states[-1]):
        return None
    box = [State(window.hull, onto(state, window.hull), state.means) for state in states]
    ahead = _ahead(contact, box, weights)
    return ahead and State(window, ahead.displacement[:, window.places], ahead.means)


def _follow_spot(contact, states, weights):
    """The same for the one spot of a window of one box."""
    known = followed_places(contact, states)
    if known is None:
        return None
    *places, target = _moved_places(contact, states, known, weights)
    if not _in_order(target, states[-1].window):
        return None
    _, nodes, (last, *earlier) = alike(contact, [states[-1]], states[:-1])
    known, ahead = [*earlier, last], None
    if nodes.even and not contact.grid.shared and contact.site(nodes):
        sites = [contact.site(state.half) for state in states]
        if len(places[0]) == 1:
            sites.append(contact.site(nodes.wider))
        ahead = followed(states, known, sites, contact.law.range, weights, places, target)
    if ahead is None:
        ahead = _followed(contact, states, nodes, known, weights, places, target)
    ahead = spread(nodes, ahead, weighted([state.means for state in states], weights))
    extents = [[line[-1] - line[0] for line in lines] for lines in (target, places[-1])]
    resized = contact.convex and any(abs(there - here) > RESIZED * here
                                     for there, here in zip(*extents))
    return None if resized and leads_astray(contact, states, weights, ahead) else ahead


def _followed(contact, states, nodes, known, weights, places, target):
    """Weighted sum of displacements (components, nodes) of states whose places are moved to a
    target near the contact, at fixed places elsewhere.

    Parameters
    ----------
    contact, states, weights : as of `follow_edge`
    nodes : Window, or EvenWindow, of the last state
    known : displacements of all states at these
    places, target : of `_moved_places`
    """
    window, initial, hull = states[-1].window, contact.gap_on(nodes), nodes.parts[0]
    found, floor = without_overlap(contact, nodes, known, weights, known[-1][0])
    part, near = _near_part(nodes, below(known[-1][0], initial, contact.law.range))
    moved = weighted([_stretched(contact, state, window, place, target, part)
                      for state, place in zip(states, places)], weights)
    hull.put_part(moved, nodes.box(found), near)
    here = hull.own(near)[1]
    normal = nodes.box(found[0])[here]
    np.maximum(normal, floor, out=normal)
    normal -= nodes.box(initial)[here]
    return found


def _moved_places(contact, states, known, weights):
    """Places of each state that stay in place in the stretched coordinates, and where they are
    foretold: for each a list of places in each direction, nodes from the first one of the last
    state's window.

    Parameters
    ----------
    contact, states, weights : as of `follow_edge`
    known : `followed_places` of the states
    """
    window = states[-1].window
    # A wider window begins before the last one. (Few numbers: lists are faster than arrays.)
    shifts = [[0] * len(window.shape) if state.window is window
              else nodes_between(window, state.window).tolist() for state in states]
    each = [[[place + shift for place in line] for line, shift in zip(one.tolist(), shifted)]
            for one, shifted in zip(known, shifts)]
    weights = np.asarray(weights).tolist()
    each.append([[sum(weight * place for weight, place in zip(weights, places))
                  for places in zip(*lines)] for lines in zip(*each)])
    if len(each[0][0]) == 6 and any(
            abs((after - before) / (later - earlier) - 1.0) > STRETCH
            for target, last in zip(each[-1], each[-2])
            for before, after, earlier, later in zip(target, target[1:], last, last[1:])):
        # Beside ends of pressure that are near to a front, or move with it, it is followed alone.
        each = _picked(each, (0, 2, 3, 5))
    # In a short step, too, after long ones: it is states far from each other that are weighted.
    moved = max((abs(there - here) for before, after in zip(each, each[1:])
                 for line, other in zip(before, after)
                 for here, there in zip(line[1:-1], other[1:-1])), default=0.0)
    if moved * in_cohesive_lengths(contact) < FAR or not _in_order(each[-1], window):
        # Fronts that hardly move, or meet each other or the edges, are not followed.
        each = _picked(each, (0, -1))
    return each


def _picked(each, which):
    """Some of the places of each direction, of each of several lists of them."""
    return [[[line[k] for k in which] for line in lines] for lines in each]


def _in_order(places, window):
    """Whether places of each direction follow each other, so many nodes apart at least, some nodes
    of a window between the first and the last."""
    return all(line[0] < n and line[-1] > 0 and all(
        after - before >= LEAST for before, after in zip(line, line[1:]))
        for line, n in zip(places, window.extents))


def _near_part(nodes, near):
    """The part of the nodes' box where the law acts, two nodes wider: slices of the window's box
    that this process is to find, and of the box of the nodes all of it.

    Parameters
    ----------
    nodes : Window, or EvenWindow, whose box begins in the middle of the window's
    near : mask (nodes) of those where the law acts
    """
    box = nodes.parts[0]
    ends = [(low - 2, high + 3) if low <= high else (0, 0)
            for low, high in box.ends(nodes.box(near))]
    if not nodes.even:
        part = tuple(slice(*line) if 0 <= line[0] and line[1] <= n else slice(0, n)
                     for line, n in zip(ends, box.extents))
        return box.divided(part), part
    # where the cell closes, the last node of the half stands before the first one of the window
    part = tuple(slice(0, min(max(after, 2), n - n // 2))
                 for (_, after), n in zip(ends, nodes.full.extents))
    return tuple(slice(count // 2 + mine.start, count // 2 + mine.stop)
                 for mine, count in zip(box.divided(part), nodes.full.extents)), part


def _follow_spots(contact, states, weights):
    """The same for several boxes, or several spots in one; None where no spot can be followed."""
    last, several = states[-1], len(states[-1].window.parts) > 1
    ahead, one = combined(contact, states, weights), last.window.parts[0]
    if several:
        boxes, targets = last.window.parts, np.moveaxis(last.window.box(ahead.displacement), 1, 0)
    else:
        cuts = _near_boxes(one.box(normal_gap(contact, last)))
        boxes = [Window(one.grid, [s + cut.start for s, cut in zip(one.start, cut)],
                        [line.stop - line.start for line in cut]) for cut in cuts]
        targets = [one.box(ahead.displacement)[(slice(None), *cut)] for cut in cuts]
    followed = False
    for box, target in zip(boxes, targets):
        own = [State(box, onto(state, box), state.means) if state is last
               or box in state.window.parts else wider(state, box) for state in states]
        moved = (follow_edge if several else _follow_spot)(contact, own, weights)
        if moved is not None:
            target[...], followed = moved.displacement.reshape(target.shape), True
    return ahead if followed else None


def carried(contact, changes, origin, state):
    """Small changes of one state as those of another: moved with the edge of contact where it is
    one spot, to the other's window.

    Parameters
    ----------
    contact : Contact
    changes : list of State on one window, the small changes
    origin : State that they are changes of
    state : State that they are wanted for
    """
    if not changes:
        return []
    window, count = state.window, state.components
    if isinstance(window, Nodes) and contact.convex:
        hull = window.hull
        *changes, origin, state = (State(hull, onto(each, hull), each.means)
                                   for each in (*changes, origin, state))
        return [State(window, found.displacement[:, window.places], found.means)
                for found in carried(contact, changes, origin, state)]
    together = State(changes[0].window, np.concatenate([change.displacement for change in changes]),
                     np.zeros(count * len(changes)))
    fixed = onto(together, window)
    fixed = fixed.copy() if fixed is together.displacement else fixed
    known = None if isinstance(window, Nodes) else followed_places(contact, [origin, state])
    if known is not None:
        part, near = _near_part(window, normal_gap(contact, state) < contact.law.range)
        places = known[0] + nodes_between(window, origin.window)[:, None]
        together.displacement[0] -= contact.gap_on(together.window)
        if isinstance(together.window, Nodes):
            together = wider(together, window)
        moved = _stretched(contact, together, window, places, known[1], part)
        window.parts[0].put_part(moved, window.box(fixed), near)
    return [State(window, field, change.means)
            for field, change in zip(fixed.reshape(len(changes), count, -1), changes)]


def _near_boxes(gap):
    """Slices, for each direction, of the boxes around places where the law acts, four nodes wider;
    none where they are many."""
    labels, count = scipy.ndimage.label(gap < NEAR)
    return [tuple(slice(max(line.start - 4, 0), min(line.stop + 4, nodes))
                  for line, nodes in zip(box, gap.shape))
            for box in scipy.ndimage.find_objects(labels)] if 1 < count <= MOST else []


def _stretched(contact, state, window, places, target, part, widened=False):
    """Normal gap and tangential displacements (components, *part) of a state whose ``places`` have
    been moved to ``target``.

    Both are counted from the first node of ``window``, of whose box ``part`` is a part. A state
    that is not known so far is ``widened`` to it.
    """
    kept, sources, parts = state.window, [], []
    begins = nodes_between(window, kept).tolist()
    for here, there, wanted, begin in zip(places, target, part, begins):
        source = contact.kernels.sources(wanted.start, wanted.stop, here, there, begin)
        sources.append(source)
        # (of slabs, others may have all of these rows)
        parts.append((int(source[0]) - SUPPORT, int(source[-1]) + SUPPORT + 2) if len(source)
                     else (0, 0))
    beyond = [low < 0 or high > count for (low, high), count in zip(parts, kept.extents)]
    if not (widened or kept.extents == contact.grid.shape) and contact.grid.any(beyond):
        return _stretched(contact, wider(state, window), window, places, target, part, True)
    known = [_within(*ends, count) for ends, count in zip(parts, kept.extents)]
    sources = [source - line.start for source, line in zip(sources, known)]
    half = state.half
    if half is None:
        field = kept.cut(kept.box(state.displacement), known)
        field[0] += kept.cut(kept.box(contact.gap_on(kept)), known)
    else:
        field = half.around(gaps_once(contact, state), known)
    for axis, places in enumerate(sources, start=1):
        field = contact.kernels.spline(field, places, axis)
    return field


def _within(low, high, count):
    """Slice of those of the nodes ``low`` to ``high`` - 1 that are on a line of ``count``: of nodes
    beyond it two at its end, whose values go on there, of none none."""
    first = min(max(low, 0), count - 2)
    return slice(first, max(min(high, count), first + 2)) if low < high else slice(0, 0)
