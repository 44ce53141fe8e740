"""Nodes outside the window of a motion: whether the law acts on none of them."""

import numpy as np

FARTHER = 4.0
"""How many times as far as the farthest node of a window, in any direction, or as the mean, nodes
outside of it are taken to move to the flat: of a half-space without friction, on which tractions
change in the window alone, none moves farther than those."""


class Outside:
    """Whether every node outside the window of a motion is certainly out of the law's range.

    Where it takes transforms of the cell to know that, they are made again only once the motion has
    come so far that some node may be.

    Parameters
    ----------
    contact : Contact
    equations : viscous.Equations, on the window
    scatters : bool, whether windows are of any nodes
    """

    def __init__(self, contact, equations, scatters):
        self._contact, self._equations, self._scatters = contact, equations, scatters
        self._known = None  # gap on the window, normal mean, and room when they were last made

    def free(self, motion, sure):
        """Whether no node outside is within the law's range.

        Parameters
        ----------
        motion : overdamped.OverdampedMotion, on the window
        sure : bool, whether what is known from before does not count
        """
        contact, window, now = self._contact, self._equations.window, motion.history[-1]
        certain = contact.law.certain
        if window in (contact.grid.whole, contact.widest):
            return True
        gap = self._equations.gap(now.unknown)
        near = self._equations.rim_gap(gap) < certain
        if near and not self._scatters:
            return False
        if contact.convex and not near:
            return True
        if not sure and self._known and self._still_far(gap, motion.means()[0]):
            return True
        state, elastic = motion.state(), self._equations.unfolded(now.elastic)
        room = contact.grid.minimum(contact.gap_outside(state, elastic)) - certain
        self._known = gap, state.means[0], room
        return room >= 0.0

    def _still_far(self, gap, mean):
        """Whether nothing has moved so far since then that a node outside may be near."""
        before, middle, room = self._known
        grid = self._equations.form.grid
        moved = max(grid.maximum(np.abs(gap - before)), abs(mean - middle))
        return FARTHER * moved < room
