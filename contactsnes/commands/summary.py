"""What would be solved, in words: lines on a scene, its load path, unknowns and method, and on what
is left out."""

import dataclasses
import math
from functools import partial

import numpy as np

from ..branch.grid_choice import again, reason
from ..branch.memory import memory_of_solve
from ..contact import states
from ..contact.scattered import on_nodes
from ..contact.symmetry import has_one_mirror, obstacles
from ..interface import bodies, shapes
from ..options.database import database
from ..options.fields import as_text
from ..options.files import quoted
from ..scene import resolution
from ..scene import settings as scenes
from ..scene.isolation import LEFT_OUT
from ..scene.load import names, quantities
from ..scene.measured import INSTEAD
from ..scene.parts import about_law, peaks
from ..scene.units import DERIVED, Units, prefixed
from ..system.processes import world


def start_window(settings, branch):
    """The window when the path begins."""
    contact, initial = branch.contact, settings.scene.initial(settings.load)
    if settings.form.form == "force" or settings.form.window == "off":
        return contact.grid.whole
    state = states.undeformed(contact, (initial[0].control,), [initial[0].value])
    sheared = scenes.tangential_legs(settings.scene, settings.load)[0]
    if branch.corrector.symmetry.scatters(settings.scene.components if sheared else 1):
        return on_nodes(contact, state, afresh=True).window
    return contact.window(states.normal_gap(contact, state).reshape(contact.grid.local_shape))


def skipped(settings, branch):
    """Sentences on what is left out of the solves, and why."""
    scene, load = settings.scene, settings.load
    sheared = scenes.tangential_legs(scene, load)
    sentences = []
    if scene.tangential == "off":
        sentences.append("no tangential unknowns: -scene_tangential is off")
    elif not any(sheared):
        little = scene.isolated and scene.dimension == 2 and math.isfinite(
            bodies.of(scene).far_field().height)
        why = f"so tall a layer slides by less than {LEFT_OUT:g} ranges" if little else \
            "the body does not couple them to normal ones"
        sentences.append(f"no tangential unknowns: the load names none, and {why}")
    elif not all(sheared):
        sentences.append(
            f"no tangential unknowns before leg {sheared.index(True)}, the first that needs them")
    if any(sheared) and not branch.contact.couples():
        which = ("an incompressible layer this thick"
                 if getattr(bodies.of(scene), "poisson", None) == 0.5 else "the body")
        sentences.append("no elastic coupling of normal and tangential displacements: "
                         f"{which} has none")
    if np.isnan(branch.contact.datum):
        sentences.append("no displacement of the body as a whole (nan): "
                         "that of a half-plane under a force has no bound")
    return [*sentences, _nodes(settings, branch), _mirror_images(settings, branch, sheared)]


def _nodes(settings, branch):
    """Sentence on the nodes that are left out, or why none are."""
    window, cell = start_window(settings, branch), branch.contact.grid.shape
    if settings.scene.isolated:
        return (f"nodes beyond the law's range: the window has {_by(window.shape)} nodes at the "
                f"start; there is room for {_by(n // 2 for n in cell)}")
    if settings.form.form == "force":
        return f"no window: the force form is solved on the whole cell of {_by(cell)} nodes"
    if window.is_whole:
        return f"the window is the whole cell of {_by(cell)} nodes"
    nodes = (f"{len(window.parts)} boxes with {window.total}" if len(window.parts) > 1
             else _by(_extents(window)))
    return f"nodes beyond the law's range: the window has {nodes} of {_by(cell)} nodes at the start"


def _extents(window):
    """Nodes of a box in each direction; of another window their number."""
    box, count = window.parts[0].extents, window.total
    return box if math.prod(box) == count else [count]


def _mirror_images(settings, branch, sheared):
    """Sentence on what symmetry leaves out, or why it does not."""
    if settings.form.symmetry == "off":
        return "no symmetry is used: -contact_symmetry is off"
    why = _asymmetries(settings, branch, sheared)
    reason = next(filter(None, why), None)
    across = ("the mirror across the load leaves half of the plane to be solved, since "
              if _one_mirror(settings, branch, why) else "")
    if all(why):
        return across + reason if across else f"no symmetry is used: {reason}"
    part = "half the line" if settings.scene.dimension == 1 else "a quarter of the plane"
    if reason:
        return (f"mirror images before leg {why.index(reason)}, so that {part} "
                "is solved: the contact is even there; from then "
                f"on {across}{reason}")
    return f"mirror images, so that {part} is solved: scene and load path are even about the apex"


