"""Laws that declare themselves: what follows from their tractions, and laws of one's own."""

import dataclasses
import hashlib
import math
import pickle
from pathlib import Path

import numpy as np
import pytest

from contactsnes import Branch, Contact, Form, InputError, Load, Scene
from contactsnes.branch.accuracy import Estimator
from contactsnes.branch.advice import advice
from contactsnes.interface import laws, own_laws
from contactsnes.interface.laws.law import Law
from contactsnes.interface.laws.mcgarry import McGarry
from contactsnes.interface.laws.modified import Modified
from contactsnes.options.fields import Options, extend, option
from contactsnes.scene import settings
from contactsnes.scene.parts import about_law
from contactsnes.scene.resolution import resolution

SMALL = {"points": 128, "period": 20.0, "normal_maugis": 1.0}


class Sticking(Law):
    """a exp(-a), and a spring of its own stiffness along the surface, wherever it is."""

    stiffness = option(0.5, "stiffness along the surface", minimum=0)
    slip_options = ("stiffness",)

    def evaluate(self, gap, traction, tangent=None):
        decay, a = np.exp(-gap[0]), gap[0].copy()
        if tangent is not None:
            tangent[...] = self.stiffness * np.eye(len(gap))[:, :, None]
            tangent[0, 0] = (1.0 - a) * decay
        np.multiply(gap, self.stiffness, out=traction)
        traction[0] = a * decay
        return traction


class Sampled(Modified):
    """The modified law, of which nothing is known but its tractions."""

    normal = Law.normal
    normal_peak = Law.normal_peak
    tangential_peak = Law.tangential_peak
    slip_peak = Law.slip_peak
    softening = Law.softening
    slip_softening = Law.slip_softening


@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0])
def test_what_follows_from_the_tractions(friction):
    sampled, exact = Sampled(friction), Modified(friction)
    for name in ("normal_peak", "tangential_peak", "softening"):
        assert getattr(sampled, name) == pytest.approx(getattr(exact, name), rel=1e-6), name
    assert sampled.slip_peak == pytest.approx(exact.slip_peak, abs=2e-4)
    assert sampled.slip_softening == pytest.approx(exact.slip_softening, rel=1e-6, abs=1e-14)
    a, w = np.array([-3.0, 0.0, 2.0, 40.0]), np.array([-700.0, -0.1, 0.0, 3.0, 50.0])
    np.testing.assert_array_equal(sampled.regularised(a, 0.2), exact.regularised(a, 0.2))
    np.testing.assert_allclose(sampled.gap_of_regularised(w, 0.2), exact.gap_of_regularised(w, 0.2),
                               rtol=1e-9)


def test_steepest_slip_softening_of_mcgarry():
    assert McGarry().slip_softening == pytest.approx(Law._slipped.func(McGarry())[2], rel=1e-6)


def test_laws_are_found_in_their_files():
    assert {"mcgarry", "modified"} <= set(laws.LAWS)
    assert all(cls.name == name and cls.meaning and cls.__doc__ for name, cls in laws.LAWS.items())
    assert Scene.rule("law")["choices"] == tuple(laws.LAWS)
    fields = {field.name: field for field in dataclasses.fields(Scene)}
    for cls in laws.LAWS.values():
        for name, field in cls.declared().items():
            assert fields[name].metadata == field.metadata and fields[name].default == field.default


def test_options_of_a_law_are_checked_as_those_of_a_scene():
    for made in (Modified, Scene):
        with pytest.raises(InputError, match="-scene_residual_friction is '2': allowed is"):
            made(residual_friction=2)
    assert laws.of(Scene(residual_friction=0.25)).residual_friction == 0.25
    assert laws.of(Scene(poisson=0.3)) is laws.of(Scene())
    with pytest.raises(TypeError, match="-scene_poisson is declared twice"):
        extend(Scene, {"poisson": option(0.1, "another")})
    with pytest.raises(TypeError, match="is not made by option"):
        type("Bare", (Law,), {"length": dataclasses.field(default=1.0)})


def test_scenes_before_an_extension_have_its_default():
    @dataclasses.dataclass(frozen=True, repr=False)
    class Few(Options):
        prefix = "few_"
        one: int = option(1, "one")

    before = Few()
    extend(Few, {"two": option(2, "two", minimum=2)})
    assert (before.two, Few(two=3).two, Few(1, 4).two) == (2, 3, 4)
    assert Few(two=2) == before and repr(Few(two=3)).endswith("Few(two=3)")
    with pytest.raises(InputError, match="-few_two is '1'"):
        Few(two=1)
    with pytest.raises(dataclasses.FrozenInstanceError):
        before.two = 3


def last(law, **changes):
    branch = Branch(Scene(**{**SMALL, **changes}), Load("normal_displacement=2",
                                                        "tangential_displacement=0.5"), law=law)
    return branch, list(branch)[-1]


