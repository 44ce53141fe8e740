"""Studies of parameters: a scene with many values, each run in a process of its own and kept in an
archive, so that a study that was interrupted goes on where it was."""

import hashlib
import itertools
import os
import re
import sys
from collections import Counter
from collections.abc import Hashable, Mapping
from dataclasses import fields as fields_of
from itertools import starmap
from pathlib import Path

import numpy as np
from tqdm import tqdm

from ..options.arguments import a_path, of_class, several, unfit, whole
from ..options.database import LISTED, database
from ..options.fields import InputError, as_text, meant
from ..options.values import instance
from ..output import resuming
from ..output.extras import extra
from ..output.reading import read
from ..scene.measured import RIVALS
from ..scene.scene import Scene
from ..scene.settings import OPTION_CLASSES, check, of_run
from ..system import children
from ..system.devices import ending, reason
from ..system.processes import launched, unlaunched

OURS = tuple(cls.prefix for cls in OPTION_CLASSES)
LONGEST = 200
"""Bytes of the name of an archive that tell its values."""
REFUSED = 2
"""Exit status of a run that has not begun."""


class Sweep(Mapping):
    """Records of a study by the values of its parameters: a value, or a tuple of several.

    Attributes
    ----------
    parameters : dict, name -> values
    folder : pathlib.Path of the archives
    failures : dict, values -> why the run ended early, or what it lacks; what it reached is in its
        record, if any
    """

    def __init__(self, parameters, folder):
        self.parameters, self.failures = parameters, {}
        self.folder = Path(a_path("folder", folder, "the path of one"))
        self._records = {}

    def __getitem__(self, values):
        if values not in self._records:
            raise KeyError(f"{self.folder} has no points of {values!r}: it has those of "
                           f"{', '.join(map(repr, self._records))}")
        return self._records[values]

    def __iter__(self):
        return iter(self._records)

    def __len__(self):
        return len(self._records)

    def __repr__(self):
        names = ", ".join(f"{name} of {len(values)} values"
                          for name, values in self.parameters.items())
        failed = f", {len(self.failures)} failures" * bool(self.failures)
        return f"<Sweep over {names}: {len(self)} runs in {self.folder}{failed}>"

    def take_in(self, values, path, reason):
        """Add the run of some values: the path of its archive, and why it ended early, if it did.

        Parameters
        ----------
        values : a value or a tuple of several
        path : pathlib.Path, None of a run that was refused: what is there is of another one
        reason : str, empty where the run came to its end
        """
        if reason:
            self.failures[values] = reason
        if path and path.is_file() and (record := read(path)).points:
            self._records[values] = record

    def take(self, name, pick=lambda column: column[-1]):
        """One number a combination of values, an array: by default the last one of a column; nan
        where a run has no points.

        Parameters
        ----------
        name : str, a column
        pick : function (array) -> number, for instance max
        """
        return np.array([pick(self[values][name]) if values in self else np.nan
                         for values in _combined(self.parameters)])


@children.ended_with_this()
def sweep(scene, load, *, folder="sweep", jobs=1, steps=None, form=None, fields="none",
          progress=True, **parameters):
    """Run a scene with all combinations of values of parameters; runs that are done already in the
    folder are taken from there, others go on.

    Parameters
    ----------
    scene : Scene
    load : Load, as it is typed: in SI where the scene is
    folder : of the archives, one a run, made if it is missing
    jobs : int, runs at a time, each in a process of its own; more than one need joblib, of the
        extra ``sweep``
    steps, form : Steps and Form, optional
    fields : as ``-archive_fields``
    progress : bool, whether to show a bar
    parameters : values of options by name, as they are typed: those of the scene without a prefix
        (normal_maugis=[1, 2]), others with theirs (load_path=[...])

    Returns
    -------
    Sweep

    Raises
    ------
    InputError : before any run, for a name or a value that is not allowed
    """
    joblib = _joblib(jobs)
    options = _given(fields, load, *of_run(scene, load, steps, form))
    parameters = {name: _listed(name, values) for name, values in parameters.items()}
    found, cases = Sweep(parameters, folder), _cases(parameters)
    tasks = [(values, _checked(scene, cases[values], options), found.folder / f"{name}.h5", jobs)
             for values, name in _stems(cases).items()]
    # Here: a thread that reads when the program is interrupted keeps HDF5's lock, at its end, too.
    tasks = [(*task, _is_done(task[2], task[1])) for task in tasks]
    _make(found.folder)
    ended = (joblib.Parallel(n_jobs=jobs, prefer="threads", return_as="generator")(
        joblib.delayed(_run)(*task) for task in tasks) if joblib else starmap(_run, tasks))
    for values, path, why in tqdm(ended, total=len(tasks), disable=not progress, unit="run"):
        found.take_in(values, path, why)
    return found


