"""How motions end that do not come to rest: some have no end, since the body leaves, sinks in or
slides, or since friction gives and takes work, so that it has a cycle to go round in."""

import numpy as np

BEGIN = 64
"""Steps after which a state is first kept; the next ones after twice, four times ... as many
(Brent 1980, BIT 20, 176)."""
NEAR, FAR = 2.0, 5.0
"""Steps' lengths within which a motion has come back to a state, and beyond which it had left
it."""
TIMES = 3
"""Returns to one state that tell of a cycle."""
SAME = 0.02
"""Part of a round's extent that the last one differs by at most: more of a spiral, inwards to where
it rests, or outwards from an unstable state to somewhere else."""


class Unsettled(RuntimeError):
    """A motion that cannot be followed to its end; the message says why."""


class Circling(Unsettled):
    """A motion that goes round and round."""


class Leaving(RuntimeError):
    """A motion without an end: the body leaves, sinks in or slides for ever."""


class Rounds:
    """Tells from its steps whether a motion goes round and round.

    Attributes
    ----------
    period : of a round, relaxation times, once `closed` has found one
    """

    def __init__(self):
        self.period, self._steps, self._keep = 0.0, 0, BEGIN
        self._kept = None

    def closed(self, moment, moved, size):
        """Whether a step ends one round too many.

        Parameters
        ----------
        moment : step_works.Moment, where it ends
        moved : float, its length
        size : function (change of the unknown) -> length, in the same unit
        """
        self._steps += 1
        if self._steps >= self._keep:
            self._keep *= 2
            # (half the memory; steps of a round are far longer than what rounding misses)
            self._kept = moment.unknown.astype(np.float32)
            self._farthest, self._returns = 0.0, []
            return False
        if self._kept is None:
            return False
        away = size(moment.unknown - self._kept)
        self._farthest = max(self._farthest, away)
        if not (away < NEAR * moved and self._farthest > FAR * moved):
            return False
        self._returns.append((moment.time, self._farthest))
        self._farthest = 0.0
        times, extents = np.transpose(self._returns)
        if len(times) < TIMES or abs(extents[-1] - extents[0]) > SAME * extents[0]:
            return False
        self.period = float(times[-1] - times[0]) / (len(times) - 1)
        return True

    def forget(self):
        """Begin anew, as on another window."""
        self._kept = None
