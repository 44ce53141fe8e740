"""States beside an equilibrium, where motions begin, and what the body carries there."""

import numpy as np

from ..contact import combining, states
from ..options.database import read
from .overdamped import MotionOptions


def kicked(system, fold, beyond, part):
    """The state beside a fold from which the motion of a jump begins.

    Along the null vector, the way the branch goes on; at a corner, which has none, along the branch
    behind it. A plateau of the load has neither: towards a state beyond it.

    Parameters
    ----------
    system : Corrector
    fold : Point
    beyond : State, of the branch behind the fold
    part : float, of the distance -jump_motion_kick
    """
    state = fold.state
    if fold.tangents:
        change = fold.tangents[-1].state
        beyond = states.State(change.window, states.onto(state, change.window)
                              + change.displacement, state.means + change.means)
    part *= read(MotionOptions).kick / max(states.missed(system.contact, state, beyond), 1e-12)
    return between(system.contact, state, beyond, part)


def between(contact, first, last, part):
    """The state at a part of the straight way from one to another.

    Parameters
    ----------
    contact : Contact
    first, last : State
    part : float
    """
    return combining.combined(contact, [last, first], [part, 1.0 - part])


def carried(contact, origin, state):
    """Tractions that the body carries (components, nodes of the window) in a state beside an
    equilibrium, and the work that is done on it on the straight way there, for each component,
    phi_i. What of this is not done on the interface is done against viscosity, where the body goes
    by itself.

    The way is one of its modes, along which the body is in balance with the law's tangent: with the
    law itself it is not, as far as that bends.

    Parameters
    ----------
    contact : Contact
    origin : State, the equilibrium
    state : State
    """
    gap = states.onto(origin, state.window).copy()
    way = state.displacement - gap
    gap[0] += state.window.take(contact.initial_gap)
    begin = contact.law.traction(gap)
    end = begin + np.einsum("ijn,jn->in", contact.law.tangent(gap), way)
    return end, contact.grid.node_area * contact.grid.sum(0.5 * (begin + end) * way)
