"""How well a state balances: the residual of the displacement form at all nodes of its window,
evaluated anew."""

import math
from typing import NamedTuple

import numpy as np

from ..grid.active import Nodes
from ..grid.boxes import convolution
from ..grid.parity import asymmetry
from .even_form import EvenForm
from .forms import DisplacementForm
from .state import State

CONVERGENCE = """\
A point is converged when residual_norm <= -snes_atol (default 1e-8; -snes_rtol and -snes_stol
default to 0), with residual_norm = sqrt( sum over the window's nodes and components of
r^2 / (nodes x components) + sum over force rows of (difference / max(1, |prescribed force|))^2 )
and r = u + C t - ubar in ranges of the law (u_n in delta_n, u_t in delta_t). It is found anew at
all nodes for every point, whatever method, symmetry or form led to it; beside it stands
largest_residual, the largest |r| at a node where the law acts (gap within its range), of which a
mean over many nodes may tell little."""

ALIKE = 1e-3
"""Relative difference of two norms of F up to which they are of one unknown. F is the difference of
displacements and what they respond to: of other displacements all of it is another."""
DIGITS = 100.0
"""Last digits of displacements by which two norms of one unknown may differ besides."""
MANY = 1024.0
"""Last digits by which displacements are moved to see what one does: more than what a converged
state leaves, and small beside the law's range."""
TOLERANCE = 1e-8
"""Default of -snes_atol."""
ROUNDING = 8.0 * np.finfo(float).eps
"""Largest difference of mirror images in tractions that are even, relative to the largest of
them."""


class Imbalance(NamedTuple):
    """The ``residual_norm`` of a state, the largest imbalance at a node where the law acts (0 if it
    acts nowhere) and, on a window of some nodes of the cell, the smallest normal gap at the others
    (None where that was not found besides)."""

    norm: float
    largest: float
    closest: float | None = None


class Response:
    """Product of a circulant operator of the cell with fields on a window, at all of its nodes: as
    `boxes.convolution`.

    Fields that are even or odd to rounding, which is asked of each, take half of the transforms, or
    a quarter.

    Parameters
    ----------
    window : the nodes that carry fields
    operator : Operator on the cell
    count : number of components
    half : EvenConvolution with the same operator on half of the window, or None
    make : what makes a transform, as of `cell.Convolution`
    """

    def __init__(self, window, operator, count, half, make=None):
        self._given, self._whole = (window, operator, count, make), None
        self._half = half

    def apply(self, values, out):
        """out (components, nodes) = operator times values (components, nodes), perhaps the same
        array."""
        if self._half is not None and asymmetry(
                self._given[0], values,
                self._half.window.parities) <= ROUNDING * self._given[0].grid.maximum(
                    np.abs(values)):
            folded = self._half.window.fold(values)
            out[...] = self._half.window.unfold(self._half.apply(folded, folded))
            return out
        if self._whole is None:
            self._whole = convolution(*self._given)
        return self._whole.apply(values, out)


class FullForm(DisplacementForm):
    """The displacement form at all nodes of a window, whose response is a `Response`.

    Parameters
    ----------
    contact, window, controls : as of `DisplacementForm`
    half : EvenConvolution on half of the window, or None
    """

    def __init__(self, contact, window, controls, half):
        self.convolution_class = lambda window, operator, count, make: Response(
            window, operator, count, half, make)
        super().__init__(contact, window, controls)

    def closest_beyond(self, mean):
        """None: it is whole transforms that leave the response at all nodes of the cell."""
        return None


def asked(form, state, reach, ended=None):
    """Norm of a form's F at a state, the largest imbalance at a node where the law acts, ranges of
    the law (0 if it acts nowhere), and whether it does anywhere.

    Parameters
    ----------
    form : DisplacementForm or EvenForm
    state : State on its window
    reach : normal gap within which the law acts, ranges
    ended : float, norm of F where a solve of the form ended, or None: where the response of that
        leads to the same norm at the state it is not made again
    """
    plain, displacement = getattr(form, "half", form), form.nodal(state)
    if form.kernel:
        told = displacement, state.means[form.forced], reach
        if ended is not None and form.kernel.answers():
            found = form.kernel.imbalance(*told, True)
            if _of_one_unknown(plain, displacement, found[0], ended):
                return found
        return form.kernel.imbalance(*told)
    acts, (made, rows) = displacement[0] + plain.initial_gap < reach, plain.pulled
    if ended is not None and made == form.grid.counter.made:
        found = _imbalance(plain, displacement, rows, acts)
        if _of_one_unknown(plain, displacement, found[0], ended):
            return found
    np.copyto(plain.work, displacement)
    plain.work[0] += plain.initial_gap
    return _imbalance(plain, displacement, plain.pull(state.means[form.forced]), acts)


