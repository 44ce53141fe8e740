"""Work done on the interface along a path, summed up over its nodes: by its tractions alone, so
that it tests the balance of energies where the law has no potential."""

import math
from functools import cache

import numpy as np

from ..kernels.sites import States
from .state import everywhere
from .states import missed, with_components
from .work_along import TWINS, gauss, line_rule, rules

PART = 2 ** 11
"""Nodes whose work is found at a time, some four states and six places each."""
AT_ONCE = 2 ** 14
"""The same on straight ways, of which two states are asked, at a place at a time."""
PLACES = 5
"""Places of a rule on a part of a straight way."""
SHORT_WAYS = 4
"""Parts of a straight way of a jump's nodes."""
FAR_PANELS = 60
"""The same of a way of twice the law's range, or longer."""
CHORD = 2
"""Places of a rule on a chord."""
ASTRAY = 0.25
"""Part of what chords leave of works at nodes, whatever their signs, that polynomials may differ by
from these: more do those that swing, far into overlap perhaps, where steps of many lengths meet."""


def between(contact, states, first):
    """Work done on the interface from state number ``first`` of a smooth part of a path to its last
    one, for each component, phi_i.

    The sum over nodes of the integral of p_n dg_n and p_t dg_t, where each node moves along the
    polynomial through its displacements in all states that are apart; or along the chords between
    them, where the polynomials go `ASTRAY`.

    Parameters
    ----------
    contact : Contact
    states : at most four
    first : int
    """
    components = max(state.components for state in states)
    states = [with_components(state, components) for state in states]
    moved, sums = None, 0.0
    for grid, nodes, known, mask in everywhere(contact, states):
        weights, site = grid.weights if nodes.even else None, contact.site(nodes)
        known = States(known) if site else known
        if moved is None:
            moved = contact.grid.together(site.squares_along(known) if site
                                          else _squares(known, weights))
        if mask is not None:
            weights = mask.astype(float) if weights is None else mask * weights
        sums = sums + contact.grid.together(
            site.works_along(known, weights, moved, first, TWINS, rules(), contact.law.range)
            if site else
            _by_numpy(contact.law, known, contact.gap_on(nodes), weights, moved, first))
    work, straight, doubt = contact.grid.node_area * sums
    return np.where(np.abs(work - straight) <= ASTRAY * doubt, work, straight)


def straight(contact, first, last, panels=None):
    """Work done on the interface on the straight way from one state to another, for each component,
    phi_i.

    Parameters
    ----------
    contact : Contact
    first, last : State
    panels : equal parts of the way, each with a rule of `PLACES` places; None: one for each range
        that a node moves where the law acts, at most `FAR_PANELS`
    """
    return _done(contact, first, last, _panels(panels or _ranges(contact, first, last)))


def released(contact, first, last):
    """What the straight way from one equilibrium to another under the same loads releases, for each
    component, phi_i: less than nothing where it leads to more energy.

    The body balances the tractions of the law at both ends, and linearly in between, so that it is
    what these do less than linear ones. No potential is asked for: where the law has one, it is the
    difference of energies, loads included.

    Parameters
    ----------
    contact, first, last : as of `straight`
    """
    places, shares = _panels(_ranges(contact, first, last))
    return _done(contact, first, last, (np.append(places, (0.0, 1.0)),
                                        np.append(-shares, (0.5, 0.5))))


def corners(contact, first, last):
    """Works done on the interface from one state to another, for each component, phi_i, array (2,
    components): where all nodes move along the normal first and then slip, and the reverse.

    Works of ways without detours lie between: where hardly anything slips, both are the same.

    Parameters
    ----------
    contact, first, last : as of `straight`
    """
    def around(start, end):
        return np.concatenate([start[:1], end[1:]])

    return np.array([_done(contact, first, last, _panels(SHORT_WAYS), corner)
                     for corner in (lambda start, end: around(end, start), around)])


def _ranges(contact, first, last):
    """Panels of a way, one for each range that a node moves."""
    return min(max(math.ceil(missed(contact, first, last, largest=True)), 1), FAR_PANELS)


@cache
def _panels(count):
    """Places on a way, from 0 to 1, and their shares: Gauss and Legendre's rule in each of so many
    equal parts."""
    abscissas, shares = gauss(PLACES)
    places = (np.arange(count)[:, None] + 0.5 * (1.0 + abscissas)) / count
    return places.ravel(), np.tile(0.5 / count * shares, count)


