"""Methods of laws, shapes and bodies of one's own that cannot be called as they are, or fail: one
sentence each, that names them."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Body, Branch, InputError, Law, Load, Scene, Shape  # noqa: E402
from contactsnes.commands import cli  # noqa: E402
from contactsnes.commands.run import Run  # noqa: E402
from contactsnes.interface import bodies, laws, own_methods, shapes  # noqa: E402
from contactsnes.interface.bodies.layer import Layer  # noqa: E402
from contactsnes.interface.gap import evaluated  # noqa: E402
from contactsnes.output.reading import read  # noqa: E402

LINE = {"points": 128, "period": 20.0, "normal_maugis": 1.0}
PRESSED = Load(path="normal_displacement=1")


def parabola(self, coordinates, scene):
    """Gap of a cylinder."""
    return coordinates[0] ** 2 / 2


def tractions(self, a, b):
    """Of a law that holds at each place for itself."""
    return a * np.exp(-a), np.exp(-a)


def made(base, **methods):
    """An object of a class of one's own with some methods."""
    given = {Shape: {"gap": parabola}, Law: {"tractions": tractions}, Layer: {}}[base]
    return type("Mine", (base,), {**given, **methods})()


def refused(part):
    """What is said of an object of one's own."""
    kind = next(name for name, base in (("law", Law), ("geometry", Shape), ("body", Body))
                if isinstance(part, base))
    with pytest.raises(InputError) as caught:
        Branch(Scene(**LINE), PRESSED, **{kind: part})
    return str(caught.value)


@pytest.mark.parametrize("base, name, method, words", (
    (Shape, "check", lambda self: None, "whose check takes (), but is called with (scene);"),
    (Shape, "gap", lambda self, x: x, "whose gap takes (x), but is called with (coordinates, s"),
    (Shape, "memory", lambda self: 0, "whose memory takes ()"),
    (Shape, "heights", lambda self, scene: None, "but is called with (scene, grid=None)"),
    (Shape, "check", True, "whose check is True, but is called with (scene); make it a method"),
    (Shape, "check", property(lambda self: 1), "whose check is a property"),
    (Shape, "completed", lambda values: values, "whose completed is called on the class"),
    (Layer, "check", lambda self, scene: None, "(scene), but is called with (scene, sheared=Fals"),
    (Layer, "rigid_compliance", lambda self: (0, 0), "whose rigid_compliance is a method"),
    (Layer, "couples", False, "whose couples is False"),
    (Layer, "about", lambda self: [], "whose about takes ()"),
    (Law, "softening", lambda self: 1.0, "whose softening is a method, but is asked for as a val"),
    (Law, "potential", lambda self, gap: None, "is called with (gap, work_ratio=1.0)"),
))
def test_a_method_that_cannot_be_called_as_it_is(base, name, method, words):
    assert words in refused(made(base, **{name: method}))


@pytest.mark.parametrize("base, name, method", (
    (Shape, "memory", lambda self, scene: "much"), (Shape, "about", lambda self, scene, size: 5),
    (Shape, "filled", lambda self, scene: None), (Layer, "about", lambda self, scene, size: [3])))
def test_a_method_that_returns_something_else(base, name, method):
    assert f"whose {name} returns" in refused(made(base, **{name: method}))


def test_rows_that_are_promised():
    assert "no rows(grid, scene)" in refused(made(Shape, by_rows=True))


def test_parameters_may_have_other_names_and_more_defaults():
    shape = made(Shape, check=lambda self, where, strict=True: None, memory=staticmethod(
        lambda scene: 0), check_grid=lambda self, *scenes, **more: None)
    body = made(Layer, check=lambda self, *anything: None, about=lambda self, it, way: ["mine"])
    point = [*Branch(Scene(**LINE), PRESSED, geometry=shape, body=body)][-1]
    assert point.forces[0] == pytest.approx([*Branch(Scene(**LINE), PRESSED)][-1].forces[0])


FAILING = """
from contactsnes import Shape
from contactsnes.interface.bodies.layer import Layer

class Bowl(Shape):
    def gap(self, coordinates, scene):
        return coordinates[0] ** 2 / 2

    def check_grid(self, scene):
        return scene.nonsense

class Soft(Layer):
    def check(self, scene, sheared=False):
        return 1 / 0
"""


