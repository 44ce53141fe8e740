"""The base of elastic bodies with a flat surface: what a body declares, and its compliance on the
waves of a grid.

Scaled units: contact modulus E* = 1, lengths in beta. Forces act on the body; components are
ordered normal, then tangential (`elasticity`).
"""

import copy
from typing import NamedTuple

import numpy as np

from ..declared import Declared
from ..elasticity import Surface

# Below this relative size a block of the compliance is rounding.
_VANISHING = 1e-15
# Waves of a body over its longest ones, at which the body's kind is found out.
_SAMPLES = 10.0 ** np.arange(0, 10)


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
    return points // 2 if points and points % 2 == 0 else None


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
            at = (*[slice(None)] * axis, index)
            e[at], nyquist[at] = 0.0, True
    return _Waves(wavenumber, unit, odd_unit, zero, nyquist)


def _of_none(wavenumber):
    """`Surface` of no wave numbers."""
    return Surface(*[np.empty(np.shape(wavenumber))] * len(Surface._fields))


class Body(Declared):
    """A linear elastic body: its surface compliance and stiffness in Fourier space. A subclass has
    to have ``surface`` and ``rigid_compliance``.

    Normal quantities are in u_n,r and E* u_n,r/beta, tangential ones in
    u_t,r = r u_n,r and E* u_t,r/beta with r = sqrt(phi_t/phi_n). So the (normal,
    tangential) blocks of both matrices carry the factor r, the (tangential,
    normal) ones 1/r, and the others none.

    Attributes
    ----------
    work_ratio : phi_t/phi_n, the scene's; matters only where the directions couple
    rigid_compliance : normal and tangential compliance of the mean surface against the far one,
        beta/E*; 0 where there is none by definition
    local_compliance : normal and tangential compliance that is left for the shortest waves, beta/E*
    """

    made = ("compliance", "diagonal", "stiffness")
    spared = {"surface": _of_none, "surface_stiffness": _of_none}
    work_ratio = 1.0
    local_compliance = (0.0, 0.0)

    def with_work_ratio(self, ratio):
        """The body in a scene with phi_t/phi_n; itself where that is its own."""
        if ratio == self.work_ratio:
            return self
        found = copy.copy(self)
        vars(found)["work_ratio"] = ratio
        return found

    # What a body declares

    def surface(self, wavenumber):
        """`Surface` compliance at wave numbers (array, 1/beta, > 0), beta/E*."""
        raise NotImplementedError(f"the body {type(self).__name__} has no surface(wavenumber)")

    def surface_stiffness(self, wavenumber):
        """`Surface` stiffness at wave numbers, E*/beta: by default the inverse of the
        compliance."""
        c = self.surface(wavenumber)
        determinant = c.normal * c.longitudinal - c.coupling ** 2
        return Surface(c.longitudinal / determinant, c.normal / determinant, 1 / c.transverse,
                       c.coupling / determinant)

    @property
    def rigid_compliance(self):
        """Normal and tangential compliance of the mean surface, beta/E*."""
        raise NotImplementedError(f"the body {type(self).__name__} has no rigid_compliance")

    def couples(self, smallest_wavenumber):
        """Whether normal and tangential directions couple above rounding at q >=
        `smallest_wavenumber`; by default it is asked at ten places."""
        c = self.surface(smallest_wavenumber * _SAMPLES)
        return bool(np.max(np.abs(c.coupling) / np.sqrt(c.normal * c.longitudinal)) > _VANISHING)

    def anisotropy(self, smallest_wavenumber):
        """Largest relative difference of longitudinal and transverse compliance at q >=
        `smallest_wavenumber`."""
        c = self.surface(smallest_wavenumber * _SAMPLES)
        return float(np.max(np.abs(c.longitudinal / c.transverse - 1)))

    @property
    def transverse_stiffness(self):
        """Stiffness of short waves across the slip over that along it."""
        c = self.surface(_SAMPLES[-1:])
        return float((c.longitudinal / c.transverse)[0])

    def coupled(self, scene):
        """Whether a scene's tangential unknowns are moved by normal loads, by more than rounding;
        of an isolated contact, those of the layer that is its `far_field`."""
        if scene.isolated:
            return self.far_field().coupled(scene)
        return self.couples(2 * np.pi / max(scene.periods))

    def far_field(self):
        """The layer or half-space that the body is but for ``local_compliance``, whose kernel on an
        unbounded flat is known; None where there is none, and no isolated contact."""

    def check(self, scene, sheared=False):
        """InputError unless the body suits a scene, with or without tangential unknowns."""

    def about(self, scene, size):
        """Phrases on what it is made of; ``size(value, unit, digits)`` puts a value in words."""
        return [f"body {scene.body}"]

    # On the waves of a grid

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

    def diagonal(self, wavevectors, components, *, last_even=True):
        """The blocks C_ii of the `compliance` alone, for what leaves out how components couple.

        Parameters
        ----------
        wavevectors, components, last_even : as of `compliance`
        """
        waves = self._check(wavevectors, components, last_even)
        return self._without_zero_mode(self._blocks(self.surface(waves.wavenumber), 1.0, waves,
                                                    components, (False, False)), waves)

    def stiffness(self, wavevectors, components, *, last_even=True):
        """Inverse of `compliance` among the given components, in the same blocks.

        One component: 1/C_nn, the frictionless interface. All: the body's
        stiffness, and at Nyquist modes the inverse of the compliance used there.

        Parameters
        ----------
        wavevectors, components, last_even : as of `compliance`
        """
        waves = self._check(wavevectors, components, last_even)
        if components == 1:
            blocks = self._compliance_blocks(waves, 1)
            blocks[0, 0] = 1 / blocks[0, 0]
        else:
            surface = self.surface_stiffness(waves.wavenumber)
            coupled, sheared = self._nonzero(waves, components)
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

    def _nonzero(self, waves, components):
        """Whether normal and tangential directions couple, and whether x and y do, among so many
        components."""
        smallest = np.min(waves.wavenumber, where=~waves.zero, initial=np.inf)
        if components == 1 or np.isinf(smallest):
            return False, False
        return (self.couples(smallest),
                components == 3 and self.anisotropy(smallest) > _VANISHING)

    def _compliance_blocks(self, waves, components):
        """Blocks of the compliance, arbitrary at q = 0."""
        return self._blocks(self.surface(waves.wavenumber), 1.0, waves, components,
                            self._nonzero(waves, components))

    def _blocks(self, surface, sign, waves, components, nonzero):
        """Rotate S to Cartesian components: S_ab = S_TT d_ab + (S_LL - S_TT) e_a e_b, S_an = i sign
        s e_a."""
        # (zero is written into it; a body of one's own may give single precision)
        blocks = {(0, 0): np.require(surface.normal, float, "W")}
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
        surface = self.surface(lines.wavenumber)
        matrix = np.zeros((lines.wavenumber.size, components, components), dtype=complex)
        for (i, j), block in self._blocks(surface, 1.0, lines, components,
                                          self._nonzero(waves, components)).items():
            matrix[:, i, j] = block
        inverse = np.linalg.inv(matrix)
        for (i, j), block in blocks.items():
            entry = inverse[:, i, j]
            block[waves.nyquist] = entry if np.iscomplexobj(block) else entry.real
