"""PETSc's vectors and matrices of a form: in one process, or shared out as the nodes of its grid
are."""

import ctypes

from petsc4py import PETSc

_first = []
"""An object of several processes, for as long as they run."""


def communicator(form):
    """The processes that a form's nodes belong to."""
    if not form.grid.shared:
        return PETSc.COMM_SELF
    if not _first:
        # PETSc gives its own communicator up with the last object on it, which Python's garbage
        # may keep longer on one process than on others; those would then wait to make it anew.
        _first.append(PETSc.Vec().createMPI((0, PETSc.DETERMINE), comm=form.grid.comm))
    return form.grid.comm


def collect(much=False):
    """Destroy what is not used any more: older petsc4py does so late, and forms hold memory of the
    problem's size; where that was ``much``, give it back to the system."""
    if _first or PETSc.Sys.isInitialized() and PETSc.COMM_WORLD.size == 1:
        PETSc.garbage_cleanup()
    if much:
        _give_back()


def _give_back():
    """Have the C library, where it is GNU's, give the system the memory that lies idle between what
    is held: arrays of other sizes would be put beside it, not into it."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim:
        trim(ctypes.c_size_t(0))


def create_vector(form, array=None):
    """A Vec of unknowns of a form, or of a vector like them, on an array if one is given: this
    process's part.

    Parameters
    ----------
    form : of the equations
    array : array of the form's size, optional
    """
    comm, sizes = communicator(form), (form.size, PETSc.DETERMINE)
    if array is not None:
        return PETSc.Vec().createWithArray(array, size=sizes, comm=comm)
    return (PETSc.Vec().createMPI(sizes, comm=comm) if form.grid.shared
            else PETSc.Vec().createSeq(form.size))


def create_operator(form, context):
    """A Mat of a form's size whose products are a context's.

    Parameters
    ----------
    form : of the equations
    context : with ``mult``
    """
    sizes = form.size, PETSc.DETERMINE
    matrix = PETSc.Mat().createPython((sizes, sizes), context, comm=communicator(form))
    matrix.setUp()
    return matrix
