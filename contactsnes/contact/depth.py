"""How deep the undeformed body stands on the flat where a path begins."""

from functools import cache

import numpy as np

from ..grid.cell import Convolution
from ..grid.roots import bracketed_root
from .problem import APPROACH, FORCE

LARGE = 2 ** 16
"""Nodes of a cell from which on the start of a convex body is looked for on every other one: each
trial is two transforms."""
ACROSS = 8
"""Nodes of each direction on the flat, at least, from which that start is taken."""


def of_start(contact, controls, load):
    """c of the start u_n = max(-g_0, -c), in ranges of the law.

    Parameters
    ----------
    contact, controls, load : as of `states.undeformed`
    """
    gap, grid = contact.initial_gap, contact.grid
    lowest = grid.minimum(gap)
    compliance = 0.0 if controls[0] == APPROACH else contact.rigid_compliance(1)[0]
    control, target = controls[0], -contact.far_displacement(len(controls), load)[0]

    def approach(depth):
        return grid.sum(np.minimum(gap, depth).reshape(-1)) / grid.size

    @cache
    def excess(depth):
        if control == FORCE:
            return _carried(contact, depth) * contact.ranges[0] * grid.node_area - load[0]
        sunk = compliance / grid.size * _carried(contact, depth) if compliance else 0.0
        return approach(depth) + sunk - target

    # The mean of equal gaps is not quite the gap.
    if load[0] <= 0.0 if control == FORCE else target <= max(lowest, approach(lowest)):
        return lowest if control == FORCE else target
    if control == FORCE or compliance:
        coarse = _on_every_other_node(contact, controls, load)
        if coarse is not None:
            return coarse
    # Each trial of what the flat carries is a transform of the cell; a start need not be exact in
    # that.
    return _first_root(excess, contact, lowest,
                       1e-3 if control == FORCE or compliance else 1e-12)


def _first_root(excess, contact, lowest, precision):
    """The least depth, from the lowest gap on, at which a function is zero, the largest gap where
    it is nowhere: what the flat carries rises with the depth first and falls again towards full
    contact."""
    gap, grid = contact.initial_gap, contact.grid
    tried = [lowest, *grid.quantiles(gap, (0.01, 0.03, 0.1, 0.2, 0.4, 0.7)), grid.maximum(gap)]
    above = next((k for k, depth in enumerate(tried) if k and excess(depth) > 0.0), None)
    return tried[-1] if above is None else bracketed_root(excess, tried[above - 1], tried[above],
                                                          rtol=precision)


def _on_every_other_node(contact, controls, load):
    """c of the same start on half as many nodes in each direction; None where that is not worth
    it, or where it would not do: bodies with several equilibria are moved from their start.

    Parameters
    ----------
    contact, controls, load : as of `of_start`
    """
    grid = contact.grid
    if grid.size < LARGE or any(n % 4 for n in grid.shape) or not contact.convex:
        return None
    coarse = contact.coarse(np.inf)
    depth = of_start(coarse, controls, load)
    pressed = coarse.grid.count(coarse.initial_gap < depth)
    contact.coarse.cache_clear()
    return depth if pressed >= ACROSS ** len(grid.shape) else None


def _carried(contact, depth):
    """Sum over the flat's nodes of the traction that bends the body to u_n = max(-g_0, -depth),
    ranges of the law."""
    displacement = np.maximum(-contact.initial_gap, -depth).reshape(1, -1)
    traction = Convolution(contact.grid.whole, contact.periodic.operator(1, "stiffness"), 1,
                           contact.transforms).apply(displacement, displacement)
    return contact.grid.sum(traction[0, contact.initial_gap.reshape(-1) < depth])
