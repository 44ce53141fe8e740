"""What is solved, and with which steps: all dataclasses of options, and what holds for them
together.

Each field is one option: ``-`` + the class's ``prefix`` + the field's name. Its metadata, made by
`fields.option`, say all the rest (meaning, unit, what is allowed), so that reading, checking and
help need no second list.
"""

import dataclasses

from ..interface import bodies, shapes
from ..options.arguments import of_class
from ..options.fields import InputError, declare
from . import digits, isolation, parts
from .load import Load
from .scene import Scene
from .steps import Form, Output, Steps

OPTION_CLASSES = declare(Scene, Form, Load, Steps, Output)


def of_run(scene, load, steps=None, form=None):
    """Steps and form of a run, those by default in place of None; InputError for an argument that
    is of another class than these have: a path as text, or one in the place of another.

    Parameters
    ----------
    scene : Scene
    load : Load
    steps : Steps, optional
    form : Form, optional
    """
    given = (scene, load, Steps() if steps is None else steps, Form() if form is None else form)
    example = "an object of contactsnes.Load, for instance Load(path='normal_force=1')"
    for made, cls in zip(given, (Scene, Load, Steps, Form)):
        of_class(cls.__name__.lower(), made, cls, example if cls is Load else "")
    return given[2:]


def check(scene, load, steps=Steps()):
    """InputError unless load path and steps fit the scene. A path that is not set is not missed
    here.

    Parameters
    ----------
    scene : Scene
    load : Load
    steps : Steps
    """
    if scene.isolated:
        isolation.check_load(scene, load)
    if scene.points != "auto":
        shapes.of(scene).check_grid(scene)
    sheared, slips = _sheared(scene, load), any(tangential_legs(scene, load))
    digits.check(scene, load, slips)
    bodies.of(scene).check(scene, slips)
    if scene.tangential == "off" and any(sheared):
        text = [load.start or "", *load.path.split(";")][sheared.index(True)].strip()
        raise InputError("-scene_tangential is 'off', but the load has "
                         f"'{text}': allowed are auto and on, or a load "
                         "without tangential quantities")
    if load.path and steps.legs not in (None, len(sheared) - 1):
        raise InputError(f"{steps.lists}, for {steps.legs} legs, "
                         f"-load_path has {len(sheared) - 1}: give one number, or one per leg")


def _sheared(scene, load):
    """Whether the start and each leg name a tangential quantity (at the start: other than what
    holds without), a list."""
    initial = load.initial(scene.dimension, scene.isolated)
    resting = "force" if scene.isolated else "displacement"
    legs = load.legs(scene.dimension) if load.path else ()
    return [any(control != (resting, 0.0) for component, control in initial.items() if component),
            *(max(leg.controls) > 0 for leg in legs)]


def tangential_legs(scene, load):
    """Whether tangential unknowns appear at the start (first entry) and in each leg, a tuple of
    bool.

    With -scene_tangential auto: everywhere if the body couples the components, else from the first
    leg on that names a tangential quantity.
    """
    everywhere = scene.tangential == "on" or scene.coupled or isolation.slides(scene, load)
    sheared = _sheared(scene, load)
    return tuple(scene.tangential != "off" and (everywhere or any(sheared[:leg + 1]))
                 for leg in range(len(sheared)))


def loaded_legs(scene, load):
    """The tangential components that have been loaded at the start (first entry) and by the end of
    each leg, a tuple of sets."""
    legs = [leg.controls for leg in load.legs(scene.dimension)] if load.path else []
    found = [set()]
    for controls in (load.initial(scene.dimension, scene.isolated), *legs):
        found.append(found[-1] | {component for component, control in controls.items()
                                  if component and control.value})
    return tuple(found[1:])


def moving(scene, load):
    """What moves along each leg, a list: the first of what it names that does not rest, (component,
    Control, how far as typed or None where that is not known); None of a leg that moves nothing."""
    initial = load.initial(scene.dimension, scene.isolated)
    found, controls = [], {component: its.control for component, its in initial.items()}
    # (a component that is held otherwise stays where it was, until something moves)
    known = {component: {its.control: its.value} for component, its in initial.items()}
    for leg in load.legs(scene.dimension) if load.path else ():
        named = {component: control for component, control in leg.controls.items()
                 if control.value is not None}
        ways = ((component, control, _way(known[component].get(control.control), control))
                for component, control in named.items())
        found.append(next((one for one in ways if one[2] != 0.0), None))
        controls |= {component: its.control for component, its in leg.controls.items()}
        if found[-1]:
            known = {component: {kind: named[component].value if component in named
                                 else known[component].get(kind)}
                     for component, kind in controls.items()}
    return found


def _way(before, control):
    """How far a leg moves a component from a value, as typed; None where that is not known."""
    return None if before is None else abs(control.value - before)


def ineffective(scene, load, names, form=Form(), output=Output(), estimates=False):
    """Options among `names` (without dash, as in 'scene_poisson') that change nothing here: list of
    (name, why).

    Parameters
    ----------
    scene : Scene
    load : Load
    names : iterable of str
    form : Form
    output : Output
    estimates : bool, whether the errors of points are estimated
    """
    sheared, by_force = any(tangential_legs(scene, load)), form.form == "force"
    unsheared, whole = ("no tangential unknown appears",
                        "the force form is solved on the whole cell")
    rules = (*parts.ineffective(scene, sheared),
             ("scene_tangential_maugis", not sheared, unsheared),
             ("scene_work_ratio", not sheared, unsheared),
             ("scene_accuracy", not estimates, "the points are given, and no errors are estimated"),
             ("contact_cascade", scene.isolated and not load.start,
              "the path begins without a contact"),
             ("contact_window", by_force, whole),
             ("contact_cascade", by_force, whole),
             *((f"contact_{name}", by_force, "it goes before solves of the displacement form")
               for name in ("first", "first_tolerance")),
             ("contact_first_tolerance", form.first == "none", "-contact_first is none"),
             ("contact_linear_precision", by_force, "the force form is solved in double precision"),
             ("archive_fields", not output.file, "there is no -archive_file"),
             *((f"archive_{name}", not output.file or output.fields == "none", "no fields are kept")
               for name in ("precision", "fields_on")),
             *((f"archive_{name}", not output.file, "there is no -archive_file")
               for name in ("stiffness", "resume", "overwrite")))
    found = {}
    for name, without_effect, why in rules:
        if without_effect and name in names:
            found.setdefault(name, why)
    return list(found.items())


def attributes(scene):
    """Name -> value of a scene for the archive, as it is typed, with defaults filled in; two
    directions give a tuple."""
    values = {field.name: scene.as_typed(field.name) for field in dataclasses.fields(scene)
              if field.name not in parts.untold(scene)}
    grid = ("spacing", scene.spacings) if scene.isolated else ("points", scene.shape)
    filled = shapes.of(scene).filled(scene)
    several = {"period": scene.periods, **dict((grid,)),
               **{name: value for name, value in filled.items() if isinstance(value, tuple)}}
    for name, directions in several.items():
        values[name] = scene.told(directions if scene.dimension == 2 else directions[0],
                                  Scene.rule(name)["unit"])
    for name in filled.keys() - several.keys():
        values[name] = scene.told(filled[name], Scene.rule(name)["unit"])
    del values["accuracy"]  # an aim, which a run that is resumed may change
    if scene.body == Scene.rule("body")["default_text"]:
        del values["body"]  # of which archives of earlier versions do not tell
    return {name: value for name, value in values.items() if value is not None}
