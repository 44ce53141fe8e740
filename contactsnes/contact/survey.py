"""A state in its contact, surveyed: the numbers that are asked of every point; gap and traction at
its nodes."""

from typing import NamedTuple

import numpy as np

from ..grid.alternation import REACH, across_rows
from ..interface.law_measures import softening
from ..kernels.laws import kernel_of
from ..kernels.sites import Site
from ..scene.resolution import sharpness

PART = 2 ** 14
"""Nodes whose tangents are taken at a time."""

TRACTIONLESS = 1e-5
"""Traction, over the scale of the law, that counts as none: what solves leave of a component that
no load moves is up to some 1e-8, and alternates as it likes."""


class Survey(NamedTuple):
    """What is known of a state, ranges of the law; sums and extremes are those of all its nodes.

    Attributes
    ----------
    closest : smallest normal gap
    slip : largest slip in contact, 0 where nothing touches
    pressure, shear : largest pressure and largest size of the shear traction, phi_i / delta_i
    steepest : steepest softening of the law, of the gap and of the slip along its own direction,
        E*/beta; 0 where it stiffens everywhere
    touching, sticking : nodes in contact, and those of them whose slip is up to the law's peak
    total, work : sums of tractions, and of tractions times displacements, by component
    alternating : part of its largest traction by which that of any component alternates from node
        to node in any direction; 0 where nothing touches
    """

    closest: float
    slip: float
    pressure: float
    shear: float
    steepest: float
    touching: int
    sticking: int
    total: np.ndarray
    work: np.ndarray
    alternating: float


def surveyed(contact, state):
    """The Survey of a state.

    Parameters
    ----------
    contact : Contact
    state : State
    """
    nodes, found = state.nodes, contact.site(state.nodes)
    grid = contact.grid if state.half is None else state.half.grid
    numbers, traction = (found.survey(state.once) if found else by_numpy(
        contact.law, state.once, contact.gap_on(nodes), getattr(grid, "weights", None),
        *judged(contact.scene, contact.law).values()))
    numbers[0] *= -1.0
    lowest, *largest = grid.largest(numbers[:5]).tolist()
    sums = grid.together(numbers[5:7 + 2 * state.components])
    total, work = sums[2:].reshape(2, -1)
    for i, signs in enumerate(getattr(nodes, "parities", None) or ()):
        if -1 in signs:
            total[i] = 0.0
    touching, sticking = sums[:2].astype(int).tolist()
    return Survey(-lowest, *largest, touching, sticking, total, work,
                  0.0 if not touching else float(numbers[-1]) if found and found.halved
                  else _alternating(contact, state, traction))


def judged(scene, law):
    """What states are judged by, by the names of `structures.Site`: gap of contact, slip of the
    law's peak, normal and tangential Maugis parameter (the second as of `sharpness`)."""
    return {"contact": scene.contact_threshold, "peak": law.slip_peak,
            "normal": scene.normal_maugis, "sharp": sharpness(scene)}


def site(contact, nodes):
    """Nodes of a contact as the library is asked about states there; None where it is not.

    Parameters
    ----------
    contact : Contact
    nodes : Window, or EvenWindow
    """
    law, ratio = kernel_of(contact.law), contact.scene.work_ratio
    if law is None or not contact.kernels.compiled:
        return None
    halved = nodes.even and len(nodes.shape) == 1 and nodes.size > REACH + 1
    return Site(law, contact.gap_on(nodes), getattr(nodes.grid, "weights", None),
                parts=(1.0, ratio, ratio), least=TRACTIONLESS, halved=halved,
                closed=halved and nodes.parts[0].closed[0],
                sign=tuple(sign for sign, in nodes.parities or ((1,),) * 3) if halved else (),
                **judged(contact.scene, contact.law))


