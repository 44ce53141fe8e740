"""Folds of a branch: limit points of the load, searched for by arc length."""

from dataclasses import replace

import numpy as np

from .points import NotConverged, lagrange_weights

FOLD_TOLERANCE = 1e-6
"""Relative accuracy in the load to which a fold is located; a step of the search promises less than this."""


class Turn:
    """Arc-length search for the fold beyond the last point of a leg: the load is one more unknown of the solve."""

    def __init__(self, system, leg, history, most=60):
        self.system, self.leg, self.history, self.most = system, leg, list(history), most

    def search(self, error):
        """(fold point, state beyond it, None), or (None, None, point) where the branch goes on past the trouble.

        Raises NotConverged (``error`` again) where no solution can be followed any further.
        """
        trail = self._trail()
        reach = self.history[-1][0] + self.leg.initial
        first = length = self.system.distance(trail[0][1].state, trail[1][1].state)
        for taken in range(self.most):
            try:
                point = self._ahead(trail, length)
            except NotConverged as second:
                length *= 0.25
                if length < 1e-4 * first:
                    raise NotConverged(f"{error}; following the branch by arc length failed too: {second}") from None
                continue
            trail.append((point.position, point))
            arc, slope = self._slopes(trail[-3:])
            if slope[2] <= 0.0:
                found, trail = self._locate(trail[-3:])
                if found is not None:
                    return (*found, None)
                continue
            steady = slope[2] > 0.7 * slope[1]
            if steady and (point.position >= 1.0 or (point.position > reach and taken > 6)):
                return None, None, self._natural(trail, min(point.position, 1.0))
            length *= 1.7 if steady and point.spent["last_iterations"] <= 6 else 1.0
        raise NotConverged(f"{error}; arc length made no headway either")

    def _slopes(self, trail):
        """Places on the arc of three points, and d(position)/d(arc length) there by the parabola through them."""
        distance = self.system.distance
        arc = np.array([-distance(trail[0][1].state, trail[1][1].state), 0.0,
                        distance(trail[1][1].state, trail[2][1].state)])
        curvature, slope, _ = np.polyfit(arc, [place for place, _ in trail], 2)
        return arc, slope + 2.0 * curvature * arc

    def _trail(self):
        """The last two points, made by a tiny tangent step where the leg has only begun."""
        if len(self.history) > 1:
            return [(position, point) for position, point in self.history[-2:]]
        here, last = self.history[-1]
        step = max(self.leg.smallest, 1e-3 * self.leg.initial)
        guess = self.system.along_tangent(last, self.leg, here, step)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(here + step))
        return [(here, last), (here + step, point)]

    def _ahead(self, trail, length):
        """The point at a given arc length beyond the last two."""
        (before, first), (here, last) = trail[-2:]
        return self._at(last, here, first, before, length)

    def _at(self, last, here, first, before, length):
        """The point at arc length ``length`` from ``last`` in the direction from ``first`` to it."""
        point, position = self.system.solve_arc(first.state, last.state, before, here, length, self.leg)
        return replace(point, leg=self.leg.number, position=position)

    def _natural(self, trail, target):
        """A point at a given place of the leg, from two neighbours on the branch."""
        weights = lagrange_weights([place for place, _ in trail[-2:]], target)
        guess = self.system.extrapolate([point for _, point in trail[-2:]], weights)
        point = self.system.solve(guess, self.leg.controls, self.leg.load(target))
        return replace(point, leg=self.leg.number, position=target, step=self.leg.initial)

    def _locate(self, trail):
        """((fold, state beyond it), trail) from three points on the arc, the load's peak near the last, refined by parabolas.

        The first is None where the load goes on rising: a bend may look like a peak.
        """
        trail = self._bracketed(trail)
        if trail[2][0] >= trail[1][0]:
            return None, trail
        beyond = trail[2][1]
        for _ in range(12):
            arc, slopes = self._slopes(trail)
            curvature = (slopes[2] - slopes[0]) / (arc[2] - arc[0]) / 2.0
            shift = -0.5 * slopes[1] / curvature
            if abs(curvature) * shift ** 2 * self._scale() < FOLD_TOLERANCE:
                break
            toward = 0 if shift < 0.0 else 2
            try:
                found = self._at(trail[1][1], trail[1][0], trail[toward][1], trail[toward][0], -abs(shift))
            except NotConverged:
                break
            between = [trail[0], (found.position, found), *trail[1:]] if shift < 0.0 else \
                [*trail[:2], (found.position, found), trail[2]]
            best = 1 if between[1][0] > between[2][0] else 2
            trail = between[best - 1:best + 2]
        fold = max(trail, key=lambda item: item[0])[1]
        return (replace(fold, step=self.leg.initial), beyond.state), trail

    def _bracketed(self, trail):
        """The last three points after going on along the arc until the load falls, or for eight steps."""
        length = 0.5 * self._slopes(trail)[0][2]
        for _ in range(8):
            if trail[2][0] < trail[1][0]:
                break
            try:
                ahead = self._ahead(trail, length)
            except NotConverged:
                length *= 0.25
                continue
            trail = [*trail[1:], (ahead.position, ahead)]
        return trail

    def _scale(self):
        """Relative change of the moving load per change of position."""
        moving = self.leg.moving
        reached = self.leg.load(self.history[-1][0])[moving]
        return abs(self.leg.direction[moving]) / max(abs(reached), 1e-3)
