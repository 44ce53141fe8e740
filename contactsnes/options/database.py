"""Between the command line, files of options, PETSc's options database and dataclasses of options.

PETSc is imported inside functions only: its database is filled when `petsc4py.init` gets the
arguments that `petsc_arguments` makes, so this module has to work before that.
"""

import contextlib
import ctypes
import dataclasses
import os
import re
from pathlib import Path

from .fields import COMMON, InputError, meant, nearest
from .files import is_option, may_be_file, quoted, read_file, with_files
from .solver_values import blamed, nearest_usual, refuse_types, refuse_values, without_entries
from .values import BOOLEANS, instance

NESTS = r"(?:(?:npc|sub_\d+|fas_coarse|fas_levels(?:_\d+)?|first|jump|arc|error)_)"
"""Prefixes of solvers inside others, PETSc's and ours: of the first relaxation, of jumps, of steps
along the arc, of finer grids."""

NESTED = ("npc", "sub_0", "fas_coarse", "fas_levels", "first", "jump", "arc", "error")
"""Examples of these prefixes."""

BEGINNING = ("-options_left", "no", "-no_signal_handler")
"""What this program itself gives PETSc. Unused options are its own business: PETSc would list those
that a sentence on bad input leaves unread. Signals are, too: PETSc's handlers would abort."""

SOLVER = re.compile(NESTS + r"*(snes|ksp|pc)_")

LISTED = ": contactsnes run -help names those that there are"
"""How a sentence about a name ends that is like none."""
SOURCE = re.compile(r" # \(source: [a-z ]+\)$")
"""What newer PETSc appends to an option, where its value came from."""


def known_options(classes=()):
    """Name (without dash) -> field of every option of the dataclasses that all commands know and of
    more `classes` of that kind."""
    return {cls.prefix + field.name: field for cls in (*COMMON, *classes)
            for field in dataclasses.fields(cls)}


def split_arguments(arguments):
    """Files and options of a command line, two lists, each in its order.

    Flags of laws and shapes in files of one's own, which take no value, are known before that,
    wherever these are named.
    """
    try:
        found = _joined(*_split(arguments))
        given = {name[1:].lower(): value for name, value in zip(found, found[1:])
                 if is_option(name) and not is_option(value)}
        for cls in COMMON:
            cls.prepare(lambda: given)
    except InputError:
        pass  # it is told where the same is read in earnest
    return _split(arguments)


def _split(arguments):
    """Files and options of a command line, two lists, each in its order.

    An argument after an option is its value, unless it is itself an option, or ends in .opts, or
    follows a flag of ours without being true or false and may be a file.
    """
    flags = {"-" + name for name, field in known_options().items()
             if field.metadata["kind"] == "flag"}
    files = []
    options = []
    name = ""
    for argument in arguments:
        if is_option(argument):
            if argument.startswith("--"):
                # PETSc would store it under a name that nobody asks for
                raise InputError(f"{argument} has two dashes: options have one, try {argument[1:]}")
            name = argument
            options.append(argument)
            continue
        is_file = argument.endswith(".opts") and name.lower() != "-options_file"
        if not name or is_file or (name.lower() in flags and argument.lower() not in BOOLEANS
                                   and may_be_file(argument)):
            files.append(argument)
        else:
            options.append(argument)
        name = ""
    return files, options


def _joined(files, options):
    """The argument vector of files and options, those of the files first."""
    return ["contactsnes", *(argument for path in files for argument in read_file(path)),
            *with_files(options)]


def petsc_arguments(arguments):
    """The argument vector for `petsc4py.init`: the files' options from left to right, then those of
    the command line.

    PETSc lets the later of two values win. InputError for what its database of lines cannot hold.
    """
    found = _joined(*split_arguments(arguments))
    depth = 0
    for name, value in zip(found, found[1:]):
        depth += (value.lower() == "-prefix_push") - (value.lower() == "-prefix_pop")
        if depth < 0:
            raise InputError("-prefix_pop has no -prefix_push before it: leave it out")
        if not value.isprintable() and re.search(r"[\x00-\x08\n-\x1f\x7f]", value):
            raise InputError(f"{name} is '{value}': a line break or another "
                             "control character cannot stand in a value; "
                             "write it in one line")
        try:
            value.encode("utf-8")
        except UnicodeEncodeError:
            raise InputError(f"{name} is '{value}': that is no text in this "
                             "environment's encoding; take other letters, or set "
                             "LC_ALL=C.UTF-8") from None
    return found


def database():
    """Name (lower case, without dash) -> whole value of everything in PETSc's database; no value is
    an empty text.

    Read from PetscOptionsView: `getAll` cuts values at their first blank, `getString` at 1023
    characters, and both `getString` and `hasName` mark the option as used.
    """
    from petsc4py import PETSc

    with _somewhere(), _scratch() as path:
        viewer = PETSc.Viewer().createASCII(path, "w", comm=PETSc.COMM_SELF)
        PETSc.Options().view(viewer)
        viewer.destroy()
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    entries = {}
    for line in lines:
        if line.startswith("-"):
            name, _, value = SOURCE.sub("", line[1:]).partition(" ")
            entries[name.lower()] = value
    return entries


@contextlib.contextmanager
def _somewhere():
    """Within it, the working folder is one that exists, which PETSc asks for where it opens a file:
    that of a run may be removed meanwhile."""
    with contextlib.ExitStack() as back:
        try:
            os.getcwd()
        except OSError:
            gone = os.open(".", os.O_RDONLY)
            back.callback(os.close, gone)
            back.callback(os.fchdir, gone)
            os.chdir("/")
        yield


