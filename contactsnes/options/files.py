"""Files of options as the arguments that they stand for."""

import difflib
import os
import re
import shlex
from pathlib import Path

from .fields import InputError

PLAIN = r"""[^\s"'#][^\s#]*"""
"""A value without quotes."""

LINE = re.compile(rf"""\s*(?P<name>-[^\s#]+)
                  (\s+("(?P<quoted>[^"]*)"|'(?P<single>[^']*)'|(?P<plain>{PLAIN})))?
                  \s*(\#.*)?""", re.VERBOSE)
"""An option, its value and a comment: PETSc's syntax, but for a # between quotes, which belongs to
the value; PETSc would cut it there."""

CODE = re.compile(r"(?P<file>.+\.py):(?P<name>\w+)")
"""A name in a file of Python."""

YAML = (".yml", ".yaml", ":yaml")
"""How names of files end that PETSc reads as YAML."""

HEIGHTS = "-scene_geometry_file"
"""The option that names a file of data."""


def is_option(argument):
    """Whether an argument is the name of an option, by PETSc's rule: a dash and a letter; -3, -.5
    and -inf are values."""
    try:
        float(argument)
    except ValueError:
        return re.match(r"--?[A-Za-z]", argument) is not None
    return False


def folders():
    """The folder of the scenes and methods that come with the package: beside its modules where it
    is installed, options/ of a checkout; a list of one, empty where it is missing."""
    package = Path(__file__).resolve().parents[1]
    found = (package / "scenes", package.parent / "options")
    return [folder for folder in found if any(folder.glob("*.opts"))][:1]


def located(path):
    """The path of a file of options: a bare name that is no file of the working folder is that of a
    file that comes with the package, if there is one."""
    if os.path.basename(path) == str(path) and not os.path.isfile(path):
        return next((folder / path for folder in folders() if os.path.isfile(folder / path)), path)
    return path


def may_be_file(word):
    """Whether what stands where a flag may have a value is more likely a file of options: it has a
    folder or an ending, which numbers and lists have not, or is the name of a file, or like that of
    one."""
    return bool(re.search(r"/|\.[A-Za-z]", word) or os.path.exists(located(word)) or _alike(word))


def _alike(path):
    """Up to three files of options whose names are like that of a file that is missing."""
    folder, name = os.path.split(path)
    names = {file.stem: file.name for place in folders() for file in place.glob("*.opts")}
    names |= {file.stem: os.path.join(folder, file.name) for file in Path(folder).glob("*.opts")}
    return [names[found] for found in difflib.get_close_matches(Path(name).stem, sorted(names))]


def read_file(path, above=()):
    """The arguments that a file of options stands for: a list of names, each with its value if it
    has one.

    PETSc's syntax: an option and its value a line, # comments, values with blanks in quotes,
    -prefix_push and -prefix_pop; the lines of another file that is named by -options_file stand in
    its place. A bare name may be that of a file that comes with the package. InputError names file
    and line. The prefix has to be popped by the end, so that it
    does not leak.

    Parameters
    ----------
    path : path of the file
    above : paths of the files that name this one
    """
    path = located(path)
    text = _text(path)
    if os.path.realpath(path) in map(os.path.realpath, above):
        raise InputError(f"the options file '{path}' includes itself by "
                         f"-options_file ({' -> '.join(map(str, (*above, path)))}): take "
                         "out one of these lines")
    arguments = [argument for number, line in enumerate(text.splitlines(), start=1)
                 for argument in _beside(_read_line(line, f"{path}, line {number}"), path)]
    if arguments.count("-prefix_push") != arguments.count("-prefix_pop"):
        raise InputError(f"the options file '{path}' has unequal numbers of "
                         "-prefix_push and -prefix_pop: close each push")
    return with_files(arguments, (*above, path))