def test_a_branch_of_a_law_of_ones_own():
    """A spring along the surface moves as a whole: its force is the slip's, over that of the layer
    in series."""
    branch, point = last(Sticking(0.3))
    assert branch.contact.law.stiffness == 0.3
    slip = point.state.displacement[1]
    assert point.forces[1] == pytest.approx(0.3 * branch.contact.grid.node_area * np.sum(slip),
                                            rel=1e-6)
    assert branch.attributes()["law"] == "Sticking(stiffness=0.3)"
    other, stiffer = last(Sticking(0.6))
    assert (other.attributes()["law"] == "Sticking(stiffness=0.6)"
            and stiffer.forces[1] > point.forces[1])
    assert resolution(branch.scene, True) == pytest.approx(resolution(branch.scene, False))


def test_an_object_of_a_named_law_is_that_law():
    branch, point = last(Modified(0.4))
    named, same = last(None, residual_friction=0.4)
    assert branch.attributes() == named.attributes()
    np.testing.assert_array_equal(point.state.displacement, same.state.displacement)


def test_objects_that_look_alike_are_told_apart():
    class Blunt(Sticking):
        """Says nothing of itself."""

        def __repr__(self):
            return "Blunt"

    one, two = Blunt(0.1), Blunt(0.2)
    first, second = Contact(Scene(**SMALL), law=one), Contact(Scene(**SMALL), law=two)
    assert (first.scene.law, second.scene.law) == ("Blunt", "Blunt 2")
    assert laws.of(first.scene) is one and laws.of(second.scene) is two
    assert Contact(first.scene).law is one


def test_names_of_options_that_change_nothing():
    load = Load("normal_displacement=1", "normal_displacement=2")
    names = ["scene_residual_friction", "scene_residual_adhesion"]
    why = dict(settings.ineffective(Scene(law="mcgarry"), load, names))
    assert set(why) == set(names) and "the law mcgarry has none" in why["scene_residual_friction"]
    why = dict(settings.ineffective(Scene(), load, names))
    assert set(why) == set(names) and "no tangential unknown" in why["scene_residual_adhesion"]
    sheared = Load("normal_displacement=1", "tangential_displacement=2")
    assert not settings.ineffective(Scene(), sheared, names)


def test_archives_tell_of_the_options_that_they_told_of():
    for law in ("modified", "mcgarry"):
        told = settings.attributes(Scene(law=law))
        assert (told["law"] == law and told["residual_friction"] == 1.0
                and told["residual_adhesion"] == 0.0)


def test_regularised_steps_need_a_stiffness_above_the_softening():
    from contactsnes.contact.forms import DisplacementForm
    from contactsnes.solvers.regularised import RegularisedStep

    class Brittle(Sticking):
        """Ten times as short."""

        def evaluate(self, gap, traction, tangent=None):
            shorter = np.array(gap)
            shorter[0] *= 10.0
            super().evaluate(shorter, traction, tangent)
            if tangent is not None:
                tangent[:, 0] *= 10.0
            return traction

    contact = Contact(Scene(**SMALL), law=Brittle())
    form = DisplacementForm(contact, contact.grid.whole, ("displacement",))
    assert contact.law.softening == pytest.approx(10 * math.exp(-2), rel=1e-3)
    given = RegularisedStep(form, None).newton_stiffness
    assert given == pytest.approx(15 * math.exp(-2), rel=1e-3)
    with pytest.raises(InputError, match="-snes_regularised_stiffness is '0.2': allowed "
                       "is a number above the law's"):
        RegularisedStep(form, 0.2)


# In a file of one's own

FILE = """
import numpy as np
from contactsnes import Law, option

class Drag(Law):
    "a exp(-a), and a drag."
    drag_strength = option(0.5, "friction", minimum=0)
    slip_options, gap_corners, slip_peak = ("drag_strength",), ({corners}), 1.0

    def evaluate(self, gap, traction, tangent=None):
        a, slip = gap[0].copy(), gap[1:].copy()
        root = np.sqrt(1 + np.sum(slip ** 2, axis=0))
        held = self.drag_strength * np.exp(-np.maximum(a, 0))
        if tangent is not None:
            tangent[0, 1:] = 0
            tangent[0, 0] = {normal}
            tangent[1:, 0] = -held * (a > 0) * slip / root
            identity = np.eye(len(slip))[:, :, None]
            tangent[1:, 1:] = held * (identity / root - {along} * slip[:, None] * slip / root ** 3)
        traction[0] = {traction}
        traction[1:] = held * slip / root
        return traction
"""
RIGHT = {"corners": "0.0,", "normal": "(1 - a) * np.exp(-a)", "along": "1.0",
         "traction": "a * np.exp(-a)"}


@pytest.fixture
def written(tmp_path, monkeypatch):
    """A function that writes a law, with changes, and gives its name; what it enters is
    forgotten."""
    monkeypatch.setattr(laws.REGISTRY, "own", {})
    monkeypatch.setattr(laws.REGISTRY, "options", dict(laws.REGISTRY.options))
    names = ("__init__", "__eq__", "__repr__", "__hash__", "__match_args__", "__dataclass_fields__")
    for name in names:
        monkeypatch.setattr(Scene, name, getattr(Scene, name))

    def write(**changes):
        path = tmp_path / f"law{len(list(tmp_path.iterdir()))}.py"
        path.write_text(FILE.format(**{**RIGHT, **changes}), encoding="utf-8")
        return f"{path}:Drag"

    yield write
    if "drag_strength" in vars(Scene):
        del Scene.drag_strength


