"""Options of PETSc that nobody asks for, told before the first solve where that can be known."""

import re

from ..contact import states
from ..options.database import database, unused_options

PLAIN = re.compile(r"(snes|ksp)_(?!.*(view|reason|test|linesearch|compute|error|diagonal|final))")
"""Options of the outer solver that it asks for when it is made; others are asked for in a solve, or
by solvers inside it, which are made when they are needed."""


def unread_options(branch, classes=()):
    """Names (with dash) of options under -snes_ and -ksp_ that the solver of the first points
    does not ask for when it is set up; empty where nothing can be said.

    Parameters
    ----------
    branch : Branch
    classes : dataclasses of the options of our own PC and SNES types
    """
    asked = [name for name in database() if PLAIN.match(name)]
    if not asked:
        return []
    corrector, initial = branch.corrector, branch.scene.initial(branch.load)[0]
    failed = False
    try:
        state = states.undeformed(branch.contact, (initial.control,), [initial.value])
        corrector.form_on(corrector.fitted(state), (initial.control,))
    except Exception:
        failed = True  # whatever it is, perhaps of a user's own class: the solve will say it
    if branch.contact.grid.any(failed):  # of several processes, perhaps in one alone
        corrector.form = corrector.snes = None  # half made
        return []
    own = tuple(cls.prefix for cls in classes)
    return [name for name in unused_options(classes)
            if PLAIN.match(name[1:]) and not name[1:].startswith(own)]