def _make(folder):
    """The folder of a study; InputError where there can be none."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise InputError(f"folder is '{folder}', which cannot be made ({reason(error)}): name "
                         "another") from None


def _refuse_launched():
    """InputError in a program that a launcher has started several times: each would run all."""
    size, _ = launched()
    if size > 1:
        raise InputError(f"started as {size} processes, but sweep starts those of its runs itself: "
                         "start the program without mpirun or srun, or with -n 1; "
                         f"sweep(..., jobs={size}) runs {size} at a time")


def _joblib(jobs):
    """The library that runs several jobs, None for one; InputError for another number, or where
    there are several processes already."""
    _refuse_launched()
    if (jobs := whole("jobs", jobs, "a whole number at least 1")) < 1:
        raise InputError(f"jobs is '{jobs}': allowed is a whole number at least 1")
    return extra("joblib", "sweep", f"sweep with jobs={jobs}") if jobs > 1 else None


def _listed(name, values):
    """The values of a parameter, a list; InputError for what is none, or an empty one."""
    example = "a list of its values, as in normal_maugis=[1, 2]"
    found = [value.tolist() if isinstance(value, np.ndarray) else value
             for value in several(name, values, example)]
    found = [tuple(value) if isinstance(value, list) else value for value in found]
    if found and all(isinstance(value, Hashable) for value in found):
        return found
    raise unfit(name, values, example)


def _cases(parameters):
    """Values, one or a tuple -> the parameters by name, of all combinations."""
    if not parameters:
        raise InputError("a sweep needs values of a parameter: for instance normal_maugis=[1, 2]")
    return dict(zip(_combined(parameters), (dict(zip(parameters, values)) for values
                                            in itertools.product(*parameters.values()))))


def _combined(parameters):
    """All combinations of values, a list of one or a tuple each, as often as they are given."""
    return [values if len(values) > 1 else values[0]
            for values in itertools.product(*parameters.values())]


def _run(values, words, path, jobs, done):
    """Run a case in a process unless it is done; (values, path of its archive, None where it was
    refused, why it ended early, or what it lacks, or an empty text)."""
    if done:
        return values, path, ""
    arguments = [part for name, value in words.items()
                 for part in ([f"-{name}", value] if value else [f"-{name}"])]
    one = {"OMP_NUM_THREADS": "1"} if jobs > 1 else {}
    done = children.run([sys.executable, "-m", "contactsnes", "run", *arguments, "-archive_file",
                         str(path), "-archive_resume"],
                        {**unlaunched(), **one,
                         "PYTHONPATH": os.pathsep.join(filter(None, sys.path))})
    said = [line.partition(": ")[2].partition(": ")[2] for line in done.stderr.splitlines()
            if "error: " in line or resuming.LACKING in line]
    return (values, None if done.returncode == REFUSED else path,
            said[-1] if said else ending(done.returncode))


def _is_done(path, words):
    """Whether an archive is a case's complete one; what stands in files is for runs to compare."""
    if any(name == "scene_geometry_file" or ".py:" in words[name] for name in words):
        return False
    try:
        record = read(path)
    except ValueError:  # there is none, or one that the run refuses
        return False
    made = resuming.entries(record.options)  # what is a default here may have been given there
    ours = {name for name in made if name.startswith(OURS)} - {"archive_file", "archive_resume"}
    return record.complete and ours <= {*map(str.lower, words)} and all(
        made.get(name.lower()) == " ".join(value.split()) for name, value in words.items())


def _given(fields, *instances):
    """Options that all runs have: of fields, of instances, and PETSc's own."""
    fields = of_class("fields", fields, str, "none, last or all, a text")
    return _words(*instances) | _petsc() | {"archive_fields": fields}


def _words(*instances):
    """Name -> text of the options of instances that are no defaults."""
    return {instance.option_name(field.name)[1:]: as_text(getattr(instance, field.name))
            for instance in instances for field in fields_of(instance)
            if getattr(instance, field.name) != field.default}


def _scene_words(scene, case):
    """Options of a scene with some values changed, as they are typed; InputError for one that is
    not allowed."""
    known = {field.name: field for field in fields_of(Scene)}
    for name in case:
        if name not in known and not name.startswith(OURS):
            raise InputError(f"{name} is no option of scenes" + meant(
                name, known, ": others have their prefix, "
                f"{', '.join(prefix for prefix in OURS if prefix != Scene.prefix)}"))
    rivals = {one: other for pair in RIVALS for one, other in (pair, pair[::-1])}
    given = {name: value for name, value in scene.stated().items()
             if rivals.get(name) not in case}
    given |= {name: _plain(value) for name, value in case.items() if name in known}
    return {f"scene_{name}": as_text(value) for name, value in given.items()}


def _others(case):
    """Options of a case that are none of scenes; InputError for a name that is none."""
    known = [cls.option_name(field.name)[1:] for cls in OPTION_CLASSES for field in fields_of(cls)]
    # (a scene has a contact_modulus, and Form the prefix contact_)
    found = {name: as_text(_plain(value)) for name, value in case.items()
             if name not in Scene.__dataclass_fields__}
    for name in found:
        if name not in known:
            raise InputError(f"{name} is no option" + meant(name, known, LISTED))
    return found


def _checked(scene, case, options):
    """All options of a case, with those that all have; InputError for one that is not allowed."""
    words = _scene_words(scene, case) | options | _others(case)
    entries = {name.lower(): value for name, value in {**words, "archive_resume": ""}.items()}
    made, _, load, steps, _ = [instance(cls, entries) for cls in OPTION_CLASSES]
    check(made, load, steps)
    return words


def _plain(value):
    """A number of NumPy as Python's."""
    return value.item() if isinstance(value, np.generic) else value


def _petsc():
    """PETSc's own options in this process, if it has started."""
    if "petsc4py.PETSc" not in sys.modules:
        return {}
    return {name: value for name, value in database().items() if not name.startswith(OURS)}


def _stems(cases):
    """Values -> the name of a case's archive, with a checksum where it would be too long, or that
    of two."""
    told = {values: "-".join(f"{name}={as_text(_plain(value))}" for name, value in case.items())
            for values, case in cases.items()}
    names = {text: re.sub(r"[^\w.,=+-]+", "_", text) for text in told.values()}
    shared = Counter(names.values())
    for text, name in names.items():
        if shared[name] > 1 or len(name.encode()) > LONGEST:
            names[text] = (name.encode()[:LONGEST].decode(errors="ignore") + "-"
                           + hashlib.sha256(text.encode()).hexdigest()[:12])
    return {values: names[text] for values, text in told.items()}
