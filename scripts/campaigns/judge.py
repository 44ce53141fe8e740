"""Runs a scene in all its variants and judges what came out: the checker on each archive, and the
archives against each other."""

import json
import os
import shlex
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import checker, comparison

HERE = Path(__file__).resolve().parent

OUTCOMES = {"agreed": "all variants agree, and the checker finds nothing",
            "unresolved": "variants differ, where the archive says that the "
            "grid does not resolve the scene, or a fold is "
            "known roughly", "unstable": "variants differ, where the archive says "
            "that points are not stable", "said": "no equilibrium at a load "
            "that was asked for, named (status 1), in all variants "
            "on the same points", "failed": "a failure of the solver, named "
            "(status 1), in all variants on the same points",
            "some": "status 1 with a reason in some variants on the same "
            "points only", "refused": "bad input (status 2) to the scene or one "
            "of its variants, with a reason", "time": "a run did not end within its time",
            "silent": "an archive is wrong, or two differ, and "
            "nothing says so", "crashed": "a traceback, or an end by a signal",}
"""Outcome of a scene -> meaning, from good to bad: the worst of its variants counts."""

FORBIDDEN = ("silent", "crashed")

NAMED = ("no equilibrium", "does not lead to")
"""What a reason says that names the load, no failure of the solver."""


class Worker:
    """A process of `worker`, started anew where it has died.

    Parameters
    ----------
    python : interpreter
    environment : variables besides those of this process
    """

    def __init__(self, python=sys.executable, environment=None):
        self.command = [python, str(HERE / "worker.py")]
        self.environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
                            **(environment or {})}
        self.process, self._beside = None, {}

    def beside(self, environment, python=sys.executable):
        """Another worker, in another environment, kept as long as this one."""
        key = (python, *sorted(environment.items()))
        return self._beside.setdefault(key, Worker(python, environment))

    def start(self):
        """Start the process, unless it runs."""
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, text=True, env=self.environment)
            if self.process.stdout.readline().strip() != "ready":
                raise RuntimeError(f"{self.command[0]} does not start the program")

    def run(self, words, output, seconds, fault=None, **more):
        """`Run` of a command line; ``more`` as `worker` has it."""
        self.start()
        job = {"words": words, "output": str(output), "seconds": seconds, "fault": fault, **more}
        timer = threading.Timer(6.0 * seconds + 30.0, self.process.kill)
        timer.start()
        try:
            self.process.stdin.write(json.dumps(job) + "\n")
            self.process.stdin.flush()
            answer = json.loads(self.process.stdout.readline()
                                or '{"status": -6, "seconds": 0, "clock": 0}')
        except BrokenPipeError:
            answer = {"status": -signal.SIGABRT, "seconds": 0.0, "clock": 0.0}
        finally:
            timer.cancel()
        texts = [Path(f"{output}.{end}").read_text(encoding="utf-8", errors="replace")
                 if Path(f"{output}.{end}").exists() else "" for end in ("out", "err")]
        return Run(words, answer["status"], answer["seconds"], *texts, answer["clock"])

    def close(self):
        """End the process, and those beside it."""
        for other in self._beside.values():
            other.close()
        if self.process is not None and self.process.poll() is None:
            self.process.stdin.close()
            self.process.wait(10)


@dataclass
class Run:
    """How a command ended: its words, exit status (negative: a signal), CPU seconds, what it
    printed, and seconds by the clock."""

    words: list
    status: int
    seconds: float
    out: str
    err: str
    clock: float = 0.0

    @property
    def crashed(self):
        """Whether it ended by a traceback or a signal other than the one of the time limit."""
        return ("Traceback (most recent call last)" in self.err
                or (self.status < 0 and self.status != -signal.SIGKILL)
                or "PETSC ERROR" in self.err)

    @property
    def reason(self):
        """Its sentence on an error, or the last thing that it said."""
        lines = [line for line in self.err.splitlines() if line.strip()]
        errors = [line.partition("error: ")[2] for line in lines if "contactsnes: error: " in line]
        return (errors or lines or [""])[-1]


@dataclass
class Verdict:
    """Outcome of a scene: what was found as (outcome, variant, sentence), points, CPU seconds and
    number of runs, and of variants that were left out."""

    found: list = field(default_factory=list)
    points: int = 0
    seconds: float = 0.0
    runs: int = 0
    left_out: int = 0

    @property
    def outcome(self):
        """The worst of what was found."""
        return max((kind for kind, _, _ in self.found), key=list(OUTCOMES).index, default="agreed")

    def add(self, kind, variant, text):
        """Take something down."""
        self.found.append((kind, variant, " ".join(str(text).split())))

    def differ(self, statuses):
        """Tell ends with status 1 that others on the same points have not from those that all
        have."""
        if 0 in [status for name, status in statuses.items() if name != "twice the points"]:
            self.found = [("some" if kind in ("said", "failed") and name != "twice the points"
                           else kind, name, text) for kind, name, text in self.found]


def variants(scene):
    """Name -> changed options of the runs that must agree with a scene's."""
    options = scene.options
    found = {"longer steps": scene.stepped(4.0), "shorter steps": scene.stepped(0.25)}
    isolated = "scene_spacing" in options
    if options.get("contact_symmetry") != "off":
        found["no symmetry"] = {"contact_symmetry": "off"}
    if (not isolated and options.get("contact_window") != "off"
        and options.get("contact_form") != "force"):
        found["no window"] = {"contact_window": "off"}
    if not isolated:
        other = "displacement" if options.get("contact_form") == "force" else "force"
        found[f"{other} form"] = {"contact_form": other, "contact_first": None}
    found["twice the points"] = scene.finer()
    return found


