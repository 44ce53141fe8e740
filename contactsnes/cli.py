"""The commands run, plot and info, their words and exit statuses. The only module that prints; it decides nothing physical.

Exit status: 0 every leg done or a stop that was asked for reached, 1 a solve failed or no equilibrium exists, 2 bad input,
128 + the signal's number for an interrupted run.
"""

import argparse
import dataclasses
import gc
import importlib
import math
import os
import platform
import signal
import sys
import time
import traceback
from typing import NamedTuple

from . import __version__, observables, scene as scenes, states
from .archive import Archive, ArchiveError, Column
from .continuation import NoEquilibrium, NotConverged
from .load import Load, quantities
from .options import check_names, check_values, database, database_text, help_text, petsc_arguments, read, unused_options
from .scene import OPTION_CLASSES
from .settings import InputError, as_text, nearest

HELP = """\
contactsnes: adhesive frictional contact of elastic bodies

  contactsnes run [FILE.opts or -option value] ...    solve a scene along its load path
  contactsnes info [FILE.opts or -option value] ...   what would be solved, without solving it
  contactsnes plot RUN.h5 ...                         figures of archives (contactsnes plot --help)
  contactsnes run -help                               every option with meaning, unit, default and range
  contactsnes --version

Files are read from left to right, then the options of the command line; the later value wins. For instance:
  contactsnes run options/cylinder.opts options/newton.opts -archive_file run.h5"""

BAD_OPTIONS = {56, 57, 62, 63, 65, 83, 86, 92, 95}
"""PETSc's error codes of what a user asked for: no support, wrong argument, missing file, unknown type, no factorisation."""


def main(argv=None):
    """Run a command; return the exit status (module docstring)."""
    words = list(sys.argv[1:] if argv is None else argv)
    command, arguments = (words[0], words[1:]) if words else ("", [])
    if command in ("-h", "-help", "--help", "help"):
        print(HELP)
        return 0
    if command == "--version":
        print(f"contactsnes {__version__}")
        return 0
    if command not in COMMANDS:
        return _no_command(command)
    try:
        return COMMANDS[command](arguments)
    except (InputError, ArchiveError) as error:
        _complain("error", error)
    except MemoryError as error:
        _complain("error", f"there is not enough memory for this scene ({error}): take fewer -scene_points")
    except KeyboardInterrupt as interrupt:
        return 128 + (interrupt.args[0] if interrupt.args else signal.SIGINT)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nobody reads on: not even the last flush
        return 128 + signal.SIGPIPE
    except Exception:  # a defect of ours: shown here, since a living traceback holds PETSc objects (see below)
        traceback.print_exc()
        return 1
    finally:
        gc.collect()  # PETSc objects with Python contexts must not outlive PETSc
    return 2


def _no_command(command):
    """Say what the commands are; exit status 2."""
    if not command:
        print(HELP, file=sys.stderr)
    else:
        guess = nearest(command, COMMANDS)
        _complain("error", f"'{command}' is no command" + (f": did you mean {guess}?" if guess else
                  f"; the commands are {', '.join(COMMANDS)}, for instance: contactsnes run FILE.opts"))
    return 2


def _complain(kind, text):
    sys.stdout.flush()
    print(f"contactsnes: {kind}: {text}", file=sys.stderr, flush=True)


class Settings(NamedTuple):
    """All that options say about a run, in the order of scene.OPTION_CLASSES."""

    scene: scenes.Scene
    form: scenes.Form
    load: Load
    steps: scenes.Steps
    output: scenes.Output


def solver_options():
    """Dataclasses of the options of our own PC and SNES types (they import PETSc)."""
    from . import preconditioners, relaxation, snes

    return (snes.NewtonOptions, preconditioners.CoreOptions, relaxation.VerletOptions, relaxation.FireOptions)