def test_a_law_in_a_file_is_one_of_the_laws(written):
    scene = Scene(law=written(), drag_strength=0.3, **SMALL)
    assert scene.drag_strength == 0.3 and laws.of(scene).drag_strength == 0.3
    assert laws.of(dataclasses.replace(scene, drag_strength=0.4)).drag_strength == 0.4
    told = settings.attributes(scene)
    assert told["law"] == scene.law and told["drag_strength"] == 0.3
    assert "drag_strength" not in settings.attributes(Scene())
    with pytest.raises(InputError,
                       match="-scene_drag_strength is '-1': allowed is a number at least 0"):
        Scene(law=scene.law, drag_strength=-1)
    load = Load("normal_displacement=1", "tangential_displacement=2")
    names = ["scene_residual_friction", "scene_drag_strength"]
    assert [name for name, _ in settings.ineffective(scene, load, names)] == names[:1]
    assert [name for name, _ in settings.ineffective(Scene(), load, names)] == names[1:]
    *_, point = Branch(scene, load)
    assert point.forces[1] > 0.0


def test_an_archive_knows_the_law_by_its_file(written):
    """A file that says something else later is another law, whatever its name."""
    load, name = Load("normal_displacement=1", "normal_displacement=2"), written()
    told = Branch(Scene(law=name, **SMALL), load).attributes()
    assert told["law_sha256"] == hashlib.sha256(
        Path(name.rpartition(":")[0]).read_bytes()).hexdigest()
    assert "law_sha256" not in Branch(Scene(**SMALL), load).attributes()


@pytest.mark.parametrize("change, words",
                         [({"normal": "np.exp(-a)"},
                           r"d t_0 / d g_0 is .*, but differences of t_0 give"),
                          ({"along": "0.0"}, r"the slip .* d t_1 / d g_1 is"),
                          ({"corners": ""}, None), ({"traction": "a * np.exp(-a) + 0.1 * "
                                                     "np.tanh(20 * gap[0])"}, "d t_0 / d g_0"),
                          ({"traction": "a * np.exp(-a) + 0.1"}, "normal traction 0.1 at "
                           "the normal gap 0 without slip: it has to be 0"),
                          ({"traction": "a * np.exp(-0.5 * a)",
                            "normal": "(1 - 0.5 * a) * np.exp(-0.5 * a)"}, "end of the range"),
                          ({"traction": "undefined"}, "cannot be evaluated with 1 "
                           "component.s. .NameError"),])
def test_what_is_wrong_with_a_law_is_told(written, change, words):
    name = written(**change)
    if words is None:  # nothing is looked at across a corner, declared or not
        Scene(law=name)
        return
    with pytest.raises(InputError, match=words) as error:
        Scene(law=name)
    assert "Drag" in str(error.value)


def test_names_of_files_and_classes_are_checked(written, tmp_path):
    name = written()
    for wrong, words in ((name + "s", "has no law 'Drags': its laws are Drag; try .*:Drag"),
                         ("nowhere.py:Drag", "there is no file 'nowhere.py'")):
        with pytest.raises(InputError, match=words):
            Scene(law=wrong)
    (tmp_path / "broken.py").write_text("1 / 0", encoding="utf-8")
    with pytest.raises(InputError, match="does not run .ZeroDivisionError"):
        Scene(law=f"{tmp_path / 'broken.py'}:Drag")
    (tmp_path / "taken.py").write_text("from contactsnes import Law, option\nclass "
                                       "Taken(Law):\n    poisson = option(0.1, "
                                       "'mine')\n", encoding="utf-8")
    with pytest.raises(InputError, match="-scene_poisson is declared twice, differently: give"):
        Scene(law=f"{tmp_path / 'taken.py'}:Taken")


def test_the_databases_law_brings_its_options(written, kept_options):
    from contactsnes.options.database import check_names, install, read
    from contactsnes.options.help import help_text

    name = written()
    install({"scene_law": name, "scene_drag_strength": "0.7"})
    check_names()
    scene = read(Scene)
    assert (scene.law, scene.drag_strength) == (name, 0.7) and "-scene_drag_strength" in help_text()


@pytest.mark.parametrize("cls", laws.LAWS.values(), ids=str)
def test_the_packages_laws_pass_what_is_asked_of_ones_own(cls):
    own_laws.check(cls(), cls.name)


def test_help_tells_of_the_options_of_a_law_in_a_file(written, monkeypatch):
    from contactsnes.commands import cli, session

    monkeypatch.setattr(session, "told", lambda text: text)
    monkeypatch.setattr(session, "begin_petsc", lambda words: None)
    assert "-scene_drag_strength" in cli.info(["-scene_law", written(), "-help"])
    assert "-scene_law" in cli.info(["nowhere.opts", "-help"])


