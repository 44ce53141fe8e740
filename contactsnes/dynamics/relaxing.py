"""Dynamic relaxation on the whole cell, from an unknown of the force form to a state near rest."""

from ..contact.force_form import ForceForm
from ..continuation.points import NotConverged
from ..solvers.snes import create_snes
from .endings import Leaving

ENDLESS = "the body leaves, sinks in or slides without end"
"""What is said of a motion without an equilibrium."""


def relaxed(run, form, unknown, tolerance, where, prefix="jump_"):
    """Where FIRE leads from an unknown of the force form.

    Parameters
    ----------
    run : function (form, unknown, most iterations or None, snes) -> (unknown, iterations) that
        runs a SNES and counts what it takes (``Corrector.run``)
    form : ForceForm with its load set
    unknown : array of the form's size, overwritten
    tolerance : of ``residual_norm``, ranges of the law
    where : str, what messages say of the place
    prefix : of the options of its SNES

    Raises
    ------
    Leaving : where the body leaves
    NotConverged : where it does not settle
    """
    snes = create_snes(form, prefix=prefix)
    snes.setType("python")
    snes.setPythonType("contactsnes.solvers.relaxation.Fire")
    snes.setTolerances(atol=tolerance, max_it=20000)
    snes.setFromOptions()
    try:
        return run(form, unknown, None, snes)[0]
    except NotConverged as error:
        if (snes.getType() == "python"
                and getattr(snes.getPythonContext(), "escaping", None) is not None):
            raise Leaving from None
        raise NotConverged(f"the motion {where} did not settle: {error}") from None


def nearer(system, guess, controls, load, tolerance):
    """The state to which dynamic relaxation on the cell brings a guess, for Newton to finish.

    Parameters
    ----------
    system : Corrector, for its contact, its symmetry and its ``run``
    guess : State
    controls, load : of each component
    tolerance : of ``residual_norm``, ranges of the law

    Raises
    ------
    NotConverged : where the body leaves, or does not settle
    """
    system.symmetry.checked(guess)
    form = ForceForm(system.contact, controls)
    form.even = system.symmetry.plain(form.components)
    form.set_load(load)
    try:
        unknown = relaxed(system.run, form, form.pack(system.contact.extended(guess)), tolerance,
                          "of the relaxation", "first_")
    except Leaving:
        raise NotConverged(f"{ENDLESS} in the relaxation before the solve") from None
    return form.state(unknown)
