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

    def __init__(self, fine, coarse):
        lines = [line_interpolation(*sizes) for sizes in zip(fine.window.start, fine.window.shape, fine.grid.shape)]
        nodes = lines[0] if len(lines) == 1 else sparse.kron(*lines, format="csr")
        picked = (nodes == 1.0).astype(float)
        ranges = coarse.contact.ranges[:fine.components] / fine.contact.ranges[:fine.components]
        fields = ranges * fine.root / coarse.root
        self.interpolation = _matrix(nodes, 1.0 / fields, 1.0 / ranges[fine.forced])
        self.restriction = _matrix(nodes.T / 2 ** len(lines), fields, np.ones(len(fine.forced)))
        self.injection = _matrix(picked.T, fields, ranges[fine.forced])


def _matrix(block, factors, scalars):
    """PETSc matrix of a sparse block times a factor for each component, and of factors of the scalars."""
    whole = sparse.block_diag([*(factor * block for factor in factors), *([[scalar]] for scalar in scalars)], format="csr")
    return PETSc.Mat().createAIJ(whole.shape, csr=(whole.indptr, whole.indices, whole.data), comm=PETSc.COMM_SELF)
