"""An isolated contact: one body on an unbounded flat, on a box of nodes that the largest force of a
load chooses.

Its cell is a circle of lags (`unbounded`): a window of up to half of it is convolved with the
unbounded body's own kernel. Nothing is periodic, but what needs a cell, as damped motion does,
finds a periodic contact on the same nodes in ``periodic``.
"""

import math
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..continuation.points import NotConverged
from ..grid.counter import Counter
from ..grid.lengths import fast_length
from ..grid.operator import Operator
from ..grid.roots import bracketed_root
from ..grid.windows import Window
from ..interface import laws, shapes
from ..options.fields import InputError
from .problem import Contact

ROOM = {1: 10.0, 2: 5.2}
"""Extent of the circle of lags over the half-width of the largest window, at least 4, by dimension
of the interface."""


class OutOfBox(NotConverged):
    """A contact that spreads beyond the nodes that were laid out for it."""


def half_width(scene, force):
    """Distance from the apex (beta) up to which a pressed body is within the law's range, or a
    little more: that of the parabola below it, a cylinder or sphere.

    Contact up to the radius a of Johnson, Kendall and Roberts; beyond it the gap of Hertz, with s =
    r/a, is (a^2/2) (s sqrt(s^2 - 1) - arcosh s) on a line and (a^2/pi) (sqrt(s^2 - 1) + (s^2 - 2)
    arccos(1/s)) in the plane. Of curvature c: lengths are beta c^(-2/3), gaps u_n,r c^(-1/3).
    """
    # most runs are of cells, and do without
    from ..reference import jkr_line_half_width, jkr_sphere_radius

    curvature = shapes.of(scene).parabola[scene.dimension]
    force = force * curvature ** (1 / 3 if scene.dimension == 1 else 1)
    if scene.dimension == 1:
        radius = jkr_line_half_width(force)
        gap = lambda s: radius ** 2 / 2 * (s * math.sqrt(s * s - 1) - math.acosh(s))
    else:
        radius = jkr_sphere_radius(force)
        gap = lambda s: radius ** 2 / math.pi * (math.sqrt(s * s - 1)
                                                 + (s * s - 2) * math.acos(1 / s))
    wanted = laws.of(scene).reach / scene.normal_maugis * curvature ** (1 / 3)
    farthest = 10.0 + 10.0 * math.sqrt(wanted) / radius
    reach = radius * bracketed_root(lambda s: gap(s) - wanted, 1.0, farthest)
    return curvature ** (-2 / 3) * reach


def lay_out(scene, force):
    """The periodic scene on whose cell an isolated one is solved under forces up to a given one.

    Raises InputError where contact may end beyond the nodes that are laid out.
    """
    if scene.contact_threshold > laws.of(scene).certain:
        raise InputError(f"-scene_contact_threshold is '{scene.contact_threshold:g}': an "
                         "isolated contact (-scene_period inf) has nodes within the law's range; "
                         f"allowed is at most {laws.of(scene).certain:g}, or take a finite "
                         "-scene_period")
    extent = ROOM[scene.dimension] * 1.1 * half_width(scene, force)
    points = [16 * fast_length(math.ceil(max(extent / spacing, 128.0) / 16))
              for spacing in scene.spacings]
    periods = [n * spacing for n, spacing in zip(points, scene.spacings)]
    if scene.dimension == 1:
        points, periods = points[0], periods[0]
    return replace(scene, points=points, period=periods, spacing=None)


class IsolatedContact(Contact):
    """A contact whose body is deformed in one place only; else as `Contact`.

    Parameters
    ----------
    cell : Scene of the periodic cell on its nodes (`lay_out`)
    counter : the grid that counts transforms, if not this contact's: one transform is that of the
        window's nodes. A contact on a coarser grid has it, whose states are guesses
    gap, law, kernels : in place of the scene's, as of `Contact`
    """

    isolated = True

    def __init__(self, cell, counter=None, gap=None, law=None, kernels=None):
        self._guesses, self._rigid = counter is not None, np.zeros(cell.components)
        own = Counter(math.prod(n // 2 for n in cell.shape))
        super().__init__(cell, counter=own if counter is None else counter, gap=gap, law=law,
                         kernels=kernels)

    @property
    def datum(self):
        """0 where the displacement of the body as a whole is defined; nan for a half-plane, which
        has none under a force."""
        known = self.scene.dimension == 2 or np.isfinite(self.body.far_field().height)
        return 0.0 if known else np.nan

    @cached_property
    def periodic(self):
        """The contact on the same nodes in a cell, with neighbours."""
        return Contact(self.scene, gap=self.initial_gap, law=self.law, grid=self.grid,
                       kernels=self.kernels)

    @cached_property
    def widest(self):
        """The largest window, on whose nodes fields are known: half of the circle of lags in each
        direction."""
        return Window(self.grid, [n // 4 for n in self.grid.shape],
                      [n // 2 for n in self.grid.shape])

    def operator(self, components, kind="compliance"):
        """Operator of the unbounded body's compliance among components; InputError for the
        stiffness."""
        if kind != "compliance":
            raise InputError("forms of the equations with a stiffness "
                             "(-contact_form force, -contact_first relaxation) need "
                             "a cell, which an isolated contact (-scene_period "
                             "inf) has not; allowed are displacement and none")
        if (components, kind) not in self._operators:
            from ..interface.unbounded import free_space  # needed here only, and slow to import

            symbols = free_space(self.body, self.grid, components)
            for i in range(components):
                self._rigid[i], symbols[i, i].flat[0] = symbols[i, i].flat[0], 0.0
            self._operators[components, kind] = Operator(self.grid,
                                                         {(i,
                                                           j): symbol
                                                          * (self.ranges[i] * self.ranges[j])
                                                          for (i, j), symbol in symbols.items()})
        return self._operators[components, kind]

    def rigid_compliance(self, components):
        """Compliance of the cell's mean against the far surface for each component, dimensionless;
        0 for the half-plane."""
        self.operator(components)
        return self._rigid[:components] * self.ranges[:components] ** 2

    def mean_mass(self, components):
        """As that of a cell: pi E* for a unit of length on a line, which is a cell's, too, and pi
        E* beta in the plane."""
        return np.pi / (self.ranges[:components] ** 2 * self.grid.area)

    def window(self, normal_gap, half=None):
        """The window around the nodes within the law's range, the unit of the count from now on;
        OutOfBox beyond the box."""
        window = super().window(normal_gap, half)
        if self._guesses:
            return window
        if any(extent > total // 2 for extent, total in zip(window.shape, self.grid.shape)):
            box = " x ".join(str(total // 2) for total in self.grid.shape)
            raise OutOfBox(f"the contact spreads beyond the {box} nodes that "
                           "its largest normal force was thought to need")
        if window.size > 2 ** len(window.shape):
            self.grid.counter.size = window.size
        return window

    def _coarser(self, scene, gap):
        """The contact of a scene on every other node, with its gap there."""
        return IsolatedContact(scene, self.grid.counter, gap, self.law, self.kernels)
