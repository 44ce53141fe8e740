"""In which precision linear solves are: what they find and what they take, where they must not be
in single, and where they go on in double."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])
from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.corrector import TURNED  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.grid.counter import Counter  # noqa: E402
from contactsnes.kernels import laws as kernel_laws  # noqa: E402
from contactsnes.kernels import library
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402
from contactsnes.solvers import callbacks, precision  # noqa: E402
from contactsnes.solvers.precision import pays  # noqa: E402
from contactsnes.solvers.snes import WARM  # noqa: E402

LINE = {"points": 512, "period": 20.0, "normal_maugis": 2.0, "tangential_maugis": 2.0}
PLANE = {**LINE, "points": 64, "period": 12.0, "dimension": 2, "geometry": "sphere"}
ROUGH = {**PLANE, "period": 24.0, "geometry": "file", "tangential_maugis": 1.0}
PRESSED = Load(start="normal_displacement=1", path="normal_displacement=2")
SLID = "normal_displacement=1.5; tangential_displacement{}=2"
KERNELS = ["auto", "off"]
WAYS = {"line": (LINE, SLID.format("")), "sphere": (PLANE, SLID.format("_x")),
        "along y": ({**PLANE, "poisson": 0.3}, SLID.format("_y")),
        "force": (LINE, "normal_force=3; tangential_force=0.5")}


def run(given, load, wanted="single", kernels="auto", log=lambda sentence: None, **more):
    """(points, branch) of a path, in steps that do not depend on what was found."""
    branch = Branch(Scene(**given), load, Steps(initial_step=0.25, largest_step=0.25, **more),
                    Form(linear_precision=wanted, kernels=kernels), log=log)
    return list(branch), branch


def spent(points, name):
    """What all points but the first, which begins afar, took."""
    return np.array([point.spent[name] for point in points[1:]])


@pytest.mark.parametrize("kernels", KERNELS)
@pytest.mark.parametrize("way", WAYS)
def test_a_path_is_that_of_double_precision(way, kernels):
    given, path = WAYS[way]
    load = Load(start="normal_displacement=1", path=path)
    (found, branch), (expected, _) = (run(given, load, wanted, kernels)
                                      for wanted in ("single", "double"))
    assert len(found) == len(expected) > 3
    for point, other in zip(found, expected):
        np.testing.assert_allclose(point.load, other.load, rtol=1e-7)
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-6, atol=1e-7)
        assert point.residual_norm <= 1e-8
    np.testing.assert_array_equal(spent(found, "nonlinear_iterations"),
                                  spent(expected, "nonlinear_iterations"))
    # one more or less in each of a point's linear solves
    assert np.all(np.abs(spent(found, "linear_iterations") - spent(expected, "linear_iterations"))
                  <= spent(expected, "nonlinear_iterations"))
    both = [spent(points, "transforms") + spent(points, "transforms_single")
            for points in (found, expected)]
    np.testing.assert_allclose(*both, rtol=0.15)
    assert not spent(expected, "transforms_single").any()
    assert np.all(spent(found, "transforms_single") > 0.2 * both[0])
    assert branch.corrector.form.precision.turned == 0


@pytest.mark.parametrize("kernels", KERNELS)
@pytest.mark.parametrize("slope", [2.0, 6.0, 30.0])
def test_rough_planes(self_affine, tmp_path, slope, kernels):
    file = tmp_path / "heights.npy"
    np.save(file, self_affine(64, 24.0, 12.0, 3.0, slope / 4.0, 5, dimension=2))
    given = {**ROUGH, "geometry_file": str(file)}
    load = Load(start="normal_displacement=0.5",
                path="normal_displacement=0.7; tangential_displacement_x=0.3")
    (found, _), (expected, _) = (run(given, load, wanted, kernels)
                                 for wanted in ("single", "double"))
    assert len(found) == len(expected)
    for point, other in zip(found, expected):
        np.testing.assert_allclose(point.load, other.load, rtol=1e-7)
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-5, atol=1e-6)
    # (rejected steps, and what follows a jump, hang on rounding)
    steps = [(point, other) for point, other in zip(found[1:], expected[1:])
             if not point.event and other.spent["nonlinear_iterations"] <= WARM]
    assert len(steps) > 1
    for point, other in steps:
        assert point.spent["nonlinear_iterations"] == other.spent["nonlinear_iterations"]
        assert other.spent["transforms_single"] == 0.0
        assert (point.spent["transforms_single"] > 0.0) == (point.spent["linear_iterations"] > 0)


def test_the_library_does_as_python():
    """Both choose the same solves."""
    load = Load(start="normal_displacement=1", path=SLID.format("_x"))
    counts = [[(spent(points, name)) for name in ("transforms", "transforms_single")]
              for points, _ in (run(PLANE, load, kernels=kernels) for kernels in KERNELS)]
    np.testing.assert_allclose(*counts, rtol=1e-9)


@pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))
@pytest.mark.parametrize("given", [PLANE, {**PLANE, "geometry": "rough", "rough_on": "flat",
                                           "rough_slope": 0.5, "rough_longest": 6.0,
                                           "rough_shortest": 2.0}], ids=["sphere", "rough"])
def test_a_law_that_is_not_compiled_is_in_double_precision_on_planes(monkeypatch, given):
    """The library's transforms are there, its products are not."""
    def fail(law, cache):
        raise library.Unavailable("there is no C compiler")

    monkeypatch.setattr(kernel_laws, "with_kernel", fail)
    points, branch = run(given, PRESSED)
    assert branch.corrector.form.kernel is None
    assert not any(point.spent["transforms_single"] for point in points)
    others, _ = run(given, PRESSED, kernels="off")
    np.testing.assert_allclose([point.forces for point in points],
                               [point.forces for point in others], rtol=1e-7)



