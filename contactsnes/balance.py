"""How well a state balances: the residual of the displacement form at all nodes of its window, evaluated anew."""

from typing import NamedTuple

import numpy as np

from .forms import DisplacementForm
from .laws import CUTOFF


class Imbalance(NamedTuple):
    """The ``residual_norm`` of a state, and the largest imbalance at a node where the law acts (0 if it acts nowhere)."""

    norm: float
    largest: float


class Balance:
    """Imbalances of states of a contact, each from its displacements and means alone: no mirror images, no method's own residual.

    Parameters
    ----------
    contact : Contact
    """

    def __init__(self, contact):
        self.contact, self._form = contact, None

    def __call__(self, state, controls, load, form=None):
        """The Imbalance of a state under controlled values, ranges of the law.

        A ``form`` of the solver's serves if it is the displacement form at all nodes of the state's window; else one is kept.
        """
        form = form if self._serves(form, state, controls) else self._kept(state, controls)
        form.set_load(load)
        unknown = form.pack(state.displacement, state.means[form.forced])
        residual = form.residual(unknown, np.empty(form.size))
        acts = form.gap(unknown)[0] < CUTOFF
        field = np.abs(form.displacement(residual))
        return Imbalance(form.grid.norm(residual), float(form.grid.maximum(field, where=acts, initial=0.0)))

    def _kept(self, state, controls):
        """The displacement form on the state's window."""
        if not self._serves(self._form, state, controls):
            self._form = DisplacementForm(self.contact, state.window, controls)
        return self._form

    @staticmethod
    def _serves(form, state, controls):
        """Whether a form is the displacement form of all nodes of a state's window."""
        return type(form) is DisplacementForm and form.window == state.window and form.controls == tuple(controls)
