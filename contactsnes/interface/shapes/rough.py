"""A cylinder, sphere or flat with self-affine roughness."""

import math
from dataclasses import replace

import numpy as np

from ...grid.cell import Grid
from ...options.fields import InputError, as_text, option
from ..roughness import FINE, surface
from .shape import Shape

BYTES = 60
"""Memory that a wave takes."""


class Rough(Shape):
    """|x|^2/2 - h or, on a flat, -h, a self-affine h (`roughness.surface`), less its smallest value
    between nodes, too: the same on every grid."""

    name = "rough"
    meaning = "cylinder, in two dimensions sphere, or flat, with self-affine roughness"
    by_rows = True
    rough_on: str = option("sphere", "what is rough: a sphere, on a line a cylinder, or a flat",
                           choices=("sphere", "flat"))
    rough_hurst: float = option(0.8, "Hurst exponent H of roughness, whose power "
                                "spectrum falls as q^-(2H + dimension)", minimum=0,
                                maximum=1)
    rough_slope: float = option(None, "root mean square slope of roughness", "u_n,r/beta",
                                kind="number", above=0, default_text="none: rough needs it")
    rough_longest: float = option(None, "longest wave of roughness", "beta", kind="number", above=0,
                                  default_text="the shortest period")
    rough_shortest: float = option(None, "length that all waves of roughness are longer than",
                                   "beta", kind="number", above=0,
                                   default_text="none: rough needs it")
    rough_rolloff: float = option(None, "roll-off wavelength: waves longer than it have all the "
                                  "power spectrum that it has", "beta", kind="number", above=0,
                                  default_text="the longest wave")
    rough_seed: int = option(0, "seed of the phases of roughness", minimum=0, maximum=2 ** 32 - 1)

    @property
    def uses_radius(self):
        """Of a flat nothing is round."""
        return self.rough_on != "flat"

    @property
    def apart(self):
        """A flat is rough up to the edge of its cell, and goes on there."""
        return self.rough_on != "flat"

    def roughness(self, scene):
        """Hurst exponent, rms slope (u_n,r/beta), longest and shortest wave (beta), seed, roll-off
        (beta), and curvature of what is rough (u_n,r/beta^2)."""
        longest = min(scene.periods) if self.rough_longest is None else self.rough_longest
        rolloff = longest if self.rough_rolloff is None else self.rough_rolloff
        return (self.rough_hurst, self.rough_slope, longest, self.rough_shortest, self.rough_seed,
                rolloff, float(self.rough_on != "flat"))

    def surface(self, scene):
        """The `roughness.Surface`."""
        return surface(tuple(map(float, scene.periods)), *self.roughness(scene))

    def gap(self, coordinates, scene):
        """c |x|^2/2 - h, the coordinates those of a cell's nodes."""
        return self.rows(Grid(np.broadcast_shapes(*(x.shape for x in coordinates)),
                              scene.periods), scene)

    def rows(self, grid, scene):
        """The same by rows."""
        found = self.surface(scene)
        lowest = found.lowest(grid)
        return found.gap(grid) - lowest

    def curvature(self, scene):
        """That of sharp asperities: three times the root mean square."""
        found = self.surface(scene)
        return tuple(found.curvature + 3.0 * found.rms(2, axis) for axis in range(scene.dimension))

    def check(self, scene):
        """InputError unless roughness is given, and its waves fit into the cell."""
        absent = [name for name in ("rough_slope", "rough_shortest") if getattr(self, name) is None]
        if absent:
            raise InputError("-scene_geometry is 'rough' without "
                             f"{' and '.join(map(scene.option_name, absent))}: give the rms "
                             "slope and the shortest wave")
        _, _, longest, shortest, _, rolloff, _ = self.roughness(scene)
        for name, value, limit, what in (("rough_longest", longest, min(scene.periods),
                                          "the period"),
                                         ("rough_shortest", shortest, longest, "the longest wave"),
                                         ("rough_rolloff", rolloff, longest, "the longest wave")):
            if value > limit:
                raise InputError(f"{scene.option_name(name)} is "
                                 f"'{as_text(scene.as_typed(name))}': allowed is at most "
                                 f"{what}, {as_text(scene.told(limit, 'beta'))}")

    def check_grid(self, scene):
        """InputError if the grid is too coarse for the shortest wave."""
        if self.rough_shortest < 2 * max(scene.spacings):
            raise InputError("-scene_rough_shortest is "
                             f"'{as_text(scene.as_typed('rough_shortest'))}': allowed is at "
                             "least two spacings of the grid, "
                             f"{2 * scene.told(max(scene.spacings), 'beta'):.6g}; take more "
                             "-scene_points, or auto")

    def too_near(self):
        """A longer period, or less roughness."""
        return "take a longer period, or a smaller -scene_rough_slope"

    def shortest(self, scene):
        """The shortest wave."""
        return self.rough_shortest

    def memory(self, scene):
        """That of the waves, on the fine grid on which the lowest place is looked for."""
        return BYTES * math.prod(FINE[scene.dimension] * period / self.rough_shortest
                                 for period in scene.periods)

    def smooth(self, scene):
        """That of the parabola."""
        if self.rough_on == "flat":
            return scene
        return replace(scene, geometry={1: "cylinder", 2: "sphere"}[scene.dimension])

    def filled(self, scene):
        """The longest wave and the roll-off."""
        roughness = self.roughness(scene)
        return {"rough_longest": roughness[2], "rough_rolloff": roughness[5]}

    def about(self, scene, size):
        """Waves, slope and height."""
        hurst, slope, longest, shortest, seed, rolloff, _ = self.roughness(scene)
        found = self.surface(scene)
        flat = f", power spectrum flat above {size(rolloff, 'beta', 4)}" * (rolloff < longest)
        return [f"roughness{' of a flat' * (self.rough_on == 'flat')}: Hurst exponent "
                f"{as_text(hurst)}, {found.count} "
                f"waves shorter than {size(longest, 'beta', 4)} and longer "
                f"than {size(shortest, 'beta', 4)}{flat}, seed {seed}", "root mean square "
                f"slope {size(slope, 'u_n,r/beta', 4)}, height "
                f"{size(found.rms(0), 'u_n,r', 4)}"]
