"""Shapes against their formulas, files of heights, and what is said about bad ones."""

import importlib.util
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from height_maps import read_heights

from contactsnes.interface.gap import gap_of_heights, is_convex
from contactsnes.interface.shapes import SHAPES
from contactsnes.options.fields import InputError
from contactsnes.scene.settings import Scene

PERIOD = (12.0, 10.0)


def coordinates(points, period):
    """Nodes x_i = (i - N/2) L/N, one broadcastable array a direction."""
    axes = [(np.arange(n) - n / 2) * length / n for n, length in zip(points, period)]
    return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))


def initial_gap(name, where, period, **options):
    """The gap of a shape on nodes of a cell."""
    periods = tuple(np.broadcast_to(period, (len(where),)))
    gap = SHAPES[name](**options).gap(where, SimpleNamespace(periods=periods, dimension=len(where)))
    return np.broadcast_to(gap, np.broadcast_shapes(*(x.shape for x in where)))


LINE, PLANE = coordinates((8,), PERIOD), coordinates((8, 6), PERIOD)


def test_parabolas():
    x, y = PLANE
    np.testing.assert_array_equal(initial_gap("cylinder", LINE, 12.0), LINE[0] ** 2 / 2)
    np.testing.assert_array_equal(initial_gap("cylinder", PLANE, PERIOD), x**2 / 2 + 0 * y)
    np.testing.assert_allclose(initial_gap("sphere", PLANE, PERIOD), (x**2 + y**2) / 2, rtol=1e-15)


def test_sinusoid():
    x, y = PLANE
    wave_x, wave_y = 1 - np.cos(2 * np.pi * x / 12.0), 1 - np.cos(2 * np.pi * y / 10.0)
    np.testing.assert_allclose(initial_gap("sinusoid", PLANE, PERIOD, amplitude=0.7),
                               0.7 * (wave_x + wave_y), atol=1e-15)
    expected = (12.0 / (2 * np.pi)) ** 2 * wave_x + (10.0 / (2 * np.pi)) ** 2 * wave_y
    np.testing.assert_allclose(initial_gap("sinusoid", PLANE, PERIOD), expected, atol=1e-14)


def test_sinusoid_has_the_curvature_of_the_parabola():
    near = coordinates((8, 6), (1e-3, 1e-3))
    np.testing.assert_allclose(initial_gap("sinusoid", near, 100.0),
                               initial_gap("sphere", near, 100.0), rtol=1e-9)


