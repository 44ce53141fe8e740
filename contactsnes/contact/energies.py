"""Energies of a point and works along a path: what is stored in body and interface, and what is
done by the loads.

In phi_n beta (one dimension: w_n,r u_n,r; two: R phi_n u_n,r, with beta squared); tangential parts
count phi_t / phi_n times. No transform is needed: in equilibrium K v = -t, so that the energy of
the body is half the work of all its loads (Clapeyron).

    dE_el + integral of (p_n dg_n + p_t dg_t) dx = W dD + T dU        along every path of
    equilibria, whatever the law

The right side is a line integral over a curve of few dimensions: the cubic through the last four
points by chord length, so that its error falls as the fourth power of the step, through folds as
well (`work_along`). Points at corners of the path, where legs or jumps begin, are not joined.
Where the law has a potential the work done on the interface is that potential's difference, free of
any step error; elsewhere it is a line integral as well, over the curves of all nodes
(`interface_work`). The two works test each other (``energy_imbalance``). A jump under fixed loads
dissipates the work of the loads that is neither stored nor done on the interface. Where there is no
potential, the latter is summed up along the motion that was followed; if there was none, it is not
known.
"""

import math
from typing import NamedTuple

import numpy as np

from ..interface import law_claims
from ..interface.laws.law import slip_of
from .interface_work import FAR_PANELS, between, corners, straight
from .state import lightest
from .work_along import MOST, path_work

STICKING = 1e-6
"""Tangential gap, in ranges, that counts as none: its energy would be below rounding."""

PART = 2 ** 14
"""Nodes whose energies are found at a time."""

UNSURE = 0.005
"""Part of the work that a motion does on the interface by which that may be wrong: mostly 0.002 to
0.007 of it (small jumps of sheared lines, beside motions and eigenvalues of another program)."""

LOCATED = 1e-6
"""Precision of a fold up to which a jump's motion begins under its load."""

WORKS = ("external_work", "interface_work", "dissipated_work", "energy_imbalance")
"""What is summed up along a path."""

BALANCES = ("", "potential", "motion", "unknown")
"""By what is known what a jump dissipates: the law's potential, the motion, or not at all."""


class Entry(NamedTuple):
    """A point with its displacements D, U, ... and forces W, T, ... (components of the scene), the
    datum of D that of the body."""

    point: object
    displacements: np.ndarray
    forces: np.ndarray


def energy_unit(scene):
    """Unit of energies and works, in words."""
    return "R phi_n u_n,r" if scene.dimension == 2 else "w_n,r u_n,r"


def weights(contact, components):
    """Energy of a component in its own units, ranges times phi_i, over that in phi_n: 1, then phi_t
    / phi_n."""
    return np.array([1.0] + [contact.scene.work_ratio] * (components - 1))


def far_displacements(contact, point):
    """D, U, ... of a point, where they are not defined (nan) against the datum of the body's
    compliance."""
    if not any(map(math.isnan, point.displacements.tolist())):
        return point.displacements
    count = len(point.forces)
    compliance = contact.rigid_compliance(count)
    far = point.state.means + compliance * point.forces / (contact.load_factor(count)
                                                           * contact.grid.size)
    return contact.signs(count) * far / contact.ranges[:count]


def stored(contact, point):
    """Elastic energy of the body and energy of the interface at a point, phi_n beta.

    The first is E = 1/2 sum over components of (F_i D_i - integral of p_i u_i), springs of the
    rigid compliance included. The second is zero where the surfaces are apart, nan where the law
    has no potential (`laws.Law.potential`).
    """
    survey, state = contact.survey(point.state), point.state
    grid = contact.grid if state.half is None else state.half.grid
    # (of the tractions themselves: what a prescribed force misses them by would do work on all of
    # a long slip)
    forces = contact.load_factor(state.components) * survey.total
    elastic = 0.5 * weights(contact, state.components) @ (
        forces * far_displacements(contact, point) - grid.node_area * survey.work)
    interfacial = potential(contact, state)
    return float(elastic), np.nan if interfacial is None else interfacial


def potential(contact, state):
    """Energy of the interface, phi_n beta; None where there is none. Nodes are summed up part by
    part, which stay in the processor's cache."""
    grid = contact.grid if state.half is None else state.half.grid
    each = getattr(grid, "weights", None)
    found, initial_gap = 0.0, contact.gap_on(state.nodes)
    for first in range(0, len(initial_gap), PART):
        part = slice(first, first + PART)
        gap = state.once[:, part].copy()
        gap[0] += initial_gap[part]
        if len(gap) > 1:
            gap[1:] *= (gap[0] < contact.law.range) & (slip_of(gap) > STICKING)
        energy = law_claims.potential(contact.law, contact.scene.law, gap,
                                      contact.scene.work_ratio)
        if energy is None:
            found = None
            break
        found += np.add.reduce(energy) if each is None else energy @ each[part]
    # whether there is one hangs on the gaps of all nodes
    return None if grid.any(found is None) else float(grid.node_area * grid.together(found))


