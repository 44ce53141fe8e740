#!/usr/bin/env python3
"""Points where damped motion is stopped, at rest or not: a command with options as of ``contactsnes
run``, and those of `Motions`.

The load path is followed as usual. Then the tangential displacement grows step by step; in each the
body starts at rest where it was stopped in the last one, and moves by damped Verlet (options
``-snes_verlet_*``) until the residual norm falls below a tolerance or a number of time steps is
over. Nothing else is asked of a point: what comes of a motion stopped early is kept as it is.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from contactsnes.commands.session import create_branch, start_petsc, versions
from contactsnes.contact import observables, states
from contactsnes.contact.force_form import ForceForm
from contactsnes.contact.problem import DISPLACEMENT
from contactsnes.interface.laws.coupled import SLIP
from contactsnes.options.database import database_text, read
from contactsnes.options.fields import Options, option
from contactsnes.output.archive import Archive
from contactsnes.output.columns import Column
from contactsnes.scene import settings as scenes
from contactsnes.solvers.motion import Motion
from contactsnes.solvers.stepping import DampedVerlet, VerletOptions


@dataclass(frozen=True)
class Motions(Options):
    """How far, in which steps, and when each motion is stopped."""

    prefix: ClassVar[str] = "moved_"
    title: ClassVar[str] = "Damped motion in steps of the load"
    end: float = option(1.0, "tangential displacement that is not exceeded", "u_t,r", above=0)
    step: float = option(1.0, "step of the tangential displacement", "u_t,r", above=0)
    tolerance: float = option(1e-8, "residual norm at which a motion is stopped",
                              "ranges of the law", above=0)
    steps: int = option(100000, "time steps after which it is stopped in any case", minimum=1)
    damping: float = option(1.0, "rate of the damping over the critical one of the slowest motion",
                            above=0)


def stopped(branch, point, displacement, asked, verlet):
    """The point at a tangential displacement where motion from rest at ``point`` is stopped."""
    contact, controls = branch.contact, (DISPLACEMENT,) * 2
    form = ForceForm(contact.periodic, controls)
    load = np.array([point.displacements[0], displacement])
    form.set_load(load)
    motion = Motion(form, verlet.masses, verlet.tangent)
    motion.start(contact.extended(states.with_components(point.state, 2)))
    rate = 2.0 * asked.damping * motion.frequencies().min()
    method, norm = DampedVerlet(motion, replace(verlet, damping=rate)), motion.norm()
    while norm > asked.tolerance and motion.steps < asked.steps:
        method.step()
        norm = motion.norm()
    touching = motion.gap[0] < contact.scene.contact_threshold
    slipped = np.abs(motion.gap[1]) > SLIP
    forces = contact.load_factor(2) * contact.grid.sum(contact.law.traction(motion.gap))
    field = motion.gap.copy()
    field[0] -= form.initial_gap
    sliding = bool(touching.any() and slipped[touching].all())
    return replace(point, state=states.State(form.window, field, contact.grid.mean(field)),
                   controls=controls, load=load, displacements=load, forces=forces,
                   in_contact=bool(touching.any()), sliding=sliding, residual_norm=float(norm),
                   stable=-1, leg=-1, event="gross_sliding" if sliding else "none",
                   spent={**branch.corrector.account(), "nonlinear_iterations": motion.steps})


def points(branch, asked, verlet):
    """The points of the load path, then those of the motions, up to the first that slides."""
    for point in branch:
        yield point
    begin = point.displacements[1] if len(point.displacements) > 1 else 0.0
    for number in range(1, int((asked.end - begin) / asked.step + 1e-9) + 1):
        point = stopped(branch, point, begin + number * asked.step, asked, verlet)
        yield point
        if point.sliding:
            return


def main(arguments):
    """Make a run, write its archive, and tell of its points."""
    settings = start_petsc(arguments)
    branch, table = create_branch(settings), observables.table(settings.scene)
    archive = Archive.create(settings.output.file, overwrite=True,
                             scene=scenes.attributes(settings.scene), options=database_text(),
                             versions=versions(),
                             columns={name: Column(row.unit, row.kind, row.names)
                                      for name, row in table.items()}, fields="all", components=2,
                             **observables.frame(branch.contact))
    for point in points(branch, read(Motions), read(VerletOptions)):
        measurement = observables.Measurement(branch.contact, point)
        row = {name: observable.function(measurement) for name, observable in table.items()}
        archive.append(row, branch.packed(point), *measurement.fields())
        branch.corrector.account()
        print(f"U {row['tangential_displacement']:g}  T {row['tangential_force']:.6g} "
              f" {row['event']}  residual norm {row['residual_norm']:.2e} after "
              f"{row['nonlinear_iterations']} steps, {row['transforms']:.0f} transforms",
              flush=True)
    archive.finish()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
