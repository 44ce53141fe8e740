"""Steps that stay on their branch: what tells a neighbour of the last point from a state that lies
beyond a jump."""

import math
import weakref
from typing import NamedTuple

import numpy as np

from ..kernels.laws import kernel_of
from ..kernels.sites import States
from ..kernels.structures import Limits
from .energies import weights
from .state import alike
from .states import REACH

STRAYS = 0.35
SHARE = 0.15
LONG = 10.0
"""How far a node may end from its prediction: ranges of the law, and the share of its way, up to a
long one, that adds to it."""
DOUBTFUL = 0.5
"""Part of that from which on the law is asked whether the step released energy."""
RELEASED = 0.05
"""Energy released on the way, over the work that linear springs would do, that few smooth steps
come up to."""
ABRUPT = 0.15
"""The same for a step that is too long to tell, whatever the tangent behind it says."""
PLACES = np.array([0.0, 1.0, *(0.5 + 0.5 * np.polynomial.legendre.leggauss(5)[0])])
SHARES = np.array([0.5, 0.5, *(-0.5 * np.polynomial.legendre.leggauss(5)[1])])
"""Places on the way, its ends first, and shares of what tractions do there in the work of linear
ones less their own, by a quadrature along it."""
TRIFLE = 1e-6
"""Traction, in units of the law, that counts as none."""
HELD = 1.0
OPEN = 3.0
WHOLE = 0.9
"""Normal gaps, in ranges, before the peak of the law and where it has softened; and the part of the
held nodes that is nearly all."""
PART = 2 ** 14
"""Nodes that are looked at at a time."""
LIMITS = Limits(STRAYS, SHARE, LONG, REACH, HELD, OPEN, DOUBTFUL, TRIFLE, len(PLACES),
                tuple(PLACES), tuple(SHARES))
"""All of this as the library takes it."""
LEFT = 0.5
"""Part of its way that a node goes back at the rate where it ended, below which a jump made much of
it; a parabola just behind its fold has one half."""


TOLD = weakref.WeakKeyDictionary()
"""State -> contact, guess and state before it, and the Ways that these make."""


class Ways(NamedTuple):
    """How a step lies to its prediction and to where it began, ranges of the law.

    Attributes
    ----------
    missed, moved : root mean square distances of where it ended from its prediction and from where
        it began, over the nodes where the law acts on either
    beyond, farthest : by how much a node ends farther from its prediction than is allowed; the
        largest way of a node where the law acts
    counts : numbers of nodes held at first and those of them that open, of nodes held at last and
        those of them that were open, of nodes in contact that pass through sticking
    releases : whether some of them may release more energy than few smooth steps do
    """

    missed: float
    moved: float
    beyond: float
    farthest: float
    counts: list
    releases: bool


def ways(contact, guess, last, found):
    """The Ways of a step; kept with the state where it ended, since more than one is asked of them.

    Parameters
    ----------
    contact : Contact
    guess : State, predicted from points of the branch
    last, found : State, equilibria
    """
    asked, made = TOLD.get(found, ((), None))
    if [one() for one in asked] == [contact, guess, last]:
        return made
    grid, nodes, known = alike(contact, [guess, found], [last])
    site, components, releases = contact.site(nodes), len(known[0]), True
    states = States(known) if site else known
    told = site.strays(states, LIMITS) if site else _by_numpy(
        *known, contact.gap_on(nodes), getattr(grid, "weights", None),
        contact.scene.contact_threshold, contact.law.slip_peak)
    beyond, farthest = grid.largest(told[:2]).tolist()
    *counts, near, missed, acting, moved = grid.together(told[2:]).tolist()
    if site:
        works = grid.together(site.releases(states, LIMITS, farthest)).tolist()
        releases = any([out > RELEASED * springs for out, springs in zip(*works)])
    made = Ways(math.sqrt(missed / max(components * near, 1.0)),
                math.sqrt(moved / max(components * acting, 1.0)), beyond, farthest, counts,
                releases)
    TOLD[found] = tuple(map(weakref.ref, (contact, guess, last))), made
    return made


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


def _by_numpy(foretold, ended, began, initial_gap, weights_of, threshold, peak):
    """How a step lies to its prediction, an array: farthest beyond what is allowed, and largest way
    where the law acts; nodes held at first and those of them that open, nodes held at last and
    those of them that were open; nodes in contact that pass through sticking; nodes where the law
    acts at the end or was foretold to, and squares of how far these ended from there; nodes where
    it acts at either end, and squares of the way of these.

    Nearly all of a contact that is made or lost, and a whole contact that slides back, ends where
    it is predicted, on the other side of all that friction does to it.

    Parameters
    ----------
    foretold, ended, began : arrays (components, nodes), ranges of the law
    initial_gap, weights_of : arrays (nodes,); weights None where all are one
    threshold, peak : gap of contact, and slip of the law's peak
    """
    change, aside, near, allowed = _ways(foretold, ended, began, initial_gap)
    first, last = began[0] + initial_gap, ended[0] + initial_gap
    touching = np.maximum(first, last) < threshold
    through = touching & _through_sticking(began[1:], ended[1:], peak)
    each = np.ones(len(near)) if weights_of is None else weights_of
    masks = np.array([first < HELD, (first < HELD) & (last > OPEN), last < HELD,
                      (last < HELD) & (first > OPEN), through])
    around = np.minimum(foretold[0], ended[0]) + initial_gap < REACH
    squares = [np.sum(aside * aside, axis=0), np.sum(change * change, axis=0) * near]
    return np.concatenate([[np.max(aside - allowed, initial=-STRAYS),
                            np.max(np.abs(change) * near, initial=0.0)], masks @ each,
                           *([mask @ each, square @ each]
                             for mask, square in zip((around, near), squares))])


def _ways(foretold, ended, began, initial_gap):
    """Ways of a step, how far it ended from its prediction where the law acts, (components, nodes)
    each, where the law acts on the way (nodes), and how far nodes may end from a prediction."""
    change, aside = ended - began, ended - foretold
    np.abs(aside, out=aside)
    aside *= np.minimum(foretold[0], ended[0]) + initial_gap < REACH
    allowed = np.abs(change)
    np.minimum(allowed, LONG, out=allowed)
    allowed *= SHARE
    allowed += STRAYS
    return change, aside, np.minimum(began[0], ended[0]) + initial_gap < REACH, allowed


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
    change, aside, _, allowed = _ways(foretold, ended, began, contact.gap_on(nodes))
    allowed *= DOUBTFUL
    gap = began.copy()
    gap[0] += contact.gap_on(nodes)
    return grid, gap, change, np.any(aside > allowed, axis=0)


def _through_sticking(begin, end, peak):
    """Nodes that slide at the begin and the end of a straight way of their slip (components,
    nodes), but stick in between: below the ``peak`` of the friction.

    A whole contact that slides back ends where it is predicted, on the other side of all that
    friction does to it.
    """
    change = end - begin
    part = np.clip(-np.sum(begin * change, axis=0) / np.maximum(np.sum(change * change, axis=0),
                                                                1e-300), 0.0, 1.0)
    begins, ends, least = (np.linalg.norm(slip, axis=0)
                           for slip in (begin, end, begin + part * change))
    return (begins > peak) & (ends > peak) & (least < peak)


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
