"""Which walk along a leg is asked for: by steps of the load, by arc length, or by both in turn."""

from ..options.fields import InputError
from .arclength import ArcWalk
from .natural import Walk


class Trace(ArcWalk):
    """Natural continuation to the first fold of a leg, arc length from there on."""

    def __iter__(self):
        last = self.history[-1][1]
        if not last.arc and last.event != "fold":
            self.at_fold = "stop"
            yield from Walk.__iter__(self)
            if not self.stopped or self.history[-1][1].event != "fold":
                return
            self.at_fold, self.stopped = "trace", False
        yield from super().__iter__()


def refuse(steps, solver):
    """InputError where the length of a branch is asked for and the type of SNES solves without a
    tangent."""
    asked = ("-continuation_type is 'arclength'" if steps.type == "arclength" else
             "-continuation_at_fold is 'trace'" if steps.at_fold == "trace" else "")
    if asked and not solver.startswith("newton"):
        raise InputError(f"{asked}, but -snes_type {solver} has no tangent to "
                         "follow a branch by: allowed are Newton's methods "
                         "(newtonls, newtontr), or natural continuation that "
                         "jumps or stops at a fold")


def walker(steps):
    """The class of walks that ``-continuation_type`` and ``-continuation_at_fold`` ask for."""
    if steps.type == "arclength":
        return ArcWalk
    return Trace if steps.at_fold == "trace" else Walk
