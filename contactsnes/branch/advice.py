"""What is known of a scene before it is solved: contact and pull-off by theory, cohesive lengths,
what its grid costs, what its layer takes of the shear, and what to change where it is out of reach.

In scaled units: E* = R = phi_n = 1, tractions in E* u_n,r/beta and E* u_t,r/beta.
"""

import math
from typing import NamedTuple

from ..interface import bodies, laws
from ..reference import (
    bonded_circle_stiffness,
    ligament_stiffness,
    maugis_line,
    maugis_line_pull_off,
    maugis_sphere,
    maugis_sphere_pull_off,
)
from ..scene.isolation import largest_force
from ..scene.settings import tangential_legs
from .costs import cost, in_bytes, in_time
from .grid_choice import cell_of
from .reach import remedies


class Theory(NamedTuple):
    """Contact by Maugis and Dugdale, alone on a half-space: at a normal force its radius (half
    width), and the least force."""

    force: float
    radius: float
    pull_off: float


def advice(scene, load, output, size, steps=None):
    """Lines of advice on a scene and its load path.

    Parameters
    ----------
    scene : Scene, its points chosen or given
    load : Load
    output : Output, which says what is kept
    size : function (value, unit, digits) that puts a value in words
    steps : Steps, optional

    Returns
    -------
    list of str
    """
    sheared = any(tangential_legs(scene, load))
    found = theory(scene, largest_force(scene, load))
    return [*_contact(scene, found, size), *_lengths(scene, found, sheared, size),
            *_cost(scene, load, output, steps), *_layer(scene, found, sheared, size),
            *remedies(scene, load, lambda other: _phrase(other, found, size))]


def theory(scene, force):
    """The `Theory` of a scene at a normal force, or None where its shape or law has none."""
    stress = laws.of(scene).normal_peak * scene.normal_maugis
    try:
        if (scene.geometry, scene.dimension) == ("sphere", 2):
            return Theory(force, float(maugis_sphere(force, stress)[0]),
                          float(maugis_sphere_pull_off(stress)[0]))
        if (scene.geometry, scene.dimension) == ("cylinder", 1):
            # of the exponential law, whose peak is lambda/e
            return Theory(force, float(maugis_line(force, math.e * stress)[0]),
                          float(maugis_line_pull_off(math.e * stress)[0]))
    except (ValueError, ArithmeticError):
        pass
    return None


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
    return [f"contact by theory (Maugis and Dugdale, alone on a half-space): {what} "
            f"{size(found.radius, 'beta', 4)} under the force {size(found.force, unit, 4)}"
            f"{unloaded}; pull-off at {size(found.pull_off, unit, 4)}"]


def cohesive_lengths(scene):
    """Lengths of the cohesive zones that open and that slip, E* phi/strength^2, beta."""
    law = laws.of(scene)
    return tuple(1.0 / (peak * maugis) ** 2 if peak > 0.0 else math.inf
                 for peak, maugis in ((law.normal_peak, scene.normal_maugis),
                                      (law.tangential_peak, scene.tangential_maugis)))


def _lengths(scene, found, sheared, size):
    """Cohesive lengths, and how they compare with the contact."""
    normal, tangential = cohesive_lengths(scene)
    lines = [f"cohesive length of the opening, E* phi_n/sigma_max^2: {size(normal, 'beta', 4)}"
             + (f"; of the slip, E* phi_t/tau_max^2: {size(tangential, 'beta', 4)}" if sheared
                else "")]
    if sheared and found is not None and found.radius > 0.0:
        ratio = tangential / found.radius
        lines.append(f"that is {ratio:.2g} of the contact: slip "
                     + ("runs in from the edge as a front" if ratio < 0.3 else
                        "comes gradually" if ratio < 3.0 else "is about the same everywhere"))
    return lines


def _cost(scene, load, output, steps):
    """Memory, disk and time of the grid that a scene has."""
    found = cost(scene, load, cell_of(scene, load).shape, output, steps)
    disk = f", {in_bytes(found.disk)} of disk" if found.disk else ", nothing on disk"
    return [f"cost, about: {found.points} points, {in_bytes(found.memory)} of memory{disk}, "
            f"{in_time(found.seconds)} of one core"]


# What the layer takes


def sliding_force(scene, found):
    """Force at which all of a contact by theory slips, strength times area: tangential force
    unit."""
    width = 2.0 * found.radius if scene.dimension == 1 else math.pi * found.radius ** 2
    return laws.of(scene).tangential_peak * scene.tangential_maugis * width


def layer_share(scene, found):
    """Displacements of the layer, T H/(G A), and of the contact in it, at the `sliding_force` of a
    contact by theory, u_t,r; None where no layer is there."""
    compliance = bodies.of(scene).rigid_compliance[1]
    if scene.isolated or compliance == 0.0 or not found.radius > 0.0:
        return None
    force = sliding_force(scene, found)
    poisson = getattr(bodies.of(scene), "poisson", 0.5)
    stiffness = (bonded_circle_stiffness(found.radius, poisson) if scene.dimension == 2
                 else ligament_stiffness(found.radius, scene.periods[0]))
    slip = laws.of(scene).slip_peak / scene.tangential_maugis
    return force * compliance / math.prod(scene.periods), float(force / stiffness) + slip


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
