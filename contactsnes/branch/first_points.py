"""First points by Newton's method, where the gap is convex: from the start without overlap.

By way of softer laws on coarser grids where that leads to the same state. Where the gap is not
convex, motion decides (`coarse_motion`).

A sharp law is reached from far away in many Newton iterations, a soft one in few; softened to what
a coarse grid resolves, it costs next to nothing there, and each level's solution is the next one's
guess. Where a body that touches the flat has one equilibrium only, all levels lead to it.
"""

import numpy as np

from ..contact import states
from ..contact.force_form import FORMS
from ..contact.problem import APPROACH, FORCE
from ..continuation.points import NotConverged
from ..scene.resolution import LARGEST_RESOLUTION, PINNING, resolution
from ..solvers.capabilities import asked
from ..solvers.snes import COLD
from .coarse_motion import reached
from .coarser import coarser, finer_state, refined, resolving, sharpened

SPACING = 2.0 * LARGEST_RESOLUTION
"""Spacing x maugis^2 up to which a coarse grid keeps the law: an edge of contact hardly sticks
between its nodes yet."""

LOOSE = 1e-2
"""Tolerance on grids that stand for another equilibrium than the next one, by a law or by an edge
that sticks."""

LOOSER = 100.0
"""Times the tolerance that is asked for: far less than last digits of a state are moved by to see
what rounding leaves of it (`contact.balance`), and far more than that tolerance."""

STRIDES = {1: (3, 1), 2: (1,)}
"""By directions of the cell: of how many coarser grids one is solved on, and what is tried where
that fails. Those of a line cost less than what is made for a solve."""

REACH = 8.0
"""Gap, in ranges of a coarse grid's law, within which that law is taken to pull."""

FEWEST, SHORTEST = 8, 32
"""Nodes of each direction on the flat, at least, in the start of the coarsest grid; and nodes of
the cell."""


def start(system, controls, load):
    """The first point: the equilibrium that the undeformed body reaches under given loads.

    A cold solve finds it where the gap is convex; elsewhere, and where that fails, motion
    decides.

    Parameters
    ----------
    system : Corrector
    controls, load : of each component
    """
    why = ambiguous(system)
    if why is None:
        if not system.contact.convex:
            system.log("the gap is not convex: inertial motion leads to the first point, and where "
                       "several equilibria exist it may be another one than overdamped motion "
                       "reaches")
        try:
            return cold(system, controls, load)
        except NotConverged as error:
            why = f"no cold solve ({error})"
    system.log(f"{why}: the first point is where motion from the undeformed body leads")
    return reached(system, lambda contact: beginning(contact, controls, load), controls, load,
                   f"at {system.contact.scene.loads(controls, load)} from the undeformed body")


def ambiguous(system):
    """Why a cold solve may end elsewhere than the undeformed body, in words; None if not."""
    relaxed = FORMS[system.settings.form].whole_cell
    if relaxed and asked().is_relaxation:
        return None
    if not system.contact.convex:
        return "the gap is not convex, so that several equilibria may exist"
    if not relaxed and max(resolution(system.contact.scene, sheared=False)) > PINNING:
        return ("edges stick between nodes of so coarse a grid, where "
                "Newton's method may find an unstable branch")
    return None


def cold(system, controls, load):
    """The point at given loads that the body reaches from the start without overlap, without
    friction first.

    Parameters
    ----------
    system : Corrector
    controls, load : of each component
    """
    if len(controls) == 1:
        return first_point(system, controls, load)
    try:
        guess = _of_every_other_node(system, controls, load)
        if guess is not None:
            return system.solve(guess, controls, load, COLD)
    except NotConverged as error:
        system.log(f"no first point by way of a coarser grid ({error})")
    guess = first_point(system, controls[:1], load[:1]).state
    return system.solve(guess, controls, load, COLD)


def _of_every_other_node(system, controls, load):
    """The state near a first point of all components that a plane's coarser grid finds where it
    resolves gap and law; None elsewhere, and where the normal contact is the answer.

    Parameters
    ----------
    system, controls, load : as of `cold`
    """
    contact = system.contact
    moves = contact.scene.dimension == 2 and (contact.couples() or np.any(load[1:]))
    coarse = resolving(system, sheared=True) if moves else None
    if coarse is None:
        return None
    state = finer_state(coarse.contact, contact, cold(coarse, controls, load).state)
    contact.coarse.cache_clear()
    return system.fitted(state)


def nearly(system, controls, load):
    """The first point of the normal component to a looser tolerance, by Newton's method alone, of
    which what stops a solve to the one that is asked for can be told; None where that fails, too.

    Parameters
    ----------
    system, controls, load : as of `cold`
    """
    system.release()
    try:
        return first_point(system.on(system.contact, LOOSER * system.allowed), controls[:1],
                           load[:1])
    except NotConverged:
        return None