class Lifting(Modified):
    """A friction of its own, without the energy and the numbers that go with it."""

    def friction(self, slip):
        return 2.0 * super().friction(slip)


class Stepping(Sampled):
    """A friction that falls by half at a slip of 1.23."""

    def friction(self, slip):
        return np.where(slip > 1.23, 0.5, 1.0) * super().friction(slip)


class Hoping(Modified):
    """A softening that its tractions do not have."""

    softening = 1e-3


class Repelling(Law):
    """No attraction."""

    gap_corners = (0.0,)

    def evaluate(self, gap, traction, tangent=None):
        a = np.minimum(gap[0], 0.0)
        if tangent is not None:
            tangent[...] = 0.0
            tangent[0, 0] = np.exp(-a) * (a < 0.0)
        traction[1:] = 0.0
        traction[0] = 1.0 - np.exp(-a)
        return traction


class Spoken(Law):
    """a exp(-a), and 2 b exp(-b^2 - a): it is right, until it declares something."""

    gap_corners = (0.0,)

    def tractions(self, a, b):
        return a * np.exp(-a), 2.0 * np.exp(-b * b - np.maximum(a, 0.0))


class Worded(Sticking):
    """A range in letters."""

    range = "37"


class Sloping(Sticking):
    """A tangent that is one hundredth too large."""

    def evaluate(self, gap, traction, tangent=None):
        super().evaluate(gap, traction, tangent)
        if tangent is not None:
            tangent *= 1.01
        return traction


class Removable(Law):
    """Divides by zero at a gap of 2, where the quotient has a limit."""

    def tractions(self, a, b):
        return a * np.exp(-a) * (a - 2.0) / (a - 2.0), np.exp(-b * b - np.maximum(a, 0.0))


class Farther(Removable):
    """The same at the gap 20."""

    def tractions(self, a, b):
        return (a * np.exp(-a) * (1.0 + 1e-9 / (a - 20.0)),
                np.exp(-b * b - np.maximum(a, 0.0)))


class Pole(Removable):
    """Goes to infinity at a gap between places that are looked at."""

    def tractions(self, a, b):
        return (a * np.exp(-a) * (1.0 + 1e-3 / (a - 1.73213)),
                np.exp(-b * b - np.maximum(a, 0.0)))


class PoleOfSlip(Removable):
    """Goes to infinity at a slip between places that are looked at."""

    def tractions(self, a, b):
        return a * np.exp(-a), (np.exp(-b * b) + 1e-4 / (b - 1.23457)) * np.exp(-np.maximum(a, 0.0))


class Logarithmic(Sticking):
    """No finite traction at a slip of 1.5, from an evaluate of its own."""

    def evaluate(self, gap, traction, tangent=None):
        slip = np.abs(gap[1:]).sum(axis=0)
        super().evaluate(gap, traction, tangent)
        traction[1:] += np.where(slip == 1.5, np.log(np.abs(slip - 1.5)), 0.0)
        return traction


class Clipping(Sampled):
    """Writes into the gaps that it is given."""

    def evaluate(self, gap, traction, tangent=None):
        np.minimum(gap, 5.0, out=gap)
        return super().evaluate(gap, traction, tangent)


class Bilinear(Law):
    """Its corners are where laws are looked at, too."""

    gap_corners, slip_corners = (0.0, 1.0, 2.5), (1.0, 3.0)
    slip_peak = 1.0

    def tractions(self, a, b):
        opened = np.where(a < 1.0, a, np.where(a < 2.5, (2.5 - a) / 1.5, 0.0 * a))
        secant = np.where(b < 1.0, 1.0, np.where(b < 3.0, (3.0 - b) / (2.0 * b), 0.0 * b))
        return opened, 0.1 * secant * np.exp(-np.maximum(a, 0.0))


def test_corners_where_laws_are_looked_at_are_corners_all_the_same():
    own_laws.check(Bilinear(), "Bilinear")


class Ending(Law):
    """Attraction that ends in a corner, where its range does."""

    range = opening_range = 4.0
    gap_corners, slip_peak = (0.0, 1.0, 4.0), 1.0

    def tractions(self, a, b):
        opened = np.where(a < 1.0, a, np.where(a < 4.0, (4.0 - a) / 3.0, 0.0 * a))
        return 0.4 * opened, 0.1 * np.exp(-b * b) * np.clip(1.0 - a / 4.0, 0.0, 1.0)


def test_a_law_that_acts_up_to_its_range_acts_at_all_nodes():
    """Those beyond 30/37 of the range, where a exp(-a) is nothing, were left out of windows: points
    balanced on these, but not beside them."""
    law, both = Ending(), []
    scene = Scene(points=160, period=24.0, normal_maugis=2.0, height=math.inf)
    for window in ("auto", "off"):
        *_, point = Branch(scene, Load("normal_displacement=-2", "normal_displacement=-1.97"),
                           form=Form(window=window), law=law)
        both.append(point.forces[0])
    assert both[0] == pytest.approx(both[1], rel=1e-6)
    assert law.certain == 4.0 < law.reach and Modified().reach == Law.range


