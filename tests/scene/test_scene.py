"""Scenes, loads and steps: defaults, allowed values, load paths, resolution."""

import dataclasses
import math

import numpy as np
import pytest

from contactsnes.interface import shapes
from contactsnes.interface.laws import LAWS
from contactsnes.options.fields import InputError, allowed, as_text, nearest
from contactsnes.scene.load import Control, Load, quantities
from contactsnes.scene.resolution import resolution, resolution_warning
from contactsnes.scene.settings import (
    OPTION_CLASSES,
    Form,
    Output,
    Scene,
    Steps,
    attributes,
    check,
    ineffective,
    tangential_legs,
)

DEFAULTS = {"scene_dimension": "1", "scene_points": "", "scene_accuracy": "1e-06",
            "scene_period": "100", "scene_spacing": "", "scene_geometry": "cylinder",
            "scene_amplitude": "", "scene_geometry_file": "",
            "scene_heights_size": "", "scene_heights_unit": "", "scene_heights_crop": "",
            "scene_heights_fill": "none", "scene_heights_edges": "warn",
            "scene_heights_fit": "exact", "scene_rough_hurst": "0.8",
            **dict.fromkeys(("scene_rough_slope", "scene_rough_longest", "scene_rough_shortest"),
                            ""), "scene_rough_seed": "0", "scene_gap_offset": "0",
            "scene_law": "modified", "scene_normal_maugis": "10", "scene_tangential_maugis": "1",
            "scene_residual_friction": "1", "scene_residual_adhesion": "0", "scene_work_ratio": "1",
            "scene_dugdale_width": "0.1", "scene_pressure_friction": "0.1",
            "scene_xu_needleman_q": "1", "scene_xu_needleman_r": "0", "scene_poisson": "0.5",
            "scene_height": "2000", "scene_body": "layer",
            "scene_coating_normal": "0", "scene_coating_tangential": "0",
            "scene_tangential": "auto",
            "scene_contact_threshold": "2.718281828", "scene_units": "dimensionless",
            **dict.fromkeys(("scene_work_of_adhesion_normal", "scene_work_of_adhesion_tangential",
                             "scene_contact_modulus", "scene_young_modulus", "scene_radius",
                             "scene_range_normal", "scene_range_tangential",
                             "scene_adhesive_strength", "scene_shear_strength"), ""),
            "contact_form": "displacement", "contact_linear_precision": "auto",
            "contact_cascade": "true", "contact_window": "auto",
            "contact_symmetry": "auto",
            "contact_kernels": "auto", "contact_cache": "",
            "contact_first": "none", "contact_first_tolerance": "0.01", "load_start": "",
            "load_path": "", "load_stop": "none", "continuation_type": "natural",
            "continuation_at_fold": "jump", "continuation_initial_step": "",
            "continuation_largest_step": "", "continuation_smallest_step": "",
            "continuation_predictor": "edge", "continuation_stability": "off",
            "continuation_at_bifurcation": "pass", "continuation_locate_folds": "",
            "archive_file": "", "archive_fields": "none",
            "archive_precision": "double", "archive_fields_on": "",
            "scene_rough_on": "sphere", "scene_rough_rolloff": "",
            "archive_errors": "false", "archive_stiffness": "false",
            "archive_resume": "false", "archive_overwrite": "false"}


def test_defaults_are_the_documented_ones():
    found = {cls.prefix + field.name: as_text(getattr(cls(), field.name))
             for cls in OPTION_CLASSES for field in dataclasses.fields(cls)}
    assert found == DEFAULTS


def test_defaults_that_depend_on_the_dimension():
    line, plane = Scene(), Scene(dimension=2, period=(100, 50))
    assert line.shape == (8192,) and plane.shape == (512, 512)
    assert line.periods == (100.0,) and plane.periods == (100.0, 50.0)
    assert plane.spacings == (100 / 512, 50 / 512)
    assert (line.components, plane.components) == (2, 3)
    assert line.ranges == (10.0, 1.0) and plane.ranges == (10.0, 1.0, 1.0)