def first_point(system, controls, load):
    """The point of one component at a given load, by way of coarser grids where that serves, else
    on the grid itself.

    Parameters
    ----------
    system : Corrector
    controls, load : of the normal component
    """
    if system.contact.isolated and load[0] == 0.0:
        return system.solve(beginning(system.contact, controls, load), controls, load)
    found = levels(system.contact, beginning(system.contact, controls, load))
    for stride in STRIDES[len(system.contact.grid.shape)]:
        try:
            guess = through_grids(system, found, controls, load, stride)
            if guess is not None:
                guess = system.fitted(guess)  # (its half alone is kept)
                return system.solve(guess, controls, load, COLD)
        except NotConverged as error:
            system.log(f"no first point by way of one of {stride} coarser grids ({error})")
    return on_grid(system, controls, load)


def beginning(contact, controls, load):
    """The undeformed body from which a first point is reached; components as controls.

    Parameters
    ----------
    contact : Contact
    controls, load : of each component
    """
    if contact.isolated and load[0] == 0.0:
        # Without a force an isolated body stays where it starts, outside the law's range.
        return states.with_components(states.apart(contact), len(controls))
    return states.undeformed(contact, controls, load)


def on_grid(system, controls, load):
    """The point of one component at a given load that a solve from the start without overlap finds.

    Where the mean surface may move (a prescribed force, a body that gives way as a whole), solves
    at given approaches first find the one that belongs to the load.

    Parameters
    ----------
    system : Corrector
    controls, load : of the normal component
    """
    state = states.undeformed(system.contact, controls, load)
    if controls[0] == FORCE or system.contact.rigid_compliance(1)[0] > 0.0:
        state = _at_load(system, state, controls, load)
    return system.solve(state, controls, load, COLD)


def _at_load(system, state, controls, load):
    """A state near the load in question: a few solves at given approaches, which a secant
    chooses."""
    contact = system.contact
    kept = (APPROACH,)
    trials = []
    approach = float(contact.signs(1)[0] * state.means[0] / contact.ranges[0])
    for _ in range(8):
        values = np.array([approach])
        point = system.solve(states.undeformed(contact, kept, values), kept, values, COLD)
        reached = (point.forces if controls[0] == FORCE else point.displacements)[0]
        trials = [*trials[-1:], (approach, reached)]
        if abs(reached - load[0]) <= 0.02 * max(1.0, abs(load[0])):
            break
        (first, before), (last, now) = trials[0], trials[-1]
        rate = (now - before) / (last - first) if len(trials) > 1 and now != before else 0.7
        approach += float(np.clip((load[0] - now) / max(rate, 0.1), -2.0 - 0.5 * abs(approach),
                                  2.0 + 0.5 * abs(approach)))
    return point.state


def levels(contact, start):
    """The contact and coarser ones through which its first point may be reached, the finest first;
    none but itself if none.

    One equilibrium is there for a convex body that is brought to the flat or pressed on it, where
    its edge hardly sticks between nodes.
    """
    found, grid = [contact], contact.grid
    gap = states.normal_gap(contact, start)
    if (not contact.convex or max(resolution(contact.scene, False)) > PINNING
        or not grid.minimum(gap) <= 1e-9):
        return found
    while all(n % 4 == 0 and n >= 2 * SHORTEST for n in found[-1].grid.shape):
        level = found[-1].coarse(SPACING)
        pulled = grid.count(gap <= REACH * contact.ranges[0] / level.ranges[0])
        if pulled * level.grid.size < (2 * FEWEST) ** len(grid.shape) * grid.size:
            break
        found.append(level)
    return found


def through_grids(system, found, controls, load, stride):
    """The state near a first point that coarser grids find from a start without overlap, or None
    where none serves.

    Parameters
    ----------
    system : Corrector
    found : `levels` of its contact
    controls, load : of the normal component
    stride : int, of how many coarser grids one is solved on, the coarsest first
    """
    state, coarsest = None, len(found) - 1
    for k in range(coarsest, 0, -1):
        level, finer = found[k], found[k - 1]
        if (coarsest - k) % stride == 0:
            coarse = coarser(system, level, tolerance(level, finer))
            if coarse is None:
                return None
            state = _at_level(coarse, state, controls, load)
        # Edges between the nodes of a grid that does not resolve them leave no smooth field.
        state = (refined if _resolved(level) else sharpened)(level, finer, state)
    system.contact.coarse.cache_clear()
    return state


def _at_level(coarse, state, controls, load):
    """The state on a coarser grid from that of the grid before it, or from the start without
    overlap: where there is none yet, and where the law before it reached so far that the body had
    come into contact that does not yet under this one.

    Parameters
    ----------
    coarse : Corrector on the coarser grid
    state : State or None
    controls, load : of the normal component
    """
    if state is not None:
        try:
            return coarse.solve(state, controls, load, COLD).state
        except NotConverged:
            pass
    return on_grid(coarse, controls, load).state


def tolerance(level, finer):
    """The residual norm that is worth reaching on a coarse grid; None where it is that of the
    finest."""
    return None if _resolved(level) and level.ranges[0] == finer.ranges[0] else LOOSE


def _resolved(level):
    """Whether a grid resolves the law that a contact has on it."""
    return max(resolution(level.scene, False)) <= 1.01
