"""The runs behind the figures: what each one is, how they are made, and their archives.

Every run is one command, as a rule ``contactsnes run``, with the options of `Run.options`; its
archive and what it said lie in the folder of results, and a run whose archive is complete is not
made again. Lengths are in beta, normal displacements in u_n,r, tangential ones in u_t,r, forces in
w_n,r and w_t,r, as everywhere.
"""

import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from forked import called
from starter import Starter

from contactsnes import Scene, reference
from contactsnes.output.files import ArchiveError, open_archive
from contactsnes.output.reading import Record, read
from contactsnes.scene.resolution import resolution

ROOT = Path(__file__).resolve().parents[2]
LAWS = {"mcgarry": {"law": "mcgarry"}, "full": {"residual_friction": 1.0},
        "half": {"residual_friction": 0.5}}
"""Name of a law -> its options: eq. 3; eq. 5 with tau_inf = tau_max; eq. 5 with tau_inf =
tau_max/2."""
RESIDUALS = (0, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1)
"""Residual over largest friction, rho, of the map of regimes."""
NORMAL = (3, 10, 20)
"""Normal Maugis parameters of figure 4."""
TANGENTIAL = (0.1, 1, 10)
"""Tangential Maugis parameters of figures 5 and 7."""
MORE_TANGENTIAL = (0.1, 0.2, 0.36, 1, 2, 3.6, 6, 10, 14)
"""Tangential Maugis parameters of figure 6."""
LOADS = (0.8, 25)
"""Normal forces of figures 5 and 6."""
MAPPED = (0.1, 0.2, 0.36, 0.6, 1, 1.4, 2, 3.6, 6, 10, 14)
"""Tangential Maugis parameters of the map of regimes."""
PROFILED = {("half", 10, 25): (825, 1880, 2935, 3990)}
"""(law, tangential parameter, normal force) -> displacements of the top that a run stops at: its
front goes so far in a step that profiles of two runs compare at the same ones only."""
MORE_LOADS = (-1, 0, 0.8, 3, 6, 10.4, 16, 25)
"""Normal forces of figure 7; for a tangential parameter of 10 every second one."""
PERIOD = 100.0
DRIVE = reference.drive_stiffness(PERIOD, 2000.0)
"""Stiffness of the drive, force over displacement of the top."""
USED = " s of processor time"
"""End of the line of a log that tells what a command took."""
SHARES = 16
"""Parts in which archives are read."""
FINER = "-x2"
"""End of the names of runs on twice the points."""

ENDS = {0: "", 1: ", ended early", 2: ", bad input"}
"""Exit status of a run that has come to its end -> what is told of it; with another one it was
interrupted, and goes on the next time."""


class Run(NamedTuple):
    """A run: its name, its options, name -> value, and whether its grid may be refined: where it is
    too coarse to finish, and for a second run on twice the points, which tells the errors of the
    grid. ``program`` is what takes the options, arguments of Python."""

    name: str
    options: dict
    finer: bool = True
    program: tuple = ("-m", "contactsnes", "run")

    def arguments(self):
        """The options as words of a command."""
        return [word for name, value in self.options.items() for word in (f"-{name}", str(value))]

    def on(self, size, **options):
        """The run on another number of points, with some other options."""
        return self._replace(options={**self.options, "scene_points": size, **options})


def points(least=8192, between=False, **scene):
    """Least power of two of points, or three times one of them (``between``), that resolves the
    cohesive zone of a scene, sheared where it has a tangential parameter."""
    ratio = max(resolution(Scene(**{**scene, "points": 8192}), "tangential_maugis" in scene))
    double = 2 ** (13 + int(np.ceil(np.log2(ratio) - 1e-9)))
    enough = double * 3 // 4 if between and 8192 * ratio <= double * 3 // 4 else double
    return max(least, enough)


def half_width(force):
    """Half width of the JKR contact in the cell."""
    return reference.jkr_line_half_width(force, PERIOD)


