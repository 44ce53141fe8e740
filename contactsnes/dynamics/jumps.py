"""Motion to rest at fixed loads, from a fold or from the undeformed body: where it settles,
polished by Newton."""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np

from ..contact import states
from ..contact.energies import potential, weights
from ..contact.force_form import ForceForm
from ..contact.interface_work import FAR_PANELS, straight
from ..continuation.points import NoEquilibrium, NotConverged
from ..options.database import read
from ..solvers.capabilities import has_modes
from ..solvers.snes import COLD, WARM
from ..solvers.vectors import collect
from .control import rough
from .endings import Circling, Leaving, Unsettled
from .kicks import between, carried
from .overdamped import MotionOptions, OverdampedMotion
from .relaxing import ENDLESS, relaxed

BESIDE = 5.0
"""Distance from an equilibrium, ranges where the law acts, within which a motion that begins there
begins in balance."""

RESTS = (1e-6, 1e-8, 1e-10)
"""Speeds at which Newton's method takes over from a motion, the next if that leads elsewhere,
ranges a relaxation time."""

SLOWED = 0.05
"""Part of the largest speed that a `rough` motion has had at which Newton's method tries to take
over, and a tenth of it the next time: one that passes a fold has not been faster before."""

SHORT, NEARER = 5.0, 0.1
"""Length of a jump, in kicks, below which the kick misses so much of the motion's own way that the
works on it are summed up anew; and the part of the jump with which that begins."""

BASIN = 0.02
"""Distance at any node where the law acts, ranges of the law, within which Newton's solution is the
motion's end."""
WIDE = 0.1
"""The same where a `rough` motion has but slowed down and the solution is stable."""


def settle(system, begin, controls, load, where, origin=None):
    """The equilibrium that motion from a state leads to at fixed load, polished by Newton.

    The motion is overdamped (`overdamped.OverdampedMotion`); where that cannot be followed, or
    where the user's method is relaxation itself, it is inertial (FIRE on the whole cell).

    Parameters
    ----------
    system : Corrector
    begin : function () -> State, which nobody has to hold during the motion
    controls, load : of each component
    where : str, what a message says of the place
    origin : State, the equilibrium at this load from which the motion begins, if it does: works
        are known from there on, against viscosity where that is near

    Raises
    ------
    NoEquilibrium : where overdamped motion shows that the body leaves, sinks in or slides for ever
    NotConverged : where the motion does not settle
    """
    options, held = read(MotionOptions), [states.with_components(begin(), len(controls))]
    if system.contact.grid.any(~np.isfinite(held[0].displacement)):
        raise NotConverged(
            f"the motion {where} cannot begin: its start holds NaN or infinite values")
    system.make_room(whole=True)
    if options.type != "overdamped" or not has_modes(system.settings):
        return inertial(system, held[0], controls, load, where, options)
    try:
        point = by_creep(system, held.pop(), controls, load, origin, options)
        collect()  # the motion's memory, after nothing that a process may meet alone
        return point
    except Leaving:
        raise NoEquilibrium(f"no equilibrium {where}: {ENDLESS}") from None
    except Circling as error:  # (inertia would keep it up as well)
        raise NotConverged(f"the motion {where} does not come to rest: {error}") from None
    except (Unsettled, NotConverged) as error:
        failure = str(error)
    collect()
    return _unfollowed(system, begin(), controls, load, where, failure)


def left(system, state, controls, load, where, origin=None):
    """`settle` from a state that a kick leads to from an equilibrium at this load.

    A jump hardly longer than its kick goes another way than that, on which the law does another
    work if it has no potential: its works are those of a second motion from a smaller kick.

    Parameters
    ----------
    system, state, controls, load, where, origin : as of `settle`, of where it begins
    """
    point = settle(system, lambda: state, controls, load, where, origin)
    if not math.isfinite(point.viscous_work):
        return point
    jump, kick = (states.missed(system.contact, origin, one) for one in (point.state, state))
    if jump >= SHORT * kick or all(potential(system.contact, one) is not None  # (no kick afar)
                                   for one in (origin, point.state)):
        return point
    with suppress(Leaving, Unsettled):
        begin = between(system.contact, origin, state, NEARER * jump / kick)
        point = _anew(system, begin, origin, point, NEARER * jump)
    collect()  # as of `settle`
    return point


def _anew(system, state, origin, point, near):
    """The point with the works of a second motion to it, if that comes as ``near`` as that, ranges
    of the law.

    Parameters
    ----------
    system, state, origin : Corrector, State, and as of `settle`
    point, near : Point, float
    """
    motion, way = started(system, state, point.controls, point.load, origin, read(MotionOptions))
    for rest, part in ((RESTS[0], SLOWED), *((rest, 0.0) for rest in RESTS)):
        motion.follow(rest, part)  # (a small jump is a slow one)
        if states.missed(system.contact, motion.state(), point.state) < near:
            return summed(system.contact, motion, way, point)
    return point


def _unfollowed(system, state, controls, load, where, failure):
    """`by_inertia` where overdamped motion cannot be followed, for a reason in words, ``failure``;
    the rest, and errors, as of `settle`."""
    system.log(f"the overdamped motion {where} cannot be followed ({failure}): following motion "
               "with inertia on the whole cell, which may lead to another equilibrium")
    try:
        return by_inertia(system, state, controls, load, where)
    except Leaving:
        raise NotConverged(f"{ENDLESS} where it moves with inertia {where}, but the overdamped "
                           f"motion there cannot be followed: {failure}") from None