def judged(scene, worker, folder, seconds=30.0, budget=10.0, only=None, fault=None,
           planted_in=None):
    """The `Verdict` on a scene.

    Parameters
    ----------
    scene : scenes.Scene
    worker : Worker
    folder : of archives and output, which are left there
    seconds : limit of each run, CPU time
    budget : CPU seconds after which no further variant is begun
    only : names of variants, all by default
    fault : planted fault of the runs in ``planted_in`` (all by default; 'scene' is the scene
        itself)
    """
    verdict = Verdict()

    def run(name, changes):
        planted = fault if planted_in is None or name in planted_in else None
        return alone(verdict, name, scene, worker, folder, seconds, changes, planted)

    base, done = run("scene", {"archive_fields": "all"})
    if done.status == 2:
        return verdict
    statuses = {"scene": done.status}
    for name, changes in shuffled(scene, only):
        if verdict.seconds > budget:
            verdict.left_out += 1
            continue
        errors = {} if "archive_errors" not in scene.options else {"archive_errors": None}
        other, again = run(name, {**changes, **errors})
        statuses[name] = again.status
        compared(verdict, name, base, other, done.status == 0 == again.status,
                 lambda: alone(Verdict(), "errors", scene, worker, folder, seconds,
                               {"archive_errors": "true"})[0])
    verdict.differ(statuses)
    return verdict


def shuffled(scene, only):
    """The variants of a scene (those named, if any) in an order of its own: where time ends early,
    it is not always the same ones."""
    order = list(variants(scene).items())
    np.random.default_rng([scene.seed, scene.number, 1]).shuffle(order)
    return [(name, changes) for name, changes in order if only is None or name in only]


def alone(verdict, name, scene, worker, folder, seconds, changes, fault=None):
    """Run a variant of a scene and take down what is wrong with it by itself; (its `Story` or None,
    its `Run`)."""
    archive = folder / f"{name.replace(' ', '-')}.h5"
    archive.unlink(missing_ok=True)
    words = ["run", *scene.words(folder, archive_file=archive, **changes)]
    done = worker.run(words, archive.with_suffix(""), seconds, fault)
    verdict.runs += 1
    verdict.seconds += done.seconds
    return _judged_alone(verdict, name, done, archive), done


def _judged_alone(verdict, name, done, archive):
    """Take down how a run ended and what the checker says; its `Story`, or None."""
    if done.crashed:
        verdict.add("crashed", name, done.reason or f"status {done.status}")
    elif done.status == -signal.SIGKILL:
        verdict.add("time", name, f"after {done.seconds:.0f} s")
    elif done.status in (1, 2):
        named = any(word in done.reason for word in NAMED)
        verdict.add("refused" if done.status == 2 else "said" if named else "failed", name,
                    done.reason)
    elif done.status != 0:
        verdict.add("crashed", name, f"status {done.status}: {done.reason}")
    if done.status in (1, 2) and not done.reason:
        verdict.add("silent", name, f"status {done.status} without a reason")
    if not archive.exists() or done.status == 2:
        if done.status == 0:
            verdict.add("silent", name, "no archive")
        return None
    try:
        for complaint in checker.check(archive, done.status if done.status == 0 else None):
            verdict.add("silent", name,
                        f"{complaint.kind}, point {complaint.point}: {complaint.text}")
        story = comparison.Story(archive)
    except (OSError, KeyError) as error:
        if done.status != -signal.SIGKILL:
            verdict.add("silent", name, f"the archive cannot be read: {error}")
        return None
    if done.status == 0:
        verdict.points += story.count
    return story


def compared(verdict, name, base, other, finished, estimated=lambda: None):
    """Compare a variant with the scene (each a `Story` or None); say why they may differ, if the
    archives do. Where grids differ, the errors that the program tells of the scene decide
    (``estimated``: function () -> its `Story` with them, or None)."""
    if base is None or other is None or not base.count or not other.count:
        if (base is None or not base.count) != (other is None or not other.count):
            verdict.add("some", name, "only one of the two has points")
        return
    resolved, stable = (all(story.known(column) for story in (base, other))
                        for column in ("resolved", "stable"))
    finer = name == "twice the points"
    # On one grid a jump of few nodes (resolved 0) is the same jump, and so is a bend at the edge of
    # the cell; what only a warning covers besides are grids too coarse for the law.
    warnings = base.path.warnings + other.path.warnings
    told = finer and (not resolved or "edge of the cell" in warnings) or "resolve" in warnings
    precise = all(np.max(story.path.get("fold_precision", [0.0])) <= 1e-6
                  for story in (base, other))
    kind = "unresolved" if told or not precise else "silent" if stable else "unstable"
    tolerance, fold = (_expected(base), 0.03) if finer else (1e-6, 1e-6)
    found = comparison.compare(base, other, tolerance, fold, finished)
    if finer and found and kind == "silent":
        found = comparison.compare(base, other, _expected(estimated() or base), fold, finished)
    for sentence in found:
        verdict.add(kind, name, sentence)


def _expected(story):
    """Error that a grid may have: ten times the estimates where they are trusted, else what grids
    that resolve a scene have."""
    if "error_trusted" in story.path and np.all(story.path["error_trusted"] == 1):
        errors = [story.path[f"error_{name}"] for name in ("normal_force", "contact_area", "slip")]
        return float(max(1e-6, 10.0 * np.nanmax(errors)))
    return 0.02


def command(words):
    """A command line that runs the words."""
    return " ".join(map(shlex.quote, ["contactsnes", *words]))