def _text(path):
    """The text of a file of options; InputError, with the names of files that may be meant."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
        if "\0" in text or not Path(path).is_file():
            raise ValueError
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        alike = _alike(path) if isinstance(error, FileNotFoundError) else []
        advice = (f"did you mean {' or '.join(alike)}?" if alike
                  else "archives are for contactsnes plot, table and report"
                  if str(path).endswith(".h5")
                  else "give a file of lines '-option value', and blanks in quotes")
        raise InputError(f"the options file '{path}' cannot be read ({reason}): {advice}") from None
    return text


def _beside(words, path):
    """An option and its value; a file of Python or of heights with the path from the working
    folder, where it lies beside the file of options that names it."""
    if len(words) < 2:
        return words
    name, value = words
    match, folder = CODE.fullmatch(value), Path(path).parent
    if match and (file := folder / match["file"]).is_file():
        return [name, f"{file}:{match['name']}"]
    file = value.partition(":")[0]
    if name.lower() == HEIGHTS and not os.path.isfile(file) and (folder / file).is_file():
        return [name, str(folder / value)]
    return words


def refuse_circles(text):
    """InputError where options in a text, or the files that PETSc reads by itself, name files that
    include themselves, or the text, PETSC_OPTIONS, names a file that PETSc does not find."""
    words = text.split()
    paths = [value for name, value in zip(words, words[1:]) if name.lower() == "-options_file"]
    for path in paths:
        if os.path.exists(path) or "$" in path or path.endswith(YAML):  # (those are PETSc's)
            continue
        if (place := located(path)) == path:
            _text(path)  # which says why
        raise InputError(f"PETSC_OPTIONS names the options file '{path}', which PETSc looks for in "
                         f"the working folder alone: name {place} there, or give {path} to the "
                         "command itself")
    for path in (*paths, os.path.expanduser("~/.petscrc"), ".petscrc", "petscrc"):
        # (the folder of another user, whom a container or sudo has left in HOME, has none for us)
        if os.path.isfile(path) and "-options_file" in _lower(path):
            read_file(path)


def _lower(path):
    """The text of a file that PETSc reads by itself, or passes over where it may not; in lower
    case."""
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace").lower()
    except OSError as error:
        raise InputError(f"the options file '{path}' cannot be read ({error.strerror}): give this "
                         "user the right to, or take it away") from None


def with_files(arguments, above=()):
    """Arguments with those of the files that -options_file names in their place; YAML is PETSc's to
    read."""
    found, words = [], iter(arguments)
    for word in words:
        if word.lower() != "-options_file":
            found.append(word)
            continue
        path = next(words, "")
        if not path or is_option(path):
            raise InputError("-options_file has no value: name a file of lines '-option value'")
        yaml = path.endswith(YAML)
        if yaml and not Path(path.removesuffix(":yaml")).is_file():
            raise InputError(
                f"the options file '{path}' cannot be read (there is no such file): check its name")
        found += [word, path] if yaml else read_file(path, above)
    return found


def _read_line(line, where):
    """The arguments of one line: nothing, a name, or a name and its value."""
    if not line.partition("#")[0].strip():
        return []
    match = LINE.fullmatch(line)
    values = [value for value in match.group("quoted", "single", "plain")
              if value is not None] if match else []
    if (not match or not is_option(match["name"]) or match["name"].startswith("--")
        or any(map(is_option, values))):
        raise InputError(f"{where} is not an option and its value: "
                         f"'{line.strip()}'; write one option a line with one "
                         "dash, and a value with blanks in double quotes")
    return [match["name"], *values]


def quoted(value):
    """A value as it is written into a file of options: in quotes where it needs them."""
    if re.fullmatch(PLAIN, value):
        return value
    mark = "'" if '"' in value else '"'
    return f"{mark}{value}{mark}"


def words(text):
    """The words of a text of options, in many lines, which may hold one option with what `quoted`
    makes of its value, or in one; without comments.

    Parameters
    ----------
    text : str
    """
    found = []
    for line in text.splitlines():
        name, value = (*line.split(maxsplit=1), "", "")[:2]
        value = value.rstrip()
        if value[:1] in ('"', "'") and value.find(value[0], 1) == len(value) - 1:
            found += [name, value[1:-1]]
            continue
        try:
            found += line.split() if len(value.split()) < 2 else shlex.split(line)
        except ValueError:  # a lone quotation mark
            found += line.split()
    return found


def entries(arguments):
    """Name (lower case, without dash) -> value of the options of an argument list; a flag has an
    empty text."""
    found = {}
    prefixes = []
    name = ""
    for argument in arguments:
        if not is_option(argument):
            if name == "prefix_push":
                prefixes.append(argument.lower())
            elif name:
                found[name] = argument
            continue
        name = argument.lstrip("-").lower()
        if name == "prefix_pop":
            prefixes.pop()
        elif name != "prefix_push":
            name = "".join(prefixes) + name
            found[name] = ""
    return found