def scaled(size):
    """A law of a exp(-a) in which all lengths are longer."""
    def tractions(self, a, b):
        opened, slid = a / size, b / size
        return (opened * np.exp(-opened) / size,
                0.6 / size ** 2 * np.exp(-0.5 * slid ** 2 - np.maximum(opened, 0.0)))

    return type("Scaled", (Law,), {
        "tractions": tractions, "range": 37.0 * size, "deepest": -30.0 * size, "repulsion": size,
        "opening_range": 5.0 * size, "slip_range": 6.0 * size, "gap_corners": (0.0,),
        "slip_peak": size})()


@pytest.mark.parametrize("size, words", (
    (20.0, "attracts by half of its peak up to a gap of 53.6 ranges, .* with s = 20 take"),
    (0.05, "up to a gap of 0.134 ranges, .* with s = 0.05 take s N")))
def test_laws_whose_lengths_are_far_from_a_range_are_refused(size, words):
    """Their folds were passed without a word: these are told by parts of a range."""
    for usual in (0.2, 1.0, 2.5):
        own_laws.check(scaled(usual), "Scaled")
    with pytest.raises(InputError, match=words):
        own_laws.check(scaled(size), "Scaled")


def test_a_jump_from_where_a_long_law_hardly_acts():
    """Such a kick was of no length, by which lengths were divided."""
    scene = Scene(points=64, period=16.0, normal_maugis=5.8, tangential_maugis=2.9, height=math.inf,
                  tangential="on")
    *_, point = Branch(scene, Load("normal_displacement=-3", "normal_force=2"), law=scaled(2.9))
    assert point.forces[0] == pytest.approx(2.0) and point.in_contact


@pytest.mark.parametrize("cls, words", (
    (Removable, "no finite N at the normal gap 2 .*divide.* has the arguments 0, 0"),
    (Farther, "no finite N at the normal gap 20 "), (Pole, "t_0 that jumps .* gap 1.73213 "),
    (PoleOfSlip, "t_1 that jumps .* slip 1.23457 "),
    (Logarithmic, "no finite traction at the normal gap -1 and the slip 1.5 "),
    (Lifting, "tangential_peak = 0.857.*, but its tractions give 1.71"),
    (Stepping, "t_1 that jumps by 0.42.* at .* the slip 1.23"),
    (Hoping, "softening = 0.001, .* give 0.135"), (Repelling, "attracts nowhere"),
    (Worded, "range = '37': allowed is a number"), (Sloping, "differences of t_0 give"),
    (Clipping, "its evaluate writes into the gaps that it is given")))
def test_what_is_wrong_with_an_object_is_told(cls, words):
    """What a base declares of other tractions, too: resolution and energies follow from it."""
    with pytest.raises(InputError, match=words):
        Branch(Scene(**SMALL), Load(path="normal_displacement=1"), law=cls())


@pytest.mark.parametrize("what, value, words", (
    ("range", 2.0, "the normal traction 0.270671 at the normal gap 2 without slip"),
    ("deepest", 1.0, "deepest = 1.0: allowed is a number below 0"),
    ("repulsion", 0.0, "repulsion = 0.0: allowed is a number above 0"),
    ("slip_range", -2.0, "slip_range = -2.0: allowed is a number above 0"),
    ("gap_corners", 0.0, "gap_corners = 0.0: allowed is a tuple of numbers"),
    ("slip_corners", "ab", "slip_corners = 'ab': allowed is a tuple of numbers"),
    ("slip_options", ("friction",), "slip_options = .*: allowed is a tuple of names of its opt"),
    ("derived", ("missing",), "derived = .*: allowed is a tuple of names of its properties"),
    ("slip_peak", None, "slip_peak = None: allowed is a number above 0"),
    ("slip_peak", 0.0, "slip_peak = 0.0: allowed is a number above 0"),
    ("newton_stiffness", -3.0, "newton_stiffness = -3.0: allowed is a number above 0.135335"),
    ("moving_stiffness", (1, 2), "moving_stiffness = .*: allowed is a number above 0.135335"),
    ("coupled_softening", lambda self, normal: 1.0, "coupled_softening takes .normal., but is"),
    ("coupled_softening", lambda self, normal, tangential: 0.0,
     "coupled_softening of 0 at Maugis parameters of 1, but its tractions give 0.8925"),
    ("coupled_softening", lambda self, normal, tangential: self.no_such,
     "coupled_softening.* cannot be evaluated"),
    ("potential", lambda self, gap: None, "potential takes .gap., but is called with"),
    ("potential", lambda self, gap, work_ratio=1.0: self.no_such,
     "potential.gap, work_ratio. that cannot be evaluated"),
))
def test_what_an_object_declares_wrongly_is_told(what, value, words):
    with pytest.raises(InputError, match=words):
        Branch(Scene(**SMALL), Load(path="normal_displacement=1"),
               law=type("Declaring", (Spoken,), {what: value})())


def test_a_potential_of_other_tractions_is_told():
    law = type("Doubled", (Lifting,), {"tangential_peak": Law.tangential_peak,
                                       "slip_softening": Law.slip_softening})()
    with pytest.raises(InputError, match="differences of its potential along g_1 are not"):
        own_laws.check(law, "Doubled")


