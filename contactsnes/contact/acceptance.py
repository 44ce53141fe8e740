"""Steps that stay on their branch: what tells a neighbour of the last point from a state that lies
beyond a jump."""

import numpy as np

from ..kernels.laws import kernel_of
from .energies import weights
from .state import alike
from .states import REACH
from .ways import DOUBTFUL, PLACES, RELEASED, SHARES, TRIFLE, by_node, taken, ways

WHOLE = 0.9
"""Part of the held nodes that is nearly all."""
OFF, OFF_ITS_WAY = 0.2, 0.4
"""How far a node may end off its prediction before a short jump may be the reason: ranges of the
law, and part of the farthest way of a node in the step."""
ABRUPT = 0.15
"""What `RELEASED` is for a step that is too long to tell, whatever the tangent behind it says."""
CROSSED = 1.0
"""Way of a node, ranges of the law, from which on it may have crossed what holds it."""
LOST = 0.02
"""What those nodes release that release energy, over what linear springs do, from which on a step
that is otherwise without fault is doubted: steps that passed a jump by which a pocket of a contact
closes had 0.027 to 0.1 of it."""
PART = 2 ** 14
"""Nodes that are looked at at a time."""
LEFT = 0.5
"""Part of its way that a node goes back at the rate where it ended, below which a jump made much of
it; a parabola just behind its fold has one half."""


def strayed(contact, guess, last, found):
    """By how much a node ends farther from its prediction than a step of a smooth branch leaves
    open, ranges of the law.

    Negative where all nodes are where the guess has them. Over the nodes where the law acts: a spot
    that jumps among many moves a few of them only, and a body that slides moves all of them, so
    that neither a mean nor the whole way tells of a jump.

    Parameters
    ----------
    contact : Contact
    guess : State, predicted from points of the branch
    last, found : State, equilibria
    """
    told = ways(contact, guess, last, found)
    held, opened, made, closed, through = told.counts
    # A body that is rigid beside its law comes off as a whole: its tangent foretells where it is
    # then, whatever happens on the way.
    if opened > WHOLE * max(held, 1.0) or closed > WHOLE * max(made, 1.0) or through:
        return np.inf
    return told.beyond


def adrift(contact, guess, last, found):
    """Whether a node ends off its prediction by a large part of the farthest way of the step: a
    short jump releases hardly any energy.

    Parameters
    ----------
    contact, guess, last, found : as of `strayed`
    """
    told = ways(contact, guess, last, found)
    return told.aside > max(OFF, OFF_ITS_WAY * told.farthest)


def doubtful(contact, guess, last, found):
    """Whether nodes release so much energy on the way that a jump may be a part of it
    (``_suspects``).

    Parameters
    ----------
    contact : Contact
    guess, last, found : as of `strayed`
    """
    if not ways(contact, guess, last, found).releases:
        return False
    return _suspects(contact, *_compared(contact, guess, last, found)) is not None


def detached(contact, guess, last, found, back):
    """Whether the branch where a step ended hardly leads back to where it began, for the nodes that
    are doubtful.

    Parameters
    ----------
    contact : Contact
    guess, last, found : State, predicted, where the step began, and where it ended
    back : State, predicted by the tangent at ``found`` for where ``last`` is
    """
    nodes, released = _suspects(contact, *_compared(contact, guess, last, found, back))
    grid, _, (_, ended, began, returned) = alike(contact, [guess, found], [last, back])
    change = (ended - began) * nodes
    return released > ABRUPT or (np.sum(grid.sum((ended - returned) * change))
                                 < LEFT * np.sum(grid.sum(change * change)))


def leapt(contact, last, found):
    """Whether nodes that crossed the law released so much on the way to a state that a jump may be
    a part of it, though predictions have them where they ended.

    As where the last pocket of a contact closes: nodes come to where all others are, whatever was
    foretold. What others take up on the same way does not count, so that jumps are seen whose end
    is far from them.

    Parameters
    ----------
    contact : Contact
    last, found : State, equilibria
    """
    if taken(contact, last, found).farthest < CROSSED:
        return False
    grid, gap, change, _ = _compared(contact, last, last, found)
    works = np.zeros(2)
    for part, each in _parts(grid, np.minimum(gap[0], gap[0] + change[0]) < REACH):
        done = _works(contact, gap[:, part], change[:, part])
        np.maximum(done[0], 0.0, out=done[0])
        works += np.sum(done * each, axis=1)
    released, springs = grid.together(works)
    return bool(released > LOST * springs)


