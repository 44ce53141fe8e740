"""Numbers of PETSc's own options, looked at before its objects read them: some of them PETSc takes
without a look, of others it says neither the name nor the value that was typed."""

import math
import os
import re
from pathlib import Path
from typing import Callable, NamedTuple

from .fields import InputError, meant, nearest, number
from .files import located


class Rule(NamedTuple):
    """What an option allows."""

    convert: Callable
    holds: Callable
    allowed: str
    words: tuple = ()


TOLERANCE = Rule(float, lambda value: 0 <= value < 1, "a number at least 0 and below 1")
FACTOR = Rule(float, lambda value: 0 <= value <= 1, "a number at least 0 and at most 1")
SIZE = Rule(float, lambda value: 0 <= value < math.inf, "a number at least 0")
POSITIVE = Rule(float, lambda value: 0 < value < math.inf, "a number above 0")
EXPONENT = Rule(float, lambda value: 1 < value <= 2, "a number above 1 and at most 2")
BOUND = Rule(float, lambda value: value > 0 or value == -1,
             "a number above 0, or -1 for none", ("unlimited",))
COUNT = Rule(int, lambda value: value >= 0, "a whole number at least 0")
LIMIT = Rule(int, lambda value: value >= 0 or value == -1,
             "a whole number at least 0, or -1 for none", ("unlimited",))
SOME = Rule(int, lambda value: value >= 1, "a whole number at least 1")
LAG = Rule(int, lambda value: value >= 1 or value == -2, "a whole number at least 1, or -2")
VERSION = Rule(int, lambda value: 1 <= value <= 4, "a whole number from 1 to 4")

RULES = {
    "snes_atol": (TOLERANCE, "1e-8"), "snes_rtol": (TOLERANCE, "0"), "snes_stol": (TOLERANCE, "0"),
    "snes_divergence_tolerance": (BOUND, "-1"), "snes_max_it": (SOME, "50"),
    "snes_max_funcs": (LIMIT, "1000000"), "snes_lag_jacobian": (LAG, "1"),
    "snes_lag_preconditioner": (LAG, "1"), "snes_ksp_ew_version": (VERSION, "2"),
    "snes_ksp_ew_rtol0": (TOLERANCE, "0.1"), "snes_ksp_ew_rtolmax": (TOLERANCE, "0.1"),
    "snes_ksp_ew_threshold": (TOLERANCE, "0.1"), "snes_ksp_ew_gamma": (FACTOR, "0.5"),
    "snes_ksp_ew_alpha": (EXPONENT, "1.6"), "snes_ksp_ew_alpha2": (EXPONENT, "1.6"),
    "snes_linesearch_damping": (POSITIVE, "1"), "snes_linesearch_maxstep": (POSITIVE, "1e8"),
    "snes_linesearch_minlambda": (TOLERANCE, "1e-12"), "snes_linesearch_max_it": (COUNT, "40"),
    "snes_linesearch_rtol": (SIZE, "1e-8"), "snes_linesearch_atol": (SIZE, "1e-15"),
    "snes_linesearch_ltol": (SIZE, "1e-8"), "snes_linesearch_order": (VERSION, "3"),
    "snes_qn_m": (SOME, "10"), "snes_ngmres_m": (SOME, "30"), "snes_anderson_m": (SOME, "30"),
    "snes_anderson_beta": (POSITIVE, "1"), "snes_tr_delta0": (POSITIVE, "0.2"),
    "snes_trdc_delta0": (POSITIVE, "0.1"), "ksp_rtol": (TOLERANCE, "1e-3"),
    "ksp_atol": (SIZE, "1e-9"), "ksp_divtol": (BOUND, "1e4"), "ksp_max_it": (COUNT, "150"),
    "ksp_gmres_restart": (SOME, "60"), "ksp_gcr_restart": (SOME, "60"),
    "ksp_bcgsl_ell": (SOME, "2"), "ksp_gmres_haptol": (SIZE, "1e-30"),
    "ksp_richardson_scale": (POSITIVE, "1")}
