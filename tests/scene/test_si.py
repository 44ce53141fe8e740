"""Scenes in SI: scales, what is typed and told, and states that are those of the dimensionless
scene."""

import copy
import math
import pickle
from pathlib import Path

import h5py
import numpy as np
import petsc4py
import pytest
from processes import call

petsc4py.init([])

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact.observables import Measurement, frame, table  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.options.fields import InputError, as_text  # noqa: E402
from contactsnes.output import prefixes
from contactsnes.output.archive import Archive  # noqa: E402
from contactsnes.output.columns import Column  # noqa: E402
from contactsnes.output.figures.words import label  # noqa: E402
from contactsnes.scene import units as si  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene, Steps, attributes  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
PHI_N = 0.03
PHI_T = 0.07
MODULUS = 2e6
RADIUS = 0.01
DELTA_N = 0.7e-6
DELTA_T = 1.1e-6
TYPED = {"units": "si", "work_of_adhesion_normal": PHI_N, "work_of_adhesion_tangential": PHI_T,
         "contact_modulus": MODULUS, "radius": RADIUS, "range_normal": DELTA_N,
         "range_tangential": DELTA_T}
PDMS = {**TYPED, "work_of_adhesion_tangential": 0.03, "range_normal": 0.131e-6,
        "range_tangential": 1.31e-6}

# Each from a formula of its own, not from the program's.
BETA = (RADIUS ** 2 * PHI_N / MODULUS) ** (1 / 3)
U_N = (RADIUS * (PHI_N / MODULUS) ** 2) ** (1 / 3)
U_T = math.sqrt(PHI_T / PHI_N) * U_N
EXPECTED = {"beta": (BETA, "m"), "beta^2": (BETA * BETA, "m^2"), "u_n,r": (U_N, "m"),
            "u_t,r": (U_T, "m"), "u_n,r/beta": ((PHI_N / (MODULUS * RADIUS)) ** (1 / 3), ""),
            "w_n,r": ((MODULUS * RADIUS * PHI_N ** 2) ** (1 / 3), "N/m"),
            "w_t,r": (math.sqrt(PHI_T / PHI_N) * (MODULUS * RADIUS * PHI_N ** 2) ** (1 / 3), "N/m"),
            "R phi_n": (RADIUS * PHI_N, "N"),
            "R sqrt(phi_n phi_t)": (RADIUS * math.sqrt(PHI_N * PHI_T), "N"),
            "w_n,r u_n,r": (PHI_N * BETA, "J/m"), "R phi_n u_n,r": (PHI_N * BETA ** 2, "J"),
            "p_n,r": (PHI_N / DELTA_N, "Pa"), "p_t,r": (PHI_T / DELTA_T, "Pa"),
            "beta/E*": (BETA / MODULUS, "m/Pa"), "w_n,r/u_n,r": (MODULUS, "Pa"),
            "R phi_n/u_n,r": ((MODULUS ** 2 * RADIUS ** 2 * PHI_N) ** (1 / 3), "N/m")}
WITHOUT = {"", "s", "relative", "ranges of the law"}


def test_units_have_their_sizes():
    scene = Scene.typed(**TYPED)
    assert set(EXPECTED) == set(si.UNITS)
    for unit, (size, name) in EXPECTED.items():
        assert scene.scale(unit) == (pytest.approx(size, rel=1e-13), name)
        assert Scene().scale(unit) == (1.0, unit)
    assert scene.scale("ranges of the law") == (1.0, "ranges of the law")


def test_numbers_of_the_paper():
    """PDMS, physics below eq. 12: three digits are given."""
    scene = Scene.typed(**PDMS)
    for unit, size in (("beta", 114.5e-6), ("u_n,r", 1.310e-6), ("w_n,r", 2.621)):
        assert scene.scale(unit)[0] == pytest.approx(size, rel=4e-4)
    assert (scene.normal_maugis == pytest.approx(10, rel=1e-3)
            and scene.tangential_maugis == pytest.approx(1, rel=1e-3))
    assert 25 * scene.scale("w_n,r")[0] == pytest.approx(65.5, abs=0.05)
    assert 0.8 * scene.scale("w_n,r")[0] == pytest.approx(2.10, abs=0.005)


