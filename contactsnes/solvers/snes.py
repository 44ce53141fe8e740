"""PETSc's nonlinear solver around a form of the contact problem: operators, defaults, and the
user's options over them."""

import atexit
import weakref
from contextlib import contextmanager

from petsc4py import PETSc

from ..contact.balance import TOLERANCE
from ..options.database import read
from . import callbacks, spots
from .capabilities import asked
from .convergence import displacement_test
from .krylov import LARGE, of_ksp, set_defaults
from .multigrid import create_levels
from .operators import Jacobian
from .precision import Precision
from .regularised import NewtonOptions, regularise
from .ritz import Ritz
from .vectors import collect, communicator, create_operator, create_vector


def _names(cls):
    """Value -> name of the enumeration that petsc4py keeps as class attributes."""
    return {value: name for name, value in vars(cls).items() if isinstance(value, int)}


SNES_REASONS, KSP_REASONS = _names(PETSc.SNES.ConvergedReason), _names(PETSc.KSP.ConvergedReason)
EARLY = {"CONVERGED_FNORM_RELATIVE": "-snes_rtol", "CONVERGED_SNORM_RELATIVE": "-snes_stol"}
"""Reason to stop, by name, above -snes_atol -> its option, 0 unless a user gives it."""


TRUST = "newtontr", "newtontrdc"
"""Methods that ask a linear solve for its solution after each iteration, which PETSc's has."""
COLD, WARM = 200, 16
"""Most Newton iterations of a solve from afar, and of a step: one that needs more is better made
shorter."""


def equip(snes, form, single=False, packed=False):
    """Give a SNES a form's function and exact Jacobian, compiled ones where there are, and our
    defaults for its linear systems; the precision of its solves.

    Parameters
    ----------
    snes : SNES
    form : of the equations
    single, packed : bools, whether products of linear solves, and their vectors, may be in single
        precision
    """
    kind = PETSc.Options(snes.getOptionsPrefix() or "").getString("snes_type", "")
    set_defaults(snes.getKSP(), form, (single or packed) and kind not in TRUST)
    if callbacks.available(form):
        return callbacks.equip(snes, form, single)
    snes.setFunction(lambda snes, x, f: form.residual(x.getArray(readonly=True), f.getArray()),
                     create_vector(form))
    precision = Precision(snes if single else None)
    matrix = create_operator(form, Jacobian(form, precision))

    def linearise(snes, x, operator, preconditioner):
        form.linearise(x.getArray(readonly=True))
        # Assembling tells PETSc that the preconditioner has to be set up again.
        operator.assemble()
        if preconditioner.handle != operator.handle:
            preconditioner.assemble()

    snes.setJacobian(linearise, matrix, matrix)
    snes.getKSP().getPC().setType("python")
    snes.getKSP().getPC().setPythonType(callbacks.OWN_ZONE)
    return precision


@contextmanager
def full_steps(database, kind):
    """Newton's method takes full steps, and its residual may grow on the way, where the user has
    not chosen otherwise; PETSc's options are as they were after it has read them, however that
    ends."""
    prefixes = {"newtonls": ("",), "fas": ("fas_levels_", "fas_coarse_")}.get(kind, ())
    # From a good guess full steps may first lead to ten thousand times its residual: what ends them
    # is the number of iterations.
    own = {prefix + name: value for prefix in prefixes
           for name, value in (("snes_linesearch_type", "basic"),
                               ("snes_divergence_tolerance", "-1"))
           if not database.hasName(prefix + name)}
    try:
        for name, value in own.items():
            database[name] = value
        yield
    finally:
        for name in own:
            database.delValue(name)


def create_snes(form, prefix="", tolerance=None, single=False, packed=False):
    """The SNES of a form, set up by our defaults and then by the user's options.

    Defaults: newtonls with full steps in the regularised gap, matrix-free Jacobian, fgmres with the
    form's own preconditioner, Eisenstat-Walker forcing 0.5 (|F|/|F_old|)^1.6 from 0.1, -snes_atol
    1e-8, -snes_rtol and -snes_stol 0.

    Parameters
    ----------
    form : of the equations, which gets ``precision``, ``regularised``, ``ritz`` and ``bounded``
    prefix : of the options, after the dash
    tolerance : of the residual norm, in place of -snes_atol
    single, packed : bools, as of `equip`
    """
    database = PETSc.Options(prefix)
    snes = kept(PETSc.SNES().create(communicator(form)))
    snes.setOptionsPrefix(prefix)
    snes.appctx, form.bounded = form, database.hasName("snes_max_it")
    form.precision = equip(snes, form, single, packed)
    kind, method = database.getString("snes_type", "newtonls"), asked(prefix)
    snes.setTolerances(rtol=0.0, atol=TOLERANCE, stol=0.0, max_it=method.most_iterations)
    if not form.in_displacements or database.getString("snes_npc_side", "right") == "left":
        snes.setConvergenceTest(displacement_test, (form,))
    with full_steps(database, kind):
        smoothers = create_levels(snes, form, equip) if kind == "fas" else []
        if method.forcing and not database.hasName("ksp_rtol"):
            snes.setUseEW(True)
            snes.setParamsEW(version=2, rtol_0=0.1, rtol_max=0.1, gamma=0.5, alpha=1.6)
        callbacks.set_from_options(snes)
    callbacks.share_work(snes, form)
    if tolerance is not None:
        snes.setTolerances(atol=tolerance)
    if not database.hasName("ksp_atol") and snes.getKSP().getPCSide() == PETSc.PC.Side.RIGHT:
        # Below half the tolerance of the outer iteration a linear solve polishes what nobody asks
        # for.
        snes.getKSP().setTolerances(atol=0.5 * snes.getTolerances()[1] * form.linear_tolerance)
    watch_modes(snes, form, method, spots.offer(snes, form, single))
    regularise([*((solver, form) for solver in (snes, *inner_solvers(snes, form))), *smoothers],
               read(NewtonOptions, prefix))
    return snes


