"""One run of a scene along its load path: its points as they come, kept and shown, and how it
ended, in words and as exit status."""

import dataclasses
import signal
import sys
from functools import partial

from ..branch.failures import uncomputable
from ..branch.grid_choice import reason
from ..contact import observables
from ..continuation.points import (
    NoEquilibrium,
    NotConverged,
    TooCoarse,
    new_points,
    unfinished_fold,
)
from ..interface.heights import let_go
from ..options.database import database, database_text, petsc_sentence, unused_options
from ..options.fields import InputError
from ..output import resuming
from ..output.files import ArchiveError
from ..scene import settings as scenes
from ..system.processes import PATIENCE, SHORT, world
from . import summary
from .cautions import cautions
from .own_solvers import blamed
from .progress import Progress
from .session import (
    create_branch,
    create_watch,
    solver_options,
    unread_options,
    versions,
)
from .speech import complain

BAD_OPTIONS = {56, 57, 62, 63, 65, 73, 75, 77, 83, 86, 92, 95}
"""PETSc's error codes of what a user asked for: no support, wrong argument, missing file, a solver
that lacks parts or has too few, arguments that do not fit, unknown type, no factorisation."""

NAMES = 1024
"""Bytes of a state besides its numbers."""


class Run:
    """One run: branch, archive and progress, and what to say when it is over."""

    def __init__(self, settings, interrupts):
        self.settings, self.interrupts = settings, interrupts
        self._set_up()

    def _set_up(self, missed=()):
        """Begin the path on the grid of the settings, where coarser ones have ``missed`` their
        accuracy."""
        settings = self.settings
        self.table = dict(observables.table(settings.scene))
        # What PETSc prints by itself would tear a bar to pieces.
        watched = any("monitor" in name or name.endswith("view") for name in database())
        self.progress = Progress(settings.scene, settings.load, partial(print, flush=True),
                                 live=sys.stdout.isatty() and sys.stderr.isatty() and not watched)
        self.branch = create_branch(settings, self.progress.log)
        self.warnings = cautions(settings, self.branch.contact)
        let_go()
        self.watch = create_watch(settings, self.branch, self.progress, missed)
        self.table |= self.watch.columns if self.watch else {}
        if settings.output.file and settings.output.stiffness:
            self.table[observables.STIFFNESS] = observables.stiffness(settings.scene)
        self.archive, self.nothing = None, 0.0
        self.waiting = []
        self.known = 0
        self.ended = False
        self.unread = []
        if settings.output.file:
            self.archive = self._open_archive()
            self.known = self.archive.points

    def _open_archive(self):
        """The archive to append to, created or resumed; the branch gets the history it goes on
        from."""
        from ..output.archive import Archive  # runs without one need not import it
        from ..output.cell_fields import NOTHING
        from ..output.columns import Column
        from ..output.shared import SharedArchive

        scene, output = self.settings.scene, self.settings.output
        self.nothing = NOTHING[output.precision]
        content = {"scene": self.branch.attributes(), "options": database_text(),
                   "versions": versions(), "columns": {name: Column(row.unit, row.kind, row.names)
                                                       for name, row in self.table.items()},
                   "fields": output.fields, "precision": output.precision,
                   "components": scene.components,
                   "warnings": self.warnings}
        if scene.dimension == 1 and output.fields != "all":
            # A byte a number: an eighth of what windows as wide as the line would take.
            content["state"] = NAMES + scene.components * self.branch.contact.grid.size
        if output.fields != "none":
            content |= (observables.frame(self.branch.contact)
                        | {"modes": self.branch.steps.keeps_modes})
            if output.on_active(scene):
                content["compliance"] = observables.compliance(self.branch.contact)
        make = partial(Archive.resume, output.file, **content) if output.resume else partial(
            Archive.create, output.file, overwrite=output.overwrite, **content)
        archive = SharedArchive(make, self.branch.contact.grid) if world.size > 1 else make()
        if archive.complete or not output.resume:
            return archive
        history = [self.branch.restored(state) for state in archive.states()]
        tracing = self.settings.steps.at_fold == "trace"
        met = len(history) - (0 if tracing else unfinished_fold(history))
        self.waiting = history[met:]
        self.branch.history = history  # all of them have to lie on the path
        if self.waiting:
            self.branch.history = history[:met]
        return archive

    def follow(self):
        """Follow the path to its end, and say how it went; return the exit status."""
        if self.archive and self.archive.complete:
            print(
                f"{self.archive.path} is complete with {self.known} points: there is nothing to do")
            if self.archive.lacking:
                complain("warning", self.archive.lacking)
            return 0
        self._say_what_is_solved()
        if self.known:
            self.progress.log(f"going on after point {self.known} of {self.archive.path}")
            for change in resuming.changes(self.archive.runs[-1].options, database_text()):
                self.progress.log(f"from point {self.known + 1} on {change}")
        status, reason = self._points()
        if status:
            self._end_others(status, reason)
        status, reason = self._settled(status, reason)
        for name in unused_options(solver_options()):
            if name in self.unread:
                continue  # this was told before
            complain("warning", f"{name} was never used: neither this program "
                     "nor any PETSc object in use asks for it")
        if status == 2 and self.archive and not self.archive.points:
            self.archive.remove()
        if self.progress.points:
            print(self.progress.summary(self.known), *(self.watch.summary() if self.watch else ()),
                  sep="\n", flush=True)
        if self.archive and self.archive.points and self.archive.path.is_file():
            print(f"  archive       {self.archive.path}, {self.archive.points} points", flush=True)
        if reason:
            self._complain(reason, counted="")
        return status

    def _complain(self, reason, counted="at least "):
        """Say why the path ended early, and what became of its points; before the archive is
        settled, the first process may have more of them than the others know of."""
        complain("error", reason.rstrip(".") + self._way_on(counted))

    def _end_others(self, status, reason):
        """Where only this process has come to an early end, say why and end all."""
        world.meet(1, status, SHORT if self.interrupts.number else PATIENCE,
                   lambda: self._complain(reason))

    def _settled(self, status, reason):
        """Exit status and reason after what waits for the archive is in its file; one that was to
        be replaced stays where input was bad, or the run was ended before its first point."""
        try:
            if self.archive and (self.archive.points or status <= 1):
                self.archive.settle()
        except ArchiveError as error:
            return status or 1, reason or str(error)
        return status, reason

    def _points(self):
        """Take all points; exit status and, if it is not 0, the reason in words."""
        try:
            for point in new_points(self.branch, self.waiting):
                self._accept(point)
                if world.first(lambda: sys.stdout.left):
                    return (128 + signal.SIGPIPE, "nobody reads standard output any more"
                            if self.archive else "")
                # PETSc may swallow what is raised in some of its callbacks
                if any(world.everywhere(self.interrupts.number)):
                    raise KeyboardInterrupt
            if self.archive:
                self.archive.finish()
        except TooCoarse as found:
            coarse = found.with_traceback(None)  # a traceback would hold PETSc objects
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            return self._verdict(error)
        else:
            return 0, ""
        finally:
            self.progress.close()
        return self._begin_anew(coarse)

    def _begin_anew(self, coarse):
        """The path from its beginning on a finer grid, in place of the points so far."""
        self.progress.log(
            f"{coarse}; the path begins anew with {reason(coarse.scene, self.settings.load)}")
        output = dataclasses.replace(self.settings.output, resume=False, overwrite=True)
        self.settings = self.settings._replace(scene=coarse.scene, output=output)
        self._set_up((*self.watch.missed, coarse))
        return self._points()

    def _verdict(self, error):
        """Exit status and reason of what ended the path early; what is neither solver nor user is
        raised again."""
        from petsc4py import PETSc

        early = self.progress.points == 0
        if isinstance(error, (NotConverged, NoEquilibrium, ArchiveError)):
            self.ended = isinstance(error, NoEquilibrium)
            return 1, str(error)
        if isinstance(error, MemoryError):
            return (2 if early else 1, f"there is not enough memory ({error}): take "
                    "fewer points of the grid")
        if isinstance(error, KeyboardInterrupt):
            number = self.interrupts.number or signal.SIGINT
            return 128 + number, f"interrupted by {signal.Signals(number).name}"
        if isinstance(error, PETSc.Error):
            return 2 if early and error.ierr in BAD_OPTIONS else 1, petsc_sentence(error)
        reason = str(error) if isinstance(error, InputError) else blamed(error)
        if reason:  # of what is one's own
            return 2 if early else 1, reason
        if isinstance(error, ArithmeticError):
            status, reason = uncomputable(error, database())
            return status if early else 1, reason
        raise error

    def _accept(self, point):
        """Keep and show a point."""
        measurement = observables.Measurement(self.branch.contact, point)
        row = self.watch.row(point) if self.watch else {}
        if observables.STIFFNESS in self.table:
            row[observables.STIFFNESS] = self.branch.stiffness(point)
        # in one order: where nodes are in several processes, what they find together
        wanted = [name for name in self.table if self.archive or name in self.progress.taken]
        row |= {name: self.table[name].function(measurement) for name in wanted if name not in row}
        if self.archive:
            self.archive.append(row, self.branch.packed(point), **self._fields(measurement))
        self.progress.point(row, point.position)
        self.branch.corrector.account()  # what observing and keeping took is not the next point's

    def _fields(self, measurement):
        """What the archive gets of a point besides its row and state, by name."""
        output = self.settings.output
        if output.fields == "none":
            return {}
        if output.on_active(self.settings.scene):
            return measurement.active_fields(self.nothing)

        def found():
            return dict(zip(("displacement", "traction", "mode"), measurement.fields()))

        # (several processes find them together)
        return {"later": found} if output.fields == "last" and world.size == 1 else found()

    def _say_what_is_solved(self):
        """Before the first solve: what has no effect, what is skipped, what to beware of."""
        scene, form, load, _, output = self.settings
        if self.settings.auto:
            self.progress.log(f"the grid: {reason(scene, load)}")
        for name, why in scenes.ineffective(scene, load, database(), form, output,
                                            self.settings.estimates):
            self.progress.log(f"-{name} has no effect: {why}")
        for sentence in summary.skipped(self.settings, self.branch):
            self.progress.log(sentence)
        for sentence in self.warnings:
            complain("warning", sentence)
        self.unread = unread_options(self.branch, solver_options())
        for name in self.unread:
            complain("warning", f"{name} is not used: the solver of this scene does not ask for it")

    def _way_on(self, counted):
        """What became of the points of a path that was not followed to its end, in words."""
        if not (self.archive and self.archive.points):
            return ""
        if not self.archive.path.is_file():
            return f"; {self.archive.path} is not there any more: it was removed, or moved away"
        points = f"{self.archive.points} points are" if self.archive.points > 1 else "1 point is"
        again = "" if self.ended else ", -archive_resume goes on from there"
        return f"; {counted}{points} in {self.archive.path}{again}"
