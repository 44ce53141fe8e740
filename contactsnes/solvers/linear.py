"""PETSc's linear solver around the Jacobian of a form, for motions that take no nonlinear one."""

from petsc4py import PETSc

from . import callbacks
from .operators import Jacobian
from .snes import kept
from .vectors import communicator, create_operator


def create_ksp(form, prefix):
    """(KSP, its matrix) of a form's Jacobian, set up by the defaults of `snes.equip` and then by
    the user's options; its matrix is to be assembled whenever the form is linearised.

    Parameters
    ----------
    form : of the equations
    prefix : str, of the options, after the dash
    """
    ksp = PETSc.KSP().create(communicator(form))
    ksp.setOptionsPrefix(prefix)
    ksp.setType("fgmres")
    ksp.setGMRESRestart(60)
    ksp.setTolerances(max_it=150)
    if callbacks.available(form):
        matrix = callbacks.operator(ksp, form)
    else:
        matrix = create_operator(form, Jacobian(form))
        ksp.getPC().setType("python")
        ksp.getPC().setPythonType(callbacks.OWN_ZONE)
    ksp.setOperators(matrix)
    callbacks.set_from_options(ksp)
    return kept(ksp), kept(matrix)
