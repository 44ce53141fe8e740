"""Shapes of one's own: plain functions of the coordinates, and what a shape claims, looked at on
the nodes."""

import inspect
from functools import lru_cache

import numpy as np

from ..grid.cell import Grid
from ..options.fields import InputError
from . import own_methods
from .gap import at, by_rows, curvatures, initial_gap, is_convex, without_mask
from .seams import rms_slope, seams
from .shapes import SHAPES, of
from .shapes.shape import NEAR, Shape

ROUNDING = 1e-10
"""Difference of mirror images, and depth below a parabola, over the largest gap, up to which a
claim holds."""

SHARPER = 1.05
"""Curvature on the nodes over the one that is claimed, up to which the claim holds."""


class Plain(Shape):
    """A function gap(x), in two dimensions gap(x, y), of arrays over the nodes: in beta and u_n,r,
    in scenes in SI in metres."""

    uses_radius = False

    def __init__(self, function):
        self.function = function
        super().__post_init__()

    def __repr__(self):
        return getattr(self.function, "__qualname__", None) or repr(self.function)

    def gap(self, coordinates, scene):
        """What the function makes of the coordinates."""
        _check_arguments(self.function, len(coordinates))
        length = scene.scale("beta")[0]
        # whole arrays of its own: what a function writes into them stays there
        places = [length * x for x in np.broadcast_arrays(*coordinates)]
        return without_mask(self.function(*places)) / scene.scale("u_n,r")[0]


def _check_arguments(function, count):
    """TypeError, in words, for a function that does not take one array a direction."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # of a function of C nothing is known
        return
    try:
        signature.bind(*range(count))
    except TypeError:
        given = " and ".join("xy"[:count])
        raise TypeError(f"it takes {signature}, but is given {given}: on a line it is gap(x), on a "
                        "plane gap(x, y)") from None


@lru_cache(maxsize=256)
def plain(function):
    """The shape of a function; the same for the same function."""
    return Plain(function)


def check(shape, gap, grid, scene):
    """InputError where a shape claims what its gap on the nodes is not; a sentence names the place.

    Parameters
    ----------
    shape : Shape
    gap : array over the nodes of the grid that are here, u_n,r
    grid : Grid
    scene : Scene
    """
    named = f"{scene.option_name('geometry')} is '{scene.geometry}'"
    size = max(grid.maximum(gap) - grid.minimum(gap), np.finfo(float).tiny)
    for axis in shape.even:
        if axis < gap.ndim:
            image = grid.mirrored(gap, axis)
            _refuse(f"{named}, which claims to be even along {'xy'[axis]} (even = {shape.even})",
                    np.abs(gap - image) > ROUNDING * size, (gap, image),
                    "the gap is {:.9g} {unit}, and {:.9g} {unit} at its mirror image", grid, scene)
    for axis in shape.uniform:
        if axis < gap.ndim:
            first = gap[:, :1] if axis else grid.of_first(gap[:1])
            first = np.broadcast_to(first, gap.shape)
            _refuse(f"{named}, which claims to be uniform along {'xy'[axis]}",
                    np.abs(gap - first) > ROUNDING * size, (gap, first),
                    "the gap is {:.9g} {unit}, and {:.9g} {unit} elsewhere along it", grid, scene)
    if shape.convex and not is_convex(gap, grid):
        raise InputError(f"{named}, which claims to be convex (convex = True), but its second "
                         "differences on the nodes are not all positive: leave the claim out")
    _check_parabola(shape, gap, grid, scene, named)
    _check_curvature(shape, gap, grid, scene, named)


def check_declared(shape, scene):
    """InputError where what a shape of one's own declares is not of the kind that is asked for."""
    if type(shape) in SHAPES.values():
        return
    named = f"{scene.option_name('geometry')} is '{scene.geometry}'"
    for name in ("even", "uniform"):
        if not isinstance(axes := getattr(shape, name), (tuple, list)) or set(axes) - {0, 1}:
            raise InputError(f"{named}, which declares {name} = {axes!r}: allowed is a tuple of "
                             "directions, (), (0,), (1,) or (0, 1)")
    own_methods.check_returned(shape, named, scene)
    if shape.by_rows and type(shape).rows is Shape.rows:
        raise InputError(f"{named}, which declares by_rows, but has no rows(grid, scene): write "
                         "it, or leave by_rows out")
    if not isinstance(shape.parabola, dict):
        raise InputError(f"{named}, which declares parabola = {shape.parabola!r}: allowed is a "
                         "dictionary from the dimension to the curvature, as {1: 1.0}")
    if type(shape).curvature is not Shape.curvature:
        try:
            claimed = shape.curvature(scene)
        except (Exception, SystemExit) as error:
            raise InputError(f"{named}: its curvature cannot be had ({type(error).__name__}: "
                             f"{error}); mend it, or leave curvature out") from error
        if not isinstance(claimed, (tuple, list)) or len(claimed) != scene.dimension:
            raise InputError(f"{named}, whose curvature(scene) is {claimed!r}: allowed is a tuple "
                             "of one number for each direction")


