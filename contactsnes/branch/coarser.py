"""Correctors on coarser grids, which count in their finer one's units, and their states on it; gaps
between the nodes of a grid."""

from weakref import WeakKeyDictionary

import numpy as np

from ..contact import states
from ..contact.force_form import FORMS
from ..grid.active import some
from ..grid.transfer import extent, interpolated, resampled
from ..grid.transfer import refined as refined_field
from ..grid.windows import Window
from ..interface import shapes
from ..interface.heights import fitted
from ..interface.seams import seams
from ..scene.resolution import LARGEST_RESOLUTION, resolution
from ..solvers.capabilities import asked

SMOOTH = 0.25
"""Ranges of the law by which the gap between the nodes of a grid may miss what its neighbours, by a
cubic, say of it: more is too rough for that grid."""
SHORTEST = 32
"""Fewest nodes of a direction of a coarser grid."""


def coarser(system, contact, tolerance):
    """A corrector for the contact on a coarser grid whose costs are this one's; None if no grid
    but its own serves it.

    Parameters
    ----------
    system : Corrector
    contact : Contact on a coarser grid
    tolerance : of the residual norm, ranges of the law; None: that of -snes_atol
    """
    form = system.settings
    if not (form.cascade and not FORMS[form.form].whole_cell and form.first == "none"
            and asked().has_tangent):
        return None
    coarse = system.on(contact, tolerance)
    coarse.totals, coarse.leads = system.totals, True
    return coarse


def resolving(system, sheared, tolerance=None):
    """A corrector on every other node of a system's grid, where those still resolve gap and
    cohesive zone; None where they do not, or where no other grid serves.

    Parameters
    ----------
    system : Corrector
    sheared : bool, whether there are tangential components
    tolerance : as of `coarser`
    """
    contact = system.contact
    if contact.isolated or any(n % 4 or n < 2 * SHORTEST for n in contact.grid.shape):
        return None
    level = contact.coarse(LARGEST_RESOLUTION)
    if (not np.array_equal(level.ranges, contact.ranges) or _missed(contact) > SMOOTH
        or max(resolution(level.scene, sheared)) > 1.0):
        return None
    return coarser(system, level, tolerance)


_known = WeakKeyDictionary()
"""What `_missed` has told of contacts: it takes as much memory as a solve leaves."""


def _missed(contact):
    """Largest difference between the gap and its cubic interpolation from every other node,
    ranges."""
    if contact not in _known:
        gap = contact.initial_gap
        aside = refined_field(contact.grid, contact.grid.every_other(gap))
        aside -= gap
        _known[contact] = contact.grid.maximum(np.abs(aside, out=aside))
    return _known[contact]


def finer_state(contact, finer, state):
    """The state of a contact as one of the same contact on twice as many nodes in each direction:
    displacements are interpolated by their waves, as smooth as the body makes them.

    Parameters
    ----------
    contact, finer : Contact
    state : State of the first of them
    """
    cell = resampled(contact.grid, finer.grid, contact.extended(state), contact.transforms)
    return states.State(finer.grid.whole, cell.reshape(len(cell), -1), state.means)


def finer_gap(contact, grid):
    """The initial gap (*grid) on a finer grid of a contact whose gap is known on its nodes alone:
    there as it is, between them as heights are interpolated (`heights.fitted`).

    Parameters
    ----------
    contact : Contact
    grid : Grid, with several times as many points in each direction
    """
    gap, shape, found = contact.initial_gap, shapes.of(contact.scene), None
    edges = getattr(shape, "heights_edges", "warn")
    if getattr(shape, "heights_fit", "exact") != "exact":
        try:
            found = shape.map()
        except (OSError, ValueError):  # it is no more where it was, or never was
            pass
    if found is None and edges != "pad" and not seams(gap, contact.grid):
        return resampled(contact.grid, grid, gap[None])[0]
    # (of several processes the first one is asked)
    nodes = -contact.grid.joined(gap)
    return grid.spread(lambda: -fitted("", nodes if found is None else _beneath(
        nodes, np.asarray(found.values), edges), grid.shape, "interpolate", edges))