def _alternating(contact, state, traction):
    """Part of its largest traction (components, nodes, each once) by which that of a state
    alternates from node to node: of any component, in any direction."""
    half, grid, found = state.half, contact.grid, 0.0
    halved = half is not None and min(half.extents) > REACH + 1
    every, fields = (half, traction) if halved else (state.window, state.unfolded(traction))
    parts, alternation = every.parts, contact.kernels.alternation
    largest = grid.largest(np.maximum(np.maximum.reduce(fields, axis=1, initial=0.0),
                                      -np.minimum.reduce(fields, axis=1, initial=0.0)))
    # beyond a window the law does not act
    parities = half.parities if halved else None
    for i, values in enumerate(fields):
        boxes = every.box(values).reshape(len(parts), *parts[0].shape)
        signs = parities[i] if parities else (int(halved),) * len(every.shape)
        for axis, (closed, sign) in enumerate(zip(parts[0].closed, signs), start=1):
            aside = (across_rows(parts[0], boxes, sign, alternation) if grid.shared and axis == 1
                     else grid.largest(alternation(boxes, axis, sign, closed)))
            found = max(found, aside / max(largest[i], TRACTIONLESS))
    return float(found)


def gaps_once(contact, state):
    """Gaps (components, nodes) of a state at its nodes, each once where others are mirror
    images."""
    found = state.once.copy()
    found[0] += contact.gap_on(state.nodes)
    return found


def gaps(contact, state):
    """Gaps (components, nodes) of a state on its window, ranges of the law.

    Parameters
    ----------
    contact : Contact
    state : State
    """
    return state.unfolded(gaps_once(contact, state))


def tractions(contact, state):
    """Tractions (components, nodes) of a state on its window, phi_i / delta_i.

    Parameters
    ----------
    contact : Contact
    state : State
    """
    found = gaps_once(contact, state)
    contact.law.evaluate(found, found)
    return state.unfolded(found)


def by_numpy(law, displacement, initial_gap, weights, contact, peak, *maugis):
    """An array of numbers: smallest normal gap, largest slip in contact, pressure and shear,
    steepest softening; nodes in contact, those that stick; sums of tractions and of their products
    with displacements by component. Beside it the tractions (components, nodes).

    Parameters
    ----------
    law : Law
    displacement : array (components, nodes)
    initial_gap, weights : arrays (nodes,); weights None where all are one
    contact, peak, maugis : as of `judged`
    """
    gap = displacement.copy()
    gap[0] += initial_gap
    traction = law.traction(gap)
    slip, shear = (np.sqrt(np.einsum("in,in->n", field[1:], field[1:]))
                   for field in (gap, traction))
    touching = gap[0] < contact
    each = np.ones(len(touching)) if weights is None else weights
    parts = np.array_split(gap, 1 + len(slip) // PART, axis=1)
    found = [np.min(gap[0], initial=np.inf), np.max(slip[touching], initial=0.0),
             np.max(-traction[0], initial=0.0), np.max(shear, initial=0.0),
             max(np.max(_steepness(law, part, maugis), initial=0.0) for part in parts),
             each @ touching, each @ (touching & ~(slip > peak))]
    return np.concatenate([found, traction @ each, (traction * displacement) @ each]), traction


def _steepness(law, gap, maugis):
    """Softening at each of some nodes, from their gaps (components, nodes), E*/beta."""
    full = law.tangent(gap)
    if len(gap) == 1:
        return -full[0, 0] * maugis[0] ** 2
    tangent = full  # where slip is to one side or the other its direction changes nothing
    if len(gap) > 2:
        tangent = np.empty((2, 2, gap.shape[1]))
        tangent[0, 0] = full[0, 0]
        slip = np.linalg.norm(gap[1:], axis=0)
        along = np.divide(gap[1:], slip, out=np.full_like(gap[1:], len(gap[1:]) ** -0.5),
                          where=slip > 0.0)
        tangent[0, 1] = np.einsum("in,in->n", full[0, 1:], along)
        tangent[1, 0] = np.einsum("in,in->n", full[1:, 0], along)
        tangent[1, 1] = np.einsum("in,ijn,jn->n", along, full[1:, 1:], along)
    return softening(tangent * np.multiply.outer(maugis, maugis)[..., None])
