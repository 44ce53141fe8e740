"""Installs the package; the scenes and methods of options/ go with it, as files of
contactsnes/scenes/, and the kernels in C where there is a compiler."""

import hashlib
from pathlib import Path

from setuptools import Extension, find_packages, setup

KERNELS = Path(__file__).parent / "contactsnes" / "kernels"
SOURCES = ("kernels.h", "both.h", "precision.h", "columns.h", "pairs.h", "folded.h", "patches.h",
           "transforms.c", "packed.c", "folded.c", "slabs.c", "forms.c", "motion.c", "core_zone.c",
           "patches.c", "two_grids.h", "two_grids.c", "steps.c", "krylov.c", "modes.c", "points.c",
           "paths.c", "petsc.c", "laws.c", "library.c")
"""As kernels/library.py has them."""

# No fast-math: it would change how the whole process treats small numbers. What the loops need of
# it alone: no errno, no traps, sums in any order.
FLAGS = ["-std=gnu99", "-O3", "-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros",
         "-fassociative-math", "-ffp-contract=off", "-w"]


def kernels():
    """The optional extension, which knows what it was built from; no module of Python's."""
    found = hashlib.sha256()
    for name in SOURCES:
        found.update((KERNELS / name).read_bytes())
    return Extension("contactsnes.kernels._compiled",
                     [f"contactsnes/kernels/{name}" for name in SOURCES if name.endswith(".c")],
                     depends=[f"contactsnes/kernels/{name}" for name in SOURCES],
                     extra_compile_args=FLAGS,
                     define_macros=[("KERNELS_CHECKSUM", f'"{found.hexdigest()[:32]}"')],
                     libraries=["m"], optional=True)


setup(
    packages=[*find_packages(include=["contactsnes*"]), "contactsnes.scenes"],
    package_dir={"contactsnes.scenes": "options"},
    package_data={"contactsnes.scenes": ["*.opts", "*.py", "*.txt"],
                  "contactsnes.kernels": ["*.c", "*.h"]},
    ext_modules=[kernels()],
)
