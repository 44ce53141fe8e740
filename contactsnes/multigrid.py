"""Coarser grids for PETSc's full approximation scheme (``-snes_type fas``): their contacts, forms and transfers.

With F the displacement form on a grid and F_c that on every other of its nodes, a cycle smooths u, solves
F_c(u_c) = F_c(I u) - R F(u) from u_c = I u, adds P (u_c - I u) and smooths again (Brandt, Math. Comp. 31, 333, 1977): P
interpolates by cubics, R is its transpose, I picks nodes. A solution u of the fine grid is a fixed point of that whatever the
law of the coarse one: so the law may be softened where a coarse grid would not resolve its cohesive zone.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from petsc4py import PETSc
from scipy import sparse

from .contact import Contact
from .forms import DisplacementForm
from .fourier import Window
from .options import read
from .settings import InputError, Options, option


@dataclass(frozen=True)
class GridsOptions(Options):
    """Options of the coarse grids that PETSc does not have."""

    prefix: ClassVar[str] = "snes_grids_"
    title: ClassVar[str] = "Coarse grids of the full approximation scheme"
    resolution: float = option(1.25, "largest spacing x maugis^2 on coarse grids, kept by smaller Maugis parameters there",
                               "beta", above=0, infinite=True)


def coarse_contact(contact, resolution):
    """The contact on every other node in each direction, with a law no sharper than spacing x maugis^2 = resolution."""
    scene, every_other = contact.scene, (slice(None, None, 2),) * contact.initial_gap.ndim
    points = tuple(n // 2 for n in scene.shape)
    sharpest = np.sqrt(resolution / (2 * max(contact.grid.spacings)))
    softened = replace(scene, points=points if scene.dimension == 2 else points[0],
                       normal_maugis=float(min(scene.normal_maugis, sharpest)),
                       tangential_maugis=float(min(scene.tangential_maugis, sharpest)))
    gap = contact.initial_gap[every_other]
    coarse = Contact(softened, heights=-gap, counter=contact.grid.counter)
    coarse.initial_gap = np.ascontiguousarray(gap) * coarse.ranges[0] / contact.ranges[0]
    return coarse


def coarse_window(window, grid):
    """The window of a grid of every other node that lies in a window of the fine one."""
    starts, shape = [], []
    for start, extent, total in zip(window.start, window.shape, window.grid.shape):
        first = 0 if extent == total else (start + 1) // 2
        starts.append(first)
        shape.append(total // 2 if extent == total else (start + extent + 1) // 2 - first)
    return Window(grid, starts, shape)


def line_interpolation(start, extent, total):
    """Cubic interpolation along a direction from a window's nodes of even number to all of them, sparse."""
    whole = extent == total
    first, count = (0, total // 2) if whole else ((start + 1) // 2, (start + extent + 1) // 2 - (start + 1) // 2)
    nodes = np.arange(extent)
    below, odd = np.divmod(start + nodes, 2)
    rows, columns, weights = [], [], []
    for shift, weight in ((-1, -0.0625), (0, 0.5625), (1, 0.5625), (2, -0.0625)):
        place = below - first + shift
        rows.append(nodes)
        columns.append(place % count if whole else np.clip(place, 0, count - 1))
        weights.append(np.where(odd, weight, float(shift == 0)))
    entries = np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))
    return sparse.csr_matrix(sparse.coo_matrix(entries, shape=(extent, count)))


class Transfer:
    """Between the unknowns of a form and of a coarser one: PETSc matrices of interpolation, restriction and injection."""

    def __init__(self, fine, coarse, stiffness=0.2):
        self.fine, self.coarse = fine, coarse
        lines = [line_interpolation(*sizes) for sizes in zip(fine.window.start, fine.window.shape, fine.grid.shape)]
        self.nodes = lines[0] if len(lines) == 1 else sparse.kron(*lines, format="csr")
        self.picked = np.flatnonzero(np.diff(self.nodes.indptr) == 1) if False else (self.nodes == 1.0).tocsc().indices
        self.back = (self.nodes.T / 2 ** len(lines)).tocsr()
        self.ranges = coarse.contact.ranges[:fine.components] / fine.contact.ranges[:fine.components]
        self.stiffness = stiffness, stiffness / self.ranges[0] ** 2
        self.start = np.zeros(coarse.size)

    def inject(self, x, out):
        f, c = self.fine, self.coarse
        v = f.displacement(x)[:, self.picked] * self.ranges[:, None]
        law = f.contact.law
        a = f.gap(x)[0, self.picked]
        w = self.ranges[0] * (a + law._normal(a)[0] / self.stiffness[0])
        zero = np.zeros_like(w)
        v[0] = law.regularised_step(zero, w / (1 + 1 / self.stiffness[1]), self.stiffness[1]) - c.initial_gap
        out[:c.count] = (v / c.root).reshape(-1)
        out[c.count:] = self.ranges[f.forced] * x[f.count:]
        self.start[:] = out

    def interpolate_add(self, x, y, out):
        f, c = self.fine, self.coarse
        law = f.contact.law
        change = c.displacement(x) / self.ranges[:, None]
        a0 = c.gap(self.start)[0].copy()
        a1 = a0 + c.displacement(x)[0]
        change[0] = (a1 - a0 + (law._normal(a1)[0] - law._normal(a0)[0]) / self.stiffness[1]) / self.ranges[0]
        up = (self.nodes @ change.T).T
        a = f.gap(y)[0].copy()
        slope = law._normal(a)[1]
        up[0] = law.regularised_step(a, up[0] / (1 + slope / self.stiffness[0]), self.stiffness[0])
        new = y.copy()
        new[:f.count] += up.reshape(-1) / f.root
        new[f.count:] += x[c.count:] / self.ranges[f.forced]
        out[:] = new

    def restrict(self, x, out):
        f, c = self.fine, self.coarse
        out[:c.count] = ((self.back @ f.displacement(x).T).T * self.ranges[:, None] / c.root).reshape(-1)
        out[c.count:] = x[f.count:]

    def matrices(self):
        f, c = self.fine.size, self.coarse.size
        class P:
            def multAdd(me, mat, x, v, y): self.interpolate_add(x.getArray(readonly=True), v.getArray(readonly=True), y.getArray())
        class R:
            def mult(me, mat, x, y): self.restrict(x.getArray(readonly=True), y.getArray())
        class I:
            def mult(me, mat, x, y): self.inject(x.getArray(readonly=True), y.getArray())
        out=[]
        for k, sz in ((P,(f,c)),(R,(c,f)),(I,(c,f))):
            m = PETSc.Mat().createPython(sz, k(), comm=PETSc.COMM_SELF); m.setUp(); out.append(m)
        return out