@pytest.mark.parametrize("cls", OPTION_CLASSES)
def test_every_field_says_all_about_its_option(cls):
    for field in dataclasses.fields(cls):
        rule = field.metadata
        assert rule["meaning"] and rule["kind"] in ("flag", "integer", "number",
                                                    "text") and allowed(rule)
        assert field.default is not None or rule["default_text"]


def test_default_sinusoid_has_curvature_one_in_each_direction():
    scene = Scene(dimension=2, period=(10.0, 20.0), geometry="sinusoid")
    for amplitude, period in zip(shapes.of(scene).amplitudes(scene), scene.periods):
        gap = lambda x: amplitude * (1 - math.cos(2 * math.pi * x / period))
        step = 1e-3
        assert (gap(step) - 2 * gap(0) + gap(-step)) / step ** 2 == pytest.approx(1, rel=1e-6)


BAD = [(Scene, dict(dimension=3), "-scene_dimension", "3", "1, 2"),
       (Scene, dict(points=17), "-scene_points", "17", "even"),
       (Scene, dict(points=14), "-scene_points", "14", "at least 16"),
       (Scene, dict(points="automatic"), "-scene_points", "automatic", "or auto"),
       (Scene, dict(points=("auto", 64)), "-scene_points", "auto,64", "even"),
       (Scene, dict(accuracy=0), "-scene_accuracy", "0", "above 0"),
       (Scene, dict(accuracy=1), "-scene_accuracy", "1", "below 1"),
       (Scene, dict(points=512.5), "-scene_points", "512.5", "even"),
       (Scene, dict(points=(64, 64)), "-scene_points", "64,64", "one dimension"),
       (Scene, dict(dimension=2, points=(64, 64, 64)), "-scene_points", "64,64,64",
        "one per direction"), (Scene, dict(points=()), "-scene_points", "", "even"),
       (Scene, dict(period=-math.inf), "-scene_period", "-inf", "above 0"),
       (Scene, dict(period=0), "-scene_period", "0", "above 0"),
       (Scene, dict(period=None), "-scene_period", "", "above 0"),
       (Scene, dict(period=(50, 60)), "-scene_period", "50,60", "one dimension"),
       (Scene, dict(geometry="roughly"), "-scene_geometry", "roughly", "sinusoid, sphere"),
       (Scene, dict(geometry="rough"), "-scene_geometry", "rough",
        "without -scene_rough_slope and -scene_rough_shortest"),
       (Scene, dict(geometry="rough", rough_slope=0.1), "-scene_geometry", "rough",
        "without -scene_rough_shortest"), (Scene, dict(rough_hurst=1.1), "-scene_rough_hurst",
                                           "1.1", "at most 1"),
       (Scene, dict(rough_hurst=-0.1), "-scene_rough_hurst", "-0.1", "at least 0"),
       (Scene, dict(rough_slope=0), "-scene_rough_slope", "0", "above 0"),
       (Scene, dict(rough_seed=-1), "-scene_rough_seed", "-1", "at least 0"),
       (Scene, dict(geometry="rough", rough_slope=0.1, rough_shortest=1, rough_longest=101),
        "-scene_rough_longest", "101", "at most the period, 100"),
       (Scene, dict(geometry="rough", dimension=2, period=(20, 30), rough_slope=0.1,
                    rough_shortest=1, rough_longest=25), "-scene_rough_longest", "25",
        "at most the period, 20"), (Scene, dict(geometry="rough", rough_slope=0.1,
                                                rough_shortest=11, rough_longest=10),
                                    "-scene_rough_shortest", "11", "at most the longest wave, 10"),
       (Scene, dict(geometry="rough", rough_slope=0.1, rough_shortest=1, period=math.inf),
        "-scene_geometry", "rough", "cylinder"), (Scene, dict(geometry="sphere"), "-scene_geometry",
                                                  "sphere", "two dimensions"),
       (Scene, dict(geometry="file"), "-scene_geometry", "file", "-scene_geometry_file"),
       (Scene, dict(amplitude=0), "-scene_amplitude", "0", "above 0"),
       (Scene, dict(gap_offset=math.nan), "-scene_gap_offset", "nan", "a number"),
       (Scene, dict(gap_offset=math.inf), "-scene_gap_offset", "inf", "a number"),
       (Scene, dict(law="mcgary"), "-scene_law", "mcgary", "try mcgarry"),
       (Scene, dict(normal_maugis=0), "-scene_normal_maugis", "0", "above 0"),
       (Scene, dict(normal_maugis=True), "-scene_normal_maugis", "true", "above 0"),
       (Scene, dict(tangential_maugis=-1), "-scene_tangential_maugis", "-1", "above 0"),
       (Scene, dict(residual_friction=1.01), "-scene_residual_friction", "1.01", "at most 1"),
       (Scene, dict(residual_friction=-0.1), "-scene_residual_friction", "-0.1", "at least 0"),
       (Scene, dict(residual_adhesion=1), "-scene_residual_adhesion", "1", "below 1"),
       (Scene, dict(work_ratio=0), "-scene_work_ratio", "0", "above 0"),
       (Scene, dict(poisson=0.51), "-scene_poisson", "0.51", "at most 0.5"),
       (Scene, dict(poisson="0.3"), "-scene_poisson", "0.3", "a number"),
       (Scene, dict(height=0), "-scene_height", "0", "inf"), (Scene, dict(tangential="yes"),
                                                              "-scene_tangential", "yes",
                                                              "auto, on, off"),
       (Scene, dict(contact_threshold=0), "-scene_contact_threshold", "0", "above 0"),
       (Scene, dict(units="metric"), "-scene_units", "metric", "dimensionless, si"),
       (Form, dict(form="mixed"), "-contact_form", "mixed", "displacement, force"),
       (Form, dict(window="on"), "-contact_window", "on", "auto, off"),
       (Load, dict(stop="pulloff"), "-load_stop", "pulloff", "try pull_off"),
       (Load, dict(stop="none,pull_off"), "-load_stop", "none,pull_off", "gross_sliding"),
       (Steps, dict(type="arc"), "-continuation_type", "arc", "natural"),
       (Steps, dict(at_fold="go"), "-continuation_at_fold", "go", "jump, stop, trace"),
       (Steps, dict(initial_step=0), "-continuation_initial_step", "0", "above 0"),
       (Steps, dict(largest_step=(1, -1)), "-continuation_largest_step", "1,-1", "above 0"),
       (Steps, dict(initial_step=2, largest_step=1), "-continuation_initial_step", "2",
        "-continuation_largest_step"), (Steps, dict(smallest_step=2, largest_step=(3, 1)),
                                        "-continuation_smallest_step", "2",
                                        "-continuation_largest_step"),
       (Steps, dict(initial_step=(1, 1), largest_step=(3, 3, 3)), "-continuation_initial_step",
        "1,1", "one number per leg"), (Steps, dict(predictor="cubic"), "-continuation_predictor",
                                       "cubic", "edge"), (Steps, dict(stability="signs"),
                                                          "-continuation_stability", "signs",
                                                          "eigenvalue"),
       (Output, dict(fields="some"), "-archive_fields", "some", "none, last, all"),
       (Output, dict(resume="maybe"), "-archive_resume", "maybe", "true or false"),
       (Output, dict(resume=True, overwrite=True), "-archive_resume", "-archive_overwrite",
        "one of them"),]


