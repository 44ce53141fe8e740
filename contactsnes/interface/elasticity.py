"""Exact elasticity of a layer or a half-space in Fourier space.

Scaled units: contact modulus E* = 1, lengths in beta, so that mu = (1 - nu)/2.
The body occupies 0 < z < H above the interface; its top is held at every q != 0.
Fields are f(x) = sum_q f(q) exp(+i q x). Forces act *on the body*, f = M u and
u = C f; a traction law that counts attraction positive enters as f = -t.
Components are ordered normal, then tangential.
"""

from typing import NamedTuple

import numpy as np

# k = qH beyond which layer and half-space agree to rounding (k^2 exp(-2k) < 1e-31).
_THICK = 40.0


class Surface(NamedTuple):
    """Stiffness or compliance of the surface in the frame of the wave vector.

    Attributes
    ----------
    normal, longitudinal, transverse : ndarray
        The diagonal: along z, along q, and across both.
    coupling : ndarray
        Real number m (stiffness) or c (compliance): the entries (longitudinal,
        normal) are -i m and +i c, their transposes the complex conjugates.
        Positive for a half-space.
    """

    normal: np.ndarray
    longitudinal: np.ndarray
    transverse: np.ndarray
    coupling: np.ndarray


def _sinh_excess(x):
    """sinh x - x for x >= 0, without cancellation."""
    square = np.minimum(x, 2.0) ** 2
    series = 1.0
    for n in range(12, 1, -1):
        series = 1.0 + square / (2 * n * (2 * n + 1)) * series
    return np.where(x < 2.0, x * square / 6.0 * series, np.sinh(x) - x)


def _layer_terms(wavenumber, poisson, height):
    """k, sinh k, cosh k, kappa sinh k - k, kappa sinh k cosh k -+ k, kappa (1-2nu) sinh^2 k - k^2.

    Every difference is split into terms that vanish together with k and a
    factor 1 - 2 nu, so nothing cancels at small k for any Poisson ratio.
    """
    k = np.minimum(wavenumber * height, _THICK)
    sinh, cosh = np.sinh(k), np.cosh(k)
    kappa, compressible = 3 - 4 * poisson, 1 - 2 * poisson
    excess = _sinh_excess(k)
    single = 2 * compressible * sinh + excess
    minus = 2 * compressible * sinh * cosh + _sinh_excess(2 * k) / 2
    plus = kappa * sinh * cosh + k
    shear = (2 * (1 - poisson) * (1 - 4 * poisson) * k**2
             + kappa * compressible * excess * (sinh + k))
    return k, sinh, cosh, single, minus, plus, shear


def layer_stiffness(wavenumber, poisson, height):
    """Surface stiffness M(q) of an elastic layer held at its top (Kausel and Roesset 1981).

    With k = qH, kappa = 3 - 4 nu, S = sinh k, C = cosh k, D = kappa^2 S^2 - k^2, E* = 1::

        M_nn = 2 (1-nu)^2 q (kappa S C + k)/D     M_LL = 2 (1-nu)^2 q (kappa S C - k)/D
        M_TT = (1-nu)/2 q coth k
        M_Ln = -i m = conj(M_nL),   m = (1-nu) q [kappa (1-2nu) S^2 - k^2]/D

    for a wave exp(+i q x) and a body above the interface (tractions on the
    body); the transverse part belongs to two-dimensional interfaces only.

    Parameters
    ----------
    wavenumber : array_like
        Positive, units 1/beta, any shape.
    poisson : float
        0 to 1/2, both included.
    height : float
        Units beta; ``math.inf`` is the half-space.

    Returns
    -------
    Surface
        Arrays of the shape of `wavenumber`, units E*/beta; accurate to
        rounding for small k, free of overflow for large.
    """
    q = np.asarray(wavenumber, dtype=float)
    k, sinh, cosh, single, minus, plus, shear = _layer_terms(q, poisson, height)
    scale = (1 - poisson) * q / (single * ((3 - 4 * poisson) * sinh + k))
    return Surface(
        normal=2 * (1 - poisson) * scale * plus,
        longitudinal=2 * (1 - poisson) * scale * minus,
        transverse=(1 - poisson) / 2 * q * cosh / sinh,
        coupling=scale * shear,
    )


def layer_compliance(wavenumber, poisson, height):
    """Surface compliance C(q) = M(q)^-1 of an elastic layer held at its top.

    In the notation of `layer_stiffness`, whose determinant is
    (1-nu)^2 q^2 G/D with G = kappa S^2 + 4 (1-nu)^2 + k^2 (a sum of positive terms)::

        C_nn = 2 (kappa S C - k)/(q G)     C_LL = 2 (kappa S C + k)/(q G)
        C_TT = 2 tanh k/((1-nu) q)
        C_Ln = +i c = conj(C_nL),   c = [kappa (1-2nu) S^2 - k^2]/((1-nu) q G)

    Half-space: C_nn = C_LL = 2/q, c = 2 beta_D/q with Dundurs'
    beta_D = (1-2nu)/(2(1-nu)). A Surface of arrays of the shape of `wavenumber`, units beta/E*.

    Parameters
    ----------
    wavenumber, poisson, height : as of `layer_stiffness`; a wave number may be complex, with a real
        part that is positive and an imaginary one below about 1/height
    """
    shape, q = np.shape(wavenumber), np.ravel(1.0 * np.asarray(wavenumber))
    # most waves of a tall layer are those of a half-space
    found = [2 / q, 2 / q, 2 / (1 - poisson) / q, (1 - 2 * poisson) / (1 - poisson) / q]
    thin = q * height < _THICK
    if thin.any():
        q = q[thin]
        k, sinh, cosh, _, minus, plus, shear = _layer_terms(q, poisson, height)
        scale = 1 / (q * ((3 - 4 * poisson) * sinh**2 + 4 * (1 - poisson) ** 2 + k**2))
        for block, values in zip(found, (2 * scale * minus, 2 * scale * plus,
                                         2 / (1 - poisson) / q * (sinh / cosh),
                                         scale * shear / (1 - poisson))):
            block[thin] = values
    return Surface(*(block.reshape(shape)[()] for block in found))


def rigid_stiffness(poisson, height):
    """Stiffness of the mean surface against the top, k_0n = (1-nu)^2/((1-2nu)H), k_0t =
    (1-nu)/(2H).

    Per area of interface, units E*/beta. ``inf`` where the mean displacement
    cannot differ from that of the top: normal for nu = 1/2, and both, by
    definition, for infinite height.

    Returns
    -------
    tuple of float
        Normal and tangential stiffness.
    """
    if np.isinf(height):
        return np.inf, np.inf
    compressible = (1 - 2 * poisson) * height
    normal = (1 - poisson) ** 2 / compressible if compressible > 0 else np.inf
    return normal, (1 - poisson) / (2 * height)
