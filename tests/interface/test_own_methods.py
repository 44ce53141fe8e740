"""Methods of laws, shapes and bodies of one's own that cannot be called as they are, or fail: one
sentence each, that names them."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Body, Branch, InputError, Law, Load, Scene, Shape  # noqa: E402
from contactsnes.commands import cli  # noqa: E402
from contactsnes.commands.run import Run  # noqa: E402
from contactsnes.contact.energies import stored  # noqa: E402
from contactsnes.interface import bodies, laws, own_methods, shapes  # noqa: E402
from contactsnes.interface.bodies.layer import Layer  # noqa: E402
from contactsnes.interface.gap import evaluated  # noqa: E402
from contactsnes.interface.laws.modified import Modified  # noqa: E402
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
            {late}
        return super().evaluate(*arguments)
"""
FAILED = "-scene_law is 'mine.py:Late': its evaluate fails ({}: too late; line 9 of the file); men"


@pytest.mark.parametrize("late, words", [
    ("raise ValueError('too late')", FAILED.format("ValueError")),
    ("raise SystemExit('too late')", FAILED.format("SystemExit")),
    ("raise StopIteration('too late')", FAILED.format("StopIteration")),
    ("raise ZeroDivisionError('too late')", FAILED.format("ZeroDivisionError")),
    ("return None", "the law mine.py:Late: its evaluate returns another array than the traction "
     "that it is given, or none (None for an array (1, ")])
def test_a_law_that_fails_on_the_way_loses_no_points(late, words, tmp_path, monkeypatch, capsys,
                                                     kept_options):
    """What was there was not told, and that it was bad input; an end of the program ended it
    without a word, that of an iteration looked like a defect of ours, as what is no array did, and
    a division by zero like one of the solver."""
    monkeypatch.setattr(laws.REGISTRY, "own", {})
    (tmp_path / "mine.py").write_text(LATE.format(late=late), encoding="utf-8")
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
    assert words in said and "; 3 points are in " in said
    assert "Traceback" not in said
    assert read("run.h5").points == 3


class Fickle:
    """Does something else with what a method makes of its arguments once it has been called."""

    def __init__(self, method, change):
        self.method, self.change, self.late = method, change, False

    def __call__(self, *arguments):
        found = self.method(*arguments)
        return self.change(found, *arguments) if self.late else found


def late(branch, fickle):
    """What is said of a method that does something else after two points."""
    points = iter(branch)
    next(points), next(points)
    fickle.late = True
    with pytest.raises(InputError) as caught:
        [*points]
    return str(caught.value)


def untold(found, gap, traction, tangent=None):
    """A traction with a tangent that is nan."""
    if tangent is not None:
        tangent[...] = np.nan
    return found


@pytest.mark.parametrize("change, words", (
    (lambda found, *_: found.astype(complex), "or none (an array (1, 65) of complex128 for an arr"),
    (lambda found, *_: found.astype(int), "or none (an array (1, 65) of int64 for an array"),
    (lambda found, *_: found[:, :-1], "or none (an array (1, 64) of float64 for an array (1, 65)"),
    (lambda found, *_: found.tolist(), "or none (a list for an array (1, 65) of float64)"),
    (lambda found, *_: np.multiply(found, np.nan, out=found), "has no finite traction at the nor"),
    (untold, "has no finite tangent at the normal gap ")))
def test_a_law_that_does_something_else_on_the_way_is_told(change, words):
    """It ended somewhere with an error of NumPy, or as a failure of the solver."""
    fickle = Fickle(Modified().evaluate, change)
    law = type("Mine", (Modified,), {
        "evaluate": lambda self, gap, traction, tangent=None: fickle(gap, traction, tangent)})()
    said = late(Branch(Scene(**LINE), PRESSED, law=law), fickle)
    assert said.startswith("the law Mine") and words in said


def test_gaps_below_the_deepest_are_the_solvers_own():
    """Steps that are too long end there; what a law makes of them is no fault of it."""
    def evaluate(self, gap, traction, tangent=None):
        far = gap[0] < -31.5
        super(cls, self).evaluate(gap, traction, tangent)
        traction[0, far] = np.inf
        return traction

    cls = type("Mine", (Modified,), {"evaluate": evaluate})
    contact = Branch(Scene(**LINE), PRESSED, law=cls()).contact
    assert np.isinf(contact.law.traction(np.array([[-32.0]])))


@pytest.mark.parametrize("change, words", (
    (lambda found, gap, ratio: found[:-1], "returns an array (64,) of float64 for 65 nodes: it"),
    (lambda found, gap, ratio: 1 / 0, "cannot be evaluated (ZeroDivisionError: division by zero)")))
def test_a_potential_that_is_something_else_on_the_way_is_told(change, words):
    fickle = Fickle(Modified().potential, change)
    law = type("Mine", (Modified,), {
        "potential": lambda self, gap, work_ratio=1.0: fickle(gap, work_ratio)})()
    branch = Branch(Scene(**LINE), PRESSED, law=law)
    point = next(iter(branch))
    fickle.late = True
    with pytest.raises(InputError) as caught:
        stored(branch.contact, point)
    said = str(caught.value)
    assert "the law Mine" in said and f"has a potential(gap, work_ratio) that {words}" in said


@pytest.mark.parametrize("change, words", (
    (lambda found, q: None, "surface returns a NoneType in place of a Surface(normal, long"),
    (lambda found, q: found._replace(normal=found.normal[1:]), "its normal compliance has the sha"),
    (lambda found, q: found._replace(normal=1j * q), "its normal compliance is "),
    (lambda found, q: found._replace(coupling=q * np.nan), "its coupling compliance is nan at")))
@pytest.mark.parametrize("dimension", (1, 2))
def test_a_body_that_is_something_else_on_the_way_is_told(change, words, dimension):
    """It ended somewhere with an error of NumPy, or as a failure of the solver."""
    fickle = Fickle(Layer(0.5, 2000.0).surface, change)
    body = made(Layer, surface=lambda self, q: fickle(q))
    geometry = ("cylinder", "sphere")[dimension - 1]
    contact = Branch(Scene(dimension=dimension, geometry=geometry, points=32, period=20.0), PRESSED,
                     body=body).contact
    fickle.late = True
    with pytest.raises(InputError) as caught:
        contact.body.compliance(contact.grid.wavevectors(), dimension + 1)
    assert "-scene_body is 'Mine" in str(caught.value) and words in str(caught.value)


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
