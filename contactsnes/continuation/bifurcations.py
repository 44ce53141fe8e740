"""Bifurcations of a branch: places of a leg where an eigenvalue crosses zero though the load has no
limit there, and what follows."""

import math
from collections import Counter
from dataclasses import replace

from . import beside_folds
from .points import NotConverged
from .predictors.predictor import moved_on, through

NEUTRAL = 1e-5
"""Real part up to which a mode counts as neutral, neither stable nor unstable: a pattern on a flat
may be anywhere."""

PRECISION = 2e-9
"""Relative accuracy in the load to which a bifurcation is located."""
SAME = 3e-7
"""Eigenvalue of a mode at a bifurcation up to which it is that one's, too: rounding makes up to
1e-7 of modes that vanish at once."""
MISSED = 0.5
"""Part of a step that a solve within it may end from its prediction."""
NEAR = 0.1
"""Part of what is known of a branch within which a polynomial foretells best: following edges has
an error of the grid's, which next to a vanishing eigenvalue leads off the branch."""
VANISHED = 1e-3
"""Part of its values at the ends of a step below which an eigenvalue is zero at a root, and does
not jump through it."""
SINGLED = 1e-3
"""Part of a first step beyond which one is not taken where modes change and none of them can be
followed to zero: two at once may be a fold that was passed."""
PARTED = 0.01
"""Part of a step by which states are apart on either side of a place if they lie on two
branches."""


class Apart(NotConverged):
    """Two points are of two branches: between them states jump, and eigenvalues with them."""


class Neutral(NotConverged):
    """A mode that counts at one point and is neutral at the other, with the same sign: it crosses
    zero elsewhere, if at all."""


def examined(system, certify, leg, last, point):
    """A point with its certificate, and the bifurcations on the way to it; NotConverged for one of
    another branch.

    Parameters
    ----------
    system, leg : as of `between`
    certify : function (Point) -> Point, which need not say anything of stability
    last : (position, Point) of the leg, before the point
    point : Point
    """
    point = point if point.stable >= 0 else certify(point)
    if math.isnan(point.softest):
        point = point.changed(softest=last[1].softest)
    begun = last[1]
    if begun.stable < 0 <= point.stable or (
            begun.unstable_modes > 0 < point.unstable_modes
            and not (begun.unstable_parities or begun.event)):  # one of an archive
        last = last[0], certify(begun)
    point = _counted(certify, last[1], point)
    if system.examiner and point.stable < 0 and point.softest < 0.0 and not last[1].softest < 0.0:
        unstable = _doubt(system, leg, last, point)
        if unstable > 0:
            point = point.changed(stable=0, unstable_modes=unstable)
        elif unstable == 0:
            point = point.changed(softest=0.0)  # the next point is asked, too
    return point, between(system, certify, leg, last, (point.position, point))


def _counted(stability, before, point):
    """A point with its neutral mode among the unstable ones if that was stable at the point
    ``before`` and is below zero: a step as short as that may have gone over a fold, to another
    branch next to a nearly broken bifurcation."""
    if (before.stable != 1 or point.stable or point.unstable_modes or point.event == "fold"
            or stability.critical(point, 0)[0] >= -SAME):
        return point
    return point.changed(unstable_modes=1)


def crossed(system, certify, first, last):
    """Whether no odd number of modes loses its stability from one side of a fold to the other: the
    points are of two branches.

    Parameters
    ----------
    system, certify : as of `examined`
    first, last : points before and beyond the fold; one that is a fold itself tells nothing
    """
    if "fold" in (first.event, last.event):
        return False
    counts = [(point if point.unstable_modes >= 0
               else (system.examiner or certify)(point)).unstable_modes for point in (first, last)]
    return min(counts) >= 0 and (counts[1] - counts[0]) % 2 == 0


