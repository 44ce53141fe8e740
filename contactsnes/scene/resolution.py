"""Spacings of a grid that resolve the cohesive zone of a scene."""

import dataclasses
import math

from ..interface import bodies, laws, shapes
from ..interface.laws.coupled import SOFTENING
from ..options.fields import as_text

LARGEST_RESOLUTION = 1.25
"""Largest dx lambda_n^2 at which the cohesive zone of a exp(-a) is resolved (relative error of the
force about 1e-6)."""
LARGEST = 2 ** 28
"""Points of the largest grid that is worth a try."""

PINNING = 1.8
"""``resolution`` from which on single nodes snap in and off, so that edges of contact stick between
nodes.

Measured on a line: 2.2 for a normal Maugis parameter of 10, below 2 for 20.
"""


def resolution(scene, sheared):
    """Spacing over the largest one that resolves the cohesive zone, in each direction (1 or less is
    resolved), a tuple.

    The edge of contact does not stick between nodes if the stiffness at the Nyquist wavenumber, c
    pi/dx (c = 1/2 normally), is well above the steepest softening of the law, s lambda^2 with s =
    e^-2 normally. dx lambda_n^2 <= 1.25 is a margin of 9.3 between the two; the same margin is
    asked of the tangential components, c/(s lambda_t^2 dx) >= (1/2)/(e^-2 1.25), with s the law's
    steepest softening in slip (``slip_softening``) and c = 1/2 (plane strain), or (1 - nu)/2 for
    waves transverse to the slip in two dimensions, and of both together (``coupled_softening``).
    Directions without an edge of contact give 0.

    Parameters
    ----------
    scene : Scene
    sheared : bool, whether tangential unknowns appear
    """
    steepest = _softening(scene, sheared)
    return tuple(spacing * steepest for spacing in _over_softest(scene))


def resolution_of_states(scene):
    """Function (steepest softening of the law in a state, E*/beta) that tells the largest
    `resolution` for that in place of the law's where nothing overlaps."""
    largest, compliance = max(_over_softest(scene)), max(bodies.of(scene).local_compliance)
    return lambda steepest: largest * _in_series(steepest, compliance)


def _over_softest(scene):
    """Spacing in each direction over the largest one that resolves a softening of 1 E*/beta."""
    uniform = shapes.of(scene).uniform
    return tuple(0.0 if axis in uniform else spacing / (SOFTENING * LARGEST_RESOLUTION)
                 for axis, spacing in enumerate(scene.spacings))


def _softening(scene, sheared):
    """Steepest softening of the law that the body meets behind what deforms at each place for
    itself, E*/beta."""
    law, (normal, tangential) = laws.of(scene), bodies.of(scene).local_compliance
    found = [_in_series(law.softening * scene.normal_maugis ** 2, normal)]
    if sheared:
        sharp = sharpness(scene)
        # How soft transverse waves are matters to the layer, not to the spring in front of it.
        found += [_in_series(sharp ** 2 * law.slip_softening, tangential,
                             scene.tangential_maugis ** 2 * law.slip_softening),
                  _in_series(law.coupled_softening(scene.normal_maugis, sharp),
                             max(normal, tangential),
                             law.coupled_softening(scene.normal_maugis, scene.tangential_maugis))]
    return max(found)


def _in_series(softening, compliance, local=None):
    """Softening of a law behind a spring at each place, whose own part in it may be another
    (``local``), E*/beta; inf where these places snap by themselves."""
    left = 1.0 - compliance * (softening if local is None else local)
    return softening / left if left > 0.0 else math.inf


def sharpness(scene):
    """The tangential Maugis parameter, larger in two dimensions, where waves transverse to the slip
    are softer by 1 - nu."""
    return scene.tangential_maugis * (1.0 if scene.dimension == 1
                                      else math.sqrt(1.0 / bodies.of(scene).transverse_stiffness))


def default_spacing(scene):
    """Spacing of an isolated contact unless one is given: resolves the cohesive zone, and what a
    soft law spans."""
    sharp = resolution(dataclasses.replace(scene, spacing=1.0), scene.tangential != "off")
    return min(0.976 / max(sharp), 0.5 / math.sqrt(scene.normal_maugis))


def resolution_warning(scene, sheared):
    """One sentence with the number of points to take where the grid does not resolve the cohesive
    zone, else None."""
    ratios = resolution(scene, sheared)
    if max(ratios) <= 1:
        return None
    if scene.isolated:
        return (f"the spacing of {scene.words(scene.spacings, 'beta')} does not "
                f"resolve the cohesive zone: it is {max(ratios):.3g} times "
                "the largest that does, and results may depend on where "
                "nodes lie; try -scene_spacing "
                f"{scene.told(0.976 * min(scene.spacings) / max(ratios), 'beta'):.3g}")
    needed = tuple(points if ratio <= 1 else 2 ** math.ceil(math.log2(points * ratio))
                   for points, ratio in zip(scene.shape, ratios))
    return (f"the grid of {as_text(scene.shape)} points does not resolve the "
            f"cohesive zone: its spacing is {max(ratios):.3g} times the "
            "largest that does, and results may depend on where nodes lie; "
            + (f"try -scene_points {as_text(needed)}" if math.prod(needed) <= LARGEST else
               f"{as_text(needed)} would do: contactsnes info tells what does on fewer"))