def pressed(maugis):
    """Normal loading without shear: from above W = 25 down by the forces of the figures to
    pull-off, figures 3 and 4."""
    scene = {"normal_maugis": float(maugis)}
    return Run(f"pressed-n{maugis}", {**{f"scene_{name}": value for name, value in scene.items()},
                                      "scene_points": points(**scene),
                                      "load_start": "normal_displacement=40",
                                      "load_path": "normal_force=25; normal_force=10.4; "
                                      "normal_force=0.8; normal_displacement=-8",
                                      "continuation_initial_step": "0.5,0.5,0.5,0.1",
                                      "continuation_largest_step": "1.5,1.5,0.6,0.2",
                                      "continuation_at_fold": "stop",
                                      "continuation_stability": "sign", "archive_fields": "all"})


def strength(law, maugis, force):
    """A tangential force that is surely beyond the onset of sliding."""
    width = 2 * half_width(force) + 1.0 / np.sqrt(maugis)
    carried = reference.peak_tangential_traction(maugis) * width
    if law == "mcgarry":
        # Under pressure eq. 3 holds more than tau_max.
        return min(1.5 * carried if maugis < 1 else carried,
                   1.75 * reference.ligament_force(half_width(force), PERIOD))
    return carried


def sheared(law, maugis, force, *, control="displacement", fields="none", beyond=None, suffix="",
            **scene):
    """A contact that is pressed to a normal force and then sheared to gross sliding, and ``beyond``
    (by default where it is cheap).

    control : what stays as it is normally under shear, the "displacement" (as in the paper) or the
        "force"
    """
    given, scene = scene, {"tangential_maugis": float(maugis), **LAWS[law], **scene}
    # A rim that slips under eq. 3 is no longer kept out of the flat, and the deeper it sinks the
    # faster its friction falls.
    size = scene.pop("points", None) or points(**scene) * (4 if law == "mcgarry" and maugis >= 10
                                                           else 1)
    begin, end = peeling(maugis, force), drive(scene, strength(law, maugis, force))
    # The more compliant the interface the more of the contact slips at once: smaller steps.
    legs = [f"normal_force={force:g}", f"tangential_displacement={end:.6g}"]
    steps = [1.0, end / (40 if maugis >= 6 else 80 if maugis >= 1 else 120)]
    if control == "displacement":
        legs[1] = "normal_displacement=hold, " + legs[1]
    if drive(scene, begin) < 0.6 * end:
        # The contact peels long before it slides: smaller steps first.
        legs.insert(1, legs[1].replace(f"{end:.6g}", f"{drive(scene, begin):.6g}"))
        steps.insert(1, drive(scene, begin) / 40)
    for stop in PROFILED.get((law, maugis, force), ()) if fields == "all" else ():
        there = next(place for place in range(1, len(legs))
                     if stop < float(legs[place].rpartition("=")[2]))
        legs.insert(there, f"{legs[there].rpartition('=')[0]}={stop:g}")
        steps.insert(there, steps[there])
    if beyond is None:
        beyond = law != "mcgarry" and maugis <= 1 or fields == "all"
    name = f"{law}-t{maugis:g}-w{force:g}" + "-force" * (control == "force") + suffix
    approach = reference.jkr_line_approach(half_width(max(force, 0.8)), PERIOD)
    return Run(
        name,
        finer="points" not in given,
        options={
            **{f"scene_{key}": value for key, value in scene.items()},
            "scene_points": size,
            "load_start": f"normal_displacement={max(2.0, approach):.3f}",
            "load_path": "; ".join(legs),
            "load_stop": "pull_off"
            if beyond or law == "mcgarry" and maugis <= 1
            else "gross_sliding,pull_off",
            "continuation_initial_step": ",".join(
                f"{min(step, 0.5):.4g}" if not leg else f"{step / 2:.4g}"
                for leg, step in enumerate(steps)
            ),
            "continuation_largest_step": ",".join(f"{step:.4g}" for step in steps),
            "continuation_at_fold": "jump" if beyond else "stop",
            "archive_fields": fields,
            # Along its length a branch tells exactly where a stable onset is; a stiff interface
            # with a fold has too long a one.
            **(
                {"continuation_type": "arclength"}
                if law == "mcgarry" or maugis <= (3.6 if law == "full" else 1)
                else {}
            ),
            "continuation_stability": "sign",
        },
    )


def law_name(residual):
    """Name of eq. 5 with a residual friction."""
    return {1: "full", 0.5: "half"}.get(residual, f"r{residual:g}")


