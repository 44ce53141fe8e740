"""Points of a branch, legs of its path, and what goes wrong: what continuation and its solvers hand
to each other."""

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Optional

import numpy as np

SAME = 1e-6
"""Relative difference up to which loads of folds that were located are one."""
LEFT = 1e-8
"""Way of a load, over the load where that is above one, up to which it is what solves leave of
their balance."""


class NotConverged(RuntimeError):
    """A solve ended without a converged point; the message names PETSc's reasons."""


class NoFold(NotConverged):
    """The search along the arc found neither a fold nor a way past the trouble."""


class NoWayBack(NotConverged):
    """The branch beyond a bracket of loads does not lead back into it, or to more energy."""


class Crossing(NamedTuple):
    """What lies in a bracket of loads and beyond it.

    Attributes
    ----------
    begin, end : float, where a narrower one lies in the bracket, 0 and 1 if it is the same
    before : Point at its begin of the branch that leads into it
    behind : Point after the jump there; None where that is ``before`` itself: there is no fold
    ahead : State beyond the jump at its end
    """

    begin: float
    end: float
    before: object
    behind: object
    ahead: object


class TooCoarse(RuntimeError):
    """A point misses the accuracy for which its grid was chosen.

    Parameters
    ----------
    sentence : str, the message
    scene : Scene, on the grid to take instead; an attribute, too, as are all below
    load : array of the point's controlled values
    error : float, its relative error, which is too large
    """

    def __init__(self, sentence, scene, load, error):
        super().__init__(sentence)
        self.scene = scene
        self.load = load
        self.error = error


def without_frames(error):
    """Drop where an error, and those it came from, were raised: frames hold forms and states, while
    what stopped a step is looked for."""
    while error is not None:
        error.__traceback__ = None
        error = error.__context__


class NoEquilibrium(RuntimeError):
    """No equilibrium exists under the present loads: the body leaves, or slides without end."""


@dataclass(frozen=True)
class Direction:
    """Where a branch goes, per unit of its length: change of the state (a state itself) and of the
    position in the leg."""

    state: object
    rate: float


@dataclass(frozen=True, repr=False)
class Point:
    """A converged point of a branch.

    Attributes
    ----------
    state : displacements and means (``contactsnes.contact.state.State``)
    controls : 'displacement' or 'force' for each component
    load : controlled values (u_n,r, u_t,r or w_n,r, w_t,r by ``controls``)
    displacements, forces : D, U, ... and W, T, ... of each component, controlled or not
    leg, position, step : leg of the path (0: start), place in it (0 to 1) and the step to try next
        (same unit)
    arc : length of the step along the branch to try next, ranges of the law; 0 in natural
        continuation
    origin : controlled values where the leg began
    in_contact, sliding : whether a node is in contact; whether all of those have slipped past the
        law's peak
    residual_norm, largest_residual : of the archive; the second nan where nobody looked at it
    spent : name -> count of iterations, evaluations, transforms and time since the point before
    event, fold_kind : as in the archive, the event None where there is none
    elastic_energy, interfacial_energy : stored in body and interface, phi_n beta (nan where the law
        has no potential)
    external_work, interface_work, dissipated_work : done by the loads, on the interface, and lost
        in jumps since the path began
    energy_imbalance : external work less all that it went into, by quadratures independent of each
        other where they can be
    smooth_steps : steps since the path's last corner, which a quadrature may join
    jump_work, viscous_work : done on the interface and against the body's viscosity along the
        overdamped motion of a jump, phi_n beta; nan elsewhere
    jump_balance : by what a jump's dissipation is known (``energies.BALANCES``)
    tangents : at a fold, the branch's direction, whose state is the null vector; at one in a corner
        of the branch, which has none, the directions on its two sides
    fold_precision : relative width of the bracket that a fold's load is known to; 0 at points that
        are no folds
    resolved : 0 where edges of contact or slip stick between nodes, or the law has become steeper
        than they resolve, so that a fold may be the grid's own, else 1
    softest : smallest real part among the Ritz values of the solve's last linear systems, a
        by-product: below zero where a mode is unstable; nan where they tell nothing
    stable, unstable_modes : 1 or 0, and how many modes are not; -1 where nobody asked, the second
        also where modes were not found
    unstable_parities : of each of them (of a fold its own, too), whether it is even (1), odd (-1)
        or neither (0) about the apex in each direction, tuples; empty ones where mirror images of
        the gap differ, and empty where modes were not looked for
    leading_eigenvalue, mode : of overdamped motion, the smallest real part, and its mode as a state
        (``contactsnes.dynamics.stability``)
    units : 'displacement' and 'force' -> (size, name) of each component's unit in what the scene is
        told in, for showing the point; all else of it is in scaled units
    """

    state: object
    controls: tuple
    load: np.ndarray
    displacements: np.ndarray
    forces: np.ndarray
    in_contact: bool
    sliding: bool
    residual_norm: float
    largest_residual: float = np.nan
    leg: int = 0
    position: float = 0.0
    step: float = 0.0
    arc: float = 0.0
    origin: np.ndarray = None
    spent: dict = field(default_factory=dict)
    event: Optional[str] = None
    fold_kind: str = ""
    elastic_energy: float = np.nan
    interfacial_energy: float = np.nan
    external_work: float = np.nan
    interface_work: float = np.nan
    dissipated_work: float = np.nan
    energy_imbalance: float = np.nan
    smooth_steps: int = 0
    jump_work: float = np.nan
    viscous_work: float = np.nan
    jump_balance: str = ""
    tangents: tuple = ()
    fold_precision: float = 0.0
    resolved: int = 1
    softest: float = np.nan
    stable: int = -1
    unstable_modes: int = -1
    unstable_parities: tuple = ()
    leading_eigenvalue: complex = complex(np.nan, np.nan)
    mode: object = None
    units: dict = field(default_factory=dict)

    def changed(self, **values):
        """The point with other values of some attributes: ``dataclasses.replace``, which looks at
        each of them, takes twenty times as long."""
        made, known = object.__new__(type(self)), vars(self)
        given = vars(made)
        given.update(known, **values)
        if len(given) > len(known):
            unknown = sorted(values.keys() - known.keys())
            raise TypeError(f"a point has no {', '.join(unknown)}")
        return made

    def sealed(self):
        """The point, whose arrays nobody can write into any more: the path goes on from them."""
        for array in (self.load, self.displacements, self.forces, self.origin):
            if array is not None:
                array.flags.writeable = False
        self.state.seal()
        return self

    def __repr__(self):
        """Place, loads in the units of the scene (controlled ones marked), and what is special."""
        told = []
        for name, values in (("displacement", self.displacements), ("force", self.forces)):
            for i, value in enumerate(values):
                size, unit = self.units[name][i] if self.units else (1.0, "")
                mark = "*" * (self.controls[i] == name)
                told.append(f"{name}[{i}] {size * value:.6g}{mark} {unit}".rstrip())
        event = f", {self.event}{f' ({self.fold_kind})' * bool(self.fold_kind)}" * bool(self.event)
        return (f"<Point: leg {self.leg} at {self.position:.4g}, {', '.join(told)}, "
                f"{'in' if self.in_contact else 'no'} contact{', sliding' * bool(self.sliding)}"
                f"{event}, residual {self.residual_norm:.1e}>")