@contextlib.contextmanager
def _scratch():
    """The path of a file to write and read: in memory, or where the system has none, on disk."""
    if hasattr(os, "memfd_create") and os.path.isdir("/proc/self/fd"):
        with os.fdopen(os.memfd_create("options")) as file:
            yield f"/proc/self/fd/{file.fileno()}"
    else:
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            yield os.path.join(folder, "options")


def install(wanted):
    """Make PETSc's database hold these options (name without dash -> value; a flag's is an empty
    text) and no others."""
    from petsc4py import PETSc

    options, present = PETSc.Options(), database()
    for name in present.keys() - wanted.keys():
        options.delValue(name)
    for name, value in wanted.items():
        if present.get(name) != value:
            options.setValue(name, value)


def database_text():
    """PETSc's whole database in the syntax of an options file, sorted by name."""
    return "\n".join(f"-{name} {quoted(value)}" if value else f"-{name}"
                     for name, value in sorted(database().items()))


def read(cls, prefix=""):
    """An instance of a dataclass of options from PETSc's database.

    Parameters
    ----------
    cls : a subclass of `fields.Options`
    prefix : str, put before the class's own prefix

    InputError for a value of the wrong type or out of its range. The options read count as used for
    PETSc.
    """
    from petsc4py import PETSc

    options = PETSc.Options(prefix + cls.prefix)
    cls.prepare(database)
    given = [options.hasName(field.name) for field in dataclasses.fields(cls)]
    # Solvers ask often, and for little: the whole database takes milliseconds.
    return instance(cls, database(), prefix) if any(given) else cls()


def check_names(classes=()):
    """InputError for names in the database under a prefix of ours, or one much like it or like one
    of PETSc's, that no one knows; each with the nearest.

    Parameters
    ----------
    classes : dataclasses of options, with a `prefix`, of our own PC and SNES types; they may stand
        under the prefixes of solvers inside others, too
    """
    entries = database()
    for cls in COMMON:
        cls.prepare(lambda: entries)
    names, own = known_options(classes), tuple(cls.prefix for cls in classes)
    prefixes = (*(cls.prefix for cls in COMMON), *own)
    sentences = []
    for name in entries:
        head = "" if name.startswith(prefixes) else _head(name, own)
        inner = name[len(head):]
        if inner.startswith(prefixes) and inner not in names:
            prefix = next(prefix for prefix in prefixes if inner.startswith(prefix))
            words = set(inner.split("_"))
            like = [known for known in names if known.startswith(prefix)
                    or words <= set(known.split("_"))]
            sentences.append(f"-{name} is no option" + meant(inner, like, LISTED, f"-{head}"))
        elif head and not re.fullmatch(NESTS + "*", head):
            # Others may use our solvers under prefixes of their own, but hardly under one that is
            # so much like ours.
            guess = nearest(head[:-1], NESTED, cutoff=0.7)
            sentences += [f"-{name} is no option: did you mean -{guess}_{inner}?"] * bool(guess)
        elif not (head or inner.startswith(prefixes) or SOLVER.match(name)
                  or "-" + name in BEGINNING):
            guess = nearest_usual(name, names, NESTED)
            sentences += [f"-{name} is no option: did you mean -{guess}?"] * bool(guess)
    if sentences:
        raise InputError("; ".join(sentences))


def _head(name, prefixes):
    """What stands before the first of some prefixes in a name; an empty text where none is."""
    places = [name.find(f"_{own}") + 1 for own in prefixes]
    return name[:min(filter(None, places), default=0)]


def check_values(classes):
    """InputError for values in the database that no one can use; none of them counts as used."""
    from petsc4py import PETSc

    entries, own = database(), tuple(cls.prefix for cls in classes)
    refuse_values(entries, NESTS)
    refuse_types(entries, PETSc)
    for head in sorted({_head(name, own) for name in entries if not name.startswith(own)} | {""}):
        for cls in classes:
            if any(name.startswith(head + cls.prefix) for name in entries):
                instance(cls, entries, head)


def petsc_sentence(error):
    """What a PETSc.Error says, with the options that it speaks of.

    Parameters
    ----------
    error : PETSc.Error
    """
    last = str(error).splitlines()[-1].removeprefix("[0] ").strip()
    said = without_entries(last, database()) or blamed(last, database(), SOLVER.match)
    return f"PETSc: {said} (error {error.ierr})"


def unused_options(classes=()):
    """Names (with dash) that nobody asked for: those under -snes_ -ksp_ -pc_, and those of our own
    solvers.

    Solvers inside others have their own: -npc_snes_ and so on (`NESTS`). To be called after the
    solves, since PETSc's objects ask for their options when they are set up.
    """
    own = tuple(cls.prefix for cls in classes)
    return ["-" + name for name in database()
            if (SOLVER.match(name) or _head(name, own)) and not _used(name)]


def _used(name):
    """Whether somebody asked the database for an option."""
    from petsc4py import PETSc

    options = PETSc.Options()
    if hasattr(options, "used"):
        return options.used(name)
    # older petsc4py does not wrap PetscOptionsUsed; the library it is linked to has it
    flag = ctypes.c_int(0)
    ctypes.PyDLL(PETSc.__file__).PetscOptionsUsed(None, name.encode(), ctypes.byref(flag))
    return bool(flag.value)
