"""Exact elasticity of a layer or a half-space in Fourier space.

Scaled units: contact modulus E* = 1, lengths in beta, so that mu = (1 - nu)/2.
The body occupies 0 < z < H above the interface; its top is held at every q != 0.
Fields are f(x) = sum_q f(q) exp(+i q x). Forces act *on the body*, f = M u and
u = C f; a traction law that counts attraction positive enters as f = -t.
Components are ordered normal, then tangential.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

# Below this relative size a block of the compliance is rounding.
_VANISHING = 1e-15
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
    beta_D = (1-2nu)/(2(1-nu)). Parameters and result as in `layer_stiffness`, units beta/E*.
    """
    q = np.asarray(wavenumber, dtype=float)
    k, sinh, cosh, _, minus, plus, shear = _layer_terms(q, poisson, height)
    scale = 1 / (q * ((3 - 4 * poisson) * sinh**2 + 4 * (1 - poisson) ** 2 + k**2))
    return Surface(
        normal=2 * scale * minus,
        longitudinal=2 * scale * plus,
        transverse=2 / (1 - poisson) / q * (sinh / cosh),
        coupling=scale * shear / (1 - poisson),
    )


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


class _Waves(NamedTuple):
    """Half spectrum: |q| (1 at the zero mode), unit vectors, the same without Nyquist, masks."""

    wavenumber: np.ndarray
    unit: tuple
    odd_unit: tuple
    zero: np.ndarray
    nyquist: np.ndarray

    def at(self, select):
        """The selected waves only."""
        return _Waves(self.wavenumber[select], tuple(e[select] for e in self.unit),
                      tuple(e[select] for e in self.odd_unit), self.zero[select],
                      self.nyquist[select])


def _nyquist_index(axis, directions, points, last_even):
    """Index of the Nyquist wave number along an axis of a half spectrum, or None."""
    if axis == directions - 1:
        return points - 1 if last_even and points > 1 else None
    return points // 2 if points % 2 == 0 else None


def _create_waves(wavevectors, last_even):
    """Wave numbers and unit vectors of a half spectrum.

    At its Nyquist index a direction has the single wave cos(pi i), the mean of
    the two waves +-q_N. An entry odd in that component of q turns it into
    sin(pi i) = 0 on every node, so the unit vector used for odd entries has a
    zero there: i q_x in the coupling to the normal direction, and q_x q_y when
    either index is Nyquist (both included: it gives sin sin). Entries even in
    q_x keep their value.
    """
    wavevectors = [np.asarray(q, dtype=float) for q in wavevectors]
    wavenumber = np.sqrt(sum(q**2 for q in wavevectors))
    zero = wavenumber == 0
    wavenumber[zero] = 1.0
    unit = tuple(q / wavenumber for q in wavevectors)
    odd_unit = tuple(e.copy() for e in unit)
    nyquist = np.zeros(wavenumber.shape, dtype=bool)
    for axis, e in enumerate(odd_unit):
        index = _nyquist_index(axis, len(unit), wavenumber.shape[axis], last_even)
        if index is not None:
            np.moveaxis(e, axis, 0)[index] = 0.0
            np.moveaxis(nyquist, axis, 0)[index] = True
    return _Waves(wavenumber, unit, odd_unit, zero, nyquist)