@dataclass(frozen=True)
class Leg:
    """A straight leg between two sets of controlled values, and the sizes of its steps as parts of
    its length."""

    number: int
    controls: tuple
    start: np.ndarray
    end: np.ndarray
    moving: int
    initial: float
    largest: float
    smallest: float

    @property
    def direction(self):
        """Change of the controlled values along the whole leg."""
        return self.end - self.start

    @property
    def left_over(self):
        """Whether all that it moves is what solves leave, as of the force of a displacement that
        was held at nothing."""
        return left_over(self.direction, self.end)

    def at_once(self):
        """The leg, in one step where that is all that it moves."""
        return replace(self, initial=1.0, largest=1.0) if self.left_over else self

    def load(self, position):
        """Controlled values at a place of the leg, exact at its end."""
        return self.end.copy() if position == 1.0 else self.start + position * self.direction


def left_over(way, load):
    """Whether a way to a load is in each component no longer than what solves leave."""
    return bool(np.all(np.abs(way) <= LEFT * np.maximum(1.0, np.abs(load))))


def lagrange_weights(nodes, target):
    """Weights of values at ``nodes`` whose sum is the polynomial through them at ``target``; nan
    where two nodes are one."""
    # (floats of Python: NumPy's take twice as long, one by one)
    nodes, target, weights = [float(node) for node in nodes], float(target), []
    for k, node in enumerate(nodes):
        weight = 1.0
        for place, other in enumerate(nodes):
            if place != k:
                weight *= (target - other) / (node - other or math.nan)
        weights.append(weight)
    return np.array(weights)


def unfinished_fold(history):
    """How many of the last points (of a killed run) are a fold, with its further events, that no
    jump follows yet.

    The state beyond a fold is not archived, so that it has to be found again.
    """
    events = [point.event for point in history]
    folds = [place for place, event in enumerate(events) if event == "fold"]
    return len(events) - folds[-1] if folds and "jump" not in events[folds[-1]:] else 0


def same_fold(fold, other):
    """Whether two folds are one: their loads differ by no more than these are known to."""
    known = SAME + fold.fold_precision + other.fold_precision
    away = np.abs(fold.load - other.load)
    return fold.leg == other.leg and bool(np.all(away <= known * np.maximum(np.abs(other.load),
                                                                           1e-3)))


def new_points(branch, waiting):
    """The points of a branch without those until its next fold and the events that follow it, which
    the archive has already: ``waiting``, of which the first is that fold."""
    left = len(waiting)
    for point in branch:
        if left == 0:
            yield point
        elif left < len(waiting) or point.event == "fold":
            if left == len(waiting) and not same_fold(point, waiting[0]):
                break
            left -= 1
    if left:
        raise NotConverged("the fold at the end of the archive was not "
                           "found again: resume with the options that found it")
