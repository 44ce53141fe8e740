"""Where the load of a branch turns, found by arc length to one of its steps: not located."""

from dataclasses import replace

import numpy as np

from . import departures
from .folds import SHORT, FoldSearch

BRACKET = 0.25
"""Part of a leg's first step, and of a fortieth of it, within which a refused step is taken for a
fold, and with which the path goes on behind one."""


def starts(system, fold, beyond):
    """States from which the motion of the jump begins: first that beyond the fold, where the load
    is below the fold's, so that the state without stability lies in between.

    Parameters
    ----------
    system, fold, beyond : as of `departures.starts`
    """
    return [lambda: beyond, *departures.starts(system, fold, beyond)]


class TurnSearch(FoldSearch):
    """A search along the arc that ends as soon as the load falls: the fold is the last point
    before, known to the peak of the parabola through the three points around it. Parameters as of
    `FoldSearch`."""

    def search(self, error, refused=np.inf):
        """As of `FoldSearch`; where the branch goes on past the refused step, so do steps of the
        load."""
        self.initial = min(self.initial, refused)
        return super().search(error, refused)

    def _solved(self, chord, guess, position):
        """As of `FoldSearch`, but what its linear systems tell of modes is left aside: where a
        chord is nearly across the load's own waves, that they eliminate, they tell of these.
        Natural steps and motion tell what is stable."""
        return replace(super()._solved(chord, guess, position), softest=np.nan)

    def _locate(self, trail):
        """Fold, state beyond it, and trail up to it, as of `FoldSearch`; the first two are None
        where the load rises on."""
        trail = self._bracketed(trail)
        if trail[-1][0] >= trail[-2][0]:
            return None, None, trail
        if self._returns(trail):
            return None, None, trail[:-1]
        place, fold = trail[-2]
        return (replace(fold, leg=self.leg.number, step=BRACKET * min(self.leg.initial, SHORT),
                        fold_precision=self._precision(trail[-3:])), trail[-1][1].state,
                trail[:-1])

    def _precision(self, trail):
        """By how much the load may rise beyond the middle of three points, relative to itself:
        twice what the parabola through them does."""
        moving = self.leg.moving
        arc, slopes = self._slopes(trail)
        rise = 0.5 * slopes[1] ** 2 * (arc[2] - arc[1]) / max(slopes[1] - slopes[2], 1e-300)
        load = abs(self.leg.load(trail[1][0])[moving])
        return max(2.0 * rise * abs(self.leg.direction[moving]) / max(load, 1e-3),
                   np.finfo(float).eps)
