"""Whether a gap that is known in rows is convex."""

import numpy as np


def convex_in_rows(grid, gap):
    """Whether a gap over a plane's cell is convex within it, to rounding, and not the same
    everywhere, as `interface.gap.is_convex` asks: second differences along each direction and the
    determinant of the Hessian are not negative, but half a cell away from the summit.

    Parameters
    ----------
    grid : slabs.Slabs
    gap : array (rows of this process, columns)
    """
    largest, lowest = grid.maximum(gap), grid.minimum(gap)
    rounding = 8.0 * np.finfo(float).eps * max(abs(largest), abs(lowest))
    if largest - lowest <= rounding:
        return False
    summit = grid.highest(-gap)
    centred = np.roll(gap, grid.shape[1] // 2 - summit[1], axis=1)
    wide = grid.with_rows(centred, 1)
    # nodes away from the border of a cell about the summit, one or two of them
    row = (grid.rows.numbers + grid.shape[0] // 2 - summit[0]) % grid.shape[0]
    inner, deeper = ((row >= reach) & (row < grid.shape[0] - reach) for reach in (1, 2))
    along = (wide[2:] - 2.0 * wide[1:-1] + wide[:-2])[deeper, 1:-1]
    across = np.diff(centred, 2, axis=1)[inner, 1:-1]
    if grid.minimum(along) < -rounding or grid.minimum(across) < -rounding:
        return False
    across = np.diff(centred, 2, axis=1)[deeper, 1:-1]
    twist = (wide[2:, 2:] - wide[2:, :-2] - wide[:-2, 2:] + wide[:-2, :-2])[deeper, 1:-1] / 4
    steepest = max(grid.maximum(along), grid.maximum(across))
    return grid.minimum(along[:, 1:-1] * across - twist ** 2) >= -rounding * steepest
