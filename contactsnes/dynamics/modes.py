"""Modes of smallest real part of an operator that has a good preconditioner: the identity plus a
compact one, say."""

from functools import lru_cache
from itertools import zip_longest

import numpy as np

from ..continuation.bifurcations import NEUTRAL
from ..continuation.points import NotConverged
from ..grid.contours import first_largest
from .holding import lengths
from .projection import Space, joined, projected

ACCURATE = 3e-4
"""Residual |J x - s x| / |x| to which the leading mode is found, up to twice that where |s| > 1/4;
its eigenvalue's error is mostly far smaller, but J is not symmetric: up to twice as large."""
DENSE, LARGEST_DENSE = 40, 1500
"""Unknowns up to which all eigenvalues are computed at once, and where the Krylov method fails."""
FALSE = 0.02
"""Residual of a mode over its negative eigenvalue that certifies it: J is not symmetric, and a
projection of it may have negative eigenvalues that J itself has not, with residuals of a quarter of
them."""
PAIRED = 0.15
"""Residual of a mode over its positive real part that certifies it where the projection has complex
pairs: J is far from symmetric there, and what looked like a pair of 0.215 +- 0.119i with a residual
of 0.079 hid a mode of -0.012. Without pairs a half will do."""
LOST = 0.15
"""Residual of the first mode of the last point, carried to this one, from which on modes of its
symmetry are looked for as if none were known: a few products from there may lead to the second."""
STIFF = 0.9
"""Eigenvalue that this mode may have, by its residual, from which on the same is done. Where the
law does not act any vector has the eigenvalue 1, and so has the mean of a whole cell: it tells
nothing of a mode that softens."""
CROWDED = 0.01
"""Residual that will do from PATIENCE runs on for a mode that is STIFF by it: where nothing
softens, as in full contact that slides, eigenvalues lie so near to each other that none has a mode
of its own."""
SHORT, LONG = 3, 12
PATIENCE = 8
RUNS = 40
NOISE = 0.003
MOST = 16
"""Products of a run, and of one for a first point or after so many runs: next to a fold short ones
stall; most runs, the part of noise in their starts, and vectors of a symmetry beyond which the
projection begins anew from its modes."""
APART = 7919
"""Places by which the noise of a run is moved from that of the one before."""


def leading_modes(operator, start=(), accurate=ACCURATE, number=0, neutral=NEUTRAL):
    """Unstable modes (real part negative) and the first stable ones of J with preconditioner P:
    `Modes` of each symmetry.

    Modes are those of the projection of J on a space, for each symmetry, that grows by runs of
    Arnoldi's method on 1 - P^-1 (J - s), s the leading eigenvalue as far as it is known: that
    operator has no large eigenvalues, and where s is an eigenvalue of J it has the same mode (the
    inverse-free preconditioned Krylov method of Golub and Ye 2002, SIAM J. Sci. Comput. 24, 312).
    A run begins with P^-1 (J x - s x) of modes x that are not accurate and with noise, without what
    the space holds; there are runs until residuals say that the signs are certain and the leading
    mode is accurate.

    Parameters
    ----------
    operator : with ``size``, ``apply`` (J), ``precondition`` (P^-1) and what `projection.Space`
        asks for; entries of vectors have a meaning where ``occupied``, ``uniform`` are of the whole
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
    space = Space(operator, number)
    if alone and operator.size <= DENSE:
        return _all_modes(space, number)
    found = _searched(space, start, accurate, number, neutral)
    if found is not None:
        return found
    if alone and operator.size <= LARGEST_DENSE:
        return _all_modes(space, number)
    modes = joined(space.modes())
    raise NotConverged("the modes of the point were not found: eigenvalue "
                       f"{modes.leading:.3g}, residual {modes.residuals[0]:.1g} after "
                       f"{RUNS} runs")


def _searched(space, start, accurate, number, neutral):
    """The modes of a space that grows by runs, None where residuals stay large; parameters as of
    `leading_modes`."""
    space.begin(start)
    lost = _lost(space)
    # What moves as a whole is as the preconditioner foretells, which shows a run nothing of it.
    for vector in getattr(space.operator, "uniform", list)() if lost else ():
        space.run(0.0, space.only(lost, vector), 1)
    # A first point has two runs from noise: two modes with nearly the same eigenvalue look like one
    # to a single run.
    cold = 0 if not lost else 1 if start else 2
    for run in range(cold):
        space.run(0.0, space.only(lost, _noise(space, run)), LONG)
    found = space.found()
    among = range(len(space.by.lengths)) if start else _loose(found, accurate, number, neutral)
    for run in range(cold, RUNS):
        if not among:
            break
        if space.largest > MOST:
            space.begin(summed([space.whole(*one) for one in found.items()]))
        ahead, shift = _ahead(space, found, among, accurate, number)
        noise = _noise(space, run)
        begin = space.only(among, sum(ahead, (NOISE if ahead else 1.0) * noise))
        space.run(shift, begin, LONG if run >= PATIENCE else SHORT)
        found = space.found()
        among = _loose(found, accurate, number, neutral, CROWDED if run >= PATIENCE else 0.0)
    return None if among else [space.whole(*one) for one in found.items()]


def _lost(space):
    """Numbers of symmetries of which no mode is known that is soft, or those of the last point are
    far from being some of this one's."""
    known = {symmetry for symmetry, modes in space.found().items()
             if modes.residuals[0] < min(LOST, STIFF - modes.values[0].real)}
    return [symmetry for symmetry in range(len(space.by.lengths)) if symmetry not in known]


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
    first = (real[first_largest(real)] if grid is None
             else grid.first_largest(operator.pieces(real)))
    return np.copysign(1.0, first) * real


