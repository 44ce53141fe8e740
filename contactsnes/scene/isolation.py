"""What an isolated contact asks of a scene and its load: one body, pressed by forces."""

import math

from ..interface import bodies, own_shapes, shapes
from ..options.fields import InputError, as_text
from .load import names

LEFT_OUT = 1e-4
"""Slip that an incompressible layer gives a sphere, ranges of the law, below which it is left out
of normal loading."""


def check_scene(scene):
    """InputError unless a scene with an infinite period is a cylinder or sphere on a grid of given
    spacing, and only such one."""
    if not scene.isolated:
        if scene.spacing is not None:
            raise InputError(f"-scene_spacing is '{as_text(scene.as_typed('spacing'))}': "
                             "it belongs to -scene_period inf; in a cell "
                             "of finite period set -scene_points")
        return
    if any(map(math.isfinite, scene.periods)):
        raise InputError(f"-scene_period is '{as_text(scene.as_typed('period'))}': "
                         "allowed are finite numbers, or inf for every "
                         "direction; an isolated cylinder has -scene_dimension 1")
    own_shapes.check_declared(shapes.of(scene), scene)
    if scene.dimension not in shapes.of(scene).parabola:
        raise InputError(f"-scene_geometry is '{scene.geometry}': with -scene_period "
                         "inf allowed are cylinder (-scene_dimension 1), "
                         "sphere (-scene_dimension 2), and shapes of one's own that "
                         "declare a parabola below them for that dimension")
    if bodies.of(scene).far_field() is None:
        raise InputError(f"-scene_body is '{scene.body}': its kernel on an unbounded flat is not "
                         "known (far_field); take a finite -scene_period")
    if scene.points not in (None, "auto"):
        raise InputError(f"-scene_points is '{as_text(scene.points)}': the grid of "
                         "an isolated contact (-scene_period inf) follows from "
                         "the load and from -scene_spacing; set that instead, "
                         "or auto points")
    if scene.points and scene.spacing:
        raise InputError(f"-scene_spacing is '{as_text(scene.as_typed('spacing'))}', but "
                         "-scene_points auto chooses it: give one of them")


def slides(scene, load):
    """Whether a thick layer of Poisson ratio 1/2 moves the interface of a sphere sideways by more
    than is left out.

    At a distance r from a force W that is r W/(2 pi H^2) times the integral of k^3/(cosh^2 k + k^2)
    over k, 1.087; at the edge of contact at most. What a slip of b ranges changes is b^2 of the
    whole.
    """
    if not scene.isolated or scene.dimension == 1:
        return False
    force = largest_force(scene, load)
    slip = (1.087 / (2 * math.pi) * force * (0.75 * force) ** (1 / 3)
            / (bodies.of(scene).far_field().height ** 2 * math.sqrt(scene.work_ratio)))
    return scene.tangential_maugis * slip > LEFT_OUT


def check_load(scene, load):
    """InputError where the load of an isolated contact prescribes a displacement."""
    known = names(scene.dimension)
    for controls in _prescribed(scene, load):
        for component, control in controls.items():
            if control.control == "displacement":
                raise InputError("-scene_period is 'inf', but the load "
                                 f"prescribes {known[component, 'displacement']}: the "
                                 "surface of an isolated contact has no mean; "
                                 f"prescribe {known[component, 'force']} instead")


def check_form(form):
    """InputError for forms of the equations that an isolated contact has not."""
    for name, value, allowed in (("form", form.form, "displacement"),
                                 ("first", form.first, "none")):
        if value != allowed:
            raise InputError(f"-contact_{name} is '{value}': it needs a cell, "
                             "which an isolated contact (-scene_period inf) has "
                             f"not; allowed is {allowed}")


def largest_force(scene, load):
    """The largest normal force that a load prescribes, at least 0, in the scene's own units."""
    forces = (controls[0].value for controls in _prescribed(scene, load) if 0 in controls
              and controls[0].control == "force")
    return max([0.0, *(force for force in forces if force is not None)])


def _prescribed(scene, load):
    """What is controlled at the start and in each leg: mappings of component to Control, in the
    scene's own units."""
    return scene.initial(load), *(leg.controls for leg in (scene.legs(load) if load.path else ()))
