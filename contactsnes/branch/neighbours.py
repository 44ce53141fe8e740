"""What continuation asks of states: their combinations, and how far they are from each other."""

import numpy as np

from ..contact import acceptance, combining, states, ways
from ..contact.edges import follow_edge
from ..contact.fronts import fronts_foretold, fronts_moved
from ..contact.scattered import boxed
from ..contact.state import Former


class Neighbours:
    """States of a contact compared and combined, for a class with ``contact`` and ``symmetry``; no
    method solves."""

    leeway = ways.STRAYS

    def adapted(self, point, controls, load):
        """The point as one of a leg: with as many components as there are controls, under its
        controls and load.

        Parameters
        ----------
        point : Point
        controls, load : of each component of the leg
        """
        displacements, forces = (np.append(values, np.zeros(len(controls)))[:len(controls)]
                                 for values in (point.displacements, point.forces))
        state = states.with_components(point.state, len(controls))
        if not self.symmetry.scatters(len(controls)):
            # an archive of another number of processes may have it on the law's nodes alone
            state = boxed(self.contact, state)
        return point.changed(state=self.symmetry.checked(state), controls=controls, load=load,
                             displacements=displacements, forces=forces)

    def lighter(self, points):
        """Points of a branch, oldest first, whose states but the last one's take half the
        memory."""
        lighter = Former.row([point.state for point in points])
        return [point if state is point.state else point.changed(state=state)
                for point, state in zip(points, lighter)]

    def extrapolate(self, points, weights):
        """Weighted sum of states at fixed places."""
        return combining.combined(self.contact, [point.state for point in points], weights)

    def follow_edge(self, points, weights):
        """Weighted sum of states in coordinates that follow the contact edge, or None."""
        known = [point.state for point in points]
        return self.symmetry.mirrored(follow_edge(self.contact, known, weights))

    def fronts_moved(self, first, last):
        """Whether slip fronts moved from one point to another by more than tangents can tell."""
        return fronts_moved(self.contact, first.state, last.state)

    def missed(self, guess, state, largest=False):
        """How far a solve ended from its guess where the law acts, ranges of the law: root mean
        square or largest.

        Parameters
        ----------
        guess, state : State
        largest : whether the largest at a node, not the root mean square
        """
        asked, told = ways.TOLD.get(state, ((), None))
        if not largest and [one() for one in asked[::2]] == [self.contact, guess]:
            return told.moved  # which a step from the one to the other has found
        return states.missed(self.contact, states.with_components(guess, state.components),
                             state, largest)

    def ways(self, guess, last, state):
        """How far a state is from its prediction and from where the step began, ranges of the law
        (``ways.ways``).

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """
        return ways.ways(self.contact, *self._alike(guess, last, state))[:2]

    def strayed(self, guess, last, state):
        """By how much a node ends farther from its prediction than a smooth branch leaves open
        (``acceptance.strayed``).

        Parameters
        ----------
        guess, last, state : State, foretold, before the step and after it
        """
        return acceptance.strayed(self.contact, *self._alike(guess, last, state))

    def adrift(self, guess, last, state):
        """Whether a node ends off its prediction by a large part of the farthest way of the step
        (``acceptance.adrift``).

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """
        return acceptance.adrift(self.contact, *self._alike(guess, last, state))

    def doubtful(self, guess, last, state):
        """Whether a jump may be a part of the way to a state (``acceptance.doubtful``): where slip
        fronts pass, nodes release energy on every way.

        Parameters
        ----------
        guess, last, state : as of `strayed`
        """
        known = self._alike(guess, last, state)
        return (acceptance.doubtful(self.contact, *known)
                and not fronts_foretold(self.contact, *known))

    def detached(self, guess, last, state, back):
        """Whether the tangent at a state hardly leads back to the last one
        (``acceptance.detached``).

        Parameters
        ----------
        guess, last, state : as of `strayed`
        back : State, foretold from ``state`` for where ``last`` is
        """
        return acceptance.detached(self.contact, *self._alike(guess, last, state), back)

    def leapt(self, last, state):
        """Whether nodes that crossed the law released so much on the way to a state that the
        tangent there has to tell of a jump (``acceptance.leapt``).

        Parameters
        ----------
        last, state : State, before the step and after it
        """
        return acceptance.leapt(self.contact, *self._alike(last, state))

    def _alike(self, *found):
        """States with the components of the last of them."""
        count = len(found[-1].means)
        return [state if len(state.means) == count else states.with_components(state, count)
                for state in found]

    def progress(self, origin, ahead, state):
        """How far a state is from ``origin`` towards ``ahead``, as a part of that distance
        (negative: the other way).

        Parameters
        ----------
        origin, ahead, state : State
        """
        return states.progress(self.contact, origin, ahead, state)

    def chord_length(self, first, last):
        """Root mean square way from one state to another where the law acts, ranges of the law."""
        return states.chord_length(self.contact, first, last)
