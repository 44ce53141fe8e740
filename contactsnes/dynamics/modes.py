"""Modes of smallest real part of an operator that has a good preconditioner: the identity plus a
compact one, say."""

from itertools import zip_longest

import numpy as np
import scipy

from ..continuation.bifurcations import NEUTRAL
from ..continuation.points import NotConverged
from ..grid.contours import first_largest
from .projection import Space, joined, lengths, projected

ACCURATE = 3e-4
"""Residual |J x - s x| / |x| to which the leading mode is found, up to twice that where |s| > 1/4;
its eigenvalue's error is smaller."""
DENSE, LARGEST_DENSE = 40, 1500
"""Unknowns up to which all eigenvalues are computed at once, and where the Krylov method fails."""
FALSE = 0.02
"""Residual of a mode over its negative eigenvalue that certifies it: J is not symmetric, and a
projection of it may have negative eigenvalues that J itself has not, with residuals of a quarter of
them."""
BASIS = 3
LONGER = 4
PATIENCE = 8
RUNS = 40
NOISE = 0.003
MOST = 16
"""Products of a run of ARPACK; how many times as many it has for a first point, and after so many
runs: next to a fold short ones stall; most runs, the part of noise in their starts, and vectors of
a symmetry beyond which the projection begins anew from its modes."""


def leading_modes(operator, axes=(), start=(), accurate=ACCURATE, number=0, neutral=NEUTRAL):
    """Unstable modes (real part negative) and the first stable ones of J with preconditioner P:
    `Modes` of each symmetry.

    ARPACK looks for the modes of P^-1 (J - s) of smallest real part, s the leading eigenvalue as
    far as it is known: that operator has no large eigenvalues, and where s is an eigenvalue of J it
    has the same mode. J's own modes are those of its projection on all vectors that ARPACK
    multiplied (the inverse-free preconditioned Krylov method of Golub and Ye 2002, SIAM J. Sci.
    Comput. 24, 312), split by symmetry. Again, from these, until residuals say that the signs are
    certain and the leading one is accurate.

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
                       f"{RUNS} runs of ARPACK")


def _searched(space, start, accurate, number, neutral):
    """The modes of a space that grows by runs of ARPACK, None where residuals stay large;
    parameters as of `leading_modes`."""
    random, size = np.random.default_rng(1), space.operator.size
    space.begin(start)
    # A first point has two runs from noise: two modes with nearly the same eigenvalue look like one
    # to a single run.
    cold = 0 if start else 2
    vectors, shift = (_ahead(space, joined(space.modes()), accurate, number) if start
                      else ([], 0.0))
    for run in range(RUNS):
        noise = random.standard_normal(size) if space.grid is None else space.operator.noise(run)
        begin = sum(vectors, (NOISE if vectors else 1.0) / lengths(noise, space.grid) * noise)
        longer = run < cold or run >= PATIENCE
        _krylov(space, shift, begin, BASIS * LONGER if longer else BASIS)
        if run + 1 < cold:
            continue
        found = space.modes()
        modes = joined(found)
        if _settled(modes, accurate, number, neutral):
            return found
        vectors, shift = _ahead(space, modes, accurate, number)
        if space.largest > MOST:
            space.begin(summed(found))
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
    return [sum(vectors) for vectors in zip_longest(*(_real(part.vectors, part.grid)
                                                      for part in found),
                                                    fillvalue=0.0)]


def _real(vectors, grid):
    """Real and imaginary parts of vectors, a list without what vanishes."""
    parts = [part for vector in vectors for part in (vector.real, vector.imag)]
    return [part for part in parts if (part.any() if grid is None else grid.any(part))]


def _ahead(space, modes, accurate, number):
    """Steps P^-1 (J x - s x) of unit length, from modes that are not accurate yet, and the shift of
    the one that counts."""
    loose = modes.certain & (modes.residuals > 0.1 * (accurate or ACCURATE))
    steps = [space.operator.precondition(residual)
             for residual in _real(modes.defects[loose], space.grid)]
    shift = modes.values[min(number, len(modes.values) - 1)].real
    return [step / lengths(step, space.grid) for step in steps], min(shift, 0.5)


def _krylov(space, shift, begin, basis):
    """ARPACK's search for modes of P^-1 (J - shift), to a loose tolerance of its own: ``space``
    keeps all products on the way."""
    operator = space.operator

    def product(vector):
        return vector - operator.precondition(space.product(vector) - shift * vector)

    if space.grid is not None:
        _arnoldi(product, begin, basis, space.grid)
        return
    size, linalg = operator.size, scipy.sparse.linalg
    try:
        linalg.eigs(linalg.LinearOperator((size, size), matvec=product, dtype=float), k=1,
                    which="LR", v0=begin, ncv=basis, tol=0.1, maxiter=1,
                    return_eigenvectors=False)
    except (linalg.ArpackNoConvergence, linalg.ArpackError):
        pass  # what it has tried serves as well


def _arnoldi(product, begin, count, grid):
    """As many products as a run of ARPACK has, of its vectors: ARPACK knows no other processes.

    Parameters
    ----------
    product : function (vector) -> vector
    begin : vector
    count : int
    grid : Grid that sums over processes
    """
    basis, vector = np.empty((0, len(begin))), begin
    for _ in range(count):
        for _ in range(2):
            vector = vector - grid.together(basis @ vector) @ basis
        length = lengths(vector, grid)
        if length == 0.0:
            return
        basis = np.concatenate([basis, [vector / length]])
        vector = product(basis[-1])


def _settled(modes, accurate, number, neutral):
    """Whether residuals are small enough for the signs of all eigenvalues, and for the one that
    counts."""
    share = np.where(modes.values.real < 0.0, FALSE, 0.5)
    signs = np.all((modes.residuals < np.maximum(share * np.abs(modes.values.real),
                                                 neutral))[modes.certain])
    return signs and (accurate is None
                      or np.all((modes.residuals <= accurate * np.clip(4.0 * np.abs(modes.values),
                                                                       1.0, 2.2))[:number + 1]))


def _all_modes(operator):
    """All modes by a dense matrix, whatever their symmetry; of the stable ones the first."""
    unit = np.eye(operator.size)
    return projected(unit, np.array([operator.apply(one) for one in unit]), 1)