def inertial(system, state, controls, load, where, options):
    """The equilibrium that motion with inertia leads to; where that has no end, since inertia may
    carry a body past an equilibrium, overdamped motion decides. Errors as of `settle`.

    Parameters
    ----------
    system, state, controls, load, where : as of `settle`
    options : MotionOptions
    """
    try:
        return by_inertia(system, state, controls, load, where)
    except Leaving:
        pass
    try:
        return by_creep(system, state, controls, load, None, options)
    except Leaving:
        raise NoEquilibrium(f"no equilibrium {where}: {ENDLESS}") from None
    except Unsettled as error:
        raise NotConverged(f"{ENDLESS} where it moves with inertia {where}, but the overdamped "
                           f"motion there cannot be followed: {error}") from None


def by_creep(system, state, controls, load, origin, options):
    """The equilibrium that overdamped motion leads to, with the works done on interface and against
    viscosity since ``origin``.

    Raises Leaving or Unsettled as the motion does, NotConverged where Newton's method does not
    confirm its end.

    Parameters
    ----------
    system, state, controls, load, origin : as of `settle`
    options : MotionOptions
    """
    motion, way = started(system, state, controls, load, origin, options)
    del state  # (much memory)
    point = at_rest(system, motion, controls, load)
    return summed(system.contact, motion, way, point) if motion.measured else point


def started(system, state, controls, load, origin, options):
    """The overdamped motion from a state, and the works that led there from ``origin`` on interface
    and against viscosity, for each component, phi_i, array (2, components); None without one.

    Parameters
    ----------
    system, state, controls, load, origin, options : as of `by_creep`
    """
    contact, state = system.contact, system.fitted(state)
    beside = origin is not None and states.missed(contact, origin, state) <= BESIDE
    elastic, given = carried(contact, origin, state) if beside else (None, math.nan)
    motion = OverdampedMotion(contact, system.symmetry, controls, load, state, system.totals,
                              options, system.settings.linear_precision, elastic,
                              measured=origin is not None)
    if origin is None:
        return motion, None
    done = straight(contact, origin, state, 1 if beside else FAR_PANELS)
    return motion, np.array([done, given - done])


def summed(contact, motion, way, point):
    """The point where a motion ends, with the works since the equilibrium beside which it began.

    Parameters
    ----------
    contact, motion, way : Contact, and as of `started`
    point : Point
    """
    works = contact.grid.node_area * motion.works + way
    # Newton's method goes the last part of the way: not a small one where nothing holds the body.
    works[0] += straight(contact, motion.state(), point.state, 1)
    interface, viscous = works @ weights(contact, len(point.controls))
    return replace(point, jump_work=float(interface), viscous_work=float(viscous))


def at_rest(system, motion, controls, load):
    """The converged point where a motion comes to rest, followed on until Newton confirms it.

    Parameters
    ----------
    system : Corrector
    motion : OverdampedMotion
    controls, load : of each component
    """
    early = rough(system.contact, len(controls), motion.measured) * (SLOWED, 0.1 * SLOWED)
    for rest, part in [*((RESTS[0], part) for part in early),
                       *((rest, 0.0) for rest in RESTS)]:
        motion.follow(rest, part)
        motion.make_room()
        most = COLD if (rest, part) == (RESTS[-1], 0.0) else WARM  # (beside a fold it may wander)
        try:
            return (taken_over if part else polished)(system, motion.state, controls, load, most)
        except NotConverged as error:
            reason = str(error)
        system.make_room(whole=True)
    raise NotConverged(reason)


def polished(system, rest, controls, load, most=COLD):
    """The converged point where a motion came to rest. NotConverged where Newton's method leads
    elsewhere.

    Parameters
    ----------
    system : Corrector
    rest : function () -> State, which nobody has to hold during the solve
    controls, load : of each component
    most : int, Newton iterations
    """
    point, led = system.solve(rest(), controls, load, most), rest()
    # Off the flat the balance hardly says where the body is.
    far = states.distance(system.contact, led, point.state) if not point.in_contact else 0.0
    if states.missed(system.contact, led, point.state, largest=True) < BASIN and far < 1.0:
        return point
    raise NotConverged("Newton's solution is not where the motion led")


def taken_over(system, slow, controls, load, most):
    """The same where a `rough` motion has but slowed down: the point has to be stable.

    Parameters
    ----------
    system : System
    slow : function () -> State that the motion has come to, as of `polished`
    controls : tuple, 'displacement' or 'force' of each component
    load : array
    most : int, Newton iterations
    """
    point = system.solve(slow(), controls, load, most)
    if point.softest < 0.0:
        raise NotConverged("Newton's solution is not stable")
    if not (point.in_contact
            and states.missed(system.contact, slow(), point.state, largest=True) < WIDE):
        raise NotConverged("Newton's solution is not where the motion slowed down")
    return point


def by_inertia(system, state, controls, load, where):
    """The equilibrium that damped motion with inertia leads to on the whole cell.

    Raises Leaving where the body leaves, NotConverged where it does not settle.

    Parameters
    ----------
    system, state, controls, load, where : as of `settle`
    """
    form = ForceForm(system.contact.periodic, controls)
    form.set_load(load)
    unknown = form.pack(system.contact.extended(states.with_components(state, form.components)))
    first = min(1e-3, 0.03 * form.displacement_norm(unknown,
                                                    form.residual(unknown, np.empty(form.size))))
    for tolerance in np.maximum((first, 1e-2 * first, 0.0), 1e-8):
        unknown = relaxed(system.run, form, unknown, tolerance, where)
        try:
            rest = system.symmetry.checked(form.state(unknown))
            return polished(system, lambda: rest, controls, load)
        except NotConverged as error:
            reason = str(error)
    raise NotConverged(f"the motion {where} settled, but {reason}")
