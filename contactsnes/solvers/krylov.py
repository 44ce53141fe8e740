"""GMRES for many unknowns: its vectors are as exact as what is asked for needs, are made when an
iteration asks for them, and are given back when a nonlinear solve has ended.

PETSc's own makes twice ten of them at once, in double precision, and keeps them: more than all else
that a plane takes.
"""

import numpy as np
from petsc4py import PETSc

from ..grid.patches import taken
from ..kernels import krylov as compiled
from .basis import LEFT, Basis, InDouble, InSingle, Orthogonality, Short
from .iterations import Iterations
from .operators import form_of
from .precision import PATIENCE, ROUNDED, SAFE
from .triangle import Triangle

WIDE = 2 ** 17
"""Unknowns from which vectors are rounded to short integers: fewer are near the processor, and take
longer to be widened than to be read."""
FELL = 0.5
"""Part of its residual that a cycle of rounded vectors leaves at most; after one that leaves more
they are as exact as what is asked for."""
LARGE = 2 ** 16
"""Unknowns from which that is taken, on planes: below, and on lines, PETSc's own vectors take
little memory, and the way into Python would take time."""


def large(form):
    """Whether a form, which processes may share out, has many unknowns."""
    return form.components * form.window.total >= LARGE


def set_defaults(ksp, form, packed):
    """Give a KSP our defaults: PETSc's flexible GMRES, or the one below where the solves are those
    of a large plane and their vectors may be in single precision.

    Parameters
    ----------
    ksp : KSP
    form : of the equations
    packed : bool, whether vectors may be in single precision
    """
    if packed and len(form.window.grid.shape) > 1 and large(form):
        ksp.setType("python")
        ksp.setPythonContext(GMRES(form.grid, not form.contact.kernels.compiled,
                                   in_patches(form)))
    else:
        ksp.setType("fgmres")
        ksp.setGMRESRestart(PATIENCE)
    ksp.setTolerances(max_it=150)


def in_patches(form):
    """Whether the preconditioner of a form, or of one under arc length, is in patches, whose
    transforms are small."""
    form = getattr(form, "form", form)
    return not form.even and taken(form.window)


def of_ksp(ksp):
    """The GMRES of a KSP, or None."""
    own = ksp.getPythonContext() if ksp.getType() == "python" else None
    return own if isinstance(own, GMRES) else None


def release(ksp):
    """Have a KSP give back the vectors of its last solve, where they are ours."""
    own = of_ksp(ksp)
    if own:
        own.release()


def tell_modes(ksp, tells):
    """Have somebody ask for the Ritz values of the next solves of a KSP, or not, where it is
    ours."""
    own = of_ksp(ksp)
    if own:
        own.tells = tells


def is_ours(pc):
    """Whether a preconditioner is the form's own, the same linear function throughout a solve."""
    return pc.getType() == "shell" or (pc.getType() == "python"
                                       and getattr(pc.getPythonContext(), "is_ours", False))


def in_library(operator, pc):
    """Of a form's operator and its own preconditioner what makes iterations in the library: (its
    form there, zone, function that chooses their precision, what is to be called when the
    preconditioner was applied, or None); None of others."""
    context = pc.getPythonContext() if pc.getType() == "python" else None
    if hasattr(context, "in_library"):
        form = form_of(operator)
        made = context.in_library(form)
        if made:
            return form.kernel, *made
    own = operator.getAttr("callbacks")
    zone = (pc.getAttr("callbacks") if pc.getType() == "shell"
            else getattr(context, "callbacks", None))
    if not own or own is not zone or own.structure.arc:
        return None
    return own.kernel, own.zone, own.choose, getattr(context, "tell", None)


def _kind(aim, size, many):
    """Class of the rows of a cycle that is to lead to a norm of the residual from another one, of
    many unknowns or not; None in double precision."""
    return Short if many and aim >= ROUNDED * size else Basis if aim >= SAFE * size else None


