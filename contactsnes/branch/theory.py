"""What theory knows of a scene before it is solved: contact and pull-off, cohesive lengths, and
where the contact slides.

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


class Theory(NamedTuple):
    """Contact by Maugis and Dugdale, alone on a half-space: at a normal force its radius (half
    width), that of the ring of attraction around it, and the least force."""

    force: float
    radius: float
    outer: float
    pull_off: float


def theory(scene, force):
    """The `Theory` of a scene at a normal force, or None where its shape or law has none."""
    stress = laws.of(scene).normal_peak * scene.normal_maugis
    try:
        if (scene.geometry, scene.dimension) == ("sphere", 2):
            return Theory(force, *map(float, maugis_sphere(force, stress)[:2]),
                          float(maugis_sphere_pull_off(stress)[0]))
        if (scene.geometry, scene.dimension) == ("cylinder", 1):
            # of the exponential law, whose peak is lambda/e
            return Theory(force, *map(float, maugis_line(force, math.e * stress)[:2]),
                          float(maugis_line_pull_off(math.e * stress)[0]))
    except (ValueError, ArithmeticError):
        pass
    return None


def cohesive_lengths(scene):
    """Lengths of the cohesive zones that open and that slip, E* phi/strength^2, beta; inf without
    a strength, as of friction that is there under pressure only."""
    law = laws.of(scene)
    return tuple(1.0 / (peak * maugis) ** 2 if peak > 0.0 else math.inf
                 for peak, maugis in ((law.normal_peak, scene.normal_maugis),
                                      (law.tangential_peak, scene.tangential_maugis)))


def sliding_force(scene, found):
    """Force at which all of a contact by theory slips, strength times area: tangential force
    unit."""
    width = 2.0 * found.radius if scene.dimension == 1 else math.pi * found.radius ** 2
    return laws.of(scene).tangential_peak * scene.tangential_maugis * width


def contact_displacement(scene, found):
    """Displacement at which all of a contact by theory slips, without what a layer takes: that of
    the bonded contact under its `sliding_force`, and the slip of the law's peak, u_t,r."""
    poisson = getattr(bodies.of(scene), "poisson", 0.5)
    stiffness = (bonded_circle_stiffness(found.radius, poisson) if scene.dimension == 2
                 else ligament_stiffness(found.radius, scene.periods[0]))
    return (float(sliding_force(scene, found) / stiffness)
            + laws.of(scene).slip_peak / scene.tangential_maugis)


def layer_share(scene, found):
    """Displacements of the layer, T H/(G A), and of the contact in it, at the `sliding_force` of a
    contact by theory, u_t,r; None where no layer is there, or no strength."""
    compliance = bodies.of(scene).rigid_compliance[1]
    if (scene.isolated or compliance == 0.0 or not found.radius > 0.0
            or not laws.of(scene).tangential_peak > 0.0):
        return None
    return (sliding_force(scene, found) * compliance / math.prod(scene.periods),
            contact_displacement(scene, found))


def sliding_displacement(scene, found):
    """Displacement of the top at which all of a contact by theory slips, u_t,r; None where it is
    not known."""
    if (found is None or scene.isolated or not found.radius > 0.0
            or not laws.of(scene).tangential_peak > 0.0):
        return None
    return sum(layer_share(scene, found) or (contact_displacement(scene, found),))
