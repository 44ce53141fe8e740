"""Steps that stay on their branch: what tells a neighbour of the last point from a state that lies beyond a jump."""

import numpy as np

from .energies import weights
from .laws import SLIP
from .states import onto, way

STRAYS, SHARE, LONG = 0.35, 0.15, 10.0
"""How far a node may end from its prediction: ranges of the law, and the share of its way, up to a long one, that adds to it."""
DOUBTFUL = 0.5
"""Part of that from which on the law is asked whether the step released energy."""
RELEASED = 0.05
"""Energy released on the way, over the work that linear springs would do, that few smooth steps come up to."""
LEFT = 1.0 / 3.0
"""Part of its way that a node goes back at the rate where it ended, below which a jump made most of it; one half behind a fold."""


def strayed(contact, guess, last, found):
    """By how much a node ends farther from its prediction than a step of a smooth branch leaves open, ranges of the law.

    Negative where all nodes are where the guess has them. Over the nodes where the law acts: a spot that jumps among many moves
    a few of them only, and a body that slides moves all of them, so that neither a mean nor the whole way tells of a jump.

    Parameters
    ----------
    contact : Contact
    guess : State, predicted from points of the branch
    last, found : State, equilibria
    """
    gap, change, aside, allowed = _compared(contact, guess, last, found)
    touching = np.maximum(gap[0], gap[0] + change[0]) < contact.scene.contact_threshold
    if contact.grid.count(touching & _through_sticking(gap[1:], gap[1:] + change[1:])):
        return np.inf
    return float(contact.grid.maximum(aside - allowed, initial=-STRAYS))


def doubtful(contact, guess, last, found):
    """Whether nodes that end aside of their prediction release so much energy on the way that a jump may be a part of it."""
    gap, change, aside, allowed = _compared(contact, guess, last, found)
    nodes = np.any(aside > DOUBTFUL * allowed, axis=0)
    return contact.grid.count(nodes) > 0 and _released(contact, gap[:, nodes], change[:, nodes]) > RELEASED


def detached(contact, guess, last, found, back):
    """Whether the branch where a step ended hardly leads back to where it began, for the nodes that are doubtful.

    Parameters
    ----------
    back : State, predicted by the tangent at ``found`` for where ``last`` is
    """
    _, change, aside, allowed = _compared(contact, guess, last, found)
    nodes = np.any(aside > DOUBTFUL * allowed, axis=0)
    window, inner = max(guess.window, found.window, key=lambda window: window.size), contact.grid.inner
    change, returned = change[:, nodes], (onto(found, window) - onto(back, window))[:, nodes]
    return inner(returned, change) < LEFT * inner(change, change)


def _compared(contact, guess, last, found):
    """Gaps before a step, their changes, how far they are from the guess where the law acts, and how far they may be."""
    window = max(guess.window, found.window, key=lambda window: window.size)
    aside, near = way(contact, guess, found, window)
    gap, change = onto(last, window).copy(), onto(found, window) - onto(last, window)
    gap[0] += window.take(contact.initial_gap)
    return gap, change, np.abs(aside) * near, STRAYS + SHARE * np.minimum(np.abs(change), LONG)


def _through_sticking(begin, end):
    """Nodes that slide at the begin and the end of a straight way of their slip (components, nodes), but stick in between.

    A whole contact that slides back ends where it is predicted, on the other side of all that friction does to it.
    """
    change = end - begin
    part = np.clip(-np.sum(begin * change, axis=0) / np.maximum(np.sum(change * change, axis=0), 1e-300), 0.0, 1.0)
    begins, ends, least = (np.linalg.norm(slip, axis=0) for slip in (begin, end, begin + part * change))
    return (begins > SLIP) & (ends > SLIP) & (least < SLIP)


def _released(contact, gap, change):
    """Energy that nodes release on the straight way from one equilibrium to the next, over what linear springs do there.

    The body balances the law's tractions at both ends and linearly in between; what the law does beyond that is of third order
    in the step on a smooth branch, but the energy that a jump dissipates where its barrier, a softening law, is crossed.
    Negative where energy is taken up or nothing softens.
    """
    first, last = contact.law.traction(gap), contact.law.traction(gap + change)
    inner, weighted = contact.grid.inner, weights(contact, len(change))[:, None] * change
    work, softest = 0.0, np.inf
    for place, share in zip(*np.polynomial.legendre.leggauss(5)):
        part = 0.5 * (1.0 + place)
        between = gap + part * change
        work += 0.5 * share * inner(contact.law.traction(between) - first - part * (last - first), weighted)
        softest = min(softest, inner(np.einsum("ijn,jn->in", contact.law.tangent(between), change), weighted))
    springs = inner(np.abs(last - first), np.abs(weighted))
    return -work / max(springs, 1e-300) if softest < 0.0 else -np.inf