"""Option, without the prefix of its solver -> its rule, and what to try. -snes_atol is in ranges of
the law, of which one is no equilibrium."""
USUAL = (*RULES, "snes_type", "snes_linesearch_type", "ksp_type", "pc_type")
"""PETSc's options that one much like them is taken to be meant for."""
VIEWERS = re.compile("(?:^|_)(?:view|monitor|reason|rate)(?:_|$)")
"""Names of options whose values say where something is written: kind of file, name, format."""
WRITTEN = re.compile("(?:ascii|binary|hdf5|vtk)?:([^:,]+)")
FILES = {"history": "(.+)", "citations": "(.+)", "log_trace": "(.+)", "info": "([^:]+)"}
"""PETSc's options that name a file, or none, as it is -> what of their values does."""
LOG = re.compile("(?:ascii)?(?::|$)")
"""How values of -log_view begin: it is written, and others are refused, when all is done."""
MATRIX_FREE = ("none", "python", "shell", "ksp", "composite")
"""Values of -pc_type that ask for no entries of a matrix."""
NO_ENTRIES = "it asks for entries of the tangent, of which products alone are known here"
UNUSABLE = {("snes_type", "aspin"): "it solves on subdomains, of which none are known here",
            ("pc_type", "mpi"): "it solves by a server's processes, of which none are here",
            ("ksp_type", "pipelcg"): "it may not end where a tangent is not symmetric and positive",
            **dict.fromkeys((("pc_type", kind) for kind in ("jacobi", "kaczmarz", "redistribute")),
                            NO_ENTRIES)}
"""Option, without the prefix of its solver, and value with which PETSc would crash, or go on
without end, in one version or another -> why: what else cannot be used it says itself."""
COUNTING = ("richardson", "chebyshev", "gcr", "preonly")
"""Values of -ksp_type of methods whose solves may end by the number of their iterations."""


def nearest_usual(name, names, nested):
    """What a name that PETSc's solvers do not ask for is most likely meant for: another name, one
    of their usual options, or such a one under the prefix of a solver inside others; empty where
    nothing is much like it.

    Parameters
    ----------
    name : str, without dash
    names : iterable of str
    nested : prefixes of solvers inside others, without their last stroke
    """
    inner = next((usual for usual in USUAL if name.endswith(f"_{usual}")), "")
    if not inner:
        return nearest(name, (*names, *USUAL), cutoff=0.85)
    # others may have prefixes of their own, and those of blocks (-sub_) are not much like ours
    head = nearest(name.removesuffix(f"_{inner}"), nested, cutoff=0.8)
    return head and f"{head}_{inner}"


def refuse_values(entries, nests):
    """InputError for a value of PETSc's options that it does not allow, or takes and cannot use.

    Parameters
    ----------
    entries : mapping, name (without dash) -> text, as of the database
    nests : regular expression of the prefix of a solver inside others
    """
    for name, text in entries.items():
        plain = re.sub(f"^{nests}*", "", name)
        if (plain, text) == ("ksp_norm_type", "none"):
            _refuse_endless(name, entries)
        if (plain, text.lower()) in UNUSABLE:
            raise InputError(f"-{name} is '{text}': {UNUSABLE[plain, text.lower()]}; leave it out")
        rule, guess = RULES.get(plain, (None, ""))
        if rule is not None and not (text.lower() in rule.words or _holds(rule, text)):
            told = f"is '{text}'" if text else "has no value"
            raise InputError(f"-{name} {told}: allowed is {rule.allowed}; leave it out, or try "
                             f"{guess}")