def _asymmetries(settings, branch, sheared):
    """Why states are not even at the start and in each leg, or None."""
    if settings.form.symmetry == "off":
        return ["it is not wanted"] * len(sheared)
    return obstacles(branch.contact, sheared, scenes.loaded_legs(settings.scene, settings.load),
                     settings.form, branch.method)


def _one_mirror(settings, branch, why):
    """Whether the first leg that is not even, of reasons or None of each, has one mirror of two."""
    legs = scenes.loaded_legs(settings.scene, settings.load)
    loaded = next((along for along, reason in zip(legs, why) if reason), None)
    return loaded is not None and has_one_mirror(branch.contact, loaded, settings.form,
                                                 branch.method)


def _by(shape):
    return " x ".join(map(str, shape))


def about_kernels(contact):
    """What computes, in a sentence."""
    if contact.kernels.compiled:
        law = contact.kernels.law_reason
        return "kernels: compiled" + (f", but the law by NumPy, since {law}" if law else "")
    return f"kernels: NumPy, since {contact.kernels.reason}"


def about_scene(settings):
    """Body, interface and grid in words and dimensionless groups."""
    scene = settings.scene
    resolved = resolution.resolution(scene, any(scenes.tangential_legs(scene, settings.load)))
    grid = ("isolated contact" if scene.isolated else
            f"period {_size(scene, scene.periods, 'beta')}, {_by(scene.shape)} points")
    finest = _by(f"{ratio:.3g}" for ratio in resolved)
    return [
        f"{scene.geometry}, interface of dimension {scene.dimension}, law {scene.law}",
        "; ".join([f"normal Maugis parameter {scene.normal_maugis:.8g}, "
                   f"tangential {scene.tangential_maugis:.8g}", *about_law(scene)]),
        ", ".join([*bodies.of(scene).about(scene, partial(_one, scene)),
                   f"ratio of works of adhesion {scene.work_ratio:.8g}"]),
        f"{grid}, spacing {_size(scene, scene.spacings, 'beta', 4)}",
        *shapes.of(scene).about(scene, partial(_one, scene)),
        *_scales(scene),
        *([f"grid: {reason(scene, settings.load)}"] if settings.auto else []),
        f"cohesive zone: the spacing is {finest} of the largest that resolves it"
        + (" (0: no edge of contact in that direction)" if 0.0 in resolved else ""),
    ]


def advised(settings):
    """What is known before solving: contact by theory, cohesive lengths, costs, and what to
    change."""
    from ..branch.advice import advice  # only `info` needs it, with all analytic solutions

    scene = settings.scene
    if scene.points == "auto":  # no grid in memory reaches the accuracy
        scene = dataclasses.replace(scene, points=None)
    output = dataclasses.replace(settings.output, errors=settings.estimates)
    return advice(scene, settings.load, output, partial(_one, scene), settings.steps, settings.form)


def _size(scene, values, unit, digits=8):
    """Values, one a direction, in a unit of the scene, and before that in SI where the scene is
    told in it."""
    size, name = scene.scale(unit)
    text = f"{_by(f'{value:.{digits}g}' for value in values)} {unit}"
    return (text if name == unit
            else f"{_by(prefixed(value * size, name) for value in values)} ({text})")


def _one(scene, value, unit, digits):
    """A value in a unit of the scene, as `_size`."""
    return _size(scene, [value], unit, digits)


def _scales(scene):
    """What a scene in SI is made of, and the units of its dimensionless form."""
    if scene.units == "dimensionless":
        return []
    made = (("works of adhesion", "work_of_adhesion_normal"),
            ("and", "work_of_adhesion_tangential"), ("contact modulus", "contact_modulus"),
            *((("radius", "radius"),) if shapes.of(scene).uses_radius else ()),
            ("ranges", "range_normal"), ("and", "range_tangential"))
    quantity = {name: f"{word} {prefixed(getattr(scene, name), type(scene).rule(name)['unit'])}"
                for word, name in made}
    forces = ("w_n,r", "w_t,r") if scene.dimension == 1 else ("R phi_n", "R sqrt(phi_n phi_t)")
    units = (f"{unit} {prefixed(*scene.scale(unit))}" for unit in ("beta", "u_n,r", "u_t,r",
                                                                   *forces, "p_n,r", "p_t,r"))
    strengths = " and ".join(prefixed(peak * scene.scale(unit)[0], "Pa")
                             for peak, unit in zip(peaks(scene), ("p_n,r", "p_t,r")))
    return ["in SI: " + ", ".join(quantity.values()).replace(", and", " and")
            + f", strengths {strengths}",
            "SI scales: " + ", ".join(units)]