@pytest.mark.parametrize("make, name, hint", [
    (Scene, "maugis", "Scene: did you mean normal_maugis?"),
    (Scene.typed, "maugis", "did you mean normal_maugis?"),
    (lambda **values: Scene.typed(units="si", **values), "maugis", "did you mean normal_maugis?"),
    (Load, "paths", "Load: did you mean path?"), (Steps, "largest", "did you mean largest_step?")])
def test_a_name_that_is_none_is_told_with_the_one_that_may_be_meant(make, name, hint):
    with pytest.raises(InputError, match=f"^{name} is no option of .*") as error:
        make(**{name: 3.0})
    assert str(error.value).endswith(hint)


@pytest.mark.parametrize("cls, values, name, value, hint", BAD)
def test_bad_value_is_one_sentence_with_option_value_and_what_is_allowed(cls, values, name, value,
                                                                         hint):
    with pytest.raises(InputError) as error:
        cls(**values)
    sentence = str(error.value)
    assert name in sentence and value in sentence and hint in sentence and "\n" not in sentence


@pytest.mark.parametrize("cls, values", [(Scene, dict(dimension=2, points=64, geometry="sphere")),
                                         (Scene, dict(points=16)), (Scene, dict(height=math.inf)),
                                         (Scene, dict(poisson=0.0)), (Scene, dict(poisson=0.5)),
                                         (Scene, dict(residual_friction=0)),
                                         (Scene, dict(residual_adhesion=0.999)),
                                         (Scene, dict(geometry="file", geometry_file="a.npy")),
                                         (Scene, dict(law="mcgarry", residual_friction=0.5)),
                                         (Load, dict(stop="gross_sliding, pull_off")),
                                         (Steps, dict(initial_step=(1, 2), largest_step=5)),
                                         (Output, dict(file="a.h5", resume=True))])
