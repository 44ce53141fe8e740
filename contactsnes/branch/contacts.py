"""The contact that a branch is of: in a cell or alone, computed by the kernels that its options
ask for."""

from petsc4py import PETSc

from ..contact.isolated import IsolatedContact, lay_out
from ..contact.problem import Contact
from ..interface import shapes
from ..interface.gap import refuse_contact_at_edge
from ..kernels.choice import chosen
from ..options.arguments import unfit
from ..scene.isolation import check_form, largest_force
from ..system.processes import end_together


def shared_grid(scene):
    """The grid of a plane whose nodes are shared out among the processes that PETSc runs in; None
    where that is one."""
    if PETSc.COMM_WORLD.size == 1 or scene.dimension == 1:
        return None
    from mpi4py import MPI

    from ..grid.slabs import Slabs

    end_together()
    return Slabs(scene.shape, scene.periods, MPI.COMM_WORLD)


def _agreed(reason):
    """Why all processes do without C: the reason of the first that has to, or None."""
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    reasons = comm.allgather(reason)
    return next((found if None not in reasons else f"{found} (process {rank} of {comm.size})"
                 for rank, found in enumerate(reasons, start=1) if found), None)


def contact_of(scene, load, form, log):
    """The Contact of a scene on its grid.

    Parameters
    ----------
    scene, load : Scene and Load
    form : Form
    log : function (sentence); called where the law is not computed as the rest is

    Raises
    ------
    InputError : where the contact would reach the cell's edge, the form is not for it, or the log
        is no function
    """
    if not callable(log):
        raise unfit("log", log, "a function of a sentence, as print is")
    grid = None if scene.isolated else shared_grid(scene)
    agreed = {} if grid is None else {"agreed": _agreed}
    kernels = chosen(form.kernels == "auto", form.cache or None, **agreed)
    if scene.isolated:
        check_form(form)
        contact = IsolatedContact(lay_out(scene, largest_force(scene, load)), kernels=kernels)
    else:
        contact = Contact(scene, kernels=kernels, grid=grid)
        refuse_contact_at_edge(shapes.of(scene), contact)
    if kernels.law_reason:
        log(f"the law is evaluated by NumPy: {kernels.law_reason}")
    return contact