def _doubt(system, leg, last, point):
    """How many modes of a point are unstable; say where a branch loses its stability that is not
    certified; NotConverged where the point is another branch's."""
    def place(position):
        return system.told(leg.controls, leg.load(position))

    before = system.examiner(last[1])
    after = _counted(system.examiner, before, system.examiner(point))
    change = after.unstable_modes - before.unstable_modes
    passed = between(system, system.examiner, leg, (last[0], before), (point.position, after))
    if min(before.unstable_modes, after.unstable_modes) > 0:
        system.log(f"the branch is not stable at {place(last[0])}: a fold "
                   "or a bifurcation was passed before; -continuation_stability "
                   "certifies points")
    if min(before.unstable_modes, after.unstable_modes) == 0 and change % 2 == 0 and change:
        system.log(f"{abs(change)} modes of the branch change their sign between {place(last[0])} "
                   f"and {place(point.position)}: -continuation_stability certifies its points")
        passed = []
    for critical in passed:
        system.log(f"a bifurcation at {place(critical.position)} is passed, and "
                   "points beyond are not stable: -continuation_stability "
                   "certifies them, -continuation_at_bifurcation follow goes on beside")
    return after.unstable_modes


def between(system, stability, leg, before, after):
    """Points with event ``bifurcation`` where unstable modes change between neighbours, in order.

    None where it is not known, nor where a mode of a free body fades (`_fades`). Each by a
    bracketed root of its eigenvalue (Brent's method) along the branch, which is solved for in
    between. NotConverged where that fails and the neighbours lie on two branches, as an odd number
    away from folds and bifurcations tells, or a jump of the state; or may (`SINGLED`).

    Parameters
    ----------
    system, stability, leg : System, Stability (`system.Stability`), Leg
    before, after : (position, Point)
    """
    after = beside_folds.reached(system, stability, leg, before, after)
    fewer, more = sorted((before[1].unstable_modes, after[1].unstable_modes))
    found, long = [], abs(after[0] - before[0]) > SINGLED * leg.initial
    if fewer < 0:
        return found
    _refuse_exchange(system, leg, before, after, long)
    if before[1].event == "bifurcation" and fewer < more:
        # A path that goes on from an archive: one of the modes that change is that of its last
        # point.
        found, fewer = [stability.critical(before[1], fewer)[1]], fewer + 1
    for index in range(fewer + beside_folds.own_modes(before[1], after[1]), more):
        sentence = _not_located(system, leg, before, after)
        try:
            if (any(_vanishes(stability, point, index) for point in found)
                    or any(_fades(stability, point, index) for _, point in (before, after))):
                continue
            point = _root(system, stability, leg, [before, after], index)
        except NotConverged as error:
            if _parts(error, before[1], after[1]) or long and not isinstance(error, Neutral):
                raise NotConverged(f"{sentence}: {error}") from None
            system.log(f"{sentence}: {error}")
            continue
        if point is None:
            system.log(f"{sentence}: an eigenvalue jumps through zero")
            continue
        found.append(point)
    return sorted(found, key=lambda point: abs(point.position - before[0]))


def _vanishes(stability, point, index):
    """Whether an eigenvalue vanishes at a bifurcation, too: that of another of several modes that
    change at once, or the other one of a complex pair."""
    try:
        return abs(stability.critical(point, index)[0]) <= SAME
    except NotConverged:
        return False


def _parts(error, first, last):
    """Whether two points are of two branches if no eigenvalue between them vanishes, for a
    reason."""
    changed = first.unstable_modes - last.unstable_modes
    return isinstance(error, Apart) or bool(changed % 2 and not isinstance(error, Neutral))


def _exchanged(one, other):
    """Whether more modes change from one point to another than their number tells: of one mirror
    symmetry some become unstable, of another one stable."""
    each = [Counter(point.unstable_parities) for point in (one, other)]
    known = all(of.total() == point.unstable_modes and not any(0 in parity for parity in of)
                for of, point in zip(each, (one, other)))
    return known and bool(each[0] - each[1] and each[1] - each[0])


def _refuse_exchange(system, leg, before, after, long):
    """NotConverged where modes of two symmetries change in a long step, which may have gone over a
    fold; a short one is told."""
    if not _exchanged(before[1], after[1]):
        return
    sentence = ("modes of one symmetry lose their stability, and others regain it, "
                f"{_told_between(system, leg, before, after)}")
    if long:
        raise NotConverged(sentence)
    system.log(sentence)


