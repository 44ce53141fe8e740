"""Methods compared on one scene and on equal terms: what each point of a load path costs them, how
exact they are, where they fail.

The path is followed once by Newton's method and its points are solved to rounding: the reference.
Every method then solves every point from the reference's points before it: from the start without
overlap the first one, as a run does, and from the same predicted state the others. So all have the
same path and the same starts, and a failure says something on a method, not on its steps. A
solution that is not the reference's is another branch's: it is marked, and counts in no mean.

All this happens in one process: the methods share the contact, its symbols and what FFTW has
learned, and take turns while the machine is in the same mood. The first pass over the path counts,
the following ones are timed.
"""

import time
from dataclasses import dataclass, field

import numpy as np
from petsc4py import PETSc

from ..branch.first_points import cold
from ..contact.balance import TOLERANCE
from ..continuation.points import NoEquilibrium, NotConverged
from ..options.database import install, petsc_sentence, read
from ..scene.settings import Form
from .recorder import Recorder
from .targets import ERRORS, follow_reference, targets

CONVERGED = "converged"
ELSEWHERE = "another branch"
FAILED = "failed"
NOT_TRIED = "not tried"

COUNTS = ("transforms", "transforms_single", "function_evaluations", "jacobian_products",
          "nonlinear_iterations", "linear_iterations")


@dataclass
class Result:
    """What became of one method at one point.

    counts, first : name -> count, and seconds, in the first pass; times : seconds in each pass that
        is timed
    errors : see ``Target.errors``
    histories : for each pass an array (iterations, 3) of transforms (`weighed`), seconds and
        residual norm, at the points that are watched
    """

    outcome: str = NOT_TRIED
    reason: str = ""
    counts: dict = field(default_factory=dict)
    times: list = field(default_factory=list)
    first: float = np.nan
    errors: tuple = (np.nan,) * len(ERRORS)
    residual_norm: float = np.nan
    histories: list = field(default_factory=list)

    def history(self):
        """The history with the median times of the timed passes, where these went the same way,
        else the last one."""
        timed = self.histories[1:] or self.histories
        same = all(rows.shape == timed[-1].shape for rows in timed)
        return np.median(timed, axis=0) if same else timed[-1]