def test_a_long_range_is_sampled_where_the_law_is_steep():
    """a / (1 + a)^3 rises to 4/27 at 1/2, and falls by up to 1/16, at 1."""
    def tractions(self, a, b):
        opened = 1.0 + np.maximum(a, 0.0)
        return (np.where(a > 0.0, a / opened ** 3, 1.0 - np.exp(-np.minimum(a, 0.0))),
                2.0 * np.exp(-b * b) / opened ** 3)

    law = type("Slow", (Law,), {"tractions": tractions, "range": 1e5, "gap_corners": (0.0,)})()
    own_laws.check(law, "Slow", in_file=False)
    assert law.normal_peak == pytest.approx(4 / 27, rel=1e-6)
    assert law.softening == pytest.approx(1 / 16, rel=1e-6)


class Hindered(Law):
    """a exp(-a), and a repulsion around a gap of 4 before it, as of a double layer."""

    opening_range = 12.0

    def tractions(self, a, b):
        return a * np.exp(-a) - 0.2 * a * np.exp(-(a - 4.0) ** 2), 0.3 * np.exp(-a)


def test_a_law_that_repels_before_it_attracts():
    """Gaps of the regularised gap were sought below it, and states that were moved lay elsewhere:
    no step was found."""
    law = Hindered()
    a = np.linspace(-5.0, 9.0, 141)
    np.testing.assert_allclose(law.gap_of_regularised(law.regularised(a, 1.2), 1.2), a, atol=1e-8)
    scene = Scene(**SMALL, height=math.inf)
    branch = Branch(scene, Load("normal_displacement=0", "normal_displacement=1"), law=law)
    *_, point = branch
    displacement = branch.contact.extended(point.state)[0]
    x = 20.0 / 128 * np.arange(-64, 64)
    waves = 2.0 * np.pi * np.fft.rfftfreq(128, 20.0 / 128)
    balance = (np.fft.rfft(law.normal(x * x / 2.0 + displacement)[0])[1:] * 2.0 / waves[1:]
               + np.fft.rfft(displacement)[1:])
    assert displacement.mean() == pytest.approx(-1.0) and np.max(np.abs(balance)) < 1e-5


def test_a_barrier_that_tractions_do_not_have_is_told():
    law = type("Free", (Hindered,), {"barrier": 0.0})()
    with pytest.raises(InputError, match="Free declares barrier = 0, .* tractions give 0.746"):
        own_laws.check(law, "Free")


def unfilled(self, gap, traction, tangent=None):
    """Tractions a exp(-a) in an array of their own."""
    a = gap[0].copy()
    if tangent is not None:
        tangent[...] = 0.0
        tangent[0, 0] = (1.0 - a) * np.exp(-a)
    return np.concatenate([[a * np.exp(-a)], 0.0 * gap[1:]])


def unreturned(self, gap, traction, tangent=None):
    """The same filled in, and no more."""
    traction[...] = unfilled(self, gap, traction, tangent)


def holed(self, gap, traction, tangent=None):
    """The same but at the gap 0.123, between places of lines."""
    hole = np.abs(gap[0] - 0.123) < 2e-4
    unreturned(self, gap, traction, tangent)
    traction[0, hole] = np.nan
    return traction


def deep(self, gap, traction, tangent=None):
    """The same but in deep overlap."""
    unreturned(self, gap, traction, tangent)
    traction[0, gap[0] < -20.0] = np.nan
    return traction


def untangent(self, gap, traction, tangent=None):
    """The same with a tangent that divides by nothing."""
    unreturned(self, gap, traction, tangent)
    if tangent is not None:
        tangent[0, 0, gap[0] < -20.0] = np.inf
    return traction


@pytest.mark.parametrize("evaluate, words", [
    (deep, "has no finite traction beside the normal gap -31 .ranges.; mend it"),
    (untangent, "has no finite tangent at the normal gap -31 .ranges.; mend it"),
    (unfilled, "its evaluate returns another array than the traction that it is given, or none"),
    (unreturned, "its evaluate returns another array than the traction that it is given, or none"),
    (holed, "a normal traction or tangent that is not finite at some gap from 0 to 37")])
def test_an_evaluate_that_does_not_fill_its_traction_is_told(evaluate, words):
    with pytest.raises(InputError, match=words):
        own_laws.check(type("Idle", (Law,), {"evaluate": evaluate})(), "Idle")


@pytest.mark.parametrize("line, words", [
    ("ab = option((1.0, 2.0), 'two')", "has the default .1.0, 2.0., but is a number, a text"),
    ("x = option(None, 'none')", "has the default None, but is a number, a text"),
    ("x: float = 0.4", "Odd.x is not made by option")])
def test_options_that_are_none_are_told(line, words, tmp_path):
    (tmp_path / "odd.py").write_text("from contactsnes import Law, option\n\n"
                                     f"class Odd(Law):\n    {line}\n", encoding="utf-8")
    with pytest.raises(InputError, match=f"odd.py' does not run .TypeError: .*{words}"):
        Scene(law=f"{tmp_path / 'odd.py'}:Odd")