def _beneath(nodes, heights, edges):
    """The map that heights at nodes have been interpolated from, in their unit; themselves where it
    is another one.

    Parameters
    ----------
    nodes, heights : arrays, the latter as the file has them
    edges : as of `heights.fitted`
    """
    there = fitted("", heights, nodes.shape, "interpolate", edges)
    factor = np.ptp(nodes) / (np.ptp(there) or 1.0)
    astray = factor * (there - there.max()) + nodes.max() - nodes
    same = np.abs(astray).max() <= 1e-9 * np.ptp(nodes)
    return factor * (heights - there.max()) + nodes.max() if same else nodes


def refined(contact, finer, state):
    """The state of a contact as one of a contact on twice as many nodes in each direction, whose
    law may be sharper: `finer_state` of the same law, else `sharpened`.

    Parameters
    ----------
    contact, finer : Contact
    state : State of the first of them
    """
    made = finer_state if contact.ranges[0] == finer.ranges[0] else sharpened
    return made(contact, finer, state)


def sharpened(contact, finer, state):
    """The state of the normal component of a contact as one of a contact on twice as many nodes in
    each direction, whose law may be sharper.

    w = a + N(a)/kappa in units of length is interpolated, with one stiffness for both laws: where
    the surfaces overlap it is the traction, elsewhere the gap.

    Parameters
    ----------
    contact, finer : Contact
    state : State of the first of them
    """
    coarse, ratio = state.window, contact.ranges[0] / finer.ranges[0]
    stiffness = finer.law.moving_stiffness
    if finer.grid.shared:
        return _in_rows(contact, finer, state, ratio, stiffness)
    window = Window(finer.grid, [2 * first for first in coarse.start],
                    [2 * n if n == total else 2 * n - 1
                     for n, total in zip(coarse.shape, coarse.grid.shape)])
    smooth = contact.law.regularised(states.normal_gap(contact, state),
                                     stiffness / ratio ** 2) / ratio
    smooth = interpolated(window, smooth)
    gap = window.box(finer.law.gap_of_regularised(smooth, stiffness))
    del smooth  # (what lies on the finest grid is not kept through the transforms that follow)
    # The sharper law reaches less far.
    within = gap < finer.law.reach
    part = tuple(extent(within, axis, margin=2 + count // 20)
                 for axis, count in enumerate(window.shape))
    known = (gap - window.box(window.take(finer.initial_gap)))[part]
    del gap
    window = Window(finer.grid, [first + kept.start for first, kept in zip(window.start, part)],
                    known.shape)
    found = states.State(window, known.reshape(1, -1), state.means / ratio)
    # Beyond half of the cell its own circle is shorter than a padded one; without neighbours the
    # contact counts in transforms of its window.
    beyond = any(n < total < 2 * n for n, total in zip(window.shape, finer.grid.shape))
    return states.fitted(finer, found, afresh=True) if beyond or finer.isolated else found


def _in_rows(contact, finer, state, ratio, stiffness):
    """`refined` to a grid of which some rows are here; the ratio is that of the ranges of the laws.

    Parameters
    ----------
    contact, finer, state : as of `refined`
    ratio, stiffness : float
    """
    # (one name: what lies on the finest grid is not kept through the transforms that follow)
    gap = contact.extended(state)[0] + contact.initial_gap
    smooth = contact.law.regularised(gap.reshape(-1), stiffness / ratio ** 2) / ratio
    gap = refined_field(finer.grid, smooth.reshape(gap.shape)).reshape(-1)
    gap = finer.law.gap_of_regularised(gap, stiffness)
    window = some(finer.grid.whole, np.flatnonzero(gap < finer.law.reach))
    gap = gap[window.places] - window.take(finer.initial_gap)
    found = states.State(window, gap[None], state.means / ratio)
    return states.State(finer.grid.whole, finer.extended(found).reshape(1, -1), found.means)
