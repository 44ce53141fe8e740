"""What speaks against a scene before it is solved, in sentences: a grid that is too coarse, more
processes than it has rows, a displacement that is out of reach, a cell at whose edge the law acts,
a layer thinner than the spacing, heights that step at the seam of theirs, are in another unit or on
a map of another size than given."""

import math

import numpy as np

from ..interface import shapes
from ..interface.gap import at_edge
from ..interface.own_shapes import jumps, proportions
from ..scene import resolution
from ..scene import settings as scenes

STEEP, EVEN = 3.0, 1e-6
"""Root mean square slopes beyond which heights and places are hardly in the same unit."""
MANY = 10_000
"""Steps of a leg beyond which they are hardly meant."""
OFF = 0.02
"""Part of a size by which that which a file tells may miss the one that is given."""
HALF_SPACE = 0.97
"""Tangential compliance for the shortest waves of a grid, over that of a half-space, below which
the layer is thin for it: about the spacing high."""
SHORTER = 1e3
"""How much shorter waves are that meet a half-space."""
COARSE = 1e-3
"""Last digit of heights, ranges of the law, from which on it is told."""
BENT = 0.01
"""Attraction at the edge of the cell, over the law's peak, from which on its bend there is told."""


def cautions(settings, contact):
    """Sentences on grid and surface, for the log and the archive."""
    sheared = any(scenes.tangential_legs(settings.scene, settings.load))
    sentence = resolution.resolution_warning(settings.scene, sheared)
    return (*((sentence,) if sentence else ()), *_idle(contact.grid),
            *of_surface(settings.scene, contact.grid), *_bend(settings.load, contact),
            *_thin(settings.load, contact),
            *_depth(settings.load, contact),
            *_many_steps(settings.scene, settings.load, settings.steps))


def _idle(grid):
    """A sentence on processes that have no rows of a plane, where there are any."""
    if grid.idle:
        yield (f"the plane has {grid.shape[0]} rows (-scene_points), of which {grid.idle} of "
               f"{grid.comm.size} processes have none: these have nothing to do")


def _farthest(scene, load):
    """The largest normal displacement that is prescribed, u_n,r; -inf where none is."""
    return max((value for control, value in (controls.get(0, ("", None)) for controls in (
        scene.initial(load), *(leg.controls for leg in scene.legs(load))))
        if control == "displacement" and value is not None), default=-math.inf)


def _bend(load, contact):
    """A sentence on bodies that the law still attracts where they meet their neighbours at an
    angle: there tractions bend, and sums over nodes err by the square of the spacing."""
    scene, shape, law = contact.scene, shapes.of(contact.scene), contact.law
    if not load.path or contact.isolated or not shape.apart:
        return
    # beside the contact the surface lies below its mean
    gap = at_edge(shape, contact) - contact.ranges[0] * max(_farthest(scene, load), 0.0)
    beyond = np.linspace(min(max(gap, 0.0), law.range), law.range, 1001)
    part = law.normal(beyond)[0].max() / law.normal_peak
    if part > BENT:
        yield (f"at the edge of the cell, where bodies meet their neighbours at an angle, the law "
               f"attracts by up to {part:.2g} of its peak: errors fall as the square of the "
               "spacing there, and no mark of points tells of them; -archive_errors estimates "
               "them, a longer -scene_period is without them")


def _thin(load, contact):
    """A sentence on a sheared layer thinner than the spacing: what deforms at each place for itself
    leaves the law's corner in the traction, so that sums over nodes err by the square of the
    spacing."""
    scene, corners = contact.scene, contact.law.gap_corners
    ratios = resolution.resolution(scene, True)
    if not (corners and max(ratios) and any(scenes.loaded_legs(scene, load))):
        return
    spacing = max(each for each, ratio in zip(scene.spacings, ratios) if ratio)
    waves, body = math.pi / spacing * np.array([1.0, SHORTER]), contact.body
    short, shorter = waves * (body.surface(waves).longitudinal - body.local_compliance[1])
    if short < HALF_SPACE * shorter:
        yield (f"the layer is thinner than the spacing, {scene.short(spacing, 'beta')}, and leaves "
               "the corner of the law, where an overlap ends, in the traction: under shear the "
               "tangential force errs by the square of the spacing, by up to a hundredth, and no "
               "mark of points tells of it; -archive_errors estimates it (error_tangential_force), "
               "half the spacing leaves a quarter")


def _depth(load, contact):
    """A sentence on normal displacements that press the mean surface of a cell, which they are
    those of, deeper into the flat than the law is followed at its deepest node."""
    if not load.path or contact.isolated or contact.body.rigid_compliance[0]:
        return
    scene, deepest = contact.scene, contact.law.deepest
    reached = _farthest(scene, load)
    possible = contact.grid.mean(contact.initial_gap.ravel()) - deepest
    if reached * contact.ranges[0] > possible:
        yield (f"normal_displacement {scene.short(reached, 'u_n,r')} is out of reach: body and "
               f"flat would overlap by more than {-deepest:g} ranges of the law in the mean, as "
               f"beyond {scene.short(possible / contact.ranges[0], 'u_n,r')}; is it in the unit of "
               "the scene?")


def _many_steps(scene, load, steps):
    """Sentences on legs that take more steps than they come to the end of, since the largest one is
    so small.

    Parameters
    ----------
    scene, load, steps : Scene, Load, Steps
    """
    for number, moved in enumerate(scenes.moving(scene, load) if steps.largest_step else (), 1):
        way, largest = moved and moved[2], steps.sizes(number, 1.0)[1]
        if way and way > MANY * largest:
            yield (f"leg {number} takes at least {way / largest:.2g} steps, since it moves by "
                   f"{way:g} and -continuation_largest_step is {largest:g}: is that in the unit "
                   "of what moves?")


