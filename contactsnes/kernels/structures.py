"""The structures of kernels.h, field by field, and what fills their pointers."""

import ctypes
from ctypes import POINTER, addressof, c_char_p, c_double, c_int, c_long, c_void_p

import numpy as np

MOST = 3
"""Components, at most."""

PATCHES = 3
"""Sizes of patches."""

PLACES = 16
"""Places of a rule on the way of a step, at most."""

TOO_MANY, FAILED = 83, 1
"""Status of a count of transforms beyond its limit, and of what has gone wrong in Python."""


NUMBERS = frozenset(map(np.dtype, (np.float64, np.complex128, np.float32, np.complex64, np.intc,
                                   np.short)))
"""Types that kernels know."""

_memory_of = (ctypes.c_char * 0).from_buffer


def address(array):
    """Where a contiguous array of floats or doubles, complex ones or C's integers begins; None of
    no array.

    Raises
    ------
    ValueError : for an array of another kind
    """
    if array is None:
        return None
    flags = array.flags
    if array.dtype not in NUMBERS or not flags.c_contiguous:
        raise ValueError("kernels take contiguous arrays of floats, doubles, or of ints")
    # a quarter of the time of `ctypes.data`, but not for what is not to be changed
    return (addressof(_memory_of(array)) if flags.writeable
            else array.__array_interface__["data"][0])


AddUp = ctypes.CFUNCTYPE(c_int, c_void_p, c_long)
Multiply = ctypes.CFUNCTYPE(c_int, c_void_p, c_void_p, c_int)
Missing = ctypes.CFUNCTYPE(c_int, c_long, c_long, c_long, c_long)
Elsewhere = ctypes.CFUNCTYPE(c_int, c_void_p, c_void_p)


class Law(ctypes.Structure):
    """A traction law."""

    _fields_ = [("sheared", c_void_p), ("tractions", c_void_p), ("normal", c_void_p),
                ("parameters", c_void_p), ("peak", c_double), ("barrier", c_double),
                ("repulsion", c_double)]


class Line(ctypes.Structure):
    """Cosine transforms of rows."""

    _fields_ = [("points", c_long), ("closed", c_long), ("row", c_void_p), ("half", c_void_p),
                ("turn", c_void_p), ("to_row", c_void_p), ("to_half", c_void_p)]


class Transform(ctypes.Structure):
    """Transforms of fields."""

    _fields_ = [("even", c_long), ("count", c_long), ("shape", c_long * 2), ("waves", c_long),
                ("single", c_long), ("real", c_void_p), ("spectrum", c_void_p),
                ("odd", c_long * 2 * (2 * MOST)), ("both", c_long * 2), ("line", Line * 2),
                ("forward", c_void_p), ("backward", c_void_p), ("packed", c_long),
                ("columns", c_void_p), ("columns_back", c_void_p), ("block", c_void_p),
                ("cost", c_double), ("counter", c_void_p), ("multiply", Multiply)]


class Response(ctypes.Structure):
    """A convolution."""

    _fields_ = [("transform", POINTER(Transform)), ("components", c_long), ("boxes", c_long),
                ("shape", c_long * 2), ("symbol", c_void_p * MOST * MOST),
                ("is_complex", c_long * MOST * MOST), ("crosses", c_long * MOST * MOST),
                ("product", c_void_p), ("picked", c_long), ("on_circle", c_void_p),
                ("in_box", c_void_p), ("pairs", c_void_p)]


class Shares(ctypes.Structure):
    """Rows of which processes get columns."""

    _fields_ = [("parts", c_long), ("own", c_long), ("rows", c_long), ("place", c_long),
                ("size", c_long), ("first", POINTER(c_long)), ("here", c_void_p),
                ("packed", c_void_p), ("came", c_void_p), ("fields", c_long * 3),
                ("sides", c_long), ("wide", c_long)]


class Columns(ctypes.Structure):
    """Columns of spectra that are shared out."""

    _fields_ = [("count", c_long), ("rows", c_long), ("columns", c_long), ("single", c_long),
                ("spectrum", c_void_p), ("block", c_void_p), ("there", c_void_p),
                ("back", c_void_p)]


class Form(ctypes.Structure):
    """The equations of a form."""

    _fields_ = [("components", c_long), ("nodes", c_long), ("forced_count", c_long),
                ("forced", c_long * MOST), ("evaluations", c_long), ("products", c_long),
                ("known", c_long), ("single", c_long), ("root", c_double), ("size", c_double),
                ("total", c_double * MOST), ("answered", c_double),
                *((name, c_void_p) for name in ("scale", "unscale", "weight", "initial_gap",
                                                "tangent", "ahead", "last", "rigid", "far",
                                                "row_scale", "target", "drag")),
                ("law", POINTER(Law)), ("response", POINTER(Response)),
                ("quick", POINTER(Response)), ("held", c_long), ("add_up", AddUp)]


class Motion(ctypes.Structure):
    """A damped motion."""

    _fields_ = [("components", c_long), ("nodes", c_long), ("waves", c_long), ("wide", c_long),
                *((name, c_void_p) for name in ("displacement", "velocity", "force",
                                                "acceleration", "gap", "work", "initial_gap",
                                                "node_weight", "weight", "mass", "mobility")),
                ("stiffness", c_void_p * MOST * MOST), ("compliance", c_void_p * MOST * MOST),
                ("is_complex", c_long * MOST * MOST), ("mean_stiffness", c_double * MOST),
                ("target", c_double * MOST), ("mobile", c_double * MOST),
                *((name, c_double) for name in ("size", "range", "harmless", "reference",
                                                "lightest", "stiffening", "closest", "within")),
                ("law", POINTER(Law)), ("transform", POINTER(Transform))]


