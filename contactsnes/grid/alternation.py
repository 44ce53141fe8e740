"""How much values alternate from node to node: their eighth differences, which let waves of two
nodes pass as they are, and those of eight nodes or more by less than a thousandth."""

import numpy as np
import scipy

ALTERNATING = np.array([1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0]) / 256.0
REACH = len(ALTERNATING) // 2
"""Nodes on either side that a difference takes."""


def differences(boxes, axis, closed):
    """Eighth differences along an axis of boxes: an array alike.

    Parameters
    ----------
    boxes : array (boxes, *box)
    axis : int, from 1
    closed : bool, whether boxes close on themselves; else nothing is beyond their ends
    """
    return scipy.ndimage.convolve1d(boxes, ALTERNATING, axis, mode="wrap" if closed else "constant")


def across_rows(window, boxes, image, alternation):
    """As `alternation` along the first axis of boxes (boxes, rows, columns), rows of which are in
    other processes: the largest of all.

    Parameters
    ----------
    window : Slab or SlabEven
    boxes, image : as of `alternation`
    alternation : that, or the library's
    """
    before, after = window.rows.beside(boxes, REACH, REACH)
    first, count = window.rows.first, boxes.shape[1]
    if image or not window.closed[0]:
        before[:, np.arange(first - REACH, first) < 0] *= image
        after[:, np.arange(REACH) + first + count >= window.extents[0]] *= (image
                                                                            * window.closed[0])
    parts = [[before, boxes, after]]
    if count > 2 * REACH:  # rows that have all they take are not copied
        parts = [[boxes], [before, boxes[:, :2 * REACH]], [boxes[:, count - 2 * REACH:], after]]
    return float(window.grid.largest(max(alternation(np.concatenate(part, 1) if part[1:]
                                                     else boxes, 1, beyond=REACH)
                                         for part in parts)))


def alternation(boxes, axis, image=0, closed=False, beyond=0):
    """The largest eighth difference along an axis of boxes (boxes, *box), 0 or more.

    Parameters
    ----------
    boxes : array (boxes, *box)
    axis : int, from 1
    image : 0; 1 or -1 for boxes that begin in the middle of even fields, or odd ones, and are
        longer than `REACH` nodes
    closed : bool, whether boxes close on themselves, or end where there are images, too
    beyond : int, nodes at either end that are neighbours of others only, and not asked for
    """
    across = (slice(None),) * axis
    if image:
        lines = [image * boxes[(*across, slice(REACH, 0, -1))], boxes]
        if closed:
            lines.append(image * boxes[(*across, slice(-2, -2 - REACH, -1))])
        waves = differences(np.concatenate(lines, axis), axis, False)
        waves = waves[(*across, slice(REACH, REACH + boxes.shape[axis]))]
    else:
        waves = differences(boxes, axis, closed)
    waves = waves[(*across, slice(beyond, waves.shape[axis] - beyond))]
    return float(np.max(np.abs(waves), initial=0.0))