def _suspects(contact, grid, gap, change, aside):
    """Mask of the nodes that release more energy than smooth steps do, and that over what linear
    springs do: of those aside of their prediction, or of all; None where none do.

    A prediction next to a fold, where the branch turns ever faster, may by chance lead to what lies
    beyond the jump.
    """
    near = np.minimum(gap[0], gap[0] + change[0]) < REACH
    moved = np.abs(change).max(axis=0) * near
    # What snaps may be a small part of a contact, whose other nodes hide what it releases.
    sets = np.array([aside, near, moved > 0.5 * grid.maximum(moved, initial=0.0)])
    del moved
    works = np.zeros((len(sets), 2))
    for part, each in _parts(grid, near | aside):
        works += sets[:, part] @ (_works(contact, gap[:, part], change[:, part]) * each).T
    for nodes, (released, springs) in zip(sets, grid.together(works)):
        if released > RELEASED * springs and _soften(contact, grid, gap, change, nodes):
            return nodes, released / springs
    return None


def _parts(grid, mask):
    """Numbers of nodes of a mask, and what each of these counts, a few at a time: on many nodes
    what is made of them takes memory."""
    weights_of = getattr(grid, "weights", None)
    for first in range(0, len(mask), PART):
        part = first + np.flatnonzero(mask[first:first + PART])
        yield part, 1.0 if weights_of is None else weights_of[part]


def _compared(contact, guess, last, found, *others):
    """Grid that sums over nodes, gaps before a step, their changes, and a mask of the nodes that
    are doubtfully far from the guess where the law acts; of even states (``others``, too) at half
    of the nodes."""
    grid, nodes, (foretold, ended, began, *_) = alike(contact, [guess, found], [last, *others])
    change, aside, _, allowed = by_node(foretold, ended, began, contact.gap_on(nodes))
    allowed *= DOUBTFUL
    gap = began.copy()
    gap[0] += contact.gap_on(nodes)
    return grid, gap, change, np.any(aside > allowed, axis=0)


def _works(contact, gap, change):
    """What each node releases on the straight way from one equilibrium to the next, and what linear
    springs do there, array (2, nodes).

    The body balances the law's tractions at both ends and linearly in between; what the law does
    beyond that is of third order in the step on a smooth branch, but the energy that a jump
    dissipates where its barrier, a softening law, is crossed.
    """
    kernel = kernel_of(contact.law)
    if kernel is not None:
        return kernel.works(gap, change, weights(contact, len(change)), (PLACES, SHARES, TRIFLE))
    way = gap[:, None] + PLACES[:, None] * change[:, None]
    tractions = contact.law.traction(way.reshape(len(gap), -1)).reshape(way.shape)
    weighted = weights(contact, len(change))[:, None] * change
    # Where a body slides freely tractions change by rounding.
    springs = np.maximum(np.abs(tractions[:, 1] - tractions[:, 0]), TRIFLE) * np.abs(weighted)
    return np.array([np.sum(SHARES @ tractions * weighted, axis=0), np.sum(springs, axis=0)])


def _soften(contact, grid, gap, change, nodes):
    """Whether the law of some nodes together softens somewhere on their straight way.

    Parameters
    ----------
    contact : Contact
    grid : Grid of the nodes
    gap, change : arrays (components, nodes), ranges of the law
    nodes : mask
    """
    share = weights(contact, len(change))[:, None]
    for place in PLACES[2:]:
        density = 0.0
        for part, each in _parts(grid, nodes):
            way = change[:, part]
            softening = np.einsum("ijn,jn->in", contact.law.tangent(gap[:, part] + place * way),
                                  way)
            density += np.sum(softening * way * share * each)
        if grid.together(density) < 0.0:
            return True
    return False