class Comparison:
    """Methods on the targets of a path.

    Parameters
    ----------
    name : of the scene
    branch : Branch of the scene, from which nothing has been solved
    methods : list of methods.Method
    given : name -> value of all options but those of the methods' files
    settings : CompareOptions
    log : function (sentence)
    """

    def __init__(self, name, branch, methods, given, settings, log):
        self.name = name
        self.branch = branch
        self.methods = methods
        self.given = given
        self.settings, self.log = settings, log
        self.contact = branch.contact
        self.meter = self.contact.grid.counter
        # Watched are the solves of the first point and of the middle one of each leg.
        self.targets = []
        self.watched = []
        self.path_failure = ""
        self.passes = 0
        self.slow = set()
        self.results = {method.name: [] for method in methods}
        names = [method.name for method in methods]
        self.base = "newton" if "newton" in names else names[0]

    def run(self, save):
        """Measure; ``save`` is called without arguments whenever there is more to keep."""
        points, self.path_failure = follow_reference(self.branch, self.given)
        self.targets = targets(self.branch, points)
        self.watched = [places[len(places) // 2] for places in self.stages()]
        worst = max((target.point.residual_norm for target in self.targets), default=np.nan)
        self.log(f"reference: {len(self.targets)} points, residual_norm at most {worst:.1e}"
                 + (f"; the path ends there: {self.path_failure}" if self.path_failure else ""))
        unstable = sum(target.is_unstable() for target in self.targets)
        if unequal := self._unequal():
            self.log(unequal)
        if unstable:
            self.log(f"of these {unstable} are not stable: methods that move as bodies do leave "
                     "them, and what such a method finds counts as another branch")
        self.results = {method.name: [Result() for _ in self.targets] for method in self.methods}
        for number in range(1 + self.settings.repeats if self.targets else 0):
            turn = number % len(self.methods)
            for method in [*self.methods[turn:], *self.methods[:turn]]:
                if method.name in self.slow:
                    continue
                began = time.perf_counter()
                self._follow(method, timed=number > 0)
                if not number:
                    self.log(self.verdict(method))
                    self._time_slow(method, time.perf_counter() - began)
                save()
            self.passes = number
        save()

    def _unequal(self):
        """Which methods stop at another imbalance than the one that ratios are to, in words; ''
        where none does."""
        asked = {method.name: float({**self.given, **method.entries}.get("snes_atol", TOLERANCE))
                 for method in self.methods}
        others = [f"{name} at {atol:g}" for name, atol in asked.items() if atol != asked[self.base]]
        return (f"terms are not equal: {self.base} stops at -snes_atol {asked[self.base]:g}, "
                f"{', '.join(others)}") if others else ""

    def _time_slow(self, method, seconds):
        """Take the first pass of a method for the timed one if it took too long for others."""
        if seconds > self.settings.seconds:
            self.slow.add(method.name)
            for result in self.results[method.name]:
                result.times = [result.first] if result.outcome == CONVERGED else []

    def stages(self):
        """Lists of the places of targets that belong together: the first point, then a list for
        each leg."""
        found = {}
        for place, target in enumerate(self.targets):
            found.setdefault(target.stage, []).append(place)
        return list(found.values())

    def _follow(self, method, timed):
        """Solve the targets by a method, in a timed pass those that it is known to find."""
        # What symmetry saves is no merit of a method: Newton's and relaxation have it, others not,
        # so that it has to be asked for.
        install({"contact_symmetry": "off", **self.given, **method.entries})
        form = read(Form)
        failures = 0
        corrector = None
        for place, (target, result) in enumerate(zip(self.targets, self.results[method.name])):
            if failures >= self.settings.failures or timed and result.outcome != CONVERGED:
                continue
            corrector = corrector or Recorder(self.contact, form)
            point, reason, spent = self._solve(corrector, target)
            if place in self.watched:
                result.histories.append(corrector.history.rows())
            if point is None:
                # What ended by an exception may have left PETSc's objects in disorder.
                failures, corrector = failures + 1, None
            if timed:
                result.times.append(spent["wall_time"])
            else:
                result.reason, result.counts = reason, {name: spent[name] for name in COUNTS}
                result.first = spent["wall_time"]
                self._judge(target, result, point)

    def _judge(self, target, result, point):
        """Set the outcome and, where there is a point, its errors."""
        result.outcome = FAILED
        if point is not None:
            result.errors = target.errors(self.contact, point)
            result.residual_norm = point.residual_norm
            result.outcome = CONVERGED if target.is_found(result.errors[0],
                                                          point.residual_norm) else ELSEWHERE

    def _solve(self, corrector, target):
        """A target's point by a method, or None; the reason why not; and what was spent."""
        point = None
        reason = ""
        wanted = target.point
        self.meter.limit = self.meter.weighed + self.settings.transforms
        corrector.account()
        corrector.history.restart()
        try:
            with np.errstate(all="ignore"):
                point = (cold(corrector, wanted.controls, wanted.load) if target.guess is None
                         else corrector.solve(target.guess, wanted.controls, wanted.load))
        except Exception as error:  # whatever it is, it is how this method fails
            reason = self._reason(error)
        self.meter.limit = np.inf
        return point, reason, corrector.account()

    def _reason(self, error):
        """What ended a solve, in one line."""
        if self.meter.weighed > self.meter.limit:
            return f"more than {self.settings.transforms:.0f} transforms"
        if isinstance(error, PETSc.Error):
            return petsc_sentence(error)
        words = " ".join(str(error).split())
        return words if isinstance(error, (NotConverged, NoEquilibrium,
                                           ValueError)) else f"{type(error).__name__}: {words}"

    def loads(self, target):
        """Controlled values of a target in words."""
        point = target.point
        return self.branch.scene.loads(point.controls, point.load)

    def finished(self, method):
        """Whether a method found every point of a path that has an end."""
        results = self.results[method.name]
        return not self.path_failure and bool(results) and all(result.outcome == CONVERGED
                                                               for result in results)

    def verdict(self, method):
        """How a method did, in words."""
        results = self.results[method.name]
        text = (f"{method.name}: {sum(result.outcome == CONVERGED for result in results)} "
                f"of {len(results)} points")
        for outcome in (FAILED, ELSEWHERE):
            places = [place for place, result in enumerate(results) if result.outcome == outcome]
            if places:
                first = places[0]
                reason = f" ({results[first].reason})" if results[first].reason else ""
                text += (f"; {len(places)} {outcome}, first at "
                         f"{self.loads(self.targets[first])}{reason}")
        return text
