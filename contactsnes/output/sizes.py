"""What the file of an archive takes, about: what `store` and `layout` make room for, and what HDF5
adds to it. Constants are measured."""

import math

from .active import ROOM
from .cell_fields import CHUNKS
from .files import SAFE
from .journal import BATCH, MOST
from .store import ROOMY
from .stored import SLOTS, STATES

COLUMN, ROW, HEADER = 3080, 7.6, 6000
"""Bytes that a column takes besides its numbers, of a number of a row, as enumerations are small,
and of a file besides."""
COLUMNS, ESTIMATES = {1: 51, 2: 55}, 5
"""Columns by the dimension, and those more of estimated errors."""
NAMES, FIRST = 1270, 1024
"""Bytes of a state besides its displacement, and of what is made room for at the start."""
QUICK = 1 << 14
"""Nodes of planes up to which points come so fast that as many as may are written together."""
PACKED, MODES = 0.55, {1: 1.0, 2: 0.2}
"""Bytes of states in a compressed file over those before, and of modes by the dimension."""
COMPLIANCE = 1.0
"""The same of the body's compliance, in pieces."""
GRID, ACTIVE = 12e3, 33e3
"""Bytes of datasets of fields besides their numbers, and of those on active nodes."""


def archive(scene, output, nodes, points, state, active=0.0, packed=0.0, modes=False):
    """Bytes of the file of a path that is done.

    Parameters
    ----------
    scene : Scene
    output : Output, which says what is kept
    nodes : int, of the grid
    points : int, of the path
    state : float, numbers of a point's displacement on its window
    active : float, nodes that the law acts on
    packed : float, bytes of all fields that are compressed, once they are; 0 where none are
    modes : bool, whether points have one
    """
    chunk = _chunk(scene, output, nodes, points, bool(packed))
    columns = COLUMNS[scene.dimension] + (ESTIMATES if output.errors else 0)
    rows = columns * (COLUMN + ROW / 8.0 * _aligned(8.0 * CHUNKS * chunk))
    found = HEADER + rows + _states(scene, output, nodes, state, bool(packed))
    if output.fields == "none":
        return found
    return (found + GRID + 8.0 * window_of(scene, nodes)
            + _fields(scene, output, nodes, points, chunk, active, packed)
            + (_modes(scene, output, nodes, points, chunk, bool(packed)) if modes else 0.0))


def waiting(pace, each):
    """Bytes of points that wait for being written.

    Parameters
    ----------
    pace : float, points a second
    each : float, bytes of one
    """
    return min(MOST, min(BATCH, pace) * each)


def _modes(scene, output, nodes, points, chunk, packed):
    """Bytes of the leading modes of points, which are kept on all nodes."""
    each = (4.0 if output.precision == "single" else 8.0) * window_of(scene, nodes)
    kept = chunk * math.ceil(points / chunk) if output.fields == "all" else 1
    return each * scene.components * (MODES[scene.dimension] * points if packed else kept)


def window_of(scene, nodes):
    """Nodes that fields have: of an isolated scene half in each direction of those that are
    solved on."""
    return nodes // 2 ** scene.dimension if scene.isolated else nodes


def _aligned(taken):
    """Bytes that a piece takes on pages of its own, if it is not small, with what is left between
    it and the one before."""
    page = SAFE["alignment_interval"]
    return taken if taken < SAFE["alignment_threshold"] else page * (math.ceil(taken / page) + 0.5)


def _chunk(scene, output, nodes, points, packed):
    """Points whose fields are allocated at once, and rows of 64 times as many: the file is written
    anew where room is lacking."""
    times = 4 if output.fields == "all" else 2
    if packed:
        return max(1, math.ceil(times * points / CHUNKS))
    # quick points come together; on lines there is room for these from the start
    quick = scene.dimension == 1 and output.fields != "all"
    together = BATCH if scene.dimension == 1 or nodes < QUICK else 1
    written = BATCH if quick else min(points, together)
    chunk = max(1, math.ceil(times * written / CHUNKS))
    while chunk * CHUNKS < points:
        chunk = math.ceil(times * min(points, chunk * CHUNKS + together) / CHUNKS)
    return chunk


def _states(scene, output, nodes, state, packed):
    """Bytes of the states that a run goes on from."""
    taken = NAMES + 8.0 * state
    if packed:
        return STATES * PACKED * taken
    if scene.dimension == 1 and output.fields != "all":
        first = _roomy(FIRST + scene.components * nodes)
        if taken < first:
            return SLOTS * first
    return SLOTS * _roomy(taken)


def _roomy(taken):
    """Bytes that there is room for where a state takes some."""
    return max(1.5 * taken, min(4.0 * taken, ROOMY))


def _fields(scene, output, nodes, points, chunk, active, packed):
    """Bytes of fields and of what they are rebuilt with."""
    every, size = output.fields == "all", 4 if output.precision == "single" else 8
    if not output.on_active(scene):
        kept = chunk * math.ceil(points / chunk) if every else 1
        return packed or 2.0 * size * window_of(scene, nodes) * scene.components * kept
    blocks = scene.components ** 2 if scene.coupled else 1 + scene.dimension ** 2
    rebuilt = COMPLIANCE * 4.0 * nodes * blocks
    kept = active * (points if every else 1)
    each = max(ROOM, math.ceil(2.0 * kept / CHUNKS))
    chunks = math.ceil(kept / each)
    if every:
        return ACTIVE + rebuilt + packed + 1.5 * SAFE["alignment_interval"] * chunks
    return ACTIVE + rebuilt + each * chunks * (8.0 + 2.0 * size * scene.components)