def idle(snes, form):
    """(right side, solution) for a linear solve between two solves of a SNES, in Vecs that it fills
    anew when it begins: of its imbalance and its step.

    Parameters
    ----------
    snes : SNES of the form
    form : of the equations
    """
    own = snes.getFunction()[0], snes.getSolutionUpdate()
    return tuple(vector if vector.handle else create_vector(form) for vector in own)


def ended_early(snes):
    """The option by which a SNES ended above -snes_atol, in words; '' where none did."""
    option = EARLY.get(SNES_REASONS.get(snes.getConvergedReason()))
    return f", where {option} ended it: without that it goes on" if option else ""


def solve(snes, form, unknown):
    """Run a SNES of a form from an unknown, an array, which the solution overwrites.

    The Vec of its last solve is put on it, but of large ones: an array stays with that as well; nor
    of those that processes share out, who make Vecs together, whatever their own part's size.

    Parameters
    ----------
    snes, form, unknown : SNES, form, array of the form's size
    """
    small = form.size < LARGE and not form.grid.shared
    solution = snes.getSolution() if small else None
    again = bool(solution)
    if again:
        solution.placeArray(unknown)
    else:
        solution = create_vector(form, unknown)
    try:
        callbacks.solve(snes, solution)
    finally:
        if again:
            solution.resetArray()
        elif not small:
            _let_go(snes, solution)
        solution.destroy()  # at once: older petsc4py does so late


def _let_go(snes, solution):
    """Have a SNES that works in a Vec of its linear solves hold that as its solution: the array of
    the last one is the caller's alone, though PETSc keeps the Vec, which it reads no more, until it
    solves again."""
    own = of_ksp(snes.getKSP())
    if own is not None and own.idle:
        snes.setSolution(own.idle)
        solution.setAttr("__array__", None)


def end_of(snes, form):
    """Norm of F, without the row of an arc, where a SNES ended; None on lines, whose transforms
    take hardly longer than to look."""
    own = getattr(form, "form", form)
    if len(own.grid.shape) == 1:
        return None
    if own is form:
        return snes.getFunctionNorm()
    return own.grid.norm(snes.getFunction()[0].getArray(readonly=True)[:own.size])


def watch_modes(snes, form, method, spots=None):
    """Give a form its monitor of Ritz values, which sees those of a method with a tangent.

    Parameters
    ----------
    snes : SNES of the form
    form : which gets ``ritz``
    method : Capabilities of the type of SNES
    spots : SpotsPC of its linear systems, or None
    """
    form.ritz = Ritz(spots)
    if spots:
        kept(spots.core)
    # (PETSc takes what fcg keeps for the numbers of cg, and crashes)
    if not method.has_tangent or snes.getKSP().getType() == "fcg":
        return
    snes.getKSP().setComputeEigenvalues(True)
    if callbacks.of(snes) and not (of_ksp(snes.getKSP()) or spots):
        form.ritz = callbacks.watch_modes(snes)
    else:
        snes.setMonitor(form.ritz)


def inner_solvers(snes, form):
    """The SNES objects inside another one on the same form, nonlinear preconditioners and the parts
    of compositions.

    They get our function, Jacobian and preconditioner, too; all other defaults of theirs are
    PETSc's.
    """
    parts = range(snes.getCompositeNumber()) if snes.getType() == "composite" else ()
    inner = [*([snes.getNPC()] if snes.hasNPC() else []), *map(snes.getCompositeSNES, parts)]
    for solver in inner:
        equip(solver, form)
        solver.setFromOptions()
    return inner + [deeper for solver in inner for deeper in inner_solvers(solver, form)]


_alive = weakref.WeakValueDictionary()


def kept(thing):
    """A PETSc object that is destroyed when a script ends, whoever holds it still: an exception
    with its frames, for instance."""
    _alive[id(thing)] = thing
    return thing


@atexit.register
def _destroy_all():
    """Destroy what a script still holds when it ends: PETSc would do so when Python's contexts can
    be called no more."""
    for thing in list(_alive.values()):
        thing.destroy()
    collect()
