"""What continuation asks of a system: the contract of what is solved, and how.

A state is an object of the system's own, which continuation hands back as it is. Loads are arrays,
one controlled value a component; positions are places in a leg, 0 to 1; lengths of the branch and
distances of states are numbers in a unit of the system's (ranges of the law).
"""

from collections.abc import Callable, Sequence
from typing import Any, Optional, Protocol, runtime_checkable

import numpy as np

from .points import Crossing, Direction, Leg, Point


@runtime_checkable
class States(Protocol):
    """States combined, and how far they are from each other; nothing here solves."""

    def adapted(self, point: Point, controls: tuple, load: np.ndarray) -> Point:
        """The point under the controls and the load of another leg, which it satisfies as well.

        Parameters
        ----------
        point : Point
        controls : tuple of 'displacement' or 'force', one a component
        load : array, one controlled value a component
        """

    def lighter(self, points: Sequence) -> Sequence:
        """Points, oldest first, the last as it is, others as exact as predictions ask for."""

    def extrapolate(self, points: Sequence, weights: Sequence) -> Any:
        """The weighted sum of the states of points or of `Direction`s."""

    def follow_edge(self, points: Sequence, weights: Sequence) -> Optional[Any]:
        """The same in coordinates that follow what moves; None where there are no such."""

    def fronts_moved(self, first: Point, last: Point) -> bool:
        """Whether something narrow moved between points, which a tangent leaves in place."""

    def missed(self, guess: Any, state: Any) -> float:
        """Distance of a state from its prediction, root mean square where it matters."""

    def ways(self, guess: Any, last: Any, state: Any) -> tuple[float, float]:
        """Distances of a state from its prediction and from where its step began, as of `missed`.

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """

    def strayed(self, guess: Any, last: Any, state: Any) -> float:
        """By how much a part of a state is farther from its prediction than steps from the state
        ``last`` of a smooth branch leave open; at most 0 where no part is.

        Parameters
        ----------
        guess : the predicted state
        last : the state that the step began at
        state : the state that was found
        """

    @property
    def leeway(self) -> float:
        """How far any part of a state may be from its prediction, however short the step is."""

    def adrift(self, guess: Any, last: Any, state: Any) -> bool:
        """Whether a part of a state is off its prediction by so much of the step's way that a jump
        may be a part of it, a short one of which nothing else tells.

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """

    def doubtful(self, guess: Any, last: Any, state: Any) -> bool:
        """Whether a jump may be a part of the way from ``last`` to a state that was foretold.

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """

    def detached(self, guess: Any, last: Any, state: Any, back: Any) -> bool:
        """The same once ``back`` is known, the prediction of ``last`` by the tangent at the state.

        Parameters
        ----------
        guess, last, state : as of `strayed`
        back : a state
        """

    def leapt(self, last: Any, state: Any) -> bool:
        """Whether a jump may be a part of the way from ``last``, wherever a state was foretold."""

    def progress(self, origin: Any, ahead: Any, state: Any) -> float:
        """Part of the way from ``origin`` to ``ahead`` that a state has gone; negative: away.

        Parameters
        ----------
        origin, ahead, state : states
        """

    def chord_length(self, first: Any, last: Any) -> float:
        """Length of the straight way between two states, a seminorm of their difference."""


@runtime_checkable
class Solves(Protocol):
    """Points and directions; all but `told` and `account` raise NotConverged where they fail.

    Attributes
    ----------
    log : function (sentence), what a user should know
    examiner : `Stability` that counts unstable modes where nobody asked for certificates, or None
    """

    log: Callable
    examiner: Optional[Callable]

    def told(self, controls: tuple, load: np.ndarray) -> str:
        """Loads in words."""

    def account(self) -> dict:
        """Name -> count of what was spent since the last call."""

    def solve(self, guess: Any, controls: tuple, load: np.ndarray) -> Point:
        """The point at a load, near a guess of its state; ``spent["last_iterations"]`` is how hard
        it was (0: not known).

        Parameters
        ----------
        guess : a state
        controls, load : as of `States.adapted`
        """

    def solve_arc(self, chord: tuple, length: float, guess: Any, position: float, leg: Leg,
                  border: tuple = (1.0, 0.0), tight: bool = False) -> Point:
        """The point at a length along a chord, with its position in the leg.

        Parameters
        ----------
        chord : two states, whose difference measures lengths
        length : along the chord, from its first state on
        guess, position : a state and its position in the leg, near the point
        leg : Leg
        border : what the length counts in the equation that holds it, and what a unit of the
            position counts, from the given one on
        tight : whether the residual is to be so small that a fold's load does not depend on it
        """

    def along_tangent(self, point: Point, leg: Leg, position: float, step: float) -> Any:
        """The state of a point at a position, moved along the branch's tangent by a step of the
        position.

        Parameters
        ----------
        point : Point
        leg : Leg
        position : of the point in the leg, 0 to 1
        step : of the position, either sign
        """

    def direction(self, point: Point, chord: tuple, leg: Leg) -> Direction:
        """The branch's direction at a point, per unit of length along a chord; regular at a fold,
        too.

        Parameters
        ----------
        point : Point
        chord : two states, whose difference measures lengths
        leg : Leg
        """

    def unit(self, point: Point, direction: Direction) -> Direction:
        """A direction at a point per unit of the branch's own length."""


