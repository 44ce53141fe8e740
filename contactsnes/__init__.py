"""contactsnes: adhesive frictional contact of elastic bodies, solved by PETSc's nonlinear solvers.

Call ``petsc4py.init(arguments)`` before the first solve if PETSc is to have options. Names are
imported when they are first used, so that importing this package alone does not start PETSc.

Rooms, each of which imports only from those before it: ``options`` and ``system`` (options;
streams, files, processes), ``grid`` (nodes, transforms), ``reference`` (analytic solutions),
``interface`` (laws, bodies, shapes), ``kernels`` (compiled C), ``continuation`` (branches of any
system), ``scene`` (what is solved), ``contact`` (the problem on its grid), ``output`` (archives,
tables, figures), ``solvers`` (PETSc), ``dynamics`` (motion, stability), ``branch`` (from a scene to
its points), ``compare`` and ``commands``.
"""

from importlib import import_module

__version__ = "0.1.0"

_HOMES = {"Scene": "scene.settings", "Load": "scene.load", "Steps": "scene.settings",
          "Form": "scene.settings", "InputError": "options.fields", "option": "options.fields",
          "Law": "interface.laws.law", "Shape": "interface.shapes.shape",
          "Body": "interface.bodies.body", "Contact": "contact.problem", "Branch": "branch.branch",
          "NotConverged": "continuation.points", "NoEquilibrium": "continuation.points",
          "observe": "contact.observables", "table": "contact.observables",
          "Archive": "output.archive", "read": "output.reading", "plot": "output.figures.plot",
          "sweep": "branch.sweep"}

__all__ = ["reference", *_HOMES]


def __getattr__(name):
    if name == "reference":
        return import_module(".reference", __name__)
    if name in _HOMES:
        return getattr(import_module("." + _HOMES[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted([*globals(), *__all__])