def start_petsc(arguments):
    """Initialise PETSc with the arguments of a command and read the settings from its database."""
    import petsc4py

    name, *words = petsc_arguments(arguments)
    try:
        # Unused options are our own business: PETSc would list those that a sentence on bad input leaves unread.
        petsc4py.init([name, "-options_left", "no", *words])
    except RuntimeError as error:
        raise InputError(f"PETSc does not start with these options ({error}); it says why above") from None
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # as Python has it; PETSc's handler would abort
    check_names(solver_options())
    check_values(solver_options())
    check_classes()
    settings = Settings(*map(read, OPTION_CLASSES))
    scenes.check(settings.scene, settings.load, settings.steps)
    return settings


def check_classes():
    """InputError for a class of this package that an option names and that does not exist."""
    for name, path in database().items():
        module, _, cls = path.rpartition(".")
        if name.endswith("python_type") and module.startswith("contactsnes."):
            try:
                found = hasattr(importlib.import_module(module), cls)
            except ImportError:
                found = False
            if not found:
                raise InputError(f"-{name} is '{path}': there is no such class")


def create_branch(settings, log=lambda sentence: None):
    """The branch of the settings; InputError, too, where the geometry's file is at fault."""
    from .run import Branch

    try:
        return Branch(settings.scene, settings.load, settings.steps, settings.form, log=log)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(str(error)) from None


# run


def run(arguments):
    """``contactsnes run``: follow the load path, show and keep its points."""
    if _asks_for_help(arguments):
        return _help_on_options()
    task = Run(start_petsc(arguments))
    # A shell's background job ignores SIGINT, and is to go on doing so.
    signals = [number for number in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, task.interrupt) for number in signals}
    try:
        return task.follow()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _asks_for_help(arguments):
    return any(argument in ("-h", "-help", "--help") for argument in arguments)


def _help_on_options():
    print(help_text(solver_options()))
    return 0