def mapped(residual, maugis, force):
    """A contact of the map of regimes, pressed to a normal force and sheared to gross sliding while
    the top stays where it is: where the paper has it, the run of its figures, else one that ends at
    the onset with the fields there."""
    if residual == 1 and maugis in MORE_TANGENTIAL or residual == 0.5 and maugis in TANGENTIAL:
        return sheared(law_name(residual), maugis, force, fields="all" if force == 25
                       and maugis in TANGENTIAL else "none")
    scene = {"tangential_maugis": float(maugis), "residual_friction": float(residual)}
    half, peak = half_width(force), reference.peak_tangential_traction(maugis)
    width = 2 * half + 1.0 / np.sqrt(maugis)
    # The front's largest force, and more: at a held displacement the normal force grows.
    front = residual * peak * width + reference.ligament_force(half, PERIOD,
                                                               reference.front_work(0.0))
    end = drive(scene, min(peak * width, 1.1 * front) + 3 / maugis * DRIVE)
    # Before the surface turns back it hardly moves while a stiff front runs: folds that coarser
    # nodes make end the path anywhere there.
    size = points(between=True, **scene) * (2 if maugis > 10 else 1)
    return Run(f"{law_name(residual)}-t{maugis:g}-w{force:g}", finer=False, options={
        **{f"scene_{key}": value for key, value in scene.items()},
        "scene_points": size,
        "load_start": "normal_displacement="
                      f"{max(2.0, reference.jkr_line_approach(half, PERIOD)):.3f}",
        "load_path": f"normal_force={force:g}; "
                     f"normal_displacement=hold, tangential_displacement={end:.6g}",
        # A compliant interface may reach its fold when everything has slipped past the peak.
        "load_stop": "pull_off" if maugis <= 1 and residual >= 0.8 else "gross_sliding,pull_off",
        "continuation_initial_step": f"0.5,{end / 60:.4g}",
        "continuation_largest_step": f"1,{end / 60:.4g}",
        "continuation_at_fold": "jump" if maugis <= 1 else "stop",
        "archive_fields": "last" if maugis >= 10 else "none",
        # Only a branch that is followed along its length tells exactly where a stable onset is.
        **({"continuation_type": "arclength"} if maugis <= 1 and residual >= 0.8 else {}),
        "continuation_stability": "sign"})


def turned(maugis=0.1, force=25):
    """A compliant contact that slides, and is then driven back to where the shear began."""
    there = sheared("half", maugis, force)
    legs, steps = (there.options[f"{name}"] for name in ("load_path", "continuation_largest_step"))
    first = there.options["continuation_initial_step"]
    back = steps.split(",")[-1]
    options = {**there.options, "load_path": legs + "; tangential_displacement=0",
               "continuation_largest_step": f"{steps},{back}",
               "continuation_initial_step": f"{first},{back}"}
    options.pop("continuation_type", None)
    return there._replace(name=f"turned-t{maugis:g}-w{force:g}", options=options)


def peeling(maugis, force):
    """A tangential force at which a contact with a stiff interface has peeled: some times its
    brittle strength."""
    return 2.0 * reference.ligament_force(half_width(force), PERIOD)


def drive(scene, force):
    """Tangential displacement of the top at a tangential force, without slip."""
    return reference.driven_displacement(0.0, force, scene.get("period", PERIOD),
                                         scene.get("height", 2000.0))


def approach(displacement, **scene):
    """One point: the top approaches by a displacement."""
    suffix = "".join(f"-{name}{value:g}" for name, value in scene.items() if name != "points")
    return Run(f"approach-{displacement:g}{suffix}",
               {**{f"scene_{name}": value for name, value in {"points": 8192, **scene}.items()},
                "load_start": f"normal_displacement={displacement:g}",
                "load_path": f"normal_displacement={displacement:g}"})


READINGS = {"as described": {}, "longer": {"period": 139.0, "gap_offset": -1.0, "points": 16384},
            "compressible": {"poisson": 0.4987, "gap_offset": -0.98},
            "nearly": {"poisson": 0.499, "gap_offset": -1.0}}
"""Name -> scene of cells in which an approach of 40 and of 2 may give the paper's forces."""


