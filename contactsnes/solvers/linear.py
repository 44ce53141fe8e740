"""PETSc's linear solver around the Jacobian of a form, for motions that take no nonlinear one; and
the Jacobian for linear solves between those of a nonlinear one."""

from petsc4py import PETSc

from . import callbacks
from .krylov import set_defaults
from .operators import Jacobian
from .precision import Precision, pays
from .snes import TRUST, kept
from .vectors import communicator, create_operator


def create_ksp(form, prefix, precision):
    """(KSP, its matrix) of a form's Jacobian, set up by the defaults of `snes.equip` and then by
    the user's options; its matrix is to be assembled whenever the form is linearised.

    Parameters
    ----------
    form : of the equations
    prefix : str, of the options, after the dash
    precision : str, of transforms inside its solves, as of ``-contact_linear_precision``
    """
    ksp = PETSc.KSP().create(communicator(form))
    ksp.setOptionsPrefix(prefix)
    single = pays(form, precision)
    set_defaults(ksp, form, single)
    if callbacks.available(form):
        matrix = callbacks.operator(ksp, form, single)
    else:
        matrix = create_operator(form, Jacobian(form, Precision(ksp if single else None)))
        ksp.getPC().setType("python")
        ksp.getPC().setPythonType(callbacks.OWN_ZONE)
    ksp.setOperators(matrix)
    callbacks.set_from_options(ksp)
    return kept(ksp), kept(matrix)


def exact_jacobian(snes, form):
    """The form's own Jacobian, at its last linearisation, for a linear solve between two of a SNES.

    That is the second matrix of the SNES where products are differences of F (-snes_mf_operator).
    Where there are but these (-snes_mf) it is made: they are of the state that the SNES has left,
    and of an F whose memory such a solve fills.

    Parameters
    ----------
    snes : SNES of the form
    form : of the equations
    """
    matrix = kept(snes.getJacobian()[1])
    if matrix.getType() == PETSc.Mat.Type.MFFD:
        return create_operator(form, Jacobian(form))
    matrix.assemble()
    return matrix


def end_by_residual(snes):
    """Have the KSP of a SNES end by its residual, for a linear solve between two of the SNES.

    One application of a preconditioner is good enough for the method, but no tangent; and PETSc
    leaves the test of a trust region in a KSP, which ends where its solution leaves that region.
    """
    ksp = snes.getKSP()
    if ksp.getType() == PETSc.KSP.Type.PREONLY:
        ksp.setType("fgmres")
    if snes.getType() in TRUST:
        ksp.setConvergenceTest(None)
