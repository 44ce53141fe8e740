"""Scenes in SI from what experiments know: Young's modulus, strengths, no radius."""

import math

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.interface import laws  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene  # noqa: E402

WORKS = {"units": "si", "work_of_adhesion_normal": 0.027, "work_of_adhesion_tangential": 0.06}
MODULI = {"young_modulus": 1.5e6, "poisson": 0.3}
STRENGTHS = {"adhesive_strength": 5e4, "shear_strength": 0.4e6}
KNOWN = {**WORKS, **MODULI, **STRENGTHS, "radius": 9.42e-3}
SINUSOID = {"geometry": "sinusoid", "amplitude": 4e-7, "height": 1e-3}


def test_scales_follow_from_what_experiments_know():
    """E/(1 - nu^2), and the peaks of the paper's eq. 4."""
    scene = Scene.typed(**KNOWN, dimension=2, geometry="sphere", period=2e-3)
    assert scene.contact_modulus == pytest.approx(1.5e6 / 0.91, rel=1e-14)
    assert scene.range_normal == pytest.approx(0.027 / (math.e * 5e4), rel=1e-14)
    assert scene.range_tangential == pytest.approx(math.sqrt(2 / math.e) * 0.06 / 0.4e6, rel=1e-14)
    assert scene.young_modulus is None and scene.shear_strength is None
    same = Scene.typed(**WORKS, radius=9.42e-3, poisson=0.3, dimension=2, geometry="sphere",
                       period=2e-3, contact_modulus=scene.contact_modulus,
                       range_normal=scene.range_normal, range_tangential=scene.range_tangential)
    assert same == scene


def test_the_range_of_a_shear_strength():
    """27 mJ/m^2 and 0.4 MPa: 58 nm."""
    scene = Scene.typed(**{**KNOWN, "work_of_adhesion_tangential": 0.027})
    assert scene.range_tangential == pytest.approx(58e-9, rel=0.01)


@pytest.mark.parametrize("law", ["mcgarry", "dugdale", "xu_needleman"])
def test_strengths_are_those_of_the_law(law):
    scene = Scene.typed(**KNOWN, law=law)
    made = laws.of(scene)
    opening, slip = np.linspace(0.0, 5.0, 20001), np.linspace(0.0, 4.0, 20001)
    normal = made.traction(np.array([opening, 0.0 * opening]))[0].max()
    tangential = made.traction(np.array([0.0 * slip, slip]))[1].max()
    assert normal * 0.027 / scene.range_normal == pytest.approx(5e4, rel=1e-6)
    assert tangential * 0.06 / scene.range_tangential == pytest.approx(0.4e6, rel=1e-6)


def states(**values):
    """Force and contact length along a path of a sinusoid in SI."""
    scene = Scene.typed(**WORKS, **MODULI, adhesive_strength=2e4, shear_strength=1e4, **SINUSOID,
                        period=1e-4, points=256, **values)
    branch = Branch(scene, Load(path="normal_displacement=2e-7; tangential_displacement=3e-6"))
    last = branch.observe(list(branch)[-1])
    return [last[name] for name in ("normal_force", "tangential_force", "contact_area")]


def test_the_radius_of_what_is_not_round_changes_nothing():
    """Without one, the period is 100 beta; scales are internal."""
    without = states()
    assert Scene.typed(**WORKS, **MODULI, **STRENGTHS, **SINUSOID, period=1e-4).period == (
        pytest.approx(100.0, rel=1e-12))
    for radius in (1e-5, 3e-2):
        assert states(radius=radius) == pytest.approx(without, rel=1e-6)


BAD = [({**KNOWN, "contact_modulus": 2e6}, "-scene_young_modulus is '1500000', but "
        "-scene_contact_modulus '2000000' fixes the same: give one of them"),
       ({**KNOWN, "range_normal": 1e-7}, "-scene_adhesive_strength is .* -scene_range_normal"),
       ({**KNOWN, "range_tangential": 1e-7}, "-scene_shear_strength is .* -scene_range_tangential"),
       ({**KNOWN, "normal_maugis": 3.0}, "it follows from -scene_range_normal"),
       ({"young_modulus": 1e6}, "-scene_units is 'dimensionless': add -scene_units si"),
       ({**WORKS, **MODULI, "range_normal": 1e-7, "radius": 0.01}, "without "
        r"-scene_range_tangential \(or -scene_shear_strength\): give it"),
       ({**WORKS, **MODULI, **STRENGTHS}, "without -scene_radius: "),
       ({**WORKS, **MODULI, **STRENGTHS, **SINUSOID}, "without -scene_radius and without a finite "
        "-scene_period"),
       ({**WORKS, **MODULI, **STRENGTHS, "geometry": "sinusoid", "period": 1e-4},
        "without -scene_radius: "),
       ({**WORKS, **STRENGTHS, "radius": 0.01}, "without -scene_contact_modulus"),
       ({**KNOWN, "shear_strength": 0.0}, "-scene_shear_strength is '0': allowed is"),]


@pytest.mark.parametrize("values, sentence", BAD)
def test_bad_input_names_both_options(values, sentence):
    with pytest.raises(InputError, match=sentence) as error:
        Scene.typed(**values)
    assert "\n" not in str(error.value)


def test_strengths_are_typed_only():
    with pytest.raises(InputError, match="follows from it in Scene.typed only"):
        Scene(**WORKS, contact_modulus=2e6, radius=0.01, work_ratio=0.06 / 0.027,
              shear_strength=1e5)