class Arc(ctypes.Structure):
    """Arc length around a form."""

    _fields_ = [*((name, c_void_p) for name in ("start", "direction", "load", "target", "far",
                                                "row_scale", "factor", "tangent", "anchor")),
                ("length", c_double), ("rate", c_double), ("load_column", c_void_p)]


class Circle(ctypes.Structure):
    """A circle that a core fits on."""

    _fields_ = [("raw", c_long * 2), ("apart", c_long), ("transform", POINTER(Transform)),
                ("quick", POINTER(Transform)), ("compliance", c_void_p), ("symbol", c_void_p),
                ("no_lag", c_double)]


class Block(ctypes.Structure):
    """A core block."""

    _fields_ = [("on", c_long), ("first", c_long * 2), ("extent", c_long * 2), ("made", c_long),
                ("apart", c_long), ("before", c_long * 2), ("within", c_double),
                ("circle", POINTER(Circle)),
                *((name, c_void_p) for name in ("into", "back", "mean", "column", "inverse")),
                ("picked", c_long), ("node", c_void_p), ("at", c_void_p)]


class Blur(ctypes.Structure):
    """A blur of masks over boxes."""

    _fields_ = [("shape", c_long * 2), ("reach", c_long * 2), ("wraps", c_long * 2),
                ("sums", c_void_p)]


class TwoGrids(ctypes.Structure):
    """One component on two grids."""

    _fields_ = [("transform", POINTER(Transform)), ("nodes", c_long), ("points", c_long),
                ("patch", c_void_p), ("inverse", c_void_p),
                ("stiffness", c_void_p), ("core", c_void_p), ("there", c_void_p),
                ("compliance", c_void_p), ("symbol", c_void_p), ("mean", c_void_p),
                ("within", c_void_p), ("number", c_void_p), ("area", c_double),
                ("left", c_double), ("compliant", c_double), ("sums", c_void_p),
                ("rows", c_void_p), ("made", c_void_p), ("matrix", c_void_p),
                ("count", c_long), ("add_up", AddUp)]


class Zone(ctypes.Structure):
    """A preconditioner."""

    _fields_ = [("form", POINTER(Form)), ("arc", POINTER(Arc)), ("threshold", c_double),
                ("pad", c_double), ("floor", c_double), ("reach", c_long * 2),
                ("wraps", c_long * 2), ("applications", c_long), ("set_ups", c_long),
                ("circles", POINTER(Circle) * MOST), ("circle_count", c_long * MOST),
                ("missing", Missing), ("elsewhere", Elsewhere), ("sizes", c_long * PATCHES),
                ("left", c_double * PATCHES), ("patched", c_long), ("start", c_long * 2),
                ("shortest", c_double * PATCHES * MOST), ("between", c_void_p * MOST),
                ("kernel_at_zero", c_double * MOST), ("block", Block * MOST),
                ("grids", POINTER(TwoGrids) * MOST), ("mean_count", c_long),
                ("means", c_long * MOST), ("columns", c_void_p),
                ("mask", c_void_p), ("blur", c_void_p), ("sums", c_void_p),
                ("column", c_void_p), ("slope", c_double),
                ("inverse", c_double * (MOST * MOST))]


class Overdamped(ctypes.Structure):
    """Linearised overdamped motion."""

    _fields_ = [("form", POINTER(Form)), ("zone", POINTER(Zone)), ("row", c_double * MOST),
                ("push", c_double * MOST)]


class System(ctypes.Structure):
    """What PETSc calls back with."""

    _fields_ = [("form", POINTER(Form)), ("arc", POINTER(Arc)), ("zone", POINTER(Zone)),
                ("ksp", c_void_p), ("chooses", c_long), ("patience", c_long), ("turned", c_long),
                ("safe", c_double),
                ("newton_stiffness", c_double), ("smallest", c_double * 2), ("told", c_long),
                ("operator_text", c_char_p), ("zone_text", c_char_p)]


class Site(ctypes.Structure):
    """Nodes of a contact, and what is there."""

    _fields_ = [("law", POINTER(Law)), ("nodes", c_long), ("initial_gap", c_void_p),
                ("weight", c_void_p), ("contact", c_double), ("peak", c_double),
                ("normal", c_double), ("sharp", c_double), ("parts", c_double * MOST),
                ("halved", c_long), ("closed", c_long), ("sign", c_int * MOST),
                ("least", c_double)]


class Limits(ctypes.Structure):
    """What steps are judged by."""

    _fields_ = [*((name, c_double) for name in ("strays", "share", "longest", "reach", "held",
                                                "open", "doubtful", "trifle")),
                ("count", c_long), ("places", c_double * PLACES), ("shares", c_double * PLACES)]


class Libraries(ctypes.Structure):
    """Functions of others that the library calls."""

    _fields_ = [(name, c_void_p) for name in
                ("execute", "execute_single", "execute_rows",
                 "execute_rows_single", "to_half", "to_half_single", "to_row",
                 "to_row_single", "alignment", "alignment_single", "get_read", "put_read", "get",
                 "put", "mat_context", "pc_context", "assembly_begin", "assembly_end", "get_ksp",
                 "iterations", "eigenvalues", "print", "tolerances", "right_side", "norm")]


STRUCTURES = {cls.__name__: cls for cls in (Law, Line, Transform, Response, Shares, Columns, Form,
                                            Motion, Arc, Circle, Block, Blur, Zone, TwoGrids,
                                            Overdamped, System, Site, Limits, Libraries)}
"""By the name that kernels.h gives them."""