def test_defaults_of_options_may_be_numpys():
    assert option(np.float64(0.5), "half").metadata["kind"] == "number"
    assert option(np.int64(2), "two").metadata["kind"] == "integer"


def test_options_of_an_object_in_use_cannot_be_set():
    """Laws that NumPy evaluates changed on the way, the archive told of the first."""
    law = Sticking(0.3)
    law.stiffness = 0.4
    branch = Branch(Scene(**SMALL), Load(path="normal_displacement=1"), law=law)
    with pytest.raises(AttributeError, match="0.4. is in use, its stiffness cannot be set: make"):
        law.stiffness = 0.5
    with pytest.raises(AttributeError, match="in use"):
        branch.contact.law.stiffness = 0.5
    assert branch.contact.law.stiffness == 0.4


def frictionless(self, a, b):
    return a * np.exp(-a), 0.0


def test_a_law_without_friction_is_one():
    law = type("Smooth", (Law,), {"tractions": frictionless})()
    scene = Scene(**SMALL, poisson=0.0, height=math.inf)
    *_, point = Branch(scene, Load(path="normal_displacement=1"), law=law)
    alone = Branch(Scene(**SMALL, height=math.inf), Load(path="normal_displacement=1"), law=law)
    assert law.slip_peak == 1.0 and len(point.forces) == 2
    # what slips without resistance presses as one that does not couple
    assert point.forces.tolist() == pytest.approx([[*alone][-1].forces[0], 0.0], abs=1e-7)


class Coulomb(Law):
    """a exp(-a), and friction in proportion to the pressure."""

    coefficient = option(0.3, "friction over pressure", minimum=0)
    gap_corners = (0.0,)

    def tractions(self, a, b):
        normal = a * np.exp(-a)
        return normal, (self.coefficient * np.maximum(-normal, 0.0)
                        * np.where(b > 0, np.tanh(b / 0.1) / b, 10.0))


def test_friction_that_is_there_under_pressure_only_is_measured_there():
    law = Coulomb()
    assert law.tangential_peak == 0.0 and law.friction_size == pytest.approx(0.3 * np.e)
    assert 0.5 < law.slip_peak < 1.5  # where the hyperbolic tangent is one to 1e-10
    assert law.slip_softening < 1e-12
    assert Coulomb(0.0).friction_size == Coulomb(0.0).slip_peak == 1.0
    assert Modified(0.3).friction_size == Modified(0.3).tangential_peak
    rounded = type("Rounded", (Coulomb,), {"tractions": lambda self, a, b: Coulomb.tractions(
        self, a - 1e-17 * (a <= 0), b)})()
    assert rounded.traction(np.array([[0.0], [1.0]]))[1, 0] > 0.0
    assert rounded.tangential_peak == 0.0 and rounded.friction_size == law.friction_size


def test_errors_of_a_law_whose_friction_is_there_under_pressure_only():
    branch = Branch(Scene(**SMALL), Load(path="normal_displacement=1; tangential_displacement=1"),
                    law=Coulomb())
    errors = [Estimator(branch.contact)(point) for point in branch]
    assert errors[0].tangential_force == errors[0].slip == 0.0
    assert np.isfinite([error.tangential_force for error in errors]).all()


def test_advice_on_friction_that_is_there_under_pressure_only():
    """It has no strength that theory could take."""
    load = Load(path="normal_displacement=1; tangential_displacement=1")
    scene = Scene(**SMALL, height=10.0)
    for law, known in ((Coulomb(), False), (Sampled(), True)):
        lines = "\n".join(advice(Branch(scene, load, law=law).scene, load, settings.Output(),
                                 lambda value, unit, digits: f"{value:.3g} {unit}"))
        assert "inf" not in lines
        assert ("of the slip" in lines) == ("slip comes" in lines) == ("tau_max" in lines) == known


def test_an_option_that_is_set_changes_what_was_measured():
    law, other = Coulomb(), Coulomb(0.6)
    before = law.friction_size, law.certain, law.softening, law.coupled_softening(1.0, 1.0)
    law.coefficient = 0.6
    assert law.friction_size == other.friction_size == 2.0 * before[0]
    assert law.coupled_softening(1.0, 1.0) == other.coupled_softening(1.0, 1.0)


def test_friction_that_drives_the_slip_is_refused():
    law = type("Driving", (Law,), {"tractions": lambda self, a, b: (
        a * np.exp(-a), -np.exp(-b * b - np.maximum(a, 0.0))), "gap_corners": (0.0,)})()
    with pytest.raises(InputError, match="a friction that drives the slip: .* grows by -1 of"):
        own_laws.check(law, "Driving")


def decoupled(gap, work_ratio=1.0):
    """Energy of a exp(-a), and of 2 b exp(-b^2) whatever the gap."""
    return -(1.0 + gap[0]) * np.exp(-gap[0]) - work_ratio * np.exp(-np.sum(gap[1:] ** 2, axis=0))


