"""Which steps along a leg are asked for: of the load, of arc length, or both in turn."""

from ..options.fields import InputError
from .arclength import ArcLengthSteps
from .bracketing import BracketingSteps
from .natural import NaturalSteps


class TracedSteps(ArcLengthSteps):
    """Natural continuation to the first fold of a leg, arc length from there on."""

    def __iter__(self):
        last = self.history[-1][1]
        if not last.arc and last.event != "fold":
            self.at_fold = "stop"
            yield from NaturalSteps.__iter__(self)
            if not self.stopped or self.history[-1][1].event != "fold":
                return
            self.at_fold, self.stopped = "trace", False
        yield from super().__iter__()


def refuse(steps, method):
    """InputError where the length of a branch is asked for and the type of SNES solves without a
    tangent."""
    asked = ("-continuation_type is 'arclength'" if steps.type == "arclength" else
             "-continuation_at_fold is 'trace'" if steps.at_fold == "trace" else "")
    if asked and not method.has_tangent:
        raise InputError(f"{asked}, but -snes_type {method.name} has no tangent to "
                         "follow a branch by: allowed are Newton's methods "
                         "(newtonls, newtontr), or natural continuation that "
                         "jumps or stops at a fold")


def stepper(steps, located):
    """The class of steps that ``-continuation_type``, ``_at_fold`` and ``_locate_folds`` ask for.

    Parameters
    ----------
    steps : Steps
    located : whether folds are located unless ``-continuation_locate_folds`` says it
    """
    if steps.type == "arclength":
        return ArcLengthSteps
    if steps.at_fold == "trace":
        return TracedSteps
    located = located if steps.locate_folds is None else steps.locate_folds
    return NaturalSteps if located else BracketingSteps


def others(taken):
    """Options of other ways past a fold than that of a class of steps."""
    if issubclass(taken, ArcLengthSteps):
        return ()
    bracketed = () if issubclass(taken, BracketingSteps) else ("-continuation_locate_folds false",)
    return *bracketed, "-continuation_type arclength"
