"""Orthonormal vectors and their images, parts of which may be in several processes: a vector more,
whose sums over processes are made in one exchange with those of others."""

import math

import numpy as np


def together(grid, parts):
    """Sums of parts in all processes; without a grid there is one."""
    return parts if grid is None else grid.together(parts)


def lengths(rows, grid=None):
    """Euclidean length of vectors (..., size), parts of which may be in other processes of a
    grid."""
    if grid is None:
        return (np.linalg.norm(rows, axis=-1) if rows.ndim > 1
                else math.sqrt(np.vdot(rows, rows).real))
    return np.sqrt(grid.together(np.sum(np.square(np.abs(rows)), axis=-1)))


def holding(held, count, pair, least):
    """Append a vector, made orthonormal to others, with its image; whether it was new. A generator,
    as of `in_step`.

    Images are kept as such, not as sums of the products they come from: where vectors are nearly
    dependent, such sums cancel.

    Parameters
    ----------
    held : (rows, products, errors), overwritten: array (2, room, size), whose first ``count`` rows
        are orthonormal vectors and their images; array (room, room), products of the first with the
        second; array (room,), how large what rounding left of the images may be
    count : int
    pair : (vector, image)
    least : length of what is left of a vector that is not new
    """
    rows, products, errors = held
    (basis, images), (vector, image) = rows[:, :count], pair
    *parts, square = yield np.append(basis @ vector, vector @ vector)
    norm, taken = math.sqrt(square), np.zeros(count)
    astray = norm ** 2 * np.finfo(float).eps ** 2
    # Twice is enough (Giraud et al. 2005, Numer. Math. 101, 87), once where much is left.
    for again in range(2):
        if not norm > least:
            return False
        before, parts = norm, (yield basis @ vector) if again else np.array(parts)
        vector, taken = vector - parts @ basis, taken + parts
        astray += np.sum((parts * errors[:count]) ** 2)
        norm = math.sqrt((yield vector @ vector))
        if norm > 0.5 * before:
            break
    if not norm > least:
        return False
    basis, images = rows[:, :count + 1]
    basis[-1], images[-1] = vector / norm, (image - taken @ images[:-1]) / norm
    errors[count] = math.sqrt(astray) / norm
    yield from multiplying(held, count + 1)
    return True


def multiplying(held, count):
    """Multiply the last of some vectors with the images of all, and its image with these. A
    generator, as of `in_step`.

    Parameters
    ----------
    held, count : as of `holding`
    """
    (basis, images), products = held[0][:, :count], held[1]
    products[:count, count - 1], products[count - 1, :count] = yield np.array(
        [basis @ images[-1], images @ basis[-1]])


def in_step(acts, grid=None):
    """What generators return, a list. They go on side by side: of what they yield, each gets back
    the sums over processes, those of all in one exchange.

    Parameters
    ----------
    acts : list of generators of arrays
    grid : Grid that sums over processes, where vectors are shared out among some
    """
    found, asked = [None] * len(acts), {number: next(act) for number, act in enumerate(acts)}
    while asked:
        sums = together(grid, np.concatenate([np.ravel(parts) for parts in asked.values()]))
        ends = np.cumsum([np.size(parts) for parts in asked.values()])[:-1]
        answers = dict(zip(asked, np.split(sums, ends)))
        for number, parts in list(asked.items()):
            try:
                asked[number] = acts[number].send(answers[number].reshape(np.shape(parts)))
            except StopIteration as ended:
                found[number] = ended.value
                del asked[number]
    return found
