"""Laws in C: those of the package, and those of one's own with their cache."""

import multiprocessing
import os

import numpy as np
import pytest

from contactsnes import Branch, Form, Load, Scene
from contactsnes.interface.laws import LAWS
from contactsnes.interface.laws.law import Law
from contactsnes.kernels import building, library
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.laws import kernel_of, with_kernel
from contactsnes.kernels.library import Unavailable
from contactsnes.options.fields import option

pytestmark = pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))


class Soft(Law):
    """A law of one's own."""

    steepness: float = option(1.5, "of the test", above=0)

    def tractions(self, a, b):
        return a * np.exp(-self.steepness * a), 2.0 * np.exp(-b * b) / (1.0 + a * a)


def has_compiler():
    try:
        return bool(building.compiler())
    except Unavailable:
        return False


compiler = pytest.mark.skipif(not has_compiler(), reason="there is no C compiler")


def gaps(count, nodes=700):
    random = np.random.default_rng(2)
    gap = random.normal(size=(count, nodes)) * 2.0
    gap[0, :5] = -34.0, -30.0, 0.0, 36.0, 50.0
    gap[1:, 5:20] = 0.0
    return gap


def agree(law, made):
    for count in (1, 2, 3):
        gap = gaps(count)
        np.testing.assert_allclose(made.traction(gap), law.traction(gap), rtol=1e-11, atol=1e-13)
        np.testing.assert_allclose(made.tangent(gap), law.tangent(gap), rtol=1e-11,
                                   atol=1e-13 * np.abs(law.tangent(gap)).max())
    for one, other in zip(made.normal(gap[0]), law.normal(gap[0])):
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-13)


def test_friction_that_underflows_is_numpys():
    law = LAWS["modified"](residual_friction=0.0)
    made = with_kernel(law, None)
    gap = np.array([np.linspace(-2.0, 30.0, 400), np.linspace(20.0, 32.0, 400)])
    for kind in ("traction", "tangent"):
        found, expected = (getattr(one, kind)(gap) for one in (made, law))
        assert np.all(np.isfinite(found))
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-280)


@pytest.mark.parametrize("name", sorted(LAWS))
def test_laws_of_the_package_are_numpys(name, tmp_path):
    law = LAWS[name]()
    made = with_kernel(law, tmp_path)
    assert kernel_of(made) and not kernel_of(law) and not list(tmp_path.iterdir())
    agree(law, made)
    assert repr(made) == repr(law)


@pytest.mark.parametrize("name", sorted(LAWS))
@pytest.mark.parametrize("nodes", [1, 255, 256, 700])
def test_gaps_of_the_regularised_gap_are_numpys(name, nodes):
    law = LAWS[name]()
    made, target = with_kernel(law, None), np.linspace(-40.0, 60.0, nodes)
    target[::7] = 0.0
    for stiffness in (law.newton_stiffness, 5.0 * law.newton_stiffness):
        found = made.gap_of_regularised(target, stiffness)
        np.testing.assert_allclose(found, law.gap_of_regularised(target, stiffness), rtol=1e-9,
                                   atol=1e-9)
        np.testing.assert_allclose(law.regularised(found, stiffness), target, rtol=1e-9, atol=1e-9)


@compiler
def test_gaps_of_the_regularised_gap_of_a_law_that_repels_first(tmp_path):
    class Hindered(Soft):
        opening_range = 12.0

        def tractions(self, a, b):
            return (a * np.exp(-a) - 0.2 * a * np.exp(-(a - 4.0) ** 2),
                    2.0 * np.exp(-b * b) / (1.0 + a * a))

    law, a = with_kernel(Hindered(), tmp_path), np.linspace(-5.0, 9.0, 141)
    assert kernel_of(law) is not None
    np.testing.assert_allclose(law.gap_of_regularised(law.regularised(a, 1.2), 1.2), a, atol=1e-8)


@compiler
def test_a_law_with_its_own_regularised_gap_keeps_it(tmp_path):
    class Own(Soft):
        def gap_of_regularised(self, target, stiffness):
            return target

    assert with_kernel(Own(), tmp_path).gap_of_regularised(3.0, 1.0) == 3.0


def test_strided_arrays_are_taken_too():
    law = LAWS["modified"](0.3, 0.2)
    made, gap = with_kernel(law, None), gaps(2)
    out = np.empty((2, 2 * gap.shape[1]))[:, ::2]
    np.testing.assert_allclose(made.evaluate(gap[:, ::-1], out), law.traction(gap[:, ::-1]))


