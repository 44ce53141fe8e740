"""Modes of smallest real part of an operator that has a good preconditioner: the identity plus a
compact one, say."""

from itertools import zip_longest

import numpy as np

from ..continuation.bifurcations import NEUTRAL
from ..continuation.points import NotConverged
from ..grid.contours import first_largest
from .projection import Space, joined, lengths, projected, real

ACCURATE = 3e-4
"""Residual |J x - s x| / |x| to which the leading mode is found, up to twice that where |s| > 1/4;
its eigenvalue's error is smaller."""
DENSE, LARGEST_DENSE = 40, 1500
"""Unknowns up to which all eigenvalues are computed at once, and where the Krylov method fails."""
FALSE = 0.02
"""Residual of a mode over its negative eigenvalue that certifies it: J is not symmetric, and a
projection of it may have negative eigenvalues that J itself has not, with residuals of a quarter of
them."""
WARM, COLD = (4,), (12, 12)
"""Products of the sequences from noise that a search begins with, where modes of a point nearby are
known and where none are: two modes with nearly the same eigenvalue look like one to a single
sequence."""
STEPS = 120
NOISE = 0.3
MOST = 16
"""Most steps of a search, the noise over what its sequence begins with otherwise, and vectors of a
symmetry beyond which the projection begins anew from its modes."""


def leading_modes(operator, axes=(), start=(), accurate=ACCURATE, number=0, neutral=NEUTRAL):
    """Unstable modes (real part negative) and the first stable ones of J with preconditioner P:
    `Modes` of each symmetry.

    J's own modes are those of its projection on vectors that are split by symmetry: those to begin
    with; Krylov sequences, with a part of noise, of 1 - P^-1 (J - s), s the leading eigenvalue as
    far as it is known, an operator that has no large eigenvalues (Golub and Ye 2002, SIAM J. Sci.
    Comput. 24, 312); and one by one, until residuals say that the signs are certain and the leading
    one is accurate, P^-1 (J x - s x) of the modes x that do not do yet (Davidson's method, Morgan
    and Scott 1986, SIAM J. Sci. Stat. Comput. 7, 817).

    Parameters
    ----------
    operator : with ``size``, ``apply`` (J), ``precondition`` (P^-1) and ``mirror`` (vector,
        symmetry)
    axes : symmetries, second arguments of ``mirror``, under which J does not change
    start : list of vectors to begin with, each a sum of modes of a point nearby that differ in
        symmetry
    accurate : residual of the leading mode; None where signs alone are asked for
    number : of the last mode that is to be accurate, 0 for the leading one
    neutral : residual that will do for a mode whatever its sign

    Raises
    ------
    NotConverged : where residuals stay large
    """
    alone = getattr(operator, "shared", None) is None
    if alone and operator.size <= DENSE:
        return [_all_modes(operator)]
    space = Space(operator, axes)
    found = _searched(space, start, accurate, number, neutral)
    if found is not None:
        return found
    if alone and operator.size <= LARGEST_DENSE:
        return [_all_modes(operator)]
    modes = joined(space.modes())
    raise NotConverged("the modes of the point were not found: eigenvalue "
                       f"{modes.leading:.3g}, residual {modes.residuals[0]:.1g} after "
                       f"{STEPS} steps")


def _searched(space, start, accurate, number, neutral):
    """The modes of a space that grows by sequences and steps, None where residuals stay large;
    parameters as of `leading_modes`."""
    random, size = np.random.default_rng(1), space.operator.size
    wanted = accurate, number, neutral
    space.begin(start)
    for turn, count in enumerate(WARM if start else COLD):
        noise = random.standard_normal(size) if space.grid is None else space.operator.noise(turn)
        noise /= lengths(noise, space.grid)
        found = space.ritz() if start else []
        ahead = _ahead(space, found, wanted)
        shift = _shift(found, number) if start else 0.0
        _krylov(space, shift, noise if ahead is None else ahead + NOISE * noise, count)
    for _ in range(STEPS):
        found = space.ritz()
        if not _loose(found, wanted).any():
            modes = space.modes()
            if not _loose(modes, wanted).any():
                return modes
        ahead = _ahead(space, found, wanted)
        space.product(noise if ahead is None else ahead)
        if space.largest > MOST:
            space.begin(summed(space.modes()))
    return None


def oriented(vector, operator=None):
    """The real part of a mode, in the phase where it is largest, with the first value of about the
    largest size positive; of one that processes have parts of, by its operator.

    Phase and sign are left to rounding by what finds eigenvectors, and which way a branch is left
    hangs on them.
    """
    grid = getattr(operator, "shared", None)
    square = np.sum(vector ** 2)
    if grid is not None:
        square = grid.together(square.real) + 1j * grid.together(square.imag)
    real = (vector * np.exp(-0.5j * np.angle(square))).real
    first = real[first_largest(real)] if grid is None else operator.first_largest(real)
    return np.copysign(1.0, first) * real


def summed(found):
    """Sums of modes of different symmetries, which can be told apart again: so that one vector
    carries one of each."""
    return [sum(vectors) for vectors in zip_longest(*(real(part.vectors, part.grid)
                                                      for part in found),
                                                    fillvalue=0.0)]


def _ahead(space, found, wanted):
    """The step P^-1 (J x - s x) from the modes that are not good enough, of length 1, or None where
    there are none; parameters as of `_loose`."""
    by_symmetry = np.split(_loose(found, wanted), np.cumsum([len(part.values) for part in found]))
    defects = [space.defects(part, loose) for part, loose in zip(found, by_symmetry) if loose.any()]
    if not defects:
        return None
    step = space.operator.precondition(sum(defects))
    return step / lengths(step, space.grid)


def _krylov(space, shift, begin, count):
    """Have a space grow by a Krylov sequence of 1 - P^-1 (J - shift): by as many vectors, made
    orthonormal as they come, or fewer where these are no longer new."""
    vector = begin
    for _ in range(count):
        if not space.product(vector):
            return
        vector, image = space.newest()
        vector = vector - space.operator.precondition(image - shift * vector)


def _loose(found, wanted):
    """Which modes are not good enough, for the signs of all eigenvalues or for the leading ones.

    Parameters
    ----------
    found : `Modes` or `Ritz` of each symmetry; the answer has all one after the other
    wanted : accurate, number, neutral, as of `leading_modes`
    """
    if not found:
        return np.zeros(0, bool)
    values, residuals, certain = (np.concatenate([getattr(part, name) for part in found])
                                  for name in ("values", "residuals", "certain"))
    accurate, number, neutral = wanted
    share = np.where(values.real < 0.0, FALSE, 0.5)
    loose = certain & (residuals >= np.maximum(share * np.abs(values.real), neutral))
    if accurate is not None:
        first = np.argsort(values.real, kind="stable")[:number + 1]
        size = np.clip(4.0 * np.abs(values[first]), 1.0, 2.2)
        loose[first] |= residuals[first] > accurate * size
    return loose


def _shift(found, number):
    """The eigenvalue of a number, or 1/2 where that is smaller."""
    values = np.sort(np.concatenate([part.values.real for part in found]))
    return min(values[:number + 1][-1], 0.5)


def _all_modes(operator):
    """All modes by a dense matrix, whatever their symmetry; of the stable ones the first."""
    return projected(np.array([operator.apply(one) for one in np.eye(operator.size)]), 1)