def test_groups_follow_from_what_is_typed():
    scene = Scene.typed(**TYPED, dimension=2, period=(0.02, 0.03), height=math.inf,
                        gap_offset=-2e-6, points="auto")
    assert scene.normal_maugis == pytest.approx(U_N / DELTA_N, rel=1e-13)
    assert scene.tangential_maugis == pytest.approx(U_T / DELTA_T, rel=1e-13)
    assert scene.work_ratio == pytest.approx(PHI_T / PHI_N, rel=1e-15)
    assert scene.periods == pytest.approx((0.02 / BETA, 0.03 / BETA), rel=1e-13)
    assert scene.gap_offset == pytest.approx(-2e-6 / U_N, rel=1e-13)
    assert scene.height == math.inf and scene.points == "auto"
    sinusoid = Scene.typed(**TYPED, geometry="sinusoid", period=0.004, amplitude=3e-6, height=0.1)
    assert (sinusoid.amplitude == pytest.approx(3e-6 / U_N, rel=1e-13)
            and sinusoid.height == pytest.approx(0.1 / BETA, rel=1e-13))
    isolated = Scene.typed(**TYPED, period=math.inf, spacing=1e-6)
    assert isolated.spacings == pytest.approx((1e-6 / BETA,), rel=1e-13)


def test_what_is_typed_is_told():
    scene = Scene.typed(**TYPED, dimension=2, period=(0.02, 0.03), gap_offset=-2e-6, points=64)
    told = attributes(scene)
    assert (told["period"] == (0.02, 0.03) and told["gap_offset"] == -2e-6
            and told["radius"] == RADIUS and told["units"] == "si")
    assert (told["height"] == pytest.approx(2000 * BETA, rel=1e-13)
            and told["normal_maugis"] == scene.normal_maugis)
    assert as_text(scene.as_typed("period")) == "0.02,0.03" and scene.as_typed("points") == 64
    assert Scene.typed(period=20.0) == Scene(period=20.0)


def test_loads_are_taken_in_the_scenes_own_units():
    scene = Scene.typed(**TYPED, dimension=2, period=0.01)
    force, shear = EXPECTED["R phi_n"][0], EXPECTED["R sqrt(phi_n phi_t)"][0]
    load = Load(start="normal_displacement=1e-6", path="normal_displacement=1e-6, "
                "tangential_displacement_y=2e-5; normal_force=3e-4; normal_force=3e-4, "
                "tangential_force_x=1e-3; tangential_force_x=hold, normal_displacement=4e-6")
    start, legs = scene.initial(load), scene.legs(load)
    assert start[0].value == pytest.approx(1e-6 / U_N, rel=1e-13)
    assert legs[0].controls[2].value == pytest.approx(2e-5 / U_T, rel=1e-13)
    assert legs[1].controls[0].value == pytest.approx(3e-4 / force, rel=1e-13)
    assert legs[2].controls[1].value == pytest.approx(1e-3 / shear, rel=1e-13)
    assert legs[3].controls[1] == ("force", None) and list(legs[3].controls) == [1, 0]
    assert Scene(dimension=2).legs(load) == load.legs(2) and Scene(dimension=2).initial(
        load) == load.initial(2)


def test_steps_have_the_unit_of_what_moves():
    """The third leg names the approach, which is where it was, before the slip that moves."""
    scene = Scene.typed(**{**TYPED, "range_tangential": 5e-6}, period=0.004, height=0.002,
                        points=128)
    load = Load(path="normal_displacement=2e-7; normal_force=hold; normal_displacement=2e-7, "
                "tangential_displacement=4e-7")
    points = list(Branch(scene, load, Steps(initial_step=(1e-7, 1e-7, 2e-7),
                                            largest_step=(1e-7, 1e-7, 2e-7))))
    assert [(point.leg, point.position) for point in points] == [(0, 0.0), (1, 0.5), (1, 1.0),
                                                                 (3, 0.5), (3, 1.0)]
    assert points[-1].load == pytest.approx([2e-7 / U_N, 4e-7 / U_T], rel=1e-13)


def without(*names):
    return {name: value for name, value in TYPED.items() if name not in names}


