"""An equilibrium of a contact as one on every other node, from which motion begins there."""

from functools import cached_property

import numpy as np

from ..contact.problem import FORCE, Contact
from ..contact.state import State
from ..contact.survey import tractions
from ..grid.cell import Convolution
from ..grid.transfer import resampled


class Departure:
    """A contact on a coarser grid in which a state of a finer one is an equilibrium, of the normal
    component.

    With v = m - C t(g) of the coarser grid's own compliance, at the finer one's gap g at its nodes,
    the initial gap there is g - v: what the grids differ by in this equilibrium stands still
    (Brandt 1977, Math. Comput. 31, 333: the correction of the full approximation scheme). So that
    a fold next to it is nearly where it is on the finer grid.

    Parameters
    ----------
    contact, coarse : Contact, the second on every other node
    origin : State of the first, an equilibrium

    Attributes
    ----------
    contact : Contact on the coarser grid
    origin : State, the equilibrium there
    """

    def __init__(self, contact, coarse, origin):
        self._fine, self._begin = contact, origin
        whole = origin.window.is_whole  # whose displacements are known, and are not copied
        self._cell = (origin.displacement.reshape(1, *contact.grid.local_shape) if whole
                      else contact.extended(origin))
        gap = contact.grid.every_other(self._cell[0] + contact.initial_gap)
        traction = contact.law.traction(gap.reshape(1, -1))
        displacement = Convolution(coarse.grid.whole, coarse.operator(1), 1).apply(
            traction, np.empty_like(traction))
        np.subtract(origin.means[:, None], displacement, out=displacement)
        self.contact = Contact(coarse.scene, gap=gap - displacement.reshape(gap.shape),
                               law=coarse.law, grid=coarse.grid, kernels=coarse.kernels)
        self.origin = State(coarse.grid.whole, displacement, origin.means)

    @cached_property
    def _loads(self):
        """(D, W) of the equilibrium on the coarser grid less those on the finer one."""
        (coarse, here), (fine, there) = ((contact, tractions(contact, state)) for contact, state
                                         in ((self.contact, self.origin),
                                             (self._fine, self._begin)))
        force = coarse.load_factor(1) * coarse.grid.sum(here) - fine.load_factor(1) * fine.grid.sum(
            there)
        sunk = coarse.grid.mean(here) - fine.grid.mean(there)
        return fine.signs(1) * fine.rigid_compliance(1) * sunk / fine.ranges[:1], force

    def load(self, controls, load):
        """The load of the coarser grid that stands for one of the finer one.

        Parameters
        ----------
        controls, load : of the normal component
        """
        return load + self._loads[1 if controls[0] == FORCE else 0]

    def injected(self, state):
        """A state of the finer grid, near the equilibrium, on the coarser one."""
        if state is self._begin:
            return self.origin
        moved = self._fine.extended(state)
        moved -= self._cell
        moved = self._fine.grid.every_other(moved)
        return State(self.origin.window, self.origin.displacement + moved.reshape(1, -1),
                     state.means)

    def prolonged(self, state):
        """A state of the coarser grid on the finer one: what has moved since the equilibrium is
        interpolated by its waves."""
        coarse, fine = self.contact, self._fine
        moved = coarse.extended(state) - self.origin.displacement.reshape(
            1, *coarse.grid.local_shape)
        cell = resampled(coarse.grid, fine.grid, moved)
        cell += self._cell
        return State(fine.grid.whole, cell.reshape(1, -1), state.means)