def slid(displacement):
    """A contact whose top has approached by a displacement, sheared until it slides and all its
    adhesion is gone."""
    end = drive({}, strength("half", 1, 25 if displacement > 10 else 0.8))
    return Run(f"slid-{displacement:g}", {
        "scene_points": 8192, "scene_residual_friction": 0.5,
        "load_start": f"normal_displacement={displacement:g}",
        "load_path": f"tangential_displacement={end:.6g}",
        "continuation_initial_step": f"{end / 40:.4g}",
        "continuation_largest_step": f"{end / 40:.4g}", "continuation_stability": "sign"})


def catalogue():
    """Name -> Run of all runs, the longest first."""
    found = [sheared(law, 10, force) for law in LAWS for force in MORE_LOADS[::-2]
             if (law, force) not in (("full", 25), ("half", 25), ("mcgarry", 10.4))]
    found += [sheared(law, maugis, 25, fields="all") for maugis in (10, 1, 0.1)
              for law in ("full", "half")]
    found += [sheared(law, 10, 0.8) for law in ("full", "half")]
    found += [sheared("full", maugis, force) for maugis in MORE_TANGENTIAL[::-1] for force in LOADS]
    found += [sheared(law, maugis, force) for law in LAWS for maugis in (1, 0.1)
              for force in MORE_LOADS if force != 25 or law == "mcgarry"]
    found += [sheared("half", maugis, force, control="force") for maugis in TANGENTIAL
              for force in LOADS]
    found += [sheared("half", 1, 25, control="force", suffix="-period", period=2 * PERIOD,
                      points=16384), sheared("half", 1, 25, control="force", suffix="-height",
                                             height=4000.0)]
    found += [pressed(maugis) for maugis in NORMAL[::-1]]
    found += [approach(displacement, **scene) for displacement in (40, 2)
              for scene in READINGS.values()]
    found += [slid(displacement) for displacement in (40, 2)] + [turned()]
    unique = {}
    for run in found:
        unique.setdefault(run.name, run)
    return unique