def _check_parabola(shape, gap, grid, scene, named):
    """InputError where a gap lies below the parabola that it claims to lie above."""
    if scene.dimension in shape.parabola:
        curvature = shape.parabola[scene.dimension]
        below = np.broadcast_to(curvature / 2 * sum(x ** 2 for x in grid.coordinates()), gap.shape)
        _refuse(f"{named}, which claims to lie above a parabola (parabola = {shape.parabola})",
                gap < below - ROUNDING * grid.maximum(below), (gap, below),
                "the gap is {:.9g} {unit}, the parabola {:.9g} {unit}", grid, scene)


def _check_curvature(shape, gap, grid, scene, named):
    """InputError where a gap is more curved than its shape says, near its lowest place."""
    if type(shape).curvature is Shape.curvature:
        return
    found = curvatures(gap, grid, NEAR / scene.normal_maugis)
    for axis, (claimed, seen) in enumerate(zip(shape.curvature(scene), found)):
        if not seen <= SHARPER * claimed:
            raise InputError(f"{named}, which claims a curvature of at most {claimed:.6g} "
                             f"u_n,r/beta^2 along {'xy'[axis]} (curvature), but differences on the "
                             f"nodes give {seen:.6g} where the law acts: mend it, or leave "
                             "curvature out")


def _refuse(claim, wrong, values, words, grid, scene):
    """InputError that tells of the first node where a claim does not hold."""
    if found := _first(wrong, values, grid):
        place, values = found
        size, unit = scene.scale("u_n,r")
        told = words.format(*(size * value for value in values), unit=unit)
        raise InputError(f"{claim}: at {at(place, scene)} {told}; mend the gap, or leave the claim "
                         "out")


def _first(wrong, values, grid):
    """(coordinates, values) of the first node of a mask, whichever process has it; None where it
    holds nowhere.

    Parameters
    ----------
    wrong : array of bool over the nodes of the grid that are here
    values : tuple of arrays over them
    grid : Grid
    """
    here = np.nonzero(wrong)
    first = [np.broadcast_to(x, wrong.shape)[here][:1] for x in (*grid.coordinates(), *values)]
    found = grid.joined(np.column_stack(first))
    return (found[0, :wrong.ndim], found[0, wrong.ndim:]) if len(found) else None


def gap_on(shape, grid, scene):
    """Initial gap of a scene, u_n,r, a new array, at the nodes of its grid that are here;
    InputError where a shape of one's own is not what it claims.

    What a shape of one's own does with its coordinates is not known, so that all are given to it at
    once, unless it says that places do not hang on each other (`by_nodes`): by the first of several
    processes, which then sends the others their rows.

    Parameters
    ----------
    shape : Shape
    grid : Grid
    scene : Scene
    """
    if shape.by_rows:
        return by_rows(shape, grid, scene) + scene.gap_offset

    def found(grid):
        gap = initial_gap(shape, grid.coordinates(), scene)
        if type(shape) not in SHAPES.values():
            _check_again(shape, gap, grid, scene)
            check(shape, gap, grid, scene)
        return gap

    if shape.by_nodes:
        return found(grid)
    return grid.spread(lambda: found(Grid(grid.shape, grid.periods)))


def _check_again(shape, gap, grid, scene):
    """InputError where a shape has another gap when it is asked again: seams and proportions, runs
    that are resumed and other processes would be of other surfaces.

    Parameters
    ----------
    shape, gap, grid, scene : as of `check`
    """
    again = initial_gap(shape, grid.coordinates(), scene)
    wrong = np.abs(again - gap) > ROUNDING * grid.maximum(np.abs(gap))
    if found := _first(wrong, (gap, again), grid):
        first, second = (scene.short(float(value), "u_n,r", 6) for value in found[1])
        raise InputError(f"{scene.option_name('geometry')} is '{scene.geometry}': the gap at "
                         f"{at(found[0], scene)} is {first}, and {second} when it is asked again: "
                         "it has to be the same each time; give what is random a seed")


def jumps(scene, grid=None):
    """Where the heights of a scene, or the gap of a shape of one's own, jump at the seam of its
    cell (`seams.seams`), u_n,r; empty for other scenes. Of what several processes share out, the
    grid is given."""
    shape = of(scene)
    if scene.isolated or (type(shape) in SHAPES.values() and not shape.gridded):
        return []
    return seams(gap_on(shape, _or_whole(scene, grid), scene), grid)


def proportions(scene, grid=None):
    """Root mean square slope, u_n,r/beta, and height from lowest to highest, u_n,r, of a scene's
    gap; the grid as of `jumps`."""
    grid = _or_whole(scene, grid)
    gap = gap_on(of(scene), grid, scene)
    return rms_slope(gap, scene.spacings, grid), grid.maximum(gap) - grid.minimum(gap)


def _or_whole(scene, grid):
    """A grid, or one of the scene's whole cell."""
    return Grid(scene.shape, scene.periods) if grid is None else grid