def test_allowed_values(cls, values):
    made, default = cls(**values), cls()
    for field in dataclasses.fields(cls):
        value = values.get(field.name, getattr(default, field.name))
        assert as_text(getattr(made, field.name)).replace(" ",
                                                          "") == as_text(value).replace(" ", "")


def test_values_take_the_type_of_their_field():
    scene = Scene(dimension=2, points=[np.int64(64), 32], period=np.float64(100), normal_maugis=3,
                  height=math.inf)
    assert scene == Scene(dimension=2, points=(64, 32), period=100.0, normal_maugis=3.0,
                          height=math.inf)
    assert (type(scene.points[0]) is int and type(scene.normal_maugis) is float
            and type(scene.period) is float)
    assert Scene(points=(64,)).points == 64


@pytest.mark.parametrize("scene", [dict(normal_maugis=2.0), dict(gap_offset=-0.5),
                                   dict(dimension=2, geometry="sphere")])
def test_smallest_period_has_the_edge_of_the_cell_just_out_of_contact(scene):
    with pytest.raises(InputError, match="smallest period") as error:
        Scene(period=0.1, **scene)
    smallest = float(str(error.value).split()[-1])
    allowed_scene = Scene(period=smallest, **scene)
    edge = smallest ** 2 / 8 + allowed_scene.gap_offset
    assert edge >= allowed_scene.contact_gap and edge == pytest.approx(allowed_scene.contact_gap,
                                                                       rel=5e-3)
    with pytest.raises(InputError):
        Scene(period=0.99 * smallest, **scene)


def test_edge_of_the_cell_counts_only_where_the_shape_ends():
    Scene(period=1, geometry="flat"), Scene(period=1, geometry="sinusoid")
    Scene(dimension=2, period=(100, 1), geometry="cylinder")
    with pytest.raises(InputError, match="smallest period"):
        Scene(dimension=2, period=(100, 1), geometry="sphere")


# Load paths

def test_quantities_and_their_units():
    assert {name: quantity.unit for name, quantity in quantities(1).items()} == {
        "normal_displacement": "u_n,r", "normal_force": "w_n,r", "tangential_displacement": "u_t,r",
        "tangential_force": "w_t,r"}
    assert [(name, quantity.component, quantity.control)
            for name, quantity in quantities(2).items()] == [("normal_displacement", 0,
                                                              "displacement"),
                                                             ("normal_force", 0, "force"),
                                                             ("tangential_displacement_x", 1,
                                                              "displacement"),
                                                             ("tangential_force_x", 1, "force"),
                                                             ("tangential_displacement_y", 2,
                                                              "displacement"),
                                                             ("tangential_force_y", 2, "force")]


