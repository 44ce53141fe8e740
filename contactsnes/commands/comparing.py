"""The command ``compare``: methods on one scene."""

import os
from functools import partial
from pathlib import Path

from ..compare import methods
from ..options.database import check_names, database, database_text, install, read, unused_options
from ..options.fields import InputError
from ..options.files import entries
from ..options.words import asks_for_help
from ..scene import settings as scenes
from ..system.streams import legible
from .session import (
    check_solvers,
    create_branch,
    help_on_options,
    solver_options,
    start_petsc,
    versions,
)
from .showing import Saved, writing
from .speech import complain, interrupted

COMPARED = (".csv", ".h5", ".png")
"""Endings of the files of a comparison."""


def compare(arguments):
    """``contactsnes compare``: methods on one scene, measured on equal terms."""
    if asks_for_help(arguments):
        return help_on_options(arguments, (methods.CompareOptions,))
    comparison, stem = _start(arguments, partial(print, flush=True))
    from ..compare import table as comparison_table

    def drawn():
        from ..compare.figure import plot_comparison  # and matplotlib, which others need not import

        return [plot_comparison([f"{stem}.h5"], f"{stem}.png")]

    about = {"scene": str(comparison.branch.scene), "options": database_text(),
             "versions": str(versions())}
    save = Saved(f"the comparison {stem}",
                 lambda: comparison_table.save(comparison, stem, about))
    try:
        comparison.run(save)
    except KeyboardInterrupt as interrupt:
        if not save.done:
            raise
        return interrupted(interrupt, f": what was measured is in {stem}.csv and {stem}.h5, and "
                           "-compare_overwrite begins anew")
    for name in unused_options(solver_options()):
        if name[1:] in comparison.given:
            complain("warning", f"{name} was never used: neither this program "
                     "nor any PETSc object in use asks for it")
    print("", *comparison_table.lines(comparison), sep="\n")
    save.check()
    figures = writing(save.path, drawn) if comparison.watched else []
    print(f"{stem}.csv", f"{stem}.h5", *figures, sep="\n", flush=True)
    return 0 if any(comparison.finished(method) for method in comparison.methods) else 1


def _start(arguments, log):
    """Initialise PETSc with the arguments of a comparison; the comparison, its options, and the
    stem of its files."""
    scene, paths, words = methods.split(arguments)
    settings = start_petsc([scene, *words])
    check_names((methods.CompareOptions,))
    asked, given = read(methods.CompareOptions), database()
    stem = Path(asked.file or f"comparison-{methods.variant(scene, words)}")
    _check_files(stem, asked.overwrite)
    branch = create_branch(settings)
    typed = {name: given[name] for name in entries(words) if name in given}
    found = [method._replace(name=legible(method.name))
             for method in methods.read_methods(paths, typed)]
    for method in found:
        install({**given, **method.entries})
        try:
            check_solvers()
            read(scenes.Form)
        except InputError as error:
            raise InputError(f"method {method.name}: {error}") from None
    from ..compare.comparison import Comparison  # PETSc has its options now

    return Comparison(legible(Path(scene).stem), branch, found, given, asked, log), stem


def _check_files(stem, overwrite):
    """InputError unless a comparison can write its files."""
    if stem.suffix in COMPARED:
        raise InputError(f"-compare_file is '{stem}': name it without its ending, the files get "
                         f"{', '.join(COMPARED)}")
    if not stem.parent.is_dir() or not os.access(stem.parent, os.W_OK):
        raise InputError(f"-compare_file is '{stem}': its folder does not "
                         "exist or cannot be written; name another")
    try:
        there = [path for path in (Path(f"{stem}{suffix}") for suffix in COMPARED)
                 if path.exists()]
    except OSError as error:
        raise InputError(f"-compare_file is '{stem}', which cannot be the "
                         f"name of a file: {error.strerror}") from None
    if there and not overwrite:
        raise InputError(f"{there[0]} exists: -compare_overwrite replaces it, "
                         "another -compare_file leaves it alone")
