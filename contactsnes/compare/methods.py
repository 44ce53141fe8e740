"""Methods as files of options: which files those are, what they say, and how a comparison of them
goes.

A method is a file without options of a scene or a load. PETSc's database is one for the whole
process: to change the method is to make the database hold the scene's options, the method's and the
command line's, the later winning, as if all had been given to one run.
"""

import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

from ..options.database import split_arguments
from ..options.fields import InputError, Options, option
from ..options.files import entries, folders, read_file
from ..solvers import capabilities


@dataclass(frozen=True)
class CompareOptions(Options):
    """Options of a comparison of methods."""

    prefix: ClassVar[str] = "compare_"
    title: ClassVar[str] = "Comparison of methods"
    repeats: int = option(3, "passes over the path that are timed, the methods in turn in each",
                          minimum=1)
    seconds: float = option(60.0, "a method whose first pass takes longer is not "
                            "timed again: its times are those of that pass",
                            "s", minimum=0)
    transforms: float = option(50000.0,
                               "a method that needs more transforms at a point has failed there",
                               above=0)
    failures: int = option(3, "failed points of a method, after which it is not tried any more",
                           minimum=1)
    file: str = option("", "name of the files: FILE.csv, FILE.h5 and FILE.png",
                       default_text="comparison-SCENE, with the options of the scene and the load "
                       "that the command line has")
    overwrite: bool = option(False, "replace existing files")


class Method(NamedTuple):
    """A method: its name, and its options as name (lower case, without dash) -> value."""

    name: str
    entries: dict

    @property
    def family(self):
        """What kind of method it is, in words."""
        method = capabilities.of(self.entries.get("snes_type", "newtonls"),
                                 self.entries.get("snes_python_type", ""))
        after = method.has_tangent and self.entries.get("contact_first") == "relaxation"
        return f"{method.kind} after relaxation" if after else method.kind


def split(arguments):
    """The scene's file, the methods' files (by default all that are at hand) and the options of a
    command line."""
    files, options = split_arguments(arguments)
    if not files:
        raise InputError("there is no scene: name its file, then those of "
                         "the methods, for instance compare options/cylinder.opts "
                         "options/newton.opts options/fire.opts")
    scene, *paths = files
    if is_method(scene):
        raise InputError(f"the first file, '{scene}', has no option of a "
                         "scene or a load: name the scene's file first")
    for path in paths:
        if not is_method(path):
            raise InputError(f"'{path}' is no method: it has options of a "
                             "scene or a load; only the first file may "
                             "have those")
    return scene, paths or files_at_hand(), options


LONGEST = 80
"""Characters of a name made of options, beyond which it is cut, and a checksum tells it apart."""


def variant(scene, words):
    """The name of a scene's variant: that of its file, and the options of scene and load on the
    command line, in letters that suit the name of a file."""
    changed = [f"{name}={value}" for name, value in sorted(entries(words).items())
               if name.startswith(("scene_", "load_"))]
    name = re.sub(r"[^\w.,=+-]+", "_", "-".join([Path(scene).stem, *changed]))
    if len(name) <= LONGEST:
        return name
    return f"{name[:LONGEST - 9]}-{zlib.crc32(' '.join(changed).encode()):08x}"


def files_at_hand():
    """The methods in the folder options/ of the current folder or, failing that, those that come
    with the package; newton.opts first."""
    for folder in (Path("options"), *folders()):
        paths = [path for path in sorted(folder.glob("*.opts")) if is_method(path)]
        if paths:
            return sorted(paths, key=lambda path: path.stem != "newton")
    raise InputError("no method is named, and the current folder has no "
                     "folder options/ with files of methods: name them "
                     "after the scene")


def is_method(path):
    """Whether a file of options says nothing on a scene or a load."""
    return not any(name.startswith(("scene_", "load_")) for name in entries(read_file(path)))


def read_methods(paths, given):
    """The methods of files, with Newton's on the whole cell after newton.opts.

    Parameters
    ----------
    paths : paths of files of options
    given : name -> value of the options of the command line, which win
    """
    methods = []
    for path in paths:
        stem, found = Path(path).stem, entries(read_file(path))
        name = stem if stem not in [method.name for method in methods] else str(path)
        methods.append(Method(name, {**found, **given}))
        if name == "newton" and "contact_window" not in given:
            methods.append(Method("newton (whole cell)", {**found, **given, "contact_window": "off",
                                                          "contact_symmetry": "off"}))
    return methods