def _not_located(system, leg, before, after):
    """The begin of a sentence on a change of unstable modes without a bifurcation."""
    return (f"unstable modes change from {before[1].unstable_modes} to {after[1].unstable_modes} "
            f"{_told_between(system, leg, before, after)}, but no bifurcation was located there")


def _told_between(system, leg, before, after):
    """Where something is between two (position, Point), in words."""
    first, last = (system.told(leg.controls, leg.load(position)) for position, _ in (before, after))
    return f"between {first} and {last}"


def _fades(stability, point, index):
    """Whether a mode is neutral since forces move a body that the law no longer holds: off the
    flat, or sliding.

    As the law fades its eigenvalue goes to zero, which it does not cross.
    """
    free = (not point.in_contact and point.controls[0] == "force" or point.sliding
            and "force" in point.controls[1:])
    return free and abs(stability.critical(point, index)[0]) <= NEUTRAL


def _precision(leg, position):
    """That of the position at a place."""
    reached, way = leg.load(position)[leg.moving], leg.direction[leg.moving]
    return PRECISION * max(abs(reached), 1e-3 * abs(way)) / abs(way)


def _root(system, stability, leg, ends, index):
    """The point where an eigenvalue vanishes, None where it jumps and the state does not;
    NotConverged where a solve leaves the branch."""
    known, values = dict(ends), {}
    far = system.missed(ends[0][1].state, ends[1][1].state)

    def value(position):
        if position not in known:
            known[position] = solved(system, leg, known, position, far)
        if position not in values:  # found anew, an eigenvalue near zero might have another sign
            values[position], known[position] = stability.critical(known[position], index)
        return values[position]

    first, last = (value(position) for position, _ in ends)
    if first * last > 0.0:
        kind = Neutral if min(abs(first), abs(last)) <= NEUTRAL else NotConverged
        raise kind(f"the eigenvalue is {first:.2g} and {last:.2g} there")
    precision = min(_precision(leg, position) for position, _ in ends)
    from scipy.optimize import brentq  # needed here only, and slow to import

    place = brentq(value, ends[0][0], ends[1][0], xtol=precision, maxiter=60)
    value(place)
    if abs(values[place]) > VANISHED * max(abs(first), abs(last)):
        if _apart(system, known, values) > PARTED * far:
            raise Apart("an eigenvalue jumps through zero, and the state with it")
        return None
    # A bifurcation next to a fold, whose copy this may be, is none.
    return replace(known[place], position=place, leg=leg.number, step=leg.initial,
                   event="bifurcation", fold_kind="", fold_precision=0.0, tangents=(), stable=0,
                   unstable_modes=index)


def _apart(system, known, values):
    """How far states are apart where an eigenvalue changes its sign, at the nearest places with
    either: little at a corner."""
    places = sorted(values)
    changes = [pair for pair in zip(places, places[1:]) if values[pair[0]] * values[pair[1]] < 0.0]
    below, above = min(changes, key=lambda pair: pair[1] - pair[0])
    return system.missed(known[below].state, known[above].state)


def solved(system, leg, known, position, far):
    """The point at a position between two known ones; the nearest one beyond them helps to foretell
    it. NotConverged where it is off the branch.

    Parameters
    ----------
    system, leg : as of `between`
    known : position -> Point
    position : float
    far : how far the step leads in which it lies, ranges of the law
    """
    nodes = sorted(sorted(known, key=lambda place: abs(place - position))[:3])
    near = min(abs(node - position) for node in nodes) < NEAR * (max(known) - min(known))
    foretold = through if near else moved_on
    guess = foretold(system, [known[place] for place in nodes], nodes, position)
    point = system.solve(guess, leg.controls, leg.load(position))
    if system.missed(guess, point.state) > MISSED * far:
        raise NotConverged("a solve in between left the branch")
    return point