@pytest.mark.parametrize("name", sorted(set(SHAPES) - {"file"}))
@pytest.mark.parametrize("where, period", ((LINE, 12.0), (PLANE, PERIOD), (PLANE, 20.0)))
def test_every_shape_covers_the_grid_and_touches(name, where, period):
    options = dict(rough_slope=0.1, rough_shortest=4.0, rough_longest=10.0, rough_seed=1)
    gap = initial_gap(name, where, period, **(options if name == "rough" else {}))
    # whose lowest place lies between these few nodes
    assert gap.min() == 0.0 or name == "rough" and 0.0 < gap.min() < 0.3
    assert name in ("flat", "rough") or gap[tuple(n // 2 for n in gap.shape)] == 0.0


def test_the_highest_point_of_a_file_is_nearest():
    heights = np.array([-3.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(gap_of_heights(heights), [8, 0, 4, 5, 5, 5, 5, 5])


def test_unknown_shape():
    with pytest.raises(InputError, match="-scene_geometry is 'cone': .* cylinder, .* sphere"):
        Scene(geometry="cone")


def write(path, heights):
    """Write heights in the format of the suffix; the specification to read them."""
    if path.suffix == ".npy":
        np.save(path, heights)
    elif path.suffix == ".txt":
        np.savetxt(path, heights)
    else:
        with h5py.File(path, "w") as file:
            file["scan/heights"] = heights
        return f"{path}:scan/heights"
    return str(path)


@pytest.mark.parametrize("name", ("a.npy", "a.txt", "a.h5"))
@pytest.mark.parametrize("shape", ((8,), (8, 6)))
def test_files_return_what_was_written(tmp_path, name, shape):
    heights = np.random.default_rng(2).normal(size=shape)
    np.testing.assert_array_equal(read_heights(write(tmp_path / name, heights), shape), heights)


def test_integers_become_numbers(tmp_path):
    heights = read_heights(write(tmp_path / "a.npy", np.arange(4)), (4,))
    assert heights.dtype == float and heights[3] == 3.0


@pytest.mark.parametrize("name", ("a.npy", "a.txt", "a.h5"))
def test_bad_heights(tmp_path, name):
    specification = write(tmp_path / name, np.zeros((8, 6)))
    with pytest.raises(ValueError, match=r"-scene_geometry_file .*\(8, 6\).*\(6, 8\)"):
        read_heights(specification, (6, 8))
    for value in (np.nan, np.inf):
        specification = write(tmp_path / name, np.array([0.0, value]))
        with pytest.raises(ValueError, match="not finite"):
            read_heights(specification, (2,))


@pytest.mark.parametrize("specification", ("none.npy", "none.txt", "none.h5:heights"))
def test_missing_file(tmp_path, specification):
    with pytest.raises(FileNotFoundError, match="there is no file .*none"):
        read_heights(str(tmp_path / specification), (8,))


@pytest.mark.skipif(importlib.util.find_spec("SurfaceTopography") is not None,
                    reason="SurfaceTopography knows more kinds of files")
@pytest.mark.parametrize("specification", ("a.opd", "a", "a.tiff:heights"))
def test_unknown_suffix(tmp_path, specification):
    with pytest.raises(ValueError, match="unknown kind .* FILE.npy, .* or FILE.h5:dataset, or "
                       "install SurfaceTopography"):
        read_heights(str(tmp_path / specification), (8,))


@pytest.mark.parametrize("dataset", ("", ":", ":profile", ":scan", ":scan/profile"))
def test_missing_dataset(tmp_path, dataset):
    write(tmp_path / "a.h5", np.zeros(8))
    with pytest.raises(ValueError, match="there is no dataset .* there are: scan/heights"):
        read_heights(f"{tmp_path}/a.h5{dataset}", (8,))


@pytest.mark.parametrize("name", ("a.npy", "a.txt", "a.h5:heights"))
def test_not_such_a_file(tmp_path, name):
    (tmp_path / name.split(":")[0]).write_text("not numbers\n")
    with pytest.raises(ValueError, match="cannot be read"):
        read_heights(str(tmp_path / name), (8,))


@pytest.mark.parametrize("heights", (np.ones(4, dtype=complex), np.array(["a", "b", "c", "d"])))
def test_not_real_numbers(tmp_path, heights):
    with pytest.raises(ValueError, match="instead of real numbers"):
        read_heights(write(tmp_path / "a.npy", heights), (4,))


# Convexity, on the gap itself

FINE = coordinates((64,), (12.0,)), coordinates((48, 40), PERIOD)
CONVEX = {"parabola": lambda x, y: x ** 2 / 2, "bowl": lambda x, y: (x ** 2 + y ** 2) / 2,
          "tall": lambda x, y: x ** 4, "between nodes": lambda x, y: (x - 0.09) ** 2,
          "wedge": lambda x, y: np.abs(x) + y ** 2,
          "far away": lambda x, y: 1e6 + x ** 2}
UNEVEN = {"wave": lambda x, y: 1 - np.cos(2 * np.pi * x / 12.0),
          "two apices": lambda x, y: np.abs(np.abs(x) - 2) ** 2,
          "flat": lambda x, y: 0 * x,
          "waves on a parabola": lambda x, y: x ** 2 / 2 + 0.03 * np.cos(8 * x),
          "saddle": lambda x, y: x ** 2 - 2.0 * x * y + 0.8 * y ** 2,
          "star": lambda x, y: (x ** 2 + y ** 2) / 2 + x ** 2 * y ** 2}


@pytest.mark.parametrize("name", [*CONVEX, *UNEVEN])
@pytest.mark.parametrize("directions, shift", ((1, 0), (1, 23), (2, 0), (2, (-11, 17))))
def test_convexity_is_a_property_of_the_gap_wherever_its_apex_lies(name, directions, shift):
    x, y = FINE[1] if directions == 2 else (FINE[0][0], 0.0)
    shape = np.broadcast_shapes(np.shape(x), np.shape(y))
    gap = np.broadcast_to({**CONVEX, **UNEVEN}[name](x, y), shape)
    expected = name in CONVEX or (name in ("saddle", "star") and directions == 1)
    assert is_convex(np.roll(gap, shift, tuple(range(directions)))) == expected
    if expected:
        dented = gap.copy()
        dented[tuple(n // 4 for n in gap.shape)] -= 10.0
        assert not is_convex(dented)
