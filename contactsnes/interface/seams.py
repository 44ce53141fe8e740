"""Steps of heights from node to node, and at the seam of their cell, where it meets its
neighbours."""

import numpy as np

from ..grid.cell import Grid

JUMP = 4.0
"""Step at the seam of a cell over those between neighbours from which on heights are told to be not
periodic."""


def rms_slope(heights, spacings, grid=None):
    """Root mean square of the gradient, by steps between neighbours.

    Parameters
    ----------
    heights : ndarray
    spacings : of the nodes, one a direction
    grid : Grid of the heights, where several processes share it out: they are what is here
    """
    steps = _steps(heights, grid)
    return float(np.sqrt(sum(np.mean(squares[1:]) / spacing ** 2
                             for squares, spacing in zip(steps, spacings))))


def _steps(heights, grid):
    """Mean squares of the steps that lead to the rows (or columns, of axis 1) of heights: an array
    for each axis, whose first number is that of the seam."""
    grid = Grid(heights.shape, (1.0,) * heights.ndim) if grid is None else grid
    before = np.concatenate([grid.row_before(heights)[None], heights[:-1]])
    across = tuple(range(1, heights.ndim))
    found = [grid.joined(np.mean((heights - before) ** 2, axis=across))]
    if heights.ndim == 2:
        aside = np.sum((heights - np.roll(heights, 1, 1)) ** 2, axis=0)
        found.append(grid.together(aside) / grid.shape[0])
    return found


def seams(heights, grid=None):
    """Where heights jump at the seam of their cell: direction, step at the seam and typical step
    between neighbours, a list.

    Steps are root mean squares: of all neighbours for the typical one, and of those across the
    seam. A jump is a seam that steps `JUMP` times as far as neighbours do, those next to it, too,
    which are steep where a steep place of the surface lies at the seam.

    Parameters
    ----------
    heights, grid : as of `rms_slope`
    """
    grid = Grid(heights.shape, (1.0,) * heights.ndim) if grid is None else grid
    height, found = grid.maximum(heights) - grid.minimum(heights), []
    for axis, squares in enumerate(_steps(heights, grid)):
        size, typical, beside = (float(np.sqrt(np.mean(part))) for part in (
            squares[0], squares[1:], [*squares[1:3], *squares[-2:]]))
        if size > JUMP * max(typical, beside) and size > 1e-9 * height:
            found.append((axis, size, typical))
    return found
