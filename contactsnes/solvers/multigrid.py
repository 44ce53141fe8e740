"""Coarser grids for PETSc's full approximation scheme (``-snes_type fas``): their contacts, forms
and transfers.

With F the displacement form on a grid and F_c that on every other of its nodes, a cycle smooths u,
solves F_c(u_c) = F_c(I u) - R F(u) from u_c = I u, corrects u by P (u_c - I u) and smooths again
(Brandt, Math. Comp. 31, 333, 1977). A solution u of the fine grid is a fixed point of that whatever
law the coarse one has: there the law may be softened, so that a coarse grid resolves its cohesive
zone and the edge of contact does not stick between nodes.
"""

from dataclasses import dataclass
from functools import reduce
from typing import ClassVar

import numpy as np
from petsc4py import PETSc

from ..contact.forms import DisplacementForm
from ..grid.transfer import interpolation
from ..grid.windows import Window
from ..options.database import read
from ..options.fields import InputError, Options, option
from .operators import Applied, Corrected

LEVELS, SMALLEST = 3, 32
"""Grids by default, and the fewest nodes that a direction of the coarsest of them has."""

CYCLES = 50
"""Most cycles by default: solves that converge take four to twenty."""

REFUSED = ("snes_fas_continuation", "snes_fas_full_total", "snes_fas_galerkin",
           "snes_fas_use_coarse_correction_linesearch")
"""Flags of PETSc that need linear transfers, or smoothers of their own."""


@dataclass(frozen=True)
class GridsOptions(Options):
    """Options of the coarse grids that PETSc does not have."""

    prefix: ClassVar[str] = "snes_grids_"
    title: ClassVar[str] = "Coarse grids of the full approximation scheme"
    resolution: float = option(1.25, "largest spacing x maugis^2 on coarse grids: "
                               "above it the law is softened there "
                               "(inf: never)", above=0, infinite=True)


class Transfer:
    """Interpolation P, restriction R and injection I between the unknowns of a form and of a
    coarser one.

    What moves of the normal component is w = a + N(a)/kappa in units of length, with one stiffness
    for both laws: where surfaces overlap that is the traction, elsewhere the gap. Gaps themselves
    would not do: the same overlap is another traction under a softer law, and a correction of it is
    multiplied by the ratio of the tangents.

    Parameters
    ----------
    fine, coarse : DisplacementForm, the coarse one on every other node
    """

    def __init__(self, fine, coarse):
        self.fine, self.coarse = fine, coarse
        self.nodes = interpolation(fine.window)
        self.restriction = (self.nodes.T / 2 ** len(fine.window.shape)).tocsr()
        even = [np.arange(start, start + extent) % 2 == 0
                for start, extent in zip(fine.window.start, fine.window.shape)]
        self.kept = np.flatnonzero(reduce(np.logical_and.outer, even))
        self.ranges = (coarse.contact.ranges[:fine.components]
                       / fine.contact.ranges[:fine.components])
        self.scalars = self.ranges[fine.forced]
        self.moving = fine.contact.law.moving_stiffness
        self.stiffness = self.moving / self.ranges[0] ** 2
        self.injected = np.zeros(coarse.size)

    def inject(self, unknown, out):
        """out = I unknown: every other node, the coarse gap being that of the same w."""
        fine, coarse = self.fine, self.coarse
        field = fine.gap(unknown)[:, self.kept]
        field[0] = fine.contact.law.regularised(field[0], self.moving)
        field *= self.ranges[:, None]
        field[0] = coarse.contact.law.gap_of_regularised(field[0],
                                                         self.stiffness) - coarse.initial_gap
        out[:coarse.count] = field.reshape(-1) / coarse.root
        out[coarse.count:] = self.scalars * unknown[fine.count:]
        self.injected[:] = out

    def restrict(self, imbalance, out):
        """out = R imbalance, the transpose of interpolation, for the rows of forces as they are."""
        fine, coarse = self.fine, self.coarse
        field = fine.displacement(imbalance) @ self.restriction.T * self.ranges[:, None]
        out[:coarse.count] = field.reshape(-1) / coarse.root
        out[coarse.count:] = imbalance[fine.count:]

    def correct(self, change, unknown, out):
        """out = unknown, perhaps the same array, corrected by P change, with change from what was
        injected last.

        Parameters
        ----------
        change : array of the coarse form's size
        unknown, out : arrays of the fine form's size
        """
        fine, coarse = self.fine, self.coarse
        field = coarse.displacement(change)
        gap = coarse.gap(self.injected)[0]
        law = coarse.contact.law
        field[0] = law.regularised(gap + field[0], self.stiffness) - law.regularised(gap,
                                                                                     self.stiffness)
        field = (field / self.ranges[:, None]) @ self.nodes.T
        gap, law = fine.gap(unknown)[0], fine.contact.law
        field[0] = law.gap_of_regularised(law.regularised(gap, self.moving) + field[0],
                                          self.moving) - gap
        np.add(unknown[:fine.count], field.reshape(-1) / fine.root, out=out[:fine.count])
        np.add(unknown[fine.count:], change[coarse.count:] / self.scalars, out=out[fine.count:])