def _of_one_unknown(form, displacement, norm, ended):
    """Whether two norms of F are of one unknown: they differ by little, or by what rounding leaves
    of displacements of this size.

    Parameters
    ----------
    form : DisplacementForm
    displacement : array (components, nodes), ranges of the law
    norm, ended : floats
    """
    apart = abs(norm - ended)
    if apart <= ALIKE * ended:
        return True
    size = math.sqrt(np.sum(form.grid.sum(np.square(displacement)))) / form.root
    return apart <= DIGITS * np.finfo(float).eps * size


def _imbalance(form, displacement, rows, acts):
    """What `asked` returns, in the form's own memory, which has C t - vbar: a large plane has no
    room for copies.

    Parameters
    ----------
    form : DisplacementForm
    displacement : array (components, nodes), ranges of the law
    rows : imbalance of each force row
    acts : mask of the nodes where the law acts
    """
    aside, grid = form.work, form.grid
    aside += displacement
    largest = float(grid.maximum(np.abs(aside, out=aside), where=acts, initial=0.0))
    aside /= form.root
    squares = np.sum(grid.sum(np.square(aside, out=aside))) + rows @ rows
    return math.sqrt(squares), largest, grid.any(acts)


def left_by_rounding(contact, state, controls, load):
    """What rounding leaves of a state's ``residual_norm``: as much as it changes where each
    displacement moves by its last digit. Tractions of deep contacts change by more than the body
    gives way to.

    Parameters
    ----------
    contact : Contact
    state : State
    controls, load : of each component, ranges of the law
    """
    digits = MANY * np.finfo(float).eps
    displacement = np.array(state.displacement)
    signs = np.random.default_rng(0).choice((-1.0, 1.0), displacement.shape)
    moved = State(state.window, displacement * (1.0 + digits * signs), state.means)
    return Balance(contact)(moved, controls, load, None).norm / MANY


class Balance:
    """Imbalances of states of a contact, from their displacements and means alone: tractions and
    residuals of all nodes.

    The first state in which the law acts on a window is asked by whole transforms in any case.

    Parameters
    ----------
    contact : Contact
    """

    def __init__(self, contact):
        self.contact = contact
        self._form = None
        self._proved = None
        self._mirrored = None, False  # the last window asked for, and whether its gap is even

    def __call__(self, state, controls, load, solver, ended=None):
        """The Imbalance of a state under controlled values.

        Parameters
        ----------
        state : State
        controls, load : of each component, ranges of the law
        solver : form that led to it; None: no form did
        ended : float or None, as of `asked`, of that form
        """
        if self._halved(state, solver):
            if load is not solver.load:
                solver.set_load(load)
            return Imbalance(*asked(solver, state, self.contact.law.range, ended)[:2])
        form = self._form_on(state.window, tuple(controls), solver)
        if load is not form.load:
            form.set_load(load)
        if state.half is not None and form is not solver:  # the state keeps its half alone
            state = State(state.window, state.unfolded(state.once), state.means)
        norm, largest, acts = asked(form, state, self.contact.law.range,
                                     ended if form is solver else None)
        closest = (form.closest_beyond(state.means[0])
                   if isinstance(state.window, Nodes) and state.window.hull.is_whole else None)
        if isinstance(solver, EvenForm) and acts:
            self._proved = state.window, len(controls)
        return Imbalance(norm, largest, closest)

    def _halved(self, state, solver):
        """Whether the half of a state tells of all of its nodes: it is made of that alone, as the
        gap is, on a window on which halves have been tried."""
        if (not isinstance(solver, EvenForm) or not solver.tells(state)
                or self._proved != (state.window, solver.components)):
            return False
        if self._mirrored[0] != state.window:
            gap = self.contact.gap_on(state.window)
            self._mirrored = state.window, asymmetry(state.window, gap[None]) <= ROUNDING
        return self._mirrored[1]

    def _form_on(self, window, controls, solver):
        """The displacement form at all nodes of a window: the solver's, if it has that, or one that
        is kept."""
        for form in (solver, self._form):
            if isinstance(form,
                          DisplacementForm) and form.window == window and form.controls == controls:
                return form
        half = solver.half.convolution if isinstance(solver,
                                                     EvenForm) and solver.window == window else None
        if half is not None and self._proved != (window, len(controls)):
            # On each window halves themselves are on trial the first time.
            return DisplacementForm(self.contact, window, controls)
        self._form = FullForm(self.contact, window, controls, half)
        return self._form
