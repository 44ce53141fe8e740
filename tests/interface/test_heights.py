"""Measured surfaces: files as instruments and spreadsheets write them, holes, edges, fitting, sizes
and units."""

import importlib.util
import pickle
from pathlib import Path

import numpy as np
import petsc4py
import pytest
from height_maps import read_heights
from scipy.io import savemat

petsc4py.init([])

from contactsnes.commands import cautions  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.interface import height_files, heights, seams, shapes  # noqa: E402
from contactsnes.interface.roughness import surface  # noqa: E402
from contactsnes.interface.stored_heights import Stored  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.settings import Scene  # noqa: E402

RANDOM = np.random.default_rng(4)
MAP = RANDOM.normal(size=(24, 18))
SI = {"units": "si", "geometry": "file", "work_of_adhesion_normal": 0.03,
      "work_of_adhesion_tangential": 0.03, "contact_modulus": 2e6, "range_normal": 1e-7,
      "range_tangential": 1e-7}


def text(values, separator=" ", comma=False, empty="nan"):
    """Rows of numbers in text; holes as ``empty``."""
    rows = [separator.join(empty if np.isnan(value) else repr(float(value)) for value in row)
            for row in values]
    return "\n".join(row.replace(".", ",") if comma else row for row in rows) + "\n"


@pytest.mark.parametrize("name, content", [
    ("a.txt", text(MAP)), ("a.csv", text(MAP, ",")), ("a.csv", text(MAP, ";", comma=True)),
    ("a.dat", text(MAP, "\t")), ("a.asc", "Width = 3 um\nHeight, in nm\n\n" + text(MAP)),
    ("a.csv", "\ufeffnm;of;a;surface\r\n" + text(MAP, ";").replace("\n", "\r\n")),
    ("A.TXT", "# x\n" + text(MAP) + "\n# end\n")])
def test_tables_are_read(tmp_path, name, content):
    (tmp_path / name).write_text(content, encoding="utf-8", newline="")
    np.testing.assert_array_equal(read_heights(tmp_path / name), MAP)


@pytest.mark.parametrize("kind", ["i4", "u1", "f4", ">f8"])
def test_heights_given_as_an_array_are_numbers_of_any_kind(kind):
    counts = (10.0 * np.abs(MAP)).astype("u1")
    contact = Contact(Scene(dimension=2, points=MAP.shape, period=9.0), counts.astype(kind))
    gap = (counts.max() - counts.astype(float)) * contact.ranges[0]
    np.testing.assert_allclose(contact.initial_gap, gap)


def test_empty_cells_are_holes(tmp_path):
    values = MAP.copy()
    values[3, 4] = values[5, 0] = np.nan
    (tmp_path / "a.csv").write_text(text(values, ",", empty=""))
    np.testing.assert_array_equal(height_files.read(tmp_path / "a.csv").values, values)
    with pytest.raises(ValueError, match="2 of 432 heights are missing; .*-scene_heights_fill"):
        read_heights(tmp_path / "a.csv")


def test_a_separator_at_the_end_of_every_row_is_no_column(tmp_path):
    for separator in ",;\t":
        (tmp_path / "a.csv").write_text(text(MAP, separator).replace("\n", f"{separator}\n"))
        np.testing.assert_array_equal(read_heights(tmp_path / "a.csv"), MAP)


def test_words_where_heights_are_missing_make_no_heading_of_a_row(tmp_path):
    """A map of which the first rows have holes has these rows, as it has others."""
    values = MAP.copy()
    values[:2, 3] = values[7, 5] = np.nan
    (tmp_path / "a.txt").write_text("24 rows of 18\n" + text(values, empty="BAD"))
    np.testing.assert_array_equal(height_files.read(tmp_path / "a.txt").values, values)
    (tmp_path / "a.xyz").write_text("64 64 points\n" + text(np.array([
        [x, y, x + y] for x in range(4) for y in range(3)])))
    assert height_files.read(tmp_path / "a.xyz").values.shape == (4, 3)


def test_what_spreadsheets_write_for_no_number_begins_no_comment(tmp_path):
    """Excel's #N/A and the 1.#QNAN of Windows are holes, also at the end of a row, where what is
    before them would be a height."""
    values = MAP.copy()
    values[3, 4] = values[5, -1] = values[6, 0] = np.nan
    for word in ("1.#QNAN", "-1.#IND00", "1.#INF", "#N/A", "#NV", "#DIV/0!"):
        for separator in (",", "\t", " "):
            content = "#HEIGHTS of #1\n" + text(values, separator, empty=word)
            (tmp_path / "a.txt").write_text(content)
            np.testing.assert_array_equal(height_files.read(tmp_path / "a.txt").values, values)


def test_a_heading_that_tells_what_stands_for_no_height_is_heeded(tmp_path):
    values = MAP.copy()
    values[3, 4] = values[5, 0] = np.nan
    for heading in ("ncols 18\nnrows 24\nNODATA_value -9999\n", "# nodata = -9999.0\n"):
        (tmp_path / "a.asc").write_text(heading + text(values, empty="-9999"))
        np.testing.assert_array_equal(height_files.read(tmp_path / "a.asc").values, values)


