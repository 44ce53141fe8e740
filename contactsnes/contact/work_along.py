"""Work of forces along a curve that some of its points tell of."""

from functools import cache

import numpy as np

from ..kernels import points

MOST = 4
"""Points that tell of a curve, at most."""
TWINS = 1e-4
"""Part of a step below which points are too near to each other to tell of a slope: what solves
leave of their balances would make one."""
REACH = 0.3
"""Extent of a force over that of its displacement, at most, in the second length that is tried:
where a force that rises many times over counts for all, displacements swing between points."""
SURER = 0.5
"""Part of the first length's doubt below which the second one is taken."""
LIMITS = np.array([TWINS, REACH, SURER])


@cache
def gauss(count):
    """Gauss and Legendre's rule of so many points: places in -1 to 1, and their shares."""
    return np.polynomial.legendre.leggauss(count)


@cache
def rules():
    """Those of two points on, the places of each before its shares."""
    return np.concatenate([part for count in range(2, MOST + 1) for part in gauss(count)])


def path_work(displacements, forces, give, weights, first, compiled):
    """Work of forces over displacements from point number ``first`` of a path to its last one:
    `line_work` of the points that are `apart`, as far as it can be ``held``, by the less doubtful
    of two lengths, that of all forces and one in which they are `reaching` less far.

    Parameters
    ----------
    displacements, forces, give, weights, first : as of `line_work`
    compiled : bool, whether the library is asked
    """
    if compiled:
        return points.path_work(displacements, forces, give, weights, first, LIMITS, rules())
    kept, first = apart(displacements, forces, give, first)
    along = displacements[kept], forces[kept]
    work, doubt = doubted(*along, give, weights, first)
    less = reaching(*along, give)
    if 2 < len(kept) == len(apart(*along, less, first)[0]):
        other, its = doubted(*along, less, weights, first)
        work = other if its < SURER * doubt else work
    return held(work, *along, weights, first)


def reaching(displacements, forces, give):
    """How much gives way to each force, or less, so that none reaches further than `REACH` of its
    displacement.

    Parameters
    ----------
    displacements, forces, give : as of `line_work`
    """
    moved, pushed = np.ptp(displacements, axis=0), np.ptp(forces, axis=0)
    return np.where(pushed * give > REACH * moved, REACH * moved / np.maximum(pushed, 1e-300), give)


def doubted(displacements, forces, give, weights, first):
    """(work, doubt) of `line_work`: what it changes by without one of its points.

    Parameters
    ----------
    displacements, forces, give, weights, first : as of `line_work`
    """
    count, left = len(displacements), int(first == 0)
    work = line_work(displacements, forces, give, weights, first, gauss(count))
    if count == 2:
        return work, 0.0
    some = np.arange(count) != left
    return work, abs(work - line_work(displacements[some], forces[some], give, weights,
                                      max(first - 1, 0), gauss(count - 1)))


def line_rule(places, first, rule):
    """Arrays with which the sum of (values @ basis) (along @ slopes) is the integral of values
    d(along) from place number ``first`` to the last, by polynomials through all places.

    These are Lagrange's polynomials, and their slopes times shares, at the points of Gauss and
    Legendre's rule of as many points, which is exact for them. (The sums come first: next to each
    other places make large numbers that cancel.)

    Parameters
    ----------
    places : array, distances along a path
    first : number of the place from which on
    rule : (places, shares) of Gauss and Legendre's of as many points
    """
    abscissas, shares = rule
    half, places = 0.5 * (places[-1] - places[first]), [float(place) for place in places]
    along, basis, slopes = (places[first] + half * (1.0 + abscissas)).tolist(), [], []
    # (few numbers: floats are faster than arrays)
    for j, own in enumerate(places):
        others = [(other, 1.0 / (own - other)) for i, other in enumerate(places) if i != j]
        for point in along:
            value, slope = 1.0, 0.0
            for other, scale in others:
                apart = point - other
                value, slope = value * apart * scale, (slope * apart + value) * scale
            basis.append(value)
            slopes.append(slope)
    basis, slopes = np.array([basis, slopes]).reshape(2, len(places), -1)
    return basis, half * shares * slopes


def line_work(displacements, forces, give, weights, first, rule):
    """Work of forces over displacements from point number ``first`` of a path to its last one, by
    polynomials through all of its points.

    These are of the chord length along the points, in which a force counts by how much gives way
    to it.

    Parameters
    ----------
    displacements, forces : arrays (points, components)
    give, weights : arrays (components,); the second of what each does in a common unit
    first : int
    rule : (places, shares) of Gauss and Legendre's of as many points
    """
    along = np.concatenate([displacements, give * forces], axis=1)
    places = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(along, axis=0), axis=1)))
    basis, slopes = line_rule(places, first, rule)
    return np.vdot(weights[:, None] * (forces.T @ basis), displacements.T @ slopes)


def apart(displacements, forces, give, first):
    """(numbers of points, place of ``first`` among them): without those that are `TWINS` of others
    beside the way from point number ``first`` of a path to its last one.

    Parameters
    ----------
    displacements, forces, give : as of `line_work`
    first : int, which stays, as the last one does
    """
    along = np.concatenate([displacements, give * forces], axis=1)
    between, last = along[:, None] - along, len(along) - 1
    squares = np.einsum("ijk,ijk->ij", between, between)
    least, kept = TWINS ** 2 * squares[first, last], [first, last]
    squares.flat[::last + 2] = np.inf
    if squares.min() > least:
        return list(range(last + 1)), first
    for number in range(last - 1, -1, -1):
        if number != first and squares[number, kept].min() > least:
            kept.append(number)
    kept.sort()
    return kept, kept.index(first)


def held(work, displacements, forces, weights, first):
    """A work by `line_work`, or that of the chords between the points where it is none that forces
    between their values could do.

    Polynomials by chord length swing where a step is many times as long as those before it: where
    a load falls steeply, or fades. Forces that rise or fall from point to point leave less doubt
    than half of their changes, over the displacements. (The change before counts as well: at an
    extremum in the middle of a step the forces at its ends are equal.)

    Parameters
    ----------
    work : float
    displacements, forces, weights, first : as of `line_work`
    """
    steps = np.diff(displacements[first:], axis=0)
    chords = np.sum(0.5 * (forces[first:-1] + forces[first + 1:]) * steps, axis=0)
    changes = np.abs(np.diff(forces[max(first - 1, 0):], axis=0)).max(axis=0)
    doubt = 0.5 * changes * np.abs(steps).sum(axis=0)
    return work if abs(work - weights @ chords) <= weights @ doubt else float(weights @ chords)
