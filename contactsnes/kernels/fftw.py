"""Plans of FFTW for the library's transforms, and what it learned about those in double precision,
kept in a file."""

import atexit
import contextlib
import ctypes
import os
from ctypes import POINTER, c_char_p, c_int, c_uint, c_void_p
from functools import lru_cache
from pathlib import Path

from .library import fftw

ESTIMATE, DESTROY_INPUT, WISDOM_ONLY = 64, 1, 1 << 21
"""FFTW's flags: plans are estimated, not measured, since what was fastest on a busy machine would
decide the last bits. By the last one a plan is made only if it is known how."""

MOST = 2 ** 18
"""Bytes of a file of what FFTW has learned from which it is begun anew."""

KINDS = ("fftw", "fftwf")
"""What FFTW's functions in double and single precision begin with."""

_state = {"file": None, "taken": None, "made": 0, "read": 0}


@lru_cache(maxsize=1)
def _calls():
    """FFTW's functions, with their arguments."""
    library, sizes = fftw(), POINTER(c_int)
    arguments = [c_int, sizes, c_int, c_void_p, sizes, c_int, c_int, c_void_p, sizes, c_int, c_int,
                 c_uint]
    for kind in KINDS:
        whole = getattr(library, f"{kind}_plan_many_dft")
        whole.argtypes, whole.restype = [*arguments[:-1], c_int, c_uint], c_void_p
        for name in ("plan_many_dft_r2c", "plan_many_dft_c2r"):
            getattr(library, f"{kind}_{name}").argtypes = arguments
            getattr(library, f"{kind}_{name}").restype = c_void_p
        destroy = getattr(library, f"{kind}_destroy_plan")
        destroy.argtypes, destroy.restype = [c_void_p], None
    library.fftw_import_wisdom_from_filename.argtypes = [c_char_p]
    library.fftw_export_wisdom_to_filename.argtypes = [c_char_p]
    return library


class Rows:
    """A pair of plans of complex transforms of rows that stand one after another.

    Parameters
    ----------
    points, count : int, points of a row and number of rows
    memory : address of (count, points) complex numbers
    found : address of those that both find; None: in place, which FFTW does with copies of its own
    single : bool, whether these are in single precision
    apart : int, from the begin of a row to that of the next one; None: they touch
    """

    def __init__(self, points, count, memory, found=None, single=True, apart=None):
        sizes, way, self._kind = (c_int * 1)(points), [None, 1, apart or points], KINDS[single]
        make = getattr(_calls(), f"{self._kind}_plan_many_dft")
        self.forward, self.backward = (make(1, sizes, count, memory, *way, found or memory, *way,
                                            sign, ESTIMATE) for sign in (-1, 1))

    def __del__(self):
        for plan in (getattr(self, "forward", None), getattr(self, "backward", None)):
            if plan and ctypes is not None:
                getattr(_calls(), f"{self._kind}_destroy_plan")(plan)


class Plans:
    """A pair of plans of real transforms of ``count`` arrays, destroyed with it.

    Parameters
    ----------
    shape : tuple of int, points in each direction
    count : int
    real, half : addresses of (count, *shape) numbers and of their half spectra; both plans may
        overwrite what they read
    single : bool, whether these are floats, not doubles
    """

    def __init__(self, shape, count, real, half, single=False):
        library, self._kind = _calls(), KINDS[single]
        make = {way: getattr(library, f"{self._kind}_plan_many_dft_{way}")
                for way in ("r2c", "c2r")}
        sizes = (c_int * len(shape))(*shape)
        points, waves = 1, shape[-1] // 2 + 1
        for n in shape:
            points *= n
        waves *= points // shape[-1]
        real, half = (real, None, 1, points), (half, None, 1, waves)
        self.to_half, self.to_row = (_planned(make[way], (len(shape), sizes, count, *there), single)
                                     for way, there in (("r2c", real + half), ("c2r", half + real)))

    def __del__(self):
        for plan in (getattr(self, "to_half", None), getattr(self, "to_row", None)):
            if plan and ctypes is not None:
                getattr(_calls(), f"{self._kind}_destroy_plan")(plan)


def _planned(make, arguments, single):
    """A plan of real transforms, which counts where FFTW learns from it what is to be kept.

    Parameters
    ----------
    make : FFTW's function
    arguments : of it, but for the flags
    single : bool, whether it is for floats, of which nothing is kept
    """
    flags = ESTIMATE | DESTROY_INPUT
    known = None if single else make(*arguments, flags | WISDOM_ONLY)
    _state["made"] += not (single or known)
    return known or make(*arguments, flags)


def remember(folder):
    """Take in what earlier runs learned about plans, from a file in a folder, and keep it there at
    the end; a folder that cannot be written costs nothing but time."""
    file = Path(folder) / "fftw.wisdom"
    if _state["file"] is None:
        atexit.register(_keep)
    if _state["file"] != file:
        _state.update(file=file, read=_state["made"])
    _take_in(file)


def _take_in(file):
    """Take in what a file holds, unless that has been done since it was written."""
    try:
        found = file.stat()
    except OSError:
        return
    written = file, found.st_mtime_ns, found.st_size
    # What is not of this FFTW is not taken; that of many scenes would take longer than their plans.
    if written != _state["taken"] and found.st_size < MOST:
        _calls().fftw_import_wisdom_from_filename(os.fsencode(file))
    _state["taken"] = written


def _keep():
    """Write the file, whole or not at all, if plans were made that it does not know."""
    file = _state["file"]
    if _state["made"] - _state["read"] < 2:
        return
    _take_in(file)  # runs beside this one have learned, too
    part = file.with_name(f"{file.name}.{os.getpid()}")
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        if _calls().fftw_export_wisdom_to_filename(os.fsencode(part)):
            os.replace(part, file)
    with contextlib.suppress(OSError):  # what a full disk took of it, if anything
        part.unlink()
