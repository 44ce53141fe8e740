"""Events of PETSc's -log_view for what a contact spends its time on."""

import functools

from petsc4py import PETSc

from ..continuation.predictors import PREDICTORS
from ..grid.cell import Transform
from ..grid.cosines import Cosines
from ..solvers.preconditioners import ZonePC


def log_events(contact):
    """Have -log_view tell of tractions of the law, transforms, the preconditioner, its set-up, and
    predictions (with their linear solves); for the rest of the process."""
    law = type(contact.law)
    _log("ContactLaw", (law, "evaluate"))
    _log("ContactTransform", *((cls, name) for cls in (Transform, Cosines)
                               for name in ("forward", "backward")))
    _log("ContactPCApply", (ZonePC, "apply"))
    _log("ContactPCSetUp", (ZonePC, "setUp"))
    _log("ContactPredict", *((type(predictor), "state") for predictor in PREDICTORS.values()))


def _log(name, *places):
    """Make an event of methods, given as (class, name); once, however often it is asked for."""
    event = PETSc.Log.Event(name)
    for cls, method in places:
        if not hasattr(getattr(cls, method), "event"):
            setattr(cls, method, _logged(getattr(cls, method), event))


def _logged(function, event):
    """A function whose calls belong to an event; not those that it makes of itself."""
    depth = 0

    @functools.wraps(function)
    def call(*arguments, **named):
        nonlocal depth
        if not depth:
            event.begin()
        depth += 1
        try:
            return function(*arguments, **named)
        finally:
            depth -= 1
            if not depth:
                event.end()

    call.event = event
    return call