def soft(found):
    """Modes that tell where to begin at a next point: those of symmetries of which one is soft.

    Where none is, any vectors are modes, of which some may be those of larger eigenvalues there.
    """
    return [part for part in found if part.values[0].real < STIFF]


def summed(found):
    """Sums of modes of different symmetries, which can be told apart again: so that one vector
    carries one of each."""
    return [sum(vectors) for vectors in zip_longest(*(_real(part.vectors, part.grid)
                                                      for part in found),
                                                    fillvalue=0.0)]


def _real(vectors, grid):
    """Real and imaginary parts of vectors, a list without what vanishes."""
    parts = (vectors if np.isrealobj(vectors)
             else [part for vector in vectors for part in (vector.real, vector.imag)])
    return [part for part in parts if (part.any() if grid is None else grid.any(part))]


def _noise(space, run):
    """Noise of length 1 to begin a run with, other noise in each."""
    operator = space.operator
    if space.grid is not None:
        noise = operator.noise(run)
        return noise / lengths(noise, space.grid)
    noise = np.roll(_random(operator.size), run * APART)
    occupied = _occupied(operator)
    if occupied is not None:
        noise[~occupied] = 0.0
    return noise / lengths(noise)


@lru_cache(maxsize=1)
def _random(size):
    """Random numbers, which are asked for at each point."""
    return np.random.default_rng(1).standard_normal(size)


def _occupied(operator):
    """Mask of the entries of vectors that have a meaning, or None: all."""
    return getattr(operator, "occupied", None)


def _ahead(space, found, among, accurate, number):
    """Steps P^-1 (J x - s x) of unit length, from modes of some symmetries that are not accurate
    yet, and the shift of the one that counts.

    Parameters
    ----------
    space : Space
    found : {number of a symmetry: Modes}
    among : numbers of symmetries
    accurate, number : as of `leading_modes`
    """
    steps = []
    for symmetry in among:
        if symmetry in found:
            modes = found[symmetry]
            loose = modes.certain & (modes.residuals > 0.1 * (accurate or ACCURATE))
            steps += [space.operator.precondition(space.by.whole(symmetry, defect))
                      for defect in _real(modes.defects[loose], space.grid)]
    values = np.sort(np.concatenate([modes.values.real for modes in found.values()]))
    return ([step / lengths(step, space.grid) for step in steps],
            min(values[min(number, len(values) - 1)], 0.5))


def _loose(found, accurate, number, neutral, crowded=0.0):
    """Numbers of symmetries of which a residual is too large for the sign of an eigenvalue, or for
    the mode that counts.

    Parameters
    ----------
    found : {number of a symmetry: Modes}
    accurate, number, neutral : as of `leading_modes`
    crowded : residual that will do where nothing softens
    """
    values = np.sort(np.concatenate([modes.values.real for modes in found.values()]))
    last = values[min(number, len(values) - 1)]
    return [symmetry for symmetry, modes in found.items()
            if _uncertain(modes, neutral)
            or accurate is not None and _inaccurate(modes, accurate, last, crowded)]


def _uncertain(modes, neutral):
    """Whether a residual leaves a sign open."""
    kept = PAIRED if np.any(modes.values.imag[modes.certain]) else 0.5
    share = np.where(modes.values.real < 0.0, FALSE, kept)
    allowed = np.maximum(share * np.abs(modes.values.real), neutral)
    return not np.all((modes.residuals < allowed)[modes.certain])


def _inaccurate(modes, accurate, last, crowded):
    """Whether a mode up to an eigenvalue, or one that may be by its residual, has one that is too
    large.

    Parameters
    ----------
    modes : Modes
    accurate : as of `leading_modes`
    last : float, real part
    crowded : as of `_loose`
    """
    allowed, least = accurate * np.clip(4.0 * np.abs(modes.values), 1.0, 2.2), modes.values.real
    allowed = np.where(least - modes.residuals > STIFF, np.maximum(allowed, crowded), allowed)
    counts = (least <= last) | (modes.certain & (least - modes.residuals <= last))
    return not np.all((modes.residuals <= allowed)[counts])


def _all_modes(space, number):
    """All modes by dense matrices, one of each symmetry: of the stable ones the first, and those up
    to a ``number``."""
    operator, by, occupied, found = space.operator, space.by, _occupied(space.operator), []
    for symmetry, length in enumerate(by.lengths):
        unit = np.eye(length)
        unit = unit if occupied is None else unit[by.parts(occupied)[symmetry]]
        if not len(unit):  # of one node nothing is odd
            continue
        images = np.array([by.parts(operator.apply(by.whole(symmetry, one)))[symmetry]
                           for one in unit])
        found.append(space.whole(symmetry, projected(unit, images, unit @ images.T, 1, number)))
    return found