def test_text_of_two_bytes_a_letter_is_read(tmp_path):
    """As spreadsheets and shells of Windows write it."""
    for name in ("utf-16-le", "utf-16-be"):
        (tmp_path / "a.txt").write_bytes(("\ufeffHöhe\n" + text(MAP, "\t")).encode(name))
        np.testing.assert_array_equal(read_heights(tmp_path / "a.txt"), MAP)


def test_places_beside_the_heights_are_none_of_them(tmp_path):
    """A column of numbers of rows, as pandas writes it, a row of places above the map, or both."""
    rows, columns = np.arange(24.0)[:, None], 0.1 * np.arange(18.0).round(3)[None]
    both = np.block([[np.full((1, 1), np.nan), columns], [rows, MAP]])
    for table, which in ((np.hstack([rows, MAP]), "column"), (np.vstack([columns, MAP]), "row"),
                         (both, "column")):
        (tmp_path / "a.csv").write_text(text(table, ",", empty=""))
        with pytest.raises(ValueError, match=f"its first {which} seems to be places"):
            height_files.read(tmp_path / "a.csv")
    tilted = MAP / 1e4 + rows + columns
    for values in (tilted, np.broadcast_to(rows, MAP.shape), np.zeros((24, 18)), MAP[:, :1] * 0):
        (tmp_path / "a.csv").write_text(text(values, ","))
        assert height_files.read(tmp_path / "a.csv").values.size == values.size


@pytest.mark.parametrize("sign", [";", "\t"])
def test_decimal_commas_stand_where_something_else_separates(tmp_path, sign):
    """Rows without a fraction before them are rows as well, and no number becomes a hole."""
    values = MAP.round(3)
    values[0] = 1.0
    rows = [sign.join(f"{value:g}".replace(".", ",") for value in row) for row in values]
    (tmp_path / "a.txt").write_text("Höhen\n" + "\n".join(rows))
    np.testing.assert_array_equal(height_files.read(tmp_path / "a.txt").values, values)


def test_a_minus_sign_is_one(tmp_path):
    """Numbers that some languages write with U+2212 were holes."""
    (tmp_path / "map.csv").write_text("\N{MINUS SIGN}1,5;2\n3;\N{MINUS SIGN}4,25\n",
                                      encoding="utf-8")
    assert np.array_equal(height_files.read(tmp_path / "map.csv").values, [[-1.5, 2], [3, -4.25]])


def test_attributes_of_a_dataset_tell_what_its_numbers_stand_for(tmp_path):
    """netCDF's conventions: -9999 was a height, and whole numbers were heights as they are."""
    h5py = pytest.importorskip("h5py")
    packed = np.array([[1, -9999, 3], [4, 5, -1]], ">i2")
    with h5py.File(tmp_path / "map.h5", "w") as file:
        file["z"] = packed
        file["z"].attrs.update({"_FillValue": np.array([-9999], ">i2"), "missing_value": -1,
                                "scale_factor": 0.5, "add_offset": 10.0})
        file["plain"] = np.float32(packed)
        file["plain"].attrs["_FillValue"] = np.float32("nan")
    found = height_files.read(f"{tmp_path}/map.h5:z").values
    assert np.array_equal(found, [[10.5, np.nan, 11.5], [12, 12.5, np.nan]], equal_nan=True)
    assert isinstance(height_files.read(f"{tmp_path}/map.h5:plain").values, Stored)


@pytest.mark.parametrize("told, unit", [
    ("mm", "mm"), (b"nm", "nm"), (np.array(["um"], "S2"), "um"), ("micrometers", "um"),
    ("metre", "m"), ("millimeter", "mm"), ("counts", None), ("1", None), (3.0, None), ([], None)])
