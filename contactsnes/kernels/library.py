"""The compiled library: found, checked against its sources, and connected with FFTW."""

import ctypes
import hashlib
import os
import sys
from functools import lru_cache
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

from . import structures

HERE = Path(__file__).parent
SOURCES = ("kernels.h", "both.h", "precision.h", "columns.h", "pairs.h", "folded.h", "patches.h",
           "transforms.c", "packed.c", "folded.c", "slabs.c", "forms.c", "motion.c", "core_zone.c",
           "patches.c", "two_grids.h", "two_grids.c", "steps.c", "krylov.c", "modes.c", "points.c",
           "paths.c", "petsc.c", "laws.c", "library.c")
"""What the library is made of, in the order of its checksum."""


class Unavailable(Exception):
    """Why there is no compiled library, in words."""


def checksum(folder=HERE):
    """Checksum of the library's sources in a folder."""
    found = hashlib.sha256()
    for name in SOURCES:
        found.update((Path(folder) / name).read_bytes())
    return found.hexdigest()[:32]


def built(folder=HERE):
    """The file of the library in a folder; Unavailable where there is none."""
    for suffix in EXTENSION_SUFFIXES:
        file = Path(folder) / f"_compiled{suffix}"
        if file.exists():
            return file
    raise Unavailable("the library was not built: that takes a C compiler when contactsnes is "
                      "installed")


def load(folder=HERE):
    """The library of a folder, checked: a ctypes.CDLL.

    Raises
    ------
    Unavailable : with the reason
    """
    if sys.byteorder != "little":
        raise Unavailable("the library is for processors that are little-endian")
    file = built(folder)
    try:
        library = ctypes.CDLL(str(file))
        made_from = ctypes.c_char_p.in_dll(library, "kernels_checksum").value.decode()
    except (OSError, ValueError) as error:
        raise Unavailable(f"{file.name} cannot be loaded ({error}): install contactsnes anew"
                          ) from error
    if made_from != checksum(folder):
        raise Unavailable(f"{file.name} was built from other sources than these: install "
                          "contactsnes anew")
    sizes = (ctypes.c_long * len(structures.STRUCTURES)).in_dll(library, "kernels_sizes")
    for size, (name, cls) in zip(sizes, structures.STRUCTURES.items()):
        if size != ctypes.sizeof(cls):
            raise Unavailable(f"{file.name} has another layout of {name} than Python")
    return library


@lru_cache(maxsize=1)
def shared():
    """The library, connected with FFTW; Unavailable with the reason where there is none.

    ``CONTACTSNES_KERNELS=off`` in the environment leaves it out.
    """
    if switched_off():
        raise Unavailable("CONTACTSNES_KERNELS is off")
    library = load()
    for name, function in EXECUTE.items():
        setattr(pointers(library), name, pointer(fftw(), function))
    for name, arguments in CALLS.items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, RETURNED.get(name, ctypes.c_int)
    return library


def switched_off():
    """Whether the environment leaves the library out."""
    return os.environ.get("CONTACTSNES_KERNELS") == "off"


def pointers(library):
    """The functions of others that a library calls."""
    return structures.Libraries.in_dll(library, "libraries")


def pointer(library, name):
    """The address of a function; Unavailable where a library has none of that name."""
    try:
        return ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    except AttributeError:
        raise Unavailable(f"no function {name} is found in {library._name}") from None


@lru_cache(maxsize=1)
def fftw():
    """FFTW in double and single precision, those of pyfftw."""
    from ..grid.fftw import pyfftw

    return ctypes.CDLL(pyfftw.pyfftw.__file__)


def reason():
    """Why NumPy's forms are taken in place of compiled ones, in words; None where they are not."""
    try:
        shared()
    except Unavailable as error:
        return str(error)
    return None


EXECUTE = {"execute": "fftw_execute", "execute_single": "fftwf_execute",
           "execute_rows": "fftw_execute_dft", "execute_rows_single": "fftwf_execute_dft",
           "to_half": "fftw_execute_dft_r2c", "to_half_single": "fftwf_execute_dft_r2c",
           "to_row": "fftw_execute_dft_c2r", "to_row_single": "fftwf_execute_dft_c2r",
           "alignment": "fftw_alignment_of", "alignment_single": "fftwf_alignment_of"}
"""What executes FFTW's plans, by its names here, and tells what memory they may take."""

