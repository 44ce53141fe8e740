"""Shapes of one's own: functions of the coordinates, classes with options, in files or from Python;
what they claim is looked at."""

import hashlib
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import petsc4py
import processes
import pytest

petsc4py.init([])

from contactsnes import (  # noqa: E402
    Branch,
    Contact,
    InputError,
    Load,
    Scene,
    Shape,
    option,
    read,
)
from contactsnes.branch.accuracy import finer_contact  # noqa: E402
from contactsnes.branch.grid_choice import chosen  # noqa: E402
from contactsnes.interface import shapes  # noqa: E402
from contactsnes.interface.own_shapes import check, jumps  # noqa: E402
from contactsnes.interface.shapes.cylinder import Cylinder  # noqa: E402
from contactsnes.scene import settings  # noqa: E402
from contactsnes.scene.parts import with_parts  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
LINE = {"points": 128, "period": 20.0, "normal_maugis": 1.0}
PLANE = {**LINE, "points": 32, "dimension": 2, "period": 12.0}
PRESSED = Load(path="normal_displacement=2")

FILE = """
import numpy as np
from contactsnes import Shape, option

def gap(x):
    return x ** 2 / 2

def bowl(x, y):
    return (x ** 2 + y ** 2) / 2

class Tilted(Shape):
    tilt_angle = option(0.1, "slope of the shape Tilted", "u_n,r/beta", minimum=0)
    tilt_steep = option(False, "whether it is steep")

    def gap(self, coordinates, scene):
        x = coordinates[0]
        g = x ** 2 / 2 * (2 if self.tilt_steep else 1) + self.tilt_angle * x
        return g + self.tilt_angle ** 2 / 2
"""


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A function that writes a file of shapes, and gives its path; what it enters is forgotten."""
    monkeypatch.setattr(shapes.REGISTRY, "own", {})
    monkeypatch.setattr(shapes.REGISTRY, "options", dict(shapes.REGISTRY.options))
    for name in ("__init__", "__eq__", "__repr__", "__hash__", "__match_args__",
                 "__dataclass_fields__"):
        monkeypatch.setattr(Scene, name, getattr(Scene, name))

    def write(text=FILE, name="mine.py"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path / name

    yield write
    for name in ("tilt_angle", "tilt_steep"):
        if name in vars(Scene):
            delattr(Scene, name)


def last(scene, **parts):
    """The last point of a scene that is pressed."""
    return list(Branch(scene, PRESSED, **parts))[-1]


def test_a_function_is_the_shape_that_it_is():
    point, same = last(Scene(**LINE)), last(Scene(**LINE), geometry=lambda x: x ** 2 / 2)
    np.testing.assert_array_equal(point.state.displacement, same.state.displacement)
    other = last(Scene(**LINE), geometry=Cylinder())
    assert other.forces[0] == point.forces[0]


def test_a_shape_may_write_into_its_coordinates():
    class Doubled(Shape):
        def gap(self, coordinates, scene):
            x = coordinates[0]
            x *= 2
            return x ** 2 / 8

    assert last(Scene(**LINE), geometry=Doubled()).forces[0] == last(Scene(**LINE)).forces[0]


@pytest.mark.parametrize("parts", ({"geometry": lambda x, y: (x ** 2 + y ** 2) / 2},))
def test_on_a_plane_it_has_two_coordinates(parts):
    point = last(Scene(**PLANE, geometry="sphere"))
    assert last(Scene(**PLANE), **parts).forces[0] == pytest.approx(point.forces[0], rel=1e-12)


def test_it_is_moved_as_a_whole():
    """A body whose apex is elsewhere is not even about the cell's middle, and solved in full: the
    same force."""
    moved = lambda x: np.minimum((x - 2.5) ** 2, (x + 17.5) ** 2) / 2
    branch = Branch(Scene(**LINE), PRESSED, geometry=moved)
    *_, point = branch
    assert branch.contact.unevenness > 1
    assert point.forces[0] == pytest.approx(last(Scene(**LINE)).forces[0], rel=1e-7)


def test_a_file_is_named_by_an_option(written):
    path = written()
    scene = Scene(**LINE, geometry=f"{path}:gap")
    branch = Branch(scene, PRESSED)
    *_, point = branch
    assert point.forces[0] == last(Scene(**LINE)).forces[0]
    told = branch.attributes()
    assert told["geometry"] == f"{path}:gap" and told["geometry_sha256"] == hashlib.sha256(
        path.read_bytes()).hexdigest()
    assert "geometry_sha256" not in Branch(Scene(**LINE), PRESSED).attributes()


def test_a_class_brings_its_options(written):
    path = written()
    scene = Scene(**LINE, geometry=f"{path}:Tilted", tilt_angle=0.5)
    assert shapes.of(scene).tilt_angle == 0.5 and settings.attributes(scene)["tilt_angle"] == 0.5
    assert "tilt_angle" not in settings.attributes(Scene())
    names = ["scene_tilt_angle", "scene_amplitude"]
    assert [name for name, _ in settings.ineffective(scene, PRESSED, names)] == names[1:]
    assert [name for name, _ in settings.ineffective(Scene(), PRESSED, names)] == names[::-1]
    with pytest.raises(InputError, match="-scene_tilt_angle is '-1': allowed is a number at least"):
        Scene(geometry=f"{path}:Tilted", tilt_angle=-1)
    # the slope times the distance of the ends less what the parabola steps there
    (axis, step, _), = jumps(scene)
    assert axis == 0 and step == pytest.approx(8.4, rel=0.01) and not jumps(Scene(**LINE))


class Claims(Shape):
    """A parabola beside the middle, with a ripple, that claims what it is told to."""

    shift = option(0.0, "of the apex", "beta")
    ripple = option(0.0, "size of waves", "u_n,r")

    def gap(self, coordinates, scene):
        return sum((x - self.shift) ** 2 / 2 + self.ripple * np.sin(3 * x) for x in coordinates)


@pytest.mark.parametrize("claims, options, words", (
    ({"even": (0,)}, (1.0, 0.0), r"claims to be even along x .* at x = -9.84375 beta the gap is "
     r"58.79\d+ u_n,r, and 39.1\d+ u_n,r at its mirror image"),
    ({"convex": True}, (0.0, 0.5), "claims to be convex"),
    ({"uniform": (0,)}, (0.0, 0.0), "claims to be uniform along x"),
    ({"parabola": {1: 1.0}}, (1.0, 0.0), "claims to lie above a parabola"),
    ({"curvature": lambda self, scene: (1.0,)}, (0.0, 0.3), "claims a curvature of at most 1 .* "
     r"give 3\.\d+"),
))
def test_a_claim_that_does_not_hold_is_refused(claims, options, words):
    cls = type("Other", (Claims,), claims)
    with pytest.raises(InputError, match=words):
        Contact(Scene(**LINE), geometry=cls(*options))
    if "uniform" not in claims:
        Contact(Scene(**LINE), geometry=cls(0.0, 0.0))


@pytest.mark.parametrize("name", sorted(set(shapes.SHAPES) - {"file", "rough"}))
@pytest.mark.parametrize("dimension", (1, 2))
def test_the_packages_shapes_are_what_they_claim(name, dimension):
    if (name, dimension) == ("sphere", 1):
        return
    scene = Scene(**{**(LINE if dimension == 1 else PLANE), "geometry": name})
    contact = Contact(scene)
    check(shapes.of(scene), contact.initial_gap, contact.grid, scene)


@pytest.mark.parametrize("gap, words", (
    (lambda x: np.where(x > 1, np.nan, x ** 2), "the gap is nan at x = 1.09375 beta"),
    (lambda x: 1 / x ** 2, "the gap is inf at x = 0 beta"),
    (lambda x: x[:5], r"the gap has the shape \(5,\), the nodes have \(128,\)"),
    (lambda x: x + 1j, "complex128 instead of real numbers"),
    (lambda x: x.no_such, "cannot be evaluated .AttributeError"),
    (lambda x: np.ma.masked_greater(x ** 2 / 2, 40), "the gap is nan at x = -10 beta"),
    (lambda x: x ** 2 / 2 + np.random.default_rng().normal(size=x.shape),
     "the gap at x = -10 beta is .* u_n,r, and .* u_n,r when it is asked again"),
    (lambda x, y: x + y, r"it takes \(x, y\), but is given x"),
))
def test_what_is_wrong_with_a_gap_is_told(gap, words):
    with pytest.raises(InputError, match=f"-scene_geometry is .*{words}"):
        Branch(Scene(**LINE), PRESSED, geometry=gap)


def test_what_is_no_shape_is_refused(written):
    path = written(FILE + "\nnumber = 3\n")
    for name, words in (("gab", "has no shape 'gab': its shapes are gap, bowl, Tilted; try .*:gap"),
                        ("number", "has no shape 'number'")):
        with pytest.raises(InputError, match=words):
            Scene(geometry=f"{path}:{name}")
    with pytest.raises(InputError, match="there is no file 'nowhere.py'"):
        Scene(geometry="nowhere.py:gap")
    with pytest.raises(InputError, match="give a function of the coordinates"):
        Branch(Scene(**LINE), PRESSED, geometry=3)


def test_points_for_an_accuracy_and_finer_grids():
    """A curvature that is not declared is found: as many points as those of the same shape of the
    package."""
    values = {**LINE, "points": "auto", "normal_maugis": 3.0, "accuracy": 1e-4}
    own = chosen(with_parts(Scene(**values), geometry=lambda x: x ** 2 / 2), PRESSED)
    assert own.shape == chosen(Scene(**values), PRESSED).shape
    sharp = chosen(with_parts(Scene(**{**values, "normal_maugis": 0.5}),
                              geometry=lambda x: 500 * x ** 2), PRESSED)
    assert sharp.shape > chosen(Scene(**{**values, "normal_maugis": 0.5}), PRESSED).shape
    finer = finer_contact(Contact(own), 2)
    assert finer.initial_gap[::2].tolist() == Contact(own).initial_gap.tolist()


def test_an_isolated_contact_needs_a_parabola_below_it():
    isolated = Scene(period=math.inf, spacing=0.2, normal_maugis=1.0)
    load = Load(path="normal_force=2")
    with pytest.raises(InputError, match="shapes of one's own that declare a parabola"):
        Branch(isolated, load, geometry=lambda x: x ** 2 / 2)
    cls = type("Steep", (Claims,), {"parabola": {1: 1.0}})
    *_, point = Branch(isolated, load, geometry=cls())
    *_, same = Branch(isolated, load)
    np.testing.assert_allclose(point.state.displacement, same.state.displacement, atol=1e-9)


def test_curvature_and_length_scale_an_isolated_contact():
    """A body of curvature c is one of curvature 1 in other units: the box is as many of its
    half-widths."""
    from contactsnes.contact.isolated import half_width

    sharp = type("Sharp", (Claims,), {"parabola": {1: 8.0},
                                      "gap": lambda self, x, scene: 4 * x[0] ** 2})
    isolated = Scene(period=math.inf, spacing=0.2, normal_maugis=1.0)
    own = with_parts(isolated, geometry=sharp())
    # beta c^(-2/3) = 1/4, u_n,r c^(-1/3) = 1/2: ranges of the law are twice as long in these
    same = Scene(period=math.inf, spacing=0.2, normal_maugis=0.5)
    assert half_width(own, 2.0) == pytest.approx(half_width(same, 4.0) / 4, rel=1e-12)


def test_in_si_a_function_is_of_metres(written):
    path = written("def gap(x):\n    return x ** 2 / 0.02\n")
    typed = dict(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
                 contact_modulus=2e6, radius=0.01, range_normal=1e-6, range_tangential=1e-6,
                 period=4e-3, points=128)
    own = Contact(Scene.typed(**typed, geometry=f"{path}:gap"))
    np.testing.assert_allclose(own.initial_gap, Contact(Scene.typed(**typed)).initial_gap,
                               rtol=1e-12, atol=1e-12)


def call(folder, *words, root=ROOT):
    """A finished command of a package in a folder."""
    other = {} if root == ROOT else {"env": {**os.environ, "PYTHONPATH": str(root)}}
    return processes.call(*words, folder=folder, **other)


def test_the_commands_know_a_shape_in_a_file(tmp_path, written):
    """A file of options names it by a path from its own folder; help, info, run, resume."""
    (tmp_path / "scenes").mkdir()
    path = written(name="scenes/mine.py")
    (tmp_path / "scenes/own.opts").write_text(
        "-scene_geometry mine.py:Tilted\n-scene_tilt_angle 0.05\n-scene_points 128\n"
        "-scene_period 20\n-scene_normal_maugis 1\n-load_path normal_displacement=1\n")
    done = call(tmp_path, "run", "scenes/own.opts", "-help")
    assert "-scene_tilt_angle" in done.stdout and "slope of the shape Tilted" in done.stdout
    # a flag of its own, before the file that brings it
    done = call(tmp_path, "info", "-scene_tilt_steep", "scenes/own.opts", "-scene_tilt_angle", "1")
    assert done.returncode == 0, done.stderr
    assert "-scene_tilt_steep true" in done.stdout and "the gap is not periodic" in done.stderr
    done = call(tmp_path, "run", "scenes/own.opts", "-archive_file", "run.h5")
    assert done.returncode == 0, done.stderr
    more = ("-archive_resume", "-load_path", "normal_displacement=1; normal_displacement=1.2")
    done = call(tmp_path / "scenes", "run", "own.opts", "-archive_file", "../run.h5", *more)
    assert done.returncode == 0, done.stderr
    path.write_text(path.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    done = call(tmp_path, "run", "scenes/own.opts", "-archive_file", "run.h5", *more)
    assert done.returncode == 2 and "geometry_sha256" in done.stderr
    done = call(tmp_path, "run", "scenes/own.opts", "-scene_tilt_angel", "1")
    assert done.returncode == 2 and "did you mean -scene_tilt_angle?" in done.stderr


@pytest.mark.parametrize("name", ("own-law", "own-geometry"))
def test_the_examples_run_from_any_folder(tmp_path, name):
    done = call(tmp_path, "run", ROOT / "options" / f"{name}.opts", "-scene_points", "128",
                "-load_path", "normal_displacement=1")
    assert done.returncode == 0, done.stderr


def test_the_other_shape_of_the_example_is_an_isolated_contact(tmp_path):
    done = call(tmp_path, "run", ROOT / "options/own-geometry.opts", "-scene_geometry",
                f"{ROOT}/options/own_geometry.py:Ogive", "-scene_period", "inf", "-scene_points",
                "auto", "-scene_accuracy", "1e-2", "-load_start", "normal_force=0", "-load_path",
                "normal_force=1")
    assert done.returncode == 0, done.stderr


NEW = {"shapes/wedge.py": '''
import numpy as np

from ...options.fields import option
from .shape import Shape


class Wedge(Shape):
    """s |x|."""

    name, meaning = "wedge", "s |x|"
    wedge_slope = option(1.0, "s of the wedge", "u_n,r/beta", above=0)
    even = (0, 1)

    def gap(self, coordinates, scene):
        return self.wedge_slope * np.abs(coordinates[0])
''', "bodies/graded.py": '''
import numpy as np

from ...options.fields import option
from ..elasticity import Surface
from .body import Body


class Graded(Body):
    """A half-space that stiffens with depth."""

    name, meaning = "graded", "a half-space that stiffens with depth"
    graded_rate = option(0.5, "wave number of the grading", "1/beta", minimum=0)
    rigid_compliance = (0.0, 0.0)

    def surface(self, wavenumber):
        compliance = 2 / (np.asarray(wavenumber, dtype=float) + self.graded_rate)
        return Surface(compliance, compliance, compliance, 0 * compliance)
'''}


def test_a_new_shape_and_a_new_body_are_one_file_each(tmp_path):
    """In a copy of the package: help, checks, what has no effect, a solve and its archive."""
    shutil.copytree(ROOT / "contactsnes", tmp_path / "contactsnes",
                    ignore=shutil.ignore_patterns("*.pyc.*"))  # which are being written
    for name, text in NEW.items():
        (tmp_path / "contactsnes/interface" / name).write_text(text, encoding="utf-8")
    small = ("-scene_geometry", "wedge", "-scene_body", "graded", "-scene_points", "128",
             "-scene_period", "20", "-scene_normal_maugis", "1")
    path = ("-load_path", "normal_displacement=1; tangential_displacement=1")
    commands = [["run", *small, "-scene_wedge_slope", "-1", *path],
                ["info", *small, "-scene_poisson", "0.3", "-scene_wedge_slope", "2"],
                ["run", *small, *path, "-archive_file", "run.h5"], ["run", "-help"]]
    done = subprocess.run([sys.executable, "-c", "from contactsnes.commands.cli import main\n"
                           f"print('statuses', *[main(words) for words in {commands!r}])"],
                          cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)},
                          capture_output=True, text=True, check=False)
    assert done.stdout.endswith("statuses 2 0 0 0\n"), done.stdout + done.stderr
    assert "-scene_wedge_slope is '-1': allowed is" in done.stderr
    for told in ("-scene_poisson: the body graded has none", "-scene_wedge_slope 2\n",
                 "body graded", "  -scene_graded_rate\n", "wedge (s |x|)",
                 "  -scene_wedge_slope\n"):
        assert told in done.stdout, told
    scene = read(tmp_path / "run.h5").scene
    assert (scene["geometry"], scene["wedge_slope"], scene["body"], scene["graded_rate"]) == (
        "wedge", 1.0, "graded", 0.5)


@pytest.mark.parametrize("declared, words", (
    ({"even": 0}, "declares even = 0: allowed is a tuple of directions"),
    ({"uniform": (3,)}, "declares uniform = .3,."), ({"parabola": 1.0}, "declares parabola = 1.0"),
    ({"curvature": lambda self, scene: 1.0}, "curvature.scene. is 1.0: allowed is a tuple"),
    ({"curvature": lambda self, scene: 1 / 0}, "curvature cannot be had .ZeroDivisionError")))
@pytest.mark.parametrize("period", (20.0, math.inf))
def test_declarations_of_another_kind_are_told(declared, words, period):
    shape = type("Odd", (Shape,), {"gap": lambda self, x, scene: x[0] ** 2, **declared})()
    if math.isinf(period) and "parabola" not in declared:
        shape.parabola = {1: 1.0}
    with pytest.raises(InputError, match=words):
        with_parts(Scene(normal_maugis=1.0, period=period), geometry=shape)


def test_a_file_that_has_changed_since_it_was_read_is_told(written):
    """As in a notebook: the file is read once, and its text of then is used."""
    path = written()
    scene = Scene(**LINE, geometry=f"{path}:gap")
    before = last(scene).forces[0]
    path.write_text(FILE.replace("x ** 2 / 2", "x ** 2"), encoding="utf-8")
    with pytest.warns(UserWarning, match="gap': the file has changed since this program read it"):
        assert last(Scene(**LINE, geometry=f"{path}:gap")).forces[0] == before
    path.unlink()
    assert last(scene).forces[0] == before