@dataclass(frozen=True)
class Body:
    """Elastic layer or half-space: its surface compliance and stiffness in Fourier space.

    Normal quantities are in u_n,r and E* u_n,r/beta, tangential ones in
    u_t,r = r u_n,r and E* u_t,r/beta with r = sqrt(phi_t/phi_n). So the (normal,
    tangential) blocks of both matrices carry the factor r, the (tangential,
    normal) ones 1/r, and the others none.

    Parameters
    ----------
    poisson : float
        Poisson ratio, 0 to 1/2. Below 1/2 normal and tangential directions couple.
    height : float
        Height of the layer in beta, or ``math.inf``.
    work_ratio : float
        phi_t/phi_n; matters only where the directions couple.
    """

    poisson: float
    height: float
    work_ratio: float = 1.0

    @property
    def rigid_compliance(self):
        """Normal and tangential compliance 1/k_0 of the zero mode; 0 where `rigid_stiffness` is
        infinite."""
        normal, tangential = rigid_stiffness(self.poisson, self.height)
        return 1 / normal, 1 / tangential

    def couples(self, smallest_wavenumber):
        """Whether normal and tangential directions couple above rounding at q >=
        `smallest_wavenumber`.

        The coupling relative to sqrt(C_nn C_LL) tends to Dundurs' constant for
        large qH; the rest, k^2 exp(-2k), is largest at the smallest q.
        """
        c = layer_compliance(smallest_wavenumber, self.poisson, self.height)
        relative = abs(c.coupling) / np.sqrt(c.normal * c.longitudinal)
        dundurs = (1 - 2 * self.poisson) / (2 * (1 - self.poisson))
        return bool(max(relative, dundurs) > _VANISHING)

    def compliance(self, wavevectors, components, *, last_even=True):
        """Symbols C_ij(q) of the compliance, u_i(q) = sum_j C_ij(q) f_j(q).

        Parameters
        ----------
        wavevectors : tuple of ndarray
            Wave numbers of numpy's ``rfftn`` in units 1/beta, broadcastable:
            ``(q,)`` with q >= 0, or ``(qx[:, None], qy[None, :])`` with the
            whole, signed qx and the half qy.
        components : int
            1 (normal), 2 (normal, tangential; one direction) or 3 (normal, x,
            y; two directions).
        last_even : bool
            The last direction has an even number of points, so that its last
            wave number is Nyquist's (the half spectrum does not tell).

        Returns
        -------
        dict of (int, int) to ndarray
            Blocks over the half spectrum, without those that vanish to
            rounding: real, but complex (imaginary) between normal and
            tangential. 0 at q = 0, whose compliance is `rigid_compliance`.

        Raises
        ------
        ValueError
            If the components do not fit the number of directions.
        """
        waves = self._check(wavevectors, components, last_even)
        return self._without_zero_mode(self._compliance_blocks(waves, components), waves)

    def stiffness(self, wavevectors, components, *, last_even=True):
        """Inverse of `compliance` among the given components, with the same parameters and result.

        One component: 1/C_nn, the frictionless interface. All: the layer's
        stiffness, and at Nyquist modes the inverse of the compliance used there.
        """
        waves = self._check(wavevectors, components, last_even)
        if components == 1:
            blocks = self._compliance_blocks(waves, 1)
            blocks[0, 0] = 1 / blocks[0, 0]
        else:
            surface = layer_stiffness(waves.wavenumber, self.poisson, self.height)
            coupled, sheared = self._nonzero(waves)
            # What is coupled to the normal direction is stiffer: where compliances of x and y are
            # equal, stiffnesses are not.
            blocks = self._blocks(surface, -1.0, waves, components, (coupled, coupled or sheared))
            self._invert_nyquist(blocks, waves, components)
        return self._without_zero_mode(blocks, waves)

    @staticmethod
    def _check(wavevectors, components, last_even):
        """The waves, if components and directions fit."""
        if components not in (1, len(wavevectors) + 1):
            raise ValueError(f"{components} components on an interface of "
                             f"{len(wavevectors)} dimension(s): use 1 (normal) or "
                             f"{len(wavevectors) + 1} (normal and tangential).")
        return _create_waves(wavevectors, last_even)

    @staticmethod
    def _without_zero_mode(blocks, waves):
        """The blocks with 0 at q = 0."""
        for block in blocks.values():
            block[waves.zero] = 0.0
        return blocks

    def _nonzero(self, waves):
        """Whether normal and tangential directions couple, and whether x and y do."""
        smallest = np.min(waves.wavenumber, where=~waves.zero, initial=np.inf)
        if np.isinf(smallest):
            return False, False
        c = layer_compliance(smallest, self.poisson, self.height)
        anisotropy = max(self.poisson, abs(c.longitudinal / c.transverse - 1))
        return self.couples(smallest), anisotropy > _VANISHING

    def surface(self, wavenumber):
        """Surface compliance at wave numbers, arbitrary at q = 0, of which `compliance` is made."""
        return layer_compliance(wavenumber, self.poisson, self.height)

    def _compliance_blocks(self, waves, components):
        """Blocks of the compliance, arbitrary at q = 0."""
        return self._blocks(self.surface(waves.wavenumber), 1.0, waves, components,
                            self._nonzero(waves))

    def _blocks(self, surface, sign, waves, components, nonzero):
        """Rotate S to Cartesian components: S_ab = S_TT d_ab + (S_LL - S_TT) e_a e_b, S_an = i sign
        s e_a."""
        blocks = {(0, 0): surface.normal}
        ratio = np.sqrt(self.work_ratio)
        for a in range(1, components):
            e = waves.unit[a - 1]
            blocks[a, a] = surface.longitudinal * e**2 + surface.transverse * (1 - e**2)
            if nonzero[0]:
                entry = 1j * sign * surface.coupling * waves.odd_unit[a - 1]
                blocks[a, 0], blocks[0, a] = entry / ratio, -entry * ratio
        if components == 3 and nonzero[1]:
            ex, ey = waves.odd_unit
            blocks[1, 2] = (surface.longitudinal - surface.transverse) * ex * ey
            blocks[2, 1] = blocks[1, 2]
        return blocks

    def _invert_nyquist(self, blocks, waves, components):
        """Replace Nyquist entries of the stiffness by the inverse of the compliance."""
        lines = waves.at(waves.nyquist)
        if lines.wavenumber.size == 0:
            return
        surface = layer_compliance(lines.wavenumber, self.poisson, self.height)
        matrix = np.zeros((lines.wavenumber.size, components, components), dtype=complex)
        for (i, j), block in self._blocks(surface, 1.0, lines, components,
                                          self._nonzero(waves)).items():
            matrix[:, i, j] = block
        inverse = np.linalg.inv(matrix)
        for (i, j), block in blocks.items():
            entry = inverse[:, i, j]
            block[waves.nyquist] = entry if np.iscomplexobj(block) else entry.real