class CoarseForm(DisplacementForm):
    """A displacement form on every other node of a finer one, its law softened where that grid asks
    for it, under its load."""

    kernel = None  # its load is the finer one's, which the library does not know

    def __init__(self, finer, resolution):
        self.finer = finer
        window, contact = finer.window, finer.contact.coarse(resolution)
        start = [(first + 1) // 2 for first in window.start]
        shape = [(first + extent + 1) // 2 - begin
                 for first, extent, begin in zip(window.start, window.shape, start)]
        super().__init__(contact, Window(contact.grid, start, shape), finer.controls)

    def residual(self, unknown, out):
        """F under the load that the finer form has now."""
        self.set_load(self.finer.load)
        return super().residual(unknown, out)


def _matrix(rows, columns, context):
    """PETSc matrix of a context."""
    matrix = PETSc.Mat().createPython([rows, columns], context, comm=PETSc.COMM_SELF)
    matrix.setUp()
    return matrix


def count_levels(form, database):
    """Number of grids: -snes_fas_levels, by default what the grid allows, up to three. InputError
    where it does not."""
    shape, allowed = np.array(form.grid.shape), 1
    while np.all(shape % 4 == 0) and np.all(shape // 2 >= SMALLEST):
        shape, allowed = shape // 2, allowed + 1
    levels = database.getInt("snes_fas_levels", min(LEVELS, allowed))
    if not 1 <= levels <= allowed:
        raise InputError(f"-snes_fas_levels is '{levels}': the grid of "
                         f"{' x '.join(map(str, form.grid.shape))} points can be "
                         f"halved to at most {allowed} levels, with even "
                         f"numbers and at least {SMALLEST} points in each "
                         "direction")
    return levels


def _check(form, database):
    """InputError for what these grids cannot do."""
    if not form.in_displacements:
        raise InputError("-snes_type is 'fas': it needs -contact_form displacement")
    if database.getString("snes_fas_type", "multiplicative").lower() == "additive":
        raise InputError("-snes_fas_type is 'additive': corrections between these "
                         "grids are not linear; take multiplicative, full "
                         "or kaskade")
    for name in REFUSED:
        if database.getBool(name, False):
            raise InputError(f"-{name} is 'true': between these grids, which "
                             "exchange changes of regularised gaps, only false "
                             "is allowed")


def create_levels(snes, form, equip):
    """Make a form's SNES a full approximation scheme; smoothers of all grids, each with its form.

    Parameters
    ----------
    snes : SNES of the form, before its setFromOptions
    form : DisplacementForm on the finest grid
    equip : function (SNES, form) that sets function, Jacobian and linear solver

    A smoother is one step of Newton, its linear system solved to 0.1; the coarsest grid is solved
    to 0.01. PETSc's options (-snes_fas_*, -fas_levels_*, -fas_coarse_*) change that. InputError
    where they ask for what these grids cannot do.
    """
    prefix = snes.getOptionsPrefix() or ""
    database = PETSc.Options(prefix)
    _check(form, database)
    forms, resolution = [form], read(GridsOptions, prefix).resolution
    for _ in range(count_levels(form, database) - 1):
        forms.append(CoarseForm(forms[-1], resolution))
    snes.setType("fas")
    snes.setTolerances(max_it=CYCLES)
    snes.setFASLevels(len(forms))
    smoothers = []
    for level, own in enumerate(reversed(forms)):
        dm = PETSc.DMShell().create(PETSc.COMM_SELF)
        dm.setGlobalVector(PETSc.Vec().createSeq(own.size))
        # PETSc takes the number of levels from the finest grid's when it reads the options.
        dm.setRefineLevel(level)
        snes.getFASCycleSNES(level).setDM(dm)
        if level:
            _connect(snes, level, Transfer(own, forms[-level]))
        made = [snes.getFASSmoother(level)]
        if level and database.hasName("snes_fas_smoothup"):
            made.append(snes.getFASSmootherUp(level))
        for smoother in made:
            smoother.setDM(dm)
            equip(smoother, own)
            smoothers.append((smoother, own))
    _set_defaults(smoothers)
    return smoothers


def _connect(snes, level, transfer):
    """Hand a transfer to the FAS; PETSc makes the coarse Vec from the scale, which is used for
    nothing else."""
    fine, coarse = transfer.fine.size, transfer.coarse.size
    snes.setFASInterpolation(level, _matrix(fine, coarse, Corrected(transfer.correct)))
    snes.setFASRestriction(level, _matrix(coarse, fine, Applied(transfer.restrict)))
    snes.setFASInjection(level, _matrix(coarse, fine, Applied(transfer.inject)))
    snes.setFASRScale(level, PETSc.Vec().createWithArray(np.ones(coarse), comm=PETSc.COMM_SELF))


def _set_defaults(smoothers):
    """Defaults of the smoothers, the coarsest first, and then the user's options."""
    for smoother, _ in smoothers:
        smoother.setType("newtonls")
        smoother.getKSP().setTolerances(rtol=0.1)
    smoothers[0][0].setTolerances(rtol=1e-2, atol=1e-9, stol=0.0)
    for smoother, _ in smoothers:
        smoother.setFromOptions()
