"""A scene on its grid: the law, the gap and the body of a contact, in ranges of the law.

Everything here is in ranges of the law: displacements v_i = lambda_i u_i, tractions in phi_i /
delta_i, so that compliances carry lambda_i lambda_j.
"""

from dataclasses import replace
from functools import cached_property
from threading import RLock
from weakref import WeakValueDictionary

import numpy as np

from ..grid.active import widened
from ..grid.cell import Convolution, Grid
from ..grid.clusters import fitting
from ..grid.operator import Operator
from ..grid.parity import UNEVEN, asymmetry
from ..grid.windows import enclosing
from ..interface import bodies, laws, shapes
from ..interface.gap import gap_of_heights, is_convex, over_nodes
from ..interface.own_shapes import gap_on
from ..kernels.choice import chosen
from ..options.arguments import alone, of_class, sealed, unpicklable
from ..scene.parts import with_parts
from ..scene.scene import Scene, changed
from .keeping import kept
from .survey import site, surveyed, tractions

DISPLACEMENT, FORCE = "displacement", "force"
APPROACH = "approach"
"""Control of the mean surface itself, without the rigid compliance of the body: what a cold start
holds."""

SUPPORT = 2
"""Nodes about one in contact that an interpolation of the edge of contact there may ask for."""
ROOM = 3.0
"""Gap beyond that of contact, ranges, of nodes that a window reckons with as in contact later."""


@unpicklable("pickle its scene, and make another one of that, Contact(scene, ...)")
@sealed("a contact", "make another one, Contact(scene, ...), which takes heights, a gap or a law "
        "in place of the scene's")
