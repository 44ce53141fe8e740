"""What is said of points, and marked at them, where nobody asked for certificates: by-products of
solves that tell of instability."""

from dataclasses import replace

import numpy as np

from ..contact.problem import DISPLACEMENT, FORCE
from ..continuation.points import left_over
from ..dynamics.stability import SIGN, Stability
from .failures import PASSED

DILUTED = 100.0
"""Largest imbalance of a node over the tolerance of their root mean square from which on a run says
so: that of one node alone, were it all there is, in a window of 10^4 unknowns."""


class Remarks:
    """Remarks on the points of a branch, in their order.

    Parameters
    ----------
    corrector : Tracer
    certified : whether points have certificates of their stability, so that by-products need not
        tell of it
    has_tangent : whether the method has a tangent whose modes can be found
    log : function (sentence)
    last : Point before the first one, if any

    Attributes
    ----------
    beginning : Point that the leg under way set out from, as long as no point of it is known to be
        stable; else None
    """

    def __init__(self, corrector, certified, has_tangent, log, last=None):
        self.corrector = corrector
        self.certified = certified
        self.has_tangent = has_tangent
        self.last = last
        self.leg = None
        self.beginning = last
        self._log = log
        self._ways = {}
        self._diluted = False
        self._released = None  # the last leg that was told to begin at an unstable point
        self._free = set()

    def marked(self, point):
        """A point with what by-products tell of its stability; from now on the last one."""
        point = self._neutral(self._not_held(self._going_on(self._not_stable(point))))
        first = self.last is None or point.leg != self.last.leg
        if point.stable > 0 or point.event == "jump" or first and point.stable < 0:
            self.beginning = None
        self.last = point
        self._tell_of_dilution(point)
        return point

    def _tell_of_dilution(self, point):
        """Say once that a node is much worse balanced than the mean over the window's, which may be
        far more than the contact's."""
        # nothing is solved for further events at a point of an earlier run
        if self._diluted or self.corrector.form is None:
            return
        if point.largest_residual > DILUTED * self.corrector.allowed:
            self._diluted = True
            self._log("a node where the law acts is out of balance by "
                      f"{point.largest_residual:.1e} ranges (largest_residual), at a "
                      f"residual_norm of {point.residual_norm:.1e} over a window "
                      f"of {point.state.window.total} nodes: the mean hides what "
                      "is wrong in a few of them; a smaller -snes_atol "
                      "balances these, too")

    def unstable_since(self):
        """Why the last point is unstable, where it is, and what to do, in words."""
        if released(self.beginning, self.leg):
            return (" now that a force holds what a displacement held: begin the leg where that "
                    "force rises with its displacement, or the path under a force, as with "
                    "-load_start normal_force=0")
        return PASSED + ("" if self.certified else ", which -continuation_stability sign finds")

    def _neutral(self, point):
        """A point marked as not stable, and told once, where nothing holds the body as a whole."""
        component = self.corrector.neutral(point)
        if component is None:
            return point
        if component not in self._free:
            self._free.add(component)
            self._log(f"at {self.corrector.told(point.controls, point.load)} nothing holds the "
                      f"body {'along' if component else 'to'} the flat: moved as a whole "
                      f"{'on its way' if component else 'off it'}, by up to a range of the law, it "
                      "is in equilibrium under the same forces. This point is one of many, "
                      "neither stable nor unstable, and the way there decides on which; a "
                      f"{'tangential' if component else 'normal'} displacement that is prescribed "
                      "in place of the force tells them apart")
        return point.changed(stable=0)

    def begun(self, leg):
        """Say what a leg that begins, or goes on, at the last point makes of it; from now on the
        one under way."""
        self._tell_of_reversal(leg)
        self._tell_of_release(self.last, leg)
        if self.leg is None and not self.certified:
            self._leave_symmetry()
        self.leg, self.beginning = leg, self.last

    def _leave_symmetry(self):
        """Take states for even no more where an earlier run did not, whose last point is not
        stable."""
        last = self.last
        if (last.stable == 0 and self.has_tangent and self.corrector.examiner
                and self.corrector.symmetry.holds(len(last.controls))):
            self._unstable_modes(last)

    def _unstable_modes(self, point):
        """How many modes of a point are unstable, whatever its event; -1 where they are not found.
        States are taken for even no more if one of them is not."""
        return self.corrector.examiner(replace(point, event=None, tangents=())).unstable_modes

    def _tell_of_reversal(self, leg):
        """Say once that a tangential load which turns back makes no hysteresis by itself."""
        if self._ways is None or leg.left_over:
            return
        ways = {component: np.sign(way) for component, way in enumerate(leg.direction) if component
                and way}
        turned = any(way * self._ways.get(component, way) < 0 for component, way in ways.items())
        self._ways = None if turned else self._ways | ways
        if turned:
            self._log(f"leg {leg.number} takes a tangential load back: these "
                      "laws have no memory, so that a path without "
                      "folds retraces itself and shows no frictional "
                      "hysteresis; energy is lost in jumps only")

    def _tell_of_release(self, last, leg):
        """Say of a leg that releases a displacement whether it begins at an unstable point.

        Where nobody checks stability, and only there; of a leg that moves but the force that it
        releases the first step tells at no cost.
        """
        free, moving = released(last, leg), tuple(np.flatnonzero(leg.direction))
        if (self.certified or last.leg == leg.number or not (free and self.has_tangent)
            or free == moving == free[:1]):
            return
        begun = replace(self.corrector.adapted(last, leg.controls, leg.start), event=None,
                        tangents=())
        found = (self.corrector.examiner or Stability(self.corrector, SIGN, told=True))(begun)
        if found.unstable_modes > 0:
            self._released = leg.number
            self._log(f"leg {leg.number} begins on an unstable part of the "
                      f"branch: at {self.corrector.told(leg.controls, leg.start)} "
                      f"{found.unstable_modes} modes are unstable now that a "
                      "force holds what a displacement held; "
                      "-continuation_stability sign certifies points")

    def _not_stable(self, point):
        """A first point, the end of a jump or of a leg marked, and told, where it is not stable and
        nobody checks: its linear solves tell, but of half a surface not of modes that are odd."""
        begins = point.leg == 0 or point.event == "jump"
        ends = point.position == 1.0 and not point.event
        hidden = (self.has_tangent and point.state.half is not None
                  and not self.corrector.contact.convex)
        if self.certified or self.corrector.examiner is None or not (
                begins and point.softest < 0.0 or hidden and (begins or ends)):
            return point
        modes = self._unstable_modes(point)
        if modes <= 0:
            return point
        what = ("the end of a jump" if point.event == "jump" else "the first point" if begins
                else f"the end of leg {point.leg}")
        self._log(f"{what}, at {self.corrector.told(point.controls, point.load)}, is not "
                  f"stable: {modes} modes are unstable; -continuation_stability "
                  "sign certifies points, and follows jumps on")
        return replace(point, stable=0, unstable_modes=modes)

    def _going_on(self, point):
        """A point marked, if nobody checks stability, where the last one of its leg was not stable
        and its linear solves tell of an unstable mode, too."""
        last = self.last
        on = (last is not None and last.leg == point.leg and last.stable == 0
              and not (last.event or point.event))
        return point.changed(stable=0) if on and point.stable < 0 and point.softest < 0.0 else point

    def _not_held(self, point):
        """A point marked where the force that moves does not hold the body, if nobody checks
        stability; told where its leg begins there.

        A displacement that goes against its force does so on an unstable part of the branch: what
        was stable while the displacement was held need not be so under the force.
        """
        last = self.last
        if self.certified or last is None or point.event == "jump":
            return point
        if point.state is last.state and point.leg == last.leg and point.event != "fold":
            return replace(point, stable=last.stable)
        count = len(last.controls)
        forced = np.array([control == FORCE for control in point.controls[:count]])
        moved = point.displacements[:count] - last.displacements
        changed = point.forces[:count] - last.forces
        if point.leg != last.leg and forced.any() and left_over(changed[forced],
                                                                point.forces[:count][forced]):
            return point  # no way to go against
        # a half-plane as a whole has no displacement (nan), and does not go against anything
        if (moved[~forced] != 0.0).any() or not changed[forced] @ moved[forced] < 0.0:
            return point
        if point.leg not in (last.leg, self._released):
            self._log(f"leg {point.leg} begins on an unstable part of the "
                      f"branch: at {self.corrector.told(point.controls, point.load)} the "
                      "displacement goes against the force; -continuation_stability "
                      "sign tells more" + ("; with -load_start normal_force=0 the path begins "
                                           "under a force" if point.leg == 1 and forced[0] else ""))
        single = np.count_nonzero(changed[forced]) == 1 and point.event != "fold"
        return replace(point, stable=0) if single else point


def released(last, leg):
    """Components in which a leg lets a force hold what at a point a displacement holds; both may be
    None."""
    if last is None or leg is None:
        return ()
    return tuple(i for i, ways in enumerate(zip(last.controls, leg.controls))
                 if ways == (DISPLACEMENT, FORCE))


def unmarked(points):
    """Points without what by-products told of their stability, as steps go on from them."""
    return [point.changed(stable=-1, unstable_modes=-1) for point in points]