class Results:
    """Archives of runs in a folder.

    Parameters
    ----------
    folder : path, made where it is missing
    """

    def __init__(self, folder):
        self.folder = Path(folder)
        self._read = {}
        self._local, self._starters = threading.local(), []
        self.asked = None
        self.folder.mkdir(parents=True, exist_ok=True)

    def __getitem__(self, name):
        """The archive of a run, as `contactsnes.read` gives it; KeyError where there is none with
        points."""
        self.asked = name
        if name not in self._read:
            try:
                record = self._record(name)
            except ArchiveError as error:
                raise KeyError(name) from error
            if not record.points:
                raise KeyError(name)
            self._read[name] = record
        return self._read[name]

    def read_all(self, names, workers):
        """Read the archives of runs that are not read yet, in several processes."""
        names = [name for name in names if name not in self._read]
        shares = [names[begin::SHARES] for begin in range(SHARES)]

        def share(names):
            return {name: self[name] for name in names if name in self}

        for found in called([partial(share, names) for names in shares], workers):
            self._read |= found

    def _record(self, name):
        """The archive of a run; of one that was made here to its end, without the trial in another
        process that an archive of unknown origin gets."""
        path = self.path(name)
        log = path.with_suffix(".log")
        if not (log.is_file() and log.read_text(encoding="utf-8").rstrip().rpartition("\n")[2]
                .startswith("exit status")):
            return read(path)
        with open_archive(path) as file:
            return Record(file, tried=False)

    def __contains__(self, name):
        try:
            return bool(self[name])
        except KeyError:
            return False

    def path(self, name):
        """Where the archive of a run lies."""
        return self.folder / f"{name}.h5"

    def lacking(self):
        """A sentence on the run that was asked for last: that it is missing, or how it ended before
        what is looked for."""
        name = self.asked
        said = [line for line in self._log(name).splitlines() if line.strip()]
        if name not in self:
            return f"the run {name} is missing" + (f" ({said[-1]})" if said else "")
        ended = "" if self[name].complete else " and ended early"
        reason = self.reason(name)
        return f"the run {name} is too short{ended}" + (f": {reason}" if reason else "")

    def reason(self, name):
        """What a run said last of an error, in words; empty where it said nothing."""
        said = reversed(self._log(name).splitlines())
        found = next((line for line in said if line.startswith("contactsnes:")
                      or "error" in line.lower()), "")
        return found.removeprefix("contactsnes: ").removeprefix("error: ").partition("; ")[0]

    def done(self, run):
        """Whether a run has been made, with these options, to whatever end."""
        log = self.path(run.name).with_suffix(".log")
        if not log.is_file() or not self.path(run.name).is_file():
            return False
        lines = log.read_text(encoding="utf-8").splitlines()
        return lines[:1] == [" ".join(run.arguments())] and lines[-1].startswith("exit status")

    def make(self, run):
        """Make a run, or go on with it, if need be on a grid of twice the points; (exit status,
        seconds)."""
        path = self.path(run.name)
        began = time.perf_counter()
        said = [" ".join(run.arguments())]
        log = path.with_suffix(".log")
        # An archive of the same scene with other steps would be taken for this run's.
        same = log.is_file() and log.read_text(encoding="utf-8").splitlines()[:1] == said
        log.write_text(said[0] + "\n", encoding="utf-8")
        status = self._command(path, [*run.program, *run.arguments(), "-archive_resume" if same
                                      else "-archive_overwrite"], said)
        if status == 2 and same:
            status = self._command(path, [*run.program, *run.arguments(), "-archive_overwrite"],
                                   said)
        if status == 1 and run.finer and path.is_file():
            finer = run.on(2 * run.options["scene_points"])
            status = self._command(path, [*finer.program, *finer.arguments(), "-archive_overwrite"],
                                   said)
        if status in ENDS:
            log.write_text("\n".join([*said, f"exit status {status}", ""]), encoding="utf-8")
        self._read.pop(run.name, None)
        return status, time.perf_counter() - began

    def _command(self, path, arguments, said):
        """Exit status of one command of Python, whose output is added to what was said, with the
        processor time that it took at the end."""
        if not hasattr(self._local, "starter"):
            self._local.starter = Starter()
            self._starters.append(self._local.starter)
        output = path.with_suffix(".out")
        try:
            status, used = self._local.starter.run([*arguments, "-archive_file", str(path)], output)
            said += [output.read_text(encoding="utf-8", errors="replace"), f"{used:.2f}{USED}"]
        finally:
            output.unlink(missing_ok=True)
        return status

    def used(self, runs):
        """Seconds of processor time that runs have taken, by their logs."""
        return sum(float(line.removesuffix(USED)) for run in runs
                   for line in self._log(run.name).splitlines() if line.endswith(USED))

    def _log(self, name):
        log = self.path(name).with_suffix(".log")
        return log.read_text(encoding="utf-8") if log.is_file() else ""

    def finer(self, run):
        """A run that has been made, on twice the points and without certificates."""
        size = 2 * int(self[run.name].scene["points"])
        return run.on(size, continuation_stability="off")._replace(name=run.name + FINER,
                                                                   finer=False)

    def make_all(self, runs, workers, say):
        """Make the runs that are missing, several at a time; ``say`` is called with a line on
        each."""
        missing = [run for run in runs if not self.done(run)]
        with ThreadPoolExecutor(workers) as pool:
            futures = {pool.submit(self.make, run): run for run in missing}
            try:
                for count, future in enumerate(as_completed(futures), start=1):
                    status, seconds = future.result()
                    name = futures[future].name
                    numbers = (f"{self[name].points} points, "
                               f"{np.sum(self[name]['transforms']):.0f} transforms"
                               if name in self else "no points")
                    say(f"{count:3} of {len(missing)}  {name:28} {numbers}, "
                        f"{seconds:.1f} s{ENDS.get(status, f', status {status}')}")
            except KeyboardInterrupt:
                pool.shutdown(cancel_futures=True)
                raise
            finally:
                pool.shutdown()
                while self._starters:
                    self._starters.pop().end()


class Finer:
    """Results of the runs on twice the points, under the names of the runs; what has no such run is
    as in the results themselves.

    Parameters
    ----------
    results : Results
    fixed : names of runs whose grid is not to be refined
    """

    def __init__(self, results, fixed=()):
        self.results, self.fixed = results, frozenset(fixed)

    def __getitem__(self, name):
        return self.results[name if name in self.fixed else name + FINER]

    def __contains__(self, name):
        return (name if name in self.fixed else name + FINER) in self.results

    @property
    def asked(self):
        """Name of the run that was read last."""
        return self.results.asked

    def lacking(self):
        """As of `Results`."""
        return self.results.lacking()
