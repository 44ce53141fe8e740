"""Points as archives keep them for going on: arrays, numbers and strings, and points of these."""

import numpy as np

from ..contact import energies
from ..contact.problem import DISPLACEMENT, FORCE
from ..contact.state import State
from ..continuation.points import Point
from ..grid import numbers
from ..options.fields import InputError
from ..scene.load import units

KEPT = ("leg", "position", "step", "arc", "load", "displacements", "forces", "in_contact",
        "sliding", "residual_norm", "largest_residual", "event", "fold_kind", "elastic_energy",
        "interfacial_energy", "smooth_steps", "jump_work", "viscous_work", *energies.WORKS,
        "stable", "unstable_modes", "leading_eigenvalue", "resolved", "fold_precision", "softest")
"""What of a point, besides state, controls and origin, an archive keeps for going on from it."""


def packed(contact, point):
    """Arrays, numbers and strings from which `restored` makes a point of a contact again."""
    state = point.state
    return {**{name: getattr(point, name) for name in KEPT},
            "event": point.event or "none",
            "displacement": contact.grid.parted(state.displacement),
            "means": state.means, **numbers.numbers_of(state.window),
            "forced": np.array([control == FORCE for control in point.controls]),
            "origin": point.load if point.origin is None else point.origin}


def restored(contact, kept):
    """The point of a contact that was `packed`; InputError for one that another version of this
    program packed.

    Parameters
    ----------
    contact : Contact
    kept : mapping
    """
    lost = [name for name in KEPT if name not in kept]
    if lost:
        raise InputError(f"a point to go on from says nothing of {', '.join(lost)}: it was "
                         "kept by another version of this program; begin anew")
    window, field = numbers.restored(contact.grid, kept, kept["displacement"])
    state = State(window, np.array(field), np.array(kept["means"]))
    controls = tuple(FORCE if forced else DISPLACEMENT for forced in kept["forced"])
    return Point(state=state, controls=controls, origin=np.array(kept["origin"]),
                 units=units(contact.scene),
                 **{**{name: kept[name] for name in KEPT},
                    "event": None if kept["event"] == "none" else kept["event"]})
