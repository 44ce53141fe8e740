"""Patches of nodes of a plane, for each of which a circle has one point: that of a preconditioner
need not tell apart what a stiff body hardly follows."""

import math

import numpy as np

from .lengths import fast_length

PATCHES = {4: 1.2, 2: 2.5, 1: math.inf}
"""Nodes of a patch in each direction: C D up to which it is taken, C the compliance of the shortest
waves along an axis that patches tell apart. Krylov iterations are then about as many as with every
node, a tenth more at most, and transforms fewer by four tenths on rough surfaces (measured)."""

FEWEST = 4
"""Points of a circle in each direction, of a cell that has as many patches."""


def compliance_between(contact, component, apart):
    """C_ii of a plane, scaled to ranges, of the shortest waves along an axis that points ``apart``
    of the cell's spacings from each other tell apart: that of the axis with the larger one.

    Parameters
    ----------
    contact : Contact
    component, apart : int
    """
    first, second = ([0.0, np.pi / (apart * spacing)] for spacing in contact.grid.spacings)
    components, key = 1 if component == 0 else 3, (component, component)
    own = contact.body.diagonal(np.ix_(first, second), components, last_even=False)[key]
    return float(max(own[1, 0], own[0, 1]) * contact.ranges[component] ** 2)


def taken(window):
    """Whether cores of a window are made of patches: those of one box of a plane that is not
    even."""
    return len(window.shape) == 2 and not window.even and len(window.parts) == 1


def shortest(contact, component):
    """(nodes of a patch in each direction, `compliance_between`) of those that the cell is made of,
    the largest first: each is found when it is asked for."""
    for apart in PATCHES:
        if contact.grid.in_patches(apart):
            yield apart, compliance_between(contact, component, apart)


def patch(contact, component, tangent):
    """(nodes of a patch in each direction, G for what patches do not tell apart) of a core.

    Parameters
    ----------
    contact, component : Contact, int
    tangent : float, D, its mean tangent, dimensionless
    """
    apart, product = next((apart, compliance * tangent) for apart, compliance
                          in shortest(contact, component)
                          if not compliance * tangent > PATCHES[apart])
    return apart, product / (1.0 + product)


def circle_points(extent, total, apart):
    """Points of a circle for an extent of nodes.

    Parameters
    ----------
    extent, total : int, of the core, and of the cell, in a direction
    apart : int, nodes from one of its points to the next
    """
    return min(total // apart, fast_length(max(-(-extent // apart), FEWEST)))