def of_surface(scene, grid=None):
    """Sentences on heights or a gap of one's own, empty for other scenes; by rows, where a grid is
    given that has some of them."""
    return [*_seams(scene, grid), *_proportions(scene, grid), *_order(scene), *_size(scene),
            *_part(scene), *_digit(scene)]


def _seams(scene, grid):
    """Sentences on heights or a gap that jump where the cell meets its neighbours."""
    heights = shapes.of(scene).gridded
    what = "the heights are" if heights else "the gap is"
    remedy = ("make the gap periodic, or the period longer than matters" if not heights
              else "-scene_heights_edges window tapers besides"
              if scene.geometry == "file" and shapes.of(scene).heights_edges == "detrend"
              else "-scene_heights_edges detrend takes out the mean plane, window tapers besides")
    names = ("x", "y") if scene.dimension == 2 else ("the line",)
    return [f"{what} not periodic: along {names[axis]} they step "
            f"by {scene.short(jump, 'u_n,r')} across the seam of the cell, "
            f"{jump / typical if typical else math.inf:.3g} times the typical step "
            f"between neighbours, {scene.short(typical, 'u_n,r')}; what is solved "
            f"has this step: {remedy}"
            for axis, jump, typical in jumps(scene, grid)]


def _proportions(scene, grid):
    """Sentences on a map in SI whose heights do not fit its size, or whose nodes are not as far
    apart along x as along y for want of a second size."""
    if scene.units != "si" or not shapes.of(scene).gridded:
        return
    slope, height = proportions(scene, grid)
    slope *= scene.scale("u_n,r/beta")[0]
    unit = shapes.of(scene).unit() if scene.geometry == "file" else "m"
    told = (f"the heights, {scene.short(height, 'u_n,r')} from lowest to highest on a map "
            f"of {scene.short(max(scene.periods), 'beta')}, have a root mean square slope of "
            f"{slope:.2g}")
    asked = (f"are they in {unit} (-scene_heights_unit), and is the size in metres "
             "(-scene_heights_size)?")
    if slope > STEEP:
        yield f"{told}: the model is one of small slopes; {asked}"
    elif 0.0 < slope < EVEN:
        yield f"{told}: {asked}"
    wide, high = max(scene.spacings), min(scene.spacings)
    if wide > 1.01 * high and not isinstance(scene.heights_size, tuple) and scene.heights_size:
        yield (f"one size for a map of {' x '.join(map(str, scene.shape))} points: its nodes are "
               f"{scene.short(scene.spacings[0], 'beta')} apart along x and "
               f"{scene.short(scene.spacings[1], 'beta')} along y; -scene_heights_size takes two, "
               "with a comma")


def _order(scene):
    """A sentence on a map whose nodes were as far apart along x as along y with its sizes in the
    other order, as the width and height of an image."""
    if scene.geometry != "file" or scene.dimension == 1:
        return
    counts = shapes.of(scene).points(scene)
    (along_x, along_y), each = ([length / n for length, n in zip(lengths, counts)]
                                for lengths in (scene.periods[::-1], scene.periods))
    if math.isclose(along_x, along_y, rel_tol=OFF) and not math.isclose(*each, rel_tol=OFF):
        x, y, both = (scene.short(step, "beta") for step in (*each, along_x))
        yield (f"nodes of {' x '.join(map(str, counts))} heights are {x} apart along x and {y} "
               f"along y, and {both} along both if the sizes stood in the other order: x runs down "
               "the rows of a text, y along the numbers in each")


def _size(scene):
    """A sentence on a map whose file tells another size than that which is given."""
    stated = shapes.of(scene).stated(scene) if scene.geometry == "file" else None
    if stated and not np.allclose(stated, scene.periods, rtol=OFF):
        told, taken = (" x ".join(scene.short(length, "beta") for length in lengths)
                       for lengths in (stated, scene.periods))
        yield (f"{scene.geometry_file} itself says {told} of the map, and {taken} is taken, as "
               f"{'-scene_heights_size' if scene.heights_size else '-scene_period'} has it")


def _part(scene):
    """A sentence on a map of which a part is used, or which has a margin, and whose size nothing
    but the period tells."""
    shape = shapes.of(scene)
    if (scene.geometry != "file" or scene.heights_size
            or not (shape.heights_crop or shape.heights_edges == "pad") or shape.stated(scene)):
        return  # nothing is read for a map that is used as it is
    used, whole = shape.points(scene), shape.whole()
    if used != whole:
        sizes = [scene.short(length * n / m, "beta")
                 for length, n, m in zip(scene.periods, whole, used)]
        yield (f"-scene_period is the length of what is used, {' x '.join(map(str, used))} nodes "
               f"of a map of {' x '.join(map(str, whole))} heights: all of the map is taken to be "
               f"{' x '.join(sizes)}; -scene_heights_size is the size of all of it")


def _digit(scene):
    """A sentence on heights so far from 0 that the last digit of their numbers is no small part of
    the law's range: they are rounded to it."""
    last = shapes.of(scene).digit(scene) if scene.geometry == "file" else 0.0
    if last * scene.ranges[0] > COARSE:
        yield (f"the heights are rounded to {scene.short(last, 'u_n,r', 2)}, "
               f"{last * scene.ranges[0]:.2g} ranges of the law: {scene.geometry_file} keeps no "
               "more digits of its largest one; take their mean out before they are written, or "
               "write them in double precision")