class Run:
    """One run: branch, archive and progress, and what to say when it is over."""

    def __init__(self, settings):
        self.settings = settings
        self.table = observables.table(settings.scene)
        self.warnings = resolution_warnings(settings)
        self.progress = Progress(settings)
        self.branch = create_branch(settings, self.progress.log)
        self.archive, self.waiting, self.known, self.signal = None, 0, 0, 0
        if settings.output.file:
            self.archive = self._open_archive()
            self.known = self.archive.points

    def _open_archive(self):
        """The archive to append to, created or resumed; the branch gets the history it goes on from."""
        scene, output = self.settings.scene, self.settings.output
        grid = self.branch.contact.grid
        content = {"scene": scenes.attributes(scene), "options": database_text(), "versions": versions(),
                   "columns": {name: Column(row.unit, row.kind, row.names) for name, row in self.table.items()},
                   "fields": output.fields, "components": scene.components, "warnings": self.warnings}
        if output.fields != "none":
            content["coordinates"] = tuple(axis.ravel() for axis in grid.coordinates())
            content["initial_gap"] = self.branch.contact.initial_gap / self.branch.contact.ranges[0]
        if not output.resume:
            return Archive.create(output.file, overwrite=output.overwrite, **content)
        archive = Archive.resume(output.file, **content)
        history = [self.branch.restored(state) for state in archive.states()]
        self.waiting = unfinished_fold(history)
        self.branch.history = history[:len(history) - self.waiting]
        return archive

    def follow(self):
        """Follow the path to its end, and say how it went; return the exit status."""
        if self.archive and self.archive.complete:
            print(f"{self.archive.path} is complete with {self.known} points: there is nothing to do")
            return 0
        self._say_what_is_solved()
        if self.known:
            self.progress.log(f"going on after point {self.known} of {self.archive.path}")
        status, reason = self._points()
        for name in unused_options(solver_options()):
            _complain("warning", f"{name} was never used: neither this program nor any PETSc object in use asks for it")
        if status == 0 and self.archive:
            self.archive.finish()
        if status == 2 and self.archive and not self.archive.points:
            self.archive.path.unlink()  # an empty one would only be in the way of the next try
        if self.progress.points:
            print(self.progress.summary(self.known), flush=True)
        if self.archive and self.archive.points:
            print(f"  archive       {self.archive.path}, {self.archive.points} points", flush=True)
        if reason:
            _complain("error", reason + self._way_on())
        return status

    def interrupt(self, number, frame):
        """Handler of signals: end the run with the points it has."""
        self.signal = number
        raise KeyboardInterrupt(number)

    def _points(self):
        """Take all points; exit status and, if it is not 0, the reason in words."""
        try:
            for point in new_points(self.branch, self.waiting):
                self._accept(point)
                if self.signal:  # PETSc may swallow what is raised in some of its callbacks
                    raise KeyboardInterrupt(self.signal)
        except (Exception, KeyboardInterrupt) as error:
            return self._verdict(error)
        finally:
            self.progress.close()
        return 0, ""

    def _verdict(self, error):
        """Exit status and reason of what ended the path early; what is neither solver nor user is raised again."""
        from petsc4py import PETSc

        if isinstance(error, PETSc.Error) and error.__cause__ is not None:
            error = error.__cause__  # newer petsc4py wraps what our callbacks raise
        early = self.progress.points == 0
        if isinstance(error, (NotConverged, NoEquilibrium)):
            return 1, str(error)
        if isinstance(error, KeyboardInterrupt):
            return 128 + self.signal, f"interrupted by {signal.Signals(self.signal).name}"
        if isinstance(error, PETSc.Error):
            sentence = str(error).splitlines()[-1].removeprefix("[0] ").strip()
            return 2 if early and error.ierr in BAD_OPTIONS else 1, f"PETSc: {sentence} (error {error.ierr})"
        if isinstance(error, ImportError) and early:
            return 2, f"a Python class that an option names cannot be imported: {error}"
        raise error

    def _accept(self, point):
        """Keep and show a point."""
        measurement = observables.Measurement(self.branch.contact, point)
        row = {name: observable.function(measurement) for name, observable in self.table.items()}
        if self.archive:
            fields = measurement.fields() if self.settings.output.fields != "none" else ()
            self.archive.append(row, self.branch.packed(point), *fields)
        self.progress.point(row, point.position)
        self.branch.corrector.account()  # what observing and keeping took is not the next point's

    def _say_what_is_solved(self):
        """Before the first solve: what has no effect, what is skipped, what to beware of."""
        scene, form, load, _, output = self.settings
        for name, why in scenes.ineffective(scene, load, database(), form, output):
            self.progress.log(f"-{name} has no effect: {why}")
        for sentence in skipped(self.settings, self.branch):
            self.progress.log(sentence)
        for sentence in self.warnings:
            _complain("warning", sentence)

    def _way_on(self):
        """What became of the points of a path that was not followed to its end, in words."""
        if not (self.archive and self.archive.points):
            return ""
        points = f"{self.archive.points} points are" if self.archive.points > 1 else "1 point is"
        return f"; {points} in {self.archive.path}, -archive_resume goes on from there"


def unfinished_fold(history):
    """How many of the last points (of a killed run) are a fold, with its further events, that no jump follows yet.

    The state beyond a fold is not archived, so that it has to be found again.
    """
    events = [point.event for point in history]
    folds = [place for place, event in enumerate(events) if event == "fold"]
    return len(events) - folds[-1] if folds and "jump" not in events[folds[-1]:] else 0


def new_points(branch, waiting):
    """The points of a branch without those until its next fold and ``waiting`` - 1 more, which the archive has already."""
    left = waiting
    for point in branch:
        if left == 0:
            yield point
        elif point.event == "fold" or left < waiting:
            left -= 1
    if left:
        raise NotConverged("the fold at the end of the archive was not found again: resume with the options that found it")


def versions():
    """Program -> version of what a result depends on."""
    import petsc4py
    from petsc4py import PETSc

    packages = {name: sys.modules[name].__version__ for name in ("numpy", "pyfftw", "h5py")}
    return {"contactsnes": __version__, "petsc": ".".join(map(str, PETSc.Sys.getVersion())), "petsc4py": petsc4py.__version__,
            **packages, "python": platform.python_version()}