BAD = [(without("radius"), "-scene_units is 'si' without -scene_radius:"),
       (without("radius", "range_tangential"), "without -scene_radius and "
        "-scene_range_tangential "), ({**TYPED, "normal_maugis": 10.0}, "-scene_normal_maugis "
                                      "is '10', but with -scene_units si it "
                                      "follows from -scene_range_normal"),
       ({**TYPED, "tangential_maugis": 1.0}, "it follows from -scene_range_tangential"),
       ({**TYPED, "work_ratio": 1.0}, "it follows from -scene_work_of_adhesion_tangential"),
       ({**TYPED, "radius": -1.0}, "-scene_radius is '-1': allowed is a "
        "number above 0"), ({**TYPED, "period": -1.0}, "-scene_period is '-1': allowed "
                            "is a number above 0, or inf"),
       ({**TYPED, "period": 2e-4},
        r"-scene_period is '0\.0002': the cylinder would be in contact up to the edge .* is "
        r"0\.0003\d+$"),
       ({**TYPED, "period": (0.01, 0.02)}, r"-scene_period is '0\.01,0\.02': one dimension"),
       ({**TYPED, "spacing": 1e-6}, "-scene_spacing is '1e-06': it belongs to "
        "-scene_period inf"), ({"radius": 0.01}, "-scene_radius is '0.01', but "
                               "-scene_units is 'dimensionless': add -scene_units si"),]


@pytest.mark.parametrize("values, sentence", BAD)
def test_bad_input_is_one_sentence(values, sentence):
    with pytest.raises(InputError, match=sentence) as error:
        Scene.typed(**values)
    assert "\n" not in str(error.value)


def test_the_smallest_period_that_is_named_is_allowed():
    with pytest.raises(InputError) as error:
        Scene.typed(**TYPED, period=2e-4)
    Scene.typed(**TYPED, period=float(str(error.value).split()[-1]))


def test_scales_from_python_do_not_contradict_the_groups():
    """Without `typed`, values are the scene's own: scales alone make a dimensionless scene speak
    SI."""
    scales = without("range_normal", "range_tangential")
    scene = Scene(**scales, work_ratio=PHI_T / PHI_N, normal_maugis=3.0, period=50.0)
    assert scene.periods == (50.0,) and scene.scale("p_n,r")[0] == pytest.approx(3 * PHI_N / U_N,
                                                                                 rel=1e-13)
    ratio = PHI_T / PHI_N
    for contradiction in (dict(work_ratio=1.0), dict(work_ratio=1.001 * ratio),
                          dict(work_ratio=ratio, range_normal=DELTA_N)):
        with pytest.raises(InputError,
                           match="but -scene_(range|work).* makes it .*give one of them"):
            Scene(**scales, **contradiction)


CASES = {1: (dict(period=0.004, height=0.002, gap_offset=-1e-7, poisson=0.4, residual_friction=0.5,
                  points=512), {}, (("normal_force", 6.0), ("tangential_displacement", 3e-6)),
             (2.0, 1e-6)), 2: (dict(period=0.001, height=0.02, geometry="sphere", dimension=2,
                                    points=48), {"range_normal": 1.3e-6},
                               (("normal_force", 4e-4), ("tangential_displacement_y", 2e-5)),
                               (2e-4, 1e-5))}
LENGTHS = {"period": BETA, "height": BETA, "gap_offset": U_N}


@pytest.fixture(params=CASES, scope="module")
def twins(request):
    """Dimension, and a path in SI and without dimensions, whose numbers are converted here:
    branches and their points."""
    values, other, path, largest = CASES[request.param]
    typed = {**TYPED, **other}
    units = {"normal_force": {1: "w_n,r", 2: "R phi_n"}[request.param], path[1][0]: "u_t,r"}
    sizes = [EXPECTED[units[name]][0] for name, _ in path]
    in_si = Scene.typed(**typed, **values)
    plain = Scene(normal_maugis=U_N / typed["range_normal"], tangential_maugis=U_T / DELTA_T,
                  work_ratio=PHI_T / PHI_N, **{name: value / LENGTHS.get(name, 1.0)
                                               if name in LENGTHS else value
                                               for name, value in values.items()})
    text = "; ".join(f"{name}={value}" for name, value in path)
    load = Load(path="; ".join(f"{name}={value / size!r}"
                               for (name, value), size in zip(path, sizes)))
    both = (Branch(in_si, Load(path=text), Steps(largest_step=largest)),
            Branch(plain, load,
                   Steps(largest_step=tuple(step / size for step, size in zip(largest, sizes)))))
    return request.param, typed, *((branch, list(branch)) for branch in both)


