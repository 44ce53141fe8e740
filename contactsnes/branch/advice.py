"""What is known of a scene before it is solved: contact and pull-off by theory, cohesive lengths,
what its grid costs, what its layer takes of the shear, and what to change where it is out of reach.
"""

import math

from ..contact.problem import DISPLACEMENT
from ..interface import laws
from ..scene.isolation import largest_force
from ..scene.settings import tangential_legs
from .costs import cost, in_bytes, in_time
from .grid_choice import cell_of
from .reach import remedies
from .theory import cohesive_lengths, layer_share, sliding_displacement, sliding_force, theory

FAR = 6.0
"""Times the displacement that slides, from which on a path's steps are told to be long."""
SMALL = 0.25
"""Contact radius over the sphere's, up to which strains count as small."""
NEAR = 0.35
"""Part of the cell's width up to which a contact's radius is hardly aware of its neighbours."""


def advice(scene, load, output, size, steps=None, form=None):
    """Lines of advice on a scene and its load path.

    Parameters
    ----------
    scene : Scene, its points chosen or given
    load : Load
    output : Output, which says what is kept
    size : function (value, unit, digits) that puts a value in words
    steps : Steps, optional
    form : Form, optional

    Returns
    -------
    list of str
    """
    sheared = any(tangential_legs(scene, load))
    found = theory(scene, largest_force(scene, load))
    return [*_contact(scene, found, size), *_lengths(scene, found, sheared, size),
            *_cost(scene, load, output, steps, form), *_layer(scene, found, sheared, size),
            *_path(scene, load, found, sheared, size),
            *remedies(scene, load, lambda other: _phrase(other, found, size))]


def _phrase(scene, found, size):
    """Radius and pull-off of another law at the same force, in words; empty where theory has
    none."""
    other = found and theory(scene, found.force)
    force = "R phi_n" if scene.dimension == 2 else "w_n,r"
    return other and (f"a contact of {size(other.radius, 'beta', 4)} and pull-off at "
                      f"{size(other.pull_off, force, 4)}")


def _contact(scene, found, size):
    """Contact and pull-off by theory."""
    if found is None:
        return []
    what, unit = (("radius", "R phi_n") if scene.dimension == 2 else ("half width", "w_n,r"))
    rest = theory(scene, 0.0)
    unloaded = "" if found.force == 0.0 or rest is None else (
        f", {size(rest.radius, 'beta', 4)} under none")
    lines = [f"contact by theory (Maugis and Dugdale, alone on a half-space): {what} "
             f"{size(found.radius, 'beta', 4)} under the force {size(found.force, unit, 4)}"
             f"{unloaded}; pull-off at {size(found.pull_off, unit, 4)}"]
    return [*lines, *_ring(scene, found, what, size), *_too_large(scene, found, what)]


def _ring(scene, found, what, size):
    """What counts as contact, where that is where the theory has attraction."""
    if abs(scene.contact_threshold * laws.of(scene).normal_peak - 1.0) > 0.01:
        return []
    area = ("length", 2.0 * found.outer, "beta") if scene.dimension == 1 else (
        "area", math.pi * found.outer ** 2, "beta^2")
    return [f"with the ring of attraction around it, gaps below e delta_n, which contact_area "
            f"counts: {what} {size(found.outer, 'beta', 4)}, {area[0]} {size(*area[1:], 4)}"]


def _too_large(scene, found, what):
    """What speaks against a contact that is large beside its cell or its sphere."""
    cell = min(scene.periods) if not scene.isolated else math.inf
    if found.outer > NEAR * cell:
        yield (f"the {what} is {found.outer / cell:.2g} of the cell's width, neighbours matter: "
               f"-scene_period {scene.told(4.0 * found.outer, 'beta'):.3g} or more")
    if scene.units == "si":
        part = found.radius * scene.scale("beta")[0] / scene.radius
        if part > SMALL:
            yield (f"the {what} is {part:.2g} of the radius of curvature: strains are not small, "
                   "as the model has them; are all numbers in SI?")


def _lengths(scene, found, sheared, size):
    """Cohesive lengths, and how they compare with the contact."""
    normal, tangential = cohesive_lengths(scene)
    slips = sheared and math.isfinite(tangential)
    lines = [f"cohesive length of the opening, E* phi_n/sigma_max^2: {size(normal, 'beta', 4)}"
             + (f"; of the slip, E* phi_t/tau_max^2: {size(tangential, 'beta', 4)}" if slips
                else "")]
    if slips and found is not None and found.radius > 0.0:
        ratio = tangential / found.radius
        lines.append(f"that is {ratio:.2g} of the contact: slip "
                     + ("runs in from the edge as a front" if ratio < 0.3 else
                        "comes gradually" if ratio < 3.0 else "is about the same everywhere"))
    return lines


def _cost(scene, load, output, steps, form):
    """Memory, disk and time of the grid that a scene has."""
    found = cost(scene, load, cell_of(scene, load).shape, output, steps, form)
    disk = f", {in_bytes(found.disk)} of disk" if found.disk else ", nothing on disk"
    return [f"cost, about: {found.points} points, {in_bytes(found.memory)} of memory{disk}, "
            f"{in_time(found.seconds)} of one core"]


def _layer(scene, found, sheared, size):
    """What the layer takes of the tangential displacement of its top."""
    both = layer_share(scene, found) if sheared and found is not None else None
    if both is None:
        return []
    layer, contact = both
    unit = "w_t,r" if scene.dimension == 1 else "R sqrt(phi_n phi_t)"
    share = layer / (layer + contact)
    lines = [f"shear: tau_max times that contact is {size(sliding_force(scene, found), unit, 4)}; "
             f"there the layer, U = mean slip + T H/(G A), takes {size(layer, 'u_t,r', 3)}, "
             f"{100 * share:.0f} % of the displacement of its top, "
             f"{size(layer + contact, 'u_t,r', 3)}"]
    if share > 0.9:
        lines.append("nearly all of a tangential displacement shears the layer, so that slip "
                     "begins with a jump where friction falls with it: prescribe the force, take "
                     "a smaller -scene_height or a longer -scene_period")
    return lines


def _path(scene, load, found, sheared, size):
    """Where the contact slides on the path, and what to change where that is a small part of a
    leg."""
    end = sliding_displacement(scene, found) if sheared else None
    if end is None:
        return []
    ways = [abs(control.value) for leg in scene.legs(load) for place, control
            in leg.controls.items() if place and control.value and control.control == DISPLACEMENT]
    lines = [] if layer_share(scene, found) else [
        f"all of it slips at a tangential displacement of about {size(end, 'u_t,r', 3)}, or "
        "earlier where slip takes the adhesion away"]
    if ways and max(ways) > FAR * end:
        lines.append(f"the path goes {max(ways) / end:.2g} times as far, and steps are parts of "
                     f"its leg: end it near {scene.told(2.0 * end, 'u_t,r'):.2g}, or take smaller "
                     "-continuation_initial_step and -continuation_largest_step")
    elif ways and max(ways) < end:
        lines.append(f"the path ends at {max(ways) / end:.2g} of that")
    return lines