def test_legs_keep_the_order_and_hold():
    legs = Load(path="normal_force=25 ; tangential_force = -1e2,normal_displacement=hold").legs(1)
    assert [leg.text for leg in legs] == ["normal_force=25",
                                          "tangential_force = -1e2,normal_displacement=hold"]
    assert list(legs[0].controls.items()) == [(0, Control("force", 25.0))]
    assert list(legs[1].controls.items()) == [(1, Control("force", -100.0)),
                                              (0, Control("displacement", None))]


def test_the_start_controls_every_component():
    assert Load().initial(1) == {0: ("displacement", 0.0), 1: ("displacement", 0.0)}
    start = Load(start="normal_force=1, tangential_displacement_y=3").initial(2)
    assert start == {0: ("force", 1.0), 1: ("displacement", 0.0), 2: ("displacement", 3.0)}


@pytest.mark.parametrize("path, dimension, quoted, hint", [("", 1, "-load_path", "is empty"),
                                                           ("   ", 1, "-load_path", "is empty"),
                                                           ("normal_force=1;", 1, "normal_force=1;",
                                                            "empty leg"),
                                                           (";normal_force=1", 1, ";normal_force=1",
                                                            "empty leg"),
                                                           ("normal_force=1; ;normal_force=2", 1,
                                                            "; ;", "empty leg"),
                                                           ("normal_force=1,", 1, "normal_force=1,",
                                                            "empty piece"),
                                                           ("normal_force", 1, "'normal_force'",
                                                            "without '='"),
                                                           ("normal_force 3", 1, "'normal_force 3'",
                                                            "without '='"),
                                                           ("normal_force=", 1, "'normal_force='",
                                                            "a finite number, or hold"),
                                                           ("normal_force=abc", 1, "abc",
                                                            "a finite number"),
                                                           ("normal_force=nan", 1, "nan",
                                                            "a finite number"),
                                                           ("normal_force=-inf", 1, "-inf",
                                                            "a finite number"),
                                                           ("normal_force=1=2", 1, "1=2",
                                                            "a finite number"),
                                                           ("normal_force=1 2", 1, "1 2",
                                                            "a finite number"),
                                                           ("normal_forse=1", 1, "normal_forse=1",
                                                            "did you mean normal_force?"),
                                                           ("xyz=1", 1, "xyz=1", "allowed are "
                                                            "normal_displacement, normal_force"),
                                                           ("tangental_displacement_x=1", 2,
                                                            "tangental_displacement_x=1",
                                                            "did you mean "
                                                            "tangential_displacement_x?"),
                                                           ("tangential_force=1", 2,
                                                            "tangential_force=1",
                                                            "tangential_force_x or "
                                                            "tangential_force_y"),
                                                           ("tangential_force_x=1", 1,
                                                            "tangential_force_x=1",
                                                            "write tangential_force"),
                                                           ("normal_force=1, normal_displacement=2",
                                                            1, "normal_displacement=2",
                                                            "controls one component twice"),
                                                           ("normal_force=1, normal_force=1", 1,
                                                            "normal_force=1",
                                                            "controls one component twice")])
def test_bad_path_is_one_sentence_that_quotes_the_piece(path, dimension, quoted, hint):
    with pytest.raises(InputError) as error:
        Load(path=path).legs(dimension)
    sentence = str(error.value)
    assert (sentence.startswith("-load_path") and quoted in sentence and hint in sentence
            and "\n" not in sentence)


@pytest.mark.parametrize("start", ["", "normal_displacement=hold",
                                   "normal_displacement=0; normal_force=1", "normal=1",
                                   "normal_force=1, normal_displacement=1"])
def test_bad_start(start):
    with pytest.raises(InputError, match="^-load_start"):
        Load(start=start).initial(1)