class Progress:
    """What a run says while it goes on: a bar on a terminal, else one line a point, and sentences between."""

    def __init__(self, settings):
        scene, load = settings.scene, settings.load
        plane = ("_x", "_y") if scene.dimension == 2 else ("",)
        self.loads = {"normal_displacement": "D", "normal_force": "W"}
        if any(scenes.tangential_legs(scene, load)):
            for end in plane:
                self.loads |= {f"tangential_displacement{end}": f"U{end}", f"tangential_force{end}": f"T{end}"}
        self.columns = {"leg": "leg", **self.loads, "contact_area": "area", "nonlinear_iterations": "nonlinear",
                        "linear_iterations": "linear", "transforms": "transforms", "event": "event"}
        self.counts = dict.fromkeys(("nonlinear_iterations", "linear_iterations", "function_evaluations", "transforms"), 0)
        self.points, self.events, self.began = 0, [], time.monotonic()
        # What PETSc prints by itself would tear a bar to pieces.
        watched = any("monitor" in name or name.endswith("view") for name in database())
        self.live = sys.stdout.isatty() and sys.stderr.isatty() and not watched
        self.bar, self.legs = None, load.path.count(";") + 1

    def log(self, sentence):
        """Print a sentence without tearing the bar."""
        if self.bar is None:
            print(sentence, flush=True)
        else:
            self.bar.write(sentence)

    def point(self, row, position):
        """Show a point that was accepted."""
        row = {**row, "event": _event(row)}
        loads = ", ".join(f"{heading} {row[name]:.6g}" for name, heading in self.loads.items())
        if not self.live:
            if not self.points:
                print(self._line(self.columns))
            print(self._line(row), flush=True)
        self.points += 1
        self.counts = {name: count + row[name] for name, count in self.counts.items()}
        if row["event"]:
            self.events.append(f"{row['event']} at {loads}")
        if self.live:
            self._advance(row, position, loads)

    def _advance(self, row, position, loads):
        """Move the bar, which begins with the first point."""
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=self.legs, bar_format="{bar:30}| {n:.2f}/{total} legs, {elapsed}{postfix}", miniters=0,
                            leave=False)
        if row["event"]:
            self.bar.write(self.events[-1])
        self.bar.set_postfix_str(f"{loads}, {self.points} points, {self.counts['transforms']:.0f} transforms", refresh=False)
        self.bar.update(max(row["leg"] - 1, 0) + position - self.bar.n)

    def _line(self, row):
        """Values, or headings, in columns."""
        texts = []
        for name, heading in self.columns.items():
            value, width = row[name], {"leg": 3, "event": 0}.get(name, 11 if name in self.loads else 10)
            if isinstance(value, float):
                value = f"{value:.1f}" if name == "transforms" else f"{value:.6g}"
            texts.append(f"{value:>{width}}")
        return " ".join(texts).rstrip()

    def close(self):
        """Remove the bar."""
        if self.bar is not None:
            self.bar.close()
            self.bar = None

    def summary(self, known):
        """The closing table of this run; ``known``: points that an archive had before."""
        lines = [f"  points        {self.points}" + (f" (after {known} of an earlier run)" if known else "")]
        lines += [f"  {'event':13} {event}" for event in self.events]
        for name, unit in (("nonlinear_iterations", "nonlinear"), ("linear_iterations", "linear")):
            lines.append(f"  {unit:13} {self.counts[name]} iterations")
        lines.append(f"  transforms    {self.counts['transforms']:.1f} of the whole cell")
        lines.append(f"  time          {time.monotonic() - self.began:.1f} s")
        return "\n".join(["", *lines])


def _event(row):
    """Event and kind of fold of a row, in words; empty for none."""
    words = "" if row["event"] == "none" else row["event"]
    return f"{words} ({row['fold_kind']})" if row["fold_kind"] else words


# What would be solved


def resolution_warnings(settings):
    """Sentences on a grid that is too coarse, for the log and the archive."""
    sheared = any(scenes.tangential_legs(settings.scene, settings.load))
    sentence = scenes.resolution_warning(settings.scene, sheared)
    return (sentence,) if sentence else ()


def start_window(settings, branch):
    """Nodes on which the law acts when the path begins, in each direction."""
    contact, initial = branch.contact, settings.load.initial(settings.scene.dimension)
    if settings.form.form == "force" or settings.form.window == "off":
        return contact.grid.shape
    state = states.undeformed(contact, (initial[0].control,), [initial[0].value])
    return contact.window(states.normal_gap(contact, state).reshape(contact.grid.shape)).shape