@pytest.mark.parametrize("potential, words", (
    (lambda self, gap, work_ratio=1.0: decoupled(gap) if len(gap) == 1 else None,
     "potential -1 at the normal gap 37 without slip.*: it has to be 0 where"),
    (lambda self, gap, work_ratio=1.0: decoupled(gap) if np.all(gap[0] < 0.0) else None,
     "along g_1 are not its traction times the work_ratio 3 "),
    (lambda self, gap, work_ratio=1.0: decoupled(gap, work_ratio),
     "along g_0 are not its traction .*normal gap 0.7 and the slip 0.2 |"
     "along g_1 are not its traction .*normal gap 0.7 and the slip 0.2 "),
    (lambda self, gap, work_ratio=1.0: decoupled(gap[:2], work_ratio)
     if np.all(gap[0] < 0.0) else None, "along g_1 are not its traction.* the slip -0.12, 0.16")))
def test_a_potential_is_that_of_all_that_it_is_asked_for(potential, words):
    """Energies count from where the surfaces are apart, for nodes of the window alone: one of a
    constant is another energy on another window."""
    with pytest.raises(InputError, match=words):
        own_laws.check(type("Declaring", (Spoken,), {"potential": potential})(), "Declaring")


@pytest.mark.parametrize("size", (lambda count: 1.0 + 1e-3 * np.arange(count),
                                  lambda count: 1.0 + 1e-3 * count))
def test_a_law_of_more_than_its_own_node_is_told(size):
    """Solves ask for the nodes of a window, of half of it or of a part, in orders of their own."""
    def evaluate(self, gap, traction, tangent=None):
        Sticking.evaluate(self, gap, traction, tangent)
        traction *= size(gap.shape[1])
        if tangent is not None:
            tangent *= size(gap.shape[1])
        return traction

    with pytest.raises(InputError, match="hangs on more than a node's own gap and slip"):
        own_laws.check(type("Placed", (Sticking,), {"evaluate": evaluate})(), "Placed", False)


@pytest.mark.parametrize("law", (Sticking, "modified", np.exp))
def test_what_is_no_object_is_told(law):
    with pytest.raises(InputError, match="the law is .*: give an object of a subclass of"):
        Branch(Scene(**SMALL), Load(path="normal_displacement=1"), law=law)


def test_a_file_that_ends_the_program_or_a_class_with_its_own_parameters(tmp_path):
    (tmp_path / "ends.py").write_text("import sys\nsys.exit(3)\n", encoding="utf-8")
    with pytest.raises(InputError, match="does not run .SystemExit: 3"):
        Scene(law=f"{tmp_path / 'ends.py'}:Drag")
    (tmp_path / "made.py").write_text(
        "from contactsnes import Law\n\nclass Made(Law):\n    def __init__(self, x):\n"
        "        self.x = x\n", encoding="utf-8")
    with pytest.raises(InputError, match="no object of its class can be made .* leave __init__"):
        Scene(law=f"{tmp_path / 'made.py'}:Made")


def test_a_law_that_ends_the_program_where_it_is_looked_at(tmp_path):
    (tmp_path / "ends.py").write_text(
        "import sys\n\nfrom contactsnes import Law\n\nclass Ends(Law):\n"
        "    def evaluate(self, gap, traction, tangent=None):\n        sys.exit('no table')\n",
        encoding="utf-8")
    with pytest.raises(InputError, match="cannot be evaluated .*SystemExit: no table"):
        Branch(Scene(law=f"{tmp_path / 'ends.py'}:Ends", **SMALL), Load(path=""))


def test_info_tells_of_the_options_of_the_law_that_there_is(written):
    """Not of a residual friction that a law of one's own has not."""
    told = [about_law(Scene(law=name)) for name in (written(), "modified", "mcgarry")]
    assert told == [["drag strength 0.5"], ["residual friction 1, residual adhesion 0"], []]


def test_a_scene_takes_the_name_of_its_file_to_another_process(tmp_path, monkeypatch):
    """The file is read there, too: what had not read it ended in an error from inside."""
    (tmp_path / "steep.py").write_text(
        "from contactsnes.interface.laws.modified import Modified\n"
        "class Steep(Modified):\n    pass\n")
    kept = pickle.dumps(Scene(law=f"{tmp_path / 'steep.py'}:Steep", **SMALL))
    for name in ("own", "objects"):  # another process has read nothing
        monkeypatch.setattr(laws.REGISTRY, name, {})
    assert type(Contact(pickle.loads(kept)).law).__name__ == "Steep"


def test_a_scene_does_not_take_its_objects_to_another_process(monkeypatch):
    load = Load(path="normal_force=1")
    kept = pickle.dumps(Branch(Scene(**SMALL), load, law=Sticking(0.3)).scene)
    monkeypatch.setattr(laws.REGISTRY, "objects", {})
    scene = pickle.loads(kept)
    with pytest.raises(InputError, match="^the law of the scene is 'Sticking.*, an object that was "
                                         "made in another process.*: give it again, law=...$"):
        Branch(scene, load)
    assert isinstance(Contact(scene, law=Sticking(0.3)).law, Sticking)
