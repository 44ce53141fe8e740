"""PETSc's callbacks from the compiled library: a solve of a form that has a kernel does not enter
Python, but for a circle of the preconditioner that is met for the first time."""

import ctypes
from functools import cache, lru_cache

import numpy as np
from petsc4py import PETSc

from ..contact.bordered import ArcLength
from ..kernels import library, structures
from ..kernels.asked import raise_error
from ..kernels.forms import call
from ..kernels.zones import CompiledZone
from ..options.database import read
from ..options.fields import InputError
from .core_zone import CoreOptions
from .krylov import is_ours, of_ksp, release
from .operators import about
from .precision import PATIENCE, SAFE
from .vectors import create_vector

MULTIPLY, MULTIPLY_TRANSPOSED, VIEW = 3, 5, 61
"""PETSc's MATOP_MULT, MATOP_MULT_TRANSPOSE and MATOP_VIEW."""

CALLED = {"get_read": "VecGetArrayRead", "put_read": "VecRestoreArrayRead", "get": "VecGetArray",
          "put": "VecRestoreArray", "mat_context": "MatShellGetContext",
          "pc_context": "PCShellGetContext", "assembly_begin": "MatAssemblyBegin",
          "assembly_end": "MatAssemblyEnd", "get_ksp": "SNESGetKSP",
          "iterations": "KSPGetIterationNumber", "eigenvalues": "KSPComputeEigenvalues",
          "print": "PetscViewerASCIIPrintf", "tolerances": "KSPGetTolerances",
          "right_side": "KSPGetRhs", "norm": "VecNorm"}
"""Member of the library's structure -> PETSc's function."""

OWN_ZONE = "contactsnes.solvers.preconditioners.ZonePC"
"""What -pc_python_type calls the form's own preconditioner."""

FULL_STEPS = (b"basic", b"none")
"""Line searches that take a step as it is, by their older and their newer name."""

NO_JACOBIAN = ("-snes_mf leaves no Jacobian to make zones from: take -snes_mf_operator, or "
               "-pc_type none with it")


@lru_cache(maxsize=1)
def connected():
    """(library, PETSc, which prints with Python's lock), connected; None where that cannot be."""
    try:
        compiled, petsc = library.shared(), ctypes.PyDLL(PETSc.__file__)
        pointers = library.pointers(compiled)
        for member, name in CALLED.items():
            setattr(pointers, member, library.pointer(petsc, name))
    except library.Unavailable:
        return None
    return compiled, petsc


def available(form):
    """Whether the solves of a form can be the library's: where processes share out its nodes, what
    they tell each other is Python's to send."""
    return (getattr(form, "kernel", None) is not None and not form.grid.shared
            and connected() is not None)


def _call(name, *arguments):
    """Call a function of PETSc by handles and addresses; PETSc.Error where it fails."""
    status = getattr(connected()[1], name)(*[ctypes.c_void_p(part) if isinstance(part, int)
                                             else part for part in arguments])
    if status:
        raise PETSc.Error(status)


@cache
def _function(name):
    """The address of a function of the library."""
    return library.pointer(connected()[0], name)


class Callbacks:
    """What PETSc calls for a form, and how a user sees it by -snes_view.

    Parameters
    ----------
    form : with a kernel
    options : CoreOptions of the preconditioner
    ksp : KSP whose solves may be in single precision, or None

    Attributes
    ----------
    zone : CompiledZone
    """

    def __init__(self, form, options, ksp=None):
        arc = form.kernel if isinstance(form, ArcLength) else None
        kernel = form.kernel if arc is None else arc.kernel
        self.form, self.kernel = form, form.kernel
        single = ksp is not None
        self.zone = CompiledZone(kernel, options, 0.0 if arc is None else 1e-5, arc, single)
        self._texts = (_about_operator(form).encode(), _about_zone(options).encode())
        self.structure = structures.System(operator_text=self._texts[0], zone_text=self._texts[1],
                                           chooses=single, patience=PATIENCE, safe=SAFE)
        if single:
            # it is no more than the address, and used in its solves only
            self.structure.ksp = ksp.handle
        self.structure.form = ctypes.pointer(kernel.structure)
        self.structure.zone = ctypes.pointer(self.zone.structure)
        if arc is not None:
            self.structure.arc = ctypes.pointer(arc.structure)
        self.address = ctypes.addressof(self.structure)

    def choose(self):
        """Choose the precision of what comes next in a linear solve."""
        call(connected()[0].choose, self.form.grid.counter, self.address, 0)


class CompiledPrecision:
    """What is known of the precision of solves in the library, as `precision.Precision`."""

    def __init__(self, structure):
        self._structure = structure

    @property
    def allowed(self):
        """Whether solves may be in single precision."""
        return bool(self._structure.chooses)

    @allowed.setter
    def allowed(self, allowed):
        """Allow them to be, where they can."""
        self._structure.chooses = allowed and bool(self._structure.ksp)

    @property
    def turned(self):
        """Number of solves that went on in double precision."""
        return self._structure.turned


class CompiledRitz:
    """What the monitor of a SNES in the library keeps, as `ritz.Ritz`."""

    def __init__(self, structure):
        self._structure = structure

    @property
    def smallest(self):
        """Smallest real part of the Ritz values of the last two linear solves that told anything,
        nan where none did."""
        told = min(self._structure.told, 2)
        return min(self._structure.smallest[:told], default=np.nan)


def _about_operator(form):
    """What -snes_view prints of the operator."""
    return f"{about(form)}, compiled\n"


def _about_zone(options):
    """What -snes_view prints of the preconditioner."""
    return (f"    CoreZone: threshold {options.threshold:g}, width {options.width:g} / "
            f"lambda_n, pad {options.pad:g}, compiled\n")


