"""Fields of a window at the nodes of another one: the same nodes, or the nearest ones."""

import weakref

import numpy as np
import scipy

from .active import Nodes
from .slab_nodes import SlabNodes


def nearest(field, source, window):
    """Values of a field at the nodes of a window, where it is not known those of the nearest known
    node, array (components, nodes of the window).

    Parameters
    ----------
    field : array (components, nodes of the source)
    source, window : Window, Spots or Nodes
    """
    if window.grid.shared:
        return _among_processes(field, source, window)
    if len(source.parts) == len(window.parts) == 1 and not (source.picked or window.picked):
        return _in_box(field, source, window)
    if source.size == 0:
        return np.zeros((len(field), window.size), dtype=field.dtype)
    return field.take(_numbers(source, window), axis=-1)


_known = weakref.WeakKeyDictionary()


def _numbers(source, window):
    """For each node of a window the number of the same one, or the nearest, among those of another:
    found once for as long as there are both, since steps go back and forth between few."""
    found = _known.setdefault(source, weakref.WeakKeyDictionary())
    if window not in found:
        found[window] = _find_numbers(source, window)
    return found[window]


def _find_numbers(source, window):
    """What `_numbers` keeps, array (nodes of the window) of int32."""
    if source.picked and window.picked:
        return _numbers_among(source, window)
    numbers = np.arange(source.size, dtype=np.int32)[None]
    if source.picked:
        numbers, source = source.filled(numbers), source.hull
    hull = window.hull if window.picked else window
    found = np.concatenate([_in_box(numbers, source, part)[0] for part in hull.parts])
    return found[window.places] if window.picked else found


def _among_processes(field, source, window):
    """`nearest` where processes share out the nodes.

    Parameters
    ----------
    field, source, window : as of `nearest`
    """
    if isinstance(window, Nodes):
        if isinstance(source, SlabNodes):
            return source.nearest(field, window)
        return _among_processes(field, source, window.hull).take(window.places, axis=-1)
    if isinstance(source, Nodes):
        field, source = source.filled(field), source.hull
    return _in_rows(field, source, window)


def _in_rows(field, source, box):
    """`nearest` from one box to another, of both of which some rows are here; neither wraps around
    the cell's border.

    Parameters
    ----------
    field, source, box : array (components, nodes), Slab and Slab
    """
    rows, columns = (np.clip(first + np.arange(count) - origin, 0, known - 1)
                     for first, count, origin, known in zip(box.start, box.shape, source.origin,
                                                            source.extents))
    found = source.rows.at(source.box(field), rows)
    # (to pick all columns takes many times as long as to leave them)
    return (found if len(columns) == found.shape[-1] == columns[-1] + 1
            else found[..., columns]).reshape(len(field), -1)


def _numbers_among(source, window):
    """For each of some nodes the number of the same one, or the nearest, among others."""
    places = np.full(source.grid.size, -1, dtype=np.int32)
    places[source.numbers] = np.arange(source.size, dtype=np.int32)
    found = places[window.numbers]
    missing = np.flatnonzero(found < 0)
    if missing.size:
        # (the nearest one has a neighbour that is none of them)
        shape, rim = source.grid.shape, np.flatnonzero(source.rim())
        tree = scipy.spatial.cKDTree(np.transpose(source.indices)[rim], boxsize=shape)
        found[missing] = rim[tree.query(np.transpose(np.unravel_index(window.numbers[missing],
                                                                      shape)))[1]]
    return found


def _in_box(field, source, box):
    """Values of a field at the nodes of a box, where it is not known those of the nearest known
    node, array (components, nodes of the box).

    Parameters
    ----------
    field : array (components, nodes of the window)
    source : Window of one box or several
    box : Window of one box
    """
    found = None
    least = np.inf
    fields = field.reshape(len(field), len(source.parts), *source.shape)
    gaps = _gaps(source, box)
    for k in np.argsort(gaps, kind="stable"):
        if found is not None and gaps[k] ** 2 >= np.max(least):
            break
        axes, away = _nodes_of(source.parts[k], box)
        picked = fields[:, k]
        for axis, nodes in enumerate(axes, start=1):
            picked = picked[(slice(None),) * axis + (nodes,)]
        far = sum(np.meshgrid(*[distance ** 2 for distance in away], indexing="ij",
                              sparse=True)) if len(gaps) > 1 else 0.0
        found = picked if found is None else np.where(far < least, picked, found)
        least = np.minimum(far, least)
    return np.ascontiguousarray(found).reshape(len(found), -1)


def _gaps(source, box):
    """Nodes between each box of a window and another, at least."""
    if len(source.parts) == 1:
        return np.zeros(1)
    total, shape = np.array(box.grid.shape), np.array(source.shape)
    ahead = (np.array(box.start) - np.array(source.start)) % total
    between = np.maximum(np.minimum(ahead - shape, total - ahead - box.shape), 0)
    return np.sqrt(np.sum(between.astype(float) ** 2, axis=1))


def _nodes_of(source, box):
    """What picks the nodes of a box, or the nearest ones, from another box in each direction, and
    their distances from those."""
    axes, away = [], []
    for start, extent, first, known, total in zip(box.start, box.shape, source.start, source.shape,
                                                  box.grid.shape):
        # Signed distance from the middle of what is known, so that nodes on either side find their
        # own end of it.
        offset = (start - first - known // 2 + total // 2) % total - total // 2 + known // 2
        inside = 0 <= offset and offset + extent <= known
        wanted = (offset + np.arange(extent) - known // 2
                  + total // 2) % total - total // 2 + known // 2
        nodes = np.clip(wanted, 0, known - 1)
        axes.append(slice(offset, offset + extent) if inside else nodes)
        away.append(wanted - nodes)
    return axes, away
