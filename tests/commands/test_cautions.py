"""What speaks against a scene before it is solved: displacements that are out of reach, cells at
whose edge the law acts, layers thinner than the spacing."""

from types import SimpleNamespace

import numpy as np
import pytest

from contactsnes import Branch, Contact, Load, Scene, Steps
from contactsnes.commands.cautions import cautions

SI = dict(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
          contact_modulus=2e6, radius=0.01, range_normal=0.8e-6, range_tangential=0.6e-6,
          period=0.006, height=0.2, points=1024)


def told(scene, words="out of reach", **load):
    """Sentences on a scene and its loads that have these words."""
    return [sentence for sentence in cautions(
        SimpleNamespace(scene=scene, load=Load(**load), steps=Steps()), Contact(scene))
        if words in sentence]


@pytest.mark.parametrize("law, deepest", [("modified", 30.0), ("dugdale", 3.0)])
def test_a_displacement_beyond_all_overlap_is_told(law, deepest):
    """The mean of x^2/2 over the nodes of a cell, and the overlap that the law is followed to."""
    scene = Scene(points=256, period=30.0, normal_maugis=2.0, law=law)
    x = [(i - 128) * 30.0 / 256 for i in range(256)]
    limit = sum(each ** 2 for each in x) / 512 + deepest / 2.0
    assert not told(scene, path=f"normal_displacement={limit - 0.1}; normal_force=4")
    (sentence,) = told(scene, path=f"normal_displacement={limit + 0.1}; normal_force=4")
    assert f"beyond {limit:.4g} u_n,r" in sentence
    assert told(scene, start=f"normal_displacement={limit + 0.1}", path="normal_force=1")


def test_a_plane_has_one_mean_gap():
    """The mean of (x^2 + y^2)/2 over the nodes of two directions, and 30 ranges."""
    scene = Scene(dimension=2, geometry="sphere", points=(64, 32), period=(16.0, 12.0),
                  normal_maugis=2.0)
    limit = 15.0 + sum(sum(((i - n // 2) * length / n) ** 2 for i in range(n)) / (2 * n)
                       for n, length in ((64, 16.0), (32, 12.0)))
    assert not told(scene, path=f"normal_displacement={limit - 0.1}")
    assert told(scene, path=f"normal_displacement={limit + 0.1}")


def test_metres_in_place_of_micrometres_are_told():
    """R = 10 mm: (L/2)^2 / 6 R and 30 ranges of 0.8 um."""
    scene = Scene.typed(**SI)
    assert not told(scene, path="normal_displacement=5e-6")
    (sentence,) = told(scene, path="normal_displacement=5")
    assert sentence.startswith("normal_displacement 5 m is out of reach")
    assert f"beyond {0.003 ** 2 / 0.06 * 1e6 + 24:.4g} µm" in sentence


def test_where_the_displacement_is_not_that_of_the_mean_surface_nothing_is_told():
    scene = Scene(points=256, period=30.0, normal_maugis=2.0, poisson=0.3)
    assert not told(scene, path="normal_displacement=3000")
    assert not told(scene)


@pytest.mark.parametrize("largest, told", [
    (None, None), (1e-3, None), ((1e-3, 1e-12), "leg 2 takes at least 3e+12 steps"),
    (1e-9, "leg 2 takes at least 3e+09 steps")])
def test_steps_that_come_to_no_end_are_told(largest, told):
    """Of a leg of 3; the force of the first one begins where the displacement has led."""
    scene = Scene(points=256, period=30.0, normal_maugis=2.0)
    load = Load(path="normal_force=1; normal_force=-2")
    settings = SimpleNamespace(scene=scene, load=load, steps=Steps(
        largest_step=largest, initial_step=largest))
    sentences = [sentence for sentence in cautions(settings, Contact(scene)) if "steps" in sentence]
    assert len(sentences) == bool(told) and all(told in sentence for sentence in sentences)
    assert all("-continuation_largest_step is 1e-" in sentence for sentence in sentences)


@pytest.mark.parametrize("period, order", [(6.0, 2.0), (12.0, None)])
def test_where_the_law_acts_at_the_edge_of_the_cell_it_is_told(period, order):
    """There x^2/2 bends: the force converges with the square of the spacing, else exponentially.
    The undeformed edge is (L/2)^2/2 above the flat, less what it is pressed by."""
    load = {"start": "normal_displacement=1.2", "path": "normal_displacement=1.2"}
    forces = [next(iter(Branch(Scene(points=points, period=period, normal_maugis=1.5, height=500.0),
                               Load(**load)))).forces[0] for points in (64, 128, 256)]
    first, second = np.abs(np.diff(forces))
    sentences = told(Scene(points=64, period=period, normal_maugis=1.5), "edge of the cell", **load)
    if order is None:
        assert first < 1e-7 and not sentences
        return
    assert np.log2(first / second) == pytest.approx(order, abs=0.1) and first > 1e-4
    gap = 1.5 * (period ** 2 / 8 - 1.2)
    (sentence,) = sentences
    assert f"up to {gap * np.exp(1 - gap):.2g} of its peak" in sentence


THIN = dict(points=256, period=20.0, normal_maugis=3.0, poisson=0.3)


@pytest.mark.parametrize("changed, way, error", [
    ({"height": 0.03}, 0.3, (5e-5, 1e-2)), ({"height": 10.0}, 2.0, (0.0, 2e-5)),
    ({"height": 0.03, "law": "mcgarry"}, 0.3, (0.0, 1e-8))])
def test_a_sheared_layer_thinner_than_the_spacing_is_told(changed, way, error):
    """The tangential force against a grid four times finer: what lies between the corner of the law
    and the traction is the body."""
    load = {"path": f"normal_force=5; tangential_displacement={way}"}
    forces = [list(Branch(Scene(**{**THIN, **changed, "points": points}),
                          Load(**load)))[-1].forces[1] for points in (256, 1024)]
    assert error[0] <= abs(forces[0] / forces[1] - 1.0) <= error[1]
    sentences = told(Scene(**THIN, **changed), "thinner than the spacing", **load)
    assert len(sentences) == (error[0] > 0.0)
    assert all("spacing, 0.07812 beta" in sentence for sentence in sentences)


def test_thin_layers_without_shear_or_edge_and_coatings_are_not_told():
    thin = Scene(**THIN, height=0.03)
    assert not told(thin, "thinner than the spacing", path="normal_force=5")
    shear = {"path": "normal_force=1; tangential_displacement=0.1"}
    assert told(thin, "thinner than the spacing", **shear)
    for changed in ({"geometry": "flat", "height": 0.03},
                    {"body": "coated", "coating_normal": 0.3, "coating_tangential": 0.3}):
        assert not told(Scene(**THIN, **changed), "thinner than the spacing", **shear)