def operator(ksp, form, single=False):
    """The matrix of a form's Jacobian in the library, whose preconditioner a KSP is given.

    Parameters
    ----------
    ksp : KSP
    form : with a kernel
    single : bool, whether solves may be in single precision
    """
    pc = ksp.getPC()
    own = Callbacks(form, read(CoreOptions, pc.getOptionsPrefix() or ""), ksp if single else None)
    matrix = PETSc.Mat().create(PETSc.COMM_SELF)
    matrix.setSizes([form.size, form.size])
    matrix.setType("shell")
    _call("MatShellSetContext", matrix.handle, own.address)
    for operation, name in ((MULTIPLY, "mat_mult"), (MULTIPLY_TRANSPOSED, "mat_mult_transpose"),
                            (VIEW, "mat_view")):
        _call("MatShellSetOperation", matrix.handle, ctypes.c_int(operation), _function(name))
    matrix.setUp()
    set_shell(pc, own)
    # it has to live as long as any of them
    for thing in (ksp, matrix, pc):
        thing.setAttr("callbacks", own)
    return matrix


def set_shell(pc, own):
    """Make a PETSc preconditioner that of a form's Callbacks in the library."""
    pc.setType("shell")
    _call("PCShellSetContext", pc.handle, own.address)
    for name, function in (("SetUp", "pc_set_up"), ("Apply", "pc_apply"), ("View", "pc_view")):
        _call(f"PCShellSet{name}", pc.handle, _function(function))


def equip(snes, form, single=False):
    """Give a SNES a form's function, Jacobian and preconditioner in the library; the precision of
    its solves.

    Parameters
    ----------
    snes, form, single : SNES, form with a kernel, bool as of `operator`
    """
    matrix = operator(snes.getKSP(), form, single)
    own = of(matrix)
    snes.setAttr("callbacks", own)
    residual = PETSc.Vec().createSeq(form.size)
    _call("SNESSetFunction", snes.handle, residual.handle, _function("snes_function"), own.address)
    _call("SNESSetJacobian", snes.handle, matrix.handle, matrix.handle,
          _function("snes_jacobian"), own.address)
    return CompiledPrecision(own.structure)


def of(thing):
    """The Callbacks of a SNES, a matrix or a preconditioner, or None."""
    return thing.getAttr("callbacks") if thing else None


def set_from_options(snes):
    """Have a SNES or a KSP read its options; InputError where these leave our
    preconditioner no Jacobian.

    ``-pc_type python`` is the library's, too, where no other class than the form's own is named.
    """
    snes.setFromOptions()
    own = of(snes)
    pc = (snes.getKSP() if isinstance(snes, PETSc.SNES) else snes).getPC()
    database = PETSc.Options(snes.getOptionsPrefix() or "")
    named = database.getString("pc_python_type", OWN_ZONE) == OWN_ZONE
    if own and named and pc.getType() == "python":
        set_shell(pc, own)
    # (where it is no shell, PETSc would take it away without a word)
    if is_ours(pc) and database.getBool("snes_mf", False):
        raise InputError(NO_JACOBIAN)


def regularise(snes, stiffness):
    """Have Newton's steps of a SNES, equipped here, taken in the regularised gap with kappa, a
    ``stiffness`` in phi_n/delta_n^2; what holds it as ``newton_stiffness``."""
    own = of(snes)
    own.structure.newton_stiffness = stiffness
    search = ctypes.c_void_p()
    _call("SNESGetLineSearch", snes.handle, ctypes.byref(search))
    _call("SNESLineSearchSetPreCheck", search.value, _function("pre_check"), own.address)
    return own.structure


def share_work(snes, form):
    """Have full steps of Newton's method and linear solves of ours, which take turns, work in one
    Vec; PETSc's line search gets no second one, of which full steps need none.

    Parameters
    ----------
    snes : SNES, as options have it
    form : of the equations
    """
    own = of_ksp(snes.getKSP())
    if own is None or snes.getType() != PETSc.SNES.Type.NEWTONLS or connected() is None:
        return
    search, kind = ctypes.c_void_p(), ctypes.c_char_p()
    _call("SNESGetLineSearch", snes.handle, ctypes.byref(search))
    _call("SNESLineSearchGetType", search.value, ctypes.byref(kind))
    if kind.value in FULL_STEPS:
        own.idle = create_vector(form)
        for _ in range(2):  # which PETSc destroys with its search, but does not count
            own.idle.incRef()
        _call("SNESLineSearchSetVecs", search.value, None, None, None, own.idle.handle,
              own.idle.handle)


def watch_modes(snes):
    """Have a SNES keep its Ritz values; the CompiledRitz that tells them."""
    own = of(snes)
    _call("SNESMonitorSet", snes.handle, _function("monitor_modes"), own.address,
          ctypes.c_void_p())
    return CompiledRitz(own.structure)


def solve(snes, solution):
    """Run a SNES, or a KSP of one, from a Vec, which it overwrites; exceptions of Python that the
    library could not pass on, or petsc4py did not, are raised.

    Parameters
    ----------
    snes : SNES or KSP
    solution : Vec, or (right-hand side, Vec) of a KSP
    """
    right, solution = solution if isinstance(solution, tuple) else (None, solution)
    try:
        snes.solve(right, solution)
    except PETSc.Error as error:
        own = of(snes)
        if own is not None:
            raise_error()
            own.form.grid.counter.check()
        raise error.__cause__ or error  # newer petsc4py wraps what our callbacks raise
    finally:
        release(snes.getKSP() if isinstance(snes, PETSc.SNES) else snes)
