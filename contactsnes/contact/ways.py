"""How a step lies to its prediction and to where it began, node by node and over all of them."""

import math
import weakref
from typing import NamedTuple

import numpy as np

from ..kernels.sites import States
from ..kernels.structures import Limits
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
PLACES = np.array([0.0, 1.0, *(0.5 + 0.5 * np.polynomial.legendre.leggauss(5)[0])])
SHARES = np.array([0.5, 0.5, *(-0.5 * np.polynomial.legendre.leggauss(5)[1])])
"""Places on the way, its ends first, and shares of what tractions do there in the work of linear
ones less their own, by a quadrature along it."""
TRIFLE = 1e-6
"""Traction, in units of the law, that counts as none."""
HELD = 1.0
OPEN = 3.0
"""Normal gaps, in ranges, before the peak of the law and where it has softened."""
LIMITS = Limits(STRAYS, SHARE, LONG, REACH, HELD, OPEN, DOUBTFUL, TRIFLE, len(PLACES),
                tuple(PLACES), tuple(SHARES))
"""All of this as the library takes it."""

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

    @property
    def aside(self):
        """How far a node may have ended from its prediction, by what is allowed to the one that
        moved farthest."""
        return self.beyond + STRAYS + SHARE * min(self.farthest, LONG)


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


def taken(contact, last, found):
    """The Ways of a step, to whatever prediction: those that are kept, else those to where it
    began.

    Parameters
    ----------
    contact, last, found : as of `ways`
    """
    asked, made = TOLD.get(found, ((), None))
    kept = [one() for one in asked[::2]] == [contact, last]
    return made if kept else ways(contact, last, last, found)


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
    change, aside, near, allowed = by_node(foretold, ended, began, initial_gap)
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


def by_node(foretold, ended, began, initial_gap):
    """Ways of a step, how far it ended from its prediction where the law acts, (components, nodes)
    each, where the law acts on the way (nodes), and how far nodes may end from a prediction.

    Parameters
    ----------
    foretold, ended, began : arrays (components, nodes), ranges of the law
    initial_gap : array (nodes,)
    """
    change, aside = ended - began, ended - foretold
    np.abs(aside, out=aside)
    aside *= np.minimum(foretold[0], ended[0]) + initial_gap < REACH
    allowed = np.abs(change)
    np.minimum(allowed, LONG, out=allowed)
    allowed *= SHARE
    allowed += STRAYS
    return change, aside, np.minimum(began[0], ended[0]) + initial_gap < REACH, allowed


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