class PathEnergies:
    """Energies and works of the points of a path, which are told in their order; needs the last
    four of them.

    Parameters
    ----------
    contact : Contact
    history : points already told, of an interrupted path, oldest first
    """

    def __init__(self, contact, history=()):
        self.contact, self.trail = contact, []
        count = contact.scene.components
        # what a body of compliance one and the rigid compliance give way to a force
        self._give = 1.0 + contact.rigid_compliance(count) / (contact.ranges ** 2
                                                              * contact.grid.area)
        self._weights = weights(contact, count)
        for point in history:
            entry = self._entry(point)
            if not (self.trail and self._same(entry, self.trail[-1])):  # a further event there
                self._keep(entry)

    def completed(self, point):
        """The point with its energies, and its works since the path began."""
        elastic, interfacial = stored(self.contact, point)
        point = point.changed(elastic_energy=elastic, interfacial_energy=interfacial)
        entry = self._entry(point)
        if not self.trail:
            point = point.changed(**dict.fromkeys(WORKS, 0.0))
        else:
            last = self.trail[-1]
            if self._same(entry, last):
                # how closely a fold is known that the last point turns out to be
                self.trail[-1] = last._replace(point=last.point.changed(
                    fold_precision=point.fold_precision))
                return point.changed(smooth_steps=last.point.smooth_steps,
                                     **{name: getattr(last.point, name) for name in WORKS})
            out_of_range = point.event == "fold" and not (point.in_contact or point.tangents)
            point = self._after_jump(entry, last) if point.event == "jump" else \
                self._after_release(entry, last) if out_of_range else self._after_step(entry, last)
        self._keep(entry._replace(point=point))
        return point

    def _entry(self, point):
        """The point with displacements and forces of all components."""
        loads, count = np.zeros((2, self.contact.scene.components)), len(point.forces)
        loads[:, :count] = far_displacements(self.contact, point), point.forces
        return Entry(point, *loads)

    def _keep(self, entry):
        """Keep an entry among the last ones."""
        self.trail = [*(one._replace(point=one.point.changed(state=lightest(one.point.state)))
                        for one in self.trail[1 - MOST:]), entry]

    def _same(self, entry, last):
        """Whether nothing has moved from one entry to the next."""
        return all((one == other).all() for one, other in zip(entry[1:], last[1:]))

    def _after_jump(self, entry, last):
        """The point behind a jump from ``last``: loads held did work, and what is not stored is
        lost."""
        external = self._weights @ (last.forces * (entry.displacements - last.displacements))
        point, before = entry.point, last.point
        left = external - (point.elastic_energy - before.elastic_energy)
        interface, balance = point.interfacial_energy - before.interfacial_energy, "potential"
        if np.isnan(interface):
            # Nearer to the truth than ``viscous_work``, which is kept beside it: velocities end
            # more abruptly than gaps do. But its error may be more than all that is lost, even than
            # nothing.
            interface = point.jump_work
            balance = "unknown" if np.isnan(point.jump_work) else "motion"
            told, viscous = left - interface, point.viscous_work
            if told < 0.0 or 0.0 <= viscous < abs(told - viscous) <= UNSURE * abs(interface):
                # (a motion that loses less than nothing itself tells of its error alone)
                interface = left - max(0.0, viscous)
            if before.fold_precision > LOCATED:
                # The motion ran under another load, which does more than a small jump loses.
                interface = self._bounded(interface, before.state, point.state, left)
        lost = left - interface
        return self._summed(point, before, external, interface, lost, jump_balance=balance)

    def _bounded(self, interface, before, after, left):
        """Work of a jump on the interface as ways without detours do it; where that leaves less
        than nothing to be lost, as the straight one does.

        Parameters
        ----------
        interface : float, what the motion did under another load
        before, after : State, at both ends of the jump
        left : float, what interface and losses take together
        """
        ways = np.array([straight(self.contact, before, after),
                         *corners(self.contact, before, after)])
        works = ways @ self._weights[:ways.shape[1]]
        interface = np.clip(interface, works.min(), works.max())
        return works[0] if interface > left else interface

    def _after_release(self, entry, last):
        """The point out of the law's range at which a force vanishes: too far from ``last`` for a
        quadrature along the branch.

        What the loads do on the way, which is reversible, is what body and interface take up.
        """
        point, before = entry.point, last.point
        interface = point.interfacial_energy - before.interfacial_energy
        if np.isnan(interface):
            # backwards: out of its range the law needs no window to speak of
            back = straight(self.contact, point.state, before.state, FAR_PANELS)
            interface = -float(back @ weights(self.contact, len(back)))
        external = interface + point.elastic_energy - before.elastic_energy
        return self._summed(point, before, external, interface, 0.0)

    def _after_step(self, entry, last):
        """The point behind a step along the branch. The first three steps of a smooth part are each
        integrated from its start."""
        steps = 1 + (last.point.smooth_steps if entry.point.leg == last.point.leg else 0)
        entries = [*self.trail[-min(steps, MOST - 1):], entry]
        first = 0 if steps == len(entries) - 1 else len(entries) - 2
        along = [np.array([getattr(other, name) for other in entries])
                 for name in ("displacements", "forces")]
        point, before = entry.point, entries[first].point
        external = path_work(*along, self._give, self._weights, first,
                             self.contact.kernels.compiled)
        interface = point.interfacial_energy - before.interfacial_energy
        if np.isnan(interface):
            done = between(self.contact, [other.point.state for other in entries], first)
            interface = float(done @ self._weights[:len(done)])
        return self._summed(point, before, external, interface, 0.0, smooth_steps=steps)

    def _summed(self, point, before, external, interface, lost, **changes):
        """The point with the works of an earlier one and those done since, and with other
        changes."""
        imbalance = external - (point.elastic_energy - before.elastic_energy) - interface - lost
        changes |= {name: float(getattr(before, name) + part)
                    for name, part in zip(WORKS, (external, interface, lost, imbalance))}
        return point.changed(**changes)