class GMRES:
    """PETSc's KSP context: GMRES, preconditioned from the right, with classical Gram-Schmidt;
    flexible (Saad, SIAM J. Sci. Comput. 14, 461, 1993), which keeps what the preconditioner made of
    its vectors, unless that is told in one more application, x = M^-1 V y, at hardly a cost.

    A cycle that is asked for no more of the residual it begins with than single precision holds
    keeps its vectors so, whatever the products are in, and one that is asked for little rounds
    those of many unknowns to short integers. That residual is found anew, in double precision. Of
    many unknowns that are asked for more, but not for modes, cycles end with what rounded vectors
    give, as often as it takes: in hardly more iterations than one in double precision, whose
    vectors take more memory than all else.

    Parameters
    ----------
    grid : Grid of the unknowns, which sums over processes
    interpreted : bool, whether NumPy computes, not the library
    cheap : bool, whether the form's own preconditioner costs little next to a product

    Attributes
    ----------
    idle : Vec that nobody else uses while this solves; None: it makes one
    tells : whether anybody asks for the Ritz values of its solves
    """

    tells = True

    def __init__(self, grid, interpreted=False, cheap=False):
        self._grid, self._cheap = grid, cheap
        self._products = InSingle if interpreted else compiled
        self._kept, self.triangle, self._restart = (None, None), None, PATIENCE
        self.idle = None

    def setFromOptions(self, ksp):
        """Read -ksp_gmres_restart, and ask for the side and the norm that are ours."""
        database = PETSc.Options(ksp.getOptionsPrefix() or "")
        self._restart = database.getInt("ksp_gmres_restart", PATIENCE)
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
        kind = "" if self._asks_again(ksp.getPC()) else "flexible "
        viewer.printfASCII(f"    {kind}GMRES, restart={self._restart}, vectors as exact as what is "
                           "asked for needs\n")

    def solve(self, ksp, b, x):
        """Solve for x.

        Parameters
        ----------
        ksp : petsc4py KSP
        b, x : petsc4py Vec; x is filled, or what the solve begins with
        """
        again = ksp.getInitialGuessNonzero()
        residual = self._residual(ksp, b, x, None) if again else None
        begin = residual or b
        relative, absolute = ksp.getTolerances()[:2]
        aim, size = max(relative * b.norm(), absolute), begin.norm()
        ksp.setIterationNumber(0)
        self._judge(ksp, 0, size)
        if ksp.getConvergedReason() and not again:
            x.set(0.0)
        many = b.getSize() >= WIDE
        parts = many and not self.tells and aim < ROUNDED * size
        while not ksp.getConvergedReason():
            kind, before = Short if parts else _kind(aim, size, many), size
            # what is not known of the solution yet is room to work in
            iterations, found, residual = self._iterations(ksp, begin, None if again else x,
                                                           residual, kind)
            self._cycle(ksp, iterations, size, ROUNDED * size if parts else 0.0)
            iterations.end(self.triangle.factors())
            del iterations  # with it PETSc has its vectors back
            if again:
                x.axpy(1.0, found)
            if again and found is not residual:
                found.destroy()  # at once: older petsc4py does so late
            again = True
            if not ksp.getConvergedReason():
                begin = residual = self._residual(ksp, b, x, residual)
                size = begin.norm()
                parts = parts and size < FELL * before
        if residual and residual is not self.idle:
            residual.destroy()

    def _residual(self, ksp, b, x, vector):
        """What x leaves of b, in a vector; None: in the one that is idle, or a new one."""
        vector = vector or self.idle or b.duplicate()
        ksp.getOperators()[0].mult(x, vector)
        vector.aypx(-1.0, b)
        return vector

    def ritz_values(self):
        """Ritz values of the last cycle, none of no solve."""
        return np.zeros(0) if self.triangle is None else self.triangle.ritz_values()

    def _asks_again(self, pc):
        """Whether a preconditioner is asked again in place of what it made of vectors."""
        return self._cheap and is_ours(pc)

    def _bases(self, kind, pc, count, patches):
        """(rows of the space, what the preconditioner made of them or None), of a kind: None in
        double precision; others are kept for the next solve.

        Parameters
        ----------
        kind : class of the first, or None
        pc : petsc4py PC
        count : int, numbers of a row here
        patches : OnTwoGrids that are the preconditioner, so that what stood for patches tells what
            they made, or None
        """
        key = kind, is_ours(pc), self._asks_again(pc), patches and len(patches.stands)
        if kind and self._kept[0] == key:
            return self._kept[1]
        self.release()
        parts = (np.float32, self._products) if kind else (float, InDouble)
        # (iterations in the library round nothing that the zone makes)
        made = kind if kind and not key[1] and not patches else Basis
        bases = ((kind or Basis)(*parts, self._grid, count),
                 None if key[2] else made(*parts, self._grid, key[3] or count))
        if kind:
            self._kept = key, bases
        return bases

    def _judge(self, ksp, iteration, norm):
        """Tell PETSc of an iteration, and ask whether it is the last."""
        ksp.setResidualNorm(norm)
        ksp.logConvergenceHistory(norm)
        ksp.monitor(iteration, norm)
        reason = ksp.callConvergenceTest(iteration, norm)
        if not reason and iteration >= ksp.getTolerances()[3]:
            reason = PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT
        ksp.setConvergedReason(reason)

    def _cycle(self, ksp, iterations, size, end):
        """A cycle.

        Parameters
        ----------
        ksp : petsc4py KSP
        iterations : what makes them
        size, end : floats, norms of the residual that it begins with, and with which it may end
        """
        self.triangle, norm = Triangle(size, self._restart), size
        triangle = self.triangle
        while triangle.count < self._restart and not norm < end and not ksp.getConvergedReason():
            column = iterations(triangle.count, 1.0 / size if size > 0.0 else 1.0)
            norm, size = triangle.add(column), column[-1]
            ksp.setIterationNumber(ksp.getIterationNumber() + 1)
            self._judge(ksp, ksp.getIterationNumber(), norm)
            if size == 0.0 and not ksp.getConvergedReason():
                ksp.setConvergedReason(PETSc.KSP.ConvergedReason.DIVERGED_BREAKDOWN)

    def _iterations(self, ksp, begin, room, residual, kind):
        """What makes the iterations of a cycle, the library or PETSc; the Vec that it fills at
        last, and the one of residuals, if it takes one.

        Parameters
        ----------
        ksp, begin : petsc4py KSP, and Vec of the residual
        room, residual : Vec to work in and fill, and that of residuals, or None
        kind : class of the rows, None in double precision
        """
        operator, pc = ksp.getOperators()[0], ksp.getPC()
        own = in_library(operator, pc) if kind else None
        alone = own and compiled.steps_alone(own[0])
        patches = own[1].patches if alone else None
        bases = self._bases(kind, pc, len(begin.getArray(readonly=True)), patches)
        if not alone:
            residual, room = residual or self.idle or begin.duplicate(), room or begin.duplicate()
            return Iterations(operator, pc, begin, (residual, room), *bases), room, residual
        room = room or residual
        array, (*own, applied) = room.getArray(), own
        given = array if begin is room else begin.getArray(readonly=True)
        return compiled.Iterations(*own, given, array, *bases, patches,
                                   Orthogonality(bases[0].kind), LEFT, applied), room, residual