@pytest.mark.parametrize("option, name, words", (
    ("geometry", "Bowl", "its check_grid fails (AttributeError: 'Scene' object has no attribute "
     "'nonsense'; line 10 of the file); mend it"),
    ("body", "Soft", "its check fails (ZeroDivisionError: division by zero; line 14 of the file); "
     "mend it")))
def test_what_fails_in_a_file_is_told_with_its_line(tmp_path, monkeypatch, capsys, option, name,
                                                    words):
    for registry in (shapes.REGISTRY, bodies.REGISTRY):
        monkeypatch.setattr(registry, "own", {})
    (tmp_path / "mine.py").write_text(FAILING, encoding="utf-8")
    monkeypatch.chdir(tmp_path)

    def command(words, interrupts):
        Branch(Scene(**LINE, **{option: f"mine.py:{name}"}), PRESSED)

    monkeypatch.setattr(cli, "_begun", command)
    assert cli.main(["run"]) == 2
    said = capsys.readouterr().err
    assert f"-scene_{option} is 'mine.py:{name}': {words}" in said and "Traceback" not in said


LATE = """
from contactsnes.interface.laws.modified import Modified

class Late(Modified):
    broken = False

    def evaluate(self, *arguments):
        if self.broken:
            raise {error}("too late")
        return super().evaluate(*arguments)
"""


@pytest.mark.parametrize("error", ["ValueError", "SystemExit", "StopIteration"])
def test_a_law_that_fails_on_the_way_loses_no_points(error, tmp_path, monkeypatch, capsys,
                                                     kept_options):
    """What was there was not told, and that it was bad input; an end of the program ended it
    without a word, and that of an iteration looked like a defect of ours."""
    monkeypatch.setattr(laws.REGISTRY, "own", {})
    (tmp_path / "mine.py").write_text(LATE.format(error=error), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    accept = Run._accept

    def breaking(self, point):
        accept(self, point)
        laws.REGISTRY.own["mine.py:Late"].broken = self.progress.points == 3

    monkeypatch.setattr(Run, "_accept", breaking)
    assert cli.main(["run", "-scene_points", "256", "-scene_normal_maugis", "3", "-scene_law",
                     "mine.py:Late", "-load_path", "normal_displacement=9", "-archive_file",
                     "run.h5"]) == 1
    said = capsys.readouterr().err
    assert ("-scene_law is 'mine.py:Late': its evaluate fails "
            f"({error}: too late; line 9 of the file); mend it; 3 points are in ") in said
    assert "Traceback" not in said
    assert read("run.h5").points == 3


def test_nothing_is_asked_of_no_nodes_or_waves():
    """One of several processes may have none, where the law acts or at all: a smallest gap among
    them, which one process has, was an error there."""
    def evaluate(self, gap, traction, tangent=None):
        assert gap[0].min() < 30.0
        if tangent is not None:
            tangent[...] = np.eye(len(gap))[:, :, None]
        return np.multiply(gap, 1.0, out=traction)

    law = type("Mine", (Law,), {"evaluate": evaluate})()
    assert law.traction(np.empty((3, 0))).shape == (3, 0) == law.tangent(np.empty((3, 0))).shape[1:]
    assert np.array_equal(law.traction(np.ones((2, 1))), np.ones((2, 1)))

    def surface(self, wavenumber):
        assert wavenumber.max() > 0.0
        return Layer.surface(self, wavenumber)

    body, none = made(Layer, surface=surface), (np.empty((4, 0)), np.empty((1, 0)))
    for blocks in (body.compliance(none, 3), body.stiffness(none, 3), body.stiffness(none, 1)):
        assert all(block.shape == (4, 0) for block in blocks.values())

    def gap(self, coordinates, scene):
        return coordinates[0] ** 2 / 2 + 0.0 * coordinates[1].max()

    assert evaluated(made(Shape, gap=gap), (np.empty((0, 1)), np.empty((1, 4))),
                     Scene(dimension=2)).shape == (0, 4)


def test_what_fails_elsewhere_is_not_blamed_on_files():
    try:
        raise ValueError("ours")
    except ValueError as error:
        assert own_methods.blamed(error, (shapes.REGISTRY, bodies.REGISTRY)) == ""