def test_stops():
    assert Load().stops == ()
    assert Load(stop="pull_off").stops == ("pull_off",)
    assert Load(stop="gross_sliding, pull_off").stops == ("gross_sliding", "pull_off")
    assert Load(stop=("gross_sliding", "pull_off")).stops == ("gross_sliding", "pull_off")


# Steps

def test_default_steps_are_fractions_of_the_leg():
    assert Steps().sizes(1, -40.0) == pytest.approx((1.0, 2.0, 4e-5), rel=1e-14)


@pytest.mark.parametrize("given", [dict(initial_step=30), dict(largest_step=0.1),
                                   dict(smallest_step=3), dict(largest_step=1e-7),
                                   dict(smallest_step=0.5, largest_step=0.6)])
def test_default_steps_give_way_to_given_ones(given):
    initial, largest, smallest = Steps(**given).sizes(1, 40.0)
    assert 0 < smallest <= initial <= largest
    assert dict(initial_step=initial, largest_step=largest, smallest_step=smallest) | given == dict(
        initial_step=initial, largest_step=largest, smallest_step=smallest)


def test_steps_per_leg():
    steps = Steps(initial_step=(1, 2), largest_step=4)
    assert steps.legs == 2 and Steps(largest_step=4).legs is None
    assert [steps.sizes(leg, 100)[:2] for leg in (1, 2)] == [(1, 4), (2, 4)]
    check(Scene(), Load(path="normal_force=1; normal_force=2"), steps)
    with pytest.raises(InputError, match="-continuation_initial_step is '1,2', for 2 legs, "
                       "-load_path has 1"):
        check(Scene(), Load(path="normal_force=1"), steps)


# Scene and load together

def test_tangential_off_refuses_tangential_loads():
    off = Scene(tangential="off")
    check(off, Load(path="normal_force=1")), check(off, Load())
    for load in (Load(path="normal_force=1; tangential_force=1"),
                 Load(start="tangential_displacement=1")):
        with pytest.raises(InputError, match="-scene_tangential is 'off'.*tangential_"):
            check(off, load)
        check(Scene(), load)


def test_tangential_unknowns_appear_where_load_or_coupling_needs_them():
    load = Load(path="normal_force=1; tangential_force=1; normal_force=2")
    assert tangential_legs(Scene(), load) == (False, False, True, True)
    assert tangential_legs(Scene(tangential="on"), load) == (True,) * 4
    assert tangential_legs(Scene(poisson=0.3), load) == (True,) * 4
    assert tangential_legs(Scene(tangential="off", poisson=0.3),
                           Load(path="normal_force=1")) == (False, False)
    assert tangential_legs(Scene(), Load(start="tangential_force=1")) == (True,)


@pytest.mark.parametrize("height, coupled", [(math.inf, False), (2000.0, False), (100.0, True),
                                             (1.0, True)])
def test_coupling_of_the_incompressible_layer_is_counted_down_to_rounding(height, coupled):
    # ratio of the coupling to the normal diagonal entry of the layer stiffness, nu = 1/2: k^2 /
    # (sinh k cosh k + k)
    k = min(2 * math.pi * height / 100.0, 300.0)
    ratio = k ** 2 / (math.sinh(k) * math.cosh(k) + k)
    assert Scene(height=height).coupled == coupled == (ratio > 1e-16)


@pytest.mark.parametrize("scene, load, name", [(dict(law="mcgarry"), "tangential_force=1",
                                                "scene_residual_friction"),
                                               (dict(law="mcgarry"), "tangential_force=1",
                                                "scene_residual_adhesion"),
                                               (dict(), "normal_force=1",
                                                "scene_residual_friction"),
                                               (dict(), "normal_force=1",
                                                "scene_tangential_maugis"),
                                               (dict(), "normal_force=1", "scene_work_ratio"),
                                               (dict(), "normal_force=1", "scene_amplitude"),
                                               (dict(geometry="flat"), "normal_force=1",
                                                "scene_geometry_file"),
                                               (dict(), "normal_force=1", "archive_resume"),
                                               (dict(), "normal_force=1",
                                                "contact_first_tolerance")])