def skipped(settings, branch):
    """Sentences on what is left out of the solves, and why."""
    scene, form, load = settings.scene, settings.form, settings.load
    sheared = scenes.tangential_legs(scene, load)
    sentences = []
    if scene.tangential == "off":
        sentences.append("no tangential unknowns: -scene_tangential is off")
    elif not any(sheared):
        sentences.append("no tangential unknowns: the load names none, and the body does not couple them to normal ones")
    elif not all(sheared):
        sentences.append(f"no tangential unknowns before leg {sheared.index(True)}, the first that needs them")
    if any(sheared) and not scene.coupled:
        sentences.append("no elastic coupling of normal and tangential displacements: an incompressible layer this thick has none")
    window, cell = start_window(settings, branch), branch.contact.grid.shape
    if form.form == "force":
        sentences.append(f"no window: the force form is solved on the whole cell of {_by(cell)} nodes")
    elif math.prod(window) == math.prod(cell):
        sentences.append(f"the window is the whole cell of {_by(cell)} nodes")
    else:
        sentences.append(f"nodes beyond the law's range: the window has {_by(window)} of {_by(cell)} nodes at the start")
    return sentences


def _by(shape):
    return " x ".join(map(str, shape))


def info(arguments):
    """``contactsnes info``: what would be solved."""
    if _asks_for_help(arguments):
        return _help_on_options()
    settings = start_petsc(arguments)
    scene, load = settings.scene, settings.load
    legs = load.legs(scene.dimension) if load.path else ()
    # Without a path there is still a contact to tell of.
    still = dataclasses.replace(load, path="normal_displacement=hold")
    branch = create_branch(settings if legs else settings._replace(load=still, steps=scenes.Steps()))
    sections = {"Scene": _about_scene(settings), "Load path": _about_path(settings, legs),
                "Unknowns": _about_unknowns(settings, branch), "Left out": skipped(settings, branch),
                "Method": _about_method(settings),
                "Without effect": [f"-{name}: {why}" for name, why in
                                   scenes.ineffective(scene, load, database(), settings.form, settings.output)],
                "All options": _all_options(settings)}
    for title, lines in sections.items():
        if lines:
            print(title, *(f"  {line}" for line in lines), sep="\n", end="\n\n")
    for sentence in resolution_warnings(settings):
        _complain("warning", sentence)
    return 0


def _about_scene(settings):
    """Body, interface and grid in words and dimensionless groups."""
    scene = settings.scene
    resolved = scenes.resolution(scene, any(scenes.tangential_legs(scene, settings.load)))
    return [f"{scene.geometry}, interface of dimension {scene.dimension}, law {scene.law}",
            f"normal Maugis parameter {as_text(scene.normal_maugis)}, tangential {as_text(scene.tangential_maugis)}; "
            f"residual friction {as_text(scene.residual_friction)}, residual adhesion {as_text(scene.residual_adhesion)}",
            f"Poisson ratio {as_text(scene.poisson)}, height {as_text(scene.height)} beta, ratio of works of adhesion "
            f"{as_text(scene.work_ratio)}",
            f"period {_by(map(as_text, scene.periods))} beta, {_by(scene.shape)} points, spacing "
            f"{_by(f'{spacing:.4g}' for spacing in scene.spacings)} beta",
            f"cohesive zone: the spacing is {_by(f'{ratio:.3g}' for ratio in resolved)} of the largest that resolves it"
            + (" (0: no edge of contact in that direction)" if 0.0 in resolved else "")]


def _about_path(settings, legs):
    """Start and legs in words."""
    dimension = settings.scene.dimension
    names = {(quantity.component, quantity.control): (name, quantity.unit)
             for name, quantity in quantities(dimension).items()}

    def words(controls, verb):
        for component, (control, value) in controls.items():
            name, unit = names[component, control]
            yield f"{name} is held" if value is None else f"{name} {verb} {as_text(value)} {unit}"

    lines = ["start: " + ", ".join(words(settings.load.initial(dimension), "="))]
    lines += [f"leg {number}: " + ", ".join(words(leg.controls, "goes to")) for number, leg in enumerate(legs, start=1)]
    stops = " or ".join(settings.load.stops)
    return lines + ([] if legs else ["no legs: run needs a -load_path"]) + ([f"ends at the first {stops}"] if stops else [])