def test_states_are_those_of_the_dimensionless_scene(twins):
    _, _, (_, mine), (_, plain) = twins
    assert len(mine) == len(plain) > 4
    for one, other in zip(mine, plain):
        assert one.state.window == other.state.window and one.event == other.event
        np.testing.assert_allclose(one.state.displacement, other.state.displacement, atol=1e-7)


def test_numbers_differ_by_the_scales(twins):
    dimension, typed, (branch, mine), (twin, plain) = twins
    sizes = {**EXPECTED, "p_n,r": (PHI_N / typed["range_normal"], "Pa")}
    columns, others = table(branch.scene), table(twin.scene)
    for one, other in zip(mine, plain):
        told, expected = branch.observe(one), twin.observe(other)
        for name in set(told) - {"energy_imbalance"}:
            size, unit = sizes.get(others[name].unit, (1.0, others[name].unit))
            assert columns[name].unit == unit
            if others[name].unit not in sizes:
                continue  # counts
            np.testing.assert_allclose(told[name], size * expected[name], rtol=1e-6,
                                       atol=1e-7 * size, err_msg=name)
    assert told["normal_force"] == pytest.approx(CASES[dimension][2][0][1], rel=1e-14)


def test_fields_are_in_si(twins):
    _, typed, (branch, mine), (twin, plain) = twins
    displacement, traction = Measurement(branch.contact, mine[-1]).fields()
    others = Measurement(twin.contact, plain[-1]).fields()
    each = (-1, *[1] * (displacement.ndim - 1))
    count = len(displacement) - 1
    np.testing.assert_allclose(displacement, others[0] * np.reshape([U_N, *[U_T] * count], each),
                               atol=1e-7 * U_N)
    pressures = [PHI_N / typed["range_normal"], *[PHI_T / DELTA_T] * count]
    np.testing.assert_allclose(traction, others[1] * np.reshape(pressures, each),
                               atol=1e-7 * max(pressures))
    frames = frame(branch.contact), frame(twin.contact)
    assert frames[0]["units"] == {"coordinates": "m", "initial_gap": "m", "displacement": "m; m",
                                  "traction": "Pa; Pa"}
    assert frames[1]["units"] == {"coordinates": "beta", "initial_gap": "u_n,r",
                                  "displacement": "u_n,r; u_t,r", "traction": "p_n,r; p_t,r"}
    np.testing.assert_allclose(frames[0]["initial_gap"], U_N * frames[1]["initial_gap"], rtol=1e-12,
                               atol=1e-12 * U_N)
    for axis, other in zip(frames[0]["coordinates"], frames[1]["coordinates"]):
        np.testing.assert_allclose(axis, BETA * other, rtol=1e-12)


@pytest.mark.parametrize("dimension", (1, 2))
def test_every_unit_of_a_column_is_one_of_si(dimension):
    """A new column needs a unit that is known here."""
    scene = Scene.typed(**TYPED, dimension=dimension, period=0.01)
    for name, row in table(scene).items():
        assert row.unit in {*si.UNITS.values(), *WITHOUT} or row.unit.startswith("real FFTs"), name


def test_loads_are_told_with_units():
    scene = Scene.typed(**TYPED)
    assert scene.loads(("force", "displacement"), (2.0, 3.0)) == (
        f"normal_force {2 * EXPECTED['w_n,r'][0]:.6g} N/m, tangential_displacement "
        f"{3e6 * U_T:.6g} µm")
    assert (Scene().loads(("approach",), (2.0,)) == "approach 2"
            and Scene(dimension=2).loads(("force",), (2.0,)) == "normal_force 2")


@pytest.mark.parametrize("value, unit, text", [(0.01145, "m", "11.45 mm"),
                                               (1.31e-6, "m", "1.31 µm"),
                                               (999.9e-9, "m", "999.9 nm"), (0.0, "m", "0 m"),
                                               (2.0e6, "Pa", "2 MPa"), (2.62, "N/m", "2.62 N/m"),
                                               (0.03, "J/m^2", "30 mJ/m²"),
                                               (3e-8, "m^2", "0.03 mm²"),
                                               (-3e-10, "m^2", "-300 µm²"), (0.5, "", "0.5"),
                                               (31.2, "", "31.2")])
def test_prefixes(value, unit, text):
    assert si.prefixed(value, unit) == text


