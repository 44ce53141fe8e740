"""Work done on the interface along a path, summed up over its nodes: by its tractions alone, so
that it tests the balance of energies where the law has no potential."""

import numpy as np

from .state import everywhere
from .states import with_components
from .work_along import apart, distances, gauss, line_rule

PART = 2 ** 12
"""Nodes whose work is found at a time, some four states and places each."""


def between(contact, states, displacements, forces, give, first):
    """Work done on the interface from point number ``first`` of a smooth part of a path to its last
    one, for each component, phi_i.

    The sum over nodes of the integral of p_n dg_n and p_t dg_t, where each node moves along the
    polynomial through its displacements at all points, by their `distances`: as
    `work_along.line_work`, of the points that are `apart`.

    Parameters
    ----------
    contact : Contact
    states : those of the points, at most four
    displacements, forces, give, first : as of `line_work`
    """
    kept, first = apart(displacements, forces, give, first)
    places = distances(displacements[kept], forces[kept], give)
    rule = line_rule(places, first, gauss(len(kept)))
    states = [states[number] for number in kept]
    components = max(state.components for state in states)
    states = [with_components(state, components) for state in states]
    return contact.grid.node_area * sum(
        _over(contact, *one, rule) for one in everywhere(contact, states))


def _over(contact, grid, nodes, known, mask, rule):
    """Sum over the nodes of a window of their works, for each component, phi_i over the area of a
    node.

    Parameters
    ----------
    contact : Contact
    grid, nodes, known, mask : as of `state.everywhere`
    rule : (values of the polynomials, their slopes by shares), as of `line_rule`
    """
    work, initial_gap = np.empty_like(known[0]), contact.gap_on(nodes)
    for first in range(0, work.shape[1], PART):
        part = slice(first, first + PART)
        some = np.stack([displacement[:, part] for displacement in known], axis=1)
        gaps, ways = (values.T @ some for values in rule)
        gaps[0] += initial_gap[part]
        tractions = contact.law.traction(gaps.reshape(len(gaps), -1)).reshape(gaps.shape)
        work[:, part] = np.einsum("ijk,ijk->ik", tractions, ways)
    if mask is not None:
        work[:, ~mask] = 0.0
    return grid.sum(work)
