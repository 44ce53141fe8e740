"""Flexible GMRES for many unknowns: its vectors are as exact as what is asked for needs, are made
when an iteration asks for them, and are given back when a nonlinear solve has ended.

PETSc's own makes twice ten of them at once, in double precision, and keeps them: more than all else
that a plane takes.
"""

import numpy as np
from petsc4py import PETSc

from ..kernels import krylov as compiled
from .basis import Basis, Changed, InDouble, InSingle, Made, Short, orthogonalised
from .precision import PATIENCE, ROUNDED, SAFE
from .triangle import Triangle

WIDE = 2 ** 17
"""Unknowns from which vectors are rounded to short integers: fewer are near the processor, and take
longer to be widened than to be read."""
LARGE = 2 ** 16
"""Unknowns from which that is taken, on planes: below, and on lines, PETSc's own vectors take
little memory, and the way into Python would take time."""


def set_defaults(ksp, form, packed):
    """Give a KSP our defaults: flexible GMRES, the one below where the solves are those of a large
    plane and their vectors may be in single precision.

    Parameters
    ----------
    ksp : KSP
    form : of the equations
    packed : bool, whether vectors may be in single precision
    """
    if (packed and len(form.window.grid.shape) > 1
        and form.components * form.window.total >= LARGE):
        ksp.setType("python")
        ksp.setPythonContext(FlexibleGMRES(form.grid, not form.contact.kernels.compiled))
    else:
        ksp.setType("fgmres")
        ksp.setGMRESRestart(PATIENCE)
    ksp.setTolerances(max_it=150)


def of_ksp(ksp):
    """The FlexibleGMRES of a KSP, or None."""
    own = ksp.getPythonContext() if ksp.getType() == "python" else None
    return own if isinstance(own, FlexibleGMRES) else None


def release(ksp):
    """Have a KSP give back the vectors of its last solve, where they are ours."""
    own = of_ksp(ksp)
    if own:
        own.release()


class FlexibleGMRES:
    """PETSc's KSP context: flexible GMRES (Saad, SIAM J. Sci. Comput. 14, 461, 1993),
    preconditioned from the right, with classical Gram-Schmidt.

    A cycle that is asked for no more of the residual it begins with than single precision holds
    keeps its vectors so, whatever the products are in, and one that is asked for little rounds
    those of many unknowns to short integers. That residual is found anew, in double precision.

    Parameters
    ----------
    grid : Grid of the unknowns, which sums over processes
    interpreted : bool, whether NumPy computes, not the library

    Attributes
    ----------
    idle : Vec that nobody else uses while this solves; None: it makes one
    """

    def __init__(self, grid, interpreted=False):
        self._grid = grid
        self._products = InSingle if interpreted else compiled
        self._kept, self.triangle, self._restart = (None, None), None, PATIENCE
        self.idle = None

    def setFromOptions(self, ksp):
        """Read -ksp_gmres_restart, and ask for the side and the norm that are ours."""
        self._restart = PETSc.Options(ksp.getOptionsPrefix() or "").getInt("ksp_gmres_restart",
                                                                          PATIENCE)
        ksp.setPCSide(PETSc.PC.Side.RIGHT)

    def release(self):
        """Give back the vectors."""
        self._kept = None, None

    def destroy(self, ksp):
        """Give back all memory, with the KSP: older petsc4py does so late."""
        self.release()
        if self.idle:
            self.idle.destroy()

    def view(self, ksp, viewer):
        """What -ksp_view prints."""
        viewer.printfASCII(f"    flexible GMRES, restart={self._restart}, vectors as exact as what "
                           "is asked for needs\n")

    def solve(self, ksp, b, x):
        """Solve for x.

        Parameters
        ----------
        ksp : petsc4py KSP
        b, x : petsc4py Vec; x is filled, or what the solve begins with
        """
        vector, again = self.idle or b.duplicate(), ksp.getInitialGuessNonzero()
        if again:
            ksp.getOperators()[0].mult(x, vector)
            vector.aypx(-1.0, b)
        else:
            x.set(0.0)
            b.copy(vector)
        relative, absolute = ksp.getTolerances()[:2]
        aim, size = max(relative * b.norm(), absolute), vector.norm()
        ksp.setIterationNumber(0)
        self._judge(ksp, 0, size)
        while not ksp.getConvergedReason():
            # what is not known of the solution yet is room to work in
            work = b.duplicate() if again else x
            few = aim >= ROUNDED * size and b.getSize() >= WIDE
            basis = self._basis(Short if few else Basis if aim >= SAFE * size else None)
            factors = self._cycle(ksp, (vector, work), size, basis)
            if not again:
                x.set(0.0)
            else:
                work.destroy()  # at once: older petsc4py does so late
            basis[1].add(factors, x.getArray())
            again = True
            if not ksp.getConvergedReason():
                basis = None  # the next cycle's may be others
                ksp.getOperators()[0].mult(x, vector)
                vector.aypx(-1.0, b)
                size = vector.norm()
        if vector is not self.idle:
            vector.destroy()

    def ritz_values(self):
        """Ritz values of the last cycle, none of no solve."""
        return np.zeros(0) if self.triangle is None else self.triangle.ritz_values()

    def _basis(self, kind):
        """(rows of the space, what the preconditioner made of them), of a kind: None in double
        precision; others are kept for the next solve."""
        if kind is None:
            self.release()
            return tuple(made(float, InDouble, self._grid) for made in (Basis, Made))
        if self._kept[0] is not kind:
            self.release()
            space = kind(np.float32, self._products, self._grid)
            self._kept = kind, (space, Changed(space, self._products, self._grid))
        return self._kept[1]

    def _judge(self, ksp, iteration, norm):
        """Tell PETSc of an iteration, and ask whether it is the last."""
        ksp.setResidualNorm(norm)
        ksp.logConvergenceHistory(norm)
        ksp.monitor(iteration, norm)
        reason = ksp.callConvergenceTest(iteration, norm)
        if not reason and iteration >= ksp.getTolerances()[3]:
            reason = PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT
        ksp.setConvergedReason(reason)

    def _cycle(self, ksp, vectors, size, basis):
        """A cycle; the parts of the second basis in the solution.

        Parameters
        ----------
        ksp : petsc4py KSP
        vectors : (Vec, Vec), the residual, which is overwritten, and one to work in
        size : float, its norm
        basis : (Basis, Basis)
        """
        (vector, work), (space, made) = vectors, basis
        operator, pc = ksp.getOperators()[0], ksp.getPC()
        self.triangle = triangle = Triangle(size, self._restart)
        if size > 0.0:
            vector.scale(1.0 / size)
        while triangle.count < self._restart and not ksp.getConvergedReason():
            place = triangle.count
            space.keep(place, vector.getArray())
            pc.apply(vector, work)
            made.take(place, vector.getArray(readonly=True), work.getArray(readonly=True))
            operator.mult(work, vector)
            column = orthogonalised(space, place + 1, vector.getArray())
            norm = triangle.add(column)
            ksp.setIterationNumber(ksp.getIterationNumber() + 1)
            self._judge(ksp, ksp.getIterationNumber(), norm)
            if column[-1] == 0.0 and not ksp.getConvergedReason():
                ksp.setConvergedReason(PETSc.KSP.ConvergedReason.DIVERGED_BREAKDOWN)
        return triangle.factors()