@runtime_checkable
class Limits(Protocol):
    """Events of a branch, and its ends."""

    def margin(self, point: Point, event: str) -> float:
        """What is at least 0 where there is the event 'pull_off' or 'gross_sliding'."""

    def stride(self, point: Point, direction: Direction) -> float:
        """Length of the branch in which what moves passes a node of the grid; 0 if that cannot be
        said."""

    def end_of_branch(self, point: Point, leg: Leg, heading: float) -> str:
        """Why a branch has nothing to offer beyond a point whose load goes on (``heading`` 1) or
        back (-1), in words, or "".

        Parameters
        ----------
        point : Point
        leg : Leg
        heading : 1 or -1
        """

    def pulled_away(self, point: Point, leg: Leg) -> str:
        """Why a leg that begins at a point has no equilibrium, since it pulls a body that nothing
        holds, in words, or "".

        Parameters
        ----------
        point : Point
        leg : Leg
        """

    def end_of_attraction(self, point: Point, leg: Leg, position: float) -> Optional[Point]:
        """The fold, with its position, where a growing force ends what attracts a free body, or a
        falling one what moves a gliding body; None for any other.

        Parameters
        ----------
        point : Point
        leg : Leg
        position : of the point in the leg, 0 to 1
        """

    def within_range(self, point: Point) -> Optional[Any]:
        """A state in which something acts on a body that a force moves freely, in which a gliding
        one is held; None for any other."""

    def neutral(self, point: Point) -> Optional[int]:
        """The component in which nothing holds a point's body: one of many equilibria; None for any
        other."""


@runtime_checkable
class Motion(Protocol):
    """Motion under a fixed load, from one equilibrium to another."""

    def kicked(self, fold: Point, beyond: Any, part: float) -> Any:
        """The state beside a fold, or on the way to the state ``beyond``, at a part of the distance
        at which motions begin.

        Parameters
        ----------
        fold : Point
        beyond : a state
        part : float, dimensionless
        """

    def settle(self, state: Any, controls: tuple, load: np.ndarray, where: str,
               origin: Optional[Any] = None) -> Point:
        """The point to which motion from a state leads.

        Parameters
        ----------
        state : where it begins
        controls, load : what is held
        where : what messages say of the place
        origin : the equilibrium beside which it begins, if it does

        Raises
        ------
        NoEquilibrium : where motion shows that there is none
        NotConverged : where it does not settle
        """

    def crossed(self, last: Point, beyond: np.ndarray, where: str) -> Crossing:
        """What lies between a point and a load beyond a fold, and under that load.

        Parameters
        ----------
        last : Point
        beyond : what is held during the motion that tells
        where : what messages say of the place

        Raises
        ------
        NoEquilibrium : where motion shows that there is none
        NotConverged : where the motion does not settle
        NoWayBack : where no branch leads back from there, or to more energy
        """


@runtime_checkable
class System(States, Solves, Limits, Motion, Protocol):
    """All that continuation asks (of a contact: ``contactsnes.branch.tracing.Tracer``)."""


@runtime_checkable
class Stability(Protocol):
    """What continuation asks of certificates, of whoever gives them.

    Where bifurcations are not looked for any function (Point) -> Point will do.
    """

    def __call__(self, point: Point) -> Point:
        """The point with ``stable`` and ``unstable_modes``."""

    def critical(self, point: Point, number: int) -> tuple:
        """(real part of the eigenvalue of a rank in stability, the point with it and its mode)."""

    def aside(self, point: Point) -> Any:
        """A state that differs from a point's by its mode, by a unit at most."""
