"""A point in its contact, looked at: gap, traction and outline of the contact, and its fields."""

from functools import cached_property

import numpy as np

from ..grid.cell import Convolution
from ..grid.outlines import outline
from ..grid.spots import labelled, runs, sizes
from . import states
from .survey import gaps, gaps_once, tractions

NOTHING = 1e-15
"""Part of a point's largest traction up to which there is none."""


class Measurement:
    """A point in its contact, with gap and traction on its window (ranges of the law).

    Parameters
    ----------
    contact : Contact
    point : Point

    Attributes
    ----------
    survey : Survey
    """

    def __init__(self, contact, point):
        self.contact = contact
        self.point = point
        self.grid = contact.grid
        self.state, self.window = point.state, point.state.window
        self.components = len(point.controls)
        self.survey = contact.survey(point.state)

    @cached_property
    def gap(self):
        """Gap (components, nodes): normal a, tangential b, ranges of the law."""
        return gaps(self.contact, self.state)

    @property
    def traction(self):
        """Traction (components, nodes), evaluated when it is asked for, phi_i / delta_i."""
        return tractions(self.contact, self.state)

    @cached_property
    def in_contact(self):
        """Mask of the nodes in contact."""
        return self.gap[0] < self.contact.scene.contact_threshold

    @cached_property
    def spot_map(self):
        """Number of the spot of contact (1, 2, ...) that each node of the cell belongs to, 0 where
        there is none (`spots.labelled`)."""
        touching = np.zeros(self.grid.local_shape, dtype=bool)
        self.window.put(self.in_contact, touching)
        return labelled(touching, self.grid)

    @cached_property
    def spot_areas(self):
        """Length or area of each spot: that of its nodes."""
        if len(self.grid.shape) == 1:
            nodes = runs(self.window.node_numbers()[self.in_contact], self.grid.size)
        else:
            nodes = sizes(self.spot_map, self.grid)
        return nodes * self.grid.node_area

    @cached_property
    def outline(self):
        """`Outline` of the contact, beta."""
        return outline(self.window, self.gap[0], self.contact.scene.contact_threshold,
                       self.contact.kernels.crossings)

    @cached_property
    def _sticking(self):
        """(2, nodes), both below 0 at the nodes in contact that stick; whether some of the contact
        slips, and some nodes of it stick."""
        scene, peak = self.contact.scene, self.contact.law.slip_peak
        # (no squares, which bend more from node to node)
        slip = np.sqrt(np.einsum("in,in->n", self.gap[1:], self.gap[1:])) / peak - 1.0
        inside = slip[self.in_contact]
        return (np.stack([self.gap[0] / scene.contact_threshold - 1.0, slip]),
                self._largest_slip >= peak, self.grid.any(inside < 0.0))

    @cached_property
    def stuck(self):
        """`Outline` of the part of the contact where the slip is short of the law's peak, beta."""
        return outline(self.window, self._sticking[0], 0.0, self.contact.kernels.crossings)

    @cached_property
    def stick_area(self):
        """Length or area where the slip in contact is short of the law's peak."""
        slips, sticks = self._sticking[1:] if self.components > 1 else (False, True)
        if not (slips and sticks):
            return self.contact_area() if sticks else 0.0
        return min(self.contact_area(), self.stuck.inside() if len(self.grid.shape) == 1
                   else self.window.area_below(self._sticking[0], 0.0))

    def component(self, values, index):
        """The value of a component, 0 where the leg has no such unknown."""
        return float(values[index]) if index < self.components else 0.0

    def mean(self, index):
        """Mean displacement over the cell, u_n,r or u_t,r; around an isolated contact that is the
        displacement far away."""
        if self.contact.isolated:
            return self.component(self.contact.signs(self.components) * self.point.displacements,
                                  index)
        return self.component(self.state.means, index) / self.contact.ranges[index]

    def energy(self, name):
        """An energy or work of the point; nan where it is that of a displacement which is not
        defined."""
        undefined = self.contact.datum if name in ("elastic_energy", "external_work") else 0.0
        return getattr(self.point, name) + undefined

    def contact_area(self):
        """Length or area where the gap is below the contact threshold."""
        return self._area

    @cached_property
    def _area(self):
        """`contact_area`, once."""
        if len(self.grid.shape) == 1:
            return self.outline.inside()
        return self.state.nodes.area_below(gaps_once(self.contact, self.state)[0],
                                           self.contact.scene.contact_threshold)

    def minimum_gap(self):
        """Smallest normal gap of the cell, u_n,r."""
        smallest = self.survey.closest
        if smallest >= self.contact.law.range and not self.window.is_whole:
            smallest = self.grid.minimum(self.contact.extended(self.state)[0]
                                         + self.contact.initial_gap)
        return float(smallest / self.contact.ranges[0])

    def maximum_pressure(self):
        """Largest compressive normal traction, p_n,r."""
        return self.survey.pressure

    @cached_property
    def _largest_slip(self):
        """Largest slip in contact, whose edge is mostly between nodes, delta_t."""
        edge = self.window.at_level(self.gap[0], self.contact.scene.contact_threshold, self.gap[1:])
        return max(self.survey.slip, self.grid.maximum(np.linalg.norm(edge, axis=0), initial=0.0))

    def maximum_tangential_gap(self):
        """Largest tangential gap in contact, u_t,r."""
        if self.components == 1:
            return 0.0
        return float(self._largest_slip / self.contact.ranges[1])

    def maximum_tangential_traction(self):
        """Largest tangential traction, p_t,r."""
        return self.survey.shear

    def active_fields(self, nothing=0.0):
        """Fields on the nodes where the law acts, name -> array: ``nodes``, their numbers in the
        fields over the widest window, mirror images near each other; ``displacement`` and
        ``traction`` (components of the scene, nodes) and ``mean`` displacement, in their units;
        ``mode`` where there is one, over the widest window. Of several processes they are parted.
        Nodes whose traction is less than a part of the largest, ``nothing``, are left out."""
        scene, widest = self.contact.scene, self.contact.widest
        found = self.traction
        size = np.max(np.abs(found), axis=0)
        acting = size > NOTHING * self.grid.maximum(size, initial=0.0)
        numbers = self.window.node_numbers()[acting]
        if not widest.is_whole:
            inside = widest.node_numbers()
            order = np.argsort(inside)
            numbers = order[np.searchsorted(inside, numbers, sorter=order)]
        displacement, traction = np.zeros((2, scene.components, len(numbers)))
        lengths = _sizes(scene, "u") / self.contact.ranges
        displacement[:self.components] = self.state.displacement[:, acting]
        traction[:self.components] = found[:, acting]
        mean = np.zeros(scene.components)
        mean[:self.components] = self.state.means
        displacement *= lengths[:, None]
        traction *= _sizes(scene, "p")[:, None]
        found = {"nodes": numbers, "displacement": displacement, "traction": traction}
        if nothing:
            size = np.max(np.abs(found["traction"]), axis=0, initial=0.0)
            acting = size >= nothing * self.grid.maximum(size, initial=0.0)
            found = {name: values[..., acting] for name, values in found.items()}
        found = self.grid.in_order(_images_beside(found["nodes"], widest.extents), found)
        found["mean"] = mean * lengths
        if self._null_or_leading() is not None:
            found["mode"] = self.grid.parted(widest.box(widest.take(self._mode())), -2)
        return found

    def fields(self):
        """Displacement (u_n,r, u_t,r) and traction (p_n,r, p_t,r), or in SI, over the widest
        window, (components of the scene, *box); of several processes they are parted."""
        scene, each = self.contact.scene, (-1, *[1] * len(self.grid.shape))
        displacement, traction = np.zeros((2, scene.components, *self.grid.local_shape))
        displacement[:self.components] = self.contact.extended(self.state)
        displacement *= np.reshape(_sizes(scene, "u") / self.contact.ranges, each)
        self.window.put(self.traction, traction[:self.components])
        traction *= np.reshape(_sizes(scene, "p"), each)
        fields = ((displacement, traction) if self._null_or_leading() is None
                  else (displacement, traction, self._mode()))
        widest = self.contact.widest
        return tuple(self.grid.parted(widest.box(widest.take(field)), -2) for field in fields)

    def _null_or_leading(self):
        """The leading mode and its eigenvalue, at a fold the null vector in its place where no mode
        was looked for, or None."""
        point = self.point
        if point.mode is not None:
            return point.mode, point.leading_eigenvalue
        return (point.tangents[0].state, 0j) if len(point.tangents) == 1 else None

    def _mode(self):
        """The leading mode (real part of a complex one), ranges of the law over its largest value,
        (components of the scene, *cell).

        Beyond the window no traction changes: there (s - 1) v = C D v, but for a constant.
        """
        contact = self.contact
        grid = self.grid
        (mode, eigenvalue) = self._null_or_leading()
        rate = eigenvalue - 1.0
        field = np.zeros((contact.scene.components, *grid.local_shape))
        window, inside = mode.window, field[:self.components]
        gap = states.onto(self.state, window).copy()
        tangent = np.zeros((self.components, self.components, window.size))
        gap[0] += window.take(contact.initial_gap)
        contact.law.evaluate(gap, np.empty_like(gap), tangent)
        if not window.is_whole and rate.imag == 0.0 and abs(rate) > 1e-6:
            window.put(np.einsum("ijn,jn->in", tangent, mode.displacement), inside)
            flat = inside.reshape(self.components, -1)
            Convolution(grid.whole, contact.operator(self.components), self.components,
                        contact.transforms).apply(flat, flat)
            inside /= rate.real
            rim = window.rim()
            beyond = grid.sum((mode.displacement - window.take(inside))[:, rim]) / grid.count(rim)
            inside += beyond.reshape(-1, *[1] * len(grid.shape))
        window.put(mode.displacement, inside)
        return field / grid.first_largest(field)


def _images_beside(numbers, shape):
    """Keys of an order of nodes, the first of which decides first, in which mirror images about the
    middle of a box stand row behind row: fields that are symmetric repeat themselves there, and
    take a fraction of the bytes when they are compressed.

    Parameters
    ----------
    numbers : array (nodes,) of their numbers in the box
    shape : tuple of int
    """
    side, apart = 0, []
    for place, count in zip(np.unravel_index(numbers, shape), shape):
        side = 2 * side + (place < count // 2)
        apart.append(np.abs(place - count // 2))
    return [*apart[:-1], side, apart[-1]]


def _sizes(scene, symbol):
    """Sizes of the units of displacement ('u') or traction ('p') of each component in what the
    scene is told in."""
    return np.array([scene.scale(f"{symbol}_n,r")[0],
                     *[scene.scale(f"{symbol}_t,r")[0]] * scene.dimension])