def test_options_without_effect_are_named(scene, load, name):
    found = ineffective(Scene(**scene), Load(path=load), {name, "scene_poisson", "snes_monitor"})
    assert [entry[0] for entry in found] == [name] and found[0][1]


def test_options_with_effect_are_not_named():
    names = {"scene_residual_friction", "scene_tangential_maugis", "scene_work_ratio",
             "scene_amplitude", "contact_window", "archive_fields"}
    scene = Scene(poisson=0.3, geometry="sinusoid")
    load = Load(path="tangential_force=1")
    assert ineffective(scene, load, names, output=Output(file="a.h5")) == []
    assert ineffective(scene, load, {"contact_window"},
                       Form(form="force"))[0][0] == "contact_window"
    first = {"contact_first", "contact_first_tolerance"}
    assert ineffective(scene, load, first, Form(first="relaxation")) == []
    assert {name for name, why in ineffective(
        scene, load, first, Form(first="relaxation", form="force"))} == first


# Resolution of the cohesive zone

def test_the_grid_of_the_paper_is_just_resolved():
    # 2^13 points, L = 100, lambda_n = 10: dx lambda_n^2 = 1.22
    assert resolution(Scene(), sheared=False) == pytest.approx((100 / 8192 * 100 / 1.25,))
    assert resolution_warning(Scene(), sheared=True) is None
    assert "-scene_points 8192" in resolution_warning(Scene(points=4096), sheared=False)


@pytest.mark.parametrize("law, friction", [("modified", 0.0), ("modified", 0.6), ("mcgarry", 1.0)])
@pytest.mark.parametrize("dimension, poisson", [(1, 0.5), (2, 0.5), (2, 0.0)])
def test_both_components_have_the_same_margin_against_pinning(law, friction, dimension, poisson):
    """Where the rule is just met, stiffness at the Nyquist wavenumber over steepest softening is
    the same for both."""
    scene = Scene(dimension=dimension, points=1024, normal_maugis=0.5, tangential_maugis=9.0,
                  law=law, residual_friction=friction, poisson=poisson, geometry="sinusoid")
    ratio, = set(resolution(scene, sheared=True))
    spacing = scene.spacings[0] / ratio
    b = np.linspace(0, 4, 400001)
    tail = math.sqrt(2 / math.e) * (friction + (1 - friction) * np.exp(-(b - math.sqrt(0.5)) ** 2))
    traction = (2 * b * np.exp(-b ** 2) if law == "mcgarry"
                else np.where(b < math.sqrt(0.5), 2 * b * np.exp(-b ** 2), tail))
    softening = -np.gradient(traction, b).min() * scene.tangential_maugis ** 2
    softest = 0.5 if dimension == 1 else (1 - poisson) / 2
    margin = softest * math.pi / spacing / softening
    a = np.linspace(0, 6, 400001)
    normal_softening = -np.gradient(a * np.exp(-a), a).min()
    assert margin == pytest.approx(0.5 * math.pi / 1.25 / normal_softening, rel=1e-4)


@pytest.mark.parametrize("normal, tangential, friction", [(3.0, 10.0, 1.0), (1.0, 1.0, 1.0),
                                                          (5.0, 5.0, 0.7), (10.0, 1.0, 0.5)])
def test_resolution_covers_the_eigenvalues_of_the_scaled_tangent(normal, tangential, friction):
    """Slip weakens adhesion and opening weakens friction: no real eigenvalue is softer than what
    the rule counts with."""
    scene = Scene(normal_maugis=normal, tangential_maugis=tangential, residual_friction=friction)
    law, scale = LAWS["modified"](friction), np.diag([normal, tangential])
    gaps = np.random.default_rng(2).uniform((0.0, -3.0), (5.0, 3.0), (20000, 2)).T
    values = np.linalg.eigvals(scale @ np.moveaxis(law.tangent(gaps), -1, 0) @ scale)
    softest = -values.real[np.abs(values.imag) < 1e-12].min()
    counted = math.exp(-2) * 1.25 * resolution(scene, True)[0] / scene.spacings[0]
    assert softest <= 1.001 * counted and softest > 0.98 * counted


