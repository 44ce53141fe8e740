"""What a type of SNES can do, the one home of all that depends on which method solves, and what is
asked of it; and which PETSc will do.

PETSc's own types are in `TYPES`; a Python type says it by a class attribute ``capabilities``, an
own one of a user's, or PETSc's shell, which say nothing, are taken to be able of nothing. Methods
in others, nonlinear preconditioners and parts of compositions, change nothing: a solve ends as the
outer method does.
"""

from functools import cache
from importlib import import_module
from typing import NamedTuple

import numpy as np

from ..contact.balance import TOLERANCE
from ..contact.force_form import FORMS
from ..options.fields import InputError

OLDEST = 3, 18
"""Version of PETSc that is needed at least."""


class Capabilities(NamedTuple):
    """What a method can do, and what it needs.

    kind : what kind of method it is, in words, for comparisons
    has_tangent : whether its linear systems are those of the exact Jacobian, which know the
        branch's direction and its unstable modes, and its iterations tell how hard a step was
    keeps_evenness : whether it may solve for half of an even state, or move half of it
    is_relaxation : whether it follows damped motion itself, so that no other motion has to decide
        where a solve ends
    forcing : whether its linear systems are solved as far as Eisenstat and Walker ask
    one_window : whether its grids are made of one window, not of boxes around spots
    most_iterations : after which it has failed, if -snes_max_it is not given
    name : the type of SNES
    """

    kind: str = "others"
    has_tangent: bool = False
    keeps_evenness: bool = False
    is_relaxation: bool = False
    forcing: bool = False
    one_window: bool = False
    most_iterations: int = 10000
    name: str = ""


NEWTON = Capabilities("Newton", has_tangent=True, keeps_evenness=True, forcing=True,
                      most_iterations=200)
TYPES = {"fas": Capabilities("multigrid", one_window=True), "qn": Capabilities("quasi-Newton"),
         "composite": Capabilities("compositions"),
         **dict.fromkeys(("newtonls", "newtontr", "newtontrdc", "newtonal"), NEWTON),
         **dict.fromkeys(("ngmres", "anderson", "ncg", "nrichardson"),
                         Capabilities("nonlinear Krylov"))}
"""PETSc's type of SNES -> what it can do; others can do nothing."""

UNKNOWN = Capabilities(forcing=True)
"""A Python type that says nothing: it may have linear systems of its own."""


def refuse_build():
    """InputError for a PETSc that is too old, or calculates with other numbers than ours."""
    import petsc4py
    from petsc4py import PETSc

    numbers, version = np.dtype(PETSc.ScalarType), PETSc.Sys.getVersion()
    if numbers != np.float64:
        found = f"calculates with numbers of type {numbers}; float64 is needed, its default"
    elif version < OLDEST:
        found = "is version {}.{}.{}; {}.{} or newer is needed".format(*version, *OLDEST)
    else:
        return
    raise InputError(f"PETSc of {petsc4py.get_config()['PETSC_DIR']} {found}: take another one by "
                     "PETSC_DIR and PETSC_ARCH, with its petsc4py, or that of scripts/setup")


@cache
def of(kind, python_type=""):
    """The capabilities of a type of SNES, and for 'python' of the class with a dotted name."""
    if kind != "python":
        return TYPES.get(kind, Capabilities())._replace(name=kind)
    module, _, name = python_type.rpartition(".")
    try:
        cls = getattr(import_module(module), name)
    except (ImportError, AttributeError, ValueError):
        cls = None
    return getattr(cls, "capabilities", UNKNOWN)._replace(name=kind)


def asked(prefix=""):
    """The capabilities of the type of SNES that the user asks for, under a prefix of options."""
    from petsc4py import PETSc  # which is initialised when it is first imported

    database = PETSc.Options(prefix)
    return of(database.getString("snes_type", "newtonls"),
              database.getString("snes_python_type", ""))


def tolerated(prefix=""):
    """The norm of a residual that the user asks for, -snes_atol under a prefix of options."""
    from petsc4py import PETSc

    return PETSc.Options(prefix).getReal("snes_atol", TOLERANCE)


def of_snes(snes):
    """The capabilities of a SNES as it is."""
    if snes.getType() != "python":
        return of(snes.getType())
    return getattr(snes.getPythonContext(), "capabilities", UNKNOWN)._replace(name="python")


def has_modes(settings):
    """Whether a tangent is there whose modes can be found: that of a displacement form, which any
    method may solve, or of the method itself.

    ``settings``: Form (options ``-contact_*``).
    """
    return FORMS[settings.form].in_displacements or asked().has_tangent