class Contact:
    """A scene on its grid: law, initial gap and body, in ranges of the law. Immutable, since much
    is made of each part.

    Parameters
    ----------
    scene : Scene
    heights : array over the grid for the geometry ``file``, or in place of another's, u_n,r
    counter : the grid that counts transforms, in units of its own, if not this contact's
    gap : array over the grid in place of the scene's initial gap, delta_n
    law, geometry, body : Law, Shape (or a function of the coordinates) and Body in place of the
        scene's
    grid : Grid to share in place of one of its own
    kernels : what computes, of `kernels.choice.chosen`; None: the compiled ones where they are

    Attributes
    ----------
    grid : Grid
    kernels : as given, or chosen
    transforms : what makes transforms that are kept, whose memory others use between two calls;
        None on planes, where they would take too much
    law : Law
    ranges : (lambda_n, lambda_t, ...), one a component of the scene
    initial_gap : array over the cell, delta_n
    datum : 0 where the displacement of the body as a whole is defined, nan where it is not
    isolated : whether means are to be told as displacements of the far surface
    turn : lock of the threads that compute with it, since they share its memory

    Raises
    ------
    InputError : for heights that do not fit the grid, or a gap that is given twice
    AttributeError : where an attribute is to be changed
    """

    datum, isolated = 0.0, False
    survey, site = kept(1)(surveyed), kept(4)(site)

    def __init__(self, scene, heights=None, counter=None, *, gap=None, law=None, grid=None,
                 geometry=None, body=None, kernels=None):
        alone(heights=heights, gap=gap, geometry=geometry)
        scene = with_parts(of_class("scene", scene, Scene), law, geometry, body)
        self.scene = scene if heights is None else _of_heights(scene, heights)
        self.grid = Grid(scene.shape, scene.periods, counter) if grid is None else grid
        self.ranges = np.array(scene.ranges)
        self._signs = np.array([-1.0] + [1.0] * (len(self.ranges) - 1))
        self.kernels = chosen() if kernels is None else kernels
        self.transforms = self.kernels.real if scene.dimension == 1 else None
        self.law = self.kernels.law(laws.of(scene) if law is None else law)
        if gap is None:
            gap = self.ranges[0] * self._initial_gap(heights)
        elif grid is None:
            gap = over_nodes("gap has", gap, scene)
        self.initial_gap = np.array(gap, dtype=float, order="C")
        self.body = bodies.of(scene)
        self._operators, self._like = {}, WeakValueDictionary()
        for array in (self.ranges, self._signs, self.initial_gap):
            array.flags.writeable = False
        self.turn = RLock()
        self._sealed = True

    def _initial_gap(self, heights):
        """The initial gap over the cell, u_n,r."""
        if heights is None:
            return gap_on(shapes.of(self.scene), self.grid, self.scene)
        here = self.grid.part_of(np.asarray(heights, dtype=float))
        return gap_of_heights(here, self.grid) + self.scene.gap_offset

    @property
    def widest(self):
        """The largest window, on whose nodes fields are known."""
        return self.grid.whole

    @cached_property
    def convex(self):
        """Whether the initial gap is: it only grows away from a window around the contact, and a
        cold solve may be trusted."""
        return is_convex(self.initial_gap, self.grid)

    @cached_property
    def unevenness(self):
        """Largest difference between mirror images about the apex in the initial gap, delta_n."""
        return asymmetry(self.grid.whole, self.initial_gap.reshape(1, -1))

    @cached_property
    def mean_initial_gap(self):
        """Mean of the initial gap over the cell, delta_n."""
        return self.grid.sum(self.initial_gap.reshape(-1)) / self.grid.size

    @cached_property
    def scattered(self):
        """Whether solves are on the nodes of a plane where the law may act, wherever these are,
        instead of on boxes: the gap is neither convex nor even, or processes share out the cell."""
        return self.scene.dimension == 2 and (self.grid.shared or (
            not self.convex and self.unevenness > UNEVEN))

    @property
    def periodic(self):
        """The contact in a cell, whose damped motion can be followed: this one."""
        return self

    def signs(self, components):
        """-1 for the normal, +1 for tangential components: load = sign x displacement of the
        body."""
        return self._signs[:components]

    def rigid_compliance(self, components):
        """Compliance of the mean, c_0 = lambda^2 / k_0, for each component (dimensionless)."""
        return self._compliance_of_mean[:components].copy()

    @cached_property
    def _compliance_of_mean(self):
        """The same of all components."""
        normal, tangential = self.body.rigid_compliance
        return np.array([normal] + [tangential] * (len(self.ranges) - 1)) * self.ranges ** 2

    def mean_mass(self, components):
        """Mean traction over the speed of the mean displacement in overdamped motion, for each
        component (dimensionless): the stiffness of the cell's softest wave."""
        blocks = self.operator(components).blocks
        return np.array([1.0 / (self.grid.size * self.grid.maximum(blocks[i, i].real))
                         for i in range(components)])

    def operator(self, components, kind="compliance"):
        """Operator of the mean-free compliance or stiffness among components, scaled to ranges of
        the law."""
        key = (components, kind)
        if key not in self._operators:
            power = 1 if kind == "compliance" else -1
            blocks = self.grid.symbols(getattr(self.body, kind), components)
            scaled = {(i, j): symbol * (self.ranges[i] * self.ranges[j]) ** power
                      for (i, j), symbol in blocks.items()}
            made = Operator(self.grid, scaled, self.transforms, self._like)
            self._operators[key] = self._like[key] = made
        return self._operators[key]

    @kept(32)
    def circle(self, component, shape, even=False, count=1, signs=None, apart=1):
        """(transform, C_ii) of a component on a circle, C scaled to ranges, `Grid.with_mean` at 0.

        Parameters
        ----------
        component, shape, apart : int, points in each direction, spacings of the cell between them
        even, signs : whether points are those from the axis outwards, and fields odd in some
        count : int, fields of a transform
        """
        grid = self.grid if even else self.grid.of_circle(shape)
        components, key = 1 if component == 0 else 1 + len(shape), (component, component)
        if even:
            transform = self.kernels.even(grid, shape, count, signs and (signs,) * count)
            own = self.body.diagonal(transform.wavevectors(grid.spacings), components,
                                     last_even=shape[-1] % 2 == 0)[key]
        else:
            transform = self.kernels.circle(grid, shape, count)
            own = grid.symbols(self.body.diagonal, components, shape, apart)[key]
        return transform, grid.with_mean(own * self.ranges[component] ** 2)

    @kept(1)
    def coarse(self, resolution):
        """The contact on every other node, its law softened to spacing x maugis^2 <= resolution;
        the grid counts for both."""
        scene = self.scene
        points = tuple(n // 2 for n in self.grid.shape)
        sharpest = float(np.sqrt(resolution / (2.0 * max(self.grid.spacings))))
        normal = min(scene.normal_maugis, sharpest)
        softened = changed(
            scene, points=points if scene.dimension == 2 else points[0], normal_maugis=normal,
            tangential_maugis=min(scene.tangential_maugis, sharpest),
            contact_threshold=scene.contact_threshold * normal / scene.normal_maugis,
            range_normal=None, range_tangential=None)
        return self._coarser(softened, softened.ranges[0] / self.ranges[0]
                             * self.grid.every_other(self.initial_gap))

    def _coarser(self, scene, gap):
        """The contact of a scene on every other node, with its gap there."""
        return Contact(scene, counter=self.grid.counter, gap=gap, law=self.law, grid=self.grid.half,
                       kernels=self.kernels)

    def couples(self):
        """Whether a normal load moves the interface sideways: compressible bodies, thin layers."""
        return (0, 1) in self.operator(self.scene.components).blocks

    def load_factor(self, components):
        """Force of a component over the sum of its traction over nodes: sign x lambda x area of a
        node."""
        return self.signs(components) * self.ranges[:components] * self.grid.node_area

    def far_displacement(self, components, values):
        """Displacements in ranges of the law from D and U (u_n,r, u_t,r): -lambda_n D, lambda_t
        U."""
        return self.signs(components) * self.ranges[:components] * values

    @kept(4)
    def gap_on(self, nodes):
        """The initial gap at nodes of the cell, delta_n, not to be changed."""
        gap = nodes.take(self.initial_gap)
        gap.flags.writeable = False
        return gap

    def extended(self, state):
        """Displacement over the whole cell (components, *grid) of a state on a window, by one
        convolution.

        Outside the window the law is zero, so the balance itself gives the displacement there.
        """
        components, window = state.components, state.window
        if window.is_whole:
            return state.displacement.reshape(components, *self.grid.local_shape).copy()
        cell = np.zeros((components, *self.grid.local_shape))
        window.put(tractions(self, state), cell)
        flat = cell.reshape(components, -1)
        Convolution(self.grid.whole, self.operator(components), components,
                    self.transforms).apply(flat, flat)
        np.subtract(state.means[:, None], flat, out=flat)
        window.put(state.displacement, cell)
        return cell

    def gap_outside(self, state, elastic=None):
        """Normal gap over the whole cell (*grid), inf on the state's window, delta_n: as
        `extended`, but one transform back only; of tractions ``elastic``, if not of the law's."""
        window, blocks = state.window, self.operator(state.components).blocks
        sources = [i for i in range(state.components) if (0, i) in blocks]
        there, back = (self.grid.transform(self.grid, self.grid.shape, count)
                       for count in (len(sources), 1))
        there.real[...] = 0.0
        window.put((tractions(self, state) if elastic is None else elastic)[sources], there.real)
        there.forward()
        back.spectrum[0] = sum(blocks[0, i] * spectrum
                               for i, spectrum in zip(sources, there.spectrum))
        back.backward()
        outside = state.means[0] - back.real[0] + self.initial_gap
        window.put(np.full(window.size, np.inf), outside)
        return outside

    def window(self, normal_gap, half=None):
        """The window around nodes of the cell, or its half, within the law's range by their gap, or
        all nodes where contact may go beyond it."""
        far = self.scene.contact_threshold > self.law.certain
        near = normal_gap < (np.inf if far else self.law.reach)
        if self.convex or self.grid.shared:
            return enclosing(self.grid, near, 0.05, half)
        return fitting(self.grid, near if half is None
                       else half.full.box(half.unfold(near.reshape(-1))), 0.05,
                       picked=self.scattered)

    def acting(self, normal_gap):
        """Mask of the nodes of the cell whose normal gap (delta_n) is within the law's range, or
        that an interpolation of the edge of contact asks for, with room for it to move."""
        touching = normal_gap < self.scene.contact_threshold + ROOM
        return (normal_gap < self.law.reach) | widened(self.grid, touching, SUPPORT)


def _of_heights(scene, heights):
    """The scene of heights given in place of its geometry, which is then that of a file; InputError
    where they do not fit."""
    over_nodes("heights have", heights, scene)
    return scene if shapes.of(scene).gridded else replace(
        scene, geometry="file", geometry_file="heights given as an array")