# The command line

OPTIONS = [word for name, value in TYPED.items() for word in (f"-scene_{name}", as_text(value))]
SMALL = [*OPTIONS, "-scene_points", "256", "-scene_period", "0.003", "-load_path",
         "normal_force=6; tangential_displacement=2e-6", "-continuation_largest_step", "3,1e-6"]


def test_archives_are_in_si_and_are_resumed(tmp_path):
    run = ["run", *SMALL, "-archive_file", "run.h5", "-archive_fields", "all"]
    done = call(*run, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        whole = {name: column[:] for name, column in file["branch"].items()}
        assert {name: file["branch"][name].attrs["unit"] for name in ("normal_force", "approach",
                                                                      "contact_area",
                                                                      "maximum_pressure")} == {
            "normal_force": "N/m", "approach": "m", "contact_area": "m", "maximum_pressure": "Pa"}
        assert whole["normal_force"][-1] == pytest.approx(6.0, rel=1e-14)
        assert whole["tangential_displacement"][-1] == pytest.approx(2e-6, rel=1e-14)
        np.testing.assert_allclose(file["fields/x"][:], (np.arange(256) - 128) * 0.003 / 256,
                                   rtol=1e-13, atol=1e-18)
        np.testing.assert_allclose(file["fields/initial_gap"][:],
                                   file["fields/x"][:] ** 2 / (2 * RADIUS), rtol=1e-12)
        pressure, spacing = -file["fields/traction"][-1][0], 0.003 / 256
        assert (np.sum(pressure) * spacing == pytest.approx(6.0, rel=1e-6)
                and file["fields/traction"].attrs["unit"] == "Pa; Pa")
        shear = np.sum(file["fields/traction"][-1][1]) * spacing
        assert shear == pytest.approx(whole["tangential_force"][-1], rel=1e-6)
        assert file["scene"].attrs["period"] == 0.003 and file["scene"].attrs["units"] == "si"
        assert file["scene"].attrs["normal_maugis"] == pytest.approx(U_N / DELTA_N)
        # as a run leaves it that was killed at its last point
        file.attrs.modify("points", len(whole["leg"]) - 1)
        file.attrs.modify("complete", False)
    done = call(*run, "-archive_resume", folder=tmp_path)
    assert done.returncode == 0 and "going on after point" in done.stdout, done.stderr
    with h5py.File(tmp_path / "run.h5") as file:
        assert file.attrs["points"] == len(whole["leg"]) and file.attrs["complete"]
        for name in ("normal_force", "approach", "contact_area", "tangential_force"):
            np.testing.assert_allclose(file["branch"][name][:], whole[name], rtol=1e-6)
    changed = [*run, "-archive_resume", "-scene_radius", "0.011"]
    done = call(*changed, folder=tmp_path)
    assert done.returncode == 2 and "radius is 0.01 there and 0.011 here" in done.stderr


def test_info_tells_groups_and_scales(tmp_path):
    done = call("info", *SMALL, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    for text in (f"normal Maugis parameter {U_N / DELTA_N:.8g}, tangential "
                 f"{U_T / DELTA_T:.8g}", f"ratio of works of adhesion {PHI_T / PHI_N:.8g}",
                 f"period 3 mm ({0.003 / BETA:.8g} beta)", "works of adhesion 30 mJ/m² "
                 "and 70 mJ/m², contact modulus 2 MPa, radius 10 mm, "
                 "ranges 700 nm and 1.1 µm", f"beta {BETA * 1e6:.4g} µm",
                 f"p_n,r {PHI_N / DELTA_N / 1e3:.4g} kPa", "normal_force goes to 6 N/m",
                 "tangential_displacement goes to 2 µm", "-scene_period 0.003\n"):
        assert text in done.stdout, text
    options = done.stdout[done.stdout.index("\nOptions\n"):].splitlines()[2:]
    assert not [line for line in options if "maugis" in line or "work_ratio" in line]
    (tmp_path / "all.opts").write_text("\n".join(options))
    again = call("info", "all.opts", folder=tmp_path)
    assert (again.returncode == 0 and again.stdout.splitlines()[:12]
            == done.stdout.splitlines()[:12]), again.stderr


def test_heights_of_a_file_are_in_metres(tmp_path):
    x = (np.arange(256) - 128) * 0.003 / 256
    np.savetxt(tmp_path / "heights.txt", -x ** 2 / (2 * RADIUS) + 1e-3)
    press = [*OPTIONS, "-scene_points", "256", "-scene_period", "0.003", "-load_path",
             "normal_force=6", "-continuation_largest_step", "6", "-continuation_initial_step", "6",
             "-archive_file"]
    forces = []
    for name, geometry in (("file", ["-scene_geometry", "file", "-scene_geometry_file",
                                     "heights.txt"]), ("cylinder", [])):
        done = call("run", *press, f"{name}.h5", *geometry, folder=tmp_path)
        assert done.returncode == 0, done.stderr
        with h5py.File(tmp_path / f"{name}.h5") as file:
            forces.append([file["branch"][column][-1] for column in ("approach", "contact_area",
                                                                     "maximum_pressure")])
    np.testing.assert_allclose(*forces, rtol=1e-7)


@pytest.mark.parametrize("words, sentence",
                         [(["-scene_units", "si"], "without -scene_work_of_adhesion_normal and"),
                          ([*OPTIONS, "-scene_normal_maugis", "10"], "leave it out"),
                          ([*OPTIONS[:-2]], "without -scene_range_tangential"),
                          ([*OPTIONS, "-scene_contact_modulus", "2 MPa"], "'2 MPa'"),
                          (OPTIONS[2:], "add -scene_units si"),
                          ([*OPTIONS, "-load_path", "normal_force=2N"],
                           "to 1e+30, without its unit")])
def test_bad_input_has_status_2(tmp_path, words, sentence):
    done = call("info", *words, folder=tmp_path)
    assert (done.returncode == 2 and sentence in done.stderr
            and len(done.stderr.splitlines()) == 1), done.stderr


# Figures


def test_the_example_goes_from_si_to_figures(tmp_path):
    """The numbers of the paper below equation 12: ranges of 0.4 and 0.6 micrometres, and a load of
    25 w_n,r."""
    run = call("run", str(ROOT / "options/pdms.opts"), "-archive_file", "pdms.h5",
               "-archive_fields", "last", folder=tmp_path)
    assert run.returncode == 0 and "warning" not in run.stderr, run.stderr
    with h5py.File(tmp_path / "pdms.h5") as file:
        scene = dict(file["scene"].attrs)
        branch = {name: column[:] for name, column in file["branch"].items()}
        assert 3 <= scene["normal_maugis"] < 3.5 and 1 <= scene["tangential_maugis"] <= 3.6
        assert "gross_sliding" in file["branch/event"].attrs["names"][branch["event"]]
        # At large slip: residual friction, half of sqrt(2/e) phi_t/delta_t, over a Hertzian
        # contact, and a little beyond it.
        hertz = 2 * math.sqrt(4 * 0.01 * 65.5 / (math.pi * 2e6))
        assert branch["tangential_force"][-1] == pytest.approx(0.5 * math.sqrt(2 / math.e) * 0.03
                                                               / 0.6e-6 * hertz, rel=0.06)
        assert branch["maximum_pressure"][-1] == pytest.approx(2 * 65.5 / (math.pi * hertz / 2),
                                                               rel=0.02)
    figures = call("plot", "pdms.h5", folder=tmp_path)
    assert (figures.returncode == 0 and {f"pdms-{name}.png"
                                         for name in ("shear", "area", "approach", "profiles")}
            <= {path.name for path in tmp_path.glob("*.png")})


@pytest.fixture(params=(1, 2))
def archives(request, tmp_path):
    """The same two points in SI and without dimensions, as `prefixes.read` has them, and the scene
    in SI."""
    dimension = request.param
    typed = dict(PDMS, dimension=dimension, period=0.01, points=32)
    found = []
    for scene in (Scene.typed(**typed), Scene(dimension=dimension,
                                              period=0.01 / ((0.01 ** 2 * 0.03 / 2e6) ** (1 / 3)),
                                              points=32)):
        contact, path = Contact(scene), tmp_path / f"{scene.units}.h5"
        columns = {name: Column(row.unit, row.kind, row.names)
                   for name, row in table(scene).items()}
        content = frame(contact)
        archive = Archive.create(path, scene=attributes(scene), options="", versions={},
                                 columns=columns, fields="all", components=scene.components,
                                 **content)
        shape = (scene.components, *contact.grid.shape)
        for place in (1.0, 2.0):
            row = {name: 10 * place * scene.scale(observable.unit)[0] if observable.kind == "f8"
                   else 0 for name, observable in table(Scene(dimension=dimension)).items()}
            fields = [np.ones(shape) * np.reshape([scene.scale(f"{symbol}_n,r")[0],
                                                   *[scene.scale(f"{symbol}_t,r")[0]] * dimension],
                                                  (-1, *[1] * dimension)) for symbol in "up"]
            archive.append(row, {}, *fields)
        found.append(prefixes.read(path))
    return (dimension, *found)


FACTORS = {"µm": 1e-6, "mm": 1e-3, "nm": 1e-9, "m": 1.0, "mm²": 1e-6, "µm²": 1e-12, "kPa": 1e3,
           "Pa": 1.0, "MPa": 1e6, "N/m": 1.0, "mN": 1e-3, "µN": 1e-6, "N": 1.0, "kN/m": 1e3,
           "µJ/m": 1e-6, "nJ": 1e-9, "pJ": 1e-12, "µJ": 1e-6, "mJ/m": 1e-3, "nJ/m": 1e-9}


def test_figures_have_prefixes_whose_values_are_those_of_the_archive(archives):
    dimension, mine, plain = archives
    scales = Scene.typed(**PDMS, dimension=dimension, period=0.01)
    converted = 0
    for name in mine:
        if plain.units[name] in si.UNITS:
            factor = FACTORS[mine.units[name]]
            np.testing.assert_allclose(mine[name] * factor,
                                       plain[name] * scales.scale(plain.units[name])[0], rtol=1e-3)
            assert 1e-3 <= np.max(np.abs(mine[name])) < 1e3
            converted += 1
        elif mine[name].dtype.kind == "f":
            assert mine.units[name] == plain.units[name]
    assert converted > 10
    assert mine.units["approach"] == mine.units["normal_displacement"] == "µm"
    for end in ("",) if dimension == 1 else ("_x", "_y"):
        assert (mine.units[f"tangential_displacement{end}"]
                == mine.units[f"mean_tangential_displacement{end}"] == "µm")


def test_fields_in_figures_have_prefixes(archives):
    dimension, mine, plain = archives
    scales = si.sizes(mine.scene, *(mine.scene[f"{end}_maugis"]
                                    for end in ("normal", "tangential")))
    beta, gap = scales["beta"], scales["u_n,r"]
    for axis, other, name in zip(mine.coordinates, plain.coordinates, "xy"):
        np.testing.assert_allclose(axis * FACTORS[mine.units[name]], other * beta, rtol=1e-9)
    np.testing.assert_allclose(mine.initial_gap * FACTORS[mine.units["initial_gap"]],
                               plain.initial_gap * gap, rtol=1e-9)
    assert mine.contact_gap * FACTORS[mine.units["initial_gap"]] == pytest.approx(
        2.718281828 * 0.131e-6, rel=1e-9)
    assert plain.contact_gap == pytest.approx(0.2718281828)
    for name, sizes in (("displacement", (gap, scales["u_t,r"])),
                        ("traction", (0.03 / 0.131e-6, 0.03 / 1.31e-6))):
        factors = [FACTORS[unit] for unit in mine.units[name].split("; ")]
        assert mine.field(name, 1).shape == plain.field(name, 1).shape
        for component, values in enumerate(mine.field(name, 1)):
            np.testing.assert_allclose(values * factors[min(component, 1)],
                                       sizes[min(component, 1)], rtol=1e-9)
    assert mine.units["displacement"].split("; ")[0] == mine.units["initial_gap"]  # they are added


def test_labels_have_units_in_brackets():
    assert label("contact length", "2a", "mm") == "contact length $2a$ (mm)"
    assert (label("", "A", "mm²") == "$A$ (mm²)" and label("normal force", "W_n", "N/m")
            == "normal force $W_n$ (N/m)")


def test_archives_for_figures_can_be_copied(archives):
    _, mine, _ = archives
    for made in (copy.copy(mine), copy.deepcopy(mine), pickle.loads(pickle.dumps(mine))):
        assert made.units == mine.units and made.points == mine.points
        assert made["approach"].tolist() == mine["approach"].tolist()
    with pytest.raises(AttributeError, match="nothing"):
        mine.nothing