def test_full_friction_asks_little_of_the_grid_where_slip_is_easy():
    scene = Scene(tangential_maugis=1.0, residual_friction=1.0)
    assert resolution(scene, True) == pytest.approx(resolution(scene, False))


def test_warning_names_a_sufficient_power_of_two():
    for scene, sheared in ((Scene(points=100, normal_maugis=7.0), False),
                           (Scene(residual_friction=0.0, tangential_maugis=20.0), True),
                           (Scene(dimension=2, points=(64, 32), geometry="sphere", period=(20, 30),
                                  normal_maugis=3.0), False)):
        suggested = resolution_warning(scene, sheared).split()[-1]
        points = tuple(map(int, suggested.split(",")))
        assert all(number & (number - 1) == 0 for number in points)
        assert resolution_warning(dataclasses.replace(scene, points=points), sheared) is None
        halved = tuple(max(16, number // 2) for number in points)
        assert resolution_warning(dataclasses.replace(scene, points=halved), sheared)


def test_directions_without_an_edge_need_no_resolution():
    assert resolution(Scene(dimension=2, points=(8192, 16)), True)[1] == 0
    assert resolution_warning(Scene(geometry="flat", points=16), True) is None


# Attributes, words

def test_attributes_have_defaults_filled_in_and_only_plain_values():
    values = attributes(Scene(geometry="sinusoid", dimension=2))
    assert (values["points"] == (512, 512)
            and values["amplitude"] == (pytest.approx((100 / (2 * math.pi)) ** 2),) * 2)
    assert attributes(Scene())["points"] == 8192 and "amplitude" not in attributes(Scene())
    for value in values.values():
        for item in value if isinstance(value, tuple) else (value,):
            assert isinstance(item, (int, float, str))


def test_text_of_values_reads_back():
    assert [as_text(value) for value in (100.0, 0.1, math.inf, (1, 2.5), True, None, "a b")] == [
        "100", "0.1", "inf", "1,2.5", "true", "", "a b"]
    for value in (1 / 3, 1e300, 5e-324, -2.0 ** 70):
        assert float(as_text(value)) == value


def test_interfaces_have_one_dimension_or_two():
    with pytest.raises(InputError, match="the dimension of the interface is 3: give 1 or 2"):
        Load(path="normal_force=1").legs(3)


@pytest.mark.parametrize("name", ("scene_temperature", "scene_grid", "scene_n"))
def test_what_only_begins_alike_is_not_near(name):
    """Prefixes make long parts of names alike."""
    known = ("scene_period", "scene_geometry", "scene_dimension", "scene_normal_maugis")
    assert nearest(name, known) == ""


def test_nearest():
    """A letter or two first, then all words, then the beginning, then what looks most alike."""
    assert nearest("poison", ("poisson", "period")) == "poisson" and nearest("qqq",
                                                                             ("poisson",)) == ""
    names = ("scene_units", "scene_heights_unit", "scene_normal_maugis")
    assert nearest("scene_unit", names) == "scene_units"
    assert nearest("scene_maugis", names) == "scene_normal_maugis"
    assert nearest("scene_maugis_of_friction", names) == "scene_normal_maugis"
    assert nearest("scene_steps", ("scene_slope", "scene_largest_step")) == "scene_largest_step"
    assert nearest("leadin", ("fold_kind", "leading_eigenvalue")) == "leading_eigenvalue"


def test_no_bound_is_a_number_or_a_word():
    """As files and the help write it."""
    assert Scene(height="inf") == Scene(height=np.inf)
    with pytest.raises(InputError, match="-scene_normal_maugis is 'inf'"):
        Scene(normal_maugis="inf")
