"""What memory holds on this machine, and what a solve takes of it."""

import contextlib
import os
import resource
from pathlib import Path

from ..system.processes import world

USABLE = 0.8
"""Part of the machine's memory that a run may take."""

ITERATIONS = 20
"""Krylov iterations of a linear solve, rarely more."""
HELD = {"own": 0.4, "fgmres": 2.5, "gmres": 1.25}
"""Vectors in double precision that a solve holds for each iteration that it makes, by -ksp_type
(ours, the default of many unknowns: one rounded, 0.25, and in fewer iterations another one on two
grids, on even planes in single precision; PETSc's are made ten at a time); other methods hold a few
in all."""


def memory_of_solve(unknowns, whole, kind=None, iterations=ITERATIONS):
    """Bytes of a solve: Krylov vectors and 13 arrays of the unknowns, 7 arrays over the cell.

    Measured on rough planes without a window, in arrays of the nodes, with five to seven iterations
    of a solve: 18 of one component on 1024 x 1024 nodes, 50 of three on 512 x 512.

    Parameters
    ----------
    unknowns : int
    whole : int, nodes of the cell times components
    kind : str, the method of linear solves; None: -ksp_type
    iterations : int, of a linear solve
    """
    from petsc4py import PETSc  # its start takes options, which nobody has read when this is loaded

    kind = kind or PETSc.Options().getString("ksp_type", "own")
    return 8 * ((HELD.get(kind, 0.0) * iterations + 13) * unknowns + 7 * whole)


def memory():
    """Bytes that a run may take on this machine: what is free now, within the limits of the process
    and its control group; of several processes as often as the one with least."""
    total = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    limits = [total, *_group_limits(), *([] if limit == resource.RLIM_INFINITY else [limit])]
    try:
        fields = dict(line.split(":")
                      for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines())
        limits.append(1024 * int(fields["MemAvailable"].split()[0]))
    except (OSError, ValueError, KeyError):
        pass  # no Linux
    return world.size * min(world.everywhere(USABLE * min(limits) / world.neighbours))


def _group_limits():
    """Limits on memory of the control group of this process and of those above it, as far as there
    are any."""
    limits = []
    try:
        groups = [line.split(":", 2)[1:]
                  for line in Path("/proc/self/cgroup").read_text(encoding="utf-8").splitlines()]
    except OSError:
        return limits
    for controllers, place in groups:
        root, name = (("/sys/fs/cgroup", "memory.max") if not controllers
                      else ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"))
        if controllers in ("", "memory"):
            folder = Path(root + place)
            for above in (folder, *folder.parents):
                with contextlib.suppress(OSError, ValueError):  # no such file, or the word max
                    limits.append(int((above / name).read_text(encoding="ascii")))
    return limits