def _done(contact, first, last, rule, corner=None):
    """Work done on the interface from one state to another, for each component, phi_i: straight, or
    by a corner.

    Parameters
    ----------
    contact, first, last : as of `straight`
    rule : as of `_panels`
    corner : function (displacements at both ends) -> those where the way turns
    """
    count, sums = max(first.components, last.components), 0.0
    known = [with_components(state, count) for state in (first, last)]
    for grid, nodes, (start, end), mask in everywhere(contact, known):
        weights = np.broadcast_to(1.0 if mask is None else mask, start.shape[1])
        weights = weights * grid.weights if nodes.even else weights
        way = (start, end) if corner is None else (start, corner(start, end), end)
        sums = sums + contact.grid.together(
            _straight(contact.law, way, contact.gap_on(nodes), weights, rule))
    return contact.grid.node_area * sums


def _straight(law, known, initial_gap, weights, rule):
    """Work on nodes summed up, along the straight ways from place to place: for each component,
    phi_i over the area of a node.

    Parameters
    ----------
    law : Law
    known : displacements (components, nodes), one after the other
    initial_gap, weights : arrays (nodes,)
    rule : as of `_panels`
    """
    work = np.zeros(len(known[0]))
    for first in range(0, len(initial_gap), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        some, counts = [each[:, part] for each in known], weights[part].astype(float)
        for start, way in ((one, other - one) for one, other in zip(some, some[1:])):
            for place, share in zip(*rule):
                gap = start + place * way
                gap[0] += initial_gap[part]
                work += share * ((law.traction(gap) * way) @ counts)
    return work


def _squares(known, weights):
    """Squares of the ways from each of some states to the next, as of `Site.squares_along`.

    Parameters
    ----------
    known, weights : as of that
    """
    steps = [later - earlier for earlier, later in zip(known, known[1:])]
    return np.array([np.sum(step * step if weights is None else step * step * weights)
                     for step in steps])


def _kept(places, first):
    """Numbers of the places that are more than `TWINS` of the way from number ``first`` to the last
    one apart from each other; these two are."""
    least, kept = TWINS * (places[-1] - places[first]), [len(places) - 1]
    for number in reversed(range(len(places) - 1)):
        if places[kept[-1]] - places[number] > least:
            kept.append(number)
        elif number == first:
            kept[-1] = first
    return kept[::-1]


def _rule(places, first):
    """Values of polynomials and of chords through points from number ``first`` on, and their slopes
    by shares, as of `line_rule`.

    Parameters
    ----------
    places : how far all nodes have moved from point to point: a fold is approached by these, where
             loads hardly move
    first : int
    """
    count = len(places)
    return np.concatenate([line_rule(places, first, gauss(count)), _chords(count, first)], axis=2)


@cache
def _chords(count, first):
    """As of `line_rule`, of the chords between points from number ``first`` of so many on."""
    rule = np.zeros((2, count, count - 1 - first, CHORD))
    for number in range(count - 1 - first):
        rule[:, first + number:, number][:, :2] = line_rule([0.0, 1.0], 0, gauss(CHORD))
    return rule.reshape(2, count, -1)


def _by_numpy(law, known, initial_gap, weights, moved, first):
    """Works on nodes summed up: along polynomials, along chords, and the latter's sizes, for each
    component, phi_i over the area of a node, array (3, components); of nodes where the law acts at
    some state.

    Parameters
    ----------
    law : Law
    known : displacements (components, nodes) of up to four states
    initial_gap, weights : arrays (nodes,), for how many nodes each stands (None: one)
    moved : array, squares of the ways from each of them to the next, of all nodes
    first : number of the state from which on
    """
    places = np.append(0.0, np.sqrt(moved).cumsum()).tolist()
    if places[-1] == places[first]:
        return np.zeros((3, len(known[0])))
    kept = _kept(places, first)
    rule = _rule([places[number] for number in kept], kept.index(first))
    known = [known[number] for number in kept]
    acts = np.minimum.reduce([displacement[0] for displacement in known]) + initial_gap < law.range
    acts, works = np.flatnonzero(acts), np.zeros((3, len(known[0])))
    for start in range(0, len(acts), PART):
        part = acts[start:start + PART]
        some = np.stack([displacement[:, part] for displacement in known], axis=1)
        gaps, ways = (values.T @ some for values in rule)
        gaps[0] += initial_gap[part]
        done = law.traction(gaps.reshape(len(gaps), -1)).reshape(gaps.shape) * ways
        done = np.array([done[:, :len(known)].sum(axis=1), done[:, len(known):].sum(axis=1)])
        works += np.concatenate([done, np.abs(done[1:])]) @ (
            np.ones(len(part)) if weights is None else weights[part])
    return works
