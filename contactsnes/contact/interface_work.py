"""Work done on the interface along a path, summed up over its nodes: by its tractions alone, so
that it tests the balance of energies where the law has no potential."""

from functools import cache

import numpy as np

from .state import everywhere
from .states import with_components
from .work_along import MOST, apart, gauss, line_rule

PART = 2 ** 12
"""Nodes whose work is found at a time, some four states and eight places each."""
ASTRAY = 0.25
"""Part of what chords leave of works at nodes, whatever their signs, that polynomials may differ by
from these: more do those that swing, far into overlap perhaps, where steps of many lengths meet."""


def between(contact, states, displacements, forces, give, first):
    """Work done on the interface from point number ``first`` of a smooth part of a path to its last
    one, for each component, phi_i.

    The sum over nodes of the integral of p_n dg_n and p_t dg_t, where each node moves along the
    polynomial through its displacements at all points that are `apart`; or along the chords between
    them, where the polynomials go `ASTRAY`.

    Parameters
    ----------
    contact : Contact
    states : those of the points, at most four
    displacements, forces, give, first : as of `work_along.line_work`
    """
    kept, first = apart(displacements, forces, give, first)
    components = max(state.components for state in states)
    states = [with_components(states[number], components) for number in kept]
    rule, sums = None, 0.0
    for grid, nodes, known, mask in everywhere(contact, states):
        if rule is None:
            rule = np.concatenate([line_rule(_places(grid, known), first, gauss(len(kept))),
                                   _chords(len(kept), first)], axis=2)
        sums = sums + _over(contact, grid, nodes, known, mask, rule)
    work, straight, doubt = contact.grid.node_area * sums
    return np.where(np.abs(work - straight) <= ASTRAY * doubt, work, straight)


def _places(grid, known):
    """Distances of points along a path, by all that their nodes (components, nodes) have moved: a
    fold is approached by these, where loads hardly move."""
    steps = [later - earlier for earlier, later in zip(known, known[1:])]
    moved = np.sqrt(grid.sum(np.array([np.einsum("ij,ij->j", step, step) for step in steps])))
    return np.append(0.0, moved.cumsum()) if moved.all() else np.arange(float(len(known)))


@cache
def _chords(count, first):
    """As of `line_rule`, of the chords between points from number ``first`` of so many on."""
    rule = np.zeros((2, count, count - 1 - first, MOST))
    for number in range(count - 1 - first):
        rule[:, first + number:, number][:, :2] = line_rule([0.0, 1.0], 0, gauss(MOST))
    return rule.reshape(2, count, -1)


def _over(contact, grid, nodes, known, mask, rule):
    """Sums over the nodes of a window of their works, along polynomials and along chords, and of
    the latter's sizes, for each component, phi_i over the area of a node: array (3, components).

    Parameters
    ----------
    contact : Contact
    grid, nodes, known, mask : as of `state.everywhere`
    rule : (values, slopes by shares), as of `line_rule`, first of the polynomials, then of chords
    """
    works, initial_gap = np.empty((3, *known[0].shape)), contact.gap_on(nodes)
    for first in range(0, works.shape[2], PART):
        part = slice(first, first + PART)
        some = np.stack([displacement[:, part] for displacement in known], axis=1)
        gaps, ways = (values.T @ some for values in rule)
        gaps[0] += initial_gap[part]
        done = contact.law.traction(gaps.reshape(len(gaps), -1)).reshape(gaps.shape)
        done *= ways
        works[0, :, part] = done[:, :len(known)].sum(axis=1)
        works[1, :, part] = done[:, len(known):].sum(axis=1)
    np.abs(works[1], out=works[2])
    if mask is not None:
        works[..., ~mask] = 0.0
    return grid.sum(works)
