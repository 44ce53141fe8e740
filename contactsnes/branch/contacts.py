"""The contact that a branch is of: in a cell or alone, computed by the kernels that its options
ask for."""

from dataclasses import fields

from petsc4py import PETSc

from ..contact.isolated import IsolatedContact, lay_out
from ..contact.problem import Contact
from ..interface import shapes
from ..interface.gap import refuse_contact_at_edge
from ..kernels.choice import chosen
from ..options.arguments import unfit
from ..options.database import database
from ..options.fields import InputError, as_text
from ..scene.digits import check_depth
from ..scene.isolation import check_form, largest_force
from ..scene.parts import sources
from ..scene.settings import attributes
from ..system.processes import difference, end_together, launched, overlooked

if launched()[0] > 1:
    end_together()  # what goes wrong in a script may do so before it has a branch


def refuse_unlike(scene, *options):
    """InputError where processes that share out a plane have other ones, or other options.

    Parameters
    ----------
    scene : Scene
    options : Load, Steps, Form
    """
    if PETSc.COMM_WORLD.size == 1 or scene.dimension == 1 or scene.isolated:
        return
    from mpi4py import MPI

    mine = {f"-scene_{name}": value for name, value in (attributes(scene) | sources(scene)).items()}
    mine |= {given.option_name(field.name): getattr(given, field.name)
             for given in options for field in fields(given)}
    mine = {name: as_text(value) for name, value in mine.items()}
    mine |= {f"-{name}": value for name, value in database().items()} | overlooked()
    if found := difference(MPI.COMM_WORLD.allgather(mine)):
        rank, name, there, here = found
        raise InputError(f"process {rank} of {PETSc.COMM_WORLD.size} differs from the first one: "
                         f"{name} is {there} there and {here} in the first; processes share out a "
                         "plane, of which all have to ask for the same")


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
    log : function (sentence); called where kernels, or the law, are not compiled though wanted

    Raises
    ------
    InputError : where the contact would reach the cell's edge, or is pressed deeper than the law is
        followed, the form is not for it, or the log is no function
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
        check_depth(scene, load, contact.mean_initial_gap, contact.rigid_compliance(1)[0])
    if kernels.missed:
        log(f"NumPy computes, which takes several times as long as compiled kernels: "
            f"{kernels.reason}")
    if kernels.law_reason:
        log(f"the law is evaluated by NumPy: {kernels.law_reason}")
    return contact