def test_an_option_that_is_set_later_counts():
    made = with_kernel(LAWS["modified"](0.3, 0.2), None)
    made.residual_friction = 0.9
    gap = gaps(2)
    np.testing.assert_allclose(made.traction(gap), LAWS["modified"](0.9, 0.2).traction(gap))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The file of the compiled law `Soft`."""
    folder = tmp_path_factory.mktemp("made")
    with_kernel(Soft(), folder)
    (kept,) = folder.iterdir()
    return kept


@compiler
def test_a_law_of_ones_own_is_compiled_once(tmp_path, monkeypatch):
    agree(Soft(), with_kernel(Soft(), tmp_path))
    (kept,) = tmp_path.iterdir()
    monkeypatch.setattr(building, "_build", None)
    agree(Soft(0.7), with_kernel(Soft(0.7), tmp_path))
    assert list(tmp_path.iterdir()) == [kept]


@compiler
def test_a_law_whose_friction_grows_with_the_overlap_is_compiled(tmp_path):
    class Growing(LAWS["modified"]):
        # beyond the peak numbers of 1e13 leave nothing in its slope, or their last digits
        decoupled_in_overlap, gap_corners = False, ()

    agree(Growing(), with_kernel(Growing(), tmp_path))


@compiler
@pytest.mark.parametrize("content", [
    pytest.param(b"", id="empty", marks=pytest.mark.study),
    pytest.param(b"nonsense", id="nonsense", marks=pytest.mark.study),
    pytest.param(None, id="cut off")])
def test_a_broken_library_is_made_anew(content, made, tmp_path):
    whole, kept = made.read_bytes(), tmp_path / made.name
    broken = whole[:len(whole) // 3] if content is None else content
    kept.write_bytes(broken)
    agree(Soft(), with_kernel(Soft(), tmp_path))
    assert list(tmp_path.iterdir()) == [kept] and kept.read_bytes() != broken


@compiler
def test_a_library_made_from_something_else_is_not_taken(made):
    with pytest.raises(ValueError, match="something else"):
        building._loaded(made, "0" * 32)


@compiler
def test_a_damaged_library_is_not_loaded(made, tmp_path):
    """One that is cut off at four fifths, or has other bytes somewhere, ends the process that loads
    it, or computes something else."""
    whole, copy = made.read_bytes(), tmp_path / "copy"
    checksum = made.stem.removeprefix("law-")
    for part in range(0, len(whole), len(whole) // 40):
        for content in (whole[:part], whole[:part] + b"nonsense" + whole[part + 8:]):
            copy.write_bytes(content)
            with pytest.raises(ValueError, match="damaged"):
                building._loaded(copy, checksum)
    assert building._loaded(made, checksum)


def build(folder, together):
    """Compile a law at the moment when others do."""
    together.wait(60.0)
    agree(Soft(), with_kernel(Soft(), folder))


@compiler
def test_two_processes_build_at_once(tmp_path):
    context = multiprocessing.get_context("fork")
    together = context.Barrier(2)
    running = [context.Process(target=build, args=(tmp_path, together)) for _ in range(2)]
    for process in running:
        process.start()
    for process in running:
        process.join()
        assert process.exitcode == 0
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize("command, words", [("false", "does not run"),
                                            ("no_such_compiler", "does not run")])
def test_a_compiler_that_fails_is_told(command, words, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", command)
    building.compiler.cache_clear()
    try:
        kernels = chosen(True, tmp_path)
        law = kernels.law(Soft())
    finally:
        building.compiler.cache_clear()
    assert kernel_of(law) is None and words in kernels.law_reason and command in kernels.law_reason


@compiler
def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(Unavailable, match="-contact_cache"):
        with_kernel(Soft(), tmp_path / "file" / "folder")


def test_a_law_with_an_evaluate_of_its_own_stays_with_numpy(tmp_path):
    class Written(LAWS["modified"]):
        """A law that fills its arrays itself."""

        def evaluate(self, gap, traction, tangent=None):
            return super().evaluate(gap, traction, tangent)

    kernels = chosen(True, tmp_path)
    law = Written()
    assert kernels.law(law) is law and "evaluate of its own" in kernels.law_reason


def test_libraries_of_other_sources_are_not_taken(tmp_path):
    """Stale, broken, or none at all: a sentence."""
    for name in library.SOURCES:
        (tmp_path / name).write_bytes((library.HERE / name).read_bytes())
    with pytest.raises(Unavailable, match="was not built"):
        library.load(tmp_path)
    file = tmp_path / library.built().name
    file.write_bytes(b"nonsense")
    with pytest.raises(Unavailable, match="cannot be loaded"):
        library.load(tmp_path)
    file.unlink()
    os.link(library.built(), file)
    assert library.load(tmp_path)
    with open(tmp_path / "forms.c", "a") as source:
        source.write("\n")
    with pytest.raises(Unavailable, match="built from other sources"):
        library.load(tmp_path)


@pytest.mark.parametrize("kernels, switch, told", [("auto", "", True), ("off", "", False),
                                                   ("auto", "off", False)])
def test_a_run_without_the_library_says_so_unless_asked_for(kernels, switch, told, monkeypatch):
    def missing():
        raise Unavailable("it was not built")

    monkeypatch.setattr(library, "shared", missing)
    monkeypatch.setenv("CONTACTSNES_KERNELS", switch)
    said = []
    Branch(Scene(points=128), Load(path="normal_displacement=0.1"), form=Form(kernels=kernels),
           log=said.append)
    assert any("it was not built" in sentence for sentence in said) is told