_pointer, _long, _double = ctypes.c_void_p, ctypes.c_long, ctypes.c_double
CALLS = {"forward": [_pointer, _long], "backward": [_pointer, _long],
         "evaluate": [_pointer, _long, _long, _pointer, _pointer, _pointer],
         **dict.fromkeys(("residual", "product", "transposed_product", "precondition"),
                         [_pointer, _pointer, _pointer]),
         "along_rows": [_pointer, _pointer, _long, ctypes.c_int, ctypes.c_int, _long, ctypes.c_int],
         "turn_field": [_pointer, _long, _long, _pointer, ctypes.c_int, ctypes.c_int],
         "answers": 3 * [_pointer], "filter": 3 * [_pointer],
         "sum_nodes": [*4 * [_pointer], _long, _long, _pointer],
         "subtract_nodes": [*4 * [_pointer], _double, _pointer, _long],
         "put_box": [_pointer, _long, *[_pointer] * 3, _long],
         "blend_box": [_pointer, _long, *[_pointer] * 4, _long],
         "smooth_mask": [_pointer, _pointer, ctypes.c_int, _long, _long, _pointer, _pointer],
         "clear_beyond": [_pointer, _pointer],
         "invert": [_pointer, _pointer, _double, _double, _pointer],
         "folded_rows": [_pointer, _pointer, _long, _long, ctypes.c_int],
         "folded_columns": 4 * [_pointer] + [_long, ctypes.c_int],
         "shared_rows": [_pointer, _pointer, _pointer, ctypes.c_int],
         "shared_columns": 4 * [_pointer] + [ctypes.c_int],
         "along_columns": [_pointer, ctypes.c_int, ctypes.c_int, _pointer, ctypes.c_int],
         "linearise": [_pointer, _pointer], "set_up": [_pointer],
         **dict.fromkeys(("arc_linearise", "load_column"), 3 * [_pointer]),
         **dict.fromkeys(("arc_residual", "arc_product", "arc_transposed"),
                         [_pointer, _pointer, _pointer, _pointer]),
         "hold": [*[_long] * 3, *[_pointer] * 6, _double],
         "ritz": [*[_long] * 2, *[_pointer] * 2, _long, *[_pointer] * 4],
         "overdamped_product": [_pointer] * 3, "overdamped_precondition": [_pointer] * 3,
         "arnoldi": [_pointer, _double, _pointer, _long, _pointer, _long, *[_pointer] * 4,
                     _double],
         "motion_evaluate": [_pointer], "motion_move": [_pointer, _double],
         "motion_advance": [_pointer, _double, _pointer, _double, _pointer, _double],
         "motion_damped": [_pointer, _double, _double, _pointer, _pointer, _pointer],
         "motion_sums": [_pointer, _pointer, _pointer], "motion_squares": [_pointer],
         "gaps_of_regularised": [_pointer, _long, _pointer, _double, _pointer],
         "regularised_step": [_pointer, _double, _pointer, _pointer, _pointer],
         "pseudo_inverse": [_pointer, _long, _double, _pointer],
         "spline": [_long, _long, _long, _pointer, _long, _pointer, _pointer, _pointer],
         **dict.fromkeys(("inner_products", "add_rows"), [_long, _long, *[_pointer] * 4]),
         "rounded": [_long, _pointer, _double, _pointer, _pointer],
         "narrowed": [_long, _pointer, _pointer],
         "patch_nodes": [_long, _pointer, _long, _pointer],
         "weigh_nodes": [_pointer, _pointer], "on_two_grids": 3 * [_pointer],
         "add_from_patches": [_pointer, _long, *[_pointer] * 4],
         "choose": [_pointer, ctypes.c_int],
         "sum_up": [_pointer, _long, _long, *[_pointer] * 3, ctypes.c_int, _pointer, _pointer],
         "iterate": [_pointer, _pointer, _long, _long, _pointer, _pointer, _double, *[_pointer] * 4,
                     _double, _double, _pointer, _pointer],
         "sources": [_long, _long, _long, _pointer, _pointer, _long, _pointer],
         "followed": [_long, _long, _long, *[_pointer] * 5, _double, _pointer, _long,
                      *[_pointer] * 4],
         "followed_plane": [_long, _pointer, _long, *[_pointer] * 6, _double, _pointer, _long,
                            *[_pointer] * 4],
         "works": [_pointer, _long, _long, *[_pointer] * 3, _long, *[_pointer] * 2, _double,
                   _pointer],
         "survey": [_pointer, _long, *[_pointer] * 3],
         "apart": [_long, _long, *[_pointer] * 4, _double, _pointer],
         "closest": [_long, _pointer, _pointer],
         "combined": [*[_long] * 3, *[_pointer] * 2, _long, *[_pointer] * 3, _double, _pointer],
         "extremes": [_long, _long, _pointer, _double, *[_pointer] * 4],
         "strays": [_pointer, _long, *[_pointer] * 3],
         "imbalance": [*[_pointer] * 3, _double, _pointer, _pointer, ctypes.c_int],
         "crossings": [_long, _pointer, _double, _long, _pointer, _pointer],
         "reaches": [_pointer, _long, _pointer, _double, _double, _pointer, _pointer],
         "alternation": [_long, _long, _long, _pointer, ctypes.c_int, ctypes.c_int, _long],
         "path_work": [_long, _long, _long, *[_pointer] * 6],
         "works_along": [_pointer, _long, _long, *[_pointer] * 3, _long, _double, _pointer, _double,
                         _pointer],
         "squares_along": [_pointer, _long, _long, _pointer, _pointer],
         "releases": [_pointer, _long, *[_pointer] * 2, _double, _pointer]}
"""What Python calls, and with what; a result that is none of `RETURNED` is a status."""

RETURNED = {**dict.fromkeys(("motion_squares", "add_rows", "alternation", "path_work",
                             "closest"), _double),
            "crossings": _long}
"""What returns something else."""