def about_path(settings, legs):
    """Start and legs in words."""
    dimension = settings.scene.dimension
    known, units = names(dimension), quantities(dimension)

    def words(controls, verb):
        for component, (control, value) in controls.items():
            name = known[component, control]
            yield f"{name} is held" if value is None else (
                f"{name} {verb} {settings.scene.typed_words(value, units[name].unit)}")

    lines = ["start: " + ", ".join(words(settings.load.initial(dimension, settings.scene.isolated),
                                         "="))]
    lines += [f"leg {number}: " + ", ".join(words(leg.controls, "goes to"))
              for number, leg in enumerate(legs, start=1)]
    stops = " or ".join(settings.load.stops)
    return lines + ([] if legs else ["no legs: run needs a -load_path"]) + (
        [f"ends at the first {stops}"] if stops else [])


def about_unknowns(settings, branch):
    """Unknowns of each leg, on the window at the start, and an estimate of the memory."""
    scene, window = settings.scene, start_window(settings, branch)
    legs = settings.load.legs(scene.dimension) if settings.load.path else ()
    controls = settings.load.initial(scene.dimension, scene.isolated)
    lines, largest = [], 0
    sheared_legs = scenes.tangential_legs(scene, settings.load)
    for number, (sheared, uneven) in enumerate(zip(sheared_legs,
                                                   _asymmetries(settings, branch,
                                                                sheared_legs))):
        if number:
            controls = controls | legs[number - 1].controls
        components = scene.components if sheared else 1
        forced = sum(controls[i].control == "force"
                     for i in range(components)) if settings.form.form == "displacement" else 0
        nodes = (_extents(window) if uneven
                 else [extent // 2 + 1 for extent in window.parts[0].extents])
        count = components * math.prod(nodes) + forced
        largest = max(largest, count)
        lines.append(
            f"{f'leg {number}' if number else 'start'}: {components} x {_by(nodes)} displacements"
            + (f" + {forced} of force control" if forced else "") + f" = {count} unknowns")
    if window.total < branch.contact.grid.size:
        lines.append("the window grows with the contact, and the unknowns with it")
    whole = (scene.components if any(sheared_legs) else 1) * branch.contact.grid.size
    times = {4: "four", 9: "nine"}[again(scene, settings.load)]
    estimates = f"; to estimate errors, {times} times as much again" if settings.estimates else ""
    return lines + [f"memory: up to {_megabytes(largest, whole)} on the window "
                    f"at the start, {_megabytes(whole, whole)} on the whole "
                    f"cell{estimates}, besides Python and its libraries"]


def _megabytes(unknowns, whole):
    """Memory of a solve in words, of each process where there are several."""
    bytes_of_each = memory_of_solve(unknowns, whole) / world.size
    return f"{math.ceil(1e-6 * bytes_of_each)} MB{' a process' if world.size > 1 else ''}"


def about_method(settings):
    """Form and solver in words."""
    entries = database()
    solver = entries.get("snes_type", "newtonls")
    solver = entries.get("snes_python_type", solver) if solver == "python" else solver
    return [f"{settings.form.form} form, SNES {solver}", f"{settings.steps.type} "
            f"continuation, predictor {settings.steps.predictor}, at a fold: "
            f"{settings.steps.at_fold}"]


def options_in_use(instances):
    """The options of dataclasses that are given, as in a file of options, and how many others have
    their defaults."""
    given, lines, others = database(), [], 0
    in_si = given.get("scene_units") == "si"
    for values in instances:
        for field in dataclasses.fields(values):
            if in_si and (field.name in DERIVED
                          or f"scene_{INSTEAD.get(field.name)}" in given):
                continue  # what it follows from stands for it
            name, value = values.option_name(field.name), getattr(values, field.name)
            if name[1:].lower() not in given:
                others += 1
                continue
            text = as_text(values.as_typed(field.name) if isinstance(values, Units) else value)
            if in_si and field.name != "points":
                text = given.get(name[1:]) or text  # of loads and steps the values in SI
            lines.append(f"{name} {quoted(text)}" if text else name)
    return [*lines, f"# {others} others have their defaults, which contactsnes run -help tells"]
