"""Where a branch has events or an end: gaps and slips over their thresholds, forces that no law
balances."""

from dataclasses import replace

import numpy as np

from ..contact import nearing, states, survey
from ..contact.problem import FORCE
from ..interface.laws.law import slip_of
from ..scene.resolution import PINNING, resolution

FAR = 8.0
"""Slip, in ranges, beyond which the law's traction is its residual one to rounding."""
LEVEL = 1e-7
"""Slope of the friction over its peak up to which it no longer depends on the slip."""
ONWARD = 0.1
"""Further slip, ranges, at which it does not either: at its peak friction has no slope."""
SLACK = 1e-6
"""Traction over the law's peak, or change of it, that is none: what a solve leaves of a balance is
less."""

DEEP = 0.95
"""Part of the deepest gap of which a law tells that a path's last point has where it ended there:
steps are made shorter until they are a millionth of a leg."""


def of_law(contact, last):
    """What there is to say where a path ended at the deepest gap of which the law tells; else an
    empty text.

    Parameters
    ----------
    contact : Contact
    last : Point, the last one; None before the first
    """
    closest = np.inf if last is None else contact.survey(last.state).closest
    if closest > DEEP * contact.law.deepest:
        return ""
    return (f"the last point has a gap of {closest:.3g} delta_n, nearly the deepest of which the "
            "law tells: slip, or the law itself, has left too little repulsion for what presses "
            "the body; end the path here, or press less")