@pytest.mark.parametrize("kernels", KERNELS)
def test_a_solve_that_is_asked_for_more_is_in_double_precision(options, kernels):
    options(ksp_rtol="1e-9", ksp_atol="1e-50")
    points, _ = run(LINE, PRESSED, kernels=kernels)
    assert len(points) > 3 and not spent(points, "transforms_single").any()


def test_a_solve_may_be_asked_for_little_in_the_end(options):
    """The tolerance that counts is the larger of the relative and the absolute one."""
    options(ksp_rtol="1e-9")
    points, _ = run(LINE, PRESSED)
    single, double = (spent(points, name) for name in ("transforms_single", "transforms"))
    assert 0.0 < single.sum() < double.sum()


@pytest.mark.parametrize("kernels", KERNELS)
def test_a_slow_solve_goes_on_in_double_precision(monkeypatch, kernels):
    """... which changes neither what is found nor by how many iterations, and is told once."""
    expected, _ = run(LINE, PRESSED, kernels=kernels)
    for module in (precision, callbacks):
        monkeypatch.setattr(module, "PATIENCE", 3)
    told = []
    found, branch = run(LINE, PRESSED, kernels=kernels, log=told.append)
    assert branch.corrector.form.precision.turned > 1
    # (each window has a solver of its own)
    assert 1 <= told.count(TURNED) < branch.corrector.form.precision.turned
    for name in ("nonlinear_iterations", "linear_iterations"):
        np.testing.assert_array_equal(spent(found, name), spent(expected, name))
    assert np.all(spent(found, "transforms_single") < spent(expected, "transforms_single"))
    for point, other in zip(found, expected):
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("settings, steps", [
    (Form(form="force", linear_precision="single"), Steps()),
    (Form(linear_precision="double"), Steps()), (Form(), Steps())],
    ids=["force form", "double", "small window"])
def test_what_stays_in_double_precision(settings, steps):
    points = list(Branch(Scene(**LINE), PRESSED, steps, settings))
    assert not any(point.spent["transforms_single"] for point in points)


@pytest.mark.parametrize("kernels", KERNELS)
def test_a_solve_from_afar_is_in_double_precision(kernels):
    """... on small grids, as this one and its coarser ones are."""
    points, _ = run(LINE, PRESSED, kernels=kernels)
    first, second = (point.spent["transforms_single"] for point in points[:2])
    assert points[0].spent["linear_iterations"] > 0
    assert first == 0.0 < second


def test_arc_length_of_one_contact_is_in_double_precision():
    """Its SNES multiplies in double, also after solves of the same form that did not."""
    load = Load(start="normal_displacement=1", path="normal_displacement=-6")
    points, branch = run(LINE, load, at_fold="stop", type="arclength")
    assert points[-1].event == "fold" and points[-1].fold_precision <= 1e-8
    steps = [point for point in points[2:] if not point.event]
    assert steps and not any(point.spent["transforms_single"] for point in steps[1:])


def test_a_fold_is_located_as_in_double_precision():
    load = Load(start="normal_displacement=1", path="normal_displacement=-6")
    folds = [run(LINE, load, wanted, at_fold="stop")[0][-1] for wanted in ("single", "double")]
    assert folds[0].event == folds[1].event == "fold"
    assert folds[0].load[0] == pytest.approx(folds[1].load[0], rel=2e-8)


def test_auto_takes_it_on_large_circles():
    small, large = (DisplacementForm(contact, contact.grid.whole, ("displacement",))
                    for contact in (Contact(Scene(**{**PLANE, "points": n})) for n in (64, 128)))
    assert [pays(form, "auto") for form in (small, large)] == [False, True]
    assert pays(small, "single") and not pays(large, "double")


def test_the_option_is_checked():
    with pytest.raises(InputError, match="linear_precision.*half.*auto, double"):
        Form(linear_precision="half")


def test_a_limit_counts_two_in_single_precision_as_one():
    counter = Counter(64)
    counter.limit = 2.0
    counter.add(1.0)
    counter.add(2.0, single=True)
    assert (counter.transforms, counter.transforms_single, counter.weighed) == (1.0, 2.0, 2.0)
    with pytest.raises(RuntimeError, match="too many"):
        counter.add(0.1, single=True)
