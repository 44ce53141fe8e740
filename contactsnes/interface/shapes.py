"""What a geometry asks of its scene: its options, and a cell that it fits into."""

import math

from ..options.fields import InputError, as_text


def check_scene(scene):
    """InputError unless a scene has what its geometry needs, and a period that its body fits
    into."""
    if scene.geometry == "sphere" and scene.dimension == 1:
        raise InputError("-scene_geometry is 'sphere': it needs two dimensions; "
                         "add -scene_dimension 2 or take cylinder")
    if scene.geometry == "file" and not scene.geometry_file:
        raise InputError(
            "-scene_geometry is 'file' without a file: name it by -scene_geometry_file")
    if scene.geometry == "rough":
        _check_roughness(scene)
    _check_edge(scene)


def _check_roughness(scene):
    """Roughness is given, and its waves fit into the cell."""
    absent = [name for name in ("rough_slope", "rough_shortest") if getattr(scene, name) is None]
    if absent:
        raise InputError("-scene_geometry is 'rough' without "
                         f"{' and '.join(map(scene.option_name, absent))}: give the rms "
                         "slope and the shortest wave")
    _, _, longest, shortest, _ = scene.roughness
    for name, value, limit, what in (("rough_longest", longest, min(scene.periods), "the period"),
                                     ("rough_shortest", shortest, longest, "the longest wave")):
        if value > limit:
            raise InputError(f"{scene.option_name(name)} is "
                             f"'{as_text(scene.as_typed(name))}': allowed is at most "
                             f"{what}, {as_text(scene.told(limit, 'beta'))}")


def _check_edge(scene):
    """A cylinder or sphere is out of contact at the edge of the cell: L^2/8 + offset >=
    threshold."""
    needed = 8 * (scene.contact_gap - scene.gap_offset)
    periods = {"cylinder": scene.periods[:1], "sphere": scene.periods}.get(scene.geometry, ())
    if any(period ** 2 < needed for period in periods):
        smallest = scene.told(math.ceil(1e3 * math.sqrt(needed)) / 1e3, "beta")
        raise InputError(f"-scene_period is '{as_text(scene.as_typed('period'))}': the "
                         f"{scene.geometry} would be in contact up to the "
                         "edge of the cell; the smallest period allowed "
                         f"here is {smallest:.6g}")


def check_grid(scene):
    """InputError if the grid of a scene, where it is known, is too coarse for the shortest wave of
    its roughness."""
    if (scene.geometry == "rough" and scene.points != "auto"
        and scene.rough_shortest < 2 * max(scene.spacings)):
        raise InputError("-scene_rough_shortest is "
                         f"'{as_text(scene.as_typed('rough_shortest'))}': allowed is at "
                         "least two spacings of the grid, "
                         f"{2 * scene.told(max(scene.spacings), 'beta'):.6g}; take more "
                         "-scene_points, or auto")