class Ends:
    """Events and ends of branches of a contact, for a class with ``contact`` and ``solve``."""

    def margin(self, point, event):
        """What is at least 0 where there is an event, 'pull_off' or 'gross_sliding': a gap or slip
        over its threshold, ranges."""
        gap = states.normal_gap(self.contact, point.state)
        threshold = self.contact.scene.contact_threshold
        if event == "pull_off":
            return float(self.contact.grid.minimum(gap) - threshold)
        slip = slip_of(point.state.displacement)
        return float(self.contact.grid.minimum(slip, where=gap < threshold, initial=1e3)
                     - np.nextafter(self.contact.law.slip_peak, np.inf))

    def stride(self, point, direction):
        """Length along a branch in which the edge that moves fastest, of contact or slip, passes a
        node of a line.

        0 in the plane, whose edges pass nodes here and there, and on grids that are known to pin.
        """
        scene = self.contact.scene
        if scene.dimension == 2 or max(resolution(scene, len(point.controls) > 1)) > PINNING:
            return 0.0
        state, window = point.state, direction.state.window
        field, moved = states.onto(state, window).copy(), direction.state.displacement
        field[0] += window.take(self.contact.initial_gap)
        node = np.unravel_index(np.argmax(np.abs(np.where(field[0] < states.NEAR, moved, 0.0))),
                                moved.shape)
        steps = np.gradient(field[node[0]].reshape(len(window.parts), -1), axis=1).reshape(-1)
        return float(abs(steps[node[1]] / moved[node]))

    def end_of_branch(self, point, leg, heading):
        """Why a branch has nothing to offer beyond a point whose load goes on (1) or back (-1), in
        words, or "".

        Parameters
        ----------
        point, leg : Point, Leg
        heading : 1 or -1
        """
        gap = states.normal_gap(self.contact, point.state)
        free = point.controls[0] == FORCE or heading < 0.0
        if free and not point.in_contact and self.contact.grid.minimum(
                gap) > self.contact.law.range:
            return "it has left the range of the law"
        pressed = heading * leg.direction[0] > 0.0
        if (point.controls[0] == FORCE and point.in_contact and not pressed
            and self._acts_nowhere(point.state)):
            return "slip has taken what held the surfaces together"
        if FORCE in point.controls[1:] and point.in_contact:
            slip = slip_of(point.state.displacement)
            touching = gap < self.contact.scene.contact_threshold
            if self.contact.grid.minimum(slip, where=touching) > FAR:
                return "the whole contact slides without end"
        return ""

    def pulled_away(self, point, leg):
        """Why a leg whose force pulls a body out of the law's range has no equilibrium, in words,
        or "": branches that come from there, out of touch under a pull, begin infinitely far away,
        and none is the body's.

        Parameters
        ----------
        point, leg : Point, Leg
        """
        pulled = leg.controls[0] == FORCE and leg.direction[0] < 0.0 and not point.in_contact
        away = pulled and self.contact.grid.minimum(
            states.normal_gap(self.contact, point.state)) > self.contact.law.range
        return ("nothing holds a body that is pulled out of the law's range; a leg before this one "
                "that presses brings it into contact") if away else ""

    def end_of_attraction(self, point, leg, position):
        """The fold, at its position, of a body that a growing force moves off the flat or where
        slip has left nothing but repulsion, or of one that glides, under a falling force or pressed
        on; None for any other.

        A gliding body is held by its residual friction wherever it is, and by no force below.

        Off the flat a body is attracted only, and less the farther it is away: as the force grows
        to zero, equilibria end out of the law's range, whatever the steps that led there.

        Parameters
        ----------
        point, leg : Point, Leg
        position : of the point in the leg
        """
        pull = leg.direction[1:] @ point.forces[1:]
        left = point.event == "jump" and point.leg == leg.number  # where it is held no better
        if (pull < 0.0 or pull == 0.0 < leg.direction[0]) and not left and self._glides(point):
            return replace(point, position=position, fold_kind="sliding")
        if point.controls[0] != FORCE or leg.direction[0] <= 0.0:
            return None
        if point.in_contact:
            loose = not left and self.neutral(point) == 0
            return replace(point, position=position, fold_kind="jump_in") if loose else None
        if leg.moving != 0:
            return None
        if self.contact.grid.minimum(states.normal_gap(self.contact,
                                                       point.state)) > self.contact.law.range:
            return replace(point, position=position)
        position = -leg.start[0] / leg.direction[0]
        load = leg.load(-leg.start[0] / leg.direction[0])
        if position > 1.0:
            return None
        load[0] = 0.0
        away = states.with_components(states.apart(self.contact), len(load))
        away.displacement[1:], away.means[1:] = point.state.means[1:, None], point.state.means[1:]
        return replace(self.solve(away, leg.controls, load), position=position)

    def within_range(self, point):
        """A state that feels the law of a body that a force moves freely, off the flat, or that
        glides, or that is pressed where nothing holds it any more; None for any other."""
        if self._glides(point):
            return nearing.held(self.contact, point.state)
        if point.controls[0] == FORCE and not point.in_contact:
            return nearing.within_range(self.contact, point.state)
        if point.fold_kind == "jump_in" and self.neutral(point) == 0:
            return nearing.touching(self.contact, point.state)
        return None

    def neutral(self, point):
        """The component of a body in contact that a force holds, and in which it may be moved as a
        whole, off the flat or on the way it slid, to other equilibria: no traction changes that a
        force balances. None for any other.

        Parameters
        ----------
        point : Point
        """
        contact, state = self.contact, point.state
        forced = [i for i, control in enumerate(point.controls) if control == FORCE]
        # what is pressed down, or sticks, is held
        free = [i for i in forced if (point.sliding if i else
                                      contact.survey(state).pressure < SLACK)]
        if not point.in_contact or not free:
            return None
        gap, law = survey.gaps(contact, state), contact.law
        before = law.traction(gap)
        least = SLACK * np.array([law.normal_peak, *[law.friction_size] * (len(gap) - 1)])
        for i in free:
            moved, changed = gap.copy(), 0.0
            for step in (ONWARD, 1.0 - ONWARD):
                moved[i] += np.copysign(step, state.means[i] if i else 1.0)
                changed = max(changed, contact.grid.maximum(np.abs(
                    law.traction(moved) - before)[forced] / least[forced, None], initial=0.0))
            if changed < 1.0:
                return i
        return None

    def _acts_nowhere(self, state):
        """Whether the law neither pulls nor pushes at any gap around a state's, to rounding: slip
        has exhausted it."""
        contact, least = self.contact, LEVEL * self.contact.law.normal_peak

        def acting(values):  # (a process may have no nodes)
            return contact.grid.maximum(np.abs(values), initial=0.0) >= least

        return not (acting(survey.tractions(contact, state)[:1]) or acting(
            contact.law.tangent(survey.gaps(contact, state))[0, 0]))

    def _glides(self, point):
        """Whether a body in contact that a tangential force moves slips so far everywhere that its
        friction no longer depends on the slip, not where it overlaps most either: friction may
        grow with the overlap as fast as it falls with the slip."""
        if FORCE not in point.controls[1:] or not point.in_contact:
            return False
        gap = states.normal_gap(self.contact, point.state)
        touching = gap < self.contact.scene.contact_threshold
        least = self.contact.grid.minimum(slip_of(point.state.displacement), where=touching)
        deepest = min(self.contact.grid.minimum(gap), 0.0)
        law, places = self.contact.law, np.array([[deepest] * 2, [least, least + ONWARD]])
        slopes = np.abs(law.tangent(places)[1, 1])
        return least > law.slip_peak and slopes.max() < LEVEL * law.friction_size
