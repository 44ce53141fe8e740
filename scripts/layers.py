#!/usr/bin/env python3
"""Where the processor time of a run goes, by layer: `scripts/benchmark --profile` asks for it.

    scripts/layers.py OUT.json [FILE.opts or -option value] ...

This is ``contactsnes run`` in a process of its own, whose functions are wrapped: while one runs,
and none that it calls is wrapped itself, the time is that of its layer. OUT.json tells what each
layer took, in seconds, from the start of the process on, and how often it was called. A wrapped
call takes about two microseconds more. What compiled kernels do within PETSc counts as PETSc's.
"""

import gc
import json
import sys
import time
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

IMPORTS, REST = "start: Python and imports", "all else"
"""Layers of what no function does."""

EARLY = {
    "start: options and database": ("commands.cli:start_petsc", "commands.run:database_text",
                                    "commands.run:unused_options",
                                    "commands.run:Run._say_what_is_solved"),
    "start: scene and branch": ("commands.run:Run._set_up",),
    "observables": ("commands.run:Run._accept",),
    "archive": ("output.archive:Archive.create", "output.archive:Archive.append",
                "output.archive:Archive.settle", "output.archive:Archive.finish"),
    "lines on the terminal": ("commands.progress:Progress.point",
                              "commands.progress:Progress.summary"),
}
"""Layer -> functions, MODULE:NAME of the package, that can be wrapped before PETSc has begun."""

LAYERS = {
    "law": ("interface.laws.law:Law.evaluate", "kernels.laws:LawKernel.__call__",
            "interface.laws.coupled:Coupled.potential", "interface.laws.law:Law.regularised_step"),
    "transforms": ("grid.cell:Transform.forward", "grid.cell:Transform.backward",
                   "grid.cosines:Cosines.forward", "grid.cosines:Cosines.backward",
                   "kernels.transforms:Compiled.forward", "kernels.transforms:Compiled.backward"),
    "plans of transforms": ("grid.cell:Transform.__init__", "grid.cosines:Cosines.__init__",
                            "kernels.transforms:Real.__init__",
                            "kernels.cosines:Cosines.__init__"),
    "circles of the preconditioner": ("contact.problem:Contact.circle.made",
                                      "kernels.zones:Circle.__init__"),
    "residual": ("contact.forms:DisplacementForm.residual",
                 "contact.forms:DisplacementForm.linearise"),
    "product": ("contact.forms:DisplacementForm.apply_jacobian",),
    "preconditioner": ("solvers.core_zone:CoreZone.apply",),
    "preconditioner, set-up": ("solvers.core_zone:CoreZone.__init__",
                               "kernels.zones:CompiledZone.__init__"),
    "forms": ("contact.forms:DisplacementForm.__init__", "contact.even_form:EvenForm.__init__"),
    "PETSc, its objects": ("branch.equations:create_snes", "branch.responses:create_snes",
                           "branch.tracing:create_snes", "dynamics.viscous:create_ksp"),
    "PETSc, solves": ("branch.corrector:Corrector.run", "branch.responses:Responses._linear",
                      "dynamics.viscous:Equations.newton"),
    "balance of points": ("contact.balance:Balance.__call__", "branch.corrector:Corrector._point"),
    "windows": ("branch.equations:Equations.fitted", "contact.states:covers"),
    "predictor": ("continuation.load_steps:predict", "branch.neighbours:Neighbours.follow_edge",
                  "branch.responses:Responses.along_tangent"),
    "acceptance": tuple(f"branch.neighbours:Neighbours.{name}"
                        for name in ("missed", "strayed", "doubtful", "detached")),
    "folds": ("continuation.folds:FoldSearch.search", "branch.tracing:Tracer.solve_arc",
              "branch.tracing:Tracer.direction"),
    "jumps": ("branch.tracing:Tracer.settle",),
    "first point": ("branch.first_points:start",),
    "energies": ("contact.energies:PathEnergies.completed",),
    "remarks": ("branch.failures:Resolution.marked", "branch.remarks:Remarks.marked"),
}
"""Layer -> functions that are wrapped once PETSc has begun."""


class Layers:
    """Processor time by layers, exclusively: that of the innermost function that is wrapped.

    Attributes
    ----------
    seconds, calls : layer -> processor time, and number of calls
    """

    def __init__(self, first=IMPORTS, clock=time.process_time):
        self.seconds, self.calls = {}, {}
        self._layers, self._clock, self._before = [first], clock, 0.0

    def mark(self):
        """Count the time since the last mark to the layer that is on."""
        now = self._clock()
        layer = self._layers[-1]
        self.seconds[layer] = self.seconds.get(layer, 0.0) + now - self._before
        self._before = now

    def change(self, layer):
        """Count what no function does to another layer from now on."""
        self.mark()
        self._layers[0] = layer

    def wrapped(self, function, layer):
        """The function, whose time is that of a layer."""
        def timed(*arguments, **named):
            self.mark()
            self._layers.append(layer)
            self.calls[layer] = self.calls.get(layer, 0) + 1
            try:
                return function(*arguments, **named)
            finally:
                self.mark()
                self._layers.pop()
        return timed

    def wrap(self, functions):
        """Wrap functions, layer -> MODULE:NAME of each, where they are defined or imported."""
        for layer, names in functions.items():
            for name in names:
                module, _, path = name.partition(":")
                *outer, last = path.split(".")
                owner = import_module(f"contactsnes.{module}")
                for part in outer:
                    owner = getattr(owner, part)
                kept = vars(owner)[last]
                kind = type(kept) if isinstance(kept, (classmethod, staticmethod)) else None
                made = self.wrapped(kept.__func__ if kind else kept, layer)
                setattr(owner, last, kind(made) if kind else made)


def measured(arguments):
    """(exit status, Layers) of ``contactsnes run`` with arguments, in this process from its begin
    on."""
    layers = Layers()
    gc.disable()  # as the command does
    from contactsnes.commands import cli, session

    begin = layers.wrapped(session.begin_petsc, "start: PETSc")
    wrap = layers.wrapped(layers.wrap, IMPORTS)

    def begun(words):
        begin(words)
        wrap(LAYERS)

    session.begin_petsc = begun
    layers.wrap(EARLY)
    follow = cli.Run.follow

    def followed(task):
        layers.change(REST)
        return follow(task)

    cli.Run.follow = followed
    status = cli.main(["run", *arguments])
    layers.mark()
    return status, layers


def main():
    """Run, and write what it took."""
    out, *arguments = sys.argv[1:]
    status, layers = measured(arguments)
    Path(out).write_text(json.dumps({"seconds": layers.seconds, "calls": layers.calls}),
                         encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main())