def refuse_unwritable(entries):
    """InputError for a file that PETSc is to write and cannot: it says so late, of some options
    when all is done, and in one of several processes alone.

    Parameters
    ----------
    entries : mapping, as of `refuse_values`
    """
    for name, text in entries.items():
        if name == "log_view" and not LOG.match(text):
            raise InputError(f"-log_view is '{text}': allowed is :FILE or :FILE:FORMAT; leave it "
                             "out, or try :log.txt")
        pattern = FILES.get(name, WRITTEN if VIEWERS.search(name) else "(?!)")
        found = re.match(pattern, text)
        if found and (Path(found[1]).is_dir() or not os.access(Path(found[1]).parent, os.W_OK)):
            raise InputError(f"-{name} is '{text}': the file '{found[1]}' cannot be written, its "
                             "folder does not exist or is closed; name another")


def _refuse_endless(name, entries):
    """InputError for an option that leaves linear solves without norms, unless another one ends
    them, and they are of a method that takes their end for one."""
    head = name.removesuffix("norm_type")
    kind = entries.get(f"{head}type", "fgmres" if head == "ksp_" else COUNTING[0])
    if f"{head}max_it" not in entries or kind not in COUNTING:
        raise InputError(f"-{name} is 'none': no residual ends a linear solve then, but its "
                         f"number of iterations, which methods but {', '.join(COUNTING)} call a "
                         f"failure; add -{head}type {COUNTING[0]} -{head}max_it 20, say, or leave "
                         "it out")


def _holds(rule, text):
    """Whether a text stands for a number that a rule allows."""
    try:
        return rule.holds(number(text.strip(), rule.convert))
    except ValueError:
        return False


def without_entries(sentence, entries):
    """What PETSc says of a method that needs the entries of the tangent, with the options that ask
    for it and what to take; an empty text where that is not what it says.

    Parameters
    ----------
    sentence, entries : as of `blamed`
    """
    if not re.search("(for Mat of|matrix) type (shell|python)|requires IJ", sentence):
        return ""
    guilty = [f"-{name} is '{text}'" if text else f"-{name}" for name, text in entries.items()
              if re.search("pc_type$|^snes_fd|pc_factor_", name) and text not in MATRIX_FREE]
    return f"{'; '.join(guilty) or 'a solver'}: {NO_ENTRIES}; leave it out ({sentence})"


def blamed(sentence, entries, is_solver):
    """What PETSc says of an option, with the option and its value where it names neither.

    Parameters
    ----------
    sentence : str, PETSc's
    entries : mapping, name (without dash) -> text, as of the database
    is_solver : function (name) -> whether an option is one of PETSc's solvers
    """
    words = set(re.split(r"[\s:;]+", sentence))
    guilty = [f"-{name} is '{text}'" for name, text in entries.items()
              if is_solver(name) and text and words & {text, *text.split(",")}]
    named = any(f"-{name}" in sentence for name in entries)
    return f"{'; '.join(guilty)}: {sentence}" if guilty and not named else sentence


def refuse_types(entries, PETSc):
    """InputError for a type of PETSc's solvers that an option names and that PETSc has not.

    Parameters
    ----------
    entries : mapping, name (without dash) -> text, as of the database
    PETSc : module of petsc4py, which this one does not import
    """
    for name, text in entries.items():
        found = re.search("(?:^|_)(snes|ksp|pc)_type$", name)
        if not found:
            continue
        kind = getattr(PETSc, found[1].upper())
        solver = kind().create(PETSc.COMM_SELF)
        try:
            solver.setType(text)
        except PETSc.Error:
            types = [known for word, known in vars(kind.Type).items()
                     if not word.startswith("_") and known != text]
            told = f"is '{text}', a type that PETSc has not here" if text else "has no value"
            method = Path(located(f"{text}.opts"))
            like = (f": the file {method.name} is that method, name it in place of the option"
                    if os.path.isfile(method) and f"-{name}" in method.read_text(encoding="utf-8")
                    else meant(text, types, ": leave it out for the usual one"))
            raise InputError(f"-{name} {told}{like}") from None
        finally:
            solver.destroy()