def test_a_dataset_tells_its_unit(tmp_path, told, unit):
    """netCDF's attribute: heights in millimetres were taken for such in metres."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "map.h5", "w") as file:
        file["z"] = MAP
        file["z"].attrs["units"] = told
    found = height_files.read(f"{tmp_path}/map.h5:z")
    assert found.unit == unit and isinstance(found.values, Stored)
    typed = {**SI, "geometry_file": f"{tmp_path}/map.h5:z", "heights_size": 1.0}
    if unit:
        contact = Contact(Scene.typed(**typed))
        size = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}[unit]
        assert np.ptp(contact.initial_gap) * 1e-7 == pytest.approx(np.ptp(MAP) * size)
        with pytest.raises(InputError, match=f"but the file says {unit}"):
            Scene.typed(**typed, heights_unit="pm")


def test_several_arrays_under_the_name_of_one_are_refused(tmp_path):
    with open(tmp_path / "map.npy", "wb") as file:
        np.savez(file, z=np.zeros((4, 4)))
    with pytest.raises(ValueError, match=r"it holds arrays by name \(z\): save one of them"):
        height_files.read(tmp_path / "map.npy")


def test_two_heights_at_one_place_are_refused(tmp_path):
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    points = np.array([x.ravel(), y.ravel(), x.ravel() + 10 * y.ravel()]).T
    np.savetxt(tmp_path / "a.xyz", np.concatenate([points, points[:2]]))
    np.testing.assert_array_equal(height_files.read(tmp_path / "a.xyz").values, x + 10 * y)
    np.savetxt(tmp_path / "a.xyz", np.concatenate([points, points[4:6] + [0, 0, 0.5]]))
    with pytest.raises(ValueError, match="two heights at 1, 1, 11 and 11.5, and at 1 more places"):
        height_files.read(tmp_path / "a.xyz")


def test_points_of_a_grid_come_in_any_order(tmp_path):
    x, y = np.meshgrid(2.0 + 0.5 * np.arange(24), -1.0 + 0.25 * np.arange(18), indexing="ij")
    points = np.array([x.ravel(), y.ravel(), MAP.ravel()]).T
    hole, kept = 7, np.arange(432) != 7
    np.savetxt(tmp_path / "a.xyz", RANDOM.permutation(points[kept]), header="x y z")
    found = height_files.read(tmp_path / "a.xyz")
    assert found.size == pytest.approx((12.0, 4.5), rel=1e-12)
    assert np.isnan(found.values.ravel()[hole])
    np.testing.assert_array_equal(found.values.ravel()[kept], MAP.ravel()[kept])
    np.savetxt(tmp_path / "b.xyz", points[:18, 1:])
    line = height_files.read(tmp_path / "b.xyz")
    np.testing.assert_array_equal(line.values, MAP[0])


@pytest.mark.parametrize("points, why", [
    (RANDOM.random((40, 3)), "no regular grid|evenly spaced"), (np.ones((5, 3)), "all points have"),
    (np.ones((5, 4)), "4 columns; x y z")])
def test_points_of_no_grid_are_refused(tmp_path, points, why):
    np.savetxt(tmp_path / "a.xyz", points)
    with pytest.raises(ValueError, match=why):
        height_files.read(tmp_path / "a.xyz")


class Bomb:
    """What does harm when it is unpickled."""

    def __reduce__(self):
        return exec, ("raise SystemExit('executed')",)


def test_files_of_surfaces_are_data(tmp_path):
    """Nothing in them is executed: no pickled object is loaded."""
    np.save(tmp_path / "a.npy", np.array([Bomb()], dtype=object), allow_pickle=True)
    (tmp_path / "b.npy").write_bytes(pickle.dumps(Bomb()))
    (tmp_path / "c.csv").write_text("=cmd|' /C calc'!A0\n__import__('os').system('x')\n")
    for name in ("a.npy", "b.npy", "c.csv"):
        with pytest.raises(ValueError, match="cannot be read"):
            height_files.read(tmp_path / name)


# Crop, holes, edges, fit


def test_what_would_be_executed_is_named(tmp_path):
    np.save(tmp_path / "a.npy", np.array([Bomb()], dtype=object), allow_pickle=True)
    with pytest.raises(ValueError, match="holds objects of Python, which are not read"):
        height_files.read(tmp_path / "a.npy")


@pytest.mark.parametrize("content", [b"", b"1 2 3\n4 5 6\n", b"\x1f\x8b\x08\x00"])
def test_what_is_no_array_of_numpy_is_not_taken_for_a_program(tmp_path, content):
    (tmp_path / "a.npy").write_bytes(content)
    with pytest.raises(ValueError, match="it is no array of NumPy"):
        height_files.read(tmp_path / "a.npy")


def test_columns_of_places_are_no_map(tmp_path):
    """A profile of two columns, a plane of three, in any order; maps of as many columns are."""
    x, y = np.arange(12) * 0.25, np.arange(5) * 0.5
    plane = np.array([(a, b, a * b) for a in x for b in y])
    columns = {"profile": np.column_stack([x, np.sin(x)]), "plane": plane,
               "mixed": RANDOM.permutation(plane)}
    for name, table in columns.items():
        np.savetxt(tmp_path / f"{name}.txt", table)
        with pytest.raises(ValueError, match="places and heights; call it FILE.xyz"):
            height_files.read(tmp_path / f"{name}.txt")
        (tmp_path / f"{name}.txt").rename(tmp_path / f"{name}.xyz")
        assert height_files.read(tmp_path / f"{name}.xyz").size is not None
    for width in (2, 3):
        np.savetxt(tmp_path / "map.txt", RANDOM.normal(size=(12, width)))
        assert height_files.read(tmp_path / "map.txt").values.shape == (12, width)


def test_an_instrument_may_write_under_an_ending_of_text(tmp_path, monkeypatch):
    """Binary files are its own, where the library that reads them is; text stays text."""
    monkeypatch.setattr(height_files, "has_library", lambda: True)
    monkeypatch.setattr(height_files, "_read_instrument",
                        lambda name, _="": height_files.Heights(MAP, (1.0, 2.0)))
    (tmp_path / "a.dat").write_bytes(b"metro\0pro" + bytes(range(200)))
    assert height_files.read(tmp_path / "a.dat").size == (1.0, 2.0)
    np.savetxt(tmp_path / "b.dat", MAP)
    assert height_files.read(tmp_path / "b.dat").size is None


def saved(tmp_path, values):
    np.save(tmp_path / "map.npy", values)
    return str(tmp_path / "map.npy")


def test_a_part_is_taken(tmp_path):
    found = heights.prepared(saved(tmp_path, MAP), crop="4:20,:16").values
    np.testing.assert_array_equal(found, MAP[4:20, :16])


@pytest.mark.parametrize("crop", ["4:20", "20:4,0:16", "0:99,0:16", "a:b,0:1", "3,0:16", "-4:3,:"])
def test_bad_parts_are_refused(tmp_path, crop):
    with pytest.raises(InputError, match="-scene_heights_crop is"):
        heights.prepared(saved(tmp_path, MAP), crop=crop)


def test_holes_are_filled():
    x, y = np.meshgrid(np.arange(24.0), np.arange(18.0), indexing="ij")
    plane = 2.0 + 0.3 * x - 0.1 * y
    values = plane.copy()
    values[5:9, 6:9] = np.nan
    filled = {fill: heights._filled("", values, fill) for fill in ("mean", "nearest",
                                                                   "interpolate")}
    np.testing.assert_allclose(filled["interpolate"], plane, atol=1e-12)
    assert np.abs(filled["nearest"] - plane).max() < 0.7
    assert filled["mean"][6, 7] == pytest.approx(np.nanmean(values), rel=1e-12)
    values[6, 7] = np.inf  # as good as nothing
    for fill, expected in filled.items():
        np.testing.assert_array_equal(heights._filled("", values, fill), expected)
    with pytest.raises(ValueError, match="12 of 432 heights are missing; .*-scene_heights_fill"):
        heights._filled("", values, "none")
    values[6, 7] = np.nan
    line = values[:, 7].copy()
    np.testing.assert_allclose(heights._filled("", line, "interpolate"), plane[:, 7], atol=1e-12)
    with pytest.raises(ValueError, match="nothing to fill from, all 16 heights are missing"):
        heights._filled("", np.full((4, 4), np.nan), "mean")


@pytest.mark.parametrize("known", (np.s_[7, :], np.s_[:, 4], np.s_[2:4, 5], np.s_[3, 3]))
def test_holes_around_a_straight_line_take_the_nearest_height(known):
    values = np.full(MAP.shape, np.nan)
    values[known] = MAP[known]
    found = heights._filled("", values, "interpolate")
    np.testing.assert_array_equal(found, heights._filled("", values, "nearest"))


@pytest.mark.parametrize("shape, crop", (((1,), ""), ((8,), "3:4"), ((1, 64), ""),
                                         ((64, 8), "0:64,7:8")))
def test_one_height_in_a_direction_makes_no_surface(shape, crop, tmp_path):
    np.save(tmp_path / "few.npy", np.zeros(shape))
    with pytest.raises(ValueError, match="one height in a direction makes no surface"):
        heights.prepared(f"{tmp_path}/few.npy", crop, "none", "warn")


def test_edges_are_mended():
    x, y = np.meshgrid(np.arange(64.0), np.arange(48.0), indexing="ij")
    tilted = 5.0 + 0.2 * x - 0.7 * y + np.cos(2 * np.pi * x / 64)
    assert seams.seams(tilted)
    flat = heights.detrended(tilted)
    slopes = np.linalg.lstsq(np.array([np.ones(x.size), x.ravel(), y.ravel()]).T, flat.ravel(),
                             rcond=None)[0]
    np.testing.assert_allclose(slopes, 0.0, atol=1e-12)
    assert not seams.seams(flat)
    tapered = heights.windowed(tilted)
    assert np.abs(tapered[[0, -1]]).max() < 0.02 and not seams.seams(tapered)
    np.testing.assert_allclose(tapered[20:44, 15:33], flat[20:44, 15:33], atol=1e-12)
    around = heights.padded(tilted)
    assert around.shape == (80, 60) and around[0, 0] == tilted.min()
    np.testing.assert_array_equal(around[8:-8, 6:-6], tilted)


def test_a_wave_is_fitted_to_another_grid():
    def wave(*shape):
        x, y = np.meshgrid(*((np.arange(n) - n // 2) / n for n in shape), indexing="ij")
        return np.cos(2 * np.pi * x + 0.4) + 0.3 * np.sin(4 * np.pi * y)

    found = heights.fitted("", wave(60, 48), (64, 32), "interpolate")
    np.testing.assert_allclose(found, wave(64, 32), atol=1e-13)
    with pytest.raises(ValueError, match="-scene_heights_fit interpolate"):
        heights.fitted("", wave(60, 48), (64, 32))


@pytest.mark.parametrize("points", ((128, 96), (45, 81), (32, 20), (64, 48)))
@pytest.mark.parametrize("known", ((60, 48), (61, 47)))
def test_periodic_heights_are_fitted_by_their_waves(points, known):
    """A surface of waves longer than two spacings of the file is the same on every grid, a coarser
    one too."""
    (numbers, amplitudes, phases), = surface((30.0, 20.0), 0.8, 0.5, 12.0, 2.0, 7).blocks()
    wavevectors = 2 * np.pi * numbers / np.array([[30.0], [20.0]])

    def summed(shape):
        x = np.meshgrid(*((np.arange(n) - n // 2) * length / n
                          for n, length in zip(shape, (30.0, 20.0))), indexing="ij")
        angles = np.tensordot(wavevectors.T, np.array(x) + np.reshape([15.0, 10.0],
                                                                            (2, 1, 1)), axes=1)
        return np.tensordot(amplitudes, np.cos(angles + phases[:, None, None]), axes=1)

    found = heights.fitted("", summed(known), points, "interpolate")
    np.testing.assert_allclose(found, summed(points), atol=1e-12)


def test_heights_that_jump_at_the_seam_do_not_ring():
    line = np.linspace(0.0, 1.0, 40)
    found = heights.fitted("", line, (80,), "interpolate")
    straight = np.interp(np.arange(80) / 2, np.arange(40), line)
    np.testing.assert_allclose(found[20:-20], straight[20:-20], atol=1e-4)


def test_margins_do_not_ring():
    """The step to a margin is felt within a few nodes only."""
    x, y = np.meshgrid(np.arange(64.0), np.arange(64.0), indexing="ij")
    around = heights.padded(np.cos(2 * np.pi * x / 16) * np.cos(2 * np.pi * y / 16))
    found = heights.fitted("", around, (100, 100), "interpolate", "pad")
    np.testing.assert_allclose(found[:, 0], -1.0, atol=2e-4)
    np.testing.assert_allclose(found[0], -1.0, atol=2e-4)


@pytest.mark.parametrize("known, points", (((64, 64), (160, 150)), ((49, 66), (240, 200)),
                                           ((100,), (320,))))
def test_the_edge_of_a_map_within_a_margin_grows_no_asperities(known, points):
    """A plane that rises to an edge is that plane on a finer grid, and the margin its lowest
    height: the step between them raises nothing, which would be in contact first."""
    x = np.meshgrid(*map(np.arange, known), indexing="ij")
    slopes = (0.02, 0.01)
    around = heights.padded(sum(slope * each for slope, each in zip(slopes, x)))
    found = heights.fitted("", around, points, "interpolate", "pad")
    places = np.meshgrid(*((np.arange(n) - n // 2) * (whole / n) + whole // 2 - count // 8
                           for n, whole, count in zip(points, around.shape, known)), indexing="ij")
    plane = sum(slope * each for slope, each in zip(slopes, places))
    within = np.all([(each >= 0) & (each <= count - 1) for each, count in zip(places, known)], 0)
    beyond = np.any([(each <= -1) | (each >= count) for each, count in zip(places, known)], 0)
    np.testing.assert_allclose(found[within], plane[within], atol=6e-3)
    np.testing.assert_array_equal(found[beyond], 0.0)
    assert found.max() <= around.max() * (1 + 1e-12) and found.min() >= -6e-3


# Scenes


def test_a_map_brings_dimension_points_and_period(tmp_path):
    name = saved(tmp_path, 1e-6 * MAP)
    scene = Scene.typed(**SI, geometry_file=name, heights_size=(2.4e-4, 1.8e-4))
    assert (scene.dimension, scene.points) == (2, (24, 18))
    assert scene.told(scene.periods, "beta") == pytest.approx((2.4e-4, 1.8e-4))
    gap = Contact(scene).initial_gap / scene.normal_maugis * scene.scale("u_n,r")[0]
    np.testing.assert_allclose(gap, 1e-6 * (MAP.max() - MAP), rtol=1e-10, atol=1e-18)


@pytest.mark.parametrize("unit", ["um", "\N{MICRO SIGN}m", "\N{GREEK SMALL LETTER MU}m"])
def test_a_part_of_a_map_has_a_part_of_its_size(tmp_path, unit):
    scene = Scene.typed(**SI, geometry_file=saved(tmp_path, MAP), heights_size=(2.4e-4, 1.8e-4),
                        heights_crop="4:20,0:16", heights_unit=unit)
    assert scene.told(scene.periods, "beta") == pytest.approx((1.6e-4, 1.6e-4))
    found = shapes.of(scene).heights(scene) * scene.scale("u_n,r")[0]
    np.testing.assert_allclose(found, 1e-6 * MAP[4:20, :16], rtol=1e-10)


def test_points_bring_their_size_in_their_unit(tmp_path):
    x, y = np.meshgrid(0.5 * np.arange(24), 0.5 * np.arange(18), indexing="ij")
    np.savetxt(tmp_path / "a.xyz", np.array([x.ravel(), y.ravel(), MAP.ravel()]).T)
    scene = Scene.typed(**SI, geometry_file=str(tmp_path / "a.xyz"), heights_unit="um")
    assert scene.told(scene.periods, "beta") == pytest.approx((12e-6, 9e-6))
    plain = Scene.typed(geometry="file", geometry_file=str(tmp_path / "a.xyz"))
    assert plain.periods == pytest.approx((12.0, 9.0))


HEADING = "# Channel: ZSensor\n# Width: {}\n# Height: {}\n# Value units: {}\n"
"""As Gwyddion writes it above rows of numbers, which are as long as the width says."""


def exported(path, values, width="3.600 µm", height="2.4e-06 m", unit="m"):
    """The path of a text as Gwyddion exports it."""
    path.write_text(HEADING.format(width, height, unit) + text(np.atleast_2d(values), "\t"),
                    encoding="utf-8")
    return str(path)


def test_headings_of_gwyddion_tell_size_and_unit(tmp_path):
    name = exported(tmp_path / "map.txt", 1e-9 * MAP)
    scene = Scene.typed(**SI, geometry_file=name)
    assert scene.told(scene.periods, "beta") == pytest.approx((2.4e-6, 3.6e-6))
    found = shapes.of(scene).heights(scene) * scene.scale("u_n,r")[0]
    np.testing.assert_allclose(found, 1e-9 * MAP, rtol=1e-10)
    part = Scene.typed(**SI, geometry_file=name, heights_crop="4:20,0:18")
    assert part.told(part.periods, "beta") == pytest.approx((1.6e-6, 3.6e-6))
    other = exported(tmp_path / "nm.txt", MAP, "3,6 \u03bcm", "2400 nm", "nm")
    assert Scene.typed(**SI, geometry_file=other).periods == pytest.approx(scene.periods)


@pytest.mark.parametrize("values", ("", "none"))
def test_headings_of_gwyddion_without_a_unit_tell_the_size(values, tmp_path):
    """It was lost: of numbers without a unit Gwyddion writes none."""
    name = exported(tmp_path / "map.txt", MAP, unit="")
    if values:
        path = Path(name)
        path.write_text(path.read_text(encoding="utf-8").replace("# Value units: \n", ""),
                        encoding="utf-8")
    scene = Scene.typed(**SI, geometry_file=name, heights_unit="nm", heights_crop="4:20,0:18")
    assert scene.told(scene.periods, "beta") == pytest.approx((1.6e-6, 3.6e-6))
    assert shapes.of(scene).stated(scene) == pytest.approx(scene.periods)
    np.testing.assert_allclose(shapes.of(scene).heights(scene) * scene.scale("u_n,r")[0],
                               1e-9 * MAP[4:20], rtol=1e-10)
    with pytest.raises(InputError, match="'dimensionless', but .* tells its size in metres: add"):
        Scene.typed(geometry="file", geometry_file=name)


def test_profiles_of_gwyddion_have_the_length_of_their_side(tmp_path):
    row = exported(tmp_path / "row.txt", MAP[:, 0])
    column = exported(tmp_path / "column.txt", MAP[:, :1])
    assert [height_files.read(name).size for name in (row, column)] == [
        pytest.approx((3.6e-6,)), pytest.approx((2.4e-6,))]


def test_headings_of_gwyddion_and_options_do_not_contradict_each_other(tmp_path):
    name = exported(tmp_path / "map.txt", 1e-9 * MAP)
    assert Scene.typed(**SI, geometry_file=name, heights_unit="m").told(
        1.0, "u_n,r") == pytest.approx(Scene.typed(**SI, geometry_file=name).told(1.0, "u_n,r"))
    with pytest.raises(InputError, match="-scene_heights_unit is 'nm', but the file says m"):
        Scene.typed(**SI, geometry_file=name, heights_unit="nm")
    with pytest.raises(InputError, match="'dimensionless', but heights of .* are in m: add"):
        Scene.typed(geometry="file", geometry_file=name)
    (told,) = [text for text in cautions.of_surface(Scene.typed(
        **SI, geometry_file=name, heights_size=(3.6e-6, 2.4e-6))) if "itself says" in text]
    assert "itself says 2.4 µm x 3.6 µm" in told


@pytest.mark.parametrize("width, unit, sentence", [
    ("3.6 µm", "V", "its unit is V; known are m"), ("18 px", "m", "a map without size"),
    ("0 m", "m", "a map without size"), ("0 m", "", "a map without size"),
    ("3.6 µm", "", "which tells its size, but no unit of its heights: give that by -scene_heigh")])
def test_headings_of_gwyddion_that_tell_no_lengths(tmp_path, width, unit, sentence):
    name = exported(tmp_path / "map.txt", MAP, width, unit=unit)
    with pytest.raises(InputError, match=sentence):
        Scene.typed(**SI, geometry_file=name)


def test_a_grid_of_its_own_is_fitted(tmp_path):
    scene = Scene.typed(geometry="file", geometry_file=saved(tmp_path, MAP[:23]), period=9.0,
                        heights_fit="interpolate", points=(32, 32), heights_edges="window")
    assert shapes.of(scene).heights(scene).shape == (32, 32)
    assert Scene.typed(geometry="file", geometry_file=saved(tmp_path, MAP[:23]), period=9.0,
                       heights_fit="interpolate").points == (24, 18)


BAD = [({}, "a map without size: give that of all of it by -scene_heights_size"),
       ({"heights_size": 1e-4, "period": 1e-4}, "-scene_heights_size is '0.0001', but "
        "-scene_period '0.0001' fixes the same"),
       ({"units": "dimensionless", "heights_unit": "nm"}, "-scene_heights_unit is 'nm', but "
        "-scene_units is 'dimensionless'"),
       ({"period": 1e-4, "heights_unit": "inch"}, "-scene_heights_unit is 'inch': allowed is one"),
       ({"period": 1e-4, "heights_fill": "magic"}, "-scene_heights_fill is 'magic'"),
       ({"period": 1e-4, "heights_crop": "0:23,0:18"}, "a map of 23 x 18 heights, and grids have "
        "even numbers of points: add -scene_heights_crop 0:22,0:18, or"),
       ({"period": 1e-4, "heights_crop": "0:8,0:18"}, "a map of 8 x 18 heights, and grids have at "
        "least 16 points a direction: add -scene_heights_fit interpolate and -scene_points"),
       ({"period": 1e-4, "geometry_file": "none.npy"}, "there is no file none.npy"),
       ({"period": 1e-4, "geometry_file": ""}, "-scene_geometry is 'file' without a file"),
       ({"geometry_file": ""}, "-scene_geometry is 'file' without a file"),
       ({"period": 1e-4, "dimension": 1}, "-scene_dimension is '1', but .* has heights in 2 "
        "directions: leave it out"),
       ({"period": 1e-4, "heights_unit": "UM"}, "-scene_heights_unit is 'UM'.*; try um")]


@pytest.mark.parametrize("values, sentence", BAD)
def test_bad_input_is_one_sentence(tmp_path, values, sentence):
    given = {**SI, "geometry_file": saved(tmp_path, MAP), **values}
    if given["units"] != "si":
        given = {name: value for name, value in given.items()
                 if name.startswith(("geo", "heights"))}
    with pytest.raises(InputError, match=sentence) as error:
        Scene.typed(**given)
    assert "\n" not in str(error.value)


def cautions_on(tmp_path, values, **typed):
    """Sentences on a surface, and the root mean square slope that the lines on a scene tell."""
    scene = Scene.typed(**SI, geometry_file=saved(tmp_path, values), heights_edges="window",
                        **typed)
    told = shapes.of(scene).about(scene, lambda value, unit, digits:
                                  f"{value * scene.scale(unit)[0]:.12g}")[0]
    return [sentence for sentence in cautions.of_surface(scene) if "not periodic" not in sentence
            ], float(told.split("slope ")[1])


def test_the_remedy_of_a_step_at_the_seam_is_another_than_what_is_done(tmp_path):
    values = MAP + 50.0 * np.cos(np.linspace(0.0, 3.0 * np.pi, 24))[:, None]
    for edges, remedy in (("warn", "edges detrend takes out the mean plane, window tapers"),
                          ("detrend", "this step: -scene_heights_edges window tapers besides")):
        scene = Scene.typed(geometry="file", geometry_file=saved(tmp_path, values), period=9.0,
                            heights_edges=edges)
        assert remedy in cautions.of_surface(scene)[0]


def test_a_profile_has_one_size(tmp_path):
    with pytest.raises(InputError, match="-scene_heights_size is '2e-05,3e-05', but .* has "
                                         "heights in 1 direction: give one number"):
        Scene.typed(geometry_file=saved(tmp_path, MAP[:, 0]), heights_size=(2e-5, 3e-5), **SI)


def test_a_map_in_another_unit_than_its_size_is_told(tmp_path):
    """Waves of 1 um over 240 um: a slope of sqrt(2) pi height over length."""
    x = np.arange(240) / 240
    waves = np.cos(2 * np.pi * 3 * x)[:, None] * np.ones(180)
    size = {"heights_size": (2.4e-4, 1.8e-4)}
    fits, slope = cautions_on(tmp_path, waves, heights_unit="µm", **size)
    whole = np.sqrt(2) * np.pi * 3 * 1e-6 / 2.4e-4
    assert not fits and slope == pytest.approx(whole, rel=0.1)  # tapered at the edges
    steep, _ = cautions_on(tmp_path, waves, **size)
    assert len(steep) == 1 and "are they in m (-scene_heights_unit)" in steep[0]
    even, _ = cautions_on(tmp_path, waves, heights_unit="um", heights_size=(240.0, 180.0))
    assert len(even) == 1 and "in um (-scene_heights_unit), and is the size in metres" in even[0]


def test_one_size_for_a_map_that_is_no_square_is_told(tmp_path):
    sentences, _ = cautions_on(tmp_path, MAP, heights_unit="nm", heights_size=2.4e-4)
    assert sentences == ["one size for a map of 24 x 18 points: its nodes are 10 µm apart along x "
                         "and 13.33 µm along y; -scene_heights_size takes two, with a comma"]
    assert not cautions_on(tmp_path, MAP, heights_unit="nm", heights_size=(2.4e-4, 1.8e-4))[0]


def test_sizes_in_the_other_order_are_told(tmp_path):
    """Width and height of an image of 18 columns and 24 rows, of which x runs down these."""
    told, _ = cautions_on(tmp_path, MAP, heights_unit="nm", heights_size=(1.8e-4, 2.4e-4))
    assert told == ["nodes of 24 x 18 heights are 7.5 µm apart along x and 13.33 µm along y, and "
                    "10 µm along both if the sizes stood in the other order: x runs down the rows "
                    "of a text, y along the numbers in each"]
    assert not cautions_on(tmp_path, MAP, heights_unit="nm", heights_size=(1.8e-4, 1.9e-4))[0]
    assert not cautions_on(tmp_path, MAP[:18], heights_unit="nm", heights_size=(2e-4, 2e-4))[0]


def test_a_size_that_is_not_the_one_of_the_file_is_told(tmp_path):
    """Points 10 um apart, 24 x 18 of them: given as a millimetre, and as it is, to a hundredth."""
    x, y = np.meshgrid(10.0 * np.arange(24), 10.0 * np.arange(18), indexing="ij")
    name = tmp_path / "points.xyz"
    np.savetxt(name, np.column_stack([x.ravel(), y.ravel(), MAP.ravel()]))
    given = dict(SI, geometry_file=str(name), heights_edges="window", heights_unit="um")
    other = Scene.typed(**given, heights_size=1e-3)
    (told,) = [text for text in cautions.of_surface(other) if "itself says" in text]
    assert told.endswith("itself says 240 µm x 180 µm of the map, and 1 mm x 1 mm is taken, as "
                         "-scene_heights_size has it")
    for same in ({}, {"heights_size": (2.41e-4, 1.79e-4)}):
        assert not [text for text in cautions.of_surface(Scene.typed(**given, **same))
                    if "itself says" in text]


@pytest.mark.parametrize("values, used, sizes", [
    ({"heights_crop": "0:16,0:18"}, "16 x 18", "360 µm x 180 µm"),
    ({"heights_edges": "pad"}, "30 x 22", "192 µm x 147.3 µm")])
def test_the_period_of_a_part_of_a_map_is_told_not_to_be_the_size_of_the_map(tmp_path, values, used,
                                                                             sizes):
    given = dict(SI, geometry_file=saved(tmp_path, MAP), heights_unit="nm") | values
    (told,) = [text for text in cautions.of_surface(Scene.typed(**given, period=(2.4e-4, 1.8e-4)))
               if "-scene_period" in text]
    assert f"{used} nodes of a map of 24 x 18 heights" in told and f"to be {sizes};" in told
    assert not [text for text in cautions.of_surface(
        Scene.typed(**given, heights_size=(2.4e-4, 1.8e-4))) if "-scene_period" in text]


def test_a_map_that_is_used_as_it_is_is_not_read_for_its_size(tmp_path, monkeypatch):
    given = dict(SI, geometry_file=saved(tmp_path, MAP), heights_unit="nm", period=(2.4e-4, 1.8e-4))
    scene = Scene.typed(**given)
    monkeypatch.setattr(shapes.SHAPES["file"], "whole", lambda shape: pytest.fail("read again"))
    assert not [text for text in cautions.of_surface(scene) if "-scene_period" in text]


@pytest.mark.parametrize("offset, kind, told", (
    (0.0, "f8", False), (1e9, "f8", False), (1e15, "f8", True), (1e5, "f4", True),
    (0.0, "f4", False), (1e3, "i8", False)))
def test_heights_too_far_from_zero_for_their_digits_are_told(tmp_path, offset, kind, told):
    """Steps of what rounding left of them were the surface, without a word."""
    np.save(tmp_path / "map.npy", (MAP + offset).astype(kind))
    scene = Scene.typed(geometry="file", geometry_file=str(tmp_path / "map.npy"), period=20.0)
    said = [sentence for sentence in cautions.of_surface(scene) if "are rounded to" in sentence]
    assert len(said) == told


def test_a_size_from_python_has_to_be_the_period(tmp_path):
    name = saved(tmp_path, MAP)
    with pytest.raises(InputError, match="-scene_heights_size is .*Scene.typed"):
        Scene(geometry="file", geometry_file=name, heights_size=3.0, dimension=2, points=(24, 18))
    assert Scene.typed(geometry="file", geometry_file=name, heights_size=3.0).periods == (3.0, 3.0)


instruments = pytest.mark.skipif(importlib.util.find_spec("SurfaceTopography") is None,
                                 reason="SurfaceTopography is not installed")


@instruments
def test_files_of_instruments_bring_size_unit_and_holes(tmp_path):
    from SurfaceTopography import Topography

    values = np.ma.masked_array(MAP, mask=np.zeros(MAP.shape, dtype=bool))
    values.mask[3, 4] = True
    Topography(values, (2.4, 1.8), unit="um").to_netcdf(str(tmp_path / "a.nc"))
    found = height_files.read(tmp_path / "a.nc")
    assert (found.size, found.unit) == (pytest.approx((2.4, 1.8)), "um")
    assert np.isnan(found.values[3, 4])
    np.testing.assert_allclose(found.values[5:], MAP[5:])


@instruments
def test_a_profile_of_points_has_the_size_of_its_steps(tmp_path):
    """The library has it from the first to the last point, one step less than the period."""
    from SurfaceTopography import NonuniformLineScan

    places = 0.2 * np.arange(len(MAP))
    NonuniformLineScan(places, MAP[:, 0], unit="nm").to_netcdf(str(tmp_path / "a.nc"))
    np.savetxt(tmp_path / "a.xyz", np.c_[places, MAP[:, 0]])
    found, known = (height_files.read(tmp_path / name) for name in ("a.nc", "a.xyz"))
    assert found.size == pytest.approx((0.2 * len(MAP),))
    assert known.size == pytest.approx(found.size)
    np.testing.assert_allclose(found.values, MAP[:, 0])


@instruments
def test_a_file_of_an_instrument_without_a_size_leaves_it_to_the_option(tmp_path):
    savemat(tmp_path / "a.mat", {"heights": MAP})
    found = height_files.read(tmp_path / "a.mat")
    assert found.size is None and np.array_equal(found.values, MAP)
    size = (2.4, 1.8)
    scene = Scene.typed(geometry="file", geometry_file=str(tmp_path / "a.mat"), heights_size=size)
    assert scene.periods == pytest.approx(size) and scene.shape == MAP.shape
    np.savetxt(tmp_path / "a.other", MAP)  # of which the library would swap the directions
    with pytest.raises(ValueError, match="a text that tells no size; call it FILE.txt"):
        height_files.read(tmp_path / "a.other")