def _about_unknowns(settings, branch):
    """Unknowns of each leg, on the window at the start, and an estimate of the memory."""
    scene, window = settings.scene, start_window(settings, branch)
    legs = settings.load.legs(scene.dimension) if settings.load.path else ()
    controls = settings.load.initial(scene.dimension)
    lines, largest = [], 0
    for number, sheared in enumerate(scenes.tangential_legs(scene, settings.load)):
        if number:
            controls = controls | legs[number - 1].controls
        components = scene.components if sheared else 1
        forced = sum(controls[i].control == "force" for i in range(components)) if settings.form.form == "displacement" else 0
        count = components * math.prod(window) + forced
        largest = max(largest, count)
        lines.append(f"{f'leg {number}' if number else 'start'}: {components} x {_by(window)} displacements"
                     + (f" + {forced} of force control" if forced else "") + f" = {count} unknowns")
    if math.prod(window) < math.prod(scene.shape):
        lines.append("the window grows with the contact, and the unknowns with it")
    whole = scene.components * math.prod(scene.shape)
    return lines + [f"memory: up to {_megabytes(largest, whole)} on the window at the start, {_megabytes(whole, whole)} on the whole "
                    "cell, besides Python and its libraries"]


def _megabytes(unknowns, whole):
    """Memory of a solve in words: 2 x 60 Krylov vectors and 20 work arrays, and 10 arrays over the cell."""
    return f"{math.ceil(8e-6 * ((2 * 60 + 20) * unknowns + 10 * whole))} MB"


def _about_method(settings):
    """Form and solver in words."""
    entries = database()
    solver = entries.get("snes_type", "newtonls")
    solver = entries.get("snes_python_type", solver) if solver == "python" else solver
    return [f"{settings.form.form} form, SNES {solver}",
            f"{settings.steps.type} continuation, predictor {settings.steps.predictor}, at a fold: {settings.steps.at_fold}"]


def _all_options(settings):
    """Every option with its value, as in a file of options, where # marks defaults."""
    given, lines = database(), []
    for values in (*settings, *map(read, solver_options())):
        for field in dataclasses.fields(values):
            name, text = f"-{values.prefix}{field.name}", as_text(getattr(values, field.name))
            if not text:
                lines.append(f"# {name}: {field.metadata['default_text'] or 'none'}")
                continue
            text = f'"{text}"' if " " in text else text
            lines.append(f"{name} {text}" + ("" if name[1:] in given else "  # default"))
    return lines


# plot


def plot(arguments):
    """``contactsnes plot``: figures of archives."""
    parser = argparse.ArgumentParser(prog="contactsnes plot", description="Figures of archives, beside them.")
    parser.add_argument("archives", nargs="+", metavar="RUN.h5")
    parser.add_argument("--pdf", action="store_true", help="each figure as PDF, too")
    parser.add_argument("--output", metavar="FOLDER", help="folder of the figures")
    parser.add_argument("--points", metavar="0,5,-1", type=_numbers, help="points of profiles and maps, from 0 or from the end")
    if "--points" in arguments[:-1]:
        # A list that begins with a negative number would be taken for an option.
        place = arguments.index("--points")
        arguments = [*arguments[:place], f"--points={arguments[place + 1]}", *arguments[place + 2:]]
    try:
        asked = parser.parse_args(arguments)
    except SystemExit as stop:
        return stop.code
    from . import plots

    for path in asked.archives:
        try:
            figures = plots.plot(path, asked.output, asked.pdf, asked.points)
        except OSError as error:
            raise InputError(f"the figures of {path} cannot be written: {error}") from None
        print(*figures.files, *(f"no figure {name} of {path}: {why}" for name, why in figures.skipped.items()), sep="\n")
    return 0


def _numbers(text):
    """Whole numbers with commas."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is no list of whole numbers, for instance 0,5,-1") from None


COMMANDS = {"run": run, "plot": plot, "info": info}
